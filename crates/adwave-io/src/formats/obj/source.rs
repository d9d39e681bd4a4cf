//! The text of an OBJ, kept to be written again.

use std::sync::Arc;

use adwave::Progress;

use super::read::read_obj;
use super::{normals, subset, turn, write};
use crate::model::context::WriteContext;
use crate::model::source_document::{DocumentNormals, SourceDocument, Update};
use crate::model::subset::Subset;
use crate::model::text_rows::TextRows;
use crate::{ReadLimits, ShapeFile, WriteError};

/// The text, with the row of each vertex.
#[derive(Debug)]
pub(crate) struct ObjSource(pub(crate) TextRows);

impl SourceDocument for ObjSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        write::update_obj(&self.0, shape, context)
    }

    /// An OBJ made of the lines of this one.
    fn subset_shape(&self, shape: &ShapeFile, part: &Subset<'_>) -> Option<ShapeFile> {
        if shape.moved || !shape.edited.is_empty() {
            return None;
        }
        let text = subset::text(&self.0.bytes, &self.0.rows, shape.faces.corners().len(), part);
        read_obj(text, &ReadLimits::default(), Progress::none()).ok().map(ShapeFile::with_original_fields)
    }

    fn with_turned_faces(&self, is_turned: &[bool]) -> Option<Arc<dyn SourceDocument>> {
        let bytes = turn::turned_text(&self.0.bytes, is_turned)?;
        Some(Arc::new(Self(TextRows { bytes, rows: self.0.rows.clone(), ..self.0 })))
    }

    fn corner_normals(&self, shape: &ShapeFile) -> Option<DocumentNormals> {
        normals::corner_normals(&self.0.bytes, shape)
    }

    /// Libraries of materials.
    fn references(&self) -> Vec<String> {
        let statements = self.0.bytes.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
        let names = statements.filter_map(|line| line.strip_prefix(b"mtllib")).map(<[u8]>::trim_ascii);
        let mut names: Vec<String> = names
            .filter(|name| !name.is_empty())
            .map(|name| String::from_utf8_lossy(name).into_owned())
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    fn corner_labels(&self, shape: &ShapeFile) -> Option<Vec<u32>> {
        subset::labels(&self.0.bytes, shape.faces.corners().len())
    }

    fn corner_texcoords(&self, shape: &ShapeFile) -> Option<Vec<f64>> {
        subset::corner_texcoords(&self.0.bytes, shape.faces.corners().len())
    }
}
