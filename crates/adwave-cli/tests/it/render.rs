//! `adwave render`: pictures of the size that was asked for, and refusals before any long work.

use crate::common;

use common::{adwave, json, refused, words};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Width, height and channels as the file itself has them.
fn header(path: &Path) -> (u32, u32, u8) {
    let bytes = fs::read(path).unwrap();
    assert_eq!(&bytes[1..4], b"PNG");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20), bytes[25])
}

#[test]
fn vectors_are_drawn_where_there_are_any() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let line = "render sample:sphere --vertices 2000 -o a.png --size 200x150 --glyphs coords";
    let n_glyphs = json(path, line)["glyphs"].as_u64().unwrap();
    assert!((200..2000).contains(&n_glyphs), "{n_glyphs}");
    assert_eq!(json(path, &line.replace(" --glyphs coords", ""))["glyphs"], 0);
    let said = refused(path, &line.replace("coords", "x"));
    assert!(said.contains("vectors of three components, and x has 1 number"), "{said}");
    adwave(path).args(words("sample hills --vertices 400 -o dem.tif")).assert().success();
    assert!(refused(path, "render dem.tif -o b.png --glyphs values").contains("meshes and point clouds"));
}

#[test]
fn pictures_have_the_size_and_ground_that_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let made =
        json(path, "render sample:sphere --vertices 500 -o a.png --size 200x150 --color mean-curvature");
    assert_eq!((made["width"].as_u64(), made["height"].as_u64()), (Some(200), Some(150)));
    assert_eq!(header(&path.join("a.png")), (200, 150, 2));
    json(
        path,
        "render sample:sphere --vertices 500 -o b.png --size 200x150 --transparent --view -30,20 --up z",
    );
    assert_eq!(header(&path.join("b.png")), (200, 150, 6));
    let made = json(
        path,
        "render sample:sphere sample:torus --vertices 500 -o c.png --size 100x80 --grid=3 --color plain --color \
         gaussian-curvature --own-scale",
    );
    assert_eq!(made["shapes"][1]["colors"][1], "gaussian-curvature");
    let (width, height, _) = header(&path.join("c.png"));
    assert!(width == 300 && height > 160, "{width} {height}");
}

#[test]
fn colors_look_the_same_in_numbers_of_any_type() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut pictures = Vec::new();
    // Bytes, bytes in words as scanners write them, words, and fractions.
    for (kind, factor) in [("uchar", 1.0), ("ushort", 1.0), ("ushort", 257.0), ("float", 1.0 / 255.0)] {
        let color = ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat();
        let row = |k: u32| {
            let (x, y) = (k % 10, k / 10);
            let [r, g, b] = [20 * x, 255 - 20 * y, 130].map(|byte| f64::from(byte) * factor);
            format!("{x} {y} 0 {r} {g} {b}\n")
        };
        let rows: String = (0..100).map(row).collect();
        let head = "ply\nformat ascii 1.0\nelement vertex 100\nproperty float x\nproperty float y\nproperty float z\n";
        fs::write(path.join("a.ply"), format!("{head}{color}end_header\n{rows}")).unwrap();
        json(path, "render a.ply --color color -o a.png --size 120x90");
        pictures.push(fs::read(path.join("a.png")).unwrap());
    }
    json(path, "render a.ply --color plain -o a.png --size 120x90");
    let plain = fs::read(path.join("a.png")).unwrap();
    for (k, picture) in pictures.iter().enumerate() {
        assert!(*picture == pictures[0], "type {k}");
        assert!(*picture != plain, "type {k}");
    }
}

#[test]
fn a_place_can_be_looked_at_from_near() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let sphere = "render sample:sphere --vertices 500 --size 90x90 -o a.png";
    let whole = json(path, sphere);
    assert_eq!(
        (&whole["zoom"], &whole["focus"], &whole["projection"]),
        (&1.0.into(), &Value::Null, &"perspective".into())
    );
    let near = json(path, &format!("{sphere} --focus 0,-1,0.5"));
    assert_eq!((&near["zoom"], &near["focus"]), (&4.0.into(), &serde_json::json!([0.0, -1.0, 0.5])));
    let nearer = json(path, &format!("{sphere} --focus vertex=7 --zoom 2.5 --orthographic"));
    assert_eq!((&nearer["zoom"], &nearer["projection"]), (&2.5.into(), &"orthographic".into()));
    assert_eq!(nearer["focus"].as_array().unwrap().len(), 3);
}

#[test]
fn land_lies_and_models_stand() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let row = |x: u32, y: u32| format!("{x} {y} {}\n", f64::from(x * x % 7) / 4.0);
    let land: String = (0..400).map(|k| row(k % 20, k / 20)).collect();
    fs::write(path.join("land.xyz"), &land).unwrap();
    json(path, "sample sphere --vertices 300 -o brain.gii");
    for (shape, more, axis, why) in [
        ("land.xyz", "", "z", "as low and open as land"),
        ("land.xyz", " --up y", "y", ""),
        ("brain.gii", "", "z", "the GIFTI"),
        ("sample:sphere --vertices 300", "", "y", "as most models"),
    ] {
        let line = format!("render {shape} --size 60x60 -o a.png{more}");
        let made = json(path, &line);
        assert_eq!(made["up"]["axis"], axis, "{line}");
        assert!(made["up"]["guessed"].as_str().unwrap_or_default().contains(why), "{line}: {}", made["up"]);
        let text = adwave(path).args(words(&line)).assert().success().get_output().stdout.clone();
        assert_eq!(String::from_utf8(text).unwrap().contains("--up x, y or z sets it"), more.is_empty());
    }
}

