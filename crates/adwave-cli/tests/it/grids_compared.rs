//! `diff`, `compare` and `report` of images and volumes: the numbers that are printed are those of the files.

use crate::common::{adwave, json, real_files, words};
use adwave_io::{Field, FieldValues, GRID_VALUES, GridLayout, ReadLimits, ShapeFile, read_path, write_path};
use adwave_test_data::data_test;
use serde_json::Value;
use std::fs;
use std::path::Path;

const SIZES: [usize; 3] = [6, 10, 8];
const SPACINGS: [f64; 3] = [3.0, 2.0, 1.5];
const N: usize = 480;
/// Rounding of files of 32-bit floats.
const ROUNDING: f64 = 1e-5;

fn write(path: &Path, layout: GridLayout, value: impl Fn(usize) -> f32) {
    let n = layout.n_places();
    let mut file = ShapeFile::from_grid(layout).unwrap();
    file.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::F32((0..n).map(value).collect()))).unwrap();
    write_path(&file, path, None).unwrap();
}

fn volume(path: &Path, value: impl Fn(usize) -> f32) {
    let mut layout = GridLayout::new(&SIZES, &SPACINGS);
    layout.origin = [-10.0, 20.0, 5.0];
    write(path, layout, value);
}

fn rough(place: usize) -> f32 {
    (place * 7919 % 101) as f32
}

/// The channels of the values of a file.
fn channels(path: &Path) -> Vec<Vec<f64>> {
    let file = read_path(path, &ReadLimits::default()).unwrap();
    let field = file.field(GRID_VALUES).unwrap();
    (0..field.n_channels).map(|c| (0..field.len()).map(|i| field.get(i, c)).collect()).collect()
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let known = values.filter(|v| v.is_finite());
    (known.clone().map(|v| v * v).sum::<f64>() / known.count() as f64).sqrt()
}

fn close(found: &Value, expected: f64) -> bool {
    (found.as_f64().unwrap() - expected).abs() <= ROUNDING * expected.abs().max(1e-3)
}

#[test]
fn a_difference_is_the_sum_of_its_bands_and_names_its_places() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let change = |place: usize| if place == 275 { -40.0 } else { (place % 7) as f32 };
    volume(&at("a.nii"), rough);
    volume(&at("b.nii"), |place| rough(place) + change(place));
    let found = json(folder.path(), "diff a.nii b.nii --lengths 2,4,8 -o d.nii.gz");
    let frames = channels(&at("d.nii.gz"));
    assert_eq!(frames.len(), 5, "the difference, three bands and the rest");
    for (place, value) in frames[0].iter().enumerate() {
        assert_eq!(*value, f64::from(change(place)));
        let sum: f64 = frames[1..].iter().map(|frame| frame[place]).sum();
        assert!((sum - value).abs() < 40.0 * ROUNDING, "{place}: {sum} {value}");
    }
    let difference = &found["difference"];
    assert!(close(&difference["rms"], rms(frames[0].iter().copied())), "{difference}");
    // Place 275 is index 3, 4, 3 of z, y, x.
    assert_eq!(
        (&difference["greatest"], &difference["index"]),
        (&40.0.into(), &serde_json::json!([3, 4, 3]))
    );
    assert_eq!(difference["position"], serde_json::json!([-5.5, 28.0, 14.0]));
    assert_eq!((&difference["identical"], &difference["compared"]), (&false.into(), &N.into()));
    for (level, band) in found["levels"].as_array().unwrap().iter().zip(&frames[1..4]) {
        assert!(close(&level["rms"], rms(band.iter().copied())), "{level}");
        let index: Vec<usize> =
            level["index"].as_array().unwrap().iter().map(|k| k.as_u64().unwrap() as usize).collect();
        let greatest = band[(index[0] * SIZES[1] + index[1]) * SIZES[2] + index[2]].abs();
        assert!(close(&level["max"], greatest), "{level} {greatest}");
        assert!(band.iter().all(|v| v.abs() <= greatest));
    }
    assert!(close(&found["rest_rms"], rms(frames[4].iter().copied())));
    let output = adwave(folder.path()).args(words("diff a.nii b.nii --lengths 2,4")).assert().success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(text.contains("at voxel 3, 4, 3 (-5.5"), "{text}");
    assert!(text.contains("rest") && text.contains("sum"), "{text}");
}

