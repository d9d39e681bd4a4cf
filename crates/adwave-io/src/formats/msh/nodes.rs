//! Nodes of a Gmsh mesh and their tags, which elements and fields refer to.

use std::collections::HashMap;

use adwave::{Cancelled, Progress};

use crate::bytes::cursor::Cursor;
use crate::formats::msh::input::Input;
use crate::model::binary_rows::Run;
use crate::model::field::{ByteOrder, Number};
use crate::progress::{at_row, extend};
use crate::{ReadError, ReadLimits};

/// Map from tags to rows.
pub(crate) enum Tags {
    /// Consecutive tags from this one on.
    Run(u64, usize),
    /// Row of each tag up to the largest, [`NONE`] for tags that do not exist.
    Table(Vec<u32>),
    Sparse(HashMap<u64, u32>),
}

/// Stands for no row.
pub(crate) const NONE: u32 = u32::MAX;

impl Tags {
    /// Builds the map; of two rows with the same tag the first one counts.
    pub(crate) fn new(tags: &[u64], progress: Progress<'_>) -> Result<Self, Cancelled> {
        let first = tags.first().copied().unwrap_or(0);
        if tags.iter().enumerate().all(|(row, &tag)| tag == first.wrapping_add(row as u64)) {
            return Ok(Self::Run(first, tags.len()));
        }
        let largest = tags.iter().copied().max().unwrap_or(0);
        if largest / 4 <= tags.len() as u64 + 1024 {
            let mut table = vec![NONE; largest as usize + 1];
            for (row, &tag) in tags.iter().enumerate().rev() {
                at_row(progress, row as u64, tags.len() as u64)?;
                table[tag as usize] = row as u32;
            }
            return Ok(Self::Table(table));
        }
        let mut map = HashMap::with_capacity(tags.len());
        for (row, &tag) in tags.iter().enumerate() {
            at_row(progress, row as u64, tags.len() as u64)?;
            map.entry(tag).or_insert(row as u32);
        }
        Ok(Self::Sparse(map))
    }

    /// Row of a tag, or [`NONE`].
    #[inline]
    pub(crate) fn row(&self, tag: u64) -> u32 {
        match self {
            Self::Run(first, n) => {
                let row = tag.wrapping_sub(*first);
                if row < *n as u64 { row as u32 } else { NONE }
            }
            Self::Table(table) => table.get(tag as usize).copied().unwrap_or(NONE),
            Self::Sparse(map) => map.get(&tag).copied().unwrap_or(NONE),
        }
    }
}

/// Nodes in the order of the file.
#[derive(Default)]
pub(crate) struct Nodes {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) tags: Vec<u64>,
    /// Positions of the coordinates in a text.
    pub(crate) rows: Vec<u64>,
    /// Positions of the coordinates in a binary file.
    pub(crate) runs: Vec<Run>,
}

/// Reads the content of `$Nodes`.
pub(crate) fn read_nodes(
    input: &mut Input<'_>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Nodes, ReadError> {
    let mut nodes = Nodes::default();
    if input.version < 40 {
        let n = input.text_count("the number of nodes")?;
        limits.check_points(n)?;
        if input.is_binary {
            tagged_rows(&mut nodes, input, n, progress)?;
        } else {
            text_rows(&mut nodes, input, n, 0, progress)?;
        }
        return Ok(nodes);
    }
    let n_blocks = input.size("block of nodes", 0)?;
    let n_nodes = input.size("block of nodes", 0)?;
    if input.version >= 41 {
        // Smallest and largest tag.
        input.size("block of nodes", 0)?;
        input.size("block of nodes", 0)?;
    }
    limits.check_points(n_nodes)?;
    for block in 0..n_blocks {
        at_row(progress, block, n_blocks)?;
        let [a, b] = [input.int("block of nodes", block)?, input.int("block of nodes", block)?];
        // Version 4.0 has the tag of the entity before its dimension.
        let dimension = if input.version >= 41 { a } else { b };
        let is_parametric = input.int("block of nodes", block)? != 0;
        let n = input.size("block of nodes", block)?;
        limits.check_points(n.saturating_add(nodes.tags.len() as u64))?;
        let n_parameters = if is_parametric { dimension.clamp(0, 3) as usize } else { 0 };
        if input.version < 41 && input.is_binary && n_parameters == 0 {
            tagged_rows(&mut nodes, input, n, progress)?;
        } else if input.version < 41 {
            if input.is_binary {
                return Err(
                    input.wrong("nodes with parameters in binary MSH 4.0 are not supported; save as 4.1")
                );
            }
            text_rows(&mut nodes, input, n, n_parameters, progress)?;
        } else {
            tags_then_rows(&mut nodes, input, n, n_parameters, progress)?;
        }
    }
    Ok(nodes)
}

