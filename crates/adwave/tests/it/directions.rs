//! Laws of tangent vectors, lines and crosses on surfaces.

use crate::common::{octahedral_sphere, plane};
use adwave::bands::Schedule;
use adwave::denoise::{DenoiseError, DenoiseParams, NoiseModel, denoise_series, denoise_signal};
use adwave::directions::{Directions, DirectionsError, Symmetry};
use adwave::operator::{OperatorKind, OperatorParams, Semigroup};
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, PointCloud, Polygons, Shape, WeldMode};
use adwave::time::TimeAxis;
use adwave::{Decomposer, Progress};
use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};

fn prepare(shape: &Shape, kind: OperatorKind) -> Decomposer {
    let params = OperatorParams::default().with_kind(kind);
    Decomposer::with_params(shape, &params, Progress::none()).unwrap()
}

fn directions(shape: &Shape, symmetry: Symmetry) -> Directions {
    Directions::new(&prepare(shape, OperatorKind::Surface), symmetry, Progress::none()).unwrap()
}

fn sample(name: &str, n: usize) -> Shape {
    let sample = Sample::from_name(name, Some(n)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

fn cloud(shape: &Shape) -> Shape {
    Shape::Cloud(PointCloud::new(shape.points().unwrap().to_vec()).unwrap())
}

/// A field that varies over the shape, n × 2.
fn varied(n: usize) -> Vec<f64> {
    (0..2 * n).map(|i| ((i * 7919) % 1013) as f64 / 1013.0 - 0.5).collect()
}

#[test]
fn a_plane_keeps_constant_directions_to_the_last_bit() {
    let (points, faces) = plane(24);
    let n = points.len();
    let mesh = Shape::Mesh(Mesh::new(points, faces).unwrap());
    for shape in [mesh.clone(), cloud(&mesh)] {
        for kind in [OperatorKind::Surface, OperatorKind::Walk] {
            for symmetry in Symmetry::ALL.iter().copied() {
                let directions = Directions::new(&prepare(&shape, kind), symmetry, Progress::none()).unwrap();
                let constant: Vec<f64> = [0.3, -0.7, 0.0].repeat(n);
                let split = directions.split(&constant).unwrap();
                assert_eq!(split.normal_share, 0.0);
                let bands =
                    directions.decomposer().decompose(&split.channels, 2, &Schedule::dyadic(5).unwrap());
                let bands = bands.unwrap();
                for level in 1..=5 {
                    assert!(bands.wavelet(level).iter().all(|w| *w == 0.0), "{kind:?} {symmetry:?} {level}");
                }
                let back = directions.join(bands.coarsest()).unwrap();
                let turns = f64::from(symmetry.order());
                for v in back.as_chunks::<3>().0 {
                    // The same direction, up to the turns that do not count.
                    let turned = (v[1].atan2(v[0]) - (-0.7_f64).atan2(0.3)) * turns / TAU;
                    assert!((turned - turned.round()).abs() < 1e-12 && v[2] == 0.0);
                    assert!((v[0].hypot(v[1]) - 0.3_f64.hypot(0.7)).abs() < 1e-12);
                }
            }
        }
    }
}

/// Smallest eigenvalues of the connection Laplacian, each a complex number's, by iterations of a block of vectors under
/// heat.
fn eigenvalues(directions: &Directions, n_values: usize) -> Vec<f64> {
    let decomposer = directions.decomposer();
    let (operator, n) = (decomposer.operator(), decomposer.n_places());
    let Semigroup::Heat { rate, .. } = operator.semigroup() else { panic!("heat") };
    let mean_area = 4.0 * PI / n as f64;
    let per_time = rate / (mean_area / (4.0 * 3.0_f64.sqrt()));
    let n_vectors = 2 * n_values + 24;
    let weights: Vec<f64> = (0..n).map(|x| operator.weights().weight(x, n)).collect();
    let mut block =
        DMatrix::from_fn(2 * n, n_vectors, |i, j| (((i * 7919 + j * 104_729) % 1013) as f64).sin());
    let scaled = |block: &DMatrix<f64>, power: f64| {
        DMatrix::from_fn(2 * n, n_vectors, |i, j| block[(i, j)] * weights[i / 2].powf(power))
    };
    let orthonormal = |block: &DMatrix<f64>| scaled(&scaled(block, 0.5).qr().q(), -0.5);
    let schedule = Schedule::real(vec![0.12 / (mean_area / (4.0 * 3.0_f64.sqrt()))]).unwrap();
    for _ in 0..12 {
        block = orthonormal(&block);
        for j in 0..n_vectors {
            let column = block.column(j).as_slice().to_vec();
            let smooth = decomposer.decompose(&column, 2, &schedule).unwrap();
            block.column_mut(j).copy_from_slice(smooth.coarsest());
        }
    }
    block = orthonormal(&block);
    let mut product = block.clone();
    for j in 0..n_vectors {
        // In the order of the shape on both sides, as the numbering of the places may differ.
        let welded = decomposer.vertex_map().mean(block.column(j).as_slice(), 2);
        let mut out = vec![0.0; 2 * n];
        operator.difference(&welded, 2, &mut out, Progress::none()).unwrap();
        product.column_mut(j).copy_from_slice(&decomposer.vertex_map().scatter(&out, 2));
    }
    let shared = decomposer.vertex_map().scatter(&weights, 1);
    let weighted = DMatrix::from_fn(2 * n, n_vectors, |i, j| product[(i, j)] * shared[i / 2]);
    let norms = DMatrix::from_fn(2 * n, n_vectors, |i, j| block[(i, j)] * shared[i / 2]);
    let (left, right) = (block.transpose() * weighted, block.transpose() * norms);
    let factor = right.cholesky().unwrap().l().try_inverse().unwrap();
    let mut values: Vec<f64> =
        (&factor * left * factor.transpose()).symmetric_eigenvalues().iter().map(|v| v * per_time).collect();
    values.sort_by(f64::total_cmp);
    values.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).take(n_values).collect()
}

/// The eigenvalues l(l+1) − s² of a sphere, l ≥ s, each 2l + 1 times.
fn expected(symmetry: Symmetry, n_values: usize) -> Vec<f64> {
    let s = symmetry.order() as usize;
    (s..).flat_map(|l| std::iter::repeat_n((l * (l + 1) - s * s) as f64, 2 * l + 1)).take(n_values).collect()
}

#[test]
fn the_sphere_has_its_eigenvalues() {
    let worst = |shape: &Shape, symmetry: Symmetry, n_values: usize| {
        let found = eigenvalues(&directions(shape, symmetry), n_values);
        let off = |(found, expected): (&f64, f64)| (found - expected).abs() / expected;
        found.iter().zip(expected(symmetry, n_values)).map(off).fold(0.0, f64::max)
    };
    for symmetry in Symmetry::ALL.iter().copied() {
        let (coarse, fine) = (octahedral_sphere(3), octahedral_sphere(4));
        for (coarse, fine, allowed) in [(&coarse, &fine, 0.03), (&cloud(&coarse), &cloud(&fine), 0.04)] {
            let [coarse, fine] = [coarse, fine].map(|shape| worst(shape, symmetry, 16));
            assert!(fine < allowed && fine < 0.3 * coarse, "{symmetry:?}: {fine} after {coarse}");
        }
    }
}

#[test]
fn lengths_never_grow_beyond_those_that_scalars_have() {
    for shape in [sample("creature", 2000), cloud(&sample("creature", 2000)), sample("bracket", 2000)] {
        let scalars = prepare(&shape, OperatorKind::Surface);
        for symmetry in Symmetry::ALL.iter().copied() {
            let directions = Directions::new(&scalars, symmetry, Progress::none()).unwrap();
            let (operator, n) = (directions.decomposer().operator(), scalars.n_places());
            let field = varied(n);
            let lengths: Vec<f64> = field.as_chunks::<2>().0.iter().map(|z| z[0].hypot(z[1])).collect();
            let (mut turned, mut straight) = (vec![0.0; 2 * n], vec![0.0; n]);
            operator.multiply(&field, 2, &mut turned, Progress::none()).unwrap();
            scalars.operator().multiply(&lengths, 1, &mut straight, Progress::none()).unwrap();
            for (z, length) in turned.as_chunks::<2>().0.iter().zip(straight) {
                assert!(z[0].hypot(z[1]) <= length * (1.0 + 1e-12) + 1e-15);
            }
        }
    }
}

/// Two bands of a sphere that touch at one vertex, with their normals on opposite sides there.
fn touching_cones() -> Shape {
    let ring =
        |z: f64| (0..12).map(move |i| (TAU * f64::from(i) / 12.0, z)).map(|(a, z)| [a.cos(), a.sin(), z]);
    let points: Vec<[f64; 3]> = [[0.0; 3]].into_iter().chain(ring(0.1)).chain(ring(-0.1)).collect();
    let fan = |first: u32| (0..12).map(move |i| [0, first + i, first + (i + 1) % 12]);
    let triangles: Vec<[u32; 3]> = fan(1).chain(fan(13).map(|[a, b, c]| [a, c, b])).collect();
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap())
}