#[test]
fn places_without_data_in_either_take_no_part() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    volume(&at("a.nii"), |place| if place < 16 { f32::NAN } else { 1.0 });
    volume(&at("b.nii"), |place| match place {
        0..=7 | 470.. => f32::NAN,
        20 => 3.0,
        _ => 1.0,
    });
    let found = json(folder.path(), "diff a.nii b.nii --lengths 2,4 -o d.npz")["difference"].clone();
    let numbers = ["places", "compared", "only_first", "only_second"].map(|key| found[key].as_u64().unwrap());
    assert_eq!(numbers, [480, 454, 10, 8]);
    assert!(close(&found["rms"], (4.0_f64 / 454.0).sqrt()) && found["greatest"] == 2.0, "{found}");
    let output = adwave(folder.path()).args(words("diff a.nii b.nii --lengths 2")).assert().success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(
        text.contains("454 of 480 voxels are compared: 10 have data in a.nii alone, 8 in b.nii alone"),
        "{text}"
    );
    // A mask applies to both.
    volume(&at("mask.nii"), |place| f32::from(u8::from(place >= 240)));
    let found = json(folder.path(), "diff a.nii b.nii --lengths 2 --mask mask.nii");
    assert_eq!(
        (&found["difference"]["compared"], &found["difference"]["greatest"]),
        (&230.into(), &0.0.into())
    );
    let same = json(folder.path(), "diff a.nii a.nii --lengths 2 -o same.nii");
    assert_eq!((&same["difference"]["identical"], &same["rest_rms"]), (&true.into(), &0.0.into()));
    let output = adwave(folder.path()).args(words("diff a.nii a.nii --lengths 2")).assert().success();
    let text = String::from_utf8(output.get_output().stdout.clone()).unwrap();
    assert!(text.contains("identical: all 464 voxels have equal values"), "{text}");
}

#[test]
fn a_page_shows_both_images_and_the_bands_of_the_difference() {
    let folder = tempfile::tempdir().unwrap();
    for line in [
        "sample hills --vertices 2500 -o a.tif",
        "sample hills --vertices 2500 --noise 0.1 -o b.tif",
        "diff a.tif b.tif --levels 4 -o diff.html",
    ] {
        adwave(folder.path()).args(words(line)).assert().success();
    }
    let page = fs::read_to_string(folder.path().join("diff.html")).unwrap();
    assert!(page.matches("<picture>").count() >= 11 && page.contains("difference, units of the image"));
}

