//! Laws of levels of quadrilaterals and their wavelets, with a literal Catmull–Clark subdivision beside them.

use crate::common::Random;
use adwave::Progress;
use adwave::shape::{MeshArea, Polygons, mesh_areas, triangulate};
use adwave_subdivision::{
    BorderCorners, Family, Hierarchy, LiftedWavelets, QuadParams, SubdivisionError, subdivide_polygons,
};
use std::collections::{BTreeMap, BTreeSet};

type Point = [f64; 3];
type Edge = [u32; 2];

/// Bound on details and on the distance from the control mesh, in units of the shape; rounding grows with the levels.
const EXACT: f64 = 1e-12;

/// Polygons with positions and sharp edges.
#[derive(Clone)]
pub(crate) struct PolygonMesh {
    pub(crate) points: Vec<Point>,
    pub(crate) faces: Vec<Vec<u32>>,
    pub(crate) creases: BTreeSet<Edge>,
}

fn edge(a: u32, b: u32) -> Edge {
    [a.min(b), a.max(b)]
}

fn mean(points: impl IntoIterator<Item = Point>) -> Point {
    let (mut sum, mut n) = ([0.0; 3], 0.0);
    for p in points {
        sum = [0, 1, 2].map(|k| sum[k] + p[k]);
        n += 1.0;
    }
    sum.map(|x| x / n)
}

impl PolygonMesh {
    fn new(points: &[Point], faces: &[&[u32]]) -> Self {
        let faces = faces.iter().map(|face| face.to_vec()).collect();
        Self { points: points.to_vec(), faces, creases: BTreeSet::new() }
    }

    pub(crate) fn polygons(&self) -> Polygons {
        self.faces.iter().map(Vec::as_slice).collect()
    }

    fn edges_of(face: &[u32]) -> Vec<Edge> {
        (0..face.len()).map(|k| edge(face[k], face[(k + 1) % face.len()])).collect()
    }

    /// One step of Catmull–Clark subdivision, rule by rule as published (`catmull1978`, `derose1998`).
    pub(crate) fn catmull_clark(&self, corners: BorderCorners) -> Self {
        let at = |v: u32| self.points[v as usize];
        let centers: Vec<Point> = self.faces.iter().map(|face| mean(face.iter().map(|&v| at(v)))).collect();
        let mut faces_of_edge: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
        for (f, face) in self.faces.iter().enumerate() {
            for e in Self::edges_of(face) {
                faces_of_edge.entry(e).or_default().push(f);
            }
        }
        let (mut edges_at, mut faces_at) =
            (vec![Vec::new(); self.points.len()], vec![Vec::new(); self.points.len()]);
        for e in faces_of_edge.keys() {
            for &v in e {
                edges_at[v as usize].push(*e);
            }
        }
        for (f, face) in self.faces.iter().enumerate() {
            for &v in face {
                faces_at[v as usize].push(f);
            }
        }
        let is_sharp = |e: &Edge| faces_of_edge[e].len() == 1 || self.creases.contains(e);
        let mut points = Vec::new();
        for v in 0..self.points.len() as u32 {
            let own = at(v);
            let (edges, faces) = (&edges_at[v as usize], &faces_at[v as usize]);
            let other = |e: &Edge| at(if e[0] == v { e[1] } else { e[0] });
            let sharp: Vec<&Edge> = edges.iter().filter(|e| is_sharp(e)).collect();
            let keeps = corners == BorderCorners::Sharp && faces.len() == 1;
            points.push(match sharp.len() {
                _ if keeps => own,
                0 | 1 => {
                    let n = edges.len() as f64;
                    let face = mean(faces.iter().map(|&f| centers[f]));
                    let middle = mean(edges.iter().map(|e| mean([own, other(e)])));
                    [0, 1, 2].map(|k| (face[k] + 2.0 * middle[k] + (n - 3.0) * own[k]) / n)
                }
                2 => {
                    let (a, b) = (other(sharp[0]), other(sharp[1]));
                    [0, 1, 2].map(|k| (a[k] + 6.0 * own[k] + b[k]) / 8.0)
                }
                _ => own,
            });
        }
        let finer = subdivide_polygons(self.points.len(), &self.polygons());
        let mut creases = BTreeSet::new();
        for (&[a, b], middle) in finer.edges.iter().zip(self.points.len() as u32..) {
            let e = edge(a, b);
            let ends = mean([at(a), at(b)]);
            points.push(if is_sharp(&e) {
                ends
            } else {
                let [f, g] = faces_of_edge[&e][..] else { panic!("two faces") };
                mean([at(a), at(b), centers[f], centers[g]])
            });
            if self.creases.contains(&e) {
                creases.extend([edge(a, middle), edge(b, middle)]);
            }
        }
        points.extend(centers);
        Self { points, faces: finer.faces.iter().map(<[u32]>::to_vec).collect(), creases }
    }

