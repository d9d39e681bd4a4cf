//! The formulas of the paper with dense matrices, term by term, and without a line of the crate's code.
//!
//! Vertices are numbered by the first vertex of the file at their position.

use crate::reference::shapes::{Case, Parts};
use adwave::operator::{CloudGraph, OperatorParams};
use adwave::shape::{CloudArea, MeshArea};
use nalgebra::{DMatrix, Vector2, Vector3};
use std::f64::consts::PI;

pub(crate) type Matrix = Vec<Vec<f64>>;

/// Relative difference of distances that count as equal in a cloud.
const TIE: f64 = 1e-9;

/// Mutations of eq. 1, 4 and 5, which the tests must notice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mutant {
    /// Nothing.
    None,
    /// exp(−d²/2t).
    TwiceAsSharp,
    /// exp(−d²/8t).
    HalfAsSharp,
    /// A(x) in place of A(y).
    AreaOfTheRow,
    /// t = E².
    DoubleTime,
    /// T(x,x) = 0: the plain random walk.
    NotLazy,
    /// T(x,x) = half the sum of its row.
    HalfLazy,
}

/// Vertices of the file that are one vertex.
pub(crate) struct Welded {
    /// The welded vertex of each vertex of the file.
    pub(crate) class: Vec<usize>,
    /// The first vertex of the file of each welded vertex.
    pub(crate) first: Vec<usize>,
}

pub(crate) fn weld(parts: &Parts) -> Welded {
    let (mut class, mut first): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    for x in 0..parts.n_vertices() {
        let same = |&y: &usize| match parts {
            Parts::Mesh { points, .. } | Parts::Cloud { points } => points[x] == points[y],
            Parts::Graph { .. } => false,
        };
        let known = first.iter().position(same);
        class.push(known.unwrap_or(first.len()));
        if known.is_none() {
            first.push(x);
        }
    }
    Welded { class, first }
}

pub(crate) fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt()
}

/// T with what belongs to it.
pub(crate) struct LocalOperator {
    /// T(x,y), the diagonal included.
    pub(crate) t: Matrix,
    /// True if y is in N(x).
    pub(crate) is_neighbor: Vec<Vec<bool>>,
    /// True if y is in the one-ring of x on a mesh; N(x) for clouds and graphs.
    pub(crate) is_next: Vec<Vec<bool>>,
    /// A.
    pub(crate) areas: Vec<f64>,
    /// E.
    pub(crate) mean_length: f64,
    /// ‖x − y‖, on a graph 1.
    pub(crate) length: Matrix,
}

impl LocalOperator {
    /// t = E²/2.
    pub(crate) fn time(&self) -> f64 {
        self.mean_length.powi(2) / 2.0
    }
}

/// T of eq. 1: `T(x,y) = A(y)·exp(−‖x−y‖²/4t)` for y in N(x), `T(x,x) = Σ_{y≠x} T(x,y)`, `t = E²/2`.
pub(crate) fn local_operator(case: &Case, mutant: Mutant) -> LocalOperator {
    let welded = weld(&case.parts);
    let n = welded.first.len();
    let mut t = vec![vec![0.0; n]; n];
    let (is_neighbor, is_next, areas, mean_length, length);
    match &case.parts {
        Parts::Graph { edges, .. } => {
            let mut next = vec![vec![false; n]; n];
            for &(u, v, w) in edges.iter().filter(|(u, v, _)| u != v) {
                let (u, v) = (u as usize, v as usize);
                t[u][v] += w;
                t[v][u] += w;
                next[u][v] = true;
                next[v][u] = true;
            }
            (areas, mean_length, length) = (vec![1.0; n], 1.0, vec![vec![1.0; n]; n]);
            (is_neighbor, is_next) = (next.clone(), next);
        }
        Parts::Mesh { points, triangles } => {
            let points: Vec<[f64; 3]> = welded.first.iter().map(|&x| points[x]).collect();
            let triangles: Vec<[usize; 3]> =
                triangles.iter().map(|t| t.map(|v| welded.class[v as usize])).collect();
            length = distances(&points);
            is_next = edges_of(n, &triangles);
            is_neighbor = within(&is_next, case.params.rings);
            let edges = (0..n).flat_map(|x| (0..x).map(move |y| (x, y))).filter(|&(x, y)| is_next[x][y]);
            mean_length = mean(edges.map(|(x, y)| length[x][y]));
            areas = mesh_areas(&points, &triangles, case.params.mesh_area);
        }
        Parts::Cloud { points } => {
            let points: Vec<[f64; 3]> = welded.first.iter().map(|&x| points[x]).collect();
            length = distances(&points);
            (is_neighbor, areas, mean_length) = cloud(&points, &length, &case.params);
            is_next = is_neighbor.clone();
        }
    }
    if !matches!(case.parts, Parts::Graph { .. }) {
        let time = match mutant {
            Mutant::DoubleTime => mean_length.powi(2),
            _ => mean_length.powi(2) / 2.0,
        };
        let four = match mutant {
            Mutant::TwiceAsSharp => 2.0,
            Mutant::HalfAsSharp => 8.0,
            _ => 4.0,
        };
        for x in 0..n {
            for y in (0..n).filter(|&y| is_neighbor[x][y]) {
                let area = if mutant == Mutant::AreaOfTheRow { areas[x] } else { areas[y] };
                t[x][y] = area * (-length[x][y].powi(2) / (four * time)).exp();
            }
        }
    }
    for (x, row) in t.iter_mut().enumerate() {
        let sum: f64 = row.iter().sum();
        row[x] = match mutant {
            Mutant::NotLazy => 0.0,
            Mutant::HalfLazy => 0.5 * sum,
            _ => sum,
        };
    }
    LocalOperator { t, is_neighbor, is_next, areas, mean_length, length }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    values.iter().sum::<f64>() / values.len() as f64
}

