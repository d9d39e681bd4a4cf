//! Weights of neighbors: kernels of their distances.

use crate::{GraphWalkError, NearestLists};
use adwave::rows::CompressedRows;
use adwave::{Progress, named_values};
use rayon::prelude::*;

/// Weight of a pair of neighbors at the distance d.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Kernel {
    /// The kernel of the paper (eq. 1), `exp(−d²/2E²)` with E the mean distance between neighbors, and points of equal
    /// areas. Pairs are neighbors if either is among the nearest of the other.
    #[default]
    Paper,
    /// `exp(−(d/σ_x)^decay)`, σ_x the distance from x to its `scale_neighbor`-th neighbor, then the mean of both
    /// directions (`vandijk2018`).
    Adaptive {
        /// Exponent, > 0.
        decay: f64,
        /// Neighbor at the scale of a point, from 1.
        scale_neighbor: usize,
    },
    /// `exp(−d²/σ_xσ_y)` (`zelnikmanor2004`). Pairs are neighbors if either is among the nearest of the other.
    SelfTuning {
        /// Neighbor at the scale of a point, from 1.
        scale_neighbor: usize,
    },
    /// `k(x,y)/q(x)q(y)` with the kernel k of the paper and its row sums q, which removes the density of the points (α
    /// = 1 of `coifmanlafon2006`).
    DensityInvariant,
}

/// Name of a [`Kernel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum KernelName {
    /// [`Kernel::Adaptive`].
    Adaptive,
    /// [`Kernel::Paper`].
    Paper,
    /// [`Kernel::SelfTuning`].
    SelfTuning,
    /// [`Kernel::DensityInvariant`].
    DensityInvariant,
}

named_values!(KernelName, "kernel", {
    Adaptive => "adaptive", "exp(−d/σ), σ the distance to the fifth neighbor, mean of both directions";
    Paper => "paper", "exp(−d²/2E²), E the mean distance, as in the paper";
    SelfTuning => "self-tuning", "exp(−d²/σσ′) with the scales of both points";
    DensityInvariant => "density-invariant", "The paper's, divided by the density of the points";
});

impl KernelName {
    /// The kernel of this name; those without a decay or a scale leave them out.
    pub fn with_scale(self, decay: f64, scale_neighbor: usize) -> Kernel {
        match self {
            Self::Adaptive => Kernel::Adaptive { decay, scale_neighbor },
            Self::Paper => Kernel::Paper,
            Self::SelfTuning => Kernel::SelfTuning { scale_neighbor },
            Self::DensityInvariant => Kernel::DensityInvariant,
        }
    }
}

/// Smallest weight that is kept: smaller ones have no effect in double precision and only cost time.
const NEGLIGIBLE: f64 = 1e-16;

