//! Exact nearest neighbors of points in any dimension, by blocks.
//!
//! Points that are close to each other form blocks. Blocks whose distance exceeds the neighbors found so far are passed
//! over; of the others, only pairs that may be among the nearest by products in single precision with a bound of their
//! rounding are measured in double precision. So the result is exact, whatever the order of the points and the number
//! of threads.

use crate::GraphWalkError;
use crate::point_blocks::{PointBlocks, QUERIES};
use adwave::Progress;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Largest number of neighbors beyond k that a tie may add.
pub const MAX_TIED: usize = 54;

/// Relative difference below which distances are equal, as for clouds in space.
const TIE: f64 = 1e-9;

/// Largest size of a coordinate.
const LARGEST: f64 = 1e100;

/// Points of any dimension, n_points × n_dimensions, row after row.
#[derive(Clone, Copy, Debug)]
pub struct DimensionedPoints<'a> {
    /// The coordinates.
    pub values: &'a [f64],
    /// Number of coordinates of a point.
    pub n_dimensions: usize,
}

impl DimensionedPoints<'_> {
    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.values.len() / self.n_dimensions.max(1)
    }

    fn check(&self) -> Result<(), GraphWalkError> {
        let (n_values, n_dimensions) = (self.values.len(), self.n_dimensions);
        if n_dimensions == 0 || !n_values.is_multiple_of(n_dimensions) {
            return Err(GraphWalkError::PointsLength { n_values, n_dimensions });
        }
        match self.values.iter().position(|v| v.is_nan() || v.abs() > LARGEST) {
            None => Ok(()),
            Some(at) => Err(GraphWalkError::BadCoordinate {
                point: at / n_dimensions,
                dimension: at % n_dimensions,
                value: self.values[at],
            }),
        }
    }
}

/// Neighbors of each point, from near to far and by index at equal distance, without the point itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NearestLists {
    /// Start of each list, and the end of the last: n_points + 1 numbers.
    pub offsets: Vec<usize>,
    /// Indices of the neighbors.
    pub indices: Vec<u32>,
    /// Distances of the neighbors.
    pub distances: Vec<f64>,
}

impl NearestLists {
    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Neighbors of a point and their distances.
    pub fn row(&self, x: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[x]..self.offsets[x + 1];
        (&self.indices[range.clone()], &self.distances[range])
    }

    /// Lists from n × k arrays that another program computed. Negative indices mean none, a point in its own list is
    /// left out, and lists are sorted. O(n·k log k).
    ///
    /// # Errors
    /// [`GraphWalkError`] if the arrays have different lengths, an index is no point, or a distance is negative or not
    /// finite.
    ///
    /// ```
    /// use adwave_graph::NearestLists;
    /// let lists = NearestLists::from_arrays(2, &[0, 1, 1, 0], &[0.0, 3.0, 0.0, 3.0])?;
    /// assert_eq!(lists.row(0), ([1].as_slice(), [3.0].as_slice()));
    /// # Ok::<(), adwave_graph::GraphWalkError>(())
    /// ```
    pub fn from_arrays(n_points: usize, indices: &[i64], distances: &[f64]) -> Result<Self, GraphWalkError> {
        let (n_indices, n_distances) = (indices.len(), distances.len());
        if n_indices != n_distances
            || n_points == 0 && n_indices > 0
            || n_points > 0 && n_indices % n_points != 0
        {
            return Err(GraphWalkError::ListsLength { n_indices, n_distances, n_points });
        }
        let k = n_indices / n_points.max(1);
        let mut lists = Self { offsets: vec![0], ..Self::default() };
        let mut row = Vec::with_capacity(k);
        for point in 0..n_points {
            row.clear();
            for (&neighbor, &distance) in indices[point * k..][..k].iter().zip(&distances[point * k..]) {
                if neighbor < 0 || neighbor as usize == point {
                    continue;
                }
                if neighbor as usize >= n_points {
                    return Err(GraphWalkError::NoNeighbor { point, neighbor, n_points });
                }
                if !(distance >= 0.0 && distance.is_finite()) {
                    return Err(GraphWalkError::BadDistance { point, neighbor: neighbor as usize, distance });
                }
                row.push(NearCandidate { square: distance, index: neighbor as u32 });
            }
            row.sort_unstable_by(NearCandidate::compare);
            row.dedup_by_key(|candidate| candidate.index);
            lists.indices.extend(row.iter().map(|candidate| candidate.index));
            lists.distances.extend(row.iter().map(|candidate| candidate.square));
            lists.offsets.push(lists.indices.len());
        }
        Ok(lists)
    }
}

/// A point that may be among the nearest.
#[derive(Clone, Copy, Debug)]
struct NearCandidate {
    square: f64,
    index: u32,
}

impl NearCandidate {
    fn compare(&self, other: &Self) -> Ordering {
        self.square.total_cmp(&other.square).then(self.index.cmp(&other.index))
    }
}

/// The nearest points found so far, sorted: the k nearest and those tied with the k-th.
struct NearestSoFar {
    k: usize,
    found: Vec<NearCandidate>,
}

