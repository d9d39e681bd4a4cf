//! Heat on the surface with dense matrices, term by term, and without a line of the crate's code: cotangents and masses,
//! Voronoi cells of a cloud, the matrix exponential.

use crate::reference::dense::{Matrix, distance, spread, weld};
use crate::reference::shapes::{Case, Parts};
use nalgebra::{DMatrix, Vector2, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};

/// Angles that sum to more than π by less than this are on one circle but for rounding.
const ON_A_CIRCLE: f64 = 1e-9;

/// Corners of the polygon that stands for a disc.
const DISC_CORNERS: usize = 24;
/// Extent of a cell, in units of the distance to the last of the neighbors looked at.
const REACH: f64 = 0.75;
/// Largest height of a neighbor above the tangent plane, in units of its distance.
const STEEP: f64 = 0.8;

/// Mutations of the formula, which the tests must notice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wrong {
    /// Nothing.
    None,
    /// No mass is raised.
    NotRaised,
    /// Twice the time.
    DoubleTime,
    /// All masses alike.
    EqualMass,
    /// All weights alike.
    EqualWeights,
}

/// w and M.
pub(crate) struct Laplacian {
    /// w(x,y) = −L(x,y), 0 on the diagonal.
    pub(crate) w: Matrix,
    /// Areas; 1 on a graph.
    pub(crate) mass: Vec<f64>,
}

pub(crate) fn laplacian(case: &Case) -> Laplacian {
    let welded = weld(&case.parts);
    let n = welded.first.len();
    match &case.parts {
        Parts::Graph { edges, .. } => {
            let mut w = vec![vec![0.0; n]; n];
            for &(u, v, weight) in edges.iter().filter(|(u, v, _)| u != v) {
                w[u as usize][v as usize] += weight;
                w[v as usize][u as usize] += weight;
            }
            Laplacian { w, mass: vec![1.0; n] }
        }
        Parts::Mesh { points, triangles } => {
            let points: Vec<[f64; 3]> = welded.first.iter().map(|&x| points[x]).collect();
            let triangles = triangles.iter().map(|t| t.map(|v| welded.class[v as usize])).collect();
            of_mesh(&points, triangles)
        }
        Parts::Cloud { points } => {
            let points: Vec<[f64; 3]> = welded.first.iter().map(|&x| points[x]).collect();
            of_cloud(&points, 2 * case.params.neighbors)
        }
    }
}

type Lengths = BTreeMap<(usize, usize), f64>;

fn edge(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

/// The angle at `c` in a triangle.
fn angle(length: &Lengths, c: usize, [a, b]: [usize; 2]) -> f64 {
    let (p, q, r) = (length[&edge(c, a)], length[&edge(c, b)], length[&edge(a, b)]);
    ((p * p + q * q - r * r) / (2.0 * p * q)).clamp(-1.0, 1.0).acos()
}

/// The edges of all triangles, each with the third corners of its own.
fn apexes(triangles: &[[usize; 3]]) -> BTreeMap<(usize, usize), Vec<(usize, usize)>> {
    let mut apexes: BTreeMap<(usize, usize), Vec<(usize, usize)>> = BTreeMap::new();
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        for (a, b, c) in [(a, b, c), (b, c, a), (c, a, b)] {
            apexes.entry(edge(a, b)).or_default().push((t, c));
        }
    }
    apexes
}

/// Flips the edges of two triangles one at a time until their opposite angles sum to at most π, by lengths alone. For
/// meshes on whose way no two vertices get two edges.
fn intrinsic_delaunay(triangles: &mut [[usize; 3]], length: &mut Lengths) {
    loop {
        let apexes = apexes(triangles);
        let to_flip = apexes.iter().find_map(|(&(i, j), at)| match at[..] {
            [(t, k), (u, m)] => {
                let sum = angle(length, k, [i, j]) + angle(length, m, [i, j]);
                (sum > PI + ON_A_CIRCLE).then_some((i, j, t, k, u, m))
            }
            _ => None,
        });
        let Some((i, j, t, k, u, m)) = to_flip else { return };
        let at_i = angle(length, i, [j, k]) + angle(length, i, [j, m]);
        let (ik, im) = (length[&edge(i, k)], length[&edge(i, m)]);
        let km = (ik * ik + im * im - 2.0 * ik * im * at_i.cos()).sqrt();
        assert!(length.insert(edge(k, m), km).is_none(), "two edges between {k} and {m}");
        length.remove(&edge(i, j));
        triangles[t] = [k, m, j];
        triangles[u] = [m, k, i];
    }
}

