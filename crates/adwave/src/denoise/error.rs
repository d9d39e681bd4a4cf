//! Why a shape or a signal cannot be denoised.

use crate::bands::BandsError;
use crate::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Why a shape or a signal cannot be denoised.
#[derive(Debug, Error, PartialEq)]
pub enum DenoiseError {
    /// A graph has no positions.
    #[error("a graph has no positions to denoise; denoise a field of it")]
    NoPositions,
    /// A number out of its range.
    #[error("the {what} is {value}; it must be a finite number of at least 0")]
    Number {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// There is not a value of each channel for each vertex.
    #[error("{found} values are not one of each channel for each vertex, which would be {expected}")]
    SignalLength {
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
    },
    /// A value is NaN or infinite, and its vertex not masked.
    #[error("the value of vertex {vertex} is {value}; mask it, or give it a value")]
    NotFinite {
        /// The vertex, from 0.
        vertex: usize,
        /// Its value.
        value: f64,
    },
    /// Bands could not be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for DenoiseError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoPositions | Self::Number { .. } | Self::SignalLength { .. } | Self::NotFinite { .. } => {
                ErrorKind::Input
            }
            Self::Bands(error) => error.kind(),
            Self::Cancelled(cancelled) => cancelled.kind(),
        }
    }
}
