//! Common beginning of `saliency`, `features`, `evaluate` and `report`: a shape, a signal on it, its operator, and
//! bands.

use crate::args::{BorderMaskArgs, GivenWalkArgs, LevelArgs, MapArgs, ShapeArgs, SignalArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::stopwatch::Stopwatch;
use crate::output::{count, given_normals_json};
use crate::resolve::levels::{check_levels, resolve_spec};
use crate::resolve::operator::{operator_for_analysis, operator_for_levels, prepare_for_signal};
use crate::resolve::shape::{Input, load_shape};
use crate::resolve::signal::{Signal, SignalValues, file_normals, load_signal};
use crate::resolve::walk::with_given_walk;
use adwave::bands::{Bands, BandsError, BandsParams, Schedule, Wavelets};
use adwave::features::{
    CoordinateFeatures, Feature, FeatureParams, Response, ShapeCoordinates, coordinate_features,
    feature_extent, features, value_step,
};
use adwave::mask::missing;
use adwave::saliency::{MapWeighting, Saliency, SaliencyParams, Sign, saliency, with_height};
use adwave::signal::OutwardInfo;
use adwave::{BandsRequest, Decomposer};
use serde_json::{Value, json};
use std::time::Instant;

/// Flags that select the shape, the signal, the operator and the levels of an analysis.
#[derive(Clone, Copy)]
pub(crate) struct AnalysisArgs<'a> {
    pub(crate) shape: &'a ShapeArgs,
    pub(crate) signal: &'a SignalArgs,
    pub(crate) levels: &'a LevelArgs,
    /// True for the weights of the paper, which go with its walk.
    pub(crate) is_of_paper: bool,
    /// Share of the diagonal that the last level reaches if no number of levels is asked for; `None` is that of features.
    pub(crate) extent: Option<f64>,
    /// A walk as given; `None` for a command without that option.
    pub(crate) walk: Option<&'a GivenWalkArgs>,
}

/// A shape that is prepared for a signal.
pub(crate) struct Analysis {
    pub(crate) input: Input,
    pub(crate) decomposer: Decomposer,
    /// Name of the signal.
    pub(crate) name: String,
    pub(crate) signal: Signal,
    pub(crate) schedule: Schedule,
    params: BandsParams,
    /// Parameters of the bands of maps and features.
    map_params: BandsParams,
    /// The reason for the number of levels.
    pub(crate) levels_reason: String,
    pub(crate) seconds: Seconds,
}

/// Times of the parts.
pub(crate) struct Seconds {
    pub(crate) read: f64,
    pub(crate) diffusion: f64,
    pub(crate) bands: f64,
}

/// A saliency map and its ingredients.
pub(crate) struct Map {
    pub(crate) saliency: Saliency,
    /// Wavelets of one channel: the levels that the map is the sum of.
    pub(crate) wavelets: Wavelets,
    pub(crate) params: SaliencyParams,
    /// True if + and − stand for different sides.
    pub(crate) is_signed: bool,
    /// Method by which the outside was found, if the signal is the shape.
    pub(crate) outward: Option<OutwardInfo>,
    /// Seconds for the map alone.
    pub(crate) seconds: f64,
}

/// Features and the bands that they were found in.
pub(crate) struct FoundFeatures {
    pub(crate) features: Vec<Feature>,
    pub(crate) wavelets: Wavelets,
    /// Seconds for the features, of a cloud with its bands.
    pub(crate) seconds: f64,
}

impl Map {
    /// A line that says which sides the signs stand for, or why there are none.
    pub(crate) fn sides(&self) -> String {
        match (&self.outward, self.is_signed) {
            (Some(outward), true) => format!("+ convex, - concave; {outward}"),
            (Some(outward), false) if !outward.has_outside() => format!("unsigned: {outward}"),
            (None, true) => "+ above its surroundings, - below".to_owned(),
            (_, false) => "unsigned".to_owned(),
        }
    }

    /// The sides that the signs stand for, and how the outside was found.
    pub(crate) fn sides_json(&self) -> Value {
        let outside = self.outward.as_ref().map(|o| {
            json!({
                "found": o.has_outside(), "how": o.to_string(), "parts": o.n_parts, "closed": o.n_closed,
                "by_file": o.n_by_file, "by_majority": o.n_by_majority, "as_given": o.n_as_given,
                "without": o.n_without, "turned_triangles": o.n_turned, "share_without": o.without,
                "given_normals": o.given.as_ref().map(given_normals_json),
            })
        });
        json!({ "signed": self.is_signed, "outside": outside })
    }
}

