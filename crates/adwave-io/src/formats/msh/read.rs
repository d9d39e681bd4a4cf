//! Gmsh MSH reader: conversion of the sections to a shape.

use crate::model::binary_rows::CoordinateRows;
use adwave::Progress;
use adwave::shape::Polygons;

use crate::formats::msh::elements::{ElementList, Elements, PhysicalGroups, read_elements};
use crate::formats::msh::fields::{TagValues, read_values};
use crate::formats::msh::input::{MshInput, Skips};
use crate::formats::msh::nodes::{MshNodes, NONE, NodeTags, read_nodes};
use crate::formats::msh::write::MshSource;
use crate::model::binary_rows::BinaryRows;
use crate::model::field::ByteOrder;
use crate::model::grouping::unique;
use crate::model::text_rows::{DecimalMark, Separator, TextRows};
use crate::progress::{collect, report_row};
use crate::text::line_end;
use crate::{Edges, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Content read from the file so far.
#[derive(Default)]
struct MshContent {
    nodes: Option<MshNodes>,
    tags: Option<NodeTags>,
    elements: Option<Elements>,
    groups: PhysicalGroups,
    of_nodes: Vec<TagValues>,
    of_elements: Vec<TagValues>,
    /// Name of a node field and the range of its section.
    sections: Vec<(String, usize, usize)>,
    extras: Vec<&'static str>,
}

/// Reads a Gmsh mesh.
pub(crate) fn read_msh(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut input = header(&bytes)?;
    let mut found = MshContent::default();
    loop {
        let start = input.position;
        let Some(name) = input.section()? else { break };
        section(&mut input, &mut found, name, limits, progress)?;
        if name == b"NodeData"
            && let Some(values) = found.of_nodes.last()
        {
            found.sections.push((values.name.clone(), start, input.position));
        }
    }
    let missing = |what: &str| ReadError::Whole(format!("the MSH has no section {what}; get the whole file"));
    let (is_binary, order) = (input.is_binary, input.order);
    let nodes = found.nodes.take().ok_or_else(|| missing("$Nodes"))?;
    let elements = found.elements.take().ok_or_else(|| missing("$Elements"))?;
    let tags = found.tags.take().ok_or_else(|| missing("$Nodes"))?;
    let mut shape = ShapeFile::from_cloud(nodes.points);
    shape.format = Some(if is_binary { Format::MSH } else { Format::MSH_ASCII });
    let mut budget = 1_000_000 + 8 * bytes.len();
    for values in &found.of_nodes {
        let name = unique(&shape.vertex_fields, values.name.clone());
        let field = field(name, values, &tags, shape.n_vertices, &mut budget, progress)?;
        shape.vertex_fields.extend(field);
    }
    attach(&mut shape, elements, &found.of_elements, &mut budget, progress)?;
    shape.extras.extend(found.extras.iter().map(ToString::to_string));
    let rows = if is_binary {
        CoordinateRows::Binary(BinaryRows { bytes, runs: nodes.runs, is_double: true, n_axes: 3, order })
    } else {
        let (columns, separator) = ([0, 1, 2], Separator::OverLines);
        CoordinateRows::Text(TextRows {
            decimal: DecimalMark::Point,
            bytes,
            rows: nodes.rows,
            columns,
            separator,
            names: None,
        })
    };
    let tags = if matches!(tags, NodeTags::Run(1, _)) { Vec::new() } else { nodes.tags };
    let original = MshSource { rows, tags, sections: found.sections };
    shape.set_source(original);
    Ok(shape)
}

fn header(bytes: &[u8]) -> Result<MshInput<'_>, ReadError> {
    let mut input = MshInput { bytes, position: 0, is_binary: false, order: ByteOrder::Little, version: 22 };
    if bytes.starts_with(b"\xef\xbb\xbf") {
        input.position = 3;
    }
    while let Some(name) = input.section()? {
        if name == b"NOD" {
            return Err(input.wrong("MSH of version 1 is not supported; save it in Gmsh as version 2 or 4"));
        }
        if name != b"MeshFormat" {
            input.end(name, Skips::Anything)?;
            continue;
        }
        let mut tokens = input.tokens();
        let version = tokens.number("the format", 0)?;
        let is_binary = tokens.integer("the format", 0)?;
        let n_bytes = tokens.integer("the format", 0)?;
        if ![2.0, 2.1, 2.2, 4.0, 4.1].contains(&version) {
            let message = format!("MSH of version {version} is not supported; save it as version 2.2 or 4.1");
            return Err(input.wrong(&message));
        }
        if n_bytes != 8 {
            return Err(input.wrong("numbers must have 8 bytes; save the file with a 64-bit program"));
        }
        input.version = (10.0 * version).round() as u32;
        input.position = tokens.position;
        if is_binary != 0 {
            input.is_binary = true;
            input.position = line_end(bytes, tokens.position).saturating_add(1);
            let mut cursor = input.cursor();
            let one = cursor.i32("the format")?;
            input.order = match one {
                1 => ByteOrder::Little,
                0x0100_0000 => ByteOrder::Big,
                _ => {
                    return Err(
                        input.wrong("the number that marks the byte order is missing; get the file again")
                    );
                }
            };
            input.position = cursor.position;
        }
        input.end(name, Skips::Anything)?;
        return Ok(input);
    }
    Err(input.wrong("the section $MeshFormat is missing; get the whole file"))
}

