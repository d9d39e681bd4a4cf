//! Directions on a surface: tangent vectors, lines and crosses, and symmetric tensors, with bands, filters and regions.
//!
//! A direction at a vertex is a complex number in its tangent plane, `z = |v|·e^{isθ}`, with s = 1 for vectors, 2 for
//! lines (v and −v are the same) and 4 for crosses. On its way to a neighbor it turns with the surface, so that a step
//! of diffusion compares directions, not coordinates:
//!
//! `(Φ₁z)(x) = z(x) + Σ_y Φ₁(x,y)·(e^{isρ_xy}·z(y) − z(x))`
//!
//! with the entries of the operator of scalars and the angle ρ_xy between the planes at y and x. On a mesh these are the
//! angles of its intrinsic triangulation ([`laplacian`](crate::laplacian)); on a cloud, and where triangles do not form
//! an oriented surface, those of the smallest rotation between the normals. In a plane constants do not change, in any
//! coordinates; on a sphere no field of vectors but 0 is constant, and its smoothest ones decay.
//!
//! A symmetric tensor in the tangent plane is its trace, a scalar, and a line: its larger principal direction, with half
//! of the difference of the principal values as its length.
//!
//! Sources: `singer2012`, `knoppel2013`, `sharp2019signpost`.

mod planes;
mod singularities;
mod tensors;

pub use crate::laplacian::TangentPlane;
pub use singularities::Singularity;
pub use tensors::{TensorLogarithms, TensorOrder, exp_tensors, log_tensors};

use crate::bands::BandsError;
use crate::laplacian::{EdgesForTurns, MeshDirections, TangentTurn, turn_between};
use crate::operator::{NoRows, OperatorKind};
use crate::sparse::VectorDiffusion;
use crate::vector::dot;
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress, named_values, parallel};
use planes::tangent_planes;
use thiserror::Error;

/// Kind of directions, by the number of turns after which one counts as itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// Vectors.
    #[default]
    Vectors,
    /// Lines: v and −v are the same.
    Lines,
    /// Crosses: v is the same after a quarter of a turn.
    Crosses,
}

named_values!(Symmetry, "kind of direction", {
    Vectors => "vectors", "a direction and a length";
    Lines => "lines", "v and −v are the same, as for principal curvatures";
    Crosses => "crosses", "v is the same after a quarter turn, as for fields that guide quadrilaterals";
});

impl Symmetry {
    /// Order s: directions are the same after a turn by 2π/s.
    pub fn order(self) -> u32 {
        match self {
            Self::Vectors => 1,
            Self::Lines => 2,
            Self::Crosses => 4,
        }
    }

    /// The kind of order 1, 2 or 4.
    pub fn from_order(order: u32) -> Option<Self> {
        Self::ALL.iter().copied().find(|symmetry| symmetry.order() == order)
    }
}

/// Error of preparing a shape for directions, or of reading them.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DirectionsError {
    /// The domain has no tangent planes.
    #[error(
        "directions lie in the tangent planes of a mesh or a point cloud, and this is neither; on a grid or a graph the components are channels"
    )]
    NoSurface,
    /// The number of values does not match the shape.
    #[error("{what} need {expected} values, {per_vertex} for each of {n_vertices} vertices, got {n_found}")]
    Length {
        /// Name of the values.
        what: &'static str,
        /// Values found.
        n_found: usize,
        /// Values expected.
        expected: usize,
        /// Values for each vertex.
        per_vertex: usize,
        /// Vertices of the shape.
        n_vertices: usize,
    },
    /// A component is infinite.
    #[error("{what} must be finite, and vertex {vertex} has {value}; NaN stands for an unknown one")]
    Infinite {
        /// Name of the values.
        what: &'static str,
        /// The vertex, from 0.
        vertex: usize,
        /// The component.
        value: f64,
    },
    /// The operator has no rows that could be turned.
    #[error(transparent)]
    Rows(#[from] NoRows),
    /// The mesh has no oriented surface on which singularities could be counted.
    #[error(
        "singularities are counted on a mesh whose edges have at most two triangles with one orientation; repair the mesh, for instance by `adwave health`, or leave them out"
    )]
    NotOriented,
    /// The bands of the operator failed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for DirectionsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Rows(error) => error.kind(),
            Self::Bands(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}

