//! `adwave studio`: an equalizer for a shape, a graph, an image or a volume in a browser.

use crate::args::{SelectionArgs, count, file_name, number, parse_named, to_path};
use crate::error::CliError;
use crate::global::{Global, HeapUse};
use crate::output::progress::bar;
use crate::output::{note, print, print_bytes};
use crate::resolve::applicable::check_source_options;
use crate::resolve::shape::{SampleSize, ShapeSource, load_source};
use adwave_io::ShapeKind;
use adwave_studio::{StudioAddress, StudioInput, StudioParams, serve};
use clap::Args;
use serde_json::json;
use std::net::IpAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

#[derive(Debug, Args)]
#[command(after_help = "\
Opens the shape in a browser, with one slider for each band; the shape follows while a slider is dragged. A brush paints gains onto
the surface, layer by layer. Every change can be undone, and the edit is restored on the next visit. Saved shapes are computed in
double precision and are bit-identical to the result of 'adwave filter --recipe'.

An image is shown flat, a terrain with shading, and a volume in three slices that are linked by a cross; sliders change the values.
A graph is shown by its nodes and edges, in the plane if it has no positions; sliders change the field that colors it.

The server listens on this machine only and answers only requests with the token of the address that it prints. Ctrl-C ends it.

Examples:
  adwave studio bunny.obj
  adwave studio sample:creature --vertices 50000
  adwave studio dem.tif
  adwave studio network.mtx                        a graph; drop a file of values on the page
  adwave studio volume.nii.gz --only values=5..    without the places below 5
  adwave studio scan.ply --no-open --port 8080     elsewhere, with ssh -L 8080:127.0.0.1:8080")]
pub(crate) struct StudioArgs {
    /// Shape, graph, image or volume: a file, '-' for the standard input, or sample:NAME
    #[arg(value_name = "SHAPE", value_parser = file_name())]
    shape: String,
    #[command(flatten)]
    selection: SelectionArgs,
    /// Take the shape as a mesh or as a cloud of its vertices
    #[arg(long = "as", alias = "kind", value_name = "KIND", value_parser = parse_named::<ShapeKind>())]
    kind: Option<ShapeKind>,
    /// Approximate number of vertices of a sample
    #[arg(long, value_name = "N", value_parser = count)]
    vertices: Option<usize>,
    /// Noise along the normals of a sample: its standard deviation in mean edge lengths
    #[arg(long, value_name = "SIGMA", value_parser = number)]
    noise: Option<f64>,
    /// Port; 0 takes any free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Print the address without opening a browser
    #[arg(long)]
    no_open: bool,
    /// Listen on this address of the machine, which others on the network can reach without encryption; needs --i-know
    #[arg(long, value_name = "ADDRESS")]
    host: Option<IpAddr>,
    /// Accept that everyone on the network path can read and change what the studio shows
    #[arg(long)]
    i_know: bool,
}

/// Bytes of freed memory that are kept: enough for a request on a shape of half a million vertices.
const KEPT: usize = 128 << 20;

pub(crate) fn run(args: &StudioArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(host) = args.host.filter(|host| !host.is_loopback()) {
        if !args.i_know {
            return Err(CliError::Input(format!(
                "--host {host} lets others on the network reach the studio without encryption. A tunnel is safer (ssh -L PORT:127.0.0.1:PORT HOST); add --i-know to go on"
            )));
        }
        note(global, "others on the network can reach the studio and read its token");
    }
    if args.host.is_none_or(|host| host.is_loopback()) {
        global.given.refuse(&["--i-know"], "applies to a --host that others on the network can reach")?;
    }
    let sample = SampleSize { n_vertices: args.vertices, noise: args.noise, ..SampleSize::default() };
    let selection = Some(&args.selection);
    let source = ShapeSource { kind: args.kind, sample, selection, ..ShapeSource::new(&args.shape) };
    let input = load_source(&source, global)?;
    check_source_options(&[&input], global)?;
    let path = Some(to_path(&input.name)).filter(|path| path.is_file());
    let name = path.as_deref().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let opened = StudioInput {
        name: name.unwrap_or_else(|| input.name.clone()),
        path,
        file: input.file,
        shape: input.shape,
    };
    // Each edit needs as much memory as the one before.
    global.tune_heap(HeapUse::ReuseUpTo(KEPT));
    let params = StudioParams::default().with_port(args.port).with_host(args.host);
    let mut browser = None;
    let mut printed = Ok(());
    // The bar is made once a large graph is being placed: remarks about the input are printed before it, and not before a
    // refusal.
    let opening = OnceLock::new();
    let report = |done: u64, total: u64| {
        let bar = opening.get_or_init(|| bar(global, "opening"));
        bar.set_length(total);
        bar.set_position(done);
    };
    let progress = global.progress().with_report(&report);
    let finished = serve(opened, &params, progress, |served: &StudioAddress| {
        if let Some(bar) = opening.get() {
            bar.finish_and_clear();
        }
        let text = format!("{}\npress Ctrl-C to end\n", served.url);
        let json = json!({"address": served.url});
        // The address is the result, which nobody can guess.
        printed = if global.quiet {
            print_bytes(global, format!("{}\n", served.url).as_bytes(), &json)
        } else {
            print(global, &text, &json)
        };
        if !args.no_open {
            browser = open(&served.url_for_browser);
            if browser.is_none() {
                note(global, "no browser was found; open the address yourself");
            }
        }
    });
    drop(browser);
    // Ctrl-C is the way to end it.
    finished.map_err(|e| CliError::classify(&e))?;
    printed
}

/// Starts the browser.
fn open(address: &str) -> Option<Child> {
    let (program, words): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else {
        let has_screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
        if !has_screen {
            return None; // xdg-open would open a text browser in this terminal
        }
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(words).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().ok()
}
