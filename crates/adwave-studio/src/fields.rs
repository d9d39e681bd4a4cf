//! Numbers at the vertices that the page shows as colors.

use crate::answer::{Answer, Refused, bytes_with, f32_bytes, json};
use crate::prepared::Prepared;
use crate::session::Session;
use adwave::Progress;
use adwave::features::{FeatureParams, features};
use adwave::saliency::saliency_f32;
use adwave::shape::Shape;
use adwave::signal::SurfaceSignal;
use adwave_io::{SignalSource, named_signal, region_field};
use serde::Serialize;
use serde_json::json;

/// A field as the page is told of it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct FieldInfo {
    name: String,
    label: String,
    unit: String,
    /// Whether it changes with the edit.
    edited: bool,
    #[serde(skip)]
    diverging: bool,
}

/// All that can be shown of a shape.
pub(crate) fn list(session: &Session, n_levels: usize) -> Vec<FieldInfo> {
    let field = |name: &str, label: &str, unit: &str, edited: bool, diverging: bool| FieldInfo {
        name: name.to_owned(),
        label: label.to_owned(),
        unit: unit.to_owned(),
        edited,
        diverging,
    };
    let mut all = vec![
        field("change", "distance moved", "model units", true, false),
        field("saliency", "saliency", "", true, true),
    ];
    for kind in [SurfaceSignal::MeanCurvature, SurfaceSignal::GaussianCurvature, SurfaceSignal::ShapeIndex] {
        let label = kind.name().replace('-', " ");
        all.push(field(kind.name(), &label, kind.unit().unwrap_or(""), true, true));
    }
    if matches!(session.opened.shape, Shape::Cloud(_)) {
        let unit = SurfaceSignal::Density.unit().unwrap_or("");
        all.push(field("density", "density", unit, true, false));
    }
    for level in 1..=n_levels {
        all.push(field(&format!("band-{level}"), &format!("|W{level}|"), "model units", false, false));
    }
    for own in session.opened.file.vertex_fields().iter().filter(|own| own.n_channels == 1) {
        if !all.iter().any(|known| known.name == own.name) {
            all.push(field(&own.name, &own.name, "", false, false));
        }
    }
    all
}

/// The values of a field.
pub(crate) fn values(session: &Session, name: &str) -> Answer {
    let prepared = session.prepared()?;
    let known = list(session, prepared.n_levels());
    let Some(info) = known.iter().find(|field| field.name == name) else {
        return Err(Refused::wrong(format!("there is no field '{name}'")));
    };
    let n = session.points().len();
    let band = name.strip_prefix("band-").and_then(|level| level.parse::<usize>().ok());
    let content = if name == "change" {
        let (before, after) = (session.points(), &prepared.points);
        f32_bytes(n, |x| length((0..3).map(|c| after[x][c] - before[x][c])))
    } else if let Some(level) = band.filter(|&j| (1..=prepared.n_levels()).contains(&j)) {
        let map = prepared.decomposer.geometry().vertex_map();
        let rows: &[[f64; 3]] = prepared.editor.wavelets().levels[level - 1].as_chunks().0;
        f32_bytes(n, |x| length(rows[map.welded(x)].into_iter()))
    } else if name == "saliency" {
        let map = salient(session, &prepared)?;
        f32_bytes(n, |x| map[x])
    } else {
        let file = if info.edited { session.edited_file(&prepared)? } else { session.opened.file.clone() };
        drop(prepared);
        let shape = file.to_shape_as(file.kind()).map_err(|e| Refused::wrong(e.to_string()))?;
        let source = SignalSource { file: &file, shape: &shape, name: &session.opened.name };
        let signal = named_signal(source, name, None).map_err(|e| Refused::of(&e))?;
        f32_bytes(n, |x| signal.values[x] as f32)
    };
    let about = json!({"label": info.label, "unit": info.unit, "diverging": info.diverging});
    Ok(bytes_with(content, "x-field", &about.to_string()))
}

/// The same as a region sees it: of the shape as it was opened, with levels of its own.
pub(crate) fn as_region(session: &Session, name: &str) -> Answer {
    let prepared = session.prepared()?;
    let known = list(session, prepared.n_levels());
    let found = region_field(&session.opened.file, &prepared.decomposer, name);
    let (Some(info), Some((1, values))) = (known.iter().find(|field| field.name == name), found) else {
        return Err(Refused::wrong(format!("there is no field '{name}' with one number a vertex")));
    };
    let content = f32_bytes(values.len(), |x| values[x] as f32);
    let about = json!({"label": info.label, "unit": info.unit, "diverging": info.diverging});
    Ok(bytes_with(content, "x-field", &about.to_string()))
}

fn length(parts: impl Iterator<Item = f64>) -> f32 {
    parts.map(|c| c * c).sum::<f64>().sqrt() as f32
}

/// Relative error of each band whose saliency is shown, at most: a map is then off by less than a step of its colors, of which there are
/// 256, and of the built-in creature by a tenth of one, at 50 000 and at a million vertices.
const SHOWN: f64 = 3e-3;

/// The saliency of the edited positions, by the diffusion of the shape as it was opened, as exact as colors show it.
fn salient(session: &Session, prepared: &Prepared) -> Result<Vec<f32>, Refused> {
    let decomposer = &prepared.decomposer;
    let request = decomposer.request(prepared.points.as_flattened(), 3, &prepared.schedule).accuracy(SHOWN);
    let found = prepared.outward(&session.opened.file)?;
    let has_outside = found.info.has_outside();
    let wavelets =
        if has_outside { request.along_normals_in_one_pass(&found.normals) } else { request.norms() };
    let wavelets = wavelets.map_err(|e| Refused::of(&e))?;
    saliency_f32(decomposer, &wavelets, Progress::none()).map_err(|e| Refused::of(&e))
}

/// The features of the edited positions.
pub(crate) fn feature_list(session: &Session, theta: f64) -> Answer {
    let prepared = session.prepared()?;
    let params = FeatureParams { theta, ..FeatureParams::default() };
    params.check().map_err(|e| Refused::of(&e))?;
    let request = prepared.decomposer.request(prepared.points.as_flattened(), 3, &prepared.schedule);
    let norms = request.norms().map_err(|e| Refused::of(&e))?;
    let found =
        features(&prepared.decomposer, &norms, &params, Progress::none()).map_err(|e| Refused::of(&e))?;
    let center = session.center;
    let rows: Vec<_> = found
        .iter()
        .map(|f| {
            let at = prepared.points[f.vertex];
            let position: [f64; 3] = std::array::from_fn(|c| at[c] - center[c]);
            json!({"vertex": f.vertex, "position": position, "level": f.level, "sigma": f.sigma,
                "strength": f.strength, "sign": f.sign()})
        })
        .collect();
    json(&rows)
}
