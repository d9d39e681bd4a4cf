//! `simplify`, and `info --detail`, which says what fewer bands lose.

use crate::common;

use adwave_test_data::data_test;
use common::{adwave, json, refused, words};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A textured sheet of n × n squares with a bump, cut by a seam down its middle, of two materials.
fn textured(folder: &Path, n: usize) {
    let side = n + 1;
    let mut text = "mtllib sheet.mtl\n".to_owned();
    for k in 0..side * side {
        let (x, y) = ((k % side) as f64 / n as f64, (k / side) as f64 / n as f64);
        let height = 0.2 * (-20.0 * ((x - 0.4).powi(2) + (y - 0.5).powi(2))).exp();
        text += &format!("v {x} {y} {height}\n");
    }
    // The left half of the picture is upside down: each vertex of the seam has two places.
    for k in 0..side * side {
        let (x, y) = ((k % side) as f64 / n as f64, (k / side) as f64 / n as f64);
        text += &format!("vt {x} {y}\nvt {x} {}\n", 1.0 - y);
    }
    for (material, columns) in [("left", 0..n / 2), ("right", n / 2..n)] {
        text += &format!("usemtl {material}\n");
        for (row, column) in (0..n).flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let k = row * side + column;
            let corner = |v: usize| format!("{}/{}", v + 1, 2 * v + 1 + usize::from(material == "left"));
            text += &format!("f {} {} {}\n", corner(k), corner(k + 1), corner(k + side));
            text += &format!("f {} {} {}\n", corner(k + 1), corner(k + side + 1), corner(k + side));
        }
    }
    fs::write(folder.join("sheet.obj"), text).unwrap();
}

#[test]
fn an_error_is_kept_to_and_measured() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let found = json(path, "simplify sample:creature -o small.ply --error 0.2% --measure");
    let (before, after) = (number(&found["vertices"]["before"]), number(&found["vertices"]["after"]));
    assert!(after < 0.6 * before, "{before} → {after}");
    let allowed = 0.002 * number(&found["diagonal"]) * (1.0 + 1e-9);
    assert!(number(&found["error"]["greatest"]) <= number(&found["within"]) * (1.0 + 1e-9));
    assert!(number(&found["within"]) <= allowed && number(&found["seconds"]["measure"]) > 0.0);
    // Without the measurement the same mesh, and the distance that the collapses have proven.
    let unmeasured = json(path, "simplify sample:creature -o same.ply --error 0.2%");
    assert_eq!((&unmeasured["error"], &unmeasured["within"]), (&Value::Null, &found["within"]));
    assert_eq!(fs::read(path.join("small.ply")).unwrap(), fs::read(path.join("same.ply")).unwrap());
    let said = adwave(path).args(words("simplify sample:creature -o s.ply --error 0.2%")).assert().success();
    let said = String::from_utf8(said.get_output().stdout.clone()).unwrap();
    assert!(said.contains("no point of either surface is farther than"), "{said}");
    let said = adwave(path).args(words("simplify sample:creature -o s.ply --ratio 0.5")).assert().success();
    let said = String::from_utf8(said.get_output().stdout.clone()).unwrap();
    assert!(said.contains("not measured (--measure)"), "{said}");
    let said = refused(path, "simplify sample:creature --as cloud -o s.ply --ratio 0.5 --measure");
    assert!(said.contains("clouds are always measured"), "{said}");
    assert_eq!(number(&json(path, "info small.ply")["health"]["vertices"]), after);
    let text = adwave(path)
        .args(words("simplify sample:creature -o small.ply --vertices 500 --measure"))
        .assert()
        .success();
    let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
    assert!(
        text.contains("vertices") && text.contains("rms by area") && text.contains("no point is farther"),
        "{text}"
    );
    // Nothing to do: the file goes out as it came.
    let same = json(path, "simplify small.ply -o same.ply --vertices 5000");
    assert_eq!(same["changed"], false);
    assert_eq!(fs::read(path.join("small.ply")).unwrap(), fs::read(path.join("same.ply")).unwrap());
}

