//! Rendering of a surface to a picture.

use crate::camera::Camera;
use crate::color_bar;
use crate::color_range::ColorScale;
use crate::error::RenderError;
use crate::framed::FramedSurface;
use crate::layout::Layout;
use crate::occlusion::DepthBuffer;
use crate::params::{Background, Framing, RenderParams};
use crate::picture::Picture;
use crate::raster::{Bins, NOTHING, TILE, TileSamples};
use crate::scene::Scene;
use crate::shade::{to_byte, to_linear};
use crate::splats::Splats;
use crate::surface::{Ball, Paint, Surface, check_balls};
use crate::vector::Direction;
use adwave::vector::Vector;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Radius of ambient occlusion, in diagonals of the visible shape.
const OCCLUSION_REACH: f32 = 0.07;

/// Number of triangles or discs drawn between two checks of the progress handle.
const CHECK_INTERVAL: usize = 4096;

/// Renders a surface and balls, framed as large as possible, with a color bar if the surface shows a field.
///
/// O(n + width × height × samples²), in parallel; the result is bit-identical on any number of threads.
///
/// # Errors
///
/// A [`RenderError`] for sizes, views and parameters out of range, for a surface without points, for coordinates that
/// are not finite, for triangles or paint that do not match the vertices, and on cancellation.
///
/// ```
/// use adwave::Progress;
/// use adwave_render::{Background, Paint, RenderParams, Surface, render};
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let surface = Surface { points: &points, triangles: &[[0, 1, 2]], paint: Paint::CLAY };
/// let params = RenderParams::default().with_size(64, 48).with_background(Background::Transparent);
/// let picture = render(&surface, &[], &params, Progress::none()).unwrap();
/// assert_eq!(picture.pixel(0, 0)[3], 0);
/// ```
pub fn render(
    surface: &Surface,
    balls: &[Ball],
    params: &RenderParams,
    progress: Progress<'_>,
) -> Result<Picture, RenderError> {
    params.check()?;
    surface.check()?;
    check_balls(balls)?;
    let framed = FramedSurface::new(surface, params.frame);
    let surface = &framed.surface();
    let subject = PreparedSurface::new(surface, balls, progress)?;
    let scale = subject.scale();
    let layout = Layout::new(params, scale.as_ref().zip(subject.label()), None);
    let camera = Camera::fit(&subject.framed, params, layout.stage, progress)?;
    let mut picture = subject.picture(&camera, scale.as_ref(), params, progress)?;
    keep_room(&mut picture, [0, 0], layout.room, params);
    if let (Some(scale), Some(bar)) = (&scale, &layout.bar) {
        color_bar::draw(&mut picture, bar, scale);
    }
    Ok(picture)
}

/// Clears the pixels outside the area from `low` (inclusive) to `high` (exclusive), which belong to color bar and
/// caption. A zoomed shape extends beyond its area.
pub(crate) fn keep_room(picture: &mut Picture, low: [u32; 2], high: [u32; 2], params: &RenderParams) {
    if params.framing == Framing::default() {
        return;
    }
    let empty = params.background.pixel();
    let width = picture.width as usize;
    for (k, pixel) in picture.rgba.chunks_exact_mut(4).enumerate() {
        let inside = |c: usize, at: usize| (low[c] as usize..high[c] as usize).contains(&at);
        if !(inside(0, k % width) && inside(1, k / width)) {
            pixel.copy_from_slice(&empty);
        }
    }
}

/// Surface with the parts of its picture that do not depend on the camera.
pub(crate) struct PreparedSurface<'a> {
    pub(crate) surface: &'a Surface<'a>,
    pub(crate) balls: &'a [Ball],
    pub(crate) splats: Option<Splats>,
    /// Balls that the camera frames, as centers and radii in model units.
    pub(crate) framed: Vec<(Vector, f64)>,
}

