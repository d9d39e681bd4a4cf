//! State of an open shape.

use crate::StudioError;
use crate::autosave::Autosave;
use crate::band_edit::default_levels;
use crate::field_bands::is_editable;
use crate::fields::{FieldInfo, list_fields};
use crate::graph_layout::{GraphLayout, graph_layout};
use crate::prepared_shape::{PreparedShape, PreparedSource, build_decomposer};
use crate::response::ApiError;
use crate::workspace::{OpenedAt, Workspace};
use adwave::operator::OperatorKind;
use adwave::shape::{Graph, Shape, bounding_box, diagonal, triangulate};
use adwave::{Decomposer, LevelSpec, Progress};
use adwave_io::{
    DEGREE, Edges, Field, FieldValues, Format, MovedNormals, ShapeFile, ShapeKind, SignalSource,
    named_signal, write_bytes,
};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, RwLock};

/// Largest number of vertices; with eight bands a browser needs about 100 bytes per vertex.
const MAX_VERTICES: usize = 12_000_000;
/// Largest number of edges of a graph or a curve; the page draws all of them.
const MAX_EDGES: usize = 1 << 24;
/// Smallest size of a graph without positions, in edges, of which the page takes shares as the radius of its brush.
const LEAST_ACROSS: usize = 40;
/// Size by which the nodes of a graph and of a curve are drawn, relative to the mean length of its edges.
const NODE: f64 = 0.6;
const CURVE_NODE: f64 = 0.35;

/// Shape to open in the studio.
#[derive(Clone, Debug)]
pub struct StudioInput {
    /// Display name.
    pub name: String,
    /// Path of the shape's file; results are saved next to it.
    pub path: Option<PathBuf>,
    /// Content of the file.
    pub file: ShapeFile,
    /// Geometry of the file.
    pub shape: Shape,
}

/// Open shape with its lazily computed state.
pub(crate) struct Session {
    pub(crate) workspace: Workspace,
    /// Geometry of the file.
    pub(crate) shape: Shape,
    /// Content of the file, with the fields that were added.
    file: RwLock<Arc<ShapeFile>>,
    /// Names of the fields that cannot be edited; `None` until they are needed.
    uneditable: Mutex<Option<Arc<HashSet<String>>>>,
    /// Places of the nodes of a graph without positions.
    layout: Option<GraphLayout>,
    /// True while the field of the degree is the one that was added here, and no file's.
    has_own_degree: AtomicBool,
    pub(crate) center: [f64; 3],
    pub(crate) triangles: Vec<[u32; 3]>,
    walk_decomposer: OnceLock<Result<Decomposer, Arc<StudioError>>>,
    prepared: OnceLock<Result<Mutex<PreparedShape>, Arc<StudioError>>>,
    /// Indices of the vertices that the page draws while the shape moves.
    drawn: Mutex<Arc<Vec<u32>>>,
}

impl Session {
    /// Opens a shape; `progress` reports while the nodes of a graph are placed.
    pub(crate) fn new(input: StudioInput, at: OpenedAt, progress: Progress<'_>) -> Result<Self, StudioError> {
        let n = input.shape.n_vertices();
        if n > MAX_VERTICES {
            return Err(StudioError::TooLarge { name: input.name, n, max: MAX_VERTICES });
        }
        let layout = match &input.shape {
            Shape::Graph(graph) => layout_of(graph, &input.name, progress)?,
            _ => None,
        };
        let points = points_of(&input.shape, layout.as_ref());
        let center = bounding_box(points)
            .map_or([0.0; 3], |(low, high)| std::array::from_fn(|c| 0.5 * low[c] + 0.5 * high[c]));
        let triangles = match &input.shape {
            Shape::Mesh(mesh) => triangulate(points, mesh.faces()),
            _ => Vec::new(),
        };
        let coordinates = points.as_flattened();
        let autosave = Autosave::new(input.path.as_deref(), coordinates, at.autosave_folder.as_deref());
        let StudioInput { name, path, mut file, shape } = input;
        if let Some(autosave) = &autosave {
            // Fields of the last session, which regions of the edit may use.
            for stored in autosave.field_files() {
                let _ = add_values(&mut file, &shape, &stored);
            }
        }
        let wants_degree = shape.is_graph() && shape.as_curve().is_none() && file.field(DEGREE).is_none();
        if wants_degree {
            add_degree(&mut file, &shape)?;
        }
        Ok(Self {
            workspace: Workspace::new(at, name, path, autosave),
            shape,
            file: RwLock::new(Arc::new(file)),
            uneditable: Mutex::default(),
            layout,
            has_own_degree: AtomicBool::new(wants_degree),
            center,
            triangles,
            walk_decomposer: OnceLock::new(),
            prepared: OnceLock::new(),
            drawn: Mutex::default(),
        })
    }

