//! Clouds and meshes that are larger than memory: terrain of any size, tiles, ends at any moment.

use crate::common;

use adwave_io::{ReadLimits, read_path};
use common::{adwave, json, refused, words};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

fn run(folder: &Path, line: &str) {
    adwave(folder).args(words(line)).args(["--quiet"]).assert().success();
}

fn says(folder: &Path, line: &str, what: &str) {
    let said = refused(folder, line);
    assert!(said.contains(what), "{line}: {said}");
}

#[test]
fn terrain_is_the_same_for_the_same_number_and_seed_and_says_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample terrain --points 1e5 -o a.laz");
    run(path, "sample terrain --points 100000 --threads 1 -o b.laz");
    assert!(fs::read(path.join("a.laz")).unwrap() == fs::read(path.join("b.laz")).unwrap());
    assert_eq!(json(path, "info a.laz")["health"]["vertices"], 100_000);
    says(path, "sample terrain --points 1000 -o c.ply", ".las or .laz");
    assert!(!path.join("c.ply").exists());
}

#[test]
fn tiles_join_to_the_bytes_of_one_and_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample terrain --points 5e4 -o a.laz");
    let said = json(path, "tiles a.laz -o one.laz --gains 0,1,0.5,1 --magnitudes 2 --tiles 1");
    assert_eq!(said["summary"]["n_points"], 50_000);
    assert_eq!(said["summary"]["n_tiles"], 1);
    run(path, "tiles a.laz -o many.laz --gains 0,1,0.5,1 --magnitudes 2 --tiles 6 --workers 2");
    assert!(fs::read(path.join("one.laz")).unwrap() == fs::read(path.join("many.laz")).unwrap());
    let mut names: Vec<_> = fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["a.laz", "many.laz", "one.laz"]);
    let fields = json(path, "info one.laz")["fields"].to_string();
    assert!(fields.contains("wavelet_2") && fields.contains("gps_time"), "{fields}");
    // By jobs, as a cluster does it.
    run(path, "tiles a.laz -o jobs --gains 0,1,0.5,1 --magnitudes 2 --tiles 6 --plan-only");
    says(path, "tile jobs neighbors 0", "are not sorted; run its sort first");
    assert_eq!(json(path, "tile jobs status")["n_runs"], 1);
    run(path, "tile jobs run 0");
    assert_eq!(json(path, "tile jobs status")["runs_done"], 1);
    says(path, "tile jobs run 1", "in 0..=0, got 1");
    says(path, "tiles jobs -o b.laz --magnitudes 1", "are not done; finish it first");
    let n_tiles = all_jobs(path);
    run(path, "tiles a.laz -o jobs --gains 0,1,0.5,1 --magnitudes 2");
    assert_eq!(fs::read_dir(path.join("jobs")).unwrap().count() as u64, n_tiles);
    // A folder of tiles is an input like the file that they were joined to.
    run(path, "tiles jobs -o from-tiles.laz --magnitudes 1 --levels 4");
    run(path, "tiles many.laz -o from-file.laz --magnitudes 1 --levels 4");
    assert!(fs::read(path.join("from-tiles.laz")).unwrap() == fs::read(path.join("from-file.laz")).unwrap());
    fs::create_dir(path.join("none")).unwrap();
    says(path, "tiles none -o b.laz --magnitudes 1", "no .las or .laz");
}

