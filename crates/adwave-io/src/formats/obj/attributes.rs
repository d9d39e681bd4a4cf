//! Colors, normals and texture coordinates of an OBJ as vertex fields, if each vertex has a single value.

use adwave::{Cancelled, Progress};

use crate::formats::obj::read::{Chunk, NONE};
use crate::model::source_document::CORNER_TEXCOORDS;
use crate::progress::report_row;
use crate::{Field, FieldValues, ShapeFile};

/// Index of the texture coordinate and of the normal for each corner of each face, or [`NONE`]; empty if no corner
/// has one.
pub(crate) struct CornerIndices {
    texcoords: Vec<u32>,
    normals: Vec<u32>,
}

impl CornerIndices {
    /// Joins the lists of the chunks. An index out of range becomes [`NONE`], because some files name normals that do
    /// not exist but have valid faces.
    pub(crate) fn join(
        chunks: &mut [Chunk],
        n_corners: usize,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let n_texcoords = chunks.iter().map(|p| p.texcoords.len()).sum();
        let n_normals = chunks.iter().map(|p| p.normals.len()).sum();
        let mut texcoords = join_list(chunks, n_corners, progress, |p| &mut p.corner_texcoords)?;
        let mut normals = join_list(chunks, n_corners, progress, |p| &mut p.corner_normals)?;
        for (list, n) in [(&mut texcoords, n_texcoords), (&mut normals, n_normals)] {
            for (k, index) in list.iter_mut().enumerate() {
                report_row(progress, k as u64, n_corners as u64)?;
                if *index as usize >= n {
                    *index = NONE;
                }
            }
        }
        Ok(Self { texcoords, normals })
    }
}

fn join_list(
    chunks: &mut [Chunk],
    n_corners: usize,
    progress: Progress<'_>,
    list: fn(&mut Chunk) -> &mut Vec<u32>,
) -> Result<Vec<u32>, Cancelled> {
    if chunks.iter_mut().all(|p| list(p).is_empty()) {
        return Ok(Vec::new());
    }
    let mut all = Vec::with_capacity(n_corners);
    for chunk in chunks {
        progress.check()?;
        let n = chunk.corners.len();
        let mut own = std::mem::take(list(chunk));
        own.resize(n, NONE);
        all.append(&mut own);
    }
    Ok(all)
}

/// Adds the fields, and reports attributes with several values at one vertex.
pub(crate) fn attach(
    shape: &mut ShapeFile,
    chunks: &mut [Chunk],
    indices: &CornerIndices,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    tails(shape, chunks, progress)?;
    let texcoords = join_values(chunks, progress, |p| &mut p.texcoords)?;
    let n_channels = chunks.iter().map(|p| p.n_texcoord_channels).max().unwrap_or(0).max(2);
    let name = "texcoord";
    let list = CornerValues { list: &texcoords, indices: &indices.texcoords, name, n_channels };
    if !corner_field(shape, &list, progress)? {
        shape.extras.push(CORNER_TEXCOORDS.into());
    }
    let normals = join_values(chunks, progress, |p| &mut p.normals)?;
    let list = CornerValues { list: &normals, indices: &indices.normals, name: "normal", n_channels: 3 };
    if !corner_field(shape, &list, progress)? {
        shape.extras.push("normals of face corners".into());
    }
    Ok(())
}

fn join_values(
    chunks: &mut [Chunk],
    progress: Progress<'_>,
    list: fn(&mut Chunk) -> &mut Vec<[f64; 3]>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let mut all = Vec::with_capacity(chunks.iter_mut().map(|chunk| list(chunk).len()).sum());
    for chunk in chunks {
        progress.check()?;
        all.append(&mut std::mem::take(list(chunk)));
    }
    Ok(all)
}

/// Content after z: a weight, or a color.
fn tails(shape: &mut ShapeFile, chunks: &mut [Chunk], progress: Progress<'_>) -> Result<(), Cancelled> {
    let n_channels = chunks.iter().map(|p| p.tail_len).max().unwrap_or(0);
    let name = match n_channels {
        0 => return Ok(()),
        1 => "w",
        2 => "extra",
        _ => "color",
    };
    let mut values = Vec::with_capacity(shape.n_vertices * n_channels);
    let mut seen = 0;
    for chunk in chunks {
        progress.check()?;
        // A chunk without such columns still counts its vertices.
        let n = chunk.n_points;
        if chunk.tails.is_empty() {
            values.resize(values.len() + n * n_channels, f64::NAN);
        } else {
            values.extend(chunk.tails.iter().flat_map(|t| &t[..n_channels]));
        }
        seen += n;
        chunk.tails = Vec::new();
    }
    debug_assert_eq!(seen, shape.n_vertices);
    shape.vertex_fields.push(Field::new(name, n_channels, FieldValues::F64(values)));
    Ok(())
}

/// Values that the corners of faces name by index.
struct CornerValues<'a> {
    list: &'a [[f64; 3]],
    indices: &'a [u32],
    name: &'a str,
    n_channels: usize,
}

/// Adds a field from values at corners; `false` if a vertex has several values.
fn corner_field(
    shape: &mut ShapeFile,
    values: &CornerValues<'_>,
    progress: Progress<'_>,
) -> Result<bool, Cancelled> {
    let CornerValues { list, indices, name, n_channels } = *values;
    if list.is_empty() {
        return Ok(true);
    }
    let Some(of_vertex) = one_per_vertex(shape, list, indices, progress)? else { return Ok(false) };
    let mut values = Vec::with_capacity(of_vertex.len() * n_channels);
    let n = of_vertex.len() as u64;
    for (i, index) in of_vertex.into_iter().enumerate() {
        report_row(progress, i as u64, n)?;
        let value = list.get(index as usize).copied().unwrap_or([f64::NAN; 3]);
        values.extend_from_slice(&value[..n_channels]);
    }
    shape.vertex_fields.push(Field::new(name, n_channels, FieldValues::F64(values)));
    Ok(true)
}

/// Index of the single value of each vertex; `None` if a vertex has several values, or a corner has none.
fn one_per_vertex(
    shape: &ShapeFile,
    list: &[[f64; 3]],
    corner_indices: &[u32],
    progress: Progress<'_>,
) -> Result<Option<Vec<u32>>, Cancelled> {
    let n = shape.n_vertices;
    if corner_indices.is_empty() {
        // No face refers to them; a list as long as the vertices belongs to them in order, as in clouds written by
        // scanners.
        return Ok((list.len() == n).then(|| (0..n as u32).collect()));
    }
    let mut of_vertex = vec![NONE; n];
    for (k, (&vertex, &index)) in shape.faces.corners().iter().zip(corner_indices).enumerate() {
        report_row(progress, k as u64, corner_indices.len() as u64)?;
        if index == NONE {
            return Ok(None);
        }
        let known = &mut of_vertex[vertex as usize];
        if *known == NONE {
            *known = index;
        } else if *known != index && !same(list[*known as usize], list[index as usize]) {
            return Ok(None);
        }
    }
    // Vertices without a face: if all others have the value of their own index, so do these.
    if list.len() == n && of_vertex.iter().enumerate().all(|(v, &i)| i == NONE || i as usize == v) {
        return Ok(Some((0..n as u32).collect()));
    }
    Ok(Some(of_vertex))
}

fn same(a: [f64; 3], b: [f64; 3]) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}
