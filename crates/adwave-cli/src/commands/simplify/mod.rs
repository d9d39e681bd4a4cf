//! `adwave simplify`: fewer vertices at a measured distance.

mod args;

use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::stopwatch::Stopwatch;
use crate::output::{check_writable, count, note, number, output_format, percent_of, print, write_shape};
use crate::resolve::applicable::check_source_options;
use crate::resolve::shape::{GivenLength, Input, ShapeSource, load_source};
use crate::resolve::signal::load_signal;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape, triangulate};
use adwave_io::{ShapeFile, Subset};
use adwave_simplify::{
    Appearance, AppearanceValues, Border, CloudTarget, Deviation, MeshParams, MeshTarget, SimplifiedMesh,
    SimplifyError, Why, measure_coarse_mesh, simplify_cloud, simplify_mesh_with_appearance,
};
use adwave_subdivision::{BorderCorners, SubdivisionError, WeldedMesh};
pub(crate) use args::SimplifyArgs;
use serde_json::{Value, json};
use std::fmt::Write;

/// The simplified shape and the report on it.
struct Simplified {
    file: ShapeFile,
    /// Distances between both shapes, if they were measured.
    deviation: Option<Deviation>,
    /// Seconds of the time of the simplification that measuring took.
    measure_seconds: f64,
    /// Distance that all points of both surfaces are proven to keep.
    within: Option<f64>,
    is_changed: bool,
    /// Number of vertices that remain of those that take part.
    n_vertices: usize,
    lines: Vec<String>,
    details: Value,
}

pub(crate) fn run(args: &SimplifyArgs, global: &Global<'_>) -> Result<(), CliError> {
    output_format(&args.output)?;
    check_writable(&args.output)?;
    check_target(args)?;
    let mut watch = Stopwatch::start();
    let (part, selection) = (args.part.to_part(), Some(&args.selection));
    let source = ShapeSource { kind: args.kind, part, selection, ..ShapeSource::new(&args.shape) };
    let mut input = load_source(&source, global)?;
    check_source_options(&[&input], global)?;
    input.allows_degrees = args.allow_degrees;
    let error = args.error.map(|length| GivenLength { option: "--error", length });
    input.check_lengths(error.as_slice())?;
    let read = watch.lap();
    let simplified_shape = match &input.shape {
        Shape::Mesh(mesh) => simplify_mesh_file(args, &input, mesh, global)?,
        Shape::Cloud(_) if args.weights.is_some() => {
            return Err(CliError::Input(format!(
                "--weights is for meshes, and {} is a cloud; leave it out",
                input.name
            )));
        }
        Shape::Cloud(cloud) => simplify_cloud_file(args, &input, cloud, global)?,
        Shape::Graph(graph) if graph.positions().is_some() => {
            return Err(CliError::Input(format!(
                "{}: simplification is for surfaces and points, and this is a curve; give a mesh or a cloud",
                input.name
            )));
        }
        Shape::Graph(_) => {
            return Err(CliError::Input(format!(
                "{}: a graph has no positions, so it cannot be simplified; give a mesh or a cloud",
                input.name
            )));
        }
    };
    let simplified = watch.lap();
    global.progress().check().map_err(|_| CliError::Cancelled)?;
    note_losses(global, &input, &simplified_shape.file);
    write_shape(global, &simplified_shape.file, &args.output)?;
    let seconds = SimplifySeconds { read, simplify: simplified, write: watch.lap() };
    report(args, &input, &simplified_shape, &seconds, global)
}

/// Seconds that each part took.
struct SimplifySeconds {
    read: f64,
    simplify: f64,
    write: f64,
}

/// Refuses targets that no shape can reach, before anything is read.
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

