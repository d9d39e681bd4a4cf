//! Resampling between registered spheres.

use crate::arrays;
use crate::call::run;
use crate::error::{StageError, stage, value_error};
use crate::shape::ShapeData;
use adwave::shape::Shape;
use adwave_register::{Keep, Sphere, SphereResampler, Zeros};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<SphereData>()?;
    module.add_class::<SphereResamplerData>()
}

/// A sphere with areas at its vertices.
#[pyclass(frozen, module = "adwave._native")]
struct SphereData {
    sphere: Sphere,
}

#[pymethods]
impl SphereData {
    /// `areas` are numbers, `surface` positions of another surface with the same vertices; both may be missing.
    #[new]
    #[pyo3(signature = (shape, areas=None, surface=None))]
    fn new(
        py: Python<'_>,
        shape: &Bound<'_, ShapeData>,
        areas: Option<PyReadonlyArray1<'_, f64>>,
        surface: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        let Shape::Mesh(mesh) = shape.get().shape(py)? else {
            return Err(value_error("a sphere must be a mesh of triangles; give (points, faces)"));
        };
        if mesh.faces().iter().any(|face| face.len() != 3) {
            return Err(value_error("a sphere must have triangles only; cut the other faces"));
        }
        let areas = areas.map(|areas| areas.as_array().to_vec());
        let surface = surface.as_ref().map(|points| arrays::points(points, "areas")).transpose()?;
        run(py, mesh.points().len(), None, |_| {
            let triangles: Vec<[u32; 3]> =
                mesh.faces().iter().map(|face| [face[0], face[1], face[2]]).collect();
            let sphere = stage(Sphere::new(mesh.points(), &triangles))?;
            let sphere = match (areas, surface) {
                (Some(areas), _) => stage(sphere.with_areas(areas))?,
                (None, Some(points)) => stage(sphere.with_surface(points))?,
                (None, None) => sphere,
            };
            Ok::<_, StageError>(Self { sphere })
        })
    }

    /// Areas at the vertices.
    fn areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        arrays::vector(py, self.sphere.areas().to_vec()).into_any()
    }

    /// Assumptions about the sphere, in words.
    fn remarks(&self) -> Vec<String> {
        self.sphere.remarks()
    }
}

/// Weights from one sphere to another.
#[pyclass(frozen, module = "adwave._native")]
struct SphereResamplerData {
    resampler: SphereResampler,
}

#[pymethods]
impl SphereResamplerData {
    #[new]
    #[pyo3(signature = (source, target, kept=None, progress=None))]
    fn new(
        py: Python<'_>,
        source: &Bound<'_, SphereData>,
        target: &Bound<'_, SphereData>,
        kept: Option<PyReadonlyArray1<'_, bool>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let (from, to) = (&source.get().sphere, &target.get().sphere);
        let kept = kept.map(|kept| kept.as_array().to_vec());
        let n = from.n_vertices().max(to.n_vertices());
        let resampler =
            run(py, n, progress.as_ref(), |p| SphereResampler::new(from, to, kept.as_deref(), p))?;
        Ok(Self { resampler })
    }

    /// Values of the targets, and the numbers of targets without one and of sources of the medial wall.
    #[pyo3(signature = (values, keep, zeros, progress=None))]
    fn apply<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f64>,
        keep: &str,
        zeros: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, usize, usize)> {
        let unknown = |e: adwave::UnknownName| value_error(e.to_string());
        let keep: Keep = keep.parse().map_err(unknown)?;
        let zeros: Zeros = zeros.parse().map_err(unknown)?;
        let (n_channels, rows) = (values.shape()[1], arrays::rows(&values, "values")?);
        let n = rows.len();
        let found =
            run(py, n, progress.as_ref(), |p| self.resampler.apply(rows, n_channels, keep, zeros, p))?;
        let values = arrays::matrix(py, found.values, n_channels)?.into_any();
        Ok((values, found.n_missing, found.n_wall))
    }
}
