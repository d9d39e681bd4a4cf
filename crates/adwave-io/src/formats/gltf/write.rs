//! Writer of a new file: one mesh in one buffer.

use std::io::Write;
use std::ops::Range;

use adwave::Progress;
use adwave::shape::bounding_box;
use base64::Engine as _;

use super::accessor::code;
use super::document::glb_head;
use super::json::{Json, object};
use crate::model::colors::{is_intensity, linear_from_srgb};
use crate::model::f32_limits::{check_range, is_single, triangles};
use crate::model::field::{ByteOrder, Number, with_values};
use crate::progress::collect;
use crate::provenance::{NAME, Provenance};
use crate::{Field, FieldValues, Format, ShapeFile, ValueType, WriteError, WriteReport};

/// Target of a buffer view.
pub(crate) const VERTICES: usize = 34962;
const INDICES: usize = 34963;
/// Attribute of colors, whose numbers are linear intensities.
pub(crate) const COLOR: &str = "COLOR_0";

/// Consecutive numbers with their views and accessors.
#[derive(Default)]
pub(crate) struct NumberBuffer {
    pub(crate) bytes: Vec<u8>,
    pub(crate) views: Vec<Json>,
    pub(crate) accessors: Vec<Json>,
    /// Number of views and accessors that existed before.
    pub(crate) n_views: usize,
    pub(crate) n_accessors: usize,
    /// Offset of the bytes in the buffer.
    pub(crate) start: usize,
}

/// Rows of numbers in the encoding of a buffer.
pub(crate) struct EncodedRows {
    pub(crate) bytes: Vec<u8>,
    pub(crate) count: usize,
    pub(crate) n_channels: usize,
    pub(crate) value_type: ValueType,
    pub(crate) is_normalized: bool,
}

impl EncodedRows {
    fn row(&self) -> usize {
        self.n_channels * self.value_type.n_bytes()
    }
}

impl NumberBuffer {
    /// Appends rows and returns the index of their accessor.
    pub(crate) fn add(&mut self, rows: &EncodedRows, target: usize, range: Option<[[f32; 3]; 2]>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (at, row) = (self.start + self.bytes.len(), rows.row());
        // Rows of vertices are aligned to four bytes.
        let stride = if target == VERTICES { row.next_multiple_of(4) } else { row };
        if stride == row {
            self.bytes.extend_from_slice(&rows.bytes);
        } else {
            for row in rows.bytes.chunks_exact(row) {
                self.bytes.extend_from_slice(row);
                self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
            }
        }
        let length = self.start + self.bytes.len() - at;
        let mut view =
            object([("buffer", 0.into()), ("byteOffset", at.into()), ("byteLength", length.into())]);
        if stride != row {
            view.set("byteStride", stride.into());
        }
        view.set("target", target.into());
        self.views.push(view);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][rows.n_channels - 1];
        let mut accessor = object([
            ("bufferView", (self.n_views + self.views.len() - 1).into()),
            ("componentType", code(rows.value_type).into()),
            ("count", rows.count.into()),
            ("type", kind.into()),
        ]);
        if rows.is_normalized {
            accessor.set("normalized", Json::Bool(true));
        }
        if let Some([low, high]) = range {
            let list =
                |corner: [f32; 3]| Json::List(corner.iter().map(|&x| Json::from_number(x.into())).collect());
            accessor.set("min", list(low));
            accessor.set("max", list(high));
        }
        self.accessors.push(accessor);
        self.n_accessors + self.accessors.len() - 1
    }
}

/// Positions as 32-bit floats, with their bounding box.
pub(crate) fn positions(
    points: &[[f32; 3]],
    progress: Progress<'_>,
) -> Result<(EncodedRows, [[f32; 3]; 2]), WriteError> {
    let bytes = collect(points.len(), progress, |i| points[i].map(f32::to_le_bytes))?;
    let bytes = bytes.as_flattened().as_flattened().to_vec();
    let rows = EncodedRows {
        bytes,
        count: points.len(),
        n_channels: 3,
        value_type: ValueType::F32,
        is_normalized: false,
    };
    Ok((rows, range(points)))
}

