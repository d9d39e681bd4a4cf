//! `adwave demo`: a tour of the method on a built-in creature.

use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::{
    make_folder, number, print, steps_json, steps_text, table, write_file, write_file_with, write_shape,
};
use crate::resolve::shape::{SampleSize, make_sample};
use adwave::bands::{Bands, Schedule};
use adwave::filter::{Edit, Gains, Layer, Preset, displacement};
use adwave::region::{Length, Region};
use adwave::shape::{Mesh, Shape, bounding_box, enclosed_volume};
use adwave::{Decomposer, LevelSpec};
use adwave_io::{Field, FieldValues, Recipe, ShapeFile, write_recipe};
use adwave_report::demo::{DemoEdit, DemoText, PICTURES, demo};
use adwave_report::page::Link;
use adwave_report::shape_report::{COORDS, Subject};
use adwave_report::{Table, column};
use clap::Args;
use serde_json::{Value, json};
use std::path::Path;
use std::path::PathBuf;
use std::time::Instant;

#[derive(Debug, Args)]
pub(crate) struct DemoArgs {
    /// Folder for the files
    #[arg(long, short, value_name = "DIR", default_value = "adwave-demo")]
    pub(crate) output: PathBuf,
    /// Approximate number of vertices of the creature
    #[arg(long, value_name = "N", value_parser = crate::args::count)]
    pub(crate) vertices: Option<usize>,
}

pub(crate) fn run(args: &DemoArgs, global: &Global<'_>) -> Result<(), CliError> {
    make_folder(&args.output)?;
    let at = |name: &str| args.output.join(name);
    let size = SampleSize { n_vertices: args.vertices, ..SampleSize::default() };
    let file = with_spinner(global, "shaping the creature", || make_sample("creature", &size))?;
    let shape =
        Shape::Mesh(Mesh::new(file.points().to_vec(), file.faces().clone()).map_err(CliError::input)?);

    let start = Instant::now();
    let decomposer = Decomposer::new(&shape);
    let diffusion_ms = start.elapsed().as_secs_f64() * 1e3;
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
    let mut editor = with_progress(global, "preparing to edit", |p| {
        decomposer.request(coords, 3, &schedule).progress(p).editor()
    })?;
    let (mut edits, mut shown) = (Vec::new(), Vec::new());
    for (name, layer) in demo_edits(&file) {
        let start = Instant::now();
        let edit = Edit::new(std::slice::from_ref(&layer));
        editor.set_edit(&edit)?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let points: Vec<[f64; 3]> = editor.edited().as_chunks().0.to_vec();
        let moved = displacement(file.points(), &points);
        let after = enclosed_volume(&points, &decomposer_triangles(&file));
        let mut out = file.clone();
        out.set_points(points.clone())?;
        write_shape(global, &out, &at(&format!("{name}.ply")))?;
        if name == LOCAL_EDIT {
            let recipe =
                Recipe { levels: LevelSpec::Dyadic(n_levels), layers: vec![layer], ..Recipe::default() };
            write_file_with(global, &at("local-edit.toml"), |path| write_recipe(path, &recipe))?;
        }
        edits.push((name, moved.rms, moved.max, 100.0 * (after - volume) / volume, ms));
        shown.push(DemoEdit {
            name,
            words: if name == LOCAL_EDIT { "is `suppress` on one half only, with a soft seam" } else { "" },
            points,
            rms_percent: 100.0 * moved.rms / decomposer.extent(),
        });
    }
    let subject = Subject {
        name: "creature",
        format: "built-in",
        fields: &[],
        shape: &shape,
        grid: None,
        decomposer: &decomposer,
        signal: COORDS,
        values: coords,
        normals: None,
        bands: &bands,
        levels_reason: &why,
        command: "adwave demo",
        seconds: &[],
    };
    let text = page_text(args, &file, &decomposer, &bands, &edits);
    let page = with_progress(global, "drawing", |progress| demo(&subject, &shown, text, progress))?;
    let pictures = [&page.sheet, &page.saliency, &page.features];
    for (name, picture) in PICTURES.iter().zip(pictures) {
        let png = picture.png()?;
        write_file(global, &at(name), &png)?;
    }
    let index = at("index.html");
    let html = page.page.html();
    write_file(global, &index, html.as_bytes())?;

    let text = report(args, &file, &decomposer, &bands, &energy, &level_ms, diffusion_ms, &why, &edits);
    let json = json!({
        "output": args.output.display().to_string(),
        "index": index.display().to_string(),
        "vertices": bands.n_vertices,
        "levels": n_levels,
        "levels_reason": why,
        "steps": steps_json(&bands.steps),
        "sigma": bands.sigma,
        "energy": energy,
        "milliseconds": {"diffusion": diffusion_ms, "levels": level_ms},
        "edits": edits.iter().map(|&(name, rms, max, volume_percent, ms)| json!({
            "name": name, "rms": rms, "max": max, "volume_change_percent": volume_percent, "milliseconds": ms,
        })).collect::<Vec<Value>>(),
    });
    print(global, &text, &json)
}

const LOCAL_EDIT: &str = "local-edit";

