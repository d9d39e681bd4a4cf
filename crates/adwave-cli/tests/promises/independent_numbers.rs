//! Bounds, distances and expected errors that the command prints, beside an independent computation of each, over random inputs
//! of every kind of shape.

use crate::harness::{Faults, Run, run_line};
use adwave_io::{ReadLimits, ShapeFile, read_path};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

type Point = [f64; 3];

/// Random inputs of each kind.
const N_SEEDS: u64 = 20;

/// Largest relative difference of a distance from its literal computation: files hold 9 digits.
const DIGITS: f64 = 1e-6;

/// Samples of a triangle along each side.
const SAMPLES: usize = 6;

/// Numbers between 0 and 1 (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let (u, v) = (self.next().max(1e-300), self.next());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}

/// A mesh.
#[derive(Clone)]
struct Mesh {
    points: Vec<Point>,
    faces: Vec<[usize; 3]>,
}

impl Mesh {
    /// A closed ball with bumps: n rings of 2n vertices and two poles.
    fn ball(n: usize, random: &mut Random) -> Self {
        let [a, b, c] = [random.next(), random.next(), random.next()];
        let m = 2 * n;
        let place = |theta: f64, phi: f64| -> Point {
            let r = 1.0
                + 0.2 * (3.0 * theta + 6.0 * a).sin() * theta.sin() * (2.0 * phi + 6.0 * b).cos()
                + 0.1 * c;
            [r * theta.sin() * phi.cos(), r * theta.sin() * phi.sin(), 1.3 * r * theta.cos()]
        };
        let angle = |k: usize, of: usize| std::f64::consts::PI * k as f64 / of as f64;
        let mut points = vec![place(0.0, 0.0)];
        for i in 1..n {
            points.extend((0..m).map(|j| place(angle(i, n), 2.0 * angle(j, m))));
        }
        points.push(place(std::f64::consts::PI, 0.0));
        let at = |i: usize, j: usize| match i {
            0 => 0,
            i if i == n => 1 + (n - 1) * m,
            i => 1 + (i - 1) * m + j % m,
        };
        let mut faces = Vec::new();
        for i in 0..n {
            for j in 0..m {
                let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                faces.extend(
                    [[p, q, r], [p, r, s]]
                        .into_iter()
                        .filter(|f| f[0] != f[1] && f[1] != f[2] && f[0] != f[2]),
                );
            }
        }
        Self { points, faces }
    }

    /// A terrain over `width` × `depth` squares.
    fn terrain(width: usize, depth: usize, random: &mut Random) -> Self {
        let [a, b] = [random.next(), random.next()];
        let place = |i: usize, j: usize| -> Point {
            let (x, y) = (i as f64, j as f64);
            [x, y, (0.6 * x + 6.0 * a).sin() + (0.4 * y + 6.0 * b).cos()]
        };
        let points = (0..=width).flat_map(|i| (0..=depth).map(move |j| place(i, j))).collect();
        let row = depth + 1;
        let square = |i: usize, j: usize| {
            let p = i * row + j;
            [[p, p + row, p + row + 1], [p, p + row + 1, p + 1]]
        };
        let faces = (0..width).flat_map(|i| (0..depth).flat_map(move |j| square(i, j))).collect();
        Self { points, faces }
    }

    /// Triangles with corners of their own, in a random order.
    fn soup(&self, random: &mut Random) -> Self {
        let mut faces = self.faces.clone();
        for k in (1..faces.len()).rev() {
            faces.swap(k, random.below(k + 1));
        }
        let points = faces.iter().flatten().map(|&x| self.points[x]).collect();
        Self { points, faces: (0..faces.len()).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect() }
    }

    fn triangles(&self) -> Vec<[Point; 3]> {
        self.faces.iter().map(|f| f.map(|x| self.points[x])).collect()
    }

    fn save(&self, path: &Path) {
        let mut text = format!(
            "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n\
             property list uchar int vertex_indices\nend_header\n",
            self.points.len(),
            self.faces.len()
        );
        self.points.iter().for_each(|p| writeln!(text, "{} {} {}", p[0], p[1], p[2]).unwrap());
        self.faces.iter().for_each(|f| writeln!(text, "3 {} {} {}", f[0], f[1], f[2]).unwrap());
        fs::write(path, text).unwrap();
    }
}

