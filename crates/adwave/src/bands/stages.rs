//! Long diffusions in stages, so that rounding does not grow with the square of the degree.
//!
//! A rounding error in `T_k(Y)u` reaches `T_{k+m}(Y)u` through `U_m(Y)`, which is m + 1 at eigenvalue 1 of Φ₁. The
//! values that are rounded are as large as u, which a rough signal fills with the fastest modes, so after n steps
//! (degree about √n) the slowest modes carry an error of about `ε·n^1.75` relative to the signal: 1e-9 for n = 10⁵. A
//! recurrence on differences (Reinsch's) has the same error here: it is exact in the slow modes of a scalar, but the
//! entries of `T_k u − T_{k−1} u` are as large as those of u as long as u holds fast modes.
//!
//! So a diffusion of more than [`LONG`] steps is cut at n/[`RATIO`], and again until the first stage is short. The
//! bands up to a cut c are subtracted from the signal, `S = f − Σ W = Φ₁ᶜ f`, and the next stage starts from
//! `(I − Φ₁)S`. Its fast modes have vanished, so its vectors are small where they are rounded, and U_m is bounded by
//! √`RATIO` times the degree of the stage before. The error is then about `100·ε` for every length, at √(1/`RATIO`)
//! more products.

use super::chebyshev::EvaluationInfo;
use super::series::Series;
use super::transform::add;
use super::{BandsError, BandsInfo, Engine, Schedule, Transform};
use crate::Progress;
use crate::operator::Semigroup;
use crate::pages::zeros;
use crate::sparse::copied;

/// Steps (jumps of heat) up to which one stage is accurate.
const LONG: f64 = 4096.0;

/// Ratio of the steps at the end of a stage to those at its start.
const RATIO: f64 = 64.0;

/// Vectors of the size of the signal that stages take beside the results.
pub(super) const EXTRA_VECTORS: u64 = 3;

impl BandsInfo {
    /// Adds the vectors of `len` values that more than one stage takes.
    pub(super) fn with_stages(mut self, n_stages: usize, len: usize) -> Self {
        if n_stages > 1 {
            self.bytes += EXTRA_VECTORS * 8 * len as u64;
        }
        self
    }
}

/// The part of a level that one stage computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// The level, from 0.
    level: usize,
    /// Steps from the start of the stage at which the piece begins and ends.
    steps: [f64; 2],
    /// True if an earlier stage computed the beginning of the level.
    continues: bool,
}

/// Consecutive pieces that start from the same smoothed signal.
pub(super) type Stage = Vec<Piece>;

impl Transform {
    /// The stages of a schedule; a single one unless the diffusion is long.
    pub(super) fn stages(&self, schedule: &Schedule) -> Vec<Stage> {
        let steps = schedule.steps_from_zero();
        let rate = match self.operator().semigroup() {
            Semigroup::Heat { rate, .. } => rate,
            Semigroup::Steps | Semigroup::PlainSteps => 1.0,
        };
        // A part of a fractional power would be a small fractional power, which converges slowly.
        let can_be_cut = self.engine() == Engine::Chebyshev
            && match self.operator().semigroup() {
                Semigroup::Heat { .. } => true,
                Semigroup::Steps => schedule.first_real().is_none(),
                // Modes near −1 last as long as those near 1, so that a stage leaves no smoother signal.
                Semigroup::PlainSteps => false,
            };
        // The slowest modes are few: on a shape of more vertices than steps their error is no part of the norm that
        // counts.
        let long = LONG.max(self.operator().n_rows() as f64);
        let jumps = rate * steps[steps.len() - 1];
        if can_be_cut && jumps > long { cut(&steps, rate) } else { vec![pieces(&steps, 0.0, f64::INFINITY)] }
    }

    /// True if [`stages`](Self::stages) returns more than one stage.
    pub(super) fn is_staged(&self, schedule: &Schedule) -> bool {
        self.stages(schedule).len() > 1
    }

    /// [`wavelets_into`](Self::wavelets_into) in stages.
    ///
    /// All stages but the last take every term that double precision can distinguish, because the next stage starts
    /// from the signal that remains.
    pub(super) fn staged_wavelets(
        &self,
        stages: &[Stage],
        signal: &[f64],
        n_channels: usize,
        wavelets: &mut [&mut [f64]],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        // The next stage starts from what this one leaves, so its rounding would have to be followed through all of
        // them.
        let this = self.in_double();
        let evaluator = self.evaluator(progress)?;
        let mut smoothed = copied(signal, n_channels, progress)?;
        let mut rest_of_level = Vec::new();
        let mut info = EvaluationInfo::default();
        for (k, stage) in stages.iter().enumerate() {
            let is_last = k + 1 == stages.len();
            let series = |i: usize, grid| {
                let series = self.band(&stage[i].steps, grid, evaluator.growth);
                if is_last { series } else { series.without_tail() }
            };
            let continues = stage[0].continues;
            if continues {
                rest_of_level = zeros(signal.len());
            }
            let levels = stage[0].level + usize::from(continues)..=stage[stage.len() - 1].level;
            let mut outs: Vec<&mut [f64]> = Vec::with_capacity(stage.len());
            if continues {
                outs.push(&mut rest_of_level);
            }
            outs.extend(wavelets[levels].iter_mut().map(|w| &mut **w));
            info.add(&this.escalate(evaluator, &smoothed, n_channels, series, &mut outs, progress)?);
            if !is_last {
                for out in &outs {
                    add(-1.0, out, &mut smoothed, n_channels);
                }
            }
            if continues {
                add(1.0, &rest_of_level, wavelets[stage[0].level], n_channels);
            }
        }
        Ok(info)
    }

