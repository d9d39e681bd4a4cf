//! Connected parts of a mesh, and the side to which the faces of each closed part point.

mod nesting;

use super::{DisjointSets, Polygons, PreparedGeometry, encloses_volume};
use crate::vector::{cross, dot, norm, subtract};
use crate::{Cancelled, Progress};
use nesting::{ClosedPart, enclosing_parts};
use thiserror::Error;

/// Smallest enclosed volume, relative to the power 3/2 of the area, whose sign is more than rounding.
const SMALLEST_VOLUME: f64 = 1e-10;

/// Number of triangles between two checks for cancellation.
const AT_A_TIME: usize = 1 << 16;

/// Connected part of a mesh: faces that share vertices, after vertices at equal positions are merged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePart {
    /// Smallest index of its vertices, in the order of the file.
    pub first_vertex: u32,
    /// Number of its faces.
    pub n_faces: usize,
    /// Enclosed volume in cubed model units, negative if the faces point inward; `None` if the part is not closed.
    pub volume: Option<f64>,
    /// True if the part is closed and its faces point inward although it is not the wall of a cavity. The wall of a
    /// cavity points inward if the part around it does.
    pub is_inward: bool,
}

/// Connected parts of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceParts {
    /// Parts in the order of their first vertices.
    pub parts: Vec<SurfacePart>,
    /// Index of the part of each vertex of the file; [`NO_PART`](Self::NO_PART) for a vertex without faces.
    pub of_vertex: Vec<u32>,
}

/// Error of choosing parts of a mesh by their first vertices.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum SurfacePartError {
    /// The vertex does not exist.
    #[error("vertex {vertex} must be below {n_vertices}, the number of vertices; choose another one")]
    OutOfRange {
        /// Vertex that was given.
        vertex: u32,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The vertex is no corner of a face.
    #[error("vertex {vertex} must be a corner of a face; choose the first vertex of a part of the surface")]
    NoFace {
        /// Vertex that was given.
        vertex: u32,
    },
    /// The vertex is not the first one of its part.
    #[error("vertex {vertex} must be the first one of its part; the part begins at vertex {first_vertex}")]
    NotFirst {
        /// Vertex that was given.
        vertex: u32,
        /// First vertex of its part.
        first_vertex: u32,
    },
}

impl crate::ClassifiedError for SurfacePartError {
    fn kind(&self) -> crate::ErrorKind {
        crate::ErrorKind::Input
    }
}

impl SurfaceParts {
    /// Entry of [`of_vertex`](Self::of_vertex) for a vertex without faces.
    pub const NO_PART: u32 = u32::MAX;

    /// Lists the first vertices of the parts whose faces point inward, ascending.
    pub fn inward(&self) -> Vec<u32> {
        self.parts.iter().filter(|part| part.is_inward).map(|part| part.first_vertex).collect()
    }

    /// True for each of `faces` that belongs to one of the parts with these first vertices.
    ///
    /// # Errors
    /// [`SurfacePartError`] if a vertex is not the first one of a part.
    pub fn faces_of(&self, first_vertices: &[u32], faces: &Polygons) -> Result<Vec<bool>, SurfacePartError> {
        let mut is_chosen = vec![false; self.parts.len()];
        for &vertex in first_vertices {
            if self.parts.is_empty() {
                return Err(SurfacePartError::NoFace { vertex });
            }
            let Some(&part) = self.of_vertex.get(vertex as usize) else {
                return Err(SurfacePartError::OutOfRange { vertex, n_vertices: self.of_vertex.len() });
            };
            let Some(known) = self.parts.get(part as usize) else {
                return Err(SurfacePartError::NoFace { vertex });
            };
            if known.first_vertex != vertex {
                return Err(SurfacePartError::NotFirst { vertex, first_vertex: known.first_vertex });
            }
            is_chosen[part as usize] = true;
        }
        let part_of = |face: &[u32]| face.first().map(|&v| self.of_vertex[v as usize]);
        Ok(faces
            .iter()
            .map(|face| part_of(face).is_some_and(|part| is_chosen.get(part as usize) == Some(&true)))
            .collect())
    }
}