#[test]
fn corners_keep_texture_coordinates_of_their_own_vertex_and_side() {
    let folder = tempfile::tempdir().unwrap();
    textured(folder.path(), 20);
    let found = json(folder.path(), "simplify sheet.obj -o small.obj --error 0.2%");
    assert!(number(&found["vertices"]["after"]) < 300.0, "{found}");
    let text = fs::read_to_string(folder.path().join("small.obj")).unwrap();
    let rows = |keyword: &str| -> Vec<Vec<f64>> {
        let lines = text.lines().filter_map(|line| line.strip_prefix(keyword)?.strip_prefix(' '));
        lines.map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect()).collect()
    };
    let (points, places) = (rows("v"), rows("vt"));
    let (mut material, mut seen) = (String::new(), [0; 2]);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("usemtl ") {
            material = name.to_owned();
        }
        let Some(face) = line.strip_prefix("f ") else { continue };
        let is_left = material == "left";
        seen[usize::from(is_left)] += 1;
        for corner in face.split(' ') {
            let (v, vt) = corner.split_once('/').unwrap();
            let (p, t) =
                (&points[v.parse::<usize>().unwrap() - 1], &places[vt.parse::<usize>().unwrap() - 1]);
            let y = if is_left { 1.0 - p[1] } else { p[1] };
            assert!((t[0] - p[0]).abs() < 1e-12 && (t[1] - y).abs() < 1e-12, "{p:?} has {t:?} in {material}");
            assert!(if is_left { p[0] <= 0.5 } else { p[0] >= 0.5 }, "{p:?} in {material}");
        }
    }
    assert!(text.starts_with("mtllib sheet.mtl\n") && seen[0] > 0 && seen[1] > 0, "{seen:?}");
}

#[test]
fn clouds_keep_what_points_carry_and_stay_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut rows = "x,y,z,intensity\n".to_owned();
    for k in 0..4000 {
        rows += &format!("{},{},0,{k}\n", f64::from(k % 80) * 0.1, f64::from(k / 80) * 0.1);
    }
    fs::write(path.join("scan.csv"), rows).unwrap();
    let found = json(path, "simplify scan.csv -o thin.csv --error 0.25");
    assert!(number(&found["error"]["greatest"]) < 0.25 && number(&found["spacing"]) == 0.25);
    let text = fs::read_to_string(path.join("thin.csv")).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len() as f64, number(&found["vertices"]["after"]));
    for row in &rows {
        let k = (row[1] * 10.0).round() * 80.0 + (row[0] * 10.0).round();
        assert_eq!(row[3], k, "{row:?}");
    }
    let cloud = json(path, "simplify sample:creature --as cloud -o thin.ply --vertices 1000");
    assert!((number(&cloud["vertices"]["after"]) - 1000.0).abs() <= 20.0, "{cloud}");
    assert_eq!(json(path, "info thin.ply")["kind"], "cloud");
}

#[test]
fn what_cannot_be_asked_for_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("one.obj"), "v 0 0 0\n").unwrap();
    fs::write(path.join("flat.obj"), "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n").unwrap();
    fs::write(path.join("nan.obj"), "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(path.join("g.mtx"), "%%MatrixMarket matrix coordinate pattern symmetric\n2 2 1\n2 1\n")
        .unwrap();
    for (line, said) in [
        ("simplify one.obj -o o.ply --vertices 0", "at least 1, got 0"),
        ("simplify one.obj -o o.ply --error -1", "must be finite and not negative"),
        ("simplify one.obj -o o.ply --error nan", "must be finite and not negative"),
        ("simplify one.obj -o o.ply --ratio 0", "at most 1, got 0.0"),
        ("simplify one.obj -o o.docx --vertices 1", "o.docx"),
        ("simplify one.obj -o o.ply --vertices 1 --keep-border", "--keep-border"),
        ("simplify flat.obj -o o.ply --vertices 1", "flat.obj: no face has a positive area"),
        ("simplify nan.obj -o o.ply --vertices 1", "not finite"),
        ("simplify g.mtx -o o.ply --vertices 1", "a graph has no positions, so it cannot be simplified"),
        ("info g.mtx --detail", "no detail"),
        ("info one.obj --error -2", "must be finite and not negative"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(said), "{line}: {error}");
    }
    adwave(path).args(words("simplify one.obj -o o.ply")).assert().code(2);
    adwave(path).args(words("simplify one.obj -o o.ply --error 1 --ratio 0.5")).assert().code(2);
    assert!(!path.join("o.ply").exists());
    assert_eq!(json(path, "simplify one.obj -o o.ply --vertices 9")["changed"], false);
}

