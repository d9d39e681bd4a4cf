//! Errors of a run, and their exit codes.

use adwave::{ClassifiedError, ErrorKind};
use adwave_io::WriteError;
use thiserror::Error;

/// A failed run. Its text is one line.
#[derive(Debug, Error)]
pub(crate) enum CliError {
    /// The arguments or the input cannot be used.
    #[error("{0}")]
    Input(String),
    /// The machine fails: a full disk, no permission.
    #[error("{0}")]
    Environment(String),
    /// Ctrl-C.
    #[error("stopped; no file was left half-written")]
    Cancelled,
    /// The reader of the standard output has stopped reading.
    #[error("the standard output is closed")]
    ClosedPipe,
}

impl ClassifiedError for CliError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Input(_) => ErrorKind::Input,
            Self::Environment(_) | Self::ClosedPipe => ErrorKind::Machine,
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }
}

impl CliError {
    /// 2 for bad usage or input, 1 for trouble with the machine, 130 for Ctrl-C as shells have it.
    pub(crate) fn exit_code(&self) -> u8 {
        match self.kind() {
            ErrorKind::Input | ErrorKind::Memory => 2,
            ErrorKind::Cancelled => 130,
            _ => 1,
        }
    }

    /// An error of one of the libraries, by its kind: the user can correct input and memory, by another shape or a
    /// smaller request.
    pub(crate) fn classify(error: &impl ClassifiedError) -> Self {
        match error.kind() {
            ErrorKind::Cancelled => Self::Cancelled,
            ErrorKind::Input | ErrorKind::Memory => Self::Input(error.to_string()),
            _ => Self::Environment(error.to_string()),
        }
    }

    /// Bad input described by an error of one of the libraries.
    pub(crate) fn input(error: impl std::fmt::Display) -> Self {
        Self::Input(error.to_string())
    }
}

/// Implements `From` for errors that have a kind.
macro_rules! by_kind {
    ($($error:ty),* $(,)?) => {
        $(impl From<$error> for CliError {
            fn from(error: $error) -> Self {
                Self::classify(&error)
            }
        })*
    };
}

by_kind!(
    adwave::Cancelled,
    adwave::bands::ScheduleError,
    adwave::directions::DirectionsError,
    adwave::shape::NoShape,
    adwave::operator::NoRows,
    adwave::filter::KeepVolumeError,
    adwave::positions::PositionsError,
    adwave_io::NamedSignalError,
    adwave_io::ReadError,
    adwave_io::ShapeFileError,
    adwave_baselines::compare::CompareError,
    adwave_graph::AnnDataError,
    adwave_graph::GraphWalkError,
    adwave_deform::DeformError,
    adwave_render::RenderError,
    adwave_report::demo::DemoError,
    adwave_reproduce::ModelError,
    adwave_reproduce::ReproduceError,
    adwave_simplify::SimplifyError,
    adwave_subdivision::SubdivisionError,
);

impl From<adwave::bands::BandsError> for CliError {
    fn from(error: adwave::bands::BandsError) -> Self {
        match error {
            adwave::bands::BandsError::Cancelled(_) => Self::Cancelled,
            other => Self::input(other),
        }
    }
}

impl From<WriteError> for CliError {
    fn from(error: WriteError) -> Self {
        let text = error.to_string();
        let mut cause = &error;
        while let WriteError::InFile { source, .. } = cause {
            cause = source;
        }
        match cause {
            WriteError::Io(_) => Self::Environment(text),
            WriteError::Cancelled(_) => Self::Cancelled,
            _ => Self::Input(text),
        }
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
