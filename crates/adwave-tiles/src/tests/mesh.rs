//! Meshes: several tiles against one tile, against the bands in memory, and what of a file is preserved.

use std::path::{Path, PathBuf};

use adwave::bands::Schedule;
use adwave::features::{Feature, FeatureParams, features};
use adwave::positions::Borders;
use adwave::saliency::{SaliencyParams, Sign, saliency};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Polygons, Shape};
use adwave::{Decomposer, Progress};
use adwave_io::{ReadLimits, ShapeFile, read_path};

use crate::stages::join::MeshJoin;
use crate::{MapKind, MapWeights, Params, Task, TilesError, TilingJob, join, run, run_task};

/// A bumpy square with an open border and irregularities: quads, a seam of duplicate vertices, a duplicate face, an
/// edge with three faces, a face with a repeated corner, one with two corners, a concave one, a distant vertex and an
/// isolated one.
pub(super) fn mesh(n: usize) -> (Vec<[f64; 3]>, Polygons) {
    let Sample { mut points, faces: triangles } = Sample::from_name("plane", Some(n)).unwrap();
    let n = points.len() as u32;
    let mut faces = Polygons::new();
    let mut doubled = vec![0; n as usize];
    for v in 0..n as usize {
        if v % 200 == 7 {
            doubled[v] = points.len() as u32;
            points.push(points[v]);
        }
    }
    let own = |v: u32, f: usize| if f % 2 == 1 && doubled[v as usize] > 0 { doubled[v as usize] } else { v };
    let triangles: Vec<&[u32]> = triangles.iter().collect();
    for (f, pair) in triangles.chunks(2).enumerate() {
        let (a, b) = (pair[0], pair[pair.len() - 1]);
        let opposite = b.iter().copied().find(|v| !a.contains(v));
        match (f % 5 == 0, opposite, a.iter().position(|v| !b.contains(v))) {
            (true, Some(opposite), Some(k)) => {
                faces.push(&[a[k], a[(k + 1) % 3], opposite, a[(k + 2) % 3]]);
            }
            _ => {
                for face in pair {
                    faces.push(&[own(face[0], f), own(face[1], f), own(face[2], f)]);
                }
            }
        }
    }
    let first = points.len() as u32;
    points.extend([[0.1, 3.0, 0.2], [50.0, -0.0, 4.0], [-0.0, 9.0, -0.0], [0.5, 2.0, 0.5], [0.6, 2.0, 0.5]]);
    let [a, b, c] = [0, 1, 2].map(|k| triangles[0][k]);
    faces.push(&[a, b, first]);
    faces.push(&[a, b, c]);
    faces.push(&[a, b, first + 1]);
    faces.push(&[b, b, first + 4]);
    faces.push(&[a, first + 2]);
    faces.push(&[a, first + 3, b, first + 4, first]);
    (points, faces)
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Form {
    Text,
    Little,
    Big,
}

/// A PLY with a comment, an element before and one after, and other properties of vertices and faces.
pub(super) fn ply((points, faces): &(Vec<[f64; 3]>, Polygons), form: Form) -> Vec<u8> {
    let format = match form {
        Form::Text => "ascii",
        Form::Little => "binary_little_endian",
        Form::Big => "binary_big_endian",
    };
    let coordinate = if form == Form::Big { "float" } else { "double" };
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment by hand\nelement camera 1\nproperty int id\nelement vertex {}\nproperty uchar red\n\
         property {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\nelement face {}\nproperty list uchar int vertex_indices\n\
         property uchar flag\nelement end 1\nproperty int id\nend_header\n",
        points.len(),
        faces.len()
    )
    .into_bytes();
    let int = |i: u32| if form == Form::Big { i.to_be_bytes() } else { i.to_le_bytes() };
    let is_text = form == Form::Text;
    if is_text {
        bytes.extend(b"7\n");
    } else {
        bytes.extend(int(7));
    }
    for (i, p) in points.iter().enumerate() {
        match form {
            Form::Text => bytes.extend(format!("{} {:?}  {:?} {:?}\n", i % 256, p[0], p[1], p[2]).bytes()),
            Form::Little => bytes.extend([i as u8].into_iter().chain(p.iter().flat_map(|c| c.to_le_bytes()))),
            Form::Big => {
                bytes.extend([i as u8].into_iter().chain(p.iter().flat_map(|c| (*c as f32).to_be_bytes())));
            }
        }
    }
    for (f, face) in faces.iter().enumerate() {
        if is_text {
            let corners: Vec<String> = face.iter().map(u32::to_string).collect();
            bytes.extend(format!("{} {} {}\n", face.len(), corners.join(" "), f % 256).bytes());
        } else {
            bytes.push(face.len() as u8);
            bytes.extend(face.iter().flat_map(|&v| int(v)));
            bytes.push(f as u8);
        }
    }
    if is_text {
        bytes.extend(b"9\n");
    } else {
        bytes.extend(int(9));
    }
    bytes
}

/// An OBJ with comments, texture coordinates and groups.
fn obj((points, faces): &(Vec<[f64; 3]>, Polygons)) -> Vec<u8> {
    let mut text = String::from("# by hand\nmtllib a.mtl\n");
    for [x, y, z] in points {
        text += &format!("v {x:?} {y:?} {z:?} # here\n");
    }
    text += "vt 0.50 0\nvn 0 0 1\n";
    for (f, face) in faces.iter().enumerate() {
        let corners: Vec<String> = face.iter().map(|v| format!("{}/1/1", v + 1)).collect();
        text += &format!("{}f {}\n", if f % 1000 == 0 { "usemtl b\n" } else { "" }, corners.join(" "));
    }
    text.into_bytes()
}

fn params() -> Params {
    let gains = vec![0.0, 0.2, 1.5, 1.0];
    Params { levels: 4, gains, magnitudes: vec![2, 4], borders: Borders::Free, ..Params::default() }
}

/// The mesh after a job in `folder`, as bytes.
fn joined(folder: &Path, input: &Path, params: &Params) -> Vec<u8> {
    joined_with_features(folder, input, params).0
}

fn joined_with_features(folder: &Path, input: &Path, params: &Params) -> (Vec<u8>, Vec<Feature>) {
    let job = TilingJob::begin(folder, &[input.to_path_buf()], params).unwrap().0;
    let summary = run(&job, Progress::none()).unwrap();
    assert!(params.n_tiles.is_none_or(|n| summary.n_tiles <= n && summary.n_tiles >= n.min(2)));
    let path = folder.join("joined");
    join(&job, &path, Progress::none()).unwrap();
    let features = job.features().unwrap();
    job.remove_tiles().unwrap();
    job.clean().unwrap();
    let names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["joined"]);
    (std::fs::read(path).unwrap(), features)
}

