//! The levels.

use super::given_length::GivenLength;
use super::parse::{count, number, width};
use adwave::LevelSpec;
use adwave::region::Length;
use clap::Args;

/// Levels of the bands.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Levels")]
pub(crate) struct LevelArgs {
    /// Number of levels, each with twice as many diffusion steps as the one before: 1, 2, 4 … 2^(J-1) [default: until a
    /// level is 2 % of the diagonal wide, for features 4 %, for signed saliency and diff 16 %; 4 to 16, fewer where
    /// that would remove half of the shape]
    #[arg(long, short = 'j', value_name = "J", value_parser = count, allow_negative_numbers = true)]
    pub(crate) levels: Option<usize>,
    /// Levels for each doubling of the steps instead of one: 2^(k/V) steps
    #[arg(long, value_name = "V", value_parser = count, allow_negative_numbers = true, conflicts_with_all = ["steps", "lengths"])]
    pub(crate) voices: Option<usize>,
    /// Levels with these numbers of steps, increasing, whole or not, at least 1/64
    #[arg(long, value_name = "N,N,…", value_parser = number, value_delimiter = ',', conflicts_with_all = ["levels", "lengths"])]
    pub(crate) steps: Option<Vec<f64>>,
    /// Largest error of a band, relative to the band: 1e-13 to 0.1 [default: 1e-10, for saliency and features by heat on
    /// a mesh or a grid 1e-4]
    #[arg(long, value_name = "E", value_parser = number)]
    pub(crate) accuracy: Option<f64>,
    /// Levels with these widths σ, increasing, in model units, in % of the diagonal, or on a sphere in degrees (5deg) or
    /// in km of a stated radius (100km/6371). σ is the root mean square distance that a value spreads to: σ/√2 along
    /// each axis of a surface, and a full width at half maximum of 1.665 σ
    #[arg(
        long,
        value_name = "L,L,…",
        value_delimiter = ',',
        value_parser = width,
        allow_negative_numbers = true,
        conflicts_with_all = ["levels", "voices"]
    )]
    pub(crate) lengths: Option<Vec<Length>>,
    /// Levels with these full widths at half maximum, increasing, in model units, in % of the diagonal, or on a sphere
    /// in degrees (5deg) or in km of a stated radius (100km/6371): --lengths of FWHM/1.665
    #[arg(
        long,
        value_name = "L,L,…",
        value_delimiter = ',',
        value_parser = width,
        allow_negative_numbers = true,
        conflicts_with_all = ["levels", "voices", "steps", "lengths"]
    )]
    pub(crate) fwhm: Option<Vec<Length>>,
}

impl LevelArgs {
    /// The widths in model units or in % that are given.
    pub(crate) fn given_lengths(&self) -> Vec<GivenLength> {
        let given = |option, widths: &Option<Vec<Length>>| {
            widths.iter().flatten().map(move |&length| GivenLength { option, length }).collect::<Vec<_>>()
        };
        [given("--lengths", &self.lengths), given("--fwhm", &self.fwhm)].concat()
    }

    /// The levels that are asked for.
    pub(crate) fn to_spec(&self) -> LevelSpec {
        match (&self.steps, &self.lengths, &self.fwhm, self.levels, self.voices) {
            (Some(steps), ..) => LevelSpec::Steps(steps.clone()),
            (_, Some(lengths), ..) => LevelSpec::Widths(lengths.clone()),
            (_, _, Some(fwhm), ..) => LevelSpec::from_fwhm(fwhm),
            (.., levels, Some(voices)) => LevelSpec::Voices { levels, voices },
            (.., Some(levels), None) => LevelSpec::Dyadic(levels),
            (.., None, None) => LevelSpec::Default,
        }
    }
}
