//! Responses to the page compared with the library; saved files compared with a replay of the recipe.

use crate::client::{Studio, opened};
use adwave::bands::{BandsParams, Schedule};
use adwave::features::{FeatureParams, ShapeCoordinates, coordinate_features, feature_extent};
use adwave::filter::Edit;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::positions::constrain_positions;
use adwave::region::Region;
use adwave::sample::Sample;
use adwave::shape::Shape;
use adwave::{Decomposer, LevelSpec, Progress};
use adwave_deform::{Clones, DeformError, bind_pose, set_pose};
use adwave_io::{
    Pose, ReadLimits, ShapeFile, parse_recipe, read_path, region_field, write_bytes, write_path,
};
use adwave_studio::StudioInput;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Writes a creature to a temporary folder.
pub(crate) fn creature(folder: &TempDir, n_vertices: usize) -> PathBuf {
    let sample = Sample::from_name("creature", Some(n_vertices)).unwrap();
    let path = folder.path().join("creature.ply");
    write_path(&ShapeFile::from_mesh(sample.points, sample.faces), &path, None).unwrap();
    path
}

pub(crate) fn layer(gains: &[f64], region: &Value) -> Value {
    json!({"name": "a layer", "on": true, "opacity": 1.0, "gains": gains, "region": region})
}

pub(crate) fn edit(revision: u64, layers: &[Value]) -> Value {
    json!({"revision": revision, "layers": layers, "along": null, "border": "natural", "volume": "free",
        "clones": [], "pose": null, "turned": [], "fields": []})
}

/// Carries positions into a pose by a deformation that was never bound before.
fn posed(decomposer: &Decomposer, pose: &Pose, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let vertices = |region: &Region| {
        let weights = region.weights(decomposer.metric(), &|_| None, &[], Progress::none()).unwrap();
        let weights = weights.to_vertices(decomposer.vertex_map());
        Ok::<_, DeformError>((0..).zip(&weights).filter(|(_, w)| **w > 0.0).map(|(v, _)| v).collect())
    };
    let mut deformer = bind_pose(decomposer, pose, None, vertices, Progress::none()).unwrap();
    set_pose(&mut deformer, pose).unwrap();
    deformer.solve(Progress::none()).unwrap();
    let mut carried = points.to_vec();
    deformer.carried_into(points, &mut carried);
    carried
}

/// Applies a recipe to a file, like `adwave filter --recipe`.
pub(crate) fn replayed(path: &Path, recipe: &str) -> Vec<u8> {
    let recipe = parse_recipe(recipe).unwrap();
    let StudioInput { mut file, shape, .. } = opened(path);
    let decomposer = Decomposer::new(&shape);
    let LevelSpec::Dyadic(n_levels) = recipe.levels else { panic!("{:?}", recipe.levels) };
    let points = shape.points().unwrap();
    let schedule = Schedule::dyadic(n_levels).unwrap();
    let mut editor = decomposer.request(points.as_flattened(), 3, &schedule).editor().unwrap();
    let field = |name: &str| region_field(&file, &decomposer, name);
    editor.set_edit(&Edit::new(&recipe.layers).with_fields(&field, &[])).unwrap();
    let edited = editor.into_edited().as_chunks().0.to_vec();
    let mut edited =
        constrain_positions(&decomposer, points, edited, &recipe.positions, Progress::none()).unwrap();
    if !recipe.clones.is_empty() {
        let mut clones = Clones::new(&decomposer, Progress::none()).unwrap();
        clones.set(&recipe.clones, Progress::none()).unwrap();
        clones.add_to(&mut edited);
    }
    if let Some(pose) = &recipe.pose {
        edited = posed(&decomposer, pose, &edited);
    }
    file.set_points(edited).unwrap();
    let mut bytes = Vec::new();
    write_bytes(&file, file.format().unwrap(), &mut bytes).unwrap();
    bytes
}

