//! Content that goes from one format into another: colors, texture coordinates of corners, values of the whole file.

use adwave::shape::Polygons;
use adwave_io::{Field, FieldValues, Format, ReadLimits, ShapeFile, WriteReport, read_bytes, write_bytes};

fn read(bytes: &[u8], name: &str) -> ShapeFile {
    read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
}

fn written(shape: &ShapeFile, format: Format) -> (Vec<u8>, WriteReport) {
    let mut out = Vec::new();
    let report = write_bytes(shape, format, &mut out).unwrap();
    (out, report)
}

/// Strip of n + 2 vertices with these colors.
fn colored(n: u32, color: Field) -> ShapeFile {
    let points = (0..n + 2).map(|i| [f64::from(i / 2), f64::from(i % 2), f64::from(i * i % 7)]).collect();
    let triangles: Vec<[u32; 3]> = (0..n).map(|i| [i, i + 1, i + 2]).collect();
    let mut shape = ShapeFile::from_mesh(points, Polygons::from_triangles(&triangles));
    shape.add_vertex_field(color).unwrap();
    shape
}

/// Numbers of the colors of a glTF whose buffer is in the text.
fn color_accessor(gltf: &[u8]) -> Vec<f32> {
    use base64::Engine as _;
    let json: serde_json::Value = serde_json::from_slice(gltf).unwrap();
    let index = json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].as_u64().unwrap() as usize;
    let accessor = &json["accessors"][index];
    assert_eq!(accessor["componentType"], 5126);
    let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let text = json["buffers"][0]["uri"].as_str().unwrap().rsplit(',').next().unwrap();
    let bytes = base64::engine::general_purpose::STANDARD.decode(text).unwrap();
    let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap_or(0) as usize);
    let numbers = bytes[start..start + length].chunks_exact(4);
    numbers.map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

#[test]
fn bytes_of_colors_become_light_in_a_gltf_and_bytes_again() {
    for n_channels in [3, 4] {
        let bytes: Vec<u8> = (0..64 * n_channels).map(|k| (k * 37 % 256) as u8).collect();
        let shape = colored(62, Field::new("color", n_channels as usize, FieldValues::U8(bytes.clone())));
        let (gltf, report) = written(&shape, Format::GLTF);
        assert!(report.not_written.is_empty());
        // IEC 61966-2-1; alpha is linear already.
        let light = color_accessor(&gltf);
        for (k, &byte) in bytes.iter().enumerate() {
            let c = k % n_channels as usize;
            let x = f64::from(byte) / 255.0;
            let expected = match c {
                3 => x,
                _ if x <= 0.040_45 => x / 12.92,
                _ => ((x + 0.055) / 1.055).powf(2.4),
            };
            let found = f64::from(light[k]);
            assert!((found - expected).abs() < 1e-6, "{byte}: {found} instead of {expected}");
        }
        for format in [Format::GLTF, Format::GLB] {
            let again = read(&written(&shape, format).0, "a");
            assert_eq!(again.field("color").unwrap().values, FieldValues::U8(bytes.clone()));
            for other in [Format::PLY, Format::PLY_ASCII, Format::THREE_MF] {
                let (text, report) = written(&again, other);
                assert!(report.not_written.is_empty(), "{other}: {report:?}");
                assert_eq!(
                    read(&text, "a").field("color").unwrap().values,
                    FieldValues::U8(bytes.clone()),
                    "{other}"
                );
            }
        }
    }
}

#[test]
fn fractions_of_colors_become_bytes_where_readers_expect_them() {
    let fractions: Vec<f64> = (0..60).map(|k| f64::from(k * 13 % 256) / 255.0).collect();
    let shape = colored(18, Field::new("color", 3, FieldValues::F64(fractions.clone())));
    let expected: Vec<u8> = fractions.iter().map(|x| (255.0 * x).round() as u8).collect();
    for format in [Format::PLY, Format::PLY_ASCII, Format::THREE_MF, Format::PCD] {
        let (bytes, report) = written(&shape, format);
        assert!(!report.not_written.iter().any(|what| what.contains("color")), "{format}: {report:?}");
        assert_eq!(
            read(&bytes, "a").field("color").unwrap().values,
            FieldValues::U8(expected.clone()),
            "{format}"
        );
    }
    // Digits that bytes do not have are reported.
    let shape = colored(1, Field::new("color", 3, FieldValues::F32(vec![0.5; 9])));
    assert_eq!(written(&shape, Format::PLY).1.not_written, ["digits of `color` beyond 8 bits"]);
    // Unknown colors have no bytes.
    let shape = colored(1, Field::new("color", 3, FieldValues::F32(vec![f32::NAN; 9])));
    assert!(read(&written(&shape, Format::PLY).0, "a.ply").field("color").unwrap().get(0, 0).is_nan());
}

/// Two triangles along an edge that have different texture coordinates there; the last face has none.
const TEXTURED: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 3\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2 6 0 0 0.5 0 0 0.5\n3 2 1 3 6 0.5 1 1 0.5 1 1\n3 0 2 3 0\n";

