//! Graphs and curves: their places and edges, edits of fields and of positions, and the files that are saved.

use crate::client::{Studio, opened};
use crate::server::{edit, layer, replayed};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::filter::Edit;
use adwave_io::{ReadLimits, parse_recipe, read_npy_bytes, read_path};
use serde_json::{Value, json};
use std::path::PathBuf;
use tempfile::TempDir;

/// Number of nodes of the ring.
const N: usize = 60;

/// A ring of nodes with weights, as an edge list.
fn ring(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("ring.edgelist");
    let edge = |k: usize| format!("{k} {} {}\n", (k + 1) % N, 1 + k % 7);
    std::fs::write(&path, (0..N).map(edge).collect::<String>()).unwrap();
    path
}

/// A curve in space that wiggles.
fn wire(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("wire.obj");
    let point = |k: usize| {
        let t = k as f64 / 20.0;
        format!("v {} {} {}\n", t.cos() + 0.02 * (7.0 * k as f64).sin(), t.sin(), 0.1 * t)
    };
    let points: String = (0..200).map(point).collect();
    let nodes: Vec<String> = (1..=200).map(|k: u32| k.to_string()).collect();
    std::fs::write(&path, format!("{points}l {}\n", nodes.join(" "))).unwrap();
    path
}

fn u32s(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect()
}

fn field_names(info: &Value) -> Vec<&str> {
    info["fields"].as_array().unwrap().iter().map(|field| field["name"].as_str().unwrap()).collect()
}

#[test]
fn a_graph_without_positions_is_placed_by_its_edges() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&ring(&folder), folder.path());
    let info = studio.get("/api/shapes/1").json();
    assert_eq!(info["kind"], "graph");
    assert_eq!(info["graph"], json!({"n_edges": N, "flat": true, "placed": true, "named": false}));
    // Nothing that is computed from positions is offered.
    assert_eq!(field_names(&info), ["degree"]);
    assert!(info["formats"].as_array().unwrap().contains(&json!("edgelist")), "{}", info["formats"]);
    assert!(!info["formats"].as_array().unwrap().contains(&json!("ply")), "{}", info["formats"]);
    let edges = u32s(&studio.get("/api/shapes/1/edges").body);
    assert_eq!(edges.len(), 2 * N);
    let points = studio.get("/api/shapes/1/positions").floats();
    let place = |v: u32| &points[3 * v as usize..][..3];
    for pair in edges.as_chunks::<2>().0 {
        let length = (0..3).map(|c| (place(pair[0])[c] - place(pair[1])[c]).powi(2)).sum::<f32>().sqrt();
        assert!((0.5..1.5).contains(&length), "{pair:?}: {length}");
    }
    // The same places on the next visit.
    drop(studio);
    let again = Studio::on(&ring(&folder), folder.path());
    assert_eq!(again.get("/api/shapes/1/positions").floats(), points);
}

#[test]
fn names_of_nodes_are_told() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("genes.edgelist");
    std::fs::write(&path, "MYC TP53\nTP53 \"EGFR\"\nMYC KRAS\n").unwrap();
    let studio = Studio::on(&path, folder.path());
    assert_eq!(studio.get("/api/shapes/1").json()["graph"]["named"], true);
    let name = |query: &str| studio.ask("GET", &format!("/api/shapes/1/name{query}"), b"");
    assert_eq!(name("?vertex=0").json(), "MYC");
    assert_eq!(name("?vertex=2").json(), "\"EGFR\"");
    for bad in ["", "?vertex=4", "?vertex=-1", "?vertex=x"] {
        assert_eq!((name(bad).status, name(bad).error().contains("vertex")), (400, true), "{bad}");
    }
    // Numbers are no names.
    let studio = Studio::on(&ring(&folder), folder.path());
    assert_eq!(studio.ask("GET", "/api/shapes/1/name?vertex=0", b"").status, 400);
}