#[test]
fn a_map_and_features_come_with_the_tiles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample terrain --points 4e4 -o a.laz");
    let what = "--saliency --vectors 2 --features f.csv --theta 1.6 --levels 5";
    let said = json(path, &format!("tiles a.laz -o one.laz {what} --tiles 1"));
    let n_features = said["features"].as_u64().unwrap() as usize;
    let csv = fs::read_to_string(path.join("f.csv")).unwrap();
    assert!(n_features > 20 && csv.lines().count() == n_features + 1, "{n_features}");
    assert!(said["summary"]["levels"][4]["sigma"].as_f64().unwrap() > 0.0);
    run(path, &format!("tiles a.laz -o many.laz {what} --tiles 4 --workers 2"));
    assert!(fs::read(path.join("one.laz")).unwrap() == fs::read(path.join("many.laz")).unwrap());
    assert_eq!(fs::read_to_string(path.join("f.csv")).unwrap(), csv);
    let fields = json(path, "info one.laz")["fields"].to_string();
    assert!(fields.contains("saliency") && fields.contains(r#""channels":3,"name":"wavelet_2""#), "{fields}");
    // By jobs.
    run(path, &format!("tiles a.laz -o jobs {what} --tiles 3 --plan-only"));
    let n_tiles = all_jobs(path);
    for tile in 0..n_tiles {
        run(path, &format!("tile jobs maps {tile}"));
    }
    assert_eq!(json(path, "tile jobs status")["maps_done"], n_tiles);
    run(path, &format!("tiles a.laz -o again.laz {what} --work jobs"));
    assert!(fs::read(path.join("one.laz")).unwrap() == fs::read(path.join("again.laz")).unwrap());
    says(path, "tiles a.laz -o b.laz --features f.txt", "f.txt");
    fs::write(path.join("one.xyz"), "0 0 0\n").unwrap();
    run(path, "convert one.xyz -o one-point.laz");
    let said = json(path, "tiles one-point.laz -o b.laz --saliency --features f.csv");
    assert_eq!((&said["summary"]["n_points"], &said["features"]), (&1.into(), &0.into()));
    says(path, "tiles a.laz -o b.laz --features f.csv --theta 0", "θ is 0");
    says(path, "tiles a.laz -o b.laz --features f.csv --levels 2", "at least 3 levels");
    says(path, "tiles a.laz -o b.laz --saliency=paper --levels 2", "skips the 2 finest levels");
    says(path, "tiles a.laz -o b.laz --vectors 9", "bands must be in 1..=8, got 9");
}

#[test]
fn noise_is_taken_off_by_tiles_and_jobs_as_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample torus --vertices 20000 --noise 0.3 -o t.ply");
    run(path, "convert t.ply -o a.laz");
    let said = json(path, "tiles a.laz -o one.laz --denoise --tiles 1");
    assert!(said["summary"]["noise"]["noise"].as_f64().unwrap() > 0.0, "{said}");
    assert!(said["summary"]["moved"][0].as_f64().unwrap() > 0.0, "{said}");
    run(path, "tiles a.laz -o many.laz --denoise --tiles 5 --workers 2");
    assert!(fs::read(path.join("one.laz")).unwrap() == fs::read(path.join("many.laz")).unwrap());
    // By tasks.
    run(path, "tiles a.laz -o jobs --denoise --tiles 5 --plan-only");
    run(path, "tile jobs sort");
    let status = json(path, "tile jobs status");
    assert_eq!(status["neighbors_done"], 0, "{status}");
    let n_tiles = status["n_tiles"].as_u64().unwrap();
    (0..n_tiles).for_each(|tile| run(path, &format!("tile jobs neighbors {tile}")));
    says(path, "tile jobs bands 99", "got 99");
    (0..n_tiles).rev().for_each(|tile| run(path, &format!("tile jobs bands {tile}")));
    run(path, "tiles a.laz -o jobs.laz --denoise --tiles 5 --work jobs");
    assert!(fs::read(path.join("one.laz")).unwrap() == fs::read(path.join("jobs.laz")).unwrap());
    // A mesh, as the command in memory has it.
    let by_tiles = json(path, "tiles t.ply -o clean.ply --denoise --tiles 4");
    run(path, "tiles t.ply -o one.ply --denoise --tiles 1");
    assert!(fs::read(path.join("one.ply")).unwrap() == fs::read(path.join("clean.ply")).unwrap());
    run(path, "denoise t.ply -o memory.ply");
    let (sigma, rms) =
        (by_tiles["summary"]["noise"]["noise"].as_f64().unwrap(), |to: &str| moved(path, "t.ply", to));
    assert!(sigma > 0.0 && (rms("clean.ply") / rms("memory.ply") - 1.0).abs() < 0.01);
    // What is said of it.
    for line in [
        "tiles t.ply -o b.ply --denoise --gains 0,1",
        "tiles t.ply -o b.ply --denoise --magnitudes 1",
        "tiles t.ply -o b.ply --gains 0,1 --strength 2",
    ] {
        adwave(path).args(words(line)).assert().code(2);
    }
    says(path, "tiles t.ply -o b.ply --denoise --strength=-1", "strength");
    says(path, "tiles t.ply -o b.ply --denoise --noise-sigma nan", "noise");
}

/// Root mean square of the distances of the vertices of one PLY from those of another.
fn moved(path: &Path, from: &str, to: &str) -> f64 {
    let read = |name: &str| read_path(&path.join(name), &ReadLimits::default()).unwrap();
    let points = |name: &str| read(name).points().to_vec();
    let (from, to) = (points(from), points(to));
    let square = |p: &[f64; 3], q: &[f64; 3]| -> f64 { (0..3).map(|a| (p[a] - q[a]).powi(2)).sum() };
    let total: f64 = from.iter().zip(&to).map(|(p, q)| square(p, q)).sum();
    (total / from.len() as f64).sqrt()
}

/// Sorts the work `jobs` and does all jobs of its tiles, the last one first; how many tiles there are.
fn all_jobs(path: &Path) -> u64 {
    run(path, "tile jobs sort");
    let n_tiles = json(path, "tile jobs sort --if-missing")["n_tiles"].as_u64().unwrap();
    for kind in ["neighbors", "bands"] {
        (0..n_tiles).rev().for_each(|tile| run(path, &format!("tile jobs {kind} {tile}")));
    }
    let status = json(path, "tile jobs status");
    assert_eq!((&status["neighbors_done"], &status["bands_done"]), (&n_tiles.into(), &n_tiles.into()));
    n_tiles
}

