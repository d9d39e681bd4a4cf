//! The formats, a folder each, and the one table that names them.
//!
//! A folder ends (in its `mod.rs`) in the descriptors of its formats. A new format needs its folder, a line `mod` and a
//! row of the table here, and the Cargo feature that it belongs to.

#[cfg(feature = "print3d")]
pub(crate) mod amf;
#[cfg(feature = "neuro")]
pub(crate) mod cifti;
pub(crate) mod columns;
pub(crate) mod csv;
#[cfg(feature = "more")]
pub(crate) mod dmat;
#[cfg(feature = "e57")]
pub(crate) mod e57;
#[cfg(feature = "grid")]
pub(crate) mod esri_grid;
#[cfg(feature = "sky")]
pub(crate) mod fits;
#[cfg(feature = "neuro")]
pub(crate) mod freesurfer;
#[cfg(feature = "more")]
pub(crate) mod geomview;
#[cfg(feature = "neuro")]
pub(crate) mod gifti;
#[cfg(feature = "gltf")]
pub(crate) mod gltf;
#[cfg(feature = "graph")]
pub(crate) mod graph;
#[cfg(feature = "las")]
pub(crate) mod las;
#[cfg(feature = "volume")]
pub(crate) mod medit;
#[cfg(feature = "grid")]
pub(crate) mod mrc;
#[cfg(feature = "volume")]
pub(crate) mod msh;
#[cfg(feature = "graph")]
pub(crate) mod mtx;
#[cfg(feature = "sky")]
pub(crate) mod netcdf;
#[cfg(feature = "grid")]
pub(crate) mod nifti;
pub(crate) mod npy;
#[cfg(feature = "grid")]
pub(crate) mod nrrd;
pub(crate) mod obj;
pub(crate) mod off;
#[cfg(feature = "pcd")]
pub(crate) mod pcd;
#[cfg(feature = "grid")]
pub(crate) mod picture;
pub(crate) mod ply;
pub(crate) mod stl;
#[cfg(feature = "print3d")]
pub(crate) mod threemf;
#[cfg(feature = "grid")]
pub(crate) mod tiff;
#[cfg(feature = "vtk")]
pub(crate) mod vtk_legacy;
#[cfg(feature = "vtk")]
pub(crate) mod vtk_xml;

use crate::model::format_descriptor::FormatDescriptor;

/// All formats, in the order of messages and documents. Forms of one ending stand together, the one that its name
/// means first; formats of values at the vertices of a surface stand last.
pub(crate) static TABLE: &[&FormatDescriptor] = &[
    &obj::OBJ,
    &ply::PLY,
    &ply::PLY_ASCII,
    &off::OFF,
    &off::OFF_BINARY,
    &stl::STL,
    &stl::STL_ASCII,
    &columns::XYZ,
    &columns::PTS,
    &columns::CSV,
    #[cfg(feature = "pcd")]
    &pcd::PCD,
    #[cfg(feature = "pcd")]
    &pcd::PCD_ASCII,
    #[cfg(feature = "pcd")]
    &pcd::PCD_COMPRESSED,
    #[cfg(feature = "las")]
    &las::LAS,
    #[cfg(feature = "las")]
    &las::LAZ,
    #[cfg(feature = "las")]
    &las::EPT,
    #[cfg(feature = "graph")]
    &mtx::MTX,
    #[cfg(feature = "neuro")]
    &gifti::GIFTI,
    #[cfg(feature = "e57")]
    &e57::E57,
    #[cfg(feature = "gltf")]
    &gltf::GLB,
    #[cfg(feature = "gltf")]
    &gltf::GLTF,
    #[cfg(feature = "vtk")]
    &vtk_xml::VTP,
    #[cfg(feature = "vtk")]
    &vtk_xml::VTU,
    #[cfg(feature = "vtk")]
    &vtk_xml::VTI,
    #[cfg(feature = "vtk")]
    &vtk_xml::VTR,
    #[cfg(feature = "vtk")]
    &vtk_xml::VTS,
    #[cfg(feature = "vtk")]
    &vtk_legacy::VTK,
    #[cfg(feature = "neuro")]
    &freesurfer::FREESURFER,
    #[cfg(feature = "volume")]
    &msh::MSH,
    #[cfg(feature = "volume")]
    &msh::MSH_ASCII,
    #[cfg(feature = "volume")]
    &medit::MEDIT,
    #[cfg(feature = "volume")]
    &medit::MEDIT_BINARY,
    #[cfg(feature = "print3d")]
    &amf::AMF,
    #[cfg(feature = "print3d")]
    &threemf::THREE_MF,
    #[cfg(feature = "more")]
    &dmat::DMAT,
    #[cfg(feature = "more")]
    &dmat::DMAT_BINARY,
    #[cfg(feature = "graph")]
    &graph::TGF,
    #[cfg(feature = "graph")]
    &graph::EDGE_LIST,
    #[cfg(feature = "graph")]
    &graph::GRAPHML,
    #[cfg(feature = "more")]
    &geomview::GEOMVIEW,
    #[cfg(feature = "sky")]
    &fits::FITS,
    #[cfg(feature = "sky")]
    &netcdf::NETCDF,
    #[cfg(feature = "grid")]
    &nifti::NIFTI,
    #[cfg(feature = "grid")]
    &picture::PNG,
    #[cfg(feature = "grid")]
    &picture::JPEG,
    #[cfg(feature = "grid")]
    &tiff::TIFF,
    #[cfg(feature = "grid")]
    &esri_grid::ESRI_GRID,
    #[cfg(feature = "grid")]
    &mrc::MRC,
    #[cfg(feature = "grid")]
    &nrrd::NRRD,
    #[cfg(feature = "grid")]
    &npy::grid::NPY,
    #[cfg(feature = "grid")]
    &npy::grid::NPZ,
    #[cfg(feature = "neuro")]
    &cifti::CIFTI,
    #[cfg(feature = "neuro")]
    &freesurfer::CURV,
    #[cfg(feature = "neuro")]
    &freesurfer::MGH,
    #[cfg(feature = "neuro")]
    &freesurfer::ANNOTATION,
    #[cfg(feature = "neuro")]
    &freesurfer::LABEL,
];
