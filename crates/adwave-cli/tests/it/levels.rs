//! Levels of any number of steps, as the command takes them and gives them back.

use crate::common;

use common::{adwave, json, refused, words};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Rounding of a square root and a quotient.
const ROUNDING: f64 = 1e-14;

/// Time in which a bad request on a small shape has to be refused, with a machine that is busy with other tests.
const AT_ONCE: Duration = Duration::from_secs(30);

fn numbers(values: &Value) -> Vec<f64> {
    values.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

/// A strip of squares: every step of its walk leads from an even node to an odd one.
fn write_strip(folder: &Path) {
    let rows: Vec<String> = (1..40).map(|a| format!("{} {a} 1", a + 1)).collect();
    let head = "%%MatrixMarket matrix coordinate real symmetric\n40 40 39\n";
    fs::write(folder.join("strip.mtx"), format!("{head}{}\n", rows.join("\n"))).unwrap();
}

#[test]
fn what_a_graph_has_not_and_what_was_made_of_its_matrix_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_strip(path);
    let head = "%%MatrixMarket matrix coordinate real general\n3 3 3\n";
    fs::write(path.join("oneway.mtx"), format!("{head}1 2 1\n2 3 1\n3 2 1\n")).unwrap();
    assert_eq!(json(path, "info oneway.mtx")["made_symmetric"], true);
    assert_eq!(json(path, "info strip.mtx")["made_symmetric"], false);
    let text = |line: &str| {
        let output = adwave(path).args(words(line)).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(text("info oneway.mtx").contains("(M + Mᵀ)/2"));
    assert!(!text("info strip.mtx").contains("(M + Mᵀ)/2"));
    let last = text("info strip.mtx --levels 4").trim_end().lines().last().unwrap().to_owned();
    assert!(last.trim_end().ends_with('–'), "a graph has no diagonal: {last}");
}

#[test]
fn a_basis_says_what_was_dropped_and_where_most_of_a_function_is() {
    let folder = tempfile::tempdir().unwrap();
    let all =
        json(folder.path(), "basis sample:torus --vertices 400 --levels 3 -o b.npz --drop-tolerance 1e-4");
    assert_eq!(all["drop_tolerance"], 1e-4);
    let one = json(folder.path(), "basis sample:torus --vertices 400 --vertex 7 --level 6 -o f.ply");
    let count = |name: &str| one[name].as_u64().unwrap();
    assert!(count("vertices_with_99_9_percent") < count("support"), "{one}");
}

#[test]
fn voices_divide_every_octave_alike() {
    let folder = tempfile::tempdir().unwrap();
    let info = json(folder.path(), "info sample:torus --vertices 900 --levels 4 --voices 3");
    let steps = numbers(&info["steps"]);
    assert_eq!(steps.len(), 1 + 10);
    assert_eq!(info["levels"], 10);
    for (k, n) in steps[1..].iter().enumerate() {
        assert!((n / (k as f64 / 3.0).exp2() - 1.0).abs() < ROUNDING, "voice {k}: {n} steps");
    }
    for pair in numbers(&info["sigma"])[1..].windows(2) {
        assert!((pair[1] / pair[0] / (1.0_f64 / 6.0).exp2() - 1.0).abs() < ROUNDING, "{pair:?}");
    }
    // What is whole is printed as a whole number, the rest with all digits.
    for (k, n) in info["steps"].as_array().unwrap().iter().enumerate() {
        assert_eq!(n.is_u64(), k == 0 || k % 3 == 1, "level {k}: {n}");
    }
    let text = adwave(folder.path())
        .args(words("info sample:torus --vertices 900 --levels 4 --voices 3"))
        .assert()
        .success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("1.26") && text.contains("1.587"), "{text}");
}

