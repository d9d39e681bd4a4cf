//! Schedules: the number of diffusion steps of each level.

use thiserror::Error;

/// Ratio of the full width at half maximum of diffusion on a surface to σ: `2·√(ln 2)`. σ is the root mean square of
/// the distance, σ/√2 along each of two axes, and a normal distribution is `2·√(2·ln 2)` standard deviations wide at
/// half its height.
pub const FWHM: f64 = 1.665_109_222_315_395_5;

/// The largest number of steps of a level: 2³¹, that is 32 dyadic levels.
pub const MAX_STEPS: u64 = 1 << 31;

/// The smallest number of steps of a level.
pub const MIN_STEPS: f64 = 1.0 / 64.0;

/// Largest number of levels per octave, that is, per doubling of the steps.
const MAX_VOICES: usize = 64;

/// Relative difference from a whole number below which a number of steps computed from a length counts as whole.
const WHOLE: f64 = 1e-12;

/// Error of a list of levels that is no schedule.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ScheduleError {
    /// There is no level.
    #[error("a schedule needs at least one level")]
    NoLevels,
    /// The number of steps of a level is below [`MIN_STEPS`] or not a number.
    #[error(
        "level {level} has {} steps; a level must have a finite number of them, at least {MIN_STEPS}; ask for more",
        format_number(*.steps)
    )]
    NoSteps {
        /// The level, from 1.
        level: usize,
        /// Number of steps of the level.
        steps: f64,
    },
    /// A level is narrower than the width of [`MIN_STEPS`].
    #[error(
        "level {level} has the width σ = {}{unit}, but the narrowest here is σ = {}{unit}, a full width at half maximum of {}{unit}; take a wider level, or a finer shape",
        format_rounded(*.sigma), format_rounded(*.least), format_rounded(FWHM * .least)
    )]
    TooNarrow {
        /// The level, from 1.
        level: usize,
        /// σ of the level in the unit.
        sigma: f64,
        /// The smallest σ in the unit.
        least: f64,
        /// The unit in which the width was asked for: `°`, `%` of the diagonal, or nothing for model units.
        unit: &'static str,
    },
    /// A level does not have more steps than the one before it.
    #[error("level {level} has {steps} steps, not more than the {before} of level {}; steps must increase", .level - 1)]
    NotIncreasing {
        /// The level, from 1.
        level: usize,
        /// Number of steps of the level.
        steps: f64,
        /// The steps of the level before it.
        before: f64,
    },
    /// A level has more than [`MAX_STEPS`] steps.
    #[error("level {level} would take more than 2^31 steps; ask for at most 32 dyadic levels")]
    TooManySteps {
        /// The level, from 1.
        level: usize,
    },
    /// A width is an arc, and the places lie on no sphere about the origin.
    #[error(
        "a width in degrees needs places on a sphere about the origin; give it in the unit of the coordinates"
    )]
    NoSphere,
    /// The number of voices is 0 or larger than 64.
    #[error("the number of voices per octave must be in 1..={MAX_VOICES}, got {n_voices}")]
    Voices {
        /// The number asked for.
        n_voices: usize,
    },
    /// A length is not finite, positive and larger than the one before it, or the diffusion does not move.
    #[error(
        "length {index} is {}: lengths must be finite, positive and increasing, and the diffusion must move (its step is {step_length} long)",
        format_number(*.length)
    )]
    BadLength {
        /// Index of the length, from 0.
        index: usize,
        /// The length in model units.
        length: f64,
        /// Root mean square length of one step in model units.
        step_length: f64,
    },
}

impl crate::ClassifiedError for ScheduleError {
    fn kind(&self) -> crate::ErrorKind {
        crate::ErrorKind::Input
    }
}

/// Formats a number with three digits, rounded up, so that a smallest number is no less than it was.
fn format_rounded(number: f64) -> String {
    if !(number.is_finite() && number > 0.0) {
        return number.to_string();
    }
    let unit = 10.0_f64.powi(number.log10().floor() as i32 - 2);
    let rounded = (number / unit - 1e-9).ceil() * unit;
    format_number(format!("{rounded:.2e}").parse().unwrap_or(rounded))
}

