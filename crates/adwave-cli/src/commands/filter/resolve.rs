//! From flags and a recipe to a filter job.

use super::FilterArgs;
use super::args::EditArgs;
use super::columns::Columns;
use crate::args::{GainRows, QuantityArgs};
use crate::commands::result_file::{ResultFile, set_value_type};
use crate::error::CliError;
use crate::global::Global;
use crate::output::{count, has_extension, note, number};
use crate::resolve::levels::check_levels;
use crate::resolve::operator::{check_operator, operator_for_spec, operator_with_default};
use crate::resolve::pose::ReshapedBy;
use crate::resolve::region::{region_in_shape, union_of_regions};
use crate::resolve::shape::{GivenLength, Input, load_first_volume, load_shape};
use crate::resolve::signal::{COORDS, Signal, SignalValues, load_labels, load_signal, refuse_labels};
use crate::resolve::time::TimeBands;
use crate::resolve::walk::with_given_walk;
use adwave::bands::BandsParams;
use adwave::filter::{Gains, KeepVolume, Layer};
use adwave::local_fit::LocalFit;
use adwave::operator::{EndPoints, OperatorKind, OperatorParams};
use adwave::positions::{Borders, MoveDirection, PositionParams, Volume};
use adwave::shape::{PreparedGeometry, Shape, VertexMap, WeldMode, jumps_at_seams};
use adwave::{LevelSpec, MANY_CHANNELS};
use adwave_io::{Format, GRID_VALUES, MovedNormals, NpyColumns, Recipe, VolumeSeries, read_recipe};
use std::path::Path;

/// Number of values of an image or a volume from which on its channels are filtered in groups: 1 GiB in 64 bits.
const LARGE: usize = 1 << 27;

/// Number of values of a series of volumes from which on they are read and written one at a time.
const LARGE_SERIES: usize = 1 << 22;

/// A filter with its shape and signal.
pub(super) struct FilterJob<'a> {
    pub(super) input: Input,
    /// The name of the signal.
    pub(super) signal_name: String,
    /// The signal, without values if they are read by columns.
    pub(super) signal: Signal,
    /// The source of a signal of many channels, which are filtered a group at a time.
    pub(super) columns: Option<Columns>,
    pub(super) operator: OperatorParams,
    pub(super) levels: FilterLevels,
    /// Meaning of the numbers of the signal.
    pub(super) quantity: QuantityArgs,
    pub(super) layers: Vec<Layer>,
    /// Bands along time, and their gains.
    pub(super) time: Option<(TimeBands, Vec<f64>)>,
    /// Gains of the bands in space for each band along time and the rest.
    pub(super) gains_by_time: Option<Vec<Vec<f64>>>,
    pub(super) keep_volume: Option<KeepVolume>,
    /// Local fit of a field or of one coordinate; `None` for coordinates that move in other directions.
    pub(super) local_fit: Option<LocalFit>,
    /// Labels of the signal, if each is filtered by its share.
    pub(super) labels: Option<Vec<f64>>,
    pub(super) positions: PositionParams,
    /// Clones and handles of the recipe, for the filtered shape.
    pub(super) reshaped_by: Option<ReshapedBy>,
    /// First vertices of the parts whose faces are turned over in the result.
    pub(super) turned: Vec<u32>,
    pub(super) bands: BandsParams,
    pub(super) normals: MovedNormals,
    pub(super) result: ResultFile<'a>,
    pub(super) save_recipe: Option<SaveRecipe<'a>>,
    /// True if a recipe is read or saved, which gives the same bits wherever it is applied.
    pub(super) has_recipe: bool,
}

impl FilterJob<'_> {
    /// True if nothing but bands along time is changed.
    pub(super) fn is_in_time_alone(&self) -> bool {
        self.layers.is_empty() && self.time.is_some()
    }
}

/// The levels of a filter.
pub(super) struct FilterLevels {
    pub(super) spec: LevelSpec,
    /// True if the levels are those of a recipe, which may have been made for another shape.
    pub(super) is_from_recipe: bool,
}

/// A recipe to be written.
#[derive(Clone, Copy)]
pub(super) struct SaveRecipe<'a> {
    pub(super) path: &'a Path,
    pub(super) levels: SavedLevels,
}

