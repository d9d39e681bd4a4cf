//! Values carried between registered spheres.

use crate::common::{adwave, json, refused, words};
use adwave::sample::Sample;
use adwave_io::{
    Field, FieldValues, Format, ReadLimits, ShapeFile, read_gifti_fields, read_npy, read_surface_values,
    write_path,
};
use predicates::str::contains;
use std::fs;
use std::path::Path;

/// Accuracy of the numbers that a GIFTI or CIFTI stores.
const SINGLE: f64 = 1e-6;

/// Spheres of both hemispheres in two sizes: fields of the source are a thickness with a wall of zeros, and labels.
fn write_spheres(folder: &Path) -> [usize; 2] {
    let mut sizes = [0; 2];
    for (k, (n, name)) in [(700, "sphere.reg"), (300, "sphere")].into_iter().enumerate() {
        let mesh = Sample::from_name("sphere", Some(n)).unwrap();
        let points: Vec<[f64; 3]> = mesh.points.iter().map(|p| p.map(|c| 100.0 * c)).collect();
        sizes[k] = points.len();
        for side in ["lh", "rh"] {
            let sign = if side == "lh" { 1.0 } else { -1.0 };
            let turned = points.iter().map(|[x, y, z]| [*x, sign * y, sign * z]).collect();
            let file = ShapeFile::from_mesh(turned, mesh.faces.clone());
            write_path(&file, &folder.join(format!("{side}.{name}")), Some(Format::FREESURFER)).unwrap();
            if k == 0 {
                let thick: Vec<f64> = file
                    .points()
                    .iter()
                    .map(|p| if p[2] > 80.0 { 0.0 } else { 2.0 + p[0] / 100.0 })
                    .collect();
                let labels = file.points().iter().map(|p| 10 * i32::from(p[0] > 0.0) + 5).collect();
                for (name, values) in
                    [("thickness", FieldValues::F64(thick)), ("parcels.label", FieldValues::I32(labels))]
                {
                    let path = folder.join(format!("{side}.{name}.gii"));
                    adwave_io::write_gifti_fields(&path, &[Field::new("value", 1, values)], None).unwrap();
                }
            }
        }
    }
    sizes
}

#[test]
fn both_hemispheres_go_into_one_cifti() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let [n, m] = write_spheres(path);
    let spheres = "--from lh.sphere.reg --from rh.sphere.reg --to lh.sphere --to rh.sphere";
    let line = format!("resample lh.thickness.gii rh.thickness.gii {spheres} -o both.dscalar.nii");
    let told = json(path, &line);
    for (k, side) in ["lh", "rh"].into_iter().enumerate() {
        let about = &told["hemispheres"][k];
        assert_eq!(
            (about["from_vertices"].as_u64(), about["to_vertices"].as_u64()),
            (Some(n as u64), Some(m as u64))
        );
        assert_eq!(about["keep"], "mean");
        let wall = about["wall_vertices"].as_f64().unwrap() / n as f64;
        assert!((wall - 0.1).abs() < 0.03, "a cap of a tenth: {wall}");
        // The same hemisphere by itself.
        json(
            path,
            &format!(
                "resample {side}.thickness.gii --from {side}.sphere.reg --to {side}.sphere -o {side}.npy"
            ),
        );
        let alone =
            read_npy(&path.join(format!("{side}.npy")), &ReadLimits::default()).unwrap().values.to_f64();
        let structure = if side == "lh" { "CortexLeft" } else { "CortexRight" };
        let both =
            read_surface_values(&path.join("both.dscalar.nii"), Some(structure), m, &ReadLimits::default());
        let both = both.unwrap()[0].to_f64();
        assert!(alone.iter().zip(&both).all(|(a, b)| (a - b).abs() < SINGLE));
        assert!(alone.iter().all(|v| *v == 0.0 || (1.0..=3.0).contains(v)), "zeros do not bleed");
    }
    // The CIFTI goes back.
    let back = "--from lh.sphere --from rh.sphere --to lh.sphere.reg --to rh.sphere.reg";
    json(path, &format!("resample both.dscalar.nii {back} -o l.gii -o r.gii"));
    let left = read_gifti_fields(&path.join("l.gii"), &ReadLimits::default()).unwrap();
    assert_eq!((left.len(), left[0].len()), (1, n));
    let line = format!("resample lh.thickness.gii rh.thickness.gii {spheres} -o out.dscalar.nii");
    adwave(path).args(words(&line)).assert().success().stderr(contains("medial wall"));
}