#[test]
fn fields_of_a_graph_are_edited_as_the_command_does() {
    let folder = TempDir::new().unwrap();
    let path = ring(&folder);
    let studio = Studio::on(&path, folder.path());
    let values: Vec<f64> = (0..N).map(|k| (k as f64 / 5.0).sin() + 0.3 * (k as f64 * 2.1).sin()).collect();
    let table = values.iter().map(f64::to_string).collect::<Vec<_>>().join("\n");
    studio.ask("POST", "/api/shapes/1/fields?name=load.csv", table.as_bytes());
    let info = studio.get("/api/shapes/1").json();
    assert_eq!(field_names(&info), ["degree", "load"]);
    let n_levels = info["levels"].as_array().unwrap().len();
    let ones = vec![1.0; n_levels];
    let mut gains = ones.clone();
    gains[..3].copy_from_slice(&[0.0, 0.25, 2.0]);
    // A ball has a radius in edges.
    let ball = json!({"ball": {"center": {"vertex": 10}, "radius": 3.5, "falloff": 0}});
    let weights = studio.post("/api/shapes/1/weights", &ball);
    let inside: Vec<usize> = (0..N).filter(|&v| weights.body[v] > 0).collect();
    assert_eq!(inside, [7, 8, 9, 10, 11, 12, 13]);
    let mut document = edit(1, &[layer(&ones, &Value::Null)]);
    document["fields"] =
        json!([{"field": "load", "layers": [layer(&gains, &Value::Null), layer(&gains, &ball)]}]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).json()["greatest"], 0.0);

    let recipe = parse_recipe(&studio.get("/api/shapes/1/recipe?field=load").text()).unwrap();
    let decomposer = Decomposer::new(&opened(&path).shape);
    let schedule = Schedule::dyadic(n_levels).unwrap();
    let request = decomposer.request(&values, 1, &schedule).local_fit(recipe.local_fit.unwrap());
    let mut editor = request.editor().unwrap();
    editor.set_edit(&Edit::new(&recipe.layers)).unwrap();
    let expected = editor.into_edited();
    let exported = studio.get("/api/shapes/1/edited-field?name=load&format=npy").body;
    assert_eq!(read_npy_bytes(&exported).unwrap().into_field("t").to_f64(), expected);
    assert!(expected.iter().zip(&values).any(|(a, b)| (a - b).abs() > 0.1));

    // A saved graph has the edited field, and the degree only if it was edited.
    assert_eq!(studio.post("/api/shapes/1/save", &json!({"name": "out.graphml"})).status, 200);
    let saved = read_path(&folder.path().join("out.graphml"), &ReadLimits::default()).unwrap();
    assert_eq!(saved.field_names(), ["load"]);
    assert_eq!(saved.field("load").unwrap().to_f64(), expected);
    document["revision"] = json!(2);
    document["fields"][0]["field"] = json!("degree");
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    let request = json!({"name": "out.graphml", "replace": true});
    assert_eq!(studio.post("/api/shapes/1/save", &request).status, 200);
    let saved = read_path(&folder.path().join("out.graphml"), &ReadLimits::default()).unwrap();
    assert!(saved.field("degree").is_some());

    // Values of a file of that name are the user's own, and are saved.
    document["revision"] = json!(3);
    document["fields"] = json!([]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    assert_eq!(studio.ask("POST", "/api/shapes/1/fields?name=degree.csv", table.as_bytes()).status, 200);
    assert_eq!(studio.post("/api/shapes/1/save", &request).status, 200);
    let saved = read_path(&folder.path().join("out.graphml"), &ReadLimits::default()).unwrap();
    assert_eq!(saved.field("degree").unwrap().to_f64(), values);

    // Places are no positions.
    let moved = edit(4, &[layer(&gains, &Value::Null)]);
    let refused = studio.put("/api/shapes/1/edit", &moved);
    assert_eq!(refused.status, 400);
    assert!(refused.error().contains("edited by its fields alone"), "{}", refused.error());

    // The outcome is what is saved.
    let outcome = studio.end();
    let edited = outcome.edited_file().unwrap().unwrap();
    assert_eq!(edited.field("degree").unwrap().to_f64(), values);
    assert_eq!(edited.field("load").unwrap().to_f64(), values);
    assert!(outcome.field_recipes.is_empty());
}

