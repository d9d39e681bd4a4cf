//! Registration and distances of two shapes, and simplification.

use crate::arrays;
use crate::call::run;
use crate::error::{Stage, StageError, stage, value_error};
use crate::options::length;
use crate::prepared::Prepared;
use crate::shape::ShapeData;
use adwave::Progress;
use adwave::shape::{PreparedGeometry, Shape};
use adwave_io::Subset;
use adwave_register::{
    AlignParams, ClosestPointSearch, DescribeError, Motion, Registrand, Registration, SearchParams,
    ShapeFeatures, Signs, align as fit_motion, closest_fit, common_lengths, describe_shape, fit_in_place,
    register, signed_distances,
};
use adwave_simplify::{
    Appearance, AppearanceValues, Border, CloudTarget, MeshParams, MeshTarget, Why, simplify_cloud,
    simplify_mesh_with_appearance,
};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(simplify, module)?)?;
    module.add_function(wrap_pyfunction!(match_shapes, module)?)?;
    module.add_function(wrap_pyfunction!(distances, module)?)
}

/// Target of a simplification.
#[derive(FromPyObject)]
struct SimplifyOptions<'py> {
    error: Option<Bound<'py, PyAny>>,
    vertices: Option<usize>,
    ratio: Option<f64>,
    keep_border: bool,
    weights: Option<PyReadonlyArray1<'py, f64>>,
}

/// Simplifies a shape: the result, its vertices in the original (`None` for all), and the greatest and rms distance.
#[pyfunction]
#[pyo3(signature = (shape, options, progress=None))]
fn simplify<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    options: SimplifyOptions<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(ShapeData, Option<Bound<'py, PyAny>>, f64, f64)> {
    let content = shape.get();
    let own = content.shape(py)?;
    let error =
        options.error.as_ref().map(length).transpose()?.map(|error| error.to_model_units(own.extent()));
    let (file, kept, deviation) = match own {
        Shape::Mesh(mesh) => {
            let target = match (error, options.vertices) {
                (Some(error), _) => MeshTarget::Error(error),
                (_, Some(n)) => MeshTarget::Vertices(n),
                _ => MeshTarget::Ratio(options.ratio.unwrap_or(1.0)),
            };
            let border = if options.keep_border { Border::Kept } else { Border::Weighted };
            let (labels, values) = (content.file.corner_labels(), content.file.corner_values());
            let values =
                values.as_ref().map(|of| AppearanceValues { values: &of.values, n_channels: of.n_channels });
            let weights = options.weights.as_ref().map(|weights| weights.as_array().to_vec());
            let appearance = Appearance { labels: labels.as_deref(), values, weights: weights.as_deref() };
            let params = MeshParams::new(target).with_border(border);
            let found = run(py, usize::MAX, progress.as_ref(), |p| {
                simplify_mesh_with_appearance(mesh, appearance, &params, p)
            })?;
            if found.why == Why::Unchanged {
                (content.file.clone(), None, found.deviation.unwrap_or_default())
            } else {
                let subset = Subset {
                    vertices: &found.kept,
                    triangles: &found.triangles,
                    faces: &found.faces,
                    corners: &found.corners,
                };
                let file = content.file.subset(&subset).map_err(|e| value_error(e.to_string()))?;
                (file, Some(found.kept), found.deviation.unwrap_or_default())
            }
        }
        Shape::Cloud(cloud) => {
            let target = match (error, options.vertices) {
                (Some(error), _) => CloudTarget::Spacing(error),
                (_, Some(n)) => CloudTarget::Points(n),
                _ => CloudTarget::Ratio(options.ratio.unwrap_or(1.0)),
            };
            let found = run(py, usize::MAX, progress.as_ref(), |p| simplify_cloud(cloud, target, p))?;
            let subset = Subset { vertices: &found.kept, ..Subset::default() };
            let file = content.file.subset(&subset).map_err(|e| value_error(e.to_string()))?;
            (file, Some(found.kept), found.deviation)
        }
        Shape::Graph(_) => return Err(value_error("a graph has no surface; give a mesh or a cloud")),
    };
    let kept = kept.map(|kept| arrays::vector(py, kept).into_any());
    Ok((content.with_file(file), kept, deviation.greatest(), deviation.rms()))
}

