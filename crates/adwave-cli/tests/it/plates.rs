//! Clouds of two plates that are closer than their points.

use crate::common;

use adwave_io::{ReadLimits, read_path};
use common::{adwave, words};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Points of one plate.
const N: usize = 1600;

/// Two jittered grids of 40 × 40 points, 1 apart, at the heights 0 and `gap`, with noise of 0.05.
fn write_plates(path: &Path, gap: f64) {
    let mut state = 11_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut text = String::new();
    for i in 0..2 * N {
        let (x, y) = ((i % N % 40) as f64 + 0.3 * random(), (i % N / 40) as f64 + 0.3 * random());
        let normal = (0..12).map(|_| random()).sum::<f64>() - 6.0;
        let z = if i < N { 0.0 } else { gap };
        let _ = writeln!(text, "{x:.6} {y:.6} {:.6}", z + 0.05 * normal);
    }
    fs::write(path, text).unwrap();
}

fn thickness(path: &Path) -> f64 {
    let file = read_path(path, &ReadLimits::default()).unwrap();
    let mean = |points: &[[f64; 3]]| points.iter().map(|p| p[2]).sum::<f64>() / N as f64;
    mean(&file.points()[N..]) - mean(&file.points()[..N])
}

#[test]
fn denoising_tells_how_far_apart_close_plates_are_afterwards() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_plates(&path.join("plates.xyz"), 1.0);
    let line = "denoise plates.xyz -o out.xyz";
    let output = adwave(path).args(words(line)).output().unwrap();
    let notes = String::from_utf8(output.stderr).unwrap();
    let (_, afterwards) = notes.split_once("afterwards ").unwrap_or_else(|| panic!("{notes}"));
    let told: f64 = match afterwards.split_once("about ") {
        Some((_, rest)) => rest.split(';').next().unwrap().parse().unwrap(),
        None => 0.0,
    };
    let right = thickness(&path.join("out.xyz"));
    assert!((told - right).abs() < 0.1, "{told}, and right is {right}: {notes}");
    assert!(notes.contains("normals that point outwards"), "{notes}");
}
