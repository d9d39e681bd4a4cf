//! The nearest points of every point of a cloud.

use super::{Adjacency, VertexMap, WeldMode};
use crate::parallel::{self, unstopped};
use crate::{Cancelled, Progress};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// The neighbourhoods of a cloud's points.
#[derive(Clone, Debug)]
pub struct Neighbourhoods {
    /// The points that each point names, not symmetric.
    pub adjacency: Adjacency,
    /// The distance to the k-th nearest neighbour of each point, in the points' units.
    pub radius: Vec<f64>,
    /// How many neighbours were asked for, at most one less than there are points.
    pub k: usize,
}

/// Distances that differ by less than this part are equal: on a grid of points, whatever its orientation, the last of
/// the k neighbours is one of several at the same distance, and which one it is must not hang on rounding.
const TIE: f64 = 1e-9;

/// How many neighbours beyond k a tie may add; past that the first in the order of `points` are taken.
const MAX_TIED: usize = 54;

/// The `k` nearest neighbours of every point, and those at the same distance as the k-th (see below). O(n log n).
///
/// `N(x) = {y ≠ x : ‖x − y‖ ≤ r_k(x)}`: "the k nearest" is not a definition when several points are equally far, as on
/// every regular grid or quantised scan; taking all of them keeps the operator unchanged when the cloud is rotated or its
/// points are listed in another order. At most k + 54 neighbours are taken. With fewer than k + 1 points, all others are
/// neighbours.
///
/// ```
/// use adwave::shape::nearest_neighbours;
/// let line: Vec<_> = (0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let near = nearest_neighbours(&line, 1);
/// assert_eq!(near.adjacency.of(2), [1, 3]); // both are at distance 1
/// assert_eq!(near.radius, [1.0; 5]);
/// ```
///
/// # Panics
/// Where a coordinate is NaN or infinite.
pub fn nearest_neighbours(points: &[[f64; 3]], k: usize) -> Neighbourhoods {
    unstopped(try_nearest_neighbours(points, k, Progress::none()))
}

/// [`nearest_neighbours`], stopped when the call is.
pub(crate) fn try_nearest_neighbours(
    points: &[[f64; 3]],
    k: usize,
    progress: Progress<'_>,
) -> Result<Neighbourhoods, Cancelled> {
    let n = points.len();
    let k = k.min(n.saturating_sub(1));
    let Some(wanted) = NonZeroUsize::new(k + 1).filter(|_| k > 0) else {
        return Ok(Neighbourhoods { adjacency: Adjacency::empty(n), radius: vec![0.0; n], k });
    };
    // The trees hold each position once: a search among many equal points would look at all of them.
    let vertex_map = VertexMap::try_new(points, WeldMode::EqualPositions, progress)?;
    let positions = vertex_map.try_positions(points, progress)?;
    let members = vertex_map.members();
    let forest = Forest::new(&positions, progress)?;
    let most = k + MAX_TIED;
    let search = |x: usize, count: NonZeroUsize| {
        let hits = forest.nearest(&points[x], vertex_map.welded(x), count);
        let mut found = Vec::with_capacity(count.get());
        for hit in &hits {
            let at_position = members.of(hit.1 as usize);
            // One more than can be used, because x may be among them.
            let others = at_position.iter().take(most + 1).filter(|&&y| y as usize != x);
            found.extend(others.map(|&y| (hit.0, y)));
            if found.len() > most {
                break;
            }
        }
        let all_seen = hits.len() == positions.len();
        (found, all_seen)
    };
    let radius: Vec<AtomicU64> = (0..n).map(|_| AtomicU64::new(0)).collect();
    // The search asks for a few more than k; only where even the last of them is tied does it ask again.
    let row = |x: usize, out: &mut Vec<u32>| {
        let (mut found, all_seen) = search(x, wanted.saturating_add(6));
        let kth = found[k - 1].0;
        let limit = kth * (1.0 + TIE) * (1.0 + TIE);
        if !all_seen && found.len() <= most && found[found.len() - 1].0 <= limit {
            found = search(x, wanted.saturating_add(MAX_TIED)).0;
        }
        let tied = found.partition_point(|&(d, _)| d <= limit).min(most);
        radius[x].store(kth.sqrt().to_bits(), Ordering::Relaxed);
        out.extend(found[..tied].iter().map(|&(_, y)| y));
    };
    let adjacency = Adjacency::from_neighbours(n, progress, || (), |(), x, out| row(x, out))?;
    let radius = radius.into_iter().map(|r| f64::from_bits(r.into_inner())).collect();
    Ok(Neighbourhoods { adjacency, radius, k })
}

