//! Words of options as the crates' enums.

use crate::error::value;
use adwave::denoise::Creases;
use adwave::features::Response;
use adwave::operator::{CloudGraph, OperatorKind, OperatorParams};
use adwave::positions::{Borders, MoveDirection, Volume};
use adwave::region::Length;
use adwave::saliency::Weighting;
use adwave::shape::{CloudArea, MeshArea, WeldMode};
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
pub(crate) const ALONG: &[(&str, MoveDirection)] = &[
    ("free", MoveDirection::Free),
    ("normal", MoveDirection::Normal),
    ("surface", MoveDirection::Surface),
    ("x", MoveDirection::X),
    ("y", MoveDirection::Y),
    ("z", MoveDirection::Z),
];
pub(crate) const BORDERS: &[(&str, Borders)] =
    &[("natural", Borders::Natural), ("keep", Borders::Keep), ("free", Borders::Free)];
pub(crate) const VOLUME: &[(&str, Volume)] = &[("free", Volume::Free), ("keep", Volume::Keep)];
pub(crate) const CREASES: &[(&str, Creases)] =
    &[("auto", Creases::Auto), ("keep", Creases::Keep), ("none", Creases::None)];
pub(crate) const RESPONSES: &[(&str, Response)] = &[
    ("normalized", Response::Normalized),
    ("literal", Response::Literal),
    ("channels", Response::Channels),
    ("sigma", Response::Sigma),
];
/// `None` is the map with a sign.
pub(crate) const WEIGHTINGS: &[(&str, Option<Weighting>)] = &[
    ("signed", None),
    ("paper", Some(Weighting::PerLevel)),
    ("printed", Some(Weighting::AsPrinted)),
    ("normalized", Some(Weighting::Normalized)),
    ("ranks", Some(Weighting::Ranks)),
    ("none", Some(Weighting::Uniform)),
];
const OPERATORS: &[(&str, OperatorKind)] =
    &[("walk", OperatorKind::Walk), ("surface", OperatorKind::Surface)];
const MESH_AREAS: &[(&str, MeshArea)] =
    &[("barycentric", MeshArea::Barycentric), ("mixed-voronoi", MeshArea::MixedVoronoi)];
const CLOUD_AREAS: &[(&str, CloudArea)] = &[
    ("kth-neighbor", CloudArea::KthNeighbor),
    ("unit", CloudArea::Unit),
    ("tangent-voronoi", CloudArea::TangentVoronoi),
];

/// How the diffusion operator is built.
pub(crate) fn operator(options: &Bound<'_, PyDict>) -> PyResult<OperatorParams> {
    let mut params = OperatorParams::default();
    for (name, given) in options {
        let name: String = name.extract()?;
        params = match name.as_str() {
            "operator" => params.with_kind(word(&name, &given.extract::<String>()?, OPERATORS)?),
            "weld" => {
                params.with_weld(if given.extract()? { WeldMode::EqualPositions } else { WeldMode::Off })
            }
            "rings" => params.with_rings(at_least_one(&name, &given)?),
            "mesh_area" => params.with_mesh_area(word(&name, &given.extract::<String>()?, MESH_AREAS)?),
            "neighbors" => params.with_neighbors(at_least_one(&name, &given)?),
            "directed" => params.with_cloud_graph(if given.extract()? {
                CloudGraph::Directed
            } else {
                CloudGraph::Union
            }),
            "cloud_area" => params.with_cloud_area(word(&name, &given.extract::<String>()?, CLOUD_AREAS)?),
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
