//! Computation on a part of the data: the rest keeps its values and is nobody's neighbor.

use crate::common;

use adwave::shape::Polygons;
use adwave_io::{
    Field, FieldValues, ReadLimits, ShapeFile, read_csv_fields, read_npy, read_path, write_path,
};
use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;

const N: usize = 30;
/// Standard deviation of the noise of the ground in meters, and the largest error after filtering.
const NOISE: f64 = 0.030;
const GREATEST_ERROR: f64 = 0.020;

fn uniform(k: usize) -> f64 {
    let mixed =
        (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 53) as f64
}

/// Normally distributed number by the method of Box and Muller.
fn normal(k: usize) -> f64 {
    let (a, b) = (uniform(2 * k + 100_001), uniform(2 * k + 100_002));
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Ground of class 2 and a third of vegetation of class 5 above it, in one table and the ground in another.
fn forest(path: &Path) -> Vec<bool> {
    let (mut all, mut ground, mut is_ground) = (String::new(), String::new(), Vec::new());
    for i in 0..N * N {
        let (x, y) = ((i % N) as f64 + 0.3 * uniform(3 * i), (i / N) as f64 + 0.3 * uniform(3 * i + 1));
        let z = (x / 7.0).sin() + (y / 9.0).cos() + 0.05 * uniform(7 * i + 2);
        let is_low = i % 3 != 1;
        let z = if is_low { z } else { z + 1.0 + 9.0 * uniform(5 * i) };
        let row = format!("{x} {y} {z} {}\n", if is_low { 2 } else { 5 });
        if is_low {
            ground += &row;
        }
        all += &row;
        is_ground.push(is_low);
    }
    let head = "x y z classification\n";
    fs::write(path.join("all.txt"), format!("{head}{all}")).unwrap();
    fs::write(path.join("ground.txt"), format!("{head}{ground}")).unwrap();
    is_ground
}

fn read(path: &Path, name: &str) -> ShapeFile {
    read_path(&path.join(name), &ReadLimits::default()).unwrap()
}

/// Notes that the command prints.
fn notes(path: &Path, line: &str) -> String {
    let output = adwave(path).args(words(line)).assert().success().get_output().clone();
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_part_is_filtered_as_if_the_rest_were_absent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let is_ground = forest(path);
    json(path, "filter ground.txt --preset smooth --along z -o alone.txt");
    let mask: String = is_ground.iter().map(|&is_low| if is_low { "1\n" } else { "0\n" }).collect();
    let inverse: String = is_ground.iter().map(|&is_low| if is_low { "nan\n" } else { "3\n" }).collect();
    fs::write(path.join("mask.csv"), format!("in\n{mask}")).unwrap();
    fs::write(path.join("inverse.csv"), format!("out\n{inverse}")).unwrap();
    let (before, alone) = (read(path, "all.txt"), read(path, "alone.txt"));
    for part in [
        "--only classification=2",
        "--only classification=..3",
        "--only classification=1,2..3 --only z=-100..100",
        "--mask mask.csv",
        "--mask inverse.csv --invert-mask",
    ] {
        json(path, &format!("filter all.txt --preset smooth --along z {part} -o part.txt"));
        let after = read(path, "part.txt");
        let mut filtered = alone.points().iter();
        for (i, &is_low) in is_ground.iter().enumerate() {
            let expected = if is_low { filtered.next().unwrap() } else { &before.points()[i] };
            assert_eq!(&after.points()[i], expected, "{part}, row {i}");
        }
    }
    // Alone in an array the rest keeps its values too.
    json(path, "filter all.txt --preset smooth --field z --only classification=2 -o z.npy");
    let array = read_npy(&path.join("z.npy"), &ReadLimits::default()).unwrap().into_field("z");
    let kept = (0..N * N).filter(|&i| !is_ground[i]).all(|i| array.get(i, 0) == before.points()[i][2]);
    assert!(array.len() == N * N && kept);
}

/// Wavy ground with noise, and 35 % of vegetation up to 15 m above it.
fn terrain(path: &Path) -> Vec<Option<f64>> {
    const SIDE: usize = 110;
    let (mut rows, mut heights) = (String::new(), Vec::new());
    for i in 0..SIDE * SIDE {
        let jitter = |k: usize| 0.8 * uniform(11 * i + k);
        let (x, y) = (0.5 * ((i % SIDE) as f64 + jitter(0)), 0.5 * ((i / SIDE) as f64 + jitter(1)));
        let height = 300.0 + 0.2 * x + 1.5 * (x / 15.0).sin() * (y / 18.0).cos();
        let is_ground = uniform(17 * i + 5) >= 0.35;
        let z = height + if is_ground { NOISE * normal(i) } else { 0.3 + 15.0 * uniform(19 * i + 3) };
        rows += &format!("{x} {y} {z} {}\n", if is_ground { 2 } else { 3 + i % 3 });
        heights.push(is_ground.then_some(height));
    }
    fs::write(path.join("land.txt"), format!("x y z classification\n{rows}")).unwrap();
    heights
}

#[test]
fn ground_among_vegetation_is_smoothed_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let heights = terrain(path);
    let before = fs::read_to_string(path.join("land.txt")).unwrap();
    for command in ["filter land.txt --preset smooth --along z", "denoise land.txt"] {
        let said = notes(path, &format!("{command} --only classification=2 -o out.txt"));
        assert!(said.contains("of 12100 vertices of land.txt take part: classification=2"), "{said}");
        let text = fs::read_to_string(path.join("out.txt")).unwrap();
        let (mut sum, mut n) = (0.0, 0);
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        for ((old, new), height) in before.lines().zip(lines).skip(1).zip(&heights) {
            match height {
                None => assert_eq!(old, new, "{command}"),
                Some(height) => {
                    let z: f64 = new.split_whitespace().nth(2).unwrap().parse().unwrap();
                    sum += (z - height).powi(2);
                    n += 1;
                }
            }
        }
        let rms = (sum / f64::from(n)).sqrt();
        println!("{command}: {rms}");
        assert!(rms <= GREATEST_ERROR, "{command}: {rms}");
    }
}

