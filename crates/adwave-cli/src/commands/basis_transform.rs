//! `adwave transform --basis`: as many coefficients as values, of wavelets by lifting, and the field that they stand
//! for.

use super::transform::TransformArgs;
use crate::args::{OPERATOR_OPTIONS, QUAD_OPTIONS, QuadArgs};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::provenance::provenance;
use crate::output::values_file::{ValuesFile, holds_fields, unsuitable_format};
use crate::output::{check_writable, clone_for_output, count, has_extension, number, print, table};
use crate::output::{write_file_with, write_shape};
use crate::resolve::shape::{Input, load_shape};
use crate::resolve::signal::{load_signal, refuse_labels, smooth_labels_hint};
use adwave::shape::{MeshArea, Shape, mesh_areas};
use adwave::{Cancelled, Progress};
use adwave_io::{ArrayValues, Compression, Field, FieldValues};
use adwave_subdivision::{
    Family, HaarWavelets, LiftedCoefficients, LiftedWavelets, SubdivisionError, WeldedMesh,
};
use serde_json::json;
use std::path::Path;

/// Options of bands, which wavelets by lifting do not have.
const LEVEL_OPTIONS: [&str; 14] = [
    "--levels",
    "--voices",
    "--steps",
    "--accuracy",
    "--lengths",
    "--fwhm",
    "--weld",
    "--no-weld",
    "--time-fwhm",
    "--time-lengths",
    "--time-step",
    "--time-ends",
    "--directions",
    "--tensors",
];

/// Wavelets of a mesh, on vertices or on faces.
enum MeshWavelets {
    Vertices(LiftedWavelets),
    Faces(HaarWavelets),
}

/// Values of the vertices or, for wavelets on faces, of the faces of the file.
struct BasisSignal {
    values: Vec<f64>,
    n_channels: usize,
    is_of_faces: bool,
}

impl BasisSignal {
    fn from_face_field(field: &Field) -> Self {
        Self { values: field.to_f64(), n_channels: field.n_channels, is_of_faces: true }
    }
}

/// The field of the faces of that name, unless the vertices have one of the same name.
fn find_face_field<'a>(input: &'a Input, name: &str) -> Option<&'a Field> {
    let field = input.file.face_fields().iter().find(|field| field.name == name)?;
    input.file.field(name).is_none().then_some(field)
}

/// A signal on a mesh, ready to be transformed.
struct BasisJob {
    family: Family,
    input: Input,
    welded: WeldedMesh,
    basis: MeshWavelets,
    /// Number of vertices or faces on each level, from fine to coarse.
    sizes: Vec<usize>,
    /// Values of the welded vertices or of the faces.
    values: Vec<f64>,
    n_channels: usize,
    /// True if the values are those of a field of the faces, and not means of their corners.
    is_of_faces: bool,
}

pub(crate) fn run(args: &TransformArgs, family: Family, global: &Global<'_>) -> Result<(), CliError> {
    let applies = "applies to bands, and --basis has levels of its own";
    global.given.refuse(&LEVEL_OPTIONS, applies)?;
    global.given.refuse(&OPERATOR_OPTIONS, applies)?;
    if args.inverse {
        global.given.refuse(&["--keep"], "applies to coefficients, and --inverse makes a field of them")?;
    }
    if let Some(share) = args.keep.filter(|share| !(0.0..=1.0).contains(share)) {
        return Err(SubdivisionError::Share(share).into());
    }
    args.quads.check()?;
    let kind = OutputKind::from_path(&args.output)?;
    check_writable(&args.output)?;
    if matches!(family, Family::Irregular | Family::Haar) {
        global.given.refuse(&QUAD_OPTIONS, "applies to --basis catmull-clark and linear")?;
    }
    let input = load_shape(&args.shape, global)?;
    let name = args.signal.name_on(&input.file);
    let of_faces = if family == Family::Haar { find_face_field(&input, name) } else { None };
    let signal = match of_faces {
        Some(field) => BasisSignal::from_face_field(field),
        None if args.inverse && family == Family::Haar => {
            return Err(CliError::Input(format!(
                "{}: coefficients of haar belong to faces, and the faces have no field {name}; name the field that \
                 transform --basis haar wrote to a shape",
                input.name
            )));
        }
        None => {
            let signal = load_signal(global, &input, name, args.signal.texture.as_deref())?;
            refuse_labels(name, &signal, args.labels, &smooth_labels_hint(name))?;
            BasisSignal { values: signal.values.to_vec(), n_channels: signal.n_channels, is_of_faces: false }
        }
    };
    let job = with_progress(global, "finding levels", |progress| {
        prepare(input, family, &args.quads, signal, progress)
    })?;
    if let Some(mesh) = job.input.shape.as_mesh() {
        QuadArgs::refuse_on_triangles(mesh, &job.input.name, global)?;
    }
    if args.inverse {
        return write_field(args, &job, kind, global);
    }
    let all = with_progress(global, "transforming", |progress| job.analyze(progress))?;
    let kept = args.keep.map(|share| all.keep(share)).transpose()?;
    let error = match &kept {
        Some(kept) => {
            Some(with_progress(global, "measuring", |progress| job.relative_error(kept, progress))?)
        }
        None => None,
    };
    write_coefficients(args, &job, kept.as_ref().unwrap_or(&all), kind, global)?;
    report(args, &job, &all, error, global)
}

