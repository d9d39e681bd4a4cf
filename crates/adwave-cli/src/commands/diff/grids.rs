//! Difference between two images or volumes, place by place.

use super::DiffArgs;
use super::distances::{Difference, fact};
use crate::commands::result_file::check_places;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{coordinate_text, count, number};
use crate::resolve::applicable::article;
use crate::resolve::shape::Input;
use adwave_io::{GRID_VALUES, GridLayout};
use adwave_register::Summary;
use adwave_report::shape_report::grid_index;
use serde_json::{Value, json};

/// Values of two images or volumes on the same places; NaN where either has no data.
pub(super) struct GridValues {
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
}

/// Refuses options of shapes, and a file that holds no images.
pub(super) fn check(args: &DiffArgs, first: &Input, global: &Global<'_>) -> Result<(), CliError> {
    let kind = first.kind_name();
    let applies = format!(
        "applies to shapes, and {} is {} {kind}: places with the same index are compared",
        first.name,
        article(kind)
    );
    global.given.refuse(&["--align", "--by", "--limit", "--view", "--up"], &applies)?;
    let is_for_all = |path: &&std::path::PathBuf| crate::output::has_extension(path, &["npz", "html", "htm"]);
    match args.output.as_ref().filter(|path| !is_for_all(path)) {
        Some(path) => check_places(path, first),
        None => Ok(()),
    }
}

/// The difference of the second image or volume from the first at each place, and the values of both.
pub(super) fn difference(first: &Input, second: &Input) -> Result<(Difference, GridValues), CliError> {
    let [a, b] = layouts([first, second])?;
    if let Some(what) = a.difference(b) {
        return Err(CliError::Input(format!(
            "{} must have the same places as {}, whose {what}; resample one of them first",
            second.name, first.name
        )));
    }
    let (mut values, n_channels) = values(first)?;
    let (mut others, n_others) = self::values(second)?;
    if n_channels != n_others {
        return Err(CliError::Input(format!(
            "{} must have as many values per place as {}, {n_channels}, got {n_others}; choose the frames to compare first",
            second.name, first.name
        )));
    }
    let (mut n_compared, mut n_alone) = (0, [0; 2]);
    for (p, q) in values.chunks_exact_mut(n_channels).zip(others.chunks_exact_mut(n_channels)) {
        match [&*p, &*q].map(|row| row.iter().all(|v| v.is_finite())) {
            [true, true] => n_compared += 1,
            has_data => {
                n_alone.iter_mut().zip(has_data).for_each(|(n, has)| *n += usize::from(has));
                p.fill(f64::NAN);
                q.fill(f64::NAN);
            }
        }
    }
    if n_compared == 0 {
        return Err(CliError::Input(format!(
            "{} and {} must have data at a common place, and none has data in both; choose other masks",
            first.name, second.name
        )));
    }
    let difference: Vec<f64> = values.iter().zip(&others).map(|(p, q)| q - p).collect();
    let is_identical = difference.iter().all(|d| *d == 0.0 || d.is_nan()) && n_alone == [0, 0];
    let weights = vec![1.0; a.n_places()];
    let summary = Summary::new(&difference, n_channels, &weights);
    let [one, many] = first.row_words();
    let mut how = vec![format!(
        "The difference at a {one} is its value in {} less that in {}.",
        second.name, first.name
    )];
    if n_compared < a.n_places() {
        how.push(format!(
            "{n_compared} of {} are compared: {} have data in {} alone, {} in {} alone, and {} in neither.",
            count(a.n_places(), one, many),
            n_alone[0],
            first.name,
            n_alone[1],
            second.name,
            a.n_places() - n_compared - n_alone[0] - n_alone[1]
        ));
    }
    if is_identical {
        how.push(format!("The two are identical: all {} have equal values.", count(n_compared, one, many)));
    }
    let mut facts = vec![fact("rms", number(summary.rms), "root mean square")];
    if n_channels == 1 {
        facts.push(fact("mean", number(summary.mean), ""));
    }
    let at = format!("at {one} {}", place_text(a, summary.vertex));
    facts.push(fact("greatest", number(summary.greatest), &at));
    let mut json = json!({
        "rms": summary.rms, "mean": summary.mean, "greatest": summary.greatest, "identical": is_identical,
        "places": a.n_places(), "compared": n_compared, "only_first": n_alone[0], "only_second": n_alone[1],
    });
    add_place(&mut json, a, summary.vertex);
    let difference = Difference { n_channels, values: difference, how, facts, json, motion: None };
    Ok((difference, GridValues { first: values, second: others }))
}

/// The places of two inputs, which both must be images or volumes.
fn layouts(inputs: [&Input; 2]) -> Result<[&GridLayout; 2], CliError> {
    if let [Some(a), Some(b)] = inputs.map(|input| input.file.grid()) {
        return Ok([a, b]);
    }
    let [first, second] = inputs.map(|input| {
        let kind = input.kind_name();
        format!("{} {kind} ({})", article(kind), input.name)
    });
    Err(CliError::Input(format!(
        "both inputs must be shapes, or both images or volumes, got {first} and {second}; give two of a kind"
    )))
}

/// Values of an image or a volume, NaN where it has no data, and their number at a place.
fn values(input: &Input) -> Result<(Vec<f64>, usize), CliError> {
    let Some(field) = input.file.field(GRID_VALUES) else {
        return Err(CliError::Input(format!("{}: the file has no values", input.name)));
    };
    let mut values = field.to_f64();
    if let Some(kept) = input.file.grid().and_then(|layout| layout.kept.as_ref()) {
        let rows = values.chunks_exact_mut(field.n_channels).zip(kept);
        rows.filter(|(_, kept)| !**kept).for_each(|(row, _)| row.fill(f64::NAN));
    }
    Ok((values, field.n_channels))
}

/// Index of a place with its coordinates in the file.
pub(super) fn place_text(layout: &GridLayout, place: usize) -> String {
    let index = grid_index(&layout.sizes, place).iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    let squares = layout.sizes.iter().zip(&layout.spacings).map(|(n, h)| (*n as f64 * h).powi(2));
    let diagonal = squares.sum::<f64>().sqrt();
    let position = layout.position(place).map(|c| coordinate_text(c, diagonal));
    format!("{index} ({})", position.join(", "))
}

/// Adds the index and the position of a place to a JSON object.
pub(super) fn add_place(json: &mut Value, layout: &GridLayout, place: usize) {
    json["index"] = json!(grid_index(&layout.sizes, place));
    json["position"] = json!(layout.position(place));
}
