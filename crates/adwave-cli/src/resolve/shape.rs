//! From the SHAPE argument to a shape.

use super::applicable::check_shape_options;
use super::brain::brain_of;
use super::walk::{GivenWalk, read_points};
pub(crate) use crate::args::GivenLength;
use crate::args::{OPERATOR_OPTIONS, SelectionArgs, ShapeArgs, to_path};
use crate::error::CliError;
use crate::global::Global;
use crate::output::health::kind_name;
use crate::output::progress::with_spinner;
use crate::output::{count, note};
use adwave::region::Length;
use adwave::sample::{GridSample, NoiseSigma, Sample};
use adwave::shape::{Graph, Shape};
use adwave::{ClassifiedError, Decomposer, ErrorKind};
use adwave_io::{
    CloudPart, Direction, Edges, FaceCells, Field, FieldValues, GRID_VALUES, GridLayout, LengthUnit,
    MovedNormals, ReadError, SelectedShape, Selection, ShapeFile, ShapeKind, VolumeSeries, read_bytes,
    read_cloud_part_with, read_path_with,
};
use std::io::Read;

/// A shape in the form of its file and in the form of the computation.
pub(crate) struct Input {
    /// The file's content, to write it back.
    pub(crate) file: ShapeFile,
    /// The shape.
    pub(crate) shape: Shape,
    /// The name in reports.
    pub(crate) name: String,
    /// True if lengths in model units are accepted although coordinates are degrees.
    pub(crate) allows_degrees: bool,
    /// The mesh whose faces the shape has as nodes, for a field of faces.
    pub(crate) mesh_of_cells: Option<Box<ShapeFile>>,
    /// Source of the operator.
    pub(crate) carrier: Carrier,
}

/// Source of the operator of an input.
pub(crate) enum Carrier {
    /// The operator of its shape, by the options of the command.
    Shape,
    /// A walk from a file.
    Walk(GivenWalk),
    /// A domain of the program's own; the shape is the graph of its neighbors.
    Own(Decomposer),
}

impl Input {
    /// The words for one row of a signal and for several.
    pub(crate) fn row_words(&self) -> [&'static str; 2] {
        if self.mesh_of_cells.is_some() { ["face", "faces"] } else { row_words(&self.file) }
    }

    /// `mesh`, `cloud`, `graph`, `sequence`, `image`, `volume` or `brain`.
    pub(crate) fn kind_name(&self) -> &'static str {
        if self.file.brain().is_some() {
            return "brain";
        }
        match self.file.grid().map(|grid| grid.sizes.len()) {
            Some(1) => "sequence",
            Some(2) => "image",
            Some(_) => "volume",
            None => kind_name(&self.shape),
        }
    }

    /// The number of rows of a signal in words.
    pub(crate) fn count_rows(&self) -> String {
        let [one, many] = self.row_words();
        count(self.shape.n_vertices(), one, many)
    }

    /// The faces of the mesh as the nodes of a shape if the signal is a field of faces; the input itself if not.
    pub(crate) fn resolve_cells(self, signal: &str, global: &Global<'_>) -> Result<Self, CliError> {
        let Some(mesh) = self.shape.as_mesh() else { return Ok(self) };
        if !self.file.has_face_field(signal) {
            return Ok(self);
        }
        let FaceCells { file, shape } = with_spinner(global, "preparing", || {
            FaceCells::new(mesh, self.file.face_fields())
                .map_err(|e| CliError::Input(format!("{}: {e}", self.name)))
        })?;
        global.inputs.add_remark(format!(
            "{signal} is a field of faces: it diffuses between faces that share a side, weighted by their areas, and regions \
             are taken at their centers"
        ));
        Ok(Self { file, shape, mesh_of_cells: Some(Box::new(self.file)), ..self })
    }

    /// Refuses lengths in model units if coordinates are degrees, in which a length means nothing.
    pub(crate) fn check_lengths(&self, lengths: &[GivenLength]) -> Result<(), CliError> {
        let Some(system) = self.file.coordinate_system().filter(|system| system.is_geographic()) else {
            return Ok(());
        };
        if self.allows_degrees {
            return Ok(());
        }
        for GivenLength { option, length } in lengths {
            if let Length::Units(units) = length
                && *units != 0.0
            {
                return Err(CliError::Input(format!(
                    "{option} needs coordinates in a unit of length, but those of {} are degrees ({}), got {units}; project \
                     the file to meters, or give --allow-degrees to take lengths as they are",
                    self.name, system.name
                )));
            }
        }
        Ok(())
    }
}

