//! Writer of frames: a mesh with one morph target per frame, and the weights that play them.

use std::io::Write;

use adwave::Progress;

use super::super::document::Document;
use super::super::json::{Json, object};
use super::super::matrix::point;
use super::super::read::parts;
use super::super::write::{EncodedRows, NumberBuffer, VERTICES, finish, positions};
use crate::model::f32_limits::check_range;
use crate::progress::collect;
use crate::{Format, ReadError, ReadLimits, ShapeFile, ValueType, WriteError};

/// Checks that the frames are an animation of the shape.
pub(crate) fn check_frames(
    shape: &ShapeFile,
    frames: &[Vec<[f64; 3]>],
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let n = shape.n_vertices;
    if frames.len() < 2 {
        return Err(WriteError::Frames(format!(
            "an animation must have at least two frames, got {}; give all frames, or write the shape alone",
            frames.len()
        )));
    }
    if n == 0 {
        return Err(WriteError::Frames(
            "an animation must have vertices, got none; give a shape with vertices".into(),
        ));
    }
    for (k, frame) in frames.iter().enumerate() {
        if frame.len() != n {
            return Err(WriteError::Frames(format!(
                "frame {k} must have {n} positions, one per vertex, got {}; give each frame the vertices of the shape",
                frame.len()
            )));
        }
        let is_finite = |i: usize| frame[i].iter().all(|c| c.is_finite());
        if !crate::progress::all(n, progress, is_finite)? {
            let vertex = (0..n).find(|&i| !is_finite(i)).unwrap_or(0);
            return Err(WriteError::Frames(format!(
                "vertex {vertex} must be at a finite position in frame {k}, got {:?}; correct it or leave the frame \
                 out",
                frame[vertex]
            )));
        }
    }
    Ok(())
}

/// Times of the frames in seconds, from 0 on.
pub(crate) fn key_times(n_frames: usize, step: f64) -> Result<Vec<f32>, WriteError> {
    let times: Vec<f32> = (0..n_frames).map(|k| (k as f64 * step) as f32).collect();
    let increases = times.windows(2).all(|pair| pair[0] < pair[1]);
    if step.is_finite() && increases && times.iter().all(|t| t.is_finite()) {
        return Ok(times);
    }
    Err(WriteError::Frames(format!(
        "the step must be positive and finite in 32-bit floats, got {step}; give the seconds from frame to frame"
    )))
}

/// Number of bytes of a binary glTF, at most.
const MOST_BYTES: u64 = u32::MAX as u64;

/// Checks that the targets and weights of the frames fit into a binary glTF.
pub(crate) fn check_size(n_frames: usize, n_vertices: usize) -> Result<(), WriteError> {
    let (n, n_targets) = (n_vertices as u64, n_frames as u64 - 1);
    let n_bytes = n_targets.saturating_mul(12 * n + 4 * (n_targets + 1));
    if n_bytes > MOST_BYTES {
        let what = format!("{n_frames} frames of {n} vertices, which take more than 4 GiB");
        return Err(WriteError::CannotHold { format: Format::GLB, what });
    }
    Ok(())
}

/// Frames with their times in seconds, and the factor from their coordinates to those of the file.
pub(crate) struct FramesInScene<'a> {
    pub(crate) frames: &'a [Vec<[f64; 3]>],
    pub(crate) times: &'a [f32],
    pub(crate) ratio: f64,
}

