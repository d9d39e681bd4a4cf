//! Laplace–Beltrami operator of a surface: edge weights and vertex masses that depend on the surface and as little
//! as possible on its mesh.
//!
//! `(M⁻¹L f)(x) = (1/M(x))·Σ_y w(x,y)·(f(x) − f(y))` with w ≥ 0. On a mesh w are the cotangent weights
//! (`pinkall1993`) of the intrinsic Delaunay triangulation (`bobenko2007`) of its surface, and M a third of its
//! triangle areas, or the areas of its Voronoi cells if faces have more than three corners. On a mesh that is not a
//! surface they are those of its double cover (`sharp2020`); on a cloud those of Voronoi cells in tangent planes. On a
//! curve w is 1/length and M half of the adjacent lengths: the Laplacian of a line. On a graph of cells w is given, and
//! M are the areas of the cells.

mod cloud;
mod gluing;
mod triangulation;
mod turning;

use crate::parallel;
use crate::rows::{CompressedRows, Pattern, rows_at_a_time};
use crate::shape::{
    Adjacency, Graph, PreparedGeometry, Shape, edge_lengths, mean_edge_length, places_without_noise,
};
use crate::{Cancelled, Progress};
use gluing::{cover, glue_sheet};
use triangulation::{Triangulation, next, previous};
pub use turning::TangentPlane;
pub(crate) use turning::{TangentTurn, turn_between};

/// Largest weight that counts as rounding, relative to cotangents of about 1: the diagonal of a rectangle has
/// weight 0.
const NEGLIGIBLE: f64 = 1e-12;

/// Number of neighbors needed to close a cell of a cloud, relative to the number of neighbors of the diffusion.
const NEIGHBORS_FOR_A_CELL: usize = 2;

/// Weights and masses of the welded vertices of a shape, in the analysis order.
///
/// ```
/// use adwave::{Progress, laplacian::Laplacian, shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode}};
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let mesh = Mesh::new(square, Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]))?;
/// let geometry = PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none())?;
/// let laplacian = Laplacian::new(&geometry, 10, Progress::none())?;
/// assert!((laplacian.areas().iter().sum::<f64>() - 1.0).abs() < 1e-14);
/// assert_eq!(laplacian.weights().row(0).1.len(), 2); // the sides, and no diagonal: its angles are right
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Laplacian {
    weights: CompressedRows<f64>,
    /// Masses, in squares of `unit`; on a curve in `unit`.
    mass: Vec<f64>,
    /// Unit of length in model units, chosen so that its squares neither overflow nor underflow.
    unit: f64,
    /// Mean length of the edges, in units of `unit`.
    mean_length: f64,
    /// Unit of the areas in model units: `unit` squared, on a curve `unit`.
    area_unit: f64,
    info: LaplacianInfo,
}

/// Changes made to the triangles of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaplacianInfo {
    /// Number of edges flipped to reach the Delaunay triangulation.
    pub n_flips: usize,
    /// True if the mesh was covered twice, because it is not an oriented surface or has obtuse angles at its
    /// border.
    pub is_covered: bool,
    /// Length added to every edge to make degenerate triangles proper, in model units.
    pub lengthened: f64,
}

