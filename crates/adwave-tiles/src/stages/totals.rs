//! Statistics of whole levels from sums over blocks, added in the order of the blocks, so that they do not depend on
//! the tiles.

use std::ops::Range;

use adwave::bands::Schedule;
use adwave::operator::LocalOperator;
use serde::{Deserialize, Serialize};

use crate::error::TilesError;
use crate::params::{MapKind, Params};
use crate::vector::length;

/// Sums over the vertices of a block.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct BlockSums {
    pub(crate) n_points: u64,
    /// Sums over the distances that the vertices moved.
    pub(crate) moved: NormSums,
    /// Number of vertices that moved farther than noise explains.
    #[serde(default)]
    pub(crate) n_far: u64,
    /// Sums over the norms of each computed band.
    pub(crate) bands: Vec<NormSums>,
    pub(crate) steps: StepSums,
}

/// Sums over the norms l of vectors, in units of the layout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NormSums {
    /// Σ l.
    sum: f64,
    /// Σ l².
    squares: f64,
    max: f64,
    /// Σ l·ln(l/E).
    logarithms: f64,
}

impl NormSums {
    /// Sums over the norms of `vectors`; `mean_length` is E, in the same units.
    pub(crate) fn from_vectors(vectors: &[[f64; 3]], mean_length: f64) -> Self {
        let mut sums = Self::default();
        let scale = if mean_length > 0.0 { mean_length.recip() } else { 1.0 };
        for v in vectors {
            let l = length(*v);
            sums.sum += l;
            sums.squares += l * l;
            sums.max = sums.max.max(l);
            if l > 0.0 {
                sums.logarithms += l * (l * scale).ln();
            }
        }
        sums
    }

    fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.squares += other.squares;
        self.max = self.max.max(other.max);
        self.logarithms += other.logarithms;
    }

    /// mean(r·ln r) with r = l/mean over `n` vectors: the entropy of n equal shares minus the entropy of the shares of
    /// the norms.
    fn unevenness(&self, n: f64, mean_length: f64) -> f64 {
        let scale = if mean_length > 0.0 { mean_length } else { 1.0 };
        (self.logarithms / self.sum - (self.sum / n / scale).ln()).max(0.0)
    }
}

/// Number of vertices with neighbors, and sums over their mean squared step lengths, weighted by the stationary
/// distribution of the walk (eq. 10).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepSums {
    /// Number of vertices with neighbors: the others take no part in statistics of bands.
    #[serde(default)]
    pub(crate) n_members: u64,
    /// The largest ln π, a logarithm that both sums are divided by; `None` if no step leaves any vertex.
    factor: Option<f64>,
    /// Σ π, over the factor.
    weights: f64,
    /// Σ π·s², over the factor; s² is the mean squared length of a step.
    squares: f64,
}

impl StepSums {
    /// Sums over vertices of T whose rows are complete.
    pub(crate) fn from_operator(operator: &LocalOperator, vertices: Range<usize>, n_members: u64) -> Self {
        let log_weight = |x: usize| {
            let row_sum: f64 = operator.rows().row(x).1.iter().sum();
            // π(x) ∝ A(x)·Σ_z T(x,z), T by its rows and the factors that these were divided by (eq. 10).
            operator.areas()[x].ln() + operator.log_factor()[x] + row_sum.ln()
        };
        let log_weights: Vec<f64> = vertices.clone().map(log_weight).collect();
        let factor = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if !factor.is_finite() {
            return Self { n_members, ..Self::default() };
        }
        let mut sums = Self { n_members, factor: Some(factor), ..Self::default() };
        for (x, log_weight) in vertices.zip(log_weights) {
            let weight = (log_weight - factor).exp();
            sums.weights += weight;
            sums.squares += weight * 0.5 * operator.mean_square()[x];
        }
        sums
    }