fn written(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn read(folder: &Path, name: &str, bytes: &[u8]) -> ShapeFile {
    read_path(&written(folder, name, bytes), &ReadLimits::default()).unwrap()
}

#[test]
fn tiles_of_any_size_give_the_bytes_of_one() {
    let folder = tempfile::tempdir().unwrap();
    let input = written(folder.path(), "a.ply", &ply(&mesh(42_000), Form::Little));
    let saliency = Some(MapWeights { skip: 0, kind: MapKind::PerLevel });
    let asked = Params { vectors: vec![1], saliency, theta: Some(1.6), ..params() };
    let whole = joined_with_features(&folder.path().join("one"), &input, &asked);
    for n_tiles in [2, 5, 9] {
        let params = Params { n_tiles: Some(n_tiles), n_workers: 2, ..asked.clone() };
        let path = folder.path().join(n_tiles.to_string());
        assert!(joined_with_features(&path, &input, &params) == whole, "{n_tiles} tiles differ");
    }
}

#[test]
fn the_bands_are_those_of_the_mesh_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let (mut points, faces) = mesh(20_000);
    // Hills of different widths and heights, for features.
    for [x, y, z] in &mut points[..20_000] {
        *y += 0.02 * (1.0 + 0.3 * *x + 0.2 * *z) * (40.0 * *x).sin() * (25.0 * *z * (1.5 + *x)).cos();
    }
    for (k, size) in [1.0, 1e-40, 1e70].into_iter().enumerate() {
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * size)).collect();
        let bytes = ply(&(points.clone(), faces.clone()), Form::Little);
        let input = written(folder.path(), "a.ply", &bytes);
        let saliency_asked = Some(MapWeights { skip: 0, kind: MapKind::Entropy });
        let params = Params {
            n_tiles: Some(3),
            accuracy: 1e-9,
            saliency: saliency_asked,
            theta: Some(0.1),
            ..params()
        };
        let (out, found) = joined_with_features(&folder.path().join(k.to_string()), &input, &params);
        let out = read(folder.path(), "out.ply", &out);
        let shape = Shape::Mesh(Mesh::new(points.clone(), faces.clone()).unwrap());
        let decomposer = Decomposer::new(&shape);
        let bands = decomposer.decompose(points.as_flattened(), 3, &Schedule::dyadic(4).unwrap()).unwrap();
        let schedule = Schedule::dyadic(4).unwrap();
        let wavelets = decomposer.request(points.as_flattened(), 3, &schedule).norms().unwrap();
        let asked = SaliencyParams::default().with_sign(Sign::Unsigned);
        let map = saliency(&decomposer, &wavelets, &asked, Progress::none()).unwrap().map;
        for (i, exact) in map.iter().enumerate() {
            let found = out.field("saliency").unwrap().get(i, 0);
            assert!((found - exact).abs() <= 1e-5 * (1.0 + exact), "{size} {i}: {found} for {exact}");
        }
        let asked = FeatureParams::default().with_theta(0.1);
        let exact = features(&decomposer, &wavelets, &asked, Progress::none()).unwrap();
        assert!(exact.len() > 5, "{}", exact.len());
        let key = |f: &Feature| (f.level, f.vertex);
        let (mut a, mut b): (Vec<_>, Vec<_>) =
            (exact.iter().map(key).collect::<Vec<_>>(), found.iter().map(key).collect());
        a.sort_unstable();
        b.sort_unstable();
        assert_eq!(a, b);
        for (exact, found) in exact.iter().zip(&found) {
            assert!((exact.strength / found.strength - 1.0).abs() < 1e-5);
            assert!((exact.sigma / found.sigma - 1.0).abs() < 1e-9, "{} for {}", found.sigma, exact.sigma);
        }
        let tolerance = 1e-6 * decomposer.mean_length();
        for (i, point) in points.iter().enumerate() {
            let band = |j: usize, c: usize| bands.wavelet(j)[3 * i + c];
            for (c, found) in out.points()[i].into_iter().enumerate() {
                let exact = point[c] - band(1, c) - 0.8 * band(2, c) + 0.5 * band(3, c);
                assert!((found - exact).abs() <= tolerance, "{size} {i}: {found} for {exact}");
            }
            for j in [2, 4] {
                let exact = (0..3).map(|c| (band(j, c) / size).powi(2)).sum::<f64>().sqrt() * size;
                let found = out.field(&format!("wavelet_{j}")).unwrap().get(i, 0);
                // A 32-bit float.
                let exact = f64::from(exact as f32);
                assert!(
                    found == exact || (found - exact).abs() <= 1e-6 * exact + tolerance,
                    "{size} {i}: {found} for {exact}"
                );
            }
        }
    }
}

