//! Levels of a mesh, and wavelets on them.

use crate::arrays;
use crate::call::run;
use crate::error::{StageError, stage, value_error};
use crate::shape::ShapeData;
use adwave::shape::{Mesh, MeshArea, Shape, mesh_areas};
use adwave_deform::{EditedLevel, with_level};
use adwave_subdivision::{
    BorderCorners, Family, HaarWavelets, Hierarchy, LiftedCoefficients, LiftedWavelets, WeldedMesh,
    sharp_edges,
};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<HierarchyData>()?;
    module.add_class::<WaveletData>()
}

/// A mesh of a shape, with vertices at equal positions taken as one.
fn welded_mesh(shape: &Shape) -> PyResult<&Mesh> {
    match shape {
        Shape::Mesh(mesh) => Ok(mesh),
        Shape::Cloud(_) | Shape::Graph(_) => {
            Err(value_error("a hierarchy needs a mesh; give faces, as in (points, faces)"))
        }
    }
}

/// Levels of subdivision of a mesh.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct HierarchyData {
    hierarchy: Hierarchy,
    welded: WeldedMesh,
}

#[pymethods]
impl HierarchyData {
    #[new]
    #[pyo3(signature = (shape, creases, angle, corners, progress=None))]
    fn new(
        py: Python<'_>,
        shape: &Bound<'_, ShapeData>,
        creases: Option<PyReadonlyArray2<'_, u32>>,
        angle: Option<f64>,
        corners: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let mesh = welded_mesh(shape.get().shape(py)?)?;
        let corners: BorderCorners =
            corners.parse().map_err(|e: adwave::UnknownName| value_error(e.to_string()))?;
        let given: Vec<[u32; 2]> = match &creases {
            Some(pairs) => arrays::rows(pairs, "creases")?.as_chunks().0.to_vec(),
            None => Vec::new(),
        };
        run(py, mesh.points().len(), progress.as_ref(), |p| {
            let welded = WeldedMesh::new(mesh);
            let mut creases = given.clone();
            if let Some(angle) = angle {
                let sharp = stage(sharp_edges(&welded.points(mesh), &welded.faces, angle, p))?;
                creases.extend(sharp.into_iter().map(|pair| pair.map(|v| welded.vertices[v as usize])));
            }
            let hierarchy = stage(welded.hierarchy(mesh, &creases, corners, p))?;
            Ok::<_, StageError>(Self { hierarchy, welded })
        })
    }

    /// Number of vertices of each level, of the mesh first.
    fn sizes(&self) -> Vec<usize> {
        let n_levels = self.hierarchy.n_levels();
        let coarser = (1..=n_levels).map(|level| self.hierarchy.n_vertices(level));
        std::iter::once(self.welded.of_vertex.len()).chain(coarser).collect()
    }

    /// Vertex of the mesh at each vertex of a level.
    fn vertices<'py>(&self, py: Python<'py>, level: usize) -> PyResult<Bound<'py, PyAny>> {
        let vertices = if level == 0 {
            (0..self.welded.of_vertex.len() as u32).collect()
        } else {
            let found = self.hierarchy.vertices(level).map_err(|e| value_error(e.to_string()))?;
            found.into_iter().map(|v| self.welded.vertices[v as usize]).collect()
        };
        Ok(arrays::vector(py, vertices).into_any())
    }

    /// Starts of the faces of a level in the list of corners, and the corners as its vertices.
    fn faces<'py>(&self, py: Python<'py>, level: usize) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let faces = self.hierarchy.faces(level).map_err(|e| value_error(e.to_string()))?;
        let of_mesh = |v: u32| if level == 0 { self.welded.vertices[v as usize] } else { v };
        let (starts, corners) = faces.into_parts();
        let corners = corners.into_iter().map(of_mesh).collect();
        Ok((arrays::vector(py, starts).into_any(), arrays::vector(py, corners).into_any()))
    }

    /// Corners of the triangles of the mesh, for areas.
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let corners = self.welded.triangles.as_flattened();
        let corners = corners.iter().map(|&v| self.welded.vertices[v as usize]).collect();
        Ok(arrays::matrix(py, corners, 3)?.into_any())
    }

    /// True if the levels are those of quadrilaterals.
    fn is_of_quads(&self) -> bool {
        self.hierarchy.is_of_quads()
    }

    /// Starts of the parents of each vertex of a level, and the parents as vertices of the next one.
    fn parents<'py>(
        &self,
        py: Python<'py>,
        level: usize,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (starts, parents) = self.hierarchy.parent_rows(level).map_err(|e| value_error(e.to_string()))?;
        let rows = |v: usize| &parents[starts[v] as usize..starts[v + 1] as usize];
        let places: Vec<usize> = match level {
            0 => self.welded.of_vertex.iter().map(|&v| v as usize).collect(),
            _ => (0..starts.len() - 1).collect(),
        };
        let (mut own_starts, mut own) = (vec![0], Vec::<u32>::with_capacity(parents.len()));
        for place in places {
            own.extend(rows(place));
            own_starts.push(own.len() as u32);
        }
        Ok((arrays::vector(py, own_starts).into_any(), arrays::vector(py, own).into_any()))
    }

    /// The mesh that belongs to the positions of an edited level, with the detail of finer levels.
    fn with_level<'py>(
        &self,
        py: Python<'py>,
        shape: &Bound<'_, ShapeData>,
        wavelets: &Bound<'_, WaveletData>,
        level: usize,
        edited: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mesh = welded_mesh(shape.get().shape(py)?)?;
        let Wavelets::Vertices(wavelets) = &wavelets.get().wavelets else {
            return Err(value_error(
                "family 'haar' has one value per face; levels of positions need another one",
            ));
        };
        let edited = arrays::points(&edited, "points")?;
        let points = run(py, mesh.points().len(), None, |p| {
            let edited = EditedLevel { level, points: edited };
            let found = stage(with_level(&self.hierarchy, wavelets, &self.welded.points(mesh), &edited, p))?;
            Ok::<_, StageError>(self.welded.scatter(found.as_flattened(), 3))
        })?;
        Ok(arrays::matrix(py, points, 3)?.into_any())
    }

    /// Number of levels and of vertices of each connected part.
    fn parts(&self) -> Vec<[usize; 2]> {
        self.hierarchy.parts().iter().map(|part| [part.n_levels, part.n_vertices]).collect()
    }
}