#[test]
fn the_operator_is_self_adjoint_on_any_surface() {
    for shape in [sample("bracket", 1000), cloud(&sample("creature", 2000)), moebius(40, 1), touching_cones()]
    {
        for kind in [OperatorKind::Surface, OperatorKind::Walk] {
            for symmetry in Symmetry::ALL.iter().copied() {
                let directions = Directions::new(&prepare(&shape, kind), symmetry, Progress::none()).unwrap();
                let (operator, n) = (directions.decomposer().operator(), directions.decomposer().n_places());
                if !operator.is_reversible() {
                    continue;
                }
                let (u, v) = (varied(n), varied(n + 7)[14..].to_vec());
                let product = |a: &[f64], b: &[f64]| {
                    let mut out = vec![0.0; 2 * n];
                    operator.multiply(a, 2, &mut out, Progress::none()).unwrap();
                    (0..2 * n).map(|i| operator.weights().weight(i / 2, n) * out[i] * b[i]).sum::<f64>()
                };
                let (there, back) = (product(&u, &v), product(&v, &u));
                assert!((there - back).abs() < 1e-12, "{kind:?} {symmetry:?}: {there} {back}");
            }
        }
    }
}

#[test]
fn turning_the_shape_turns_the_result() {
    let turn = |v: &[f64; 3]| {
        let (s, c) = 0.7_f64.sin_cos();
        let [x, y, z] = [v[0], c * v[1] - s * v[2], s * v[1] + c * v[2]];
        [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y, z]
    };
    let shape = sample("creature", 2000);
    let mesh = shape.as_mesh().unwrap();
    let turned: Vec<[f64; 3]> = mesh.points().iter().map(turn).collect();
    let turned = Shape::Mesh(Mesh::new(turned, mesh.faces().clone()).unwrap());
    let field: Vec<[f64; 3]> = mesh.points().iter().map(|p| [p[1] + 0.3, p[2] - p[0], p[0] * p[1]]).collect();
    let turned_field: Vec<[f64; 3]> = field.iter().map(turn).collect();
    let smooth = |shape: &Shape, field: &[[f64; 3]]| {
        let directions = directions(shape, Symmetry::Vectors);
        let split = directions.split(field.as_flattened()).unwrap();
        let schedule = Schedule::dyadic(5).unwrap();
        let bands = directions.decomposer().decompose(&split.channels, 2, &schedule).unwrap();
        directions.join(bands.coarsest()).unwrap()
    };
    let (one, other) = (smooth(&shape, &field), smooth(&turned, &turned_field));
    for (v, w) in one.as_chunks::<3>().0.iter().map(turn).zip(other.as_chunks::<3>().0) {
        assert!((0..3).all(|c| (v[c] - w[c]).abs() < 1e-9), "{v:?} {w:?}");
    }
}

