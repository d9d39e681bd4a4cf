//! Edit of a shape, in the form of the page and as a recipe.

use crate::field_bands::FIELD_FIT;
use crate::listed::{DocumentPose, ListedItem};
use crate::pose::ReshapedBy;
use crate::response::ApiError;
use adwave::LevelSpec;
use adwave::filter::{Gains, Layer};
use adwave::local_fit::LocalFit;
use adwave::operator::OperatorKind;
use adwave::positions::{Borders, MoveDirection, PositionParams, Volume};
use adwave::region::Region;
use adwave_io::{DetailClone, Recipe};
use serde::{Deserialize, Serialize};

/// Largest number of layers of the positions, and of each field.
const MAX_LAYERS: usize = 1000;
/// Largest number of edited fields.
const MAX_FIELDS: usize = 200;

/// Edit of a shape: layers, whose gains multiply, and constraints on the new positions.
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
    pub clones: Vec<ListedItem<DetailClone>>,
    /// Handles that bend the shape after all other edits.
    #[serde(default)]
    pub pose: Option<DocumentPose>,
    /// First vertices of the parts of a mesh whose faces are turned over in saved files, ascending.
    #[serde(default)]
    pub turned: Vec<u32>,
    /// Edits of fields; the layers above do not change fields.
    #[serde(default)]
    pub fields: Vec<FieldEdit>,
}

/// Edit of one field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FieldEdit {
    /// Name of the field.
    pub field: String,
    /// Layers of the field; their order does not matter.
    pub layers: Vec<DocumentLayer>,
    /// True if the edit of the field has an effect.
    #[serde(default = "default_eye", skip_serializing_if = "is_on")]
    pub on: bool,
}

fn default_eye() -> bool {
    true
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands the field by reference")]
fn is_on(on: &bool) -> bool {
    *on
}

/// Layer of an edit, which multiplies band j by `1 + opacity·r(x)·(g_j − 1)`, where r is the weight of its region.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DocumentLayer {
    /// Display name.
    pub name: String,
    /// True if the layer has an effect.
    pub on: bool,
    /// Opacity in [0, 1].
    pub opacity: f64,
    /// Gains g_1 … g_J, fine to coarse.
    pub gains: Vec<f64>,
    /// Region of the layer; the whole shape if `None`.
    #[serde(default)]
    pub region: Option<Region>,
    /// Name of the preset that the gains were set to last; they may have changed since.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
}

impl DocumentLayer {
    fn has_effect(&self) -> bool {
        self.on && self.opacity > 0.0 && self.gains.iter().any(|gain| *gain != 1.0)
    }

    /// Converts to the layer of a recipe with the same effect.
    fn to_recipe_layer(&self) -> Layer {
        let faded = |g: &f64| if self.opacity == 1.0 { *g } else { 1.0 + self.opacity * (g - 1.0) };
        let gains = self.gains.iter().map(faded).collect();
        Layer { gains: Gains::Gains(gains), region: self.region.clone().unwrap_or(Region::Everywhere {}) }
    }
}

fn to_recipe_layers(layers: &[DocumentLayer]) -> Vec<Layer> {
    layers.iter().filter(|layer| layer.on).map(DocumentLayer::to_recipe_layer).collect()
}

