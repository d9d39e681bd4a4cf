//! The motion that most features of two shapes agree on.

use crate::Motion;
use adwave::features::{Descriptor, Feature};
use adwave::vector::{dot, norm, subtract};
use adwave::{Cancelled, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// A feature as matching sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Where it is.
    pub position: [f64; 3],
    /// Unit normal there; zero where there is none.
    pub normal: [f64; 3],
    /// Its radius.
    pub sigma: f64,
    /// The sign of its response.
    pub sign: i8,
}

impl Key {
    /// Of a feature that has a position.
    pub fn new(feature: &Feature, normal: [f64; 3]) -> Option<Self> {
        Some(Self { position: feature.position?, normal, sigma: feature.sigma, sign: feature.sign() })
    }

    /// Whether another could be the same, `scale` times as large: its sign, and its size within [`OCTAVES`].
    pub(crate) fn is_alike(&self, other: &Self, scale: f64) -> bool {
        self.sign == other.sign && (other.sigma / (scale * self.sigma)).log2().abs() <= OCTAVES
    }

    /// The same, and facing the same way after the motion.
    pub(crate) fn is_alike_after(&self, other: &Self, motion: &Motion) -> bool {
        let no_normal = self.normal == [0.0; 3] || other.normal == [0.0; 3];
        self.is_alike(other, motion.scale())
            && (no_normal || dot(&motion.turn(&self.normal), &other.normal) > 0.5)
    }
}

/// How much the σ of one feature may differ on two meshings, in doublings.
const OCTAVES: f64 = 0.75;

/// Triples that are tried at least.
const LEAST_TRIES: usize = 2000;
/// One time in so many the right motion may be missed.
const MISSED: f64 = 1e4;
/// Random turns that say what chance gives.
const TURNS: usize = 50;

/// How a motion is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConsensusParams {
    /// Triples of pairs that are tried.
    pub tries: usize,
    /// For each feature, how many of the other shape's that look most like it may be the same.
    pub candidates: usize,
    /// Features agree with a motion when it brings them together to within so many of their σ.
    pub sigmas: f64,
    /// Whether the size may differ too.
    pub scaled: bool,
    /// Seed of the triples.
    pub seed: u64,
}

impl Default for ConsensusParams {
    fn default() -> Self {
        Self { tries: 200_000, candidates: 5, sigmas: 1.0, scaled: false, seed: 1 }
    }
}

/// What most features agree on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Consensus {
    /// From the first shape to the second.
    pub motion: Motion,
    /// Pairs of features that it brings together.
    pub n_agreeing: usize,
    /// The most that it brings together when it is followed by one of 50 random turns about the middle of the second shape.
    pub n_by_chance: usize,
}

impl Consensus {
    /// Whether it explains clearly more than a turn by chance: half as many pairs again, and at least six.
    pub fn is_clear(&self) -> bool {
        self.n_agreeing >= 6 && 2 * self.n_agreeing > 3 * self.n_by_chance
    }
}

/// The motion from `first` to `second` that most features agree on, by random triples of pairs that look alike (RANSAC); `None` where
/// no triple fits. The same seed gives the same motion. O(tries + hundreds × first × second).
///
/// Source: `fischler1981`.
///
/// # Errors
/// [`Cancelled`].
pub fn consensus(
    first: (&[Key], &[Descriptor]),
    second: (&[Key], &[Descriptor]),
    params: &ConsensusParams,
    progress: Progress<'_>,
) -> Result<Option<Consensus>, Cancelled> {
    let (keys, others) = (first.0, second.0);
    let candidates = candidates(first, second, params);
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
        let Some(motion) = motion_of(&triple, keys, others, spread, params) else { continue };
        let count = agreeing(keys, others, &motion, params.sigmas).len();
        if best.is_none_or(|(_, most)| count > most) {
            let found = refined(keys, others, motion, count, params);
            enough = params.tries.min(tries_for(&candidates, keys, others, &found.0, params));
            best = Some(found);
        }
    }
    let Some((motion, n_agreeing)) = best else { return Ok(None) };
    let n_by_chance = by_chance(keys, others, &motion, params, &mut random);
    Ok(Some(Consensus { motion, n_agreeing, n_by_chance }))
}

/// Triples after which one of three right pairs has come up but for one time in [`MISSED`], were the motion right.
fn tries_for(
    candidates: &[(usize, usize)],
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    params: &ConsensusParams,
) -> usize {
    let n_right = candidates.iter().filter(|pair| fits(pair, keys, others, motion, params)).count();
    let share = (n_right as f64 / candidates.len() as f64).powi(3);
    // Few of the right triples are wide apart and placed sharply; ten times as many make up for it.
    LEAST_TRIES.max((10.0 * MISSED.ln() / -(-share).ln_1p()).ceil() as usize)
}

