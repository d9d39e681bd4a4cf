//! Closest points by a tree of halved boxes.

use std::collections::BinaryHeap;

/// Point found by a search.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index of the point, `u32::MAX` if none is wanted.
    pub name: u32,
    /// Squared distance to it, infinite if none is wanted.
    pub square: f64,
}

/// Search structure over points.
pub struct Tree {
    points: Vec<[f64; 3]>,
    names: Vec<u32>,
}

/// Number of points that are searched one after another.
const LEAF: usize = 12;

impl Tree {
    /// Sorts points into the tree. O(n log n).
    pub fn new(points: &[[f64; 3]]) -> Self {
        let mut names: Vec<u32> = (0..points.len() as u32).collect();
        sort(points, &mut names, 0);
        Self { points: names.iter().map(|&x| points[x as usize]).collect(), names }
    }

    /// Closest of the points for which `is_wanted`, called with the index and the squared distance, is true.
    pub fn closest(&self, p: &[f64; 3], is_wanted: impl Fn(u32, f64) -> bool) -> Hit {
        let mut best = Hit { name: u32::MAX, square: f64::INFINITY };
        self.search(p, [0, self.names.len()], 0, &mut { f64::INFINITY }, &mut |name, square, reach| {
            if is_wanted(name, square) {
                best = Hit { name, square };
                *reach = square;
            }
        });
        best
    }

    /// The `k` nearest points, from near to far; all points if there are fewer.
    pub fn nearest(&self, p: &[f64; 3], k: usize) -> Vec<u32> {
        // The bits of numbers from 0 on are in the order of the numbers.
        let mut found: BinaryHeap<(u64, u32)> = BinaryHeap::with_capacity(k + 1);
        self.search(p, [0, self.names.len()], 0, &mut { f64::INFINITY }, &mut |name, square, reach| {
            found.push((square.to_bits(), name));
            if found.len() > k {
                found.pop();
            }
            if let Some((farthest, _)) = found.peek().filter(|_| found.len() == k) {
                *reach = f64::from_bits(*farthest);
            }
        });
        found.into_sorted_vec().into_iter().map(|(_, name)| name).collect()
    }

    /// Distance to the closest point at another position.
    pub fn nearest_other(&self, p: &[f64; 3]) -> f64 {
        self.closest(p, |_, square| square > 0.0).square.sqrt()
    }

    /// Calls `visit` with index, squared distance and `reach` for each point whose square is less than `reach`, which
    /// `visit` may reduce.
    fn search(
        &self,
        p: &[f64; 3],
        [low, high]: [usize; 2],
        depth: usize,
        reach: &mut f64,
        visit: &mut impl FnMut(u32, f64, &mut f64),
    ) {
        let mut compare = |k: usize, reach: &mut f64| {
            let q = &self.points[k];
            let square: f64 = (0..3).map(|c| (p[c] - q[c]).powi(2)).sum();
            if square < *reach {
                visit(self.names[k], square, reach);
            }
        };
        if high - low <= LEAF {
            (low..high).for_each(|k| compare(k, reach));
            return;
        }
        let middle = usize::midpoint(low, high);
        let gap = p[depth % 3] - self.points[middle][depth % 3];
        compare(middle, reach);
        let (near, far) = ([low, middle], [middle + 1, high]);
        let (first, second) = if gap < 0.0 { (near, far) } else { (far, near) };
        self.search(p, first, depth + 1, reach, visit);
        if gap * gap <= *reach {
            self.search(p, second, depth + 1, reach, visit);
        }
    }
}

/// Puts the middle point along an axis into the middle, and sorts both halves without it.
fn sort(points: &[[f64; 3]], names: &mut [u32], depth: usize) {
    if names.len() <= LEAF {
        return;
    }
    let middle = names.len() / 2;
    names.select_nth_unstable_by(middle, |a, b| {
        points[*a as usize][depth % 3].total_cmp(&points[*b as usize][depth % 3])
    });
    let (left, right) = names.split_at_mut(middle);
    sort(points, left, depth + 1);
    sort(points, &mut right[1..], depth + 1);
}

/// Chamfer distance of two clouds times 10⁴: the mean squared distance to the closest point of the other, both ways.
pub fn chamfer(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let one_way = |from: &[[f64; 3]], to: &[[f64; 3]]| {
        let tree = Tree::new(to);
        from.iter().map(|p| tree.closest(p, |_, _| true).square).sum::<f64>() / from.len() as f64
    };
    1e4 * (one_way(a, b) + one_way(b, a))
}

/// Moves and scales both clouds so that the unit sphere around the middle of the box of the first one touches it.
pub fn into_unit_sphere(first: &mut [[f64; 3]], second: &mut [[f64; 3]]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in first.iter() {
        for k in 0..3 {
            low[k] = low[k].min(p[k]);
            high[k] = high[k].max(p[k]);
        }
    }
    let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let square = |p: &[f64; 3]| (0..3).map(|k| (p[k] - middle[k]).powi(2)).sum::<f64>();
    let radius = first.iter().map(square).fold(0.0, f64::max).sqrt();
    for p in first.iter_mut().chain(second) {
        *p = std::array::from_fn(|k| (p[k] - middle[k]) / radius);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CloudNoise, CloudShape, Random};
    use super::*;

    #[test]
    fn the_tree_finds_what_a_search_of_all_finds() {
        let mut random = Random::new(3);
        let points: Vec<[f64; 3]> = (0..700).map(|_| random.normals()).collect();
        let tree = Tree::new(&points);
        for _ in 0..200 {
            let p = random.normals();
            let square = |q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
            let least = points.iter().map(square).fold(f64::INFINITY, f64::min);
            assert_eq!(tree.closest(&p, |_, _| true).square, least);
            let mut all: Vec<u32> = (0..700).collect();
            all.sort_by(|a, b| square(&points[*a as usize]).total_cmp(&square(&points[*b as usize])));
            assert_eq!(tree.nearest(&p, 40), all[..40]);
        }
        assert_eq!(chamfer(&points, &points), 0.0);
    }

    #[test]
    fn shapes_lie_in_the_unit_sphere_and_noise_has_the_asked_size() {
        for (name, shape) in CloudShape::ALL {
            let clean = shape.sample(2000, 5);
            assert!(clean.points.len() > 1000 && clean.spacing > 0.0, "{name}");
            assert!(clean.dense.iter().flatten().all(|c| c.abs() <= 1.0 + 1e-9), "{name}");
            let noisy = CloudNoise::Normal(0.3).apply(&clean, 9);
            let square = |(p, q): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
            let n = clean.normals.iter().filter(|n| **n != [0.0; 3]).count() as f64;
            let rms = (noisy.points.iter().zip(&clean.points).map(square).sum::<f64>() / n).sqrt();
            // Five standard errors of a standard deviation from 1,000 samples.
            assert!((rms / clean.spacing / 0.3 - 1.0).abs() < 5.0 / 2000.0_f64.sqrt(), "{name}: {rms}");
        }
    }
}