/// Form in which a recipe saves levels.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SavedLevels {
    /// Widths, which mean the same on other shapes.
    Widths,
    /// Numbers of steps, which give the same bits on this shape.
    Steps,
}

/// The job that the flags and the recipe ask for.
pub(super) fn resolve<'a>(args: &'a FilterArgs, global: &Global<'_>) -> Result<FilterJob<'a>, CliError> {
    let result = ResultFile::new(&args.output)?;
    let bands = check_levels(&args.levels)?.with_precision(args.precision);
    let edit = &args.edit;
    let recipe = edit.recipe.as_deref().map(|path| load_recipe(path, global)).transpose()?;
    let recipe = recipe.as_ref();
    let layers = layers(args, recipe, global)?;
    let levels = levels(args, recipe);
    let operator = operator(args, recipe)?;
    let (input, series) = load_input(args, result, global)?;
    let asked = args.signal.asked_name().or(recipe.map(|recipe| recipe.field.as_str()));
    let signal_name = asked.unwrap_or_else(|| args.signal.name_on(&input.file)).to_owned();
    let input = input.resolve_cells(&signal_name, global)?;
    let mut input = with_given_walk(input, &args.walk, global)?;
    result.check_places(&input)?;
    set_value_type(&mut input, &args.output, args.value_type, global)?;
    input.check_lengths(&given_lengths(&levels.spec))?;
    for layer in &layers {
        region_in_shape(&layer.region, &input)?;
    }
    let columns = series.or_else(|| columns_of_signal(args, &input, &signal_name, result));
    let mut signal = match &columns {
        Some(columns) => {
            global.inputs.add_signal(&signal_name, None);
            Signal::new(columns.n_channels(&input.file), SignalValues::Other(Vec::new()))
        }
        None => load_signal(global, &input, &signal_name, args.signal.texture.as_deref())?,
    };
    let labels = if args.as_labels {
        global.given.refuse(&["--precision"], "applies to numbers, and the signal holds labels")?;
        Some(load_labels(&signal_name, &signal)?)
    } else {
        refuse_labels(&signal_name, &signal, args.labels, "--as-labels smooths them by their shares")?;
        None
    };
    let time = time_bands(args, &signal_name, &mut signal, global)?;
    if signal_name != COORDS {
        let applies = format!("applies to coordinates, and the signal is {signal_name}");
        global.given.refuse(&["--along", "--border", "--keep-volume", "--keep-normals"], &applies)?;
    }
    check_operator(&input.shape, &operator, global)?;
    let operator = with_open_seams(operator, &input, &signal_name, &signal, global)?;
    let positions = positions(edit, recipe);
    let operator = match positions.borders {
        Borders::Free => operator.with_end_points(EndPoints::Free),
        _ => operator,
    };
    // Heat alone keeps the sum of an image or a map, and is the Gaussian that their users know.
    let has_values = input.file.carries_values() || input.file.is_map();
    let usual = if has_values { LocalFit::Constant } else { LocalFit::Linear };
    let fit = resolve_local_fit(args, recipe, &signal_name, positions, usual)?;
    let saved_levels = if edit.save_steps { SavedLevels::Steps } else { SavedLevels::Widths };
    let save_recipe = edit.save_recipe.as_deref().map(|path| SaveRecipe { path, levels: saved_levels });
    Ok(FilterJob {
        input,
        reshaped_by: reshaped_by(recipe, &signal_name)?,
        turned: recipe.map_or_else(Vec::new, |recipe| recipe.turned.clone()),
        signal_name,
        signal,
        columns,
        operator,
        levels,
        quantity: args.quantity,
        layers,
        time,
        gains_by_time: args.gains_by_time.as_ref().map(|rows| rows.0.clone()),
        keep_volume: edit.keep_volume,
        local_fit: fit.filter(|_| labels.is_none() && args.quantity.are_numbers()),
        labels,
        positions,
        bands,
        normals: args.normals.to_rule(),
        result,
        has_recipe: recipe.is_some() || save_recipe.is_some(),
        save_recipe,
    })
}

