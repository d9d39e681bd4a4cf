//! Description of a chart: axes, series, title.

use super::canvas::{self, Area, Drawable};
use super::{PlotError, draw};
use crate::picture::Picture;
use plotters::prelude::DrawingBackend;
use std::ops::Range;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum AxisScale {
    /// Linear scale.
    #[default]
    Linear,
    /// Logarithmic scale.
    Log10,
}

/// Axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartAxis {
    /// Label of the axis, with the unit.
    pub label: String,
    /// Scale of the axis.
    pub scale: AxisScale,
    /// Labels at 0, 1, 2 … that replace the numbers, for a linear horizontal axis; empty for numbers.
    pub names: Vec<String>,
}

/// Drawing style of a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mark {
    /// Line through the points.
    #[default]
    Line,
    /// Line through the points with a dot at each.
    Points,
    /// Bar to each point from 0, or from the lower end of a logarithmic axis; bars of several series are drawn side by
    /// side.
    Bars,
    /// Thin line with a dot to each point, from the start of a bar.
    Stems,
}

/// Series of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Drawing style.
    pub mark: Mark,
    /// x and y of each point.
    pub points: Vec<[f64; 2]>,
}

/// Series over common axes, with a legend above them if there are several.
///
/// ```
/// use adwave_render::plot::{ChartAxis, Chart, Series};
/// let axis = |label: &str| ChartAxis { label: label.to_owned(), ..ChartAxis::default() };
/// let line = Series { label: "y = x".to_owned(), points: vec![[0.0, 0.0], [1.0, 1.0]], ..Series::default() };
/// let chart = Chart { title: "A line".to_owned(), x: axis("x"), y: axis("y"), series: vec![line] };
/// assert!(chart.svg(400, 300)?.contains("A line"));
/// assert_eq!(chart.picture(400, 300)?.width, 400);
/// # Ok::<(), adwave_render::plot::PlotError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Title above the chart.
    pub title: String,
    /// Horizontal axis.
    pub x: ChartAxis,
    /// Vertical axis.
    pub y: ChartAxis,
    /// Series to draw.
    pub series: Vec<Series>,
}

impl Chart {
    /// Draws the chart as SVG.
    ///
    /// # Errors
    ///
    /// No points, values outside the domain of their axis, or a size out of range.
    pub fn svg(&self, width: u32, height: u32) -> Result<String, PlotError> {
        canvas::svg(self, width, height)
    }

    /// Draws the chart in pixels.
    ///
    /// # Errors
    ///
    /// The errors of [`Chart::svg`].
    pub fn picture(&self, width: u32, height: u32) -> Result<Picture, PlotError> {
        canvas::picture(self, width, height)
    }

    /// Number of series drawn as bars.
    pub(super) fn n_bars(&self) -> usize {
        self.series.iter().filter(|s| s.mark == Mark::Bars).count()
    }

    /// Half the width shared by the bars at one position: 0.4 of the smallest distance between positions, in units of
    /// the horizontal axis, or of its natural logarithm if the axis is logarithmic.
    pub(super) fn half_slot(&self) -> f64 {
        let log = self.x.scale == AxisScale::Log10;
        let bars = self.series.iter().filter(|s| s.mark == Mark::Bars);
        let mut places: Vec<f64> =
            bars.flat_map(|s| &s.points).map(|p| if log { p[0].ln() } else { p[0] }).collect();
        places.sort_unstable_by(f64::total_cmp);
        let gaps = places.windows(2).map(|w| w[1] - w[0]).filter(|gap| *gap > 0.0);
        let least = gaps.fold(f64::INFINITY, f64::min);
        0.4 * if least.is_finite() { least } else { 1.0 }
    }

    /// Range of the horizontal axis, with margins.
    pub(super) fn x_range(&self) -> Range<f64> {
        let (low, high) = self.extremes(0);
        let slot = if self.n_bars() > 0 { 1.4 * self.half_slot() } else { 0.0 };
        match self.x.scale {
            AxisScale::Log10 => {
                let factor = slot.exp().max(1.3);
                low / factor..high * factor
            }
            AxisScale::Linear => {
                let room = if high > low { 0.04 * (high - low) } else { low.abs().max(1.0) * 0.1 };
                low - room.max(slot)..high + room.max(slot)
            }
        }
    }

    /// Range of the vertical axis, with margins; a linear axis with bars or stems includes 0.
    pub(super) fn y_range(&self) -> Range<f64> {
        let (low, high) = self.extremes(1);
        match self.y.scale {
            AxisScale::Log10 => low / 1.3..high * 1.3,
            AxisScale::Linear => {
                let from_zero = self.series.iter().any(|s| matches!(s.mark, Mark::Bars | Mark::Stems));
                let (low, high) = if from_zero { (low.min(0.0), high.max(0.0)) } else { (low, high) };
                let room = if high > low { 0.04 * (high - low) } else { low.abs().max(1.0) * 0.1 };
                let room_at = |end: f64| if from_zero && end == 0.0 { 0.0 } else { room };
                low - room_at(low)..high + if high > low { room_at(high) } else { room }
            }
        }
    }

    fn extremes(&self, k: usize) -> (f64, f64) {
        let values = || self.series.iter().flat_map(|s| &s.points).map(|p| p[k]);
        (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
    }
}

impl Drawable for Chart {
    fn check(&self) -> Result<(), PlotError> {
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

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Result<(), PlotError> {
        draw::draw(self, area)
    }
}
