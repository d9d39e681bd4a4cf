//! Scalar fields at the vertices, shown as colors.

use crate::prepared_shape::{PreparedShape, analysis_operator, build_decomposer};
use crate::response::{
    ApiError, ApiResult, bytes_response, bytes_response_with_header, encode_f32, encode_rows, json_response,
};
use crate::session::Session;
use adwave::bands::BandsParams;
use adwave::features::{
    Feature, FeatureParams, ShapeCoordinates, coordinate_features, feature_extent, features,
};
use adwave::operator::OperatorKind;
use adwave::saliency::saliency_f32;
use adwave::signal::SurfaceSignal;
use adwave::{LevelSpec, Progress};
use adwave_io::{Field, ShapeFile, SignalSource, mark_unknown, named_signal, region_field};
use serde_json::{Value, json};
use std::collections::HashSet;

/// Origin of a field, which determines the actions that the page offers for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FieldOrigin {
    /// Computed from the edited shape.
    EditedShape,
    /// Computed from the bands of the original shape.
    Bands,
    /// Values of the file or of an added file, which can be edited.
    Editable,
    /// Values of the file or of an added file that are labels, or missing everywhere.
    Fixed,
    /// One channel of a field of the file that has several.
    Channel,
    /// Colors of the file, which have no single value per vertex.
    Colors,
}

/// Description of a field for the page.
#[derive(Clone, Debug)]
pub(crate) struct FieldInfo {
    name: String,
    label: String,
    unit: String,
    origin: FieldOrigin,
    diverging: bool,
    series: Option<FieldSeries>,
}

/// Series that a field is a frame of; its frames are listed in order.
#[derive(Clone, Debug, PartialEq)]
struct FieldSeries {
    name: String,
    /// Seconds from one frame to the next, if the file says so.
    step: Option<f64>,
}

