//! Attributes of a file that depend on the positions of its vertices: normals and tangents follow when these move.

use std::sync::Arc;

use adwave::Progress;
use adwave::signal::{MovedPoints, StoredNormals, moved_cloud_normals, moved_corner_normals, moved_tangent};

use crate::model::source_document::DocumentNormals;
use crate::{Field, ShapeFile, ShapeFileError};

/// Treatment of normals and tangents in a file whose vertices move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MovedNormals {
    /// Normals and tangents are computed from the new positions.
    #[default]
    Follow,
    /// The old normals and tangents stay.
    Keep,
}

/// Attributes that depend on positions, after the vertices of a file have moved.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MovedAttributes {
    /// Attributes that were computed from the new positions.
    pub followed: Vec<String>,
    /// Attributes that still belong to the old positions.
    pub stale: Vec<String>,
}

impl MovedAttributes {
    /// One line about the attributes; `None` if there are none.
    ///
    /// ```
    /// use adwave_io::MovedAttributes;
    /// let attributes = MovedAttributes { followed: vec!["normals".into(), "tangents".into()], stale: vec![] };
    /// assert_eq!(attributes.note().unwrap(), "normals and tangents were recomputed from the new positions");
    /// ```
    pub fn note(&self) -> Option<String> {
        let join = |names: &[String]| names.join(" and ");
        let followed = || format!("{} were recomputed from the new positions", join(&self.followed));
        let stale = || format!("{} are those of the old positions", join(&self.stale));
        match (self.followed.is_empty(), self.stale.is_empty()) {
            (true, true) => None,
            (false, true) => Some(followed()),
            (true, false) => Some(stale()),
            (false, false) => Some(format!("{}; {}", followed(), stale())),
        }
    }
}

/// True if a field holds normals as floating-point numbers.
pub(crate) fn is_normal(field: &Field) -> bool {
    let name = field.name.to_ascii_lowercase();
    field.n_channels == 3
        && !field.values.value_type().is_integer()
        && (name == "normal" || name == "normals")
}

/// True if a field holds tangents as floating-point numbers: a direction, and in the fourth channel a side.
pub(crate) fn is_tangent(field: &Field) -> bool {
    let name = field.name.to_ascii_lowercase();
    matches!(field.n_channels, 3 | 4) && !field.values.value_type().is_integer() && name == "tangent"
}

fn rows_of_three(values: &[f64]) -> Vec<[f64; 3]> {
    values.as_chunks().0.to_vec()
}

