//! Points that take no part: they keep their values, are nobody's neighbors, and change nothing for the others.

use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave_io::{LasLayout, LasReader, LasWriter};

use super::{RECORD, cloud, joined};
use crate::layout::{quantized_xyz, set_quantized_xyz};
use crate::{Params, TileSelection, TilesError, TilingJob, run};

/// Rule by which the point of a row takes part.
type Rule = fn(usize) -> bool;

/// Number of points.
const N: usize = 12_000;

/// Byte of a record with the class and the flags of a point.
const CLASS: usize = 15;

fn class(i: usize) -> u8 {
    match i % 100 {
        7 => 7,
        8 => 2 | 4 << 5,
        k if k % 3 == 0 => 5,
        _ => 2,
    }
}

/// The points of a hilly sheet that `is_in` names, with classes and flags; one of them has no height.
fn write(path: &Path, is_in: impl Fn(usize) -> bool) {
    let layout = LasLayout {
        format: 0,
        record_bytes: RECORD,
        scale: [0.001; 3],
        offset: [0.0; 3],
        n_points: (0..N).filter(|i| is_in(*i)).count() as u64,
        bounds: Some(([0.0, 0.0, -10.0], [100.0, 80.0, 30.0])),
    };
    let mut writer = LasWriter::new(path, &layout, &[], None).unwrap();
    let mut points = cloud(N as u32);
    points[40][2] = -9_999_000;
    let mut records = Vec::new();
    for (i, point) in points.iter().enumerate().filter(|(i, _)| is_in(*i)) {
        let mut record = [0; RECORD];
        set_quantized_xyz(&mut record, *point);
        record[12..14].copy_from_slice(&(i as u16).to_le_bytes());
        record[CLASS] = class(i);
        records.extend(record);
    }
    writer.write(&records).unwrap();
    writer.finish().unwrap();
}

/// Record of each point after a job, with its added fields; empty for a point that the file does not have.
fn results(folder: &Path, input: &Path, params: &Params) -> Vec<Vec<u8>> {
    let path = folder.join("out.las");
    std::fs::write(&path, joined(&folder.join("job"), &[input.to_path_buf()], params)).unwrap();
    std::fs::remove_dir_all(folder.join("job")).unwrap();
    let mut reader = LasReader::open(&path).unwrap();
    let (mut records, size) = (Vec::new(), reader.layout().record_bytes);
    while reader.read(usize::MAX, &mut records).unwrap() > 0 {}
    let mut of_points = vec![Vec::new(); N];
    for record in records.chunks_exact(size) {
        of_points[usize::from(u16::from_le_bytes([record[12], record[13]]))] = record.to_vec();
    }
    of_points
}

fn selection(conditions: &[&str]) -> TileSelection {
    let conditions = conditions.iter().map(|text| (*text).to_owned()).collect();
    TileSelection { conditions, ..TileSelection::default() }
}

fn params(selection: TileSelection) -> Params {
    let gains = vec![0.0, 0.2, 1.5];
    Params { levels: 3, gains, magnitudes: vec![2], selection, ..Params::default() }
}