fn distances(points: &[[f64; 3]]) -> Matrix {
    points.iter().map(|&p| points.iter().map(|&q| distance(p, q)).collect()).collect()
}

fn edges_of(n: usize, triangles: &[[usize; 3]]) -> Vec<Vec<bool>> {
    let mut next = vec![vec![false; n]; n];
    for &[a, b, c] in triangles {
        for (u, v) in [(a, b), (b, c), (c, a)] {
            if u != v {
                next[u][v] = true;
                next[v][u] = true;
            }
        }
    }
    next
}

/// Vertices at most `k` edges away, without the vertex itself.
pub(crate) fn within(next: &[Vec<bool>], k: usize) -> Vec<Vec<bool>> {
    let n = next.len();
    let mut found: Vec<Vec<bool>> = (0..n).map(|x| (0..n).map(|y| x == y).collect()).collect();
    for _ in 0..k {
        let before = found.clone();
        for x in 0..n {
            for y in 0..n {
                found[x][y] |= (0..n).any(|z| before[x][z] && next[z][y]);
            }
        }
        if found == before {
            break;
        }
    }
    for (x, row) in found.iter_mut().enumerate() {
        row[x] = false;
    }
    found
}

/// A third of the triangles' areas, or the Voronoi areas of Meyer et al. 2003.
fn mesh_areas(points: &[[f64; 3]], triangles: &[[usize; 3]], kind: MeshArea) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|v| points[v]);
        // Heron's formula in the form that keeps its digits (Kahan).
        let mut sides = [distance(a, b), distance(b, c), distance(c, a)];
        sides.sort_by(|p, q| q.total_cmp(p));
        let [p, q, r] = sides;
        let square = (p + (q + r)) * (r - (p - q)) * (r + (p - q)) * (p + (q - r));
        let area = square.max(0.0).sqrt() / 4.0;
        if area == 0.0 {
            continue;
        }
        // The angle at the corner k, by the law of cosines.
        let side = |k: usize, l: usize| distance(points[corners[k]], points[corners[l]]);
        let angle = |k: usize| {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            let cosine = (side(k, l).powi(2) + side(k, m).powi(2) - side(l, m).powi(2))
                / (2.0 * side(k, l) * side(k, m));
            cosine.clamp(-1.0, 1.0).acos()
        };
        let is_obtuse = (0..3).any(|k| angle(k) >= PI / 2.0);
        for k in 0..3 {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            areas[corners[k]] += match kind {
                MeshArea::Barycentric => area / 3.0,
                MeshArea::MixedVoronoi if is_obtuse && angle(k) >= PI / 2.0 => area / 2.0,
                MeshArea::MixedVoronoi if is_obtuse => area / 4.0,
                MeshArea::MixedVoronoi => {
                    (side(k, l).powi(2) / angle(m).tan() + side(k, m).powi(2) / angle(l).tan()) / 8.0
                }
                other => unreachable!("no reference for {other:?}"),
            };
        }
    }
    areas
}

