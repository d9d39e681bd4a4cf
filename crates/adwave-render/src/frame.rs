//! From the model to the picture: the viewer's axes, and the scale at which all that is drawn fits.

use crate::surface::{Ball, Surface};
use crate::vector::{Vec3, dot, sub};
use crate::view::{Up, View};
use rayon::prelude::*;

/// The part of the room that a shape fills.
const FILLED: f64 = 0.94;

/// What is seen, as intervals along the picture's right, its up and towards the viewer, model units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent([[f64; 2]; 3]);

impl Extent {
    /// The extent of a surface and its balls along the viewer's axes. O(n).
    pub(crate) fn of(surface: &Surface, balls: &[Ball], axes: &[Vec3; 3]) -> Self {
        let used = used_points(surface);
        let points = surface
            .points
            .par_iter()
            .zip(used.par_iter())
            .filter(|&(_, &used)| used)
            .map(|(p, _)| Self(axes.map(|a| [dot(p, &a); 2])))
            .reduce(Self::nothing, Self::with);
        balls.iter().fold(points, |extent, ball| {
            let along = axes.map(|a| dot(&ball.center, &a));
            extent.with(Self(along.map(|c| [c - ball.radius, c + ball.radius])))
        })
    }

    fn nothing() -> Self {
        Self([[f64::INFINITY, f64::NEG_INFINITY]; 3])
    }

    /// What holds both.
    pub(crate) fn with(self, other: Self) -> Self {
        Self([0, 1, 2].map(|k| [self.0[k][0].min(other.0[k][0]), self.0[k][1].max(other.0[k][1])]))
    }

    fn middle(&self) -> Vec3 {
        self.0.map(|[low, high]| 0.5 * low + 0.5 * high)
    }

    fn size(&self, axis: usize) -> f64 {
        self.0[axis][1] - self.0[axis][0]
    }
}

/// The points that faces use; all of a cloud. Unreferenced vertices are not seen and must not make the rest small.
fn used_points(surface: &Surface) -> Vec<bool> {
    if surface.triangles.is_empty() {
        return vec![true; surface.points.len()];
    }
    let mut used = vec![false; surface.points.len()];
    surface.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    used
}

/// Parallel rays into a part of a picture. Positions in the picture are in samples: right, down, towards the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    axes: [Vec3; 3],
    middle: Vec3,
    /// Samples a model unit.
    pub(crate) scale: f64,
    center: [f64; 2],
}

impl Frame {
    pub(crate) fn axes(view: View, up: Up) -> [Vec3; 3] {
        view.axes(up)
    }

    /// The frame in which `extent` fills `width` × `height` samples from the upper left corner.
    pub(crate) fn new(axes: [Vec3; 3], extent: &Extent, width: f64, height: f64) -> Self {
        let [across, up] = [0, 1].map(|k| extent.size(k));
        let scale = (FILLED * width / across).min(FILLED * height / up);
        // One point, or a line seen from its end, has no size; any scale shows it.
        let depth = extent.size(2);
        let scale = if scale.is_finite() && scale > 0.0 {
            scale
        } else if depth > 0.0 {
            FILLED * width.min(height) / depth
        } else {
            1.0
        };
        Self { axes, middle: extent.middle(), scale, center: [0.5 * width, 0.5 * height] }
    }

    /// Where a point of the model is seen.
    pub(crate) fn place(&self, p: &Vec3) -> Vec3 {
        let along = sub(&self.axes.map(|a| dot(p, &a)), &self.middle);
        [
            self.center[0] + self.scale * along[0],
            self.center[1] - self.scale * along[1],
            self.scale * along[2],
        ]
    }

    /// A direction of the model as right, up, towards the viewer.
    pub(crate) fn turn(&self, direction: &Vec3) -> [f32; 3] {
        self.axes.map(|a| dot(direction, &a) as f32)
    }
}
