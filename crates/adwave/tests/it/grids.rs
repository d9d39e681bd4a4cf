//! Grids: heat by its eigenvectors, borders, masks, and what all domains share.

use adwave::bands::{BandsError, BandsParams, Engine, Schedule, Transform};
use adwave::denoise::{DenoiseParams, denoise_signal};
use adwave::features::{FeatureParams, Response, features};
use adwave::grid::{Grid, GridError, GridHeat};
use adwave::operator::{Operator, Semigroup};
use adwave::{Cancelled, Decomposer, Progress};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::f64::consts::{PI, TAU};

fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| f64::from(random.next_u32()) / 4_294_967_296.0 - 0.5).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Steps of heat at once, with the bound of the error.
fn heat(grid: &Grid, n_steps: f64, values: &[f64], accuracy: f64) -> (Vec<f64>, f64) {
    let (operator, mut out) = (grid.heat(), vec![0.0; values.len()]);
    let n_channels = values.len() / grid.n_places();
    let leap = operator.leap().unwrap();
    let error = leap.take_steps(n_steps, values, n_channels, accuracy, &mut out, Progress::none()).unwrap();
    (out, error)
}

fn decomposer(grid: &Grid) -> Decomposer {
    Decomposer::from_domain(grid.clone(), grid.heat()).unwrap()
}

/// Values of a function of the coordinates, which are counted from 0.
fn image(sizes: &[usize], f: impl Fn(&[usize]) -> f64) -> Vec<f64> {
    let n: usize = sizes.iter().product();
    (0..n)
        .map(|mut place| {
            let mut at = vec![0; sizes.len()];
            for axis in (0..sizes.len()).rev() {
                at[axis] = place % sizes[axis];
                place /= sizes[axis];
            }
            f(&at)
        })
        .collect()
}

#[test]
fn waves_are_eigenvectors_at_any_width() {
    let (sizes, spacings, periodic) = ([9, 2, 14], [1.0, 0.7, 2.5], [false, true, true]);
    let grid = Grid::new(&sizes, &spacings).unwrap().with_periodic(&periodic).unwrap();
    let wave = [3, 1, 4];
    let angle =
        |axis: usize| if periodic[axis] { TAU } else { PI } * f64::from(wave[axis]) / sizes[axis] as f64;
    let values = image(&sizes, |at| {
        let along = |axis: usize| angle(axis) * (at[axis] as f64 + if periodic[axis] { 0.0 } else { 0.5 });
        (0..3).map(|axis| along(axis).cos()).product()
    });
    let rate: f64 = (0..3).map(|axis| (2.0 - 2.0 * angle(axis).cos()) / spacings[axis].powi(2)).sum();
    for n_steps in [0.01, 1.0, 7.5, 60.0] {
        let factor = (-0.25 * 0.7_f64.powi(2) * n_steps * rate).exp();
        let wanted: Vec<f64> = values.iter().map(|v| factor * v).collect();
        for (accuracy, bound) in [(1e-6, 7.3e-8), (1e-11, 2e-13)] {
            let (found, error) = heat(&grid, n_steps, &values, accuracy);
            let off = largest_difference(&found, &wanted);
            assert!(error <= bound && off <= error, "{n_steps} steps to {accuracy:e}: {off:e} of {error:e}");
        }
        if n_steps < 1.0 {
            continue; // no level
        }
        // The series from the stencil gives the same.
        let [by_leaps, by_series] = [Engine::Leaps, Engine::Chebyshev].map(|engine| {
            let params = BandsParams::default().with_engine(engine);
            let schedule = Schedule::real(vec![n_steps]).unwrap();
            decomposer(&grid)
                .request(&values, 1, &schedule)
                .params(&params)
                .bands()
                .unwrap()
                .coarsest()
                .to_vec()
        });
        assert!(
            largest_difference(&by_leaps, &wanted) < 1e-10 && largest_difference(&by_series, &wanted) < 1e-10
        );
    }
}

