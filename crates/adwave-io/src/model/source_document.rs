//! Content of the file that a shape was read from, kept to write the same file again with the changes.

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use crate::model::context::WriteContext;
use crate::model::subset::Subset;
use crate::{Format, ShapeFile, WriteError};

/// Outcome of an update.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Update {
    /// The document was written with all changes.
    Written,
    /// The document cannot hold the changes and nothing was written: a plain new file is needed.
    DoesNotFit,
}

/// Normals of face corners that only the kept document holds.
pub(crate) struct DocumentNormals {
    pub(crate) normals: Vec<[f64; 3]>,
    /// Index of the normal of each corner, or a larger number.
    pub(crate) of_corner: Vec<u32>,
    /// Faces that are shaded flat; empty if there are none.
    pub(crate) is_flat: Vec<bool>,
}

/// A file that was read, as far as its format needs it to write the same file again.
///
/// Each format implements it for its own type and finds that type again with [`ShapeFile::source`]; other modules use
/// the trait only.
pub(crate) trait SourceDocument: Any + Debug + Send + Sync {
    /// Writes the document with the positions and fields of the shape.
    ///
    /// # Errors
    /// Writing fails, or the shape has values that the format cannot hold.
    fn update(&self, _: &ShapeFile, _: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        Ok(Update::DoesNotFit)
    }

    /// True if a document of the format `read` can be updated as the format `written`.
    fn can_update(&self, read: Format, written: Format) -> bool {
        read == written
    }

    /// True if files of that format keep the extras of the shape, because they are written from this document.
    fn keeps_extras(&self, _: Format) -> bool {
        false
    }

    /// Document of some of the vertices (indices of the shape, increasing), as far as it is independent of the others.
    fn subset(&self, _vertices: &[u32]) -> Option<Arc<dyn SourceDocument>> {
        None
    }

    /// Document in which the flagged faces are turned over; `None` if a plain new file has to be written.
    fn with_turned_faces(&self, _is_turned: &[bool]) -> Option<Arc<dyn SourceDocument>> {
        None
    }

    /// Part of the shape made from the document itself, with the content that only the document holds; `None` if the
    /// shape's own arrays hold all of it.
    fn subset_shape(&self, _: &ShapeFile, _: &Subset<'_>) -> Option<ShapeFile> {
        None
    }

    /// Normals of face corners, if the document has any that are no vertex field.
    fn corner_normals(&self, _: &ShapeFile) -> Option<DocumentNormals> {
        None
    }

    /// True if the document is written with normals of faces that are computed from the points.
    fn computes_face_normals(&self) -> bool {
        false
    }

    /// Names of content that depends on positions and stays as it is when these change.
    fn stale_attributes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Names of other files that the written document refers to, such as libraries of materials.
    fn references(&self) -> Vec<String> {
        Vec::new()
    }

    /// One label per corner of the faces, equal where texture coordinate, material and group are; `None` if nothing
    /// differs that way.
    fn corner_labels(&self, shape: &ShapeFile) -> Option<Vec<u32>> {
        shape.labels_by_texcoord()
    }

    /// Two texture coordinates per corner of the faces, if the document has some that are no vertex field.
    fn corner_texcoords(&self, _: &ShapeFile) -> Option<Vec<f64>> {
        None
    }
}

/// Name in [`ShapeFile::extras`] of texture coordinates that are no vertex field.
pub(crate) const CORNER_TEXCOORDS: &str = "texture coordinates of face corners";

impl ShapeFile {
    /// Two texture coordinates per corner of the faces, if the document has some and no vertex field replaces them.
    pub(crate) fn corner_texcoords(&self) -> Option<Vec<f64>> {
        let source = self.original.as_deref().filter(|_| self.field("texcoord").is_none())?;
        source.corner_texcoords(self).filter(|values| values.len() == 2 * self.faces.corners().len())
    }

    /// The kept document, if it is of that type.
    pub(crate) fn source<T: SourceDocument>(&self) -> Option<&T> {
        let document: &dyn Any = self.original.as_deref()?;
        document.downcast_ref()
    }

    /// Keeps the document that the shape was read from.
    pub(crate) fn set_source(&mut self, document: impl SourceDocument) {
        self.original = Some(Arc::new(document));
    }
}
