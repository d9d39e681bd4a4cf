//! Bands of a signal: schedules of levels, scaling and wavelet coefficients, reconstruction (eq. 11) (eq. 15).
//!
//! [`Transform`] is the diffusion operator prepared for many signals. It computes [`Bands`] in the order of the
//! shape, [`Wavelets`] in the analysis order, or a weighted sum of bands, each at the cost of its products alone.

#[expect(clippy::module_inception, reason = "the file of the type `Bands`")]
mod bands;
mod chebyshev;
mod error;
mod fixed_series;
mod heat_series;
mod leaps;
mod norms;
mod params;
mod plain_series;
mod powers;
mod real_series;
mod schedule;
mod series;
mod shape_order;
mod stages;
mod sum;
mod transform;
mod wavelets;

pub use bands::{Bands, mean_square};
pub use error::BandsError;
pub(crate) use error::{check_buffer, check_factors, check_signal};
pub use fixed_series::FixedSeries;
pub use params::{BandsInfo, BandsParams, Engine, FINEST_ACCURACY, Precision};
pub use powers::smooth;
pub use schedule::{
    DEFAULT_EXTENT, FWHM, MAX_STEPS, MIN_STEPS, Schedule, ScheduleError, default_levels, levels_reaching,
};
pub use transform::Transform;
pub(crate) use wavelets::RowMeasure;
pub use wavelets::Wavelets;
