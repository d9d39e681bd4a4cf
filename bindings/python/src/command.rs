//! The command, and the constants and names that the package shares with it.

use crate::call::run;
use crate::error;
use crate::options;
use adwave::bands::{BandsParams, DEFAULT_EXTENT, FWHM};
use adwave::filter::Preset;
use adwave::region::parse_region;
use adwave::saliency::SALIENCY_EXTENT;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(run_command, module)?)?;
    module.add_function(wrap_pyfunction!(preset_gains, module)?)?;
    module.add_function(wrap_pyfunction!(preset_names, module)?)?;
    module.add_function(wrap_pyfunction!(check_region, module)?)?;
    module.add("ACCURACY", BandsParams::default().accuracy)?;
    module.add("FWHM", FWHM)?;
    let extent = PyDict::new(module.py());
    extent.set_item("bands", DEFAULT_EXTENT)?;
    extent.set_item("saliency", SALIENCY_EXTENT)?;
    module.add("EXTENT", extent)
}

/// Runs a command line, which begins with the program's name, and returns its exit code.
#[pyfunction]
fn run_command(py: Python<'_>, arguments: Vec<String>) -> PyResult<u8> {
    run(py, usize::MAX, None, |progress| {
        let (stop, done) = (AtomicBool::new(false), AtomicBool::new(false));
        std::thread::scope(|scope| {
            let (watched, ended) = (&stop, &done);
            // The command polls a flag of its own.
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

/// Gains of a preset, from fine to coarse.
#[pyfunction]
fn preset_gains(name: &str, n_levels: usize) -> PyResult<Vec<f64>> {
    options::preset_gains(name, n_levels)
}

/// Names of the presets.
#[pyfunction]
fn preset_names() -> Vec<&'static str> {
    Preset::ALL.iter().map(|preset| preset.name()).collect()
}

/// Raises `ValueError` if a text is not a region.
#[pyfunction]
fn check_region(region: &str) -> PyResult<()> {
    parse_region(region).map(|_| ()).map_err(|e| error::value_error(format!("region: {e}")))
}