#[test]
fn steps_need_not_be_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let report = json(path, "transform sample:torus --vertices 900 --steps 1,2.5,4 -o bands.ply");
    assert_eq!(report["steps"], json!([0, 1, 2.5, 4]));
    let sigma = numbers(&report["sigma"]);
    assert!((sigma[2] / sigma[1] - 2.5_f64.sqrt()).abs() < ROUNDING, "{sigma:?}");
    assert!(numbers(&report["energy"]).iter().all(|&e| e > 0.0 && e.is_finite()));
    assert!(report["error_bound"].as_f64().unwrap() <= 1e-10 && report["products"].as_u64().unwrap() > 4);
    // Two bands in place of one: their sum is the band of whole steps.
    let whole = json(path, "transform sample:torus --vertices 900 --steps 1,4 -o whole.ply");
    assert_eq!(whole["steps"], json!([0, 1, 4]));
    for (file, steps) in [("parts.npz", "1,2.5,4"), ("whole.npz", "1,4")] {
        let line = format!("transform sample:torus --vertices 900 --steps {steps} -o {file} -q");
        adwave(path).args(words(&line)).assert().success();
    }
    // A NumPy archive holds the steps as doubles.
    let archive = fs::read(path.join("parts.npz")).unwrap();
    let header = archive.windows(9).position(|w| w == b"steps.npy").expect("the array of the steps");
    let header = String::from_utf8_lossy(&archive[header..header + 140]).into_owned();
    assert!(header.contains("'descr': '<f8'") && header.contains("(4,)"), "{header}");
}

#[test]
fn widths_are_those_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for operator in ["walk", "surface"] {
        let line = format!("info sample:torus --vertices 900 --levels 2 --operator {operator}");
        let step = numbers(&json(path, &line)["sigma"])[1];
        let widths = [0.9 * step, 1.3 * step, 2.0 * step, 3.77 * step];
        let asked: Vec<String> = widths.iter().map(f64::to_string).collect();
        let asked = asked.join(",");
        let line = format!(
            "transform sample:torus --vertices 900 --lengths {asked} -o bands.npz --operator {operator}"
        );
        let report = json(path, &line);
        assert_eq!(report["operator"], operator);
        for (found, asked) in numbers(&report["sigma"])[1..].iter().zip(widths) {
            assert!((found / asked - 1.0).abs() < ROUNDING, "{found} for {asked}");
        }
        // Twice the width of a step are four steps, whatever rounding makes of the quotient.
        assert_eq!(report["steps"][3], json!(4));
        assert!(report["steps"][1].as_f64().unwrap() < 1.0);
    }
}

#[test]
fn widths_are_given_as_people_give_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let torus = "info sample:torus --vertices 900";
    let by_sigma = json(path, &format!("{torus} --lengths 0.2,0.4"));
    let by_fwhm = json(path, &format!("{torus} --fwhm 0.333021844463079,0.666043688926158"));
    assert_eq!(
        (&by_fwhm["diffusion"]["operator"], &by_sigma["diffusion"]["operator"]),
        (&json!("surface"), &json!("surface"))
    );
    for (a, b) in numbers(&by_sigma["sigma"]).iter().zip(numbers(&by_fwhm["sigma"])) {
        assert!((a - b).abs() < 1e-9, "{a} and {b}");
    }
    assert!((numbers(&by_fwhm["fwhm"])[1] - 0.333_021_844_463_079).abs() < 1e-9);
    let diagonal = by_sigma["diagonal"].as_f64().unwrap();
    let by_share = json(path, &format!("{torus} --lengths 5%,10%"));
    assert!((numbers(&by_share["sigma"])[2] / (0.1 * diagonal) - 1.0).abs() < 1e-9);
    // What is finer than the mesh, or wider than the shape, is done and said.
    for (asked, said) in [("0.05,0.3", "below the mean edge"), ("50%,150%", "larger than the shape")] {
        let line = format!("{torus} --lengths {asked}");
        let output = adwave(path).args(words(&line)).assert().success().get_output().stderr.clone();
        let output = String::from_utf8(output).unwrap();
        assert!(output.contains(said), "{asked}: {output}");
    }
    // What is hardly a change of bands any more is done and said.
    for (edit, said) in [
        ("--steps 3000,6000 --gains 500,500", "times the widest σ"),
        ("--steps 3000,6000 --gains 0,0", "the volume changed from"),
        ("--steps 1,2 --gains 1.5,1.2", ""),
    ] {
        let line = format!("filter sample:torus --vertices 900 {edit} -o far.obj");
        let output = adwave(path).args(words(&line)).assert().success().get_output().stderr.clone();
        let output = String::from_utf8(output).unwrap();
        assert!(if said.is_empty() { output.is_empty() } else { output.contains(said) }, "{edit}: {output}");
    }
    // Recipes travel: widths in them are those that were asked for.
    let line =
        "filter sample:torus --vertices 900 --lengths 2%,4% --gains 0,0 -o edit.obj --save-recipe edit.toml";
    json(path, line);
    let recipe = fs::read_to_string(path.join("edit.toml")).unwrap();
    assert!(recipe.contains("lengths = [\"2%\", \"4%\"]"), "{recipe}");
    let larger = json(path, "filter sample:torus --vertices 4000 --recipe edit.toml -o again.obj");
    assert!((numbers(&larger["sigma"])[2] / (0.04 * diagonal) - 1.0).abs() < 0.02);
}