impl<'a> PreparedSurface<'a> {
    pub(crate) fn new(
        surface: &'a Surface<'a>,
        balls: &'a [Ball],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let points = surface.points;
        let seen = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            a != b && b != c && c != a
        };
        let mut used = vec![false; points.len()];
        for &v in surface.triangles.iter().filter(seen).flatten() {
            used[v as usize] = true;
        }
        // A mesh whose triangles all have no area is still visible by its vertices.
        let splats = (!used.contains(&true)).then(|| Splats::new(points, progress)).transpose()?;
        let mut framed: Vec<(Vector, f64)> = match &splats {
            Some(splats) => points.iter().copied().zip(splats.radii.iter().copied()).collect(),
            None => points.iter().zip(&used).filter(|p| *p.1).map(|(p, _)| (*p, 0.0)).collect(),
        };
        framed.extend(balls.iter().map(|b| (b.center, b.radius)));
        progress.check()?;
        Ok(Self { surface, balls, splats, framed })
    }

    /// Color scale of the surface's field; `None` without a field.
    pub(crate) fn scale(&self) -> Option<ColorScale> {
        match &self.surface.paint {
            Paint::Field(field) => Some(ColorScale::from_fields(&[field])),
            _ => None,
        }
    }

    /// Name of the surface's field; `None` without a field.
    pub(crate) fn label(&self) -> Option<&str> {
        match &self.surface.paint {
            Paint::Field(field) => Some(&field.label),
            _ => None,
        }
    }

    /// Draws the picture without color bar and text; `params` must have been checked.
    pub(crate) fn picture(
        &self,
        camera: &Camera,
        scale: Option<&ColorScale>,
        params: &RenderParams,
        progress: Progress<'_>,
    ) -> Result<Picture, Cancelled> {
        let scene = Scene::new(self, camera, scale, params, progress)?;
        let pixels = draw(&scene, camera, params, progress)?;
        // Relative to the whole shape; an enlarged part is shaded like a shape of its own.
        let reach = OCCLUSION_REACH * (camera.pixels_per_unit() / params.framing.zoom.max(1.0)) as f32;
        let front = DepthBuffer {
            width: params.width as usize,
            height: params.height as usize,
            depth: pixels.iter().map(|p| p.depth).collect(),
            normal: pixels.iter().map(|p| p.normal).collect(),
        };
        let light = front.light(reach.clamp(2.0, 400.0), scene.kind(), progress)?;
        let mut rgba = vec![0; pixels.len() * 4];
        rgba.par_chunks_exact_mut(4).with_min_len(4096).enumerate().for_each(|(k, out)| {
            out.copy_from_slice(&resolve(&pixels[k], light[k], params.background));
        });
        progress.check()?;
        Ok(Picture { width: params.width, height: params.height, rgba })
    }
}

/// Color and depth of a pixel.
#[derive(Clone, Copy)]
struct Pixel {
    /// Linear color, averaged over the samples.
    color: [f32; 3],
    coverage: f32,
    depth: f32,
    normal: Direction,
}

const EMPTY: Pixel = Pixel { color: [0.0; 3], coverage: 0.0, depth: f32::NEG_INFINITY, normal: [0.0; 3] };

fn draw(
    scene: &Scene,
    camera: &Camera,
    params: &RenderParams,
    progress: Progress<'_>,
) -> Result<Vec<Pixel>, Cancelled> {
    let (width, height) = (params.width as usize, params.height as usize);
    let n_tiles = [width.div_ceil(TILE), height.div_ceil(TILE)];
    let bins = Bins::new(scene.n_primitives(), n_tiles, |k| scene.pixel_box(k), progress)?;
    let samples = params.samples as usize;
    let tiles: Vec<Vec<Pixel>> = (0..n_tiles[0] * n_tiles[1])
        .into_par_iter()
        .map(|t| {
            if bins.primitives(t).is_empty() {
                return Ok(Vec::new());
            }
            let mut tile = TileSamples::new(t % n_tiles[0], t / n_tiles[0], samples);
            for chunk in bins.primitives(t).chunks(CHECK_INTERVAL) {
                progress.check()?;
                for &k in chunk {
                    scene.draw(k, &mut tile);
                }
            }
            Ok((0..TILE * TILE).map(|p| pixel(scene, camera, &tile, samples, p % TILE, p / TILE)).collect())
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut pixels = vec![EMPTY; width * height];
    pixels.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (tile_x, part) in row.chunks_mut(TILE).enumerate() {
            let tile = &tiles[y / TILE * n_tiles[0] + tile_x];
            if !tile.is_empty() {
                let from = y % TILE * TILE;
                part.copy_from_slice(&tile[from..from + part.len()]);
            }
        }
    });
    Ok(pixels)
}

