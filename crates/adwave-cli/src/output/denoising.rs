//! Report of a denoised shape.

use super::{count, number};
use adwave::denoise::{CloudDenoising, CurveDenoising, DenoiseChoice, DenoiseInfo, MeshDenoising, Outliers};
use adwave::local_fit::LocalFit;
use std::fmt::Write;

/// Unit of lengths relative to the sampling of a shape.
#[derive(Clone, Copy)]
pub(crate) enum SamplingUnit {
    MeanEdges,
    NeighborDistances,
    /// Mean edges of a curve, whose noise is that of each coordinate.
    CurveEdges,
}

/// Adds lines on the noise that was assumed, and on how much was smoothed and how.
pub(crate) fn describe_denoising(text: &mut String, info: &DenoiseInfo, unit: SamplingUnit) {
    let unit = match unit {
        SamplingUnit::CurveEdges => {
            describe_curve(text, info, info.curve.as_ref());
            describe_far(text, info);
            return;
        }
        SamplingUnit::MeanEdges => "mean edges",
        SamplingUnit::NeighborDistances => "mean distances of neighbors",
    };
    if let Some(cloud) = &info.cloud {
        describe_cloud(text, info, cloud);
        return;
    }
    let _ = write!(
        text,
        "noise along the normals: {} model units, {} {unit}",
        number(info.noise),
        number(info.noise_in_edges)
    );
    match info.mesh.as_ref().map(|mesh| mesh.noise_range) {
        Some([low, high]) if low < high => {
            let _ = writeln!(text, "; {} to {} by place (5 % to 95 %)", number(low), number(high));
        }
        _ => text.push('\n'),
    }
    if let Some(mesh) = &info.mesh {
        describe_mesh(text, info, mesh);
    }
    let percent = |weights: &[f64]| 100.0 * weights.iter().sum::<f64>();
    let mean_steps = |weights: &[f64]| {
        let sum: f64 = weights.iter().enumerate().map(|(j, w)| w * f64::from(1_u32 << j)).sum();
        sum / weights.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    };
    let _ = write!(text, "normals: {:.0} % unchanged", 100.0 * info.kept);
    match info.mesh.as_ref().map(|mesh| &mesh.kept_by_place[..]) {
        Some([least, between, most]) => {
            let _ = writeln!(
                text,
                " ({:.0} % where the surface bends least, {:.0} % in between, {:.0} % where it bends most)",
                100.0 * least,
                100.0 * between,
                100.0 * most
            );
        }
        _ => text.push('\n'),
    }
    for (name, weights) in
        [("creases kept", &info.crease_weights), ("creases smoothed", &info.smooth_weights)]
    {
        if percent(weights) > 0.0 {
            let _ = writeln!(
                text,
                "         {:.0} % with {name}, by {} on average",
                percent(weights),
                count(mean_steps(weights).round(), "step", "steps")
            );
        }
    }
    describe_far(text, info);
}

/// Adds lines on the noise of a curve: one number, or three if the axes differ.
fn describe_curve(text: &mut String, info: &DenoiseInfo, curve: Option<&CurveDenoising>) {
    let edges = number(info.noise_in_edges);
    let _ = match curve.map(|curve| curve.noise_by_axis) {
        Some([x, y, z]) if x != y || y != z => {
            let [x, y, z] = [x, y, z].map(number);
            writeln!(text, "noise {x} {y} {z} along x y z, in model units; {edges} mean edges of the result")
        }
        _ => {
            let noise = number(info.noise);
            writeln!(text, "noise of each coordinate: {noise} model units, {edges} mean edges of the result")
        }
    };
    let Some(curve) = curve else { return };
    for ((axis, step), noise) in ["x", "y", "z"].iter().zip(curve.rounding).zip(curve.noise_by_axis) {
        if step > 0.5 * noise {
            let _ = writeln!(text, "{axis} is rounded to steps of {}", number(step));
        }
    }
}

/// Noise that neighbors share, in mean edges, below which it is not reported. Below twice the noise of single vertices
/// it is not reported either, because it would hardly show.
const LEAST_SHARED: f64 = 0.02;

/// Noise of a cloud, in mean distances of neighbors, that is the rounding of coordinates.
const NO_NOISE: f64 = 1e-9;

/// Adds lines on the kinds of noise of a mesh other than noise along the normals.
fn describe_mesh(text: &mut String, info: &DenoiseInfo, mesh: &MeshDenoising) {
    if mesh.impulse_share > 0.0 {
        let _ = writeln!(
            text,
            "impulses: {:.1} % of the vertices by {} model units (root mean square); moved to the planes around them",
            100.0 * mesh.impulse_share,
            number(mesh.impulse_size)
        );
    }
    if mesh.turned_share > 0.001 && info.noise > 0.0 {
        let _ = writeln!(
            text,
            "turned triangles: {:.1} %, as noise in all directions makes them",
            100.0 * mesh.turned_share
        );
    }
    let edge = info.noise / info.noise_in_edges;
    if mesh.shared > 0.0 {
        let _ = writeln!(
            text,
            "noise that neighbors share: {} model units assumed; detail of that size is removed too",
            number(mesh.shared)
        );
    } else if mesh.shared_at_most > (2.0 * info.noise).max(LEAST_SHARED * edge) {
        let _ = writeln!(
            text,
            "noise that neighbors share: about {} model units at most, if it is not detail; it stays (--shared-noise)",
            number(mesh.shared_at_most)
        );
    }
    if mesh.linear_rounds > 0.0 && info.kept < 1.0 {
        let _ = writeln!(text, "positions: {:.1} rounds of a linear filter first", mesh.linear_rounds);
    }
}

