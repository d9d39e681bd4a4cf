//! Charts of lines, points, bars and stems, and the patterns of sparse matrices, as SVG and as pixels.
//!
//! A [`Chart`] is one pair of axes, a [`Sheet`] several charts, a [`SparsityPattern`] the positions of a matrix's
//! entries. Axes, ticks and both backends come from plotters. The legend is drawn here, because plotters can only draw
//! it over the curves.

mod canvas;
mod chart;
mod draw;
mod sheet;
mod sparsity;
#[cfg(test)]
mod tests;
mod ticks;

pub use chart::{AxisScale, Chart, ChartAxis, Mark, Series};
pub use sheet::Sheet;
pub use sparsity::SparsityPattern;

use adwave::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Largest number of pixels per side of a chart.
const MAX_SIDE: u32 = 8192;
/// Smallest number of pixels per side of a chart.
const MIN_SIDE: u32 = 64;

/// Reason for which a chart cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlotError {
    /// The chart has no points.
    #[error("the chart '{title}' has no points")]
    Empty {
        /// Title of the chart.
        title: String,
    },
    /// A value lies outside the domain of its axis.
    #[error(
        "values must be finite, and above 0 on a logarithmic axis, but '{series}' of the chart '{title}' \
        has {value}"
    )]
    BadValue {
        /// Title of the chart.
        title: String,
        /// Label of the series.
        series: String,
        /// The value.
        value: f64,
    },
    /// An entry lies outside the matrix.
    #[error(
        "the entries of '{title}' must lie inside {n_rows} rows and {n_columns} columns, got row {row}, \
        column {column}"
    )]
    BadEntry {
        /// Title of the pattern.
        title: String,
        /// Row, from 0.
        row: u32,
        /// Column, from 0.
        column: u32,
        /// Number of rows of the matrix.
        n_rows: usize,
        /// Number of columns of the matrix.
        n_columns: usize,
    },
    /// The size is out of range.
    #[error("the sides of a chart must be in {MIN_SIDE}..={MAX_SIDE} pixels, got {width}x{height}")]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
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
