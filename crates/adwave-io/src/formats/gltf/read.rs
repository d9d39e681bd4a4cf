//! Conversion of the scene to one shape.

use std::path::Path;
use std::sync::Arc;

use adwave::Progress;
use adwave::shape::Polygons;

use super::accessor::Accessor;
use super::document::Document;
use super::json::Json;
use super::matrix::{AffineMatrix, IDENTITY, determinant, direction, normal, point, turns};
use super::scene::{Instance, instances};
use super::update::GltfSource;
use super::write::COLOR;
use crate::model::colors::srgb_values;
use crate::provenance::{NAME, Provenance};
use crate::{CoordinatePrecision, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// Vertices shared by the primitives of one instance with the same attributes.
#[derive(Clone, Debug)]
pub(crate) struct VertexGroup {
    pub(crate) instance: Instance,
    /// Indices of the primitives in the mesh.
    pub(crate) primitives: Vec<usize>,
    pub(crate) first: usize,
    pub(crate) positions: Accessor,
    /// Other attributes, with their names in the file.
    pub(crate) attributes: Vec<(String, Accessor)>,
}

/// Reads a glTF or GLB; `folder` contains external files.
pub(crate) fn read_gltf(
    bytes: Vec<u8>,
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let document = Document::parse(bytes, folder, limits, progress)?;
    let mut shape = ShapeFile::empty();
    shape.format = Some(if document.is_binary { Format::GLB } else { Format::GLTF });
    let parts = parts(&document, limits)?;
    let n_vertices: u64 = parts.iter().map(|part| part.positions.count as u64).sum();
    limits.check_points(n_vertices)?;
    // A mesh that is shown by many nodes takes memory for each of them.
    limits.check_bytes(n_vertices.saturating_mul(24))?;
    shape.n_vertices = n_vertices as usize;
    let mut points = Vec::new();
    for part in &parts {
        let matrix = part.instance.matrix;
        if matrix == IDENTITY {
            part.positions.append_points(&document, &mut points, |p| p, progress)?;
        } else {
            part.positions.append_points(&document, &mut points, |p| point(&matrix, p), progress)?;
        }
    }
    // Transformed coordinates have more digits than the file's numbers.
    let is_plain = |part: &VertexGroup| part.instance.matrix == IDENTITY && !part.positions.is_normalized;
    shape.precision =
        if parts.iter().all(is_plain) { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 };
    shape.points = points.into();
    shape.vertex_fields = fields(&document, &parts, shape.n_vertices, progress)?;
    cells(&document, &parts, &mut shape, limits, progress)?;
    shape.extras = extras(&document.json);
    let made = document.json.get("asset").and_then(|asset| asset.get("extras")?.get(NAME));
    let made = made.and_then(|made| Provenance::from_json(std::str::from_utf8(&made.to_text()).ok()?));
    shape.provenance = made.map(Arc::new);
    shape.set_source(GltfSource { document, parts });
    Ok(shape)
}

/// Collects the vertices of the scene, mesh by mesh.
pub(crate) fn parts(document: &Document, limits: &ReadLimits) -> Result<Vec<VertexGroup>, ReadError> {
    let mut parts: Vec<VertexGroup> = Vec::new();
    let mut first = 0;
    for instance in instances(document)? {
        let Some(mesh) = document.json.list_of("meshes").get(instance.mesh) else {
            return Err(ReadError::Whole(format!(
                "mesh {} is referenced but does not exist; export the file again",
                instance.mesh
            )));
        };
        let of_instance = parts.len();
        let mut known: Vec<&Json> = Vec::new();
        for (k, primitive) in mesh.list_of("primitives").iter().enumerate() {
            let compressed = primitive.get("extensions").and_then(|e| e.get("KHR_draco_mesh_compression"));
            let Some(attributes @ Json::Object(members)) = primitive.get("attributes") else { continue };
            let Some(positions) = attributes.index_of("POSITION") else { continue };
            if let Some(same) = known.iter().position(|other| *other == attributes) {
                parts[of_instance + same].primitives.push(k);
                continue;
            }
            let mut others = Vec::new();
            for (name, value) in members.iter().filter(|(name, _)| name != "POSITION") {
                if let Some(index) = value.index() {
                    others.push((name.clone(), Accessor::read(document, index, limits)?));
                }
            }
            let positions = Accessor::read(document, positions, limits)?;
            if compressed.is_some() && positions.place.is_none() {
                return Err(ReadError::Whole(
                    "the meshes are compressed by Draco (KHR_draco_mesh_compression), which is not \
                    supported; export the file without compression"
                        .into(),
                ));
            }
            if let Some((name, other)) = others.iter().find(|(_, other)| other.count != positions.count) {
                let shown: String = name.chars().filter(|c| !c.is_control()).take(40).collect();
                return Err(ReadError::Whole(format!(
                    "mesh {}, primitive {k} has {} positions and {} of {shown}; export the file again",
                    instance.mesh, positions.count, other.count
                )));
            }
            first += positions.count;
            known.push(attributes);
            parts.push(VertexGroup {
                instance: instance.clone(),
                primitives: vec![k],
                first: first - positions.count,
                positions,
                attributes: others,
            });
        }
    }
    Ok(parts)
}

/// Name of the field for an attribute.
pub(crate) fn field_name(attribute: &str) -> String {
    match attribute {
        "NORMAL" => "normal".into(),
        COLOR => "color".into(),
        "TEXCOORD_0" => "texcoord".into(),
        own => own.strip_prefix('_').map_or_else(|| own.to_ascii_lowercase(), str::to_owned),
    }
}

/// True if an attribute has texture coordinates.
pub(crate) fn is_texcoord(attribute: &str) -> bool {
    attribute.starts_with("TEXCOORD_")
}

/// Fields of all parts; a part without a field of that name gets NaN, 0 for integers, or white.
fn fields(
    document: &Document,
    parts: &[VertexGroup],
    n_vertices: usize,
    progress: Progress<'_>,
) -> Result<Vec<Field>, ReadError> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in parts.iter().flat_map(|part| &part.attributes) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let mut fields: Vec<Field> = Vec::new();
    for attribute in names {
        let of = |part: &VertexGroup| {
            part.attributes.iter().find(|(name, _)| name == attribute).map(|(_, a)| a.clone())
        };
        let n_channels = parts.iter().filter_map(of).map(|a| a.n_channels).max().unwrap_or(1);
        let mut whole: Option<FieldValues> = None;
        for part in parts {
            let values = match of(part) {
                Some(accessor) => {
                    let values = in_scene(
                        attribute,
                        &accessor,
                        accessor.values(document, progress)?,
                        &part.instance.matrix,
                    );
                    widened(values, accessor.n_channels, n_channels, accessor.count)
                }
                None => absent(attribute, part.positions.count * n_channels),
            };
            whole = Some(match whole {
                None => values,
                Some(before) => concatenate(before, values),
            });
        }
        let Some(mut values) = whole.filter(|values| values.len() == n_vertices * n_channels) else {
            continue;
        };
        if attribute == COLOR {
            values = srgb_values(&values, n_channels);
        }
        let mut name = field_name(attribute);
        // Two attributes may differ in more than the field's name shows.
        while fields.iter().any(|field| field.name == name) {
            name.push('_');
        }
        fields.push(Field::new(name, n_channels, values));
    }
    numbered(&fields, progress)
}

