//! Algorithm 2 by brute force: every vertex against every neighbor on three levels.

use crate::reference::dense::{
    Matrix, Mutant, apply, local_operator, mean_of_welded, minus, norms, restricted, scaling_functions,
    stationary, step_length, weld, within, without_unused,
};
use crate::reference::fast::{Fast, FeatureParams, Response, ThresholdScope};
use crate::reference::shapes::{Case, Parts, cases, signal};
use crate::reference::{ROUNDING, assert_close};

const LEVELS: usize = 6;
/// Responses and strengths, relative to the largest: the accuracy of the bands, by the norm of a level.
const RESPONSE: f64 = 1e-10;

const RESPONSES: [Response; 4] =
    [Response::Normalized, Response::Literal, Response::Channels, Response::Sigma];

/// Mutations of the search, which the tests must notice.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Search {
    Paper,
    /// The mean in the threshold is that of R, not of |R|.
    MeanWithoutBars,
    OneRing,
    ThreeRings,
    /// Only the level itself is looked at.
    OneLevel,
    OnlyMaxima,
    /// The first level is searched too.
    FromTheFirst,
}

#[derive(Clone, Debug)]
struct Found {
    vertex: usize,
    level: usize,
    channel: Option<usize>,
    response: f64,
    strength: f64,
}

/// R(j,x) for each channel that is searched by itself.
fn layers(
    phi: &[Matrix],
    f: &[f64],
    n_channels: usize,
    response: Response,
    sigma: &[f64],
    is_masked: &[bool],
) -> Vec<(Option<usize>, Vec<Vec<f64>>)> {
    let channel = |c: usize| -> Vec<Vec<f64>> {
        (1..phi.len())
            .map(|j| {
                let w = apply(&minus(&phi[j - 1], &phi[j]), f, n_channels);
                w.chunks(n_channels).map(|w| w[c]).collect()
            })
            .collect()
    };
    if response == Response::Channels {
        return (0..n_channels).map(|c| (Some(c), channel(c))).collect();
    }
    let mut levels = if n_channels == 1 { channel(0) } else { norms(phi, f, n_channels) };
    let of_each = norms(phi, f, n_channels);
    for (j, level) in levels.iter_mut().enumerate() {
        let scale = match response {
            Response::Normalized => mean_over(&of_each[j], is_masked),
            Response::Sigma => sigma[j],
            _ => 1.0,
        };
        for r in level {
            *r /= scale;
        }
    }
    vec![(None, levels)]
}

fn mean_over(values: &[f64], is_masked: &[bool]) -> f64 {
    let known: Vec<f64> = (0..values.len()).filter(|&x| !is_masked[x]).map(|x| values[x].abs()).collect();
    known.iter().sum::<f64>() / known.len() as f64
}

/// Input of Algorithm 2.
struct Prepared {
    phi: Vec<Matrix>,
    /// σ_1 … σ_J.
    sigma: Vec<f64>,
    /// Within one, two and three rings.
    rings: [Vec<Vec<bool>>; 3],
    component: Vec<Vec<bool>>,
    /// The first vertex of the file at each welded vertex.
    first: Vec<usize>,
    is_cloud: bool,
    is_masked: Vec<bool>,
}

impl Prepared {
    fn new(case: &Case, is_masked: &[bool]) -> Self {
        let operator = restricted(&local_operator(case, Mutant::None), is_masked);
        let phi = scaling_functions(&operator.t, LEVELS);
        let step = step_length(&phi[1], &stationary(&operator), &operator.length);
        Self {
            sigma: (0..LEVELS).map(|j| step * f64::from(1_u32 << j).sqrt()).collect(),
            rings: [1, 2, 3].map(|k| within(&operator.is_next, k)),
            component: within(&either_way(&operator.is_next), phi[0].len()),
            first: weld(&case.parts).first,
            is_cloud: matches!(case.parts, Parts::Cloud { .. }),
            is_masked: without_unused(case, is_masked),
            phi,
        }
    }
}

