//! `adwave match`: the motion between two shapes, and pairs of their features.

mod args;
mod picture;
mod thinning;

use crate::args::ShapeArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::{
    check_writable, count, has_extension, number, output_format, print, shift, table, without_gzip,
    write_file, write_shape,
};
use crate::resolve::applicable::check_shape_options;
use crate::resolve::operator::{build_decomposer, check_operator, operator_for_task, prepare};
use crate::resolve::shape::{Input, load_one_of_two, move_points};
use crate::resolve::signal::file_normals;
use adwave::Decomposer;
use adwave::operator::OperatorTask;
use adwave_io::MovedNormals;
use adwave_register::{
    DEFAULT_THETA, Motion, Pair, RegisteredMotion, Registrand, Registration, SearchParams, ShapeFeatures,
    common_lengths, describe_shape, descriptor_pairs, register,
};
use adwave_report::Table;
pub(crate) use args::MatchArgs;
use args::MotionArg;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use thinning::WholeCloud;

/// Most pairs that are printed.
const MAX_PRINTED: usize = 20;

/// Most equal motions that are printed.
const MAX_EQUAL: usize = 8;
/// Ratio of two diagonals beyond which the units are likely to differ.
const UNIT_RATIO: f64 = 1.7;

/// One of the two shapes.
struct Side {
    /// The shape, or the points of a large cloud that are searched for features.
    input: Input,
    /// The large cloud.
    whole: Option<WholeCloud>,
    decomposer: Decomposer,
    registrand: Registrand,
}

impl Side {
    fn features(&self) -> &ShapeFeatures {
        &self.registrand.features
    }

    fn n_vertices(&self) -> usize {
        self.whole.as_ref().map_or(self.decomposer.n_vertices(), WholeCloud::n_vertices)
    }
}

/// The motion between two shapes, and the pairs of their features.
struct Matching {
    /// The motions that were found; `None` if features are paired without a motion.
    registration: Option<Registration>,
    pairs: Vec<Pair>,
}

impl Matching {
    fn motion(&self) -> Option<&RegisteredMotion> {
        self.registration.as_ref().and_then(Registration::clear)
    }

    /// Other motions that fit equally well.
    fn equal(&self) -> &[RegisteredMotion] {
        self.registration.as_ref().map_or(&[], |registration| &registration.equal)
    }
}

pub(crate) fn run(args: &MatchArgs, global: &Global<'_>) -> Result<(), CliError> {
    check(args, global)?;
    let [mut first, mut second] = sides(args, global)?;
    let found = find(args, &first, &second, global)?;
    for side in [&mut first, &mut second] {
        for feature in &mut side.registrand.features.features {
            feature.vertex = side.input.file.file_row(feature.vertex);
        }
    }
    let mut text = describe(args, &first, &second, &found);
    if let Some(path) = &args.output {
        write_pairs(path, &first, &second, &found, global)?;
        let _ = writeln!(text, "{}", path.display());
    }
    if let Some(path) = &args.moved {
        let Some(RegisteredMotion { motion, .. }) = found.motion() else {
            return Err(CliError::Input("no motion was found that --moved could apply to SHAPE".to_owned()));
        };
        let mut file = first.whole.as_ref().map_or(&first.input.file, |whole| &whole.file).clone();
        let points = file.points().iter().map(|p| motion.apply(p)).collect();
        move_points(&mut file, points, MovedNormals::Follow, global)?;
        write_shape(global, &file, path)?;
        let _ = writeln!(text, "{}", path.display());
    }
    if let Some(path) = &args.picture {
        with_spinner(global, "drawing", || picture::write(path, args, [&first, &second], &found, global))?;
        let _ = writeln!(text, "{}", path.display());
    }
    let mut json = report(&first, &second, &found);
    json["output"] = json!(args.output.as_ref().map(|path| path.display().to_string()));
    print(global, &text, &json)
}

