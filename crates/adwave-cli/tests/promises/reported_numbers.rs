//! Numbers of reports, compared with numbers computed from the files that the runs wrote, into new files and over old ones.

use crate::fixtures::{INPUTS, fixtures};
use crate::harness::{Faults, PATIENCE, Run, commands, is_in_sample, run_line, run_words};
use crate::option_cases::{base_line, base_lines, with_words};
use adwave_io::{ReadLimits, ShapeFile, read_path};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Difference that rounding of coordinates in files may make, relative to the size of the shape.
const ROUNDING: f64 = 1e-5;

/// A run with its report.
struct Reported<'a> {
    folder: &'a Path,
    run: Run,
    json: Value,
    /// The shape that was read, if there is one.
    input: Option<ShapeFile>,
    /// File of the result.
    output: std::path::PathBuf,
}

fn read(path: &Path) -> Option<ShapeFile> {
    read_path(path, &ReadLimits::default()).ok()
}

fn clear(folder: &Path) {
    let _ = fs::remove_dir_all(folder.join("out"));
    fs::create_dir_all(folder.join("out")).unwrap();
}

/// A report without the times of this run.
fn without_times(json: &Value) -> Value {
    match json {
        Value::Object(entries) => entries
            .iter()
            .filter(|(key, _)| {
                !["seconds", "milliseconds", "peak_memory_bytes", "bytes"].contains(&key.as_str())
            })
            .map(|(key, value)| (key.clone(), without_times(value)))
            .collect(),
        Value::Array(values) => values.iter().map(without_times).collect(),
        other => other.clone(),
    }
}

fn is_near(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= ROUNDING * scale.abs().max(1.0)
}

