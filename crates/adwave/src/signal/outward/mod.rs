//! Which side of a surface is its outside.

mod cloud;
mod patches;
mod vote;

use crate::shape::{PreparedGeometry, Shape};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress};
use thiserror::Error;

/// Beyond this share of the area without an outside a shape counts as having none.
const MOST_WITHOUT: f64 = 0.1;

/// Unit normals that point out of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardNormals {
    /// At the welded vertices, in the analysis order; zero where neither side is outside.
    pub normals: Vec<[f64; 3]>,
    /// How the outside was found.
    pub info: OutwardInfo,
}

/// How the outside of a shape was found, part by part: pieces of a mesh that hang together by edges of two triangles, pieces
/// of a cloud that hang together by neighbors.
#[derive(Clone, Debug, PartialEq)]
pub struct OutwardInfo {
    /// Parts.
    pub n_parts: usize,
    /// Closed ones: their outside is where the volume that they enclose is not.
    pub n_closed: usize,
    /// Parts that follow the normals of the file.
    pub n_by_file: usize,
    /// Open parts whose outside is away from their own center, seen from most of the area.
    pub n_by_majority: usize,
    /// Open parts seen alike from both sides, whose triangles agree on one.
    pub n_as_given: usize,
    /// Parts without an outside: one-sided, flat, or seen alike from both sides.
    pub n_without: usize,
    /// Triangles that ran the other way round.
    pub n_turned: usize,
    /// Share of the area (of the points of a cloud) that has no outside, in [0, 1].
    pub without: f64,
}

impl OutwardInfo {
    /// Whether the normals say which side is outside on at least nine tenths of the area.
    pub fn has_outside(&self) -> bool {
        self.without <= MOST_WITHOUT
    }

    /// How the outside was found, in words; why there is none where there is none.
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
        format!("outside {}{turned}", used.join(", "))
    }
}

impl std::fmt::Display for OutwardInfo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.words())
    }
}

/// Why there are no outward normals.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum OutwardError {
    /// A graph has no positions.
    #[error("a graph has no positions, so it has no outside")]
    NoPositions,
    /// The file's normals are those of another shape.
    #[error(
        "there are {n_normals} normals and {n_vertices} vertices; give one normal for each vertex, or none"
    )]
    WrongLength {
        /// Normals given.
        n_normals: usize,
        /// Vertices of the shape.
        n_vertices: usize,
    },
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for OutwardError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}

/// Unit normals of a shape that point outwards, each part by itself. O(n log n).
///
/// *Mesh.* Triangles are turned to agree across every edge of two triangles; what hangs together so is a part. The outside of a
/// closed part is where its signed volume `⅓ Σ A_f·n_f·(x_f − c)` is positive, x_f the center of a triangle and c that of the
/// part. An open part follows the normals of the file (`file`, one for each vertex of the shape, of any length, zero
/// or NaN where there is none); without them the same sum decides, which then is the volume of the cones from c, where it is
/// clear: at least a fiftieth of `⅓ Σ A_f·|n_f·(x_f − c)|`. Where it is not, the part is taken as its triangles run if they agree.
/// A normal is the area-weighted mean of the triangles'.
///
/// *Cloud.* The normals of the file, or those of [`cloud_normals`](super::cloud_normals); a part without thickness, or
/// alike from both sides, has no outside.
///
/// Where a part is one-sided (a Möbius strip), flat, or alike from both sides there is no outside: [`OutwardInfo::without`].
///
/// # Errors
/// [`OutwardError`] of a graph, or where there is not one normal for each vertex; cancelled.
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
    let file = file.map(|normals| welded(geometry, normals));
    let (points, _) = geometry.unit_points(progress)?;
    Ok(match geometry.shape() {
        Shape::Mesh(_) => patches::normals(&points, geometry.triangles(), file.as_deref(), progress)?,
        Shape::Cloud(_) => cloud::normals(&points, file.as_deref(), progress)?,
        Shape::Graph(_) => return Err(OutwardError::NoPositions),
    })
}

/// The file's normals at the welded vertices, as unit vectors; zero where there is none.
fn welded(geometry: &PreparedGeometry, normals: &[f64]) -> Vec<[f64; 3]> {
    let mut sum = vec![[0.0; 3]; geometry.n_vertices()];
    for (normal, &x) in normals.chunks_exact(3).zip(geometry.vertex_map().as_slice()) {
        let unit = unit([normal[0], normal[1], normal[2]]);
        for (s, n) in sum[x as usize].iter_mut().zip(unit) {
            *s += n;
        }
    }
    sum.into_iter().map(unit).collect()
}

/// The unit vector, whatever the length; zero of what has no direction.
fn unit(v: [f64; 3]) -> [f64; 3] {
    let size = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if !(size.is_finite() && size > 0.0 && v.iter().all(|c| c.is_finite())) {
        return [0.0; 3];
    }
    crate::vector::unit(&v.map(|c| c / size)).unwrap_or_default()
}

#[cfg(test)]
mod tests;