#[test]
fn unchanged_parts_of_a_file_are_preserved_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = mesh(9000);
    let stays = Params { gains: vec![1.0; 4], magnitudes: Vec::new(), n_tiles: Some(2), ..params() };
    let moves = Params { magnitudes: Vec::new(), ..stays.clone() };
    let moves = Params { gains: params().gains, ..moves };
    let forms = [
        ("text.ply", ply(&mesh, Form::Text)),
        ("little.ply", ply(&mesh, Form::Little)),
        ("big.ply", ply(&mesh, Form::Big)),
        ("a.obj", obj(&mesh)),
    ];
    for (name, bytes) in &forms {
        let input = written(folder.path(), name, bytes);
        assert!(&joined(&folder.path().join("stays"), &input, &stays) == bytes, "{name}");
        let before = read(folder.path(), name, bytes);
        let moved = joined(&folder.path().join("moves"), &input, &moves);
        assert!(&moved != bytes);
        // The same as writing the original file with the new coordinates from memory.
        let after = read(folder.path(), &format!("moved-{name}"), &moved);
        assert_eq!((after.faces(), after.precision()), (before.faces(), before.precision()));
        let mut again = before.clone();
        again.set_points(after.points().to_vec()).unwrap();
        let mut expected = Vec::new();
        adwave_io::write_bytes(&again, again.format().unwrap(), &mut expected).unwrap();
        assert!(moved == expected, "{name}");
        if *name != "a.obj" {
            let both = Params { magnitudes: vec![3], ..stays.clone() };
            let with_field = joined(&folder.path().join("field"), &input, &both);
            let with_field = read(folder.path(), &format!("field-{name}"), &with_field);
            assert_eq!(with_field.points(), before.points());
            assert_eq!(with_field.field_names(), ["red", "wavelet_3"]);
        }
    }
    // Isolated vertices never move.
    let input = written(folder.path(), "big.ply", &forms[2].1);
    let moved = read(folder.path(), "moved.ply", &joined(&folder.path().join("isolated"), &input, &moves));
    let isolated = mesh.0.len() - 3;
    assert_eq!(moved.points()[isolated].map(f64::to_bits), [-0.0_f64, 9.0, -0.0].map(f64::to_bits));
}