/// Wavelets of one family.
enum Wavelets {
    Vertices(LiftedWavelets),
    Faces(HaarWavelets),
}

/// Wavelets on a mesh, prepared for many fields.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct WaveletData {
    wavelets: Wavelets,
    welded: WeldedMesh,
}

#[pymethods]
impl WaveletData {
    /// `areas` are positions of another surface with the same faces, or nothing for the positions of the shape;
    /// `hierarchy` is needed by all families but the irregular one.
    #[new]
    #[pyo3(signature = (shape, family, hierarchy=None, surface=None, progress=None))]
    fn new(
        py: Python<'_>,
        shape: &Bound<'_, ShapeData>,
        family: &str,
        hierarchy: Option<&Bound<'_, HierarchyData>>,
        surface: Option<PyReadonlyArray2<'_, f64>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let family: Family = family.parse().map_err(|e: adwave::UnknownName| value_error(e.to_string()))?;
        let mesh = welded_mesh(shape.get().shape(py)?)?;
        let surface = match &surface {
            Some(points) if points.shape()[0] != mesh.points().len() => {
                return Err(value_error(format!(
                    "areas must be a surface of {} vertices, got {}",
                    mesh.points().len(),
                    points.shape()[0]
                )));
            }
            Some(points) => arrays::points(points, "areas")?,
            None => mesh.points(),
        };
        let hierarchy = hierarchy.map(|found| &found.get().hierarchy);
        run(py, mesh.points().len(), progress.as_ref(), |p| {
            let welded = WeldedMesh::new(mesh);
            let at_welded = |points: &[[f64; 3]]| -> Vec<[f64; 3]> {
                welded.vertices.iter().map(|&v| points[v as usize]).collect()
            };
            let areas_of = at_welded(surface);
            let areas = mesh_areas(&areas_of, &welded.triangles, MeshArea::Barycentric);
            let wavelets = match hierarchy {
                None => {
                    let points = at_welded(mesh.points());
                    Wavelets::Vertices(stage(LiftedWavelets::new_irregular(
                        &points,
                        &welded.triangles,
                        &areas,
                        p,
                    ))?)
                }
                Some(hierarchy) if family == Family::Haar => {
                    let area = |t: &[u32; 3]| -> f64 {
                        let corners = t.map(|v| areas_of[v as usize]);
                        mesh_areas(&corners, &[[0, 1, 2]], MeshArea::Barycentric).iter().sum()
                    };
                    let areas: Vec<f64> = welded.triangles.iter().map(area).collect();
                    Wavelets::Faces(stage(HaarWavelets::new(hierarchy, &areas))?)
                }
                Some(hierarchy) => {
                    Wavelets::Vertices(stage(LiftedWavelets::new(hierarchy, family, &areas, p))?)
                }
            };
            Ok::<_, StageError>(Self { wavelets, welded })
        })
    }

    /// Number of vertices of each level, of the mesh first; of faces for wavelets on faces.
    fn sizes(&self) -> Vec<usize> {
        match &self.wavelets {
            Wavelets::Faces(wavelets) => vec![wavelets.n_faces()],
            Wavelets::Vertices(wavelets) => {
                let coarser = (1..=wavelets.n_levels()).map(|level| wavelets.n_vertices_at(level));
                std::iter::once(self.welded.of_vertex.len()).chain(coarser).collect()
            }
        }
    }

