//! Mixture of smoothed normals with the least risk: one for the whole surface, or one for each kind of place.

use super::places::{KINDS, PlaceKinds};
use super::risk::Risk;
use super::smoothed_normals::LEVELS;
use super::{Creases, DenoiseInfo, LEAST_SHARE, SHAKE};
use crate::vector::{add_scaled, dot, unit};
use crate::{Cancelled, Progress, parallel};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Number of sites up to which one mixture holds everywhere: fewer sites do not determine the risk of each kind of
/// place.
pub(super) const FEW_FOR_KINDS: usize = 2_000;

/// Number of standard errors by which mixtures by place must promise to be better than one for all.
const LEAST_GAIN: f64 = 2.0;

/// Number of sites that a thread processes at a time.
const SITES_AT_A_TIME: usize = 1 << 11;

/// Parts of a mixture at each site, and the shares of the kinds of places there; no shares if there is one kind.
pub(super) struct MixtureParts {
    /// Normals of each part, three numbers per site; the first are those of the surface.
    pub(super) normals: Vec<Vec<f64>>,
    pub(super) shares: Vec<[f64; KINDS]>,
}

/// Factors of the parts of a mixture at one kind of place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct MixtureFactors {
    /// Factor of the unchanged normals.
    pub(super) kept: f64,
    /// Factors after 1, 2, 4, … steps of the walk that respects creases; empty if it has none.
    pub(super) creases: Vec<f64>,
    /// Factors after these steps of the walk that nearly ignores creases.
    pub(super) smooth: Vec<f64>,
}

/// Factors of a mixture by kind of place. The sum of the parts is normalized at each site.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PlaceMixture {
    /// Kinds of places; `None` if one mixture holds everywhere.
    pub(super) kinds: Option<PlaceKinds>,
    /// Factors for each kind, or for all places.
    pub(super) factors: Vec<MixtureFactors>,
}

/// Weights of a mixture by kind of place, and its factors.
pub(super) struct ChosenMixture {
    /// Weights of the parts for each kind, or for all places; they are ≥ 0 and have sum 1.
    pub(super) weights: Vec<Vec<f64>>,
    /// Mean share of each kind, by area.
    pub(super) shares: Vec<f64>,
    /// Factor of each part that makes its root mean square length 1.
    scales: Vec<f64>,
}

/// Risk of mixtures of normals. Averages of normals are shorter than 1 where these differ, on bends as on noise; the
/// parts are scaled to a root mean square length of 1, so that length does not count against smoothing, and compared
/// with the unit normals without noise.
///
/// Stein's identity gives `⟨F, m⟩ = ⟨F, y⟩ − cov(F, y)` for a function F of the noisy normals `y = m + e`. The
/// covariance follows from the change of F and y when noise of known size is added (`ramani2008`). The mean m of noisy
/// unit normals has the direction of the normals without noise and a length below 1, whose mean square is `⟨y, m⟩`.
pub(super) struct MixtureRisk {
    n_parts: usize,
    n_kinds: usize,
    /// The products `⟨φ_g F_k, φ_h F_l⟩` for parts F and shares φ, (kinds × parts)².
    gram: Vec<Vec<f64>>,
    /// The products `⟨φ_g F_k, m⟩`.
    toward: Vec<f64>,
    /// Mean share of each kind, by area.
    shares: Vec<f64>,
}

/// Layout of the sums over sites: `φ_g φ_h F_k·F_l` for the pairs of kinds g ≥ h and of parts k ≥ l, then `φ_g F_k·m`,
/// then φ_g, each times the area.
#[derive(Clone, Copy)]
struct SumLayout {
    /// Number of parts.
    parts: usize,
    /// Number of kinds of places.
    kinds: usize,
    /// Number of pairs of parts.
    pairs: usize,
}