    fn subdivided(&self, n_levels: usize, corners: BorderCorners) -> Self {
        (0..n_levels).fold(self.clone(), |mesh, _| mesh.catmull_clark(corners))
    }

    /// The mesh with vertices and faces in another order, faces turned, and the place of each vertex.
    pub(crate) fn shuffled(&self, seed: u64) -> (Self, Vec<u32>) {
        let mut random = Random(seed);
        let mut places: Vec<u32> = (0..self.points.len() as u32).collect();
        random.shuffle(&mut places);
        let mut points = vec![[0.0; 3]; places.len()];
        for (p, &place) in self.points.iter().zip(&places) {
            points[place as usize] = *p;
        }
        let mut faces: Vec<Vec<u32>> = Vec::new();
        for face in &self.faces {
            let mut face: Vec<u32> = face.iter().map(|&v| places[v as usize]).collect();
            let turn = random.below(face.len());
            face.rotate_left(turn);
            if random.below(2) == 1 {
                face.reverse();
            }
            faces.push(face);
        }
        random.shuffle(&mut faces);
        let creases =
            self.creases.iter().map(|e| edge(places[e[0] as usize], places[e[1] as usize])).collect();
        (Self { points, faces, creases }, places)
    }

    fn hierarchy(&self, corners: BorderCorners) -> Result<Hierarchy, SubdivisionError> {
        let creases: Vec<Edge> = self.creases.iter().copied().collect();
        let params = QuadParams { points: Some(&self.points), creases: &creases, corners };
        Hierarchy::from_faces(self.points.len(), &self.polygons(), &params, Progress::none())
    }

    pub(crate) fn areas(&self) -> Vec<f64> {
        mesh_areas(&self.points, &triangulate(&self.points, &self.polygons()), MeshArea::Barycentric)
    }
}

pub(crate) fn cube() -> PolygonMesh {
    let points: Vec<Point> =
        (0..8_u8).map(|k| [0, 1, 2].map(|c| 2.0 * f64::from(k >> c & 1) - 1.0)).collect();
    let faces: [&[u32]; 6] =
        [&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5]];
    PolygonMesh::new(&points, &faces)
}

fn tetrahedron() -> PolygonMesh {
    let points = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.2]];
    PolygonMesh::new(&points, &[&[0, 1, 2], &[0, 2, 3], &[0, 3, 1], &[1, 3, 2]])
}

fn octahedron() -> PolygonMesh {
    let points = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.5],
        [0.0, 0.0, -1.0],
    ];
    let faces: [&[u32]; 8] =
        [&[0, 2, 4], &[2, 1, 4], &[1, 3, 4], &[3, 0, 4], &[2, 0, 5], &[1, 2, 5], &[3, 1, 5], &[0, 3, 5]];
    PolygonMesh::new(&points, &faces)
}

/// A prism over a regular polygon, without quadrilaterals but on its sides.
fn prism(n: u32) -> PolygonMesh {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k % n) / f64::from(n);
    let height = |k: u32| if k < n { -0.7 } else { 0.7 };
    let points: Vec<Point> = (0..2 * n).map(|k| [angle(k).cos(), angle(k).sin(), height(k)]).collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    PolygonMesh { points, faces, creases: BTreeSet::new() }
}

