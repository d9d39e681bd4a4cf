//! VTK XML reader: points and cells of all pieces joined, each array of values as a field.

use std::sync::Arc;

use adwave::Progress;
use roxmltree::Node;

use super::array::{arrays, no_index};
use super::document::{XmlFrame, count, error_at, parse, split};
use super::grid::read_grid;
use super::update::ImageDocument;
use crate::model::cells::{CellKind, Cells, Dataset, GridArrays, GridPoints, Polyhedra};
use crate::model::field::unused;
use crate::model::numbers::{Numbers, append};
use crate::progress::{all, collect};
use crate::provenance::{NAME, Provenance};
use crate::text::show;
use crate::{CoordinatePrecision, Field, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// Format of a VTK XML file.
pub(crate) fn kind_of(head: &[u8]) -> Option<Result<Format, &'static str>> {
    let at = memchr::memmem::find(head, b"<VTKFile")?;
    let tag = &head[at..];
    let tag = &tag[..memchr::memchr(b'>', tag).unwrap_or(tag.len())];
    // `header_type` may precede it.
    let is_own = |at: &usize| tag[at - 1].is_ascii_whitespace();
    let kind = memchr::memmem::find_iter(tag, b"type=").find(is_own).and_then(|at| tag.get(at + 6..))?;
    let end = kind.iter().position(|b| matches!(b, b'"' | b'\'')).unwrap_or(kind.len());
    Some(match &kind[..end] {
        b"PolyData" => Ok(Format::VTP),
        b"UnstructuredGrid" => Ok(Format::VTU),
        b"ImageData" | b"UniformGrid" => Ok(Format::VTI),
        b"RectilinearGrid" => Ok(Format::VTR),
        b"StructuredGrid" => Ok(Format::VTS),
        other if other.starts_with(b"P") || other == b"Collection" || other.starts_with(b"vtkMulti") => {
            Err("VTK XML that only refers to other files: use one of those")
        }
        _ => Err("VTK XML of an unknown kind"),
    })
}

/// Reads an image or a volume, with its bytes to write it again.
pub(crate) fn read_vti(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut content = read_content(&bytes, Format::VTI, limits, progress)?;
    if let Some(arrays) = content.arrays {
        content.shape.set_source(ImageDocument { bytes, limits: *limits, arrays });
    }
    Ok(content.shape)
}

/// Reads a file of one of the formats of shapes.
pub(crate) fn read_vtk_xml(
    bytes: &[u8],
    format: Format,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    Ok(read_content(bytes, format, limits, progress)?.shape)
}

/// Content of a file.
struct XmlContent {
    shape: ShapeFile,
    /// Arrays of the fields of an image.
    arrays: Option<GridArrays>,
}

impl From<ShapeFile> for XmlContent {
    fn from(shape: ShapeFile) -> Self {
        Self { shape, arrays: None }
    }
}

