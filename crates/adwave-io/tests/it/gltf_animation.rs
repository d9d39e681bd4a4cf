//! Tests of animations by morph targets in glTF and GLB: weights between keys, frames of the scene, errors, and frames
//! that come back after writing.

use crate::common;

use std::path::Path;

use adwave::Progress;
use adwave::shape::Polygons;
use adwave_io::{
    Field, FieldValues, Format, LengthUnit, ReadError, ReadLimits, ShapeFile, ShapeFrames, WriteError,
    read_gltf_animation, read_path, write_glb_animation,
};
use adwave_test_data::data_test;

type Point = [f64; 3];

/// Numbers of a GLB with their views and accessors.
#[derive(Clone, Default)]
struct Numbers {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Numbers {
    fn add_bytes(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (at, n) = (self.bytes.len(), bytes.len());
        self.bytes.extend_from_slice(bytes);
        self.views.push(format!("{{\"buffer\":0,\"byteOffset\":{at},\"byteLength\":{n}}}"));
        self.views.len() - 1
    }

    fn add(&mut self, values: &[f32], kind: &str) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.add_bytes(&bytes);
        let n = values.len() / if kind == "VEC3" { 3 } else { 1 };
        self.add_accessor(format!(
            "{{\"bufferView\":{view},\"componentType\":5126,\"count\":{n},\"type\":\"{kind}\"}}"
        ))
    }

    fn add_accessor(&mut self, json: String) -> usize {
        self.accessors.push(json);
        self.accessors.len() - 1
    }

    /// GLB of these numbers with other content.
    fn glb(&self, content: &str) -> Vec<u8> {
        let text = format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},{content},\"accessors\":[{}],\"bufferViews\":[{}],\
             \"buffers\":[{{\"byteLength\":{}}}]}}",
            self.accessors.join(","),
            self.views.join(","),
            self.bytes.len()
        );
        glb(&text, &self.bytes)
    }
}

fn glb(text: &str, binary: &[u8]) -> Vec<u8> {
    let mut text = text.as_bytes().to_vec();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let total = 12 + 8 + text.len() + 8 + binary.len();
    let mut bytes = b"glTF".to_vec();
    for number in [2, total as u32, text.len() as u32, 0x4e4f_534a] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(&text);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(0x004e_4942_u32.to_le_bytes());
    bytes.extend(&binary);
    bytes
}

const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
/// The first target lifts vertex 0, the second one shifts vertex 1 along x.
const LIFT: [f32; 9] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
const SHIFT: [f32; 9] = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// The triangle with both targets, shown by `node`; the animation `move` has these keys.
fn animated_triangle(node: &str, interpolation: &str, times: &[f32], weights: &[f32]) -> (Numbers, String) {
    let mut numbers = Numbers::default();
    for values in [TRIANGLE, LIFT, SHIFT] {
        numbers.add(&values, "VEC3");
    }
    numbers.add(times, "SCALAR");
    numbers.add(weights, "SCALAR");
    let content = format!(
        "\"nodes\":[{node}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\
         \"targets\":[{{\"POSITION\":1}},{{\"POSITION\":2}}]}}]}}],\
         \"animations\":[{{\"name\":\"move\",\"channels\":[{{\"sampler\":0,\"target\":{{\"node\":0,\"path\":\"weights\"}}}}],\
         \"samplers\":[{{\"input\":3,\"interpolation\":\"{interpolation}\",\"output\":4}}]}}]"
    );
    (numbers, content)
}

/// Keys at 0, 1 and 3 s.
fn linear_triangle(node: &str) -> (Numbers, String) {
    animated_triangle(node, "LINEAR", &[0.0, 1.0, 3.0], &[0.0, 0.0, 1.0, 0.0, 0.5, 1.0])
}

fn try_read(bytes: &[u8], name: Option<&str>, step: Option<f64>) -> Result<ShapeFrames, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    std::fs::write(&path, bytes).unwrap();
    read_gltf_animation(&path, name, step, &ReadLimits::default(), Progress::none())
}

