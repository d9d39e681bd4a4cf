//! Points of a LAS that its producer took out: flagged as withheld or classified as noise.

use crate::model::point_flags::{NOISE_CLASSES, WITHHELD_FLAG};
use crate::{Format, ShapeFile};

/// Treatment of points of LAS, LAZ and EPT that are flagged as withheld or classified as noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum FlaggedPoints {
    /// Flagged points take no part.
    #[default]
    LeftOut,
    /// Flagged points take part like all other points.
    Included,
}

/// Rule for flagged points in the presence of conditions on the fields that flag them.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlagRule {
    /// Points of the classes of noise are left out.
    pub(super) leaves_out_noise: bool,
    /// Withheld points are left out.
    pub(super) leaves_out_withheld: bool,
}

/// Flags of the points that the rule leaves out; empty for a file of another format.
pub(super) fn flagged_points(file: &ShapeFile, rule: FlagRule) -> Vec<bool> {
    if !file.format().is_some_and(Format::flags_points) {
        return Vec::new();
    }
    let mut is_flagged = vec![false; file.n_vertices()];
    let mut mark = |name: &str, marks: &dyn Fn(u8) -> bool| {
        let Some(field) = file.field(name).filter(|field| field.n_channels == 1) else { return };
        for (i, flag) in is_flagged.iter_mut().enumerate() {
            *flag |= marks(field.get(i, 0) as u8);
        }
    };
    if rule.leaves_out_noise {
        mark("classification", &|class| NOISE_CLASSES.contains(&class));
    }
    if rule.leaves_out_withheld {
        mark("classification_flags", &|flags| flags & WITHHELD_FLAG != 0);
    }
    is_flagged
}
