//! Images and volumes: their planes, edits, recipes and saved files.

use crate::client::Studio;
use crate::server::{edit, layer};
use adwave::bands::Schedule;
use adwave::filter::Edit;
use adwave::shape::{Graph, Shape};
use adwave::{Decomposer, LevelSpec};
use adwave_io::{
    Field, FieldValues, GRID_VALUES, GridLayout, ReadLimits, ShapeFile, ValueType, parse_recipe, read_path,
    write_path,
};
use adwave_studio::StudioInput;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SIZES: [usize; 3] = [9, 12, 10];

fn rough(place: usize) -> f32 {
    (place * 7919 % 101) as f32 + 40.0 * (place as f32 / 90.0).sin()
}

fn grid(layout: GridLayout, n_channels: usize, value: impl Fn(usize) -> f32) -> ShapeFile {
    let mut file = ShapeFile::from_grid(layout).unwrap();
    let values = (0..file.n_vertices() * n_channels).map(value).collect();
    file.add_vertex_field(Field::new(GRID_VALUES, n_channels, FieldValues::F32(values))).unwrap();
    file
}

/// Opens an image or a volume like the command does.
fn opened(path: &Path) -> StudioInput {
    let file = read_path(path, &ReadLimits::default()).unwrap();
    let shape = Shape::Graph(Graph::new(file.n_vertices(), &[]).unwrap());
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    StudioInput { name, path: Some(path.to_path_buf()), file, shape }
}

fn volume(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("head.nii.gz");
    write_path(&grid(GridLayout::new(&SIZES, &[3.0, 2.0, 1.5]), 1, rough), &path, None).unwrap();
    path
}

/// Applies a recipe of a grid, like `adwave filter --recipe`.
fn replayed(path: &Path, recipe: &str) -> Vec<f64> {
    let recipe = parse_recipe(recipe).unwrap();
    assert_eq!(recipe.field, GRID_VALUES);
    let file = read_path(path, &ReadLimits::default()).unwrap();
    let places = file.grid().unwrap().to_grid().unwrap();
    let heat = places.heat();
    let decomposer = Decomposer::from_domain(places, heat).unwrap();
    let LevelSpec::Dyadic(n_levels) = recipe.levels else { panic!("{:?}", recipe.levels) };
    let (schedule, values) = (Schedule::dyadic(n_levels).unwrap(), file.field(GRID_VALUES).unwrap());
    let (n_channels, values) = (values.n_channels, values.to_f64());
    let mut editor = decomposer.request(&values, n_channels, &schedule).editor().unwrap();
    editor.set_edit(&Edit::new(&recipe.layers)).unwrap();
    editor.into_edited()
}

fn gains(n_levels: usize) -> Vec<f64> {
    (0..n_levels).map(|j| [0.0, 2.0, 0.5, 1.0][j % 4]).collect()
}

#[test]
fn a_slice_has_the_values_and_bands_that_sum_to_the_edit() {
    let folder = TempDir::new().unwrap();
    let path = volume(&folder);
    let studio = Studio::of(opened(&path), folder.path());
    let list = studio.get("/api/shapes").json();
    assert_eq!(list["shapes"][0]["domain"], "grid");
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["kind"], &info["grid"]["sizes"]), (&json!("volume"), &json!(SIZES)));
    assert_eq!(info["grid"]["views"][0]["name"], "Axial");
    let n_levels = info["levels"].as_array().unwrap().len();
    let values = read_path(&path, &ReadLimits::default()).unwrap().field(GRID_VALUES).unwrap().to_f64();

    let plane = studio.get("/api/shapes/1/plane?axes=0,2&index=5").floats();
    let n = SIZES[0] * SIZES[2];
    assert_eq!(plane.len(), n * (1 + n_levels));
    let place = |k: usize| (k / SIZES[2]) * SIZES[1] * SIZES[2] + 5 * SIZES[2] + k % SIZES[2];
    assert!((0..n).all(|k| plane[k] == values[place(k)] as f32));

    let gains = gains(n_levels);
    let summary = studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains, &Value::Null)])).json();
    let recipe = studio.get("/api/shapes/1/recipe").text();
    let edited = replayed(&path, &recipe);
    let off = |k: usize| {
        let sum = |j: usize| (gains[j] - 1.0) * f64::from(plane[(1 + j) * n + k]);
        (f64::from(plane[k]) + (0..n_levels).map(sum).sum::<f64>() - edited[place(k)]).abs()
    };
    // Rounding of values up to 141 and of their bands to 24 bits.
    assert!((0..n).map(off).fold(0.0, f64::max) < 1e-4);
    let changes = || edited.iter().zip(&values).map(|(a, b)| (a - b).abs());
    assert_eq!(summary["greatest"].as_f64().unwrap(), changes().fold(0.0, f64::max));
    let rms = (changes().map(|d| d * d).sum::<f64>() / values.len() as f64).sqrt();
    assert!((summary["rms"].as_f64().unwrap() - rms).abs() < 1e-12 * rms);
    assert_eq!(studio.get("/api/shapes/1").json()["grid"]["change"]["rms"], summary["rms"]);

    let saved = studio.post("/api/shapes/1/save", &json!({})).json();
    let saved = PathBuf::from(saved["path"].as_str().unwrap());
    assert_eq!(saved, folder.path().join("head-edited.nii.gz"));
    let stored = read_path(&saved, &ReadLimits::default()).unwrap();
    let stored = stored.field(GRID_VALUES).unwrap().to_f64();
    assert!(stored.iter().zip(&edited).all(|(a, b)| *a == f64::from(*b as f32)));
}

