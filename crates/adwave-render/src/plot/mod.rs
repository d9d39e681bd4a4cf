//! Charts of lines, points, bars and stems, and the patterns of sparse matrices, as SVG and as pixels.
//!
//! A [`Chart`] is one pair of axes, a [`Sheet`] several charts, a [`SparsityPattern`] the places where a matrix has entries.
//! Axes, ticks and both backends are plotters'; the legend is our own, since that library can only lay it over the curves.

mod canvas;
mod chart;
mod draw;
mod sheet;
mod sparsity;
#[cfg(test)]
mod tests;
mod ticks;

pub use chart::{Axis, AxisScale, Chart, Mark, Series};
pub use sheet::Sheet;
pub use sparsity::SparsityPattern;

use adwave::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// The most pixels of a chart's side.
const MAX_SIDE: u32 = 8192;
/// The least pixels of a chart's side.
const MIN_SIDE: u32 = 64;

/// A chart that cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlotError {
    /// No points at all.
    #[error("the chart '{title}' has no points")]
    Empty {
        /// Its title.
        title: String,
    },
    /// A value that has no place on its axis.
    #[error(
        "the chart '{title}' has the value {value} in '{series}'; values are finite, and above 0 on a logarithmic axis"
    )]
    BadValue {
        /// Its title.
        title: String,
        /// The label of the series.
        series: String,
        /// The value.
        value: f64,
    },
    /// An entry of a matrix outside of it.
    #[error(
        "the pattern '{title}' has an entry at row {row}, column {column} of {n_rows} rows and {n_columns} columns"
    )]
    BadEntry {
        /// Its title.
        title: String,
        /// From 0.
        row: u32,
        /// From 0.
        column: u32,
        /// Rows of the matrix.
        n_rows: usize,
        /// Columns of the matrix.
        n_columns: usize,
    },
    /// A size that is none.
    #[error("a chart of {width}x{height} pixels; each is from {MIN_SIDE} to {MAX_SIDE}")]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// The charting library failed.
    #[error("the chart cannot be drawn: {0}")]
    Drawing(String),
}

impl ClassifiedError for PlotError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Empty { .. } | Self::BadValue { .. } | Self::BadEntry { .. } | Self::Size { .. } => {
                ErrorKind::Input
            }
            Self::Drawing(_) => ErrorKind::Machine,
        }
    }
}

impl PlotError {
    fn drawing(error: &dyn std::fmt::Display) -> Self {
        Self::Drawing(error.to_string())
    }
}
