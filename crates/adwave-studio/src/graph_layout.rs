//! Places in the plane for the nodes of a graph without positions, so that it can be drawn.
//!
//! Each connected part is placed so that the distance of two nodes in the plane is the number of edges between them, as
//! far as a plane permits: first by the distances from a few pivots (Brandes and Pich, *Eigensolver Methods for
//! Progressive Multidimensional Scaling of Large Data*, 2007), then by sweeps that lower the stress of neighbors, of
//! nodes two edges apart, and of pivots (Ortmann, Klimenta and Brandes, *A Sparse Stress Model*, 2017). The parts are
//! put beside each other. O(pivots · (nodes + edges)), and the same for any number of threads. It is written here
//! because the crates that place graphs compare all pairs of nodes, or may not be combined with our license.

use adwave::shape::{Adjacency, Graph};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of pivots, and of those for parts with more nodes than [`MANY_NODES`].
const PIVOTS: [usize; 2] = [50, 20];
/// Number of sweeps that lower the stress, and of those for parts with many nodes.
const SWEEPS: [usize; 2] = [80, 30];
const MANY_NODES: usize = 200_000;
/// Number of nodes two edges away that push a node.
const SECOND_NEIGHBORS: u64 = 8;
/// Steps of the power iteration.
const POWER_STEPS: usize = 100;
/// Distance between parts, in edges.
const GAP: f64 = 1.5;
/// Width of the picture relative to its height.
const ASPECT: f64 = 1.5;

/// Nodes in the plane; an edge is about one unit long.
pub(crate) struct GraphLayout {
    /// Places of the nodes; the third coordinate is 0.
    pub(crate) places: Vec<[f64; 3]>,
    /// Largest number of edges between two nodes that was found.
    pub(crate) n_across: usize,
}

/// Places the nodes of a graph; the steps of large parts are reported.
pub(crate) fn graph_layout(graph: &Graph, progress: Progress<'_>) -> Result<GraphLayout, Cancelled> {
    let n = graph.n_nodes();
    // Number of each node within its part.
    let mut rank = vec![u32::MAX; n];
    let (mut parts, mut n_across) = (Vec::new(), 0);
    for first in 0..n {
        if rank[first] == u32::MAX {
            let part = Part::collect(first, graph.adjacency(), &mut rank);
            let (places, across) = part.place(progress)?;
            n_across = n_across.max(across);
            parts.push((part.nodes, places));
        }
    }
    Ok(GraphLayout { places: pack(parts, n), n_across })
}

/// Connected part of a graph. Its nodes are counted in the order of their distances from the first one, so that most
/// neighbors are near each other in memory.
struct Part {
    nodes: Vec<u32>,
    neighbors: Adjacency,
}

/// Distances from the pivots, in edges: that of pivot p from node i is at `p · n + i`.
struct PivotDistances {
    pivots: Vec<u32>,
    edges: Vec<u32>,
}

impl Part {
    /// Collects the nodes that are joined with `first`, and numbers them.
    fn collect(first: usize, adjacency: &Adjacency, rank: &mut [u32]) -> Self {
        let mut nodes = vec![first as u32];
        rank[first] = 0;
        let mut at = 0;
        while let Some(&node) = nodes.get(at) {
            at += 1;
            for &other in adjacency.row(node as usize) {
                if rank[other as usize] == u32::MAX {
                    rank[other as usize] = nodes.len() as u32;
                    nodes.push(other);
                }
            }
        }
        let mut offsets = vec![0];
        let mut columns = Vec::new();
        for &node in &nodes {
            let from = columns.len();
            columns.extend(adjacency.row(node as usize).iter().map(|&other| rank[other as usize]));
            columns[from..].sort_unstable();
            offsets.push(columns.len());
        }
        let neighbors = Adjacency::new(offsets, columns, nodes.len());
        Self { neighbors: neighbors.expect("the rows are sorted and within the part"), nodes }
    }

    fn row(&self, i: usize) -> &[u32] {
        self.neighbors.row(i)
    }

