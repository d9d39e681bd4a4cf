//! Which numbers of steps the levels stand for.

use thiserror::Error;

/// The largest number of steps of a level: 2³¹, that is 32 dyadic levels.
pub const MAX_STEPS: u64 = 1 << 31;

/// Why a list of levels is no schedule.
#[derive(Debug, Error, PartialEq)]
pub enum ScheduleError {
    /// There is no level.
    #[error("a schedule needs at least one level")]
    NoLevels,
    /// A level stands for no step at all.
    #[error("level {level} has 0 steps; the first level needs at least 1")]
    NoSteps {
        /// The level, from 1.
        level: usize,
    },
    /// A level does not have more steps than the one before it.
    #[error("level {level} has {steps} steps, not more than the {before} of level {}; steps must increase", .level - 1)]
    NotIncreasing {
        /// The level, from 1.
        level: usize,
        /// Its steps.
        steps: u64,
        /// The steps of the level before it.
        before: u64,
    },
    /// A level has more steps than can be counted on.
    #[error("level {level} would take more than 2^31 steps; ask for at most 32 dyadic levels")]
    TooManySteps {
        /// The level, from 1.
        level: usize,
    },
    /// A number of voices that is not at least 1.
    #[error("an octave needs at least one voice")]
    NoVoices,
    /// A length that no number of steps of this walk spreads to.
    #[error(
        "length {index} is {length}: lengths must be finite, positive and increasing, and the walk must move (its step is {step_length})"
    )]
    BadLength {
        /// Which length, from 0.
        index: usize,
        /// The length in model units.
        length: f64,
        /// Root mean square length of one step in model units.
        step_length: f64,
    },
}

/// How many steps of the walk each level stands for: n_1 < n_2 < … < n_J, all at least 1.
///
/// ```
/// use adwave::bands::Schedule;
/// assert_eq!(Schedule::dyadic(5)?.steps(), [1, 2, 4, 8, 16]);
/// assert_eq!(Schedule::voices(4, 2)?.steps(), [1, 2, 3, 4, 6, 8]);
/// # Ok::<(), adwave::bands::ScheduleError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schedule {
    steps: Vec<u64>,
}

impl Schedule {
    /// Levels of the given numbers of steps.
    ///
    /// # Errors
    /// [`ScheduleError`] unless `steps` is increasing, starts at 1 or more and ends at 2³¹ at most.
    pub fn new(steps: Vec<u64>) -> Result<Self, ScheduleError> {
        if steps.is_empty() {
            return Err(ScheduleError::NoLevels);
        }
        for (j, &n) in steps.iter().enumerate() {
            let level = j + 1;
            if n == 0 {
                return Err(ScheduleError::NoSteps { level });
            }
            if n > MAX_STEPS {
                return Err(ScheduleError::TooManySteps { level });
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

    /// `n_voices` levels for each doubling of the steps, up to the steps of `n_levels` dyadic levels: n = 2^(k/voices),
    /// rounded, each number once.
    ///
    /// # Errors
    /// [`ScheduleError`] as for [`dyadic`](Self::dyadic), or when there is no voice.
    pub fn voices(n_levels: usize, n_voices: usize) -> Result<Self, ScheduleError> {
        let last = *Self::dyadic(n_levels)?.steps.last().expect("a schedule has a level");
        if n_voices == 0 {
            return Err(ScheduleError::NoVoices);
        }
        let mut steps = Vec::new();
        // An octave has at most as many distinct numbers as steps: enough rounds to reach the last.
        for k in 0_u32.. {
            let n = (f64::from(k) / n_voices as f64).exp2().round() as u64;
            if n > last {
                break;
            }
            if steps.last() != Some(&n) {
                steps.push(n);
            }
            if n == last {
                break;
            }
        }
        Self::new(steps)
    }

    /// Levels whose widths σ = s·√n are nearest to `lengths` (model units), for a walk of step length `s`. Lengths that
    /// come to the same number of steps are one level.
    ///
    /// # Errors
    /// [`ScheduleError`] unless the lengths are positive, increasing and within 2³¹ steps.
    pub fn lengths(lengths: &[f64], step_length: f64) -> Result<Self, ScheduleError> {
        let mut steps: Vec<u64> = Vec::new();
        let mut before = 0.0;
        for (index, &length) in lengths.iter().enumerate() {
            let n = (length / step_length).powi(2).round().max(1.0);
            if !(length.is_finite() && length > before && step_length > 0.0 && n.is_finite()) {
                return Err(ScheduleError::BadLength { index, length, step_length });
            }
            before = length;
            if n > MAX_STEPS as f64 {
                return Err(ScheduleError::TooManySteps { level: index + 1 });
            }
            if steps.last() != Some(&(n as u64)) {
                steps.push(n as u64);
            }
        }
        Self::new(steps)
    }

    /// Steps of each level, n_1 … n_J.
    pub fn steps(&self) -> &[u64] {
        &self.steps
    }

    /// J, the number of levels.
    pub fn n_levels(&self) -> usize {
        self.steps.len()
    }

    /// Steps of level j, with 0 steps on level 0: n_0 … n_J.
    pub fn steps_from_zero(&self) -> Vec<u64> {
        std::iter::once(0).chain(self.steps.iter().copied()).collect()
    }

    /// Widths σ_j = s·√n_j of the levels 0 … J in the unit of `step_length`; σ_0 = 0.
    pub fn sigma(&self, step_length: f64) -> Vec<f64> {
        self.steps_from_zero().into_iter().map(|n| step_length * (n as f64).sqrt()).collect()
    }
}

/// The number of dyadic levels to take where none is asked for, and why.
///
/// The smallest J with σ_J ≥ 2 % of `diagonal`, at least 4 and at most 16, so that the same command does the same to a
/// coarse and to a fine mesh of one shape. Where there is no diagonal (a graph) it is 6.
///
/// ```
/// use adwave::bands::default_levels;
/// assert_eq!(default_levels(0.003, 1.0).0, 7); // 0.003·√64 = 0.024 ≥ 0.02
/// ```
pub fn default_levels(step_length: f64, diagonal: f64) -> (usize, String) {
    const FEWEST: usize = 4;
    const MOST: usize = 16;
    const WITHOUT_LENGTH: usize = 6;
    if !(diagonal > 0.0 && step_length > 0.0) {
        return (WITHOUT_LENGTH, format!("{WITHOUT_LENGTH} levels, because the shape has no extent"));
    }
    let target = 0.02 * diagonal;
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
            format!("{levels} levels: the first with σ_{levels} ≥ 2 % of the diagonal (it is {percent:.3} %)")
        }
    };
    (levels, why)
}