#[test]
fn the_bound_holds_for_any_number_of_steps() {
    let n = 600;
    let values = noise(n, 19);
    let angle = |k: usize| PI * k as f64 / n as f64;
    for periodic in [false, true] {
        let grid = Grid::new(&[n], &[1.0]).unwrap().with_periodic(&[periodic]).unwrap();
        // The coefficients of the eigenvectors, by their definition; angles in whole parts of a turn, so that the waves are
        // exact to rounding.
        let phase = |parts: usize| PI * (parts % (4 * n)) as f64 / (2 * n) as f64;
        let wave = |k: usize, i: usize| match (periodic, k % 2) {
            (false, _) => phase(k * (2 * i + 1)).cos(),
            (true, 1) if k + 1 == n => phase(2 * n * i).cos(),
            (true, 0) => phase(2 * k * i).cos(),
            (true, _) => phase(2 * (k + 1) * i).sin(),
        };
        let frequency = |k: usize| angle(if periodic && k % 2 == 1 { k + 1 } else { k });
        let spectrum: Vec<(f64, f64)> = (0..n)
            .map(|k| {
                let square: f64 = (0..n).map(|i| wave(k, i).powi(2)).sum();
                let product: f64 = (0..n).map(|i| wave(k, i) * values[i]).sum();
                (frequency(k), product / square)
            })
            .collect();
        for n_steps in [0.01, 0.1, 0.5, 1.0, 3.0, 10.0, 100.0, 1e3, 1e5, 1e8, 1e12] {
            let part = |i: usize| {
                let term = |(k, (a, c)): (usize, &(f64, f64))| {
                    c * (-0.25 * n_steps * (2.0 - 2.0 * a.cos())).exp() * wave(k, i)
                };
                spectrum.iter().enumerate().map(term).sum::<f64>()
            };
            let wanted: Vec<f64> = (0..n).map(part).collect();
            let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
            for accuracy in [1e-6, 1e-11] {
                let (found, error) = heat(&grid, n_steps, &values, accuracy);
                let off = norm(&mut found.iter().zip(&wanted).map(|(a, b)| a - b));
                let off = off / norm(&mut values.iter().copied());
                assert!(off <= error, "{n_steps:e} steps: {off:e} of {error:e}");
            }
        }
    }
}

#[test]
fn the_bound_holds_on_lines_of_any_length() {
    for n in [2, 3, 4, 5, 7, 11, 40, 250] {
        let grid = Grid::new(&[n], &[1.0]).unwrap();
        let cosine = |k: usize, i: usize| {
            (PI * (k * (2 * i + 1) % (4 * n)) as f64 / (2 * n) as f64).cos()
                * (if k == 0 { 1.0 } else { 2.0 } / n as f64).sqrt()
        };
        let basis: Vec<f64> = (0..n * n).map(|at| cosine(at / n, at % n)).collect();
        for (case, exponent) in (-4..16).enumerate() {
            let n_steps = 4.0 * 10.0_f64.powf(f64::from(exponent) / 2.0);
            let values = noise(n, case as u64);
            let part = |k: usize| -> f64 {
                let rate = 2.0 - 2.0 * (PI * k as f64 / n as f64).cos();
                let product: f64 = (0..n).map(|i| basis[k * n + i] * values[i]).sum();
                (-0.25 * n_steps * rate).exp() * product
            };
            let parts: Vec<f64> = (0..n).map(part).collect();
            let wanted = |i: usize| (0..n).map(|k| parts[k] * basis[k * n + i]).sum::<f64>();
            let size = values.iter().map(|v| v * v).sum::<f64>().sqrt();
            for accuracy in [1e-6, 1e-13] {
                let (found, error) = heat(&grid, n_steps, &values, accuracy);
                let off = (0..n).map(|i| (found[i] - wanted(i)).powi(2)).sum::<f64>().sqrt() / size;
                assert!(off <= error, "{n} places, {n_steps} steps to {accuracy:e}: {off:e} of {error:e}");
            }
        }
    }
}

