//! Tests of AMF and 3MF.

use std::io::Write;

use adwave::shape::Polygons;
use adwave_io::{Field, FieldValues, Format, ReadLimits, ShapeFile, read_bytes, read_path, write_bytes};
use adwave_test_data::data_test;

use crate::common;
use crate::meshes::{error, read, survives, written};

/// Archive of these texts.
fn zip(files: &[(&str, &str)]) -> Vec<u8> {
    let mut out = std::io::Cursor::new(Vec::new());
    let mut zip = zip::ZipWriter::new(&mut out);
    for (name, text) in files {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    out.into_inner()
}

fn model(unit: &str, resources: &str, build: &str) -> String {
    format!(
        "<model unit=\"{unit}\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" xmlns:m=\"m\" \
         xmlns:p=\"p\"><resources>{resources}</resources><build>{build}</build></model>"
    )
}

/// Triangle in the plane z = 0.
fn object(id: u32, of_object: &str, of_triangle: &str) -> String {
    format!(
        "<object id=\"{id}\" {of_object}><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>\
         <vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\" {of_triangle}/>\
         </triangles></mesh></object>"
    )
}

#[test]
fn a_3mf_places_objects_of_all_parts_in_its_unit() {
    let turned = "<component objectid=\"1\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 5\"/>";
    let other = "<component objectid=\"7\" p:path=\"/3D/more.model\"/>";
    let objects =
        format!("{}<object id=\"2\"><components>{turned}{other}</components></object>", object(1, "", ""));
    let build = "<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/>";
    let bytes = zip(&[
        ("3D/3dmodel.model", &model("millimeter", &objects, build)),
        ("3D/more.model", &model("centimeter", &object(7, "", ""), "")),
    ]);
    let file = read(&bytes, "a.3mf");
    assert_eq!((file.n_vertices(), file.faces().len(), file.format()), (9, 3, Some(Format::THREE_MF)));
    // Rotated by a quarter turn about z, lifted, then moved along x; the other part is ten times as large.
    assert_eq!(file.points()[4], [10.0, 1.0, 5.0]);
    assert_eq!(file.points()[5], [9.0, 0.0, 5.0]);
    assert_eq!(file.points()[7], [20.0, 0.0, 0.0]);
    assert_eq!(file.face_fields()[0].to_f64(), [0.0, 1.0, 2.0]);
}

#[test]
fn colors_of_a_3mf_are_those_of_vertices_or_of_faces() {
    let colors =
        "<m:colorgroup id=\"5\"><m:color color=\"#FF0000\"/><m:color color=\"#00FF0080\"/></m:colorgroup>";
    let part = |of_triangle: &str| {
        let objects = format!("{colors}{}", object(1, "pid=\"5\" pindex=\"1\"", of_triangle));
        read(&zip(&[("3D/3dmodel.model", &model("inch", &objects, "<item objectid=\"1\"/>"))]), "a.3mf")
    };
    let of_vertices = part("p1=\"0\" p2=\"1\" p3=\"0\"");
    assert_eq!(
        of_vertices.field("color").unwrap().values,
        FieldValues::U8(vec![255, 0, 0, 255, 0, 255, 0, 128, 255, 0, 0, 255])
    );
    assert_eq!(part("").face_fields()[0].values, FieldValues::U8(vec![0, 255, 0, 128]));
    assert_eq!(part("p1=\"0\"").face_fields()[0].values, FieldValues::U8(vec![255, 0, 0, 255]));
}

/// Six times the signed volume of a shape of triangles.
fn volume6(file: &ShapeFile) -> f64 {
    let points = file.points();
    let of_face = |face: &[u32]| {
        let [a, b, c]: [[f64; 3]; 3] = std::array::from_fn(|k| points[face[k] as usize]);
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    file.faces().iter().map(of_face).sum()
}

/// The matrix of each transform has the determinant that is given beside it.
#[test]
fn a_mirrored_solid_of_a_3mf_keeps_its_outside() {
    let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        .map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"))
        .concat();
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
        .map(|[a, b, c]| {
            format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" pid=\"5\" p1=\"{a}\" p2=\"{b}\" p3=\"{c}\"/>")
        })
        .concat();
    let colors = ["#000000", "#100000", "#200000", "#300000"]
        .map(|color| format!("<m:color color=\"{color}\"/>"))
        .concat();
    let solid = format!(
        "<m:colorgroup id=\"5\">{colors}</m:colorgroup><object id=\"1\"><mesh><vertices>{corners}</vertices>\
         <triangles>{faces}</triangles></mesh></object>"
    );
    let flip_x = "-1 0 0 0 1 0 0 0 1 5 0 0";
    for (item, component, determinant) in [
        ("1 0 0 0 1 0 0 0 1 0 0 0", "1 0 0 0 1 0 0 0 1 0 0 0", 1.0),
        (flip_x, "1 0 0 0 1 0 0 0 1 0 0 0", 1.0),
        ("1 0 0 0 1 0 0 0 1 0 0 0", flip_x, 1.0),
        (flip_x, flip_x, 1.0),
        ("0 1 0 1 0 0 0 0 2 1 2 3", "0 1 0 -1 0 0 0 0 1 0 0 0", 2.0),
        ("-1 0 0 0 -1 0 0 0 -1 0 0 7", "3 0 0 0 1 0 0 0 1 0 0 0", 3.0),
    ] {
        let placed = format!("<component objectid=\"1\" transform=\"{component}\"/>");
        let objects = format!("{solid}<object id=\"2\"><components>{placed}</components></object>");
        let build = format!("<item objectid=\"2\" transform=\"{item}\"/>");
        let file = read(&zip(&[("3D/3dmodel.model", &model("meter", &objects, &build))]), "a.3mf");
        let found = volume6(&file);
        assert!((found - determinant).abs() < 1e-12, "{item} of {component}: {found}");
        // Each vertex keeps its color.
        let reds: Vec<f64> = (0..4).map(|i| file.field("color").unwrap().get(i, 0)).collect();
        assert_eq!(reds, [0.0, 16.0, 32.0, 48.0]);
    }
}

#[test]
fn objects_are_written_as_objects() {
    let points: Vec<[f64; 3]> = (0..7).map(|i| [f64::from(i), f64::from(i * i), 0.0]).collect();
    let mut mesh = ShapeFile::from_mesh(points, Polygons::from_triangles(&[[0, 1, 2], [2, 1, 3], [4, 6, 5]]));
    mesh.add_face_field(Field::new("object", 1, FieldValues::U32(vec![0, 0, 1]))).unwrap();
    mesh.add_vertex_field(Field::new("color", 3, FieldValues::U8((0..21).collect()))).unwrap();
    for format in [Format::AMF, Format::THREE_MF] {
        let mut bytes = Vec::new();
        let report = write_bytes(&mesh, format, &mut bytes).unwrap();
        assert!(report.not_written.is_empty(), "{report:?}");
        let again = read(&bytes, "a");
        assert_eq!((again.points(), again.faces()), (mesh.points(), mesh.faces()));
        assert_eq!(again.face_fields()[0], mesh.face_fields()[0]);
        let scale = if format == Format::AMF { 255.0 } else { 1.0 };
        assert_eq!(again.field("color").unwrap().get(6, 2), 20.0 / scale);
    }
    // Objects that share vertices cannot be told apart.
    let faces = Polygons::from_triangles(&[[0, 1, 2], [2, 1, 3]]);
    let mut mesh = ShapeFile::from_mesh(mesh.points().to_vec(), faces);
    mesh.add_face_field(Field::new("object", 1, FieldValues::U32(vec![0, 1]))).unwrap();
    let report = write_bytes(&mesh, Format::THREE_MF, &mut Vec::new()).unwrap();
    assert_eq!(report.not_written, ["face field `object`"]);
}

#[test]
fn hostile_3mf_are_errors() {
    // Objects that place the previous one twice, thirty times over.
    let mut doubled = String::new();
    for id in 2..40 {
        let inner = format!("<component objectid=\"{}\"/>", id - 1).repeat(2);
        doubled += &format!("<object id=\"{id}\"><components>{inner}</components></object>");
    }
    let nested = |objects: &str, id: u32| {
        let build = format!("<item objectid=\"{id}\"/>");
        error(&zip(&[("3D/3dmodel.model", &model("meter", objects, &build))]), "a.3mf")
    };
    let message = nested(&format!("{}{doubled}", object(1, "", "")), 39);
    assert!(message.contains("exceeds the limit") || message.contains("nested too deeply"), "{message}");
    let circle = "<object id=\"1\"><components><component objectid=\"1\"/></components></object>";
    assert!(nested(circle, 1).contains("check whether"));
    assert!(nested(circle, 3).contains("the placed object 3 does not exist"));
    assert!(nested(&object(1, "", "").replace("v3=\"2\"", "v3=\"3\""), 1).contains("face 0 names vertex 3"));
    assert!(
        nested(&object(1, "", "").replace("x=\"1\"", "x=\"a\""), 1)
            .contains("`x` must be a number, got \"a\"")
    );
    assert!(error(&zip(&[("3D/a.model", "<model><resources>")]), "a.3mf").contains("the XML is malformed"));
    // A decompression bomb stops at the limit.
    let spaces = " ".repeat(1 << 22);
    let bytes = zip(&[("3D/3dmodel.model", &model("meter", &spaces, ""))]);
    assert!(bytes.len() < 1 << 17);
    let limits = ReadLimits { max_bytes: 1 << 20, ..ReadLimits::default() };
    let message = read_bytes(bytes, Some("a.3mf"), &limits).unwrap_err().to_string();
    assert!(message.contains("limit of 1048576"), "{message}");
    survives(&zip(&[("3D/3dmodel.model", &model("meter", &object(1, "", ""), ""))]), "a.3mf", |end, _| {
        panic!("cut at {end}")
    });
}

/// Two objects with colors everywhere; one of them is placed twice, the other not at all.
const AMF: &str = "<?xml version=\"1.0\"?><amf unit=\"inch\"><metadata type=\"name\">a</metadata>\
    <object id=\"a\"><mesh><vertices>\
    <vertex><coordinates><x>0</x><y>0</y><z>0</z></coordinates><color><r>1</r><g>0</g><b>0.5</b></color></vertex>\
    <vertex><coordinates><x>1</x><y>0</y><z>0</z></coordinates></vertex>\
    <vertex><coordinates><x>0</x><y>1</y><z>0</z></coordinates></vertex></vertices>\
    <volume materialid=\"m\"><triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle></volume>\
    <volume><triangle><color><r>0</r><g>0</g><b>1</b><a>0.5</a></color><v1>0</v1><v2>2</v2><v3>1</v3></triangle></volume>\
    </mesh></object><material id=\"m\"><color><r>0</r><g>1</g><b>0</b></color></material>\
    <constellation id=\"c\"><instance objectid=\"a\"><deltax>2</deltax><rz>90</rz></instance>\
    <instance objectid=\"a\"><deltaz>-1</deltaz></instance></constellation></amf>";

#[test]
fn an_amf_is_placed_and_colored() {
    let file = read(AMF.as_bytes(), "a.amf");
    assert_eq!((file.n_vertices(), file.faces().len(), file.format()), (6, 4, Some(Format::AMF)));
    let [x, y, z] = file.points()[1];
    assert!((x - 2.0).abs() < 1e-15 && y == 1.0 && z == 0.0, "{:?}", file.points()[1]);
    assert_eq!(file.points()[4], [1.0, 0.0, -1.0]);
    let color = file.field("color").unwrap();
    assert_eq!((color.n_channels, color.get(0, 2), color.get(1, 0).is_nan()), (3, 0.5, true));
    let names: Vec<&str> = file.face_fields().iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["object", "volume", "color"]);
    assert_eq!(file.face_fields()[1].to_f64(), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(file.face_fields()[2].get(0, 1), 1.0);
    assert_eq!(file.extras(), ["metadata", "materials"]);
    // The result is the same when zipped, and in UTF-16.
    let zipped = read(&zip(&[("a.amf", AMF)]), "a.amf");
    assert_eq!(
        (zipped.points(), zipped.face_fields()[0].to_f64()),
        (file.points(), file.face_fields()[0].to_f64())
    );
    let wide: Vec<u8> = [0xfeff].into_iter().chain(AMF.encode_utf16()).flat_map(u16::to_be_bytes).collect();
    assert_eq!(read(&wide, "a.amf").points(), file.points());
    survives(AMF.as_bytes(), "a.amf", |end, _| panic!("cut at {end}"));
    assert!(error(AMF.replace("<v3>2", "<v3>3").as_bytes(), "a.amf").contains("face 0 names vertex 3"));
}

#[test]
fn colors_are_written_and_other_fields_named() {
    let mut mesh = ShapeFile::from_mesh(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.1, 0.0]],
        Polygons::from_triangles(&[[0, 1, 2]]),
    );
    mesh.add_vertex_field(Field::new("color", 3, FieldValues::U8((0..9).collect()))).unwrap();
    mesh.add_vertex_field(Field::new("q", 1, FieldValues::U8(vec![0; 3]))).unwrap();
    for format in [Format::AMF, Format::THREE_MF] {
        let mut bytes = Vec::new();
        let report = write_bytes(&mesh, format, &mut bytes).unwrap();
        assert_eq!(report.not_written, ["vertex field `q`"]);
        let again = read(&bytes, "a");
        assert_eq!((again.points(), again.faces()), (mesh.points(), mesh.faces()));
        let scale = if format == Format::AMF { 255.0 } else { 1.0 };
        let colors: Vec<f64> = mesh.field("color").unwrap().to_f64().iter().map(|c| c / scale).collect();
        assert_eq!(again.field("color").unwrap().to_f64(), colors);
    }
    assert!(written(&mesh, Format::THREE_MF).starts_with(b"PK"));
}

/// Vertices and triangles as counted by `trimesh` in the first file, and by XML elements in the others.
#[data_test]
fn real_files() {
    let folder = common::test_inputs().join("formats/messy/assimp/models");
    for (name, n_vertices, n_faces) in [
        ("3MF/box.3mf", 8, 12),
        ("3MF/cube_gears_prod_req.3mf", GEARS.0, GEARS.1),
        ("AMF/test1.amf", 4, 4),
        ("AMF/test3.amf", 4, 4),
        ("AMF/test5.amf", 4, 4),
        ("AMF/test6.amf", 4, 4),
        ("AMF/test8.amf", 10, 16),
        ("AMF/test_with_mat.amf", 5, 8),
    ] {
        let file = read_path(&folder.join(name), &ReadLimits::default()).unwrap();
        assert_eq!((file.n_vertices(), file.faces().len()), (n_vertices, n_faces), "{name}");
        file.to_shape().unwrap();
    }
}

/// Total of the seventeen objects.
const GEARS: (usize, usize) = (12_864, 25_692);