/// Neighbors, areas and E of a cloud.
fn cloud(points: &[[f64; 3]], length: &Matrix, params: &OperatorParams) -> (Vec<Vec<bool>>, Vec<f64>, f64) {
    let n = length.len();
    let k = params.neighbors.min(n - 1);
    let radius: Vec<f64> = (0..n)
        .map(|x| {
            let mut others: Vec<f64> = (0..n).filter(|&y| y != x).map(|y| length[x][y]).collect();
            others.sort_by(f64::total_cmp);
            others[k - 1]
        })
        .collect();
    let mut near: Vec<Vec<bool>> =
        (0..n).map(|x| (0..n).map(|y| y != x && length[x][y] <= radius[x] * (1.0 + TIE)).collect()).collect();
    let pairs = (0..n).flat_map(|x| (0..n).map(move |y| (x, y))).filter(|&(x, y)| near[x][y]);
    let mean_length = mean(pairs.map(|(x, y)| length[x][y]));
    let areas = match params.cloud_area {
        CloudArea::Unit => vec![1.0; n],
        CloudArea::KthNeighbor => radius.iter().map(|r| PI * r * r / k as f64).collect(),
        CloudArea::TangentVoronoi => {
            let others = |x: usize| (0..n).filter(|&y| near[x][y]).map(|y| points[y]).collect::<Vec<_>>();
            (0..n).map(|x| voronoi_area(points[x], &others(x), radius[x])).collect()
        }
        other => unreachable!("no reference for {other:?}"),
    };
    if params.cloud_graph == CloudGraph::Union {
        let directed = near.clone();
        for x in 0..n {
            for y in 0..n {
                near[x][y] |= directed[y][x];
            }
        }
    }
    (near, areas, mean_length)
}

/// The directions in which points spread, the widest first, each with length 1.
pub(crate) fn spread(points: &[[f64; 3]]) -> [Vector3<f64>; 3] {
    let middle = points.iter().map(|&p| Vector3::from(p)).sum::<Vector3<f64>>() / points.len() as f64;
    // Three rows at least, so that there are three directions.
    let offset = |k: usize, c: usize| points.get(k).map_or(0.0, |p| p[c] - middle[c]);
    let offsets = DMatrix::from_fn(points.len().max(3), 3, offset);
    let directions = offsets.svd(false, true).v_t.expect("asked for");
    [0, 1, 2].map(|k| Vector3::new(directions[(k, 0)], directions[(k, 1)], directions[(k, 2)]))
}

/// The area of what is nearer to `p` than to any of the others, in the plane of the others, within the regular polygon of 24
/// corners that stands for the disc of that radius, the first on the axis of their widest spread.
///
/// All half-planes at once: its corners are where two of their edges meet that lie in all the others.
fn voronoi_area(p: [f64; 3], others: &[[f64; 3]], radius: f64) -> f64 {
    const CORNERS: usize = 24;
    /// Tolerance of a corner outside of an edge that it lies on, in units of the radius.
    const ON_IT: f64 = 1e-12;
    let [u, v, _] = spread(others);
    // (n, h) is where n·q ≤ h. The sides of the polygon are half-way between its corners.
    let side = |k: usize| {
        let angle = (k as f64 + 0.5) * 2.0 * PI / CORNERS as f64;
        (Vector2::new(angle.cos(), angle.sin()), (PI / CORNERS as f64).cos())
    };
    let bisector = |q: &[f64; 3]| {
        let d = (Vector3::from(*q) - Vector3::from(p)) / radius;
        let q = Vector2::new(d.dot(&u), d.dot(&v));
        (q, q.norm_squared() / 2.0)
    };
    let halves: Vec<(Vector2<f64>, f64)> =
        (0..CORNERS).map(side).chain(others.iter().map(bisector)).collect();
    let mut corners = Vec::new();
    for (k, (n, h)) in halves.iter().enumerate() {
        for (m, g) in &halves[..k] {
            let det = n.perp(m);
            let corner = Vector2::new(h * m.y - g * n.y, g * n.x - h * m.x) / det;
            if det != 0.0 && halves.iter().all(|(n, h)| n.dot(&corner) <= h + ON_IT) {
                corners.push(corner);
            }
        }
    }
    corners.sort_by(|a, b| a.y.atan2(a.x).total_cmp(&b.y.atan2(b.x)));
    let after = corners.iter().cycle().skip(1);
    corners.iter().zip(after).map(|(a, b)| a.perp(b)).sum::<f64>() / 2.0 * radius * radius
}

