//! Every example runs without arguments, and those that read a file also on one.

use adwave::sample::{NoiseSigma, Sample};
use adwave_io::{ReadLimits, ShapeFile, read_path, write_path};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Runs an example in a folder of its own and gives what it printed.
fn run(example: &str, arguments: &[&str]) -> String {
    let program = built().join(example).with_extension(std::env::consts::EXE_EXTENSION);
    let output =
        Command::new(program).args(arguments).current_dir(folder(example)).output().expect("it is built");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{example} {arguments:?}: {out}{err}");
    out.into_owned()
}

/// The folder of the built examples. `cargo test` has built them before any test runs, but not where only some targets were
/// asked for.
fn built() -> &'static Path {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(|| {
        // This test is target/PROFILE/deps/examples-…, the examples are in target/PROFILE/examples.
        let test = std::env::current_exe().expect("this test is a file");
        let profile = test.ancestors().nth(2).expect("a folder of the profile");
        let examples = profile.join("examples");
        if !examples.join("own_operator").with_extension(std::env::consts::EXE_EXTENSION).is_file() {
            let name = profile.file_name().and_then(|name| name.to_str()).expect("a name");
            let built = Command::new(env!("CARGO"))
                .current_dir(env!("CARGO_MANIFEST_DIR"))
                .args(["build", "--quiet", "--locked", "--examples", "--profile"])
                .arg(if name == "debug" { "dev" } else { name })
                .arg("--target-dir")
                .arg(profile.parent().expect("the folder of all profiles"))
                .status();
            assert!(built.expect("cargo runs").success(), "the examples cannot be built");
        }
        examples
    })
}

/// A folder for what an example writes.
fn folder(example: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(example);
    std::fs::create_dir_all(&folder).expect("a folder below target");
    folder
}

/// The numbers that follow a phrase in what an example printed.
fn number_after(text: &str, phrase: &str) -> f64 {
    let rest = text.split(phrase).nth(1).unwrap_or_else(|| panic!("no '{phrase}' in {text}"));
    let number: String =
        rest.trim_start().chars().take_while(|c| c.is_ascii_digit() || *c == '.' || *c == '-').collect();
    number.parse().unwrap_or_else(|_| panic!("no number after '{phrase}' in {text}"))
}

/// A file with a built-in shape, rough by noise.
fn rough(sample: &str, n_vertices: usize, of_test: &str) -> PathBuf {
    let mut shape = Sample::from_name(sample, Some(n_vertices)).expect("a sample");
    shape.add_noise(NoiseSigma::MeanEdge(0.1), 1).expect("noise");
    let path = folder(of_test).join("rough.ply");
    write_path(&ShapeFile::from_mesh(shape.points, shape.faces), &path, None).expect("written");
    path
}

#[test]
fn smooth_a_file_writes_the_same_mesh_smoothed() {
    run("smooth_a_file", &[]);
    let built_in = read(&folder("smooth_a_file").join("smooth.ply"));
    assert!(built_in.n_vertices() > 4000);

    let noisy = rough("sphere", 2000, "smooth_a_file");
    let out = noisy.with_file_name("smoothed.ply");
    run("smooth_a_file", &[noisy.to_str().expect("a name"), out.to_str().expect("a name")]);
    let (before, after) = (read(&noisy), read(&out));
    assert_eq!(before.faces(), after.faces());
    // The radius is 1 but for the noise, and evenly a little less when smoothed.
    let roughness = |file: &ShapeFile| {
        let distance = |p: &[f64; 3]| p[0].hypot(p[1]).hypot(p[2]);
        let (mut sum, mut squares) = (0.0, 0.0);
        for p in file.points() {
            sum += distance(p);
            squares += distance(p).powi(2);
        }
        let mean = sum / file.n_vertices() as f64;
        squares / file.n_vertices() as f64 - mean * mean
    };
    let (before, after) = (roughness(&before), roughness(&after));
    assert!(after < 0.5 * before, "variance {before} before, {after} after");
}

#[test]
fn local_edit_moves_a_part_and_takes_it_back() {
    let file = rough("sphere", 2000, "local_edit");
    for (arguments, n) in [(vec![], 5000.0), (vec![file.to_str().expect("a name")], 2000.0)] {
        let text = run("local_edit", &arguments);
        let (part, all) = (number_after(&text, "the ball holds"), number_after(&text, "vertices of"));
        assert!(part > 5.0 && part < 0.5 * all && (all - n).abs() < 0.05 * n, "{text}");
        assert!(number_after(&text, "smoothed: no vertex moved more than") > 0.0, "{text}");
        assert_eq!(number_after(&text, "undone: no vertex moved more than"), 0.0);
    }
}

#[test]
fn features_of_a_cloud_lists_the_strongest() {
    let file = rough("creature", 6000, "features_of_a_cloud");
    for arguments in [vec![], vec![file.to_str().expect("a name")]] {
        let text = run("features_of_a_cloud", &arguments);
        let n = text.lines().filter(|line| line.contains("of radius")).count();
        assert!((1..=5).contains(&n), "{text}");
        assert!(number_after(&text, "of radius") > 0.0, "{text}");
    }
}

#[test]
fn signal_on_a_graph_loses_what_turns_its_sign_from_node_to_node() {
    let text = run("signal_on_a_graph", &[]);
    // On a ring the alternating part has the eigenvalue 0: W_f(1) holds all of it.
    assert_eq!(number_after(&text, "distance from the wave:"), 0.2);
    assert!(number_after(&text, "before,") < 0.002, "{text}");
    let file = rough("sphere", 2000, "signal_on_a_graph");
    let text = run("signal_on_a_graph", &[file.to_str().expect("a name")]);
    assert!(number_after(&text, "before,") < 0.2, "{text}");
}

#[test]
fn own_operator_takes_as_many_products_as_steps() {
    let text = run("own_operator", &[]);
    assert!(text.contains("reversible: false"), "{text}");
    assert!(text.contains("16 products"), "{text}");
    assert_eq!(number_after(&text, "up to 1 steps:"), 0.25); // 1 − 3/4
}

fn read(path: &Path) -> ShapeFile {
    read_path(path, &ReadLimits::default()).expect("what an example wrote")
}
