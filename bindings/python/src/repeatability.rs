//! Shapes changed on purpose, and the features that are found again.

use crate::call::run;
use crate::error::{Stage, stage, to_exception, value_error};
use crate::prepared::Prepared;
use crate::shape::ShapeData;
use adwave::features::Feature;
use adwave::measure::{
    Change, ChangedShape, RepeatabilityParams, change, n_right, repeatability, share_by_chance,
};
use adwave::shape::{Shape, surface_area};
use adwave_io::ShapeFile;
use adwave_simplify::resample_mesh;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<ChangeData>()
}

/// A changed shape with the way back.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct ChangeData {
    changed: ChangedShape,
    shape: Py<ShapeData>,
}

/// Features as structs, from their columns.
fn features(columns: &Bound<'_, PyDict>) -> PyResult<Vec<Feature>> {
    let get = |name: &str| columns.get_item(name)?.ok_or_else(|| value_error(format!("features: no {name}")));
    let vertex: PyReadonlyArray1<'_, i64> = get("vertex")?.extract()?;
    let position: PyReadonlyArray2<'_, f64> = get("position")?.extract()?;
    let level: PyReadonlyArray1<'_, i32> = get("level")?.extract()?;
    let sigma: PyReadonlyArray1<'_, f64> = get("sigma")?.extract()?;
    let response: PyReadonlyArray1<'_, f64> = get("response")?.extract()?;
    let channel: PyReadonlyArray1<'_, i32> = get("channel")?.extract()?;
    let (vertex, position) = (vertex.as_slice()?, crate::arrays::points(&position, "position")?);
    let (level, sigma) = (level.as_slice()?, sigma.as_slice()?);
    let (response, channel) = (response.as_slice()?, channel.as_slice()?);
    let one = |i: usize| Feature {
        vertex: vertex[i].unsigned_abs() as usize,
        position: Some(position[i]).filter(|p| p.iter().all(|c| c.is_finite())),
        level: level[i].unsigned_abs() as usize,
        sigma: sigma[i],
        response: response[i],
        strength: 0.0,
        channel: usize::try_from(channel[i]).ok(),
    };
    Ok((0..vertex.len()).map(one).collect())
}

/// For each level its number, features and features found again; then the features that are right, and the share that
/// chance would find.
type RepeatedFeatures = (Vec<(usize, usize, usize)>, usize, f64);

#[pymethods]
impl ChangeData {
    /// A change by its name: `noise` of a standard deviation in edges, `rotation`, `scaling` by a factor, `resampling`,
    /// `other-vertices`.
    #[new]
    fn new(
        py: Python<'_>,
        prepared: &Bound<'_, Prepared>,
        kind: &str,
        amount: f64,
        seed: u64,
    ) -> PyResult<Self> {
        let decomposer = &prepared.get().decomposer;
        let shape = decomposer.geometry_for("a change").map_err(|e| to_exception(&e))?.shape();
        let step = match kind {
            "noise" => Some(Change::Noise { edges: amount, seed }),
            "rotation" => Some(Change::Rotation { seed }),
            "scaling" => Some(Change::Scaling { factor: amount }),
            "resampling" => Some(Change::Resampling { seed }),
            "other-vertices" => None,
            _ => {
                let known = "'noise', 'rotation', 'scaling', 'resampling', 'other-vertices'";
                return Err(value_error(format!("change must be one of {known}, got '{kind}'")));
            }
        };
        let changed = run(py, usize::MAX, None, |p| -> Stage<Option<ChangedShape>> {
            match (&step, shape) {
                (Some(step), _) => stage(change(shape, decomposer, step)).map(Some),
                (None, Shape::Mesh(mesh)) => {
                    let mesh = stage(resample_mesh(mesh, seed, p))?;
                    Ok(Some(ChangedShape::resampled(Shape::Mesh(mesh))))
                }
                _ => Ok(None),
            }
        })?;
        let changed = changed.ok_or_else(|| value_error("change 'other-vertices' needs a mesh"))?;
        let file = match &changed.shape {
            Shape::Mesh(mesh) => ShapeFile::from_mesh(mesh.points().to_vec(), mesh.faces().clone()),
            other => ShapeFile::from_cloud(other.points().unwrap_or_default().to_vec()),
        };
        let shape = Py::new(py, prepared.get().shape.get().with_file(file))?;
        Ok(Self { changed, shape })
    }

    #[getter]
    fn shape(&self, py: Python<'_>) -> Py<ShapeData> {
        self.shape.clone_ref(py)
    }

    /// Length in the original of a length in the changed shape.
    fn length_before(&self, length: f64) -> f64 {
        self.changed.length_before(length)
    }

    /// Points of the changed shape before it was rotated and scaled.
    fn undo_motion<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let back = crate::arrays::points(&points, "points")?.iter().map(|p| self.changed.before(p)).collect();
        Ok(crate::arrays::point_rows(py, back)?.into_any())
    }

    /// Features of the reference that are found again.
    fn find_repeated(
        &self,
        py: Python<'_>,
        reference: &Bound<'_, Prepared>,
        before: &Bound<'_, PyDict>,
        after: &Bound<'_, PyDict>,
        sigmas: f64,
    ) -> PyResult<RepeatedFeatures> {
        if !(sigmas.is_finite() && sigmas > 0.0) {
            return Err(value_error(format!("within must be a finite number above 0, got {sigmas}")));
        }
        let decomposer = &reference.get().decomposer;
        let (before, after) = (features(before)?, features(after)?);
        let params = RepeatabilityParams::default().with_sigmas(sigmas);
        run(py, usize::MAX, None, |_| {
            let triangles = decomposer.geometry().map_or(&[][..], |geometry| geometry.triangles());
            let area = match triangles {
                [] => decomposer.areas().iter().sum(),
                triangles => surface_area(decomposer.positions(), triangles),
            };
            let levels = repeatability(&before, &after, &self.changed, &params);
            let levels = levels.iter().map(|l| (l.level, l.n_reference, l.n_found)).collect();
            let right = n_right(&before, &after, &self.changed, &params);
            let chance = share_by_chance(&before, &after, &self.changed, &params, area);
            Ok::<_, adwave::Cancelled>((levels, right, chance))
        })
    }
}
