//! State of an open image or volume: its values, bands and edit.

use crate::StudioError;
use crate::autosave::Autosave;
use crate::band_edit::{BandEdit, BandEditRequest, LevelsRequest, default_levels};
use crate::document::{Document, DocumentLayer};
use crate::grid_planes::{PlaneRequest, slice_views};
use crate::prepared_shape::EditSummary;
use crate::response::{ApiError, ApiResult, json_response};
use crate::session::StudioInput;
use crate::workspace::{OpenedAt, Workspace, check_revision};
use adwave::filter::WeightedLayer;
use adwave::local_fit::LocalFit;
use adwave::mask::channels_by_mask;
use adwave::region::{Length, Region};
use adwave::shape::{Graph, Shape};
use adwave::{Decomposer, ErrorKind, LevelSpec, Progress};
use adwave_io::{
    CoordinateSystem, Format, GRID_VALUES, GridLayout, NamedSignal, Recipe, ShapeFile, SignalSource,
    named_signal, parse_recipe,
};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Largest number of values; so many take 4 GiB with eight bands.
const MAX_VALUES: usize = 1 << 25;
/// Largest number of channels of an image that are shown together: colors and their opacity.
const MAX_COLORS: usize = 4;
/// Number of values in the sample from which the range of colors is chosen.
const RANGE_SAMPLE: usize = 1 << 16;
/// Shares of the values below and above the range of colors.
const OUTSIDE_RANGE: f64 = 0.01;
/// Meters of a degree of latitude.
const METERS_PER_DEGREE: f64 = 111_320.0;

/// Open image or volume with its lazily computed bands.
pub(crate) struct GridSession {
    pub(crate) workspace: Workspace,
    pub(crate) file: ShapeFile,
    n_channels: usize,
    decomposer: Decomposer,
    bands: OnceLock<Result<Mutex<GridBands>, Arc<StudioError>>>,
    range: OnceLock<[f64; 4]>,
}

/// Bands of the values of a grid, and the edit of their gains.
pub(crate) struct GridBands {
    edit: BandEdit,
    /// Largest and root mean square change of the values by the edit.
    change: [f64; 2],
}

/// Shape in place of that of a grid, whose values are carried by the grid itself.
pub(crate) fn stand_in_shape() -> Result<Shape, StudioError> {
    Graph::new(1, &[]).map(Shape::Graph).map_err(|e| StudioError::from_classified(&e))
}

/// Reads the values of a grid; numbers that stand for unknown values are NaN.
pub(crate) fn grid_signal(file: &ShapeFile, name: &str) -> Result<NamedSignal, StudioError> {
    let shape = stand_in_shape()?;
    let source = SignalSource { file, shape: &shape, name };
    named_signal(source, GRID_VALUES, None).map_err(|e| StudioError::from_classified(&e))
}

/// Number of frames, the channels that are shown one at a time; `None` if a place has one value or a color.
fn count_frames(layout: &GridLayout, n_channels: usize) -> Option<usize> {
    let most = if layout.sizes.len() == 2 { MAX_COLORS } else { 1 };
    Some(n_channels).filter(|n| *n > most)
}

/// Refuses more than [`MAX_VALUES`] values.
fn check_size(layout: &GridLayout, n_values: usize, n_frames: Option<usize>) -> Result<(), String> {
    if n_values <= MAX_VALUES {
        return Ok(());
    }
    let n_places = layout.n_places();
    Err(match n_frames.filter(|_| n_places <= MAX_VALUES) {
        Some(n) => format!(
            "the studio opens up to {MAX_VALUES} values, which are {} frames of {n_places} places, got {n} frames; \
             filter it with `adwave filter`, or open fewer frames",
            MAX_VALUES / n_places.max(1)
        ),
        None => format!(
            "the studio opens up to {MAX_VALUES} values (an image of 5792 × 5792, a volume of 322 × 322 × 322), got \
             {n_values}; filter it with `adwave filter`, or open a part of it"
        ),
    })
}