impl Laplacian {
    /// Laplacian of a prepared shape; for a graph `D − W` with masses 1, for a curve w = 1/length. `neighbors` is the
    /// number of nearest points of a point of a cloud. O(n log n).
    ///
    /// All values are finite, whatever the shape: vertices without a triangle have neither weight nor mass.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn new(
        geometry: &PreparedGeometry,
        neighbors: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        if let (Shape::Graph(graph), None) = (geometry.shape(), geometry.curve_edges()) {
            return graph_laplacian(graph, geometry, progress);
        }
        let (points, unit) = geometry.unit_points(progress)?;
        if let Some(edges) = geometry.curve_edges() {
            let laplacian = curve_laplacian(&points, edges);
            return Ok(Self { unit, area_unit: unit, ..laplacian });
        }
        let mut laplacian = if geometry.shape().is_cloud() {
            let near = geometry.nearest(&points, NEIGHBORS_FOR_A_CELL * neighbors, progress)?;
            cloud::laplacian(&points, &near, progress)?
        } else {
            polygon_laplacian(geometry, &points, progress)?
        };
        laplacian.unit = unit;
        laplacian.area_unit = unit * unit;
        laplacian.info.lengthened *= unit;
        Ok(laplacian)
    }

    /// Weights w, n × n: symmetric, > 0, without a diagonal; dimensionless on a surface.
    pub fn weights(&self) -> &CompressedRows<f64> {
        &self.weights
    }

    /// Diagonal of M in squared model units (1 for a graph; in model units on a curve): ≥ 0, with the area of the
    /// surface or the length of the curve as sum.
    pub fn areas(&self) -> Vec<f64> {
        self.mass.iter().map(|m| m * self.area_unit).collect()
    }

    /// Mean edge length, or mean distance between neighboring points of a cloud, in model units (1 for a graph
    /// without positions).
    pub fn mean_length(&self) -> f64 {
        self.mean_length * self.unit
    }

    /// Changes made to the triangles.
    pub fn info(&self) -> &LaplacianInfo {
        &self.info
    }

    /// The weights, the masses in squares of a unit (on a curve in that unit), and the unit in model units.
    pub fn into_parts(self) -> (CompressedRows<f64>, Vec<f64>, f64) {
        (self.weights, self.mass, self.unit)
    }
}

fn graph_laplacian(
    graph: &Graph,
    geometry: &PreparedGeometry,
    progress: Progress<'_>,
) -> Result<Laplacian, Cancelled> {
    let n = graph.n_nodes();
    let vertex_map = geometry.vertex_map();
    let (node_at, place) = (vertex_map.last_members(), vertex_map.as_slice());
    let row = |row: &mut Vec<(u32, f64)>, x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
        row.clear();
        row.extend(graph.neighbors(node_at[x] as usize).map(|(y, w)| (place[y as usize], w)));
        row.sort_unstable_by_key(|entry| entry.0);
        columns.extend(row.iter().map(|entry| entry.0));
        weights.extend(row.iter().map(|entry| entry.1));
    };
    let weights = CompressedRows::from_rows(n, rows_at_a_time(n), progress, Vec::new, row)?;
    let info = LaplacianInfo::default();
    if let Some(areas) = graph.cell_areas() {
        let (points, unit) = geometry.unit_points(progress)?;
        let mean_length = mean_edge_length(&points, weights.pattern(), progress)?;
        let mass = node_at.iter().map(|&node| areas[node as usize] / unit / unit).collect();
        return Ok(Laplacian { weights, mass, unit, mean_length, area_unit: unit * unit, info });
    }
    let mass = vec![1.0; n];
    let mean_length = match geometry.points() {
        [] => 1.0,
        points => mean_edge_length(points, weights.pattern(), progress)?,
    };
    Ok(Laplacian { weights, mass, unit: 1.0, mean_length, area_unit: 1.0, info })
}

/// Laplacian of a curve, `w(x,y) = 1/‖x−y‖` and `M(x) = ½Σ_y ‖x−y‖`, in the unit of `points`. Along a straight line a
/// linear function is harmonic, however the vertices are spaced. Lengths that noise stretches are measured without it.
fn curve_laplacian(points: &[[f64; 3]], edges: &Adjacency) -> Laplacian {
    let places = places_without_noise(points, edges);
    let lengths = edge_lengths(places.as_deref().unwrap_or(points), edges);
    let mass = (0..points.len()).map(|x| 0.5 * lengths[edges.range(x)].iter().sum::<f64>()).collect();
    let mean_length = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
    let weights = CompressedRows::new_unchecked(edges.clone(), lengths.iter().map(|l| 1.0 / l).collect());
    Laplacian { weights, mass, unit: 1.0, mean_length, area_unit: 1.0, info: LaplacianInfo::default() }
}

