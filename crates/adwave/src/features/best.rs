//! Selection of the N best features, well spread.

use super::Feature;
use crate::parallel;

/// Factor of the strength by which a feature must be stronger to suppress another; without a margin, noise decides
/// between equals.
const ROBUST: f64 = 0.9;

/// Selects the `n` features with the largest distance to the nearest clearly stronger one, in the given order; the
/// strongest feature always stays. Without positions (on a graph) it selects the `n` strongest. O(m²) for m
/// features.
///
/// Source: `brown2005` (adaptive
/// non-maximal suppression).
pub fn select_spread(features: &[Feature], n: usize) -> Vec<Feature> {
    select_spread_by(features, n, |feature| feature.strength)
}

/// Selects the `n` features as [`select_spread`] does, with `strength` as their strength.
pub(super) fn select_spread_by(
    features: &[Feature],
    n: usize,
    strength: impl Fn(&Feature) -> f64 + Sync,
) -> Vec<Feature> {
    let strengths: Vec<f64> = features.iter().map(strength).collect();
    let radius = |k: usize| {
        let Some(p) = features[k].position else { return f64::INFINITY };
        let stronger = features.iter().zip(&strengths).filter(|(_, other)| ROBUST * *other > strengths[k]);
        let squared = |b: &Feature| b.position.map(|q| crate::shape::squared_distance(&p, &q));
        stronger.filter_map(|(b, _)| squared(b)).fold(f64::INFINITY, f64::min)
    };
    let radii: Vec<f64> = parallel::map_items(features.len(), features.len(), radius);
    let mut order: Vec<usize> = (0..features.len()).collect();
    order.sort_by(|&a, &b| {
        let by_strength = strengths[b].total_cmp(&strengths[a]);
        radii[b].total_cmp(&radii[a]).then(by_strength).then(a.cmp(&b))
    });
    order.truncate(n);
    order.sort_unstable();
    order.into_iter().map(|k| features[k].clone()).collect()
}
