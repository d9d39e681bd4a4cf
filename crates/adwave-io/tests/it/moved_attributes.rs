//! Normals and tangents after the vertices of a file have moved.

use adwave::Progress;
use adwave::sample::Sample;
use adwave::shape::vertex_normals;
use adwave_io::{Field, FieldValues, Format, MovedNormals, ReadLimits, ShapeFile, read_bytes, write_bytes};
use std::fmt::Write;

/// Largest deviation of a written normal: rounding to 32-bit floats.
const ROUNDING: f64 = 1e-6;

fn read(bytes: &[u8], name: &str) -> ShapeFile {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn write(file: &ShapeFile, format: Format) -> Vec<u8> {
    let mut out = Vec::new();
    let report = write_bytes(file, format, &mut out).unwrap();
    assert!(report.not_written.is_empty(), "{:?}", report.not_written);
    out
}

fn sheared(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    points.iter().map(|p| [p[0] + 0.4 * p[1] * p[1], p[1], p[2] - 0.5 * p[0]]).collect()
}

fn triangles(file: &ShapeFile) -> Vec<[u32; 3]> {
    file.faces().iter().map(|f| [f[0], f[1], f[2]]).collect()
}

fn worst(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// A sphere as OBJ text with a normal per vertex, whose corners count from the end.
fn smooth_obj(sign: f64) -> String {
    let sphere = Sample::from_name("sphere", Some(200)).unwrap();
    let mut text = "# exported\nmtllib mat.mtl\no Ball\n".to_owned();
    for p in &sphere.points {
        writeln!(text, "v {} {} {} 0.8 0.2 0.1", p[0], p[1], p[2]).unwrap();
    }
    for p in &sphere.points {
        let n = p.map(|x| sign * x / p.iter().map(|x| x * x).sum::<f64>().sqrt());
        writeln!(text, "vn {:.4} {:.4} {:.4}", n[0], n[1], n[2]).unwrap();
    }
    let n = sphere.points.len() as i64;
    for (f, face) in sphere.faces.iter().enumerate() {
        if f == 50 {
            text += "g rest\ns off\n";
        }
        text += "f";
        for &v in face {
            let k = i64::from(v) - n;
            write!(text, " {k}//{k}").unwrap();
        }
        text += " # kept\n";
    }
    text
}

#[test]
fn smooth_normals_of_an_obj_become_those_of_the_written_file_on_their_old_side() {
    for sign in [1.0, -1.0] {
        let mut file = read(smooth_obj(sign).as_bytes(), "a.obj");
        let points = sheared(file.points());
        let attributes = file.move_points(points, MovedNormals::Follow, Progress::none()).unwrap();
        assert_eq!(attributes.followed, ["normals"]);
        let text = write(&file, Format::OBJ);
        assert_eq!(String::from_utf8_lossy(&text).matches("# kept").count(), file.faces().len());
        let written = read(&text, "a.obj");
        let normals = written.field("normal").unwrap().to_f64();
        let right: Vec<[f64; 3]> = vertex_normals(written.points(), &triangles(&written))
            .iter()
            .map(|n| n.map(|x| sign * x))
            .collect();
        assert!(worst(normals.as_chunks().0, &right) < ROUNDING);
    }
}

/// A cube of four quads a side with one normal per side.
fn flat_cube() -> String {
    let mut text = String::new();
    let mut quads = String::new();
    let mut n = 0;
    for side in 0..6_usize {
        let (axis, high) = (side / 2, side % 2);
        let (u, v) =
            if high == 1 { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
        for i in 0..3_u8 {
            for j in 0..3_u8 {
                let mut p = [0.0; 3];
                (p[axis], p[u], p[v]) = (high as f64, f64::from(i) / 2.0, f64::from(j) / 2.0);
                writeln!(text, "v {} {} {}", p[0], p[1], p[2]).unwrap();
            }
        }
        let mut normal = [0.0; 3];
        normal[axis] = if high == 1 { 1.0 } else { -1.0 };
        writeln!(text, "vn {} {} {}", normal[0], normal[1], normal[2]).unwrap();
        for i in 0..2 {
            for j in 0..2 {
                let at = |i: usize, j: usize| n + 3 * i + j + 1;
                let k = side + 1;
                writeln!(
                    quads,
                    "f {}//{k} {}//{k} {}//{k} {}//{k}",
                    at(i, j),
                    at(i + 1, j),
                    at(i + 1, j + 1),
                    at(i, j + 1)
                )
                .unwrap();
            }
        }
        n += 9;
    }
    text + &quads
}

/// Normal of each corner of the faces of an OBJ text.
fn corner_normals(text: &[u8]) -> Vec<[f64; 3]> {
    let text = String::from_utf8_lossy(text).into_owned();
    let numbers =
        |line: &str| -> Vec<f64> { line.split_whitespace().skip(1).map(|w| w.parse().unwrap()).collect() };
    let normals: Vec<Vec<f64>> = text.lines().filter(|l| l.starts_with("vn ")).map(numbers).collect();
    let corners = text.lines().filter(|l| l.starts_with("f ")).flat_map(|l| l.split_whitespace().skip(1));
    let of = |corner: &str| -> [f64; 3] {
        let k: usize = corner.rsplit('/').next().unwrap().parse().unwrap();
        [normals[k - 1][0], normals[k - 1][1], normals[k - 1][2]]
    };
    corners.map(of).collect()
}

#[test]
fn creases_of_an_obj_stay_and_shared_normals_are_split_where_corners_differ() {
    let mut file = read(flat_cube().as_bytes(), "a.obj");
    let bent = |p: &[f64; 3]| [p[0], p[1], p[2] + 0.3 * p[0] * p[0] + 0.1 * p[1]];
    let points: Vec<[f64; 3]> = file.points().iter().map(bent).collect();
    let attributes = file.move_points(points, MovedNormals::Follow, Progress::none()).unwrap();
    assert_eq!(attributes.note().unwrap(), "normals were recomputed from the new positions");
    let text = write(&file, Format::OBJ);
    let normals = corner_normals(&text);
    let written = read(&text, "a.obj");
    // The vertices of a side are its own, so that its normals are those of its vertices.
    let mut sums = vec![[0.0; 3]; written.n_vertices()];
    for face in written.faces().iter() {
        let p: Vec<[f64; 3]> = face.iter().map(|&v| written.points()[v as usize]).collect();
        let (a, b): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|c| p[2][c] - p[0][c]), std::array::from_fn(|c| p[3][c] - p[1][c]));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        for &v in face {
            for (sum, x) in sums[v as usize].iter_mut().zip(cross) {
                *sum += x;
            }
        }
    }
    let unit = |n: [f64; 3]| n.map(|x| x / n.iter().map(|x| x * x).sum::<f64>().sqrt());
    let right: Vec<[f64; 3]> = written.faces().corners().iter().map(|&v| unit(sums[v as usize])).collect();
    assert!(worst(&normals, &right) < ROUNDING, "{}", worst(&normals, &right));
}

#[test]
fn flat_faces_stay_flat_and_unmoved_parts_keep_their_text() {
    let text = flat_cube().replacen("f ", "s off\nf ", 1);
    let mut file = read(text.as_bytes(), "a.obj");
    let mut points = file.points().to_vec();
    points[0][0] -= 0.25;
    file.move_points(points, MovedNormals::Follow, Progress::none()).unwrap();
    let written = write(&file, Format::OBJ);
    let normals = corner_normals(&written);
    assert!(normals.chunks(4).all(|face| face.iter().all(|n| *n == face[0])));
    let (before, after) = (corner_normals(text.as_bytes()), &normals);
    let n_changed = before.iter().zip(after).filter(|(a, b)| a != b).count();
    assert_eq!(n_changed, 4, "one face of the first side moved");
    let mut kept = read(text.as_bytes(), "a.obj");
    let mut points = kept.points().to_vec();
    points[0][0] -= 0.25;
    let attributes = kept.move_points(points, MovedNormals::Keep, Progress::none()).unwrap();
    assert_eq!(attributes.stale, ["normals"]);
    assert_eq!(corner_normals(&write(&kept, Format::OBJ)), before);
}

#[test]
fn normals_of_a_cloud_follow_its_points_on_their_old_side() {
    let sphere = Sample::from_name("sphere", Some(800)).unwrap();
    let mut file = ShapeFile::from_cloud(sphere.points.clone());
    let values: Vec<f64> = sphere.points.as_flattened().iter().map(|x| -x).collect();
    file.add_vertex_field(Field::new("normal", 3, FieldValues::F64(values))).unwrap();
    let file_bytes = write(&file, Format::PLY);
    let mut file = read(&file_bytes, "a.ply");
    // An ellipsoid has the normal (x/a², y/b², z/c²).
    let axes = [1.0, 2.0, 0.7];
    let points: Vec<[f64; 3]> =
        file.points().iter().map(|p| std::array::from_fn(|c| axes[c] * p[c])).collect();
    file.move_points(points, MovedNormals::Follow, Progress::none()).unwrap();
    let written = read(&write(&file, Format::PLY), "a.ply");
    let normals = written.field("normal").unwrap().to_f64();
    for (p, n) in written.points().iter().zip(normals.as_chunks::<3>().0) {
        let right: [f64; 3] = std::array::from_fn(|c| -p[c] / (axes[c] * axes[c]));
        let length = right.iter().map(|x| x * x).sum::<f64>().sqrt();
        let cos: f64 = (0..3).map(|c| right[c] * n[c] / length).sum();
        assert!(cos > 0.95, "{n:?} at {p:?}");
    }
}

#[test]
fn tangents_of_a_gltf_become_perpendicular_to_the_new_normals() {
    let mut sphere = Sample::from_name("sphere", Some(200)).unwrap();
    sphere.points.as_flattened_mut().iter_mut().for_each(|x| *x = f64::from(*x as f32));
    let n = sphere.points.len();
    let mut file = ShapeFile::from_mesh(sphere.points.clone(), sphere.faces);
    let normals: Vec<f32> = sphere.points.as_flattened().iter().map(|x| *x as f32).collect();
    file.add_vertex_field(Field::new("normal", 3, FieldValues::F32(normals))).unwrap();
    let tangent = |p: &[f64; 3]| {
        let length = p[0].hypot(p[1]).max(1e-9);
        [(-p[1] / length) as f32, (p[0] / length) as f32, 0.0, -1.0]
    };
    let tangents: Vec<f32> = sphere.points.iter().flat_map(tangent).collect();
    file.add_vertex_field(Field::new("tangent", 4, FieldValues::F32(tangents))).unwrap();
    let mut file = read(&write(&file, Format::GLB), "a.glb");
    let points = sheared(file.points());
    let attributes = file.move_points(points, MovedNormals::Follow, Progress::none()).unwrap();
    assert_eq!(attributes.followed, ["normals", "tangents"]);
    let mut out = Vec::new();
    write_bytes(&file, Format::GLB, &mut out).unwrap();
    let written = read(&out, "a.glb");
    let right = vertex_normals(written.points(), &triangles(&written));
    let normals = written.field("normal").unwrap().to_f64();
    assert!(worst(normals.as_chunks().0, &right) < ROUNDING);
    let tangents = written.field("tangent").unwrap();
    for (v, normal) in right.iter().enumerate().take(n) {
        let t: Vec<f64> = (0..4).map(|c| tangents.get(v, c)).collect();
        let along: f64 = (0..3).map(|c| t[c] * normal[c]).sum();
        let length: f64 = (0..3).map(|c| t[c] * t[c]).sum::<f64>().sqrt();
        assert!(along.abs() < ROUNDING && (length - 1.0).abs() < ROUNDING && t[3] == -1.0);
    }
}

#[test]
fn unmoved_points_change_no_byte() {
    let text = smooth_obj(1.0);
    let mut file = read(text.as_bytes(), "a.obj");
    let points = file.points().to_vec();
    let attributes = file.move_points(points, MovedNormals::Follow, Progress::none()).unwrap();
    assert_eq!(attributes.note(), None);
    assert_eq!(write(&file, Format::OBJ), text.as_bytes());
}

#[test]
fn libraries_of_materials_that_are_not_in_the_folder_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = read(smooth_obj(1.0).as_bytes(), "a.obj");
    assert_eq!(file.missing_references(Format::OBJ, folder.path()), ["mat.mtl"]);
    std::fs::write(folder.path().join("mat.mtl"), "newmtl red\n").unwrap();
    assert!(file.missing_references(Format::OBJ, folder.path()).is_empty());
    assert!(file.missing_references(Format::PLY, std::path::Path::new("none")).is_empty());
}
