//! Measures that tell detail from noise on a grid: the size of noise around each place, the share of it that heat leaves,
//! and the places around another.

use super::{Grid, MAX_AXES};
use crate::bessel::scaled_i0;
use crate::parallel;

/// Places along each axis of a patch in which noise is measured, for one, two and three axes.
const PATCH: [usize; MAX_AXES] = [512, 32, 12];

/// Fewest places with data that measure noise.
const FEWEST: usize = 64;

/// Median of the absolute values of a normal distribution of variance 1.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

impl Grid {
    /// Number of axes with more than one place.
    pub(crate) fn n_long_axes(&self) -> usize {
        self.axes.long().count()
    }

    /// Largest spacing of an axis with more than one place, in model units.
    pub(crate) fn coarsest(&self) -> f64 {
        self.axes.long().map(|axis| self.axes.spacings[axis]).fold(0.0, f64::max)
    }

    /// Position of a place in model units.
    pub(crate) fn position(&self, place: usize) -> [f64; 3] {
        self.position_at(self.coordinates(place))
    }

    /// Coordinates of a place along each axis, in places.
    pub(crate) fn coordinates(&self, place: usize) -> [f64; MAX_AXES] {
        std::array::from_fn(|axis| {
            if axis < self.axes.sizes.len() { self.axes.coordinate(axis, place) as f64 } else { 0.0 }
        })
    }

    /// Position of a point between places, given in places along each axis.
    pub(crate) fn position_at(&self, at: [f64; MAX_AXES]) -> [f64; 3] {
        let steps = self.frame.steps.iter().zip(at);
        steps.fold(self.frame.origin, |position, (step, at)| crate::vector::add_scaled(&position, at, step))
    }

    /// Share of a unit at a place that is still there after heat of width √`square` (σ², squared model units), far from
    /// borders: the product of `e^(−v) I₀(v)` over the axes, v = σ²/2h².
    pub(crate) fn own_share(&self, square: f64) -> f64 {
        self.axes.long().map(|axis| scaled_i0(0.5 * square / self.axes.spacings[axis].powi(2))).product()
    }

    /// Steps along the axes to places whose distance from another is `radius` to within `half`, or to within half of the
    /// finest spacing if that is more; along each axis they are `apart` or less from each other, or next to each other.
    /// All lengths are in model units.
    pub(crate) fn shell(&self, radius: f64, half: f64, apart: f64) -> Vec<[isize; MAX_AXES]> {
        let half = half.max(0.5 * self.axes.finest());
        let mut found = vec![([0; MAX_AXES], 0.0)];
        for axis in self.axes.long() {
            let spacing = self.axes.spacings[axis];
            let stride = ((apart / spacing) as isize).max(1);
            let reach = ((radius + half) / spacing).min(self.axes.sizes[axis] as f64) as isize / stride;
            let along = |(step, square): &([isize; MAX_AXES], f64)| {
                let (step, square) = (*step, *square);
                (-reach..=reach).map(move |k| k * stride).map(move |k| {
                    let mut step = step;
                    step[axis] = k;
                    (step, square + (k as f64 * spacing).powi(2))
                })
            };
            found =
                found.iter().flat_map(along).filter(|(_, square)| square.sqrt() <= radius + half).collect();
        }
        found.into_iter().filter(|(_, square)| square.sqrt() >= radius - half).map(|(step, _)| step).collect()
    }

    /// The place that is `step` away along the axes; `None` beyond a border.
    pub(crate) fn place_at(&self, place: usize, step: &[isize; MAX_AXES]) -> Option<usize> {
        let mut found = place as isize;
        for axis in self.axes.long().filter(|&axis| step[axis] != 0) {
            let (n, at) = (self.axes.sizes[axis] as isize, self.axes.coordinate(axis, place) as isize);
            let mut other = at + step[axis];
            if self.axes.is_periodic[axis] {
                other = other.rem_euclid(n);
            } else if !(0..n).contains(&other) {
                return None;
            }
            found += (other - at) * self.axes.stride(axis) as isize;
        }
        Some(found as usize)
    }

    /// Standard deviation of independent noise in each patch: the largest of the medians of several measures, and of the
    /// patches around.
    pub(crate) fn noise(&self, measures: &[NoiseMeasure<'_>]) -> NoisePatches {
        let edge = PATCH[self.n_long_axes().clamp(1, MAX_AXES) - 1];
        let sizes: Vec<usize> = self.axes.sizes.iter().map(|n| (n / edge).max(1)).collect();
        let patches = Self::new(&sizes, &vec![1.0; sizes.len()]).expect("one spacing for each size");
        let bounds = |patch: usize, axis: usize| {
            let (n, k) = (self.axes.sizes[axis], patches.axes.coordinate(axis, patch));
            n * k / sizes[axis]..n * (k + 1) / sizes[axis]
        };
        let median = |patch: usize| {
            let mut places = vec![0];
            for axis in 0..sizes.len() {
                let stride = self.axes.stride(axis);
                places =
                    places.iter().flat_map(|p| bounds(patch, axis).map(move |k| p + k * stride)).collect();
            }
            let by_measure = |measure: &NoiseMeasure<'_>| {
                let size = |&x: &usize| (measure.level[x] - measure.share * measure.background[x]).abs();
                let mut sizes: Vec<f64> = places.iter().map(size).filter(|size| !size.is_nan()).collect();
                if sizes.len() < FEWEST.min(self.n_places()) {
                    return 0.0;
                }
                let middle = sizes.len() / 2;
                *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
                    / (MEDIAN_OF_NORMAL * measure.deviation)
            };
            measures.iter().map(by_measure).fold(0.0, f64::max)
        };
        let own = parallel::map_items(self.n_places() * measures.len(), patches.n_places(), median);
        let around = Self { frame: patches.frame.clone(), ..patches }.largest_around(own);
        NoisePatches { sizes: self.axes.sizes.clone(), counts: sizes, deviations: around }
    }

