//! Orientation: normals of a cloud that point to one side of its surface, over all tiles.
//!
//! The orientation is carried from point to point along the minimum spanning tree of all pairs of neighbors, as
//! [`cloud_normals`](adwave::signal::cloud_normals) does it. Ties are broken by the order of the curve, so that there is exactly one such
//! tree. A tile finds those of its edges that are certainly in the tree ([`pieces`]); the points that they connect are a *piece*. The
//! few other edges that may be in the tree are considered together ([`normal_orientation`]).

mod normal_orientation;
mod pieces;
mod union_find;

pub(crate) use normal_orientation::NormalOrientation;
pub(crate) use pieces::write_pieces;
