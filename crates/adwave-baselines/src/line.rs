//! Numerical comparison of three kinds of wavelets, as in Fig. 2 and Table 1 of the paper.

use crate::multiscale::{
    BiorthogonalDiffusionWavelets, DiffusionWavelets, Downsampled, Locality, MultiscaleError,
    MultiscaleParams, downsample, locality,
};
use adwave::Decomposer;
use adwave::Progress;
use adwave::shape::Shape;
use std::time::Instant;

/// Measures of one kind of wavelets on one level.
#[derive(Clone, Debug, PartialEq)]
pub struct LineCase {
    /// Name of the kind: `"DW"`, `"BDW"` or `"ADW"`.
    pub name: &'static str,
    /// Level, from 1.
    pub level: usize,
    /// Number of steps of the walk up to the level, 2^level − 1 for each kind.
    pub steps: usize,
    /// Number of scaling functions.
    pub count: usize,
    /// Means over all scaling functions.
    pub scaling: MeanLocality,
    /// Means over all wavelets.
    pub wavelet: MeanLocality,
    /// Means over all duals; `None` if the kind has no duals.
    pub dual: Option<MeanLocality>,
    /// Largest `|⟨φ_i, φ̃_k⟩ − δ_ik|`, each φ of unit length; φ̃ = φ if the kind has no duals.
    pub defect: f64,
    /// Selections of ADW's scaling functions and wavelets, as many as their rank; `None` for the other kinds.
    pub downsampled: Option<[Downsampled; 2]>,
    /// Largest error of a signal that is decomposed on all levels up to this one and reconstructed.
    pub error: f64,
    /// Seconds spent on the reconstruction, after all preparations.
    pub seconds: f64,
    /// Scaling function that peaks nearest to the middle vertex.
    pub middle_scaling: Vec<f64>,
    /// Wavelet that peaks nearest to the middle vertex.
    pub middle_wavelet: Vec<f64>,
}

/// Means of [`Locality`] over several functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanLocality {
    /// Mean of the support.
    pub support: f64,
    /// Mean of the smallest number of vertices that hold 99 % of a function.
    pub core: f64,
    /// Largest of the values [`Locality::mean`].
    pub mean: f64,
}

/// Measures DW, BDW and ADW of `shape`'s walk on each of `levels`, all after the same number of steps. Level j of DW
/// and BDW is T^(2^j − 1), one power T^(2^i) for each earlier level, so ADW uses the steps n_j = 2^j − 1 instead of
/// 2^(j − 1). The functions of ADW are the rows of Φ_j (eq. 6) and Ψ_j (eq. 8) at every vertex; the other kinds have as
/// many functions as the rank.
///
/// # Errors
/// [`MultiscaleError`] if the walk is too large or not reversible.
pub fn line_case(shape: &Shape, levels: &[usize]) -> Result<Vec<LineCase>, MultiscaleError> {
    let decomposer = Decomposer::new(shape);
    let walk = decomposer.rows("a comparison of bases")?;
    let n = walk.n_vertices();
    let top = levels.iter().copied().max().unwrap_or(1);
    let params = MultiscaleParams::default().with_levels(top);
    let dw = DiffusionWavelets::new(walk, &params, Progress::none())?;
    let bdw = BiorthogonalDiffusionWavelets::new(walk, &params, Progress::none())?;
    let signal = (0..n).map(|i| (0.2 * i as f64).sin() + f64::from(u8::from(i % 13 == 5))).collect();
    let test = LineTest { decomposer: &decomposer, signal, precision: params.precision };
    let mut cases = Vec::new();
    for &level in levels {
        if level == 0 || level > dw.n_levels().min(bdw.n_levels()) {
            continue;
        }
        cases.extend([
            test.orthogonal_case(&dw, level)?,
            test.biorthogonal_case(&bdw, level)?,
            test.adaptive_case(level)?,
        ]);
    }
    Ok(cases)
}

/// Walk and test signal shared by the cases of [`line_case`].
struct LineTest<'a> {
    decomposer: &'a Decomposer,
    /// Test signal at the rows of the walk: a sine with spikes.
    signal: Vec<f64>,
    /// Precision of the downsampling.
    precision: f64,
}

