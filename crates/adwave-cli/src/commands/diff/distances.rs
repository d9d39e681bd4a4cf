//! Difference between two versions of a shape at each vertex.

use super::DiffArgs;
use super::args::ByArg;
use super::reach::Reach;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{count, note, number, shift};
use crate::resolve::operator::prepare;
use crate::resolve::shape::Input;
use crate::resolve::signal::file_normals;
use adwave::Decomposer;
use adwave::operator::OperatorParams;
use adwave::shape::{Mesh, PointCloud, PreparedGeometry, Shape, WeldMode, first_misplaced_vertex};
use adwave_register::{
    AlignParams, ClosestFit, ClosestPointSearch, Motion, Registrand, ShapeFeatures, SignedDistances, Signs,
    Summary, align, closest_fit, common_lengths, describe_shape, fit_in_place, signed_distances,
};
use adwave_report::page::Fact;
use serde_json::{Value, json};

/// Share of points with a closest point off the border below which a sentence reports it.
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
    let mut how = Vec::new();
    let by_vertex = match args.by {
        ByArg::Auto => match has_same_rows(first, second, decomposer, global)? {
            SameRows::Yes => {
                how.push(
                    "Both have the same vertices and faces in the same order: the difference is the vector from vertex to \
                     vertex (--by closest measures distances to closest points)."
                        .to_owned(),
                );
                true
            }
            SameRows::No => false,
            SameRows::Misplaced(vertex) => {
                let vertex = first.file.file_row(vertex);
                how.push(format!(
                    "Their faces have equal numbers, but vertex {vertex} meets other vertices in {} than in {}: the order differs, \
                     so closest points are compared (--by vertex compares by the order all the same).",
                    second.name, first.name
                ));
                false
            }
        },
        ByArg::Vertex if first.shape.n_vertices() == second.shape.n_vertices() => {
            how.push(
                "Vertices are compared by their order, as --by vertex asks: the difference is the vector from vertex to vertex."
                    .to_owned(),
            );
            true
        }
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
        vertex_differences(args, first, second, decomposer, how)
    } else {
        closest_differences(args, first, second, decomposer, how, global)
    }
}

/// Evidence on whether equal rows of two files are the same vertex.
enum SameRows {
    Yes,
    No,
    /// The faces name the same rows, but this vertex shows another order of the vertices.
    Misplaced(usize),
}

