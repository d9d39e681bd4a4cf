//! Errors of splitting a signal into bands.

use super::Schedule;
use crate::operator::NoRows;
use crate::parallel;
use crate::{Cancelled, ClassifiedError, ErrorKind};
use thiserror::Error;

/// Error of splitting a signal into bands.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BandsError {
    /// The length of the signal does not match the shape.
    #[error("the signal has {n_values} values, which is not {n_vertices} vertices × {n_channels} channels")]
    WrongLength {
        /// Number of values given.
        n_values: usize,
        /// Number of vertices of the shape.
        n_vertices: usize,
        /// Number of channels of the signal.
        n_channels: usize,
    },
    /// Channels that belong together are missing.
    #[error(
        "the operator takes vectors of {together} channels at each place, so the number of channels must be a multiple of {together}, got {n_channels}"
    )]
    ChannelGroups {
        /// Number of channels of the signal.
        n_channels: usize,
        /// Number of channels that belong together.
        together: usize,
    },
    /// A value is NaN or infinite.
    #[error(
        "the signal at vertex {vertex}, channel {channel} (both counted from 0) is {value}, which is not finite; correct it, or mask the vertex"
    )]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Index of the channel, from 0.
        channel: usize,
        /// The value found.
        value: f64,
    },
    /// The output buffer has the wrong length.
    #[error("the buffer for the result has {n_values} values, and {expected} are needed")]
    WrongBuffer {
        /// Length of the buffer.
        n_values: usize,
        /// Length of the result.
        expected: usize,
    },
    /// The number of factors or weights does not match the number of bands or vertices.
    #[error("there are {n_given} {what}, and {expected} are needed")]
    WrongNumber {
        /// Name of the values.
        what: &'static str,
        /// Number given.
        n_given: usize,
        /// Number required.
        expected: usize,
    },
    /// A factor of a band is NaN or infinite.
    #[error("the factor of level {level} is {factor}, which is not finite")]
    BadFactor {
        /// The level, from 1.
        level: usize,
        /// The factor.
        factor: f64,
    },
    /// The accuracy is out of range.
    #[error(
        "the accuracy {accuracy} of the bands is not between {} and 0.1; double precision promises no less, and more is no result",
        super::FINEST_ACCURACY
    )]
    Accuracy {
        /// The requested accuracy.
        accuracy: f64,
    },
    /// The call would need more memory than allowed.
    #[error(
        "the bands need {needed} bytes of memory and {available} may be used; ask for fewer levels or channels"
    )]
    TooLarge {
        /// Bytes needed, including the result.
        needed: u64,
        /// Bytes allowed.
        available: u64,
    },
    /// Fractional steps on an operator that only supports whole steps.
    #[error(
        "level {level} has {steps} steps, and this diffusion operator takes whole steps only, because it is not reversible or is to be applied power by power; ask for whole steps, or make the graph of a cloud symmetric"
    )]
    NotWhole {
        /// The level, from 1.
        level: usize,
        /// The number of steps.
        steps: f64,
    },
    /// Fractional powers did not reach the requested accuracy.
    #[error(
        "level {level} {} and {accuracy:.1e} was asked for: small fractional powers converge slowly on a graph that is nearly bipartite; ask for whole steps or for less accuracy",
        shortfall(*.reached)
    )]
    Missed {
        /// The level, from 1; for a sum of levels, the first fractional one.
        level: usize,
        /// The requested accuracy.
        accuracy: f64,
        /// Bound of the relative error of the band; infinite if the band nearly vanishes relative to W_f(1).
        reached: f64,
    },
    /// Bands without an adjoint, and so without a gradient.
    #[error(
        "the bands have no gradient: {reason}; make the graph symmetric, or remove vertices without area"
    )]
    NoAdjoint {
        /// The condition that does not hold.
        reason: &'static str,
    },
    /// Functions of the Laplacian of a walk that is not reversible.
    #[error(
        "a function of the Laplacian needs a symmetric graph, and this walk is not reversible; make the graph symmetric"
    )]
    NotReversible,
    /// Single precision was asked for and does not apply.
    #[error(
        "single precision does not apply: {reason}; it needs a reversible operator, and whole steps or heat; use double precision"
    )]
    NotSingle {
        /// The condition that does not hold.
        reason: &'static str,
    },
    /// An operator contradicts its promises.
    #[error("the operator is none of diffusion: {reason}")]
    BadOperator {
        /// The condition that does not hold.
        reason: &'static str,
    },
    /// The method needs the rows of an operator that has none.
    #[error(transparent)]
    NoRows(#[from] NoRows),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Describes the accuracy that a band reached.
fn shortfall(reached: f64) -> String {
    if reached < 1.0 {
        format!("reaches a relative accuracy of {reached:.1e}")
    } else {
        "all but vanishes beside the first, of which no relative accuracy can be had,".to_owned()
    }
}

impl ClassifiedError for BandsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } => ErrorKind::Memory,
            Self::Cancelled(_) => ErrorKind::Cancelled,
            _ => ErrorKind::Input,
        }
    }
}

/// Checks that a signal has a finite value for every channel at every vertex.
pub(crate) fn check_signal(signal: &[f64], n_vertices: usize, n_channels: usize) -> Result<(), BandsError> {
    if n_channels == 0 || n_vertices.checked_mul(n_channels) != Some(signal.len()) {
        return Err(BandsError::WrongLength { n_values: signal.len(), n_vertices, n_channels });
    }
    let bad = parallel::map_chunks(n_vertices, 1 << 14, |rows| {
        let start = rows.start * n_channels;
        let values = &signal[start..rows.end * n_channels];
        // All at once: an early end would compare value by value.
        let all_finite = values.iter().fold(true, |all, v| all & v.is_finite());
        if all_finite { None } else { values.iter().position(|v| !v.is_finite()).map(|at| start + at) }
    });
    if let Some(at) = bad.into_iter().flatten().next() {
        let (vertex, channel) = (at / n_channels, at % n_channels);
        return Err(BandsError::NotFinite { vertex, channel, value: signal[at] });
    }
    Ok(())
}

/// Checks the length of an output buffer.
pub(crate) fn check_buffer(n_values: usize, expected: usize) -> Result<(), BandsError> {
    if n_values == expected { Ok(()) } else { Err(BandsError::WrongBuffer { n_values, expected }) }
}

/// Checks that there is one finite factor per level.
pub(crate) fn check_factors(factors: &[f64], schedule: &Schedule) -> Result<(), BandsError> {
    let (n_given, expected) = (factors.len(), schedule.n_levels());
    if n_given != expected {
        return Err(BandsError::WrongNumber { what: "factors of the bands", n_given, expected });
    }
    match factors.iter().position(|factor| !factor.is_finite()) {
        Some(at) => Err(BandsError::BadFactor { level: at + 1, factor: factors[at] }),
        None => Ok(()),
    }
}
