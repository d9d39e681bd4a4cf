//! `adwave rebase`: detail put onto a base that was edited elsewhere.

use super::moved_shape::MovedShape;
use crate::args::{
    BaseWidthArgs, OPERATOR_OPTIONS, QUAD_OPTIONS, QuadArgs, ShapeArgs, count_from_one, file_name,
    parse_named,
};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::{check_writable, count, number, output_format, percent_of, print, write_shape};
use crate::resolve::operator::{operator_for_task, prepare};
use crate::resolve::shape::{Input, ShapeSource, load_shape, load_source};
use adwave::Progress;
use adwave::operator::OperatorTask;
use adwave::shape::{Mesh, MeshArea, Polygons, mesh_areas};
use adwave_deform::{EditedLevel, base_points, with_base, with_level};
use adwave_io::ShapeFile;
use adwave_subdivision::{Family, Hierarchy, LiftedWavelets, SubdivisionError, WeldedMesh};
use clap::{ArgGroup, Args};
use serde_json::json;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(
    group(ArgGroup::new("step").required(true).args(["base", "write_base"])),
    after_help = "\
The base is the shape without its detail: all its vertices, smoothed to the width of --width. Write it, bend or sculpt it in any
program that keeps the number and the order of the vertices, and put the detail back: each detail turns with its
surroundings from the old base to the new one. The unchanged base gives the shape back. The base of another pose with the same
faces works as well. Use the same --width for both steps.

Examples:
  adwave rebase scan.ply --write-base base.obj            1. write the base
  adwave rebase scan.ply --base bent.obj -o posed.ply     2. base.obj was edited as bent.obj
  adwave rebase scan.ply --write-base base.obj --width 4%     a smoother base: more rides along
  adwave rebase sculpture.obj --write-base coarse.obj --level 1    a coarse level
  adwave rebase sculpture.obj --base coarse.obj --level 1 -o out.obj"
)]
pub(crate) struct RebaseArgs {
    #[command(flatten)]
    pub(crate) shape: ShapeArgs,
    /// Edited base: a file with as many vertices in the same order
    #[arg(long, value_name = "FILE", value_parser = file_name(), requires = "output")]
    pub(crate) base: Option<String>,
    /// File for the base of the shape, to edit it elsewhere
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    pub(crate) write_base: Option<PathBuf>,
    /// File for the result; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) width: BaseWidthArgs,
    /// Take level K of subdivision as the base (see 'adwave info'): it has its own vertices and faces, and the detail of all finer
    /// levels rides along
    #[arg(long, value_name = "K", value_parser = count_from_one, conflicts_with = "width", help_heading = "Base")]
    pub(crate) level: Option<NonZeroUsize>,
    /// Rule of subdivision of --level [default: catmull-clark on quadrilaterals, butterfly on triangles]
    #[arg(long, value_name = "FAMILY", value_parser = parse_named::<Family>(), requires = "level", help_heading = "Base")]
    pub(crate) family: Option<Family>,
    #[command(flatten)]
    pub(crate) quads: QuadArgs,
}

pub(crate) fn run(args: &RebaseArgs, global: &Global<'_>) -> Result<(), CliError> {
    args.width.check()?;
    args.quads.check()?;
    let path = args.write_base.as_ref().or(args.output.as_ref());
    let Some(path) = path else { unreachable!("one of them is required") };
    output_format(path)?;
    check_writable(path)?;
    if let Some(level) = args.level {
        global.given.refuse(&OPERATOR_OPTIONS, "applies to --width, and --level needs no operator")?;
        return rebase_level(args, level.get(), path, global);
    }
    global.given.refuse(&QUAD_OPTIONS, "applies to --level")?;
    let input = load_shape(&args.shape, global)?;
    input.check_lengths(&args.width.given_lengths())?;
    let base = match &args.base {
        Some(name) => Some(load_source(&ShapeSource::new(name), global)?),
        None => None,
    };
    let decomposer =
        prepare(global, &input, &operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?)?;
    let schedule = args.width.resolve(&decomposer)?;
    let sigma = schedule.sigma(decomposer.operator().step_length()).last().copied().unwrap_or_default();
    let points = with_progress(global, "splitting", |progress| match &base {
        Some(base) => {
            let points = base.shape.points().unwrap_or_default();
            with_base(&decomposer, &schedule, points, progress)
        }
        None => base_points(&decomposer, &schedule, progress),
    });
    let points = points.map_err(|error| match (&base, error) {
        (Some(base), error) => super::moved_shape::name_error(&base.name, error),
        (None, error) => error.into(),
    })?;
    let what = if base.is_some() { "detail put onto" } else { "base:" };
    let onto = base.as_ref().map_or_else(String::new, |base| format!(" {}", base.name));
    let text = format!(
        "{}: {what}{onto} σ {}, {} % of the diagonal\n",
        input.name,
        number(sigma),
        percent_of(sigma, decomposer.extent())
    );
    let report = json!({"sigma": sigma, "base": args.base, "operator": decomposer.operator_kind().name()});
    MovedShape { input, decomposer: &decomposer, points, text, report }.write(path, global)
}

