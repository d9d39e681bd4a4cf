//! Lints and documentation without a second compilation of all libraries.
//!
//! `cargo clippy` and `cargo doc` are `cargo check` with other compilers, and share nothing with `cargo test`: on a bare
//! machine they compile every library once more. So the compiler of the tests is Clippy, which compiles as well, and the
//! documentation of each library is built from the libraries of its examples, just before these run.

use crate::{StepResult, run, target};
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

/// Variable that makes this program stand in for rustdoc, with the path of the real one.
const RUSTDOC: &str = "ADWAVE_RUSTDOC";

/// The compilers that are in use.
static IN_USE: OnceLock<Option<Compilers>> = OnceLock::new();

/// Compilers that check what they compile.
pub(crate) struct Compilers {
    clippy: PathBuf,
    rustdoc: PathBuf,
}

impl Compilers {
    /// Lets all further calls of cargo take these compilers, if they are installed.
    pub(crate) fn use_from_now_on() {
        IN_USE.get_or_init(Self::find);
    }

    /// The compilers in use; `None` if cargo takes its usual ones.
    pub(crate) fn in_use() -> Option<&'static Self> {
        IN_USE.get()?.as_ref()
    }

    /// The compilers beside cargo; `None` if it is installed without them.
    fn find() -> Option<Self> {
        let folder = PathBuf::from(std::env::var_os("CARGO")?).parent()?.to_path_buf();
        let [clippy, rustdoc] = ["clippy-driver", "rustdoc"].map(|name| folder.join(name));
        (clippy.is_file() && rustdoc.is_file()).then_some(Self { clippy, rustdoc })
    }

    /// Variables by which cargo takes them; warnings are errors.
    pub(crate) fn variables(&self) -> Vec<(&'static str, OsString)> {
        let mut variables = vec![
            ("RUSTC_WORKSPACE_WRAPPER", self.clippy.clone().into_os_string()),
            // Words of this variable are separated so by Clippy.
            ("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__".into()),
        ];
        if let Ok(this) = std::env::current_exe() {
            variables.push(("RUSTDOC", this.into_os_string()));
            variables.push((RUSTDOC, self.rustdoc.clone().into_os_string()));
        }
        variables
    }
}

/// Runs in the place of rustdoc, if cargo started this program so: builds the documentation of a library whose examples
/// are to be run, and then runs them. `None` otherwise.
pub(crate) fn stand_in_for_rustdoc() -> Option<StepResult> {
    let rustdoc = std::env::var_os(RUSTDOC)?;
    let words: Vec<OsString> = std::env::args_os().skip(1).collect();
    let documented =
        if words.iter().any(|word| word == "--test") { document(&rustdoc, &words) } else { Ok(()) };
    let tested = run(Command::new(&rustdoc).args(&words));
    Some(documented.and(tested))
}

/// Builds the documentation of a library from the words by which its examples are run.
fn document(rustdoc: &OsStr, words: &[OsString]) -> StepResult {
    const WITH_VALUE: [&str; 3] = ["--test-args", "--test-run-directory", "--test-builder"];
    let mut command = Command::new(rustdoc);
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let text = word.to_string_lossy();
        if WITH_VALUE.contains(&&*text) {
            words.next();
        } else if !text.starts_with("--test") && text != "--no-run" && text != "--nocapture" {
            command.arg(word);
        }
    }
    run(command.args(["-D", "warnings", "--out-dir"]).arg(target().join("debug/documented")))
}
