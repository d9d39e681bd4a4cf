//! Tests of external fields: GIFTI, tables, textures; their content, and errors of invalid ones.

use crate::common;

use adwave_io::{
    FieldValues, Format, ReadLimits, parse_csv_fields, read_bytes, read_gifti_fields, read_path,
    texture_colors,
};
use adwave_test_data::data_test;
use base64::Engine;
use std::io::Write;
use std::path::Path;

fn limits() -> ReadLimits {
    ReadLimits::default()
}

struct Gifti(String);

impl Gifti {
    fn new() -> Self {
        Self(
            "<?xml version=\"1.0\"?>\n<!DOCTYPE GIFTI SYSTEM \"gifti.dtd\">\n<GIFTI Version=\"1.0\">\n"
                .into(),
        )
    }

    fn array(mut self, attributes: &str, data: &str) -> Self {
        self.0 += &format!("<DataArray {attributes}><MetaData/><Data>{data}</Data></DataArray>\n");
        self
    }

    fn bytes(self) -> Vec<u8> {
        (self.0 + "</GIFTI>\n").into_bytes()
    }
}

fn points(encoding: &str, data: &str) -> Gifti {
    let attributes = format!(
        "Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" ArrayIndexingOrder=\"RowMajorOrder\" \
         Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" Encoding=\"{encoding}\" Endian=\"LittleEndian\""
    );
    Gifti::new().array(&attributes, data)
}

const COORDINATES: [f32; 9] = [0.0, 0.5, -1.0, 2.0, 0.25, 3.0, 1.5, 1.0, 8.0];

fn little_endian() -> Vec<u8> {
    COORDINATES.iter().flat_map(|c| c.to_le_bytes()).collect()
}

fn base64(bytes: &[u8]) -> String {
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut stream = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    stream.write_all(bytes).unwrap();
    stream.finish().unwrap()
}

#[test]
fn all_encodings_and_orders_of_a_gifti_give_the_same_points() {
    let text = COORDINATES.map(|c| c.to_string()).join("\n ");
    let by_column: Vec<u8> =
        (0..3).flat_map(|c| (0..3).flat_map(move |r| COORDINATES[3 * r + c].to_be_bytes())).collect();
    let column_major = "Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" \
        ArrayIndexingOrder=\"ColumnMajorOrder\" Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" \
        Encoding=\"Base64Binary\" Endian=\"BigEndian\"";
    let triangles = "Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"2\" Dim0=\"1\" \
        Dim1=\"3\" Encoding=\"ASCII\" Endian=\"LittleEndian\"";
    let packed = base64(&zlib(&little_endian()));
    let (left, right) = packed.split_at(20);
    for gifti in [
        points("ASCII", &text),
        points("Base64Binary", &base64(&little_endian())),
        points("GZipBase64Binary", &format!("\n{left}\n  {right}\n")),
        Gifti::new().array(column_major, &base64(&by_column)),
    ] {
        let shape = read_bytes(gifti.array(triangles, "0 1 2").bytes(), None, &limits()).unwrap();
        assert_eq!(shape.format(), Some(Format::GIFTI));
        let expected: Vec<f64> = COORDINATES.iter().map(|&c| c.into()).collect();
        assert_eq!(shape.points().as_flattened(), expected);
        assert_eq!(shape.faces().get(0), [0, 1, 2]);
    }
}

#[test]
fn what_is_wrong_with_a_gifti_is_said_in_one_line() {
    let values = "Intent=\"NIFTI_INTENT_SHAPE\" DataType=\"NIFTI_TYPE_FLOAT32\" Dimensionality=\"1\" Dim0=\"2\" \
        Encoding=\"ASCII\" Endian=\"LittleEndian\"";
    let bad_triangle = "Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" Dimensionality=\"2\" Dim0=\"1\" \
        Dim1=\"3\" Encoding=\"ASCII\" Endian=\"LittleEndian\"";
    let whole = || points("ASCII", "0 0 0 1 0 0 0 1 0");
    for (gifti, words) in [
        (Gifti::new().array(values, "1 2"), "as a signal of a surface"),
        (points("ASCII", "0 0 0"), "9 values, got 3"),
        (points("ASCII", "0 0 zero 0 0 0 0 0 0"), "zero"),
        (points("Base64Binary", "@@@"), "Base64"),
        (points("GZipBase64Binary", &base64(b"not zlib at all")), "compressed"),
        (points("GZipBase64Binary", &base64(&zlib(&vec![0; 1 << 16]))), "more than"),
        (points("Base64Binary", &base64(&[0; 35])), "fewer than"),
        (points("ExternalFileBinary", ""), "open the GIFTI by its path"),
        (points("Base128", ""), "Base128"),
        (whole().array(bad_triangle, "0 1 3"), "names vertex 3"),
        (whole().array(bad_triangle, "0 1 -1"), "names vertex -1"),
        (
            whole().array(&bad_triangle.replace("Dim0=\"1\"", "Dim0=\"99999999999999\""), "0"),
            "99999999999999",
        ),
        (Gifti("<GIFTI><DataArray".into()), "XML"),
    ] {
        let error = read_bytes(gifti.bytes(), Some("a.gii"), &limits()).unwrap_err().to_string();
        assert!(error.contains(words) && !error.contains('\n'), "{error:?} lacks {words:?}");
    }
}

#[test]
fn a_gifti_that_is_cut_anywhere_is_an_error_and_never_a_panic() {
    let whole = points("GZipBase64Binary", &base64(&zlib(&little_endian()))).bytes();
    let last = whole.iter().rposition(|&b| b == b'>').unwrap();
    for end in 0..=last {
        assert!(read_bytes(whole[..end].to_vec(), Some("a.gii"), &limits()).is_err(), "{end}");
    }
}

