//! Features that a picture shows as balls, from the files of `adwave features`.

use crate::error::CliError;
use adwave_io::ReadLimits;
use adwave_render::Ball;
use serde_json::Value;
use std::path::Path;

/// Color of the balls.
const GREEN: [u8; 3] = [52, 168, 83];

/// True if a table of features has only its head, because no features were found.
fn has_no_row(path: &Path) -> bool {
    /// Upper bound of the length of a head in bytes.
    const HEAD: u64 = 4096;
    if !std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() < HEAD) {
        return false;
    }
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let columns: Vec<&str> = text.trim().split(',').collect();
    ["x", "y", "z", "sigma"].iter().all(|name| columns.contains(name)) && text.trim().lines().count() == 1
}

/// The balls for the features in a file of `adwave features`.
pub(super) fn read_balls(path: &Path) -> Result<Vec<Ball>, CliError> {
    let shown = path.display();
    let rows: Vec<[f64; 4]> = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        let text = std::fs::read_to_string(path).map_err(|e| CliError::Input(format!("{shown}: {e}")))?;
        let json: Value =
            serde_json::from_str(&text).map_err(|e| CliError::Input(format!("{shown}: {e}")))?;
        let list = json.get("features").unwrap_or(&json).as_array();
        let list =
            list.ok_or_else(|| CliError::Input(format!("{shown}: it must hold a list of features")))?;
        let row = |f: &Value| {
            let number = |name: &str| f.get(name).and_then(Value::as_f64);
            let position = |k: usize| f.get("position").and_then(|p| p.get(k)).and_then(Value::as_f64);
            let at = |k: usize, name: &str| number(name).or_else(|| position(k));
            Some([at(0, "x")?, at(1, "y")?, at(2, "z")?, number("sigma")?])
        };
        let missing = |k: usize| CliError::Input(format!("{shown}: feature {k} has no x, y, z and sigma"));
        list.iter().enumerate().map(|(k, f)| row(f).ok_or_else(|| missing(k))).collect::<Result<_, _>>()?
    } else if has_no_row(path) {
        Vec::new()
    } else {
        let fields = adwave_io::read_csv_fields(path, &ReadLimits::default()).map_err(CliError::input)?;
        let columns = ["x", "y", "z", "sigma"].map(|name| fields.iter().find(|f| f.name == name));
        let [Some(x), Some(y), Some(z), Some(sigma)] = columns else {
            return Err(CliError::Input(format!(
                "{shown}: it must have the columns x, y, z and sigma, as in files of 'adwave features -o FILE.csv'"
            )));
        };
        (0..x.len()).map(|k| [x, y, z, sigma].map(|f| f.get(k, 0))).collect()
    };
    Ok(rows.into_iter().map(|[x, y, z, radius]| Ball { center: [x, y, z], radius, color: GREEN }).collect())
}
