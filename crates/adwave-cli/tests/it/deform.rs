//! `deform`, `rebase`, `transfer` and `morph`.

use crate::common;

use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;

const FEET: &str = "half-space:point=0 0 0,normal=0 -1 0,falloff=0";

/// Positions of a file, by columns of a CSV.
fn positions(folder: &Path, file: &str) -> Vec<[f64; 3]> {
    adwave(folder).args(words(&format!("convert {file} -o {file}.xyz"))).assert().success();
    let text = fs::read_to_string(folder.join(format!("{file}.xyz"))).unwrap();
    let numbers = text.lines().filter(|line| !line.starts_with(['#', 'x'])).map(|line| {
        let row: Vec<f64> = line.split([' ', ',']).map(|word| word.parse().unwrap()).collect();
        [row[0], row[1], row[2]]
    });
    numbers.collect()
}

fn sample(folder: &Path) {
    adwave(folder).args(words("sample sphere --vertices 1500 -o a.ply")).assert().success();
}

#[test]
fn a_recipe_bends_as_the_options_do_and_after_its_layers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sample(path);
    let handle = "half-space:point=0 0.7 0,normal=0 1 0,falloff=0";
    let pose = |handle: &str| {
        format!(
            "[pose]\nfixed = '{FEET}'\nstiffness = '6%'\n[[pose.handle]]\nregion = '{handle}'\nby = [0.0, 0.5, 0.1]\n"
        )
    };
    fs::write(path.join("pose.toml"), pose(handle)).unwrap();
    let mut line = words("deform a.ply -o typed.ply --by 0,0.5,0.1 --stiffness 6%");
    line.extend(["--fix".into(), FEET.into(), "--move".into(), handle.into()]);
    adwave(path).args(line).assert().success();
    let typed = positions(path, "typed.ply");
    adwave(path).args(words("deform a.ply -o recipe.ply --recipe pose.toml")).assert().success();
    assert_eq!(positions(path, "recipe.ply"), typed);
    let line = "filter a.ply -o filtered.ply --recipe pose.toml --save-recipe again.toml";
    adwave(path).args(words(line)).assert().success();
    assert_eq!(positions(path, "filtered.ply"), typed);
    adwave(path).args(words("deform a.ply -o again.ply --recipe again.toml")).assert().success();
    assert_eq!(positions(path, "again.ply"), typed);
    // Layers act before the pose: vertices of the handle are those of the filter, moved.
    fs::write(path.join("both.toml"), format!("levels = 4\n[[layer]]\npreset = 'smooth'\n{}", pose(handle)))
        .unwrap();
    adwave(path).args(words("filter a.ply -o both.ply --recipe both.toml")).assert().success();
    adwave(path).args(words("filter a.ply -o smooth.ply --levels 4 --preset smooth")).assert().success();
    let (rest, smooth, both) =
        (positions(path, "a.ply"), positions(path, "smooth.ply"), positions(path, "both.ply"));
    let of_handle = (0..rest.len()).filter(|&v| rest[v][1] > 0.71);
    let n_handle = of_handle
        .inspect(|&v| {
            let by = [0, 1, 2].map(|c| both[v][c] - smooth[v][c]);
            assert!((by[1] - 0.5).abs() < 1e-6 && (by[2] - 0.1).abs() < 1e-6, "{by:?}");
        })
        .count();
    assert!(n_handle > 50);
    assert!(smooth.iter().zip(&rest).any(|(a, b)| a != b));
    fs::write(path.join("none.toml"), "levels = 4\n").unwrap();
    let message = refused(path, "deform a.ply -o x.ply --recipe none.toml");
    assert!(message.contains("[[pose.handle]]"), "{message}");
    let message = refused(path, "filter a.ply -o x.csv --signal mean-curvature --recipe pose.toml");
    assert!(message.contains("change coordinates"), "{message}");
}

#[test]
fn a_shape_bends_by_its_handles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sample(path);
    let handle = "half-space:point=0 0.7 0,normal=0 1 0,falloff=0";
    let line = |motion: &str| {
        let mut line = words("deform a.ply -o b.ply --json");
        line.extend(["--fix".into(), FEET.into(), "--move".into(), handle.into()]);
        line.extend(words(motion));
        line
    };
    let output = adwave(path).args(line("--by 0,0.5,0")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found["converged"].as_bool().unwrap() && found["nodes"].as_u64().unwrap() > 4, "{found}");
    let (before, after) = (positions(path, "a.ply"), positions(path, "b.ply"));
    let (mut n_fixed, mut n_moved) = (0, 0);
    for (p, q) in before.iter().zip(&after) {
        if p[1] < 0.0 {
            assert_eq!(p, q);
            n_fixed += 1;
        } else if p[1] > 0.71 {
            assert!((q[1] - p[1] - 0.5).abs() < 1e-6 && (q[0] - p[0]).abs() < 1e-6);
            n_moved += 1;
        }
    }
    assert_eq!(found["fixed"].as_u64().unwrap(), n_fixed);
    assert!(n_moved > 50);
    fs::write(path.join("m.txt"), "# up\n1 0 0 0\n0 1 0 0.5\n0 0 1 0\n0 0 0 1\n").unwrap();
    adwave(path).args(line("--matrix m.txt")).assert().success();
    assert_eq!(positions(path, "b.ply"), after);
    adwave(path).args(line("--turn y,30")).assert().success();
    adwave(path).args(line("--to 0,2,0")).assert().success();
}

