//! Heat on a grid: a stencil, and all steps at once where every place has data.

use super::lines::{LineKind, Lines, diffuse_axes};
use super::runs::Runs;
use super::steps::RunSteps;
use super::{Axes, MAX_AXES};
use crate::operator::{
    DifferenceSteps, Diffusion, DiffusionError, Leap, Operator, RowOutput, RowWeights, Semigroup,
    SignalBlock, Steps,
};
use crate::rows::{CompressedRows, rows_at_a_time};
use crate::{Cancelled, Progress};
use std::sync::{Arc, OnceLock};

/// Heat on a grid, `exp(−n·τ·L)` after n steps, with `L = Σ_a D_a/h_a²`, the second differences D of each axis and its
/// spacing h. τ is a quarter of the square of the smallest spacing, so that σ² = 4τn, as on a surface and on a curve, and
/// the variance along each axis is 2τn. `Φ₁ = I − L/λ` with `λ = Σ_a 4/h_a²`.
///
/// Constants and sums are kept, and the maximum principle holds, to the accuracy asked. Where every place has data, n steps
/// are one solve along each axis (see [`Leap`]), which costs the same for all n.
#[derive(Clone, Debug)]
pub struct GridHeat {
    axes: Axes,
    /// Places that belong to the data; all if `None`.
    kept: Option<Arc<[bool]>>,
    /// The places with data and their neighbors, for steps that are no leaps.
    runs: Arc<OnceLock<Runs>>,
}

impl GridHeat {
    pub(super) fn new(axes: Axes, kept: Option<Arc<[bool]>>) -> Self {
        Self { axes, kept, runs: Arc::default() }
    }

    fn runs(&self) -> &Runs {
        self.runs.get_or_init(|| {
            let mut weights = [0.0; MAX_AXES];
            self.axes.long().for_each(|axis| weights[axis] = self.weight(axis));
            Runs::new(&self.axes, self.kept.as_deref(), weights)
        })
    }

    /// Weight of a difference along `axis` in `I − Φ₁`.
    fn weight(&self, axis: usize) -> f64 {
        self.side_weight(axis) / (4.0 * self.rate())
    }

    /// Weight of a side along `axis`, 1/h² in units of the smallest spacing.
    fn side_weight(&self, axis: usize) -> f64 {
        (self.axes.finest() / self.axes.spacings[axis]).powi(2)
    }

    /// Time of a step in units of 1/λ, which is also the sum of the weights of one side along each axis.
    fn rate(&self) -> f64 {
        self.axes.long().map(|axis| self.side_weight(axis)).sum::<f64>().max(f64::MIN_POSITIVE)
    }
}

impl Operator for GridHeat {
    fn n_rows(&self) -> usize {
        self.axes.n_places()
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn semigroup(&self) -> Semigroup {
        Semigroup::Heat { rate: self.rate(), dispersion: 0.0 }
    }

    fn step_length(&self) -> f64 {
        self.axes.finest()
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        self.runs().difference(x, n_channels, out, progress)
    }

    fn masked(
        &self,
        masked: &[bool],
        _: &(dyn Fn(usize, usize) -> f64 + Sync + Send),
        _: Progress<'_>,
    ) -> Result<Option<Arc<dyn Operator>>, DiffusionError> {
        if masked.len() != self.n_rows() {
            return Err(DiffusionError::RowCount { n_rows: self.n_rows(), n_vertices: masked.len() });
        }
        let was_kept = |place: usize| self.kept.as_ref().is_none_or(|kept| kept[place]);
        let kept = masked.iter().enumerate().map(|(place, masked)| !masked && was_kept(place)).collect();
        Ok(Some(Arc::new(Self::new(self.axes.clone(), Some(kept)))))
    }

    fn stored_rows(&self, progress: Progress<'_>) -> Result<Option<Arc<Diffusion>>, Cancelled> {
        let (axes, n) = (&self.axes, self.n_rows());
        let is_kept = |place: usize| self.kept.as_ref().is_none_or(|kept| kept[place]);
        let row =
            |sides: &mut Vec<(u32, f64)>, place: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
                let on_axis = |axis: usize| {
                    let sides = axes.sides(axis, place, axes.coordinate(axis, place));
                    sides.into_iter().flatten().map(move |other| (other as u32, self.weight(axis)))
                };
                let is_part = |side: &(u32, f64)| {
                    is_kept(place) && is_kept(side.0 as usize) && side.0 as usize != place
                };
                sides.clear();
                sides.extend(axes.long().flat_map(on_axis).filter(is_part));
                sides.sort_unstable_by_key(|side| side.0);
                // Both sides of a ring of two places are the same place.
                for same in sides.chunk_by(|a, b| a.0 == b.0) {
                    columns.push(same[0].0);
                    weights.push(same.iter().map(|side| side.1).sum());
                }
            };
        let rows = CompressedRows::from_rows(n, rows_at_a_time(n), progress, Vec::new, row)?;
        let (pattern, weights) = rows.into_parts();
        let (length, semigroup) = (self.step_length(), self.semigroup());
        let heat = Diffusion::from_heat_weights(pattern, weights, vec![1.0; n], length, semigroup, progress)?;
        Ok(Some(Arc::new(heat)))
    }

    fn keeps_promises(&self) -> bool {
        true
    }

    fn leap(&self) -> Option<&dyn Leap> {
        self.kept.is_none().then_some(self)
    }

    fn start<'a>(
        &'a self,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Box<dyn Steps + 'a>, Cancelled> {
        if matches!(block.output, RowOutput::Channels) && block.weights == RowWeights::Uniform {
            return Ok(Box::new(RunSteps::new(self.runs(), self.axes.n_places(), &block, progress)?));
        }
        Ok(Box::new(DifferenceSteps::new(self, block, progress)?))
    }
}

impl Leap for GridHeat {
    /// Each axis by sums of the places around each, or by the fewest poles that keep to `accuracy` together: 8, 14 or 16.
    /// O(n · channels) for any number of steps. The bound grows with the number of steps by rounding, up to the time at which nothing but the mean is left.
    fn take_steps(
        &self,
        n_steps: f64,
        x: &[f64],
        n_channels: usize,
        accuracy: f64,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<f64, Cancelled> {
        let own_accuracy = accuracy / self.axes.long().count().max(1) as f64;
        let on_axis = |axis: usize| {
            let kind = if self.axes.is_periodic[axis] { LineKind::Ring } else { LineKind::Even };
            let lines = Lines::new(self.axes.sizes[axis], self.axes.stride(axis) * n_channels, kind);
            let heat = lines.heat(0.25 * n_steps * self.side_weight(axis), own_accuracy);
            (lines, heat)
        };
        let axes: Vec<_> = self.axes.long().map(on_axis).collect();
        if axes.is_empty() {
            out.copy_from_slice(x); // a single place
        }
        diffuse_axes(&axes, x, out, progress)?;
        // Heat never increases the norm, so that the errors add up to their product.
        let bound = axes.iter().fold(0.0, |bound, (_, heat)| bound + heat.error() + bound * heat.error());
        Ok(bound)
    }
}
