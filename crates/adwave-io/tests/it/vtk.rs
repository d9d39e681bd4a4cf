//! Tests of VTK, XML and legacy: encodings and kinds of cells, samples from other programs, damaged files.

use crate::common;

use std::io::Write;

use adwave::shape::Polygons;
use adwave_io::{
    Edges, Field, FieldValues, Format, GridLayout, ReadError, ReadLimits, ShapeFile, ValueType, read_bytes,
    read_path, write_bytes,
};
use adwave_test_data::data_test;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

fn read(bytes: impl Into<Vec<u8>>) -> Result<ShapeFile, ReadError> {
    read_bytes(bytes.into(), None, &ReadLimits::default())
}

fn faces(shape: &ShapeFile) -> Vec<Vec<u32>> {
    shape.faces().iter().map(<[u32]>::to_vec).collect()
}

/// Storage of the arrays in an XML file.
#[derive(Clone, Copy, Debug)]
struct Storage {
    is_big: bool,
    is_wide: bool,
    is_packed: bool,
    place: Place,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Ascii,
    Inline,
    Raw,
    Base64,
}

struct Writer {
    storage: Storage,
    appended: Vec<u8>,
}

impl Writer {
    fn number(&self, n: usize) -> Vec<u8> {
        match (self.storage.is_wide, self.storage.is_big) {
            (true, true) => (n as u64).to_be_bytes().to_vec(),
            (true, false) => (n as u64).to_le_bytes().to_vec(),
            (false, true) => (n as u32).to_be_bytes().to_vec(),
            (false, false) => (n as u32).to_le_bytes().to_vec(),
        }
    }

    /// Array with its numbers as text and as bytes.
    fn array(&mut self, kind: &str, name: &str, n: usize, text: &str, bytes: Vec<u8>) -> String {
        let open = format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{n}\" ");
        if self.storage.place == Place::Ascii {
            return format!("{open}format=\"ascii\">\n{text}\n</DataArray>\n");
        }
        let (head, body) = if self.storage.is_packed {
            let blocks: Vec<Vec<u8>> = bytes.chunks(20).map(zlib).collect();
            let mut head = [blocks.len(), 20, bytes.len() % 20].map(|n| self.number(n)).concat();
            for block in &blocks {
                head.extend(self.number(block.len()));
            }
            (head, blocks.concat())
        } else {
            (self.number(bytes.len()), bytes)
        };
        let encoded = if self.storage.is_packed {
            format!("{}{}", STANDARD.encode(&head), STANDARD.encode(&body))
        } else {
            STANDARD.encode([head.clone(), body.clone()].concat())
        };
        let at = self.appended.len();
        match self.storage.place {
            Place::Inline => return format!("{open}format=\"binary\">\n  {encoded}\n</DataArray>\n"),
            Place::Raw => self.appended.extend([head, body].concat()),
            _ => self.appended.extend(encoded.as_bytes()),
        }
        format!("{open}format=\"appended\" offset=\"{at}\"/>\n")
    }

    fn floats(&mut self, name: &str, n: usize, values: &[f64]) -> String {
        let bytes = |x: &f64| if self.storage.is_big { x.to_be_bytes() } else { x.to_le_bytes() };
        let bytes = values.iter().flat_map(bytes).collect();
        let text: Vec<String> = values.iter().map(ToString::to_string).collect();
        self.array("Float64", name, n, &text.join(" "), bytes)
    }

    fn whole(&mut self, name: &str, values: &[i16]) -> String {
        let bytes = |x: &i16| if self.storage.is_big { x.to_be_bytes() } else { x.to_le_bytes() };
        let bytes = values.iter().flat_map(bytes).collect();
        let text: Vec<String> = values.iter().map(ToString::to_string).collect();
        self.array("Int16", name, 1, &text.join("\n"), bytes)
    }

    fn file(self, kind: &str, attributes: &str, pieces: &str) -> Vec<u8> {
        let Storage { is_big, is_wide, is_packed, place } = self.storage;
        let order = if is_big { "BigEndian" } else { "LittleEndian" };
        let width = if is_wide { " header_type=\"UInt64\"" } else { "" };
        let packed = if is_packed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let mut bytes = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"0.1\" byte_order=\"{order}\"{width}{packed}>\n\
             <{kind} {attributes}>\n{pieces}</{kind}>\n"
        )
        .into_bytes();
        if matches!(place, Place::Raw | Place::Base64) {
            let encoding = if place == Place::Raw { "raw" } else { "base64" };
            bytes.extend(format!("<AppendedData encoding=\"{encoding}\">\n _").into_bytes());
            bytes.extend(self.appended);
            bytes.extend(b"\n</AppendedData>\n");
        }
        bytes.extend(b"</VTKFile>\n");
        bytes
    }
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    zlib.write_all(bytes).unwrap();
    zlib.finish().unwrap()
}