impl Analysis {
    /// Reads the shape and the signal and prepares them.
    pub(crate) fn new(args: AnalysisArgs<'_>, global: &Global<'_>) -> Result<Self, CliError> {
        // Impossible levels are refused before a large file is read.
        check_levels(args.levels)?;
        let mut watch = Stopwatch::start();
        let mut input = load_shape(args.shape, global)?;
        if let Some(walk) = args.walk {
            input = with_given_walk(input, walk, global)?;
        }
        Self::from_input(input, watch.lap(), args, global)
    }

    /// Prepares a shape that was read in `read` seconds.
    pub(crate) fn from_input(
        input: Input,
        read: f64,
        args: AnalysisArgs<'_>,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        let AnalysisArgs { shape, signal, levels, extent, is_of_paper, .. } = args;
        let params = check_levels(levels)?;
        input.check_lengths(&levels.given_lengths())?;
        let mut watch = Stopwatch::start();
        let name = signal.name_on(&input.file);
        // The signal comes first: a name that does not exist is reported before the operator is built.
        let signal = load_signal(global, &input, name, signal.texture.as_deref())?;
        let operator = if is_of_paper {
            operator_for_levels(&shape.operator, levels)?
        } else {
            operator_for_analysis(&shape.operator, levels, &input.shape)?
        };
        let decomposer = prepare_for_signal(global, &input, &operator, &signal, name)?;
        let name = name.to_owned();
        let extent = extent.unwrap_or_else(|| feature_extent(&decomposer));
        let resolved = resolve_spec(&levels.to_spec(), extent, &decomposer, global)?;
        let seconds = Seconds { read, diffusion: watch.lap(), bands: 0.0 };
        let (schedule, levels_reason) = (resolved.schedule, resolved.reason);
        let map_params = match levels.accuracy {
            Some(_) => params,
            None => params.with_accuracy(decomposer.analysis_accuracy()),
        };
        Ok(Self { input, decomposer, name, signal, schedule, params, map_params, levels_reason, seconds })
    }

