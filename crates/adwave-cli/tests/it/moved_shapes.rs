//! Normals, borders and regions when the vertices of a shape move.

use crate::common;

use common::adwave;
use predicates::str::contains;
use std::fmt::Write;
use std::fs;

/// A terrain of 17 × 17 vertices with noise and a normal per vertex.
fn write_terrain(folder: &std::path::Path) -> Vec<[f64; 3]> {
    let (mut points, mut text) = (Vec::new(), "mtllib terrain.mtl\n".to_owned());
    for i in 0..17_u32 {
        for j in 0..17_u32 {
            let noise = f64::from((i * 7919 + j * 104_729) % 1000) / 1000.0 - 0.5;
            points.push([f64::from(i), f64::from(j), 0.3 * noise]);
        }
    }
    for p in &points {
        writeln!(text, "v {} {} {}", p[0], p[1], p[2]).unwrap();
    }
    for _ in &points {
        text += "vn 0 0 1\n";
    }
    for i in 0..16 {
        for j in 0..16 {
            let (a, b) = (17 * i + j + 1, 17 * (i + 1) + j + 1);
            writeln!(text, "f {a}//{a} {b}//{b} {0}//{0}\nf {a}//{a} {0}//{0} {1}//{1}", b + 1, a + 1)
                .unwrap();
        }
    }
    fs::write(folder.join("terrain.obj"), text).unwrap();
    points
}

fn statements(path: &std::path::Path, keyword: &str) -> Vec<[f64; 3]> {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| line.split_whitespace().next() == Some(keyword));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect();
        [numbers[0], numbers[1], numbers[2]]
    };
    lines.map(row).collect()
}

#[test]
fn denoise_keeps_the_border_and_stays_in_its_region() {
    let folder = tempfile::tempdir().unwrap();
    let points = write_terrain(folder.path());
    adwave(folder.path())
        .args(["denoise", "terrain.obj", "-o", "kept.obj", "--border", "keep"])
        .assert()
        .success();
    let kept = statements(&folder.path().join("kept.obj"), "v");
    let is_border = |p: &[f64; 3]| p[..2].iter().any(|&x| x == 0.0 || x == 16.0);
    assert!(points.iter().zip(&kept).all(|(p, q)| !is_border(p) || p == q));
    assert!(points.iter().zip(&kept).any(|(p, q)| p != q));
    let region = "half-space:point=8 0 0,normal=1 0 0,falloff=2";
    adwave(folder.path())
        .args(["denoise", "terrain.obj", "-o", "half.obj", "--region", region])
        .assert()
        .success();
    let half = statements(&folder.path().join("half.obj"), "v");
    assert!(points.iter().zip(&half).all(|(p, q)| p[0] > 4.0 || p == q));
    assert!(points.iter().zip(&half).any(|(p, q)| p != q));
    adwave(folder.path())
        .args(["denoise", "terrain.obj", "-o", "z.obj", "--signal", "z", "--border", "keep"])
        .assert()
        .code(2)
        .stderr(contains("--border applies to coordinates"));
}

#[test]
fn normals_of_an_obj_follow_its_points_unless_they_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    write_terrain(folder.path());
    adwave(folder.path())
        .args(["filter", "terrain.obj", "-o", "new.obj", "--preset", "smooth"])
        .assert()
        .success()
        .stderr(contains("normals were recomputed from the new positions"))
        .stderr(contains("refers to terrain.mtl"));
    let normals = statements(&folder.path().join("new.obj"), "vn");
    assert!(normals.iter().all(|n| (n.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-6 && n[2] > 0.5));
    assert!(normals.iter().any(|n| n[2] < 1.0));
    adwave(folder.path())
        .args(["filter", "terrain.obj", "-o", "old.obj", "--preset", "smooth", "--keep-normals"])
        .assert()
        .success()
        .stderr(contains("normals are those of the old positions"));
    assert!(statements(&folder.path().join("old.obj"), "vn").iter().all(|n| *n == [0.0, 0.0, 1.0]));
}

#[test]
fn columns_that_are_coordinates_are_named_in_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<String> = (0..40).map(|k| format!("{k},{},{},tree,{k}\n", k % 7, k % 5)).collect();
    let rows = rows.concat();
    fs::write(folder.path().join("a.csv"), format!("id,easting,northing,kind,elev\n{rows}")).unwrap();
    adwave(folder.path())
        .args(["info", "a.csv"])
        .assert()
        .success()
        .stderr(contains("the columns `easting`, `northing` and `elev` are x, y and z"))
        .stderr(contains("the column of text is left out: `kind`"));
}
