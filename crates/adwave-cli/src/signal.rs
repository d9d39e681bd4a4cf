//! From the --field argument to a signal.

use crate::error::CliError;
use crate::global::Global;
use crate::output::note;
use crate::shape_input::Input;
use adwave::mask::missing;
use adwave::{ClassifiedError, Decomposer, ErrorKind};
use adwave_io::ShapeFile;
pub(crate) use adwave_io::{
    COORDS, NamedSignal as Signal, SignalValues as Values, default_signal, file_normals, named_axis as axis,
    with_axis, written_signal as written,
};
use adwave_io::{SignalSource, named_signal};
use std::path::Path;

/// The signal of that name.
pub(crate) fn load(
    global: &Global<'_>,
    input: &Input,
    name: &str,
    texture: Option<&Path>,
) -> Result<Signal, CliError> {
    global.inputs.add_signal(name, texture);
    let source = SignalSource { file: &input.file, shape: &input.shape, name: &input.name };
    // A file that is not there is a wrong name: for the user to mend, as for the shape's own file.
    named_signal(source, name, texture).map_err(|e| match e.kind() {
        ErrorKind::Cancelled => CliError::Cancelled,
        _ => CliError::input(e),
    })
}

/// The same with the vertices masked where the signal is NaN.
pub(crate) fn mask(
    decomposer: Decomposer,
    signal: &Signal,
    name: &str,
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    let Some(flags) = missing(&signal.values, signal.n_channels) else { return Ok(decomposer) };
    let masked = decomposer.masked(&flags).map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    let n_missing = flags.iter().filter(|&&f| f).count();
    note(global, &format!("{name} is NaN at {n_missing} of {} vertices, which are masked", flags.len()));
    Ok(masked)
}

/// The names of the file's fields.
pub(crate) fn field_names(file: &ShapeFile) -> Vec<String> {
    file.field_names().into_iter().map(str::to_owned).collect()
}
