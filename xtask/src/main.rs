//! Commands of `cargo xtask …`: the checks and measurements of the project, each by one command on a bare machine.

mod clouds;
mod denoise;
mod grids;
mod integrations;
mod matching;
mod meshings;
mod notices;
mod package;
mod peers;
mod publish;
mod python;
mod site;
mod studio;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo xtask COMMAND

  test      run every check that must pass: format, lints, unit, property, documentation and command-line tests; bands of
            small built-in shapes compared with SciPy's; the Python package (needs Python 3.10 or newer with venv); the
            studio in a browser (needs Node 20.19 or newer); a minute of broken input; licenses of dependencies, if
            cargo-deny is installed
  fuzz [--seconds N] [--only TARGET] [--seed N] [--runs N] [--file FILE]
            feed broken input to every reader and parser; failing inputs are saved below target/fuzz
  wheel     build the Python package as target/wheels/adwave-….whl, for Python 3.10 and newer
  python [--wheel]
            test the Python package: its tests, the examples of its documentation and its types; the wheel, or otherwise
            the build of the tests
  torch-check
            install PyTorch (gigabytes) and run the tests and examples of `adwave.torch`, by Triton's interpreter too
  studio-test
            test the studio's page: types, laws, the committed bundle against its sources, and all of it in Chromium
  oracle    compare bands with SciPy's on larger built-in shapes and on ../shared/data (or $ADWAVE_DATA), if it exists
  oracle-baselines
            compare eigenvalues with SciPy's on libigl's matrices, and spectral graph wavelets with PyGSP's
  bench-peers [--models DIR] [--only PART]
            time other programs and ours on the same operators and write docs/PERFORMANCE.md; the part `denoise` runs
            denoisers on pairs of noisy and clean meshes and writes docs/DENOISING.md
  bench-python [--vertices N] [--mesh FILE] [--repeat K]
            time the same tasks in the Python package and in other packages: seconds and lines, as a table
  bench-clouds [--points N]
            process a scan of ten million points by tiles and by other programs: seconds and memory, as a table
  bench-denoise [first|second] [SEEDS] [--curve FILE.svg]
            denoise random meshes, clouds and curves whose truth is known: tables by noise and by shape for one half of the seeds,
            the noise found over the true noise as a curve, and the published pairs of ../shared/data (or $ADWAVE_DATA), if it
            exists
  bench-claims [--measure]
            write docs/BENCHMARKS.md and the tables in docs/benchmarks from the measurements in the other pages; --measure first
            measures again what they rest on, beside the other programs, in an hour and a half
  bench-grids [--models DIR] [--only PART]
            time heat and bands of images and volumes beside SciPy and write the section of docs/PERFORMANCE.md on them
  bench-commands [--only COMMAND]
            time five commands and libraries that do the same, from 10,000 to 10,000,000 vertices, and write the section and
            the picture of docs/PERFORMANCE.md on them, in about half an hour
  bench-meshings [--models DIR] [--only PART]
            compare bands, features and maps between meshings of the same surfaces and write docs/MESHINGS.md
  bench-match [--seeds choose|final] [--cases N] [--seconds N] [--curve FILE.svg]
            match terrains and, if ../shared/data exists, cuts and views of surfaces with a known motion or with none: rates
            of right and wrong claims and the calibration of confidences, as tables and as a curve; constants are chosen by
            the seeds `choose` and measured by the seeds `final`
  integrations
            test the plug-in of napari in napari, which is installed below target/, and that of QGIS in the QGIS of the system,
            if there is one
  docs      build the site as target/docs/index.html: front page, guides, gallery, references of Python and Rust, and the
            search; check links, titles, pictures, sizes, numbers of claims and answers of the search; warnings are errors
  site-test
            build the site and check it in Chromium, on a desk and on a phone, in light and dark colors: contrast, sizes of
            what is tapped, moves while a page loads, search, menu
  command-check
            all cases of the systematic tests of the command, of which every test run takes a sample: each documented command,
            each option on each kind of input, odd numbers, equal inputs, names of results, closed and full streams, wording,
            numbers of reports, suggested commands
  same-outputs --before PROGRAM
            run a fixed list of commands with an older build of adwave and with this one, and compare the bytes of every file
  notices   write the notices and licenses of all that the program contains
  package-check
            what the registries check before a release: `cargo publish` of all crates; metadata, licenses, symbols and
            manylinux tag of the Python package, and that its source distribution builds without a network; the workflows
            of releases and the recipe of conda; skips with a reason what is not installed
  style [FOLDER]
            print every violation of the countable rules of style, below a folder of the repository

