//! 3MF: a ZIP archive of models in XML.
//!
//! The archive is read with `zip`, the XML with `roxmltree`. `threemf` (0.8) reads neither colors nor components of
//! other parts of the archive; `lib3mf` is C++ and runs as a separate service.

pub(crate) mod model;
pub(crate) mod read;
pub(crate) mod write;
