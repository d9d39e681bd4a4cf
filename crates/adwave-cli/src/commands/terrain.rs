//! `adwave sample terrain`: a made landscape as LAS or LAZ, of any number of points, written as it is made.

use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, print};
use crate::progress::with_progress;
use adwave_io::Format;
use adwave_tiles::Terrain;
use serde_json::json;
use std::path::{Path, PathBuf};

/// What it is called among the samples, and what it is.
pub(crate) const NAME: &str = "terrain";
pub(crate) const DESCRIPTION: &str =
    "flown laser scan of hills, houses and trees, made point by point: LAS or LAZ, --points";
pub(crate) const DEFAULT_POINTS: u64 = 1_000_000;
/// More would not fit in the 32-bit coordinates.
const MOST_POINTS: f64 = 1e13;
/// Most points of each file in a folder.
const PER_FILE: u64 = 20_000_000;

/// A number of points, which may be written as `1e8`.
pub(crate) fn parse_points(text: &str) -> Result<u64, String> {
    match text.parse::<f64>() {
        Ok(n) if n.fract() == 0.0 && (1.0..=MOST_POINTS).contains(&n) => Ok(n as u64),
        _ => Err(format!("give a whole number from 1 to {MOST_POINTS:e}, such as 1e8")),
    }
}

/// Writes `n` points into the file, or into some files in the folder.
pub(crate) fn write(global: &Global<'_>, n: u64, seed: u64, output: &Path) -> Result<(), CliError> {
    let is_file = match Format::from_path(output) {
        Some(Format::LAS | Format::LAZ) => true,
        _ if output.is_dir() => false,
        None if output.extension().is_none() && output != Path::new("-") => false,
        _ => {
            return Err(CliError::Input(format!(
                "{}: a {NAME} is a file in .las or .laz, or a folder of such; name one",
                output.display()
            )));
        }
    };
    let files = if is_file {
        check_writable(output)?;
        vec![(output.to_owned(), 0..n)]
    } else {
        std::fs::create_dir_all(output).map_err(|e| {
            CliError::Environment(format!("cannot make the folder {}: {e}", output.display()))
        })?;
        let file = |k: u64| {
            let path: PathBuf = output.join(format!("{NAME}-{:04}.laz", k + 1));
            (path, k * PER_FILE..((k + 1) * PER_FILE).min(n))
        };
        (0..n.div_ceil(PER_FILE)).map(file).collect()
    };
    let terrain = Terrain::new(n, seed);
    with_progress(global, "scanning", |progress| {
        files.iter().try_for_each(|(path, points)| terrain.write(path, points.clone(), progress))
    })
    .map_err(|e| CliError::of(&e))?;
    let count = if is_file { String::new() } else { format!(" in {} files", files.len()) };
    print(
        global,
        &format!("{NAME}: {n} points{count}\n{}\n", output.display()),
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