#[test]
fn levels_recipes_and_edits_are_kept_like_those_of_shapes() {
    let folder = TempDir::new().unwrap();
    let path = volume(&folder);
    let studio = Studio::of(opened(&path), folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let gains = gains(n_levels);
    studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains, &Value::Null)]));
    let stale = studio.put("/api/shapes/1/edit", &edit(1, &[]));
    assert_eq!((stale.status, &stale.json()["edit"]["revision"]), (409, &json!(1)));

    let answer = studio.put("/api/shapes/1/levels", &json!({"lengths": [2, 4]})).json();
    assert_eq!(answer["levels"].as_array().unwrap().len(), 2);
    assert!((answer["levels"][1]["sigma"].as_f64().unwrap() - 4.0).abs() < 1e-12);
    assert_eq!(studio.get("/api/shapes/1/plane?axes=0,2").floats().len(), 3 * SIZES[0] * SIZES[2]);

    let recipe =
        "field = \"values\"\nlevels = 3\n[[layer]]\ngains = [0.5, 1, 2]\n[[layer]]\ngains = [3, 1, 1]\n";
    let answer = studio.ask("PUT", "/api/shapes/1/recipe", recipe.as_bytes()).json();
    assert_eq!(answer["edit"]["layers"][0]["gains"], json!([1.5, 1.0, 2.0]));
    studio.end();

    let studio = Studio::of(opened(&path), folder.path());
    assert_eq!(studio.get("/api/shapes/1").json()["resumed"], true);
    assert_eq!(studio.get("/api/shapes/1/edit").json()["layers"], answer["edit"]["layers"]);
    let outcome = studio.end();
    assert!(outcome.edited_file().unwrap().is_none());
    assert_eq!(parse_recipe(&outcome.recipe).unwrap().levels, LevelSpec::Dyadic(3));
}

#[test]
fn what_an_image_does_not_have_is_refused_in_one_line() {
    let folder = TempDir::new().unwrap();
    let path = volume(&folder);
    let studio = Studio::of(opened(&path), folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let error = |method: &str, path: &str, body: &Value| {
        let answer = studio.ask(method, path, body.to_string().as_bytes());
        assert_eq!(answer.status, 400, "{path}");
        answer.error()
    };
    let none = Value::Null;
    assert!(error("GET", "/api/shapes/1/positions", &none).contains("head.nii.gz is a volume"));
    assert!(error("GET", "/api/shapes/1/bands", &none).contains("for shapes"));
    assert!(error("GET", "/api/shapes/1/plane?axes=0,2&index=12", &none).contains("below 12, got 12"));
    let ball = json!({"ball": {"center": {"vertex": 20}, "radius": 5}});
    let regional = edit(1, &[layer(&vec![1.0; n_levels], &ball)]);
    assert!(error("PUT", "/api/shapes/1/edit", &regional).contains("without regions"));
    let refused = |text: &str| {
        let answer = studio.ask("PUT", "/api/shapes/1/recipe", text.as_bytes());
        assert_eq!(answer.status, 400);
        answer.error()
    };
    assert!(refused("levels = 2\n").contains("edits 'coords'"));
    let region =
        "field = \"values\"\nlevels = 1\n[[layer]]\ngains = [2]\nregion = \"ball:vertex=1,radius=2\"\n";
    assert!(refused(region).contains("has a region"));
    let save = |body: Value| error("POST", "/api/shapes/1/save", &body);
    assert!(save(json!({"name": "head.ply"})).contains(".nii"));
    assert!(save(json!({"value_type": "f31"})).contains("f32"));
    // The values stay as they were.
    assert_eq!(studio.get("/api/shapes/1/edit").json()["revision"], 0);
}

#[test]
fn places_without_data_are_nan_and_keep_their_values() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("dem.tif");
    let mut layout = GridLayout::new(&[20, 30], &[10.0, 10.0]);
    layout.origin = [5000.0, 9000.0, 0.0];
    layout.steps = vec![[0.0, -10.0, 0.0], [10.0, 0.0, 0.0]];
    let heights = |k: usize| if k % 30 < 4 { f32::NAN } else { rough(k) };
    write_path(&grid(layout, 1, heights), &path, None).unwrap();
    let studio = Studio::of(opened(&path), folder.path());
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["kind"], &info["grid"]["n_missing"]), (&json!("image"), &json!(80)));
    let n_levels = info["levels"].as_array().unwrap().len();
    let plane = studio.get("/api/shapes/1/plane").floats();
    for k in 0..600 {
        assert_eq!(plane[k].is_nan(), k % 30 < 4, "place {k}");
        assert!(
            (1..=n_levels)
                .all(|j| plane[j * 600 + k].is_finite() && (k % 30 >= 4 || plane[j * 600 + k] == 0.0))
        );
    }
    let part = studio.get("/api/shapes/1/plane?from=2,6&to=12,20&step=3").floats();
    let expected: Vec<f32> =
        (2..12).step_by(3).flat_map(|r| (6..20).step_by(3).map(move |c| r * 30 + c)).map(rough).collect();
    assert_eq!(part[..20], expected);
    studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains(n_levels), &Value::Null)]));
    let saved = studio.post("/api/shapes/1/save", &json!({"name": "out.tif"})).json();
    let saved = read_path(Path::new(saved["path"].as_str().unwrap()), &ReadLimits::default()).unwrap();
    assert_eq!(saved.grid().unwrap().n_missing(), 80);
    assert_eq!(saved.grid().unwrap().origin, [5000.0, 9000.0, 0.0]);
}