/// Formats a number with few digits at any magnitude.
fn format_number(number: f64) -> String {
    if number == 0.0 || (1e-6..1e12).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// Numbers of diffusion steps of the levels: n_1 < n_2 < … < n_J, whole or fractional.
///
/// `Φ₁ⁿ` of a real n > 0 is the power of the operator's spectrum, which lies in [0, 1] where it is reversible. Whole
/// steps are taken where they are asked for: they cost nothing extra and work for every operator.
///
/// ```
/// use adwave::bands::Schedule;
/// assert_eq!(Schedule::dyadic(5)?.steps(), [1.0, 2.0, 4.0, 8.0, 16.0]);
/// assert_eq!(Schedule::voices(3, 2)?.rounded().steps(), [1.0, 2.0, 3.0, 4.0]);
/// assert_eq!(Schedule::real(vec![0.5, 1.25])?.whole_steps(), None);
/// # Ok::<(), adwave::bands::ScheduleError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Whole numbers up to 2³¹ are exact.
    steps: Vec<f64>,
}

impl Schedule {
    /// Levels of the given whole numbers of steps.
    ///
    /// # Errors
    /// [`ScheduleError`] unless `steps` is increasing, starts at 1 or more and ends at 2³¹ at most.
    pub fn new(steps: Vec<u64>) -> Result<Self, ScheduleError> {
        Self::real(steps.into_iter().map(|n| n as f64).collect())
    }

    /// Levels of the given numbers of steps, whole or not.
    ///
    /// # Errors
    /// [`ScheduleError`] unless `steps` is increasing, starts at [`MIN_STEPS`] or more and ends at 2³¹ at most.
    pub fn real(steps: Vec<f64>) -> Result<Self, ScheduleError> {
        if steps.is_empty() {
            return Err(ScheduleError::NoLevels);
        }
        for (j, &n) in steps.iter().enumerate() {
            let level = j + 1;
            if n > MAX_STEPS as f64 {
                return Err(ScheduleError::TooManySteps { level });
            }
            if n.is_nan() || n < MIN_STEPS {
                return Err(ScheduleError::NoSteps { level, steps: n });
            }
            if j > 0 && n <= steps[j - 1] {
                return Err(ScheduleError::NotIncreasing { level, steps: n, before: steps[j - 1] });
            }
        }
        Ok(Self { steps })
    }

    /// The dyadic levels of the paper: `n_j = 2^(j−1)`, j = 1 … `n_levels`.
    ///
    /// # Errors
    /// [`ScheduleError`] when `n_levels` is 0 or more than 32.
    pub fn dyadic(n_levels: usize) -> Result<Self, ScheduleError> {
        let longest = MAX_STEPS.ilog2() as usize + 1;
        if n_levels > longest {
            return Err(ScheduleError::TooManySteps { level: longest + 1 });
        }
        Self::new((0..n_levels as u32).map(|j| 1 << j).collect())
    }

    /// `n_voices` levels for each doubling of the steps, up to the steps of `n_levels` dyadic levels: n_j =
    /// 2^((j−1)/voices), so that σ grows by the same factor `2^(1/(2·voices))` from each level to the next.
    ///
    /// # Errors
    /// [`ScheduleError`] as for [`dyadic`](Self::dyadic), or when there is no voice or more than 64 of them.
    pub fn voices(n_levels: usize, n_voices: usize) -> Result<Self, ScheduleError> {
        let octaves = Self::dyadic(n_levels)?.n_levels() - 1;
        if !(1..=MAX_VOICES).contains(&n_voices) {
            return Err(ScheduleError::Voices { n_voices });
        }
        let level = |k: usize| {
            let (octave, voice) = (k / n_voices, k % n_voices);
            // Whole octaves are whole numbers to the last bit.
            (1_u64 << octave) as f64 * (voice as f64 / n_voices as f64).exp2()
        };
        Self::real((0..=octaves * n_voices).map(level).collect())
    }

    /// Levels of the widths `lengths` (model units) for a diffusion of step length `s`: σ = s·√n, so n = (σ/s)². A
    /// number of steps that is whole but for rounding is taken for whole.
    ///
    /// # Errors
    /// [`ScheduleError`] unless the lengths are positive, increasing and within [`MIN_STEPS`] to 2³¹ steps.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// assert_eq!(Schedule::lengths(&[0.5, 0.75], 0.5)?.steps(), [1.0, 2.25]);
    /// # Ok::<(), adwave::bands::ScheduleError>(())
    /// ```
    pub fn lengths(lengths: &[f64], step_length: f64) -> Result<Self, ScheduleError> {
        let mut steps: Vec<f64> = Vec::new();
        let mut before = 0.0;
        for (index, &length) in lengths.iter().enumerate() {
            let n = (length / step_length).powi(2);
            if !(length.is_finite() && length > before && step_length > 0.0 && n.is_finite()) {
                return Err(ScheduleError::BadLength { index, length, step_length });
            }
            before = length;
            if n < MIN_STEPS {
                let least = MIN_STEPS.sqrt() * step_length;
                return Err(ScheduleError::TooNarrow { level: index + 1, sigma: length, least, unit: "" });
            }
            let whole = n.round();
            steps.push(if (n - whole).abs() <= WHOLE * n { whole } else { n });
        }
        Self::real(steps)
    }

