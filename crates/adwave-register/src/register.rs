//! Motions between two shapes, with the evidence for each.

use crate::consensus::agreeing_pairs;
use crate::registrand::RegistrandView;
use crate::search::{FoundMotion, MotionSearch, SearchParams, SearchStarts, search_motions};
use crate::shape_features::keys_of_view;
use crate::two_way_fit::{precision, two_way_fit};
use crate::{AlignParams, Motion, Pair, PairParams, Registrand, TwoWayFit, align, pairs_under};
use adwave::{Cancelled, Progress};

/// Least correlation of the bands of a clear motion.
const MIN_AGREEMENT: f64 = 0.65;
/// Least information of a clear motion, in nats.
const MIN_INFORMATION: f64 = 18.0;
/// Number of places at which a band is extremal below which a motion may be clear without a pair of them: a machined part
/// may have none.
const FEW_PLACES: usize = 6;
/// Least ratio of the information of a clear motion to that of the best motion of the mirror image.
const MIN_GAIN: f64 = 1.4;
/// Largest conflict of a clear motion.
const MAX_CONFLICT: f64 = 0.15;
/// Least information of a candidate that is refined to the end, relative to the best.
const LEAST_SHARE: f64 = 0.15;
/// Number of points with which all candidates are refined; only the best is refined with more.
const REFINED_POINTS: usize = 1200;
/// Number of rounds with which all candidates are refined.
const REFINED_ROUNDS: usize = 60;
/// Number of rounds of the last refinement of the best candidate.
const LAST_ROUNDS: usize = 60;
/// Largest excess of the conflict of an equal motion over that of the best.
const EQUAL_CONFLICT: f64 = 0.02;
/// Largest excess of the cost of an equal motion over that of the best.
const EQUAL_COST: f64 = 0.7;
/// Least information of an equal motion, relative to the best.
const EQUAL_INFORMATION: f64 = 0.15;

/// Least overlap of a fit that is preferred for its cost.
const LEAST_OVERLAP: f64 = 0.3;
/// Largest median distance that is regarded as noise, in multiples of the precision.
const MAX_NOISE: f64 = 5.0;
/// Largest ratio of the distance that 99.5 % of the samples do not exceed to the median distance, if the rest is noise.
const MAX_TAIL: f64 = 6.0;

/// Share of clear motions that are correct, measured on shapes with a known motion (`cargo xtask bench-match`).
pub const CLEAR_CONFIDENCE: f64 = 0.99;

/// Standard deviation of the distance of a pair after a motion from its distance after the true motion, in mean
/// spacings. It is 0.03 to 0.07, depending on σ, for 201 pairs of the seeds `choose` of `cargo xtask bench-match`.
const DISTANCE_DEVIATION: f64 = 0.06;

/// Motion between two shapes with its evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegisteredMotion {
    /// Motion from the first shape to the second.
    pub motion: Motion,
    /// Fit of the surfaces and bands in both directions.
    pub fit: TwoWayFit,
    /// Number of pairs of features within 1 σ after the motion.
    pub n_agreeing: usize,
}

/// Result of a registration.
#[derive(Clone, Debug, Default)]
pub struct Registration {
    /// Motion that fits best, if any was found.
    pub best: Option<RegisteredMotion>,
    /// True if the best motion fits better than chance, as [`register()`] defines it.
    pub is_clear: bool,
    /// Other motions that fit as well as the best; empty if the best is not clear.
    pub equal: Vec<RegisteredMotion>,
    /// All refined candidates, the best included.
    pub candidates: Vec<RegisteredMotion>,
    /// Fit of the best motion of the mirror image of the first shape, found by the same search.
    pub chance: Option<TwoWayFit>,
    /// Number of pairs of features within 1 σ after the best motion of the mirror image.
    pub n_by_chance: usize,
}

impl Registration {
    /// Returns the best motion if it is clear.
    pub fn clear(&self) -> Option<&RegisteredMotion> {
        self.best.as_ref().filter(|_| self.is_clear)
    }

    /// Probability that the best motion is the true one: [`CLEAR_CONFIDENCE`] divided by the number of equal motions,
    /// the best included; 0 if the best is not clear.
    pub fn confidence(&self) -> f64 {
        if self.is_clear { CLEAR_CONFIDENCE / (1 + self.equal.len()) as f64 } else { 0.0 }
    }
}

impl Registration {
    /// Pairs of features within `sigmas` times σ after the best motion, with their confidences; empty if the motion is
    /// not clear.
    pub fn pairs(&self, first: &Registrand, second: &Registrand, sigmas: f64) -> Vec<Pair> {
        let Some(best) = self.clear() else { return Vec::new() };
        let keys = keys_of_view(&first.features.keys, false, best.fit.is_flipped);
        let precision = DISTANCE_DEVIATION * second.spacing;
        let params = PairParams { sigmas, confidence: CLEAR_CONFIDENCE, precision };
        let motions: Vec<Motion> =
            std::iter::once(best).chain(&self.equal).map(|found| found.motion).collect();
        pairs_under(&keys, &second.features.keys, &motions, &params)
    }
}

