//! Tests of writing LAS and LAZ: over the original, so that all other content stays, and new files.

use adwave_io::{Field, FieldValues, Format, ReadLimits, ShapeFile, Subset, read_bytes, write_bytes};
use adwave_test_data::data_test;

fn read(bytes: &[u8], name: &str) -> ShapeFile {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn written(shape: &ShapeFile, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    let report = write_bytes(shape, format, &mut bytes).unwrap();
    assert!(report.not_written.is_empty(), "{:?}", report.not_written);
    bytes
}

fn scan(n: usize) -> ShapeFile {
    let at =
        |i: usize| [0.25 * (i % 20) as f64 + 1000.0, 0.25 * (i / 20) as f64 - 3.0, (0.3 * i as f64).sin()];
    let mut shape = ShapeFile::from_cloud((0..n).map(at).collect());
    let intensity = FieldValues::U16((0..n).map(|i| (37 * i % 65_000) as u16).collect());
    let color = FieldValues::U16((0..3 * n).map(|i| (101 * i % 65_000) as u16).collect());
    let class = FieldValues::U8((0..n).map(|i| (i % 7) as u8).collect());
    shape.add_vertex_field(Field::new("intensity", 1, intensity)).unwrap();
    shape.add_vertex_field(Field::new("classification", 1, class)).unwrap();
    shape.add_vertex_field(Field::new("color", 3, color)).unwrap();
    shape
}

fn farthest(a: &ShapeFile, b: &ShapeFile) -> f64 {
    let off =
        |(p, q): (&[f64; 3], &[f64; 3])| p.iter().zip(q).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    assert_eq!(a.n_vertices(), b.n_vertices());
    a.points().iter().zip(b.points()).map(off).fold(0.0, f64::max)
}

#[test]
fn a_new_file_holds_points_intensity_classes_and_colors() {
    let shape = scan(500);
    for (format, name) in [(Format::LAS, "a.las"), (Format::LAZ, "a.laz")] {
        let again = read(&written(&shape, format), name);
        assert_eq!(again.format(), Some(format));
        // A thousandth of the smallest distance between points.
        assert!(farthest(&shape, &again) < 2.6e-4);
        for field in shape.vertex_fields() {
            assert_eq!(Some(&field.values), again.field(&field.name).map(|f| &f.values), "{}", field.name);
        }
        assert!(again.field("return_number").unwrap().to_f64().iter().all(|r| *r == 1.0));
    }
}

#[test]
fn what_was_read_is_written_with_all_that_it_had() {
    let las = written(&scan(300), Format::LAS);
    let shape = read(&las, "a.las");
    assert_eq!(written(&shape, Format::LAS), las, "nothing changed");
    // There and back.
    let laz = written(&shape, Format::LAZ);
    assert_eq!(written(&read(&laz, "a.laz"), Format::LAS), las);
    for (bytes, name, format) in [(&las, "a.las", Format::LAS), (&laz, "a.laz", Format::LAZ)] {
        let mut moved = read(bytes, name);
        let mut points = moved.points().to_vec();
        points[7][2] += 0.5;
        moved.set_points(points).unwrap();
        let intensity = FieldValues::U16(vec![9; 300]);
        moved.add_vertex_field(Field::new("intensity", 1, intensity)).unwrap();
        let again = read(&written(&moved, format), name);
        assert!(farthest(&moved, &again) < 1e-7 && again.points()[8] == shape.points()[8]);
        assert_eq!(again.field("color"), shape.field("color"));
        assert!(again.field("intensity").unwrap().to_f64().iter().all(|v| *v == 9.0));
        // A new field becomes extra bytes, and is updated in place when it is written again with other values.
        moved.add_vertex_field(Field::new("gaze", 1, FieldValues::F32(vec![1.5; 300]))).unwrap();
        let mut again = read(&written(&moved, format), name);
        assert_eq!(again.field("gaze"), moved.field("gaze"));
        assert_eq!(again.field("color"), shape.field("color"));
        again.add_vertex_field(Field::new("gaze", 1, FieldValues::F32(vec![-2.0; 300]))).unwrap();
        let bytes = written(&again, format);
        let last = read(&bytes, name);
        assert_eq!((last.vertex_fields(), last.points()), (again.vertex_fields(), again.points()));
        assert_eq!(written(&last, format), bytes);
    }
    let far = {
        let mut shape = shape.clone();
        let points = shape.points().iter().map(|p| p.map(|c| 1e9 * c)).collect();
        shape.set_points(points).unwrap();
        write_bytes(&shape, Format::LAS, &mut Vec::new()).unwrap_err().to_string()
    };
    assert!(far.contains("in steps of"), "{far}");
}

#[test]
fn some_of_the_points_are_counted_anew() {
    let shape = read(&written(&scan(300), Format::LAS), "a.las");
    let vertices: Vec<u32> = (0..300).filter(|v| v % 3 == 1).collect();
    let subset = Subset { vertices: &vertices, ..Subset::default() };
    let few = shape.subset(&subset).unwrap();
    for (format, name) in [(Format::LAS, "b.las"), (Format::LAZ, "b.laz")] {
        let bytes = written(&few, format);
        assert_eq!(bytes[107..111], 100_u32.to_le_bytes());
        assert_eq!(bytes[111..115], 100_u32.to_le_bytes());
        let again = read(&bytes, name);
        assert_eq!(again.points(), few.points());
        assert_eq!(again.field("color").unwrap().values, few.field("color").unwrap().values);
    }
}

#[data_test]
fn real_scans_keep_everything() {
    for name in ["autzen/autzen-thin.las", "las/1.2-with-color.las"] {
        let path = std::path::Path::new(adwave_test_data::folder!()).join("pointclouds/PDAL-test").join(name);
        let bytes = std::fs::read(&path).unwrap();
        let shape = read(&bytes, name);
        assert_eq!(written(&shape, Format::LAS), bytes, "{name}");
        let laz = written(&shape, Format::LAZ);
        assert!(10 * laz.len() < 6 * bytes.len(), "{name}: {} of {} bytes", laz.len(), bytes.len());
        assert_eq!(written(&read(&laz, "a.laz"), Format::LAS), bytes, "{name}");
    }
}

#[test]
fn what_a_record_has_no_place_for_becomes_extra_bytes() {
    let mut shape = ShapeFile::from_cloud(vec![[0.0, 0.5, 1.0], [1.0, 0.0, 0.25]]);
    let fields = [
        Field::new("return_number", 1, FieldValues::U8(vec![3, 15])),
        Field::new("classification", 1, FieldValues::U8(vec![2, 64])),
        Field::new("gps_time", 1, FieldValues::F64(vec![0.1, 1e9])),
        Field::new("a", 1, FieldValues::U8(vec![1, 2])),
        Field::new("b", 2, FieldValues::I8(vec![-1, 2, 3, 4])),
        Field::new("c", 1, FieldValues::U16(vec![1, 65535])),
        Field::new("d", 1, FieldValues::I16(vec![-32768, 2])),
        Field::new("e", 1, FieldValues::U32(vec![1, u32::MAX])),
        Field::new("f", 5, FieldValues::I32((0..10).map(|k| -k).collect())),
        Field::new("g", 1, FieldValues::U64(vec![1, u64::MAX])),
        Field::new("h", 1, FieldValues::I64(vec![i64::MIN, 2])),
        Field::new("normal", 3, FieldValues::F32(vec![0.1, f32::NAN, -0.0, 1.0, 2.0, 3.0])),
        Field::new("color", 3, FieldValues::F32(vec![0.5; 6])),
        Field::new("W1", 3, FieldValues::F64((0..6).map(|k| 0.1 * f64::from(k)).collect())),
        Field::new("intensity", 1, FieldValues::F64(vec![0.25, 7.0])),
    ];
    for field in &fields {
        shape.add_vertex_field(field.clone()).unwrap();
    }
    for (format, name) in [(Format::LAS, "a.las"), (Format::LAZ, "a.laz")] {
        let mut bytes = Vec::new();
        let report = write_bytes(&shape, format, &mut bytes).unwrap();
        assert_eq!(report.not_written, ["the name of `intensity` (stored as `intensity_2`)"]);
        let again = read(&bytes, name);
        let renamed =
            |name: &str| if name == "intensity" { "intensity_2".to_owned() } else { name.to_owned() };
        for field in &fields {
            let own = again.field(&renamed(&field.name)).unwrap_or_else(|| panic!("{}", field.name));
            assert_eq!(
                (own.n_channels, own.values.value_type()),
                (field.n_channels, field.values.value_type())
            );
            let same = |(a, b): (f64, f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
            assert!(field.to_f64().into_iter().zip(own.to_f64()).all(same), "{}", field.name);
        }
        assert_eq!(written(&again, format), bytes);
    }
}

#[test]
fn coordinates_beyond_all_steps_are_refused() {
    let far = ShapeFile::from_cloud(vec![[-1.7e308, 0.0, 0.0], [1.7e308, 0.0, 0.0]]);
    let error = write_bytes(&far, Format::LAS, &mut Vec::new()).unwrap_err().to_string();
    assert!(error.contains("cannot store"), "{error}");
}

#[test]
fn parts_that_lie_over_each_other_are_one_line() {
    let las = written(&scan(30), Format::LAS);
    let refusal = |at: usize, value: &[u8]| {
        let mut broken = las.clone();
        broken[at..at + value.len()].copy_from_slice(value);
        read_bytes(broken, Some("a.las"), &ReadLimits::default()).unwrap_err().to_string()
    };
    assert!(refusal(94, &99_u16.to_le_bytes()).contains("a header of 99 bytes is too short"));
    assert!(refusal(96, &83_u32.to_le_bytes()).contains("inside the header of 227 bytes"));
    // More records than fit before the points; none of them describes points.
    let mut counted = las.clone();
    counted[100..104].copy_from_slice(&1_u32.to_le_bytes());
    let again = written(&read(&counted, "a.las"), Format::LAS);
    assert_eq!(again, las);
}

#[test]
fn times_that_differ_by_more_than_a_whole_number_holds_are_kept_or_refused() {
    let mut las = written(&scan(30), Format::LAS);
    // Format 3 has a time before the color.
    let (head, points) = las.split_at(227);
    let (mut head, mut rows) = (head.to_vec(), Vec::new());
    for (i, row) in points.chunks_exact(26).enumerate() {
        rows.extend(&row[..20]);
        rows.extend([[0x80, 0x3f, 0x7f][i % 3]; 8]);
        rows.extend(&row[20..]);
    }
    head[104] = 3;
    head[105..107].copy_from_slice(&34_u16.to_le_bytes());
    las = [head, rows].concat();
    let mut laz = Vec::new();
    match write_bytes(&read(&las, "a.las"), Format::LAZ, &mut laz) {
        Ok(_) => assert_eq!(written(&read(&laz, "a.laz"), Format::LAS), las),
        Err(error) => assert!(error.to_string().contains("write a LAS instead"), "{error}"),
    }
}
