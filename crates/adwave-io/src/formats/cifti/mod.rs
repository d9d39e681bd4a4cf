//! CIFTI-2: dense scalars, series and labels (`.dscalar.nii`, `.dtseries.nii`, `.dlabel.nii`) as values on a surface.
//!
//! Library: `roxmltree` for the XML. The crate `nifti` reads the numbers, but not the XML that names their vertices.

mod models;
pub(crate) mod read;
mod update;
pub(crate) mod write;

use crate::Format;
use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor};

pub(crate) static CIFTI: FormatDescriptor = FormatDescriptor {
    format: Format::new("cifti"),
    title: "CIFTI-2",
    content: ContentKind::Values,
    recognize: |file| read::is_nifti(file.bytes).then_some(Evidence::Signature),
    name_foreign: |file| {
        read::is_nifti(file.bytes).then_some("NIfTI or CIFTI: use a CIFTI as a field of a surface")
    },
    read_values: Some(|bytes, size, c| {
        read::read_cifti(bytes, size.structure, size.n_vertices, c.limits, c.progress)
    }),
    rewrite_values: Some(update::rewrite),
    ..FormatDescriptor::NEW
};