fn storages() -> Vec<Storage> {
    let mut all = Vec::new();
    for place in [Place::Ascii, Place::Inline, Place::Raw, Place::Base64] {
        for k in 0..8 {
            all.push(Storage { is_big: k & 1 > 0, is_wide: k & 2 > 0, is_packed: k & 4 > 0, place });
        }
    }
    all
}

const SQUARE: [f64; 12] = [0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

/// Square of two triangles, as strip and as polygons, with a line and values.
fn polydata(storage: Storage) -> Vec<u8> {
    let mut w = Writer { storage, appended: Vec::new() };
    let mut piece = |strip: bool| {
        let n = if strip { [0, 1, 1, 0] } else { [0, 0, 0, 2] };
        let cells = |w: &mut Writer, name: &str, corners: &[i16], ends: &[i16]| {
            format!("<{name}>{}{}</{name}>", w.whole("connectivity", corners), w.whole("offsets", ends))
        };
        let mut text = format!(
            "<Piece NumberOfPoints=\"4\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"{}\" NumberOfPolys=\"{}\">",
            n[0], n[1], n[2], n[3]
        );
        text += &format!("<PointData>{}</PointData>", w.floats("heat", 1, &[0.5, 1.5, -2.0, 1e300]));
        let values: &[i16] = if strip { &[0, 7] } else { &[8, 9] };
        text += &format!("<CellData>{}</CellData>", w.whole("part", values));
        text += &format!("<Points>{}</Points>", w.floats("Points", 3, &SQUARE));
        if strip {
            text += &cells(&mut w, "Lines", &[3, 0, 1], &[3]);
            text += &cells(&mut w, "Strips", &[0, 1, 3, 2], &[4]);
        } else {
            text += &cells(&mut w, "Polys", &[0, 1, 2, 3, 2, 0], &[3, 6]);
        }
        text + "</Piece>\n"
    };
    let pieces = piece(false) + &piece(true);
    w.file("PolyData", "", &pieces)
}

#[test]
fn pieces_are_joined_however_their_arrays_are_stored() {
    for storage in storages() {
        let bytes = polydata(storage);
        let shape = read(bytes.clone()).unwrap_or_else(|e| panic!("{storage:?}: {e}"));
        assert_eq!(shape.format(), Some(Format::VTP));
        let twice: Vec<f64> = SQUARE.iter().chain(&SQUARE).copied().collect();
        assert_eq!(shape.points().as_flattened(), twice, "{storage:?}");
        assert_eq!(faces(&shape), [[0, 1, 2], [3, 2, 0], [4, 5, 7], [7, 5, 6]]);
        assert_eq!(shape.edges().pairs, [[7, 4], [4, 5]]);
        assert_eq!(shape.field("heat").unwrap().get(7, 0), 1e300);
        assert_eq!(shape.face_fields()[0].values, FieldValues::I16(vec![8, 9, 7, 7]));
        assert_eq!(shape.extras(), [""; 0], "{storage:?}");
    }
}

#[test]
fn no_cut_or_changed_byte_is_more_than_an_error() {
    let mut seed = 7_u64;
    let mut random = |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    let mut files: Vec<Vec<u8>> = storages().into_iter().step_by(5).map(polydata).collect();
    let whole = files.len();
    files.extend(LEGACY.iter().map(|(text, ..)| text.as_bytes().to_vec()));
    for (k, bytes) in files.into_iter().enumerate() {
        let end = bytes.trim_ascii_end().len();
        for cut in 0..end {
            match read(&bytes[..cut]) {
                // A legacy file has no end mark.
                Ok(_) => assert!(k >= whole, "byte {cut} of {end}"),
                Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
            }
        }
        for _ in 0..400 {
            let mut broken = bytes.clone();
            for _ in 0..=random(4) {
                let at = random(broken.len());
                broken[at] = random(256) as u8;
            }
            if let Err(error) = read(broken) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
}

/// An unstructured grid of a hexahedron on a wedge, a quadratic triangle, a voxel, a separate tetrahedron, and a
/// line.
#[test]
fn of_volumes_the_boundary_is_taken_and_of_curved_cells_the_corners() {
    let mut points = Vec::new();
    for z in 0..3 {
        for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
            points.extend([f64::from(x), f64::from(y), f64::from(z)]);
        }
    }
    // The midpoints of the sides of a curved triangle 0 1 2, and a point without a cell.
    points.extend([0.5, -0.2, 0.0, 1.2, 0.5, 0.0, 0.5, 0.5, 0.0, 9.0, 9.0, 9.0]);
    let storage = Storage { is_big: false, is_wide: false, is_packed: false, place: Place::Raw };
    let mut w = Writer { storage, appended: Vec::new() };
    let corners = [0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 7, 6, 8, 9, 11, 10, 0, 1, 2, 12, 13, 14, 0, 4];
    let cells = w.whole("connectivity", &corners)
        + &w.whole("offsets", &[8, 16, 22, 24])
        + &w.whole("types", &[12, 11, 22, 3]);
    let values = w.whole("id", &[1, 2, 3, 0]);
    let piece = format!(
        "<Piece NumberOfPoints=\"16\" NumberOfCells=\"4\"><CellData>{values}</CellData><Points>{}</Points><Cells>{cells}</Cells></Piece>",
        w.floats("Points", 3, &points)
    );
    let shape = read(w.file("UnstructuredGrid", "", &piece)).unwrap();
    assert_eq!(shape.format(), Some(Format::VTU));
    // The three midpoints are dropped; points that no cell names stay.
    assert_eq!((shape.n_vertices(), shape.points()[12]), (13, [9.0; 3]));
    assert_eq!(shape.faces().len(), 1 + 5 + 5);
    assert_eq!(shape.faces().get(0), [0, 1, 2]);
    assert_eq!(shape.edges().pairs, [[0, 4]]);
    let ids = shape.face_fields()[0].to_f64();
    assert_eq!(ids, [3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0]);
    assert_eq!(shape.extras().len(), 2, "{:?}", shape.extras());
    // All faces point outwards: the faces of the volumes traverse each side once in each direction.
    let mut sides = std::collections::BTreeMap::new();
    for face in shape.faces().iter().skip(1) {
        for k in 0..face.len() {
            *sides.entry((face[k], face[(k + 1) % face.len()])).or_insert(0) += 1;
        }
    }
    assert!(sides.iter().all(|((a, b), n)| *n == 1 && sides.get(&(*b, *a)) == Some(&1)));
}

/// An image of 4 × 3 points in two pieces, with values `p` of the points if `has_points`, and `c` of the cells.
fn image_in_pieces(storage: Storage, has_points: bool) -> Vec<u8> {
    let mut w = Writer { storage, appended: Vec::new() };
    let mut pieces = String::new();
    for (first, last) in [(2, 3), (0, 2)] {
        let values: Vec<i16> = (0..3).flat_map(|j| (first..=last).map(move |i| 10 * j + i)).collect();
        let cells: Vec<i16> = (0..2).flat_map(|j| (first..last).map(move |i| 100 + 10 * j + i)).collect();
        let points = if has_points { w.whole("p", &values) } else { String::new() };
        pieces += &format!(
            "<Piece Extent=\"{first} {last} 5 7 0 0\"><PointData>{points}</PointData>\
             <CellData>{}</CellData></Piece>",
            w.whole("c", &cells)
        );
    }
    let attributes = "WholeExtent=\"0 3 5 7 0 0\" Origin=\"1 0 0\" Spacing=\"0.5 2 0\"";
    w.file("ImageData", attributes, &pieces)
}

#[test]
fn images_in_pieces_are_one() {
    for storage in storages() {
        let bytes = image_in_pieces(storage, true);
        let mut shape = read(&bytes[..]).unwrap();
        let grid = shape.grid().unwrap();
        assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[3, 4][..], &[2.0, 0.5][..]));
        assert_eq!((grid.position(0), grid.position(11)), ([1.0, 10.0, 0.0], [2.5, 14.0, 0.0]));
        let expected = (0..12).map(|k| 10 * (k / 4) + k % 4).collect();
        assert_eq!(shape.field("values").unwrap().values, FieldValues::I16(expected), "{storage:?}");
        assert_eq!(shape.extras(), ["values of cells in `c`"]);
        let mut same = Vec::new();
        write_bytes(&shape, Format::VTI, &mut same).unwrap();
        assert!(same == bytes);
        // With other values it is a new file in one piece, in which the array keeps its name and type.
        let field = shape.field("values").unwrap().to_f64().iter().map(|x| x + 1.0).collect();
        shape.add_vertex_field(Field::new("values", 1, FieldValues::F64(field))).unwrap();
        shape.set_value_type(Some(ValueType::I16));
        let mut new = Vec::new();
        let report = write_bytes(&shape, Format::VTI, &mut new).unwrap();
        assert_eq!(report.not_written, ["values of cells in `c`"]);
        assert!(new.windows(26).any(|part| part == b"type=\"Int16\" Name=\"p\" Numb"));
        let again = read(new).unwrap();
        assert_eq!((again.grid(), again.field("values").unwrap().get(0, 0)), (shape.grid(), 1.0));
        let cells = read(image_in_pieces(storage, false)).unwrap();
        let grid = cells.grid().unwrap();
        assert_eq!((&grid.sizes[..], grid.origin), (&[2, 3][..], [1.25, 11.0, 0.0]));
        let expected = FieldValues::I16(vec![100, 101, 102, 110, 111, 112]);
        assert_eq!(cells.field("values").unwrap().values, expected);
        assert!(cells.notes()[0].contains("values of cells alone"), "{:?}", cells.notes());
    }
    let storage = Storage { is_big: true, is_wide: true, is_packed: true, place: Place::Base64 };
    let half = read(Writer { storage, appended: Vec::new() }.file(
        "ImageData",
        "WholeExtent=\"0 9 0 9 0 9\"",
        "<Piece Extent=\"0 9 0 9 0 4\"/><Piece Extent=\"0 9 0 9 0 3\"/>",
    ));
    assert!(half.unwrap_err().to_string().contains("do not fill"));
}

