//! Tests of written GIFTI files: surfaces, values alone, conversion of names and numbers.

use crate::common;

use adwave::shape::Polygons;
use adwave_io::{
    Field, FieldValues, Format, ReadLimits, ShapeFile, parse_gifti_fields, read_bytes, read_gifti_fields,
    read_path, write_bytes, write_csv_fields, write_gifti_fields, write_path,
};
use adwave_test_data::data_test;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

fn limits() -> ReadLimits {
    ReadLimits::default()
}

fn square() -> ShapeFile {
    let points = vec![[0.0, 0.0, 0.5], [1.0, 0.0, 0.25], [1.0, 1.0, 0.0], [0.0, 1.0, -8.0]];
    ShapeFile::from_mesh(points, Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]))
}

fn written(shape: &ShapeFile) -> (Vec<u8>, Vec<String>) {
    let mut bytes = Vec::new();
    let report = write_bytes(shape, Format::GIFTI, &mut bytes).unwrap();
    (bytes, report.not_written)
}

#[test]
fn a_surface_with_fields_comes_back() {
    let mut shape = square();
    for field in [
        Field::new("thickness", 1, FieldValues::F32(vec![0.5, f32::NAN, 3.0, -1.0])),
        Field::new("normal", 3, FieldValues::F64((0..12).map(f64::from).collect())),
        Field::new("color", 3, FieldValues::U8((0..12).collect())),
        Field::new("label", 1, FieldValues::I64(vec![-7, 0, 1, 2_000_000_000])),
    ] {
        shape.add_vertex_field(field).unwrap();
    }
    let (bytes, left) = written(&shape);
    assert_eq!(left, [""; 0]);
    let again = read_bytes(bytes, None, &limits()).unwrap();
    assert_eq!((again.points(), again.faces()), (shape.points(), shape.faces()));
    assert_eq!(again.field_names(), shape.field_names());
    for field in shape.vertex_fields() {
        let read = again.field(&field.name).unwrap();
        assert_eq!(read.n_channels, field.n_channels);
        let same = |(x, y): (&f64, &f64)| x == y || (x.is_nan() && y.is_nan());
        assert!(field.to_f64().iter().zip(&read.to_f64()).all(same), "{}", field.name);
    }
}

#[test]
fn what_32_bits_cannot_hold_is_said_or_refused() {
    let mut shape = square();
    shape.add_vertex_field(Field::new("third", 1, FieldValues::F64(vec![1.0 / 3.0; 4]))).unwrap();
    shape.add_vertex_field(Field::new("id", 1, FieldValues::U64(vec![u64::MAX - 1; 4]))).unwrap();
    assert_eq!(
        written(&shape).1,
        ["digits of `third` beyond 32-bit floats", "digits of `id` beyond 32-bit floats"]
    );
    shape.set_points(vec![[0.1; 3]; 4]).unwrap();
    assert!(written(&shape).1.contains(&"digits of coordinates beyond 32-bit floats".to_owned()));
    shape.set_points(vec![[1e39, 0.0, 0.0]; 4]).unwrap();
    let error = write_bytes(&shape, Format::GIFTI, &mut Vec::new()).unwrap_err().to_string();
    assert!(error.contains("coordinates beyond 3.4e38"), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.gii");
    let field = Field::new("heat", 1, FieldValues::F64(vec![-1e300]));
    let error = write_gifti_fields(&path, &[field], None).unwrap_err().to_string();
    assert!(error.contains("large.gii") && error.contains("`heat` beyond"), "{error}");
    assert!(!path.exists());
}

#[test]
fn polygons_become_triangles_and_that_is_said() {
    let points = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 2.0, 0.0]];
    let arrow: Polygons = std::iter::once(&[0_u32, 1, 2, 3][..]).collect();
    let (bytes, left) = written(&ShapeFile::from_mesh(points, arrow));
    assert_eq!(left, ["polygons (as triangles)"]);
    let again = read_bytes(bytes, None, &limits()).unwrap();
    // The reentrant corner is on the diagonal, so that the two parts do not overlap.
    assert_eq!(again.faces().len(), 2);
    assert!(again.faces().iter().all(|f| f.contains(&0) && f.contains(&2)));
}