/// Sheet of quadrangles with fields of several types at its vertices; a fifth of the vertices has class 7.
fn sheet(path: &Path, name: &str) {
    let points: Vec<[f64; 3]> = (0..N * N)
        .map(|i| {
            let (x, y) = ((i % N) as f64, (i / N) as f64);
            [x, y, (x / 5.0).sin() * (y / 6.0).cos() + 0.2 * uniform(i)]
        })
        .collect();
    let mut faces = Polygons::new();
    for i in 0..(N - 1) * N {
        if i % N < N - 1 {
            let i = i as u32;
            faces.push(&[i, i + 1, i + 1 + N as u32, i + N as u32]);
        }
    }
    let mut file = ShapeFile::from_mesh(points, faces);
    let class: Vec<i32> = (0..N * N).map(|i| if i % N < 6 { 7 } else { 2 }).collect();
    let quality: Vec<f32> = (0..N * N).map(|i| if i % N < 6 { f32::NAN } else { 0.1 }).collect();
    let color: Vec<u8> = (0..3 * N * N).map(|i| i as u8).collect();
    for (name, n_channels, values) in [
        ("class", 1, FieldValues::I32(class)),
        ("quality", 1, FieldValues::F32(quality)),
        ("color", 3, FieldValues::U8(color)),
    ] {
        file.add_vertex_field(Field::new(name, n_channels, values)).unwrap();
    }
    write_path(&file, &path.join(name), None).unwrap();
}

