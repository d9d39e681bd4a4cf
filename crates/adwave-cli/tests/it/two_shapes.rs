//! `adwave match` and `adwave diff`: two versions of one shape.

use crate::common;

use common::{adwave, json, words};

/// A creature, and the same meshed otherwise, turned by a quarter about z and moved.
fn two_scans(path: &std::path::Path) {
    for (name, n, seed) in [("a", 8000, 1), ("b", 11_000, 2)] {
        let line = format!("sample creature --vertices {n} --noise 0.1 --seed {seed} -o {name}.off");
        adwave(path).args(words(&line)).assert().success();
    }
    let text = std::fs::read_to_string(path.join("b.off")).unwrap();
    let mut lines = text.lines();
    let mut turned = vec![lines.next().unwrap().to_owned(), lines.next().unwrap().to_owned()];
    let n: usize = turned[1].split_whitespace().next().unwrap().parse().unwrap();
    for line in lines.by_ref().take(n) {
        let [x, y, z] = numbers(line);
        turned.push(format!("{} {} {}", 1.0 - y, x + 2.0, z));
    }
    turned.extend(lines.map(str::to_owned));
    std::fs::write(path.join("b.off"), turned.join("\n")).unwrap();
}

fn numbers(line: &str) -> [f64; 3] {
    let numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
    [numbers[0], numbers[1], numbers[2]]
}

#[test]
fn scans_are_matched_drawn_and_brought_together() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    two_scans(path);
    let found = json(path, "match a.off b.off -o pairs.csv --picture lines.png --moved moved.ply");
    let matrix = &found["motion"]["matrix"];
    for (i, row) in [[0.0, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 0.0]].iter().enumerate() {
        for (j, wanted) in row.iter().enumerate() {
            assert!((matrix[i][j].as_f64().unwrap() - wanted).abs() < 0.01, "{matrix}");
        }
    }
    let pairs = found["pairs"].as_array().unwrap();
    let is_right = |pair: &serde_json::Value| {
        let at = |side: &str, c: usize| pair[side]["position"][c].as_f64().unwrap();
        let truth = [1.0 - at("first", 1), at("first", 0) + 2.0, at("first", 2)];
        let off = (0..3).map(|c| (truth[c] - at("second", c)).powi(2)).sum::<f64>().sqrt();
        off <= 2.0 * pair["second"]["sigma"].as_f64().unwrap()
    };
    // Half of the significant features of the smaller scan have a partner.
    let n_right = pairs.iter().filter(|pair| is_right(pair)).count();
    assert!(pairs.len() >= 17 && 10 * n_right >= 9 * pairs.len(), "{n_right} of {}", pairs.len());
    // With a threshold there are more.
    let more = json(path, "match a.off b.off --theta 1");
    let more = more["pairs"].as_array().unwrap();
    let n_right = more.iter().filter(|pair| is_right(pair)).count();
    assert!(more.len() >= 30 && 10 * n_right >= 8 * more.len(), "{n_right} of {}", more.len());
    let csv = std::fs::read_to_string(path.join("pairs.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + pairs.len());
    assert!(path.join("lines.png").metadata().unwrap().len() > 10_000);
    // What was moved lies on the other.
    let left = json(path, "diff b.off moved.ply");
    let straight = json(path, "diff b.off a.off");
    let rms = |found: &serde_json::Value| found["difference"]["rms"].as_f64().unwrap();
    assert!(rms(&left) < 0.02 * rms(&straight), "{} of {}", rms(&left), rms(&straight));
}

#[test]
fn large_clouds_are_searched_at_some_points_and_matched_by_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    two_scans(path);
    let seen = adwave(path)
        .args(words(
            "match a.off b.off --as cloud --search-points 4000 --json --moved moved.ply -o pairs.csv",
        ))
        .assert()
        .success()
        .get_output()
        .clone();
    let notes = String::from_utf8(seen.stderr).unwrap();
    let said = notes.lines().filter(|line| line.contains("evenly spread (--search-points")).count();
    assert_eq!(said, 2, "{notes}");
    let found: serde_json::Value = serde_json::from_slice(&seen.stdout).unwrap();
    let matrix = &found["motion"]["matrix"];
    for (i, row) in [[0.0, -1.0, 0.0, 1.0], [1.0, 0.0, 0.0, 2.0], [0.0, 0.0, 1.0, 0.0]].iter().enumerate() {
        for (j, wanted) in row.iter().enumerate() {
            assert!((matrix[i][j].as_f64().unwrap() - wanted).abs() < 0.01, "{matrix}");
        }
    }
    let points = |name: &str| -> Vec<[f64; 3]> {
        let text = std::fs::read_to_string(path.join(name)).unwrap();
        let n: usize = text.lines().nth(1).unwrap().split_whitespace().next().unwrap().parse().unwrap();
        text.lines().skip(2).take(n).map(numbers).collect()
    };
    for (side, name) in [("first", "a.off"), ("second", "b.off")] {
        let all = points(name);
        assert_eq!(found[side]["vertices"], all.len(), "{name}");
        let searched = found[side]["searched"].as_u64().unwrap();
        assert!((3200..=4800).contains(&searched), "{searched} of {name}");
        // Vertices are rows of the file, not of the points that were searched.
        for pair in found["pairs"].as_array().unwrap() {
            let own = all[pair[side]["vertex"].as_u64().unwrap() as usize];
            let at = |c: usize| pair[side]["position"][c].as_f64().unwrap();
            let off = (0..3).map(|c| (own[c] - at(c)).powi(2)).sum::<f64>().sqrt();
            assert!(off < 2.0 * pair[side]["sigma"].as_f64().unwrap(), "{pair}");
        }
    }
    // All points are moved, and what was moved lies on the other.
    let moved = json(path, "info moved.ply");
    assert_eq!(moved["diffusion"]["vertices"], points("a.off").len());
    let rms = |line: &str| json(path, line)["difference"]["rms"].as_f64().unwrap();
    assert!(rms("diff b.off moved.ply --by closest") < 0.02 * rms("diff b.off a.off --by closest"));
    // A copy that moved is found exactly, although other points of it are searched.
    let copy = json(path, "match a.off moved.ply --as cloud --search-points 4000");
    assert!(copy["motion"]["median_distance"].as_f64().unwrap() < 1e-6, "{copy}");
}

