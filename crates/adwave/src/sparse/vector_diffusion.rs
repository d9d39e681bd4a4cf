//! Diffusion of directions: one step moves a vector along the entries of a scalar operator and turns it on its way.

use super::vector_recurrence::{VectorRecurrence, VectorTiles};
use crate::laplacian::TangentTurn;
use crate::operator::{
    BlockPrecision, DifferenceSteps, Diffusion, DiffusionError, Invariant, Operator, RowOutput, RowWeights,
    Semigroup, SignalBlock, Steps, typical_difference_of,
};
use crate::parallel;
use crate::{Cancelled, Progress};
use std::sync::{Arc, OnceLock};

/// Largest number of channels that whole vectors take together.
const WHOLE_CHANNELS: usize = 8;

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 2048;

/// `(Φ₁v)(x) = v(x) + Σ_y Φ₁(x,y)·(R_xy v(y) − v(x))` for vectors v of two coordinates, as complex numbers.
///
/// Φ₁(x,y) are the entries of the operator of scalars, and R_xy = e^{isρ} turns the plane at y into that at x; s is the
/// order of the symmetry. |R_xy| ≤ 1, so |Φ₁v| ≤ Φ₁|v|, and the eigenvalues lie in [0, 1] as those of the scalars do.
/// Where two planes have opposite orientations, the vector is mirrored before it is turned.
///
/// Source: `singer2012` for the walk of vectors, `knoppel2013` for s.
#[derive(Clone, Debug)]
pub(crate) struct VectorDiffusion {
    scalars: Arc<Diffusion>,
    /// R_xy of each entry.
    turns: Arc<[TangentTurn]>,
    /// −1 where an entry mirrors the second coordinate, else 1; empty if none does.
    mirrors: Arc<[f64]>,
    /// The operator in tiles, cut by the first call that needs them.
    tiled: OnceLock<Arc<VectorTiles>>,
}

impl VectorDiffusion {
    /// Joins the operator of scalars with a turn for each of its entries, and with the signs of the entries' second
    /// coordinates, if any entry mirrors.
    pub(crate) fn new(scalars: Arc<Diffusion>, turns: Vec<TangentTurn>, mirrors: Vec<f64>) -> Self {
        assert_eq!(turns.len(), scalars.weights().len(), "a turn for each entry");
        assert!(mirrors.is_empty() || mirrors.len() == turns.len(), "a sign for each entry or none");
        Self { scalars, turns: turns.into(), mirrors: mirrors.into(), tiled: OnceLock::new() }
    }

    /// The operator of scalars.
    pub(super) fn scalars(&self) -> &Arc<Diffusion> {
        &self.scalars
    }

    /// R_xy of each entry.
    pub(super) fn turns(&self) -> &[TangentTurn] {
        &self.turns
    }

    /// The operator in tiles. O(entries) for the first call.
    fn tiled(&self, progress: Progress<'_>) -> Result<&VectorTiles, Cancelled> {
        if let Some(tiled) = self.tiled.get() {
            return Ok(tiled);
        }
        // If two threads arrive here at once, one of them works in vain.
        let tiled = Arc::new(VectorTiles::new(self, progress)?);
        Ok(self.tiled.get_or_init(|| tiled))
    }

    /// `|v(x) − R_xy v(y)|²` for the k-th neighbor y of x, the same number from both sides.
    fn squared_difference(&self, vectors: &[[f64; 2]], x: usize, k: usize) -> f64 {
        let entry = self.scalars.neighbors().range(x).start + k;
        let y = self.scalars.neighbors().row(x)[k] as usize;
        let ([c, s], mirror) = (self.turns[entry], self.mirrors.get(entry).copied().unwrap_or(1.0));
        // The way back is the inverse turn; one that mirrors is its own inverse.
        let (here, there, s) = if x < y { (x, y, s) } else { (y, x, -mirror * s) };
        let [u, v] = [vectors[there][0], mirror * vectors[there][1]];
        let apart = [vectors[here][0] - (c * u - s * v), vectors[here][1] - (s * u + c * v)];
        apart[0] * apart[0] + apart[1] * apart[1]
    }

    /// Adds the differences of a row for `N` vectors that lie at `x[row·stride..]`.
    #[inline]
    fn add_row<const N: usize>(&self, row: usize, x: &[f64], stride: usize, out: &mut [f64]) {
        let (columns, weights) = self.scalars.row(row);
        let range = self.scalars.neighbors().range(row);
        let turns = &self.turns[range.clone()];
        let here: &[[f64; 2]] = x[row * stride..][..2 * N].as_chunks().0;
        let mut sum = [[0.0; 2]; N];
        let mut add = |w: f64, [c, s]: TangentTurn, column: u32, mirror: f64| {
            let there: &[[f64; 2]] = x[column as usize * stride..][..2 * N].as_chunks().0;
            for k in 0..N {
                let [u, v] = [there[k][0], mirror * there[k][1]];
                sum[k][0] += w * (here[k][0] - (c * u - s * v));
                sum[k][1] += w * (here[k][1] - (s * u + c * v));
            }
        };
        if self.mirrors.is_empty() {
            for ((&column, &w), &turn) in columns.iter().zip(weights).zip(turns) {
                add(w, turn, column, 1.0);
            }
        } else {
            let mirrors = &self.mirrors[range];
            for (((&column, &w), &turn), &mirror) in columns.iter().zip(weights).zip(turns).zip(mirrors) {
                add(w, turn, column, mirror);
            }
        }
        out[..2 * N].copy_from_slice(sum.as_flattened());
    }
}

