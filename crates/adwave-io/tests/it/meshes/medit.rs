//! Tests of Medit meshes: handwritten files of each version, real ones, and damaged ones.

use adwave::shape::Polygons;
use adwave_io::{
    CoordinatePrecision, Field, FieldValues, Format, ReadLimits, ShapeFile, read_bytes, read_path,
    write_bytes,
};
use adwave_test_data::data_test;

use crate::common;

fn read(bytes: &[u8]) -> ShapeFile {
    read_bytes(bytes.to_vec(), None, &ReadLimits::default()).unwrap()
}

fn written(file: &ShapeFile, format: Format) -> Vec<u8> {
    let mut out = Vec::new();
    write_bytes(file, format, &mut out).unwrap();
    out
}

const TEXT: &str = "MeshVersionFormatted 2\n\nDimension\n3\n# points\nVertices\n5\n0 0 0 1\n1.50 0 0 1\n1 1 0 1\n0 1 0 2 # last\n0 0 1 0\n\
    Ridges\n1\n1\nTriangles 1\n1 2 5 7\nQuadrilaterals\n1\n1 2 3 4 9\nEdges\n1\n1 2 0\nTetrahedra\n1\n1 2 3 5 4\nEnd\n";

#[test]
fn text_with_everything() {
    let mut file = read(TEXT.as_bytes());
    assert_eq!((file.n_vertices(), file.format()), (5, Some(Format::MEDIT)));
    let faces: Polygons = [&[0_u32, 1, 4][..], &[0, 1, 2, 3]].into_iter().collect();
    assert_eq!(*file.faces(), faces);
    assert_eq!(file.field("reference").unwrap().values, FieldValues::I32(vec![1, 1, 1, 2, 0]));
    assert_eq!(file.face_fields()[0].to_f64(), [7.0, 9.0]);
    assert_eq!(file.extras().len(), 3, "{:?}", file.extras());
    assert_eq!(written(&file, Format::MEDIT), TEXT.as_bytes());
    let mut points = file.points().to_vec();
    points[1][2] = 0.25;
    file.set_points(points).unwrap();
    let moved = TEXT.replace("1.50 0 0", "1.50 0 0.25");
    assert_eq!(String::from_utf8(written(&file, Format::MEDIT)).unwrap(), moved);
}

#[test]
fn points_of_the_plane_and_the_boundary_of_cells() {
    let flat =
        "MeshVersionFormatted 1\nDimension 2\nVertices\n3\n0 0 1\n1 0 1\n0 1 1\nTriangles\n1\n1 2 3 0\n";
    let mut file = read(flat.as_bytes());
    assert_eq!((file.points()[1], file.faces().len()), ([1.0, 0.0, 0.0], 1));
    assert_eq!(written(&file, Format::MEDIT), flat.as_bytes());
    file.set_points(vec![[0.0, 0.0, 1.0]; 3]).unwrap();
    assert_eq!(read(&written(&file, Format::MEDIT)).points(), [[0.0, 0.0, 1.0]; 3]);
    let cells = "MeshVersionFormatted 2 Dimension 3 Vertices 4 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0 Tetrahedra 1 1 2 3 4 6 End";
    let file = read(cells.as_bytes());
    assert_eq!((file.faces().len(), file.face_fields()[0].to_f64()), (4, vec![6.0; 4]));
}

/// Points, a triangle and an edge in binary.
fn binary(version: i32, is_big: bool) -> Vec<u8> {
    let int = |x: i32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() }.to_vec();
    let long = |x: i64| if is_big { x.to_be_bytes() } else { x.to_le_bytes() }.to_vec();
    let single = |x: f32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() }.to_vec();
    let double = |x: f64| if is_big { x.to_be_bytes() } else { x.to_le_bytes() }.to_vec();
    let place = |x: usize| if version >= 3 { long(x as i64) } else { int(x as i32) };
    let whole = |x: i64| if version >= 4 { long(x) } else { int(x as i32) };
    let float = |x: f64| if version == 1 { single(x as f32) } else { double(x) };
    let mut out = [int(1), int(version)].concat();
    let mut add = |keyword: i32, body: Vec<u8>| {
        let next = out.len() + 4 + place(0).len() + body.len();
        out.extend([int(keyword), place(next), body].concat());
    };
    add(3, int(3));
    let mut body = whole(3);
    for (p, reference) in [([0.0, 0.0, 0.0], 5), ([1.0, 0.0, 0.0], 6), ([0.0, 1.0, 0.5], 7)] {
        body.extend(p.into_iter().flat_map(float));
        body.extend(whole(reference));
    }
    add(4, body);
    add(14, [whole(1), whole(1)].concat());
    add(6, [1, 1, 2, 3, 8].into_iter().flat_map(whole).collect());
    out.extend([int(54), place(0)].concat());
    out
}

