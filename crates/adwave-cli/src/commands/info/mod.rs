//! `adwave info`: what a shape consists of, what is unusual about it, and which levels it gets.

mod detail;

use crate::args::{LevelArgs, ShapeArgs, any_length};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{
    bounds_json, bounds_text, check_levels, fwhm_json, fwhm_text, number, percent_of, print, schedule,
    steps_json, steps_text, table,
};
use crate::progress::{prepare, with_spinner};
use crate::provenance;
use crate::shape_input::{Input, load};
use adwave::Decomposer;
use adwave::operator::SurfaceInfo;
use adwave::region::Length;
use adwave::shape::{Health, Shape, bounding_box};
use adwave_io::{CloudLevels, Format, ReadError, cloud_levels};
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  adwave info scan.las
  adwave info land.copc.laz --resolution 5        a coarse look at a large cloud
  adwave info bunny.obj --json | jq .health
  adwave info sample:creature --vertices 200000
  adwave info bunny.obj --detail                 what each level loses
  adwave info bunny.obj --error 0.1%             how many of the fine bands can be dropped for that")]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    /// Measure what is lost of the shape when everything finer than each level is dropped
    #[arg(long, help_heading = "Detail")]
    pub(crate) detail: bool,
    /// Say how many of the fine bands can be dropped for an error of at most this, in model units or in % of the diagonal
    #[arg(long, value_name = "LENGTH", value_parser = any_length, allow_negative_numbers = true, help_heading = "Detail")]
    pub(crate) error: Option<Length>,
}

impl InfoArgs {
    fn wants_detail(&self) -> bool {
        self.detail || self.error.is_some()
    }
}

pub(crate) fn run(args: &InfoArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_levels(&args.levels)?;
    detail::check(args)?;
    let (input, decomposer, health) = with_spinner(global, "reading", || {
        let input = load(&args.shape, global)?;
        let decomposer = prepare(global, &input.shape, &args.shape.operator_for(&args.levels)?)?;
        let health = decomposer.health();
        Ok::<_, CliError>((input, decomposer, health))
    })?;
    let (schedule, why) = schedule(&args.levels, &decomposer, global)?;
    let sigma = schedule.sigma(decomposer.diffusion().step_length());
    let detail = args
        .wants_detail()
        .then(|| detail::measure(args, &input, &decomposer, &schedule, &health, global))
        .transpose()?;
    let kind = kind(&input.shape);
    let diagonal = decomposer.diagonal();
    let format = input.file.format().map_or_else(|| "sample".to_owned(), |f| f.to_string());

    let mut text = format!("{}: {kind}, {format}\n", input.name);
    let bounds = input.shape.points().and_then(bounding_box);
    health_lines(&mut text, &input.shape, &health);
    if let Some(bounds) = bounds {
        let _ = writeln!(text, "  bounding box  {}", bounds_text(bounds, diagonal));
    }
    if diagonal > 0.0 {
        let _ = writeln!(text, "  diagonal      {}", number(diagonal));
    }
    let octree = octree(&input, global);
    if let Some(octree) = &octree {
        let _ = writeln!(text, "  octree        {}", octree_text(octree));
    }
    health_notes(&mut text, &health);
    let is_unsymmetric = kind == "graph" && input.file.is_unsymmetric();
    if is_unsymmetric {
        text +=
            "  weights       (M + Mᵀ)/2: the matrix M is not symmetric, and a walk on it goes both ways\n";
    }
    text += &input.file.provenance().map_or_else(String::new, provenance::text);
    let fields = input.file.vertex_fields();
    if !fields.is_empty() {
        let named = fields.iter().map(|f| format!("{} ({})", f.name, f.n_channels)).collect::<Vec<_>>();
        let _ = writeln!(text, "  fields        {}", named.join(", "));
    }
    let _ = writeln!(
        text,
        "  diffusion     {}{}{}, {} entries, mean edge {}, step {}",
        decomposer.operator_kind().name(),
        if decomposer.operator_params().density_invariant { " without density" } else { "" },
        if decomposer.operator_params().keep_creases { " along creases" } else { "" },
        decomposer.diffusion().nnz(),
        number(decomposer.mean_length()),
        number(decomposer.diffusion().step_length()),
    );
    if let Some(info) = decomposer.surface_info() {
        let _ = writeln!(text, "  surface       {}", surface_text(info, &input.shape));
    }
    let _ = writeln!(text, "  levels        {why}\n");
    text += &table(
        ["level", "steps", "sigma", "FWHM", "% of diagonal"],
        (1..=schedule.n_levels()).map(|j| {
            [
                j.to_string(),
                steps_text(schedule.steps()[j - 1]),
                number(sigma[j]),
                fwhm_text(sigma[j], diagonal),
                percent_of(sigma[j], diagonal),
            ]
        }),
    );

    text += &detail.as_ref().map_or_else(String::new, detail::Detail::text);

    let json = json!({
        "shape": input.name,
        "kind": kind,
        "format": format,
        "fields": fields.iter().map(|f| json!({"name": f.name, "channels": f.n_channels})).collect::<Vec<_>>(),
        "provenance": input.file.provenance().map(provenance::json),
        "bounding_box": bounds_json(bounds),
        "diagonal": diagonal,
        "octree": octree.and_then(Result::ok).map(|levels| json!({
            "spacing": levels.spacing, "points": levels.n_points,
        })),
        "made_symmetric": is_unsymmetric,
        "health": health_json(&health),
        "diffusion": diffusion_json(&decomposer),
        "levels": schedule.n_levels(),
        "levels_reason": why,
        "steps": steps_json(&schedule.steps_from_zero()),
        "sigma": sigma,
        "fwhm": fwhm_json(&sigma, diagonal),
        "detail": detail.as_ref().map(detail::Detail::json),
    });
    print(global, &text, &json)
}

