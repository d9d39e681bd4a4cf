//! Large clouds: features are sought among some of their points, evenly spread, and the motion is refined on all.

use super::Side;
use crate::error::CliError;
use crate::global::Global;
use crate::output::count;
use crate::output::progress::with_progress;
use crate::resolve::operator::note_outsiders;
use crate::resolve::shape::{Carrier, Input};
use adwave::Progress;
use adwave::operator::OperatorParams;
use adwave::shape::{PointCloud, PreparedGeometry};
use adwave_io::{ShapeFile, ShapeKind};
use adwave_register::{AlignParams, ClosestPointSearch, RegisteredMotion, align};
use adwave_simplify::{CloudTarget, simplify_cloud};

/// A cloud of which some points are searched for features.
pub(super) struct WholeCloud {
    pub(super) file: ShapeFile,
    geometry: PreparedGeometry,
}

impl WholeCloud {
    pub(super) fn n_vertices(&self) -> usize {
        self.file.n_vertices()
    }
}

/// Splits a cloud of more than `most` points into about as many of them, evenly spread and without strays, and the
/// whole cloud. Other shapes stay as they are.
pub(super) fn split(
    input: Input,
    most: usize,
    operator: &OperatorParams,
    global: &Global<'_>,
) -> Result<(Input, Option<WholeCloud>), CliError> {
    let is_cloud = input.shape.is_cloud() && matches!(input.carrier, Carrier::Shape);
    if !is_cloud || input.shape.n_vertices() <= most {
        return Ok((input, None));
    }
    let geometry = with_progress(global, "preparing", |progress| {
        PreparedGeometry::new(&input.shape, operator.weld, progress).map_err(|_| CliError::Cancelled)
    })?;
    note_outsiders(Some(&geometry), &input, global);
    let is_searched = with_progress(global, "thinning", |progress| spread(&geometry, most, progress))?;
    if is_searched.iter().all(|is| *is) {
        // Points on a line or a grid may have no spacing that leaves fewer.
        return Ok((input, None));
    }
    let file = input.file.select_rows(&is_searched)?;
    let shape =
        file.to_shape_as(ShapeKind::Cloud).map_err(|e| CliError::Input(format!("{}: {e}", input.name)))?;
    global.inputs.add_remark(format!(
        "{}: features are sought among {} of {}, evenly spread (--search-points N for more or fewer)",
        input.name,
        file.n_vertices(),
        count(input.file.n_vertices(), "point", "points"),
    ));
    let whole = WholeCloud { file: input.file, geometry };
    Ok((Input { file, shape, ..input }, Some(whole)))
}

/// Whether each point is one of about `most` members of a cloud that are evenly spread.
fn spread(geometry: &PreparedGeometry, most: usize, progress: Progress<'_>) -> Result<Vec<bool>, CliError> {
    let points = geometry.shape().points().unwrap_or_default();
    let mut is_member = vec![true; points.len()];
    for (vertex, _) in geometry.outsiders() {
        is_member[vertex] = false;
    }
    let members: Vec<usize> = (0..points.len()).filter(|&x| is_member[x]).collect();
    let cloud = PointCloud::new(members.iter().map(|&x| points[x]).collect())
        .map_err(|e| CliError::Input(e.to_string()))?;
    let thinned = simplify_cloud(&cloud, CloudTarget::About(most), progress)?;
    let mut is_kept = vec![false; points.len()];
    for x in thinned.kept {
        is_kept[members[x as usize]] = true;
    }
    Ok(is_kept)
}

/// Refines a motion that was found between thinned clouds on all points of both.
pub(super) fn refine(
    first: &Side,
    second: &Side,
    found: &mut RegisteredMotion,
    is_scaled: bool,
    progress: Progress<'_>,
) -> Result<(), CliError> {
    if first.whole.is_none() && second.whole.is_none() {
        return Ok(());
    }
    let points = first.whole.as_ref().map_or(first.input.file.points(), |whole| whole.file.points());
    let search = match &second.whole {
        Some(whole) => ClosestPointSearch::new(&whole.geometry, progress).map_err(|_| CliError::Cancelled)?,
        None => None,
    };
    let surface = search.as_ref().unwrap_or(&second.registrand.surface);
    let params = AlignParams::default().with_scaled(is_scaled);
    let (motion, info) =
        align(points, surface, found.motion, &params, progress).map_err(|_| CliError::Cancelled)?;
    found.motion = motion;
    found.fit.median = info.median;
    Ok(())
}
