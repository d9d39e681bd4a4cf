//! Options as they come from the Python classes. Their words are those of the crates.

use crate::error::{self, value_error};
use adwave::bands::{BandsParams, FWHM, Schedule, ScheduleError};
use adwave::filter::Preset;
use adwave::operator::{CloudGraph, EndPoints, Masses, OperatorParams};
use adwave::positions::PositionParams;
use adwave::region::Length;
use adwave::shape::{CloudArea, MeshArea, WeldMode};
use adwave::{Decomposer, NamedValue};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

/// The value of a word of an option that only Python has.
pub(crate) fn word<T: Copy>(option: &str, given: &str, known: &[(&str, T)]) -> PyResult<T> {
    known.iter().find(|(name, _)| *name == given).map(|(_, found)| *found).ok_or_else(|| {
        let names: Vec<String> = known.iter().map(|(name, _)| format!("'{name}'")).collect();
        value_error(format!("{option} must be one of {}, got '{given}'", names.join(", ")))
    })
}

/// The value of an option by its name in the library.
pub(crate) fn parse_name<T: NamedValue>(option: &str, given: &str) -> PyResult<T> {
    let entries = T::ENTRIES.iter();
    let names = entries.flat_map(|entry| {
        std::iter::once(entry.name).chain(entry.alias).map(move |name| (name, entry.value))
    });
    word(option, given, &names.collect::<Vec<_>>())
}

const END_POINTS: &[(&str, EndPoints)] = &[("keep", EndPoints::Keep), ("free", EndPoints::Free)];

/// Rule of welding: on or off for vertices at equal or nearly equal positions, or a tolerance in model units.
#[derive(Clone, Copy, FromPyObject)]
pub(crate) enum WeldOption {
    Flag(bool),
    Tolerance(f64),
}

impl WeldOption {
    /// The rule in the form of the library.
    pub(crate) fn mode(self) -> PyResult<WeldMode> {
        match self {
            Self::Flag(true) => Ok(WeldMode::default()),
            Self::Flag(false) => Ok(WeldMode::Off),
            Self::Tolerance(0.0) => Ok(WeldMode::EqualPositions),
            Self::Tolerance(tolerance) if tolerance.is_finite() && tolerance > 0.0 => {
                Ok(WeldMode::Within(tolerance))
            }
            Self::Tolerance(tolerance) => Err(value_error(format!(
                "weld must be True, False or a length of at least 0, got {tolerance}"
            ))),
        }
    }
}

/// Options of the diffusion operator; `None` takes the library's default.
#[derive(FromPyObject)]
pub(crate) struct OperatorOptions {
    kind: Option<String>,
    weld: Option<WeldOption>,
    rings: Option<i64>,
    neighbors: Option<i64>,
    directed: Option<bool>,
    area: Option<String>,
    density_invariant: Option<bool>,
    keep_creases: Option<bool>,
    end_points: Option<String>,
    exact: Option<bool>,
}

impl OperatorOptions {
    /// Parameters of the operator.
    pub(crate) fn params(&self) -> PyResult<OperatorParams> {
        let mut params = OperatorParams::default();
        if let Some(kind) = &self.kind {
            params = params.with_kind(parse_name("operator", kind)?);
        }
        if let Some(weld) = self.weld {
            params = params.with_weld(weld.mode()?);
        }
        if let Some(rings) = self.rings {
            params = params.with_rings(parse_positive("rings", rings)?);
        }
        if let Some(neighbors) = self.neighbors {
            params = params.with_neighbors(parse_positive("neighbors", neighbors)?);
        }
        if let Some(directed) = self.directed {
            params = params.with_cloud_graph(if directed { CloudGraph::Directed } else { CloudGraph::Union });
        }
        if let Some(area) = &self.area {
            params = with_area(params, area)?;
        }
        if let Some(invariant) = self.density_invariant {
            params = params.with_density_invariant(invariant);
        }
        if let Some(keep) = self.keep_creases {
            params = params.with_keep_creases(keep);
        }
        if let Some(ends) = &self.end_points {
            params = params.with_end_points(word("end_points", ends, END_POINTS)?);
        }
        if self.exact == Some(true) {
            params = params.with_masses(Masses::Exact);
        }
        if params.density_invariant && params.cloud_graph == CloudGraph::Directed {
            return Err(value_error("density_invariant steps both ways; leave out directed"));
        }
        Ok(params)
    }
}

