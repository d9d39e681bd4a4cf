//! Drawing of a chart on an area: title, legend, axes, series.

use super::PlotError;
use super::canvas::{Area, letters, width_of};
use super::chart::{AxisScale, Chart, Mark, Series};
use super::ticks::number;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colors that can be told apart with all kinds of color vision. Source: Okabe and Ito, "Color universal design", 2008.
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

const INK: RGBColor = RGBColor(48, 48, 48);

pub(super) fn draw<B: DrawingBackend>(chart: &Chart, area: &Area<B>) -> Result<(), PlotError> {
    let (x, y) = (chart.x_range(), chart.y_range());
    match (chart.x.scale, chart.y.scale) {
        (AxisScale::Linear, AxisScale::Linear) => draw_on(chart, area, x, y),
        (AxisScale::Linear, AxisScale::Log10) => draw_on(chart, area, x, y.log_scale()),
        (AxisScale::Log10, AxisScale::Linear) => draw_on(chart, area, x.log_scale(), y),
        (AxisScale::Log10, AxisScale::Log10) => draw_on(chart, area, x.log_scale(), y.log_scale()),
    }
}

fn draw_on<B, X, Y>(chart: &Chart, area: &Area<B>, x: X, y: Y) -> Result<(), PlotError>
where
    B: DrawingBackend,
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
    Y::CoordDescType: ValueFormatter<f64>,
{
    let failed = |e: &dyn std::fmt::Display| PlotError::drawing(e);
    let size = letters(area);
    let ink = &INK;
    area.fill(&WHITE).map_err(|e| failed(&e))?;
    let below = legend(chart, area, size)?;
    let (_, area) = area.split_vertically(below);
    let (x_span, y_span) = (length(&chart.x_range()), length(&chart.y_range()));
    let mut axes = ChartBuilder::on(&area)
        .margin(size)
        .margin_top(0)
        .x_label_area_size(3 * size)
        .y_label_area_size(5 * size)
        .build_cartesian_2d(x, y)
        .map_err(|e| failed(&e))?;
    let named = !chart.x.names.is_empty() && chart.x.scale == AxisScale::Linear;
    let formats = |v: &f64| if named { String::new() } else { number(*v, x_span) };
    let mut mesh = axes.configure_mesh();
    let y_formats = |v: &f64| number(*v, y_span);
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 225))
        .axis_style(RGBColor(120, 120, 120))
        .label_style(("sans-serif", size, ink))
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .x_label_formatter(&formats)
        .y_label_formatter(&y_formats);
    if named {
        mesh.disable_x_mesh();
    }
    mesh.draw().map_err(|e| failed(&e))?;
    let foot = if chart.y.scale == AxisScale::Log10 { chart.y_range().start } else { 0.0 };
    let (n_bars, half) = (chart.n_bars(), chart.half_slot());
    let mut bar = 0;
    for (k, series) in chart.series.iter().enumerate() {
        let color = COLORS[k % COLORS.len()];
        let points = || series.points.iter().map(|p| (p[0], p[1]));
        let dots = || points().map(|p| Circle::new(p, 4, color.filled()));
        match series.mark {
            Mark::Line | Mark::Points => {
                axes.draw_series(LineSeries::new(points(), color.stroke_width(2))).map_err(|e| failed(&e))?;
            }
            Mark::Bars => {
                // Offset of this series within the slot, −1 to 1.
                let edges = [bar, bar + 1].map(|k| 2.0 * f64::from(k) / n_bars as f64 - 1.0);
                bar += 1;
                let at = |x: f64, place: f64| {
                    if chart.x.scale == AxisScale::Log10 {
                        x * (place * half).exp()
                    } else {
                        x + place * half
                    }
                };
                let bars = points().map(|(x, y)| {
                    Rectangle::new([(at(x, edges[0]), y), (at(x, edges[1]), foot)], color.filled())
                });
                axes.draw_series(bars).map_err(|e| failed(&e))?;
            }
            Mark::Stems => {
                let stems =
                    points().map(|(x, y)| PathElement::new([(x, foot), (x, y)], color.stroke_width(1)));
                axes.draw_series(stems).map_err(|e| failed(&e))?;
            }
        }
        if matches!(series.mark, Mark::Points | Mark::Stems) {
            axes.draw_series(dots()).map_err(|e| failed(&e))?;
        }
    }
    if named {
        draw_names(chart, &area, &axes, size)?;
    }
    Ok(())
}

