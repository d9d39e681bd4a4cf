//! What each command does with good input.

use crate::common;

use common::{adwave, json, refused};
use predicates::str::contains;
use std::fs;

#[test]
fn every_command_explains_itself_with_examples() {
    let folder = tempfile::tempdir().unwrap();
    for command in [
        "info",
        "transform",
        "filter",
        "region",
        "denoise",
        "simplify",
        "deform",
        "rebase",
        "transfer",
        "resample",
        "morph",
        "match",
        "diff",
        "saliency",
        "features",
        "evaluate",
        "basis",
        "convert",
        "formats",
        "sample",
    ] {
        adwave(folder.path()).args([command, "--help"]).assert().success().stdout(contains("Examples:"));
    }
    adwave(folder.path()).args(["completions", "bash"]).assert().success().stdout(contains("adwave"));
    for package in ["faer", "epaint_default_fonts"] {
        adwave(folder.path()).arg("notices").assert().success().stdout(contains(package));
    }
    adwave(folder.path()).arg("man").assert().success().stdout(contains(".TH adwave"));
    adwave(folder.path()).arg("sample").assert().success().stdout(contains("creature"));
}

#[test]
fn formats_are_listed_as_the_document_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let said = |args: &[&str]| {
        let output = adwave(folder.path()).arg("formats").args(args).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let document = include_str!("../../../../docs/FORMATS.md");
    let list = said(&["--markdown"]);
    assert!(document.contains(list.trim()), "docs/FORMATS.md has another list than\n{list}");
    let list = json(folder.path(), "formats");
    let names: Vec<&str> =
        list["formats"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(names, adwave_io::Format::all().map(adwave_io::Format::name).collect::<Vec<_>>());
    assert!(said(&[]).lines().any(|line| line.trim_start().starts_with("ply-ascii")));
}

#[test]
fn a_shape_goes_over_into_another_format_and_back() {
    let folder = tempfile::tempdir().unwrap();
    adwave(folder.path()).args(["sample", "knot", "--vertices", "500", "-o", "a.ply"]).assert().success();
    adwave(folder.path())
        .args(["convert", "a.ply", "-o", "b.glb"])
        .assert()
        .success()
        .stdout(contains("500 vertices"));
    let told = json(folder.path(), "convert b.glb -o c.obj");
    assert_eq!((&told["format"], &told["vertices"]), (&serde_json::json!("glb"), &serde_json::json!(500)));
    let error = refused(folder.path(), "convert b.glb -o c.e57");
    assert!(error.contains("e57") && error.contains("choose another format"), "{error}");
}

#[test]
fn info_counts_what_is_there() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("two.obj"),
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\nf 4 5 6\n",
    )
    .unwrap();
    let info = json(folder.path(), "info two.obj");
    let health = &info["health"];
    assert_eq!(info["kind"], "mesh");
    assert_eq!((&health["vertices"], &health["faces"]), (&7.into(), &2.into()));
    assert_eq!(health["welded_vertices"], 2);
    assert_eq!(health["unreferenced_vertices"], 1);
    assert_eq!(health["boundary_edges"], 4);
    assert_eq!(health["edges"], 5);
    assert_eq!(health["area"], 1.0);
    // One step is already half as wide as such a coarse shape.
    assert_eq!(info["steps"], serde_json::json!([0, 1]));
    let apart = json(folder.path(), "info two.obj --no-weld");
    assert_eq!(apart["health"]["boundary_edges"], 6);
    let cloud = json(folder.path(), "info two.obj --as cloud");
    assert_eq!(cloud["kind"], "cloud");
    let graph = json(folder.path(), "info two.obj --as graph");
    assert_eq!((&graph["kind"], &graph["health"]["edges"]), (&"graph".into(), &6.into()));
}

