//! Matching of shapes with a known motion, or with no common motion: runs the example `match_cases` of
//! `adwave-register`.

use crate::{StepResult, data, run};
use std::process::Command;

/// Surfaces that are cut, viewed and compared, relative to the folder of test data; missing files are left out. The
/// flower pot coincides with itself after a rotation.
const FILES: [&str; 13] = [
    "benchmarks/FandosA-gaze-saliency/gaze_ply/bunny.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/camel.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/chair.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/dragon.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/flowerpot.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/hand.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/horse.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/octopus.ply",
    "benchmarks/FandosA-gaze-saliency/gaze_ply/torso.ply",
    "denoise/fertility-n3/clean.obj",
    "paper/common-3d-test-models/fandisk.obj",
    "paper/geom-algo-segmentation/skull.off",
    "paper/mesh_saliency_simplification/kitten.obj",
];

/// Prints the tables and draws the calibration. `arguments`: `--seeds choose|final`, `--cases N`, `--seconds N` and
/// `--curve FILE`.
pub(crate) fn bench_match(arguments: &[&str]) -> StepResult {
    let (mut seeds, mut cases, mut seconds) = ("choose", "40", "3600");
    let mut curve = "target/match-calibration.svg";
    for pair in arguments.chunks(2) {
        match *pair {
            ["--seeds", value @ ("choose" | "final")] => seeds = value,
            ["--cases", value] if value.parse::<u64>().is_ok() => cases = value,
            ["--seconds", value] if value.parse::<u64>().is_ok() => seconds = value,
            ["--curve", value] => curve = value,
            _ => {
                return Err(format!(
                    "bench-match: {} is not understood; see `cargo xtask help`",
                    pair.join(" ")
                ));
            }
        }
    }
    let files = FILES.iter().map(|name| data().join(name)).filter(|path| path.is_file());
    run(Command::new("cargo")
        .args([
            "run",
            "--release",
            "--locked",
            "--quiet",
            "-p",
            "adwave-register",
            "--example",
            "match_cases",
            "--",
        ])
        .args([seeds, cases, seconds, curve])
        .args(files))
}
