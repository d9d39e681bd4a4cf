//! Two shapes brought together, and one with fewer vertices.

use crate::arrays;
use crate::call::run;
use crate::error::value;
use crate::measures::{Failure, Stage, stage};
use crate::options::length;
use crate::prepared::Prepared;
use crate::shape::ShapeData;
use adwave::Progress;
use adwave::shape::{Shape, surface_area};
use adwave::signal::outward_normals;
use adwave_io::Subset;
use adwave_register::{
    AlignInfo, AlignParams, Consensus, ConsensusParams, Described, Motion, PairParams, Surface, align,
    common_lengths, consensus, described, pairs_under, signed_distances,
};
use adwave_simplify::{Border, CloudTarget, MeshParams, MeshTarget, Why, simplify_cloud, simplify_mesh};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// How many times the mean response of its level a feature has that a motion is looked for by.
const THETA: f64 = 1.0;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(simplified, module)?)?;
    module.add_function(wrap_pyfunction!(matched, module)?)?;
    module.add_function(wrap_pyfunction!(distances, module)?)
}

/// The shape with fewer vertices, which are kept (none listed where all are), and the greatest and rms distance.
#[pyfunction]
#[pyo3(signature = (shape, error, vertices, ratio, keep_border, progress=None))]
fn simplified<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    error: Option<Bound<'py, PyAny>>,
    vertices: Option<usize>,
    ratio: Option<f64>,
    keep_border: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(ShapeData, Option<Bound<'py, PyAny>>, f64, f64)> {
    let content = shape.get();
    let own = content.shape(py)?;
    let error = error.as_ref().map(length).transpose()?.map(|error| error.to_model_units(own.diagonal()));
    let (file, kept, deviation) = match own {
        Shape::Mesh(mesh) => {
            let target = match (error, vertices) {
                (Some(error), _) => MeshTarget::Error(error),
                (_, Some(n)) => MeshTarget::Vertices(n),
                _ => MeshTarget::Ratio(ratio.unwrap_or(1.0)),
            };
            let border = if keep_border { Border::Kept } else { Border::Weighted };
            let labels = content.file.corner_labels();
            let params = MeshParams::new(target).with_border(border);
            let found = run(py, usize::MAX, progress.as_ref(), |p| {
                simplify_mesh(mesh, labels.as_deref(), &params, p)
            })?;
            if found.why == Why::Unchanged {
                (content.file.clone(), None, found.deviation)
            } else {
                let subset = Subset {
                    vertices: &found.kept,
                    triangles: &found.triangles,
                    faces: &found.faces,
                    corners: &found.corners,
                };
                let file = content.file.subset(&subset).map_err(|e| value(e.to_string()))?;
                (file, Some(found.kept), found.deviation)
            }
        }
        Shape::Cloud(cloud) => {
            let target = match (error, vertices) {
                (Some(error), _) => CloudTarget::Spacing(error),
                (_, Some(n)) => CloudTarget::Points(n),
                _ => CloudTarget::Ratio(ratio.unwrap_or(1.0)),
            };
            let found = run(py, usize::MAX, progress.as_ref(), |p| simplify_cloud(cloud, target, p))?;
            let subset = Subset { vertices: &found.kept, ..Subset::default() };
            let file = content.file.subset(&subset).map_err(|e| value(e.to_string()))?;
            (file, Some(found.kept), found.deviation)
        }
        Shape::Graph(_) => return Err(value("a graph has no surface; give a mesh or a cloud")),
    };
    let kept = kept.map(|kept| arrays::vector(py, kept).into_any());
    Ok((content.like(file), kept, deviation.greatest(), deviation.rms()))
}

/// Features of both shapes, the motion from the first to the second, and pairs.
#[pyfunction]
#[pyo3(signature = (first, second, theta, within, scaled, progress=None))]
fn matched<'py>(
    py: Python<'py>,
    first: &Bound<'py, Prepared>,
    second: &Bound<'py, Prepared>,
    theta: f64,
    within: f64,
    scaled: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (a, b) = (first.get(), second.get());
    let work = |p: Progress<'_>| -> Stage<_> {
        let (one, two, motion) = motion_between(a, b, theta, scaled, p)?;
        let other = &b.decomposer;
        let pairs = motion.as_ref().map_or_else(Vec::new, |(motion, _)| {
            let area = match other.geometry().triangles() {
                [] => other.areas().iter().sum(),
                triangles => surface_area(other.geometry().points(), triangles),
            };
            pairs_under(&one.keys, &two.keys, motion, area, &PairParams { sigmas: within })
        });
        Ok((one, two, motion, pairs))
    };
    let (one, two, motion, pairs) = run(py, usize::MAX, progress.as_ref(), work)?;
    let found = PyDict::new(py);
    found.set_item("n_features", (one.features.len(), two.features.len()))?;
    found.set_item("motion", motion.as_ref().map(|(motion, _)| matrix(py, motion)).transpose()?)?;
    found.set_item("median", motion.as_ref().map(|(_, info)| info.median))?;
    found.set_item("overlap", motion.as_ref().map(|(_, info)| info.overlap))?;
    let indices = |of: &dyn Fn(&adwave_register::Pair) -> usize| -> Vec<i64> {
        pairs.iter().map(|pair| of(pair) as i64).collect()
    };
    found.set_item("first", arrays::vector(py, indices(&|pair| one.features[pair.first].vertex)))?;
    found.set_item("second", arrays::vector(py, indices(&|pair| two.features[pair.second].vertex)))?;
    let numbers = |of: &dyn Fn(&adwave_register::Pair) -> f64| -> Vec<f64> { pairs.iter().map(of).collect() };
    found.set_item("sigma", arrays::vector(py, numbers(&|pair| one.features[pair.first].sigma)))?;
    found.set_item("distance", arrays::vector(py, numbers(&|pair| pair.sigmas)))?;
    found.set_item("confidence", arrays::vector(py, numbers(&|pair| pair.confidence)))?;
    Ok(found)
}