/// Vectors split into the tangent planes and along the normals, in the order of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitVectors {
    /// Complex numbers in the tangent planes, n_vertices × 2.
    pub channels: Vec<f64>,
    /// Parts along the normals, n_vertices.
    pub normal: Vec<f64>,
    /// Share of the sum of squares that lies along the normals, 0 to 1, without vertices that are NaN.
    pub normal_share: f64,
}

/// Tensors split into the tangent planes and the rest, in the order of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitTensors {
    /// Traces of the tangent parts, n_vertices.
    pub trace: Vec<f64>,
    /// Lines of the tangent parts without their traces, n_vertices × 2.
    pub channels: Vec<f64>,
    /// Share of the sum of squares that does not lie in the tangent planes, 0 to 1.
    pub normal_share: f64,
}

/// A mesh or a point cloud prepared for directions of one kind.
///
/// ```
/// use adwave::bands::Schedule;
/// use adwave::directions::{Directions, Symmetry};
/// use adwave::sample::Sample;
/// use adwave::operator::{OperatorKind, OperatorParams};
/// use adwave::{Decomposer, Progress};
/// use adwave::shape::{Mesh, Shape};
///
/// // Rotation about the z-axis: on the unit sphere it decays as e^(−t), and a scalar of its shape as e^(−2t).
/// let sphere = Sample::from_name("sphere", Some(2562))?;
/// let sphere = Mesh::new(sphere.points, sphere.faces)?;
/// let params = OperatorParams::default().with_kind(OperatorKind::Surface);
/// let decomposer = Decomposer::with_params(&Shape::Mesh(sphere.clone()), &params, Progress::none())?;
/// let directions = Directions::new(&decomposer, Symmetry::Vectors, Progress::none())?;
/// let rotation: Vec<f64> = sphere.points().iter().flat_map(|p| [-p[1], p[0], 0.0]).collect();
/// let split = directions.split(&rotation)?;
/// assert!(split.normal_share < 1e-4);
/// let schedule = Schedule::real(vec![64.0])?;
/// let smooth = directions.decomposer().decompose(&split.channels, 2, &schedule)?;
/// let kept = smooth.coarsest().iter().zip(&split.channels).map(|(s, z)| s * z).sum::<f64>()
///     / split.channels.iter().map(|z| z * z).sum::<f64>();
/// let time = -kept.ln();
/// let steps = 64.0 * 4.0 * std::f64::consts::PI / (4.0 * 3.0_f64.sqrt() * 2562.0);
/// assert!((time - steps).abs() < 0.01 * steps, "{time} {steps}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Directions {
    symmetry: Symmetry,
    planes: Vec<TangentPlane>,
    decomposer: Decomposer,
}

impl Directions {
    /// Prepares the surface of `decomposer` for directions, with its operator, mask and levels. O(n log n).
    ///
    /// # Errors
    /// [`DirectionsError::NoSurface`] unless it is a mesh or a cloud, or its operator has no rows; or if the call is
    /// cancelled.
    pub fn new(
        decomposer: &Decomposer,
        symmetry: Symmetry,
        progress: Progress<'_>,
    ) -> Result<Self, DirectionsError> {
        let geometry = decomposer.geometry().ok_or(DirectionsError::NoSurface)?;
        if !geometry.shape().is_mesh() && !geometry.shape().is_cloud() {
            return Err(DirectionsError::NoSurface);
        }
        let scalars = decomposer.rows("a diffusion of directions")?;
        let planes = tangent_planes(geometry, decomposer.operator_params().neighbors, progress)?;
        let order = symmetry.order();
        // A sheet has one orientation, so that nothing is mirrored on it, however sharp it bends.
        let smallest_turn = |x: usize, y: usize, may_mirror: bool| {
            let (here, mut there) = (planes[x], planes[y]);
            if may_mirror && is_mirrored(&here, &there) {
                there.second = there.second.map(|c| -c);
                there.normal = there.normal.map(|c| -c);
            }
            // Without a plane nothing is known of the direction, and nothing arrives.
            turn_between(&here, &there, order).unwrap_or([0.0; 2])
        };
        let pattern = scalars.neighbors();
        let by_edges = if geometry.shape().is_mesh() {
            let (points, _) = geometry.unit_points(progress)?;
            let triangles = geometry.triangles();
            let mesh = MeshDirections { points: &points, triangles, planes: &planes, symmetry: order };
            let edges = match decomposer.operator_kind() {
                OperatorKind::Surface => EdgesForTurns::Delaunay,
                OperatorKind::Walk => EdgesForTurns::Mesh,
            };
            mesh.turns(edges, pattern, |x, y| smallest_turn(x, y, false), progress)?
        } else {
            None
        };
        let is_sheet = by_edges.is_some();
        let entries =
            (0..pattern.n_rows()).flat_map(|x| pattern.row(x).iter().map(move |&y| (x, y as usize)));
        let turns: Vec<TangentTurn> = match by_edges {
            Some(turns) => turns,
            None => entries.clone().map(|(x, y)| smallest_turn(x, y, true)).collect(),
        };
        let mirrors = |(x, y): (usize, usize)| if is_mirrored(&planes[x], &planes[y]) { -1.0 } else { 1.0 };
        let mirrors: Vec<f64> = if is_sheet { Vec::new() } else { entries.map(mirrors).collect() };
        let mirrors = if mirrors.iter().all(|m| *m > 0.0) { Vec::new() } else { mirrors };
        let operator = VectorDiffusion::new(scalars.clone(), turns, mirrors);
        let decomposer = decomposer.with_operator(operator)?;
        Ok(Self { symmetry, planes, decomposer })
    }

