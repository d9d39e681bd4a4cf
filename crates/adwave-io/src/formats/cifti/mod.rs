//! CIFTI-2: dense scalars, series and labels (`.dscalar.nii`, `.dtseries.nii`, `.dlabel.nii`) as values on a surface.
//!
//! Library: `roxmltree` for the XML. The crate `nifti` reads the numbers, but not the XML that names their vertices.

mod models;
pub(crate) mod read;
mod update;
mod whole;
pub(crate) mod write;

use crate::model::format_descriptor::{ContentKind, Evidence, FormatDescriptor, SampleFile};
use crate::model::units::UnitRoom;
use crate::{Format, LengthUnit};

impl Format {
    /// CIFTI-2.
    pub const CIFTI: Self = Self::new("cifti");
}

pub(crate) static CIFTI: FormatDescriptor = FormatDescriptor {
    format: Format::CIFTI,
    title: "CIFTI-2",
    extensions: &["dscalar.nii", "dtseries.nii"],
    content: ContentKind::Brain,
    reads: "dense scalars and series of surfaces and voxels, in both byte orders, times slope plus intercept; labels as \
            values of one surface",
    writes: "the CIFTI that was read with other values, as floats; values of one surface as a new one",
    unit: UnitRoom::Fixed(&LengthUnit::MILLIMETER),
    keeps: "the structures, names of maps, time step, metadata",
    loses: "columns that are neither scalars nor a series; fields other than `values`",
    // Volumes stand before it in the table.
    recognize: |file| read::is_nifti(file.bytes).then_some(Evidence::Signature),
    read: Some(|bytes, c| whole::read_whole(&bytes, c.limits, c.progress)),
    read_values: Some(|bytes, size, c| {
        read::read_cifti(bytes, size.structure, size.n_vertices, c.limits, c.progress)
    }),
    rewrite_values: Some(update::rewrite),
    write: Some(whole::write_new),
    samples: &[SampleFile { name: "a.dscalar.nii", bytes: include_bytes!("samples/a.dscalar.nii") }],
    ..FormatDescriptor::NEW
};
