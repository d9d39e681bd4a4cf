//! The nearest points of every point of a cloud.

use super::{Adjacency, VertexMap, WeldMode};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;
use std::num::NonZeroUsize;

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
pub fn nearest_neighbours(points: &[[f64; 3]], k: usize) -> Neighbourhoods {
    let n = points.len();
    let k = k.min(n.saturating_sub(1));
    let Some(wanted) = NonZeroUsize::new(k + 1).filter(|_| k > 0) else {
        let adjacency = Adjacency { offsets: vec![0; n + 1], neighbours: Vec::new() };
        return Neighbourhoods { adjacency, radius: vec![0.0; n], k };
    };
    // The tree holds each position once: a search among many equal points would look at all of them.
    let vertex_map = VertexMap::new(points, WeldMode::EqualPositions);
    let positions = vertex_map.positions(points);
    let (first_member, members) = vertex_map.members();
    let tree: ImmutableKdTree<f64, 3> =
        ImmutableKdTree::new_from_slice(&positions).expect("the tree of finitely many finite points");
    let most = k + MAX_TIED;
    let search = |x: usize, count: NonZeroUsize| {
        let mut hits = tree.query(&points[x]).nearest_n::<SquaredEuclidean<f64>>(count).execute();
        hits.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.item.cmp(&b.item)));
        let mut found = Vec::with_capacity(count.get());
        for hit in &hits {
            let class = hit.item as usize;
            let at_position = &members[first_member[class]..first_member[class + 1]];
            // One more than can be used, because x may be among them.
            found.extend(
                at_position.iter().take(most + 1).filter(|&&y| y as usize != x).map(|&y| (hit.distance, y)),
            );
            if found.len() > most {
                break;
            }
        }
        let all_seen = hits.len() == positions.len();
        (found, all_seen)
    };
    // The search asks for a few more than k; only where even the last of them is tied does it ask again.
    let rows: Vec<(f64, Vec<u32>)> = (0..n)
        .into_par_iter()
        .map(|x| {
            let (mut found, all_seen) = search(x, wanted.saturating_add(6));
            let kth = found[k - 1].0;
            let limit = kth * (1.0 + TIE) * (1.0 + TIE);
            if !all_seen && found.len() <= most && found[found.len() - 1].0 <= limit {
                found = search(x, wanted.saturating_add(MAX_TIED)).0;
            }
            let tied = found.partition_point(|&(d, _)| d <= limit).min(most);
            (kth.sqrt(), found[..tied].iter().map(|&(_, y)| y).collect())
        })
        .collect();
    let adjacency = Adjacency::from_rows(n, || (), |(), x, out| out.extend_from_slice(&rows[x].1));
    Neighbourhoods { adjacency, radius: rows.into_iter().map(|row| row.0).collect(), k }
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
    fn a_hundred_thousand_equal_points_neither_hang_nor_blow_up() {
        let near = nearest_neighbours(&vec![[1.0, 2.0, 3.0]; 100_000], 10);
        assert!((0..100_000).all(|x| near.adjacency.of(x).len() <= 10 + MAX_TIED && near.radius[x] == 0.0));
    }
}