/// Kind of the file of coefficients or of a field.
#[derive(Clone, Copy)]
enum OutputKind {
    Npz,
    Alone(ValuesFile),
    Shape,
}

impl OutputKind {
    fn from_path(path: &Path) -> Result<Self, CliError> {
        if has_extension(path, &["npz"]) {
            return Ok(Self::Npz);
        }
        match ValuesFile::from_path(path) {
            Some(alone) => Ok(Self::Alone(alone)),
            None if holds_fields(path) => Ok(Self::Shape),
            None => Err(unsuitable_format(path, "coefficients are", &[".npz", ".npy", ".csv"])),
        }
    }
}

fn prepare(
    input: Input,
    family: Family,
    quads: &QuadArgs,
    signal: BasisSignal,
    progress: Progress<'_>,
) -> Result<BasisJob, CliError> {
    let name_error = |error: SubdivisionError| match error {
        SubdivisionError::Cancelled(_) => CliError::Cancelled,
        other => CliError::Input(format!("{}: {other}", input.name)),
    };
    let Some(mesh) = input.shape.as_mesh() else {
        return Err(CliError::Input(format!(
            "{}: --basis needs a mesh; without --basis, bands are for any shape",
            input.name
        )));
    };
    let welded = WeldedMesh::new(mesh);
    let BasisSignal { values, n_channels: d, is_of_faces } = signal;
    let values = if is_of_faces {
        if mesh.faces().triangles().is_none() || values.len() != d * welded.triangles.len() {
            return Err(CliError::Input(format!(
                "{}: its field of the faces must have a row per triangle; triangulate the mesh first",
                input.name
            )));
        }
        values
    } else {
        welded.gather(&values, d).map_err(name_error)?
    };
    let points = welded.points(mesh);
    let areas = mesh_areas(&points, &welded.triangles, MeshArea::Barycentric);
    progress.check().map_err(|Cancelled| CliError::Cancelled)?;
    let (basis, sizes, values) = match family {
        Family::Irregular => {
            let wavelets = LiftedWavelets::new_irregular(&points, &welded.triangles, &areas, progress)
                .map_err(name_error)?;
            let sizes = (0..=wavelets.n_levels()).map(|level| wavelets.n_vertices_at(level)).collect();
            (MeshWavelets::Vertices(wavelets), sizes, values)
        }
        Family::Haar => {
            let hierarchy = quads.hierarchy(&welded, mesh, progress).map_err(name_error)?;
            let wavelets =
                HaarWavelets::new(&hierarchy, &face_areas(&points, &welded.triangles)).map_err(name_error)?;
            let sizes = (0..=hierarchy.n_levels()).map(|level| hierarchy.n_faces(level)).collect();
            let values = if is_of_faces { values } else { means_of_corners(&values, d, &welded.triangles) };
            (MeshWavelets::Faces(wavelets), sizes, values)
        }
        _ => {
            let hierarchy = quads.hierarchy(&welded, mesh, progress).map_err(name_error)?;
            let wavelets = LiftedWavelets::new(&hierarchy, family, &areas, progress).map_err(name_error)?;
            let sizes = (0..=hierarchy.n_levels()).map(|level| hierarchy.n_vertices(level)).collect();
            (MeshWavelets::Vertices(wavelets), sizes, values)
        }
    };
    Ok(BasisJob { family, welded, basis, sizes, values, n_channels: d, is_of_faces, input })
}

/// Areas of triangles.
fn face_areas(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
    // Each third of a triangle is its corner's share of a mesh of that triangle alone.
    let area = |t: &[u32; 3]| {
        let corners = t.map(|v| points[v as usize]);
        mesh_areas(&corners, &[[0, 1, 2]], MeshArea::Barycentric).iter().sum()
    };
    triangles.iter().map(area).collect()
}

/// Mean of the values of the corners of each triangle.
fn means_of_corners(values: &[f64], d: usize, triangles: &[[u32; 3]]) -> Vec<f64> {
    let mean = |t: &[u32; 3], c: usize| t.iter().map(|&v| values[v as usize * d + c]).sum::<f64>() / 3.0;
    triangles.iter().flat_map(|t| (0..d).map(move |c| mean(t, c))).collect()
}

