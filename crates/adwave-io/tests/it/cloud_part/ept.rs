//! Tests of Entwine point tiles, written here as a folder of LAZ.

use crate::cloud_part::copc_file::{LOW, SIDE, las, nodes};
use crate::cloud_part::{N, expected, numbers, parts, read};
use adwave_io::{CloudPart, Format, ReadLimits, cloud_levels, read_bytes, read_path, write_path};
use std::fs;
use std::path::Path;

/// Writes `ept.json`, the hierarchy (level 2 in separate files) and the tiles.
fn write(folder: &Path) {
    let [hierarchy, tiles] = ["ept-hierarchy", "ept-data"].map(|name| folder.join(name));
    fs::create_dir(&hierarchy).unwrap();
    fs::create_dir(&tiles).unwrap();
    let high = LOW.map(|x| x + SIDE);
    fs::write(
        folder.join("ept.json"),
        format!(
            r#"{{"bounds": [{}, {}, {}, {}, {}, {}], "dataType": "laszip", "hierarchyType": "json", "points": {N},
            "schema": [{{"name": "X", "type": "signed", "size": 4, "scale": 0.01, "offset": 1000}}], "span": 5,
            "srs": {{"wkt": "LOCAL_CS[\"else\"]"}}, "version": "1.0.0"}}"#,
            LOW[0], LOW[1], LOW[2], high[0], high[1], high[2]
        ),
    )
    .unwrap();
    let mut lists = std::collections::BTreeMap::<String, Vec<String>>::new();
    for ([d, x, y, z], points) in nodes(N) {
        let name = format!("{d}-{x}-{y}-{z}");
        let tile = read_bytes(las(&points), None, &ReadLimits::default()).unwrap();
        write_path(&tile, &tiles.join(format!("{name}.laz")), None).unwrap();
        let line = format!("\"{name}\": {}", points.len());
        match d {
            0 => lists.entry("0-0-0-0".into()).or_default().push(line),
            1 => {
                lists.entry("0-0-0-0".into()).or_default().push(format!("\"{name}\": -1"));
                lists.entry(name).or_default().push(line);
            }
            _ => lists.entry(format!("1-{}-{}-{}", x / 2, y / 2, z / 2)).or_default().push(line),
        }
    }
    for (name, lines) in lists {
        fs::write(hierarchy.join(format!("{name}.json")), format!("{{{}}}", lines.join(","))).unwrap();
    }
}

#[test]
fn a_part_of_tiles_is_their_points_by_level_and_node() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    for path in [folder.path().to_path_buf(), folder.path().join("ept.json")] {
        for (part, n_levels) in parts() {
            let shape = read(&path, &part).unwrap();
            assert_eq!(numbers(&shape), expected(&part, n_levels), "{part:?}");
            assert_eq!(shape.format(), Some(Format::EPT));
        }
        let whole = read_path(&path, &ReadLimits::default()).unwrap();
        assert_eq!(numbers(&whole), expected(&CloudPart::default(), 3));
        let levels = cloud_levels(&path, &ReadLimits::default()).unwrap().unwrap();
        assert_eq!((levels.spacing, levels.n_points), (4.0, vec![75, 75, 450]));
        let mut written = Vec::new();
        let report = adwave_io::write_bytes(&whole, Format::LAZ, &mut written).unwrap();
        assert!(report.not_written.is_empty());
        assert!(
            written.windows(9).any(|own| own == b"somewhere")
                && !written.windows(4).any(|own| own == b"else")
        );
    }
}

#[test]
fn what_is_wrong_with_tiles_is_said_in_one_line() {
    let replaced = |file: &str, from: &str, to: &str, words: &str| {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path());
        let path = folder.path().join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{text}");
        fs::write(&path, text.replace(from, to)).unwrap();
        let read = read_path(folder.path(), &ReadLimits::default());
        let error = read.map(|shape| shape.n_vertices()).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    };
    let root = "ept-hierarchy/0-0-0-0.json";
    replaced("ept.json", "laszip", "zstandard", "must be of type `laszip`, got `zstandard`");
    replaced("ept.json", "\"span\": 5", "\"span\": 0", "must describe an octree");
    replaced("ept.json", "\"points\": 600", "\"points\": 6", "exceed the 6 points of the cloud");
    replaced("ept.json", "{\"bounds\"", "\"bounds\"", "must be JSON");
    replaced(root, "\"0-0-0-0\": 75", "\"0-0-0-0\": 74", "has 75 points, but the hierarchy states 74");
    replaced(root, "0-0-0-0", "../../0-0-0-0", "must name a node");
    replaced(root, "0-0-0-0", "0-0-0-0-../a", "must name a node");
    replaced(root, "0-0-0-0\": 75", "0-0-0-0\": -1", "refers back to itself");
    replaced(root, "0-0-0-0\": 75", "2-0-0-0\": -1", "cannot be read");
    replaced(root, "0-0-0-0\": 75", "0-0-0-0\": 7.5", "must have an integer number of points");
}

#[test]
fn tiles_of_other_steps_and_missing_tiles_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path());
    let tile = folder.path().join("ept-data/0-0-0-0.laz");
    let mut bytes = fs::read(&tile).unwrap();
    bytes[131..139].copy_from_slice(&0.02_f64.to_le_bytes());
    fs::write(&tile, bytes).unwrap();
    let error = read_path(folder.path(), &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.contains("in format, scale or offset"), "{error}");
    fs::remove_file(&tile).unwrap();
    let error = read_path(folder.path(), &ReadLimits::default()).unwrap_err().to_string();
    assert!(error.contains("0-0-0-0.laz: the file cannot be read"), "{error}");
}
