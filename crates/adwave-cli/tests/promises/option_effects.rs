//! Each option changes the result or is refused, on every command and on every kind of input.

use crate::fixtures::{INPUTS, fixtures};
use crate::harness::{
    Faults, Run, commands, is_in_sample, name, options, run_words, split_words, takes_value,
};
use crate::option_cases::{OptionCase, base_lines, file_line, option_case, with_words};
use crate::signature::Signature;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

/// Options that no result depends on, with the reason.
const WITHOUT_EFFECT: [(&str, &str, &str); 15] = [
    ("*", "--threads", "results do not depend on it"),
    ("*", "--max-input", "a limit; commands without an input have nothing to limit"),
    (
        "*",
        "--provenance",
        "a setting of all commands; it acts on PLY and OBJ, whose comments are left out of the comparison",
    ),
    ("*", "--quiet", "a report as JSON is the result"),
    ("*", "--output", "names the file"),
    ("tiles", "--memory", "results do not depend on the tiles"),
    ("tiles", "--tiles", "results do not depend on the tiles"),
    ("tiles", "--workers", "results do not depend on the tiles"),
    ("tiles", "--work", "names a folder that is deleted"),
    ("tile", "--if-missing", "a job that is done again writes the same"),
    ("reproduce", "--models", "a folder without the models that a figure uses"),
    ("reproduce", "--most-vertices", "the figure of the base line has fewer"),
    ("*", "--json", "the comparison is of JSON"),
    ("filter", "--save-recipe", "names a file"),
    ("match", "--moved", "names a file"),
];

/// Options that need data that no fixture has, with the reason.
const WITHOUT_DATA: [(&str, &str, &str); 6] = [
    ("*", "--resolution", "COPC and EPT are not written"),
    ("tiles", "--allow-degrees", "the lines of the command have coordinates in meters"),
    ("*", "--surface", "no fixture has values of several surfaces"),
    ("animate", "--animation", "a GLB with several animations is not written"),
    ("match", "--weld", "the shapes with features are closed"),
    ("evaluate", "--per-component", "the shapes with features have one part"),
];

/// Options that act on some data alone, with the kinds of input of the fixtures on which they have nothing to do.
const BY_DATA: [(&str, &str, &str, &str); 26] = [
    ("denoise", "--outliers", "cloud scan", "there are no outliers"),
    ("*", "--as", "cloud scan", "they are clouds"),
    ("*", "--no-weld", "scan own", "no two points are equal"),
    ("*", "--weld", "own", "no two vertices are near"),
    ("saliency", "--operator", "mesh own", "the default of meshes"),
    ("features", "--operator", "mesh own", "the default of meshes"),
    ("evaluate", "--operator", "mesh own", "the default of meshes"),
    ("report", "--operator", "mesh own", "the default of meshes"),
    ("*", "--accuracy", "*", "levels of few steps are computed exactly"),
    ("*", "--border", "curve", "keeping ends is the default of curves"),
    ("*", "--mask-border", "*", "features need not lie near a border"),
    ("*", "--per-component", "*", "levels whose features all stand out in every part"),
    ("*", "--refine", "*", "there may be no features"),
    ("*", "--edge-ratio", "*", "there may be no features on edges"),
    ("*", "--best", "*", "there may be few features"),
    ("*", "--theta", "*", "there may be few features"),
    ("*", "--response", "*", "there may be no features"),
    ("features", "--descriptors", "*", "there may be no features"),
    ("evaluate", "--within", "*", "there may be no features"),
    ("evaluate", "--levels", "*", "the default may be as many"),
    ("match", "*", "*", "small shapes have few features, and a motion is found or not"),
    ("diff", "--by", "cloud scan", "clouds are compared by closest points"),
    ("diff", "--limit", "scan own", "equal shapes have no distance"),
    ("*", "--seed", "own", "two samples of one seed are equal"),
    ("render", "--frame", "*", "no vertex may lie far from the others"),
    ("render", "--crease", "*", "edges need not be sharp"),
];

/// Result of a line, of which the report is JSON where the command has it.
struct Tried {
    run: Run,
    signature: Signature,
}

fn try_words(folder: &Path, words: &[String]) -> Tried {
    let out = folder.join("out");
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir_all(&out).unwrap();
    let mut words = words.to_vec();
    if !words.iter().any(|word| word == "--json" || word == "--markdown") || words[0] == "reproduce" {
        words.push("--json".to_owned());
    }
    let run = run_words(folder, &words, Duration::from_secs(60));
    let signature = Signature::new(&run, &out);
    Tried { run, signature }
}

/// Results of one command without the option under test, by their words.
#[derive(Default)]
struct BaseResults(BTreeMap<Vec<String>, Tried>);