impl LineTest<'_> {
    fn orthogonal_case(&self, dw: &DiffusionWavelets, level: usize) -> Result<LineCase, MultiscaleError> {
        let coefficients = dw.analyze(&self.signal)?;
        let start = Instant::now();
        let back = dw.synthesize(&coefficients)?;
        let seconds = start.elapsed().as_secs_f64();
        let scaling = self.scatter(&dw.scaling_functions(level));
        let wavelets = self.scatter(&dw.wavelets(level));
        let defect = dw.orthogonality_defect(level);
        let error = self.largest_error(&back);
        Ok(LineCase { error, seconds, ..case("DW", level, &scaling, &wavelets, defect) })
    }

    fn biorthogonal_case(
        &self,
        bdw: &BiorthogonalDiffusionWavelets,
        level: usize,
    ) -> Result<LineCase, MultiscaleError> {
        let coefficients = bdw.analyze(&self.signal)?;
        let start = Instant::now();
        let back = bdw.synthesize(&coefficients)?;
        let seconds = start.elapsed().as_secs_f64();
        let scaling = self.scatter(&bdw.scaling_functions(level));
        let wavelets = self.scatter(&bdw.wavelets(level));
        let defect = bdw.biorthogonality_defect(level);
        Ok(LineCase {
            error: self.largest_error(&back),
            seconds,
            dual: Some(measure(&bdw.dual_functions(level))),
            ..case("BDW", level, &scaling, &wavelets, defect)
        })
    }

    fn adaptive_case(&self, level: usize) -> Result<LineCase, MultiscaleError> {
        let walk = self.decomposer.rows("a comparison of bases")?;
        let n = walk.n_vertices();
        // Rows of Φ_j: powers of the walk, 2·(2^(j−1) − 1) + 1 = 2^j − 1.
        let once = dense_walk(walk);
        let mut powers = vec![identity(n), once.clone()];
        for j in 2..=level {
            let next = multiply(&multiply(&powers[j - 1], &powers[j - 1]), &once);
            powers.push(next);
        }
        let wavelets: Vec<Vec<Vec<f64>>> = (1..=level)
            .map(|j| powers[j - 1].iter().zip(&powers[j]).map(|(a, b)| subtract(a, b)).collect())
            .collect();
        let product = |m: &[Vec<f64>]| -> Vec<f64> {
            m.iter().map(|row| row.iter().zip(&self.signal).map(|(a, b)| a * b).sum()).collect()
        };
        let bands: Vec<Vec<f64>> =
            wavelets.iter().map(|w| product(w)).chain([product(&powers[level])]).collect();
        let start = Instant::now();
        let mut back = vec![0.0; n];
        for band in &bands {
            back.iter_mut().zip(band).for_each(|(b, p)| *b += p);
        }
        let seconds = start.elapsed().as_secs_f64();
        let (scaling, wavelets) = (&powers[level], &wavelets[level - 1]);
        let defect = gram_defect(scaling);
        let downsampled = [downsample(scaling, self.precision)?, downsample(wavelets, self.precision)?];
        Ok(LineCase {
            error: self.largest_error(&back),
            seconds,
            downsampled: Some(downsampled),
            ..case("ADW", level, &self.scatter(scaling), &self.scatter(wavelets), defect)
        })
    }

    /// Converts functions to the order of the shape, so that the middle index is the middle vertex.
    fn scatter(&self, functions: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let vertex_map = self.decomposer.vertex_map();
        functions.iter().map(|f| vertex_map.scatter(f, 1)).collect()
    }

    /// Largest error of a reconstruction of the signal.
    fn largest_error(&self, back: &[f64]) -> f64 {
        back.iter().zip(&self.signal).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

fn case(
    name: &'static str,
    level: usize,
    scaling: &[Vec<f64>],
    wavelets: &[Vec<f64>],
    defect: f64,
) -> LineCase {
    LineCase {
        name,
        level,
        steps: (1 << level) - 1,
        count: scaling.len(),
        scaling: measure(scaling),
        wavelet: measure(wavelets),
        dual: None,
        downsampled: None,
        defect,
        error: 0.0,
        seconds: 0.0,
        middle_scaling: nearest_to_middle(scaling),
        middle_wavelet: nearest_to_middle(wavelets),
    }
}

fn measure(functions: &[Vec<f64>]) -> MeanLocality {
    let each: Vec<Locality> = functions.iter().map(|f| locality(f)).collect();
    let mean = |count: fn(&Locality) -> usize| {
        each.iter().map(|l| count(l) as f64).sum::<f64>() / each.len().max(1) as f64
    };
    MeanLocality {
        support: mean(|l| l.support),
        core: mean(|l| l.core),
        mean: each.iter().map(|l| l.mean).fold(0.0, f64::max),
    }
}

fn nearest_to_middle(functions: &[Vec<f64>]) -> Vec<f64> {
    let peak = |f: &Vec<f64>| (0..f.len()).max_by(|&a, &b| f[a].abs().total_cmp(&f[b].abs())).unwrap_or(0);
    functions.iter().min_by_key(|f| peak(f).abs_diff(f.len() / 2)).cloned().unwrap_or_default()
}

fn identity(n: usize) -> Vec<Vec<f64>> {
    (0..n).map(|x| (0..n).map(|y| f64::from(u8::from(x == y))).collect()).collect()
}

fn dense_walk(walk: &adwave::operator::Diffusion) -> Vec<Vec<f64>> {
    let n = walk.n_vertices();
    (0..n)
        .map(|x| {
            let mut row = vec![0.0; n];
            row[x] = walk.diagonal(x);
            let (columns, weights) = walk.row(x);
            for (&y, &w) in columns.iter().zip(weights) {
                row[y as usize] = w;
            }
            row
        })
        .collect()
}

fn multiply(left: &[Vec<f64>], right: &[Vec<f64>]) -> Vec<Vec<f64>> {
    left.iter()
        .map(|row| {
            let mut out = vec![0.0; row.len()];
            for (a, other) in row.iter().zip(right) {
                out.iter_mut().zip(other).for_each(|(o, b)| *o += a * b);
            }
            out
        })
        .collect()
}

fn subtract(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Largest magnitude of the inner product of two functions, scaled to unit length.
fn gram_defect(functions: &[Vec<f64>]) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let lengths: Vec<f64> = functions.iter().map(|f| dot(f, f).sqrt()).collect();
    let mut most = 0.0_f64;
    for (i, f) in functions.iter().enumerate() {
        for (k, g) in functions[..i].iter().enumerate() {
            most = most.max((dot(f, g) / (lengths[i] * lengths[k])).abs());
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::shape::Graph;

    #[test]
    fn support_counts_what_as_many_steps_reach() {
        let edges: Vec<_> = (1..100).map(|i| (i - 1, i, 1.0)).collect();
        let line = Shape::Graph(Graph::new(100, &edges).unwrap());
        let cases = line_case(&line, &[3]).unwrap();
        let of = |name: &str| cases.iter().find(|c| c.name == name).unwrap();
        // 7 steps of a lazy walk reach 7 points on each side, the furthest with (1/4)^7 = 6e-5 of a step.
        let middle = &of("ADW").middle_scaling;
        let reached = middle.iter().filter(|v| **v > 0.0).count();
        assert_eq!((of("ADW").steps, reached, locality(middle).support), (7, 15, 15));
        assert!((of("BDW").scaling.support - of("ADW").scaling.support).abs() < 1.0, "{cases:?}");
    }

    #[test]
    fn the_claims_of_table_1_hold_on_the_line_of_figure_2() {
        let edges: Vec<_> = (1..100).map(|i| (i - 1, i, 1.0)).collect();
        let line = Shape::Graph(Graph::new(100, &edges).unwrap());
        for cases in line_case(&line, &[9, 10]).unwrap().chunks(3) {
            let [dw, bdw, adw] = cases else { panic!("three kinds on each level") };
            assert!(dw.defect < 1e-10 && bdw.defect < 1e-8, "{} {}", dw.defect, bdw.defect);
            assert!(adw.defect > 0.9, "neighboring functions of the ADW overlap: {}", adw.defect);
            // By the footnote of Table 1, as many functions as the rank have duals. A dual is as long as the
            // precision allows, 1/ε.
            for kept in adw.downsampled.as_ref().unwrap() {
                assert!((2..50).contains(&kept.kept.len()), "{}", kept.kept.len());
                assert!(kept.defect < 1e-8 && kept.longest_dual > 1.0, "{kept:?}");
            }
            // This number of steps reaches nearly all of the line: 1e-6 of a peak lies 5.3 σ away, at least 84
            // points.
            for case in [dw, bdw, adw] {
                assert!(case.scaling.support > 90.0, "{} {}: {:?}", case.name, case.level, case.scaling);
            }
            // The core is narrower than that of DW, and equal for ADW and BDW, as both are the same power of the
            // walk.
            assert!(bdw.scaling.core < dw.scaling.core, "{:?} {:?}", bdw.scaling, dw.scaling);
            assert!(adw.scaling.core < dw.scaling.core, "{:?} {:?}", adw.scaling, dw.scaling);
            assert!(
                (adw.scaling.core / bdw.scaling.core - 1.0).abs() < 0.1,
                "{:?} {:?}",
                adw.scaling,
                bdw.scaling
            );
            // Zero mean: to rounding for ADW, not for BDW.
            assert!(adw.wavelet.mean < 1e-9, "{}", adw.wavelet.mean);
            assert!(bdw.wavelet.mean > 1e-3, "{}", bdw.wavelet.mean);
            for case in cases {
                assert!(case.error < 1e-8, "{}: {}", case.name, case.error);
            }
        }
    }
}
