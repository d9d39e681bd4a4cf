//! Fig. 13: local edits. A letter carved and raised, one half smoothed and the other enhanced, one edit after another.

use crate::draw::{Sheet, SheetPanel, View};
use crate::numbers::{decomposer, distance, positions};
use crate::{Context, FigureError, Model, Outcome, Table, Verdict, digits};
use adwave::bands::{BandsParams, Schedule};
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::region::{Length, Location, Region};
use adwave::shape::{bounding_box, diagonal, vertex_normals};
use adwave::{Decomposer, Progress};
use std::f64::consts::TAU;

const SPHERE_VERTICES: usize = 10_242;
const SPHERE_LEVELS: usize = 8;
const N_VERTICES: usize = 25_000;
const N_LEVELS: usize = 8;
/// Gain of the raised letter, which moves it outward as far as the other letter moves inward.
const RAISE: f64 = 2.0;
/// Gains of an enhanced region, the finest band first.
const ENHANCE: [f64; N_LEVELS] = [1.5, 1.8, 2.0, 2.0, 2.0, 1.8, 1.5, 1.2];

#[expect(clippy::too_many_lines, reason = "one figure, from its first number to its verdict")]
pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let mut table = Table::new(
        "fig13.csv",
        "Displacements by each edit (% of the diagonal; along the normals, outward is positive)",
        &["edit", "vertices in the region", "mean in the region", "largest", "largest outside"],
    );
    let sphere = context.model_or(&["sphere"], "sphere", SPHERE_VERTICES)?;
    let sphere_decomposer = decomposer(&sphere);
    let letter = letter_s(sphere.points())?;
    let uniform = |gain: f64| Gains::Gains(vec![gain; SPHERE_LEVELS]);
    let mut letters = Vec::new();
    let mut edits = Vec::new();
    for (name, gain) in [("S carved", 0.0), ("S raised", RAISE)] {
        let layer = Layer { gains: uniform(gain), region: letter.clone() };
        let after = apply_layer(context, &sphere_decomposer, sphere.points(), SPHERE_LEVELS, &layer)?;
        edits.push(measure(name, &sphere, &sphere_decomposer, sphere.points(), &after, &layer.region)?);
        letters.push((name, after));
    }

    let creature = context.model_or(&["skull", "armadillo", "gargoyle"], "creature", N_VERTICES)?;
    let creature_decomposer = decomposer(&creature);
    let (low, high) = bounding_box(creature.points()).ok_or("the model has no vertices")?;
    let middle: [f64; 3] = std::array::from_fn(|c| 0.5 * (low[c] + high[c]));
    let half = |sign: f64| Region::HalfSpace {
        point: middle,
        normal: [sign, 0.0, 0.0],
        falloff: Some(Length::PercentOfDiagonal(4.0)),
    };
    let suppress = |region: Region| Layer { gains: Gains::Preset(Preset::SuppressPaper), region };
    let enhance = |region: Region| Layer { gains: Gains::Gains(ENHANCE.to_vec()), region };
    let halves = [suppress(half(1.0)), enhance(half(-1.0))];
    let mut both = creature.points().to_vec();
    for layer in &halves {
        both = apply_layer(context, &creature_decomposer, &both, N_LEVELS, layer)?;
    }

    // One edit after another: each is applied to what the one before left.
    let chain_on = context.model_or(&["gargoyle", "dinosaur", "armadillo"], "creature", N_VERTICES)?;
    let chain_decomposer = decomposer(&chain_on);
    let extreme = |score: &dyn Fn(&[f64; 3]) -> f64| -> Location {
        let best = (0..chain_on.points().len())
            .max_by(|&x, &y| score(&chain_on.points()[x]).total_cmp(&score(&chain_on.points()[y])));
        Location::Vertex(best.unwrap_or(0) as u32)
    };
    let ball = |center: Location, percent: f64| Region::Ball {
        center,
        radius: Length::PercentOfDiagonal(percent),
        falloff: None,
    };
    let steps = [
        ("top enhanced", enhance(ball(extreme(&|p| p[1]), 18.0))),
        ("front smoothed", suppress(ball(extreme(&|p| p[2]), 22.0))),
        ("side smoothed", suppress(ball(extreme(&|p| p[0]), 25.0))),
    ];
    let mut chain = vec![("original", chain_on.points().to_vec())];
    for (name, layer) in &steps {
        let before = chain[chain.len() - 1].1.clone();
        let after = apply_layer(context, &chain_decomposer, &before, N_LEVELS, layer)?;
        edits.push(measure(name, &chain_on, &chain_decomposer, &before, &after, &layer.region)?);
        chain.push((name, after));
    }

    for edit in &edits {
        table.push([
            edit.name.clone(),
            edit.n_inside.to_string(),
            digits(edit.mean),
            digits(edit.largest),
            digits(edit.outside),
        ]);
    }
    let mut sheet = Sheet::new(4).own_cameras();
    let front = View { azimuth: 25.0, elevation: 15.0 };
    sheet = sheet.view(front);
    for (name, after) in &letters {
        sheet.push(SheetPanel::with_points(&sphere, after.clone(), *name));
    }
    sheet.push(SheetPanel::new(&creature, "original"));
    sheet.push(SheetPanel::with_points(&creature, both, "one half smoothed, the other enhanced"));
    for (name, after) in chain {
        sheet.push(SheetPanel::with_points(&chain_on, after, name));
    }
    let untouched = edits.iter().all(|e| e.outside == 0.0);
    let (carved, raised) = (edits[0].mean, edits[1].mean);
    let verdict = Verdict::from_parts(
        &[untouched, carved < 0.0, raised > 0.0],
        format!(
            "Suppression moves the letter by {} % of the diagonal along the normals (inward is negative), enhancement \
             by {} %. No vertex outside the region of an edit moves{}.",
            digits(carved),
            digits(raised),
            if untouched { ", to the last bit" } else { " – but for some that did" }
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(sphere.label())
        .add_shape(creature.label())
        .add_shape(chain_on.label())
        .sheet(
            "fig13.png",
            "Top: a letter on a sphere, carved by suppressing all bands in the region and raised by doubling them; a \
             figure, and the same figure with one half smoothed and the other enhanced. Bottom: a sequence of edits, \
             each applied to the result of the one before.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "An edit has gains and a soft region: a stroke along the surface, a half-space, or a ball by geodesic \
             distance. On a sphere the bands of the coordinates point outward, so that removing them carves and \
             doubling them raises.",
        ))
}