/// Bounding box of the finite points.
pub(crate) fn range(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let mut range = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for point in points {
        for c in 0..3 {
            if point[c].is_finite() {
                range[0][c] = range[0][c].min(point[c]);
                range[1][c] = range[1][c].max(point[c]);
            }
        }
    }
    if range.as_flattened().iter().all(|x| x.is_finite()) { range } else { [[0.0; 3]; 2] }
}

/// Attribute that stores channels of a field.
pub(crate) struct Attribute {
    pub(crate) name: String,
    /// First channel of the field, and the number of channels.
    pub(crate) channels: (usize, usize),
    pub(crate) value_type: ValueType,
    pub(crate) is_normalized: bool,
}

/// Attributes for a field: several if it has more than four channels.
pub(crate) fn attributes(field: &Field) -> Vec<Attribute> {
    let (n, own) = (field.n_channels, field.values.value_type());
    let small = matches!(own, ValueType::U8 | ValueType::I8 | ValueType::U16 | ValueType::I16);
    let one = |name: &str, value_type, is_normalized| {
        vec![Attribute { name: name.into(), channels: (0, n), value_type, is_normalized }]
    };
    match (field.name.as_str(), n) {
        ("normal", 3) => one("NORMAL", ValueType::F32, false),
        ("tangent", 4) => one("TANGENT", ValueType::F32, false),
        // Eight bits of light would not tell dark colors apart, and some readers take 16 bits for 8.
        ("color", 3 | 4) if is_intensity(field) => one(COLOR, ValueType::F32, false),
        ("texcoord", 2) => one("TEXCOORD_0", ValueType::F32, false),
        (name, 1..=4) => one(&format!("_{name}"), if small { own } else { ValueType::F32 }, false),
        (name, _) => (0..n)
            .map(|c| Attribute {
                name: format!("_{name}_{c}"),
                channels: (c, 1),
                value_type: if small { own } else { ValueType::F32 },
                is_normalized: false,
            })
            .collect(),
    }
}

/// Rows of a field as an attribute has them; `turned` changes each row of floats.
pub(crate) fn rows(
    field: &Field,
    attribute: &Attribute,
    range: Range<usize>,
    turned: impl Fn(&mut [f32]) + Sync + Send,
    progress: Progress<'_>,
) -> Result<EncodedRows, WriteError> {
    let (first, count) = (range.start, range.len());
    let (from, n) = attribute.channels;
    let flips = attribute.name == "TEXCOORD_0";
    let index = |i: usize, c: usize| (first + i) * field.n_channels + from + c;
    let full = if attribute.name == COLOR { field.full_intensity() } else { 1.0 };
    let intensity = |i: usize, c: usize| {
        let x = field.values.get(index(i, c)) / full;
        if c < 3 { linear_from_srgb(x) } else { x }
    };
    let bytes = if attribute.value_type == ValueType::F32 {
        let row = |i: usize| {
            let mut row = [0_f32; 4];
            for (c, x) in row[..n].iter_mut().enumerate() {
                let value =
                    if attribute.name == COLOR { intensity(i, c) } else { field.values.get(index(i, c)) };
                *x = if flips && c == 1 { 1.0 - value } else { value } as f32;
            }
            turned(&mut row[..n]);
            row
        };
        let rows = collect(count, progress, row)?;
        rows.iter().flat_map(|row| row[..n].iter().flat_map(|x| x.to_le_bytes())).collect()
    } else {
        let mut bytes = Vec::with_capacity(count * n * attribute.value_type.n_bytes());
        with_values!(&field.values, values => for i in 0..count {
            (0..n).for_each(|c| values[index(i, c)].write_bytes(ByteOrder::Little, &mut bytes));
        });
        bytes
    };
    let (value_type, is_normalized) = (attribute.value_type, attribute.is_normalized);
    Ok(EncodedRows { bytes, count, n_channels: n, value_type, is_normalized })
}