/// A volume of 3 × 2 × 2 points with values `t`, vectors `v`, ghosts and a further text.
fn volume(storage: Storage) -> Vec<u8> {
    let mut w = Writer { storage, appended: Vec::new() };
    let values: Vec<f64> = (0..12).map(|i| f64::from(i) / 8.0).collect();
    let vectors: Vec<f64> = (0..36).map(f64::from).collect();
    let vectors = w.floats("v", 3, &vectors).replace("Name=\"v\"", "ComponentName0=\"u\" Name=\"v\"");
    let whole: Vec<i16> = (0..12).collect();
    let arrays = [vectors, w.floats("t", 1, &values), w.whole("values", &whole)].concat();
    let cells = w.whole("c", &[7, 8]);
    let ghosts = "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">0 2 0 1 0 0 0 0 0 0 0 0</DataArray>";
    let piece = format!(
        "<Piece Extent=\"1 3 0 1 -1 0\"><PointData Scalars=\"t\">{arrays}{ghosts}</PointData>\
         <CellData><!-- kept -->{cells}</CellData></Piece>"
    );
    let attributes =
        "WholeExtent=\"1 3 0 1 -1 0\" Origin=\"1 2 3\" Spacing=\"0.5 2 3\" Direction=\"0 -1 0 1 0 0 0 0 1\"";
    w.file("ImageData", attributes, &piece)
}