Python packages are installed into an environment below target/. If Node or Chromium is missing, it is installed from the
packages of Debian; nothing else is installed.";

/// Number of seconds for which every test run feeds broken input to all readers and parsers.
const FUZZED_SECONDS: &str = "60";

/// Arguments that build the libraries and the programs that the tests of the page and of the package run. The tests of
/// the workspace are built too, so that the libraries have the same features as those of `cargo test`.
const BUILD_WITH_TESTS: [&str; 10] = [
    "build",
    "--workspace",
    "--locked",
    "--quiet",
    "--lib",
    "--tests",
    "--bin",
    "adwave",
    "--bin",
    "adwave-fuzz",
];

/// Result of a step; the error is one line of text.
type StepResult = Result<(), String>;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test(),
        ["oracle"] => oracle(),
        ["oracle-baselines"] => oracle_baselines(),
        ["wheel"] => package::wheel().map(|_| ()),
        ["integrations"] => integrations::test(),
        ["docs"] => site::build(),
        ["site-test"] => site::test(),
        ["bench-python", ref rest @ ..] => package::bench(rest),
        ["studio-test"] => studio_test(),
        ["python", ref rest @ ..] => package::test_package(rest),
        ["torch-check"] => package::test_torch(),
        ["fuzz", ref rest @ ..] => fuzz(rest),
        ["bench-peers", ref rest @ ..] if rest.contains(&denoise::PART) => denoise::bench_denoise(rest),
        ["bench-peers", ref rest @ ..] => peers::bench_peers(rest),
        ["bench-denoise", ref rest @ ..] => denoise::bench_truth(rest),
        ["bench-clouds", ref rest @ ..] => clouds::bench_clouds(rest),
        ["bench-claims"] => xtask::claims::write(&root()),
        ["bench-claims", "--measure"] => measure_claims(),
        ["bench-grids", ref rest @ ..] => grids::bench_grids(rest),
        ["bench-commands", ref rest @ ..] => peers::bench_commands(rest),
        ["bench-match", ref rest @ ..] => matching::bench_match(rest),
        ["bench-meshings", ref rest @ ..] => meshings::bench_meshings(rest),
        ["command-check"] => command_check(),
        ["same-outputs", ref rest @ ..] => same_outputs(rest),
        ["notices"] => notices::write(),
        ["package-check"] => publish::check(),
        ["style"] => print_style("."),
        ["style", folder] => print_style(folder),
        ["help" | "--help" | "-h"] => {
            println!("{USAGE}");
            Ok(())
        }
        _ => Err(USAGE.to_owned()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(what) => {
            eprintln!("{what}");
            ExitCode::FAILURE
        }
    }
}

/// Prints every violation of the countable rules of style below `folder`.
fn print_style(folder: &str) -> StepResult {
    let violations = xtask::style::check(&root(), folder)?;
    for (rule, list) in violations.rules() {
        println!("{rule}: {}", list.len());
        for line in list {
            println!("  {line}");
        }
    }
    let share = 100.0 * violations.riddle_share();
    println!("{} doc comments, {share:.1} % of them begin with What/Who/Which/…", violations.n_doc_comments);
    Ok(())
}

fn same_outputs(arguments: &[&str]) -> StepResult {
    cargo(&["build", "--release", "--locked", "--quiet", "-p", "adwave-cli"], &[])?;
    xtask::outputs::compare(arguments, &root(), &target().join("release/adwave"), &data())
}

/// Runs all cases of the systematic tests of the command line, which the environment variable selects.
fn command_check() -> StepResult {
    let test = ["test", "--locked", "--quiet", "-p", "adwave-cli", "--test", "promises"];
    cargo(&test, &[("ADWAVE_COMMAND_CHECK", "full")])
}

