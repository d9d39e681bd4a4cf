//! From the --field argument to a signal.

use crate::error::CliError;
use crate::global::Global;
use crate::output::note;
use crate::shape_input::Input;
use adwave::mask::missing;
use adwave::shape::{PreparedGeometry, Shape, WeldMode};
use adwave::signal::{SurfaceSignal, degree, lightness, luminance, surface_signal};
use adwave::{Decomposer, Progress};
use adwave_io::{Field, FieldValues, ReadLimits, ShapeFile};
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

/// The name of the coordinates as a signal.
pub(crate) const COORDS: &str = "coords";
/// The name of the sum of the weights at each node of a graph.
pub(crate) const DEGREE: &str = "degree";

/// What a shape is split by where nothing is said: its coordinates, or the degree of a graph's nodes.
pub(crate) fn default_name(input: &Input) -> &'static str {
    if input.file.points().is_empty() { DEGREE } else { COORDS }
}

/// A signal on the vertices: n_vertices × n_channels, row-major.
pub(crate) struct Signal {
    pub(crate) n_channels: usize,
    pub(crate) values: Values,
}

/// The values of a signal. The coordinates are the shape's own and not copied.
pub(crate) enum Values {
    Coordinates(Arc<Vec<[f64; 3]>>),
    Other(Vec<f64>),
}

impl Deref for Values {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Self::Coordinates(points) => points.as_flattened(),
            Self::Other(values) => values,
        }
    }
}

impl From<Field> for Signal {
    fn from(field: Field) -> Self {
        Self { n_channels: field.n_channels, values: Values::Other(field.to_f64()) }
    }
}

/// The coordinates, a field of the file by its name, a signal that the shape gives by itself, the texture's colours, or the
/// content of another file.
///
/// `texture` is the picture of the texture, in the place of the one that the shape's materials name.
pub(crate) fn load(input: &Input, name: &str, texture: Option<&Path>) -> Result<Signal, CliError> {
    if texture.is_some() && !name.starts_with("texture") {
        return Err(CliError::Input(format!(
            "--texture goes with --field texture, texture-luminance or texture-lightness, not with {name}"
        )));
    }
    if name == COORDS {
        let points = input.file.shared_points();
        if points.is_empty() {
            return Err(CliError::Input(format!(
                "{}: a graph has no coordinates; name a signal with --field degree or --field FILE.npy",
                input.name
            )));
        }
        return Ok(Signal { n_channels: 3, values: Values::Coordinates(points) });
    }
    if let Some((n_channels, values)) = field(&input.file, name) {
        return Ok(Signal { n_channels, values: Values::Other(values) });
    }
    if let Some(axis) = axis(input, name) {
        let values = input.file.points().iter().map(|p| p[axis]).collect();
        return Ok(Signal { n_channels: 1, values: Values::Other(values) });
    }
    if name == DEGREE
        && let Shape::Graph(graph) = &input.shape
    {
        return Ok(Signal { n_channels: 1, values: Values::Other(degree(graph)) });
    }
    if let Some(kind) = SurfaceSignal::from_name(name) {
        let geometry = PreparedGeometry::new(&input.shape, WeldMode::EqualPositions, Progress::none())
            .map_err(CliError::input)?;
        let values = surface_signal(&geometry, kind, Progress::none()).map_err(CliError::input)?;
        return Ok(Signal { n_channels: kind.n_channels(), values: Values::Other(values) });
    }
    match name {
        "luminance" | "lightness" => {
            let colors = input
                .file
                .field("color")
                .ok_or_else(|| CliError::Input(format!("{} has no colours, so no {name}", input.name)))?;
            return brightness(colors, name);
        }
        "texture" => return Ok(texture_field(input, texture)?.into()),
        "texture-luminance" | "texture-lightness" => {
            return brightness(&texture_field(input, texture)?, name.trim_start_matches("texture-"));
        }
        _ => {}
    }
    if let Some(field) = from_file(name)? {
        let n_vertices = input.shape.n_vertices();
        if field.len() != n_vertices {
            return Err(CliError::Input(format!(
                "{name} has {} rows, but {} has {n_vertices} vertices",
                field.len(),
                input.name
            )));
        }
        return Ok(field.into());
    }
    let is_mesh = !input.file.faces().is_empty();
    let own = SurfaceSignal::ALL.iter().filter(|&&kind| !(is_mesh && kind == SurfaceSignal::Density));
    let own = own.map(|kind| kind.name().to_owned());
    let axes = ["x", "y", "z"].into_iter().filter(|name| axis(input, name).is_some()).map(str::to_owned);
    let known: Vec<String> = std::iter::once(default_name(input).to_owned())
        .chain(field_names(&input.file))
        .chain(axes)
        .chain(own)
        .collect();
    Err(CliError::Input(format!(
        "{} has no field '{name}'; there is {}, or a file .npy, .csv or .gii",
        input.name,
        known.join(", ")
    )))
}

/// The coordinate that is named, where no field of the file has that name: `z` is the heights of a terrain.
pub(crate) fn axis(input: &Input, name: &str) -> Option<usize> {
    let axis = ["x", "y", "z"].iter().position(|axis| *axis == name)?;
    (input.file.field(name).is_none() && !input.file.points().is_empty()).then_some(axis)
}

/// The points with one coordinate replaced.
pub(crate) fn with_axis(points: &[[f64; 3]], axis: usize, values: &[f64]) -> Vec<[f64; 3]> {
    let replaced = |(p, v): (&[f64; 3], &f64)| std::array::from_fn(|c| if c == axis { *v } else { p[c] });
    points.iter().zip(values).map(replaced).collect()
}

