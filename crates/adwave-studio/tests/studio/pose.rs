//! Poses and clones of detail: stored, replayed, and followed while a handle is dragged.

use crate::client::Studio;
use crate::server::{creature, edit, layer, replayed};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A pose that pulls a vertex by a vector and pins a ball about another.
fn pulled(vertex: u32, by: [f64; 3]) -> Value {
    let pin = json!({"vertices": {"indices": [900], "radius": "10%"}});
    let region = json!({"vertices": {"indices": [vertex], "radius": 0}});
    json!({"fixed": {"any": [pin]}, "handle": [{"by": by, "region": region}]})
}

#[test]
fn a_pose_bends_the_edit_and_is_replayed_by_its_recipe() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 6000);
    let studio = Studio::on(&path, folder.path());
    let gains = [0.0, 0.5, 1.25, 1.0, 1.0, 1.0, 1.0, 1.0];
    let with_pose = |revision: u64, gains: &[f64], pose: &Value| {
        let mut edit = edit(revision, &[layer(gains, &Value::Null)]);
        edit["pose"] = pose.clone();
        studio.put("/api/shapes/1/edit", &edit)
    };
    let rest = studio.get("/api/shapes/1/positions").floats();
    let pose = pulled(3000, [0.3, 0.2, -0.4]);
    assert_eq!(with_pose(1, &gains, &pose).status, 200);
    let bent = studio.get("/api/shapes/1/exact").floats();
    let recipe = studio.get("/api/shapes/1/recipe").text();
    let saved = studio.post("/api/shapes/1/save", &json!({})).json();
    let bytes = std::fs::read(saved["path"].as_str().unwrap()).unwrap();
    assert!(bytes == replayed(&path, &recipe), "{recipe}");
    // A drag by another way ends in the same bits.
    for k in 0..5 {
        let pose = json!({"pose": pulled(3000, [0.1 * f64::from(k), 0.9, 0.4])});
        assert_eq!(studio.post("/api/shapes/1/pose?follow=step", &pose).status, 200);
    }
    assert_eq!(with_pose(2, &[1.0; 8], &pose).status, 200);
    assert_eq!(with_pose(3, &gains, &pose).status, 200);
    assert_eq!(studio.get("/api/shapes/1/exact").floats(), bent);
    // The shape at rest in the pose, and the rotations of its detail.
    let carried = studio.post("/api/shapes/1/pose", &json!({"pose": pose})).body;
    let n = rest.len() / 3;
    assert_eq!(carried.len(), 20 * n);
    assert_eq!(with_pose(4, &[1.0; 8], &pose).status, 200);
    let places: Vec<f32> = carried[..12 * n].as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    assert_eq!(studio.get("/api/shapes/1/exact").floats(), places);
    for row in carried[12 * n..].as_chunks::<8>().0 {
        let turn: Vec<f64> =
            row.as_chunks().0.iter().map(|b| f64::from(i16::from_le_bytes(*b)) / 32767.0).collect();
        assert!((turn.iter().map(|c| c * c).sum::<f64>() - 1.0).abs() < 1e-3);
    }
    // Some of the vertices.
    let drawn: Vec<u8> = [3000_u32, 5, 900].iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(studio.ask("PUT", "/api/shapes/1/drawn", &drawn).status, 200);
    let few = studio.post("/api/shapes/1/pose?of=drawn", &json!({"pose": pose})).body;
    assert_eq!((few.len(), &few[..12]), (60, &carried[36000..36012]));
    assert_eq!(studio.ask("PUT", "/api/shapes/1/drawn", &u32::MAX.to_le_bytes()).status, 400);
    // Other levels keep the pose, and so does another session.
    assert_eq!(studio.put("/api/shapes/1/levels", &json!({"levels": 5})).status, 200);
    assert_eq!(studio.get("/api/shapes/1/exact").floats(), places);
    drop(studio);
    let studio = Studio::on(&path, folder.path());
    assert_eq!(studio.get("/api/shapes/1/edit").json()["pose"]["handle"][0]["by"], json!([0.3, 0.2, -0.4]));
    assert_eq!(studio.get("/api/shapes/1/exact").floats(), places);
    // The recipe brings the pose back.
    assert_eq!(studio.ask("PUT", "/api/shapes/1/recipe", recipe.as_bytes()).status, 200);
    assert_eq!(studio.get("/api/shapes/1/exact").floats(), bent);
}