#[test]
fn fewer_vertices_than_the_parts_need_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut text = String::new();
    for k in 0..3 {
        text += &format!("v {k} 0 0\nv {k}.5 0 0\nv {k} 0.5 0\nv {k} 0 0.5\nv {k}.15 0.15 0\n");
        for face in [[1, 3, 5], [3, 2, 5], [2, 1, 5], [1, 2, 4], [2, 3, 4], [3, 1, 4]] {
            let [a, b, c] = face.map(|v| v + 5 * k);
            text += &format!("f {a} {b} {c}\n");
        }
    }
    fs::write(path.join("parts.obj"), text).unwrap();
    let said = adwave(path).args(words("simplify parts.obj -o few.obj --vertices 5")).assert().success();
    let said = String::from_utf8(said.get_output().stderr.clone()).unwrap();
    assert!(
        said.contains("note: asked for 5 vertices, reached 12: 3 parts need at least 12 vertices"),
        "{said}"
    );
    let found = json(path, "simplify parts.obj -o few.obj --vertices 13 --measure");
    assert_eq!((number(&found["vertices"]["after"]), &found["reached"]), (13.0, &Value::Bool(true)));
    let error = &found["error"];
    assert!(number(&error["at_least"]) <= number(&error["greatest"]));
}

#[test]
fn a_red_disc_in_a_flat_blue_square_survives() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let n = 30_u32;
    let side = n + 1;
    let is_red = |x: f64, y: f64| (x / f64::from(n) - 0.5).hypot(y / f64::from(n) - 0.5) < 0.25;
    let cells = (0..n * n).map(|s| (s % n, s / n));
    let faces: Vec<([u32; 3], bool)> = cells
        .flat_map(|(x, y)| {
            let k = y * side + x;
            let red = is_red(f64::from(x) + 0.5, f64::from(y) + 0.5);
            [([k, k + 1, k + side], red), ([k + 1, k + side + 1, k + side], red)]
        })
        .collect();
    let (mut colored, mut obj) = (String::new(), "mtllib m.mtl\n".to_owned());
    for k in 0..side * side {
        let (x, y) = (k % side, k / side);
        let color = if is_red(f64::from(x), f64::from(y)) { "255 0 0" } else { "0 0 255" };
        colored += &format!("{x} {y} 0 {color}\n");
        obj += &format!("v {x} {y} 0\n");
    }
    for ([a, b, c], red) in &faces {
        colored += &format!("3 {a} {b} {c}\n");
        let material = if *red { "red" } else { "blue" };
        obj += &format!("usemtl {material}\nf {} {} {}\n", a + 1, b + 1, c + 1);
    }
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        side * side,
        faces.len()
    );
    fs::write(path.join("colored.ply"), header + &colored).unwrap();
    fs::write(path.join("materials.obj"), obj).unwrap();
    for target in ["--error 3%", "--vertices 60"] {
        json(path, &format!("simplify colored.ply -o small.csv {target}"));
        let rows = fs::read_to_string(path.join("small.csv")).unwrap();
        let red = rows.lines().skip(1).filter(|row| row.contains("255,0,0")).count();
        assert!(red >= 6, "{red} red vertices at {target}: {rows}");
        let found = json(path, &format!("simplify materials.obj -o small.obj {target}"));
        assert!(number(&found["vertices"]["after"]) < 200.0, "{found}");
        let text = fs::read_to_string(path.join("small.obj")).unwrap();
        let points: Vec<Vec<f64>> = text
            .lines()
            .filter_map(|line| line.strip_prefix("v "))
            .map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect())
            .collect();
        let (mut red, mut is_red) = (0.0, false);
        for line in text.lines() {
            if let Some(material) = line.strip_prefix("usemtl ") {
                is_red = material == "red";
            }
            let Some(face) = line.strip_prefix("f ").filter(|_| is_red) else { continue };
            let corners: Vec<&Vec<f64>> =
                face.split(' ').map(|v| &points[v.parse::<usize>().unwrap() - 1]).collect();
            let [a, b, c] = [corners[0], corners[1], corners[2]];
            red += 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        }
        let disc = std::f64::consts::PI * (0.25 * f64::from(n)).powi(2);
        assert!((red / disc - 1.0).abs() < 0.15, "the red area is {red} of {disc} at {target}");
    }
}

