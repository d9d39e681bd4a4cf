//! `adwave compare`: every method does its task, writes its files, and refuses what it cannot do.

use crate::common;

use common::{json, refused};

#[test]
fn every_method_writes_both_shapes_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    for method in
        ["mht", "lee", "feature-map", "sgwt", "dw", "bdw", "taubin", "bilateral", "guided", "subdivision"]
    {
        let line = format!("compare sample:torus --vertices 400 --levels 6 --with {method} -o {method}");
        let report = json(folder.path(), &line);
        assert_eq!(report["with"], method);
        assert!(report["rows"].as_array().unwrap().len() >= 3);
        for name in ["adwave.ply", &format!("{method}.ply"), "comparison.json"] {
            assert!(folder.path().join(method).join(name).is_file(), "{method}: {name}");
        }
    }
}

#[test]
fn what_a_method_cannot_do_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (method, flags, named) in [
        ("lee", "--as cloud", "mesh"),
        ("subdivision", "--as cloud", "mesh"),
        ("bilateral", "--as cloud", "mesh"),
        ("guided", "--field normals", "coordinates"),
        ("feature-map", "--field normals", "one channel"),
        ("dw", "--vertices 20000", "6000"),
        ("sgwt", "--as cloud --directed", "reversible"),
    ] {
        let text = refused(folder.path(), &format!("compare sample:torus --with {method} -o out {flags}"));
        assert!(text.contains(named), "{method}: {text}");
    }
}
