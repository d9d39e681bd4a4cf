//! Meshes: PLY and OBJ files in, result rows out.
//!
//! Vertices at one position are one vertex, as for every mesh in memory. A result row has the index of the vertex in
//! the file, so that the rows of all tiles can be put back into the order of the file.

use std::path::{Path, PathBuf};

use adwave::shape::{PointCloud, ShapeError, bounding_box, may_be_placeholder};
use adwave_io::MeshReader;

use super::input_shape::{InputFile, InputShape, input_error};
use super::record_marker::RecordMarker;
use super::vertex_values::VertexValues;
use crate::bounds::BoundingBox;
use crate::error::TilesError;
use crate::index::blocks::Blocks;
use crate::layout::{MAX_POINTS, MeshUnits, RecordLayout, index_in_file, push_vertex_record};
use crate::params::Params;

/// Returns true if the file is a mesh by its extension: PLY or OBJ.
pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply") || e.eq_ignore_ascii_case("obj"))
}

/// Reads the vertices of a mesh once, to check and count them.
pub(crate) fn read_header(paths: &[PathBuf], params: &Params) -> Result<InputShape, TilesError> {
    let [path] = paths else {
        return Err(TilesError::Input(format!(
            "a mesh must be the only input, got {} files; give one PLY or OBJ",
            paths.len()
        )));
    };
    let mut reader = MeshReader::open(path)?;
    let error = |message: &str| input_error(path, message);
    if !reader.holds_fields() && params.field_bytes() > 0 {
        return Err(error(
            "an OBJ cannot store fields; request none (magnitudes, vectors, saliency), or give a PLY",
        ));
    }
    let bytes = std::fs::metadata(path).map_err(TilesError::io(path))?.len();
    let (mut bounds, mut known_bounds, mut n_known) = (BoundingBox::EMPTY, BoundingBox::EMPTY, 0);
    let (mut n_points, mut points) = (0, Vec::new());
    while reader.vertices(&mut points)? {
        if points.is_empty() {
            continue;
        }
        let n = points.len();
        let cloud = PointCloud::new(std::mem::take(&mut points));
        let cloud = cloud.map_err(|e| error(&offset_vertex(e, n_points as usize).to_string()))?;
        let known = cloud.points().iter().filter(|p| !may_be_placeholder(p)).copied().collect::<Vec<_>>();
        n_known += known.len() as u64;
        for (bounds, points) in [(&mut bounds, cloud.points()), (&mut known_bounds, &known[..])] {
            if let Some((min, max)) = bounding_box(points) {
                bounds.include(&BoundingBox { min, max });
            }
        }
        n_points += n as u64;
        if n_points > MAX_POINTS {
            return Err(error(&ShapeError::TooManyVertices(n_points as usize).to_string()));
        }
    }
    if n_points == 0 {
        return Err(error("it has no vertices"));
    }
    if reader.n_faces() == 0 {
        return Err(error("it has no faces; give a mesh, or a cloud as LAS or LAZ"));
    }
    // Placeholders would make everything else a single cell of the curve.
    if 2 * n_known >= n_points {
        bounds = known_bounds;
    }
    let path = std::path::absolute(path).map_err(TilesError::io(path))?;
    Ok(InputShape {
        files: vec![InputFile { path, bytes, n_points, shift: [0; 3] }],
        layout: RecordLayout::Mesh(MeshUnits::from_bounds(&bounds)),
        bounds,
        n_points,
        n_faces: reader.n_faces(),
    })
}

/// Adds `n_before` to the vertex that an error names.
fn offset_vertex(error: ShapeError, n_before: usize) -> ShapeError {
    match error {
        ShapeError::NotFinite { vertex, x, y, z } => {
            ShapeError::NotFinite { vertex: vertex + n_before, x, y, z }
        }
        ShapeError::TooFar { vertex, value } => ShapeError::TooFar { vertex: vertex + n_before, value },
        other => other,
    }
}

/// Opens a mesh and checks that it has not changed since the job was planned.
pub(crate) fn open_unchanged(file: &InputFile) -> Result<MeshReader, TilesError> {
    let reader = MeshReader::open(&file.path)?;
    let bytes = std::fs::metadata(&file.path).map_err(TilesError::io(&file.path))?.len();
    if bytes != file.bytes {
        return Err(file.changed());
    }
    Ok(reader)
}

/// Returns a function that appends the records of up to n of the next vertices, in the order of the file, and returns
/// their number, 0 at the end.
pub(crate) fn record_reader(
    file: &InputFile,
    marker: RecordMarker,
) -> Result<impl FnMut(usize, &mut Vec<u8>) -> Result<usize, TilesError>, TilesError> {
    let mut reader = open_unchanged(file)?;
    let (mut points, mut next, mut index_in_file) = (Vec::new(), 0, 0_u32);
    let (mut values, n_columns) = (Vec::new(), marker.columns.len());
    Ok(move |max_records: usize, records: &mut Vec<u8>| {
        while next == points.len() {
            points.clear();
            next = 0;
            values.clear();
            if !reader.vertices_with(&mut points, &marker.columns, &mut values)? {
                return Ok(0);
            }
        }
        let n = max_records.min(points.len() - next);
        for (i, point) in (next..).zip(&points[next..next + n]) {
            let start = records.len();
            push_vertex_record(records, *point, index_in_file);
            let values = values.get(i * n_columns..(i + 1) * n_columns).unwrap_or(&[]);
            let marks = marker.mark_vertex(index_in_file, &records[start..], values);
            if let Some(last) = records.last_mut() {
                *last = marks;
            }
            index_in_file = index_in_file.saturating_add(1);
        }
        next += n;
        Ok(n)
    })
}

/// Bytes of a result row: the index of the vertex in the file, its coordinates if the job changes positions, its
/// fields.
pub(crate) fn result_row_bytes(params: &Params) -> usize {
    4 + if params.changes_positions() { 24 } else { 0 } + params.field_bytes()
}

/// Result rows of a block, without the saliency. A coordinate that does not change is NaN.
pub(crate) fn result_rows(
    params: &Params,
    blocks: &Blocks,
    records: &[u8],
    points: &[[f64; 3]],
    values: &VertexValues<'_>,
    unit: f64,
) -> Vec<u8> {
    let n = records.len() / MeshUnits::RECORD_BYTES;
    let mut rows = Vec::with_capacity(n * result_row_bytes(params));
    for (vertex, record) in blocks.with_vertices(records) {
        let position = values.change.map(|changes| {
            let Some(vertex) = vertex else { return [f64::NAN; 3] };
            let (point, change) = (points[vertex], changes[vertex]);
            let coordinate =
                |c: usize| if change[c] == 0.0 { f64::NAN } else { (point[c] + change[c]) * unit };
            [0, 1, 2].map(coordinate)
        });
        rows.extend(index_in_file(record).to_le_bytes());
        rows.extend(position.iter().flatten().flat_map(|c| c.to_le_bytes()));
        match vertex {
            Some(vertex) => values.push_fields(vertex, &mut rows),
            None => values.push_outsider_fields(blocks.outsider_value(record), &mut rows),
        }
    }
    rows
}