#[test]
fn a_spot_spreads_by_its_variance_and_keeps_its_sum_and_sign() {
    let (size, spacing) = ([41, 61], [1.5, 1.0]);
    let grid = Grid::new(&size, &spacing).unwrap();
    let spot = image(&size, |at| f64::from(at == [20, 30]));
    for n_steps in [0.5, 4.0, 20.0] {
        let (found, _) = heat(&grid, n_steps, &spot, 1e-11);
        let total: f64 = found.iter().sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
        let lowest = found.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(lowest > -1e-12, "{lowest:e}");
        for axis in 0..2 {
            let square = image(&size, |at| ((at[axis] as f64 - [20.0, 30.0][axis]) * spacing[axis]).powi(2));
            let variance: f64 = found.iter().zip(&square).map(|(f, d)| f * d).sum();
            assert!((variance - 0.5 * n_steps).abs() < 1e-8, "{variance} after {n_steps} steps along {axis}");
        }
    }
}

#[test]
fn constants_stay_and_steps_add_up_whatever_the_axes() {
    for sizes in [vec![37], vec![1, 19], vec![8, 9], vec![5, 1, 7], vec![4, 9, 3]] {
        for periodic in [false, true] {
            let spacings = vec![0.3; sizes.len()];
            let flags = vec![periodic; sizes.len()];
            let grid = Grid::new(&sizes, &spacings).unwrap().with_periodic(&flags).unwrap();
            let n = grid.n_places();
            let (constant, _) = heat(&grid, 9.0, &vec![0.1; n], 1e-11);
            assert!(constant.iter().all(|v| *v == 0.1), "{sizes:?}");
            let values = noise(2 * n, 3);
            let (first, _) = heat(&grid, 2.5, &values, 1e-11);
            let (second, _) = heat(&grid, 4.0, &first, 1e-11);
            let (both, _) = heat(&grid, 6.5, &values, 1e-11);
            assert!(largest_difference(&second, &both) < 1e-11, "{sizes:?}");
        }
    }
}

#[test]
fn the_order_of_the_axes_changes_nothing() {
    let (rows, columns) = (23, 31);
    let values = noise(rows * columns, 5);
    let turned: Vec<f64> = (0..rows * columns).map(|i| values[i % rows * columns + i / rows]).collect();
    let schedule = Schedule::dyadic(6).unwrap();
    let bands = |sizes: [usize; 2], spacings: [f64; 2], values: &[f64]| {
        let grid = Grid::new(&sizes, &spacings).unwrap();
        decomposer(&grid).decompose(values, 1, &schedule).unwrap()
    };
    let (a, b) = (bands([rows, columns], [1.0, 2.0], &values), bands([columns, rows], [2.0, 1.0], &turned));
    for (a, b) in a.wavelets().zip(b.wavelets()) {
        let back: Vec<f64> = (0..rows * columns).map(|i| b[i % columns * rows + i / columns]).collect();
        assert!(largest_difference(a, &back) < 1e-11);
    }
}

#[test]
fn nothing_crosses_a_mask_and_a_full_one_changes_nothing() {
    let sizes = [12, 10, 11];
    let schedule = Schedule::dyadic(8).unwrap();
    let whole = Grid::new(&sizes, &[1.0; 3]).unwrap();
    let values = noise(whole.n_places(), 7);
    let kept = vec![true; values.len()];
    let full = decomposer(&whole.clone().with_kept(kept).unwrap()).decompose(&values, 1, &schedule).unwrap();
    let none = decomposer(&whole).decompose(&values, 1, &schedule).unwrap();
    assert!(full.into_vec() == none.into_vec());
    // Two chambers behind a wall: the values of one do not depend on those of the other, and each keeps its mean.
    let kept: Vec<bool> = image(&sizes, |at| f64::from(at[1] != 4)).iter().map(|v| *v == 1.0).collect();
    let walled = decomposer(&whole.with_kept(kept.clone()).unwrap());
    let is_left: Vec<bool> = image(&sizes, |at| f64::from(at[1] < 4)).iter().map(|v| *v == 1.0).collect();
    let other: Vec<f64> =
        values.iter().zip(&is_left).map(|(v, left)| if *left { *v } else { 50.0 }).collect();
    let [a, b] = [&values, &other].map(|values| walled.decompose(values, 1, &schedule).unwrap());
    let sum = |values: &[f64]| {
        values.iter().zip(&is_left).map(|(v, left)| if *left { *v } else { 0.0 }).sum::<f64>()
    };
    assert!((sum(a.coarsest()) - sum(&values)).abs() < 1e-9);
    for (x, (a, b)) in a.coarsest().iter().zip(b.coarsest()).enumerate() {
        match (kept[x], is_left[x]) {
            (false, _) => assert!(*b == other[x], "a place without data keeps its value"),
            (true, true) => assert!((a - b).abs() < 1e-8, "{a} became {b} at {x}"),
            (true, false) => assert!((b - 50.0).abs() < 1e-9),
        }
    }
    // Left out of the request instead of the grid, places are as if they had no data.
    let masked: Vec<bool> = kept.iter().map(|kept| !kept).collect();
    let open = Decomposer::from_domain(
        Grid::new(&sizes, &[1.0; 3]).unwrap(),
        Grid::new(&sizes, &[1.0; 3]).unwrap().heat(),
    );
    let c = open.unwrap().masked(&masked).unwrap().decompose(&values, 1, &schedule).unwrap();
    assert!(largest_difference(a.coarsest(), c.coarsest()) < 1e-9);
}

