//! Images and volumes: what is read equals what other programs read, and what is written keeps all that was not edited.

use std::io::Read;
use std::path::{Path, PathBuf};

use adwave_test_data::{data_test, folder};
use flate2::read::MultiGzDecoder;

use adwave_io::{
    Field, FieldValues, Format, GridLayout, ReadLimits, ShapeFile, ValueType, WriteError, read_bytes,
    read_path, write_bytes,
};

const NIFTI: &[u8] = include_bytes!("../../src/formats/nifti/samples/a.nii");
const NIFTI_BIG: &[u8] = include_bytes!("../../src/formats/nifti/samples/b.nii");

fn read(bytes: &[u8], name: &str) -> Result<ShapeFile, String> {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).map_err(|e| e.to_string())
}

fn written(shape: &ShapeFile, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_bytes(shape, format, &mut bytes).unwrap();
    bytes
}

fn refusal(shape: &ShapeFile, format: Format) -> String {
    let error = write_bytes(shape, format, &mut Vec::new()).unwrap_err();
    let message = error.to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

/// The same grid with other values.
fn with_values(shape: &ShapeFile, values: FieldValues) -> ShapeFile {
    let mut shape = shape.clone();
    let n_channels = values.len() / shape.n_vertices();
    // A header that says that two channels are frames still does.
    let frame_step =
        shape.field("values").filter(|own| own.n_channels == n_channels).and_then(|own| own.frame_step);
    shape.add_vertex_field(Field { frame_step, ..Field::new("values", n_channels, values) }).unwrap();
    shape
}

fn values(shape: &ShapeFile) -> Vec<f64> {
    shape.field("values").unwrap().to_f64()
}

/// The values with the first one changed by `step`.
fn stepped(shape: &ShapeFile, step: f64) -> ShapeFile {
    let mut numbers = values(shape);
    numbers[0] += step;
    with_values(shape, FieldValues::F64(numbers))
}

#[test]
fn a_nifti_has_the_axes_of_its_affine_in_the_order_of_its_values() {
    // nibabel: shape (4, 3, 2), affine [-2 0 0 10; 0 2 0 -20; 0 0 2.5 5], values 7 i − 30 in C order.
    let shape = read(NIFTI, "a.nii").unwrap();
    let grid = shape.grid().unwrap();
    assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[2, 3, 4][..], &[2.5, 2.0, 2.0][..]));
    assert_eq!((grid.origin, grid.steps[2]), ([10.0, -20.0, 5.0], [-2.0, 0.0, 0.0]));
    assert_eq!(grid.unit.as_ref().unwrap().name(), "millimeter");
    assert_eq!(grid.position(1 + 4 * (2 + 3)), [8.0, -16.0, 7.5]);
    assert!(shape.notes().is_empty(), "{:?}", shape.notes());
    // Voxel (i, j, k) = (1, 2, 1) is number 6 i + 2 j + k of the array.
    assert_eq!(shape.field("values").unwrap().get(1 + 4 * (2 + 3), 0), 7.0 * 11.0 - 30.0);
    assert_eq!(grid.to_grid().unwrap().n_places(), 24);
}

#[test]
fn slope_and_intercept_give_physical_values_in_both_byte_orders() {
    // Big-endian bytes 0..24, slope 0.5, intercept −3, three points in time, qform without sform.
    let shape = read(NIFTI_BIG, "b.nii").unwrap();
    let field = shape.field("values").unwrap();
    assert_eq!((field.n_channels, field.len()), (3, 8));
    for place in 0..8 {
        for time in 0..3 {
            assert_eq!(field.get(place, time), 0.5 * (place + 8 * time) as f64 - 3.0);
        }
    }
    assert_eq!(shape.grid().unwrap().spacings, [2.0, 1.5, 1.0]);
    let edited = stepped(&shape, 1.2);
    let again = read(&written(&edited, Format::NIFTI), "b.nii").unwrap();
    assert_eq!(values(&again)[0], -2.0, "−1.8 is rounded to the next number, 2 · 0.5 − 3");
    assert_eq!(values(&again)[1..], values(&shape)[1..]);
    assert_eq!(written(&edited, Format::NIFTI)[..352], NIFTI_BIG[..352]);
}