/// New values of the signal of that name as a field to write: that of the file in its own type of numbers, else one by the name
/// of the column, or of the file without its extensions.
pub(crate) fn written(file: &ShapeFile, name: &str, n_channels: usize, values: Vec<f64>) -> Field {
    if let Some(old) = file.field(name) {
        return old.with_values_rounded(&values);
    }
    let last = name.rsplit([':', '/', '\\']).next().unwrap_or(name);
    let stem = last.split('.').next().filter(|stem| !stem.is_empty()).unwrap_or(last);
    Field::new(stem, n_channels, FieldValues::F64(values))
}

/// The same with the vertices masked where the signal is NaN.
pub(crate) fn mask(
    walk: Decomposer,
    signal: &Signal,
    name: &str,
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    let Some(flags) = missing(&signal.values, signal.n_channels) else { return Ok(walk) };
    let masked = walk.masked(&flags).map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    let n_missing = flags.iter().filter(|&&f| f).count();
    note(global, &format!("{name} is NaN at {n_missing} of {} vertices, which are masked", flags.len()));
    Ok(masked)
}

/// A field of another file: `FILE.npy`, `FILE.csv`, `FILE.gii`, the last two with `:NAME` for one of several.
fn from_file(name: &str) -> Result<Option<Field>, CliError> {
    let limits = ReadLimits::default();
    let kind = |path: &str| {
        let path = path.to_ascii_lowercase();
        let plain = path.strip_suffix(".gz").unwrap_or(&path).to_owned();
        [".npy", ".csv", ".tsv", ".gii"].into_iter().find(|ending| plain.ends_with(ending))
    };
    let (path, column) = match name.rsplit_once(':') {
        Some((path, column)) if kind(path).is_some() && kind(name).is_none() => (path, Some(column)),
        _ => (name, None),
    };
    let fields = match kind(path) {
        Some(".npy") => {
            vec![adwave_io::read_npy(Path::new(path), &limits).map_err(CliError::input)?.into_field(name)]
        }
        Some(".csv" | ".tsv") => {
            adwave_io::read_csv_fields(Path::new(path), &limits).map_err(CliError::input)?
        }
        Some(_) => adwave_io::read_gifti_fields(Path::new(path), &limits).map_err(CliError::input)?,
        None => return Ok(None),
    };
    let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
    match column {
        Some(column) => match names.iter().position(|n| *n == column) {
            Some(at) => Ok(fields.into_iter().nth(at)),
            None => Err(CliError::Input(format!("{path} has no '{column}'; there is {}", names.join(", ")))),
        },
        None => Ok(Some(joined(path, &fields)?)),
    }
}

/// All fields of a file as the channels of one.
fn joined(path: &str, fields: &[Field]) -> Result<Field, CliError> {
    if let Some(other) = fields.iter().find(|f| f.len() != fields[0].len()) {
        return Err(CliError::Input(format!(
            "{path} holds {} with {} rows and {} with {}; name one of them: {path}:{}",
            fields[0].name,
            fields[0].len(),
            other.name,
            other.len(),
            fields[0].name
        )));
    }
    let (n, n_channels) = (fields[0].len(), fields.iter().map(|f| f.n_channels).sum());
    let row = |i: usize| fields.iter().flat_map(move |f| (0..f.n_channels).map(move |c| f.get(i, c)));
    Ok(Field::new(path, n_channels, FieldValues::F64((0..n).flat_map(row).collect())))
}

fn texture_field(input: &Input, texture: Option<&Path>) -> Result<Field, CliError> {
    let path = Path::new(&input.name);
    if input.name == "-" || input.file.format().is_none() {
        return Err(CliError::Input(format!("{}: a texture needs a shape from a file", input.name)));
    }
    adwave_io::texture_colors(&input.file, path, texture, &ReadLimits::default()).map_err(CliError::input)
}

/// Luminance or lightness of colours: bytes, or numbers in [0, 1].
fn brightness(colors: &Field, name: &str) -> Result<Signal, CliError> {
    let n_channels = colors.n_channels;
    if n_channels < 3 {
        return Err(CliError::Input(format!(
            "the colours have {n_channels} channels, not red, green and blue"
        )));
    }
    let scale = match colors.values {
        FieldValues::U8(_) => 255.0,
        FieldValues::U16(_) => 65535.0,
        _ => 1.0,
    };
    let bright = if name == "luminance" { luminance } else { lightness };
    let values = (0..colors.len()).map(|i| bright([0, 1, 2].map(|c| colors.get(i, c) / scale))).collect();
    Ok(Signal { n_channels: 1, values: Values::Other(values) })
}

/// A field of the file as numbers.
pub(crate) fn field(file: &ShapeFile, name: &str) -> Option<(usize, Vec<f64>)> {
    file.field(name).map(|field| (field.n_channels, field.to_f64()))
}

/// The normals of the file, three numbers for each vertex.
pub(crate) fn file_normals(input: &Input) -> Option<Vec<f64>> {
    let normals = field(&input.file, "normal").filter(|(n_channels, _)| *n_channels == 3)?.1;
    (normals.len() == 3 * input.shape.n_vertices()).then_some(normals)
}

/// The names of the file's fields.
pub(crate) fn field_names(file: &ShapeFile) -> Vec<String> {
    file.field_names().into_iter().map(str::to_owned).collect()
}
