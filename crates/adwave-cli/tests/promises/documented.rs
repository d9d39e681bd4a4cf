//! Every command in the help, and in the documents for files that the reader has, runs as it is written, in a folder of small files
//! of the names that they use. The other commands of the guides run in an empty folder (`pages`).

use crate::cells_file::write_cells_file;
use crate::fixtures::{levels, quads, sky, tensors};
use crate::harness::{Faults, commands, is_in_sample, run_line, runs_all};
use crate::pages::PAGES;
use crate::wording::wording_faults;
use adwave::sample::{NoiseSigma, Sample};
use adwave_io::{Field, FieldValues, ShapeFile, write_path};
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Words of commands that cannot run here, with the reason.
const SKIPPED: [(&str, &str); 9] = [
    (".copc.laz", "COPC is not written"),
    (".e57", "E57 is not written"),
    (".nc ", "NetCDF is not written"),
    ("parallel ", "needs GNU parallel"),
    ("$SLURM", "needs Slurm"),
    ("tiles/ run 2", "small files have one run"),
    ("tiles/ neighbors 3", "small files have one tile"),
    ("tiles/ bands 3", "small files have one tile"),
    ("tiles/ maps 3", "small files have one tile"),
];

/// Beginning of the first line of a block whose commands take a file of the reader.
const OWN_FILE: &str = "# your own file";

/// Beginnings of lines without `adwave` that make folders and files for the commands after them.
const PREPARING: [&str; 3] = ["mkdir", "printf ", "(for "];

/// A command with the place where it stands.
pub(crate) struct Documented {
    place: String,
    line: String,
    /// Tells if it takes a file of the reader, which no line before it writes.
    pub(crate) takes_own_file: bool,
}

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Commands in fenced blocks of shell lines, loops as a whole.
pub(crate) fn in_document(path: &Path) -> Vec<Documented> {
    let text = fs::read_to_string(path).unwrap();
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    let (mut found, mut is_shell, mut in_code, mut line) = (Vec::new(), false, false, String::new());
    let mut takes_own_file = false;
    let mut rows = text.lines().enumerate().peekable();
    while let Some((k, row)) = rows.next() {
        if let Some(language) = row.trim().strip_prefix("```") {
            in_code = !in_code;
            is_shell = language == "sh";
            takes_own_file = rows.peek().is_some_and(|(_, next)| next.trim_start().starts_with(OWN_FILE));
            line.clear();
            continue;
        }
        if !(in_code && is_shell) || row.trim_start().starts_with('#') {
            continue;
        }
        line += row;
        let is_open_loop = line.trim_start().starts_with("for ") && row.trim() != "done";
        if let Some(rest) = line.strip_suffix('\\') {
            line = rest.to_owned();
        } else if is_open_loop {
            line.push('\n');
        } else {
            let line = std::mem::take(&mut line);
            if line.contains("adwave ") || PREPARING.iter().any(|word| line.starts_with(word)) {
                found.push(Documented { place: format!("{name}:{}", k + 1), line, takes_own_file });
            }
        }
    }
    found
}

/// Examples in the help of all commands.
fn in_help(folder: &Path) -> Vec<Documented> {
    let mut found = Vec::new();
    let all = commands();
    for name in all.iter().map(clap::Command::get_name).chain([""]) {
        let help = run_line(folder, &format!("{name} --help"));
        let examples = help.out.lines().skip_while(|line| !line.starts_with("Examples:")).skip(1);
        let mut line = String::new();
        for row in examples.take_while(|row| !row.is_empty()) {
            // A line that the help has broken cannot be copied: a long command goes on behind a backslash.
            let is_whole = line.is_empty() == row.starts_with("  adwave ");
            assert!(
                is_whole,
                "adwave {name} --help: '{row}' is a part of an example; end the line before with \\"
            );
            // What an example does stands behind it.
            let part = row.trim().split("   ").next().unwrap_or_default();
            if let Some(part) = part.strip_suffix('\\') {
                line += part;
                continue;
            }
            let command = std::mem::take(&mut line) + part;
            let place = format!("adwave {name} --help");
            found.push(Documented { place, line: command, takes_own_file: true });
        }
    }
    found
}

/// A creature with a field of numbers and colors.
fn creature(n_vertices: usize, scale: f64, seed: u64) -> ShapeFile {
    let mut sample = Sample::from_name("creature", Some(n_vertices)).unwrap();
    sample.add_noise(NoiseSigma::MeanEdge(0.1), seed).unwrap();
    let points: Vec<[f64; 3]> = sample.points.iter().map(|p| p.map(|c| scale * c)).collect();
    let mut file = ShapeFile::from_mesh(points, sample.faces);
    add_fields(&mut file);
    file
}

