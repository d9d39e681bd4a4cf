//! Welding: vertices at exactly equal positions become one welded vertex.
//!
//! STL stores every triangle with its own corners, and OBJ and glTF split vertices along texture seams; without
//! welding, diffusion could not cross there. The welded vertices are numbered along a Hilbert curve, so vertices
//! that are close in space are close in memory whatever the order of the file, and the file's order does not change
//! a single bit of the result.

use super::hilbert::{HILBERT_BITS, hilbert};
use crate::parallel::{self, expect_not_cancelled};
use crate::rows::{Pattern, incidence};
use crate::{Cancelled, Progress};
use std::cmp::Ordering;
use std::sync::atomic::{self, AtomicU32};
use std::sync::{Arc, OnceLock};

/// Treatment of vertices at equal or nearly equal positions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum WeldMode {
    /// Vertices at equal positions are one welded vertex, and so are the ends of edges of open borders that nearly
    /// coincide: within four steps of 32-bit floats or a millionth of the shortest edge there, and at most a thousandth
    /// of it.
    #[default]
    Seams,
    /// Like `Seams`, with a tolerance in model units, which counts up to half of the shortest edge there.
    Within(f64),
    /// Vertices with three equal coordinates are one welded vertex (0 and −0 are equal).
    EqualPositions,
    /// Every vertex is a welded vertex.
    Off,
}

/// Map from the vertices `0..n_vertices()` of a shape onto the welded vertices `0..n_welded()`; for a graph, whose
/// nodes have no positions, a permutation. Copies share it.
#[derive(Clone, Debug)]
pub struct VertexMap(Arc<Classes>);

#[derive(Debug)]
enum Classes {
    /// Each vertex is a class: a grid has as many vertices as values, so that their numbers are listed only if they are
    /// asked for.
    Each { n_vertices: usize, listed: OnceLock<Vec<u32>> },
    Listed {
        welded: Vec<u32>,
        /// Last vertex of the shape in each class.
        last_member: Vec<u32>,
    },
}

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 13;

impl VertexMap {
    /// Groups `points` by position. O(n log n).
    ///
    /// ```
    /// use adwave::shape::{VertexMap, WeldMode};
    /// let vertex_map = VertexMap::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-0.0, 0.0, 0.0]], WeldMode::EqualPositions);
    /// assert_eq!(vertex_map.n_welded(), 2);
    /// assert_eq!(vertex_map.welded(0), vertex_map.welded(2));
    /// ```
    pub fn new(points: &[[f64; 3]], mode: WeldMode) -> Self {
        expect_not_cancelled(Self::try_new(points, mode, Progress::none()))
    }

    /// [`new`](Self::new); stops if the call is cancelled.
    pub(crate) fn try_new(
        points: &[[f64; 3]],
        mode: WeldMode,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n = points.len();
        if n == 0 {
            return Ok(Self::identity(0));
        }
        let mut order: Vec<(u64, u32)> = parallel::try_collect(n, progress, |i| (0, i as u32))?;
        sort_along_curve(points, &mut order, progress)?;
        let starts_class = |k: usize| {
            let (before, here) = (order[k - 1], order[k]);
            mode == WeldMode::Off
                || before.0 != here.0
                || points[before.1 as usize] != points[here.1 as usize]
        };
        // At the start of a class, the class before has had its last member.
        let ended: Vec<Vec<u32>> = parallel::try_map_chunks(
            n,
            VERTICES_AT_A_TIME,
            progress,
            || (),
            |(), range| {
                let starts = range.filter(|&k| k > 0 && starts_class(k));
                starts.map(|k| order[k - 1].1).collect()
            },
        )?;
        let mut last_member = Vec::with_capacity(ended.iter().map(Vec::len).sum::<usize>() + 1);
        let mut classes_before = Vec::with_capacity(ended.len());
        for ended in ended {
            classes_before.push(last_member.len() as u32);
            last_member.extend(ended);
        }
        last_member.push(order[n - 1].1);
        let welded: Vec<AtomicU32> = (0..n).map(|_| AtomicU32::new(0)).collect();
        parallel::try_map_chunks(
            n,
            VERTICES_AT_A_TIME,
            progress,
            || (),
            |(), range| {
                let mut class = classes_before[range.start / VERTICES_AT_A_TIME];
                for k in range {
                    class += u32::from(k > 0 && starts_class(k));
                    welded[order[k].1 as usize].store(class, atomic::Ordering::Relaxed);
                }
            },
        )?;
        let welded = welded.into_iter().map(AtomicU32::into_inner).collect();
        Ok(Self::listed(welded, last_member))
    }