#[test]
fn the_operator_follows_from_what_is_asked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let of = |line: &str| json(path, line)["operator"].as_str().expect("a name").to_owned();
    for (line, operator) in [
        ("transform sample:torus --vertices 500 --levels 3 -o a.npz", "walk"),
        ("transform sample:torus --vertices 500 --lengths 0.1,0.2,0.4 -o a.npz", "surface"),
        ("transform sample:torus --vertices 500 --lengths 0.1,0.2,0.4 --rings 2 -o a.npz", "walk"),
        ("transform sample:torus --vertices 500 --lengths 0.1,0.2,0.4 --operator walk -o a.npz", "walk"),
        ("saliency sample:torus --vertices 500 --levels 4 --operator surface -o a.ply", "surface"),
        ("saliency sample:torus --vertices 500 --lengths 0.1,0.2,0.4 -o a.ply", "surface"),
        ("features sample:torus --vertices 500 --levels 4", "surface"),
        ("features sample:torus --vertices 500 --levels 4 --rings 2", "walk"),
        ("features sample:torus --as cloud --vertices 500 --levels 4", "walk"),
        ("features sample:torus --as cloud --vertices 500 --levels 4 --operator surface", "surface"),
        ("basis sample:torus --vertices 500 --vertex 3 --level 4 --operator surface -o a.vtp", "surface"),
    ] {
        assert_eq!(of(line), operator, "{line}");
    }
    let line = "transform sample:torus --vertices 500 --operator surface --rings 2 -o a.npz";
    let said = refused(path, line);
    assert!(said.contains("--rings is an option of the walk"), "{said}");
    let line = "basis sample:torus --vertices 500 --levels 3 --operator surface -o a.npz";
    let said = refused(path, line);
    assert!(said.contains("no sparse matrices"), "{said}");
}

#[test]
fn a_recipe_keeps_the_operator() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let line = "filter sample:torus --vertices 900 --lengths 0.1,0.2,0.4 --gains 0,2,1 -o edit.obj --save-recipe edit.toml";
    assert_eq!(json(path, line)["operator"], "surface");
    let recipe = fs::read_to_string(path.join("edit.toml")).unwrap();
    assert!(recipe.contains("operator = \"surface\""), "{recipe}");
    let again = json(path, "filter sample:torus --vertices 900 --recipe edit.toml -o again.obj");
    assert_eq!(again["operator"], "surface");
    assert!(fs::read(path.join("edit.obj")).unwrap() == fs::read(path.join("again.obj")).unwrap());
    fs::write(path.join("hand.toml"), "lengths = [0.1, 0.2, 0.4]\n[[layer]]\ngains = [0, 2, 1]\n").unwrap();
    let by_hand = json(path, "filter sample:torus --vertices 900 --recipe hand.toml -o hand.obj");
    assert_eq!(by_hand["operator"], "surface");
    assert!(fs::read(path.join("edit.obj")).unwrap() == fs::read(path.join("hand.obj")).unwrap());
}

