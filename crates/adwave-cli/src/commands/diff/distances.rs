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
use adwave_register::{
    AlignParams, ClosestFit, ClosestPointSearch, Motion, Registrand, ShapeFeatures, SignedDistances, Summary,
    align, closest_fit, common_lengths, describe_shape, fit_in_place, signed_distances,
};
use adwave_report::page::Fact;
use serde_json::{Value, json};

/// Share of points with a closest point off the border below which that is said.
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
        global.given.refuse(
            &["--limit"],
            "applies to closest points, and the shapes are compared vertex by vertex (--by closest)",
        )?;
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
    let (mut motion, mut alignment) = (None, None);
    if args.align {
        let found = fit(first, second, decomposer, global)?;
        how.push(moved_sentence(&second.name, &found.motion));
        if let Some(doubt) = doubt(&found, [&first.name, &second.name]) {
            note(global, &doubt);
            how.push(doubt);
        }
        move_shape(second, &found.motion)?;
        motion = Some(found.motion);
        alignment = Some(found);
    }
    let geometry = prepare_geometry(&second.shape, global)?;
    let surface = surface(&geometry, &second.name)?;
    let normals = file_normals(&first.file);
    let outward = decomposer
        .outward_normals(normals.as_deref(), global.progress())
        .map_err(|e| CliError::classify(&e))?;
    let limit = args.limit.map_or(f64::INFINITY, |limit| limit.to_model_units(decomposer.extent()));
    let measured = |points: &[[f64; 3]], normals: &[[f64; 3]], surface: &ClosestPointSearch| {
        with_progress(global, "measuring", |progress| {
            signed_distances(points, normals, surface, limit, progress)
        })
        .map_err(|_| CliError::Cancelled)
    };
    let there = measured(decomposer.positions(), &outward.normals, &surface)?;
    let own = self::surface(decomposer.geometry_for("a distance")?, &first.name)?;
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
    let values = decomposer.vertex_map().scatter(&values, 1);
    if values.iter().all(|v| v.is_nan()) {
        return Err(CliError::Input(format!(
            "no vertex of {} has a closest point on {} off its borders and within the limit; try --align",
            first.name, second.name
        )));
    }
    let summary = Summary::new(&values, 1, &decomposer.areas());
    let summary = Summary { vertex: first.file.file_row(summary.vertex), ..summary };
    let greatest_back = Summary::new(&back.values, 1, &vec![1.0; back.values.len()]).greatest;
    let alignment = alignment.map(|found| {
        json!({
            "certain": found.is_certain && found.n_equal == 0, "equal_motions": found.n_equal,
            "median_distance": found.median, "overlap": found.overlap,
        })
    });
    let json = json!({
        "alignment": alignment, "rms": summary.rms, "mean": summary.mean, "greatest": summary.greatest, "vertex": summary.vertex,
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

fn surface(geometry: &PreparedGeometry, name: &str) -> Result<ClosestPointSearch, CliError> {
    ClosestPointSearch::new(geometry)
        .ok_or_else(|| CliError::Input(format!("{name}: the shape has no points")))
}

/// Alignment of the second shape with the first.
struct Alignment {
    motion: Motion,
    /// Share of the second shape that has a partner.
    overlap: f64,
    median: f64,
    is_certain: bool,
    /// Number of other motions that fit equally well.
    n_equal: usize,
}

/// Motion that aligns the second shape with the first: from where it is, or, if parts then remain apart, the best of those
/// from features and from a grid of rotations.
fn fit(
    first: &Input,
    second: &Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<Alignment, CliError> {
    let params: &OperatorParams = decomposer.operator_params();
    let other = prepare(global, second, params)?;
    let plain = |input: &Input, decomposer: &Decomposer| {
        let normals = file_normals(&input.file);
        let outward = decomposer
            .outward_normals(normals.as_deref(), global.progress())
            .map_err(|e| CliError::classify(&e))?;
        registrand(input, decomposer, ShapeFeatures::without_features(outward), global)
    };
    let (moving, target) = (plain(second, &other)?, plain(first, decomposer)?);
    let in_place = with_progress(global, "fitting", |progress| fit_in_place(&moving, &target, progress))
        .map_err(|_| CliError::Cancelled)?;
    let found = match in_place {
        Some(found) => Some(found),
        None => fit_from_anywhere([second, first], [&other, decomposer], global)?,
    };
    let found = found.ok_or_else(|| {
        CliError::Input(format!(
            "--align found no motion between {} and {}; leave it out, or move one near the other first",
            second.name, first.name
        ))
    })?;
    let points = other.positions();
    let (motion, info) = with_progress(global, "fitting", |progress| {
        align(points, &target.surface, found.motion, &AlignParams::default(), progress)
    })
    .map_err(|_| CliError::Cancelled)?;
    Ok(Alignment {
        motion,
        overlap: info.overlap,
        median: info.median,
        is_certain: found.is_certain,
        n_equal: found.n_equal,
    })
}

/// Best motion of the first of two shapes to the second, from features and from a grid of rotations.
fn fit_from_anywhere(
    inputs: [&Input; 2],
    decomposers: [&Decomposer; 2],
    global: &Global<'_>,
) -> Result<Option<ClosestFit>, CliError> {
    let lengths = common_lengths(decomposers[0], decomposers[1]).map_err(|e| CliError::classify(&e))?;
    let described = |k: usize| {
        let normals = file_normals(&inputs[k].file);
        let features = with_progress(global, "finding features", |progress| {
            describe_shape(decomposers[k], normals.as_deref(), &lengths, 1.0, progress)
        })
        .map_err(|e| CliError::classify(&e))?;
        registrand(inputs[k], decomposers[k], features, global)
    };
    let (moving, target) = (described(0)?, described(1)?);
    with_progress(global, "matching", |progress| closest_fit(&moving, &target, progress))
        .map_err(|_| CliError::Cancelled)
}

fn registrand(
    input: &Input,
    decomposer: &Decomposer,
    features: ShapeFeatures,
    global: &Global<'_>,
) -> Result<Registrand, CliError> {
    Registrand::new(decomposer, features, global.progress())
        .map_err(|_| CliError::Cancelled)?
        .ok_or_else(|| CliError::Input(format!("{}: the shape has no points", input.name)))
}

/// Sentence on how certain an alignment is; `None` if nothing speaks against it.
fn doubt(alignment: &Alignment, names: [&str; 2]) -> Option<String> {
    let [first, second] = names;
    if !alignment.is_certain {
        Some(format!(
            "the alignment is not certain: {second} differs from {first} in many places after the best motion, and no features agree on \
             another; look at the result with -o FILE.html"
        ))
    } else if alignment.n_equal > 0 {
        Some(format!(
            "the alignment is not certain: {} equally well",
            count(alignment.n_equal, "other motion fits", "other motions fit")
        ))
    } else if alignment.overlap < LEAST_OVERLAP || alignment.median.is_nan() {
        Some(format!("only {:.0} % of {second} lie over {first}", 100.0 * alignment.overlap))
    } else {
        None
    }
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
