//! Difference between two versions of a shape at each vertex.

use super::DiffArgs;
use super::args::ByArg;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, note, number};
use crate::resolve::operator::prepare;
use crate::resolve::shape::Input;
use crate::resolve::signal::file_normals;
use adwave::Decomposer;
use adwave::operator::OperatorParams;
use adwave::shape::{Mesh, PointCloud, PreparedGeometry, Shape, WeldMode};
use adwave::signal::outward_normals;
use adwave_register::{
    AlignInfo, AlignParams, Consensus, ConsensusParams, Motion, SignedDistances, Summary, Surface, align,
    common_lengths, consensus, describe_shape, signed_distances,
};
use adwave_report::page::Fact;
use serde_json::{Value, json};

/// Median distance of a fit, as a share of the diagonal, beyond which the fit starts again from features.
const POOR: f64 = 0.005;
/// Share of points with a closest point off the border below which the fit starts again from features.
const LEAST_OVERLAP: f64 = 0.3;

/// Difference at the vertices of the first shape, in its order; NaN where there is none.
pub(super) struct Difference {
    /// 3 for vectors from vertex to vertex, 1 for signed distances.
    pub(super) n_channels: usize,
    pub(super) values: Vec<f64>,
    /// Sentences on how the two were compared.
    pub(super) how: Vec<String>,
    pub(super) facts: Vec<Fact>,
    pub(super) json: Value,
    /// Motion of the second shape.
    pub(super) motion: Option<Motion>,
}

