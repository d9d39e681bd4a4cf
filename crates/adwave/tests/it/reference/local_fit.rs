//! Bands about a local linear fit: `S_f(j) = Φ_j f + a_j·(p − Φ_j p)`, from dense matrices.

use crate::reference::dense::{
    Matrix, apply, identity, local_operator, mean_of_welded, normalized_rows, product, weld,
};
use crate::reference::fast::{Fast, dyadic};
use crate::reference::shapes::{Case, Parts, cases, signal};
use crate::reference::{SEEN, assert_close, difference};
use adwave::bands::Engine;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Directions of a few neighbors are known to rounding divided by how much they spread in them.
const FITS: f64 = 1e-8;

const LEVELS: usize = 5;

/// Change of the formula.
#[derive(Clone, Copy, PartialEq)]
enum Mutant {
    None,
    /// a_j from the edges of x alone.
    OwnEdges,
    /// Gradients of all levels with the same smoothing.
    SameGradient,
    /// Gradients count alike, however their neighbors spread.
    NoWeights,
    /// The drift along the normal counts too.
    NormalDrift,
}

/// Squared spreads, largest first, and their directions.
fn spread(m: &Matrix3<f64>) -> ([f64; 3], [Vector3<f64>; 3]) {
    if m.trace() == 0.0 {
        return ([0.0; 3], [Vector3::zeros(); 3]);
    }
    let eigen = SymmetricEigen::new(m / m.trace());
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    (
        order.map(|k| eigen.eigenvalues[k].max(0.0) * m.trace()),
        order.map(|k| eigen.eigenvectors.column(k).into_owned()),
    )
}

/// `S_f(1) … S_f(J)` of a field at the welded vertices, over the coordinates `axes`.
fn scaling(case: &Case, field: &[f64], axes: &[usize], mutant: Mutant) -> Vec<Vec<f64>> {
    let (Parts::Mesh { points, .. } | Parts::Cloud { points }) = &case.parts else { panic!("no positions") };
    let welded = weld(&case.parts);
    let p: Vec<Vector3<f64>> = welded
        .first
        .iter()
        .map(|&x| Vector3::from_fn(|c, _| if axes.contains(&c) { points[x][c] } else { 0.0 }))
        .collect();
    let n = p.len();
    let phi = normalized_rows(&local_operator(case, crate::reference::dense::Mutant::None).t);
    let power = |k: usize| (0..k).fold(identity(n), |m, _| product(&m, &phi));
    // M and v after four steps.
    let around = if mutant == Mutant::OwnEdges { identity(n) } else { power(4) };
    let (mut m, mut v) = (vec![Matrix3::zeros(); n], vec![Vector3::zeros(); n]);
    for x in 0..n {
        for z in 0..n {
            for y in 0..n {
                let d = p[y] - p[z];
                m[x] += around[x][z] * phi[z][y] * d * d.transpose();
                v[x] += around[x][z] * phi[z][y] * (field[y] - field[z]) * d;
            }
        }
    }
    let spreads: Vec<_> = m.iter().map(spread).collect();
    let mut ratios: Vec<f64> = spreads.iter().filter(|s| s.0[1] > 0.0).map(|s| s.0[2] / s.0[1]).collect();
    ratios.sort_by(f64::total_cmp);
    let is_volume =
        matches!(case.parts, Parts::Cloud { .. }) && axes.len() == 3 && ratios[ratios.len() / 2] > 0.5;
    assert!(!is_volume, "the shapes are surfaces");
    let gradient = |x: usize| -> Vector3<f64> {
        let (squares, directions) = &spreads[x];
        (0..2)
            .filter(|&k| squares[k] > 1e-10 * squares[0])
            .map(|k| directions[k] * (directions[k].dot(&v[x]) / squares[k]))
            .sum()
    };
    let weight = |x: usize| match &spreads[x].0 {
        [largest, ..] if *largest == 0.0 => 0.0,
        _ if mutant == Mutant::NoWeights => 1.0,
        [largest, second, _] => (second / largest).max(1e-10),
    };
    let own: Vec<Vector3<f64>> = (0..n).map(gradient).collect();
    let weights: Vec<f64> = (0..n).map(weight).collect();
    let mean_weight = weights.iter().sum::<f64>() / n as f64;
    (1..=LEVELS)
        .map(|j| {
            let steps = 1_usize << (j - 1);
            let phi_j = power(steps);
            let smoothing = if mutant == Mutant::SameGradient { identity(n) } else { power(steps / 4) };
            let s = apply(&phi_j, field, 1);
            (0..n)
                .map(|x| {
                    let sum: f64 = (0..n).map(|z| smoothing[x][z] * weights[z]).sum();
                    let a: Vector3<f64> = if sum > 1e-2 * mean_weight {
                        (0..n).map(|z| own[z] * (smoothing[x][z] * weights[z] / sum)).sum()
                    } else {
                        own[x]
                    };
                    let drift: Vector3<f64> = (0..n).map(|y| (p[x] - p[y]) * phi_j[x][y]).sum();
                    let normal = spreads[x].1[2];
                    let along = if mutant == Mutant::NormalDrift { 0.0 } else { normal.dot(&drift) };
                    s[x] + a.dot(&(drift - normal * along))
                })
                .collect()
        })
        .collect()
}

/// Cases with positions and whole steps of the walk over the vertices of the file.
fn shapes() -> Vec<Case> {
    cases().into_iter().filter(|case| !matches!(case.parts, Parts::Graph { .. })).collect()
}

/// The field in the file, and over which coordinates it is fitted: noise over all, heights over x and y.
fn fields(case: &Case) -> [(Vec<f64>, &'static [usize]); 2] {
    let (Parts::Mesh { points, .. } | Parts::Cloud { points }) = &case.parts else { panic!("no positions") };
    let heights = points.iter().map(|p| p[2]).collect();
    [(signal(points.len(), 1, 7), &[0, 1, 2]), (heights, &[0, 1])]
}

#[test]
fn scaling_coefficients_are_those_of_the_formula() {
    for case in shapes() {
        let fast = Fast::new(&case);
        for (field, axes) in fields(&case) {
            let welded = weld(&case.parts);
            let mean = mean_of_welded(&welded, &field, 1);
            let expected = scaling(&case, &mean, axes, Mutant::None);
            let found = fast.linear_scaling(&field, &dyadic(LEVELS), Engine::Powers);
            for (j, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let expected: Vec<f64> = welded.class.iter().map(|&c| expected[c]).collect();
                assert_close(found, &expected, FITS, &format!("{}, S_f({})", case.name, j + 1));
            }
        }
    }
}

#[test]
fn a_change_of_the_formula_is_seen() {
    let case = shapes().into_iter().find(|case| case.name == "cloud").expect("a cloud");
    for (field, axes) in fields(&case) {
        let mean = mean_of_welded(&weld(&case.parts), &field, 1);
        let expected: Matrix = scaling(&case, &mean, axes, Mutant::None);
        for mutant in [Mutant::OwnEdges, Mutant::SameGradient, Mutant::NoWeights, Mutant::NormalDrift] {
            if mutant == Mutant::NormalDrift && axes.len() == 2 {
                continue; // heights do not drift along the normal of their plane
            }
            let other = scaling(&case, &mean, axes, mutant);
            assert!(difference(&other.concat(), &expected.concat()) > SEEN * FITS);
        }
    }
}
