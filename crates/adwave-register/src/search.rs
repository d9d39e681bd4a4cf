//! Search for motions between two shapes.

use crate::consensus::{ConsensusParams, consensus};
use crate::registrand::{RegistrandView, centered_motions, principal_motions};
use crate::shape_features::Landmarks;
use crate::two_way_fit::{RoughFit, precision, two_way_fit};
use crate::{AlignParams, Motion, Registrand, TwoWayFit, align};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Motion that was refined on the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FoundMotion {
    /// Motion from the first shape to the second.
    pub(crate) motion: Motion,
    /// Fit of the surfaces.
    pub(crate) fit: TwoWayFit,
}

/// Starts of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SearchStarts {
    /// Places where bands are extremal, and rotations between the principal axes.
    Surfaces,
    /// The starts of [`Surfaces`](Self::Surfaces), the identity, and a grid of rotations about the centers.
    Everywhere,
}

/// Options of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SearchParams {
    /// True to search for similarities, with a change of size, instead of rigid motions.
    pub scaled: bool,
    /// Starts of the search.
    pub starts: SearchStarts,
    /// Largest number of motions that are compared in full.
    pub equal: usize,
}

impl SearchParams {
    /// Sets [`scaled`](Self::scaled).
    #[must_use]
    pub fn with_scaled(self, scaled: bool) -> Self {
        Self { scaled, ..self }
    }
}

impl Default for SearchParams {
    fn default() -> Self {
        Self { scaled: false, starts: SearchStarts::Surfaces, equal: 16 }
    }
}

/// Result of a search.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionSearch {
    /// Distinct motions, the one with the most information first.
    pub(crate) motions: Vec<FoundMotion>,
    /// Distinct motions of the mirror image of the first shape, found by the same procedure.
    pub(crate) chance: Vec<FoundMotion>,
}

/// Correlation of bands below which a motion is not compared with chance, because it cannot be clear.
const PLAUSIBLE_AGREEMENT: f64 = 0.3;

/// Correlation of bands above which a motion is so plausible that no further starts are tried.
const SURE_AGREEMENT: f64 = 0.6;
/// Largest number of candidates that are refined on more points.
const MAX_CANDIDATES: usize = 16;
/// Step between the samples of a rough fit.
const ROUGH_STEP: usize = 30;
/// Numbers of starts that are tried and of starts that are refined, in rounds: first few, then all.
const BATCHES: [(usize, usize); 3] = [(44, 10), (88, 20), (usize::MAX, 48)];

/// Least gain of the rough fit of an alternative, relative to that of the best motion.
const LEAST_GAIN: f64 = 0.4;
/// Distance from known motions below which a start is not tried again, as a share of the extent.
const NEAR: f64 = 0.05;
/// Largest number of motions whose differences are continued.
const MAX_CONTINUED: usize = 6;
/// Largest number of rounds in which motions are continued.
const CONTINUING_ROUNDS: usize = 3;
/// Number of starts of the landmarks that come before those of the principal axes.
const N_FIRST: usize = 16;

/// Stage of the refinement.
struct RefinementStage {
    /// Number of points of the alignment.
    points: usize,
    /// Number of rounds of the alignment.
    rounds: usize,
    /// Reach of the alignment, as a share of the extent.
    reach: f64,
    /// Step between the samples by which the refined motions are judged.
    step: usize,
    /// Difference below which two refined motions count as one, as a share of the extent.
    distance: f64,
}

/// Stages of the refinement, from many rough motions to few precise ones.
const STAGES: [RefinementStage; 2] = [
    RefinementStage { points: 120, rounds: 6, reach: 0.05, step: 6, distance: 0.01 },
    RefinementStage { points: 300, rounds: 6, reach: 0.02, step: 2, distance: 0.02 },
];
/// Number of rotations of the grid; no rotation is farther than about 40° from one of them.
const N_TURNS: usize = 96;

/// Searches for distinct motions from `first` to `second`, and for those of the mirror image of `first` by the same
/// procedure.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub(crate) fn search_motions(
    first: &Registrand,
    second: &Registrand,
    params: &SearchParams,
    progress: Progress<'_>,
) -> Result<MotionSearch, Cancelled> {
    let target = RegistrandView::new(second);
    let motions = refined_candidates(&RegistrandView::new(first), &target, params, progress)?;
    if !motions.first().is_some_and(|found| found.fit.agreement > PLAUSIBLE_AGREEMENT) {
        return Ok(MotionSearch { motions, chance: Vec::new() });
    }
    let chance = refined_candidates(&RegistrandView::mirrored(first), &target, params, progress)?;
    Ok(MotionSearch { motions, chance })
}