/// Finds the motion from `first` to `second`, judges if it is better than chance, and lists the motions that fit
/// equally well.
///
/// Candidates come from places where bands are extremal and from rotations about the centers. Each is refined on the
/// surfaces and judged by its fit in both directions: by the distances between partners, and by the correlation between
/// the bands of both shapes. The same search on the mirror image of `first` shows the fit that chance achieves. A
/// motion is clear if its bands correlate, if they carry much more information than those of the mirror image, and if
/// few places contradict it. A shape that equals its own mirror image is judged by correlation and conflict alone.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub fn register(
    first: &Registrand,
    second: &Registrand,
    params: &SearchParams,
    progress: Progress<'_>,
) -> Result<Registration, Cancelled> {
    let MotionSearch { motions, chance } = search_motions(first, second, params, progress)?;
    let (view, target) = (RegistrandView::new(first), RegistrandView::new(second));
    let most = motions.first().map_or(0.0, |found| found.fit.information);
    let is_plausible = |found: &&FoundMotion| {
        found.fit.agreement >= MIN_AGREEMENT && found.fit.information >= LEAST_SHARE * most
    };
    let n_plausible = motions.iter().filter(is_plausible).count();
    let mut refined: Vec<RegisteredMotion> = Vec::new();
    // Without a plausible motion the fit may still serve someone who wants the closest one.
    for found in motions.iter().filter(|found| n_plausible == 0 || is_plausible(found)).take(params.equal) {
        refined.push(if n_plausible == 1 {
            measure(&view, &target, found.motion)
        } else {
            refine(&view, &target, found, params, progress)?
        });
    }
    let by_score = |a: &RegisteredMotion, b: &RegisteredMotion| score(&b.fit).total_cmp(&score(&a.fit));
    refined.sort_by(by_score);
    let mut refined = distinct(refined, first);
    if let Some(best) = refined.first_mut() {
        *best = refine_best(&view, &target, best, params, progress)?;
    }
    let Some((best, others)) = refined.split_first() else { return Ok(Registration::default()) };
    let null = chance.first();
    let [own, other] = [first, second].map(|side| &side.features.extremal_keys);
    let has_pairs = own.len().min(other.len()) < FEW_PLACES || {
        let own = keys_of_view(own, false, best.fit.is_flipped);
        !agreeing_pairs(&own, other, &best.motion, 1.0).is_empty()
    };
    let is_clear = has_pairs && is_clear(&best.fit, null.map(|found| &found.fit));
    let is_equal = |other: &&RegisteredMotion| is_clear && is_equal(&best.fit, &other.fit, second);
    let equal = others.iter().filter(is_equal).copied().collect();
    let n_by_chance = null.map_or(0, |found| {
        agreeing_pairs(
            &keys_of_view(&first.features.keys, true, found.fit.is_flipped),
            &second.features.keys,
            &found.motion,
            1.0,
        )
        .len()
    });
    let candidates = refined.clone();
    Ok(Registration {
        best: Some(*best),
        is_clear,
        equal,
        candidates,
        chance: null.map(|found| found.fit),
        n_by_chance,
    })
}

/// Information of a fit, reduced by its conflict.
fn score(fit: &TwoWayFit) -> f64 {
    fit.information * (1.0 - fit.conflict)
}

/// True if a motion fits better than chance, the fit of the mirror image.
fn is_clear(fit: &TwoWayFit, chance: Option<&TwoWayFit>) -> bool {
    let chance = chance.copied().unwrap_or_default();
    // A shape that is nearly its own mirror image says nothing about chance.
    let is_own_mirror_image = chance.agreement >= MIN_AGREEMENT && chance.conflict <= MAX_CONFLICT;
    fit.agreement >= MIN_AGREEMENT
        && fit.information >= MIN_INFORMATION
        && fit.conflict <= MAX_CONFLICT
        && (is_own_mirror_image || fit.information >= MIN_GAIN * chance.information)
}

/// True if another motion fits as well as the best.
fn is_equal(best: &TwoWayFit, other: &TwoWayFit, second: &Registrand) -> bool {
    other.agreement >= MIN_AGREEMENT
        && other.information >= EQUAL_INFORMATION * best.information
        && other.conflict <= best.conflict + EQUAL_CONFLICT
        && (other.cost <= best.cost + EQUAL_COST || other.median <= best.median.max(0.05 * second.spacing))
}

/// Refines a motion on more points.
fn refine(
    view: &RegistrandView<'_>,
    target: &RegistrandView<'_>,
    found: &FoundMotion,
    params: &SearchParams,
    progress: Progress<'_>,
) -> Result<RegisteredMotion, Cancelled> {
    let points: Vec<[f64; 3]> = view.samples.iter().map(|sample| sample.point).collect();
    let params = AlignParams {
        max_points: REFINED_POINTS,
        max_rounds: REFINED_ROUNDS,
        scaled: params.scaled,
        reach: 10.0 * precision(view, target, &found.motion),
    };
    let (motion, _) = align(&points, &target.shape.surface, found.motion, &params, progress)?;
    Ok(measure(view, target, motion))
}