#[test]
fn a_value_beyond_the_type_is_refused_with_what_to_do() {
    let shape = read(NIFTI_BIG, "b.nii").unwrap();
    let mut edited = stepped(&shape, 1000.0);
    let message = refusal(&edited, Format::NIFTI);
    assert!(
        message.contains("997 at place 0, channel 0") && message.contains("from -3 to 124.5"),
        "{message}"
    );
    let nan = refusal(&stepped(&shape, f64::NAN), Format::NIFTI);
    assert!(nan.contains("NaN at place 0"), "{nan}");
    edited.set_value_type(Some(ValueType::F32));
    let wide = read(&written(&edited, Format::NIFTI), "b.nii").unwrap();
    assert_eq!(values(&wide), values(&edited));
    assert_eq!(wide.grid(), shape.grid());
}

#[test]
fn other_numbers_of_channels_keep_the_header() {
    let shape = read(NIFTI, "a.nii").unwrap();
    let mut bands = with_values(&shape, FieldValues::F32((0..48).map(|i| i as f32 / 4.0).collect()));
    bands.set_value_type(Some(ValueType::F32));
    let again = read(&written(&bands, Format::NIFTI), "a.nii").unwrap();
    assert_eq!((again.field("values"), again.grid()), (bands.field("values"), shape.grid()));
    let new = ShapeFile::from_grid(GridLayout::new(&[1, 40_000], &[1.0, 2.0])).unwrap();
    let new = with_values(&new, FieldValues::U16((0..40_000).map(|i| i as u16).collect()));
    let again = read(&written(&new, Format::NIFTI), "long.nii").unwrap();
    assert_eq!(
        (again.field("values"), &again.grid().unwrap().sizes),
        (new.field("values"), &vec![1, 40_000])
    );
}

#[test]
fn claims_beyond_the_file_are_errors() {
    let mut huge = NIFTI.to_vec();
    for axis in 1..4 {
        huge[40 + 2 * axis..42 + 2 * axis].copy_from_slice(&30_000_i16.to_le_bytes());
    }
    let message = read(&huge, "a.nii").unwrap_err();
    assert!(message.contains("the file ends at byte 400"), "{message}");
    for end in 0..NIFTI.len() {
        assert!(read(&NIFTI[..end], "a.nii").is_err(), "{end}");
    }
}

#[test]
fn shapes_and_grids_do_not_mix() {
    let grid = read(NIFTI, "a.nii").unwrap();
    assert!(refusal(&grid, Format::OBJ).contains("obj cannot store the values of a grid"));
    assert!(refusal(&grid, Format::MTX).contains("mtx cannot store the values of a grid"));
    let cloud = ShapeFile::from_cloud(vec![[0.0; 3]]);
    assert!(matches!(
        write_bytes(&cloud, Format::NIFTI, &mut Vec::new()),
        Err(WriteError::CannotHold { format: Format::NIFTI, .. })
    ));
}

const PNG: &[u8] = include_bytes!("../../src/formats/picture/samples/a.png");
const PALETTE: &[u8] = include_bytes!("../../src/formats/picture/samples/b.png");
const GEO: &[u8] = include_bytes!("../../src/formats/tiff/samples/a.tif");
const STACK: &[u8] = include_bytes!("../../src/formats/tiff/samples/b.tif");
const TILES: &[u8] = include_bytes!("../../src/formats/tiff/samples/c.tif");

/// Samples of grids with the format that they are written in.
fn samples() -> impl Iterator<Item = (&'static str, &'static [u8], Format)> {
    let formats = Format::all().filter(|format| format.holds_grids());
    formats.flat_map(|format| format.samples().map(move |(name, bytes)| (name, bytes, format)))
}

#[test]
fn an_edited_value_changes_nothing_else() {
    for (name, bytes, format) in samples().filter(|(_, _, format)| format.can_write()) {
        let shape = read(bytes, name).unwrap();
        let first = values(&shape).iter().position(|x| !x.is_nan()).unwrap();
        let mut numbers = values(&shape);
        numbers[first] += if numbers[first] > 100.0 { -1.0 } else { 1.0 };
        let edited = with_values(&shape, FieldValues::F64(numbers.clone()));
        let again = read(&written(&edited, format), name).unwrap();
        assert_eq!(again.grid(), shape.grid(), "{name}");
        let found = values(&again);
        for (i, (a, b)) in found.iter().zip(&numbers).enumerate() {
            assert!(a == b || (a.is_nan() && b.is_nan()), "{format} {name}: {a} instead of {b} at {i}");
        }
        assert_eq!(again.coordinate_system(), shape.coordinate_system(), "{name}");
        // The same values, given anew, leave the file as it is.
        let same = with_values(&shape, FieldValues::F64(values(&shape)));
        assert!(written(&same, format) == bytes, "{format} {name}");
    }
}