fn simplify_mesh_file(
    args: &SimplifyArgs,
    input: &Input,
    mesh: &Mesh,
    global: &Global<'_>,
) -> Result<Simplified, CliError> {
    if let Some(level) = args.level {
        return coarse_level(input, mesh, level.get(), global);
    }
    let target = match (args.error, args.vertices, args.ratio) {
        (Some(error), ..) => MeshTarget::Error(error.to_model_units(input.shape.extent())),
        (_, Some(n), _) => MeshTarget::Vertices(n),
        (.., ratio) => MeshTarget::Ratio(ratio.unwrap_or(1.0)),
    };
    // Faces that take no part hold on to the vertices along the cut.
    let is_border_kept = args.keep_border || input.file.n_left_out_faces() > 0;
    let border = if is_border_kept { Border::Kept } else { Border::Weighted };
    let (labels, values) = (input.file.corner_labels(), input.file.corner_values());
    let values = values.as_ref().map(|of| AppearanceValues { values: &of.values, n_channels: of.n_channels });
    let weights = load_weights(args, input, global)?;
    let appearance = Appearance { labels: labels.as_deref(), values, weights: weights.as_deref() };
    let simplified = with_progress(global, "simplifying", |progress| {
        let params = MeshParams::new(target).with_border(border).with_measure(args.measure);
        let params = params.with_nearest_faces(!input.file.face_fields().is_empty());
        simplify_mesh_with_appearance(mesh, appearance, &params, progress)
    })
    .map_err(|e| name_error(input, e))?;
    let is_changed = simplified.why != Why::Unchanged;
    let file = if is_changed {
        input.file.subset_with_left_out(&Subset {
            vertices: &simplified.kept,
            triangles: &simplified.triangles,
            faces: &simplified.faces,
            corners: &simplified.corners,
        })?
    } else {
        input.file.clone()
    };
    let n_faces = if is_changed { simplified.triangles.len() } else { mesh.faces().len() };
    let n_vertices = if is_changed { simplified.kept.len() } else { input.file.n_vertices() };
    let mut lines = vec![format!("faces      {} → {n_faces}", mesh.faces().len())];
    match (shortfall(args, &simplified), simplified.why) {
        (Some(text), Why::Stuck) => note(global, &text),
        (text, _) => lines.extend(text),
    }
    Ok(Simplified {
        details: json!({
            "faces": {"before": mesh.faces().len(), "after": n_faces},
            "vertices_welded": simplified.n_vertices_before,
            "triangles_left_out": simplified.n_left_out,
            "reached": simplified.why != Why::Stuck,
        }),
        file,
        deviation: simplified.deviation,
        measure_seconds: simplified.measure_seconds,
        within: simplified.within,
        is_changed,
        n_vertices,
        lines,
    })
}

/// Values of the signal that `--weights` names.
fn load_weights(
    args: &SimplifyArgs,
    input: &Input,
    global: &Global<'_>,
) -> Result<Option<Vec<f64>>, CliError> {
    let Some(name) = &args.weights else { return Ok(None) };
    let signal = load_signal(global, input, name, None)?;
    if signal.n_channels != 1 {
        return Err(CliError::Input(format!(
            "--weights must name a signal of one number per vertex, and {name} has {}",
            signal.n_channels
        )));
    }
    Ok(Some(signal.values.to_vec()))
}

/// A coarser level of a mesh that was made by cutting triangles into four, or polygons into quadrilaterals.
fn coarse_level(
    input: &Input,
    mesh: &Mesh,
    level: usize,
    global: &Global<'_>,
) -> Result<Simplified, CliError> {
    global.given.refuse(&["--keep-border", "--weights"], "applies to --error, --vertices and --ratio")?;
    global
        .given
        .refuse(&["--measure"], "applies to --error, --vertices and --ratio; a level is always measured")?;
    let name_error = |error: SubdivisionError| match error {
        SubdivisionError::Cancelled(_) => CliError::Cancelled,
        other => CliError::Input(format!("{}: {other}", input.name)),
    };
    let (faces, n_levels) = with_progress(global, "finding levels", |progress| {
        let welded = WeldedMesh::new(mesh);
        let hierarchy = welded.hierarchy(mesh, &[], BorderCorners::default(), progress)?;
        let names = hierarchy.vertices(level)?;
        let name = |&v: &u32| welded.vertices[names[v as usize] as usize];
        let faces = hierarchy.faces(level)?;
        let named: Vec<Vec<u32>> = faces.iter().map(|face| face.iter().map(name).collect()).collect();
        Ok((named.iter().map(Vec::as_slice).collect::<Polygons>(), hierarchy.n_levels()))
    })
    .map_err(name_error)?;
    let triangles = triangulate(mesh.points(), &faces);
    let measured =
        with_progress(global, "measuring", |progress| measure_coarse_mesh(mesh, &triangles, progress))
            .map_err(|error| self::name_error(input, error))?;
    let of_polygons = mesh.faces().triangles().is_none();
    let file = if of_polygons {
        polygon_level(input, &faces)?
    } else {
        input.file.subset_with_left_out(&Subset {
            vertices: &measured.kept,
            triangles: &measured.triangles,
            faces: &measured.faces,
            corners: &measured.corners,
        })?
    };
    let n_vertices = if of_polygons { file.n_vertices() } else { measured.kept.len() };
    let after = if of_polygons { faces.len() } else { measured.triangles.len() };
    let before = mesh.faces().len();
    let lines = vec![
        format!("faces      {before} → {after}"),
        format!("level      {level} of {}", count(n_levels, "level of subdivision", "levels of subdivision")),
    ];
    Ok(Simplified {
        details: json!({
            "faces": {"before": before, "after": after},
            "level": level,
            "levels": n_levels,
            "vertices_welded": measured.n_vertices_before,
            "triangles_left_out": measured.n_left_out,
            "reached": true,
        }),
        file,
        deviation: measured.deviation,
        measure_seconds: measured.measure_seconds,
        within: None,
        is_changed: true,
        n_vertices,
        lines,
    })
}