/// Options of matching.
#[derive(FromPyObject)]
struct MatchOptions {
    theta: Option<f64>,
    within: f64,
    scaled: bool,
}

/// Features of both shapes, the motion from the first to the second, and pairs.
#[pyfunction]
#[pyo3(signature = (first, second, options, progress=None))]
fn match_shapes<'py>(
    py: Python<'py>,
    first: &Bound<'py, Prepared>,
    second: &Bound<'py, Prepared>,
    options: MatchOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (a, b) = (first.get(), second.get());
    let work = |p: Progress<'_>| -> Stage<_> {
        let [one, two] = registrands(a, b, options.theta, options.scaled, p)?;
        let params = SearchParams::default().with_scaled(options.scaled);
        let registration = stage(register(&one, &two, &params, p))?;
        let pairs = registration.pairs(&one, &two, options.within);
        Ok((one.features, two.features, registration, pairs))
    };
    let (one, two, registration, pairs): (ShapeFeatures, ShapeFeatures, Registration, _) =
        run(py, usize::MAX, progress.as_ref(), work)?;
    let clear = registration.clear();
    let found = PyDict::new(py);
    found.set_item("n_features", (one.features.len(), two.features.len()))?;
    found.set_item("motion", clear.map(|found| matrix(py, &found.motion)).transpose()?)?;
    let equal: PyResult<Vec<_>> = registration.equal.iter().map(|found| matrix(py, &found.motion)).collect();
    found.set_item("equal_motions", equal?)?;
    found.set_item("median", clear.map(|found| found.fit.median))?;
    found.set_item("overlap", clear.map(|found| found.fit.overlap))?;
    let indices = |vertex: &dyn Fn(&adwave_register::Pair) -> usize| -> Vec<i64> {
        pairs.iter().map(|pair| vertex(pair) as i64).collect()
    };
    found.set_item("first", arrays::vector(py, indices(&|pair| one.features[pair.first].vertex)))?;
    found.set_item("second", arrays::vector(py, indices(&|pair| two.features[pair.second].vertex)))?;
    let numbers =
        |column: &dyn Fn(&adwave_register::Pair) -> f64| -> Vec<f64> { pairs.iter().map(column).collect() };
    found.set_item("sigma", arrays::vector(py, numbers(&|pair| one.features[pair.first].sigma)))?;
    found.set_item("distance", arrays::vector(py, numbers(&|pair| pair.sigmas)))?;
    found.set_item("confidence", arrays::vector(py, numbers(&|pair| pair.confidence)))?;
    Ok(found)
}

/// Prepares two shapes for registration, with features at common widths unless their sizes may differ.
fn registrands(
    a: &Prepared,
    b: &Prepared,
    theta: Option<f64>,
    scaled: bool,
    p: Progress<'_>,
) -> Stage<[Registrand; 2]> {
    let (decomposer, other) = (&a.decomposer, &b.decomposer);
    let lengths = if scaled {
        [stage(common_lengths(decomposer, decomposer))?, stage(common_lengths(other, other))?]
    } else {
        let both = stage(common_lengths(decomposer, other))?;
        [both.clone(), both]
    };
    let prepare = |side: &Prepared, lengths: &[f64]| -> Stage<Registrand> {
        let found = stage(describe_shape(&side.decomposer, side.normals.as_deref(), lengths, theta, p))?;
        registrand(side, found, p)
    };
    Ok([prepare(a, &lengths[0])?, prepare(b, &lengths[1])?])
}

