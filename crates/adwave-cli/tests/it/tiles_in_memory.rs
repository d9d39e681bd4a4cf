//! Outputs of `adwave tiles` against those of the commands that work in memory, on the same files with the same options.

use crate::common;

use adwave::sample::Sample;
use adwave::shape::Polygons;
use adwave_io::{Field, FieldValues, LasReader, ReadLimits, ShapeFile, read_path, write_path};
use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;

/// Size of the cloud.
const N: usize = 6000;

/// Resolution of the coordinates, in model units.
const RESOLUTION: f64 = 0.001;

fn uniform(k: usize) -> f64 {
    let mixed =
        (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 53) as f64
}

/// A slope of class 2 with trees of class 5 and noise of class 7, far from the origin, with a withheld point, a record
/// without a position and a stray. The intensity is the row.
fn slope(path: &Path) {
    let at = |i: usize| [5e5 + 60.0 * uniform(3 * i), 4e6 + 60.0 * uniform(3 * i + 1)];
    let class = |i: usize| match i % 100 {
        7 => 7,
        k if k % 3 == 1 => 5,
        _ => 2,
    };
    let mut points: Vec<[f64; 3]> = (0..N)
        .map(|i| {
            let [x, y] = at(i);
            let ground = 100.0 + 0.5 * (x - 5e5) + (y / 7.0).sin() + 0.1 * uniform(3 * i + 2);
            let above = match class(i) {
                5 => 6.0 * uniform(7 * i + 1),
                7 => 40.0 * uniform(11 * i),
                _ => 0.0,
            };
            [x, y, ground + above].map(|c| (c / RESOLUTION).round() * RESOLUTION)
        })
        .collect();
    points[42] = [0.0; 3];
    points[41] = [5.02e5, 4.001e6, 900.0];
    let mut file = ShapeFile::from_cloud(points);
    let mut flags = vec![0; N];
    flags[50] = 4;
    let classes = FieldValues::U8((0..N).map(class).collect());
    for (name, values) in [
        ("intensity", FieldValues::U16((0..N as u16).collect())),
        ("classification", classes),
        ("classification_flags", FieldValues::U8(flags)),
    ] {
        file.add_vertex_field(Field::new(name, 1, values)).unwrap();
    }
    write_path(&file, &path.join("a.las"), None).unwrap();
    let mask: String = (0..N).map(|i| if i % 7 == 3 { "0\n" } else { "1\n" }).collect();
    fs::write(path.join("mask.csv"), format!("mask\n{mask}")).unwrap();
}

/// A bumpy plane with a border and a bumpy closed ball, with a field by which a part can be chosen.
fn plane_and_ball(path: &Path) -> usize {
    let Sample { mut points, faces } = Sample::from_name("plane", Some(6000)).unwrap();
    for (i, [x, y, z]) in points.iter_mut().enumerate() {
        *y += 0.05 * (9.0 * *x).sin() * (7.0 * *z).cos() + 0.01 * uniform(i);
    }
    let mut all = Polygons::new();
    faces.iter().for_each(|face| all.push(face));
    let first = points.len() as u32;
    let Sample { points: ball, faces } = Sample::from_name("sphere", Some(6000)).unwrap();
    points.extend(ball.iter().enumerate().map(|(i, p)| {
        let r = 0.3 + 0.05 * (7.0 * p[0]).sin() * (5.0 * p[1]).cos() + 0.004 * uniform(i + 99);
        [r * p[0], 2.0 + r * p[1], r * p[2]]
    }));
    for face in faces.iter() {
        all.push(&face.iter().map(|v| v + first).collect::<Vec<_>>());
    }
    let n = points.len();
    let mut file = ShapeFile::from_mesh(points, all);
    let kind = FieldValues::U8((0..n).map(|i| (i % 11 / 9) as u8).collect());
    file.add_vertex_field(Field::new("kind", 1, kind)).unwrap();
    write_path(&file, &path.join("a.ply"), None).unwrap();
    let mask: String = (0..n).map(|i| if i % 97 < 4 { "0\n" } else { "1\n" }).collect();
    fs::write(path.join("mesh-mask.csv"), format!("mask\n{mask}")).unwrap();
    n
}

fn read(path: &Path, name: &str) -> ShapeFile {
    read_path(&path.join(name), &ReadLimits::default()).unwrap()
}

/// Notes that the command prints.
fn notes(path: &Path, line: &str) -> String {
    let output = adwave(path).args(words(line)).assert().success().get_output().clone();
    String::from_utf8(output.stderr).unwrap()
}

/// Largest step of the coordinates of a LAS, in model units.
fn step(path: &Path, name: &str) -> f64 {
    LasReader::open(&path.join(name)).unwrap().layout().scale.into_iter().fold(0.0, f64::max)
}

/// For each row of the cloud the vertex in a file, by the intensity.
fn rows(file: &ShapeFile) -> Vec<usize> {
    let row = file.field("intensity").unwrap();
    let mut vertices = vec![usize::MAX; N];
    (0..file.n_vertices()).for_each(|v| vertices[row.get(v, 0) as usize] = v);
    assert!(vertices.iter().all(|v| *v != usize::MAX));
    vertices
}

