//! Signals by name: coordinates, fields of the file, quantities computed from the shape, colors of a texture, other
//! files.

use crate::model::brain_layout::BRAIN_VALUES;
use crate::model::field::COORDS;
use crate::model::format_descriptor::SurfaceSize;
use crate::model::grid_layout::GRID_VALUES;
use crate::model::label_table::LabelTable;
use crate::registry::values::read_value_file;
use crate::unknown::{UnknownValue, mark_unknown};
use crate::{Field, FieldValues, ReadError, ReadLimits, ShapeFile, TextureError};
use adwave::shape::{PreparedGeometry, Shape, WeldMode};
use adwave::signal::{SignalError, SurfaceSignal, degree, lightness, luminance, surface_signal};
use adwave::{Cancelled, ClassifiedError, ErrorKind, Progress};
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;
use thiserror::Error;

/// Reasons for which a name does not select a signal.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum NamedSignalError {
    /// The signal does not exist, or does not fit the shape.
    #[error("{0}")]
    Unknown(String),
    /// The named file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The colors of the texture cannot be determined.
    #[error(transparent)]
    Texture(#[from] TextureError),
    /// The shape does not have this signal.
    #[error(transparent)]
    Shape(#[from] SignalError),
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for NamedSignalError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Unknown(_) => ErrorKind::Input,
            Self::Read(error) => error.kind(),
            Self::Texture(error) => error.kind(),
            Self::Shape(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
        }
    }
}

/// Name of the signal with the sum of the weights at each node of a graph.
pub const DEGREE: &str = "degree";

/// Default signal of a shape: its coordinates, the degree of a graph's nodes, the values of an image, a volume or a
/// brain, or the first field of a map.
pub fn default_signal(file: &ShapeFile) -> &str {
    let field = file.vertex_fields().first().or(file.face_fields().first());
    match file.grid() {
        Some(_) => GRID_VALUES,
        None if file.is_map() && field.is_some() => field.map_or(COORDS, |field| &field.name),
        None if file.brain().is_some() => BRAIN_VALUES,
        None if file.points().is_empty() => DEGREE,
        None => COORDS,
    }
}

/// Signal on the vertices: n_vertices × n_channels, row-major.
#[derive(Clone, Debug)]
pub struct NamedSignal {
    /// Number of values per vertex.
    pub n_channels: usize,
    /// All values.
    pub values: SignalValues,
    /// Names of the channels, if they are columns of another file; else empty.
    pub channel_names: Vec<String>,
    /// Seconds from one channel to the next, if the file says that the channels are frames.
    pub frame_step: Option<f64>,
    /// Names and colors of the labels in each channel, if a file has them; else empty.
    pub labels: Vec<Option<Arc<LabelTable>>>,
    /// Numbers of a field that stand for unknown values (see [`mark_unknown`]), in whose places `values` has NaN.
    pub unknown: Vec<UnknownValue>,
}

/// Values of a signal. Coordinates are shared with the shape instead of copied.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum SignalValues {
    /// Points of the shape.
    Coordinates(Arc<Vec<[f64; 3]>>),
    /// Any other values.
    Other(Vec<f64>),
}

impl Deref for SignalValues {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Self::Coordinates(points) => points.as_flattened(),
            Self::Other(values) => values,
        }
    }
}

impl NamedSignal {
    /// A signal of these values, all of them known.
    pub fn new(n_channels: usize, values: SignalValues) -> Self {
        let (channel_names, labels, unknown) = (Vec::new(), Vec::new(), Vec::new());
        Self { n_channels, values, channel_names, frame_step: None, labels, unknown }
    }

    /// Signal of a field, in which unknown values are NaN.
    fn from_field(field: &Field) -> Self {
        let mut values = field.to_f64();
        let unknown = mark_unknown(&mut values, field.n_channels);
        let frame_step = field.frame_step;
        let labels =
            if field.labels.is_some() { vec![field.labels.clone(); field.n_channels] } else { Vec::new() };
        Self { frame_step, labels, unknown, ..Self::new(field.n_channels, SignalValues::Other(values)) }
    }

    /// Names and colors of the labels that all channels share, if they do.
    pub fn shared_labels(&self) -> Option<Arc<LabelTable>> {
        let first = self.labels.first()?.clone()?;
        self.labels.iter().all(|labels| labels.as_ref() == Some(&first)).then_some(first)
    }

    /// Puts the numbers that stand for unknown values back among `values`, in places that are NaN.
    pub fn restore_unknown(&self, values: &mut [f64]) {
        for UnknownValue { index, value } in &self.unknown {
            if values[*index].is_nan() {
                values[*index] = *value;
            }
        }
    }

