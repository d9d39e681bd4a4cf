//! Heat on the surface: the Laplacian, the operator, bands, saliency, the functions of a vertex, filters and masks.

use crate::reference::dense::{Bands, bands, fill, mean_of_welded, minus, norms, weld};
use crate::reference::fast::{Fast, FastBands, Method, SaliencyParams, Weighting, dyadic};
use crate::reference::heat::{Heat, Wrong, heat, laplacian, planar_delaunay};
use crate::reference::shapes::{Case, Noise, Parts, signal, surface_cases};
use crate::reference::{ROUNDING, SEEN, assert_close, assert_same_matrix, difference};

/// The exponential is squared up to some 15 times, which doubles its error each time; the bands are asked for within 1e-13, in
/// the norm that masses weigh.
const BANDS: f64 = 1e-9;
/// The map is of third order in the bands.
const MAP: f64 = 3e-9;
/// Cotangents by angles, against those by lengths.
const WEIGHTS: f64 = 1e-11;

const LEVELS: usize = 6;

fn whole(case: &Case) -> Heat {
    heat(case, &vec![false; weld(&case.parts).first.len()], Wrong::None)
}

fn assert_same_bands(case: &Case, fast: &FastBands, expected: &Bands) {
    for (j, (s, e)) in fast.scaling.iter().zip(&expected.scaling).enumerate() {
        assert_close(s, e, BANDS, &format!("{}, S_f({j})", case.name));
    }
    for (j, (w, e)) in fast.wavelet.iter().zip(&expected.wavelet).enumerate() {
        assert_close(w, e, BANDS, &format!("{}, W_f({})", case.name, j + 1));
    }
}

#[test]
fn weights_are_cotangents_and_masses_thirds_of_areas() {
    for case in surface_cases() {
        let (weights, areas) = Fast::new(&case).laplacian();
        let expected = laplacian(&case);
        assert_same_matrix(&weights, &expected.w, WEIGHTS, case.name);
        assert_close(&areas, &expected.mass, WEIGHTS, case.name);
    }
}

#[test]
fn a_flat_mesh_and_a_cloud_in_a_plane_have_the_weights_of_the_delaunay_triangulation_inside() {
    for case in surface_cases().iter().filter(|case| case.name.starts_with("flat")) {
        let (Parts::Mesh { points, .. } | Parts::Cloud { points }) = &case.parts else { unreachable!() };
        let (weights, areas) = Fast::new(case).laplacian();
        let (expected, triangles) = planar_delaunay(points);
        let (low, high) = (|c| bound(points, c, f64::min), |c| bound(points, c, f64::max));
        let inside = |x: usize| (0..2).all(|c| points[x][c] > low(c) + 2.6 && points[x][c] < high(c) - 2.6);
        let mut n_inside = 0;
        for x in (0..points.len()).filter(|&x| inside(x)) {
            n_inside += 1;
            assert_close(&weights[x], &expected[x], WEIGHTS, case.name);
            // A third of the triangles around, or the Voronoi cell: Σ w·d²/4.
            let distance = |y: usize| crate::reference::dense::distance(points[x], points[y]);
            let cell: f64 = (0..points.len()).map(|y| expected[x][y] * distance(y).powi(2) / 4.0).sum();
            let around = triangles.iter().filter(|t| t.contains(&x));
            let thirds: f64 = around.map(|&[a, b, c]| area(points[a], points[b], points[c]) / 3.0).sum();
            let is_mesh = matches!(case.parts, Parts::Mesh { .. });
            assert_close(&[areas[x]], &[if is_mesh { thirds } else { cell }], WEIGHTS, case.name);
        }
        assert!(n_inside > 20, "{}: {n_inside}", case.name);
    }
}

fn bound(points: &[[f64; 3]], c: usize, of: fn(f64, f64) -> f64) -> f64 {
    points.iter().map(|p| p[c]).reduce(of).unwrap()
}

fn area(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
}

#[test]
fn the_diffusion_has_the_generator_of_heat() {
    for case in surface_cases() {
        let (fast, expected) = (Fast::new(&case), whole(&case));
        let generator: Vec<f64> = fast.heat_generator().concat();
        let expected_rows: Vec<f64> = expected.generator.transpose().as_slice().to_vec();
        assert_close(&generator, &expected_rows, WEIGHTS, case.name);
        assert_close(&fast.stationary(), &expected.stationary, WEIGHTS, case.name);
        assert_close(&[fast.step_length()], &[expected.step_length], WEIGHTS, case.name);
        assert!(fast.is_reversible(), "{}", case.name);
        let welded = weld(&case.parts);
        let share =
            |&c: &usize| expected.areas[c] / welded.class.iter().filter(|&&other| other == c).count() as f64;
        let shares: Vec<f64> = welded.class.iter().map(share).collect();
        assert_close(&fast.areas_of_the_file(), &shares, WEIGHTS, case.name);
    }
}

