//! `adwave simplify`: fewer vertices, and the distance measured.

mod args;

use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, format_of, note, number, percent_of, print, write_shape};
use crate::progress::{with_progress, with_spinner};
use crate::shape_input::{Input, Source, load_source};
use crate::stopwatch::Stopwatch;
use adwave::shape::{Mesh, PointCloud, Shape};
use adwave_io::{ShapeFile, Subset};
use adwave_simplify::{
    Border, CloudTarget, Deviation, MeshParams, MeshTarget, SimplifiedMesh, SimplifyError, Why,
    simplify_cloud, simplify_mesh,
};
pub(crate) use args::SimplifyArgs;
use serde_json::{Value, json};
use std::fmt::Write;

/// What goes out, and what is said of it.
struct Outcome {
    file: ShapeFile,
    deviation: Deviation,
    is_changed: bool,
    lines: Vec<String>,
    details: Value,
}

pub(crate) fn run(args: &SimplifyArgs, global: &Global<'_>) -> Result<(), CliError> {
    format_of(&args.output)?;
    check_writable(&args.output)?;
    check_target(args)?;
    let mut watch = Stopwatch::start();
    let source = Source { kind: args.kind, part: args.part.part(), ..Source::new(&args.shape) };
    let input = with_spinner(global, "reading", || load_source(&source, global))?;
    let read = watch.lap();
    let outcome = match &input.shape {
        Shape::Mesh(mesh) => of_mesh(args, &input, mesh, global)?,
        Shape::Cloud(cloud) => of_cloud(args, &input, cloud, global)?,
        Shape::Graph(_) => {
            return Err(CliError::Input(format!(
                "{}: a graph has no positions, so there is nothing to simplify by distance; give a mesh or a cloud",
                input.name
            )));
        }
    };
    let simplified = watch.lap();
    global.progress().check().map_err(|_| CliError::Cancelled)?;
    say_what_is_lost(global, &input, &outcome.file);
    with_spinner(global, "writing", || write_shape(global, &outcome.file, &args.output))?;
    let seconds = [read, simplified, watch.lap()];
    report(args, &input, &outcome, seconds, global)
}

/// Refuses before anything is read what no shape can be simplified to.
fn check_target(args: &SimplifyArgs) -> Result<(), CliError> {
    let error = args.error.map(|error| error.to_model_units(1.0)).filter(|e| !(e.is_finite() && *e >= 0.0));
    let ratio = args.ratio.filter(|r| !(*r > 0.0 && *r <= 1.0));
    match (error, ratio, args.vertices) {
        (Some(error), ..) => Err(SimplifyError::Length(error).into()),
        (_, Some(ratio), _) => Err(SimplifyError::Ratio(ratio).into()),
        (.., Some(0)) => Err(SimplifyError::NoVertices.into()),
        _ => Ok(()),
    }
}

fn of_mesh(
    args: &SimplifyArgs,
    input: &Input,
    mesh: &Mesh,
    global: &Global<'_>,
) -> Result<Outcome, CliError> {
    let target = match (args.error, args.vertices, args.ratio) {
        (Some(error), ..) => MeshTarget::Error(error.to_model_units(input.shape.diagonal())),
        (_, Some(n), _) => MeshTarget::Vertices(n),
        (.., ratio) => MeshTarget::Ratio(ratio.unwrap_or(1.0)),
    };
    let border = if args.keep_border { Border::Kept } else { Border::Weighted };
    let labels = input.file.corner_labels();
    let simplified = with_progress(global, "simplifying", |progress| {
        let params = MeshParams::new(target).with_border(border);
        simplify_mesh(mesh, labels.as_deref(), &params, progress)
    })
    .map_err(|e| in_shape(input, e))?;
    let is_changed = simplified.why != Why::Unchanged;
    let file = if is_changed {
        input.file.subset(&Subset {
            vertices: &simplified.kept,
            triangles: &simplified.triangles,
            faces: &simplified.faces,
            corners: &simplified.corners,
        })?
    } else {
        input.file.clone()
    };
    let mut lines = vec![format!("faces      {} → {}", mesh.faces().len(), file.faces().len())];
    lines.extend(why_not(args, &simplified));
    Ok(Outcome {
        details: json!({
            "faces": {"before": mesh.faces().len(), "after": file.faces().len()},
            "vertices_welded": simplified.n_vertices_before,
            "triangles_left_out": simplified.n_left_out,
            "reached": simplified.why != Why::Stuck,
        }),
        file,
        deviation: simplified.deviation,
        is_changed,
        lines,
    })
}

