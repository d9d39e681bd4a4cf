//! Tests of the gradient against differences of the energy.

use super::contacts::{Contacts, kept_distances};
use super::energy::{LengthEnergy, LengthState};
use crate::rotation::NO_TURN;
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::{Decomposer, Progress};

#[test]
fn the_gradient_is_that_of_differences() {
    let sample = Sample::from_name("sphere", Some(400)).unwrap();
    let shape = Shape::Mesh(Mesh::new(sample.points.clone(), sample.faces).unwrap());
    let decomposer = Decomposer::new(&shape);
    let rest = decomposer.positions().to_vec();
    let is_free: Vec<bool> = rest.iter().map(|p| p[2].abs() < 0.8).collect();
    let bumped = |k: usize, size: f64| {
        let number = |c: usize| (((3 * k + c) * 7919) % 1000) as f64 / 500.0 - 1.0;
        [0, 1, 2].map(|c| rest[k][c] + if is_free[k] { size * number(c) } else { 0.0 })
    };
    let detail: Vec<_> = (0..rest.len()).map(|k| bumped(k, 0.02)).collect();
    let start: Vec<_> = (0..rest.len()).map(|k| bumped(k, 0.05)).collect();
    let kept = kept_distances(decomposer.neighbors(), &rest);
    for share in [1.0, 0.4] {
        let energy = LengthEnergy::new(decomposer.neighbors(), &rest, is_free.clone(), share);
        let (unit, progress) = (energy.unit, Progress::none());
        let contacts =
            Contacts::new(&start, &rest, &kept, &is_free, unit, 1.0 / (unit * unit), progress).unwrap();
        let at = |points: Vec<[f64; 3]>| {
            let turns = vec![NO_TURN; points.len()];
            let gradient = vec![[0.0; 3]; points.len()];
            let mut state = LengthState { points, turns, gradient, value: 0.0 };
            // A second time, so that the rotations have come to rest.
            energy.evaluate(&mut state, &detail, &contacts, progress).unwrap();
            energy.evaluate(&mut state, &detail, &contacts, progress).unwrap();
            state
        };
        let here = at(start.clone());
        assert!(here.value > 0.0);
        let step = 1e-6;
        for x in (0..rest.len()).filter(|&x| is_free[x]).step_by(37) {
            for c in 0..3 {
                let moved = |sign: f64| {
                    let mut points = start.clone();
                    points[x][c] += sign * step;
                    at(points).value
                };
                let slope = (moved(1.0) - moved(-1.0)) / (2.0 * step);
                let found = here.gradient[x][c];
                assert!((slope - found).abs() < 1e-5 * (1.0 + found.abs()), "{x} {c}: {slope} {found}");
            }
        }
        for x in (0..rest.len()).filter(|&x| !is_free[x]) {
            assert_eq!(here.gradient[x], [0.0; 3]);
        }
    }
}
