//! From the name of a signal to its values.

use super::shape::Input;
use crate::args::LabelArgs;
use crate::error::CliError;
use crate::global::Global;
use adwave::{ClassifiedError, ErrorKind};
pub(crate) use adwave_io::{COORDS, NamedSignal as Signal, SignalValues, default_signal, file_normals};
use adwave_io::{
    ShapeFile, SignalSource, UnknownValue, describe_unknown, distinct_labels, labels_of_field, named_signal,
};
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
    let mut signal = named_signal(source, name, texture).map_err(|e| match e.kind() {
        ErrorKind::Cancelled => CliError::Cancelled,
        _ if name == "saliency" => {
            CliError::Input(format!("{e}; 'adwave saliency SHAPE -o map.ply' writes the shape with it"))
        }
        _ => CliError::input(e),
    })?;
    if signal.unknown.is_empty() {
        global
            .given
            .refuse(&[KEEP_SENTINELS], &format!("applies to a signal with sentinels, and {name} has none"))?;
    } else if global.given.has(KEEP_SENTINELS) {
        signal.take_unknown_as_numbers();
    }
    note_unknown(name, &signal.unknown, global);
    Ok(signal)
}

/// Option that takes sentinels as numbers.
pub(crate) const KEEP_SENTINELS: &str = "--keep-sentinels";

/// Prints a note on the numbers of a signal that were taken for unknown values.
pub(crate) fn note_unknown(name: &str, unknown: &[UnknownValue], global: &Global<'_>) {
    if let Some(text) = describe_unknown(name, unknown) {
        let has_option = !["render", "resample", "simplify"].contains(&global.given.command());
        let change = if has_option { "; --keep-sentinels takes them as numbers" } else { "" };
        global.inputs.add_remark(format!("{text}{change}"));
    }
}

/// Refuses a signal that has labels; `hint` says how to smooth it anyway.
pub(crate) fn refuse_labels(
    name: &str,
    signal: &Signal,
    args: LabelArgs,
    hint: &str,
) -> Result<(), CliError> {
    let Some(labels) = labels_of_field(name, signal.n_channels, &signal.values) else {
        if args.as_numbers {
            return Err(CliError::Input(format!(
                "--as-numbers applies to fields of labels, and {name} is none; leave it out"
            )));
        }
        return Ok(());
    };
    if args.as_numbers {
        return Ok(());
    }
    let first: Vec<String> = labels.iter().take(3).map(f64::to_string).collect();
    let dots = if labels.len() > first.len() { ", …" } else { "" };
    Err(CliError::Input(format!(
        "{name} has labels ({}{dots}; {} of them), and a mean of labels is none; {hint}; --as-numbers takes them for numbers",
        first.join(", "),
        labels.len()
    )))
}

/// A hint that names the command that smooths labels.
pub(crate) fn smooth_labels_hint(name: &str) -> String {
    format!("'adwave filter SHAPE -o OUT --signal {name} --as-labels --preset smooth' smooths them")
}

/// All labels of a signal, in ascending order.
pub(crate) fn load_labels(name: &str, signal: &Signal) -> Result<Vec<f64>, CliError> {
    let labels = if signal.n_channels == 1 { distinct_labels(&signal.values) } else { None };
    labels.filter(|labels| !labels.is_empty()).ok_or_else(|| {
        CliError::Input(format!(
            "--as-labels needs one label per vertex, at most 65536 different ones; {name} has {} numbers per vertex",
            signal.n_channels
        ))
    })
}

/// The names of the file's fields.
pub(crate) fn field_names(file: &ShapeFile) -> Vec<String> {
    file.field_names().into_iter().map(str::to_owned).collect()
}