#[test]
fn the_outcome_of_a_graph_has_its_edited_fields_and_no_others() {
    let folder = TempDir::new().unwrap();
    let path = ring(&folder);
    // Ended before or after its bands are there, and not edited.
    let outcome = Studio::on(&path, folder.path()).end();
    assert!(outcome.edited_file().unwrap().unwrap().field_names().is_empty());

    let studio = Studio::on(&path, folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let ones = vec![1.0; n_levels];
    let mut document = edit(1, &[layer(&ones, &Value::Null)]);
    document["fields"] = json!([{"field": "degree", "layers": [layer(&vec![2.0; n_levels], &Value::Null)]}]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    let recipe = studio.get("/api/shapes/1/recipe?field=degree").text();
    let saved = studio.get("/api/shapes/1/edited-field?name=degree&format=npy").body;
    let outcome = studio.end();
    assert_eq!(outcome.field_recipes, [("degree".to_owned(), recipe)]);
    let edited = outcome.edited_file().unwrap().unwrap();
    assert_eq!(edited.field_names(), ["degree"]);
    let values = read_npy_bytes(&saved).unwrap().into_field("degree").to_f64();
    assert_eq!(edited.field("degree").unwrap().to_f64(), values);
}

#[test]
fn a_curve_is_saved_as_the_command_writes_it() {
    let folder = TempDir::new().unwrap();
    let path = wire(&folder);
    let studio = Studio::on(&path, folder.path());
    let info = studio.get("/api/shapes/1").json();
    assert_eq!((&info["kind"], &info["graph"]["n_edges"]), (&json!("curve"), &json!(199)));
    assert_eq!((&info["graph"]["flat"], &info["graph"]["placed"]), (&json!(false), &json!(false)));
    let n_levels = info["levels"].as_array().unwrap().len();
    let mut gains = vec![1.0; n_levels];
    gains[..3].copy_from_slice(&[0.0, 0.0, 0.5]);
    let summary = studio.put("/api/shapes/1/edit", &edit(1, &[layer(&gains, &Value::Null)])).json();
    assert!(summary["greatest"].as_f64().unwrap() > 0.001, "{summary}");
    let recipe = studio.get("/api/shapes/1/recipe").text();
    assert_eq!(studio.post("/api/shapes/1/save", &json!({"name": "out.obj"})).status, 200);
    assert_eq!(std::fs::read(folder.path().join("out.obj")).unwrap(), replayed(&path, &recipe));
    let clean = studio.post("/api/shapes/1/denoise", &json!({"strength": 1.0}));
    assert_eq!(clean.status, 200, "{}", clean.text());
}

#[test]
fn what_graphs_do_not_have_is_refused_in_one_line() {
    let folder = TempDir::new().unwrap();
    for path in [ring(&folder), wire(&folder)] {
        let studio = Studio::on(&path, folder.path());
        for (method, at, body) in [
            ("GET", "page", ""),
            ("GET", "field?name=saliency", ""),
            ("POST", "compare", "{\"method\": \"taubin\"}"),
            ("POST", "compare", "{\"method\": \"harmonics\"}"),
            ("POST", "deviation", "{\"from\": 1}"),
            ("GET", "download?format=stl", ""),
        ] {
            let answer = studio.ask(method, &format!("/api/shapes/1/{at}"), body.as_bytes());
            assert_eq!(answer.status, 400, "{} {at}: {}", path.display(), answer.text());
            answer.error();
        }
        let answer = studio.ask("POST", "/api/shapes/1/report", b"");
        assert_eq!(answer.status, 200, "{}: {}", path.display(), answer.text());
        let features = studio.ask("GET", "/api/shapes/1/features", b"");
        let posed = studio.ask("POST", "/api/shapes/1/pose?of=all", b"{}");
        let expected = if path.ends_with("wire.obj") { 200 } else { 400 };
        assert_eq!(posed.status, expected, "{}: {}", path.display(), posed.text());
        assert_eq!(features.status, expected, "{}: {}", path.display(), features.text());
    }
}
