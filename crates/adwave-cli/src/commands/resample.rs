//! `adwave resample`: values carried between registered spheres, of one hemisphere or of both.

use crate::args::{file_name, parse_named};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_progress;
use crate::output::values_file::ValuesFile;
use crate::output::{check_writable, count, note, number, print, write_file_with};
use crate::resolve::shape::{Input, ShapeSource, load_source};
use crate::resolve::signal::{Signal, load_signal};
use adwave::shape::Shape;
use adwave_io::{BrainLayout, CiftiPart, Field, FieldValues, labels_of_field, write_cifti_parts};
use adwave_register::{Keep, Resampled, Sphere, SphereError, SphereResampler, Zeros};
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "\
VALUES are signals of the sphere FROM: files (GIFTI, CIFTI, FreeSurfer's curv, annot, label and MGH,
NPY, CSV), one for each hemisphere, or one CIFTI for both. Give --from and --to once for each
hemisphere, in the order of the values; the two spheres of a hemisphere must be in register.
OUT is a file for each hemisphere (.gii, .npy, .csv, .annot, .dscalar.nii, .dtseries.nii, .dlabel.nii),
or one CIFTI for both. Labels keep their names and colors in .gii, .annot and .dlabel.nii.

Weights are barycentric both ways and corrected by area, as Connectome Workbench's ADAP_BARY_AREA.
NaN is no value. One connected piece of exact zeros is taken as the medial wall of a field, and does
not bleed into the rest.

Examples:
  adwave resample lh.thickness --from lh.sphere.reg --to L.sphere.surf.gii -o L.thick.shape.gii
  adwave resample lh.yeo7.annot --from lh.sphere.reg --to L.sphere.surf.gii -o L.yeo7.label.gii
  adwave resample lh.area --from lh.sphere.reg --to L.sphere.surf.gii -o L.area.gii --keep sum
  adwave resample lh.thickness rh.thickness --from lh.sphere.reg --from rh.sphere.reg \\
    --to L.sphere.surf.gii --to R.sphere.surf.gii -o thickness.dscalar.nii")]
pub(crate) struct ResampleArgs {
    /// Signals of the spheres, one for each hemisphere or one CIFTI for both
    #[arg(value_name = "VALUES", required = true)]
    pub(crate) values: Vec<String>,
    /// Sphere of the values; once for each hemisphere
    #[arg(long, value_name = "FROM", required = true, value_parser = file_name())]
    pub(crate) from: Vec<String>,
    /// Sphere of the result, in register with FROM; once for each hemisphere
    #[arg(long, value_name = "TO", required = true, value_parser = file_name())]
    pub(crate) to: Vec<String>,
    /// File for the result; once for each hemisphere, or one CIFTI for both
    #[arg(long, short, value_name = "OUT", required = true)]
    pub(crate) output: Vec<PathBuf>,
    /// Quantity that is kept: mean (constants), sum (of the values), integral (of value × area) or labels
    /// [default: labels for files of labels, else mean]
    #[arg(long, value_name = "WHAT", value_parser = parse_named::<Keep>())]
    pub(crate) keep: Option<Keep>,
    /// Surface with the vertices of FROM whose areas count, such as the midthickness; once for each hemisphere
    /// [default: FROM]
    #[arg(long, value_name = "SURFACE", value_parser = file_name())]
    pub(crate) from_areas: Vec<String>,
    /// Surface with the vertices of TO whose areas count; once for each hemisphere [default: TO]
    #[arg(long, value_name = "SURFACE", value_parser = file_name())]
    pub(crate) to_areas: Vec<String>,
    /// Signal of TO that is not 0 where the result has values, such as lh.cortex.label; once for each hemisphere
    #[arg(long, value_name = "MASK")]
    pub(crate) to_mask: Vec<String>,
    /// Meaning of one connected piece of exact zeros in a field: wall or values
    #[arg(long, value_name = "WHAT", value_parser = parse_named::<Zeros>(), default_value_t)]
    pub(crate) zeros: Zeros,
}

/// Values of one hemisphere on both spheres.
struct Hemisphere {
    values: String,
    signal: Signal,
    keep: Keep,
    from: Input,
    to: Input,
    found: Resampled,
    /// Areas of both spheres.
    areas: [Vec<f64>; 2],
}