impl SumLayout {
    fn new(parts: &MixtureParts) -> Self {
        let n_parts = parts.normals.len();
        let n_kinds = if parts.shares.is_empty() { 1 } else { KINDS };
        Self { parts: n_parts, kinds: n_kinds, pairs: n_parts * (n_parts + 1) / 2 }
    }

    fn toward_at(self) -> usize {
        self.kinds * (self.kinds + 1) / 2 * self.pairs
    }

    fn shares_at(self) -> usize {
        self.toward_at() + self.kinds * self.parts
    }

    fn len(self) -> usize {
        self.shares_at() + self.kinds
    }

    /// The sums over some sites.
    fn sums(
        self,
        parts: &MixtureParts,
        shaken: &[MixtureParts],
        areas: &[f64],
        strength: f64,
        sites: Range<usize>,
    ) -> Vec<f64> {
        let Self { parts: n_parts, kinds: n_kinds, pairs: n_pairs } = self;
        let (toward_at, shares_at) = (self.toward_at(), self.shares_at());
        let amplification = (strength / SHAKE).powi(2) / shaken.len().max(1) as f64;
        let mut sums = vec![0.0; self.len()];
        let mut products = vec![0.0; n_pairs];
        let at = |parts: &MixtureParts, k: usize, x: usize| normal_at(&parts.normals[k], x);
        for x in sites {
            let (area, here, data) = (areas[x], parts.shares_at(x), at(parts, 0, x));
            let mut pair = 0;
            for k in 0..n_parts {
                let f = at(parts, k, x);
                for l in 0..=k {
                    products[pair] = area * dot(&f, &at(parts, l, x));
                    pair += 1;
                }
                for kind in 0..n_kinds {
                    let covariance = |shaken: &MixtureParts| {
                        let moved = add_scaled(&at(shaken, 0, x), -1.0, &data);
                        shaken.shares_at(x)[kind] * dot(&at(shaken, k, x), &moved)
                            - here[kind] * dot(&f, &moved)
                    };
                    let covariance: f64 = shaken.iter().map(covariance).sum();
                    sums[toward_at + kind * n_parts + k] +=
                        area * (here[kind] * dot(&f, &data) - amplification * covariance);
                }
            }
            let pairs_of_kinds = (0..n_kinds).flat_map(|g| (0..=g).map(move |h| (g, h)));
            for ((g, h), block) in pairs_of_kinds.zip(sums[..toward_at].chunks_mut(n_pairs)) {
                let share = here[g] * here[h];
                if share != 0.0 {
                    block.iter_mut().zip(&products).for_each(|(sum, p)| *sum += share * p);
                }
            }
            sums[shares_at..].iter_mut().zip(here).for_each(|(sum, share)| *sum += area * share);
        }
        sums
    }
}

impl MixtureParts {
    /// Shares of the kinds of places at a site; all of the first if there is one kind.
    fn shares_at(&self, x: usize) -> [f64; KINDS] {
        self.shares
            .get(x)
            .copied()
            .unwrap_or_else(|| std::array::from_fn(|kind| f64::from(u8::from(kind == 0))))
    }
}

impl MixtureRisk {
    /// Builds the risk from the parts for the noisy data, and those for one or more repetitions with added noise of
    /// [`SHAKE`] times the existing noise; `areas` are the weights of the sites and `strength` multiplies the noise.
    /// O(sites × parts²).
    pub(super) fn new(
        parts: &MixtureParts,
        shaken: &[MixtureParts],
        areas: &[f64],
        strength: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let layout = SumLayout::new(parts);
        let SumLayout { parts: n_parts, kinds: n_kinds, pairs: n_pairs } = layout;
        let sums = |(): &mut (), sites: Range<usize>| layout.sums(parts, shaken, areas, strength, sites);
        let chunks = parallel::try_map_chunks(areas.len(), SITES_AT_A_TIME, progress, || (), sums)?;
        let mut total = vec![0.0; layout.len()];
        for chunk in chunks {
            total.iter_mut().zip(chunk).for_each(|(total, sum)| *total += sum);
        }
        let area: f64 = total[layout.shares_at()..].iter().sum();
        if area > 0.0 {
            for sum in &mut total {
                *sum /= area;
            }
        }
        let triangle = |a: usize, b: usize| a.max(b) * (a.max(b) + 1) / 2 + a.min(b);
        let n = n_kinds * n_parts;
        let entry = |i: usize, j: usize| {
            let kinds = triangle(i / n_parts, j / n_parts);
            total[kinds * n_pairs + triangle(i % n_parts, j % n_parts)]
        };
        let gram = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let toward = total[layout.toward_at()..layout.shares_at()].to_vec();
        Ok(Self { n_parts, n_kinds, gram, toward, shares: total[layout.shares_at()..].to_vec() })
    }

