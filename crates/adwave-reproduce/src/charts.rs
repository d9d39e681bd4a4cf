//! Charts of a figure as pictures, and the line graph of the one-dimensional figures.

use crate::{FigureError, Outcome};
use adwave::shape::{Graph, Shape};
use adwave_render::Picture;
use adwave_render::plot::{AxisScale, Chart, ChartAxis, Mark, Series, Sheet, SparsityPattern};

/// Number of points of the line in Figs. 2, 4 and 7.
pub(crate) const N_POINTS: usize = 100;

/// Size of a chart in pixels.
const SIZE: (u32, u32) = (900, 520);
/// Size of a chart among others, in pixels.
const SMALL: (u32, u32) = (520, 400);
/// Size of a sparsity pattern in pixels.
const PATTERN: (u32, u32) = (460, 500);

/// Creates a path graph with equal weights.
pub(crate) fn line() -> Result<Shape, FigureError> {
    let edges: Vec<_> = (1..N_POINTS as u32).map(|i| (i - 1, i, 1.0)).collect();
    Ok(Shape::Graph(Graph::new(N_POINTS, &edges)?))
}

/// Creates a series of values at 0, 1, 2 …
pub(crate) fn row(label: impl Into<String>, values: &[f64]) -> Series {
    let points = values.iter().enumerate().map(|(x, &y)| [x as f64, y]).collect();
    Series { label: label.into(), mark: Mark::Line, points }
}

/// Creates a linear axis.
pub(crate) fn linear(label: &str) -> ChartAxis {
    ChartAxis { label: label.to_owned(), ..ChartAxis::default() }
}

/// Creates a logarithmic axis.
pub(crate) fn logarithmic(label: &str) -> ChartAxis {
    ChartAxis { label: label.to_owned(), scale: AxisScale::Log10, ..ChartAxis::default() }
}

/// Creates an axis of categories.
pub(crate) fn categories(label: &str, names: impl IntoIterator<Item = String>) -> ChartAxis {
    ChartAxis { names: names.into_iter().collect(), ..linear(label) }
}

impl Outcome {
    /// Adds a chart, as SVG and as PNG.
    pub(crate) fn chart(self, stem: &str, caption: &str, chart: &Chart) -> Result<Self, FigureError> {
        let (width, height) = SIZE;
        self.add_svg_and_png(stem, caption, chart.svg(width, height)?, &chart.picture(width, height)?)
    }

    /// Adds charts side by side, as SVG and as PNG.
    pub(crate) fn charts(self, stem: &str, caption: &str, sheet: &Sheet) -> Result<Self, FigureError> {
        let columns = sheet.columns.clamp(1, sheet.charts.len().max(1));
        let rows = sheet.charts.len().div_ceil(columns);
        let (width, height) = (SMALL.0 * columns as u32, SMALL.1 * rows as u32);
        self.add_svg_and_png(stem, caption, sheet.svg(width, height)?, &sheet.picture(width, height)?)
    }

    /// Adds the sparsity pattern of a matrix, as SVG and as PNG.
    pub(crate) fn pattern(
        self,
        stem: &str,
        caption: &str,
        pattern: &SparsityPattern,
    ) -> Result<Self, FigureError> {
        let (width, height) = PATTERN;
        self.add_svg_and_png(stem, caption, pattern.svg(width, height)?, &pattern.picture(width, height)?)
    }

    fn add_svg_and_png(
        self,
        stem: &str,
        caption: &str,
        svg: String,
        picture: &Picture,
    ) -> Result<Self, FigureError> {
        let png = picture.png()?;
        Ok(self.picture(&format!("{stem}.svg"), caption, svg.into_bytes()).picture(
            &format!("{stem}.png"),
            caption,
            png,
        ))
    }
}