fn has_same_rows(
    first: &Input,
    second: &Input,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<SameRows, CliError> {
    let has_equal_faces =
        first.shape.n_vertices() == second.shape.n_vertices() && first.file.faces() == second.file.faces();
    if !has_equal_faces || first.file.faces().is_empty() {
        return Ok(SameRows::No);
    }
    let geometry = prepare_geometry(&second.shape, global)?;
    Ok(first_misplaced_vertex(decomposer.geometry_for("a difference")?, &geometry)
        .map_or(SameRows::Yes, SameRows::Misplaced))
}

/// Vectors from vertex to vertex.
fn vertex_differences(
    args: &DiffArgs,
    first: &Input,
    second: &mut Input,
    decomposer: &Decomposer,
    mut how: Vec<String>,
) -> Result<Difference, CliError> {
    let points = first.shape.points().unwrap_or_default();
    let areas = decomposer.areas();
    let mut motion = None;
    if args.align {
        let fitted = Motion::fit_robust(second.shape.points().unwrap_or_default(), points, &areas);
        let found = fitted.ok_or_else(|| {
            CliError::Input(
                "--align needs points that fix a rotation, and these do not (too few, or on a line)"
                    .to_owned(),
            )
        })?;
        how.push(moved_sentence(&second.name, &found, decomposer.extent()));
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
    mut how: Vec<String>,
    global: &Global<'_>,
) -> Result<Difference, CliError> {
    let (mut motion, mut alignment) = (None, None);
    if args.align {
        let found = fit(first, second, decomposer, global)?;
        how.push(moved_sentence(&second.name, &found.motion, decomposer.extent()));
        if let Some(doubt) = doubt(&found, [&first.name, &second.name]) {
            note(global, &doubt);
            how.push(doubt);
        }
        move_shape(second, &found.motion)?;
        motion = Some(found.motion);
        alignment = Some(found);
    }
    let geometry = prepare_geometry(&second.shape, global)?;
    let surface = surface(&geometry, &second.name, global)?;
    let own = decomposer.geometry_for("a distance")?;
    let (normals, others) = (file_normals(&first.file), file_normals(&second.file));
    // The normals of a file do not turn with its points, so those of a moved shape are not used.
    let others = others.as_deref().filter(|_| motion.is_none());
    let signs = Signs::choose([own, &geometry], [normals.as_deref(), others], global.progress())
        .map_err(|e| CliError::classify(&e))?;
    let limit = args.limit.map_or(f64::INFINITY, |limit| limit.to_model_units(decomposer.extent()));
    let distances = with_progress(global, "measuring", |progress| {
        signed_distances(own.points(), &signs, &surface, limit, progress)
    })
    .map_err(|_| CliError::Cancelled)?;
    let back = Reach::measure([&geometry, own], &first.name, limit, global)?;
    how.push(format!(
        "The difference at a vertex of {0} is its distance to the closest point of {1}, {2}.",
        first.name,
        second.name,
        match &signs {
            Signs::Own(_) => format!("positive where {} lies outside of {}", second.name, first.name),
            Signs::Other(sides) if sides.is_closed => {
                format!("positive inside of {0}, whose surface is then outside of the vertex", second.name)
            }
            Signs::Other(_) => {
                format!("positive on the inner side of {}, since {} has no outside", second.name, first.name)
            }
            Signs::Nothing => "without a sign, since neither has an inside; a closed surface has".to_owned(),
        }
    ));
    let values = decomposer.vertex_map().scatter(&distances.values, 1);
    if values.iter().all(|v| v.is_nan()) {
        return Err(CliError::Input(format!(
            "no vertex of {} has a closest point on {} off its borders and within the limit; try --align",
            first.name, second.name
        )));
    }
    let summary = Summary::new(&values, 1, &decomposer.areas());
    let summary = Summary { vertex: first.file.file_row(summary.vertex), ..summary };
    let there = if own.triangles().is_empty() {
        None
    } else {
        Some(Reach::measure([own, &geometry], &second.name, limit, global)?)
    };
    let comparison = ClosestComparison { summary, distances, there, back, is_signed: signs.is_signed() };
    let facts = comparison.facts([&first.name, &second.name]);
    let json = comparison.json(alignment.as_ref());
    Ok(Difference { n_channels: 1, values, how, facts, json, motion })
}

/// Distances to the closest points of another shape, and the greatest ones both ways.
struct ClosestComparison {
    summary: Summary,
    distances: SignedDistances,
    /// Distance from all points of the first shape; `None` for a cloud.
    there: Option<Reach>,
    /// Distance from all points of the second shape.
    back: Reach,
    is_signed: bool,
}

impl ClosestComparison {
    fn facts(&self, [first, second]: [&str; 2]) -> Vec<Fact> {
        let Summary { rms, mean, greatest, vertex } = self.summary;
        let mut facts = vec![
            fact("rms", number(rms), "root mean square by area"),
            fact("mean", number(mean), "by area"),
            fact("greatest", number(greatest), &format!("at vertex {vertex}")),
        ];
        if let Some(there) = &self.there {
            facts.push(fact("forward", number(there.greatest), &there.meaning([first, second])));
        }
        facts.extend(self.back.facts([second, first], "reverse"));
        let SignedDistances { n_beyond_border, n_too_far, .. } = self.distances;
        let without = n_beyond_border + n_too_far;
        if without > 0 {
            let meaning =
                format!("{n_beyond_border} lie beyond a border of {second}, {n_too_far} beyond the limit");
            let of = count(self.distances.values.len(), "vertex", "vertices");
            facts.push(fact("no value", format!("{without} of {of}"), &meaning));
        }
        facts
    }

    fn json(&self, alignment: Option<&Alignment>) -> Value {
        let alignment = alignment.map(|found| {
            let mut own = json!({
                "certain": found.is_certain && found.n_equal == 0, "equal_motions": found.n_equal,
                "overlap": found.overlap,
            });
            // There is none if no point lies over the other shape.
            if found.median.is_finite() {
                own["median_distance"] = json!(found.median);
            }
            own
        });
        let Summary { rms, mean, greatest, vertex } = self.summary;
        let mut json = json!({
            "alignment": alignment, "rms": rms, "mean": mean, "greatest": greatest, "vertex": vertex,
            "greatest_back": self.back.greatest, "beyond_border": self.distances.n_beyond_border,
            "too_far": self.distances.n_too_far, "back": self.back.json(), "signed": self.is_signed,
        });
        if let Some(there) = &self.there {
            json["greatest_there"] = json!(there.greatest);
            json["there"] = there.json();
        }
        json
    }
}

pub(super) fn fact(name: &str, value: String, meaning: &str) -> Fact {
    Fact { name: name.to_owned(), value, meaning: meaning.to_owned() }
}

fn moved_sentence(name: &str, motion: &Motion, size: f64) -> String {
    format!(
        "{name} was rotated by {:.3}° and translated by ({}) to fit.",
        motion.degrees(),
        shift(motion.translation(), size)
    )
}

fn prepare_geometry(shape: &Shape, global: &Global<'_>) -> Result<PreparedGeometry, CliError> {
    PreparedGeometry::new(shape, WeldMode::default(), global.progress()).map_err(|_| CliError::Cancelled)
}

pub(super) fn surface(
    geometry: &PreparedGeometry,
    name: &str,
    global: &Global<'_>,
) -> Result<ClosestPointSearch, CliError> {
    ClosestPointSearch::new(geometry, global.progress())
        .map_err(|_| CliError::Cancelled)?
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

/// Motion that aligns the second shape with the first: from where it is, or, if parts then remain apart, the best of
/// those from features and from a grid of rotations.
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
            describe_shape(decomposers[k], normals.as_deref(), &lengths, None, progress)
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