#[test]
fn indices_sum_to_the_euler_characteristic() {
    for (name, characteristic) in
        [("sphere", 2.0), ("torus", 0.0), ("creature", 2.0), ("knot", 0.0), ("bracket", 0.0)]
    {
        let shape = sample(name, 2000);
        for symmetry in Symmetry::ALL.iter().copied() {
            let directions = directions(&shape, symmetry);
            let mut field = varied(directions.decomposer().n_vertices());
            for smoothing in 0..2 {
                let found = directions.singularities(&field, Progress::none()).unwrap();
                let sum: f64 = found.iter().map(|singularity| singularity.index).sum();
                assert_eq!(sum, characteristic, "{name} {symmetry:?} {smoothing}");
                let s = f64::from(symmetry.order());
                assert!(found.iter().all(|f| (f.index * s).fract() == 0.0));
                let bands = directions.decomposer().decompose(&field, 2, &Schedule::dyadic(7).unwrap());
                field = bands.unwrap().coarsest().to_vec();
            }
        }
    }
    // Rotation about an axis turns once around each of two poles.
    let shape = sample("sphere", 3000);
    let directions = directions(&shape, Symmetry::Vectors);
    let field: Vec<f64> = shape.points().unwrap().iter().flat_map(|p| [-p[1], p[0], 0.0]).collect();
    let found =
        directions.singularities(&directions.split(&field).unwrap().channels, Progress::none()).unwrap();
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|f| f.index == 1.0 && f.center[2].abs() > 0.99), "{found:?}");
}