/// `[·]_r` (eq. 5): every row divided by its ‖·‖₁; a row of zeros becomes one of the identity.
pub(crate) fn normalized_rows(matrix: &Matrix) -> Matrix {
    let mut rows = matrix.clone();
    for (x, row) in rows.iter_mut().enumerate() {
        let norm: f64 = row.iter().map(|v| v.abs()).sum();
        if norm > 0.0 {
            for v in row {
                *v /= norm;
            }
        } else {
            row[x] = 1.0;
        }
    }
    rows
}

pub(crate) fn identity(n: usize) -> Matrix {
    (0..n).map(|x| (0..n).map(|y| f64::from(u8::from(x == y))).collect()).collect()
}

pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let n = a.len();
    (0..n).map(|x| (0..n).map(|y| (0..n).map(|z| a[x][z] * b[z][y]).sum()).collect()).collect()
}

pub(crate) fn minus(a: &Matrix, b: &Matrix) -> Matrix {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect()).collect()
}

/// Φ_0 … Φ_J (eq. 3, 4 and 6): Φ_0 = I, Φ₁ = [T]_r, Φ_j = [Φ_{j−1}Φ_{j−1}]_r.
pub(crate) fn scaling_functions(t: &Matrix, n_levels: usize) -> Vec<Matrix> {
    let mut phi = vec![identity(t.len()), normalized_rows(t)];
    for j in 2..=n_levels {
        phi.push(normalized_rows(&product(&phi[j - 1], &phi[j - 1])));
    }
    phi.truncate(n_levels + 1);
    phi
}

/// Algorithm 1: entries below ε are dropped before rows are divided by their sums.
pub(crate) fn algorithm_1(t: &Matrix, n_levels: usize, epsilon: f64) -> Vec<Matrix> {
    let mut phi = vec![identity(t.len()), normalized_rows(t)];
    for j in 2..=n_levels {
        let mut squared = product(&phi[j - 1], &phi[j - 1]);
        squared.iter_mut().flatten().filter(|v| **v < epsilon).for_each(|v| *v = 0.0);
        phi.push(normalized_rows(&squared));
    }
    phi
}

/// Φ^n for a reversible Φ and any real n ≥ 0, by the eigenpairs of `D^½ΦD^−½`, D the stationary distribution.
pub(crate) fn real_power(phi: &Matrix, stationary: &[f64], n: f64) -> Matrix {
    let size = phi.len();
    // What no step leaves or enters may have any weight but 0.
    let root: Vec<f64> = stationary.iter().map(|&p| if p > 0.0 { p.sqrt() } else { 1.0 }).collect();
    let symmetric = DMatrix::from_fn(size, size, |x, y| root[x] * phi[x][y] / root[y]);
    let symmetric = 0.5 * (&symmetric + symmetric.transpose());
    let eigen = symmetric.symmetric_eigen();
    let powers = eigen.eigenvalues.map(|l| l.max(0.0).powf(n));
    let power = &eigen.eigenvectors * DMatrix::from_diagonal(&powers) * eigen.eigenvectors.transpose();
    (0..size).map(|x| (0..size).map(|y| power[(x, y)] / root[x] * root[y]).collect()).collect()
}

/// π(x) ∝ A(x)·Σ_z T(x,z), Σπ = 1.
pub(crate) fn stationary(operator: &LocalOperator) -> Vec<f64> {
    let n = operator.t.len();
    let off = |x: usize| (0..n).filter(|&y| y != x).map(|y| operator.t[x][y]).sum::<f64>();
    let weight: Vec<f64> = (0..n).map(|x| operator.areas[x] * off(x)).collect();
    let total: f64 = weight.iter().sum();
    weight.into_iter().map(|w| w / total).collect()
}

/// s = (Σ_x π(x) Σ_y Φ₁(x,y)‖x−y‖²)^½.
pub(crate) fn step_length(phi: &Matrix, stationary: &[f64], length: &Matrix) -> f64 {
    let n = phi.len();
    let square = |x: usize| (0..n).filter(|&y| y != x).map(|y| phi[x][y] * length[x][y].powi(2)).sum::<f64>();
    (0..n).map(|x| stationary[x] * square(x)).sum::<f64>().sqrt()
}

/// T without the vertices that are masked: their rows and columns are 0.
pub(crate) fn restricted(operator: &LocalOperator, is_masked: &[bool]) -> LocalOperator {
    let n = operator.t.len();
    let mut t = vec![vec![0.0; n]; n];
    let mut is_next = operator.is_next.clone();
    for x in 0..n {
        for y in 0..n {
            let is_out = is_masked[x] || is_masked[y];
            is_next[x][y] &= !is_out;
            if x != y && !is_out {
                t[x][y] = operator.t[x][y];
            }
        }
        t[x][x] = t[x].iter().sum();
    }
    let (areas, length) = (operator.areas.clone(), operator.length.clone());
    let is_neighbor = operator.is_neighbor.clone();
    LocalOperator { t, is_neighbor, is_next, areas, mean_length: operator.mean_length, length }
}