#[data_test]
fn the_cortex_is_read_with_its_curvature_and_depth() {
    let folder = common::test_inputs().join("fields/nilearn-fsaverage5");
    let surface = read_path(&folder.join("pial_left.gii.gz"), &limits()).unwrap();
    assert_eq!((surface.n_vertices(), surface.faces().len()), (10242, 20480));
    // The coordinates are millimeters of a brain.
    assert!(surface.points().iter().flatten().all(|c| c.abs() < 150.0));
    for name in ["sulc_left", "curv_left", "thick_left", "area_left"] {
        let fields = read_gifti_fields(&folder.join(format!("{name}.gii.gz")), &limits()).unwrap();
        assert_eq!((fields.len(), fields[0].len(), fields[0].n_channels), (1, 10242, 1), "{name}");
        assert!(fields[0].to_f64().iter().all(|v| v.is_finite()));
    }
    let error = read_gifti_fields(&folder.join("pial_left.gii.gz"), &limits()).unwrap_err().to_string();
    assert!(error.contains("no values"), "{error}");
}

#[test]
fn a_table_names_its_columns_or_numbers_them() {
    let named = parse_csv_fields(b"a,\"b c\"\n1,2\nNA, 4e1\n", &limits()).unwrap();
    assert_eq!((named[0].name.as_str(), named[1].name.as_str()), ("a", "b c"));
    assert_eq!(named[1].values, FieldValues::F64(vec![2.0, 40.0]));
    assert!(named[0].get(1, 0).is_nan());
    let bare = parse_csv_fields(b"1\n2\n3", &limits()).unwrap();
    assert_eq!((bare.len(), bare[0].name.as_str(), bare[0].len()), (1, "1", 3));
    for (text, words) in [
        ("a,b\n1,2\n3\n", "got 1 after 2"),
        ("a\n1\nx\n", "\"x\""),
        ("", "no row"),
        ("a,b\n", "no row"),
        ("1,2\n3,\"4", ""),
    ] {
        match parse_csv_fields(text.as_bytes(), &limits()) {
            Err(error) => assert!(error.to_string().contains(words), "{text:?}: {error}"),
            Ok(fields) => assert!(words.is_empty(), "{text:?} gives {fields:?}"),
        }
    }
}

/// Creates a folder with a square of two triangles, its material and its picture: left red, right blue.
fn textured(obj: &str, mtl: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut picture = image::RgbImage::new(8, 8);
    for (x, _, pixel) in picture.enumerate_pixels_mut() {
        *pixel = if x < 4 { image::Rgb([255, 0, 0]) } else { image::Rgb([0, 0, 255]) };
    }
    picture.save(folder.path().join("my picture.png")).unwrap();
    std::fs::write(folder.path().join("a.obj"), obj).unwrap();
    std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    folder
}

const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nvt 0.25 0.5\nvt 0.75 0.5\n";

fn colors(folder: &Path, image: Option<&Path>) -> Result<Vec<f64>, String> {
    let path = folder.join("a.obj");
    let shape = read_path(&path, &limits()).unwrap();
    texture_colors(&shape, &path, image, &limits()).map(|f| f.to_f64()).map_err(|e| e.to_string())
}

#[test]
fn a_texture_is_sampled_at_the_corners_and_seams_take_the_mean() {
    // Vertex 1 is red in one triangle and blue in the other; vertex 5 is in none.
    let faces = "usemtl m\nf 1/1 2/2 3/2\nf -5/-1 -3/2 -2/1\n";
    let folder = textured(&format!("{SQUARE}{faces}"), "newmtl m\nmap_Kd -clamp on my picture.png\n");
    let by_material = colors(folder.path(), None).unwrap();
    assert_eq!(by_material[..12], [0.5, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
    assert!(by_material[12..].iter().all(|c| c.is_nan()));
    let by_name = colors(folder.path(), Some(&folder.path().join("my picture.png"))).unwrap();
    assert_eq!(by_material[..12], by_name[..12]);
}

#[test]
fn what_a_texture_lacks_is_said() {
    let faces = "usemtl m\nf 1/1 2/2 3/2\n";
    let bare = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (obj, mtl, words) in [
        (bare.to_owned(), "", "no texture coordinates"),
        (format!("{SQUARE}{faces}"), "newmtl m\nKd 1 0 0\n", "names no texture"),
        (format!("{SQUARE}{faces}"), "newmtl m\nmap_Kd gone.png\n", "gone.png"),
        (format!("{SQUARE}{faces}"), "newmtl m\nmap_Kd a.mtl\n", "PNG or JPEG"),
        (format!("{SQUARE}{faces}").replace("a.mtl", "b.mtl"), "", "b.mtl"),
    ] {
        let folder = textured(&obj, mtl);
        let error = colors(folder.path(), None).unwrap_err();
        assert!(error.contains(words) && !error.contains('\n'), "{error:?} lacks {words:?}");
    }
}

#[data_test]
fn spot_has_the_colors_of_its_picture() {
    let folder = common::test_inputs().join("fields/spot-textured");
    let path = folder.join("spot.obj");
    let shape = read_path(&path, &limits()).unwrap();
    let picture = folder.join("spot_texture.png");
    let colors = texture_colors(&shape, &path, Some(&picture), &limits()).unwrap().to_f64();
    assert_eq!(colors.len(), 3 * 2930);
    assert!(colors.iter().all(|c| (0.0..=1.0).contains(c)));
    // White with dark spots.
    let dark = colors.chunks_exact(3).filter(|c| c.iter().sum::<f64>() < 1.2).count();
    assert!((100..1500).contains(&dark), "{dark}");
    assert!(texture_colors(&shape, &path, None, &limits()).unwrap_err().to_string().contains("--texture"));
}