fn save_cloud(path: &Path, points: &[Point]) {
    let mut text = String::new();
    for p in points {
        writeln!(text, "{} {} {}", p[0], p[1], p[2]).unwrap();
    }
    fs::write(path, text).unwrap();
}

fn read(path: &Path) -> ShapeFile {
    read_path(path, &ReadLimits::default()).unwrap()
}

fn minus(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|c| a[c] - b[c])
}

fn dot(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Distance of a point from a triangle: from its plane if the foot lies inside, else from the nearest side.
fn distance_to_triangle(p: &Point, t: &[Point; 3]) -> f64 {
    let normal = cross(&minus(&t[1], &t[0]), &minus(&t[2], &t[0]));
    let square = dot(&normal, &normal);
    let height = dot(&minus(p, &t[0]), &normal) / square.sqrt();
    let foot = [0, 1, 2].map(|c| p[c] - height * normal[c] / square.sqrt());
    let is_inside = (0..3).all(|k| {
        let side = minus(&t[(k + 1) % 3], &t[k]);
        dot(&cross(&side, &minus(&foot, &t[k])), &normal) >= 0.0
    });
    if square > 0.0 && is_inside {
        return height.abs();
    }
    let side_distance = |k: usize| {
        let side = minus(&t[(k + 1) % 3], &t[k]);
        let s = (dot(&minus(p, &t[k]), &side) / dot(&side, &side).max(1e-300)).clamp(0.0, 1.0);
        let apart = [0, 1, 2].map(|c| p[c] - t[k][c] - s * side[c]);
        dot(&apart, &apart).sqrt()
    };
    (0..3).map(side_distance).fold(f64::INFINITY, f64::min)
}

fn distance_to_surface(p: &Point, triangles: &[[Point; 3]]) -> f64 {
    triangles.iter().map(|t| distance_to_triangle(p, t)).fold(f64::INFINITY, f64::min)
}

/// Greatest distance of samples of the triangles of one mesh from another.
fn sampled_distance(from: &Mesh, to: &Mesh) -> f64 {
    let length = |a: &Point, b: &Point| dot(&minus(a, b), &minus(a, b)).sqrt();
    // A triangle reaches from its first corner as far as its longer side there.
    let reach = |t: &[Point; 3]| length(&t[0], &t[1]).max(length(&t[0], &t[2]));
    let triangles: Vec<([Point; 3], f64)> = to.triangles().into_iter().map(|t| (t, reach(&t))).collect();
    let mut greatest = 0.0_f64;
    for [a, b, c] in from.triangles() {
        for i in 0..=SAMPLES {
            for j in 0..=SAMPLES - i {
                let (s, t) = (i as f64 / SAMPLES as f64, j as f64 / SAMPLES as f64);
                let p = [0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]));
                let mut least = f64::INFINITY;
                for (triangle, reach) in &triangles {
                    if length(&p, &triangle[0]) - reach < least {
                        least = least.min(distance_to_triangle(&p, triangle));
                    }
                    // The point is nearer than the farthest one already.
                    if least <= greatest {
                        break;
                    }
                }
                greatest = greatest.max(least);
            }
        }
    }
    greatest
}

