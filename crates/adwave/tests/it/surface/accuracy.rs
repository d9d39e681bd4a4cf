//! Against closed forms: spherical harmonics, cosines, the second moments of an impulse.

use crate::surface::meshes::{Points, Triangles, sample, sector, uneven_rectangle, uneven_sphere};
use crate::surface::{decomposer, mesh, params};
use adwave::bands::{FWHM, Schedule};
use adwave::operator::surface_diffusion;
use adwave::shape::{Mesh, Polygons, Shape};
use adwave::{Decomposer, Progress};
use std::f64::consts::PI;

/// Error of the decay of an eigenfunction relative to `e^(−λt)`, relative to it.
const DECAY: f64 = 0.01;
/// Times are looked at until the function has decayed by `e^(−3)`.
const LONGEST: f64 = 3.0;
/// Factor by which the error must fall when edges are halved; of second order it falls by 4.
const SECOND_ORDER: f64 = 3.3;
/// Largest error of the second moments of an impulse relative to σ²/2, for σ of at least that many edges. At 3 edges it is 0.0225.
const MOMENT: f64 = 0.02;
const FROM_EDGES: f64 = 4.0;
/// Errors of a wave on a sphere from its flat triangles.
const OTHER: f64 = 1e-4;

/// A function with its eigenvalue.
type Eigenfunction = (f64, Box<dyn Fn(&[f64; 3]) -> f64>);

/// The largest relative error of the decay of any of the functions at any level, as projected on itself by area; and what of it the
/// masses that are raised make up, which belong to one vertex in a hundred however many there are.
fn largest_decay_error((points, triangles): &(Points, Triangles), functions: &[Eigenfunction]) -> [f64; 2] {
    let decomposer = decomposer(&mesh(points, triangles));
    let (areas, step) = (decomposer.areas(), decomposer.operator().step_length());
    let n_channels = functions.len();
    let signal: Vec<f64> =
        points.iter().flat_map(|p| functions.iter().map(|(_, f)| f(p)).collect::<Vec<_>>()).collect();
    let slowest = functions.iter().map(|(l, _)| *l).fold(f64::INFINITY, f64::min);
    let n_levels = (1..32).take_while(|&j| slowest * time(step, f64::from(j - 1).exp2()) < LONGEST).count();
    let bands = decomposer.decompose(&signal, n_channels, &Schedule::dyadic(n_levels).unwrap()).unwrap();
    let mut worst = 0.0_f64;
    for j in 1..=n_levels {
        let level = bands.scaling(j);
        for (c, (lambda, _)) in functions.iter().enumerate() {
            let product = |other: &[f64]| -> f64 {
                (0..points.len())
                    .map(|x| areas[x] * signal[x * n_channels + c] * other[x * n_channels + c])
                    .sum()
            };
            let exponent = lambda * time(step, bands.steps[j]);
            if exponent <= LONGEST {
                let decay = product(&level) / product(&signal);
                worst = worst.max((decay / (-exponent).exp() - 1.0).abs());
            }
        }
    }
    let raised = surface_diffusion(decomposer.geometry().unwrap(), &params(), Progress::none())
        .unwrap()
        .info
        .added_mass;
    [worst, LONGEST * raised]
}

/// The time of so many steps: σ² = 4t.
fn time(step_length: f64, steps: f64) -> f64 {
    step_length * step_length * steps / 4.0
}

/// The 24 spherical harmonics of degree 1 to 4, as polynomials in a frame that has no direction in common with the mesh.
fn harmonics() -> Vec<Eigenfunction> {
    let turned = |p: &[f64; 3]| {
        let [x, y, z] = *p;
        // A rotation: the columns are orthonormal.
        let (u, v, w) =
            ((2.0 * x - 2.0 * y + z) / 3.0, (x + 2.0 * y + 2.0 * z) / 3.0, (2.0 * x + y - 2.0 * z) / 3.0);
        [u, v, w]
    };
    // Real and imaginary parts of (x + iy)^m times the part of the Legendre function that is a polynomial in z.
    let legendre = |l: i32, m: i32, z: f64| -> f64 {
        match (l, m) {
            (l, m) if l == m => 1.0,
            (l, m) if l == m + 1 => z,
            (2, 0) => 3.0 * z * z - 1.0,
            (3, 0) => 5.0 * z.powi(3) - 3.0 * z,
            (3, 1) => 5.0 * z * z - 1.0,
            (4, 0) => 35.0 * z.powi(4) - 30.0 * z * z + 3.0,
            (4, 1) => 7.0 * z.powi(3) - 3.0 * z,
            (4, 2) => 7.0 * z * z - 1.0,
            _ => unreachable!("{l} {m}"),
        }
    };
    let mut functions: Vec<Eigenfunction> = Vec::new();
    for l in 1..=4 {
        for m in 0..=l {
            for imaginary in [false, true] {
                if m == 0 && imaginary {
                    continue;
                }
                let f = move |p: &[f64; 3]| {
                    let [x, y, z] = turned(p);
                    let (angle, r) = (f64::from(m) * y.atan2(x), x.hypot(y).powi(m));
                    let around = if imaginary { angle.sin() } else { angle.cos() };
                    r * around * legendre(l, m, z)
                };
                functions.push((f64::from(l * (l + 1)), Box::new(f)));
            }
        }
    }
    assert_eq!(functions.len(), 24);
    functions
}

