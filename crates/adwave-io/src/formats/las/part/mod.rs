//! Parts of a cloud: the points in a box, at a resolution.
//!
//! COPC and EPT store their points in an octree. Each point is in one node; the nodes of level d, cubes with 2⁻ᵈ
//! times the side of the root, contain points about spacing / 2ᵈ apart and add to those of the coarser levels. A part
//! therefore consists of the nodes whose cubes intersect the box, down to the first level that is fine enough,
//! without the points outside the box. Only these nodes are read. A LAS or LAZ has no levels, so all its points are
//! examined in blocks.
//!
//! The selected points become a LAS in memory, which the LAS reader parses: fields, extra bytes, coordinate system
//! and writing are the same as for a whole file.

mod copc;
mod ept;
mod image;
mod levels;
mod octree;
mod plain;
mod selection;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use adwave::Progress;

pub use levels::{CloudLevels, cloud_levels};

use crate::formats::las::stream::LasReader;
use crate::model::context::ReadContext;
use crate::{ReadError, ReadLimits, ShapeFile};
use ept::{folder_of_tiles, read_tiles};
use selection::Selection;

/// Which part of a cloud is read: a box, a resolution, both, or all of it.
///
/// ```
/// use adwave_io::CloudPart;
/// let part = CloudPart::default().with_bounds([0.0; 3], [10.0, 10.0, f64::INFINITY]).with_resolution(0.5);
/// assert_eq!(part.resolution, Some(0.5));
/// assert!(CloudPart::default().is_whole());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CloudPart {
    /// Smallest and largest coordinates of the points, in model units, both inclusive. A side may be infinite.
    pub bounds: Option<([f64; 3], [f64; 3])>,
    /// Distance of the points in model units, above 0: finer levels are skipped.
    pub resolution: Option<f64>,
}

impl CloudPart {
    /// Selects the points in the box from `low` to `high`, inclusive.
    #[must_use]
    pub fn with_bounds(mut self, low: [f64; 3], high: [f64; 3]) -> Self {
        self.bounds = Some((low, high));
        self
    }

    /// Selects only the levels needed for points `resolution` apart.
    #[must_use]
    pub fn with_resolution(mut self, resolution: f64) -> Self {
        self.resolution = Some(resolution);
        self
    }

    /// True if the whole cloud is selected.
    pub fn is_whole(&self) -> bool {
        self.bounds.is_none() && self.resolution.is_none()
    }
}

/// Reads the part of a cloud that is not all of it.
pub(crate) fn read_cloud_part(
    path: &Path,
    part: &CloudPart,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    read_part(path, part, limits, progress).map_err(|error| named(error, path))
}

/// Reads the folder of an EPT; `None` of any other path.
pub(crate) fn read_folder(path: &Path, context: &ReadContext<'_>) -> Option<Result<ShapeFile, ReadError>> {
    let folder = folder_of_tiles(path)?;
    Some(read_tiles(&folder, &Selection::whole(), context.limits, context.progress))
}

fn read_part(
    path: &Path,
    part: &CloudPart,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let selection = Selection::of(part)?;
    let shape = if let Some(folder) = folder_of_tiles(path) {
        read_tiles(&folder, &selection, limits, progress)?
    } else if is_las(path)? {
        let reader = LasReader::open(path)?;
        match copc::Info::of(&reader)? {
            Some(info) => copc::read(path, &reader, &info, &selection, limits, progress)?,
            None => plain::read(path, reader, &selection, limits, progress)?,
        }
    } else {
        let what = "is no LAS, LAZ, COPC or EPT, of which alone a part can be read; read all of it";
        return Err(ReadError::Whole(what.into()));
    };
    Ok(shape.with_original_fields())
}

/// Whether it is a regular file that begins as a LAS does.
fn is_las(path: &Path) -> Result<bool, ReadError> {
    let file = File::open(path)?;
    let mut magic = Vec::new();
    if file.metadata()?.is_file() {
        file.take(4).read_to_end(&mut magic)?;
    }
    Ok(magic == b"LASF")
}

/// Prefixes the error with the file's name, unless it has one.
fn named(error: ReadError, path: &Path) -> ReadError {
    if matches!(error, ReadError::InFile { .. }) { error } else { error.in_file(path) }
}
