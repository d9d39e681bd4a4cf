//! Fig. 9: saliency of two poses, by ours and by Lee, Varshney & Jacobs.

use super::draw::{Frame, Sheet};
use super::numbers::{bands, mean_curvature, percent, prepare_model};
use super::{Context, FigureError, Outcome, Table, Verdict, digits};
use crate::analysis::saliency;
use adwave::measure::{correlation, rank_correlation, shared_top};
use adwave::saliency::{SaliencyParams, Weighting};
use adwave::shape::bounding_box;
use adwave_baselines::lee::lee_saliency;
use std::time::Instant;

const N_VERTICES: usize = 25_000;
const N_LEVELS: usize = 8;
/// How far the top is turned against the bottom, radians.
const TWIST: f64 = 0.7;
/// How far the upper half is bent to the side, radians.
const BEND: f64 = 0.5;
/// Maps of two poses agree when their correlation is at least this.
const AGREES: f64 = 0.8;
/// Two methods have similar effects when the ranks of their maps correlate at least this much.
const SIMILAR: f64 = 0.5;

pub(super) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let first = context.model_or(&["armadillo"], "creature", N_VERTICES)?;
    let second = first.moved(&format!("{} bent", first.name), bent(first.points())?);
    let mut ours = Vec::new();
    let mut alike = Vec::new();
    let mut theirs = Vec::new();
    let (mut our_seconds, mut their_seconds) = (0.0, 0.0);
    for pose in [&*first, &second] {
        let start = Instant::now();
        let decomposer = prepare_model(pose);
        let curvature = mean_curvature(&decomposer)?;
        let bands = bands(context, &decomposer, &curvature, 1, N_LEVELS)?;
        ours.push(saliency(&decomposer, &bands, &SaliencyParams::paper())?.map);
        our_seconds += 0.5 * start.elapsed().as_secs_f64();
        let equal = SaliencyParams::paper().with_weighting(Weighting::Normalized);
        alike.push(saliency(&decomposer, &bands, &equal)?.map);
        let start = Instant::now();
        theirs.push(lee_saliency(&pose.shape, context.progress)?.saliency);
        their_seconds += 0.5 * start.elapsed().as_secs_f64();
    }
    let methods = [("Lee et al.", &theirs), ("ours", &ours), ("ours, levels alike", &alike)];
    let mut sheet = Sheet::new(methods.len());
    for (pose, model) in [(0, &*first), (1, &second)] {
        for (method, maps) in methods {
            sheet.push(Frame::new(model, format!("{method}, pose {}", pose + 1)).saliency(&maps[pose]));
        }
    }
    let mut table = Table::new(
        "fig09.csv",
        "How alike the maps are",
        &[
            "compared",
            "correlation",
            "correlation of ranks",
            "shared part of the top 5 % (%)",
            "seconds a map",
        ],
    );
    let mut row = |what: &str, a: &[f64], b: &[f64], seconds: String| {
        let shared = 100.0 * shared_top(a, b, 0.05);
        table.push([
            what.to_owned(),
            digits(correlation(a, b)),
            digits(rank_correlation(a, b)),
            digits(shared),
            seconds,
        ]);
    };
    row("ours, pose 1 and 2", &ours[0], &ours[1], digits(our_seconds));
    row("Lee et al., pose 1 and 2", &theirs[0], &theirs[1], digits(their_seconds));
    row("ours and Lee et al., pose 1", &ours[0], &theirs[0], String::new());
    row("ours and Lee et al., pose 2", &ours[1], &theirs[1], String::new());
    row("ours with levels weighed alike, pose 1 and 2", &alike[0], &alike[1], String::new());
    row("ours with levels weighed alike and Lee et al., pose 1", &alike[0], &theirs[0], String::new());
    let (we, they) = (correlation(&ours[0], &ours[1]), correlation(&theirs[0], &theirs[1]));
    let between = rank_correlation(&ours[0], &theirs[0]);
    let top = shared_top(&ours[0], &theirs[0], 0.05);
    let verdict = Verdict::from_parts(
        &[we >= AGREES, they >= AGREES, between >= SIMILAR],
        format!(
            "The maps of the two poses correlate by {we:.2} with ours and by {they:.2} with Lee's (from {AGREES} on they are \
             taken to agree). Ours and Lee's correlate by {between:.2} in their ranks and share {} of the top 5 % (from \
             {SIMILAR} on they are taken as similar); with all levels weighed alike the ranks correlate by {:.2}.",
            percent(top),
            rank_correlation(&alike[0], &theirs[0])
        ),
    );
    Ok(Outcome::new(verdict)
        .on(first.label())
        .sheet(
            "fig09.png",
            "Saliency of mean curvature in two poses. From left to right: by Lee et al., by ours as eq. 17 has it, and by ours with all levels \
             weighed alike. The second pose is the first, twisted and bent.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "The paper has two deformed shapes of the Armadillo, which are not public; here the second pose is made by \
             twisting the figure about its height and bending its upper half. Both methods subtract two smoothings of mean \
             curvature: Lee's by balls in space whose sizes are fixed parts of the diagonal, ours by walks along the \
             surface. By eq. 17 the finest of the levels that count outweighs the others, and on a fine mesh it is as fine as \
             Lee's finest or finer; the row with levels weighed alike shows how much of the difference that explains.",
        ))
}

/// A smooth twist about y, and a bend of the upper half about z.
fn bent(points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, FigureError> {
    let (low, high) = bounding_box(points).ok_or("the model has no vertices")?;
    let middle: [f64; 3] = std::array::from_fn(|c| 0.5 * (low[c] + high[c]));
    let height = (high[1] - low[1]).max(f64::MIN_POSITIVE);
    let hip = low[1] + 0.35 * height;
    let one = |p: &[f64; 3]| {
        let up = (p[1] - low[1]) / height;
        let twist = TWIST * (up - 0.5);
        let (x, z) = (p[0] - middle[0], p[2] - middle[2]);
        let (x, z) = (x * twist.cos() + z * twist.sin(), z * twist.cos() - x * twist.sin());
        // The spine becomes an arc above the hip: its angle grows evenly with height.
        let above = (p[1] - hip) / (high[1] - hip);
        let angle = BEND * above.max(0.0);
        let radius = (high[1] - hip) / BEND;
        if angle > 0.0 {
            let out = radius - x;
            [middle[0] + radius - out * angle.cos(), hip + out * angle.sin(), middle[2] + z]
        } else {
            [middle[0] + x, p[1], middle[2] + z]
        }
    };
    Ok(points.iter().map(one).collect())
}

#[cfg(test)]
mod tests {
    use super::super::Model;
    use super::*;

    #[test]
    fn the_second_pose_keeps_lengths_along_the_spine() {
        let spine: Vec<[f64; 3]> = (0..=100).map(|k| [0.0, f64::from(k) / 100.0, 0.0]).collect();
        let bent = bent(&spine).unwrap();
        for pair in bent.windows(2) {
            let length = super::super::numbers::distance(&pair[0], &pair[1]);
            // A chord is shorter than its arc by a part of angle²/24.
            assert!((length - 0.01).abs() < 1e-6, "{length}");
        }
        assert!(bent[100][0] > 0.1, "bent to the side");
    }

    #[test]
    fn a_model_that_is_moved_keeps_its_faces() {
        let model = Model::built_in("sphere", 100).unwrap();
        let moved = model.moved("bent", bent(model.points()).unwrap());
        assert_eq!(moved.triangles, model.triangles);
        assert_ne!(moved.points(), model.points());
    }
}
