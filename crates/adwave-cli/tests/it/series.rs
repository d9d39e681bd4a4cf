//! Series of frames in the subcommands: the numbers are those of the library, and frames that do not say their time are
//! asked for it.

use crate::common::{adwave, json, refused, words};
use adwave::Progress;
use adwave::time::TimeAxis;
use adwave_io::{
    ArrayValues, Field, FieldValues, GRID_VALUES, GridLayout, ReadLimits, ShapeFile, read_path, write_npy,
    write_path,
};
use std::path::Path;

const FRAMES: usize = 12;

fn series(step: Option<f64>) -> ShapeFile {
    let mut file = ShapeFile::from_grid(GridLayout::new(&[4, 5, 6], &[3.0, 2.0, 2.0])).unwrap();
    let value = |i: usize| (i * 7919 % 101) as f32 + (i / FRAMES) as f32;
    let values = (0..120 * FRAMES).map(value).collect();
    let mut field = Field::new(GRID_VALUES, FRAMES, FieldValues::F32(values));
    field.frame_step = step;
    file.add_vertex_field(field).unwrap();
    file
}

fn values(path: &Path) -> Vec<f64> {
    read_path(path, &ReadLimits::default()).unwrap().field(GRID_VALUES).unwrap().to_f64()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_filter_along_time_is_that_of_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&series(Some(1.5)), &at("v.nii.gz"), None).unwrap();
    let report = json(folder.path(), "filter v.nii.gz -o s.nii.gz --time-lengths 3s");
    assert_eq!((&report["time"]["step"], &report["time"]["frames"]), (&1.5.into(), &FRAMES.into()));
    let mut expected = values(&at("v.nii.gz"));
    let axis = TimeAxis::new(FRAMES, 1.5).unwrap();
    axis.smooth(&mut expected, 1, 3.0, Progress::none()).unwrap();
    assert!(apart(&values(&at("s.nii.gz")), &expected) < 1e-4);
    // The file says the time again.
    let again = read_path(&at("s.nii.gz"), &ReadLimits::default()).unwrap();
    assert_eq!(again.field(GRID_VALUES).unwrap().frame_step, Some(1.5));
    // Space and time in one go are one after the other.
    for line in [
        "filter v.nii.gz -o both.nii.gz --fwhm 5 --preset suppress --time-lengths 3 --value-type f64",
        "filter v.nii.gz -o one.nii.gz --fwhm 5 --preset suppress --value-type f64",
        "filter one.nii.gz -o two.nii.gz --time-lengths 3",
    ] {
        adwave(folder.path()).args(words(line)).assert().success();
    }
    assert!(apart(&values(&at("both.nii.gz")), &values(&at("two.nii.gz"))) < 1e-9);
}

/// Numbers of the array of bands of this shape, which a file stores as they are.
fn stored_bands(path: &Path, shape: &[u8], n_bands: usize) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap();
    let find =
        |text: &[u8], from: usize| from + bytes[from..].windows(text.len()).position(|w| w == text).unwrap();
    let start = find(b"\n", find(shape, 0)) + 1;
    let numbers = bytes[start..][..n_bands * 120 * FRAMES * 8].as_chunks::<8>().0;
    numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

#[test]
fn bands_of_space_and_time_sum_to_the_signal() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&series(Some(2.0)), &at("v.nii"), None).unwrap();
    let line = "transform v.nii -o b.npz --fwhm 5,10 --time-fwhm 4s,9s";
    let report = json(folder.path(), line);
    assert_eq!(report["time"]["fwhm"].as_array().unwrap().len(), 2);
    let numbers = stored_bands(&at("b.npz"), b"(3, 3, 4, 5, 6, 12)", 9);
    let n = 120 * FRAMES;
    let sum: Vec<f64> = (0..n).map(|i| (0..9).map(|band| numbers[band * n + i]).sum()).collect();
    assert!(apart(&sum, &values(&at("v.nii"))) < 1e-11);
    let refused = refused(folder.path(), "transform v.nii -o b.nii --fwhm 5 --time-fwhm 4s");
    assert!(refused.contains(".npz"), "{refused}");
}

