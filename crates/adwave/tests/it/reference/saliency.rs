//! Eq. 17: `Λ = Σ_{j > skip} α_j·|W_f(j)|`, for every α.

use crate::reference::dense::{
    Mutant, Welded, local_operator, mean_of_welded, norms, restricted, scaling_functions, stationary, weld,
    without_unused,
};
use crate::reference::fast::{Fast, SaliencyParams, Weighting};
use crate::reference::shapes::{Case, cases, signal};
use crate::reference::{ROUNDING, SEEN, assert_close, difference};

/// The map is of third order in the bands, and their largest values.
const MAP: f64 = 1e-10;

const LEVELS: usize = 6;

const WEIGHTINGS: [Weighting; 6] = [
    Weighting::Entropy,
    Weighting::PerLevel,
    Weighting::AsPrinted,
    Weighting::Normalized,
    Weighting::Ranks,
    Weighting::Uniform,
];

/// |W_f(j)| of the welded vertices, for each level.
fn responses(case: &Case, f: &[f64], n_channels: usize, is_masked: &[bool]) -> Vec<Vec<f64>> {
    let mean = mean_of_welded(&weld(&case.parts), f, n_channels);
    let operator = restricted(&local_operator(case, Mutant::None), is_masked);
    norms(&scaling_functions(&operator.t, LEVELS), &mean, n_channels)
}

/// α_j|W_f(j)| of one level, for the vertices that are not masked.
fn level_map(w: &[f64], weighting: Weighting, is_masked: &[bool]) -> Vec<f64> {
    let known: Vec<f64> = (0..w.len()).filter(|&x| !is_masked[x]).map(|x| w[x]).collect();
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let max = known.iter().fold(0.0_f64, |m, &v| m.max(v));
    let rank = |v: f64| {
        let smaller = known.iter().filter(|&&other| other < v).count() as f64;
        let equal = known.iter().filter(|&&other| other == v).count() as f64 - 1.0;
        if v == 0.0 { 0.0 } else { (smaller + equal / 2.0) / (known.len() as f64 - 1.0) }
    };
    let share = |v: &f64| v / known.iter().sum::<f64>();
    let entropy: f64 = known.iter().map(share).filter(|p| *p > 0.0).map(|p| -p * p.ln()).sum();
    w.iter()
        .map(|&v| match weighting {
            Weighting::Entropy => ((known.len() as f64).ln() - entropy) / mean * v,
            Weighting::PerLevel => (max - mean).powi(2) * v,
            Weighting::AsPrinted => (max - v).powi(2) * v,
            Weighting::Normalized => v / mean,
            Weighting::Ranks => rank(v),
            Weighting::Uniform => v,
            other => unreachable!("no reference for {other:?}"),
        })
        .collect()
}

/// True if two values are equal up to rounding, as at the ends of an isolated edge: equally large on the first
/// level and 0 on the others.
fn has_ties(w: &[f64], is_masked: &[bool]) -> bool {
    let mut sorted: Vec<f64> = (0..w.len()).filter(|&x| !is_masked[x]).map(|x| w[x]).collect();
    sorted.sort_by(f64::total_cmp);
    sorted.windows(2).any(|pair| pair[1] - pair[0] <= ROUNDING * pair[1])
}

fn scatter(welded: &Welded, map: &[f64], is_masked: &[bool]) -> Vec<f64> {
    welded.class.iter().map(|&c| if is_masked[c] { f64::NAN } else { map[c] }).collect()
}

fn sum(maps: &[Vec<f64>]) -> Vec<f64> {
    (0..maps[0].len()).map(|x| maps.iter().map(|map| map[x]).sum()).collect()
}