pub(crate) fn run(args: &ResampleArgs, global: &Global<'_>) -> Result<(), CliError> {
    check_counts(args)?;
    args.output.iter().try_for_each(|path| check_writable(path))?;
    if let Some(keep) = args.keep.filter(|keep| *keep != Keep::Mean) {
        global.given.refuse(&["--zeros"], &format!("applies to --keep mean, and --keep is {keep}"))?;
    }
    let hemispheres =
        (0..args.from.len()).map(|k| resample(args, k, global)).collect::<Result<Vec<_>, _>>()?;
    for hemisphere in &hemispheres {
        note_assumptions(hemisphere, global);
    }
    match &args.output[..] {
        [path] if hemispheres.len() > 1 => write_both(path, &hemispheres, global)?,
        paths => {
            for (path, hemisphere) in paths.iter().zip(&hemispheres) {
                write_one(path, hemisphere, global)?;
            }
        }
    }
    let text: String = hemispheres.iter().map(describe).collect();
    let report: Vec<Value> = hemispheres.iter().map(report).collect();
    let outputs: Vec<String> = args.output.iter().map(|path| path.display().to_string()).collect();
    let output = if let [one] = &outputs[..] { json!(one) } else { json!(outputs) };
    print(global, &text, &json!({"hemispheres": report, "output": output}))
}

/// Refuses lists of other lengths than the number of hemispheres.
fn check_counts(args: &ResampleArgs) -> Result<(), CliError> {
    let n = args.from.len();
    let wrong = |option: &str, found: usize| {
        let times = count(n, "time", "times");
        Err(CliError::Input(format!("{option} must be given {times}, as often as --from, got {found}")))
    };
    let lists = [("--from-areas", args.from_areas.len()), ("--to-areas", args.to_areas.len())];
    let masks = [("--to-mask", args.to_mask.len())];
    if args.to.len() != n {
        return wrong("--to", args.to.len());
    }
    for (option, found) in lists.into_iter().chain(masks) {
        if found != 0 && found != n {
            return wrong(option, found);
        }
    }
    if args.values.len() != n && args.values.len() != 1 {
        return wrong("VALUES", args.values.len());
    }
    let is_one_cifti = matches!(&args.output[..], [path] if ValuesFile::is_cifti(path));
    if args.output.len() != n && !is_one_cifti {
        return Err(CliError::Input(format!(
            "-o must name a file for each of the {n} hemispheres, or one .dscalar.nii, .dtseries.nii or .dlabel.nii, got \
             {}",
            count(args.output.len(), "file", "files")
        )));
    }
    for path in &args.output {
        if !matches!(
            ValuesFile::from_path(path),
            Some(
                ValuesFile::Npy
                    | ValuesFile::Csv
                    | ValuesFile::Gifti
                    | ValuesFile::Cifti(_)
                    | ValuesFile::Annotation
            )
        ) {
            return Err(CliError::Input(format!(
                "{}: values are written as .npy, .csv, .gii, .dscalar.nii or .dtseries.nii, labels also as .annot or \
                 .dlabel.nii",
                path.display()
            )));
        }
    }
    Ok(())
}

/// Carries the values of hemisphere k.
fn resample(args: &ResampleArgs, k: usize, global: &Global<'_>) -> Result<Hemisphere, CliError> {
    let values = args.values.get(k).unwrap_or(&args.values[0]);
    let from = load_source(&ShapeSource::new(&args.from[k]), global)?;
    let to = load_source(&ShapeSource::new(&args.to[k]), global)?;
    if let (Some(one), Some(other)) = (from.file.structure(), to.file.structure())
        && !BrainLayout::is_same_structure(one, other)
    {
        return Err(CliError::Input(format!(
            "--from and --to must be of one hemisphere, and {} is of {one}, {} of {other}; give them in the same order",
            from.name, to.name
        )));
    }
    let signal = load_signal(global, &from, values, None)?;
    let keep = args.keep.unwrap_or_else(|| usual_keep(values, &signal));
    let first = sphere(&from, args.from_areas.get(k), global)?;
    let second = sphere(&to, args.to_areas.get(k), global)?;
    let mask = args.to_mask.get(k).map(|name| load_signal(global, &to, name, None)).transpose()?;
    let kept: Option<Vec<bool>> = mask.map(|mask| {
        let is_kept = |row: &[f64]| row.iter().any(|v| *v != 0.0 && !v.is_nan());
        mask.values.chunks_exact(mask.n_channels).map(is_kept).collect()
    });
    let found = with_progress(global, "resampling", |progress| {
        SphereResampler::new(&first, &second, kept.as_deref(), progress)?.apply(
            &signal.values,
            signal.n_channels,
            keep,
            args.zeros,
            progress,
        )
    });
    let found = found.map_err(|e| in_words(&from.name, &e))?;
    let areas = [first.areas().to_vec(), second.areas().to_vec()];
    Ok(Hemisphere { values: values.clone(), signal, keep, from, to, found, areas })
}