    /// Returns a handle that is cancelled at shutdown.
    pub(crate) fn progress(&self) -> Progress<'_> {
        self.workspace.progress()
    }

    pub(crate) fn set_drawn(&self, vertices: Vec<u32>) {
        *self.drawn.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(vertices);
    }

    /// Returns the indices of the vertices that the page draws while the shape moves.
    pub(crate) fn drawn_vertices(&self) -> Arc<Vec<u32>> {
        Arc::clone(&self.drawn.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the diffusion of the walk operator, whose steps define the levels; computed once.
    pub(crate) fn walk_decomposer(&self) -> Result<&Decomposer, ApiError> {
        let result = self.walk_decomposer.get_or_init(|| {
            self.workspace.expect_turn();
            build_decomposer(&self.shape, OperatorKind::Walk, self.progress()).map_err(Arc::new)
        });
        result.as_ref().map_err(|e| ApiError::from_classified(&**e))
    }

    /// Locks the bands and the edit; the first call computes them and restores the edit of the last session.
    pub(crate) fn lock_prepared(&self) -> Result<MutexGuard<'_, PreparedShape>, ApiError> {
        let mut prepared = self.lock_unsplit()?;
        prepared.bands.split(self.progress())?;
        Ok(prepared)
    }

    /// Locks the shape with its levels and its edit, whose bands need not be computed. On the first visit a picture is
    /// shown before they are.
    pub(crate) fn lock_unsplit(&self) -> Result<MutexGuard<'_, PreparedShape>, ApiError> {
        self.workspace.expect_turn();
        let walk = self.walk_decomposer()?;
        let result = self.prepared.get_or_init(|| {
            let unedited = || self.prepare_unsplit(walk, default_levels(walk), self.progress());
            let stored = self.workspace.autosave.as_ref().and_then(Autosave::read);
            let resumed = stored.and_then(|(levels, document)| {
                let mut prepared = self.prepare(walk, levels, self.progress()).ok()?;
                prepared.apply_edit(document, &self.file()).ok()?;
                Some(prepared)
            });
            let _ = self.workspace.was_resumed.set(resumed.is_some());
            let prepared = resumed.map_or_else(unedited, Ok);
            prepared.map(Mutex::new).map_err(Arc::new)
        });
        let prepared = result.as_ref().map_err(|e| ApiError::from_classified(&**e))?;
        Ok(prepared.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the content of the file with the fields that were added.
    pub(crate) fn file(&self) -> Arc<ShapeFile> {
        Arc::clone(&self.file.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// Returns the names of the file's fields that cannot be edited; computed once for each content of the file.
    pub(crate) fn uneditable_fields(&self) -> Arc<HashSet<String>> {
        let mut known = self.uneditable.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(known.get_or_insert_with(|| {
            let file = self.file();
            let single = file.vertex_fields().iter().filter(|field| field.n_channels == 1);
            let uneditable = single.filter(|field| !is_editable(field));
            Arc::new(uneditable.map(|field| field.name.clone()).collect())
        }))
    }

    /// Adds the per-vertex values of a file as fields, and returns the names of the new fields.
    pub(crate) fn add_fields(&self, name: &str, content: &[u8]) -> Result<Vec<String>, ApiError> {
        let folder = tempfile::tempdir().map_err(StudioError::from)?;
        let path = folder.path().join(name);
        std::fs::write(&path, content).map_err(StudioError::from)?;
        let mut file = ShapeFile::clone(&self.file());
        let names = add_values(&mut file, &self.shape, &path)
            // The message names the file by its place on this machine.
            .map_err(|e| ApiError::bad_request(e.replace(&path.display().to_string(), name)))?;
        if let Some(autosave) = &self.workspace.autosave {
            autosave.write_field_file(name, content)?;
        }
        if names.iter().any(|name| name == DEGREE) {
            self.has_own_degree.store(false, Ordering::Relaxed);
        }
        *self.file.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(file);
        *self.uneditable.lock().unwrap_or_else(PoisonError::into_inner) = None;
        if let Some(Ok(prepared)) = self.prepared.get() {
            // A field of the same name may have been replaced.
            prepared.lock().unwrap_or_else(PoisonError::into_inner).field_bands = None;
        }
        Ok(names)
    }

    /// Positions of the vertices, or the places of the nodes of a graph without positions.
    pub(crate) fn points(&self) -> &[[f64; 3]] {
        points_of(&self.shape, self.layout.as_ref())
    }

    /// Computes the bands of `levels`; the edit is empty.
    pub(crate) fn prepare(
        &self,
        walk: &Decomposer,
        levels: LevelSpec,
        progress: Progress<'_>,
    ) -> Result<PreparedShape, StudioError> {
        let mut prepared = self.prepare_unsplit(walk, levels, progress)?;
        prepared.bands.split(progress)?;
        Ok(prepared)
    }

    fn prepare_unsplit(
        &self,
        walk: &Decomposer,
        levels: LevelSpec,
        progress: Progress<'_>,
    ) -> Result<PreparedShape, StudioError> {
        let source = PreparedSource { shape: &self.shape, points: self.points(), walk };
        PreparedShape::new(&source, levels, progress)
    }

    /// Edges of a graph or a curve, each once; other shapes have none.
    pub(crate) fn edges(&self) -> Vec<[u32; 2]> {
        let Shape::Graph(graph) = &self.shape else { return Vec::new() };
        let rows = (0..graph.n_nodes()).map(|u| (u as u32, graph.adjacency().row(u)));
        rows.flat_map(|(u, row)| row.iter().filter(move |&&v| v > u).map(move |&v| [u, v])).collect()
    }

    /// Stores the edit for the next session.
    pub(crate) fn store_edit(&self, prepared: &PreparedShape) -> Result<(), ApiError> {
        self.workspace.store_edit(&prepared.bands.levels, &prepared.bands.document)
    }

    /// Returns the content of the file with the edited positions, and with its turned parts.
    pub(crate) fn edited_file(&self, prepared: &PreparedShape) -> Result<ShapeFile, ApiError> {
        let mut file = ShapeFile::clone(&self.file());
        let turned = &prepared.bands.document.turned;
        if !turned.is_empty() {
            let is_turned = prepared.turned_faces(turned, &file)?;
            file.turn_faces(&is_turned).map_err(|e| ApiError::from_classified(&e))?;
        }
        if self.layout.is_none() {
            file.move_points(prepared.points.to_vec(), MovedNormals::Follow, self.progress())
                .map_err(|e| ApiError::from_classified(&e))?;
        }
        Ok(file)
    }

    /// Returns the content of the file with the edited positions and fields.
    pub(crate) fn saved_file(&self, prepared: &mut PreparedShape) -> Result<ShapeFile, ApiError> {
        let mut file = self.edited_file(prepared)?;
        prepared.replace_edited_fields(&mut file, self.progress())?;
        if !prepared.bands.document.changed_fields().iter().any(|name| name == DEGREE) {
            self.drop_own_degree(&mut file);
        }
        Ok(file)
    }

    /// Returns the content of the file without the edit, for a session that ends before its bands are there.
    pub(crate) fn unedited_file(&self) -> ShapeFile {
        let mut file = ShapeFile::clone(&self.file());
        self.drop_own_degree(&mut file);
        file
    }

    /// Drops the degrees of nodes that the studio added to the fields.
    fn drop_own_degree(&self, file: &mut ShapeFile) {
        if self.has_own_degree.load(Ordering::Relaxed) {
            file.drop_added_fields(|name| name == DEGREE);
        }
    }

    /// Describes a graph or a curve, and the size of its picture; `None` for other shapes.
    fn describe_graph(&self) -> Option<(Value, f64)> {
        let graph = self.shape.as_graph()?;
        let points = self.points();
        let n_edges = graph.adjacency().nnz() / 2;
        // The diagonal of two points is their distance.
        let rows = points.iter().enumerate().map(|(u, point)| (point, graph.adjacency().row(u)));
        let lengths =
            rows.flat_map(|(point, row)| row.iter().map(|&v| diagonal(&[*point, points[v as usize]])));
        let mean = lengths.sum::<f64>() / (2 * n_edges).max(1) as f64;
        let room = diagonal(points) / (3.0 * (points.len() as f64).sqrt());
        let size = if graph.is_curve() { CURVE_NODE } else { NODE };
        let spacing = if mean > 0.0 { room.min(size * mean) } else { room };
        let is_flat = points.iter().all(|point| point[2] == points[0][2]);
        let is_named = self.file().vertex_names().is_some();
        let described = json!({
            "n_edges": n_edges, "flat": is_flat, "placed": self.layout.is_some(), "named": is_named,
        });
        Some((described, spacing))
    }

    /// Describes the shape for the page.
    pub(crate) fn describe(&self) -> Result<Value, ApiError> {
        let prepared = self.lock_unsplit()?;
        let health = prepared.health();
        let inward: Vec<Value> = prepared
            .inward_parts()?
            .iter()
            .map(|part| json!({"vertex": part.first_vertex, "n_faces": part.n_faces, "volume": part.volume}))
            .collect();
        let (workspace, bands) = (&self.workspace, &prepared.bands);
        let kind = match &self.shape {
            Shape::Graph(graph) if graph.is_curve() => "curve",
            Shape::Graph(_) => "graph",
            _ if self.triangles.is_empty() => "cloud",
            _ => "mesh",
        };
        let (graph, spacing) = self.describe_graph().unzip();
        let across = self.layout.as_ref().map(|layout| layout.n_across.max(LEAST_ACROSS) as f64);
        Ok(json!({
            "id": workspace.id,
            "name": workspace.name,
            "format": self.file().format().map(Format::name),
            "formats": self.writable_formats(),
            "kind": kind,
            "n_vertices": self.shape.n_vertices(),
            "n_triangles": self.triangles.len(),
            "center": self.center,
            "graph": graph,
            "diagonal": across.unwrap_or_else(|| bands.decomposer.extent()),
            "mean_length": spacing.unwrap_or_else(|| bands.decomposer.mean_length()),
            "closed": health.is_closed(),
            "volume": health.volume,
            "components": health.n_components,
            "inward": inward,
            "notes": describe_defects(health),
            "levels": bands.level_infos(),
            "choice": bands.levels_request(),
            "fields": list_fields(self, bands.n_levels()).iter().map(FieldInfo::to_json).collect::<Vec<_>>(),
            "presets": bands.presets(),
            "resumed": self.workspace.was_resumed.get().copied().unwrap_or(false),
        }))
    }

    /// Lists the names of formats that can store this shape.
    fn writable_formats(&self) -> Vec<&'static str> {
        let file = self.file();
        let probe = match file.kind() {
            ShapeKind::Graph => {
                let Edges { weights, direction, .. } = file.edges();
                let weights = weights.iter().take(1).map(|_| 1.0).collect();
                let edges = Edges { pairs: vec![[0, 1]], weights, direction: *direction };
                match self.layout {
                    Some(_) => ShapeFile::from_graph(2, edges),
                    None => ShapeFile::from_curve(vec![[0.0; 3], [1.0, 0.0, 0.0]], edges),
                }
            }
            ShapeKind::Mesh => {
                let faces = adwave::shape::Polygons::from_triangles(&[[0, 1, 2]]);
                ShapeFile::from_mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], faces)
            }
            _ => ShapeFile::from_cloud(vec![[0.0; 3]]),
        };
        let can_store = |format: &Format| write_bytes(&probe, *format, &mut std::io::sink()).is_ok();
        Format::all().filter(can_store).map(Format::name).collect()
    }
}