fn section(
    input: &mut MshInput<'_>,
    found: &mut MshContent,
    name: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let mut extra = |what: &'static str| {
        if !found.extras.contains(&what) {
            found.extras.push(what);
        }
    };
    match name {
        b"Nodes" if found.nodes.is_none() => {
            let nodes = read_nodes(input, limits, progress)?;
            found.tags = Some(NodeTags::new(&nodes.tags, progress)?);
            found.nodes = Some(nodes);
        }
        b"Elements" if found.elements.is_none() => {
            let Some(tags) = &found.tags else {
                return Err(input.wrong("the nodes must precede the elements; put $Nodes first"));
            };
            found.elements = Some(read_elements(input, tags, &found.groups, progress)?);
        }
        b"Entities" if input.version >= 40 => {
            found.groups = entities(input)?;
            extra("entities");
        }
        b"NodeData" => found.of_nodes.push(read_values(input, progress)?),
        b"ElementData" => found.of_elements.push(read_values(input, progress)?),
        b"ParametricNodes" => {
            return Err(input.wrong("nodes with parameters are not supported; save them without"));
        }
        b"Comments" | b"MeshFormat" => return input.end(name, Skips::Anything),
        _ => {
            extra(match name {
                b"PhysicalNames" => "names of physical groups",
                b"ElementNodeData" => "fields of corners of elements",
                b"Periodic" => "periodicity",
                b"PartitionedEntities" => "partitions",
                _ => "sections of other kinds",
            });
            return input.end(name, Skips::Anything);
        }
    }
    input.end(name, Skips::Blanks)
}

/// Reads the content of `$Entities`: points, curves, surfaces and volumes with their physical groups.
fn entities(input: &mut MshInput<'_>) -> Result<PhysicalGroups, ReadError> {
    let mut groups = PhysicalGroups::new();
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = input.size("entity", 0)?;
    }
    for (dimension, n) in counts.into_iter().enumerate() {
        for row in 0..n {
            let tag = input.int("entity", row)?;
            // A point of 4.1 has a position, other entities have a box.
            let n_doubles = if dimension == 0 && input.version >= 41 { 3 } else { 6 };
            for _ in 0..n_doubles {
                input.double("entity")?;
            }
            let n_groups = input.size("entity", row)?;
            for k in 0..n_groups {
                let group = input.int("entity", row)?;
                if k == 0 {
                    groups.insert((dimension as i64, tag), group as i32);
                }
            }
            if dimension > 0 {
                for _ in 0..input.size("entity", row)? {
                    input.int("entity", row)?;
                }
            }
        }
    }
    Ok(groups)
}