#[test]
fn an_edited_base_takes_the_detail_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    adwave(path).args(words("sample creature --vertices 2000 -o a.ply")).assert().success();
    let found = json(path, "rebase a.ply --write-base base.obj");
    assert!(found["sigma"].as_f64().unwrap() > 0.0);
    adwave(path).args(words("rebase a.ply --base base.obj -o same.ply")).assert().success();
    let (before, after) = (positions(path, "a.ply"), positions(path, "same.ply"));
    for (p, q) in before.iter().zip(&after) {
        assert!((0..3).all(|c| (p[c] - q[c]).abs() < 1e-5), "{p:?} {q:?}");
    }
    let error = refused(path, "rebase a.ply --base sample:sphere -o o.ply");
    assert!(error.contains("sample:sphere") && error.contains("must have the"), "{error}");
    assert!(refused(path, "rebase a.ply --base base.obj -o o.ply --width -1").contains("above 0"));
}

#[test]
fn detail_goes_over_to_another_mesh_and_shapes_blend() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    adwave(path).args(words("sample creature --vertices 2000 -o a.ply")).assert().success();
    adwave(path).args(words("filter a.ply -o smooth.ply --gains 0,0,0,0 --levels 4")).assert().success();
    adwave(path).args(words("simplify a.ply -o low.ply --ratio 0.5")).assert().success();
    let found = json(path, "transfer low.ply --from a.ply -o back.ply --width 4%");
    assert_eq!(found["far_vertices"], 0);
    assert!(found["moved"]["rms"].as_f64().unwrap() > 1e-3, "vertices keep their places on their own base");
    let off = json(path, "diff back.ply a.ply")["difference"]["rms"].as_f64().unwrap();
    assert!(off < 2e-4, "{off}");
    let mean = |a: &str, b: &str| {
        let (a, b) = (positions(path, a), positions(path, b));
        a.iter().zip(&b).map(|(p, q)| (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt()).sum::<f64>()
    };
    json(path, "morph a.ply smooth.ply -o whole.ply --share 1");
    assert!(mean("whole.ply", "smooth.ply") < 1e-3);
    json(path, "morph a.ply smooth.ply -o fine.ply --share 1 --band-shares 0,0 --levels 4");
    assert!(mean("fine.ply", "a.ply") < mean("smooth.ply", "a.ply"));
}

#[test]
fn requests_that_cannot_be_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sample(path);
    let ball = "--move ball:vertex=0,radius=10%";
    for (motion, named) in [
        ("--by 1,2", "three numbers"),
        ("--turn w,3", "finite numbers"),
        ("--matrix missing.txt", "missing.txt"),
    ] {
        let line = format!("deform a.ply -o o.ply {ball} {motion}");
        let output = adwave(path).args(words(&line)).assert().code(2).get_output().clone();
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(text.contains(named), "{line}: {text}");
    }
    for (line, named) in [
        (format!("deform a.ply -o o.ply {ball}"), "each --move needs one motion"),
        (
            format!("deform a.ply -o o.ply --fix ball:vertex=0,radius=20% {ball} --by 0,0,1"),
            "in the fixed part",
        ),
        (format!("deform a.ply -o o.ply {ball} --by 0,0,1 --stiffness -1"), "stiffness"),
        (format!("deform graph.mtx -o o.ply {ball} --by 0,0,1"), "graph.mtx"),
        ("morph a.ply sample:creature -o o.ply --share 0.5".to_owned(), "same vertices"),
        ("morph a.ply a.ply -o o.ply --share 0.5 --band-shares 1,1,1 --levels 2".to_owned(), "at most"),
        ("transfer a.ply --from a.ply -o o.ply --width -1".to_owned(), "above 0"),
    ] {
        let error = refused(path, &line);
        assert!(error.contains(named), "{line}: {error}");
    }
    assert!(!path.join("o.ply").exists());
}