fn read_content(
    bytes: &[u8],
    format: Format,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<XmlContent, ReadError> {
    let (xml, appended) = split(bytes)?;
    let document = parse(&xml)?;
    let root = document.root_element();
    let frame = XmlFrame::new(root, appended, limits)?;
    let kind = root.attribute("type").unwrap_or("");
    let Some(data) = root.children().find(|node| node.has_tag_name(kind)) else {
        return Err(error_at(
            root,
            format!("the element {} is missing; save the file again", show(kind.as_bytes())),
        ));
    };
    let (mut extras, mut made, mut field_data) = (Vec::new(), None, Vec::new());
    for section in data.children().chain(root.children()).filter(|node| node.has_tag_name("FieldData")) {
        for array in arrays(section) {
            let name = array.attribute("Name").unwrap_or("");
            let own = (name == NAME)
                .then(|| letters(array))
                .flatten()
                .and_then(|text| Provenance::from_json(&text));
            if let Some(own) = own {
                made = Some(Arc::new(own));
            } else if let Some(field) = frame.field_data(array, progress)? {
                field_data.push(field);
            } else {
                extras.push(format!("field data `{name}`"));
            }
        }
    }
    let pieces: Vec<Node<'_, '_>> = data.children().filter(|node| node.has_tag_name("Piece")).collect();
    if pieces.is_empty() {
        return Err(error_at(data, "the file has no piece; save the file again"));
    }
    if matches!(format, Format::VTP | Format::VTU) {
        let mut shape = read_cells(&frame, &pieces, format, extras, progress)?;
        (shape.provenance, shape.field_data) = (made, field_data);
        return Ok(shape.into());
    }
    let grid = read_grid(&frame, data, &pieces, format, extras, progress)?;
    let mut content = if let GridPoints::Image(image) = grid.points {
        let active = |section: &str| {
            pieces[0].children().find(|node| node.has_tag_name(section))?.attribute("Scalars")
        };
        let active = [active("PointData"), active("CellData")];
        let (shape, arrays) = grid.into_image(&image, active, limits, progress)?;
        XmlContent { shape, arrays: Some(arrays) }
    } else {
        grid.into_shape(format, limits, progress)?.into()
    };
    (content.shape.format, content.shape.field_data) = (Some(format), field_data);
    Ok(content)
}

/// Decodes an array with a single text, which is stored as the codes of its letters.
fn letters(array: Node<'_, '_>) -> Option<String> {
    let is_text = matches!(array.attribute("type"), Some("String" | "UInt8"))
        && array.attribute("format") == Some("ascii");
    let numbers = array.text().filter(|_| is_text)?.split_ascii_whitespace();
    let bytes: Vec<u8> = numbers.map(|number| number.parse().ok()).collect::<Option<_>>()?;
    String::from_utf8(bytes.strip_suffix(&[0]).unwrap_or(&bytes).to_vec()).ok()
}

/// Fields of several pieces, joined.
#[derive(Default)]
pub(super) struct JoinedFields {
    fields: Option<Vec<Field>>,
}

impl JoinedFields {
    /// Adds the fields of a piece; fields that not all pieces have are listed in `extras`.
    pub(super) fn add(&mut self, more: Vec<Field>, extras: &mut Vec<String>) {
        let Some(fields) = &mut self.fields else {
            self.fields = Some(more);
            return;
        };
        let mut more: Vec<Option<Field>> = more.into_iter().map(Some).collect();
        let mut leave = |name: &str| {
            let what = format!("`{name}`, which differs between pieces");
            if !extras.contains(&what) {
                extras.push(what);
            }
        };
        fields.retain_mut(|field| {
            let is_alike = |other: &Option<Field>| {
                other.as_ref().is_some_and(|o| o.name == field.name && o.n_channels == field.n_channels)
            };
            let other = more.iter_mut().find(|other| is_alike(other)).and_then(Option::take);
            let is_joined = other.is_some_and(|other| append(&mut field.values, other.values));
            if !is_joined {
                leave(&field.name);
            }
            is_joined
        });
        more.iter().flatten().for_each(|field| leave(&field.name));
    }

    pub(super) fn into_fields(self) -> Vec<Field> {
        self.fields.unwrap_or_default()
    }
}

/// Fields in an element of a piece.
pub(super) fn fields<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    piece: Node<'n, '_>,
    section: &str,
    n_rows: usize,
    extras: &mut Vec<String>,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    let of = if section == "PointData" { "points" } else { "cells" };
    let mut fields: Vec<Field> = Vec::new();
    for node in piece.children().filter(|node| node.has_tag_name(section)).flat_map(arrays) {
        match frame.field(node, n_rows, of, progress)? {
            Some(mut field) => {
                field.name = unused(&field.name, "_", |name| fields.iter().any(|f| f.name == name));
                fields.push(field);
            }
            None => extras.push(format!(
                "array `{}`, which is not a list of rows",
                node.attribute("Name").unwrap_or("")
            )),
        }
    }
    Ok(fields)
}

/// Points of a piece, and their type.
pub(super) fn points<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    piece: Node<'n, '_>,
    n_points: u64,
    progress: Progress<'_>,
) -> Result<(Vec<[f64; 3]>, ValueType), ReadError> {
    frame.limits.check_points(n_points)?;
    let section = piece.children().find(|node| node.has_tag_name("Points"));
    let Some(node) = section.and_then(|section| arrays(section).next()) else {
        if n_points == 0 {
            return Ok((Vec::new(), ValueType::F32));
        }
        return Err(error_at(
            piece,
            format!("the piece has {n_points} points but no coordinates; save the file again"),
        ));
    };
    let numbers = frame.array(node, progress)?;
    let found = numbers.len();
    if n_points.checked_mul(3) != Some(found as u64) {
        return Err(error_at(
            node,
            format!("{n_points} points do not match {found} coordinates; get the whole file"),
        ));
    }
    Ok((numbers.to_points(progress)?, numbers.kind()))
}

