//! Small files of every kind, made so that most options make a difference on them.

use adwave::sample::{NoiseSigma, Sample};
use adwave::shape::Polygons;
use adwave_io::{
    ArrayValues, Field, FieldValues, Format, GRID_VALUES, GridLayout, ShapeFile, write_npy, write_path,
};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Kinds of inputs, with the file of each.
pub(crate) const INPUTS: [(&str, &str); 5] = [
    ("mesh", "mesh.ply"),
    ("cloud", "cloud.ply"),
    ("curve", "curve.obj"),
    ("graph", "graph.mtx"),
    ("scan", "scan.las"),
];

/// A folder with all fixtures, deleted when it is dropped.
pub(crate) fn fixtures() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_fixtures(folder.path());
    folder
}

fn write_fixtures(folder: &Path) {
    let at = |name: &str| folder.join(name);
    for (name, seed) in [("mesh.ply", 1), ("mesh2.ply", 2)] {
        save(&mesh(seed), &at(name));
    }
    save(&closed(), &at("closed.ply"));
    save(&levels(), &at("levels.ply"));
    save(&quads(), &at("quads.ply"));
    save(&creature(1), &at("creature.ply"));
    save(&creature(2), &at("creature2.ply"));
    save(&cloud(1), &at("cloud.ply"));
    save(&cloud(2), &at("cloud2.ply"));
    save(&single(), &at("single.ply"));
    for (name, n) in [("ball.ply", 400), ("ball2.ply", 900), ("ball3.ply", 700)] {
        save(&ball(n), &at(name));
    }
    for (name, n) in [("egg.ply", 400), ("egg2.ply", 900)] {
        save(&egg(n), &at(name));
    }
    write_path(&image(), &at("image.tif"), None).unwrap();
    write_path(&series(), &at("series.nii"), None).unwrap();
    write_path(&tensors(), &at("tensors.nii"), None).unwrap();
    write_frames(folder);
    for (name, seed) in [("curve.obj", 1), ("curve2.obj", 2)] {
        fs::write(at(name), curve(seed)).unwrap();
    }
    for (name, seed) in [("graph.mtx", 1), ("graph2.mtx", 2)] {
        fs::write(at(name), graph(seed)).unwrap();
    }
    scan(&at("scan.las"), false);
    scan(&at("scan2.las"), true);
    fs::write(at("outliers.xyz"), with_outliers()).unwrap();
    let texture = "texture.obj";
    fs::write(at(texture), textured()).unwrap();
    fs::write(at("texture.mtl"), "newmtl m\nmap_Kd first.png\n").unwrap();
    for (name, shift) in [("first.png", 0), ("second.png", 90)] {
        let color = |x: u32, y: u32| {
            image::Rgb([(8 * x + shift) as u8, (8 * y) as u8, ((x * y + shift) % 256) as u8])
        };
        image::RgbImage::from_fn(16, 16, color).save(at(name)).unwrap();
    }
    fs::write(at("recipe.toml"), "levels = 3\n[[layer]]\ngains = [0.5, 0.0, 1.0]\n").unwrap();
    let pose = "[pose]\nfixed = 'ball:vertex=31,radius=20%'\n[[pose.handle]]\nregion = 'vertices:indices=2'\nby = [0.1, 0.1, 0.0]\n";
    fs::write(at("pose.toml"), pose).unwrap();
    fs::write(at("balls.csv"), "vertex,x,y,z,sigma\n1,0,0,1,0.3\n2,1,0,0,0.2\n").unwrap();
    fs::write(at("shift.txt"), "1 0 0 0.2\n0 1 0 0\n0 0 1 0.1\n0 0 0 1\n").unwrap();
    let n = mesh(1).n_vertices();
    let mask: String = (0..n).fold(String::new(), |text, k| text + &format!("{}\n", u8::from(k % 5 != 0)));
    fs::write(at("mask.csv"), format!("inside\n{mask}")).unwrap();
    let depth = |k: usize| if k.is_multiple_of(7) { -9999.0 } else { (k as f64).sin() };
    let depths: String = (0..n).fold(String::new(), |text, k| text + &format!("{}\n", depth(k)));
    fs::write(at("depth.csv"), format!("depth\n{depths}")).unwrap();
    write_cells(folder);
}