/// Laplacian of a mesh of triangles or polygons with the welded vertices at `points`.
fn polygon_laplacian(
    geometry: &PreparedGeometry,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Laplacian, Cancelled> {
    if geometry.faces().triangles().is_some() {
        return mesh_laplacian(points, geometry.triangles(), MassCells::Thirds, progress);
    }
    let mut laplacian = mesh_laplacian(points, geometry.triangles(), MassCells::Voronoi, progress)?;
    let ring = geometry.incidence(progress)?.ring(progress)?;
    laplacian.mean_length = mean_edge_length(points, &ring, progress)?;
    Ok(laplacian)
}

/// Cells whose areas are the masses of a mesh.
#[derive(Clone, Copy, PartialEq)]
enum MassCells {
    /// A third of each triangle.
    Thirds,
    /// Voronoi cells. If the corners of a polygon lie on a circle, it has several Delaunay triangulations; their
    /// thirds differ, and their Voronoi cells do not.
    Voronoi,
}

fn mesh_laplacian(
    points: &[[f64; 3]],
    triangles: &[[u32; 3]],
    cells: MassCells,
    progress: Progress<'_>,
) -> Result<Laplacian, Cancelled> {
    let n = points.len();
    let mut surface = Triangulation::new(points, triangles, progress)?;
    let at_vertex = surface.triangles_at_vertices(n, progress)?;
    let edges = glue_sheet(&mut surface, &at_vertex, progress)?;
    if !edges.is_manifold {
        surface.twin.fill(triangulation::NONE);
        surface = cover(surface, points, &at_vertex, progress)?;
    }
    drop(at_vertex);
    let lengthened = surface.mollify(progress)?;
    let mut n_flips = surface.flip_to_delaunay(progress)?;
    let mut is_covered = !edges.is_manifold;
    // A border edge opposite an obtuse angle would have a negative weight. Beyond the border lies the back of the
    // same triangle; inside, the triangulation stays the same.
    if edges.is_manifold && edges.has_border && surface.has_obtuse_border(progress)? {
        surface = surface.double();
        n_flips += surface.flip_to_delaunay(progress)?;
        is_covered = true;
    }
    let at_vertex = surface.triangles_at_vertices(n, progress)?;
    let share = if is_covered { 0.5 } else { 1.0 };
    let weights = weights(&surface, &at_vertex, n, share, progress)?;
    let mass = parallel::try_collect(n, progress, |x| {
        if cells == MassCells::Voronoi {
            return share * cell_area(&surface, at_vertex.row(x), x);
        }
        let areas = at_vertex.row(x).iter().map(|&t| surface.area(3 * t as usize));
        share / 3.0 * areas.sum::<f64>()
    })?;
    let info = LaplacianInfo { n_flips, is_covered, lengthened };
    Ok(Laplacian { weights, mass, unit: 1.0, mean_length: edges.mean_length, area_unit: 1.0, info })
}

/// Triangulation whose edges carry directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgesForTurns {
    /// The triangles of the mesh.
    Mesh,
    /// The intrinsic Delaunay triangulation, along whose edges heat flows.
    Delaunay,
}

/// Turns of directions that are carried around a triangle.
#[derive(Clone)]
pub(crate) struct TriangleTurns {
    /// Number of the triangle.
    pub(crate) triangle: usize,
    /// Angle by which the triangle turns whatever is carried around it.
    pub(crate) curvature: f64,
    /// Turns from its corners 1, 2 and 0 to its corners 0, 1 and 2.
    pub(crate) turns: [TangentTurn; 3],
}

/// Directions on a triangle mesh.
pub(crate) struct MeshDirections<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
    /// Tangent planes of the vertices, with the orientation of the triangles.
    pub(crate) planes: &'a [TangentPlane],
    /// Order s of the symmetry: a direction counts as itself after a turn by 2π/s.
    pub(crate) symmetry: u32,
}

