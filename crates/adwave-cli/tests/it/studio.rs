//! `adwave studio` as a shell has it: what it prints, what it refuses, how it ends.

use crate::common;

use common::{adwave, refused};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

#[test]
fn what_cannot_be_opened_is_refused_in_one_line() {
    let folder = TempDir::new().unwrap();
    let refused = |line: &str| refused(folder.path(), line);
    assert!(refused("studio no-such-file.obj").contains("no-such-file.obj"));
    assert!(refused("studio sample:creature --host 0.0.0.0").contains("--i-know"));
    let graph = "%%MatrixMarket matrix coordinate pattern general\n2 2 1\n1 2\n";
    std::fs::write(folder.path().join("graph.mtx"), graph).unwrap();
    assert!(
        refused("studio graph.mtx --no-open").contains("shows surfaces and points, and no graphs or curves")
    );
    std::fs::write(folder.path().join("empty.obj"), "").unwrap();
    assert!(refused("studio empty.obj --no-open").contains("empty.obj"));
}

#[test]
fn the_help_has_examples() {
    let help = adwave(&std::env::temp_dir()).args(["studio", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    assert!(help.contains("adwave studio bunny.obj") && help.contains("ssh -L"), "{help}");
}

#[test]
#[cfg(unix)]
fn it_prints_its_address_and_ctrl_c_ends_it() {
    let folder = TempDir::new().unwrap();
    let mut studio = Command::new(env!("CARGO_BIN_EXE_adwave"))
        .args(["studio", "sample:creature", "--vertices", "3000", "--no-open"])
        .env("XDG_STATE_HOME", folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut printed = BufReader::new(studio.stdout.take().unwrap());
    printed.read_line(&mut line).unwrap();
    assert!(line.starts_with("http://127.0.0.1:") && line.contains("/#"), "{line}");
    let stopped = Instant::now();
    let pid = studio.id().to_string();
    assert!(Command::new("kill").args(["-INT", &pid]).status().unwrap().success());
    assert_eq!(studio.wait().unwrap().code(), Some(0));
    assert!(stopped.elapsed() < Duration::from_secs(5), "{:?}", stopped.elapsed());
    assert_eq!(std::io::read_to_string(printed).unwrap(), "press Ctrl-C to end\n");
    let told = std::io::read_to_string(studio.stderr.take().unwrap()).unwrap();
    assert_eq!(told, "");
}