    /// Kind of the directions.
    pub fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// The surface with the operator of directions: bands, filters and regions of signals of two channels for each
    /// direction.
    pub fn decomposer(&self) -> &Decomposer {
        &self.decomposer
    }

    /// Tangent plane of a vertex of the shape. Welded vertices share theirs.
    pub fn plane(&self, vertex: usize) -> &TangentPlane {
        &self.planes[self.decomposer.vertex_map().welded(vertex)]
    }

    fn check(&self, what: &'static str, n_found: usize, per_vertex: usize) -> Result<usize, DirectionsError> {
        let n_vertices = self.decomposer.n_vertices();
        let expected = per_vertex * n_vertices;
        if n_found == expected {
            return Ok(n_vertices);
        }
        Err(DirectionsError::Length { what, n_found, expected, per_vertex, n_vertices })
    }

    /// Splits vectors in space (n_vertices × 3, in the order of the shape) into complex numbers in the tangent planes,
    /// `|v|·e^{isθ}`, and parts along the normals. O(n).
    ///
    /// # Errors
    /// [`DirectionsError`] unless there are three values for each vertex, or if one is infinite.
    pub fn split(&self, vectors: &[f64]) -> Result<SplitVectors, DirectionsError> {
        let n = self.check("vectors", vectors.len(), 3)?;
        check_finite("vectors", vectors, 3)?;
        let order = self.symmetry.order();
        let vectors: &[[f64; 3]] = vectors.as_chunks().0;
        let parts = parallel::collect(n, |v| self.plane(v).coordinates(&vectors[v]));
        let channels = parts.iter().flat_map(|&[a, b, _]| power(a, b, order)).collect();
        let normal: Vec<f64> = parts.iter().map(|p| p[2]).collect();
        let unit = largest(vectors.as_flattened());
        let square =
            |values: &[f64]| values.iter().map(|v| (v / unit).powi(2)).filter(|s| s.is_finite()).sum();
        let normal_share = share(square(&normal), square(vectors.as_flattened()));
        Ok(SplitVectors { channels, normal, normal_share })
    }

    /// Vectors in space, n_vertices × 3, of complex numbers in the tangent planes (n_vertices × 2): of a line or a cross
    /// one of the directions that are the same. O(n).
    ///
    /// # Errors
    /// [`DirectionsError::Length`] unless there are two values for each vertex.
    pub fn join(&self, channels: &[f64]) -> Result<Vec<f64>, DirectionsError> {
        let n = self.check("directions", channels.len(), 2)?;
        let channels: &[[f64; 2]] = channels.as_chunks().0;
        let order = f64::from(self.symmetry.order());
        let vectors = parallel::collect(n, |v| {
            let [a, b] = channels[v];
            let flat = if order == 1.0 {
                [a, b]
            } else {
                let (sin, cos) = (b.atan2(a) / order).sin_cos();
                let length = a.hypot(b);
                [length * cos, length * sin]
            };
            self.plane(v).vector(flat)
        });
        Ok(vectors.into_flattened())
    }

