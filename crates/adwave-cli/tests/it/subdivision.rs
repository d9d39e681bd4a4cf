//! Levels of subdivision: `info`, `simplify --level`, `transform --basis`, and shares of variance.

use crate::common;

use adwave::shape::Polygons;
use adwave_subdivision::{subdivide, subdivide_polygons};
use adwave_test_data::data_test;
use common::{json, real_files, refused};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Writes an octahedron cut `n_levels` times, on the sphere, as `ball.obj`, with a field in `bump.csv`.
fn write_ball(folder: &Path, n_levels: usize) -> usize {
    let mut points: Vec<[f64; 3]> = (0..6_u8)
        .map(|k| [0, 1, 2].map(|c| if c == k / 2 { 1.0 - 2.0 * f64::from(k % 2) } else { 0.0 }))
        .collect();
    let mut triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..n_levels {
        let finer = subdivide(points.len(), &triangles);
        for [a, b] in finer.parents {
            let sum = [0, 1, 2].map(|k| points[a as usize][k] + points[b as usize][k]);
            let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
            points.push(sum.map(|x| x / length));
        }
        triangles = finer.triangles;
    }
    let (mut text, mut field) = (String::new(), "bump\n".to_owned());
    for p in &points {
        let _ = writeln!(text, "v {} {} {}", p[0], p[1], p[2]);
        let _ = writeln!(field, "{}", (3.0 * p[0]).sin() * p[1] + (-20.0 * (p[2] - 0.5).powi(2)).exp());
    }
    for t in &triangles {
        let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    fs::write(folder.join("ball.obj"), text).unwrap();
    fs::write(folder.join("bump.csv"), field).unwrap();
    points.len()
}

#[test]
fn info_tells_the_levels_and_simplify_takes_one() {
    let folder = tempfile::tempdir().unwrap();
    let n = write_ball(folder.path(), 4);
    let info = json(folder.path(), "info ball.obj");
    assert_eq!(info["subdivision"]["levels"], 4);
    assert_eq!(info["subdivision"]["vertices"], serde_json::json!([n, 258, 66, 18, 6]));
    let text = common::adwave(folder.path()).args(["info", "ball.obj"]).output().unwrap().stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("subdivision   4 levels, 1026 → 6 vertices"), "{text}");
    let coarse = json(folder.path(), "simplify ball.obj -o coarse.obj --level 2");
    assert_eq!((&coarse["vertices"]["after"], &coarse["faces"]["after"]), (&66.into(), &128.into()));
    // The chord of an edge of a sphere of radius 1 that spans 22.5 to 30 degrees.
    let error = coarse["error"]["greatest"].as_f64().unwrap();
    assert!((0.02..0.08).contains(&error), "{error}");
    let info = json(folder.path(), "info coarse.obj");
    assert_eq!(info["subdivision"]["vertices"], serde_json::json!([66, 18, 6]));
    assert!(json(folder.path(), "info sample:creature --vertices 2000")["subdivision"].is_null());
}

#[test]
fn coefficients_go_to_a_file_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let n = write_ball(folder.path(), 4);
    for family in ["butterfly", "linear", "loop", "irregular"] {
        let line = format!("transform ball.obj -o c.ply --basis {family} --signal bump.csv");
        let report = json(folder.path(), &line);
        let counts: u64 =
            report["coefficients"].as_array().unwrap().iter().map(|c| c.as_u64().unwrap()).sum();
        assert_eq!(counts, n as u64, "{family}");
        json(
            folder.path(),
            &format!("transform c.ply -o back.csv --basis {family} --signal coefficient --inverse"),
        );
        let read = |name: &str| -> Vec<f64> {
            let text = fs::read_to_string(folder.path().join(name)).unwrap();
            text.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect()
        };
        let (before, after) = (read("bump.csv"), read("back.csv"));
        assert_eq!(before.len(), after.len());
        assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-6), "{family}");
        let kept = json(folder.path(), &format!("{line} --keep 0.2"));
        let error = kept["error"].as_f64().unwrap();
        let limit = if family == "irregular" { 0.08 } else { 0.05 };
        assert!(error > 0.0 && error < limit, "{family}: {error}");
        assert_eq!(kept["kept"], (0.2 * n as f64).ceil() as u64);
    }
    let haar =
        json(folder.path(), "transform ball.obj -o haar.npz --basis haar --signal bump.csv --keep 0.2");
    assert_eq!(haar["elements"], "faces");
    assert!(folder.path().join("haar.npz").is_file());
}