#[test]
fn the_others_change_as_if_the_file_did_not_have_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (all, part) = (folder.join("all.las"), folder.join("part.las"));
    write(&all, |_| true);
    let mask = folder.join("mask.csv");
    let rows: String = (0..N).map(|i| if i % 5 == 2 { "0\n" } else { "1\n" }).collect();
    std::fs::write(&mask, format!("mask\n{rows}")).unwrap();
    let in_mask = |is_mask_inverted| TileSelection {
        mask: Some(mask.display().to_string()),
        is_mask_inverted,
        includes_flagged: true,
        ..TileSelection::default()
    };
    let cases: [(TileSelection, Rule); 7] = [
        (TileSelection::default(), |i| class(i) < 7),
        (TileSelection { includes_flagged: true, ..TileSelection::default() }, |_| true),
        (selection(&["classification=2"]), |i| class(i) == 2),
        (selection(&["classification=2,7"]), |i| class(i) == 2 || class(i) == 7),
        (selection(&["classification_flags=4"]), |i| class(i) > 31),
        (in_mask(false), |i| i % 5 != 2),
        (in_mask(true), |i| i % 5 == 2),
    ];
    for (selection, is_in) in cases {
        // The point without a height takes no part, and a file with the others alone has the same result.
        let is_member = |i: usize| is_in(i) && i != 40;
        write(&part, is_member);
        let asked = params(selection.clone());
        let found = results(folder, &all, &asked);
        for n_tiles in [2, 3] {
            let asked = Params { n_tiles: Some(n_tiles), n_workers: 2, ..asked.clone() };
            assert!(results(folder, &all, &asked) == found, "{selection:?}: {n_tiles} tiles differ");
        }
        let everything = TileSelection { includes_flagged: true, ..TileSelection::default() };
        let alone = results(folder, &part, &params(everything));
        let before: Vec<[i32; 3]> = {
            let mut points = cloud(N as u32);
            points[40][2] = -9_999_000;
            points
        };
        for i in 0..N {
            let field = |record: &[u8]| f32::from_le_bytes(record[RECORD..RECORD + 4].try_into().unwrap());
            assert_eq!(found[i][CLASS], class(i));
            if !is_member(i) {
                assert_eq!(quantized_xyz(&found[i]), before[i], "{selection:?} {i}");
                let is_right = if is_in(i) { field(&found[i]) == 0.0 } else { field(&found[i]).is_nan() };
                assert!(is_right, "{selection:?} {i}");
                continue;
            }
            let (a, b) = (quantized_xyz(&found[i]), quantized_xyz(&alone[i]));
            assert!((0..3).all(|c| (a[c] - b[c]).abs() <= 1), "{selection:?} {i}: {a:?} for {b:?}");
            let (a, b) = (field(&found[i]), field(&alone[i]));
            assert!((a - b).abs() <= 1e-5 * (1.0 + b), "{selection:?} {i}: {a} for {b}");
        }
    }
}

#[test]
fn points_left_out_are_counted_and_a_selection_that_fits_nothing_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let input = folder.join("a.las");
    write(&input, |_| true);
    let inputs: [PathBuf; 1] = [input];
    let summary = |name: &str, selection: TileSelection| {
        let job = TilingJob::begin(&folder.join(name), &inputs, &params(selection)).unwrap().0;
        run(&job, Progress::none())
    };
    let found = summary("default", TileSelection::default()).unwrap();
    let n_flagged = (0..N).filter(|i| class(*i) >= 7).count() as u64;
    assert_eq!((found.n_unselected, found.n_flagged, found.n_placeholders), (0, n_flagged, 1));
    let found = summary("class", selection(&["classification=2", "y=..40"])).unwrap();
    assert!(found.n_unselected > N as u64 / 2 && found.n_flagged > 0 && found.n_placeholders <= 1);
    let none = summary("none", selection(&["classification=31"])).unwrap_err();
    assert!(none.to_string().contains("classification=31"), "{none}");
    let begin = |selection: TileSelection| {
        TilingJob::begin(&folder.join("wrong"), &inputs, &params(selection)).map(|_| ()).unwrap_err()
    };
    let unknown = begin(selection(&["height=2"])).to_string();
    assert!(
        unknown.contains("no field for the condition 'height=2'") && unknown.contains("intensity"),
        "{unknown}"
    );
    assert!(matches!(begin(selection(&["height"])), TilesError::Input(_)));
    let mask = Some("missing.csv".to_owned());
    let missing = begin(TileSelection { mask, ..TileSelection::default() }).to_string();
    assert!(missing.contains("missing.csv") && !folder.join("wrong").exists(), "{missing}");
}

#[test]
fn a_file_of_noise_alone_takes_part() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("a.las");
    write(&input, |i| class(i) == 7);
    let job =
        TilingJob::begin(&folder.path().join("job"), &[input], &params(TileSelection::default())).unwrap().0;
    let summary = run(&job, Progress::none()).unwrap();
    assert_eq!((summary.n_flagged, summary.n_points), (0, (N / 100) as u64));
}
