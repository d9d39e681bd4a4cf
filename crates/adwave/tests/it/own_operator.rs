//! Laws of operators of one's own: the same walk has the same bands in whatever form it is given.

use adwave::bands::{BandsError, BandsParams, Engine, Schedule, Transform};
use adwave::features::{FeatureParams, features};
use adwave::local_fit::LocalFit;
use adwave::operator::{Diffusion, DiffusionError, Operator, OperatorKind, OperatorParams, RowFunction};
use adwave::region::parse_region;
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::{Cancelled, Decomposer, Progress};
use std::sync::Arc;

/// Rounding of some hundred products, relative to the largest value.
const ROUNDING: f64 = 1e-10;

fn creature(n: usize) -> (Decomposer, Vec<f64>) {
    let sample = Sample::from_name("creature", Some(n)).unwrap();
    let positions = sample.points.as_flattened().to_vec();
    (Decomposer::new(&Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())), positions)
}

/// The rows of a diffusion operator as a function.
fn row_function(diffusion: &Arc<Diffusion>) -> impl Operator + 'static {
    let (rows, weights) = (Arc::clone(diffusion), diffusion.stationary().to_vec());
    let row = move |x: usize| {
        let (columns, values) = rows.row(x);
        let entries: Vec<_> = columns.iter().zip(values).map(|(&y, &w)| (y as usize, w)).collect();
        entries
    };
    let walk = RowFunction::new(diffusion.n_vertices(), row).unwrap().with_weights(weights).unwrap();
    walk.with_step_length(diffusion.step_length())
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let largest = expected.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let off = found.iter().zip(expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(largest > 0.0 && off <= ROUNDING * largest, "{what}: {off:e} of {largest:e}");
}

#[test]
fn a_function_of_the_row_has_the_bands_of_the_stored_rows() {
    let (shape, positions) = creature(3000);
    let own = shape.with_operator(row_function(shape.rows("a test").unwrap())).unwrap();
    assert!(own.operator().is_reversible() && own.operator().rows().is_none());
    assert_eq!(own.default_levels(), shape.default_levels());
    let n = shape.n_vertices();
    for n_channels in [1, 3, 5, 20] {
        let signal: Vec<f64> =
            (0..n * n_channels).map(|i| positions[3 * (i / n_channels) + i % 3] + (i % 7) as f64).collect();
        for schedule in [Schedule::dyadic(7).unwrap(), Schedule::real(vec![0.5, 3.5]).unwrap()] {
            let bands = shape.decompose(&signal, n_channels, &schedule).unwrap();
            let found = own.decompose(&signal, n_channels, &schedule).unwrap();
            assert_eq!(
                (found.steps.clone(), found.sigma.clone()),
                (bands.steps.clone(), bands.sigma.clone())
            );
            assert!(found.info.error_bound <= 1e-9, "{:?}", found.info);
            for level in 1..=schedule.n_levels() {
                assert_close(found.wavelet(level), bands.wavelet(level), &format!("{n_channels}, {level}"));
            }
            let factors: Vec<f64> = (0..schedule.n_levels()).map(|j| 1.0 - 0.3 * j as f64).collect();
            let [found, expected] = [&own, &shape]
                .map(|shape| shape.request(&signal, n_channels, &schedule).weighted(&factors).unwrap().0);
            assert_close(&found, &expected, "a weighted sum");
        }
        let schedule = Schedule::dyadic(4).unwrap();
        let gradients = signal.repeat(5);
        let [found, expected] = [&own, &shape].map(|shape| {
            let (map, none) = (shape.vertex_map(), Progress::none());
            shape.transform().gradient_of_bands(map, &gradients, n_channels, &schedule, none).unwrap()
        });
        assert_close(&found, &expected, "the gradient");
    }
}

