//! Why tiles cannot be made.

use std::path::Path;

use adwave::bands::{BandsError, ScheduleError};
use adwave::denoise::DenoiseError;
use adwave::{Cancelled, ClassifiedError, ErrorKind};
use adwave_io::{ReadError, WriteError};

/// Why tiles cannot be made. Every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum TilesError {
    /// What was asked for cannot be.
    #[error("{0}")]
    Input(String),
    /// The work would take more memory than it may.
    #[error("{0}")]
    Memory(String),
    /// A file of the work folder cannot be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A file of the work folder is not what was written there.
    #[error("{path} is broken ({what}); delete the folder and begin anew")]
    Broken {
        /// The file.
        path: String,
        /// What is wrong with it.
        what: String,
    },
    /// An input cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A result cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The levels are none.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// The bands cannot be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The noise cannot be taken off.
    #[error(transparent)]
    Denoise(#[from] DenoiseError),
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl TilesError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + '_ {
        move |source| Self::Io { path: path.display().to_string(), source }
    }

    pub(crate) fn broken(path: &Path, what: impl Into<String>) -> Self {
        Self::Broken { path: path.display().to_string(), what: what.into() }
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
            Self::Schedule(error) => error.kind(),
            Self::Bands(error) => error.kind(),
            Self::Denoise(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
        }
    }
}
