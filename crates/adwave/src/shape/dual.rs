//! Dual graph of a mesh: its faces as nodes, joined across the sides that they share.
//!
//! The flux between two faces is `w·(f_y − f_x)` with `w = |e|/h` (`eymard2000`): |e| is the length of the shared side,
//! and h the sum of the distances of the two centers from it. The centers of triangles are their circumcenters, which a
//! line across the side connects, so that the flux of a slope is right; if an angle is obtuse it is the middle of the
//! longest side, so that h stays positive. Other faces use their centers of area. Fluxes cancel in pairs, so the
//! integral of a field is kept.

use super::face_incidence::{centered, vector_area};
use super::{Graph, GraphError, Mesh, PreparedGeometry, Shape, WeldMode};
use crate::Progress;
use crate::parallel::{self, expect_not_cancelled};
use nalgebra::Vector3;

/// Largest number of faces at one side that are joined in pairs; more faces are joined in a row.
const MOST_PAIRED: usize = 8;

/// Largest weight. Two right triangles with the same circumcenter conduct without resistance, and the number of
/// products of a diffusion grows with the root of the largest weight.
const MAX_WEIGHT: f64 = 30.0;

/// Builds the dual graph of a mesh: node f is face f at its center of area, with its area in squared model units, and
/// faces that share a side are neighbors. Two sides are one if their ends are at equal positions, or welded along a
/// seam.
///
/// On this graph fields of faces diffuse as fields of vertices do on the surface, with faces weighted by area. Faces
/// of fewer than three corners have no neighbors. O(n log n).
///
/// # Errors
/// [`GraphError`] if the mesh has no faces.
///
/// ```
/// use adwave::shape::{Mesh, Polygons, dual_graph};
/// let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]];
/// let faces: Polygons = [[0, 1, 2, 3].as_slice(), &[1, 4, 5, 2]].into_iter().collect();
/// let dual = dual_graph(&Mesh::new(points, faces)?)?;
/// assert_eq!(dual.neighbors(0).collect::<Vec<_>>(), [(1, 1.0)]); // a side of length 1, centers 1 apart
/// assert_eq!(dual.cell_areas(), Some([1.0, 1.0].as_slice()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn dual_graph(mesh: &Mesh) -> Result<Graph, GraphError> {
    let (points, faces) = (mesh.points(), mesh.faces());
    let shape = Shape::Mesh(mesh.clone());
    let geometry = expect_not_cancelled(PreparedGeometry::new(&shape, WeldMode::default(), Progress::none()));
    let centers: Vec<[f64; 3]> = parallel_faces(faces.len(), |f| center(points, faces.get(f)));
    // Squares of areas would overflow in the unit of the model.
    let unit = geometry.size_unit();
    let scaled: Vec<[f64; 3]> = parallel_faces(points.len(), |x| points[x].map(|c| c / unit));
    let areas: Vec<f64> =
        parallel_faces(faces.len(), |f| vector_area(&scaled, faces.get(f)).norm() * unit * unit);
    let mut sides = sides(mesh, geometry.vertex_map().as_slice());
    expect_not_cancelled(parallel::sort_by(&mut sides, Progress::none(), |a, b| {
        (a.ends, a.face).cmp(&(b.ends, b.face))
    }));
    let mut edges = Vec::with_capacity(sides.len() / 2);
    for group in sides.chunk_by(|a, b| a.ends == b.ends) {
        let weight = |f: &FaceSide, g: &FaceSide| {
            let [p, q] = f.corners.map(|corner| Vector3::from(scaled[corner as usize]));
            let length = (q - p).norm();
            let across: f64 =
                [f, g].map(|side| center_distance(&scaled, faces.get(side.face as usize), side)).iter().sum();
            if length > 0.0 { length / across.max(length / MAX_WEIGHT) } else { 0.0 }
        };
        let mut join = |f: &FaceSide, g: &FaceSide, share: f64| {
            if f.face != g.face {
                edges.push((f.face, g.face, share * weight(f, g)));
            }
        };
        if group.len() > MOST_PAIRED {
            group.windows(2).for_each(|pair| join(&pair[0], &pair[1], 1.0));
            continue;
        }
        for (k, f) in group.iter().enumerate() {
            for g in &group[k + 1..] {
                join(f, g, 1.0 / (group.len() - 1) as f64);
            }
        }
    }
    Graph::new(faces.len(), &edges)?.with_cells(centers, areas)
}

