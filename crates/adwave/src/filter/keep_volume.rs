//! Smoothing that keeps more of the volume: by an offset, or by further levels.

use super::{Gains, Layer, Preset};
use crate::bands::{Schedule, ScheduleError};
use crate::{ClassifiedError, ErrorKind, named_values};
use thiserror::Error;

/// Way in which a smoothing keeps the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum KeepVolume {
    /// Exact volume, by one offset along the normals of the vertices that moved (see
    /// [`Volume::Keep`](crate::positions::Volume::Keep)).
    Offset,
    /// Part of the volume, by `1 − (1 − Φⁿ)²` instead of a smoothing by n steps: one level more.
    Twice,
    /// More of the volume, by `1 − (1 − Φⁿ)³` instead of a smoothing by n steps: two levels more.
    Thrice,
}

named_values!(KeepVolume, "way to keep the volume", {
    Offset => "offset", "Exactly: by one offset along the normals of what moved";
    Twice => "twice", "Of a smoothing by n steps: 1 − (1 − Φⁿ)², by one more level";
    Thrice => "thrice", "Of a smoothing by n steps: 1 − (1 − Φⁿ)³, by two more levels";
});

/// Error of a filter whose volume cannot be kept by further levels.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum KeepVolumeError {
    /// The layer changes bands in another way than dropping all of them.
    #[error(
        "layer {layer} does not drop every band, so '{how}' cannot keep its volume; take 'offset', which works for every filter"
    )]
    NotSmoothing {
        /// The layer, from 1.
        layer: usize,
        /// The requested way of keeping the volume.
        how: KeepVolume,
    },
    /// The further levels would have too many steps.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
}

impl ClassifiedError for KeepVolumeError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

impl KeepVolume {
    /// The schedule and the layers of a smoothing that keeps more of the volume: `1 − (1 − Φⁿ)^m` instead of Φⁿ, n the
    /// steps of the last level. [`Offset`](Self::Offset) changes neither.
    ///
    /// ```
    /// use adwave::bands::Schedule;
    /// use adwave::filter::{Gains, KeepVolume, Layer, Preset};
    /// use adwave::region::Region;
    /// let smooth = Layer { gains: Gains::Preset(Preset::SuppressPaper), region: Region::Everywhere {} };
    /// let (schedule, layers) = KeepVolume::Twice.extend_levels(Schedule::dyadic(3)?, vec![smooth])?;
    /// assert_eq!(schedule.steps(), [1.0, 2.0, 4.0, 8.0]);
    /// assert_eq!(layers[0].gains, Gains::Gains(vec![0.0, 0.0, 0.0, 2.0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`KeepVolumeError`] if a layer is no smoothing, or a further level would have more than 2³¹ steps.
    pub fn extend_levels(
        self,
        schedule: Schedule,
        mut layers: Vec<Layer>,
    ) -> Result<(Schedule, Vec<Layer>), KeepVolumeError> {
        let (factors, gains_of_further_levels): (&[f64], &[f64]) = match self {
            Self::Offset => return Ok((schedule, layers)),
            // 2Φⁿ − Φ²ⁿ = S(2n) + 2·(S(n) − S(2n)).
            Self::Twice => (&[2.0], &[2.0]),
            // 3Φⁿ − 3Φ²ⁿ + Φ³ⁿ = S(3n) + 3·(S(n) − S(2n)).
            Self::Thrice => (&[2.0, 3.0], &[3.0, 0.0]),
        };
        let n_levels = schedule.n_levels();
        for (k, layer) in layers.iter_mut().enumerate() {
            let is_smoothing = match &layer.gains {
                Gains::Preset(preset) => matches!(preset, Preset::Suppress | Preset::SuppressPaper),
                Gains::Gains(gains) => gains.len() == n_levels && gains.iter().all(|g| *g == 0.0),
            };
            if !is_smoothing {
                return Err(KeepVolumeError::NotSmoothing { layer: k + 1, how: self });
            }
            layer.gains = Gains::Gains([&vec![0.0; n_levels][..], gains_of_further_levels].concat());
        }
        let mut steps = schedule.steps().to_vec();
        let last = steps[n_levels - 1];
        steps.extend(factors.iter().map(|m| m * last));
        Ok((Schedule::real(steps)?, layers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::Region;

    #[test]
    fn only_smoothings_get_further_levels() {
        let layer = |gains| vec![Layer { gains, region: Region::Everywhere {} }];
        let schedule = || Schedule::dyadic(3).unwrap();
        let enhance = layer(Gains::Preset(Preset::Enhance));
        let error = KeepVolume::Thrice.extend_levels(schedule(), enhance.clone()).unwrap_err();
        assert_eq!(error, KeepVolumeError::NotSmoothing { layer: 1, how: KeepVolume::Thrice });
        let (unchanged, layers) = KeepVolume::Offset.extend_levels(schedule(), enhance.clone()).unwrap();
        assert_eq!((unchanged, layers), (schedule(), enhance));
        let (longer, layers) =
            KeepVolume::Thrice.extend_levels(schedule(), layer(Gains::Gains(vec![0.0; 3]))).unwrap();
        assert_eq!(longer.steps(), [1.0, 2.0, 4.0, 8.0, 12.0]);
        assert_eq!(layers[0].gains, Gains::Gains(vec![0.0, 0.0, 0.0, 3.0, 0.0]));
    }
}
