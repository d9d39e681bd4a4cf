//! Charts as pictures of a figure, and the line of points that the one-dimensional figures are about.

use super::{FigureError, Outcome};
use adwave::shape::{Graph, Shape};
use adwave_render::plot::{Axis, AxisScale, Chart, Mark, Series};

/// Points on the line of Figs. 2, 4 and 7.
pub(super) const N_POINTS: usize = 100;

/// Pixels of a chart.
const SIZE: (u32, u32) = (900, 520);

/// Equal weights between neighbours on a line of points.
pub(super) fn line() -> Result<Shape, FigureError> {
    let edges: Vec<_> = (1..N_POINTS as u32).map(|i| (i - 1, i, 1.0)).collect();
    Ok(Shape::Graph(Graph::new(N_POINTS, &edges)?))
}

/// A series of values at 0, 1, 2 …
pub(super) fn row(label: impl Into<String>, values: &[f64]) -> Series {
    let points = values.iter().enumerate().map(|(x, &y)| [x as f64, y]).collect();
    Series { label: label.into(), mark: Mark::Line, points }
}

/// A linear axis.
pub(super) fn linear(label: &str) -> Axis {
    Axis { label: label.to_owned(), scale: AxisScale::Linear }
}

/// A logarithmic axis.
pub(super) fn logarithmic(label: &str) -> Axis {
    Axis { label: label.to_owned(), scale: AxisScale::Log10 }
}

impl Outcome {
    /// Adds a chart, as SVG and as PNG.
    pub(super) fn chart(self, stem: &str, caption: &str, chart: &Chart) -> Result<Self, FigureError> {
        let svg = chart.svg(SIZE.0, SIZE.1)?.into_bytes();
        let png = chart.picture(SIZE.0, SIZE.1)?.png()?;
        Ok(self.picture(&format!("{stem}.svg"), caption, svg).picture(&format!("{stem}.png"), caption, png))
    }
}
