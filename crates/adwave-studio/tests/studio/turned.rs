//! Parts of a mesh whose faces are turned over in the saved file.

use crate::client::Studio;
use crate::server::edit;
use adwave::sample::Sample;
use adwave_io::{ReadLimits, ShapeFile, read_path, write_path};
use serde_json::json;
use std::path::PathBuf;
use tempfile::TempDir;

/// Writes two spheres of a part each, the second of which is inside out.
fn two_parts(folder: &TempDir) -> PathBuf {
    let sample = Sample::from_name("sphere", Some(500)).unwrap();
    let n = sample.points.len() as u32;
    let mut points = sample.points.clone();
    points.extend(sample.points.iter().map(|&[x, y, z]| [x + 3.0, y, z]));
    let mut faces = sample.faces.clone();
    for face in sample.faces.iter() {
        faces.push(&[n + face[0], n + face[2], n + face[1]]);
    }
    let path = folder.path().join("two.ply");
    write_path(&ShapeFile::from_mesh(points, faces), &path, None).unwrap();
    path
}

#[test]
fn faces_that_point_inward_are_turned_in_the_saved_file() {
    let folder = TempDir::new().unwrap();
    let path = two_parts(&folder);
    let studio = Studio::on(&path, folder.path());
    let info = studio.get("/api/shapes/1").json();
    let n = info["n_vertices"].as_u64().unwrap() / 2;
    let volume = -info["inward"][0]["volume"].as_f64().unwrap();
    assert!((4.0..4.19).contains(&volume), "{volume}");
    assert_eq!(info["inward"].as_array().unwrap().len(), 1);
    assert_eq!(info["inward"][0]["vertex"], n);
    let parts = studio.get("/api/shapes/1/parts").body;
    let first = |v: u64| u32::from_le_bytes(parts[4 * v as usize..][..4].try_into().unwrap());
    assert_eq!((first(n - 1), u64::from(first(n)), u64::from(first(2 * n - 1))), (0, n, n));
    let turn = |revision: u64, parts: &[u64]| {
        let mut document = edit(revision, &[]);
        document["turned"] = json!(parts);
        studio.put("/api/shapes/1/edit", &document)
    };
    assert!(info["volume"].as_f64().unwrap().abs() < 1e-9, "one part adds what the other takes away");
    let moved = turn(1, &[n]).json();
    for side in 0..2 {
        assert!((moved["volume"][side].as_f64().unwrap() - 2.0 * volume).abs() < 1e-9, "{moved}");
    }
    let recipe = studio.get("/api/shapes/1/recipe").text();
    assert!(recipe.contains(&format!("turned = [{n}]")), "{recipe}");
    let saved = studio.get("/api/shapes/1/download?format=ply").body;
    std::fs::write(folder.path().join("saved.ply"), &saved).unwrap();
    let [before, after] =
        [&path, &folder.path().join("saved.ply")].map(|p| read_path(p, &ReadLimits::default()).unwrap());
    let half = before.faces().len() / 2;
    for f in 0..half {
        assert_eq!(before.faces().get(f), after.faces().get(f));
        let [a, b, c] = before.faces().get(f) else { panic!("no triangle") };
        assert_eq!(
            after.faces().get(half + f).iter().map(|v| *v - n as u32).collect::<Vec<_>>(),
            [*a, *b, *c]
        );
    }
    // What is no first vertex of a part is refused, and the edit stays.
    let refused = turn(2, &[n + 1]);
    assert_eq!(refused.status, 400);
    assert!(refused.text().contains(&format!("the part begins at vertex {n}")), "{}", refused.text());
    assert_eq!(turn(3, &[n, 0]).status, 400);
    assert_eq!(studio.get("/api/shapes/1/edit").json()["turned"], json!([n]));
    // Without it the file has its own bytes again.
    assert_eq!(turn(4, &[]).status, 200);
    assert_eq!(studio.get("/api/shapes/1/download?format=ply").body, std::fs::read(&path).unwrap());
}
