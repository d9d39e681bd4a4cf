//! Changes of a shape that features should survive.

use crate::sample::add_noise;
use crate::shape::NoShape;
use crate::shape::{
    Mesh, PointCloud, Polygons, PreparedGeometry, Shape, face_vertex_normals, nearest_neighbors,
};
use crate::signal::{FIT_NEIGHBORS, cloud_normals};
use crate::{ClassifiedError, Decomposer, ErrorKind};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use std::collections::HashMap;
use thiserror::Error;

/// A change of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Change {
    /// Moves every vertex along its normal by a normal deviate with standard deviation `edges` in mean edge lengths
    /// (Fig. 10 of the paper: 0.1 … 0.5).
    Noise {
        /// Standard deviation in mean edge lengths (mean neighbor distances on a cloud), ≥ 0.
        edges: f64,
        /// Seed.
        seed: u64,
    },
    /// Rotates about the origin by a uniformly distributed rotation.
    Rotation {
        /// Seed.
        seed: u64,
    },
    /// Multiplies every coordinate by a factor.
    Scaling {
        /// The factor, > 0.
        factor: f64,
    },
    /// Adds a vertex in the middle of every mesh edge, splitting each triangle into four; removes a random half of
    /// the points of a cloud.
    Resampling {
        /// Seed of the half that a cloud loses.
        seed: u64,
    },
}

/// Error of changing a shape.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ChangeError {
    /// The shape is a graph, which has no positions.
    #[error("a graph has no positions that could be changed")]
    NoPositions,
    /// The domain is no shape.
    #[error(transparent)]
    NoShape(#[from] NoShape),
    /// A parameter is out of its range.
    #[error("the {what} is {value}; it must be a finite number {range}")]
    Number {
        /// Name of the parameter.
        what: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Valid range.
        range: &'static str,
    },
    /// The result has too many vertices to index, or a coordinate that is too large.
    #[error("the changed shape is too large")]
    TooLarge,
}

impl ClassifiedError for ChangeError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// A changed shape, with the inverse of its rotation and scaling.
#[derive(Clone, Debug)]
pub struct ChangedShape {
    /// The shape.
    pub shape: Shape,
    rotation: Rotation3<f64>,
    factor: f64,
}

impl ChangedShape {
    /// A shape with other vertices on the same surface, neither rotated nor scaled.
    pub fn resampled(shape: Shape) -> Self {
        Self { shape, rotation: Rotation3::identity(), factor: 1.0 }
    }

    /// Position of a point of the changed shape before rotation and scaling; noise is not undone.
    pub fn before(&self, point: &[f64; 3]) -> [f64; 3] {
        (self.rotation.inverse() * (Vector3::from(*point) / self.factor)).into()
    }

    /// A length of the changed shape before scaling.
    pub fn length_before(&self, length: f64) -> f64 {
        length / self.factor
    }
}

/// Changes a shape. The same seed gives the same change. O(n), with noise on a cloud O(n log n).
///
/// # Errors
/// [`ChangeError`] for a graph, a parameter out of its range, or a result that is too large.
pub fn change(shape: &Shape, decomposer: &Decomposer, change: &Change) -> Result<ChangedShape, ChangeError> {
    let geometry = decomposer.geometry_for("a change of positions")?;
    let points = shape.points().ok_or(ChangeError::NoPositions)?;
    let number = |what, value: f64, valid: bool, range| {
        if value.is_finite() && valid { Ok(()) } else { Err(ChangeError::Number { what, value, range }) }
    };
    let (mut rotation, mut factor) = (Rotation3::identity(), 1.0);
    let changed = match *change {
        Change::Noise { edges, seed } => {
            number("noise", edges, edges >= 0.0, "of at least 0")?;
            noisy(shape, geometry, edges * decomposer.mean_length(), seed)
        }
        Change::Rotation { seed } => {
            rotation = random_rotation(seed);
            with_points(shape, points.iter().map(|p| (rotation * Vector3::from(*p)).into()).collect())
        }
        Change::Scaling { factor: f } => {
            number("factor", f, f > 0.0, "above 0")?;
            factor = f;
            with_points(shape, points.iter().map(|p| p.map(|c| c * f)).collect())
        }
        Change::Resampling { seed } => match shape {
            Shape::Mesh(_) => subdivided(geometry),
            _ => half(geometry.points(), seed),
        },
    };
    let shape = changed.ok_or(ChangeError::TooLarge)?;
    Ok(ChangedShape { shape, rotation, factor })
}

/// The shape with new positions.
fn with_points(shape: &Shape, points: Vec<[f64; 3]>) -> Option<Shape> {
    match shape {
        Shape::Mesh(mesh) => Mesh::new(points, mesh.faces().clone()).map(Shape::Mesh),
        _ => PointCloud::new(points).map(Shape::Cloud),
    }
    .ok()
}

fn noisy(shape: &Shape, geometry: &PreparedGeometry, sigma: f64, seed: u64) -> Option<Shape> {
    // Applied to the welded vertices, so that they stay welded.
    let normals = match shape {
        Shape::Mesh(_) => face_vertex_normals(geometry.points(), geometry.faces()),
        _ => cloud_normals(geometry.points(), &nearest_neighbors(geometry.points(), FIT_NEIGHBORS)),
    };
    let mut points = geometry.points().to_vec();
    add_noise(&mut points, &normals, sigma, seed).ok()?;
    with_points(shape, geometry.vertex_map().scatter(&points, 1))
}

fn random_rotation(seed: u64) -> Rotation3<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    // A quaternion of four normal deviates is uniformly distributed over the directions of its sphere.
    let q: [f64; 4] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(q[0], q[1], q[2], q[3])).to_rotation_matrix()
}

/// Splits every triangle of the welded mesh into four.
fn subdivided(geometry: &PreparedGeometry) -> Option<Shape> {
    let mut points = geometry.points().to_vec();
    let mut middle: HashMap<(u32, u32), u32> = HashMap::new();
    let mut faces = Vec::with_capacity(4 * geometry.triangles().len());
    for &[a, b, c] in geometry.triangles() {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            *middle.entry((p.min(q), p.max(q))).or_insert_with(|| {
                let (p, q) = (points[p as usize], points[q as usize]);
                points.push(std::array::from_fn(|k| 0.5 * p[k] + 0.5 * q[k]));
                (points.len() - 1) as u32
            })
        });
        faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    if faces.len() > u32::MAX as usize / 3 {
        return None;
    }
    Mesh::new(points, Polygons::from_triangles(&faces)).ok().map(Shape::Mesh)
}

/// A random half of the points, at least one.
fn half(points: &[[f64; 3]], seed: u64) -> Option<Shape> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut keys: Vec<(f64, usize)> =
        (0..points.len()).map(|x| (StandardNormal.sample(&mut random), x)).collect();
    keys.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    keys.truncate(points.len().div_ceil(2));
    PointCloud::new(keys.into_iter().map(|(_, x)| points[x]).collect()).ok().map(Shape::Cloud)
}