impl FieldInfo {
    fn new(name: &str, label: &str, unit: &str, origin: FieldOrigin) -> Self {
        let (name, label, unit) = (name.to_owned(), label.to_owned(), unit.to_owned());
        Self { name, label, unit, origin, diverging: false, series: None }
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// True if the values are computed from the shape.
    pub(crate) fn is_computed(&self) -> bool {
        matches!(self.origin, FieldOrigin::EditedShape | FieldOrigin::Bands)
    }

    /// Returns the description of the field for the list of fields of a shape.
    pub(crate) fn to_json(&self) -> Value {
        json!({
            "name": self.name,
            "label": self.label,
            "unit": self.unit,
            "edited": self.origin == FieldOrigin::EditedShape,
            "rgb": self.origin == FieldOrigin::Colors,
            "editable": self.origin == FieldOrigin::Editable,
            "channel": self.origin == FieldOrigin::Channel,
            "series": self.series.as_ref().map(|series| json!({"name": series.name, "step": series.step})),
        })
    }
}

/// Lists the fields of a shape.
pub(crate) fn list_fields(session: &Session, n_levels: usize) -> Vec<FieldInfo> {
    use FieldOrigin::{Bands, Colors, Editable, EditedShape, Fixed};
    let mut fields = Vec::new();
    if session.shape.points().is_some() {
        fields.push(FieldInfo::new("change", "Displacement", "model units", EditedShape));
    }
    if !session.shape.is_graph() {
        fields.extend(fields_of_surfaces(session.shape.is_cloud()));
    }
    if session.shape.points().is_some() {
        fields.extend((1..=n_levels).map(|level| {
            let (name, label) = (format!("band-{level}"), format!("Size of band {level}"));
            FieldInfo::new(&name, &label, "model units", Bands)
        }));
    }
    let (file, uneditable) = (session.file(), session.uneditable_fields());
    let computed: HashSet<String> = fields.iter().map(|field| field.name.clone()).collect();
    let first = fields.len();
    for stored in file.vertex_fields() {
        if stored.n_channels == 1 {
            if !computed.contains(&stored.name) {
                let origin = if uneditable.contains(&stored.name) { Fixed } else { Editable };
                fields.push(FieldInfo::new(&stored.name, &stored.name, "", origin));
            }
        } else if !GEOMETRIC.contains(&stored.name.as_str()) {
            fields.extend((1..=stored.n_channels).map(|c| {
                let name = format!("{} {c}", stored.name);
                FieldInfo::new(&name, &name, "", FieldOrigin::Channel)
            }));
        }
    }
    join_series(&mut fields[first..], &file);
    if file.field("color").is_some_and(|color| matches!(color.n_channels, 3 | 4)) {
        fields.push(FieldInfo::new("color", "Colors of the file", "", Colors));
    }
    fields
}

/// Lists the fields that are computed from the normals of a surface or a cloud.
fn fields_of_surfaces(is_cloud: bool) -> Vec<FieldInfo> {
    let edited = |name: &str, label: &str, unit: Option<&str>| {
        FieldInfo::new(name, label, unit.unwrap_or(""), FieldOrigin::EditedShape)
    };
    let mut fields = vec![FieldInfo { diverging: true, ..edited("saliency", "Saliency", None) }];
    for kind in [SurfaceSignal::MeanCurvature, SurfaceSignal::GaussianCurvature, SurfaceSignal::ShapeIndex] {
        let info = edited(kind.name(), &sentence_case(kind.name()), kind.unit());
        fields.push(FieldInfo { diverging: true, ..info });
    }
    if is_cloud {
        fields.push(edited("density", "Density", SurfaceSignal::Density.unit()));
    }
    fields
}

/// Fields of several channels that belong to the geometry or to its look.
const GEOMETRIC: [&str; 4] = ["color", "normal", "texcoord", "tangent"];

/// Splits the number off the end of a name such as `bold 12`, with what separates them.
fn split_number(name: &str) -> Option<(&str, usize)> {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = name[stem.len()..].parse().ok()?;
    (!stem.is_empty()).then_some((stem, number))
}

/// Marks the fields whose names differ in a number that counts up from 0 or 1 as frames of a series.
fn join_series(fields: &mut [FieldInfo], file: &ShapeFile) {
    let mut start = 0;
    while start < fields.len() {
        let numbered = split_number(&fields[start].name).filter(|(_, number)| *number <= 1);
        let Some((stem, number)) = numbered.map(|(stem, number)| (stem.to_owned(), number)) else {
            start += 1;
            continue;
        };
        let is_next = |k: usize| split_number(&fields[k].name) == Some((stem.as_str(), number + k - start));
        let end = (start..fields.len()).find(|&k| !is_next(k)).unwrap_or(fields.len());
        let name = stem.trim_end_matches([' ', '_', '-', '.', ':']);
        let stored = file.field(name).or_else(|| file.field(&fields[start].name));
        let series = FieldSeries {
            name: if name.is_empty() { stem.clone() } else { name.to_owned() },
            step: stored.and_then(|field| field.frame_step),
        };
        if end > start + 1 {
            for field in &mut fields[start..end] {
                field.series = Some(series.clone());
            }
        }
        start = end;
    }
}

/// Values of a stored field of one channel, or of one channel of another, whose name is followed by the number of the
/// channel; unknown values are NaN. `None` if there is no such field.
fn stored_values(file: &ShapeFile, name: &str) -> Option<Vec<f64>> {
    let single = file.field(name).filter(|field| field.n_channels == 1).map(|field| (field, 0));
    let channel = || {
        let (stem, channel) = name.rsplit_once(' ')?;
        let (field, channel) = (file.field(stem)?, channel.parse::<usize>().ok()?);
        channel.checked_sub(1).filter(|&c| c < field.n_channels).map(|c| (field, c))
    };
    let (field, c) = single.or_else(channel)?;
    let mut values: Vec<f64> = (0..field.len()).map(|x| field.get(x, c)).collect();
    mark_unknown(&mut values, 1);
    Some(values)
}

/// Largest number of values in a sample of a series.
const SERIES_SAMPLE: usize = 1 << 16;

/// Responds with a sample of the values of all frames of a series, `f32`, with the least and the greatest of all. The
/// frames share the range of colors that is chosen from it.
pub(crate) fn series_response(session: &Session, name: &str) -> ApiResult {
    let known = list_fields(session, 0);
    let series = known.iter().find(|field| field.name == name).and_then(|field| field.series.clone());
    let Some(series) = series else {
        return Err(ApiError::bad_request(format!(
            "'{name}' is no frame of a series; see `series` in `fields` of the shape"
        )));
    };
    let file = session.file();
    let frames: Vec<_> = known.iter().filter(|field| field.series.as_ref() == Some(&series)).collect();
    let step = (frames.len() * session.points().len()).div_ceil(SERIES_SAMPLE).max(1);
    let (mut sample, mut low, mut high) = (Vec::new(), f64::INFINITY, f64::NEG_INFINITY);
    let mut place = 0;
    for frame in frames {
        for value in stored_values(&file, &frame.name).unwrap_or_default() {
            if value.is_finite() {
                (low, high) = (low.min(value), high.max(value));
            }
            if place % step == 0 {
                sample.push(value);
            }
            place += 1;
        }
    }
    sample.extend([low, high].iter().filter(|value| value.is_finite()));
    Ok(bytes_response(encode_f32(sample.len(), |k| sample[k] as f32)))
}

/// Encodes colors as `u8 × 4 × n`.
fn encode_colors(colors: &Field) -> Vec<u8> {
    let (values, n_channels) = (colors.to_f64(), colors.n_channels);
    let factor = 255.0 / colors.full_intensity();
    encode_rows(values.len() / n_channels, 4, |x, rgba| {
        for c in 0..3 {
            rgba[c] = (factor * values[n_channels * x + c]).round().clamp(0.0, 255.0) as u8;
        }
        rgba[3] = u8::MAX;
    })
}

/// Converts a name such as `mean-curvature` to a label such as `Mean curvature`.
fn sentence_case(name: &str) -> String {
    let label = name.replace('-', " ");
    let mut letters = label.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Responds with the values of a field, `f32 × n`, and its description in the header `X-Field`.
pub(crate) fn field_response(session: &Session, name: &str) -> ApiResult {
    let prepared = session.lock_prepared()?;
    let known = list_fields(session, prepared.bands.n_levels());
    let Some(info) = known.iter().find(|field| field.name == name) else {
        return Err(ApiError::bad_request(format!(
            "the shape has no field '{name}'; see `fields` of the shape"
        )));
    };
    let n = session.points().len();
    let band = name.strip_prefix("band-").and_then(|level| level.parse::<usize>().ok());
    let content = if info.origin == FieldOrigin::Colors {
        session.file().field(name).map(encode_colors).unwrap_or_default()
    } else if name == "change" {
        let (before, after) = (session.points(), &prepared.points);
        encode_f32(n, |x| norm((0..3).map(|c| after[x][c] - before[x][c])))
    } else if let Some(level) = band.filter(|&j| (1..=prepared.bands.n_levels()).contains(&j)) {
        let map = prepared.bands.decomposer.vertex_map();
        let rows: &[[f64; 3]] = prepared.bands.editor().wavelets().levels[level - 1].as_chunks().0;
        encode_f32(n, |x| norm(rows[map.welded(x)].into_iter()))
    } else if let Some(values) = stored_values(&session.file(), name).filter(|_| !info.is_computed()) {
        encode_f32(n, |x| values[x] as f32)
    } else if name == "saliency" {
        let saliency = compute_saliency(session, &prepared)?;
        encode_f32(n, |x| saliency[x])
    } else {
        let file = session.edited_file(&prepared)?;
        drop(prepared);
        let shape = file.to_shape_as(file.kind()).map_err(|e| ApiError::bad_request(e.to_string()))?;
        let source = SignalSource { file: &file, shape: &shape, name: &session.workspace.name };
        let signal = named_signal(source, name, None).map_err(|e| ApiError::from_classified(&e))?;
        encode_f32(n, |x| signal.values[x] as f32)
    };
    let description = json!({"label": info.label, "unit": info.unit, "diverging": info.diverging});
    Ok(bytes_response_with_header(content, "x-field", &description))
}

/// Responds with a field in the form that regions use: computed on the original shape, with its own dyadic levels.
pub(crate) fn region_field_response(session: &Session, name: &str) -> ApiResult {
    let prepared = session.lock_prepared()?;
    let known = list_fields(session, prepared.bands.n_levels());
    let field = region_field(&session.file(), &prepared.bands.decomposer, name);
    let (Some(info), Some((1, values))) = (known.iter().find(|field| field.name == name), field) else {
        return Err(ApiError::bad_request(format!(
            "the shape has no field '{name}' with one value per vertex"
        )));
    };
    let content = encode_f32(values.len(), |x| values[x] as f32);
    let description = json!({"label": info.label, "unit": info.unit, "diverging": info.diverging});
    Ok(bytes_response_with_header(content, "x-field", &description))
}

fn norm(components: impl Iterator<Item = f64>) -> f32 {
    components.map(|c| c * c).sum::<f64>().sqrt() as f32
}

/// Largest relative error of the bands from which a saliency map is computed. The error of the map is then less than
/// one of its 256 color steps; for the built-in creature it is a tenth of a step, at 50 000 and at a million vertices.
const COLOR_ACCURACY: f64 = 3e-3;

/// Computes the saliency of the edited positions with the diffusion of the original shape, at the accuracy of colors.
fn compute_saliency(session: &Session, prepared: &PreparedShape) -> Result<Vec<f32>, ApiError> {
    let decomposer = &prepared.bands.decomposer;
    let request = decomposer
        .request(prepared.points.as_flattened(), 3, &prepared.bands.schedule)
        .accuracy(COLOR_ACCURACY);
    let outward = prepared.outward_normals(&session.file())?;
    let has_outside = outward.info.has_outside();
    let wavelets =
        if has_outside { request.normal_components_in_one_pass(&outward.normals) } else { request.norms() };
    let wavelets = wavelets.map_err(|e| ApiError::from_classified(&e))?;
    saliency_f32(decomposer, &wavelets, Progress::none()).map_err(|e| ApiError::from_classified(&e))
}

/// Features of a shape as `adwave features` finds them; with `theta` those of Algorithm 2 on a mesh.
fn find_features(
    file: &ShapeFile,
    theta: Option<f64>,
    progress: Progress<'_>,
) -> Result<Vec<Feature>, ApiError> {
    let params = FeatureParams::default().with_theta(theta);
    params.check().map_err(|e| ApiError::from_classified(&e))?;
    let shape = file.to_shape_as(file.kind()).map_err(|e| ApiError::bad_request(e.to_string()))?;
    let kind = if theta.is_none() { analysis_operator(&shape) } else { OperatorKind::Walk };
    let decomposer = build_decomposer(&shape, kind, progress)?;
    let levels = LevelSpec::Default.resolve(&decomposer, feature_extent(&decomposer));
    let schedule = levels.map_err(|e| ApiError::from_classified(&e))?.schedule;
    let points = shape.points().unwrap_or_default();
    if params.finds_significant(&decomposer) {
        let normals = adwave_io::file_normals(file);
        let bands = BandsParams::default().with_accuracy(decomposer.analysis_accuracy());
        let coordinates =
            ShapeCoordinates { points, normals: normals.as_deref(), schedule: &schedule, bands };
        let found = coordinate_features(&decomposer, &coordinates, &params, progress);
        return Ok(found.map_err(|e| ApiError::from_classified(&e))?.features);
    }
    let norms = decomposer.request(points.as_flattened(), 3, &schedule).progress(progress).norms();
    let norms = norms.map_err(|e| ApiError::from_classified(&e))?;
    features(&decomposer, &norms, &params, progress).map_err(|e| ApiError::from_classified(&e))
}

/// Responds with the features of the edited shape. Their `level` is the band of the equalizer that is as wide.
pub(crate) fn feature_response(session: &Session, theta: Option<f64>) -> ApiResult {
    let (file, sigmas) = {
        let prepared = session.lock_prepared()?;
        (session.edited_file(&prepared)?, prepared.bands.sigmas())
    };
    let list = find_features(&file, theta, session.progress())?;
    let points = file.points();
    let level = |sigma: f64| {
        let away = |j: &usize| (sigma / sigmas[*j]).ln().abs();
        1 + (0..sigmas.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
    };
    let center = session.center;
    let rows: Vec<_> = list
        .iter()
        .map(|f| {
            let point = points[f.vertex];
            let position: [f64; 3] = std::array::from_fn(|c| point[c] - center[c]);
            json!({"vertex": f.vertex, "position": position, "level": level(f.sigma), "sigma": f.sigma,
                "strength": f.strength, "sign": f.sign()})
        })
        .collect();
    json_response(&rows)
}
