//! The edit of a shape, in the form of the page and as a recipe.

use crate::pose::ReshapedBy;
use crate::response::ApiError;
use adwave::LevelSpec;
use adwave::filter::{Gains, Layer};
use adwave::local_fit::LocalFit;
use adwave::operator::OperatorKind;
use adwave::positions::{Borders, MoveDirection, PositionParams, Volume};
use adwave::region::Region;
use adwave_io::{DetailClone, Pose, Recipe};
use serde::{Deserialize, Serialize};

/// Largest number of layers of an edit.
const MAX_LAYERS: usize = 1000;

/// An edit: layers, whose gains multiply, and constraints on the new positions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Revision number, increased by the page with every change.
    pub revision: u64,
    /// Layers of the edit; their order does not matter.
    #[serde(default)]
    pub layers: Vec<DocumentLayer>,
    /// Directions in which vertices may move; the default of the shape if `None`.
    #[serde(default)]
    pub along: Option<MoveDirection>,
    /// Treatment of open borders.
    #[serde(default)]
    pub border: Borders,
    /// Treatment of the volume of a closed surface.
    #[serde(default)]
    pub volume: Volume,
    /// Clones of detail, on top of the layers.
    #[serde(default)]
    pub clones: Vec<DetailClone>,
    /// Handles that bend the shape after all else.
    #[serde(default)]
    pub pose: Option<Pose>,
}

/// One layer: `1 + opacity·r(x)·(g_j − 1)` times each band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DocumentLayer {
    /// Display name.
    pub name: String,
    /// Switch; a layer that is off has no effect.
    pub on: bool,
    /// Opacity in [0, 1].
    pub opacity: f64,
    /// Gains g_1 … g_J, fine to coarse.
    pub gains: Vec<f64>,
    /// Region of the layer; the whole shape if `None`.
    #[serde(default)]
    pub region: Option<Region>,
}

impl DocumentLayer {
    /// Converts to the layer of a recipe with the same effect.
    fn to_recipe_layer(&self) -> Layer {
        let gains = self.gains.iter().map(|g| 1.0 + self.opacity * (g - 1.0)).collect();
        Layer { gains: Gains::Gains(gains), region: self.region.clone().unwrap_or(Region::Everywhere {}) }
    }
}

impl Document {
    /// Checks the rules that do not depend on the shape.
    pub(crate) fn check(&self, n_levels: usize) -> Result<(), ApiError> {
        if self.layers.len() > MAX_LAYERS {
            let n = self.layers.len();
            return Err(ApiError::bad_request(format!(
                "an edit has at most {MAX_LAYERS} layers, got {n}; merge some"
            )));
        }
        self.reshaped_by().check()?;
        for (k, layer) in self.layers.iter().enumerate() {
            let label = || format!("layer {} ('{}')", k + 1, layer.name);
            if !(0.0..=1.0).contains(&layer.opacity) {
                return Err(ApiError::bad_request(format!(
                    "{}: opacity must be in [0, 1], got {}",
                    label(),
                    layer.opacity
                )));
            }
            if layer.gains.len() != n_levels {
                let n = layer.gains.len();
                return Err(ApiError::bad_request(format!(
                    "{}: one gain per level is needed, got {n} gains for {n_levels} levels",
                    label()
                )));
            }
        }
        Ok(())
    }

    /// Edits beside those of bands.
    pub(crate) fn reshaped_by(&self) -> ReshapedBy {
        ReshapedBy { clones: self.clones.clone(), pose: self.pose.clone() }
    }

    /// Maps the gains of levels of widths `before` to levels of widths `after`; see [`map_gains`].
    pub(crate) fn map_levels(&mut self, before: &[f64], after: &[f64]) {
        for layer in &mut self.layers {
            layer.gains = map_gains(&layer.gains, before, after);
        }
    }

    /// Returns the layers that are on.
    pub(crate) fn active_layers(&self) -> Vec<Layer> {
        self.layers.iter().filter(|layer| layer.on).map(DocumentLayer::to_recipe_layer).collect()
    }

    pub(crate) fn position_params(&self) -> PositionParams {
        PositionParams { along: self.along, borders: self.border, volume: self.volume }
    }

    /// Tells whether new positions are more than a sum of bands; by default a cloud moves along its normals.
    pub(crate) fn has_constraints(&self, is_cloud: bool) -> bool {
        let is_free = self.along.map_or(!is_cloud, |along| along == MoveDirection::Free);
        !(is_free && self.border == Borders::default() && self.volume == Volume::default())
    }

    /// Converts to a recipe, which the command and the Python package replay bit-identically.
    pub(crate) fn to_recipe(&self, levels: &LevelSpec, operator: OperatorKind) -> Recipe {
        Recipe {
            levels: levels.clone(),
            operator: Some(operator),
            // The studio sums bands of the coordinates, which are about their mean.
            local_fit: self.along.and_then(MoveDirection::axis).map(|_| LocalFit::Constant),
            positions: self.position_params(),
            layers: self.active_layers(),
            clones: self.clones.clone(),
            pose: self.pose.clone(),
            ..Recipe::default()
        }
    }

