//! Signals of many channels, which are filtered in groups.

use crate::common;

use adwave_io::{ArrayValues, ReadLimits, read_npy, write_npy};
use common::{json, refused};
use std::path::Path;

/// Bound of the bands' relative error, times the size of the values.
const ACCURACY: f64 = 1e-8;

fn write(path: &Path, shape: &[usize], values: &[f64]) {
    write_npy(path, shape, ArrayValues::F64(values)).unwrap();
}

fn read(path: &Path) -> Vec<f64> {
    read_npy(path, &ReadLimits::default()).unwrap().values.to_f64()
}

#[test]
fn each_of_many_channels_is_filtered_as_if_it_were_alone() {
    const N: usize = 400;
    const CHANNELS: usize = 40;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let value = |x: usize, c: usize| ((x * 37 + c * 101 + x * c) % 257) as f64 / 16.0;
    // A gap in two channels.
    let gap = |x: usize, c: usize| (50..60).contains(&x) && (c == 3 || c == 31);
    let signal = |x: usize, c: usize| if gap(x, c) { f64::NAN } else { value(x, c) };
    let all: Vec<f64> = (0..N * CHANNELS).map(|i| signal(i / CHANNELS, i % CHANNELS)).collect();
    write(&path.join("all.npy"), &[N, CHANNELS], &all);
    let region = "--region ball:vertex=7,radius=40%";
    for options in ["--preset smooth", "--preset smooth --local-fit constant", region] {
        let gains = if options == region { "--preset enhance " } else { "" };
        let line = |name: &str| {
            format!(
                "filter sample:sphere --vertices {N} --signal {name}.npy {gains}{options} -o out-{name}.npy"
            )
        };
        json(path, &line("all"));
        let found = read(&path.join("out-all.npy"));
        for c in [0, 3, 17, 31, CHANNELS - 1] {
            let one: Vec<f64> = (0..N).map(|x| signal(x, c)).collect();
            write(&path.join("one.npy"), &[N], &one);
            json(path, &line("one"));
            for (x, alone) in read(&path.join("out-one.npy")).into_iter().enumerate() {
                let together = found[x * CHANNELS + c];
                assert_eq!(alone.is_nan(), together.is_nan(), "{options}: channel {c}, vertex {x}");
                let is_close = alone.is_nan() || (alone - together).abs() <= ACCURACY * 16.0;
                assert!(is_close, "{options}: {alone} and {together}");
            }
        }
    }
    write(&path.join("short.npy"), &[N - 1, CHANNELS], &all[CHANNELS..]);
    let line = "filter sample:sphere --vertices 400 --signal short.npy --preset smooth -o out.npy";
    assert!(refused(path, line).contains("399"));
}