#[test]
fn diff_says_where_and_at_which_scale() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    adwave(path).args(words("sample creature --vertices 8000 -o a.ply")).assert().success();
    let edit = "filter a.ply -o b.ply --lengths 2%,4% --gains 1,3 --region ball:vertex=100,radius=15%";
    adwave(path).args(words(edit)).assert().success();
    let found = json(path, "diff a.ply b.ply --lengths 1%,2%,4%,8% -o diff.ply");
    assert_eq!(found["by"], "vertex");
    let levels = found["levels"].as_array().unwrap();
    let share = |j: usize| levels[j]["share"].as_f64().unwrap();
    assert!(share(2) > 0.3 && share(2) > share(0), "{levels:?}");
    let fields = json(path, "info diff.ply");
    let names: Vec<&str> =
        fields["fields"].as_array().unwrap().iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert!(["difference", "W1", "W4", "S4"].iter().all(|name| names.contains(name)), "{names:?}");
    // The same shape does not differ from itself, by vertices and by closest points.
    for by in ["vertex", "closest"] {
        let none = json(path, &format!("diff a.ply a.ply --by {by}"));
        assert!(none["difference"]["greatest"].as_f64().unwrap() < 1e-12, "{none}");
    }
    adwave(path).args(words("diff a.ply b.ply --by closest --align -o diff.html")).assert().success();
    let page = std::fs::read_to_string(path.join("diff.html")).unwrap();
    assert!(page.contains("b.ply compared with a.ply") && page.matches("<img").count() >= 6);
}

#[test]
fn two_shapes_that_cannot_be_compared_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(
        path.join("g.mtx"),
        "%%MatrixMarket matrix coordinate real symmetric\n3 3 2\n2 1 1\n3 2 1\n",
    )
    .unwrap();
    std::fs::write(path.join("dot.xyz"), "1 2 3\n1 2 3\n").unwrap();
    std::fs::write(path.join("line.xyz"), "0 0 0\n1 0 0\n2 0 0\n").unwrap();
    for (line, said) in [
        ("match sample:sphere g.mtx", "graph"),
        ("match sample:sphere dot.xyz", "dot.xyz: the shape has no extent"),
        ("match sample:sphere sample:torus --search-points 900", "neither shape is one"),
        ("diff sample:sphere g.mtx", "no positions"),
        ("diff sample:sphere line.xyz --by vertex", "needs equal numbers of vertices"),
        ("diff sample:sphere sample:torus -o out.stl", ".vtk, .msh, .graphml, .fits or .html"),
        ("diff sample:sphere sample:torus --limit 1e-9", "no vertex of"),
        ("diff line.xyz line.xyz --by vertex --align", "needs points that fix a rotation"),
        ("match sample:sphere sample:torus -o out.txt", ".csv or .json"),
        ("match sample:sphere sample:torus -o out.ply", "--moved FILE writes the first shape"),
        ("match sample:sphere sample:torus --within 0", "above 0"),
    ] {
        let output = adwave(path).args(words(line)).assert().code(2).get_output().stderr.clone();
        let output = String::from_utf8(output).unwrap();
        assert!(output.contains(said) && output.lines().count() == 1, "{line}: {output}");
    }
    // Nothing in common is no error: there is no motion, and that is said.
    let found = json(path, "match sample:sphere sample:torus --vertices 900");
    assert!(found["motion"].is_null() && found["pairs"].as_array().unwrap().is_empty(), "{found}");
}