#[test]
fn weak_coarse_bands_are_computed_by_finer_leaps() {
    // The errors of the fewest poles, relative to the fast wave, are larger than 1e-4 of the slow one.
    let sizes = [96, 80];
    let grid = Grid::new(&sizes, &[1.0; 2]).unwrap();
    let values = image(&sizes, |at| {
        let wave = |k: f64| (PI * k * (at[0] as f64 + 0.5) / sizes[0] as f64).cos();
        wave(60.0) + 1e-4 * wave(1.0)
    });
    let schedule = Schedule::dyadic(12).unwrap();
    let accuracy = 1e-4;
    let request = decomposer(&grid);
    let bands = request.request(&values, 1, &schedule).accuracy(accuracy).bands().unwrap();
    assert_eq!(bands.info.engine, Engine::Leaps);
    assert!(bands.info.error_bound <= accuracy);
    let series = BandsParams::default().with_engine(Engine::Chebyshev);
    let exact = request.request(&values, 1, &schedule).params(&series).bands().unwrap();
    for (a, b) in bands.wavelets().zip(exact.wavelets()) {
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
        let off = norm(&mut a.iter().zip(b).map(|(a, b)| a - b));
        assert!(off <= accuracy * norm(&mut b.iter().copied()), "{off:e}");
    }
}

/// Heat on a grid by its products alone.
#[derive(Debug)]
struct Products(GridHeat);

impl Operator for Products {
    fn n_rows(&self) -> usize {
        self.0.n_rows()
    }

    fn is_reversible(&self) -> bool {
        true
    }

    fn semigroup(&self) -> Semigroup {
        self.0.semigroup()
    }

    fn difference(
        &self,
        x: &[f64],
        n_channels: usize,
        out: &mut [f64],
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        self.0.difference(x, n_channels, out, progress)
    }
}

