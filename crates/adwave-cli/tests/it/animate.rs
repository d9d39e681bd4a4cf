//! Frames of one connectivity, read, changed in time and space, and written.

use crate::common::{adwave, json, refused, words};
use adwave::sample::Sample;
use adwave_io::{ReadLimits, ShapeFile, read_npy, read_path, write_path};
use std::fs;
use std::path::Path;

const FRAMES: usize = 16;

/// A sphere that turns, walks on and breathes, with jitter, in the files `walk/f1.obj` and so on. Returns the positions
/// without jitter, frame after frame.
fn write_frames(folder: &Path, jitter: f64) -> Vec<Vec<[f64; 3]>> {
    let Sample { points, faces, .. } = Sample::from_name("sphere", Some(400)).unwrap();
    fs::create_dir(folder.join("walk")).unwrap();
    let mut file = ShapeFile::from_mesh(points.clone(), faces);
    let mut clean = Vec::new();
    let mut state = 7_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        12.0_f64.sqrt() * (f64::from(state >> 8) / f64::from(1 << 24) - 0.5)
    };
    for t in 0..FRAMES {
        let (time, (sin, cos)) = (t as f64, (0.1 * t as f64).sin_cos());
        let breath = 1.0 + 0.1 * (0.4 * time).sin();
        let place = |[a, b, c]: [f64; 3]| [cos * a - sin * b + 0.2 * time, sin * a + cos * b, breath * c];
        clean.push(points.iter().map(|p| place(*p)).collect::<Vec<_>>());
        let noisy = clean[t].iter().map(|p| p.map(|c| c + jitter * random())).collect();
        file.set_points(noisy).unwrap();
        write_path(&file, &folder.join(format!("walk/f{}.obj", t + 1)), None).unwrap();
    }
    clean
}

/// Positions vertices × 3 × frames, frame after frame.
fn read_frames(path: &Path) -> Vec<Vec<[f64; 3]>> {
    let array = read_npy(path, &ReadLimits::default()).unwrap();
    let (n, n_frames, values) = (array.shape[0], array.shape[2], array.values.to_f64());
    assert_eq!(array.shape[1], 3);
    let point = |t: usize, x: usize| std::array::from_fn(|c| values[(3 * x + c) * n_frames + t]);
    (0..n_frames).map(|t| (0..n).map(|x| point(t, x)).collect()).collect()
}

fn rms(a: &[Vec<[f64; 3]>], b: &[Vec<[f64; 3]>]) -> f64 {
    assert_eq!((a.len(), a[0].len()), (b.len(), b[0].len()));
    let (a, b) = (a.concat().concat(), b.concat().concat());
    (a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn jitter_is_found_and_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let clean = write_frames(path, 0.01);
    let report = json(path, "animate walk -o out.npy --denoise --time-step 40ms");
    assert_eq!((report["frames"].as_u64(), report["vertices_per_frame"].as_u64()), (Some(16), Some(400)));
    let noise = report["denoise"]["noise"].as_f64().unwrap();
    assert!((noise / 0.01 - 1.0).abs() < 0.15, "{noise}");
    let left = rms(&read_frames(&path.join("out.npy")), &clean);
    assert!(left < 0.006, "{left}");
}

#[test]
fn smoothing_along_time_keeps_the_mean_of_each_vertex() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let clean = write_frames(path, 0.0);
    json(path, "animate walk -o fast.npy --time-fwhm 3s --time-step 1s --time-gains 2");
    json(path, "animate walk -o slow.npy --time-fwhm 3s --time-step 1s");
    let (fast, slow) = (read_frames(&path.join("fast.npy")), read_frames(&path.join("slow.npy")));
    // Half of what is doubled and of what is smoothed away is what was there.
    for ((f, s), c) in fast.concat().iter().zip(slow.concat()).zip(clean.concat()) {
        assert!((0..3).all(|k| (0.5 * (f[k] + s[k]) - c[k]).abs() < 1e-12));
    }
    for x in [0, 77, 399] {
        let mean = |frames: &[Vec<[f64; 3]>]| frames.iter().map(|points| points[x][0]).sum::<f64>();
        assert!((mean(&slow) - mean(&clean)).abs() < 1e-10);
    }
    let said = adwave(path).args(words("animate walk -o s.npy --time-fwhm 3s")).assert().success();
    let said = String::from_utf8(said.get_output().stderr.clone()).unwrap();
    assert!(said.contains("frames are taken as 1 s apart; --time-step"), "{said}");
}

#[test]
fn a_rigid_motion_leaves_nothing_that_moves() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_frames(path, 0.0);
    let report = json(path, "animate walk -o still.npy --still --motion motion.ply --levels 3");
    assert!((report["still"]["degrees"].as_f64().unwrap() - 86.0).abs() < 1.0);
    let still = read_frames(&path.join("still.npy"));
    let center = |t: usize| -> f64 { still[t].iter().map(|p| p[0]).sum::<f64>() / 400.0 };
    assert!((center(15) - center(0)).abs() < 1e-9);
    let map = read_path(&path.join("motion.ply"), &ReadLimits::default()).unwrap();
    let names: Vec<&str> = map.field_names().into_iter().filter(|name| name.starts_with("motion")).collect();
    assert_eq!(names, ["motion_1", "motion_2", "motion_3", "motion_rest"]);
    // The breath moves the poles and hardly the equator.
    let rest = map.field("motion_rest").unwrap();
    let pole = (0..400).max_by(|a, b| map.points()[*a][2].total_cmp(&map.points()[*b][2])).unwrap();
    let equator =
        (0..400).min_by(|a, b| map.points()[*a][2].abs().total_cmp(&map.points()[*b][2].abs())).unwrap();
    assert!(rest.get(pole, 0) > 3.0 * rest.get(equator, 0));
}

