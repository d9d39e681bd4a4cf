//! Saliency, features and evaluation by the command line: what they write, and what they refuse.

use crate::common;

use adwave_io::{FieldValues, ReadLimits, read_npy, read_path};
use adwave_test_data::data_test;
use common::{json, real_files, refused};
use std::fs;
use std::path::Path;

/// A folder with a torus of a few hundred vertices.
fn torus() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    json(folder.path(), "sample knot --vertices 3000 --noise 0.2 -o a.ply");
    folder
}

fn n_vertices(folder: &Path) -> usize {
    read_path(&folder.join("a.ply"), &ReadLimits::default()).unwrap().n_vertices()
}

#[test]
fn a_map_is_written_with_its_colors_or_as_an_array() {
    /// Points along a side of a flat square.
    const N: usize = 40;
    let folder = torus();
    let n = n_vertices(folder.path());
    let report = json(
        folder.path(),
        "saliency a.ply -o map.ply --levels 6 --weighting paper --per-level --color-map magma",
    );
    let written = read_path(&folder.path().join("map.ply"), &ReadLimits::default()).unwrap();
    let map = written.field("saliency").unwrap().to_f64();
    assert_eq!(map.len(), n);
    assert!(map.iter().all(|v| *v >= 0.0) && map.iter().any(|v| *v > 0.0));
    let at = report["largest_vertex"].as_u64().unwrap() as usize;
    assert_eq!(map[at], map.iter().copied().fold(0.0, f64::max));
    let colors = written.field("color").unwrap();
    assert!(matches!(colors.values, FieldValues::U8(_)) && colors.n_channels == 3);
    // The largest value has the last color of magma, a pale yellow.
    assert!(colors.get(at, 0) > 240.0 && colors.get(at, 1) > 240.0);
    let parts = (3..=6).map(|j| written.field(&format!("saliency{j}")).unwrap().get(at, 0));
    assert!((parts.sum::<f64>() - map[at]).abs() < 1e-12 * map[at]);
    json(folder.path(), "saliency a.ply -o map.npy --levels 6 --weighting paper --per-level");
    let array = read_npy(&folder.path().join("map.npy"), &ReadLimits::default()).unwrap();
    assert_eq!(array.shape, [n, 5]);
    assert_eq!(array.values.get(5 * at), map[at]);
    json(folder.path(), "saliency a.ply -o map.vtp --field mean-curvature --weighting ranks");
    // All that stands out of a flat plane is its border.
    let mut flat = format!("OFF\n{} {} 0\n", N * N, (N - 1) * (N - 1));
    for x in 0..N * N {
        flat += &format!("{} {} 0\n", x / N, x % N);
    }
    for x in (0..N * (N - 1)).filter(|x| x % N + 1 < N) {
        flat += &format!("4 {x} {} {} {}\n", x + N, x + N + 1, x + 1);
    }
    fs::write(folder.path().join("flat.off"), flat).unwrap();
    let edge = |flags: &str| {
        let line = format!("saliency flat.off -o edge.npy --levels 6 --weighting none{flags}");
        json(folder.path(), &line)["largest"].as_f64().unwrap()
    };
    assert!(edge(" --border 1") < 0.1 * edge(""));
}

#[test]
fn a_map_of_coordinates_says_which_side_is_outside_and_is_red_where_convex() {
    let folder = torus();
    let report = json(folder.path(), "saliency a.ply -o map.ply --levels 6 --operator walk");
    assert_eq!(report["sides"]["signed"], true);
    assert_eq!(report["sides"]["outside"]["how"], "outside by the volume enclosed");
    let written = read_path(&folder.path().join("map.ply"), &ReadLimits::default()).unwrap();
    let (map, colors) = (written.field("saliency").unwrap().to_f64(), written.field("color").unwrap());
    let [most, least] = ["largest_vertex", "smallest_vertex"].map(|k| report[k].as_u64().unwrap() as usize);
    assert!(map[most] > 0.0 && colors.get(most, 0) > colors.get(most, 2), "red at {most}");
    assert!(map[least] < 0.0 && colors.get(least, 2) > colors.get(least, 0), "blue at {least}");
    let unsigned = json(folder.path(), "saliency a.ply -o map.npy --levels 6 --operator walk --unsigned");
    assert_eq!(unsigned["sides"]["signed"], false);
    let array = read_npy(&folder.path().join("map.npy"), &ReadLimits::default()).unwrap();
    assert!((0..map.len()).all(|x| array.values.get(x) >= 0.0 && array.values.get(x) + 1e-9 >= map[x].abs()));
    let up = json(folder.path(), "saliency a.ply -o up.npy --levels 6 --up z");
    assert!(up["largest"].as_f64().unwrap() <= 1.0 && up["sides"]["signed"] == false);
}