/// Measures what the page of benchmarks rests on, and writes it.
fn measure_claims() -> StepResult {
    peers::bench_peers(&[])?;
    denoise::bench_denoise(&["--only", denoise::PART])?;
    peers::bench_commands(&[])?;
    grids::bench_grids(&[])?;
    clouds::bench_clouds(&[])?;
    xtask::claims::write(&root())
}

fn studio_test() -> StepResult {
    cargo(&BUILD_WITH_TESTS, &[])?;
    studio::test()
}

/// Reads the values of `--models` and `--only`; without `--models` the folder of models is `models`.
fn models_and_part<'a>(
    command: &str,
    arguments: &[&'a str],
    mut models: PathBuf,
) -> Result<(PathBuf, Option<&'a str>), String> {
    let mut only = None;
    let mut rest = arguments.iter();
    while let Some(&option) = rest.next() {
        let value = rest.next().ok_or_else(|| format!("{option} needs a value"))?;
        match option {
            "--models" => models = PathBuf::from(value),
            "--only" => only = Some(*value),
            _ => return Err(format!("{command} knows --models and --only, not {option}")),
        }
    }
    Ok((models, only))
}

fn test() -> StepResult {
    notices::check()?;
    // Before anything is built: the extension for Python asks for it too, in its own words.
    python::check()?;
    // Downloads take no processor, so they run while the compiler does.
    let downloads = std::thread::spawn(|| -> StepResult {
        package::test_environment()?;
        python::environment("oracle")?;
        studio::install_requirements().map(|_| ())
    });
    cargo(&["fmt", "--all", "--check"], &[])?;
    cargo(&["clippy", "--workspace", "--all-targets", "--locked", "--quiet", "--", "-D", "warnings"], &[])?;
    cargo(&["test", "--workspace", "--locked", "--quiet", "--no-run"], &[])?;
    cargo(&BUILD_WITH_TESTS, &[])?;
    downloads.join().map_err(|_| "the thread of downloads panicked")??;
    // Two rows of tests, so that no processor is idle during the last tests of a crate, while a browser is waited for, or
    // beside tests of the package, most of which are serial.
    let test = |words: &[&str]| {
        cargo(&[&["test", "--workspace", "--locked", "--quiet", "--no-fail-fast"][..], words].concat(), &[])
    };
    let others = std::thread::spawn(move || -> StepResult {
        // Not `--bins`, which would build the tests of programs that have none.
        test(&["--lib"])?;
        test(&["--doc"])?;
        println!("> adwave-fuzz --seconds {FUZZED_SECONDS}");
        let fuzzer = target().join("debug/adwave-fuzz");
        run(Command::new(fuzzer).current_dir(root()).args(["--seconds", FUZZED_SECONDS]))?;
        site::build()?;
        // Only those crates that are not published are left.
        let words = ["doc", "--workspace", "--no-deps", "--locked", "--quiet"];
        cargo(&words, &[("RUSTDOCFLAGS", "-D warnings")])?;
        package::test_package(&[])?;
        let adwave = target().join("debug/adwave");
        compare_with_scipy(&adwave, "oracle-small", [1000, 1000, 1000, 1000, 3000], None)
    });
    let first = test(&["--test", "*"]).and_then(|()| studio::test());
    let others = others.join().map_err(|_| "the second row of tests panicked")?;
    first.and(others)?;
    dependencies()
}

/// Checks licenses and sources of dependencies by `deny.toml`, if cargo-deny is installed. Known vulnerabilities are
/// not checked, because that needs its database.
fn dependencies() -> StepResult {
    let tool = Command::new("cargo-deny").arg("--version").output();
    if !tool.is_ok_and(|output| output.status.success()) {
        println!("licenses and sources of dependencies were not checked: cargo-deny is not installed");
        return Ok(());
    }
    cargo(&["deny", "--offline", "check", "licenses", "bans", "sources"], &[])
}

