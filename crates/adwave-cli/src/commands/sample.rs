//! `adwave sample`: a built-in shape as a file.

use super::terrain;
use crate::args::{count as parse_count, number, seed};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_spinner;
use crate::output::{check_writable, count, output_format, print, table, write_shape};
use crate::resolve::shape::{SampleSize, make_sample, row_words};
use adwave::sample::{GRID_SAMPLE_NAMES, SAMPLE_NAMES, SampleInfo};
use adwave_io::ShapeFile;
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  adwave sample                                 list the shapes
  adwave sample creature -o creature.ply
  adwave sample knot --vertices 200000 --noise 0.3 --seed 7 -o noisy.obj
  adwave sample sphere --as cloud -o points.ply
  adwave sample hills -o hills.tif              an image; 'head' is a volume, 'bold' a series
  adwave sample terrain --points 1e8 -o scan     a folder of LAZ files")]
pub(crate) struct SampleArgs {
    /// Name of the shape; without it the shapes are listed
    pub(crate) name: Option<String>,
    /// File for the shape; its extension names the format
    #[arg(long, short, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    /// Approximate number of vertices
    #[arg(long, value_name = "N", value_parser = parse_count)]
    pub(crate) vertices: Option<usize>,
    /// Write a mesh, or only its vertices as a cloud
    #[arg(long = "as", value_name = "KIND", value_enum)]
    pub(crate) kind: Option<SampleKind>,
    /// Noise along the normals, its standard deviation in mean edge lengths; of an image or a volume, noise of the
    /// values in multiples of their standard deviation
    #[arg(long, value_name = "S", value_parser = number)]
    pub(crate) noise: Option<f64>,
    /// Seed of the noise
    #[arg(long, value_name = "K", value_parser = seed, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Number of points of a terrain, such as 1e8
    #[arg(long, value_name = "N", value_parser = terrain::parse_points)]
    pub(crate) points: Option<u64>,
}

/// Kind of shape that a sample is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SampleKind {
    Mesh,
    Cloud,
}

pub(crate) fn run(args: &SampleArgs, global: &Global<'_>) -> Result<(), CliError> {
    let Some(name) = &args.name else {
        let options = ["--output", "--vertices", "--as", "--noise", "--seed", "--points"];
        global.given.refuse(&options, "applies to a sample, and none is named")?;
        return list(global);
    };
    if name != terrain::NAME && !all_samples().any(|sample| sample.name == name) {
        // The error names the samples.
        make_sample(name, &SampleSize::default())?;
    }
    let Some(output) = &args.output else {
        let ending = if name == terrain::NAME { "laz" } else { "ply" };
        return Err(CliError::Input(format!("a file for the {name} is missing; add -o {name}.{ending}")));
    };
    if name == terrain::NAME {
        let given = [
            ("--vertices", args.vertices.is_some()),
            ("--noise", args.noise.is_some()),
            ("--as", args.kind.is_some()),
        ];
        if let Some((flag, _)) = given.iter().find(|(_, is_given)| *is_given) {
            return Err(CliError::Input(format!(
                "{flag} applies to the other samples; a terrain has --points"
            )));
        }
        return terrain::write(global, args.points.unwrap_or(terrain::DEFAULT_POINTS), args.seed, output);
    }
    if args.points.is_some() {
        return Err(CliError::Input(format!("--points applies to the terrain; a {name} has --vertices")));
    }
    output_format(output)?;
    check_writable(output)?;
    let size = SampleSize { n_vertices: args.vertices, noise: args.noise, seed: args.seed };
    if GRID_SAMPLE_NAMES.iter().any(|sample| sample.name == name) {
        global.given.refuse(&["--as"], &format!("applies to shapes, and {name} is an image or a volume"))?;
    }
    let mut file = with_spinner(global, "shaping", || make_sample(name, &size))?;
    match args.kind {
        None | Some(SampleKind::Mesh) => {}
        Some(SampleKind::Cloud) => file = ShapeFile::from_cloud(file.points().to_vec()),
    }
    write_shape(global, &file, output)?;
    let (n_vertices, n_faces) = (file.n_vertices(), file.faces().len());
    print(
        global,
        &format!("{name}: {}\n{}\n", describe(&file), output.display()),
        &json!({
            "sample": name,
            row_words(&file)[1]: n_vertices,
            "faces": n_faces,
            "output": output.display().to_string(),
        }),
    )
}

/// The size of a sample: `100 vertices, 196 faces`, or `image, 256 × 256`.
fn describe(file: &ShapeFile) -> String {
    match file.grid() {
        Some(grid) => {
            let kind = if grid.sizes.len() == 2 { "image" } else { "volume" };
            let sizes: Vec<String> = grid.sizes.iter().map(usize::to_string).collect();
            let frames = match file.vertex_fields().first().map(|field| (field.n_channels, field.frame_step))
            {
                Some((n_frames, Some(step))) => format!(", {n_frames} frames, one every {step} s"),
                _ => String::new(),
            };
            format!("{kind}, {}{frames}", sizes.join(" × "))
        }
        None => format!(
            "{}, {}",
            count(file.n_vertices(), "vertex", "vertices"),
            count(file.faces().len(), "face", "faces")
        ),
    }
}

/// All samples but the terrain.
fn all_samples() -> impl Iterator<Item = &'static SampleInfo> {
    SAMPLE_NAMES.iter().chain(&GRID_SAMPLE_NAMES)
}

fn list(global: &Global<'_>) -> Result<(), CliError> {
    let text = table(
        ["sample", "vertices", "description"],
        all_samples()
            .map(|s| [s.name.to_owned(), s.default_vertices.to_string(), s.description.to_owned()])
            .chain([[terrain::NAME, &terrain::DEFAULT_POINTS.to_string(), terrain::DESCRIPTION]
                .map(str::to_owned)]),
    );
    let json = all_samples()
        .map(
            |s| json!({"name": s.name, "description": s.description, "default_vertices": s.default_vertices}),
        )
        .chain([json!({
            "name": terrain::NAME,
            "description": terrain::DESCRIPTION,
            "default_points": terrain::DEFAULT_POINTS,
        })])
        .collect();
    print(global, &text, &json)
}