/// Prepares a shape with its features.
fn registrand(side: &Prepared, features: ShapeFeatures, p: Progress<'_>) -> Stage<Registrand> {
    // Shapes without a surface are refused before.
    Ok(stage(Registrand::new(&side.decomposer, features, p))?.expect("a surface"))
}

/// Motion that brings the points of `a` closest to `b`, from where they are or from anywhere.
fn aligning_motion(
    a: &Prepared,
    b: &Prepared,
    surface: &ClosestPointSearch,
    p: Progress<'_>,
) -> Stage<Motion> {
    let plain = |side: &Prepared| -> Stage<Registrand> {
        let outward = stage(side.decomposer.outward_normals(side.normals.as_deref(), p))?;
        registrand(side, ShapeFeatures::without_features(outward), p)
    };
    let start = if let Some(found) = stage(fit_in_place(&plain(a)?, &plain(b)?, p))? {
        found.motion
    } else {
        let [one, two] = registrands(a, b, None, false, p)?;
        stage(closest_fit(&one, &two, p))?.map_or_else(Motion::default, |found| found.motion)
    };
    let points = a.decomposer.positions();
    Ok(stage(fit_motion(points, surface, start, &AlignParams::default(), p))?.0)
}

fn matrix<'py>(py: Python<'py>, motion: &Motion) -> PyResult<Bound<'py, PyAny>> {
    Ok(arrays::matrix(py, motion.matrix().as_flattened().to_vec(), 4)?.into_any())
}

/// Closest points of a surface.
fn closest_points(geometry: &PreparedGeometry, progress: Progress<'_>) -> Stage<ClosestPointSearch> {
    stage(stage(ClosestPointSearch::new(geometry, progress))?.ok_or(DescribeError::NoPositions))
}

/// Signed distance of each vertex of the first shape to the second, whether it has a sign, and the motion of the second
/// if it is fitted first.
#[pyfunction]
#[pyo3(signature = (first, second, align, limit, progress=None))]
fn distances<'py>(
    py: Python<'py>,
    first: &Bound<'py, Prepared>,
    second: &Bound<'py, Prepared>,
    align: bool,
    limit: Option<Bound<'py, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, bool, Bound<'py, PyAny>)> {
    let (a, b) = (first.get(), second.get());
    let decomposer = &a.decomposer;
    let limit = limit.as_ref().map(length).transpose()?;
    let limit = limit.map_or(f64::INFINITY, |limit| limit.to_model_units(decomposer.extent()));
    let (Some(first), Some(second)) = (decomposer.geometry(), b.decomposer.geometry()) else {
        return Err(value_error("a graph has no surface; give meshes or clouds"));
    };
    let work = |p: Progress<'_>| -> Stage<_> {
        let own = closest_points(first, p)?;
        let surface = closest_points(second, p)?;
        let mut motion = Motion::default();
        if align {
            motion = aligning_motion(b, a, &own, p)?;
        }
        // The first shape is moved to the second, instead of the second to the first.
        let back = motion.inverse();
        let [one, two] = [a, b].map(|side| side.decomposer.geometry_for("a distance"));
        let geometries = [stage(one)?, stage(two)?];
        let normals = [a.normals.as_deref(), b.normals.as_deref()];
        let signs = match stage(Signs::choose(geometries, normals, p))? {
            Signs::Own(normals) => Signs::Own(normals.iter().map(|normal| back.turn(normal)).collect()),
            signs => signs,
        };
        let points: Vec<[f64; 3]> = decomposer.positions().iter().map(|point| back.apply(point)).collect();
        let found = stage(signed_distances(&points, &signs, &surface, limit, p))?;
        let values = decomposer.vertex_map().scatter(&found.values, 1);
        Ok::<_, StageError>((values, signs.is_signed(), motion))
    };
    let (values, is_signed, motion) = run(py, usize::MAX, progress.as_ref(), work)?;
    Ok((arrays::vector(py, values).into_any(), is_signed, matrix(py, &motion)?))
}
