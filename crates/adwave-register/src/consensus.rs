//! Motions that features agree on.

use crate::Motion;
use crate::shape_features::Landmarks;
use adwave::features::Feature;
use adwave::vector::{cross, dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Properties of a feature that are used in matching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Position.
    pub position: [f64; 3],
    /// Unit normal; zero if unknown.
    pub normal: [f64; 3],
    /// Radius σ, in model units.
    pub sigma: f64,
    /// Sign of the response.
    pub sign: i8,
}

impl Key {
    /// Creates the key of a feature; `None` if it has no position.
    pub fn new(feature: &Feature, normal: [f64; 3]) -> Option<Self> {
        Some(Self { position: feature.position?, normal, sigma: feature.sigma, sign: feature.sign() })
    }

    /// Returns the feature mirrored at x = 0.
    pub(crate) fn mirrored(&self) -> Self {
        let mirror = crate::registrand::mirror;
        Self { position: mirror(&self.position), normal: mirror(&self.normal), ..*self }
    }

    /// Returns the feature of the same surface with its other side outside.
    pub(crate) fn flipped(&self) -> Self {
        Self { normal: self.normal.map(|c| -c), sign: -self.sign, ..*self }
    }

    /// True if another feature, on a shape `scale` times as large, has the same sign and a similar σ ([`MAX_OCTAVES`]).
    pub(crate) fn is_alike(&self, other: &Self, scale: f64) -> bool {
        self.sign == other.sign && (other.sigma / (scale * self.sigma)).log2().abs() <= MAX_OCTAVES
    }

    /// True if another feature is similar and has a similar normal after the motion; an unknown normal does not count.
    pub(crate) fn is_alike_after(&self, other: &Self, motion: &Motion) -> bool {
        let no_normal = self.normal == [0.0; 3] || other.normal == [0.0; 3];
        self.is_alike(other, motion.scale())
            && (no_normal || dot(&motion.turn(&self.normal), &other.normal) > 0.5)
    }
}

/// Largest difference between the σ of one feature on two meshes, in octaves.
const MAX_OCTAVES: f64 = 0.75;
/// Largest number of candidate pairs; those with the most similar descriptors are kept.
const MAX_CANDIDATES: usize = 1536;
/// Distance between two features, relative to the sum of their σ, below which they determine no direction.
const LEAST_SPREAD: f64 = 1.0;
/// Largest difference between the cosines of the angles that two features form on the two shapes.
const COSINE_SLACK: f64 = 0.35;
/// Largest number of couples of one candidate pair from which motions are fitted.
const MAX_COUPLES_OF_PAIR: usize = 4;
/// Largest number of couples from which motions are fitted.
const MAX_COUPLES: usize = 700;
/// Weight of normals in the fit of a motion to few pairs, relative to positions.
const NORMAL_WEIGHT: f64 = 0.1;
/// Largest number of rounds in which a motion is fitted again to the pairs that agree with it.
const REFINING_ROUNDS: usize = 3;

/// Options of the search for motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ConsensusParams {
    /// Number of most similar features of the other shape that are candidates for each feature.
    pub(crate) candidates: usize,
    /// Distance after the motion up to which two features agree with it, in σ of the second feature.
    pub(crate) sigmas: f64,
    /// True to search for similarities, with a change of size, instead of rigid motions.
    pub(crate) scaled: bool,
    /// Largest number of motions.
    pub(crate) motions: usize,
}

impl Default for ConsensusParams {
    fn default() -> Self {
        Self { candidates: 5, sigmas: 1.0, scaled: false, motions: 150 }
    }
}

/// Motion with the candidate pairs that agree with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Consensus {
    /// Motion from the first shape to the second.
    pub(crate) motion: Motion,
    /// Number of features of the first shape with a similar feature of the second within [`ConsensusParams::sigmas`].
    pub(crate) n_agreeing: usize,
}

/// Finds distinct motions from `first` to `second` that many features agree on, the motion with most features first.
///
/// Two candidate pairs are compatible if distances and angles between their features are equal on both shapes, up to
/// the precision of features. Two compatible pairs, with their normals, give a motion; couples that share most
/// compatible pairs come first. The motion is fitted to all pairs that agree with it. O(candidates³ / 64) at most,
/// typically O(candidates²).
///
/// Source: `chen2022`.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub(crate) fn consensus(
    first: &Landmarks,
    second: &Landmarks,
    params: &ConsensusParams,
    progress: Progress<'_>,
) -> Result<Vec<Consensus>, Cancelled> {
    let pairs = candidate_pairs(first, second, params);
    let places: Vec<PairedKeys> = pairs
        .iter()
        .map(|pair| PairedKeys { from: first.keys[pair.first], to: second.keys[pair.second] })
        .collect();
    if pairs.len() < 2 {
        return Ok(Vec::new());
    }
    progress.check()?;
    let graph = CompatiblePairs::new(&pairs, &places, params);
    progress.check()?;
    let fit = |couple: &Couple| fit_members(&[couple.first, couple.second], &pairs, &places, params);
    let mut found: Vec<Consensus> = graph.best_couples().par_iter().filter_map(fit).collect();
    found.sort_by_key(|consensus| std::cmp::Reverse(consensus.n_agreeing));
    Ok(distinct(found, first, params.motions))
}