#[test]
fn a_saved_shape_has_the_bytes_of_its_recipe_replayed() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 6000);
    let studio = Studio::on(&path, folder.path());
    let stroke = json!({"painted": [
        {"add": {"vertices": {"indices": [5, 9, 300], "radius": 0.3, "falloff": 0.1}}},
        {"subtract": {"faded": {"factor": 0.5, "region": {"vertices": {"indices": [9], "radius": "4%"}}}}},
    ]});
    let gains = [2.0, 1.5, 1.25, 1.0, 1.0, 0.5, 1.0, 1.0];
    let layers = [
        layer(&gains, &Value::Null),
        json!({"name": "brush", "on": true, "opacity": 0.3, "gains": [0, 0, 0, 1, 1, 1, 1, 1], "region": stroke}),
        json!({"name": "off", "on": false, "opacity": 1.0, "gains": [9, 9, 9, 9, 9, 9, 9, 9], "region": null}),
    ];
    let moved = studio.put("/api/shapes/1/edit", &edit(1, &layers)).json();
    assert_eq!(moved["revision"], 1);
    assert!(moved["greatest"].as_f64().unwrap() > 0.0 && moved["volume"][1].as_f64().unwrap() > 0.0);
    let recipe = studio.get("/api/shapes/1/recipe").text();
    let saved = studio.post("/api/shapes/1/save", &json!({})).json();
    let saved = Path::new(saved["path"].as_str().unwrap());
    assert_eq!(saved, folder.path().join("creature-edited.ply"));
    let bytes = std::fs::read(saved).unwrap();
    assert_eq!(bytes, replayed(&path, &recipe));
    assert_eq!(studio.get("/api/shapes/1/download?format=ply").body, bytes);
    // Data of the page: positions, the sum of the bands, and the exact result.
    let info = studio.get("/api/shapes/1").json();
    let center = &info["center"];
    let exact = read_path(saved, &ReadLimits::default()).unwrap();
    let shown = studio.get("/api/shapes/1/exact").floats();
    for (x, p) in exact.points().iter().enumerate() {
        for c in 0..3 {
            assert_eq!(shown[3 * x + c], (p[c] - center[c].as_f64().unwrap()) as f32, "vertex {x}");
        }
    }
    let finished = studio.end();
    let edited = finished.edited_file().unwrap().unwrap();
    assert_eq!((finished.recipe, edited.points(), finished.is_done), (recipe, exact.points(), false));
}

#[test]
fn bands_come_coarse_first_and_say_what_a_gain_does() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 4000);
    let studio = Studio::on(&path, folder.path());
    let n = opened(&path).file.n_vertices();
    let before = studio.get("/api/shapes/1/positions").floats();
    assert_eq!(before.len(), 3 * n);
    let triangles = studio.get("/api/shapes/1/triangles").body;
    assert!(triangles.as_chunks().0.iter().all(|b| (u32::from_le_bytes(*b) as usize) < n));
    let levels = studio.put("/api/shapes/1/levels", &json!({"levels": 5})).json();
    assert_eq!(levels["levels"].as_array().unwrap().len(), 5);
    let bands = studio.get("/api/shapes/1/bands").body;
    let size = 8 + 8 * n;
    assert_eq!(bands.len(), 5 * size);
    for (k, level) in (1..=5_u32).rev().enumerate() {
        let band = &bands[k * size..][..size];
        assert_eq!(u32::from_le_bytes(band[..4].try_into().unwrap()), level);
        let scale = f32::from_le_bytes(band[4..8].try_into().unwrap());
        let mut gains = vec![1.0; 5];
        gains[level as usize - 1] = 2.0;
        let revision = u64::from(6 - level);
        studio.put("/api/shapes/1/edit", &edit(revision, &[layer(&gains, &Value::Null)]));
        let after = studio.get("/api/shapes/1/exact").floats();
        for x in 0..n {
            for c in 0..3 {
                let at = 8 + 8 * x + 2 * c;
                let w = scale * f32::from(i16::from_le_bytes(band[at..at + 2].try_into().unwrap()));
                let moved = after[3 * x + c] - before[3 * x + c];
                assert!(
                    (moved - w).abs() <= 0.6 * scale + 3e-7,
                    "level {level}, vertex {x}: {moved}, not {w}"
                );
            }
        }
    }
}