#[test]
fn a_killed_run_goes_on_and_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample terrain --points 6e4 -o a.laz");
    let line = "tiles a.laz -o out.laz --magnitudes 3 --saliency --tiles 8";
    run(path, "tiles a.laz -o whole.laz --magnitudes 3 --saliency --tiles 8");
    let mut n_killed = 0;
    for kill in 0..20_u64 {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin("adwave"));
        let command = command
            .args(words(line))
            .arg("--quiet")
            .current_dir(path)
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        let mut child = command.spawn().unwrap();
        std::thread::sleep(Duration::from_millis(10 + 37 * kill % 400));
        // It may have ended already: then there is nothing to go on with.
        n_killed += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(n_killed > 0);
    run(path, line);
    assert!(fs::read(path.join("whole.laz")).unwrap() == fs::read(path.join("out.laz")).unwrap());
}

#[test]
fn what_cannot_be_is_said_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample terrain --points 3e4 -o a.laz");
    says(path, "tiles a.laz -o b.laz", "--gains");
    says(path, "tiles a.laz -o b.laz --magnitudes 9", "bands must be in 1..=8, got 9");
    says(path, "tiles a.laz -o b.laz --magnitudes 30 --levels 30", "rings");
    says(path, "tiles a.laz -o b.laz --gains 0,1 --levels 3", "must be that of the levels, 3");
    says(path, "tiles a.laz -o b.ply --magnitudes 1", ".las or .laz");
    says(path, "tiles a.laz -o b.laz --magnitudes 1 --memory 60M", "allow more memory");
    says(path, "tiles missing.laz -o b.laz --magnitudes 1", "missing.laz");
    says(path, "tile . sort", "plan.json");
    // Cut in the middle, among whole ones: the file is named and nothing of the result is there.
    let bytes = fs::read(path.join("a.laz")).unwrap();
    fs::write(path.join("cut.laz"), &bytes[..bytes.len() / 2]).unwrap();
    says(path, "tiles a.laz cut.laz -o b.laz --magnitudes 1 --quiet", "cut.laz");
    assert!(!path.join("b.laz").exists() && !path.join("b.laz.work").exists());
    // Tiles of an earlier work are not replaced, not even where they are the input.
    run(path, "tiles a.laz -o done --magnitudes 1");
    let before = fs::read(path.join("done/tile-00000.laz")).unwrap();
    says(path, "tiles done/tile-00000.laz -o done --magnitudes 2", "earlier job");
    assert!(fs::read(path.join("done/tile-00000.laz")).unwrap() == before);
    // Another work in the same folder, and other input under the same name.
    run(path, "tiles a.laz -o w --magnitudes 1 --plan-only");
    says(path, "tiles a.laz -o w --magnitudes 2", "another job");
    run(path, "sample terrain --points 2e4 -o a.laz");
    says(path, "tile w sort", "has changed");
}

#[test]
fn a_mesh_keeps_its_order_and_format_by_one_command_and_by_jobs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, "sample torus --vertices 30000 -o t.ply");
    let what = "--gains 0,1,0.5,1 --magnitudes 2";
    let said = json(path, &format!("tiles t.ply -o one.ply {what} --tiles 1"));
    assert_eq!(said["summary"]["n_tiles"], 1);
    run(path, &format!("tiles t.ply -o many.ply {what} --tiles 6 --workers 2"));
    assert!(fs::read(path.join("one.ply")).unwrap() == fs::read(path.join("many.ply")).unwrap());
    run(path, &format!("tiles t.ply -o jobs {what} --tiles 6 --plan-only"));
    all_jobs(path);
    run(path, &format!("tiles t.ply -o jobs.ply --work jobs {what}"));
    assert!(fs::read(path.join("one.ply")).unwrap() == fs::read(path.join("jobs.ply")).unwrap());
    run(path, "convert t.ply -o t.obj");
    run(path, "tiles t.obj -o one.obj --gains 0,1,0.5,1 --tiles 4");
    let mut names: Vec<_> = fs::read_dir(path).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["jobs.ply", "many.ply", "one.obj", "one.ply", "t.obj", "t.ply"]);
    let info = json(path, "info one.ply");
    assert_eq!(info["health"]["vertices"], said["summary"]["n_points"]);
    assert!(info["fields"].to_string().contains("wavelet_2"));
    says(path, "tiles t.ply -o b.obj --magnitudes 1", "give a .ply");
    says(path, "tiles t.ply -o b --magnitudes 1", "give a .ply");
    says(path, "tiles t.obj -o b.obj --magnitudes 1", "cannot store fields");
    says(path, "tiles t.ply t.obj -o b.ply --magnitudes 1", "only input");
    says(path, "tiles missing.ply -o b.ply --magnitudes 1", "missing.ply");
    let bytes = fs::read(path.join("t.ply")).unwrap();
    fs::write(path.join("cut.ply"), &bytes[..bytes.len() - 5]).unwrap();
    says(path, "tiles cut.ply -o b.ply --magnitudes 1 --quiet", "cut.ply");
    assert!(!path.join("b.ply").exists());
}
