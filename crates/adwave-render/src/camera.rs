//! Projection from model coordinates to the picture.

use crate::error::RenderError;
use crate::params::{FARTHEST_FOCUS, Framing, Projection, RenderParams};
use adwave::Progress;
use adwave::vector::{Vector, dot, subtract};

/// Rectangle in the picture, in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

/// Point projected into the picture.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Projected {
    /// Pixels from the left.
    pub(crate) x: f64,
    /// Pixels from the top.
    pub(crate) y: f64,
    /// Nearness to the viewer in (0, 1]; it grows toward the viewer and is linear over a plane in the picture.
    pub(crate) near: f64,
}

/// Camera that frames the balls for which it was fitted.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    axes: [Vector; 3],
    /// Origin of the camera's coordinates, in model coordinates.
    origin: Vector,
    unit: f64,
    /// Position of the eye across the picture; `distance` is its distance from the origin (perspective) or 0
    /// (orthographic).
    eye: [f64; 2],
    distance: f64,
    /// Pixels per unit, at a distance of 1 from the eye (perspective) or everywhere (orthographic).
    focal: f64,
    center: [f64; 2],
    /// Range of depths toward the viewer.
    depths: [f64; 2],
}

/// Smallest distance between the eye of a perspective camera and the shape, in diagonals of the shape. A nearer eye
/// would distort the shape.
const MIN_DISTANCE: f64 = 0.5;

/// Number of balls processed between two checks of the progress handle.
const CHECK_INTERVAL: usize = 1 << 14;

/// Axis-aligned bounding box of balls.
struct BoundingBox {
    middle: Vector,
    diagonal: f64,
}

impl BoundingBox {
    fn new(balls: &[(Vector, f64)]) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for (p, r) in balls {
            for c in 0..3 {
                low[c] = low[c].min(p[c] - r);
                high[c] = high[c].max(p[c] + r);
            }
        }
        let middle = [0, 1, 2].map(|c| f64::midpoint(low[c], high[c]));
        // Scaled before squaring, because coordinates may be extremely small or large.
        let side = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
        let square: f64 = (0..3).map(|c| ((high[c] - low[c]) / side).powi(2)).sum();
        Self { middle, diagonal: if side > 0.0 { side * square.sqrt() } else { 0.0 } }
    }
}

/// Tangents of half the field of view, horizontal and vertical; 0 for parallel rays.
fn frustum_tangents(projection: Projection, rect: Rect) -> [f64; 2] {
    match projection {
        Projection::Orthographic => [0.0; 2],
        Projection::Perspective { field_of_view } => {
            let half = (field_of_view.to_radians() / 2.0).tan();
            let shorter = rect.width.min(rect.height);
            [half * rect.width / shorter, half * rect.height / shorter]
        }
    }
}