/// Labels for files of labels, else means.
fn usual_keep(name: &str, signal: &Signal) -> Keep {
    let has_names = !signal.labels.is_empty() && signal.labels.iter().all(Option::is_some);
    let is_label = has_names || labels_of_field(name, signal.n_channels, &signal.values).is_some();
    if is_label { Keep::Labels } else { Keep::Mean }
}

fn in_words(name: &str, error: &SphereError) -> CliError {
    match error {
        SphereError::Cancelled(_) => CliError::Cancelled,
        _ => CliError::Input(format!("{name}: {error}")),
    }
}

/// Sphere of an input, with the areas of another surface if there is one.
fn sphere(input: &Input, areas: Option<&String>, global: &Global<'_>) -> Result<Sphere, CliError> {
    let Shape::Mesh(mesh) = &input.shape else {
        return Err(CliError::Input(format!(
            "{} must be a sphere of triangles, and it is a {}; give a file such as lh.sphere.reg",
            input.name,
            input.kind_name()
        )));
    };
    let Some(triangles) = mesh.faces().triangles() else {
        return Err(CliError::Input(format!("{} must have triangles only; cut its other faces", input.name)));
    };
    let own = Sphere::new(mesh.points(), triangles).map_err(|e| in_words(&input.name, &e))?;
    for remark in own.remarks() {
        note(global, &format!("{}: {remark}", input.name));
    }
    let Some(areas) = areas else { return Ok(own) };
    let surface = load_source(&ShapeSource::new(areas), global)?;
    own.with_surface(surface.shape.points().unwrap_or_default()).map_err(|e| in_words(&surface.name, &e))
}

/// Says what was assumed about the values, before a file is written.
fn note_assumptions(hemisphere: &Hemisphere, global: &Global<'_>) {
    let (found, n) = (&hemisphere.found, hemisphere.areas[0].len());
    if found.n_wall > 0 {
        let share = format!("{:.1}", 100.0 * found.n_wall as f64 / n as f64);
        note(
            global,
            &format!(
                "{}: {} vertices ({share} %) that are exactly 0 and connected are taken as the medial wall, which has \
                 no values; --zeros values averages them too",
                hemisphere.values, found.n_wall
            ),
        );
    } else if found.n_missing > 0 {
        let n_targets = hemisphere.areas[1].len();
        note(
            global,
            &format!("{}: {} of {n_targets} vertices have no value", hemisphere.values, found.n_missing),
        );
    }
}

impl Hemisphere {
    /// The result as fields: a field for each named column.
    fn fields(&self) -> Vec<Field> {
        let n = self.signal.n_channels;
        let values = &self.found.values;
        let whole = |values: &[f64]| -> FieldValues {
            let is_int = |v: &f64| v.fract() == 0.0 && f64::from(i32::MIN) <= *v && *v <= f64::from(i32::MAX);
            if self.keep == Keep::Labels && values.iter().all(is_int) {
                FieldValues::I32(values.iter().map(|v| *v as i32).collect())
            } else {
                FieldValues::F64(values.to_vec())
            }
        };
        if n > 1 && self.signal.channel_names.len() == n {
            let column = |c: usize| values.iter().skip(c).step_by(n).copied().collect::<Vec<f64>>();
            let names = self.signal.channel_names.iter().enumerate();
            let of_channel = |c: usize| self.signal.labels.get(c).cloned().flatten();
            let labels = |c: usize| of_channel(c).filter(|_| self.keep == Keep::Labels);
            return names
                .map(|(c, name)| Field::new(name.clone(), 1, whole(&column(c))).with_labels(labels(c)))
                .collect();
        }
        let name = crate::inputs::last_component(&self.values);
        let name = name.rsplit(':').next().unwrap_or(name);
        let name = match name.split_once('.') {
            Some((before @ ("lh" | "rh"), after)) => {
                format!("{before}.{}", after.split('.').next().unwrap_or(after))
            }
            Some((before, _)) if !before.is_empty() => before.to_owned(),
            _ => name.to_owned(),
        };
        let labels = self.signal.shared_labels().filter(|_| self.keep == Keep::Labels);
        vec![Field::new(name, n, whole(values)).with_frame_step(self.signal.frame_step).with_labels(labels)]
    }