#[test]
fn a_region_is_shown_as_a_field_of_weights() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let line = "render sample:sphere --vertices 500 --size 200x150 -o a.png --region 'ball:vertex=0,radius=20%' --region \
                'vertices:indices=99'";
    assert_eq!(json(path, line)["shapes"][0]["colors"][0], "weight");
    json(
        path,
        "region sample:sphere --vertices 500 -o m.ply --region 'ball:vertex=0,radius=20%|vertices:indices=99'",
    );
    json(path, "render m.ply --size 200x150 -o b.png --color weight --range 0,1");
    assert_eq!(fs::read(path.join("a.png")).unwrap(), fs::read(path.join("b.png")).unwrap());
}

#[test]
fn the_same_command_makes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for (name, threads) in [("a.png", "1"), ("b.png", "2")] {
        let arguments = ["render", "sample:knot", "-o", name, "--size", "160x120", "--threads", threads];
        adwave(folder.path()).args(arguments).assert().success();
    }
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("a.png"), read("b.png"));
}

#[test]
fn features_are_shown_from_the_files_that_features_writes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut counts = Vec::new();
    for file in ["f.csv", "f.json"] {
        json(
            path,
            &format!(
                "features sample:plane --vertices 2000 --levels 7 --operator walk --theta 1.6 -o {file}"
            ),
        );
        let made = json(
            path,
            &format!("render sample:plane --vertices 2000 -o f.png --size 90x90 --features {file}"),
        );
        counts.push(made["features"].as_u64().unwrap());
    }
    assert!(counts[0] > 0 && counts[0] == counts[1], "{counts:?}");
    for file in ["none.csv", "none.json"] {
        json(
            path,
            &format!(
                "features sample:plane --vertices 2000 --levels 7 --operator walk --theta 1e9 -o {file}"
            ),
        );
        let line = format!("render sample:plane --vertices 2000 -o f.png --size 90x90 --features {file}");
        assert_eq!(json(path, &line)["features"], 0, "{file}");
    }
}

#[test]
fn bad_requests_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("other.csv"), "a,b\n1,2\n").unwrap();
    fs::write(
        path.join("graph.mtx"),
        "%%MatrixMarket matrix coordinate real symmetric\n3 3 2\n2 1 1\n3 2 1\n",
    )
    .unwrap();
    for (arguments, words) in [
        ("sample:sphere -o a.png --size 99999x99999", "pixels per side, got 99999x99999"),
        ("sample:sphere -o a.png --colormap sepia --color density", "viridis"),
        ("sample:sphere -o a.png --color heat", "coords"),
        ("sample:sphere -o a.jpg", ".png"),
        ("sample:sphere -o nowhere/a.png", "nowhere"),
        ("sample:sphere sample:torus -o a.png", "--grid"),
        ("sample:sphere -o a.png --features other.csv", "sigma"),
        ("sample:sphere -o a.png --features missing.json", "missing.json"),
        ("graph.mtx -o a.png", "no positions"),
        ("missing.obj -o a.png", "missing.obj"),
        ("sample:sphere -o a.png --zoom 0", "got 0.0"),
        ("sample:sphere -o a.png --zoom nan", "got NaN"),
        ("sample:sphere -o a.png --zoom 1e9", "at most 277 "),
        ("sample:sphere -o a.png --focus vertex=999999", "below the number of vertices"),
        ("sample:sphere -o a.png --focus 1e9,0,0", "far from the shape"),
        ("sample:sphere -o a.png --region 'ball:vertex=999999,radius=1'", "vertex 999999"),
        ("sample:sphere -o a.png --region 'field:name=heat'", "heat"),
    ] {
        let error = refused(path, &format!("render {arguments}"));
        assert!(error.contains(words), "{arguments}: {error}");
    }
    assert!(!path.join("a.png").exists());
}

#[test]
fn flags_that_cannot_be_parsed_say_what_they_want() {
    let folder = tempfile::tempdir().unwrap();
    for (flag, value, words) in [
        ("--size", "0x10", "at least 1"),
        ("--size", "wide", "WIDTHxHEIGHT"),
        ("--view", "sideways", "three-quarter"),
        ("--view", "10,100", "-90..=90"),
        ("--range", "3,1", "LOW,HIGH"),
        ("--up", "w", "x, y or z"),
        ("--focus", "1,2", "vertex=N"),
        ("--region", "bal:radius=1", "no region 'bal'"),
    ] {
        let run = adwave(folder.path())
            .args(["render", "sample:sphere", "-o", "a.png", flag, value])
            .assert()
            .code(2);
        let error = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert!(error.contains(words), "{flag} {value}: {error}");
    }
}
