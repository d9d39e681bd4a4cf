//! Errors of denoising.

use super::NoiseModel;
use crate::bands::BandsError;
use crate::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Error of denoising a shape or a signal.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DenoiseError {
    /// The shape is a graph without positions, or one whose parts were to be denoised separately.
    #[error("a graph has no positions to denoise; denoise a field of it")]
    NoPositions,
    /// A parameter is out of its range.
    #[error("the {what} must be a number from 0 to {most:e}, got {value:?}")]
    Number {
        /// Name of the parameter.
        what: &'static str,
        /// Value of the parameter.
        value: f64,
        /// Largest value of the parameter.
        most: f64,
    },
    /// The length of the signal does not match the shape.
    #[error("the signal must have {expected} values, one per channel and vertex, got {found}")]
    SignalLength {
        /// Number of values given.
        found: usize,
        /// Number of values required.
        expected: usize,
    },
    /// A value is NaN or infinite, and its vertex is not masked.
    #[error("the value of vertex {vertex} is {value}; mask it, or give it a value")]
    NotFinite {
        /// The vertex, from 0.
        vertex: usize,
        /// Value at the vertex.
        value: f64,
    },
    /// A value does not occur with noise of the given model, and its vertex is not masked.
    #[error(
        "{model} noise needs values {}, and vertex {vertex} has {value}; mask such vertices, or take the noise model gaussian",
        if *model == NoiseModel::Multiplicative { "above 0" } else { "of at least 0" }
    )]
    ImpossibleValue {
        /// The model of the noise.
        model: NoiseModel,
        /// The vertex, from 0.
        vertex: usize,
        /// Value at the vertex.
        value: f64,
    },
    /// Noise that depends on the values is not removed in space and time together.
    #[error(
        "noise of the model {model} is removed frame by frame only; leave out the time, or take the noise model gaussian"
    )]
    NotInTime {
        /// The model of the noise.
        model: NoiseModel,
    },
    /// Directions are denoised as Gaussian noise of single fields.
    #[error(
        "directions are denoised one field at a time, with noise of the model gaussian; leave out the time and other models"
    )]
    Directions,
    /// The bands could not be computed.
    #[error(transparent)]
    Bands(#[from] BandsError),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for DenoiseError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoPositions
            | Self::Number { .. }
            | Self::SignalLength { .. }
            | Self::NotFinite { .. }
            | Self::ImpossibleValue { .. }
            | Self::NotInTime { .. }
            | Self::Directions => ErrorKind::Input,
            Self::Bands(error) => error.kind(),
            Self::Cancelled(cancelled) => cancelled.kind(),
        }
    }
}