/// Description of where a shape comes from.
#[derive(Clone, Copy)]
pub(crate) struct ShapeSource<'a> {
    /// A file, `-`, or `sample:NAME`.
    pub(crate) shape: &'a str,
    /// The file's volumes, if the first alone is read here.
    pub(crate) series: Option<&'a VolumeSeries>,
    pub(crate) kind: Option<ShapeKind>,
    pub(crate) sample: SampleSize,
    /// The part of a cloud that is read.
    pub(crate) part: CloudPart,
    /// The vertices that take part; `None` for all, with those that the file flags.
    pub(crate) selection: Option<&'a SelectionArgs>,
    /// Neighbors of points of any dimension; `None` for the usual number.
    pub(crate) neighbors: Option<usize>,
    /// Surfaces of the parts of a CIFTI.
    pub(crate) surfaces: &'a [String],
}

/// Prefix of a table of points of any dimension.
pub(crate) const POINTS: &str = "points:";

/// Size and noise of a sample.
#[derive(Clone, Copy)]
pub(crate) struct SampleSize {
    /// Approximate number of vertices.
    pub(crate) n_vertices: Option<usize>,
    /// Standard deviation of the noise along the normals, in mean edge lengths.
    pub(crate) noise: Option<f64>,
    /// Seed of the noise.
    pub(crate) seed: u64,
}

impl Default for SampleSize {
    fn default() -> Self {
        Self { n_vertices: None, noise: None, seed: 1 }
    }
}

impl<'a> ShapeSource<'a> {
    /// Source of a shape with all its vertices and no further options.
    pub(crate) fn new(shape: &'a str) -> Self {
        let (sample, part) = (SampleSize::default(), CloudPart::default());
        Self {
            shape,
            series: None,
            kind: None,
            sample,
            part,
            selection: None,
            neighbors: None,
            surfaces: &[],
        }
    }
}

/// Reads or makes the shape that the arguments ask for, and refuses options that apply to nothing on it.
pub(crate) fn load_shape(args: &ShapeArgs, global: &Global<'_>) -> Result<Input, CliError> {
    let input = load_one_of_two(args, global)?;
    check_shape_options(&[&input], global)?;
    Ok(input)
}

/// [`load_shape`] for a command that compares two shapes, whose options may apply to either of them.
pub(crate) fn load_one_of_two(args: &ShapeArgs, global: &Global<'_>) -> Result<Input, CliError> {
    load(args, None, global)
}

/// [`load_shape`] for a series of volumes that are read one at a time: the first of them.
pub(crate) fn load_first_volume(
    args: &ShapeArgs,
    series: &VolumeSeries,
    global: &Global<'_>,
) -> Result<Input, CliError> {
    let input = load(args, Some(series), global)?;
    check_shape_options(&[&input], global)?;
    Ok(input)
}

fn load(args: &ShapeArgs, series: Option<&VolumeSeries>, global: &Global<'_>) -> Result<Input, CliError> {
    let sample = SampleSize { n_vertices: args.vertices, noise: args.noise, seed: args.seed };
    let (part, selection) = (args.part.to_part(), Some(&args.selection));
    let neighbors = global.given.has("--neighbors").then(|| args.operator.neighbors.get());
    let surfaces = &args.surface;
    let (shape, kind) = (&args.shape, args.kind);
    let source = ShapeSource { shape, series, kind, sample, part, selection, neighbors, surfaces };
    let mut input = load_source(&source, global)?;
    input.allows_degrees = args.allow_degrees;
    Ok(input)
}