#[test]
fn a_shape_can_come_from_a_pipe_and_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let output = adwave(folder.path())
        .args(["info", "-", "--json"])
        .write_stdin("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        .assert()
        .success();
    assert!(String::from_utf8_lossy(&output.get_output().stdout).contains("\"off\""));
    let info = json(folder.path(), "info sample:sphere --vertices 500");
    assert_eq!(info["health"]["euler_characteristic"], 2);
}

#[test]
fn transform_writes_fields_that_filter_and_transform_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let report = json(path, "transform sample:torus --vertices 2000 --levels 5 -o bands.ply");
    assert_eq!(report["steps"].as_array().unwrap().len(), 6);
    assert_eq!(report["channels"], 3);
    let info = json(path, "info bands.ply");
    let names: Vec<&str> =
        info["fields"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap()).collect();
    for name in ["S0", "S5", "W1", "W5"] {
        assert!(names.contains(&name), "{name} is not among {names:?}");
    }
    let again = json(path, "transform bands.ply --field W3 -o again.vtp --steps 1,3,7");
    assert_eq!(again["steps"], serde_json::json!([0, 1, 3, 7]));
    adwave(path).args(["transform", "sample:torus", "-o", "bands.npz", "-q"]).assert().success().stdout("");
    assert!(fs::read(path.join("bands.npz")).unwrap().starts_with(b"PK"));
}

#[test]
fn filtering_keeps_everything_but_the_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let obj = "# a cube corner\nmtllib stone.mtl\no rock\nv 0 0 0\nv 1.50 -0.000 0\nv 0 1 0 \nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n\
               usemtl gray\ns 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/2\nf 1/1 4/2 2/3\n# end\n";
    fs::write(path.join("in.obj"), obj).unwrap();
    adwave(path).args(["filter", "in.obj", "-o", "same.obj", "--gains", "1,1,1"]).assert().success();
    assert_eq!(fs::read_to_string(path.join("same.obj")).unwrap(), obj);
    let report = json(path, "filter in.obj -o smooth.obj --preset suppress --levels 2");
    assert!(report["moved"]["rms"].as_f64().unwrap() > 0.01);
    let smooth = fs::read_to_string(path.join("smooth.obj")).unwrap();
    let kept =
        |text: &str| text.lines().filter(|l| !l.starts_with("v ")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(kept(&smooth), kept(obj));
    assert!(!smooth.contains("v 1.50 -0.000 0"));
}

#[test]
fn filtering_leaves_vertices_outside_the_region_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    adwave(path).args(["sample", "plane", "--vertices", "900", "-o", "in.obj"]).assert().success();
    let line = "filter in.obj -o out.obj --preset suppress --region 'ball:vertex=0,radius=20%' --save-recipe edit.toml";
    let report = json(path, line);
    assert!(report["moved"]["max"].as_f64().unwrap() > 0.0);
    let (before, after) =
        (fs::read_to_string(path.join("in.obj")).unwrap(), fs::read_to_string(path.join("out.obj")).unwrap());
    let moved = before.lines().zip(after.lines()).filter(|(a, b)| a != b).count();
    assert!((5..300).contains(&moved), "{moved} vertices moved");
    adwave(path).args(["filter", "in.obj", "-o", "replayed.obj", "--recipe", "edit.toml"]).assert().success();
    assert_eq!(fs::read_to_string(path.join("replayed.obj")).unwrap(), after);
}

