//! Fig. 9: saliency of two poses, by this method and by Lee, Varshney & Jacobs.

use crate::draw::{Sheet, SheetPanel};
use crate::numbers::{bands, decomposer, mean_curvature, percent};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::measure::{correlation, rank_correlation, shared_top};
use adwave::saliency::{SaliencyParams, Weighting};
use adwave::shape::bounding_box;
use adwave_baselines::lee::lee_saliency;
use adwave_report::analysis::saliency;
use std::time::Instant;

const N_VERTICES: usize = 25_000;
const N_LEVELS: usize = 8;
/// Rotation of the top relative to the bottom, in radians.
const TWIST: f64 = 0.7;
/// Angle by which the upper half is bent to the side, in radians.
const BEND: f64 = 0.5;
/// Smallest correlation at which the maps of two poses agree.
const AGREES: f64 = 0.8;
/// Smallest rank correlation at which the maps of two methods are similar.
const SIMILAR: f64 = 0.5;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let first = context.model_or(&["armadillo"], "creature", N_VERTICES)?;
    let second = first.with_points(&format!("{} bent", first.name), bend(first.points())?);
    let mut ours = Vec::new();
    let mut alike = Vec::new();
    let mut theirs = Vec::new();
    let (mut our_seconds, mut their_seconds) = (0.0, 0.0);
    for pose in [&*first, &second] {
        let start = Instant::now();
        let decomposer = decomposer(pose);
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
    let methods = [("Lee et al.", &theirs), ("ours", &ours), ("ours, equal weights", &alike)];
    let mut sheet = Sheet::new(methods.len());
    for (pose, model) in [(0, &*first), (1, &second)] {
        for (method, maps) in methods {
            sheet.push(SheetPanel::new(model, format!("{method}, pose {}", pose + 1)).saliency(&maps[pose]));
        }
    }
    let mut table = Table::new(
        "fig09.csv",
        "Agreement of the maps",
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
    row("ours with equal weights, pose 1 and 2", &alike[0], &alike[1], String::new());
    row("ours with equal weights and Lee et al., pose 1", &alike[0], &theirs[0], String::new());
    let (we, they) = (correlation(&ours[0], &ours[1]), correlation(&theirs[0], &theirs[1]));
    let between = rank_correlation(&ours[0], &theirs[0]);
    let top = shared_top(&ours[0], &theirs[0], 0.05);
    let verdict = Verdict::from_parts(
        &[we >= AGREES, they >= AGREES, between >= SIMILAR],
        format!(
            "The maps of the two poses have a correlation of {we:.2} with our method and {they:.2} with Lee's (they \
             agree from {AGREES} on). Our maps and Lee's have a rank correlation of {between:.2} and share {} of the \
             top 5 % (they are similar from {SIMILAR} on). With equal weights of all levels, the rank correlation is \
             {:.2}.",
            percent(top),
            rank_correlation(&alike[0], &theirs[0])
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(first.label())
        .sheet(
            "fig09.png",
            "Saliency of mean curvature in two poses. From left to right: Lee et al., our method by eq. 17, and our \
             method with equal weights of all levels. The second pose is the first one, twisted and bent.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "The paper uses two deformed shapes of the Armadillo, which are not public. Here the second pose is made \
             by twisting the figure about its vertical axis and bending its upper half. Both methods subtract two \
             smoothings of mean curvature: Lee's method by balls in space whose radii are fixed shares of the \
             diagonal, ours by random walks on the surface. With eq. 17, the finest level that counts outweighs the \
             others, and on a fine mesh it is at least as fine as Lee's finest level. The row with equal weights \
             shows how much of the difference this explains.",
        ))
}

/// Twists the points about y and bends the upper half about z, both smoothly.
fn bend(points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, FigureError> {
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
    use super::*;
    use crate::Model;

    #[test]
    fn the_second_pose_keeps_lengths_along_the_spine() {
        let spine: Vec<[f64; 3]> = (0..=100).map(|k| [0.0, f64::from(k) / 100.0, 0.0]).collect();
        let bent = bend(&spine).unwrap();
        for pair in bent.windows(2) {
            let length = crate::numbers::distance(&pair[0], &pair[1]);
            // A chord is shorter than its arc by a part of angle²/24.
            assert!((length - 0.01).abs() < 1e-6, "{length}");
        }
        assert!(bent[100][0] > 0.1, "bent to the side");
    }

    #[test]
    fn a_model_that_is_moved_keeps_its_faces() {
        let model = Model::built_in("sphere", 100).unwrap();
        let moved = model.with_points("bent", bend(model.points()).unwrap());
        assert_eq!(moved.triangles, model.triangles);
        assert_ne!(moved.points(), model.points());
    }
}
