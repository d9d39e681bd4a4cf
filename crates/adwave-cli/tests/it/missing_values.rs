//! Signals that are NaN at some vertices: each channel has its own mask, and summaries are numbers.

use crate::common;

use adwave_io::{
    ArrayValues, CiftiColumns, Field, FieldValues, ReadLimits, read_npy, read_path, write_cifti_fields,
    write_npy,
};
use common::{adwave, json, refused, words};
use std::fmt::Write;
use std::fs;
use std::path::Path;

const SIDE: usize = 20;

/// A grid of triangles as an OBJ, and a table with three columns, some of whose cells are empty.
fn write_inputs(path: &Path) {
    let mut text = String::new();
    for i in 0..SIDE * SIDE {
        let _ = writeln!(text, "v {} {} 0", i % SIDE, i / SIDE);
    }
    for i in (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE + 1 < SIDE) {
        let a = i + 1;
        let _ = writeln!(text, "f {a} {} {}\nf {} {} {a}", a + 1, a + SIDE + 1, a + SIDE + 1, a + SIDE);
    }
    fs::write(path.join("grid.obj"), text).unwrap();
    let mut table = String::from("a,b,c\n");
    for i in 0..SIDE * SIDE {
        let noise = (i * 7919 % 101) as f64 / 50.0 - 1.0;
        let b = if i % 7 == 0 { "nan".to_owned() } else { format!("{}", noise + 3.0) };
        let c = if i < 90 { "nan".to_owned() } else { format!("{}", noise * 2.0) };
        let _ = writeln!(table, "{noise},{b},{c}");
    }
    fs::write(path.join("all.csv"), table).unwrap();
}

fn columns(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    (0..rows[0].len()).map(|c| rows.iter().map(|row| row[c]).collect()).collect()
}

#[test]
fn a_gap_in_one_channel_leaves_the_others_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    for command in ["filter grid.obj --gains 0,0,0 --local-fit constant", "denoise grid.obj"] {
        let report = json(path, &format!("{command} --signal all.csv -o all-out.csv"));
        let all = columns(&path.join("all-out.csv"));
        let before = columns(&path.join("all.csv"));
        for (c, name) in ["a", "b", "c"].into_iter().enumerate() {
            json(path, &format!("{command} --signal all.csv:{name} -o one.csv"));
            let one = &columns(&path.join("one.csv"))[0];
            for i in 0..SIDE * SIDE {
                let (found, alone) = (all[c][i], one[i]);
                assert_eq!(found.is_nan(), before[c][i].is_nan(), "{command} {name} {i}");
                assert!(
                    found.is_nan() || (found - alone).abs() < 1e-9,
                    "{command} {name} {i}: {found} {alone}"
                );
            }
        }
        if command.starts_with("filter") {
            let rms = report["changed"]["rms"].as_f64().unwrap();
            assert!(rms > 0.1 && rms.is_finite(), "{report}");
        }
    }
    let output =
        adwave(path).args(words("filter grid.obj --gains 0 --signal all.csv -o o.csv")).output().unwrap();
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(notes.contains("3 groups of channels, at most 90 of 400"), "{notes}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(!text.contains("NaN"), "{text}");
}

#[test]
fn noise_models_need_their_values_and_leave_gaps_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    let all = columns(&path.join("all.csv"));
    let column: Vec<String> =
        all[1].iter().map(|b| if b.is_nan() { "nan".to_owned() } else { b.to_string() }).collect();
    fs::write(path.join("b.csv"), format!("b\n{}\n", column.join("\n"))).unwrap();
    let negative: Vec<String> = (0..column.len()).map(|x| (x as f64 - 7.0).to_string()).collect();
    fs::write(path.join("negative.csv"), format!("b\n{}\n", negative.join("\n"))).unwrap();
    for model in ["poisson", "multiplicative"] {
        let line = format!("denoise grid.obj --signal b.csv -o out.csv --noise-model {model}");
        let report = json(path, &line);
        assert_eq!(report["denoise"][0]["model"], model, "{report}");
        let found = &columns(&path.join("out.csv"))[0];
        assert!(found.iter().zip(&all[1]).all(|(f, b)| f.is_nan() == b.is_nan() && (f.is_nan() || *f > 0.0)));
        let message = refused(path, &line.replace("b.csv", "negative.csv"));
        assert!(message.contains("noise needs values"), "{message}");
    }
    let message = refused(path, "denoise grid.obj -o out.obj --noise-model poisson");
    assert!(message.contains("applies to a field"), "{message}");
}

/// Values in (−1, 1) at the vertices of the grid, with `sentinel` at the first sixty.
fn with_sentinel(sentinel: f64) -> Vec<f64> {
    (0..SIDE * SIDE).map(|i| if i < 60 { sentinel } else { (i as f64 * i as f64).sin() }).collect()
}

