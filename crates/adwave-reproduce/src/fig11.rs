//! Fig. 11: textures. Critical points of the feature map, saliency and features of this method.

use crate::draw::{GREEN, ORANGE, Sheet, SheetPanel};
use crate::numbers::{bands, decomposer, distance, percent};
use crate::{Context, FigureError, Model, Outcome, Table, Verdict};
use adwave::features::{Feature, FeatureParams};
use adwave::saliency::SaliencyParams;
use adwave::shape::diagonal;
use adwave::signal::luminance;
use adwave_baselines::feature_map::{CriticalKind, feature_map};
use adwave_io::{ReadLimits, texture_colors};
use adwave_report::analysis::{features, saliency};
use std::path::{Path, PathBuf};

const N_VERTICES: usize = 10_000;
/// Number of levels: one more than for the face in Table 2 of the paper, so that levels 2 to 6 can have features.
const N_LEVELS: usize = 7;
/// Lowest threshold θ that the paper calls useful; the default is 2.4.
const LOW_THETA: f64 = 1.6;

/// Textured shape.
struct Textured {
    model: std::sync::Arc<Model>,
    /// Red, green and blue of each vertex, in [0, 1].
    colors: Vec<[f64; 3]>,
    /// Centers and radii of the spots, in model units; empty if they are unknown.
    spots: Vec<([f64; 3], f64)>,
}

/// Numbers of the points found by a method that lie on the painted spots.
struct SpotHits {
    n_points: usize,
    /// Number of spots with a point in their inner half.
    hit: usize,
    /// Number of points that lie on a spot.
    on: usize,
}