fn read(bytes: &[u8], step: Option<f64>) -> ShapeFrames {
    try_read(bytes, None, step).unwrap_or_else(|e| panic!("{e}"))
}

#[track_caller]
fn assert_near(found: &[Point], expected: &[Point], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        let is_near = a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance);
        assert!(is_near, "vertex {i}: {a:?} instead of {b:?}");
    }
}

/// The triangle with these weights.
fn moved_triangle(weights: [f64; 2]) -> Vec<Point> {
    vec![[0.0, 0.0, weights[0]], [1.0 + 2.0 * weights[1], 0.0, 0.0], [0.0, 1.0, 0.0]]
}

#[test]
fn weights_between_keys_are_those_of_their_interpolation() {
    let times = [0.0, 1.0, 3.0];
    let keys = [0.0, 0.0, 1.0, 0.0, 0.5, 1.0];
    let linear = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [0.875, 0.25], [0.75, 0.5], [0.625, 0.75], [0.5, 1.0]];
    let step = [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.5, 1.0]];
    for (interpolation, expected) in [("LINEAR", linear), ("STEP", step)] {
        let (numbers, content) = animated_triangle("{\"mesh\":0}", interpolation, &times, &keys);
        let read = read(&numbers.glb(&content), Some(0.5));
        assert_eq!((read.step, read.frames.len()), (0.5, 7), "{interpolation}");
        for (frame, weights) in read.frames.iter().zip(expected) {
            assert_near(frame, &moved_triangle(weights), 1e-12);
        }
        assert_eq!(read.notes, Vec::<String>::new());
        assert_eq!(read.shape.points(), read.frames[0]);
        assert_eq!(read.shape.faces().iter().collect::<Vec<_>>(), [[0, 1, 2]]);
    }
    // Keys at 0 and 2 s, each with the tangents before it, the weights, and the tangents after it.
    let spline = [9.0, 9.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 1.0, 1.0, 9.0, 9.0];
    let (numbers, content) = animated_triangle("{\"mesh\":0}", "CUBICSPLINE", &[0.0, 2.0], &spline);
    let read = read(&numbers.glb(&content), Some(0.5));
    // With u = t / 2: 3u² − 2u³ + 2 (u³ − 2u² + u), and 3u² − 2u³ + 4 (u³ − u²) for the second target.
    let expected = [[0.0, 0.0], [0.4375, -0.03125], [0.75, 0.0], [0.9375, 0.28125], [1.0, 1.0]];
    assert_eq!(read.frames.len(), 5);
    for (frame, weights) in read.frames.iter().zip(expected) {
        assert_near(frame, &moved_triangle(weights), 1e-12);
    }
}

#[test]
fn without_a_step_frames_are_the_mean_distance_of_keys_apart() {
    let (numbers, content) = linear_triangle("{\"mesh\":0}");
    let read = read(&numbers.glb(&content), None);
    assert_eq!((read.step, read.frames.len()), (1.5, 3));
    assert_near(&read.frames[1], &moved_triangle([0.875, 0.25]), 1e-12);
    let note = "frames are 1.5 s apart, the mean distance between the 3 keys, which are not at even times";
    assert_eq!(read.notes, [note]);
    // Steps of keys at 30 Hz are reached although 32-bit floats round their times.
    let times: Vec<f32> = (1..=200).map(|k| k as f32 / 30.0).collect();
    let weights: Vec<f32> = (0..400_u16).map(f32::from).collect();
    let (numbers, content) = animated_triangle("{\"mesh\":0}", "STEP", &times, &weights);
    let read = read_even(&numbers.glb(&content));
    for (k, frame) in read.frames.iter().enumerate() {
        assert_near(frame, &moved_triangle([2.0 * k as f64, 2.0 * k as f64 + 1.0]), 0.0);
    }
}

