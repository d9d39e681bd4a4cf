//! Orthogonal and biorthogonal diffusion wavelets: decomposition and reconstruction.

use super::shared::{channel, interleave, largest_difference, reconstruct, row};
use super::{CompareError, Comparison, ComparisonInput, Method, Outcome};
use crate::multiscale::{
    BiorthogonalDiffusionWavelets, Coefficients, DiffusionWavelets, MultiscaleError, MultiscaleParams,
    locality,
};
use adwave::Progress;
use adwave::bands::Bands;
use std::time::Instant;

/// Diffusion wavelets of either kind.
enum Basis {
    Orthogonal(DiffusionWavelets),
    Biorthogonal(BiorthogonalDiffusionWavelets),
}

impl Basis {
    fn analyze(&self, f: &[f64]) -> Result<Coefficients, MultiscaleError> {
        match self {
            Self::Orthogonal(basis) => basis.analyze(f),
            Self::Biorthogonal(basis) => basis.analyze(f),
        }
    }

    fn synthesize(&self, c: &Coefficients) -> Result<Vec<f64>, MultiscaleError> {
        match self {
            Self::Orthogonal(basis) => basis.synthesize(c),
            Self::Biorthogonal(basis) => basis.synthesize(c),
        }
    }
}

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    method: Method,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let diffusion = input.decomposer.rows("a diffusion wavelet basis")?;
    let (vertex_map, d) = (input.decomposer.vertex_map(), input.n_channels);
    let params = MultiscaleParams::default().with_levels(bands.n_levels());
    let start = Instant::now();
    let (basis, ranks, defect, functions) = if method == Method::DiffusionWavelets {
        let basis = DiffusionWavelets::new(diffusion, &params, progress)?;
        let last = basis.n_levels();
        let functions = basis.scaling_functions(last);
        (Basis::Orthogonal(basis.clone()), basis.ranks(), basis.orthogonality_defect(last), functions)
    } else {
        let basis = BiorthogonalDiffusionWavelets::new(diffusion, &params, progress)?;
        let last = basis.n_levels();
        let (defect, functions) = if last > 0 {
            (basis.biorthogonality_defect(last), basis.scaling_functions(last))
        } else {
            (0.0, Vec::new())
        };
        (Basis::Biorthogonal(basis.clone()), basis.ranks(), defect, functions)
    };
    let prepared = start.elapsed().as_secs_f64();
    let mean = vertex_map.mean(input.signal, d);
    let start = Instant::now();
    let coefficients: Vec<Coefficients> =
        (0..d).map(|c| basis.analyze(&channel(&mean, d, c))).collect::<Result<_, _>>()?;
    let analysis = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let back: Vec<Vec<f64>> = coefficients.iter().map(|c| basis.synthesize(c)).collect::<Result<_, _>>()?;
    let synthesis = start.elapsed().as_secs_f64();
    // The coarse shape: reconstruction from the scaling functions of the last level alone.
    let coarse = coefficients.iter().map(|c| {
        let mut c = c.clone();
        c.wavelets.iter_mut().flatten().for_each(|w| *w = 0.0);
        basis.synthesize(&c)
    });
    let coarse = interleave(&coarse.collect::<Result<Vec<_>, _>>()?);
    let (ours, our_synthesis) = reconstruct(bands);
    let support =
        |f: &[Vec<f64>]| f.iter().map(|f| locality(f).core as f64).sum::<f64>() / f.len().max(1) as f64;
    let mut rows = vec![
        row("prepare, s", input.prepare_seconds, prepared),
        row("bands, s", seconds, analysis),
        row("reconstruction, s", our_synthesis, synthesis),
        row(
            "largest error of the reconstruction",
            largest_difference(input.signal, &ours),
            largest_difference(&mean, &interleave(&back)),
        ),
        row("defect of (bi)orthogonality", None, defect),
        row(
            "mean number of vertices that hold 99 % of a scaling function of the last level",
            None,
            support(&functions),
        ),
    ];
    for (j, rank) in ranks.iter().enumerate() {
        rows.push(row(
            &format!("scaling coefficients at level {j}"),
            diffusion.n_vertices() as f64,
            *rank as f64,
        ));
    }
    let outcome = |values| vec![Outcome { name: "coarse".to_owned(), n_channels: d, values }];
    Ok(Comparison {
        task: "decompose and reconstruct".to_owned(),
        rows,
        adwave: outcome(bands.coarsest().to_vec()),
        other: outcome(vertex_map.scatter(&coarse, d)),
    })
}