impl Camera {
    /// Fits a camera for `params.view` that shows all balls (center and radius) as large as possible inside `rect`, or
    /// that shows the part of this picture selected by `params.framing`. O(n).
    pub(crate) fn fit(
        balls: &[(Vector, f64)],
        params: &RenderParams,
        rect: Rect,
        progress: Progress<'_>,
    ) -> Result<Self, RenderError> {
        let axes = params.view.axes(params.up);
        let BoundingBox { middle: origin, diagonal } = BoundingBox::new(balls);
        let unit = if diagonal > 0.0 { diagonal } else { 1.0 };
        let mut camera = Self {
            axes,
            origin,
            unit,
            eye: [0.0; 2],
            distance: 0.0,
            focal: 1.0,
            center: [rect.left + rect.width / 2.0, rect.top + rect.height / 2.0],
            depths: [0.0, 1.0],
        };
        let most = |f: &dyn Fn(Vector, f64) -> f64| {
            let chunks = balls.chunks(CHECK_INTERVAL).take_while(|_| !progress.is_cancelled());
            let spheres = chunks.flatten().map(|(p, r)| (camera.to_view(p), r / unit));
            spheres.map(|(v, r)| f(v, r)).fold(f64::NEG_INFINITY, f64::max)
        };
        let nearest = most(&|v, r| v[2] + r);
        let farthest = -most(&|v, r| r - v[2]);
        let tangents = frustum_tangents(params.projection, rect);
        // Each side of the frustum is moved against the shape; two opposite sides meet at the eye.
        let bounds = [0, 1].map(|c| {
            let t = tangents[c];
            let slope = (1.0 + t * t).sqrt();
            [most(&|v, r| v[c] + t * v[2] + r * slope), most(&|v, r| -v[c] + t * v[2] + r * slope)]
        });
        let eye = bounds.map(|[upper, lower]| (upper - lower) / 2.0);
        let mut shift = [0.0; 2];
        let (distance, focal) = match params.projection {
            Projection::Orthographic => {
                let extents = bounds.map(|[upper, lower]| upper + lower);
                let least = 1e-9;
                (0.0, (rect.width / extents[0].max(least)).min(rect.height / extents[1].max(least)))
            }
            Projection::Perspective { .. } => {
                let needed = [0, 1].map(|c| (bounds[c][0] + bounds[c][1]) / (2.0 * tangents[c]));
                let needed = needed[0].max(needed[1]);
                let distance = needed.max(nearest + MIN_DISTANCE);
                // Extent of the shape seen from the eye, as tangents: the lens is scaled and shifted so that the
                // shape fills the picture.
                let seen = [0, 1].map(|c| {
                    let tangent =
                        |v: Vector, r: f64, sign: f64| (sign * (v[c] - eye[c]) + r) / (distance - v[2] - r);
                    [most(&|v, r| tangent(v, r, 1.0)), most(&|v, r| tangent(v, r, -1.0))]
                });
                let fill = |c: usize, side: f64| side / (seen[c][0] + seen[c][1]).max(1e-9);
                let focal = fill(0, rect.width).min(fill(1, rect.height));
                shift = [0, 1].map(|c| focal * (seen[c][1] - seen[c][0]) / 2.0);
                (distance, focal)
            }
        };
        progress.check()?;
        camera.center[0] += shift[0];
        camera.center[1] -= shift[1];
        camera.eye = eye;
        camera.distance = distance;
        camera.focal = focal;
        camera.depths = [farthest - 1e-3, nearest];
        camera.apply_framing(&params.framing, rect)?;
        Ok(camera)
    }

    /// Zooms to a part of the picture with a longer lens from the same distance, so that no point is behind the eye.
    fn apply_framing(&mut self, framing: &Framing, rect: Rect) -> Result<(), RenderError> {
        let middle = [rect.left + rect.width / 2.0, rect.top + rect.height / 2.0];
        if let Some(focus) = framing.focus {
            let seen = self.to_view(&focus);
            if !seen.iter().all(|c| c.abs() <= FARTHEST_FOCUS) {
                return Err(RenderError::FarFocus { focus, middle: self.origin });
            }
            // The eye moves sideways; the point straight ahead is in the middle at any depth.
            self.eye = [seen[0], seen[1]];
            self.center = middle;
        }
        self.center = [0, 1].map(|c| middle[c] + framing.zoom * (self.center[c] - middle[c]));
        self.focal *= framing.zoom;
        Ok(())
    }

    /// Transforms a position to the viewer's axes, relative to the origin and in units of the camera.
    fn to_view(&self, p: &Vector) -> Vector {
        let d = subtract(p, &self.origin).map(|c| c / self.unit);
        self.axes.map(|axis| dot(&axis, &d))
    }

    /// Rotates a direction into the viewer's axes: right, up, toward the viewer.
    pub(crate) fn rotate(&self, d: &Vector) -> Vector {
        self.axes.map(|axis| dot(&axis, d))
    }

    pub(crate) fn is_perspective(&self) -> bool {
        self.distance > 0.0
    }

    pub(crate) fn project(&self, p: &Vector) -> Projected {
        let v = self.to_view(p);
        let scale = self.scale(v[2]);
        Projected {
            x: self.center[0] + (v[0] - self.eye[0]) * scale,
            y: self.center[1] - (v[1] - self.eye[1]) * scale,
            near: self.near(v[2]),
        }
    }

    /// Pixels spanned by a radius at `p`, and the difference in nearness between the center of a ball there and its
    /// foremost point.
    pub(crate) fn radius(&self, p: &Vector, radius: f64) -> (f64, f64) {
        let depth = self.to_view(p)[2];
        let r = radius / self.unit;
        (r * self.scale(depth), self.near(depth + r) - self.near(depth))
    }

    /// Pixels per unit at a depth.
    fn scale(&self, depth: f64) -> f64 {
        if self.is_perspective() { self.focal / (self.distance - depth).max(1e-6) } else { self.focal }
    }

