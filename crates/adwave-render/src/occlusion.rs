//! Less light in hollows and where things touch: ambient occlusion from the depths of the pixels around.

use crate::raster::Pixel;
use crate::vector::dot_f32;
use rayon::prelude::*;

/// Pixels that are looked at around each, on a spiral.
const N_TAPS: usize = 20;
/// Turns of the spiral, prime to the number of taps.
const N_TURNS: f32 = 7.0;
/// How far, in parts of the picture's shorter side: once for fine relief, once for folds and what touches.
const REACH: [f32; 2] = [0.012, 0.06];
/// The part of the light that a closed hollow loses.
const STRENGTH: f32 = 1.15;
/// Slopes up to this sine do not darken: a smooth surface seen by few pixels has steps of that size.
const BIAS: f32 = 0.08;
/// Pixels on a side of the pattern by which the spiral turns, and of the window that takes it out again.
const PATTERN: usize = 4;

/// Darkens colours by how much of the half space above each pixel is blocked by its surroundings. O(pixels × taps).
///
/// Source: McGuire, Osman, Bukowski and Hennessy, "The alchemy screen-space ambient obscurance algorithm", 2011; with an
/// ordered pattern in place of a random one, so that the same picture has the same bytes.
pub(crate) fn darken(pixels: &mut [Pixel], width: usize, height: usize) {
    let short = width.min(height) as f32;
    let open: Vec<f32> = (0..width * height)
        .into_par_iter()
        .with_min_len(width)
        .map(|at| {
            if pixels[at].coverage == 0.0 {
                return 1.0;
            }
            let blocked: f32 = REACH
                .iter()
                .map(|reach| blocked(pixels, width, height, at, (reach * short).max(2.0)))
                .sum::<f32>()
                / REACH.len() as f32;
            (1.0 - STRENGTH * blocked).clamp(0.0, 1.0)
        })
        .collect();
    let reach = REACH[1] * short;
    let smooth: Vec<f32> = (0..width * height)
        .into_par_iter()
        .with_min_len(width)
        .map(|at| {
            if pixels[at].coverage == 0.0 { 1.0 } else { mean_near(pixels, &open, width, height, at, reach) }
        })
        .collect();
    pixels.par_iter_mut().zip(smooth).for_each(|(pixel, open)| pixel.color = pixel.color.map(|c| c * open));
}

/// How much of the half space above a pixel is blocked within so many pixels, 0 to about 1.
fn blocked(pixels: &[Pixel], width: usize, height: usize, at: usize, reach: f32) -> f32 {
    let (x, y) = (at % width, at / width);
    let own = &pixels[at];
    let turn = ((x % PATTERN) + PATTERN * (y % PATTERN)) as f32 / (PATTERN * PATTERN) as f32;
    let mut sum = 0.0;
    for tap in 0..N_TAPS {
        let part = (tap as f32 + 0.5) / N_TAPS as f32;
        let angle = std::f32::consts::TAU * (part * N_TURNS + turn);
        let (sin, cos) = angle.sin_cos();
        let (dx, dy) = ((part * reach * cos).round(), (part * reach * sin).round());
        let (px, py) = (x as f32 + dx, y as f32 + dy);
        if px < 0.0 || py < 0.0 || px >= width as f32 || py >= height as f32 || (dx == 0.0 && dy == 0.0) {
            continue;
        }
        let other = &pixels[py as usize * width + px as usize];
        if other.coverage == 0.0 {
            continue;
        }
        let v = [dx, -dy, other.depth - own.depth];
        let length = dot_f32(&v, &v).sqrt();
        let rise = dot_f32(&v, &own.normal) / length - BIAS;
        // What is far in front hangs over the place without touching it, and blocks little.
        sum += rise.max(0.0) * (1.0 - (length / (2.0 * reach)).powi(2)).max(0.0);
    }
    2.0 * sum / N_TAPS as f32
}

/// The mean over a window as large as the pattern, over pixels of about the same depth.
fn mean_near(pixels: &[Pixel], open: &[f32], width: usize, height: usize, at: usize, reach: f32) -> f32 {
    let (x, y) = (at % width, at / width);
    let (mut sum, mut weight) = (0.0, 0.0);
    let half = PATTERN / 2;
    for py in y.saturating_sub(half)..(y + half).min(height) {
        for px in x.saturating_sub(half)..(x + half).min(width) {
            let other = py * width + px;
            if pixels[other].coverage > 0.0 && (pixels[other].depth - pixels[at].depth).abs() < 0.3 * reach {
                sum += open[other];
                weight += 1.0;
            }
        }
    }
    if weight > 0.0 { sum / weight } else { open[at] }
}
