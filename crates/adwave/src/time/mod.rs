//! Time: a second axis of a signal, with bands of its own.
//!
//! The frames of a signal are the places of a line. Heat on that line, `Θ`, smooths along time as the operator Φ of a
//! domain smooths in space, so a signal of frames has the bands
//! `W_(j,i) = (Φ^{n_{j−1}} − Φ^{n_j}) ⊗ (Θ^{m_{i−1}} − Θ^{m_i})`. The two act on different axes and commute: apply
//! [`TimeAxis`] to the bands of space, or take the bands of space of what it returns.
//!
//! A width σ in units of time means what a width in space means: the standard deviation along the axis is σ/√2, and the
//! full width at half maximum 1.665 σ.
//!
//! ```
//! use adwave::Progress;
//! use adwave::time::{TimeAxis, TimeEnds};
//! // Two places with 200 frames, a frame every 0.5 s.
//! let frames: Vec<f64> = (0..400).map(|i| (0.05 * (i % 200) as f64).sin() + (i / 200) as f64).collect();
//! let axis = TimeAxis::new(200, 0.5)?;
//! let bands = axis.bands(&frames, 1, &[1.0, 4.0], Progress::none())?;
//! let sum: Vec<f64> = (0..400).map(|i| bands.iter().map(|band| band[i]).sum()).collect();
//! assert!(frames.iter().zip(&sum).all(|(a, b)| (a - b).abs() < 1e-13));
//! // No value depends on later frames; what comes out is late by the delay.
//! let causal = axis.with_ends(TimeEnds::Causal)?;
//! let mut smooth = frames.clone();
//! causal.smooth(&mut smooth, 1, 4.0, Progress::none())?;
//! assert!((causal.delay(&[4.0]) - 3.531).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod causal;

use crate::grid::lines::{LineBuffers, LineHeat, LineKind, Lines};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress, parallel};
use causal::{Cascade, filter_row};
use thiserror::Error;

/// Values that a thread takes at a time.
const VALUES_AT_A_TIME: usize = 1 << 14;

/// Parts of that size from one report of progress to the next.
const PARTS_TOGETHER: usize = 256;

/// Largest difference between steps that count as equal, relative to their mean.
const EVEN: f64 = 1e-6;

/// Frames of a signal along time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeAxis {
    n_frames: usize,
    steps: FrameSteps,
    ends: TimeEnds,
}

/// Steps between frames.
#[derive(Clone, Debug, PartialEq)]
enum FrameSteps {
    Even(f64),
    /// Gaps between frames, and the weights of the frames before and after each.
    Uneven {
        gaps: Vec<f64>,
        sides: Vec<[f64; 2]>,
    },
}

/// Frames beyond the ends, with which the first and the last ones are smoothed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum TimeEnds {
    /// The frames in reverse order: nothing flows past the ends.
    #[default]
    Reflect,
    /// The frames at the other end: time is a cycle, such as a day or a gait.
    Periodic,
    /// Earlier frames alone, everywhere. What comes out is late by [`TimeAxis::delay`].
    Causal,
}

crate::named_values!(TimeEnds, "ends of time", {
    Reflect => "reflect", "nothing flows past the first and the last frame";
    Periodic => "periodic", "the first frame follows the last";
    Causal => "causal", "each frame depends on itself and earlier ones alone, so that the result is late";
});

/// Error of an axis of time or of widths along it.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum TimeError {
    /// The time from frame to frame is not a positive number.
    #[error("the time from frame to frame must be a finite number above 0, got {step}")]
    Step {
        /// The step.
        step: f64,
    },
    /// The times of the frames do not increase.
    #[error("the times of the frames must increase, but frame {frame} is at {time} after {before}")]
    Times {
        /// Frame, from 0.
        frame: usize,
        /// Its time.
        time: f64,
        /// The time of the frame before.
        before: f64,
    },
    /// There are fewer than two frames.
    #[error("time needs at least 2 frames, got {n_frames}")]
    FewFrames {
        /// Number of frames.
        n_frames: usize,
    },
    /// Frames at uneven times cannot be a cycle.
    #[error("a cycle needs frames at equal steps; resample them, or let the ends reflect")]
    UnevenCycle,
    /// The values are not whole rows of frames.
    #[error(
        "a signal has {n_frames} frames of {n_components} values at each place, got {found} values in all"
    )]
    Values {
        /// Number of frames.
        n_frames: usize,
        /// Values of a frame at each place.
        n_components: usize,
        /// Number of values.
        found: usize,
    },
    /// The widths do not increase from above 0.
    #[error("widths along time must be finite, above 0 and increasing, got {widths:?}")]
    Widths {
        /// The widths σ.
        widths: Vec<f64>,
    },
    /// The gains do not fit the widths.
    #[error("each of the {n_bands} bands along time needs one finite gain, got {gains:?}")]
    Gains {
        /// Number of bands.
        n_bands: usize,
        /// The gains.
        gains: Vec<f64>,
    },
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for TimeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Cancelled(_) => ErrorKind::Cancelled,
            _ => ErrorKind::Input,
        }
    }
}

