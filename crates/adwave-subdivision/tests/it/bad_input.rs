//! Meshes and fields that cannot be used, each with its reason.

use crate::common::{TestMesh, areas, fan, octahedron, tetrahedron};
use adwave::Progress;
use adwave::shape::{Mesh, Polygons};
use adwave_subdivision::{
    Family, HaarWavelets, Hierarchy, LiftedWavelets, Obstacle, SubdivisionError, WeldedMesh,
};
use std::sync::atomic::AtomicBool;

fn refused(mesh: &TestMesh) -> SubdivisionError {
    Hierarchy::new(mesh.points.len(), &mesh.triangles, Progress::none()).expect_err("no levels")
}

#[test]
fn a_flipped_edge_destroys_the_levels() {
    let mut mesh = octahedron().cut(3);
    // The faces of the edge between corners 0 and 1 of face 7 get its other diagonal.
    let [a, b, c] = mesh.triangles[7];
    let (other, t) = mesh
        .triangles
        .iter()
        .enumerate()
        .find(|(f, t)| *f != 7 && t.contains(&a) && t.contains(&b))
        .map(|(f, t)| (f, *t))
        .unwrap();
    let d = t.into_iter().find(|v| *v != a && *v != b).unwrap();
    mesh.triangles[7] = [a, d, c];
    mesh.triangles[other] = [d, b, c];
    assert!(matches!(refused(&mesh), SubdivisionError::NoLevels { .. }));
}

