//! Bands of a signal: schedules of levels, scaling and wavelet coefficients, reconstruction.

mod chebyshev;
mod decompose;
mod params;
mod powers;
mod real_series;
mod schedule;
mod series;
mod transform;

pub(crate) use decompose::check_signal;
pub use decompose::{Bands, BandsError, decompose, forecast_bytes, weighted_bands};
pub use params::{BandsInfo, BandsParams, Engine, FINEST_ACCURACY};
pub use powers::smooth;
pub use schedule::{
    DEFAULT_REACH, MAX_STEPS, MIN_STEPS, Schedule, ScheduleError, default_levels, levels_reaching,
};
pub use transform::Transform;