/// Symmetric weights of the neighbors, n_points × n_points, without a diagonal. O(entries · log).
///
/// Duplicates have the distance 0 and the weight 1. If the scale σ_x of a point is 0, its smallest positive distance is
/// used.
///
/// # Errors
/// [`GraphWalkError`] if the decay is out of range or the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave_graph::{Kernel, NearestLists, kernel_weights};
/// let pair = NearestLists::from_arrays(2, &[1, 0], &[2.0, 2.0])?;
/// let weights = kernel_weights(&pair, Kernel::Adaptive { decay: 1.0, scale_neighbor: 1 }, Progress::none())?;
/// assert_eq!(weights.row(0), ([1].as_slice(), [(-1.0_f64).exp()].as_slice()));
/// # Ok::<(), adwave_graph::GraphWalkError>(())
/// ```
pub fn kernel_weights(
    lists: &NearestLists,
    kernel: Kernel,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, GraphWalkError> {
    progress.check()?;
    let n_pairs = lists.distances.len().max(1) as f64;
    let mean = lists.distances.iter().map(|d| d / n_pairs).sum::<f64>();
    let gaussian = |_: usize, _: usize, d: f64| {
        if mean > 0.0 { (-0.5 * (d / mean).powi(2)).exp() } else { 1.0 }
    };
    match kernel {
        Kernel::Paper => symmetric(lists, gaussian, Directions::Either, progress),
        Kernel::Adaptive { decay, scale_neighbor } => {
            if !(decay > 0.0 && decay.is_finite()) {
                return Err(GraphWalkError::BadDecay(decay));
            }
            let scale = scales(lists, scale_neighbor);
            let weight = |x: usize, _: usize, d: f64| {
                if d == 0.0 { 1.0 } else { (-(d / scale[x]).powf(decay)).exp() }
            };
            symmetric(lists, weight, Directions::Mean, progress)
        }
        Kernel::SelfTuning { scale_neighbor } => {
            let scale = scales(lists, scale_neighbor);
            let weight = |x: usize, y: usize, d: f64| {
                if d == 0.0 { 1.0 } else { (-(d / scale[x]) * (d / scale[y])).exp() }
            };
            symmetric(lists, weight, Directions::Either, progress)
        }
        Kernel::DensityInvariant => {
            let mut weights = symmetric(lists, gaussian, Directions::Either, progress)?;
            // A point is its own neighbor in the estimate of the density.
            let density: Vec<f64> =
                (0..weights.n_rows()).map(|x| 1.0 + weights.row(x).1.iter().sum::<f64>()).collect();
            let columns = weights.columns().to_vec();
            let offsets = weights.offsets().to_vec();
            for x in 0..density.len() {
                let range = offsets[x]..offsets[x + 1];
                for (w, &y) in weights.values_mut()[range.clone()].iter_mut().zip(&columns[range]) {
                    *w /= density[x] * density[y as usize];
                }
            }
            Ok(weights)
        }
    }
}

/// Distance of each point to its `neighbor`-th neighbor, or the smallest positive one after it; 1 if all are 0.
fn scales(lists: &NearestLists, neighbor: usize) -> Vec<f64> {
    let scale = |x: usize| {
        let distances = lists.row(x).1;
        let from = neighbor.max(1).min(distances.len()).saturating_sub(1);
        distances[from.min(distances.len())..].iter().copied().find(|&d| d > 0.0).unwrap_or(1.0)
    };
    (0..lists.n_points()).map(scale).collect()
}

/// Weight of a pair of which one direction may be missing.
#[derive(Clone, Copy, PartialEq)]
enum Directions {
    /// The weight of either.
    Either,
    /// The mean of both, a missing one counting as 0.
    Mean,
}

fn symmetric(
    lists: &NearestLists,
    weight: impl Fn(usize, usize, f64) -> f64,
    directions: Directions,
    progress: Progress<'_>,
) -> Result<CompressedRows<f64>, GraphWalkError> {
    let n = lists.n_points();
    let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(2 * lists.indices.len());
    for x in 0..n {
        if x % 4096 == 0 {
            progress.check()?;
        }
        let (indices, distances) = lists.row(x);
        for (&y, &d) in indices.iter().zip(distances) {
            let value = weight(x, y as usize, d);
            if value >= NEGLIGIBLE {
                entries.push((x as u32, y, value));
                entries.push((y, x as u32, value));
            }
        }
    }
    progress.check()?;
    entries.par_sort_unstable_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
    progress.check()?;
    // Of two directions the smaller comes first, in both rows: sums have the same bits.
    let mut merged: Vec<(u32, u32, f64)> = Vec::with_capacity(entries.len());
    for entry in entries {
        match merged.last_mut() {
            Some(last) if (last.0, last.1) == (entry.0, entry.1) => match directions {
                Directions::Either => last.2 = entry.2,
                Directions::Mean => last.2 += entry.2,
            },
            _ => merged.push(entry),
        }
    }
    if directions == Directions::Mean {
        for entry in &mut merged {
            entry.2 *= 0.5;
        }
    }
    Ok(CompressedRows::from_sorted(n, n, merged)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three points at 0, 1 and 3, with the two nearest of each.
    fn line() -> NearestLists {
        NearestLists::from_arrays(3, &[1, 2, 0, 2, 1, 0], &[1.0, 3.0, 1.0, 2.0, 2.0, 3.0]).unwrap()
    }

    fn weights(lists: &NearestLists, kernel: Kernel) -> CompressedRows<f64> {
        kernel_weights(lists, kernel, Progress::none()).unwrap()
    }

    #[test]
    fn weights_are_those_of_the_formulas() {
        let adaptive = weights(&line(), Kernel::Adaptive { decay: 1.0, scale_neighbor: 1 });
        let expected = 0.5 * ((-2.0_f64).exp() + (-1.0_f64).exp()); // σ₁ = 1, σ₂ = 2, d = 2
        assert!((adaptive.get(1, 2) - expected).abs() < 1e-16);
        let tuned = weights(&line(), Kernel::SelfTuning { scale_neighbor: 1 });
        assert!((tuned.get(1, 2) - (-2.0_f64).exp()).abs() < 1e-16);
        let paper = weights(&line(), Kernel::Paper);
        assert!((paper.get(0, 1) - (-0.125_f64).exp()).abs() < 1e-15); // E = 2
        let invariant = weights(&line(), Kernel::DensityInvariant);
        let q = |x: usize| 1.0 + paper.row(x).1.iter().sum::<f64>();
        assert!((invariant.get(0, 1) - paper.get(0, 1) / (q(0) * q(1))).abs() < 1e-15);
    }

    #[test]
    fn weights_are_symmetric_to_the_last_bit() {
        let kernels = [
            Kernel::Paper,
            Kernel::Adaptive { decay: 2.5, scale_neighbor: 2 },
            Kernel::SelfTuning { scale_neighbor: 2 },
            Kernel::DensityInvariant,
        ];
        for kernel in kernels {
            let weights = weights(&line(), kernel);
            for x in 0..3 {
                for y in 0..3 {
                    assert_eq!(weights.get(x, y), weights.get(y, x), "{kernel:?}");
                }
            }
        }
    }

    #[test]
    fn a_direction_that_is_missing_counts_as_zero_in_the_mean_alone() {
        let one_way = NearestLists::from_arrays(2, &[1, -1], &[2.0, 0.0]).unwrap();
        let adaptive = weights(&one_way, Kernel::Adaptive { decay: 1.0, scale_neighbor: 1 });
        assert_eq!(adaptive.get(1, 0), 0.5 * (-1.0_f64).exp());
        let tuned = weights(&one_way, Kernel::SelfTuning { scale_neighbor: 1 });
        assert_eq!(tuned.get(1, 0), tuned.get(0, 1));
    }

    #[test]
    fn duplicates_have_the_weight_one_and_a_bad_decay_an_error() {
        let lists =
            NearestLists::from_arrays(3, &[1, 2, 0, 2, 0, 1], &[0.0, 4.0, 0.0, 4.0, 4.0, 4.0]).unwrap();
        for kernel in
            [Kernel::Adaptive { decay: 1.0, scale_neighbor: 1 }, Kernel::SelfTuning { scale_neighbor: 1 }]
        {
            let weights = weights(&lists, kernel);
            assert_eq!(weights.get(0, 1), 1.0);
            assert!((weights.get(0, 2) - (-1.0_f64).exp()).abs() < 1e-16);
        }
        for decay in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let kernel = Kernel::Adaptive { decay, scale_neighbor: 1 };
            assert!(kernel_weights(&lists, kernel, Progress::none()).is_err());
        }
    }
}