    /// Nearness of a depth, linear over a plane in the picture: the depth itself for parallel rays, the inverse
    /// distance for rays from an eye.
    fn near(&self, depth: f64) -> f64 {
        if self.is_perspective() {
            ((self.distance - self.depths[1]) / (self.distance - depth)).max(1e-6)
        } else {
            (depth - self.depths[0]) / (self.depths[1] - self.depths[0])
        }
    }

    /// Depth toward the viewer in pixels, computed from [`Projected::near`]. Shading needs the same unit across and
    /// along the view.
    pub(crate) fn depth_in_pixels(&self, near: f64) -> f64 {
        let depth = if self.is_perspective() {
            self.distance - (self.distance - self.depths[1]) / near
        } else {
            self.depths[0] + near * (self.depths[1] - self.depths[0])
        };
        depth * self.pixels_per_unit()
    }

    /// Pixels per diagonal of the framed shape, at the middle of the shape.
    pub(crate) fn pixels_per_unit(&self) -> f64 {
        self.scale(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::View;

    /// Part of the picture used by these tests, in pixels; its middle is (200, 150).
    const RECT: Rect = Rect { left: 0.0, top: 0.0, width: 400.0, height: 300.0 };

    /// Tolerance for pixel coordinates that differ by rounding only.
    const ROUNDING: f64 = 1e-9;

    fn cube() -> Vec<(Vector, f64)> {
        (0..8).map(|k| ([k & 1, k >> 1 & 1, k >> 2].map(f64::from), 0.0)).collect()
    }

    fn camera(projection: Projection, framing: Framing) -> Result<Camera, RenderError> {
        let params = RenderParams::default()
            .with_view(View { azimuth: 30.0, elevation: 20.0 })
            .with_projection(projection)
            .with_framing(framing);
        Camera::fit(&cube(), &params, RECT, Progress::none())
    }

    const BOTH: [Projection; 2] = [Projection::Orthographic, Projection::Perspective { field_of_view: 20.0 }];

    #[test]
    fn zoom_enlarges_the_picture_about_its_middle() {
        for projection in BOTH {
            let whole = camera(projection, Framing::default()).unwrap();
            let part = camera(projection, Framing { zoom: 3.0, focus: None }).unwrap();
            for (p, _) in cube() {
                let (a, b) = (whole.project(&p), part.project(&p));
                assert!((b.x - 200.0 - 3.0 * (a.x - 200.0)).abs() < ROUNDING, "{projection:?}");
                assert!((b.y - 150.0 - 3.0 * (a.y - 150.0)).abs() < ROUNDING, "{projection:?}");
                assert_eq!(a.near, b.near, "nothing comes nearer");
                assert!((part.radius(&p, 0.1).0 - 3.0 * whole.radius(&p, 0.1).0).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn the_focus_is_in_the_middle_of_the_picture() {
        for projection in BOTH {
            for focus in [[0.0; 3], [1.0, 1.0, 0.0], [0.2, 0.9, 1.5]] {
                let camera = camera(projection, Framing { zoom: 5.0, focus: Some(focus) }).unwrap();
                let seen = camera.project(&focus);
                assert!((seen.x - 200.0).abs() < ROUNDING && (seen.y - 150.0).abs() < ROUNDING);
            }
        }
    }

    #[test]
    fn parallel_rays_show_equal_lengths_equally_wherever_they_are() {
        let framing = Framing { zoom: 2.0, focus: Some([1.0; 3]) };
        let radii = |projection| {
            let camera = camera(projection, framing).unwrap();
            [[0.0; 3], [1.0; 3]].map(|p| camera.radius(&p, 0.1).0)
        };
        let [far, near] = radii(Projection::Orthographic);
        assert!((far - near).abs() < ROUNDING);
        let [far, near] = radii(BOTH[1]);
        assert!(near > 1.05 * far, "{near} {far}");
    }

    #[test]
    fn a_focus_far_off_the_shape_is_refused() {
        for focus in [[1e3, 0.0, 0.0], [0.0, -1e300, 0.0], [0.0, 0.0, f64::NAN]] {
            let error = camera(BOTH[1], Framing { zoom: 4.0, focus: Some(focus) }).unwrap_err();
            assert!(error.to_string().contains("whose middle is (0.5, 0.5, 0.5)"), "{error}");
        }
    }
}