impl TimeAxis {
    /// The axis of `n_frames` frames, one every `step` units of time. The ends reflect.
    ///
    /// # Errors
    /// [`TimeError`] for fewer than two frames, or unless the step is a positive number.
    pub fn new(n_frames: usize, step: f64) -> Result<Self, TimeError> {
        if n_frames < 2 {
            return Err(TimeError::FewFrames { n_frames });
        }
        // Beyond these, squares are no normal numbers.
        if !(1e-100..1e100).contains(&step) {
            return Err(TimeError::Step { step });
        }
        Ok(Self { n_frames, steps: FrameSteps::Even(step), ends: TimeEnds::default() })
    }

    /// The axis of frames at these times, in any order of size of the gaps. Each frame stands for the time up to half of
    /// the way to its neighbors, and heat keeps the integral over time. The ends reflect.
    ///
    /// # Errors
    /// [`TimeError`] for fewer than two frames, or unless the times increase.
    pub fn from_times(times: &[f64]) -> Result<Self, TimeError> {
        let n_frames = times.len();
        let gaps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(at) = gaps.iter().position(|gap| !(1e-100..1e100).contains(gap)) {
            return Err(TimeError::Times { frame: at + 1, time: times[at + 1], before: times[at] });
        }
        let step = gaps.iter().sum::<f64>() / gaps.len().max(1) as f64;
        if n_frames < 2 || gaps.iter().all(|gap| (gap / step - 1.0).abs() <= EVEN) {
            return Self::new(n_frames, step);
        }
        let sides = (0..n_frames).map(|k| {
            let [before, after] = [k.checked_sub(1), Some(k)].map(|gap| gap.and_then(|gap| gaps.get(gap)));
            let own = 0.5 * (before.or(after).unwrap_or(&0.0) + after.or(before).unwrap_or(&0.0));
            [before, after].map(|gap| gap.map_or(0.0, |gap| 1.0 / (own * gap)))
        });
        let steps = FrameSteps::Uneven { sides: sides.collect(), gaps };
        Ok(Self { n_frames, steps, ends: TimeEnds::default() })
    }

    /// This axis with other ends.
    ///
    /// # Errors
    /// [`TimeError`] for a cycle of frames at uneven times.
    pub fn with_ends(self, ends: TimeEnds) -> Result<Self, TimeError> {
        if ends == TimeEnds::Periodic && matches!(self.steps, FrameSteps::Uneven { .. }) {
            return Err(TimeError::UnevenCycle);
        }
        Ok(Self { ends, ..self })
    }

    /// Number of frames.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Time from frame to frame; the mean for uneven times.
    pub fn step(&self) -> f64 {
        match &self.steps {
            FrameSteps::Even(step) => *step,
            FrameSteps::Uneven { gaps, .. } => gaps.iter().sum::<f64>() / gaps.len() as f64,
        }
    }

    /// Treatment of the ends.
    pub fn ends(&self) -> TimeEnds {
        self.ends
    }

    /// Time by which values smoothed by each of these widths in turn lag behind, 0 unless the axis is causal. For uneven
    /// times it is that of frames at the mean step.
    pub fn delay(&self, widths: &[f64]) -> f64 {
        if self.ends != TimeEnds::Causal {
            return 0.0;
        }
        let step = self.step();
        pairs(widths).map(|(from, to)| step * Cascade::new(from / step, to / step).delay()).sum()
    }

