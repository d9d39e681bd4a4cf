use super::*;
use crate::shape::{Mesh, Shape, WeldMode};

/// Rounding of a volume of a few triangles, relative to it.
const ROUNDING: f64 = 1e-14;

fn is_close(found: Option<f64>, volume: f64) -> bool {
    found.is_some_and(|found| (found - volume).abs() <= ROUNDING * volume.abs())
}

/// Cube of edge 2 · `half` about `center`, of squares; `is_inward` turns them.
fn push_cube(points: &mut Vec<[f64; 3]>, faces: &mut Polygons, center: [f64; 3], half: f64, is_inward: bool) {
    let first = points.len() as u32;
    for k in 0..8 {
        points.push(std::array::from_fn(|c| center[c] + if k >> c & 1 == 1 { half } else { -half }));
    }
    for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        let mut corners: Vec<u32> = face.iter().map(|k| first + k).collect();
        if is_inward {
            corners.reverse();
        }
        faces.push(&corners);
    }
}

fn parts_of(points: Vec<[f64; 3]>, faces: &Polygons) -> SurfaceParts {
    let mesh = Shape::Mesh(Mesh::new(points, faces.clone()).unwrap());
    let geometry = PreparedGeometry::new(&mesh, WeldMode::default(), Progress::none()).unwrap();
    surface_parts(&geometry, Progress::none()).unwrap()
}

/// Parts of cubes: center on the x axis, half of the edge, and whether the faces point inward.
fn cubes(list: &[(f64, f64, bool)]) -> SurfaceParts {
    let (mut points, mut faces) = (Vec::new(), Polygons::new());
    for &(x, half, is_inward) in list {
        push_cube(&mut points, &mut faces, [x, 0.0, 0.0], half, is_inward);
    }
    parts_of(points, &faces)
}

#[test]
fn cubes_have_their_volumes_and_the_inward_one_is_named() {
    let found = cubes(&[(0.0, 1.0, false), (5.0, 0.5, true), (9.0, 1.5, false)]);
    for (part, volume) in found.parts.iter().zip([8.0, -1.0, 27.0]) {
        assert!(is_close(part.volume, volume), "{part:?}");
    }
    assert_eq!(found.inward(), [8]);
    assert!(found.parts.iter().all(|part| part.n_faces == 6));
    assert_eq!(found.of_vertex[7..9], [0, 1]);
}

#[test]
fn the_wall_of_a_cavity_shares_the_verdict_of_the_part_around_it() {
    // A hollow cube is right, and so is a cube in its cavity.
    assert_eq!(cubes(&[(0.0, 3.0, false), (0.0, 2.0, true), (0.0, 1.0, false)]).inward(), [0; 0]);
    // Turned as a whole, all three are wrong.
    assert_eq!(cubes(&[(0.0, 3.0, true), (0.0, 2.0, false), (0.0, 1.0, true)]).inward(), [0, 8, 16]);
    // Two bodies, one inside of the other, each turned: no cavity.
    assert_eq!(cubes(&[(0.0, 3.0, true), (0.0, 1.0, true)]).inward(), [0, 8]);
    // The smallest part around counts, whatever the order in the file.
    assert_eq!(cubes(&[(0.0, 1.0, true), (0.0, 3.0, true), (0.0, 2.0, true)]).inward(), [0, 8, 16]);
    assert_eq!(cubes(&[(0.0, 1.0, true), (0.0, 3.0, true), (0.0, 2.0, false)]).inward(), [0, 8, 16]);
}

#[test]
fn parts_beside_each_other_are_not_nested() {
    // The ray from each cube passes through all further ones, and along their faces and edges.
    let row: Vec<(f64, f64, bool)> = (0..9).map(|k| (3.0 * f64::from(k), 1.0, k % 2 == 1)).collect();
    assert_eq!(cubes(&row).inward(), [8, 24, 40, 56]);
}

#[test]
fn an_open_part_has_no_volume_and_leaves_the_others_theirs() {
    let (mut points, mut faces) = (Vec::new(), Polygons::new());
    push_cube(&mut points, &mut faces, [0.0; 3], 1.0, true);
    points.extend([[9.0, 0.0, 0.0], [9.0, 1.0, 0.0], [9.0, 0.0, 1.0]]);
    faces.push(&[8, 9, 10]);
    points.push([20.0; 3]);
    let found = parts_of(points, &faces);
    assert!(is_close(found.parts[0].volume, -8.0), "{found:?}");
    assert_eq!(found.parts[1].volume, None);
    assert_eq!(found.inward(), [0]);
    assert_eq!(found.of_vertex[11], SurfaceParts::NO_PART);
    let flags = found.faces_of(&[8], &faces).unwrap();
    assert_eq!(flags.iter().filter(|is_chosen| **is_chosen).count(), 1);
    assert!(flags[6]);
    for (vertex, message) in [
        (3, "vertex 3 must be the first one of its part; the part begins at vertex 0"),
        (11, "vertex 11 must be a corner of a face; choose the first vertex of a part of the surface"),
        (12, "vertex 12 must be below 12, the number of vertices; choose another one"),
    ] {
        assert_eq!(found.faces_of(&[vertex], &faces).unwrap_err().to_string(), message);
    }
}

#[test]
fn a_soup_of_polygons_is_one_part() {
    let (mut points, mut faces) = (Vec::new(), Polygons::new());
    push_cube(&mut points, &mut faces, [0.0; 3], 1.0, true);
    let soup: Vec<[f64; 3]> = faces.corners().iter().map(|&v| points[v as usize]).collect();
    let mut separate = Polygons::new();
    for f in 0..6 {
        separate.push(&[4 * f, 4 * f + 1, 4 * f + 2, 4 * f + 3]);
    }
    let found = parts_of(soup, &separate);
    assert_eq!((found.parts.len(), found.parts[0].n_faces), (1, 6));
    assert!(is_close(found.parts[0].volume, -8.0), "{found:?}");
    assert_eq!(found.inward(), [0]);
}
