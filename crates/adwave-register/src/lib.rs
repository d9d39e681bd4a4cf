//! Registration of two shapes: closest points of a surface ([`Surface`]), motions ([`Motion`], [`align`]), a motion that
//! features agree on ([`consensus`], [`pairs_under`]), and signed distances ([`signed_distances`]).
//!
//! All lengths are in model units. The crate reads no files.

mod align;
mod closest;
mod consensus;
mod distance;
mod motion;
mod pairs;
mod shape_features;

pub use align::{AlignInfo, AlignParams, align};
pub use closest::{ClosestPoint, Surface};
pub use consensus::{Consensus, ConsensusParams, Key, consensus};
pub use distance::{SignedDistances, Summary, signed_distances};
pub use motion::Motion;
pub use pairs::{Pair, PairParams, pairs_under};
pub use shape_features::{DescribeError, ShapeFeatures, common_lengths, describe_shape};