#[test]
fn every_truncation_is_an_error_of_one_line() {
    for (name, bytes, format) in samples() {
        for end in 0..bytes.len() {
            match read(&bytes[..end], name) {
                Err(message) => assert!(!message.contains('\n'), "{message}"),
                // The last bytes of a PNG or a JPEG are marks behind the pixels, those of a text a part of a number.
                Ok(_) => assert!(
                    [Format::PNG, Format::JPEG, Format::ESRI_GRID].contains(&format)
                        && end + 12 >= bytes.len(),
                    "{format} {name} {end} of {}",
                    bytes.len()
                ),
            }
        }
    }
}

#[test]
fn any_changed_byte_is_a_grid_or_an_error() {
    for (name, bytes, _) in samples() {
        for at in 0..bytes.len().min(700) {
            for byte in [0, 1, 0x7f, 0xff, bytes[at] ^ 0x10] {
                let mut changed = bytes.to_vec();
                changed[at] = byte;
                if let Ok(shape) = read(&changed, name) {
                    let grid = shape.grid();
                    assert!(grid.is_none_or(|grid| grid.n_places() == shape.n_vertices()), "{name} {at}");
                }
            }
        }
    }
}

#[test]
fn a_png_keeps_its_texts_and_bits() {
    // Pillow: 3 rows of 4 numbers of 16 bits, 5000 apart.
    let shape = read(PNG, "a.png").unwrap();
    assert_eq!(shape.grid().unwrap().sizes, [3, 4]);
    assert_eq!(shape.field("values").unwrap().values, FieldValues::U16((0..12).map(|i| 5000 * i).collect()));
    let bytes = written(&stepped(&shape, 1.0), Format::PNG);
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("Comment\0kept") && text.contains("pHYs"));
    assert_eq!(bytes[..33], PNG[..33], "size and bits");
    assert!(refusal(&stepped(&shape, -1.0), Format::PNG).contains("does not fit the u16 numbers"));
    let palette = read(PALETTE, "b.png").unwrap();
    assert_eq!(palette.field("values").unwrap().values, {
        let colors = (0..12).flat_map(|i| (0..3).map(move |c| if i % 3 == c { 255 } else { 0 }));
        FieldValues::U8(colors.collect())
    });
    assert!(palette.notes()[0].contains("palette"));
    let mut fractions = ShapeFile::from_grid(GridLayout::new(&[1, 2], &[1.0, 1.0])).unwrap();
    fractions = with_values(&fractions, FieldValues::F64(vec![0.5, 1.0]));
    assert!(refusal(&fractions, Format::PNG).contains("TIFF"));
    let whole = with_values(&fractions, FieldValues::F64(vec![0.0, 256.0]));
    assert_eq!(values(&read(&written(&whole, Format::PNG), "a.png").unwrap()), [0.0, 256.0]);
}

#[test]
fn a_geotiff_has_its_place_on_the_map_and_keeps_it() {
    let shape = read(GEO, "a.tif").unwrap();
    let grid = shape.grid().unwrap();
    assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[4, 5][..], &[20.0, 30.0][..]));
    assert_eq!(grid.position(6), [1045.0, 1970.0, 0.0], "the second pixel of the second row");
    assert_eq!(shape.coordinate_system().unwrap().name, "EPSG:32633");
    // The first number is −7, which means no data.
    assert_eq!(grid.kept.as_ref().unwrap().iter().position(|kept| !kept), Some(0));
    assert!(values(&shape)[0].is_nan() && values(&shape)[19] == 50.0);
    let mut numbers = values(&shape);
    (numbers[0], numbers[1]) = (1.0, f64::NAN);
    let bytes = written(&with_values(&shape, FieldValues::F64(numbers)), Format::TIFF);
    let differing: Vec<usize> = (0..GEO.len()).filter(|&i| bytes[i] != GEO[i]).collect();
    assert!(bytes.len() == GEO.len() && differing.len() <= 4, "{differing:?}");
    assert!(values(&read(&bytes, "a.tif").unwrap())[1].is_nan());
    let mut wide = stepped(&shape, 0.25);
    wide.set_value_type(Some(ValueType::F32));
    let again = read(&written(&wide, Format::TIFF), "a.tif").unwrap();
    assert_eq!((again.grid(), again.coordinate_system()), (shape.grid(), shape.coordinate_system()));
    assert_eq!(again.field("values").unwrap().values.value_type(), ValueType::F32);
}

