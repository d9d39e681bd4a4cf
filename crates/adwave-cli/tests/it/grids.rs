//! Images and volumes in the subcommands: the numbers are those of the library, files keep what they had, and nothing
//! crosses a mask.

use crate::common::{adwave, json, refused, words};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::grid::Grid;
use adwave_io::{Field, FieldValues, GRID_VALUES, GridLayout, ReadLimits, ShapeFile, read_path, write_path};
use std::fs;
use std::path::Path;

const SIZES: [usize; 3] = [9, 12, 10];
const SPACINGS: [f64; 3] = [3.0, 2.0, 1.5];

fn volume(value: impl Fn(usize) -> f32) -> ShapeFile {
    let mut file = ShapeFile::from_grid(GridLayout::new(&SIZES, &SPACINGS)).unwrap();
    let values = (0..file.n_vertices()).map(value).collect();
    file.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::F32(values))).unwrap();
    file
}

fn rough(place: usize) -> f32 {
    (place * 7919 % 101) as f32 + 40.0 * (place as f32 / 90.0).sin()
}

fn values(path: &Path) -> Vec<f64> {
    read_path(path, &ReadLimits::default()).unwrap().field(GRID_VALUES).unwrap().to_f64()
}

fn run(folder: &Path, line: &str) {
    adwave(folder).args(words(line)).assert().success();
}

#[test]
fn a_filter_of_a_volume_is_heat_of_the_width_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&volume(rough), &at("v.nii.gz"), None).unwrap();
    run(folder.path(), "filter v.nii.gz -o s.nii.gz --fwhm 6 --preset suppress");
    let grid = Grid::new(&SIZES, &SPACINGS).unwrap();
    let heat = grid.heat();
    let decomposer = Decomposer::from_domain(grid, heat).unwrap();
    let sigma = 6.0 / (4.0 * std::f64::consts::LN_2).sqrt();
    let schedule = Schedule::lengths(&[sigma], decomposer.operator().step_length()).unwrap();
    let input = values(&at("v.nii.gz"));
    let expected = decomposer.decompose(&input, 1, &schedule).unwrap().coarsest().to_vec();
    let found = values(&at("s.nii.gz"));
    // The file has 32-bit floats.
    let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-5, "{off:e}");
    let sum = |v: &[f64]| v.iter().sum::<f64>();
    assert!((sum(&found) - sum(&input)).abs() < 1e-5 * sum(&input).abs());
}

/// Writes 130 volumes of 32³ voxels as 32-bit floats: enough values that the volumes are filtered one by one.
fn write_series(path: &Path, change: impl Fn(&mut [f32])) {
    let mut file = ShapeFile::from_grid(GridLayout::new(&[32; 3], &[2.0; 3])).unwrap();
    let mut values: Vec<f32> = (0..(32 * 32 * 32) * 130).map(|k| 300.0 + rough(k % 9973)).collect();
    change(&mut values);
    file.add_vertex_field(Field::new(GRID_VALUES, 130, FieldValues::F32(values))).unwrap();
    write_path(&file, path, None).unwrap();
}

#[test]
fn volumes_that_are_filtered_one_by_one_are_those_of_the_series_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let edit = "--fwhm 5,9 --gains 0,0.5";
    let filtered = |output: &str, more: &str| {
        let line = format!("filter series.nii -o {output} {edit} {more}");
        (json(folder.path(), &line), fs::read(at(output)).unwrap())
    };
    write_series(&at("series.nii"), |_| ());
    let (report, found) = filtered("one.nii", "");
    // A type of numbers is an option of the series in memory.
    let (expected_report, expected) = filtered("all.nii", "--value-type f32");
    assert_eq!(found[..352], expected[..352]);
    assert_eq!(found.len(), expected.len());
    let (values, expected) = (values(&at("one.nii")), values(&at("all.nii")));
    let off = values.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-4, "{off:e}"); // the last digit of a float near 400
    let change = |report: &serde_json::Value| report["changed"]["rms"].as_f64().unwrap();
    assert!((change(&report) / change(&expected_report) - 1.0).abs() < 1e-6);
    assert!(change(&report) > 1.0);
    // A NaN in one volume hides its place there alone, whichever way the volumes are read.
    write_series(&at("series.nii"), |values| values[77 * 130 + 5] = f32::NAN);
    let (_, found) = filtered("one.nii", "");
    let (_, expected) = filtered("all.nii", "--value-type f32");
    assert!(found == expected);
}

