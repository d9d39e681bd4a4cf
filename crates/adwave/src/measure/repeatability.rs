//! Repeatability: the share of features that are found again on a changed shape.

use super::ChangedShape;
use crate::features::Feature;
use crate::shape::squared_distance;

/// Criteria for a feature to count as found again.
///
/// ```
/// use adwave::measure::RepeatabilityParams;
/// assert_eq!(RepeatabilityParams::default().sigmas, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RepeatabilityParams {
    /// Largest distance, in its own σ.
    pub sigmas: f64,
    /// Largest difference of its σ in octaves (doublings). Dyadic levels are half an octave apart; noise lengthens
    /// edges, and with them the step in which σ is counted.
    pub octaves: f64,
}

impl RepeatabilityParams {
    /// Sets [`sigmas`](Self::sigmas).
    #[must_use]
    pub fn with_sigmas(self, sigmas: f64) -> Self {
        Self { sigmas, ..self }
    }
}

impl Default for RepeatabilityParams {
    fn default() -> Self {
        Self { sigmas: 1.0, octaves: 0.75 }
    }
}

/// Repeatability of the features of one level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LevelRepeatability {
    /// Level of the reference.
    pub level: usize,
    /// Number of features of the reference.
    pub n_reference: usize,
    /// Number of those that are found again.
    pub n_found: usize,
}

impl LevelRepeatability {
    /// Share that is found again, in [0, 1]; NaN without features.
    pub fn share(&self) -> f64 {
        self.n_found as f64 / self.n_reference as f64
    }
}

/// Repeatability of each level that has features in `reference`: the number of those that have a feature of the
/// same sign and channel in `found` within [`sigmas`](RepeatabilityParams::sigmas)·σ of their position. `found`
/// holds the features of a [`ChangedShape`]. O(reference × found).
///
/// Features without positions match if they are at the same vertex.
pub fn repeatability(
    reference: &[Feature],
    found: &[Feature],
    changed: &ChangedShape,
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

/// Number of features in `found`, those of a [`ChangedShape`], that match one of `reference` by the rule of
/// [`repeatability`]. Divided by their number this is the precision; the recall is the share found again.
/// O(reference × found).
pub fn n_right(
    reference: &[Feature],
    found: &[Feature],
    changed: &ChangedShape,
    params: &RepeatabilityParams,
) -> usize {
    found.iter().filter(|other| reference.iter().any(|f| is_again(f, other, changed, params))).count()
}

/// Expected share of `reference` found again if the features of `found` were at random positions on a surface of
/// that `area`, in squared model units of the reference: the mean of `1 − (1 − π(sσ)²/area)^m`, where m is the
/// number of features of the same sign, channel and size and s = [`sigmas`](RepeatabilityParams::sigmas). A larger
/// share is not chance. NaN without features, area or positions. O(reference × found).
pub fn share_by_chance(
    reference: &[Feature],
    found: &[Feature],
    changed: &ChangedShape,
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

/// True if both have the same sign, the same channel and about the same size.
fn is_alike(
    feature: &Feature,
    other: &Feature,
    changed: &ChangedShape,
    params: &RepeatabilityParams,
) -> bool {
    let octaves = (changed.length_before(other.sigma) / feature.sigma).log2().abs();
    (feature.sign(), feature.channel) == (other.sign(), other.channel) && octaves <= params.octaves
}

/// True if `other`, of the changed shape, matches `feature`.
fn is_again(
    feature: &Feature,
    other: &Feature,
    changed: &ChangedShape,
    params: &RepeatabilityParams,
) -> bool {
    let near = match (feature.position, other.position) {
        (Some(p), Some(q)) => {
            squared_distance(&p, &changed.before(&q)).sqrt() <= params.sigmas * feature.sigma
        }
        _ => feature.vertex == other.vertex,
    };
    near && is_alike(feature, other, changed, params)
}