    fn add(&mut self, other: &Self) {
        self.n_members += other.n_members;
        let Some(theirs) = other.factor else { return };
        let ours = self.factor.unwrap_or(f64::NEG_INFINITY);
        let factor = ours.max(theirs);
        let (ours, theirs) = ((ours - factor).exp(), (theirs - factor).exp());
        self.factor = Some(factor);
        self.weights = self.weights * ours + other.weights * theirs;
        self.squares = self.squares * ours + other.squares * theirs;
    }

    fn step_length(&self) -> f64 {
        if self.weights > 0.0 { (self.squares / self.weights).sqrt() } else { 0.0 }
    }
}

/// Statistics of a band over the whole shape, in model units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LevelSummary {
    /// j, from 1.
    pub level: usize,
    /// Width σ_j of the scaling functions.
    pub sigma: f64,
    /// Mean of ‖W_j‖.
    pub mean: f64,
    /// Root mean square of ‖W_j‖.
    pub rms: f64,
    /// Largest ‖W_j‖.
    pub most: f64,
    /// Weight α_j in the saliency map; 0 for skipped levels and without a map.
    pub alpha: f64,
}

/// Statistics of the whole shape.
pub(crate) struct Totals {
    /// Root mean square of the distances moved, and the largest one.
    pub(crate) moved: [f64; 2],
    /// Number of vertices that moved farther than noise explains.
    pub(crate) n_far: u64,
    /// Number of vertices with neighbors; 0 for a job that denoises.
    pub(crate) n_members: u64,
    /// One entry per computed band.
    pub(crate) levels: Vec<LevelSummary>,
}

/// Quantities of the whole shape that totals are computed with.
#[derive(Clone, Copy)]
pub(crate) struct ShapeScale {
    pub(crate) n_vertices: u64,
    /// E, in units of the layout.
    pub(crate) mean_length: f64,
    /// Unit of the layout, in model units.
    pub(crate) unit: f64,
}

impl Totals {
    /// Adds the sums of all blocks, which must come in order.
    pub(crate) fn from_blocks(
        params: &Params,
        blocks: impl IntoIterator<Item = BlockSums>,
        scale: ShapeScale,
    ) -> Result<Self, TilesError> {
        let ShapeScale { n_vertices, mean_length, unit } = scale;
        let computed = params.computed_bands();
        let (mut moved, mut n_far) = (NormSums::default(), 0);
        let mut bands = vec![NormSums::default(); computed.len()];
        let mut steps = StepSums::default();
        for block in blocks {
            moved.add(&block.moved);
            n_far += block.n_far;
            for (sums, band) in bands.iter_mut().zip(&block.bands) {
                sums.add(band);
            }
            steps.add(&block.steps);
        }
        let rms = |sums: &NormSums, n: u64| (sums.squares / n.max(1) as f64).sqrt() * unit;
        let n = steps.n_members.max(1) as f64;
        let sigma = Schedule::dyadic(params.levels)?.sigma(steps.step_length() * unit);
        let level = |(&level, sums): (&usize, &NormSums)| LevelSummary {
            level,
            sigma: sigma[level],
            mean: sums.sum / n * unit,
            rms: rms(sums, steps.n_members),
            most: sums.max * unit,
            alpha: params.saliency.map_or(0.0, |weights| match weights.kind {
                _ if level <= weights.skip => 0.0,
                MapKind::Uniform => 1.0,
                // α_j = (max|W_f(j)| − mean|W_f(j)|)² (eq. 17)
                MapKind::PerLevel => ((sums.max - sums.sum / n) * unit).powi(2),
                // A level that is 0 everywhere contributes nothing.
                MapKind::Normalized | MapKind::Entropy if sums.sum == 0.0 => 0.0,
                MapKind::Normalized => (sums.sum / n * unit).recip(),
                MapKind::Entropy => sums.unevenness(n, mean_length) / (sums.sum / n * unit),
            }),
        };
        Ok(Self {
            moved: [rms(&moved, n_vertices), moved.max * unit],
            n_far,
            n_members: steps.n_members,
            levels: computed.iter().zip(&bands).map(level).collect(),
        })
    }
}