/// `w = ½Σ cot` over the angles opposite the edge, and thirds of the triangles' areas, on the intrinsic Delaunay
/// triangulation.
///
/// Where an edge of the border sees an obtuse angle at c, its triangle abc and the mirror image beyond the border are two
/// triangles with c twice, a c c′ and b c c′: isosceles, with the angles 2A at a and π/2 − A at c. Half of each belongs here.
fn of_mesh(points: &[[f64; 3]], mut triangles: Vec<[usize; 3]>) -> Laplacian {
    let n = points.len();
    let mut length = Lengths::new();
    for &[a, b, c] in &triangles {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            length.insert(edge(a, b), distance(points[a], points[b]));
        }
    }
    intrinsic_delaunay(&mut triangles, &mut length);
    let apexes = apexes(&triangles);
    let mut cotangents: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
    let mut mass = vec![0.0; n];
    for &[a, b, c] in &triangles {
        let turns = [(a, b, c), (b, c, a), (c, a, b)];
        let obtuse = turns.into_iter().find(|&(a, b, c)| {
            apexes[&edge(a, b)].len() == 1 && angle(&length, c, [a, b]) > FRAC_PI_2 + ON_A_CIRCLE
        });
        if let Some((a, b, c)) = obtuse {
            for (a, b) in [(a, b), (b, a)] {
                let at = angle(&length, a, [b, c]);
                cotangents.entry(edge(a, c)).or_default().push(at.tan());
                let area = 0.5 * length[&edge(a, c)].powi(2) * (2.0 * at).sin();
                mass[a] += 0.5 * area / 3.0;
                mass[c] += area / 3.0;
            }
            continue;
        }
        for (a, b, c) in turns {
            let at = angle(&length, c, [a, b]);
            cotangents.entry(edge(a, b)).or_default().push(1.0 / at.tan());
            mass[c] += 0.5 * length[&edge(c, a)] * length[&edge(c, b)] * at.sin() / 3.0;
        }
    }
    let mut w = vec![vec![0.0; n]; n];
    for (&(a, b), cotangents) in &cotangents {
        // Delaunay whatever two of the triangles at an edge are neighbors around it.
        let sum: f64 = cotangents.iter().sum();
        assert!(if cotangents.len() == 2 { sum > -1e-9 } else { cotangents.iter().all(|&c| c > 0.0) });
        w[a][b] = 0.5 * sum;
        w[b][a] = 0.5 * sum;
    }
    Laplacian { w, mass }
}