/// A sphere with a field that is 0 on one piece, and flags.
fn ball(n_vertices: usize) -> ShapeFile {
    let mesh = Sample::from_name("sphere", Some(n_vertices)).unwrap();
    let heights: Vec<f64> = mesh.points.iter().map(|p| p[2]).collect();
    let mut file = ShapeFile::from_mesh(mesh.points, mesh.faces);
    let relief = heights.iter().map(|z| if *z > 0.8 { 0.0 } else { 2.0 + z }).collect();
    file.add_vertex_field(Field::new("relief", 1, FieldValues::F64(relief))).unwrap();
    let inside = heights.iter().map(|z| u8::from(*z > -0.5)).collect();
    file.add_vertex_field(Field::new("inside", 1, FieldValues::U8(inside))).unwrap();
    file
}

/// The vertices of a sphere, stretched.
fn egg(n_vertices: usize) -> ShapeFile {
    let mesh = Sample::from_name("sphere", Some(n_vertices)).unwrap();
    let points = mesh.points.iter().map(|[x, y, z]| [*x, *y, z * (2.0 + z)]).collect();
    ShapeFile::from_mesh(points, mesh.faces)
}

/// Frames of a mesh that turns and sways with jitter, as files and as two arrays.
fn write_frames(folder: &Path) {
    const FRAMES: usize = 12;
    let mut file = ShapeFile::from_mesh(mesh(1).points().to_vec(), mesh(1).faces().clone());
    let rest = file.points().to_vec();
    let jitter = |x: usize, t: usize| 0.01 * ((x * 7919 + t * 104_729) % 101) as f64 / 101.0;
    let point = |x: usize, t: usize| {
        let ([a, b, c], time) = (rest[x], t as f64);
        let (sin, cos) = (0.05 * time).sin_cos();
        [cos * a - sin * b, sin * a + cos * b + 0.1 * time, c + 0.1 * (0.7 * time + a).sin() + jitter(x, t)]
    };
    fs::create_dir(folder.join("walk")).unwrap();
    for t in 0..FRAMES {
        file.set_points((0..rest.len()).map(|x| point(x, t)).collect()).unwrap();
        save(&file, &folder.join(format!("walk/{}.obj", t + 1)));
    }
    for (name, shift) in [("moves.npy", 0), ("moves2.npy", 5)] {
        let value = |k: usize| point(k / FRAMES / 3, k % FRAMES + shift)[k / FRAMES % 3];
        let values: Vec<f64> = (0..3 * rest.len() * FRAMES).map(value).collect();
        write_npy(&folder.join(name), &[rest.len(), 3, FRAMES], ArrayValues::F64(&values)).unwrap();
    }
}

/// Counts and coordinates of 60 cells on a ring, a walk on them, and the graph of each.
fn write_cells(folder: &Path) {
    let n = 60;
    let save = |name: &str, n_columns: usize, value: &dyn Fn(usize, usize) -> f64| {
        let values: Vec<f64> = (0..n * n_columns).map(|i| value(i / n_columns, i % n_columns)).collect();
        write_npy(&folder.join(name), &[n, n_columns], ArrayValues::F64(&values)).unwrap();
    };
    let angle = |x: usize| std::f64::consts::TAU * x as f64 / n as f64;
    let rough = |x: usize, c: usize| ((x * 7919 + c * 31) % 101) as f64 / 100.0;
    let count = |x: usize, c: usize| (6.0 + 4.0 * (angle(x) + c as f64).sin() + 5.0 * rough(x, c)).floor();
    save("counts.npy", 4, &count);
    crate::cells_file::write_cells_file(&folder.join("cells.h5ad"), n, 4, &count);
    save("cells.npy", 6, &|x, c| {
        (angle(x) * (1.0 + (c / 2) as f64) + (c % 2) as f64).sin() + 0.1 * rough(x, c)
    });
    save("batch.npy", 1, &|x, _| (x % 3) as f64);
    let mut text = format!("%%MatrixMarket matrix coordinate real general\n{n} {n} {}\n", 3 * n);
    for x in 0..n {
        let (before, after) = ((x + n - 1) % n + 1, (x + 1) % n + 1);
        let _ = writeln!(text, "{} {} 0.5\n{} {before} 0.25\n{} {after} 0.25", x + 1, x + 1, x + 1, x + 1);
    }
    fs::write(folder.join("walk.mtx"), text).unwrap();
}

/// An image of whole numbers with two plateaus and some noise.
fn image() -> ShapeFile {
    let mut file = ShapeFile::from_grid(GridLayout::new(&[24, 30], &[1.0, 1.0])).unwrap();
    let value = |k: usize| (60 + 90 * usize::from(k % 30 > 13) + k * 7919 % 23) as u8;
    file.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::U8((0..720).map(value).collect())))
        .unwrap();
    file
}