#[test]
fn names_are_escaped() {
    let mut shape = square();
    let name = "a<b> & \"c\" ]]> ä";
    shape.add_vertex_field(Field::new(name, 1, FieldValues::F32(vec![1.0; 4]))).unwrap();
    let (bytes, _) = written(&shape);
    assert_eq!(read_bytes(bytes, None, &limits()).unwrap().field_names(), [name]);
    shape.add_vertex_field(Field::new("bell\u{7}", 1, FieldValues::F32(vec![2.0; 4]))).unwrap();
    let (bytes, _) = written(&shape);
    assert_eq!(read_bytes(bytes, None, &limits()).unwrap().field_names(), [name, "bell_"]);
}

#[test]
fn values_alone_are_columns_with_names() {
    let folder = tempfile::tempdir().unwrap();
    let fields = [
        Field::new("saliency", 1, FieldValues::F64(vec![0.5, -2.0])),
        Field::new("flow", 3, FieldValues::F64(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
    ];
    for (name, packed) in [("map.func.gii", false), ("map.gii.gz", true)] {
        let path = folder.path().join(name);
        write_gifti_fields(&path, &fields, Some("CortexLeft")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap().starts_with(&[0x1f, 0x8b]), packed);
        let read = read_gifti_fields(&path, &limits()).unwrap();
        let names: Vec<&str> = read.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["saliency", "flow_x", "flow_y", "flow_z"]);
        assert_eq!((read[0].to_f64(), read[2].to_f64()), (vec![0.5, -2.0], vec![2.0, 5.0]));
    }
    let text = std::fs::read_to_string(folder.path().join("map.func.gii")).unwrap();
    assert!(text.contains("NumberOfDataArrays=\"4\"") && text.contains("CortexLeft"), "{text}");
    assert_eq!(parse_gifti_fields(text.as_bytes(), &limits()).unwrap().len(), 4);
}

#[test]
fn a_table_has_a_row_of_names_even_where_a_name_is_a_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    let fields = [
        Field::new("2", 1, FieldValues::F64(vec![0.1, f64::NAN])),
        Field::new("flow", 2, FieldValues::F32(vec![0.1, 2.0, 3.0, 4.0])),
    ];
    write_csv_fields(&path, &fields).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "field_2,flow_0,flow_1\n0.1,0.1,2\nnan,3,4\n");
    let uneven = [fields[0].clone(), Field::new("one", 1, FieldValues::U8(vec![1]))];
    let error = write_csv_fields(&path, &uneven).unwrap_err().to_string();
    assert!(error.contains("one") && error.contains("table.csv"), "{error}");
}

/// A triangle in every encoding, with unknown text around it.
fn kept(encoding: &str, data: &str, order: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<!-- kept -->\n<GIFTI Version=\"1.0\" NumberOfDataArrays=\"3\">\n<MetaData/>\n<DataArray \
         Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" ArrayIndexingOrder=\"{order}\" \
         Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" Encoding=\"{encoding}\" Endian=\"BigEndian\"><MetaData><MD>\
         <Name>GeometricType</Name><Value>Inflated</Value></MD></MetaData><Data>{data}</Data></DataArray>\n<DataArray \
         Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"2\" Dim0=\"1\" Dim1=\"3\" \
         Encoding=\"ASCII\" Endian=\"LittleEndian\"><Data>0 1 2</Data></DataArray>\n<DataArray \
         Intent=\"NIFTI_INTENT_LABEL\" DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"1\" Dim0=\"3\" Encoding=\"ASCII\" \
         Endian=\"LittleEndian\"><Data> 7 8  9 </Data></DataArray>\n<!-- and this --></GIFTI>\n"
    )
}

