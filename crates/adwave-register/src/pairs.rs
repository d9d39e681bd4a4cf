//! Pairs of features that a motion brings together.

use crate::consensus::agreeing;
use crate::{Key, Motion};

/// What counts as a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairParams {
    /// How far off the two may be after the motion, in σ of the second.
    pub sigmas: f64,
}

impl Default for PairParams {
    fn default() -> Self {
        Self { sigmas: 2.0 }
    }
}

/// Two features that are one place of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Index among the first features.
    pub first: usize,
    /// Index among the second features.
    pub second: usize,
    /// How far apart they are after the motion, in σ of the second.
    pub sigmas: f64,
    /// How sure it is, in [0, 1].
    pub confidence: f64,
}

/// The pairs of features each of which is the nearest like the other after the motion, within [`PairParams::sigmas`] of σ, by rising
/// index of the first. O(first × second).
///
/// The confidence is the chance `exp(−m·π·d²/area)` that no feature would lie so near were the m features of the second that are like
/// it put anywhere on its surface, d the distance and `area` that surface's in squared model units.
pub fn pairs_under(
    first: &[Key],
    second: &[Key],
    motion: &Motion,
    area: f64,
    params: &PairParams,
) -> Vec<Pair> {
    let pair = |(a, b, sigmas): (usize, usize, f64)| {
        let like = second.iter().filter(|other| first[a].is_alike_after(other, motion)).count();
        let disc = std::f64::consts::PI * (sigmas * second[b].sigma).powi(2);
        Pair { first: a, second: b, sigmas, confidence: (-(like as f64) * disc / area).exp() }
    };
    agreeing(first, second, motion, params.sigmas).into_iter().map(pair).collect()
}
