//! Tests that files with fewer vertices keep the attributes of the remaining ones.

use adwave::shape::Polygons;
use adwave_io::{Edges, Field, FieldValues, Format, ReadLimits, ShapeFile, Subset, read_bytes, write_bytes};

fn read(text: &str, name: &str) -> ShapeFile {
    read_bytes(text.as_bytes().to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn written(file: &ShapeFile, format: Format) -> String {
    let mut out = Vec::new();
    let report = write_bytes(file, format, &mut out).unwrap();
    assert!(report.not_written.is_empty(), "{report:?}");
    String::from_utf8(out).unwrap()
}

/// Two squares of two triangles with two materials; the texture has a seam between them.
const TEXTURED: &str = "# head\nmtllib a.mtl\nv 0 0 0 1 0 0\nv 1.0 0 0 0 1 0\nv 2 0 0 0 0 1\nv 0 1 0 1 1 0\n\
    v 1 1 0 0 1 1\nv 2 1 0 1 0 1\nvt 0 0\nvt 0.5 0\nvt 0.0 1\nvt 0.5 1\nvt 0.6 0\nvt 1 0\nvt 0.6 1\nvt 1 1\n\
    vn 0 0 1\no sheet\ng left\nusemtl red\nf 1/1/1 2/2/1 4/3/1\nf 2/2/1 5/4/1 4/3/1\ng right\nusemtl blue\n\
    f 2/5/1 3/6/1 5/7/1\nf -4/-3/1 6/8/1 5/7/1\nl 1 2 3 6\n";

#[test]
fn an_obj_keeps_its_lines_materials_groups_and_both_sides_of_a_seam() {
    let file = read(TEXTURED, "a.obj");
    assert!(file.extras().iter().any(|extra| extra.contains("texture coordinates")));
    // The corners of vertex 5 (index 4) on both sides, and of vertices 2 and 3.
    let subset = Subset {
        vertices: &[0, 1, 2, 4],
        triangles: &[[1, 2, 3], [0, 1, 3]],
        faces: &[2, 0],
        corners: &[[6, 7, 8], [0, 1, 4]],
    };
    let part = file.subset(&subset).unwrap();
    assert_eq!(part.points(), [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(
        written(&part, Format::OBJ),
        "# head\nmtllib a.mtl\nv 0 0 0 1 0 0\nv 1.0 0 0 0 1 0\nv 2 0 0 0 0 1\nv 1 1 0 0 1 1\nvt 0.6 0\nvt 1 0\n\
         vt 0.6 1\nvt 0 0\nvt 0.5 0\nvt 0.5 1\nvn 0 0 1\no sheet\ng left\nusemtl red\nf 1/4/1 2/5/1 4/6/1\n\
         g right\nusemtl blue\nf 2/1/1 3/2/1 4/3/1\nl 1 2\nl 2 3\n"
    );
    assert_eq!(part.field("color").unwrap().to_f64()[9..], [0.0, 1.0, 1.0]);
}

#[test]
fn labels_tell_sides_of_seams_apart() {
    let file = read(TEXTURED, "a.obj");
    let labels = file.corner_labels().unwrap();
    let corners = file.faces().corners();
    assert_eq!(labels.len(), 12);
    for (j, k) in
        (0..12).flat_map(|j| (0..12).map(move |k| (j, k))).filter(|&(j, k)| corners[j] == corners[k])
    {
        assert_eq!(labels[j] == labels[k], (j < 6) == (k < 6), "corners {j} and {k}");
    }
    let plain = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj");
    assert!(plain.corner_labels().is_none());
    let mut mesh = ShapeFile::from_mesh(vec![[0.0; 3]; 3], Polygons::from_triangles(&[[0, 1, 2]]));
    mesh.add_vertex_field(Field::new("texcoord", 2, FieldValues::F32(vec![0.0, 0.0, 1.0, 0.0, -0.0, 0.0])))
        .unwrap();
    assert_eq!(mesh.corner_labels().unwrap(), [0, 1, 0]);
}

#[test]
fn fields_keep_their_types_and_rows_and_edges_their_ends() {
    let square = Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]);
    let mut file = ShapeFile::from_mesh(vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]], square);
    let id = Field::new("id", 1, FieldValues::U64(vec![u64::MAX, 1, 2, 3]));
    let flow = Field::new("flow", 2, FieldValues::F32((0..8).map(|k| k as f32).collect()));
    let label = Field::new("label", 1, FieldValues::I16(vec![-5, 7]));
    file.add_vertex_field(id).unwrap();
    file.add_vertex_field(flow).unwrap();
    file.add_face_field(label).unwrap();
    let subset = Subset { vertices: &[0, 2, 3], triangles: &[[0, 1, 2]], faces: &[1], corners: &[[3, 4, 5]] };
    let part = file.subset(&subset).unwrap();
    assert_eq!(part.field("id").unwrap().values, FieldValues::U64(vec![u64::MAX, 2, 3]));
    assert_eq!(part.field("flow").unwrap().values, FieldValues::F32(vec![0.0, 1.0, 4.0, 5.0, 6.0, 7.0]));
    assert_eq!(part.face_fields()[0].values, FieldValues::I16(vec![7]));
    // As a cloud it has no faces and no face attributes.
    let cloud = file.subset(&Subset { vertices: &[1], ..Subset::default() }).unwrap();
    assert!(cloud.faces().is_empty() && cloud.face_fields().is_empty());
    let graph = ShapeFile::from_graph(
        4,
        Edges { pairs: vec![[0, 1], [1, 3], [3, 2]], weights: vec![1.0, 2.0, 3.0], ..Edges::default() },
    );
    let part = graph.subset(&Subset { vertices: &[1, 3], ..Subset::default() }).unwrap();
    assert_eq!((part.edges().pairs.as_slice(), part.edges().weights.as_slice()), (&[[0, 1]][..], &[2.0][..]));
}

#[test]
fn clouds_of_an_obj_keep_colors_and_normals() {
    let file = read("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 2 0 0 0 0 1\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n", "a.obj");
    let part = file.subset(&Subset { vertices: &[0, 2], ..Subset::default() }).unwrap();
    assert_eq!(part.field("normal").unwrap().to_f64(), [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
    assert_eq!(part.field("color").unwrap().to_f64(), [1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let file = read(TEXTURED, "a.obj");
    let whole = Subset { vertices: &[0, 1, 2], triangles: &[[0, 1, 2]], faces: &[0], corners: &[[0, 1, 2]] };
    assert!(file.subset(&whole).is_ok());
    for (bad, said) in [
        (Subset { vertices: &[0, 0, 2], ..whole.clone() }, "vertices"),
        (Subset { vertices: &[0, 1, 6], ..whole.clone() }, "vertices"),
        (Subset { triangles: &[[0, 1, 3]], ..whole.clone() }, "triangles"),
        (Subset { faces: &[4], ..whole.clone() }, "faces"),
        (Subset { faces: &[], ..whole.clone() }, "faces"),
        (Subset { corners: &[[0, 1, 12]], ..whole.clone() }, "corners"),
    ] {
        assert!(file.subset(&bad).unwrap_err().to_string().contains(said), "{bad:?}");
    }
}