    /// Requests a result from the bands of the signal, and records the time.
    fn request<T>(
        &mut self,
        global: &Global<'_>,
        params: BandsParams,
        compute: impl FnOnce(BandsRequest<'_>) -> Result<T, BandsError>,
    ) -> Result<T, CliError> {
        let mut watch = Stopwatch::start();
        let found = with_progress(global, "splitting", |progress| {
            let request =
                self.decomposer.request(&self.signal.values, self.signal.n_channels, &self.schedule);
            compute(request.params(&params).progress(progress))
        })?;
        self.seconds.bands = watch.lap();
        Ok(found)
    }

    /// All bands.
    pub(crate) fn bands(&mut self, global: &Global<'_>) -> Result<Bands, CliError> {
        self.request(global, self.params, |request| request.bands())
    }

    /// The wavelet coefficients for saliency and features: their norms, unless the response is that of each channel.
    pub(crate) fn wavelets(
        &mut self,
        global: &Global<'_>,
        response: Option<Response>,
    ) -> Result<Wavelets, CliError> {
        match response {
            Some(Response::Channels) => self.request(global, self.map_params, |request| request.wavelets()),
            _ => self.request(global, self.map_params, |request| request.norms()),
        }
    }

    /// The saliency map; that of coordinates has a sign if the shape has an outside.
    pub(crate) fn saliency(
        &mut self,
        map: &MapArgs,
        border: &BorderMaskArgs,
        global: &Global<'_>,
    ) -> Result<Map, CliError> {
        let outward = if map.weighting == MapWeighting::Signed && self.is_geometry() {
            let normals = file_normals(&self.input.file);
            let found = self.decomposer.outward_normals(normals.as_deref(), global.progress());
            Some(found.map_err(|e| CliError::classify(&e))?)
        } else {
            None
        };
        let (wavelets, has_sign) = match &outward {
            Some(outward) if outward.info.has_outside() => {
                let along = |request: BandsRequest<'_>| request.normal_components(&outward.normals);
                (self.request(global, self.map_params, along)?, true)
            }
            _ => (self.wavelets(global, None)?, self.signal.n_channels == 1),
        };
        if !has_sign {
            let applies = "applies to maps with a sign, and this signal gives none";
            global.given.refuse(&["--unsigned"], applies)?;
        }
        let params = map.to_params(border);
        let mut watch = Stopwatch::start();
        let mut saliency = saliency(&self.decomposer, &wavelets, &params, global.progress())
            .map_err(|e| CliError::classify(&e))?;
        if let Some(axis) = map.up {
            let Some(points) = self.input.shape.points() else {
                return Err(CliError::Input(format!(
                    "{}: a graph has no heights, so --up cannot apply; leave it out",
                    self.input.name
                )));
            };
            let heights: Vec<f64> = points.iter().map(|p| p[axis.index()]).collect();
            saliency.map = with_height(&saliency.map, &heights);
        }
        let seconds = watch.lap();
        let is_signed = has_sign && params.sign == Sign::Signed && map.up.is_none();
        Ok(Map { saliency, wavelets, params, is_signed, outward: outward.map(|o| o.info), seconds })
    }

    /// The features and the bands that they were found in: significant ones of the coordinates where there are such,
    /// else those of Algorithm 2.
    pub(crate) fn features(
        &mut self,
        params: &FeatureParams,
        global: &Global<'_>,
    ) -> Result<FoundFeatures, CliError> {
        if !self.is_geometry() || !self.finds_significant(params) {
            let is_of_values = self.is_grid() && self.finds_significant(params);
            let step = is_of_values.then(|| value_step(&self.signal.values));
            let params = &params.with_value_step(step);
            let wavelets = self.wavelets(global, Some(params.response))?;
            let start = Instant::now();
            let found = features(&self.decomposer, &wavelets, params, global.progress());
            let features = found.map_err(|e| CliError::classify(&e))?;
            return Ok(FoundFeatures { features, wavelets, seconds: start.elapsed().as_secs_f64() });
        }
        global.given.refuse(
            &["--walk"],
            "applies to fields and to shapes with edges; features of the points of a cloud come from their own walk",
        )?;
        let normals = file_normals(&self.input.file);
        let coordinates = ShapeCoordinates {
            points: self.input.shape.points().unwrap_or_default(),
            normals: normals.as_deref(),
            schedule: &self.schedule,
            bands: self.map_params,
        };
        let start = Instant::now();
        let found = with_progress(global, "splitting", |progress| {
            coordinate_features(&self.decomposer, &coordinates, params, progress)
        });
        let CoordinateFeatures { features, wavelets } = found.map_err(|e| CliError::classify(&e))?;
        Ok(FoundFeatures { features, wavelets, seconds: start.elapsed().as_secs_f64() })
    }

    /// Masks the places of an image or a volume that take no part, so that numbers and pictures leave them out.
    pub(crate) fn mask_outsiders(&mut self) -> Result<(), CliError> {
        let Some(outsiders) =
            self.decomposer.domain().outsiders().filter(|_| self.input.file.grid().is_some())
        else {
            return Ok(());
        };
        let is_out = |x: usize| self.decomposer.mask_flags().is_some_and(|flags| flags[x]);
        if (0..outsiders.len()).all(|x| !outsiders[x] || is_out(x)) {
            return Ok(());
        }
        let mut values = self.signal.values.to_vec();
        for (row, _) in
            values.chunks_exact_mut(self.signal.n_channels).zip(&outsiders).filter(|(_, out)| **out)
        {
            row.fill(f64::NAN);
        }
        let flags = missing(&values, self.signal.n_channels).unwrap_or(outsiders);
        self.decomposer = self.decomposer.masked(&flags).map_err(CliError::input)?;
        self.signal.values = SignalValues::Other(values);
        Ok(())
    }

    /// True if the signal is the coordinates of a mesh or cloud.
    pub(crate) fn is_geometry(&self) -> bool {
        matches!(self.signal.values, SignalValues::Coordinates(_)) && !self.input.shape.is_graph()
    }

    /// True if the features are those that stand out significantly, not those of Algorithm 2.
    pub(crate) fn finds_significant(&self, params: &FeatureParams) -> bool {
        (self.is_geometry() || self.is_grid()) && params.finds_significant(&self.decomposer)
    }

    /// True for an image or a volume.
    pub(crate) fn is_grid(&self) -> bool {
        self.input.file.grid().is_some()
    }

    /// Widths σ_j of the levels 0 … J in model units.
    pub(crate) fn sigma(&self) -> Vec<f64> {
        self.schedule.sigma(self.decomposer.operator().step_length())
    }

    /// `NAME: N vertices, coords`, and a line with the reason for the number of levels.
    pub(crate) fn headline(&self) -> String {
        let n = self.decomposer.n_vertices();
        let masked = self.decomposer.mask_flags().map_or(0, |out| out.iter().filter(|&&out| out).count());
        let masked = if masked > 0 { format!(", {masked} of them masked") } else { String::new() };
        let [one, many] = self.input.row_words();
        let n = count(n, one, many);
        format!("{}: {n}{masked}, {}\n{}\n", self.input.name, self.name, self.levels_reason)
    }

    /// A width in % of the diagonal; none on a graph.
    pub(crate) fn percent(&self, sigma: f64) -> Option<f64> {
        let diagonal = self.decomposer.extent();
        (diagonal > 0.0).then(|| 100.0 * sigma / diagonal)
    }

    /// A line of times, ending in that of one further part.
    pub(crate) fn timing(&self, part: &str, seconds: f64) -> String {
        let Seconds { read, diffusion, bands } = self.seconds;
        format!(
            "read {read:.3} s, diffusion {diffusion:.3} s, bands {bands:.3} s, {part} {:.2} ms\n",
            1e3 * seconds
        )
    }
}
