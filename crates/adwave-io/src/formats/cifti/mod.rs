//! CIFTI-2: dense scalars, series and labels (`.dscalar.nii`, `.dtseries.nii`, `.dlabel.nii`) as values on a surface.
//!
//! An own reader: the crate `nifti` reads the numbers, but not the XML that says of which vertices they are.

mod models;
pub(crate) mod read;
