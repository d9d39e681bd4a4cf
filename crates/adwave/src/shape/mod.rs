//! Shapes: polygon meshes, point clouds and weighted graphs, and their measures.
//!
//! A [`Shape`] holds the content of a file in the file's order. All computation works on a [`PreparedGeometry`]:
//! the same shape with vertices at equal positions merged, polygons cut into triangles, and vertices renumbered so
//! that neighbors on the shape are close in memory: along a space-filling curve, or for graphs by breadth-first
//! search.

mod adjacency;
mod area;
mod cloud;
mod curve;
mod disjoint_sets;
mod dual;
mod face_flags;
mod face_incidence;
mod given_normals;
mod graph;
mod health;
mod hilbert;
mod mesh;
mod nearest;
mod order;
pub(crate) mod orientation;
mod participation;
mod parts;
mod polygons;
mod prepared_geometry;
mod seam_jumps;
mod seams;
mod sheets;
mod surface;
mod triangulate;
mod vertex_map;
mod vertex_order;

pub use adjacency::{Adjacency, k_rings, label_components, n_components, one_ring};
pub(crate) use adjacency::{triangles_at_vertices, try_k_rings, try_one_ring};
pub use area::{CloudArea, MeshArea, cloud_areas, mesh_areas};
pub(crate) use area::{mean_edge_length, tangent_plane, try_cloud_areas, try_mesh_areas};
pub use cloud::PointCloud;
pub use curve::curve_length;
pub(crate) use curve::{edge_lengths, places_without_noise};
pub use dual::dual_graph;
pub(crate) use face_incidence::FaceIncidence;
pub use face_incidence::{enclosed_face_volume, face_areas, face_ring, face_vertex_normals, total_face_area};
pub(crate) use given_normals::welded_normals;
pub use given_normals::{GivenNormals, NormalCheck, NormalSigns};
pub use graph::{Graph, GraphError};
pub use health::{Health, encloses_volume, health};
#[doc(hidden)]
pub use hilbert::{HILBERT_BITS, hilbert};
pub use mesh::Mesh;
pub(crate) use nearest::nearest_of_wanted;
pub use nearest::{Neighborhoods, nearest_neighbors, nearest_to_vertex, try_nearest_neighbors};
pub(crate) use order::reverse_cuthill_mckee;
pub use participation::{KnownRange, OriginRule, STRAY_NEIGHBORS, VertexRole, is_stray};
#[doc(hidden)]
pub use participation::{describe_outsiders, leads_to, may_be_placeholder, picture_frame};
pub use parts::{SurfacePart, SurfacePartError, SurfaceParts, surface_parts};
pub use polygons::Polygons;
pub use prepared_geometry::PreparedGeometry;
pub use seam_jumps::{SeamJumps, jumps_at_seams};
pub use seams::SeamWeld;
pub use surface::{enclosed_volume, face_normals, surface_area, vertex_normals};
pub(crate) use surface::{sphere_radius, try_vertex_normals};
pub use triangulate::{triangulate, triangulate_with_faces};
pub use vertex_map::{VertexMap, WeldMode};
pub use vertex_order::first_misplaced_vertex;

use crate::vector::{norm, subtract};
use crate::{ClassifiedError, ErrorKind, Progress, parallel};
pub(crate) use disjoint_sets::DisjointSets;
pub(crate) use participation::Participation;
use thiserror::Error;

/// Largest magnitude of a coordinate; squares and products of three lengths stay finite below it.
pub const MAX_COORDINATE: f64 = 1e100;

/// A mesh, a point cloud or a graph, in the order of its file. Copies share its arrays.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A polygon mesh.
    Mesh(Mesh),
    /// A point cloud.
    Cloud(PointCloud),
    /// A weighted graph, or a curve: a graph whose nodes have positions.
    Graph(Graph),
}

impl Shape {
    /// Number of vertices, points or nodes.
    pub fn n_vertices(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.points().len(),
            Self::Cloud(cloud) => cloud.points().len(),
            Self::Graph(graph) => graph.n_nodes(),
        }
    }

    /// Positions in model units; `None` for a graph without positions.
    pub fn points(&self) -> Option<&[[f64; 3]]> {
        match self {
            Self::Mesh(mesh) => Some(mesh.points()),
            Self::Cloud(cloud) => Some(cloud.points()),
            Self::Graph(graph) => graph.positions(),
        }
    }

    /// True if the shape is a polygon mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self, Self::Mesh(_))
    }

    /// True if the shape is a point cloud.
    pub fn is_cloud(&self) -> bool {
        matches!(self, Self::Cloud(_))
    }

    /// True if the shape is a graph or a curve.
    pub fn is_graph(&self) -> bool {
        matches!(self, Self::Graph(_))
    }

    /// The mesh; `None` for another shape.
    pub fn as_mesh(&self) -> Option<&Mesh> {
        if let Self::Mesh(mesh) = self { Some(mesh) } else { None }
    }

    /// The point cloud; `None` for another shape.
    pub fn as_cloud(&self) -> Option<&PointCloud> {
        if let Self::Cloud(cloud) = self { Some(cloud) } else { None }
    }

    /// The graph or curve; `None` for another shape.
    pub fn as_graph(&self) -> Option<&Graph> {
        if let Self::Graph(graph) = self { Some(graph) } else { None }
    }

    /// The graph of a curve: nodes with positions, and steps by the lengths of the edges ([`Graph::curve`]).
    pub fn as_curve(&self) -> Option<&Graph> {
        match self {
            Self::Graph(graph) if graph.is_curve() => Some(graph),
            _ => None,
        }
    }

    /// Size of the shape in model units, from which lengths in percent follow ([`PreparedGeometry::extent`]): the
    /// diagonal of the bounding box of its largest part, without strays; 0 without positions. O(n log n).
    ///
    /// ```
    /// use adwave::shape::{Mesh, Polygons, Shape};
    /// let points = vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [500.0, 0.0, 0.0]];
    /// let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&[[0, 1, 2]]))?);
    /// assert_eq!((shape.extent(), shape.diagonal() > 500.0), (5.0, true));
    /// # Ok::<(), adwave::shape::ShapeError>(())
    /// ```
    pub fn extent(&self) -> f64 {
        match PreparedGeometry::new(self, WeldMode::default(), Progress::none()) {
            Ok(geometry) => geometry.extent(),
            Err(cancelled) => unreachable!("{cancelled}"),
        }
    }

    /// Length of the bounding box's diagonal in model units; 0 without positions.
    pub fn diagonal(&self) -> f64 {
        self.points().map_or(0.0, diagonal)
    }
}

