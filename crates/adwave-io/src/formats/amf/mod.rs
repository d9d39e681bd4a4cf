//! AMF (ISO/ASTM 52915): XML, plain or in a ZIP archive. The XML by `roxmltree`; no crate reads the format.

pub(crate) mod read;
pub(crate) mod write;