/// Parts of a directed graph hang together whichever way its edges point.
fn either_way(next: &[Vec<bool>]) -> Vec<Vec<bool>> {
    (0..next.len()).map(|x| (0..next.len()).map(|y| next[x][y] || next[y][x]).collect()).collect()
}

/// Algorithm 2.
fn algorithm_2(
    shape: &Prepared,
    f: &[f64],
    n_channels: usize,
    params: &FeatureParams,
    search: Search,
) -> Vec<Found> {
    let Prepared { phi, sigma, component, first, is_masked, .. } = shape;
    let n = phi[0].len();
    let neighbors = match search {
        Search::OneRing => &shape.rings[0],
        Search::ThreeRings => &shape.rings[2],
        _ => &shape.rings[usize::from(!shape.is_cloud)],
    };
    let mut found = Vec::new();
    for (channel, levels) in layers(phi, f, n_channels, params.response, sigma, is_masked) {
        // r[j] is R(j).
        let mut r = vec![Vec::new()];
        r.extend(levels);
        let finest = if search == Search::FromTheFirst { 1 } else { 2 };
        for j in finest..LEVELS {
            for x in (0..n).filter(|&x| !is_masked[x]) {
                let others: Vec<f64> = (0..n)
                    .filter(|&y| !is_masked[y])
                    .filter(|&y| params.scope == ThresholdScope::Shape || y == x || component[x][y])
                    .map(|y| if search == Search::MeanWithoutBars { r[j][y] } else { r[j][y].abs() })
                    .collect();
                let mean = others.iter().sum::<f64>() / others.len() as f64;
                if r[j][x].abs() <= params.theta() * mean {
                    continue;
                }
                let near: Vec<usize> = (0..n).filter(|&y| neighbors[x][y] && !is_masked[y]).collect();
                let is_greater = |sign: f64| {
                    let here = sign * r[j][x];
                    let beats = |level: usize, y: usize| here > sign * r[level][y];
                    let beside: &[usize] = match search {
                        Search::OneLevel => &[],
                        Search::FromTheFirst if j == 1 => &[2],
                        _ => &[j - 1, j + 1],
                    };
                    near.iter().all(|&y| beats(j, y))
                        && beside
                            .iter()
                            .all(|&level| beats(level, x) && near.iter().all(|&y| beats(level, y)))
                };
                if is_greater(1.0) || (search != Search::OnlyMaxima && is_greater(-1.0)) {
                    let strength = r[j][x].abs() / mean;
                    found.push(Found { vertex: first[x], level: j, channel, response: r[j][x], strength });
                }
            }
        }
    }
    found.sort_by(|a, b| a.level.cmp(&b.level).then(b.strength.total_cmp(&a.strength)));
    found
}

/// Signals with features at several sizes: noise, and noise that is smoothed.
fn signals(case: &Case, n_channels: usize) -> Vec<Vec<f64>> {
    let n = case.parts.n_vertices();
    let rough = |seed| signal(n, n_channels, seed);
    let fast = Fast::new(case);
    let smooth = |seed: u64| {
        let bands = fast.bands(&rough(seed), n_channels, &[2.0, 4.0], crate::reference::fast::Method::Powers);
        // A little of the fine bands stays, so that no two values are equal.
        bands.scaling[2].iter().zip(rough(seed + 1)).map(|(s, f)| s + 0.03 * f).collect()
    };
    vec![rough(70), rough(71), smooth(72), smooth(74)]
}

type Key = (usize, usize, Option<usize>);

fn keys(found: &[Found]) -> Vec<Key> {
    let mut keys: Vec<Key> = found.iter().map(|f| (f.vertex, f.level, f.channel)).collect();
    keys.sort_unstable();
    keys
}