    /// The mixture of least risk: one for each kind of place if these promise a smaller error by [`LEAST_GAIN`]
    /// standard errors, else one for all. `n_sites` is the number of sites of the estimate.
    pub(super) fn best(&self, n_sites: usize) -> ChosenMixture {
        let (n_parts, n_kinds) = (self.n_parts, self.n_kinds);
        let sum_over_kinds = |k: usize, l: usize| -> f64 {
            let pairs = (0..n_kinds * n_kinds).map(|pair| (pair / n_kinds, pair % n_kinds));
            pairs.map(|(g, h)| self.gram[g * n_parts + k][h * n_parts + l]).sum()
        };
        let everywhere: Vec<Vec<f64>> =
            (0..n_parts).map(|k| (0..n_parts).map(|l| sum_over_kinds(k, l)).collect()).collect();
        let toward: Vec<f64> =
            (0..n_parts).map(|k| (0..n_kinds).map(|g| self.toward[g * n_parts + k]).sum()).collect();
        let scale = |k: usize| if everywhere[k][k] > 0.0 { everywhere[k][k].sqrt().recip() } else { 1.0 };
        let scales: Vec<f64> = (0..n_parts).map(scale).collect();
        let length_squared = toward[0] * scales[0].powi(2);
        let to_unit = if length_squared > 0.0 { length_squared.sqrt().recip() } else { 1.0 };
        let scaled = |gram: &[Vec<f64>], toward: &[f64]| {
            let row = |(i, row): (usize, &Vec<f64>)| {
                let scaled =
                    row.iter().enumerate().map(|(j, v)| v * scales[i % n_parts] * scales[j % n_parts]);
                scaled.collect()
            };
            let toward = toward.iter().enumerate().map(|(i, b)| b * scales[i % n_parts] * to_unit);
            Risk::from_products(gram.iter().enumerate().map(row).collect(), toward.collect())
        };
        let one = shares(scaled(&everywhere, &toward).best_weights());
        if n_kinds > 1 {
            let risk = scaled(&self.gram, &self.toward);
            let by_kind = risk.best_in_blocks(n_parts);
            let noise = (1.0 - length_squared).max(0.0).sqrt();
            let (gain, error) = risk.gain(&by_kind, &one.repeat(n_kinds), noise, n_sites);
            if gain > LEAST_GAIN * error {
                let weights = by_kind.chunks(n_parts).map(|weights| shares(weights.to_vec())).collect();
                return ChosenMixture { weights, shares: self.shares.clone(), scales };
            }
        }
        ChosenMixture { weights: vec![one], shares: vec![1.0], scales }
    }
}

impl ChosenMixture {
    /// True if the normals are best unchanged everywhere.
    pub(super) fn is_nothing(&self) -> bool {
        self.weights.iter().all(|weights| weights[0] >= 1.0)
    }

    /// Mean weight of each part over the surface.
    fn mean_weights(&self) -> Vec<f64> {
        let mut mean = vec![0.0; self.scales.len()];
        for (weights, share) in self.weights.iter().zip(&self.shares) {
            mean.iter_mut().zip(weights).for_each(|(mean, w)| *mean += share * w);
        }
        mean
    }

