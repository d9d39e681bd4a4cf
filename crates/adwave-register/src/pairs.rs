//! Corresponding features under a motion.

use crate::consensus::{AgreeingPair, agreeing_pairs};
use crate::{Key, Motion};

/// Options of the pairing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairParams {
    /// Largest distance after the motion, in σ of the second feature.
    pub sigmas: f64,
}

impl Default for PairParams {
    fn default() -> Self {
        Self { sigmas: 2.0 }
    }
}

/// Two features at the same place of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index among the first features.
    pub first: usize,
    /// Index among the second features.
    pub second: usize,
    /// Distance after the motion, in σ of the second feature.
    pub sigmas: f64,
    /// Confidence in [0, 1].
    pub confidence: f64,
}

/// Lists the mutually nearest similar features after a motion, within [`PairParams::sigmas`] of σ, by rising index of the
/// first. O(first × second).
///
/// The confidence `exp(−m·π·d²/area)` is the probability that none of the m similar features of the second shape would lie
/// within the distance d if they were placed at random on its surface, whose `area` is in squared model units.
pub fn pairs_under(
    first: &[Key],
    second: &[Key],
    motion: &Motion,
    area: f64,
    params: &PairParams,
) -> Vec<Pair> {
    let to_pair = |AgreeingPair { first: a, second: b, sigmas }| {
        let n_similar = second.iter().filter(|other| first[a].is_alike_after(other, motion)).count();
        let disk = std::f64::consts::PI * (sigmas * second[b].sigma).powi(2);
        Pair { first: a, second: b, sigmas, confidence: (-(n_similar as f64) * disk / area).exp() }
    };
    agreeing_pairs(first, second, motion, params.sigmas).into_iter().map(to_pair).collect()
}