/// Positions of a shape, or the places of the nodes of a graph without positions.
fn points_of<'a>(shape: &'a Shape, layout: Option<&'a GraphLayout>) -> &'a [[f64; 3]] {
    shape.points().or(layout.map(|layout| layout.places.as_slice())).unwrap_or_default()
}

/// Places the nodes of a graph without positions.
fn layout_of(graph: &Graph, name: &str, progress: Progress<'_>) -> Result<Option<GraphLayout>, StudioError> {
    let n = graph.adjacency().nnz() / 2;
    if n > MAX_EDGES {
        let problem =
            format!("the studio draws up to {MAX_EDGES} edges, got {n}; filter it with `adwave filter`");
        return Err(StudioError::Unsuitable { name: name.to_owned(), problem });
    }
    if graph.positions().is_some() {
        return Ok(None);
    }
    let layout = graph_layout(graph, progress);
    layout.map(Some).map_err(|e| StudioError::from_classified(&e))
}

/// Adds the degree of the nodes, the default signal of a graph, as a field.
fn add_degree(file: &mut ShapeFile, shape: &Shape) -> Result<(), StudioError> {
    let source = SignalSource { file, shape, name: "the graph" };
    let degree = named_signal(source, DEGREE, None).map_err(|e| StudioError::from_classified(&e))?;
    let added = file.add_vertex_field(Field::new(DEGREE, 1, FieldValues::F64(degree.values.to_vec())));
    added.map_err(|e| StudioError::from_classified(&e))
}