fn read_even(bytes: &[u8]) -> ShapeFrames {
    let read = read(bytes, None);
    assert_eq!(read.frames.len(), 200);
    assert_eq!(read.notes, ["frames are 0.0333333 s apart, the mean distance between the 200 keys"]);
    read
}

#[test]
fn the_last_frame_is_before_the_last_key_if_the_step_says_so() {
    let (numbers, content) = linear_triangle("{\"mesh\":0}");
    let read = read(&numbers.glb(&content), Some(2.0));
    assert_eq!(read.frames.len(), 2);
    assert_near(&read.frames[1], &moved_triangle([0.75, 0.5]), 1e-12);
    assert_eq!(read.notes, ["the last frame is at 2 s, before the last key at 3 s"]);
}

#[test]
fn nodes_transform_displacements_and_each_has_its_weights() {
    // A quarter turn about z, a scaling with a reflection, a translation; then the same mesh at rest, and lifted.
    let nodes = "{\"mesh\":0,\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],\"scale\":[2,3,-4],\
                 \"translation\":[10,20,30]},{\"mesh\":0},{\"mesh\":0,\"weights\":[0.5,0],\"translation\":[0,0,7]}";
    let (numbers, content) = linear_triangle(nodes);
    let content = content.replace("\"meshes\":[{", "\"meshes\":[{\"weights\":[0,1],");
    let bytes = numbers.glb(&content);
    let read = read(&bytes, Some(1.0));
    assert_eq!(read.frames.len(), 4);
    for (frame, weights) in read.frames.iter().zip([[0.0, 0.0], [1.0, 0.0], [0.75, 0.5], [0.5, 1.0]]) {
        let place = |p: Point| [10.0 - 3.0 * p[1], 20.0 + 2.0 * p[0], 30.0 - 4.0 * p[2]];
        let mut expected: Vec<Point> = moved_triangle(weights).into_iter().map(place).collect();
        expected.extend(moved_triangle([0.0, 1.0]));
        expected.extend(moved_triangle([0.5, 0.0]).into_iter().map(|p| [p[0], p[1], p[2] + 7.0]));
        assert_near(frame, &expected, 1e-12);
    }
    assert_eq!(read.shape.points(), read.frames[0]);
    let plain = adwave_io::read_bytes(bytes, None, &ReadLimits::default()).unwrap();
    assert_eq!(read.shape.faces(), plain.faces());
    assert_near(&read.frames[0][..3], &plain.points()[..3], 0.0);
}

#[test]
fn targets_may_be_sparse_or_integers_and_some_meshes_have_none() {
    let (mut numbers, content) = linear_triangle("{\"mesh\":0},{\"mesh\":1}");
    let rows = numbers.add_bytes(&[0]);
    let lift: Vec<u8> = LIFT[..3].iter().flat_map(|x| x.to_le_bytes()).collect();
    let lift = numbers.add_bytes(&lift);
    numbers.accessors[1] = format!(
        "{{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{{\"count\":1,\
         \"indices\":{{\"bufferView\":{rows},\"componentType\":5121}},\"values\":{{\"bufferView\":{lift}}}}}}}"
    );
    // Bytes that represent fractions: 127 is 1, half of the shift.
    let shift = numbers.add_bytes(&[0, 0, 0, 127, 0, 0, 0, 0, 0]);
    numbers.accessors[2] = format!(
        "{{\"bufferView\":{shift},\"componentType\":5120,\"normalized\":true,\"count\":3,\"type\":\"VEC3\"}}"
    );
    let content = content.replace(
        "}]}],\"animations\"",
        "}]},{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"animations\"",
    );
    let read = read(&numbers.glb(&content), Some(1.0));
    for (frame, weights) in read.frames.iter().zip([[0.0, 0.0], [1.0, 0.0], [0.75, 0.25], [0.5, 0.5]]) {
        assert_near(&frame[..3], &moved_triangle(weights), 1e-12);
        assert_near(&frame[3..], &moved_triangle([0.0, 0.0]), 0.0);
    }
}

