//! From the --field argument to a signal.

use crate::error::CliError;
use crate::shape_input::Input;
use adwave_io::{ReadLimits, ShapeFile};
use std::path::Path;

/// The name of the coordinates as a signal.
pub(crate) const COORDS: &str = "coords";

/// A signal on the vertices: n_vertices × n_channels, row-major.
pub(crate) struct Signal {
    pub(crate) n_channels: usize,
    pub(crate) values: Vec<f64>,
}

/// The coordinates, a field of the file by its name, or the content of an .npy file.
pub(crate) fn load(input: &Input, name: &str) -> Result<Signal, CliError> {
    let n_vertices = input.shape.n_vertices();
    if name == COORDS {
        return match input.file.points() {
            points if !points.is_empty() => {
                Ok(Signal { n_channels: 3, values: points.as_flattened().to_vec() })
            }
            _ => Err(CliError::Input(format!(
                "{}: a graph has no coordinates; name a signal with --field FILE.npy",
                input.name
            ))),
        };
    }
    if let Some((n_channels, values)) = field(&input.file, name) {
        return Ok(Signal { n_channels, values });
    }
    if Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
        let array = adwave_io::read_npy(Path::new(name), &ReadLimits::default()).map_err(CliError::input)?;
        let n_rows = array.shape.first().copied().unwrap_or(1);
        if n_rows != n_vertices {
            return Err(CliError::Input(format!(
                "{name} has {n_rows} rows, but {} has {n_vertices} vertices",
                input.name
            )));
        }
        let field = array.into_field(name);
        return Ok(Signal { n_channels: field.n_channels, values: field.to_f64() });
    }
    let fields = field_names(&input.file);
    let known = if fields.is_empty() { String::new() } else { format!(", {}", fields.join(", ")) };
    Err(CliError::Input(format!("{} has no field '{name}'; there is coords{known}", input.name)))
}

/// A field of the file as numbers.
pub(crate) fn field(file: &ShapeFile, name: &str) -> Option<(usize, Vec<f64>)> {
    file.field(name).map(|field| (field.n_channels, field.to_f64()))
}

/// The names of the file's fields.
pub(crate) fn field_names(file: &ShapeFile) -> Vec<String> {
    file.field_names().into_iter().map(str::to_owned).collect()
}
