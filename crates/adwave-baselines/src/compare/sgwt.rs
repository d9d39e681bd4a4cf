//! Spectral graph wavelets of the same diffusion operator, with as many kernels as levels: decomposition and
//! reconstruction.

use super::shared::{channel, interleave, largest_difference, reconstruct, row, wavelets};
use super::{CompareError, Comparison, ComparisonInput, Outcome};
use crate::sgwt::{Frame, KernelFamily, Kernels, normalized_laplacian};
use adwave::Progress;
use adwave::bands::Bands;
use std::time::Instant;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    const ACCURACY: f64 = 1e-6;
    const SOLVED: f64 = 1e-10;
    let start = Instant::now();
    let walk = input.decomposer.rows("a spectral graph wavelet")?;
    let vertex_map = input.decomposer.vertex_map();
    let (laplacian, root) = normalized_laplacian(walk)?;
    // I − Q has its spectrum in [0, 2].
    let kernels = Kernels::new(KernelFamily::Meyer, (bands.n_levels() + 1).max(3), 2.0)?;
    let frame = Frame::new(laplacian, kernels, ACCURACY)?;
    let prepared = start.elapsed().as_secs_f64();
    let d = input.n_channels;
    let mean = vertex_map.mean(input.signal, d);
    let (mut analysis, mut synthesis, mut iterations) = (0.0, 0.0, 0);
    let n_kernels = frame.polynomials.len();
    let (mut back, mut parts) = (Vec::new(), vec![Vec::new(); n_kernels]);
    for c in 0..d {
        let f: Vec<f64> = channel(&mean, d, c).iter().zip(&root).map(|(f, r)| f * r).collect();
        let start = Instant::now();
        let coefficients = frame.analyze(&f, progress)?;
        analysis += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (inverse, info) = frame.inverse(&coefficients, SOLVED, progress)?;
        synthesis += start.elapsed().as_secs_f64();
        iterations = iterations.max(info.iterations);
        let unscale = |v: &[f64]| v.iter().zip(&root).map(|(v, r)| v / r).collect::<Vec<_>>();
        back.push(unscale(&inverse));
        for (part, coefficient) in parts.iter_mut().zip(&coefficients) {
            part.push(unscale(coefficient));
        }
    }
    let theirs = interleave(&back);
    let (ours, our_synthesis) = reconstruct(bands);
    let degree = frame.polynomials.iter().map(|p| p.coefficients.len() - 1).max().unwrap_or(0);
    let rows = vec![
        row("prepare, s", input.prepare_seconds, prepared),
        row("bands, s", seconds, analysis),
        row("reconstruction, s", our_synthesis, synthesis),
        row(
            "largest error of the reconstruction",
            largest_difference(input.signal, &ours),
            largest_difference(&mean, &theirs),
        ),
        row("bands including the low pass", (bands.n_levels() + 1) as f64, n_kernels as f64),
        row("products with the operator", bands.info.products as f64, degree as f64),
        row("iterations of the reconstruction", 0.0, iterations as f64),
        row("lower frame bound", None, frame.bounds.0),
        row("upper frame bound", None, frame.bounds.1),
    ];
    debug_assert_eq!(root.len(), walk.n_vertices());
    // From fine to coarse, as in adwave.
    let other = parts.iter().skip(1).rev().enumerate().map(|(k, part)| Outcome {
        name: format!("W{}", k + 1),
        n_channels: d,
        values: vertex_map.scatter(&interleave(part), d),
    });
    let task = "decompose and reconstruct".to_owned();
    Ok(Comparison { task, rows, adwave: wavelets(bands), other: other.collect() })
}
