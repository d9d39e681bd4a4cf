//! Fields of labels, whose mean is no label, and fields of faces.

use crate::common;

use adwave_io::{ReadLimits, read_path};
use common::{adwave, json, refused, words};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A grid of points: class 2 on the left, 6 on the right, and a wrong class in the middle of either side.
fn write_classes(path: &Path) {
    let mut text = String::from(
        "ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar classification\nproperty uchar intensity\nend_header\n",
    );
    for i in 0..400 {
        let (x, y) = (i % 20, i / 20);
        let class = match (x, y) {
            (5, 10) => 6,
            (15, 10) => 9,
            _ => [2, 6][usize::from(x >= 10)],
        };
        let _ = writeln!(text, "{x} {y} 0 {class} {}", (7 * i) % 50);
    }
    fs::write(path, text).unwrap();
}

fn classes(path: &Path) -> Vec<f64> {
    read_path(path, &ReadLimits::default()).unwrap().field("classification").unwrap().to_f64()
}

#[test]
fn labels_are_not_averaged_unless_they_are_taken_for_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_classes(&path.join("land.ply"));
    for line in [
        "filter land.ply -o o.ply --preset smooth --field classification",
        "denoise land.ply -o o.ply --field classification",
        "transform land.ply -o o.npz --field classification",
    ] {
        let error = refused(path, line);
        assert!(error.contains("classification has labels (2, 6, 9; 3 of them)"), "{error}");
        assert!(error.contains("--as-labels") && error.contains("--as-numbers"), "{error}");
        json(path, &format!("{line} --as-numbers"));
        json(path, &line.replace("classification", "intensity"));
    }
}

#[test]
fn labels_are_smoothed_by_the_share_of_each() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_classes(&path.join("land.ply"));
    let before = classes(&path.join("land.ply"));
    let line =
        "filter land.ply -o o.ply --preset suppress-paper --levels 3 --field classification --as-labels";
    let report = json(path, line);
    assert_eq!(report["labels"]["different"], 3);
    let after = classes(&path.join("o.ply"));
    assert_eq!((after[205], after[215]), (2.0, 6.0)); // the wrong ones follow their surroundings
    let changed: Vec<usize> = (0..400).filter(|&i| before[i] != after[i]).collect();
    assert_eq!(report["labels"]["changed"], changed.len());
    assert!(after.iter().all(|class| [2.0, 6.0].contains(class)));
    // Away from the wrong ones the border between the classes stays.
    assert!((0..400).filter(|i| !(8..13).contains(&(i / 20))).all(|i| before[i] == after[i]), "{changed:?}");
    // Without a change all labels stay.
    json(path, "filter land.ply -o o.ply --gains 1,1 --field classification --as-labels");
    assert_eq!(classes(&path.join("o.ply")), before);
    let error = refused(path, "filter land.ply -o o.ply --gains 1,1 --as-labels");
    assert!(error.contains("one label per vertex"), "{error}");
}

#[test]
fn a_field_of_faces_is_shown_and_named_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mesh = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element face 2\nproperty list uchar int vertex_indices\nproperty float pressure\nend_header\n\
                0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 1.5\n3 0 2 3 2.5\n";
    fs::write(path.join("mesh.ply"), mesh).unwrap();
    assert_eq!(json(path, "info mesh.ply")["face_fields"][0]["name"], "pressure");
    let text = adwave(path).args(words("info mesh.ply")).output().unwrap().stdout;
    assert!(String::from_utf8(text).unwrap().contains("face fields   pressure (1)"));
    let error = refused(path, "saliency mesh.ply -o o.ply --signal pressure");
    assert!(error.contains("pressure is a field of faces"), "{error}");
}