impl Reported<'_> {
    fn number(&self, path: &str) -> Option<f64> {
        self.json.pointer(path)?.as_f64()
    }

    fn expect_number(&self, path: &str, expected: f64, scale: f64, faults: &mut Faults) {
        if let Some(found) = self.number(path) {
            faults.expect(is_near(found, expected, scale), || {
                format!("{}: {path} is {found}, the file says {expected}", self.run.line)
            });
        }
    }

    /// Counts of a shape: of its vertices and faces, before and after.
    fn check_counts(&self, faults: &mut Faults) {
        let is_json = self.output.extension().is_some_and(|e| e == "csv" || e == "png");
        let Some(shape) = read(&self.output).filter(|_| !is_json) else { return };
        let (n, n_faces) = (shape.n_vertices() as f64, shape.faces().len() as f64);
        for (path, expected) in [
            ("/vertices", n),
            ("/vertices/after", n),
            ("/faces", n_faces),
            ("/faces/after", n_faces),
            ("/summary/n_points", n),
        ] {
            self.expect_number(path, expected, 0.0, faults);
        }
        if let Some(input) = &self.input {
            self.expect_number("/vertices/before", input.n_vertices() as f64, 0.0, faults);
            self.expect_number("/faces/before", input.faces().len() as f64, 0.0, faults);
        }
    }

    /// Size of the file in bytes, in text.
    fn check_size(&self, text: &Run, faults: &mut Faults) {
        let size = fs::metadata(&self.output).map_or(0, |file| file.len());
        let line = text.out.lines().find(|line| line.contains("size") && line.ends_with(" bytes"));
        if let Some(line) = line {
            faults.expect(line.contains(&format!(" {size} bytes")), || {
                format!("{}: {line}, not {size}", text.line)
            });
        }
    }

    /// Movement of the vertices, and area and volume, which `info` measures on the files.
    fn check_movement(&self, faults: &mut Faults) {
        let (Some(input), Some(output)) = (&self.input, read(&self.output)) else { return };
        if self.json.get("moved").is_none() || input.n_vertices() != output.n_vertices() {
            return;
        }
        let distance = |k: usize| -> f64 {
            let (a, b) = (input.points()[k], output.points()[k]);
            (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()
        };
        let distances: Vec<f64> = (0..input.n_vertices()).map(distance).collect();
        let max = distances.iter().copied().fold(0.0, f64::max);
        let rms = (distances.iter().map(|d| d * d).sum::<f64>() / distances.len() as f64).sqrt();
        let scale = max.max(1e-3);
        self.expect_number("/moved/max", max, scale, faults);
        self.expect_number("/moved/rms", rms, scale, faults);
        if let Some(vertex) = self.number("/moved/furthest_vertex").filter(|_| max > 0.0) {
            let found = distances[vertex as usize];
            faults.expect(is_near(found, max, scale), || {
                format!("{}: vertex {vertex} moved by {found}, another by {max}", self.run.line)
            });
        }
        let info = run_line(self.folder, &format!("info {} --json", self.output.display()));
        let info: Value = serde_json::from_str(&info.out).unwrap_or_default();
        for name in ["area", "volume"] {
            if let Some(measured) = info.pointer(&format!("/health/{name}")).and_then(Value::as_f64) {
                self.expect_number(&format!("/{name}/after"), measured, measured, faults);
            }
        }
    }

    /// Values of fields: weights of regions, maps, differences.
    fn check_fields(&self, faults: &mut Faults) {
        let Some(output) = read(&self.output) else { return };
        let values = |name: &str| output.field(name).map(adwave_io::Field::to_f64);
        if let Some(weights) = values("weight") {
            let n = |is_counted: fn(&f64) -> bool| weights.iter().filter(|w| is_counted(w)).count() as f64;
            self.expect_number("/weight_above_0", n(|w| *w > 0.0), 0.0, faults);
            self.expect_number("/weight_1", n(|w| *w == 1.0), 0.0, faults);
        }
        if let Some(map) = values("saliency") {
            let known = || map.iter().copied().filter(|v| !v.is_nan());
            let (least, most) =
                (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
            self.expect_number("/largest", most, most, faults);
            self.expect_number("/smallest", least, least, faults);
            for (path, expected) in [("/largest_vertex", most), ("/smallest_vertex", least)] {
                if let Some(vertex) = self.number(path) {
                    let found = map[vertex as usize];
                    faults.expect(is_near(found, expected, expected), || {
                        format!("{}: {path} has {found}", self.run.line)
                    });
                }
            }
        }
        if let Some(field) = output.field("difference") {
            let values = field.to_f64();
            let length = |row: &[f64]| row.iter().map(|v| v * v).sum::<f64>().sqrt();
            let lengths: Vec<f64> = values.chunks_exact(field.n_channels).map(length).collect();
            let greatest = lengths.iter().copied().filter(|v| !v.is_nan()).fold(0.0, f64::max);
            self.expect_number("/difference/greatest", greatest, greatest, faults);
        }
    }

    /// Rows of tables, and sizes of pictures.
    fn check_tables(&self, faults: &mut Faults) {
        let extension = self.output.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
        if extension == "csv"
            && let Ok(text) = fs::read_to_string(&self.output)
        {
            let n_rows = text.lines().count().saturating_sub(1);
            for key in ["features", "pairs"] {
                if let Some(list) = self.json.get(key).and_then(Value::as_array) {
                    faults.expect(list.len() == n_rows, || {
                        format!("{}: {} {key}, {n_rows} rows", self.run.line, list.len())
                    });
                }
            }
        }
        if extension == "png"
            && let Ok(picture) = image::open(&self.output)
        {
            self.expect_number("/width", picture.width().into(), 0.0, faults);
            self.expect_number("/height", picture.height().into(), 0.0, faults);
        }
    }

    /// Numbers of vertices and the like in the text, which are those of the report.
    fn check_text(&self, text: &Run, faults: &mut Faults) {
        for (path, noun) in [("/vertices", "vert"), ("/faces", "face")] {
            if let (Some(n), true) = (self.number(path), text.out.contains(noun)) {
                faults.expect(text.out.contains(&n.to_string()), || {
                    format!("{}: the text has no {n} {noun}…", text.line)
                });
            }
        }
    }
}

/// The file behind `-o`.
fn output_of(words: &[String]) -> Option<&String> {
    let at = words.iter().position(|word| word == "-o" || word == "--output")?;
    words.get(at + 1)
}

#[test]
fn numbers_of_reports_are_those_of_the_files() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        for line in base_lines(command.get_name()) {
            for (kind, file) in INPUTS {
                if !is_in_sample(&format!("{line} {kind}"), 6) {
                    continue;
                }
                let mut words = base_line(line, kind);
                if kind == "scan" && line.contains("{in}") {
                    // Reports count the points that take part.
                    words.push("--all-points".to_owned());
                }
                let Some(output) =
                    output_of(&words).map(|name| folder.join(name)).filter(|p| p.extension().is_some())
                else {
                    continue;
                };
                clear(folder);
                let as_json = with_words(&words, &["--json".to_owned()]);
                let run = run_words(folder, &as_json, PATIENCE);
                faults.inspect(&run);
                if !run.is_done() {
                    continue;
                }
                // Over an old and longer file, and as text.
                fs::write(&output, vec![b'x'; 300_000]).unwrap();
                let again = run_words(folder, &as_json, PATIENCE);
                let size = fs::metadata(&output).map_or(0, |file| file.len());
                let told = serde_json::from_str::<Value>(&again.out).unwrap_or_default()["bytes"].as_u64();
                faults.expect(told.is_none_or(|told| told == size), || {
                    format!("{}: {told:?} bytes, not {size}", again.line)
                });
                fs::write(&output, vec![b'x'; 300_000]).unwrap();
                let text = run_words(folder, &words, PATIENCE);
                faults.inspect(&text);
                let [json, again] =
                    [&run, &again].map(|run| serde_json::from_str::<Value>(&run.out).unwrap_or_default());
                faults.expect(json["output"].is_string(), || {
                    format!("{}: the report names no output", run.line)
                });
                faults.expect(without_times(&json) == without_times(&again), || {
                    format!("{}: another report over an old file", run.line)
                });
                let input = line.contains("{in}").then(|| read(&folder.join(file))).flatten();
                let reported = Reported { folder, run, json, input, output };
                reported.check_counts(&mut faults);
                reported.check_size(&text, &mut faults);
                reported.check_movement(&mut faults);
                reported.check_fields(&mut faults);
                reported.check_tables(&mut faults);
                reported.check_text(&text, &mut faults);
            }
        }
    }
    faults.finish();
}