/// Positions in a tree: one is built in a few milliseconds and cannot be interrupted.
const POSITIONS_IN_A_TREE: usize = 1 << 16;

/// Trees over runs of positions that are sorted along a curve, so that each run is near together.
struct Forest {
    trees: Vec<Tree>,
}

struct Tree {
    lo: [f64; 3],
    hi: [f64; 3],
    inside: ImmutableKdTree<f64, 3>,
}

impl Forest {
    fn new(positions: &[[f64; 3]], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let build = |(): &mut (), run: Range<usize>| {
            let run = &positions[run];
            let (lo, hi) = run.iter().fold((run[0], run[0]), |(lo, hi), p| {
                (std::array::from_fn(|c| lo[c].min(p[c])), std::array::from_fn(|c| hi[c].max(p[c])))
            });
            let inside = ImmutableKdTree::new_from_slice(run).expect("coordinates are finite");
            Tree { lo, hi, inside }
        };
        let trees = parallel::try_map_chunks(positions.len(), POSITIONS_IN_A_TREE, progress, || (), build)?;
        Ok(Self { trees })
    }

    /// The `count` positions nearest to `p`, which is near position `near`, with squared distances: by rising distance, then
    /// index.
    fn nearest(&self, p: &[f64; 3], near: usize, count: NonZeroUsize) -> Vec<(f64, u32)> {
        let own = near / POSITIONS_IN_A_TREE;
        let mut hits: Vec<(f64, u32)> = Vec::with_capacity(count.get());
        self.search(own, p, count, &mut hits);
        for other in (0..self.trees.len()).filter(|&t| t != own) {
            let farthest = if hits.len() < count.get() { f64::INFINITY } else { hits[hits.len() - 1].0 };
            if self.trees[other].squared_distance(p) <= farthest {
                self.search(other, p, count, &mut hits);
            }
        }
        hits
    }

    /// Adds the nearest of one tree to `hits` and keeps the first `count` of all.
    fn search(&self, which: usize, p: &[f64; 3], count: NonZeroUsize, hits: &mut Vec<(f64, u32)>) {
        let first = (which * POSITIONS_IN_A_TREE) as u32;
        let found = self.trees[which].inside.query(p).nearest_n::<SquaredEuclidean<f64>>(count).execute();
        hits.extend(found.iter().map(|hit| (hit.distance, first + hit.item)));
        hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        hits.truncate(count.get());
    }
}

impl Tree {
    /// At most the squared distance of `p` from any position of the tree, however that is rounded.
    fn squared_distance(&self, p: &[f64; 3]) -> f64 {
        let outside = |c: usize| (self.lo[c] - p[c]).max(p[c] - self.hi[c]).max(0.0);
        let [x, y, z] = [outside(0), outside(1), outside(2)];
        (x * x + y * y + z * z) * (1.0 - 1e-15)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::distance;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_tree_finds_what_comparing_all_pairs_finds(
            points in prop::collection::vec(prop::array::uniform3(-4_i8..4), 1..60), k in 1_usize..12,
        ) {
            // Small integer coordinates make ties and repeated points the rule.
            let points: Vec<[f64; 3]> = points.into_iter().map(|p| p.map(f64::from)).collect();
            let near = nearest_neighbours(&points, k);
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
                    prop_assert_eq!(near.adjacency.of(x), &expected[..]);
                }
            }
        }
    }

    #[test]
    fn several_trees_find_what_one_finds() {
        // A lattice of more positions than two trees hold, where every search meets ties.
        let side = 52_u32;
        let points: Vec<[f64; 3]> = (0..side * side * side)
            .map(|i| [f64::from(i % side), f64::from(i / side % side), f64::from(i / side / side)])
            .collect();
        let near = nearest_neighbours(&points, 6);
        for (x, p) in points.iter().enumerate() {
            let inside = |c: f64| u32::from(c > 0.0) + u32::from(c < f64::from(side - 1));
            let n_faces: u32 = p.iter().map(|&c| inside(c)).sum();
            if n_faces == 6 {
                assert_eq!((near.radius[x], near.adjacency.of(x).len()), (1.0, 6), "{p:?}");
            }
        }
    }

    #[test]
    fn a_hundred_thousand_equal_points_neither_hang_nor_blow_up() {
        let near = nearest_neighbours(&vec![[1.0, 2.0, 3.0]; 100_000], 10);
        assert!((0..100_000).all(|x| near.adjacency.of(x).len() <= 10 + MAX_TIED && near.radius[x] == 0.0));
    }
}