#[test]
fn single_precision_keeps_to_the_bound_that_is_printed() {
    const N: usize = 300;
    const CHANNELS: usize = 70;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let all: Vec<f64> = (0..N * CHANNELS).map(|i| ((i * 37 + i / 11) % 257) as f64 / 16.0).collect();
    write(&path.join("all.npy"), &[N, CHANNELS], &all);
    let line = |options: &str, out: &str| {
        format!(
            "filter sample:sphere --vertices {N} --signal all.npy --local-fit constant --gains 0,0,0,1 {options} -o {out}"
        )
    };
    let exact = json(path, &line("", "exact.npy"));
    assert_eq!(exact["bands"]["precision"], "double");
    assert!(exact["bands"]["error_bound"].as_f64().unwrap() <= 1e-10);
    let single = json(path, &line("--precision single", "single.npy"));
    assert_eq!(single["bands"]["precision"], "single");
    let bound = single["bands"]["error_bound"].as_f64().unwrap();
    assert!((1e-7..1e-3).contains(&bound), "{bound}");
    let (exact, found) = (read(&path.join("exact.npy")), read(&path.join("single.npy")));
    let norm = |v: &dyn Fn(usize) -> f64| (0..all.len()).map(|i| v(i).powi(2)).sum::<f64>().sqrt();
    let error = norm(&|i| found[i] - exact[i]) / norm(&|i| exact[i] - all[i]);
    // The bound is in the norm of the stationary distribution; on this sphere it differs little from the plain one.
    assert!(error > 1e-9 && error < 3.0 * bound, "{error} with a bound of {bound}");
    let auto = json(path, &line("--accuracy 0.01", "auto.npy"));
    assert_eq!(auto["bands"]["precision"], "single");
    assert_eq!(
        json(path, &line("--accuracy 0.01 --precision double", "d.npy"))["bands"]["precision"],
        "double"
    );
    for n_channels in [1, 3, 15] {
        write(&path.join("few.npy"), &[N, n_channels], &all[..N * n_channels]);
        let few = |options: &str, out: &str| line(options, out).replace("all.npy", "few.npy");
        let exact = json(path, &few("", "exact.npy"));
        assert!(exact["bands"].is_null());
        let single = json(path, &few("--precision single", "single.npy"));
        assert_eq!(single["bands"]["precision"], "single");
        let bound = single["bands"]["error_bound"].as_f64().unwrap();
        let (exact, found) = (read(&path.join("exact.npy")), read(&path.join("single.npy")));
        let norm = |v: &dyn Fn(usize) -> f64| (0..exact.len()).map(|i| v(i).powi(2)).sum::<f64>().sqrt();
        let error = norm(&|i| found[i] - exact[i]) / norm(&|i| exact[i] - all[i]);
        assert!(error > 1e-9 && error < 3.0 * bound && bound < 1e-3, "{error} with a bound of {bound}");
    }
    let positions =
        "filter sample:sphere --vertices 300 --preset smooth --levels 4 --precision single -o out.ply";
    assert_eq!(json(path, positions)["bands"]["precision"], "single");
    let region = "filter sample:sphere --vertices 300 --region ball:vertex=0,radius=30% --gains 0,0 \
        --precision single -o out.ply";
    assert_eq!(json(path, region)["bands"]["precision"], "single");
    let linear =
        "filter sample:sphere --vertices 300 --signal all.npy --preset smooth --precision single -o out.npy";
    assert!(refused(path, linear).contains("--local-fit constant"));
}

#[test]
fn an_array_by_columns_is_the_whole_array_and_a_wrong_one_leaves_no_file() {
    const N: usize = 100;
    const CHANNELS: usize = 10_001;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let all: Vec<f64> = (0..N * CHANNELS).map(|i| ((i * 37 + i / 11) % 257) as f64 / 16.0).collect();
    write(&path.join("all.npy"), &[N, CHANNELS], &all);
    let options = "--vertices 100 --local-fit constant --gains 0,0,1";
    json(path, &format!("filter sample:sphere {options} --signal all.npy -o out.npy"));
    let found = read(&path.join("out.npy"));
    for c in [0, 4999, 10_000] {
        let one: Vec<f64> = (0..N).map(|x| all[x * CHANNELS + c]).collect();
        write(&path.join("one.npy"), &[N], &one);
        json(path, &format!("filter sample:sphere {options} --signal one.npy -o alone.npy"));
        for (x, alone) in read(&path.join("alone.npy")).into_iter().enumerate() {
            assert!((alone - found[x * CHANNELS + c]).abs() <= ACCURACY * 16.0);
        }
    }
    write(&path.join("none.npy"), &[N, 0], &[]);
    let none = format!("filter sample:sphere {options} --signal none.npy -o none-out.npy");
    assert!(!refused(path, &none).is_empty() && !path.join("none-out.npy").exists());
    let mut bad = all[..N * 20].to_vec();
    bad[N * 20 - 1] = f64::INFINITY;
    write(&path.join("bad.npy"), &[N, 20], &bad);
    let line = format!("filter sample:sphere {options} --signal bad.npy -o bad-out.npy");
    assert!(refused(path, &line).contains("not finite"));
    let left = std::fs::read_dir(path).unwrap().filter(|entry| {
        let name = entry.as_ref().unwrap().file_name();
        name.to_string_lossy().starts_with(".adwave") || name == "bad-out.npy"
    });
    assert_eq!(left.count(), 0);
}