/// Solid angle of a closed mesh seen from a point, in turns: 1 inside and 0 outside.
fn winding(p: &Point, triangles: &[[Point; 3]]) -> f64 {
    let angle = |t: &[Point; 3]| {
        let [a, b, c] = t.map(|q| minus(&q, p));
        let [x, y, z] = [&a, &b, &c].map(|v| dot(v, v).sqrt());
        let below = x * y * z + dot(&a, &b) * z + dot(&b, &c) * x + dot(&c, &a) * y;
        2.0 * dot(&a, &cross(&b, &c)).atan2(below)
    };
    triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Runs a line that must succeed and returns its report.
fn report(folder: &Path, line: &str, faults: &mut Faults) -> Option<Value> {
    let run: Run = run_line(folder, &format!("{line} --json"));
    faults.inspect(&run);
    faults.expect(run.is_done(), || format!("{line}: {}", run.tail()));
    serde_json::from_str(&run.out).ok()
}

fn number(json: &Value, path: &str) -> f64 {
    json.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

/// Adds a fault unless `low ≤ found ≤ high`.
fn expect_between(line: &str, what: &str, found: f64, [low, high]: [f64; 2], faults: &mut Faults) {
    faults.expect((low..=high).contains(&found), || {
        format!("{line}: {what} is {found}, the computation gives {low} to {high}")
    });
}

/// Distances of vertices in the field of a result, beside literal ones.
fn check_field(folder: &Path, line: &str, literal: impl Fn(&Point) -> f64, faults: &mut Faults) -> Vec<f64> {
    let result = read(&folder.join("o.ply"));
    let field = result.field("difference").map(adwave_io::Field::to_f64).unwrap_or_default();
    faults.expect(field.len() == result.n_vertices(), || format!("{line}: {} values", field.len()));
    for (p, d) in result.points().iter().zip(&field).filter(|(_, d)| !d.is_nan()) {
        let expected = literal(p);
        faults.expect((d.abs() - expected).abs() <= DIGITS * (1.0 + expected), || {
            format!("{line}: {d} at {p:?}, the computation gives {expected}")
        });
    }
    field
}

#[test]
fn diff_of_two_meshes_bounds_both_distances() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(seed);
        let is_closed = seed % 2 == 0;
        let (a, b) = if is_closed {
            (Mesh::ball(5, &mut random), Mesh::ball(4, &mut random))
        } else {
            // The second continues beyond a border of the first.
            (Mesh::terrain(5, 4, &mut random), Mesh::terrain(9, 4, &mut random))
        };
        a.save(&folder.join("a.ply"));
        b.save(&folder.join("b.ply"));
        for (line, a, b) in [("diff a.ply b.ply -o o.ply", &a, &b), ("diff b.ply a.ply -o o.ply", &b, &a)] {
            let Some(json) = report(folder, line, &mut faults) else { continue };
            let triangles = b.triangles();
            let field = check_field(folder, line, |p| distance_to_surface(p, &triangles), &mut faults);
            let greatest = field.iter().filter(|d| !d.is_nan()).fold(0.0_f64, |most, d| most.max(d.abs()));
            let difference = |key: &str| number(&json, &format!("/difference/{key}"));
            expect_between(
                line,
                "greatest",
                difference("greatest"),
                [greatest - 1e-9, greatest + 1e-9],
                &mut faults,
            );
            for (attained, bound, from, to) in
                [("greatest_there", "there/bound", a, b), ("greatest_back", "back/bound", b, a)]
            {
                let sampled = sampled_distance(from, to);
                let (found, bound) = (difference(attained), difference(bound));
                expect_between(line, attained, found, [sampled / 1.012, bound], &mut faults);
                expect_between(line, "bound", bound, [sampled - DIGITS, 1.012 * found + DIGITS], &mut faults);
            }
        }
    }
    faults.finish();
}

#[test]
fn diff_of_one_surface_in_two_orders_is_zero() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(100 + seed);
        let mesh = if seed % 2 == 0 { Mesh::ball(4, &mut random) } else { Mesh::terrain(5, 3, &mut random) };
        let [a, b] = [mesh.soup(&mut random), mesh.soup(&mut random)];
        a.save(&folder.join("a.ply"));
        b.save(&folder.join("b.ply"));
        for format in ["ply", "stl", "obj", "glb", "off"] {
            for name in ["a", "b"] {
                if format != "ply" {
                    faults.inspect(&run_line(folder, &format!("convert {name}.ply -o {name}.{format}")));
                }
            }
            let line = format!("diff a.{format} b.{format}");
            let Some(json) = report(folder, &line, &mut faults) else { continue };
            for key in ["greatest", "greatest_there", "greatest_back"] {
                expect_between(
                    &line,
                    key,
                    number(&json, &format!("/difference/{key}")),
                    [0.0, DIGITS],
                    &mut faults,
                );
            }
            let morph = run_line(folder, &format!("morph a.{format} b.{format} -o m.{format} --share 0.5"));
            faults.inspect(&morph);
            faults.expect(!morph.is_done(), || format!("{}: other orders are blended", morph.line));
        }
    }
    faults.finish();
}