/// Vertices less edges plus faces, and the number of edges with more than two faces.
fn topology(faces: &[[u32; 3]]) -> (i64, usize) {
    let mut edges = std::collections::BTreeMap::new();
    for &[a, b, c] in faces {
        for [x, y] in [[a, b], [b, c], [c, a]] {
            *edges.entry([x.min(y), x.max(y)]).or_insert(0) += 1;
        }
    }
    let vertices: std::collections::BTreeSet<u32> = faces.iter().flatten().copied().collect();
    let characteristic = vertices.len() as i64 - edges.len() as i64 + faces.len() as i64;
    (characteristic, edges.values().filter(|&&n| n > 2).count())
}

#[data_test]
fn a_part_with_long_triangles_keeps_its_distance_and_its_handles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let part = Path::new(adwave_test_data::folder!()).join("domains/points/PUNet/casting/casting.off");
    fs::copy(part, path.join("part.off")).unwrap();
    let read = |name: &str| {
        let file = adwave_io::read_path(&path.join(name), &adwave_io::ReadLimits::default()).unwrap();
        (file.points().to_vec(), adwave::shape::triangulate(file.points(), file.faces()))
    };
    let before = read("part.off");
    let apart = |p: [f64; 3], q: [f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt();
    // A triangle reaches from its first corner as far as its longer side there.
    let with_reach = |t: [[f64; 3]; 3]| (t, apart(t[0], t[1]).max(apart(t[0], t[2])));
    let triangles: Vec<_> = before.1.iter().map(|t| with_reach(t.map(|x| before.0[x as usize]))).collect();
    for target in ["--error 0.2%", "--ratio 0.2", "--ratio 0.05"] {
        let found = json(path, &format!("simplify part.off -o small.off {target} --measure"));
        let after = read("small.off");
        assert_eq!(topology(&before.1), topology(&after.1), "{target}");
        let greatest = number(&found["error"]["greatest"]);
        if target.starts_with("--error") {
            assert!(greatest <= 0.002 * number(&found["diagonal"]) * (1.0 + 1e-9), "{found}");
        }
        // Edge midpoints and centers were measured before; other points were up to nine times farther.
        for face in after.1.iter().step_by(7) {
            let [a, b, c] = face.map(|x| after.0[x as usize]);
            for [u, v] in [[0.3, 0.1], [0.1, 0.7], [0.25, 0.0]] {
                let p: [f64; 3] = std::array::from_fn(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
                let bound = greatest * (1.0 + 1e-6);
                let mut near = triangles.iter().filter(|(t, reach)| apart(p, t[0]) <= reach + bound);
                assert!(
                    near.any(|(t, _)| distance(p, *t) <= bound),
                    "{p:?} is farther away at {target} than {greatest}"
                );
            }
        }
    }
}

/// Distance of a point from a triangle: to its plane inside of it, else to its edges.
fn distance(p: [f64; 3], corners: [[f64; 3]; 3]) -> f64 {
    let minus = |u: [f64; 3], v: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| u[k] - v[k]) };
    let dot = |u: [f64; 3], v: [f64; 3]| -> f64 { u.iter().zip(v).map(|(u, v)| u * v).sum() };
    let cross = |u: [f64; 3], v: [f64; 3]| {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
    let (mut is_inside, mut nearest) = (true, f64::INFINITY);
    for k in 0..3 {
        let (from, along) = (corners[k], minus(corners[(k + 1) % 3], corners[k]));
        is_inside &= dot(cross(normal, along), minus(p, from)) >= 0.0;
        let t = (dot(minus(p, from), along) / dot(along, along).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let to = minus(minus(p, from), along.map(|x| t * x));
        nearest = nearest.min(dot(to, to).sqrt());
    }
    let area = dot(normal, normal).sqrt();
    if is_inside && area > 0.0 { dot(minus(p, corners[0]), normal).abs() / area } else { nearest }
}

#[test]
fn detail_says_which_bands_can_go_and_the_command_does_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let plain = json(path, "info sample:creature --vertices 2000");
    assert!(plain["detail"].is_null());
    for error in ["3%", "0.2"] {
        let line = format!("info sample:creature --vertices 2000 --error {error}");
        let found = json(path, &line);
        let levels = found["detail"]["levels"].as_array().unwrap();
        assert_eq!(levels.len() as u64, found["levels"].as_u64().unwrap());
        let within = &found["detail"]["within"];
        for measure in ["greatest", "rms"] {
            let level = within[measure]["level"].as_u64().unwrap() as usize;
            let bound = number(&within["error"]);
            assert!(number(&levels[level - 1][measure]) <= bound);
            assert!(levels.get(level).is_none_or(|next| number(&next[measure]) > bound));
        }
        // The command moves the vertices by what was said.
        let level = within["greatest"]["level"].as_u64().unwrap() as usize;
        let command = within["greatest"]["command"].as_str().unwrap();
        let moved = json(path, command.strip_prefix("adwave ").unwrap());
        let (said, done) = (number(&levels[level - 1]["greatest"]), number(&moved["moved"]["max"]));
        assert!((said - done).abs() < 1e-9, "{said} is not {done}");
    }
    let text = adwave(path).args(words("info sample:creature --vertices 2000 --error 3%")).assert().success();
    let text = String::from_utf8(text.get_output().stdout.clone()).unwrap();
    assert!(text.contains("rms by area") && text.contains("can be dropped:\n  adwave filter"), "{text}");
    let none = adwave(path).args(words("info sample:creature --vertices 2000 --error 0")).assert().success();
    assert!(String::from_utf8_lossy(&none.get_output().stdout).contains("no band can be dropped"));
}

