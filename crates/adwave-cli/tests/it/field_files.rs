//! Results that go into files of values alone, and signals by the same names in every command.

use crate::common;

use adwave_io::{Field, ReadLimits, read_csv_fields, read_gifti_fields, read_npy, read_path};
use common::{adwave, json, refused};
use std::fs;
use std::path::Path;

fn array(path: &Path) -> Field {
    read_npy(path, &ReadLimits::default()).unwrap().into_field("array")
}

fn columns(path: &Path) -> Vec<Field> {
    let limits = ReadLimits::default();
    if path.extension().unwrap() == "gii" {
        read_gifti_fields(path, &limits).unwrap()
    } else {
        read_csv_fields(path, &limits).unwrap()
    }
}

fn names(fields: &[Field]) -> Vec<&str> {
    fields.iter().map(|f| f.name.as_str()).collect()
}

/// A torus with a signal of its own in a file beside it.
fn torus(path: &Path) -> usize {
    json(path, "sample torus --vertices 600 -o torus.ply");
    let n = read_path(&path.join("torus.ply"), &ReadLimits::default()).unwrap().n_vertices();
    let heat = (0..n).fold(String::new(), |text, i| text + &format!("{}\n", (i * i) % 17));
    fs::write(path.join("thickness.csv"), format!("thickness\n{heat}")).unwrap();
    n
}

#[test]
fn a_filtered_field_is_the_same_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let n = torus(path);
    for command in ["filter --preset suppress", "denoise"] {
        let (verb, more) = command.split_once(' ').unwrap_or((command, ""));
        let run = |out: &str| json(path, &format!("{verb} torus.ply {more} --field thickness.csv -o {out}"));
        for out in ["out.npy", "out.csv", "out.gii", "out.ply"] {
            run(out);
        }
        let exact = array(&path.join("out.npy"));
        assert_eq!((exact.n_channels, exact.len()), (1, n));
        let shape = read_path(&path.join("out.ply"), &ReadLimits::default()).unwrap();
        assert_eq!(shape.field("thickness").unwrap().to_f64(), exact.to_f64(), "{verb}");
        let table = columns(&path.join("out.csv"));
        assert_eq!((names(&table), table[0].to_f64()), (vec!["thickness"], exact.to_f64()));
        let gifti = columns(&path.join("out.gii"));
        let single: Vec<f64> = exact.to_f64().iter().map(|x| f64::from(*x as f32)).collect();
        assert_eq!((names(&gifti), gifti[0].to_f64()), (vec!["thickness"], single));
    }
}

#[test]
fn positions_go_into_shapes_or_an_array() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let n = torus(path);
    for out in ["out.npy", "out.gii", "out.csv", "out.ply"] {
        json(path, &format!("filter torus.ply -o {out} --preset suppress --levels 3"));
    }
    let limits = ReadLimits::default();
    let (array, ply) = (array(&path.join("out.npy")), read_path(&path.join("out.ply"), &limits).unwrap());
    assert_eq!((array.n_channels, array.len()), (3, n));
    assert_eq!(array.to_f64(), ply.points().as_flattened());
    let gifti = read_path(&path.join("out.gii"), &limits).unwrap();
    assert_eq!(gifti.faces().len(), ply.faces().len());
    assert_eq!(gifti.points()[7], ply.points()[7].map(|c| f64::from(c as f32)));
    assert_eq!(read_path(&path.join("out.csv"), &limits).unwrap().points(), ply.points());
}

#[test]
fn a_field_of_a_table_of_points_goes_back_into_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let row = |k: u32| format!("{},{},0,{}\n", k % 12, k / 12, k % 5);
    fs::write(path.join("scan.csv"), format!("x,y,z,heat\n{}", (0..144).map(row).collect::<String>()))
        .unwrap();
    json(path, "filter scan.csv --field heat --preset suppress -o even.csv");
    assert_eq!(names(&columns(&path.join("even.csv"))), ["x", "y", "z", "heat"]);
    json(path, "filter scan.csv --field heat --preset suppress -o even.npy");
    assert_eq!(array(&path.join("even.npy")).n_channels, 1);
}