/// Bands along time and their gains, of a signal of numbers.
fn time_bands(
    args: &FilterArgs,
    signal_name: &str,
    signal: &mut Signal,
    global: &Global<'_>,
) -> Result<Option<(TimeBands, Vec<f64>)>, CliError> {
    args.quantity.check_signal(signal_name)?;
    if !args.quantity.are_numbers() {
        let applies = "applies to numbers, and the signal holds directions or tensors";
        let options =
            ["--as-labels", "--local-fit", "--time-fwhm", "--time-lengths", "--recipe", "--save-recipe"];
        global.given.refuse(&options, applies)?;
    }
    let Some(time) = TimeBands::resolve(&args.time, signal_name, signal, global)? else { return Ok(None) };
    let usual = if args.gains_by_time.is_some() { 1.0 } else { 0.0 };
    let gains = args.time_gains.clone().unwrap_or_else(|| vec![usual; time.widths.len()]);
    time.check_gains(&gains)?;
    Ok(Some((time, gains)))
}

/// The operator, without welding if a field jumps between the sides of seams, because their mean would belong to
/// neither side.
fn with_open_seams(
    operator: OperatorParams,
    input: &Input,
    name: &str,
    signal: &Signal,
    global: &Global<'_>,
) -> Result<OperatorParams, CliError> {
    let is_field = name != COORDS && matches!(input.shape, Shape::Mesh(_)) && input.mesh_of_cells.is_none();
    let is_given = global.given.has("--weld") || global.given.has("--no-weld");
    let has_seams =
        |points: &[[f64; 3]]| VertexMap::new(points, WeldMode::EqualPositions).n_welded() < points.len();
    if !is_field || is_given || !input.shape.points().is_some_and(has_seams) {
        return Ok(operator);
    }
    let values = signal.values.to_vec();
    if values.len() != input.shape.n_vertices() * signal.n_channels {
        return Ok(operator);
    }
    let geometry = PreparedGeometry::new(&input.shape, operator.weld, global.progress())
        .map_err(|e| CliError::classify(&e))?;
    let Some(jumps) = jumps_at_seams(&geometry, &values, signal.n_channels) else { return Ok(operator) };
    let text = format!(
        "{name} jumps by about {} between the sides of seams, at {}: the sides are smoothed apart, as by --no-weld; --weld 0 smooths \
         across",
        number(jumps.size),
        count(jumps.n_places, "place", "places")
    );
    note(global, &text);
    Ok(operator.with_weld(WeldMode::Off))
}

/// Options with which each volume of a series is filtered by itself.
const OPTIONS_OF_VOLUMES: [&str; 9] = [
    "--output",
    "--levels",
    "--lengths",
    "--fwhm",
    "--steps",
    "--gains",
    "--preset",
    "--accuracy",
    "--local-fit",
];

/// The shape; of a series of volumes that are filtered one by one, the first and the source of all.
fn load_input(
    args: &FilterArgs,
    result: ResultFile<'_>,
    global: &Global<'_>,
) -> Result<(Input, Option<Columns>), CliError> {
    match series_of_input(args, result, global)? {
        Some(series) => {
            let input = load_first_volume(&args.shape, &series, global)?;
            Ok((input, Some(Columns::Volumes(Box::new(series)))))
        }
        None => Ok((load_shape(&args.shape, global)?, None)),
    }
}

/// The series of volumes that the shape is, if it is large, each volume is filtered by itself, and all values are known.
fn series_of_input(
    args: &FilterArgs,
    result: ResultFile<'_>,
    global: &Global<'_>,
) -> Result<Option<VolumeSeries>, CliError> {
    let (path, output) = (Path::new(&args.shape.shape), result.path());
    let is_file = path.is_file() && (output.is_file() || !output.exists());
    let is_nifti = Format::grid_from_path(output) == Some(Format::NIFTI);
    if !is_file || !is_nifti || !global.given.are_among(&OPTIONS_OF_VOLUMES) {
        return Ok(None);
    }
    let Some(series) = VolumeSeries::open(path, &global.limits) else { return Ok(None) };
    if series.n_volumes().saturating_mul(series.n_places()) < LARGE_SERIES {
        return Ok(None);
    }
    // Places without values are those of all volumes together.
    let is_finite = series.is_finite(global.progress()).map_err(CliError::input)?;
    Ok(is_finite.then_some(series))
}