    /// Writes the weights to `info`.
    pub(super) fn describe(&self, creases: Creases, info: &mut DenoiseInfo) {
        let mean = split(&self.mean_weights(), creases);
        info.kept = if self.is_nothing() { 1.0 } else { mean.kept };
        (info.crease_weights, info.smooth_weights) = (mean.creases, mean.smooth);
        if let Some(mesh) = &mut info.mesh {
            mesh.kept_by_place = match &self.weights[..] {
                [_] => Vec::new(),
                weights => weights.iter().map(|weights| weights[0]).collect(),
            };
        }
    }

    /// The factors of the parts.
    pub(super) fn factors(&self, kinds: Option<PlaceKinds>, creases: Creases) -> PlaceMixture {
        let of_kind = |weights: &Vec<f64>| {
            let factors: Vec<f64> = weights.iter().zip(&self.scales).map(|(w, scale)| w * scale).collect();
            split(&factors, creases)
        };
        let factors = self.weights.iter().map(of_kind).collect::<Vec<_>>();
        PlaceMixture { kinds: kinds.filter(|_| factors.len() > 1), factors }
    }

    /// The mixture of `parts`, of unit length or zero at each site.
    pub(super) fn normals(
        &self,
        parts: &MixtureParts,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let n_sites = parts.normals.first().map_or(0, Vec::len) / 3;
        parallel::try_collect(n_sites, progress, |x| {
            let mut sum = [0.0; 3];
            for (kind, weights) in self.weights.iter().enumerate() {
                let share = if self.weights.len() == 1 { 1.0 } else { parts.shares[x][kind] };
                if share == 0.0 {
                    continue;
                }
                for ((weight, scale), part) in weights.iter().zip(&self.scales).zip(&parts.normals) {
                    if *weight != 0.0 {
                        sum = add_scaled(&sum, share * weight * scale, &normal_at(part, x));
                    }
                }
            }
            unit(&sum).unwrap_or_default()
        })
    }
}

impl PlaceMixture {
    /// True if the walk that respects creases has a part.
    pub(super) fn uses_creases(&self) -> bool {
        self.factors.iter().any(|factors| factors.creases.iter().any(|w| *w > 0.0))
    }

    /// True if the walk that nearly ignores creases has a part.
    pub(super) fn uses_smooth(&self) -> bool {
        self.factors.iter().any(|factors| factors.smooth.iter().any(|w| *w > 0.0))
    }
}

fn normal_at(normals: &[f64], x: usize) -> [f64; 3] {
    [normals[3 * x], normals[3 * x + 1], normals[3 * x + 2]]
}

/// The parts of a mixture by walk.
fn split(parts: &[f64], creases: Creases) -> MixtureFactors {
    let by_walk: Vec<Vec<f64>> = parts[1..].chunks(LEVELS).map(<[f64]>::to_vec).collect();
    let (creases, smooth) = match creases {
        Creases::Auto => (by_walk[0].clone(), by_walk[1].clone()),
        Creases::Keep => (by_walk[0].clone(), Vec::new()),
        Creases::None => (Vec::new(), by_walk[0].clone()),
    };
    MixtureFactors { kept: parts[0], creases, smooth }
}

