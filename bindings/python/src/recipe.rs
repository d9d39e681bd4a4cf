//! Recipes.

use crate::arrays;
use crate::call::run;
use crate::error::{self, Stage, stage};
use crate::prepared::Prepared;
use crate::shape::ShapeData;
use adwave::local_fit::LocalFit;
use adwave::positions::MoveDirection;
use adwave::region::{Length, Region};
use adwave::shape::surface_parts;
use adwave::{LevelSpec, Progress};
use adwave_io::{Recipe, parse_recipe, recipe_to_text, write_recipe};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;

/// A parsed recipe.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct RecipeData {
    pub(crate) recipe: Recipe,
}

#[pymethods]
impl RecipeData {
    #[new]
    fn new(text: &str) -> PyResult<Self> {
        Ok(Self { recipe: parse_recipe(text).map_err(|e| error::to_exception(&e))? })
    }

    /// The recipe as text.
    fn text(&self) -> String {
        recipe_to_text(&self.recipe)
    }

    /// Writes the recipe to a file, completely or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        run(py, usize::MAX, None, |_| write_recipe(&path, &self.recipe))
    }

    /// Number of layers.
    #[getter]
    fn n_layers(&self) -> usize {
        self.recipe.layers.len()
    }

    /// True if there are clones of detail, or a pose with handles.
    #[getter]
    fn reshapes(&self) -> bool {
        let bends = self.recipe.pose.as_ref().is_some_and(|pose| !pose.handles.is_empty());
        bends || !self.recipe.clones.is_empty()
    }

    /// True if faces are turned over.
    #[getter]
    fn turns_faces(&self) -> bool {
        !self.recipe.turned.is_empty()
    }

    /// Positions with the clones of the recipe, carried into its pose. `prepared` has the walk on the shape before all
    /// edits.
    #[pyo3(signature = (prepared, points, progress=None))]
    fn reshape<'py>(
        &self,
        py: Python<'py>,
        prepared: &Bound<'py, Prepared>,
        points: PyReadonlyArray2<'py, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let points = arrays::points(&points, "points")?.to_vec();
        let (decomposer, shape) = (&prepared.get().decomposer, prepared.get().shape.get());
        let (names, recipe) = (shape.field_names(), &self.recipe);
        let moved = run(py, decomposer.n_vertices(), progress.as_ref(), |p| {
            let vertices = |region: &Region| -> Stage<Vec<u32>> {
                let lookup = |name: &str| shape.region_field(decomposer, name);
                let weights = stage(region.weights(decomposer.metric(), &lookup, &names, p))?;
                let weights = weights.to_vertices(decomposer.vertex_map());
                Ok((0..).zip(&weights).filter(|(_, w)| **w > 0.0).map(|(v, _)| v).collect())
            };
            let pose = recipe.pose.as_ref();
            adwave_deform::reshape(decomposer, &recipe.clones, pose, points, vertices, p)
        })?;
        Ok(arrays::point_rows(py, moved)?.into_any())
    }

    /// The shape with the faces of the recipe's parts turned over.
    fn turn_faces(&self, py: Python<'_>, prepared: &Bound<'_, Prepared>) -> PyResult<ShapeData> {
        let (decomposer, shape) = (&prepared.get().decomposer, prepared.get().shape.get());
        let first_vertices = &self.recipe.turned;
        run(py, decomposer.n_vertices(), None, |p: Progress<'_>| -> Stage<_> {
            let parts = stage(surface_parts(stage(decomposer.geometry_for("parts of a surface"))?, p))?;
            let mut file = shape.file.clone();
            let is_turned = stage(parts.faces_of(first_vertices, file.faces()))?;
            stage(file.turn_faces(&is_turned))?;
            Ok(shape.with_file(file))
        })
    }

    /// The parts of the recipe except the layers.
    fn content<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (recipe, found) = (&self.recipe, PyDict::new(py));
        found.set_item("field", &recipe.field)?;
        found.set_item("operator", recipe.operator.map(adwave::operator::OperatorKind::name))?;
        found.set_item("density_invariant", recipe.density_invariant)?;
        found.set_item("keep_creases", recipe.keep_creases)?;
        found.set_item("local_fit", recipe.local_fit.map(LocalFit::name))?;
        let positions = &recipe.positions;
        found.set_item("along", positions.along.map(MoveDirection::name))?;
        found.set_item("border", positions.borders.name())?;
        found.set_item("volume", positions.volume.name())?;
        match &recipe.levels {
            LevelSpec::Default => {}
            LevelSpec::Dyadic(levels) => found.set_item("levels", levels)?,
            LevelSpec::Voices { levels, voices } => {
                if let Some(levels) = levels {
                    found.set_item("levels", levels)?;
                }
                found.set_item("voices", voices)?;
            }
            LevelSpec::Steps(steps) => found.set_item("steps", steps.clone())?,
            LevelSpec::Widths(lengths) => {
                let widths = PyList::empty(py);
                for length in lengths {
                    match length {
                        Length::Units(units) => widths.append(*units)?,
                        Length::PercentOfDiagonal(percent) => widths.append(format!("{percent}%"))?,
                        Length::Degrees(angle) => widths.append(format!("{angle}deg"))?,
                    }
                }
                found.set_item("lengths", widths)?;
            }
        }
        Ok(found)
    }
}