#[test]
fn texture_coordinates_of_corners_go_from_ply_to_obj_and_back() {
    let ply = read(TEXTURED.as_bytes(), "a.ply");
    let (obj, report) = written(&ply, Format::OBJ);
    assert!(report.not_written.is_empty(), "{report:?}");
    let text = String::from_utf8(obj.clone()).unwrap();
    assert_eq!(text.matches("vt ").count(), 6);
    assert!(text.contains("\nf 1/1 2/2 3/3\nf 3/4 2/5 4/6\nf 1 3 4\n"), "{text}");
    let (back, report) = written(&read(&obj, "a.obj"), Format::PLY_ASCII);
    assert!(report.not_written.is_empty(), "{report:?}");
    let back = String::from_utf8(back).unwrap();
    assert!(back.contains("6 0 0 0.5 0 0 0.5\n") && back.contains("6 0.5 1 1 0.5 1 1\n"), "{back}");
    let binary = written(&read(&obj, "a.obj"), Format::PLY).0;
    let again = String::from_utf8(written(&read(&binary, "a.ply"), Format::OBJ).0).unwrap();
    assert!(again.contains("\nf 1/1 2/2 3/3\nf 3/4 2/5 4/6\n"), "{again}");
    // Another format still says what it lacks.
    assert_eq!(written(&ply, Format::OFF).1.not_written, ["texture coordinates of face corners"]);
}

#[test]
fn field_data_stay_in_vtk_files() {
    let vtp = "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\"><PolyData><FieldData>\
        <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">2.5</DataArray>\
        <DataArray type=\"Int32\" Name=\"size\" NumberOfTuples=\"2\" NumberOfComponents=\"3\" format=\"ascii\">\
        1 2 3 4 5 6</DataArray></FieldData>\
        <Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" \
        format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" \
        format=\"ascii\">0 1 2</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys>\
        </Piece></PolyData></VTKFile>";
    let mut file = read(vtp.as_bytes(), "a.vtp");
    for format in [Format::VTP, Format::VTU, Format::VTP] {
        let (bytes, report) = written(&file, format);
        assert!(report.not_written.is_empty(), "{report:?}");
        let text = String::from_utf8_lossy(&bytes).into_owned();
        assert!(text.contains("Name=\"TimeValue\" NumberOfTuples=\"1\""), "{text}");
        assert!(text.contains("\n2.5\n") && text.contains("\n1 2 3 4 5 6\n"), "{text}");
        file = read(&bytes, "a");
    }
    let lost = written(&file, Format::PLY).1.not_written;
    assert_eq!(lost, ["field data `TimeValue`", "field data `size`"]);
}

#[test]
fn a_ply_with_mixed_line_ends_is_written_with_one() {
    for encoding in ["ascii", "binary_little_endian"] {
        let head = format!(
            "ply\nformat {encoding} 1.0\ncomment from afar\r\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\r\nend_header\n"
        );
        let mut bytes = head.into_bytes();
        if encoding == "ascii" {
            bytes.extend_from_slice(b"0 0 0\n1 0 0\n0 1 0\n");
        } else {
            bytes.extend(
                [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()),
            );
        }
        let mut file = read(&bytes, "a.ply");
        let points = file.points().to_vec();
        file.add_vertex_field(Field::new("q", 1, FieldValues::F32(vec![1.0, 2.0, 3.0]))).unwrap();
        let (out, _) = written(&file, file.format().unwrap());
        let end = out.windows(11).position(|w| w == b"end_header\n").unwrap();
        let head = String::from_utf8(out[..end].to_vec()).unwrap();
        assert!(!head.contains('\r') && head.contains("property float z\nproperty float q\n"), "{head:?}");
        assert_eq!(read(&out, "a.ply").points(), points);
    }
}

#[test]
fn a_binary_off_may_be_little_endian() {
    for letters in ["", "N", "C"] {
        for is_little in [false, true] {
            let per_vertex = 3 + match letters {
                "N" => 3,
                "C" => 4,
                _ => 0,
            };
            let mut bytes = format!("{letters}OFF BINARY\n").into_bytes();
            let mut push = |x: [u8; 4]| {
                let reversed = [x[3], x[2], x[1], x[0]];
                bytes.extend_from_slice(if is_little { &reversed } else { &x });
            };
            for n in [5_i32, 2, 0] {
                push(n.to_be_bytes());
            }
            (0..5 * per_vertex).for_each(|k| push((k as f32 / 8.0).to_be_bytes()));
            for face in [vec![3_i32, 0, 1, 2, 0], vec![4, 1, 2, 3, 4, 0]] {
                for n in face {
                    push(n.to_be_bytes());
                }
            }
            let file = read(&bytes, "a.off");
            assert_eq!(file.n_vertices(), 5);
            assert_eq!(file.points()[1][0], f64::from(per_vertex) / 8.0, "{letters} {is_little}");
            assert_eq!(file.faces().iter().nth(1).unwrap(), [1, 2, 3, 4]);
            // An edit keeps the order.
            assert_eq!(written(&file, Format::OFF_BINARY).0, bytes);
        }
    }
}
