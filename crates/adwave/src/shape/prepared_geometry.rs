//! A shape prepared for the analysis: welded, triangulated, and numbered so that neighbors are close in memory.

use super::order::reverse_cuthill_mckee;
use super::triangulate::try_triangulate;
use super::{Graph, Shape, VertexMap, WeldMode};
use crate::{Cancelled, Progress, parallel};
use std::borrow::Cow;
use std::sync::Arc;

/// A shape with its welded vertices in the analysis order, and their relation to the vertices of the shape. Copies
/// share all arrays.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{PointCloud, PreparedGeometry, Shape, WeldMode};
/// let shape = Shape::Cloud(PointCloud::new(vec![[0.0; 3], [1.0; 3], [0.0; 3]])?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
/// assert_eq!((shape.n_vertices(), geometry.n_vertices()), (3, 2));
/// assert_eq!(geometry.points(), [[0.0; 3], [1.0; 3]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PreparedGeometry {
    shape: Shape,
    vertex_map: VertexMap,
    points: Arc<Vec<[f64; 3]>>,
    triangles: Arc<Vec<[u32; 3]>>,
}

/// Number of reported stages: vertex map, positions, triangles.
const STAGES: u64 = 3;

/// Exponent range of moderate sizes: between 2⁻³² and 2³² model units nothing overflows or underflows that would
/// not at a size of 1.
const MODERATE_EXPONENT: f64 = 32.0;

/// Positions in some unit, and the length of that unit in model units.
pub(crate) type UnitPoints<'a> = (Cow<'a, [[f64; 3]]>, f64);

impl PreparedGeometry {
    /// Welds and triangulates `shape`. O(n log n).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn new(shape: &Shape, weld_mode: WeldMode, progress: Progress<'_>) -> Result<Self, Cancelled> {
        progress.step(0, STAGES)?;
        let prepared = |vertex_map, points, triangles| Self {
            shape: shape.clone(),
            vertex_map,
            points: Arc::new(points),
            triangles: Arc::new(triangles),
        };
        let (points, faces) = match shape {
            Shape::Graph(graph) => {
                let place = reverse_cuthill_mckee(graph.adjacency(), progress)?;
                progress.step(STAGES, STAGES)?;
                return Ok(prepared(VertexMap::from_places(place), Vec::new(), Vec::new()));
            }
            Shape::Cloud(cloud) => (cloud.points(), None),
            Shape::Mesh(mesh) => (mesh.points(), Some(mesh.faces())),
        };
        let vertex_map = VertexMap::try_new(points, weld_mode, progress)?;
        progress.step(1, STAGES)?;
        let positions = vertex_map.try_positions(points, progress)?;
        progress.step(2, STAGES)?;
        let welded = vertex_map.as_slice();
        let triangles = match faces {
            Some(faces) => try_triangulate(points, faces, progress, |_, corners| {
                corners.map(|corner| welded[corner as usize])
            })?,
            None => Vec::new(),
        };
        progress.step(STAGES, STAGES)?;
        Ok(prepared(vertex_map, positions, triangles))
    }

    /// Wraps a graph whose nodes keep the given order, for one that is already well numbered.
    pub fn from_ordered_graph(graph: Graph) -> Self {
        let vertex_map = VertexMap::identity(graph.n_nodes());
        Self { shape: Shape::Graph(graph), vertex_map, points: Arc::default(), triangles: Arc::default() }
    }

    /// The shape, in the order of its file.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Map from the vertices of the shape to the welded vertices.
    pub fn vertex_map(&self) -> &VertexMap {
        &self.vertex_map
    }

    /// Positions of the welded vertices, in model units; empty for a graph.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Triangulated faces between welded vertices; empty for a cloud or a graph.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Number of welded vertices.
    pub fn n_vertices(&self) -> usize {
        self.vertex_map.n_welded()
    }

    /// Largest power of two not above the diagonal, in model units; 1 if all points coincide.
    pub(crate) fn size_unit(&self) -> f64 {
        let diagonal = super::diagonal(&self.points);
        if diagonal == 0.0 { 1.0 } else { diagonal.log2().floor().clamp(-1000.0, 1000.0).exp2() }
    }

    /// Positions in a unit in which squares of lengths neither overflow nor underflow, and the length of that unit
    /// in model units: a power of two, so that nothing is rounded, and 1 for a shape of moderate size.
    pub(crate) fn unit_points(&self, progress: Progress<'_>) -> Result<UnitPoints<'_>, Cancelled> {
        let unit = self.size_unit();
        if unit.log2().abs() <= MODERATE_EXPONENT {
            return Ok((Cow::Borrowed(&self.points), 1.0));
        }
        let scaled = |x: usize| self.points[x].map(|c| c / unit);
        Ok((Cow::Owned(parallel::try_collect(self.points.len(), progress, scaled)?), unit))
    }
}