#[test]
fn notes_say_what_was_chosen_and_what_is_not_applied() {
    let (numbers, content) = linear_triangle("{\"mesh\":0,\"skin\":0},{}");
    let turn = "{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"rotation\"}}";
    let content = content
        .replace(
            "\"channels\":[",
            &format!(
                "\"channels\":[{turn},{{\"sampler\":0,\"target\":{{\"node\":1,\"path\":\"weights\"}}}},"
            ),
        )
        .replace("\"animations\":[", &format!("\"animations\":[{{\"channels\":[{turn}]}},"));
    let bytes = numbers.glb(&content);
    let read = read(&bytes, Some(1.0));
    assert_eq!(
        read.notes,
        [
            "the file has 2 animations, and the first one with weights was read: `move`",
            "channels of weights without morph targets in the scene, which move nothing: 1",
            "the animation of rotation is not applied; nodes keep their transforms",
            "skins are not applied; their meshes are moved by morph targets alone",
        ]
    );
    let named = try_read(&bytes, Some("move"), Some(1.0)).unwrap();
    assert_eq!(named.frames, read.frames);
    let error = try_read(&bytes, Some("walk"), None).unwrap_err().to_string();
    assert!(error.ends_with("no animation `walk`; choose one of number 0 without a name, `move`"), "{error}");
}

#[test]
fn what_is_malformed_is_an_error_of_one_line() {
    let (numbers, content) = linear_triangle("{\"mesh\":0}");
    for (from, to, said) in [
        ("\"animations\"", "\"others\"", "must have an animation, got none"),
        (
            "\"path\":\"weights\"",
            "\"path\":\"scale\"",
            "one of `move` must have a channel of weights, got none",
        ),
        ("\"node\":0", "\"node\":1", "names node 1, but there are 1"),
        ("\"sampler\":0", "\"sampler\":1", "must name one of 1 samplers"),
        ("\"input\":3", "\"input\":9", "accessor 9 is referenced but does not exist"),
        ("\"output\":4,", "", "has no output"),
        ("\"input\":3", "\"input\":0", "must have increasing times, got 0 s at key 0 and 0 s at key 1"),
        ("\"output\":4", "\"output\":3", "one weight for each of 3 keys and 2 targets, got 3 weights"),
        ("LINEAR", "CUBICSPLINE", "must have 3 times one weight for each of 3 keys and 2 targets, got 6"),
        ("LINEAR", "SMOOTH", "must interpolate by LINEAR, STEP or CUBICSPLINE"),
        ("\"POSITION\":2", "\"POSITION\":3", "must have 3 numbers for a position|needs 3 numbers"),
        ("\"POSITION\":2", "\"POSITION\":4", "must have 3 displacements, one per vertex, got 6"),
        ("\"POSITION\":2", "\"POSITION\":22", "accessor 22 is referenced but does not exist"),
        (
            ",\"targets\":[{\"POSITION\":1},{\"POSITION\":2}]",
            "",
            "must set weights of a mesh with morph targets",
        ),
        ("\"mesh\":0", "\"mesh\":0,\"weights\":[1]", "must be 2 finite numbers, one per morph target, got 1"),
        (
            "\"primitives\":[",
            "\"primitives\":[{\"attributes\":{\"POSITION\":0}},",
            "share their vertices and must share their morph targets",
        ),
        (
            "\"primitives\":[",
            "\"primitives\":[{\"attributes\":{\"POSITION\":1},\"targets\":[{}]},",
            "must have the same number of morph targets, got 1 and 2",
        ),
        (
            "\"channels\":[",
            "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}},",
            "sets the weights of node 0 again",
        ),
    ] {
        let changed = content.replace(from, to).replace("\"output\":4}", "\"output\":4,\"x\":0}");
        let changed = if said == "has no output" { changed.replace("\"output\":4,", "") } else { changed };
        let error = try_read(&numbers.glb(&changed), None, None).map(|read| read.frames).unwrap_err();
        let message = error.to_string();
        assert!(said.split('|').any(|said| message.contains(said)), "{from} to {to}: {message}");
        assert!(
            !message.contains('\n') && message.contains("a.glb: ") && message.contains("; "),
            "{message}"
        );
    }
}