impl BasisJob {
    fn analyze(&self, progress: Progress<'_>) -> Result<LiftedCoefficients, CliError> {
        Ok(match &self.basis {
            MeshWavelets::Vertices(wavelets) => wavelets.analyze(&self.values, self.n_channels, progress)?,
            MeshWavelets::Faces(wavelets) => wavelets.analyze(&self.values, self.n_channels, progress)?,
        })
    }

    fn synthesize(&self, coefficients: &[f64], progress: Progress<'_>) -> Result<Vec<f64>, CliError> {
        Ok(match &self.basis {
            MeshWavelets::Vertices(wavelets) => {
                wavelets.synthesize(coefficients, self.n_channels, progress)?
            }
            MeshWavelets::Faces(wavelets) => wavelets.synthesize(coefficients, self.n_channels, progress)?,
        })
    }

    fn masses(&self) -> &[f64] {
        match &self.basis {
            MeshWavelets::Vertices(wavelets) => wavelets.masses(),
            MeshWavelets::Faces(wavelets) => wavelets.areas(),
        }
    }

    /// Root mean square difference by area from the field that some coefficients stand for, divided by the deviation of
    /// the field; 0 for a constant field.
    fn relative_error(&self, kept: &LiftedCoefficients, progress: Progress<'_>) -> Result<f64, CliError> {
        let (found, d) = (self.synthesize(&kept.values, progress)?, self.n_channels);
        let (mut error, mut variance) = (0.0, 0.0);
        for c in 0..d {
            let rows = || self.masses().iter().enumerate().map(|(i, m)| (m, i * d + c));
            let mean: f64 = rows().map(|(m, i)| m * self.values[i]).sum();
            error += rows().map(|(m, i)| m * (self.values[i] - found[i]).powi(2)).sum::<f64>();
            variance += rows().map(|(m, i)| m * (self.values[i] - mean).powi(2)).sum::<f64>();
        }
        Ok(if variance > 0.0 { (error / variance).sqrt() } else { 0.0 })
    }

    /// Values of welded vertices as rows of the mesh; values of faces as they are.
    fn in_mesh_rows(&self, values: &[f64], d: usize) -> Vec<f64> {
        match self.basis {
            MeshWavelets::Vertices(_) => self.welded.scatter(values, d),
            MeshWavelets::Faces(_) => values.to_vec(),
        }
    }
}

fn faces_need_shape(path: &Path, what: &str) -> CliError {
    let text =
        format!("{what} of haar belong to faces; write a shape with fields of faces, such as .ply or .vtu");
    CliError::Input(format!("{}: {text}", path.display()))
}

/// Makes a field of the coefficients in the signal and writes it.
fn write_field(
    args: &TransformArgs,
    job: &BasisJob,
    kind: OutputKind,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let field = with_progress(global, "transforming", |progress| job.synthesize(&job.values, progress))?;
    let values = FieldValues::F64(job.in_mesh_rows(&field, job.n_channels));
    let field = Field::new("field", job.n_channels, values);
    let on_faces = matches!(job.basis, MeshWavelets::Faces(_));
    match kind {
        OutputKind::Npz => {
            let text = "the field of --inverse is written as a shape with fields, .npy, .csv or .gii";
            return Err(CliError::Input(format!("{}: {text}", args.output.display())));
        }
        OutputKind::Alone(_) if on_faces => return Err(faces_need_shape(&args.output, "the field")),
        OutputKind::Alone(alone) => alone.write(global, &args.output, &[field], &job.input.file)?,
        OutputKind::Shape => {
            let mut file = clone_for_output(&job.input.file, &args.output);
            if on_faces {
                file.add_face_field(field)?;
            } else {
                file.add_vertex_field(field)?;
            }
            write_shape(global, &file, &args.output)?;
        }
    }
    let text = format!(
        "{}: field of {} of the family {}, by the levels of the mesh\n{}",
        job.input.name,
        count(job.values.len() / job.n_channels, "coefficient", "coefficients"),
        job.family,
        args.output.display()
    );
    let json = json!({
        "shape": job.input.name,
        "output": args.output.display().to_string(),
        "basis": job.family.name(),
        "levels": job.sizes.len() - 1,
        "sizes": job.sizes,
        "inverse": true,
    });
    print(global, &text, &json)
}

