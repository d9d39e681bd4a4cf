//! From the name of a signal to its values.

use super::shape::Input;
use crate::error::CliError;
use crate::global::Global;
use adwave::{ClassifiedError, ErrorKind};
pub(crate) use adwave_io::{COORDS, NamedSignal as Signal, SignalValues, default_signal, file_normals};
use adwave_io::{ShapeFile, SignalSource, named_signal};
use std::path::Path;

/// The signal of that name.
pub(crate) fn load_signal(
    global: &Global<'_>,
    input: &Input,
    name: &str,
    texture: Option<&Path>,
) -> Result<Signal, CliError> {
    global.inputs.add_signal(name, texture);
    let source = SignalSource { file: &input.file, shape: &input.shape, name: &input.name };
    // A file that is missing is a wrong name, which the user can mend, as for the file of the shape.
    named_signal(source, name, texture).map_err(|e| match e.kind() {
        ErrorKind::Cancelled => CliError::Cancelled,
        _ => CliError::input(e),
    })
}

/// The names of the file's fields.
pub(crate) fn field_names(file: &ShapeFile) -> Vec<String> {
    file.field_names().into_iter().map(str::to_owned).collect()
}
