//! Conversion of errors to exceptions.

use adwave::{ClassifiedError, ErrorKind};
use adwave_deform::DeformError;
use pyo3::exceptions::{
    PyFileNotFoundError, PyKeyboardInterrupt, PyMemoryError, PyOSError, PyPermissionError, PyRuntimeError,
    PyValueError,
};
use pyo3::{PyErr, create_exception};

create_exception!(
    adwave,
    InternalError,
    PyRuntimeError,
    "An internal error of adwave. Please report it with the input."
);

/// The exception for an error, by its kind.
pub(crate) fn to_exception(error: &impl ClassifiedError) -> PyErr {
    let text = error.to_string();
    match error.kind() {
        ErrorKind::Input => PyValueError::new_err(text),
        ErrorKind::Memory => PyMemoryError::new_err(text),
        ErrorKind::Cancelled => PyKeyboardInterrupt::new_err(text),
        // The exceptions of Python itself, so that `except FileNotFoundError` works.
        _ if text.contains("(os error 2)") => PyFileNotFoundError::new_err(text),
        _ if text.contains("(os error 13)") => PyPermissionError::new_err(text),
        _ => PyOSError::new_err(text),
    }
}

/// A `ValueError`.
pub(crate) fn value_error(text: impl Into<String>) -> PyErr {
    PyValueError::new_err(text.into())
}

/// Result of work whose steps have different error types.
pub(crate) type Stage<T> = Result<T, StageError>;

/// An error of any type, reduced to its kind and message.
#[derive(Debug)]
pub(crate) struct StageError {
    kind: ErrorKind,
    text: String,
}

impl std::fmt::Display for StageError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for StageError {}

impl ClassifiedError for StageError {
    fn kind(&self) -> ErrorKind {
        self.kind
    }
}

impl From<DeformError> for StageError {
    fn from(error: DeformError) -> Self {
        Self { kind: error.kind(), text: error.to_string() }
    }
}

/// The result of a step with the common error type.
pub(crate) fn stage<T, E: ClassifiedError>(result: Result<T, E>) -> Stage<T> {
    result.map_err(|e| StageError { kind: e.kind(), text: e.to_string() })
}