/// Side of a face.
#[derive(Clone, Copy)]
struct FaceSide {
    /// Welded vertices at its ends, the smaller one first.
    ends: [u32; 2],
    /// Vertices of the mesh at these ends.
    corners: [u32; 2],
    face: u32,
}

/// Sides of all faces whose ends are different welded vertices.
fn sides(mesh: &Mesh, welded: &[u32]) -> Vec<FaceSide> {
    let mut sides = Vec::with_capacity(mesh.faces().corners().len());
    for (face, corners) in (0..).zip(mesh.faces().iter()) {
        if corners.len() < 3 {
            continue;
        }
        for k in 0..corners.len() {
            let pair = [corners[k], corners[(k + 1) % corners.len()]];
            let [a, b] = pair.map(|corner| welded[corner as usize]);
            match a.cmp(&b) {
                std::cmp::Ordering::Less => sides.push(FaceSide { ends: [a, b], corners: pair, face }),
                std::cmp::Ordering::Greater => {
                    sides.push(FaceSide { ends: [b, a], corners: [pair[1], pair[0]], face });
                }
                std::cmp::Ordering::Equal => {}
            }
        }
    }
    sides
}

/// Distance of the center of a face from one of its sides (see the module), in the unit of `points`; ≥ 0.
fn center_distance(points: &[[f64; 3]], corners: &[u32], side: &FaceSide) -> f64 {
    let at = |corner: u32| Vector3::from(points[corner as usize]);
    let [p, q] = side.corners.map(at);
    let length = (q - p).norm();
    if length == 0.0 {
        return 0.0;
    }
    let &[a, b, c] = corners else {
        let offset = Vector3::from(center(points, corners)) - p;
        return (q - p).cross(&offset).norm() / length;
    };
    let Some(apex) = [a, b, c].into_iter().find(|corner| !side.corners.contains(corner)) else { return 0.0 };
    let (to_p, to_q) = (p - at(apex), q - at(apex));
    let (dot, doubled_area) = (to_p.dot(&to_q), to_p.cross(&to_q).norm());
    if dot <= 0.0 {
        return 0.0; // the longest side
    }
    let is_obtuse = (q - p).dot(&to_p) > 0.0 || (p - q).dot(&to_q) > 0.0;
    if is_obtuse { 0.5 * doubled_area / length } else { 0.5 * length * dot / doubled_area }
}

/// Center of area of a face, in model units; the mean of its corners if it has no area.
fn center(points: &[[f64; 3]], corners: &[u32]) -> [f64; 3] {
    let (mean, offsets) = centered(points, corners);
    if corners.len() <= 3 {
        return mean.into();
    }
    let n = offsets.len();
    let normal = vector_area(points, corners).try_normalize(0.0).unwrap_or_default();
    let (mut total, mut moment) = (0.0, Vector3::zeros());
    for k in 0..n {
        let (a, b) = (offsets[k], offsets[(k + 1) % n]);
        let area = a.cross(&b).dot(&normal);
        total += area;
        moment += area * (a + b) / 3.0;
    }
    if total > 0.0 { (mean + moment / total).into() } else { mean.into() }
}

/// Values of all faces or vertices, computed on all threads.
fn parallel_faces<T: Clone + Default + Send>(n: usize, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    expect_not_cancelled(parallel::try_collect(n, Progress::none(), value))
}
