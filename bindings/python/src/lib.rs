//! The extension module `adwave._native`: the crates of adwave for the Python files of the package.
//!
//! Nothing is computed here. [`call`] runs the work with the interpreter released, stops it at Ctrl-C and turns errors
//! into exceptions; [`arrays`] passes numbers without a copy; [`options`] reads the option classes of the package; the
//! other modules have one class or a few functions each. Names, checks and documentation for users are in the package's
//! Python files.

#![expect(clippy::needless_pass_by_value, reason = "arguments come from the interpreter as values")]

mod allocator;
mod arrays;
mod baselines;
mod call;
mod command;
mod deform;
mod directions;
mod edit;
mod error;
mod frames;
mod grid;
mod hierarchy;
mod measures;
mod operator;
mod options;
mod own_operator;
mod picture;
mod prepared;
mod recipe;
mod region;
mod register;
mod repeatability;
mod shape;
mod spectral;
mod sphere;
mod studio;
mod time;
mod walk;

use pyo3::prelude::*;

#[pymodule(gil_used = false)]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    call::keep_panics_quiet();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("InternalError", module.py().get_type::<error::InternalError>())?;
    module.add_class::<shape::ShapeData>()?;
    module.add_class::<prepared::Prepared>()?;
    module.add_class::<recipe::RecipeData>()?;
    module.add_function(wrap_pyfunction!(call::threads, module)?)?;
    module.add_function(wrap_pyfunction!(call::requested_threads, module)?)?;
    module.add_function(wrap_pyfunction!(call::set_threads, module)?)?;
    module.add_function(wrap_pyfunction!(shape::mark_unknown, module)?)?;
    command::add(module)?;
    deform::add(module)?;
    directions::add(module)?;
    edit::add(module)?;
    measures::add(module)?;
    operator::add(module)?;
    picture::add(module)?;
    register::add(module)?;
    spectral::add(module)?;
    baselines::add(module)?;
    frames::add(module)?;
    hierarchy::add(module)?;
    repeatability::add(module)?;
    sphere::add(module)?;
    studio::add(module)?;
    time::add(module)?;
    walk::add(module)
}