/// Adds faces and their fields: those of the file, else the boundary of its cells, else its lines.
fn attach(
    shape: &mut ShapeFile,
    elements: Elements,
    fields: &[TagValues],
    budget: &mut usize,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let Elements { lines, faces, volumes, cells, n_points, is_curved } = elements;
    let mut extra = |is_there: bool, what: &str| {
        if is_there {
            shape.extras.push(what.into());
        }
    };
    extra(n_points > 0, "elements of a point");
    extra(!volumes.sizes.is_empty(), "volume cells");
    extra(is_curved, "nodes between corners as such");
    let has_faces = !faces.sizes.is_empty() || !volumes.sizes.is_empty();
    extra(has_faces && !lines.sizes.is_empty(), "elements of a line");
    if !has_faces {
        let (pairs, _) = lines.corners.as_chunks::<2>();
        shape.edges = Edges { pairs: pairs.to_vec(), ..Edges::default() };
        return Ok(());
    }
    let (part, owners) = if faces.sizes.is_empty() {
        let (faces, owners) = cells.boundary(progress)?;
        shape.faces = faces.into();
        (volumes, Some(owners))
    } else {
        shape.faces = polygons(&faces, progress)?.into();
        (faces, None)
    };
    let n = shape.faces.len();
    let of_face = |row: usize| owners.as_ref().map_or(row, |owners| owners[row] as usize);
    for (name, list, usual) in [("physical", &part.physical, 0), ("elementary", &part.elementary, 1)] {
        if list.iter().any(|&tag| tag != usual) {
            let values = collect(n, progress, |f| list[of_face(f)])?;
            shape.face_fields.push(Field::new(name, 1, FieldValues::I32(values)));
        }
    }
    if fields.is_empty() {
        return Ok(());
    }
    let tags = NodeTags::new(&part.tags, progress)?;
    for values in fields {
        let name = unique(&shape.face_fields, values.name.clone());
        let Some(mut field) = field(name, values, &tags, part.tags.len(), budget, progress)? else {
            continue;
        };
        if owners.is_some() {
            let (n_channels, FieldValues::F64(of_cells)) = (field.n_channels, &field.values) else {
                continue;
            };
            let of_faces = collect(n * n_channels, progress, |k| {
                of_cells[of_face(k / n_channels) * n_channels + k % n_channels]
            })?;
            field.values = FieldValues::F64(of_faces);
        }
        shape.face_fields.push(field);
    }
    Ok(())
}

fn polygons(faces: &ElementList, progress: Progress<'_>) -> Result<Polygons, ReadError> {
    let mut offsets = Vec::with_capacity(faces.sizes.len() + 1);
    let mut end = 0;
    offsets.push(0);
    for (row, &size) in faces.sizes.iter().enumerate() {
        report_row(progress, row as u64, faces.sizes.len() as u64)?;
        end += u32::from(size);
        offsets.push(end);
    }
    Ok(Polygons::from_parts(offsets, faces.corners.clone()).expect("sums of the sizes of the faces"))
}

/// Values for `n` tags, NaN for tags without a value; `None` if there are no values.
fn field(
    name: String,
    values: &TagValues,
    tags: &NodeTags,
    n: usize,
    budget: &mut usize,
    progress: Progress<'_>,
) -> Result<Option<Field>, ReadError> {
    let n_channels = values.n_channels;
    if !values.tags.iter().any(|&tag| tags.row(tag) != NONE) {
        return Ok(None);
    }
    // A field with few rows must not allocate memory at every vertex.
    let Some(left) = budget.checked_sub(n.saturating_mul(n_channels)) else {
        let message = "a field must have values at most of the vertices for its number of channels; add \
                      them to all vertices";
        return Err(ReadError::Whole(message.into()));
    };
    *budget = left;
    let mut all = vec![f64::NAN; n * n_channels];
    for (row, &tag) in values.tags.iter().enumerate() {
        report_row(progress, row as u64, values.tags.len() as u64)?;
        let place = tags.row(tag);
        if place != NONE {
            let start = place as usize * n_channels;
            all[start..start + n_channels]
                .copy_from_slice(&values.numbers[row * n_channels..(row + 1) * n_channels]);
        }
    }
    Ok(Some(Field::new(name, n_channels, FieldValues::F64(all))))
}
