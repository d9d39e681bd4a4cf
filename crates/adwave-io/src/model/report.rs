//! Report of the content that a written file does not have.

use crate::ShapeFile;

/// Content that is missing in a written file because the format cannot store it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteReport {
    /// Descriptions of the content that the format cannot store and the file does not have, such as ``vertex field
    /// `gaze` ``; empty if everything was written.
    pub not_written: Vec<String>,
    /// Remarks on the written file, one line each, such as a conversion between units of length.
    pub notes: Vec<String>,
}

impl WriteReport {
    pub(crate) fn report_dropped(&mut self, what: impl Into<String>) {
        let what = what.into();
        if !self.not_written.contains(&what) {
            self.not_written.push(what);
        }
    }

    pub(crate) fn add_note(&mut self, text: impl Into<String>) {
        let text = text.into();
        if !self.notes.contains(&text) {
            self.notes.push(text);
        }
    }

    /// Reports all vertex fields except `held`.
    pub(crate) fn report_vertex_fields(&mut self, shape: &ShapeFile, held: &[&str]) {
        for field in shape.vertex_fields.iter().filter(|f| !held.contains(&f.name.as_str())) {
            let kind = if shape.grid.is_some() { "field" } else { "vertex field" };
            self.report_dropped(format!("{kind} `{}`", field.name));
        }
    }

    /// Reports all face fields except `held`.
    pub(crate) fn report_face_fields(&mut self, shape: &ShapeFile, held: &[&str]) {
        for field in shape.face_fields.iter().filter(|f| !held.contains(&f.name.as_str())) {
            self.report_dropped(format!("face field `{}`", field.name));
        }
    }
}
