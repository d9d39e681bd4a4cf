//! Curves from files of every format that has edges and positions: filter, denoise, render, info.

use crate::common;

use common::{adwave, json, refused, words};
use serde_json::Value;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Points of a noisy helix.
fn helix() -> Vec<[f64; 3]> {
    let mut state = 1_u32;
    let mut uniform = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5
    };
    let mut noise = || 0.06 * (uniform() + uniform() + uniform()) / 3.0_f64.sqrt();
    (0..120_u32)
        .map(|i| f64::from(i) * 4.0 * std::f64::consts::PI / 119.0)
        .map(|t| [t.cos() + noise(), t.sin() + noise(), t / 5.0 + noise()])
        .collect()
}

/// Writes the helix as OBJ, PLY, legacy VTK and GraphML; gives the names.
fn write_helix(folder: &Path) -> [&'static str; 4] {
    let points = helix();
    let n = points.len();
    let rows = |start: &str| {
        points.iter().fold(String::new(), |mut text, p| {
            let _ = writeln!(text, "{start}{} {} {}", p[0], p[1], p[2]);
            text
        })
    };
    let numbers = |first: usize| (first..first + n).map(|k| k.to_string()).collect::<Vec<_>>().join(" ");
    fs::write(folder.join("line.obj"), format!("# track\n{}l {}\n", rows("v "), numbers(1))).unwrap();
    let mut ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {n}\nproperty double x\nproperty double y\nproperty double z\n\
         element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n{}",
        n - 1,
        rows("")
    );
    for k in 1..n {
        let _ = writeln!(ply, "{} {k}", k - 1);
    }
    fs::write(folder.join("line.ply"), ply).unwrap();
    let vtk = format!(
        "# vtk DataFile Version 3.0\nc\nASCII\nDATASET POLYDATA\nPOINTS {n} double\n{}LINES 1 {}\n{n} {}\n",
        rows(""),
        n + 1,
        numbers(0)
    );
    fs::write(folder.join("line.vtk"), vtk).unwrap();
    let mut xml =
        String::from("<?xml version=\"1.0\"?><graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">");
    for axis in ["x", "y", "z"] {
        let _ = write!(xml, "<key id=\"{axis}\" for=\"node\" attr.name=\"{axis}\" attr.type=\"double\"/>");
    }
    xml += "<graph edgedefault=\"undirected\">";
    for (k, p) in points.iter().enumerate() {
        let [x, y, z] = p;
        let _ = write!(
            xml,
            "<node id=\"n{k}\"><data key=\"x\">{x}</data><data key=\"y\">{y}</data><data key=\"z\">{z}</data></node>"
        );
    }
    for k in 1..n {
        let _ = write!(xml, "<edge source=\"n{}\" target=\"n{k}\"/>", k - 1);
    }
    fs::write(folder.join("line.graphml"), xml + "</graph></graphml>").unwrap();
    ["line.obj", "line.ply", "line.vtk", "line.graphml"]
}

fn number(report: &Value, keys: &[&str]) -> f64 {
    keys.iter().fold(report, |value, key| &value[key]).as_f64().unwrap_or(f64::NAN)
}

