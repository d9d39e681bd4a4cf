//! Frames of an animation: the scene at even times.

use std::collections::BTreeMap;

use adwave::Progress;
use rayon::prelude::*;

use super::super::accessor::Accessor;
use super::super::document::Document;
use super::super::json::Json;
use super::super::matrix::{AffineMatrix, IDENTITY, point};
use super::super::read::VertexGroup;
use super::super::update::GltfSource;
use super::channels::{animated_nodes, choose_animation};
use super::rounded_text;
use super::sampler::{MemoryCounter, WeightTrack};
use crate::{ReadError, ReadLimits, ShapeFile};

/// Frames of a shape that moves: positions at even times.
#[derive(Clone, Debug)]
pub struct ShapeFrames {
    /// The shape at the first frame, with all other content of its file.
    pub shape: ShapeFile,
    /// Positions of each frame in the order of the vertices of the shape.
    pub frames: Vec<Vec<[f64; 3]>>,
    /// Seconds from frame to frame.
    pub step: f64,
    /// Remarks on assumptions, one line each.
    pub notes: Vec<String>,
}

/// Times of the frames in seconds.
struct FrameTimes {
    first: f64,
    last: f64,
    step: f64,
    n_frames: usize,
}

impl FrameTimes {
    fn time(&self, frame: usize) -> f64 {
        (self.first + frame as f64 * self.step).min(self.last)
    }
}