impl NearestSoFar {
    /// Largest squared distance that may still be among the nearest.
    fn limit(&self) -> f64 {
        match self.found.get(self.k - 1) {
            Some(farthest) => farthest.square * ((1.0 + TIE) * (1.0 + TIE)),
            None => f64::INFINITY,
        }
    }

    fn insert(&mut self, candidate: NearCandidate) {
        if candidate.square > self.limit() {
            return;
        }
        let at = self.found.partition_point(|other| other.compare(&candidate) == Ordering::Less);
        self.found.insert(at, candidate);
        let limit = self.limit();
        let kept = self.found.partition_point(|other| other.square <= limit);
        self.found.truncate(kept.min(self.k + MAX_TIED));
    }
}

/// Finds the `k` nearest neighbors of every point, and those at the same distance as the k-th within a relative 1e-9,
/// at most k + 54: the same rule as for clouds in space. With fewer than k + 1 points all others are neighbors. O(n²·d)
/// at most; less if the points lie near a surface of few dimensions or in clusters.
///
/// # Errors
/// [`GraphWalkError`] if the values are not n × d or a coordinate is not finite, or the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave_graph::{DimensionedPoints, nearest_lists};
/// let line = DimensionedPoints { values: &[0.0, 1.0, 2.0, 4.0], n_dimensions: 1 };
/// let near = nearest_lists(line, 1, Progress::none())?;
/// assert_eq!(near.row(1), ([0, 2].as_slice(), [1.0, 1.0].as_slice())); // both are nearest
/// assert_eq!(near.row(3), ([2].as_slice(), [2.0].as_slice()));
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn nearest_lists(
    points: DimensionedPoints<'_>,
    k: usize,
    progress: Progress<'_>,
) -> Result<NearestLists, GraphWalkError> {
    points.check()?;
    let n = points.n_points();
    let k = k.min(n.saturating_sub(1));
    if k == 0 {
        return Ok(NearestLists { offsets: vec![0; n + 1], ..NearestLists::default() });
    }
    let blocks = PointBlocks::new(points, progress)?;
    let n_searches = n.div_ceil(QUERIES);
    let found: Vec<Vec<NearestSoFar>> = (0..n_searches)
        .into_par_iter()
        .map(|search| search_block(&blocks, search * QUERIES, k, progress))
        .collect::<Result<_, GraphWalkError>>()?;
    progress.step(n_searches as u64, n_searches as u64)?;
    let mut lists = NearestLists { offsets: vec![0], ..NearestLists::default() };
    for place in blocks.places() {
        for candidate in &found[place / QUERIES][place % QUERIES].found {
            lists.indices.push(candidate.index);
            lists.distances.push(blocks.unit() * candidate.square.sqrt());
        }
        lists.offsets.push(lists.indices.len());
    }
    Ok(lists)
}