#[test]
fn gains_by_time_are_those_of_the_bands_with_two_indices() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&series(Some(1.5)), &at("v.nii"), None).unwrap();
    let levels = "--fwhm 3,6 --time-fwhm 4s";
    json(folder.path(), &format!("transform v.nii -o bands.npz {levels}"));
    let band = stored_bands(&at("bands.npz"), b"(3, 2, 4, 5, 6, 12)", 6);
    let line = format!(
        "filter v.nii -o f.nii {levels} --gains-by-time 0,0.5;2,1 --time-gains 0.25 --value-type f64"
    );
    let report = json(folder.path(), &line);
    assert_eq!(report["time"]["gains_by_time"], serde_json::json!([[0.0, 0.5], [2.0, 1.0]]));
    // Bands of space, then of time; what is left in space keeps 1, and the fine band along time a quarter of all.
    let gains = [[0.0, 2.0], [0.5, 1.0], [1.0, 1.0]].map(|[fine, rest]| [0.25 * fine, rest]);
    let found = values(&at("f.nii"));
    let n = found.len();
    let expected: Vec<f64> =
        (0..n).map(|i| (0..6).map(|k| gains[k / 2][k % 2] * band[k * n + i]).sum()).collect();
    assert!(apart(&found, &expected) < 1e-9, "{}", apart(&found, &expected));
    for (line, says) in [
        ("--fwhm 3,6 --time-fwhm 4s --gains-by-time 0,1", "2 rows"),
        ("--fwhm 3 --time-fwhm 4s --gains-by-time 0,1;1,1 --quiet", "got 2"),
        ("--fwhm 3 --gains-by-time 0;1", "--time-fwhm"),
    ] {
        let text = refused(folder.path(), &format!("filter v.nii -o s.nii {line}"));
        assert!(text.contains(says) && !at("s.nii").exists(), "{line}: {text}");
    }
}

#[test]
fn noise_in_space_and_time_goes_and_unknown_frames_are_held() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    adwave(folder.path()).args(words("sample bold -o clean.nii")).assert().success();
    adwave(folder.path()).args(words("sample bold --noise 0.03 -o noisy.nii")).assert().success();
    let report = json(folder.path(), "denoise noisy.nii -o found.nii --in-time");
    let (clean, noisy, found) =
        (values(&at("clean.nii")), values(&at("noisy.nii")), values(&at("found.nii")));
    let rms =
        |f: &[f64]| (f.iter().zip(&clean).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / f.len() as f64).sqrt();
    let noise = report["denoise"]["noise"].as_f64().unwrap();
    assert!((noise / rms(&noisy) - 1.0).abs() < 0.1, "{noise}");
    assert!(rms(&found) < 0.35 * rms(&noisy), "{} {}", rms(&found), rms(&noisy));
    let promised = report["denoise"]["risk"][1].as_f64().unwrap().sqrt();
    assert!((promised / rms(&found) - 1.0).abs() < 0.3, "{promised} {}", rms(&found));

    let mut gaps = series(Some(1.0));
    let mut numbers = gaps.field(GRID_VALUES).unwrap().to_f64();
    numbers[5 * FRAMES + 3] = f64::NAN;
    gaps.add_vertex_field(Field::new(GRID_VALUES, FRAMES, FieldValues::F64(numbers.clone()))).unwrap();
    write_path(&gaps, &at("gaps.nii"), None).unwrap();
    let line = "filter gaps.nii -o held.nii --time-fwhm 4s --time-step 1s";
    adwave(folder.path()).args(words(line)).assert().success();
    let held = values(&at("held.nii"));
    let row = |f: &[f64]| f[5 * FRAMES..6 * FRAMES].iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(row(&held), row(&numbers));
    assert!(held[..5 * FRAMES] != numbers[..5 * FRAMES]);
}

#[test]
fn what_does_not_say_its_time_is_asked_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&series(None), &at("v.nii"), None).unwrap();
    for (line, says) in [
        ("filter v.nii -o s.nii --time-fwhm 3s", "--time-step 2s"),
        ("denoise v.nii -o s.nii --in-time", "--time-step 2s"),
        ("filter v.nii -o s.nii --time-step 2s --fwhm 5 --preset suppress", "--time-fwhm"),
        ("filter v.nii -o s.nii --time-fwhm 5,3 --time-step 1", "increasing"),
        ("filter v.nii -o s.nii --time-fwhm 3,5 --time-step 1 --time-gains 1", "gain"),
        ("filter v.nii -o s.nii --time-fwhm 3 --time-step 0", "above 0"),
        ("filter v.nii -o s.nii --time-fwhm 3 --time-step 1 --fwhm 5", "--preset"),
        ("denoise v.nii -o s.nii --time-step 1", "--in-time"),
        ("denoise v.nii -o s.nii --in-time --time-step 1 --noise-model poisson", "--noise-model"),
        ("filter v.nii -o s.nii", "--time-fwhm"),
    ] {
        let text = refused(folder.path(), line);
        assert!(text.contains(says), "{line}: {text}");
        assert!(!at("s.nii").exists());
    }
    let sphere = "sample sphere --vertices 60 -o ball.ply";
    adwave(folder.path()).args(words(sphere)).assert().success();
    let text = refused(folder.path(), "filter ball.ply -o s.ply --time-fwhm 3");
    assert!(text.contains("frames"), "{text}");
    let n = read_path(&at("ball.ply"), &ReadLimits::default()).unwrap().n_vertices();
    let numbers: Vec<f64> = (0..n * 30).map(|i| (i * 31 % 17) as f64).collect();
    write_npy(&at("f.npy"), &[n, 30], ArrayValues::F64(&numbers)).unwrap();
    let line = "filter ball.ply -o s.npy --signal f.npy --time-fwhm 3 --time-step 1 --time-ends causal";
    let report = json(folder.path(), line);
    assert!(report["time"]["delay"].as_f64().unwrap() > 1.0);
    let gaps: Vec<f64> =
        numbers.iter().enumerate().map(|(i, v)| if i == 77 { f64::NAN } else { *v }).collect();
    write_npy(&at("f.npy"), &[n, 30], ArrayValues::F64(&gaps)).unwrap();
    let output = adwave(folder.path()).args(words(line)).assert().success().get_output().clone();
    let notes = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(notes.contains("NaN in some frames at 1 vertex"), "{notes}");
}