#[test]
fn labels_stay_labels_and_sums_stay_sums() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let [n, m] = write_spheres(path);
    let pair = "--from lh.sphere.reg --to lh.sphere";
    let told = json(path, &format!("resample lh.parcels.label.gii {pair} -o labels.gii"));
    assert_eq!(told["hemispheres"][0]["keep"], "labels");
    assert_eq!(told["hemispheres"][0]["kept_after"], 2.0);
    let labels = read_gifti_fields(&path.join("labels.gii"), &ReadLimits::default()).unwrap();
    assert_eq!(labels[0].values.value_type().name(), "i32");
    assert!(labels[0].to_f64().iter().all(|v| *v == 5.0 || *v == 15.0));
    let told = json(path, &format!("resample lh.thickness.gii {pair} -o sums.npy --keep sum"));
    let sums = read_npy(&path.join("sums.npy"), &ReadLimits::default()).unwrap().values.to_f64();
    let before =
        read_gifti_fields(&path.join("lh.thickness.gii"), &ReadLimits::default()).unwrap()[0].to_f64();
    let (before, after): (f64, f64) = (before.iter().sum(), sums.iter().sum());
    assert!((before - after).abs() < 1e-12 * before && sums.len() == m);
    assert!((told["hemispheres"][0]["kept_before"].as_f64().unwrap() - before).abs() < 1e-9 * before);
    assert!((told["hemispheres"][0]["kept_after"].as_f64().unwrap() - after).abs() < 1e-9 * before);
    // A mask of the target.
    let mask: Vec<String> = (0..m).map(|k| u8::from(k % 3 != 0).to_string()).collect();
    fs::write(path.join("mask.csv"), format!("inside\n{}\n", mask.join("\n"))).unwrap();
    let told =
        json(path, &format!("resample lh.thickness.gii {pair} -o part.npy --keep sum --to-mask mask.csv"));
    assert_eq!(told["hemispheres"][0]["missing_vertices"].as_u64().unwrap(), m.div_ceil(3) as u64);
    let part = read_npy(&path.join("part.npy"), &ReadLimits::default()).unwrap().values.to_f64();
    let kept: f64 = part.iter().filter(|v| !v.is_nan()).sum();
    assert!((kept - before).abs() < 1e-12 * before && n > m);
}

#[test]
fn what_cannot_be_resampled_is_refused_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_spheres(path);
    let pair = "--from lh.sphere.reg --to lh.sphere";
    for (line, why) in [
        ("resample x --from sample:creature --to lh.sphere -o a.npy".to_owned(), "must lie on a sphere"),
        ("resample x --from lh.sphere.reg --to rh.sphere -o a.npy".to_owned(), "one hemisphere"),
        (format!("resample x {pair} --to rh.sphere -o a.npy"), "as often as --from"),
        (format!("resample x {pair} --to-areas lh.sphere --to-areas lh.sphere -o a.npy"), "as often as --from"),
        (format!("resample x {pair} -o a.png"), "written as .npy"),
        (format!("resample x {pair} -o a.npy --keep sum --zeros values"), "applies to --keep mean"),
        (format!("resample x {pair} -o a.npy --from-areas lh.sphere"), "with the areas"),
        (format!("resample missing.gii {pair} -o a.npy"), "missing.gii"),
        (
            format!("resample x y {pair} --from rh.sphere.reg --to rh.sphere -o a.npy"),
            "a file for each of the 2 hemispheres",
        ),
        (
            "resample x x --from lh.sphere.reg --from lh.sphere.reg --to lh.sphere --to lh.sphere -o a.dscalar.nii"
                .to_owned(),
            "each structure once",
        ),
    ] {
        assert!(refused(path, &line).contains(why), "{line}: {}", refused(path, &line));
        assert!(!path.join("a.npy").exists() && !path.join("a.dscalar.nii").exists());
    }
}