/// Refuses grids that the page does not show; otherwise returns the number of channels.
fn check_grid(file: &ShapeFile) -> Result<usize, String> {
    let (Some(layout), Some(field)) = (file.grid(), file.field(GRID_VALUES)) else {
        return Err("the studio opens images and volumes with values, and this file has none".to_owned());
    };
    let (n_axes, n) = (layout.sizes.len(), field.n_channels);
    if n_axes < 2 {
        return Err("the studio opens images and volumes, and this is a sequence of values; use `adwave transform` or \
                    `adwave filter`"
            .to_owned());
    }
    check_size(layout, field.values.len(), count_frames(layout, n))?;
    if layout.n_missing() == layout.n_places() {
        return Err("no place has data; all are NaN, NODATA or left out".to_owned());
    }
    Ok(n)
}

/// Greatest common divisor.
fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

impl GridSession {
    pub(crate) fn new(input: StudioInput, at: OpenedAt) -> Result<Self, StudioError> {
        let StudioInput { name, path, file, .. } = input;
        let refuse = |problem: String| StudioError::Unsuitable { name: name.clone(), problem };
        let n_channels = check_grid(&file).map_err(refuse)?;
        let layout = file.grid().expect("a grid was checked for");
        let signal = grid_signal(&file, &name)?;
        let grid = layout.to_grid().map_err(|e| refuse(e.to_string()))?;
        let heat = grid.heat();
        let mut decomposer = Decomposer::from_domain(grid, heat).map_err(|e| refuse(e.to_string()))?;
        // As the command masks a signal.
        let groups = channels_by_mask(&signal.values, n_channels);
        if groups.len() > 1 || groups.first().is_some_and(|group| group.channels.len() < n_channels) {
            let channels = match count_frames(layout, n_channels) {
                Some(_) => "series whose frames",
                None => "images whose channels",
            };
            return Err(refuse(format!(
                "the studio opens {channels} have values at the same places, and these differ; filter it with `adwave \
                 filter`"
            )));
        }
        if let Some(flags) = groups.first().and_then(|group| group.missing.as_ref()) {
            decomposer = decomposer.masked(flags).map_err(|e| refuse(e.to_string()))?;
        }
        let autosave = Autosave::new(path.as_deref(), &signal.values, at.autosave_folder.as_deref());
        drop(signal);
        Ok(Self {
            workspace: Workspace::new(at, name, path, autosave),
            file,
            n_channels,
            decomposer,
            bands: OnceLock::new(),
            range: OnceLock::new(),
        })
    }

    pub(crate) fn layout(&self) -> &GridLayout {
        self.file.grid().expect("an image or a volume has axes")
    }

    /// Number of frames of a series, which are shown one at a time; `None` for other images and volumes.
    pub(crate) fn n_frames(&self) -> Option<usize> {
        count_frames(self.layout(), self.n_channels)
    }

