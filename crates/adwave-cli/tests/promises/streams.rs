//! Standard output and standard error that are full, closed or not read, and runs after failed ones.

use crate::fixtures::fixtures;
use crate::harness::{Faults, PATIENCE, commands, is_in_sample, run_words};
use crate::option_cases::{base_lines, file_line, with_words};
use crate::signature::Signature;
use std::path::Path;
use std::process::Command;

/// Ways in which a shell connects the streams, and the exit codes that each may give.
const WAYS: [(&str, &[i32]); 5] = [
    (">/dev/full", &[0, 1]),
    ("2>/dev/full", &[0]),
    (">&-", &[0]),
    ("2>&-", &[0]),
    (">/dev/full 2>&-", &[0, 1]),
];

fn program() -> std::path::PathBuf {
    assert_cmd::cargo::cargo_bin("adwave")
}

fn shell_line(words: &[String], way: &str) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
    format!("'{}' {} {way}", program().display(), quoted.join(" "))
}

fn clear(folder: &Path) -> std::path::PathBuf {
    let out = folder.join("out");
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir_all(&out).unwrap();
    out
}

#[cfg(target_os = "linux")]
#[test]
fn streams_that_cannot_be_written_lose_no_result() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        for line in base_lines(command.get_name()) {
            let words = file_line(line, "mesh.ply");
            if !is_in_sample(line, 4) {
                continue;
            }
            let out = clear(folder);
            let usual = run_words(folder, &words, PATIENCE);
            faults.inspect(&usual);
            if !usual.is_done() {
                continue;
            }
            let expected = Signature::new(&usual, &out).files;
            for (way, codes) in WAYS {
                let out = clear(folder);
                let line = shell_line(&words, way);
                let output = Command::new("sh").current_dir(folder).args(["-c", &line]).output().unwrap();
                let code = output.status.code().unwrap_or(-1);
                let told = String::from_utf8_lossy(&output.stderr).into_owned();
                faults.expect(codes.contains(&code), || format!("{words:?} {way}: exit code {code}: {told}"));
                faults.expect(!told.contains("panicked"), || format!("{words:?} {way}: {told}"));
                if code == 0 {
                    let written = Signature::new(&usual, &out).files;
                    faults.expect(written == expected, || format!("{words:?} {way}: other results"));
                }
            }
            let line = format!("{} | head -c 1", shell_line(&words, ""));
            let output = Command::new("sh").current_dir(folder).args(["-c", &line]).output().unwrap();
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            faults.expect(!told.contains("panicked") && !told.contains("adwave: "), || {
                format!("{words:?} | head: {told}")
            });
        }
    }
    // A refusal has its code whether it can be said or not.
    let line = shell_line(&["info".to_owned(), "nowhere.ply".to_owned()], "2>/dev/full");
    let output = Command::new("sh").current_dir(folder).args(["-c", &line]).output().unwrap();
    faults.expect(output.status.code() == Some(2), || format!("{:?}", output.status));
    faults.finish();
}

/// Words that make a run fail, before, during or after its work.
const FAILURES: [&str; 4] = ["--gains=0,1e308,1", "--levels=0", "--only nothing=1", "--threads=0"];

#[test]
fn a_failed_run_leaves_nothing_in_the_way_of_the_next() {
    let folder = fixtures();
    let folder = folder.path();
    let mut faults = Faults::default();
    for command in commands() {
        for line in base_lines(command.get_name()).iter().filter(|line| line.contains("out")) {
            if !is_in_sample(line, 5) && command.get_name() != "tiles" {
                continue;
            }
            let words = file_line(line, "mesh.ply");
            let out = clear(folder);
            let usual = run_words(folder, &words, PATIENCE);
            if !usual.is_done() {
                continue;
            }
            let expected = Signature::new(&usual, &out).files;
            for failure in FAILURES {
                let out = clear(folder);
                let further = crate::harness::split_words(failure);
                let failed = run_words(folder, &with_words(&words, &further), PATIENCE);
                faults.inspect(&failed);
                if failed.is_done() {
                    continue;
                }
                let left: Vec<String> = Signature::new(&failed, &out).files.into_keys().collect();
                faults.expect(left.is_empty(), || format!("{}: left {left:?}", failed.line));
                let run = run_words(folder, &words, PATIENCE);
                faults.inspect(&run);
                let found = Signature::new(&run, &out).files;
                faults.expect(run.is_done() && found == expected, || {
                    format!("{} after {}: {}", run.line, failed.line, run.tail())
                });
            }
        }
    }
    faults.finish();
}

#[test]
fn runs_with_one_output_do_not_mix() {
    let folder = fixtures();
    let folder = folder.path();
    clear(folder);
    let start = || {
        Command::new(program())
            .current_dir(folder)
            .args(["tiles", "scan.las", "-o", "out/r.las", "--gains", "0,0.5,1", "-q"])
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap()
    };
    let runs: Vec<_> = (0..4).map(|_| start()).collect();
    let outputs: Vec<_> = runs.into_iter().map(|run| run.wait_with_output().unwrap()).collect();
    let mut n_done = 0;
    for output in outputs {
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        n_done += usize::from(output.status.success());
        assert!(output.status.success() || told.contains("another run is at work on out/r.las"), "{told}");
    }
    assert!(n_done > 0);
    let names: Vec<_> =
        std::fs::read_dir(folder.join("out")).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["r.las"]);
}

#[cfg(unix)]
#[test]
fn signals_have_their_exit_codes() {
    let folder = fixtures();
    let words = ["denoise", "sample:creature", "--vertices", "400000", "-o", "out.ply", "-q"];
    for (signal, code) in [("-TERM", 143), ("-INT", 130)] {
        let mut child = Command::new(program())
            .current_dir(folder.path())
            .args(words)
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(std::time::Duration::from_millis(700));
        let id = child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(code), "{signal}");
        assert!(!folder.path().join("out.ply").exists());
    }
}
