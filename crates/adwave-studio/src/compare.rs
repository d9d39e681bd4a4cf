//! The shape after another method, as smooth as the edit makes it.
//!
//! Smoothness is the root mean square of `|f(x) − mean of f over the neighbors of x|` with the walk's weights, in model units: small for a smooth
//! surface, and falling with the strength of every low-pass filter. The strength of the other method is searched for until it is that
//! of the edit.

use crate::answer::{Answer, Refused, bytes_with, points_bytes};
use crate::session::Session;
use adwave::Decomposer;
use adwave::filter::displacement;
use adwave_baselines::differential::Differential;
use adwave_baselines::harmonics::{Harmonics, Remainder};
use adwave_baselines::laplacian::{Laplacian, LaplacianParams};
use adwave_baselines::linalg::EigenParams;
use adwave_baselines::taubin::WindowedSinc;
use serde::Deserialize;
use serde_json::{Value, json};

/// The other method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Method {
    /// Taubin's windowed sinc, with the gain ½ at the frequency that is searched for.
    Taubin,
    /// Manifold harmonics with the gain e^(−λt) of heat, t searched for.
    Harmonics,
}

/// What is asked for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CompareAsked {
    pub(crate) method: Method,
}

/// Harmonics that are computed.
const N_HARMONICS: usize = 200;
/// Vertices up to which they are: their cost grows with n^1.5.
const MOST_HARMONICS: usize = 50_000;
/// Vertices up to which Taubin's filter is searched for: some 15 filters of up to 400 products.
const MOST_TAUBIN: usize = 500_000;
/// Halvings of the range of the strength.
const HALVINGS: usize = 16;
/// Products of a filter at the most.
const MOST_PRODUCTS: f64 = 400.0;

/// The positions of the other method, and how both compare.
pub(crate) fn compare(
    session: &Session,
    method: Method,
    edited: &[[f64; 3]],
    decomposer: &Decomposer,
) -> Answer {
    let n = session.points().len();
    let (name, most) = match method {
        Method::Taubin => ("Taubin's filter", MOST_TAUBIN),
        Method::Harmonics => ("manifold harmonics", MOST_HARMONICS),
    };
    if n > most {
        let told = "`adwave simplify` makes a shape of fewer";
        return Err(Refused::wrong(format!(
            "{n} vertices are more than the {most} that {name} are computed for here; {told}"
        )));
    }
    let original = session.points();
    let differential =
        Differential::from_walk(decomposer.diffusion(), decomposer.geometry().vertex_map().clone());
    let roughness = |points: &[[f64; 3]]| -> Result<f64, Refused> {
        let away = differential.coordinates(points.as_flattened(), 3).map_err(|e| Refused::of(&e))?;
        Ok((away.iter().map(|c| c * c).sum::<f64>() / n.max(1) as f64).sqrt())
    };
    let (before, wanted) = (roughness(original)?, roughness(edited)?);
    if wanted >= before || before == 0.0 {
        return Err(Refused::wrong(format!(
            "the edit does not smooth the shape: a vertex is {} from the mean of its neighbors after it, {} before, and {name} can only smooth; \
             lower some sliders first",
            digits(wanted),
            digits(before)
        )));
    }
    let signal = original.as_flattened();
    let found = match method {
        Method::Taubin => search((1e-5, 1.9), wanted, roughness, |frequency| {
            let narrow = (1.0 - frequency / 2.0).acos();
            let degree = (8.0 / narrow).ceil().clamp(10.0, MOST_PRODUCTS) as usize;
            let filter = WindowedSinc::half_gain(frequency, degree).map_err(|e| Refused::of(&e))?;
            let filtered = filter.apply(&differential, signal, 3).map_err(|e| Refused::of(&e))?;
            Ok((filtered, json!({"degree": degree, "frequency": frequency})))
        })?,
        Method::Harmonics => {
            let laplacian = Laplacian::new(&session.opened.shape, &LaplacianParams::default());
            let laplacian = laplacian.map_err(|e| Refused::of(&e))?;
            let made = Harmonics::new(&laplacian, N_HARMONICS, &EigenParams::default(), session.progress());
            let harmonics = made.map_err(|e| Refused::of(&e))?;
            let unit = decomposer.mean_length().powi(2);
            let n_harmonics = harmonics.len();
            // Rising strength is falling roughness: the search is by 1/t.
            search((1e-6, 1e4), wanted, roughness, |inverse| {
                let t = unit / inverse;
                let heat = |frequency: f64| (-frequency * frequency * t).exp();
                let filtered = harmonics.filter(signal, 3, heat, Remainder::LastGain);
                Ok((filtered.map_err(|e| Refused::of(&e))?, json!({"harmonics": n_harmonics, "t": t})))
            })?
        }
    };
    let Found { points, how, roughness } = found;
    let moved = |points: &[[f64; 3]]| displacement(original, points).rms;
    let about = json!({
        "how": how,
        "roughness": {"before": before, "edit": wanted, "other": roughness},
        "rms": {"edit": moved(edited), "other": moved(&points)},
    });
    Ok(bytes_with(points_bytes(&points, session.center), "x-compare", &about.to_string()))
}

struct Found {
    points: Vec<[f64; 3]>,
    /// The strength that was found.
    how: Value,
    roughness: f64,
}

/// Halves a range of strengths on a logarithmic scale; the roughness rises with the strength.
fn search(
    (mut low, mut high): (f64, f64),
    wanted: f64,
    roughness: impl Fn(&[[f64; 3]]) -> Result<f64, Refused>,
    apply: impl Fn(f64) -> Result<(Vec<f64>, Value), Refused>,
) -> Result<Found, Refused> {
    let mut best: Option<Found> = None;
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        let (values, how) = apply(middle)?;
        let points: Vec<[f64; 3]> = values.as_chunks().0.to_vec();
        let found = roughness(&points)?;
        if found > wanted {
            high = middle;
        } else {
            low = middle;
        }
        let is_nearer = |best: &Found| (found - wanted).abs() < (best.roughness - wanted).abs();
        if best.as_ref().is_none_or(is_nearer) {
            best = Some(Found { points, how, roughness: found });
        }
    }
    best.ok_or_else(|| Refused::wrong("no strength was tried"))
}

fn digits(value: f64) -> String {
    adwave_report::digits(value)
}
