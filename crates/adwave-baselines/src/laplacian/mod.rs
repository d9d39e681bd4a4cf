//! Laplacian of a shape: a symmetric stiffness matrix and a mass for each vertex.
//!
//! With the mass matrix M and the stiffness matrix S, `Δf = M⁻¹ S f` has the sign for which it is positive
//! semi-definite: `fᵀSf` is the Dirichlet energy.

mod cloud;
mod cotangent;

use crate::linalg::{LinalgError, SymmetricMatrix};
use adwave::Progress;
use adwave::operator::{OperatorParams, local_operator};
use adwave::shape::MeshArea;
use adwave::shape::{PreparedGeometry, Shape, VertexMap, WeldMode, mesh_areas};

/// Triangles of a mesh on which the cotangents are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Triangulation {
    /// Intrinsic Delaunay triangulation of the same surface, as in [`adwave::laplacian`]; no weight is negative.
    #[default]
    IntrinsicDelaunay,
    /// Triangles of the mesh: obtuse triangles give negative weights, and triangles without area are skipped.
    AsGiven,
}

/// Parameters of a Laplacian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LaplacianParams {
    /// Triangulation of a mesh.
    pub triangulation: Triangulation,
    /// Mass of a vertex of a mesh with [`Triangulation::AsGiven`]. Intrinsic triangles always give a third of their
    /// area to each corner.
    pub area: MeshArea,
    /// Welding of vertices at equal positions.
    pub weld: WeldMode,
}

impl LaplacianParams {
    /// Sets the triangulation of a mesh.
    #[must_use]
    pub fn with_triangulation(self, triangulation: Triangulation) -> Self {
        Self { triangulation, ..self }
    }

    /// Sets the mass of a mesh's vertices.
    #[must_use]
    pub fn with_area(self, area: MeshArea) -> Self {
        Self { area, ..self }
    }

    /// Sets the welding of vertices at equal positions.
    #[must_use]
    pub fn with_weld(self, weld: WeldMode) -> Self {
        Self { weld, ..self }
    }
}

/// Changes made to the triangles, and properties of the weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaplacianInfo {
    /// Number of edges flipped to reach the intrinsic Delaunay triangulation.
    pub n_flips: usize,
    /// Number of negative weights, which come from obtuse triangles of the mesh; edges at the border count as well.
    pub n_negative: usize,
    /// Length added to every edge, in model units; 0 without degenerate triangles.
    pub lengthened: f64,
    /// Number of vertices without mass, which belong to no surface.
    pub n_massless: usize,
}

/// Stiffness and mass of a shape, with one row per welded vertex (`vertex_map` maps the shape's vertices to the rows).
///
/// ```
/// use adwave::shape::{Mesh, Polygons, Shape};
/// use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(square, Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]))?;
/// let laplacian = LaplacianMatrices::new(&Shape::Mesh(mesh), &LaplacianParams::default())?;
/// assert!((laplacian.mass.iter().sum::<f64>() - 1.0).abs() < 1e-15);
/// assert!(laplacian.stiffness.product(&[1.0; 4]).iter().all(|v| v.abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LaplacianMatrices {
    /// Stiffness matrix S: symmetric, positive semi-definite, with rows that sum to 0; dimensionless on a surface.
    pub stiffness: SymmetricMatrix,
    /// Diagonal of the mass matrix M, at least 0, in squared model units (1 for a graph).
    pub mass: Vec<f64>,
    /// Map from the shape's vertices to the rows of the matrices.
    pub vertex_map: VertexMap,
    /// Changes made to the triangles, and properties of the weights.
    pub info: LaplacianInfo,
}

