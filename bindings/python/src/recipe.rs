//! Recipes.

use crate::call::run;
use crate::error;
use adwave::LevelSpec;
use adwave::local_fit::LocalFit;
use adwave::positions::MoveDirection;
use adwave::region::Length;
use adwave_io::{Recipe, parse_recipe, recipe_to_text, write_recipe};
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
