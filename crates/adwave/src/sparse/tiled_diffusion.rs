//! The diffusion operator prepared for many products.

use super::kernel::{InstructionSet, MAX_DEPTH, VectorNumber};
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
    /// Memory of the recurrences in double and in single precision.
    pub(super) double: VectorPool<f64>,
    pub(super) single: VectorPool<f32>,
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
        let (target, double, single) =
            (InstructionSet::detect(), VectorPool::default(), VectorPool::default());
        Ok(Self { diffusion, tiles, own, depth, target, n_around, double, single })
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

    /// True if the recurrence overwrites its vectors; false if the tiles have more values around them than two vectors
    /// hold.
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

    /// Bytes of memory of a recurrence of `width` channels in the number format `T`.
    pub(crate) fn vector_bytes<T>(&self, width: usize) -> u64 {
        let around = self.n_around.min(2 * self.n_vertices());
        (size_of::<T>() * (2 * self.n_vertices() + around) * width) as u64
    }

    pub(crate) fn steps_per_pass(&self) -> usize {
        self.depth
    }
}

/// Number of rows of u that are computed and weighted together.
const ROWS_AT_A_TIME: usize = 2048;

/// Channels of a signal f, n_vertices × `n_channels`, and the power of 2 by which their difference is multiplied; 1 in
/// double precision.
#[derive(Clone, Copy)]
pub(super) struct DifferenceInput<'a> {
    pub(super) signal: &'a [f64],
    pub(super) n_channels: usize,
    /// First channel.
    pub(super) at: usize,
    pub(super) scale: f64,
}

/// Computes `scale·u`, `u = (I − Φ₁)f = Σ_y Φ₁(x,y)·(f(x) − f(y))`, in double precision and rounds it, for as many
/// channels of f as u has; returns `Σ_x weights(x)|scale·u(x)|²` after rounding, and whether any value of u is not 0.
///
/// It is a sum of differences, so u has the relative accuracy of the differences of f and is exactly 0 where f is
/// constant.
pub(super) fn difference<T: VectorNumber>(
    diffusion: &Diffusion,
    weights: &[f64],
    input: DifferenceInput<'_>,
    u: &mut [T],
    progress: Progress<'_>,
) -> Result<(f64, bool), Cancelled> {
    let n = diffusion.n_vertices();
    let width = u.len() / n.max(1);
    let DifferenceInput { signal, n_channels, at, scale } = input;
    let parts = parallel::try_map_rows(u, width, ROWS_AT_A_TIME, progress, |first, u| {
        match (width, n_channels) {
            (1, 1) => difference_rows::<T, 1>(diffusion, signal, scale, first, u),
            (2, 2) => difference_rows::<T, 2>(diffusion, signal, scale, first, u),
            (3, 3) => difference_rows::<T, 3>(diffusion, signal, scale, first, u),
            (4, 4) => difference_rows::<T, 4>(diffusion, signal, scale, first, u),
            _ => {
                let mut sum = vec![0.0; width];
                for (x, u) in (first..).zip(u.chunks_exact_mut(width)) {
                    let row = |x: usize| &signal[x * n_channels + at..][..width];
                    let (columns, values) = diffusion.row(x);
                    sum.fill(0.0);
                    for (&y, w) in columns.iter().zip(values) {
                        for ((sum, here), there) in sum.iter_mut().zip(row(x)).zip(row(y as usize)) {
                            *sum += w * (here - there);
                        }
                    }
                    for (u, &v) in u.iter_mut().zip(&sum) {
                        *u = T::rounded(v, scale);
                    }
                }
            }
        }
        let square = |(u, w): (&[T], &f64)| w * u.iter().map(|v| v.to_f64() * v.to_f64()).sum::<f64>();
        let square: f64 = u.chunks_exact(width).zip(&weights[first..]).map(square).sum();
        (square, u.iter().any(|&v| v.to_f64() != 0.0))
    })?;
    Ok(parts.into_iter().fold((0.0, false), |(sum, moves), (s, m)| (sum + s, moves || m)))
}

fn difference_rows<T: VectorNumber, const D: usize>(
    diffusion: &Diffusion,
    signal: &[f64],
    scale: f64,
    first: usize,
    u: &mut [T],
) {
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
        *u = sum.map(|v| T::rounded(v, scale));
    }
}

/// Best number of steps per pass, where `shares[r]` is the relative size of a tile with r rings; that of its rows
/// is at most [`MAX_SHARE`].
pub(super) fn best_depth(shares: &[f64]) -> usize {
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

/// Memory of recurrences in one number format, kept between calls, so that calls in a loop allocate none.
#[derive(Debug, Default)]
pub(super) struct VectorPool<T> {
    /// Vectors of all vertices.
    spare: Mutex<Vec<Vec<T>>>,
    /// Scratch buffers of threads, taken at the start of a tile and returned after it.
    scratch: Mutex<Vec<Vec<T>>>,
}

impl<T: VectorNumber> VectorPool<T> {
    /// A vector of at least `len` arbitrary values.
    pub(super) fn take(&self, len: usize) -> Vec<T> {
        let mut spare = self.spare.lock().expect("nobody panics with the lock");
        let fits = (0..spare.len())
            .filter(|&at| (len..=2 * len).contains(&spare[at].len()))
            .min_by_key(|&at| spare[at].len());
        let found = fits.map(|at| spare.swap_remove(at));
        drop(spare);
        found.unwrap_or_else(|| zeros(len))
    }

    /// Keeps a vector for a later [`take`](Self::take).
    pub(super) fn give(&self, vector: Vec<T>) {
        self.spare.lock().expect("nobody panics with the lock").push(vector);
    }

    /// Calls `work` with a scratch buffer of `len` arbitrary values.
    pub(super) fn use_scratch<R>(&self, len: usize, work: impl FnOnce(&mut [T]) -> R) -> R {
        let mut scratch = self.scratch.lock().expect("nobody panics with the lock").pop().unwrap_or_default();
        if scratch.len() < len {
            scratch = zeros(len);
        }
        let result = work(&mut scratch);
        self.scratch.lock().expect("nobody panics with the lock").push(scratch);
        result
    }
}
