//! Reference methods with which adwave is compared, each implemented as its literature recommends.

pub mod compare;
pub mod differential;
mod error_kind;
pub mod feature_map;
pub mod grid_smoothing;
pub mod harmonics;
pub mod laplacian;
pub mod lee;
pub mod linalg;
pub mod line;
pub mod multiscale;
pub mod normal_filter;
pub mod sgwt;
pub mod signature;
pub mod taubin;