impl Operator for VectorDiffusion {
    fn n_rows(&self) -> usize {
        self.scalars.n_vertices()
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        assert!(n_channels.is_multiple_of(2), "two coordinates for each vector");
        parallel::try_visit_rows(out, n_channels, ROWS_AT_A_TIME, progress, |first, rows| {
            for (row, out) in (first..).zip(rows.chunks_exact_mut(n_channels)) {
                let mut at = 0;
                while n_channels - at >= 8 {
                    self.add_row::<4>(row, &x[at..], n_channels, &mut out[at..]);
                    at += 8;
                }
                while at < n_channels {
                    self.add_row::<1>(row, &x[at..], n_channels, &mut out[at..]);
                    at += 2;
                }
            }
        })
    }

    fn is_reversible(&self) -> bool {
        self.scalars.is_reversible()
    }

    fn weights(&self) -> RowWeights<'_> {
        RowWeights::Each(self.scalars.stationary())
    }

    fn semigroup(&self) -> Semigroup {
        self.scalars.semigroup()
    }

    fn step_length(&self) -> f64 {
        self.scalars.step_length()
    }

    fn invariant(&self) -> Invariant {
        Invariant::Nothing
    }

    fn channels_at_place(&self) -> usize {
        2
    }

    fn width(&self, _n_channels: usize, n_left: usize, _precision: BlockPrecision) -> usize {
        // Directions that are mirrored take whole vectors, several together.
        if self.mirrors.is_empty() { 2 } else { n_left.min(WHOLE_CHANNELS) }
    }

    fn bytes(&self, n_channels: usize, _precision: BlockPrecision) -> u64 {
        const VECTORS: usize = 4;
        let width = if self.mirrors.is_empty() { 2 } else { n_channels.min(WHOLE_CHANNELS) };
        let tiles = self.tiled.get().map_or(0, |tiles| tiles.bytes());
        let turns = size_of_val(&self.turns[..]) + size_of_val(&self.mirrors[..]);
        self.scalars.bytes() + tiles + (turns + VECTORS * size_of::<f64>() * width * self.n_rows()) as u64
    }

    fn prepare(&self, progress: Progress<'_>) -> Result<(), Cancelled> {
        if self.mirrors.is_empty() {
            self.tiled(progress)?;
        }
        Ok(())
    }

    fn start<'a>(
        &'a self,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Box<dyn Steps + 'a>, Cancelled> {
        let is_one = block.channels.len() == 2 && matches!(block.output, RowOutput::Channels);
        if is_one && self.mirrors.is_empty() {
            return Ok(Box::new(VectorRecurrence::new(self, self.tiled(progress)?, block, progress)?));
        }
        Ok(Box::new(DifferenceSteps::new(self, block, progress)?))
    }

    fn keeps_promises(&self) -> bool {
        true
    }

    fn weighed_by_guide(
        &self,
        guide: &[f64],
        reach: f64,
        progress: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, Cancelled> {
        let vectors: &[[f64; 2]] = guide.as_chunks().0;
        let squared = |x: usize, k: usize| self.squared_difference(vectors, x, k);
        let square = |x: usize| vectors[x][0] * vectors[x][0] + vectors[x][1] * vectors[x][1];
        let typical = typical_difference_of(self.scalars.neighbors(), squared, square, progress)?;
        // The lengths of steps are not needed.
        let scalars = Diffusion::clone(&self.scalars);
        let scalars = scalars.weigh_by_squares(squared, reach * reach * typical, |_, _| 0.0, progress)?;
        // The entries stay in their places, and with them the turns and the tiles' neighbors, but not their weights.
        let (turns, mirrors) = (Arc::clone(&self.turns), Arc::clone(&self.mirrors));
        Ok(Some(Arc::new(Self { scalars: Arc::new(scalars), turns, mirrors, tiled: OnceLock::new() })))
    }

    fn masked(
        &self,
        masked: &[bool],
        squared_length: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        progress: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        let scalars = self.scalars.remove_masked(masked, squared_length, progress)?;
        let before = self.scalars.neighbors();
        let mut turns = Vec::with_capacity(scalars.weights().len());
        let mut mirrors = Vec::new();
        for x in 0..self.n_rows() {
            let mut at = before.range(x).zip(before.row(x));
            for y in scalars.row(x).0 {
                let (entry, _) = at.find(|(_, column)| *column == y).expect("a mask adds no entries");
                turns.push(self.turns[entry]);
                mirrors.extend(self.mirrors.get(entry));
            }
        }
        Ok(Some(Arc::new(Self::new(Arc::new(scalars), turns, mirrors))))
    }
}