/// Keeps the first of motions that differ by at most 4 % of the extent of the features, and at most `most` motions.
fn distinct(found: Vec<Consensus>, first: &Landmarks, most: usize) -> Vec<Consensus> {
    let points: Vec<[f64; 3]> = first.keys.iter().map(|key| key.position).collect();
    let extent = adwave::shape::diagonal(&points);
    let points: Vec<[f64; 3]> = points.into_iter().step_by(1 + first.keys.len() / 12).collect();
    let mut kept: Vec<Consensus> = Vec::new();
    for consensus in found {
        let size = consensus.motion.scale() * extent;
        if kept.len() < most
            && kept.iter().all(|other| consensus.motion.difference(&other.motion, &points) > 0.04 * size)
        {
            kept.push(consensus);
        }
    }
    kept
}

/// Two features that may correspond, as indices into the features of both shapes.
#[derive(Clone, Copy, Debug)]
struct CandidatePair {
    first: usize,
    second: usize,
    /// Squared distance of the descriptors.
    distance: f64,
}

/// Keys of the two features of a candidate pair.
#[derive(Clone, Copy)]
struct PairedKeys {
    from: Key,
    to: Key,
}

/// Lists the most similar features of the second shape for each feature of the first, and vice versa.
fn candidate_pairs(first: &Landmarks, second: &Landmarks, params: &ConsensusParams) -> Vec<CandidatePair> {
    let (firsts, seconds): (Vec<usize>, Vec<usize>) =
        ((0..first.keys.len()).collect(), (0..second.keys.len()).collect());
    let rate = |&a: &usize, &b: &usize| -> Option<CandidatePair> {
        let (key, other) = (&first.keys[a], &second.keys[b]);
        let is_alike = if params.scaled { key.sign == other.sign } else { key.is_alike(other, 1.0) };
        let squares = first.descriptors[a].iter().zip(&second.descriptors[b]).map(|(x, y)| (x - y) * (x - y));
        is_alike.then(|| CandidatePair { first: a, second: b, distance: squares.sum() })
    };
    let forward = firsts.iter().map(|a| seconds.iter().filter_map(|b| rate(a, b)).collect::<Vec<_>>());
    let backward = seconds.iter().map(|b| firsts.iter().filter_map(|a| rate(a, b)).collect::<Vec<_>>());
    let mut pairs: Vec<CandidatePair> = Vec::new();
    for mut near in forward.chain(backward) {
        near.sort_by(|x, y| {
            x.distance.total_cmp(&y.distance).then((x.first, x.second).cmp(&(y.first, y.second)))
        });
        near.truncate(params.candidates);
        pairs.extend(near);
    }
    pairs.sort_by_key(|pair| (pair.first, pair.second));
    pairs.dedup_by_key(|pair| (pair.first, pair.second));
    if pairs.len() > MAX_CANDIDATES {
        pairs.sort_by(|x, y| {
            x.distance.total_cmp(&y.distance).then((x.first, x.second).cmp(&(y.first, y.second)))
        });
        pairs.truncate(MAX_CANDIDATES);
        pairs.sort_by_key(|pair| (pair.first, pair.second));
    }
    pairs
}

/// Matrix of bits: row i marks the candidate pairs that are compatible with candidate pair i.
struct CompatiblePairs {
    n_words: usize,
    words: Vec<u64>,
}

/// Two compatible candidate pairs, whose positions and normals determine a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Couple {
    /// Rank among the couples of the first pair. Low ranks come first, so that motions that few pairs agree on are
    /// tried too.
    rank: usize,
    /// Number of candidate pairs that are not compatible with both.
    missing: usize,
    first: usize,
    second: usize,
}

