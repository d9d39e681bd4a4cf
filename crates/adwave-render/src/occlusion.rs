//! Ambient occlusion: points that see little of the sky are darkened, and ridges are slightly brightened.

use crate::vector::{Direction, dot_f32};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Foremost surface at each pixel, row by row.
pub(crate) struct DepthBuffer {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Depth toward the viewer, in pixels; −∞ if the pixel is empty.
    pub(crate) depth: Vec<f32>,
    pub(crate) normal: Vec<Direction>,
}

/// Kind of surface, which selects the shading of ridges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SurfaceKind {
    /// Smooth surface: ridges and creases are emphasized.
    Mesh,
    /// Surface of discs, whose edges are not ridges.
    Cloud,
}

/// Period of the sampling pattern, in pixels, in both directions.
const PERIOD: usize = 4;

/// Number of sampled pixels around each pixel.
const TAPS: usize = 20;

/// Number of turns of the spiral of samples, coprime to [`TAPS`], so that no two samples are collinear with the center.
const TURNS: f32 = 7.0;

/// Strength of the darkening: the light of a pixel is 1 minus twice this factor times the mean obscurance of its
/// samples.
const STRENGTH: f32 = 1.7;

/// Smallest fraction of light of a pixel.
const DARKEST: f32 = 0.2;

/// Weights of the blur from the center to either side; together they cover one period of the pattern, so that it
/// cancels.
const BLUR: [f32; 3] = [1.0, 1.0, 0.5];

/// Strength of the light change at creases and ridges.
const CAVITY: f32 = 0.5;

impl DepthBuffer {
    fn depth_at(&self, x: i32, y: i32) -> Option<(usize, f32)> {
        if x < 0 || y < 0 || x >= self.width as i32 || y >= self.height as i32 {
            return None;
        }
        let k = y as usize * self.width + x as usize;
        (self.depth[k] > f32::NEG_INFINITY).then(|| (k, self.depth[k]))
    }

    /// Computes the fraction of light that reaches each pixel from surroundings of `radius` pixels.
    ///
    /// Source: McGuire, Mara and Luebke, "Scalable ambient obscurance", 2012. A fixed pattern of 4 × 4 pixels replaces
    /// the random rotations, and a depth-aware blur covers exactly that pattern.
    pub(crate) fn light(
        &self,
        radius: f32,
        kind: SurfaceKind,
        progress: Progress<'_>,
    ) -> Result<Vec<f32>, Cancelled> {
        let taps = taps(radius);
        let raw: Vec<f32> = self.map_pixels(progress, |x, y, k| self.openness(x, y, k, radius, &taps))?;
        let near = (0.02 * radius).max(1.5);
        let smooth = |values: &[f32], step: [i32; 2]| {
            self.map_pixels(progress, |x, y, k| {
                let (mut sum, mut weight) = (0.0, 0.0);
                for d in 1 - BLUR.len() as i32..BLUR.len() as i32 {
                    if let Some((other, depth)) = self.depth_at(x + d * step[0], y + d * step[1]) {
                        // Relative to the slope; otherwise slanted surfaces would show the pattern.
                        let slant = (1.0 - self.normal[k][2]).max(0.0) * 4.0 + 1.0;
                        let w = BLUR[d.unsigned_abs() as usize]
                            * (1.0 - (depth - self.depth[k]).abs() / (near * slant)).max(0.0);
                        sum += w * values[other];
                        weight += w;
                    }
                }
                if weight > 0.0 { sum / weight } else { values[k] }
            })
        };
        let smoothed = smooth(&smooth(&raw, [1, 0])?, [0, 1])?;
        match kind {
            SurfaceKind::Mesh => self.map_pixels(progress, |x, y, k| smoothed[k] * self.ridge(x, y, k)),
            SurfaceKind::Cloud => Ok(smoothed),
        }
    }

    /// Computes a value for each covered pixel, and 1 for empty pixels.
    fn map_pixels(
        &self,
        progress: Progress<'_>,
        value: impl Fn(i32, i32, usize) -> f32 + Sync,
    ) -> Result<Vec<f32>, Cancelled> {
        let mut values = vec![1.0; self.depth.len()];
        values.par_chunks_mut(self.width).enumerate().try_for_each(|(y, row)| {
            progress.check()?;
            for (x, v) in row.iter_mut().enumerate() {
                let k = y * self.width + x;
                if self.depth[k] > f32::NEG_INFINITY {
                    *v = value(x as i32, y as i32, k);
                }
            }
            Ok::<(), Cancelled>(())
        })?;
        Ok(values)
    }

    fn openness(&self, x: i32, y: i32, k: usize, radius: f32, taps: &[[[i32; 2]; TAPS]]) -> f32 {
        let n = self.normal[k];
        let square = radius * radius;
        // Flat slanted surfaces must not shade themselves.
        let bias = 0.002 * radius + 0.6;
        let mut sum = 0.0;
        for [dx, dy] in taps[x as usize % PERIOD * PERIOD + y as usize % PERIOD] {
            if let Some((_, depth)) = self.depth_at(x + dx, y + dy) {
                let v = [dx as f32, -dy as f32, depth - self.depth[k]];
                let length = dot_f32(&v, &v);
                if length < square {
                    let up = (dot_f32(&v, &n) - bias).max(0.0);
                    sum += (1.0 - length / square) * up / (length.sqrt() + 0.5);
                }
            }
        }
        (1.0 - 2.0 * STRENGTH * sum / TAPS as f32).clamp(DARKEST, 1.0)
    }

    /// Light factor, above 1 on ridges and below 1 in creases, from the change of the normals between pixels.
    fn ridge(&self, x: i32, y: i32, k: usize) -> f32 {
        let turn = |dx: i32, dy: i32, axis: usize| {
            let pair = (self.depth_at(x + dx, y + dy), self.depth_at(x - dx, y - dy));
            match pair {
                (Some((a, depth_a)), Some((b, depth_b)))
                    if (depth_a - self.depth[k]).abs() < 8.0 && (depth_b - self.depth[k]).abs() < 8.0 =>
                {
                    self.normal[a][axis] - self.normal[b][axis]
                }
                _ => 0.0,
            }
        };
        let curvature = turn(1, 0, 0) - turn(0, 1, 1);
        1.0 + CAVITY * curvature.clamp(-0.8, 0.5)
    }
}

/// Sample offsets for each pixel of the pattern, in pixels: a spiral, rotated slightly from pixel to pixel.
fn taps(radius: f32) -> Vec<[[i32; 2]; TAPS]> {
    let turned = |pixel: usize| {
        // Steps of 11 of 16, so that neighboring pixels differ strongly.
        let phase = (pixel * 11 % (PERIOD * PERIOD)) as f32 / (PERIOD * PERIOD) as f32;
        std::array::from_fn(|tap| {
            let share = (tap as f32 + 0.5) / TAPS as f32;
            let angle = std::f32::consts::TAU * (share * TURNS + phase);
            let reach = 1.0 + share * share * radius;
            [angle.cos(), angle.sin()].map(|c| (c * reach).round() as i32)
        })
    };
    (0..PERIOD * PERIOD).map(turned).collect()
}