#[test]
fn keys_and_steps_that_give_no_frames_are_errors() {
    let nan = f32::NAN;
    for (times, weights, step, said) in [
        (&[0.0, nan, 3.0][..], &[0.0; 6][..], None, "must have finite times, got NaN at key 1"),
        (&[0.0, 3.0, 1.0], &[0.0; 6], None, "must have increasing times, got 3 s at key 1 and 1 s at key 2"),
        (&[0.0, 1.0, 1.0], &[0.0; 6], None, "must have increasing times, got 1 s at key 1 and 1 s at key 2"),
        (&[0.0, 1.0], &[0.0, 0.0, nan, 0.0], None, "must have finite weights, got NaN at place 2"),
        (&[], &[], None, "must have keys, got none"),
        (&[2.0], &[1.0, 1.0], None, "at least two frames, got one between the keys at 2 s and 2 s"),
        (&[2.0], &[1.0, 1.0], Some(0.1), "at least two frames, got one between the keys at 2 s and 2 s"),
        (&[0.0, 1.0], &[0.0; 4], Some(1.5), "at least two frames, got one"),
        (&[0.0, 1.0], &[0.0; 4], Some(0.0), "the step must be positive and finite, got 0"),
        (&[0.0, 1.0], &[0.0; 4], Some(f64::NAN), "the step must be positive and finite, got NaN"),
        (&[0.0, 1.0], &[0.0; 4], Some(1e-300), "exceeds the limit"),
        (&[0.0, 1.0], &[0.0; 4], Some(1e-12), "exceeds the limit"),
    ] {
        let (numbers, content) = animated_triangle("{\"mesh\":0}", "LINEAR", times, weights);
        let error = try_read(&numbers.glb(&content), None, step).unwrap_err().to_string();
        assert!(error.contains(said) && !error.contains('\n'), "{error}");
    }
    // A displacement that is not finite, as soon as it takes part.
    let (mut numbers, content) = linear_triangle("{\"mesh\":0}");
    let broken = numbers.add(&[0.0, 0.0, nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], "VEC3");
    let bytes = numbers.glb(&content.replace("\"POSITION\":1", &format!("\"POSITION\":{broken}")));
    let error = try_read(&bytes, None, None).unwrap_err().to_string();
    assert!(error.contains("vertex 0 must be at a finite position in frame 1"), "{error}");
    // Another format.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let error = read_gltf_animation(&path, None, None, &ReadLimits::default(), Progress::none()).unwrap_err();
    assert!(error.to_string().contains("must be in a glTF or GLB, got Wavefront OBJ"), "{error}");
}

#[test]
fn every_cut_and_every_changed_byte_give_a_line_or_frames() {
    let (mut numbers, content) = linear_triangle("{\"mesh\":0}");
    let rows = numbers.add_bytes(&[0]);
    numbers.accessors[1] = format!(
        "{{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"sparse\":{{\"count\":1,\
         \"indices\":{{\"bufferView\":{rows},\"componentType\":5121}},\"values\":{{\"bufferView\":1}}}}}}"
    );
    let whole = numbers.glb(&content);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let limits = ReadLimits { max_bytes: 1 << 20, ..ReadLimits::default() };
    let try_bytes = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        read_gltf_animation(&path, None, None, &limits, Progress::none())
    };
    assert_eq!(try_bytes(&whole).unwrap().frames.len(), 3);
    for end in 0..whole.len() {
        let error = try_bytes(&whole[..end]).unwrap_err().to_string();
        assert!(!error.contains('\n'), "{error}");
    }
    for at in 0..whole.len() {
        for change in [0x01, 0x10, 0x80] {
            let mut bytes = whole.clone();
            bytes[at] ^= change;
            match try_bytes(&bytes) {
                Ok(read) => {
                    let n = read.shape.n_vertices();
                    assert!(read.frames.len() >= 2 && read.frames.iter().all(|frame| frame.len() == n));
                }
                Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
            }
        }
    }
}

