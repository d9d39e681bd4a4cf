//! `adwave sample terrain`: a synthetic landscape of any number of points as LAS or LAZ, written while it is generated.

use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{check_writable, count, make_folder, print};
use adwave_io::Format;
use adwave_tiles::{Terrain, TilesError};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Name and description in the list of samples.
pub(crate) const NAME: &str = "terrain";
pub(crate) const DESCRIPTION: &str =
    "airborne laser scan of hills, houses and trees; LAS or LAZ of any number of --points";
pub(crate) const DEFAULT_POINTS: u64 = 1_000_000;
/// Largest number of points that the 32-bit coordinates can hold.
const MOST_POINTS: f64 = 1e13;
/// Most points of a file in a folder.
const PER_FILE: u64 = 20_000_000;

/// A number of points, which may be written as `1e8`.
pub(crate) fn parse_points(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(n) if n.fract() == 0.0 && (1.0..=MOST_POINTS).contains(&n) => Ok(n as u64),
        _ => Err(format!("must be a whole number in 1..={MOST_POINTS:e}, such as 1e8")),
    }
}

/// Writes `n` points into a file, or into several files in a folder.
pub(crate) fn write(global: &Global<'_>, n: u64, seed: u64, output: &Path) -> Result<(), CliError> {
    let is_file = match Format::from_path(output) {
        Some(Format::LAS | Format::LAZ) => true,
        _ if output.is_dir() => false,
        None if output.extension().is_none() && output != Path::new("-") => false,
        _ => {
            return Err(CliError::Input(format!(
                "{}: a {NAME} is written as a .las or .laz file, or into a folder of such files",
                output.display()
            )));
        }
    };
    let files = if is_file {
        check_writable(output)?;
        vec![(output.to_owned(), 0..n)]
    } else {
        make_folder(output)?;
        let file = |k: u64| {
            let path: PathBuf = output.join(format!("{NAME}-{:04}.laz", k + 1));
            (path, k * PER_FILE..((k + 1) * PER_FILE).min(n))
        };
        (0..n.div_ceil(PER_FILE)).map(file).collect()
    };
    let terrain = Terrain::new(n, seed);
    with_progress(global, "scanning", |progress| {
        files.iter().try_for_each(|(path, points)| {
            global.files.write_with(path, |staged| {
                terrain.write(staged, points.clone(), progress).map_err(|error| match error {
                    TilesError::Write(error) => error.about_file(path).into(),
                    other => CliError::classify(&other),
                })
            })
        })
    })?;
    let in_files =
        if is_file { String::new() } else { format!(" in {}", count(files.len(), "file", "files")) };
    print(
        global,
        &format!("{NAME}: {}{in_files}\n{}\n", count(n, "point", "points"), output.display()),
        &json!({
            "sample": NAME,
            "points": n,
            "output": output.display().to_string(),
            "files": files.iter().map(|(path, _)| path.display().to_string()).collect::<Vec<_>>(),
        }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_points_may_have_exponents() {
        assert_eq!(parse_points("1e8"), Ok(100_000_000));
        assert_eq!(parse_points("12345"), Ok(12_345));
        for bad in ["0", "-1", "1.5", "1e99", "nan", "inf", "many", ""] {
            assert!(parse_points(bad).is_err(), "{bad}");
        }
    }
}