#[expect(clippy::too_many_lines, reason = "one figure, from its first number to its verdict")]
pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let mut note = String::new();
    let mut cases = vec![paint_sphere(context)?];
    if let Some(model) = context.model(&["spot"]) {
        let path = model.path.clone().unwrap_or_default();
        match texture_colors(&model.file, &path, find_picture(&path).as_deref(), &ReadLimits::default()) {
            Ok(field) => {
                let colors = (0..field.len()).map(|x| std::array::from_fn(|c| field.get(x, c))).collect();
                cases.push(Textured { model, colors, spots: Vec::new() });
            }
            Err(error) => note = format!(" The texture of the user's model could not be used: {error}."),
        }
    }
    let mut table = Table::new(
        "fig11.csv",
        "Points of each method, level by level",
        &["shape", "level", "maxima", "minima", "saddles", "sum of indices", "features of ours"],
    );
    let mut known = Table::new(
        "fig11-spots.csv",
        "Points on the painted spots",
        &["method", "points", "spots with a point near the center", "spots", "points on a spot"],
    );
    let mut sheet = Sheet::new(4).own_cameras();
    let mut found_by = Vec::new();
    for case in &cases {
        let model = &case.model;
        let signal: Vec<f64> = case.colors.iter().map(|&rgb| luminance(rgb)).collect();
        let decomposer = decomposer(model);
        let bands = bands(context, &decomposer, &signal, 1, N_LEVELS)?;
        let map = saliency(&decomposer, &bands, &SaliencyParams::paper())?.map;
        let ours = features(&decomposer, &bands, &FeatureParams::default())?;
        // e^(−tΔ) of the same width: its mean square displacement is 4t.
        let times: Vec<f64> = bands.sigma[2..N_LEVELS].iter().map(|s| s * s / 4.0).collect();
        let theirs = feature_map(&model.shape, &signal, &times, context.progress)?;
        let mut critical = Vec::new();
        for (k, level) in theirs.iter().enumerate() {
            let j = k + 2;
            let kind =
                |kind: CriticalKind| level.points.iter().filter(|p| p.kind == kind).count().to_string();
            table.push([
                model.name.clone(),
                j.to_string(),
                kind(CriticalKind::Maximum),
                kind(CriticalKind::Minimum),
                kind(CriticalKind::Saddle),
                level.index_sum.to_string(),
                ours.iter().filter(|f| f.level == j).count().to_string(),
            ]);
            critical.extend(level.points.iter().map(|p| (p.vertex, p.kind, bands.sigma[j])));
        }
        let bytes = |rgb: &[f64; 3]| rgb.map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8);
        let colors: Vec<[u8; 3]> = case.colors.iter().map(bytes).collect();
        // Smaller than σ, so that balls of several levels do not hide the texture.
        let at = |vertex: usize, sigma: f64| (model.points()[vertex], 0.3 * sigma);
        let (saddles, extrema): (Vec<_>, Vec<_>) =
            critical.iter().partition(|(_, kind, _)| *kind == CriticalKind::Saddle);
        let place = |points: Vec<&(usize, CriticalKind, f64)>| -> Vec<([f64; 3], f64)> {
            points.into_iter().map(|p| at(p.0, p.2)).collect()
        };
        sheet.push(SheetPanel::new(model, format!("texture on the {}", model.name)).colors(colors.clone()));
        sheet.push(
            SheetPanel::new(model, format!("feature map: {} points", critical.len()))
                .colors(colors.clone())
                .balls(model, place(extrema), GREEN)
                .balls(model, place(saddles), ORANGE),
        );
        sheet.push(SheetPanel::new(model, "our saliency").saliency(&map));
        sheet.push(SheetPanel::new(model, format!("our features: {}", ours.len())).colors(colors).balls(
            model,
            ours.iter().map(|f| at(f.vertex, f.sigma)),
            GREEN,
        ));
        if !case.spots.is_empty() {
            let critical: Vec<[f64; 3]> = critical.iter().map(|p| model.points()[p.0]).collect();
            let extrema: Vec<[f64; 3]> = theirs
                .iter()
                .flat_map(|l| l.points.iter().filter(|p| p.kind != CriticalKind::Saddle))
                .map(|p| model.points()[p.vertex])
                .collect();
            let low = FeatureParams::default().with_theta(LOW_THETA);
            let place = |found: &[Feature]| found.iter().map(|f| model.points()[f.vertex]).collect();
            let ours: Vec<[f64; 3]> = place(&ours);
            let more: Vec<[f64; 3]> = place(&features(&decomposer, &bands, &low)?);
            for (name, points) in [
                ("feature map", critical),
                ("feature map, maxima and minima", extrema),
                ("ours, θ = 2.4", ours),
                ("ours, θ = 1.6", more),
            ] {
                let found = count_hits(&case.spots, &points);
                known.push([
                    name.to_owned(),
                    found.n_points.to_string(),
                    found.hit.to_string(),
                    case.spots.len().to_string(),
                    percent(found.on as f64 / found.n_points as f64),
                ]);
                found_by.push(found);
            }
        }
    }
    let [all, extrema, ours, more] = &found_by[..] else { return Err("the painted shape has spots".into()) };
    let n_spots = cases[0].spots.len();
    let on = |found: &SpotHits| found.on as f64 / found.n_points as f64;
    let verdict = Verdict::from_parts(
        &[ours.hit * 10 >= n_spots * 8, on(ours) > on(all), on(ours) > on(extrema)],
        format!(
            "On the painted shape, whose spots are known, our method finds {} of {n_spots} with {} points, {} of them \
             on a spot (with θ = {LOW_THETA}: {} with {}). The feature map finds {} with {} points, {} on a spot; its \
             maxima and minima alone find {} with {} points, {} on a spot.",
            ours.hit,
            ours.n_points,
            percent(on(ours)),
            more.hit,
            more.n_points,
            all.hit,
            all.n_points,
            percent(on(all)),
            extrema.hit,
            extrema.n_points,
            percent(on(extrema)),
        ),
    );
    let mut outcome = Outcome::new(verdict)
        .sheet(
            "fig11.png",
            "From left to right: the texture, critical points of the feature map (maxima and minima green, saddles \
             orange), our saliency, our features. The radius of a ball is 0.3 σ.",
            &sheet,
            context,
        )?
        .table(table)
        .table(known)
        .say(format!(
            "The signal is the luminance of a texture, on a surface without geometric features. The feature map marks \
             maxima, minima and saddles of the smoothed signal. Our method marks extrema of the bands in place and \
             scale, that is, the spots themselves, with their sizes.{note}"
        ))
        .say(
            "The textured face of the paper is not public. The painted shape is a sphere with dark and light spots of \
             three sizes on a gradient from dark to light. It is synthetic, so that the true features are known.",
        );
    for case in &cases {
        outcome = outcome.add_shape(case.model.label());
    }
    Ok(outcome)
}

