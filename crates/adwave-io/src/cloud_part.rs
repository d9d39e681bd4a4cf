//! Parts of clouds.

use std::path::Path;

use adwave::Progress;

use crate::formats::las::part::read_cloud_part as read_part;
use crate::{CloudPart, ReadError, ReadLimits, ShapeFile, read_path_with};

/// Reads a part of a cloud: of a COPC 1.0 (identified by its content), of an EPT (its folder, or the `ept.json` in
/// it; local files with LAZ tiles), or the points of a LAS or LAZ in a box.
///
/// A resolution r selects the levels 0 to d, where d is the first level with spacing / 2ᵈ ≤ r, or the last level.
/// Points of COPC and EPT are ordered by level, then by the x, y and z of their node; those of a LAS or LAZ keep the
/// order of the file. All point attributes, the coordinate system and other records are kept, so that the shape can
/// be written as LAS or LAZ like one that was read completely (wave packets of LAS 1.3 are dropped). Without a
/// selection this is [`read_path`](crate::read_path).
///
/// For COPC and EPT only the hierarchy and the selected nodes are read; a LAS or LAZ is read completely, with memory
/// for the selected points and about 64 MiB.
///
/// # Errors
/// The file has none of these formats or is damaged; the box contains NaN or has its corners reversed; the resolution
/// is not above 0, or the file has no levels; the box contains no point (the message has the bounds); the limits are
/// exceeded. The message is one line that begins with the file's name.
///
/// ```
/// use adwave_io::{CloudPart, ReadLimits, ShapeFile, read_cloud_part, write_path};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("line.laz");
/// let line = (0..10).map(|x| [f64::from(x), 0.0, 0.0]).collect();
/// write_path(&ShapeFile::from_cloud(line), &path, None).unwrap();
/// let part = CloudPart::default().with_bounds([2.0, -1.0, -1.0], [4.0, 1.0, 1.0]);
/// let shape = read_cloud_part(&path, &part, &ReadLimits::default()).unwrap();
/// assert_eq!(shape.points(), [[2.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
/// ```
pub fn read_cloud_part(path: &Path, part: &CloudPart, limits: &ReadLimits) -> Result<ShapeFile, ReadError> {
    read_cloud_part_with(path, part, limits, Progress::none())
}

/// [`read_cloud_part`] with cancellation and progress in nodes, or in points of a LAS or LAZ.
///
/// # Errors
/// The errors of [`read_cloud_part`], and [`ReadError::Cancelled`] soon after the cancellation.
pub fn read_cloud_part_with(
    path: &Path,
    part: &CloudPart,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    if part.is_whole() {
        return read_path_with(path, limits, progress);
    }
    read_part(path, part, limits, progress)
}