    /// The largest value of each place and of those beside it, diagonals included.
    fn largest_around(&self, mut values: Vec<f64>) -> Vec<f64> {
        for axis in self.axes.long() {
            let largest = |x: usize| {
                let sides = self.axes.sides(axis, x, self.axes.coordinate(axis, x));
                sides.iter().flatten().fold(values[x], |largest: f64, y| largest.max(values[*y]))
            };
            values = (0..values.len()).map(largest).collect();
        }
        values
    }
}

/// A sum that measures noise at each place: a level of a signal less a share of another that tells its background.
pub(crate) struct NoiseMeasure<'a> {
    pub(crate) level: &'a [f64],
    pub(crate) background: &'a [f64],
    pub(crate) share: f64,
    /// Standard deviation of the sum for noise of variance 1.
    pub(crate) deviation: f64,
}

/// Noise of a grid by patches.
pub(crate) struct NoisePatches {
    sizes: Vec<usize>,
    counts: Vec<usize>,
    deviations: Vec<f64>,
}

impl NoisePatches {
    /// Standard deviation at a place.
    pub(crate) fn deviation_at(&self, mut place: usize) -> f64 {
        let (mut patch, mut stride) = (0, 1);
        for (n, n_patches) in self.sizes.iter().zip(&self.counts).rev() {
            // The patch k begins at n·k/n_patches, rounded down.
            patch += ((place % n + 1) * n_patches - 1) / n * stride;
            place /= n;
            stride *= n_patches;
        }
        self.deviations[patch]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Decomposer;
    use crate::bands::Schedule;

    #[test]
    fn the_own_share_is_what_heat_leaves_at_a_place() {
        let grid = Grid::new(&[41, 33], &[1.0, 2.0]).unwrap();
        let middle = 20 * 33 + 16;
        let mut unit = vec![0.0; grid.n_places()];
        unit[middle] = 1.0;
        let decomposer = Decomposer::from_domain(grid.clone(), grid.heat()).unwrap();
        for sigma in [0.5, 1.0, 3.0, 6.0] {
            let heat = decomposer.decompose(&unit, 1, &Schedule::lengths(&[sigma], 1.0).unwrap()).unwrap();
            assert!((heat.coarsest()[middle] - grid.own_share(sigma * sigma)).abs() < 1e-7, "{sigma}");
        }
    }

    #[test]
    fn patches_cover_a_grid_and_noise_is_that_of_the_patches_around() {
        let grid = Grid::new(&[70, 100], &[1.0, 1.0]).unwrap();
        // Twice as strong in the last rows.
        let level: Vec<f64> = (0..7000)
            .map(|x| [-1.0, 1.0][x % 2] * if x / 100 >= 35 { 2.0 } else { 1.0 } * MEDIAN_OF_NORMAL)
            .collect();
        let none = vec![0.0; 7000];
        let measure = |level, deviation| NoiseMeasure { level, background: &none, share: 0.0, deviation };
        let noise = grid.noise(&[measure(&level, 0.5)]);
        assert_eq!(noise.counts, [2, 3]);
        // The patches of the first rows are beside those of the last.
        assert!((0..7000).all(|x| (noise.deviation_at(x) - 4.0).abs() < 1e-9));
        let tall = Grid::new(&[140, 10], &[1.0, 1.0]).unwrap();
        let level: Vec<f64> = (0..1400).map(|x| if x < 350 { 3.0 } else { 1.0 }).collect();
        let noise = tall.noise(&[measure(&level, MEDIAN_OF_NORMAL.recip())]);
        let found: Vec<f64> = [0, 690, 700, 1399].map(|x| noise.deviation_at(x).round()).to_vec();
        assert_eq!(found, [3.0, 3.0, 1.0, 1.0]);
    }

    #[test]
    fn a_shell_has_places_in_all_directions_at_its_radius() {
        let grid = Grid::new(&[30, 30, 30], &[1.0, 1.0, 2.0]).unwrap();
        let shell = grid.shell(4.0, 0.0, 0.0);
        let away = |s: &[isize; 3]| ((s[0] * s[0] + s[1] * s[1] + 4 * s[2] * s[2]) as f64).sqrt();
        assert!(shell.iter().all(|s| (away(s) - 4.0).abs() <= 0.5));
        assert!([[4, 0, 0], [0, -4, 0], [0, 0, 2]].iter().all(|s| shell.contains(s)));
        let sparse = grid.shell(6.0, 2.0, 3.0);
        assert!(sparse.iter().all(|s| (4.0..=8.0).contains(&away(s)) && s[0] % 3 == 0 && s[1] % 3 == 0));
        assert!([[6, 0, 0], [0, -3, 2], [0, 0, 3]].iter().all(|s| sparse.contains(s)));
        let ring = Grid::new(&[8], &[1.0]).unwrap().with_periodic(&[true]).unwrap();
        assert_eq!((ring.place_at(7, &[3, 0, 0]), grid.place_at(29, &[0, 0, 1])), (Some(2), None));
    }
}
