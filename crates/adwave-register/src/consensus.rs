//! Consensus: the motion that most features of two shapes agree on.

use crate::{Motion, ShapeFeatures};
use adwave::features::Feature;
use adwave::vector::{dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

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

    /// Tells if another feature, `scale` times as large, has the same sign and a similar size ([`MAX_OCTAVES`]).
    pub(crate) fn is_alike(&self, other: &Self, scale: f64) -> bool {
        self.sign == other.sign && (other.sigma / (scale * self.sigma)).log2().abs() <= MAX_OCTAVES
    }

    /// Tells if another feature is similar and has a similar normal after the motion.
    pub(crate) fn is_alike_after(&self, other: &Self, motion: &Motion) -> bool {
        let no_normal = self.normal == [0.0; 3] || other.normal == [0.0; 3];
        self.is_alike(other, motion.scale())
            && (no_normal || dot(&motion.turn(&self.normal), &other.normal) > 0.5)
    }
}

/// Largest difference of σ of the same feature on two meshes, in octaves.
const MAX_OCTAVES: f64 = 0.75;

/// Smallest number of tried triples.
const MIN_TRIES: usize = 2000;
/// Inverse probability of missing the correct motion.
const INVERSE_MISS_RATE: f64 = 1e4;
/// Number of random rotations for the chance level.
const N_RANDOM_TURNS: usize = 50;

/// Options of the search for a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConsensusParams {
    /// Largest number of tried triples of pairs.
    pub tries: usize,
    /// Number of most similar features of the other shape that are candidates for each feature.
    pub candidates: usize,
    /// Distance after the motion up to which features agree with it, in their σ.
    pub sigmas: f64,
    /// True to search for a similarity, with a change of size, instead of a rigid motion.
    pub scaled: bool,
    /// Seed of the triples.
    pub seed: u64,
}

impl Default for ConsensusParams {
    fn default() -> Self {
        Self { tries: 200_000, candidates: 5, sigmas: 1.0, scaled: false, seed: 1 }
    }
}

/// Motion that most features agree on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Consensus {
    /// Motion from the first shape to the second.
    pub motion: Motion,
    /// Number of pairs of features that agree with it.
    pub n_agreeing: usize,
    /// Largest number of agreeing pairs after one of 50 random rotations about the center of the second shape.
    pub n_by_chance: usize,
}

impl Consensus {
    /// Returns true if at least six pairs agree, and more than 1.5 times as many as by chance.
    pub fn is_clear(&self) -> bool {
        self.n_agreeing >= 6 && 2 * self.n_agreeing > 3 * self.n_by_chance
    }
}

/// Finds the motion from `first` to `second` that most features agree on, by random triples of similar pairs (RANSAC).
///
/// Returns `None` if no triple fits. The same seed gives the same motion. O(tries + hundreds × first × second).
///
/// Source: `fischler1981`.
///
/// # Errors
/// Returns [`Cancelled`] on cancellation.
pub fn consensus(
    first: &ShapeFeatures,
    second: &ShapeFeatures,
    params: &ConsensusParams,
    progress: Progress<'_>,
) -> Result<Option<Consensus>, Cancelled> {
    let (keys, others) = (first.keys.as_slice(), second.keys.as_slice());
    let candidates = candidate_pairs(first, second, params);
    if candidates.len() < 3 {
        return Ok(None);
    }
    let mut random = Pcg64Mcg::seed_from_u64(params.seed);
    let mut draw = || candidates[(random.next_u64() % candidates.len() as u64) as usize];
    let mut best: Option<(Motion, usize)> = None;
    let spread = adwave::shape::diagonal(&keys.iter().map(|k| k.position).collect::<Vec<_>>());
    let (mut tried, mut enough) = (0, params.tries);
    while tried < enough {
        if tried % 1024 == 0 {
            progress.check()?;
        }
        tried += 1;
        let triple = [draw(), draw(), draw()];
        let Some(motion) = fit_triple(&triple, keys, others, spread, params) else { continue };
        let count = agreeing_pairs(keys, others, &motion, params.sigmas).len();
        if best.is_none_or(|(_, most)| count > most) {
            let refined = refine(keys, others, motion, count, params);
            enough = params.tries.min(required_tries(&candidates, keys, others, &refined.0, params));
            best = Some(refined);
        }
    }
    let Some((motion, n_agreeing)) = best else { return Ok(None) };
    let n_by_chance = count_by_chance(keys, others, &motion, params, &mut random);
    Ok(Some(Consensus { motion, n_agreeing, n_by_chance }))
}

/// Number of triples after which three correct pairs have been drawn, except for one run in [`INVERSE_MISS_RATE`], assuming that
/// the motion is correct.
fn required_tries(
    candidates: &[CandidatePair],
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    params: &ConsensusParams,
) -> usize {
    let n_right = candidates.iter().filter(|pair| is_fitting(pair, keys, others, motion, params)).count();
    let share = (n_right as f64 / candidates.len() as f64).powi(3);
    // Only some correct triples are far apart and precise; a factor of ten compensates for this.
    MIN_TRIES.max((10.0 * INVERSE_MISS_RATE.ln() / -(-share).ln_1p()).ceil() as usize)
}