#[test]
fn diff_of_clouds_gives_distances_and_sides() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(200 + seed);
        let mesh = Mesh::ball(5, &mut random);
        mesh.save(&folder.join("m.ply"));
        let triangles = mesh.triangles();
        let mut place = || [3.0 * random.next() - 1.5, 3.0 * random.next() - 1.5, 4.0 * random.next() - 2.0];
        let scattered: Vec<Point> = (0..300).map(|_| place()).collect();
        save_cloud(&folder.join("q.xyz"), &scattered);
        let line = "diff q.xyz m.ply -o o.ply";
        if let Some(json) = report(folder, line, &mut faults) {
            let field = check_field(folder, line, |p| distance_to_surface(p, &triangles), &mut faults);
            faults.expect(json["difference"]["signed"] == true, || format!("{line}: no signs"));
            for (p, d) in scattered.iter().zip(&field).filter(|(_, d)| d.abs() > DIGITS) {
                let is_inside = winding(p, &triangles) > 0.5;
                faults
                    .expect(is_inside == (*d > 0.0), || format!("{line}: {d} at {p:?}, inside: {is_inside}"));
            }
        }
        // Two scattered clouds have no side.
        let other: Vec<Point> = (0..200).map(|_| place()).collect();
        save_cloud(&folder.join("r.xyz"), &other);
        let line = "diff q.xyz r.xyz --by closest";
        let run = run_line(folder, &format!("{line} --json"));
        faults.inspect(&run);
        if run.is_done() {
            let json: Value = serde_json::from_str(&run.out).unwrap_or_default();
            faults.expect(json["difference"]["signed"] == false, || format!("{line}: signs without a side"));
        }
        // A grid, and one that continues and climbs beyond its border.
        let (n, climb) = (8 + random.below(5), 0.5 + random.next());
        let grid = |n: usize, climb: f64| -> Vec<Point> {
            let height = |i: usize| climb * i.saturating_sub(9) as f64;
            (0..n).flat_map(|i| (0..8).map(move |j| [i as f64, f64::from(j), height(i)])).collect()
        };
        let (s, t) = (grid(n, 0.0), grid(n + 12, climb));
        save_cloud(&folder.join("s.xyz"), &s);
        save_cloud(&folder.join("t.xyz"), &t);
        let line = "diff s.xyz t.xyz";
        if let Some(json) = report(folder, line, &mut faults) {
            let nearest = |p: &Point| {
                s.iter().map(|q| dot(&minus(p, q), &minus(p, q)).sqrt()).fold(f64::INFINITY, f64::min)
            };
            let expected = t.iter().map(nearest).fold(0.0, f64::max);
            let found = number(&json, "/difference/greatest_back");
            expect_between(line, "greatest_back", found, [expected - 1e-9, expected + 1e-9], &mut faults);
        }
    }
    faults.finish();
}

#[test]
fn bounds_of_simplified_meshes_hold() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(300 + seed);
        let mesh = match seed % 3 {
            0 => Mesh::ball(8, &mut random),
            1 => Mesh::terrain(9, 7, &mut random),
            _ => Mesh::ball(7, &mut random).soup(&mut random),
        };
        mesh.save(&folder.join("a.ply"));
        let line = format!("simplify a.ply -o s.ply --measure --ratio {}", 0.25 + 0.5 * random.next());
        let Some(json) = report(folder, &line, &mut faults) else { continue };
        let result = read(&folder.join("s.ply"));
        let faces = result.faces().iter().map(|f| [f[0] as usize, f[1] as usize, f[2] as usize]).collect();
        let simple = Mesh { points: result.points().to_vec(), faces };
        for (side, from, to) in [("of_input", &mesh, &simple), ("of_result", &simple, &mesh)] {
            let sampled = sampled_distance(from, to);
            let [bound, attained] =
                ["greatest", "at_least"].map(|key| number(&json, &format!("/error/{side}/{key}")));
            expect_between(&line, side, bound, [sampled - DIGITS, f64::INFINITY], &mut faults);
            expect_between(&line, side, attained, [sampled / 1.012 - DIGITS, bound], &mut faults);
        }
    }
    faults.finish();
}

