//! Charts of lines and points, as SVG and as pixels, and the patterns of sparse matrices.

use crate::picture::Picture;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::sync::Once;
use thiserror::Error;

/// Colours that differ for all kinds of colour vision. Source: Okabe and Ito, "Color universal design", 2008.
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// The most pixels of a chart's side.
const MAX_SIDE: u32 = 8192;

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
    /// A size that is none.
    #[error("a chart of {width}x{height} pixels; each is from 64 to {MAX_SIDE}")]
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

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisScale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithm.
    Log10,
}

/// An axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What it shows, with the unit.
    pub label: String,
    /// How values are spread.
    pub scale: AxisScale,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// A line through its points.
    #[default]
    Line,
    /// A line with a dot at each point.
    Points,
}

/// A row of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub label: String,
    /// How it is drawn.
    pub mark: Mark,
    /// x and y.
    pub points: Vec<[f64; 2]>,
}

/// Series over common axes, with a legend where there are several.
///
/// ```
/// use adwave_render::plot::{Axis, Chart, Series};
/// let axis = |label: &str| Axis { label: label.to_owned(), ..Axis::default() };
/// let line = Series { label: "y = x".to_owned(), points: vec![[0.0, 0.0], [1.0, 1.0]], ..Series::default() };
/// let chart = Chart { title: "A line".to_owned(), x: axis("x"), y: axis("y"), series: vec![line] };
/// assert!(chart.svg(400, 300)?.contains("A line"));
/// assert_eq!(chart.picture(400, 300)?.width, 400);
/// # Ok::<(), adwave_render::plot::PlotError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// The line above.
    pub title: String,
    /// The axis across.
    pub x: Axis,
    /// The axis up.
    pub y: Axis,
    /// What is shown.
    pub series: Vec<Series>,
}

impl Chart {
    /// The chart as the text of an SVG file.
    ///
    /// # Errors
    ///
    /// No points, values that have no place on their axis, a size that is none.
    pub fn svg(&self, width: u32, height: u32) -> Result<String, PlotError> {
        self.check(width, height)?;
        let mut text = String::new();
        self.draw(&SVGBackend::with_string(&mut text, (width, height)).into_drawing_area())?;
        Ok(text)
    }

    /// The chart in pixels.
    ///
    /// # Errors
    ///
    /// As [`Chart::svg`].
    pub fn picture(&self, width: u32, height: u32) -> Result<Picture, PlotError> {
        self.check(width, height)?;
        let mut rgb = vec![255; 3 * width as usize * height as usize];
        self.draw(&BitMapBackend::with_buffer(&mut rgb, (width, height)).into_drawing_area())?;
        let rgba = rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
        Ok(Picture { width, height, rgba })
    }

    fn check(&self, width: u32, height: u32) -> Result<(), PlotError> {
        if ![width, height].iter().all(|s| (64..=MAX_SIDE).contains(s)) {
            return Err(PlotError::Size { width, height });
        }
        if self.series.iter().all(|s| s.points.is_empty()) {
            return Err(PlotError::Empty { title: self.title.clone() });
        }
        for series in &self.series {
            for (axis, value) in series.points.iter().flat_map(|p| [(&self.x, p[0]), (&self.y, p[1])]) {
                let fits = value.abs() < 1e300 && (axis.scale == AxisScale::Linear || value > 1e-300);
                if !fits {
                    let (title, series) = (self.title.clone(), series.label.clone());
                    return Err(PlotError::BadValue { title, series, value });
                }
            }
        }
        Ok(())
    }

