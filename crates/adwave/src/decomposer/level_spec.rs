//! Levels as they are asked for, and the schedule that they are on a shape.

use super::Decomposer;
use crate::bands::{DEFAULT_EXTENT, FWHM, Schedule, ScheduleError};
use crate::operator::OperatorTask;
use crate::region::Length;
use crate::shape::Shape;
use crate::{ClassifiedError, ErrorKind};
use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// Levels as a command line, a recipe or a caller of the library asks for them.
///
/// Written as in [`FromStr`]: `default`, `levels=6`, `levels=6,voices=2`, `steps=1,2.5,4` or `widths=0.5,2%`.
///
/// ```
/// use adwave::LevelSpec;
/// use adwave::region::Length;
/// let spec: LevelSpec = "widths=0.5,2%".parse()?;
/// assert_eq!(spec, LevelSpec::Widths(vec![Length::Units(0.5), Length::PercentOfDiagonal(2.0)]));
/// assert_eq!(spec.to_string(), "widths=0.5,2%");
/// # Ok::<(), adwave::LevelSpecError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LevelSpec {
    /// Dyadic levels, as many as reach a share of the diagonal.
    #[default]
    Default,
    /// A number of dyadic levels: 1, 2, 4 … steps.
    Dyadic(usize),
    /// Several levels for each doubling of the steps.
    Voices {
        /// Number of dyadic levels whose steps the last level reaches; the default number if `None`.
        levels: Option<usize>,
        /// Levels for each doubling.
        voices: usize,
    },
    /// Levels of these numbers of steps, increasing, whole or not.
    Steps(Vec<f64>),
    /// Levels of these widths σ, increasing.
    Widths(Vec<Length>),
}

/// A schedule of levels on a shape, and the reason for it.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedLevels {
    /// Steps of each level.
    pub schedule: Schedule,
    /// The number of levels and the reason for it, as part of a sentence.
    pub reason: String,
}

/// Error of levels that no shape can have, or of text that names no levels.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LevelSpecError {
    /// The number of levels, voices or steps is wrong.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// A width is not a length, or not wider than the one before it.
    #[error("width {nth} is {width:?}; widths must be positive, finite and increasing")]
    BadWidth {
        /// Number of the width, from 1.
        nth: usize,
        /// The width, in model units or percent as it was given.
        width: f64,
    },
    /// The text is in no form that names levels.
    #[error("levels must be default, levels=J, levels=J,voices=V, steps=N,N,… or widths=L,L,…, got '{0}'")]
    Syntax(String),
}

impl ClassifiedError for LevelSpecError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl LevelSpec {
    /// Levels of the given full widths at half maximum: the widths σ are these divided by [`FWHM`].
    pub fn from_fwhm(widths: &[Length]) -> Self {
        let sigma = |width: &Length| match *width {
            Length::Units(width) => Length::Units(width / FWHM),
            Length::PercentOfDiagonal(width) => Length::PercentOfDiagonal(width / FWHM),
            Length::Degrees(width) => Length::Degrees(width / FWHM),
        };
        Self::Widths(widths.iter().map(sigma).collect())
    }

    /// True if the levels are given by their widths, which should mean the same on every mesh.
    pub fn is_by_width(&self) -> bool {
        matches!(self, Self::Widths(_))
    }

    /// The task that decides which operator goes with these levels if none is asked for.
    pub fn operator_task(&self) -> OperatorTask {
        if self.is_by_width() { OperatorTask::WidthLevels } else { OperatorTask::StepLevels }
    }

    /// The task that decides which operator goes with these levels for a map or features of a shape if none is asked
    /// for: on a mesh the surface decides, not its triangles.
    pub fn analysis_task(&self, shape: &Shape) -> OperatorTask {
        if shape.is_mesh() { OperatorTask::Analysis } else { self.operator_task() }
    }

    /// Refuses levels that no shape can have.
    ///
    /// # Errors
    /// [`LevelSpecError`] for such levels. Widths of different units pass, because they cannot be compared before the
    /// shape is known.
    pub fn check(&self) -> Result<(), LevelSpecError> {
        match self {
            Self::Default => {}
            Self::Dyadic(levels) => {
                Schedule::dyadic(*levels)?;
            }
            Self::Voices { levels, voices } => {
                if let Some(levels) = levels {
                    Schedule::dyadic(*levels)?;
                }
                Schedule::voices(1, *voices)?;
            }
            Self::Steps(steps) => {
                Schedule::real(steps.clone())?;
            }
            Self::Widths(widths) => check_widths(widths)?,
        }
        Ok(())
    }

