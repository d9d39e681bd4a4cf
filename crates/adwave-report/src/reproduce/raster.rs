//! Panels of shaded shapes, drawn with a depth buffer, parallel rays, normals smoothed over the faces, and four samples a
//! pixel.

use adwave::shape::vertex_normals;
use adwave_render::{ColorMap, value_range};
use image::{ImageFormat, Rgb, RgbImage};
use nalgebra::{Vector2, Vector3};
use rayon::prelude::*;

type V3 = Vector3<f64>;

/// Where the viewer stands, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// How far round the shape from the front, counterclockwise as seen from above.
    pub(super) azimuth: f64,
    /// How far above the horizon.
    pub(super) elevation: f64,
}

impl View {
    /// From the right of the front and a little above.
    pub(super) const THREE_QUARTER: Self = Self { azimuth: 30.0, elevation: 15.0 };

    /// The picture's right, its up, and the direction towards the viewer; y is up.
    fn axes(self) -> [V3; 3] {
        let (azimuth, elevation) = (self.azimuth.to_radians(), self.elevation.to_radians());
        let towards =
            V3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        let right = V3::new(azimuth.cos(), 0.0, -azimuth.sin());
        [right, towards.cross(&right), towards]
    }
}

/// Which values the ends of a colour map stand for.
#[derive(Clone, Copy, Debug)]
pub(super) enum ValueRange {
    /// The 2nd and 98th percentile.
    Auto,
    /// These.
    Fixed(f64, f64),
}

impl ValueRange {
    /// The values for a field.
    pub(super) fn of(self, values: &[f64]) -> (f64, f64) {
        let (low, high) = match self {
            Self::Auto => value_range(values, 0.02, 0.98),
            Self::Fixed(low, high) => (low, high),
        };
        // A field of both signs has 0 in the middle.
        let most = high.max(-low);
        if low < 0.0 && high > 0.0 { (-most, most) } else { (low, high) }
    }
}

/// The colours of a shape.
pub(super) enum Paint<'a> {
    /// One for all.
    Plain([u8; 3]),
    /// One a vertex.
    Colors(&'a [[u8; 3]]),
    /// By a field: viridis, or a map of two colours centred on 0 where there are values of both signs.
    Field(&'a [f64], ValueRange),
}

impl Paint<'_> {
    fn colors(&self, n_vertices: usize) -> Vec<[u8; 3]> {
        match *self {
            Self::Plain(color) => vec![color; n_vertices],
            Self::Colors(colors) => colors.to_vec(),
            Self::Field(values, range) => {
                let (low, high) = range.of(values);
                let both_signs = low < 0.0 && high > 0.0;
                let map = ColorMap::from_name(if both_signs { "red-blue" } else { "viridis" });
                let map = map.expect("one of the named maps");
                // Red for what is above 0.
                let (from, to) = if both_signs { (high, low) } else { (low, high) };
                let span = if from == to { 1.0 } else { to - from };
                values.iter().map(|v| map.color((v - from) / span)).collect()
            }
        }
    }
}

/// A ball that marks a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub(super) center: [f64; 3],
    pub(super) radius: f64,
    pub(super) color: [u8; 3],
}

/// One shape; without triangles its points are drawn as balls as large as their spacing.
pub(super) struct Panel<'a> {
    pub(super) points: &'a [[f64; 3]],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) paint: Paint<'a>,
    pub(super) balls: &'a [Ball],
}

/// Whether all panels have one scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    /// So that all shapes fit.
    Same,
    /// Each shape fills its panel.
    Own,
}

/// Samples a pixel along each axis.
const SAMPLES: usize = 2;
/// The part of a panel that the shape fills.
const FILLED: f64 = 0.9;
/// Light that comes from everywhere.
const AMBIENT: f64 = 0.35;