/// Writes a prism over a pentagon, cut three times onto a bumpy ball of quadrilaterals, as `quads.obj`.
fn write_quads(folder: &Path) {
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k % 5) / 5.0;
    let point = |k: u32| [turn(k).cos(), turn(k).sin(), if k < 5 { -0.8 } else { 0.8 }];
    let mut points: Vec<[f64; 3]> = (0..10).map(point).collect();
    let sides = (0..5).map(|k| vec![k, (k + 1) % 5, 5 + (k + 1) % 5, 5 + k]);
    let all: Vec<Vec<u32>> = sides.chain([vec![4, 3, 2, 1, 0], vec![5, 6, 7, 8, 9]]).collect();
    let mut faces: Polygons = all.iter().map(Vec::as_slice).collect();
    for _ in 0..3 {
        let finer = subdivide_polygons(points.len(), &faces);
        let sum = |corners: &[u32]| {
            corners.iter().fold([0.0; 3], |s, &v| [0, 1, 2].map(|k| s[k] + points[v as usize][k]))
        };
        let new: Vec<[f64; 3]> =
            finer.edges.iter().map(|edge| sum(edge)).chain(faces.iter().map(sum)).collect();
        points.extend(new);
        faces = finer.faces;
    }
    let mut text = String::new();
    for p in &points {
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt() / (1.0 + 0.05 * (9.0 * p[0]).sin());
        let _ = writeln!(text, "v {} {} {}", p[0] / length, p[1] / length, p[2] / length);
    }
    for face in faces.iter() {
        let corners: Vec<String> = face.iter().map(|v| (v + 1).to_string()).collect();
        let _ = writeln!(text, "f {}", corners.join(" "));
    }
    fs::write(folder.join("quads.obj"), text).unwrap();
}

#[test]
fn quadrilaterals_have_levels_and_are_written_again() {
    let folder = tempfile::tempdir().unwrap();
    write_quads(folder.path());
    let info = json(folder.path(), "info quads.obj");
    assert_eq!(info["subdivision"]["vertices"], serde_json::json!([482, 122, 32, 10]));
    assert_eq!(info["subdivision"]["scheme"], "quadrilaterals");
    let text = common::adwave(folder.path()).args(["info", "quads.obj"]).output().unwrap().stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("subdivision   3 levels, 482 → 10 vertices (Catmull-Clark)"), "{text}");
    let coarse = json(folder.path(), "simplify quads.obj -o coarse.obj --level 3");
    assert_eq!((&coarse["vertices"]["after"], &coarse["faces"]["after"]), (&10.into(), &7.into()));
    let written = fs::read_to_string(folder.path().join("coarse.obj")).unwrap();
    let mut corners: Vec<usize> = written
        .lines()
        .filter(|line| line.starts_with("f "))
        .map(|line| line.split_whitespace().count() - 1)
        .collect();
    corners.sort_unstable();
    assert_eq!(corners, [4, 4, 4, 4, 4, 5, 5]);
    for family in ["catmull-clark", "linear", "irregular"] {
        let line = format!("transform quads.obj -o c.ply --basis {family} --signal z");
        json(folder.path(), &line);
        let back = format!("transform c.ply -o back.npy --basis {family} --signal coefficient --inverse");
        json(folder.path(), &back);
        let kept = json(folder.path(), &format!("{line} --keep 0.2"));
        assert!(kept["error"].as_f64().unwrap() < 0.08, "{family}: {}", kept["error"]);
    }
    for (line, named) in [
        ("transform quads.obj -o c.npz --basis butterfly", "is for triangles"),
        ("transform quads.obj -o c.npz --basis haar --signal z", "is for triangles"),
        ("transform quads.obj -o c.npz --sharp-edges 30", "--sharp-edges applies to coefficients"),
        ("transform quads.obj -o c.npz --basis catmull-clark --sharp-edges 200", "0..=180"),
        ("simplify quads.obj -o c.obj --level 4", "0..=3"),
    ] {
        let text = refused(folder.path(), line);
        assert!(text.contains(named), "{line}: {text}");
    }
}

#[test]
fn an_edited_level_carries_its_detail() {
    let folder = tempfile::tempdir().unwrap();
    write_quads(folder.path());
    let read = |name: &str| {
        let path = folder.path().join(name);
        let file = adwave_io::read_path(&path, &adwave_io::ReadLimits::default()).unwrap();
        (file.points().to_vec(), file.faces().clone())
    };
    let report = json(folder.path(), "rebase quads.obj --write-base base.obj --level 2");
    assert_eq!((&report["vertices"], &report["faces"]), (&32.into(), &30.into()));
    json(folder.path(), "rebase quads.obj --base base.obj --level 2 -o same.obj");
    let (points, faces) = read("quads.obj");
    let (same, same_faces) = read("same.obj");
    assert_eq!(faces, same_faces);
    let distance = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    assert!(distance(&points, &same) < 1e-12);
    // The base turned by a right angle about z turns the mesh.
    let (base, base_faces) = read("base.obj");
    let turned = base.iter().map(|p| [-p[1], p[0], p[2]]).collect();
    let file = adwave_io::ShapeFile::from_mesh(turned, base_faces);
    adwave_io::write_path(&file, &folder.path().join("turned.obj"), None).unwrap();
    json(folder.path(), "rebase quads.obj --base turned.obj --level 2 -o out.obj");
    let expected: Vec<[f64; 3]> = points.iter().map(|p| [-p[1], p[0], p[2]]).collect();
    assert!(distance(&read("out.obj").0, &expected) < 1e-12);
    for (line, named) in [
        ("rebase quads.obj --base quads.obj --level 2 -o o.obj", "level 2 has 32 vertices"),
        ("rebase quads.obj --write-base b.obj --level 4", "0..=3"),
        ("rebase quads.obj --write-base b.obj --level 1 --family loop", "is for triangles"),
        ("rebase quads.obj --write-base b.obj --sharp-edges 20", "--sharp-edges applies to --level"),
    ] {
        let text = refused(folder.path(), line);
        assert!(text.contains(named), "{line}: {text}");
    }
}

