//! `adwave convert`: a shape in another format.

use crate::args::{CloudPartArgs, SelectionArgs, file_name};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, count, output_format, print, write_shape};
use crate::resolve::applicable::check_source_options;
use crate::resolve::shape::{Input, Rest, SelectionUse, ShapeSource, load_source, row_words, select};
use crate::resolve::turned::{TurnedParts, turn_parts};
use adwave::shape::{PreparedGeometry, WeldMode, surface_parts};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Points, faces, edges and fields are written in the number types of the new format. A note lists what that format cannot store;
'adwave formats' lists it for every format. Numbers keep their unit of length; if the new format has another one (glTF is in meters),
they are converted, and a note says so. All points are written unless --only or --mask selects some, which are written alone.

Examples:
  adwave convert model.glb -o model.ply
  adwave convert surface.vtu -o surface.obj
  adwave convert lh.pial -o lh.surf.gii
  adwave convert scan.e57 -o scan.laz
  adwave convert land.copc.laz -o corner.laz --box 635000,848000,636000,849000 --resolution 2
  adwave convert scan.laz -o ground.ply --only classification=2
  adwave convert part.stl -o turned.stl --turn-faces inward
  adwave convert scan.ply -o - | other-program")]
pub(crate) struct ConvertArgs {
    /// Shape: a file, '-' for the standard input, or sample:NAME
    #[arg(value_name = "SHAPE", value_parser = file_name())]
    shape: String,
    #[command(flatten)]
    part: CloudPartArgs,
    #[command(flatten)]
    selection: SelectionArgs,
    /// Turn faces over: of closed parts whose faces point inward, or of all parts. Walls of cavities point inward
    /// rightly, and stay. Normals of the file follow if they belonged to the old front
    #[arg(long, value_name = "WHICH")]
    turn_faces: Option<TurnedFaces>,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    output: PathBuf,
}

/// Parts whose faces are turned over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TurnedFaces {
    /// Closed parts whose faces point inward
    Inward,
    /// All parts
    All,
}

/// Turns over the faces of some parts of a mesh.
fn turn_faces(which: TurnedFaces, input: &mut Input, global: &Global<'_>) -> Result<TurnedParts, CliError> {
    if input.file.faces().is_empty() {
        let applies = format!("applies to meshes, and {} has no faces", input.name);
        global.given.refuse(&["--turn-faces"], &applies)?;
    }
    let shape = input.file.to_shape()?;
    let geometry = PreparedGeometry::new(&shape, WeldMode::default(), global.progress())?;
    let parts = surface_parts(&geometry, global.progress())?;
    drop(geometry);
    drop(shape);
    let first_vertices = match which {
        TurnedFaces::Inward => parts.inward(),
        TurnedFaces::All => parts.parts.iter().map(|part| part.first_vertex).collect(),
    };
    turn_parts(input, &parts, &first_vertices)
}

pub(crate) fn run(args: &ConvertArgs, global: &Global<'_>) -> Result<(), CliError> {
    output_format(&args.output)?;
    check_writable(&args.output)?;
    let source = ShapeSource { part: args.part.to_part(), ..ShapeSource::new(&args.shape) };
    let selection = args.selection.to_selection()?;
    let mut input = load_source(&source, global)?;
    check_source_options(&[&input], global)?;
    if !selection.is_restricted() {
        let applies = "applies to a selection (--only or --mask), and without one all points are written";
        global.given.refuse(&["--all-points"], applies)?;
    }
    if input.file.grid().is_some() {
        let applies = format!("applies to shapes, and all places of {} are written", input.name);
        global.given.refuse(&["--only", "--mask"], &applies)?;
    }
    if selection.is_restricted() {
        let selection = SelectionUse { selection, rest: Rest::IsDropped };
        input.file = select(input.file, &input.name, selection, global)?;
        input.file.forget_left_out();
    }
    let turned = args.turn_faces.map(|which| turn_faces(which, &mut input, global)).transpose()?;
    let file = &input.file;
    let report = write_shape(global, file, &args.output)?;
    let (n_vertices, n_faces, [one, many]) = (file.n_vertices(), file.faces().len(), input.row_words());
    let output = args.output.display();
    let faces = if file.grid().is_some() { String::new() } else { count(n_faces, "face", "faces") + ", " };
    let mut text = format!(
        "{}, {faces}{}\n",
        count(n_vertices, one, many),
        count(file.vertex_fields().len(), "field", "fields")
    );
    let mut summary = json!({
        "input": input.name,
        "format": file.format().map(adwave_io::Format::name),
        row_words(file)[1]: n_vertices,
        "faces": n_faces,
        "fields": file.field_names(),
        "not_written": report.not_written,
        "notes": report.notes,
        "output": output.to_string(),
    });
    if let Some(turned) = turned {
        turned.describe(&mut text);
        turned.add_to(&mut summary);
    }
    print(global, &format!("{text}{output}\n"), &summary)
}
