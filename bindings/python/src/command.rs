//! The command, recipes, and what stands behind the names of signals and presets.

use crate::call::run;
use crate::error;
use adwave::LevelSpec;
use adwave::bands::{BandsParams, DEFAULT_EXTENT, FWHM};
use adwave::features::{FEATURE_EXTENT, FeatureParams};
use adwave::filter::Preset;
use adwave::positions::Along;
use adwave::region::{Length, parse_region};
use adwave::saliency::SALIENCY_EXTENT;
use adwave_io::{Recipe, parse_recipe, recipe_to_text, write_recipe};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(run_command, module)?)?;
    module.add_function(wrap_pyfunction!(preset_gains, module)?)?;
    module.add_function(wrap_pyfunction!(preset_names, module)?)?;
    module.add_function(wrap_pyfunction!(check_region, module)?)?;
    module.add_class::<RecipeData>()?;
    module.add("ACCURACY", BandsParams::default().accuracy)?;
    module.add("FWHM", FWHM)?;
    module.add("THETA", FeatureParams::default().theta)?;
    let reach = PyDict::new(module.py());
    reach.set_item("bands", DEFAULT_EXTENT)?;
    reach.set_item("features", FEATURE_EXTENT)?;
    reach.set_item("saliency", SALIENCY_EXTENT)?;
    module.add("REACH", reach)
}

/// Runs a command line, the program's name first, and gives its exit code.
#[pyfunction]
fn run_command(py: Python<'_>, arguments: Vec<String>) -> PyResult<u8> {
    run(py, usize::MAX, None, |progress| {
        let (stop, done) = (AtomicBool::new(false), AtomicBool::new(false));
        std::thread::scope(|scope| {
            let (watched, ended) = (&stop, &done);
            // The command looks at a flag of its own.
            scope.spawn(move || {
                while !ended.load(Ordering::Relaxed) {
                    if progress.is_cancelled() {
                        watched.store(true, Ordering::Relaxed);
                    }
                    std::thread::sleep(std::time::Duration::from_millis(10));
                }
            });
            let code = adwave_cli::run(arguments, &stop);
            done.store(true, Ordering::Relaxed);
            Ok::<u8, adwave::Cancelled>(code)
        })
    })
}

#[pyfunction]
fn preset_gains(name: &str, n_levels: usize) -> PyResult<Vec<f64>> {
    crate::edit::preset(name, n_levels)
}

#[pyfunction]
fn preset_names() -> Vec<&'static str> {
    Preset::ALL.iter().map(|preset| preset.name()).collect()
}

/// Refuses a region's text that is none.
#[pyfunction]
fn check_region(region: &str) -> PyResult<()> {
    parse_region(region).map(|_| ()).map_err(|e| error::value(format!("region: {e}")))
}

/// A recipe that has been read.
#[pyclass(frozen, module = "adwave._native")]
pub(crate) struct RecipeData {
    pub(crate) recipe: Recipe,
}

#[pymethods]
impl RecipeData {
    #[new]
    fn new(text: &str) -> PyResult<Self> {
        Ok(Self { recipe: parse_recipe(text).map_err(|e| error::of(&e))? })
    }

    /// The recipe as it is written.
    fn text(&self) -> String {
        recipe_to_text(&self.recipe)
    }

    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        run(py, usize::MAX, None, |_| write_recipe(&path, &self.recipe))
    }

    #[getter]
    fn n_layers(&self) -> usize {
        self.recipe.layers.len()
    }

    /// Everything but the layers.
    fn content<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (recipe, found) = (&self.recipe, PyDict::new(py));
        found.set_item("field", &recipe.field)?;
        found.set_item("operator", recipe.operator.map(adwave::operator::OperatorKind::name))?;
        found.set_item("density_invariant", recipe.density_invariant)?;
        found.set_item("keep_creases", recipe.keep_creases)?;
        let positions = &recipe.positions;
        found.set_item("along", positions.along.map(Along::name))?;
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
                let own = PyList::empty(py);
                for length in lengths {
                    match length {
                        Length::Units(units) => own.append(*units)?,
                        Length::PercentOfDiagonal(percent) => own.append(format!("{percent}%"))?,
                    }
                }
                found.set_item("lengths", own)?;
            }
        }
        Ok(found)
    }
}

