//! Implicit surfaces f(p) = 0, f < 0 inside: round cones, flattening, smooth union and smooth carving.
//!
//! All functions are 1-Lipschitz, |f(p) − f(q)| ≤ ‖p − q‖, so |f(p)| is a lower bound of the distance to the
//! surface; the polygonizer skips empty space by it.

/// A point or direction in model units.
pub(super) type V3 = nalgebra::Vector3<f64>;

/// A side of a closed surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The inside, f < 0.
    Inside,
    /// The outside, f > 0.
    Outside,
}

/// A solid described by the sign of a function.
pub(super) trait Implicit: Sync {
    /// f(p), negative inside, zero on the surface, about the signed distance near it. Model units.
    fn value(&self, p: V3) -> f64;

    /// Side that contains a whole ball, if a bound shows that the surface does not cross it. Model units.
    fn side_of_ball(&self, center: V3, radius: f64) -> Option<Side>;

    /// Two opposite corners of a box that contains the solid.
    fn bounds(&self) -> (V3, V3);
}

/// The solid swept by a ball that moves straight from one center to another while its radius changes linearly.
#[derive(Clone, Debug)]
pub(super) struct RoundCone {
    start: V3,
    axis: V3,
    /// Squared length of the axis, and its inverse.
    length2: f64,
    inverse_length2: f64,
    start_radius: f64,
    end_radius: f64,
    /// Squared length of the axis minus the squared difference of the radii.
    slant2: f64,
}

impl RoundCone {
    /// Sweeps the ball of radius `ra` at `a` to the ball of radius `rb` at `b`; neither may contain the other.
    pub(super) fn new(a: V3, ra: f64, b: V3, rb: f64) -> Self {
        let axis = b - a;
        let length2 = axis.norm_squared();
        let slant2 = length2 - (ra - rb) * (ra - rb);
        assert!(slant2 > 0.0, "a ball of radius {ra} and one of radius {rb}, {} apart, nest", length2.sqrt());
        Self {
            start: a,
            axis,
            length2,
            inverse_length2: 1.0 / length2,
            start_radius: ra,
            end_radius: rb,
            slant2,
        }
    }

    /// Exact signed distance from `p`: the nearest of the two end balls and the cone tangent to both. Cases are
    /// distinguished in the plane through `p` and the axis, scaled by ‖axis‖ to avoid the square root.
    pub(super) fn distance(&self, p: V3) -> f64 {
        let from_start = p - self.start;
        let along = from_start.dot(&self.axis);
        let beyond = along - self.length2;
        let across2 = (from_start * self.length2 - self.axis * along).norm_squared();
        let taper = self.start_radius - self.end_radius;
        let side = taper.signum() * taper * taper * across2;
        let along2 = along * along * self.length2;
        let beyond2 = beyond * beyond * self.length2;
        if beyond.signum() * self.slant2 * beyond2 > side {
            (across2 + beyond2).sqrt() * self.inverse_length2 - self.end_radius
        } else if along.signum() * self.slant2 * along2 < side {
            (across2 + along2).sqrt() * self.inverse_length2 - self.start_radius
        } else {
            ((across2 * self.slant2 * self.inverse_length2).sqrt() + along * taper) * self.inverse_length2
                - self.start_radius
        }
    }

    /// Projection of `p` onto the axis: 0 at the start, 1 at the end, clamped.
    pub(super) fn fraction(&self, p: V3) -> f64 {
        ((p - self.start).dot(&self.axis) * self.inverse_length2).clamp(0.0, 1.0)
    }

    /// The two end balls as (center, radius).
    pub(super) fn balls(&self) -> [(V3, f64); 2] {
        [(self.start, self.start_radius), (self.start + self.axis, self.end_radius)]
    }

    /// Length of the axis.
    pub(super) fn length(&self) -> f64 {
        self.length2.sqrt()
    }
}

/// Compresses space towards a plane, so that a solid becomes thinner by `factor` across it.
#[derive(Clone, Debug)]
pub(super) struct Flatten {
    /// A point of the plane.
    pub(super) center: V3,
    /// Unit normal of the plane.
    pub(super) normal: V3,
    /// Factor by which the solid becomes thinner, at least 1.
    pub(super) factor: f64,
}

impl Flatten {
    /// Preimage of `p`: distances across the plane grow by `factor`.
    pub(super) fn unsqueeze(&self, p: V3) -> V3 {
        p + self.normal * ((self.factor - 1.0) * (p - self.center).dot(&self.normal))
    }
}

/// Union of a and b with a fillet: min(a, b) − max(k − |a − b|, 0)²/(4k). It equals the smaller value exactly if
/// they differ by k or more, and is at most k/4 below it otherwise. `k` in model units.
pub(super) fn smooth_union(a: f64, b: f64, k: f64) -> f64 {
    let overlap = (k - (a - b).abs()).max(0.0);
    a.min(b) - overlap * overlap / (4.0 * k)
}

/// Difference `a` without `b` with a rounded rim: −[`smooth_union`](−a, b, k).
pub(super) fn smooth_carve(a: f64, b: f64, k: f64) -> f64 {
    -smooth_union(-a, b, k)
}

/// Smooth step: 0 below `from`, 1 above `to`, 3t² − 2t³ between; with `from > to` it falls.
pub(super) fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding in distances of size 1.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn round_cone_with_equal_radii_is_a_capsule() {
        let capsule = RoundCone::new(V3::zeros(), 0.5, V3::new(2.0, 0.0, 0.0), 0.5);
        assert!((capsule.distance(V3::new(1.0, 2.0, 0.0)) - 1.5).abs() < ROUNDING);
        assert!((capsule.distance(V3::new(-1.0, 0.0, 0.0)) - 0.5).abs() < ROUNDING);
        assert!((capsule.distance(V3::new(3.0, 0.0, 4.0)) - (17.0_f64.sqrt() - 0.5)).abs() < ROUNDING);
        assert!((capsule.fraction(V3::new(0.5, 7.0, 0.0)) - 0.25).abs() < ROUNDING);
    }

    proptest! {
        /// The round cone is the union of all its balls: no ball may come closer than the distance, and one of a
        /// fine sampling must come about as close.
        #[test]
        fn round_cone_is_the_union_of_its_balls(x in -2.0..2.0_f64, y in -2.0..2.0_f64, z in -2.0..2.0_f64,
                                                 ra in 0.05..0.5_f64, rb in 0.05..0.5_f64) {
            let (a, b) = (V3::new(-0.4, 0.1, 0.2), V3::new(0.5, -0.3, 0.1));
            let cone = RoundCone::new(a, ra, b, rb);
            let p = V3::new(x, y, z);
            let nearest = (0..=1000)
                .map(|i| f64::from(i) / 1000.0)
                .map(|t| (p - a.lerp(&b, t)).norm() - (ra + t * (rb - ra)))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(cone.distance(p) <= nearest + ROUNDING);
            prop_assert!(cone.distance(p) >= nearest - 1e-3, "sampled {nearest}, closed form {}", cone.distance(p));
        }

        #[test]
        fn smooth_union_is_exact_beyond_its_width(a in -1.0..1.0_f64, gap in 0.1..1.0_f64) {
            prop_assert_eq!(smooth_union(a, a + gap, 0.1), a);
            prop_assert!(smooth_union(a, a + 0.5 * gap, 2.0) >= a - 0.5);
            prop_assert_eq!(smooth_carve(a, -(a - gap), 0.1), a);
        }
    }
}