/// Refuses arguments that are invalid for all shapes, before anything is read.
fn check(args: &MatchArgs, global: &Global<'_>) -> Result<(), CliError> {
    if let Some(path) =
        args.output.as_deref().filter(|path| !has_extension(&without_gzip(path), &["csv", "json"]))
    {
        return Err(CliError::Input(format!(
            "{}: pairs are written as .csv or .json; --moved FILE writes the first shape, moved onto the second",
            path.display()
        )));
    }
    if let Some(path) = args.picture.as_deref().filter(|path| !has_extension(path, &["png"])) {
        return Err(CliError::Input(format!("{}: a picture is written as .png", path.display())));
    }
    if let Some(path) = &args.moved {
        output_format(path)?;
    }
    for path in [&args.output, &args.picture, &args.moved].into_iter().flatten() {
        check_writable(path)?;
    }
    if args.picture.is_none() {
        global.given.refuse(&["--view", "--up"], "applies to the picture (--picture)")?;
    }
    if args.motion == MotionArg::None {
        global.given.refuse(&["--within"], "applies to motions, and --motion is none")?;
        global.given.refuse(&["--moved"], "applies to motions, and --motion is none")?;
    } else {
        global.given.refuse(&["--ratio"], "applies to --motion none")?;
    }
    for (name, value) in
        [("--within", args.within), ("--theta", args.theta.unwrap_or(DEFAULT_THETA)), ("--ratio", args.ratio)]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(CliError::Input(format!("{name} must be a number above 0, got {value}")));
        }
    }
    Ok(())
}

fn sides(args: &MatchArgs, global: &Global<'_>) -> Result<[Side; 2], CliError> {
    let shapes = [args.shape.clone(), ShapeArgs { shape: args.other.clone(), ..args.shape.clone() }];
    let operator = operator_for_task(&args.shape.operator, OperatorTask::Comparison)?;
    let mut inputs = Vec::new();
    for shape in &shapes {
        let input = load_one_of_two(shape, global)?;
        inputs.push(input);
    }
    check_shape_options(&inputs.iter().collect::<Vec<_>>(), global)?;
    if !inputs.iter().any(|input| input.shape.is_cloud()) {
        global.given.refuse(&["--search-points"], "applies to clouds, and neither shape is one")?;
    }
    let mut prepared = Vec::new();
    for input in inputs {
        let (input, whole) = thinning::split(input, args.search_points.get(), &operator, global)?;
        let decomposer = match whole {
            // Notes on its points were printed for the whole cloud.
            Some(_) => {
                check_operator(&input.shape, &operator, global)?;
                with_progress(global, "preparing", |progress| build_decomposer(&input, &operator, progress))?
            }
            None => prepare(global, &input, &operator)?,
        };
        let lengths = common_lengths(&decomposer, &decomposer)
            .map_err(|e| CliError::Input(format!("{}: {e}", input.name)))?;
        prepared.push((input, whole, decomposer, lengths));
    }
    if args.motion == MotionArg::Rigid {
        let both = common_lengths(&prepared[0].2, &prepared[1].2).map_err(|e| CliError::classify(&e))?;
        for (.., lengths) in &mut prepared {
            lengths.clone_from(&both);
        }
    }
    let mut sides = Vec::new();
    for (input, whole, decomposer, lengths) in prepared {
        let normals = file_normals(&input.file);
        let described = with_progress(global, "finding features", |progress| {
            describe_shape(&decomposer, normals.as_deref(), &lengths, args.theta, progress)
        })
        .map_err(|e| CliError::classify(&e))?;
        let registrand =
            with_progress(global, "preparing", |progress| Registrand::new(&decomposer, described, progress))
                .map_err(|_| CliError::Cancelled)?
                .ok_or_else(|| CliError::Input(format!("{}: the shape has no points", input.name)))?;
        sides.push(Side { input, whole, decomposer, registrand });
    }
    sides.try_into().map_err(|_| CliError::Input("two shapes are needed".to_owned()))
}

fn find(args: &MatchArgs, first: &Side, second: &Side, global: &Global<'_>) -> Result<Matching, CliError> {
    let (a, b) = (first.features(), second.features());
    if args.motion == MotionArg::None {
        return Ok(Matching { registration: None, pairs: descriptor_pairs(a, b, args.ratio) });
    }
    let params = SearchParams::default().with_scaled(args.motion == MotionArg::Similarity);
    let mut registration = with_progress(global, "matching", |progress| {
        register(&first.registrand, &second.registrand, &params, progress)
    })
    .map_err(|_| CliError::Cancelled)?;
    if registration.is_clear
        && let Some(best) = &mut registration.best
    {
        with_progress(global, "refining", |progress| {
            thinning::refine(first, second, best, params.scaled, progress)
        })?;
    }
    let pairs = registration.pairs(&first.registrand, &second.registrand, args.within);
    Ok(Matching { registration: Some(registration), pairs })
}