#[test]
fn maps_and_bands_have_names_in_tables_and_giftis() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let n = torus(path);
    for out in ["map.npy", "map.csv", "map.gii"] {
        json(path, &format!("saliency torus.ply -o {out} --levels 4 --per-level"));
    }
    let exact = array(&path.join("map.npy"));
    let table = columns(&path.join("map.csv"));
    assert_eq!(names(&table), ["saliency", "saliency1", "saliency2", "saliency3", "saliency4"]);
    assert_eq!((exact.n_channels, exact.get(3, 2)), (5, table[2].get(3, 0)));
    assert_eq!(names(&columns(&path.join("map.gii"))), names(&table));

    json(path, "transform torus.ply -o bands.gii --field thickness.csv --levels 3");
    let bands = columns(&path.join("bands.gii"));
    assert_eq!(names(&bands), ["W1", "W2", "W3", "S3"]);
    let thickness = columns(&path.join("thickness.csv"))[0].to_f64();
    assert_eq!(thickness.len(), n);
    for (i, own) in thickness.iter().enumerate() {
        let sum: f64 = bands.iter().map(|band| band.get(i, 0)).sum();
        // Four numbers of up to 17 in 32 bits.
        assert!((sum - own).abs() < 1e-5, "{sum} {own}");
    }
    json(path, "transform torus.ply -o bands.csv --field thickness.csv --levels 3");
    json(path, "transform torus.ply -o bands.npy --field thickness.csv --levels 3");
    let (table, exact) = (columns(&path.join("bands.csv")), array(&path.join("bands.npy")));
    assert_eq!(names(&table), names(&bands));
    assert_eq!((exact.n_channels, exact.to_f64().len()), (n, 4 * n), "one row for each band");
    for (i, own) in thickness.iter().enumerate() {
        let sum: f64 = (0..4).map(|band| exact.get(band, i)).sum();
        assert!((sum - own).abs() < 1e-12 && exact.get(1, i) == table[1].get(i, 0), "{sum} {own}");
    }
    for (line, words) in [
        ("transform torus.ply -o bands.lh.annot", "holds labels, and bands are numbers"),
        ("transform torus.ply -o bands.dlabel.nii", "holds labels, and bands are numbers"),
        ("filter torus.ply -o out.ply --fwhm 5%", "--fwhm chooses the bands and changes none; add --gains"),
        ("filter torus.ply -o out.ply --lengths 5%", "--lengths chooses the bands"),
        ("filter torus.ply -o out.ply", "nothing to change; give --preset"),
    ] {
        let error = refused(path, line);
        assert!(error.contains(words), "{line}: {error}");
    }
    json(path, "transform torus.ply -o coords.gii --levels 2");
    assert_eq!(names(&columns(&path.join("coords.gii")))[..4], ["W1_x", "W1_y", "W1_z", "W2_x"]);
}

#[test]
fn signals_have_the_same_names_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    torus(path);
    for field in ["mean-curvature", "normals"] {
        json(path, &format!("filter torus.ply -o out.ply --preset suppress --field {field}"));
        assert!(read_path(&path.join("out.ply"), &ReadLimits::default()).unwrap().field(field).is_some());
        json(path, &format!("denoise torus.ply -o out.npy --field {field}"));
    }
    let error = |line: &str| refused(path, &format!("{line} torus.ply -o out.ply --field heat"));
    for command in ["filter --preset suppress", "denoise", "saliency", "transform"] {
        let said = error(command);
        assert!(said.contains("mean-curvature") && said.contains("shape-index"), "{command}: {said}");
    }
    let help = |command: &str| {
        let run = adwave(path).args([command, "--help"]).assert().success();
        let text = String::from_utf8(run.get_output().stdout.clone()).unwrap();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    for command in
        ["filter", "denoise", "saliency", "transform", "features", "evaluate", "compare", "report", "render"]
    {
        assert!(
            help(command).contains("coords, x, y, z (such as heights), normals, mean-curvature"),
            "{command}"
        );
    }
}

/// A square of 8 × 8 quads in a PLY with a pressure for each face.
fn plate_with_pressures(path: &Path) -> Vec<f64> {
    let n = 8;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nproperty double pressure\nend_header\n",
        (n + 1) * (n + 1),
        n * n
    );
    for v in 0..(n + 1) * (n + 1) {
        text += &format!("{} {} 0\n", v % (n + 1), v / (n + 1));
    }
    let pressures: Vec<f64> = (0..n * n).map(|f| f64::from((f * f) % 7)).collect();
    for (f, pressure) in (0..n * n).zip(&pressures) {
        let a = f / n * (n + 1) + f % n;
        text += &format!("4 {a} {} {} {} {pressure}\n", a + 1, a + n + 2, a + n + 1);
    }
    fs::write(path.join("plate.ply"), text).unwrap();
    pressures
}

#[test]
fn fields_of_faces_are_filtered_over_faces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let before = plate_with_pressures(path);
    for verb in ["filter --gains 0,0 --local-fit constant", "denoise"] {
        let (command, more) = verb.split_once(' ').unwrap_or((verb, ""));
        let run = |out: &str| json(path, &format!("{command} plate.ply --field pressure {more} -o {out}"));
        let report = run("out.ply");
        assert_eq!((report["faces"].as_u64(), report["vertices"].as_u64()), (Some(64), None), "{report}");
        run("out.npy");
        let exact = array(&path.join("out.npy")).to_f64();
        let shape = read_path(&path.join("out.ply"), &ReadLimits::default()).unwrap();
        assert_eq!(shape.faces().len(), 64);
        let field = shape.face_fields().iter().find(|field| field.name == "pressure").unwrap();
        assert_eq!(field.to_f64(), exact);
        // All faces have the same area, so that the sum stays, and smoothing brings the values together.
        let sum = |values: &[f64]| values.iter().sum::<f64>();
        let kept = if command == "denoise" { 0.02 } else { 1e-9 };
        assert!((sum(&before) - sum(&exact)).abs() < kept * sum(&before), "{verb}");
        let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        assert!(command == "denoise" || square(&exact) < 0.9 * square(&before));
    }
    let error = refused(path, "filter plate.ply --field pressure --preset smooth -o out.obj");
    assert!(error.contains("fields of faces are written as") && error.contains(".vtu"), "{error}");
    assert!(!path.join("out.obj").exists());
}
