//! ESRI ASCII grids: heights of a terrain as text.
//!
//! Library: none. There is none that keeps the text of numbers.

mod read;
mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// ESRI ASCII grid.
    pub const ESRI_GRID: Self = Self::new("esri-grid");
}

pub(crate) static ESRI_GRID: FormatDescriptor = FormatDescriptor {
    format: Format::ESRI_GRID,
    title: "ESRI ASCII grid",
    extensions: &["agr"],
    shared_extensions: &["asc"],
    content: ContentKind::Grid,
    reads: "images of numbers with their position and NODATA, also named `.asc`; a `.prj` beside the file that states \
            degrees",
    writes: "one channel of an image whose axes are not turned",
    keeps: "the header and the text of numbers that are not edited",
    loses: "coordinate systems, further channels, fields other than `values`",
    recognize: |file| {
        let is_grid = file.keyword().is_some_and(|word| word.eq_ignore_ascii_case(b"ncols"));
        is_grid.then_some(Evidence::Keyword)
    },
    has_lines: |_| true,
    read: Some(read::read_grid),
    write: Some(write::write_grid),
    samples: &[SampleFile { name: "a.asc", bytes: include_bytes!("samples/a.asc") }],
    ..FormatDescriptor::NEW
};