/// A small volume that changes over 20 frames.
/// Positive definite tensors in a volume: xx, xy, xz, yy, yz, zz.
pub(crate) fn tensors() -> ShapeFile {
    let mut file = ShapeFile::from_grid(GridLayout::new(&[5, 6, 7], &[3.0, 2.0, 2.0])).unwrap();
    let value = |i: usize| {
        let wave = 0.3 * ((i / 6 * 7919 % 23) as f32).sin();
        [2.0 + wave, 0.2, wave, 1.0 - wave, 0.1, 1.5][i % 6]
    };
    let values = FieldValues::F32((0..1260).map(value).collect());
    file.add_vertex_field(Field::new(GRID_VALUES, 6, values)).unwrap();
    file
}

fn series() -> ShapeFile {
    let mut file = ShapeFile::from_grid(GridLayout::new(&[5, 6, 7], &[3.0, 2.0, 2.0])).unwrap();
    let value = |i: usize| ((i / 20 * 7919 % 23) as f32 + 3.0 * (i % 20 * 37 % 11) as f32).sin();
    let mut field = Field::new(GRID_VALUES, 20, FieldValues::F32((0..4200).map(value).collect()));
    field.frame_step = Some(1.5);
    file.add_vertex_field(field).unwrap();
    file
}

/// A rough square of 400 points, and three points above it.
fn with_outliers() -> String {
    let mut text = String::new();
    for k in 0..400 {
        let (i, j) = (k / 20, k % 20);
        let _ = writeln!(text, "{i} {j} {}", f64::from((7 * i + 13 * j) % 11 - 5) / 100.0);
    }
    text + "4.5 5.5 3\n12.5 9.5 3\n8.5 15.5 3\n"
}

fn save(file: &ShapeFile, path: &Path) {
    write_path(file, path, Some(Format::PLY)).unwrap();
}

/// Fields of a shape: a smooth number with some noise, labels, normals that point outward, and seconds of fixation.
fn add_fields(file: &mut ShapeFile) {
    let points = file.points().to_vec();
    let of = |f: &dyn Fn(usize, &[f64; 3]) -> f64| points.iter().enumerate().map(|(k, p)| f(k, p)).collect();
    let rough = |k: usize| ((k * 7919 % 101) as f64 - 50.0) / 500.0;
    let heat: Vec<f64> = of(&|k, p| (2.0 * p[0]).sin() + p[1] * p[2] + rough(k));
    let gaze: Vec<f64> = of(&|k, p| (p[2] + rough(k)).max(0.0));
    let mut field = |name: &str, n: usize, values: FieldValues| {
        file.add_vertex_field(Field::new(name, n, values)).unwrap();
    };
    field("heat", 1, FieldValues::F64(heat));
    field("gaze", 1, FieldValues::F64(gaze));
    let classes = points.iter().enumerate().map(|(k, p)| u8::from(p[0] + rough(k) > 0.1) + 1).collect();
    field("classification", 1, FieldValues::U8(classes));
    let normals: Vec<f64> = points
        .iter()
        .flat_map(|p| {
            let length = p.iter().map(|c| c * c).sum::<f64>().sqrt().max(1e-9);
            p.map(|c| c / length)
        })
        .collect();
    field("normal", 3, FieldValues::F64(normals));
}