/// Finds candidate motions, the candidate with the most information first. If some of the best starts lead to motions
/// with a high correlation, only those of the other starts that fit roughly as well are tried.
fn refined_candidates(
    first: &RegistrandView<'_>,
    second: &RegistrandView<'_>,
    params: &SearchParams,
    progress: Progress<'_>,
) -> Result<Vec<FoundMotion>, Cancelled> {
    let starts = starts(first, second, params, progress)?;
    let points = first.samples.iter().map(|sample| sample.point).collect();
    let refinement = Refinement { first, second, points, scaled: params.scaled, progress };
    let mut found = Vec::new();
    for (batch, kept) in BATCHES {
        let (tried, left) = starts.split_at(batch.min(starts.len()));
        progress.check()?;
        let rough = refinement.rough_fits(tried);
        let typical = typical_distance(&rough);
        let mut rated: Vec<(f64, Motion)> =
            rough.iter().map(|fit| fit.gain(typical)).zip(tried.iter().copied()).collect();
        rated.sort_by(|a, b| b.0.total_cmp(&a.0));
        found = refinement.refine(rated.into_iter().take(kept).map(|(_, motion)| motion).collect())?;
        if found.first().is_some_and(|found| found.fit.agreement > SURE_AGREEMENT) {
            return refinement.add_alternatives(found, left, typical);
        }
    }
    Ok(found)
}

/// Median over the starts of the median distance, in units of the smaller extent: the distance of a wrong motion, as
/// most are.
fn typical_distance(rough: &[RoughFit]) -> f64 {
    let mut medians: Vec<f64> = rough.iter().map(RoughFit::median).filter(|d| d.is_finite()).collect();
    medians.sort_by(f64::total_cmp);
    medians.get(medians.len() / 2).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

/// Refinement of motions on the surfaces.
struct Refinement<'a> {
    first: &'a RegistrandView<'a>,
    second: &'a RegistrandView<'a>,
    /// Samples of the first shape.
    points: Vec<[f64; 3]>,
    /// True to refine similarities instead of rigid motions.
    scaled: bool,
    progress: Progress<'a>,
}

impl Refinement<'_> {
    fn rough_fits(&self, motions: &[Motion]) -> Vec<RoughFit> {
        let fit = |motion: &Motion| RoughFit::new(self.first, self.second, motion, ROUGH_STEP);
        motions.par_iter().map(fit).collect()
    }

    /// Refines starts on few points, and the best results on more. The motion with the most information comes first.
    fn refine(&self, mut motions: Vec<Motion>) -> Result<Vec<FoundMotion>, Cancelled> {
        let mut found: Vec<FoundMotion> = Vec::new();
        for stage in &STAGES {
            self.progress.check()?;
            let refined: Result<Vec<FoundMotion>, Cancelled> =
                motions.par_iter().map(|start| self.refine_start(start, stage)).collect();
            found = refined?;
            self.sort_distinct(&mut found, stage.distance);
            let n_plausible = found.iter().filter(|found| found.fit.agreement > PLAUSIBLE_AGREEMENT).count();
            let n = n_plausible.clamp(2, MAX_CANDIDATES);
            motions = found.iter().take(n).map(|found| found.motion).collect();
        }
        Ok(found)
    }

    fn refine_start(&self, start: &Motion, stage: &RefinementStage) -> Result<FoundMotion, Cancelled> {
        let (first, second) = (self.first, self.second);
        let extent = (start.scale() * first.shape.extent).min(second.shape.extent);
        let params = AlignParams {
            max_points: stage.points,
            max_rounds: stage.rounds,
            scaled: self.scaled,
            reach: (stage.reach * extent).max(10.0 * precision(first, second, start)),
        };
        let (motion, _) = align(&self.points, &second.shape.surface, *start, &params, self.progress)?;
        Ok(FoundMotion { motion, fit: two_way_fit(first, second, &motion, stage.step) })
    }

    /// Sorts motions by information, and keeps the first of those that differ by at most a share of the extent.
    fn sort_distinct(&self, found: &mut Vec<FoundMotion>, share: f64) {
        found.sort_by(|a, b| b.fit.information.total_cmp(&a.fit.information));
        let mut kept: Vec<FoundMotion> = Vec::new();
        for candidate in found.drain(..) {
            if !self.is_near(&candidate.motion, kept.iter().map(|other| &other.motion), share) {
                kept.push(candidate);
            }
        }
        *found = kept;
    }

    /// True if a motion differs from one of the others by at most a share of the extent.
    fn is_near<'m>(&self, motion: &Motion, others: impl IntoIterator<Item = &'m Motion>, share: f64) -> bool {
        let points: Vec<[f64; 3]> = self.points.iter().copied().step_by(100).collect();
        let least = share * motion.scale() * self.first.shape.extent;
        others.into_iter().any(|other| motion.difference(other, &points) <= least)
    }

    /// Adds motions that may fit as well as the known ones: further starts, and motions that continue a row or a
    /// rotation.
    ///
    /// If m and m′ are known, m′·m⁻¹ brings one part of the second shape onto another part that looks alike; applied
    /// after m′ it leads to the next such part. Only motions whose rough fit is nearly as good as that of the best
    /// motion are refined.
    fn add_alternatives(
        &self,
        mut found: Vec<FoundMotion>,
        starts: &[Motion],
        typical: f64,
    ) -> Result<Vec<FoundMotion>, Cancelled> {
        let mut proposed = starts.to_vec();
        for _ in 0..CONTINUING_ROUNDS {
            self.progress.check()?;
            let plausible = found.iter().filter(|found| found.fit.agreement > SURE_AGREEMENT);
            let plausible: Vec<Motion> = plausible.take(MAX_CONTINUED).map(|found| found.motion).collect();
            let Some(best) = plausible.first() else { break };
            let least = LEAST_GAIN * RoughFit::new(self.first, self.second, best, ROUGH_STEP).gain(typical);
            proposed.extend(continued(&plausible));
            let rough = self.rough_fits(&proposed);
            let rated = rough.iter().map(|fit| fit.gain(typical)).zip(proposed.drain(..));
            let mut rated: Vec<(f64, Motion)> = rated.filter(|(gain, _)| *gain >= least).collect();
            rated.sort_by(|a, b| b.0.total_cmp(&a.0));
            let mut added: Vec<Motion> = Vec::new();
            for (_, motion) in rated {
                let known = found.iter().map(|found| &found.motion).chain(&added);
                if added.len() < MAX_CANDIDATES && !self.is_near(&motion, known, NEAR) {
                    added.push(motion);
                }
            }
            let n_before = found.len();
            if !added.is_empty() {
                found.extend(self.refine(added)?);
                self.sort_distinct(&mut found, STAGES[STAGES.len() - 1].distance);
            }
            if found.len() == n_before {
                break;
            }
        }
        found.truncate(MAX_CANDIDATES);
        Ok(found)
    }
}

