//! Corresponding features, under a motion or by their descriptors.

use crate::consensus::{AgreeingPair, agreeing_pairs};
use crate::{Key, Motion, ShapeFeatures};
use adwave::features::match_features;

/// Options of the pairing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairParams {
    /// Largest distance after the motion, in σ of the second feature.
    pub sigmas: f64,
    /// Probability that the motion is the true one, in [0, 1].
    pub confidence: f64,
}

impl Default for PairParams {
    fn default() -> Self {
        Self { sigmas: 1.0, confidence: 1.0 }
    }
}

/// Distance of descriptors at which the confidence of a pair is 1/e, fitted to 164 pairs between two meshings of five shapes.
const DESCRIPTOR_DISTANCE: f64 = 0.2;

/// Two features at the same place of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index among the first features.
    pub first: usize,
    /// Index among the second features.
    pub second: usize,
    /// Distance after the motion, in σ of the second feature; NaN without a motion.
    pub sigmas: f64,
    /// Confidence in [0, 1].
    pub confidence: f64,
}

/// Lists the mutually nearest similar features after a motion, within [`PairParams::sigmas`] of σ, by rising index of the
/// first. O(first × second).
///
/// The confidence is that the true motion brings the two within one σ of each other: [`PairParams::confidence`], the probability
/// that the motion is right, for pairs within one σ. For pairs farther apart it is that times `exp(−m·π·(d² − σ²)/area)`, the
/// probability that none of the m similar features of the second shape would lie between σ and d if they were placed at
/// random on its surface, whose `area` is in squared model units.
pub fn pairs_under(
    first: &[Key],
    second: &[Key],
    motion: &Motion,
    area: f64,
    params: &PairParams,
) -> Vec<Pair> {
    let to_pair = |AgreeingPair { first: a, second: b, sigmas }| {
        let n_similar = second.iter().filter(|other| first[a].is_alike_after(other, motion)).count();
        let disk = std::f64::consts::PI * (sigmas.powi(2) - 1.0).max(0.0) * second[b].sigma.powi(2);
        let confidence = params.confidence * (-(n_similar as f64) * disk / area).exp();
        Pair { first: a, second: b, sigmas, confidence }
    };
    agreeing_pairs(first, second, motion, params.sigmas).into_iter().map(to_pair).collect()
}

/// Lists the features with the most similar descriptors, in both directions, nearer than `ratio` times the second nearest, by
/// rising index of the first. O(first × second).
///
/// The confidence is `exp(−d/0.2)` for the distance d of the descriptors. It follows the share of right pairs between two meshings
/// of one whole shape, and says nothing about shapes that differ.
pub fn descriptor_pairs(first: &ShapeFeatures, second: &ShapeFeatures, ratio: f64) -> Vec<Pair> {
    let pair = |m: adwave::features::Match| Pair {
        first: m.first,
        second: m.second,
        sigmas: f64::NAN,
        confidence: (-m.distance / DESCRIPTOR_DISTANCE).exp(),
    };
    match_features(&first.descriptors, &second.descriptors, ratio).into_iter().map(pair).collect()
}