#[test]
fn bands_are_those_of_the_matrix_exponential_for_whole_and_other_steps() {
    for case in surface_cases() {
        let (fast, welded, heat) = (Fast::new(&case), weld(&case.parts), whole(&case));
        for steps in [dyadic(LEVELS), vec![0.02, 0.5, 0.55, 1.7, 9.3, 9.31, 40.0]] {
            let phi = heat.levels(&steps);
            for n_channels in [1, 3] {
                let f = signal(case.parts.n_vertices(), n_channels, 71 + n_channels as u64);
                let expected = bands(&phi, &welded, &f, n_channels);
                // Heat has no powers: whoever asks for them gets the same.
                for method in [Method::Default, Method::Powers] {
                    let found = fast.bands(&f, n_channels, &steps, method);
                    assert_same_bands(&case, &found, &expected);
                    assert_close(&found.reconstructed, &f, ROUNDING, case.name);
                    let sigma: Vec<f64> =
                        [0.0].iter().chain(&steps).map(|n| heat.step_length * n.sqrt()).collect();
                    assert_close(&found.sigma, &sigma, ROUNDING, case.name);
                }
            }
        }
    }
}

#[test]
fn weighted_sums_and_filters_are_sums_of_the_bands() {
    for case in surface_cases() {
        let (fast, n) = (Fast::new(&case), case.parts.n_vertices());
        let f = signal(n, 2, 5);
        let bands = bands(&whole(&case).levels(&dyadic(LEVELS)), &weld(&case.parts), &f, 2);
        let factors = [0.5, -2.0, 0.0, 1.0, 3.0, -0.25];
        let sum: Vec<f64> =
            (0..f.len()).map(|i| bands.wavelet.iter().zip(factors).map(|(w, a)| a * w[i]).sum()).collect();
        assert_close(&fast.weighted(&f, 2, LEVELS, &factors), &sum, BANDS, case.name);
        let mut noise = Noise::new(9);
        let mut region = || (0..n).map(|_| (1.6 * noise.next() - 0.3).clamp(0.0, 1.0)).collect::<Vec<f64>>();
        let layers = [(vec![0.3, -1.0, 1.0, 2.5, 0.0, 1.0], region()), (vec![0.0; LEVELS], region())];
        for layers in [&layers[..1], &layers] {
            let expected: Vec<f64> = (0..f.len())
                .map(|i| {
                    let gamma = |j: usize| -> f64 {
                        layers.iter().map(|(gains, r)| 1.0 + r[i / 2] * (gains[j] - 1.0)).product()
                    };
                    let edited = |j: usize| gamma(j) * bands.wavelet[j][i];
                    bands.scaling[LEVELS][i] + (0..LEVELS).map(edited).sum::<f64>()
                })
                .collect();
            assert_close(&fast.filter(&f, 2, LEVELS, layers), &expected, BANDS, case.name);
        }
    }
}

#[test]
fn saliency_has_means_by_area() {
    for case in surface_cases() {
        let (fast, welded, heat) = (Fast::new(&case), weld(&case.parts), whole(&case));
        let f = signal(case.parts.n_vertices(), 3, 17);
        let norms = norms(&heat.levels(&dyadic(LEVELS)), &mean_of_welded(&welded, &f, 3), 3);
        let total: f64 = heat.areas.iter().sum();
        for (weighting, by_area) in
            [(Weighting::PerLevel, true), (Weighting::Normalized, true), (Weighting::PerLevel, false)]
        {
            let mut map = vec![0.0; welded.first.len()];
            for w in &norms[1..] {
                let max = w.iter().fold(0.0_f64, |m, &v| m.max(v));
                let mean = if by_area {
                    w.iter().zip(&heat.areas).map(|(w, a)| w * a).sum::<f64>() / total
                } else {
                    w.iter().sum::<f64>() / w.len() as f64
                };
                let alpha = if weighting == Weighting::PerLevel { (max - mean).powi(2) } else { 1.0 / mean };
                map.iter_mut().zip(w).for_each(|(m, w)| *m += alpha * w);
            }
            let map: Vec<f64> = welded.class.iter().map(|&c| map[c]).collect();
            let params = SaliencyParams::paper().with_weighting(weighting).with_skip(1);
            let (found, _) = fast.saliency(&f, 3, LEVELS, &params);
            if by_area {
                assert_close(&found.map, &map, MAP, &format!("{}, {weighting:?}", case.name));
            } else if !matches!(case.parts, Parts::Graph { .. }) && welded.first.len() > 3 {
                let off = difference(&found.map, &map);
                assert!(off > SEEN * MAP, "{}, plain means: {off:.1e}", case.name);
            }
        }
    }
}

