//! Bands along time of a signal whose channels are frames.

use super::signal::{COORDS, Signal, SignalValues};
use crate::args::{TimeArgs, TimeAxisArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{count, note, number};
use adwave::Progress;
use adwave::bands::FWHM;
use adwave::time::{TimeAxis, TimeEnds, TimeError};
use serde_json::{Value, json};
use std::fmt::Write;

/// Options that need widths along time.
const NEED_WIDTHS: [&str; 3] = ["--time-gains", "--time-step", "--time-ends"];

/// Vertices that are NaN in some frames, with their values in all frames.
pub(crate) type HeldRows = Vec<(usize, Vec<f64>)>;

/// Bands along time.
pub(crate) struct TimeBands {
    pub(crate) axis: TimeAxis,
    /// Widths σ of the bands, in seconds.
    pub(crate) widths: Vec<f64>,
    source: StepSource,
    held: HeldRows,
}

/// Source of the time from frame to frame.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepSource {
    File,
    Option,
    Assumed,
}

impl TimeBands {
    /// The bands that are asked for; `None` without widths. Vertices that are NaN in some frames become NaN in all.
    pub(crate) fn resolve(
        args: &TimeArgs,
        name: &str,
        signal: &mut Signal,
        global: &Global<'_>,
    ) -> Result<Option<Self>, CliError> {
        let Some(widths) = args.widths() else {
            global
                .given
                .refuse(&NEED_WIDTHS, "applies to bands along time (--time-fwhm or --time-lengths)")?;
            return Ok(None);
        };
        TimeAxis::check_widths(&widths).map_err(time_error)?;
        let (axis, held) = resolve_frames(&args.axis, name, signal, global)?;
        let source = if args.axis.time_step.is_none() { StepSource::File } else { StepSource::Option };
        Ok(Some(Self { axis, widths, source, held }))
    }

    /// The bands that are asked for along an axis that is known; `None` without widths.
    pub(crate) fn resolve_on_axis(
        args: &TimeArgs,
        axis: TimeAxis,
        source: StepSource,
    ) -> Result<Option<Self>, CliError> {
        let Some(widths) = args.widths() else { return Ok(None) };
        TimeAxis::check_widths(&widths).map_err(time_error)?;
        Ok(Some(Self { axis, widths, source, held: Vec::new() }))
    }

    /// Refuses gains that are not one finite number for each band.
    pub(crate) fn check_gains(&self, gains: &[f64]) -> Result<(), CliError> {
        TimeAxis::check_gains(self.widths.len(), gains).map_err(time_error)
    }

    /// Multiplies the bands of `values`, vertices × frames, by `gains`.
    pub(crate) fn filter(
        &self,
        values: &mut [f64],
        gains: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), CliError> {
        self.filter_components(values, 1, gains, progress)?;
        self.restore_held(values);
        Ok(())
    }

    /// Puts the values of vertices that are NaN in some frames back.
    pub(crate) fn restore_held(&self, values: &mut [f64]) {
        restore_held(&self.held, values);
    }

    /// Multiplies the bands of `values`, vertices × frames × components, by `gains`. Vertices with a value that is not
    /// finite keep their values.
    pub(crate) fn filter_components(
        &self,
        values: &mut [f64],
        n_components: usize,
        gains: &[f64],
        progress: Progress<'_>,
    ) -> Result<(), CliError> {
        self.axis.filter(values, n_components, &self.widths, gains, progress).map_err(time_error)
    }

    /// The bands of `values`, vertices × frames, fine to coarse, and the rest.
    pub(crate) fn bands(&self, values: &[f64], progress: Progress<'_>) -> Result<Vec<Vec<f64>>, CliError> {
        self.axis.bands(values, 1, &self.widths, progress).map_err(time_error)
    }

    /// Says what the frames and the bands are.
    pub(crate) fn describe(&self, text: &mut String, gains: Option<&[f64]>) {
        let list = |values: &[f64]| values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ");
        let source = match self.source {
            StepSource::File => "as the file says",
            StepSource::Option => "as given",
            StepSource::Assumed => "assumed",
        };
        let _ = write!(
            text,
            "time: {}, one every {} s ({source}); FWHM {} s",
            count(self.axis.n_frames(), "frame", "frames"),
            number(self.axis.step()),
            list(&self.fwhm())
        );
        if let Some(gains) = gains {
            let _ = write!(text, ", gains {}", list(gains));
        }
        match self.axis.ends() {
            TimeEnds::Causal => {
                let _ = write!(text, "; causal, late by {} s", number(self.axis.delay(&self.widths)));
            }
            ends => {
                let _ = write!(text, "; ends: {ends}");
            }
        }
        text.push('\n');
    }

    pub(crate) fn to_json(&self, gains: Option<&[f64]>) -> Value {
        json!({
            "frames": self.axis.n_frames(),
            "step": self.axis.step(),
            "step_is_from_file": self.source == StepSource::File,
            "sigma": self.widths,
            "fwhm": self.fwhm(),
            "gains": gains,
            "ends": self.axis.ends().name(),
            "delay": self.axis.delay(&self.widths),
        })
    }

    fn fwhm(&self) -> Vec<f64> {
        self.widths.iter().map(|sigma| sigma * FWHM).collect()
    }
}

/// The axis of time of a signal whose channels are frames. Vertices that are NaN in some frames become NaN in all.
pub(crate) fn resolve_frames(
    args: &TimeAxisArgs,
    name: &str,
    signal: &mut Signal,
    global: &Global<'_>,
) -> Result<(TimeAxis, HeldRows), CliError> {
    let n_frames = signal.n_channels;
    if name == COORDS {
        return Err(CliError::Input(
            "time needs a signal whose channels are frames (--signal), and coordinates are x, y, z"
                .to_owned(),
        ));
    }
    let Some(step) = args.time_step.or(signal.frame_step) else {
        return Err(CliError::Input(format!(
            "{name} does not say how long it is from one of its {} to the next; add --time-step, such as --time-step 2s",
            count(n_frames, "channel", "channels")
        )));
    };
    let axis = TimeAxis::new(n_frames, step)
        .and_then(|axis| axis.with_ends(args.time_ends.unwrap_or_default()))
        .map_err(|e| CliError::Input(format!("{name}: {e}")))?;
    let held = hold_partly_unknown(signal);
    if !held.is_empty() {
        let text = format!(
            "{name} is NaN in some frames at {}, which keep their values in all frames",
            count(held.len(), "vertex", "vertices")
        );
        note(global, &text);
    }
    Ok((axis, held))
}

/// Puts the values of vertices that are NaN in some frames back.
pub(crate) fn restore_held(held: &HeldRows, values: &mut [f64]) {
    for (vertex, held) in held {
        values[vertex * held.len()..][..held.len()].copy_from_slice(held);
    }
}

/// Error of a filter along time.
fn time_error(error: TimeError) -> CliError {
    match error {
        TimeError::Cancelled(_) => CliError::Cancelled,
        other => CliError::Input(other.to_string()),
    }
}

/// Sets all values of vertices that are NaN in some frames to NaN, and returns what they were.
fn hold_partly_unknown(signal: &mut Signal) -> HeldRows {
    let SignalValues::Other(values) = &mut signal.values else { return Vec::new() };
    let mut held = Vec::new();
    for (vertex, row) in values.chunks_exact_mut(signal.n_channels).enumerate() {
        let n_unknown = row.iter().filter(|value| value.is_nan()).count();
        if n_unknown > 0 && n_unknown < row.len() {
            held.push((vertex, row.to_vec()));
            row.fill(f64::NAN);
        }
    }
    held
}