#[test]
fn pictures_keep_their_whole_numbers_unless_fractions_are_asked_for() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("photo.png");
    let mut file = grid(GridLayout::new(&[16, 24], &[1.0, 1.0]), 3, |k| 100.0 + (k * 37 % 60) as f32);
    file.set_value_type(Some(ValueType::U8));
    write_path(&file, &path, None).unwrap();
    let studio = Studio::of(opened(&path), folder.path());
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["grid"]["n_channels"], &info["grid"]["value_type"]), (&json!(3), &json!("u8")));
    let n_levels = info["levels"].as_array().unwrap().len();
    let mut one = vec![1.0; n_levels];
    one[0] = 0.5;
    studio.put("/api/shapes/1/edit", &edit(1, &[layer(&one, &Value::Null)]));
    let edited = replayed(&path, &studio.get("/api/shapes/1/recipe").text());
    let saved = studio.post("/api/shapes/1/save", &json!({"name": "out.png"})).json();
    assert!(saved["notes"][0].as_str().unwrap().contains("rounded to whole numbers (u8)"), "{saved}");
    let read = |name: &str| read_path(&folder.path().join(name), &ReadLimits::default()).unwrap();
    let stored = read("out.png").field(GRID_VALUES).unwrap().to_f64();
    assert!(stored.iter().zip(&edited).all(|(a, b)| (a - b).abs() <= 0.5));
    studio.post("/api/shapes/1/save", &json!({"name": "out.tif", "value_type": "f32"}));
    let stored = read("out.tif").field(GRID_VALUES).unwrap().to_f64();
    assert!(stored.iter().zip(&edited).all(|(a, b)| *a == f64::from(*b as f32)));
    // A value that 8 bits do not hold is no silent clip.
    studio.put("/api/shapes/1/edit", &edit(2, &[layer(&vec![40.0; n_levels], &Value::Null)]));
    let refused = studio.post("/api/shapes/1/save", &json!({"name": "loud.png"}));
    assert!(refused.status == 400 && refused.error().contains("does not fit the u8"), "{}", refused.text());
}