    /// Smooths `values`, places × frames × `n_components` with the last index fastest, by the width σ along time.
    /// Places with a value that is not finite keep their values. Constants are kept to the last bit. O(values).
    ///
    /// # Errors
    /// [`TimeError`] unless the values are whole rows of frames and σ is above 0, or if the call is cancelled.
    pub fn smooth(
        &self,
        values: &mut [f64],
        n_components: usize,
        sigma: f64,
        progress: Progress<'_>,
    ) -> Result<(), TimeError> {
        self.filter(values, n_components, &[sigma], &[0.0], progress)
    }

    /// Multiplies the bands of the widths σ_1 < … < σ_I along time by gains: `f + Σ_i (g_i − 1)·W_i`. `values` are as for
    /// [`smooth`](Self::smooth). O(values · widths).
    ///
    /// # Errors
    /// [`TimeError`] unless the values are whole rows of frames, the widths increase and there is a finite gain for each;
    /// or if the call is cancelled.
    pub fn filter(
        &self,
        values: &mut [f64],
        n_components: usize,
        widths: &[f64],
        gains: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), TimeError> {
        self.check(values.len(), n_components, widths)?;
        Self::check_gains(widths.len(), gains)?;
        let is_smoothing = gains.iter().all(|gain| *gain == 0.0);
        let row = self.n_frames * n_components;
        let levels = self.levels(n_components, widths);
        let together = rows_at_a_time(row) * PARTS_TOGETHER * row;
        let n_blocks = values.len().div_ceil(together);
        for (k, block) in values.chunks_mut(together).enumerate() {
            progress.step(k as u64, n_blocks as u64)?;
            parallel::try_visit_rows(block, row, rows_at_a_time(row), progress.quiet(), |_, rows| {
                let (mut scaling, mut finer) = (rows.to_vec(), Vec::new());
                fill_unknown(&mut scaling, row);
                for (gain, level) in gains.iter().zip(&levels) {
                    if is_smoothing {
                        level.advance(&mut scaling);
                        continue;
                    }
                    finer.clone_from(&scaling);
                    level.advance(&mut scaling);
                    for ((value, finer), coarser) in rows.iter_mut().zip(&finer).zip(&scaling) {
                        *value += (gain - 1.0) * (finer - coarser);
                    }
                }
                if is_smoothing {
                    for (own, smooth) in rows.chunks_exact_mut(row).zip(scaling.chunks_exact(row)) {
                        if own.iter().all(|value| value.is_finite()) {
                            own.copy_from_slice(smooth);
                        }
                    }
                }
            })?;
        }
        Ok(progress.step(n_blocks as u64, n_blocks as u64)?)
    }

    /// The bands W_1, …, W_I of the widths along time and the rest S_I, whose sum are the values. Shapes are as for
    /// [`smooth`](Self::smooth); at places with a value that is not finite all are NaN.
    ///
    /// # Errors
    /// [`TimeError`] unless the values are whole rows of frames and the widths increase, or if the call is cancelled.
    pub fn bands(
        &self,
        values: &[f64],
        n_components: usize,
        widths: &[f64],
        progress: Progress<'_>,
    ) -> Result<Vec<Vec<f64>>, TimeError> {
        self.check(values.len(), n_components, widths)?;
        let row = self.n_frames * n_components;
        let mut scaling = values.to_vec();
        let visit = |values: &mut [f64], work: &(dyn Fn(usize, &mut [f64]) + Sync)| {
            parallel::try_visit_rows(values, row, rows_at_a_time(row), progress, work)
        };
        visit(&mut scaling, &|_, rows| fill_unknown(rows, row))?;
        let mut bands = Vec::with_capacity(widths.len() + 1);
        for level in self.levels(n_components, widths) {
            let mut band = scaling.clone();
            visit(&mut scaling, &|_, rows| level.advance(rows))?;
            let scaling = &scaling;
            visit(&mut band, &|first, rows| {
                rows.iter_mut().zip(&scaling[first * row..]).for_each(|(b, s)| *b -= s);
            })?;
            bands.push(band);
        }
        bands.push(scaling);
        for band in &mut bands {
            visit(band, &|first, rows| {
                for (k, rows) in rows.chunks_exact_mut(row).enumerate() {
                    let range = (first + k) * row..(first + k + 1) * row;
                    if values[range].iter().any(|value| !value.is_finite()) {
                        rows.fill(f64::NAN);
                    }
                }
            })?;
        }
        Ok(bands)
    }

