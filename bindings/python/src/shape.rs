//! Shapes with everything that their file had.

use crate::arrays;
use crate::call::run;
use crate::error::value_error;
use crate::options::parse_name;
use adwave::sample::{NoiseSigma, Sample, SampleError};
use adwave::shape::{Polygons, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{
    CloudPart, Direction, Edges, FlaggedPoints, Format, MaskFile, MaskSide, MovedNormals, ReadLimits,
    Selection, SelectionError, ShapeFile, ShapeFileError, ShapeKind, SignalSource, named_signal,
    read_bytes_with, read_cloud_part_with, region_field, write_bytes_with, write_path_with, written_signal,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A shape with everything that its file had. It is immutable: changes give a new one.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct ShapeData {
    pub(crate) file: ShapeFile,
    pub(crate) kind: ShapeKind,
    pub(crate) name: String,
    /// Number of points that were left out because they are flagged as withheld or classified as noise.
    #[pyo3(get)]
    n_flagged: usize,
    shape: OnceLock<Shape>,
}

fn file_error(error: ShapeFileError) -> PyErr {
    value_error(error.to_string())
}

impl ShapeData {
    fn new(file: ShapeFile, kind: Option<ShapeKind>, name: String) -> Self {
        let kind = kind.unwrap_or_else(|| file.kind());
        Self { file, kind, name, n_flagged: 0, shape: OnceLock::new() }
    }

    /// The part of a file that a selection chooses.
    fn from_selected(
        file: ShapeFile,
        selection: &Selection,
        kind: Option<ShapeKind>,
        name: String,
    ) -> Result<Self, SelectionError> {
        // A mesh without faces among the vertices that take part stays a mesh.
        let kind = kind.unwrap_or_else(|| file.kind());
        let selected = selection.apply(file)?;
        Ok(Self { n_flagged: selected.n_flagged, ..Self::new(selected.file, Some(kind), name) })
    }

    /// The shape, which is built when it is first used.
    pub(crate) fn shape(&self, py: Python<'_>) -> PyResult<&Shape> {
        if let Some(shape) = self.shape.get() {
            return Ok(shape);
        }
        let shape = run(py, self.file.n_vertices(), None, |_| self.file.to_shape_as(self.kind))?;
        Ok(self.shape.get_or_init(|| shape))
    }

    /// A field that a region may name, with its number of channels.
    pub(crate) fn region_field(&self, decomposer: &Decomposer, name: &str) -> Option<(usize, Vec<f64>)> {
        region_field(&self.file, decomposer, name)
    }

    /// Another file with the same kind and name.
    pub(crate) fn with_file(&self, file: ShapeFile) -> Self {
        Self { n_flagged: self.n_flagged, ..Self::new(file, Some(self.kind), self.name.clone()) }
    }
}

fn parse_kind(kind: Option<&str>) -> PyResult<Option<ShapeKind>> {
    kind.map(|kind| parse_name("kind", kind)).transpose()
}

fn parse_format(format: Option<&str>) -> PyResult<Option<Format>> {
    let Some(name) = format else { return Ok(None) };
    if let Some(format) = Format::from_name(name) {
        return Ok(Some(format));
    }
    let names: Vec<&str> = Format::all().map(Format::name).collect();
    Err(value_error(format!("format must be one of {}, got '{name}'", names.join(", "))))
}

/// Part of a file to read.
#[derive(FromPyObject)]
struct ReadOptions {
    kind: Option<String>,
    bounds: Option<([f64; 3], [f64; 3])>,
    resolution: Option<f64>,
    selection: SelectionOptions,
}

/// Vertices that take part.
#[derive(FromPyObject)]
struct SelectionOptions {
    /// Conditions on fields.
    only: Vec<String>,
    /// Path of a mask.
    mask: Option<String>,
    invert_mask: bool,
    /// Flagged points take part.
    all_points: bool,
}

impl SelectionOptions {
    fn to_selection(&self) -> PyResult<Selection> {
        let conditions = self.only.iter().map(|text| text.parse()).collect::<Result<_, _>>();
        let side = if self.invert_mask { MaskSide::Outside } else { MaskSide::Inside };
        Ok(Selection {
            conditions: conditions.map_err(|e| value_error(format!("only: {e}")))?,
            mask: self.mask.clone().map(|name| MaskFile { name, side }),
            flagged: if self.all_points { FlaggedPoints::Included } else { FlaggedPoints::LeftOut },
        })
    }
}

/// Values of n × channels without the numbers that stand for unknown ones, and a clause on these; `None` if there are
/// none.
#[pyfunction]
pub(crate) fn mark_unknown<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'_, f64>,
) -> PyResult<Option<(Bound<'py, PyAny>, String)>> {
    let n_channels = values.shape()[1];
    let mut values = arrays::rows(&values, "values")?.to_vec();
    let unknown = adwave_io::mark_unknown(&mut values, n_channels.max(1));
    let Some(text) = adwave_io::describe_unknown("the signal", &unknown) else { return Ok(None) };
    Ok(Some((arrays::matrix(py, values, n_channels)?.into_any(), text)))
}

#[pymethods]
impl ShapeData {
    /// Reads a file, or a part of it.
    #[staticmethod]
    #[pyo3(signature = (path, options, progress=None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        options: ReadOptions,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let kind = parse_kind(options.kind.as_deref())?;
        let selection = options.selection.to_selection()?;
        let part = CloudPart { bounds: options.bounds, resolution: options.resolution };
        let limits = ReadLimits::default();
        let file =
            run(py, usize::MAX, progress.as_ref(), |p| read_cloud_part_with(&path, &part, &limits, p))?;
        let name = path.display().to_string();
        run(py, file.n_vertices(), None, |_| Self::from_selected(file, &selection, kind, name))
    }

    #[staticmethod]
    #[pyo3(signature = (content, name=None, kind=None, all_points=false))]
    fn read_bytes(
        py: Python<'_>,
        content: &[u8],
        name: Option<&str>,
        kind: Option<&str>,
        all_points: bool,
    ) -> PyResult<Self> {
        let kind = parse_kind(kind)?;
        let (owned, limits) = (content.to_vec(), ReadLimits::default());
        let file_name = std::path::Path::new(name.unwrap_or("content"));
        let file = run(py, content.len(), None, |p| {
            read_bytes_with(owned, name, &limits, p).map_err(|e| e.in_file(file_name))
        })?;
        let flagged = if all_points { FlaggedPoints::Included } else { FlaggedPoints::LeftOut };
        let (selection, name) =
            (Selection { flagged, ..Selection::default() }, name.unwrap_or("bytes").to_owned());
        run(py, file.n_vertices(), None, |_| Self::from_selected(file, &selection, kind, name))
    }

    /// A mesh, or a cloud without corners; the corners are those of triangles without offsets.
    #[staticmethod]
    #[pyo3(signature = (points, corners, offsets=None, kind=None))]
    fn from_arrays(
        points: PyReadonlyArray2<'_, f64>,
        corners: PyReadonlyArray1<'_, u32>,
        offsets: Option<PyReadonlyArray1<'_, u32>>,
        kind: Option<&str>,
    ) -> PyResult<Self> {
        let kind = parse_kind(kind)?;
        let points = arrays::points(&points, "points")?.to_vec();
        let corners = corners.as_slice()?;
        let faces = match offsets {
            Some(offsets) => Polygons::from_parts(offsets.as_slice()?.to_vec(), corners.to_vec())
                .ok_or_else(|| value_error("faces: offsets must ascend from 0 to the number of corners"))?,
            None if corners.len().is_multiple_of(3) => Polygons::from_triangles(corners.as_chunks().0),
            None => {
                return Err(value_error(format!(
                    "faces: the number of corners must be a multiple of 3, got {}",
                    corners.len()
                )));
            }
        };
        Ok(Self::new(ShapeFile::from_mesh(points, faces), kind, "arrays".to_owned()))
    }

    /// A graph from its edges; if it is not `undirected`, both directions are listed. With points and without weights
    /// it is a curve.
    #[staticmethod]
    #[pyo3(signature = (n_vertices, rows, columns, weights, undirected, points=None))]
    fn from_graph(
        n_vertices: usize,
        rows: PyReadonlyArray1<'_, u32>,
        columns: PyReadonlyArray1<'_, u32>,
        weights: Option<PyReadonlyArray1<'_, f64>>,
        undirected: bool,
        points: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        let (rows, columns) = (rows.as_slice()?, columns.as_slice()?);
        if rows.len() != columns.len() {
            return Err(value_error(format!(
                "edges must have as many rows as columns, got {} and {}",
                rows.len(),
                columns.len()
            )));
        }
        let weights =
            weights.map(|w| Ok::<_, PyErr>(w.as_slice()?.to_vec())).transpose()?.unwrap_or_default();
        let edges = Edges {
            pairs: rows.iter().zip(columns).map(|(&a, &b)| [a, b]).collect(),
            weights,
            direction: if undirected { Direction::Both } else { Direction::RowToColumn },
        };
        let file = match points {
            Some(points) => ShapeFile::from_curve(arrays::points(&points, "points")?.to_vec(), edges),
            None => ShapeFile::from_graph(n_vertices, edges),
        };
        Ok(Self::new(file, Some(ShapeKind::Graph), "graph".to_owned()))
    }

    #[staticmethod]
    #[pyo3(signature = (name, vertices=None, noise=None, seed=1))]
    fn sample(
        py: Python<'_>,
        name: &str,
        vertices: Option<usize>,
        noise: Option<f64>,
        seed: u64,
    ) -> PyResult<Self> {
        let sample = run(py, usize::MAX, None, |_| {
            let mut sample = Sample::from_name(name, vertices)?;
            if let Some(sigma) = noise {
                sample.add_noise(NoiseSigma::MeanEdge(sigma), seed)?;
            }
            Ok::<_, SampleError>(sample)
        })?;
        let file = ShapeFile::from_mesh(sample.points, sample.faces);
        Ok(Self::new(file, None, format!("sample:{name}")))
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.kind.name()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Content of the file that only its own format keeps, such as materials.
    #[getter]
    fn extras(&self) -> Vec<String> {
        self.file.extras().to_vec()
    }

    #[getter]
    fn format(&self) -> Option<&'static str> {
        self.file.format().map(Format::name)
    }

    #[getter]
    fn structure(&self) -> Option<&str> {
        self.file.structure()
    }

    #[getter]
    fn n_vertices(&self) -> usize {
        self.file.n_vertices()
    }

    #[getter]
    fn n_file_rows(&self) -> usize {
        self.file.n_file_rows()
    }

    /// Row of the file of each vertex.
    fn file_rows<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let rows = match self.file.file_rows() {
            Some(rows) => rows.vertex_rows().to_vec(),
            None => (0..self.file.n_vertices() as u32).collect(),
        };
        arrays::vector(py, rows).into_any()
    }

    #[getter]
    fn n_faces(&self) -> usize {
        self.file.faces().len()
    }

    /// Positions, a read-only view: n × 3, or 0 × 3 for a graph without positions.
    #[getter]
    #[allow(unsafe_code)]
    fn points<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let points = this.get().file.points().as_flattened();
        // SAFETY: the class is frozen and never replaces its points.
        Ok(unsafe { arrays::view(this.clone().into_any(), points, 3) }?.into_any())
    }

    /// Triangles, a read-only view: m × 3; `None` for other faces.
    #[getter]
    #[allow(unsafe_code)]
    fn triangles<'py>(this: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let faces = this.get().file.faces();
        let Some(triangles) = faces.triangles() else { return Ok(None) };
        // SAFETY: as for the points.
        Ok(Some(unsafe { arrays::view(this.clone().into_any(), triangles.as_flattened(), 3) }?.into_any()))
    }

    /// Offsets and corners of all faces.
    fn polygons<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, Bound<'py, PyAny>) {
        let (offsets, corners) = self.file.faces().clone().into_parts();
        (arrays::vector(py, offsets).into_any(), arrays::vector(py, corners).into_any())
    }

    /// Both ends of the listed edges, their weights, and whether each stands for both directions.
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, bool)> {
        let edges = self.file.edges();
        let pairs = arrays::matrix(py, edges.pairs.as_flattened().to_vec(), 2)?;
        let weights = arrays::vector(py, edges.weights.clone());
        Ok((pairs.into_any(), weights.into_any(), edges.direction == Direction::Both))
    }

    pub(crate) fn field_names(&self) -> Vec<String> {
        self.file.field_names().into_iter().map(str::to_owned).collect()
    }

    fn face_field_names(&self) -> Vec<String> {
        self.file.face_fields().iter().map(|f| f.name.clone()).collect()
    }

    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.file.field(name).map(|field| arrays::field(py, field)).transpose()
    }

    fn face_field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let field = self.file.face_fields().iter().find(|f| f.name == name);
        field.map(|field| arrays::field(py, field)).transpose()
    }

    /// New positions; normals and tangents follow them, or stay as they are.
    #[pyo3(signature = (points, keep_normals=false))]
    fn with_points(&self, points: PyReadonlyArray2<'_, f64>, keep_normals: bool) -> PyResult<Self> {
        let mut file = self.file.clone();
        let normals = if keep_normals { MovedNormals::Keep } else { MovedNormals::Follow };
        let points = arrays::points(&points, "points")?.to_vec();
        file.move_points(points, normals, Progress::none()).map_err(file_error)?;
        Ok(self.with_file(file))
    }

    fn with_field(&self, name: &str, values: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut file = self.file.clone();
        file.add_vertex_field(arrays::to_field(name, values)?).map_err(file_error)?;
        Ok(self.with_file(file))
    }

    /// New values of a signal, n × channels, stored in the number type that the file has for it.
    fn with_signal(&self, name: &str, values: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let n_channels = values.shape()[1];
        let values = arrays::rows(&values, "values")?.to_vec();
        let mut file = self.file.clone();
        file.add_vertex_field(written_signal(&file, name, n_channels, values)).map_err(file_error)?;
        Ok(self.with_file(file))
    }

    fn with_face_field(&self, name: &str, values: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut file = self.file.clone();
        file.add_face_field(arrays::to_field(name, values)?).map_err(file_error)?;
        Ok(self.with_file(file))
    }

    /// The part with the vertices for which `keep` is true, if it is given, and that the options choose.
    #[pyo3(signature = (options, keep=None))]
    fn select(
        &self,
        py: Python<'_>,
        options: SelectionOptions,
        keep: Option<PyReadonlyArray1<'_, bool>>,
    ) -> PyResult<Self> {
        let selection = options.to_selection()?;
        let mut file = self.file.clone();
        if let Some(keep) = keep {
            file = file.select_rows(keep.as_slice()?).map_err(file_error)?;
        }
        let (kind, name) = (Some(self.kind), self.name.clone());
        run(py, file.n_vertices(), None, |_| Self::from_selected(file, &selection, kind, name))
    }

    /// The shape treated as another kind.
    fn with_kind(&self, kind: &str) -> PyResult<Self> {
        Ok(Self::new(self.file.clone(), parse_kind(Some(kind))?, self.name.clone()))
    }

    /// Writes the shape, and returns the parts that the format cannot store.
    #[pyo3(signature = (path, format=None, progress=None))]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Vec<String>> {
        let format = parse_format(format)?;
        let write = |p: Progress<'_>| write_path_with(&self.file, &path, format, p);
        Ok(run(py, usize::MAX, progress.as_ref(), write)?.not_written)
    }

    fn to_bytes<'py>(&self, py: Python<'py>, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        let Some(format) = parse_format(Some(format))? else {
            return Err(value_error("format must be given"));
        };
        let write = |p: Progress<'_>| {
            let mut bytes = Vec::new();
            write_bytes_with(&self.file, format, &mut bytes, p).map(|_| bytes)
        };
        Ok(PyBytes::new(py, &run(py, self.file.n_vertices(), None, write)?))
    }

    /// A signal by its name, n × channels.
    #[pyo3(signature = (name, texture=None))]
    fn signal<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        texture: Option<PathBuf>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let source = SignalSource { file: &self.file, shape: self.shape(py)?, name: &self.name };
        let mut signal =
            run(py, self.file.n_vertices(), None, |_| named_signal(source, name, texture.as_deref()))?;
        // `mark_unknown` tells them from numbers, with a warning.
        signal.take_unknown_as_numbers();
        Ok(arrays::matrix(py, signal.values.to_vec(), signal.n_channels)?.into_any())
    }
}
