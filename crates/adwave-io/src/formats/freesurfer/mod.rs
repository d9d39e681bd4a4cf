//! FreeSurfer: surfaces (`lh.white`, `rh.pial`, …), and values on them (`lh.thickness`, `lh.aparc.annot`, MGH and
//! MGZ).
//!
//! Such files have no extension of their own; their first bytes identify them. The reader is our own, because no
//! crate reads all of these small formats.

pub(crate) mod overlay;
pub(crate) mod read;
pub(crate) mod write;
