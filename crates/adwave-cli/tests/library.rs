//! The command as a function: called again and again in one process, stopped by a flag, no pool left behind.

use std::sync::atomic::{AtomicBool, Ordering};

fn run(cancel: &AtomicBool, line: &str) -> u8 {
    adwave_cli::run(std::iter::once("adwave").chain(line.split_whitespace()), cancel)
}

#[test]
fn one_process_runs_many_commands() {
    let (folder, cancel) = (tempfile::tempdir().unwrap(), AtomicBool::new(false));
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let transform = |out: &str, flags: &str| {
        run(&cancel, &format!("transform sample:knot --vertices 3000 -q -o {} {flags}", at(out)))
    };
    // Each pool is one of its own.
    for name in ["a", "b", "c"] {
        std::fs::create_dir(at(name)).unwrap();
    }
    assert_eq!(transform("a/bands.npz", "--threads 1"), 0);
    assert_eq!(transform("b/bands.npz", "--threads 3"), 0);
    // All of it ran in them: the pool of the whole process can still be set up.
    assert!(rayon::ThreadPoolBuilder::new().num_threads(2).build_global().is_ok());
    assert_eq!(transform("c/bands.npz", ""), 0);
    let bytes = |name: &str| std::fs::read(folder.path().join(name).join("bands.npz")).unwrap();
    assert!(bytes("a") == bytes("b") && bytes("b") == bytes("c"));
    // Bad usage, bad input and help come back as codes; the process lives on.
    assert_eq!(run(&cancel, "fly"), 2);
    assert_eq!(run(&cancel, "info nowhere.obj"), 2);
    assert_eq!(run(&cancel, "--version"), 0);
    assert_eq!(run(&cancel, "sample sphere -q -o /nowhere/at/all.ply"), 2);
}

#[test]
fn a_flag_stops_a_run() {
    let (folder, cancel) = (tempfile::tempdir().unwrap(), AtomicBool::new(true));
    let out = folder.path().join("bands.npz");
    std::fs::write(&out, "precious").unwrap();
    let line =
        format!("transform sample:sphere --vertices 20000 --levels 12 --threads 2 -q -o {}", out.display());
    assert_eq!(run(&cancel, &line), 130);
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "precious");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    cancel.store(false, Ordering::Relaxed);
    assert_eq!(run(&cancel, &line), 0);
    assert_ne!(std::fs::read(&out).unwrap(), b"precious");
}
