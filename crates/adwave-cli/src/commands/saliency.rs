//! `adwave saliency`: a map of where a signal stands out.

use super::analysis::{Analysis, AnalysisArgs, Map};
use super::result_file::check_places;
use crate::args::{
    BorderMaskArgs, GivenWalkArgs, LevelArgs, MapArgs, ShapeArgs, SignalArgs, number as parse_number,
};
use crate::error::CliError;
use crate::global::Global;
use crate::output::values_file::{ValuesFile, holds_fields, unsuitable_format};
use crate::output::{
    check_writable, clone_for_output, number, percent_of, print, release_source, table, write_shape,
};
use crate::resolve::shape::row_words;
use adwave::saliency::{MapWeighting, Saliency, SaliencyLevel, saliency_per_level};
use adwave_io::{Field, FieldValues};
use adwave_render::{ColorMap, value_range};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Output by extension:
  .ply .vtp   the shape with the fields saliency and color
  .npy        the map, one number per vertex; with --per-level one row per vertex: the map, then
              each level
  .csv .gii   the map and, with --per-level, the levels as named columns; .gii as 32-bit floats

The map of coordinates is + where the shape is convex and - where it is concave, if the shape has an outside. That of a scalar
signal is + above its surroundings and - below. Other vectors, --unsigned and --weighting give a map without a sign. Vertices
where the signal is NaN are masked, and the map is NaN there.

Examples:
  adwave saliency bunny.obj -o map.ply
  adwave saliency bunny.obj -o map.ply --weighting paper
  adwave saliency scan.pcd -o map.vtp --signal mean-curvature --color-map magma
  adwave saliency face-scan.ply -o map.ply --mask-border 1
  adwave saliency cow.obj -o map.ply --signal texture-lightness --texture cow.png
  adwave saliency pial.gii.gz -o map.shape.gii --signal sulc.gii.gz")]
pub(crate) struct SaliencyArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// File for the map (.ply, .glb, .vtp, .las, .npy, .csv, .gii and others)
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) walk: GivenWalkArgs,
    #[command(flatten)]
    pub(crate) signal: SignalArgs,
    #[command(flatten)]
    pub(crate) levels: LevelArgs,
    #[command(flatten)]
    pub(crate) map: MapArgs,
    #[command(flatten)]
    pub(crate) border: BorderMaskArgs,
    /// Write the contribution of each level too, as the fields saliency3, saliency4 …
    #[arg(long, help_heading = "Map")]
    pub(crate) per_level: bool,
    /// Color map: viridis, magma, inferno, plasma, cividis, turbo, cool, warm, gray, coolwarm, red-blue or spectral
    /// [default: coolwarm centered at 0 if the map has a sign, else viridis]
    #[arg(long, alias = "colormap", value_name = "NAME", help_heading = "Map")]
    pub(crate) color_map: Option<String>,
    /// Percentile of the map, or of its magnitude if it has a sign, that gets the last color; values above get it too
    #[arg(long, value_name = "P", value_parser = parse_number, default_value_t = 99.0, help_heading = "Map")]
    pub(crate) color_top: f64,
}

impl SaliencyArgs {
    fn analysis(&self) -> AnalysisArgs<'_> {
        let extent = self.map.weighting.extent();
        let walk = Some(&self.walk);
        AnalysisArgs {
            shape: &self.shape,
            signal: &self.signal,
            levels: &self.levels,
            is_of_paper: self.map.weighting != MapWeighting::Signed,
            extent: Some(extent),
            walk,
        }
    }
}

pub(crate) fn run(args: &SaliencyArgs, global: &Global<'_>) -> Result<(), CliError> {
    let mut alone = ValuesFile::from_path(&args.output);
    if alone.is_none() && !holds_fields(&args.output) {
        return Err(unsuitable_format(&args.output, "a map is", &[".npy", ".csv", ".gii"]));
    }
    check_writable(&args.output)?;
    if alone.is_some() {
        let applies = "applies to shapes with colors, and the file holds the map alone";
        global.given.refuse(&["--color-map", "--color-top"], applies)?;
    }
    if args.map.weighting != MapWeighting::Signed {
        global
            .given
            .refuse(&["--unsigned"], "applies to --weighting signed, and the other maps have no sign")?;
    }
    color_map(args)?;
    if !(args.color_top > 0.0 && args.color_top <= 100.0) {
        return Err(CliError::Input(format!(
            "--color-top must be above 0 and at most 100, got {}",
            args.color_top
        )));
    }
    args.map.to_params(&args.border).check().map_err(CliError::input)?;
    let mut analysis = Analysis::new(args.analysis(), global)?;
    // The map goes into a new file: the bytes of the old one need not be kept while the bands are computed.
    release_source(&mut analysis.input.file, &args.output);
    check_places(&args.output, &analysis.input)?;
    alone = ValuesFile::choose(&args.output, &analysis.input.file);
    let mut map = analysis.saliency(&args.map, &args.border, global)?;
    let mut levels = if args.per_level {
        saliency_per_level(&analysis.decomposer, &map.wavelets, &map.params, global.progress())
            .map_err(|e| CliError::classify(&e))?
    } else {
        Vec::new()
    };
    if let Some(kept) = analysis.input.file.grid().and_then(|grid| grid.kept.as_deref()) {
        let maps = std::iter::once(&mut map.saliency.map).chain(levels.iter_mut().map(|(_, level)| level));
        maps.for_each(|map| leave_out(map, kept));
    }
    let fields = fields(&map.saliency, &levels);
    match alone {
        Some(kind) => kind.write(global, &args.output, &fields, &analysis.input.file)?,
        None => write_colored(args, global, &analysis, &map, fields)?,
    }
    report(args, global, &analysis, &map)
}