#[test]
fn a_bad_pose_is_refused_and_changes_nothing() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let studio = Studio::on(&path, folder.path());
    let good = pulled(1500, [0.1, 0.0, 0.0]);
    let ask = |pose: &Value| studio.post("/api/shapes/1/pose", &json!({"pose": pose}));
    assert_eq!(ask(&good).status, 200);
    let far = pulled(1500, [1e70, 0.0, 0.0]);
    let handles = |n: usize| json!({"handle": vec![good["handle"][0].clone(); n]});
    for (pose, named) in [
        (pulled(99999, [0.0; 3]), "99999"),
        (far, "finite"),
        (handles(201), "at most 200"),
        (json!({"handle": [{"by": [0, 0, 0]}]}), "region"),
        (handles(2), "no vertex"),
    ] {
        let answer = ask(&pose);
        assert_eq!(answer.status, 400, "{pose}");
        assert!(answer.error().contains(named), "{}", answer.error());
    }
    let before = studio.get("/api/shapes/1/exact").floats();
    let mut bad = edit(1, &[]);
    bad["pose"] = pulled(99999, [0.0; 3]);
    assert_eq!(studio.put("/api/shapes/1/edit", &bad).status, 400);
    assert_eq!(studio.get("/api/shapes/1/exact").floats(), before);
    assert_eq!(ask(&good).status, 200);
}

#[test]
fn clones_of_detail_lie_on_top_of_the_layers_and_are_replayed() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 6000);
    let studio = Studio::on(&path, folder.path());
    let clone = |targets: &[u32]| json!({"source": 3000, "targets": targets, "radius": "6%", "angle": 45.0});
    let put = |revision: u64, gains: &[f64], clones: &Value| {
        let mut edit = edit(revision, &[layer(gains, &Value::Null)]);
        edit["clones"] = clones.clone();
        studio.put("/api/shapes/1/edit", &edit)
    };
    let exact = || studio.get("/api/shapes/1/exact").floats();
    let rest = exact();
    assert_eq!(put(1, &[1.0; 8], &json!([clone(&[900])])).status, 200);
    let one = exact();
    let n_moved = one.as_chunks::<3>().0.iter().zip(rest.as_chunks::<3>().0).filter(|(a, b)| a != b).count();
    assert!(n_moved > 5 && n_moved < 1000, "{n_moved}");
    let gains = [0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    let clones = json!([clone(&[900, 910]), clone(&[2000])]);
    assert_eq!(put(2, &gains, &clones).status, 200);
    let recipe = studio.get("/api/shapes/1/recipe").text();
    let saved = studio.post("/api/shapes/1/save", &json!({})).json();
    let bytes = std::fs::read(saved["path"].as_str().unwrap()).unwrap();
    assert!(bytes == replayed(&path, &recipe), "{recipe}");
    let all = exact();
    assert_eq!(put(3, &[1.0; 8], &json!([clone(&[900])])).status, 200);
    assert_eq!(exact(), one);
    assert_eq!(studio.ask("PUT", "/api/shapes/1/recipe", recipe.as_bytes()).status, 200);
    assert_eq!(exact(), all);
    let bad = json!([{"source": 99999, "targets": [1], "radius": 0.1}]);
    let answer = put(9, &gains, &bad);
    assert!(answer.status == 400 && answer.error().contains("99999"), "{}", answer.text());
    assert_eq!(exact(), all);
}