/// Largest number of values per vertex that a file may add in any case.
const MAX_ADDED_FIELDS: usize = 64;

/// Largest number of values that a file of more channels may add: half a GiB of them.
const MAX_ADDED_VALUES: usize = 1 << 26;

/// Returns the name for the field of a file of values: the file name without its extensions.
pub(crate) fn name_of_values(file_name: &str) -> &str {
    ["gz", "npy", "dmat", "csv", "tsv", "txt", "gii", "nii", "mgh", "mgz", "annot", "label"]
        .iter()
        .fold(file_name, |stem, ending| stem.strip_suffix(&format!(".{ending}")).unwrap_or(stem))
}

/// Adds the per-vertex values of a file as fields, one for each channel, named after the file. Returns the names of the
/// fields, or the reason for which the file has no values for this shape.
fn add_values(file: &mut ShapeFile, shape: &Shape, path: &Path) -> Result<Vec<String>, String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let source = SignalSource { file, shape, name: "the shape" };
    let signal = named_signal(source, &path.to_string_lossy(), None).map_err(|e| e.to_string())?;
    let n_channels = signal.n_channels;
    let most = MAX_ADDED_FIELDS.max(MAX_ADDED_VALUES / shape.n_vertices().max(1));
    if n_channels > most {
        return Err(format!(
            "{name} must have at most {most} values for each of so many vertices, got {n_channels}; add a part of its frames, or fewer columns"
        ));
    }
    let stem = name_of_values(&name);
    let names: Vec<String> = match n_channels {
        1 => vec![stem.to_owned()],
        _ => (0..n_channels)
            .map(|c| {
                let channel = signal.channel_names.get(c).cloned().unwrap_or_else(|| (c + 1).to_string());
                format!("{stem} {channel}")
            })
            .collect(),
    };
    // Frames of a longer file of this name that was added before.
    let number = |field: &str| field.strip_prefix(stem)?.strip_prefix(' ')?.parse::<usize>().ok();
    file.drop_added_fields(|field| n_channels > 1 && number(field).is_some_and(|k| k > n_channels));
    for (c, name) in names.iter().enumerate() {
        let values = signal.values.iter().skip(c).step_by(n_channels).copied().collect();
        let mut field = Field::new(name.as_str(), 1, FieldValues::F64(values));
        // The page shows unnamed channels as the frames of a series.
        field.frame_step = signal.frame_step;
        file.add_vertex_field(field).map_err(|e| e.to_string())?;
    }
    Ok(names)
}

/// Describes unusual properties of a shape, one sentence each.
fn describe_defects(health: &adwave::shape::Health) -> Vec<String> {
    [
        (health.n_non_manifold_edges, "edges belong to three or more faces."),
        (health.n_misoriented_edges, "edges have inconsistently oriented faces."),
        (health.n_zero_area_faces, "faces have zero area."),
        (health.n_unreferenced, "vertices belong to no face; they are not moved."),
    ]
    .into_iter()
    .filter(|(n, _)| *n > 0)
    .map(|(n, what)| format!("{n} {what}"))
    .collect()
}