/// Refines the best motion once more, on vertices instead of samples.
fn refine_best(
    view: &RegistrandView<'_>,
    target: &RegistrandView<'_>,
    found: &RegisteredMotion,
    params: &SearchParams,
    progress: Progress<'_>,
) -> Result<RegisteredMotion, Cancelled> {
    let params = AlignParams { max_rounds: LAST_ROUNDS, scaled: params.scaled, ..AlignParams::default() };
    // The vertices of machined parts are few.
    let are_few = view.shape.vertices.len() < view.samples.len();
    let points = if are_few { view.shape.sample_points() } else { view.shape.vertices.clone() };
    let (motion, _) = align(&points, &target.shape.surface, found.motion, &params, progress)?;
    Ok(measure(view, target, motion))
}

/// Measures the fit of a motion.
fn measure(view: &RegistrandView<'_>, target: &RegistrandView<'_>, motion: Motion) -> RegisteredMotion {
    let fit = two_way_fit(view, target, &motion, 1);
    let keys = keys_of_view(&view.shape.features.keys, false, fit.is_flipped);
    let n_agreeing = agreeing_pairs(&keys, &target.shape.features.keys, &motion, 1.0).len();
    RegisteredMotion { motion, fit, n_agreeing }
}

/// Keeps the first of motions that differ by at most 2 % of the extent.
fn distinct(refined: Vec<RegisteredMotion>, first: &Registrand) -> Vec<RegisteredMotion> {
    let points = first.sample_points();
    let mut kept: Vec<RegisteredMotion> = Vec::new();
    for candidate in refined {
        let least = 0.02 * candidate.motion.scale() * first.extent;
        if kept.iter().all(|other| candidate.motion.difference(&other.motion, &points) > least) {
            kept.push(candidate);
        }
    }
    kept
}

/// Motion that brings two shapes closest together; it need not be clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestFit {
    /// Motion from the first shape to the second.
    pub motion: Motion,
    /// Fit in both directions.
    pub fit: TwoWayFit,
    /// True if the motion is clear, or if the surfaces coincide nearly everywhere.
    pub is_certain: bool,
    /// Number of other motions that fit equally well.
    pub n_equal: usize,
}

/// Aligns `first` with `second` from where they are; `None` if few places have a partner, or if some are much farther
/// apart than most.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub fn fit_in_place(
    first: &Registrand,
    second: &Registrand,
    progress: Progress<'_>,
) -> Result<Option<ClosestFit>, Cancelled> {
    let (view, target) = (RegistrandView::new(first), RegistrandView::new(second));
    let start = FoundMotion { motion: Motion::default(), fit: TwoWayFit::default() };
    let found = refine(&view, &target, &start, &SearchParams::default(), progress)?;
    let fits =
        is_even(&found.fit, precision(&view, &target, &found.motion)) && found.fit.overlap >= LEAST_OVERLAP;
    Ok(fits.then_some(ClosestFit { motion: found.motion, fit: found.fit, is_certain: true, n_equal: 0 }))
}

/// Finds the motion that brings `first` closest to `second`: a clear one, or else the candidate with the least mean of
/// `ln(1 + d²/ε²)` over both directions. Parts that differ cannot outweigh the rest in this mean.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub fn closest_fit(
    first: &Registrand,
    second: &Registrand,
    progress: Progress<'_>,
) -> Result<Option<ClosestFit>, Cancelled> {
    let params = SearchParams { starts: SearchStarts::Everywhere, ..SearchParams::default() };
    let registration = register(first, second, &params, progress)?;
    let (view, target) = (RegistrandView::new(first), RegistrandView::new(second));
    let has_overlap = |found: &&RegisteredMotion| found.fit.overlap >= LEAST_OVERLAP;
    let by_cost = |a: &&RegisteredMotion, b: &&RegisteredMotion| a.fit.cost.total_cmp(&b.fit.cost);
    let best = if registration.is_clear {
        registration.best.iter().chain(&registration.equal).min_by(by_cost)
    } else {
        registration.candidates.iter().filter(has_overlap).min_by(by_cost).or(registration.best.as_ref())
    };
    Ok(best.map(|best| ClosestFit {
        motion: best.motion,
        fit: best.fit,
        is_certain: registration.is_clear || is_even(&best.fit, precision(&view, &target, &best.motion)),
        n_equal: registration.equal.len(),
    }))
}

/// True if the surfaces coincide up to noise, and no place is much farther apart than most.
fn is_even(fit: &TwoWayFit, precision: f64) -> bool {
    fit.median <= MAX_NOISE * precision && fit.tail <= MAX_TAIL * fit.median.max(precision)
}