#[test]
fn a_series_that_does_not_fit_its_type_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("series.nii");
    let mut file = ShapeFile::from_grid(GridLayout::new(&[32; 3], &[2.0; 3])).unwrap();
    let values =
        (0..(32 * 32 * 32) * 130).map(|k: usize| if k.is_multiple_of(7) { 255 } else { 0 }).collect();
    file.add_vertex_field(Field::new(GRID_VALUES, 130, FieldValues::U8(values))).unwrap();
    write_path(&file, &path, None).unwrap();
    let line = "filter series.nii -o out.nii --fwhm 5 --gains 3 --quiet";
    let error = refused(folder.path(), line);
    assert!(error.contains("u8") && error.contains("channel"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let report = json(folder.path(), "filter series.nii -o out.nii --fwhm 5 --gains 0");
    assert!(report["changed"]["max"].as_f64().unwrap() > 100.0);
    assert_eq!(
        fs::metadata(folder.path().join("out.nii")).unwrap().len(),
        fs::metadata(&path).unwrap().len()
    );
}

#[test]
fn gains_of_one_give_the_file_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&volume(rough), &at("v.nii"), None).unwrap();
    run(folder.path(), "filter v.nii -o same.nii --gains 1,1,1");
    assert!(fs::read(at("v.nii")).unwrap() == fs::read(at("same.nii")).unwrap());
}

#[test]
fn values_that_the_type_of_the_file_cannot_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut file = ShapeFile::from_grid(GridLayout::new(&SIZES, &SPACINGS)).unwrap();
    let bytes = (0..1080).map(|k| 250 + (k * 7919 % 6) as u8).collect();
    file.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::U8(bytes))).unwrap();
    write_path(&file, &at("v.nii"), None).unwrap();
    let line = "filter v.nii -o s.nii --levels 3 --gains 40,1,1";
    let output = adwave(folder.path()).args(words(line)).assert().code(2).get_output().stderr.clone();
    let told = String::from_utf8(output).unwrap();
    assert!(told.contains("u8") && !at("s.nii").exists(), "{told}");
    run(folder.path(), &format!("{line} --value-type i16"));
    assert!(values(&at("s.nii")).iter().any(|v| *v > 255.0 && v.fract() == 0.0));
    run(folder.path(), "filter v.nii -o s.tif --levels 3 --preset smooth");
    let written = read_path(&at("s.tif"), &ReadLimits::default()).unwrap();
    assert!(matches!(written.field(GRID_VALUES).unwrap().values, FieldValues::U8(_)));
}

#[test]
fn nothing_crosses_a_mask_and_the_rest_keeps_its_values() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let side = |place: usize| place % SIZES[2] < 4;
    write_path(&volume(|p| if side(p) { 10.0 } else { rough(p) }), &at("v.nii"), None).unwrap();
    write_path(&volume(|p| f32::from(u8::from(side(p)))), &at("mask.nii"), None).unwrap();
    for (line, is_in) in [("--mask mask.nii", true), ("--mask mask.nii --invert-mask", false)] {
        run(folder.path(), &format!("filter v.nii -o s.nii --fwhm 8 --preset suppress {line}"));
        let (before, after) = (values(&at("v.nii")), values(&at("s.nii")));
        for place in 0..before.len() {
            let (was, is) = (before[place], after[place]);
            if side(place) != is_in {
                assert_eq!(was, is, "{line}: place {place} is outside and changed");
            } else if is_in {
                assert!((is - 10.0).abs() < 1e-5, "{line}: the constant of place {place} became {is}");
            }
        }
        assert!(before.iter().zip(&after).any(|(a, b)| a != b) != is_in, "{line}");
    }
    run(folder.path(), "saliency v.nii -o map.nii --levels 3 --mask mask.nii --invert-mask");
    let map = values(&at("map.nii"));
    assert!((0..map.len()).all(|place| map[place].is_nan() == side(place)));
    let mut other = ShapeFile::from_grid(GridLayout::new(&[9, 12, 9], &SPACINGS)).unwrap();
    other.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::F32(vec![1.0; 972]))).unwrap();
    write_path(&other, &at("other.nii"), None).unwrap();
    let error = refused(folder.path(), "filter v.nii -o s.nii --fwhm 8 --preset suppress --mask other.nii");
    assert!(error.contains("sizes are [9, 12, 10], got [9, 12, 9]"), "{error}");
}