/// Largest difference of the coordinates of two files, and the largest change of those of `b` from those of `start`.
fn differences(path: &Path, [a, b, start]: [&str; 3]) -> [f64; 2] {
    let files = [a, b, start].map(|name| read(path, name));
    let rows = if start == "a.las" {
        files.each_ref().map(rows)
    } else {
        let n = files[0].n_vertices();
        [(0..n).collect(), (0..n).collect(), (0..n).collect()]
    };
    let point = |file: usize, row: usize| files[file].points()[rows[file][row]];
    let distance = |p: [f64; 3], q: [f64; 3]| (0..3).map(|c| (p[c] - q[c]).abs()).fold(0.0, f64::max);
    let largest = |x: usize, y: usize| {
        (0..rows[0].len()).map(|row| distance(point(x, row), point(y, row))).fold(0.0, f64::max)
    };
    [largest(0, 1), largest(1, 2)]
}

#[test]
fn gains_move_points_as_the_filter_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    slope(path);
    for options in [
        "",
        "--along free",
        "--along normal",
        "--along surface",
        "--along x",
        "--along z",
        "--along z --local-fit constant",
        "--only classification=2",
        "--only classification=2,7 --along z",
        "--only z=..115 --along free",
        "--all-points",
        "--mask mask.csv",
        "--mask mask.csv --invert-mask --along z",
    ] {
        let gains = format!("--gains 0,0.5,1,0.8 --accuracy 1e-9 {options}");
        adwave(path).args(words(&format!("filter a.las -o memory.las -q {gains}"))).assert().success();
        let many = format!("tiles a.las -o many.las -q --tiles 2 --workers 2 {gains}");
        adwave(path).args(words(&many)).assert().success();
        let one = format!("tiles a.las -o one.las -q --tiles 1 --threads 1 {gains}");
        adwave(path).args(words(&one)).assert().success();
        assert!(fs::read(path.join("one.las")).unwrap() == fs::read(path.join("many.las")).unwrap());
        let [difference, moved] = differences(path, ["one.las", "memory.las", "a.las"]);
        assert!(difference <= 1.01 * step(path, "a.las"), "{options}: {difference}");
        assert!(moved > 4.0 * RESOLUTION, "{options}: {moved}");
    }
    for gains in ["--gains 0,0,0 --keep-volume twice", "--gains 0,0,0,2"] {
        let line =
            format!("tiles a.las -o {}.las -q {gains}", if gains.contains("keep") { "one" } else { "many" });
        adwave(path).args(words(&line)).assert().success();
    }
    assert!(fs::read(path.join("one.las")).unwrap() == fs::read(path.join("many.las")).unwrap());
}

#[test]
fn gains_move_vertices_as_the_filter_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    plane_and_ball(path);
    for options in [
        "",
        "--border free",
        "--along free",
        "--along normal",
        "--along z",
        "--along y --local-fit constant",
        "--only kind=0",
        "--only x=..0.4",
        "--only y=1.9..2.1 --along normal",
        "--mask mesh-mask.csv",
    ] {
        let gains = format!("--gains 0,0.5,1,0.8 --accuracy 1e-9 {options}");
        adwave(path).args(words(&format!("filter a.ply -o memory.ply -q {gains}"))).assert().success();
        let many = format!("tiles a.ply -o many.ply -q --tiles 3 --workers 2 {gains}");
        adwave(path).args(words(&many)).assert().success();
        let one = format!("tiles a.ply -o one.ply -q --tiles 1 --threads 1 {gains}");
        adwave(path).args(words(&one)).assert().success();
        assert!(fs::read(path.join("one.ply")).unwrap() == fs::read(path.join("many.ply")).unwrap());
        let [difference, moved] = differences(path, ["one.ply", "memory.ply", "a.ply"]);
        assert!(difference <= 1e-6 * moved, "{options}: {difference} of {moved}");
        assert!(moved > 1e-3, "{options}: {moved}");
    }
    let line = "--gains 0,0,0 --keep-volume twice --accuracy 1e-9";
    adwave(path).args(words(&format!("filter a.ply -o memory.ply -q {line}"))).assert().success();
    adwave(path).args(words(&format!("tiles a.ply -o one.ply -q {line}"))).assert().success();
    let [difference, moved] = differences(path, ["one.ply", "memory.ply", "a.ply"]);
    assert!(difference <= 1e-6 * moved, "{difference} of {moved}");
}

