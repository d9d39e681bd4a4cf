//! Meshes: their files, the faces of each tile, neighbors by faces, and results in the order of the file.
//!
//! Vertices at one position are one vertex, as for every mesh in memory. Faces are told the places of their corners along the curve and
//! dealt out to the tiles that these lie in (`faces`); a tile then has all faces of its vertices, in the order of the file, so that
//! its neighbors and areas are those of the whole (`neighbors`). Results go back to the order of the file by its numbers (`join`).

mod faces;
mod join;
mod neighbors;
mod part_faces;
#[cfg(test)]
mod tests;

pub(crate) use faces::{deal, places_at_a_time};
pub(crate) use join::join;
pub(crate) use neighbors::neighbors_of_tile;
pub(crate) use part_faces::FaceFiles;

use std::path::{Path, PathBuf};

use adwave::shape::{PointCloud, ShapeError, bounding_box};
use adwave_io::MeshReader;

use crate::TilesError;
use crate::blocks::Blocks;
use crate::layout::{Layout, Lengths, push_vertex, vertex_number};
use crate::outputs::Outputs;
use crate::plan::{Input, Params, Plan};
use crate::work::MOST_POINTS;

/// Whether a file is a mesh by its name: a PLY or OBJ.
pub fn is_mesh(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply") || e.eq_ignore_ascii_case("obj"))
}

/// The work on a mesh, not yet cut into tiles.
pub(crate) fn planned(inputs: &[PathBuf], params: &Params) -> Result<Plan, TilesError> {
    let [path] = inputs else {
        return Err(TilesError::Input("a mesh is worked on alone; give one PLY or OBJ".into()));
    };
    let mut reader = MeshReader::open(path)?;
    let named = |what: &str| TilesError::Input(format!("{}: {what}", path.display()));
    if !reader.holds_fields() && params.field_bytes() > 0 {
        return Err(named(
            "an OBJ holds no fields; ask for none (magnitudes, vectors, saliency), or give a PLY",
        ));
    }
    let bytes = std::fs::metadata(path).map_err(TilesError::io(path))?.len();
    let mut bounds = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (mut n_points, mut points) = (0, Vec::new());
    while reader.vertices(&mut points)? {
        if points.is_empty() {
            continue;
        }
        let n = points.len();
        let checked = PointCloud::new(std::mem::take(&mut points));
        let checked = checked.map_err(|e| named(&later(e, n_points as usize).to_string()))?;
        if let Some((lo, hi)) = bounding_box(checked.points()) {
            for c in 0..3 {
                bounds.0[c] = bounds.0[c].min(lo[c]);
                bounds.1[c] = bounds.1[c].max(hi[c]);
            }
        }
        n_points += n as u64;
        if n_points > MOST_POINTS {
            return Err(named(&ShapeError::TooManyVertices(n_points as usize).to_string()));
        }
    }
    if n_points == 0 {
        return Err(named("it has no vertices; give another"));
    }
    if reader.n_faces() == 0 {
        return Err(named("it has no faces; give a mesh, or a cloud as LAS or LAZ"));
    }
    let input = Input {
        path: std::path::absolute(path).map_err(TilesError::io(path))?,
        bytes,
        n_points,
        shift: [0; 3],
    };
    Ok(Plan {
        inputs: vec![input],
        layout: Layout::Mesh(Lengths::of(bounds)),
        bounds,
        params: params.clone(),
        blocks_per_tile: 0,
        n_points,
        n_faces: reader.n_faces(),
    })
}

/// What is wrong with a vertex, of which `before` others come before those that it was counted among.
fn later(error: ShapeError, before: usize) -> ShapeError {
    match error {
        ShapeError::NotFinite { vertex, x, y, z } => {
            ShapeError::NotFinite { vertex: vertex + before, x, y, z }
        }
        ShapeError::TooFar { vertex, value } => ShapeError::TooFar { vertex: vertex + before, value },
        other => other,
    }
}

/// Opens the mesh and asks whether it is still the same.
fn open(input: &Input) -> Result<MeshReader, TilesError> {
    let reader = MeshReader::open(&input.path)?;
    let bytes = std::fs::metadata(&input.path).map_err(TilesError::io(&input.path))?.len();
    if bytes != input.bytes {
        return Err(TilesError::Input(format!(
            "{} has changed since the work began; delete the folder and begin anew",
            input.path.display()
        )));
    }
    Ok(reader)
}

/// The records of all vertices, in the order of the file.
pub(crate) fn records(
    inputs: &[Input],
) -> Result<impl FnMut(usize, &mut Vec<u8>) -> Result<usize, TilesError>, TilesError> {
    let mut reader = open(&inputs[0])?;
    let (mut points, mut next, mut number) = (Vec::new(), 0, 0_u32);
    Ok(move |most: usize, held: &mut Vec<u8>| {
        while next == points.len() {
            points.clear();
            next = 0;
            if !reader.vertices(&mut points)? {
                return Ok(0);
            }
        }
        let n = most.min(points.len() - next);
        for point in &points[next..next + n] {
            push_vertex(held, *point, number);
            number = number.saturating_add(1);
        }
        next += n;
        Ok(n)
    })
}

/// Bytes of what comes out for a vertex: its number, its coordinates where any are to change, its fields.
pub(crate) fn result_bytes(params: &Params) -> usize {
    4 + if params.moves() { 24 } else { 0 } + params.field_bytes()
}

/// What comes out for the vertices of a block. A coordinate that stays as it is is NaN.
pub(crate) fn results_of_block(
    plan: &Plan,
    blocks: &Blocks,
    records: &[u8],
    points: &[[f64; 3]],
    outs: &Outputs<'_>,
) -> Vec<u8> {
    let unit = plan.layout.unit();
    let n = records.len() / Lengths::RECORD_BYTES;
    let mut made = Vec::with_capacity(n * result_bytes(&plan.params));
    for (vertex, same) in blocks.of_one_vertex(records).enumerate() {
        let moved = outs.change.map(|changes| {
            let (point, change) = (points[vertex], changes[vertex]);
            let coordinate =
                |c: usize| if change[c] == 0.0 { f64::NAN } else { (point[c] + change[c]) * unit };
            [0, 1, 2].map(coordinate)
        });
        for record in same.chunks_exact(Lengths::RECORD_BYTES) {
            made.extend(vertex_number(record).to_le_bytes());
            made.extend(moved.iter().flatten().flat_map(|c| c.to_le_bytes()));
            outs.push_fields(vertex, &mut made);
        }
    }
    made
}