#[test]
fn an_edit_is_there_again_on_the_next_visit() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let kept = folder.path().join("kept/here");
    let studio = Studio::on(&path, &kept);
    assert_eq!(studio.get("/api/shapes/1").json()["resumed"], false);
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let document = edit(3, &[layer(&vec![0.25; n_levels], &Value::Null)]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    // An edit that is not newer is rejected with the stored one; an identical edit is accepted.
    let stale = studio.put("/api/shapes/1/edit", &edit(3, &[]));
    assert_eq!((stale.status, &stale.json()["edit"]), (409, &document));
    assert!(stale.error().contains("revision 3"));
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    let exact = studio.get("/api/shapes/1/exact").body;
    studio.end();
    let again = Studio::on(&path, &kept);
    assert_eq!(again.get("/api/shapes/1").json()["resumed"], true);
    assert_eq!(again.get("/api/shapes/1/edit").json(), document);
    assert_eq!(again.get("/api/shapes/1/exact").body, exact);
    again.end();
    // Another shape at the same path does not resume the edit.
    creature(&folder, 2500);
    let other = Studio::on(&path, &kept);
    assert_eq!(other.get("/api/shapes/1").json()["resumed"], false);
}

#[test]
fn features_without_a_threshold_are_the_significant_ones_of_the_surface() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let studio = Studio::on(&path, folder.path());
    let found = studio.get("/api/shapes/1/features").json();
    let bands = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let file = opened(&path).file;
    let shape = file.to_shape_as(file.kind()).unwrap();
    let surface = OperatorParams::default().with_kind(OperatorKind::Surface);
    let decomposer = Decomposer::with_params(&shape, &surface, Progress::none()).unwrap();
    let levels = LevelSpec::Default.resolve(&decomposer, feature_extent(&decomposer)).unwrap();
    let coordinates = ShapeCoordinates {
        points: file.points(),
        normals: None,
        schedule: &levels.schedule,
        bands: BandsParams::default().with_accuracy(decomposer.analysis_accuracy()),
    };
    let params = FeatureParams::default();
    let expected =
        coordinate_features(&decomposer, &coordinates, &params, Progress::none()).unwrap().features;
    let found = found.as_array().unwrap();
    assert!(expected.len() > 5 && found.len() == expected.len(), "{} {}", found.len(), expected.len());
    for (feature, expected) in found.iter().zip(&expected) {
        assert_eq!(feature["vertex"], expected.vertex);
        assert_eq!(feature["sigma"], expected.sigma);
        assert!((1..=bands as u64).contains(&feature["level"].as_u64().unwrap()));
    }
}

#[test]
fn recipes_weights_fields_features_and_other_shapes() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let studio = Studio::on(&path, folder.path());
    let n = opened(&path).file.n_vertices();
    let text = "lengths = [0.05, '3%']\n[[layer]]\ngains = [2.0, 0.5]\nregion = 'ball:vertex=7,radius=10%'\n";
    let told = studio.ask("PUT", "/api/shapes/1/recipe", text.as_bytes()).json();
    assert_eq!(told["levels"].as_array().unwrap().len(), 2, "{told}");
    assert_eq!(told["edit"]["layers"][0]["gains"], json!([2.0, 0.5]));
    let again = parse_recipe(&studio.get("/api/shapes/1/recipe").text()).unwrap();
    assert_eq!(again.layers, parse_recipe(text).unwrap().layers);
    let region = json!({"vertices": {"indices": [7], "radius": "10%"}});
    let weights = studio.post("/api/shapes/1/weights", &region).body;
    assert_eq!((weights.len(), weights[7]), (n, 255));
    assert!(weights.iter().filter(|&&w| w > 0).count() > 5);
    studio.put("/api/shapes/1/levels", &json!({"levels": 6}));
    for name in ["change", "saliency", "mean-curvature", "band-3"] {
        let field = studio.get(&format!("/api/shapes/1/field?name={name}"));
        assert!(field.head.contains("x-field: {"), "{}", field.head);
        let values = field.floats();
        assert!(values.len() == n && values.iter().all(|v| v.is_finite()), "{name}");
    }
    let features = studio.get("/api/shapes/1/features?theta=1.2").json();
    assert!(!features.as_array().unwrap().is_empty());
    let clean = studio.post("/api/shapes/1/denoise", &json!({"strength": 1.0})).json();
    assert!(clean["noise"].as_f64().unwrap() >= 0.0);
    let dropped =
        studio.ask("POST", "/api/shapes?name=a%2Fb.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").json();
    let list = studio.get("/api/shapes").json();
    assert_eq!(list["shapes"].as_array().unwrap().len(), 3);
    let id = dropped["id"].as_u64().unwrap();
    assert_eq!(studio.get(&format!("/api/shapes/{id}")).json()["n_triangles"], 1);
    assert_eq!(studio.ask("DELETE", &format!("/api/shapes/{id}"), b"").status, 200);
    assert_eq!(studio.ask("GET", &format!("/api/shapes/{id}"), b"").status, 404);
    assert_eq!(studio.post("/api/done", &json!({})).status, 200);
    assert!(studio.finished().is_done);
}