/// A sheet of n × m quadrilaterals with a border; without one, a torus.
fn sheet(n: u32, m: u32, wraps: bool) -> PolygonMesh {
    let (columns, rows) = if wraps { (n, m) } else { (n + 1, m + 1) };
    let vertex = |i: u32, j: u32| j % rows * columns + i % columns;
    let turn = |k: u32, of: u32| std::f64::consts::TAU * f64::from(k) / f64::from(of);
    let point = |v: u32| {
        let (i, j) = (v % columns, v / columns);
        let (x, y) = (f64::from(i), f64::from(j));
        if wraps {
            let radius = 3.0 + turn(j, m).cos();
            [turn(i, n).cos() * radius, turn(i, n).sin() * radius, turn(j, m).sin()]
        } else {
            [x, y + 0.1 * x * y, (0.8 * x).sin() * (0.6 * y).cos()]
        }
    };
    let faces = (0..m)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .map(|(i, j)| vec![vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
    let (faces, points) = (faces.collect(), (0..columns * rows).map(point).collect());
    PolygonMesh { points, faces, creases: BTreeSet::new() }
}

/// A cube with a roof of four triangles, and a hole in its floor.
fn house() -> PolygonMesh {
    let mut mesh = cube();
    mesh.points.push([0.1, 0.0, 2.0]);
    mesh.faces.remove(1);
    mesh.faces.remove(0);
    mesh.faces.extend([vec![4, 5, 8], vec![5, 7, 8], vec![7, 6, 8], vec![6, 4, 8]]);
    mesh
}

/// The cube with a closed crease around its top, one that ends inside, and a corner of three.
fn creased(mut mesh: PolygonMesh, creases: &[Edge]) -> PolygonMesh {
    mesh.creases = creases.iter().map(|&[a, b]| edge(a, b)).collect();
    mesh
}

fn control_meshes() -> Vec<(&'static str, PolygonMesh)> {
    vec![
        ("cube", cube()),
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("pentagonal prism", prism(5)),
        ("hexagonal prism", prism(6)),
        ("triangular prism", prism(3)),
        ("sheet", sheet(3, 2, false)),
        ("one quadrilateral", sheet(1, 1, false)),
        ("torus", sheet(5, 3, true)),
        ("house", house()),
        ("crease around the top", creased(cube(), &[[4, 5], [5, 7], [7, 6], [6, 4]])),
        ("crease that ends", creased(sheet(3, 5, false), &[[5, 9], [9, 13], [13, 14]])),
        ("corner of three", creased(cube(), &[[0, 1], [0, 2], [0, 4], [1, 5]])),
        ("all edges sharp", creased(tetrahedron(), &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])),
        ("crease from a border", creased(house(), &[[0, 4], [4, 8], [8, 7]])),
    ]
}

fn as_sets(faces: impl IntoIterator<Item = Vec<u32>>) -> Vec<Vec<u32>> {
    let sorted = |mut face: Vec<u32>| {
        face.sort_unstable();
        face
    };
    let mut sets: Vec<Vec<u32>> = faces.into_iter().map(sorted).collect();
    sets.sort();
    sets
}

fn largest_distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

#[test]
fn control_meshes_come_back_from_shuffled_subdivided_ones() {
    for (name, control) in control_meshes() {
        for &corners in BorderCorners::ALL {
            for n_levels in 2..=4 {
                check(name, &control, n_levels, corners);
            }
        }
    }
    for n_levels in [5, 6] {
        check("house", &house(), n_levels, BorderCorners::Smooth);
        let crease = creased(sheet(3, 3, false), &[[4, 5], [5, 9], [9, 10]]);
        check("sheet with a crease", &crease, n_levels, BorderCorners::Sharp);
    }
}

/// Checks all sizes, the control mesh, the details and the reconstruction.
fn check(name: &str, control: &PolygonMesh, n_levels: usize, corners: BorderCorners) {
    let mut meshes = vec![control.clone()];
    for k in 0..n_levels {
        meshes.push(meshes[k].catmull_clark(corners));
    }
    let (mesh, places) = meshes[n_levels].shuffled(n_levels as u64 + 7);
    let hierarchy = mesh.hierarchy(corners).unwrap();
    let name = format!("{name}, {n_levels} levels, {corners} corners");
    assert_eq!(hierarchy.n_levels(), n_levels, "{name}");
    for (level, expected) in meshes.iter().rev().enumerate() {
        assert_eq!(hierarchy.n_vertices(level), expected.points.len(), "{name}, level {level}");
        assert_eq!(hierarchy.n_faces(level), expected.faces.len(), "{name}, level {level}");
    }
    let vertices = hierarchy.vertices(n_levels).unwrap();
    let found = hierarchy.faces(n_levels).unwrap();
    let found = as_sets(found.iter().map(|face| face.iter().map(|&v| vertices[v as usize]).collect()));
    let expected = as_sets(
        control.faces.iter().map(|face| face.iter().map(|&v| places[v as usize]).collect::<Vec<u32>>()),
    );
    assert_eq!(found, expected, "{name}");
    let wavelets =
        LiftedWavelets::new(&hierarchy, Family::CatmullClark, &mesh.areas(), Progress::none()).unwrap();
    let field = mesh.points.as_flattened();
    let coefficients = wavelets.analyze(field, 3, Progress::none()).unwrap();
    let rows = coefficients.values.chunks_exact(3).zip(&coefficients.levels);
    let details = rows.filter(|(_, level)| **level as usize <= n_levels).flat_map(|(row, _)| row);
    let detail = details.fold(0.0_f64, |most, x| most.max(x.abs()));
    let own = |v: usize| &coefficients.values[places[v] as usize * 3..][..3];
    let distances = control.points.iter().enumerate().map(|(v, p)| largest_distance(own(v), p));
    let distance = distances.fold(0.0, f64::max);
    let again = wavelets.synthesize(&coefficients.values, 3, Progress::none()).unwrap();
    let error = largest_distance(&again, field);
    println!(
        "{name}: {} → {} vertices; control mesh {distance:.0e}, details {detail:.0e}, reconstruction {error:.0e}",
        mesh.points.len(),
        control.points.len(),
    );
    assert!(detail < EXACT && distance < EXACT && error < EXACT, "{name}: {detail:e} {distance:e} {error:e}");
}

#[test]
fn linear_wavelets_find_no_details_in_a_linear_subdivision() {
    let control = house();
    let mut mesh = control.clone();
    for _ in 0..3 {
        let finer = subdivide_polygons(mesh.points.len(), &mesh.polygons());
        let at = |v: u32| mesh.points[v as usize];
        let mut points = mesh.points.clone();
        points.extend(finer.edges.iter().map(|&[a, b]| mean([at(a), at(b)])));
        points.extend(mesh.faces.iter().map(|face| mean(face.iter().map(|&v| at(v)))));
        let faces = finer.faces.iter().map(<[u32]>::to_vec).collect();
        mesh = PolygonMesh { points, faces, creases: BTreeSet::new() };
    }
    let (mesh, places) = mesh.shuffled(5);
    let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
    let wavelets = LiftedWavelets::new(&hierarchy, Family::Linear, &mesh.areas(), Progress::none()).unwrap();
    let field = mesh.points.as_flattened();
    let coefficients = wavelets.analyze(field, 3, Progress::none()).unwrap();
    for (row, &level) in coefficients.values.chunks_exact(3).zip(&coefficients.levels) {
        assert!(level == 4 || row.iter().all(|x| x.abs() < 1e-14), "{row:?}");
    }
    for (p, &place) in control.points.iter().zip(&places) {
        assert!(largest_distance(&coefficients.values[3 * place as usize..][..3], p) < 1e-14);
    }
}

#[test]
fn any_field_comes_back_and_keeps_its_mean_on_all_levels() {
    for (name, control) in control_meshes() {
        let (mesh, _) = control.subdivided(3, BorderCorners::Smooth).shuffled(3);
        let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
        let mut random = Random(11);
        let field: Vec<f64> = mesh.points.iter().map(|_| random.number() - 0.5).collect();
        for family in [Family::Linear, Family::CatmullClark] {
            let wavelets = LiftedWavelets::new(&hierarchy, family, &mesh.areas(), Progress::none()).unwrap();
            let coefficients = wavelets.analyze(&field, 1, Progress::none()).unwrap();
            let again = wavelets.synthesize(&coefficients.values, 1, Progress::none()).unwrap();
            let error = largest_distance(&again, &field);
            assert!(error < 1e-11, "{name}, {family}: {error:e}");
            let total =
                |values: &[f64]| -> f64 { values.iter().zip(wavelets.masses()).map(|(x, m)| x * m).sum() };
            for level in 1..=3 {
                let coarse = wavelets.coarse_field(&field, 1, level, Progress::none()).unwrap();
                let smooth = wavelets.fine_field(&coarse, 1, level, Progress::none()).unwrap();
                assert!((total(&smooth) - total(&field)).abs() < 1e-12, "{name}, {family}, level {level}");
            }
        }
    }
}

#[test]
fn a_cube_and_an_octahedron_are_told_apart_by_their_positions() {
    for (control, n_corners) in [(cube(), 4), (octahedron(), 3)] {
        let (mesh, _) = control.subdivided(3, BorderCorners::Smooth).shuffled(9);
        let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
        assert!(hierarchy.parts()[0].is_ambiguous);
        assert!(hierarchy.faces(3).unwrap().iter().all(|face| face.len() == n_corners));
        // Without positions, quadrilaterals are preferred.
        let params = QuadParams::default();
        let blind =
            Hierarchy::from_faces(mesh.points.len(), &mesh.polygons(), &params, Progress::none()).unwrap();
        assert!(blind.faces(3).unwrap().iter().all(|face| face.len() == 4));
    }
}

#[test]
fn parents_are_the_corners_of_what_was_cut() {
    let (mesh, _) = house().subdivided(2, BorderCorners::Smooth).shuffled(1);
    let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
    for level in 0..2 {
        let (starts, parents) = hierarchy.parent_rows(level).unwrap();
        assert_eq!(starts.len(), hierarchy.n_vertices(level) + 1);
        let mut counts = BTreeMap::new();
        for pair in starts.windows(2) {
            let row = &parents[pair[0] as usize..pair[1] as usize];
            assert!(row.iter().all(|&v| (v as usize) < hierarchy.n_vertices(level + 1)));
            *counts.entry(row.len()).or_insert(0) += 1;
        }
        assert_eq!(counts[&1], hierarchy.n_vertices(level + 1));
        let faces = hierarchy.faces(level + 1).unwrap();
        for n in [3, 4] {
            let of_n = faces.iter().filter(|face| face.len() == n).count();
            assert_eq!(counts.get(&n).copied().unwrap_or(0), of_n, "level {level}");
        }
    }
    assert_eq!(hierarchy.parents(0).unwrap_err(), SubdivisionError::PairsOfQuads);
}

#[test]
fn parts_have_their_own_number_of_levels() {
    let mut mesh = cube().subdivided(3, BorderCorners::Smooth);
    for part in [house().subdivided(1, BorderCorners::Smooth), prism(5), tetrahedron()] {
        let first = mesh.points.len() as u32;
        mesh.points.extend(&part.points);
        mesh.faces.extend(part.faces.iter().map(|face| face.iter().map(|v| v + first).collect()));
    }
    let (mesh, _) = mesh.shuffled(3);
    let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
    let mut levels: Vec<usize> = hierarchy.parts().iter().map(|part| part.n_levels).collect();
    levels.sort_unstable();
    assert_eq!(levels, [0, 0, 1, 3]);
    assert_eq!(hierarchy.n_vertices(3), 8 + 9 + 10 + 4);
    let wavelets =
        LiftedWavelets::new(&hierarchy, Family::CatmullClark, &mesh.areas(), Progress::none()).unwrap();
    let coefficients = wavelets.analyze(mesh.points.as_flattened(), 3, Progress::none()).unwrap();
    let again = wavelets.synthesize(&coefficients.values, 3, Progress::none()).unwrap();
    assert!(largest_distance(&again, mesh.points.as_flattened()) < EXACT);
}

#[test]
fn meshes_without_levels_and_wrong_requests_are_refused_in_one_line() {
    let text = |mesh: &PolygonMesh| mesh.hierarchy(BorderCorners::Smooth).unwrap_err().to_string();
    for (mesh, named) in [
        (cube(), "no levels of subdivision"),
        (prism(5), "corners"),
        (sheet(3, 5, false), "no levels of subdivision"),
        (sheet(5, 5, true), "both a coarse vertex and a new one"),
    ] {
        let text = text(&mesh);
        assert!(text.contains(named) && !text.contains('\n'), "{text}");
    }
    let mut wrong = cube().subdivided(1, BorderCorners::Smooth);
    wrong.creases.insert([0, 1]);
    assert_eq!(text(&wrong), "a crease is given between vertices 0 and 1, and the mesh has no edge there");
    let mut two = cube().subdivided(1, BorderCorners::Smooth);
    two.faces.push(vec![0, 1]);
    assert!(text(&two).contains("face 24 has 2"), "{}", text(&two));
    let mesh = cube().subdivided(2, BorderCorners::Smooth);
    let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
    for family in [Family::Butterfly, Family::Loop, Family::Haar, Family::Irregular] {
        let refused = LiftedWavelets::new(&hierarchy, family, &mesh.areas(), Progress::none()).unwrap_err();
        assert!(matches!(refused, SubdivisionError::Family { .. }), "{refused}");
    }
}

/// A sheet with random faces removed or cut: the search ends, and what it finds has the right counts.
#[test]
fn no_mesh_makes_the_search_fail_in_another_way() {
    for seed in 0..200 {
        let mut random = Random(seed);
        let mut mesh = sheet(8, 8, seed % 2 == 0);
        for _ in 0..random.below(5) {
            let k = random.below(mesh.faces.len());
            let face = mesh.faces.swap_remove(k);
            if random.below(3) == 0 && face.len() == 4 {
                mesh.faces.push(face[..3].to_vec());
                mesh.faces.push(vec![face[0], face[2], face[3]]);
            }
        }
        if let Ok(hierarchy) = mesh.hierarchy(BorderCorners::Smooth) {
            for level in 0..hierarchy.n_levels() {
                let (starts, _) = hierarchy.parent_rows(level).unwrap();
                assert_eq!(starts.len(), hierarchy.n_vertices(level) + 1);
                assert!(hierarchy.n_vertices(level + 1) < hierarchy.n_vertices(level));
            }
        }
    }
}

#[test]
fn the_basis_is_stable() {
    // A little above the measured conditions of three levels; those of vertices of three faces side by side are large.
    for (control, limits) in [
        (cube(), [15.5, 740.0]),
        (prism(5), [16.5, 690.0]),
        (sheet(3, 2, false), [11.0, 90.0]),
        (sheet(5, 3, true), [13.5, 190.0]),
        (house(), [11.5, 175.0]),
    ] {
        let mesh = control.subdivided(3, BorderCorners::Smooth);
        let hierarchy = mesh.hierarchy(BorderCorners::Smooth).unwrap();
        for (family, limit) in [Family::Linear, Family::CatmullClark].into_iter().zip(limits) {
            let wavelets = LiftedWavelets::new(&hierarchy, family, &mesh.areas(), Progress::none()).unwrap();
            let condition = wavelets.riesz_bounds(Progress::none()).unwrap().condition();
            assert!(condition < limit, "{family}: {condition}");
        }
    }
}
