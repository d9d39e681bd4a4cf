//! The width of a coarse base.

use super::given_length::GivenLength;
use super::parse::length;
use crate::error::CliError;
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::region::Length;
use adwave_deform::default_base;
use clap::Args;

/// Width of the coarse base that is edited while finer detail rides along.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Base")]
pub(crate) struct BaseWidthArgs {
    /// Width σ of the base, in model units or in % of the diagonal: detail finer than this rides along [default: 4.5%,
    /// or the last default level of a shape too coarse for it]
    #[arg(long, value_name = "L", value_parser = length, allow_negative_numbers = true)]
    pub(crate) width: Option<Length>,
}

impl BaseWidthArgs {
    /// The width as it was given.
    pub(crate) fn given_lengths(&self) -> Vec<GivenLength> {
        self.width.map(|length| GivenLength { option: "--width", length }).into_iter().collect()
    }

    /// Refuses a width that is no length, before a shape is read.
    pub(crate) fn check(&self) -> Result<(), CliError> {
        match self.width.map(|width| width.to_model_units(1.0)) {
            Some(width) if !(width > 0.0 && width.is_finite()) => Err(CliError::Input(format!(
                "--width must be a finite length above 0, got {width}; leave it out for the usual one"
            ))),
            _ => Ok(()),
        }
    }

    /// Levels of which the last is the base.
    pub(crate) fn resolve(&self, decomposer: &Decomposer) -> Result<Schedule, CliError> {
        let Some(width) = self.width else { return Ok(default_base(decomposer)) };
        let width = width.to_model_units(decomposer.extent());
        Ok(Schedule::lengths(&[width], decomposer.operator().step_length())?)
    }
}
