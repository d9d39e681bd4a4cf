//! Tests of Gmsh meshes: handwritten files of each version, real ones, and damaged ones.

use adwave::shape::Polygons;
use adwave_io::{Field, FieldValues, Format, ReadLimits, ShapeFile, read_bytes, read_path, write_bytes};
use adwave_test_data::data_test;

use crate::common;

fn read(bytes: &[u8]) -> ShapeFile {
    read_bytes(bytes.to_vec(), None, &ReadLimits::default()).unwrap()
}

fn error(bytes: &[u8]) -> String {
    read_bytes(bytes.to_vec(), Some("a.msh"), &ReadLimits::default()).unwrap_err().to_string()
}

fn written(file: &ShapeFile, format: Format) -> Vec<u8> {
    let mut out = Vec::new();
    write_bytes(file, format, &mut out).unwrap();
    out
}

/// Sparse tags, a line, a triangle, a quadratic triangle and a quadrilateral, a field with a gap and a face field.
const TEXT_2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"skin\"\n$EndPhysicalNames\n\
    $Nodes\n5\n10 0 0 0\n20 1.50 0 0\n30 0 1 0\n1000000 1 1 0.5\n7 3 3 3\n$EndNodes\n\
    $Elements\n4\n1 1 2 0 1 10 20\n5 2 2 7 3 10 20 30\n6 9 3 8 4 99 20 1000000 30 7 7 7\n9 3 2 7 3 10 20 1000000 30\n$EndElements\n\
    $NodeData\n1\n\"a b\"\n1\n0.5\n3\n0\n1\n2\n30 2.5\n10 -1\n$EndNodeData\n\
    $ElementData\n1\n\"load\"\n0\n3\n0\n3\n1\n9 1 2 3\n$EndElementData\n";

