//! Tests of unusual content: points without a position, planar points, other encodings, several solids.

use adwave_io::{Field, FieldValues, Format, ShapeFile, ShapeKind, read_path};

use crate::meshes::{error, read, written};

#[test]
fn points_without_a_place_are_left_out_and_come_back() {
    let text = "# .PCD v0.7\nVERSION 0.7\nfields X Y Z q\nSIZE 4 4 4 2\nTYPE f f F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 2\n\
        VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA ascii\n0.50 0 0 1\nnan nan nan 2\n1 0 0 3\n0 inf 0 4\n";
    let mut file = read(text.as_bytes(), "a.pcd");
    assert_eq!((file.n_vertices(), file.field("q").unwrap().to_f64()), (2, vec![1.0, 3.0]));
    assert_eq!(file.extras(), ["2 points without a position"]);
    file.to_shape().unwrap();
    assert_eq!(String::from_utf8(written(&file, Format::PCD_ASCII)).unwrap(), text);
    file.set_points(vec![[0.5, 0.0, 0.0], [9.0, 0.0, 0.0]]).unwrap();
    assert_eq!(
        String::from_utf8(written(&file, Format::PCD_ASCII)).unwrap(),
        text.replace("1 0 0 3", "9 0 0 3")
    );
    // A new field is 0 or NaN at points without a position; other formats do not store these points.
    file.add_vertex_field(Field::new("new", 1, FieldValues::F32(vec![5.0, 6.0]))).unwrap();
    for format in [Format::PCD, Format::PCD_COMPRESSED, Format::PCD_ASCII] {
        let bytes = written(&file, format);
        let head = String::from_utf8_lossy(&bytes).into_owned();
        assert!(head.contains("WIDTH 2\nHEIGHT 2\n") && head.contains("POINTS 4"), "{head}");
        let again = read(&bytes, "a.pcd");
        assert_eq!((again.points(), again.format()), (file.points(), Some(format)));
        assert_eq!(again.field("new").unwrap().to_f64(), [5.0, 6.0]);
        assert_eq!(again.field("q").unwrap().to_f64(), [1.0, 3.0]);
    }
    assert_eq!(read(&written(&file, Format::PLY), "a").n_vertices(), 2);
}

#[test]
fn a_compressed_pcd_stays_compressed() {
    let points: Vec<[f64; 3]> = (0..500).map(|k| [f64::from(k % 10), f64::from(k / 10), 0.5]).collect();
    let mut cloud = ShapeFile::from_cloud(points);
    cloud.add_vertex_field(Field::new("color", 3, FieldValues::U8(vec![200; 1500]))).unwrap();
    cloud
        .add_vertex_field(Field::new("hks", 5, FieldValues::I16((0..2500).map(|k| k / 9).collect())))
        .unwrap();
    let bytes = written(&cloud, Format::PCD_COMPRESSED);
    assert!(bytes.len() < written(&cloud, Format::PCD).len() / 2);
    let again = read(&bytes, "a.pcd");
    assert_eq!((again.points(), again.format()), (cloud.points(), Some(Format::PCD_COMPRESSED)));
    for field in cloud.vertex_fields() {
        assert_eq!(again.field(&field.name), Some(field));
    }
}

#[test]
fn an_obj_of_the_plane() {
    let text = "v 0 0\nv 1.50 0\nv 0 1 # last\nf 1 2 3\n";
    let mut file = read(text.as_bytes(), "a.obj");
    assert_eq!(file.points()[1], [1.5, 0.0, 0.0]);
    assert_eq!(written(&file, Format::OBJ), text.as_bytes());
    file.set_points(vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
    assert_eq!(String::from_utf8(written(&file, Format::OBJ)).unwrap(), text.replace("1.50", "2"));
    file.set_points(vec![[0.0; 3], [2.0, 0.0, 0.25], [0.0, 1.0, 0.0]]).unwrap();
    assert_eq!(read(&written(&file, Format::OBJ), "a.obj").points(), file.points());
    let message = error(b"v 0 0 0\nv 1 2\nv 0 1 0\n", "a.obj");
    assert!(message.contains("line 2: a vertex needs 3 numbers, got 2"), "{message}");
}

#[test]
fn an_obj_of_lines_is_a_graph_with_places() {
    let file = read(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n", "a.obj");
    assert_eq!((file.kind(), file.points().len()), (ShapeKind::Graph, 3));
    file.to_shape().unwrap();
}

#[test]
fn text_in_utf_16() {
    let text = "# ä\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let bytes: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(to_bytes).collect();
        let file = read(&bytes, "a.obj");
        assert_eq!((file.n_vertices(), file.faces().len()), (3, 1));
        assert_eq!(written(&file, Format::OBJ), text.as_bytes());
    }
}

#[cfg(unix)]
#[test]
fn names_that_are_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(std::ffi::OsStr::from_bytes(b"\xff\xfe.edges"));
    std::fs::write(&path, "0 1\n1 2\n").unwrap();
    let file = read_path(&path, &adwave_io::ReadLimits::default()).unwrap();
    assert_eq!(file.n_vertices(), 3);
}

const SOLIDS: &str = "solid left side\nfacet normal 0 0 2\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid left side\n\
    solid right\nfacet normal 0 0.1 1\nouter loop\nvertex 5 0 0\nvertex 6 0 0\nvertex 5 1 0\nendloop\nendfacet\nendsolid right\n";

#[test]
fn solids_stay_apart_and_normals_of_what_stayed_too() {
    let mut file = read(SOLIDS.as_bytes(), "a.stl");
    let solid = file.face_fields().iter().find(|f| f.name == "solid").unwrap();
    assert_eq!(solid.to_f64(), [0.0, 1.0]);
    assert_eq!(String::from_utf8(written(&file, Format::STL_ASCII)).unwrap(), SOLIDS);
    let mut points = file.points().to_vec();
    points[5] = [5.0, 1.0, 1.0];
    file.set_points(points).unwrap();
    let again = read(&written(&file, Format::STL_ASCII), "a.stl");
    let normal = again.face_fields().iter().find(|f| f.name == "normal").unwrap().to_f64();
    let half = 0.5_f64.sqrt();
    assert_eq!(normal[..3], [0.0, 0.0, 2.0]);
    assert!((normal[4] + half).abs() < 1e-15 && (normal[5] - half).abs() < 1e-15, "{normal:?}");
    let names: Vec<&str> = again.face_fields().iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["normal", "solid"]);
}

#[test]
fn a_binary_stl_that_begins_as_a_text() {
    let file = read(SOLIDS.as_bytes(), "a.stl");
    let mut bytes = written(&file, Format::STL);
    bytes[..11].copy_from_slice(b"solid shape");
    let again = read(&bytes, "a.stl");
    assert_eq!((again.format(), again.faces().len()), (Some(Format::STL), 2));
    // Bytes after the last triangle do not make it a text either.
    bytes.extend([0; 7]);
    assert_eq!(read(&bytes, "a.stl").faces().len(), 2);
}
