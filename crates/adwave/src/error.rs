//! Classification of errors by who can fix them.

/// Category of an error by who can fix it.
///
/// A command turns it into an exit code, a binding into an exception type: `Input` is a `ValueError`, `Memory` a
/// `MemoryError`, `Cancelled` a `KeyboardInterrupt`, `Machine` an `OSError`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// Invalid input: a shape, a signal, a number, the content of a file. The caller can correct it.
    Input,
    /// The call would need more memory than allowed or available. The caller can request less or allow more.
    Memory,
    /// The call was cancelled.
    Cancelled,
    /// The system failed: the disk is full, a file cannot be opened, a thread cannot be started.
    Machine,
}

/// An error of one of the crates of this project.
///
/// ```
/// use adwave::bands::Schedule;
/// use adwave::{ClassifiedError, ErrorKind};
/// assert_eq!(Schedule::dyadic(0).unwrap_err().kind(), ErrorKind::Input);
/// ```
pub trait ClassifiedError: std::error::Error {
    /// Category of the error; for an error that wraps another one, the category of that one.
    fn kind(&self) -> ErrorKind;
}