#[test]
fn version_2_as_text() {
    let mut file = read(TEXT_2.as_bytes());
    assert_eq!((file.n_vertices(), file.format()), (5, Some(Format::MSH_ASCII)));
    let faces: Polygons = [&[0_u32, 1, 2][..], &[1, 3, 2], &[0, 1, 3, 2]].into_iter().collect();
    assert_eq!(*file.faces(), faces);
    let names: Vec<&str> = file.face_fields().iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["physical", "elementary", "load"]);
    assert_eq!(file.face_fields()[0].values, FieldValues::I32(vec![7, 8, 7]));
    assert_eq!(file.face_fields()[2].to_f64()[6..], [1.0, 2.0, 3.0]);
    let gap = file.field("a b").unwrap().to_f64();
    assert_eq!((gap[0], gap[2], gap[1].is_nan()), (-1.0, 2.5, true));
    assert!(file.extras().iter().any(|e| e == "elements of a line"), "{:?}", file.extras());

    // Everything else stays.
    assert_eq!(written(&file, Format::MSH_ASCII), TEXT_2.as_bytes());
    let mut points = file.points().to_vec();
    points[3][1] = -2.0;
    file.set_points(points).unwrap();
    let moved = TEXT_2.replace("1000000 1 1 0.5", "1000000 1 -2 0.5");
    assert_eq!(String::from_utf8(written(&file, Format::MSH_ASCII)).unwrap(), moved);
    // A new field is added, a changed one replaces the old one.
    file.add_vertex_field(Field::new("new", 1, FieldValues::U8(vec![5; 5]))).unwrap();
    file.add_vertex_field(Field::new("a b", 1, FieldValues::U8(vec![1, 2, 3, 4, 5]))).unwrap();
    let again = read(&written(&file, Format::MSH_ASCII));
    assert_eq!(again.field("new").unwrap().to_f64(), [5.0; 5]);
    assert_eq!(again.field("a b").unwrap().to_f64(), [1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(again.vertex_fields().len(), 2);
    // With NaN, which differs from itself.
    assert_eq!(format!("{:?}", again.face_fields()), format!("{:?}", file.face_fields()));
}

/// Two blocks of nodes, groups by entity, and two tetrahedra that share a face.
const TEXT_41: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 0 1\n1 0 0 0 0\n5 0 0 0 1 1 1 2 42 43 0\n$EndEntities\n\
    $Nodes\n2 5 1 9\n0 1 0 1\n9\n1 1 1\n3 5 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n\
    $Elements\n2 3 1 3\n0 1 15 1\n1 9\n3 5 4 2\n2 1 2 3 4\n3 2 3 4 9\n$EndElements\n\
    $ElementData\n1\n\"heat\"\n1\n0\n3\n0\n1\n2\n2 0.5\n3 0.25\n$EndElementData\n";

#[test]
fn version_4_as_text_with_the_boundary_of_cells() {
    let file = read(TEXT_41.as_bytes());
    assert_eq!((file.n_vertices(), file.faces().len()), (5, 6));
    assert_eq!(file.points()[0], [1.0; 3]);
    let field = |name: &str| file.face_fields().iter().find(|f| f.name == name).unwrap().to_f64();
    assert_eq!((field("physical"), field("elementary")), (vec![42.0; 6], vec![5.0; 6]));
    assert_eq!(field("heat"), [0.5, 0.5, 0.5, 0.25, 0.25, 0.25]);
    assert_eq!(written(&file, Format::MSH_ASCII), TEXT_41.as_bytes());
    // Version 4.0 has tag before dimension, boxes for points, and tags next to coordinates.
    let old = "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n3 0 0 0 1 1 1 1 6 0\n$EndEntities\n\
        $Nodes\n1 3\n3 2 0 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1 1\n3 2 2 1\n1 1 2 3\n$EndElements\n";
    let file = read(old.as_bytes());
    assert_eq!((file.faces().len(), file.face_fields()[0].to_f64()), (1, vec![6.0]));
}

/// Binary file of version 4.1 in a byte order.
fn binary_41(is_big: bool) -> Vec<u8> {
    let int = |x: i32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    let size = |x: u64| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    let double = |x: f64| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
    let mut out = b"$MeshFormat\n4.1 1 8\n".to_vec();
    out.extend(int(1));
    out.extend(b"\n$EndMeshFormat\n$Nodes\n");
    out.extend([1, 4, 3, 6].into_iter().flat_map(size));
    out.extend([2, 1, 0].into_iter().flat_map(int));
    out.extend(size(4));
    out.extend([3, 4, 5, 6].into_iter().flat_map(size));
    for p in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]] {
        out.extend(p.into_iter().flat_map(double));
    }
    out.extend(b"\n$EndNodes\n$Elements\n");
    out.extend([2, 2, 1, 2].into_iter().flat_map(size));
    for (kind, tag, nodes) in [(2, 1, &[3, 4, 5][..]), (3, 2, &[3, 4, 5, 6])] {
        out.extend([2, 1, kind].into_iter().flat_map(int));
        out.extend(size(1));
        out.extend(size(tag));
        out.extend(nodes.iter().copied().flat_map(size));
    }
    out.extend(b"\n$EndElements\n");
    out
}

#[test]
fn both_byte_orders_are_read_and_kept() {
    for is_big in [false, true] {
        let bytes = binary_41(is_big);
        let mut file = read(&bytes);
        assert_eq!((file.n_vertices(), file.faces().len(), file.format()), (4, 2, Some(Format::MSH)));
        assert_eq!(file.faces().get(1), [0, 1, 2, 3]);
        assert_eq!(written(&file, Format::MSH), bytes);
        let points: Vec<[f64; 3]> = file.points().iter().map(|p| p.map(|x| x + 0.1)).collect();
        file.set_points(points.clone()).unwrap();
        file.add_vertex_field(Field::new("q", 2, FieldValues::F32((0..8).map(|k| k as f32).collect())))
            .unwrap();
        let again = read(&written(&file, Format::MSH));
        assert_eq!((again.points(), again.faces()), (points.as_slice(), file.faces()));
        assert_eq!(again.field("q").unwrap().to_f64(), file.field("q").unwrap().to_f64());
    }
}