/// The features of two shapes, and the motion between them where one is clear.
type Brought = (Described, Described, Option<(Motion, AlignInfo)>);

/// Features of both shapes, and the motion from the first to the second that most of them agree on, fitted to the surfaces.
fn motion_between(a: &Prepared, b: &Prepared, theta: f64, scaled: bool, p: Progress<'_>) -> Stage<Brought> {
    let (decomposer, other) = (&a.decomposer, &b.decomposer);
    let lengths = if scaled {
        [stage(common_lengths(decomposer, decomposer))?, stage(common_lengths(other, other))?]
    } else {
        let both = stage(common_lengths(decomposer, other))?;
        [both.clone(), both]
    };
    let of = |side: &Prepared, lengths: &[f64]| -> Stage<Described> {
        stage(described(&side.decomposer, side.normals.as_deref(), lengths, theta, p))
    };
    let (one, two) = (of(a, &lengths[0])?, of(b, &lengths[1])?);
    let params = ConsensusParams { scaled, ..ConsensusParams::default() };
    let found = stage(consensus((&one.keys, &one.descriptors), (&two.keys, &two.descriptors), &params, p))?;
    let clear = found.filter(Consensus::is_clear);
    let (Some(found), Some(surface)) = (clear, Surface::new(other.geometry())) else {
        return Ok((one, two, None));
    };
    let params = AlignParams { scaled, ..AlignParams::default() };
    let motion = stage(align(decomposer.geometry().points(), &surface, found.motion, &params, p))?;
    Ok((one, two, Some(motion)))
}

fn matrix<'py>(py: Python<'py>, motion: &Motion) -> PyResult<Bound<'py, PyAny>> {
    Ok(arrays::matrix(py, motion.matrix().as_flattened().to_vec(), 4)?.into_any())
}

/// The signed distance of each vertex of the first shape to the second, which is fitted first where that is asked for; whether they
/// have a sign; the motion of the second.
#[pyfunction]
#[pyo3(signature = (first, second, fitted, limit, progress=None))]
fn distances<'py>(
    py: Python<'py>,
    first: &Bound<'py, Prepared>,
    second: &Bound<'py, Prepared>,
    fitted: bool,
    limit: Option<Bound<'py, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, bool, Bound<'py, PyAny>)> {
    let (a, b) = (first.get(), second.get());
    let decomposer = &a.decomposer;
    let limit = limit.as_ref().map(length).transpose()?;
    let limit = limit.map_or(f64::INFINITY, |limit| limit.to_model_units(decomposer.diagonal()));
    let (Some(own), Some(surface)) =
        (Surface::new(decomposer.geometry()), Surface::new(b.decomposer.geometry()))
    else {
        return Err(value("a graph has no surface; give meshes or clouds"));
    };
    let work = |p: Progress<'_>| -> Stage<_> {
        let mut motion = Motion::default();
        if fitted {
            // Where no motion of features is clear they are taken to lie near each other already.
            let start = motion_between(b, a, THETA, false, p)?.2.map_or(motion, |(motion, _)| motion);
            let other = b.decomposer.geometry().points();
            motion = stage(align(other, &own, start, &AlignParams::default(), p))?.0;
        }
        let outward = stage(outward_normals(decomposer.geometry(), a.normals.as_deref(), p))?;
        // The first shape goes to where the second is, in place of the second to the first.
        let back = motion.inverse();
        let points: Vec<[f64; 3]> =
            decomposer.geometry().points().iter().map(|point| back.apply(point)).collect();
        let normals: Vec<[f64; 3]> = outward.normals.iter().map(|normal| back.turn(normal)).collect();
        let found = stage(signed_distances(&points, &normals, &surface, limit, p))?;
        let is_signed = outward.info.has_outside();
        let values = if is_signed { found.values } else { found.values.iter().map(|v| v.abs()).collect() };
        Ok::<_, Failure>((decomposer.geometry().vertex_map().scatter(&values, 1), is_signed, motion))
    };
    let (values, is_signed, motion) = run(py, usize::MAX, progress.as_ref(), work)?;
    Ok((arrays::vector(py, values).into_any(), is_signed, matrix(py, &motion)?))
}
