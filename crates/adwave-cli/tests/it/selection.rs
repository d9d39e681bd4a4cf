//! Computation on a part of the data: the rest keeps its values and is no neighbor.

use crate::common;

use adwave_io::{ReadLimits, ShapeFile, read_npy, read_path};
use common::{json, refused};
use std::fs;
use std::path::Path;

const N: usize = 30;

fn uniform(k: usize) -> f64 {
    let mixed =
        (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 53) as f64
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

#[test]
fn a_part_is_filtered_as_if_the_rest_were_absent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let is_ground = forest(path);
    json(path, "filter ground.txt --preset smooth --along z -o alone.txt");
    let mask: String = is_ground.iter().map(|&is_low| if is_low { "1\n" } else { "0\n" }).collect();
    fs::write(path.join("mask.csv"), format!("in\n{mask}")).unwrap();
    let (before, alone) = (read(path, "all.txt"), read(path, "alone.txt"));
    for part in ["--only classification=2", "--only classification=..3", "--mask mask.csv"] {
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

#[test]
fn conditions_are_joined_by_and() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    forest(path);
    let found = json(path, "info all.txt --only classification=2 --only x=..10");
    let file = read(path, "all.txt");
    let n = (0..file.n_vertices())
        .filter(|&i| file.field("classification").unwrap().get(i, 0) == 2.0 && file.points()[i][0] <= 10.0)
        .count();
    assert_eq!(found["vertices"], n);
}

#[test]
fn selections_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    forest(path);
    fs::write(path.join("short.csv"), "in\n1\n0\n").unwrap();
    for (part, said) in [
        ("--only classification=9", "no vertex fulfils classification=9; the values of the field are 2 to 5"),
        ("--only class=2", "use classification, x, y, z"),
        ("--only classification", "must be FIELD=VALUE"),
        ("--only classification=3..2", "must be FIELD=VALUE"),
        ("--mask short.csv", "needs one number for each of 900 vertices, but has 2 rows"),
        ("--mask none.npy", "none.npy"),
    ] {
        let text = refused(path, &format!("info all.txt {part}"));
        assert!(text.contains(said), "{part}: {text}");
    }
}