#[test]
fn stacks_tiles_and_predictors_are_read() {
    // tifffile: big-endian floats i / 4 in two pages of 3 × 4 pixels of 3 channels, Deflate with predictor 3.
    let stack = read(STACK, "b.tif").unwrap();
    assert_eq!(stack.grid().unwrap().sizes, [2, 3, 4]);
    assert_eq!(values(&stack), (0..72).map(|i| f64::from(i) / 4.0).collect::<Vec<_>>());
    // Tiles of 16 × 16 in an image of 20 × 18, LZW with predictor 2.
    let tiles = read(TILES, "c.tif").unwrap();
    assert_eq!(values(&tiles), (0..360).map(|i| f64::from(i % 251)).collect::<Vec<_>>());
    let mut bands = with_values(&tiles, FieldValues::F32((0..720).map(|i| i as f32).collect()));
    bands.set_value_type(Some(ValueType::F32));
    assert_eq!(values(&read(&written(&bands, Format::TIFF), "c.tif").unwrap()), values(&bands));
}

#[test]
fn a_grid_goes_to_another_format_with_what_that_stores() {
    let shape = read(GEO, "a.tif").unwrap();
    let mut bytes = Vec::new();
    let report = write_bytes(&shape, Format::NIFTI, &mut bytes).unwrap();
    let nifti = read(&bytes, "a.nii").unwrap();
    assert_eq!(nifti.grid().unwrap().steps, shape.grid().unwrap().steps);
    assert_eq!(nifti.grid().unwrap().kept, shape.grid().unwrap().kept);
    assert!(report.not_written.is_empty(), "{report:?}");
    for mut new in [nifti.clone(), shape.clone()] {
        new.forget_original();
        let again = read(&written(&new, Format::TIFF), "b.tif").unwrap();
        assert_eq!(again.grid().unwrap().steps, shape.grid().unwrap().steps);
        assert_eq!(again.grid().unwrap().kept, shape.grid().unwrap().kept);
    }
}

const ESRI: &[u8] = include_bytes!("../../src/formats/esri_grid/samples/a.asc");
const MAP: &[u8] = include_bytes!("../../src/formats/mrc/samples/a.mrc");
const ARRAY: &[u8] = include_bytes!("../../src/formats/npy/samples/a.npy");

#[test]
fn an_esri_grid_keeps_the_text_of_its_numbers() {
    let shape = read(ESRI, "a.asc").unwrap();
    let grid = shape.grid().unwrap();
    assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[3, 4][..], &[10.0, 10.0][..]));
    assert_eq!((grid.position(0), grid.position(11)), ([105.0, 225.0, 0.0], [135.0, 205.0, 0.0]));
    assert_eq!(grid.n_missing(), 1);
    let mut numbers = values(&shape);
    (numbers[0], numbers[2]) = (1.25, f64::NAN);
    let bytes = written(&with_values(&shape, FieldValues::F64(numbers)), Format::ESRI_GRID);
    let text = String::from_utf8(bytes).unwrap();
    assert!(text.ends_with("\n1.25 2.50 -9999 4\n-9999 6 7 8\n9 10 11 1.20e1\n"), "{text}");
    let mut new = shape.clone();
    new.forget_original();
    let again = read(&written(&new, Format::ESRI_GRID), "b.asc").unwrap();
    assert_eq!(again.grid(), shape.grid());
    assert_eq!(values(&again)[1..4], values(&shape)[1..4]);
    let tiff = read(&written(&shape, Format::TIFF), "a.tif").unwrap();
    assert_eq!((&tiff.grid().unwrap().steps, tiff.grid().unwrap().origin), (&grid.steps, grid.origin));
}

#[test]
fn an_esri_grid_is_written_to_its_usual_ending() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.asc.gz");
    let shape = read(ESRI, "a.asc").unwrap();
    adwave_io::write_path(&shape, &path, None).unwrap();
    let again = read_path(&path, &ReadLimits::default()).unwrap();
    assert_eq!((again.format(), again.grid()), (Some(Format::ESRI_GRID), shape.grid()));
    std::fs::write(folder.path().join("dem.prj"), "GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\"]]").unwrap();
    let degrees = read_path(&path, &ReadLimits::default()).unwrap();
    assert!(degrees.coordinate_system().unwrap().is_geographic());
}