#[test]
fn expected_errors_of_denoised_fields_are_those_that_are_left() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for (kind, n_repeats) in [("mesh", 1), ("cloud", 1), ("curve", 1), ("repeated", 3)] {
        let (mut expected, mut left, mut before, mut noisy) = (0.0, 0.0, 0.0, 0.0);
        for seed in 0..N_SEEDS {
            let mut random = Random(400 + seed);
            let mut places = match kind {
                "curve" => (0..400).map(|k| [f64::from(k), (0.05 * f64::from(k)).sin(), 0.0]).collect(),
                _ => Mesh::terrain(19, 19, &mut random).points,
            };
            places = vec![places; n_repeats].concat();
            let sigma = 0.5 + random.next();
            let truth: Vec<f64> = places.iter().map(|p| 3.0 + (0.2 * p[0]).sin()).collect();
            let values: Vec<f64> = truth.iter().map(|f| f + sigma * random.normal()).collect();
            let mut rows = String::new();
            for (p, v) in places.iter().zip(&values) {
                writeln!(rows, "{} {} {} {v}", p[0], p[1], p[2]).unwrap();
            }
            let mut header = format!(
                "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nproperty double q\n",
                places.len()
            );
            let mut rest = String::new();
            if kind == "mesh" {
                let mesh = Mesh::terrain(19, 19, &mut random);
                let _ = writeln!(
                    header,
                    "element face {}\nproperty list uchar int vertex_indices",
                    mesh.faces.len()
                );
                mesh.faces.iter().for_each(|f| writeln!(rest, "3 {} {} {}", f[0], f[1], f[2]).unwrap());
            }
            if kind == "curve" {
                let _ = writeln!(
                    header,
                    "element edge {}\nproperty int vertex1\nproperty int vertex2",
                    places.len() - 1
                );
                (1..places.len()).for_each(|k| writeln!(rest, "{} {k}", k - 1).unwrap());
            }
            fs::write(folder.join("f.ply"), format!("{header}end_header\n{rows}{rest}")).unwrap();
            let Some(json) = report(folder, "denoise f.ply -o g.ply --signal q", &mut faults) else {
                continue;
            };
            let found =
                read(&folder.join("g.ply")).field("q").map(adwave_io::Field::to_f64).unwrap_or_default();
            let n = truth.len() as f64;
            let square = |f: &[f64]| f.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / n;
            before += number(&json, "/denoise/0/risk/0");
            expected += number(&json, "/denoise/0/risk/1");
            noisy += square(&values);
            left += square(&found);
        }
        // The sum over the inputs: each estimate has a random part.
        expect_between(kind, "expected error before", before, [0.8 * noisy, 1.25 * noisy], &mut faults);
        expect_between(kind, "expected error after", expected, [0.4 * left, 2.5 * left], &mut faults);
        faults.expect(left < 0.3 * noisy, || format!("{kind}: {left} of {noisy} is left"));
    }
    faults.finish();
}

#[test]
fn moved_shapes_match_by_their_motion() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(500 + seed);
        let n = 2000 + 50 * seed;
        faults.inspect(&run_line(folder, &format!("sample creature -o a.ply --vertices {n}")));
        let original = read(&folder.join("a.ply"));
        let angle = random.next();
        let (sin, cos) = (angle.sin(), angle.cos());
        let scale = if seed % 2 == 0 { 1.0 } else { 10_f64.powf(6.0 * random.next() - 3.0) };
        let motion = |p: &Point| {
            [scale * (cos * p[0] - sin * p[1]) + 1.0, scale * (sin * p[0] + cos * p[1]), scale * p[2]]
        };
        let faces = original.faces().iter().map(|f| [f[0] as usize, f[1] as usize, f[2] as usize]).collect();
        let moved = Mesh { points: original.points().iter().map(motion).collect(), faces };
        moved.save(&folder.join("b.ply"));
        let kind = if seed % 2 == 0 { "rigid" } else { "similarity" };
        let line = format!("match a.ply b.ply --motion {kind}");
        let Some(json) = report(folder, &line, &mut faults) else { continue };
        if json["motion"].is_null() {
            faults.add(format!("{line}: no motion, seed {seed}"));
            continue;
        }
        let matrix = |i: usize, j: usize| number(&json, &format!("/motion/matrix/{i}/{j}"));
        let extent = 4.0 * scale;
        for p in original.points() {
            let image = [0, 1, 2].map(|i| (0..3).map(|j| matrix(i, j) * p[j]).sum::<f64>() + matrix(i, 3));
            let apart = minus(&image, &motion(p));
            expect_between(
                &line,
                "distance of the image",
                dot(&apart, &apart).sqrt(),
                [0.0, 1e-4 * extent],
                &mut faults,
            );
        }
        expect_between(&line, "scale", number(&json, "/motion/scale") / scale, [0.9999, 1.0001], &mut faults);
        expect_between(
            &line,
            "median",
            number(&json, "/motion/median_distance"),
            [0.0, 1e-4 * extent],
            &mut faults,
        );
    }
    faults.finish();
}