#[test]
fn an_edited_image_keeps_everything_else_in_its_encoding() {
    for storage in storages() {
        let bytes = volume(storage);
        let shape = read(&bytes[..]).unwrap();
        let grid = shape.grid().unwrap();
        assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[2, 2, 3][..], &[3.0, 2.0, 0.5][..]));
        assert_eq!((grid.origin, grid.position(1)), ([1.0, 2.5, 0.0], [1.0, 3.0, 0.0]));
        assert_eq!(grid.position(3), [-1.0, 2.5, 0.0]);
        assert_eq!(shape.field_names(), ["v", "values", "values_2", "vtkGhostType"]);
        assert_eq!(grid.kept.as_ref().unwrap().iter().position(|kept| !kept), Some(1), "a hidden point");
        let mut values = shape.field("values").unwrap().to_f64();
        assert!(values[1].is_nan() && values[11] == 1.375);
        values[11] = -1.0;
        let mut edited = shape.clone();
        edited.add_vertex_field(Field::new("values", 1, FieldValues::F64(values.clone()))).unwrap();
        let mut out = Vec::new();
        write_bytes(&edited, Format::VTI, &mut out).unwrap();
        let again = read(&out[..]).unwrap();
        assert_eq!((again.grid(), again.extras()), (shape.grid(), shape.extras()));
        let found = again.field("values").unwrap();
        assert_eq!(found.values.value_type(), ValueType::F64);
        assert_eq!((found.get(0, 0), found.get(11, 0)), (0.0, -1.0));
        for name in ["v", "values_2"] {
            assert_eq!(again.field(name), shape.field(name), "{storage:?}");
        }
        // The number at the hidden point is still there.
        let seen = read(String::from_utf8_lossy(&out).replace("vtkGhostType", "ghost_types!"));
        if storage.place != Place::Raw {
            assert_eq!(seen.unwrap().field("values").unwrap().get(1, 0), 0.125);
        }
        let text = String::from_utf8_lossy(&out);
        assert!(text.contains("<!-- kept -->") && text.contains("ComponentName0=\"u\""));
        // A further field in another type, and a new one.
        let mut more = shape.clone();
        more.set_value_type(Some(ValueType::F32));
        let vectors = FieldValues::F64((0..24).map(|i| f64::from(i) / 4.0).collect());
        more.add_vertex_field(Field::new("v", 2, vectors)).unwrap();
        more.add_vertex_field(Field::new("new", 1, FieldValues::F64(values))).unwrap();
        let mut out = Vec::new();
        write_bytes(&more, Format::VTI, &mut out).unwrap();
        assert!(!String::from_utf8_lossy(&out).contains("ComponentName0"));
        let again = read(out).unwrap();
        assert_eq!(
            again.field("v").unwrap().values,
            FieldValues::F32((0..24).map(|i| i as f32 / 4.0).collect())
        );
        assert_eq!(again.field("new").unwrap().get(11, 0), -1.0);
        assert_eq!(again.field("values_2"), shape.field("values_2"));
    }
}