#[test]
fn faults_of_esri_grids_are_told() {
    for (old, new, expected) in [
        ("ncols 4", "ncols 4000000000", "`ncols` is 4000000000"),
        ("ncols 4", "ncols 5", "12 numbers instead of 15"),
        ("ncols 4", "ncols 4.5", "`ncols` is 4.5"),
        ("cellsize 10", "cellsize 0", "`cellsize` must be above 0"),
        ("cellsize 10\n", "", "`cellsize` is missing"),
        ("9 10", "9 ten", "line 9: expected a number"),
        ("nrows 3", "nrows x", "`nrows` needs a number"),
    ] {
        let text = String::from_utf8_lossy(ESRI).replace(old, new);
        let message = read(text.as_bytes(), "a.asc").unwrap_err();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_map_has_spacings_of_its_cell_in_angstrom() {
    // mrcfile: 2 sections of 3 rows of 4 columns, voxels of 1.5 × 2 × 2.5, origin x 7, first section −1.
    let shape = read(MAP, "a.mrc").unwrap();
    let grid = shape.grid().unwrap();
    assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[2, 3, 4][..], &[2.5, 2.0, 1.5][..]));
    assert_eq!((grid.origin, grid.unit.as_ref().unwrap().meters()), ([7.0, 0.0, -2.5], Some(1e-10)));
    assert_eq!(values(&shape), (0..24).map(f64::from).collect::<Vec<_>>());
    let bytes = written(&stepped(&shape, 100.0), Format::MRC);
    assert_eq!(f32::from_le_bytes(bytes[80..84].try_into().unwrap()), 100.0, "the greatest density");
    assert!(refusal(&stepped(&shape, 1e5), Format::MRC).contains("i16"));
    let mut new = with_values(&shape, FieldValues::F64(vec![0.5; 24]));
    new.forget_original();
    let again = read(&written(&new, Format::MRC), "b.mrc").unwrap();
    assert_eq!((&again.grid().unwrap().spacings, values(&again)), (&grid.spacings, vec![0.5; 24]));
}

#[test]
fn arrays_are_grids_unless_they_are_tables_of_points() {
    let shape = read(ARRAY, "a.npy").unwrap();
    assert_eq!(shape.grid().unwrap().sizes, [5, 6]);
    assert_eq!(values(&shape), (0..30).map(|i| f64::from(i) / 4.0).collect::<Vec<_>>());
    let array = |shape: &str, n: usize| {
        let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let length = (header.len() as u16).to_le_bytes();
        let body: Vec<u8> = (0..n).map(|i| i as u8).collect();
        [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &body].concat()
    };
    for (sizes, n, places, n_channels) in [
        ("5, 5, 3", 75, &[5, 5][..], 3),
        ("3, 5, 5", 75, &[3, 5, 5][..], 1),
        ("2, 2, 2, 2", 16, &[2, 2, 2][..], 2),
    ] {
        let shape = read(&array(sizes, n), "a.npy").unwrap();
        assert_eq!(
            (&shape.grid().unwrap().sizes[..], shape.field("values").unwrap().n_channels),
            (places, n_channels)
        );
    }
    for (sizes, n) in [("12,", 12), ("4, 3", 12), ("0, 5", 0), ("2, 2, 2, 2, 2", 32)] {
        let message = read(&array(sizes, n), "a.npy").unwrap_err();
        assert!(message.contains("a NumPy array of the shape"), "{message}");
    }
    let mut bytes = array("4, 5", 20);
    let at = bytes.windows(5).position(|word| word == b"False").unwrap();
    bytes[at..at + 5].copy_from_slice(b"True ");
    let shape = read(&bytes, "a.npy").unwrap();
    assert_eq!(shape.field("values").unwrap().get(1, 0), 4.0, "the first index runs fastest");
    assert_eq!(values(&read(&written(&stepped(&shape, 1.0), Format::NPY), "a.npy").unwrap())[0], 1.0);
}

#[test]
fn an_archive_is_the_one_array_that_is_a_grid() {
    let bytes = include_bytes!("../../src/formats/npy/samples/a.npz");
    let shape = read(bytes, "a.npz").unwrap();
    assert_eq!(shape.grid().unwrap().sizes, [4, 5]);
    assert!(shape.notes()[0].contains("\"elevation\""), "{:?}", shape.notes());
    assert!(refusal(&shape, Format::NPZ).contains("read-only"));
}