#[test]
fn a_part_of_a_mesh_keeps_the_rest_and_all_faces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sheet(path, "sheet.ply");
    let before = read(path, "sheet.ply");
    for part in ["--only class=2", "--only quality=0.1", "--only quality=..", "--only quality=0.1..0.1"] {
        json(path, &format!("filter sheet.ply --preset smooth {part} -o out.ply"));
        let after = read(path, "out.ply");
        assert_eq!(after.faces(), before.faces(), "{part}");
        for i in 0..N * N {
            assert_eq!(after.points()[i] == before.points()[i], i % N < 6, "{part}, row {i}");
        }
        for field in before.vertex_fields() {
            let kept = after.field(&field.name).unwrap();
            let bits = |field: &Field| field.to_f64().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(kept), bits(field), "{part}, {}", field.name);
        }
    }
    // A result per vertex is missing at the others.
    json(path, "saliency sheet.ply --only class=2 -o map.ply");
    let map = read(path, "map.ply");
    let map = map.field("saliency").unwrap();
    assert!((0..N * N).all(|i| map.get(i, 0).is_nan() == (i % N < 6)));
}

#[test]
fn a_selection_of_all_vertices_changes_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sheet(path, "sheet.ply");
    forest(path);
    fs::write(path.join("ones.csv"), "in\n".to_owned() + &"1\n".repeat(N * N)).unwrap();
    for (shape, part) in [
        ("sheet.ply", "--only class=2,7"),
        ("sheet.ply", "--mask ones.csv"),
        ("all.txt", "--only classification=.."),
    ] {
        let ending = shape.rsplit('.').next().unwrap();
        let line = |out: &str| format!("filter {shape} --preset smooth -o {out}.{ending}");
        json(path, &line("plain"));
        json(path, &format!("{} {part}", line("part")));
        let bytes = |name: &str| fs::read(path.join(format!("{name}.{ending}"))).unwrap();
        assert!(bytes("plain") == bytes("part"), "{shape} {part}");
    }
}

#[test]
fn every_command_takes_a_part() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sheet(path, "sheet.ply");
    sheet(path, "other.ply");
    let n_part = N * N - 6 * N;
    for command in [
        "info sheet.ply",
        "transform sheet.ply -o bands.npz",
        "filter sheet.ply --preset smooth -o out.ply",
        "denoise sheet.ply -o out.ply",
        "saliency sheet.ply -o map.npy",
        "features sheet.ply -o features.csv",
        "region sheet.ply --region ball:vertex=400,radius=10% -o weight.npy",
        "basis sheet.ply --vertex 400 --level 3 -o basis.ply",
        "simplify sheet.ply --ratio 0.5 -o out.ply",
        "diff sheet.ply other.ply",
        "match sheet.ply other.ply",
        "evaluate sheet.ply --runs 1 --percent 10",
        "compare sheet.ply --with taubin -o compared",
        "render sheet.ply -o picture.png",
        "report sheet.ply -o report.html",
        "convert sheet.ply -o converted.vtp",
    ] {
        let said = notes(path, &format!("{command} --only class=2"));
        let noted = format!("{n_part} of {} vertices of sheet.ply", N * N);
        assert!(said.contains(&noted), "{command}: {said}");
    }
    assert_eq!(read(path, "converted.vtp").n_vertices(), n_part);
}