/// Checks that the values fit 32-bit floats, and reports digits that do not.
pub(crate) fn report_field(
    field: &Field,
    format: Format,
    report: &mut WriteReport,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    if attributes(field).iter().all(|a| a.value_type != ValueType::F32) {
        return Ok(());
    }
    let (n, value) = (field.values.len(), |i: usize| field.values.get(i));
    check_range(format, &format!("values of `{}`", field.name), n, progress, value)?;
    let has_more = |x: f64| field.values.value_type().is_integer() && x.abs() >= (1_u64 << 53) as f64;
    if !is_single(n, progress, value)? || (0..n).any(|i| has_more(value(i))) {
        report.report_dropped(format!("digits of `{}` beyond 32-bit floats", field.name));
    }
    Ok(())
}

/// Translation of the node: the center of the points if 32-bit floats would lose their digits otherwise.
fn place(shape: &ShapeFile) -> Option<[f64; 3]> {
    /// Distance from the origin, in sizes of the shape, from which points are translated.
    const FAR: f64 = 16.0;
    let flat = shape.points.as_flattened();
    if !flat.iter().all(|x| x.is_finite()) || flat.iter().all(|&x| f64::from(x as f32) == x) {
        return None;
    }
    let (low, high) = bounding_box(&shape.points)?;
    let center: [f64; 3] = std::array::from_fn(|c| 0.5 * low[c] + 0.5 * high[c]);
    let size = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    center.iter().any(|x| x.abs() > FAR * size).then_some(center)
}

/// Sets or removes the provenance of the shape in the extras of the asset.
pub(super) fn set_provenance(json: &mut Json, provenance: Option<&Provenance>) {
    let value = provenance.and_then(|own| Json::parse(own.to_json().as_bytes()).ok());
    let Some(asset) = json.get_mut("asset") else { return };
    let Some(value) = value else {
        if let Some(extras) = asset.get_mut("extras") {
            extras.remove(NAME);
        }
        return;
    };
    if !matches!(asset.get("extras"), Some(Json::Object(_))) {
        asset.set("extras", object([]));
    }
    if let Some(extras) = asset.get_mut("extras") {
        extras.set(NAME, value);
    }
}

/// Writes a glTF or GLB.
pub(crate) fn write_gltf(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let (n, points) = (shape.points.len(), &shape.points);
    let center = place(shape);
    let shift = center.unwrap_or_default();
    let local =
        collect(n, progress, |i| std::array::from_fn::<f32, 3, _>(|c| (points[i][c] - shift[c]) as f32))?;
    let is_exact = |k: usize| {
        let x = points[k / 3][k % 3];
        (f64::from(local[k / 3][k % 3]) + shift[k % 3]).to_bits() == x.to_bits() || x.is_nan() || x == 0.0
    };
    if !crate::progress::all(3 * n, progress, is_exact)? {
        report.report_dropped("digits of coordinates beyond 32-bit floats");
    }
    let mut numbers = NumberBuffer::default();
    let (rows_of_points, range) = positions(&local, progress)?;
    let mut named = object([("POSITION", numbers.add(&rows_of_points, VERTICES, Some(range)).into())]);
    for field in &shape.vertex_fields {
        report_field(field, format, report, progress)?;
        for attribute in attributes(field) {
            let rows = rows(field, &attribute, 0..n, |_| {}, progress)?;
            named.set(&attribute.name, numbers.add(&rows, VERTICES, None).into());
        }
    }
    report.report_face_fields(shape, &[]);
    if !shape.edges.weights.is_empty() {
        report.report_dropped("weights of edges");
    }
    let mut primitives = Vec::new();
    let mut primitive =
        |corners: &[u32], mode: usize, numbers: &mut NumberBuffer| -> Result<(), WriteError> {
            let rows = corner_rows(corners, n, progress)?;
            let indices = numbers.add(&rows, INDICES, None);
            primitives.push(object([
                ("attributes", named.clone()),
                ("indices", indices.into()),
                ("mode", mode.into()),
            ]));
            Ok(())
        };
    let triangles = triangles(shape, report);
    if !triangles.is_empty() {
        primitive(triangles.as_flattened(), 4, &mut numbers)?;
    }
    if !shape.edges.pairs.is_empty() {
        primitive(shape.edges.pairs.as_flattened(), 1, &mut numbers)?;
    }
    if primitives.is_empty() {
        primitives.push(object([("attributes", named), ("mode", 0.into())]));
    }
    let mut node = object([("mesh", 0.into())]);
    if let Some(center) = center {
        node.set("translation", Json::List(center.map(Json::from_number).to_vec()));
    }
    let generator = concat!("adwave ", env!("CARGO_PKG_VERSION"));
    let mut json = object([("asset", object([("version", "2.0".into()), ("generator", generator.into())]))]);
    set_provenance(&mut json, shape.valid_provenance());
    if n > 0 {
        json.set("scene", 0.into());
        json.set("scenes", Json::List(vec![object([("nodes", Json::List(vec![0.into()]))])]));
        json.set("nodes", Json::List(vec![node]));
        json.set("meshes", Json::List(vec![object([("primitives", Json::List(primitives))])]));
        json.set("accessors", Json::List(numbers.accessors));
        json.set("bufferViews", Json::List(numbers.views));
        json.set("buffers", Json::List(vec![object([("byteLength", numbers.bytes.len().into())])]));
    }
    finish(json, vec![numbers.bytes], format, out, progress)
}

