//! `adwave reproduce`: bad requests are refused before any work, good ones make a page.

use crate::common;

use common::{adwave, json, refused};

#[test]
fn bad_requests_are_refused_in_one_line_before_anything_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::create_dir_all(path.join("empty/deep")).unwrap();
    std::fs::create_dir_all(path.join("broken")).unwrap();
    std::fs::write(path.join("broken/dinosaur.obj"), "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n").unwrap();
    let error = refused(path, "reproduce fig99 -o out");
    assert!(error.contains("'fig99'") && error.contains("fig15"), "{error}");
    let error = refused(path, "reproduce fig8 -o out --models nowhere");
    assert!(error.contains("nowhere"), "{error}");
    let error = refused(path, "reproduce fig8 -o out --models empty");
    assert!(error.contains("empty") && error.contains("armadillo") && error.contains("spot"), "{error}");
    let error = refused(path, "reproduce fig8 -o out --models broken");
    assert!(error.contains("'dinosaur'") && error.contains("dinosaur.obj"), "{error}");
    assert!(!path.join("out").exists());
    let error = refused(path, "reproduce fig8 -o broken/dinosaur.obj");
    assert!(error.contains("dinosaur.obj is a file"), "{error}");
    // A model that no figure asked for is not read.
    let made = json(path, "reproduce fig1 -o fine --models broken --most-vertices 1500");
    assert_eq!(made["figures"][0]["verdict"], "as-claimed");
}

#[test]
fn a_folder_that_cannot_be_made_is_trouble_with_the_machine() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let output = adwave(folder.path()).args(["reproduce", "fig8", "-o", "file/out"]).assert().code(1);
    let error = String::from_utf8(output.get_output().stderr.clone()).unwrap();
    assert!(error.contains("file/out") && error.trim_end().lines().count() == 1, "{error}");
}

#[test]
fn a_figure_is_made_and_described() {
    let folder = tempfile::tempdir().unwrap();
    let made = json(folder.path(), "reproduce fig8 -o out --most-vertices 1500");
    let figure = &made["figures"][0];
    assert_eq!(figure["id"], "fig8");
    assert!(figure["because"].as_str().unwrap().contains("sum of its levels"), "{figure}");
    for file in figure["files"].as_array().unwrap() {
        assert!(folder.path().join(file.as_str().unwrap()).is_file(), "{file}");
    }
    assert!(folder.path().join(made["index"].as_str().unwrap()).is_file());
}
