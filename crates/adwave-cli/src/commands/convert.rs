//! `adwave convert`: a shape in another format.

use crate::args::PartArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, format_of, print, write_shape};
use crate::progress::with_spinner;
use crate::shape_input::{Source, load_source};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Points, faces, edges and fields go over in the number types that the new format has; what it cannot hold is said. 'adwave formats' lists
what each holds.

Examples:
  adwave convert model.glb -o model.ply
  adwave convert surface.vtu -o surface.obj
  adwave convert lh.pial -o lh.surf.gii
  adwave convert scan.e57 -o scan.laz
  adwave convert land.copc.laz -o corner.laz --box 635000,848000,636000,849000 --resolution 2
  adwave convert scan.ply -o - | other-program")]
pub(crate) struct ConvertArgs {
    /// The shape: a file, '-' for the standard input, or sample:NAME
    #[arg(value_name = "SHAPE")]
    shape: String,
    #[command(flatten)]
    part: PartArgs,
    /// Where it goes; the ending names the format
    #[arg(long, short, value_name = "OUT")]
    output: PathBuf,
}

pub(crate) fn run(args: &ConvertArgs, global: &Global<'_>) -> Result<(), CliError> {
    format_of(&args.output)?;
    check_writable(&args.output)?;
    let source = Source { part: args.part.part(), ..Source::new(&args.shape) };
    let input = with_spinner(global, "reading", || load_source(&source, global))?;
    let file = &input.file;
    let report = with_spinner(global, "writing", || write_shape(global, file, &args.output))?;
    let (n_vertices, n_faces) = (file.n_vertices(), file.faces().len());
    let output = args.output.display();
    print(
        global,
        &format!("{n_vertices} vertices, {n_faces} faces, {} fields\n{output}\n", file.vertex_fields().len()),
        &json!({
            "input": input.name,
            "format": file.format().map(adwave_io::Format::name),
            "vertices": n_vertices,
            "faces": n_faces,
            "fields": file.field_names(),
            "not_written": report.not_written,
            "output": output.to_string(),
        }),
    )
}
