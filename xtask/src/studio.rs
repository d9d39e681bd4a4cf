//! Tests of the studio's page: type check, lints, unit tests, comparison of the committed bundle with a fresh build,
//! and end-to-end tests in a browser.

use crate::{StepResult, root, run, target};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Oldest supported version of Node.
const NODE: (u32, u32) = (20, 19);
/// Paths of Chromium or Chrome on Debian and other systems.
const BROWSERS: [&str; 3] = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

/// Folder of the page, in which its packages are installed.
pub(crate) fn web() -> PathBuf {
    root().join("crates/adwave-studio/web")
}

fn npm(words: &[&str]) -> StepResult {
    println!("> npm {}", words.join(" "));
    // Playwright must use the installed browser instead of downloading one.
    run(Command::new("npm").current_dir(web()).args(words).env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1"))
}

/// Installs what the tests of the page need if it is missing: Node, Chromium and the packages of the lock file. Returns
/// the path of the browser.
pub(crate) fn install_requirements() -> Result<&'static str, String> {
    require_node()?;
    let browser = require_browser()?;
    // `npm ci` would reject a lock file that lacks optional packages of other operating systems.
    npm(&["install", "--no-save", "--no-audit", "--no-fund", "--loglevel=error"])?;
    Ok(browser)
}

/// Runs all tests of the page.
pub(crate) fn test() -> StepResult {
    let browser = install_requirements()?;
    npm(&["run", "--silent", "check"])?;
    npm(&["run", "--silent", "test"])?;
    check_bundle()?;
    npm(&["run", "--silent", "build:e2e", "--", "--logLevel", "error"])?;
    run_in_browser(browser)
}

/// Checks that the committed bundle, which the server embeds, equals a fresh build of the sources.
fn check_bundle() -> StepResult {
    let fresh = target().join("studio-bundle");
    println!("> npm run build, into {}", fresh.display());
    run(Command::new("npm")
        .current_dir(web())
        .args(["run", "--silent", "build", "--", "--logLevel", "warn", "--emptyOutDir", "--outDir"])
        .arg(&fresh))?;
    let names = |folder: &Path| -> Result<Vec<PathBuf>, String> {
        let entries = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut names: Vec<PathBuf> = entries.flatten().map(|entry| entry.file_name().into()).collect();
        names.sort();
        Ok(names)
    };
    let committed = web().join("dist");
    let (built, existing) = (names(&fresh)?, names(&committed)?);
    let read = |path: PathBuf| std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()));
    let mut differs = built != existing;
    for name in &built {
        differs = differs || read(fresh.join(name))? != read(committed.join(name))?;
    }
    if differs {
        return Err(format!(
            "the bundle in {} is out of date; run `npm run build` in {} and commit the result",
            committed.display(),
            web().display()
        ));
    }
    Ok(())
}

/// Runs the end-to-end tests, which start their own servers from the debug build.
fn run_in_browser(browser: &str) -> StepResult {
    let out = target().join("studio-test");
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir_all(&out).map_err(|e| format!("cannot create {}: {e}", out.display()))?;
    println!("> npx playwright test --project=page");
    run(Command::new("npx")
        .current_dir(web())
        .args(["playwright", "test", "--project=page"])
        .env("CHROMIUM", browser)
        .env("ADWAVE", target().join("debug/adwave"))
        .env("STUDIO_OUT", &out))
}

/// Version of the installed Node, if there is one.
fn node_version() -> Option<(u32, u32)> {
    let out = Command::new("node").arg("--version").output().ok()?;
    let text = String::from_utf8(out.stdout).ok()?;
    let mut numbers = text.trim().trim_start_matches('v').split('.').map(|n| n.parse::<u32>().ok());
    Some((numbers.next()??, numbers.next()??))
}

/// True if a Node is installed that is new enough.
pub(crate) fn has_node() -> bool {
    node_version().is_some_and(|version| version >= NODE)
}

/// Checks the version of Node; installs it if it is missing.
fn require_node() -> StepResult {
    if node_version().is_none() {
        install(&["nodejs", "npm"]);
    }
    match node_version() {
        Some(version) if version >= NODE => Ok(()),
        Some((major, minor)) => Err(format!(
            "the studio's page needs Node {}.{} or later, got {major}.{minor}; update it",
            NODE.0, NODE.1
        )),
        None => {
            Err(format!("the studio's page needs Node {}.{} or later with npm; install it", NODE.0, NODE.1))
        }
    }
}

fn browser_path() -> Option<&'static str> {
    BROWSERS.into_iter().find(|path| Path::new(path).exists())
}

/// Finds Chromium; installs it if it is missing.
fn require_browser() -> Result<&'static str, String> {
    if browser_path().is_none() {
        install(&["chromium"]);
    }
    browser_path().ok_or_else(|| {
        "the tests of the studio need Chromium; install it (apt-get install chromium)".to_owned()
    })
}

/// Tries to install Debian packages; the caller checks the result.
fn install(packages: &[&str]) {
    println!("> apt-get install {}", packages.join(" "));
    let install_quietly = |words: &[&str]| {
        let _ = Command::new("apt-get")
            .args(words)
            .args(packages)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(Stdio::null())
            .status();
    };
    let _ = Command::new("apt-get").args(["update", "-qq"]).stdout(Stdio::null()).status();
    install_quietly(&["install", "-y", "-qq", "--no-install-recommends"]);
}
