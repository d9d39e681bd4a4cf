//! Errors of a tiling job.

use std::path::Path;

use adwave::bands::{BandsError, ScheduleError};
use adwave::denoise::DenoiseError;
use adwave::{Cancelled, ClassifiedError, ErrorKind};
use adwave_io::{ReadError, SelectionError, WriteError};

/// Error of a tiling job. Every message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TilesError {
    /// The inputs or the parameters are invalid.
    #[error("{0}")]
    Input(String),
    /// The job needs more memory than it may use.
    #[error("{0}")]
    Memory(String),
    /// A file of the work folder cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// Path of the file.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file of the work folder is damaged or belongs to another job.
    #[error("{path} is broken ({reason}); delete the work folder and start again")]
    Broken {
        /// Path of the file.
        path: String,
        /// Description of the damage.
        reason: String,
    },
    /// An input cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A result cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The vertices that take part cannot be chosen.
    #[error(transparent)]
    Selection(#[from] SelectionError),
    /// The number of levels is invalid.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The positions cannot be denoised.
    #[error(transparent)]
    Denoise(#[from] DenoiseError),
    /// The caller cancelled the job.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl TilesError {
    /// Adapter for `map_err` that adds the path.
    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.display().to_string(), source }
    }

    pub(crate) fn broken(path: &Path, reason: impl Into<String>) -> Self {
        Self::Broken { path: path.display().to_string(), reason: reason.into() }
    }
}

impl ClassifiedError for TilesError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Input(_) => ErrorKind::Input,
            Self::Memory(_) => ErrorKind::Memory,
            Self::Io { .. } | Self::Broken { .. } => ErrorKind::Machine,
            Self::Read(error) => error.kind(),
            Self::Write(error) => error.kind(),
            Self::Selection(error) => error.kind(),
            Self::Schedule(error) => error.kind(),
            Self::Bands(error) => error.kind(),
            Self::Denoise(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
        }
    }
}