/// A wall of identical windows from x = `start` on, 10 wide.
fn facade(path: &std::path::Path, name: &str, start: f64) {
    let (columns, rows) = (100, 40);
    let step = |d: f64| 1.0 / (1.0 + (-d / 0.05).exp());
    let mut lines =
        vec!["OFF".to_owned(), format!("{} {} 0", columns * rows, 2 * (columns - 1) * (rows - 1))];
    for i in 0..columns {
        for j in 0..rows {
            let (x, y) = (start + 0.1 * f64::from(i), 0.1 * f64::from(j));
            let inside = (0.5 - ((x % 2.0) - 1.0).abs()).min(0.8 - (y - 2.1).abs());
            let sill = step(0.12 - (y - 1.1).abs()) * step(0.7 - ((x % 2.0) - 1.0).abs());
            lines.push(format!("{x} {y} {}", 0.12 * sill - 0.3 * step(inside)));
        }
    }
    for i in 0..columns - 1 {
        for j in 0..rows - 1 {
            let a = i * rows + j;
            lines.push(format!("3 {a} {} {}", a + rows, a + rows + 1));
            lines.push(format!("3 {a} {} {}", a + rows + 1, a + 1));
        }
    }
    std::fs::write(path.join(name), lines.join("\n")).unwrap();
}

#[test]
fn motions_between_repeated_windows_are_listed_and_share_the_confidence() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    facade(path, "left.off", 0.0);
    facade(path, "right.off", 4.0);
    let line = "match left.off right.off -o pairs.json --picture windows.png";
    let found = json(path, line);
    let equal = found["equal_motions"].as_array().unwrap();
    assert!(!found["motion"].is_null() && equal.len() >= 2, "{found}");
    // The windows repeat every 2, and 0 is the true motion.
    let is_true = |motion: &serde_json::Value| {
        motion["matrix"][0][3].as_f64().unwrap().abs() < 0.02 && motion["degrees"].as_f64().unwrap() < 0.5
    };
    assert!(equal.iter().chain([&found["motion"]]).any(is_true), "{found}");
    let confidence = |pair: &serde_json::Value| pair["confidence"].as_f64().unwrap();
    // A wide feature is within one σ of its partner under several motions.
    let is_narrow = |pair: &&serde_json::Value| pair["second"]["sigma"].as_f64().unwrap() < 0.95;
    let mut narrow = found["pairs"].as_array().unwrap().iter().filter(is_narrow);
    assert!(narrow.all(|pair| confidence(pair) <= 0.5));
    let output = adwave(path).args(words(line)).assert().success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    assert!(text.contains("not certain") && text.contains("fit equally well"), "{text}");
}

#[test]
fn a_shape_matches_itself_and_the_angle_is_a_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["bracket", "creature"] {
        let found = json(path, &format!("match sample:{name} sample:{name} --vertices 4000"));
        assert!(found["motion"]["degrees"].is_number(), "{found}");
        let motions = found["equal_motions"].as_array().unwrap().iter().chain([&found["motion"]]);
        assert!(motions.into_iter().any(|motion| motion["degrees"].as_f64().unwrap() < 0.01), "{found}");
        let found =
            json(path, &format!("diff sample:{name} sample:{name} --vertices 4000 --by closest --align"));
        assert!(found["motion"]["degrees"].as_f64().unwrap() < 0.01, "{found}");
        assert!(found["difference"]["rms"].as_f64().unwrap() < 1e-6, "{found}");
    }
}

#[test]
fn what_match_suggests_applies() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    adwave(path).args(words("sample creature --vertices 4000 -o a.off")).assert().success();
    let text = std::fs::read_to_string(path.join("a.off")).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let n: usize = lines[1].split_whitespace().next().unwrap().parse().unwrap();
    for line in &mut lines[2..2 + n] {
        *line = numbers(line).map(|c| (25.4 * c).to_string()).join(" ");
    }
    std::fs::write(path.join("b.off"), lines.join("\n")).unwrap();
    let output = adwave(path).args(words("match a.off b.off")).assert().success().get_output().stdout.clone();
    let text = String::from_utf8(output).unwrap();
    assert!(text.contains("no motion") && text.contains("--motion similarity"), "{text}");
    let found = json(path, "match a.off b.off --motion similarity");
    assert!((found["motion"]["scale"].as_f64().unwrap() - 25.4).abs() < 0.05, "{found}");
    let output = adwave(path).args(words("match sample:sphere sample:sphere")).assert().success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(text.contains("no motion") && !text.contains("similarity"), "{text}");
}
