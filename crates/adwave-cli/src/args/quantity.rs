//! Meaning of the numbers of a signal.

use super::parse_named;
use crate::error::CliError;
use adwave::directions::{Symmetry, TensorOrder};
use adwave_io::COORDS;
use clap::Args;

/// Meaning of the numbers of a signal: each by itself, or directions or tensors in tangent planes.
#[derive(Clone, Copy, Debug, Default, Args)]
#[command(next_help_heading = "Signal")]
pub(crate) struct QuantityArgs {
    /// Take the three components as directions in the tangent planes of the surface, which turn on their way
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Symmetry>(), conflicts_with = "tensors")]
    pub(crate) directions: Option<Symmetry>,
    /// Take the six components as symmetric tensors: in a volume by their logarithms, on a surface in its tangent planes
    #[arg(long, value_name = "ORDER", value_parser = parse_named::<TensorOrder>())]
    pub(crate) tensors: Option<TensorOrder>,
}

impl QuantityArgs {
    /// True if each number is filtered by itself.
    pub(crate) fn are_numbers(self) -> bool {
        self.directions.is_none() && self.tensors.is_none()
    }

    /// Refuses positions, which are no directions.
    ///
    /// # Errors
    /// [`CliError::Input`] for directions or tensors if `signal` is coordinates.
    pub(crate) fn check_signal(self, signal: &str) -> Result<(), CliError> {
        if self.are_numbers() || signal != COORDS {
            return Ok(());
        }
        Err(CliError::Input(
            "--directions and --tensors need a field of the shape, and coordinates are positions; name one by --signal, \
             such as principal-direction"
                .to_owned(),
        ))
    }
}