/// Reads or makes a shape.
pub(crate) fn load_source(source: &ShapeSource<'_>, global: &Global<'_>) -> Result<Input, CliError> {
    with_spinner(global, "reading", || {
        let name = source.shape.to_owned();
        check_source(source)?;
        // A condition that cannot be read is refused before a large file is read.
        let selection = source.selection.map(SelectionArgs::to_selection).transpose()?;
        let own = open_own_domain(&name, global)?;
        let file = if let Some(own) = &own {
            global.inputs.add_unhashed(source.shape);
            graph_of_domain(own)
        } else if let Some(sample) = source.shape.strip_prefix("sample:") {
            global.inputs.add_unhashed(source.shape);
            make_sample(sample, &source.sample)?
        } else if let Some(path) = source.shape.strip_prefix(POINTS) {
            read_points(&to_path(path), source, global)?
        } else if let Some(series) = source.series {
            global.inputs.add_file(series.path());
            series.first(&global.limits, global.progress()).map_err(CliError::input)?
        } else {
            read(source.shape, &source.part, global)?
        };
        // Messages about a CIFTI speak of the vertices of its surfaces.
        if file.brain().is_none() {
            global.inputs.set_row_words(row_words(&file));
        }
        note_left_out(&file, &name, global);
        for text in file.notes() {
            global.inputs.add_remark(text.clone());
        }
        let kind = source.kind.unwrap_or_else(|| file.kind());
        let brain = brain_of(&file, &name, source.surfaces, global)?;
        let file = match selection {
            Some(selection) => select(file, &name, SelectionUse { selection, rest: Rest::Stays }, global)?,
            None => file,
        };
        let shape = if file.carries_values() {
            // The operator is that of the grid or of the parts.
            Graph::new(file.n_vertices(), &[]).map(Shape::Graph).map_err(|e| e.to_string())
        } else {
            file.to_shape_as(kind).map_err(|e| e.to_string())
        };
        let shape = shape.map_err(|e| CliError::Input(format!("{name}: {e}")))?;
        if shape.is_graph()
            && !global.given.has("--walk")
            && let Some(text) = file.graph_changes().note()
        {
            let takes_walk = ["transform", "filter", "denoise", "saliency", "features", "report", "info"];
            let change = if takes_walk.contains(&global.given.command()) {
                "; --walk FILE takes a matrix of probabilities as it is"
            } else {
                ""
            };
            global.inputs.add_remark(format!("{name}: {text}{change}"));
        }
        let carrier = match own.or(brain).or(grid_of(&file, &name, global)?) {
            Some(domain) => Carrier::Own(domain),
            None => Carrier::Shape,
        };
        Ok(Input { file, shape, name, allows_degrees: false, mesh_of_cells: None, carrier })
    })
}

/// The domain of the program's own that a name stands for, if it does.
fn open_own_domain(name: &str, global: &Global<'_>) -> Result<Option<Decomposer>, CliError> {
    let Some((word, text)) = name.split_once(':') else { return Ok(None) };
    let Some(own) = global.program.domains.iter().find(|own| own.name == word) else { return Ok(None) };
    global
        .given
        .refuse(&OPERATOR_OPTIONS, &format!("applies to shapes, and {name} has an operator of its own"))?;
    (own.open)(text).map(Some).map_err(|e| CliError::Input(format!("{name}: {e}")))
}

/// The words for one place of a file and for several.
pub(crate) fn row_words(file: &ShapeFile) -> [&'static str; 2] {
    if file.brain().is_some() {
        return ["place", "places"];
    }
    match file.grid().map(|grid| grid.sizes.len()) {
        Some(1) => ["sample", "samples"],
        Some(2) => ["pixel", "pixels"],
        Some(_) => ["voxel", "voxels"],
        None => ["vertex", "vertices"],
    }
}

/// Commands that take images and volumes.
const GRID_COMMANDS: [&str; 13] = [
    "info",
    "transform",
    "filter",
    "denoise",
    "saliency",
    "features",
    "region",
    "diff",
    "compare",
    "report",
    "render",
    "convert",
    "studio",
];

/// The domain of an image or a volume, with heat on its grid.
fn grid_of(file: &ShapeFile, name: &str, global: &Global<'_>) -> Result<Option<Decomposer>, CliError> {
    let Some(layout) = file.grid() else { return Ok(None) };
    let command = global.given.command();
    if !GRID_COMMANDS.contains(&command) {
        return Err(CliError::Input(format!(
            "{command} takes shapes, and {name} is an image or a volume; {} take these",
            GRID_COMMANDS.join(", ")
        )));
    }
    global.given.refuse(
        &OPERATOR_OPTIONS,
        &format!("applies to shapes, and {name} is a grid, which has heat of its own"),
    )?;
    if layout.n_missing() == layout.n_places() {
        return Err(CliError::Input(format!("{name}: no place has data; all are NaN, NODATA or left out")));
    }
    let grid = layout.to_grid().map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    let heat = grid.heat();
    Decomposer::from_domain(grid, heat).map(Some).map_err(|e| CliError::Input(format!("{name}: {e}")))
}