/// Sentences on the motion, on the evidence for it, and on the other motions that fit equally well.
fn describe_motion(found: &RegisteredMotion, registration: &Registration, second: &Side) -> String {
    let chance = registration.chance.map_or(0.0, |fit| fit.agreement.max(0.0));
    let mut text = format!("motion: {}\n", motion_text(&found.motion, second.decomposer.extent()));
    let _ = writeln!(
        text,
        "rests on: {} within 1 σ of each other, {} after the best motion of the mirror image; bands correlate by {:.2}, mirrored by {chance:.2}",
        count(found.n_agreeing, "pair of features", "pairs of features"),
        registration.n_by_chance,
        found.fit.agreement,
    );
    let _ = writeln!(
        text,
        "fit: median distance {} ({} mean edges), {:.0} % overlap, {:.1} % of it farther apart than 1 % of the diagonal",
        number(found.fit.median),
        number(found.fit.median / second.decomposer.mean_length()),
        100.0 * found.fit.overlap,
        100.0 * found.fit.conflict,
    );
    let n_equal = registration.equal.len();
    if n_equal > 0 {
        let _ = writeln!(
            text,
            "not certain: {} equally well, so that each is right with a probability of at most {:.2}:",
            count(n_equal, "other motion fits", "other motions fit"),
            registration.confidence()
        );
        for other in registration.equal.iter().take(MAX_EQUAL) {
            let _ = writeln!(
                text,
                "  {}; median distance {}, {:.0} % overlap",
                motion_text(&other.motion, second.decomposer.extent()),
                number(other.fit.median),
                100.0 * other.fit.overlap
            );
        }
        if n_equal > MAX_EQUAL {
            let _ = writeln!(text, "  … {} more; write them with -o FILE.json", n_equal - MAX_EQUAL);
        }
    }
    text
}

fn motion_text(motion: &Motion, size: f64) -> String {
    let scale =
        if motion.scale() == 1.0 { String::new() } else { format!(", scale {}", number(motion.scale())) };
    format!(
        "rotation by {:.2}°, translation by ({}){scale}",
        motion.degrees(),
        shift(motion.translation(), size)
    )
}

/// A sentence on why no motion is claimed, with a suggestion that applies to these shapes.
fn describe_none(args: &MatchArgs, first: &Side, second: &Side) -> String {
    let fewest = first.features().keys.len().min(second.features().keys.len());
    let ratio = second.decomposer.extent() / first.decomposer.extent();
    let has_few = fewest < 3;
    let reason = if has_few {
        let found = count(fewest, "feature", "features");
        format!("no motion: {found}, too few to tell one motion from another")
    } else {
        "no motion fits better than the best motion of the mirror image: the shapes differ, or share less than a \
         quarter of their surface"
            .to_owned()
    };
    if args.motion == MotionArg::Rigid && !(1.0 / UNIT_RATIO..=UNIT_RATIO).contains(&ratio) {
        format!(
            "{reason}; {} is {} times as large, so that --motion similarity may apply\n",
            second.input.name,
            number(ratio)
        )
    } else if has_few {
        format!("{reason}, as on a ball or a mesh of few vertices\n")
    } else {
        format!("{reason}; --motion none pairs features without a motion, for bent shapes\n")
    }
}

