//! Distances from the border of a grid and of its places without data.
//!
//! The straight line from a place to the nearest place of the border passes no other place of it, so that the distance is
//! that of points in space: a minimum of `f(q) + h²(p − q)²` along one axis after the other, each the lower envelope of
//! parabolas (`felzenszwalb2012`).

use super::Grid;
use crate::{Cancelled, Progress, parallel};

/// Lines that a thread processes at a time; those beside each other share the lines of the cache.
const LINES_AT_A_TIME: usize = 16;

impl Grid {
    /// Distance of each place with data from the nearest place on the border or next to a place that is left out, in model
    /// units; infinite beyond `radius`, and at places without data. O(places).
    pub(super) fn border_distances(
        &self,
        masked: Option<&[bool]>,
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let n = self.n_places();
        let at_border = |place: usize| if self.is_border(place, masked) { 0.0 } else { f64::INFINITY };
        let mut squares = parallel::try_collect(n, progress, at_border)?;
        let mut others = crate::pages::zeros(n);
        // Each round turns the first axis into the last, so that lines are written one after another.
        for axis in 0..self.axes.sizes.len() {
            let (size, spacing) = (self.axes.sizes[axis], self.axes.spacings[axis]);
            let line = SampledLine { size, spacing, is_ring: self.axes.is_periodic[axis], stride: n / size };
            parallel::try_visit_rows(&mut others, size, LINES_AT_A_TIME, progress, |first, rows| {
                let mut envelope = Vec::new();
                for (k, row) in rows.chunks_exact_mut(size).enumerate() {
                    line.find_distances(&squares[first + k..], &mut envelope, row);
                }
            })?;
            std::mem::swap(&mut squares, &mut others);
        }
        let distance = |place: usize| {
            let distance = squares[place].sqrt();
            if distance <= radius && self.is_part(place, masked) { distance } else { f64::INFINITY }
        };
        parallel::try_collect(n, progress, distance)
    }
}

/// Lines of places along an axis.
struct SampledLine {
    size: usize,
    spacing: f64,
    is_ring: bool,
    /// Distance between adjacent places in memory.
    stride: usize,
}

impl SampledLine {
    /// Computes `min_q given[q·stride] + h²(p − q)²` for each p into `out`. `envelope` holds the parabolas that are lowest
    /// somewhere: their q and value, and where they begin to be lowest, in places.
    fn find_distances(&self, given: &[f64], envelope: &mut Vec<(f64, f64, f64)>, out: &mut [f64]) {
        let square = self.spacing * self.spacing;
        envelope.clear();
        // A ring goes on with itself on both sides.
        for turn in if self.is_ring { -1..=1 } else { 0..=0 } {
            for at in 0..self.size {
                let value = given[at * self.stride];
                if value == f64::INFINITY {
                    continue;
                }
                let q = (turn * self.size as isize + at as isize) as f64;
                let mut from = f64::NEG_INFINITY;
                while let Some(&(other, lowest, since)) = envelope.last() {
                    from = 0.5 * ((value - lowest) / (square * (q - other)) + q + other);
                    if from > since {
                        break;
                    }
                    from = f64::NEG_INFINITY;
                    envelope.pop();
                }
                envelope.push((q, value, from));
            }
        }
        let mut lowest = 0;
        for (out, p) in out.iter_mut().zip(0..) {
            let p = f64::from(p);
            while envelope.get(lowest + 1).is_some_and(|(_, _, since)| *since < p) {
                lowest += 1;
            }
            *out =
                envelope.get(lowest).map_or(f64::INFINITY, |(q, value, _)| value + square * (p - q).powi(2));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Domain;

    #[test]
    fn distances_are_those_of_the_nearest_place_of_the_border() {
        let (sizes, spacings) = ([9, 7, 11], [1.0, 2.5, 0.75]);
        let n: usize = sizes.iter().product();
        let kept: Vec<bool> = (0..n).map(|place| place * 7919 % 97 > 2).collect();
        let masked: Vec<bool> = (0..n).map(|place| place == n / 2).collect();
        for is_periodic in [[false; 3], [true, false, true], [true; 3]] {
            let grid = Grid::new(&sizes, &spacings).unwrap().with_periodic(&is_periodic).unwrap();
            for grid in [grid.clone(), grid.with_kept(kept.clone()).unwrap()] {
                let found = grid.border_distances(Some(&masked), 3.0, Progress::none()).unwrap();
                let neighbors = grid.neighbors(Progress::none()).unwrap().unwrap();
                let border = grid.border(&neighbors, Some(&masked), Progress::none()).unwrap();
                let along = |axis: usize, x: usize, y: usize| {
                    let [x, y] = [x, y].map(|place| grid.axes.coordinate(axis, place));
                    let away = x.abs_diff(y);
                    let away = if is_periodic[axis] { away.min(sizes[axis] - away) } else { away };
                    (away as f64 * spacings[axis]).powi(2)
                };
                let mut n_inside = 0;
                for (x, found) in found.into_iter().enumerate() {
                    let square = |&y: &usize| (0..3).map(|axis| along(axis, x, y)).sum::<f64>();
                    let nearest = border.iter().map(square).fold(f64::INFINITY, f64::min).sqrt();
                    let is_known = grid.is_part(x, Some(&masked)) && nearest <= 3.0;
                    let wanted = if is_known { nearest } else { f64::INFINITY };
                    assert!(found == wanted || (found - wanted).abs() < 1e-12, "{x}: {found} {wanted}");
                    n_inside += usize::from(is_known && nearest > 0.0);
                }
                assert!(n_inside > 20, "{n_inside} places inside");
            }
        }
    }
}