/// Checks the layers of the positions or of a field.
fn check_layers(layers: &[DocumentLayer], n_levels: usize) -> Result<(), ApiError> {
    if layers.len() > MAX_LAYERS {
        let n = layers.len();
        return Err(ApiError::bad_request(format!(
            "an edit has at most {MAX_LAYERS} layers, got {n}; merge some"
        )));
    }
    for (k, layer) in layers.iter().enumerate() {
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

impl Document {
    /// Checks the rules that do not depend on the shape.
    pub(crate) fn check(&self, n_levels: usize) -> Result<(), ApiError> {
        self.reshaped_by().check()?;
        let is_unsorted = |pair: &&[u32]| pair[0] >= pair[1];
        if let Some(&[before, after]) = self.turned.windows(2).find(is_unsorted) {
            return Err(ApiError::bad_request(format!(
                "turned parts must be in ascending order, each once, got {before} before {after}; sort them"
            )));
        }
        check_layers(&self.layers, n_levels)?;
        if self.fields.len() > MAX_FIELDS {
            let n = self.fields.len();
            return Err(ApiError::bad_request(format!(
                "an edit changes at most {MAX_FIELDS} fields, got {n}; reset some"
            )));
        }
        for (k, edit) in self.fields.iter().enumerate() {
            let name = &edit.field;
            if self.fields[..k].iter().any(|other| other.field == *name) {
                return Err(ApiError::bad_request(format!(
                    "each field has one list of layers, got two for '{name}'; merge them"
                )));
            }
            check_layers(&edit.layers, n_levels).map_err(|e| e.with_prefix(&format!("field '{name}': ")))?;
        }
        Ok(())
    }

    /// Returns the clones that are on, in their order.
    fn active_clones(&self) -> Vec<DetailClone> {
        self.clones.iter().filter(|clone| clone.on).map(|clone| clone.item.clone()).collect()
    }

    /// Returns the edits other than those of bands that are on.
    pub(crate) fn reshaped_by(&self) -> ReshapedBy {
        let pose = self.pose.as_ref().map(DocumentPose::to_pose);
        ReshapedBy { clones: self.active_clones(), pose }
    }

    /// Maps the gains from levels of widths `before` to levels of widths `after`, both in model units; see
    /// [`map_gains`].
    pub(crate) fn map_levels(&mut self, before: &[f64], after: &[f64]) {
        let of_fields = self.fields.iter_mut().flat_map(|edit| &mut edit.layers);
        for layer in self.layers.iter_mut().chain(of_fields) {
            layer.gains = map_gains(&layer.gains, before, after);
        }
    }

    /// Returns the layers that are on.
    pub(crate) fn active_layers(&self) -> Vec<Layer> {
        to_recipe_layers(&self.layers)
    }

    /// Returns the layers of a field that are on.
    pub(crate) fn active_field_layers(&self, name: &str) -> Vec<Layer> {
        let edit = self.fields.iter().find(|edit| edit.field == name);
        edit.filter(|edit| edit.on).map_or_else(Vec::new, |edit| to_recipe_layers(&edit.layers))
    }

    /// True if the edit moves vertices or turns faces.
    pub(crate) fn changes_positions(&self) -> bool {
        let is_reshaped = !self.clones.is_empty() || self.pose.is_some() || !self.turned.is_empty();
        is_reshaped || self.layers.iter().any(DocumentLayer::has_effect)
    }

    /// Returns the names of the fields with a layer that has an effect.
    pub(crate) fn changed_fields(&self) -> Vec<String> {
        let is_changed = |edit: &&FieldEdit| edit.on && edit.layers.iter().any(DocumentLayer::has_effect);
        let changed = self.fields.iter().filter(is_changed);
        changed.map(|edit| edit.field.clone()).collect()
    }

    pub(crate) fn position_params(&self) -> PositionParams {
        PositionParams::default().with_along(self.along).with_borders(self.border).with_volume(self.volume)
    }

    /// True if new positions are more than a sum of bands; by default a cloud moves along its normals.
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
            clones: self.active_clones(),
            pose: self.pose.as_ref().map(DocumentPose::to_pose),
            turned: self.turned.clone(),
            ..Recipe::default()
        }
    }

    /// Converts the edit of a field to a recipe, which `adwave filter --recipe` replays.
    pub(crate) fn to_field_recipe(&self, name: &str, levels: &LevelSpec, operator: OperatorKind) -> Recipe {
        Recipe {
            field: name.to_owned(),
            levels: levels.clone(),
            operator: Some(operator),
            local_fit: Some(FIELD_FIT),
            layers: self.active_field_layers(name),
            ..Recipe::default()
        }
    }

    /// Replaces the layers of a field.
    pub(crate) fn with_field_layers(mut self, name: &str, layers: Vec<DocumentLayer>) -> Self {
        self.fields.retain(|edit| edit.field != name);
        self.fields.push(FieldEdit { field: name.to_owned(), layers, on: true });
        self
    }

    /// Converts a recipe of the positions to an edit of `n_levels` levels, without fields.
    pub(crate) fn from_recipe(recipe: &Recipe, n_levels: usize, revision: u64) -> Result<Self, ApiError> {
        let moves_along_axis = recipe.positions.along.and_then(MoveDirection::axis).is_some();
        if moves_along_axis && recipe.local_fit != Some(LocalFit::Constant) {
            let message = "the studio smooths heights about their mean, which drags slopes to where the samples lie; \
                           write local_fit = \"constant\" into the recipe, or apply it with `adwave filter --recipe`";
            return Err(ApiError::bad_request(message));
        }
        let layers = layers_of_recipe(recipe, n_levels)?;
        let PositionParams { along, borders, volume, .. } = recipe.positions;
        let clones = recipe.clones.iter().cloned().map(ListedItem::from).collect();
        let (pose, turned) = (recipe.pose.clone().map(DocumentPose::from), recipe.turned.clone());
        Ok(Self {
            revision,
            layers,
            along,
            border: borders,
            volume,
            clones,
            pose,
            turned,
            fields: Vec::new(),
        })
    }
}

/// Converts the layers of a recipe to those of an edit of `n_levels` levels.
pub(crate) fn layers_of_recipe(recipe: &Recipe, n_levels: usize) -> Result<Vec<DocumentLayer>, ApiError> {
    let preset_of = |layer: &Layer| match &layer.gains {
        Gains::Preset(preset) => Some(preset.name().to_owned()),
        _ => None,
    };
    let layer = |(k, layer): (usize, &Layer)| {
        let gains = layer.gains.resolve(n_levels).map_err(|e| ApiError::from_classified(&e))?;
        let region = Some(layer.region.clone()).filter(|region| *region != Region::Everywhere {});
        Ok(DocumentLayer {
            name: format!("layer {}", k + 1),
            on: true,
            opacity: 1.0,
            gains,
            region,
            preset: preset_of(layer),
        })
    };
    recipe.layers.iter().enumerate().map(layer).collect()
}

/// Maps gains to levels of other widths σ, in model units and increasing: the mean of the old gains over the octaves
/// that a new band covers. Detail coarser than all old bands keeps the gain 1; equal levels keep their gains.
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