/// `w(x,y) = ½(ℓ_x/d + ℓ_y/d)`: ℓ_x the side toward y of what is nearer to x than to any other point, in the tangent plane of
/// the `k` nearest; M the area of the triangles between x and such sides.
///
/// All half-planes at once: the cell's corners are where two of their edges meet that lie in all the others.
fn of_cloud(points: &[[f64; 3]], k: usize) -> Laplacian {
    const ON_IT: f64 = 1e-12;
    let n = points.len();
    let (mut one_sided, mut mass) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    for x in 0..n {
        let mut by_distance: Vec<usize> = (0..n).filter(|&y| y != x).collect();
        by_distance
            .sort_by(|&a, &b| distance(points[x], points[a]).total_cmp(&distance(points[x], points[b])));
        by_distance.truncate(k);
        let radius = REACH * distance(points[x], points[by_distance[by_distance.len() - 1]]);
        let others: Vec<[f64; 3]> = by_distance.iter().map(|&y| points[y]).collect();
        let [u, v, _] = spread(&others);
        // (n, h, y) is where n·q ≤ h, on the bisector with y.
        let mut halves: Vec<(Vector2<f64>, f64, Option<usize>)> = (0..DISC_CORNERS)
            .map(|k| {
                let angle = (k as f64 + 0.5) * 2.0 * PI / DISC_CORNERS as f64;
                let apothem = (PI / DISC_CORNERS as f64).cos();
                (Vector2::new(angle.cos(), angle.sin()), apothem, None)
            })
            .collect();
        for &y in &by_distance {
            let d = (Vector3::from(points[y]) - Vector3::from(points[x])) / radius;
            let flat = Vector2::new(d.dot(&u), d.dot(&v));
            if flat.norm() > (1.0 - STEEP * STEEP).sqrt() * d.norm() {
                let q = flat * (d.norm() / flat.norm());
                halves.push((q, q.norm_squared() / 2.0, Some(y)));
            }
        }
        for (i, (q, h, y)) in halves.iter().enumerate() {
            let Some(y) = *y else { continue };
            // Where along the bisector it enters and leaves the cell, and whether through the disc.
            let mut ends = Vec::new();
            for (j, (m, g, other)) in halves.iter().enumerate() {
                let det = q.perp(m);
                let corner = Vector2::new(h * m.y - g * q.y, g * q.x - h * m.x) / det;
                if j != i && det != 0.0 && halves.iter().all(|(n, h, _)| n.dot(&corner) <= h + ON_IT) {
                    ends.push((q.perp(&corner) / q.norm(), other.is_none()));
                }
            }
            if ends.len() < 2 {
                continue;
            }
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            let [(start, from_disc), .., (end, to_disc)] = ends[..] else { unreachable!() };
            let side = match (from_disc, to_disc) {
                (true, false) => end,
                (false, true) => -start,
                _ => end - start,
            };
            let height = if from_disc && to_disc { q.norm() } else { q.norm() / 2.0 };
            if side > 0.0 {
                one_sided[x][y] = side / q.norm();
                mass[x] += 0.5 * side * height * radius * radius;
            }
        }
    }
    let w = (0..n).map(|x| (0..n).map(|y| 0.5 * (one_sided[x][y] + one_sided[y][x])).collect()).collect();
    Laplacian { w, mass }
}

/// The cotangent weights of the Delaunay triangulation of points in the plane z = 0: three points are a triangle where
/// the circle through them has no other in it.
pub(crate) fn planar_delaunay(points: &[[f64; 3]]) -> (Matrix, Vec<[usize; 3]>) {
    let n = points.len();
    let at = |x: usize| Vector2::new(points[x][0], points[x][1]);
    let mut w = vec![vec![0.0; n]; n];
    let mut triangles = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                let (p, q) = (at(b) - at(a), at(c) - at(a));
                let twice = p.perp(&q);
                let square = (p.norm_squared() * q - q.norm_squared() * p) / (2.0 * twice);
                let center = at(a) + Vector2::new(square.y, -square.x);
                let radius = (at(a) - center).norm();
                if twice == 0.0 || (0..n).any(|d| (at(d) - center).norm() < radius * (1.0 - 1e-12)) {
                    continue;
                }
                triangles.push([a, b, c]);
                for (a, b, c) in [(a, b, c), (b, c, a), (c, a, b)] {
                    let (p, q) = (at(a) - at(c), at(b) - at(c));
                    let half = 0.5 * p.dot(&q) / p.perp(&q).abs();
                    w[a][b] += half;
                    w[b][a] += half;
                }
            }
        }
    }
    (w, triangles)
}

/// Heat operator of a shape.
pub(crate) struct Heat {
    /// τ·M⁻¹L.
    pub(crate) generator: DMatrix<f64>,
    /// Areas, before any mass is raised.
    pub(crate) areas: Vec<f64>,
    /// π ∝ M.
    pub(crate) stationary: Vec<f64>,
    pub(crate) step_length: f64,
}