#[test]
fn grids_that_do_not_fit_are_refused_with_both_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    volume(&at("a.nii"), rough);
    write(&at("small.nii"), GridLayout::new(&[6, 10, 7], &SPACINGS), rough);
    write(&at("moved.nii"), GridLayout::new(&SIZES, &SPACINGS), rough);
    let mut file = ShapeFile::from_grid(GridLayout::new(&SIZES, &SPACINGS)).unwrap();
    file.add_vertex_field(Field::new(GRID_VALUES, 2, FieldValues::F32(vec![1.0; 2 * N]))).unwrap();
    write_path(&file, &at("two.nii"), None).unwrap();
    write(
        &at("none.nii"),
        GridLayout::new(&SIZES, &SPACINGS),
        |place| if place > 0 { f32::NAN } else { 1.0 },
    );
    write(
        &at("rest.nii"),
        GridLayout::new(&SIZES, &SPACINGS),
        |place| if place > 0 { 1.0 } else { f32::NAN },
    );
    for (line, named) in [
        ("diff a.nii small.nii", "sizes are [6, 10, 8], got [6, 10, 7]"),
        ("diff a.nii moved.nii", "place 0 is at [-10.0, 20.0, 5.0], got [0.0, 0.0, 0.0]"),
        ("diff moved.nii two.nii", "1, got 2"),
        ("diff none.nii rest.nii", "none has data in both"),
        ("diff a.nii sample:sphere", "got a volume (a.nii) and a mesh (sample:sphere)"),
        ("diff sample:sphere a.nii", "got a mesh (sample:sphere) and a volume (a.nii)"),
        ("diff a.nii a.nii --align", "--align applies to shapes, and a.nii is a volume"),
        ("diff a.nii a.nii --by closest", "--by applies to shapes"),
        ("diff a.nii a.nii --limit 3", "--limit applies to shapes"),
        ("diff a.nii a.nii -o d.html --view top", "--view applies to shapes"),
        ("diff a.nii a.nii -o d.ply", "the format holds shapes"),
        ("diff sample:sphere sample:sphere -o d.npz", "a difference is written as"),
        ("compare a.nii --with mht -o out", "--with mht takes shapes, and a.nii is a volume"),
        (
            "compare sample:sphere --with starlet -o out",
            "takes images and volumes, and sample:sphere is a mesh",
        ),
        ("compare a.nii --with gaussian --harmonics 3 -o out", "--harmonics applies to --with mht"),
        ("compare a.nii --with gaussian --lengths 1e9 -o out", "at most 32 dyadic levels"),
        ("report a.nii -o r.html --up z", "--up applies to shapes"),
    ] {
        let output = adwave(folder.path()).args(words(line)).assert().code(2).get_output().clone();
        let text = String::from_utf8(output.stderr).unwrap();
        // Notes on what the files lack come first.
        let error = text.lines().find(|line| !line.starts_with("note: ")).unwrap();
        assert!(error.starts_with("adwave: ") && error.contains(named), "{line}: {text}");
        assert!(output.stdout.is_empty() && text.trim_end().ends_with(error), "{line}: {text}");
    }
}

/// Number of a row of a comparison for ours and the other method.
fn row(report: &Value, level: usize, quantity: &str) -> [Option<f64>; 2] {
    let rows = report["rows"].as_array().unwrap();
    let is_asked = |row: &&Value| row["quantity"] == quantity && row["level"] == level;
    let row = rows.iter().find(is_asked).unwrap_or_else(|| panic!("{quantity}: {rows:?}"));
    ["adwave", "other"].map(|key| row[key].as_f64())
}