#[test]
fn tasks_in_parts_of_any_size_and_repeated_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let input = written(folder.path(), "a.obj", &obj(&mesh(18_000)));
    let params = Params { magnitudes: Vec::new(), n_tiles: Some(3), ..params() };
    let whole = joined(&folder.path().join("whole"), &input, &params);
    let path = folder.path().join("parts");
    let job = TilingJob::begin(&path, std::slice::from_ref(&input), &params).unwrap().0;
    assert!(run_task(&job, Task::Neighbors(0), Progress::none()).is_err());
    // Files that a killed process left behind, also between the sort and the distribution of faces.
    std::fs::write(path.join("faces-00000.bin"), b"half").unwrap();
    job.sort_in_runs(7000, 5000, Progress::none()).unwrap();
    std::fs::remove_file(path.join("faces.json")).unwrap();
    std::fs::write(path.join("faces-00001.bin"), b"half").unwrap();
    std::fs::write(path.join("corners-0001.bin"), b"half").unwrap();
    assert!(!job.is_done(Task::Sort));
    job.sort_in_runs(7000, 4321, Progress::none()).unwrap();
    let n_tiles = job.n_tiles().unwrap();
    for tile in (0..n_tiles).rev().chain([1]) {
        run_task(&TilingJob::open(&path).unwrap(), Task::Neighbors(tile), Progress::none()).unwrap();
    }
    for tile in (0..n_tiles).rev().chain([1]) {
        run_task(&TilingJob::open(&path).unwrap(), Task::Bands(tile), Progress::none()).unwrap();
    }
    run(&job, Progress::none()).unwrap();
    let tiles: Vec<PathBuf> = (0..n_tiles).map(|tile| job.tile(tile)).collect();
    let out = folder.path().join("out.obj");
    // With the results of few vertices in memory at a time.
    for memory in [100_000, 1 << 30] {
        let (shape, params) = (&job.plan.shape, &job.plan.params);
        let mesh_join = MeshJoin { shape, params, tiles: &tiles, folder: &path, memory };
        mesh_join.write(&out, Progress::none()).unwrap();
        assert!(std::fs::read(&out).unwrap() == whole);
    }
    // Errors name the truncated file.
    for name in ["faces-00001.bin", "records.bin", "near-00001.bin"] {
        let bytes = std::fs::read(path.join(name)).unwrap();
        std::fs::write(path.join(name), &bytes[..bytes.len() - 2]).unwrap();
        let task = if name.starts_with("near") { Task::Bands(1) } else { Task::Neighbors(n_tiles - 1) };
        let task = if name.starts_with("faces") { Task::Neighbors(1) } else { task };
        let done = run_task(&job, task, Progress::none());
        assert!(done.as_ref().is_err_and(|e| e.to_string().contains(name)), "{name}: {done:?}");
        std::fs::write(path.join(name), &bytes).unwrap();
    }
    let tile = job.tile(0);
    let bytes = std::fs::read(&tile).unwrap();
    std::fs::write(&tile, &bytes[..bytes.len() - 28]).unwrap();
    let joined = join(&job, &out, Progress::none());
    assert!(matches!(joined, Err(TilesError::Broken { .. })), "{joined:?}");
}

