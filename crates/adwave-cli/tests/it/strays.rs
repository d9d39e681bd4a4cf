//! Strays and placeholders: named, without a say in default levels, and outside the frame of pictures.

use crate::common;

use common::{adwave, json, words};
use std::fmt::Write;
use std::fs;

/// A terrain of 40 × 40 points in UTM coordinates, and the lines of more points.
fn terrain(more: &[&str]) -> String {
    let mut text = String::new();
    for i in 0..1600_u32 {
        let height = 300.0 + 0.5 * f64::from(i % 40 / 4).sin();
        let _ = writeln!(text, "{} {} {height:.3}", 500_000 + i % 40, 5_400_000 + i / 40);
    }
    for line in more {
        let _ = writeln!(text, "{line}");
    }
    text
}

#[test]
fn info_names_what_takes_no_part_and_default_levels_ignore_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("good.xyz"), terrain(&[])).unwrap();
    fs::write(path.join("more.xyz"), terrain(&["0 0 0", "500003.5 5400003.5 -9999", "500007 5400007 900"]))
        .unwrap();
    let (good, more) = (json(path, "info good.xyz"), json(path, "info more.xyz"));
    assert_eq!(good["levels"], more["levels"]);
    assert!((good["extent"].as_f64().unwrap() - more["extent"].as_f64().unwrap()).abs() < 1e-6);
    assert!(more["diagonal"].as_f64().unwrap() > 1e6);
    assert_eq!(good["outsiders"]["placeholders"]["count"], 0);
    let rows = |kind: &str| more["outsiders"][kind]["first_rows"].clone();
    assert_eq!(
        (rows("placeholders"), rows("strays")),
        (serde_json::json!([1600, 1601]), serde_json::json!([1602]))
    );
    let output = adwave(path).args(words("filter more.xyz -o out.xyz --preset smooth")).output().unwrap();
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(notes.contains("2 placeholders without a real position (rows 1600, 1601)"), "{notes}");
    assert!(notes.contains("1 point far from all others (row 1602)"), "{notes}");
}

#[test]
fn a_cube_keeps_half_of_its_volume_by_default() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut text = String::new();
    for i in 0..8 {
        let _ = writeln!(text, "v {} {} {}", i & 1, i >> 1 & 1, i >> 2 & 1);
    }
    text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    fs::write(path.join("cube.obj"), text).unwrap();
    for preset in ["smooth", "suppress-paper"] {
        let report = json(path, &format!("filter cube.obj -o out.obj --preset {preset}"));
        assert!(report["volume"]["after"].as_f64().unwrap() > 0.5, "{report}");
    }
}

#[test]
fn a_picture_leaves_out_what_is_far_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("more.xyz"), terrain(&["0 0 0"])).unwrap();
    let line = "render more.xyz -o picture.png --size 60x40";
    let report = json(path, line);
    assert_eq!((&report["vertices_outside"], &report["frame"]), (&1.into(), &"main".into()));
    let output = adwave(path).args(words(line)).output().unwrap();
    assert!(String::from_utf8(output.stderr).unwrap().contains("leaves out 1 vertex"));
    let all = json(path, &format!("{line} --frame all"));
    assert_eq!(all["vertices_outside"], 0);
}