/// The nearest points of the points at the places from `first` on.
fn search_block(
    blocks: &PointBlocks<'_>,
    first: usize,
    k: usize,
    progress: Progress<'_>,
) -> Result<Vec<NearestSoFar>, GraphWalkError> {
    let n_queries = QUERIES.min(blocks.n_points() - first);
    let queries = blocks.queries(first, n_queries);
    let mut nearest: Vec<NearestSoFar> =
        (0..n_queries).map(|_| NearestSoFar { k, found: Vec::with_capacity(k + 2) }).collect();
    let mut thresholds = vec![f32::NEG_INFINITY; QUERIES];
    let near = blocks.near_blocks(first, n_queries, &queries);
    for &(bound, other) in &near.blocks {
        progress.check()?;
        let threshold =
            |q: usize, nearest: &NearestSoFar| blocks.threshold(first + q, other, nearest.limit());
        let mut is_any = false;
        for (q, nearest) in nearest.iter().enumerate() {
            let limit = nearest.limit();
            let may_reach = bound <= limit && blocks.may_reach(&near, q, other, limit);
            is_any |= may_reach;
            thresholds[q] = if may_reach { threshold(q, nearest) } else { f32::NEG_INFINITY };
        }
        if !is_any {
            continue;
        }
        blocks.visit_near(&queries, other, &mut thresholds, |q, place| {
            let nearest = &mut nearest[q];
            if place != first + q {
                let square = blocks.squared_distance(first + q, place);
                nearest.insert(NearCandidate { square, index: blocks.index_at(place) });
            }
            threshold(q, nearest)
        });
    }
    Ok(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        (0..n).map(|_| next()).collect()
    }

    /// The definition, without blocks.
    fn by_definition(values: &[f64], d: usize, k: usize) -> Vec<Vec<u32>> {
        let n = values.len() / d;
        let square = |x: usize, y: usize| -> f64 {
            (0..d).map(|c| (values[x * d + c] - values[y * d + c]).powi(2)).sum()
        };
        let list = |x: usize| {
            let mut all: Vec<(f64, u32)> =
                (0..n).filter(|&y| y != x).map(|y| (square(x, y), y as u32)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let limit = all[k - 1].0 * (1.0 + TIE) * (1.0 + TIE);
            let mut near: Vec<u32> = all.into_iter().filter(|a| a.0 <= limit).map(|a| a.1).collect();
            near.truncate(k + MAX_TIED);
            near.sort_unstable();
            near
        };
        (0..n).map(list).collect()
    }

    fn sorted(lists: &NearestLists) -> Vec<Vec<u32>> {
        let row = |x: usize| {
            let mut row = lists.row(x).0.to_vec();
            row.sort_unstable();
            row
        };
        (0..lists.n_points()).map(row).collect()
    }

    #[test]
    fn neighbors_are_those_of_the_definition_in_any_dimension() {
        for (n, d, k) in [(300, 1, 3), (2500, 2, 7), (2100, 50, 15), (400, 130, 9)] {
            let values = noise(n * d, (n + d) as u64);
            let points = DimensionedPoints { values: &values, n_dimensions: d };
            let found = nearest_lists(points, k, Progress::none()).unwrap();
            assert_eq!(sorted(&found), by_definition(&values, d, k), "{n} × {d}");
        }
    }

    #[test]
    fn clusters_far_from_each_other_are_measured_exactly() {
        // Distances of 1e-6 within clusters at 1e6: single precision sees none of them.
        let mut values = noise(900 * 5, 3);
        for (i, v) in values.iter_mut().enumerate() {
            *v = *v * 1e-6 + if (i / 5) % 3 == 0 { 1e6 } else { -1e6 };
        }
        let found =
            nearest_lists(DimensionedPoints { values: &values, n_dimensions: 5 }, 4, Progress::none())
                .unwrap();
        assert_eq!(sorted(&found), by_definition(&values, 5, 4));
    }

    #[test]
    fn blocks_of_other_clusters_are_passed_over_without_losing_a_neighbor() {
        // Seven clusters that are not sorted, some of them close enough to share neighbors.
        let (n, d) = (1900, 12);
        let (mut values, centers) = (noise(n * d, 8), noise(7 * d, 9));
        for (i, v) in values.iter_mut().enumerate() {
            *v = 0.4 * *v + 3.0 * centers[(i / d) % 7 * d + i % d];
        }
        let points = DimensionedPoints { values: &values, n_dimensions: d };
        let found = nearest_lists(points, 10, Progress::none()).unwrap();
        assert_eq!(sorted(&found), by_definition(&values, d, 10));
    }

    #[test]
    fn ties_on_a_grid_are_all_taken_as_for_clouds_in_space() {
        let grid: Vec<[f64; 3]> =
            (0..6 * 6 * 6).map(|i| [f64::from(i % 6), f64::from(i / 6 % 6), f64::from(i / 36)]).collect();
        let points = DimensionedPoints { values: grid.as_flattened(), n_dimensions: 3 };
        let found = nearest_lists(points, 5, Progress::none()).unwrap();
        let space = adwave::shape::nearest_neighbors(&grid, 5);
        for (x, row) in sorted(&found).iter().enumerate() {
            assert_eq!(row, space.adjacency.row(x), "{x}");
            assert_eq!(*found.row(x).1.last().unwrap(), space.radius[x]);
        }
    }

    #[test]
    fn equal_points_and_small_clouds_have_lists_and_wrong_input_an_error() {
        let same = vec![2.5; 200 * 4];
        let found =
            nearest_lists(DimensionedPoints { values: &same, n_dimensions: 4 }, 3, Progress::none()).unwrap();
        assert_eq!(found.row(7).0.len(), 3 + MAX_TIED);
        assert!(found.distances.iter().all(|&distance| distance == 0.0));
        for n in 0..3 {
            let values = noise(n * 2, 1);
            let points = DimensionedPoints { values: &values, n_dimensions: 2 };
            let found = nearest_lists(points, 10, Progress::none()).unwrap();
            assert_eq!(found.n_points(), n);
            assert!((0..n).all(|x| found.row(x).0.len() == n - 1));
        }
        let wrong = |values: &[f64], n_dimensions| {
            nearest_lists(DimensionedPoints { values, n_dimensions }, 1, Progress::none())
                .unwrap_err()
                .to_string()
        };
        assert!(wrong(&[1.0, f64::NAN], 1).contains("coordinate 0 of point 1"));
        assert!(wrong(&[1.0, 2.0, 3.0], 2).contains("n × d"));
        assert!(wrong(&[], 0).contains("at least 1"));
    }

    #[test]
    fn lists_of_others_are_sorted_and_checked() {
        let lists = NearestLists::from_arrays(
            3,
            &[0, 2, 1, -1, 0, 2, 2, 0, 1],
            &[0.0, 2.0, 1.0, 0.0, 1.0, 5.0, 0.0, 2.0, 5.0],
        )
        .unwrap();
        assert_eq!(lists.row(0), ([1, 2].as_slice(), [1.0, 2.0].as_slice()));
        assert_eq!(lists.row(1).0, [0, 2]);
        assert!(NearestLists::from_arrays(2, &[1, 7], &[1.0, 1.0]).is_err());
        assert!(NearestLists::from_arrays(2, &[1, 0], &[1.0, f64::NAN]).is_err());
        assert!(NearestLists::from_arrays(2, &[1, 0, 1], &[1.0, 1.0, 1.0]).is_err());
    }
}