#[test]
fn bands_agree_where_they_are_wider_than_the_edges() {
    use adwave::bands::Schedule;
    use adwave::operator::{OperatorKind, OperatorParams};
    use adwave::shape::Shape;
    use adwave::{Decomposer, Progress};
    use adwave_simplify::{MeshParams, MeshTarget, simplify_mesh};
    let file = adwave::sample::Sample::from_name("creature", Some(12_000)).unwrap();
    let mesh = adwave::shape::Mesh::new(file.points, file.faces).unwrap();
    let simplified =
        simplify_mesh(&mesh, None, &MeshParams::new(MeshTarget::Ratio(0.33)), Progress::none()).unwrap();
    let points: Vec<[f64; 3]> = simplified.kept.iter().map(|&x| mesh.points()[x as usize]).collect();
    let triangles = adwave::shape::Polygons::from_triangles(&simplified.triangles);
    let small = adwave::shape::Mesh::new(points, triangles).unwrap();
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let of = |mesh: &adwave::shape::Mesh| {
        Decomposer::with_params(&Shape::Mesh(mesh.clone()), &params, Progress::none()).unwrap()
    };
    let (whole, part) = (of(&mesh), of(&small));
    let edge = part.mean_length();
    let widths: Vec<f64> = [2.5, 4.0, 6.0, 9.0].iter().map(|k| k * edge).collect();
    let bands = |decomposer: &Decomposer, mesh: &adwave::shape::Mesh| {
        let schedule = Schedule::lengths(&widths, decomposer.operator().step_length()).unwrap();
        decomposer.decompose(mesh.points().as_flattened(), 3, &schedule).unwrap()
    };
    let (whole, part) = (bands(&whole, &mesh), bands(&part, &small));
    // Band 1 holds what is finer than the first width, which the smaller mesh has lost in part.
    for j in 2..=widths.len() {
        let (mut difference, mut size) = (0.0, 0.0);
        for (k, &x) in simplified.kept.iter().enumerate() {
            for c in 0..3 {
                let (a, b) = (whole.wavelet(j)[3 * x as usize + c], part.wavelet(j)[3 * k + c]);
                difference += (a - b) * (a - b);
                size += a * a;
            }
        }
        let relative = f64::sqrt(difference / size);
        assert!(relative < 0.08, "band {j}: {relative}");
    }
}