#[test]
fn a_recipe_keeps_creases_density_borders_and_volume() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (name, line, kept) in [
        (
            "bracket",
            "sample:bracket --vertices 3000 --keep-creases --keep-volume",
            &["keep_creases = true", "volume = \"keep\""][..],
        ),
        (
            "plane",
            "sample:plane --vertices 900 --density-invariant --border free",
            &["density_invariant = true", "border = \"free\""],
        ),
    ] {
        json(path, &format!("filter {line} --preset suppress -o {name}.obj --save-recipe {name}.toml"));
        let recipe = fs::read_to_string(path.join(format!("{name}.toml"))).unwrap();
        assert!(kept.iter().all(|line| recipe.contains(line)), "{recipe}");
        let shape = line.split(" --").take(2).collect::<Vec<_>>().join(" --");
        json(path, &format!("filter {shape} --recipe {name}.toml -o again.obj"));
        let [first, again] =
            [format!("{name}.obj"), "again.obj".into()].map(|file| fs::read(path.join(file)).unwrap());
        assert!(first == again, "{name}");
        json(path, &format!("filter {shape} --preset suppress -o plain.obj"));
        assert!(first != fs::read(path.join("plain.obj")).unwrap(), "{name}");
    }
    let info = json(path, "info sample:bracket --vertices 3000 --keep-creases --density-invariant");
    assert_eq!(
        (&info["diffusion"]["keeps_creases"], &info["diffusion"]["density_invariant"]),
        (&json!(true), &json!(true))
    );
    let said = refused(path, "info sample:bracket --density-invariant --operator surface");
    assert!(said.contains("--density-invariant is an option of the walk"), "{said}");
    let said = refused(path, "info sample:bracket --as cloud --density-invariant --directed");
    assert!(said.contains("leave out --directed"), "{said}");
    fs::write(path.join("path.mtx"), "%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n2 1 1.0\n")
        .unwrap();
    let said = refused(path, "info path.mtx --keep-creases");
    assert!(said.contains("needs normals, and a graph has none"), "{said}");
}

#[test]
fn a_recipe_has_the_levels_that_keeping_the_volume_adds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (how, levels) in
        [("twice", "--lengths 5%,10%"), ("thrice", "--lengths 5%,10%"), ("twice", "--levels 3")]
    {
        let line = format!(
            "filter sample:torus --vertices 900 {levels} --preset suppress --keep-volume {how} --operator walk"
        );
        json(path, &format!("{line} -o first.obj --save-recipe edit.toml"));
        json(
            path,
            "filter sample:torus --vertices 900 --recipe edit.toml -o again.obj --save-recipe copy.toml",
        );
        let [first, again] =
            ["edit.toml", "copy.toml"].map(|file| fs::read_to_string(path.join(file)).unwrap());
        assert_eq!(first, again);
        let coordinates = |file: &str| -> Vec<f64> {
            let text = fs::read_to_string(path.join(file)).unwrap();
            let vertices = text.lines().filter_map(|line| line.strip_prefix("v "));
            vertices
                .flat_map(|line| line.split(' ').map(|c| c.parse().unwrap()).collect::<Vec<f64>>())
                .collect()
        };
        let (first, again) = (coordinates("first.obj"), coordinates("again.obj"));
        assert!(first.len() >= 3 * 800 && first.len() == again.len());
        assert!(first.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-9), "{line}");
    }
}

#[test]
fn a_recipe_keeps_steps_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let line = "filter sample:torus --vertices 900 --levels 3 --voices 2 --gains 0,2,1,0.5,0 -o edit.obj --save-recipe edit.toml --save-steps";
    let report = json(path, line);
    assert_eq!(report["steps"].as_array().unwrap().len(), 6);
    let recipe = fs::read_to_string(path.join("edit.toml")).unwrap();
    assert!(recipe.contains("1.4142135623730951"), "{recipe}");
    let again = json(path, "filter sample:torus --vertices 900 --recipe edit.toml -o again.obj");
    assert_eq!(again["steps"], report["steps"]);
    assert!(fs::read(path.join("edit.obj")).unwrap() == fs::read(path.join("again.obj")).unwrap());
    // By hand, whole numbers and others beside each other.
    fs::write(path.join("hand.toml"), "steps = [1, 2.5, 4]\n[[layer]]\ngains = [0, 1, 0.5]\n").unwrap();
    let by_hand = json(path, "filter sample:torus --vertices 900 --recipe hand.toml -o hand.obj");
    assert_eq!(by_hand["steps"], json!([0, 1, 2.5, 4]));
}