/// `τ·M⁻¹L` where vertices are masked: nothing flows to or from them. `τ = A/(4√3·N)`, N of vertices that have a mass; on a
/// graph a step is half a jump on average over the nodes that have edges.
pub(crate) fn heat(case: &Case, is_masked: &[bool], wrong: Wrong) -> Heat {
    let Laplacian { mut w, mass: areas } = laplacian(case);
    let n = areas.len();
    if wrong == Wrong::EqualWeights {
        w.iter_mut().flatten().filter(|w| **w > 0.0).for_each(|w| *w = 0.5);
    }
    let stiffness: Vec<f64> = w.iter().map(|row| row.iter().sum()).collect();
    let mut mass = areas.clone();
    if wrong == Wrong::EqualMass {
        let mean = areas.iter().sum::<f64>() / n as f64;
        mass.iter_mut().filter(|m| **m > 0.0).for_each(|m| *m = mean);
    }
    // The 1 % of vertices with the largest L(x,x)/M(x), rounded up, get no larger one than the largest of the others; of 100
    // or fewer that is none, and on a graph too.
    let mut rates: Vec<f64> =
        (0..n).filter(|&x| stiffness[x] > 0.0).map(|x| stiffness[x] / mass[x]).collect();
    rates.sort_by(f64::total_cmp);
    let cap = rates[((0.99 * rates.len() as f64).floor() as usize).min(rates.len() - 1)];
    if wrong != Wrong::NotRaised && !matches!(case.parts, Parts::Graph { .. }) {
        for x in 0..n {
            mass[x] = mass[x].max(stiffness[x] / cap);
        }
    }
    let rate = |x: usize| if stiffness[x] > 0.0 { stiffness[x] / mass[x] } else { 0.0 };
    let (mut tau, step_length);
    if let Parts::Graph { .. } = case.parts {
        let n_moving = (0..n).filter(|&x| stiffness[x] > 0.0).count() as f64;
        tau = 0.5 / ((0..n).map(rate).sum::<f64>() / n_moving);
        step_length = 0.5_f64.sqrt();
    } else {
        let n_moving = mass.iter().filter(|m| **m > 0.0).count() as f64;
        tau = areas.iter().sum::<f64>() / (4.0 * 3.0_f64.sqrt() * n_moving);
        step_length = (4.0 * tau).sqrt();
    }
    if wrong == Wrong::DoubleTime {
        tau *= 2.0;
    }
    let flows = |x: usize, y: usize| !is_masked[x] && !is_masked[y] && w[x][y] > 0.0;
    let generator = DMatrix::from_fn(n, n, |x, y| match x == y {
        true => (0..n).filter(|&z| flows(x, z)).map(|z| tau * w[x][z] / mass[x]).sum(),
        false if flows(x, y) => -tau * w[x][y] / mass[x],
        false => 0.0,
    });
    let kept: Vec<f64> = (0..n).map(|x| if is_masked[x] { 0.0 } else { mass[x] }).collect();
    let total: f64 = kept.iter().sum();
    Heat { generator, areas, stationary: kept.into_iter().map(|m| m / total).collect(), step_length }
}

impl Heat {
    /// `S_n = exp(−n·τM⁻¹L)`: the series where the matrix is small, then squared again and again.
    pub(crate) fn after(&self, n_steps: f64) -> Matrix {
        let n = self.generator.nrows();
        let a = -n_steps * &self.generator;
        let largest = a.row_iter().map(|row| row.iter().map(|v| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        let squarings = (largest / 0.5).log2().ceil().max(0.0) as i32;
        let a = a / 2.0_f64.powi(squarings);
        let mut sum = DMatrix::identity(n, n);
        let mut term = sum.clone();
        for k in 1..20 {
            term = term * &a / f64::from(k);
            sum += &term;
        }
        for _ in 0..squarings {
            sum = &sum * &sum;
        }
        (0..n).map(|x| (0..n).map(|y| sum[(x, y)]).collect()).collect()
    }

    /// S_0 = I and S_n at each number of steps.
    pub(crate) fn levels(&self, steps: &[f64]) -> Vec<Matrix> {
        [0.0].iter().chain(steps).map(|&n| self.after(n)).collect()
    }
}
