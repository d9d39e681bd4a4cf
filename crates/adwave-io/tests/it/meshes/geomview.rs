//! Tests of Geomview's objects and its forms of OFF.

use adwave::shape::Polygons;
use adwave_io::{Field, FieldValues, Format, ReadLimits, ShapeFile, read_path};
use adwave_test_data::data_test;

use crate::common;
use crate::meshes::{error, read, survives, written};

#[test]
fn grids_make_quadrilaterals() {
    let plain = read(b"MESH\n3 2\n0 0 0 1 0 0 2 0 0\n0 1 0 1 1 0 2 1 1.5\n", "a.mesh");
    assert_eq!((plain.format(), plain.n_vertices()), (Some(Format::GEOMVIEW), 6));
    let faces: Polygons = [&[0_u32, 1, 4, 3][..], &[1, 2, 5, 4]].into_iter().collect();
    assert_eq!(*plain.faces(), faces);
    // Wrapped both ways it is a torus: as many faces as points.
    let points = "0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0 0 2 0 1 2 0 2 2 0";
    assert_eq!(read(format!("uvMESH 3 3 {points}").as_bytes(), "a").faces().len(), 9);
    assert_eq!(read(format!("uMESH 3 3 {points}").as_bytes(), "a").faces().len(), 6);
    // Heights alone, normals and colors, the fourth coordinate.
    let height = read(b"ZMESH 2 2 1 2 3 4", "a");
    assert_eq!(height.points(), [[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [0.0, 1.0, 3.0], [1.0, 1.0, 4.0]]);
    let rich = read(b"CNMESH 1 2\n0 0 0  0 0 1  1 0 0 1\n1 0 0  0 0 1  0 1 0 1\n", "a");
    assert_eq!((rich.field("normal").unwrap().get(1, 2), rich.field("color").unwrap().get(1, 1)), (1.0, 1.0));
    assert_eq!(read(b"4MESH 1 2 2 4 6 2  1 1 1 1", "a").points()[0], [1.0, 2.0, 3.0]);
    assert!(error(b"MESH 99999999 99999999 1", "a.mesh").contains("exceeds the limit"));
    assert_eq!(read(b"MESH 0 99999999999999\n", "a.mesh").n_vertices(), 0);
    survives(
        b"{ LIST { appearance {a 1} CMESH 1 2 0 0 0 1 0 0 1 1 0 0 0 1 0 1 } {= OFF 1 0 0 1 2 3} }",
        "a",
        |_, _| {},
    );
}

#[test]
fn lists_hold_several_objects() {
    let text = "{ LIST\n { appearance { material { diffuse 0 0 1 } } OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n }\n\
        { QUAD 0 0 1 1 0 1 1 1 1 0 1 1 }\n { SKEL 3 1\n0 0 2 1 0 2 1 1 2\n3 0 1 2  1 0 0 1\n } { VECT 1 2 0 -2 0 5 5 5 6 6 6 } }\n";
    let file = read(text.as_bytes(), "a.list");
    assert_eq!((file.n_vertices(), file.faces().len()), (12, 2));
    assert_eq!(file.faces().get(1), [3, 4, 5, 6]);
    assert_eq!(file.edges().pairs, [[7, 8], [8, 9], [10, 11], [11, 10]]);
    assert_eq!(file.extras(), ["appearance"]);
    assert!(error(b"{ INST geom { : a } }", "a.list").contains("not a supported mesh of Geomview"));
    assert!(error(b"{ LIST { MESH 1 1 0 0 0 }", "a.list").contains("is missing"));
}

#[test]
fn faces_may_run_over_lines_or_share_one() {
    let plain = read(b"OFF 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", "a.off");
    for text in [
        "OFF\n4 2 0\n0 0 0 1 0 0\n1 1 0\n0 1\n0\n3 0 1 2 3 0 2 3\n",
        "OFF 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3\n0 1\n2\n3 0 # a remark\n2 3",
    ] {
        let mut file = read(text.as_bytes(), "a.off");
        assert_eq!((file.points(), file.faces()), (plain.points(), plain.faces()));
        assert_eq!(written(&file, Format::OFF), text.as_bytes());
        file.set_points(vec![[2.0; 3]; 4]).unwrap();
        assert_eq!(read(&written(&file, Format::OFF), "a.off").points(), [[2.0; 3]; 4]);
    }
    let colored =
        read(b"COFF 3 1 0 0 0 0 1 0 0 1\n1 0 0 0 1 0 1 0 1 0 0 0 1 1\n3 0 1\n2 0.5 0.5 0 1\n", "a.off");
    assert_eq!(colored.field("color").unwrap().get(2, 2), 1.0);
    assert_eq!(colored.face_fields()[0].to_f64(), [0.5, 0.5, 0.0, 1.0]);
    // Errors refer to lines, as most files have them.
    assert!(
        error(b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "a.off")
            .contains("line 5: face 0 names vertex 7")
    );
    assert!(error(b"OFF 3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "a.off").contains("line 3"));
}

#[test]
fn dimensions_and_fourth_coordinates() {
    assert_eq!(read(b"nOFF\n3\n1 0 0\n1 2 3\n", "a.off").points(), [[1.0, 2.0, 3.0]]);
    assert_eq!(read(b"nOFF 3\n1 0 0\n1 2 3\n", "a.off").points(), [[1.0, 2.0, 3.0]]);
    assert!(error(b"nOFF\n4\n1 0 0\n1 2 3 4\n", "a.off").contains("needs points of three dimensions"));
    // Divided; with a point at infinity projected along the fourth axis.
    let divided = read(b"4OFF\n2 0 0\n2 4 6 2\n1 1 1 -1\n", "a.off");
    assert_eq!((divided.points(), divided.field("w").is_none()), (&[[1.0, 2.0, 3.0], [-1.0; 3]][..], true));
    let seen = read(b"4OFF\n2 0 0\n2 4 6 2\n1 1 1 0\n", "a.off");
    assert_eq!((seen.points()[0], seen.field("w").unwrap().to_f64()), ([2.0, 4.0, 6.0], vec![2.0, 0.0]));
}

#[test]
fn binary_off_is_kept() {
    let faces: Polygons = [&[0_u32, 1, 2][..], &[0, 1, 2, 3]].into_iter().collect();
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, -2.0]];
    let mut mesh = ShapeFile::from_mesh(points, faces);
    mesh.add_vertex_field(Field::new("normal", 3, FieldValues::F32((0..12).map(|k| k as f32).collect())))
        .unwrap();
    mesh.add_face_field(Field::new("color", 3, FieldValues::F32(vec![0.5, 0.0, 1.0, 0.25, 1.0, 0.0])))
        .unwrap();
    let bytes = written(&mesh, Format::OFF_BINARY);
    assert!(bytes.starts_with(b"NOFF BINARY\n\0\0\0\x04\0\0\0\x02\0\0\0\0"));
    let mut again = read(&bytes, "a.off");
    assert_eq!(
        (again.points(), again.faces(), again.format()),
        (mesh.points(), mesh.faces(), Some(Format::OFF_BINARY))
    );
    assert_eq!((again.vertex_fields(), again.face_fields()), (mesh.vertex_fields(), mesh.face_fields()));
    assert_eq!(written(&again, Format::OFF_BINARY), bytes);
    again.set_points(vec![[7.0; 3]; 4]).unwrap();
    assert_eq!(read(&written(&again, Format::OFF_BINARY), "a.off").points(), [[7.0; 3]; 4]);
    survives(&bytes, "a.off", |end, _| panic!("cut at {end}"));
}

/// Points and faces according to the heads of the files; a wrapped grid has as many faces as points.
#[data_test]
fn real_files() {
    let folder = common::test_inputs().join("formats/messy/geomview/spherical");
    for (name, n_vertices, n_faces) in [
        ("dodecaplex.off", 600, 720),
        ("flattorus.mesh", 256, 256),
        ("hypercube.off", 16, 24),
        ("octaplex.off", 24, 96),
        ("orthoplex.off", 8, 32),
        ("ruledtorus.mesh", 400, 400),
        ("simplex.off", 5, 10),
        ("tetraplex.off", 120, 1200),
        ("twosided.flattorus", 512, 512),
    ] {
        let file = read_path(&folder.join(name), &ReadLimits::default()).unwrap();
        assert_eq!((file.n_vertices(), file.faces().len()), (n_vertices, n_faces), "{name}");
        file.to_shape().unwrap();
    }
}