    /// The quantity that is kept, before and after: the mean by area, the sum, the integral, or the number of labels.
    fn measure_kept(&self) -> [f64; 2] {
        let n = self.signal.n_channels;
        [(&self.signal.values[..], &self.areas[0]), (&self.found.values[..], &self.areas[1])].map(
            |(values, areas)| {
                let known = || values.iter().enumerate().filter(|(_, v)| !v.is_nan());
                match self.keep {
                    Keep::Sum => known().map(|(_, v)| v).sum(),
                    Keep::Integral => known().map(|(i, v)| v * areas[i / n]).sum(),
                    Keep::Labels => {
                        adwave_io::distinct_labels(values).map_or(f64::NAN, |labels| labels.len() as f64)
                    }
                    Keep::Mean => {
                        let total: f64 = known().map(|(i, _)| areas[i / n]).sum();
                        known().map(|(i, v)| v * areas[i / n]).sum::<f64>() / total
                    }
                }
            },
        )
    }
}

fn quantity(keep: Keep) -> &'static str {
    match keep {
        Keep::Mean => "mean by area",
        Keep::Sum => "sum",
        Keep::Integral => "sum of value × area",
        Keep::Labels => "labels",
    }
}

fn describe(hemisphere: &Hemisphere) -> String {
    let [before, after] = hemisphere.measure_kept().map(number);
    format!(
        "{}: {} → {} vertices, {} {before} → {after}\n",
        hemisphere.values,
        hemisphere.areas[0].len(),
        hemisphere.areas[1].len(),
        quantity(hemisphere.keep)
    )
}

fn report(hemisphere: &Hemisphere) -> Value {
    let [before, after] = hemisphere.measure_kept();
    json!({
        "values": hemisphere.values,
        "from": hemisphere.from.name,
        "to": hemisphere.to.name,
        "from_vertices": hemisphere.areas[0].len(),
        "to_vertices": hemisphere.areas[1].len(),
        "keep": hemisphere.keep.name(),
        "kept_before": before,
        "kept_after": after,
        "wall_vertices": hemisphere.found.n_wall,
        "missing_vertices": hemisphere.found.n_missing,
    })
}

fn write_one(path: &Path, hemisphere: &Hemisphere, global: &Global<'_>) -> Result<(), CliError> {
    let Some(kind) = ValuesFile::from_path(path) else { return Ok(()) };
    // A sphere that does not state its hemisphere has that of the other one.
    let stated =
        [&hemisphere.to, &hemisphere.from].into_iter().find(|input| input.file.structure().is_some());
    if let (ValuesFile::Gifti, Some(input)) = (kind, stated) {
        let fields = hemisphere.fields();
        let structure = input.file.structure();
        return write_file_with(global, path, |path| adwave_io::write_gifti_fields(path, &fields, structure));
    }
    if let ValuesFile::Cifti(_) = kind {
        return write_both(path, std::slice::from_ref(hemisphere), global);
    }
    kind.write(global, path, &hemisphere.fields(), &hemisphere.to.file)
}

/// Writes all hemispheres as one CIFTI.
fn write_both(path: &Path, hemispheres: &[Hemisphere], global: &Global<'_>) -> Result<(), CliError> {
    let Some(ValuesFile::Cifti(columns)) = ValuesFile::from_path(path) else { return Ok(()) };
    let mut parts = Vec::new();
    for hemisphere in hemispheres {
        let stated = [&hemisphere.to, &hemisphere.from].into_iter().find_map(|input| input.file.structure());
        let Some(structure) = stated else {
            return Err(CliError::Input(format!(
                "{}: a CIFTI names the structure of each surface, and neither {} nor {} states it; use a GIFTI that \
                 does (AnatomicalStructurePrimary), or name the file with lh. or rh. at the beginning",
                path.display(),
                hemisphere.to.name,
                hemisphere.from.name
            )));
        };
        parts.push((structure, hemisphere.fields()));
    }
    for (k, (structure, _)) in parts.iter().enumerate() {
        if parts[..k].iter().any(|(other, _)| BrainLayout::is_same_structure(structure, other)) {
            return Err(CliError::Input(format!(
                "{}: a CIFTI has each structure once, and two spheres are of {structure}; give one of each hemisphere",
                path.display()
            )));
        }
    }
    let parts: Vec<CiftiPart<'_>> =
        parts.iter().map(|(structure, fields)| CiftiPart { structure, fields }).collect();
    write_file_with(global, path, |path| write_cifti_parts(path, &parts, columns))
}
