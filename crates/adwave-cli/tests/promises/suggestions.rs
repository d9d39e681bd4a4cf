//! Commands and options that messages suggest: they exist, they run, and they do what was promised.

use crate::fixtures::fixtures;
use crate::harness::{Faults, PATIENCE, Run, commands, name, run_line, run_words, split_words};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// Lines whose output suggests something: errors, notes and results.
const SUGGESTING: [&str; 28] = [
    "smooth mesh.ply",
    "decimate mesh.ply",
    "align mesh.ply mesh2.ply",
    "view mesh.ply",
    "keypoints mesh.ply",
    "hausdorff mesh.ply mesh2.ply",
    "save mesh.ply",
    "filter mesh.ply -o out/r.ply",
    "filter mesh.ply -o out/r.ply --signal classification --preset smooth",
    "denoise mesh.ply -o out/r.ply --signal classification",
    "features mesh.ply --theta 1e6",
    "features mesh.ply --best 0",
    "features mesh.ply --theta 1e6 --response literal",
    "match mesh.ply scan.las",
    "match graph.mtx mesh.ply",
    "diff mesh.ply closed.ply --by vertex",
    "saliency mesh.ply -o out/r.obj",
    "sample sphere",
    "sample nonsense",
    "sample terrain",
    "tiles scan.las -o out/r.las --gains 1 --only classification=2 --mask a.npy",
    "tiles scan.las -o out/r.las",
    "info mesh.ply --noise 0.3",
    "info scan.las",
    "info scan2.las --lengths 1,2",
    "region mesh.ply --region ball:vertex=9999,radius=1",
    "render mesh.ply mesh2.ply -o out/r.png",
    "studio mesh.ply --host 0.0.0.0",
];

/// Commands in a text: the rest of a line, or of a quotation, from the word adwave on.
fn suggested_commands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in text.lines() {
        for (at, _) in line.match_indices("adwave ") {
            let before = line[..at].chars().next_back();
            let rest = &line[at + "adwave ".len()..];
            let end = match before {
                Some('\'') => rest.find('\''),
                Some('`') => rest.find('`'),
                Some(' ') | None => {
                    Some(rest.find("  ").or_else(|| rest.find(", or ")).unwrap_or(rest.len()))
                }
                _ => None,
            };
            found.extend(end.map(|end| rest[..end].trim().to_owned()));
        }
    }
    found
}

/// A command with files in the places of words that stand for them.
fn fill_in(command: &str) -> Vec<String> {
    let words = command
        .replace("SHAPE", "creature.ply")
        .replace("OTHER", "creature.ply")
        .replace("IN.laz", "scan.las");
    let words = words.replace("PART.laz", "out/part.laz");
    let rename = |word: String| if word == "OUT" { "out/result.ply".to_owned() } else { word };
    split_words(&words).into_iter().map(rename).collect()
}

/// Options that a text mentions.
fn mentioned_options(text: &str) -> BTreeSet<String> {
    let is_part = |c: char| c.is_ascii_lowercase() || c == '-' || c.is_ascii_digit();
    text.match_indices("--")
        .filter(|(at, _)| !text[..*at].ends_with(|c: char| c.is_alphanumeric() || c == '-'))
        .map(|(at, _)| text[at..].chars().take_while(|c| is_part(*c)).collect::<String>())
        .map(|option| option.trim_end_matches('-').to_owned())
        .filter(|option| option.len() > 3)
        .collect()
}

/// Adds a fault for each mentioned option that neither the command nor one that the text names has.
fn check_options(run: &Run, faults: &mut Faults) {
    let all = commands();
    let text = format!("{}\n{}", run.out, run.err);
    let typed = run.line.clone();
    let is_known = |option: &String| {
        let words = text
            .split_whitespace()
            .chain(typed.split_whitespace())
            .map(|w| w.trim_matches(|c: char| !c.is_alphanumeric()));
        let named: BTreeSet<&str> = words.collect();
        let concerned = all.iter().filter(|command| named.contains(command.get_name()));
        concerned.flat_map(clap::Command::get_arguments).any(|arg| {
            name(arg) == *option
                || arg
                    .get_all_aliases()
                    .unwrap_or_default()
                    .iter()
                    .any(|alias| format!("--{alias}") == *option)
        })
    };
    for option in mentioned_options(&text) {
        let is_typed = typed.contains(&option);
        faults.expect(is_typed || option == "--help" || is_known(&option), || {
            format!("{}: mentions {option}, which no command named there has: {}", run.line, run.tail())
        });
    }
}

