//! Shapes that move: glTF is the only format with animations, so these functions name it.

use std::io::Write;
use std::path::Path;

use adwave::Progress;

use crate::files::atomic::atomic_write_with;
use crate::formats::gltf::animation::{
    FramesInScene, ShapeFrames, check_frames, check_size, frames_of_shape, key_times, write_frames,
};
use crate::model::units::convert_unit;
use crate::progress::CancellableWriter;
use crate::registry::read::read_path_with;
use crate::registry::write::write_bytes_with;
use crate::{Format, LengthUnit, ReadError, ReadLimits, ShapeFile, WriteError, WriteReport};

/// Reads an animation of morph targets from a glTF or GLB.
///
/// Vertices and faces are those of [`read_path`](crate::read_path); vertex p is at M (p + Σₖ wₖ(t) dₖ) at time t, with
/// the displacements dₖ of the targets, their weights wₖ and the transform M of the node. The first frame is at the
/// first key of the weights, and the last one at the last key or up to one step before it. Meshes without animated
/// weights keep the weights of their node or mesh. Animated transforms and skins are not applied, and normals stay
/// those of the file; `notes` say so.
///
/// `animation` is the name of the animation, or `None` for the first one with weights. `step` is the number of seconds
/// from frame to frame, or `None` for the mean distance between keys of the channel with the most keys.
///
/// # Errors
/// The errors of [`read_path`](crate::read_path); the file is no glTF, has no such animation, the animation moves no
/// vertex, has fewer than two frames or more than the limits allow, or its keys, weights or targets are malformed. The
/// message is one line that begins with the file's name.
pub fn read_gltf_animation(
    path: &Path,
    animation: Option<&str>,
    step: Option<f64>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFrames, ReadError> {
    let shape = read_path_with(path, limits, progress)?;
    frames_of_shape(shape, animation, step, limits, progress).map_err(|e| e.in_file(path))
}

/// Writes frames as a GLB: each frame after the first is a morph target, and an animation of weights plays them, `step`
/// seconds apart, with linear interpolation in between.
///
/// The mesh has the positions of the first frame in 32-bit floats, with the faces and vertex fields that
/// [`write_path`](crate::write_path) writes into a new GLB; units of length are converted in the same way. Other
/// content of the shape's file, and vertices that were left out of it, are not written. The file is replaced
/// atomically (see [`atomic_write`](crate::atomic_write)), and compressed if its name ends in `.gz`.
///
/// ```
/// use adwave_io::{ReadLimits, ShapeFile, read_gltf_animation, write_glb_animation};
/// use adwave::Progress;
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.glb");
/// let frames = [0.0, 0.5, 2.0].map(|z| vec![[0.0, 0.0, z], [1.0, 0.0, 0.0]]);
/// let shape = ShapeFile::from_cloud(frames[0].clone());
/// write_glb_animation(&path, &shape, &frames, 0.25, Progress::none()).unwrap();
/// let read = read_gltf_animation(&path, None, None, &ReadLimits::default(), Progress::none()).unwrap();
/// assert_eq!((read.step, read.frames), (0.25, frames.to_vec()));
/// ```
///
/// # Errors
/// There are fewer than two frames, a frame does not have one finite position per vertex, or the step is not positive
/// and finite ([`WriteError::Frames`]); numbers are beyond 32-bit floats, the GLB would have more than 4 GiB, or the
/// name has the ending of another format ([`WriteError::CannotHold`]); or writing fails. An older file of that name is
/// unchanged then. The message is one line that begins with the file's name.
pub fn write_glb_animation(
    path: &Path,
    shape: &ShapeFile,
    frames: &[Vec<[f64; 3]>],
    step: f64,
    progress: Progress<'_>,
) -> Result<WriteReport, WriteError> {
    let in_file = |e: WriteError| e.in_file(path);
    if let Some(format) = Format::from_path(path).filter(|&format| format != Format::GLB) {
        let what = "an animation of morph targets, which is written as GLB alone".into();
        return Err(in_file(WriteError::CannotHold { format, what }));
    }
    check_frames(shape, frames, progress).map_err(in_file)?;
    check_size(frames.len(), shape.n_vertices).map_err(in_file)?;
    let times = key_times(frames.len(), step).map_err(in_file)?;
    let is_compressed = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    atomic_write_with(path, progress, |out| {
        let out: &mut dyn Write = &mut CancellableWriter::new(out, progress);
        if !is_compressed {
            return write_animation(shape, frames, &times, out, progress);
        }
        let mut gz = flate2::write::GzEncoder::new(out, flate2::Compression::default());
        let report = write_animation(shape, frames, &times, &mut gz, progress)?;
        gz.finish()?;
        Ok(report)
    })
}

fn write_animation(
    shape: &ShapeFile,
    frames: &[Vec<[f64; 3]>],
    times: &[f32],
    out: &mut dyn Write,
    progress: Progress<'_>,
) -> Result<WriteReport, WriteError> {
    let format = Format::GLB;
    let mut first = shape.clone();
    first.forget_original();
    first.forget_left_out();
    if first.points() != frames[0] {
        first.set_points(frames[0].clone()).map_err(|e| WriteError::Frames(e.to_string()))?;
    }
    let mut report = WriteReport::default();
    let converted = convert_unit(&first, format, &mut report)?;
    let unit = converted.as_ref().and(first.unit.as_ref());
    let ratio = unit.and_then(|unit| unit.ratio_to(&LengthUnit::METER)).unwrap_or(1.0);
    let (plain, mut glb) = (converted.as_ref().unwrap_or(&first), Vec::new());
    let of_first = write_bytes_with(plain, format, &mut glb, progress.quiet())?;
    of_first.notes.into_iter().for_each(|note| report.add_note(note));
    report.not_written.extend(of_first.not_written);
    write_frames(glb, &FramesInScene { frames, times, ratio }, out, progress)?;
    Ok(report)
}