/// Joins scalar attributes `hks_0`, `hks_1`, … to one field of more than four channels, as an attribute has at most
/// four.
fn numbered(fields: &[Field], progress: Progress<'_>) -> Result<Vec<Field>, ReadError> {
    let mut grouped: Vec<Field> = Vec::new();
    let mut k = 0;
    while k < fields.len() {
        let base = fields[k].name.strip_suffix("_0").filter(|base| !base.is_empty());
        let same = |n: usize, base: &str| {
            let other = fields.get(k + n);
            other.is_some_and(|f| f.n_channels == 1 && f.name == format!("{base}_{n}"))
        };
        let n = base.map_or(0, |base| (0..fields.len() - k).take_while(|&n| same(n, base)).count());
        let lists: Vec<&FieldValues> = fields[k..k + n].iter().map(|field| &field.values).collect();
        let whole = if n > 4 { FieldValues::interleave(&lists, progress)? } else { None };
        if let (Some(values), Some(base)) = (whole, base) {
            grouped.push(Field::new(base, n, values));
            k += n;
        } else {
            grouped.push(fields[k].clone());
            k += 1;
        }
    }
    Ok(grouped)
}

/// Transforms values to the scene: normals are rotated with their mesh, v of texture coordinates points upwards, and
/// small integers that represent fractions are converted, except for colors.
fn in_scene(attribute: &str, accessor: &Accessor, values: FieldValues, matrix: &AffineMatrix) -> FieldValues {
    let is_color = attribute.starts_with("COLOR_");
    let mut values = match accessor.fractions(&values) {
        std::borrow::Cow::Owned(fractions) if !is_color => fractions,
        _ => values,
    };
    if is_texcoord(attribute) && accessor.n_channels == 2 {
        flip_v(&mut values);
    }
    if attribute == "NORMAL" && accessor.n_channels == 3 && turns(matrix) {
        let turned =
            |row: &[f32]| normal(matrix, [row[0].into(), row[1].into(), row[2].into()]).map(|x| x as f32);
        if let FieldValues::F32(list) = &mut values {
            list.as_chunks_mut::<3>().0.iter_mut().for_each(|row| *row = turned(row));
        }
    }
    if attribute == "TANGENT"
        && accessor.n_channels == 4
        && turns(matrix)
        && let FieldValues::F32(list) = &mut values
    {
        list.as_chunks_mut::<4>().0.iter_mut().for_each(|row| turn_direction(row, matrix));
    }
    values
}

