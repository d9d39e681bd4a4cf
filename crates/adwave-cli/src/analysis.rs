//! What `saliency`, `features`, `evaluate` and `report` begin with: a shape, a signal on it, its diffusion operator, and the bands.

use crate::args::FieldArgs;
use crate::args::{LevelArgs, ShapeArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{bands_params, check_levels, schedule_reaching};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::shape_input::{Input, load};
use crate::signal::{self, Signal};
use crate::stopwatch::Stopwatch;
use adwave::bands::{Bands, BandsError, BandsParams, Schedule, Wavelets};
use adwave::features::Response;
use adwave::{BandsRequest, Decomposer};
use std::time::Duration;

/// A shape that is prepared for a signal.
pub(crate) struct Analysis {
    pub(crate) input: Input,
    pub(crate) walk: Decomposer,
    pub(crate) signal: Signal,
    pub(crate) schedule: Schedule,
    params: BandsParams,
    /// Why there are so many levels.
    pub(crate) why: String,
    pub(crate) seconds: Seconds,
}

/// How long it took.
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) diffusion: f64,
    pub(crate) bands: f64,
}

impl Analysis {
    /// Where no number of levels is asked for they go up to `share` of the diagonal.
    pub(crate) fn new(
        shape: &ShapeArgs,
        field: &FieldArgs,
        levels: &LevelArgs,
        share: f64,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        // What cannot be, before a large file is read.
        bands_params(levels)?;
        check_levels(levels)?;
        let mut watch = Stopwatch::start();
        let input = with_spinner(global, "reading", || load(shape))?;
        Self::of(input, watch.lap(), shape, field, levels, share, global)
    }

    /// The same of a shape that was read in that many seconds.
    pub(crate) fn of(
        input: Input,
        read: f64,
        shape: &ShapeArgs,
        field: &FieldArgs,
        levels: &LevelArgs,
        share: f64,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        let params = bands_params(levels)?;
        let mut watch = Stopwatch::start();
        // First the signal: a name that does not exist shows before the operator is built.
        let signal = signal::load_with_texture(&input, &field.field, field.texture.as_deref())?;
        let walk = prepare(global, &input.shape, &shape.operator_for(levels)?)?;
        let walk = signal::mask(walk, &signal, &field.field, global)?;
        let (schedule, why) = schedule_reaching(share, levels, &walk)?;
        let seconds = Seconds { read, diffusion: watch.lap(), bands: 0.0 };
        Ok(Self { input, walk, signal, schedule, params, why, seconds })
    }

    /// Asks for something of the signal's bands, and notes how long that took.
    fn ask<T>(
        &mut self,
        global: &Global<'_>,
        what: impl FnOnce(BandsRequest<'_>) -> Result<T, BandsError>,
    ) -> Result<T, CliError> {
        let mut watch = Stopwatch::start();
        let found = with_progress(global, "splitting", |progress| {
            let request = self.walk.request(&self.signal.values, self.signal.n_channels, &self.schedule);
            what(request.params(&self.params).progress(progress))
        })?;
        self.seconds.bands = watch.lap();
        Ok(found)
    }

    /// All bands.
    pub(crate) fn bands(&mut self, global: &Global<'_>) -> Result<Bands, CliError> {
        self.ask(global, |request| request.bands())
    }

    /// The wavelet coefficients for saliency and features: their norms unless every channel counts by itself.
    pub(crate) fn wavelets(
        &mut self,
        global: &Global<'_>,
        response: Option<Response>,
    ) -> Result<Wavelets, CliError> {
        match response {
            Some(Response::Channels) => self.ask(global, |request| request.wavelets()),
            _ => self.ask(global, |request| request.norms()),
        }
    }

    /// Widths σ_j of the levels 0 … J in model units.
    pub(crate) fn sigma(&self) -> Vec<f64> {
        self.schedule.sigma(self.walk.diffusion().step_length())
    }

    /// `NAME: N vertices, coords` and why so many levels.
    pub(crate) fn headline(&self, field: &str) -> String {
        let n = self.walk.n_vertices();
        let masked = self.walk.mask_flags().map_or(0, |out| out.iter().filter(|&&out| out).count());
        let masked = if masked > 0 { format!(", {masked} of them masked") } else { String::new() };
        format!("{}: {n} vertices{masked}, {field}\n{}\n", self.input.name, self.why)
    }

    /// σ_j in % of the bounding box's diagonal.
    pub(crate) fn percent(&self, sigma: f64) -> f64 {
        let diagonal = self.walk.diagonal();
        if diagonal > 0.0 { 100.0 * sigma / diagonal } else { 0.0 }
    }

    /// How long it took, in words.
    pub(crate) fn timing(&self, what: &str, took: Duration) -> String {
        let Seconds { read, diffusion, bands } = self.seconds;
        format!(
            "read {read:.3} s, diffusion {diffusion:.3} s, bands {bands:.3} s, {what} {:.2} ms\n",
            1e3 * took.as_secs_f64()
        )
    }
}