/// Files below a folder.
fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files_below(&path, files) } else { files.push(path) }
    }
}

#[data_test]
fn real_images_terrains_and_volumes_come_back_byte_for_byte() {
    let mut files = Vec::new();
    for kind in ["images", "dem", "volumes"] {
        files_below(&Path::new(folder!()).join("domains").join(kind), &mut files);
    }
    files.sort();
    let mut n_grids = 0;
    for path in files {
        let name = path.display();
        if path.extension().is_some_and(|ending| ending == "raw") {
            continue;
        }
        let shape = read_path(&path, &ReadLimits::default()).unwrap();
        let grid = shape.grid().unwrap_or_else(|| panic!("{name} is no grid"));
        assert!(grid.to_grid().is_ok() && grid.n_places() == shape.n_vertices(), "{name}");
        n_grids += 1;
        let format = shape.format().unwrap();
        if !format.can_write() {
            continue;
        }
        let bytes = std::fs::read(&path).unwrap();
        let mut plain = Vec::new();
        if MultiGzDecoder::new(&bytes[..]).read_to_end(&mut plain).is_err() {
            plain = bytes;
        }
        assert!(written(&shape, format) == plain, "{name}");
        let field = shape.field("values").unwrap();
        let same = with_values(&shape, FieldValues::F64(field.to_f64()));
        assert!(written(&same, format) == plain, "{name}: the same values given anew");
    }
    assert!(n_grids >= 30, "{n_grids}");
}

#[test]
fn a_nrrd_keeps_its_header_and_its_encoding() {
    let bytes = include_bytes!("../../src/formats/nrrd/samples/a.nrrd");
    let shape = read(bytes, "a.nrrd").unwrap();
    let grid = shape.grid().unwrap();
    assert_eq!((&grid.sizes[..], &grid.spacings[..]), (&[2, 3, 4][..], &[2.5, 2.0, 2.0][..]));
    assert_eq!((grid.origin, grid.steps[2]), ([10.0, -20.0, 5.0], [-2.0, 0.0, 0.0]));
    assert_eq!(
        (values(&shape), grid.unit.as_ref().unwrap().name()),
        ((0..24).map(f64::from).collect(), "millimeter")
    );
    let mut edited = stepped(&shape, 0.5);
    edited.set_value_type(Some(ValueType::F64));
    let wide = written(&edited, Format::NRRD);
    assert!(String::from_utf8_lossy(&wide).contains("# kept\ntype: double\n"));
    assert_eq!(values(&read(&wide, "a.nrrd").unwrap()), values(&edited));
    // Two components at each place, as gzip.
    let vectors = read(include_bytes!("../../src/formats/nrrd/samples/b.nrrd"), "b.nrrd").unwrap();
    let (grid, field) = (vectors.grid().unwrap(), vectors.field("values").unwrap());
    assert_eq!((&grid.sizes[..], &grid.spacings[..], field.n_channels), (&[4, 3][..], &[0.25, 0.5][..], 2));
    assert_eq!((field.get(0, 1), field.get(1, 0)), (0.25, 0.5));
    let mut new = shape.clone();
    new.forget_original();
    assert_eq!(read(&written(&new, Format::NRRD), "c.nrrd").unwrap().grid(), shape.grid());
}

#[test]
fn a_detached_nrrd_is_read_from_its_own_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let head = "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 2\nencoding: raw\ndata file: ";
    std::fs::write(folder.path().join("a.raw"), [1, 2, 3, 4]).unwrap();
    let path = folder.path().join("a.nhdr");
    std::fs::write(&path, format!("{head}a.raw\n")).unwrap();
    let shape = read_path(&path, &ReadLimits::default()).unwrap();
    assert_eq!(values(&shape), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(
        values(&read(&written(&stepped(&shape, 1.0), Format::NRRD), "a.nhdr").unwrap()),
        [2.0, 2.0, 3.0, 4.0]
    );
    for name in ["../a.raw", "/etc/hostname", "a%d.raw 1 2 1"] {
        std::fs::write(&path, format!("{head}{name}\n")).unwrap();
        let message = read_path(&path, &ReadLimits::default()).unwrap_err().to_string();
        assert!(message.contains("folder of the header only"), "{message}");
    }
}