fn length(range: &std::ops::Range<f64>) -> f64 {
    range.end - range.start
}

/// Draws the names of the horizontal axis below their positions.
fn draw_names<B, X, Y>(
    chart: &Chart,
    area: &Area<B>,
    axes: &ChartContext<'_, B, Cartesian2d<X, Y>>,
    size: u32,
) -> Result<(), PlotError>
where
    B: DrawingBackend,
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    // The library chooses the ticks; names belong to integer positions.
    let (_, bottom) = axes.plotting_area().get_pixel_range();
    let slot = (f64::from(axes.plotting_area().dim_in_pixel().0) / length(&chart.x_range())) as u32;
    let size = fit_font_size(&chart.x.names, area, size, slot)?;
    let style = ("sans-serif", size, &INK).into_text_style(area).pos(Pos::new(HPos::Center, VPos::Top));
    let (left, top) = area.get_base_pixel();
    for (k, name) in chart.x.names.iter().enumerate() {
        let (x, _) = axes.plotting_area().map_coordinate(&(k as f64, chart.y_range().start));
        let position = (x - left, bottom.end - top + 2 * size as i32 / 3);
        area.draw_text(name, &style, position).map_err(|e| PlotError::drawing(&e))?;
    }
    Ok(())
}

/// Largest font size, at most `size`, at which no name is wider than its slot in pixels.
fn fit_font_size<B: DrawingBackend>(
    names: &[String],
    area: &Area<B>,
    size: u32,
    slot: u32,
) -> Result<u32, PlotError> {
    let mut widest = 1;
    for name in names {
        widest = widest.max(width_of(area, name, size)?);
    }
    Ok((size * slot.saturating_sub(size / 3) / widest).clamp(7, size))
}

/// Draws the title and, below it, the names and colors of the series in as many rows as needed; returns the lower end
/// in pixels.
fn legend<B: DrawingBackend>(chart: &Chart, area: &Area<B>, size: u32) -> Result<u32, PlotError> {
    let failed = |e: &dyn std::fmt::Display| PlotError::drawing(e);
    let line = 3 * size as i32 / 2;
    let width = area.dim_in_pixel().0 as i32;
    let left = size as i32;
    let mut y = size as i32;
    if !chart.title.is_empty() {
        let title =
            ("sans-serif", size + 3, &INK).into_text_style(area).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw_text(&chart.title, &title, (width / 2, y + size as i32 / 2)).map_err(|e| failed(&e))?;
        y += line;
    }
    if chart.series.iter().filter(|s| !s.label.is_empty()).count() < 2 {
        return Ok((y + size as i32 / 2) as u32);
    }
    let style = ("sans-serif", size, &INK).into_text_style(area).pos(Pos::new(HPos::Left, VPos::Center));
    let swatch = 2 * size as i32;
    let mut x = left;
    for (k, series) in chart.series.iter().enumerate().filter(|(_, s)| !s.label.is_empty()) {
        let wide = swatch + size as i32 / 2 + width_of(area, &series.label, size)? as i32;
        if x > left && x + wide > width - left {
            x = left;
            y += line;
        }
        let middle = y + size as i32 / 2;
        draw_swatch(series, COLORS[k % COLORS.len()], area, [x, x + swatch], middle)?;
        let after = (x + swatch + size as i32 / 2, middle);
        area.draw_text(&series.label, &style, after).map_err(|e| failed(&e))?;
        x += wide + 2 * size as i32;
    }
    Ok((y + line + size as i32 / 2) as u32)
}

fn draw_swatch<B: DrawingBackend>(
    series: &Series,
    color: RGBColor,
    area: &Area<B>,
    x: [i32; 2],
    y: i32,
) -> Result<(), PlotError> {
    let failed = |e: &dyn std::fmt::Display| PlotError::drawing(e);
    if series.mark == Mark::Bars {
        let half = (x[1] - x[0]) / 5;
        return area
            .draw(&Rectangle::new([(x[0], y - half), (x[1], y + half)], color.filled()))
            .map_err(|e| failed(&e));
    }
    let wide = if series.mark == Mark::Stems { 1 } else { 2 };
    area.draw(&PathElement::new([(x[0], y), (x[1], y)], color.stroke_width(wide))).map_err(|e| failed(&e))?;
    if series.mark != Mark::Line {
        area.draw(&Circle::new((i32::midpoint(x[0], x[1]), y), 4, color.filled())).map_err(|e| failed(&e))?;
    }
    Ok(())
}
