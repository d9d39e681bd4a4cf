//! Features section: places where a level stands out, with their sizes.

use super::Subject;
use super::drawing::{PictureSpec, SignalPictures, Studio};
use super::place::Places;
use crate::analysis::features;
use crate::page::{Block, Figure, Legend, Section};
use crate::table::{NONE, Table, digits};
use adwave::Progress;
use adwave::bands::{BandsParams, Schedule};
use adwave::features::{Feature, FeatureParams, Response, ShapeCoordinates, coordinate_features, value_step};
use adwave_render::{Ball, ColorMap};
use std::time::Instant;

/// Largest number of features in the table.
const MAX_LISTED: usize = 15;

/// Features of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureSummary {
    /// Features, the strongest first.
    pub features: Vec<Feature>,
    /// Seconds spent on the computation.
    pub seconds: f64,
}

pub(crate) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> (Section, Option<FeatureSummary>) {
    let mut section = Section::new("features", "Features");
    let mut params = FeatureParams::default();
    if subject.grid.is_some() {
        // The mean of a level, by which the usual response divides, is that of the background of an image.
        params = params.with_response(Response::Literal).with_value_step(Some(value_step(subject.values)));
    }
    let start = Instant::now();
    let is_significant = params.finds_significant(subject.decomposer);
    let found = if is_significant && subject.is_geometry() {
        significant_features(subject, &params).map_err(|why| why.to_string())
    } else {
        features(subject.decomposer, subject.bands, &params).map_err(|why| why.to_string())
    };
    let mut found = match found {
        Ok(found) => found,
        Err(why) => {
            section.note(format!("No features: {why}."));
            return (section, None);
        }
    };
    let seconds = start.elapsed().as_secs_f64();
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let n_levels = subject.bands.n_levels();
    let vertex = subject.vertex();
    let is_of_values = is_significant && subject.grid.is_some();
    let rule = if is_of_values {
        format!(
            "A feature is a {vertex} where W_j is extremal among its neighbors and stands out from its surroundings by more than \
             independent noise explains, and by more than on the levels below and above."
        )
    } else if is_significant && subject.is_geometry() {
        let causes = if subject.shape.is_cloud() { "the drawing of the points" } else { "the triangles" };
        format!(
            "A feature is a {vertex} where the part of W_j along the normal is extremal among its neighbors and stands out \
             from its surroundings by more than {causes} and noise explain, and by more than on the levels below and above."
        )
    } else {
        format!(
            "A feature is a {vertex} where |W_j| is larger than at its neighbors, on the same level and on the levels below \
             and above, and at least {} times the mean of its level.",
            params.theta()
        )
    };
    section.say(format!(
        "{rule} Levels 2 to {} can have features. The radius of a feature is about σ_j.",
        n_levels - 1
    ));
    if found.is_empty() {
        section.note(format!("No {} is a feature.", subject.vertex()));
        return (section, Some(FeatureSummary { features: found, seconds }));
    }
    section.say(match found.len() {
        1 => "There is one feature.".to_owned(),
        n => format!("There are {n} features."),
    });
    section.gallery(pictures(subject, studio, &found));
    section.push(Block::Table(level_table(subject, &found)));
    let strength = if is_of_values {
        "the contrast of W_j with its surroundings, in standard deviations of the noise"
    } else {
        "|W_j| divided by its mean over the level"
    };
    section.push(Block::Table(strongest_table(subject, studio, &found, strength)));
    (section, Some(FeatureSummary { features: found, seconds }))
}

/// Finds the significant features of the coordinates.
fn significant_features(
    subject: &Subject<'_>,
    params: &FeatureParams,
) -> Result<Vec<Feature>, Box<dyn std::error::Error>> {
    let steps = subject.bands.steps.get(1..).unwrap_or_default();
    let schedule = Schedule::real(steps.to_vec())?;
    let coordinates = ShapeCoordinates {
        points: subject.values.as_chunks().0,
        normals: subject.normals,
        schedule: &schedule,
        bands: BandsParams::default(),
    };
    Ok(coordinate_features(subject.decomposer, &coordinates, params, Progress::none())?.features)
}