#[test]
fn comparisons_state_the_numbers_of_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let is_out = |place: usize| place.is_multiple_of(8);
    volume(&at("a.nii"), |place| if is_out(place) { f32::NAN } else { rough(place) });
    volume(&at("whole.nii"), rough);
    for (method, input) in [("gaussian", "a.nii"), ("starlet", "a.nii"), ("gaussian", "whole.nii")] {
        let line = format!("compare {input} --with {method} --lengths 4,8 -o {method}");
        let report = json(folder.path(), &line);
        assert_eq!((&report["with"], report["rows"].as_array().unwrap().len()), (&method.into(), 12));
        let [own, other] =
            ["adwave", method].map(|name| channels(&at(method).join(format!("{name}.nii.gz"))));
        assert_eq!((own.len(), other.len()), (3, 3));
        let input = channels(&at(input)).remove(0);
        for frames in [&own, &other] {
            let sum = |place: usize| frames.iter().map(|frame| frame[place]).sum::<f64>();
            let is_same = |place: usize| input[place].is_nan() || (sum(place) - input[place]).abs() < 1e-3;
            assert!((0..N).all(is_same), "{method}: bands and rest sum to the input");
        }
        for (level, (a, b)) in own.iter().zip(&other).take(2).enumerate() {
            let [ours, theirs] = row(&report, level + 1, "rms of W").map(Option::unwrap);
            let difference = rms(a.iter().zip(b).map(|(a, b)| a - b));
            assert!((ours / rms(a.iter().copied()) - 1.0).abs() < 1e-4, "{method} {ours}");
            assert!((theirs / rms(b.iter().copied()) - 1.0).abs() < 1e-4, "{method} {theirs}");
            let [_, relative] = row(&report, level + 1, "W differs by");
            assert!((relative.unwrap() - difference / ours).abs() < 1e-4, "{method} {relative:?}");
        }
        let mean = |values: &[f64]| {
            let known = values.iter().filter(|v| v.is_finite());
            known.clone().sum::<f64>() / known.count() as f64
        };
        let changes = row(&report, 2, "mean of S off by").map(Option::unwrap);
        for (change, frames) in changes.iter().zip([&own, &other]) {
            assert!((mean(&frames[2]) - mean(&input) - change).abs() < 1e-3, "{method} {change}");
        }
        assert!(changes[0].abs() < 1e-7, "heat keeps the sum: {changes:?}");
        let below = row(&report, 2, "S below data").map(Option::unwrap);
        assert!(below.iter().all(|below| *below < 1e-6), "{below:?}");
        let [sigma, width] = row(&report, 2, "σ").map(Option::unwrap);
        assert!((sigma - 8.0).abs() < 1e-9, "{sigma}");
        // Two passes of the spline: variances 1 + 4 in places along each axis.
        let expected = match method {
            "starlet" => (2.0 * 5.0 * (9.0 + 4.0 + 2.25) / 3.0_f64).sqrt(),
            _ => 8.0,
        };
        assert!((width / expected - 1.0).abs() < 1e-3, "{method} {width}");
    }
    let report = json(folder.path(), "compare whole.nii --with starlet --levels 2 -o out");
    let [ours, theirs] = row(&report, 2, "σ").map(Option::unwrap);
    assert!((ours - theirs).abs() < 1e-9, "levels have the widths of the starlet: {ours} {theirs}");
}

#[test]
fn a_report_of_an_image_and_of_a_volume_has_pictures_and_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    volume(&path.join("v.nii"), rough);
    for (line, kind, words, n_pictures) in [
        ("report sample:hills --vertices 2500 --levels 4 -o page.html", "image", "pixels", 16),
        ("report v.nii --levels 3 -o page.html", "volume", "voxels", 14),
        ("report v.nii --levels 3 --only values=30.. -o page.html", "volume", "voxels", 14),
    ] {
        let report = json(path, line);
        assert_eq!((&report["kind"], &report["health"]), (&kind.into(), &Value::Null));
        assert!(report["pictures"].as_u64().unwrap() >= n_pictures, "{line}: {}", report["pictures"]);
        let level = &report["bands"][1];
        let fwhm = level["fwhm"].as_f64().unwrap() / level["sigma"].as_f64().unwrap();
        assert!((fwhm - (4.0 * std::f64::consts::LN_2).sqrt()).abs() < 1e-12, "{level}");
        let page = fs::read_to_string(path.join("page.html")).unwrap();
        for part in [words, "FWHM", "Axes and values", "Saliency", "Presets"] {
            assert!(page.contains(part), "{line}: {part}");
        }
        assert!(!page.contains(" vertices") && !page.contains(" node "), "{line}");
        assert_eq!(page.contains("Places without data"), line.contains("--only"), "{line}");
    }
}

#[data_test]
fn real_images_terrains_and_volumes_are_compared_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let data = real_files().join("domains");
    for name in ["images/coins.png", "dem/west_bijou_gully.asc", "volumes/anatomical.nii"] {
        let shown = data.join(name).display().to_string();
        let report = json(folder.path(), &format!("report {shown} --levels 4 -o page.html"));
        assert!(report["pictures"].as_u64().unwrap() >= 10, "{name}");
        for method in ["gaussian", "starlet"] {
            let report = json(folder.path(), &format!("compare {shown} --with {method} --levels 4 -o out"));
            let [ours, _] = row(&report, 4, "S below data");
            assert!(ours.unwrap() < 1e-6, "{name}: {ours:?}");
        }
        let found = json(folder.path(), &format!("diff {shown} {shown} --levels 3"));
        assert_eq!(found["difference"]["identical"], true, "{name}");
    }
}
