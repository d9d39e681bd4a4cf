//! Functions shared by several programs: meshes to measure on, noise for them, denoising with its defaults, and the
//! memory bandwidth.

mod calibration;
mod noise;
mod triangles;
pub mod truth;

pub use calibration::{CalibrationDot, calibration_svg};
pub use noise::Noise;
pub use triangles::Triangles;

use adwave::Progress;
use adwave::denoise::{DenoiseParams, Denoised, denoise};
use adwave::shape::{PreparedGeometry, Shape, WeldMode};
use rayon::prelude::*;
use std::error::Error;
use std::time::Instant;

/// Outcome of a program that measures; any error ends it.
pub type BenchOutcome<T> = Result<T, Box<dyn Error>>;

/// Denoises a shape with the default parameters.
///
/// # Errors
/// Positions that cannot be prepared or denoised.
pub fn denoise_by_default(shape: &Shape) -> BenchOutcome<Denoised> {
    let geometry = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none())?;
    Ok(denoise(&geometry, &DenoiseParams::default(), Progress::none())?)
}

/// Remainder of the seeds modulo 2 of a half: 0 for `first`, which is for development, and 1 for `second`, which is
/// looked at in the end.
///
/// # Errors
/// Another word.
pub fn seed_parity(half: &str) -> Result<u64, String> {
    match half {
        "first" => Ok(0),
        "second" => Ok(1),
        _ => Err(format!("the half of the seeds must be first or second, got {half}")),
    }
}

/// Bandwidth of `a = b + s·c` in bytes per second, 24 bytes per element, over arrays far larger than the caches: the
/// best of several calls.
pub fn triad() -> f64 {
    const LEN: usize = 1 << 24;
    let (b, c) = (vec![1.0_f64; LEN], vec![2.0_f64; LEN]);
    let mut a = vec![0.0_f64; LEN];
    let mut least = f64::INFINITY;
    for _ in 0..9 {
        let start = Instant::now();
        let parts = a.par_chunks_mut(1 << 16).zip(b.par_chunks(1 << 16)).zip(c.par_chunks(1 << 16));
        parts.for_each(|((a, b), c)| {
            for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                *a = b + 3.0 * c;
            }
        });
        least = least.min(start.elapsed().as_secs_f64());
    }
    assert_eq!(a[LEN / 2], 7.0);
    24.0 * LEN as f64 / least
}