/// How many features agree at best with the motion followed by one of [`TURNS`] random turns about the middle of the second shape.
fn by_chance(
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
        agreeing(keys, others, &motion.then(&turn).then(&back), params.sigmas).len()
    };
    (0..TURNS).map(count).max().unwrap_or(0)
}

/// For each feature of the first those of the second that look most like it.
fn candidates(
    first: (&[Key], &[Descriptor]),
    second: (&[Key], &[Descriptor]),
    params: &ConsensusParams,
) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for (a, (key, descriptor)) in first.0.iter().zip(first.1).enumerate() {
        let alike = |b: &usize| {
            let other = &second.0[*b];
            if params.scaled { key.sign == other.sign } else { key.is_alike(other, 1.0) }
        };
        let distance =
            |b: usize| -> f64 { descriptor.iter().zip(&second.1[b]).map(|(x, y)| (x - y) * (x - y)).sum() };
        let mut near: Vec<(f64, usize)> =
            (0..second.0.len()).filter(alike).map(|b| (distance(b), b)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.extend(near.iter().take(params.candidates).map(|&(_, b)| (a, b)));
    }
    found
}

/// The motion of three pairs that are wide apart, at the same distances on both shapes.
fn motion_of(
    triple: &[(usize, usize); 3],
    keys: &[Key],
    others: &[Key],
    spread: f64,
    params: &ConsensusParams,
) -> Option<Motion> {
    let p = triple.map(|(a, _)| keys[a].position);
    let q = triple.map(|(_, b)| others[b].position);
    let scale = if params.scaled { others[triple[0].1].sigma / keys[triple[0].0].sigma } else { 1.0 };
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (before, after) = (norm(&subtract(&p[i], &p[j])), norm(&subtract(&q[i], &q[j])));
        let slack = params.sigmas * (others[triple[i].1].sigma + others[triple[j].1].sigma);
        let slack = if params.scaled { slack + 0.5 * after } else { slack };
        if before < 0.15 * spread || (after - scale * before).abs() > slack {
            return None;
        }
    }
    let motion = Motion::fit(&p, &q, &[1.0; 3], params.scaled)?;
    triple.iter().all(|pair| fits(pair, keys, others, &motion, params)).then_some(motion)
}

/// Whether the motion brings the two of a pair together.
fn fits(
    &(a, b): &(usize, usize),
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    params: &ConsensusParams,
) -> bool {
    let off = norm(&subtract(&motion.apply(&keys[a].position), &others[b].position));
    off <= params.sigmas * others[b].sigma && keys[a].is_alike_after(&others[b], motion)
}

/// The pairs of features that a motion brings together to within `sigmas` of σ, each the nearest of the other that is like it: the index of
/// the first, rising, that of the second, and how far apart they are in its σ.
pub(crate) fn agreeing(
    keys: &[Key],
    others: &[Key],
    motion: &Motion,
    sigmas: f64,
) -> Vec<(usize, usize, f64)> {
    let nearest = |(a, key): (usize, &Key)| {
        let at = motion.apply(&key.position);
        let off = |other: &Key| norm(&subtract(&at, &other.position)) / other.sigma;
        let fellows = others.iter().enumerate().map(|(b, other)| (a, b, off(other)));
        fellows
            .filter(|&(_, b, off)| off <= sigmas && key.is_alike_after(&others[b], motion))
            .min_by(|x, y| x.2.total_cmp(&y.2))
    };
    let forward: Vec<(usize, usize, f64)> = keys.iter().enumerate().filter_map(nearest).collect();
    let mut nearest_of = vec![(f64::INFINITY, usize::MAX); others.len()];
    for &(a, b, off) in &forward {
        if off < nearest_of[b].0 {
            nearest_of[b] = (off, a);
        }
    }
    forward.into_iter().filter(|&(a, b, _)| nearest_of[b].1 == a).collect()
}

/// The motion fitted to all features that agree with it, again and again while more do.
fn refined(
    keys: &[Key],
    others: &[Key],
    mut motion: Motion,
    mut count: usize,
    params: &ConsensusParams,
) -> (Motion, usize) {
    for _ in 0..10 {
        let agreeing = agreeing(keys, others, &motion, params.sigmas);
        let (p, q): (Vec<_>, Vec<_>) =
            agreeing.iter().map(|&(a, b, _)| (keys[a].position, others[b].position)).unzip();
        // Fine features are placed more sharply.
        let weights: Vec<f64> = agreeing.iter().map(|&(_, b, _)| others[b].sigma.powi(-2)).collect();
        let Some(next) = Motion::fit(&p, &q, &weights, params.scaled) else { break };
        let n = self::agreeing(keys, others, &next, params.sigmas).len();
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
