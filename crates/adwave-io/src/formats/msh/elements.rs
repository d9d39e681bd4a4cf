//! Elements of a Gmsh mesh.

use std::collections::HashMap;

use adwave::Progress;

use crate::ReadError;
use crate::formats::msh::input::MshInput;
use crate::formats::msh::kinds::ElementKind;
use crate::formats::msh::nodes::{NONE, NodeTags};
use crate::model::field::{ByteOrder, Number};
use crate::model::volume::Cells;
use crate::progress::{extend, report_row};

/// Elements of one dimension: corners as rows of nodes, and their tags.
#[derive(Default)]
pub(crate) struct ElementList {
    /// Number of corners of each element.
    pub(crate) sizes: Vec<u8>,
    pub(crate) corners: Vec<u32>,
    pub(crate) tags: Vec<u64>,
    pub(crate) physical: Vec<i32>,
    pub(crate) elementary: Vec<i32>,
}

/// All elements except points.
#[derive(Default)]
pub(crate) struct Elements {
    pub(crate) lines: ElementList,
    pub(crate) faces: ElementList,
    pub(crate) volumes: ElementList,
    pub(crate) cells: Cells,
    pub(crate) n_points: u64,
    /// True if an element has nodes between its corners.
    pub(crate) is_curved: bool,
}

/// First physical group of each entity, by dimension and tag.
pub(crate) type PhysicalGroups = HashMap<(i64, i64), i32>;

/// Consecutive elements of one kind.
struct ElementBlock {
    kind: ElementKind,
    n_nodes: usize,
    n: u64,
    physical: i32,
    elementary: i32,
}

impl Elements {
    fn part(&mut self, kind: ElementKind) -> Option<&mut ElementList> {
        match kind {
            ElementKind::Point => None,
            ElementKind::Line => Some(&mut self.lines),
            ElementKind::Face(_) => Some(&mut self.faces),
            ElementKind::Cell(_) => Some(&mut self.volumes),
        }
    }

    /// Records the properties common to all elements of a block.
    fn begin(&mut self, kind: ElementKind, n_nodes: usize, n: u64) {
        self.is_curved |= n_nodes > kind.n_corners();
        match kind {
            ElementKind::Point => self.n_points += n,
            ElementKind::Cell(cell) => self.cells.kinds.extend(std::iter::repeat_n(cell, n as usize)),
            _ => {}
        }
    }
}

/// Reads the content of `$Elements`.
pub(crate) fn read_elements(
    input: &mut MshInput<'_>,
    nodes: &NodeTags,
    groups: &PhysicalGroups,
    progress: Progress<'_>,
) -> Result<Elements, ReadError> {
    let mut elements = Elements::default();
    if input.version < 40 {
        let n = input.text_count("the number of elements")?;
        if input.is_binary {
            binary_2(&mut elements, input, nodes, n, progress)?;
        } else {
            input.tokens().check(n, 8, "element")?;
            for row in 0..n {
                report_row(progress, row, n)?;
                text_2(&mut elements, input, nodes, row)?;
            }
        }
    } else {
        let n_blocks = input.size("block of elements", 0)?;
        input.size("block of elements", 0)?;
        if input.version >= 41 {
            input.size("block of elements", 0)?;
            input.size("block of elements", 0)?;
        }
        for block in 0..n_blocks {
            report_row(progress, block, n_blocks)?;
            let mut next = || input.int("block of elements", block);
            let [a, b, number] = [next()?, next()?, next()?];
            let n = input.size("block of elements", block)?;
            // Version 4.0 has the tag of the entity before its dimension.
            let entity = if input.version >= 41 { (a, b) } else { (b, a) };
            let (kind, n_nodes) = input.kind(number)?;
            let physical = groups.get(&entity).copied().unwrap_or(0);
            let block = ElementBlock { kind, n_nodes, n, physical, elementary: entity.1 as i32 };
            read_block(&mut elements, input, nodes, &block, progress)?;
        }
    }
    elements.cells.corners = std::mem::take(&mut elements.volumes.corners);
    let n_corners = elements.faces.corners.len().max(elements.cells.corners.len());
    if n_corners >= NONE as usize || elements.cells.kinds.len() >= NONE as usize {
        let limit = NONE.into();
        return Err(ReadError::Limit { what: "corners of elements", found: n_corners as u64, limit });
    }
    Ok(elements)
}

/// Reads one text element of version 2: tag, kind, number of tags, tags, nodes.
fn text_2(
    elements: &mut Elements,
    input: &mut MshInput<'_>,
    nodes: &NodeTags,
    row: u64,
) -> Result<(), ReadError> {
    let tag = input.size("element", row)?;
    let number = input.int("element", row)?;
    let (kind, n_nodes) = input.kind(number)?;
    let n_tags = input.size("element", row)?;
    let mut tags = [0; 2];
    for k in 0..n_tags {
        let value = input.int("element", row)?;
        if let Some(slot) = tags.get_mut(k as usize) {
            *slot = value as i32;
        }
    }
    elements.begin(kind, n_nodes, 1);
    push(elements, input, nodes, &Element { kind, n_nodes, tag }, row)?;
    if let Some(part) = elements.part(kind) {
        part.physical.push(tags[0]);
        part.elementary.push(tags[1]);
    }
    Ok(())
}

/// An element of a text before its nodes.
struct Element {
    kind: ElementKind,
    n_nodes: usize,
    tag: u64,
}