/// The array that a signal of many channels is read from group by group, if the result is an array too and nothing
/// needs the signal as a whole. If the array has errors, reading it like any other signal reports them.
fn columns_of_signal(
    args: &FilterArgs,
    input: &Input,
    name: &str,
    result: ResultFile<'_>,
) -> Option<Columns> {
    let (path, output) = (Path::new(name), result.path());
    let is_array = has_extension(path, &["npy"]) && has_extension(output, &["npy"]);
    // A pipe or a device takes bytes in order.
    let is_file = path.is_file() && (output.is_file() || !output.exists());
    let is_plain = args.time.widths().is_none()
        && args.quantity.are_numbers()
        && args.signal.texture.is_none()
        && !args.as_labels
        && !args.labels.as_numbers;
    let own = input.file.field(name);
    if input.file.grid().is_some() && name == GRID_VALUES && is_plain && !has_extension(output, &["npy"]) {
        let is_large = own.is_some_and(|f| f.n_channels >= MANY_CHANNELS && f.values.len() >= LARGE);
        return is_large.then_some(Columns::OfGrid);
    }
    let is_of_shape = own.is_some() || input.file.file_rows().is_some();
    if !is_array || !is_file || !is_plain || is_of_shape || input.mesh_of_cells.is_some() {
        return None;
    }
    let columns = NpyColumns::open(path).ok().flatten()?;
    let fits = columns.n_rows() == input.shape.n_vertices() && columns.n_channels() >= MANY_CHANNELS;
    fits.then_some(Columns::Array(columns))
}

/// The widths of levels, which the flags or a recipe give.
fn given_lengths(spec: &LevelSpec) -> Vec<GivenLength> {
    let LevelSpec::Widths(widths) = spec else { return Vec::new() };
    widths.iter().map(|&length| GivenLength { option: "--lengths", length }).collect()
}

fn load_recipe(path: &Path, global: &Global<'_>) -> Result<Recipe, CliError> {
    global.inputs.add_file(path);
    read_recipe(path).map_err(CliError::input)
}

/// Clones and handles of the recipe, for coordinates only.
fn reshaped_by(recipe: Option<&Recipe>, signal_name: &str) -> Result<Option<ReshapedBy>, CliError> {
    let by = recipe.and_then(ReshapedBy::from_recipe);
    if recipe.is_some_and(|recipe| !recipe.turned.is_empty()) && signal_name != COORDS {
        return Err(CliError::Input(format!(
            "'turned' of the recipe turns faces over when coordinates are written, and the signal is {signal_name}; \
             remove it from the recipe"
        )));
    }
    if by.is_some() && signal_name != COORDS {
        return Err(CliError::Input(format!(
            "[[clone]] and [pose] of the recipe change coordinates, and the signal is {signal_name}; remove them from the recipe"
        )));
    }
    Ok(by)
}