/// Turns the first three numbers of a row by the linear part of a matrix and scales them to length 1.
pub(crate) fn turn_direction(row: &mut [f32], matrix: &AffineMatrix) {
    if let [x, y, z, ..] = row {
        [*x, *y, *z] = direction(matrix, [(*x).into(), (*y).into(), (*z).into()]).map(|x| x as f32);
    }
}

/// v ↦ 1 − v.
pub(crate) fn flip_v(values: &mut FieldValues) {
    match values {
        FieldValues::F32(list) => list.as_chunks_mut::<2>().0.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]),
        FieldValues::F64(list) => list.as_chunks_mut::<2>().0.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]),
        _ => {}
    }
}

/// Adds channels to rows; the alpha of a color without alpha is 1.
fn widened(values: FieldValues, from: usize, to: usize, n_rows: usize) -> FieldValues {
    if from == to {
        return values;
    }
    let full = match values.value_type() {
        ValueType::U8 => 255.0,
        ValueType::U16 => 65_535.0,
        _ => 1.0,
    };
    let mut wide = values.value_type().empty();
    for k in 0..n_rows * to {
        let x = if k % to < from { values.get(k / to * from + k % to) } else { full };
        wide.push_f64(x);
    }
    wide
}

fn absent(attribute: &str, n: usize) -> FieldValues {
    let value = if attribute.starts_with("COLOR_") { 1.0 } else { f32::NAN };
    FieldValues::F32(vec![value; n])
}

/// Concatenates two lists; lists of different types become floats, colors become fractions.
fn concatenate(before: FieldValues, after: FieldValues) -> FieldValues {
    macro_rules! same {
        ($($variant:ident),*) => {
            match (before, after) {
                $((FieldValues::$variant(mut a), FieldValues::$variant(mut b)) => {
                    a.append(&mut b);
                    FieldValues::$variant(a)
                })*
                (a, b) => {
                    let mut all = as_floats(&a);
                    all.extend(as_floats(&b));
                    FieldValues::F32(all)
                }
            }
        };
    }
    same!(U8, I8, U16, I16, U32, F32, F64)
}

fn as_floats(values: &FieldValues) -> Vec<f32> {
    let largest = match values {
        FieldValues::U8(_) => 255.0,
        FieldValues::U16(_) => 65_535.0,
        _ => 1.0,
    };
    (0..values.len()).map(|k| (values.get(k) / largest) as f32).collect()
}