#[test]
fn a_part_is_simplified_and_the_rest_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sheet(path, "sheet.ply");
    let before = read(path, "sheet.ply");
    let found = json(path, "simplify sheet.ply --ratio 0.3 --only class=2 -o out.ply");
    assert_eq!(found["vertices"]["before"], N * N - 6 * N);
    let after = read(path, "out.ply");
    let class = after.field("class").unwrap();
    let rest: Vec<[f64; 3]> =
        (0..after.n_vertices()).filter(|&i| class.get(i, 0) == 7.0).map(|i| after.points()[i]).collect();
    let expected: Vec<[f64; 3]> = (0..N * N).filter(|i| i % N < 6).map(|i| before.points()[i]).collect();
    assert_eq!(rest, expected);
    assert!(after.n_vertices() < 6 * N + (N * N - 6 * N) / 2);
    // The surface has no gap along the cut: its only border is the outline of the sheet.
    let mut edges = std::collections::HashMap::new();
    for face in after.faces().iter() {
        for k in 0..face.len() {
            let (a, b) = (face[k], face[(k + 1) % face.len()]);
            *edges.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    let last = (N - 1) as f64;
    let on_outline = |x: u32| {
        let [x, y, _] = after.points()[x as usize];
        x == 0.0 || y == 0.0 || x == last || y == last
    };
    for ((a, b), n) in edges {
        assert!(n == 2 || (n == 1 && on_outline(a) && on_outline(b)), "edge {a} {b} has {n} faces");
    }
    forest(path);
    json(path, "simplify all.txt --ratio 0.3 --only classification=2 -o thin.txt");
    let thin = read(path, "thin.txt");
    let class = thin.field("classification").unwrap();
    let n_high = (0..class.len()).filter(|&i| class.get(i, 0) == 5.0).count();
    let n_low = class.len() - n_high;
    assert!(n_high == N * N / 3 && n_low.abs_diff(180) < 18, "{n_high} {n_low}");
}

/// Terrain as LAS: noise of class 7 and 18 and withheld points far below and above the ground.
fn scan(path: &Path, name: &str) -> Vec<bool> {
    let mut points = Vec::new();
    let (mut class, mut flags, mut is_taken) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..N * N {
        let (x, y) = ((i % N) as f64 + 0.3 * uniform(3 * i), (i / N) as f64 + 0.3 * uniform(3 * i + 1));
        let (of_class, of_flags, above) = match i % 20 {
            3 => (7, 0, -1.5),
            8 => (18, 0, 1.5),
            13 => (2, 4, 0.7),
            14 => (2, 1, 0.0), // synthetic, which takes part
            _ => (2, 0, 0.0),
        };
        points.push([x, y, (x / 7.0).sin() + 0.05 * uniform(7 * i) + above]);
        class.push(of_class);
        flags.push(of_flags);
        is_taken.push(of_class == 2 && of_flags != 4);
    }
    let mut file = ShapeFile::from_cloud(points);
    for (name, values) in [("classification", class), ("classification_flags", flags)] {
        file.add_vertex_field(Field::new(name, 1, FieldValues::U8(values))).unwrap();
    }
    write_path(&file, &path.join(name), None).unwrap();
    is_taken
}

#[test]
fn withheld_and_noise_points_take_no_part() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for name in ["scan.las", "scan.laz"] {
        let is_taken = scan(path, name);
        let before = read(path, name);
        assert_eq!(before.field("classification_flags").unwrap().get(13, 0), 4.0);
        let n_taken = is_taken.iter().filter(|&&taken| taken).count();
        let line = format!("filter {name} --preset smooth --along z -o out.las");
        let said = notes(path, &line);
        let noted = format!("{n_taken} of {} points of {name} take part: without 135 points flagged", N * N);
        assert!(said.contains(&noted), "{said}");
        let after = read(path, "out.las");
        assert_eq!(after.vertex_fields(), before.vertex_fields());
        for (i, &taken) in is_taken.iter().enumerate() {
            assert_eq!(after.points()[i] == before.points()[i], !taken, "{name}, row {i}");
        }
        // All points on request, and those of noise if a condition asks for them.
        let said = notes(path, &format!("{line} --all-points"));
        assert!(!said.contains("take part"), "{said}");
        let after = read(path, "out.las");
        assert!((0..N * N).all(|i| after.points()[i] != before.points()[i]));
        let said = notes(path, &format!("info {name} --only classification=7"));
        assert!(said.contains(&format!("45 of {} vertices", N * N)), "{said}");
        // A conversion computes nothing and keeps all.
        let said = notes(path, &format!("convert {name} -o copy.laz"));
        assert!(!said.contains("take part"), "{said}");
        assert_eq!(read(path, "copy.laz").n_vertices(), N * N);
    }
}

#[test]
fn a_cloud_of_noise_alone_is_computed_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut file = ShapeFile::from_cloud((0..60).map(|i| [uniform(i), uniform(i + 99), 0.0]).collect());
    file.add_vertex_field(Field::new("classification", 1, FieldValues::U8(vec![7; 60]))).unwrap();
    write_path(&file, &path.join("noise.las"), None).unwrap();
    assert!(!notes(path, "info noise.las").contains("take part"));
}