impl MeshDirections<'_> {
    /// The sheet of the triangles with the angles of its sides; `None` unless each edge has at most two triangles, with
    /// one orientation.
    fn sheet(&self, progress: Progress<'_>) -> Result<Option<(Triangulation, Pattern)>, Cancelled> {
        let n = self.points.len();
        let mut surface = Triangulation::new(self.points, self.triangles, progress)?;
        let at_vertex = surface.triangles_at_vertices(n, progress)?;
        if !glue_sheet(&mut surface, &at_vertex, progress)?.is_manifold {
            return Ok(None);
        }
        surface.mollify(progress)?;
        let angles = surface.side_angles(self.points, self.planes, &at_vertex, progress)?;
        surface.angles = Some(angles);
        Ok(Some((surface, at_vertex)))
    }

    /// Turns of the entries of `pattern`, in its order: those of the edges, and elsewhere of `across(x, y)`.
    pub(crate) fn turns(
        &self,
        edges: EdgesForTurns,
        pattern: &Pattern,
        across: impl Fn(usize, usize) -> TangentTurn + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Option<Vec<TangentTurn>>, Cancelled> {
        let Some((mut surface, mut at_vertex)) = self.sheet(progress)? else { return Ok(None) };
        if edges == EdgesForTurns::Delaunay {
            surface.flip_to_delaunay(progress)?;
            at_vertex = surface.triangles_at_vertices(self.points.len(), progress)?;
        }
        surface.turns(&at_vertex, self.symmetry, pattern, across, progress).map(Some)
    }

    /// Turns of each triangle with three different corners, in order, without those at vertices whose triangles are no
    /// fan. `None` as for [`turns`](Self::turns).
    pub(crate) fn triangle_turns(
        &self,
        progress: Progress<'_>,
    ) -> Result<Option<Vec<TriangleTurns>>, Cancelled> {
        let Some((surface, _)) = self.sheet(progress)? else { return Ok(None) };
        let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        let numbers: Vec<usize> = (0..self.triangles.len()).filter(|&t| proper(&self.triangles[t])).collect();
        let found = parallel::try_collect(numbers.len(), progress, |t| {
            let (curvature, turns) = surface.triangle_turns(t, self.symmetry)?;
            Some(TriangleTurns { triangle: numbers[t], curvature, turns })
        })?;
        Ok(Some(found.into_iter().flatten().collect()))
    }
}

/// Area of the Voronoi cell of `x`, whose triangles are `around`, in the surface of a Delaunay triangulation: at each
/// corner ⅛·(|a|²·cot α + |b|²·cot β) of its sides a and b with their opposite angles α and β.
fn cell_area(surface: &Triangulation, around: &[u32], x: usize) -> f64 {
    let mut before = None;
    let mut area = 0.0;
    for &t in around {
        // A triangle with two corners at x appears twice.
        if before.replace(t) == Some(t) {
            continue;
        }
        for h in (3 * t as usize..3 * t as usize + 3).filter(|&h| surface.corner[h] as usize == x) {
            let part = |side: usize| surface.length[side].powi(2) * surface.cotangent(side);
            area += 0.125 * (part(h) + part(previous(h)));
        }
    }
    area.max(0.0)
}

/// Cotangent weights `w(x,y) = ½(cot α + cot β)`, α and β opposite the edge; edges between the same two vertices
/// are added.
fn weights(
    surface: &Triangulation,
    at_vertex: &Pattern,
    n: usize,
    share: f64,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, Cancelled> {
    let row = |row: &mut Vec<(u32, f64)>, x: usize, columns: &mut Vec<u32>, weights: &mut Vec<f64>| {
        row.clear();
        let mut before = None;
        for &t in at_vertex.row(x) {
            // A triangle with two corners at x appears twice.
            if before.replace(t) == Some(t) {
                continue;
            }
            for h in 3 * t as usize..3 * t as usize + 3 {
                let (from, to) = (surface.corner[h], surface.corner[next(h)]);
                if from != to && (from as usize == x || to as usize == x) {
                    let other = if from as usize == x { to } else { from };
                    row.push((other, 0.5 * share * surface.cotangent(h)));
                }
            }
        }
        row.sort_by_key(|entry| entry.0);
        for edge in row.chunk_by(|a, b| a.0 == b.0) {
            let weight: f64 = edge.iter().map(|e| e.1).sum();
            if weight > NEGLIGIBLE {
                columns.push(edge[0].0);
                weights.push(weight);
            }
        }
    };
    CompressedRows::from_rows(n, rows_at_a_time(n), progress, Vec::new, row)
}

#[cfg(test)]
mod tests;