    /// Takes the numbers that stand for unknown values as numbers like all others.
    pub fn take_unknown_as_numbers(&mut self) {
        if let SignalValues::Other(values) = &mut self.values {
            self.unknown.iter().for_each(|u| values[u.index] = u.value);
        }
        self.unknown.clear();
    }
}

impl From<Field> for NamedSignal {
    fn from(field: Field) -> Self {
        Self::new(field.n_channels, SignalValues::Other(field.to_f64()))
    }
}

/// Shape whose signals are selected by name.
#[derive(Clone, Copy, Debug)]
pub struct SignalSource<'a> {
    /// Content of its file.
    pub file: &'a ShapeFile,
    /// Shape made from the file.
    pub shape: &'a Shape,
    /// Name in errors: its path, in whose folder textures are located.
    pub name: &'a str,
}

/// Finds a signal by its name: the coordinates (`coords`, or one of `x`, `y`, `z`), a field of the file, a quantity
/// computed from the shape ([`SurfaceSignal`], the `degree` of a graph), `luminance` or `lightness` of its colors,
/// the same of a texture after `texture-`, or the content of another file: `FILE.npy`, `FILE.dmat`, `FILE.csv`,
/// `FILE.gii`, or a file for [`read_surface_values`](crate::read_surface_values). All but the first two accept
/// `:NAME` for one of several columns.
///
/// `texture` is a picture that replaces the one named by the shape's materials.
///
/// # Errors
/// [`NamedSignalError`].
///
/// ```
/// use adwave_io::{ShapeFile, SignalSource, named_signal};
/// let file = ShapeFile::from_cloud(vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
/// let source = SignalSource { file: &file, shape: &file.to_shape()?, name: "two points" };
/// assert_eq!(*named_signal(source, "z", None)?.values, [2.0, 5.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn named_signal(
    source: SignalSource<'_>,
    name: &str,
    texture: Option<&Path>,
) -> Result<NamedSignal, NamedSignalError> {
    let SignalSource { file, shape, name: of } = source;
    if texture.is_some() && !name.starts_with("texture") {
        return Err(NamedSignalError::Unknown(format!(
            "a picture of a texture needs the signal texture, texture-luminance or texture-lightness, got {name}"
        )));
    }
    if name == COORDS {
        let points = file.shared_points();
        if points.is_empty() {
            return Err(NamedSignalError::Unknown(format!(
                "{of}: a graph has no coordinates; choose another signal, such as degree or FILE.npy"
            )));
        }
        return Ok(NamedSignal::new(3, SignalValues::Coordinates(points)));
    }
    if let Some(field) = file.field(name) {
        return Ok(NamedSignal::from_field(field));
    }
    if let Some(axis) = named_axis(file, name) {
        let values = file.points().iter().map(|p| p[axis]).collect();
        return Ok(NamedSignal::new(1, SignalValues::Other(values)));
    }
    if name == DEGREE
        && let Shape::Graph(graph) = shape
    {
        return Ok(NamedSignal::new(1, SignalValues::Other(degree(graph))));
    }
    if let Some(kind) = SurfaceSignal::from_name(name) {
        let geometry = PreparedGeometry::new(shape, WeldMode::default(), Progress::none())?;
        let values = surface_signal(&geometry, kind, Progress::none())?;
        return Ok(NamedSignal::new(kind.n_channels(), SignalValues::Other(values)));
    }
    match name {
        "luminance" | "lightness" => {
            let colors = file.field("color").ok_or_else(|| {
                NamedSignalError::Unknown(format!("{of} has no colors and therefore no {name}"))
            })?;
            return brightness(colors, name);
        }
        "texture" => return Ok(texture_field(file, of, texture)?.into()),
        "texture-luminance" | "texture-lightness" => {
            return brightness(&texture_field(file, of, texture)?, name.trim_start_matches("texture-"));
        }
        _ => {}
    }
    let n_vertices = shape.n_vertices();
    if let Some(FileField { field, channel_names, labels }) =
        values_of_file(name, file.structure(), file.n_file_rows())?
    {
        let signal = |field: Field| {
            let signal = NamedSignal { channel_names, ..NamedSignal::from_field(&field) };
            if labels.is_empty() { signal } else { NamedSignal { labels, ..signal } }
        };
        if let Some(rows) = file.file_rows().filter(|rows| rows.n_rows() == field.len()) {
            return Ok(signal(rows.select(&field)));
        }
        if field.len() != n_vertices {
            return Err(NamedSignalError::Unknown(format!(
                "{name} needs one row per vertex: it has {} rows, but {} has {n_vertices} vertices",
                field.len(),
                of
            )));
        }
        return Ok(signal(field));
    }
    if let Some(field) = file.face_fields().iter().find(|field| field.name == name) {
        return Err(NamedSignalError::Unknown(format!(
            "{name} is a field of faces ({} values for {} faces), and this analysis needs one row per \
             vertex; filter or denoise it, or convert it to a field of vertices first",
            field.len(),
            file.faces().len()
        )));
    }
    let is_mesh = !file.faces().is_empty();
    let own = SurfaceSignal::ALL.iter().filter(|&&kind| !(is_mesh && kind == SurfaceSignal::Density));
    let own = own.map(|kind| kind.name().to_owned());
    let axes = ["x", "y", "z"].into_iter().filter(|name| named_axis(file, name).is_some()).map(str::to_owned);
    let known: Vec<String> = std::iter::once(default_signal(file).to_owned())
        .chain(file.field_names().into_iter().map(str::to_owned))
        .chain(axes)
        .chain(own)
        .collect();
    Err(NamedSignalError::Unknown(format!(
        "{} has no field '{name}'; use {}, or a file .npy, .dmat, .csv, .gii, .nii, .mgh or with \
        FreeSurfer's values",
        of,
        known.join(", ")
    )))
}

