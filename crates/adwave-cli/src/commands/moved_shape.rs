//! Common end of the commands that move all vertices of a shape.

use super::result_file::{EditedSignal, ResultFile};
use crate::error::CliError;
use crate::global::Global;
use crate::output::movement::Movement;
use crate::output::{count, print};
use crate::resolve::shape::Input;
use crate::resolve::signal::COORDS;
use adwave::Decomposer;
use adwave_deform::DeformError;
use adwave_io::MovedNormals;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// A shape with new positions, and the report on it.
pub(crate) struct MovedShape<'a> {
    pub(crate) input: Input,
    pub(crate) decomposer: &'a Decomposer,
    pub(crate) points: Vec<[f64; 3]>,
    /// Lines for people before those about the movement.
    pub(crate) text: String,
    pub(crate) report: Value,
}

impl MovedShape<'_> {
    /// Writes the shape to `path` and reports how far its vertices moved.
    pub(crate) fn write(mut self, path: &Path, global: &Global<'_>) -> Result<(), CliError> {
        let geometry = self.decomposer.geometry_for("a report of the movement")?;
        let movement = Movement::measure(geometry, &self.points)?.in_file_rows(&self.input.file);
        let (mut text, mut report) = (self.text, self.report);
        let _ = writeln!(text, "{}", count(self.input.shape.n_vertices(), "vertex", "vertices"));
        movement.describe(&mut text);
        movement.add_to(&mut report);
        report["shape"] = json!(self.input.name);
        report["output"] = json!(path.display().to_string());
        report["vertices"] = json!(self.input.shape.n_vertices());
        let edited = EditedSignal::Points(self.points);
        ResultFile::new(path)?.write(&mut self.input, COORDS, edited, MovedNormals::Follow, global)?;
        let _ = writeln!(text, "{}", path.display());
        print(global, &text, &report)
    }
}

/// An error with the name of the file that it is about.
pub(crate) fn name_error(name: &str, error: DeformError) -> CliError {
    match CliError::from(error) {
        CliError::Input(text) => CliError::Input(format!("{name}: {text}")),
        other => other,
    }
}