/// Lists the levels that have features, ascending, with their numbers of features.
fn counts(found: &[Feature]) -> Vec<(usize, usize)> {
    let mut levels: Vec<usize> = found.iter().map(|f| f.level).collect();
    levels.sort_unstable();
    levels.chunk_by(|a, b| a == b).map(|same| (same[0], same.len())).collect()
}

fn level_table(subject: &Subject<'_>, found: &[Feature]) -> Table {
    let unit = subject.width_unit();
    let mut table = Table::new(
        "features-by-level.csv",
        "Number of features on each level.",
        &["level j", &format!("σ_j, {unit}"), "features"],
    );
    for (level, count) in counts(found) {
        table.push([level.to_string(), digits(subject.bands.sigma[level]), count.to_string()]);
    }
    table
}

fn strongest_table(subject: &Subject<'_>, studio: &Studio<'_>, found: &[Feature], strength: &str) -> Table {
    let unit = subject.width_unit();
    let signed = subject.bands.n_channels == 1;
    let places = Places::new(subject, studio.up());
    let caption = format!(
        "The strongest features{}. The strength is {strength}{}.",
        if found.len() > MAX_LISTED { format!(", {MAX_LISTED} of {}", found.len()) } else { String::new() },
        if signed { "; the sign is that of W_j: + where the signal is above its surroundings" } else { "" },
    );
    let mut table = Table::new(
        "features.csv",
        &caption,
        &[
            subject.vertex(),
            "where",
            "level j",
            &format!("radius σ_j, {unit}"),
            "strength",
            "sign",
            "x, y, z",
        ],
    );
    for f in found.iter().take(MAX_LISTED) {
        let none = || NONE.to_owned();
        table.push([
            subject.place(f.vertex),
            f.position.zip(places.as_ref()).map_or_else(none, |(p, places)| places.words(&p)),
            f.level.to_string(),
            digits(f.sigma),
            digits(f.strength),
            if signed { if f.sign() > 0 { "+" } else { "−" }.to_owned() } else { none() },
            f.position.map_or_else(none, |p| subject.position(p)),
        ]);
    }
    table.drop_empty_columns()
}

fn pictures(
    subject: &Subject<'_>,
    studio: &mut Studio<'_>,
    found: &[Feature],
) -> Result<Vec<Figure>, String> {
    let levels = counts(found);
    let map = ColorMap::from_name("turbo").expect("a color map that exists");
    let last = subject.bands.n_levels().saturating_sub(1).max(3) as f64;
    // The ends of the map are nearly black.
    let color = |level: usize| map.color(0.12 + 0.76 * (level as f64 - 2.0) / (last - 2.0));
    let balls: Vec<Ball> = found
        .iter()
        .filter_map(|f| {
            let center = match &subject.grid {
                Some(grid) => grid.position_on_sheet(f.vertex),
                None => f.position,
            };
            Some(Ball { center: center?, radius: f.sigma, color: color(f.level) })
        })
        .filter(|ball| ball.radius > 0.0)
        .collect();
    if balls.is_empty() && subject.grid.is_some() {
        return Ok(Vec::new());
    }
    let keys = || {
        let key = |&(level, count): &(usize, usize)| {
            let sigma = digits(subject.bands.sigma[level]);
            (color(level), format!("level {level}, σ = {sigma}: {count}"))
        };
        Some(Legend::Keys(levels.iter().map(key).collect()))
    };
    let alt = format!("Features of {}", subject.name);
    let caption = "A ball for each feature, of radius σ_j, colored by level.";
    let front = if subject.grid.is_some() {
        SignalPictures::new(subject).picture(subject.values, alt, caption.to_owned())
    } else {
        PictureSpec::plain(alt, format!("{caption} Features on the far side are hidden."))
    };
    let back = PictureSpec::plain(
        format!("Features of {} from the opposite side", subject.name),
        "The same from the opposite side.",
    );
    let mut figures = studio.draw_both(vec![front.balls(balls.clone())], vec![back.balls(balls)])?;
    for figure in &mut figures {
        figure.legend = keys();
    }
    Ok(figures)
}