#[test]
fn holes_odd_borders_and_t_junctions_are_refused_with_a_reason() {
    let mut hole = octahedron().cut(3);
    hole.triangles.remove(43);
    let text = refused(&hole).to_string();
    assert!(text.starts_with("the mesh has no levels of subdivision: ") && text.contains("vertex"), "{text}");
    // A border of odd length: nine triangles around a vertex, not cut.
    assert!(matches!(refused(&fan(9)), SubdivisionError::NoLevels { .. }));
    // One face cut, its neighbors not.
    let mut junction = tetrahedron().cut(1);
    let [a, b, c] = junction.triangles[3];
    junction.points.push([0.0; 3]);
    let m = junction.points.len() as u32 - 1;
    junction.triangles[3] = [a, m, c];
    junction.triangles.push([m, b, c]);
    assert!(matches!(refused(&junction), SubdivisionError::NoLevels { .. }));
    // Where nothing can be coarser there is a vertex that says so.
    match refused(&octahedron()) {
        SubdivisionError::NoLevels { obstacle: Obstacle::Valence { n_neighbors: 4, .. } } => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn surfaces_that_are_no_manifold_are_refused() {
    let mut book = fan(6).cut(1);
    let [a, b, _] = book.triangles[0];
    book.points.push([0.0, 0.0, 1.0]);
    book.triangles.push([a, b, book.points.len() as u32 - 1]);
    let n_faces =
        if matches!(refused(&book), SubdivisionError::ManyFaces { n_faces: 3, .. }) { 3 } else { 2 };
    // The edge of the first face lies inside or on the border; on a border the book has two pages only.
    assert!(n_faces == 3 || matches!(refused(&book), SubdivisionError::NoLevels { .. }));
    let mut pinched = tetrahedron().cut(1);
    let first = pinched.points.len() as u32 - 1;
    let mut other = tetrahedron().cut(1);
    let name = |v: u32| if v == 0 { 0 } else { v + first };
    pinched.triangles.extend(other.triangles.iter().map(|t| t.map(name)));
    pinched.points.extend(other.points.drain(1..));
    match refused(&pinched) {
        SubdivisionError::NoLevels { obstacle: Obstacle::Pinched { vertex: 0 } } => {}
        error => panic!("{error}"),
    }
    let mut twice = tetrahedron().cut(1);
    twice.triangles[2] = [1, 1, 4];
    assert_eq!(refused(&twice), SubdivisionError::RepeatedCorner { face: 2, vertex: 1 });
    twice.triangles[2] = [1, 99, 4];
    assert!(matches!(refused(&twice), SubdivisionError::IndexOutOfRange { face: 2, index: 99, .. }));
    let empty = TestMesh { points: vec![[0.0; 3]; 4], triangles: Vec::new() };
    assert_eq!(refused(&empty), SubdivisionError::NoFaces);
}

#[test]
fn a_quadrilateral_alone_has_no_levels() {
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut faces = Polygons::new();
    faces.push(&[0, 1, 2, 3]);
    let mesh = Mesh::new(points, faces).unwrap();
    let error = Hierarchy::from_mesh(&mesh, Progress::none()).unwrap_err();
    assert!(error.to_string().starts_with("the mesh has no levels of subdivision: vertex"), "{error}");
    let welded = WeldedMesh::new(&mesh);
    assert_eq!((welded.faces.len(), welded.triangles.len()), (1, 2));
}

#[test]
fn seams_are_welded_first() {
    // A tetrahedron whose faces share no vertices.
    let cut = tetrahedron().cut(2);
    let points: Vec<[f64; 3]> =
        cut.triangles.iter().flat_map(|t| t.map(|v| cut.points[v as usize])).collect();
    let triangles: Vec<[u32; 3]> =
        (0..cut.triangles.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let mesh = Mesh::new(points.clone(), Polygons::from_triangles(&triangles)).unwrap();
    assert!(Hierarchy::from_mesh(&mesh, Progress::none()).is_err());
    let welded = WeldedMesh::new(&mesh);
    assert_eq!(welded.vertices.len(), cut.points.len());
    let hierarchy = Hierarchy::new(welded.vertices.len(), &welded.triangles, Progress::none()).unwrap();
    assert_eq!(hierarchy.n_levels(), 2);
    let field: Vec<f64> = points.iter().map(|p| p[0] + 2.0 * p[1]).collect();
    let gathered = welded.gather(&field, 1).unwrap();
    assert_eq!(welded.scatter(&gathered, 1), field);
    let mut torn = field;
    torn[welded.of_vertex.iter().rposition(|&w| w == 0).unwrap()] += 1.0;
    assert!(matches!(welded.gather(&torn, 1), Err(SubdivisionError::Seam { first: 0, .. })));
}

#[test]
fn fields_and_areas_that_do_not_fit_are_refused() {
    let mesh = octahedron().cut(2);
    let (hierarchy, none) = (mesh.hierarchy(), Progress::none());
    let n = mesh.points.len();
    let wavelets = LiftedWavelets::new(&hierarchy, Family::Butterfly, &areas(&mesh), none).unwrap();
    let mut field = vec![1.0; n];
    field[5] = f64::NAN;
    let text = wavelets.analyze(&field, 1, none).unwrap_err().to_string();
    assert!(text.contains("of 5 is NaN"), "{text}");
    assert!(wavelets.analyze(&field[1..], 1, none).is_err());
    assert!(wavelets.analyze(&[], 0, none).is_err());
    assert!(wavelets.coarse_field(&vec![0.0; n], 1, 3, none).is_err());
    let mut negative = areas(&mesh);
    negative[3] = -1.0;
    let error = LiftedWavelets::new(&hierarchy, Family::Linear, &negative, none).unwrap_err();
    assert_eq!(error, SubdivisionError::NegativeMass { element: 3, value: -1.0 });
    for family in [Family::Haar, Family::Irregular] {
        assert!(LiftedWavelets::new(&hierarchy, family, &areas(&mesh), none).is_err(), "{family}");
    }
    assert!(HaarWavelets::new(&hierarchy, &[1.0; 5]).is_err());
    let coefficients = wavelets.analyze(&vec![1.0; n], 1, none).unwrap();
    assert!(coefficients.keep(1.5).is_err() && coefficients.keep(f64::NAN).is_err());
}

#[test]
fn areas_of_zero_leave_everything_finite() {
    let mesh = octahedron().cut(3);
    let (hierarchy, none) = (mesh.hierarchy(), Progress::none());
    let n = mesh.points.len();
    let field: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let mut some = areas(&mesh);
    some[..n / 2].fill(0.0);
    for masses in [vec![0.0; n], some, vec![1e300; n], vec![1e-300; n]] {
        for family in [Family::Linear, Family::Butterfly, Family::Loop] {
            let wavelets = LiftedWavelets::new(&hierarchy, family, &masses, none).unwrap();
            let coefficients = wavelets.analyze(&field, 1, none).unwrap();
            assert!(coefficients.values.iter().chain(&coefficients.norms).all(|x| x.is_finite()));
            let back = wavelets.synthesize(&coefficients.values, 1, none).unwrap();
            assert!(back.iter().zip(&field).all(|(a, b)| (a - b).abs() < 1e-6), "{family}");
        }
    }
}

#[test]
fn vertices_of_many_neighbors_cost_no_more_than_they_are_allowed_to() {
    let none = Progress::none();
    let mesh = fan(900).cut(1);
    let (hierarchy, masses) = (mesh.hierarchy(), areas(&mesh));
    for family in [Family::Linear, Family::Butterfly, Family::Loop] {
        let wavelets = LiftedWavelets::new(&hierarchy, family, &masses, none).unwrap();
        let found = wavelets.analyze(&masses, 1, none).unwrap();
        let back = wavelets.synthesize(&found.values, 1, none).unwrap();
        assert!(back.iter().zip(&masses).all(|(a, b)| (a - b).abs() < 1e-13), "{family}");
    }
    let crowded = fan(20_000).cut(1);
    let error = LiftedWavelets::new(&crowded.hierarchy(), Family::Loop, &areas(&crowded), none).unwrap_err();
    assert_eq!(error, SubdivisionError::Crowded { vertex: 0, n_neighbors: 20_000, most: 1000 });
    assert!(
        LiftedWavelets::new_irregular(&crowded.points, &crowded.triangles, &areas(&crowded), none).is_ok()
    );
}

#[test]
fn every_call_can_be_cancelled() {
    let stop = AtomicBool::new(true);
    let (mesh, stopped) = (octahedron().cut(3), Progress::none().with_cancel(&stop));
    let cancelled = |error: SubdivisionError| matches!(error, SubdivisionError::Cancelled(_));
    assert!(cancelled(Hierarchy::new(mesh.points.len(), &mesh.triangles, stopped).unwrap_err()));
    let (hierarchy, masses) = (mesh.hierarchy(), areas(&mesh));
    for family in [Family::Butterfly, Family::Loop] {
        assert!(cancelled(LiftedWavelets::new(&hierarchy, family, &masses, stopped).unwrap_err()));
        let wavelets = LiftedWavelets::new(&hierarchy, family, &masses, Progress::none()).unwrap();
        assert!(cancelled(wavelets.analyze(&masses, 1, stopped).unwrap_err()));
        assert!(cancelled(wavelets.synthesize(&masses, 1, stopped).unwrap_err()));
    }
    assert!(cancelled(
        LiftedWavelets::new_irregular(&mesh.points, &mesh.triangles, &masses, stopped).unwrap_err()
    ));
}