/// Flags of the vertices that are masked or that no face of a mesh uses: they count in no mean.
pub(crate) fn without_unused(case: &Case, is_masked: &[bool]) -> Vec<bool> {
    let Parts::Mesh { triangles, .. } = &case.parts else { return is_masked.to_vec() };
    let class = weld(&case.parts).class;
    let mut is_out = vec![true; is_masked.len()];
    triangles.as_flattened().iter().for_each(|&v| is_out[class[v as usize]] = false);
    is_out.iter().zip(is_masked).map(|(a, b)| *a || *b).collect()
}

/// Rows of `matrix` times the channels of a signal, n × n_channels.
pub(crate) fn apply(matrix: &Matrix, signal: &[f64], n_channels: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for row in matrix {
        for c in 0..n_channels {
            out.push(row.iter().enumerate().map(|(y, m)| m * signal[y * n_channels + c]).sum());
        }
    }
    out
}

/// The mean of a signal of the file over the vertices that are one.
pub(crate) fn mean_of_welded(welded: &Welded, signal: &[f64], n_channels: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for class in 0..welded.first.len() {
        let members: Vec<usize> = (0..welded.class.len()).filter(|&x| welded.class[x] == class).collect();
        for c in 0..n_channels {
            out.push(mean(members.iter().map(|&x| signal[x * n_channels + c])));
        }
    }
    out
}

/// Gives the masked vertices of the file what the others at their position have on average, or 0.
pub(crate) fn fill(welded: &Welded, flags: &[bool], signal: &mut [f64], n_channels: usize) {
    for x in (0..flags.len()).filter(|&x| flags[x]) {
        for c in 0..n_channels {
            let others: Vec<f64> = (0..flags.len())
                .filter(|&y| welded.class[y] == welded.class[x] && !flags[y])
                .map(|y| signal[n_channels * y + c])
                .collect();
            signal[n_channels * x + c] =
                if others.is_empty() { 0.0 } else { others.iter().sum::<f64>() / others.len() as f64 };
        }
    }
}

/// S_f and W_f of eq. 11 in the order of the file.
pub(crate) struct Bands {
    /// S_f(0) … S_f(J).
    pub(crate) scaling: Vec<Vec<f64>>,
    /// W_f(1) … W_f(J), at index j − 1.
    pub(crate) wavelet: Vec<Vec<f64>>,
}

/// `S_f(j,x) = ⟨f, φ_{j,x}⟩` and `W_f(j,x) = ⟨f, ψ_{j,x}⟩` with `Ψ_j = Φ_{j−1} − Φ_j` (eq. 8, 11). Where the file repeats a
/// vertex, f is the mean of its values but on level 0.
pub(crate) fn bands(phi: &[Matrix], welded: &Welded, signal: &[f64], n_channels: usize) -> Bands {
    let f = mean_of_welded(welded, signal, n_channels);
    let scatter = |values: &[f64]| -> Vec<f64> {
        welded.class.iter().flat_map(|&c| values[c * n_channels..][..n_channels].to_vec()).collect()
    };
    let mut scaling = vec![signal.to_vec()];
    let mut wavelet = Vec::new();
    for j in 1..phi.len() {
        scaling.push(scatter(&apply(&phi[j], &f, n_channels)));
        let psi = minus(&phi[j - 1], &phi[j]);
        let mut band = scatter(&apply(&psi, &f, n_channels));
        if j == 1 {
            let mean = scatter(&f);
            band.iter_mut().zip(signal.iter().zip(&mean)).for_each(|(w, (f, mean))| *w += f - mean);
        }
        wavelet.push(band);
    }
    Bands { scaling, wavelet }
}

/// ‖W_f(j,x)‖ over the channels at the welded vertices, for each level.
pub(crate) fn norms(phi: &[Matrix], f: &[f64], n_channels: usize) -> Vec<Vec<f64>> {
    (1..phi.len())
        .map(|j| {
            apply(&minus(&phi[j - 1], &phi[j]), f, n_channels)
                .chunks(n_channels)
                .map(|w| w.iter().map(|w| w * w).sum::<f64>().sqrt())
                .collect()
        })
        .collect()
}
