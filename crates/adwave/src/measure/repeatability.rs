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
        let again = found.iter().any(|other| {
            let octaves = (changed.length_before(other.sigma) / feature.sigma).log2().abs();
            let near = match (feature.position, other.position) {
                (Some(p), Some(q)) => {
                    squared_distance(&p, &changed.before(&q)).sqrt() <= params.sigmas * feature.sigma
                }
                _ => feature.vertex == other.vertex,
            };
            let alike = (feature.sign(), feature.channel) == (other.sign(), other.channel);
            near && alike && octaves <= params.octaves
        });
        let at = levels.binary_search_by_key(&feature.level, |l| l.level).unwrap_or_else(|at| {
            levels.insert(at, LevelRepeatability { level: feature.level, n_reference: 0, n_found: 0 });
            at
        });
        levels[at].n_reference += 1;
        levels[at].n_found += usize::from(again);
    }
    levels
}