/// The weights, with sum 1, without the walks whose weights sum to less than [`LEAST_SHARE`].
fn shares(mut weights: Vec<f64>) -> Vec<f64> {
    for walk in weights[1..].chunks_mut(LEVELS) {
        if walk.iter().sum::<f64>() < LEAST_SHARE {
            walk.fill(0.0);
        }
    }
    let total: f64 = weights.iter().sum();
    for w in &mut weights {
        *w /= total;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;
    use rand_pcg::rand_core::SeedableRng;

    const N: usize = 6_000;

    /// Noisy normals about (0, 0, 1), an estimate that is exact at the first half of the sites and off by `off` at the
    /// others, and the shares: the first kind at the first half, the last kind at the other.
    fn parts(noise: f64, off: f64, seed: u64) -> MixtureParts {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut noisy = || -> [f64; 3] {
            let [x, y]: [f64; 2] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
            unit(&[noise * x, noise * y, 1.0]).unwrap_or_default()
        };
        let estimate = |x: usize| if x < N / 2 { [0.0, 0.0, 1.0] } else { [off.sin(), 0.0, off.cos()] };
        let normals =
            vec![(0..N).flat_map(|_| noisy()).collect(), (0..N).flat_map(estimate).collect::<Vec<f64>>()];
        let shares = (0..N).map(|x| if x < N / 2 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] }).collect();
        MixtureParts { normals, shares }
    }

    /// The risk of parts whose estimate does not depend on the noise.
    fn risk(noise: f64, off: f64) -> MixtureRisk {
        let data = parts(noise, off, 1);
        let mut shaken = parts(SHAKE * noise, off, 2);
        // Noise across the normals, added to the data.
        for (moved, there) in shaken.normals[0].chunks_mut(3).zip(data.normals[0].chunks(3)) {
            moved.copy_from_slice(&[moved[0] + there[0], moved[1] + there[1], there[2]]);
        }
        MixtureRisk::new(&data, &[shaken], &vec![1.0; N], 1.0, Progress::none()).unwrap()
    }

    #[test]
    fn each_kind_of_place_gets_the_estimate_that_is_right_there() {
        let chosen = risk(0.1, 1.0).best(N);
        let [first, _, last] = &chosen.weights[..] else { panic!("{:?}", chosen.weights) };
        assert!(first[1] > 0.9 && last[1] < 0.1, "{first:?} {last:?}");
        assert!((chosen.shares[0] - 0.5).abs() < 1e-12 && chosen.shares[1] == 0.0, "{:?}", chosen.shares);
        // Normals are those of the estimate at the one half, nearly the data at the other.
        let data = parts(0.1, 1.0, 1);
        let found = chosen.normals(&data, Progress::none()).unwrap();
        assert!(dot(&found[0], &[0.0, 0.0, 1.0]) > 0.999);
        assert!(dot(&found[N - 1], &normal_at(&data.normals[0], N - 1)) > 0.99);
    }

    #[test]
    fn one_mixture_holds_everywhere_where_places_do_not_differ() {
        let chosen = risk(0.1, 0.0).best(N);
        assert!(chosen.weights.len() == 1 && chosen.weights[0][1] > 0.9, "{:?}", chosen.weights);
    }

    #[test]
    fn kinds_of_places_sum_to_the_whole() {
        let (data, shaken) = (parts(0.3, 0.4, 1), parts(0.31, 0.4, 2));
        let without =
            |parts: &MixtureParts| MixtureParts { normals: parts.normals.clone(), shares: Vec::new() };
        let areas: Vec<f64> = (0..N).map(|x| 1.0 + (x % 7) as f64).collect();
        let of = |data: &MixtureParts, shaken: MixtureParts| {
            MixtureRisk::new(data, &[shaken], &areas, 1.0, Progress::none()).unwrap()
        };
        let (plain, by_kind) = (of(&without(&data), without(&shaken)), of(&data, shaken));
        for k in 0..2 {
            let sum: f64 = (0..KINDS).map(|g| by_kind.toward[2 * g + k]).sum();
            assert!((sum - plain.toward[k]).abs() < 1e-12 * plain.toward[k].abs());
            for l in 0..2 {
                let entry = |g: usize| (0..KINDS).map(|h| by_kind.gram[2 * g + k][2 * h + l]).sum::<f64>();
                let sum: f64 = (0..KINDS).map(entry).sum();
                assert!((sum - plain.gram[k][l]).abs() < 1e-12, "{sum} {}", plain.gram[k][l]);
            }
        }
    }
}
