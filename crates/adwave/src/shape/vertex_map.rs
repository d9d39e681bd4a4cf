//! Vertices at exactly equal positions are one vertex of the analysis.
//!
//! STL stores every triangle with corners of its own, OBJ and glTF split vertices along texture seams: without welding
//! the walk could not cross there. The welded vertices are numbered along a Hilbert curve, so that vertices near in
//! space are near in memory whatever the order of the file, and so that the file's order does not change a single bit
//! of the result.

use rayon::prelude::*;

/// Whether vertices at exactly equal positions are merged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WeldMode {
    /// Vertices whose three coordinates are equal are one vertex of the analysis (0 and −0 are equal).
    #[default]
    EqualPositions,
    /// Every vertex stands for itself.
    Off,
}

/// Which vertices of the shape are one vertex of the analysis: a map from `0..n_vertices()` onto `0..n_welded()`.
#[derive(Clone, Debug)]
pub struct VertexMap {
    welded: Vec<u32>,
    n_welded: usize,
}

impl VertexMap {
    /// Groups `points` (finite) by position. O(n log n).
    ///
    /// ```
    /// use adwave::shape::{VertexMap, WeldMode};
    /// let vertex_map = VertexMap::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-0.0, 0.0, 0.0]], WeldMode::EqualPositions);
    /// assert_eq!(vertex_map.n_welded(), 2);
    /// assert_eq!(vertex_map.welded(0), vertex_map.welded(2));
    /// ```
    pub fn new(points: &[[f64; 3]], mode: WeldMode) -> Self {
        let Some((lo, hi)) = super::bounding_box(points) else {
            return Self { welded: Vec::new(), n_welded: 0 };
        };
        let extent = (0..3).map(|c| hi[c] - lo[c]).fold(0.0, f64::max);
        let cells = f64::from((1_u32 << HILBERT_BITS) - 1);
        let scale = if extent > 0.0 { cells / extent } else { 0.0 };
        let mut order: Vec<(u64, u32)> = points
            .par_iter()
            .enumerate()
            .map(|(i, p)| {
                // `scale` may overflow for a shape of subnormal extent; the cast saturates and the exact comparison
                // below still separates unequal points.
                (hilbert(std::array::from_fn(|c| ((p[c] - lo[c]) * scale) as u32)), i as u32)
            })
            .collect();
        order.par_sort_unstable_by(|a, b| {
            a.0.cmp(&b.0)
                .then_with(|| {
                    let (p, q) = (&points[a.1 as usize], &points[b.1 as usize]);
                    p.partial_cmp(q).expect("coordinates are finite")
                })
                .then(a.1.cmp(&b.1))
        });
        let mut welded = vec![0_u32; points.len()];
        let mut class = 0_u32;
        for k in 0..order.len() {
            let i = order[k].1 as usize;
            if k > 0 && (mode == WeldMode::Off || points[i] != points[order[k - 1].1 as usize]) {
                class += 1;
            }
            welded[i] = class;
        }
        Self { welded, n_welded: class as usize + 1 }
    }

    /// Every vertex stands for itself, at the given places: `welded(x) == place[x]`, each place once.
    pub(crate) fn from_places(place: Vec<u32>) -> Self {
        Self { n_welded: place.len(), welded: place }
    }

    /// Every vertex stands for itself, in the given order: `welded(x) == x`.
    pub fn identity(n_vertices: usize) -> Self {
        Self { welded: (0..n_vertices as u32).collect(), n_welded: n_vertices }
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.welded.len()
    }

    /// Number of vertices of the analysis.
    pub fn n_welded(&self) -> usize {
        self.n_welded
    }

    /// The vertex of the analysis that vertex `x` of the shape belongs to.
    pub fn welded(&self, x: usize) -> usize {
        self.welded[x] as usize
    }

    /// [`welded`](Self::welded) for all vertices.
    pub fn as_slice(&self) -> &[u32] {
        &self.welded
    }

    /// The vertices of each class, by rising index: where each class starts (and the end of the last), and the vertices.
    pub(crate) fn members(&self) -> (Vec<usize>, Vec<u32>) {
        super::adjacency::incidence(self.n_welded, self.welded.iter().zip(0..).map(|(&class, x)| (class, x)))
    }

    /// The positions of the analysis' vertices.
    pub fn positions(&self, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut positions = vec![[0.0; 3]; self.n_welded];
        for (&class, p) in self.welded.iter().zip(points) {
            positions[class as usize] = p.map(|c| c + 0.0); // −0 becomes 0, whichever of the two comes last
        }
        positions
    }

