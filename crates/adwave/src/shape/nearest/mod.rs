//! Nearest neighbors of every point of a cloud.

mod blocks;

use super::{Adjacency, VertexMap, WeldMode};
use crate::parallel::expect_not_cancelled;
use crate::{Cancelled, Progress};
use blocks::{Blocks, NearestSearch};
use std::sync::atomic::{AtomicU64, Ordering};

/// Nearest neighbors of the points of a cloud.
#[derive(Clone, Debug)]
pub struct Neighborhoods {
    /// Neighbors of each point; not symmetric.
    pub adjacency: Adjacency,
    /// Distance to the k-th nearest neighbor of each point, in the unit of the points.
    pub radius: Vec<f64>,
    /// Number of requested neighbors, at most the number of points minus one.
    pub k: usize,
}

/// Relative difference below which distances are equal. On a grid of any orientation the k-th neighbor is one of
/// several at the same distance, and rounding must not decide which.
const TIE: f64 = 1e-9;

/// Largest number of neighbors beyond k that a tie may add; beyond it the first in the order of `points` are taken.
const MAX_TIED: usize = 54;

/// Finds the `k` nearest neighbors of every point, and those at the same distance as the k-th (see below). O(n log
/// n).
///
/// `N(x) = {y ≠ x : ‖x − y‖ ≤ r_k(x)}`. "The k nearest" is ambiguous if several points are equally far, as on every
/// regular grid or quantized scan; taking all of them makes the operator independent of rotations of the cloud and
/// of the order of its points. At most k + 54 neighbors are taken. With fewer than k + 1 points, all others are
/// neighbors.
///
/// ```
/// use adwave::shape::nearest_neighbors;
/// let line: Vec<_> = (0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let near = nearest_neighbors(&line, 1);
/// assert_eq!(near.adjacency.row(2), [1, 3]); // both are at distance 1
/// assert_eq!(near.radius, [1.0; 5]);
/// ```
///
/// # Panics
/// If a coordinate is NaN or infinite.
pub fn nearest_neighbors(points: &[[f64; 3]], k: usize) -> Neighborhoods {
    expect_not_cancelled(try_nearest_neighbors(points, k, Progress::none()))
}

/// Finds the neighbors of `points[x]` among `points`, all different, with the result of [`nearest_neighbors`] but
/// without a search structure: O(n). Writes them to `neighbors` in ascending order and returns the distance to the
/// k-th.
///
/// ```
/// use adwave::shape::nearest_to_vertex;
/// let line: Vec<_> = (0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let mut near = Vec::new();
/// assert_eq!(nearest_to_vertex(&line, 2, 1, &mut near), 1.0);
/// assert_eq!(near, [1, 3]);
/// ```
///
/// # Panics
/// If point `x` does not exist.
pub fn nearest_to_vertex(points: &[[f64; 3]], x: usize, k: usize, neighbors: &mut Vec<u32>) -> f64 {
    neighbors.clear();
    let k = k.min(points.len().saturating_sub(1));
    if k == 0 {
        return 0.0;
    }
    let unit = coordinate_unit(points);
    let p = points[x].map(|c| c / unit);
    let others = (0..).zip(points).filter(|(y, _)| *y as usize != x);
    let mut squares: Vec<(f64, u32)> =
        others.map(|(y, q)| (super::squared_distance(&p, &q.map(|c| c / unit)), y)).collect();
    let farthest = squares.select_nth_unstable_by(k - 1, |a, b| a.0.total_cmp(&b.0)).1.0;
    let limit = farthest * ((1.0 + TIE) * (1.0 + TIE));
    squares.retain(|(square, _)| *square <= limit);
    if squares.len() > k + MAX_TIED {
        squares.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        squares.truncate(k + MAX_TIED);
    }
    neighbors.extend(squares.into_iter().map(|(_, y)| y));
    neighbors.sort_unstable();
    unit * farthest.sqrt()
}