#[test]
fn messages_speak_of_the_places_of_a_grid() {
    let folder = tempfile::tempdir().unwrap();
    write_path(&volume(|p| rough(p) - 1000.0), &folder.path().join("v.nii"), None).unwrap();
    for (line, told) in [
        ("denoise v.nii -o d.nii --noise-model rician", "and voxel 0 has"),
        ("denoise v.nii -o d.nii --noise-model poisson", "mask such voxels"),
        ("filter v.nii -o s.nii --preset smooth --only values=9e9..", "no voxel fulfills"),
        ("filter sample:hills -o s.tif --preset smooth --only values=9e9..", "no pixel fulfills"),
        ("filter v.nii -o s.nii --gains 1,1 --region ball:vertex=5000,radius=3", "names voxel 5000"),
    ] {
        let error = refused(folder.path(), &format!("{line} --quiet"));
        assert!(error.contains(told) && !error.contains("vertices"), "{line}: {error}");
    }
}

#[test]
fn bands_of_a_volume_sum_to_its_values() {
    let folder = tempfile::tempdir().unwrap();
    write_path(&volume(rough), &folder.path().join("v.nii"), None).unwrap();
    let report = json(folder.path(), "transform v.nii -o bands.npz --fwhm 4,8,16");
    assert_eq!((&report["levels"], &report["field"]), (&3.into(), &"values".into()));
    run(folder.path(), "saliency v.nii -o map.nii --levels 3");
    assert_eq!(values(&folder.path().join("map.nii")).len(), 1080);
}

#[test]
fn info_names_the_axes_and_operators_of_shapes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_path(&volume(rough), &folder.path().join("v.nii"), None).unwrap();
    let report = json(folder.path(), "info v.nii");
    assert_eq!((&report["kind"], &report["grid"]["sizes"][1]), (&"volume".into(), &12.into()));
    assert_eq!(report["grid"]["spacings"][2], 1.5);
    for line in [
        "filter v.nii -o s.nii --preset smooth --operator walk",
        "info v.nii --neighbors 9",
        "match v.nii v.nii -o m.csv",
        "simplify v.nii -o s.nii --ratio 0.5",
        "filter v.nii -o s.ply --preset smooth",
        "render v.nii -o v.png --relief",
        "render v.nii -o v.png --view top",
    ] {
        refused(folder.path(), line);
    }
}

#[test]
fn samples_are_drawn_flat_or_as_a_relief() {
    let folder = tempfile::tempdir().unwrap();
    for line in [
        "render sample:hills --vertices 4096 -o flat.png --size 300x300",
        "render sample:hills --vertices 4096 -o relief.png --relief 2 --view 20,50 --size 300x300",
        "render sample:head --vertices 8000 -o slices.png --size 600x300",
        "features sample:hills --vertices 4096 -o f.csv --theta 1",
        "render sample:hills --vertices 4096 -o found.png --features f.csv --size 300x300",
    ] {
        run(folder.path(), line);
    }
    let distinct = |name: &str| {
        let picture = image::open(folder.path().join(name)).unwrap().to_rgb8();
        picture.pixels().collect::<std::collections::HashSet<_>>().len()
    };
    for name in ["flat.png", "relief.png", "slices.png"] {
        assert!(distinct(name) > 100, "{name} has {} colors", distinct(name));
    }
}