/// Faces, edges, and the material of each face.
fn cells(
    document: &Document,
    parts: &[VertexGroup],
    shape: &mut ShapeFile,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let (mut triangles, mut materials): (Vec<[u32; 3]>, Vec<i32>) = (Vec::new(), Vec::new());
    for part in parts {
        let mesh = &document.json.list_of("meshes")[part.instance.mesh];
        let is_mirrored = determinant(&part.instance.matrix) < 0.0;
        for &k in &part.primitives {
            let primitive = &mesh.list_of("primitives")[k];
            let n = part.positions.count;
            let corners = match primitive.index_of("indices") {
                Some(index) => Some(Accessor::read(document, index, limits)?.indices(document, progress)?),
                None => None,
            };
            let n_corners = corners.as_ref().map_or(n, Vec::len);
            if let Some(place) = corners.iter().flatten().position(|&v| v as usize >= n) {
                return Err(ReadError::FaceIndex {
                    place: format!("mesh {}, primitive {k}", part.instance.mesh),
                    face: place as u64 / 3,
                    index: corners.map_or(0, |corners| corners[place].into()),
                    n_vertices: n as u64,
                });
            }
            let corner =
                |c: usize| part.first as u32 + corners.as_ref().map_or(c as u32, |corners| corners[c]);
            let before = triangles.len();
            limits.check_bytes((triangles.len() as u64 + n_corners as u64).saturating_mul(12))?;
            match primitive.index_of("mode").unwrap_or(4) {
                0 => {}
                mode @ 1..=3 => lines(mode, n_corners, &corner, &mut shape.edges.pairs),
                mode @ 4..=6 => surface(mode, n_corners, &corner, &mut triangles),
                mode => {
                    let told =
                        format!("mesh {}, primitive {k} has the unknown mode {mode}", part.instance.mesh);
                    return Err(ReadError::Whole(told + "; export the file again"));
                }
            }
            if is_mirrored {
                triangles[before..].iter_mut().for_each(|t| t.swap(1, 2));
            }
            let material = primitive.index_of("material").map_or(-1, |m| m as i32);
            materials.resize(triangles.len(), material);
        }
    }
    shape.faces = Polygons::from_triangles(&triangles).into();
    if materials.iter().any(|m| Some(m) != materials.first()) {
        shape.face_fields.push(Field::new("material", 1, FieldValues::I32(materials)));
    }
    Ok(())
}

fn lines(mode: usize, n: usize, corner: &impl Fn(usize) -> u32, pairs: &mut Vec<[u32; 2]>) {
    if mode == 1 {
        pairs.extend((0..n / 2).map(|k| [corner(2 * k), corner(2 * k + 1)]));
        return;
    }
    pairs.extend((1..n).map(|k| [corner(k - 1), corner(k)]));
    if mode == 2 && n > 2 {
        pairs.push([corner(n - 1), corner(0)]);
    }
}

fn surface(mode: usize, n: usize, corner: &impl Fn(usize) -> u32, triangles: &mut Vec<[u32; 3]>) {
    match mode {
        4 => triangles.extend((0..n / 3).map(|k| [corner(3 * k), corner(3 * k + 1), corner(3 * k + 2)])),
        5 => {
            let strip = (2..n).map(|k| {
                let odd = k % 2;
                [corner(k - 2), corner(k - 1 + odd), corner(k - odd)]
            });
            // A strip continues across triangles without area.
            triangles.extend(strip.filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        }
        _ => triangles.extend((2..n).map(|k| [corner(k - 1), corner(k), corner(0)])),
    }
}

/// Content that only this format can store.
fn extras(json: &Json) -> Vec<String> {
    let mut extras = Vec::new();
    for (key, one, many) in [
        ("materials", "material", "materials"),
        ("images", "picture", "pictures"),
        ("animations", "animation", "animations"),
        ("skins", "skin", "skins"),
        ("cameras", "camera", "cameras"),
    ] {
        match json.list_of(key).len() {
            0 => {}
            1 => extras.push(format!("1 {one}")),
            n => extras.push(format!("{n} {many}")),
        }
    }
    if json.list_of("nodes").len() > 1 {
        extras.push(format!("the tree of {} nodes", json.list_of("nodes").len()));
    }
    let targets = |mesh: &Json| mesh.list_of("primitives").iter().any(|p| !p.list_of("targets").is_empty());
    if json.list_of("meshes").iter().any(targets) {
        extras.push("morph targets".into());
    }
    extras
}