#[test]
fn sentinels_count_as_unknown_and_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    let write = |name: &str, values: &[f64], n_channels: usize| {
        let shape = [values.len() / n_channels, n_channels];
        write_npy(&path.join(name), &shape, ArrayValues::F64(values)).unwrap();
    };
    let read = |name: &str| read_npy(&path.join(name), &ReadLimits::default()).unwrap().values.to_f64();
    write("nan.npy", &with_sentinel(f64::NAN), 1);
    json(path, "filter grid.obj -o known.npy --signal nan.npy --preset smooth");
    let known = read("known.npy");
    for sentinel in [-1.6375e30, 9.96921e36, 1e20, -9999.0, -32768.0] {
        write("f.npy", &with_sentinel(sentinel), 1);
        let line = "filter grid.obj -o o.npy --signal f.npy --preset smooth";
        let output = adwave(path).args(words(line)).assert().success().get_output().clone();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("60 values of f.npy are") && said.contains("--keep-sentinels takes"), "{said}");
        let found = read("o.npy");
        for i in 0..SIDE * SIDE {
            assert!(if i < 60 { found[i] == sentinel } else { found[i] == known[i] }, "{sentinel} at {i}");
        }
        // A map has no value there.
        json(path, "saliency grid.obj -o map.npy --signal f.npy");
        let map = read("map.npy");
        assert!((0..60).all(|i| map[i].is_nan()) && map[60..].iter().all(|x| x.abs() < 10.0));
        // Many channels are read a group at a time.
        let wide: Vec<f64> = with_sentinel(sentinel).iter().flat_map(|x| [*x; 20]).collect();
        write("wide.npy", &wide, 20);
        json(path, "filter grid.obj -o wide-out.npy --signal wide.npy --preset smooth");
        let wide = read("wide-out.npy");
        for i in 0..SIDE * SIDE {
            let expected = if i < 60 { sentinel } else { known[i] };
            assert!(
                (wide[20 * i + 7] - expected).abs() <= 1e-9 * expected.abs().max(1.0),
                "{sentinel} at {i}"
            );
        }
        json(path, &format!("{line} --keep-sentinels"));
        assert!(read("o.npy")[60..].iter().any(|x| x.abs() > 100.0));
    }
    // Depths of some thousand meters may be −9999 too.
    let depths: Vec<f64> = (0..SIDE * SIDE).map(|i| -9999.0 + 40.0 * i as f64).collect();
    write("depths.npy", &depths, 1);
    let line = "filter grid.obj -o o.npy --signal depths.npy --preset smooth";
    let output = adwave(path).args(words(line)).assert().success().get_output().clone();
    assert!(!String::from_utf8(output.stderr).unwrap().contains("unknown"));
    assert!(refused(path, &format!("{line} --keep-sentinels")).contains("has none"));
}

#[test]
fn integers_of_a_file_keep_their_sentinel() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let n = SIDE * SIDE;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\n\
         property short depth\nend_header\n"
    );
    for i in 0..n {
        let depth = if i % 9 == 0 { -32768 } else { (i * 7919 % 101) as i32 };
        let _ = writeln!(text, "{} {} 0 {depth}", i % SIDE, i / SIDE);
    }
    fs::write(path.join("a.ply"), text).unwrap();
    json(path, "filter a.ply -o b.ply --signal depth --preset smooth");
    let file = read_path(&path.join("b.ply"), &ReadLimits::default()).unwrap();
    let depth = file.field("depth").unwrap();
    for i in 0..n {
        let x = depth.get(i, 0);
        assert!(if i % 9 == 0 { x == -32768.0 } else { (0.0..=100.0).contains(&x) }, "{x} at {i}");
    }
}

#[test]
fn a_cifti_keeps_both_hemispheres_without_a_code_of_its_intent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    fs::rename(path.join("grid.obj"), path.join("lh.grid.obj")).unwrap();
    let values =
        Field::new("v", 2, FieldValues::F64((0..2 * SIDE * SIDE).map(|k| (k as f64).sin()).collect()));
    let name = path.join("v.dtseries.nii");
    write_cifti_fields(&name, &[values], "CortexLeft", CiftiColumns::Series).unwrap();
    let mut bytes = fs::read(&name).unwrap();
    bytes[504..512].fill(0);
    let at = bytes.windows(14).position(|w| w == b"SeriesStep=\"1\"").unwrap();
    bytes[at + 12] = b'2';
    fs::write(&name, &bytes).unwrap();
    let line = "filter lh.grid.obj -o w.dtseries.nii --signal v.dtseries.nii --fwhm 3 --gains 0";
    let output = adwave(path).args(words(line)).assert().success().get_output().clone();
    assert!(!String::from_utf8(output.stderr).unwrap().contains("1 s apart"));
    let written = fs::read(path.join("w.dtseries.nii")).unwrap();
    assert!(written.windows(14).any(|w| w == b"SeriesStep=\"2\""));
    // Another kind of file is a new one, and a note says what it lacks.
    let line = "filter lh.grid.obj -o w.dscalar.nii --signal v.dtseries.nii --fwhm 3 --gains 0";
    let output = adwave(path).args(words(line)).assert().success().get_output().clone();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("a new CIFTI with the values of this surface alone"), "{said}");
    fs::rename(path.join("lh.grid.obj"), path.join("grid.obj")).unwrap();
    let error = refused(path, "saliency grid.obj -o map.dscalar.nii");
    assert!(error.contains("name its file with lh. or rh. at the beginning"), "{error}");
}