#[test]
fn a_surface_that_is_written_again_keeps_everything_but_what_changed() {
    let coordinates = [0.0_f32, 0.5, -1.0, 2.0, 0.25, 3.0, 1.5, 1.0, 8.0];
    let big: Vec<u8> = coordinates.iter().flat_map(|c| c.to_be_bytes()).collect();
    let text = coordinates.map(|c| c.to_string()).join(" ");
    for (encoding, data) in [("ASCII", text), ("Base64Binary", STANDARD.encode(&big))] {
        for order in ["RowMajorOrder", "ColumnMajorOrder"] {
            let file = kept(encoding, &data, order);
            let mut shape = read_bytes(file.clone().into_bytes(), None, &limits()).unwrap();
            assert_eq!(String::from_utf8(written(&shape).0).unwrap(), file);
            let moved: Vec<[f64; 3]> = shape.points().iter().map(|p| p.map(|c| c + 0.125)).collect();
            shape.set_points(moved.clone()).unwrap();
            shape.add_vertex_field(Field::new("heat", 1, FieldValues::F32(vec![1.0, 2.0, 4.0]))).unwrap();
            let (bytes, left) = written(&shape);
            assert_eq!(left, [""; 0]);
            let again = read_bytes(bytes.clone(), None, &limits()).unwrap();
            assert_eq!(again.points(), moved, "{encoding} {order}");
            assert_eq!(again.field_names(), ["label", "heat"]);
            let now = String::from_utf8(bytes).unwrap();
            for part in
                ["<!-- kept -->", "Inflated", "<Data> 7 8  9 </Data>", "<!-- and this -->", order, encoding]
            {
                assert!(now.contains(part), "{part} is gone: {now}");
            }
            assert!(now.contains("NumberOfDataArrays=\"4\""), "{now}");
            // A field of the file in its own type, and one whose type has changed.
            let own = shape.field("label").unwrap().with_values_rounded(&[1.0, 2.4, 3.0]);
            shape.add_vertex_field(own).unwrap();
            let read = read_bytes(written(&shape).0, None, &limits()).unwrap();
            assert_eq!(read.field("label").unwrap().values, FieldValues::I32(vec![1, 2, 3]));
            shape.add_vertex_field(Field::new("label", 1, FieldValues::F32(vec![0.5; 3]))).unwrap();
            let read = read_bytes(written(&shape).0, None, &limits()).unwrap();
            assert_eq!(read.field("label").unwrap().values, FieldValues::F32(vec![0.5; 3]));
        }
    }
}

#[data_test]
fn a_surface_of_the_brain_keeps_its_bits_and_its_side() {
    let folder = tempfile::tempdir().unwrap();
    let brain = common::test_inputs().join("fields/nilearn-fsaverage5");
    let surface = read_path(&brain.join("white_left.gii.gz"), &limits()).unwrap();
    assert_eq!(surface.structure(), Some("CortexLeft"));
    for name in ["white.gii", "white.gii.gz"] {
        let path = folder.path().join(name);
        assert_eq!(write_path(&surface, &path, None).unwrap().not_written, [""; 0]);
        let again = read_path(&path, &limits()).unwrap();
        assert_eq!((again.points(), again.faces()), (surface.points(), surface.faces()));
        assert_eq!(again.structure(), Some("CortexLeft"));
    }
    let thickness = read_gifti_fields(&brain.join("thick_left.gii.gz"), &limits()).unwrap();
    let path = folder.path().join("thickness.shape.gii");
    write_gifti_fields(&path, &thickness, None).unwrap();
    assert_eq!(read_gifti_fields(&path, &limits()).unwrap(), thickness);
}

#[test]
fn arrays_in_files_of_their_own_lie_beside_the_surface() {
    let folder = tempfile::tempdir().unwrap();
    let text = |name: &str| {
        format!(
            "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"1\"><DataArray Intent=\"NIFTI_INTENT_POINTSET\" \
             DataType=\"NIFTI_TYPE_FLOAT32\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"2\" \
             Dim1=\"3\" Encoding=\"ExternalFileBinary\" Endian=\"LittleEndian\" ExternalFileName=\"{name}\" \
             ExternalFileOffset=\"4\"><Data/></DataArray></GIFTI>"
        )
    };
    let path = folder.path().join("a.surf.gii");
    let numbers = [9.0_f32, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(folder.path().join("a.data"), &bytes).unwrap();
    std::fs::write(&path, text("a.data")).unwrap();
    let shape = read_path(&path, &limits()).unwrap();
    assert_eq!(shape.points(), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
    // It is written with its numbers embedded.
    assert_eq!(read_bytes(written(&shape).0, None, &limits()).unwrap().points(), shape.points());
    std::fs::write(folder.path().join("a.data"), &bytes[..20]).unwrap();
    let error = read_path(&path, &limits()).unwrap_err().to_string();
    assert!(error.contains("fewer than the 24 bytes"), "{error}");
    for name in ["../a.data", "/etc/hostname", "..", ""] {
        std::fs::write(&path, text(name)).unwrap();
        let error = read_path(&path, &limits()).unwrap_err().to_string();
        assert!(error.contains("move it next to the GIFTI"), "{error}");
    }
    let error = read_bytes(text("a.data").into_bytes(), None, &limits()).unwrap_err().to_string();
    assert!(error.contains("open the GIFTI by its path"), "{error}");
}
