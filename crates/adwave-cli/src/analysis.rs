//! What `saliency`, `features`, `evaluate` and `report` begin with: a shape, a signal on it, its diffusion operator, and the bands.

use crate::args::{BorderArgs, FieldArgs, LevelArgs, MapArgs, ShapeArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{bands_params, check_levels, schedule_reaching};
use crate::progress::{prepare, with_progress, with_spinner};
use crate::shape_input::{Input, load};
use crate::signal::{self, Signal, Values};
use crate::stopwatch::Stopwatch;
use adwave::bands::{Bands, BandsError, BandsParams, Schedule, Wavelets};
use adwave::features::Response;
use adwave::saliency::{Saliency, SaliencyParams, Sign, saliency, with_height};
use adwave::shape::Shape;
use adwave::signal::{OutwardInfo, outward_normals};
use adwave::{BandsRequest, Decomposer};
use serde_json::{Value, json};

/// A shape that is prepared for a signal.
pub(crate) struct Analysis {
    pub(crate) input: Input,
    pub(crate) decomposer: Decomposer,
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

/// A saliency map, and what it was made of.
pub(crate) struct Map {
    pub(crate) saliency: Saliency,
    /// One channel: what the map is the sum of.
    pub(crate) wavelets: Wavelets,
    pub(crate) params: SaliencyParams,
    /// Whether + and - are different sides.
    pub(crate) is_signed: bool,
    /// How the outside was found, where the signal is the shape.
    pub(crate) outward: Option<OutwardInfo>,
    /// Seconds for the map alone.
    pub(crate) took: f64,
}

impl Map {
    /// In a line which sides the signs stand for, or why there are none.
    pub(crate) fn sides(&self) -> String {
        match (&self.outward, self.is_signed) {
            (Some(outward), true) => format!("+ convex, - concave; {outward}"),
            (Some(outward), false) if !outward.has_outside() => format!("unsigned: {outward}"),
            (None, true) => "+ above its surroundings, - below".to_owned(),
            (_, false) => "unsigned".to_owned(),
        }
    }

    /// The same for machines.
    pub(crate) fn sides_json(&self) -> Value {
        let outside = self.outward.as_ref().map(|o| {
            json!({
                "found": o.has_outside(), "how": o.to_string(), "parts": o.n_parts, "closed": o.n_closed,
                "by_file": o.n_by_file, "by_majority": o.n_by_majority, "as_given": o.n_as_given,
                "without": o.n_without, "turned_triangles": o.n_turned, "share_without": o.without,
            })
        });
        json!({ "signed": self.is_signed, "outside": outside })
    }
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
        let input = with_spinner(global, "reading", || load(shape, global))?;
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
        let signal = signal::load(global, &input, field.name(), field.texture.as_deref())?;
        let decomposer = prepare(global, &input.shape, &shape.operator_for(levels)?)?;
        let decomposer = signal::mask(decomposer, &signal, field.name(), global)?;
        let (schedule, why) = schedule_reaching(share, levels, &decomposer, global)?;
        let seconds = Seconds { read, diffusion: watch.lap(), bands: 0.0 };
        Ok(Self { input, decomposer, signal, schedule, params, why, seconds })
    }

    /// Asks for something of the signal's bands, and notes how long that took.
    fn ask<T>(
        &mut self,
        global: &Global<'_>,
        what: impl FnOnce(BandsRequest<'_>) -> Result<T, BandsError>,
    ) -> Result<T, CliError> {
        let mut watch = Stopwatch::start();
        let found = with_progress(global, "splitting", |progress| {
            let request =
                self.decomposer.request(&self.signal.values, self.signal.n_channels, &self.schedule);
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

    /// The map of where the signal stands out; of coordinates to which side, where one is outside.
    pub(crate) fn saliency(
        &mut self,
        map: &MapArgs,
        border: &BorderArgs,
        global: &Global<'_>,
    ) -> Result<Map, CliError> {
        let outward = if map.is_along_normals() && self.is_geometry() {
            let normals = signal::file_normals(&self.input.file);
            let found = outward_normals(self.decomposer.geometry(), normals.as_deref(), global.progress());
            Some(found.map_err(|e| CliError::classified(&e))?)
        } else {
            None
        };
        let (wavelets, has_sign) = match &outward {
            Some(outward) if outward.info.has_outside() => {
                (self.ask(global, |request| request.along_normals(&outward.normals))?, true)
            }
            _ => (self.wavelets(global, None)?, self.signal.n_channels == 1),
        };
        let params = map.params(border);
        let mut watch = Stopwatch::start();
        let mut saliency = saliency(&self.decomposer, &wavelets, &params, global.progress())
            .map_err(|e| CliError::classified(&e))?;
        if let Some(axis) = map.up {
            let Some(points) = self.input.shape.points() else {
                return Err(CliError::Input(format!(
                    "{}: a graph has no heights; leave out --up",
                    self.input.name
                )));
            };
            let heights: Vec<f64> = points.iter().map(|p| p[axis as usize]).collect();
            saliency.map = with_height(&saliency.map, &heights);
        }
        let took = watch.lap();
        let is_signed = has_sign && params.sign == Sign::Signed && map.up.is_none();
        Ok(Map { saliency, wavelets, params, is_signed, outward: outward.map(|o| o.info), took })
    }

    /// Whether the signal is the shape itself.
    fn is_geometry(&self) -> bool {
        matches!(self.signal.values, Values::Coordinates(_)) && !matches!(self.input.shape, Shape::Graph(_))
    }

    /// Widths σ_j of the levels 0 … J in model units.
    pub(crate) fn sigma(&self) -> Vec<f64> {
        self.schedule.sigma(self.decomposer.diffusion().step_length())
    }

    /// `NAME: N vertices, coords` and why so many levels.
    pub(crate) fn headline(&self, field: &str) -> String {
        let n = self.decomposer.n_vertices();
        let masked = self.decomposer.mask_flags().map_or(0, |out| out.iter().filter(|&&out| out).count());
        let masked = if masked > 0 { format!(", {masked} of them masked") } else { String::new() };
        format!("{}: {n} vertices{masked}, {field}\n{}\n", self.input.name, self.why)
    }

    /// σ_j in % of the bounding box's diagonal.
    pub(crate) fn percent(&self, sigma: f64) -> f64 {
        let diagonal = self.decomposer.diagonal();
        if diagonal > 0.0 { 100.0 * sigma / diagonal } else { 0.0 }
    }

    /// How long it took, in words.
    pub(crate) fn timing(&self, what: &str, took: f64) -> String {
        let Seconds { read, diffusion, bands } = self.seconds;
        format!(
            "read {read:.3} s, diffusion {diffusion:.3} s, bands {bands:.3} s, {what} {:.2} ms\n",
            1e3 * took
        )
    }
}
