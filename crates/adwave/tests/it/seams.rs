//! Seams of nearly coincident vertices: closed by default, and nothing else is joined.

use adwave::Progress;
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};

fn prepared(points: &[[f64; 3]], faces: &[[u32; 3]], weld: WeldMode) -> PreparedGeometry {
    let mesh = Mesh::new(points.to_vec(), Polygons::from_triangles(faces)).unwrap();
    PreparedGeometry::new(&Shape::Mesh(mesh), weld, Progress::none()).unwrap()
}

fn default(points: &[[f64; 3]], faces: &[[u32; 3]]) -> PreparedGeometry {
    prepared(points, faces, WeldMode::default())
}

/// Numbers from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 31)
    }
}

/// A sphere by longitude and latitude, whose columns at 0° and 360° are copies; the poles are one vertex per column.
fn sphere(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>, Vec<u32>) {
    let rows = n / 2;
    let at = |i: u32, j: u32| i * (rows + 1) + j;
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for i in 0..=n {
        for j in 0..=rows {
            let (u, v) = (
                std::f64::consts::TAU * f64::from(i % n) / f64::from(n),
                std::f64::consts::PI * f64::from(j) / f64::from(rows),
            );
            let ring = if j % rows == 0 { 0.0 } else { v.sin() };
            points.push([ring * u.cos(), ring * u.sin(), v.cos()]);
        }
    }
    for i in 0..n {
        for j in 0..rows {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            if j > 0 {
                faces.push([a, d, b]);
            }
            if j + 1 < rows {
                faces.push([b, d, c]);
            }
        }
    }
    // No face uses the last copy of the south pole.
    (points, faces, (at(n, 0)..=at(n, rows)).collect())
}

/// Moves some vertices by steps of 32-bit floats.
fn perturb(points: &mut [[f64; 3]], vertices: &[u32], steps: f64, random: &mut Random) {
    for &v in vertices {
        for c in &mut points[v as usize] {
            *c += (2.0 * random.next() - 1.0) * steps * f64::from(f32::EPSILON);
        }
    }
}

#[test]
fn a_seam_that_differs_by_rounding_is_closed() {
    let mut random = Random(1);
    for (n, scale, offset) in
        [(16, 1.0, 0.0), (64, 37.0, 0.0), (40, 0.01, 0.5), (24, 1e-9, 0.0), (24, 1e12, 0.0)]
    {
        let (exact, faces, seam) = sphere(n);
        let mut near = exact.clone();
        perturb(&mut near, &seam, 0.5, &mut random);
        let place = |points: &[[f64; 3]]| -> Vec<[f64; 3]> {
            points.iter().map(|p| p.map(|c| (c + offset) * scale)).collect()
        };
        let (exact, near) = (default(&place(&exact), &faces), default(&place(&near), &faces));
        assert!(exact.seams().is_none());
        let seams = near.seams().unwrap_or_else(|| panic!("{n} {scale} {offset}"));
        assert_eq!(near.n_vertices(), exact.n_vertices(), "{n} {scale} {offset}");
        assert!(seams.distance < 4.0 * f64::from(f32::EPSILON) * scale * (1.0 + offset));
        let off = prepared(&place(&sphere(n).0), &faces, WeldMode::Off);
        assert!(off.seams().is_none() && off.n_vertices() > exact.n_vertices());
    }
}

#[test]
fn triangles_alone_that_differ_by_rounding_become_one_surface() {
    // As an STL whose corners went through different products of matrices.
    let (points, faces, _) = sphere(20);
    let mut random = Random(2);
    let mut soup: Vec<[f64; 3]> = faces.iter().flatten().map(|&v| points[v as usize]).collect();
    let all: Vec<u32> = (0..soup.len() as u32).collect();
    perturb(&mut soup, &all, 0.5, &mut random);
    let triangles: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let welded = default(&soup, &triangles);
    assert_eq!(welded.n_vertices(), default(&points, &faces).n_vertices());
    assert_eq!(prepared(&soup, &triangles, WeldMode::EqualPositions).n_vertices(), soup.len());
}

