//! Images and volumes: what is read equals what other programs read, and what is written keeps all that was not edited.

use adwave_io::{
    Field, FieldValues, Format, GridLayout, ReadLimits, ShapeFile, ValueType, WriteError, read_bytes,
    write_bytes,
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
    shape.add_vertex_field(Field::new("values", n_channels, values)).unwrap();
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
