//! The edit of a shape as the page keeps it, and as the recipe that it is.

use crate::answer::Refused;
use adwave::filter::{Gains, Layer};
use adwave::operator::OperatorKind;
use adwave::positions::{Along, Borders, PositionParams, Volume};
use adwave::region::Region;
use adwave::LevelSpec;
use adwave_io::Recipe;
use serde::{Deserialize, Serialize};

/// The most layers of an edit.
const MAX_LAYERS: usize = 1000;

/// An edit: layers that multiply, and what is asked of new positions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    /// Counted up by the page with every change.
    pub revision: u64,
    /// What is changed where.
    #[serde(default)]
    pub layers: Vec<DocumentLayer>,
    /// In which directions vertices move.
    #[serde(default)]
    pub along: Option<Along>,
    /// What becomes of open borders.
    #[serde(default)]
    pub border: Borders,
    /// Whether a closed surface keeps its volume.
    #[serde(default)]
    pub volume: Volume,
}

/// One layer: `1 + opacity·r(x)·(g_j − 1)` times each band.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DocumentLayer {
    /// What it is called.
    pub name: String,
    /// Whether it does anything.
    pub on: bool,
    /// In [0, 1].
    pub opacity: f64,
    /// g_1 … g_J, fine to coarse.
    pub gains: Vec<f64>,
    /// Where; everywhere where there is none.
    #[serde(default)]
    pub region: Option<Region>,
}

impl DocumentLayer {
    /// The layer of a recipe that does the same.
    fn layer(&self) -> Layer {
        let gains = self.gains.iter().map(|g| 1.0 + self.opacity * (g - 1.0)).collect();
        Layer { gains: Gains::Gains(gains), region: self.region.clone().unwrap_or(Region::Everywhere {}) }
    }
}

impl Document {
    /// Checks what does not need the shape.
    pub(crate) fn check(&self, n_levels: usize) -> Result<(), Refused> {
        if self.layers.len() > MAX_LAYERS {
            let n = self.layers.len();
            return Err(Refused::wrong(format!("{n} layers are more than {MAX_LAYERS}; join some")));
        }
        for (k, layer) in self.layers.iter().enumerate() {
            let at = || format!("layer {} ('{}')", k + 1, layer.name);
            if !(0.0..=1.0).contains(&layer.opacity) {
                return Err(Refused::wrong(format!("{}: opacity {} is not in [0, 1]", at(), layer.opacity)));
            }
            if layer.gains.len() != n_levels {
                let n = layer.gains.len();
                return Err(Refused::wrong(format!("{}: {n} gains for {n_levels} levels", at())));
            }
        }
        Ok(())
    }

    /// The layers that do something.
    pub(crate) fn layers(&self) -> Vec<Layer> {
        self.layers.iter().filter(|layer| layer.on).map(DocumentLayer::layer).collect()
    }

    pub(crate) fn positions(&self) -> PositionParams {
        PositionParams { along: self.along, borders: self.border, volume: self.volume }
    }

    /// Whether more is asked of new positions than that bands are summed; a cloud moves along its normals unasked.
    pub(crate) fn has_rules(&self, is_cloud: bool) -> bool {
        let is_free = self.along.map_or(!is_cloud, |along| along == Along::Free);
        !(is_free && self.border == Borders::default() && self.volume == Volume::default())
    }

    /// The edit as a recipe, which the command and the Python package replay to the same bits.
    pub(crate) fn recipe(&self, levels: &LevelSpec, operator: OperatorKind) -> Recipe {
        Recipe {
            levels: levels.clone(),
            operator: Some(operator),
            positions: self.positions(),
            layers: self.layers(),
            ..Recipe::default()
        }
    }

    /// A recipe as an edit for so many levels.
    pub(crate) fn of_recipe(recipe: &Recipe, n_levels: usize, revision: u64) -> Result<Self, Refused> {
        if recipe.field != "coords" {
            let told = "the studio edits coordinates; apply this recipe with the command or the Python package";
            return Err(Refused::wrong(format!("the recipe is of the field '{}': {told}", recipe.field)));
        }
        if recipe.density_invariant || recipe.keep_creases {
            let told = "the studio has neither density_invariant nor keep_creases; apply this recipe with the command or the Python package";
            return Err(Refused::wrong(told));
        }
        let layer = |(k, layer): (usize, &Layer)| {
            let gains = layer.gains.resolve(n_levels).map_err(|e| Refused::of(&e))?;
            let region = Some(layer.region.clone()).filter(|region| *region != Region::Everywhere {});
            Ok(DocumentLayer { name: format!("layer {}", k + 1), on: true, opacity: 1.0, gains, region })
        };
        let layers = recipe.layers.iter().enumerate().map(layer).collect::<Result<_, Refused>>()?;
        let PositionParams { along, borders, volume } = recipe.positions;
        Ok(Self { revision, layers, along, border: borders, volume })
    }
}
