//! Built-in shapes for tests, benchmarks and first steps: sphere, torus, bumpy plane, knot, a creature with fine
//! skin and a machined bracket; an image and a volume.
//!
//! Each is computed on demand; the same name and number of vertices give the same bits on any number of threads.
//! Closed forms of the first four shapes and the volume of the bracket are known; the creature represents a scanned
//! figure.

#![allow(clippy::cast_possible_wrap, reason = "grid coordinates and counts stay far below 2^31 here")]

mod bracket;
mod cell;
mod creature;
mod grids;
mod implicit;
mod knot;
mod noise;
mod plane;
mod polygonize;
mod relax;
mod ring;
mod sphere;
#[cfg(test)]
mod tests;
mod torus;
mod weave;

pub use grids::{GRID_SAMPLE_NAMES, GridSample};
pub use noise::{NoiseSigma, add_noise};

use crate::shape::Polygons;
use crate::{ClassifiedError, ErrorKind};
use implicit::V3;

/// Largest number of vertices of a sample.
pub const MAX_VERTICES: usize = 50_000_000;

/// Description of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleInfo {
    /// Name for [`Sample::from_name`].
    pub name: &'static str,
    /// One-line description.
    pub description: &'static str,
    /// Default number of vertices.
    pub default_vertices: usize,
    /// Smallest number of vertices.
    pub min_vertices: usize,
}

/// The samples, by name.
pub const SAMPLE_NAMES: [SampleInfo; 6] = [
    SampleInfo {
        name: "sphere",
        description: "unit sphere, vertices spread evenly by area",
        default_vertices: 10_000,
        min_vertices: 4,
    },
    SampleInfo {
        name: "torus",
        description: "torus round the z axis, radii 1 and 0.4",
        default_vertices: 10_000,
        min_vertices: torus::MIN_VERTICES,
    },
    SampleInfo {
        name: "plane",
        description: "square of side 2 with an open border and bumps of three sizes",
        default_vertices: 10_000,
        min_vertices: 4,
    },
    SampleInfo {
        name: "knot",
        description: "tube of radius 0.18 round a trefoil knot",
        default_vertices: 20_000,
        min_vertices: knot::MIN_VERTICES,
    },
    SampleInfo {
        name: "creature",
        description: "standing figure with shell, ears, claws, tail and fine skin; closed, genus 0",
        default_vertices: 50_000,
        min_vertices: creature::MIN_VERTICES,
    },
    SampleInfo {
        name: "bracket",
        description: "machined part with sharp edges, a hole, a fillet, a rounded edge and a thin flange; closed, genus 1",
        default_vertices: 10_000,
        min_vertices: bracket::MIN_VERTICES,
    },
];

/// Error of generating a sample.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// No sample has this name.
    #[error("there is no sample `{name}`; choose one of {}", names())]
    UnknownName {
        /// The requested name.
        name: String,
    },
    /// The number of vertices is out of range.
    #[error("{n_vertices} vertices asked for, but sample `{name}` has between {min} and {max}")]
    VertexCount {
        /// Name of the sample.
        name: &'static str,
        /// The requested number.
        n_vertices: usize,
        /// Smallest valid number.
        min: usize,
        /// Largest valid number.
        max: usize,
    },
    /// No grid gave the shape with that number of vertices.
    #[error(
        "sample `{name}` found no grid for {n_vertices} vertices in {tries} tries; ask for more vertices"
    )]
    NotReached {
        /// Name of the sample.
        name: &'static str,
        /// The requested number.
        n_vertices: usize,
        /// Number of grids tried.
        tries: usize,
    },
    /// The numbers of points and normals differ.
    #[error("{n_points} points but {n_normals} normals; give one normal for each point")]
    NormalsMismatch {
        /// Number of points.
        n_points: usize,
        /// Number of normals.
        n_normals: usize,
    },
    /// The standard deviation is negative, not finite, or so large that coordinates exceed
    /// [`MAX_COORDINATE`](crate::shape::MAX_COORDINATE).
    #[error("standard deviation {sigma:?} of the noise; give a number from 0 to 1e98")]
    BadSigma {
        /// The value found.
        sigma: f64,
    },
}

impl ClassifiedError for SampleError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

fn names() -> String {
    SAMPLE_NAMES.iter().chain(&GRID_SAMPLE_NAMES).map(|info| info.name).collect::<Vec<_>>().join(", ")
}

/// A generated shape: vertices in model units with y up, and triangles counter-clockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Vertex positions, model units.
    pub points: Vec<[f64; 3]>,
    /// Triangles.
    pub faces: Polygons,
}

/// Points drawn from a sample's surface.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleCloud {
    /// Positions, model units.
    pub points: Vec<[f64; 3]>,
    /// Unit outward normals.
    pub normals: Vec<[f64; 3]>,
}

