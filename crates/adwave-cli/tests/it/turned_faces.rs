//! Faces that are turned over: `convert --turn-faces`, and `turned` of a recipe.

use crate::common::{json, refused};
use serde_json::json as value;

#[test]
fn faces_turned_twice_are_the_file_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let read = |name: &str| std::fs::read(path.join(name)).unwrap();
    for ending in ["ply", "stl", "obj"] {
        json(path, &format!("sample sphere --vertices 60 -o s.{ending}"));
        let told = json(path, &format!("convert s.{ending} -o t.{ending} --turn-faces all"));
        assert_eq!(told["turned"], value!({"parts": 1, "faces": 116}), "{ending}");
        assert_ne!(read(&format!("t.{ending}")), read(&format!("s.{ending}")), "{ending}");
        json(path, &format!("convert t.{ending} -o u.{ending} --turn-faces inward"));
        assert_eq!(read(&format!("u.{ending}")), read(&format!("s.{ending}")), "{ending}");
        let told = json(path, &format!("convert s.{ending} -o v.{ending} --turn-faces inward"));
        assert_eq!(told["turned"], value!({"parts": 0, "faces": 0}), "{ending}");
        assert_eq!(read(&format!("v.{ending}")), read(&format!("s.{ending}")), "{ending}");
    }
}

#[test]
fn a_recipe_turns_the_parts_that_it_names() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    json(path, "sample sphere --vertices 60 -o s.ply");
    json(path, "convert s.ply -o t.ply --turn-faces all");
    std::fs::write(path.join("r.toml"), "levels = 3\nturned = [0]\n").unwrap();
    let told = json(path, "filter t.ply -o w.ply --recipe r.toml --save-recipe again.toml");
    assert_eq!(told["turned"], value!({"parts": 1, "faces": 116}));
    assert_eq!(std::fs::read(path.join("w.ply")).unwrap(), std::fs::read(path.join("s.ply")).unwrap());
    assert!(std::fs::read_to_string(path.join("again.toml")).unwrap().contains("turned = [0]"));
    let error = refused(path, "filter t.ply -o w.ply --recipe r.toml --signal z");
    assert!(error.contains("the signal is z") && error.contains("remove it from the recipe"), "{error}");
    std::fs::write(path.join("r.toml"), "levels = 3\nturned = [5]\n").unwrap();
    let error = refused(path, "filter t.ply -o w.ply --recipe r.toml");
    assert!(
        error.contains("vertex 5 must be the first one of its part; the part begins at vertex 0"),
        "{error}"
    );
}

#[test]
fn a_cloud_has_no_faces_to_turn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    json(path, "sample sphere --vertices 60 -o s.xyz");
    let error = refused(path, "convert s.xyz -o t.xyz --turn-faces all");
    assert!(error.contains("--turn-faces applies to meshes, and s.xyz has no faces"), "{error}");
}