/// Error of building a shape from points and faces.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ShapeError {
    /// The shape has no vertices.
    #[error("the shape has no vertices")]
    NoVertices,
    /// The shape has more vertices than a 32-bit index can name.
    #[error("{0} vertices are more than the {max} that can be indexed", max = u32::MAX - 1)]
    TooManyVertices(usize),
    /// A coordinate is NaN or infinite.
    #[error(
        "vertex {vertex} (counted from 0) has the position ({x}, {y}, {z}), which is not finite; remove or repair it"
    )]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its x coordinate.
        x: f64,
        /// Its y coordinate.
        y: f64,
        /// Its z coordinate.
        z: f64,
    },
    /// A coordinate is so large that areas and volumes would overflow.
    #[error(
        "vertex {vertex} (counted from 0) has a coordinate of {value:e}, beyond ±{MAX_COORDINATE:e}; scale the shape"
    )]
    TooFar {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// The coordinate.
        value: f64,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} (counted from 0) names vertex {index}, but there are only {n_vertices} vertices")]
    IndexOutOfRange {
        /// Index of the face, from 0.
        face: usize,
        /// The vertex that it names, from 0.
        index: u32,
        /// Number of vertices.
        n_vertices: usize,
    },
}

impl ClassifiedError for ShapeError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Error of a method that needs a mesh, a cloud or a graph, for another domain.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("{needed_by} needs a mesh, a point cloud or a curve, and this domain is none")]
pub struct NoShape {
    /// The method, with an article if it is a noun.
    pub needed_by: &'static str,
}

impl ClassifiedError for NoShape {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Number of points that a thread processes at a time.
const POINTS_AT_A_TIME: usize = 1 << 14;

/// Side length in model units below which the diagonal is measured relative to the longest side: squares of lengths
/// lose digits below 1e-154 and vanish below 1e-162.
const SMALL_SIDE: f64 = 1e-140;

/// Checks that there are points, that each is finite, and that its square is too.
fn check_points(points: &[[f64; 3]]) -> Result<(), ShapeError> {
    if points.is_empty() {
        return Err(ShapeError::NoVertices);
    }
    if points.len() >= u32::MAX as usize {
        return Err(ShapeError::TooManyVertices(points.len()));
    }
    let is_bad = |value: &f64| !value.is_finite() || value.abs() > MAX_COORDINATE;
    let first_bad = |mut range: std::ops::Range<usize>| range.find(|&x| points[x].iter().any(is_bad));
    let bad = parallel::map_chunks(points.len(), POINTS_AT_A_TIME, first_bad);
    let Some(vertex) = bad.into_iter().flatten().next() else { return Ok(()) };
    let [x, y, z] = points[vertex];
    match [x, y, z].into_iter().find(is_bad) {
        Some(value) if value.is_finite() => Err(ShapeError::TooFar { vertex, value }),
        _ => Err(ShapeError::NotFinite { vertex, x, y, z }),
    }
}

/// Two corners of the axis-aligned bounding box, the smallest coordinates first; `None` without points.
pub fn bounding_box(points: &[[f64; 3]]) -> Option<([f64; 3], [f64; 3])> {
    let first = *points.first()?;
    let wider = |(lo, hi): ([f64; 3], [f64; 3]), p: &([f64; 3], [f64; 3])| {
        (std::array::from_fn(|c| lo[c].min(p.0[c])), std::array::from_fn(|c| hi[c].max(p.1[c])))
    };
    let boxes = parallel::map_chunks(points.len(), POINTS_AT_A_TIME, |range| {
        points[range].iter().fold((first, first), |so_far, p| wider(so_far, &(*p, *p)))
    });
    Some(boxes.iter().fold((first, first), wider))
}

/// Length of the bounding box's diagonal in model units; 0 without points or if all coincide.
pub fn diagonal(points: &[[f64; 3]]) -> f64 {
    bounding_box(points).map_or(0.0, |(lo, hi)| box_diagonal(&lo, &hi))
}

/// Length of the diagonal between two opposite corners of a box.
pub(crate) fn box_diagonal(lo: &[f64; 3], hi: &[f64; 3]) -> f64 {
    let sides = subtract(hi, lo).map(f64::abs);
    let longest = sides.into_iter().fold(0.0, f64::max);
    if longest == 0.0 {
        return 0.0;
    }
    let unit = if longest < SMALL_SIDE { longest } else { 1.0 };
    unit * norm(&sides.map(|side| side / unit))
}

/// Euclidean distance of two points.
#[inline]
pub(crate) fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    squared_distance(a, b).sqrt()
}

/// Squared Euclidean distance of two points.
#[inline]
pub(crate) fn squared_distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let (x, y, z) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    x * x + y * y + z * z
}