fn diffusion_json(decomposer: &Decomposer) -> Value {
    json!({
        "operator": decomposer.operator_kind().name(),
        "density_invariant": decomposer.operator_params().density_invariant,
        "keeps_creases": decomposer.operator_params().keep_creases,
        "vertices": decomposer.diffusion().n_vertices(),
        "entries": decomposer.diffusion().nnz(),
        "mean_length": decomposer.mean_length(),
        "step_length": decomposer.diffusion().step_length(),
        "reversible": decomposer.diffusion().is_reversible(),
        "surface": decomposer.surface_info().map(|info| json!({
            "flips": info.laplacian.n_flips,
            "double_cover": info.laplacian.is_covered,
            "edges_lengthened_by": info.laplacian.lengthened,
            "mass_added": info.added_mass,
        })),
    })
}

/// The levels of a file that has such; what is wrong with them where it has no true ones, which the points do not need.
fn octree(input: &Input, global: &Global<'_>) -> Option<Result<CloudLevels, ReadError>> {
    let has_file = matches!(input.file.format(), Some(Format::LAZ | Format::EPT)) && input.name != "-";
    has_file.then(|| cloud_levels(Path::new(&input.name), &global.limits).transpose()).flatten()
}

fn octree_text(octree: &Result<CloudLevels, ReadError>) -> String {
    match octree {
        Ok(levels) => {
            let n = levels.n_points.len();
            let finest = levels.spacing * 0.5_f64.powi(n.saturating_sub(1) as i32);
            let points = levels.n_points.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
            format!("{n} levels of {points} points; {} to {} apart", number(levels.spacing), number(finest))
        }
        Err(error) => format!("of no use: {error}"),
    }
}

/// What was done to a shape on the way to heat on it.
fn surface_text(info: &SurfaceInfo, shape: &Shape) -> String {
    let mut said = match shape {
        Shape::Mesh(_) => vec![format!("{} edges flipped", info.laplacian.n_flips)],
        Shape::Cloud(_) => vec!["cells of the points in tangent planes".to_owned()],
        Shape::Graph(_) => return "degrees minus weights".to_owned(),
    };
    if info.laplacian.is_covered {
        said.push("covered twice".to_owned());
    }
    if info.laplacian.lengthened > 0.0 {
        said.push(format!("edges lengthened by {}", number(info.laplacian.lengthened)));
    }
    said.push(format!("{} % of mass added", number(100.0 * info.added_mass)));
    said.join(", ")
}

pub(crate) fn kind(shape: &Shape) -> &'static str {
    match shape {
        Shape::Mesh(_) => "mesh",
        Shape::Cloud(_) => "cloud",
        Shape::Graph(_) => "graph",
    }
}

/// The counts that mean something, one a line.
fn health_lines(text: &mut String, shape: &Shape, health: &Health) {
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<13} {value}");
    };
    line("vertices", health.n_vertices.to_string());
    if let Shape::Mesh(_) = shape {
        let polygons = if health.n_polygons > 0 {
            format!(", {} of them with more than three corners", health.n_polygons)
        } else {
            String::new()
        };
        line("faces", format!("{}{polygons}", health.n_faces));
        let surface = if health.is_closed() { "closed" } else { "open" };
        let volume = health.volume.map_or(String::new(), |v| format!(", volume {}", number(v)));
        let euler =
            health.euler_characteristic.map_or(String::new(), |e| format!(", Euler characteristic {e}"));
        line("surface", format!("{surface}, area {}{volume}{euler}", number(health.area)));
    }
    line("edges", health.n_edges.to_string());
    line("components", (health.n_components - health.n_isolated).to_string());
}

/// Counts that are 0 when all is well, where they are not.
fn health_notes(text: &mut String, health: &Health) {
    for (count, one, many) in [
        (health.n_boundary_edges, "boundary edge", "boundary edges"),
        (health.n_non_manifold_edges, "edge of three faces or more", "edges of three faces or more"),
        (
            health.n_misoriented_edges,
            "edge whose two faces disagree on the orientation",
            "edges whose two faces disagree on the orientation",
        ),
        (health.n_zero_area_faces, "face without area", "faces without area"),
        (health.n_repeated_faces, "repeated face", "repeated faces"),
        (
            health.n_welded,
            "vertex at the position of another, welded",
            "vertices at the position of another, welded",
        ),
        (
            health.n_isolated,
            "vertex without neighbors, unchanged in every band",
            "vertices without neighbors, unchanged in every band",
        ),
        (health.n_unreferenced, "vertex of no face", "vertices of no face"),
    ] {
        if count > 0 {
            let _ = writeln!(text, "  note          {count} {}", if count == 1 { one } else { many });
        }
    }
}

pub(crate) fn health_json(health: &Health) -> Value {
    json!({
        "vertices": health.n_vertices,
        "faces": health.n_faces,
        "polygons": health.n_polygons,
        "edges": health.n_edges,
        "components": health.n_components,
        "boundary_edges": health.n_boundary_edges,
        "non_manifold_edges": health.n_non_manifold_edges,
        "misoriented_edges": health.n_misoriented_edges,
        "zero_area_faces": health.n_zero_area_faces,
        "repeated_faces": health.n_repeated_faces,
        "welded_vertices": health.n_welded,
        "isolated_vertices": health.n_isolated,
        "unreferenced_vertices": health.n_unreferenced,
        "closed": health.is_closed(),
        "area": health.area,
        "volume": health.volume,
        "euler_characteristic": health.euler_characteristic,
    })
}