#[test]
fn features_and_regions_are_in_the_coordinates_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut layout = GridLayout::new(&[40, 40], &[0.5, 0.5]);
    layout.origin = [100.0, 200.0, 0.0];
    let mut file = ShapeFile::from_grid(layout).unwrap();
    let bump = |place: usize| {
        let (y, x) = ((place / 40) as f32 * 0.5 - 12.0, (place % 40) as f32 * 0.5 - 6.0);
        (-(x * x + y * y) / 4.0).exp()
    };
    file.add_vertex_field(Field::new(GRID_VALUES, 1, FieldValues::F32((0..1600).map(bump).collect())))
        .unwrap();
    write_path(&file, &at("bump.nii"), None).unwrap();
    let found = json(folder.path(), "features bump.nii --lengths 1,2,4,8 --theta 1");
    let near = |feature: &&serde_json::Value| {
        let p = |k: usize| feature["position"][k].as_f64().unwrap();
        (p(0) - 106.0).hypot(p(1) - 212.0) < 0.6
    };
    assert!(found["features"].as_array().unwrap().iter().any(|f| near(&f)), "{found}");
    run(
        folder.path(),
        "filter bump.nii -o cut.nii --lengths 1,2 --gains 0,0 --region 'ball:point=106 212 0,radius=2'",
    );
    let (before, after) = (values(&at("bump.nii")), values(&at("cut.nii")));
    let changed: Vec<usize> = (0..1600).filter(|&p| before[p] != after[p]).collect();
    assert!(!changed.is_empty() && changed.len() < 80, "{} places", changed.len());
    assert!(changed.contains(&(24 * 40 + 12)));
}

#[test]
fn a_volume_of_vtk_keeps_its_arrays_and_speaks_of_voxels() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    write_path(&volume(rough), &at("v.nii.gz"), None).unwrap();
    let report = json(folder.path(), "convert v.nii.gz -o v.vti");
    assert_eq!((&report["voxels"], &report["vertices"]), (&1080.into(), &serde_json::Value::Null));
    let (nifti, vti) = (at("v.nii.gz"), at("v.vti"));
    let layouts =
        [&nifti, &vti].map(|path| read_path(path, &ReadLimits::default()).unwrap().grid().cloned().unwrap());
    assert_eq!((&layouts[0].steps, layouts[0].origin), (&layouts[1].steps, layouts[1].origin));
    assert!(values(&nifti) == values(&vti));
    // Two arrays, of which the second one is active, and one of the cells.
    let array = |kind: &str, name: &str, n: usize, slope: usize| {
        let numbers: Vec<String> = (0..n).map(|k| (slope * (k * 7919 % 50)).to_string()).collect();
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{}</DataArray>",
            numbers.join(" ")
        )
    };
    let text = format!(
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 5 2 6 0 3\" Origin=\"7 8 9\" Spacing=\"2 2 1.5\" \
         Direction=\"0 1 0 -1 0 0 0 0 1\"><Piece Extent=\"0 5 2 6 0 3\"><PointData Scalars=\"t\">{}{}</PointData>\
         <CellData>{}</CellData></Piece></ImageData></VTKFile>",
        array("Int32", "first", 120, 3),
        array("UInt8", "t", 120, 1),
        array("Float64", "c", 60, 2),
    );
    fs::write(at("w.vti"), text).unwrap();
    run(folder.path(), "filter w.vti -o s.vti --fwhm 4 --preset suppress");
    let written = fs::read_to_string(at("s.vti")).unwrap();
    for kept in
        ["Direction=\"0 1 0 -1 0 0 0 0 1\"", "Origin=\"7 8 9\"", "type=\"UInt8\" Name=\"t\"", "Name=\"c\""]
    {
        assert!(written.contains(kept), "{kept}");
    }
    let [before, after] =
        ["w.vti", "s.vti"].map(|name| read_path(&at(name), &ReadLimits::default()).unwrap());
    assert_eq!((before.grid(), before.field("first")), (after.grid(), after.field("first")));
    let range = |file: &ShapeFile| file.field(GRID_VALUES).unwrap().to_f64().into_iter().fold(0.0, f64::max);
    assert!(range(&before) == 49.0 && range(&after) < 49.0);
    // A further array, in a file of its own.
    run(folder.path(), "filter w.vti -o first.nii --signal first --gains 1,1");
    assert_eq!(values(&at("first.nii")), before.field("first").unwrap().to_f64());
    let saliency = json(folder.path(), "saliency w.vti -o map.vti --levels 2");
    assert!(saliency["largest_voxel"].is_u64() && saliency["voxels"] == 120, "{saliency}");
    assert_eq!(json(folder.path(), "info w.vti")["diffusion"]["voxels"], 120);
    fs::write(at("empty.vti"), "").unwrap();
    assert!(refused(folder.path(), "info empty.vti").contains("an image or a volume"));
}
