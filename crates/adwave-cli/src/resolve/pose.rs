//! The pose of a recipe, bound to a shape.

use super::region::region_weights;
use super::shape::Input;
use crate::error::CliError;
use adwave::operator::OperatorParams;
use adwave::region::Region;
use adwave::{Decomposer, Progress};
use adwave_deform::{DeformInfo, Deformer, bind_pose, reshape, set_pose};
use adwave_io::{DetailClone, Pose, Recipe};

/// Binds a shape to the handles of a pose and bends it, as the studio does.
pub(crate) fn bend(
    pose: &Pose,
    input: &Input,
    decomposer: &Decomposer,
    progress: Progress<'_>,
) -> Result<BentShape, CliError> {
    let vertices = |region: &Region| vertices(region, input, decomposer, progress);
    let mut deformer = bind_pose(decomposer, pose, None, vertices, progress)?;
    set_pose(&mut deformer, pose)?;
    let info = deformer.solve(progress)?;
    Ok(BentShape { deformer, info })
}

/// Vertices of a region with a weight above 0.
fn vertices(
    region: &Region,
    input: &Input,
    decomposer: &Decomposer,
    progress: Progress<'_>,
) -> Result<Vec<u32>, CliError> {
    let weights = region_weights(region, input, decomposer, progress)?;
    Ok((0..).zip(&weights).filter(|(_, w)| **w > 0.0).map(|(v, _)| v).collect())
}

/// A shape in its pose.
pub(crate) struct BentShape {
    pub(crate) deformer: Deformer,
    pub(crate) info: DeformInfo,
}

/// Edits of a recipe other than those of bands: clones and a pose.
#[derive(Clone, Debug, Default)]
pub(crate) struct ReshapedBy {
    pub(crate) clones: Vec<DetailClone>,
    /// A pose with handles.
    pub(crate) pose: Option<Pose>,
}

impl ReshapedBy {
    /// Clones and pose of a recipe; `None` if it has neither.
    pub(crate) fn from_recipe(recipe: &Recipe) -> Option<Self> {
        let pose = recipe.pose.clone().filter(|pose| !pose.handles.is_empty());
        let clones = recipe.clones.clone();
        (pose.is_some() || !clones.is_empty()).then_some(Self { clones, pose })
    }
}

/// Positions of the shape of `input` after an edit of its bands, with clones of detail, carried into a pose.
pub(crate) fn reshaped_points(
    by: &ReshapedBy,
    input: &Input,
    points: Vec<[f64; 3]>,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, CliError> {
    // The base is that of the walk, whatever smooths the bands.
    let decomposer = Decomposer::with_params(&input.shape, &OperatorParams::default(), progress)
        .map_err(|e| CliError::classify(&e))?;
    let vertices = |region: &Region| vertices(region, input, &decomposer, progress);
    reshape(&decomposer, &by.clones, by.pose.as_ref(), points, vertices, progress)
}