/// A square with a field, and frames that bend it, at `origin`.
fn bending_square(origin: Point) -> (ShapeFile, Vec<Vec<Point>>) {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let frame = |t: f64| {
        let point = |[x, y]: [f64; 2]| {
            [origin[0] + x + 0.1 * t * y, origin[1] + y, origin[2] + (t * (1.0 + x) + y).sin()]
        };
        corners.map(point).to_vec()
    };
    let frames: Vec<Vec<Point>> = (0..6).map(|k| frame(0.3 * f64::from(k))).collect();
    let mut faces = Polygons::new();
    faces.push(&[0, 1, 2, 3]);
    let mut shape = ShapeFile::from_mesh(frames[0].clone(), faces);
    let heat = Field::new("heat", 1, FieldValues::F32(vec![1.0, 2.0, 3.0, 4.0]));
    shape.add_vertex_field(heat).unwrap();
    (shape, frames)
}

fn write(
    path: &Path,
    shape: &ShapeFile,
    frames: &[Vec<Point>],
    step: f64,
) -> Result<adwave_io::WriteReport, WriteError> {
    write_glb_animation(path, shape, frames, step, Progress::none())
}

#[test]
fn frames_come_back_after_writing() {
    let folder = tempfile::tempdir().unwrap();
    // Far from the origin a node keeps the digits.
    for (name, origin, tolerance) in
        [("a.glb", [0.0; 3], 1e-6), ("b.glb.gz", [4_512_345.123, 5_401_234.456, 312.0], 1e-6)]
    {
        let path = folder.path().join(name);
        let (shape, frames) = bending_square(origin);
        let report = write(&path, &shape, &frames, 0.04).unwrap();
        assert!(report.not_written.contains(&"polygons (as triangles)".to_owned()), "{report:?}");
        let read = read_gltf_animation(&path, Some("frames"), None, &ReadLimits::default(), Progress::none());
        let read = read.unwrap();
        assert_eq!(read.frames.len(), frames.len());
        assert!((read.step - 0.04).abs() < 1e-8, "{}", read.step);
        assert_eq!(read.notes, ["frames are 0.04 s apart, the mean distance between the 6 keys"]);
        for (a, b) in read.frames.iter().zip(&frames) {
            assert_near(a, b, tolerance);
        }
        let plain = read_path(&path, &ReadLimits::default()).unwrap();
        assert_eq!(plain.points(), read.frames[0]);
        assert_eq!(plain.faces(), read.shape.faces());
        assert_eq!((plain.faces().len(), plain.field("heat")), (2, shape.field("heat")));
        assert_eq!(plain.extras(), ["1 animation", "morph targets"]);
        // Written again, the numbers stay.
        let again = folder.path().join("again.glb");
        write(&again, &read.shape, &read.frames, read.step).unwrap();
        let again =
            read_gltf_animation(&again, None, None, &ReadLimits::default(), Progress::none()).unwrap();
        for (a, b) in again.frames.iter().zip(&read.frames) {
            assert_near(a, b, tolerance);
        }
        assert_eq!(again.shape.faces(), read.shape.faces());
    }
}