#[test]
fn what_is_no_number_of_steps_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_strip(path);
    let start = Instant::now();
    for (asked, named) in [
        ("--steps 0", "level 1 has 0 steps"),
        ("--steps=-1", "-1"),
        ("--steps nan", "NaN"),
        ("--steps inf", "2^31"),
        ("--steps 2,1", "increase"),
        ("--steps 1.5,1.5", "increase"),
        ("--steps 1,nan", "level 2"),
        ("--steps 1e30", "2^31"),
        ("--steps 1e-9", "at least 0.015625"),
        ("--voices 0", "1..=64, got 0"),
        ("--voices 1000", "1..=64, got 1000"),
        ("--voices 3 --levels 0", "at least one level"),
        ("--voices 3 --levels 99", "32"),
        ("--lengths 0", "positive"),
        ("--lengths=-1e-99", "-1e-99"),
        ("--lengths nan", "NaN"),
        ("--lengths 2,1", "increasing"),
        ("--fwhm 0", "--fwhm"),
        ("--lengths 1%,0.5%", "increasing"),
        ("--lengths 1e300", "1e300"),
        ("--lengths 1e-9", "narrowest here is"),
    ] {
        for verb in ["info", "transform", "filter", "saliency", "features"] {
            let rest = match verb {
                "info" => "",
                "filter" => "--preset suppress -o o.obj",
                "features" => "-o o.csv",
                _ => "-o o.ply",
            };
            let line = format!("{verb} sample:sphere --vertices 100 {asked} {rest}");
            let error = refused(path, &line);
            assert!(error.contains(named), "{line}: {error}");
        }
    }
    for line in ["--steps one", "--steps ''", "--voices 2.5", "--voices=-1", "--lengths x"] {
        let line = format!("transform sample:sphere --vertices 100 -o o.ply {line}");
        adwave(path).args(words(&line)).assert().code(2);
    }
    for steps in ["[0.0]", "[2, 1]", "[nan]", "[1e30]", "[]"] {
        fs::write(path.join("bad.toml"), format!("steps = {steps}\n[[layer]]\ngains = [0]\n")).unwrap();
        refused(path, "filter sample:sphere --vertices 100 -o o.ply --recipe bad.toml");
    }
    let left: Vec<_> = fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "files were left behind: {left:?}");
    assert!(start.elapsed() < AT_ONCE, "{:?}", start.elapsed());
}

#[test]
fn a_walk_that_takes_whole_steps_only_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let cloud: Vec<String> =
        (0..200).map(|i| format!("{} {} {}", i % 20, i / 20, f64::from(i * i % 7) / 5.0)).collect();
    fs::write(path.join("cloud.xyz"), cloud.join("\n")).unwrap();
    let error = refused(path, "transform cloud.xyz --directed --voices 2 -o o.npz");
    assert!(error.contains("level 2") && error.contains("whole steps"), "{error}");
    json(path, "transform cloud.xyz --directed --steps 1,2,5 -o o.npz");
    json(path, "transform cloud.xyz --voices 2 -o o.npz");
}

#[test]
fn an_accuracy_out_of_reach_is_refused_with_the_one_in_reach() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_strip(path);
    let values: Vec<String> = (0..40).map(|i| (i * 17 % 11).to_string()).collect();
    fs::write(path.join("f.csv"), format!("f\n{}\n", values.join("\n"))).unwrap();
    let line = "transform strip.mtx --field f.csv --steps 1,1.1,2 -o o.npz";
    let start = Instant::now();
    let error = refused(path, line);
    assert!(error.contains("level 2") && error.contains("less accuracy"), "{error}");
    json(path, &format!("{line} --accuracy 1e-4"));
    json(path, "transform strip.mtx --field f.csv --steps 1,3.5,7 -o o.npz");
    assert!(start.elapsed() < AT_ONCE, "{:?}", start.elapsed());
}
