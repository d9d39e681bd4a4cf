//! Noise for benchmarks of denoisers: seeded, in units of the mean edge, equal for welded vertices so that seams stay
//! closed.

use adwave::Progress;
use adwave::shape::{Adjacency, Mesh, PreparedGeometry, Shape, WeldMode, one_ring, vertex_normals};
use adwave::vector::{Vector, norm, subtract};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Kind of noise; σ is the root mean square displacement, for [`Noise::Impulsive`] that of the displaced vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Along the normals, independent for each vertex.
    Normal,
    /// In all directions, each coordinate with σ/√3.
    Isotropic,
    /// Along the normals, one vertex in five.
    Impulsive,
    /// Along one line of sight, smoothed over the surface, as from a scanner.
    Scanner,
}

/// Line of sight of the scanner.
const SIGHT: Vector = [0.267_261, 0.534_522, 0.801_784];
/// Number of times that scanner noise is averaged over the one-ring; it is then correlated over about three edges.
const SMOOTHINGS: usize = 4;
/// Fraction of the vertices displaced by impulses.
const HIT: f64 = 0.2;

impl Noise {
    /// Kinds by name.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("normal", Self::Normal),
        ("isotropic", Self::Isotropic),
        ("impulsive", Self::Impulsive),
        ("scanner", Self::Scanner),
    ];

    /// Finds a kind by its name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(n, _)| *n == name).map(|(_, kind)| *kind)
    }

    /// Adds noise of `sigma` mean edges to the positions of the mesh, in its order. The same seed gives the same
    /// noise.
    pub fn apply(self, mesh: &Mesh, sigma: f64, seed: u64) -> Vec<[f64; 3]> {
        let shape = Shape::Mesh(mesh.clone());
        let geometry = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none())
            .unwrap_or_else(|_| unreachable!("nothing cancels it"));
        let (points, triangles) = (geometry.points(), geometry.triangles());
        let ring = one_ring(points.len(), triangles);
        let scale = sigma * mean_edge(points, &ring);
        // Drawn in the order of the file, so that the internal numbering has no influence.
        let map = geometry.vertex_map();
        let mut first = vec![usize::MAX; points.len()];
        for x in (0..map.n_vertices()).rev() {
            first[map.welded(x)] = x;
        }
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by_key(|&x| first[x]);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut shifts = vec![[0.0; 3]; points.len()];
        let normals = vertex_normals(points, triangles);
        for &x in &order {
            let deviates: [f64; 3] = std::array::from_fn(|_| StandardNormal.sample(&mut random));
            let hit = (random.next_u64() >> 11) as f64 / ((1_u64 << 53) as f64) < HIT;
            shifts[x] = match self {
                Self::Normal => normals[x].map(|n| n * deviates[0]),
                Self::Isotropic => deviates.map(|d| d / 3.0_f64.sqrt()),
                Self::Impulsive if hit => normals[x].map(|n| n * deviates[0]),
                Self::Impulsive => [0.0; 3],
                Self::Scanner => [deviates[0], 0.0, 0.0],
            };
        }
        if self == Self::Scanner {
            let heights = smooth_heights(shifts.iter().map(|s| s[0]).collect(), &ring);
            shifts = heights.iter().map(|h| SIGHT.map(|s| s * h)).collect();
        }
        let moved: Vec<f64> = points
            .iter()
            .zip(&shifts)
            .flat_map(|(p, s)| std::array::from_fn::<f64, 3, _>(|k| p[k] + scale * s[k]))
            .collect();
        map.scatter(&moved, 3).as_chunks().0.to_vec()
    }
}

/// Averages heights over the surface and rescales them to a mean square of 1.
fn smooth_heights(mut heights: Vec<f64>, ring: &Adjacency) -> Vec<f64> {
    for _ in 0..SMOOTHINGS {
        heights = (0..heights.len())
            .map(|x| {
                let around: f64 = ring.row(x).iter().map(|&y| heights[y as usize]).sum();
                (heights[x] + around) / (1 + ring.row(x).len()) as f64
            })
            .collect();
    }
    let square = heights.iter().map(|h| h * h).sum::<f64>() / heights.len().max(1) as f64;
    let scale = if square > 0.0 { square.sqrt().recip() } else { 0.0 };
    heights.iter().map(|h| h * scale).collect()
}

/// Mean length of the distinct edges, in model units.
fn mean_edge(points: &[[f64; 3]], ring: &Adjacency) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for x in 0..points.len() {
        for &y in ring.row(x).iter().filter(|&&y| y as usize > x) {
            sum += norm(&subtract(&points[x], &points[y as usize]));
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::sample::Sample;

    #[test]
    fn every_kind_has_the_asked_size_and_its_own_structure() {
        let sample = Sample::from_name("sphere", Some(5000)).unwrap();
        let edge = sample.mean_edge_length();
        let mesh = Mesh::new(sample.points, sample.faces).unwrap();
        let ring = one_ring(5000, mesh.faces().triangles().unwrap());
        for (name, kind) in Noise::NAMES {
            let moved = kind.apply(&mesh, 0.3, 5);
            assert_eq!(moved, kind.apply(&mesh, 0.3, 5), "{name}");
            assert_ne!(moved, kind.apply(&mesh, 0.3, 6), "{name}");
            let shifts: Vec<Vector> = moved.iter().zip(mesh.points()).map(|(q, p)| subtract(q, p)).collect();
            let hit: Vec<&Vector> = shifts.iter().filter(|s| norm(s) > 1e-15).collect();
            let part = hit.len() as f64 / 5000.0;
            assert!((part - if kind == Noise::Impulsive { HIT } else { 1.0 }).abs() < 0.03, "{name}: {part}");
            let rms = (hit.iter().map(|s| norm(s).powi(2)).sum::<f64>() / hit.len() as f64).sqrt() / edge;
            // Five standard errors of a standard deviation from 1,000 samples.
            assert!((rms / 0.3 - 1.0).abs() < 5.0 / 2000.0_f64.sqrt(), "{name}: {rms}");
            let neighbors: f64 = (0..5000)
                .map(|x| {
                    let y = ring.row(x)[0] as usize;
                    adwave::vector::dot(&shifts[x], &shifts[y])
                })
                .sum::<f64>()
                / shifts.iter().map(|s| norm(s).powi(2)).sum::<f64>();
            // Averaged displacements of neighbors are similar, the others are independent.
            assert_eq!(neighbors > 0.6, kind == Noise::Scanner, "{name}: {neighbors}");
        }
    }
}
