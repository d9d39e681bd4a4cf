//! Corresponding features, under a motion or by their descriptors.

use crate::consensus::{AgreeingPair, agreeing_pairs};
use crate::{Key, Motion, ShapeFeatures};
use adwave::features::match_features;
use adwave::vector::{norm, subtract};

/// Options of the pairing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairParams {
    /// Largest distance after the motion, in σ of the second feature.
    pub sigmas: f64,
    /// Probability that one of the motions is the true one, in [0, 1].
    pub confidence: f64,
    /// Standard deviation of the distance of a pair after the best motion from its distance after the true motion, in
    /// model units.
    pub precision: f64,
}

impl Default for PairParams {
    fn default() -> Self {
        Self { sigmas: 1.0, confidence: 1.0, precision: 0.0 }
    }
}

/// Distance between descriptors at which the confidence of a pair is 1/e, fitted to 164 pairs between two meshings of
/// five shapes.
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

/// Ratio of the width of a logistic curve to its standard deviation, √3/π.
const LOGISTIC_WIDTH: f64 = 0.551_328_895_421_792;

/// Smallest width of the logistic curve, in σ.
const MIN_WIDTH: f64 = 1e-6;

/// Lists the mutually nearest similar features after the first of `motions`, within [`PairParams::sigmas`] times σ,
/// sorted by the index of the first feature. O(first × second).
///
/// The confidence is the probability that the true motion brings the two features within one σ of each other:
/// `c/m · Σ 1/(1 + exp((dᵢ − 1)/w))` over the m motions, which fit equally well. Here dᵢ is the distance after motion i
/// in σ, c is the probability that one of the motions is the true one ([`PairParams::confidence`]), and the width w is
/// `√3/π` times [`PairParams::precision`] over σ.
pub fn pairs_under(first: &[Key], second: &[Key], motions: &[Motion], params: &PairParams) -> Vec<Pair> {
    let Some(best) = motions.first() else { return Vec::new() };
    let to_pair = |AgreeingPair { first: a, second: b, sigmas }| {
        let within = |motion: &Motion| {
            let moved = motion.apply(&first[a].position);
            let distance = norm(&subtract(&moved, &second[b].position)) / second[b].sigma;
            let width = (LOGISTIC_WIDTH * params.precision / second[b].sigma).max(MIN_WIDTH);
            1.0 / (1.0 + ((distance - 1.0) / width).exp())
        };
        let mean = motions.iter().map(within).sum::<f64>() / motions.len() as f64;
        Pair { first: a, second: b, sigmas, confidence: params.confidence * mean }
    };
    agreeing_pairs(first, second, best, params.sigmas).into_iter().map(to_pair).collect()
}

/// Lists the pairs of features whose descriptors are mutually the most similar, with a distance below `ratio` times
/// that of the second nearest, sorted by the index of the first feature. O(first × second).
///
/// The confidence is `exp(−d/0.2)` for the distance d between the descriptors. It follows the share of correct pairs
/// between two meshings of one whole shape, and does not hold for shapes that differ.
pub fn descriptor_pairs(first: &ShapeFeatures, second: &ShapeFeatures, ratio: f64) -> Vec<Pair> {
    let pair = |m: adwave::features::Match| Pair {
        first: m.first,
        second: m.second,
        sigmas: f64::NAN,
        confidence: (-m.distance / DESCRIPTOR_DISTANCE).exp(),
    };
    match_features(&first.descriptors, &second.descriptors, ratio).into_iter().map(pair).collect()
}
