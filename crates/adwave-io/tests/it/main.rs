//! Tests of `adwave-io`, in one program: each program of its own would be linked with everything again.

mod all_files;
mod between_formats;
mod cancelling;
mod cloud_part;
mod common;
mod every_format;
mod fields;
mod freesurfer;
mod gifti;
mod gltf;
mod graph_names;
mod grids;
mod las_write;
mod laz;
mod meshes;
mod models;
mod moved_attributes;
mod oddities;
mod replacing;
mod round_trip;
mod row_numbers;
mod subset;
mod text_tables;
mod units;
mod value_files;
mod vtk;