/// The first 20 cosines of the rectangle [0, 1.3] × [0, 1] but for the constant.
fn cosines() -> Vec<Eigenfunction> {
    let mut waves: Vec<(f64, f64, f64)> = Vec::new();
    for k in 0..12 {
        for l in 0..12 {
            let (a, b) = (f64::from(k) * PI / 1.3, f64::from(l) * PI);
            waves.push((a * a + b * b, a, b));
        }
    }
    waves.sort_by(|p, q| p.0.total_cmp(&q.0));
    let function = |&(lambda, a, b): &(f64, f64, f64)| -> Eigenfunction {
        (lambda, Box::new(move |p: &[f64; 3]| (a * p[0]).cos() * (b * p[1]).cos()))
    };
    waves[1..=20].iter().map(function).collect()
}

/// Errors of three meshes, each with edges half as long as the one before.
fn assert_second_order(name: &str, errors: [[f64; 2]; 3]) {
    let without = errors.map(|[error, raised]| error - raised);
    let orders = [without[0] / without[1], without[1] / without[2]];
    println!("{name}: errors {errors:.6?}, falling {orders:.2?} times");
    assert!(errors[2][0] <= DECAY, "{name}: {errors:?}");
    assert!(orders.iter().all(|&order| order >= SECOND_ORDER), "{name}: {errors:?}");
}

#[test]
fn spherical_harmonics_decay_as_on_the_sphere_and_the_error_is_of_second_order() {
    let functions = harmonics();
    let error = |n| largest_decay_error(&uneven_sphere(n), &functions);
    assert_second_order("sphere", [2500, 10_000, 40_000].map(error));
}

