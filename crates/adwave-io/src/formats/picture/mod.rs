//! PNG and JPEG: images of 8 or 16 bits, gray or in colors.
//!
//! Library: `image`. Chunks of a PNG other than its pixels are copied here, since the library drops most of them.

mod png;
mod read;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// Portable Network Graphics.
    pub const PNG: Self = Self::new("png");
    /// JPEG, which is read only: it stores no exact values.
    pub const JPEG: Self = Self::new("jpeg");
}

pub(crate) static PNG: FormatDescriptor = FormatDescriptor {
    format: Format::PNG,
    title: "PNG",
    extensions: &["png"],
    content: ContentKind::Grid,
    reads: "images of 1 to 16 bits, gray or in colors, with opacity as a channel; palettes become colors",
    writes: "whole numbers from 0 to 255 or 65535 in 1 to 4 channels",
    keeps: "all other chunks, such as color profiles, resolution and texts; the number of bits",
    loses: "other numbers, spacings, positions, fields other than `values`, frames of animations after the first",
    recognize: |file| file.bytes.starts_with(b"\x89PNG\r\n\x1a\n").then_some(Evidence::Signature),
    read: Some(read::read_png),
    write: Some(png::write_png),
    samples: &[
        SampleFile { name: "a.png", bytes: include_bytes!("samples/a.png") },
        SampleFile { name: "b.png", bytes: include_bytes!("samples/b.png") },
    ],
    ..FormatDescriptor::NEW
};

pub(crate) static JPEG: FormatDescriptor = FormatDescriptor {
    format: Format::JPEG,
    title: "JPEG",
    extensions: &["jpg", "jpeg"],
    content: ContentKind::Grid,
    reads: "gray and colors, turned as their EXIF orientation says",
    loses: "color profiles and other metadata",
    recognize: |file| file.bytes.starts_with(b"\xff\xd8\xff").then_some(Evidence::Signature),
    read: Some(|bytes, c| read::read_jpeg(&bytes, c)),
    samples: &[SampleFile { name: "a.jpg", bytes: include_bytes!("samples/a.jpg") }],
    ..FormatDescriptor::NEW
};