#[test]
fn a_series_sends_one_frame_and_an_edit_changes_all() {
    const N_FRAMES: usize = 7;
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("bold.nii.gz");
    // The brightest frame is the last one.
    let value = |k: usize| rough(k) + (k % N_FRAMES) as f32;
    let mut file = ShapeFile::from_grid(GridLayout::new(&SIZES, &[3.0, 2.0, 1.5])).unwrap();
    let values = FieldValues::F32((0..file.n_vertices() * N_FRAMES).map(value).collect());
    file.add_vertex_field(Field::new(GRID_VALUES, N_FRAMES, values).with_frame_step(Some(1.5))).unwrap();
    write_path(&file, &path, None).unwrap();

    let studio = Studio::of(opened(&path), folder.path());
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["kind"], &info["grid"]["n_channels"]), (&json!("volume"), &json!(1)));
    assert_eq!(info["grid"]["frames"], json!({"n": N_FRAMES, "step": 1.5}));
    let n_values = SIZES.iter().product::<usize>() * N_FRAMES;
    let greatest = (0..n_values).map(value).fold(0.0, f32::max);
    assert_eq!(info["grid"]["range"]["greatest"].as_f64(), Some(f64::from(greatest)));

    let n_levels = info["levels"].as_array().unwrap().len();
    let n = SIZES[0] * SIZES[2];
    let index = |k: usize, frame: usize| {
        N_FRAMES * ((k / SIZES[2]) * SIZES[1] * SIZES[2] + 5 * SIZES[2] + k % SIZES[2]) + frame
    };
    let plane = |query: &str| studio.get(&format!("/api/shapes/1/plane?axes=0,2&index=5{query}")).floats();
    let sent = plane("&frame=3");
    assert_eq!(sent.len(), n * (1 + n_levels));
    assert!((0..n).all(|k| sent[k] == value(index(k, 3))));
    assert!(plane("").iter().zip(plane("&frame=0")).all(|(a, b)| *a == b));
    let beyond = studio.ask("GET", "/api/shapes/1/plane?frame=7", b"");
    assert!(beyond.status == 400 && beyond.error().contains("below 7, got 7"), "{}", beyond.text());

    let gains = gains(n_levels);
    studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains, &Value::Null)]));
    let edited = replayed(&path, &studio.get("/api/shapes/1/recipe").text());
    let off = |k: usize| {
        let sum = |j: usize| (gains[j] - 1.0) * f64::from(sent[(1 + j) * n + k]);
        (f64::from(sent[k]) + (0..n_levels).map(sum).sum::<f64>() - edited[index(k, 3)]).abs()
    };
    assert!((0..n).map(off).fold(0.0, f64::max) < 1e-4);
    let saved = studio.post("/api/shapes/1/save", &json!({})).json();
    let stored = read_path(Path::new(saved["path"].as_str().unwrap()), &ReadLimits::default()).unwrap();
    let stored = stored.field(GRID_VALUES).unwrap();
    assert_eq!((stored.n_channels, stored.frame_step), (N_FRAMES, Some(1.5)));
    let stored = stored.to_f64();
    assert_eq!(stored.len(), edited.len());
    assert!(stored.iter().zip(&edited).all(|(a, b)| *a == f64::from(*b as f32)));
}

#[test]
fn an_image_of_many_channels_is_a_series() {
    let folder = TempDir::new().unwrap();
    let opened_image = |name: &str, n_channels: usize| {
        let path = folder.path().join(name);
        write_path(&grid(GridLayout::new(&[16, 24], &[1.0; 2]), n_channels, rough), &path, None).unwrap();
        Studio::of(opened(&path), folder.path())
    };
    let studio = opened_image("stack.tif", 6);
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["kind"], &info["grid"]["n_channels"]), (&json!("image"), &json!(1)));
    assert_eq!(info["grid"]["frames"], json!({"n": 6, "step": null}));
    let plane = studio.get("/api/shapes/1/plane?frame=5").floats();
    assert!((0..16 * 24).all(|k| plane[k] == rough(6 * k + 5)));
    studio.end();
    let studio = opened_image("photo.tif", 3);
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["grid"]["n_channels"], &info["grid"]["frames"]), (&json!(3), &Value::Null));
    let refused = studio.ask("GET", "/api/shapes/1/plane?frame=1", b"");
    assert!(
        refused.status == 400 && refused.error().contains("'frame' must be left out"),
        "{}",
        refused.text()
    );
}

#[test]
fn sequences_and_gaps_that_differ_are_refused_with_what_to_do() {
    let folder = TempDir::new().unwrap();
    let refused = |name: &str, file: &ShapeFile| {
        let path = folder.path().join(name);
        write_path(file, &path, None).unwrap();
        let params = adwave_studio::StudioParams::default();
        let served = adwave_studio::serve(opened(&path), &params, adwave::Progress::none(), |_| {
            panic!("{name} is served")
        });
        served.unwrap_err().to_string()
    };
    let gap = |k: usize| if k == 12 { f32::NAN } else { rough(k) };
    let series = refused("f.nii", &grid(GridLayout::new(&[4, 5, 6], &[1.0; 3]), 7, gap));
    assert!(series.contains("series whose frames") && series.contains("adwave filter"), "{series}");
    let colors = refused("f.tif", &grid(GridLayout::new(&[6, 7], &[1.0; 2]), 3, gap));
    assert!(colors.contains("images whose channels"), "{colors}");
    let sequence = refused("f.nii", &grid(GridLayout::new(&[40], &[1.0]), 1, rough));
    assert!(sequence.contains("a sequence of values"), "{sequence}");
}
