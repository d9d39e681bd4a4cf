//! From errors to exceptions.

use adwave::{ClassifiedError, ErrorKind};
use pyo3::exceptions::{
    PyFileNotFoundError, PyKeyboardInterrupt, PyMemoryError, PyOSError, PyPermissionError, PyRuntimeError,
    PyValueError,
};
use pyo3::{PyErr, create_exception};

create_exception!(
    adwave,
    InternalError,
    PyRuntimeError,
    "adwave broke one of its own rules. Please report it, with what you gave it."
);

/// The exception for an error, by who can do something about it.
pub(crate) fn of(error: &impl ClassifiedError) -> PyErr {
    let text = error.to_string();
    match error.kind() {
        ErrorKind::Input => PyValueError::new_err(text),
        ErrorKind::Memory => PyMemoryError::new_err(text),
        ErrorKind::Cancelled => PyKeyboardInterrupt::new_err(text),
        // As Python names them itself, so that `except FileNotFoundError` holds.
        ErrorKind::Machine if text.contains("(os error 2)") => PyFileNotFoundError::new_err(text),
        ErrorKind::Machine if text.contains("(os error 13)") => PyPermissionError::new_err(text),
        ErrorKind::Machine => PyOSError::new_err(text),
    }
}

/// A `ValueError`.
pub(crate) fn value(text: impl Into<String>) -> PyErr {
    PyValueError::new_err(text.into())
}
