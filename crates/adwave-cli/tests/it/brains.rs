//! CIFTI files as a whole: surfaces and voxels of one file, one file in and one out.

use crate::common::{adwave, json, refused, words};
use adwave_io::{Field, Format, ReadLimits, read_npy, read_path};
use std::fs;
use std::path::Path;

/// A CIFTI of two surfaces of 4 vertices and 4 voxels, and the surfaces.
fn write_inputs(folder: &Path) {
    let bytes = Format::CIFTI.samples().next().unwrap().1;
    fs::write(folder.join("a.dscalar.nii"), bytes).unwrap();
    let square = |width: f64| format!("v 0 0 0\nv {width} 0 0\nv {width} 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
    fs::write(folder.join("lh.white.obj"), square(1.0)).unwrap();
    fs::write(folder.join("right.obj"), square(2.0)).unwrap();
}

const BOTH: &str = "--surface lh.white.obj --surface CORTEX_RIGHT=right.obj";

fn values(path: &Path) -> Vec<f64> {
    read_path(path, &ReadLimits::default()).unwrap().field("values").map(Field::to_f64).unwrap()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn each_part_is_filtered_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    let edit = "--fwhm 1.5 --preset suppress";
    let report = json(path, &format!("filter a.dscalar.nii -o b.dscalar.nii {BOTH} {edit}"));
    assert_eq!(report["places"], 11);
    let (before, after) = (values(&path.join("a.dscalar.nii")), values(&path.join("b.dscalar.nii")));
    // One surface after the other gives the same.
    json(
        path,
        &format!("filter lh.white.obj -o one.dscalar.nii --signal a.dscalar.nii {edit} --local-fit constant"),
    );
    fs::rename(path.join("right.obj"), path.join("rh.obj")).unwrap();
    json(
        path,
        &format!("filter rh.obj -o two.dscalar.nii --signal one.dscalar.nii {edit} --local-fit constant"),
    );
    let in_turn = values(&path.join("two.dscalar.nii"));
    assert!(largest_difference(&after[..14], &in_turn[..14]) < 1e-6);
    assert_eq!(in_turn[14..], before[14..]);
    // Voxels of one structure keep their sum, and the only voxel of another its value.
    let sum = |values: &[f64], c: usize| (7..10).map(|row| values[2 * row + c]).sum::<f64>();
    for c in 0..2 {
        assert!((sum(&before, c) - sum(&after, c)).abs() < 1e-5);
        assert_eq!(before[20 + c], after[20 + c]);
    }
    assert!(largest_difference(&before[14..20], &after[14..20]) > 0.01);
    let line = "info a.dscalar.nii --surface lh.white.obj --surface CORTEX_RIGHT=rh.obj";
    let output = adwave(path).args(words(line)).assert().success().get_output().clone();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("CORTEX_LEFT, 3 of 4 vertices") && said.contains("THALAMUS_LEFT, 3 voxels"),
        "{said}"
    );
}

#[test]
fn bands_of_all_parts_sum_to_the_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    json(path, &format!("transform a.dscalar.nii -o b.npz {BOTH} --fwhm 1,3"));
    json(path, &format!("filter a.dscalar.nii -o all.npy {BOTH} --fwhm 1,3 --gains 1,1"));
    let same = read_npy(&path.join("all.npy"), &ReadLimits::default()).unwrap();
    assert_eq!(same.shape, [11, 2]);
    assert!(largest_difference(&same.values.to_f64(), &values(&path.join("a.dscalar.nii"))) < 1e-14);
    json(path, &format!("denoise a.dscalar.nii -o c.dscalar.nii {BOTH}"));
    assert!(values(&path.join("c.dscalar.nii")).iter().all(|v| v.is_finite()));
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_inputs(path);
    fs::write(
        path.join("rh.five.obj"),
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 2 0\nf 1 2 3\nf 1 3 4\nf 3 4 5\n",
    )
    .unwrap();
    let tail = "--fwhm 1 --preset suppress";
    for (surfaces, output, expected) in [
        (
            "--surface lh.white.obj",
            "b.dscalar.nii",
            "values of CORTEX_RIGHT, whose surface is not given; add --surface",
        ),
        (
            "--surface right.obj",
            "b.dscalar.nii",
            "does not say which part of a.dscalar.nii it is the surface of",
        ),
        (
            "--surface lh.white.obj --surface rh.five.obj",
            "b.dscalar.nii",
            "CORTEX_RIGHT of a.dscalar.nii has 4 vertices, and the surface has 5",
        ),
        ("--surface lh.white.obj --surface CORTEX_LEFT=right.obj", "b.dscalar.nii", "are both CORTEX_LEFT"),
        (BOTH, "b.dtseries.nii", "go into a CIFTI of the same kind, .npy or .csv"),
        (BOTH, "b.ply", "go into a CIFTI of the same kind"),
    ] {
        let error = refused(path, &format!("filter a.dscalar.nii -o {output} {surfaces} {tail}"));
        assert!(error.contains(expected), "{error}");
        assert!(!path.join(output).exists());
    }
    let error = refused(path, "render a.dscalar.nii -o a.png");
    assert!(error.contains("give one surface as the shape and the CIFTI as --signal"), "{error}");
    let error = refused(path, &format!("filter lh.white.obj -o b.ply --surface right.obj {tail}"));
    assert!(error.contains("--surface applies to a CIFTI"), "{error}");
    let error =
        refused(path, &format!("filter a.dscalar.nii -o b.dscalar.nii {BOTH} {tail} --only values=1.."));
    assert!(error.contains("--only applies to the vertices of one shape"), "{error}");
}
