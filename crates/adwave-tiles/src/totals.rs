//! Numbers of whole levels, from those of blocks: the same however the shape is cut.

use std::ops::Range;

use adwave::bands::Schedule;
use adwave::operator::LocalOperator;
use serde::{Deserialize, Serialize};

use crate::TilesError;
use crate::outputs::length;
use crate::plan::{MapKind, Params};

/// What a block gives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct BlockOutcome {
    pub(crate) n_points: u64,
    /// The distances that its vertices moved.
    pub(crate) moved: LengthSums,
    /// How many moved farther than noise does.
    #[serde(default)]
    pub(crate) n_far: u64,
    /// The lengths of each band that is computed.
    pub(crate) bands: Vec<LengthSums>,
    pub(crate) steps: StepSums,
}

/// Sums over the lengths l of vectors, in units of the layout.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LengthSums {
    sum: f64,
    squares: f64,
    most: f64,
    /// Σ l·ln(l/E).
    logarithms: f64,
}

impl LengthSums {
    /// E is `mean_length`, in the same units.
    pub(crate) fn of(vectors: &[[f64; 3]], mean_length: f64) -> Self {
        let mut sums = Self::default();
        let scale = if mean_length > 0.0 { mean_length.recip() } else { 1.0 };
        for v in vectors {
            let l = length(*v);
            sums.sum += l;
            sums.squares += l * l;
            sums.most = sums.most.max(l);
            if l > 0.0 {
                sums.logarithms += l * (l * scale).ln();
            }
        }
        sums
    }

    fn add(&mut self, other: &Self) {
        self.sum += other.sum;
        self.squares += other.squares;
        self.most = self.most.max(other.most);
        self.logarithms += other.logarithms;
    }

    /// mean(r·ln r) with r = l/mean, over `n` vectors: by how much the entropy of the lengths' shares is below that of equal ones.
    fn unevenness(&self, n: f64, mean_length: f64) -> f64 {
        let scale = if mean_length > 0.0 { mean_length } else { 1.0 };
        (self.logarithms / self.sum - (self.sum / n / scale).ln()).max(0.0)
    }
}

/// Sums over what a step from each vertex is, weighed by the stationary distribution of the walk (eq. 10), up to a factor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepSums {
    /// The logarithm of the factor: the largest ln π; none where no step leaves any vertex.
    factor: Option<f64>,
    /// Σ π and Σ π·s², over the factor; s² is the mean square of the length of a step.
    weights: f64,
    squares: f64,
}

impl Default for StepSums {
    fn default() -> Self {
        Self { factor: None, weights: 0.0, squares: 0.0 }
    }
}

impl StepSums {
    /// Over some of the vertices of T, whose rows are whole.
    pub(crate) fn of(operator: &LocalOperator, vertices: Range<usize>) -> Self {
        let log_weight = |x: usize| {
            let row_sum: f64 = operator.rows().row(x).1.iter().sum();
            // π(x) ∝ A(x)·Σ_z T(x,z), T by its rows and the factors that these were divided by (eq. 10).
            operator.areas()[x].ln() + operator.log_factor()[x] + row_sum.ln()
        };
        let log_weights: Vec<f64> = vertices.clone().map(log_weight).collect();
        let factor = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if !factor.is_finite() {
            return Self::default();
        }
        let mut sums = Self { factor: Some(factor), ..Self::default() };
        for (x, log_weight) in vertices.zip(log_weights) {
            let weight = (log_weight - factor).exp();
            sums.weights += weight;
            sums.squares += weight * 0.5 * operator.mean_square()[x];
        }
        sums
    }

    fn add(&mut self, other: &Self) {
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

/// A band over the whole shape: lengths in model units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelSummary {
    /// j, from 1.
    pub level: usize,
    /// σ_j, how wide the scaling functions are.
    pub sigma: f64,
    /// The mean of ‖W_j‖.
    pub mean: f64,
    /// Its root mean square.
    pub rms: f64,
    /// Its largest value.
    pub most: f64,
    /// α_j, what it counts in the map: 0 of levels that are skipped.
    pub alpha: f64,
}

/// What the blocks of all tiles come to.
pub(crate) struct Totals {
    /// Root mean square and largest of the distances moved.
    pub(crate) moved: [f64; 2],
    /// How many vertices moved farther than noise does.
    pub(crate) n_far: u64,
    /// The bands that are computed.
    pub(crate) levels: Vec<LevelSummary>,
}

impl Totals {
    /// From the blocks in their order, of `n_vertices` in all; `mean_length` (E) in units of the layout, `unit` that of the layout.
    pub(crate) fn of(
        params: &Params,
        outcomes: impl IntoIterator<Item = BlockOutcome>,
        n_vertices: u64,
        mean_length: f64,
        unit: f64,
    ) -> Result<Self, TilesError> {
        let wanted = params.wanted();
        let (mut moved, mut n_far) = (LengthSums::default(), 0);
        let mut bands = vec![LengthSums::default(); wanted.len()];
        let mut steps = StepSums::default();
        for outcome in outcomes {
            moved.add(&outcome.moved);
            n_far += outcome.n_far;
            for (sums, band) in bands.iter_mut().zip(&outcome.bands) {
                sums.add(band);
            }
            steps.add(&outcome.steps);
        }
        let n = n_vertices.max(1) as f64;
        let rms = |sums: &LengthSums| (sums.squares / n).sqrt() * unit;
        let sigma = Schedule::dyadic(params.levels)?.sigma(steps.step_length() * unit);
        let level = |(&level, sums): (&usize, &LengthSums)| LevelSummary {
            level,
            sigma: sigma[level],
            mean: sums.sum / n * unit,
            rms: rms(sums),
            most: sums.most * unit,
            alpha: params.saliency.map_or(0.0, |weights| match weights.kind {
                _ if level <= weights.skip => 0.0,
                MapKind::Uniform => 1.0,
                // α_j = (max|W_f(j)| − mean|W_f(j)|)² (eq. 17)
                MapKind::PerLevel => ((sums.most - sums.sum / n) * unit).powi(2),
                // A level without any response adds nothing.
                MapKind::Normalized | MapKind::Entropy if sums.sum == 0.0 => 0.0,
                MapKind::Normalized => (sums.sum / n * unit).recip(),
                MapKind::Entropy => sums.unevenness(n, mean_length) / (sums.sum / n * unit),
            }),
        };
        Ok(Self {
            moved: [rms(&moved), moved.most * unit],
            n_far,
            levels: wanted.iter().zip(&bands).map(level).collect(),
        })
    }
}