impl LaplacianMatrices {
    /// Builds the Laplacian of `shape`: cotangents on a mesh, the heat kernel on a cloud, `D − W` on a graph. O(n log
    /// n).
    ///
    /// # Errors
    /// [`LinalgError`] if weights overflow.
    pub fn new(shape: &Shape, params: &LaplacianParams) -> Result<Self, LinalgError> {
        let geometry = PreparedGeometry::new(shape, params.weld, Progress::none())?;
        let n = geometry.n_vertices();
        let mut info = LaplacianInfo::default();
        let (entries, mass) = match shape {
            Shape::Mesh(_) => match params.triangulation {
                Triangulation::AsGiven => cotangents_and_areas(&geometry, params.area),
                Triangulation::IntrinsicDelaunay => {
                    let surface = adwave::laplacian::Laplacian::new(&geometry, 0, Progress::none())?;
                    (info.n_flips, info.lengthened) = (surface.info().n_flips, surface.info().lengthened);
                    let mass = surface.areas();
                    let weights = surface.into_parts().0;
                    let later = |x: usize| {
                        let (columns, values) = weights.row(x);
                        let entries = columns.iter().zip(values).filter(move |(y, _)| **y as usize > x);
                        entries.map(move |(&y, &w)| (x as u32, y, w))
                    };
                    ((0..n).flat_map(later).collect(), mass)
                }
            },
            Shape::Cloud(_) => {
                let params = OperatorParams::default().with_weld(params.weld);
                cloud::heat_kernel(geometry.points(), &local_operator(&geometry, &params, Progress::none())?)
            }
            Shape::Graph(graph) => {
                let class = |u: u32| geometry.vertex_map().welded(u as usize) as u32;
                let edges = (0..n as u32).flat_map(|u| {
                    let later = graph.neighbors(u as usize).filter(move |&(v, _)| v > u);
                    later.map(move |(v, w)| (class(u), class(v), w))
                });
                (edges.collect(), vec![1.0; n])
            }
        };
        let stiffness = from_weights(n, &entries)?;
        info.n_negative = count_negative(&stiffness);
        info.n_massless = mass.iter().filter(|&&m| m <= 0.0).count();
        Ok(Self { stiffness, mass, vertex_map: geometry.vertex_map().clone(), info })
    }

    /// Number of rows, that of the welded vertices.
    pub fn n(&self) -> usize {
        self.mass.len()
    }
}

/// Builds `S = Σ w (e_x − e_y)(e_x − e_y)ᵀ` from edges with their weights.
fn from_weights(n: usize, edges: &[(u32, u32, f64)]) -> Result<SymmetricMatrix, LinalgError> {
    let off: Vec<_> = edges.iter().filter(|e| e.0 != e.1).map(|&(x, y, w)| (x, y, -w)).collect();
    let off = SymmetricMatrix::from_halves(n, &off)?;
    // The diagonal comes from the summed row, so that rows sum to 0 as closely as possible.
    let diagonal: Vec<f64> = (0..n).map(|x| -off.row(x).1.iter().sum::<f64>()).collect();
    Ok(off.add_diagonal(&diagonal))
}

fn count_negative(stiffness: &SymmetricMatrix) -> usize {
    let rounding = 1e-12;
    (0..stiffness.n())
        .map(|x| {
            let (columns, values) = stiffness.row(x);
            let above = columns.iter().zip(values).filter(|&(&y, &s)| y as usize > x && s > rounding);
            above.count()
        })
        .sum()
}

/// Computes the cotangents of the mesh's triangles, and the vertex areas according to `area`.
fn cotangents_and_areas(geometry: &PreparedGeometry, area: MeshArea) -> (Vec<(u32, u32, f64)>, Vec<f64>) {
    let (points, unit) = unit_points(geometry.points());
    let entries = cotangent::cotangent_weights(&points, geometry.triangles());
    let areas = mesh_areas(&points, geometry.triangles(), area);
    (entries, areas.into_iter().map(|a| a * unit * unit).collect())
}

/// Scales the positions by a power of two near the diagonal, so that squares neither overflow nor vanish; also returns
/// that power.
fn unit_points(points: &[[f64; 3]]) -> (Vec<[f64; 3]>, f64) {
    let diagonal = adwave::shape::diagonal(points);
    let unit = if diagonal > 0.0 { diagonal.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
    (points.iter().map(|p| p.map(|c| c / unit)).collect(), unit)
}

#[cfg(test)]
mod tests;