    /// Returns the places of the nodes, and the largest distance that was found.
    fn place(&self, progress: Progress<'_>) -> Result<(Vec<[f64; 2]>, usize), Cancelled> {
        let n = self.nodes.len();
        if n == 1 {
            return Ok((vec![[0.0; 2]], 0));
        }
        let is_large = n > MANY_NODES;
        let (n_pivots, n_sweeps) = (PIVOTS[usize::from(is_large)].min(n), SWEEPS[usize::from(is_large)]);
        // There may be as many small parts as nodes, so that only large ones report.
        let step = |done: usize| {
            if is_large { progress.step(done as u64, (n_pivots + n_sweeps) as u64) } else { progress.check() }
        };
        let distances = self.pivot_distances(n_pivots, step)?;
        let across = distances.edges.iter().copied().max().unwrap_or(0) as usize;
        let mut places = distances.scaled_places(n);
        for (i, place) in places.iter_mut().enumerate() {
            // Nodes with equal distances are told apart.
            let angle = std::f64::consts::TAU * unit_number(i as u64);
            place[0] += 0.1 * angle.cos();
            place[1] += 0.1 * angle.sin();
        }
        let counts = distances.near_counts(n);
        let second: Vec<Vec<u32>> = (0..n).into_par_iter().map(|i| self.second_neighbors(i)).collect();
        for sweep in 0..n_sweeps {
            step(n_pivots + sweep)?;
            let moved = |i: usize| {
                let mut pull = Pull::new(places[i], i);
                for &j in self.row(i) {
                    pull.toward(places[j as usize], 1.0, 1.0);
                }
                for &j in &second[i] {
                    pull.toward(places[j as usize], 2.0, 0.25);
                }
                for (p, &pivot) in distances.pivots.iter().enumerate() {
                    let edges = distances.edges[p * n + i];
                    if edges > 1 {
                        let far = f64::from(edges);
                        let near = f64::from(counts[p][edges as usize / 2]);
                        pull.toward(places[pivot as usize], far, near / (far * far));
                    }
                }
                pull.place()
            };
            places = (0..n).into_par_iter().map(moved).collect();
        }
        Ok((places, across))
    }

    /// Chooses pivots, each as far as possible from those before, and measures the distances from them.
    fn pivot_distances(
        &self,
        n_pivots: usize,
        step: impl Fn(usize) -> Result<(), Cancelled>,
    ) -> Result<PivotDistances, Cancelled> {
        let n = self.nodes.len();
        let mut nearest = vec![u32::MAX; n];
        let (mut pivots, mut edges) = (Vec::with_capacity(n_pivots), Vec::with_capacity(n_pivots * n));
        // The node farthest from the first one is at the edge of the picture.
        let mut next = farthest(&self.distances_from(0));
        for pivot in 0..n_pivots {
            step(pivot)?;
            let from = self.distances_from(next);
            nearest.iter_mut().zip(&from).for_each(|(least, edges)| *least = (*least).min(*edges));
            pivots.push(next as u32);
            edges.extend(from);
            next = farthest(&nearest);
        }
        Ok(PivotDistances { pivots, edges })
    }

    /// Number of edges from a node to each.
    fn distances_from(&self, source: usize) -> Vec<u32> {
        let mut distances = vec![u32::MAX; self.nodes.len()];
        let mut reached = vec![source];
        distances[source] = 0;
        let mut at = 0;
        while let Some(&i) = reached.get(at) {
            at += 1;
            for j in self.row(i).iter().map(|&j| j as usize) {
                if distances[j] == u32::MAX {
                    distances[j] = distances[i] + 1;
                    reached.push(j);
                }
            }
        }
        distances
    }

    /// Draws nodes that are two edges away.
    fn second_neighbors(&self, i: usize) -> Vec<u32> {
        let row = self.row(i);
        let draw = |k: u64, list: &[u32]| {
            let share = unit_number(k ^ ((i as u64) << 8));
            list[((share * list.len() as f64) as usize).min(list.len() - 1)]
        };
        let drawn = (0..SECOND_NEIGHBORS).map(|k| draw(2 * k + 1, self.row(draw(2 * k, row) as usize)));
        drawn.filter(|&j| j as usize != i && row.binary_search(&j).is_err()).collect()
    }
}

fn farthest(distances: &[u32]) -> usize {
    let mut best = 0;
    for (i, distance) in distances.iter().enumerate() {
        if *distance > distances[best] {
            best = i;
        }
    }
    best
}