/// Mean color, depth and normal over a pixel's samples; samples of one primitive are shaded once, at their mean
/// position.
fn pixel(scene: &Scene, camera: &Camera, tile: &TileSamples, samples: usize, x: usize, y: usize) -> Pixel {
    let mut ids = [NOTHING; 16];
    let mut middle = [(0.0_f32, 0.0_f32, 0.0_f32, 0.0_f32); 16];
    let mut n = 0;
    for sy in y * samples..(y + 1) * samples {
        for sx in x * samples..(x + 1) * samples {
            let at = sy * tile.side + sx;
            let id = tile.id[at];
            if id == NOTHING {
                continue;
            }
            let k = ids[..n].iter().position(|&known| known == id).unwrap_or_else(|| {
                ids[n] = id;
                n += 1;
                n - 1
            });
            let m = &mut middle[k];
            *m = (m.0 + sx as f32 + 0.5, m.1 + sy as f32 + 0.5, m.2 + 1.0, m.3 + tile.near[at]);
        }
    }
    if n == 0 {
        return EMPTY;
    }
    let total = (samples * samples) as f32;
    let depth_of = |m: &(f32, f32, f32, f32)| camera.depth_in_pixels(f64::from(m.3 / m.2)) as f32;
    let depth = middle[..n].iter().map(depth_of).fold(f32::NEG_INFINITY, f32::max);
    let mut found = Pixel { depth: 0.0, ..EMPTY };
    let mut weight = 0.0;
    for (id, m) in ids[..n].iter().zip(&middle[..n]) {
        let shaded = scene.shade(*id, tile.left as f32 + m.0 / m.2, tile.top as f32 + m.1 / m.2);
        for c in 0..3 {
            found.color[c] += shaded.color[c] * m.2 / total;
        }
        found.coverage += m.2 / total;
        // Only the foremost surface counts: a mean with the surface behind would float between the two.
        let own = depth_of(m);
        if own > depth - 3.0 {
            weight += m.2;
            found.depth += m.2 * own;
            for c in 0..3 {
                found.normal[c] += m.2 * shaded.normal[c];
            }
        }
    }
    found.depth /= weight;
    found.normal = crate::vector::facing_unit(&found.normal);
    found
}

fn resolve(pixel: &Pixel, light: f32, background: Background) -> [u8; 4] {
    let covered = pixel.color.map(|c| c * light);
    match background {
        Background::Color(color) => {
            let behind = to_linear(color);
            if pixel.coverage <= 0.0 {
                return [color[0], color[1], color[2], 255];
            }
            // Each color is converted to byte range before blending, so that a bright surface does not bleed over its
            // edge.
            let mix = |c: usize| {
                let front = to_linear([to_byte(covered[c] / pixel.coverage); 3])[0];
                let light = pixel.coverage * front + (1.0 - pixel.coverage) * behind[c];
                crate::shade::to_byte_exact(light)
            };
            [mix(0), mix(1), mix(2), 255]
        }
        Background::Transparent => {
            if pixel.coverage <= 0.0 {
                return [0; 4];
            }
            let [r, g, b] = covered.map(|c| to_byte(c / pixel.coverage));
            [r, g, b, (pixel.coverage * 255.0).round() as u8]
        }
    }
}
