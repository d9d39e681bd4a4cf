//! Edits of fields: their bands, their files, and regions of fields with gaps.

use crate::client::{Studio, opened};
use crate::server::{creature, edit, layer};
use adwave::bands::Schedule;
use adwave::filter::Edit;
use adwave::local_fit::LocalFit;
use adwave::{Decomposer, LevelSpec};
use adwave_io::{
    ArrayValues, Field, FieldValues, ReadLimits, parse_recipe, read_npy_bytes, read_path, write_npy,
    write_path,
};
use serde_json::{Value, json};
use std::path::Path;
use tempfile::TempDir;

/// A field of slow and fast waves, with a wall of missing values.
fn thickness(n: usize) -> Vec<f64> {
    let value = |v: usize| 2.5 + (v as f64 / 40.0).sin() + 0.25 * (v as f64 * 1.7).sin();
    (0..n).map(|v| if v % 900 < 60 { f64::NAN } else { value(v) }).collect()
}

fn table(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join("\n")
}

/// Applies the recipe of a field, like `adwave filter --recipe --signal`.
fn replayed(path: &Path, values: &[f64], recipe: &str) -> Vec<f64> {
    let recipe = parse_recipe(recipe).unwrap();
    let LevelSpec::Dyadic(n_levels) = recipe.levels else { panic!("{:?}", recipe.levels) };
    let missing: Vec<bool> = values.iter().map(|v| v.is_nan()).collect();
    let decomposer = Decomposer::new(&opened(path).shape).masked(&missing).unwrap();
    let schedule = Schedule::dyadic(n_levels).unwrap();
    let mut editor = decomposer.request(values, 1, &schedule).local_fit(LocalFit::Linear).editor().unwrap();
    editor.set_edit(&Edit::new(&recipe.layers)).unwrap();
    editor.into_edited()
}

#[test]
fn a_field_is_edited_by_its_own_layers_and_exported_in_double_precision() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let kept = folder.path().join("kept");
    let studio = Studio::on(&path, &kept);
    let values = thickness(opened(&path).file.n_vertices());
    let n = values.len();
    studio.ask("POST", "/api/shapes/1/fields?name=thickness.csv", table(&values).as_bytes());
    let info = studio.get("/api/shapes/1").json();
    let listed = info["fields"].as_array().unwrap().iter().find(|f| f["name"] == "thickness").unwrap();
    assert_eq!((&listed["editable"], &listed["edited"]), (&json!(true), &json!(false)));
    let n_levels = info["levels"].as_array().unwrap().len();

    let bands = studio.get("/api/shapes/1/field-bands?name=thickness").floats();
    assert_eq!(bands.len(), (n_levels + 1) * n);
    let mut gains = vec![1.0; n_levels];
    gains[..3].copy_from_slice(&[0.1, 0.3, 2.0]);
    let ball = json!({"ball": {"center": {"vertex": 2000}, "radius": 0.5}});
    let mut document = edit(1, &[layer(&vec![1.0; n_levels], &Value::Null)]);
    document["fields"] =
        json!([{"field": "thickness", "layers": [layer(&gains, &Value::Null), layer(&gains, &ball)]}]);
    let summary = studio.put("/api/shapes/1/edit", &document).json();
    assert_eq!(summary["greatest"], 0.0, "positions have an edit of their own");

    let recipe = studio.get("/api/shapes/1/recipe?field=thickness").text();
    let expected = replayed(&path, &values, &recipe);
    assert!(expected.iter().zip(&values).any(|(a, b)| (a - b).abs() > 0.1));
    let exported = studio.get("/api/shapes/1/edited-field?name=thickness&format=npy").body;
    let exported = read_npy_bytes(&exported).unwrap();
    assert_eq!(exported.shape, [n]);
    let exported = exported.into_field("t").to_f64();
    for (x, (a, b)) in exported.iter().zip(&expected).enumerate() {
        assert!(a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()), "vertex {x}: {a} and {b}");
        assert_eq!(a.is_nan(), values[x].is_nan(), "vertex {x}");
    }
    let shown = studio.get("/api/shapes/1/edited-field?name=thickness").floats();
    assert!(shown.iter().zip(&expected).all(|(a, b)| *a == *b as f32 || a.is_nan()));
    let text = studio.get("/api/shapes/1/edited-field?name=thickness&format=csv").text();
    assert_eq!(text.lines().next(), Some("thickness"));
    assert_eq!(text.lines().count(), n + 1);
    // A saved shape has the edited field.
    let saved = studio.post("/api/shapes/1/save", &json!({"name": "out.ply"})).json();
    let saved = read_path(Path::new(saved["path"].as_str().unwrap()), &ReadLimits::default()).unwrap();
    let field = saved.field("thickness").unwrap();
    assert!(matches!(&field.values, FieldValues::F64(stored) if stored[100] == expected[100]));

    // Gains follow their widths to other levels, and the edit is there on the next visit.
    studio.put("/api/shapes/1/levels", &json!({"levels": n_levels - 1}));
    let again = studio.get("/api/shapes/1/edit").json();
    assert_eq!(again["fields"][0]["layers"][0]["gains"], json!(gains[..n_levels - 1]));
    assert_eq!(studio.get("/api/shapes/1/field-bands?name=thickness").floats().len(), n_levels * n);
    studio.end();
    let studio = Studio::on(&path, &kept);
    assert_eq!(studio.get("/api/shapes/1/edit").json()["fields"], again["fields"]);
}