fn describe(args: &MatchArgs, first: &Side, second: &Side, found: &Matching) -> String {
    let mut text = String::new();
    for side in [first, second] {
        let (n, n_features) = (side.n_vertices(), side.features().features.len());
        let (n, n_features) = (count(n, "vertex", "vertices"), count(n_features, "feature", "features"));
        let _ = writeln!(text, "{}: {n}, {n_features}", side.input.name);
    }
    if let Some(registration) = &found.registration {
        text += &match registration.clear() {
            Some(motion) => describe_motion(motion, registration, second),
            None => describe_none(args, first, second),
        };
    }
    let _ = writeln!(text, "{}\n", count(found.pairs.len(), "pair", "pairs"));
    let mut by_confidence: Vec<&Pair> = found.pairs.iter().collect();
    by_confidence.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    if !by_confidence.is_empty() {
        text += &table(
            ["vertex", "other vertex", "sigma", "apart, σ", "confidence"],
            by_confidence.iter().take(MAX_PRINTED).map(|p| {
                let (a, b) = (&first.features().features[p.first], &second.features().features[p.second]);
                let apart = if p.sigmas.is_nan() { "–".to_owned() } else { format!("{:.2}", p.sigmas) };
                [
                    a.vertex.to_string(),
                    b.vertex.to_string(),
                    number(a.sigma),
                    apart,
                    format!("{:.2}", p.confidence),
                ]
            }),
        );
    }
    if by_confidence.len() > MAX_PRINTED {
        let _ = writeln!(text, "  … {} more; write them with -o FILE.csv", by_confidence.len() - MAX_PRINTED);
    }
    text
}

/// A pair with its two features.
fn pair_json(first: &Side, second: &Side, pair: &Pair) -> Value {
    let feature = |side: &Side, k: usize| {
        let f = &side.features().features[k];
        json!({"vertex": f.vertex, "position": f.position, "sigma": f.sigma, "sign": f.sign()})
    };
    json!({
        "first": feature(first, pair.first), "second": feature(second, pair.second),
        "apart_sigmas": if pair.sigmas.is_nan() { None } else { Some(pair.sigmas) },
        "confidence": pair.confidence,
    })
}

/// A motion with its evidence.
fn motion_json(found: &RegisteredMotion, matching: &Matching) -> Value {
    let RegisteredMotion { motion, fit, n_agreeing, .. } = found;
    let registration = matching.registration.as_ref();
    json!({
        "matrix": motion.matrix(), "degrees": motion.degrees(), "scale": motion.scale(),
        "agreeing": n_agreeing, "by_chance": registration.map(|r| r.n_by_chance),
        "median_distance": fit.median, "overlap": fit.overlap, "conflict": fit.conflict,
        "agreement": fit.agreement,
        "agreement_by_chance": registration.and_then(|r| r.chance).map(|fit| fit.agreement),
        "confidence": registration.map(Registration::confidence),
    })
}

fn report(first: &Side, second: &Side, found: &Matching) -> Value {
    let side = |side: &Side| {
        json!({
            "shape": side.input.name, "vertices": side.n_vertices(), "searched": side.decomposer.n_vertices(),
            "features": side.features().features.len(), "signed": side.features().is_signed,
        })
    };
    json!({
        "first": side(first),
        "second": side(second),
        "motion": found.motion().map(|motion| motion_json(motion, found)),
        "equal_motions": found.equal().iter().map(|motion| motion_json(motion, found)).collect::<Vec<_>>(),
        "pairs": found.pairs.iter().map(|p| pair_json(first, second, p)).collect::<Vec<_>>(),
    })
}

fn write_pairs(
    path: &Path,
    first: &Side,
    second: &Side,
    found: &Matching,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let text = if has_extension(&without_gzip(path), &["json"]) {
        format!("{:#}\n", report(first, second, found))
    } else {
        let head = [
            "vertex",
            "x",
            "y",
            "z",
            "sigma",
            "other_vertex",
            "other_x",
            "other_y",
            "other_z",
            "other_sigma",
            "apart_sigmas",
            "confidence",
        ];
        let mut table = Table::new("pairs.csv", "", &head);
        for pair in &found.pairs {
            let mut row = Vec::new();
            for f in [&first.features().features[pair.first], &second.features().features[pair.second]] {
                row.push(f.vertex.to_string());
                row.extend(f.position.unwrap_or([f64::NAN; 3]).map(|c| c.to_string()));
                row.push(f.sigma.to_string());
            }
            row.push(if pair.sigmas.is_nan() { String::new() } else { pair.sigmas.to_string() });
            row.push(pair.confidence.to_string());
            table.rows.push(row);
        }
        table.csv()
    };
    write_file(global, path, text.as_bytes())
}