/// What to know where the target was not reached.
fn why_not(args: &SimplifyArgs, simplified: &SimplifiedMesh) -> Option<String> {
    let n = simplified.n_vertices_before;
    match (simplified.why, args.vertices.or(args.ratio.map(|r| (r * n as f64).round() as usize))) {
        (Why::Reached, _) => None,
        (Why::Unchanged, None) => Some("unchanged: no vertex can be dropped within that error".to_owned()),
        (Why::Unchanged, Some(wanted)) => {
            Some(format!("unchanged: the faces have {n} vertices, no more than the {wanted} asked for"))
        }
        (Why::Stuck, wanted) => Some(format!(
            "not the {} asked for: seams of textures and materials, {}edges of three faces, and parts that are as small as \
             they can be stay",
            wanted.unwrap_or(0),
            if args.keep_border { "borders, " } else { "" },
        )),
    }
}

fn of_cloud(
    args: &SimplifyArgs,
    input: &Input,
    cloud: &PointCloud,
    global: &Global<'_>,
) -> Result<Outcome, CliError> {
    if args.keep_border {
        return Err(CliError::Input(
            "--keep-border is for meshes; a cloud has no border, leave it out".to_owned(),
        ));
    }
    let target = match (args.error, args.vertices, args.ratio) {
        (Some(error), ..) => CloudTarget::Spacing(error.to_model_units(input.shape.diagonal())),
        (_, Some(n), _) => CloudTarget::Points(n),
        (.., ratio) => CloudTarget::Ratio(ratio.unwrap_or(1.0)),
    };
    let thinned = with_progress(global, "thinning", |progress| simplify_cloud(cloud, target, progress))
        .map_err(|e| in_shape(input, e))?;
    // A mesh that is taken as a cloud goes out as one.
    let is_changed = thinned.kept.len() < cloud.points().len() || !input.file.faces().is_empty();
    let file = if is_changed {
        input.file.subset(&Subset { vertices: &thinned.kept, ..Subset::default() })?
    } else {
        input.file.clone()
    };
    let diagonal = input.shape.diagonal();
    let line = if is_changed {
        format!(
            "spacing    {}, {} % of the diagonal: no two points are nearer, and every dropped one has one within it",
            number(thinned.spacing),
            percent_of(thinned.spacing, diagonal)
        )
    } else {
        "unchanged: no point can be dropped for that".to_owned()
    };
    Ok(Outcome {
        details: json!({"spacing": thinned.spacing}),
        file,
        deviation: thinned.deviation,
        is_changed,
        lines: vec![line],
    })
}

/// An error about the shape begins with its name.
fn in_shape(input: &Input, error: SimplifyError) -> CliError {
    match error {
        SimplifyError::NoSurface => CliError::Input(format!("{}: {error}", input.name)),
        other => other.into(),
    }
}

/// What the file had besides that the result does not carry.
fn say_what_is_lost(global: &Global<'_>, input: &Input, file: &ShapeFile) {
    let lost: Vec<&str> = input
        .file
        .extras()
        .iter()
        .filter(|extra| !file.extras().contains(extra) && file.field(field_of(extra)).is_none())
        .map(String::as_str)
        .collect();
    if !lost.is_empty() {
        note(global, &format!("not carried over: {}", lost.join(", ")));
    }
}

/// The field that values of corners become where each vertex that is left has one.
fn field_of(extra: &str) -> &str {
    match extra {
        "texture coordinates of face corners" => "texcoord",
        "normals of face corners" => "normal",
        other => other,
    }
}

fn report(
    args: &SimplifyArgs,
    input: &Input,
    outcome: &Outcome,
    [read, simplified, written]: [f64; 3],
    global: &Global<'_>,
) -> Result<(), CliError> {
    let (before, after) = (input.shape.n_vertices(), outcome.file.n_vertices());
    let diagonal = input.shape.diagonal();
    let (greatest, rms) = (outcome.deviation.greatest(), outcome.deviation.rms());
    let bytes = std::fs::metadata(&args.output).map_or(0, |m| m.len());
    let by = if let Shape::Mesh(_) = input.shape { "rms by area" } else { "rms" };
    let mut text = format!("{}: {before} → {after} vertices\n", input.name);
    for line in &outcome.lines {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(
        text,
        "  error      greatest {} ({} % of the diagonal), {by} {} ({} %), measured",
        number(greatest),
        percent_of(greatest, diagonal),
        number(rms),
        percent_of(rms, diagonal),
    );
    let _ = writeln!(text, "  size       {bytes} bytes");
    let _ = writeln!(text, "read {read:.3} s, simplified {simplified:.3} s, written {written:.3} s");
    let _ = writeln!(text, "{}", args.output.display());
    let side = |side: adwave_simplify::OneSided| json!({"greatest": side.greatest, "rms": side.rms});
    let mut json = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "changed": outcome.is_changed,
        "vertices": {"before": before, "after": after},
        "diagonal": diagonal,
        "error": {
            "greatest": greatest,
            "rms": rms,
            "of_input": side(outcome.deviation.of_original),
            "of_result": side(outcome.deviation.of_simplified),
        },
        "bytes": bytes,
        "seconds": {"read": read, "simplify": simplified, "write": written},
    });
    if let (Some(json), Value::Object(details)) = (json.as_object_mut(), outcome.details.clone()) {
        json.extend(details);
    }
    print(global, &text, &json)
}
