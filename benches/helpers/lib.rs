//! Functions shared by several programs: meshes to measure on, noise for them, and the memory bandwidth.

mod noise;
mod triangles;
pub mod truth;

pub use noise::Noise;
pub use triangles::Triangles;

use rayon::prelude::*;
use std::time::Instant;

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