impl PivotDistances {
    /// Places by the two directions in which the distances from the pivots vary most, scaled to distances in edges.
    fn scaled_places(&self, n: usize) -> Vec<[f64; 2]> {
        let k = self.pivots.len();
        let square = |p: usize, i: usize| f64::from(self.edges[p * n + i]).powi(2);
        let of_pivots: Vec<f64> =
            (0..k).into_par_iter().map(|p| (0..n).map(|i| square(p, i)).sum::<f64>() / n as f64).collect();
        let all = of_pivots.iter().sum::<f64>() / k as f64;
        let centered = |i: usize| -> Vec<f64> {
            let own = (0..k).map(|p| square(p, i)).sum::<f64>() / k as f64;
            (0..k).map(|p| -0.5 * (square(p, i) - of_pivots[p] - own + all)).collect()
        };
        let rows: Vec<Vec<f64>> = (0..n).into_par_iter().map(centered).collect();
        let product =
            |p: usize| -> Vec<f64> { (0..k).map(|q| rows.iter().map(|row| row[p] * row[q]).sum()).collect() };
        let products: Vec<Vec<f64>> = (0..k).into_par_iter().map(product).collect();
        let first = principal_direction(&products, None);
        let second = principal_direction(&products, Some(&first));
        let along = |row: &[f64], axis: &[f64]| row.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>();
        let mut places: Vec<[f64; 2]> =
            rows.par_iter().map(|row| [along(row, &first), along(row, &second)]).collect();
        let (mut product, mut norm) = (0.0, 0.0);
        for (p, &pivot) in self.pivots.iter().enumerate() {
            let from = places[pivot as usize];
            for (i, place) in places.iter().enumerate() {
                let length = (place[0] - from[0]).hypot(place[1] - from[1]);
                product += length * f64::from(self.edges[p * n + i]);
                norm += length * length;
            }
        }
        let scale = if norm > 0.0 { product / norm } else { 1.0 };
        for place in &mut places {
            *place = place.map(|x| scale * x);
        }
        places
    }

    /// For each pivot the number of nodes that are within d of it and nearer to it than to other pivots, for d = 0, 1, …
    fn near_counts(&self, n: usize) -> Vec<Vec<u32>> {
        let most = self.edges.iter().copied().max().unwrap_or(0) as usize;
        let mut counts = vec![vec![0_u32; most + 1]; self.pivots.len()];
        for i in 0..n {
            let distance = |p: &usize| self.edges[p * n + i];
            let nearest = (0..self.pivots.len()).min_by_key(distance).unwrap_or(0);
            counts[nearest][distance(&nearest) as usize] += 1;
        }
        for list in &mut counts {
            for d in 1..list.len() {
                list[d] += list[d - 1];
            }
        }
        counts
    }
}

/// Direction of a symmetric matrix with the largest eigenvalue, of those orthogonal to `other`, by power iteration.
fn principal_direction(matrix: &[Vec<f64>], other: Option<&[f64]>) -> Vec<f64> {
    let mut axis: Vec<f64> = (0..matrix.len()).map(|p| 0.5 + unit_number(p as u64)).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for _ in 0..POWER_STEPS {
        axis = matrix.iter().map(|row| dot(row, &axis)).collect();
        if let Some(other) = other {
            let along = dot(&axis, other);
            axis.iter_mut().zip(other).for_each(|(x, o)| *x -= along * o);
        }
        let norm = dot(&axis, &axis).sqrt();
        if norm == 0.0 {
            return vec![0.0; matrix.len()];
        }
        for x in &mut axis {
            *x /= norm;
        }
    }
    axis
}

/// Weighted mean of the places at which a node would have the wanted distances from others.
struct Pull {
    from: [f64; 2],
    sum: [f64; 2],
    weight: f64,
    node: usize,
}

impl Pull {
    fn new(from: [f64; 2], node: usize) -> Self {
        Self { from, sum: [0.0; 2], weight: 0.0, node }
    }

    fn toward(&mut self, other: [f64; 2], distance: f64, weight: f64) {
        let away = [self.from[0] - other[0], self.from[1] - other[1]];
        let length = (away[0] * away[0] + away[1] * away[1]).sqrt();
        let direction = if length > 1e-9 {
            [away[0] / length, away[1] / length]
        } else {
            let angle = std::f64::consts::TAU * unit_number(self.node as u64);
            [angle.cos(), angle.sin()]
        };
        for c in 0..2 {
            self.sum[c] += weight * (other[c] + distance * direction[c]);
        }
        self.weight += weight;
    }

    fn place(&self) -> [f64; 2] {
        self.sum.map(|x| x / self.weight)
    }
}

/// Number in [0, 1) that looks drawn at random, the same for the same `k` (SplitMix64).
fn unit_number(k: u64) -> f64 {
    let mut x = k.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x ^ (x >> 31)) as f64 / 2.0_f64.powi(64)
}