#[test]
fn the_functions_of_a_vertex_are_rows_of_the_exponential() {
    for case in surface_cases() {
        let (fast, welded, heat) = (Fast::new(&case), weld(&case.parts), whole(&case));
        let phi = heat.levels(&dyadic(5));
        for vertex in [0, 1, 20, 33, 71] {
            let Some(&class) = welded.class.get(vertex) else { continue };
            let scatter = |row: &[f64]| welded.class.iter().map(|&c| row[c]).collect::<Vec<f64>>();
            for j in [1, 2, 5] {
                let (scaling, wavelet) = fast.functions_of(vertex, j);
                let psi = minus(&phi[j - 1], &phi[j]);
                let what = format!("{}, vertex {vertex}, level {j}", case.name);
                assert_close(&scaling, &scatter(&phi[j][class]), BANDS, &what);
                assert_close(&wavelet, &scatter(&psi[class]), BANDS, &what);
            }
        }
    }
}

#[test]
fn heat_does_not_enter_masked_vertices() {
    for case in surface_cases() {
        let (welded, n) = (weld(&case.parts), case.parts.n_vertices());
        let flags: Vec<bool> = (0..n).map(|x| x % 5 == 2 || x == 6).collect();
        let is_masked: Vec<bool> = (0..welded.first.len())
            .map(|c| welded.class.iter().zip(&flags).all(|(&class, &flag)| class != c || flag))
            .collect();
        let heat = heat(&case, &is_masked, Wrong::None);
        let mut f = signal(n, 2, 8);
        fill(&welded, &flags, &mut f, 2);
        let mut expected = bands(&heat.levels(&dyadic(LEVELS)), &welded, &f, 2);
        for x in (0..n).filter(|&x| flags[x]) {
            f[2 * x..2 * x + 2].fill(f64::NAN);
            for band in expected.scaling.iter_mut().chain(&mut expected.wavelet) {
                band[2 * x..2 * x + 2].fill(f64::NAN);
            }
        }
        let fast = Fast::masked(&case, &flags);
        assert_same_bands(&case, &fast.bands(&f, 2, &dyadic(LEVELS), Method::Default), &expected);
        assert_close(&fast.stationary(), &heat.stationary, WEIGHTS, case.name);
        assert_close(&[fast.step_length()], &[heat.step_length], WEIGHTS, case.name);
        let areas = fast.areas_of_the_file();
        assert!((0..n).all(|x| !is_masked[welded.class[x]] || areas[x] == 0.0), "{}", case.name);
    }
}

#[test]
fn other_times_masses_and_weights_would_be_seen() {
    let mut n_raised = 0;
    for case in surface_cases() {
        let (fast, welded) = (Fast::new(&case), weld(&case.parts));
        let f = signal(case.parts.n_vertices(), 1, 2);
        let found = fast.bands(&f, 1, &dyadic(LEVELS), Method::Default);
        for wrong in [Wrong::NotRaised, Wrong::DoubleTime, Wrong::EqualMass, Wrong::EqualWeights] {
            let is_graph = matches!(case.parts, Parts::Graph { .. });
            if is_graph && wrong == Wrong::EqualMass {
                continue;
            }
            let none = vec![false; welded.first.len()];
            let other = bands(&heat(&case, &none, wrong).levels(&dyadic(LEVELS)), &welded, &f, 1);
            let off = difference(&found.wavelet[3], &other.wavelet[3]);
            if wrong == Wrong::NotRaised && (is_graph || welded.first.len() <= 100) {
                assert!(off <= BANDS, "{}: graphs and so few vertices are not raised, {off:.1e}", case.name);
                continue;
            }
            n_raised += usize::from(wrong == Wrong::NotRaised);
            assert!(off > SEEN * BANDS, "{}, {wrong:?}: only {off:.1e}", case.name);
        }
    }
    assert!(n_raised >= 1);
}