fn add_fields(file: &mut ShapeFile) {
    let points = file.points().to_vec();
    let thickness: Vec<f64> = points.iter().map(|p| 2.0 + (3.0 * p[0]).sin() + p[1]).collect();
    let gaze: Vec<f64> = points.iter().map(|p| (p[1] - 1.0).max(0.0)).collect();
    let color: Vec<u8> = points.iter().flat_map(|p| p.map(|c| (100.0 + 50.0 * c.sin()) as u8)).collect();
    for (name, n, values) in [
        ("thickness", 1, FieldValues::F64(thickness)),
        ("gaze", 1, FieldValues::F64(gaze)),
        ("color", 3, FieldValues::U8(color)),
    ] {
        file.add_vertex_field(Field::new(name, n, values)).unwrap();
    }
}

/// Land with ground, water and noise.
fn land(offset: f64) -> ShapeFile {
    let point = |k: u32| {
        let (x, y) = (f64::from(k % 40), f64::from(k / 40));
        [x + offset, y, 30.0 + (0.3 * x).sin() + (0.2 * y).cos() + 0.03 * f64::from(k * 7919 % 13)]
    };
    let mut file = ShapeFile::from_cloud((0..1600).map(point).collect());
    let classes = (0..1600).map(|k| if k % 50 == 7 { 9 } else { 2 }).collect();
    file.add_vertex_field(Field::new("classification", 1, FieldValues::U8(classes))).unwrap();
    let intensity = (0..1600_u32).map(|k| (100 + k % 40) as u16).collect();
    file.add_vertex_field(Field::new("intensity", 1, FieldValues::U16(intensity))).unwrap();
    file
}

/// Writes a file of every name that documents and help use.
fn write_named_files(folder: &Path) {
    let at = |name: &str| folder.join(name);
    let save = |file: &ShapeFile, name: &str| {
        write_path(file, &at(name), None).unwrap();
    };
    let names = [
        "bunny.obj",
        "bunny.ply",
        "bust.obj",
        "scan.obj",
        "scan.ply",
        "scan.pcd",
        "tile.obj",
        "before.obj",
        "before.ply",
        "a.ply",
        "face-scan.ply",
        "model.glb",
        "surface.vtu",
        "map.ply",
        "cat.ply",
        "low.obj",
        "calm.obj",
        "base.obj",
        "bent.obj",
    ];
    let model = creature(2000, 1.0, 1);
    for name in names {
        save(&model, name);
    }
    let other = creature(2000, 1.0, 2);
    for name in ["after.obj", "after.ply", "b.ply", "smile.obj"] {
        save(&other, name);
    }
    for (name, seed) in [("scan1.ply", 3), ("scan2.ply", 4)] {
        save(&creature(6000, 1.0, seed), name);
    }
    save(&creature(6000, 0.0254, 3), "bust-in-inches.obj");
    let brain = creature(2000, 30.0, 1);
    for name in ["brain.ply", "brain.gii", "part.stl", "lh.pial"] {
        save(&brain, name);
    }
    save(&creature(2100, 30.0, 2), "printed.ply");
    for name in ["scan.laz", "scan.las", "land.laz", "lidar.laz", "flight-1.laz"] {
        save(&land(0.0), name);
    }
    save(&land(40.0), "flight-2.laz");
    write_curves_and_graphs(folder);
    write_cells(folder);
    write_cortex(folder, &brain);
    write_spheres(folder);
    let n = model.n_vertices();
    let values: Vec<f64> = (0..n).map(|k| (k as f64 / 50.0).cos()).collect();
    adwave_io::write_npy(&at("other.npy"), &[n], adwave_io::ArrayValues::F64(&values)).unwrap();
    for line in [
        "sample hills --vertices 4096 -o hills.tif",
        "sample hills --vertices 4096 -o dem.tif",
        "sample bold --vertices 1500 -o bold.nii.gz",
        "sample head --vertices 8000 -o volume.nii.gz",
    ] {
        assert!(run_line(folder, line).is_done(), "{line}");
    }
    let mut flow = model.clone();
    let wind = flow.points().iter().flat_map(|p| [-p[1], p[0], 0.2]).collect();
    flow.add_vertex_field(Field::new("wind", 3, FieldValues::F64(wind))).unwrap();
    save(&flow, "flow.ply");
    write_path(&tensors(), &at("dti.nii.gz"), None).unwrap();
    write_texture(folder);
    write_frames(folder, &model);
    for folder in ["models", "textured-models", "FOLDER"] {
        fs::create_dir_all(at(folder)).unwrap();
        save(&model, &format!("{folder}/armadillo.obj"));
    }
    let recipe = "levels = 4\n[[layer]]\npreset = \"suppress\"\nregion = \"ball:vertex=120,radius=10%\"\n";
    fs::write(at("edit.toml"), recipe).unwrap();
    let pose = "[pose]\nfixed = 'ball:vertex=7,radius=10%'\n[[pose.handle]]\nregion = 'ball:vertex=1972,radius=5%'\nby = [0.0, 0.0, 0.3]\n";
    fs::write(at("pose.toml"), pose).unwrap();
    fs::write(at("leap.toml"), pose.replace("0.0, 0.0, 0.3", "0.0, 0.2, 0.0")).unwrap();
}