/// Panels of `size` × `size` pixels in rows of `columns`, as PNG.
pub(super) fn sheet(
    panels: &[Panel<'_>],
    columns: usize,
    scale: Scale,
    view: View,
    size: u32,
) -> image::ImageResult<Vec<u8>> {
    let axes = view.axes();
    let onto = |p: &[f64; 3]| axes.map(|axis| axis.dot(&V3::from(*p)));
    let seen: Vec<Vec<[f64; 3]>> =
        panels.par_iter().map(|panel| panel.points.iter().map(onto).collect()).collect();
    let all = extent(seen.iter().flatten());
    let pictures: Vec<RgbImage> = panels
        .par_iter()
        .zip(&seen)
        .map(|(panel, points)| {
            let box_of = if scale == Scale::Same { all } else { extent(points) };
            draw(panel, points, &onto, box_of, size)
        })
        .collect();
    let n_rows = panels.len().div_ceil(columns) as u32;
    let mut sheet = RgbImage::from_pixel(size * columns as u32, size * n_rows, Rgb([255; 3]));
    for (k, picture) in pictures.iter().enumerate() {
        let (column, row) = ((k % columns) as i64, (k / columns) as i64);
        image::imageops::replace(&mut sheet, picture, column * i64::from(size), row * i64::from(size));
    }
    let mut png = std::io::Cursor::new(Vec::new());
    sheet.write_to(&mut png, ImageFormat::Png)?;
    Ok(png.into_inner())
}

/// The smallest and largest coordinates across and up.
fn extent<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> [[f64; 2]; 2] {
    let start = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    points.into_iter().fold(start, |b, p| [0, 1].map(|c| [b[c][0].min(p[c]), b[c][1].max(p[c])]))
}

/// Depth and colour of every sample.
struct Canvas {
    side: usize,
    depth: Vec<f64>,
    color: Vec<V3>,
}

impl Canvas {
    fn put(&mut self, x: usize, y: usize, depth: f64, color: impl FnOnce() -> V3) {
        let at = y * self.side + x;
        if depth > self.depth[at] {
            self.depth[at] = depth;
            self.color[at] = color();
        }
    }

    /// The samples whose middles lie between.
    fn between(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let bound = |v: f64| v.clamp(0.0, self.side as f64) as usize;
        bound(low.floor())..bound(high.ceil())
    }

    fn triangle(&mut self, corners: [&[f64; 3]; 3], shade: impl Fn([f64; 3]) -> V3) {
        let [a, b, c] = corners.map(|p| Vector2::new(p[0], p[1]));
        let area = (b - a).perp(&(c - a));
        if area == 0.0 || !area.is_finite() {
            return;
        }
        for y in self.between(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y)) {
            for x in self.between(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)) {
                let p = Vector2::new(x as f64 + 0.5, y as f64 + 0.5);
                let (u, v) = ((b - p).perp(&(c - p)) / area, (c - p).perp(&(a - p)) / area);
                let w = [u, v, 1.0 - u - v];
                if w.iter().all(|&w| w >= 0.0) {
                    let depth = (0..3).map(|k| w[k] * corners[k][2]).sum();
                    self.put(x, y, depth, || shade(w));
                }
            }
        }
    }

    fn ball(&mut self, center: &[f64; 3], radius: f64, color: V3) {
        for y in self.between(center[1] - radius, center[1] + radius) {
            for x in self.between(center[0] - radius, center[0] + radius) {
                let (dx, dy) = (x as f64 + 0.5 - center[0], y as f64 + 0.5 - center[1]);
                let height = radius * radius - dx * dx - dy * dy;
                if height > 0.0 {
                    let out = height.sqrt();
                    self.put(x, y, center[2] + out, || lit(color, V3::new(dx, -dy, out)));
                }
            }
        }
    }
}

/// A colour under light from the viewer's upper right; a surface is seen from both sides.
fn lit(color: V3, normal: V3) -> V3 {
    let light = V3::new(0.3, 0.5, 1.0).normalize();
    let normal = normal.try_normalize(0.0).unwrap_or(V3::z());
    let facing = if normal.z < 0.0 { -normal } else { normal };
    color * (AMBIENT + (1.0 - AMBIENT) * facing.dot(&light).max(0.0))
}