    /// [`weighted_into`](Self::weighted_into) in stages.
    ///
    /// Every stage takes all terms: parts of a sum may cancel, so the accuracy of each says nothing about that of the
    /// sum.
    pub(super) fn staged_sum(
        &self,
        stages: &[Stage],
        signal: &[f64],
        n_channels: usize,
        factors: &[f64],
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<EvaluationInfo, BandsError> {
        // The next stage starts from what this one leaves, so its rounding would have to be followed through all of
        // them.
        let this = self.in_double();
        let evaluator = self.evaluator(progress)?;
        let growth = evaluator.growth;
        let mut smoothed = copied(signal, n_channels, progress)?;
        let (mut part, mut removed) = (zeros(signal.len()), zeros(signal.len()));
        let mut info = EvaluationInfo::default();
        out.fill(0.0);
        for (k, stage) in stages.iter().enumerate() {
            let is_last = k + 1 == stages.len();
            // The weighted sum, and the part that the stage removes from the signal.
            let series = |i: usize, grid| {
                let bands: Vec<Series> =
                    stage.iter().map(|piece| self.band(&piece.steps, grid, growth)).collect();
                let factors: Vec<f64> =
                    stage.iter().map(|piece| if i == 0 { factors[piece.level] } else { 1.0 }).collect();
                Series::combination(&bands, &factors, growth).without_tail()
            };
            let mut outs: Vec<&mut [f64]> = vec![&mut part];
            if !is_last {
                outs.push(&mut removed);
            }
            info.add(&this.escalate(evaluator, &smoothed, n_channels, series, &mut outs, progress)?);
            add(1.0, &part, out, n_channels);
            if !is_last {
                add(-1.0, &removed, &mut smoothed, n_channels);
            }
        }
        Ok(info)
    }
}

/// Cuts the levels at `total/RATIO`, `total/RATIO²`, … down to [`LONG`] jumps, at the end of a level where one is near.
fn cut(steps: &[f64], rate: f64) -> Vec<Stage> {
    /// Ratio within which a cut moves to an end of a level.
    const NEAR: f64 = 4.0;
    let mut starts = Vec::new();
    let mut start = steps[steps.len() - 1];
    while rate * start > LONG {
        start /= RATIO;
        let off = |end: &f64| (end / start).ln().abs();
        let near = steps[1..].iter().copied().filter(|end| off(end) <= NEAR.ln());
        // Walks take whole steps; only heat of many jumps per step is cut before the first.
        let cut = if start < 1.0 { start } else { start.ceil() };
        let end = near.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(cut);
        starts.push(end);
    }
    starts.push(0.0);
    starts.reverse();
    starts.dedup();
    let ends = starts[1..].iter().copied().chain([f64::INFINITY]);
    starts.iter().zip(ends).map(|(&start, end)| pieces(steps, start, end)).collect()
}

/// The pieces of levels between `start` and `end` steps.
fn pieces(steps: &[f64], start: f64, end: f64) -> Stage {
    let piece = |(level, pair): (usize, &[f64])| {
        let (from, to) = (pair[0].max(start), pair[1].min(end));
        (from < to).then_some(Piece { level, steps: [from - start, to - start], continues: pair[0] < start })
    };
    steps.windows(2).enumerate().filter_map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_cover_every_level_once() {
        let schedules: [&[f64]; 5] = [
            &[0.0, 1e5],
            &[0.0, 1.0, 2.0, 1e9],
            &[0.0, 0.5, 3000.25, 2e5],
            &[0.0, 10.0, 5000.0],
            &[0.0, 1.0, 3.0],
        ];
        let rates = [1.0, 1.0, 1.0, 1.0, 1e6];
        for (steps, rate) in schedules.into_iter().zip(rates) {
            let stages = cut(steps, rate);
            let mut length = vec![0.0; steps.len() - 1];
            let mut start = 0.0;
            for stage in &stages {
                assert!(stage.iter().skip(1).all(|piece| !piece.continues), "{stage:?}");
                assert_eq!(stage[0].steps[0], 0.0, "a stage starts where it says");
                for piece in stage {
                    length[piece.level] += piece.steps[1] - piece.steps[0];
                }
                start += stage[stage.len() - 1].steps[1];
            }
            assert_eq!(start, steps[steps.len() - 1]);
            for (length, pair) in length.iter().zip(steps.windows(2)) {
                assert!((length - (pair[1] - pair[0])).abs() <= 1e-9 * pair[1], "{steps:?}: {length}");
            }
        }
    }

    #[test]
    fn a_cut_falls_on_the_end_of_a_level_where_one_is_near() {
        let dyadic: Vec<f64> = std::iter::once(0.0).chain((0..=16).map(|j| f64::from(1 << j))).collect();
        let stages = cut(&dyadic, 1.0);
        assert_eq!(stages.len(), 2);
        assert_eq!((stages[0].len(), stages[1].len()), (11, 6)); // 2¹⁰ = 2¹⁶/64 is the end of level 11
        assert!(stages.iter().flatten().all(|piece| !piece.continues));
    }
}