/// A band of squares that is turned over once around a circle of `n` squares, which is walked `rounds` times: its ends are
/// joined with their sides exchanged after an odd number.
fn moebius(n: u32, rounds: u32) -> Shape {
    let point = |i: u32, j: u32| {
        let angle = TAU * f64::from(i) / f64::from(n);
        let (t, across) = (angle / 2.0, 0.1 * (f64::from(j) - 2.0));
        let radius = 1.0 + across * t.cos();
        [radius * angle.cos(), radius * angle.sin(), across * t.sin()]
    };
    let n_all = n * rounds;
    let points: Vec<[f64; 3]> = (0..n_all).flat_map(|i| (0..5).map(move |j| point(i, j))).collect();
    let at = |i: u32, j: u32| {
        if i < n_all {
            5 * i + j
        } else if rounds == 1 {
            4 - j
        } else {
            j
        }
    };
    let quads = (0..n_all)
        .flat_map(|i| (0..4).map(move |j| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
    let triangles: Vec<[u32; 3]> = quads.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).unwrap())
}

#[test]
fn a_surface_with_one_side_carries_vectors_as_its_cover_with_two() {
    let smooth = |rounds: u32| {
        let shape = moebius(120, rounds);
        let params = OperatorParams::default().with_kind(OperatorKind::Surface).with_weld(WeldMode::Off);
        let decomposer = Decomposer::with_params(&shape, &params, Progress::none()).unwrap();
        let directions = Directions::new(&decomposer, Symmetry::Vectors, Progress::none()).unwrap();
        let field: Vec<f64> =
            shape.points().unwrap().iter().flat_map(|p| [-p[1] + p[2], p[0], 1.0 + p[0]]).collect();
        let split = directions.split(&field).unwrap();
        let schedule = Schedule::real(vec![60.0]).unwrap();
        let bands = directions.decomposer().decompose(&split.channels, 2, &schedule).unwrap();
        let refused = directions.singularities(&split.channels, Progress::none());
        assert_eq!(refused.is_err(), rounds == 1);
        (directions.join(bands.coarsest()).unwrap(), directions.join(&split.channels).unwrap())
    };
    let ((one_side, before), (cover, _)) = (smooth(1), smooth(2));
    let sum_of_squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let off = sum_of_squares(&mut one_side.iter().zip(&cover).map(|(a, b)| a - b));
    let moved = sum_of_squares(&mut one_side.iter().zip(&before).map(|(a, b)| a - b));
    assert!(off < 4e-4 * moved, "{off} of {moved}");
}

#[test]
fn bands_sum_to_the_field_and_masks_and_regions_hold() {
    let shape = sample("creature", 2000);
    let directions = directions(&shape, Symmetry::Crosses);
    let n = directions.decomposer().n_vertices();
    let field = varied(n);
    let bands = directions.decomposer().decompose(&field, 2, &Schedule::dyadic(6).unwrap()).unwrap();
    assert!(bands.reconstruct().iter().zip(&field).all(|(a, b)| (a - b).abs() < 1e-13));
    let mut gap = field.clone();
    let flags: Vec<bool> = (0..n).map(|v| v % 11 == 0).collect();
    (0..n).filter(|&v| flags[v]).for_each(|v| gap[2 * v..][..2].fill(f64::NAN));
    let masked = directions.decomposer().masked(&flags).unwrap();
    let bands = masked.decompose(&gap, 2, &Schedule::dyadic(4).unwrap()).unwrap();
    assert!(flags.iter().zip(bands.coarsest().as_chunks::<2>().0).all(|(flag, z)| z[0].is_nan() == *flag));
}