    /// Map with some welded vertices made one: `roots` has the smallest member of each vertex's set. The position of a
    /// set is that of its smallest member.
    pub(super) fn merged(&self, roots: &[u32]) -> Self {
        let mut number = vec![0; roots.len()];
        let mut last_member = Vec::new();
        for (x, &root) in roots.iter().enumerate() {
            if root as usize == x {
                number[x] = last_member.len() as u32;
                last_member.push(self.last_members()[x]);
            } else {
                number[x] = number[root as usize];
            }
        }
        let welded = self.as_slice().iter().map(|&x| number[x as usize]).collect();
        Self::listed(welded, last_member)
    }

    /// A map without welding, with `welded(x) == place[x]`; each place occurs once.
    pub(crate) fn from_places(place: Vec<u32>) -> Self {
        let mut vertex_at = vec![0; place.len()];
        for (x, &place) in (0..).zip(&place) {
            vertex_at[place as usize] = x;
        }
        Self::listed(place, vertex_at)
    }

    /// A map with `welded(x) == class[x]`; each of the `n_classes` classes has a vertex.
    pub(crate) fn from_classes(class: Vec<u32>, n_classes: usize) -> Self {
        let mut last_member = vec![0; n_classes];
        for (x, &class) in (0..).zip(&class) {
            last_member[class as usize] = x;
        }
        Self::listed(class, last_member)
    }