/// The area of a vertex of a mesh or of a point of a cloud; their names differ.
fn with_area(params: OperatorParams, name: &str) -> PyResult<OperatorParams> {
    if let Ok(area) = name.parse::<MeshArea>() {
        return Ok(params.with_mesh_area(area));
    }
    if let Ok(area) = name.parse::<CloudArea>() {
        return Ok(params.with_cloud_area(area));
    }
    let names: Vec<String> = MeshArea::ALL
        .iter()
        .map(|area| area.name())
        .chain(CloudArea::ALL.iter().map(|area| area.name()))
        .map(|name| format!("'{name}'"))
        .collect();
    Err(value_error(format!("area must be one of {}, got '{name}'", names.join(", "))))
}

fn parse_positive(name: &str, n: i64) -> PyResult<usize> {
    usize::try_from(n)
        .ok()
        .filter(|&n| n > 0)
        .ok_or_else(|| value_error(format!("{name} must be at least 1, got {n}")))
}

/// A signal with its levels and the accuracy of its bands. No signal stands for the coordinates.
#[derive(FromPyObject)]
pub(crate) struct BandsOptions<'py> {
    pub(crate) signal: Option<PyReadonlyArray2<'py, f64>>,
    pub(crate) steps: Vec<f64>,
    pub(crate) accuracy: f64,
    pub(crate) local_fit: String,
    pub(crate) precision: String,
}

impl BandsOptions<'_> {
    /// Accuracy and number format.
    pub(crate) fn params(&self) -> PyResult<BandsParams> {
        let precision = parse_name("precision", &self.precision)?;
        Ok(BandsParams::default().with_accuracy(self.accuracy).with_precision(precision))
    }
}

/// Levels: widths, dyadic levels with voices, or a number of dyadic levels.
#[derive(FromPyObject)]
pub(crate) enum LevelOptions<'py> {
    Widths {
        rms: Option<Vec<Bound<'py, PyAny>>>,
        fwhm: Option<Vec<Bound<'py, PyAny>>>,
    },
    Octaves {
        n_levels: usize,
        voices: usize,
    },
    #[pyo3(transparent)]
    Count(usize),
}

impl LevelOptions<'_> {
    /// Levels on a shape.
    pub(crate) fn schedule(&self, decomposer: &Decomposer) -> PyResult<Schedule> {
        let schedule = match self {
            Self::Widths { rms, fwhm } => {
                let divisor = if rms.is_some() { 1.0 } else { FWHM };
                let widths = rms.as_ref().or(fwhm.as_ref()).into_iter().flatten();
                let sigma = |given: &Bound<'_, PyAny>| {
                    let width = decomposer.model_units(width(given)?);
                    Ok(width.ok_or_else(|| error::to_exception(&ScheduleError::NoSphere))? / divisor)
                };
                let sigma: Vec<f64> = widths.map(sigma).collect::<PyResult<_>>()?;
                Schedule::lengths(&sigma, decomposer.operator().step_length())
            }
            Self::Octaves { n_levels, voices } => Schedule::voices(*n_levels, *voices),
            Self::Count(n) => Schedule::dyadic(*n),
        };
        schedule.map_err(|e| error::to_exception(&e))
    }
}

/// Constraints on positions after a filter.
#[derive(FromPyObject)]
pub(crate) struct ConstraintOptions {
    along: Option<String>,
    border: String,
    volume: String,
}

impl ConstraintOptions {
    /// Parameters of the constraints.
    pub(crate) fn params(&self) -> PyResult<PositionParams> {
        Ok(PositionParams::default()
            .with_along(self.along.as_ref().map(|along| parse_name("along", along)).transpose()?)
            .with_borders(parse_name("border", &self.border)?)
            .with_volume(parse_name("volume", &self.volume)?))
    }
}

/// Gains of a preset by its name.
pub(crate) fn preset_gains(name: &str, n_levels: usize) -> PyResult<Vec<f64>> {
    Ok(parse_name::<Preset>("preset", name)?.gains(n_levels))
}

/// Width of a level: a length, or an arc of a sphere such as `5deg`.
fn width(given: &Bound<'_, PyAny>) -> PyResult<Length> {
    match given.extract::<String>() {
        Ok(text) => Length::parse_width(&text).map_err(|e| value_error(format!("{e}"))),
        Err(_) => length(given),
    }
}

/// A length in model units, or a share of the diagonal such as `"2%"`.
pub(crate) fn length(given: &Bound<'_, PyAny>) -> PyResult<Length> {
    if let Ok(units) = given.extract::<f64>() {
        return Ok(Length::Units(units));
    }
    let text: String = given.extract()?;
    text.parse().map_err(|e| value_error(format!("{e}")))
}