#[test]
fn the_map_is_the_weighted_sum_of_the_bands_norms() {
    for case in cases() {
        let (fast, welded) = (Fast::new(&case), weld(&case.parts));
        let none = vec![false; welded.first.len()];
        let out = without_unused(&case, &none);
        for n_channels in [1, 3] {
            let f = signal(case.parts.n_vertices(), n_channels, 17);
            let responses = responses(&case, &f, n_channels, &none);
            for weighting in WEIGHTINGS {
                for skip in [0, 2, 5] {
                    let params = SaliencyParams::paper().with_weighting(weighting).with_skip(skip);
                    let (found, by_level) = fast.saliency(&f, n_channels, LEVELS, &params);
                    let maps: Vec<Vec<f64>> = responses[skip..]
                        .iter()
                        .map(|w| scatter(&welded, &level_map(w, weighting, &out), &none))
                        .collect();
                    let what = format!("{}, {weighting:?}, {n_channels} channels", case.name);
                    assert_close(&found.map, &sum(&maps), MAP, &what);
                    for (found, expected) in by_level.iter().zip(&maps) {
                        assert_close(found, expected, MAP, &what);
                    }
                    let levels: Vec<usize> = found.levels.iter().map(|level| level.level).collect();
                    assert_eq!(levels, (skip + 1..=LEVELS).collect::<Vec<_>>());
                    for (level, w) in found.levels.iter().zip(&responses[skip..]) {
                        let known = out.iter().filter(|out| !**out).count();
                        let mean = w.iter().sum::<f64>() / known as f64;
                        let max = w.iter().fold(0.0_f64, |m, &v| m.max(v));
                        assert_close(&[level.mean, level.max], &[mean, max], MAP, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn two_levels_are_skipped_and_levels_weighed_by_default() {
    let params = SaliencyParams::paper();
    assert_eq!((params.skip, params.weighting), (2, Weighting::PerLevel));
}

#[test]
fn masked_vertices_count_neither_in_means_nor_in_maxima_nor_in_ranks() {
    for case in cases() {
        let welded = weld(&case.parts);
        let n = case.parts.n_vertices();
        // Whole positions only.
        let is_masked: Vec<bool> = (0..welded.first.len()).map(|c| c % 13 == 12).collect();
        let flags: Vec<bool> = (0..n).map(|x| is_masked[welded.class[x]]).collect();
        let f = signal(n, 2, 18);
        let responses = responses(&case, &f, 2, &is_masked);
        let out = without_unused(&case, &is_masked);
        let fast = Fast::masked(&case, &flags);
        for weighting in WEIGHTINGS {
            if weighting == Weighting::Ranks && responses.iter().any(|w| has_ties(w, &is_masked)) {
                continue; // rounding decides which of two comes first
            }
            let params = SaliencyParams::paper().with_weighting(weighting);
            let (found, _) = fast.saliency(&f, 2, LEVELS, &params);
            let maps: Vec<Vec<f64>> = responses[2..]
                .iter()
                .map(|w| scatter(&welded, &level_map(w, weighting, &out), &is_masked))
                .collect();
            assert_close(&found.map, &sum(&maps), MAP, &format!("{}, {weighting:?}", case.name));
        }
    }
}

/// α_j from the largest, the mean and the weighted mean |W_f(j)|.
type Alpha<'a> = &'a dyn Fn(f64, f64, f64) -> f64;

#[test]
fn missing_bars_squares_and_means_by_area_would_be_seen() {
    for case in cases() {
        let (fast, welded) = (Fast::new(&case), weld(&case.parts));
        let none = vec![false; welded.first.len()];
        let f = signal(case.parts.n_vertices(), 1, 19);
        let (found, _) = fast.saliency(&f, 1, LEVELS, &SaliencyParams::paper());
        let responses = responses(&case, &f, 1, &none);
        let pi = stationary(&local_operator(&case, Mutant::None));
        let alphas: [(&str, Alpha<'_>); 4] = [
            ("not squared", &|max, mean, _| max - mean),
            ("maximum only", &|max, _, _| max * max),
            ("weighted mean", &|max, _, weighted| (max - weighted).powi(2)),
            ("sum", &|max, mean, _| (max + mean).powi(2)),
        ];
        for (name, alpha) in alphas {
            let maps: Vec<Vec<f64>> = responses[2..]
                .iter()
                .map(|w| {
                    let max = w.iter().fold(0.0_f64, |m, &v| m.max(v));
                    let mean = w.iter().sum::<f64>() / w.len() as f64;
                    let weighted = w.iter().zip(&pi).map(|(w, p)| w * p).sum();
                    scatter(
                        &welded,
                        &w.iter().map(|v| alpha(max, mean, weighted) * v).collect::<Vec<_>>(),
                        &none,
                    )
                })
                .collect();
            let off = difference(&found.map, &sum(&maps));
            assert!(off > SEEN * MAP, "{}, {name}: {off:.1e}", case.name);
        }
    }
}