/// Writes a GLB of the first frame again, with the other frames as morph targets.
pub(crate) fn write_frames(
    glb: Vec<u8>,
    scene: &FramesInScene<'_>,
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let (format, quiet) = (Format::GLB, progress.quiet());
    let limits = ReadLimits { max_bytes: u64::MAX, max_points: u64::from(u32::MAX) };
    let document = Document::parse(glb, None, &limits, quiet).map_err(to_write_error)?;
    let base = written_points(&document, &limits, quiet).map_err(to_write_error)?;
    let mut numbers = NumberBuffer {
        bytes: document.buffer(0).unwrap_or_default().to_vec(),
        n_views: document.json.list_of("bufferViews").len(),
        n_accessors: document.json.list_of("accessors").len(),
        ..NumberBuffer::default()
    };
    let mut json = document.json;
    let mut targets = Vec::new();
    for (k, frame) in scene.frames.iter().enumerate().skip(1) {
        progress.step(k as u64, scene.frames.len() as u64)?;
        let coordinate = |i: usize| scene.ratio * frame[i / 3][i % 3];
        let displacement = |i: usize| coordinate(i) - base[i / 3][i % 3];
        let n = 3 * frame.len();
        check_range(format, &format!("coordinates of frame {k}"), n, quiet, coordinate)?;
        check_range(format, &format!("displacements of frame {k}"), n, quiet, displacement)?;
        let row = |i: usize| std::array::from_fn::<f32, 3, _>(|c| displacement(3 * i + c) as f32);
        let (rows, range) = positions(&collect(frame.len(), quiet, row)?, quiet)?;
        targets.push(object([("POSITION", numbers.add(&rows, VERTICES, Some(range)).into())]));
    }
    let input = add_scalars(&mut numbers, scene.times);
    let output = add_scalars(&mut numbers, &key_weights(scene.frames.len()));
    add_animation(&mut json, &targets, input, output);
    for (key, added) in [("bufferViews", numbers.views), ("accessors", numbers.accessors)] {
        if let Some(list) = json.list_mut(key) {
            list.extend(added);
        }
    }
    finish(json, vec![numbers.bytes], format, out, progress)
}

fn to_write_error(error: ReadError) -> WriteError {
    match error {
        ReadError::Cancelled(e) => e.into(),
        other => WriteError::Io(std::io::Error::other(other.to_string())),
    }
}

/// Positions of the vertices as readers get them, rounded to 32-bit floats.
fn written_points(
    document: &Document,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, ReadError> {
    let mut points = Vec::new();
    for part in parts(document, limits)? {
        let matrix = part.instance.matrix;
        part.positions.append_points(document, &mut points, |p| point(&matrix, p), progress)?;
    }
    Ok(points)
}

/// Weights of all targets at each key: none at the first one, and that of the frame at the others.
fn key_weights(n_frames: usize) -> Vec<f32> {
    let n_targets = n_frames - 1;
    let mut weights = vec![0.0; n_frames * n_targets];
    for k in 0..n_targets {
        weights[(k + 1) * n_targets + k] = 1.0;
    }
    weights
}

/// Appends numbers of an animation with their range, and returns the index of their accessor.
fn add_scalars(numbers: &mut NumberBuffer, values: &[f32]) -> usize {
    let rows = EncodedRows {
        bytes: values.iter().flat_map(|x| x.to_le_bytes()).collect(),
        count: values.len(),
        n_channels: 1,
        value_type: ValueType::F32,
        is_normalized: false,
    };
    let index = numbers.add(&rows, VERTICES, None);
    if let Some(view) = numbers.views.last_mut() {
        // Only numbers of vertices and faces have a target.
        view.remove("target");
    }
    if let Some(accessor) = numbers.accessors.last_mut() {
        let low = values.iter().copied().fold(f32::INFINITY, f32::min);
        let high = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        accessor.set("min", Json::List(vec![Json::from_number(low.into())]));
        accessor.set("max", Json::List(vec![Json::from_number(high.into())]));
    }
    index
}

/// Adds targets to the mesh, and the animation of their weights.
fn add_animation(json: &mut Json, targets: &[Json], input: usize, output: usize) {
    let mesh = json.list_mut("meshes").and_then(|meshes| meshes.first_mut());
    if let Some(mesh) = mesh {
        mesh.set("weights", Json::List(vec![0.into(); targets.len()]));
        for primitive in mesh.list_mut("primitives").into_iter().flatten() {
            primitive.set("targets", Json::List(targets.to_vec()));
        }
    }
    let target = object([("node", 0.into()), ("path", "weights".into())]);
    let channel = object([("sampler", 0.into()), ("target", target)]);
    let sampler =
        object([("input", input.into()), ("interpolation", "LINEAR".into()), ("output", output.into())]);
    let animation = object([
        ("name", "frames".into()),
        ("channels", Json::List(vec![channel])),
        ("samplers", Json::List(vec![sampler])),
    ]);
    json.set("animations", Json::List(vec![animation]));
}
