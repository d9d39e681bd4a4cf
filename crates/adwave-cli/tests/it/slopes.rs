//! Heights and fields on a slope that is sampled irregularly.

use crate::common;

use adwave_io::{ReadLimits, read_path};
use common::{json, refused};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The six digits that the file has, and the extent times the bar of the interior.
const STAYS: f64 = 1e-6;

/// Random points on z = x/2 in a square of side 60, about 1.3 apart, with noise.
fn write_slope(path: &Path, noise: f64) {
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut text = String::new();
    for _ in 0..2200 {
        let (x, y) = ((60e3 * random()).round() / 1e3, 60.0 * random());
        let normal = (0..12).map(|_| random()).sum::<f64>() - 6.0;
        let _ = writeln!(text, "{x:.3} {y:.6} {:.6}", x / 2.0 + noise * normal);
    }
    fs::write(path, text).unwrap();
}

/// Root mean square and largest distance of the heights from the plane.
fn off_plane(path: &Path) -> (f64, f64) {
    let file = read_path(path, &ReadLimits::default()).unwrap();
    let off: Vec<f64> = file.points().iter().map(|p| (p[2] - p[0] / 2.0).abs()).collect();
    let square: f64 = off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64;
    (square.sqrt(), off.iter().copied().fold(0.0, f64::max))
}

#[test]
fn slopes_stay_and_their_noise_goes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_slope(&path.join("plane.xyz"), 0.0);
    write_slope(&path.join("noisy.xyz"), 0.05);
    for (line, fit) in [
        ("filter IN.xyz -o out.xyz --preset smooth --along z", "linear"),
        ("filter IN.xyz -o out.xyz --preset smooth --field z", "linear"),
        ("denoise IN.xyz -o out.xyz --field z", "linear"),
        ("filter IN.xyz -o out.xyz --preset smooth --along z --local-fit constant", "constant"),
    ] {
        let report = json(path, &line.replace("IN", "plane"));
        assert_eq!(report["local_fit"], fit, "{line}");
        let (_, largest) = off_plane(&path.join("out.xyz"));
        assert_eq!(largest <= STAYS, fit == "linear", "{line}: {largest}");
        json(path, &line.replace("IN", "noisy"));
        let (rms, _) = off_plane(&path.join("out.xyz"));
        assert_eq!(rms <= 0.35 * 0.05, fit == "linear", "{line}: {rms}");
    }
    let noise = json(path, "denoise plane.xyz -o out.xyz --field z")["denoise"][0]["noise"].as_f64().unwrap();
    assert!(noise <= STAYS, "{noise}");
}

#[test]
fn a_recipe_keeps_the_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_slope(&path.join("noisy.xyz"), 0.05);
    let edit = "filter noisy.xyz -o direct.xyz --preset smooth --along z --levels 4 --local-fit constant";
    json(path, &format!("{edit} --save-recipe edit.toml --save-steps"));
    assert!(fs::read_to_string(path.join("edit.toml")).unwrap().contains("local_fit = \"constant\""));
    json(path, "filter noisy.xyz -o again.xyz --recipe edit.toml");
    assert_eq!(fs::read(path.join("direct.xyz")).unwrap(), fs::read(path.join("again.xyz")).unwrap());
}

#[test]
fn coordinates_in_several_directions_take_no_fit() {
    let folder = tempfile::tempdir().unwrap();
    write_slope(&folder.path().join("plane.xyz"), 0.0);
    let error = refused(folder.path(), "filter plane.xyz -o o.xyz --preset smooth --local-fit linear");
    assert!(error.contains("--along z"), "{error}");
    let error = refused(folder.path(), "denoise plane.xyz -o o.xyz --local-fit linear");
    assert!(error.contains("--signal"), "{error}");
}