/// Composes each motion with the difference of each two.
fn continued(motions: &[Motion]) -> Vec<Motion> {
    let mut continued = Vec::new();
    for (i, from) in motions.iter().enumerate() {
        for (j, to) in motions.iter().enumerate() {
            if i != j {
                let step = from.inverse().then(to);
                continued.extend(motions.iter().map(|motion| motion.then(&step)));
            }
        }
    }
    continued
}

/// Lists the starts of all kinds, the most promising first.
fn starts(
    first: &RegistrandView<'_>,
    second: &RegistrandView<'_>,
    params: &SearchParams,
    progress: Progress<'_>,
) -> Result<Vec<Motion>, Cancelled> {
    let consensus_params = ConsensusParams { scaled: params.scaled, ..ConsensusParams::default() };
    let (landmarks, others) = (first.landmarks(), &second.shape.features);
    let mut starts: Vec<Motion> = Vec::new();
    if params.starts == SearchStarts::Everywhere {
        starts.push(Motion::default());
    }
    let mut lists: Vec<Vec<Motion>> = Vec::new();
    let mut add = |landmarks: &Landmarks| -> Result<(), Cancelled> {
        let found = consensus(landmarks, &others.landmarks, &consensus_params, progress)?;
        lists.push(found.into_iter().map(|found| found.motion).collect());
        Ok(())
    };
    add(&landmarks)?;
    let own = &first.shape.features;
    if own.is_signed && others.is_signed && (own.is_guessed || others.is_guessed) {
        add(&landmarks.flipped())?;
    }
    // The best of both orientations come first, then the principal axes.
    let longest = lists.iter().map(Vec::len).max().unwrap_or(0);
    let ranks =
        |range: std::ops::Range<usize>| range.flat_map(|k| lists.iter().filter_map(move |list| list.get(k)));
    starts.extend(ranks(0..N_FIRST.min(longest)));
    let scale = if params.scaled { (second.shape.area / first.shape.area).sqrt() } else { 1.0 };
    starts.extend(principal_motions(first, second, scale));
    starts.extend(ranks(N_FIRST.min(longest)..longest));
    if params.starts == SearchStarts::Everywhere {
        starts.extend(centered_motions(first, second, &rotation_grid(N_TURNS)));
    }
    Ok(starts)
}

/// Rotation vectors that cover all rotations evenly, along a spiral; n vectors in radians.
///
/// Source: `alexa2022`.
fn rotation_grid(n: usize) -> Vec<[f64; 3]> {
    const PSI: f64 = 1.533_751_168_755_204_3;
    let turn = |i: usize| {
        let s = i as f64 + 0.5;
        let (r, rest) = ((s / n as f64).sqrt(), (1.0 - s / n as f64).sqrt());
        let (a, b) = (std::f64::consts::TAU * s / std::f64::consts::SQRT_2, std::f64::consts::TAU * s / PSI);
        let (x, y, z, w) = (r * a.sin(), r * a.cos(), rest * b.sin(), rest * b.cos());
        let length = (x * x + y * y + z * z).sqrt().max(f64::MIN_POSITIVE);
        let angle = 2.0 * length.atan2(w);
        [x, y, z].map(|c| c * angle / length)
    };
    (0..n).map(turn).collect()
}