#[test]
fn normals_regions_and_features_follow_the_edges_of_the_shape() {
    let (shape, positions) = creature(3000);
    let own = shape.with_operator(row_function(shape.rows("a test").unwrap())).unwrap();
    let schedule = Schedule::dyadic(8).unwrap();
    let normals: Vec<[f64; 3]> = (0..shape.n_vertices()).map(|i| [0.6, 0.8, (i % 3) as f64]).collect();
    let [found, expected] = [&own, &shape].map(|shape| {
        shape.request(&positions, 3, &schedule).normal_components_in_one_pass(&normals).unwrap().levels
    });
    for (found, expected) in found.iter().zip(&expected) {
        assert_close(found, expected, "components along normals");
    }
    let region = parse_region("ball:vertex=17,radius=10%").unwrap();
    let [found, expected] = [&own, &shape].map(|shape| {
        region
            .weights(shape.metric(), &|_| None, &[], Progress::none())
            .unwrap()
            .to_vertices(shape.vertex_map())
    });
    assert!(found == expected && found.iter().any(|&w| w > 0.0));
    let [found, expected] = [&own, &shape].map(|shape| {
        let wavelets = shape.request(&positions, 3, &schedule).wavelets().unwrap();
        let features = features(shape, &wavelets, &FeatureParams::default(), Progress::none()).unwrap();
        features.iter().map(|feature| (feature.vertex, feature.level)).collect::<Vec<_>>()
    });
    assert!(!found.is_empty());
    assert_eq!(found, expected);
}

#[test]
fn masks_fits_and_functions_need_no_rows() {
    let (shape, positions) = creature(2000);
    let own = shape.with_operator(row_function(shape.rows("a test").unwrap())).unwrap();
    let schedule = Schedule::dyadic(4).unwrap();
    let mask: Vec<bool> = (0..own.n_vertices()).map(|x| x % 50 < 7).collect();
    let [found, expected] = [&own, &shape].map(|shape| shape.masked(&mask).unwrap());
    assert!((found.operator().step_length() / expected.operator().step_length() - 1.0).abs() < 1e-12);
    let [found, expected] =
        [found, expected].map(|shape| shape.decompose(&positions, 3, &schedule).unwrap().into_vec());
    let known = |values: &[f64]| -> Vec<f64> { values.iter().copied().filter(|v| !v.is_nan()).collect() };
    assert_close(&known(&found), &known(&expected), "masked bands");
    assert!(found.iter().zip(&expected).all(|(a, b)| a.is_nan() == b.is_nan()));
    let [found, expected] = [&own, &shape].map(|shape| {
        let functions = shape.basis_of_vertex(17, &schedule, Progress::none()).unwrap();
        [functions.scaling_function, functions.wavelet].concat()
    });
    assert_close(&found, &expected, "the functions of a vertex");
    // Gradients are fitted over the neighbors, whatever the weights of their steps.
    let slope: Vec<f64> = positions.iter().step_by(3).map(|x| 2.0 * x).collect();
    let [found, stored] = [&own, &shape].map(|shape| {
        let bands = shape.request(&slope, 1, &schedule).local_fit(LocalFit::Linear).bands().unwrap();
        bands.wavelets().flatten().map(|w| w * w).sum::<f64>().sqrt()
    });
    assert!(found < 1.2 * stored && stored < 1.2 * found, "bands of a slope of {found} and {stored}");
    let reason = own.rows("this test").unwrap_err().to_string();
    assert!(reason.starts_with("this test needs the rows of the operator"), "{reason}");
    let short = RowFunction::new(7, |_| []).unwrap();
    assert!(matches!(own.with_operator(short), Err(BandsError::WrongNumber { n_given: 7, .. })));
}

#[test]
fn a_walk_that_is_not_symmetric_takes_powers() {
    let n = 50;
    let drift = RowFunction::new(n, move |x| [((x + 1) % n, 0.25)]).unwrap();
    assert!(!drift.is_reversible());
    let transform = Transform::from_operator(drift, &BandsParams::default()).unwrap();
    let mut signal = vec![0.0; n];
    signal[0] = 1.0;
    let (mut first, mut second) = (vec![0.0; n], vec![0.0; n]);
    let schedule = Schedule::dyadic(2).unwrap();
    let info = transform
        .wavelets_into(&signal, 1, &schedule, &mut [&mut first, &mut second], Progress::none())
        .unwrap();
    assert_eq!(info.engine, Engine::Powers);
    // One step keeps 3/4 of a place and takes 1/4 of the next one.
    assert_eq!((first[0], first[n - 1]), (0.25, -0.25));
    assert_eq!((second[0], second[n - 1], second[n - 2]), (0.1875, -0.125, -0.0625));
    let refused = transform.wavelets_into(
        &signal,
        1,
        &Schedule::real(vec![0.5]).unwrap(),
        &mut [&mut first],
        Progress::none(),
    );
    assert!(matches!(refused, Err(BandsError::NotWhole { .. })));
}