#[test]
fn all_versions_and_both_byte_orders() {
    for version in 1..=4 {
        for is_big in [false, true] {
            let bytes = binary(version, is_big);
            let mut file = read(&bytes);
            assert_eq!(file.format(), Some(Format::MEDIT_BINARY));
            assert_eq!(
                file.precision(),
                if version == 1 { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 }
            );
            assert_eq!((file.points()[2], file.faces().get(0)), ([0.0, 1.0, 0.5], &[0, 1, 2][..]));
            assert_eq!(file.field("reference").unwrap().to_f64(), [5.0, 6.0, 7.0]);
            assert_eq!(file.face_fields()[0].to_f64(), [8.0]);
            assert_eq!(written(&file, Format::MEDIT_BINARY), bytes, "{version}");
            file.set_points(vec![[0.25; 3], [2.0; 3], [-1.0, 0.0, 3.0]]).unwrap();
            let again = read(&written(&file, Format::MEDIT_BINARY));
            assert_eq!((again.points(), again.faces()), (file.points(), file.faces()));
        }
    }
}

#[test]
fn broken_files_are_errors_of_one_line() {
    let mesh = ShapeFile::from_mesh(vec![[0.0, 1.0, 2.0]; 3], Polygons::from_triangles(&[[0, 1, 2]]));
    let new = [written(&mesh, Format::MEDIT), written(&mesh, Format::MEDIT_BINARY)];
    for bytes in [TEXT.as_bytes().to_vec(), binary(2, false), binary(4, true)].into_iter().chain(new) {
        let is_binary = bytes.contains(&0);
        for end in 0..bytes.len() {
            let result = read_bytes(bytes[..end].to_vec(), Some("a.meshb"), &ReadLimits::default());
            assert!(!is_binary || end + 4 >= bytes.len() || result.is_err(), "{end} of {}", bytes.len());
            if let Err(error) = result {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
        for at in 0..bytes.len() {
            for other in [0, b'-', b'9', 255, bytes[at] ^ 1] {
                let mut broken = bytes.clone();
                broken[at] = other;
                if let Err(error) = read_bytes(broken, Some("a.mesh"), &ReadLimits::default()) {
                    assert!(!error.to_string().contains('\n'), "{error}");
                }
            }
        }
    }
    for (from, to, said) in [
        ("1 2 5 7", "1 2 6 7", "line 17: face 0 names vertex 6, but there are 5"),
        ("Vertices\n5", "Vertices\n5000000000", "exceeds the limit"),
        ("Vertices\n5", "Vertices\n4", "line 12: expected a keyword, got \"0\""),
        ("Dimension\n3", "Dimension\n4", "line 3: points must have dimension 2 or 3, got 4"),
    ] {
        let bytes = TEXT.replacen(from, to, 1).into_bytes();
        let message = read_bytes(bytes, None, &ReadLimits::default()).unwrap_err().to_string();
        assert!(message.contains(said), "{message}");
    }
}

#[test]
fn what_does_not_fit_is_said() {
    let faces: Polygons = [&[0_u32, 1, 2, 3][..], &[0, 1, 2], &[0, 1, 2, 3, 4]].into_iter().collect();
    let mut mesh = ShapeFile::from_mesh(vec![[0.0; 3]; 5], faces);
    mesh.add_vertex_field(Field::new("reference", 1, FieldValues::U8(vec![1, 2, 3, 4, 5]))).unwrap();
    mesh.add_vertex_field(Field::new("quality", 1, FieldValues::F32(vec![0.0; 5]))).unwrap();
    let mut bytes = Vec::new();
    let report = write_bytes(&mesh, Format::MEDIT_BINARY, &mut bytes).unwrap();
    let left =
        ["vertex field `quality`", "the order of faces (triangles come first)", "polygons (as triangles)"];
    assert_eq!(report.not_written, left);
    let again = read(&bytes);
    assert_eq!(
        (again.faces().len(), again.field("reference").unwrap().to_f64()),
        (5, vec![1.0, 2.0, 3.0, 4.0, 5.0])
    );
}

/// Vertices and faces as counted by `meshio`; for the file with one cell its faces.
#[data_test]
fn real_files() {
    let folder = common::test_inputs().join("formats/messy/PyMesh/tests/data");
    for (name, n_vertices, n_faces) in [("empty.mesh", 0, 0), ("tet.mesh", 4, 4)] {
        let file = read_path(&folder.join(name), &ReadLimits::default()).unwrap();
        assert_eq!((file.n_vertices(), file.faces().len()), (n_vertices, n_faces), "{name}");
        assert_eq!(written(&file, Format::MEDIT), std::fs::read(folder.join(name)).unwrap(), "{name}");
    }
}