#[test]
fn a_studio_that_ends_does_not_wait_for_bands() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 200_000);
    let studio = Studio::on(&path, folder.path());
    let asked = std::time::Instant::now();
    let finished = studio.end();
    assert!(asked.elapsed() < std::time::Duration::from_secs(3), "{:?}", asked.elapsed());
    assert_eq!(finished.edited_file().unwrap().unwrap().points(), opened(&path).file.points());
    parse_recipe(&finished.recipe).unwrap();
}

#[test]
fn clouds_and_shapes_of_a_few_vertices_open_too() {
    let folder = TempDir::new().unwrap();
    for (name, text) in [("one.xyz", "1 2 3\n"), ("three.xyz", "0 0 0\n1 0 0\n0 1 0\n")] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let studio = Studio::on(&path, folder.path());
        let info = studio.get("/api/shapes/1").json();
        assert_eq!((&info["kind"], &info["n_triangles"]), (&json!("cloud"), &json!(0)), "{name}");
        let n_levels = info["levels"].as_array().unwrap().len();
        let document = edit(1, &[layer(&vec![0.0; n_levels], &Value::Null)]);
        assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200, "{name}");
        assert!(studio.get("/api/shapes/1/exact").floats().iter().all(|v| v.is_finite()));
    }
}

#[test]
fn what_is_wrong_is_said_in_one_line_and_changes_nothing() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 2000);
    let studio = Studio::on(&path, folder.path());
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let ones = vec![1.0; n_levels];
    let bad_layer = |layer: Value| edit(9, &[layer]);
    let mut long = ones.clone();
    long.push(1.0);
    for (document, said) in [
        (json!({"revision": 9, "layer": []}), "unknown field"),
        (bad_layer(layer(&long, &Value::Null)), "gains for"),
        (
            bad_layer(layer(&ones, &json!({"ball": {"center": {"vertex": 99999}, "radius": 1}}))),
            "vertex 99999",
        ),
        (bad_layer(layer(&ones, &json!({"field": {"name": "nothing"}}))), "'nothing'"),
        (
            bad_layer(json!({"name": "", "on": true, "opacity": 7.0, "gains": ones})),
            "opacity must be in [0, 1], got 7",
        ),
        (bad_layer(layer(&vec![1e308; n_levels], &json!({"balloon": {}}))), "unknown variant"),
    ] {
        let refused = studio.put("/api/shapes/1/edit", &document);
        assert_eq!(refused.status, 400, "{}", refused.text());
        assert!(refused.error().contains(said), "{said}: {}", refused.error());
    }
    assert_eq!(studio.get("/api/shapes/1/edit").json()["revision"], 0);
    // Gains with an overflowing result are rejected, and the previous edit and positions stay.
    let good = edit(1, &[layer(&vec![2.0; n_levels], &Value::Null)]);
    assert_eq!(studio.put("/api/shapes/1/edit", &good).status, 200);
    let exact = studio.get("/api/shapes/1/exact").body;
    for gain in [1e60, 1e308] {
        let refused =
            studio.put("/api/shapes/1/edit", &edit(2, &[layer(&vec![gain; n_levels], &Value::Null)]));
        assert_eq!(refused.status, 400, "{gain}: {}", refused.text());
        assert!(refused.error().contains("smaller gains"), "{gain}: {}", refused.error());
        assert_eq!(studio.get("/api/shapes/1/edit").json(), good);
        assert_eq!(studio.get("/api/shapes/1/exact").body, exact);
    }
    for (method, at, body, status, said) in [
        ("PUT", "levels", "{\"levels\": 0}", 400, "level"),
        ("PUT", "levels", "{\"lengths\": [-1]}", 400, "length"),
        ("PUT", "recipe", "layer = 3", 400, "line"),
        ("PUT", "recipe", "field = 'color'", 400, "color"),
        ("POST", "weights", "[", 400, "invalid region"),
        ("POST", "save", "{\"name\": \"../up.ply\"}", 400, "without folders"),
        ("POST", "save", "{\"name\": \"/etc/up.ply\"}", 400, "without folders"),
        ("POST", "save", "{\"name\": \"creature.ply\"}", 400, "is the file that was opened"),
        ("POST", "save", "{\"name\": \"creature.doc\"}", 400, "known format"),
        ("POST", "denoise", "{\"strength\": -3}", 400, "strength"),
        ("GET", "field?name=../secret", "", 400, "has no field"),
        ("GET", "field?name=other.npy", "", 400, "has no field"),
        ("GET", "features?theta=much", "", 400, "theta"),
        ("GET", "download?format=doc", "", 400, "'doc'"),
        ("GET", "nothing", "", 404, "not found"),
    ] {
        let refused = studio.ask(method, &format!("/api/shapes/1/{at}"), body.as_bytes());
        assert_eq!(refused.status, status, "{at}: {}", refused.text());
        assert!(refused.error().contains(said), "{at}: {}", refused.error());
    }
    let there = folder.path().join("there.ply");
    std::fs::write(&there, "mine").unwrap();
    let refused = studio.post("/api/shapes/1/save", &json!({"name": "there.ply"}));
    assert_eq!((refused.status, &refused.json()["exists"]), (409, &json!(true)));
    assert_eq!(std::fs::read(&there).unwrap(), b"mine");
    assert_eq!(studio.post("/api/shapes/1/save", &json!({"name": "there.ply", "replace": true})).status, 200);
    let refused = studio.ask("POST", "/api/shapes?name=a.obj", b"");
    assert_eq!(refused.status, 400);
    assert!(refused.error().contains("a.obj"), "{}", refused.error());
    let shape = opened(&path);
    assert!(matches!(shape.shape, Shape::Mesh(_)));
}