fn read_cells<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    pieces: &[Node<'n, '_>],
    format: Format,
    mut extras: Vec<String>,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut all_points = Vec::new();
    let mut precision = CoordinatePrecision::F32;
    let (mut point_fields, mut cell_fields) = (JoinedFields::default(), JoinedFields::default());
    let mut cells = Vec::new();
    for &piece in pieces {
        let n_points = count(piece, "NumberOfPoints")?.unwrap_or(0);
        let (points, kind) = points(frame, piece, n_points, progress)?;
        let first = all_points.len();
        frame.limits.check_points((first + points.len()) as u64)?;
        let n = points.len();
        if first == 0 {
            all_points = points;
        } else {
            all_points.extend(points);
        }
        if n > 0 && kind != ValueType::F32 {
            precision = CoordinatePrecision::F64;
        }
        let mut of_piece = if format == Format::VTP {
            polydata_cells(frame, piece, n, progress)?
        } else {
            unstructured_cells(frame, piece, n, progress)?
        };
        let n_cells = of_piece.iter().map(Cells::len).sum();
        let of_points = fields(frame, piece, "PointData", n, &mut extras, progress)?;
        let of_cells = fields(frame, piece, "CellData", n_cells, &mut extras, progress)?;
        // Empty pieces have no arrays, or empty ones of any type.
        if n > 0 {
            point_fields.add(of_points, &mut extras);
        }
        if n_cells > 0 {
            cell_fields.add(of_cells, &mut extras);
        }
        if first > 0 {
            for block in &mut of_piece {
                block.renumber(first as u32);
            }
        }
        cells.append(&mut of_piece);
    }
    let (point_fields, cell_fields) = (point_fields.into_fields(), cell_fields.into_fields());
    Dataset { points: all_points, precision, cells, point_fields, cell_fields, extras }
        .into_shape(format, progress)
}

fn polydata_cells<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    piece: Node<'n, '_>,
    n_points: usize,
    progress: Progress<'_>,
) -> Result<Vec<Cells>, ReadError> {
    let mut blocks = Vec::new();
    for (name, kind) in [
        ("Verts", CellKind::Vertices),
        ("Lines", CellKind::Lines),
        ("Polys", CellKind::Polygons),
        ("Strips", CellKind::Strips),
    ] {
        let n_cells = count(piece, &format!("NumberOf{name}"))?;
        let Some(section) = piece.children().find(|node| node.has_tag_name(name)) else {
            if n_cells.is_some_and(|n| n > 0) {
                return Err(error_at(piece, format!("the piece has no {name}; get the whole file")));
            }
            continue;
        };
        if n_cells != Some(0) {
            blocks.push(block(frame, section, kind, n_cells, n_points, progress)?);
        }
    }
    Ok(blocks)
}

/// Cells of an element.
fn block<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    section: Node<'n, '_>,
    kind: CellKind,
    n_cells: Option<u64>,
    n_points: usize,
    progress: Progress<'_>,
) -> Result<Cells, ReadError> {
    let none = || Numbers::Values(ValueType::I64.empty());
    let corners = frame.find_array(section, "connectivity", progress)?.unwrap_or_else(none);
    let ends = frame.find_array(section, "offsets", progress)?.unwrap_or_else(none);
    let (n, n_corners) = (ends.len(), corners.len());
    if let Some(expected) = n_cells.filter(|&expected| expected != n as u64) {
        return Err(error_at(
            section,
            format!("{expected} cells do not match {n} offsets; get the whole file"),
        ));
    }
    if n_corners >= u32::MAX as usize || n >= u32::MAX as usize {
        let (found, limit) = (n_corners.max(n) as u64, u32::MAX.into());
        return Err(ReadError::Limit { what: "corners of cells", found, limit });
    }
    let offsets = ends
        .to_indices(n_corners as u32 + 1, progress)
        .map_err(|e| no_index(section, "offsets", e, n_corners as u64))?;
    drop(ends);
    let mut with_first = Vec::with_capacity(n + 1);
    with_first.push(0);
    with_first.extend_from_slice(&offsets);
    let offsets = with_first;
    if !all(n, progress, |i| offsets[i] <= offsets[i + 1])? || offsets[n] as usize != n_corners {
        let message = format!("the offsets must ascend to the {n_corners} corners; save the file again");
        return Err(error_at(section, message));
    }
    let corners = corners.to_indices(n_points as u32, progress).map_err(|error| match error {
        crate::model::numbers::IndexError::At(k, index) => ReadError::FaceIndex {
            place: format!("line {}", section.document().text_pos_at(section.range().start).row),
            face: (offsets.partition_point(|&start| start as usize <= k) - 1) as u64,
            index: index as i64,
            n_vertices: n_points as u64,
        },
        other => no_index(section, "corners", other, n_points as u64),
    })?;
    Ok(Cells { kind, offsets, corners, polyhedra: None })
}