#[test]
fn a_field_is_filtered_in_its_own_type() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let ply = "ply\nformat ascii 1.0\ncomment kept\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
               property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float heat\n\
               element face 2\nproperty list uchar int vertex_indices\nend_header\n\
               0 0 0 255 0 0 1.5\n1 0 0 0 255 0 2\n1 1 0 0 0 255 3\n0 1 0 9 9 9 4\n3 0 1 2\n3 0 2 3\n";
    fs::write(path.join("in.ply"), ply).unwrap();
    adwave(path)
        .args(["filter", "in.ply", "-o", "out.ply", "--field", "color", "--preset", "suppress"])
        .assert()
        .success();
    let out = fs::read_to_string(path.join("out.ply")).unwrap();
    assert!(out.contains("comment kept"));
    let rows: Vec<Vec<&str>> = out
        .lines()
        .skip_while(|l| *l != "end_header")
        .skip(1)
        .take(4)
        .map(|l| l.split_whitespace().collect())
        .collect();
    assert_eq!(rows[0][..3], ["0", "0", "0"]);
    // A field that was changed becomes the last of the vertex, in its own type.
    assert_eq!(rows[0][3], "1.5");
    let red: u8 = rows[0][4].parse().unwrap();
    assert!(red < 255);
    assert!(out.contains("property uchar red"));
}

#[test]
fn a_wavelet_sums_to_zero_over_the_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let report = json(path, "basis sample:sphere --vertices 1000 --vertex 3 --level 4 -o w.ply");
    assert!(report["support"].as_u64().unwrap() > 7);
    assert!(report["phi_at_vertex"].as_f64().unwrap() > 0.0);
    let report = json(path, "basis sample:sphere --vertices 300 --levels 2 -o b.npz");
    assert_eq!(report["files"].as_array().unwrap().len(), 4);
    assert!(path.join("b.phi2.npz").is_file() && path.join("b.psi1.npz").is_file());
}

#[test]
fn the_demo_shows_all_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let output = adwave(path).args(["demo", "--vertices", "20000"]).assert().success();
    let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
    for word in ["level", "sigma", "energy", "suppress.ply", "local-edit.ply", "Next"] {
        assert!(text.contains(word), "no '{word}' in\n{text}");
    }
    for file in ["creature.ply", "enhance.ply", "band1.ply", "band2.ply", "bands.vtp", "local-edit.toml"] {
        assert!(path.join("adwave-demo").join(file).is_file(), "{file}");
    }
    // The last line names a page that shows it all, opens from a disk, and whose links lead to files.
    let folder = path.join("adwave-demo");
    assert!(text.trim_end().ends_with("index.html"), "{text}");
    let page = fs::read_to_string(folder.join("index.html")).unwrap();
    let tags = common::page::tags(&page);
    let pictures: Vec<_> = tags.iter().filter(|t| t.name == "img").collect();
    assert!(pictures.len() > 6 + 2, "{} pictures", pictures.len());
    for picture in pictures {
        assert!(picture.get("src").unwrap().starts_with("data:"), "inside the page");
        assert!(picture.get("alt").unwrap().split(' ').count() > 2);
    }
    assert!(page.contains("prefers-color-scheme:dark"));
    for link in tags.iter().filter(|t| t.name == "a").filter_map(|t| t.get("href")) {
        let is_there = |file: &str| folder.join(file).is_file();
        assert!(link.starts_with("data:text/csv") || link.starts_with('#') || is_there(link), "{link}");
    }
    for name in ["sheet.png", "saliency.png", "features.png"] {
        let picture = image::open(folder.join(name)).unwrap().into_rgb8();
        assert!(picture.width() >= 1200, "{name}");
        let ground = picture.get_pixel(0, 0);
        let n_drawn = picture.pixels().filter(|p| *p != ground).count();
        assert!(n_drawn > picture.pixels().len() / 20, "{name} is empty");
    }
    // What is printed can be followed.
    let line = "filter sample:creature --vertices 20000 -o edit.ply --recipe adwave-demo/local-edit.toml -q";
    adwave(path).args(common::words(line)).assert().success();
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for threads in ["1", "2", "5"] {
        fs::create_dir(path.join(threads)).unwrap();
        let out = format!("{threads}/bands.npz");
        let line = ["transform", "sample:knot", "--vertices", "5000", "-o", &out, "--threads", threads, "-q"];
        adwave(path).args(line).assert().success();
    }
    let bytes = |threads: &str| fs::read(path.join(threads).join("bands.npz")).unwrap();
    assert!(bytes("1") == bytes("2") && bytes("2") == bytes("5"));
}