fn corner_rows(
    corners: &[u32],
    n_vertices: usize,
    progress: Progress<'_>,
) -> Result<EncodedRows, WriteError> {
    let is_short = n_vertices < usize::from(u16::MAX);
    let bytes = if is_short {
        collect(corners.len(), progress, |k| (corners[k] as u16).to_le_bytes())?.as_flattened().to_vec()
    } else {
        collect(corners.len(), progress, |k| corners[k].to_le_bytes())?.as_flattened().to_vec()
    };
    let value_type = if is_short { ValueType::U16 } else { ValueType::U32 };
    Ok(EncodedRows { bytes, count: corners.len(), n_channels: 1, value_type, is_normalized: false })
}

/// Writes the document with its buffers: the first buffer of a GLB follows the text, all others are embedded in it.
pub(crate) fn finish(
    mut json: Json,
    buffers: Vec<Vec<u8>>,
    format: Format,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let mut binary = Vec::new();
    if let Some(Json::List(list)) = json.get_mut("buffers") {
        for (k, (buffer, bytes)) in list.iter_mut().zip(buffers).enumerate() {
            progress.check()?;
            buffer.set("byteLength", bytes.len().into());
            buffer.remove("uri");
            if k == 0 && format == Format::GLB {
                binary = bytes;
            } else if !bytes.is_empty() {
                let encoded = base64::engine::general_purpose::STANDARD.encode(&bytes);
                buffer.set("uri", Json::Text(format!("data:application/octet-stream;base64,{encoded}")));
            }
        }
    }
    let text = json.to_text();
    if format == Format::GLTF {
        return Ok(out.write_all(&text)?);
    }
    let Some((head, n_padding)) = glb_head(&text, binary.len()) else {
        return Err(WriteError::CannotHold { format, what: "more than 4 GiB".into() });
    };
    out.write_all(&head)?;
    out.write_all(&binary)?;
    Ok(out.write_all(&[0; 4][..n_padding])?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadLimits, read_bytes, write_bytes};

    #[test]
    fn a_shape_far_from_the_origin_keeps_its_detail() {
        // Coordinates of a survey, in millimeters.
        let points = vec![[4_512_345.123, 5_401_234.456, 312.001], [4_512_346.125, 5_401_234.455, 312.002]];
        let shape = ShapeFile::from_cloud(points.clone());
        let mut bytes = Vec::new();
        write_bytes(&shape, Format::GLB, &mut bytes).unwrap();
        let again = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
        for (a, b) in points.as_flattened().iter().zip(again.points().as_flattened()) {
            assert!((a - b).abs() < 1e-6, "{a} became {b}");
        }
    }

    #[test]
    fn rows_of_vertices_begin_at_multiples_of_four() {
        let mut shape = ShapeFile::from_cloud(vec![[0.0; 3]; 3]);
        shape.add_vertex_field(Field::new("label", 3, FieldValues::U8((0..9).collect()))).unwrap();
        let mut bytes = Vec::new();
        write_bytes(&shape, Format::GLTF, &mut bytes).unwrap();
        assert!(String::from_utf8_lossy(&bytes).contains("\"byteStride\":4"));
        let again = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
        assert_eq!(again.vertex_fields(), shape.vertex_fields());
    }
}