#[test]
fn tensors_are_a_trace_and_a_line() {
    let shape = sample("torus", 1200);
    let directions = directions(&shape, Symmetry::Lines);
    let n = directions.decomposer().n_vertices();
    // 3·u uᵀ + 1·v vᵀ in each tangent plane.
    let tensors: Vec<f64> = (0..n)
        .flat_map(|vertex| {
            let plane = directions.plane(vertex);
            let (s, c) = (0.01 * vertex as f64).sin_cos();
            let (u, v) = (plane.vector([c, s]), plane.vector([-s, c]));
            let entry = |i: usize, j: usize| 3.0 * u[i] * u[j] + v[i] * v[j];
            [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
        })
        .collect();
    let split = directions.split_tensors(&tensors).unwrap();
    assert!(split.normal_share < 1e-14 && split.trace.iter().all(|t| (t - 4.0).abs() < 1e-12));
    for (vertex, z) in split.channels.as_chunks::<2>().0.iter().enumerate() {
        let (s, c) = (0.02 * vertex as f64).sin_cos();
        assert!((z[0] - c).abs() < 1e-12 && (z[1] - s).abs() < 1e-12);
    }
    let back = directions.join_tensors(&split.trace, &split.channels).unwrap();
    assert!(back.iter().zip(&tensors).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn what_has_no_tangent_plane_is_refused() {
    let path = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)]).unwrap());
    let refused = Directions::new(&prepare(&path, OperatorKind::Walk), Symmetry::Vectors, Progress::none());
    assert!(matches!(refused, Err(DirectionsError::NoSurface)));
    let shape = sample("sphere", 100);
    let directions = directions(&shape, Symmetry::Vectors);
    let message = directions.split(&[0.0; 10]).unwrap_err().to_string();
    assert_eq!(message, "vectors need 300 values, 3 for each of 100 vertices, got 10");
    // The share along the normals neither overflows nor underflows.
    for size in [1e-200, 1.0, 1e200] {
        let radial: Vec<f64> =
            shape.points().unwrap().iter().flat_map(|p| [size * p[0], size * p[1], 0.0]).collect();
        let split = directions.split(&radial).unwrap();
        assert!((0.5..0.95).contains(&split.normal_share), "{size}: {}", split.normal_share);
    }
    // Zero vectors have no direction, and no singularity.
    let zeros = vec![0.0; 200];
    assert_eq!(directions.join(&zeros).unwrap(), vec![0.0; 300]);
    assert!(directions.singularities(&zeros, Progress::none()).unwrap().is_empty());
}

/// Normal deviates, by sums of uniform ones.
fn noise(n: usize, sigma: f64, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..n).map(|_| sigma * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect()
}