    /// The mean of `signal` (n_vertices × n_channels, row-major) over the vertices of each class.
    ///
    /// Where a class has one value only, however often, the mean is that value to the last bit.
    pub fn mean(&self, signal: &[f64], n_channels: usize) -> Vec<f64> {
        let mut mean = vec![0.0; self.n_welded * n_channels];
        if self.n_welded == self.welded.len() {
            for (&class, row) in self.welded.iter().zip(signal.chunks_exact(n_channels)) {
                mean[class as usize * n_channels..][..n_channels].copy_from_slice(row);
            }
            return mean;
        }
        let mut count = vec![0_u32; self.n_welded];
        for (&class, row) in self.welded.iter().zip(signal.chunks_exact(n_channels)) {
            count[class as usize] += 1;
            let n = f64::from(count[class as usize]);
            for (m, value) in mean[class as usize * n_channels..][..n_channels].iter_mut().zip(row) {
                *m += (value - *m) / n;
            }
        }
        mean
    }

    /// Gives every vertex of the shape the value of its class: n_welded × n_channels → n_vertices × n_channels.
    pub fn scatter<T: Copy + Send + Sync>(&self, values: &[T], n_channels: usize) -> Vec<T> {
        let mut scattered = Vec::with_capacity(self.welded.len() * n_channels);
        for &class in &self.welded {
            scattered.extend_from_slice(&values[class as usize * n_channels..][..n_channels]);
        }
        scattered
    }
}

/// Bits per axis of a Hilbert key: three axes fill 63 of 64 bits.
const HILBERT_BITS: u32 = 21;

/// Position along the Hilbert curve through the cube of 2²¹ cells a side (Skilling, "Programming the Hilbert curve",
/// AIP Conf. Proc. 707, 2004).
fn hilbert(mut axes: [u32; 3]) -> u64 {
    let mut q = 1_u32 << (HILBERT_BITS - 1);
    while q > 1 {
        let p = q - 1;
        for i in 0..3 {
            if axes[i] & q == 0 {
                let t = (axes[0] ^ axes[i]) & p;
                axes[0] ^= t;
                axes[i] ^= t;
            } else {
                axes[0] ^= p;
            }
        }
        q >>= 1;
    }
    axes[1] ^= axes[0];
    axes[2] ^= axes[1];
    let mut t = 0;
    let mut q = 1_u32 << (HILBERT_BITS - 1);
    while q > 1 {
        if axes[2] & q != 0 {
            t ^= q - 1;
        }
        q >>= 1;
    }
    let mut key = 0_u64;
    for bit in (0..HILBERT_BITS).rev() {
        for axis in axes {
            key = key << 1 | u64::from((axis ^ t) >> bit & 1);
        }
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hilbert_neighbours_in_order_are_neighbours_in_space() {
        // On the coarsest 8³ cells the curve visits every cell once and moves by one cell at a time.
        let shift = HILBERT_BITS - 3;
        let mut cells: Vec<(u64, [u32; 3])> = Vec::new();
        for x in 0..8 {
            for y in 0..8 {
                for z in 0..8 {
                    cells.push((hilbert([x << shift, y << shift, z << shift]) >> (3 * shift), [x, y, z]));
                }
            }
        }
        cells.sort_unstable();
        for (k, pair) in cells.windows(2).enumerate() {
            assert_eq!(pair[0].0, k as u64);
            let moved: u32 = (0..3).map(|c| pair[0].1[c].abs_diff(pair[1].1[c])).sum();
            assert_eq!(moved, 1, "{:?} to {:?}", pair[0].1, pair[1].1);
        }
    }

    #[test]
    fn the_order_of_the_points_does_not_change_the_classes() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, -0.0, 0.0], [0.2, 0.9, 1e-300]];
        let forward = VertexMap::new(&points, WeldMode::EqualPositions);
        let reversed: Vec<_> = points.iter().rev().copied().collect();
        let backward = VertexMap::new(&reversed, WeldMode::EqualPositions);
        assert_eq!(forward.positions(&points), backward.positions(&reversed));
        assert_eq!(forward.n_welded(), 3);
        assert_eq!(VertexMap::new(&points, WeldMode::Off).n_welded(), 4);
    }

    #[test]
    fn the_mean_of_equal_values_is_that_value() {
        let vertex_map = VertexMap { welded: vec![0, 1, 0, 0], n_welded: 2 };
        assert_eq!(vertex_map.mean(&[0.1, 7.0, 0.1, 0.1], 1), [0.1, 7.0]);
        assert_eq!(vertex_map.mean(&[1.0, 0.0, 2.0, 3.0], 1)[0], 2.0);
        assert_eq!(vertex_map.scatter(&[5, 6], 1), [5, 6, 5, 5]);
    }
}