impl CompatiblePairs {
    fn new(pairs: &[CandidatePair], places: &[PairedKeys], params: &ConsensusParams) -> Self {
        let n_words = pairs.len().div_ceil(64);
        // Bits above the diagonal, then their mirror image.
        let row = |i: usize| -> Vec<u64> {
            let mut words = vec![0_u64; n_words];
            for j in i + 1..pairs.len() {
                let is_one = pairs[i].first == pairs[j].first || pairs[i].second == pairs[j].second;
                if !is_one && are_compatible(&places[i], &places[j], params) {
                    words[j / 64] |= 1 << (j % 64);
                }
            }
            words
        };
        let mut words: Vec<u64> = (0..pairs.len()).into_par_iter().flat_map_iter(row).collect();
        for i in 0..pairs.len() {
            for j in i + 1..pairs.len() {
                if (words[i * n_words + j / 64] >> (j % 64)) & 1 == 1 {
                    words[j * n_words + i / 64] |= 1 << (i % 64);
                }
            }
        }
        Self { n_words, words }
    }

    fn row(&self, i: usize) -> &[u64] {
        &self.words[i * self.n_words..][..self.n_words]
    }

    /// Returns the couples that share most compatible pairs.
    fn best_couples(&self) -> Vec<Couple> {
        let n_pairs = self.words.len() / self.n_words;
        let couples_of = |i: usize| -> Vec<Couple> {
            let own = self.row(i);
            let is_near = |j: &usize| (own[j / 64] >> (j % 64)) & 1 == 1;
            let couple = |j: usize| {
                let shared: u32 = own.iter().zip(self.row(j)).map(|(a, b)| (a & b).count_ones()).sum();
                Couple { rank: 0, missing: n_pairs - shared as usize, first: i, second: j }
            };
            let mut couples: Vec<Couple> = (i + 1..n_pairs).filter(is_near).map(couple).collect();
            couples.sort_unstable();
            couples.truncate(MAX_COUPLES_OF_PAIR);
            couples.iter_mut().enumerate().for_each(|(rank, couple)| couple.rank = rank);
            couples
        };
        let mut couples: Vec<Couple> = (0..n_pairs).into_par_iter().flat_map_iter(couples_of).collect();
        couples.sort_unstable();
        couples.truncate(MAX_COUPLES);
        couples
    }
}