#[test]
fn distances_are_measured_on_the_surface_that_the_page_is_given() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let studio = Studio::on(&path, folder.path());
    let body = studio.get("/api/shapes/1/surface").body;
    let StudioInput { shape, .. } = opened(&path);
    let (points, map) = (shape.points().unwrap(), Decomposer::new(&shape).vertex_map().clone());
    let (positions, places) = body.split_at(24 * points.len());
    let positions: Vec<f64> = positions.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect();
    let places: Vec<u32> = places.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
    assert_eq!((positions, places.as_slice()), (points.as_flattened().to_vec(), map.as_slice()));
}

#[test]
fn regions_are_made_of_the_surface_its_fields_and_each_other() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 3000), folder.path());
    let mask = |region: Value| studio.post("/api/shapes/1/weights", &region);
    let half = json!({"half-space": {"point": [0, 0, 0], "normal": [1, 0, 0], "falloff": 0}});
    let count = |region: Value| {
        let answer = mask(region);
        assert_eq!(answer.status, 200, "{}", answer.text());
        answer.body.iter().map(|w| usize::from(*w)).sum::<usize>()
    };
    let [there, more, less] = [
        half.clone(),
        json!({"grown": {"by": "3%", "region": half}}),
        json!({"not": {"grown": {"by": "3%", "region": {"not": half}}}}),
    ]
    .map(count);
    assert!(less < there && there < more);
    let n = studio.get("/api/shapes/1").json()["n_vertices"].as_u64().unwrap() as usize;
    assert_eq!(count(json!({"component": {"vertex": 7}})), 255 * n);
    let front = json!({"facing": {"direction": [0, 0, 1], "falloff": 0.2}});
    assert!((80 * n..160 * n).contains(&count(front.clone())));
    let brush = json!({"vertices": {"indices": [3], "radius": "40%"}});
    let smoothed =
        json!({"painted": [{"add": half}, {"smooth": {"region": {"all": [brush, front]}, "by": "2%"}}]});
    assert!(mask(smoothed).body.iter().any(|w| (20..235).contains(w)));
    // Fields of regions belong to the original shape, with the range that the page receives.
    for name in ["saliency", "mean-curvature", "band-2"] {
        let values = studio.get(&format!("/api/shapes/1/field?of=region&name={name}")).floats();
        let (low, high) = values.iter().fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
        let weights = mask(json!({"field": {"name": name, "low": low, "high": high}})).body;
        for (value, weight) in values.iter().zip(weights) {
            let expected = 255.0 * (value - low) / (high - low);
            assert!((f32::from(weight) - expected).abs() < 0.6, "{name}: {weight} for {expected}");
        }
    }
    assert!(mask(json!({"field": {"name": "heat"}})).error().contains("heat"));
}

