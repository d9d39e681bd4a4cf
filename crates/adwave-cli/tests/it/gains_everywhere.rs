//! Gains that hold everywhere, which are one polynomial of the operator and keep no bands.

use crate::common;

use adwave_io::{ReadLimits, read_path};
use common::{adwave, words};
use std::path::Path;

/// Largest relative error of each band by default; positions differ by no more, times the size of the shape.
const ACCURACY: f64 = 1e-10;

/// Positions that `line` writes to out.ply, and its report without the lines that name files.
fn edited(folder: &Path, line: &str) -> (Vec<[f64; 3]>, Vec<String>) {
    let output = adwave(folder).args(words(line)).assert().success().get_output().clone();
    let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    let report = text.lines().filter(|line| !line.contains(".toml") && !line.starts_with("out.ply"));
    let file = read_path(&folder.join("out.ply"), &ReadLimits::default()).unwrap();
    (file.points().to_vec(), report.map(str::to_owned).collect())
}

#[test]
fn one_polynomial_gives_the_positions_and_the_report_of_all_bands() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let shapes = [
        "sample:creature --vertices 3000",
        "sample:plane --vertices 900",
        "sample:creature --vertices 2000 --operator surface",
        "sample:sphere --vertices 1500 --weld 0",
    ];
    let edits = [
        "--preset smooth",
        "--preset enhance --levels 6",
        "--preset suppress-paper --levels 5",
        "--preset band2 --lengths '1%,2%,4%'",
        "--gains 1,1,0.5",
        "--gains 1,1,1",
        "--preset smooth --keep-volume twice --levels 5",
        "--preset smooth --along normal --border free --levels 4",
    ];
    for shape in shapes {
        for edit in edits {
            let line = format!("filter {shape} {edit} -o out.ply");
            // A recipe takes the bits of interactive edits, which keep the bands.
            let (expected, expected_report) = edited(path, &format!("{line} --save-recipe edit.toml"));
            let (found, report) = edited(path, &line);
            assert_eq!(report, expected_report, "{line}");
            let size = expected.as_flattened().iter().fold(0.0_f64, |size, c| size.max(c.abs()));
            for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((found - expected).abs() <= ACCURACY * size, "{line}: {found} and {expected}");
            }
            assert!(size > 0.0 && found.len() == expected.len());
        }
    }
}