/// Reads text rows of a tag and three coordinates.
fn text_rows(
    nodes: &mut Nodes,
    input: &mut Input<'_>,
    n: u64,
    n_parameters: usize,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    input.tokens().check(n, 8, "node")?;
    for row in 0..n {
        at_row(progress, row, n)?;
        nodes.tags.push(input.size("node", row)?);
        text_row(nodes, input, row, n_parameters)?;
    }
    Ok(())
}

fn text_row(
    nodes: &mut Nodes,
    input: &mut Input<'_>,
    row: u64,
    n_parameters: usize,
) -> Result<(), ReadError> {
    let mut tokens = input.tokens();
    tokens.skip();
    nodes.rows.push(tokens.position as u64);
    let mut point = [0.0; 3];
    for x in &mut point {
        *x = tokens.number("node", row)?;
    }
    for _ in 0..n_parameters {
        tokens.number("node", row)?;
    }
    nodes.points.push(point);
    input.position = tokens.position;
    Ok(())
}

/// Reads rows of a 32-bit tag and three doubles.
fn tagged_rows(
    nodes: &mut Nodes,
    input: &mut Input<'_>,
    n: u64,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    const STRIDE: usize = 28;
    let mut cursor = input.cursor();
    let start = cursor.position;
    let rows = cursor.rows(n, STRIDE as u64, "node")?;
    input.position = cursor.position;
    let order = input.order;
    extend(&mut nodes.tags, n as usize, progress, |i| {
        u64::from(u32::from_bytes(&rows[STRIDE * i..], order))
    })?;
    extend(&mut nodes.points, n as usize, progress, |i| point(&rows[STRIDE * i + 4..], order))?;
    nodes.runs.push(Run { start: start + 4, n: n as usize, stride: STRIDE });
    Ok(())
}

fn point(row: &[u8], order: ByteOrder) -> [f64; 3] {
    [0, 8, 16].map(|at| f64::from_bytes(&row[at..], order))
}

/// Reads all tags of a block, then the coordinates, as in 4.1.
fn tags_then_rows(
    nodes: &mut Nodes,
    input: &mut Input<'_>,
    n: u64,
    n_parameters: usize,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    if !input.is_binary {
        input.tokens().check(n, 8, "node")?;
        for row in 0..n {
            at_row(progress, row, n)?;
            nodes.tags.push(input.size("node", row)?);
        }
        for row in 0..n {
            at_row(progress, row, n)?;
            text_row(nodes, input, row, n_parameters)?;
        }
        return Ok(());
    }
    let mut cursor: Cursor<'_> = input.cursor();
    let tags = cursor.rows(n, 8, "node")?;
    let start = cursor.position;
    let stride = 24 + 8 * n_parameters;
    let rows = cursor.rows(n, stride as u64, "node")?;
    input.position = cursor.position;
    let order = input.order;
    extend(&mut nodes.tags, n as usize, progress, |i| u64::from_bytes(&tags[8 * i..], order))?;
    extend(&mut nodes.points, n as usize, progress, |i| point(&rows[stride * i..], order))?;
    nodes.runs.push(Run { start, n: n as usize, stride });
    Ok(())
}