#[test]
fn numbers_of_the_animation_have_their_bounds_and_no_target_of_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let (shape, frames) = bending_square([0.0; 3]);
    write(&path, &shape, &frames[..2], 0.5).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let n = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + n]).unwrap();
    let sampler = &json["animations"][0]["samplers"][0];
    let accessor = |index: &serde_json::Value| &json["accessors"][index.as_u64().unwrap() as usize];
    let view = |accessor: &serde_json::Value| {
        &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize]
    };
    let (times, weights) = (accessor(&sampler["input"]), accessor(&sampler["output"]));
    assert_eq!((&times["min"][0], &times["max"][0]), (&0.0.into(), &0.5.into()));
    assert_eq!((&times["count"], &weights["count"]), (&2.into(), &2.into()));
    assert!(view(times)["target"].is_null() && view(weights)["target"].is_null());
    let primitive = &json["meshes"][0]["primitives"][0];
    let target = accessor(&primitive["targets"][0]["POSITION"]);
    assert_eq!(view(target)["target"], 34962);
    // The displacement of vertex 2 along x is the largest one.
    let displacement = f64::from((frames[1][2][0] - 1.0) as f32);
    assert!((target["max"][0].as_f64().unwrap() - displacement).abs() < 1e-7);
    assert_eq!(target["min"][1], 0.0);
    assert_eq!(json["meshes"][0]["weights"], serde_json::json!([0]));
}

#[test]
fn lengths_are_converted_in_all_frames() {
    let folder = tempfile::tempdir().unwrap();
    let source = folder.path().join("a.amf");
    let (shape, frames) = bending_square([0.0; 3]);
    adwave_io::write_path(&shape, &source, Some(Format::AMF)).unwrap();
    let shape = read_path(&source, &ReadLimits::default()).unwrap();
    assert_eq!(shape.length_unit(), Some(&LengthUnit::MILLIMETER));
    let path = folder.path().join("a.glb");
    let report = write(&path, &shape, &frames, 1.0).unwrap();
    assert_eq!(report.notes.iter().filter(|note| note.contains("from millimeters to meters")).count(), 1);
    let read = read_gltf_animation(&path, None, None, &ReadLimits::default(), Progress::none()).unwrap();
    for (a, b) in read.frames.iter().zip(&frames) {
        let meters: Vec<Point> = b.iter().map(|p| p.map(|c| c / 1000.0)).collect();
        assert_near(a, &meters, 1e-9);
    }
}

#[test]
fn what_is_no_animation_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    std::fs::write(&path, "before").unwrap();
    let (shape, frames) = bending_square([0.0; 3]);
    let mut short = frames.clone();
    short[2].pop();
    let mut broken = frames.clone();
    broken[3][1][2] = f64::NAN;
    let mut large = frames.clone();
    large[4][0][0] = 1e39;
    let none = ShapeFile::from_cloud(Vec::new());
    for (shape, frames, step, said) in [
        (&shape, &frames[..1], 1.0, "at least two frames, got 1"),
        (&shape, &short[..], 1.0, "frame 2 must have 4 positions, one per vertex, got 3"),
        (&shape, &broken[..], 1.0, "vertex 1 must be at a finite position in frame 3"),
        (&shape, &large[..], 1.0, "coordinates of frame 4 beyond 3.4e38"),
        (&shape, &frames[..], 0.0, "the step must be positive and finite in 32-bit floats, got 0"),
        (&shape, &frames[..], -1.0, "the step must be positive and finite in 32-bit floats, got -1"),
        (&shape, &frames[..], f64::INFINITY, "the step must be positive and finite"),
        (&shape, &frames[..], 1e-60, "the step must be positive and finite"),
        (&none, &[Vec::new(), Vec::new()][..], 1.0, "must have vertices, got none"),
    ] {
        let error = write(&path, shape, frames, step).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("a.glb: ") && !error.contains('\n'), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), b"before");
    }
    let error = write(&folder.path().join("a.obj"), &shape, &frames, 1.0).unwrap_err().to_string();
    assert!(error.contains("obj cannot store an animation of morph targets"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_cancelled_call_ends() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let progress = Progress::none().with_cancel(&stop);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    let (shape, frames) = bending_square([0.0; 3]);
    let error = write_glb_animation(&path, &shape, &frames, 1.0, progress).unwrap_err();
    assert!(error.to_string().contains("stopped on request") && !path.exists(), "{error}");
    write(&path, &shape, &frames, 1.0).unwrap();
    let error = read_gltf_animation(&path, None, None, &ReadLimits::default(), progress).unwrap_err();
    assert!(error.to_string().contains("stopped on request"), "{error}");
}

/// A GLB whose accessors all are floats without a stride.
struct PlainGlb {
    json: serde_json::Value,
    binary: Vec<u8>,
}

impl PlainGlb {
    fn new(bytes: &[u8]) -> Self {
        let n = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        Self { json: serde_json::from_slice(&bytes[20..20 + n]).unwrap(), binary: bytes[28 + n..].to_vec() }
    }

    fn floats(&self, accessor: &serde_json::Value) -> Vec<f64> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        assert!(accessor["componentType"] == 5126 && view["byteStride"].is_null());
        let n = accessor["count"].as_u64().unwrap() as usize * if accessor["type"] == "VEC3" { 3 } else { 1 };
        let start = [view, accessor].map(|json| json["byteOffset"].as_u64().unwrap_or(0) as usize);
        let bytes = &self.binary[start[0] + start[1]..][..4 * n];
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap()).into()).collect()
    }
}