/// Frames of a shape that was read from a glTF; see [`read_gltf_animation`](crate::read_gltf_animation).
pub(crate) fn frames_of_shape(
    mut shape: ShapeFile,
    name: Option<&str>,
    step: Option<f64>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFrames, ReadError> {
    // Vertices without a position may have been left out of the file.
    let whole = shape.outermost().unwrap_or(&shape);
    let Some(source) = whole.source::<GltfSource>() else {
        let found = shape.format.map_or("another format", |format| format.title());
        return Err(ReadError::Whole(format!(
            "an animation of morph targets must be in a glTF or GLB, got {found}; convert it to GLB"
        )));
    };
    let mut notes = Vec::new();
    let animation = choose_animation(source.document.json.list_of("animations"), name, &mut notes)?;
    let mut memory = MemoryCounter::new(limits);
    let animated = animated_nodes(source, animation, &mut memory, progress)?;
    notes.extend(animated.notes);
    let times = frame_times(&animated.tracks, step, &mut notes)?;
    memory.add(times.n_frames, (whole.n_vertices as u64).saturating_mul(24).saturating_add(24))?;
    let frames = vec![whole.points().to_vec(); times.n_frames];
    let step = times.step;
    let mut builder = FrameBuilder { document: &source.document, times, frames, memory, progress };
    for (k, part) in source.parts.iter().enumerate() {
        progress.step(k as u64, source.parts.len() as u64)?;
        let track = part.instance.node.and_then(|node| animated.tracks.get(&node));
        builder.move_part(part, track)?;
    }
    let mut frames = builder.frames;
    check_finite(whole.points(), &frames, progress)?;
    if let Some(rows) = shape.file_rows() {
        let kept = rows.vertex_rows();
        for frame in &mut frames {
            *frame = kept.iter().map(|&row| frame[row as usize]).collect();
        }
    }
    // Vertices without a position stay so.
    let stays = |(a, b): (&[f64; 3], &[f64; 3])| a == b || a.iter().any(|c| c.is_nan());
    if !shape.points().iter().zip(&frames[0]).all(stays) {
        if shape.field("normal").or_else(|| shape.field("tangent")).is_some() {
            notes.push("normals and tangents are those of the file without its morph targets".into());
        }
        shape.set_points(frames[0].clone()).map_err(|e| ReadError::Whole(e.to_string()))?;
    }
    Ok(ShapeFrames { shape, frames, step, notes })
}

/// Times of the frames from the first key to the last one.
fn frame_times(
    tracks: &BTreeMap<usize, WeightTrack>,
    step: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<FrameTimes, ReadError> {
    /// Share of a step by which the last key may be missed, as 32-bit floats round its time.
    const SHARE: f64 = 1e-3;
    let ranges = || tracks.values().map(WeightTrack::range);
    let first = ranges().map(|[first, _]| first).fold(f64::INFINITY, f64::min);
    let last = ranges().map(|[_, last]| last).fold(f64::NEG_INFINITY, f64::max);
    // The first one of several with as many keys.
    let longest = tracks.values().rev().max_by_key(|track| track.n_keys());
    let step = match (step, longest) {
        (Some(step), _) if step > 0.0 && step.is_finite() => step,
        (Some(step), _) => {
            return Err(ReadError::Whole(format!(
                "the step must be positive and finite, got {step}; give the seconds from frame to frame"
            )));
        }
        (None, longest) => {
            let step = longest.and_then(WeightTrack::mean_distance).unwrap_or(0.0);
            if let Some(track) = longest.filter(|_| step > 0.0) {
                let uneven = if track.is_even() { "" } else { ", which are not at even times" };
                notes.push(format!(
                    "frames are {} s apart, the mean distance between the {} keys{uneven}",
                    rounded_text(step),
                    track.n_keys()
                ));
            }
            step
        }
    };
    let n_steps = if step > 0.0 { (last - first) / step } else { 0.0 };
    let nearest = n_steps.round();
    let is_whole = (n_steps - nearest).abs() <= SHARE;
    let n_steps = if is_whole { nearest } else { n_steps.floor() };
    if n_steps < 1.0 {
        let [first, last] = [first, last].map(rounded_text);
        return Err(ReadError::Whole(format!(
            "an animation must have at least two frames, got one between the keys at {first} s and {last} s; give a \
             smaller step, or a file with more keys"
        )));
    }
    let end = first + n_steps * step;
    if !is_whole {
        let [end, last] = [end, last].map(rounded_text);
        notes.push(format!("the last frame is at {end} s, before the last key at {last} s"));
    }
    // A number that is too large for memory is refused where the frames are allocated.
    let n_frames = (n_steps as usize).saturating_add(1);
    Ok(FrameTimes { first, last, step, n_frames })
}

/// Displacements of the targets of a part; `None` for a target without any.
fn part_targets(
    document: &Document,
    part: &VertexGroup,
    limits: &ReadLimits,
) -> Result<Vec<Option<Accessor>>, ReadError> {
    let mesh = part.instance.mesh;
    let primitives = document.json.list_of("meshes")[mesh].list_of("primitives");
    let indices = |k: usize| -> Vec<Option<usize>> {
        primitives[k].list_of("targets").iter().map(|target| target.index_of("POSITION")).collect()
    };
    let own = indices(part.primitives[0]);
    if let Some(other) = part.primitives[1..].iter().find(|&&other| indices(other) != own) {
        return Err(ReadError::Whole(format!(
            "primitives {} and {other} of mesh {mesh} share their vertices and must share their morph targets, got \
             different ones; export them as separate meshes",
            part.primitives[0]
        )));
    }
    let mut targets = Vec::with_capacity(own.len());
    for (k, index) in own.into_iter().enumerate() {
        let Some(index) = index else {
            targets.push(None);
            continue;
        };
        let accessor = Accessor::read(document, index, limits)?;
        if accessor.count != part.positions.count {
            return Err(ReadError::Whole(format!(
                "target {k} of mesh {mesh} must have {} displacements, one per vertex, got {}; export the mesh again",
                part.positions.count, accessor.count
            )));
        }
        // Numbers without bytes of their own are 0.
        targets.push((accessor.place.is_some() || accessor.is_sparse).then_some(accessor));
    }
    Ok(targets)
}

/// Weights that a part has without an animation: those of its node, else those of its mesh, else 0.
fn default_weights(document: &Document, part: &VertexGroup, n_targets: usize) -> Result<Vec<f64>, ReadError> {
    let mesh = part.instance.mesh;
    let node = part.instance.node.and_then(|node| document.json.list_of("nodes").get(node));
    let own = node.and_then(|node| node.get("weights"));
    let Some(list) = own.or_else(|| document.json.list_of("meshes")[mesh].get("weights")) else {
        return Ok(vec![0.0; n_targets]);
    };
    let weights: Option<Vec<f64>> = list.list().iter().map(Json::number).collect();
    weights.filter(|weights| weights.len() == n_targets && weights.iter().all(|w| w.is_finite())).ok_or_else(|| {
        ReadError::Whole(format!(
            "the weights of mesh {mesh} must be {n_targets} finite numbers, one per morph target, got {}; export the \
             mesh again",
            list.list().len()
        ))
    })
}

/// Transforms a displacement by the linear part of a matrix.
fn displacement(m: &AffineMatrix, d: [f64; 3]) -> [f64; 3] {
    let origin = m.map(|row| [row[0], row[1], row[2], 0.0]);
    if *m == IDENTITY { d } else { point(&origin, d) }
}

/// Frames that are being computed.
struct FrameBuilder<'a> {
    document: &'a Document,
    times: FrameTimes,
    frames: Vec<Vec<[f64; 3]>>,
    memory: MemoryCounter<'a>,
    progress: Progress<'a>,
}

impl FrameBuilder<'_> {
    /// Adds the displacements of a part to all frames; without a track its weights stay the same.
    fn move_part(&mut self, part: &VertexGroup, track: Option<&WeightTrack>) -> Result<(), ReadError> {
        /// Share of a step by which a key may be later than a frame.
        const SHARE: f64 = 1e-4;
        let (document, progress, n_frames) = (self.document, self.progress, self.frames.len());
        let primitives = document.json.list_of("meshes")[part.instance.mesh].list_of("primitives");
        let n = primitives[part.primitives[0]].list_of("targets").len();
        // Checked before the targets are read, because many nodes may show one mesh.
        self.memory.add(n.saturating_mul(n_frames), 8)?;
        let targets = part_targets(document, part, self.memory.limits())?;
        if n == 0 {
            return Ok(());
        }
        let mut weights = default_weights(document, part, n)?.repeat(n_frames);
        if let Some(track) = track {
            for (frame, row) in weights.chunks_exact_mut(n).enumerate() {
                track.weights_at(self.times.time(frame), SHARE * self.times.step, row);
            }
        }
        let vertices = part.first..part.first + part.positions.count;
        for (k, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            if weights.iter().skip(k).step_by(n).all(|&w| w == 0.0) {
                continue;
            }
            // Bounds the work as well: many targets may share the same bytes.
            self.memory.add(target.count, 12)?;
            let (matrix, mut displacements) = (&part.instance.matrix, Vec::new());
            let moved = |d| displacement(matrix, d);
            target.append_points(document, &mut displacements, moved, progress.quiet())?;
            self.frames.par_iter_mut().enumerate().try_for_each(|(frame, points)| {
                progress.check()?;
                let w = weights[frame * n + k];
                if w != 0.0 {
                    for (p, d) in points[vertices.clone()].iter_mut().zip(&displacements) {
                        *p = std::array::from_fn(|c| p[c] + w * d[c]);
                    }
                }
                Ok::<(), ReadError>(())
            })?;
        }
        Ok(())
    }
}

/// Checks that all vertices that are finite in the file stay so.
fn check_finite(
    base: &[[f64; 3]],
    frames: &[Vec<[f64; 3]>],
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let is_finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
    for (frame, points) in frames.iter().enumerate() {
        progress.check()?;
        if let Some(vertex) = (0..points.len()).find(|&i| is_finite(&base[i]) && !is_finite(&points[i])) {
            return Err(ReadError::Whole(format!(
                "vertex {vertex} must be at a finite position in frame {frame}, got {:?}; export the morph targets \
                 again",
                points[vertex]
            )));
        }
    }
    Ok(())
}
