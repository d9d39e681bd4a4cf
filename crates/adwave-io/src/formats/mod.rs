//! Formats: a folder for each.

pub(crate) mod amf;
pub(crate) mod cifti;
pub(crate) mod columns;
pub(crate) mod csv;
pub(crate) mod dmat;
pub(crate) mod e57;
pub(crate) mod freesurfer;
pub(crate) mod geomview;
pub(crate) mod gifti;
pub(crate) mod gltf;
pub(crate) mod graph;
pub(crate) mod las;
pub(crate) mod medit;
pub(crate) mod msh;
pub(crate) mod mtx;
pub(crate) mod npy;
pub(crate) mod obj;
pub(crate) mod off;
pub(crate) mod pcd;
pub(crate) mod ply;
pub(crate) mod stl;
pub(crate) mod threemf;
pub(crate) mod vtk_legacy;
pub(crate) mod vtk_xml;