    fn check(&self, n_values: usize, n_components: usize, widths: &[f64]) -> Result<(), TimeError> {
        let row = self.n_frames * n_components;
        if row == 0 || !n_values.is_multiple_of(row) {
            return Err(TimeError::Values { n_frames: self.n_frames, n_components, found: n_values });
        }
        Self::check_widths(widths)
    }

    /// Checks widths along time without values.
    ///
    /// # Errors
    /// [`TimeError`] unless they increase from above 0.
    pub fn check_widths(widths: &[f64]) -> Result<(), TimeError> {
        let is_increasing = widths.windows(2).all(|pair| pair[0] < pair[1]);
        if widths.is_empty() || !is_increasing || widths.iter().any(|width| !(1e-100..1e100).contains(width))
        {
            return Err(TimeError::Widths { widths: widths.to_vec() });
        }
        Ok(())
    }

    /// Checks gains of `n_bands` bands along time without values.
    ///
    /// # Errors
    /// [`TimeError`] unless there is a finite gain for each band.
    pub fn check_gains(n_bands: usize, gains: &[f64]) -> Result<(), TimeError> {
        if gains.len() != n_bands || gains.iter().any(|gain| !gain.is_finite()) {
            return Err(TimeError::Gains { n_bands, gains: gains.to_vec() });
        }
        Ok(())
    }

    /// The steps from each width to the next, from 0.
    fn levels(&self, n_components: usize, widths: &[f64]) -> Vec<TimeLevel<'_>> {
        pairs(widths).map(|(from, to)| self.level(n_components, from, to)).collect()
    }

    /// The step from the width `from` to the width `to`.
    fn level(&self, n_components: usize, from: f64, to: f64) -> TimeLevel<'_> {
        /// Relative to the norm of a series: of the order of rounding.
        const ACCURACY: f64 = 1e-12;
        if self.ends == TimeEnds::Causal {
            let gaps = match &self.steps {
                FrameSteps::Even(_) => None,
                FrameSteps::Uneven { gaps, .. } => Some((gaps.as_slice(), self.step())),
            };
            let cascade = Cascade::new(from / self.step(), to / self.step());
            return TimeLevel::Causal { shares: cascade.shares(self.n_frames, gaps), n_components };
        }
        // The variance along the axis is half of σ², and twice the time of heat.
        let time = 0.25 * (to - from) * (to + from);
        let (kind, time) = match (&self.steps, self.ends) {
            (FrameSteps::Uneven { sides, .. }, _) => (LineKind::Uneven(sides), time),
            (FrameSteps::Even(step), TimeEnds::Periodic) => (LineKind::Ring, time / (step * step)),
            (FrameSteps::Even(step), _) => (LineKind::Even, time / (step * step)),
        };
        let lines = Lines::new(self.n_frames, n_components, kind);
        TimeLevel::Heat { heat: lines.heat(time, ACCURACY), lines }
    }
}

/// Smoothing from one width to the next, prepared.
enum TimeLevel<'a> {
    Heat { lines: Lines<'a>, heat: LineHeat },
    Causal { shares: Vec<f64>, n_components: usize },
}

impl TimeLevel<'_> {
    /// Smooths rows of values, frames × components, in place.
    fn advance(&self, rows: &mut [f64]) {
        match self {
            Self::Heat { lines, heat } => lines.diffuse_blocks(heat, &mut LineBuffers::default(), None, rows),
            Self::Causal { shares, n_components } => {
                for row in rows.chunks_exact_mut((shares.len() + 1) * n_components) {
                    filter_row(shares, *n_components, row);
                }
            }
        }
    }
}

/// Rows of this many values that a thread takes at a time.
fn rows_at_a_time(row: usize) -> usize {
    (VALUES_AT_A_TIME / row).max(1)
}

/// Pairs of consecutive widths, from 0.
fn pairs(widths: &[f64]) -> impl Iterator<Item = (f64, f64)> + '_ {
    std::iter::once(0.0).chain(widths.iter().copied()).zip(widths.iter().copied())
}

/// Fills each row that has a value that is not finite with 0: rows side by side are solved together.
fn fill_unknown(values: &mut [f64], row: usize) {
    for row in values.chunks_exact_mut(row) {
        if row.iter().any(|value| !value.is_finite()) {
            row.fill(0.0);
        }
    }
}