#[test]
fn errors_about_a_mesh_are_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = String::from_utf8(ply(&mesh(2000), Form::Text)).unwrap();
    let run_of = |name: &str, text: &str| {
        let input = written(folder.path(), name, text.as_bytes());
        let path = folder.path().join("job");
        let done = TilingJob::begin(&path, &[input], &Params { n_tiles: Some(1), ..params() })
            .and_then(|(job, _)| run(&job, Progress::none()));
        let _ = std::fs::remove_dir_all(path);
        let message = done.unwrap_err().to_string();
        assert_eq!(message.lines().count(), 1, "{message}");
        message
    };
    let says = |name: &str, text: &str, what: &str| {
        let message = run_of(name, text);
        assert!(message.contains(what) && message.contains(name), "{message}");
    };
    says("a.ply", &text[..text.len() / 4], "get the whole file");
    says("a.ply", &text[..text.len() - 3000], "get the whole file");
    says("a.ply", &text.replacen("\n3 0 ", "\n3 99999 ", 1), "names vertex 99999");
    says("a.ply", &text.replacen("\n5 ", "\n5 nan ", 1), "which is not finite");
    let last_vertex = text.find("  2.0 0.5\n").unwrap();
    says("a.ply", &format!("{}  2e101 0.5\n{}", &text[..last_vertex], &text[last_vertex + 10..]), "beyond");
    says("b.ply", "ply\nformat ascii 1.0\nelement vertex 0\nelement face 0\nend_header\n", "no vertices");
    says(
        "b.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
        "no faces",
    );
    says("a.obj", "v 0 0 0\nf 1 1 1\n", "cannot store fields");
    let input = written(folder.path(), "a.ply", text.as_bytes());
    let two = TilingJob::begin(&folder.path().join("two"), &[input.clone(), input], &params()).map(|_| ());
    assert!(two.is_err_and(|e| e.to_string().contains("only input")));
}

#[test]
fn meshes_of_few_vertices() {
    let folder = tempfile::tempdir().unwrap();
    for text in ["v 1 2 3\nf 1 1 1\n", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "v 0 0 0\nv 1 0 0\nf 1 2\n"] {
        let input = written(folder.path(), "a.obj", text.as_bytes());
        let params = Params { magnitudes: Vec::new(), ..params() };
        let out = joined(&folder.path().join("job"), &input, &params);
        assert_eq!(String::from_utf8(out).unwrap().lines().count(), text.lines().count());
        std::fs::remove_dir_all(folder.path().join("job")).unwrap();
    }
}