#[test]
fn steps_between_places_with_data_are_second_differences() {
    let cases: [(&[usize], &[f64], &[bool]); 6] = [
        (&[2500], &[1.0], &[true]),
        (&[7, 1100], &[1.0, 2.0], &[false, false]),
        (&[2, 9], &[1.0, 0.5], &[true, true]),
        (&[6, 5, 8], &[2.0, 1.0, 3.0], &[true, false, true]),
        (&[5, 2, 2], &[1.0, 1.0, 1.5], &[true, true, true]),
        (&[4, 1, 3], &[1.0, 0.1, 1.0], &[false, true, false]),
    ];
    for (sizes, spacings, periodic) in cases {
        let whole = Grid::new(sizes, spacings).unwrap().with_periodic(periodic).unwrap();
        let n = whole.n_places();
        let kept: Vec<bool> = noise(n, 3).iter().map(|v| *v > -0.2).collect();
        for (kept, grid) in [(vec![true; n], whole.clone()), (kept.clone(), whole.with_kept(kept).unwrap())] {
            let (n_channels, heat) = (11, grid.heat());
            let values = noise(n * n_channels, 5);
            let at = |mut place: usize| {
                let mut at = vec![0; sizes.len()];
                for axis in (0..sizes.len()).rev() {
                    at[axis] = place % sizes[axis];
                    place /= sizes[axis];
                }
                at
            };
            let long = |axis: &usize| sizes[*axis] > 1;
            let all: f64 = (0..sizes.len()).filter(long).map(|axis| 4.0 / spacings[axis].powi(2)).sum();
            let mut wanted = vec![0.0; values.len()];
            for x in (0..n).filter(|&x| kept[x]) {
                for axis in (0..sizes.len()).filter(long) {
                    for step in [1, sizes[axis] - 1] {
                        let mut other = at(x);
                        other[axis] += step;
                        let is_beyond = if step == 1 { other[axis] == sizes[axis] } else { at(x)[axis] == 0 };
                        if is_beyond && !periodic[axis] {
                            continue;
                        }
                        other[axis] %= sizes[axis];
                        let y = other.iter().zip(sizes).fold(0, |y, (at, size)| y * size + at);
                        if kept[y] {
                            for c in 0..n_channels {
                                let [here, there] = [x, y].map(|place| values[place * n_channels + c]);
                                wanted[x * n_channels + c] += (here - there) / spacings[axis].powi(2) / all;
                            }
                        }
                    }
                }
            }
            let mut found = vec![1.0; values.len()];
            heat.difference(&values, n_channels, &mut found, Progress::none()).unwrap();
            assert!(largest_difference(&found, &wanted) < 1e-14, "{sizes:?}");
            // The recurrence of the grid and that of its products.
            let params = BandsParams::default().with_engine(Engine::Chebyshev);
            let schedule = Schedule::real(vec![0.3, 2.0, 40.0]).unwrap();
            let bands = |transform: &Transform| {
                let mut bands = vec![vec![7.0; values.len()]; 3];
                let mut outs: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
                let info =
                    transform.wavelets_into(&values, n_channels, &schedule, &mut outs, Progress::none());
                (bands.concat(), info.unwrap().degree)
            };
            let (own, degree) = bands(&Transform::from_operator(heat.clone(), &params).unwrap());
            let (by_products, same) = bands(&Transform::from_operator(Products(heat), &params).unwrap());
            assert!(largest_difference(&own, &by_products) < 1e-12 && degree == same, "{sizes:?}");
        }
    }
}

#[test]
fn blobs_are_features_and_noise_is_removed() {
    // Blobs of two widths in an image and in a volume.
    let blob = |at: &[usize], center: &[f64], width: f64| {
        let square: f64 = at.iter().zip(center).map(|(a, c)| (*a as f64 - c).powi(2)).sum();
        (-square / (2.0 * width * width)).exp()
    };
    for sizes in [vec![60, 70], vec![36, 30, 33]] {
        let centers = [vec![15.0; sizes.len()], sizes.iter().map(|n| *n as f64 - 14.0).collect()];
        let widths = [2.0, 3.5];
        let values = image(&sizes, |at| blob(at, &centers[0], widths[0]) - blob(at, &centers[1], widths[1]));
        let decomposer = decomposer(&Grid::new(&sizes, &vec![1.0; sizes.len()]).unwrap());
        let lengths: Vec<f64> = (0..9).map(|j| 1.5 * (f64::from(j) / 2.0).exp2()).collect();
        let schedule = Schedule::lengths(&lengths, decomposer.operator().step_length()).unwrap();
        let bands = decomposer.request(&values, 1, &schedule).wavelets().unwrap();
        let params = FeatureParams::default().with_response(Response::Literal).with_best(2);
        let found = features(&decomposer, &bands, &params, Progress::none()).unwrap();
        for (center, sign) in centers.iter().zip([1.0, -1.0]) {
            let is_there = |p: [f64; 3]| center.iter().zip(p).all(|(c, p)| (c - p).abs() < 1.1);
            let at = found.iter().find(|f| is_there(f.position.unwrap())).expect("a feature at each blob");
            assert_eq!(at.response.signum(), sign);
        }
    }
    let sizes = [64, 64];
    let truth = image(&sizes, |at| (at[0] as f64 / 9.0).sin() * (at[1] as f64 / 7.0).cos());
    let noisy: Vec<f64> = truth.iter().zip(noise(truth.len(), 11)).map(|(v, e)| v + e).collect();
    let decomposer = decomposer(&Grid::new(&sizes, &[1.0; 2]).unwrap());
    let clean =
        denoise_signal(&decomposer, &noisy, 1, &DenoiseParams::default(), Progress::none()).unwrap().values;
    let error = |values: &[f64]| {
        let sum: f64 = values.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        (sum / truth.len() as f64).sqrt()
    };
    assert!(error(&clean) < 0.35 * error(&noisy), "{} of {}", error(&clean), error(&noisy));
}

