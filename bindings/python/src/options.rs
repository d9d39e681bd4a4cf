//! Words of options as the crates' enums.

use crate::error::value;
use adwave::NamedValue;
use adwave::operator::{CloudGraph, OperatorParams};
use adwave::region::Length;
use adwave::shape::WeldMode;
use adwave_io::ShapeKind;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// One of several words.
pub(crate) fn word<T: Copy>(option: &str, given: &str, known: &[(&str, T)]) -> PyResult<T> {
    known.iter().find(|(name, _)| *name == given).map(|(_, found)| *found).ok_or_else(|| {
        let names: Vec<String> = known.iter().map(|(name, _)| format!("'{name}'")).collect();
        value(format!("{option}: '{given}' is none of {}", names.join(", ")))
    })
}

pub(crate) const KINDS: &[(&str, ShapeKind)] =
    &[("mesh", ShapeKind::Mesh), ("cloud", ShapeKind::Cloud), ("graph", ShapeKind::Graph)];

/// The value of a name, in a message that says which option it was for.
pub(crate) fn named<T: NamedValue>(option: &str, given: &str) -> PyResult<T> {
    T::from_name(given).map_err(|_| {
        let names: Vec<String> = T::ENTRIES.iter().map(|entry| format!("'{}'", entry.name)).collect();
        value(format!("{option}: '{given}' is none of {}", names.join(", ")))
    })
}

/// How the diffusion operator is built.
pub(crate) fn operator(options: &Bound<'_, PyDict>) -> PyResult<OperatorParams> {
    let mut params = OperatorParams::default();
    for (name, given) in options {
        let name: String = name.extract()?;
        params = match name.as_str() {
            "operator" => params.with_kind(named(&name, &given.extract::<String>()?)?),
            "weld" => {
                params.with_weld(if given.extract()? { WeldMode::EqualPositions } else { WeldMode::Off })
            }
            "rings" => params.with_rings(at_least_one(&name, &given)?),
            "mesh_area" => params.with_mesh_area(named(&name, &given.extract::<String>()?)?),
            "neighbors" => params.with_neighbors(at_least_one(&name, &given)?),
            "directed" => params.with_cloud_graph(if given.extract()? {
                CloudGraph::Directed
            } else {
                CloudGraph::Union
            }),
            "cloud_area" => params.with_cloud_area(named(&name, &given.extract::<String>()?)?),
            "density_invariant" => params.with_density_invariant(given.extract()?),
            "keep_creases" => params.with_keep_creases(given.extract()?),
            _ => return Err(value(format!("{name}: there is no such option of the diffusion operator"))),
        };
    }
    if params.density_invariant && params.cloud_graph == CloudGraph::Directed {
        return Err(value("density_invariant steps both ways; leave out directed"));
    }
    Ok(params)
}

fn at_least_one(name: &str, given: &Bound<'_, PyAny>) -> PyResult<usize> {
    let n: i64 = given.extract()?;
    usize::try_from(n).ok().filter(|&n| n > 0).ok_or_else(|| value(format!("{name}: {n} is below 1")))
}

/// A length: a number in model units, or `"2%"` of the diagonal.
pub(crate) fn length(given: &Bound<'_, PyAny>) -> PyResult<Length> {
    if let Ok(units) = given.extract::<f64>() {
        return Ok(Length::Units(units));
    }
    let text: String = given.extract()?;
    text.parse().map_err(|e| value(format!("{e}")))
}
