//! The index of the sorted vertices: blocks of records, their bounding boxes, and the neighbors of every vertex, on
//! disk.
//!
//! Vertices are numbered along a Hilbert curve. This number, the *vertex index*, names a vertex in all files but the
//! inputs.

pub(crate) mod blocks;
pub(crate) mod bounds_tree;
pub(crate) mod face_lists;
pub(crate) mod interval_set;
pub(crate) mod neighbor_index;
pub(crate) mod neighbor_lists;
pub(crate) mod position_cache;
pub(crate) mod scratch_buckets;
pub(crate) mod vertex_rows;