/// Region of the letter S, a stroke over the front of a sphere.
fn letter_s(points: &[[f64; 3]]) -> Result<Region, FigureError> {
    let (low, high) = bounding_box(points).ok_or("the sphere has no vertices")?;
    let middle: [f64; 3] = std::array::from_fn(|c| 0.5 * (low[c] + high[c]));
    let size = 0.5 * (high[1] - low[1]);
    // Two arcs of three quarters of a circle each, the upper open to the right, the lower to the left.
    let (arc, n) = (0.30, 24);
    let arc_point = |center: f64, from: f64, to: f64, k: usize| {
        let angle = TAU * (from + (to - from) * k as f64 / f64::from(n));
        [arc * angle.cos(), center + arc * angle.sin()]
    };
    let upper = (0..=n as usize).map(|k| arc_point(arc, 0.06, 0.75, k));
    let lower = (1..=n as usize).map(|k| arc_point(-arc, 0.25, -0.44, k));
    let on_sphere = |[x, y]: [f64; 2]| {
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        // Rotated toward the viewer of the sheet.
        let (azimuth, elevation) = (25.0_f64.to_radians(), 15.0_f64.to_radians());
        let (y, z) = (y * elevation.cos() + z * elevation.sin(), z * elevation.cos() - y * elevation.sin());
        let (x, z) = (x * azimuth.cos() + z * azimuth.sin(), z * azimuth.cos() - x * azimuth.sin());
        Location::Point([middle[0] + size * x, middle[1] + size * y, middle[2] + size * z])
    };
    Ok(Region::Stroke {
        path: upper.chain(lower).map(on_sphere).collect(),
        radius: Length::Units(0.13 * size),
        falloff: Some(Length::Units(0.09 * size)),
    })
}

fn apply_layer(
    context: &Context<'_>,
    decomposer: &Decomposer,
    points: &[[f64; 3]],
    n_levels: usize,
    layer: &Layer,
) -> Result<Vec<[f64; 3]>, FigureError> {
    let layers = [layer.clone()];
    let (schedule, params) = (Schedule::dyadic(n_levels)?, BandsParams::default());
    let after = decomposer
        .request(points.as_flattened(), 3, &schedule)
        .params(&params)
        .progress(context.progress)
        .filter(&Edit::new(&layers))?;
    Ok(positions(&after))
}

/// Displacements by an edit, in % of the diagonal.
struct EditMeasure {
    name: String,
    n_inside: usize,
    mean: f64,
    largest: f64,
    outside: f64,
}

fn measure(
    name: &str,
    model: &Model,
    decomposer: &Decomposer,
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    region: &Region,
) -> Result<EditMeasure, FigureError> {
    let weights = region.weights(decomposer.metric(), &|_| None, &[], Progress::none())?;
    let weights = weights.to_vertices(decomposer.vertex_map());
    let normals = vertex_normals(before, &model.triangles);
    let unit = 100.0 / diagonal(model.points());
    let (mut sum, mut total, mut largest, mut outside, mut n_inside) = (0.0, 0.0, 0.0_f64, 0.0_f64, 0);
    for x in 0..before.len() {
        let away = unit * distance(&before[x], &after[x]);
        if weights[x] > 0.0 {
            let along: f64 = (0..3).map(|c| (after[x][c] - before[x][c]) * normals[x][c]).sum();
            sum += weights[x] * along * unit;
            total += weights[x];
            largest = largest.max(away);
            n_inside += 1;
        } else {
            outside = outside.max(away);
        }
    }
    Ok(EditMeasure { name: name.to_owned(), n_inside, mean: sum / total, largest, outside })
}