/// The places of a domain as nodes, with an edge between neighbors.
fn graph_of_domain(domain: &Decomposer) -> ShapeFile {
    let (map, neighbors) = (domain.vertex_map(), domain.neighbors());
    let mut place_of_row = vec![0; map.n_welded()];
    for place in (0..map.n_vertices()).rev() {
        place_of_row[map.welded(place)] = place as u32;
    }
    let mut edges = Edges { direction: Direction::Both, ..Edges::default() };
    for x in 0..map.n_welded() {
        let after = neighbors.row(x).iter().filter(|y| **y as usize > x);
        edges.pairs.extend(after.map(|&y| [place_of_row[x], place_of_row[y as usize]]));
    }
    edges.weights = vec![1.0; edges.pairs.len()];
    ShapeFile::from_graph(map.n_vertices(), edges)
}

/// A selection and the treatment of the vertices that take no part.
pub(crate) struct SelectionUse {
    pub(crate) selection: Selection,
    pub(crate) rest: Rest,
}

/// Fate of the vertices that take no part.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rest {
    /// The other vertices keep their values.
    Stays,
    /// The other vertices are not written.
    IsDropped,
}

/// The part of a file whose vertices take part, with a note of their number.
pub(crate) fn select(
    file: ShapeFile,
    name: &str,
    selection: SelectionUse,
    global: &Global<'_>,
) -> Result<ShapeFile, CliError> {
    let SelectionUse { selection, rest } = selection;
    if let Some(mask) = &selection.mask {
        global.inputs.add_signal(&mask.name, None);
    }
    let selected = selection.apply(file).map_err(|e| match e.kind() {
        ErrorKind::Cancelled => CliError::Cancelled,
        _ => CliError::Input(format!("{name}: {e}")),
    })?;
    if let Some(text) = describe_selected(&selected, name, &selection) {
        let others = if rest == Rest::Stays { "keep their values" } else { "are not written" };
        global.inputs.add_remark(format!("{text}; the others {others}"));
    }
    Ok(selected.file)
}

/// Sentence on the vertices that take part; `None` if nothing chose them and all do.
fn describe_selected(selected: &SelectedShape, name: &str, selection: &Selection) -> Option<String> {
    let SelectedShape { file, n_before, n_flagged, mask_meaning } = selected;
    let n = file.grid().map_or_else(|| file.n_vertices(), |grid| grid.n_places() - grid.n_missing());
    let [_, rows] = row_words(file);
    let flagged = format!(
        "{} flagged as withheld or classified as noise (7, 18), which --all-points includes",
        count(*n_flagged, "point", "points")
    );
    if !selection.is_restricted() {
        let text = format!("{n} of {n_before} points of {name} take part: without {flagged}");
        return (*n_flagged > 0).then_some(text);
    }
    let mut reasons = selection.describe().join(" and ");
    if let Some(meaning) = mask_meaning {
        let inverse = if selection.is_mask_inverted() { "leave out --invert-mask" } else { "--invert-mask" };
        reasons += &format!(" ({meaning}; {inverse} for the other side)");
    }
    if *n_flagged > 0 {
        reasons += &format!(", without {flagged}");
    }
    Some(format!("{n} of {n_before} {rows} of {name} take part: {reasons}"))
}

/// Prints a note that rows of the file are not part of the shape.
fn note_left_out(file: &ShapeFile, name: &str, global: &Global<'_>) {
    let (n_rows, n_left) = (file.n_file_rows(), file.n_file_rows() - file.n_vertices());
    if n_left > 0 {
        let text = format!(
            "{n_left} of {n_rows} points of {name} have no position and are left out; vertices are numbered by the rows of \
             the file"
        );
        global.inputs.add_remark(text);
    }
}

/// Refuses options that do not go with the kind of source.
fn check_source(source: &ShapeSource<'_>) -> Result<(), CliError> {
    let name = source.shape;
    if !source.part.is_whole() && (name == "-" || name.starts_with("sample:") || name.starts_with(POINTS)) {
        return Err(CliError::Input(format!(
            "--box and --resolution apply to files (LAS, LAZ, COPC, EPT), and '{name}' is not a file"
        )));
    }
    if let Some((min, max)) = source.part.bounds
        && let Some(infinite) = [min[0], min[1], max[0], max[1]].iter().find(|c| c.is_infinite())
    {
        return Err(CliError::Input(format!("--box must have finite bounds in x and y, got {infinite}")));
    }
    let sample = &source.sample;
    for (flag, is_given) in [("--vertices", sample.n_vertices.is_some()), ("--noise", sample.noise.is_some())]
    {
        if is_given && !name.starts_with("sample:") {
            return Err(CliError::Input(format!("{flag} applies to samples, and '{name}' is a file")));
        }
    }
    Ok(())
}

