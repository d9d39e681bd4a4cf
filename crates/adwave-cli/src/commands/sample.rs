//! `adwave sample`: a built-in shape as a file.

use crate::args::{Kind, SampleArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, format_of, print, table, write_shape};
use crate::progress::with_spinner;
use crate::shape_input::make_sample;
use adwave::sample::SAMPLE_NAMES;
use adwave_io::ShapeFile;
use serde_json::json;

pub(crate) fn run(args: &SampleArgs, global: &Global<'_>) -> Result<(), CliError> {
    let Some(name) = &args.name else { return list(global) };
    let Some(output) = &args.output else {
        return Err(CliError::Input(format!("say where the {name} goes: -o {name}.ply")));
    };
    format_of(output)?;
    check_writable(output)?;
    let mut file =
        with_spinner(global, "shaping", || make_sample(name, args.vertices, args.noise, args.seed))?;
    match args.kind {
        None | Some(Kind::Mesh) => {}
        Some(Kind::Cloud) => file = ShapeFile::from_cloud(file.points().to_vec()),
        Some(Kind::Graph) => return Err(CliError::Input("a sample is a mesh or a cloud".to_owned())),
    }
    write_shape(global, &file, output)?;
    let (n_vertices, n_faces) = (file.n_vertices(), file.faces().len());
    print(
        global,
        &format!("{name}: {n_vertices} vertices, {n_faces} faces\n{}\n", output.display()),
        &json!({
            "sample": name,
            "vertices": n_vertices,
            "faces": n_faces,
            "output": output.display().to_string(),
        }),
    )
}

fn list(global: &Global<'_>) -> Result<(), CliError> {
    let text = table(
        ["sample", "vertices", "what it is"],
        SAMPLE_NAMES
            .iter()
            .map(|s| [s.name.to_owned(), s.default_vertices.to_string(), s.description.to_owned()]),
    );
    let json = SAMPLE_NAMES
        .iter()
        .map(
            |s| json!({"name": s.name, "description": s.description, "default_vertices": s.default_vertices}),
        )
        .collect();
    print(global, &text, &json)
}