    pub(crate) fn kind(&self) -> &'static str {
        if self.layout().sizes.len() == 2 { "image" } else { "volume" }
    }

    /// `an image` or `a volume`.
    pub(crate) fn kind_with_article(&self) -> &'static str {
        if self.kind() == "image" { "an image" } else { "a volume" }
    }

    /// Computes the bands of `levels`.
    fn bands_of(&self, levels: LevelSpec, progress: Progress<'_>) -> Result<GridBands, StudioError> {
        let signal = grid_signal(&self.file, &self.workspace.name)?;
        let resolved = levels.resolve(&self.decomposer, adwave::bands::DEFAULT_EXTENT);
        let n_levels = resolved.map_err(|e| StudioError::from_classified(&e))?.schedule.n_levels();
        // The bands, and the signal, the result and their copies while the bands are computed and saved.
        let bytes = 8 * (n_levels + 8) as u64 * signal.values.len() as u64;
        if let Some(free) = adwave_io::free_memory().filter(|free| bytes > *free) {
            let gib = |bytes: u64| bytes as f64 / (1_u64 << 30) as f64;
            let text = format!(
                "{}: {n_levels} bands take {:.1} GiB, and {:.1} GiB are free; ask for fewer bands, or filter it with \
                 `adwave filter`",
                self.workspace.name,
                gib(bytes),
                gib(free)
            );
            return Err(StudioError::Method { kind: ErrorKind::Memory, text });
        }
        let request = BandEditRequest { values: &signal.values, n_channels: self.n_channels, levels };
        let mut edit = BandEdit::new(self.decomposer.clone(), request)?;
        edit.split(progress)?;
        Ok(GridBands { edit, change: [0.0; 2] })
    }

    /// Computes the bands of the levels that the page requests.
    pub(crate) fn bands_of_request(
        &self,
        request: &LevelsRequest,
        progress: Progress<'_>,
    ) -> Result<GridBands, ApiError> {
        let levels = request.to_levels(&self.decomposer)?;
        self.check_lengths(&levels)?;
        Ok(self.bands_of(levels, progress)?)
    }

    /// Refuses widths in units where the coordinates are degrees.
    fn check_lengths(&self, levels: &LevelSpec) -> Result<(), ApiError> {
        let system = self.file.coordinate_system().filter(|system| system.is_geographic());
        let (Some(system), LevelSpec::Widths(widths)) = (system, levels) else { return Ok(()) };
        let Some(width) = widths.iter().find_map(|w| if let Length::Units(w) = w { Some(w) } else { None })
        else {
            return Ok(());
        };
        Err(ApiError::bad_request(format!(
            "widths need coordinates in a unit of length, but those of {} are degrees ({}), got {width}; give widths in % \
             of the diagonal, or project the file to meters",
            self.workspace.name, system.name
        )))
    }

    /// Locks the bands and the edit; the first call computes them and restores the edit of the last session.
    pub(crate) fn lock_bands(&self) -> Result<MutexGuard<'_, GridBands>, ApiError> {
        self.workspace.expect_turn();
        let result = self.bands.get_or_init(|| {
            let stored = self.workspace.autosave.as_ref().and_then(Autosave::read);
            let resumed = stored.and_then(|(levels, document)| {
                let mut bands = self.bands_of(levels, self.workspace.progress()).ok()?;
                bands.apply_edit(document).ok()?;
                Some(bands)
            });
            let _ = self.workspace.was_resumed.set(resumed.is_some());
            let unedited = || self.bands_of(default_levels(&self.decomposer), self.workspace.progress());
            resumed.map_or_else(unedited, Ok).map(Mutex::new).map_err(Arc::new)
        });
        let bands = result.as_ref().map_err(|e| ApiError::from_classified(&**e))?;
        Ok(bands.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn store_edit(&self, bands: &GridBands) -> Result<(), ApiError> {
        self.workspace.store_edit(&bands.edit.levels, &bands.edit.document)
    }

    /// Replaces the edit and stores it.
    pub(crate) fn apply_edit(&self, document: Document) -> Result<EditSummary, ApiError> {
        let mut bands = self.lock_bands()?;
        check_revision(&bands.edit.document, &document)?;
        let summary = bands.apply_edit(document)?;
        self.store_edit(&bands)?;
        Ok(summary)
    }

    /// Replaces the levels; the gains of the edit follow their widths.
    pub(crate) fn replace_levels(&self, next: GridBands) -> ApiResult {
        let mut bands = self.lock_bands()?;
        let mut document = bands.edit.document.clone();
        document.map_levels(&bands.edit.sigmas(), &next.edit.sigmas());
        *bands = next;
        bands.apply_edit(document)?;
        self.store_edit(&bands)?;
        json_response(&bands.edit.describe_levels())
    }

    /// Replaces the levels and the edit by those of a recipe.
    pub(crate) fn apply_recipe(&self, text: &str) -> ApiResult {
        let recipe = parse_recipe(text).map_err(|e| ApiError::from_classified(&e))?;
        self.check_recipe(&recipe)?;
        self.check_lengths(&recipe.levels)?;
        let mut next = self.bands_of(recipe.levels.clone(), self.workspace.progress())?;
        let mut gains = vec![1.0; next.edit.n_levels()];
        for layer in &recipe.layers {
            let own = layer.gains.resolve(gains.len()).map_err(|e| ApiError::from_classified(&e))?;
            gains.iter_mut().zip(&own).for_each(|(all, own)| *all *= own);
        }
        let layer =
            DocumentLayer { name: String::new(), on: true, opacity: 1.0, gains, region: None, preset: None };
        let mut bands = self.lock_bands()?;
        let revision = bands.edit.document.revision + 1;
        next.apply_edit(Document { revision, layers: vec![layer], ..Document::default() })?;
        *bands = next;
        self.store_edit(&bands)?;
        let mut described = bands.edit.describe_levels();
        described["field"] = Value::Null;
        json_response(&described)
    }

    /// Refuses a recipe that is not one of gains for the values of a grid.
    fn check_recipe(&self, recipe: &Recipe) -> Result<(), ApiError> {
        let kind = self.kind_with_article();
        let problem = if recipe.field != GRID_VALUES {
            format!(
                "the recipe edits '{}', and {kind} has the field '{GRID_VALUES}'; open the file that it belongs to",
                recipe.field
            )
        } else if !recipe.clones.is_empty() || recipe.pose.is_some() || !recipe.turned.is_empty() {
            format!(
                "[[clone]], [pose] and turned of the recipe change shapes, and {kind} is none; remove them"
            )
        } else if recipe.layers.iter().any(|layer| layer.region != Region::Everywhere {}) {
            format!(
                "the recipe has a region, and the studio edits {kind} as a whole; apply it with `adwave filter --recipe`"
            )
        } else if recipe
            .local_fit
            .is_some_and(|fit| self.decomposer.applied_local_fit(fit) != LocalFit::Constant)
        {
            format!(
                "the studio smooths {kind} about a constant, and the recipe has another local_fit; apply it with `adwave \
                 filter --recipe`"
            )
        } else {
            return Ok(());
        };
        Err(ApiError::bad_request(problem))
    }

    /// Least and greatest value, and the range without the outermost values, from an even sample.
    fn range(&self, bands: &GridBands) -> [f64; 4] {
        *self.range.get_or_init(|| {
            let values = bands.edit.editor().signal();
            let kept = self.layout().kept.as_deref();
            let is_known =
                |k: usize| values[k].is_finite() && kept.is_none_or(|kept| kept[k / self.n_channels]);
            let ends = (0..values.len())
                .into_par_iter()
                .filter(|&k| is_known(k))
                .map(|k| (values[k], values[k]))
                .reduce(|| (f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
            // A step that shares no factor with the sizes, so that the sample is no column and no single frame.
            let least = (values.len() / RANGE_SAMPLE).max(1);
            let step =
                (least..=values.len()).find(|step| common_divisor(*step, values.len()) == 1).unwrap_or(1);
            let mut sample: Vec<f64> =
                (0..values.len()).step_by(step).filter(|&k| is_known(k)).map(|k| values[k]).collect();
            sample.sort_by(f64::total_cmp);
            let at = |share: f64| sample.get(((sample.len().max(1) - 1) as f64 * share).round() as usize);
            let low = at(OUTSIDE_RANGE).copied().unwrap_or(ends.0);
            let high = at(1.0 - OUTSIDE_RANGE).copied().unwrap_or(ends.1);
            if high > low { [ends.0, ends.1, low, high] } else { [ends.0, ends.1, ends.0, ends.1] }
        })
    }

    /// Distances of rows and columns in the unit of heights, for the shading of a terrain.
    fn height_spacings(&self) -> Vec<f64> {
        let layout = self.layout();
        if !self.file.coordinate_system().is_some_and(CoordinateSystem::is_geographic) {
            return layout.spacings.clone();
        }
        let latitude = layout.position(layout.n_places() / 2)[1].clamp(-89.0, 89.0).to_radians();
        let meters = |axis: usize| {
            let [x, y, _] = layout.steps[axis];
            METERS_PER_DEGREE * (x * latitude.cos()).hypot(y)
        };
        (0..layout.sizes.len()).map(meters).collect()
    }

    /// True if the values are those of a map with one value per place, such as heights.
    fn is_terrain(&self) -> bool {
        let is_placed = self.layout().origin != [0.0; 3] && self.file.format() == Some(Format::TIFF);
        let is_map = self.file.coordinate_system().is_some() || self.file.format() == Some(Format::ESRI_GRID);
        self.kind() == "image" && self.n_channels == 1 && (is_map || is_placed)
    }

    fn describe_grid(&self, bands: &GridBands) -> Value {
        let layout = self.layout();
        let [least, greatest, low, high] = self.range(bands);
        let field = self.file.field(GRID_VALUES);
        let frames =
            self.n_frames().map(|n| json!({"n": n, "step": field.and_then(|field| field.frame_step)}));
        json!({
            "sizes": layout.sizes,
            "spacings": layout.spacings,
            "axes": layout.axis_names,
            "origin": layout.origin,
            "steps": layout.steps,
            "unit": self.file.length_unit().map(adwave_io::LengthUnit::name),
            "views": slice_views(layout, self.file.format() == Some(Format::NIFTI)),
            "n_channels": if frames.is_some() { 1 } else { self.n_channels },
            "frames": frames,
            "value_type": field.map(|field| field.values.value_type().name()),
            "n_missing": layout.n_missing(),
            "change": {"greatest": bands.change[0], "rms": bands.change[1]},
            "terrain": self.is_terrain(),
            "height_spacings": self.height_spacings(),
            "range": {"least": least, "greatest": greatest, "low": low, "high": high},
            "extensions": self.extensions(),
        })
    }

    /// Describes the image or volume for the page.
    pub(crate) fn describe(&self) -> Result<Value, ApiError> {
        let bands = self.lock_bands()?;
        let (workspace, edit, layout) = (&self.workspace, &bands.edit, self.layout());
        Ok(json!({
            "id": workspace.id,
            "name": workspace.name,
            "format": self.file.format().map(Format::name),
            "formats": self.writable_formats().into_iter().map(Format::name).collect::<Vec<_>>(),
            "kind": self.kind(),
            "n_vertices": layout.n_places(),
            "n_triangles": 0,
            "center": layout.position(layout.n_places() / 2),
            "diagonal": self.decomposer.extent(),
            "mean_length": self.decomposer.mean_length(),
            "closed": false,
            "volume": null,
            "components": 1,
            "notes": self.file.notes(),
            "levels": edit.level_infos(),
            "choice": edit.levels_request(),
            "fields": [],
            "presets": edit.presets(),
            "resumed": workspace.was_resumed.get().copied().unwrap_or(false),
            "grid": self.describe_grid(&bands),
        }))
    }
}

impl GridBands {
    pub(crate) fn document(&self) -> &Document {
        &self.edit.document
    }

    /// New values of all places.
    pub(crate) fn edited(&self) -> &[f64] {
        self.edit.editor().edited()
    }

    /// Replaces the current edit; on an error nothing changes.
    fn apply_edit(&mut self, document: Document) -> Result<EditSummary, ApiError> {
        document.check(self.edit.n_levels())?;
        let is_gains_alone = document.clones.is_empty()
            && document.pose.is_none()
            && document.turned.is_empty()
            && document.fields.is_empty()
            && document.layers.iter().all(|layer| layer.region.is_none());
        if !is_gains_alone {
            return Err(ApiError::bad_request(
                "an edit of an image or a volume has layers without regions alone; remove regions, clones, poses, \
                 turned parts and fields, or use `adwave filter --region`",
            ));
        }
        let layers = |document: &Document, n_levels: usize| -> Result<Vec<WeightedLayer>, ApiError> {
            let resolve =
                |layer: adwave::filter::Layer| layer.gains.resolve(n_levels).map(WeightedLayer::everywhere);
            let layers = document.active_layers().into_iter().map(resolve).collect::<Result<_, _>>();
            layers.map_err(|e| ApiError::from_classified(&e))
        };
        let (next, before) = (
            layers(&document, self.edit.n_levels())?,
            layers(&self.edit.document, self.edit.n_levels()).unwrap_or_default(),
        );
        self.edit.editor_mut().set_layers(next).map_err(|e| ApiError::from_classified(&e))?;
        let [greatest, rms] = self.measure_change();
        // The page computes in single precision.
        if !(greatest as f32).is_finite() {
            self.edit.editor_mut().set_layers(before).map_err(|e| ApiError::from_classified(&e))?;
            let message = "values would leave the range of single precision; choose smaller gains";
            return Err(ApiError::bad_request(message));
        }
        (self.edit.document, self.change) = (document, [greatest, rms]);
        Ok(EditSummary { revision: self.edit.document.revision, greatest, rms, volume: None })
    }

    /// Largest and root mean square change of the values that are known.
    fn measure_change(&self) -> [f64; 2] {
        /// Values that a thread compares at a time.
        const CHUNK: usize = 1 << 16;
        let (before, after) = (self.edit.editor().signal(), self.edit.editor().edited());
        let part = |(before, after): (&[f64], &[f64])| {
            let known = before.iter().zip(after).filter(|(a, _)| !a.is_nan());
            known.fold((0.0_f64, 0.0, 0_usize), |(most, sum, n), (a, b)| {
                (most.max((b - a).abs()), sum + (b - a) * (b - a), n + 1)
            })
        };
        let parts: Vec<_> = before.par_chunks(CHUNK).zip(after.par_chunks(CHUNK)).map(part).collect();
        let all = parts.into_iter().fold((0.0_f64, 0.0, 0), |a, b| (a.0.max(b.0), a.1 + b.1, a.2 + b.2));
        [all.0, (all.1 / all.2.max(1) as f64).sqrt()]
    }

    /// Converts to a recipe, which the command replays bit-identically.
    pub(crate) fn to_recipe(&self) -> Recipe {
        Recipe {
            field: GRID_VALUES.to_owned(),
            levels: self.edit.levels.clone(),
            local_fit: Some(LocalFit::Constant),
            layers: self.edit.document.active_layers(),
            ..Recipe::default()
        }
    }

    /// Encodes the values and bands of a part of an image or a slice of a volume.
    pub(crate) fn encode_plane(
        &self,
        plane: &PlaneRequest,
        layout: &GridLayout,
    ) -> Result<Vec<u8>, ApiError> {
        plane.encode(&self.edit, layout)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn volumes_and_images_with_more_channels_than_colors_have_frames() {
        let (image, volume) = (GridLayout::new(&[4, 5], &[1.0; 2]), GridLayout::new(&[4, 5, 6], &[1.0; 3]));
        assert_eq!([1, 4, 5].map(|n| count_frames(&image, n)), [None, None, Some(5)]);
        assert_eq!([1, 2, 90].map(|n| count_frames(&volume, n)), [None, Some(2), Some(90)]);
    }

    #[test]
    fn too_many_values_are_refused_with_the_number_of_frames_that_fit() {
        let layout = GridLayout::new(&[64, 256, 256], &[1.0; 3]);
        let n_places = layout.n_places();
        assert_eq!(check_size(&layout, 8 * n_places, Some(8)), Ok(()));
        let series = check_size(&layout, 9 * n_places, Some(9)).unwrap_err();
        assert!(series.contains("which are 8 frames of 4194304 places, got 9 frames"), "{series}");
        let layout = GridLayout::new(&[512, 512, 512], &[1.0; 3]);
        for n_frames in [None, Some(2)] {
            let text = check_size(&layout, layout.n_places(), n_frames).unwrap_err();
            assert!(text.contains("322 × 322 × 322), got 134217728"), "{text}");
        }
    }
}