/// Puts the parts in rows, the highest first.
fn pack(parts: Vec<(Vec<u32>, Vec<[f64; 2]>)>, n: usize) -> Vec<[f64; 3]> {
    let bounds = |places: &[[f64; 2]], c: usize| {
        places
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[c]), high.max(p[c])))
    };
    let mut boxes: Vec<_> = parts
        .into_iter()
        .map(|(nodes, places)| {
            let (x, y) = (bounds(&places, 0), bounds(&places, 1));
            ((x.1 - x.0 + GAP, y.1 - y.0 + GAP), [x.0, y.0], nodes, places)
        })
        .collect();
    boxes.sort_by(|a, b| b.0.1.total_cmp(&a.0.1).then(a.2[0].cmp(&b.2[0])));
    let area: f64 = boxes.iter().map(|part| part.0.0 * part.0.1).sum();
    let widest = boxes.iter().map(|part| part.0.0).fold((ASPECT * area).sqrt(), f64::max);
    let mut placed = vec![[0.0; 3]; n];
    let (mut left, mut top, mut height) = (0.0, 0.0, 0.0);
    for ((wide, high), low, nodes, places) in boxes {
        if left > 0.0 && left + wide > widest {
            (left, top, height) = (0.0, top - height, 0.0);
        }
        for (node, place) in nodes.iter().zip(&places) {
            placed[*node as usize] = [left + place[0] - low[0], top - high + place[1] - low[1], 0.0];
        }
        left += wide;
        height = f64::max(height, high);
    }
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(n: usize, edges: &[(u32, u32)]) -> GraphLayout {
        let weighted: Vec<(u32, u32, f64)> = edges.iter().map(|&(a, b)| (a, b, 1.0)).collect();
        graph_layout(&Graph::new(n, &weighted).unwrap(), Progress::none()).unwrap()
    }

    fn length(layout: &GraphLayout, (a, b): (u32, u32)) -> f64 {
        let (a, b) = (layout.places[a as usize], layout.places[b as usize]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    #[test]
    fn a_path_is_straight_and_a_lattice_is_flat() {
        let path: Vec<(u32, u32)> = (0..99).map(|k| (k, k + 1)).collect();
        let layout = place(100, &path);
        assert_eq!(layout.n_across, 99);
        assert!((length(&layout, (0, 99)) - 99.0).abs() < 3.0, "{}", length(&layout, (0, 99)));
        let side = 20;
        let node = |r: u32, c: u32| r * side + c;
        let right = (0..side).flat_map(|r| (1..side).map(move |c| (node(r, c - 1), node(r, c))));
        let down = (1..side).flat_map(|r| (0..side).map(move |c| (node(r - 1, c), node(r, c))));
        let edges: Vec<(u32, u32)> = right.chain(down).collect();
        let layout = place((side * side) as usize, &edges);
        let lengths: Vec<f64> = edges.iter().map(|&edge| length(&layout, edge)).collect();
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        // Distances along a lattice are those of city blocks, which no plane has.
        assert!((0.6..1.5).contains(&mean), "{mean}");
        assert!(lengths.iter().all(|l| (0.2 * mean..3.0 * mean).contains(l)));
        // Opposite corners stay opposite.
        let corners = [node(0, 0), node(0, side - 1), node(side - 1, side - 1), node(side - 1, 0)];
        let diagonal = length(&layout, (corners[0], corners[2]));
        assert!(diagonal > 1.1 * length(&layout, (corners[0], corners[1])));
    }

    #[test]
    fn leaves_of_a_star_have_places_of_their_own() {
        let edges: Vec<(u32, u32)> = (1..40).map(|k| (0, k)).collect();
        let layout = place(40, &edges);
        let apart = (1..40).flat_map(|a| (1..a).map(move |b| (a, b))).map(|pair| length(&layout, pair));
        assert!(apart.fold(f64::INFINITY, f64::min) > 0.01);
        assert!(edges.iter().all(|&edge| (0.3..2.0).contains(&length(&layout, edge))));
    }

    #[test]
    fn parts_do_not_overlap() {
        let ring = |first: u32| (0..30).map(move |k| (first + k, first + (k + 1) % 30));
        let edges: Vec<(u32, u32)> = ring(0).chain(ring(30)).chain(ring(60)).collect();
        // Three rings, and nodes without edges.
        let layout = place(100, &edges);
        let bounds = |nodes: std::ops::Range<usize>, c: usize| {
            let places = layout.places[nodes].iter();
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[c]), h.max(p[c])))
        };
        let parts: Vec<_> = [0..30, 30..60, 60..90].into_iter().chain((90..100).map(|k| k..k + 1)).collect();
        for (k, a) in parts.iter().enumerate() {
            for b in &parts[..k] {
                let apart = |c| {
                    let ((al, ah), (bl, bh)) = (bounds(a.clone(), c), bounds(b.clone(), c));
                    al > bh || bl > ah
                };
                assert!(apart(0) || apart(1), "{a:?} {b:?}");
            }
        }
        assert!(layout.places.iter().flatten().all(|x| x.is_finite()));
    }
}
