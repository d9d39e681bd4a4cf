//! What a written file is without.

use crate::ShapeFile;

/// What is not in the written file because the format cannot hold it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteReport {
    /// What the shape has and the format cannot hold, so that the file is without it: one phrase each, such as
    /// ``vertex field `gaze` ``; empty where all was written.
    pub not_written: Vec<String>,
}

impl WriteReport {
    pub(crate) fn leave_out(&mut self, what: impl Into<String>) {
        let what = what.into();
        if !self.not_written.contains(&what) {
            self.not_written.push(what);
        }
    }

    /// Names all vertex fields but those that are held.
    pub(crate) fn leave_vertex_fields(&mut self, shape: &ShapeFile, held: &[&str]) {
        for field in shape.vertex_fields.iter().filter(|f| !held.contains(&f.name.as_str())) {
            self.leave_out(format!("vertex field `{}`", field.name));
        }
    }

    /// Names all face fields but those that are held.
    pub(crate) fn leave_face_fields(&mut self, shape: &ShapeFile, held: &[&str]) {
        for field in shape.face_fields.iter().filter(|f| !held.contains(&f.name.as_str())) {
            self.leave_out(format!("face field `{}`", field.name));
        }
    }
}
