//! Triangles of double-sided meshes, taken once.

use crate::parallel;
use std::collections::HashMap;

/// Vertices whose triangles a thread compares at a time.
const CORNERS_AT_A_TIME: usize = 1 << 13;

/// Triangles of which each that occurs in both orientations is kept once, oriented like its neighbors.
///
/// Exporters make a surface visible from both sides by a second copy of each triangle, reversed. The normals of both
/// copies cancel, so that noise along them could not be measured. Triangles that occur in one orientation stay as they
/// are. O(n).
pub(super) fn without_reverse_sides(triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    if !has_reverse_sides(&triangles) {
        return triangles;
    }
    let mut sides: HashMap<[u32; 3], [bool; 2]> = HashMap::with_capacity(triangles.len());
    for triangle in &triangles {
        let (key, is_odd) = sort_corners(*triangle);
        sides.entry(key).or_default()[usize::from(is_odd)] = true;
    }
    let is_double = |key: &[u32; 3], sides: &HashMap<[u32; 3], [bool; 2]>| {
        sides.get(key).is_some_and(|found| *found == [true; 2]) && key[0] != key[1] && key[1] != key[2]
    };
    let (mut kept, mut may_turn) = (Vec::with_capacity(triangles.len()), Vec::new());
    for triangle in triangles {
        let key = sort_corners(triangle).0;
        if is_double(&key, &sides) {
            kept.push(triangle);
            may_turn.push(true);
            sides.remove(&key);
        } else if sides.contains_key(&key) {
            kept.push(triangle);
            may_turn.push(false);
        }
    }
    orient(&mut kept, &may_turn);
    kept
}

/// True if a triangle occurs in both orientations. Each is compared with those that have the same least corner. O(n log d)
/// for d triangles at a vertex.
fn has_reverse_sides(triangles: &[[u32; 3]]) -> bool {
    let least = |triangle: &[u32; 3]| triangle.iter().copied().fold(u32::MAX, u32::min) as usize;
    let n = triangles.iter().map(least).max().map_or(0, |most| most + 1);
    let mut ends = vec![0_u32; n + 1];
    for triangle in triangles {
        ends[least(triangle) + 1] += 1;
    }
    for x in 0..n {
        ends[x + 1] += ends[x];
    }
    let mut by_corner = vec![[0; 3]; triangles.len()];
    for triangle in triangles {
        let end = &mut ends[least(triangle)];
        by_corner[*end as usize] = *triangle;
        *end += 1;
    }
    let found = parallel::map_chunks(n, CORNERS_AT_A_TIME, |corners| {
        let start = |x: usize| if x == 0 { 0 } else { ends[x - 1] as usize };
        let mut keys = Vec::new();
        corners.into_iter().any(|x| {
            keys.clear();
            keys.extend(by_corner[start(x)..ends[x] as usize].iter().map(|triangle| sort_corners(*triangle)));
            keys.sort_unstable();
            keys.windows(2).any(|pair| {
                let [(key, is_odd), (other, other_is_odd)] = [pair[0], pair[1]];
                key == other && is_odd != other_is_odd && key[0] != key[1] && key[1] != key[2]
            })
        })
    });
    found.contains(&true)
}

/// Corners in ascending order, and whether the permutation is odd.
fn sort_corners(triangle: [u32; 3]) -> ([u32; 3], bool) {
    let [a, b, c] = triangle;
    let mut key = triangle;
    key.sort_unstable();
    let n_exchanged = [a > b, b > c, a > c].into_iter().filter(|is| *is).count();
    (key, n_exchanged % 2 == 1)
}

/// Turns triangles that may turn, so that they agree with their neighbors across edges of two triangles; those that may
/// not are the first to spread their orientation.
fn orient(triangles: &mut [[u32; 3]], may_turn: &[bool]) {
    let mut at_edge: HashMap<[u32; 2], Vec<u32>> = HashMap::with_capacity(3 * triangles.len() / 2);
    for (t, triangle) in (0..).zip(&*triangles) {
        for k in 0..3 {
            let (x, y) = (triangle[k], triangle[(k + 1) % 3]);
            at_edge.entry([x.min(y), x.max(y)]).or_default().push(t);
        }
    }
    let mut is_settled: Vec<bool> = may_turn.iter().map(|may| !may).collect();
    let mut queue: Vec<usize> = (0..triangles.len()).filter(|&t| is_settled[t]).collect();
    // First from those that may not turn, then from the first triangle of each part that has none.
    for start in std::iter::once(None).chain((0..triangles.len()).map(Some)) {
        if let Some(start) = start.filter(|&start| !is_settled[start]) {
            is_settled[start] = true;
            queue.push(start);
        }
        while let Some(t) = queue.pop() {
            for k in 0..3 {
                let (x, y) = (triangles[t][k], triangles[t][(k + 1) % 3]);
                let [a, b] = at_edge[&[x.min(y), x.max(y)]][..] else { continue };
                let other = if a as usize == t { b as usize } else { a as usize };
                if is_settled[other] {
                    continue;
                }
                is_settled[other] = true;
                queue.push(other);
                let [p, q, r] = triangles[other];
                // Neighbors of one orientation run along their edge in opposite directions.
                if [(p, q), (q, r), (r, p)].contains(&(x, y)) {
                    triangles[other] = [p, r, q];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: u32) -> Vec<[u32; 3]> {
        (0..n * n)
            .flat_map(|k| {
                let v = k / n * (n + 1) + k % n;
                [[v, v + 1, v + n + 2], [v, v + n + 2, v + n + 1]]
            })
            .collect()
    }

    /// The triangle from its smallest corner on.
    fn rotated(t: [u32; 3]) -> [u32; 3] {
        [t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min().unwrap()
    }

    #[test]
    fn the_second_side_is_left_out_whatever_the_order() {
        let single = grid(6);
        let reversed = single.iter().map(|[a, b, c]| [*b, *a, *c]);
        let mut double: Vec<[u32; 3]> = single.iter().copied().chain(reversed).collect();
        let expected: Vec<[u32; 3]> = single.iter().copied().map(rotated).collect();
        let sets = |triangles: &[[u32; 3]]| {
            let mut all: Vec<[u32; 3]> = triangles.iter().map(|t| sort_corners(*t).0).collect();
            all.sort_unstable();
            all
        };
        for step in [1, 5, 11, 29] {
            let n = double.len();
            double = (0..n).map(|k| double[k * step % n]).collect();
            let found = without_reverse_sides(double.clone());
            assert_eq!(sets(&found), sets(&single), "{step}");
            let agreeing = found.iter().filter(|t| expected.contains(&rotated(**t))).count();
            assert!(agreeing == 0 || agreeing == single.len(), "{step}: {agreeing} of {}", single.len());
        }
    }

    #[test]
    fn other_meshes_stay_as_they_are() {
        let single = grid(3);
        assert_eq!(without_reverse_sides(single.clone()), single);
        let copied = [&single[..], &single[..4]].concat();
        assert_eq!(without_reverse_sides(copied.clone()), copied);
        // A part is double-sided: it follows the others.
        let partly: Vec<[u32; 3]> =
            single[3..6].iter().map(|[a, b, c]| [*a, *c, *b]).chain(single.clone()).collect();
        let mut found = without_reverse_sides(partly);
        found = found.into_iter().map(rotated).collect();
        found.sort_unstable();
        let mut expected: Vec<[u32; 3]> = single.into_iter().map(rotated).collect();
        expected.sort_unstable();
        assert_eq!(found, expected);
    }
}