/// Frames of a shape that sways, as files and as an array.
fn write_frames(folder: &Path, model: &ShapeFile) {
    const FRAMES: usize = 12;
    let rest = model.points().to_vec();
    let sway = |x: usize, t: usize| {
        let [a, b, c] = rest[x];
        [a, b, c + 0.05 * (0.6 * t as f64 + 2.0 * a).sin() + 0.002 * ((x * 37 + t * 11) % 13) as f64]
    };
    let mut frame = ShapeFile::from_mesh(rest.clone(), model.faces().clone());
    fs::create_dir(folder.join("walk")).unwrap();
    for t in 0..FRAMES {
        frame.set_points((0..rest.len()).map(|x| sway(x, t)).collect()).unwrap();
        write_path(&frame, &folder.join(format!("walk/{}.obj", t + 1)), None).unwrap();
    }
    let value = |k: usize| sway(k / FRAMES / 3, k % FRAMES)[k / FRAMES % 3];
    let values: Vec<f64> = (0..3 * rest.len() * FRAMES).map(value).collect();
    let sizes = [rest.len(), 3, FRAMES];
    adwave_io::write_npy(&folder.join("moves.npy"), &sizes, adwave_io::ArrayValues::F64(&values)).unwrap();
}

fn write_curves_and_graphs(folder: &Path) {
    let vertex =
        |k: u32| format!("v {} {} 0\n", k, 10.0 * (f64::from(k) / 15.0).sin() + 0.1 * f64::from(k * 37 % 11));
    let vertices: String = (0..120).map(vertex).collect();
    let path = (1..=120).map(|k: u32| k.to_string()).collect::<Vec<_>>().join(" ");
    fs::write(folder.join("track.obj"), format!("{vertices}l {path}\n")).unwrap();
    assert!(run_line(folder, "convert track.obj -o centerline.vtk").is_done());
    let edges: String = (1..=50).fold(String::new(), |text, k| text + &format!("{} {k} 1\n", k % 50 + 1));
    let head = "%%MatrixMarket matrix coordinate real general";
    fs::write(folder.join("network.mtx"), format!("{head}\n50 50 50\n{edges}")).unwrap();
}

/// Cells on a ring with counts, coordinates, their graph and their walk.
fn write_cells(folder: &Path) {
    let (n, n_genes) = (60_usize, 45_usize);
    let count = |x: usize, g: usize| {
        (4.0 + 3.0 * (x as f64 / 9.5 + g as f64).sin()).floor() + f64::from((x * 7 + g * 3) as u32 % 3)
    };
    let save = |name: &str, n_columns: usize, value: &dyn Fn(usize, usize) -> f64| {
        let values: Vec<f64> = (0..n * n_columns).map(|i| value(i / n_columns, i % n_columns)).collect();
        adwave_io::write_npy(&folder.join(name), &[n, n_columns], adwave_io::ArrayValues::F64(&values))
            .unwrap();
    };
    save("counts.npy", n_genes, &count);
    write_cells_file(&folder.join("cells.h5ad"), n, n_genes, &count);
    for name in ["pca.npy", "cells.npy", "genes.npy", "x.npy"] {
        save(name, 6, &|x, c| {
            (x as f64 / 9.5 * (1.0 + (c / 2) as f64) + (c % 2) as f64).sin() + 0.01 * (x * 31 % 17) as f64
        });
    }
    save("f.npy", 1, &|x, _| (x as f64 / 9.5).sin());
    let (mut counts, mut ring, mut walk, mut edges) =
        (String::new(), String::new(), String::new(), String::new());
    for x in 1..=n {
        let (before, after) = ((x + n - 2) % n + 1, x % n + 1);
        (1..=n_genes).for_each(|g| counts += &format!("{x} {g} {}\n", count(x - 1, g - 1)));
        ring += &format!("{x} {before} 1\n{x} {after} 1\n");
        walk += &format!("{x} {x} 0.5\n{x} {before} 0.25\n{x} {after} 0.25\n");
        edges += &format!("{} {}\n", x - 1, after - 1);
    }
    let head = "%%MatrixMarket matrix coordinate real general";
    for (name, n_columns, n_entries, entries) in [
        ("counts.mtx", n_genes, n * n_genes, &counts),
        ("neighbors.mtx", n, 2 * n, &ring),
        ("graph.mtx", n, 2 * n, &ring),
        ("walk.mtx", n, 3 * n, &walk),
    ] {
        fs::write(folder.join(name), format!("{head}\n{n} {n_columns} {n_entries}\n{entries}")).unwrap();
    }
    fs::write(folder.join("edges.txt"), edges).unwrap();
}

