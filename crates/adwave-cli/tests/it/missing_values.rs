//! Signals that are NaN at some vertices: each channel has its own mask, and summaries are numbers.

use crate::common;

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
