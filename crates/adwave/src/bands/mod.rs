//! Bands of a signal: schedules of levels, scaling and wavelet coefficients, reconstruction.

mod decompose;
mod powers;
mod schedule;

pub use decompose::{Bands, BandsError, decompose};
pub use powers::smooth;
pub use schedule::{MAX_STEPS, Schedule, ScheduleError, default_levels};
