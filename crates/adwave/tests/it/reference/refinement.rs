//! Refined positions of features between vertices and levels, and the ratio of their curvatures.

use crate::reference::dense::{LocalOperator, Mutant, distance, local_operator, spread, weld, within};
use crate::reference::fast::{Fast, FeatureParams, Refinement, Response};
use crate::reference::shapes::{Case, Noise, Parts, cases};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Vector2, Vector3};

/// Widths that are even neither in σ nor in log σ.
const SIGMA: [f64; 6] = [0.0, 1.0, 1.7, 2.2, 4.1, 9.0];
/// Six unknowns by normal equations, relative to the nearest neighbor.
const FIT: f64 = 1e-7;
/// The smallest of the singular values by the largest, below which six points are as good as on a conic.
const SINGULAR: f64 = 1e-4;

/// A vertex and its neighbors, in the plane that fits them best.
struct Around {
    /// Vertices, the middle first, and where they are.
    vertices: Vec<usize>,
    places: Vec<Vector3<f64>>,
    origin: Vector3<f64>,
    directions: [Vector3<f64>; 3],
    nearest: f64,
}

impl Around {
    fn new(points: &[[f64; 3]], neighbors: &[bool], x: usize) -> Self {
        let others: Vec<usize> = (0..points.len()).filter(|&y| neighbors[y]).collect();
        let vertices: Vec<usize> = std::iter::once(x).chain(others.iter().copied()).collect();
        let origin = Vector3::from(points[x]);
        let directions = spread(&vertices.iter().map(|&y| points[y]).collect::<Vec<_>>());
        let place =
            |&y: &usize| Vector3::from(directions.map(|d| d.dot(&(Vector3::from(points[y]) - origin))));
        Self {
            places: vertices.iter().map(place).collect(),
            nearest: others.iter().map(|&y| distance(points[x], points[y])).fold(f64::INFINITY, f64::min),
            vertices,
            origin,
            directions,
        }
    }

    /// The gradient and the second derivatives at the middle of the quadric that fits values best, in units of the nearest
    /// neighbor's distance; `None` where they do not determine it.
    fn quadric(&self, value: impl Fn(usize) -> f64) -> Option<(Vector2<f64>, Matrix2<f64>)> {
        let n = self.places.len();
        if n < 6 {
            return None;
        }
        let rows = DMatrix::from_fn(n, 6, |k, c| {
            let p = self.places[k] / self.nearest;
            [1.0, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y][c]
        });
        let svd = rows.svd(true, true);
        if svd.singular_values.min() < SINGULAR * svd.singular_values.max() {
            return None;
        }
        let values = DVector::from_fn(n, |k, _| value(k));
        let q = svd.solve(&values, 0.0).expect("both sides were asked for");
        Some((Vector2::new(q[1], q[2]), Matrix2::new(2.0 * q[3], q[4], q[4], 2.0 * q[5])))
    }

    /// Position of the maximum of R, or the vertex.
    fn top(&self, r: &[f64]) -> [f64; 3] {
        let Some((gradient, hessian)) = self.quadric(|k| r[self.vertices[k]]) else {
            return self.origin.into();
        };
        let sign = r[self.vertices[0]].signum();
        let bends = hessian.symmetric_eigenvalues();
        if sign * bends[0] >= 0.0 || sign * bends[1] >= 0.0 {
            return self.origin.into();
        }
        let at = hessian.lu().solve(&-gradient).expect("both bend");
        if at.norm() > 1.0 {
            return self.origin.into();
        }
        let Some((slope, bend)) = self.quadric(|k| self.places[k].z / self.nearest) else { unreachable!() };
        let height = slope.dot(&at) + at.dot(&(bend * at)) / 2.0;
        let [u, v, normal] = self.directions;
        (self.origin + self.nearest * (at.x * u + at.y * v + height * normal)).into()
    }

    /// The larger of the principal curvatures by the smaller; `None` unless both bend to the same side.
    fn ratio(&self, r: &[f64]) -> Option<f64> {
        let bends = self.quadric(|k| r[self.vertices[k]])?.1.symmetric_eigenvalues();
        let (small, large) = (bends.abs().min(), bends.abs().max());
        (bends[0] * bends[1] > 0.0).then(|| large / small)
    }
}

/// The top of the parabola through |R| over log σ, not past half-way to the next level (which it passes only where levels tie); σ_j where
/// it opens upwards.
fn sigma_at_the_top(r: [f64; 3], sigma: &[f64]) -> f64 {
    let t = [sigma[0], sigma[1], sigma[2]].map(f64::ln);
    let rows = Matrix3::from_fn(|k, c| t[k].powi(c as i32));
    let [_, b, c]: [f64; 3] = rows.lu().solve(&Vector3::from(r)).expect("three widths").into();
    if c < 0.0 { (-b / (2.0 * c)).clamp(0.5 * (t[0] + t[1]), 0.5 * (t[1] + t[2])).exp() } else { sigma[1] }
}

