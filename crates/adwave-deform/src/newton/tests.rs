//! Tests of the derivatives: against each other, and against differences of the energy.

use super::*;
use crate::{DeformParams, DeformRegions, Deformer, HandleMotion};
use adwave::bands::Schedule;
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};

#[test]
fn cross_products_and_their_transposes_agree() {
    let (w, r, m) = (
        [0.3, -0.7, 0.2],
        to_matrix(&exponential(&[0.5, 0.1, -1.0])),
        [[1.0, 2.0, 0.5], [-0.3, 0.7, 1.1], [0.2, 0.9, -1.4]],
    );
    let direct: f64 = cross_rows(&w, &r).iter().zip(&m).map(|(a, b)| dot(a, b)).sum();
    assert!((direct - dot(&w, &axial(&m, &r))).abs() < 1e-14);
}

/// A bent sphere, away from rest.
fn bent_sphere() -> Deformer {
    let sample = Sample::from_name("sphere", Some(1500)).unwrap();
    let shape = Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces).unwrap());
    let decomposer = Decomposer::new(&shape);
    let beyond = |z: f64| (0..).zip(&sample.points).filter(|(_, p)| z * p[2] > 0.8).map(|(v, _)| v).collect();
    // A region that turns, and a single vertex that turns freely.
    let regions = DeformRegions { fixed: beyond(-1.0), handles: vec![beyond(1.0), vec![750]] };
    let schedule = Schedule::dyadic(6).unwrap();
    let (params, progress) = (DeformParams::default(), Progress::none());
    let mut deformer = Deformer::bind(&decomposer, &schedule, &regions, &params, progress).unwrap();
    let turn = HandleMotion::from_turn([0.0, 1.0, 0.3], 0.8, [0.0, 0.0, 0.8]).unwrap();
    deformer.set(1, turn).unwrap();
    deformer.set(2, HandleMotion::from_translation([0.2, -0.1, 0.3])).unwrap();
    deformer.step(progress).unwrap();
    deformer
}

/// Small rotation vectors of the free columns, of mixed signs.
fn directions(solver: &NodeSolver, n: usize, seed: usize) -> Vec<Vector> {
    let number = |k: usize| ((k * 7919 + seed * 104_729) % 1000) as f64 / 500.0 - 1.0;
    let vector = |k: usize| [number(3 * k), number(3 * k + 1), number(3 * k + 2)];
    (0..n).map(|k| if solver.has_free_turn[k] { vector(k) } else { [0.0; 3] }).collect()
}

#[test]
fn the_gradient_is_that_of_differences() {
    let deformer = bent_sphere();
    let (energy, solver, state) = deformer.parts();
    let mut state = state.clone();
    solver.fit_maps(energy, &mut state);
    let (_, gradient) = solver.linearize(energy, &state);
    let value = |state: &NodeState| {
        let mut state = state.clone();
        solver.fit_maps(energy, &mut state);
        energy.value(&state.maps, &state.turns.iter().map(to_matrix).collect::<Vec<_>>())
    };
    for seed in 0..5 {
        let direction = directions(solver, energy.n_columns(), seed);
        let step = 1e-4;
        let up = value(&rotate_state(&state, &direction, step));
        let down = value(&rotate_state(&state, &direction, -step));
        let (slope, expected) = ((up - down) / (2.0 * step), total_dot(&gradient, &direction));
        let size = (total_dot(&gradient, &gradient) * total_dot(&direction, &direction)).sqrt();
        assert!((slope - expected).abs() < 1e-6 * size, "{slope} {expected} {size}");
        assert!(size > 1e-3, "{size}");
    }
}

#[test]
fn curvature_along_a_direction_is_that_of_differences() {
    let deformer = bent_sphere();
    let (energy, solver, state) = deformer.parts();
    let mut state = state.clone();
    solver.fit_maps(energy, &mut state);
    let (at, _) = solver.linearize(energy, &state);
    let value = |state: &NodeState| {
        let mut state = state.clone();
        solver.fit_maps(energy, &mut state);
        energy.value(&state.maps, &state.turns.iter().map(to_matrix).collect::<Vec<_>>())
    };
    for seed in 0..3 {
        let direction = directions(solver, energy.n_columns(), seed);
        let step = 1e-3;
        let ends =
            value(&rotate_state(&state, &direction, step)) + value(&rotate_state(&state, &direction, -step));
        let second = (ends - 2.0 * value(&state)) / (step * step);
        let expected = total_dot(&direction, &solver.hessian(energy, &at, &direction));
        assert!((second - expected).abs() < 1e-4 * expected.abs(), "{second} {expected}");
    }
}