fn write_coefficients(
    args: &TransformArgs,
    job: &BasisJob,
    coefficients: &LiftedCoefficients,
    kind: OutputKind,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let d = job.n_channels;
    let values = job.in_mesh_rows(&coefficients.values, d);
    let levels: Vec<f64> = coefficients.levels.iter().map(|&level| f64::from(level)).collect();
    let (levels, norms) = (job.in_mesh_rows(&levels, 1), job.in_mesh_rows(&coefficients.norms, 1));
    let on_faces = matches!(job.basis, MeshWavelets::Faces(_));
    let path = args.output.as_path();
    if let OutputKind::Npz = kind {
        let file = &job.input.file;
        let in_rows = |values: Vec<f64>, d: usize| match file.file_rows() {
            Some(rows) if !on_faces => rows.spread_values(&values, d),
            _ => values,
        };
        let (values, levels, norms) = (in_rows(values, d), in_rows(levels, 1), in_rows(norms, 1));
        let (values_shape, rows_shape) = ([levels.len(), d], [levels.len()]);
        let provenance = provenance(global)?.to_json();
        let arrays: Vec<(&str, &[usize], ArrayValues<'_>)> = vec![
            ("coefficient", &values_shape, ArrayValues::F64(&values)),
            ("level", &rows_shape, ArrayValues::F64(&levels)),
            ("norm", &rows_shape, ArrayValues::F64(&norms)),
            ("basis", &[], ArrayValues::Text(job.family.name())),
            ("provenance", &[], ArrayValues::Text(&provenance)),
        ];
        return write_file_with(global, path, |path| {
            adwave_io::write_npz(path, &arrays, Compression::Stored)
        });
    }
    let field = |name: &str, d: usize, values: Vec<f64>| Field::new(name, d, FieldValues::F64(values));
    let fields = [field("coefficient", d, values), field("level", 1, levels), field("norm", 1, norms)];
    match kind {
        _ if on_faces => {
            let Shape::Mesh(_) = &job.input.shape else { return Ok(()) };
            if !holds_fields(path) {
                return Err(faces_need_shape(path, "coefficients"));
            }
            let mut file = clone_for_output(&job.input.file, path);
            for field in fields {
                file.add_face_field(field)?;
            }
            write_shape(global, &file, path).map(|_| ())
        }
        OutputKind::Alone(alone) => alone.write(global, path, &fields, &job.input.file),
        _ => {
            let mut file = clone_for_output(&job.input.file, path);
            for field in fields {
                file.add_vertex_field(field)?;
            }
            write_shape(global, &file, path).map(|_| ())
        }
    }
}

fn report(
    args: &TransformArgs,
    job: &BasisJob,
    all: &LiftedCoefficients,
    error: Option<f64>,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let (name, n_levels, d) = (args.signal.name_on(&job.input.file), job.sizes.len() - 1, job.n_channels);
    let mut squares = vec![0.0; n_levels + 2];
    let mut counts = vec![0_usize; n_levels + 2];
    for (i, &level) in all.levels.iter().enumerate() {
        let row = &all.values[i * d..][..d];
        squares[level as usize] += row.iter().map(|c| (c * all.norms[i]).powi(2)).sum::<f64>();
        counts[level as usize] += 1;
    }
    let [one, many] =
        if let MeshWavelets::Faces(_) = job.basis { ["face", "faces"] } else { ["vertex", "vertices"] };
    let mut text = format!(
        "{}: {}, {} of {name}\n{} levels of the family {}, {} → {}\n\n",
        job.input.name,
        count(job.sizes[0], one, many),
        count(d, "channel", "channels"),
        n_levels,
        job.family,
        job.sizes[0],
        count(job.sizes[n_levels], one, many),
    );
    let rows = (1..=n_levels + 1).map(|level| {
        let label = if level <= n_levels { level.to_string() } else { "coarsest".to_owned() };
        [label, counts[level].to_string(), number(squares[level].sqrt())]
    });
    text += &table(["level", "coefficients", "norm"], rows);
    let n_kept = args.keep.map(|share| (share * job.sizes[0] as f64).ceil() as usize);
    if let (Some(error), Some(n_kept)) = (error, n_kept) {
        text += &format!(
            "\nkept {n_kept} of {}; they give the signal up to {} % of its deviation, rms by area\n",
            count(job.sizes[0], "coefficient", "coefficients"),
            number(100.0 * error)
        );
    }
    if let MeshWavelets::Faces(_) = job.basis {
        let origin = if job.is_of_faces { "a field of the file" } else { "means of their corners" };
        text += &format!("\nvalues of the faces: {origin}\n");
    }
    text += &format!("{}", args.output.display());
    let json = json!({
        "shape": job.input.name,
        "output": args.output.display().to_string(),
        "field": name,
        "basis": job.family.name(),
        "elements": many,
        "channels": d,
        "levels": n_levels,
        "sizes": job.sizes,
        "coefficients": counts[1..],
        "norm": squares[1..].iter().map(|square| square.sqrt()).collect::<Vec<f64>>(),
        "kept": n_kept,
        "error": error,
    });
    print(global, &text, &json)
}