#[test]
fn a_recipe_with_regions_of_the_shape_itself_is_replayed_to_the_same_bits() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let studio = Studio::on(&path, folder.path());
    let saliency = json!({"field": {"name": "saliency", "low": 0, "high": 0.001}});
    let region = json!({"grown": {"by": "1%", "region": {"blurred": {"by": "1%", "region": saliency}}}});
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let moved = studio.put("/api/shapes/1/edit", &edit(1, &[layer(&vec![2.0; n_levels], &region)])).json();
    assert!(moved["greatest"].as_f64().unwrap() > 0.0, "{moved}");
    let recipe = studio.get("/api/shapes/1/recipe").text();
    let saved = studio.post("/api/shapes/1/save", &json!({})).json();
    let bytes = std::fs::read(saved["path"].as_str().unwrap()).unwrap();
    assert_eq!(bytes, replayed(&path, &recipe));
}

#[test]
fn other_levels_keep_the_edit_by_width_and_can_be_taken_back() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 3000), folder.path());
    let before = studio.get("/api/shapes/1").json();
    let n_levels = before["levels"].as_array().unwrap().len();
    let mut gains = vec![1.0; n_levels];
    (gains[0], gains[n_levels - 1]) = (0.25, 3.0);
    let document = edit(1, &[layer(&gains, &Value::Null)]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    let two_an_octave = json!({"levels": n_levels, "voices": 2});
    let told = studio.put("/api/shapes/1/levels", &two_an_octave).json();
    let mapped = told["edit"]["layers"][0]["gains"].as_array().unwrap();
    assert_eq!((mapped.len(), told["levels"].as_array().unwrap().len()), (2 * n_levels - 1, mapped.len()));
    assert_eq!((&mapped[0], mapped.last().unwrap()), (&json!(0.25), &json!(3.0)), "{told}");
    assert_eq!(told["choice"]["steps"].as_array().unwrap().len(), mapped.len());
    let back = studio.put("/api/shapes/1/levels", &before["choice"]).json();
    assert_eq!((&back["levels"], &back["edit"]), (&before["levels"], &document));
    let mixed = studio.put("/api/shapes/1/levels", &json!({"steps": [1, 2], "levels": 2}));
    assert_eq!(mixed.status, 400);
    assert!(mixed.error().contains("give one"), "{}", mixed.error());
}

#[test]
fn bands_that_are_computed_block_nothing_and_can_be_cancelled() {
    let folder = TempDir::new().unwrap();
    let studio = Studio::on(&creature(&folder, 100_000), folder.path());
    let before = studio.get("/api/shapes/1").json()["levels"].clone();
    // Dropping the connection cancels the computation.
    {
        let mut stream = std::net::TcpStream::connect(&studio.host).unwrap();
        let body = "{\"levels\": 16}";
        let request = format!(
            "PUT /api/shapes/1/levels HTTP/1.1\r\nHost: {}\r\nAuthorization: Bearer {}\r\nContent-Length: {}\r\n\r\n{body}",
            studio.host,
            studio.token,
            body.len()
        );
        std::io::Write::write_all(&mut stream, request.as_bytes()).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(100));
        let n_levels = before.as_array().unwrap().len();
        let document = edit(1, &[layer(&vec![0.5; n_levels], &Value::Null)]);
        assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    }
    std::thread::sleep(std::time::Duration::from_millis(1500));
    assert_eq!(studio.get("/api/shapes/1").json()["levels"], before);
}

