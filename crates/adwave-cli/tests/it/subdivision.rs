//! Levels of subdivision: `info`, `simplify --level`, `transform --basis`, and shares of variance.

use crate::common;

use adwave_subdivision::subdivide;
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
        ("transform ball.obj --as cloud -o c.npz --basis butterfly", "mesh of triangles"),
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