#[test]
fn the_bands_of_a_field_sum_to_what_a_gain_does() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let studio = Studio::on(&path, folder.path());
    let values = thickness(opened(&path).file.n_vertices());
    let n = values.len();
    studio.ask("POST", "/api/shapes/1/fields?name=t.csv", table(&values).as_bytes());
    let bands = studio.get("/api/shapes/1/field-bands?name=t").floats();
    let n_levels = bands.len() / n - 1;
    for level in [1, n_levels] {
        let mut gains = vec![1.0; n_levels];
        gains[level - 1] = 0.0;
        let mut document = edit(level as u64, &[]);
        document["fields"] = json!([{"field": "t", "layers": [layer(&gains, &Value::Null)]}]);
        assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
        let edited = studio.get("/api/shapes/1/edited-field?name=t").floats();
        for x in 0..n {
            assert_eq!(values[x].is_nan(), edited[x].is_nan(), "vertex {x}");
            let sum = bands[x] - bands[level * n + x];
            // Rounding of two numbers in single precision.
            assert!(edited[x].is_nan() || (edited[x] - sum).abs() < 2e-6, "vertex {x}: {sum}");
        }
    }
}

#[test]
fn what_is_wrong_with_a_field_is_said_in_one_line() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let studio = Studio::on(&path, folder.path());
    let n = opened(&path).file.n_vertices();
    let add = |name: &str, values: &[f64]| {
        let path = format!("/api/shapes/1/fields?name={name}.csv");
        assert_eq!(studio.ask("POST", &path, table(values).as_bytes()).status, 200);
    };
    add("nothing", &vec![f64::NAN; n]);
    add("label", &vec![3.0; n]);
    add("half", &(0..n).map(|v| if v < n / 2 { f64::NAN } else { 1.0 }).collect::<Vec<_>>());
    let bands = |name: &str| studio.ask("GET", &format!("/api/shapes/1/field-bands?name={name}"), b"");
    let listed = studio.get("/api/shapes/1").json()["fields"].clone();
    let editable = |name: &str| {
        listed.as_array().unwrap().iter().find(|field| field["name"] == name).unwrap()["editable"].clone()
    };
    assert_eq!(["nothing", "label", "half"].map(editable), [false, false, true]);
    for (name, message) in [
        ("nothing", "'nothing'"),
        ("label", "a mean of labels is none"),
        ("saliency", "got 'saliency'"),
        ("", "got ''"),
    ] {
        let answer = bands(name);
        assert_eq!(answer.status, 400, "{name}");
        assert!(answer.error().contains(message), "{}", answer.error());
    }
    let other = studio.ask("GET", "/api/shapes/1/edited-field?name=half&format=exe", b"");
    assert!(other.status == 400 && other.error().contains("npy, csv or gii"), "{}", other.error());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let mut document = edit(1, &[]);
    document["fields"] = json!([{"field": "half", "layers": [layer(&[1.0], &Value::Null)]}]);
    let refused = studio.put("/api/shapes/1/edit", &document);
    let message = format!(
        "field 'half': layer 1 ('a layer'): one gain per level is needed, got 1 gains for {n_levels}"
    );
    assert!(refused.status == 400 && refused.error().starts_with(&message), "{}", refused.error());
    document["fields"] = json!([{"field": "half", "layers": []}, {"field": "half", "layers": []}]);
    assert!(studio.put("/api/shapes/1/edit", &document).error().contains("got two for 'half'"));
    // A vertex without a value is outside of the region, whichever way the weight goes.
    for (low, high, inside) in [(0.0, 1.0, 255), (2.0, 1.0, 255), (1.0, 2.0, 0)] {
        let region = json!({"field": {"name": "half", "low": low, "high": high}});
        let weights = studio.post("/api/shapes/1/weights", &region);
        assert_eq!(weights.status, 200, "{}", weights.text());
        assert!(weights.body[..n / 2].iter().all(|w| *w == 0));
        assert!(weights.body[n / 2..].iter().all(|w| *w == inside), "{low} {high}");
    }
}