#[test]
fn lines_are_edges_where_there_is_no_face() {
    let text =
        TEXT_2.lines().filter(|l| !l.starts_with("5 2") && !l.starts_with("6 9") && !l.starts_with("9 3"));
    let text = text.map(|l| if l == "4" { "1" } else { l }).collect::<Vec<_>>().join("\n");
    let file = read(text.as_bytes());
    assert_eq!((file.faces().len(), file.edges().pairs.as_slice()), (0, &[[0, 1]][..]));
}

#[test]
fn every_cut_before_the_end_of_the_elements_is_an_error() {
    let text_4 = TEXT_41.as_bytes().to_vec();
    let mesh = {
        let faces: Polygons = [&[0_u32, 1, 2][..], &[0, 2, 3, 1]].into_iter().collect();
        ShapeFile::from_mesh(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], faces)
    };
    for bytes in [TEXT_2.as_bytes().to_vec(), text_4, binary_41(true), written(&mesh, Format::MSH)] {
        let last = bytes.windows(12).position(|w| w == b"$EndElements").unwrap() + 12;
        for end in 0..bytes.len() {
            let result = read_bytes(bytes[..end].to_vec(), Some("a.msh"), &ReadLimits::default());
            assert!(end >= last || result.is_err(), "{end} of {last}");
            if let Err(error) = result {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
        // Every byte, changed to several others.
        for at in 0..bytes.len() {
            for other in [0, b'-', b'9', 255, bytes[at] ^ 1] {
                let mut broken = bytes.clone();
                broken[at] = other;
                if let Err(error) = read_bytes(broken, Some("a.msh"), &ReadLimits::default()) {
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
            }
        }
    }
}

#[test]
fn messages_say_where_and_what() {
    for (from, to, said) in [
        ("9 3 2 7 3 10 20", "9 3 2 7 3 11 20", "line 21: element 3 names node 11, which does not exist"),
        ("2.2 0 8", "3 0 8", "line 2: MSH of version 3 is not supported"),
        ("20 1.50", "20 x", "line 11: node 1 needs a number, got \"x\""),
        ("$Nodes\n5", "$Nodes\n5000000000", "vertices: 5000000000 exceeds the limit"),
        ("$Nodes\n5", "$Nodes\n500000000", "in element `node`"),
        ("9 3 2 7", "9 34 2 7", "elements of kind 34 are not supported"),
    ] {
        let message = error(TEXT_2.replacen(from, to, 1).as_bytes());
        assert!(message.contains(said), "{message}");
    }
    assert!(error(b"$NOD\n1\n").contains("version 1"));
}

/// Vertices and faces as counted by `meshio`; for files of cells the faces that belong to one cell.
#[data_test]
fn real_files() {
    let folder = common::test_inputs().join("formats/messy/PyMesh/tests/data");
    for (name, n_vertices, n_faces) in [
        ("ball.msh", 642, 1280),
        ("cube.msh", 8, 12),
        ("hex.msh", 8, 6),
        ("hex_s1.msh", 27, 24),
        ("tet.msh", 4, 4),
    ] {
        let file = read_path(&folder.join(name), &ReadLimits::default()).unwrap();
        assert_eq!((file.n_vertices(), file.faces().len()), (n_vertices, n_faces), "{name}");
        assert_eq!(
            written(&file, file.format().unwrap()),
            std::fs::read(folder.join(name)).unwrap(),
            "{name}"
        );
    }
    let empty = read_path(&folder.join("empty.msh"), &ReadLimits::default()).unwrap();
    assert_eq!((empty.n_vertices(), empty.faces().len()), (0, 0));
}