    /// The maps one after another: the vertices and welded vertices of each follow those of the one before.
    pub(crate) fn union<'a>(maps: impl Iterator<Item = &'a Self>) -> Self {
        let (mut welded, mut last_member) = (Vec::new(), Vec::new());
        for map in maps {
            let (first_vertex, first) = (welded.len() as u32, last_member.len() as u32);
            welded.extend(map.as_slice().iter().map(|x| first + x));
            last_member.extend(map.last_members().iter().map(|x| first_vertex + x));
        }
        Self::listed(welded, last_member)
    }

    /// A map without welding, in the given order: `welded(x) == x`.
    pub fn identity(n_vertices: usize) -> Self {
        Self(Arc::new(Classes::Each { n_vertices, listed: OnceLock::new() }))
    }

    fn listed(welded: Vec<u32>, last_member: Vec<u32>) -> Self {
        Self(Arc::new(Classes::Listed { welded, last_member }))
    }

    /// True if the map was made as the identity, so that values need no new order.
    pub(crate) fn is_identity(&self) -> bool {
        matches!(*self.0, Classes::Each { .. })
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        match &*self.0 {
            Classes::Each { n_vertices, .. } => *n_vertices,
            Classes::Listed { welded, .. } => welded.len(),
        }
    }

    /// Number of welded vertices.
    pub fn n_welded(&self) -> usize {
        match &*self.0 {
            Classes::Each { n_vertices, .. } => *n_vertices,
            Classes::Listed { last_member, .. } => last_member.len(),
        }
    }

    /// Welded vertex of vertex `x` of the shape.
    pub fn welded(&self, x: usize) -> usize {
        match &*self.0 {
            Classes::Each { .. } => x,
            Classes::Listed { welded, .. } => welded[x] as usize,
        }
    }

    /// [`welded`](Self::welded) for all vertices.
    pub fn as_slice(&self) -> &[u32] {
        match &*self.0 {
            Classes::Each { n_vertices, listed } => numbers(*n_vertices, listed),
            Classes::Listed { welded, .. } => welded,
        }
    }

    /// The last vertex of the shape in each welded vertex.
    pub(crate) fn last_members(&self) -> &[u32] {
        match &*self.0 {
            Classes::Each { n_vertices, listed } => numbers(*n_vertices, listed),
            Classes::Listed { last_member, .. } => last_member,
        }
    }

    /// The vertices of the shape in each welded vertex, in ascending order.
    pub(crate) fn members(&self) -> Pattern {
        expect_not_cancelled(self.try_members(Progress::none()))
    }

    fn try_members(&self, progress: Progress<'_>) -> Result<Pattern, Cancelled> {
        let welded = self.as_slice();
        incidence(self.n_welded(), self.n_vertices(), progress, |x| std::slice::from_ref(&welded[x]))
    }

    /// The positions of the welded vertices.
    ///
    /// # Panics
    /// Unless there is one position per vertex of the shape.
    pub fn positions(&self, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        expect_not_cancelled(self.try_positions(points, Progress::none()))
    }

    /// [`positions`](Self::positions); stops if the call is cancelled.
    pub(crate) fn try_positions(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let members = self.last_members();
        let position = |class: usize| points[members[class] as usize].map(|c| c + 0.0); // −0 becomes 0
        parallel::try_collect(self.n_welded(), progress, position)
    }

    /// Mean of `signal` (n_vertices × n_channels, row-major) over the vertices of each class.
    ///
    /// If all values of a class are equal, the mean is exactly that value.
    pub fn mean(&self, signal: &[f64], n_channels: usize) -> Vec<f64> {
        expect_not_cancelled(self.try_mean(signal, n_channels, Progress::none()))
    }

    /// [`mean`](Self::mean); stops if the call is cancelled.
    pub(crate) fn try_mean(
        &self,
        signal: &[f64],
        n_channels: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let mut mean = vec![0.0; self.n_welded() * n_channels];
        if n_channels == 0 {
            return Ok(mean);
        }
        if self.is_identity() {
            parallel::try_visit_rows(&mut mean, n_channels, VERTICES_AT_A_TIME, progress, |first, rows| {
                rows.copy_from_slice(&signal[first * n_channels..][..rows.len()]);
            })?;
            return Ok(mean);
        }
        let row = |x: u32| &signal[x as usize * n_channels..][..n_channels];
        if self.n_welded() == self.n_vertices() {
            parallel::try_visit_rows(&mut mean, n_channels, VERTICES_AT_A_TIME, progress, |first, rows| {
                for (mean, &x) in rows.chunks_exact_mut(n_channels).zip(&self.last_members()[first..]) {
                    mean.copy_from_slice(row(x));
                }
            })?;
            return Ok(mean);
        }
        let members = self.try_members(progress)?;
        parallel::try_visit_rows(&mut mean, n_channels, VERTICES_AT_A_TIME, progress, |first, rows| {
            for (class, mean) in (first..).zip(rows.chunks_exact_mut(n_channels)) {
                for (count, &x) in (1..).zip(members.row(class)) {
                    for (m, value) in mean.iter_mut().zip(row(x)) {
                        *m += (value - *m) / f64::from(count);
                    }
                }
            }
        })?;
        Ok(mean)
    }

    /// Copies the value of its class to every vertex of the shape: n_welded × n_channels → n_vertices × n_channels.
    pub fn scatter<T: Copy + Send + Sync>(&self, values: &[T], n_channels: usize) -> Vec<T> {
        expect_not_cancelled(self.try_scatter(values, n_channels, Progress::none()))
    }

    /// [`scatter`](Self::scatter); stops if the call is cancelled.
    pub(crate) fn try_scatter<T: Copy + Send + Sync>(
        &self,
        values: &[T],
        n_channels: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<T>, Cancelled> {
        let Some(&any) = values.first() else { return Ok(Vec::new()) };
        let mut scattered = vec![any; self.n_vertices() * n_channels];
        if self.is_identity() {
            parallel::try_visit_rows(
                &mut scattered,
                n_channels,
                VERTICES_AT_A_TIME,
                progress,
                |first, rows| {
                    rows.copy_from_slice(&values[first * n_channels..][..rows.len()]);
                },
            )?;
            return Ok(scattered);
        }
        parallel::try_visit_rows(&mut scattered, n_channels, VERTICES_AT_A_TIME, progress, |first, rows| {
            for (row, &class) in rows.chunks_exact_mut(n_channels).zip(&self.as_slice()[first..]) {
                row.copy_from_slice(&values[class as usize * n_channels..][..n_channels]);
            }
        })?;
        Ok(scattered)
    }
}

/// The numbers from 0 on.
fn numbers(n: usize, listed: &OnceLock<Vec<u32>>) -> &[u32] {
    listed.get_or_init(|| (0..n as u32).collect())
}

/// Compares points by their coordinates; 0 and −0 are equal.
fn compare(p: &[f64; 3], q: &[f64; 3]) -> Ordering {
    let [x, y, z] = [0, 1, 2].map(|c| (p[c] + 0.0).total_cmp(&(q[c] + 0.0)));
    x.then(y).then(z)
}