/// Axis of that name, unless a field of the file has that name: `z` is the heights of a terrain.
pub fn named_axis(file: &ShapeFile, name: &str) -> Option<usize> {
    let axis = ["x", "y", "z"].iter().position(|axis| *axis == name)?;
    (file.field(name).is_none() && !file.points().is_empty()).then_some(axis)
}

/// Replaces one coordinate of the points.
pub fn with_axis(points: &[[f64; 3]], axis: usize, values: &[f64]) -> Vec<[f64; 3]> {
    let replaced = |(p, v): (&[f64; 3], &f64)| std::array::from_fn(|c| if c == axis { *v } else { p[c] });
    points.iter().zip(values).map(replaced).collect()
}

/// Converts new values of the named signal to a field for writing. A field of the file keeps its type of numbers, for an
/// image or a volume once it is written, and its integers stay as they are in places that are NaN now. Other signals are named after the column, or after the
/// file without its extensions.
pub fn written_signal(file: &ShapeFile, name: &str, n_channels: usize, mut values: Vec<f64>) -> Field {
    if let Some(old) = file.field(name) {
        if old.values.value_type().is_integer() {
            let missing = values.iter_mut().enumerate().filter(|(_, x)| x.is_nan());
            missing.for_each(|(k, x)| *x = old.values.get(k));
        }
        if file.grid().is_some() || file.brain().is_some() {
            // Its writer rounds to the type of the file, and refuses what that cannot hold.
            let frame_step = old.frame_step.filter(|_| old.n_channels == n_channels);
            return Field::new(name, n_channels, FieldValues::F64(values)).with_frame_step(frame_step);
        }
        return old.with_values_rounded(&values);
    }
    let last = name.rsplit([':', '/', '\\']).next().unwrap_or(name);
    let stem = last.split('.').next().filter(|stem| !stem.is_empty()).unwrap_or(last);
    Field::new(stem, n_channels, FieldValues::F64(values))
}

/// Lets the rows that are not part of the shape keep the values that a signal from another file has there, for writing
/// the field `written`. Without such rows, or for a signal of the shape itself, nothing changes.
///
/// # Errors
/// [`NamedSignalError`]: the file cannot be read again.
pub fn keep_left_out_values(
    file: &mut ShapeFile,
    name: &str,
    written: &Field,
) -> Result<(), NamedSignalError> {
    if file.file_rows().is_none() || file.field(name).is_some() || named_axis(file, name).is_some() {
        return Ok(());
    }
    if let Some(FileField { field: old, .. }) = values_of_file(name, file.structure(), file.n_file_rows())? {
        let values = FieldValues::F64(old.to_f64());
        file.set_left_out_values(&Field::new(written.name.clone(), old.n_channels, values));
    }
    Ok(())
}

/// Field of another file.
pub(crate) struct FileField {
    pub(crate) field: Field,
    /// Names of the channels, if they are columns of a table.
    channel_names: Vec<String>,
    /// Names and colors of the labels in each channel, if they differ between these.
    labels: Vec<Option<Arc<LabelTable>>>,
}