/// Difference of two points; inlined because it is computed millions of times.
#[inline]
fn offset(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Length of a vector; inlined like [`offset`].
#[inline]
fn length(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// True if the features of two candidate pairs have equal distances and angles on both shapes, up to the precision of
/// features.
fn are_compatible(a: &PairedKeys, b: &PairedKeys, params: &ConsensusParams) -> bool {
    let (before, after) =
        (offset(&b.from.position, &a.from.position), offset(&b.to.position, &a.to.position));
    let (own_length, other_length) = (length(&before), length(&after));
    let scale = if params.scaled { other_length / own_length } else { 1.0 };
    if params.scaled {
        let is_near =
            |pair: &PairedKeys| (pair.to.sigma / (scale * pair.from.sigma)).log2().abs() <= MAX_OCTAVES;
        if !(is_near(a) && is_near(b)) {
            return false;
        }
    }
    let reach = a.to.sigma + b.to.sigma;
    if other_length.min(scale * own_length) < LEAST_SPREAD * reach
        || (other_length - scale * own_length).abs() > 0.5 * params.sigmas * reach
    {
        return false;
    }
    let [p, q, r, s] = [&a.from.normal, &b.from.normal, &a.to.normal, &b.to.normal];
    if [p, q, r, s].contains(&&[0.0; 3]) {
        return true;
    }
    // The triple product tells a shape from its mirror image.
    let cosines = |d: &[f64; 3], n: &[f64; 3], m: &[f64; 3], length: f64| {
        [dot(n, m), dot(d, n) / length, dot(d, m) / length, dot(d, &cross(n, m)) / length]
    };
    let (before, after) = (cosines(&before, p, q, own_length), cosines(&after, r, s, other_length));
    before.iter().zip(after).all(|(x, y)| (x - y).abs() <= COSINE_SLACK)
}

/// Fits a motion to some candidate pairs, then to all candidate pairs that agree with it.
fn fit_members(
    members: &[usize],
    pairs: &[CandidatePair],
    places: &[PairedKeys],
    params: &ConsensusParams,
) -> Option<Consensus> {
    let mut motion = fit_keys(members.iter().map(|&i| places[i]), params.scaled)?;
    let mut n_best = 0;
    let mut best = None;
    for _ in 0..REFINING_ROUNDS {
        let agreeing = agreeing_candidates(pairs, places, &motion, params.sigmas);
        if agreeing.len() <= n_best || agreeing.len() < 3 {
            break;
        }
        n_best = agreeing.len();
        best = Some(Consensus { motion, n_agreeing: n_best });
        let Some(next) = fit_keys(agreeing.iter().map(|&i| places[i]), params.scaled) else { break };
        motion = next;
    }
    best.filter(|best| best.motion.scale() > 0.0)
}

/// Lists the candidate pairs that agree with a motion, the nearest first; each feature is in at most one of them.
fn agreeing_candidates(
    pairs: &[CandidatePair],
    places: &[PairedKeys],
    motion: &Motion,
    sigmas: f64,
) -> Vec<usize> {
    let mut near: Vec<(f64, usize)> = Vec::new();
    for (i, place) in places.iter().enumerate() {
        let distance =
            length(&offset(&motion.apply(&place.from.position), &place.to.position)) / place.to.sigma;
        if distance <= sigmas && place.from.is_alike_after(&place.to, motion) {
            near.push((distance, i));
        }
    }
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let size = |index: fn(&CandidatePair) -> usize| pairs.iter().map(index).max().map_or(0, |most| most + 1);
    let (mut firsts, mut seconds) = (vec![false; size(|p| p.first)], vec![false; size(|p| p.second)]);
    near.retain(|&(_, i)| {
        let CandidatePair { first, second, .. } = pairs[i];
        let is_free = !firsts[first] && !seconds[second];
        if is_free {
            (firsts[first], seconds[second]) = (true, true);
        }
        is_free
    });
    near.into_iter().map(|(_, i)| i).collect()
}

/// Fits a motion to the positions of paired features, and with little weight to their normals.
fn fit_keys(places: impl Iterator<Item = PairedKeys>, scaled: bool) -> Option<Motion> {
    let places: Vec<PairedKeys> = places.collect();
    let positions: Vec<[f64; 3]> = places.iter().map(|place| place.from.position).collect();
    let arm = 0.5 * adwave::shape::diagonal(&positions);
    let normal_weight = if places.len() < 4 { 1.0 } else { NORMAL_WEIGHT };
    let scale = if scaled { scale_of(&places)? } else { 1.0 };
    let (mut from, mut to, mut weights) = (Vec::new(), Vec::new(), Vec::new());
    for PairedKeys { from: p, to: q } in &places {
        // The positions of fine features are more precise.
        let weight = q.sigma.powi(-2);
        from.push(p.position);
        to.push(q.position);
        weights.push(weight);
        if p.normal != [0.0; 3] && q.normal != [0.0; 3] {
            from.push(adwave::vector::add_scaled(&p.position, arm, &p.normal));
            to.push(adwave::vector::add_scaled(&q.position, scale * arm, &q.normal));
            weights.push(normal_weight * weight);
        }
    }
    Motion::fit(&from, &to, &weights, scaled)
}

/// Ratio of the extents of paired features about their means; `None` if one of them is 0.
fn scale_of(places: &[PairedKeys]) -> Option<f64> {
    let spread = |key: fn(&PairedKeys) -> [f64; 3]| -> f64 {
        let sum = places.iter().map(key).fold([0.0; 3], |sum, p| std::array::from_fn(|c| sum[c] + p[c]));
        let mean = sum.map(|c| c / places.len() as f64);
        places.iter().map(|place| norm(&subtract(&key(place), &mean)).powi(2)).sum::<f64>().sqrt()
    };
    let scale = spread(|place| place.to.position) / spread(|place| place.from.position);
    (scale.is_finite() && scale > 0.0).then_some(scale)
}

/// Two features that a motion brings together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AgreeingPair {
    pub(crate) first: usize,
    pub(crate) second: usize,
    /// Distance after the motion, in σ of the second feature.
    pub(crate) sigmas: f64,
}

/// Lists the mutually nearest similar features within `sigmas` of σ after a motion, by rising index of the first.
pub(crate) fn agreeing_pairs(
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    sigmas: f64,
) -> Vec<AgreeingPair> {
    let nearest = |(first, key): (usize, &Key)| {
        let moved = motion.apply(&key.position);
        let distance = |other: &Key| norm(&subtract(&moved, &other.position)) / other.sigma;
        let pair = |(second, other)| AgreeingPair { first, second, sigmas: distance(other) };
        others
            .iter()
            .enumerate()
            .map(pair)
            .filter(|pair| pair.sigmas <= sigmas && key.is_alike_after(&others[pair.second], motion))
            .min_by(|x, y| x.sigmas.total_cmp(&y.sigmas))
    };
    let forward: Vec<AgreeingPair> = keys.iter().enumerate().filter_map(nearest).collect();
    let mut nearest_of = vec![(f64::INFINITY, usize::MAX); others.len()];
    for pair in &forward {
        if pair.sigmas < nearest_of[pair.second].0 {
            nearest_of[pair.second] = (pair.sigmas, pair.first);
        }
    }
    forward.into_iter().filter(|pair| nearest_of[pair.second].1 == pair.first).collect()
}
