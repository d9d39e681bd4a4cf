//! Names of results: two with one name, `-` for the standard output, `.gz` after every extension.

use crate::fixtures::fixtures;
use crate::harness::{Faults, PATIENCE, Run, commands, is_in_sample, name, options, run_line, run_words};
use crate::option_cases::{base_lines, file_line, option_case, with_words};
use crate::signature::stable_bytes;
use std::any::TypeId;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Options that name a file or folder to read.
const INPUT_PATHS: [(&str, &str); 10] = [
    ("*", "--texture"),
    ("filter", "--recipe"),
    ("render", "--features"),
    ("reproduce", "--models"),
    ("*", "--work"),
    ("*", "--graph"),
    ("*", "--walk"),
    ("*", "--points"),
    ("scatter", "--field"),
    ("scatter", "--batch"),
];

/// Options of a command that name a result: those of a path that are no input.
fn output_options(command: &clap::Command) -> Vec<String> {
    let is_input = |option: &str| {
        INPUT_PATHS.iter().any(|(c, o)| (*c == "*" || *c == command.get_name()) && *o == option)
    };
    let is_path = |argument: &clap::Arg| argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
    options(command).iter().filter(|a| is_path(a)).map(name).filter(|option| !is_input(option)).collect()
}

/// A name for the result of an option, with the usual extension.
fn usual_name(command: &str, option: &str) -> String {
    let case = option_case(command, option);
    case.value.trim_start_matches("out/").to_owned()
}

fn run_in_new_folder(folder: &Path, words: &[String]) -> Run {
    let out = folder.join("out");
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir_all(&out).unwrap();
    run_words(folder, words, PATIENCE)
}

#[test]
fn two_results_need_two_names() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    let mut n_pairs = 0;
    for command in commands() {
        let outputs = output_options(&command);
        let Some(line) = base_lines(command.get_name()).first() else { continue };
        for (k, first) in outputs.iter().enumerate() {
            for second in &outputs[..k] {
                n_pairs += 1;
                for path in [usual_name(command.get_name(), first), usual_name(command.get_name(), second)] {
                    let base = file_line(line, "mesh.ply");
                    let same = [first, second].map(|option| format!("{option}=out/{path}"));
                    let also = [format!("{first}=out/{path}"), format!("{second}=./out/../out/{path}")];
                    for further in [same, also] {
                        let run = run_in_new_folder(folder, &with_words(&base, &further));
                        faults.inspect(&run);
                        faults.expect(run.code == Some(2), || format!("{}: accepted", run.line));
                        let n_files = std::fs::read_dir(folder.join("out")).unwrap().count();
                        faults.expect(n_files == 0, || format!("{}: left {n_files} files", run.line));
                    }
                }
            }
        }
    }
    faults.expect(n_pairs >= 5, || format!("only {n_pairs} pairs"));
    faults.finish();
}

#[test]
fn a_dash_is_the_standard_output_or_refused() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        for option in output_options(&command) {
            for line in base_lines(command.get_name()) {
                let words = with_words(&file_line(line, "mesh.ply"), &[format!("{option}=-")]);
                let run = run_in_new_folder(folder, &words);
                faults.inspect(&run);
                faults.expect(!folder.join("-").exists(), || format!("{}: made '-'", run.line));
                let _ = std::fs::remove_dir_all(folder.join("-"));
                let is_shape = run.out_bytes.starts_with(b"ply");
                let is_fine =
                    if run.is_done() { is_shape } else { run.code == Some(2) && run.out.is_empty() };
                faults.expect(is_fine, || format!("{}: {:?} {}", run.line, run.code, run.tail()));
            }
        }
    }
    faults.finish();
}

/// Extensions of files that some command writes.
fn extensions(folder: &Path) -> Vec<String> {
    let run = run_line(folder, "formats --json");
    let json: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    let of_shapes = json["formats"].as_array().unwrap().iter().flat_map(|format| {
        let endings = format["extensions"].as_array().unwrap().iter();
        endings
            .filter_map(|ending| Some(ending.as_str()?.trim_start_matches('.').to_owned()))
            .collect::<Vec<_>>()
    });
    let others = ["npy", "npz", "json", "html", "png", "toml", "dscalar.nii", "md"].map(str::to_owned);
    let mut all: Vec<String> = of_shapes.chain(others).filter(|e| !e.ends_with("gz")).collect();
    all.sort();
    all.dedup();
    all
}

#[test]
fn gzip_is_for_the_same_formats_everywhere() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for extension in extensions(folder) {
        let mut answers: Vec<(bool, String)> = Vec::new();
        for command in commands() {
            for option in output_options(&command) {
                for line in base_lines(command.get_name()).iter().filter(|_| option == "--output") {
                    // Scans that are written while they are computed are no archives.
                    let is_stream = command.get_name() == "tiles" || line.contains("terrain");
                    if is_stream || !is_in_sample(&format!("{extension} {line}"), 12) {
                        continue;
                    }
                    let plain = format!("out/r.{extension}");
                    let words =
                        |path: &str| with_words(&file_line(line, "mesh.ply"), &[format!("{option}={path}")]);
                    let run = run_in_new_folder(folder, &words(&plain));
                    faults.inspect(&run);
                    let Some(bytes) = std::fs::read(folder.join(&plain)).ok().filter(|_| run.is_done())
                    else {
                        continue;
                    };
                    let run = run_in_new_folder(folder, &words(&format!("{plain}.gz")));
                    faults.inspect(&run);
                    let packed =
                        std::fs::read(folder.join(format!("{plain}.gz"))).ok().filter(|_| run.is_done());
                    faults.expect(packed.is_some() || run.code == Some(2), || {
                        format!("{}: {}", run.line, run.tail())
                    });
                    if let Some(packed) = &packed {
                        let mut text = Vec::new();
                        let is_gzip =
                            flate2::read::MultiGzDecoder::new(&packed[..]).read_to_end(&mut text).is_ok();
                        let path = Path::new(&plain);
                        let has_command = ["vtp", "vtu", "glb", "vrm", "gltf", "las", "laz", "vtk"]
                            .contains(&extension.as_str());
                        let is_same = has_command || stable_bytes(path, text) == stable_bytes(path, bytes);
                        faults.expect(is_gzip && is_same, || {
                            format!("{}: other bytes than without .gz", run.line)
                        });
                    }
                    answers.push((packed.is_some(), run.line.clone()));
                }
            }
        }
        let differs = answers.iter().find(|(is_written, _)| *is_written != answers[0].0);
        if let Some((_, line)) = differs {
            faults.add(format!(".{extension}.gz: {line} answers otherwise than {}", answers[0].1));
        }
    }
    faults.finish();
}