/// Adds lines on the noise of a cloud by place, and on its points.
fn describe_cloud(text: &mut String, info: &DenoiseInfo, cloud: &CloudDenoising) {
    let [low, high] = cloud.noise_range;
    if info.noise_in_edges < NO_NOISE {
        text.push_str("noise along the normals: none that could be told from rounding\n");
    } else {
        let _ = writeln!(
            text,
            "noise along the normals: {} model units, {} mean distances of neighbors; {} to {} by place (5 % to 95 %)",
            number(info.noise),
            number(info.noise_in_edges),
            number(low),
            number(high)
        );
        let [least, most] = cloud.noise_interval;
        if least < most {
            let _ = writeln!(
                text,
                "true noise: {} to {} in 9 of 10 generated clouds with such an estimate",
                number(least),
                number(most)
            );
        }
    }
    if cloud.neighbors > DenoiseChoice::NEIGHBORS {
        let _ = writeln!(
            text,
            "points in lines: {} neighbors were drawn from up to {} nearest points there, so that they span several \
             lines",
            DenoiseChoice::NEIGHBORS,
            cloud.neighbors
        );
    }
    if let Some(strong) = &cloud.strong {
        let _ = writeln!(
            text,
            "strong noise: it hides among the nearest points, so {} to {} neighbors were fitted; {} where these tell nothing",
            strong.neighbors,
            4 * strong.neighbors,
            number(strong.at_least)
        );
    }
    if let (true, Some(share)) = (cloud.is_noise_doubtful(), cloud.flat_share) {
        let _ = writeln!(
            text,
            "the noise may be larger: only {:.0} % of the places have a flat neighborhood, as where \
             surfaces are thin or noise exceeds the distance of the points; if you know the noise, give --noise-sigma",
            100.0 * share
        );
    }
    if let (true, Some(ratio)) = (cloud.has_two_surfaces(), cloud.residual_ratio) {
        let _ = writeln!(
            text,
            "two surfaces, it seems: most neighborhoods have residuals like those of thin walls or of passes that are \
             shifted against each other (mean absolute / root mean square {}, of noise on one surface 0.80); they may have \
             been joined in part",
            number(ratio)
        );
    }
    if cloud.rounding > 0.5 * info.noise && cloud.rounding > 0.0 {
        let _ = writeln!(text, "coordinates are rounded to steps of {}", number(cloud.rounding));
    }
    let _ =
        writeln!(text, "surface: {:.0} % of the estimated noise left as it is, by risk", 100.0 * info.kept);
    describe_points(text, info, cloud);
}

/// Adds lines on the points of a cloud that did not move, and on how far the others did.
fn describe_points(text: &mut String, info: &DenoiseInfo, cloud: &CloudDenoising) {
    if cloud.n_outliers > 0 {
        let treatment = match cloud.outliers {
            Outliers::Pull => "moved to the surface of the neighbors",
            Outliers::Drop => "dropped",
            _ => "kept in place",
        };
        let _ = writeln!(text, "{}, {treatment}", count(cloud.n_outliers, "outlier", "outliers"));
    }
    if cloud.n_left > 0 {
        let _ = writeln!(
            text,
            "{} left as they are: no surface there, or more than 3 times the noise away from it",
            count(cloud.n_left, "point", "points")
        );
    }
    let [before, after] = cloud.nearest_distance;
    let _ = writeln!(
        text,
        "distance to the nearest point: {} before, {} after (mean)",
        number(before),
        number(after)
    );
    if info.n_far == 0 {
        let _ = writeln!(text, "no point but outliers moved farther than 3 times the noise at its place");
    } else {
        describe_far(text, info);
    }
}

/// Adds a line on vertices that moved far.
fn describe_far(text: &mut String, info: &DenoiseInfo) {
    if info.n_far > 0 {
        let vertices = count(info.n_far, "vertex", "vertices");
        let what = if info.mesh.is_some() || info.curve.is_some() {
            "stopped at 3 times the noise there"
        } else {
            "moved farther than 3 times the noise"
        };
        let _ = writeln!(text, "{vertices} {what}");
    }
}

/// Adds a line on the fields that smoothing left unchanged.
pub(crate) fn describe_local_fit(text: &mut String, fit: LocalFit) {
    let line = match fit {
        LocalFit::Linear => "slopes are kept (local fit: linear)",
        _ => "about the mean of the neighbors (local fit: constant)",
    };
    let _ = writeln!(text, "{line}");
}
