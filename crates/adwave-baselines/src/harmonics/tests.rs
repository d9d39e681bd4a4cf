use super::*;
use crate::laplacian::LaplacianParams;
use crate::signature::{heat_kernel_signature, heat_times, wave_kernel_signature};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};
use std::f64::consts::PI;

fn harmonics(shape: &Shape, k: usize) -> Harmonics {
    let laplacian = LaplacianMatrices::new(shape, &LaplacianParams::default()).unwrap();
    Harmonics::new(&laplacian, k, &EigenParams::default(), Progress::none()).unwrap()
}

fn shape(points: Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> Shape {
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(triangles)).unwrap())
}

fn sample(name: &str, n: usize) -> Shape {
    let sample = Sample::from_name(name, Some(n)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

/// Octahedron on the unit sphere with each edge halved `times` times: a family of nested meshes.
fn octasphere(times: u32) -> Shape {
    let mut points = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..times {
        let mut middle = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for t in &triangles {
            let m: [u32; 3] = std::array::from_fn(|k| {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let sum: [f64; 3] =
                        std::array::from_fn(|c| points[a as usize][c] + points[b as usize][c]);
                    let length = adwave::vector::norm(&sum);
                    points.push(sum.map(|c| c / length));
                    points.len() as u32 - 1
                })
            });
            finer.extend([[t[0], m[0], m[2]], [t[1], m[1], m[0]], [t[2], m[2], m[1]], m]);
        }
        triangles = finer;
    }
    shape(points, &triangles)
}

/// Graph of the five-point stencil on a flat square torus of side 1. The torus cannot be embedded in space, but the
/// graph's spectrum has a closed form for grid × grid vertices.
fn torus_graph(n: u32) -> Shape {
    let at = |i: u32, j: u32| (i % n) * n + j % n;
    let edges: Vec<_> = (0..n)
        .flat_map(|i| {
            (0..n).flat_map(move |j| [(at(i, j), at(i + 1, j), 1.0), (at(i, j), at(i, j + 1), 1.0)])
        })
        .collect();
    Shape::Graph(adwave::shape::Graph::new((n * n) as usize, &edges).unwrap())
}

#[test]
fn the_sphere_converges_to_l_times_l_plus_1_at_second_order() {
    // Largest relative error over l = 1 … 4 on three refinements.
    let errors: Vec<f64> = [3, 4, 5]
        .map(|times| {
            let harmonics = harmonics(&octasphere(times), 25);
            assert!(harmonics.values[0].abs() < 1e-9);
            let exact = (1..5).flat_map(|l| std::iter::repeat_n(f64::from(l * (l + 1)), 2 * l as usize + 1));
            harmonics.values[1..].iter().zip(exact).map(|(v, e)| (v / e - 1.0).abs()).fold(0.0, f64::max)
        })
        .to_vec();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 1.8 && order < 2.2, "errors {errors:?}, order {order}");
    }
    assert!(errors[2] < 0.01, "{errors:?}");
}

#[test]
fn the_flat_torus_converges_at_second_order() {
    let exact: Vec<f64> = {
        let mut all: Vec<f64> = (-3..=3_i32)
            .flat_map(|i| (-3..=3_i32).map(move |j| 4.0 * PI * PI * f64::from(i * i + j * j)))
            .collect();
        all.sort_by(f64::total_cmp);
        all.truncate(21);
        all
    };
    let errors: Vec<f64> = [24, 48]
        .map(|n| {
            let found = harmonics(&torus_graph(n), 21);
            let squared = f64::from(n * n);
            let error = found.values.iter().zip(&exact).skip(1).map(|(v, e)| (v * squared / e - 1.0).abs());
            error.fold(0.0, f64::max)
        })
        .to_vec();
    let order = (errors[0] / errors[1]).log2();
    assert!((1.8..2.2).contains(&order), "errors {errors:?}, order {order}");
}

#[test]
fn harmonics_are_orthonormal_under_the_mass() {
    for shape in [sample("knot", 3000), sample("torus", 800), octasphere(4)] {
        let h = harmonics(&shape, 60);
        for i in 0..h.len() {
            for j in 0..=i {
                let inner: f64 =
                    h.function(i).iter().zip(h.function(j)).zip(&h.mass).map(|((a, b), m)| a * b * m).sum();
                assert!((inner - f64::from(u8::from(i == j))).abs() < 1e-10, "{i}, {j}: {inner}");
            }
        }
    }
}

#[test]
fn all_harmonics_together_lose_nothing_and_filters_are_what_they_say() {
    let shape = octasphere(3);
    let points = shape.points().unwrap().as_flattened().to_vec();
    let n = shape.n_vertices();
    let all = harmonics(&shape, n + 100);
    assert_eq!(all.len(), n);
    let back = all.inverse(&all.transform(&points, 3).unwrap(), 3).unwrap();
    assert!(points.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-10));
    let few = harmonics(&shape, 20);
    let same = few.filter(&points, 3, |_| 1.0, Remainder::LastGain).unwrap();
    assert!(points.iter().zip(&same).all(|(a, b)| (a - b).abs() < 1e-12));
    let low = few.filter(&points, 3, |_| 1.0, Remainder::Drop).unwrap();
    let projected = few.inverse(&few.transform(&points, 3).unwrap(), 3).unwrap();
    assert!(low.iter().zip(&projected).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!(few.transform(&points[1..], 3).is_err());
}

