//! Quality of features and saliency maps: repeatability of features on a changed shape, and agreement of a map with
//! human fixations.

mod agreement;
mod change;
mod repeatability;
mod statistics;

pub use agreement::{Agreement, AgreementError, agreement, center_distance};
pub use change::{Change, ChangeError, ChangedShape, change};
pub use repeatability::{LevelRepeatability, RepeatabilityParams, n_right, repeatability, share_by_chance};
pub use statistics::{correlation, rank_correlation, rms, shared_top};