/// Makes a built-in shape, image or volume.
pub(crate) fn make_sample(name: &str, size: &SampleSize) -> Result<ShapeFile, CliError> {
    if let Some(mut grid) = GridSample::from_name(name, size.n_vertices).map_err(CliError::input)? {
        if let Some(sigma) = size.noise {
            grid.add_noise(NoiseSigma::MeanEdge(sigma), size.seed).map_err(CliError::input)?;
        }
        let is_image = grid.sizes.len() == 2;
        let unit = if is_image { LengthUnit::METER } else { LengthUnit::MILLIMETER };
        let layout = GridLayout { unit: Some(unit), ..GridLayout::new(&grid.sizes, &grid.spacings) };
        let mut file = ShapeFile::from_grid(layout)?;
        let values = grid.values.iter().map(|v| *v as f32).collect();
        let mut field = Field::new(GRID_VALUES, grid.n_frames, FieldValues::F32(values));
        field.frame_step = grid.frame_step;
        file.add_vertex_field(field)?;
        return Ok(file);
    }
    let mut sample = Sample::from_name(name, size.n_vertices).map_err(CliError::input)?;
    if let Some(sigma) = size.noise {
        sample.add_noise(NoiseSigma::MeanEdge(sigma), size.seed).map_err(CliError::input)?;
    }
    Ok(ShapeFile::from_mesh(sample.points, sample.faces))
}

fn read(source: &str, part: &CloudPart, global: &Global<'_>) -> Result<ShapeFile, CliError> {
    let (limits, path) = (&global.limits, &to_path(source));
    let read = if source == "-" {
        let mut bytes = Vec::new();
        std::io::stdin()
            .lock()
            .take(limits.max_bytes.saturating_add(1))
            .read_to_end(&mut bytes)
            .map_err(|e| CliError::Environment(format!("cannot read the standard input: {e}")))?;
        global.inputs.add_bytes(source, &bytes);
        read_bytes(bytes, None, limits)
    } else if part.is_whole() {
        global.inputs.add_file(path);
        read_path_with(path, limits, global.progress())
    } else {
        // A hash would be that of the whole file.
        global.inputs.add_unhashed(source);
        read_cloud_part_with(path, part, limits, global.progress())
    };
    read.map_err(|error| {
        if error.kind() == ErrorKind::Cancelled {
            return CliError::Cancelled;
        }
        let mut text = error.to_string();
        if matches!(innermost_error(&error), ReadError::Limit { what: "bytes", .. }) {
            text = text.replace("raise the limit", "raise the limit (--max-input 8G)");
        }
        let shown = path.display().to_string();
        CliError::Input(if text.contains(&shown) { text } else { format!("{source}: {text}") })
    })
}

/// The error without the name of the file.
fn innermost_error(error: &ReadError) -> &ReadError {
    if let ReadError::InFile { source, .. } = error { innermost_error(source) } else { error }
}

/// The vertex in a row of the file. A row beyond the file stays as it is, so that the error of the caller names it.
pub(crate) fn vertex_in_row(input: &Input, row: usize) -> Result<usize, CliError> {
    let Some(rows) = input.file.file_rows().filter(|rows| row < rows.n_rows()) else { return Ok(row) };
    rows.vertex(row).ok_or_else(|| {
        CliError::Input(format!("vertex {row} of {} is left out; name one that takes part", input.name))
    })
}

/// Moves the points of a file with the normals that depend on them, and prints a note on these.
pub(crate) fn move_points(
    file: &mut ShapeFile,
    points: Vec<[f64; 3]>,
    normals: MovedNormals,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let is_moved = file.points() != points;
    let attributes = file.move_points(points, normals, global.progress())?;
    if normals == MovedNormals::Keep && is_moved && attributes.stale.is_empty() {
        global.given.refuse(&["--keep-normals"], "applies to files with normals, and this one has none")?;
    }
    if let Some(text) = attributes.note() {
        note(global, &text);
    }
    Ok(())
}