/// Levels of a mesh with wavelets on them.
struct LevelBase {
    welded: WeldedMesh,
    hierarchy: Hierarchy,
    wavelets: LiftedWavelets,
    /// Positions of the welded vertices.
    points: Vec<[f64; 3]>,
}

impl LevelBase {
    fn new(args: &RebaseArgs, mesh: &Mesh, progress: Progress<'_>) -> Result<Self, SubdivisionError> {
        let welded = WeldedMesh::new(mesh);
        let hierarchy = args.quads.hierarchy(&welded, mesh, progress)?;
        let points = welded.points(mesh);
        let areas = mesh_areas(&points, &welded.triangles, MeshArea::Barycentric);
        let family = args.family.unwrap_or(hierarchy.usual_family());
        let wavelets = LiftedWavelets::new(&hierarchy, family, &areas, progress)?;
        Ok(Self { welded, hierarchy, wavelets, points })
    }

    /// Positions of a level.
    fn positions(&self, level: usize, progress: Progress<'_>) -> Result<Vec<[f64; 3]>, SubdivisionError> {
        let coarse = self.wavelets.coarse_field(self.points.as_flattened(), 3, level, progress)?;
        Ok(coarse.as_chunks().0.to_vec())
    }
}

/// Writes a level of subdivision, or puts the detail of finer levels onto an edited one.
fn rebase_level(args: &RebaseArgs, level: usize, path: &Path, global: &Global<'_>) -> Result<(), CliError> {
    let input = load_shape(&args.shape, global)?;
    let name_error = |error: SubdivisionError| match error {
        SubdivisionError::Cancelled(_) => CliError::Cancelled,
        other => CliError::Input(format!("{}: {other}", input.name)),
    };
    let Some(mesh) = input.shape.as_mesh() else {
        return Err(CliError::Input(format!("{}: --level needs a mesh; use --width", input.name)));
    };
    QuadArgs::refuse_on_triangles(mesh, &input.name, global)?;
    let base = with_progress(global, "finding levels", |progress| LevelBase::new(args, mesh, progress))
        .map_err(name_error)?;
    let sizes: Vec<usize> = (0..=base.hierarchy.n_levels()).map(|k| base.hierarchy.n_vertices(k)).collect();
    let family = base.wavelets.family();
    let text = format!(
        "{}: level {level} of {}, by the rule {family}\n",
        input.name,
        count(sizes.len() - 1, "level of subdivision", "levels of subdivision"),
    );
    let report = json!({"level": level, "sizes": sizes, "family": family.name(), "base": args.base});
    let Some(name) = &args.base else {
        let points = with_progress(global, "splitting", |progress| base.positions(level, progress))
            .map_err(name_error)?;
        return write_level(
            &input,
            &base.hierarchy.faces(level)?,
            points,
            LevelReport { text, report },
            path,
            global,
        );
    };
    let edited = load_source(&ShapeSource::new(name), global)?;
    let points = with_progress(global, "carrying detail", |progress| {
        let edited = EditedLevel { level, points: edited.shape.points().unwrap_or_default() };
        with_level(&base.hierarchy, &base.wavelets, &base.points, &edited, progress)
    })
    .map_err(|error| super::moved_shape::name_error(&edited.name, error))?;
    let points = base.welded.of_vertex.iter().map(|&v| points[v as usize]).collect();
    let decomposer =
        prepare(global, &input, &operator_for_task(&args.shape.operator, OperatorTask::StepLevels)?)?;
    MovedShape { input, decomposer: &decomposer, points, text, report }.write(path, global)
}

/// Lines and numbers about a level.
struct LevelReport {
    text: String,
    report: serde_json::Value,
}

/// Writes the mesh of a level.
fn write_level(
    input: &Input,
    faces: &Polygons,
    points: Vec<[f64; 3]>,
    told: LevelReport,
    path: &Path,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let LevelReport { mut text, mut report } = told;
    text +=
        &format!("{}, {}\n", count(points.len(), "vertex", "vertices"), count(faces.len(), "face", "faces"));
    report["shape"] = json!(input.name);
    report["output"] = json!(path.display().to_string());
    report["vertices"] = json!(points.len());
    report["faces"] = json!(faces.len());
    write_shape(global, &ShapeFile::from_mesh(points, faces.clone()), path)?;
    text += &format!("{}\n", path.display());
    print(global, &text, &report)
}