fn unstructured_cells<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    piece: Node<'n, '_>,
    n_points: usize,
    progress: Progress<'_>,
) -> Result<Vec<Cells>, ReadError> {
    let n_cells = count(piece, "NumberOfCells")?;
    let Some(section) = piece.children().find(|node| node.has_tag_name("Cells")) else {
        if n_cells.is_some_and(|n| n > 0) {
            return Err(error_at(piece, "the piece has no cells; get the whole file"));
        }
        return Ok(Vec::new());
    };
    if n_cells == Some(0) {
        return Ok(Vec::new());
    }
    let mut cells = block(frame, section, CellKind::Polygons, n_cells, n_points, progress)?;
    let Some(types) = frame.find_array(section, "types", progress)? else {
        return Err(error_at(section, "the cells have no types; save the file again"));
    };
    if types.len() != cells.len() {
        let (found, n) = (types.len(), cells.len());
        return Err(error_at(section, format!("{n} cells do not match {found} types; get the whole file")));
    }
    let types = types.to_indices(256, progress).map_err(|e| no_index(section, "types", e, 256))?;
    let types: Vec<u8> = collect(types.len(), progress, |i| types[i] as u8)?;
    if types.contains(&42) {
        cells.polyhedra = polyhedra(frame, section, cells.len(), n_points, progress)?;
    }
    cells.kind = CellKind::Each(types);
    Ok(vec![cells])
}

/// Faces of polyhedra: since version 2.3 of the format in nested lists, before that in one stream of numbers.
fn polyhedra<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    section: Node<'n, '_>,
    n_cells: usize,
    n_points: usize,
    progress: Progress<'_>,
) -> Result<Option<Polyhedra>, ReadError> {
    let broken = || error_at(section, "the faces of polyhedra are invalid; save the file again");
    let list = |name: &str| -> Result<Option<Vec<i64>>, ReadError> {
        let Some(numbers) = frame.find_array(section, name, progress)? else { return Ok(None) };
        if !numbers.kind().is_integer() {
            return Err(broken());
        }
        Ok(Some(collect(numbers.len(), progress, |i| numbers.get(i) as i64)?))
    };
    let corner = |v: i64| u32::try_from(v).ok().filter(|&v| (v as usize) < n_points);
    let mut polyhedra = Polyhedra::default();
    if let (Some(stream), Some(ends)) = (list("faces")?, list("faceoffsets")?) {
        if ends.len() != n_cells {
            return Err(broken());
        }
        let mut at = 0;
        let next = |at: &mut usize| {
            let n = usize::try_from(*stream.get(*at)?).ok()?;
            *at += 1;
            Some(n)
        };
        for end in ends {
            let n_faces = if end < 0 { 0 } else { next(&mut at).ok_or_else(broken)? };
            for _ in 0..n_faces {
                progress.check()?;
                let n = next(&mut at).ok_or_else(broken)?;
                let end = at.checked_add(n).filter(|&end| end <= stream.len()).ok_or_else(broken)?;
                let face: Option<Vec<u32>> = stream[at..end].iter().map(|&v| corner(v)).collect();
                polyhedra.faces.push(&face.ok_or_else(broken)?);
                at = end;
            }
            polyhedra.ends.push(polyhedra.faces.len() as u32);
        }
        return Ok(Some(polyhedra));
    }
    let lists = [
        list("face_connectivity")?,
        list("face_offsets")?,
        list("polyhedron_to_faces")?,
        list("polyhedron_offsets")?,
    ];
    let [Some(corners), Some(face_ends), Some(to_faces), Some(ends)] = lists else { return Ok(None) };
    if ends.len() != n_cells {
        return Err(broken());
    }
    let mut start = 0;
    for end in ends {
        let end = usize::try_from(end)
            .ok()
            .filter(|end| (start..=to_faces.len()).contains(end))
            .ok_or_else(broken)?;
        for &f in &to_faces[start..end] {
            progress.check()?;
            let f = usize::try_from(f).map_err(|_| broken())?;
            let place = |f: usize| usize::try_from(*face_ends.get(f)?).ok();
            let first = if f == 0 { Some(0) } else { place(f - 1) };
            let range = first.zip(place(f)).and_then(|(a, b)| corners.get(a..b)).ok_or_else(broken)?;
            let face: Option<Vec<u32>> = range.iter().map(|&v| corner(v)).collect();
            polyhedra.faces.push(&face.ok_or_else(broken)?);
            // A face belongs to two cells at most.
            if polyhedra.faces.corners().len() > 2 * corners.len() {
                return Err(broken());
            }
        }
        start = end;
        polyhedra.ends.push(polyhedra.faces.len() as u32);
    }
    Ok(Some(polyhedra))
}