#[test]
fn denoised_and_filtered_fields_of_other_files_go_into_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let sphere = json(path, "sample sphere --vertices 500 -o s.ply");
    let n_vertices = sphere["vertices"].as_u64().unwrap();
    let rows = (0..n_vertices).map(|x| format!("{}\n", 1.0 + (x * 7919 % 97) as f64 / 970.0));
    fs::write(path.join("depth.of.folds.csv"), "value\n".to_owned() + &rows.collect::<String>()).unwrap();
    for (field, name) in [("depth.of.folds.csv", "depth"), ("depth.of.folds.csv:value", "value")] {
        let report = json(path, &format!("denoise s.ply --field {field} -o o.ply"));
        assert!(report["denoise"][0]["noise"].as_f64().unwrap() > 0.01, "{report}");
        let changed = fs::read(path.join("o.ply")).unwrap();
        assert_ne!(changed, fs::read(path.join("s.ply")).unwrap());
        json(path, &format!("transform o.ply --field {name} -o b.npz --levels 2"));
        let report = json(path, &format!("filter s.ply --field {field} --preset suppress -o f.ply"));
        assert!(report["changed"]["rms"].as_f64().unwrap() > 0.01, "{report}");
        json(path, &format!("transform f.ply --field {name} -o b.npz --levels 2"));
    }
}

#[test]
fn denoising_of_a_cloud_says_whether_its_noise_is_strong_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (noise, is_strong) in [(0.3, false), (2.0, true)] {
        json(path, &format!("sample sphere --vertices 10000 --noise {noise} -o s.xyz"));
        let report = json(path, "denoise s.xyz -o o.xyz");
        assert_eq!(report["denoise"]["cloud"]["strong"].is_object(), is_strong, "{report}");
        let said = adwave(path).args(common::words("denoise s.xyz -o o.xyz")).assert().success();
        let said = String::from_utf8_lossy(&said.get_output().stdout).into_owned();
        assert_eq!(said.contains("strong noise: it hides among the nearest points"), is_strong, "{said}");
    }
    // A plane of rounded positions.
    let plane: Vec<String> = (0..900).map(|k| format!("{} {} 0.5", k % 30, k / 30)).collect();
    fs::write(path.join("p.xyz"), plane.join("\n")).unwrap();
    let said = adwave(path).args(common::words("denoise p.xyz -o o.xyz")).assert().success();
    let said = String::from_utf8_lossy(&said.get_output().stdout).into_owned();
    assert!(said.contains("none that could be told from rounding"), "{said}");
}

#[test]
fn treatments_of_positions_are_refused_for_fields_and_of_meshes_for_clouds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    json(path, "sample torus --vertices 500 -o t.ply");
    json(path, "convert t.ply -o t.xyz");
    for option in ["--creases none", "--outliers drop", "--shared-noise auto"] {
        let error = refused(path, &format!("denoise t.ply -o o.ply --signal z {option}"));
        assert!(error.contains("applies to positions") && error.contains("leave it out"), "{error}");
    }
    for line in
        ["denoise t.xyz -o o.xyz --shared-noise 0.1", "tiles t.las -o o.las --denoise --shared-noise auto"]
    {
        if line.starts_with("tiles") {
            json(path, "convert t.xyz -o t.las");
        }
        let error = refused(path, line);
        assert!(error.contains("--shared-noise applies to meshes"), "{error}");
    }
    for value in ["nan", "inf"] {
        let error = refused(path, &format!("denoise t.ply -o o.ply --shared-noise {value}"));
        assert!(error.contains("must be a number from 0 to"), "{error}");
    }
    assert!(!path.join("o.ply").exists() && !path.join("o.xyz").exists() && !path.join("o.las").exists());
}