/// Sets a map to NaN where an image or a volume has no data.
fn leave_out(map: &mut [f64], kept: &[bool]) {
    for (value, _) in map.iter_mut().zip(kept).filter(|(_, kept)| !**kept) {
        *value = f64::NAN;
    }
}

/// The color map that is asked for.
fn color_map(args: &SaliencyArgs) -> Result<Option<ColorMap>, CliError> {
    let Some(name) = &args.color_map else { return Ok(None) };
    ColorMap::from_name(name).map(Some).ok_or_else(|| {
        let names: Vec<&str> = ColorMap::names().collect();
        CliError::Input(format!("--color-map must be one of {}, got '{name}'", names.join(", ")))
    })
}

fn report(args: &SaliencyArgs, global: &Global<'_>, analysis: &Analysis, map: &Map) -> Result<(), CliError> {
    let saliency = &map.saliency;
    let [one, _] = analysis.input.row_words();
    let [row, rows] = row_words(&analysis.input.file);
    let mut text = analysis.headline();
    text += &format!("{}\n\n", map.sides());
    text += &table(
        ["level", "sigma", "% of diagonal", "mean of |W|", "max of |W|", "alpha"],
        saliency.levels.iter().map(|l| {
            let percent = percent_of(l.sigma, analysis.decomposer.extent());
            let alpha = if l.alpha.is_nan() { format!("per {one}") } else { number(l.alpha) };
            [l.level.to_string(), number(l.sigma), percent, number(l.mean), number(l.max), alpha]
        }),
    );
    let known = || saliency.map.iter().enumerate().filter(|(_, v)| !v.is_nan());
    let in_file = |(vertex, value)| (analysis.input.file.file_row(vertex), value);
    let most = known().max_by(|a, b| a.1.total_cmp(b.1)).map(in_file);
    let least = known().min_by(|a, b| a.1.total_cmp(b.1)).filter(|_| map.is_signed).map(in_file);
    if let Some((vertex, value)) = most {
        text += &format!("\nlargest at {one} {vertex}: {}\n", number(*value));
    }
    if let Some((vertex, value)) = least {
        text += &format!("smallest at {one} {vertex}: {}\n", number(*value));
    }
    text += &analysis.timing("map", map.seconds);
    text += &args.output.display().to_string();
    let json = json!({
        "shape": analysis.input.name,
        "output": args.output.display().to_string(),
        "field": analysis.name,
        rows: analysis.decomposer.n_vertices(),
        "operator": analysis.decomposer.operator_kind().name(),
        "sides": map.sides_json(),
        "levels_reason": analysis.levels_reason,
        "levels": saliency.levels.iter().map(|l| json!({
            "level": l.level, "sigma": l.sigma, "mean": l.mean, "max": l.max,
            "alpha": if l.alpha.is_nan() { None } else { Some(l.alpha) },
        })).collect::<Vec<_>>(),
        format!("largest_{row}"): most.map(|m| m.0),
        "largest": most.map(|m| m.1),
        format!("smallest_{row}"): least.map(|m| m.0),
        "smallest": least.map(|m| m.1),
        "seconds": {
            "read": analysis.seconds.read, "diffusion": analysis.seconds.diffusion, "bands": analysis.seconds.bands,
            "map": map.seconds,
        },
    });
    print(global, &text, &json)
}

/// The map, then the contribution of each level if that is asked for.
fn fields(saliency: &Saliency, levels: &[(SaliencyLevel, Vec<f64>)]) -> Vec<Field> {
    let field = |name: String, map: &[f64]| Field::new(name, 1, FieldValues::F64(map.to_vec()));
    let each = levels.iter().map(|(level, map)| field(format!("saliency{}", level.level), map));
    std::iter::once(field("saliency".to_owned(), &saliency.map)).chain(each).collect()
}

/// The shape with the fields and colors.
fn write_colored(
    args: &SaliencyArgs,
    global: &Global<'_>,
    analysis: &Analysis,
    map: &Map,
    fields: Vec<Field>,
) -> Result<(), CliError> {
    let colors = color_map(args)?;
    let mut file = clone_for_output(&analysis.input.file, &args.output);
    for field in fields {
        file.add_vertex_field(field)?;
    }
    let values = &map.saliency.map;
    let sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    let top = value_range(&sizes, 0.0, args.color_top / 100.0).1;
    let (name, bottom) = if map.is_signed { ("coolwarm", -top) } else { ("viridis", 0.0) };
    let colors = colors.or_else(|| ColorMap::from_name(name)).expect("a name of the list");
    let color = colors.colors(values, bottom, top);
    file.add_vertex_field(Field::new("color", 3, FieldValues::U8(color)))?;
    write_shape(global, &file, &args.output).map(|_| ())
}