#[test]
fn new_images_have_the_axes_of_their_grids() {
    let plane = |steps: [[f64; 3]; 2]| {
        let mut layout = GridLayout::new(&[2, 3], &[2.0, 0.5]);
        (layout.steps, layout.origin) = (steps.to_vec(), [1.0, 2.0, 3.0]);
        let mut shape = ShapeFile::from_grid(layout).unwrap();
        let values = FieldValues::F32(vec![0.0, 1.0, 2.0, 3.0, f32::NAN, 5.0]);
        shape.add_vertex_field(Field::new("values", 1, values)).unwrap();
        let mut bytes = Vec::new();
        write_bytes(&shape, Format::VTI, &mut bytes).unwrap();
        let again = read(&bytes[..]).unwrap();
        for place in 0..6 {
            let (a, b) = (shape.grid().unwrap().position(place), again.grid().unwrap().position(place));
            assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-14), "{a:?} {b:?}");
        }
        assert_eq!(again.grid().unwrap().n_missing(), 1);
        assert_eq!(again.field("values").unwrap().values.value_type(), ValueType::F32);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let at = text.find("WholeExtent").unwrap();
        text[at..at + text[at..].find('>').unwrap()].to_owned()
    };
    let origin = "Origin=\"1 2 3\"";
    // The usual image, the plane of x and z, a picture whose rows go down, and a plane that is turned.
    for (steps, expected) in [
        (
            [[0.0, 2.0, 0.0], [0.5, 0.0, 0.0]],
            "0 2 0 1 0 0\" {} Spacing=\"0.5 2 1\" Direction=\"1 0 0 0 1 0 0 0 1",
        ),
        (
            [[0.0, 0.0, 2.0], [0.5, 0.0, 0.0]],
            "0 2 0 0 0 1\" {} Spacing=\"0.5 1 2\" Direction=\"1 0 0 0 1 0 0 0 1",
        ),
        (
            [[0.0, -2.0, 0.0], [0.5, 0.0, 0.0]],
            "0 2 0 1 0 0\" {} Spacing=\"0.5 2 1\" Direction=\"1 0 0 0 -1 0 0 0 -1",
        ),
        (
            [[1.2, 1.6, 0.0], [-0.4, 0.3, 0.0]],
            "0 2 0 1 0 0\" {} Spacing=\"0.5 2 1\" Direction=\"-0.8 0.6 0 0.6 0.8 0 0 0 -1",
        ),
    ] {
        let found = plane(steps).replace("-0 ", "0 ");
        assert!(found.contains(&expected.replace("{}", origin)), "{found}");
    }
    for (axis, step) in [[3.0, 0.0, 0.0], [0.0, 0.0, 3.0], [1.0, 2.0, 2.0]].into_iter().enumerate() {
        let mut layout = GridLayout::new(&[4], &[3.0]);
        layout.steps = vec![step];
        let mut shape = ShapeFile::from_grid(layout).unwrap();
        shape.add_vertex_field(Field::new("values", 2, FieldValues::I64((0..8).collect()))).unwrap();
        let mut bytes = Vec::new();
        write_bytes(&shape, Format::VTI, &mut bytes).unwrap();
        let again = read(bytes).unwrap();
        assert_eq!(again.grid().unwrap().steps, [step], "{axis}");
        assert_eq!(again.field("values"), shape.field("values"));
    }
}