/// Feeds broken input to the readers for a minute, or as the arguments say. It is built with the optimization of the
/// tests, so that overflows of integers are detected.
fn fuzz(arguments: &[&str]) -> StepResult {
    let run = ["run", "--locked", "--quiet", "-p", "adwave-fuzz", "--"];
    cargo(&[&run[..], arguments].concat(), &[])
}

fn oracle() -> StepResult {
    cargo(&["build", "--release", "--locked", "--quiet", "-p", "adwave-cli"], &[])?;
    let adwave = target().join("release/adwave");
    compare_with_scipy(&adwave, "oracle-samples", [5000, 5000, 5000, 5000, 20000], Some(data()))
}

/// Runs `benches/oracle` on built-in shapes with the given numbers of vertices, and on the shapes of a folder.
fn compare_with_scipy(
    adwave: &Path,
    folder: &str,
    vertices: [usize; 5],
    data: Option<PathBuf>,
) -> StepResult {
    let samples = target().join(folder);
    std::fs::create_dir_all(&samples).map_err(|e| format!("cannot make {}: {e}", samples.display()))?;
    for (name, vertices) in ["sphere", "torus", "plane", "knot", "creature"].into_iter().zip(vertices) {
        let out = samples.join(format!("{name}.ply"));
        let vertices = vertices.to_string();
        let arguments = ["sample", name, "--vertices", &vertices, "--quiet", "-o"].map(OsStr::new);
        run(Command::new(adwave).args(arguments).arg(out))?;
    }
    let python = python::environment("oracle")?;
    println!("> python {}", root().join("benches/oracle/oracle.py").display());
    let mut command = Command::new(python);
    command.arg(root().join("benches/oracle/oracle.py")).arg(adwave).arg(&samples);
    if let Some(data) = data {
        command.arg("--data").arg(data);
    }
    run(&mut command)
}

fn oracle_baselines() -> StepResult {
    let build =
        ["build", "--release", "--locked", "--quiet", "-p", "adwave-bench-helpers", "--bin", "oracle_values"];
    cargo(&build, &[])?;
    let python = python::environment("baselines")?;
    run(Command::new(python)
        .arg(root().join("benches/baselines/oracle.py"))
        .arg(target().join("release/oracle_values"))
        .arg("--data")
        .arg(data()))
}

/// Root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository").to_owned()
}

/// Folder in which cargo builds.
fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// Folder of further test inputs, which need not exist.
fn data() -> PathBuf {
    std::env::var_os("ADWAVE_DATA").map_or_else(|| root().join("../shared/data"), PathBuf::from)
}

/// True if nothing was built here before. A first build does not benefit from incremental compilation and line numbers.
fn is_bare() -> bool {
    let partial = std::fs::read_dir(target().join("debug/incremental"));
    !partial.is_ok_and(|mut entries| {
        entries
            .any(|entry| entry.is_ok_and(|entry| entry.file_name().to_string_lossy().starts_with("adwave")))
    })
}

fn cargo(arguments: &[&str], variables: &[(&str, &str)]) -> StepResult {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    println!("> cargo {}", arguments.join(" "));
    let mut command = Command::new(cargo);
    if is_bare() {
        // As many parts of a crate as there are cores: more parts repeat work, and the tests become slower.
        let parts = std::thread::available_parallelism().map_or(2, usize::from).to_string();
        command.envs([
            ("CARGO_INCREMENTAL", "0"),
            ("CARGO_PROFILE_DEV_DEBUG", "0"),
            ("CARGO_PROFILE_DEV_CODEGEN_UNITS", parts.as_str()),
        ]);
    }
    run(command.current_dir(root()).args(arguments).envs(variables.iter().copied()))
}

/// Returns the standard output of a command of cargo.
fn cargo_output(arguments: &[&str]) -> Result<String, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo).current_dir(root()).args(arguments).output();
    let output = output.map_err(|e| format!("cannot run cargo: {e}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    Err(format!("cargo {} failed: {}", arguments.join(" "), String::from_utf8_lossy(&output.stderr).trim()))
}

/// Runs a command to its end, with the standard streams of this program.
fn run(command: &mut Command) -> StepResult {
    let program = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{program} failed: {status}")),
        Err(e) => Err(format!("cannot run {program}: {e}")),
    }
}
