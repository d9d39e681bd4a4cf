//! Laws of the published figures: the page of benchmarks and the comparison have the numbers of the measured pages.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// Rows of all tables of a page that begin with a cell, as their other cells.
fn cells_of_rows(page: &str, first: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(root().join("docs").join(page)).unwrap();
    let start = format!("| {first} |");
    let rows = text.lines().filter(|line| line.starts_with(&start));
    rows.map(|row| row.split('|').skip(2).map(|cell| cell.replace("**", "").trim().to_owned()).collect())
        .collect()
}

#[test]
fn the_page_of_benchmarks_has_the_measured_tables() {
    let differences = xtask::claims::differences(&root()).unwrap();
    assert!(differences.is_empty(), "{}", differences.join("\n"));
}

#[test]
fn the_comparison_has_the_measured_angles() {
    let heads = cells_of_rows("DENOISING.md", "pair");
    let columns = heads.iter().find(|cells| cells.iter().any(|cell| cell == "Taubin")).unwrap();
    let rows = cells_of_rows("DENOISING.md", "mean, published");
    let means = rows.iter().find(|cells| cells.len() == columns.len()).unwrap();
    let of = |name: &str| &means[columns.iter().position(|column| column == name).unwrap()];
    for (row, column) in [
        ("adwave", "adwave"),
        ("guided normal filtering", "guided"),
        ("bilateral normal filtering", "bilateral"),
        ("windowed sinc", "sinc"),
        ("MeshLab, Taubin", "Taubin"),
        ("MeshLib", "MeshLib"),
        ("MeshLab, two-step smoothing", "two-step"),
        ("noisy input", "noisy"),
    ] {
        let rows = cells_of_rows("COMPARISON.md", row);
        let found = rows.iter().any(|cells| &cells[0] == of(column));
        assert!(found, "COMPARISON.md, {row}: {rows:?}, measured {}", of(column));
    }
}