#[test]
fn faults_of_images_are_told() {
    let image = |attributes: &str, section: &str| {
        let text = format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 0\" {attributes}><Piece Extent=\"0 1 0 1 0 0\">\
             {section}</Piece></ImageData></VTKFile>"
        );
        read(text).map(|_| ()).map_err(|e| e.to_string())
    };
    let array = |values: &str| {
        format!(
            "<PointData><DataArray type=\"Float32\" Name=\"a\" format=\"ascii\">{values}</DataArray></PointData>"
        )
    };
    let four = array("1 2 3 4");
    assert_eq!(image("Spacing=\"1 1 0\"", &four), Ok(()), "the spacing of no axis");
    for (attributes, section, expected) in [
        ("Spacing=\"0 1 1\"", &four, "the spacing along x must be a number above 0, got 0"),
        ("Spacing=\"1 -1 1\"", &four, "the spacing along y must be a number above 0, got -1"),
        ("Spacing=\"1 nan 1\"", &four, "the spacing along y must be a number above 0, got NaN"),
        ("Spacing=\"1 1\"", &four, "Spacing must be 3 numbers"),
        ("Origin=\"0 inf 0\"", &four, "the position of the first place must be finite"),
        (
            "Direction=\"1 0 0 0 0 0 0 0 1\"",
            &four,
            "the direction of the axis y must be a vector with a length",
        ),
        ("Direction=\"1 0 0 0 1e300 0 0 0 1\" Spacing=\"1 1e300 1\"", &four, "the direction of the axis y"),
        ("", &array("1 2 3"), "array \"a\" needs 1 values for each of 4 points, got 3"),
        ("", &array("1 2 3 4 5"), "must have an array of numbers at its points or cells, got none"),
        ("", &String::new(), "must have an array of numbers at its points or cells, got none"),
    ] {
        let message = image(attributes, section).unwrap_err();
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
    }
    let lying = read(
        String::from_utf8_lossy(&volume(storages()[0]))
            .replace("Extent=\"1 3", "Extent=\"-2147483648 2147483647"),
    );
    assert!(lying.unwrap_err().to_string().contains("exceeds the limit"));
    let empty = read(String::from_utf8_lossy(&volume(storages()[0])).replace("Extent=\"1 3", "Extent=\"3 1"));
    assert!(empty.unwrap_err().to_string().contains("the grid is empty"));
}

#[test]
fn claims_make_no_room() {
    let file = |kind: &str, attributes: &str, piece: &str| {
        let text = format!(
            "<VTKFile type=\"{kind}\" byte_order=\"LittleEndian\"><{kind} {attributes}>{piece}</{kind}></VTKFile>"
        );
        read(text).unwrap_err().to_string()
    };
    let large = "WholeExtent=\"0 999999 0 0 0 1000\"";
    let none = "must have an array of numbers at its points or cells, got none";
    assert!(file("ImageData", large, "<Piece Extent=\"0 999999 0 0 0 1000\"/>").contains(none));
    let pieces = "<Piece Extent=\"0 999999 0 0 0 1000\"/>".repeat(2);
    assert!(
        file("ImageData", large, &pieces).contains("a grid without values may have at most 262144 points")
    );
    let huge = "WholeExtent=\"0 2000000000 0 2000000000 0 9\"";
    assert!(file("ImageData", huge, "<Piece Extent=\"0 2000000000 0 2000000000 0 9\"/>").contains("limit"));
    assert!(file("PolyData", "", "<Piece NumberOfPoints=\"4000000000\"/>").contains("no coordinates"));
    // A block table that states more than zlib can decompress to.
    let head: Vec<u8> = [1_u32, 1 << 30, 0, 9].iter().flat_map(|n| n.to_le_bytes()).collect();
    let text = STANDARD.encode([head, zlib(&[0; 12])].concat());
    let bomb = format!(
        "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData><Piece NumberOfPoints=\"1\"><Points>\
         <DataArray type=\"Float32\" format=\"binary\">{text}</DataArray></Points></Piece></PolyData></VTKFile>"
    );
    let error = read(bomb).unwrap_err().to_string();
    assert!(error.contains("table of compressed blocks"), "{error}");
}

