//! The diffusion operator prepared for many products.

use super::kernel::{InstructionSet, MAX_DEPTH};
use super::tiles::{Tiles, halo_shares};
use crate::operator::Diffusion;
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};
use std::sync::{Arc, Mutex};

/// Number of channels that go through a product together.
pub(crate) const MAX_CHANNELS: usize = 4;

/// Number of interior vertices of a tile of a large operator; with its rings, its vectors and its part of the
/// operator it fills a second-level cache.
const OWN: usize = 8192;

/// Largest size of a tile relative to its interior, which limits the memory.
const MAX_SHARE: f64 = 1.6;

/// A diffusion operator cut into tiles, with the memory that its products need. It is shared by reference; any
/// number of threads may use it at a time.
#[derive(Debug)]
pub(crate) struct TiledDiffusion {
    diffusion: Arc<Diffusion>,
    pub(super) tiles: Tiles,
    pub(super) own: usize,
    depth: usize,
    pub(super) target: InstructionSet,
    /// Number of values around all tiles, per channel.
    pub(super) n_around: usize,
    /// Vectors returned by earlier calls, so that calls in a loop allocate no memory.
    spare: Mutex<Vec<Vec<f64>>>,
    /// Scratch buffers of the threads.
    pub(super) pool: BufferPool,
}

impl TiledDiffusion {
    /// Cuts `diffusion` into tiles. O(entries).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub(crate) fn new(diffusion: Arc<Diffusion>, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let n = diffusion.n_vertices();
        let own = OWN.min(n / 16).max(512);
        let shares = halo_shares(&diffusion, own, MAX_DEPTH, progress)?;
        Self::cut(diffusion, own, best_depth(&shares), progress)
    }

    fn cut(
        diffusion: Arc<Diffusion>,
        own: usize,
        depth: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let tiles = Tiles::new(&diffusion, own, depth, progress)?;
        let n_around = tiles.n_around();
        let (target, spare, pool) = (InstructionSet::detect(), Mutex::default(), BufferPool::default());
        Ok(Self { diffusion, tiles, own, depth, target, n_around, spare, pool })
    }

    /// This operator in tiles of another size.
    #[cfg(test)]
    pub(crate) fn with_tiles(&self, own: usize, depth: usize) -> Self {
        Self::cut(Arc::clone(&self.diffusion), own, depth, Progress::none()).expect("nobody can stop this")
    }

    pub(crate) fn diffusion(&self) -> &Diffusion {
        &self.diffusion
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.diffusion.n_vertices()
    }

    /// True if the recurrence overwrites its vectors, unless the tiles have more values around them than two
    /// vectors hold.
    pub(super) fn is_in_place(&self) -> bool {
        self.n_around <= 2 * self.n_vertices()
    }

    /// Upper bound of the bytes that preparing `diffusion` and a recurrence of `width` channels take, without the
    /// diffusion itself.
    pub(crate) fn forecast_bytes(diffusion: &Diffusion, width: usize) -> u64 {
        let n = diffusion.n_vertices() as u64;
        // Rows are repeated as far as `best_depth` allows, with at most 32 bits per entry and vertex; and two
        // vectors and the values around the tiles, which are less than two more.
        2 * 4 * (diffusion.nnz() as u64) + 4 * 8 * n * width as u64
    }

    /// Bytes of memory beyond the diffusion itself.
    pub(crate) fn bytes(&self) -> u64 {
        self.tiles.bytes()
    }

    /// Bytes of memory of a recurrence of `width` channels.
    pub(crate) fn vector_bytes(&self, width: usize) -> u64 {
        let around = self.n_around.min(2 * self.n_vertices());
        8 * ((2 * self.n_vertices() + around) * width) as u64
    }

    pub(crate) fn steps_per_pass(&self) -> usize {
        self.depth
    }

    /// A vector of at least `len` arbitrary values.
    pub(super) fn take(&self, len: usize) -> Vec<f64> {
        let mut spare = self.spare.lock().expect("nobody panics with the lock");
        let fits = (0..spare.len())
            .filter(|&at| (len..=2 * len).contains(&spare[at].len()))
            .min_by_key(|&at| spare[at].len());
        let found = fits.map(|at| spare.swap_remove(at));
        drop(spare);
        found.unwrap_or_else(|| zeros(len))
    }

    /// Keeps a vector for a later [`take`](Self::take).
    pub(super) fn give(&self, vector: Vec<f64>) {
        self.spare.lock().expect("nobody panics with the lock").push(vector);
    }
}

/// Number of rows of u that are computed and weighted together.
const ROWS_AT_A_TIME: usize = 2048;

/// Computes `u = (I − Φ₁)f = Σ_y Φ₁(x,y)·(f(x) − f(y))` for the channels `at ..` of f, as many as u has; returns
/// `Σ_x weights(x)|u(x)|²`, and whether any value of u is not 0.
///
/// It is a sum of differences, so u has the relative accuracy of the differences of f and is exactly 0 where f is
/// constant.
pub(crate) fn difference(
    diffusion: &Diffusion,
    weights: &[f64],
    signal: &[f64],
    n_channels: usize,
    at: usize,
    u: &mut [f64],
    progress: Progress<'_>,
) -> Result<(f64, bool), Cancelled> {
    let n = diffusion.n_vertices();
    let width = u.len() / n.max(1);
    let parts = parallel::try_map_rows(u, width, ROWS_AT_A_TIME, progress, |first, u| {
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
        let square: f64 = u.chunks_exact(width).zip(&weights[first..]).map(square).sum();
        (square, u.iter().any(|&v| v != 0.0))
    })?;
    Ok(parts.into_iter().fold((0.0, false), |(sum, moves), (s, m)| (sum + s, moves || m)))
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

/// Best number of steps per pass, where `shares[r]` is the relative size of a tile with r rings; that of its rows
/// is at most [`MAX_SHARE`].
fn best_depth(shares: &[f64]) -> usize {
    /// Fixed cost of a pass in units of a step: reading and writing the vectors and the bands.
    const PASS: f64 = 6.0;
    let cost = |depth: usize| {
        let steps: f64 = shares[..depth].iter().sum();
        (steps + PASS * shares[depth - 1]) / depth as f64
    };
    (1..shares.len())
        .take_while(|&depth| depth == 1 || shares[depth - 1] <= MAX_SHARE)
        .min_by(|&a, &b| cost(a).total_cmp(&cost(b)))
        .unwrap_or(1)
}

/// Scratch buffers of threads, taken at the start of a tile and returned after it.
#[derive(Debug, Default)]
pub(super) struct BufferPool(Mutex<Vec<Vec<f64>>>);

impl BufferPool {
    /// Calls `work` with a buffer of `len` arbitrary values.
    pub(super) fn use_free<R>(&self, len: usize, work: impl FnOnce(&mut [f64]) -> R) -> R {
        let mut scratch = self.0.lock().expect("nobody panics with the lock").pop().unwrap_or_default();
        if scratch.len() < len {
            scratch = zeros(len);
        }
        let result = work(&mut scratch);
        self.0.lock().expect("nobody panics with the lock").push(scratch);
        result
    }
}