/// The vertices of some polygons with their fields, and these polygons.
fn polygon_level(input: &Input, faces: &Polygons) -> Result<ShapeFile, CliError> {
    let mut kept = faces.corners().to_vec();
    kept.sort_unstable();
    kept.dedup();
    let part = input.file.subset(&Subset { vertices: &kept, ..Subset::default() })?;
    let place = |v: &u32| kept.partition_point(|k| k < v) as u32;
    let renamed: Vec<Vec<u32>> = faces.iter().map(|face| face.iter().map(place).collect()).collect();
    let polygons = renamed.iter().map(Vec::as_slice).collect();
    let mut file = ShapeFile::from_mesh(part.points().to_vec(), polygons);
    for field in part.vertex_fields() {
        file.add_vertex_field(field.clone())?;
    }
    Ok(file)
}

/// Line on a target that was not reached: the target, the result, and the reason.
fn shortfall(args: &SimplifyArgs, simplified: &SimplifiedMesh) -> Option<String> {
    let n = simplified.n_vertices_before;
    match (simplified.why, args.vertices.or(args.ratio.map(|r| (r * n as f64).round() as usize))) {
        (Why::Reached, _) => None,
        (Why::Unchanged, None) => Some("unchanged: no vertex can be dropped within the error".to_owned()),
        (Why::Unchanged, Some(wanted)) => {
            Some(format!("unchanged: the faces have {n} vertices, no more than the {wanted} asked for"))
        }
        (Why::Stuck, wanted) => {
            let (wanted, reached) = (wanted.unwrap_or(0), simplified.kept.len());
            let parts = simplified.parts.unwrap_or_default();
            let (n_parts, least) = (parts.n_open + parts.n_closed, parts.n_least_vertices());
            let reason = if wanted < least {
                let are =
                    if n_parts == 1 { "1 part needs".to_owned() } else { format!("{n_parts} parts need") };
                format!("{are} at least {least} vertices (4 if closed, 3 if not)")
            } else {
                let borders = if args.keep_border { ", kept borders" } else { "" };
                format!(
                    "a further collapse would close a hole, a handle, a part or a seam, or fold the surface; ends and \
                     junctions of seams, of borders and of edges with more than two faces{borders} are kept"
                )
            };
            Some(format!("asked for {wanted} vertices, reached {reached}: {reason}"))
        }
    }
}

fn simplify_cloud_file(
    args: &SimplifyArgs,
    input: &Input,
    cloud: &PointCloud,
    global: &Global<'_>,
) -> Result<Simplified, CliError> {
    if args.keep_border {
        return Err(CliError::Input(
            "--keep-border applies to meshes, and a cloud has no border; leave it out".to_owned(),
        ));
    }
    global.given.refuse(&["--level"], &format!("applies to meshes, and {} is a cloud", input.name))?;
    global.given.refuse(&["--measure"], "applies to meshes; clouds are always measured")?;
    let target = match (args.error, args.vertices, args.ratio) {
        (Some(error), ..) => CloudTarget::Spacing(error.to_model_units(input.shape.extent())),
        (_, Some(n), _) => CloudTarget::Points(n),
        (.., ratio) => CloudTarget::Ratio(ratio.unwrap_or(1.0)),
    };
    let thinned = with_progress(global, "thinning", |progress| simplify_cloud(cloud, target, progress))
        .map_err(|e| name_error(input, e))?;
    // A mesh that is taken as a cloud is written as one.
    let is_changed = thinned.kept.len() < cloud.points().len() || !input.file.faces().is_empty();
    let file = if is_changed {
        input.file.subset_with_left_out(&Subset { vertices: &thinned.kept, ..Subset::default() })?
    } else {
        input.file.clone()
    };
    let diagonal = input.shape.extent();
    let line = if is_changed {
        format!(
            "spacing    {}, {} % of the diagonal: no two points are nearer, and every dropped point is that near to one that stays",
            number(thinned.spacing),
            percent_of(thinned.spacing, diagonal)
        )
    } else {
        "unchanged: no point can be dropped".to_owned()
    };
    Ok(Simplified {
        details: json!({"spacing": thinned.spacing}),
        file,
        deviation: Some(thinned.deviation),
        measure_seconds: 0.0,
        within: None,
        is_changed,
        n_vertices: thinned.kept.len(),
        lines: vec![line],
    })
}