#[test]
fn the_recipe_of_a_field_is_opened_on_the_field_and_leaves_the_positions() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let values = thickness(opened(&path).file.n_vertices());
    let open = |kept: &str| {
        let studio = Studio::on(&path, &folder.path().join(kept));
        studio.ask("POST", "/api/shapes/1/fields?name=thickness.csv", table(&values).as_bytes());
        studio
    };
    let exported = |studio: &Studio| studio.get("/api/shapes/1/edited-field?name=thickness&format=npy").body;
    // Two layers on other levels than the default ones, sent by one studio and opened by another.
    let studio = open("first");
    studio.put("/api/shapes/1/levels", &json!({"levels": 3}));
    let ball = json!({"ball": {"center": {"vertex": 2000}, "radius": 0.5}});
    let mut document = edit(9, &[layer(&[1.0, 0.5, 1.0], &Value::Null)]);
    document["fields"] = json!([{"field": "thickness", "layers": [
        layer(&[0.1, 0.3, 2.0], &Value::Null), layer(&[3.0, 1.0, 1.0], &ball)]}]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    let (recipe, expected) = (studio.get("/api/shapes/1/recipe?field=thickness").text(), exported(&studio));
    studio.end();
    let studio = open("second");
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let mut gains = vec![1.0; n_levels];
    gains[1] = 0.25;
    assert_eq!(studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains, &Value::Null)])).status, 200);
    let answer = studio.ask("PUT", "/api/shapes/1/recipe", recipe.as_bytes()).json();
    assert_eq!((&answer["field"], answer["levels"].as_array().unwrap().len()), (&json!("thickness"), 3));
    let kept = &answer["edit"]["layers"][0]["gains"];
    assert_eq!(*kept, json!([1.0, 0.25, 1.0]), "the gains of the positions follow their widths");
    assert!(exported(&studio) == expected, "equal bytes");
    // A recipe of the positions in turn leaves the field.
    let answer =
        studio.ask("PUT", "/api/shapes/1/recipe", b"levels = 3\n[[layer]]\npreset = 'suppress'").json();
    assert_eq!(answer["field"], Value::Null);
    assert!(exported(&studio) == expected, "equal bytes");
    // `adwave filter --save-recipe` names the file, and the widths of a walk without the gaps.
    let missing: Vec<bool> = values.iter().map(|v| v.is_nan()).collect();
    let masked = Decomposer::new(&opened(&path).shape).masked(&missing).unwrap();
    let widths = Schedule::dyadic(4).unwrap().sigma(masked.operator().step_length())[1..].to_vec();
    let by_width = format!(
        "field = 'some/folder/thickness.csv'\noperator = 'walk'\nlengths = {widths:?}\n[[layer]]\ngains = [0, 0.5, 2, 1]"
    );
    assert_eq!(studio.ask("PUT", "/api/shapes/1/recipe", by_width.as_bytes()).json()["field"], "thickness");
    let schedule = Schedule::lengths(&widths, masked.operator().step_length()).unwrap();
    let mut editor = masked.request(&values, 1, &schedule).local_fit(LocalFit::Linear).editor().unwrap();
    editor.set_edit(&Edit::new(&parse_recipe(&by_width).unwrap().layers)).unwrap();
    let shown = read_npy_bytes(&exported(&studio)).unwrap().into_field("t").to_f64();
    assert!(shown.iter().zip(editor.edited()).all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan()));
}