/// Reads a field of another file; `:NAME` selects one of several. Files of values without an extension of their own
/// are identified by their content.
pub(crate) fn values_of_file(
    name: &str,
    structure: Option<&str>,
    n_vertices: usize,
) -> Result<Option<FileField>, NamedSignalError> {
    let limits = ReadLimits::default();
    let kind = |path: &str| {
        let lower = path.to_ascii_lowercase();
        let plain = lower.strip_suffix(".gz").unwrap_or(&lower).to_owned();
        let known = [".npy", ".dmat", ".csv", ".tsv", ".gii", ".nii", ".mgh", ".mgz", ".annot"];
        let ending = known.into_iter().find(|ending| plain.ends_with(ending));
        ending.or_else(|| Path::new(path).is_file().then_some(""))
    };
    let (path, column) = match name.rsplit_once(':') {
        Some((path, column)) if kind(path).is_some() && kind(name).is_none() => (path, Some(column)),
        _ => (name, None),
    };
    let fields = match kind(path) {
        Some(".npy") => {
            vec![crate::read_npy(Path::new(path), &limits)?.into_field(name)]
        }
        Some(".csv" | ".tsv") => crate::read_csv_fields(Path::new(path), &limits)?,
        Some(_) => read_value_file(Path::new(path), &SurfaceSize { structure, n_vertices }, &limits)?,
        None => return Ok(None),
    };
    let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
    if let Some(column) = column {
        let Some(at) = names.iter().position(|n| *n == column) else {
            let known = names.join(", ");
            return Err(NamedSignalError::Unknown(format!("{path} has no '{column}'; use {known}")));
        };
        let alone = |field| FileField { field, channel_names: Vec::new(), labels: Vec::new() };
        return Ok(fields.into_iter().nth(at).map(alone));
    }
    // Columns without names are numbered.
    let has_names = names.iter().any(|name| name.parse::<usize>().is_err());
    let is_table = has_names && matches!(kind(path), Some(".csv" | ".tsv"));
    let labels: Vec<_> =
        fields.iter().flat_map(|field| std::iter::repeat_n(field.labels.clone(), field.n_channels)).collect();
    let has_labels = labels.iter().any(Option::is_some);
    let keeps_names = is_table || has_labels && labels.len() > 1;
    let channel_names = if keeps_names { names.into_iter().map(str::to_owned).collect() } else { Vec::new() };
    let labels = if has_labels { labels } else { Vec::new() };
    Ok(Some(FileField { field: join_channels(path, &fields)?, channel_names, labels }))
}

/// Joins all fields of a file as the channels of one field.
fn join_channels(path: &str, fields: &[Field]) -> Result<Field, NamedSignalError> {
    if let Some(other) = fields.iter().find(|f| f.len() != fields[0].len()) {
        return Err(NamedSignalError::Unknown(format!(
            "{path} has {} with {} rows and {} with {}; select one of them: {path}:{}",
            fields[0].name,
            fields[0].len(),
            other.name,
            other.len(),
            fields[0].name
        )));
    }
    if let [field] = fields {
        return Ok(Field { name: path.to_owned(), ..field.clone() });
    }
    let (n, n_channels) = (fields[0].len(), fields.iter().map(|f| f.n_channels).sum());
    let row = |i: usize| fields.iter().flat_map(move |f| (0..f.n_channels).map(move |c| f.get(i, c)));
    Ok(Field::new(path, n_channels, FieldValues::F64((0..n).flat_map(row).collect())))
}

fn texture_field(file: &ShapeFile, of: &str, texture: Option<&Path>) -> Result<Field, NamedSignalError> {
    if of == "-" || file.format().is_none() {
        return Err(NamedSignalError::Unknown(format!("{of}: a texture needs a shape from a file")));
    }
    #[cfg(feature = "texture")]
    return Ok(crate::texture_colors(file, Path::new(of), texture, &ReadLimits::default())?);
    #[cfg(not(feature = "texture"))]
    Err(NamedSignalError::Unknown(format!("{of}: textures {texture:?} need the feature `texture`")))
}

/// Luminance or lightness of colors.
fn brightness(colors: &Field, name: &str) -> Result<NamedSignal, NamedSignalError> {
    let n_channels = colors.n_channels;
    if n_channels < 3 {
        return Err(NamedSignalError::Unknown(format!(
            "colors must have 3 channels (red, green and blue), got {n_channels}"
        )));
    }
    let scale = colors.full_intensity();
    let bright = if name == "luminance" { luminance } else { lightness };
    let values = (0..colors.len()).map(|i| bright([0, 1, 2].map(|c| colors.get(i, c) / scale))).collect();
    Ok(NamedSignal::new(1, SignalValues::Other(values)))
}

/// Normals of the file, three numbers per vertex.
pub fn file_normals(file: &ShapeFile) -> Option<Vec<f64>> {
    let normals = file.field("normal").filter(|field| field.n_channels == 3)?.to_f64();
    (normals.len() == 3 * file.n_vertices()).then_some(normals)
}