/// Surfaces, fields, labels and an annotation as neuroimaging has them.
fn write_cortex(folder: &Path, brain: &ShapeFile) {
    let at = |name: &str| folder.join(name);
    for name in ["pial.gii", "pial.gii.gz", "white.gii", "white_left.gii.gz"] {
        assert!(run_line(folder, &format!("convert lh.pial -o {name}")).is_done(), "{name}");
    }
    let n = brain.n_vertices();
    let field = |name: &str, n_channels: usize| {
        let values = (0..n * n_channels).map(|k| (k as f64 / 40.0).sin() + 2.0).collect();
        Field::new(name, n_channels, FieldValues::F64(values))
    };
    let structure = adwave_io::read_path(&at("white.gii"), &adwave_io::ReadLimits::default()).unwrap();
    let structure = structure.structure();
    for name in ["thick.gii.gz", "thickness.gii", "sulc.gii.gz"] {
        adwave_io::write_gifti_fields(&at(name), &[field("value", 1)], structure).unwrap();
    }
    let cut = levels();
    write_path(&cut, &at("fsaverage5.gii"), None).unwrap();
    write_path(&quads(), &at("sculpture.obj"), None).unwrap();
    fs::write(at("sky.fits"), sky()).unwrap();
    let sulc = Field::new("value", 1, FieldValues::F64((0..cut.n_vertices()).map(|k| k as f64).collect()));
    adwave_io::write_gifti_fields(&at("sulc5.gii"), &[sulc], structure).unwrap();
    adwave_io::write_gifti_fields(&at("bold.func.gii"), &[field("bold", 3)], structure).unwrap();
    adwave_io::write_cifti_fields(
        &at("rest.dtseries.nii"),
        &[field("rest", 3)],
        structure.expect("lh.pial states its structure"),
        adwave_io::CiftiColumns::Series,
    )
    .unwrap();
    let rows: String = (0..n - 20).fold(String::new(), |text, k| text + &format!("{k} 0 0 0 0\n"));
    fs::write(at("lh.cortex.label"), format!("#!ascii label\n{}\n{rows}", n - 20)).unwrap();
    fs::write(at("lh.aparc.annot"), annotation(n)).unwrap();
}

/// Spheres of both hemispheres in two sizes, with a thickness, areas and labels on one.
fn write_spheres(folder: &Path) {
    let at = |name: &str| folder.join(name);
    let sphere = |n: usize, name: &str| {
        let mesh = Sample::from_name("sphere", Some(n)).unwrap();
        let file = ShapeFile::from_mesh(mesh.points, mesh.faces);
        write_path(&file, &at(name), Some(adwave_io::Format::FREESURFER)).unwrap();
        file
    };
    for (side, short) in [("lh", "L"), ("rh", "R")] {
        let file = sphere(700, &format!("{side}.sphere.reg"));
        sphere(400, &format!("{side}.sphere"));
        assert!(run_line(folder, &format!("convert {side}.sphere -o {short}.sphere.surf.gii")).is_done());
        let n = file.n_vertices();
        for (name, lift) in [("thickness", 2.0_f32), ("area", 0.7)] {
            let mut bytes = vec![255, 255, 255];
            for word in [n as i32, 2 * n as i32 - 4, 1] {
                bytes.extend(word.to_be_bytes());
            }
            file.points().iter().for_each(|p| bytes.extend((p[2] as f32 + lift).to_be_bytes()));
            fs::write(at(&format!("{side}.{name}")), bytes).unwrap();
        }
        fs::write(at(&format!("{side}.yeo7.annot")), annotation(n)).unwrap();
    }
}