    /// Converts a recipe to an edit of `n_levels` levels.
    pub(crate) fn from_recipe(recipe: &Recipe, n_levels: usize, revision: u64) -> Result<Self, ApiError> {
        if recipe.field != "coords" {
            let hint = "the studio edits coordinates only; apply it with `adwave filter --recipe`";
            return Err(ApiError::bad_request(format!(
                "the recipe filters the field '{}': {hint}",
                recipe.field
            )));
        }
        if recipe.density_invariant || recipe.keep_creases {
            let message = "the studio does not support density_invariant and keep_creases; \
                           apply the recipe with `adwave filter --recipe`";
            return Err(ApiError::bad_request(message));
        }
        let moves_along_axis = recipe.positions.along.and_then(MoveDirection::axis).is_some();
        if moves_along_axis && recipe.local_fit != Some(LocalFit::Constant) {
            let message = "the studio smooths heights about their mean, which drags slopes to where the samples lie; \
                           write local_fit = \"constant\" into the recipe, or apply it with `adwave filter --recipe`";
            return Err(ApiError::bad_request(message));
        }
        let layer = |(k, layer): (usize, &Layer)| {
            let gains = layer.gains.resolve(n_levels).map_err(|e| ApiError::from_classified(&e))?;
            let region = Some(layer.region.clone()).filter(|region| *region != Region::Everywhere {});
            Ok(DocumentLayer { name: format!("layer {}", k + 1), on: true, opacity: 1.0, gains, region })
        };
        let layers = recipe.layers.iter().enumerate().map(layer).collect::<Result<_, ApiError>>()?;
        let PositionParams { along, borders, volume } = recipe.positions;
        let (clones, pose) = (recipe.clones.clone(), recipe.pose.clone());
        Ok(Self { revision, layers, along, border: borders, volume, clones, pose })
    }
}

/// Gains for levels of other widths σ, in model units, increasing: the mean of the old gains over the octaves that a new
/// band covers. Detail coarser than all old bands keeps the gain 1; equal levels keep their gains.
///
/// The page computes the same numbers for edits made while the server computes the bands.
pub(crate) fn map_gains(gains: &[f64], before: &[f64], after: &[f64]) -> Vec<f64> {
    let finest = before.iter().chain(after).copied().fold(f64::INFINITY, f64::min) / 2.0;
    // The range of widths of each band, in octaves.
    let ranges = |widths: &[f64]| -> Vec<(f64, f64)> {
        let ends: Vec<f64> = widths.iter().map(|w| (w / finest).log2()).collect();
        let starts = std::iter::once(0.0).chain(ends.iter().copied());
        starts.zip(ends.iter().copied()).collect()
    };
    let old = ranges(before);
    let mapped = |(start, end): (f64, f64)| {
        let shares =
            old.iter().zip(gains).map(|(&(low, high), &gain)| (end.min(high) - start.max(low), gain));
        let beyond = end - start.max(old.last().map_or(0.0, |last| last.1));
        let covered: Vec<(f64, f64)> =
            shares.chain([(beyond, 1.0)]).filter(|(share, _)| *share > 1e-6).collect();
        match covered.first() {
            None => 1.0,
            Some((_, first)) if covered.iter().all(|(_, gain)| gain == first) => *first,
            Some(_) => {
                let total: f64 = covered.iter().map(|(share, _)| share).sum();
                covered.iter().map(|(share, gain)| share * gain).sum::<f64>() / total
            }
        }
    };
    ranges(after).into_iter().map(mapped).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_follow_their_widths_to_other_levels() {
        let widths = [1.0, 2.0, 4.0];
        assert_eq!(map_gains(&[0.5, 3.0, 2.0], &widths, &widths), [0.5, 3.0, 2.0]);
        // Coarser detail than all old bands is not changed, and neither is that of a band between them.
        assert_eq!(map_gains(&[0.5, 3.0, 2.0], &widths, &[1.0, 2.0, 4.0, 8.0]), [0.5, 3.0, 2.0, 1.0]);
        // A band that covers two old ones takes their mean; two within one take its gain.
        assert_eq!(map_gains(&[0.5, 3.0, 2.0], &widths, &[1.0, 4.0]), [0.5, 2.5]);
        assert_eq!(map_gains(&[0.5, 3.0], &widths[..2], &[1.0, 1.5, 2.0]), [0.5, 3.0, 3.0]);
        // Finer than all old bands is part of the finest.
        assert_eq!(map_gains(&[0.5, 3.0], &widths[..2], &[0.25, 1.0, 2.0]), [0.5, 0.5, 3.0]);
        assert_eq!(map_gains(&[], &[], &[1.0]), [1.0]);
    }
}