#[test]
fn what_cannot_be_read_says_so() {
    for (text, expected) in [
        ("<VTKFile type=\"PPolyData\"><PPolyData/></VTKFile>", "only refers to other files"),
        ("<VTKFile type=\"HyperTreeGrid\"/>", "VTK XML of an unknown kind"),
        ("<VTKFile header_type=\"UInt64\" type=\"PolyData\"><PolyData/></VTKFile>", "no piece"),
        ("<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\"><PolyData/></VTKFile>", "LZ4"),
        ("<VTKFile type=\"PolyData\"><PolyData/></VTKFile>", "no piece"),
        ("# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nWAVES 3\n", "line 5: the keyword \"WAVES\""),
        (
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0\n",
            "needs 9 numbers, got 5",
        ),
        (
            "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 1 4 3 0 0 1\n",
            "line 7: face 0 names vertex 1",
        ),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

type Names = &'static [&'static str];

/// Texts with the numbers of vertices, faces and edges, and the fields of vertices and faces.
const LEGACY: &[(&str, [usize; 3], Names, Names)] = &[
    (
        "# vtk DataFile Version 1.0\nold\nASCII\nDATASET POLYDATA\nPOINTS 4 int\n0 0 0  1 0 0\n1 1 0  0 1 0\n\
         LINES 1 4\n3 0 1 2\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\nPOLYGONS 1 4\n3 2 3 0\nVERTICES 1 2\n1 0\nCELL_DATA 4\n\
         SCALARS part int\nLOOKUP_TABLE default\n0 0 5 6\nPOINT_DATA 4\nNORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1\n\
         COLOR_SCALARS rgb 3\n0 0 0 1 1 1 0.2 0.4 0.6 0 0 1\nTENSORS t double\n\
         1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1\n",
        [4, 3, 2],
        &["n", "rgb", "t"],
        &["part"],
    ),
    (
        "# vtk DataFile Version 5.1\nnew\nASCII\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n0.5\n\
         POINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n\
         0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3\n1 2 3 4\n\nCELL_TYPES 2\n10\n10\nPOINT_DATA 5\nFIELD FieldData 2\n\
         a%20b 2 5 vtktypeint64\n1 2 3 4 5 6 7 8 9 9007199254740993\nwords 1 5 string\na\nb c\n\nd\ne\n",
        [5, 6, 0],
        &["a b"],
        &[],
    ),
    (
        "# vtk DataFile Version 3.0\ngrid\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 3 1\nX_COORDINATES 2 float\n0 1\n\
         Y_COORDINATES 3 float\n0 1 3\nZ_COORDINATES 1 float\n7\nCELL_DATA 2\nSCALARS c unsigned_char 2\n\
         LOOKUP_TABLE mine\n1 2 3 4\nLOOKUP_TABLE mine 1\n0 0 0 1\n",
        [6, 2, 0],
        &[],
        &["c"],
    ),
    (
        "# vtk DataFile Version 3.0\ngrid\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 1 1 1\n\
         SPACING 1 1 2\nPOINT_DATA 8\nSCALARS s bit\nLOOKUP_TABLE default\n0 1 0 1 0 1 1 1\n",
        [8, 0, 0],
        &["values"],
        &[],
    ),
];

#[test]
fn legacy_texts() {
    for (text, counts, of_vertices, of_faces) in LEGACY {
        let shape = read(*text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(shape.format(), Some(Format::VTK));
        assert_eq!([shape.n_vertices(), shape.faces().len(), shape.edges().pairs.len()], *counts, "{text}");
        assert_eq!(shape.field_names(), *of_vertices);
        assert_eq!(shape.face_fields().iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), *of_faces);
    }
    let old = read(LEGACY[0].0).unwrap();
    // Polygons precede strips among the cells, regardless of their order in the file.
    assert_eq!(faces(&old), [[2, 3, 0], [0, 1, 3], [3, 1, 2]]);
    assert_eq!(old.face_fields()[0].to_f64(), [5.0, 6.0, 6.0]);
    assert_eq!(
        old.field("rgb").unwrap().values,
        FieldValues::U8(vec![0, 0, 0, 255, 255, 255, 51, 102, 153, 0, 0, 255])
    );
    let new = read(LEGACY[1].0).unwrap();
    let FieldValues::I64(values) = &new.field("a b").unwrap().values else { panic!("another type") };
    assert_eq!(values[9], 9_007_199_254_740_993);
    assert!(
        new.extras().iter().any(|e| e.contains("TIME")) && new.extras().iter().any(|e| e.contains("words"))
    );
}

#[test]
fn edges_and_values_of_faces_are_written_together() {
    let faces: Polygons = [&[0_u32, 1, 2][..], &[0, 2, 3]].into_iter().collect();
    let points: Vec<[f64; 3]> = SQUARE.as_chunks().0.to_vec();
    let mut mesh = ShapeFile::from_mesh(points, faces);
    mesh.add_face_field(Field::new("part", 1, FieldValues::U8(vec![3, 4]))).unwrap();
    mesh.add_face_field(Field::new("area", 1, FieldValues::F32(vec![0.5, 0.25]))).unwrap();
    let line = Edges { pairs: vec![[0, 1]], ..Edges::default() };
    for format in [Format::VTP, Format::VTU, Format::VTK] {
        let text = "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\nLINES 1 3\n2 0 1\n\
                    POLYGONS 1 4\n3 0 1 2\nCELL_DATA 2\nSCALARS part int\nLOOKUP_TABLE default\n0 9\n";
        let shape = read(text).unwrap();
        let mut bytes = Vec::new();
        assert_eq!(write_bytes(&shape, format, &mut bytes).unwrap().not_written, [""; 0]);
        let again = read(bytes).unwrap();
        assert_eq!((again.format(), again.edges()), (Some(format), &line));
        assert_eq!(again.face_fields(), shape.face_fields());
        assert_eq!(again.extras(), [""; 0]);
        let mut bytes = Vec::new();
        write_bytes(&mesh, format, &mut bytes).unwrap();
        assert_eq!(read(bytes).unwrap().face_fields(), mesh.face_fields());
    }
}

/// Vertices, faces and edges as counted by VTK 9 (`extract_surface` of PyVista, equal points of grids merged); of images
/// and volumes the points, or the cells if there are only values of these.
const SAMPLES: &[(&str, [usize; 3])] = &[
    ("formats/fields/pyvista-examples/channels.vti", [6_250_000, 0, 0]),
    ("formats/fields/pyvista-examples/frog_tissues.vti", [31_960_000, 0, 0]),
    ("formats/fields/pyvista-examples/globe.vtk", [540, 980, 0]),
    ("formats/fields/pyvista-examples/hexbeam.vtk", [90, 88, 0]),
    ("formats/fields/pyvista-examples/rectilinear.vtk", [3844, 3842, 0]),
    ("formats/fields/pyvista-examples/uniform.vtk", [1000, 0, 0]),
    ("formats/messy/threejs-copy/vtk/cube_binary.vtp", [24, 6, 0]),
    ("messy/vtkio/assets/RectilinearGridAppendedBase64.vtr", [16, 14, 0]),
    ("messy/vtkio/assets/RectilinearGridCompressed.vtr", [16, 14, 0]),
    ("messy/vtkio/assets/RectilinearGridInlineBinary.vtr", [16, 14, 0]),
    ("messy/vtkio/assets/RectilinearGridRawBinary.vtr", [16, 14, 0]),
    ("messy/vtkio/assets/RectilinearGrid_ascii.vtr", [16, 14, 0]),
    ("messy/vtkio/assets/box.vtu", [8, 6, 0]),
    ("messy/vtkio/assets/box_para.vtu", [8, 6, 0]),
    ("messy/vtkio/assets/cube_complex_topo.vtk", [8, 6, 0]),
    ("messy/vtkio/assets/hexahedron_ascii.vtu", [8, 6, 0]),
    ("messy/vtkio/assets/hexahedron_inline_binary.vtu", [8, 6, 0]),
    ("messy/vtkio/assets/hexahedron_zlib.vtu", [8, 6, 0]),
    ("messy/vtkio/assets/para_test.vtk", [12, 12, 0]),
    ("messy/vtkio/assets/para_tet_ascii.vtk", [4, 4, 0]),
    ("messy/vtkio/assets/point_cloud.vtp", [3, 0, 0]),
    ("messy/vtkio/assets/polyEx0.vtp", [8, 6, 0]),
    ("messy/vtkio/assets/pygmsh/binary.vtk", [18, 22, 12]),
    ("messy/vtkio/assets/pygmsh/no-compression.vtu", [18, 22, 12]),
    ("messy/vtkio/assets/pygmsh/zlib.vtu", [18, 22, 12]),
    ("messy/vtkio/assets/structured_grid.vtk", [8, 6, 0]),
    ("messy/vtkio/assets/tri_attrib_binary.vtk", [3, 1, 0]),
    ("messy/vtkio/assets/triangle_vtkidtype.vtk", [3, 1, 0]),
    // One of its tetrahedra has points of a volume that VTK keeps.
    ("messy/vtkio/assets/unstructured_grid_complex.vtk", [27, 30, 1]),
    ("messy/vtkio/assets/volume_complex.vti", [72, 0, 0]),
    ("messy/vtkio/assets/volume_complex.vtk", [72, 0, 0]),
];

#[data_test]
fn samples_of_others() {
    for (name, counts) in SAMPLES {
        let path = common::test_inputs().join(name);
        let shape = read_path(&path, &ReadLimits::default()).unwrap();
        let found = [shape.n_vertices(), shape.faces().len(), shape.edges().pairs.len()];
        assert_eq!(found, *counts, "{name}");
    }
    let field = |name: &str, field: &str| {
        let shape = read_path(&common::test_inputs().join(name), &ReadLimits::default()).unwrap();
        let of_faces = shape.face_fields().iter().chain(shape.vertex_fields());
        of_faces.into_iter().find(|f| f.name == field).unwrap().values.clone()
    };
    assert_eq!(
        field("messy/vtkio/assets/triangle_vtkidtype.vtk", "vtkOriginalPointIds").to_f64(),
        [95364.0, 95538.0, 95691.0]
    );
    let facies = field("formats/fields/pyvista-examples/channels.vti", "values");
    assert!(facies.to_f64().iter().all(|x| (0.0..=4.0).contains(x)));
}