/// Coordinates of a file, by its conversion to text.
fn points(folder: &Path, name: &str) -> Vec<f64> {
    adwave(folder).args(words(&format!("convert {name} -o points.xyz"))).assert().success();
    let text = fs::read_to_string(folder.join("points.xyz")).unwrap();
    text.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn values(folder: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    text.lines().filter_map(|line| line.split(',').next_back()?.trim().parse().ok()).collect()
}

#[test]
fn coordinates_of_curves_are_smoothed_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in write_helix(path) {
        let extension = name.split('.').next_back().unwrap();
        let out = format!("s.{extension}");
        let report = json(path, &format!("filter {name} -o {out} --preset smooth"));
        let (before, after) = (number(&report, &["length", "before"]), number(&report, &["length", "after"]));
        assert!(
            number(&report, &["moved", "rms"]) > 1e-3 && after < before && after > 12.5,
            "{name}: {report}"
        );
        let info = json(path, &format!("info {out}"));
        assert!((number(&info, &["curve", "length"]) - after).abs() < 1e-4 * after, "{name}: {info}");
        assert_eq!(
            (info["curve"]["end_points"].as_u64(), info["curve"]["branch_points"].as_u64()),
            (Some(2), Some(0))
        );
        assert_eq!(info["health"]["edges"], 119, "{name}");
        let smooth = points(path, &out);
        assert_eq!(smooth.len(), 360, "{name}");
        for (end, k) in [(0, 0), (119, 357)] {
            for c in 0..3 {
                assert!((smooth[k + c] - helix()[end][c]).abs() < 1e-9, "{name}: an end moved");
            }
        }
        // Coordinates are three signals.
        json(path, &format!("filter {name} --signal x -o x.csv --preset smooth"));
        let column: Vec<f64> = smooth.iter().copied().step_by(3).collect();
        let alone = values(path, "x.csv");
        assert_eq!(alone.len(), 120);
        for (a, b) in column.iter().zip(&alone) {
            assert!((a - b).abs() < 1e-6, "{name}: {a} {b}");
        }
    }
    let text = adwave(path).args(words("filter line.obj -o s.obj --preset smooth")).output().unwrap().stdout;
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains("vertices moved by") && text.contains("length "), "{text}");
    assert!(fs::read_to_string(path.join("s.obj")).unwrap().starts_with("# track\n"));
}

#[test]
fn directions_borders_regions_and_widths_apply_to_curves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_helix(path);
    let before = points(path, "line.obj");
    let filter = |options: &str| {
        let report = json(path, &format!("filter line.obj -o s.obj --preset suppress {options}"));
        (points(path, "s.obj"), report)
    };
    let moved = |after: &[f64], k: usize| (after[k] - before[k]).abs() > 1e-9;
    let (along_z, _) = filter("--along z");
    assert!((0..360).all(|k| k % 3 == 2 || !moved(&along_z, k)) && moved(&along_z, 182));
    let (free, _) = filter("--border free");
    assert!(moved(&free, 0) && moved(&free, 359));
    for rule in ["natural", "keep"] {
        let (kept, _) = filter(&format!("--border {rule}"));
        assert!((0..3).chain(357..360).all(|k| !moved(&kept, k)) && moved(&kept, 180), "{rule}");
    }
    let (low, _) = filter("--region 'box:min=-9 -9 -9,max=9 9 1'");
    assert!((1..120).all(|v| before[3 * v + 2] <= 1.0 || (0..3).all(|c| !moved(&low, 3 * v + c))));
    assert!((1..20).any(|v| moved(&low, 3 * v)));
    filter("--region 'ball:vertex=60,radius=0.5'");
    for widths in ["--lengths 0.2,0.4", "--fwhm 0.3,0.6"] {
        let (_, report) = filter(widths);
        let finest = report["sigma"][1].as_f64().unwrap();
        let expected = if widths.contains("fwhm") { 0.3 / adwave::bands::FWHM } else { 0.2 };
        assert!((finest - expected).abs() < 1e-9, "{widths}: {report}");
    }
}

