//! A shape made ready for the analysis: welded, triangulated, numbered so that neighbours are near in memory.

use super::order::reverse_cuthill_mckee;
use super::{Shape, VertexMap, WeldMode, triangulate};

/// The vertices of the analysis and how they belong to those of the shape.
#[derive(Clone, Debug)]
pub struct PreparedGeometry {
    /// Which vertices of the shape are one vertex here.
    pub vertex_map: VertexMap,
    /// Positions of the vertices here, in model units; empty for a graph.
    pub points: Vec<[f64; 3]>,
    /// The triangulated faces in the numbering here; empty for a cloud or a graph.
    pub triangles: Vec<[u32; 3]>,
}

impl PreparedGeometry {
    /// Welds and triangulates `shape`. O(n log n).
    pub fn new(shape: &Shape, weld_mode: WeldMode) -> Self {
        let Some(points) = shape.points() else {
            let vertex_map = match shape {
                Shape::Graph(graph) => VertexMap::from_places(reverse_cuthill_mckee(graph.adjacency())),
                _ => VertexMap::identity(shape.n_vertices()),
            };
            return Self { vertex_map, points: Vec::new(), triangles: Vec::new() };
        };
        let vertex_map = VertexMap::new(points, weld_mode);
        let triangles = match shape {
            Shape::Mesh(mesh) => {
                let mut triangles = triangulate(points, mesh.faces());
                for corner in triangles.as_flattened_mut() {
                    *corner = vertex_map.welded(*corner as usize) as u32;
                }
                triangles
            }
            _ => Vec::new(),
        };
        Self { points: vertex_map.positions(points), vertex_map, triangles }
    }

    /// Number of vertices of the analysis.
    pub fn n_vertices(&self) -> usize {
        self.vertex_map.n_welded()
    }

    /// The positions in units in which the bounding box measures between 1 and 4, and how many model units one such
    /// unit is (a power of two, so nothing is rounded). Squares of lengths can then neither overflow nor vanish.
    pub(crate) fn unit_points(&self) -> (Vec<[f64; 3]>, f64) {
        let diagonal = super::diagonal(&self.points);
        if diagonal == 0.0 {
            return (self.points.clone(), 1.0);
        }
        let exponent = diagonal.log2().floor().clamp(-1000.0, 1000.0);
        let unit = exponent.exp2();
        (self.points.iter().map(|p| p.map(|c| c / unit)).collect(), unit)
    }
}