#[test]
fn a_recipe_of_a_field_that_cannot_be_opened_says_what_to_do() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let studio = Studio::on(&path, folder.path());
    let n = opened(&path).file.n_vertices();
    let rows: Vec<String> = (0..n).map(|v| format!("{v},{}", v % 7)).collect();
    let two = format!("first,second\n{}", rows.join("\n"));
    assert_eq!(studio.ask("POST", "/api/shapes/1/fields?name=two.csv", two.as_bytes()).status, 200);
    studio.ask("POST", "/api/shapes/1/fields?name=label.csv", table(&vec![3.0; n]).as_bytes());
    let before = studio.get("/api/shapes/1/edit").json();
    let layer = "[[layer]]\npreset = 'suppress'\n";
    for (head, message) in [
        (
            "field = 'age'",
            "'age', which this shape does not have; drop its file, such as age.npy, on the page",
        ),
        ("field = 'data/age.npy'", "drop age.npy on the page, and open the recipe again"),
        ("field = 'two.csv'", "write field = \"two first\" into the recipe"),
        ("field = 'mean-curvature'", "computed from the shape"),
        ("field = 'saliency'", "computed from the shape"),
        ("field = 'z'", "computed from the shape"),
        ("field = 'label'", "a mean of labels is none"),
        ("field = 'two first'\nlocal_fit = 'constant'", "has another local_fit"),
        ("field = 'two first'\nkeep_creases = true", "keep_creases"),
        ("field = 'two first'\n[pose]\nhandle = []", "[pose] of the recipe change positions"),
        ("field = 'two first'\nlevels = 99", "at most 32"),
    ] {
        let recipe = format!("{head}\n{}", if head.contains("[pose]") { "" } else { layer });
        let answer = studio.ask("PUT", "/api/shapes/1/recipe", recipe.as_bytes());
        assert_eq!(answer.status, 400, "{head}");
        assert!(answer.error().contains(message), "{head}: {}", answer.error());
    }
    assert_eq!(studio.get("/api/shapes/1/edit").json(), before, "nothing changed");
    let column = format!("field = 'some/two.csv:second'\n{layer}");
    assert_eq!(studio.ask("PUT", "/api/shapes/1/recipe", column.as_bytes()).json()["field"], "two second");
}