/// An error with the name of the shape, if it is about the shape.
fn name_error(input: &Input, error: SimplifyError) -> CliError {
    match error {
        SimplifyError::NoSurface => CliError::Input(format!("{}: {error}", input.name)),
        other => other.into(),
    }
}

/// Prints a note on content of the file that the result does not have.
fn note_losses(global: &Global<'_>, input: &Input, file: &ShapeFile) {
    let lost: Vec<&str> = input
        .file
        .extras()
        .iter()
        .filter(|extra| !file.extras().contains(extra) && file.field(vertex_field_name(extra)).is_none())
        .map(String::as_str)
        .collect();
    if !lost.is_empty() {
        note(global, &format!("not carried over: {}", lost.join(", ")));
    }
}

/// The vertex field that values of corners become if each remaining vertex has one value.
fn vertex_field_name(extra: &str) -> &str {
    match extra {
        "texture coordinates of face corners" => "texcoord",
        "normals of face corners" => "normal",
        other => other,
    }
}

/// Ratio of the bounds of the largest distance up to which only one of them is shown.
const MAX_BOUND_RATIO: f64 = 1.02;

/// Distances caused by rounding, as a share of the diagonal.
const ROUNDING_SHARE: f64 = 1e-11;

/// Text on what is known of the distances between both shapes.
fn error_text(input: &Input, simplified_shape: &Simplified) -> String {
    let diagonal = input.shape.extent();
    let percent = |length: f64| percent_of(length, diagonal);
    let Some(deviation) = simplified_shape.deviation else {
        return match simplified_shape.within {
            Some(within) => format!(
                "no point of either surface is farther than {} ({} % of the diagonal), which every collapse has proven \
                 (--measure measures the largest distance and the rms)",
                number(within),
                percent(within)
            ),
            None => "not measured (--measure)".to_owned(),
        };
    };
    let (greatest, rms, at_least) = (deviation.greatest(), deviation.rms(), deviation.lower_bound());
    let by = if input.shape.is_mesh() { "rms by area" } else { "rms" };
    let is_close = greatest <= MAX_BOUND_RATIO * at_least + ROUNDING_SHARE * diagonal;
    let basis = match input.shape {
        Shape::Mesh(_) if is_close => "no point is farther; measured on the result".to_owned(),
        Shape::Mesh(_) => {
            format!(
                "no point is farther; measured on the result, the farthest point found is at {}",
                number(at_least)
            )
        }
        _ => "measured on the result".to_owned(),
    };
    format!(
        "greatest {} ({} % of the diagonal), {by} {} ({} %); {basis}",
        number(greatest),
        percent(greatest),
        number(rms),
        percent(rms)
    )
}

fn report(
    args: &SimplifyArgs,
    input: &Input,
    simplified_shape: &Simplified,
    seconds: &SimplifySeconds,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let (before, after) = (input.shape.n_vertices(), simplified_shape.n_vertices);
    let diagonal = input.shape.extent();
    let bytes = global.files.size(&args.output);
    let mut text = format!("{}: {before} → {after} vertices\n", input.name);
    for line in &simplified_shape.lines {
        let _ = writeln!(text, "  {line}");
    }
    let _ = writeln!(text, "  error      {}", error_text(input, simplified_shape));
    if let Some(bytes) = bytes {
        let _ = writeln!(text, "  size       {bytes} bytes");
    }
    let (SimplifySeconds { read, simplify, write }, measure) = (seconds, simplified_shape.measure_seconds);
    let measured = if measure > 0.0 { format!(", measured {measure:.3} s") } else { String::new() };
    let simplify = simplify - measure;
    let _ = writeln!(text, "read {read:.3} s, simplified {simplify:.3} s{measured}, written {write:.3} s");
    let _ = writeln!(text, "{}", args.output.display());
    let side = |side: adwave_simplify::OneSided| json!({"greatest": side.greatest, "at_least": side.at_least, "rms": side.rms});
    let mut json = json!({
        "shape": input.name,
        "output": args.output.display().to_string(),
        "changed": simplified_shape.is_changed,
        "vertices": {"before": before, "after": after},
        "diagonal": diagonal,
        "error": simplified_shape.deviation.map(|deviation| json!({
            "greatest": deviation.greatest(),
            "at_least": deviation.lower_bound(),
            "rms": deviation.rms(),
            "of_input": side(deviation.of_original),
            "of_result": side(deviation.of_simplified),
        })),
        "within": simplified_shape.within,
        "bytes": bytes,
        "seconds": {"read": seconds.read, "simplify": simplify, "measure": measure, "write": seconds.write},
    });
    if let (Some(json), Value::Object(details)) = (json.as_object_mut(), simplified_shape.details.clone()) {
        json.extend(details);
    }
    print(global, &text, &json)
}
