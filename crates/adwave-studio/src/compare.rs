//! Comparison of the edit with another smoothing method of equal roughness.
//!
//! Roughness is the root mean square of `|f(x) − mean of f over the neighbors of x|` with the weights of the walk
//! operator, in model units. It is small for a smooth surface and falls with the strength of every low-pass filter. The
//! strength of the other method is found by bisection, so that its roughness equals that of the edit.

use crate::response::{ApiError, ApiResult, bytes_response_with_header, encode_points};
use crate::session::Session;
use adwave::Decomposer;
use adwave::filter::displacement;
use adwave_baselines::differential::Differential;
use adwave_baselines::harmonics::{Harmonics, Remainder};
use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
use adwave_baselines::linalg::EigenParams;
use adwave_baselines::taubin::WindowedSinc;
use serde::Deserialize;
use serde_json::{Value, json};

/// Smoothing method with which the edit is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Method {
    /// Taubin's windowed sinc filter; the search varies the frequency at which its gain is ½.
    Taubin,
    /// Manifold harmonics with the heat kernel e^(−λt) as gain; the search varies t.
    Harmonics,
}

/// Body of `POST compare`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CompareRequest {
    pub(crate) method: Method,
}

/// Number of harmonics that are computed.
const N_HARMONICS: usize = 200;
/// Largest number of vertices for manifold harmonics, whose cost grows with n^1.5.
const MAX_VERTICES_HARMONICS: usize = 50_000;
/// Largest number of vertices for Taubin's filter: the search applies 16 filters of up to 400 sparse products.
const MAX_VERTICES_TAUBIN: usize = 500_000;
/// Number of bisection steps over the range of strengths.
const N_BISECTIONS: usize = 16;
/// Largest degree of a filter, in sparse products.
const MAX_DEGREE: f64 = 400.0;

/// Computes the positions of the other method and the figures of the comparison.
pub(crate) fn compare(
    session: &Session,
    method: Method,
    edited: &[[f64; 3]],
    decomposer: &Decomposer,
) -> ApiResult {
    let n = session.points().len();
    let (name, max_vertices) = match method {
        Method::Taubin => ("comparison with Taubin's filter", MAX_VERTICES_TAUBIN),
        Method::Harmonics => ("comparison with manifold harmonics", MAX_VERTICES_HARMONICS),
    };
    if n > max_vertices {
        return Err(ApiError::bad_request(format!(
            "{name} supports up to {max_vertices} vertices here, got {n}; reduce the shape with `adwave simplify`"
        )));
    }
    let original = session.points();
    let rows = decomposer.rows("a comparison").map_err(|e| ApiError::from_classified(&e))?;
    let differential = Differential::from_diffusion(rows, decomposer.vertex_map().clone());
    let roughness = |points: &[[f64; 3]]| -> Result<f64, ApiError> {
        let offsets =
            differential.coordinates(points.as_flattened(), 3).map_err(|e| ApiError::from_classified(&e))?;
        Ok((offsets.iter().map(|c| c * c).sum::<f64>() / n.max(1) as f64).sqrt())
    };
    let (before, target) = (roughness(original)?, roughness(edited)?);
    if target >= before || before == 0.0 {
        return Err(ApiError::bad_request(format!(
            "the edit must be smoother than the original to be compared: its roughness is {}, that of the original {}; \
             lower some gains below 1",
            format_length(target),
            format_length(before)
        )));
    }
    let signal = original.as_flattened();
    let matched = match method {
        Method::Taubin => {
            match_roughness(&StrengthRange { low: 1e-5, high: 1.9 }, target, roughness, |frequency| {
                let narrow = (1.0 - frequency / 2.0).acos();
                let degree = (8.0 / narrow).ceil().clamp(10.0, MAX_DEGREE) as usize;
                let filter =
                    WindowedSinc::half_gain(frequency, degree).map_err(|e| ApiError::from_classified(&e))?;
                let filtered =
                    filter.apply(&differential, signal, 3).map_err(|e| ApiError::from_classified(&e))?;
                Ok((filtered, json!({"degree": degree, "frequency": frequency})))
            })?
        }
        Method::Harmonics => {
            let laplacian = LaplacianMatrices::new(&session.shape, &LaplacianParams::default());
            let laplacian = laplacian.map_err(|e| ApiError::from_classified(&e))?;
            let harmonics =
                Harmonics::new(&laplacian, N_HARMONICS, &EigenParams::default(), session.progress());
            let harmonics = harmonics.map_err(|e| ApiError::from_classified(&e))?;
            let unit = decomposer.mean_length().powi(2);
            let n_harmonics = harmonics.len();
            // Roughness must rise with the searched value, hence 1/t instead of t.
            match_roughness(&StrengthRange { low: 1e-6, high: 1e4 }, target, roughness, |inverse| {
                let t = unit / inverse;
                let heat = |frequency: f64| (-frequency * frequency * t).exp();
                let filtered = harmonics.filter(signal, 3, heat, Remainder::LastGain);
                Ok((
                    filtered.map_err(|e| ApiError::from_classified(&e))?,
                    json!({"harmonics": n_harmonics, "t": t}),
                ))
            })?
        }
    };
    let MatchedSmoothing { points, strength, roughness } = matched;
    let rms = |points: &[[f64; 3]]| displacement(original, points).rms;
    let summary = json!({
        "how": strength,
        "roughness": {"before": before, "edit": target, "other": roughness},
        "rms": {"edit": rms(edited), "other": rms(&points)},
    });
    Ok(bytes_response_with_header(encode_points(&points, session.center), "x-compare", &summary))
}

/// Bounds of the searched parameter of the other method.
struct StrengthRange {
    low: f64,
    high: f64,
}

/// Positions of the other method at the strength whose roughness is nearest to the target.
struct MatchedSmoothing {
    points: Vec<[f64; 3]>,
    /// Parameters of the method, as JSON for display.
    strength: Value,
    /// Roughness in model units.
    roughness: f64,
}

/// Bisects a range on a logarithmic scale until the roughness is `target`; the roughness must rise over the range.
fn match_roughness(
    range: &StrengthRange,
    target: f64,
    roughness: impl Fn(&[[f64; 3]]) -> Result<f64, ApiError>,
    apply: impl Fn(f64) -> Result<(Vec<f64>, Value), ApiError>,
) -> Result<MatchedSmoothing, ApiError> {
    let &StrengthRange { mut low, mut high } = range;
    let mut best: Option<MatchedSmoothing> = None;
    for _ in 0..N_BISECTIONS {
        let middle = (low * high).sqrt();
        let (values, strength) = apply(middle)?;
        let points: Vec<[f64; 3]> = values.as_chunks().0.to_vec();
        let reached = roughness(&points)?;
        if reached > target {
            high = middle;
        } else {
            low = middle;
        }
        let is_nearer = |best: &MatchedSmoothing| (reached - target).abs() < (best.roughness - target).abs();
        if best.as_ref().is_none_or(is_nearer) {
            best = Some(MatchedSmoothing { points, strength, roughness: reached });
        }
    }
    best.ok_or_else(|| ApiError::bad_request("no strength was tried"))
}

fn format_length(value: f64) -> String {
    adwave_report::digits(value)
}