/// A FreeSurfer annotation with two regions and the rest.
fn annotation(n: usize) -> Vec<u8> {
    let names = ["unknown", "precentral", "postcentral"];
    let color = |k: usize| [25 * k as i32 + 5, 5, 50];
    let label = |k: usize| {
        let [r, g, b] = color(k);
        r + (g << 8) + (b << 16)
    };
    let mut words: Vec<i32> = vec![n as i32];
    words.extend((0..n).flat_map(|v| [v as i32, label(v * 3 / n)]));
    let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_be_bytes()).collect();
    let int = |bytes: &mut Vec<u8>, value: i32| bytes.extend(value.to_be_bytes());
    let text = |bytes: &mut Vec<u8>, text: &str| {
        bytes.extend((text.len() as i32 + 1).to_be_bytes());
        bytes.extend(text.as_bytes());
        bytes.push(0);
    };
    int(&mut bytes, 1);
    int(&mut bytes, -2);
    int(&mut bytes, names.len() as i32);
    text(&mut bytes, "colors");
    int(&mut bytes, names.len() as i32);
    for (k, name) in names.iter().enumerate() {
        int(&mut bytes, k as i32);
        text(&mut bytes, name);
        color(k).iter().chain(&[0]).for_each(|c| int(&mut bytes, *c));
    }
    bytes
}

fn write_texture(folder: &Path) {
    let mut text = "mtllib cow.mtl\nusemtl m\n".to_owned();
    for k in 0..400 {
        let (x, y) = (f64::from(k % 20), f64::from(k / 20));
        text += &format!("v {x} {y} {}\nvt {} {}\n", (0.7 * x).sin(), x / 19.0, y / 19.0);
    }
    for k in (0..380).filter(|k| k % 20 != 19) {
        let [a, b, c, d] = [k + 1, k + 2, k + 22, k + 21];
        text += &format!("f {a}/{a} {b}/{b} {c}/{c} {d}/{d}\n");
    }
    fs::write(folder.join("cow.obj"), text).unwrap();
    fs::write(folder.join("cow.mtl"), "newmtl m\nmap_Kd cow.png\n").unwrap();
    image::RgbImage::from_fn(32, 32, |x, y| image::Rgb([(8 * x) as u8, (8 * y) as u8, (x * y) as u8]))
        .save(folder.join("cow.png"))
        .unwrap();
}

/// A line with smaller shapes where sizes only say how fast something is, and without the taking of its time.
pub(crate) fn shrink_sizes(line: &str) -> String {
    let line = line.replace("--points 1e8", "--points 3e3").replace("--vertices 1000000", "--vertices 6000");
    line.trim_start_matches("time ").to_owned()
}

/// A line with smaller shapes, so that it takes seconds: sizes that only say how fast something is, and, where a sample is run, all.
fn shrink(line: &str) -> String {
    let mut line = shrink_sizes(line);
    line =
        line.replace("--vertices 200000", "--vertices 3000").replace("--vertices 50000", "--vertices 3000");
    if line.contains("adwave reproduce") {
        line = line.replace("adwave reproduce", "adwave reproduce --most-vertices 300");
    }
    if !runs_all() {
        if !line.contains("sample:creature --vertices") {
            line = line.replace("sample:creature", "bunny.ply");
        }
        line = line.replace("creature --vertices 20000", "creature --vertices 2000");
        line = line
            .replace("adwave demo", "adwave demo --vertices 2000")
            .replace("--harmonics 300", "--harmonics 30");
        line = line.replace("sample:plane", "tile.obj").replace("--vertices 3000 --with dw", "--with dw");
    }
    line.split("| jq").next().unwrap_or_default().replace("other-program", "cat > /dev/null")
}

/// Names of files that a line writes.
fn written_files(line: &str) -> Vec<String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let is_named =
        |pair: &&[&str]| ["-o", "--moved", "--picture", "--save-recipe"].contains(&pair[0]) && pair[1] != "-";
    let names =
        words.windows(2).filter(is_named).map(|pair| pair[1].trim_matches(['"', '\'']).replace('*', "0001"));
    if line.contains("--forecast") || line.contains("basis") || line.contains('$') {
        Vec::new()
    } else {
        names.collect()
    }
}