    /// The schedule of these levels on a shape. `extent` is the share of the diagonal that the last level reaches if no
    /// number of levels is asked for; for [`DEFAULT_EXTENT`](crate::bands::DEFAULT_EXTENT) that is
    /// [`Decomposer::default_schedule`].
    ///
    /// ```
    /// use adwave::{Decomposer, LevelSpec, bands::DEFAULT_EXTENT, sample::Sample, shape::Shape};
    /// let sphere = Sample::from_name("sphere", Some(300))?;
    /// let shape = Shape::Mesh(adwave::shape::Mesh::new(sphere.points, sphere.faces)?);
    /// let levels = LevelSpec::Dyadic(3).resolve(&Decomposer::new(&shape), DEFAULT_EXTENT)?;
    /// assert_eq!(levels.schedule.steps(), [1.0, 2.0, 4.0]);
    /// assert_eq!(levels.reason, "3 levels, the number asked for");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ScheduleError`] if the levels do not fit the shape.
    pub fn resolve(&self, decomposer: &Decomposer, extent: f64) -> Result<ResolvedLevels, ScheduleError> {
        let reaching = |levels: Option<usize>| match levels {
            Some(levels) => (levels, format!("{}, the number asked for", count_levels(levels))),
            None => decomposer.levels_reaching(extent),
        };
        match self {
            // Wider levels measure and edit nothing.
            Self::Default if extent <= DEFAULT_EXTENT => Ok(decomposer.default_schedule()),
            Self::Default => {
                let (levels, reason) = reaching(None);
                Ok(ResolvedLevels { schedule: Schedule::dyadic(levels)?, reason })
            }
            Self::Dyadic(levels) => {
                let (levels, reason) = reaching(Some(*levels));
                Ok(ResolvedLevels { schedule: Schedule::dyadic(levels)?, reason })
            }
            Self::Voices { levels, voices } => {
                let schedule = Schedule::voices(reaching(*levels).0, *voices)?;
                let reason =
                    format!("{}, {voices} for each doubling of the steps", count_levels(schedule.n_levels()));
                Ok(ResolvedLevels { schedule, reason })
            }
            Self::Steps(steps) => {
                let schedule = Schedule::real(steps.clone())?;
                let reason = format!("{}, of the steps asked for", count_levels(schedule.n_levels()));
                Ok(ResolvedLevels { schedule, reason })
            }
            Self::Widths(widths) => {
                let sigma = |width: &Length| decomposer.model_units(*width).ok_or(ScheduleError::NoSphere);
                let sigma: Vec<f64> = widths.iter().map(sigma).collect::<Result<_, _>>()?;
                let schedule = Schedule::lengths(&sigma, decomposer.operator().step_length())
                    .map_err(|error| in_asked_unit(error, widths))?;
                let reason = format!("{}, of the widths asked for", count_levels(schedule.n_levels()));
                Ok(ResolvedLevels { schedule, reason })
            }
        }
    }
}

/// An error with widths in the unit in which they were asked for.
fn in_asked_unit(error: ScheduleError, widths: &[Length]) -> ScheduleError {
    let ScheduleError::TooNarrow { level, sigma, least, unit } = error else { return error };
    let (asked, unit) = match widths[level - 1] {
        Length::Units(width) => (width, unit),
        Length::PercentOfDiagonal(percent) => (percent, "%"),
        Length::Degrees(angle) => (angle, "°"),
    };
    ScheduleError::TooNarrow { level, sigma: asked, least: least / sigma * asked, unit }
}