fn rms_between(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn noise_of_directions_is_found_and_removed_whatever_carries_them() {
    let params = DenoiseParams::default();
    for shape in [sample("sphere", 3000), cloud(&sample("sphere", 3000)), sample("torus", 3000)] {
        for symmetry in Symmetry::ALL.iter().copied() {
            for (kind, sigma) in [(OperatorKind::Surface, 0.1), (OperatorKind::Walk, 0.4)] {
                let directions = Directions::new(&prepare(&shape, kind), symmetry, Progress::none()).unwrap();
                let around: Vec<f64> =
                    shape.points().unwrap().iter().flat_map(|p| [-p[1], p[0], 0.0]).collect();
                let truth = directions.split(&around).unwrap().channels;
                let noise = noise(truth.len(), sigma, 7);
                let noisy: Vec<f64> = truth.iter().zip(&noise).map(|(z, e)| z + e).collect();
                let clean =
                    denoise_signal(directions.decomposer(), &noisy, 2, &params, Progress::none()).unwrap();
                let [info] = &clean.info[..] else { panic!("one group") };
                let found = info.noise / sigma;
                assert!((0.95..1.05).contains(&found), "{symmetry:?} {kind:?}: found {found}");
                let left = rms_between(&clean.values, &truth) / sigma;
                assert!(left < 0.4, "{symmetry:?} {kind:?}: {left} of the noise is left");
                // The expected error is that of both numbers. An error of the noise of 2 % is one of 4 % of its square.
                let expected = 0.5 * info.risk[1] / (sigma * sigma);
                let off = (expected - left * left).abs();
                assert!(off < 0.06, "{symmetry:?} {kind:?}: {expected} for {}", left * left);
            }
        }
    }
}

#[test]
fn a_jump_of_directions_stays_and_a_turned_shape_gives_the_same() {
    let (points, faces) = plane(48);
    let jump: Vec<f64> = points
        .iter()
        .flat_map(|p| if p[0] < points[points.len() / 2][0] { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] })
        .collect();
    let noise = noise(points.len() * 3, 0.15, 3);
    let noisy: Vec<f64> =
        jump.iter().zip(&noise).enumerate().map(|(i, (v, e))| if i % 3 < 2 { v + e } else { 0.0 }).collect();
    let denoised = |points: &[[f64; 3]], vectors: &[f64]| {
        let shape = Shape::Mesh(Mesh::new(points.to_vec(), faces.clone()).unwrap());
        let directions = directions(&shape, Symmetry::Vectors);
        let split = directions.split(vectors).unwrap();
        let params = DenoiseParams::default();
        let clean =
            denoise_signal(directions.decomposer(), &split.channels, 2, &params, Progress::none()).unwrap();
        directions.join(&clean.values).unwrap()
    };
    let clean = denoised(&points, &noisy);
    // A filter that mixes both sides would leave differences of half of the jump beside it.
    assert!(rms_between(&clean, &jump) < 0.35 * rms_between(&noisy, &jump), "{}", rms_between(&clean, &jump));
    let (sin, cos) = 0.7_f64.sin_cos();
    let turn = |v: &[f64; 3]| [v[0], cos * v[1] - sin * v[2], sin * v[1] + cos * v[2]];
    let turned: Vec<[f64; 3]> = points.iter().map(turn).collect();
    let vectors: Vec<f64> = noisy.as_chunks::<3>().0.iter().flat_map(turn).collect();
    let again = denoised(&turned, &vectors);
    let back: Vec<f64> = clean.as_chunks::<3>().0.iter().flat_map(turn).collect();
    // The probes of the risk lie in other frames, so that the weights differ a little.
    assert!(rms_between(&again, &back) < 0.1 * 0.15, "{}", rms_between(&again, &back));
}

#[test]
fn directions_are_denoised_alone_and_with_gaussian_noise() {
    let directions = directions(&sample("sphere", 300), Symmetry::Lines);
    let (decomposer, n) = (directions.decomposer(), directions.decomposer().n_vertices());
    let field = varied(n);
    let wrong = DenoiseParams::default().with_noise_model(NoiseModel::Multiplicative);
    let positive: Vec<f64> = field.iter().map(|v| v + 2.0).collect();
    let refused = denoise_signal(decomposer, &positive, 2, &wrong, Progress::none());
    assert_eq!(refused.unwrap_err(), DenoiseError::Directions);
    let refused =
        denoise_signal(decomposer, &[0.0].repeat(n), 1, &DenoiseParams::default(), Progress::none());
    assert!(matches!(refused.unwrap_err(), DenoiseError::Bands(_)));
    let axis = TimeAxis::new(2, 1.0).unwrap();
    let refused = denoise_series(decomposer, &axis, &field, 1, &DenoiseParams::default(), Progress::none());
    assert_eq!(refused.unwrap_err(), DenoiseError::Directions);
}

#[test]
fn infinite_components_are_refused_and_unknown_ones_stay_unknown() {
    let directions = directions(&sample("sphere", 300), Symmetry::Vectors);
    let n = directions.decomposer().n_vertices();
    let mut vectors = [1.0, 0.5, 0.0].repeat(n);
    vectors[3 * 5 + 1] = f64::NEG_INFINITY;
    let said = directions.split(&vectors).unwrap_err().to_string();
    assert!(said.contains("vertex 5 has -inf"), "{said}");
    vectors[3 * 5 + 1] = f64::NAN;
    let split = directions.split(&vectors).unwrap();
    assert!(split.channels[10].is_nan() && split.channels[11].is_nan());
    let mut tensors = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0].repeat(n);
    tensors[6 * 7] = f64::INFINITY;
    assert!(matches!(directions.split_tensors(&tensors), Err(DirectionsError::Infinite { vertex: 7, .. })));
}