#[test]
fn grids_that_cannot_be_are_refused() {
    let sizes = |sizes: &[usize]| Grid::new(sizes, &vec![1.0; sizes.len()]);
    assert!(matches!(sizes(&[]), Err(GridError::Axes { .. })));
    assert!(matches!(sizes(&[2; 4]), Err(GridError::Axes { .. })));
    assert!(matches!(sizes(&[3, 0]), Err(GridError::Sizes { .. })));
    assert!(matches!(sizes(&[1 << 40, 1 << 40]), Err(GridError::Sizes { .. })));
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        assert!(matches!(Grid::new(&[4, 4], &[1.0, spacing]), Err(GridError::Spacing { axis: 1, .. })));
    }
    let grid = sizes(&[3, 3]).unwrap();
    assert!(matches!(grid.clone().with_periodic(&[true]), Err(GridError::Axes { .. })));
    assert!(matches!(grid.clone().with_kept(vec![true; 8]), Err(GridError::Mask { .. })));
    assert!(matches!(grid.clone().with_kept(vec![false; 9]), Err(GridError::Mask { .. })));
    // A single place has no differences.
    let point = decomposer(&sizes(&[1, 1]).unwrap());
    assert_eq!(point.decompose(&[4.0], 1, &Schedule::dyadic(2).unwrap()).unwrap().coarsest(), [4.0]);
}

#[test]
fn bands_one_after_another_are_those_of_the_whole_call() {
    let sizes = [9, 11, 7];
    let n: usize = sizes.iter().product();
    let even = Grid::new(&sizes, &[1.0, 2.0, 1.0]).unwrap();
    let kept: Vec<bool> = (0..n).map(|i| i % 5 != 0).collect();
    let holes = Grid::new(&sizes, &[1.0; 3]).unwrap().with_kept(kept).unwrap();
    let rough = noise(2 * n, 8);
    // Coarse bands of a smooth signal are so small that the leaps are repeated, or replaced by series.
    let smooth: Vec<f64> = (0..2 * n).map(|i| ((i / 2 % 7) as f64 * 0.3).cos() + 1e4).collect();
    let schedule = Schedule::real(vec![1.0, 4.5, 300.0]).unwrap();
    for (grid, signal) in [(&even, &rough), (&even, &smooth), (&holes, &rough)] {
        let decomposer = decomposer(grid);
        for accuracy in [1e-3, 1e-10] {
            let params = BandsParams::default().with_accuracy(accuracy);
            let request = decomposer.request(signal, 2, &schedule).params(&params);
            let whole = request.bands().unwrap();
            let mut found = vec![Vec::new(); 4];
            let info = request.visit_bands(|level, band| {
                found[level] = band.to_vec();
                band.fill(f64::NAN); // it may be changed
                Ok::<(), BandsError>(())
            });
            assert_eq!(info.unwrap().error_bound, whole.info.error_bound);
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert!(bits(&found.concat()) == bits(whole.as_slice()), "{accuracy}");
            let mut levels = Vec::new();
            let ended = request.visit_bands(|level, _| {
                levels.push(level);
                if level == 1 { Err(BandsError::Cancelled(Cancelled)) } else { Ok(()) }
            });
            assert!(matches!(ended, Err(BandsError::Cancelled(_))) && levels == [0, 1], "{levels:?}");
        }
    }
}