/// A cube of n × n quadrilaterals on each side, on the unit sphere, with even angles along both sides.
fn cubed_sphere(n: u32) -> Shape {
    let across = |k: u32| ((f64::from(2 * k) / f64::from(n) - 1.0) * 0.25 * PI).tan();
    let mut numbers = std::collections::HashMap::new();
    let (mut points, mut faces) = (Points::new(), Polygons::new());
    for side in 0..6 {
        let mut vertex = |i: u32, j: u32| {
            let (u, v) = (across(i), across(j));
            // Each outward side has its u and v counterclockwise.
            let p = [[1.0, u, v], [v, 1.0, u], [u, v, 1.0], [-1.0, v, u], [u, -1.0, v], [v, u, -1.0]][side];
            let key = p.map(|c: f64| (1e9 * c).round() as i64);
            *numbers.entry(key).or_insert_with(|| {
                let length = p[0].hypot(p[1]).hypot(p[2]);
                points.push(p.map(|c| c / length));
                points.len() as u32 - 1
            })
        };
        for i in 0..n {
            for j in 0..n {
                faces.push(&[vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
            }
        }
    }
    Shape::Mesh(Mesh::new(points, faces).unwrap())
}

/// The law of a beam: Y_l decays as exp(−t·l(l + 1)). A mesh of edges h slows it by the factor 1 − l(l + 1)h²/16, which at the
/// time t is an error of t(l(l + 1))²h²/16·exp(−t·l(l + 1)). Hardly any of it is left on triangles. On quadrilaterals waves
/// along the sides have 4/3 of the mean error, and these waves pass cells of 1.18 of the mean area.
#[test]
fn short_waves_of_a_sphere_decay_as_those_of_the_sphere() {
    let (points, triangles) = sample("sphere", 10_000);
    let meshes = [("triangles", mesh(&points, &triangles), 0.15), ("quadrilaterals", cubed_sphere(40), 0.6)];
    for (name, shape, share) in meshes as [(&str, Shape, f64); 2] {
        let corrected = params().with_corrected_dispersion(true);
        let decomposer = Decomposer::with_params(&shape, &corrected, Progress::none()).unwrap();
        let (areas, step) = (decomposer.areas(), decomposer.operator().step_length());
        let cell = areas.iter().sum::<f64>() / areas.len() as f64;
        for l in (4..).take_while(|&l| f64::from(l * (l + 1)) * cell < 0.5) {
            let lambda = f64::from(l * (l + 1));
            for turn in 0..3 {
                let wave = |p: &[f64; 3]| {
                    let [x, y] = [p[turn], p[(turn + 1) % 3]];
                    x.hypot(y).powi(l) * (f64::from(l) * y.atan2(x)).cos()
                };
                let signal: Vec<f64> = decomposer.positions().iter().map(wave).collect();
                let signal = decomposer.vertex_map().scatter(&signal, 1);
                let steps = [0.3, 1.0, 2.0].map(|decay| 4.0 * decay / (lambda * step * step));
                let Ok(schedule) = Schedule::real(steps.to_vec()) else { continue };
                let bands = decomposer.decompose(&signal, 1, &schedule).unwrap();
                let product =
                    |other: &[f64]| (0..areas.len()).map(|x| areas[x] * signal[x] * other[x]).sum::<f64>();
                for (j, decay) in [0.3_f64, 1.0, 2.0].into_iter().enumerate() {
                    let found = product(&bands.scaling(j + 1)) / product(&signal);
                    let off = found - (-decay).exp();
                    let plain = decay * (-decay).exp() * lambda * cell / 16.0;
                    println!(
                        "{name}: l = {l}, λt = {decay}: off by {off:.5}, without correction about {plain:.5}"
                    );
                    assert!(off.abs() < share * plain + OTHER, "{name}: l = {l}, λt = {decay}: {off}");
                }
            }
        }
    }
}

#[test]
fn cosines_decay_as_on_the_rectangle_and_the_error_is_of_second_order() {
    let functions = cosines();
    let error = |n| largest_decay_error(&uneven_rectangle(n), &functions);
    assert_second_order("rectangle", [36, 72, 144].map(error));
}

#[test]
fn the_second_moments_of_an_impulse_are_half_of_sigma_squared_anywhere() {
    let (points, triangles, edge) = sector(120);
    let decomposer = decomposer(&mesh(&points, &triangles));
    let step = decomposer.operator().step_length();
    let mut errors = Vec::new();
    for edges in [1.5, 2.0, 3.0, 4.0, 6.0] {
        let mut worst = 0.0_f64;
        for (r, angle) in [
            (2.0, 0.0),
            (2.3, 0.4),
            (2.7, -0.3),
            (3.3, 0.5),
            (4.0, -0.5),
            (4.7, 0.1),
            (5.5, 0.3),
            (6.0, -0.2),
        ] {
            let at: [f64; 2] = [f64::cos(angle) * r, f64::sin(angle) * r];
            let square = |p: &[f64; 3]| (p[0] - at[0]).powi(2) + (p[1] - at[1]).powi(2);
            let x =
                (0..points.len()).min_by(|&a, &b| square(&points[a]).total_cmp(&square(&points[b]))).unwrap();
            let sigma = edges * edge * points[x][0].hypot(points[x][1]);
            let schedule = Schedule::lengths(&[sigma], step).unwrap();
            let phi = decomposer.basis_of_vertex(x, &schedule, Progress::none()).unwrap().scaling_function;
            for c in 0..2 {
                let moment: f64 =
                    phi.iter().zip(&points).map(|(v, p)| v * (p[c] - points[x][c]).powi(2)).sum();
                worst = worst.max((moment / (0.5 * sigma * sigma) - 1.0).abs());
            }
        }
        println!("σ = {edges} edges: second moments off by {worst:.2e}");
        errors.push((edges, worst));
    }
    assert!(errors.iter().all(|&(edges, error)| edges < FROM_EDGES || error <= MOMENT), "{errors:?}");
}

/// Spread from one vertex in the middle of a flat grid: its width at half its height, along either axis.
#[test]
fn an_impulse_is_as_wide_at_half_its_height_as_was_asked_for() {
    let n = 100_u32;
    let at = |i: u32, j: u32| (i * (n + 1) + j) as usize;
    let points: Points =
        (0..=n).flat_map(|i| (0..=n).map(move |j| [f64::from(i), f64::from(j), 0.0])).collect();
    let cell = |i: u32, j: u32| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    let cells = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j)));
    let triangles: Triangles = cells.map(|triangle| triangle.map(|v| v as u32)).collect();
    let decomposer = decomposer(&mesh(&points, &triangles));
    let spacing = 1.0;
    let mut impulse = vec![0.0; points.len()];
    impulse[at(n / 2, n / 2)] = 1.0;
    for asked in [8.0, 12.0, 20.0].map(|cells| cells * spacing) {
        let schedule = Schedule::lengths(&[asked / FWHM], decomposer.operator().step_length()).unwrap();
        let bands = decomposer.decompose(&impulse, 1, &schedule).unwrap();
        let values = bands.coarsest();
        let half = 0.5 * values[at(n / 2, n / 2)];
        let reach = |vertex: &dyn Fn(u32) -> usize| {
            let k = (1..n / 2).find(|&k| values[vertex(k)] < half).unwrap();
            let (before, after) = (values[vertex(k - 1)], values[vertex(k)]);
            (f64::from(k - 1) + (before - half) / (before - after)) * spacing
        };
        let wide = reach(&|k| at(n / 2 + k, n / 2)) + reach(&|k| at(n / 2 - k, n / 2));
        let high = reach(&|k| at(n / 2, n / 2 + k)) + reach(&|k| at(n / 2, n / 2 - k));
        for found in [wide, high] {
            assert!((found / asked - 1.0).abs() < 0.02, "{found} for {asked}");
        }
    }
}