#[test]
fn maps_features_and_denoising_are_those_of_the_other_commands() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let n = plane_and_ball(path);
    slope(path);
    for (name, options) in
        [("a.ply", ""), ("a.ply", "--only kind=0"), ("a.las", ""), ("a.las", "--only classification=2")]
    {
        let (memory, tiles) = (format!("memory-{name}"), format!("tiles-{name}"));
        let line = format!("--levels 4 --accuracy 1e-9 {options}");
        let in_memory = format!("saliency {name} -o {memory} -q --weighting paper {line}");
        adwave(path).args(words(&in_memory)).assert().success();
        let in_tiles = format!("tiles {name} -o {tiles} -q --saliency=paper --tiles 2 {line}");
        adwave(path).args(words(&in_tiles)).assert().success();
        let files = [memory, tiles].map(|name| read(path, &name));
        let of_row =
            if name == "a.las" { files.each_ref().map(rows) } else { [0, 1].map(|_| (0..n).collect()) };
        let values = |k: usize| -> Vec<f64> {
            let map = files[k].field("saliency").unwrap();
            of_row[k].iter().map(|&v| map.get(v, 0)).collect()
        };
        let (memory, tiles) = (values(0), values(1));
        let most = memory.iter().copied().fold(0.0, f64::max);
        let mut n_left_out = 0;
        for (row, (a, b)) in memory.iter().zip(&tiles).enumerate() {
            assert!(
                a.is_nan() == b.is_nan() && (a.is_nan() || (a - b).abs() <= 1e-5 * most),
                "{name} {options} {row}: {a} {b}"
            );
            n_left_out += usize::from(a.is_nan());
        }
        assert!(most > 0.0 && (n_left_out > 0) != (options.is_empty() && name == "a.ply"), "{n_left_out}");
    }
    // Features of a mesh, which have the same order.
    let line = "--levels 5 --theta 1.2";
    adwave(path)
        .args(words(&format!("features a.ply -o memory.csv -q --operator walk {line}")))
        .assert()
        .success();
    let tiled = format!("tiles a.ply -o t.ply -q --saliency --features tiles.csv --tiles 3 {line}");
    adwave(path).args(words(&tiled)).assert().success();
    let column = |name: &str| {
        let text = fs::read_to_string(path.join(name)).unwrap();
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let at = lines.next().unwrap().split(',').position(|column| column == "vertex").unwrap();
        let vertex = |line: &str| line.split(',').nth(at).unwrap().parse::<u64>().unwrap();
        let mut vertices: Vec<u64> = lines.map(vertex).collect();
        vertices.sort_unstable();
        vertices
    };
    assert!(column("memory.csv").len() > 3);
    assert_eq!(column("memory.csv"), column("tiles.csv"));
    // Denoising, which leaves points out by the same rules.
    for options in ["", "--only classification=2"] {
        adwave(path).args(words(&format!("denoise a.las -o memory.las -q {options}"))).assert().success();
        adwave(path)
            .args(words(&format!("tiles a.las -o one.las -q --denoise {options}")))
            .assert()
            .success();
        let [difference, moved] = differences(path, ["one.las", "memory.las", "a.las"]);
        assert!(
            difference <= 2.01 * step(path, "a.las") && moved > 0.0,
            "{options}: {difference} of {moved}"
        );
    }
}

#[test]
fn points_that_take_no_part_are_counted_and_keep_their_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    slope(path);
    let said = json(path, "tiles a.las -o one.las --gains 0,0.5,1");
    let summary = &said["summary"];
    // Of class 7 there are 60 points, and one is withheld.
    assert_eq!((&summary["n_flagged"], &summary["n_placeholders"]), (&61.into(), &1.into()), "{said}");
    assert_eq!(summary["n_strays"], 1, "{said}");
    let text = notes(path, "tiles a.las -o one.las --gains 0,0.5,1 --only classification=2,7");
    assert!(text.contains("vertices take part: classification=2,7, without 1 point flagged"), "{text}");
    assert!(text.contains("1 placeholder without a real position"), "{text}");
    for (line, what) in [
        ("--gains 0,1 --only height=1", "there is no field for the condition 'height=1'"),
        ("--gains 0,1 --mask missing.csv", "there is no mask file 'missing.csv'"),
        ("--gains 0,1 --border free", "--border applies to meshes"),
        ("--gains 0,1 --local-fit linear", "--local-fit is for heights"),
        ("--gains 0,0 --keep-volume offset", "must be 'twice', got 'offset'"),
        ("--gains 0,0.5 --keep-volume twice", "does not drop every band"),
    ] {
        let said = refused(path, &format!("tiles a.las -o b.las {line}"));
        assert!(said.contains(what), "{line}: {said}");
        assert!(!path.join("b.las").exists() && !path.join("b.las.work").exists(), "{line}");
    }
    plane_and_ball(path);
    let said = refused(path, "tiles a.ply -o b.ply --gains 0,1 --border keep");
    assert!(said.contains("cannot keep borders"), "{said}");
    // A file of noise alone takes part.
    adwave(path).args(words("convert a.las -o noise.las -q --only classification=7")).assert().success();
    let said = json(path, "tiles noise.las -o n.las --gains 0,1");
    assert_eq!(
        (&said["summary"]["n_flagged"], &said["summary"]["n_points"]),
        (&0.into(), &60.into()),
        "{said}"
    );
}