#[test]
fn bands_that_are_written_one_by_one_are_those_that_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut first = ShapeFile::from_grid(GridLayout::new(&[9, 8, 7], &[2.0, 1.0, 1.0])).unwrap();
    let numbers: Vec<f64> = (0..504).map(|i| f64::from(i * 7919 % 101)).collect();
    first.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::F64(numbers.clone()))).unwrap();
    write_path(&first, &at("v.nii"), None).unwrap();
    write_npy(&at("v.npy"), &[9, 8, 7], ArrayValues::F64(&numbers)).unwrap();
    // A TIFF keeps all bands until the end; a NIfTI takes them one after another, plain or compressed.
    let report = json(folder.path(), "transform v.nii -o kept.tif --fwhm 3,6");
    let kept = values(&at("kept.tif"));
    for name in ["one.nii", "one.nii.gz"] {
        let own = json(folder.path(), &format!("transform v.nii -o {name} --fwhm 3,6"));
        for key in ["energy", "fwhm", "levels", "error_bound", "channels"] {
            assert_eq!(own[key], report[key], "{key}");
        }
        let found = values(&at(name));
        assert!(found.len() == 3 * 504 && apart(&found, &kept) == 0.0);
        let sum: Vec<f64> = found.chunks_exact(3).map(|row| row.iter().sum()).collect();
        assert!(apart(&sum, &numbers) < 1e-12);
    }
    // The places without a value, and several channels, each with its bands.
    let mut holes = numbers.clone();
    holes[17] = f64::NAN;
    let mut two = first.clone();
    let pairs = holes.iter().flat_map(|v| [*v, 2.0 * v]).collect();
    two.add_vertex_field(Field::new(GRID_VALUES, 2, FieldValues::F64(pairs))).unwrap();
    write_path(&two, &at("two.nii"), None).unwrap();
    for name in ["bands.tif", "bands.nii"] {
        json(folder.path(), &format!("transform two.nii -o {name} --fwhm 3,6"));
    }
    let [kept, found] = ["bands.tif", "bands.nii"].map(|name| values(&at(name)));
    assert!(found.len() == 6 * 504 && kept.len() == found.len());
    let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
    assert!(kept.iter().zip(&found).all(same));
}

#[test]
fn a_compressed_series_is_filtered_as_a_plain_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // Large enough to go volume by volume.
    let (n, frames) = (64 * 64 * 64, 17);
    let mut file = ShapeFile::from_grid(GridLayout::new(&[64, 64, 64], &[2.0; 3])).unwrap();
    let numbers = (0..n * frames).map(|i| (i * 7919 % 10_007) as f32).collect();
    file.add_vertex_field(Field::new(GRID_VALUES, frames, FieldValues::F32(numbers))).unwrap();
    for name in ["v.nii", "v.nii.gz"] {
        write_path(&file, &at(name), None).unwrap();
    }
    let reports =
        [("v.nii", "a.nii"), ("v.nii.gz", "b.nii"), ("v.nii", "c.nii.gz"), ("v.nii.gz", "d.nii.gz")].map(
            |(input, output)| {
                let report =
                    json(folder.path(), &format!("filter {input} -o {output} --fwhm 6 --preset suppress"));
                (report["change"].clone(), values(&at(output)))
            },
        );
    assert!(reports.iter().all(|other| *other == reports[0]));
}