/// Counts the features that agree by chance: the largest number after [`N_RANDOM_TURNS`] random rotations of the second shape
/// about its center.
fn count_by_chance(
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    params: &ConsensusParams,
    random: &mut Pcg64Mcg,
) -> usize {
    let sum = others.iter().fold([0.0; 3], |sum, k| std::array::from_fn(|c| sum[c] + k.position[c]));
    let center = sum.map(|c| c / others.len().max(1) as f64);
    let mut number = || random.next_u64() as f64 / u64::MAX as f64 - 0.5;
    let count = |_| {
        let axis: [f64; 3] = std::array::from_fn(|_| number());
        let angle = 0.5 + 2.0 * (number() + 0.5);
        let length = norm(&axis).max(f64::MIN_POSITIVE);
        let turn = Motion::new(axis.map(|c| c * angle / length), [0.0; 3]);
        let moved = turn.apply(&center);
        let back = Motion::new([0.0; 3], std::array::from_fn(|c| center[c] - moved[c]));
        agreeing_pairs(keys, others, &motion.then(&turn).then(&back), params.sigmas).len()
    };
    (0..N_RANDOM_TURNS).map(count).max().unwrap_or(0)
}

/// Two features that may be the same, by their indices.
#[derive(Clone, Copy, Debug)]
struct CandidatePair {
    first: usize,
    second: usize,
}

/// Lists the most similar features of the second shape for each feature of the first.
fn candidate_pairs(
    first: &ShapeFeatures,
    second: &ShapeFeatures,
    params: &ConsensusParams,
) -> Vec<CandidatePair> {
    let mut pairs = Vec::new();
    for (a, (key, descriptor)) in first.keys.iter().zip(&first.descriptors).enumerate() {
        let alike = |b: &usize| {
            let other = &second.keys[*b];
            if params.scaled { key.sign == other.sign } else { key.is_alike(other, 1.0) }
        };
        let distance = |b: usize| -> f64 {
            descriptor.iter().zip(&second.descriptors[b]).map(|(x, y)| (x - y) * (x - y)).sum()
        };
        let mut near: Vec<(f64, usize)> =
            (0..second.keys.len()).filter(alike).map(|b| (distance(b), b)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let nearest = near.iter().take(params.candidates);
        pairs.extend(nearest.map(|&(_, b)| CandidatePair { first: a, second: b }));
    }
    pairs
}

/// Fits a motion to three pairs that are far apart and at equal distances on both shapes; `None` otherwise.
fn fit_triple(
    triple: &[CandidatePair; 3],
    keys: &[Key],
    others: &[Key],
    spread: f64,
    params: &ConsensusParams,
) -> Option<Motion> {
    let p = triple.map(|pair| keys[pair.first].position);
    let q = triple.map(|pair| others[pair.second].position);
    let scale =
        if params.scaled { others[triple[0].second].sigma / keys[triple[0].first].sigma } else { 1.0 };
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (before, after) = (norm(&subtract(&p[i], &p[j])), norm(&subtract(&q[i], &q[j])));
        let slack = params.sigmas * (others[triple[i].second].sigma + others[triple[j].second].sigma);
        let slack = if params.scaled { slack + 0.5 * after } else { slack };
        if before < 0.15 * spread || (after - scale * before).abs() > slack {
            return None;
        }
    }
    let motion = Motion::fit(&p, &q, &[1.0; 3], params.scaled)?;
    triple.iter().all(|pair| is_fitting(pair, keys, others, &motion, params)).then_some(motion)
}

/// Tells if a motion brings the features of a pair together.
fn is_fitting(
    pair: &CandidatePair,
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    params: &ConsensusParams,
) -> bool {
    let (key, other) = (&keys[pair.first], &others[pair.second]);
    let distance = norm(&subtract(&motion.apply(&key.position), &other.position));
    distance <= params.sigmas * other.sigma && key.is_alike_after(other, motion)
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

/// Fits the motion to all features that agree with it, repeatedly while their number grows.
fn refine(
    keys: &[Key],
    others: &[Key],
    mut motion: Motion,
    mut count: usize,
    params: &ConsensusParams,
) -> (Motion, usize) {
    for _ in 0..10 {
        let agreeing = agreeing_pairs(keys, others, &motion, params.sigmas);
        let (p, q): (Vec<_>, Vec<_>) =
            agreeing.iter().map(|pair| (keys[pair.first].position, others[pair.second].position)).unzip();
        // The positions of fine features are more precise.
        let weights: Vec<f64> = agreeing.iter().map(|pair| others[pair.second].sigma.powi(-2)).collect();
        let Some(next) = Motion::fit(&p, &q, &weights, params.scaled) else { break };
        let n = agreeing_pairs(keys, others, &next, params.sigmas).len();
        if n < count {
            break;
        }
        (motion, count) = (next, n);
        if n == agreeing.len() && n == count {
            break;
        }
    }
    (motion, count)
}