#[test]
fn imputed_counts_are_powers_of_the_walk() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(600 + seed);
        let (n, genes, steps) = (6 + random.below(12), 2 + random.below(4), 1 + random.below(4));
        let mut walk = vec![vec![0.0; n]; n];
        for (x, row) in walk.iter_mut().enumerate() {
            row[x] = 0.5;
            row[(x + 1) % n] += random.next();
            row[random.below(n)] += random.next();
            let sum: f64 = row.iter().sum();
            for w in row.iter_mut() {
                *w /= sum;
            }
        }
        let mut counts = vec![vec![0.0; genes]; n];
        counts.iter_mut().flatten().for_each(|c| *c = (6.0 * random.next()).floor());
        let market = |rows: &[Vec<f64>]| {
            let entries: Vec<String> = rows
                .iter()
                .enumerate()
                .flat_map(|(i, row)| row.iter().enumerate().map(move |(j, v)| (i, j, *v)))
                .filter(|(_, _, v)| *v != 0.0)
                .map(|(i, j, v)| format!("{} {} {v}\n", i + 1, j + 1))
                .collect();
            let size = format!("{} {} {}", rows.len(), rows[0].len(), entries.len());
            format!("%%MatrixMarket matrix coordinate real general\n{size}\n{}", entries.concat())
        };
        fs::write(folder.join("walk.mtx"), market(&walk)).unwrap();
        fs::write(folder.join("counts.mtx"), market(&counts)).unwrap();
        let line = format!("impute counts.mtx -o out.npy --walk walk.mtx --time {steps}");
        let Some(_) = report(folder, &line, &mut faults) else { continue };
        for _ in 0..steps {
            counts = walk
                .iter()
                .map(|row| (0..genes).map(|g| row.iter().zip(&counts).map(|(w, c)| w * c[g]).sum()).collect())
                .collect();
        }
        let bytes = fs::read(folder.join("out.npy")).unwrap();
        let found: Vec<f64> = bytes[bytes.len() - 8 * n * genes..]
            .chunks_exact(8)
            .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
            .collect();
        for (a, b) in found.iter().zip(counts.iter().flatten()) {
            expect_between(&line, "value", *a, [b - 1e-9, b + 1e-9], &mut faults);
        }
    }
    faults.finish();
}