/// FreeSurfer label of these vertices.
fn label(vertices: impl Iterator<Item = usize>) -> String {
    let rows: Vec<String> = vertices.map(|v| format!("{v}  1.5  -2.0  0.25 0.0000000000\n")).collect();
    format!("#!ascii label  , from subject fsaverage vox2ras=TkReg\n{}\n{}", rows.len(), rows.concat())
}

/// FreeSurfer annotation with these regions, of which `region(i)` is the one of vertex i; beyond the names it has none.
fn annotation(names: &[&str], region: impl Fn(usize) -> usize) -> Vec<u8> {
    let color = |k: usize| if k < names.len() { 1 + 7 * k as i32 } else { 0 };
    let mut numbers = vec![(N * N) as i32];
    numbers.extend((0..N * N).flat_map(|i| [i as i32, color(region(i))]));
    let mut bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_be_bytes()).collect();
    let mut put = |numbers: &[i32], text: &str| {
        bytes.extend(numbers.iter().flat_map(|x| x.to_be_bytes()));
        if !text.is_empty() {
            bytes.extend((text.len() as i32 + 1).to_be_bytes());
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
    };
    put(&[1, -2, names.len() as i32], "colors");
    put(&[names.len() as i32], "");
    for (k, name) in names.iter().enumerate() {
        put(&[k as i32], name);
        put(&[color(k), 0, 0, 0], "");
    }
    bytes
}

#[test]
fn the_medial_wall_keeps_its_zeros_and_does_not_leak() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    sheet(path, "lh.ply");
    let is_wall = |i: usize| i % N < 6;
    let values: String = (0..N * N)
        .map(|i| if is_wall(i) { "0\n".to_owned() } else { format!("{}\n", 1000.0 + normal(i)) })
        .collect();
    fs::write(path.join("bold.csv"), format!("bold\n{values}")).unwrap();
    fs::write(path.join("lh.cortex.label"), label((0..N * N).filter(|&i| !is_wall(i)))).unwrap();
    fs::write(path.join("lh.Medial_wall.label"), label((0..N * N).filter(|&i| is_wall(i)))).unwrap();
    let names = ["unknown", "precentral", "postcentral", "corpuscallosum"];
    let regions = annotation(&names, |i| match i % N {
        0..2 => 0,
        2..4 => 3,
        4..6 => 9,
        6..15 => 1,
        _ => 2,
    });
    fs::write(path.join("lh.aparc.annot"), regions).unwrap();
    for (mask, meaning) in [
        ("lh.cortex.label", "the vertices that the label lists take part; --invert-mask"),
        ("lh.Medial_wall.label", "the label lists the medial wall, which takes no part"),
        ("lh.aparc.annot", "without a region and those of unknown, corpuscallosum take no part"),
        ("lh.aparc.annot:precentral,postcentral", "the regions precentral,postcentral take part"),
    ] {
        let said =
            notes(path, &format!("filter lh.ply --field bold.csv --preset smooth --mask {mask} -o out.csv"));
        assert!(said.contains(meaning), "{mask}: {said}");
        assert!(said.contains(&format!("720 of {} vertices", N * N)), "{mask}: {said}");
        let smooth = &read_csv_fields(&path.join("out.csv"), &ReadLimits::default()).unwrap()[0];
        for i in 0..N * N {
            let value = smooth.get(i, 0);
            assert!(
                if is_wall(i) { value == 0.0 } else { (value - 1000.0).abs() < 5.0 },
                "{mask}: {i} {value}"
            );
        }
    }
    let said = notes(path, "info lh.ply --mask lh.cortex.label --invert-mask");
    assert!(
        said.contains(&format!("180 of {} vertices", N * N)) && said.contains("the inverse of"),
        "{said}"
    );
    // Written with the shape, the values outside stay as well.
    json(path, "filter lh.ply --field bold.csv --preset smooth --mask lh.cortex.label -o out.ply");
    let out = read(path, "out.ply");
    let bold = out.field("bold").unwrap();
    assert!((0..N * N).all(|i| (bold.get(i, 0) == 0.0) == is_wall(i)));
}