impl ShapeFile {
    /// Replaces the coordinates of all vertices, like [`set_points`](Self::set_points), together with the normals and
    /// tangents that depend on them.
    ///
    /// Corners and vertices at one position that shared one normal share one afterwards, so that creases and flat
    /// faces stay as they are; normals of clouds come from the planes of neighboring points, on the side of the old
    /// ones. Tangents become perpendicular to the new normals. Values keep their bits where nothing moved.
    ///
    /// ```
    /// use adwave_io::{MovedNormals, ReadLimits, read_bytes};
    /// # use adwave::Progress;
    /// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
    /// let mut file = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap();
    /// let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    /// let attributes = file.move_points(points, MovedNormals::Follow, Progress::none())?;
    /// assert_eq!(attributes.followed, ["normals"]);
    /// assert_eq!(file.field("normal").unwrap().to_f64()[..3], [0.0, -1.0, 0.0]);
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`set_points`](Self::set_points), and [`ShapeFileError::Cancelled`] if the call is cancelled.
    pub fn move_points(
        &mut self,
        points: Vec<[f64; 3]>,
        normals: MovedNormals,
        progress: Progress<'_>,
    ) -> Result<MovedAttributes, ShapeFileError> {
        let before = Arc::clone(&self.points);
        self.set_points(points)?;
        let after = Arc::clone(&self.points);
        let same = |k: usize| before[k].map(f64::to_bits) == after[k].map(f64::to_bits);
        if before.len() != after.len() || crate::progress::all(before.len(), progress, same)? {
            return Ok(MovedAttributes::default());
        }
        let moved = MovedPoints { before: &before, after: &after };
        let mut attributes = MovedAttributes::default();
        self.move_normals(&moved, normals, &mut attributes, progress)?;
        if let Some(source) = &self.original {
            attributes.stale.extend(source.stale_attributes());
        }
        Ok(attributes)
    }

    fn move_normals(
        &mut self,
        moved: &MovedPoints<'_>,
        rule: MovedNormals,
        attributes: &mut MovedAttributes,
        progress: Progress<'_>,
    ) -> Result<(), ShapeFileError> {
        let normal = self.vertex_fields.iter().find(|f| is_normal(f)).cloned();
        let tangents: Vec<Field> = self.vertex_fields.iter().filter(|f| is_tangent(f)).cloned().collect();
        let corners = self.document_normals();
        // A curve has no normals that follow from its points.
        let has_surface = !self.faces.is_empty() || self.edges.pairs.is_empty();
        // A shape without a file may name vertices that it does not have, which only writing refuses.
        let has_surface = has_surface && self.faces.corners().iter().all(|&v| (v as usize) < self.n_vertices);
        let follows = rule == MovedNormals::Follow && has_surface;
        let list = if follows { &mut attributes.followed } else { &mut attributes.stale };
        if normal.is_some() {
            list.push("normals".to_owned());
        }
        if corners.is_some() && normal.is_none() {
            list.push("normals of face corners".to_owned());
        }
        let can_follow = follows && normal.is_some();
        if !tangents.is_empty() {
            let list = if can_follow { list } else { &mut attributes.stale };
            list.push("tangents".to_owned());
        }
        self.move_face_normals(attributes);
        if !follows {
            return Ok(());
        }
        let corner_normals = match corners {
            Some(corners) => {
                let stored = StoredNormals {
                    faces: &self.faces,
                    normals: &corners.normals,
                    of_corner: &corners.of_corner,
                    is_flat: &corners.is_flat,
                };
                Some(moved_corner_normals(moved, &stored, progress)?)
            }
            None => None,
        };
        if let Some(field) = normal {
            let old = rows_of_three(&field.to_f64());
            let new = match &corner_normals {
                Some(normals) => self.vertex_normals_of_corners(&old, normals),
                None => self.moved_vertex_normals(moved, &old, progress)?,
            };
            for tangent in tangents {
                let mut values = tangent.to_f64();
                for (v, row) in values.chunks_exact_mut(tangent.n_channels).enumerate() {
                    if new[v].map(f64::to_bits) != old[v].map(f64::to_bits) {
                        let tangent = moved_tangent([row[0], row[1], row[2]], new[v]);
                        row[..3].copy_from_slice(&tangent);
                    }
                }
                self.add_vertex_field(tangent.with_values_rounded(&values))?;
            }
            self.add_vertex_field(field.with_values_rounded(new.as_flattened()))?;
        }
        self.corner_normals = corner_normals.map(Arc::new);
        Ok(())
    }

    /// Normals of the vertices from those of their corners; the old one at vertices without.
    fn vertex_normals_of_corners(&self, old: &[[f64; 3]], corners: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut new = old.to_vec();
        for (&v, normal) in self.faces.corners().iter().zip(corners) {
            if normal.iter().all(|x| x.is_finite()) {
                new[v as usize] = *normal;
            }
        }
        new
    }

    /// Normals of the vertices at their new positions.
    fn moved_vertex_normals(
        &self,
        moved: &MovedPoints<'_>,
        old: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, ShapeFileError> {
        if self.faces.is_empty() {
            return Ok(moved_cloud_normals(moved, old, progress)?);
        }
        let of_corner = self.faces.corners();
        let stored = StoredNormals { faces: &self.faces, normals: old, of_corner, is_flat: &[] };
        let new_corners = moved_corner_normals(moved, &stored, progress)?;
        Ok(self.vertex_normals_of_corners(old, &new_corners))
    }

    /// Normals of face corners that were set before, or that the document holds.
    fn document_normals(&self) -> Option<DocumentNormals> {
        let Some(normals) = &self.corner_normals else {
            return self.original.as_ref()?.corner_normals(self);
        };
        let of_corner = (0..normals.len() as u32)
            .map(|k| if normals[k as usize][0].is_nan() { u32::MAX } else { k })
            .collect();
        Some(DocumentNormals { normals: normals.to_vec(), of_corner, is_flat: Vec::new() })
    }

    /// Reports normals of whole faces, which writers of triangles compute and other documents copy.
    fn move_face_normals(&self, attributes: &mut MovedAttributes) {
        let is_computed = self.original.as_ref().is_some_and(|source| source.computes_face_normals());
        if !is_computed && self.face_fields.iter().any(is_normal) {
            attributes.stale.push("normals of faces".to_owned());
        }
    }
}