/// [`nearest_neighbors`] that can be stopped.
///
/// # Errors
/// [`Cancelled`] if `progress` was cancelled.
///
/// # Panics
/// If a coordinate is NaN or infinite.
pub fn try_nearest_neighbors(
    points: &[[f64; 3]],
    k: usize,
    progress: Progress<'_>,
) -> Result<Neighborhoods, Cancelled> {
    nearest_of_wanted(points, k, |_| true, progress)
}

/// [`nearest_neighbors`] of the points that are wanted; none and radius 0 for the others.
pub(crate) fn nearest_of_wanted(
    points: &[[f64; 3]],
    k: usize,
    is_wanted: impl Fn(usize) -> bool + Sync + Send,
    progress: Progress<'_>,
) -> Result<Neighborhoods, Cancelled> {
    let n = points.len();
    let k = k.min(n.saturating_sub(1));
    if k == 0 {
        return Ok(Neighborhoods { adjacency: Adjacency::empty(n), radius: vec![0.0; n], k });
    }
    // The blocks hold each position once: a search among many equal points would visit all of them.
    let vertex_map = VertexMap::try_new(points, WeldMode::EqualPositions, progress)?;
    let mut positions = vertex_map.try_positions(points, progress)?;
    let unit = coordinate_unit(&positions);
    if unit != 1.0 {
        for p in &mut positions {
            *p = p.map(|c| c / unit);
        }
    }
    let members = vertex_map.members();
    let blocks = Blocks::new(&positions, progress)?;
    let is_distinct = positions.len() == n;
    let is_ordered = is_distinct && (0..).zip(vertex_map.as_slice()).all(|(x, &w)| w == x);
    let most = k + MAX_TIED;
    let scratch = || (NearestSearch::new(&blocks, k + 1, (1.0 + TIE) * (1.0 + TIE)), Vec::new());
    if is_ordered {
        let radius: Vec<AtomicU64> = (0..n).map(|_| AtomicU64::new(0)).collect();
        let adjacency = Adjacency::from_neighbors(n, progress, scratch, |(search, tied), x, out| {
            if !is_wanted(x) {
                return;
            }
            let found = search.nearest(x, |_| 1);
            radius[x].store(found.farthest.sqrt().to_bits(), Ordering::Relaxed);
            if found.names.len() <= most + 1 {
                out.extend_from_slice(found.names);
            } else {
                found.sort_by_distance(tied);
                out.extend(tied.iter().take(most + 1).map(|&(_, y)| y));
            }
        })?;
        let radius = radius.into_iter().map(|r| unit * f64::from_bits(r.into_inner())).collect();
        return Ok(Neighborhoods { adjacency, radius, k });
    }
    // Along the curve, whatever the order of the points: the neighbors of each position, one more than a point
    // needs.
    let radius: Vec<AtomicU64> = (0..positions.len()).map(|_| AtomicU64::new(0)).collect();
    let near = Adjacency::from_rows(positions.len(), progress, scratch, |(search, tied), w, out| {
        if !members.row(w).iter().any(|&x| is_wanted(x as usize)) {
            return;
        }
        let found = search.nearest(w, |w| if is_distinct { 1 } else { members.row(w as usize).len() });
        radius[w].store(found.farthest.sqrt().to_bits(), Ordering::Relaxed);
        if is_distinct && found.names.len() <= most + 1 {
            out.extend(found.names.iter().map(|&w| vertex_map.last_members()[w as usize]));
            return;
        }
        // Of many at one distance, the first in the order of the points, whatever the curve.
        let all = found.squares.iter().zip(found.names);
        tied.clear();
        tied.extend(all.flat_map(|(&square, &w)| members.row(w as usize).iter().map(move |&y| (square, y))));
        tied.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        out.extend(tied.iter().take(most + 1).map(|&(_, y)| y));
    })?;
    let adjacency = Adjacency::from_neighbors(
        n,
        progress,
        || (),
        |(), x, out| {
            if !is_wanted(x) {
                return;
            }
            let of_position = near.row(vertex_map.welded(x)).iter().copied();
            out.extend(of_position.filter(|&y| y as usize != x).take(most));
        },
    )?;
    let radius =
        (0..n).map(|x| unit * f64::from_bits(radius[vertex_map.welded(x)].load(Ordering::Relaxed))).collect();
    Ok(Neighborhoods { adjacency, radius, k })
}

