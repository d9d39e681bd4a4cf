//! How good features and saliency maps are: whether features are found again on a changed shape, and whether a map agrees
//! with where people look.

mod agreement;
mod change;
mod repeatability;
mod statistics;

pub use agreement::{Agreement, AgreementError, agreement, center_distance};
pub use change::{Change, ChangeError, Changed, change};
pub use repeatability::{LevelRepeatability, RepeatabilityParams, n_right, repeatability, share_by_chance};
pub use statistics::{correlation, rank_correlation, rms, shared_top};