/// A NumPy array of doubles, `n` × `n_frames`, as bytes.
fn npy(values: &[f64], n_frames: usize) -> Vec<u8> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("values.npy");
    write_npy(&path, &[values.len() / n_frames, n_frames], ArrayValues::F64(values)).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn values_over_time_are_frames_of_a_series() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2500);
    let kept = folder.path().join("kept");
    let studio = Studio::on(&path, &kept);
    let n = opened(&path).file.n_vertices();
    // More frames than a file of other columns may have.
    let n_frames = 150;
    let value = |x: usize, t: usize| (x as f64 / 50.0).sin() * (t as f64 / 9.0).cos() + 0.01 * t as f64;
    let mut values: Vec<f64> = (0..n * n_frames).map(|k| value(k / n_frames, k % n_frames)).collect();
    values[3 * n_frames + 70] = 1e3;
    values[5 * n_frames + 20] = f64::NAN;
    let added = studio.ask("POST", "/api/shapes/1/fields?name=bold.npy", &npy(&values, n_frames)).json();
    assert_eq!(added["fields"].as_array().unwrap().len(), n_frames);
    let listed = |studio: &Studio| {
        let info = studio.get("/api/shapes/1").json();
        let fields = info["fields"].as_array().unwrap().clone();
        fields.into_iter().filter(|f| f["series"]["name"] == "bold").collect::<Vec<_>>()
    };
    let fields = listed(&studio);
    assert_eq!(fields.len(), n_frames);
    for (t, field) in fields.iter().enumerate() {
        assert_eq!(field["name"], format!("bold {}", t + 1));
        assert_eq!((&field["editable"], &field["channel"]), (&json!(true), &json!(false)));
    }
    for t in [0, 20, 149] {
        let shown = studio.get(&format!("/api/shapes/1/field?name=bold%20{}", t + 1)).floats();
        assert_eq!(shown.len(), n);
        for (x, a) in shown.iter().enumerate() {
            let b = values[x * n_frames + t] as f32;
            assert!(*a == b || (a.is_nan() && b.is_nan()), "frame {t}, vertex {x}: {a} and {b}");
        }
    }
    // The sample has the extremes of all frames, and as many small values as large ones.
    let sample = studio.get("/api/shapes/1/field?name=bold%207&of=series").floats();
    assert!(sample.len() > 20_000 && sample.len() <= (1 << 16) + 2, "{}", sample.len());
    let known: Vec<f32> = values.iter().filter(|v| v.is_finite()).map(|v| *v as f32).collect();
    let extreme = |list: &[f32], better: fn(f32, f32) -> f32| {
        list.iter().copied().filter(|v| v.is_finite()).reduce(better).unwrap()
    };
    assert_eq!(extreme(&sample, f32::max), 1e3);
    assert_eq!(extreme(&sample, f32::min), extreme(&known, f32::min));
    let mean = |list: &[f32]| {
        let usual: Vec<f32> = list.iter().copied().filter(|v| *v < 100.0).collect();
        usual.iter().sum::<f32>() / usual.len() as f32
    };
    assert!((mean(&sample) - mean(&known)).abs() < 0.02, "{} and {}", mean(&sample), mean(&known));
    let error = studio.ask("GET", "/api/shapes/1/field?name=saliency&of=series", b"");
    assert_eq!(error.status, 400);
    assert!(error.error().contains("no frame of a series"));
    // Nobody else can read what was edited.
    #[cfg(unix)]
    for entry in std::fs::read_dir(&kept).unwrap().map(Result::unwrap) {
        let mode = std::os::unix::fs::PermissionsExt::mode(&entry.metadata().unwrap().permissions());
        assert_eq!(mode & 0o077, 0, "{:?}", entry.path());
    }
    // They are there on the next visit; named columns are no series.
    studio.ask("POST", "/api/shapes/1/fields?name=two.csv", two_columns(n).as_bytes());
    studio.end();
    let studio = Studio::on(&path, &kept);
    assert_eq!(listed(&studio).len(), n_frames);
    let info = studio.get("/api/shapes/1").json();
    let two: Vec<_> = info["fields"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|f| f["name"].as_str().unwrap().starts_with("two "))
        .collect();
    assert_eq!(two.len(), 2);
    assert!(two.iter().all(|f| f["series"].is_null()));
    // A shorter series replaces the longer one.
    let short: Vec<f64> = (0..n * 3).map(|k| k as f64).collect();
    studio.ask("POST", "/api/shapes/1/fields?name=bold.npy", &npy(&short, 3));
    assert_eq!(listed(&studio).len(), 3);
    studio.end();
}

fn two_columns(n: usize) -> String {
    (0..n).fold("thickness,area\n".to_owned(), |text, x| text + &format!("{x},{}\n", 2 * x))
}

#[test]
fn channels_of_a_field_of_the_file_are_frames() {
    let folder = TempDir::new().unwrap();
    let mut file = opened(&creature(&folder, 2000)).file;
    let n = file.n_vertices();
    let flow: Vec<f32> = (0..3 * n).map(|k| k as f32).collect();
    file.add_vertex_field(Field::new("flow", 3, FieldValues::F32(flow))).unwrap();
    let path = folder.path().join("flow.vtu");
    write_path(&file, &path, None).unwrap();
    let studio = Studio::on(&path, &folder.path().join("kept"));
    let info = studio.get("/api/shapes/1").json();
    let names: Vec<_> =
        info["fields"].as_array().unwrap().iter().filter(|f| f["series"]["name"] == "flow").collect();
    assert_eq!(names.len(), 3, "{}", info["fields"]);
    assert!(names.iter().all(|f| f["channel"] == true && f["editable"] == false));
    let second = studio.get("/api/shapes/1/field?name=flow%202").floats();
    assert!(second.iter().enumerate().all(|(x, v)| *v == (3 * x + 1) as f32));
    studio.end();
}