#[data_test]
fn frames_of_a_sample_are_its_targets_times_its_weights() {
    let path = common::test_inputs().join("domains/animation/morph-stress-test.glb");
    let glb = PlainGlb::new(&std::fs::read(&path).unwrap());
    let plain = read_path(&path, &ReadLimits::default()).unwrap();
    for (k, (name, n_keys)) in [("Individuals", 281), ("TheWave", 59), ("Pulse", 191)].into_iter().enumerate()
    {
        let read =
            read_gltf_animation(&path, Some(name), None, &ReadLimits::default(), Progress::none()).unwrap();
        assert_eq!((read.frames.len(), read.shape.n_vertices()), (n_keys, 1528), "{name}");
        assert!((read.step - 1.0 / 30.0).abs() < 1e-6, "{}", read.step);
        assert_eq!(read.shape.faces(), plain.faces());
        assert_eq!(read.shape.points(), read.frames[0]);
        let weights = glb.floats(&glb.json["animations"][k]["samplers"][0]["output"]);
        let mut most = 0.0_f64;
        for frame in [0, n_keys / 7, n_keys / 3, n_keys / 2, n_keys - 2, n_keys - 1] {
            let mut expected = Vec::new();
            for primitive in glb.json["meshes"][0]["primitives"].as_array().unwrap() {
                let mut points = glb.floats(&primitive["attributes"]["POSITION"]);
                for (target, w) in primitive["targets"].as_array().unwrap().iter().zip(&weights[8 * frame..])
                {
                    let displacements = glb.floats(&target["POSITION"]);
                    points.iter_mut().zip(displacements).for_each(|(p, d)| *p += w * d);
                }
                expected.extend(points.as_chunks::<3>().0.iter().copied());
            }
            // Frames are at even times, and the file's keys where 32-bit floats round them to.
            assert_near(&read.frames[frame], &expected, 1e-4);
            let moves = expected.iter().zip(plain.points()).map(|(a, b)| (a[1] - b[1]).abs());
            most = moves.fold(most, f64::max);
        }
        assert!(most > 0.1, "{name}: {most}");
    }
    let first = read_gltf_animation(&path, None, None, &ReadLimits::default(), Progress::none()).unwrap();
    assert_eq!(first.frames.len(), 281);
    assert!(first.notes[0].contains("has 3 animations"), "{:?}", first.notes);
    let error = read_gltf_animation(&path, Some("Jump"), None, &ReadLimits::default(), Progress::none());
    let error = error.unwrap_err().to_string();
    assert!(
        error.ends_with("no animation `Jump`; choose one of `Individuals`, `TheWave`, `Pulse`"),
        "{error}"
    );
}
