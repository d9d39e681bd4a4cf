//! Tests of unusual files found in practice, and of error messages.

use std::fmt::Write;

use adwave_io::{
    CoordinatePrecision, FieldValues, Format, ReadError, ReadLimits, ShapeFile, read_bytes, write_bytes,
};

fn read(text: impl AsRef<[u8]>, name: &str) -> ShapeFile {
    read_bytes(text.as_ref().to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn error(text: impl AsRef<[u8]>, name: &str) -> String {
    read_bytes(text.as_ref().to_vec(), Some(name), &ReadLimits::default()).unwrap_err().to_string()
}

fn written(shape: &ShapeFile, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_bytes(shape, format, &mut bytes).unwrap();
    bytes
}

#[test]
fn obj_statements_may_be_continued() {
    let shape = read("v 0 0 \\\r\n0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 \\\n 2 \\\n 3  \r\n", "a.obj");
    assert_eq!((shape.n_vertices(), shape.faces().get(0)), (3, &[0, 1, 2][..]));
}

#[test]
fn obj_comments_are_not_continued() {
    let shape = read("# C:\\models\\\nv 1 2 3\n", "a.obj");
    assert_eq!(shape.points(), [[1.0, 2.0, 3.0]]);
}

#[test]
fn obj_indices_may_count_backwards_and_from_before_the_vertices() {
    let shape =
        read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 2 -1\nf 1 2 5\nv 9 9 9\n", "a.obj");
    let faces: Vec<&[u32]> = shape.faces().iter().collect();
    assert_eq!(faces, [[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
}

#[test]
fn obj_edit_keeps_groups_comments_and_line_ends() {
    let text = "\u{feff}# é\r\nmtllib a b.mtl\r\nv 0.10 1 2 # first\r\nv 3 4 5 0.5 0.5 1\r\nvn 0 0 1\r\ng x\r\nusemtl m\r\ns 1\r\nf 1//1 2//1 1//1\r\n";
    let mut shape = read(text, "a.obj");
    assert_eq!(written(&shape, Format::OBJ), text.as_bytes());
    shape.set_points(vec![[0.1, 1.0, 2.5], [3.0, 4.0, 5.0]]).unwrap();
    assert_eq!(written(&shape, Format::OBJ), text.replace("1 2 #", "1 2.5 #").as_bytes());
}

#[test]
fn obj_errors_name_line_and_token() {
    assert_eq!(
        error("v 0 0 0\nv 1 x2 0\n", "a.obj"),
        "line 2: a vertex must have numbers, got \"x2\"; correct it"
    );
    assert_eq!(
        error("v 0 0 0\n\nf 1 2 3\n", "a.obj"),
        "line 3: face 0 names vertex 2, but there are 1; correct the face"
    );
    assert_eq!(
        error("v 1 2 3\nv 1 2\n", "a.obj"),
        "line 2: a vertex needs 3 numbers, got 2; add the missing ones"
    );
    assert!(error("v 0 0 0\nl 1 7\n", "a.obj").starts_with("line 2: "));
}

#[test]
fn obj_pieces_join_in_order() {
    // Large enough for several chunks, with negative indices across their borders.
    let n = 60_000;
    let mut text = String::new();
    for i in 0..n {
        writeln!(text, "v {i} 0.25 -1e-3").unwrap();
        if i > 2 {
            text += "f -1 -2 -4\n";
        }
    }
    assert!(text.len() > 1 << 20);
    let shape = read(&text, "a.obj");
    assert!(shape.points().iter().enumerate().all(|(i, p)| *p == [i as f64, 0.25, -1e-3]));
    assert!(shape.faces().iter().enumerate().all(|(f, c)| c == [f as u32 + 3, f as u32 + 2, f as u32]));
    assert_eq!(written(&shape, Format::OBJ), text.as_bytes());
    assert!(error(text + "v 0 0\n", "a.obj").starts_with(&format!("line {}: ", 2 * n - 3 + 1)));
}

#[test]
fn content_overrules_the_name() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0.1 2 3\n";
    let shape = read(ply, "a.obj");
    assert_eq!((shape.format(), shape.precision()), (Some(Format::PLY_ASCII), CoordinatePrecision::F32));
    assert_eq!(shape.points(), [[f64::from(0.1_f32), 2.0, 3.0]]);
    assert_eq!(read("v 1 2 3\n", "a.stl").format(), Some(Format::OBJ));
    assert_eq!(read("1 2 3\n", "a.obj").format(), Some(Format::XYZ));
    assert!(error("newmtl a\n", "a.obj").contains("a material library"));
    assert!(error("import numpy\n", "a.py").contains("formats that can be read: obj, ply"));
    assert!(error("", "a.obj").contains("is empty"));
}

#[test]
fn gzip_is_read_whatever_the_name() {
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut gz, b"OFF\n1 0 0\n1 2 3\n").unwrap();
    assert_eq!(read(gz.finish().unwrap(), "a.bin").points(), [[1.0, 2.0, 3.0]]);
}

#[test]
fn a_header_of_four_thousand_million_vertices_fails_at_once() {
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\nproperty double y\nproperty double z\nend_header\n0123456789";
    let message = error(ply, "a.ply");
    assert!(message.starts_with(&format!("the file ends at byte {} of 96000000", ply.len())), "{message}");
    assert!(message.contains("element `vertex`, row 0"), "{message}");
    for text in [
        "OFF\n4000000000 1 0\n0 0 0\n",
        "%%MatrixMarket matrix coordinate real general\n4000000000 4000000000 1\n1 1 1\n",
        "FIELDS x y z\nPOINTS 4000000000\nDATA binary\n",
    ] {
        assert!(!error(text, "a").contains('\n'));
    }
    let limits = ReadLimits { max_points: 2, ..ReadLimits::default() };
    let three = b"v 0 0 0\nv 0 0 0\nv 0 0 0\n".to_vec();
    assert!(matches!(read_bytes(three, None, &limits), Err(ReadError::Limit { found: 3, limit: 2, .. })));
}

#[test]
fn ply_keeps_elements_properties_and_comments() {
    let text = "ply\nformat ascii 1.0\ncomment made by hand\nelement material 1\nproperty list uchar int ids\nelement vertex 2\nproperty uchar red\nproperty float z\nproperty list uchar short flags\nproperty float y\nproperty float x\nproperty uchar green\nproperty uchar blue\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nproperty float crease\nend_header\n2 4 5\n255 3.0 1 7 2.50 1 0 9\n1 6 0 5 4 2 3\n0 1 0.5\n";
    let mut shape = read(text, "a.ply");
    assert_eq!(shape.points(), [[1.0, 2.5, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(shape.field("color").unwrap().values, FieldValues::U8(vec![255, 0, 9, 1, 2, 3]));
    assert_eq!(shape.edges().pairs, [[0, 1]]);
    assert_eq!(written(&shape, Format::PLY_ASCII), text.as_bytes());
    shape.set_points(vec![[1.0, 2.5, 3.5], [4.0, 5.0, 6.0]]).unwrap();
    assert_eq!(written(&shape, Format::PLY_ASCII), text.replace("255 3.0", "255 3.5").as_bytes());
    shape.add_vertex_field(adwave_io::Field::new("saliency", 1, FieldValues::F32(vec![0.5, 0.1]))).unwrap();
    let more = String::from_utf8(written(&shape, Format::PLY_ASCII)).unwrap();
    assert!(more.contains("property uchar blue\nproperty float saliency\nelement edge"), "{more}");
    assert!(more.contains("255 3.5 1 7 2.50 1 0 9 0.5\n1 6 0 5 4 2 3 0.1\n0 1 0.5\n"), "{more}");
}

#[test]
fn ply_strips_become_triangles() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 2\n8 0 1 2 3 -1 2 3 4\n";
    let faces: Vec<Vec<u32>> = read(text, "a.ply").faces().iter().map(<[u32]>::to_vec).collect();
    assert_eq!(faces, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
}

#[test]
fn ply_strips_stand_beside_faces_and_a_number_is_no_list_of_corners() {
    let points =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
    let strips = "element tristrips 1\nproperty list int int vertex_indices\n";
    let face = "element face 1\nproperty list uchar int vertex_indices\nproperty int part\n";
    let rows = "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    for (header, body) in [
        (format!("{points}{strips}{face}"), "3 0 1 2\n3 1 3 2 7\n"),
        (format!("{points}{face}{strips}"), "3 1 3 2 7\n3 0 1 2\n"),
    ] {
        let shape = read(format!("{header}{rows}{body}"), "a.ply");
        assert_eq!(shape.faces().len(), 2);
        assert!(shape.face_fields().is_empty(), "one value for two faces");
        assert!(shape.extras().iter().any(|e| e.contains("`part`")), "{:?}", shape.extras());
    }
    let text = format!("{points}element face 1\nproperty uchar vertex_indices\n{rows}3\n");
    assert!(error(&text, "a.ply").contains("no list `vertex_indices`"));

    // Faces of equal size are read by another path; the strips before them stay too.
    let text = format!("{points}{strips}{face}end_header\n").replace("ascii", "binary_little_endian");
    let mut binary = text.into_bytes();
    binary.extend([0_f32, 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.].iter().flat_map(|x| x.to_le_bytes()));
    binary.extend([3, 0, 1, 2].iter().flat_map(|x: &i32| x.to_le_bytes()));
    binary.push(3);
    binary.extend([1, 3, 2, 7].iter().flat_map(|x: &i32| x.to_le_bytes()));
    let faces: Vec<Vec<u32>> = read(&binary, "a.ply").faces().iter().map(<[u32]>::to_vec).collect();
    assert_eq!(faces, [[0, 1, 2], [1, 3, 2]]);
}

#[test]
fn off_letters_say_what_follows_the_coordinates() {
    let shape = read("STCNOFF\n1 0 0\n1 2 3  0 0 1  255 0 9 255  0.5 0.25\n", "a.off");
    assert_eq!(shape.field_names(), ["normal", "color", "texcoord"]);
    assert_eq!(shape.field("color").unwrap().values, FieldValues::U8(vec![255, 0, 9, 255]));
    assert_eq!(shape.field("texcoord").unwrap().to_f64(), [0.5, 0.25]);
    assert!(error("OFF BINARY\n", "a.off").contains("get the whole file"));
    assert!(
        error("OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 3\n", "a.off")
            .starts_with("line 6: face 0 names vertex 3")
    );
}

#[test]
fn stl_is_told_apart_by_its_length() {
    let mut binary = b"solid as many programs begin".to_vec();
    binary.resize(80, b' ');
    binary.extend(1_u32.to_le_bytes());
    binary.extend([0; 48]);
    binary.extend([5, 1]);
    let shape = read(&binary, "a.stl");
    assert_eq!((shape.format(), shape.n_vertices()), (Some(Format::STL), 3));
    assert_eq!(shape.face_fields()[1].values, FieldValues::U16(vec![261]));
    let cut = error(&binary[..120], "a.stl");
    assert_eq!(cut, "the file ends at byte 120 of 134, in element `triangle`, row 0; get the whole file");
    let ascii = read(
        "solid vertex facet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 .5\nendloop\nendfacet\nendsolid\n",
        "a",
    );
    assert_eq!((ascii.format(), ascii.points()[2]), (Some(Format::STL_ASCII), [0.0, 1.0, 0.5]));
}

#[test]
fn rows_of_numbers_are_understood() {
    let csv = read("Id;X;Y;Z;Gaze\n1;0.5;2;3;9\n2;1;2;;8\n", "a.csv");
    assert_eq!(csv.points()[0], [0.5, 2.0, 3.0]);
    // The second row has no height, so it is left out.
    assert_eq!((csv.n_vertices(), csv.n_file_rows()), (1, 2));
    assert_eq!(csv.field_names(), ["Id", "Gaze"]);
    let pts = read("2\n0 0 0 -1200 10 20 30\n1 1 1 -1300 40 50 60\n", "a.pts");
    assert_eq!(pts.field_names(), ["intensity", "color"]);
    let pwn = read("2\n0 0 0\n1 1 1\n0 0 1\n0 1 0\n", "a.pwn");
    assert_eq!(
        (pwn.n_vertices(), pwn.field("normal").unwrap().to_f64()),
        (2, vec![0.0, 0.0, 1.0, 0.0, 1.0, 0.0])
    );
    let remark = read("//X Y Z R G B\n0,0,0,1,2,3\n", "a.txt");
    assert_eq!(remark.field("color").unwrap().values, FieldValues::U8(vec![1, 2, 3]));
    assert_eq!(
        error("1 2 3\n4 5\n", "a.xyz"),
        "line 2: all rows must have the same number of values, got 2 after 3; make them equal"
    );
    assert!(error("5\n1 2 3\n4 5 6\n", "a.pts").contains("the count is 5, but there are 2 rows"));
}

#[test]
fn old_macintosh_line_ends_are_line_ends() {
    let shape = read("# a\rv 1 2 3\rv 4 5 6\r", "a.obj");
    assert_eq!(shape.points(), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
}

#[test]
fn what_a_format_cannot_hold_is_reported() {
    let mut shape = read("g a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.1\nf 1 2 4 3\n", "a.obj");
    shape.add_vertex_field(adwave_io::Field::new("gaze", 1, FieldValues::F32(vec![1.0; 4]))).unwrap();
    let mut bytes = Vec::new();
    let report = write_bytes(&shape, Format::STL, &mut bytes).unwrap();
    for what in ["groups", "vertex field `gaze`", "polygons", "digits of coordinates"] {
        assert!(report.not_written.iter().any(|l| l.contains(what)), "{what}: {:?}", report.not_written);
    }
    let report = write_bytes(&shape, Format::OBJ, &mut bytes).unwrap();
    assert_eq!(report.not_written, ["vertex field `gaze`"]);
    let cloud = ShapeFile::from_cloud(vec![[0.0; 3]]);
    assert!(write_bytes(&cloud, Format::STL, &mut bytes).unwrap_err().to_string().contains("cannot store"));
    let report = write_bytes(&shape, Format::LAS, &mut bytes).unwrap();
    assert!(report.not_written.iter().any(|l| l == "faces"), "{:?}", report.not_written);
}

/// Reads and writes without a change, and returns the written bytes.
fn unchanged(bytes: &[u8], name: &str) -> Vec<u8> {
    let shape = read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap();
    let mut out = Vec::new();
    write_bytes(&shape, shape.format().unwrap(), &mut out).unwrap();
    out
}

#[test]
fn a_vertical_tab_between_values_of_a_ply_is_kept() {
    let text =
        b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
                 end_header\n0 0 5\x0b1 2 3\n";
    assert_eq!(unchanged(text, "a.ply"), text);
}

#[test]
fn a_remark_right_after_a_value_of_an_off_is_kept() {
    let text = b"OFF\n1 0 0\n1 0 0#3 4\n";
    assert_eq!(unchanged(text, "a.off"), text);
}

#[test]
fn a_remark_that_ends_in_a_carriage_return_hides_no_rows() {
    let text = b"# 0.5\r 1 \r";
    let error = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap_err();
    assert!(error.to_string().contains("named as obj"), "{error}");
}

#[test]
fn an_xml_error_is_one_line() {
    let error = adwave_io::parse_gifti_fields(b"<?x\ry?><GIFTI\r", &ReadLimits::default()).unwrap_err();
    assert!(!error.to_string().contains('\r'), "{error:?}");
}

#[test]
fn faces_that_are_not_convex_are_cut_inside() {
    // An arrowhead of area 1.5; a fan around its first corner would extend beyond it.
    let off = b"OFF\n5 2 0\n-1 0 0\n0 .5 0\n1 0 0\n0 2 0\n0 0 1\n4 0 1 2 3\n3 0 3 4\n";
    let shape = read_bytes(off.to_vec(), None, &ReadLimits::default()).unwrap();
    for format in [Format::STL, Format::STL_ASCII, Format::AMF, Format::THREE_MF, Format::GLB] {
        let mut bytes = Vec::new();
        let report = write_bytes(&shape, format, &mut bytes).unwrap();
        assert!(report.not_written.contains(&"polygons (as triangles)".to_owned()), "{format}");
        let again = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
        assert_eq!(again.faces().len(), 3, "{format}");
        let area = |face: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|k| again.points()[face[k] as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        let flat = |face: &&[u32]| face.iter().all(|&v| again.points()[v as usize][2] == 0.0);
        let total: f64 = again.faces().iter().filter(flat).map(area).sum();
        assert!((total - 1.5).abs() < 1e-12, "{format}: {total}");
    }
}

#[test]
fn an_archive_that_was_cut_is_said_to_be_cut() {
    let off = b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let shape = read_bytes(off.to_vec(), None, &ReadLimits::default()).unwrap();
    let mut bytes = Vec::new();
    write_bytes(&shape, Format::THREE_MF, &mut bytes).unwrap();
    bytes.truncate(bytes.len() - 20);
    for name in ["a.3mf", "a.amf"] {
        let error = read_bytes(bytes.clone(), Some(name), &ReadLimits::default()).unwrap_err().to_string();
        assert!(error.starts_with("the ZIP archive is damaged"), "{error}");
        assert!(error.ends_with("get the whole file"), "{error}");
    }
}

#[test]
fn a_matrix_of_nothing_is_none_under_another_name() {
    let said = error("3 0\n6 ", "a.ply");
    assert!(said.contains("named as ply"), "{said}");
    assert_eq!(read("3 0\n", "a.dmat").n_vertices(), 0);
}
