//! Tests of glTF and GLB: the scene is read, moved points are written in place, all other content stays.

use crate::common;

use adwave_io::{
    CoordinatePrecision, FieldValues, Format, ReadLimits, ShapeFile, read_bytes, read_path, write_bytes,
    write_path,
};
use adwave_test_data::data_test;
use base64::Engine as _;

/// Buffer in the text.
fn data(bytes: &[u8]) -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(bytes)
    )
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Triangle shown by `nodes`.
fn triangle(nodes: &str, roots: &str) -> String {
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":{roots}}}],\"nodes\":{nodes},\
         \"meshes\":[{{\"name\":\"t\",\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\"material\":0}}]}}],\
         \"materials\":[{{\"name\":\"red\",\"extras\":{{\"kept\":[1.5,true]}}}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":36}}],\"buffers\":[{{\"byteLength\":36,\"uri\":\"{}\"}}]}}",
        data(&floats(&TRIANGLE))
    )
}

fn read(text: &str) -> ShapeFile {
    try_read(text).unwrap_or_else(|e| panic!("{e}"))
}

fn try_read(text: &str) -> Result<ShapeFile, adwave_io::ReadError> {
    read_bytes(text.as_bytes().to_vec(), Some("a.gltf"), &ReadLimits::default())
}

fn written(shape: &ShapeFile, format: Format) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_bytes(shape, format, &mut bytes).unwrap();
    bytes
}

#[test]
fn nodes_put_meshes_into_the_scene() {
    let shape = read(&triangle(
        r#"[{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,-2,2]},{"mesh":0}]"#,
        "[0]",
    ));
    // The third node is in no scene.
    assert_eq!(shape.points(), [[10.0, 0.0, 0.0], [12.0, 0.0, 0.0], [10.0, -2.0, 0.0]]);
    // A reflection reverses the order of the corners.
    assert_eq!(shape.faces().iter().next().unwrap(), [0, 2, 1]);
    assert_eq!(shape.precision(), CoordinatePrecision::F64);
    assert_eq!(shape.extras(), ["1 material", "the tree of 3 nodes"]);
}

