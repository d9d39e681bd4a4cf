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