/// Finds the connected parts of a mesh, the volume that each closed part encloses, and the parts that are inside out.
/// Other shapes have no parts. O(n log n); nested parts are told apart by rays.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode, surface_parts};
/// let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let inward = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
/// let mesh = Mesh::new(points.to_vec(), Polygons::from_triangles(&inward))?;
/// let geometry = PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none())?;
/// let parts = surface_parts(&geometry, Progress::none())?;
/// assert_eq!((parts.parts[0].volume, parts.inward()), (Some(-1.0 / 6.0), vec![0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn surface_parts(geometry: &PreparedGeometry, progress: Progress<'_>) -> Result<SurfaceParts, Cancelled> {
    let Some(mesh) = geometry.shape().as_mesh() else { return Ok(SurfaceParts::default()) };
    let welded = geometry.vertex_map().as_slice();
    let mut sets = DisjointSets::new(geometry.n_vertices());
    for (f, face) in mesh.faces().iter().enumerate() {
        if f.is_multiple_of(AT_A_TIME) {
            progress.check()?;
        }
        for pair in face.windows(2) {
            sets.join(welded[pair[0] as usize], welded[pair[1] as usize]);
        }
    }
    let mut result = label_vertices(mesh.faces(), welded, &mut sets);
    let part_of_welded = {
        let mut of = vec![SurfaceParts::NO_PART; geometry.n_vertices()];
        for (v, &part) in result.of_vertex.iter().enumerate() {
            if part != SurfaceParts::NO_PART {
                of[welded[v] as usize] = part;
            }
        }
        of
    };
    let triangles = geometry.triangles();
    let mut is_closed = vec![true; result.parts.len()];
    if !encloses_volume(geometry, progress)? {
        mark_open(triangles, &part_of_welded, &mut is_closed, progress)?;
    }
    let sizes = measure(geometry.points(), triangles, &part_of_welded, result.parts.len());
    for ((part, size), _) in
        result.parts.iter_mut().zip(&sizes).zip(&is_closed).filter(|(_, closed)| **closed)
    {
        part.volume = Some(size.volume);
    }
    let is_solid = |part: &SurfacePart, size: &PartSize| {
        part.volume.is_some_and(|volume| volume.abs() > SMALLEST_VOLUME * size.area.powf(1.5))
    };
    let solid: Vec<ClosedPart> = (0..result.parts.len())
        .filter(|&p| is_solid(&result.parts[p], &sizes[p]))
        .map(|p| ClosedPart {
            part: p as u32,
            vertex: welded[result.parts[p].first_vertex as usize],
            volume: sizes[p].volume,
        })
        .collect();
    let around = enclosing_parts(geometry.points(), triangles, &part_of_welded, &solid, progress)?;
    for k in 0..solid.len() {
        // The wall of a cavity has the other sign than the part around it, and shares its verdict.
        let mut at = k;
        while let Some(outer) = around[at]
            && (solid[outer].volume < 0.0) != (solid[at].volume < 0.0)
        {
            at = outer;
        }
        result.parts[solid[k].part as usize].is_inward = solid[at].volume < 0.0;
    }
    Ok(result)
}

/// Numbers the parts by their first vertices, and counts their faces.
fn label_vertices(faces: &Polygons, welded: &[u32], sets: &mut DisjointSets) -> SurfaceParts {
    let mut has_face = vec![false; welded.len()];
    for &corner in faces.corners() {
        has_face[corner as usize] = true;
    }
    let mut of_root = vec![SurfaceParts::NO_PART; sets.len()];
    let mut result = SurfaceParts { parts: Vec::new(), of_vertex: vec![SurfaceParts::NO_PART; welded.len()] };
    for v in (0..welded.len()).filter(|&v| has_face[v]) {
        let part = &mut of_root[sets.root(welded[v]) as usize];
        if *part == SurfaceParts::NO_PART {
            *part = result.parts.len() as u32;
            let first_vertex = v as u32;
            result.parts.push(SurfacePart { first_vertex, n_faces: 0, volume: None, is_inward: false });
        }
        result.of_vertex[v] = *part;
    }
    for face in faces.iter().filter(|face| !face.is_empty()) {
        result.parts[result.of_vertex[face[0] as usize] as usize].n_faces += 1;
    }
    result
}

/// Marks the parts with an edge that does not have two triangles, once in each direction.
fn mark_open(
    triangles: &[[u32; 3]],
    part_of: &[u32],
    is_closed: &mut [bool],
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * triangles.len());
    let mut has_triangle = vec![false; is_closed.len()];
    for triangle in triangles {
        has_triangle[part_of[triangle[0] as usize] as usize] = true;
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            if a != b {
                edges.push((a.min(b), a.max(b), a < b));
            }
        }
    }
    crate::parallel::sort_unstable_by(&mut edges, progress, Ord::cmp)?;
    for edge in edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
        let is_inner = matches!(edge, [e, f] if e.2 != f.2);
        is_closed[part_of[edge[0].0 as usize] as usize] &= is_inner;
    }
    for (closed, has_triangle) in is_closed.iter_mut().zip(has_triangle) {
        *closed &= has_triangle;
    }
    Ok(())
}

/// Signed volume and area of a part, in model units.
#[derive(Clone, Copy, Default)]
struct PartSize {
    volume: f64,
    area: f64,
}

/// Sums volumes and areas of the triangles of each part, about the first corner of the part.
fn measure(points: &[[f64; 3]], triangles: &[[u32; 3]], part_of: &[u32], n_parts: usize) -> Vec<PartSize> {
    let mut sizes = vec![PartSize::default(); n_parts];
    let mut origins: Vec<Option<[f64; 3]>> = vec![None; n_parts];
    for triangle in triangles {
        let part = part_of[triangle[0] as usize] as usize;
        let origin = *origins[part].get_or_insert(points[triangle[0] as usize]);
        let [a, b, c] = triangle.map(|v| subtract(&points[v as usize], &origin));
        sizes[part].volume += dot(&a, &cross(&b, &c)) / 6.0;
        sizes[part].area += 0.5 * norm(&cross(&subtract(&b, &a), &subtract(&c, &a)));
    }
    sizes
}

#[cfg(test)]
mod tests;