#[test]
fn rows_that_are_no_lazy_walk_are_refused() {
    let error = |row: fn(usize) -> Vec<(usize, f64)>| RowFunction::new(4, row).unwrap_err();
    assert_eq!(error(|_| vec![(0, -0.1)]), DiffusionError::BadEntry { row: 0, column: 0, value: -0.1 });
    assert_eq!(error(|_| vec![(4, 0.1)]), DiffusionError::BadEntry { row: 0, column: 4, value: 0.1 });
    assert!(matches!(error(|_| vec![(0, f64::NAN)]), DiffusionError::BadEntry { .. }));
    assert_eq!(
        error(|x| vec![(0, f64::from(u8::from(x == 2)) * 0.75)]),
        DiffusionError::NotLazy { row: 2, moves: 0.75 }
    );
    let ring = || RowFunction::new(4, |x| [((x + 1) % 4, 0.25), ((x + 3) % 4, 0.25)]).unwrap();
    assert!(ring().with_weights(vec![1.0; 4]).unwrap().is_reversible());
    assert!(!ring().with_weights(vec![1.0, 1.0, 1.0, 2.0]).unwrap().is_reversible());
    assert!(matches!(ring().with_weights(vec![1.0; 3]), Err(DiffusionError::RowCount { .. })));
    assert!(matches!(
        ring().with_weights(vec![1.0, 0.0, 1.0, 1.0]),
        Err(DiffusionError::BadWeight { row: 1, .. })
    ));
}

/// An operator with a given difference, which says that it is reversible.
struct Claim<F>(F);

impl<F> std::fmt::Debug for Claim<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Claim")
    }
}

impl<F: Fn(&[f64], usize) -> f64 + Send + Sync> Operator for Claim<F> {
    fn n_rows(&self) -> usize {
        6
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        _: Progress<'_>,
    ) -> Result<(), Cancelled> {
        for c in 0..n_channels {
            let column: Vec<f64> = x.iter().skip(c).step_by(n_channels).copied().collect();
            for row in 0..6 {
                out[row * n_channels + c] = (self.0)(&column, row);
            }
        }
        Ok(())
    }
}

#[test]
fn operators_that_contradict_themselves_are_refused() {
    fn reason(difference: impl Fn(&[f64], usize) -> f64 + Send + Sync + 'static) -> String {
        Transform::from_operator(Claim(difference), &BandsParams::default()).unwrap_err().to_string()
    }
    assert!(reason(|x, row| x[row]).contains("rows must sum to 1"));
    assert!(reason(|x, row| 0.3 * (x[row] - x[(row + 1) % 6])).contains("not self-adjoint"));
    let far = |x: &[f64], row: usize| 0.9 * (2.0 * x[row] - x[(row + 1) % 6] - x[(row + 5) % 6]);
    assert!(reason(far).contains("eigenvalues outside of [0, 1]"));
    assert!(reason(|_, _| f64::NAN).contains("not finite"));
    let ring = |x: &[f64], row: usize| 0.25 * (2.0 * x[row] - x[(row + 1) % 6] - x[(row + 5) % 6]);
    Transform::from_operator(Claim(ring), &BandsParams::default()).unwrap();
}

#[test]
fn a_stored_operator_that_is_shared_keeps_its_bits() {
    let (_, positions) = creature(2000);
    let sample = Sample::from_name("creature", Some(2000)).unwrap();
    let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let heat = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
    let shared =
        Transform::from_shared_operator(Arc::clone(heat.operator()), &BandsParams::default()).unwrap();
    let map = heat.vertex_map();
    let schedule = Schedule::real(vec![0.5, 2.0, 7.5]).unwrap();
    let bands = heat.decompose(&positions, 3, &schedule).unwrap();
    let again = shared.bands(map, &positions, 3, &schedule, Progress::none()).unwrap();
    assert!(again.as_slice() == bands.as_slice());
}
