//! Maps of the sky in FITS.

use adwave_io::{Field, FieldValues, Format, ReadLimits, ShapeFile, Subset, read_bytes, write_bytes};

const UNSEEN: f32 = -1.6375e30;

fn sample(name: &str) -> Vec<u8> {
    Format::FITS.samples().find(|(own, _)| *own == name).unwrap().1.to_vec()
}

fn read(bytes: Vec<u8>) -> Result<ShapeFile, String> {
    read_bytes(bytes, Some("a.fits"), &ReadLimits::default()).map_err(|e| e.to_string())
}

fn write(shape: &ShapeFile) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_bytes(shape, Format::FITS, &mut bytes).unwrap();
    bytes
}

/// A file with another value of a card.
fn with_card(mut bytes: Vec<u8>, keyword: &str, value: &str) -> Vec<u8> {
    let begin = format!("{keyword:<8}= ");
    // The last one is that of the table.
    let at = bytes.chunks_exact(80).rposition(|card| card.starts_with(begin.as_bytes())).unwrap() * 80;
    let card = if value.starts_with('\'') {
        format!("{begin}{value:<70}")
    } else {
        format!("{begin}{value:>20}{:50}", "")
    };
    bytes[at..at + 80].copy_from_slice(card.as_bytes());
    bytes
}

#[test]
fn a_map_is_a_closed_sphere_with_its_columns_as_fields() {
    let map = read(sample("a.fits")).unwrap();
    assert_eq!((map.n_vertices(), map.faces().len(), map.is_map()), (12, 14, true));
    assert_eq!(map.field_names(), ["TEMPERATURE", "N_OBS"]);
    let temperature = map.field("TEMPERATURE").unwrap();
    assert!(matches!(temperature.values, FieldValues::F32(_)));
    for pixel in 0..12 {
        let value = temperature.get(pixel, 0);
        assert!(if pixel == 5 { value.is_nan() } else { value == pixel as f64 });
        assert_eq!(map.field("N_OBS").unwrap().get(pixel, 0), pixel as f64);
    }
    // Pixel 4 of NSIDE 1 in ring order is the first on the equator.
    assert_eq!(map.points()[4], [1.0, 0.0, 0.0]);
    assert!(map.notes().iter().any(|note| note.contains("ring order, galactic") && note.contains("K_CMB")));
}

#[test]
fn a_part_has_the_places_of_its_pixels() {
    let part = read(sample("part.fits")).unwrap();
    assert_eq!((part.n_vertices(), part.field_names()), (7, vec!["SIGNAL"]));
    // healpy 1.20.1: pix2vec(2, [3, 9, 1, 0, 7, 12, 47], nest=True).
    let (a, b, c, z) =
        (0.282_597_082_630_22, 0.285_235_389_543_762, 0.688_619_145_905_321, 0.916_666_666_666_667);
    let (third, two_thirds) = (1.0 / 3.0, 2.0 / 3.0);
    let expected = [
        [a, a, z],
        [-b, -c, two_thirds],
        [b, c, two_thirds],
        [two_thirds, two_thirds, third],
        [-a, a, z],
        [two_thirds, -two_thirds, third],
        [two_thirds, -two_thirds, -third],
    ];
    for (found, expected) in part.points().iter().zip(&expected) {
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-14), "{found:?} {expected:?}");
    }
    for (k, pixel) in [3, 9, 1, 0, 7, 12, 47].into_iter().enumerate() {
        assert_eq!(part.field("SIGNAL").unwrap().get(k, 0), f64::from(pixel) / 2.0);
    }
}

#[test]
fn edited_values_go_back_into_the_file_and_nothing_else_changes() {
    let bytes = sample("a.fits");
    let mut map = read(bytes.clone()).unwrap();
    let mut values = map.field("TEMPERATURE").unwrap().to_f64();
    values[2] = 0.25;
    values[7] = f64::NAN;
    let field = map.field("TEMPERATURE").unwrap().with_values_rounded(&values);
    map.add_vertex_field(field).unwrap();
    let written = write(&map);
    let changed: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k] != written[k]).collect();
    assert_eq!(written.len(), bytes.len());
    // Rows of 8 bytes behind two headers of one block each.
    assert!(changed.iter().all(|k| [2, 7].contains(&((k - 5760) / 8)) && (k - 5760) % 8 < 4));
    assert_eq!(written[5760 + 7 * 8..][..4], UNSEEN.to_be_bytes());
    assert_eq!(read(written).unwrap().field("TEMPERATURE").unwrap().get(2, 0), 0.25);
}

