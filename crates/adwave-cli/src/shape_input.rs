//! From the SHAPE argument to a shape.

use crate::args::{Kind, ShapeArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::note;
use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::{Shape, triangulate, vertex_normals};
use adwave::{ClassifiedError, ErrorKind};
use adwave_io::{CloudPart, ReadError, ShapeFile, ShapeKind, read_bytes, read_cloud_part_with};
use std::io::Read;
use std::path::Path;

/// What was read, as its file has it and as the mathematics has it.
pub(crate) struct Input {
    /// The file's content, to write it back.
    pub(crate) file: ShapeFile,
    /// The shape.
    pub(crate) shape: Shape,
    /// What to call it in reports.
    pub(crate) name: String,
}

/// What says where a shape comes from.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    /// A file, `-`, or `sample:NAME`.
    pub(crate) shape: &'a str,
    pub(crate) kind: Option<Kind>,
    pub(crate) vertices: Option<usize>,
    pub(crate) noise: Option<f64>,
    pub(crate) seed: u64,
    /// Which part of a cloud.
    pub(crate) part: CloudPart,
}

impl<'a> Source<'a> {
    /// A shape as it is.
    pub(crate) fn new(shape: &'a str) -> Self {
        Self { shape, kind: None, vertices: None, noise: None, seed: 1, part: CloudPart::default() }
    }
}

/// Reads or makes the shape that the arguments ask for.
pub(crate) fn load(args: &ShapeArgs, global: &Global<'_>) -> Result<Input, CliError> {
    let ShapeArgs { shape, part, kind, vertices, noise, seed, .. } = args;
    let part = part.part();
    let source = Source { shape, kind: *kind, vertices: *vertices, noise: *noise, seed: *seed, part };
    load_source(&source, global)
}

/// Reads or makes a shape.
pub(crate) fn load_source(source: &Source<'_>, global: &Global<'_>) -> Result<Input, CliError> {
    let name = source.shape.to_owned();
    if !source.part.is_whole() && (name == "-" || name.starts_with("sample:")) {
        return Err(CliError::Input(format!(
            "--box and --resolution are for files (LAS, LAZ, COPC, EPT); '{name}' is none"
        )));
    }
    let file = if let Some(sample) = source.shape.strip_prefix("sample:") {
        global.inputs.add_unhashed(source.shape);
        make_sample(sample, source.vertices, source.noise, source.seed)?
    } else {
        for (flag, given) in [("--vertices", source.vertices.is_some()), ("--noise", source.noise.is_some())]
        {
            if given {
                return Err(CliError::Input(format!("{flag} is for samples; '{name}' is a file")));
            }
        }
        read(source.shape, &source.part, global)?
    };
    let kind = match source.kind {
        None => file.kind(),
        Some(Kind::Mesh) => ShapeKind::Mesh,
        Some(Kind::Cloud) => ShapeKind::Cloud,
        Some(Kind::Graph) => ShapeKind::Graph,
    };
    let shape = file.to_shape_as(kind).map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    Ok(Input { file, shape, name })
}

/// Makes a built-in shape.
pub(crate) fn make_sample(
    name: &str,
    n_vertices: Option<usize>,
    noise: Option<f64>,
    seed: u64,
) -> Result<ShapeFile, CliError> {
    let mut sample = Sample::from_name(name, n_vertices).map_err(CliError::input)?;
    if let Some(sigma) = noise {
        sample.add_noise(NoiseSigma::MeanEdge(sigma), seed).map_err(CliError::input)?;
    }
    Ok(ShapeFile::from_mesh(sample.points, sample.faces))
}

fn read(source: &str, part: &CloudPart, global: &Global<'_>) -> Result<ShapeFile, CliError> {
    let limits = &global.limits;
    let read = if source == "-" {
        let mut bytes = Vec::new();
        std::io::stdin()
            .lock()
            .take(limits.max_bytes.saturating_add(1))
            .read_to_end(&mut bytes)
            .map_err(|e| CliError::Environment(format!("cannot read the standard input: {e}")))?;
        global.inputs.add_bytes(source, &bytes);
        read_bytes(bytes, None, limits)
    } else {
        if part.is_whole() {
            global.inputs.add_file(Path::new(source));
        } else {
            // A hash would be of all that is not read.
            global.inputs.add_unhashed(source);
        }
        read_cloud_part_with(Path::new(source), part, limits, global.progress())
    };
    read.map_err(|error| {
        if error.kind() == ErrorKind::Cancelled {
            return CliError::Cancelled;
        }
        let mut text = error.to_string();
        if matches!(cause(&error), ReadError::Limit { what: "bytes", .. }) {
            text = text.replace("raise the limit", "raise the limit (--max-input 8G)");
        }
        CliError::Input(if text.contains(source) { text } else { format!("{source}: {text}") })
    })
}

/// What is wrong with a file, without its name.
fn cause(error: &ReadError) -> &ReadError {
    if let ReadError::InFile { source, .. } = error { cause(source) } else { error }
}

/// Computes the file's normals of a mesh anew where that is asked for, or says that they are the old ones.
pub(crate) fn refresh_normals(update: bool, global: &Global<'_>, input: &mut Input) -> Result<(), CliError> {
    let (Some(field), Shape::Mesh(mesh)) = (input.file.field("normal"), &input.shape) else { return Ok(()) };
    if update {
        let triangles = triangulate(input.file.points(), mesh.faces());
        let normals = vertex_normals(input.file.points(), &triangles);
        let field = field.with_values_rounded(normals.as_flattened());
        input.file.add_vertex_field(field)?;
    } else {
        note(global, "the normals are those of the input; --update-normals computes them anew");
    }
    Ok(())
}
