//! What `saliency`, `features`, `evaluate` and `report` begin with: a shape, a signal on it, its diffusion operator, and the bands.

use crate::args::FieldArgs;
use crate::args::{LevelArgs, ShapeArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{bands_params, check_levels, schedule_reaching};
use crate::progress::{with_progress, with_spinner};
use crate::shape_input::{Input, load};
use crate::signal::{self, Signal};
use crate::stopwatch::Stopwatch;
use adwave::Decomposer;
use adwave::bands::Bands;
use std::time::Duration;

/// A shape split into bands.
pub(crate) struct Analysis {
    pub(crate) input: Input,
    pub(crate) walk: Decomposer,
    pub(crate) bands: Bands,
    /// Why there are so many levels.
    pub(crate) why: String,
    pub(crate) seconds: Seconds,
}

/// How long it took.
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) walk: f64,
    pub(crate) bands: f64,
}

impl Analysis {
    /// Where no number of levels is asked for they go up to `reach` of the diagonal.
    pub(crate) fn new(
        shape: &ShapeArgs,
        field: &FieldArgs,
        levels: &LevelArgs,
        reach: f64,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        // What cannot be, before a large file is read.
        bands_params(levels)?;
        check_levels(levels)?;
        let mut watch = Stopwatch::start();
        let input = with_spinner(global, "reading", || load(shape))?;
        Self::of(input, watch.lap(), shape, field, levels, reach, global)
    }

    /// The same of a shape that was read in that many seconds.
    pub(crate) fn of(
        input: Input,
        read: f64,
        shape: &ShapeArgs,
        field: &FieldArgs,
        levels: &LevelArgs,
        reach: f64,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        let params = bands_params(levels)?;
        let mut watch = Stopwatch::start();
        let (walk, signal) = with_spinner(global, "building the diffusion operator", || {
            // First the signal: a name that does not exist shows before the walk is built.
            let signal = signal::load_with_texture(&input, &field.field, field.texture.as_deref())?;
            let walk = Decomposer::new(&input.shape, &shape.operator());
            let walk = signal::mask(walk, &signal, &field.field, global)?;
            Ok::<(Decomposer, Signal), CliError>((walk, signal))
        })?;
        let (schedule, why) = schedule_reaching(reach, levels, &walk)?;
        let built = watch.lap();
        let bands = with_progress(global, "splitting", |progress| {
            walk.decompose(&signal.values, signal.n_channels, &schedule, &params, progress)
        })?;
        let seconds = Seconds { read, walk: built, bands: watch.lap() };
        Ok(Self { input, walk, bands, why, seconds })
    }

    /// `NAME: N vertices, coords` and why so many levels.
    pub(crate) fn headline(&self, field: &str) -> String {
        let n = self.bands.n_vertices;
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
        let Seconds { read, walk, bands } = self.seconds;
        format!(
            "read {read:.3} s, walk {walk:.3} s, bands {bands:.3} s, {what} {:.2} ms\n",
            1e3 * took.as_secs_f64()
        )
    }
}