/// Reads the nodes of one text element.
fn push(
    elements: &mut Elements,
    input: &mut MshInput<'_>,
    nodes: &NodeTags,
    element: &Element,
    row: u64,
) -> Result<(), ReadError> {
    let &Element { kind, tag, n_nodes } = element;
    let mut tokens = input.tokens();
    let part = elements.part(kind);
    let mut corners = [NONE; 8];
    for k in 0..n_nodes {
        tokens.skip();
        let start = tokens.position;
        let node = tokens.count("element", row)?;
        // Nodes between corners are not checked.
        if let Some(corner) = corners[..kind.n_corners()].get_mut(k) {
            *corner = nodes.row(node);
            if *corner == NONE {
                let message = format!("element {row} names node {node}, which does not exist; correct it");
                return Err(ReadError::line_error(tokens.bytes, start, message));
            }
        }
    }
    input.position = tokens.position;
    if let Some(part) = part {
        part.tags.push(tag);
        part.sizes.push(kind.n_corners() as u8);
        part.corners.extend_from_slice(&corners[..kind.n_corners()]);
    }
    Ok(())
}

/// Reads a block of version 4: elements of a tag and nodes.
fn read_block(
    elements: &mut Elements,
    input: &mut MshInput<'_>,
    nodes: &NodeTags,
    block: &ElementBlock,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    if input.is_binary {
        let n_bytes = if input.version >= 41 { 8 } else { 4 };
        let mut cursor = input.cursor();
        let rows = cursor.rows(block.n, (n_bytes * (1 + block.n_nodes)) as u64, "element")?;
        let start = input.position;
        input.position = cursor.position;
        let layout = RowLayout { rows, start, n_bytes, head: 1, order: input.order };
        binary_rows(elements, nodes, block, &layout, progress)?;
    } else {
        input.tokens().check(block.n, 2 + 2 * block.n_nodes as u64, "element")?;
        elements.begin(block.kind, block.n_nodes, block.n);
        for row in 0..block.n {
            report_row(progress, row, block.n)?;
            let tag = input.size("element", row)?;
            let element = Element { kind: block.kind, n_nodes: block.n_nodes, tag };
            push(elements, input, nodes, &element, row)?;
        }
    }
    if let Some(part) = elements.part(block.kind) {
        let n = block.n as usize;
        part.physical.extend(std::iter::repeat_n(block.physical, n));
        part.elementary.extend(std::iter::repeat_n(block.elementary, n));
    }
    Ok(())
}

/// Reads blocks of version 2, each with its kind, its number of elements, and their number of tags.
fn binary_2(
    elements: &mut Elements,
    input: &mut MshInput<'_>,
    nodes: &NodeTags,
    n: u64,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let mut row = 0;
    while row < n {
        progress.step(row, n)?;
        let mut cursor = input.cursor();
        let head = cursor.rows(1, 12, "element")?;
        let [number, n_rows, n_tags] =
            [0, 4, 8].map(|at| i64::from(i32::from_bytes(&head[at..], input.order)));
        let (kind, n_nodes) = input.kind(number)?;
        if n_rows < 1 || n_tags < 0 || n_rows as u64 > n - row {
            return Err(input.wrong(
                "the counts of a block of elements do not match the file; get the file \
                                   again",
            ));
        }
        let head = 1 + n_tags as usize;
        let start = cursor.position;
        let rows = cursor.rows(n_rows as u64, (4 * (head + n_nodes)) as u64, "element")?;
        let block = ElementBlock { kind, n_nodes, n: n_rows as u64, physical: 0, elementary: 0 };
        let layout = RowLayout { rows, start, n_bytes: 4, head, order: input.order };
        binary_rows(elements, nodes, &block, &layout, progress)?;
        let order = input.order;
        if let Some(part) = elements.part(kind) {
            let stride = 4 * (head + n_nodes);
            let tag = |k: usize| {
                move |i: usize| {
                    if k < head { i32::from_bytes(&rows[stride * i + 4 * k..], order) } else { 0 }
                }
            };
            extend(&mut part.physical, n_rows as usize, progress, tag(1))?;
            extend(&mut part.elementary, n_rows as usize, progress, tag(2))?;
        }
        input.position = cursor.position;
        row += n_rows as u64;
    }
    Ok(())
}

/// Rows of `head` numbers, of which the first is the tag, and the nodes, each number of `n_bytes` bytes.
struct RowLayout<'a> {
    rows: &'a [u8],
    /// The byte of the file where the rows begin.
    start: usize,
    n_bytes: usize,
    head: usize,
    order: ByteOrder,
}

/// Reads the rows of a block of a binary file.
fn binary_rows(
    elements: &mut Elements,
    nodes: &NodeTags,
    block: &ElementBlock,
    layout: &RowLayout<'_>,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let RowLayout { rows, start, n_bytes, head, order } = *layout;
    let (n, n_corners) = (block.n as usize, block.kind.n_corners());
    elements.begin(block.kind, block.n_nodes, block.n);
    let Some(part) = elements.part(block.kind) else { return Ok(()) };
    let stride = n_bytes * (head + block.n_nodes);
    let whole = |at: usize| {
        if n_bytes == 8 {
            u64::from_bytes(&rows[at..], order)
        } else {
            u64::from(u32::from_bytes(&rows[at..], order))
        }
    };
    let first = part.corners.len();
    extend(&mut part.tags, n, progress, |i| whole(stride * i))?;
    part.sizes.extend(std::iter::repeat_n(n_corners as u8, n));
    let place = |k: usize| stride * (k / n_corners) + n_bytes * (head + k % n_corners);
    extend(&mut part.corners, n * n_corners, progress, |k| nodes.row(whole(place(k))))?;
    let found = &part.corners[first..];
    if !crate::progress::all(found.len(), progress, |k| found[k] != NONE)? {
        let k = found.iter().position(|&v| v == NONE).unwrap_or(0);
        let (row, node) = (k / n_corners, whole(place(k)));
        let message = format!("element {row} of a block names node {node}, which does not exist; correct it");
        return Err(ReadError::byte_error(start + place(k), message));
    }
    Ok(())
}