/// Compares all responses, thresholds and scopes on a shape and returns how many features there were on each level.
fn compare(case: &Case, is_masked: &[bool]) -> Vec<usize> {
    let welded = weld(&case.parts);
    let flags: Vec<bool> = welded.class.iter().map(|&c| is_masked[c]).collect();
    let fast = if flags.contains(&true) { Fast::masked(case, &flags) } else { Fast::new(case) };
    let shape = Prepared::new(case, is_masked);
    let mut counts = vec![0; LEVELS + 1];
    for n_channels in [1, 3] {
        for f in signals(case, n_channels) {
            let mean = mean_of_welded(&welded, &f, n_channels);
            for response in RESPONSES {
                for theta in [0.05, 1.07, 1.6, 2.4] {
                    for scope in [ThresholdScope::Shape, ThresholdScope::Component] {
                        let params = FeatureParams::default()
                            .with_theta(theta)
                            .with_response(response)
                            .with_scope(scope);
                        let what = format!("{}, {n_channels} channels, {params:?}", case.name);
                        let expected = algorithm_2(&shape, &mean, n_channels, &params, Search::Paper);
                        let found = fast.features(&f, n_channels, LEVELS, &params);
                        let list = |of: &dyn Fn(usize) -> Vec<f64>, n: usize| {
                            (0..n).flat_map(of).collect::<Vec<_>>()
                        };
                        let mut keys_found: Vec<Key> =
                            found.iter().map(|f| (f.vertex, f.level, f.channel)).collect();
                        let order_found = keys_found.clone();
                        keys_found.sort_unstable();
                        assert_eq!(keys_found, keys(&expected), "{what}");
                        let order: Vec<Key> =
                            expected.iter().map(|f| (f.vertex, f.level, f.channel)).collect();
                        assert_eq!(order_found, order, "{what}: fine to coarse, the strongest first");
                        assert_close(
                            &list(&|k| vec![found[k].response, found[k].strength], found.len()),
                            &list(&|k| vec![expected[k].response, expected[k].strength], expected.len()),
                            RESPONSE,
                            &what,
                        );
                        for f in &found {
                            let sigma = shape.sigma[f.level - 1];
                            assert!((f.sigma / sigma - 1.0).abs() < ROUNDING, "{what}");
                            counts[f.level] += 1;
                        }
                    }
                }
            }
        }
    }
    counts
}

#[test]
fn features_are_the_extrema_in_place_and_scale_that_pass_the_threshold() {
    let mut counts = vec![0; LEVELS + 1];
    for case in cases() {
        let none = vec![false; weld(&case.parts).first.len()];
        counts.iter_mut().zip(compare(&case, &none)).for_each(|(all, here)| *all += here);
    }
    // None on the first and the last level, many between.
    assert_eq!((counts[1], counts[LEVELS]), (0, 0));
    assert!(counts[2..LEVELS].iter().all(|&n| n > 50), "{counts:?}");
}

#[test]
fn masked_vertices_are_nobody_to_compare_with() {
    for case in cases() {
        let n = weld(&case.parts).first.len();
        compare(&case, &(0..n).map(|c| c % 7 == 3).collect::<Vec<bool>>());
    }
}

#[test]
fn another_threshold_neighborhood_or_range_of_levels_would_be_seen() {
    let searches = [
        Search::MeanWithoutBars,
        Search::OneRing,
        Search::ThreeRings,
        Search::OneLevel,
        Search::OnlyMaxima,
        Search::FromTheFirst,
    ];
    for search in searches {
        let mut n_seen = 0;
        for case in cases().iter().filter(|case| matches!(case.name, "open mesh" | "closed mesh" | "graph")) {
            let shape = Prepared::new(case, &vec![false; weld(&case.parts).first.len()]);
            for f in signals(case, 1) {
                let mean = mean_of_welded(&weld(&case.parts), &f, 1);
                for theta in [0.05, 1.6] {
                    let params = FeatureParams::default().with_theta(theta);
                    let found = algorithm_2(&shape, &mean, 1, &params, Search::Paper);
                    let other = algorithm_2(&shape, &mean, 1, &params, search);
                    n_seen += usize::from(keys(&found) != keys(&other));
                }
            }
        }
        assert!(n_seen > 0, "{search:?} finds the same features everywhere");
    }
}