/// Bands with a hill (or a hole, or a hole in what is high) near each vertex in turn, stretched and turned.
fn bumps(case: &Case, operator: &LocalOperator, points: &[[f64; 3]]) -> Vec<Vec<Vec<f64>>> {
    let mut noise = Noise::new(case.name.len() as u64);
    let e = operator.mean_length;
    let bump = |x: usize| {
        let off: [f64; 3] = std::array::from_fn(|c| points[x][c] + 0.5 * e * noise.signed());
        let axis = Vector3::new(noise.signed(), noise.signed(), noise.signed()).normalize();
        let (width, along) = (2.0 * e * (0.6 + noise.next()), 0.2 + 0.8 * noise.next());
        let height = |p: &[f64; 3]| {
            let d = Vector3::from(*p) - Vector3::from(off);
            let square = d.norm_squared() - (1.0 - along) * d.dot(&axis).powi(2);
            (-square / (width * width)).exp()
        };
        let (sign, floor) = [(1.0, 0.0), (-1.0, 0.0), (-0.9, 1.0)][x % 3];
        let top = 2 + x % 3;
        let level = |j: usize| {
            let share = if j == top { 1.0 } else { 0.9 * noise.next() };
            points.iter().map(|p| floor + share * sign * height(p)).collect()
        };
        (1..SIGMA.len()).map(level).collect()
    };
    (0..points.len()).map(bump).collect()
}

#[test]
fn features_are_refined_to_the_top_of_a_quadric_and_of_a_parabola() {
    let (mut moved, mut stayed, mut kept, mut rejected) = (0, 0, [0; 4], [0; 4]);
    let plain = FeatureParams::default().with_response(Response::Literal).with_theta(0.01);
    for case in cases() {
        let (Parts::Mesh { points, .. } | Parts::Cloud { points }) = &case.parts else { continue };
        let welded = weld(&case.parts);
        let points: Vec<[f64; 3]> = welded.first.iter().map(|&x| points[x]).collect();
        let operator = local_operator(&case, Mutant::None);
        let rings = if matches!(case.parts, Parts::Cloud { .. }) { 1 } else { 2 };
        let (near, fast) = (within(&operator.is_next, rings), Fast::new(&case));
        for levels in bumps(&case, &operator, &points) {
            let all = fast.features_of(&levels, &SIGMA, &plain);
            let refined = fast.features_of(&levels, &SIGMA, &plain.with_refinement(Refinement::Quadratic));
            assert_eq!(all.len(), refined.len());
            let mut ratios = Vec::new();
            for (feature, refined) in all.iter().zip(&refined) {
                let (x, j) = (welded.class[feature.vertex], feature.level);
                assert_eq!((feature.position, feature.sigma), (Some(points[x]), SIGMA[j]));
                assert_eq!((refined.vertex, refined.level), (feature.vertex, j));
                let sign = feature.response.signum();
                let r = [j - 2, j - 1, j].map(|level| sign * levels[level][x]);
                let sigma = sigma_at_the_top(r, &SIGMA[j - 1..=j + 1]);
                assert!(
                    (refined.sigma / sigma - 1.0).abs() < FIT,
                    "{}: {} for {sigma}",
                    case.name,
                    refined.sigma
                );
                let around = Around::new(&points, &near[x], x);
                let top = around.top(&levels[j - 1]);
                let off = distance(refined.position.unwrap(), top) / around.nearest;
                assert!(off <= FIT, "{}, vertex {x}: off by {off:.1e}", case.name);
                *if top == points[x] { &mut stayed } else { &mut moved } += 1;
                ratios.push(around.ratio(&levels[j - 1]));
            }
            for (k, most) in [1.0, 1.5, 4.0, 10.0].into_iter().enumerate() {
                let found = fast.features_of(&levels, &SIGMA, &plain.with_max_edge_ratio(most));
                let is_round = |ratio: &Option<f64>| ratio.is_some_and(|ratio| ratio <= most);
                let expected = all.iter().zip(&ratios).filter(|(_, ratio)| is_round(ratio)).map(|(f, _)| f);
                assert!(found.iter().eq(expected), "{}, at most {most}", case.name);
                kept[k] += found.len();
                rejected[k] += all.len() - found.len();
            }
        }
    }
    assert!(moved > 100 && stayed > 100, "{moved} moved, {stayed} stayed");
    assert!(kept[1..].iter().chain(&rejected).all(|&n| n > 50), "{kept:?} kept, {rejected:?} rejected");
}

#[test]
fn nothing_is_rejected_or_refined_by_default() {
    let params = FeatureParams::default();
    assert_eq!(
        (params.max_edge_ratio, params.refinement, params.border_sigmas),
        (None, Refinement::Off, None)
    );
}

#[test]
fn a_graph_has_no_curvature_and_no_place() {
    let binding = cases();
    let case = binding.last().unwrap();
    let n = case.parts.n_vertices();
    let mut levels = vec![vec![0.0; n]; 5];
    for (level, r) in levels.iter_mut().zip([0.1, 0.5, 1.0, 0.7, 0.2]) {
        level[0] = r;
    }
    let fast = Fast::new(case);
    let params = FeatureParams::default().with_response(Response::Literal);
    let refined = fast.features_of(&levels, &SIGMA, &params.with_refinement(Refinement::Quadratic));
    assert_eq!(refined.len(), 1);
    assert_eq!((refined[0].vertex, refined[0].level, refined[0].position), (0, 3, None));
    let sigma = sigma_at_the_top([0.5, 1.0, 0.7], &SIGMA[2..]);
    assert!((refined[0].sigma / sigma - 1.0).abs() < FIT);
    assert_eq!(fast.features_of(&levels, &SIGMA, &params.with_max_edge_ratio(1e9)), []);
}
