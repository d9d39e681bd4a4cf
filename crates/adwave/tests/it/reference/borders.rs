//! Fading of borders in saliency and rejection of features near them, on a square of squares, where distances are known.

use crate::reference::fast::{Fast, FeatureParams, Response, SaliencyParams, Weighting};
use crate::reference::shapes::{Case, Parts, signal};
use crate::reference::{ROUNDING, assert_close};
use adwave::operator::OperatorParams;

/// Squares on each side of the middle.
const HALF: i32 = 4;
const LEVELS: usize = 4;
/// Widths of which multiples are distances, exactly: squares have sides of 1.
const SIGMA: [f64; LEVELS + 1] = [0.0, 0.5, 0.75, 1.0, 1.25];

fn places() -> impl Iterator<Item = (i32, i32)> {
    (-HALF..=HALF).flat_map(|i| (-HALF..=HALF).map(move |j| (i, j)))
}

/// Squares of side 1 round the origin, in two halves each, so that the vertex in the middle is next to all eight round it.
fn square() -> Case {
    let points = places().map(|(i, j)| [f64::from(i), f64::from(j), 0.0]).collect();
    let at = |(i, j): (i32, i32)| ((i + HALF) * (2 * HALF + 1) + j + HALF) as u32;
    let mut triangles = Vec::new();
    for (i, j) in places().filter(|&(i, j)| i < HALF && j < HALF) {
        let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(at);
        let is_even = (i + j) % 2 == 0;
        triangles.extend(if is_even { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
    }
    Case { name: "square", parts: Parts::Mesh { points, triangles }, params: OperatorParams::default() }
}

/// Distance of each vertex from the border, or from those next to a hole in the middle.
fn distances(has_hole: bool) -> Vec<f64> {
    let distance = |(i, j): (i32, i32)| {
        let outside = f64::from(HALF - i.abs().max(j.abs()));
        let [u, v] = [i, j].map(|i| f64::from((i.abs() - 1).max(0)));
        if has_hole { outside.min(u.hypot(v)) } else { outside }
    };
    places().map(distance).collect()
}

fn middle() -> usize {
    places().position(|place| place == (0, 0)).unwrap()
}

/// The square, whole and with its middle masked.
fn both(case: &Case) -> [(Fast<'_>, bool); 2] {
    let flags: Vec<bool> = (0..case.parts.n_vertices()).map(|x| x == middle()).collect();
    [(Fast::new(case), false), (Fast::masked(case, &flags), true)]
}

/// 0 up to `none`, 1 from twice that on, 3t² − 2t³ between.
fn share_left(distance: f64, none: f64) -> f64 {
    match distance {
        d if d <= none => 0.0,
        d if d >= 2.0 * none => 1.0,
        d => 3.0 * (d / none - 1.0).powi(2) - 2.0 * (d / none - 1.0).powi(3),
    }
}

/// Weighted remainder of a level.
fn level_map(w: &[f64], left: &[f64], weighting: Weighting) -> Vec<f64> {
    let known = |x: &usize| !w[*x].is_nan();
    let faded: Vec<f64> = w.iter().zip(left).map(|(w, left)| w * left).collect();
    let total = |values: &[f64]| (0..w.len()).filter(known).map(|x| values[x]).sum::<f64>();
    let mean = if total(left) > 0.0 { total(&faded) / total(left) } else { 0.0 };
    let max = faded.iter().fold(0.0_f64, |m, &v| m.max(v));
    let ranked: Vec<f64> = (0..w.len()).filter(known).filter(|&x| left[x] > 0.0).map(|x| faded[x]).collect();
    let rank = |v: f64| {
        let smaller = ranked.iter().filter(|&&other| other < v).count() as f64;
        if v == 0.0 { 0.0 } else { smaller / (ranked.len() as f64 - 1.0) }
    };
    let weigh = |&v: &f64| match weighting {
        Weighting::PerLevel => (max - mean).powi(2) * v,
        Weighting::AsPrinted => (max - v).powi(2) * v,
        Weighting::Normalized if mean == 0.0 => 0.0 * v,
        Weighting::Normalized => v / mean,
        Weighting::Ranks if v.is_nan() => v,
        Weighting::Ranks => rank(v),
        Weighting::Uniform => v,
        other => unreachable!("{other:?} is not among those of this test"),
    };
    faded.iter().map(weigh).collect()
}

#[test]
fn saliency_fades_from_one_to_two_times_the_width_of_each_level() {
    let case = square();
    for (fast, has_hole) in both(&case) {
        let distance = distances(has_hole);
        let n = distance.len();
        let levels: Vec<Vec<f64>> = (0..LEVELS as u64)
            .map(|j| {
                let mut level: Vec<f64> = signal(n, 1, 90 + j).iter().map(|v| v.abs() + 0.1).collect();
                level[middle()] = if has_hole { f64::NAN } else { 7.0 };
                level
            })
            .collect();
        for sigmas in [0.0, 0.3, 0.9, 1.0, 1.6, 2.0, 9.0] {
            for weighting in [
                Weighting::PerLevel,
                Weighting::AsPrinted,
                Weighting::Normalized,
                Weighting::Ranks,
                Weighting::Uniform,
            ] {
                let params = SaliencyParams::paper().with_skip(1).with_weighting(weighting);
                let mut expected = vec![0.0; n];
                for j in 2..=LEVELS {
                    let left: Vec<f64> = distance.iter().map(|&d| share_left(d, sigmas * SIGMA[j])).collect();
                    let map = level_map(&levels[j - 1], &left, weighting);
                    expected.iter_mut().zip(map).for_each(|(sum, v)| *sum += v);
                }
                let found = fast.saliency_of(&levels, &SIGMA, &params.with_border_sigmas(sigmas)).map;
                let what = format!("{weighting:?} within {sigmas} σ, a hole: {has_hole}");
                assert_close(&found, &expected, ROUNDING, &what);
            }
        }
    }
}

#[test]
fn features_within_the_width_of_their_level_are_rejected_the_one_at_that_distance_too() {
    let case = square();
    let params = FeatureParams::default().with_response(Response::Literal).with_theta(0.1);
    for (fast, has_hole) in both(&case) {
        let distance = distances(has_hole);
        for x in (0..distance.len()).filter(|&x| !has_hole || x != middle()) {
            for j in 2..LEVELS {
                let mut levels = vec![vec![0.0; distance.len()]; LEVELS];
                levels[j - 1][x] = 1.0;
                if has_hole {
                    for level in &mut levels {
                        level[middle()] = f64::NAN;
                    }
                }
                assert_eq!(fast.features_of(&levels, &SIGMA, &params).len(), 1);
                for sigmas in [0.0, 0.5, 0.95, 1.0, 4.0 / 3.0, 2.0, 3.0] {
                    let found = fast.features_of(&levels, &SIGMA, &params.with_border_sigmas(sigmas)).len();
                    let is_far = distance[x] > sigmas * SIGMA[j];
                    assert_eq!(found, usize::from(is_far), "vertex {x} at {}, level {j}", distance[x]);
                }
            }
        }
    }
}

#[test]
fn every_feature_is_judged_by_its_own_width() {
    let case = square();
    let fast = Fast::new(&case);
    let at = |place: (i32, i32)| places().position(|other| other == place).unwrap();
    let mut levels = vec![vec![0.0; case.parts.n_vertices()]; LEVELS];
    // At a distance of 1 with σ = 0.75, and of 3 with σ = 1.
    levels[1][at((3, 0))] = 1.0;
    levels[2][at((-1, 0))] = 1.0;
    let params = FeatureParams::default().with_response(Response::Literal).with_theta(0.1);
    for (sigmas, expected) in [(1.3, vec![2, 3]), (1.4, vec![3]), (2.9, vec![3]), (3.1, vec![])] {
        let found = fast.features_of(&levels, &SIGMA, &params.with_border_sigmas(sigmas));
        assert_eq!(found.iter().map(|f| f.level).collect::<Vec<_>>(), expected, "within {sigmas} σ");
    }
}
