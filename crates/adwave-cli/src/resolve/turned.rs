//! Parts of a mesh whose faces are turned over.

use super::shape::Input;
use crate::error::CliError;
use crate::output::count;
use adwave::shape::SurfaceParts;
use serde_json::json;
use std::fmt::Write;

/// Parts that were turned over.
pub(crate) struct TurnedParts {
    n_parts: usize,
    n_faces: usize,
}

/// Turns over the faces of the parts with these first vertices, in the file of `input`.
pub(crate) fn turn_parts(
    input: &mut Input,
    parts: &SurfaceParts,
    first_vertices: &[u32],
) -> Result<TurnedParts, CliError> {
    let is_turned = parts
        .faces_of(first_vertices, input.file.faces())
        .map_err(|e| CliError::Input(format!("{}: {e}", input.name)))?;
    input.file.turn_faces(&is_turned)?;
    let n_faces = is_turned.iter().filter(|is_turned| **is_turned).count();
    Ok(TurnedParts { n_parts: first_vertices.len(), n_faces })
}

impl TurnedParts {
    pub(crate) fn describe(&self, text: &mut String) {
        let (faces, parts) = (count(self.n_faces, "face", "faces"), count(self.n_parts, "part", "parts"));
        let _ = writeln!(text, "{faces} of {parts} turned over");
    }

    pub(crate) fn add_to(&self, report: &mut serde_json::Value) {
        report["turned"] = json!({"parts": self.n_parts, "faces": self.n_faces});
    }
}
