//! `--box` and `--resolution`: of LAS, COPC and EPT, and refused of all else.

use crate::common;

use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;

/// A COPC of 40 points in three levels, and an EPT of one tile of 10 000 points between 0 and 100.
fn files(folder: &Path) {
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds/copc/pages");
    fs::copy(seed, folder.join("a.copc.laz")).unwrap();
    run(folder, "sample terrain --points 1e4 -o b.laz");
    let tiles = folder.join("tiles");
    for part in ["ept-data", "ept-hierarchy"] {
        fs::create_dir_all(tiles.join(part)).unwrap();
    }
    let n = json(folder, "info b.laz")["health"]["vertices"].clone();
    fs::copy(folder.join("b.laz"), tiles.join("ept-data/0-0-0-0.laz")).unwrap();
    fs::write(tiles.join("ept-hierarchy/0-0-0-0.json"), format!("{{\"0-0-0-0\": {n}}}")).unwrap();
    let text = format!(
        r#"{{"bounds": [-1e5, -1e5, -1e5, 1e5, 1e5, 1e5], "dataType": "laszip", "points": {n}, "span": 128}}"#
    );
    fs::write(tiles.join("ept.json"), text).unwrap();
}

fn run(folder: &Path, line: &str) {
    adwave(folder).args(words(line)).args(["--quiet"]).assert().success();
}

#[test]
fn parts_are_read_by_all_commands_of_one_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    files(path);
    let said = json(path, "info a.copc.laz");
    assert_eq!(said["octree"], serde_json::json!({"spacing": 4.0, "points": [5, 5, 30]}));
    assert_eq!(said["health"]["vertices"], 40);
    assert_eq!(json(path, "info a.copc.laz --resolution 2")["health"]["vertices"], 10);
    let part = "--box 1000,1990,1020,2010";
    let in_box = json(path, &format!("convert a.copc.laz {part} -o c.laz"))["vertices"].as_u64().unwrap();
    assert!(in_box > 5 && in_box < 35, "{in_box}");
    assert_eq!(json(path, "info c.laz")["health"]["vertices"], in_box);
    assert!(json(path, "info c.laz")["octree"].is_null());
    let flat = json(path, "convert a.copc.laz --box 1000,1990,-1e3,1020,2010,1e3 -o d.laz");
    assert_eq!(flat["vertices"], in_box);
    // The numbers may begin with a minus.
    assert_eq!(json(path, "convert a.copc.laz --box -1,-1,1e4,1e4 -o e.ply")["vertices"], 40);
    for line in ["simplify a.copc.laz --ratio 0.5 -o s.laz", "render a.copc.laz -o r.png"] {
        run(path, &format!("{line} {part}"));
    }
    run(path, "saliency b.laz -j 2 --box -1e9,-1e9,1e9,1e9 -o m.laz");
    // What is written names the file without its folders.
    let whole_name = path.join("a.copc.laz");
    run(path, &format!("filter {} {part} --gains 0,1 -o p.laz", whole_name.display()));
    let written = fs::read(path.join("p.laz")).unwrap();
    let has = |text: &str| written.windows(text.len()).any(|part| part == text.as_bytes());
    assert!(has("a.copc.laz") && !has(&path.to_string_lossy()));
}

#[test]
fn tiles_are_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    files(path);
    for name in ["tiles", "tiles/ept.json"] {
        let said = json(path, &format!("info {name}"));
        assert_eq!((&said["format"], &said["health"]["vertices"]), (&"ept".into(), &10_000.into()));
        assert_eq!(said["octree"]["points"], serde_json::json!([10_000]));
    }
    assert_eq!(json(path, "convert tiles -o f.laz --resolution 100")["vertices"], 10_000);
    for name in ["tiles", "tiles/ept.json"] {
        let said = json(path, &format!("tiles {name} -o t.laz --magnitudes 1 --levels 3"));
        assert_eq!(said["summary"]["n_points"], 10_000);
    }
}

#[test]
fn what_cannot_be_read_in_part_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    files(path);
    run(path, "convert a.copc.laz -o g.ply");
    for (line, words) in [
        ("info g.ply --box 0,0,1,1", "g.ply: parts can be read of LAS, LAZ, COPC and EPT only"),
        ("info sample:sphere --resolution 1", "--box and --resolution apply to files"),
        ("info - --resolution 1", "--box and --resolution apply to files"),
        ("info b.laz --resolution 1", "b.laz: the file has no levels"),
        ("info a.copc.laz --resolution 0", "must be a length above 0"),
        ("info a.copc.laz --box 0,0,1,1", "contains no points"),
        ("info a.copc.laz --box 2,0,1,1", "along x, got 2.0 to 1.0"),
        ("info a.copc.laz --box 0,0,0,1,1,nan", "along z"),
    ] {
        let said = refused(path, &format!("{line} --quiet"));
        assert!(said.contains(words), "{line}: {said}");
    }
    for numbers in ["0,0,0,1,1", "0,0,a,1", "1", ""] {
        let outcome = adwave(path).args(["info", "a.copc.laz", "--box", numbers]).assert().code(2);
        let said = String::from_utf8(outcome.get_output().stderr.clone()).unwrap();
        assert!(said.contains("must be XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX"), "{said}");
    }
}
