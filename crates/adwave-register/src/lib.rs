//! Registration of two shapes.
//!
//! - Closest points of a surface: [`ClosestPointSearch`].
//! - Motions: [`Motion`], [`align`].
//! - Pairs of features: [`pairs_under`].
//! - The motion between two shapes that is better than chance, and the motions that fit equally well: [`register()`].
//! - Signed distances: [`signed_distances`].
//! - Fields and labels between registered spheres, such as those of cortical surfaces: [`SphereResampler`].
//!
//! All lengths are in model units. The crate reads no files.

mod align;
mod closest;
mod consensus;
mod distance;
mod motion;
mod pairs;
mod register;
mod registrand;
mod search;
mod shape_features;
mod side;
mod sphere;
mod two_way_fit;

pub use align::{AlignInfo, AlignParams, MAX_GROWTH, align};
pub use closest::{ClosestPoint, ClosestPointSearch};
pub use consensus::Key;
pub use distance::{SignedDistances, Summary, signed_distances};
pub use motion::Motion;
pub use pairs::{Pair, PairParams, descriptor_pairs, pairs_under};
pub use register::{
    CLEAR_CONFIDENCE, ClosestFit, RegisteredMotion, Registration, closest_fit, fit_in_place, register,
};
pub use registrand::Registrand;
pub use search::{SearchParams, SearchStarts};
pub use shape_features::{DEFAULT_THETA, DescribeError, ShapeFeatures, common_lengths, describe_shape};
pub use side::{Signs, SurfaceSides, lies_on_a_surface};
pub use sphere::{Keep, Resampled, Sphere, SphereError, SphereResampler, Zeros};
pub use two_way_fit::TwoWayFit;