/// An open bumpy ball with a sharp edge and noise, a seam of vertices that nearly coincide, another of equal ones, and a small second ball
/// at its side.
fn mesh(seed: u64) -> ShapeFile {
    let (n_rings, n_around) = (14_usize, 18_usize);
    let mut points = Vec::new();
    let place = |i: usize, j: usize| {
        let (theta, phi) = (
            0.35 + 2.5 * i as f64 / (n_rings - 1) as f64,
            std::f64::consts::TAU * j as f64 / n_around as f64,
        );
        let bump = 1.0
            + 0.15 * (3.0 * theta).sin() * (2.0 * phi).cos()
            + 0.01 * (((i * 31 + j * 17) as u64 * 7 + seed * 13) % 11) as f64 / 11.0;
        let z = (bump * theta.cos()).max(-0.5);
        [bump * theta.sin() * phi.cos(), bump * theta.sin() * phi.sin(), z]
    };
    // The last column repeats the first: half of it exactly, half of it nearly.
    for i in 0..n_rings {
        for j in 0..=n_around {
            let mut p = place(i, j % n_around);
            if j == n_around && i >= n_rings / 2 {
                p[0] += 2e-4;
            }
            points.push(p);
        }
    }
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..n_rings - 1 {
        for j in 0..n_around {
            let at = |i: usize, j: usize| (i * (n_around + 1) + j) as u32;
            faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let mut ball = Sample::from_name("sphere", Some(60)).unwrap();
    ball.add_noise(NoiseSigma::MeanEdge(0.1), seed).unwrap();
    let first = points.len() as u32;
    points.extend(ball.points.iter().map(|p| [0.3 * p[0] + 1.9, 0.3 * p[1], 0.3 * p[2]]));
    for face in ball.faces.iter() {
        faces.push([face[0] + first, face[1] + first, face[2] + first]);
    }
    let mut file = ShapeFile::from_mesh(points, faces.into());
    add_fields(&mut file);
    file
}

/// A closed noisy ring.
fn closed() -> ShapeFile {
    let mut ball = Sample::from_name("torus", Some(500)).unwrap();
    ball.add_noise(NoiseSigma::MeanEdge(0.1), 3).unwrap();
    let mut file = ShapeFile::from_mesh(ball.points, ball.faces);
    add_fields(&mut file);
    file
}

/// A tetrahedron, cut three times.
pub(crate) fn levels() -> ShapeFile {
    let mut points = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let mut triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    for _ in 0..3 {
        let finer = adwave_subdivision::subdivide(points.len(), &triangles);
        for [a, b] in finer.parents {
            let (p, q): ([f64; 3], [f64; 3]) = (points[a as usize], points[b as usize]);
            points.push([0, 1, 2].map(|k| 0.6 * (p[k] + q[k])));
        }
        triangles = finer.triangles;
    }
    let mut file = ShapeFile::from_mesh(points, Polygons::from_triangles(&triangles));
    add_fields(&mut file);
    file
}

/// Two squares that meet at a right angle, cut twice into quadrilaterals, with a bump.
pub(crate) fn quads() -> ShapeFile {
    let mut points: Vec<[f64; 3]> =
        vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.1, 1.0]];
    let mut faces: Polygons = [[0, 1, 2, 3].as_slice(), &[1, 0, 4, 5]].into_iter().collect();
    for _ in 0..2 {
        let finer = adwave_subdivision::subdivide_polygons(points.len(), &faces);
        let mean = |corners: &[u32]| {
            let sum = |k: usize| corners.iter().map(|&v| points[v as usize][k]).sum::<f64>();
            [0, 1, 2].map(|k| sum(k) / corners.len() as f64)
        };
        let new: Vec<[f64; 3]> =
            finer.edges.iter().map(|edge| mean(edge)).chain(faces.iter().map(mean)).collect();
        points.extend(new);
        faces = finer.faces;
    }
    for p in &mut points {
        p[1] += 0.05 * (7.0 * p[0] + 3.0 * p[2]).sin();
    }
    let mut file = ShapeFile::from_mesh(points, faces);
    add_fields(&mut file);
    file
}

/// A creature with features.
fn creature(seed: u64) -> ShapeFile {
    let mut creature = Sample::from_name("creature", Some(2000)).unwrap();
    creature.add_noise(NoiseSigma::MeanEdge(0.05), seed).unwrap();
    let mut file = ShapeFile::from_mesh(creature.points, creature.faces);
    add_fields(&mut file);
    file
}

/// The points of the mesh without faces.
fn cloud(seed: u64) -> ShapeFile {
    let mut file = ShapeFile::from_cloud(mesh(seed).points().to_vec());
    add_fields(&mut file);
    file
}

/// One triangle.
fn single() -> ShapeFile {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    ShapeFile::from_mesh(points, vec![[0, 1, 2]].into())
}

/// A noisy path with a corner and a second piece.
fn curve(seed: u64) -> String {
    let mut text = String::new();
    for k in 0..60 {
        let t = f64::from(k) / 10.0;
        let rough = 0.02 * (((k as u64 * 37 + seed * 11) % 13) as f64 / 13.0 - 0.5);
        let _ = writeln!(text, "v {t} {} {}", (t - 3.0).abs() + rough, 0.3 * t.sin());
    }
    for k in 0..20 {
        let _ = writeln!(text, "v {} {} 3", f64::from(k) / 10.0, 0.1 * f64::from(k % 3));
    }
    let list = |from: u32, to: u32| (from..=to).map(|k| k.to_string()).collect::<Vec<_>>().join(" ");
    text + &format!("l {}\nl {}\n", list(1, 60), list(61, 80))
}