    /// The values that an axis shows.
    fn range(&self, axis: &Axis, k: usize) -> std::ops::Range<f64> {
        let values = || self.series.iter().flat_map(|s| &s.points).map(|p| p[k]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        match axis.scale {
            AxisScale::Log10 => low / 1.3..high * 1.3,
            AxisScale::Linear => {
                let room = if high > low { 0.04 * (high - low) } else { low.abs().max(1.0) * 0.1 };
                low - room..high + room
            }
        }
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, plotters::coord::Shift>,
    ) -> Result<(), PlotError> {
        // Pixels need a font of our own; SVG names one, and its reader has it.
        static FONT: Once = Once::new();
        FONT.call_once(|| {
            let registered =
                register_font("sans-serif", FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
            assert!(registered.is_ok(), "the font of the library is one");
        });
        let (x, y) = (self.range(&self.x, 0), self.range(&self.y, 1));
        match (self.x.scale, self.y.scale) {
            (AxisScale::Linear, AxisScale::Linear) => self.draw_on(area, x, y),
            (AxisScale::Linear, AxisScale::Log10) => self.draw_on(area, x, y.log_scale()),
            (AxisScale::Log10, AxisScale::Linear) => self.draw_on(area, x.log_scale(), y),
            (AxisScale::Log10, AxisScale::Log10) => self.draw_on(area, x.log_scale(), y.log_scale()),
        }
    }

    fn draw_on<B, X, Y>(
        &self,
        area: &DrawingArea<B, plotters::coord::Shift>,
        x: X,
        y: Y,
    ) -> Result<(), PlotError>
    where
        B: DrawingBackend,
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let failed = |e: &dyn std::fmt::Display| PlotError::Drawing(e.to_string());
        let size = (area.dim_in_pixel().1 / 24).clamp(11, 40);
        let ink = RGBColor(48, 48, 48);
        area.fill(&WHITE).map_err(|e| failed(&e))?;
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", size + 3, &ink))
            .margin(size)
            .x_label_area_size(3 * size)
            .y_label_area_size(5 * size)
            .build_cartesian_2d(x, y)
            .map_err(|e| failed(&e))?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .axis_style(RGBColor(120, 120, 120))
            .label_style(("sans-serif", size, &ink))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_label_formatter(&|v| number(*v))
            .y_label_formatter(&|v| number(*v))
            .draw()
            .map_err(|e| failed(&e))?;
        for (k, series) in self.series.iter().enumerate() {
            let color = COLORS[k % COLORS.len()];
            let style = color.stroke_width(2);
            let points = || series.points.iter().map(|p| (p[0], p[1]));
            let drawn = chart.draw_series(LineSeries::new(points(), style)).map_err(|e| failed(&e))?;
            if !series.label.is_empty() {
                let long = 2 * size as i32;
                drawn
                    .label(&series.label)
                    .legend(move |(x, y)| PathElement::new([(x, y), (x + long, y)], style));
            }
            if series.mark == Mark::Points {
                let dots = points().map(|p| Circle::new(p, 4, color.filled()));
                chart.draw_series(dots).map_err(|e| failed(&e))?;
            }
        }
        if self.series.len() > 1 {
            chart
                .configure_series_labels()
                .label_font(("sans-serif", size, &ink))
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200))
                .legend_area_size(3 * size as i32)
                .draw()
                .map_err(|e| failed(&e))?;
        }
        area.present().map_err(|e| failed(&e))
    }
}

/// A tick: few digits, powers of ten where it is far from 1.
fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || size < 1e-12 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.0e}")
    }
}

/// Where a matrix of so many rows and columns has entries: a dark square each, row 0 at the top.
///
/// # Errors
///
/// [`PlotError::Empty`] without rows, columns or entries; [`PlotError::Size`] when the squares do not fit.
pub fn sparsity_pattern(
    n_rows: usize,
    n_columns: usize,
    entries: &[[u32; 2]],
    square: u32,
) -> Result<Picture, PlotError> {
    if n_rows == 0 || n_columns == 0 || entries.is_empty() {
        return Err(PlotError::Empty { title: "sparsity pattern".to_owned() });
    }
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX).saturating_mul(square.max(1));
    let (width, height) = (side(n_columns), side(n_rows));
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(PlotError::Size { width, height });
    }
    let mut picture = Picture::filled(width, height, [244, 244, 244, 255])
        .map_err(|_| PlotError::Size { width, height })?;
    for &[row, column] in entries {
        for k in 0..square.max(1).pow(2) {
            let (x, y) = (column * square + k % square, row * square + k / square);
            picture.blend(i64::from(x), i64::from(y), [0, 80, 140], 1.0);
        }
    }
    Ok(picture)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<[f64; 2]>, scale: AxisScale) -> Chart {
        let axis = Axis { label: "σ".to_owned(), scale };
        let series = vec![Series { label: "one".to_owned(), mark: Mark::Points, points }];
        Chart { title: "t".to_owned(), x: axis.clone(), y: axis, series }
    }

    #[test]
    fn what_has_no_place_on_its_axis_is_refused() {
        let error = |points, scale| chart(points, scale).svg(200, 150).unwrap_err().to_string();
        assert!(error(vec![], AxisScale::Linear).contains("no points"));
        assert!(error(vec![[1.0, f64::NAN]], AxisScale::Linear).contains("NaN"));
        assert!(error(vec![[1.0, 0.0]], AxisScale::Log10).contains("above 0"));
        assert!(chart(vec![[1.0, 1.0]], AxisScale::Linear).picture(0, 5).is_err());
    }

    #[test]
    fn charts_are_the_same_each_time_and_show_their_series() {
        for scale in [AxisScale::Linear, AxisScale::Log10] {
            let chart = chart(vec![[1.0, 1.0], [10.0, 100.0]], scale);
            let picture = chart.picture(300, 200).unwrap();
            assert_eq!(picture, chart.picture(300, 200).unwrap());
            assert!(picture.rgba.chunks_exact(4).any(|p| p[..3] == [0, 114, 178]));
            assert!(chart.svg(300, 200).unwrap().starts_with("<svg"));
        }
    }

    #[test]
    fn a_pattern_has_a_square_for_each_entry() {
        let picture = sparsity_pattern(3, 2, &[[0, 0], [2, 1]], 4).unwrap();
        assert_eq!((picture.width, picture.height), (8, 12));
        let dark = picture.rgba.chunks_exact(4).filter(|p| p[0] == 0).count();
        assert_eq!(dark, 2 * 16);
        assert!(sparsity_pattern(0, 0, &[], 4).is_err());
    }
}