#[test]
fn curves_are_denoised_drawn_and_measured() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in write_helix(path) {
        let extension = name.split('.').next_back().unwrap();
        let report = json(path, &format!("denoise {name} -o d.{extension}"));
        let noise = number(&report, &["denoise", "noise"]);
        assert!((0.012..0.025).contains(&noise), "{name}: {report}");
        let after = points(path, &format!("d.{extension}"));
        let truth = |t: f64| [t.cos(), t.sin(), t / 5.0];
        let square = |rows: &[f64]| -> f64 {
            (0..120)
                .map(|i| truth(f64::from(i) * 4.0 * std::f64::consts::PI / 119.0))
                .zip(rows.chunks(3))
                .map(|(p, q)| (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>())
                .sum()
        };
        let share = (square(&after) / square(helix().as_flattened())).sqrt();
        assert!(share < 0.7, "{name}: {share}");
    }
    for options in ["", "--color z", "--grid --color plain --color x", "--region 'ball:vertex=60,radius=0.5'"]
    {
        let report = json(path, &format!("render line.obj -o line.png --size 300x200 {options}"));
        assert_eq!(report["shapes"][0]["vertices"], 120);
        assert!(fs::metadata(path.join("line.png")).unwrap().len() > 1000, "{options}");
    }
    let info = String::from_utf8(adwave(path).args(["info", "line.vtk"]).output().unwrap().stdout).unwrap();
    for line in
        ["edges         119", "components    1", "2 end points, 0 branch points", "heat by arc length"]
    {
        assert!(info.contains(line), "{line}: {info}");
    }
    // Each command works or gives one line.
    for line in [
        "saliency line.obj -o s.npy",
        "features line.obj -o f.csv",
        "transform line.obj -o t.npz",
        "basis line.obj --vertex 3 -o b.npy",
        "report line.obj -o r.html",
        "region line.obj 'box:min=0 0 0,max=1 1 1' -o w.npy",
        "simplify line.obj -o q.obj --vertices 10",
        "match line.obj line.obj",
        "diff line.obj line.obj",
        "convert line.obj c.ply",
        "filter line.obj -o k.obj --preset smooth --keep-volume",
        "filter line.obj -o k.obj --preset smooth --keep-creases",
        "denoise line.obj -o k.obj --signal z",
        "compare line.obj --with taubin",
    ] {
        let output = adwave(path).args(words(line)).output().unwrap();
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 2)), "{line}: {code:?} {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn broken_curves_give_an_error_of_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("nan.obj"), "v 0 0 0\nv nan 0 0\nv 1 0 0\nl 1 2 3\n").unwrap();
    for line in
        ["filter nan.obj -o s.obj --preset smooth", "denoise nan.obj -o s.obj", "render nan.obj -o s.png"]
    {
        assert!(refused(path, line).contains("finite"), "{line}");
    }
    // Weights decide the steps, so a position may be missing, but then no position can be smoothed.
    let pair = |x: &str| {
        format!(
            "<?xml version=\"1.0\"?><graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\
             <key id=\"x\" for=\"node\" attr.name=\"x\" attr.type=\"double\"/>\
             <key id=\"y\" for=\"node\" attr.name=\"y\" attr.type=\"double\"/>\
             <key id=\"w\" for=\"edge\" attr.name=\"weight\" attr.type=\"double\"/><graph edgedefault=\"undirected\">\
             <node id=\"a\"><data key=\"x\">{x}</data><data key=\"y\">0</data></node>\
             <node id=\"b\"><data key=\"x\">1</data><data key=\"y\">0</data></node>\
             <node id=\"c\"><data key=\"x\">3</data><data key=\"y\">1</data></node>\
             <edge source=\"a\" target=\"b\"><data key=\"w\">2</data></edge>\
             <edge source=\"b\" target=\"c\"><data key=\"w\">1</data></edge></graph></graphml>"
        )
    };
    fs::write(path.join("w.graphml"), pair("0")).unwrap();
    let report = json(path, "filter w.graphml -o s.graphml --preset smooth");
    assert_eq!(report["operator"], "walk");
    assert!(report["length"]["before"].as_f64().unwrap() > 3.0, "{report}");
    // Two vertices, no length, repeated edges and loops.
    for (name, text) in [
        ("two.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"),
        ("point.obj", "v 0 0 0\nv 0 0 0\nl 1 2\n"),
        ("again.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nl 1 2 1 2 3 3\n"),
    ] {
        fs::write(path.join(name), text).unwrap();
        for command in [
            "filter NAME -o s.obj --preset smooth",
            "denoise NAME -o s.obj",
            "render NAME -o s.png",
            "info NAME",
        ] {
            let line = command.replace("NAME", name);
            let output = adwave(path).args(words(&line)).output().unwrap();
            let code = output.status.code();
            assert!(
                matches!(code, Some(0 | 2)),
                "{line}: {code:?} {}",
                String::from_utf8_lossy(&output.stderr)
            );
        }
    }
}
