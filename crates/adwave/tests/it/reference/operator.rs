//! Eq. 1, 2, 4 and 5: the local operator, the diffusion, its stationary distribution and its step length.

use crate::reference::dense::{
    LocalOperator, Matrix, Mutant, local_operator, normalized_rows, restricted, stationary, step_length, weld,
};
use crate::reference::fast::Fast;
use crate::reference::shapes::{Case, Parts, cases};
use crate::reference::{ROUNDING, SEEN, assert_close, assert_same_matrix, difference};
use adwave::operator::{CloudGraph, OperatorParams};
use std::f64::consts::PI;

fn off_diagonal(t: &Matrix) -> Matrix {
    let mut t = t.clone();
    for (x, row) in t.iter_mut().enumerate() {
        row[x] = 0.0;
    }
    t
}

fn expected(case: &Case) -> LocalOperator {
    local_operator(case, Mutant::None)
}

#[test]
fn the_local_operator_is_that_of_equation_1() {
    for case in cases() {
        let (fast, expected) = (Fast::new(&case).local_operator(), expected(&case));
        let t = off_diagonal(&expected.t);
        // One factor for all rows, an even power of 2: the square of the unit that lengths are measured in.
        let largest = |t: &Matrix| t.iter().flatten().fold(0.0_f64, |m, v| m.max(*v));
        let exponent = (largest(&t) / largest(&fast.off_diagonal)).log2();
        let whole = exponent.round();
        assert!((exponent - whole).abs() < ROUNDING && whole % 2.0 == 0.0, "{}: 2^{exponent}", case.name);
        let scaled: Matrix =
            fast.off_diagonal.iter().map(|row| row.iter().map(|v| v * whole.exp2()).collect()).collect();
        assert_same_matrix(&scaled, &t, ROUNDING, case.name);
        assert_close(&fast.areas, &expected.areas, ROUNDING, case.name);
        assert_close(
            &[fast.mean_length, fast.time],
            &[expected.mean_length, expected.time()],
            ROUNDING,
            case.name,
        );
        let n = t.len();
        let mean_square: Vec<f64> = (0..n)
            .map(|x| {
                let sum: f64 = t[x].iter().sum();
                let square: f64 = (0..n).map(|y| t[x][y] * expected.length[x][y].powi(2)).sum();
                if sum > 0.0 { square / sum } else { 0.0 }
            })
            .collect();
        assert_close(&fast.mean_square, &mean_square, ROUNDING, case.name);
    }
}

#[test]
fn the_mean_length_of_a_cloud_counts_every_neighbor_of_a_tie() {
    // One neighbor each, but two of the point 1, equally far: (1 + 1 + 1 + 1 + 3) / 5. The neighborhood is what is directed,
    // so that the edge from 2 to 3 is none of them.
    let points = [0.0, 1.0, 2.0, 5.0].map(|x| [x, 0.0, 0.0]).to_vec();
    for graph in [CloudGraph::Union, CloudGraph::Directed] {
        let params = OperatorParams::default().with_neighbors(1).with_cloud_graph(graph);
        let case = Case { name: "tie", parts: Parts::Cloud { points: points.clone() }, params };
        assert_close(&[Fast::new(&case).local_operator().mean_length], &[1.4], ROUNDING, "E");
    }
}

#[test]
fn the_local_operator_is_the_discrete_laplacian_with_its_diagonal_turned() {
    // Eq. 2: T = 4πt²(L − 2D_L), L the Laplacian of Belkin, Sun and Wang (2008).
    for case in cases().iter().filter(|case| !matches!(case.parts, Parts::Graph { .. })) {
        let expected = expected(case);
        let (n, time) = (expected.t.len(), expected.time());
        let mut laplacian = vec![vec![0.0; n]; n];
        for (x, row) in laplacian.iter_mut().enumerate() {
            for y in (0..n).filter(|&y| expected.is_neighbor[x][y]) {
                let heat = (-expected.length[x][y].powi(2) / (4.0 * time)).exp() / (4.0 * PI * time * time);
                row[y] = heat * expected.areas[y];
            }
            row[x] = -row.iter().sum::<f64>();
        }
        for (x, row) in laplacian.iter_mut().enumerate() {
            row[x] -= 2.0 * row[x];
            for v in row {
                *v *= 4.0 * PI * time * time;
            }
        }
        assert_same_matrix(&Fast::new(case).diffusion(), &normalized_rows(&laplacian), ROUNDING, case.name);
    }
}

