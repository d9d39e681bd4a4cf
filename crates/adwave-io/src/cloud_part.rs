//! Parts of clouds.

use std::path::Path;

use adwave::Progress;

use crate::formats::las::part::read_cloud_part as read_part;
use crate::{CloudPart, ReadError, ReadLimits, ShapeFile, read_path_with};

/// Reads a part of a cloud: of a COPC 1.0 (found by what is in the file), of an EPT (its folder, or the `ept.json` in it; local files,
/// LAZ tiles), and of a LAS or LAZ what lies in a box.
///
/// A resolution r takes the levels 0 to d, where d is the first with spacing / 2ᵈ ≤ r, or the last that there is. Points of COPC
/// and EPT come by level, then by the x, y and z of their node; those of a LAS or LAZ in the order of the file. All that the points
/// carry, the coordinate system and other records are kept, so that the shape is written as LAS or LAZ like one that was
/// read whole (wave packets of LAS 1.3 are left out). A part that is whole is [`read_path`](crate::read_path).
///
/// Of COPC and EPT the hierarchy and the chosen nodes are read; of a LAS or LAZ all, with no more in memory than what is kept and
/// some 64 MiB.
///
/// # Errors
/// One line that begins with a file's name: it is none of these, or broken; a box with NaN or with its corners the wrong way round; a
/// resolution of a file without levels, or one that is not above 0; no point in the box (the bounds are named); more than the limits.
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

/// [`read_cloud_part`] that says how many nodes, or points of a LAS or LAZ, are read, and can be stopped.
///
/// # Errors
/// As [`read_cloud_part`], and [`ReadError::Cancelled`] soon after it is told to stop.
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
