//! Guess of the axis that points up.

use crate::view::Up;

/// Height relative to width and depth below which a shape may be terrain.
const LOW: f64 = 0.25;

/// Height relative to width and depth below which a shape is a flat drawing: it has no heights and is seen from
/// above.
const FLAT: f64 = 1e-3;

impl Up {
    /// Guesses z for a scan of terrain: it has a border or no faces (`is_open`), and its extent along z is less than
    /// a quarter of those along x and y, but not negligible. Otherwise guesses y, the convention of most models.
    /// O(n).
    ///
    /// ```
    /// use adwave_render::Up;
    /// let land: Vec<[f64; 3]> = (0..100).map(|i| [f64::from(i % 10), f64::from(i / 10), f64::from(i % 3) / 2.0]).collect();
    /// assert_eq!(Up::guess(&land, || true), Up::Z);
    /// assert_eq!(Up::guess(&land, || false), Up::Y);
    /// ```
    pub fn guess(points: &[[f64; 3]], is_open: impl FnOnce() -> bool) -> Self {
        let extent = |c: usize| {
            let within = |(low, high): (f64, f64), p: &[f64; 3]| (low.min(p[c]), high.max(p[c]));
            let (low, high) = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), within);
            high - low
        };
        let (height, across) = (extent(2), extent(0).min(extent(1)));
        let is_low = height < LOW * across && height > FLAT * across;
        if is_low && is_open() { Self::Z } else { Self::Y }
    }

    /// `x`, `y` or `z`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Grid of 10 × 10 points with heights from 0 to `height` along `axis`.
    fn land(height: f64, axis: usize) -> Vec<[f64; 3]> {
        let point = |i: u32| {
            let mut p = [f64::from(i % 10), f64::from(i / 10), height * f64::from(i % 2)];
            p.swap(2, axis);
            p
        };
        (0..100).map(point).collect()
    }

    #[test]
    fn only_low_open_shapes_with_heights_along_z_are_land() {
        for (height, axis, up) in [
            (1.0, 2, Up::Z),
            (2.2, 2, Up::Z),
            (3.0, 2, Up::Y),
            (0.0, 2, Up::Y),
            (1.0, 1, Up::Y),
            (1.0, 0, Up::Y),
        ] {
            assert_eq!(Up::guess(&land(height, axis), || true), up, "{height} along {axis}");
        }
        assert_eq!(Up::guess(&land(1.0, 2), || false), Up::Y);
        assert_eq!(Up::guess(&[], || true), Up::Y);
        assert_eq!(Up::guess(&[[1.0; 3]], || true), Up::Y);
    }
}
