//! What can go wrong, and the exit code that says so.

use adwave::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// A failed run. Its text is one line.
#[derive(Debug, Error)]
pub(crate) enum CliError {
    /// What was asked for or given cannot be used.
    #[error("{0}")]
    Input(String),
    /// The machine cannot do it: a full disk, no permission.
    #[error("{0}")]
    Environment(String),
    /// Ctrl-C.
    #[error("stopped; no file is half written")]
    Cancelled,
    /// Who reads the standard output has stopped reading.
    #[error("the standard output is closed")]
    ClosedPipe,
}

impl CliError {
    /// 2 for bad usage or input, 1 for trouble with the machine, 130 for Ctrl-C as shells have it.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Environment(_) => 1,
            Self::Cancelled => 130,
            Self::ClosedPipe => 0,
        }
    }

    /// An error of one of the libraries, by its kind.
    pub(crate) fn classified(error: impl ClassifiedError) -> Self {
        match error.kind() {
            ErrorKind::Cancelled => Self::Cancelled,
            ErrorKind::Machine => Self::Environment(error.to_string()),
            ErrorKind::Input | ErrorKind::Memory => Self::Input(error.to_string()),
        }
    }

    /// Bad input described by an error of one of the libraries.
    pub(crate) fn input(error: impl std::fmt::Display) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<adwave::bands::BandsError> for CliError {
    fn from(error: adwave::bands::BandsError) -> Self {
        match error {
            adwave::bands::BandsError::Cancelled(_) => Self::Cancelled,
            other => Self::input(other),
        }
    }
}

impl From<adwave_io::ShapeFileError> for CliError {
    fn from(error: adwave_io::ShapeFileError) -> Self {
        Self::input(error)
    }
}

impl From<adwave::basis::BasisError> for CliError {
    fn from(error: adwave::basis::BasisError) -> Self {
        match error {
            adwave::basis::BasisError::Cancelled(_) => Self::Cancelled,
            other => Self::input(other),
        }
    }
}

impl From<adwave::filter::FilterError> for CliError {
    fn from(error: adwave::filter::FilterError) -> Self {
        match error {
            adwave::filter::FilterError::Bands(error) => error.into(),
            other => Self::input(other),
        }
    }
}

impl From<adwave::bands::ScheduleError> for CliError {
    fn from(error: adwave::bands::ScheduleError) -> Self {
        Self::input(error)
    }
}