/// A ring with chords and weights.
fn graph(seed: u32) -> String {
    let n = 60;
    let mut rows = Vec::new();
    for k in 1..=n {
        rows.push(format!("{} {} {}", k % n + 1, k, 1 + (k * 7 + seed) % 5));
        if k % 4 == 0 {
            rows.push(format!("{} {} 1", (k * 7) % n + 1, k));
        }
    }
    format!("%%MatrixMarket matrix coordinate real general\n{n} {n} {}\n{}\n", rows.len(), rows.join("\n"))
}

/// Land with some points of noise, in meters or in degrees.
fn scan(path: &Path, is_in_degrees: bool) {
    let point = |k: u32| {
        let (x, y) = (f64::from(k % 20), f64::from(k / 20));
        let z = 30.0 + (0.4 * x).sin() + (0.3 * y).cos() + 0.05 * f64::from(k * 7919 % 11);
        if is_in_degrees { [13.0 + 1e-5 * x, 52.0 + 1e-5 * y, z] } else { [x, y, z] }
    };
    let mut file = ShapeFile::from_cloud((0..400).map(point).collect());
    let classes = (0..400).map(|k| if k % 40 == 7 { 7 } else { 2 }).collect();
    file.add_vertex_field(Field::new("classification", 1, FieldValues::U8(classes))).unwrap();
    write_path(&file, path, Some(Format::LAS)).unwrap();
    if is_in_degrees {
        add_degrees(path);
    }
}

/// Adds a record to a LAS that says that its coordinates are degrees.
fn add_degrees(path: &Path) {
    const SYSTEM: &str = "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
                          PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]";
    let mut bytes = fs::read(path).unwrap();
    let start = u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize;
    let mut record = vec![0; 54];
    record[2..17].copy_from_slice(b"LASF_Projection");
    record[18..20].copy_from_slice(&2112_u16.to_le_bytes());
    record[20..22].copy_from_slice(&(SYSTEM.len() as u16).to_le_bytes());
    record.extend(SYSTEM.as_bytes());
    let n_records = u32::from_le_bytes(bytes[100..104].try_into().unwrap()) + 1;
    bytes[96..100].copy_from_slice(&((start + record.len()) as u32).to_le_bytes());
    bytes[100..104].copy_from_slice(&n_records.to_le_bytes());
    bytes.splice(start..start, record);
    fs::write(path, bytes).unwrap();
}

/// A grid with texture coordinates.
fn textured() -> String {
    let mut text = "mtllib texture.mtl\nusemtl m\n".to_owned();
    for k in 0..100 {
        let (x, y) = (f64::from(k % 10), f64::from(k / 10));
        let _ = writeln!(text, "v {x} {y} {}\nvt {} {}", (0.7 * x).sin(), x / 9.0, y / 9.0);
    }
    for k in (0..90).filter(|k| k % 10 != 9) {
        let [a, b, c, d] = [k + 1, k + 2, k + 12, k + 11];
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}\nf {a}/{a} {c}/{c} {d}/{d}");
    }
    text
}

/// Map of the sky of 12·16² pixels in FITS.
pub(crate) fn sky() -> Vec<u8> {
    const N_SIDE: usize = 16;
    const N: usize = 12 * N_SIDE * N_SIDE;
    let block = |cards: &[(&str, &str)]| {
        let card = |(name, value): &(&str, &str)| format!("{:<80}", format!("{name:<8}= {value:>20}"));
        let text = cards.iter().map(card).collect::<Vec<_>>().concat() + "END";
        format!("{text:<0$}", text.len().next_multiple_of(2880))
    };
    let [n, n_side] = [N, N_SIDE].map(|n| n.to_string());
    let first = block(&[("SIMPLE", "T"), ("BITPIX", "8"), ("NAXIS", "0"), ("EXTEND", "T")]);
    let table = block(&[
        ("XTENSION", "'BINTABLE'"),
        ("BITPIX", "8"),
        ("NAXIS", "2"),
        ("NAXIS1", "4"),
        ("NAXIS2", &n),
        ("PCOUNT", "0"),
        ("GCOUNT", "1"),
        ("TFIELDS", "1"),
        ("TTYPE1", "'TEMPERATURE'"),
        ("TFORM1", "'E       '"),
        ("PIXTYPE", "'HEALPIX '"),
        ("ORDERING", "'RING    '"),
        ("NSIDE", &n_side),
    ]);
    let mut bytes = [first, table].concat().into_bytes();
    let value = |k: usize| if k < 40 { -1.6375e30 } else { (0.1 * k as f32).sin() };
    bytes.extend((0..N).flat_map(|k| value(k).to_be_bytes()));
    bytes.resize(bytes.len().next_multiple_of(2880), 0);
    bytes
}