#[test]
fn a_flat_sheet_has_no_outside_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("f.off"), "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n")
        .unwrap();
    let report = json(folder.path(), "saliency f.off -o m.npy --levels 4");
    assert_eq!(
        (&report["sides"]["signed"], &report["sides"]["outside"]["found"]),
        (&false.into(), &false.into())
    );
    assert!(report["sides"]["outside"]["how"].as_str().unwrap().starts_with("no side is outside"));
}

#[test]
fn features_are_written_in_every_way_alike() {
    let folder = torus();
    let flags = "--levels 7 --theta 1.5 --field mean-curvature --response literal --refine --edge-ratio 20";
    let report = json(folder.path(), &format!("features a.ply {flags} -o f.json --descriptors"));
    let features = report["features"].as_array().unwrap();
    assert!(!features.is_empty());
    assert_eq!(features[0]["descriptor"].as_array().unwrap().len(), adwave::features::DESCRIPTOR_LENGTH);
    let saved: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("f.json")).unwrap()).unwrap();
    assert_eq!(saved["features"], report["features"]);
    json(folder.path(), &format!("features a.ply {flags} -o f.csv"));
    let csv = fs::read_to_string(folder.path().join("f.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + features.len());
    let row: Vec<&str> = csv.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(row[0].parse::<u64>().unwrap(), features[0]["vertex"].as_u64().unwrap());
    // Reading a decimal of JSON may be off by the last bit.
    let ratio = row[5].parse::<f64>().unwrap() / features[0]["sigma"].as_f64().unwrap();
    assert!((ratio - 1.0).abs() < 1e-15);
    json(folder.path(), &format!("features a.ply {flags} -o f.ply"));
    let spheres = read_path(&folder.path().join("f.ply"), &ReadLimits::default()).unwrap();
    assert_eq!(spheres.n_vertices(), 42 * features.len());
    let center = &features[0]["position"];
    let sigma = features[0]["sigma"].as_f64().unwrap();
    for p in &spheres.points()[..42] {
        let square: f64 = (0..3).map(|c| (p[c] - center[c].as_f64().unwrap()).powi(2)).sum();
        assert!((square.sqrt() / sigma - 1.0).abs() < 1e-6);
    }
    let fewer = json(folder.path(), &format!("features a.ply {flags} --best 3"));
    assert!(fewer["features"].as_array().unwrap().len() <= 3);
}

#[test]
fn fields_come_from_tables_arrays_colors_and_textures() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fs::write(
        at.join("s.obj"),
        "mtllib s.mtl\nusemtl m\nv 0 0 0 1 1 1\nv 1 0 0 0 0 0\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\nvt 0.1 0.5\nvt 0.9 0.5\n\
         f 1/1 2/2 3/2\nf 1/1 3/2 4/1\n",
    )
    .unwrap();
    fs::write(at.join("s.mtl"), "newmtl m\nmap_Kd p.png\n").unwrap();
    let mut picture = image::RgbImage::new(10, 2);
    for (x, _, pixel) in picture.enumerate_pixels_mut() {
        *pixel = image::Rgb(if x < 5 { [255; 3] } else { [0; 3] });
    }
    picture.save(at.join("p.png")).unwrap();
    fs::write(at.join("bare.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(at.join("t.csv"), "depth,gaze\n1,5\n0,5\n0,5\n1,5\n").unwrap();
    // The same signal four times: white on the left, black on the right.
    let expected = json(at, "transform s.obj -o w.npz --levels 3 --field t.csv:depth")["energy"].clone();
    for field in ["luminance", "texture-luminance"] {
        let found =
            json(at, &format!("transform s.obj -o w.npz --levels 3 --field {field}"))["energy"].clone();
        for (a, b) in expected.as_array().unwrap().iter().zip(found.as_array().unwrap()) {
            assert!((a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-12, "{field}");
        }
    }
    // A JPEG is sampled the same, but for what its compression loses.
    picture.save(at.join("p.jpg")).unwrap();
    let with_jpeg = |name: &str| {
        fs::read_to_string(at.join(name)).unwrap().replace("s.mtl", "j.mtl").replace("p.png", "p.jpg")
    };
    for (name, copy) in [("s.obj", "j.obj"), ("s.mtl", "j.mtl")] {
        fs::write(at.join(copy), with_jpeg(name)).unwrap();
    }
    let found = json(at, "transform j.obj -o w.npz --levels 3 --field texture-luminance")["energy"].clone();
    for (a, b) in expected.as_array().unwrap().iter().zip(found.as_array().unwrap()) {
        assert!((a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 0.05, "{a} {b}");
    }
    assert_eq!(json(at, "transform s.obj -o w.npz --field t.csv")["channels"], 2);
    json(at, "saliency s.obj -o m.ply --field texture-lightness --texture p.png");
    json(at, "transform s.obj -o t.npz --levels 3 --field texture-lightness --texture p.png");
    for (line, words) in [
        ("saliency s.obj -o m.ply --field t.csv:width", "depth, gaze"),
        ("saliency s.obj -o m.ply --field texture --texture gone.png", "gone.png"),
        ("saliency s.obj -o m.ply --texture p.png", "needs the signal texture"),
        ("saliency sample:sphere --vertices 100 -o m.ply --field texture", "from a file"),
        ("saliency bare.obj -o n.ply --field texture", "UVs"),
        ("saliency bare.obj -o n.ply --field texture --texture p.png", "UVs"),
    ] {
        let error = refused(at, line);
        assert!(error.contains(words), "{line}: {error}");
    }
}

#[test]
fn nan_is_a_mask() {
    let folder = torus();
    let n = n_vertices(folder.path());
    let values = |x: usize| if x < n / 3 { "NA".to_owned() } else { ((x * 37 % 101) as f64).to_string() };
    let column = |value: &dyn Fn(usize) -> String| (0..n).map(|x| value(x) + "\n").collect::<String>();
    fs::write(folder.path().join("v.csv"), column(&values)).unwrap();
    json(folder.path(), "saliency a.ply -o m.npy --field v.csv --levels 5");
    let map = read_npy(&folder.path().join("m.npy"), &ReadLimits::default()).unwrap().values.to_f64();
    assert!(map.iter().enumerate().all(|(x, v)| v.is_nan() == (x < n / 3)));
    let found = json(folder.path(), "features a.ply --field v.csv --levels 5 --theta 1.2");
    let vertices =
        found["features"].as_array().unwrap().iter().map(|f| f["vertex"].as_u64().unwrap() as usize);
    assert!(vertices.into_iter().all(|x| x >= n / 3));
    fs::write(folder.path().join("none.csv"), column(&|_| "nan".to_owned())).unwrap();
    let error = refused(folder.path(), "saliency a.ply -o m.npy --field none.csv");
    assert!(error.contains("NaN at all"), "{error}");
    fs::write(folder.path().join("short.csv"), "1\n2\n3\n").unwrap();
    let error = refused(folder.path(), "saliency a.ply -o m.npy --field short.csv");
    assert!(error.contains("3 rows") && error.contains(&n.to_string()), "{error}");
}

#[test]
fn evaluation_counts_what_is_found_again_and_compares_maps() {
    let folder = torus();
    let report = json(
        folder.path(),
        "evaluate a.ply --levels 6 --theta 1.5 --field mean-curvature --response literal --percent 10 --runs 1",
    );
    let changes = report["changes"].as_array().unwrap();
    let names: Vec<&str> = changes.iter().map(|c| c["change"].as_str().unwrap()).collect();
    assert_eq!(names, ["noise 10 %", "rotation", "scaling by 7.3", "4 × the faces", "other vertices"]);
    // Rotation and scaling change rounding only.
    for change in &changes[1..3] {
        for level in change["levels"].as_array().unwrap() {
            assert_eq!(level["share"], 1.0);
        }
    }
    json(folder.path(), "saliency a.ply -o looks.npy --levels 6 --weighting ranks");
    let line =
        "evaluate a.ply --levels 6 --weighting ranks --fixations looks.npy --threshold 2 --map looks.npy";
    let report = json(folder.path(), line);
    for map in &report["maps"].as_array().unwrap()[..2] {
        assert!((map["correlation"].as_f64().unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(map["auc"], 1.0);
    }
    assert_eq!(report["maps"][2]["map"], "distance from the center");
}

#[test]
fn what_makes_no_sense_is_refused_in_one_line() {
    let folder = torus();
    for (line, words) in [
        ("features a.ply --theta 0", "θ is 0"),
        ("features a.ply --theta -2", "θ is -2"),
        ("features a.ply --theta nan", "θ is NaN"),
        ("features a.ply --levels 2", "at least 3 levels"),
        ("features a.ply --edge-ratio 0.5", "edge ratio"),
        ("features a.ply -o f.obj", "features are written as .ply, .glb"),
        ("saliency a.ply -o m.obj", ".vtk, .msh, .graphml, .fits, .npy, .csv or .gii"),
        ("saliency a.ply -o m.ply --levels 2 --weighting paper", "skip fewer"),
        ("saliency a.ply -o m.ply --color-map sepia", "viridis"),
        ("saliency a.ply -o m.ply --border -1", "distance from the border is -1"),
        ("features a.ply --border nan", "distance from the border is NaN"),
        ("saliency a.ply -o m.ply --color-top 0", "--color-top"),
        ("saliency a.ply -o m.ply --field density", "cloud"),
        ("saliency a.ply -o m.ply --field luminance", "no colors"),
        ("saliency a.ply -o m.ply --field gone.npy", "gone.npy"),
        (
            "saliency a.ply -o m.ply --field saliency",
            "'adwave saliency SHAPE -o map.ply' writes the shape with it",
        ),
        ("saliency a.ply -o m.png", "`adwave render` makes pictures"),
        (
            "saliency a.ply -o m.ply --field wishes",
            "no field 'wishes'; use coords, x, y, z, normals, mean-curvature",
        ),
        ("evaluate a.ply --against coords", "one channel, got 3"),
        ("evaluate a.ply --percent -10 --levels 5", "noise"),
    ] {
        let error = refused(folder.path(), line);
        assert!(error.contains(words), "{line}: {error}");
    }
}

#[data_test]
fn the_cortex_takes_its_fields_from_other_files() {
    let folder = real_files().join("fields/nilearn-fsaverage5");
    let out = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.join(format!("{name}_left.gii.gz")).display().to_string();
    for field in ["sulc", "curv"] {
        let report =
            json(out.path(), &format!("features '{}' --field '{}' --levels 8", path("infl"), path(field)));
        assert_eq!(report["vertices"], 10242);
        assert!(!report["features"].as_array().unwrap().is_empty(), "{field}");
    }
    let error = refused(out.path(), &format!("saliency '{}' -o m.ply", path("sulc")));
    assert!(error.contains("as a signal of a surface"), "{error}");
}

#[data_test]
fn a_figure_has_features_on_toes_nose_and_knees_and_by_the_rule_of_the_paper_on_wide_ends() {
    const DIAGONAL: f64 = 1.512;
    let folder = real_files().join("paper/libigl-tutorial-data");
    let out = tempfile::tempdir().unwrap();
    let armadillo = folder.join("armadillo.obj").display().to_string();
    // Places of the figure, read off its picture.
    let toes = [[0.325, -0.568, 0.043], [-0.287, -0.568, -0.038]];
    let fingers = [[0.362, 0.173, 0.364], [-0.360, 0.325, 0.288]];
    let others =
        [[0.132, 0.419, 0.203], [-0.160, 0.419, 0.180], [-0.019, 0.187, 0.323], [0.019, -0.295, -0.378]];
    let knees = [[0.255, -0.292, 0.013], [-0.223, -0.330, 0.005]];
    let found = |flags: &str| -> Vec<([f64; 3], f64)> {
        let report = json(out.path(), &format!("features '{armadillo}' {flags}"));
        let features = report["features"].as_array().unwrap().iter();
        features
            .map(|f| ([0, 1, 2].map(|c| f["position"][c].as_f64().unwrap()), f["sigma"].as_f64().unwrap()))
            .collect()
    };
    // A feature as wide as a limb's end, from 2 to 4 % of the diagonal, within its σ.
    let holds = |features: &[([f64; 3], f64)], place: &[f64; 3]| {
        features.iter().any(|(p, sigma)| {
            let distance = (0..3).map(|c| (p[c] - place[c]).powi(2)).sum::<f64>().sqrt();
            distance < *sigma && (0.02..0.04).contains(&(sigma / DIAGONAL))
        })
    };
    // A feature at the place itself, whatever its size.
    let default = found("");
    for place in toes.iter().chain(&fingers).chain(&others).chain(&knees) {
        let distance = |p: &[f64; 3]| (0..3).map(|c| (p[c] - place[c]).powi(2)).sum::<f64>().sqrt();
        assert!(default.iter().any(|(p, _)| distance(p) < 0.03 * DIAGONAL), "{place:?}");
    }
    let (default, lower) = (found("--operator walk"), found("--operator walk --theta 1.8"));
    for place in toes.iter().chain(&fingers).chain(&others) {
        assert!(holds(&default, place), "{place:?}");
    }
    for place in &knees {
        assert!(holds(&lower, place), "{place:?}");
    }
    assert!((60..120).contains(&default.len()), "{}", default.len());
}

/// A sphere as a cloud with normals, each with the sign of its number, in one file.
fn sphere_with_normals(sign: impl Fn(usize) -> f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let sphere = adwave::sample::Sample::from_name("sphere", Some(1500)).unwrap();
    let mut text = "ply\nformat ascii 1.0\n".to_owned();
    text += &format!("element vertex {}\n", sphere.points.len());
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        text += &format!("property float {name}\n");
    }
    text += "end_header\n";
    for (k, [x, y, z]) in sphere.points.iter().enumerate() {
        let s = sign(k);
        text += &format!("{x} {y} {z} {} {} {}\n", s * x, s * y, s * z);
    }
    fs::write(folder.path().join("a.ply"), text).unwrap();
    folder
}

#[test]
fn given_normals_that_disagree_or_point_inward_are_named_once_and_in_json() {
    type Sign<'a> = &'a dyn Fn(usize) -> f64;
    let kinds: [(Sign<'_>, &str, Option<&str>, u64); 3] = [
        (&|k| if k % 2 == 0 { 1.0 } else { -1.0 }, "unoriented", Some("are not oriented"), 0),
        (&|_| -1.0, "as given", Some("point inward"), 1),
        (&|_| 1.0, "as given", None, 0),
    ];
    for (sign, signs, said, n_inward) in kinds {
        let folder = sphere_with_normals(sign);
        let line = "saliency a.ply -o map.npy --levels 5";
        let run = common::adwave(folder.path()).args(common::words(line)).assert().success();
        let errors = String::from_utf8(run.get_output().stderr.clone()).unwrap();
        assert_eq!(errors.matches("given normals").count(), usize::from(said.is_some()), "{errors}");
        assert!(said.is_none_or(|said| errors.contains(said)), "{errors}");
        let report = json(folder.path(), line);
        let given = &report["sides"]["outside"]["given_normals"];
        assert_eq!((&given["signs"], &given["inward_parts"]), (&signs.into(), &n_inward.into()), "{report}");
        assert_eq!(json(folder.path(), "info a.ply")["given_normals"]["signs"], signs);
    }
}

#[test]
fn a_round_cloud_has_no_features_and_says_why() {
    let folder = sphere_with_normals(|_| 1.0);
    let line = "features a.ply --levels 7";
    assert_eq!(json(folder.path(), line)["features"].as_array().unwrap().len(), 0);
    common::adwave(folder.path())
        .args(common::words(line))
        .assert()
        .success()
        .stdout(predicates::str::contains("no features: nothing stands out from what the sampling"));
}