/// The layers that the flags or the recipe ask for.
fn layers(args: &FilterArgs, recipe: Option<&Recipe>, global: &Global<'_>) -> Result<Vec<Layer>, CliError> {
    let n_widths = args.time.widths().map(|widths| widths.len());
    if let Some(GainRows(rows)) = &args.gains_by_time {
        let n_bands = match n_widths {
            None => {
                let applies = "applies to bands along time (--time-fwhm or --time-lengths)";
                return Err(CliError::Input(format!("--gains-by-time {applies}")));
            }
            Some(n_widths) => n_widths + 1,
        };
        if rows.len() != n_bands {
            return Err(CliError::Input(format!(
                "--gains-by-time must have {n_bands} rows, one for each band along time and one for the rest, got {}",
                rows.len()
            )));
        }
    }
    let (is_in_time, by_time, args) = (n_widths.is_some(), &args.gains_by_time, &args.edit);
    if is_in_time {
        // A recipe would lose them.
        global.given.refuse(
            &["--save-recipe", "--as-labels"],
            "applies to bands in space, and bands along time are asked for",
        )?;
    }
    if let Some(recipe) = recipe {
        if recipe.layers.is_empty() && ReshapedBy::from_recipe(recipe).is_none() && recipe.turned.is_empty() {
            note(global, "the recipe has no [[layer]], so nothing changes");
        }
        return Ok(recipe.layers.clone());
    }
    let gains = match (args.preset, by_time.as_ref().map(|rows| &rows.0[0]).or(args.gains.as_ref())) {
        (Some(preset), _) => Gains::Preset(preset),
        (None, Some(gains)) => Gains::Gains(gains.clone()),
        (None, None) if is_in_time => {
            let applies = "applies to bands in space; give --preset or --gains for them";
            global.given.refuse(&["--levels", "--steps", "--lengths", "--fwhm", "--region"], applies)?;
            return Ok(Vec::new());
        }
        (None, None) => {
            let width = ["--fwhm", "--lengths"].into_iter().find(|width| global.given.has(width));
            return Err(CliError::Input(match width {
                Some(width) => format!(
                    "{width} chooses the bands and changes none; add --gains, such as --gains 0, which smooths by the \
                     first width"
                ),
                None => "nothing to change; give --preset, --gains, --recipe, or --time-fwhm for a series"
                    .to_owned(),
            }));
        }
    };
    Ok(vec![Layer { gains, region: union_of_regions(&args.region) }])
}

/// The levels: those of the flags, else those of the recipe, else as many as there are gains, else the default.
fn levels(args: &FilterArgs, recipe: Option<&Recipe>) -> FilterLevels {
    let asked = args.levels.to_spec();
    let is_asked = asked != LevelSpec::Default;
    let by_time = args.gains_by_time.as_ref().map(|rows| &rows.0[0]);
    match (recipe, by_time.or(args.edit.gains.as_ref())) {
        (Some(recipe), _) if !is_asked => FilterLevels { spec: recipe.levels.clone(), is_from_recipe: true },
        (None, Some(gains)) if !is_asked => {
            FilterLevels { spec: LevelSpec::Dyadic(gains.len()), is_from_recipe: false }
        }
        _ => FilterLevels { spec: asked, is_from_recipe: false },
    }
}

/// The operator: that of the flags, else that of the recipe, else the one that goes with the levels of either.
fn operator(args: &FilterArgs, recipe: Option<&Recipe>) -> Result<OperatorParams, CliError> {
    let mut flags = args.shape.operator.clone();
    flags.density_invariant |= recipe.is_some_and(|recipe| recipe.density_invariant);
    flags.keep_creases |= recipe.is_some_and(|recipe| recipe.keep_creases);
    match recipe.and_then(|recipe| recipe.operator) {
        Some(kind) => operator_with_default(&flags, kind),
        None if !args.quantity.are_numbers() => operator_with_default(&flags, OperatorKind::Surface),
        None => operator_for_spec(&flags, &levels(args, recipe).spec),
    }
}

/// The local fit that is asked for, else the usual one; none if coordinates move in several directions.
fn resolve_local_fit(
    args: &FilterArgs,
    recipe: Option<&Recipe>,
    signal: &str,
    positions: PositionParams,
    usual: LocalFit,
) -> Result<Option<LocalFit>, CliError> {
    if signal == COORDS && positions.along.and_then(MoveDirection::axis).is_none() {
        return match args.fit.local_fit {
            Some(_) => Err(CliError::Input(
                "--local-fit is for a field (--signal) or for heights (--along z); leave it out".to_owned(),
            )),
            None => Ok(None),
        };
    }
    let in_recipe = recipe.and_then(|recipe| recipe.local_fit);
    Ok(Some(args.fit.local_fit.or(in_recipe).unwrap_or(usual)))
}

/// Options of new positions: those of the flags, else those of the recipe.
fn positions(args: &EditArgs, recipe: Option<&Recipe>) -> PositionParams {
    let in_recipe = recipe.map(|recipe| recipe.positions).unwrap_or_default();
    PositionParams::default()
        .with_along(args.along.or(in_recipe.along))
        .with_borders(args.border.unwrap_or(in_recipe.borders))
        .with_volume(match args.keep_volume {
            Some(KeepVolume::Offset) => Volume::Keep,
            Some(_) => Volume::Free,
            None => in_recipe.volume,
        })
}
