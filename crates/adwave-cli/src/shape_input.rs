//! From the SHAPE argument to a shape.

use crate::args::{Kind, ShapeArgs};
use crate::error::CliError;
use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::{Graph, Mesh, PointCloud, Shape};
use adwave_io::{Direction, ReadLimits, ShapeFile, read_bytes, read_path};
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
}

impl<'a> Source<'a> {
    /// A shape as it is.
    pub(crate) fn new(shape: &'a str) -> Self {
        Self { shape, kind: None, vertices: None, noise: None, seed: 1 }
    }
}

/// Reads or makes the shape that the arguments ask for.
pub(crate) fn load(args: &ShapeArgs) -> Result<Input, CliError> {
    let ShapeArgs { shape, kind, vertices, noise, seed, .. } = args;
    load_source(&Source { shape, kind: *kind, vertices: *vertices, noise: *noise, seed: *seed })
}

/// Reads or makes a shape.
pub(crate) fn load_source(source: &Source<'_>) -> Result<Input, CliError> {
    let name = source.shape.to_owned();
    let file = if let Some(sample) = source.shape.strip_prefix("sample:") {
        make_sample(sample, source.vertices, source.noise, source.seed)?
    } else {
        for (flag, given) in [("--vertices", source.vertices.is_some()), ("--noise", source.noise.is_some())]
        {
            if given {
                return Err(CliError::Input(format!("{flag} is for samples; '{name}' is a file")));
            }
        }
        read(source.shape)?
    };
    let shape = to_shape(&file, source.kind).map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    Ok(Input { file, shape, name })
}

/// Makes a built-in shape.
pub(crate) fn make_sample(
    name: &str,
    n_vertices: Option<usize>,
    noise: Option<f64>,
    seed: u64,
) -> Result<ShapeFile, CliError> {
    let mut sample = Sample::by_name(name, n_vertices).map_err(CliError::input)?;
    if let Some(sigma) = noise {
        sample.add_noise(NoiseSigma::MeanEdge(sigma), seed).map_err(CliError::input)?;
    }
    Ok(ShapeFile::from_mesh(sample.points, sample.faces))
}

fn read(source: &str) -> Result<ShapeFile, CliError> {
    let limits = ReadLimits::default();
    let read = if source == "-" {
        let mut bytes = Vec::new();
        std::io::stdin()
            .lock()
            .read_to_end(&mut bytes)
            .map_err(|e| CliError::Environment(format!("cannot read the standard input: {e}")))?;
        read_bytes(bytes, None, &limits)
    } else {
        read_path(Path::new(source), &limits)
    };
    read.map_err(|error| {
        let text = error.to_string();
        CliError::Input(if text.contains(source) { text } else { format!("{source}: {text}") })
    })
}

/// The shape that a file holds: a mesh where it has faces, a cloud where it has points, else a graph.
fn to_shape(file: &ShapeFile, kind: Option<Kind>) -> Result<Shape, Box<dyn std::error::Error>> {
    let kind = kind.unwrap_or(if !file.faces().is_empty() {
        Kind::Mesh
    } else if !file.points().is_empty() || file.edges().pairs.is_empty() {
        Kind::Cloud
    } else {
        Kind::Graph
    });
    Ok(match kind {
        Kind::Mesh if file.faces().is_empty() => return Err("there are no faces to take it as a mesh".into()),
        Kind::Mesh => Shape::Mesh(Mesh::new(file.points().to_vec(), file.faces().clone())?),
        Kind::Cloud => Shape::Cloud(PointCloud::new(file.points().to_vec())?),
        Kind::Graph if file.edges().pairs.is_empty() => {
            let edges: Vec<_> = edges_of_faces(file).into_iter().map(|[a, b]| (a, b, 1.0)).collect();
            if edges.is_empty() {
                return Err("there are no edges to take it as a graph".into());
            }
            Shape::Graph(Graph::new(file.n_vertices(), &edges)?)
        }
        Kind::Graph => {
            let edges = file.edges();
            // A matrix that lists both directions has every edge twice; half of each makes the edge.
            let part = if edges.direction == Direction::RowToColumn { 0.5 } else { 1.0 };
            let weight = |k: usize| part * edges.weights.get(k).copied().unwrap_or(1.0);
            let list: Vec<_> = edges.pairs.iter().enumerate().map(|(k, &[a, b])| (a, b, weight(k))).collect();
            Shape::Graph(Graph::new(file.n_vertices(), &list)?)
        }
    })
}

/// The distinct undirected edges of the faces.
fn edges_of_faces(file: &ShapeFile) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = file
        .faces()
        .iter()
        .flat_map(|face| (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]))
        .map(|[a, b]| [a.min(b), a.max(b)])
        .filter(|[a, b]| a != b)
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}
