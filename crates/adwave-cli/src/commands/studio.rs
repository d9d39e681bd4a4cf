//! `adwave studio`: an equalizer for the shape, in the browser.

use crate::args::Kind;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{note, print};
use crate::progress::with_spinner;
use crate::shape_input::{Source, load_source};
use adwave::pages::keep_some_freed;
use adwave_studio::{StudioAddress, StudioInput, StudioParams, serve};
use clap::Args;
use serde_json::json;
use std::io::Write as _;
use std::net::IpAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::NamedTempFile;

#[derive(Debug, Args)]
#[command(after_help = "\
Opens the browser on the shape, with one slider for each band: coarse bands first, live while they are dragged. A brush paints gains onto
the surface, layer by layer; every change can be undone, and the edit is there again on the next visit. What is saved is computed in double
precision and has the bits of the recipe replayed by 'adwave filter --recipe'.

The server listens on this machine alone, and answers only to who has the address that it prints. Ctrl-C ends it.

Examples:
  adwave studio bunny.obj
  adwave studio sample:creature --vertices 50000
  adwave studio scan.ply --no-open --port 8080        on another machine: ssh -L 8080:127.0.0.1:8080 HOST, then open what it prints")]
pub(crate) struct StudioArgs {
    /// The shape: a file, '-' for the standard input, or sample:NAME
    #[arg(value_name = "SHAPE")]
    shape: String,
    /// Take the shape as a mesh or as a cloud of its vertices
    #[arg(long, value_name = "KIND")]
    kind: Option<Kind>,
    /// Number of vertices of a sample
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// Noise along the normals of a sample, in mean edges
    #[arg(long, value_name = "SIGMA")]
    noise: Option<f64>,
    /// The port; any that is free where none is given
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Only print the address
    #[arg(long)]
    no_open: bool,
    /// Listen on this address of the machine, which others on the network reach, without encryption; needs --i-know
    #[arg(long, value_name = "ADDRESS")]
    host: Option<IpAddr>,
    /// I know that everyone who reads the network can then read and change what the studio has
    #[arg(long)]
    i_know: bool,
}

/// Bytes that are kept of freed memory, which every question of a shape of half a million vertices fits into.
const KEPT: usize = 128 << 20;

pub(crate) fn run(args: &StudioArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(host) = args.host.filter(|host| !host.is_loopback()) {
        if !args.i_know {
            return Err(CliError::Input(format!(
                "--host {host} lets others on the network reach the studio, without encryption; a tunnel does not (ssh -L PORT:127.0.0.1:PORT HOST). Say --i-know where that is meant"
            )));
        }
        note(global, "others on the network can reach the studio, and read its token on the way");
    }
    let source =
        Source { kind: args.kind, vertices: args.vertices, noise: args.noise, ..Source::new(&args.shape) };
    let input = with_spinner(global, "reading", || load_source(&source, global))?;
    let path = Path::new(&input.name);
    let path = path.is_file().then(|| path.to_path_buf());
    let name = path.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let input = StudioInput {
        name: name.unwrap_or_else(|| input.name.clone()),
        path,
        file: input.file,
        shape: input.shape,
    };
    // Each edit asks for as much as the one before.
    keep_some_freed(KEPT);
    let params = StudioParams { port: args.port, host: args.host, ..StudioParams::default() };
    let mut browser = None;
    let mut printed = Ok(());
    let outcome = serve(input, &params, global.progress(), |address: &StudioAddress| {
        let text = format!("{}\nCtrl-C ends it\n", address.url);
        printed = print(global, &text, &json!({"address": address.url}));
        if !args.no_open {
            browser = open(&address.url);
            if browser.is_none() {
                note(global, "no browser was found; open the address in one");
            }
        }
    });
    drop(browser);
    // Ctrl-C says more of how it ended than a reader of the address that is gone.
    if outcome.map_err(|e| CliError::of(&e))?.is_done { printed } else { Err(CliError::Cancelled) }
}

/// Opens the browser by a file that leads to the address: the list of programs that run, which all users of the machine can read, has no
/// token then. The file is for its owner's eyes, and goes when this is dropped.
fn open(address: &str) -> Option<(NamedTempFile, Child)> {
    let (program, words): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else {
        let has_screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
        if !has_screen {
            return None; // what opens then is a browser of text in this terminal
        }
        ("xdg-open", &[])
    };
    let mut page = tempfile::Builder::new().prefix("adwave-studio-").suffix(".html").tempfile().ok()?;
    write!(page, "<!doctype html><meta http-equiv=\"refresh\" content=\"0;url={address}\">").ok()?;
    page.flush().ok()?;
    let mut command = Command::new(program);
    command.args(words).arg(page.path()).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let child = command.spawn().ok()?;
    Some((page, child))
}