/// A square of n × n quads in the plane z = `z`, each cut in two.
fn plate(n: u32, z: f64, is_flipped: bool) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let points =
        (0..(n + 1) * (n + 1)).map(|k| [f64::from(k % (n + 1)), f64::from(k / (n + 1)), z]).collect();
    let quads = (0..n * n).map(|k| k / n * (n + 1) + k % n);
    let faces = quads
        .flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]])
        .map(|[a, b, c]| if is_flipped { [a, c, b] } else { [a, b, c] });
    (points, faces.collect())
}

#[test]
fn sheets_side_by_side_stay_apart() {
    // Two plates in the same direction, closer than any tolerance.
    let (mut points, mut faces) = plate(6, 0.0, false);
    let (more, more_faces) = plate(6, 1e-9, false);
    let n = points.len() as u32;
    points.extend(more);
    faces.extend(more_faces.iter().map(|face| face.map(|v| v + n)));
    assert!(default(&points, &faces).seams().is_none());
    assert!(prepared(&points, &faces, WeldMode::Within(0.1)).seams().is_none());
}

#[test]
fn inner_vertices_and_far_borders_stay_apart() {
    // A closed sphere inside another one that is larger by two steps of rounding: no borders, nothing to weld.
    let (points, faces, _) = sphere(16);
    let n = points.len() as u32;
    let mut two = points.clone();
    two.extend(points.iter().map(|p| p.map(|c| c * (1.0 + 2.0 * f64::from(f32::EPSILON)))));
    let both: Vec<[u32; 3]> = faces.iter().copied().chain(faces.iter().map(|f| f.map(|v| v + n))).collect();
    assert!(default(&two, &both).seams().is_none());
    // A gap of a hundredth of an edge stays open by default, and is closed on request.
    let (mut points, mut faces) = plate(4, 0.0, false);
    let (more, more_faces) = plate(4, 0.0, false);
    let n = points.len() as u32;
    points.extend(more.iter().map(|p| [p[0] + 4.01, p[1], p[2]]));
    faces.extend(more_faces.iter().map(|face| face.map(|v| v + n)));
    assert!(default(&points, &faces).seams().is_none());
    let asked = prepared(&points, &faces, WeldMode::Within(0.02));
    assert_eq!(asked.seams().map(|seams| seams.n_vertices), Some(5));
    assert!(prepared(&points, &faces, WeldMode::Within(0.005)).seams().is_none());
}

#[test]
fn no_tolerance_makes_two_corners_of_a_face_one() {
    let mut random = Random(3);
    for n in [2, 3, 7] {
        let (mut points, faces) = plate(n, 0.0, false);
        for p in &mut points {
            p[2] = random.next();
        }
        for tolerance in [0.1, 1.0, 1e6, f64::MAX] {
            let geometry = prepared(&points, &faces, WeldMode::Within(tolerance));
            for triangle in geometry.triangles() {
                assert!(
                    triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0]
                );
            }
        }
    }
}

#[test]
fn coordinates_of_a_map_are_not_welded_across_their_steps() {
    // UTM in metres with vertices a centimetre apart: a step of a 32-bit float is half a metre there.
    let (mut points, mut faces) = plate(8, 0.0, false);
    let (more, more_faces) = plate(8, 0.0, true);
    let n = points.len() as u32;
    points.extend(more.iter().map(|p| [p[0] + 8.5, p[1], p[2]]));
    faces.extend(more_faces.iter().map(|face| face.map(|v| v + n)));
    let points: Vec<[f64; 3]> =
        points.iter().map(|p| [500_000.0 + 0.01 * p[0], 5_400_000.0 + 0.01 * p[1], 100.0 + p[2]]).collect();
    assert!(default(&points, &faces).seams().is_none());
}
