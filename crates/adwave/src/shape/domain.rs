//! A shape made ready for the analysis: welded, triangulated, numbered so that neighbours are near in memory.

use super::order::reverse_cuthill_mckee;
use super::{Shape, Weld, WeldMode, triangulate};

/// The vertices of the analysis and how they belong to those of the shape.
#[derive(Clone, Debug)]
pub struct Domain {
    /// Which vertices of the shape are one vertex here.
    pub weld: Weld,
    /// Positions of the vertices here, in model units; empty for a graph.
    pub points: Vec<[f64; 3]>,
    /// The triangulated faces in the numbering here; empty for a cloud or a graph.
    pub triangles: Vec<[u32; 3]>,
}

impl Domain {
    /// Welds and triangulates `shape`. O(n log n).
    pub fn new(shape: &Shape, weld_mode: WeldMode) -> Self {
        let Some(points) = shape.points() else {
            let weld = match shape {
                Shape::Graph(graph) => Weld::from_places(reverse_cuthill_mckee(graph.adjacency())),
                _ => Weld::identity(shape.n_vertices()),
            };
            return Self { weld, points: Vec::new(), triangles: Vec::new() };
        };
        let weld = Weld::new(points, weld_mode);
        let triangles = match shape {
            Shape::Mesh(mesh) => {
                let mut triangles = triangulate(points, mesh.faces());
                for corner in triangles.as_flattened_mut() {
                    *corner = weld.class_of(*corner as usize) as u32;
                }
                triangles
            }
            _ => Vec::new(),
        };
        Self { points: weld.positions(points), weld, triangles }
    }

    /// Number of vertices of the analysis.
    pub fn n_vertices(&self) -> usize {
        self.weld.n_classes()
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