/// Runs a line in a shell in which `adwave` is this program.
fn run_in_shell(folder: &Path, line: &str) -> (bool, String) {
    let program = assert_cmd::cargo::cargo_bin("adwave");
    let path =
        format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap_or_default());
    let output = Command::new("sh")
        .current_dir(folder)
        .args(["-c", line])
        .env("PATH", path)
        .env("XDG_STATE_HOME", folder)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    (output.status.success(), told + &String::from_utf8_lossy(&output.stdout))
}

/// Starts the studio as a line says, without a browser, and ends it by Ctrl-C.
#[cfg(unix)]
fn run_studio(folder: &Path, line: &str) -> (bool, String) {
    let words = line.split_whitespace().skip(1).take_while(|word| *word != "#");
    let words = words.filter(|word| !["--port", "8080", "--no-open"].contains(word));
    let mut studio = Command::new(assert_cmd::cargo::cargo_bin("adwave"))
        .current_dir(folder)
        .args(words)
        .arg("--no-open")
        .env("XDG_STATE_HOME", folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut address = String::new();
    BufReader::new(studio.stdout.take().unwrap()).read_line(&mut address).unwrap();
    assert!(Command::new("kill").args(["-INT", &studio.id().to_string()]).status().unwrap().success());
    let status = studio.wait().unwrap();
    let mut told = String::new();
    studio.stderr.take().unwrap().read_to_string(&mut told).unwrap();
    (status.success() && address.starts_with("http://127.0.0.1:"), format!("{status} {address} {told}"))
}

/// Runs commands in a folder, each as `prepare` changes it.
pub(crate) fn run_all(
    folder: &Path,
    documented: &[Documented],
    prepare: &dyn Fn(&str) -> String,
    faults: &mut Faults,
) {
    for Documented { place, line, .. } in documented {
        if let Some((_, reason)) = SKIPPED.iter().find(|(word, _)| line.contains(word)) {
            println!("{place}: not run, {reason}: {line}");
            continue;
        }
        let is_long = line.contains("reproduce") || line.contains("evaluate") || line.contains("--with dw");
        if is_long && !runs_all() {
            continue;
        }
        let line = prepare(line);
        let is_studio = line.starts_with("adwave studio");
        let (is_done, told) = if is_studio { run_studio(folder, &line) } else { run_in_shell(folder, &line) };
        faults.expect(is_done, || format!("{place}: {line}: {}", told.trim()));
        for fault in wording_faults(&told) {
            faults.add(format!("{place}: {line}: {fault}"));
        }
        for name in written_files(&line) {
            faults.expect(folder.join(&name).exists(), || format!("{place}: {line}: {name} was not written"));
        }
    }
}

/// Runs commands in a folder with files of the names that they use.
fn run_with_files(folder: &Path, documented: &[Documented], faults: &mut Faults) {
    let prepare = |line: &str| {
        if line.contains("-o tiles/") {
            let _ = fs::remove_dir_all(folder.join("tiles"));
        }
        shrink(line)
    };
    run_all(folder, documented, &prepare, faults);
}

#[test]
fn commands_of_the_documents_run() {
    let folder = TempDir::new().unwrap();
    write_named_files(folder.path());
    let mut faults = Faults::default();
    faults.inspect(&run_line(folder.path(), "formats"));
    let docs = root().join("docs");
    let mut documents: Vec<PathBuf> = fs::read_dir(&docs)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
        .collect();
    documents.extend([root().join("README.md"), docs.join("python/README.md")]);
    documents.sort();
    let mut n_commands = 0;
    for document in documents {
        let mut commands = in_document(&document);
        n_commands += commands.len();
        let is_page = PAGES.iter().any(|page| root().join(page) == document);
        commands.retain(|command| command.takes_own_file || !is_page);
        if is_in_sample(&document.file_name().unwrap().to_string_lossy(), 1) {
            run_with_files(folder.path(), &commands, &mut faults);
        }
    }
    faults.expect(n_commands > 80, || format!("only {n_commands} commands were found"));
    faults.finish();
}

#[test]
fn examples_of_the_help_run() {
    let folder = TempDir::new().unwrap();
    write_named_files(folder.path());
    let mut faults = Faults::default();
    faults.inspect(&run_line(folder.path(), "--help"));
    let mut examples = in_help(folder.path());
    faults.expect(examples.len() > 70, || format!("only {} examples were found", examples.len()));
    examples.retain(|example| is_in_sample(&example.line, 3) || example.line.contains("adwave tile"));
    run_with_files(folder.path(), &examples, &mut faults);
    faults.finish();
}