#[test]
fn bent_shapes_move_as_reported() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(700 + seed);
        let mesh =
            if seed % 2 == 0 { Mesh::ball(10, &mut random) } else { Mesh::terrain(16, 12, &mut random) };
        mesh.save(&folder.join("a.ply"));
        let mut end = |high: bool| {
            let along = |p: &Point| if seed % 2 == 0 { p[2] } else { p[0] };
            let mut order: Vec<usize> = (0..mesh.points.len()).collect();
            order.sort_by(|a, b| along(&mesh.points[*a]).total_cmp(&along(&mesh.points[*b])));
            if high {
                order.reverse();
            }
            order.truncate(20 + random.below(15));
            order
        };
        let (fixed, handle) = (end(false), end(true));
        let [x, y, z] = [0, 1, 2].map(|_| (random.next() - 0.5) * if seed % 2 == 0 { 0.6 } else { 4.0 });
        let words = |vertices: &[usize]| {
            let all: Vec<String> = vertices.iter().map(ToString::to_string).collect();
            format!("'vertices:indices={}'", all.join(" "))
        };
        let (fix, moved) = (words(&fixed), words(&handle));
        let line = format!("deform a.ply -o b.ply --fix {fix} --move {moved} --by {x},{y},{z}");
        let Some(json) = report(folder, &line, &mut faults) else { continue };
        let result = read(&folder.join("b.ply"));
        let line = format!("deform, seed {seed}");
        let mut expect = |what: &str, path: &str, expected: f64, within: f64| {
            let limits = [expected - within, expected + within];
            expect_between(&line, what, number(&json, path), limits, &mut faults);
        };
        expect("fixed", "/fixed", fixed.len() as f64, 0.0);
        expect("vertices of the handle", "/handles/0", handle.len() as f64, 0.0);
        let distances: Vec<f64> = (mesh.points.iter().zip(result.points()))
            .map(|(a, b)| dot(&minus(b, a), &minus(b, a)).sqrt())
            .collect();
        let greatest = distances.iter().fold(0.0_f64, |most, d| most.max(*d));
        expect("greatest motion", "/moved/max", greatest, DIGITS * greatest);
        let furthest = number(&json, "/moved/furthest_vertex") as usize;
        faults.expect(distances[furthest] >= greatest * (1.0 - DIGITS), || {
            format!("{line}: vertex {furthest}")
        });
        let mean = distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64;
        let rms = number(&json, "/moved/rms");
        expect_between(&line, "rms", rms, [mean.sqrt() - DIGITS, mean.sqrt() + DIGITS], &mut faults);
        let after = Mesh { points: result.points().to_vec(), faces: mesh.faces.clone() };
        for (when, mesh) in [("before", &mesh), ("after", &after)] {
            let twice = |[a, b, c]: &[Point; 3]| {
                let normal = cross(&minus(b, a), &minus(c, a));
                dot(&normal, &normal).sqrt()
            };
            let area = mesh.triangles().iter().map(twice).sum::<f64>() / 2.0;
            let limits = [area * (1.0 - DIGITS), area * (1.0 + DIGITS)];
            expect_between(&line, "area", number(&json, &format!("/area/{when}")), limits, &mut faults);
            if seed % 2 == 0 {
                let six = |[a, b, c]: &[Point; 3]| dot(a, &cross(b, c));
                let volume = mesh.triangles().iter().map(six).sum::<f64>() / 6.0;
                let found = number(&json, &format!("/volume/{when}")).abs();
                let limits = [volume.abs() * (1.0 - DIGITS), volume.abs() * (1.0 + DIGITS)];
                expect_between(&line, "volume", found, limits, &mut faults);
            }
        }
        // A handle follows its motion, and what is fixed stays.
        for (vertices, motion) in [(&fixed, [0.0; 3]), (&handle, [x, y, z])] {
            for &v in vertices {
                let apart = minus(&minus(&result.points()[v], &mesh.points[v]), &motion);
                let apart = dot(&apart, &apart).sqrt();
                expect_between(&line, "distance from its place", apart, [0.0, 0.02 * greatest], &mut faults);
            }
        }
    }
    faults.finish();
}

/// A ball whose triangles were cut into four some times.
fn subdivided(n_times: usize, random: &mut Random) -> Mesh {
    let mut mesh = Mesh::ball(2, random);
    for _ in 0..n_times {
        let mut middles = std::collections::HashMap::new();
        let Mesh { points, faces } = &mut mesh;
        let mut cut = Vec::new();
        for &[a, b, c] in faces.iter() {
            let [p, q, r] = [[a, b], [b, c], [c, a]].map(|[x, y]| {
                *middles.entry([x.min(y), x.max(y)]).or_insert_with(|| {
                    let bump = 1.0 + 0.1 * random.next();
                    points.push([0, 1, 2].map(|k| bump * (points[x][k] + points[y][k]) / 2.0));
                    points.len() - 1
                })
            });
            cut.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]);
        }
        *faces = cut;
    }
    mesh
}

