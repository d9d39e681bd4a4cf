//! 3MF: a ZIP archive of models in XML.
//!
//! Archive by `zip`, XML by `roxmltree`. `threemf` (0.8) reads no colors and no components of other parts of the archive; `lib3mf` is
//! C++ and a service of its own.

pub(crate) mod model;
pub(crate) mod read;
pub(crate) mod write;