impl BaseResults {
    fn get(&mut self, folder: &Path, words: &[String]) -> &Tried {
        self.0.entry(words.to_vec()).or_insert_with(|| try_words(folder, words))
    }
}

/// Words of an option with its value.
fn option_words(case: &OptionCase) -> Vec<String> {
    let mut words = vec![case.option.to_owned()];
    words.extend(split_words(case.value));
    words
}

fn is_exempt(command: &str, option: &str) -> bool {
    WITHOUT_EFFECT.iter().any(|(c, o, _)| (*c == "*" || *c == command) && *o == option)
}

fn is_by_data(command: &str, option: &str, kind: &str) -> bool {
    BY_DATA.iter().any(|(c, o, k, _)| {
        (*c == "*" || *c == command)
            && (*o == "*" || *o == option)
            && (*k == "*" || k.split(' ').any(|k| k == kind))
    })
}

/// Tries one option of a command on every kind of input.
fn check_option(
    folder: &Path,
    command: &str,
    case: &OptionCase,
    results: &mut BaseResults,
    faults: &mut Faults,
) {
    let (mut acts, mut is_tried) = (false, false);
    for line in base_lines(command) {
        let mut inputs: Vec<(&str, &str)> = INPUTS.to_vec();
        if !case.input.is_empty() {
            inputs.push(("own", case.input));
        }
        if !line.contains("{in}") {
            inputs.truncate(1);
        }
        for (kind, file) in inputs {
            let base = file_line(line, file);
            let needs = split_words(case.needs);
            let kept: Vec<String> = needs.iter().filter(|word| !word.starts_with('!')).cloned().collect();
            let has_taken_away = kept.len() < needs.len();
            let base_words = if has_taken_away { base.clone() } else { with_words(&base, &needs) };
            let is_refused_without = !results.get(folder, &base_words).run.is_done();
            let words = with_words(&with_words(&base, &needs), &option_words(case));
            if words == base_words {
                continue;
            }
            if is_refused_without {
                // An option that makes a run possible acts.
                let tried = try_words(folder, &words);
                faults.inspect(&tried.run);
                acts |= tried.run.is_done();
                continue;
            }
            let tried = try_words(folder, &words);
            faults.inspect(&tried.run);
            is_tried = true;
            let before = &results.get(folder, &base_words).signature;
            if tried.run.code == Some(2) {
                let lines = tried.run.err.lines().filter(|line| !line.starts_with("note: "));
                let is_one_line = lines.count() == 1 || tried.run.err.starts_with("error: ");
                faults.expect(is_one_line, || {
                    format!("{}: refused in several lines: {}", tried.run.line, tried.run.tail())
                });
            } else if tried.run.is_done() && tried.signature != *before {
                acts = true;
            } else if tried.run.is_done() && !is_by_data(command, case.option, kind) {
                faults.add(format!("{}: changes nothing ({kind})", tried.run.line));
            }
        }
    }
    let is_never = WITHOUT_DATA.iter().any(|(c, o, _)| (*c == "*" || *c == command) && *o == case.option);
    faults.expect(acts || !is_tried || is_never, || {
        format!("{} of {command} acts on no fixture; change its case", case.option)
    });
}

#[test]
fn each_option_changes_the_result_or_is_refused() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        let command_name = command.get_name().to_owned();
        let mut results = BaseResults::default();
        for argument in options(&command) {
            let option = name(&argument);
            // Looked up even where it is not run, so that a new option without a case fails every time.
            let case = option_case(&command_name, &option);
            let needs_value = argument.get_num_args().is_none_or(|n| n.min_values() > 0);
            let is_right = if takes_value(&argument) {
                !(needs_value && case.value.is_empty())
            } else {
                case.value.is_empty()
            };
            assert!(is_right, "{option} of {command_name} has the wrong value '{}'", case.value);
            let is_tried = !is_exempt(&command_name, &option) && !base_lines(&command_name).is_empty();
            if is_tried && is_in_sample(&format!("{command_name} {option}"), 20) {
                check_option(folder, &command_name, case, &mut results, &mut faults);
            }
        }
    }
    faults.finish();
}

#[test]
fn reasons_are_given_for_options_that_exist() {
    let all = commands();
    let exists = |command: &str, option: &str| {
        all.iter()
            .filter(|c| command == "*" || c.get_name() == command)
            .any(|c| options(c).iter().any(|a| name(a) == option))
    };
    for (command, option, reason) in WITHOUT_EFFECT {
        assert!(exists(command, option) && !reason.is_empty(), "{command} {option}");
    }
    for (command, option, reason) in WITHOUT_DATA {
        assert!(exists(command, option) && !reason.is_empty(), "{command} {option}");
    }
    for (command, option, _, reason) in BY_DATA {
        assert!((option == "*" || exists(command, option)) && !reason.is_empty(), "{command} {option}");
    }
}
