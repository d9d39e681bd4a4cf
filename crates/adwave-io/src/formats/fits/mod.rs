//! Maps of the sky in FITS: HEALPix in a binary table, ring or nested, of the whole sphere or of a part.
//!
//! A pixel is a vertex at its center on the unit sphere, the columns of the table are fields, and the faces join the
//! pixels that meet at a corner. So a length along the surface is an angle in radians. UNSEEN (−1.6375e30) is NaN.
//!
//! Library: none. `fitsio` needs the C library; `fitsrs` (0.4) reads only, and images in the first place; a file that
//! is written again must keep its header, for which the places of its bytes are needed. What maps use of FITS (cards,
//! binary tables) is small. For the geometry there is `cdshealpix`, which brings coverages, projections and a
//! dozen crates, and has no mesh of centers.

mod column;
mod header;
mod healpix;
mod read;
mod write;

use adwave::vector::Axis;

use crate::Format;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{Evidence, FormatDescriptor, SampleFile};

/// Number in place of a pixel that was not observed.
const UNSEEN: f64 = -1.6375e30;

impl Format {
    /// HEALPix map in FITS.
    pub const FITS: Self = Self::new("fits");
}

/// Any FITS whose table may be a map; the reader says what is missing.
fn recognize(file: &FileHead<'_>) -> Option<Evidence> {
    file.bytes.starts_with(b"SIMPLE  =").then_some(Evidence::Signature)
}

pub(crate) static FITS: FormatDescriptor = FormatDescriptor {
    format: Format::FITS,
    title: "HEALPix map in FITS",
    extensions: &["fits", "fit", "fts"],
    reads: "binary tables of HEALPix in ring or nested order, of all pixels or of those listed; each column of \
            integers or floats is a field; UNSEEN is a missing value; the places are the centers of pixels on the unit sphere",
    writes: "all fields as columns, missing values as UNSEEN, of the pixels of the map that was read",
    keeps: "the header, other tables and pictures, the type of numbers",
    loses: "shapes that are no HEALPix map, moved points; other FITS files are not read",
    holds_fields: true,
    up_axis: Some(Axis::Z),
    recognize,
    read: Some(|bytes, c| read::read_fits(bytes, c.limits, c.progress)),
    write: Some(write::write_fits),
    samples: &[
        SampleFile { name: "a.fits", bytes: include_bytes!("samples/a.fits") },
        SampleFile { name: "part.fits", bytes: include_bytes!("samples/part.fits") },
    ],
    ..FormatDescriptor::NEW
};