/// Refuses widths that are no lengths or do not increase.
fn check_widths(widths: &[Length]) -> Result<(), LevelSpecError> {
    let mut before = Length::Units(0.0);
    for (k, &width) in widths.iter().enumerate() {
        let is_wider = match (width, before) {
            (Length::Units(width), Length::Units(before))
            | (Length::PercentOfDiagonal(width), Length::PercentOfDiagonal(before))
            | (Length::Degrees(width), Length::Degrees(before)) => width > before,
            // Lengths of different units can be compared only if the shape is known.
            (Length::Units(width) | Length::PercentOfDiagonal(width) | Length::Degrees(width), _) => {
                width > 0.0
            }
        };
        let (Length::Units(number) | Length::PercentOfDiagonal(number) | Length::Degrees(number)) = width;
        if !(is_wider && number.is_finite()) {
            return Err(LevelSpecError::BadWidth { nth: k + 1, width: number });
        }
        before = width;
    }
    Ok(())
}

/// `1 level`, `2 levels`.
fn count_levels(n_levels: usize) -> String {
    format!("{n_levels} level{}", if n_levels == 1 { "" } else { "s" })
}

impl fmt::Display for LevelSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |numbers: Vec<String>| numbers.join(",");
        match self {
            Self::Default => f.write_str("default"),
            Self::Dyadic(levels) => write!(f, "levels={levels}"),
            Self::Voices { levels: Some(levels), voices } => write!(f, "levels={levels},voices={voices}"),
            Self::Voices { levels: None, voices } => write!(f, "voices={voices}"),
            Self::Steps(steps) => write!(f, "steps={}", list(steps.iter().map(f64::to_string).collect())),
            Self::Widths(widths) => {
                let text = |width: &Length| match width {
                    Length::Units(units) => units.to_string(),
                    Length::PercentOfDiagonal(percent) => format!("{percent}%"),
                    Length::Degrees(angle) => format!("{angle}deg"),
                };
                write!(f, "widths={}", list(widths.iter().map(text).collect()))
            }
        }
    }
}

impl FromStr for LevelSpec {
    type Err = LevelSpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || LevelSpecError::Syntax(text.to_owned());
        let count = |digits: &str| digits.trim().parse::<usize>().map_err(|_| wrong());
        let spec = match text.trim().split_once('=') {
            None if text.trim() == "default" => Self::Default,
            Some(("levels", rest)) => match rest.split_once(",voices=") {
                None => Self::Dyadic(count(rest)?),
                Some((levels, voices)) => {
                    Self::Voices { levels: Some(count(levels)?), voices: count(voices)? }
                }
            },
            Some(("voices", voices)) => Self::Voices { levels: None, voices: count(voices)? },
            Some(("steps", steps)) => {
                let step = |n: &str| n.trim().parse::<f64>().map_err(|_| wrong());
                Self::Steps(steps.split(',').map(step).collect::<Result<_, _>>()?)
            }
            Some(("widths", widths)) => {
                let width = |length: &str| Length::parse_width(length).map_err(|_| wrong());
                Self::Widths(widths.split(',').map(width).collect::<Result<_, _>>()?)
            }
            _ => return Err(wrong()),
        };
        spec.check()?;
        Ok(spec)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_reads_back_to_the_same_levels() {
        for text in [
            "default",
            "levels=6",
            "levels=6,voices=2",
            "voices=3",
            "steps=1,2.5,4",
            "widths=0.5,2%",
            "widths=5deg,10deg",
        ] {
            assert_eq!(text.parse::<LevelSpec>().unwrap().to_string(), text);
        }
        for bad in
            ["", "6", "levels=", "levels=0", "levels=33", "steps=2,1", "steps=x", "widths=2,1", "widths=0"]
        {
            assert!(bad.parse::<LevelSpec>().is_err(), "{bad}");
        }
    }

    #[test]
    fn widths_of_different_units_wait_for_the_shape() {
        let mixed = vec![Length::Units(5.0), Length::PercentOfDiagonal(1.0)];
        assert_eq!(LevelSpec::Widths(mixed).check(), Ok(()));
        let falling = vec![Length::PercentOfDiagonal(2.0), Length::PercentOfDiagonal(1.0)];
        let error = LevelSpec::Widths(falling).check().unwrap_err();
        assert_eq!(error, LevelSpecError::BadWidth { nth: 2, width: 1.0 });
        let endless = LevelSpec::Widths(vec![Length::Units(f64::INFINITY)]);
        assert!(endless.check().is_err());
    }
}
