//! Numeric options with numbers that nobody means: each is refused, or the value is in effect.

use crate::fixtures::fixtures;
use crate::harness::{
    Faults, PATIENCE, commands, is_in_sample, name, options, run_words, split_words, takes_value,
};
use crate::option_cases::{base_lines, file_line, option_case, with_words};
use crate::signature::Signature;
use adwave::region::Length;
use std::any::TypeId;
use std::num::NonZeroUsize;
use std::path::Path;

/// Numbers at the ends of the ranges of numbers.
const NUMBERS: [&str; 7] = ["0", "-1", "nan", "inf", "1e308", "4294967296", "18446744073709551615"];

/// Options whose value is text with numbers: `#` is a number.
const TEMPLATES: [(&str, &str); 8] = [
    ("--range", "0,#"),
    ("--size", "#x10"),
    ("--view", "#,10"),
    ("--focus", "#,0,0"),
    ("--box", "0,0,#,#"),
    ("--region", "ball:vertex=31,radius=#"),
    ("--only", "x=..#"),
    ("--points", "#"),
];

/// Numbers of options that may change nothing, with the reason.
const SAME_RESULT: [(&str, &[&str], &str); 18] = [
    ("--box", LARGE, "all points lie in it"),
    (
        "--only",
        &["inf", "1e308", "4294967296", "18446744073709551615"],
        "all vertices fulfill it; an end may be missing",
    ),
    ("--threads", LARGE, "results do not depend on it"),
    ("--max-input", LARGE, "a limit that no input here reaches"),
    ("--memory", LARGE, "results do not depend on it"),
    ("--workers", LARGE, "results do not depend on it"),
    ("--tiles", LARGE, "results do not depend on it"),
    ("--noise", &["0"], "no noise is the default"),
    (
        "--weld",
        &["0", "1e308", "4294967296", "18446744073709551615"],
        "equal positions alone, or all ends, as by default",
    ),
    ("--skip", &["0"], "the default"),
    (
        "--mask-border",
        &["0", "1e308", "4294967296", "18446744073709551615"],
        "nothing or all of the features of a border",
    ),
    ("--edge-ratio", LARGE, "a bound that no feature reaches"),
    ("--best", LARGE, "there are fewer features"),
    ("--within", LARGE, "a bound that no pair reaches"),
    ("--ratio", LARGE, "a bound that no pair reaches"),
    ("--limit", LARGE, "a bound that no distance reaches"),
    ("--threshold", &["0"], "the default"),
    ("--most-vertices", LARGE, "a bound that no shape reaches"),
];

/// The large numbers.
const LARGE: &[&str] = &["1e308", "4294967296", "18446744073709551615"];

/// Value of a numeric option with a number in it; none if the option is no number.
fn numeric_value(argument: &clap::Arg, number: &str) -> Option<String> {
    let option = name(argument);
    if let Some((_, template)) = TEMPLATES.iter().find(|(name, _)| *name == option) {
        return Some(template.replace('#', number));
    }
    let kind = argument.get_value_parser().type_id();
    let numeric = [
        TypeId::of::<f64>(),
        TypeId::of::<usize>(),
        TypeId::of::<u64>(),
        TypeId::of::<u16>(),
        TypeId::of::<NonZeroUsize>(),
        TypeId::of::<Length>(),
    ];
    (takes_value(argument) && numeric.iter().any(|number| kind == *number)).then(|| number.to_owned())
}

#[test]
fn numbers_that_nobody_means_are_refused_or_in_effect() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        let command_name = command.get_name().to_owned();
        for argument in options(&command) {
            let option = name(&argument);
            for number in NUMBERS {
                let Some(value) = numeric_value(&argument, number) else { continue };
                // So many points of a terrain may be wanted, and take their time.
                let is_long = option == "--points" && LARGE.contains(&number);
                let is_server = base_lines(&command_name).is_empty() || is_long;
                if !is_server && is_in_sample(&format!("{command_name} {option} {number}"), 60) {
                    check_number(folder, &command_name, &option, &value, &mut faults);
                }
            }
        }
    }
    faults.finish();
}

fn check_number(folder: &Path, command: &str, option: &str, value: &str, faults: &mut Faults) {
    let case = option_case(command, option);
    let file = if case.input.is_empty() { "mesh.ply" } else { case.input };
    for line in base_lines(command) {
        let base = with_words(&file_line(line, file), &split_words(case.needs));
        let words = with_words(&base, &[format!("{option}={value}")]);
        let [before, after] = [base, words].map(|words| {
            let out = folder.join("out");
            let _ = std::fs::remove_dir_all(&out);
            std::fs::create_dir_all(&out).unwrap();
            let words = with_words(&words, &["--json".to_owned()]);
            let run = run_words(folder, &words, PATIENCE);
            let signature = Signature::new(&run, &out);
            (run, signature)
        });
        let (run, signature) = after;
        faults.inspect(&run);
        if !run.is_done() {
            continue;
        }
        let is_explained = SAME_RESULT
            .iter()
            .any(|(name, numbers, _)| *name == option && numbers.iter().any(|n| value.contains(n)));
        let is_number = !["nan", "inf"].iter().any(|bad| value.contains(bad));
        faults.expect(is_number || is_explained, || format!("{}: accepted", run.line));
        let is_same = before.0.is_done() && before.1 == signature;
        faults.expect(!is_same || is_explained, || format!("{}: changes nothing", run.line));
    }
}
