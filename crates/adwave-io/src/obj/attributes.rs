//! The colours, normals and texture coordinates of an OBJ as fields of its vertices, where each vertex has one.

use crate::obj::read::{NONE, Piece};
use crate::{Field, FieldValues, ShapeFile};

/// For each corner of each face the index of its texture coordinate and normal, or [`NONE`]; empty when none has.
pub(crate) struct CornerIndices {
    texcoords: Vec<u32>,
    normals: Vec<u32>,
}

impl CornerIndices {
    /// Joins the lists of the pieces. An index of nothing becomes [`NONE`]: files name normals that they do not have,
    /// and their faces are sound all the same.
    pub(crate) fn join(pieces: &mut [Piece], n_corners: usize) -> Self {
        let n_texcoords = pieces.iter().map(|p| p.texcoords.len()).sum();
        let n_normals = pieces.iter().map(|p| p.normals.len()).sum();
        let mut texcoords = join_list(pieces, n_corners, |p| &mut p.corner_texcoords);
        let mut normals = join_list(pieces, n_corners, |p| &mut p.corner_normals);
        for (list, n) in [(&mut texcoords, n_texcoords), (&mut normals, n_normals)] {
            for index in list.iter_mut().filter(|i| **i as usize >= n) {
                *index = NONE;
            }
        }
        Self { texcoords, normals }
    }
}

fn join_list(pieces: &mut [Piece], n_corners: usize, list: fn(&mut Piece) -> &mut Vec<u32>) -> Vec<u32> {
    if pieces.iter_mut().all(|p| list(p).is_empty()) {
        return Vec::new();
    }
    let mut all = Vec::with_capacity(n_corners);
    for piece in pieces {
        let n = piece.corners.len();
        let mut own = std::mem::take(list(piece));
        own.resize(n, NONE);
        all.append(&mut own);
    }
    all
}

/// Adds the fields, and names what has several values at one vertex.
pub(crate) fn attach(shape: &mut ShapeFile, pieces: &mut [Piece], indices: &CornerIndices) {
    tails(shape, pieces);
    let texcoords: Vec<[f64; 3]> = pieces.iter_mut().flat_map(|p| std::mem::take(&mut p.texcoords)).collect();
    let n_channels = pieces.iter().map(|p| p.n_texcoord_channels).max().unwrap_or(0).max(2);
    corner_field(shape, "texcoord", n_channels, &texcoords, &indices.texcoords, "texture coordinates");
    let normals: Vec<[f64; 3]> = pieces.iter_mut().flat_map(|p| std::mem::take(&mut p.normals)).collect();
    corner_field(shape, "normal", 3, &normals, &indices.normals, "normals");
}

/// What stands after z: a weight, or a colour.
fn tails(shape: &mut ShapeFile, pieces: &mut [Piece]) {
    let n_channels = pieces.iter().map(|p| p.tail_len).max().unwrap_or(0);
    let name = match n_channels {
        0 => return,
        1 => "w",
        2 => "extra",
        _ => "color",
    };
    let mut values = Vec::with_capacity(shape.n_vertices * n_channels);
    let mut seen = 0;
    for piece in pieces {
        // A piece without tails still counts its vertices.
        let n = piece.n_points;
        if piece.tails.is_empty() {
            values.resize(values.len() + n * n_channels, f64::NAN);
        } else {
            values.extend(piece.tails.iter().flat_map(|t| &t[..n_channels]));
        }
        seen += n;
        piece.tails = Vec::new();
    }
    debug_assert_eq!(seen, shape.n_vertices);
    shape.vertex_fields.push(Field::new(name, n_channels, FieldValues::F64(values)));
}

/// A field from values at corners, if all corners of each vertex have the same value.
fn corner_field(
    shape: &mut ShapeFile,
    name: &str,
    n_channels: usize,
    list: &[[f64; 3]],
    corner_indices: &[u32],
    what: &str,
) {
    if list.is_empty() {
        return;
    }
    match one_a_vertex(shape, list, corner_indices) {
        None => shape.extras.push(format!("{what} of face corners")),
        Some(of_vertex) => {
            let mut values = Vec::with_capacity(of_vertex.len() * n_channels);
            for index in of_vertex {
                let value = list.get(index as usize).copied().unwrap_or([f64::NAN; 3]);
                values.extend_from_slice(&value[..n_channels]);
            }
            shape.vertex_fields.push(Field::new(name, n_channels, FieldValues::F64(values)));
        }
    }
}

/// For each vertex the index of its only value; `None` when a vertex has several, or a corner has none.
fn one_a_vertex(shape: &ShapeFile, list: &[[f64; 3]], corner_indices: &[u32]) -> Option<Vec<u32>> {
    let n = shape.n_vertices;
    if corner_indices.is_empty() {
        // No face names them; a list as long as the vertices belongs to them in order, as scanners write clouds.
        return (list.len() == n).then(|| (0..n as u32).collect());
    }
    let mut of_vertex = vec![NONE; n];
    for (&vertex, &index) in shape.faces.corners().iter().zip(corner_indices) {
        if index == NONE {
            return None;
        }
        let known = &mut of_vertex[vertex as usize];
        if *known == NONE {
            *known = index;
        } else if *known != index && !same(list[*known as usize], list[index as usize]) {
            return None;
        }
    }
    // Vertices of no face: where all others have the value of their own number, so have they.
    if list.len() == n && of_vertex.iter().enumerate().all(|(v, &i)| i == NONE || i as usize == v) {
        return Some((0..n as u32).collect());
    }
    Some(of_vertex)
}

fn same(a: [f64; 3], b: [f64; 3]) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}
