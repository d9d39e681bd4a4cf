//! Points of a LAS or LAZ without levels in a box.

use std::fs::File;
use std::path::Path;

use adwave::Progress;

use crate::formats::las::part::image::Image;
use crate::formats::las::part::selection::Selection;
use crate::formats::las::stream::LasReader;
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// Size of a block of points in bytes.
const STEP: usize = 1 << 22;

/// Reads all points and keeps those in the box.
pub(super) fn read(
    path: &Path,
    mut reader: LasReader,
    selection: &Selection,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    if selection.resolution().is_some() {
        let what = "the file has no levels, as COPC and EPT have; omit the resolution, or convert the file \
                   to COPC (pdal translate IN OUT.copc.laz)";
        return Err(ReadError::Whole(what.into()));
    }
    let mut image = Image::new(reader.head().0, &mut File::open(path)?, limits, progress)?;
    let layout = reader.layout().clone();
    let (n, most) = (layout.n_points, (STEP / layout.record_bytes).max(1));
    let (mut done, mut rows) = (0, Vec::new());
    loop {
        progress.step(done, n)?;
        rows.clear();
        let n_read = reader.read(most, &mut rows)?;
        if n_read == 0 {
            break;
        }
        done += n_read as u64;
        selection.retain(&mut rows, image.header());
        image.add(&rows)?;
    }
    if image.is_empty() {
        return Err(selection.empty(layout.bounds));
    }
    let is_compressed = reader.head().1.is_compressed;
    drop(reader);
    image.into_shape(if is_compressed { Format::LAZ } else { Format::LAS }, limits, progress)
}
