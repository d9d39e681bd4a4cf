//! The page of the studio: its types and laws, that the committed bundle is what the sources give, and the whole of it in a browser.

use crate::{Outcome, root, run, target};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The least version of Node that the page is built by.
const NODE: (u32, u32) = (20, 19);
/// Where Debian's packages put the browser, and what others call it.
const BROWSERS: [&str; 3] = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];

fn web() -> PathBuf {
    root().join("crates/adwave-studio/web")
}

/// All of it.
pub(crate) fn test() -> Outcome {
    node()?;
    browser()?;
    let npm = |words: &[&str]| {
        println!("> npm {}", words.join(" "));
        run(Command::new("npm").current_dir(web()).args(words))
    };
    // Not `npm ci`: it refuses a lock file without the optional packages of systems that a registry does not offer.
    npm(&["install", "--no-save", "--no-audit", "--no-fund", "--loglevel=error"])?;
    npm(&["run", "--silent", "check"])?;
    npm(&["run", "--silent", "test"])?;
    same_bundle()?;
    in_browser()
}

/// The committed bundle is embedded by the server, so that nobody needs Node to build it.
fn same_bundle() -> Outcome {
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
    let (built, kept) = (names(&fresh)?, names(&committed)?);
    let read = |path: PathBuf| std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()));
    let mut differs = built != kept;
    for name in &built {
        differs = differs || read(fresh.join(name))? != read(committed.join(name))?;
    }
    if differs {
        return Err(format!(
            "the bundle in {} is not what its sources give: run `npm run build` in {} and commit it",
            committed.display(),
            web().display()
        ));
    }
    Ok(())
}

/// Servers on a built-in shape, and the page in a browser.
fn in_browser() -> Outcome {
    let folder = target().join("studio-test");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
    let adwave = target().join("debug/adwave");
    let shape = folder.join("creature.ply");
    run(Command::new(&adwave)
        .args(["sample", "creature", "--vertices", "20000", "--quiet", "-o"])
        .arg(&shape))?;
    // Each on a server of its own, whose edits nothing else has touched.
    for (name, words) in
        [("studio", vec![folder.clone()]), ("tools", vec![folder.clone()]), ("masks", vec![])]
    {
        let (mut server, address) = serve(&adwave, &shape, &folder.join(name))?;
        let outcome = node_test(name, &[address.into()], words);
        let _ = server.kill();
        let _ = server.wait();
        outcome?;
    }
    node_test("recovery", &[adwave, shape], vec![folder.join("recovery")])
}

/// A test of the page, in a browser.
fn node_test(name: &str, first: &[PathBuf], more: Vec<PathBuf>) -> Outcome {
    println!("> node test/{name}.mjs");
    run(Command::new("node")
        .current_dir(web())
        .arg(format!("test/{name}.mjs"))
        .args(first)
        .args(more)
        .env("CHROMIUM", browser_path().unwrap_or_default()))
}

fn serve(adwave: &Path, shape: &Path, folder: &Path) -> Result<(Child, String), String> {
    let mut server = Command::new(adwave)
        .args(["studio", "--no-open"])
        .arg(shape)
        .env("XDG_STATE_HOME", folder.join("state"))
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|e| format!("cannot start {}: {e}", adwave.display()))?;
    let out = server.stdout.take().ok_or("the studio has no output")?;
    let mut address = String::new();
    let read = BufReader::new(out).read_line(&mut address);
    match read {
        Ok(n) if n > 0 => Ok((server, address.trim().to_owned())),
        _ => {
            let _ = server.kill();
            Err("the studio gave no address".to_owned())
        }
    }
}

/// Node and npm, new enough.
fn node() -> Outcome {
    let version = || {
        let out = Command::new("node").arg("--version").output().ok()?;
        let text = String::from_utf8(out.stdout).ok()?;
        let mut numbers = text.trim().trim_start_matches('v').split('.').map(|n| n.parse::<u32>().ok());
        Some((numbers.next()??, numbers.next()??))
    };
    if version().is_none() {
        install(&["nodejs", "npm"]);
    }
    match version() {
        Some(found) if found >= NODE => Ok(()),
        Some((major, minor)) => Err(format!(
            "Node {major}.{minor} is older than {}.{}, which the studio's page is built by",
            NODE.0, NODE.1
        )),
        None => {
            Err(format!("Node {}.{} with npm is needed for the studio's page: install it", NODE.0, NODE.1))
        }
    }
}

fn browser_path() -> Option<&'static str> {
    BROWSERS.into_iter().find(|path| Path::new(path).exists())
}

fn browser() -> Outcome {
    if browser_path().is_none() {
        install(&["chromium"]);
    }
    browser_path().map(|_| ()).ok_or_else(|| {
        "Chromium is needed to test the studio: install it (apt-get install chromium)".to_owned()
    })
}

/// From the packages of Debian, where that is possible; who calls looks whether it is there then.
fn install(packages: &[&str]) {
    println!("> apt-get install {}", packages.join(" "));
    let quiet = |words: &[&str]| {
        let _ = Command::new("apt-get")
            .args(words)
            .args(packages)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .stdout(Stdio::null())
            .status();
    };
    let _ = Command::new("apt-get").args(["update", "-qq"]).stdout(Stdio::null()).status();
    quiet(&["install", "-y", "-qq", "--no-install-recommends"]);
}
