//! What all errors have in common: a kind that says who can do something about them.

/// Who can do something about an error.
///
/// A command turns it into an exit code, a binding into a type of exception: `Input` is a `ValueError`, `Memory` a
/// `MemoryError`, `Cancelled` a `KeyboardInterrupt`, `Machine` an `OSError`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ErrorKind {
    /// What was given is wrong: a shape, a signal, a number, a file's content. The caller mends it.
    Input,
    /// The call would take more memory than it may or than there is. The caller asks for less or allows more.
    Memory,
    /// The call was told to stop.
    Cancelled,
    /// The machine failed: a disk is full, a file cannot be opened, a thread cannot be started.
    Machine,
}

/// An error of one of this project's crates.
///
/// ```
/// use adwave::bands::Schedule;
/// use adwave::{ClassifiedError, ErrorKind};
/// assert_eq!(Schedule::dyadic(0).unwrap_err().kind(), ErrorKind::Input);
/// ```
pub trait ClassifiedError: std::error::Error {
    /// Who can do something about it. Of an error that has another one inside, the kind of that one.
    fn kind(&self) -> ErrorKind;
}