#[test]
fn names_of_fields_arrive_in_any_language() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("dicke.ply");
    let sample = Sample::from_name("creature", Some(2000)).unwrap();
    let mut file = ShapeFile::from_mesh(sample.points, sample.faces);
    let values = (0..file.n_vertices()).map(|v| v as f32).collect::<Vec<_>>();
    file.add_vertex_field(adwave_io::Field::new("Höhe_高", 1, adwave_io::FieldValues::F32(values))).unwrap();
    write_path(&file, &path, None).unwrap();
    let studio = Studio::on(&path, folder.path());
    let listed = studio.get("/api/shapes/1").json()["fields"].as_array().unwrap().last().unwrap().clone();
    assert_eq!(listed["label"], "Höhe_高");
    let field = studio.get("/api/shapes/1/field?name=H%C3%B6he_%E9%AB%98");
    let header = field.head.lines().find_map(|line| line.strip_prefix("x-field: ")).unwrap();
    assert!(header.is_ascii(), "{header}");
    // The client of this test changes heads to lower case.
    assert_eq!(serde_json::from_str::<Value>(header).unwrap()["label"], "höhe_高");
}

#[test]
fn fields_of_other_files_color_the_shape_and_select_regions_and_are_there_again() {
    let folder = TempDir::new().unwrap();
    let path = creature(&folder, 3000);
    let kept = folder.path().join("kept");
    let studio = Studio::on(&path, &kept);
    let n = opened(&path).file.n_vertices();
    let table = |n: usize| (0..n).map(|v| v.to_string()).collect::<Vec<_>>().join("\n");
    let refused = studio.ask("POST", "/api/shapes/1/fields?name=short.csv", table(3).as_bytes());
    assert_eq!(refused.status, 400);
    assert!(refused.error().contains("short.csv needs one row per vertex"), "{}", refused.error());
    let hidden = studio.ask("POST", "/api/shapes/1/fields?name=.csv", table(n).as_bytes());
    assert_eq!(hidden.status, 400);
    let added = studio.ask("POST", "/api/shapes/1/fields?name=a%2Fheat.csv", table(n).as_bytes());
    assert_eq!(added.json(), json!({"fields": ["heat"]}), "{}", added.text());
    let values = studio.get("/api/shapes/1/field?name=heat").floats();
    assert_eq!((values.len(), values[7]), (n, 7.0));
    let region = json!({"field": {"name": "heat", "low": 0, "high": n - 1}});
    let n_levels = studio.get("/api/shapes/1").json()["levels"].as_array().unwrap().len();
    let document = edit(1, &[layer(&vec![0.0; n_levels], &region)]);
    assert_eq!(studio.put("/api/shapes/1/edit", &document).status, 200);
    studio.end();
    let again = Studio::on(&path, &kept);
    assert_eq!(again.get("/api/shapes/1/edit").json()["layers"][0]["region"]["field"]["name"], "heat");
    let fields = again.get("/api/shapes/1").json()["fields"].clone();
    assert!(fields.as_array().unwrap().iter().any(|field| field["name"] == "heat"), "{fields}");
}

#[test]
fn colors_of_a_file_are_sent_as_bytes() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("colored.ply");
    let sample = Sample::from_name("creature", Some(2000)).unwrap();
    let mut file = ShapeFile::from_mesh(sample.points, sample.faces);
    let values = (0..file.n_vertices()).flat_map(|v| [0, (v % 200) as u8, 255]).collect();
    file.add_vertex_field(adwave_io::Field::new("color", 3, adwave_io::FieldValues::U8(values))).unwrap();
    write_path(&file, &path, None).unwrap();
    let studio = Studio::on(&path, folder.path());
    let fields = studio.get("/api/shapes/1").json()["fields"].clone();
    assert!(fields.as_array().unwrap().iter().any(|field| field["name"] == "color" && field["rgb"] == true));
    let colors = studio.get("/api/shapes/1/field?name=color").body;
    assert_eq!((colors.len(), &colors[4 * 150..][..4]), (4 * file.n_vertices(), &[0, 150, 255, 255][..]));
}