/// Finds a picture in the folder of a shape whose name begins with that of the shape, for files without materials.
fn find_picture(path: &Path) -> Option<PathBuf> {
    let lower =
        |path: &Path| path.file_name().map(|n| n.to_string_lossy().to_lowercase()).unwrap_or_default();
    let stem = lower(path).split('.').next().unwrap_or_default().to_owned();
    let is_picture = |name: &str| [".png", ".jpg", ".jpeg"].iter().any(|end| name.ends_with(end));
    let mut found: Vec<PathBuf> = std::fs::read_dir(path.parent()?)
        .ok()?
        .flatten()
        .map(|entry| entry.path())
        .filter(|file| lower(file).starts_with(&stem) && is_picture(&lower(file)))
        .collect();
    found.sort();
    found.into_iter().next()
}

/// Counts the points on spots, and the spots with a point in their inner half.
fn count_hits(spots: &[([f64; 3], f64)], points: &[[f64; 3]]) -> SpotHits {
    let within =
        |point: &[f64; 3], part: f64| spots.iter().any(|(middle, r)| distance(point, middle) <= part * r);
    SpotHits {
        n_points: points.len(),
        hit: spots.iter().filter(|(m, r)| points.iter().any(|p| distance(p, m) <= 0.5 * r)).count(),
        on: points.iter().filter(|p| within(p, 1.0)).count(),
    }
}

/// Paints a sphere with spots of three sizes, distributed by the golden angle, on a gradient.
fn paint_sphere(context: &Context<'_>) -> Result<Textured, FigureError> {
    const N_SPOTS: usize = 60;
    const RADII: [f64; 3] = [0.05, 0.08, 0.12];
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let model = context.built_in("sphere", N_VERTICES)?;
    let size = 0.5 * diagonal(model.points()) / 3.0_f64.sqrt();
    let spots: Vec<([f64; 3], f64)> = (0..N_SPOTS)
        .map(|k| {
            let z = 1.0 - (2.0 * k as f64 + 1.0) / N_SPOTS as f64;
            let (angle, r) = (GOLDEN_ANGLE * k as f64, (1.0 - z * z).sqrt());
            ([r * angle.cos() * size, r * angle.sin() * size, z * size], RADII[k % 3] * size)
        })
        .collect();
    let color = |p: &[f64; 3]| {
        let base = 0.5 + 0.22 * p[1] / size;
        let mut shade = base;
        for (k, (middle, radius)) in spots.iter().enumerate() {
            // Flat in the middle, soft at the border.
            let away = distance(p, middle) / radius;
            let inside = 1.0 / (1.0 + (12.0 * (away - 0.8)).exp());
            shade += inside * if k % 2 == 0 { -0.25 } else { 0.22 };
        }
        [shade, 0.95 * shade, 0.8 * shade]
    };
    let colors = model.points().iter().map(color).collect();
    Ok(Textured { model, colors, spots })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_near_the_center_hits_its_spot_and_one_outside_hits_none() {
        let spots = [([0.0; 3], 1.0), ([10.0, 0.0, 0.0], 2.0)];
        let found = count_hits(&spots, &[[0.4, 0.0, 0.0], [11.5, 0.0, 0.0], [5.0, 0.0, 0.0]]);
        assert_eq!((found.n_points, found.hit, found.on), (3, 1, 2));
    }
}