    /// Splits symmetric tensors in space (n_vertices × 6: xx, xy, xz, yy, yz, zz) into the traces and the lines of their
    /// tangent parts `PTP`. A tensor's line is its larger principal direction with half of the difference of the
    /// principal values as its length. O(n).
    ///
    /// # Errors
    /// [`DirectionsError`] unless there are six values for each vertex and the directions are lines, or if a value is
    /// infinite.
    pub fn split_tensors(&self, tensors: &[f64]) -> Result<SplitTensors, DirectionsError> {
        let n = self.check("symmetric tensors", tensors.len(), 6)?;
        check_finite("symmetric tensors", tensors, 6)?;
        let unit = largest(tensors);
        let tensors: &[[f64; 6]] = tensors.as_chunks().0;
        let parts = parallel::collect(n, |v| {
            let [xx, xy, xz, yy, yz, zz] = tensors[v];
            let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let plane = self.plane(v);
            let apply = |u: &[f64; 3]| [0, 1, 2].map(|c| dot(&rows[c], u));
            let (first, second) = (apply(&plane.first), apply(&plane.second));
            let (a, b, c) =
                (dot(&plane.first, &first), dot(&plane.first, &second), dot(&plane.second, &second));
            let square = |values: &[f64]| values.iter().map(|t| (t / unit).powi(2)).sum::<f64>();
            let (inside, all) = (square(&[a, b, b, c]), square(rows.as_flattened()));
            [a + c, 0.5 * (a - c), b, inside, all]
        });
        let sum = |k: usize| parts.iter().map(|p| p[k]).filter(|v| v.is_finite()).sum::<f64>();
        let (inside, all) = (sum(3), sum(4));
        Ok(SplitTensors {
            trace: parts.iter().map(|p| p[0]).collect(),
            channels: parts.iter().flat_map(|p| [p[1], p[2]]).collect(),
            normal_share: share((all - inside).max(0.0), all),
        })
    }

    /// Symmetric tensors in space, n_vertices × 6, of traces and lines in the tangent planes. O(n).
    ///
    /// # Errors
    /// [`DirectionsError::Length`] unless there are a trace and two values for each vertex.
    pub fn join_tensors(&self, trace: &[f64], channels: &[f64]) -> Result<Vec<f64>, DirectionsError> {
        let n = self.check("traces", trace.len(), 1)?;
        self.check("lines", channels.len(), 2)?;
        let channels: &[[f64; 2]] = channels.as_chunks().0;
        let tensors = parallel::collect(n, |v| {
            let ([d, b], plane) = (channels[v], self.plane(v));
            let (a, c) = (0.5 * trace[v] + d, 0.5 * trace[v] - d);
            let (p, q) = (&plane.first, &plane.second);
            let entry =
                |i: usize, j: usize| a * p[i] * p[j] + c * q[i] * q[j] + b * (p[i] * q[j] + q[i] * p[j]);
            [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
        });
        Ok(tensors.into_flattened())
    }
}

/// Refuses infinite components, which would make some numbers of a direction unknown and others not.
fn check_finite(what: &'static str, values: &[f64], per_vertex: usize) -> Result<(), DirectionsError> {
    match values.iter().position(|value| value.is_infinite()) {
        Some(at) => Err(DirectionsError::Infinite { what, vertex: at / per_vertex, value: values[at] }),
        None => Ok(()),
    }
}

/// True if two planes have opposite orientations.
fn is_mirrored(here: &TangentPlane, there: &TangentPlane) -> bool {
    dot(&here.normal, &there.normal) < 0.0
}

/// The complex number `|v|·e^{isθ}` of the vector (a, b) = |v|·e^{iθ}.
fn power(a: f64, b: f64, order: u32) -> [f64; 2] {
    let length = a.hypot(b);
    if order == 1 || length == 0.0 {
        return [a, b];
    }
    let (mut z, unit) = ([a / length, b / length], [a / length, b / length]);
    for _ in 1..order {
        z = [z[0] * unit[0] - z[1] * unit[1], z[0] * unit[1] + z[1] * unit[0]];
    }
    z.map(|c| length * c)
}

/// Largest finite absolute value, or 1 if none is above 0: a unit whose squares neither overflow nor underflow.
fn largest(values: &[f64]) -> f64 {
    let largest = values.iter().map(|v| v.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Share of a part, at most 1.
fn share(part: f64, all: f64) -> f64 {
    if all > 0.0 { (part / all).min(1.0) } else { 0.0 }
}
