//! Two shapes brought together: the closest points of a surface ([`Surface`]), rigid motions ([`Motion`], [`align`]), features of two
//! shapes that one motion explains ([`consensus`], [`pairs_under`]), and how far one shape lies from the other ([`signed_distances`]).
//!
//! Everything here is in the units of the shapes. Nothing reads a file.

mod align;
mod closest;
mod consensus;
mod described;
mod distance;
mod motion;
mod pairs;

pub use align::{AlignInfo, AlignParams, align};
pub use closest::{Closest, Surface};
pub use consensus::{Consensus, ConsensusParams, Key, consensus};
pub use described::{DescribeError, Described, common_lengths, described};
pub use distance::{SignedDistances, Summary, signed_distances};
pub use motion::Motion;
pub use pairs::{Pair, PairParams, pairs_under};