/// Sorts vertices by their Hilbert keys in their common bounding box, then by position and index.
///
/// If many vertices share a key, because a few others are very far away, they are sorted by keys in their own box:
/// each level makes cells 2²¹ times smaller.
fn sort_along_curve(
    points: &[[f64; 3]],
    order: &mut [(u64, u32)],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let n = order.len();
    let boxes = parallel::try_map_chunks(
        n,
        VERTICES_AT_A_TIME,
        progress,
        || (),
        |(), range| {
            order[range].iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(lo, hi), &(_, x)| {
                let p = &points[x as usize];
                (std::array::from_fn(|c| p[c].min(lo[c])), std::array::from_fn(|c| p[c].max(hi[c])))
            })
        },
    )?;
    let low = |c: usize| boxes.iter().map(|(lo, _)| lo[c]).fold(f64::INFINITY, f64::min);
    let high = |c: usize| boxes.iter().map(|(_, hi)| hi[c]).fold(f64::NEG_INFINITY, f64::max);
    let lo = [0, 1, 2].map(low);
    let extent = (0..3).map(|c| high(c) - lo[c]).fold(0.0, f64::max);
    let cells = f64::from((1_u32 << HILBERT_BITS) - 1);
    let scale = if extent > 0.0 { cells / extent } else { 0.0 };
    parallel::try_visit_rows(order, 1, VERTICES_AT_A_TIME, progress, |_, rows| {
        for (key, x) in rows {
            let p = &points[*x as usize];
            // `scale` may overflow for a shape of subnormal extent; the cast saturates, and the exact comparison
            // below still separates unequal points.
            *key = hilbert(std::array::from_fn(|c| ((p[c] - lo[c]) * scale) as u32));
        }
    })?;
    let in_order = |a: &(u64, u32), b: &(u64, u32)| {
        let by_position = || compare(&points[a.1 as usize], &points[b.1 as usize]);
        a.0.cmp(&b.0).then_with(by_position).then(a.1.cmp(&b.1))
    };
    // Unchanged if the points belong to another map.
    if !order.is_sorted_by(|a, b| in_order(a, b).is_lt()) {
        parallel::sort_by_key_bits(order, 3 * HILBERT_BITS, progress, |entry| entry.0)?;
        let runs: Vec<_> = order.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1).collect();
        parallel::try_each(runs, n, progress, |run| parallel::sort_unstable_by(run, progress, in_order))?;
    }
    let is_split = order[0].0 != order[n - 1].0;
    let runs: Vec<_> =
        order.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > MOST_IN_A_CELL).collect();
    if is_split {
        parallel::try_each(runs, n, progress, |run| sort_along_curve(points, run, progress))?;
    }
    Ok(())
}

/// Number of vertices with one key that stay in the order of their positions.
const MOST_IN_A_CELL: usize = 32;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_point_far_away_does_not_disturb_the_order_of_the_others() {
        let mut points: Vec<[f64; 3]> =
            (0..4000_u32).map(|i| [f64::from(i * 7919 % 4000), f64::from(i * 104_729 % 4001), 0.0]).collect();
        points.extend_from_within(..100);
        let alone = VertexMap::new(&points, WeldMode::EqualPositions);
        // The next levels are cells within cells.
        for far in [1e12, 1e25, 1e80] {
            let mut with_far = points.clone();
            with_far.push([far; 3]);
            let map = VertexMap::new(&with_far, WeldMode::EqualPositions);
            assert_eq!(map.n_welded(), alone.n_welded() + 1);
            let step = |map: &VertexMap| {
                let places = map.positions(&with_far[..map.n_vertices()]);
                places.windows(2).map(|p| super::super::distance(&p[0], &p[1]).min(1e5)).sum::<f64>()
            };
            assert!(step(&map) < 1.5 * step(&alone) + 1e5, "{far}: {} beside {}", step(&map), step(&alone));
        }
    }

    #[test]
    fn the_order_of_the_points_does_not_change_the_classes() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, -0.0, 0.0], [0.2, 0.9, 1e-300]];
        let forward = VertexMap::new(&points, WeldMode::EqualPositions);
        let reversed: Vec<_> = points.iter().rev().copied().collect();
        let backward = VertexMap::new(&reversed, WeldMode::EqualPositions);
        assert_eq!(forward.positions(&points), backward.positions(&reversed));
        assert_eq!(forward.n_welded(), 3);
        assert_eq!(VertexMap::new(&points, WeldMode::Off).n_welded(), 4);
    }

    #[test]
    fn the_mean_of_equal_values_is_that_value() {
        let (welded, last_member) = (vec![0, 1, 0, 0], vec![3, 1]);
        let vertex_map = VertexMap::listed(welded, last_member);
        assert_eq!(vertex_map.mean(&[0.1, 7.0, 0.1, 0.1], 1), [0.1, 7.0]);
        assert_eq!(vertex_map.mean(&[1.0, 0.0, 2.0, 3.0], 1)[0], 2.0);
        assert_eq!(vertex_map.scatter(&[5, 6], 1), [5, 6, 5, 5]);
    }
}
