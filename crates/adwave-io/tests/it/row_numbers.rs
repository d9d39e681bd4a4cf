//! Clouds with rows that have no position: results are numbered by the rows of the file.

use adwave_io::{
    Field, FieldValues, Format, ReadLimits, ShapeFile, SignalSource, named_signal, read_bytes, write_bytes,
    write_npy,
};

const POINTS: [[f64; 3]; 5] =
    [[0.0, 0.5, 1.0], [f64::NAN; 3], [2.0, 0.25, 3.0], [f64::NAN; 3], [4.0, 0.75, 5.0]];

fn read(bytes: &[u8], name: &str) -> ShapeFile {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn written(file: &ShapeFile, format: Format) -> Vec<u8> {
    let mut out = Vec::new();
    write_bytes(file, format, &mut out).unwrap();
    out
}

/// An organized cloud of 5 × 1 points as a PCD: the color as a float before the position, and an unusual order.
fn organized() -> Vec<u8> {
    let rows: Vec<String> = POINTS
        .iter()
        .enumerate()
        .map(|(i, p)| format!("{} {} {} {} {i}\n", f32::from_bits(0x0001_0203 + i as u32), p[2], p[0], p[1]))
        .collect();
    let rows = rows.concat();
    format!(
        "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb z x y label\nSIZE 4 4 4 4 2\nTYPE F F F F U\nCOUNT 1 1 1 1 1\n\
         WIDTH 5\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 5\nDATA ascii\n{rows}"
    )
    .into_bytes()
}

#[test]
fn organized_clouds_are_read_from_every_format_that_holds_them() {
    let pcd = read(&organized(), "a.pcd");
    for format in [
        Format::PCD,
        Format::PCD_ASCII,
        Format::PCD_COMPRESSED,
        Format::PLY,
        Format::PLY_ASCII,
        Format::XYZ,
        Format::CSV,
    ] {
        let file =
            read(&written(&pcd, format), &format!("a.{}", format.extensions().first().unwrap_or(&"pcd")));
        assert_eq!((file.n_vertices(), file.n_file_rows()), (3, 5), "{format}");
        assert_eq!(file.file_rows().unwrap().vertex_rows(), [0, 2, 4], "{format}");
        assert_eq!((file.points()[1], file.file_row(1)), (POINTS[2], 2), "{format}");
        assert_eq!(file.field("label").unwrap().to_f64(), [0.0, 2.0, 4.0], "{format}");
        assert!(file.to_shape().is_ok());
    }
}

#[test]
fn rows_come_back_where_the_file_has_them() {
    for name in ["a.pcd", "a.ply", "a.xyz"] {
        let format = Format::from_path(name.as_ref()).unwrap();
        let bytes = written(&read(&organized(), "a.pcd"), format);
        let mut file = read(&bytes, name);
        assert_eq!(written(&file, file.format().unwrap()), bytes, "{name}: nothing changed");
        let moved: Vec<[f64; 3]> = file.points().iter().map(|p| [p[0], p[1], p[2] + 1.0]).collect();
        file.set_points(moved).unwrap();
        file.add_vertex_field(Field::new("heat", 1, FieldValues::F64(vec![7.0, 8.0, 9.0]))).unwrap();
        let again = read(&written(&file, format), name);
        assert_eq!((again.n_file_rows(), again.file_row(1), again.points()[1][2]), (5, 2, 4.0), "{name}");
        assert_eq!(again.field("heat").unwrap().to_f64(), [7.0, 8.0, 9.0], "{name}");
    }
}

#[test]
fn a_pcd_keeps_the_order_and_the_types_of_its_fields() {
    let mut file = read(&organized(), "a.pcd");
    file.add_vertex_field(Field::new("heat", 1, FieldValues::F32(vec![7.0, 8.0, 9.0]))).unwrap();
    for format in [Format::PCD, Format::PCD_ASCII, Format::PCD_COMPRESSED] {
        let bytes = written(&file, format);
        let head = String::from_utf8_lossy(&bytes[..200]).into_owned();
        assert!(head.contains("FIELDS rgb z x y label heat\nSIZE 4 4 4 4 2 4\nTYPE F F F F U F\n"), "{head}");
        let again = read(&bytes, "a.pcd");
        assert_eq!(again.field("color").unwrap(), file.field("color").unwrap());
        assert_eq!(again.points(), file.points());
    }
}

#[test]
fn values_of_another_file_have_a_row_for_each_row_of_the_cloud() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("heat.npy");
    write_npy(&path, &[5], adwave_io::ArrayValues::F64(&[1.0, 2.0, 3.0, 4.0, 5.0])).unwrap();
    let file = read(&organized(), "a.pcd");
    let shape = file.to_shape().unwrap();
    let source = SignalSource { file: &file, shape: &shape, name: "a.pcd" };
    let signal = named_signal(source, path.to_str().unwrap(), None).unwrap();
    assert_eq!(*signal.values, [1.0, 3.0, 5.0]);
}

#[test]
fn results_are_nan_where_there_is_no_position() {
    let file = read(&organized(), "a.pcd");
    let all = file.in_file_rows(Field::new("map", 1, FieldValues::F64(vec![1.0, 2.0, 3.0]))).to_f64();
    assert_eq!((all[0], all[2], all[4]), (1.0, 2.0, 3.0));
    assert!(all.len() == 5 && all[1].is_nan() && all[3].is_nan());
}

#[test]
fn a_selection_keeps_the_rest_of_the_file() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 5\nf 1 2 3\nf 2 4 3\n";
    let whole = read(text, "a.obj");
    let mut part = whole.select_rows(&[true, true, true, false]).unwrap();
    assert_eq!((part.n_vertices(), part.faces().len()), (3, 1));
    part.set_points(part.points().iter().map(|p| [p[0], p[1], 2.0]).collect()).unwrap();
    let text = String::from_utf8(written(&part, Format::OBJ)).unwrap();
    assert_eq!(text, "v 0 0 2\nv 1 0 2\nv 0 1 2\nv 1 1 5\nf 1 2 3\nf 2 4 3\n");
    assert!(whole.select_rows(&[false; 4]).unwrap_err().to_string().contains("no vertex"));
    assert!(whole.select_rows(&[true; 3]).is_err());
}
