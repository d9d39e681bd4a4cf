//! `adwave demo`: all of it on a built-in creature, in seconds.

use crate::error::CliError;
use crate::global::Global;
use crate::output::{number, print, steps_json, steps_text, table, write_shape};
use crate::progress::{with_progress, with_spinner};
use crate::shape_input::make_sample;
use adwave::Decomposer;
use adwave::bands::{Bands, Schedule};
use adwave::filter::{Edit, Gains, Layer, Preset, displacement};
use adwave::region::{Length, Region};
use adwave::shape::{Mesh, Shape, bounding_box, enclosed_volume};
use adwave_io::{Field, FieldValues, Levels, Recipe, ShapeFile, write_recipe};
use clap::Args;
use serde_json::{Value, json};
use std::path::Path;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder that the files go to
    #[arg(long, short, value_name = "DIR", default_value = "adwave-demo")]
    pub(crate) output: PathBuf,
    /// Number of vertices of the creature (about)
    #[arg(long, value_name = "N")]
    pub(crate) vertices: Option<usize>,
}

pub(crate) fn run(args: &DemoArgs, global: &Global<'_>) -> Result<(), CliError> {
    std::fs::create_dir_all(&args.output).map_err(|e| {
        CliError::Environment(format!("cannot make the folder {}: {e}", args.output.display()))
    })?;
    let at = |name: &str| args.output.join(name);
    let file =
        with_spinner(global, "shaping the creature", || make_sample("creature", args.vertices, None, 1))?;
    let shape =
        Shape::Mesh(Mesh::new(file.points().to_vec(), file.faces().clone()).map_err(CliError::input)?);

    let start = Instant::now();
    let decomposer = Decomposer::new(&shape);
    let walk_ms = start.elapsed().as_secs_f64() * 1e3;
    let (n_levels, why) = decomposer.default_levels();
    let schedule = Schedule::dyadic(n_levels)?;
    let coords = file.points().as_flattened();
    let bands =
        with_progress(global, "splitting", |p| decomposer.request(coords, 3, &schedule).progress(p).bands())?;
    let level_ms = level_times(&decomposer, coords, &schedule)?;
    let energy = bands.energy(&decomposer.areas())?;

    write_shape(global, &file, &at("creature.ply"))?;
    write_bands(global, &file, &bands, &at("bands.vtp"))?;
    let volume = enclosed_volume(file.points(), &decomposer_triangles(&file));
    let mut edits = Vec::new();
    for (name, layer) in edits_of(&file) {
        let start = Instant::now();
        let edit = Edit::new(std::slice::from_ref(&layer));
        let edited = with_progress(global, name, |p| {
            decomposer.request(coords, 3, &schedule).progress(p).filter(&edit)
        })?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let points: Vec<[f64; 3]> = edited.as_chunks().0.to_vec();
        let moved = displacement(file.points(), &points);
        let after = enclosed_volume(&points, &decomposer_triangles(&file));
        let mut out = file.clone();
        out.set_points(points)?;
        write_shape(global, &out, &at(&format!("{name}.ply")))?;
        if name == LOCAL_EDIT {
            let recipe =
                Recipe { field: "coords".to_owned(), levels: Levels::Dyadic(n_levels), layers: vec![layer] };
            write_recipe(&at("local-edit.toml"), &recipe).map_err(CliError::input)?;
        }
        edits.push((name, moved.rms, moved.max, 100.0 * (after - volume) / volume, ms));
    }

    let text = report(args, &file, &decomposer, &bands, &energy, &level_ms, walk_ms, &why, &edits);
    let json = json!({
        "output": args.output.display().to_string(),
        "vertices": bands.n_vertices,
        "levels": n_levels,
        "levels_reason": why,
        "steps": steps_json(&bands.steps),
        "sigma": bands.sigma,
        "energy": energy,
        "milliseconds": {"walk": walk_ms, "levels": level_ms},
        "edits": edits.iter().map(|&(name, rms, max, volume_percent, ms)| json!({
            "name": name, "rms": rms, "max": max, "volume_change_percent": volume_percent, "milliseconds": ms,
        })).collect::<Vec<Value>>(),
    });
    print(global, &text, &json)
}

const LOCAL_EDIT: &str = "local-edit";

