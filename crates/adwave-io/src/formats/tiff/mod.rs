//! TIFF, BigTIFF and GeoTIFF: images, and stacks of images of one size as volumes.
//!
//! Library: none but `flate2`. The crate `tiff` (0.11) reads the first plane alone of images whose colors are stored in
//! planes, refuses images beyond a fixed size instead of one that follows from the file, and its writer makes new files,
//! without the tags of the old one.

mod chunks;
mod codec;
mod geo;
mod page;
mod read;
mod tags;
mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// TIFF, BigTIFF and GeoTIFF.
    pub const TIFF: Self = Self::new("tiff");
}

pub(crate) static TIFF: FormatDescriptor = FormatDescriptor {
    format: Format::TIFF,
    title: "TIFF and GeoTIFF",
    extensions: &["tif", "tiff"],
    content: ContentKind::Grid,
    reads: "images of integers of 1 to 64 bits and floats of 32 and 64 bits, in strips, tiles or planes and both byte \
            orders; uncompressed, LZW, Deflate and PackBits; stacks of pages of one size as volumes; spacings, position \
            and coordinate system of a GeoTIFF, NODATA, spacings of ImageJ",
    writes: "the values in their type, with position and code of the coordinate system",
    keeps: "all tags, strips or tiles; bytes of values that are not edited; compressed images are written with Deflate",
    loses: "spacing along a stack, fields other than `values`; overviews and EXIF of compressed files that are edited",
    recognize: |file| {
        let is_tiff =
            [&b"II*\0"[..], b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| file.bytes.starts_with(magic));
        is_tiff.then_some(Evidence::Signature)
    },
    read: Some(read::read_tiff),
    write: Some(write::write_tiff),
    samples: &[
        SampleFile { name: "a.tif", bytes: include_bytes!("samples/a.tif") },
        SampleFile { name: "b.tif", bytes: include_bytes!("samples/b.tif") },
        SampleFile { name: "c.tif", bytes: include_bytes!("samples/c.tif") },
    ],
    ..FormatDescriptor::NEW
};