    /// Vertices of the mesh at a level of wavelets on any mesh.
    fn vertices<'py>(&self, py: Python<'py>, level: usize) -> PyResult<Bound<'py, PyAny>> {
        let Wavelets::Vertices(wavelets) = &self.wavelets else {
            return Err(value_error("wavelets on faces have no vertices"));
        };
        if level > wavelets.n_levels() {
            return Err(value_error(format!("level must be in 0..={}, got {level}", wavelets.n_levels())));
        }
        let vertices = if level == 0 {
            (0..self.welded.of_vertex.len() as u32).collect()
        } else {
            let order = &wavelets.order()[..wavelets.n_vertices_at(level)];
            order.iter().map(|&v| self.welded.vertices[v as usize]).collect()
        };
        Ok(arrays::vector(py, vertices).into_any())
    }

    /// Coefficients of a field, and level and norm of each row.
    #[pyo3(signature = (field, progress=None))]
    fn analyze<'py>(
        &self,
        py: Python<'py>,
        field: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let d = field.shape()[1];
        let values = arrays::rows(&field, "field")?;
        let LiftedCoefficients { values, levels, norms, .. } =
            run(py, values.len(), progress.as_ref(), |p| match &self.wavelets {
                Wavelets::Vertices(wavelets) => {
                    let found = stage(wavelets.analyze(&stage(self.welded.gather(values, d))?, d, p))?;
                    let levels = self.welded.of_vertex.iter().map(|&v| found.levels[v as usize]).collect();
                    Ok::<_, StageError>(LiftedCoefficients {
                        n_channels: d,
                        values: self.welded.scatter(&found.values, d),
                        levels,
                        norms: self.welded.scatter(&found.norms, 1),
                    })
                }
                Wavelets::Faces(wavelets) => stage(wavelets.analyze(values, d, p)),
            })?;
        Ok((
            arrays::matrix(py, values, d)?.into_any(),
            arrays::vector(py, levels).into_any(),
            arrays::vector(py, norms).into_any(),
        ))
    }

    /// Coefficients of which only the share that contributes most stays; the others become 0.
    fn keep<'py>(
        &self,
        py: Python<'py>,
        coefficients: PyReadonlyArray2<'py, f64>,
        share: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let d = coefficients.shape()[1];
        let values = arrays::rows(&coefficients, "coefficients")?;
        let kept = run(py, values.len(), None, |_| match &self.wavelets {
            Wavelets::Vertices(wavelets) => {
                let all = LiftedCoefficients {
                    n_channels: d,
                    values: stage(self.welded.gather(values, d))?,
                    levels: wavelets.levels().to_vec(),
                    norms: wavelets.norms().to_vec(),
                };
                Ok::<_, StageError>(self.welded.scatter(&stage(all.keep(share))?.values, d))
            }
            Wavelets::Faces(wavelets) => {
                let n = wavelets.n_faces();
                let (values, levels, norms) = (values.to_vec(), vec![1; n], vec![1.0; n]);
                Ok(stage(LiftedCoefficients { n_channels: d, values, levels, norms }.keep(share))?.values)
            }
        })?;
        Ok(arrays::matrix(py, kept, d)?.into_any())
    }

    /// Field of coefficients.
    #[pyo3(signature = (coefficients, progress=None))]
    fn synthesize<'py>(
        &self,
        py: Python<'py>,
        coefficients: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let d = coefficients.shape()[1];
        let values = arrays::rows(&coefficients, "coefficients")?;
        let field = run(py, values.len(), progress.as_ref(), |p| match &self.wavelets {
            Wavelets::Vertices(wavelets) => {
                let found = stage(wavelets.synthesize(&stage(self.welded.gather(values, d))?, d, p))?;
                Ok::<_, StageError>(self.welded.scatter(&found, d))
            }
            Wavelets::Faces(wavelets) => stage(wavelets.synthesize(values, d, p)),
        })?;
        Ok(arrays::matrix(py, field, d)?.into_any())
    }

    /// Field on a coarser level with the same mean (`down`), or on the mesh from one on a coarser level (`up`).
    #[pyo3(signature = (field, level, direction))]
    fn resample<'py>(
        &self,
        py: Python<'py>,
        field: PyReadonlyArray2<'py, f64>,
        level: usize,
        direction: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let is_down = crate::options::word("direction", direction, &[("down", true), ("up", false)])?;
        let Wavelets::Vertices(wavelets) = &self.wavelets else {
            return Err(value_error("family 'haar' has one value per face; down and up are for vertices"));
        };
        let d = field.shape()[1];
        let values = arrays::rows(&field, "field")?;
        let found = run(py, values.len(), None, |p| match (is_down, level) {
            (_, 0) => Ok::<_, StageError>(values.to_vec()),
            (true, _) => stage(wavelets.coarse_field(&stage(self.welded.gather(values, d))?, d, level, p)),
            (false, _) => Ok(self.welded.scatter(&stage(wavelets.fine_field(values, d, level, p))?, d)),
        })?;
        Ok(arrays::matrix(py, found, d)?.into_any())
    }
}