fn draw(
    panel: &Panel<'_>,
    points: &[[f64; 3]],
    onto: &impl Fn(&[f64; 3]) -> [f64; 3],
    [across, up]: [[f64; 2]; 2],
    size: u32,
) -> RgbImage {
    let side = size as usize * SAMPLES;
    let widest = (across[1] - across[0]).max(up[1] - up[0]);
    let scale = if widest > 0.0 { FILLED * side as f64 / widest } else { 1.0 };
    let (x, y, half) = (0.5 * (across[0] + across[1]), 0.5 * (up[0] + up[1]), 0.5 * side as f64);
    let place = |p: &[f64; 3]| [half + scale * (p[0] - x), half - scale * (p[1] - y), scale * p[2]];
    let placed: Vec<[f64; 3]> = points.iter().map(place).collect();
    let color: Vec<V3> =
        panel.paint.colors(points.len()).iter().map(|c| V3::from(c.map(f64::from))).collect();
    let mut canvas = Canvas {
        side,
        depth: vec![f64::NEG_INFINITY; side * side],
        color: vec![V3::repeat(255.0); side * side],
    };
    let normals: Vec<V3> = vertex_normals(points, panel.triangles).into_iter().map(V3::from).collect();
    for t in panel.triangles {
        let [a, b, c] = t.map(|v| v as usize);
        canvas.triangle([&placed[a], &placed[b], &placed[c]], |w| {
            let mix = |of: &[V3]| of[a] * w[0] + of[b] * w[1] + of[c] * w[2];
            lit(mix(&color), mix(&normals))
        });
    }
    if panel.triangles.is_empty() {
        // As if the points were spread evenly over twice the area that is seen.
        let area = (across[1] - across[0]) * (up[1] - up[0]);
        let radius = 0.85 * scale * (area / points.len().max(1) as f64).sqrt();
        placed.iter().zip(&color).for_each(|(p, color)| canvas.ball(p, radius, *color));
    }
    for ball in panel.balls {
        canvas.ball(&place(&onto(&ball.center)), scale * ball.radius, V3::from(ball.color.map(f64::from)));
    }
    RgbImage::from_fn(size, size, |x, y| {
        let mut sum = V3::zeros();
        for k in 0..SAMPLES * SAMPLES {
            let (dx, dy) = (k % SAMPLES, k / SAMPLES);
            sum += canvas.color[(y as usize * SAMPLES + dy) * side + x as usize * SAMPLES + dx];
        }
        Rgb((sum / (SAMPLES * SAMPLES) as f64).map(|c| c.round().clamp(0.0, 255.0) as u8).into())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nearer_hides_what_is_behind() {
        let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let ball = |z: f64| Ball { center: [0.0, -0.5, z], radius: 0.2, color: [0, 255, 0] };
        let front = View { azimuth: 0.0, elevation: 0.0 };
        let green_at_the_ball = |z: f64| {
            let balls = [ball(z)];
            let paint = Paint::Plain([255, 0, 0]);
            let panel = Panel { points: &points, triangles: &[[0, 1, 2]], paint, balls: &balls };
            let png = sheet(&[panel], 1, Scale::Own, front, 60).unwrap();
            let picture = image::load_from_memory(&png).unwrap().to_rgb8();
            assert_eq!(picture.get_pixel(0, 0).0, [255; 3], "the background");
            let pixel = picture.get_pixel(30, 43).0;
            pixel[1] > pixel[0]
        };
        assert!(green_at_the_ball(1.0) && !green_at_the_ball(-1.0));
    }

    #[test]
    fn a_field_of_both_signs_is_white_at_zero_and_red_above() {
        let colors = Paint::Field(&[-1.0, 0.0, 1.0], ValueRange::Fixed(-1.0, 1.0)).colors(3);
        assert!(colors[2][0] > colors[2][2] && colors[0][2] > colors[0][0]);
        assert!(colors[1].iter().all(|&c| c > 230), "{:?}", colors[1]);
    }
}