/// The presets everywhere, and one of them on a part: one half smooth, the seam between them soft.
fn demo_edits(file: &ShapeFile) -> Vec<(&'static str, Layer)> {
    let mut edits: Vec<_> = Preset::ALL
        .iter()
        .map(|&preset| (preset.name(), Layer { gains: Gains::Preset(preset), region: Region::Everywhere {} }))
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

/// Milliseconds to compute the levels 1 … n, for each n.
fn level_times(decomposer: &Decomposer, coords: &[f64], schedule: &Schedule) -> Result<Vec<f64>, CliError> {
    let mut times = (1..=schedule.n_levels())
        .map(|n| {
            let start = Instant::now();
            let schedule = Schedule::dyadic(n)?;
            decomposer.decompose(coords, 3, &schedule)?;
            Ok(start.elapsed().as_secs_f64() * 1e3)
        })
        .collect::<Result<Vec<f64>, CliError>>()?;
    // A run to a higher level passes the lower ones, so its time bounds theirs when the machine was busy.
    for n in (1..times.len()).rev() {
        times[n - 1] = times[n - 1].min(times[n]);
    }
    Ok(times)
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
    diffusion_ms: f64,
    why: &str,
    edits: &[(&str, f64, f64, f64, f64)],
) -> String {
    let diagonal = decomposer.extent();
    let mut text = format!(
        "A creature of {} vertices and {} faces, its diffusion operator built in {diffusion_ms:.1} ms, split into {} bands\n({why}):\n\n",
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
    text += &format!("\n{} edits of these bands:\n\n", edits.len());
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
        "\n{dir}/creature.ply, suppress.ply … local-edit.ply are for any mesh viewer, {dir}/bands.vtp with W1 … W{} for\n\
         ParaView. Next, on a shape of your own:\n",
        bands.n_levels(),
    );
    for (command, _) in next_commands(args) {
        text += &format!("  {command}\n");
    }
    text += &format!("\nThe same in pictures: {}\n", args.output.join("index.html").display());
    text
}

/// Commands to try next, with their purposes.
fn next_commands(args: &DemoArgs) -> [(String, &'static str); 5] {
    let recipe = args.output.join("local-edit.toml");
    [
        ("adwave report SHAPE -o report.html".to_owned(), "one page about it"),
        ("adwave info SHAPE".to_owned(), "its contents, and the levels it gets"),
        ("adwave transform SHAPE -o bands.npz".to_owned(), "its bands, for numpy"),
        ("adwave filter SHAPE -o crisp.ply --preset enhance".to_owned(), "one of the five presets"),
        (
            format!("adwave filter SHAPE -o edit.ply --recipe {}", recipe.display()),
            "the local edit of this page",
        ),
    ]
}

/// The tables of the page, and its links.
fn page_text(
    args: &DemoArgs,
    file: &ShapeFile,
    decomposer: &Decomposer,
    bands: &Bands,
    edits: &[(&str, f64, f64, f64, f64)],
) -> DemoText {
    let diagonal = decomposer.extent();
    let energy = bands.energy(&decomposer.areas()).expect("one area per vertex");
    let mut levels = Table::new(
        "bands.csv",
        "The bands: steps of averaging, width, and how much each holds.",
        &["level j", "steps n_j", "σ_j, model units", "σ_j, % of the diagonal", "rms of W_j, model units"],
    );
    let widths: Vec<f64> = bands.sigma[1..].to_vec();
    let columns = [
        column(&widths),
        column(&widths.iter().map(|s| 100.0 * s / diagonal).collect::<Vec<_>>()),
        column(&energy.iter().map(|e| e.sqrt()).collect::<Vec<_>>()),
    ];
    for j in 1..=bands.n_levels() {
        let [sigma, percent, rms] = columns.each_ref().map(|c| c[j - 1].clone());
        levels.push([j.to_string(), steps_text(bands.steps[j]), sigma, percent, rms]);
    }
    let mut table = Table::new(
        "edits.csv",
        "Effect of each edit.",
        &["edit", "moved (rms), % of the diagonal", "moved at most, % of the diagonal", "volume, %", "ms"],
    );
    for &(name, rms, max, volume, ms) in edits {
        table.push([
            name.to_owned(),
            format!("{:.3}", 100.0 * rms / diagonal),
            format!("{:.3}", 100.0 * max / diagonal),
            format!("{volume:+.2}").replace('-', "−"),
            format!("{ms:.1}"),
        ]);
    }
    let link = |path: &str, text: String| Link { path: path.to_owned(), text };
    let mut files =
        vec![link("creature.ply", format!("creature.ply: the mesh, {} vertices", file.n_vertices()))];
    for &(name, ..) in edits {
        files.push(link(&format!("{name}.ply"), format!("{name}.ply: after {name}")));
    }
    files.push(link("local-edit.toml", "local-edit.toml: the local edit as a recipe".to_owned()));
    let all = format!("bands.vtp: the mesh with its bands W1 … W{}, for ParaView", bands.n_levels());
    files.push(link("bands.vtp", all));
    for (name, what) in PICTURES.iter().zip(["before and after", "the saliency map", "the features"]) {
        files.push(link(name, format!("{name}: {what}")));
    }
    let next = next_commands(args).map(|(command, what)| (command, what.to_owned()));
    DemoText { bands: levels, edits: table, files, next: next.into() }
}
