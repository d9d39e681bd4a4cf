//! FreeSurfer: surfaces (`lh.white`, `rh.pial`, …), and values on them (`lh.thickness`, `lh.aparc.annot`, MGH and MGZ).
//!
//! Such files have no ending of their own; their first bytes tell. An own reader: the formats are a few counts and lists,
//! and no crate reads all of them.

pub(crate) mod overlay;
pub(crate) mod read;
pub(crate) mod write;