#[test]
fn suggested_commands_run() {
    let folder = fixtures();
    let folder = folder.path();
    std::fs::create_dir_all(folder.join("out")).unwrap();
    let mut faults = Faults::default();
    let mut n_suggested = 0;
    for line in SUGGESTING {
        let run = run_line(folder, line);
        faults.inspect(&run);
        check_options(&run, &mut faults);
        // A usage line is no suggestion.
        let text = format!("{}\n{}", run.out, run.err);
        let text: Vec<&str> = text.lines().filter(|line| !line.starts_with("Usage:")).collect();
        for command in suggested_commands(&text.join("\n")) {
            let words = fill_in(&command);
            if words.len() < 2
                || words[0] == "studio"
                || command.contains('…')
                || words.iter().any(|w| w == "--help")
            {
                continue;
            }
            n_suggested += 1;
            let suggested = run_words(folder, &words, PATIENCE);
            faults.inspect(&suggested);
            faults.expect(suggested.is_done(), || {
                format!("{} suggests: {}: {}", run.line, suggested.line, suggested.tail())
            });
        }
    }
    faults.expect(n_suggested >= 6, || format!("only {n_suggested} suggestions were found"));
    faults.finish();
}

#[test]
fn the_tour_suggests_commands_that_run() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    let run = run_line(folder, "demo -o tour --vertices 2000");
    faults.inspect(&run);
    let commands = suggested_commands(&run.out);
    faults.expect(commands.len() >= 4, || run.out.clone());
    for command in commands {
        let suggested = run_words(folder, &fill_in(&command), PATIENCE);
        faults.expect(suggested.is_done(), || format!("{}: {}", suggested.line, suggested.tail()));
    }
    faults.finish();
}

/// Greatest distance between the vertices of two files that adwave reads.
fn greatest_move(folder: &Path, before: &str, after: &str) -> f64 {
    let read = |name: &str| {
        adwave_io::read_path(&folder.join(name), &adwave_io::ReadLimits::default()).unwrap().points().to_vec()
    };
    let distance =
        |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
    read(before).iter().zip(&read(after)).map(|(a, b)| distance(a, b)).fold(0.0, f64::max)
}

/// Rounding of a file of 32-bit floats or of an integer grid, relative to the promised number.
const ROUNDING: f64 = 1e-3;

#[test]
fn a_filter_that_info_suggests_moves_as_far_as_promised() {
    let folder = fixtures();
    let folder = folder.path();
    std::fs::create_dir_all(folder.join("out")).unwrap();
    let mut faults = Faults::default();
    for file in ["mesh.ply", "closed.ply", "cloud.ply", "curve.obj", "scan.las"] {
        for further in ["", "--levels 5", "--operator surface", "--lengths 2%,4%,8%"] {
            for error in ["1%", "3%", "10%"] {
                let run = run_line(folder, &format!("info {file} --error {error} {further} --json"));
                faults.inspect(&run);
                if !run.is_done() {
                    continue; // a curve has one operator
                }
                let json: Value = serde_json::from_str(&run.out).unwrap();
                let allowed = json["detail"]["within"]["error"].as_f64().unwrap();
                let within = &json["detail"]["within"]["greatest"];
                let Some(command) = within["command"].as_str() else { continue };
                let level = within["level"].as_u64().unwrap();
                let levels = json["detail"]["levels"].as_array().unwrap();
                let promised =
                    levels.iter().find(|l| l["level"] == level).and_then(|l| l["greatest"].as_f64()).unwrap();
                let extension = file.rsplit('.').next().unwrap();
                let name = format!("out/filtered.{extension}");
                let words: Vec<String> = split_words(command.trim_start_matches("adwave "))
                    .into_iter()
                    .map(|word| if word.starts_with("OUT.") { name.clone() } else { word })
                    .collect();
                let filtered = run_words(folder, &words, PATIENCE);
                faults.inspect(&filtered);
                if !filtered.is_done() {
                    faults.add(format!("{} suggests {}: {}", run.line, filtered.line, filtered.tail()));
                    continue;
                }
                let moved = greatest_move(folder, file, &name);
                let is_kept = moved <= allowed * (1.0 + ROUNDING)
                    && (moved - promised).abs() <= ROUNDING * promised.max(allowed);
                faults.expect(is_kept, || {
                    format!("{}: moves by {moved}, promised {promised}, allowed {allowed}", filtered.line)
                });
            }
        }
    }
    faults.finish();
}

#[test]
fn suggestions_are_found() {
    let text = "use 'adwave convert A -o B', or adwave diff A B --align\n  adwave info X  about";
    assert_eq!(suggested_commands(text), ["convert A -o B", "diff A B --align", "info X"]);
    let options: Vec<String> = mentioned_options("give --weld 0 (or --no-weld); a--b").into_iter().collect();
    assert_eq!(options, ["--no-weld", "--weld"]);
}
