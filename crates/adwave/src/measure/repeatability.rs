//! The share of features that are found again on a changed shape.

use super::Changed;
use crate::features::Feature;
use crate::shape::squared_distance;

/// When a feature counts as found again.
///
/// ```
/// use adwave::measure::RepeatabilityParams;
/// assert_eq!(RepeatabilityParams::default().sigmas, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepeatabilityParams {
    /// How far off it may be, in its own σ.
    pub sigmas: f64,
    /// How much its σ may differ, in octaves (doublings). Dyadic levels are half an octave apart; noise lengthens edges, and
    /// so the step that σ is counted in.
    pub octaves: f64,
}

impl Default for RepeatabilityParams {
    fn default() -> Self {
        Self { sigmas: 1.0, octaves: 0.75 }
    }
}

/// How many features of a level are found again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelRepeatability {
    /// The level of the reference.
    pub level: usize,
    /// Features of the reference.
    pub n_reference: usize,
    /// Those of them that are found again.
    pub n_found: usize,
}

impl LevelRepeatability {
    /// The share found again, in [0, 1]; NaN without features.
    pub fn share(&self) -> f64 {
        self.n_found as f64 / self.n_reference as f64
    }
}

/// For each level that has features in `reference`: how many have a feature of the same sign and channel in `found` within
/// [`sigmas`](RepeatabilityParams::sigmas)·σ of their own place. `found` are those of a [`Changed`] shape. O(reference ×
/// found).
///
/// Features without positions are at one place when they are at one vertex.
pub fn repeatability(
    reference: &[Feature],
    found: &[Feature],
    changed: &Changed,
    params: &RepeatabilityParams,
) -> Vec<LevelRepeatability> {
    let mut levels: Vec<LevelRepeatability> = Vec::new();
    for feature in reference {
        let again = found.iter().any(|other| is_again(feature, other, changed, params));
        let at = levels.binary_search_by_key(&feature.level, |l| l.level).unwrap_or_else(|at| {
            levels.insert(at, LevelRepeatability { level: feature.level, n_reference: 0, n_found: 0 });
            at
        });
        levels[at].n_reference += 1;
        levels[at].n_found += usize::from(again);
    }
    levels
}

/// How many of `found`, the features of a [`Changed`] shape, are one of `reference`, by the same rule as [`repeatability`]: over their
/// number that is the precision, whose recall is the share found again. O(reference × found).
pub fn n_right(
    reference: &[Feature],
    found: &[Feature],
    changed: &Changed,
    params: &RepeatabilityParams,
) -> usize {
    found.iter().filter(|other| reference.iter().any(|f| is_again(f, other, changed, params))).count()
}

/// The share of `reference` that would be found again if the features of `found` lay anywhere on a surface of that `area`, in
/// squared model units of the reference: the mean of `1 − (1 − π(sσ)²/area)^m`, m the features of the same sign, channel and size
/// and s = [`sigmas`](RepeatabilityParams::sigmas). What is found again beyond that is not chance. NaN without features, without an
/// area or without positions. O(reference × found).
pub fn share_by_chance(
    reference: &[Feature],
    found: &[Feature],
    changed: &Changed,
    params: &RepeatabilityParams,
    area: f64,
) -> f64 {
    if area.is_nan() || area <= 0.0 || reference.iter().any(|f| f.position.is_none()) {
        return f64::NAN;
    }
    let by_chance = |feature: &Feature| {
        let disc = std::f64::consts::PI * (params.sigmas * feature.sigma).powi(2);
        let alike = found.iter().filter(|other| is_alike(feature, other, changed, params)).count();
        1.0 - (1.0 - disc / area).max(0.0).powf(alike as f64)
    };
    reference.iter().map(by_chance).sum::<f64>() / reference.len() as f64
}

/// Whether both have the same sign, channel and about the same size.
fn is_alike(feature: &Feature, other: &Feature, changed: &Changed, params: &RepeatabilityParams) -> bool {
    let octaves = (changed.length_before(other.sigma) / feature.sigma).log2().abs();
    (feature.sign(), feature.channel) == (other.sign(), other.channel) && octaves <= params.octaves
}

/// Whether `other`, of the changed shape, is `feature`.
fn is_again(feature: &Feature, other: &Feature, changed: &Changed, params: &RepeatabilityParams) -> bool {
    let near = match (feature.position, other.position) {
        (Some(p), Some(q)) => {
            squared_distance(&p, &changed.before(&q)).sqrt() <= params.sigmas * feature.sigma
        }
        _ => feature.vertex == other.vertex,
    };
    near && is_alike(feature, other, changed, params)
}
