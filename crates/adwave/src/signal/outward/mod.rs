//! Outside of a surface.

mod cloud;
mod patches;
mod vote;

use super::FIT_NEIGHBORS;
use crate::shape::NoShape;
use crate::shape::{GivenNormals, NormalCheck, NormalSigns, PreparedGeometry, Shape, welded_normals};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress};
use std::borrow::Cow;
use thiserror::Error;

/// Share of the area without an outside beyond which a shape counts as having none.
const MOST_WITHOUT: f64 = 0.1;

/// Unit outward normals of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardNormals {
    /// Normals at the welded vertices, in the analysis order; zero if neither side is outside.
    pub normals: Vec<[f64; 3]>,
    /// Method by which the outside was found.
    pub info: OutwardInfo,
}

/// Method by which the outside of a shape was found, per part: pieces of a mesh connected by edges of two
/// triangles, or pieces of a cloud connected by neighbors.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardInfo {
    /// Number of parts.
    pub n_parts: usize,
    /// Number of closed parts, whose outside is opposite to the enclosed volume.
    pub n_closed: usize,
    /// Number of parts that follow the normals of the file.
    pub n_by_file: usize,
    /// Number of open parts oriented away from their own center, by most of the area.
    pub n_by_majority: usize,
    /// Number of open parts that look the same from both sides and keep the consistent orientation of their
    /// triangles.
    pub n_as_given: usize,
    /// Number of parts without an outside: one-sided, flat, or the same from both sides.
    pub n_without: usize,
    /// Number of triangles that were reversed.
    pub n_turned: usize,
    /// Share of the area (of the points of a cloud) without an outside, in [0, 1].
    pub without: f64,
    /// Check of the given normals of a cloud; `None` for a mesh and without normals.
    pub given: Option<NormalCheck>,
}

impl OutwardInfo {
    /// True if the outside is known on at least nine tenths of the area.
    pub fn has_outside(&self) -> bool {
        self.without <= MOST_WITHOUT
    }

    /// Describes how the outside was found, or why there is none.
    ///
    /// ```
    /// use adwave::Progress;
    /// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
    /// use adwave::signal::outward_normals;
    /// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    /// let flat = Shape::Mesh(Mesh::new(square, Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]))?);
    /// let geometry = PreparedGeometry::new(&flat, WeldMode::EqualPositions, Progress::none())?;
    /// let info = outward_normals(&geometry, None, Progress::none())?.info;
    /// assert!(!info.has_outside());
    /// assert_eq!(info.to_string(), "no side is outside: the shape is flat, one-sided, or alike from both sides");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn words(&self) -> String {
        if !self.has_outside() {
            return "no side is outside: the shape is flat, one-sided, or alike from both sides".to_owned();
        }
        let ways = [
            (self.n_closed, "by the volume enclosed"),
            (self.n_by_file, "by the file's normals"),
            (self.n_by_majority, "away from the center of an open part"),
            (self.n_as_given, "as the triangles run"),
            (self.n_without, "none"),
        ];
        let used: Vec<String> = match ways.iter().filter(|(n, _)| *n > 0).collect::<Vec<_>>()[..] {
            [(_, way)] => vec![(*way).to_owned()],
            ref several => {
                several.iter().map(|(n, way)| format!("{way} ({n} of {})", self.n_parts)).collect()
            }
        };
        let turned = match self.n_turned {
            0 => String::new(),
            1 => "; 1 triangle turned over".to_owned(),
            n => format!("; {n} triangles turned over"),
        };
        format!("outside {}{turned}{}", used.join(", "), self.given_words())
    }
}

impl OutwardInfo {
    /// Peculiarities of the given normals of a cloud; empty if there are none.
    fn given_words(&self) -> String {
        let Some(given) = self.given else { return String::new() };
        let signs = match given.signs {
            NormalSigns::AsGiven => String::new(),
            NormalSigns::Repaired => format!(", {} of them turned over", given.n_turned),
            NormalSigns::Unoriented => ", as the file's normals are not oriented".to_owned(),
        };
        let inward = match given.n_inward {
            0 => "",
            _ => "; they point inward, so convex and concave are exchanged",
        };
        signs + inward
    }
}

impl std::fmt::Display for OutwardInfo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.words())
    }
}

/// Error of finding outward normals.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum OutwardError {
    /// The shape is a graph or curve, which has no surface.
    #[error("a graph has no surface, so it has no outside")]
    NoPositions,
    /// The number of normals does not match the shape.
    #[error(
        "there are {n_normals} normals and {n_vertices} vertices; give one normal for each vertex, or none"
    )]
    WrongLength {
        /// Number of normals given.
        n_normals: usize,
        /// Number of vertices of the shape.
        n_vertices: usize,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<NoShape> for OutwardError {
    fn from(_: NoShape) -> Self {
        Self::NoPositions
    }
}

impl ClassifiedError for OutwardError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}

/// Unit outward normals of a shape, each part separately. O(n log n).
///
/// *Mesh.* Triangles are reversed until they agree across every edge of two triangles; connected triangles form a
/// part. The outside of a closed part is where its signed volume `⅓ Σ A_f·n_f·(x_f − c)` is positive, x_f the
/// center of a triangle and c that of the part. An open part follows the normals of the file (`file`, one for each
/// vertex of the shape, of any length, zero or NaN where there is none). Without them the same sum, which is then
/// the volume of the cones from c, decides if it is clear: at least a fiftieth of `⅓ Σ A_f·|n_f·(x_f − c)|`.
/// Otherwise the part keeps the orientation of its triangles if they agree. A normal is the area-weighted mean of
/// the triangle normals.
///
/// *Cloud.* The normals of the file where neighbors agree on the side ([`GivenNormals`]); else those of
/// [`cloud_normals`](super::cloud_normals), or the axes of the file oriented in the same way. A part of these that has
/// no thickness, or is the same from both sides, has no outside.
///
/// A part that is one-sided (a Möbius strip), flat, or the same from both sides has no outside; see
/// [`OutwardInfo::without`].
///
/// # Errors
/// [`OutwardError`] for a graph, unless there is one normal per vertex, or if the call is cancelled.
pub fn outward_normals(
    geometry: &PreparedGeometry,
    file: Option<&[f64]>,
    progress: Progress<'_>,
) -> Result<OutwardNormals, OutwardError> {
    let map = geometry.vertex_map();
    if let Some(normals) = file
        && normals.len() != 3 * map.n_vertices()
    {
        return Err(OutwardError::WrongLength { n_normals: normals.len() / 3, n_vertices: map.n_vertices() });
    }
    let welded = |normals: &[f64]| {
        let rows = normals.as_chunks().0.iter().copied();
        welded_normals(rows, map.as_slice(), map.n_welded())
    };
    let (points, _) = geometry.unit_points(progress)?;
    Ok(match geometry.shape() {
        Shape::Mesh(_) => patches::normals(&points, geometry, file.map(welded).as_deref(), progress)?,
        Shape::Cloud(cloud) => {
            let is_known = |file: &[f64]| cloud.normals().is_some_and(|own| own.as_flattened() == file);
            let near = geometry.nearest(&points, FIT_NEIGHBORS, progress)?;
            let given = match file {
                Some(file) if is_known(file) => geometry.given_normals().map(Cow::Borrowed),
                Some(file) => GivenNormals::new(&points, &near, &welded(file), progress)?.map(Cow::Owned),
                None => None,
            };
            cloud::normals(&points, &near, geometry, given.as_deref(), progress)?
        }
        Shape::Graph(_) => return Err(OutwardError::NoPositions),
    })
}

#[cfg(test)]
mod tests;