/// Exponent range of moderate coordinates: between 2⁻³⁰⁰ and 2³⁰⁰ squares neither overflow nor underflow relative
/// to each other.
const MODERATE_EXPONENT: f64 = 300.0;

/// A power of two near the largest coordinate, or 1 if that is moderate; dividing by it rounds nothing that
/// matters.
fn coordinate_unit(positions: &[[f64; 3]]) -> f64 {
    let largest = positions.as_flattened().iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    let exponent = if largest > 0.0 { largest.log2().floor() } else { 0.0 };
    if exponent.abs() <= MODERATE_EXPONENT { 1.0 } else { exponent.clamp(-1000.0, 1000.0).exp2() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::distance;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_search_finds_what_comparing_all_pairs_finds(
            points in prop::collection::vec(prop::array::uniform3(-4_i8..4), 1..60), k in 1_usize..12,
        ) {
            // Small integer coordinates make ties and repeated points the rule.
            let points: Vec<[f64; 3]> = points.into_iter().map(|p| p.map(f64::from)).collect();
            let near = nearest_neighbors(&points, k);
            for (x, p) in points.iter().enumerate() {
                let mut all: Vec<f64> =
                    (0..points.len()).filter(|&y| y != x).map(|y| distance(p, &points[y])).collect();
                all.sort_by(f64::total_cmp);
                let Some(&radius) = all.get(near.k.max(1) - 1) else { continue };
                prop_assert_eq!(near.radius[x], radius);
                let expected: Vec<u32> = (0..points.len())
                    .filter(|&y| y != x && distance(p, &points[y]) <= radius)
                    .map(|y| y as u32)
                    .collect();
                if expected.len() <= near.k + MAX_TIED {
                    prop_assert_eq!(near.adjacency.row(x), &expected[..]);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn many_blocks_and_more_neighbors_than_a_block_has_change_nothing(
            seed in any::<u64>(), n in 100_usize..900, k in 1_usize..60, lumps in 1_usize..5, is_doubled: bool,
        ) {
            // Clusters of different sizes far apart, and isolated points.
            let mut state = seed | 1;
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            let mut points: Vec<[f64; 3]> = (0..n)
                .map(|i| {
                    let lump = (i % lumps) as f64;
                    let size = if i % 50 == 0 { 1e3 } else { 0.1_f64.powf(lump) };
                    [100.0 * lump + size * next(), size * next(), 0.1 * size * next()]
                })
                .collect();
            if is_doubled {
                points.extend_from_within(..n / 3);
            }
            let near = nearest_neighbors(&points, k);
            for (x, p) in points.iter().enumerate() {
                let squared = |y: usize| crate::shape::squared_distance(p, &points[y]);
                let mut all: Vec<f64> = (0..points.len()).filter(|&y| y != x).map(squared).collect();
                all.sort_by(f64::total_cmp);
                prop_assert_eq!(near.radius[x], all[k - 1].sqrt());
                let limit = all[k - 1] * (1.0 + TIE) * (1.0 + TIE);
                let expected: Vec<u32> =
                    (0..points.len()).filter(|&y| y != x && squared(y) <= limit).map(|y| y as u32).collect();
                prop_assert_eq!(near.adjacency.row(x), &expected[..]);
            }
        }
    }

    #[test]
    fn far_points_and_sizes_of_all_orders_take_no_longer() {
        const N: u32 = 40_000;
        let random = |i: u32, salt: u32| {
            f64::from((i ^ salt).wrapping_mul(2_654_435_761).rotate_left(13).wrapping_mul(2_246_822_519))
                / 4_294_967_296.0
        };
        let sheet = |i: u32| [random(i, 1), random(i, 2), 1e-3 * random(i, 3)];
        let time = |points: &[[f64; 3]]| {
            let start = std::time::Instant::now();
            assert_eq!(nearest_neighbors(points, 10).radius.len(), points.len());
            start.elapsed().as_secs_f64()
        };
        let mut points: Vec<[f64; 3]> = (0..N).map(sheet).collect();
        let usual = time(&points);
        points.push([1e12; 3]);
        let with_far = time(&points);
        let of_all_orders: Vec<_> =
            (0..N).map(|i| sheet(i).map(|c| (c - 0.5) * 10_f64.powf(20.0 * random(i, 4)))).collect();
        let of_all_orders = time(&of_all_orders);
        let overflowing: Vec<_> = (0..N).map(|i| sheet(i).map(|c| 1e200 * c)).collect();
        let overflowing = time(&overflowing);
        // Comparing all pairs would take thousands of times as long.
        let most = 30.0 * usual + 1.0;
        assert!(
            with_far < most && of_all_orders < most && overflowing < most,
            "{usual} {with_far} {of_all_orders} {overflowing}"
        );
    }

    #[test]
    fn one_point_without_a_search_has_the_same_neighbors() {
        let random =
            |i: u32, salt: u32| f64::from((i ^ salt).wrapping_mul(2_654_435_761).rotate_left(11) >> 8);
        let scattered: Vec<_> = (0..300).map(|i| [random(i, 1), random(i, 2), random(i, 3)]).collect();
        let lattice: Vec<_> =
            (0..343_u32).map(|i| [i % 7, i / 7 % 7, i / 49].map(|c| 0.1 * f64::from(c))).collect();
        // More points at one distance than are taken.
        let sphere: Vec<_> = (0..200_u32)
            .map(|i| [f64::from(i % 2), f64::from(i / 2 % 2), f64::from(i / 4)])
            .chain((0..100).map(|i| {
                let angle = f64::from(i);
                [9.0 + angle.cos(), 9.0 + angle.sin(), 0.0]
            }))
            .chain([[9.0, 9.0, 0.0]])
            .collect();
        let mut found = Vec::new();
        for points in [scattered, lattice, sphere] {
            for k in [1, 4, 10, 26, 500] {
                let near = nearest_neighbors(&points, k);
                for x in 0..points.len() {
                    assert_eq!(nearest_to_vertex(&points, x, k, &mut found), near.radius[x]);
                    assert_eq!(found, near.adjacency.row(x), "{x} of {}, k = {k}", points.len());
                }
            }
        }
    }

    #[test]
    fn squares_that_overflow_or_vanish_find_the_same() {
        let points: Vec<[f64; 3]> = (0..300_u32)
            .map(|i| [f64::from(i * 37 % 101), f64::from(i * 53 % 97), f64::from(i % 7)])
            .collect();
        let usual = nearest_neighbors(&points, 8);
        for exponent in [-1020, -600, 600, 1000] {
            let factor = 2_f64.powi(exponent);
            let scaled: Vec<_> = points.iter().map(|p| p.map(|c| c * factor)).collect();
            let near = nearest_neighbors(&scaled, 8);
            assert_eq!(near.adjacency, usual.adjacency, "2^{exponent}");
            assert!(near.radius.iter().zip(&usual.radius).all(|(r, usual)| *r == usual * factor));
        }
    }

    #[test]
    fn a_lattice_of_many_blocks_has_its_ties() {
        // Every search meets ties.
        let side = 52_u32;
        let points: Vec<[f64; 3]> = (0..side * side * side)
            .map(|i| [f64::from(i % side), f64::from(i / side % side), f64::from(i / side / side)])
            .collect();
        let near = nearest_neighbors(&points, 6);
        for (x, p) in points.iter().enumerate() {
            let inside = |c: f64| u32::from(c > 0.0) + u32::from(c < f64::from(side - 1));
            let n_faces: u32 = p.iter().map(|&c| inside(c)).sum();
            if n_faces == 6 {
                assert_eq!((near.radius[x], near.adjacency.row(x).len()), (1.0, 6), "{p:?}");
            }
        }
    }

    #[test]
    fn a_hundred_thousand_equal_points_neither_hang_nor_blow_up() {
        let near = nearest_neighbors(&vec![[1.0, 2.0, 3.0]; 100_000], 10);
        assert!((0..100_000).all(|x| near.adjacency.row(x).len() <= 10 + MAX_TIED && near.radius[x] == 0.0));
    }
}