#[test]
fn coefficients_that_are_kept_give_the_field_to_the_error_that_is_reported() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    let mut faults = Faults::default();
    for seed in 0..N_SEEDS {
        let mut random = Random(800 + seed);
        let family = ["linear", "butterfly", "loop", "irregular"][seed as usize % 4];
        let mesh = subdivided(2 + seed as usize % 2, &mut random);
        let [a, b] = [random.next(), random.next()];
        let values: Vec<f64> = (mesh.points.iter())
            .map(|p| 5.0 + (3.0 * p[0] + a).sin() + b * p[1] * p[2] + 0.1 * random.normal())
            .collect();
        mesh.save(&folder.join("a.ply"));
        let columns: Vec<String> = values.iter().map(ToString::to_string).collect();
        fs::write(folder.join("f.csv"), format!("f\n{}\n", columns.join("\n"))).unwrap();
        let share = 0.05 + 0.9 * random.next();
        let n = values.len();
        // The areas of the vertices: a third of each of their triangles.
        let mut areas = vec![0.0; n];
        for (t, f) in mesh.triangles().iter().zip(&mesh.faces) {
            let normal = cross(&minus(&t[1], &t[0]), &minus(&t[2], &t[0]));
            for &x in f {
                areas[x] += dot(&normal, &normal).sqrt() / 6.0;
            }
        }
        for keep in [share, 1.0] {
            let line = format!("transform a.ply --signal f.csv --basis {family} --keep {keep} -o c.vtu");
            let Some(json) = report(folder, &line, &mut faults) else { continue };
            let line_back =
                format!("transform c.vtu --signal coefficient --basis {family} --inverse -o g.npy");
            let back = run_line(folder, &line_back);
            faults.inspect(&back);
            faults.expect(back.is_done(), || format!("{line_back}: {}", back.tail()));
            let Ok(bytes) = fs::read(folder.join("g.npy")) else { continue };
            let found: Vec<f64> = (bytes[bytes.len().saturating_sub(8 * n)..].chunks_exact(8))
                .map(|b| f64::from_le_bytes(b.try_into().unwrap()))
                .collect();
            let total: f64 = areas.iter().sum();
            let mean = areas.iter().zip(&values).map(|(m, v)| m * v).sum::<f64>() / total;
            let square = |of: &dyn Fn(usize) -> f64| (0..n).map(|x| areas[x] * of(x).powi(2)).sum::<f64>();
            let error = square(&|x| found[x] - values[x]) / square(&|x| values[x] - mean);
            let reported = number(&json, "/error");
            let error = error.sqrt();
            expect_between(&line, "error", reported, [error - DIGITS, error + DIGITS], &mut faults);
            let n_kept = (keep * n as f64).ceil();
            expect_between(&line, "kept", number(&json, "/kept"), [n_kept, n_kept], &mut faults);
            let file = read(&folder.join("c.vtu"));
            let field = |name: &str| file.field(name).map(adwave_io::Field::to_f64).unwrap_or_default();
            let [coefficients, levels, norms] = [field("coefficient"), field("level"), field("norm")];
            let n_nonzero = coefficients.iter().filter(|c| **c != 0.0).count() as f64;
            expect_between(&line, "coefficients that are not 0", n_nonzero, [0.0, n_kept], &mut faults);
            if keep < 1.0 {
                continue;
            }
            faults.expect(reported < 1e-9, || format!("{line}: all coefficients leave {reported}"));
            for level in 1..=number(&json, "/levels") as usize + 1 {
                let of_level = || (0..n).filter(|&i| levels[i] == level as f64);
                let square: f64 = of_level().map(|i| (coefficients[i] * norms[i]).powi(2)).sum();
                let at = |key: &str| number(&json, &format!("/{key}/{}", level - 1));
                let (norm, count) = (square.sqrt(), of_level().count() as f64);
                let limits = [norm * (1.0 - DIGITS), norm * (1.0 + DIGITS)];
                expect_between(&line, "norm of a level", at("norm"), limits, &mut faults);
                expect_between(&line, "coefficients", at("coefficients"), [count, count], &mut faults);
            }
        }
    }
    faults.finish();
}