/// Difference of two shapes; `second` is moved if --align asks for it.
pub(super) fn difference(
    args: &DiffArgs,
    first: &Input,
    second: &mut Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Difference, CliError> {
    for input in [first, &*second] {
        if input.shape.points().is_none_or(<[_]>::is_empty) {
            return Err(CliError::Input(format!("{}: the shape has no positions to compare", input.name)));
        }
    }
    let same =
        first.shape.n_vertices() == second.shape.n_vertices() && first.file.faces() == second.file.faces();
    let by_vertex = match args.by {
        ByArg::Auto => same && (!first.file.faces().is_empty()),
        ByArg::Vertex if first.shape.n_vertices() == second.shape.n_vertices() => true,
        ByArg::Vertex => {
            return Err(CliError::Input(format!(
                "--by vertex needs equal numbers of vertices, but {} has {} and {} has {}; leave out --by",
                first.name,
                first.shape.n_vertices(),
                second.name,
                second.shape.n_vertices()
            )));
        }
        ByArg::Closest => false,
    };
    if by_vertex {
        vertex_differences(args, first, second, decomposer)
    } else {
        closest_differences(args, first, second, decomposer, global)
    }
}

/// Vectors from vertex to vertex.
fn vertex_differences(
    args: &DiffArgs,
    first: &Input,
    second: &mut Input,
    decomposer: &Decomposer,
) -> Result<Difference, CliError> {
    let points = first.shape.points().unwrap_or_default();
    let areas = decomposer.areas();
    let mut how =
        vec!["Both have the same vertices: the difference is the vector from vertex to vertex.".to_owned()];
    let mut motion = None;
    if args.align {
        let fitted = Motion::fit_robust(second.shape.points().unwrap_or_default(), points, &areas);
        let found = fitted.ok_or_else(|| {
            CliError::Input(
                "--align needs points that fix a rotation, and these do not (too few, or on a line)"
                    .to_owned(),
            )
        })?;
        how.push(moved_sentence(&second.name, &found));
        move_shape(second, &found)?;
        motion = Some(found);
    }
    let others = second.shape.points().unwrap_or_default();
    let values: Vec<f64> =
        points.iter().zip(others).flat_map(|(p, q)| [0, 1, 2].map(|c| q[c] - p[c])).collect();
    let Summary { rms, greatest, vertex, .. } = Summary::new(&values, 3, &areas);
    let vertex = first.file.file_row(vertex);
    let facts = vec![
        fact("rms", number(rms), "root mean square of the distances, by area"),
        fact("greatest", number(greatest), &format!("at vertex {vertex}")),
    ];
    let json = json!({"rms": rms, "greatest": greatest, "vertex": vertex});
    Ok(Difference { n_channels: 3, values, how, facts, json, motion })
}

/// Signed distances to the closest points.
fn closest_differences(
    args: &DiffArgs,
    first: &Input,
    second: &mut Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Difference, CliError> {
    let mut how = Vec::new();
    let mut motion = None;
    if args.align {
        let (found, info) = fit(first, second, decomposer, global)?;
        how.push(moved_sentence(&second.name, &found));
        if info.overlap < LEAST_OVERLAP || info.median.is_nan() {
            note(
                global,
                &format!("only {:.0} % of {} lie over {}", 100.0 * info.overlap, second.name, first.name),
            );
        }
        move_shape(second, &found)?;
        motion = Some(found);
    }
    let geometry = prepare_geometry(&second.shape, global)?;
    let surface = surface(&geometry, &second.name)?;
    let normals = file_normals(&first.file);
    let outward = outward_normals(decomposer.geometry(), normals.as_deref(), global.progress())
        .map_err(|e| CliError::classify(&e))?;
    let limit = args.limit.map_or(f64::INFINITY, |limit| limit.to_model_units(decomposer.extent()));
    let measured = |points: &[[f64; 3]], normals: &[[f64; 3]], surface: &Surface| {
        with_progress(global, "measuring", |progress| {
            signed_distances(points, normals, surface, limit, progress)
        })
        .map_err(|_| CliError::Cancelled)
    };
    let there = measured(decomposer.geometry().points(), &outward.normals, &surface)?;
    let own = self::surface(decomposer.geometry(), &first.name)?;
    let back = measured(geometry.points(), &vec![[0.0; 3]; geometry.points().len()], &own)?;
    how.push(format!(
        "The difference at a vertex of {} is its distance to the closest point of {}, {}.",
        first.name,
        second.name,
        if outward.info.has_outside() {
            "positive where that lies outside"
        } else {
            "without a sign, since neither side is outside"
        }
    ));
    let magnitude = |values: &[f64]| values.iter().map(|v| v.abs()).collect();
    let values = if outward.info.has_outside() { there.values.clone() } else { magnitude(&there.values) };
    let values = decomposer.geometry().vertex_map().scatter(&values, 1);
    if values.iter().all(|v| v.is_nan()) {
        return Err(CliError::Input(format!(
            "no vertex of {} has a closest point on {} off its borders and within the limit; try --align",
            first.name, second.name
        )));
    }
    let summary = Summary::new(&values, 1, &decomposer.areas());
    let summary = Summary { vertex: first.file.file_row(summary.vertex), ..summary };
    let greatest_back = Summary::new(&back.values, 1, &vec![1.0; back.values.len()]).greatest;
    let json = json!({
        "rms": summary.rms, "mean": summary.mean, "greatest": summary.greatest, "vertex": summary.vertex,
        "greatest_back": greatest_back, "beyond_border": there.n_beyond_border, "too_far": there.n_too_far,
        "signed": outward.info.has_outside(),
    });
    let facts = closest_facts([&first.name, &second.name], &summary, greatest_back, &there);
    Ok(Difference { n_channels: 1, values, how, facts, json, motion })
}

/// Facts on signed distances.
fn closest_facts(
    [first, second]: [&str; 2],
    summary: &Summary,
    greatest_back: f64,
    there: &SignedDistances,
) -> Vec<Fact> {
    let mut facts = vec![
        fact("rms", number(summary.rms), "root mean square by area"),
        fact("mean", number(summary.mean), "by area"),
        fact("greatest", number(summary.greatest), &format!("at vertex {}", summary.vertex)),
        fact("reverse", number(greatest_back), &format!("greatest distance from {second} to {first}")),
    ];
    let without = there.n_beyond_border + there.n_too_far;
    if without > 0 {
        let meaning = format!(
            "{} lie beyond a border of {second}, {} beyond the limit",
            there.n_beyond_border, there.n_too_far
        );
        facts.push(fact(
            "no value",
            format!("{without} of {}", count(there.values.len(), "vertex", "vertices")),
            &meaning,
        ));
    }
    facts
}

fn fact(name: &str, value: String, meaning: &str) -> Fact {
    Fact { name: name.to_owned(), value, meaning: meaning.to_owned() }
}

fn moved_sentence(name: &str, motion: &Motion) -> String {
    format!(
        "{name} was rotated by {:.3}° and translated by ({}) to fit.",
        motion.degrees(),
        motion.translation().map(number).join(", ")
    )
}

fn prepare_geometry(shape: &Shape, global: &Global<'_>) -> Result<PreparedGeometry, CliError> {
    PreparedGeometry::new(shape, WeldMode::default(), global.progress()).map_err(|_| CliError::Cancelled)
}

fn surface(geometry: &PreparedGeometry, name: &str) -> Result<Surface, CliError> {
    Surface::new(geometry).ok_or_else(|| CliError::Input(format!("{name}: the shape has no points")))
}

/// Motion that aligns the second shape with the first, starting from where it is, or from features if that fit is poor.
fn fit(
    first: &Input,
    second: &Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<(Motion, AlignInfo), CliError> {
    let (geometry, target) =
        (prepare_geometry(&second.shape, global)?, surface(decomposer.geometry(), &first.name)?);
    let from = |start: Motion| {
        with_progress(global, "fitting", |progress| {
            align(geometry.points(), &target, start, &AlignParams::default(), progress)
        })
        .map_err(|_| CliError::Cancelled)
    };
    let direct = from(Motion::default())?;
    let is_poor = |info: &AlignInfo| {
        info.median.is_nan() || info.median > POOR * decomposer.extent() || info.overlap < LEAST_OVERLAP
    };
    if !is_poor(&direct.1) {
        return Ok(direct);
    }
    let Some(start) = motion_from_features(first, second, decomposer, global)? else { return Ok(direct) };
    let fitted = from(start)?;
    let is_better = direct.1.median.is_nan() || fitted.1.median < direct.1.median;
    Ok(if is_better { fitted } else { direct })
}

/// Motion that the features of both shapes agree on.
fn motion_from_features(
    first: &Input,
    second: &Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Option<Motion>, CliError> {
    let params: &OperatorParams = decomposer.operator_params();
    let other = prepare(global, second, params)?;
    let Ok(lengths) = common_lengths(&other, decomposer) else { return Ok(None) };
    let features_of = |input: &Input, decomposer: &Decomposer| {
        with_progress(global, "finding features", |progress| {
            describe_shape(decomposer, file_normals(&input.file).as_deref(), &lengths, 1.0, progress)
        })
        .map_err(|e| CliError::classify(&e))
    };
    let (a, b) = (features_of(second, &other)?, features_of(first, decomposer)?);
    let found = with_progress(global, "matching", |progress| {
        consensus(&a, &b, &ConsensusParams::default(), progress)
    })
    .map_err(|_| CliError::Cancelled)?;
    Ok(found.filter(Consensus::is_clear).map(|found| found.motion))
}

/// Moves the points of a shape.
fn move_shape(input: &mut Input, motion: &Motion) -> Result<(), CliError> {
    let points: Vec<[f64; 3]> =
        input.shape.points().unwrap_or_default().iter().map(|p| motion.apply(p)).collect();
    let moved = match &input.shape {
        Shape::Mesh(mesh) => Mesh::new(points, mesh.faces().clone()).map(Shape::Mesh),
        _ => PointCloud::new(points).map(Shape::Cloud),
    };
    input.shape = moved.map_err(CliError::input)?;
    Ok(())
}