#[test]
fn values_of_faces_come_back_from_their_coefficients() {
    let folder = tempfile::tempdir().unwrap();
    write_ball(folder.path(), 3);
    let haar = "--basis haar --signal";
    json(folder.path(), &format!("transform ball.obj -o means.ply {haar} bump.csv"));
    json(folder.path(), &format!("transform means.ply -o field.ply {haar} coefficient --inverse"));
    let again = json(folder.path(), &format!("transform field.ply -o again.ply {haar} field"));
    assert_eq!(again["elements"], "faces");
    let of = |name: &str, field: &str| {
        let file =
            adwave_io::read_path(&folder.path().join(name), &adwave_io::ReadLimits::default()).unwrap();
        file.face_fields().iter().find(|f| f.name == field).unwrap().to_f64()
    };
    let (first, second) = (of("means.ply", "coefficient"), of("again.ply", "coefficient"));
    let greatest = first.iter().zip(&second).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(first.iter().any(|c| c.abs() > 1e-3) && greatest < 1e-14, "{greatest}");
    let error =
        refused(folder.path(), &format!("transform means.ply -o back.csv {haar} coefficient --inverse"));
    assert!(error.contains("belong to faces"), "{error}");
}

#[test]
fn what_a_basis_cannot_do_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    write_ball(folder.path(), 3);
    for (line, named) in [
        ("transform sample:creature --vertices 2000 -o c.npz --basis butterfly", "no levels of subdivision"),
        ("transform ball.obj --as cloud -o c.npz --basis butterfly", "--basis needs a mesh"),
        ("transform ball.obj -o c.npz --basis butterfly --keep 2", "0..=1"),
        ("transform ball.obj -o c.npz --basis butterfly --levels 3", "--levels applies to bands"),
        ("transform ball.obj -o c.npz --basis butterfly --operator surface", "--operator applies to bands"),
        ("transform ball.obj -o c.npz --keep 0.1", "--basis"),
        ("transform ball.obj -o c.ply --basis haar --inverse", "the faces have no field"),
        ("transform ball.obj -o c.csv --basis haar --signal bump.csv", "faces"),
        ("transform ball.obj -o c.npz --basis butterfly --inverse --signal bump.csv", "--inverse"),
        ("transform ball.obj -o c.npz --basis butterfly --inverse --keep 0.1", "--keep"),
        ("simplify ball.obj -o c.obj --level 4", "0..=3"),
        ("simplify ball.obj -o c.obj --level 1 --keep-border", "--keep-border"),
        ("simplify sample:creature -o c.obj --level 1", "no levels of subdivision"),
    ] {
        let text = refused(folder.path(), line);
        assert!(text.contains(named), "{line}: {text}");
    }
}

#[test]
fn shares_of_variance_are_a_column_of_detail() {
    let folder = tempfile::tempdir().unwrap();
    write_ball(folder.path(), 4);
    let info = json(folder.path(), "info ball.obj --detail --levels 5");
    let levels = info["detail"]["levels"].as_array().unwrap();
    let shares: Vec<f64> = levels.iter().map(|level| level["share"].as_f64().unwrap()).collect();
    let rest = info["detail"]["rest_share"].as_f64().unwrap();
    assert!((shares.iter().sum::<f64>() + rest - 1.0).abs() < 1e-12);
    assert!(shares.iter().all(|share| *share >= 0.0) && rest > 0.5, "{shares:?} {rest}");
}

#[data_test]
fn sulcal_depth_keeps_its_form_with_a_tenth_of_the_coefficients() {
    let folder = tempfile::tempdir().unwrap();
    let data = real_files().join("fields/nilearn-fsaverage5");
    let file = |name: &str| data.join(name).display().to_string();
    let line = |family: &str| {
        let (white, depth) = (file("white_left.gii.gz"), file("sulc_left.gii.gz"));
        format!("transform '{white}' -o c.npz --basis {family} --signal '{depth}' --keep 0.1")
    };
    let report = json(folder.path(), &line("butterfly"));
    assert_eq!(report["sizes"], serde_json::json!([10242, 2562, 642, 162, 42, 12]));
    assert!(report["error"].as_f64().unwrap() <= 0.112, "{report}");
    assert!(json(folder.path(), &line("irregular"))["error"].as_f64().unwrap() <= 0.16);
    let flat =
        refused(folder.path(), &format!("transform '{}' -o c.npz --basis linear", file("flat_left.gii.gz")));
    assert!(flat.contains("no levels of subdivision: ") && flat.contains("vertex"), "{flat}");
}
