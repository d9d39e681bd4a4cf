//! `adwave info`: contents of a shape, unusual features of it, and the levels that it gets.

mod args;
mod detail;
mod health;

use crate::args::to_path;
use crate::error::CliError;
use crate::global::Global;
use crate::output::health::health_json;
use crate::output::progress::with_progress;
use crate::output::provenance::{provenance_json, provenance_text};
use crate::output::{
    bounds_json, bounds_text, count, fwhm_json, fwhm_text, given_normals_json, number, percent_of, print,
    steps_json, steps_text, table,
};
use crate::resolve::levels::{check_levels, resolve_levels};
use crate::resolve::operator::{operator_for_levels, prepare};
use crate::resolve::shape::{Input, load_shape, row_words};
use crate::resolve::walk::with_given_walk;
use adwave::operator::{Semigroup, SurfaceInfo};
use adwave::shape::{Health, PreparedGeometry, Shape, VertexRole, bounding_box, curve_length};
use adwave::{Decomposer, ResolvedLevels};
use adwave_io::{
    BrainLayout, BrainPart, BrainPlaces, CloudLevels, Field, Format, GraphChanges, GridLayout, LengthUnit,
    ReadError, cloud_levels,
};
use adwave_subdivision::{Hierarchy, QuadParams, SubdivisionError};
pub(crate) use args::InfoArgs;
use detail::Detail;
use health::{health_lines, health_notes};
use serde_json::{Value, json};
use std::fmt::Write;

/// Facts about a shape.
struct ShapeFacts {
    input: Input,
    decomposer: Decomposer,
    /// Counts of the elements of a shape; `None` for an image or a volume, which has places alone.
    health: Option<Health>,
    levels: ResolvedLevels,
    /// Levels of a file that has an octree, or the error if they are damaged; reading the points does not need them.
    octree: Option<Result<CloudLevels, ReadError>>,
    detail: Option<Detail>,
    /// Levels of subdivision, if the mesh has any.
    hierarchy: Option<Hierarchy>,
}

pub(crate) fn run(args: &InfoArgs, global: &Global<'_>) -> Result<(), CliError> {
    detail::check(args)?;
    let facts = gather(args, global)?;
    print(global, &facts.text(), &facts.json())
}

fn gather(args: &InfoArgs, global: &Global<'_>) -> Result<ShapeFacts, CliError> {
    if !args.needs_detail() {
        global.given.refuse(&["--accuracy"], "applies to bands, which --detail and --error compute")?;
    }
    let params = check_levels(&args.levels)?;
    let input = with_given_walk(load_shape(&args.shape, global)?, &args.walk, global)?;
    input.check_lengths(&args.given_lengths())?;
    let operator = operator_for_levels(&args.shape.operator, &args.levels)?;
    let decomposer = prepare(global, &input, &operator)?;
    let health = (!input.file.carries_values()).then(|| decomposer.health());
    let levels = resolve_levels(&args.levels, &decomposer, global)?;
    let detail = if args.needs_detail() {
        let measured = detail::measure(&input, &decomposer, &levels.schedule, &params, global)?;
        Some(measured.with_question(args, &input, health.as_ref(), global))
    } else {
        None
    };
    let octree = octree(&input, global);
    let hierarchy = find_hierarchy(&input, &decomposer, global)?;
    Ok(ShapeFacts { input, decomposer, health, levels, octree, detail, hierarchy })
}