#[test]
fn conditions_are_joined_by_and() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    forest(path);
    let said = notes(path, "info all.txt --only classification=2 --only x=..10");
    let file = read(path, "all.txt");
    let n = (0..file.n_vertices())
        .filter(|&i| file.field("classification").unwrap().get(i, 0) == 2.0 && file.points()[i][0] <= 10.0)
        .count();
    assert!(said.contains(&format!("{n} of 900 vertices")), "{said}");
}

#[test]
fn selections_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    forest(path);
    sheet(path, "sheet.ply");
    fs::write(path.join("short.csv"), "in\n1\n0\n").unwrap();
    fs::write(path.join("two.csv"), "a,b\n".to_owned() + &"1,0\n".repeat(N * N)).unwrap();
    fs::write(path.join("zeros.csv"), "in\n".to_owned() + &"0\n".repeat(N * N)).unwrap();
    fs::write(path.join("far.label"), label([900].into_iter())).unwrap();
    fs::write(path.join("cut.label"), label(0..9).replace("\n9\n", "\n12\n")).unwrap();
    for (shape, part, said) in [
        (
            "all.txt",
            "--only classification=9",
            "no vertex fulfills classification=9; the values of the field are 2 to 5",
        ),
        ("all.txt", "--only classification=2 --only classification=5", "none fulfills classification=2 and"),
        ("all.txt", "--only class=2", "use classification, x, y, z"),
        ("all.txt", "--only classification", "must be FIELD=VALUE"),
        ("all.txt", "--only classification=two", "must be FIELD=VALUE"),
        ("all.txt", "--only classification=", "must be FIELD=VALUE"),
        ("all.txt", "--only =2", "must be FIELD=VALUE"),
        ("all.txt", "--only classification=nan", "must be FIELD=VALUE"),
        ("all.txt", "--only classification=1..2..3", "must be FIELD=VALUE"),
        ("all.txt", "--only classification=3..2", "LOW must not be above HIGH"),
        ("sheet.ply", "--only color=2", "one number per vertex, and this one has 3; use class, quality"),
        ("all.txt", "--mask short.csv", "a number for each of 900 vertices, got 2 rows"),
        ("all.txt", "--mask two.csv", "one number per vertex, got 2; select a column with two.csv:NAME"),
        ("all.txt", "--mask zeros.csv", "no vertex takes part"),
        ("all.txt", "--mask none.npy", "there is no mask file 'none.npy'"),
        ("all.txt", "--mask far.label", "vertex 900 must be in 0..900"),
        ("all.txt", "--mask cut.label", "must have 12 rows, got 9"),
        ("sample:sphere", "--only class=2", "use x, y, z"),
    ] {
        let text = refused(path, &format!("info {shape} {part}"));
        assert!(text.contains(said), "{part}: {text}");
    }
    json(path, "info all.txt --mask two.csv:a");
    adwave(path).args(words("info all.txt --invert-mask")).assert().code(2);
}

#[test]
fn tiles_leave_out_the_same_points_and_say_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    scan(path, "scan.las");
    let line = "tiles scan.las -o out.las --gains 0,0.5 --memory 1G";
    let said = notes(path, &format!("{line} --only classification=2"));
    assert!(
        said.contains("765 of 900 vertices take part: classification=2, without 45 points flagged"),
        "{said}"
    );
    let said = notes(path, line);
    assert!(said.contains("without 135 points flagged as withheld or classified as noise"), "{said}");
}

#[test]
fn notes_name_rows_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    forest(path);
    // A stray among the points that take part, after 900 others.
    let text = fs::read_to_string(path.join("all.txt")).unwrap() + "5 5 900 2\n";
    fs::write(path.join("all.txt"), text).unwrap();
    for command in [
        "filter all.txt --preset smooth -o out.txt",
        "saliency all.txt -o map.npy",
        "denoise all.txt -o out.txt",
    ] {
        let said = notes(path, &format!("{command} --only classification=2"));
        if !command.starts_with("denoise") {
            assert!(said.contains("1 point far from all others (row 900)"), "{command}: {said}");
        }
    }
}
