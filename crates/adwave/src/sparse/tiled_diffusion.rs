//! The walk prepared for many products.

use super::kernel::{MAX_DEPTH, Target, zeros};
use super::tiles::{Tiles, halo_shares};
use crate::operator::Diffusion;
use crate::{Cancelled, Progress};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};

/// Channels that go through a product together.
pub(crate) const MAX_CHANNELS: usize = 4;

/// Own vertices of a tile of a large walk: with its rings, its vectors and its part of the walk it fills a second-level
/// cache.
const OWN: usize = 8192;

/// A walk cut into tiles.
#[derive(Debug)]
pub(crate) struct TiledDiffusion {
    diffusion: Arc<Diffusion>,
    pub(super) tiles: Tiles,
    pub(super) own: usize,
    depth: usize,
    pub(super) target: Target,
    /// Vectors that earlier calls have left, so that calls in a loop take no fresh memory.
    spare: Mutex<Vec<Vec<f64>>>,
}

impl TiledDiffusion {
    /// Cuts `diffusion` into tiles. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] when the call is to stop.
    pub(crate) fn new(diffusion: Arc<Diffusion>, progress: Progress<'_>) -> Result<Self, Cancelled> {
        progress.check()?;
        let n = diffusion.n_vertices();
        let own = OWN.min(n / 16).max(512);
        let shares = halo_shares(&diffusion, own, MAX_DEPTH);
        let depth = best_depth(&shares);
        let tiles = Tiles::new(&diffusion, own, depth);
        Ok(Self { diffusion, tiles, own, depth, target: Target::detect(), spare: Mutex::default() })
    }

    pub(crate) fn diffusion(&self) -> &Diffusion {
        &self.diffusion
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.diffusion.n_vertices()
    }

    /// Bytes of memory that preparing `diffusion` will take, about.
    pub(crate) fn forecast_bytes(diffusion: &Diffusion) -> u64 {
        // Tiles repeat at most as many rows as `best_depth` allows.
        let n = diffusion.n_vertices() as u64;
        2 * (12 * (diffusion.nnz() as u64 - n) + 8 * n)
    }

    /// Bytes of memory taken beyond the diffusion itself.
    pub(crate) fn bytes(&self) -> u64 {
        self.tiles.bytes()
    }

    pub(crate) fn steps_per_pass(&self) -> usize {
        self.depth
    }

    /// A vector of `len` values, whatever they are.
    pub(super) fn take(&self, len: usize) -> Vec<f64> {
        let mut spare = self.spare.lock().expect("nobody panics with the lock");
        let fits = spare.iter().position(|v| v.capacity() >= len && v.capacity() <= 2 * len);
        let found = fits.map(|at| spare.swap_remove(at));
        drop(spare);
        let mut vector = found.unwrap_or_else(|| zeros(len));
        vector.resize(len, 0.0);
        vector
    }

    /// Keeps a vector for a later [`take`](Self::take).
    pub(super) fn give(&self, vector: Vec<f64>) {
        self.spare.lock().expect("nobody panics with the lock").push(vector);
    }
}

/// Rows of u that are computed and weighed together.
const ROWS_AT_A_TIME: usize = 2048;

/// `u = (I − Φ₁)f = Σ_y Φ₁(x,y)·(f(x) − f(y))` for the channels `at ..` of f, as many as u has, and
/// `Σ_x weights(x)|u(x)|²`, and whether any value of u is not 0.
///
/// Of differences, so that u has the relative accuracy of f's differences and is exactly 0 where f is constant.
pub(crate) fn difference(
    diffusion: &Diffusion,
    weights: &[f64],
    signal: &[f64],
    n_channels: usize,
    at: usize,
    u: &mut [f64],
) -> (f64, bool) {
    let width = u.len() / diffusion.n_vertices();
    let parts: Vec<(f64, bool)> = u
        .par_chunks_mut(ROWS_AT_A_TIME * width)
        .enumerate()
        .map(|(chunk, u)| {
            let first = chunk * ROWS_AT_A_TIME;
            match (width, n_channels) {
                (1, 1) => difference_rows::<1>(diffusion, signal, first, u),
                (2, 2) => difference_rows::<2>(diffusion, signal, first, u),
                (3, 3) => difference_rows::<3>(diffusion, signal, first, u),
                (4, 4) => difference_rows::<4>(diffusion, signal, first, u),
                _ => {
                    for (x, u) in (first..).zip(u.chunks_exact_mut(width)) {
                        let row = |x: usize| &signal[x * n_channels + at..][..width];
                        let (columns, values) = diffusion.row(x);
                        u.fill(0.0);
                        for (&y, w) in columns.iter().zip(values) {
                            for ((u, here), there) in u.iter_mut().zip(row(x)).zip(row(y as usize)) {
                                *u += w * (here - there);
                            }
                        }
                    }
                }
            }
            let square = |(u, w): (&[f64], &f64)| w * u.iter().map(|v| v * v).sum::<f64>();
            let square = u.chunks_exact(width).zip(&weights[first..]).map(square).sum();
            (square, u.iter().any(|&v| v != 0.0))
        })
        .collect();
    parts.into_iter().fold((0.0, false), |(sum, moves), (s, m)| (sum + s, moves || m))
}

fn difference_rows<const D: usize>(diffusion: &Diffusion, signal: &[f64], first: usize, u: &mut [f64]) {
    let signal = signal.as_chunks::<D>().0;
    for (x, u) in (first..).zip(u.as_chunks_mut::<D>().0) {
        let (columns, values) = diffusion.row(x);
        let here = signal[x];
        let mut sum = [0.0; D];
        for (&y, w) in columns.iter().zip(values) {
            let there = &signal[y as usize];
            for c in 0..D {
                sum[c] += w * (here[c] - there[c]);
            }
        }
        *u = sum;
    }
}

/// How many steps a tile should take in a pass, where `shares[r]` is the size of a tile with r rings.
fn best_depth(shares: &[f64]) -> usize {
    /// What one pass costs besides its steps, in steps: reading and writing the vectors and the bands.
    const PASS: f64 = 6.0;
    /// No tile is to be larger than this many times its own vertices.
    const LARGEST: f64 = 1.6;
    let cost = |depth: usize| {
        let steps: f64 = shares[..depth].iter().sum();
        (steps + PASS * shares[depth - 1]) / depth as f64
    };
    (1..shares.len())
        .take_while(|&depth| depth == 1 || shares[depth - 1] <= LARGEST)
        .min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
        .unwrap_or(1)
}

/// The scratch of one thread: taken from a pool and given back.
pub(super) struct Pool(Mutex<Vec<Vec<f64>>>);

impl Pool {
    pub(super) fn new() -> Self {
        Self(Mutex::default())
    }

    pub(super) fn with<R>(&self, len: usize, work: impl FnOnce(&mut [f64]) -> R) -> R {
        let mut scratch = self.0.lock().expect("nobody panics with the lock").pop().unwrap_or_default();
        if scratch.len() < len {
            scratch.resize(len, 0.0);
        }
        let result = work(&mut scratch);
        self.0.lock().expect("nobody panics with the lock").push(scratch);
        result
    }
}