    /// This schedule with whole numbers of steps, each at least 1 and without repetitions, for operators that are not
    /// reversible, and for the functions φ and ψ themselves.
    #[must_use]
    pub fn rounded(&self) -> Self {
        let mut steps: Vec<f64> = self.steps.iter().map(|n| n.round().max(1.0)).collect();
        steps.dedup();
        Self { steps }
    }

    /// Steps of each level, n_1 … n_J.
    pub fn steps(&self) -> &[f64] {
        &self.steps
    }

    /// Steps of each level; `None` unless all of them are whole.
    pub fn whole_steps(&self) -> Option<Vec<u64>> {
        self.first_real().is_none().then(|| self.steps.iter().map(|&n| n as u64).collect())
    }

    /// First level, from 1, with a fractional number of steps; `None` if there is none.
    pub fn first_real(&self) -> Option<usize> {
        self.steps.iter().position(|n| n.fract() != 0.0).map(|j| j + 1)
    }

    /// J, the number of levels.
    pub fn n_levels(&self) -> usize {
        self.steps.len()
    }

    /// Steps of level j, with 0 steps on level 0: n_0 … n_J.
    pub fn steps_from_zero(&self) -> Vec<f64> {
        std::iter::once(0.0).chain(self.steps.iter().copied()).collect()
    }

    /// Widths σ_j = s·√n_j of the levels 0 … J in the unit of `step_length`; σ_0 = 0.
    pub fn sigma(&self, step_length: f64) -> Vec<f64> {
        self.steps_from_zero().into_iter().map(|n| step_length * n.sqrt()).collect()
    }
}

/// Default width of the last level, as a share of the bounding box's diagonal.
pub const DEFAULT_EXTENT: f64 = 0.02;

/// Default number of dyadic levels and the reason for it: [`levels_reaching`] for [`DEFAULT_EXTENT`].
///
/// ```
/// use adwave::bands::default_levels;
/// assert_eq!(default_levels(0.003, 1.0).0, 7); // 0.003·√64 = 0.024 ≥ 0.02
/// ```
pub fn default_levels(step_length: f64, diagonal: f64) -> (usize, String) {
    levels_reaching(DEFAULT_EXTENT, step_length, diagonal)
}

/// The number of dyadic levels whose last is as wide as a share of the diagonal, and the reason for it.
///
/// The smallest J with σ_J ≥ `share`·`diagonal`, at least 4 and at most 16, so that a command has the same effect on a
/// coarse and on a fine mesh of one shape. Without a diagonal (on a graph) it is 6.
///
/// ```
/// use adwave::bands::levels_reaching;
/// let (levels, why) = levels_reaching(0.04, 0.003, 1.0);
/// assert_eq!(levels, 9); // 0.003·√256 = 0.048 ≥ 0.04
/// assert!(why.contains("≥ 4 % of the diagonal"));
/// ```
pub fn levels_reaching(share: f64, step_length: f64, diagonal: f64) -> (usize, String) {
    const FEWEST: usize = 4;
    const MOST: usize = 16;
    const WITHOUT_LENGTH: usize = 6;
    if !(diagonal > 0.0 && step_length > 0.0) {
        return (WITHOUT_LENGTH, format!("{WITHOUT_LENGTH} levels, because the shape has no extent"));
    }
    let target = share * diagonal;
    let sigma = |j: usize| step_length * ((j as f64 - 1.0) / 2.0).exp2();
    let levels = (FEWEST..MOST).find(|&j| sigma(j) >= target).unwrap_or(MOST);
    let percent = 100.0 * sigma(levels) / diagonal;
    let why = match levels {
        FEWEST => {
            format!("{FEWEST} levels, the fewest: σ_{FEWEST} is already {percent:.3} % of the diagonal")
        }
        MOST if sigma(MOST) < target => {
            format!("{MOST} levels, the most by default: σ_{MOST} is {percent:.3} % of the diagonal")
        }
        _ => {
            let least = (1e5 * share).round() / 1e3;
            format!(
                "{levels} levels: the first with σ_{levels} ≥ {least} % of the diagonal (it is {percent:.3} %)"
            )
        }
    };
    (levels, why)
}
