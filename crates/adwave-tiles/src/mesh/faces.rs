//! The faces of each tile.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave::shape::Polygons;

use super::open;
use crate::TilesError;
use crate::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::buckets::Buckets;
use crate::files::write_whole;
use crate::layout::{Lengths, vertex_number};
use crate::plan::Plan;

/// Of how many vertices the places may be in memory, by a part of what a work may use.
pub(crate) fn places_at_a_time(plan: &Plan) -> usize {
    (plan.params.memory as usize / 2 / size_of::<u32>()).max(1 << 16)
}

/// A corner whose place is not known yet.
const UNKNOWN: u32 = u32::MAX;

/// Deals the faces out to the files `tiles`: to each those with a corner in that tile, in the order of the mesh, as the number of
/// their corners and the places of these. `mark` is written last. With the places of `most` vertices in memory the faces are read
/// as often as that asks for, which has no bearing on the result.
pub(crate) fn deal(
    plan: &Plan,
    blocks: &Blocks,
    (tiles, mark): (Vec<PathBuf>, &Path),
    most: usize,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let folder = mark.parent().unwrap_or_else(|| Path::new("."));
    let n = plan.n_points as usize;
    let part = |pass: usize| pass * most..((pass + 1) * most).min(n);
    let n_passes = n.div_ceil(most);
    let mut known: Option<Corners> = None;
    for pass in 1..n_passes {
        let path = folder.join(format!("corners-{pass:04}.bin"));
        let file = File::create(&path).map_err(TilesError::io(&path))?;
        let mut out = BufWriter::with_capacity(AT_ONCE, file);
        each_face(plan, blocks, part(pass - 1), known.take(), progress, |face| {
            let bytes = face.iter().map(|place| place.to_le_bytes());
            bytes.into_iter().try_for_each(|place| out.write_all(&place)).map_err(TilesError::io(&path))
        })?;
        out.flush().map_err(TilesError::io(&path))?;
        known = Some(Corners::open(path)?);
    }
    let mut dealt = Dealt {
        buckets: Buckets::new(tiles, plan.params.memory as usize / 8)?,
        vertices_per_tile: plan.blocks_per_tile * VERTICES_IN_A_BLOCK,
        tiles: Vec::new(),
        bytes: Vec::new(),
    };
    each_face(plan, blocks, part(n_passes - 1), known, progress, |face| dealt.add(face))?;
    let n_bytes = dealt.buckets.finish()?;
    let json = serde_json::to_vec(&n_bytes).map_err(std::io::Error::from).map_err(TilesError::io(mark))?;
    write_whole(mark, |out| out.write_all(&json).map_err(TilesError::io(mark)))
}

/// Bytes that are read or written at once.
const AT_ONCE: usize = 1 << 20;

/// The places of the corners of all faces, as far as they are known, in a file that is deleted when it is done with.
struct Corners {
    file: BufReader<File>,
    path: PathBuf,
}

impl Corners {
    fn open(path: PathBuf) -> Result<Self, TilesError> {
        let file = File::open(&path).map_err(TilesError::io(&path))?;
        Ok(Self { file: BufReader::with_capacity(AT_ONCE, file), path })
    }

    fn next(&mut self) -> Result<u32, TilesError> {
        let mut bytes = [0; 4];
        self.file.read_exact(&mut bytes).map_err(TilesError::io(&self.path))?;
        Ok(u32::from_le_bytes(bytes))
    }
}

impl Drop for Corners {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// The places of some vertices, by their numbers in the mesh.
fn places(blocks: &Blocks, numbers: Range<usize>, progress: Progress<'_>) -> Result<Vec<u32>, TilesError> {
    let mut places = vec![UNKNOWN; numbers.len()];
    for block in 0..blocks.len() {
        progress.check()?;
        let records = blocks.records(block)?;
        for (place, same) in blocks.vertices(block).zip(blocks.of_one_vertex(&records)) {
            for record in same.chunks_exact(Lengths::RECORD_BYTES) {
                let i = (vertex_number(record) as usize).checked_sub(numbers.start);
                if let Some(slot) = i.and_then(|i| places.get_mut(i)) {
                    *slot = place as u32;
                }
            }
        }
    }
    Ok(places)
}

/// Calls `each` with the places of the corners of every face, as far as they are `known` or those of the vertices `numbers`.
fn each_face(
    plan: &Plan,
    blocks: &Blocks,
    numbers: Range<usize>,
    mut known: Option<Corners>,
    progress: Progress<'_>,
    mut each: impl FnMut(&[u32]) -> Result<(), TilesError>,
) -> Result<(), TilesError> {
    let first = numbers.start;
    let places = places(blocks, numbers, progress)?;
    let mut reader = open(&plan.inputs[0])?;
    let mut face_places = Vec::new();
    loop {
        progress.check()?;
        let mut faces = Polygons::new();
        if !reader.faces(plan.n_points, &mut faces)? {
            return Ok(());
        }
        for face in faces.iter() {
            face_places.clear();
            for &corner in face {
                let before = known.as_mut().map_or(Ok(UNKNOWN), Corners::next)?;
                let here = (corner as usize).checked_sub(first).and_then(|i| places.get(i));
                face_places.push(here.copied().unwrap_or(before));
            }
            each(&face_places)?;
        }
    }
}

/// Faces on their way to the tiles.
struct Dealt {
    buckets: Buckets,
    vertices_per_tile: usize,
    /// Those of a face.
    tiles: Vec<usize>,
    bytes: Vec<u8>,
}

impl Dealt {
    fn add(&mut self, face: &[u32]) -> Result<(), TilesError> {
        // Such a face has no triangles.
        if face.len() < 3 {
            return Ok(());
        }
        self.bytes.clear();
        self.bytes.extend((face.len() as u32).to_le_bytes());
        self.bytes.extend(face.iter().flat_map(|place| place.to_le_bytes()));
        self.tiles.clear();
        self.tiles.extend(face.iter().map(|&place| place as usize / self.vertices_per_tile));
        self.tiles.sort_unstable();
        self.tiles.dedup();
        self.tiles.iter().try_for_each(|&tile| self.buckets.push(tile, &self.bytes))
    }
}