impl Sample {
    /// Generates the sample `name` with about `n_vertices` vertices, or its default number.
    ///
    /// The sphere has exactly that number. Torus, plane and knot are regular grids with the nearest count, within 1
    /// % from 1000 vertices up; creature and bracket (from 2000 up) are within 2 %. All except the plane are
    /// closed. Euler characteristic: sphere and creature 2, torus, knot and bracket 0, plane 1. O(n) time and
    /// memory, at most about 300 bytes per vertex.
    ///
    /// ```
    /// use adwave::sample::Sample;
    /// let sphere = Sample::from_name("sphere", Some(500))?;
    /// assert_eq!((sphere.points.len(), sphere.faces.len()), (500, 996));
    /// # Ok::<(), adwave::sample::SampleError>(())
    /// ```
    ///
    /// # Errors
    /// [`SampleError::UnknownName`], whose message lists the names; [`SampleError::VertexCount`] outside
    /// `min_vertices` … [`MAX_VERTICES`]; [`SampleError::NotReached`] if the parts of the creature do not connect
    /// at that resolution.
    pub fn from_name(name: &str, n_vertices: Option<usize>) -> Result<Self, SampleError> {
        let info = SAMPLE_NAMES
            .iter()
            .find(|info| info.name == name)
            .ok_or_else(|| SampleError::UnknownName { name: name.to_owned() })?;
        let n = n_vertices.unwrap_or(info.default_vertices);
        if !(info.min_vertices..=MAX_VERTICES).contains(&n) {
            let (name, min) = (info.name, info.min_vertices);
            return Err(SampleError::VertexCount { name, n_vertices: n, min, max: MAX_VERTICES });
        }
        let (points, triangles) = match info.name {
            "sphere" => sphere::sphere(n),
            "torus" => torus::torus(n),
            "plane" => plane::plane(n),
            "knot" => knot::knot(n),
            "bracket" => bracket::bracket(n),
            _ => {
                let surface = creature::creature(n)?;
                (surface.points, surface.triangles)
            }
        };
        Ok(Self {
            points: points.into_iter().map(Into::into).collect(),
            faces: Polygons::from_triangles(&triangles),
        })
    }

    /// Unit outward vertex normals: the area-weighted mean of the face normals.
    pub fn normals(&self) -> Vec<[f64; 3]> {
        let mut normals = vec![V3::zeros(); self.points.len()];
        for face in self.faces.iter() {
            let normal = self.area_normal(face);
            for &v in face {
                normals[v as usize] += normal;
            }
        }
        normals.into_iter().map(|n| n.try_normalize(0.0).unwrap_or_else(V3::zeros).into()).collect()
    }

    /// Mean length of the distinct edges, model units.
    pub fn mean_edge_length(&self) -> f64 {
        let mut edges: Vec<(u32, u32)> = self
            .faces
            .iter()
            .flat_map(|face| (0..face.len()).map(move |k| (face[k], face[(k + 1) % face.len()])))
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let total: f64 = edges.iter().map(|&(a, b)| (self.corner(a) - self.corner(b)).norm()).sum();
        total / edges.len().max(1) as f64
    }

    /// Adds Gaussian noise along the [`normals`](Self::normals) by [`add_noise`], with the unit of `sigma`
    /// resolved.
    ///
    /// # Errors
    /// [`SampleError::BadSigma`] if `sigma` is negative, infinite or NaN.
    pub fn add_noise(&mut self, sigma: NoiseSigma, seed: u64) -> Result<(), SampleError> {
        let sigma = match sigma {
            NoiseSigma::Model(sigma) => sigma,
            NoiseSigma::MeanEdge(multiple) => multiple * self.mean_edge_length(),
        };
        let normals = self.normals();
        add_noise(&mut self.points, &normals, sigma, seed)
    }

    /// Draws `n_points` points from the surface, uniformly by area, with the normals of their faces. The same seed
    /// gives the same points. O(faces + n log faces).
    ///
    /// # Errors
    /// [`SampleError::VertexCount`] if `n_points` is more than [`MAX_VERTICES`].
    pub fn draw_cloud(&self, n_points: usize, seed: u64) -> Result<SampleCloud, SampleError> {
        if n_points > MAX_VERTICES {
            return Err(SampleError::VertexCount {
                name: "cloud",
                n_vertices: n_points,
                min: 0,
                max: MAX_VERTICES,
            });
        }
        let (points, normals) = noise::draw_cloud(self, n_points, seed);
        Ok(SampleCloud { points, normals })
    }

    fn corner(&self, v: u32) -> V3 {
        V3::from(self.points[v as usize])
    }

    /// Outward normal of a triangle, with twice its area as length.
    fn area_normal(&self, face: &[u32]) -> V3 {
        let [a, b, c] = [0, 1, 2].map(|k| self.corner(face[k]));
        (b - a).cross(&(c - a))
    }
}