#[test]
fn what_does_not_move_stays_the_same_bytes_and_what_moves_goes_into_its_place() {
    let text = triangle(r#"[{"mesh":0,"translation":[0.1,0,0]}]"#, "[0]");
    let mut shape = read(&text);
    assert_eq!(written(&shape, Format::GLTF), text.as_bytes());
    // As a GLB and back: the same document.
    let binary = written(&shape, Format::GLB);
    let of_binary = read_bytes(binary.clone(), None, &ReadLimits::default()).unwrap();
    assert_eq!((of_binary.format(), of_binary.points()), (Some(Format::GLB), shape.points()));
    assert_eq!(written(&of_binary, Format::GLB), binary);
    let mut points = shape.points().to_vec();
    points[1][2] = 0.5;
    shape.set_points(points.clone()).unwrap();
    let again = String::from_utf8(written(&shape, Format::GLTF)).unwrap();
    let mut moved = TRIANGLE;
    moved[5] = 0.5;
    let expected =
        text.replace(&data(&floats(&TRIANGLE)), &data(&floats(&moved))).replace("[1,1,0]", "[1.0,1.0,0.5]");
    assert_eq!(again.replace("[0.0,0.0,0.0]", "[0,0,0]"), expected);
    assert_eq!(read(&again).points(), points);
}

#[test]
fn a_mesh_that_two_nodes_show_can_move_in_one() {
    let mut shape = read(&triangle(r#"[{"mesh":0},{"mesh":0,"translation":[0,0,4]}]"#, "[0,1]"));
    assert_eq!(shape.n_vertices(), 6);
    let mut points = shape.points().to_vec();
    points[5] = [7.0, 8.0, 9.0];
    shape.set_points(points.clone()).unwrap();
    for format in [Format::GLB, Format::GLTF] {
        let again = read_bytes(written(&shape, format), None, &ReadLimits::default()).unwrap();
        assert_eq!(again.points(), points, "{format}");
        assert_eq!(again.faces(), shape.faces());
        assert_eq!(again.extras(), ["1 material", "the tree of 2 nodes"]);
    }
}

#[test]
fn a_field_that_is_added_joins_each_mesh() {
    let mut shape = read(&triangle(r#"[{"mesh":0},{"mesh":0,"translation":[0,0,4]}]"#, "[0,1]"));
    let saliency = adwave_io::Field::new("saliency", 1, FieldValues::F32((0..6_u8).map(f32::from).collect()));
    shape.add_vertex_field(saliency.clone()).unwrap();
    let normal = adwave_io::Field::new("normal", 3, FieldValues::F32([0.0, 0.0, 1.0].repeat(6)));
    shape.add_vertex_field(normal.clone()).unwrap();
    let bytes = written(&shape, Format::GLB);
    let again = read_bytes(bytes, None, &ReadLimits::default()).unwrap();
    assert_eq!(again.field("saliency"), Some(&saliency));
    assert_eq!(again.field("normal"), Some(&normal));
    assert_eq!(again.points(), shape.points());
}

#[test]
fn sparse_and_quantized_positions() {
    // Row 2 is replaced; positions are bytes that represent fractions, with a stride of four bytes.
    let mut bytes = vec![0, 0, 0, 0, 255, 0, 0, 0, 0, 51, 0, 0];
    bytes.extend([2, 0, 0, 0]);
    bytes.extend([0, 255, 0]);
    let text = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"extensionsUsed\":[\"KHR_mesh_quantization\"],\
         \"extensionsRequired\":[\"KHR_mesh_quantization\"],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5121,\"normalized\":true,\"count\":3,\"type\":\"VEC3\",\
         \"sparse\":{{\"count\":1,\"indices\":{{\"bufferView\":1,\"componentType\":5121}},\"values\":{{\"bufferView\":2}}}}}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteLength\":12,\"byteStride\":4}},{{\"buffer\":0,\"byteOffset\":12,\"byteLength\":1}},\
         {{\"buffer\":0,\"byteOffset\":16,\"byteLength\":3}}],\"buffers\":[{{\"byteLength\":19,\"uri\":\"{}\"}}]}}",
        data(&bytes)
    );
    let mut shape = read(&text);
    assert_eq!(shape.points(), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(written(&shape, Format::GLTF), text.as_bytes());
    // Moved points have no representation as bytes, so they are appended.
    let points = vec![[0.0, 0.0, 0.25], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    shape.set_points(points.clone()).unwrap();
    assert_eq!(
        read_bytes(written(&shape, Format::GLB), None, &ReadLimits::default()).unwrap().points(),
        points
    );
}

#[test]
fn rows_of_a_sparse_accessor_have_unsigned_indices() {
    // The signed index is the last byte of the buffer.
    let text = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\
         \"accessors\":[{{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{{\"count\":1,\
         \"indices\":{{\"bufferView\":0,\"componentType\":5120}},\"values\":{{\"bufferView\":1}}}}}}],\
         \"bufferViews\":[{{\"buffer\":0,\"byteOffset\":12,\"byteLength\":1}},{{\"buffer\":0,\"byteLength\":12}}],\
         \"buffers\":[{{\"byteLength\":13,\"uri\":\"{}\"}}]}}",
        data(&[0; 13])
    );
    let error = try_read(&text).unwrap_err().to_string();
    assert!(error.contains("indices are not unsigned integers"), "{error}");
    assert_eq!(read(&text.replace("5120", "5121")).points(), [[0.0; 3]; 3]);
}

#[test]
fn what_cannot_be_read_is_said_in_one_line() {
    let text = triangle(r#"[{"mesh":0}]"#, "[0]");
    for (from, to, said) in [
        ("\"2.0\"", "\"1.0\"", "convert it to glTF 2.0"),
        ("\"count\":3", "\"count\":4", "needs 48 bytes, but its buffer view has 36"),
        ("\"count\":3", "\"count\":4000000000", "needs"),
        ("\"bufferView\":0,", "", "3 vertices at one place"),
        ("36,\"uri\"", "37,\"uri\"", "ends at byte 36 of 37"),
        ("5126", "5125", "no error"),
        ("5126", "7", "no known type of component"),
        ("\"VEC3\"", "\"VEC2\"", "3 numbers for a position, got 2"),
        ("[{\"mesh\":0}]", "[{\"mesh\":0,\"children\":[0]}]", "its own ancestor"),
        ("[{\"mesh\":0}]", "[{\"mesh\":3}]", "mesh 3"),
        ("\"nodes\":[0]", "\"nodes\":[5]", "node 5"),
        ("\"asset\":", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\":", "Draco"),
        ("data:application/octet-stream;base64,", "../secret", "must be in the folder of the file"),
        ("data:application/octet-stream;base64,", "file:///etc/passwd", "must be in the folder of the file"),
        ("data:application/octet-stream;base64,", "beside", "open the file by its path"),
        ("data:application/octet-stream;base64,", "data:;base64,?", "base64"),
    ] {
        assert!(text.contains(from), "{from}");
        match try_read(&text.replacen(from, to, 1)) {
            Err(error) => {
                let message = error.to_string();
                assert!(message.contains(said) && !message.contains('\n'), "{to}: {message}");
            }
            Ok(shape) => assert!(
                ["no error", "3 vertices at one place"].contains(&said) && shape.n_vertices() == 3,
                "{to}"
            ),
        }
    }
}

#[test]
fn every_cut_and_many_changed_bytes_give_a_line_or_a_shape() {
    let shape = read(&triangle(r#"[{"mesh":0},{"mesh":0,"translation":[0,0,4]}]"#, "[0,1]"));
    let whole = written(&shape, Format::GLB);
    // Fewer bytes than the magic number could be text.
    for end in 4..whole.len() {
        let error = read_bytes(whole[..end].to_vec(), Some("a.glb"), &ReadLimits::default()).unwrap_err();
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    let mut state = 7_u64;
    for _ in 0..3000 {
        let mut bytes = whole.clone();
        for _ in 0..3 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (state >> 33) as usize % bytes.len();
            bytes[at] = (state >> 20) as u8;
        }
        if let Ok(read) = read_bytes(bytes, Some("a.glb"), &ReadLimits::default()) {
            let mut moved = read.points().to_vec();
            for p in &mut moved {
                p[0] += 1.0;
            }
            let mut read = read;
            if read.set_points(moved).is_ok() {
                let _ = write_bytes(&read, Format::GLB, &mut Vec::new());
            }
        }
    }
}

#[test]
fn buffers_and_pictures_beside_the_file_go_with_it() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("tri angle.bin"), floats(&TRIANGLE)).unwrap();
    std::fs::write(folder.path().join("p.png"), b"\x89PNG not really").unwrap();
    let text = triangle(r#"[{"mesh":0}]"#, "[0]")
        .replace(&data(&floats(&TRIANGLE)), "tri%20angle.bin")
        .replace("\"materials\"", "\"images\":[{\"uri\":\"p.png\"}],\"materials\"");
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let shape = read_path(&path, &ReadLimits::default()).unwrap();
    let other = tempfile::tempdir().unwrap();
    for name in ["b.glb", "b.gltf"] {
        write_path(&shape, &other.path().join(name), None).unwrap();
        let again = read_path(&other.path().join(name), &ReadLimits::default()).unwrap();
        assert_eq!(again.points(), shape.points());
        assert_eq!(again.extras(), ["1 material", "1 picture"]);
        let bytes = std::fs::read(other.path().join(name)).unwrap();
        assert!(!String::from_utf8_lossy(&bytes).contains("p.png"));
    }
}

/// `(file, vertices, faces, edges)` as counted by trimesh and pygltflib.
const SAMPLES: &[(&str, usize, usize, usize)] = &[
    ("BoxTextured-glTF-Binary/BoxTextured.glb", 24, 12, 0),
    ("SimpleMorph/glTF/SimpleMorph.gltf", 3, 1, 0),
    ("simple_skin/simple_skin.gltf", 10, 8, 0),
];

#[data_test]
fn samples_of_others() {
    let folder = common::test_inputs().join("formats/messy/assimp/models/glTF2");
    for &(file, n_vertices, n_faces, n_edges) in SAMPLES {
        let shape = read_path(&folder.join(file), &ReadLimits::default()).unwrap();
        let found = (shape.n_vertices(), shape.faces().len(), shape.edges().pairs.len());
        assert_eq!(found, (n_vertices, n_faces, n_edges), "{file}");
    }
    // One square in each mode: points, lines, their loop and strip, triangles as strip, fan and list; without and with indices.
    let modes = [(1024, 0, 0), (8, 0, 4), (4, 0, 4), (5, 0, 4), (4, 2, 0), (4, 2, 0), (6, 2, 0)];
    for (k, expected) in modes.into_iter().enumerate() {
        let file =
            folder.join(format!("glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_{k:02}.gltf"));
        let shape = read_path(&file, &ReadLimits::default()).unwrap();
        assert_eq!((shape.n_vertices(), shape.faces().len(), shape.edges().pairs.len()), expected, "{k}");
    }
}

#[data_test]
fn pictures_give_colors_at_the_vertices() {
    let file = common::test_inputs()
        .join("formats/messy/assimp/models/glTF2/BoxTextured-glTF-Binary/BoxTextured.glb");
    let shape = read_path(&file, &ReadLimits::default()).unwrap();
    let colors = adwave_io::texture_colors(&shape, &file, None, &ReadLimits::default()).unwrap();
    assert_eq!((colors.len(), colors.n_channels), (24, 3));
    assert!(colors.to_f64().iter().all(|c| (0.0..=1.0).contains(c)));
    let none = read(&triangle(r#"[{"mesh":0}]"#, "[0]"));
    let error = adwave_io::texture_colors(&none, &file, None, &ReadLimits::default()).unwrap_err();
    assert!(error.to_string().contains("texture coordinates"), "{error}");
}
