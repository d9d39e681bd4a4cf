//! NIfTI-1 and NIfTI-2: volumes, also in several points in time, in one file (`.nii`).
//!
//! Library: none. The crate `nifti` (0.17) keeps neither the bytes of the header nor its extensions, writes other types of
//! numbers than it read, and makes room for the sizes that a header claims.

mod header;
mod read;
pub(crate) mod series;
mod write;

use crate::Format;
use crate::model::file_head::FileHead;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};

impl Format {
    /// NIfTI-1 and NIfTI-2.
    pub const NIFTI: Self = Self::new("nifti");
}

/// Endings of CIFTI, which stores values of surfaces in the frame of NIfTI-2.
const CIFTI_ENDINGS: &[&str] = &[
    ".dconn.nii",
    ".dtseries.nii",
    ".pconn.nii",
    ".ptseries.nii",
    ".dscalar.nii",
    ".dlabel.nii",
    ".pscalar.nii",
    ".plabel.nii",
    ".pdconn.nii",
    ".dpconn.nii",
    ".pconnseries.nii",
    ".pconnscalar.nii",
    ".dfan.nii",
];

fn recognize(file: &FileHead<'_>) -> Option<Evidence> {
    (header::has_magic(file.bytes) && !header::is_cifti(file.bytes)).then_some(Evidence::Signature)
}

pub(crate) static NIFTI: FormatDescriptor = FormatDescriptor {
    format: Format::NIFTI,
    title: "NIfTI-1 and NIfTI-2",
    extensions: &["nii"],
    foreign_endings: CIFTI_ENDINGS,
    content: ContentKind::Grid,
    reads: "volumes of integers, floats, colors or complex numbers, in both byte orders, times slope plus intercept; \
            points in time and other axes as channels; spacings from the affine matrix (sform, else qform)",
    writes: "the values in their type, with the affine matrix as sform",
    keeps: "the header, its extensions and the type of numbers; bytes of values that are not edited",
    loses: "fields other than `values`",
    recognize,
    read: Some(|bytes, c| read::read_nifti(bytes, c.limits, c.progress)),
    write: Some(write::write_nifti),
    samples: &[
        SampleFile { name: "a.nii", bytes: include_bytes!("samples/a.nii") },
        SampleFile { name: "b.nii", bytes: include_bytes!("samples/b.nii") },
    ],
    ..FormatDescriptor::NEW
};
