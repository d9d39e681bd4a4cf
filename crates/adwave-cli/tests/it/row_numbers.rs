//! Clouds with points that have no position: every result has a row for each row of the file.

use crate::common;

use adwave_io::{ReadLimits, read_csv_fields, read_npy};
use common::{json, refused};
use std::fs;
use std::path::Path;

const N: usize = 30;

/// Position of row `i` of the frame; every seventh row has none.
fn position(i: usize) -> Option<[f64; 3]> {
    let (x, y) = ((i % N) as f64, (i / N) as f64);
    (i % 7 != 3).then(|| [x, y, 3.0 * (-((x - 10.0).powi(2) + (y - 12.0).powi(2)) / 20.0).exp()])
}

fn frame(path: &Path) {
    let rows: String = (0..N * N)
        .map(|i| position(i).map_or("nan nan nan\n".to_owned(), |[x, y, z]| format!("{x} {y} {z}\n")))
        .collect();
    let head = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        N * N
    );
    fs::write(path.join("frame.ply"), head + &rows).unwrap();
}

#[test]
fn arrays_have_a_row_for_each_row_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    frame(path);
    json(path, "saliency frame.ply --levels 4 -o map.npy");
    json(path, "filter frame.ply --preset smooth -o points.npy");
    json(path, "filter frame.ply --preset smooth --field z -o z.npy");
    json(path, "region frame.ply --region ball:vertex=400,radius=10% -o weight.csv");
    let limits = ReadLimits::default();
    let read = |name: &str| read_npy(&path.join(name), &limits).unwrap().into_field("array");
    for (name, n_channels) in [("map.npy", 1), ("points.npy", 3), ("z.npy", 1)] {
        let field = read(name);
        assert_eq!((field.len(), field.n_channels), (N * N, n_channels), "{name}");
        for i in 0..N * N {
            assert_eq!(field.get(i, 0).is_nan(), position(i).is_none(), "{name}, row {i}");
        }
    }
    let weight = &read_csv_fields(&path.join("weight.csv"), &limits).unwrap()[0];
    assert_eq!((weight.len(), weight.get(400, 0)), (N * N, 1.0));
    // The values of another file are numbered the same way.
    json(path, "filter frame.ply --preset smooth --field z.npy -o again.npy");
    assert_eq!(read("again.npy").len(), N * N);
}

#[test]
fn features_are_named_by_the_rows_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    frame(path);
    json(path, "features frame.ply --field z --theta 0.01 --levels 5 -o f.json");
    let found: serde_json::Value = serde_json::from_slice(&fs::read(path.join("f.json")).unwrap()).unwrap();
    let features = found["features"].as_array().unwrap();
    assert!(!features.is_empty());
    for feature in features {
        let at = position(feature["vertex"].as_u64().unwrap() as usize).unwrap();
        for axis in 0..3 {
            assert!((feature["position"][axis].as_f64().unwrap() - at[axis]).abs() < 1e-5, "{feature}");
        }
    }
}

#[test]
fn a_row_without_a_position_is_no_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    frame(path);
    let said = refused(path, "region frame.ply --quiet --region ball:vertex=3,radius=10%");
    assert!(said.contains("vertex 3 of frame.ply is left out"), "{said}");
}