#[test]
fn gains_in_space_change_the_motion_and_not_the_mean_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let clean = write_frames(path, 0.0);
    json(path, "animate walk -o same.npy --gains 1,1,1");
    assert!(rms(&read_frames(&path.join("same.npy")), &clean) < 1e-13);
    json(path, "animate walk -o calm.npy --gains 0,0,0");
    let calm = read_frames(&path.join("calm.npy"));
    let mean = |frames: &[Vec<[f64; 3]>], x: usize| -> [f64; 3] {
        std::array::from_fn(|c| frames.iter().map(|points| points[x][c]).sum::<f64>() / FRAMES as f64)
    };
    for x in [0, 5, 399] {
        let (a, b) = (mean(&calm, x), mean(&clean, x));
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-9));
    }
    assert!(rms(&calm, &clean) > 1e-4);
    // With a gain for the rest as well, all displacements from the mean are scaled.
    let report = json(path, "animate walk -o large.npy --fwhm 5%,20% --gains 1.5,1.5,1.5");
    assert_eq!(report["gains"], serde_json::json!([1.5, 1.5, 1.5]));
    let large = read_frames(&path.join("large.npy"));
    for x in 0..clean[0].len() {
        let mean = mean(&clean, x);
        for (large, clean) in large.iter().zip(&clean) {
            assert!((0..3).all(|c| (large[x][c] - mean[c] - 1.5 * (clean[x][c] - mean[c])).abs() < 1e-9));
        }
    }
    json(path, "animate walk -o rest.npy --fwhm 20% --gains 0,2");
    json(path, "animate walk -o twice.npy --fwhm 20% --gains 0");
    let (rest, once) = (read_frames(&path.join("rest.npy")), read_frames(&path.join("twice.npy")));
    for x in [0, 5, 399] {
        let mean = mean(&clean, x);
        for (rest, once) in rest.iter().zip(&once) {
            assert!((0..3).all(|c| (rest[x][c] - mean[c] - 2.0 * (once[x][c] - mean[c])).abs() < 1e-9));
        }
    }
}

#[test]
fn frames_come_back_in_the_form_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let clean = write_frames(path, 0.0);
    json(path, "animate walk -o again --time-fwhm 0.01 --time-step 1");
    // f2 stands before f10.
    for (t, clean) in clean.iter().enumerate() {
        let frame = read_path(&path.join(format!("again/f{}.obj", t + 1)), &ReadLimits::default()).unwrap();
        assert!(rms(&[frame.points().to_vec()], std::slice::from_ref(clean)) < 1e-4);
    }
    json(path, "animate walk/f*.obj -o out/x*.ply");
    assert!(path.join("out/x0001.ply").is_file() && path.join("out/x0016.ply").is_file());
    json(path, "animate walk -o walk.glb --time-step 40ms");
    let report = json(path, "animate walk.glb -o from_glb.npy");
    assert!((report["step"].as_f64().unwrap() - 0.04).abs() < 1e-6, "{report}");
    assert!(rms(&read_frames(&path.join("from_glb.npy")), &clean) < 1e-6);
    json(path, "animate walk/f1.obj --positions from_glb.npy -o copy.npy");
    assert_eq!(read_frames(&path.join("copy.npy")), read_frames(&path.join("from_glb.npy")));
}

#[test]
fn frames_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_frames(path, 0.0);
    let expect = |line: &str, expected: &str| {
        let error = refused(path, line);
        assert!(error.contains(expected), "{error}");
    };
    expect("animate walk/f1.obj -o a.npy", "names 1 file; give a folder or a pattern");
    expect("animate run -o a.npy", "run: no such file or folder");
    expect("animate walk -o walk", "is the folder of the frames, which would be replaced");
    expect("animate walk -o a.npy --time-gains 2", "--time-gains applies to bands along time");
    expect("animate walk -o a.npy --levels 3", "--levels applies to bands in space");
    expect(
        "animate walk -o a.npy --gains 1,2,3 --fwhm 0.5",
        "a number for each band, 1, and may have one more for the rest, got 3",
    );
    expect("animate walk -o a.npy --motion map.stl", "maps of the motion are written as");
    expect("animate walk -o a.npy --positions walk/f1.obj", "walk");
    let text = fs::read_to_string(path.join("walk/f3.obj")).unwrap();
    fs::write(path.join("walk/f3.obj"), text.replacen("f ", "f 1 2 3\nf ", 1)).unwrap();
    expect(
        "animate walk -o a.npy",
        "f3.obj: all frames have the same vertices and faces, and its faces are others",
    );
    fs::write(path.join("walk/f3.obj"), format!("v 0 0 0\n{text}")).unwrap();
    expect("animate walk -o a.npy", "it has 401 vertices where walk/f1.obj has 400");
    assert!(!path.join("a.npy").exists());
    // A vertex without a position in one frame stays as it is in all.
    fs::write(path.join("walk/f3.obj"), text.replacen("v ", "v nan 0 0\n# ", 1)).unwrap();
    let output =
        adwave(path).args(words("animate walk -o a.npy --denoise")).assert().success().get_output().clone();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("1 vertex has no position in some frames"), "{said}");
    let held = read_frames(&path.join("a.npy"));
    assert!(
        held[2][0][0].is_nan()
            && held.iter().all(|points| points[1..].iter().flatten().all(|c| c.is_finite()))
    );
    expect("animate walk -o one.ply", "there are 16 frames, and this is the name of one file");
}