/// The levels of subdivision of a mesh.
fn find_hierarchy(
    input: &Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Option<Hierarchy>, CliError> {
    if !input.shape.is_mesh() {
        return Ok(None);
    }
    let Some(geometry) = decomposer.geometry() else { return Ok(None) };
    let found = with_progress(global, "finding levels", |progress| {
        let params = QuadParams { points: Some(geometry.points()), ..QuadParams::default() };
        Hierarchy::from_faces(geometry.n_vertices(), geometry.faces(), &params, progress)
    });
    match found {
        Ok(hierarchy) => Ok(Some(hierarchy)),
        Err(SubdivisionError::Cancelled(_)) => Err(CliError::Cancelled),
        Err(_) => Ok(None),
    }
}

/// Number of levels of subdivision, and of the vertices on the finest and on the coarsest.
fn hierarchy_text(hierarchy: &Hierarchy) -> String {
    let n_levels = hierarchy.n_levels();
    let mut text = format!(
        "{}, {} → {} vertices",
        count(n_levels, "level", "levels"),
        hierarchy.n_vertices(0),
        hierarchy.n_vertices(n_levels)
    );
    if hierarchy.is_of_quads() {
        text += " (Catmull-Clark)";
    }
    let parts = hierarchy.parts();
    if parts.iter().any(|part| part.is_ambiguous) {
        text += "; other coarse vertices are possible, and the positions chose";
    }
    let n_fewer = parts.iter().filter(|part| part.n_levels < n_levels).count();
    if n_fewer > 0 {
        let fewer = if n_fewer == 1 {
            "1 has fewer levels".to_owned()
        } else {
            format!("{n_fewer} have fewer levels")
        };
        text += &format!("; of {} parts {fewer}", parts.len());
    }
    text
}

impl ShapeFacts {
    fn format_name(&self) -> String {
        self.input.file.format().map_or_else(|| "sample".to_owned(), |f| f.to_string())
    }

    fn graph_changes(&self) -> Option<GraphChanges> {
        self.input.shape.is_graph().then(|| self.input.file.graph_changes())
    }

    /// Widths σ_0 … σ_J.
    fn sigma(&self) -> Vec<f64> {
        self.levels.schedule.sigma(self.decomposer.operator().step_length())
    }

    fn text(&self) -> String {
        let Self { input, decomposer, health, .. } = self;
        let diagonal = decomposer.extent();
        let mut text = format!("{}: {}, {}\n", input.name, input.kind_name(), self.format_name());
        if let Some(grid) = input.file.grid() {
            text += &grid_lines(grid);
        }
        if let Some(brain) = input.file.brain() {
            text += &brain_lines(brain);
        }
        if let Some(health) = health {
            health_lines(&mut text, &input.shape, health);
        }
        if let Some(bounds) = input.shape.points().and_then(bounding_box) {
            let _ = writeln!(text, "  bounding box  {}", bounds_text(&bounds, diagonal));
        }
        if let Some(unit) = input.file.length_unit() {
            let _ = writeln!(text, "  unit          {unit}");
        }
        if let Some(system) = input.file.coordinate_system() {
            let _ = writeln!(text, "  coordinates   {} ({})", system.name, system.kind.name());
        }
        if diagonal > 0.0 {
            let _ = writeln!(text, "  diagonal      {}", number(decomposer.diagonal()));
            let what = match input.file.grid() {
                Some(_) => "the diagonal of the places with data",
                None => "the diagonal of the largest part, without strays",
            };
            let refer = "default levels and % refer to it";
            let _ = writeln!(text, "  extent        {}, {what}; {refer}", number(diagonal));
        }
        if let Some(octree) = &self.octree {
            let _ = writeln!(text, "  octree        {}", octree_text(octree));
        }
        if let Some(curve) = CurveFacts::new(decomposer) {
            text += &curve.text();
        }
        if let Some(hierarchy) = &self.hierarchy {
            let _ = writeln!(text, "  subdivision   {}", hierarchy_text(hierarchy));
        }
        if let Some(health) = health {
            health_notes(&mut text, health);
        }
        if self.graph_changes().is_some_and(|changes| changes.n_asymmetric > 0) {
            text += "  weights       (M + Mᵀ)/2, since the matrix M is not symmetric and the walk needs symmetric weights\n";
        }
        text += &input.file.provenance().map_or_else(String::new, provenance_text);
        let describe = |f: &Field| match f.frame_step {
            Some(step) => format!("{} ({} frames, one every {} s)", f.name, f.n_channels, number(step)),
            None => format!("{} ({})", f.name, f.n_channels),
        };
        let face_fields = input.file.face_fields();
        if !face_fields.is_empty() {
            let names = face_fields.iter().map(describe).collect::<Vec<_>>();
            let _ = writeln!(text, "  face fields   {}", names.join(", "));
        }
        let fields = input.file.vertex_fields();
        if !fields.is_empty() {
            let names = fields.iter().map(describe).collect::<Vec<_>>();
            let _ = writeln!(text, "  fields        {}", names.join(", "));
        }
        text += &diffusion_text(decomposer, &input.shape);
        let _ = writeln!(text, "  levels        {}\n", self.levels.reason);
        text += &self.level_table();
        text += &self.detail.as_ref().map_or_else(String::new, Detail::text);
        text
    }

    fn level_table(&self) -> String {
        let (schedule, sigma, diagonal) = (&self.levels.schedule, self.sigma(), self.decomposer.extent());
        table(
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
        )
    }

    fn json(&self) -> Value {
        let Self { input, decomposer, health, .. } = self;
        let (sigma, diagonal) = (self.sigma(), decomposer.extent());
        let fields = input.file.vertex_fields();
        json!({
            "shape": input.name,
            "kind": input.kind_name(),
            "format": self.format_name(),
            "fields": fields.iter().map(field_json).collect::<Vec<_>>(),
            "face_fields": input.file.face_fields().iter().map(|f| json!({"name": f.name, "channels": f.n_channels})).collect::<Vec<_>>(),
            "unit": input.file.length_unit().map(LengthUnit::name),
            "unit_in_meters": input.file.length_unit().and_then(LengthUnit::meters),
            "coordinate_system": input.file.coordinate_system().map(|system| json!({
                "name": system.name, "kind": system.kind.name(),
            })),
            "provenance": input.file.provenance().map(provenance_json),
            "grid": input.file.grid().map(grid_json),
            "parts": input.file.brain().map(parts_json),
            "bounding_box": bounds_json(input.shape.points().and_then(bounding_box)),
            "diagonal": decomposer.diagonal(),
            "extent": diagonal,
            "outsiders": outsiders_json(decomposer, input),
            "seams": decomposer.geometry().and_then(PreparedGeometry::seams),
            "given_normals": decomposer.geometry().and_then(PreparedGeometry::given_normals).map(|given| given_normals_json(&given.check)),
            "octree": self.octree.as_ref().and_then(|octree| octree.as_ref().ok()).map(|levels| json!({
                "spacing": levels.spacing, "points": levels.n_points,
            })),
            "made_symmetric": self.graph_changes().is_some_and(|changes| changes.n_asymmetric > 0),
            "dropped_loops": self.graph_changes().map(|changes| changes.n_loops),
            "asymmetric_pairs": self.graph_changes().map(|changes| changes.n_asymmetric),
            "health": health.as_ref().map(health_json),
            "curve": CurveFacts::new(decomposer).map(|curve| curve.json()),
            "subdivision": self.hierarchy.as_ref().map(|hierarchy| json!({
                "levels": hierarchy.n_levels(),
                "scheme": if hierarchy.is_of_quads() { "quadrilaterals" } else { "triangles" },
                "vertices": (0..=hierarchy.n_levels()).map(|k| hierarchy.n_vertices(k)).collect::<Vec<_>>(),
                "parts": hierarchy.parts().iter().map(|part| json!({
                    "vertices": part.n_vertices, "coarsest": part.n_coarsest, "levels": part.n_levels,
                    "ambiguous": part.is_ambiguous,
                })).collect::<Vec<_>>(),
            })),
            "diffusion": diffusion_json(decomposer, row_words(&input.file)[1]),
            "levels": self.levels.schedule.n_levels(),
            "levels_reason": self.levels.reason,
            "steps": steps_json(&self.levels.schedule.steps_from_zero()),
            "sigma": sigma,
            "fwhm": fwhm_json(&sigma, diagonal),
            "detail": self.detail.as_ref().map(Detail::json),
        })
    }
}

/// Lines on the axes of an image or a volume and on places without data.
fn grid_lines(grid: &GridLayout) -> String {
    let mut text = String::new();
    for ((name, size), spacing) in grid.axis_names.iter().zip(&grid.sizes).zip(&grid.spacings) {
        let length = number(*size as f64 * spacing);
        let places = count(*size, "place", "places");
        let _ = writeln!(text, "  {name:<13} {places}, {} apart, {length} in all", number(*spacing));
    }
    let (n_missing, n) = (grid.n_missing(), grid.n_places());
    if n_missing > 0 {
        let percent = number(100.0 * n_missing as f64 / n as f64);
        let _ = writeln!(
            text,
            "  without data  {n_missing} of {n} places, {percent} %; no step reaches or leaves them"
        );
    }
    text
}

fn grid_json(grid: &GridLayout) -> Value {
    json!({
        "axes": grid.axis_names,
        "sizes": grid.sizes,
        "spacings": grid.spacings,
        "origin": grid.origin,
        "steps": grid.steps,
        "without_data": grid.n_missing(),
    })
}

/// Length and kinds of vertices of a curve, or of a graph with positions.
struct CurveFacts {
    length: f64,
    n_ends: usize,
    n_branches: usize,
}

impl CurveFacts {
    fn new(decomposer: &Decomposer) -> Option<Self> {
        let geometry = decomposer.geometry()?;
        let graph = geometry.shape().as_graph()?;
        let length = curve_length(graph, graph.positions()?);
        let edges = geometry.curve_edges().unwrap_or(graph.adjacency());
        let n_with = |is_counted: fn(usize) -> bool| {
            (0..edges.n_rows()).filter(|&x| is_counted(edges.row(x).len())).count()
        };
        Some(Self { length, n_ends: n_with(|degree| degree == 1), n_branches: n_with(|degree| degree > 2) })
    }

    fn text(&self) -> String {
        let ends = count(self.n_ends, "end point", "end points");
        let branches = count(self.n_branches, "branch point", "branch points");
        format!("  length        {}, {ends}, {branches}\n", number(self.length))
    }

    fn json(&self) -> Value {
        json!({"length": self.length, "end_points": self.n_ends, "branch_points": self.n_branches})
    }
}

/// Number of rows of each role that take no part, and the first of these rows.
fn outsiders_json(decomposer: &Decomposer, input: &Input) -> Value {
    const MOST_ROWS: usize = 100;
    let outsiders = decomposer.geometry().map(PreparedGeometry::outsiders).unwrap_or_default();
    let of_role = |role: VertexRole| {
        let rows: Vec<usize> = outsiders
            .iter()
            .filter(|(_, own)| *own == role)
            .map(|(vertex, _)| input.file.file_row(*vertex))
            .collect();
        json!({"count": rows.len(), "first_rows": rows.iter().take(MOST_ROWS).collect::<Vec<_>>()})
    };
    json!({
        "placeholders": of_role(VertexRole::Placeholder),
        "strays": of_role(VertexRole::Stray),
        "unused": of_role(VertexRole::Unused),
    })
}

/// Lines on the diffusion operator.
/// A line for each part of a brain.
fn brain_lines(brain: &BrainLayout) -> String {
    let mut text = String::new();
    for part in &brain.parts {
        let places = match &part.places {
            BrainPlaces::Surface { n_vertices, .. } => format!("of {n_vertices} vertices"),
            _ => "voxels".to_owned(),
        };
        let _ = writeln!(text, "  part          {}, {} {places}", part.structure, part.rows.len());
    }
    text
}

fn parts_json(brain: &BrainLayout) -> Value {
    let part = |part: &BrainPart| {
        let n_vertices = match part.places {
            BrainPlaces::Surface { n_vertices, .. } => Some(n_vertices),
            _ => None,
        };
        json!({"structure": part.structure, "first": part.rows.start, "rows": part.rows.len(), "vertices": n_vertices})
    };
    brain.parts.iter().map(part).collect()
}

fn diffusion_text(decomposer: &Decomposer, shape: &Shape) -> String {
    let params = decomposer.operator_params();
    if decomposer.geometry().is_none() && matches!(decomposer.operator().semigroup(), Semigroup::Heat { .. })
    {
        let step = number(decomposer.operator().step_length());
        return format!("  diffusion     heat, spacing {}, step {step}\n", number(decomposer.mean_length()));
    }
    let mut text = format!(
        "  diffusion     {}{}{}, {}, mean edge {}, step {}\n",
        decomposer.operator_kind().name(),
        if params.density_invariant { ", density-invariant" } else { "" },
        if params.keep_creases { ", keeping creases" } else { "" },
        decomposer
            .n_entries()
            .map_or_else(|| "no stored entries".to_owned(), |n| count(n, "entry", "entries")),
        number(decomposer.mean_length()),
        number(decomposer.operator().step_length()),
    );
    if let Some(info) = decomposer.surface_info() {
        let _ = writeln!(text, "  surface       {}", surface_text(info, shape));
    }
    text
}

fn diffusion_json(decomposer: &Decomposer, rows: &str) -> Value {
    json!({
        "operator": decomposer.operator_kind().name(),
        "density_invariant": decomposer.operator_params().density_invariant,
        "keeps_creases": decomposer.operator_params().keep_creases,
        rows: decomposer.n_places(),
        "entries": decomposer.n_entries(),
        "mean_length": decomposer.mean_length(),
        "step_length": decomposer.operator().step_length(),
        "reversible": decomposer.operator().is_reversible(),
        "surface": decomposer.surface_info().map(|info| json!({
            "flips": info.laplacian.n_flips,
            "double_cover": info.laplacian.is_covered,
            "edges_lengthened_by": info.laplacian.lengthened,
            "mass_added": info.added_mass,
        })),
    })
}

/// The levels of the octree of a LAZ or EPT, if it has one.
fn octree(input: &Input, global: &Global<'_>) -> Option<Result<CloudLevels, ReadError>> {
    let has_file = matches!(input.file.format(), Some(Format::LAZ | Format::EPT)) && input.name != "-";
    has_file.then(|| cloud_levels(&to_path(&input.name), &global.limits).transpose()).flatten()
}

fn octree_text(octree: &Result<CloudLevels, ReadError>) -> String {
    match octree {
        Ok(levels) => {
            let n = levels.n_points.len();
            let finest = levels.spacing * 0.5_f64.powi(n.saturating_sub(1) as i32);
            let points = levels.n_points.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
            let levels_text = count(n, "level", "levels");
            format!(
                "{levels_text} of {points} points; spacing {} to {}",
                number(levels.spacing),
                number(finest)
            )
        }
        Err(error) => format!("not usable: {error}"),
    }
}

/// Changes to the surface that its operator needed.
fn surface_text(info: &SurfaceInfo, shape: &Shape) -> String {
    let mut changes = match shape {
        Shape::Mesh(_) => vec![format!("{} flipped", count(info.laplacian.n_flips, "edge", "edges"))],
        Shape::Cloud(_) => vec!["cells of the points in tangent planes".to_owned()],
        Shape::Graph(graph) if graph.is_curve() => vec!["heat by arc length".to_owned()],
        Shape::Graph(_) => return "degrees minus weights".to_owned(),
    };
    if info.laplacian.is_covered {
        changes.push("double cover".to_owned());
    }
    if info.laplacian.lengthened > 0.0 {
        changes.push(format!("edges lengthened by {}", number(info.laplacian.lengthened)));
    }
    changes.push(format!("{} % of mass added", number(100.0 * info.added_mass)));
    changes.join(", ")
}

/// Name and channels of a field, and seconds from one to the next if they are frames.
fn field_json(field: &Field) -> Value {
    let mut json = json!({"name": field.name, "channels": field.n_channels});
    if let Some(step) = field.frame_step {
        json["frame_step"] = json!(step);
    }
    json
}