#[test]
fn new_fields_are_columns_behind_the_old_header() {
    let mut map = read(sample("a.fits")).unwrap();
    map.add_vertex_field(Field::new("saliency", 1, FieldValues::F64((0..12).map(f64::from).collect())))
        .unwrap();
    map.add_vertex_field(Field::new("flow", 3, FieldValues::F32((0..36).map(|k| k as f32).collect())))
        .unwrap();
    let written = write(&map);
    let text = String::from_utf8_lossy(&written).into_owned();
    assert!(text.contains("COORDSYS= 'G") && text.contains("TUNIT1  = 'K_CMB"));
    assert_eq!(written.len() % 2880, 0);
    let again = read(written).unwrap();
    assert_eq!(again.field_names(), ["TEMPERATURE", "N_OBS", "saliency", "flow_x", "flow_y", "flow_z"]);
    assert_eq!(again.field("flow_z").unwrap().get(11, 0), 35.0);
    assert_eq!(again.points(), map.points());
    assert!(again.field("TEMPERATURE").unwrap().get(5, 0).is_nan());
}

#[test]
fn some_pixels_of_a_map_are_written_with_their_numbers() {
    let map = read(sample("a.fits")).unwrap();
    let part = map.subset(&Subset { vertices: &[1, 4, 5, 9], ..Subset::default() }).unwrap();
    let again = read(write(&part)).unwrap();
    assert_eq!(again.points(), part.points());
    assert_eq!(again.field("N_OBS").unwrap().to_f64(), [1.0, 4.0, 5.0, 9.0]);
}

#[test]
fn moved_points_and_other_shapes_are_no_map() {
    let mut map = read(sample("a.fits")).unwrap();
    let points = map.points().to_vec();
    map.set_points(points.clone()).unwrap();
    assert_eq!(write(&map), sample("a.fits"));
    map.set_points(points.iter().map(|p| p.map(|c| 1.1 * c)).collect()).unwrap();
    for shape in [&map, &ShapeFile::from_cloud(points)] {
        let error = write_bytes(shape, Format::FITS, &mut Vec::new()).unwrap_err().to_string();
        assert!(error.contains("fits cannot store") && !error.contains('\n'), "{error}");
    }
}

#[test]
fn wrong_headers_are_errors_of_one_line() {
    for (name, keyword, value, message) in [
        ("a.fits", "NSIDE", "0", "NSIDE must be a whole number from 1"),
        ("a.fits", "NSIDE", "-4", "NSIDE must be"),
        ("a.fits", "NSIDE", "1.5", "NSIDE must be a whole number"),
        ("a.fits", "NSIDE", "4000000000000000000", "NSIDE must be"),
        ("part.fits", "NSIDE", "3", "power of two"),
        ("part.fits", "NSIDE", "1", "names pixel 47, but there are 12"),
        ("a.fits", "ORDERING", "'SPIRAL  '", "ORDERING must be RING or NESTED, got 'SPIRAL"),
        ("a.fits", "NAXIS", "1", "NAXIS 2"),
        ("a.fits", "NAXIS", "-1", "NAXIS must be"),
        ("a.fits", "NAXIS1", "9", "NAXIS1 must be 8"),
        ("a.fits", "NAXIS2", "999999999999", "ends at byte"),
        ("a.fits", "NAXIS2", "0", "no pixels"),
        ("a.fits", "BITPIX", "7", "BITPIX must be"),
        ("a.fits", "TFORM1", "'1024Y   '", "TFORM1 must be"),
        ("a.fits", "TFORM1", "'99999999999999999999E'", "TFORM1 must be"),
        ("a.fits", "TFORM1", "'1A      '", "NAXIS1 must be 5"),
        ("a.fits", "TFIELDS", "1000", "TFIELDS must be"),
        ("a.fits", "PIXTYPE", "'SQUARE  '", "no HEALPix map"),
    ] {
        let error = read(with_card(sample(name), keyword, value)).map(|map| map.n_vertices()).unwrap_err();
        assert!(error.contains(message) && !error.contains('\n'), "{keyword} {value}: {error}");
    }
    // Twelve pixels of 48 are those from FIRSTPIX to LASTPIX, or an error.
    let coarse = with_card(sample("a.fits"), "NSIDE", "2");
    assert_eq!(read(coarse.clone()).unwrap().n_vertices(), 12);
    let error = read(with_card(coarse, "LASTPIX", "12")).map(|map| map.n_vertices()).unwrap_err();
    assert!(error.contains("must have 12·NSIDE² = 48 pixels, or list them, got 12"), "{error}");
    let mut twice = sample("part.fits");
    // The second row gets the pixel of the first.
    let (first, second) = (5760, 5760 + 12);
    twice.copy_within(first..first + 4, second);
    assert!(read(twice).unwrap_err().contains("name the same pixel 3"));
    let mut outside = sample("part.fits");
    outside[first..first + 4].copy_from_slice(&(-1_i32).to_be_bytes());
    assert!(read(outside).unwrap_err().contains("row 0 of the map names pixel"));
}