/// The presets everywhere, and one of them on a part: one half smooth, the seam between them soft.
fn edits_of(file: &ShapeFile) -> Vec<(&'static str, Layer)> {
    let mut edits: Vec<_> = Preset::ALL
        .iter()
        .map(|&(name, preset)| (name, Layer { gains: Gains::Preset(preset), region: Region::Everywhere {} }))
        .collect();
    let (min, max) = bounding_box(file.points()).expect("the creature has vertices");
    let middle = std::array::from_fn(|c| 0.5 * (min[c] + max[c]));
    let region = Region::HalfSpace {
        point: middle,
        normal: [1.0, 0.0, 0.0],
        falloff: Some(Length::PercentOfDiagonal(5.0)),
    };
    edits.push((LOCAL_EDIT, Layer { gains: Gains::Preset(Preset::Suppress), region }));
    edits
}

fn decomposer_triangles(file: &ShapeFile) -> Vec<[u32; 3]> {
    adwave::shape::triangulate(file.points(), file.faces())
}

/// Milliseconds that all levels up to each take by themselves.
fn level_times(decomposer: &Decomposer, coords: &[f64], schedule: &Schedule) -> Result<Vec<f64>, CliError> {
    (1..=schedule.n_levels())
        .map(|n| {
            let start = Instant::now();
            let schedule = Schedule::dyadic(n)?;
            decomposer.decompose(coords, 3, &schedule)?;
            Ok(start.elapsed().as_secs_f64() * 1e3)
        })
        .collect()
}

fn write_bands(global: &Global<'_>, file: &ShapeFile, bands: &Bands, path: &Path) -> Result<(), CliError> {
    let mut file = file.clone();
    for (j, band) in bands.wavelets().enumerate() {
        file.add_vertex_field(Field::new(format!("W{}", j + 1), 3, FieldValues::F64(band.to_vec())))?;
    }
    write_shape(global, &file, path).map(|_| ())
}

#[expect(clippy::too_many_arguments, reason = "one page of text about everything that was done")]
fn report(
    args: &DemoArgs,
    file: &ShapeFile,
    decomposer: &Decomposer,
    bands: &Bands,
    energy: &[f64],
    level_ms: &[f64],
    walk_ms: f64,
    why: &str,
    edits: &[(&str, f64, f64, f64, f64)],
) -> String {
    let diagonal = decomposer.diagonal();
    let mut text = format!(
        "A creature of {} vertices and {} faces, its walk built in {walk_ms:.1} ms, split into {} bands\n({why}):\n\n",
        file.n_vertices(),
        file.faces().len(),
        bands.n_levels(),
    );
    text += &table(
        ["level", "steps", "sigma", "% of diagonal", "energy of W", "ms up to here"],
        (1..=bands.n_levels()).map(|j| {
            [
                j.to_string(),
                steps_text(bands.steps[j]),
                number(bands.sigma[j]),
                number(100.0 * bands.sigma[j] / diagonal),
                number(energy[j - 1]),
                format!("{:.1}", level_ms[j - 1]),
            ]
        }),
    );
    text += "\nFive edits of these bands:\n\n";
    text += &table(
        ["file", "moved (rms, % of diagonal)", "at most", "volume", "ms"],
        edits.iter().map(|&(name, rms, max, volume, ms)| {
            [
                format!("{name}.ply"),
                number(100.0 * rms / diagonal),
                number(100.0 * max / diagonal),
                format!("{volume:+.3} %"),
                format!("{ms:.1}"),
            ]
        }),
    );
    let dir = args.output.display();
    text += &format!(
        "\nLook at {dir}/creature.ply beside {dir}/suppress.ply, enhance.ply, band1.ply, band2.ply and\n\
         local-edit.ply (one half smoothed) in any mesh viewer; {dir}/bands.vtp holds W1 … W{} for ParaView.\n\n\
         Next, on a shape of your own:\n  \
         adwave report SHAPE -o report.html\n  \
         adwave info SHAPE\n  \
         adwave transform SHAPE -o bands.npz\n  \
         adwave filter SHAPE -o crisp.ply --preset enhance\n  \
         adwave filter SHAPE -o edit.ply --recipe {dir}/local-edit.toml\n",
        bands.n_levels(),
    );
    text
}