#[test]
fn heat_and_wave_signatures_are_constant_on_the_sphere() {
    // 1 + 3 + … + 15 harmonics span whole eigenspaces. On a mesh these split slightly, and vertices differ by the
    // discretization error.
    let h = harmonics(&octasphere(5), 64);
    let times = heat_times(&h, 10);
    for signature in [heat_kernel_signature(&h, &times), wave_kernel_signature(&h, 10)] {
        let n = signature.scales.len();
        for i in 0..n {
            let column: Vec<f64> = signature.values.iter().skip(i).step_by(n).copied().collect();
            let mean = column.iter().sum::<f64>() / column.len() as f64;
            let spread = column.iter().map(|v| (v / mean - 1.0).abs()).fold(0.0, f64::max);
            assert!(spread < 0.03, "scale {i}: {spread}");
        }
    }
    // The energies end 2σ, or fourteen steps, short of both ends of the spectrum.
    let energies = wave_kernel_signature(&h, 10).scales;
    let (step, last) = (energies[1] - energies[0], h.values[h.values.len() - 1].ln());
    assert!((energies[9] - (last - 14.0 * step)).abs() < 1e-9, "{energies:?} {last}");
    // The total heat is the trace: ∫ HKS = Σ e^(−λt).
    let signature = heat_kernel_signature(&h, &times[4..5]);
    let total: f64 = signature.values.iter().zip(h.scatter(&h.mass, 1)).map(|(v, m)| v * m).sum();
    let trace: f64 = h.values.iter().map(|l| (-l * times[4]).exp()).sum();
    assert!((total / trace - 1.0).abs() < 1e-10);
}

#[test]
fn scaling_a_shape_scales_its_spectrum() {
    let shape = sample("torus", 900);
    let big = |s: f64| {
        let Some(mesh) = shape.as_mesh() else { unreachable!() };
        let points = mesh.points().iter().map(|p| p.map(|c| c * s)).collect();
        Shape::Mesh(Mesh::new(points, mesh.faces().clone()).unwrap())
    };
    let one = harmonics(&shape, 10);
    for s in [1e-30, 1e30] {
        let other = harmonics(&big(s), 10);
        for (a, b) in one.values.iter().zip(&other.values).skip(1) {
            assert!((b * s * s / a - 1.0).abs() < 1e-9, "{a} {b}");
        }
    }
}

#[test]
fn tiny_and_broken_shapes_have_harmonics() {
    let one = Shape::Cloud(PointCloud::new(vec![[1.0, 2.0, 3.0]]).unwrap());
    let two = Shape::Cloud(PointCloud::new(vec![[0.0; 3], [1.0, 0.0, 0.0]]).unwrap());
    let fifty = Shape::Cloud(
        PointCloud::new((0..50).map(|i| [f64::from(i), f64::from(i * i % 7), 0.0]).collect()).unwrap(),
    );
    for shape in [&one, &two, &fifty] {
        for k in [0, 1, 50, 1000] {
            assert_eq!(harmonics(shape, k).len(), k.min(shape.n_vertices()));
        }
    }
    // One zero eigenvalue per component of any size: three spheres, a face without area, a vertex without faces.
    let Shape::Mesh(sphere) = sample("sphere", 700) else { unreachable!() };
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..3_u32 {
        let base = points.len() as u32;
        points.extend(sphere.points().iter().map(|p| [p[0] + 10.0 * f64::from(k), p[1], p[2]]));
        triangles.extend(sphere.faces().iter().map(|f| [f[0] + base, f[1] + base, f[2] + base]));
    }
    let base = points.len() as u32;
    points.extend([[50.0, 0.0, 0.0], [51.0, 0.0, 0.0], [52.0, 0.0, 0.0], [99.0, 0.0, 0.0]]);
    triangles.push([base, base + 1, base + 2]);
    let h = harmonics(&shape(points.clone(), &triangles), 40);
    let first = h.values[4];
    assert_eq!(h.values.iter().filter(|v| v.abs() < 1e-9 * first).count(), 4);
    assert_eq!(h.len(), 40);
    assert!(h.values.iter().chain(&h.functions).all(|v| v.is_finite()));
    let flat = points.as_flattened();
    let kept = h.filter(flat, 3, |_| 0.0, Remainder::Drop).unwrap();
    assert_eq!(kept[flat.len() - 3..], flat[flat.len() - 3..], "a vertex of no face stays");
}

#[test]
fn more_harmonics_than_one_band_are_orthonormal_and_complete() {
    let shape = sample("creature", 2500);
    let laplacian = LaplacianMatrices::new(&shape, &LaplacianParams::default()).unwrap();
    let by_bands = |band| {
        Harmonics::new(&laplacian, 130, &EigenParams::default().with_band(band), Progress::none()).unwrap()
    };
    let (one, many) = (by_bands(320), by_bands(25));
    assert!(many.info.factorizations > 4);
    for (a, b) in one.values.iter().zip(&many.values) {
        assert!((a - b).abs() <= 1e-9 * one.values[129], "{a} {b}");
    }
    for i in (0..130).step_by(7) {
        for j in 0..130 {
            let inner: f64 = many
                .function(i)
                .iter()
                .zip(many.function(j))
                .zip(&many.mass)
                .map(|((a, b), m)| a * b * m)
                .sum();
            assert!((inner - f64::from(u8::from(i == j))).abs() < 1e-10, "{i}, {j}: {inner}");
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let shape = sample("knot", 2000);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| harmonics(&shape, 30))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.values, three.values);
    assert_eq!(one.functions, three.functions);
}