#[test]
fn the_diffusion_is_the_operator_with_normalized_rows() {
    for case in cases() {
        let (fast, expected) = (Fast::new(&case), expected(&case));
        assert_same_matrix(&fast.diffusion(), &normalized_rows(&expected.t), ROUNDING, case.name);
    }
}

#[test]
fn the_stationary_distribution_and_the_step_length_are_those_of_the_operator() {
    for case in cases() {
        let (fast, expected) = (Fast::new(&case), expected(&case));
        let (phi, pi) = (normalized_rows(&expected.t), stationary(&expected));
        assert_close(&fast.stationary(), &pi, ROUNDING, case.name);
        let step = step_length(&phi, &pi, &expected.length);
        assert_close(&[fast.step_length()], &[step], ROUNDING, case.name);
        let n = pi.len();
        let balance = (0..n).all(|x| {
            (0..n).all(|y| (pi[x] * phi[x][y] - pi[y] * phi[y][x]).abs() <= ROUNDING * pi[x].max(pi[y]))
        });
        assert_eq!(fast.is_reversible(), balance, "{}", case.name);
    }
}

#[test]
fn welded_vertices_share_the_area_of_their_place() {
    for case in cases() {
        let (welded, expected) = (weld(&case.parts), expected(&case));
        let share =
            |&c: &usize| expected.areas[c] / welded.class.iter().filter(|&&other| other == c).count() as f64;
        let shares: Vec<f64> = welded.class.iter().map(share).collect();
        assert_close(&Fast::new(&case).areas_of_the_file(), &shares, ROUNDING, case.name);
    }
}

#[test]
fn a_masked_operator_is_the_operator_without_those_vertices() {
    for case in cases() {
        let welded = weld(&case.parts);
        let flags: Vec<bool> = (0..case.parts.n_vertices()).map(|x| x % 5 == 2 || x == 6).collect();
        let is_masked: Vec<bool> = (0..welded.first.len())
            .map(|c| welded.class.iter().zip(&flags).all(|(&class, &flag)| class != c || flag))
            .collect();
        let (fast, whole) = (Fast::masked(&case, &flags), expected(&case));
        let rest = restricted(&whole, &is_masked);
        let areas = fast.areas_of_the_file();
        let is_without = |x: usize| is_masked[welded.class[x]];
        assert!((0..areas.len()).all(|x| !is_without(x) || areas[x] == 0.0), "{}: masked areas", case.name);
        let phi = normalized_rows(&rest.t);
        assert_same_matrix(&fast.diffusion(), &phi, ROUNDING, case.name);
        let pi = stationary(&rest);
        assert_close(&fast.stationary(), &pi, ROUNDING, case.name);
        assert_close(&[fast.step_length()], &[step_length(&phi, &pi, &rest.length)], ROUNDING, case.name);
    }
}

#[test]
fn another_kernel_another_area_and_another_diagonal_would_be_seen() {
    let mutants = [
        Mutant::TwiceAsSharp,
        Mutant::HalfAsSharp,
        Mutant::AreaOfTheRow,
        Mutant::DoubleTime,
        Mutant::NotLazy,
        Mutant::HalfLazy,
    ];
    for case in cases() {
        let phi = Fast::new(&case).diffusion();
        for mutant in mutants {
            let is_graph = matches!(case.parts, Parts::Graph { .. });
            if is_graph && !matches!(mutant, Mutant::NotLazy | Mutant::HalfLazy) {
                continue; // a graph's weights are given
            }
            if case.name.contains("areas of 1") && mutant == Mutant::AreaOfTheRow {
                continue;
            }
            let other = normalized_rows(&local_operator(&case, mutant).t);
            let off = difference(&phi.concat(), &other.concat());
            assert!(off > SEEN * ROUNDING, "{}, {mutant:?}: only {off:.1e}", case.name);
        }
    }
}
