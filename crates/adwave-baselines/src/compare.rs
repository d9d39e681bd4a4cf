//! The same task by adwave and by another method, with differences and times side by side.

use crate::differential::Differential;
use crate::feature_map::{FeatureMapError, feature_map};
use crate::harmonics::{Harmonics, HarmonicsError, Remainder};
use crate::laplacian::{Laplacian, LaplacianParams};
use crate::lee::{LeeError, lee_saliency};
use crate::linalg::{EigenParams, LinalgError, SymmetricMatrix};
use crate::multiscale::{
    BiorthogonalDiffusionWavelets, Coefficients, DiffusionWavelets, MultiscaleError, MultiscaleParams,
    locality,
};
use crate::sgwt::{Frame, KernelFamily, Kernels, SgwtError};
use crate::taubin::{TaubinError, WindowedSinc};
use adwave::bands::{Bands, BandsError, BandsParams, Schedule, Wavelets};
use adwave::features::{FeatureError, FeatureParams, features};
use adwave::saliency::{SaliencyError, SaliencyParams, saliency};
use adwave::shape::Shape;
use adwave::{Decomposer, Progress};
use std::time::Instant;
use thiserror::Error;

/// What adwave is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Smoothing: manifold harmonics with the gain `e^(−λσ²/4)` of the same heat.
    Harmonics,
    /// A saliency map: Lee, Varshney & Jacobs.
    Lee,
    /// Features of a signal of one channel: critical points at the same heats.
    FeatureMap,
    /// Bands and back: spectral graph wavelets of the same walk, as many kernels as levels.
    Sgwt,
    /// Bands and back: diffusion wavelets of the same walk.
    DiffusionWavelets,
    /// Bands and back: biorthogonal diffusion wavelets of the same walk.
    Biorthogonal,
    /// Smoothing: the windowed sinc on the same walk, half gain at the same frequency.
    Taubin,
}

/// Why a comparison cannot be made.
#[derive(Debug, Error)]
#[allow(missing_docs)] // each is the error of the module it names
pub enum CompareError {
    #[error(transparent)]
    Bands(#[from] BandsError),
    #[error(transparent)]
    Harmonics(#[from] HarmonicsError),
    #[error(transparent)]
    Lee(#[from] LeeError),
    #[error(transparent)]
    FeatureMap(#[from] FeatureMapError),
    #[error(transparent)]
    Sgwt(#[from] SgwtError),
    #[error(transparent)]
    Multiscale(#[from] MultiscaleError),
    #[error(transparent)]
    Taubin(#[from] TaubinError),
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    #[error(transparent)]
    Saliency(#[from] SaliencyError),
    #[error(transparent)]
    Features(#[from] FeatureError),
    /// The task takes a signal of one channel.
    #[error("critical points need a signal of one channel; this one has {0}")]
    Channels(usize),
}

/// One measured quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What is measured, with its unit.
    pub quantity: String,
    /// By adwave, where it has a meaning.
    pub adwave: Option<f64>,
    /// By the other method.
    pub other: Option<f64>,
}

/// A result on the vertices of the shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// What it is.
    pub name: String,
    /// Values a vertex.
    pub n_channels: usize,
    /// n_vertices × n_channels.
    pub values: Vec<f64>,
}

/// Both results and what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What both did.
    pub task: String,
    /// The measurements.
    pub rows: Vec<Row>,
    /// Results of adwave.
    pub adwave: Vec<Outcome>,
    /// Results of the other method, in the same order.
    pub other: Vec<Outcome>,
}

/// What is compared on.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Its walk.
    pub walk: &'a Decomposer,
    /// The levels of adwave.
    pub schedule: &'a Schedule,
    /// How its bands are computed.
    pub params: &'a BandsParams,
    /// n_vertices × n_channels.
    pub signal: &'a [f64],
    /// Channels of the signal.
    pub n_channels: usize,
    /// Harmonics of the first comparison.
    pub n_harmonics: usize,
}

/// Does the task of `method` both ways.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    subject: &Subject<'_>,
    method: Method,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let bands = subject
        .walk
        .request(subject.signal, subject.n_channels, subject.schedule)
        .params(subject.params)
        .progress(progress)
        .bands()?;
    let seconds = start.elapsed().as_secs_f64();
    match method {
        Method::Harmonics => harmonics(subject, &bands, seconds, progress),
        Method::Taubin => taubin(subject, &bands, seconds),
        Method::Lee => lee(subject, &bands, seconds, progress),
        Method::FeatureMap => critical(subject, &bands, seconds, progress),
        Method::Sgwt => sgwt(subject, &bands, seconds, progress),
        Method::DiffusionWavelets | Method::Biorthogonal => {
            multiscale(subject, &bands, seconds, method, progress)
        }
    }
}

fn row(quantity: &str, adwave: impl Into<Option<f64>>, other: impl Into<Option<f64>>) -> Row {
    Row { quantity: quantity.to_owned(), adwave: adwave.into(), other: other.into() }
}

fn rms(a: &[f64], b: &[f64], n_channels: usize) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / (a.len() / n_channels.max(1)).max(1) as f64).sqrt()
}

fn most(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Both smoothed signals, against the signal and against each other.
fn smoothing(
    subject: &Subject<'_>,
    task: String,
    ours: &[f64],
    theirs: Vec<f64>,
    mut rows: Vec<Row>,
) -> Comparison {
    let (f, d) = (subject.signal, subject.n_channels);
    rows.push(row("rms change of the signal", rms(f, ours, d), rms(f, &theirs, d)));
    rows.push(row("largest change of the signal", most(f, ours), most(f, &theirs)));
    rows.push(row("rms difference of the two", None, rms(ours, &theirs, d)));
    let outcome = |values: Vec<f64>| vec![Outcome { name: "smoothed".to_owned(), n_channels: d, values }];
    Comparison { task, rows, adwave: outcome(ours.to_vec()), other: outcome(theirs) }
}

fn harmonics(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let laplacian = Laplacian::new(subject.shape, &LaplacianParams::default())?;
    let harmonics = Harmonics::new(&laplacian, subject.n_harmonics, &EigenParams::default(), progress)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let sigma = bands.sigma[bands.n_levels()];
    // The mean square distance after the time t is 4t in a plane.
    let gain = |frequency: f64| (-(frequency * sigma).powi(2) / 4.0).exp();
    let theirs = harmonics.filter(subject.signal, subject.n_channels, gain, Remainder::Drop)?;
    let filtered = start.elapsed().as_secs_f64();
    let last = harmonics.values.last().copied().unwrap_or(0.0).max(0.0).sqrt();
    let rows = vec![
        row("prepare, s", None, prepared),
        row("smooth, s", seconds, filtered),
        row("harmonics", None, harmonics.len() as f64),
        row("gain left out above the last harmonic", None, gain(last)),
    ];
    let task = format!("smooth by the heat of width {sigma:.4} (model units)");
    Ok(smoothing(subject, task, bands.coarsest(), theirs, rows))
}

fn taubin(subject: &Subject<'_>, bands: &Bands, seconds: f64) -> Result<Comparison, CompareError> {
    let steps = bands.steps[bands.n_levels()];
    // (1 − k/2)^n = ½, which is inside (0, 2).
    let pass_band = (2.0 * (1.0 - (-1.0 / steps).exp2())).clamp(1e-6, 1.9);
    let degree = (8.0 / (1.0 - pass_band / 2.0).acos()).ceil().clamp(10.0, 2000.0) as usize;
    let start = Instant::now();
    let k = Differential::from_walk(subject.walk.diffusion(), subject.walk.geometry().vertex_map().clone());
    let filter = WindowedSinc::new(pass_band, degree)?;
    let prepared = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let theirs = filter.apply(&k, subject.signal, subject.n_channels)?;
    let filtered = start.elapsed().as_secs_f64();
    let rows = vec![
        row("prepare, s", None, prepared),
        row("smooth, s", seconds, filtered),
        row("products with the walk", bands.info.products as f64, degree as f64),
        row("gain at half the pass band", (1.0 - pass_band / 4.0).powf(steps), filter.gain(pass_band / 2.0)),
        row(
            "gain at twice the pass band",
            (1.0 - pass_band.min(1.0)).powf(steps),
            filter.gain((2.0 * pass_band).min(2.0)),
        ),
    ];
    let task = format!("smooth with half the gain at the frequency {pass_band:.4} of the walk");
    Ok(smoothing(subject, task, bands.coarsest(), theirs, rows))
}

fn lee(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let start = Instant::now();
    let ours = saliency(subject.walk, &norms(subject, bands), &SaliencyParams::default(), progress)?.map;
    let mapped = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let theirs = lee_saliency(subject.shape, progress)?;
    let their_seconds = start.elapsed().as_secs_f64();
    let narrowest = theirs.sigma[0];
    let rows = vec![
        row("map, s", seconds + mapped, their_seconds),
        row("narrowest width, model units", bands.sigma.get(3).copied(), narrowest),
        row("widest width, model units", bands.sigma[bands.n_levels()], 2.0 * theirs.sigma[4]),
        row("rank correlation of the two", None, rank_correlation(&ours, &theirs.saliency)),
        row("shared part of the top 5 %", None, shared_top(&ours, &theirs.saliency, 0.05)),
    ];
    let outcome = |values| vec![Outcome { name: "saliency".to_owned(), n_channels: 1, values }];
    Ok(Comparison {
        task: "map what stands out".to_owned(),
        rows,
        adwave: outcome(ours),
        other: outcome(theirs.saliency),
    })
}

fn order(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    order
}

/// Spearman's ρ; ties share their mean rank. 0 where either map is constant.
fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let ranks = |values: &[f64]| {
        let order = order(values);
        let mut ranks = vec![0.0; values.len()];
        let mut start = 0;
        for group in order.chunk_by(|&x, &y| values[x] == values[y]) {
            for &x in group {
                ranks[x] = start as f64 + 0.5 * (group.len() - 1) as f64;
            }
            start += group.len();
        }
        ranks
    };
    let (a, b) = (ranks(a), ranks(b));
    let mean = (a.len() as f64 - 1.0) / 2.0;
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| (x - mean) * (y - mean)).sum::<f64>();
    let size = (product(&a, &a) * product(&b, &b)).sqrt();
    if size > 0.0 { product(&a, &b) / size } else { 0.0 }
}

/// Which part of the highest `part` of both maps is the same.
fn shared_top(a: &[f64], b: &[f64], part: f64) -> f64 {
    let count = ((a.len() as f64 * part).ceil() as usize).min(a.len());
    let top = |values: &[f64]| {
        let mut is_top = vec![false; values.len()];
        for &x in order(values).iter().rev().take(count) {
            is_top[x] = true;
        }
        is_top
    };
    let both = top(a).iter().zip(top(b)).filter(|&(&a, b)| a && b).count();
    both as f64 / count.max(1) as f64
}

fn critical(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    if subject.n_channels != 1 {
        return Err(CompareError::Channels(subject.n_channels));
    }
    let start = Instant::now();
    let ours = features(subject.walk, &norms(subject, bands), &FeatureParams::default(), progress)?;
    let found = start.elapsed().as_secs_f64();
    let times: Vec<f64> = bands.sigma[2..bands.n_levels()].iter().map(|s| s * s / 4.0).collect();
    let start = Instant::now();
    let theirs = feature_map(subject.shape, subject.signal, &times, progress)?;
    let their_seconds = start.elapsed().as_secs_f64();
    let n = subject.shape.n_vertices();
    let (mut our_field, mut their_field) = (vec![0.0; n], vec![0.0; n]);
    let mut rows = vec![row("find, s", seconds + found, their_seconds)];
    for f in &ours {
        our_field[f.vertex] = f.level as f64;
    }
    for (k, level) in theirs.iter().enumerate() {
        let j = k + 2;
        for p in &level.points {
            their_field[p.vertex] = j as f64;
        }
        let count = ours.iter().filter(|f| f.level == j).count();
        rows.push(row(&format!("features at level {j}"), count as f64, level.points.len() as f64));
        rows.push(row(&format!("sum of indices at level {j}"), None, level.index_sum as f64));
    }
    let outcome = |values| vec![Outcome { name: "feature_level".to_owned(), n_channels: 1, values }];
    let task = "find features at the widths of the levels".to_owned();
    Ok(Comparison { task, rows, adwave: outcome(our_field), other: outcome(their_field) })
}

/// `S_f(J) + Σ W_f(j)`, and how long it takes.
fn put_together(bands: &Bands) -> (Vec<f64>, f64) {
    let start = Instant::now();
    let sum = bands.reconstruct();
    (sum, start.elapsed().as_secs_f64())
}

/// The norms of the wavelets, for saliency and features.
fn norms(subject: &Subject<'_>, bands: &Bands) -> Wavelets {
    bands.to_wavelets(subject.walk.geometry().vertex_map()).into_norms()
}

fn channel(f: &[f64], n_channels: usize, c: usize) -> Vec<f64> {
    f.iter().skip(c).step_by(n_channels).copied().collect()
}

fn interleave(channels: &[Vec<f64>]) -> Vec<f64> {
    let n = channels.first().map_or(0, Vec::len);
    (0..n).flat_map(|x| channels.iter().map(move |c| c[x])).collect()
}

fn wavelets(bands: &Bands) -> Vec<Outcome> {
    let outcome = |(k, values): (usize, &[f64])| Outcome {
        name: format!("W{}", k + 1),
        n_channels: bands.n_channels,
        values: values.to_vec(),
    };
    bands.wavelets().enumerate().map(outcome).collect()
}

fn sgwt(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    const ACCURACY: f64 = 1e-6;
    const SOLVED: f64 = 1e-10;
    let start = Instant::now();
    let walk = subject.walk.diffusion();
    let vertex_map = subject.walk.geometry().vertex_map();
    let (laplacian, root) = normalised_laplacian(subject)?;
    // I − Q has its spectrum in [0, 2].
    let kernels = Kernels::new(KernelFamily::Meyer, (bands.n_levels() + 1).max(3), 2.0)?;
    let frame = Frame::new(&laplacian, kernels, ACCURACY)?;
    let prepared = start.elapsed().as_secs_f64();
    let d = subject.n_channels;
    let mean = vertex_map.mean(subject.signal, d);
    let (mut analysis, mut synthesis, mut iterations) = (0.0, 0.0, 0);
    let n_kernels = frame.polynomials.len();
    let (mut back, mut parts) = (Vec::new(), vec![Vec::new(); n_kernels]);
    for c in 0..d {
        let f: Vec<f64> = channel(&mean, d, c).iter().zip(&root).map(|(f, r)| f * r).collect();
        let start = Instant::now();
        let coefficients = frame.analyse(&f, progress)?;
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
    let (ours, our_synthesis) = put_together(bands);
    let degree = frame.polynomials.iter().map(|p| p.coefficients.len() - 1).max().unwrap_or(0);
    let rows = vec![
        row("prepare, s", None, prepared),
        row("bands, s", seconds, analysis),
        row("put together, s", our_synthesis, synthesis),
        row("largest error of the reconstruction", most(subject.signal, &ours), most(&mean, &theirs)),
        row("bands, the low pass among them", (bands.n_levels() + 1) as f64, n_kernels as f64),
        row("products with the walk", bands.info.products as f64, degree as f64),
        row("iterations to put together", 0.0, iterations as f64),
        row("lower frame bound", None, frame.bounds.0),
        row("upper frame bound", None, frame.bounds.1),
    ];
    debug_assert_eq!(root.len(), walk.n_vertices());
    // Fine to coarse, as adwave has them.
    let other = parts.iter().skip(1).rev().enumerate().map(|(k, part)| Outcome {
        name: format!("W{}", k + 1),
        n_channels: d,
        values: vertex_map.scatter(&interleave(part), d),
    });
    let task = "split into bands and put together".to_owned();
    Ok(Comparison { task, rows, adwave: wavelets(bands), other: other.collect() })
}

/// `Π^½ (I − Q) Π^(−½)`, and `√π`.
fn normalised_laplacian(subject: &Subject<'_>) -> Result<(SymmetricMatrix, Vec<f64>), CompareError> {
    let walk = subject.walk.diffusion();
    if !walk.is_reversible() {
        return Err(MultiscaleError::NotReversible.into());
    }
    let n = walk.n_vertices();
    let root: Vec<f64> = walk.stationary().iter().map(|p| (p.max(1e-30) * n as f64).sqrt()).collect();
    let mut entries = Vec::new();
    for x in 0..n {
        let (columns, weights) = walk.row(x);
        entries.push((x as u32, x as u32, 2.0 * weights.iter().sum::<f64>()));
        let above = columns.iter().zip(weights).filter(|e| *e.0 as usize > x);
        entries.extend(above.map(|(&y, &w)| (x as u32, y, -2.0 * root[x] * w / root[y as usize])));
    }
    Ok((SymmetricMatrix::from_halves(n, &entries)?, root))
}

/// What both kinds of diffusion wavelets have.
enum Basis {
    Orthogonal(DiffusionWavelets),
    Biorthogonal(BiorthogonalDiffusionWavelets),
}

impl Basis {
    fn analyse(&self, f: &[f64]) -> Result<Coefficients, MultiscaleError> {
        match self {
            Self::Orthogonal(basis) => basis.analyse(f),
            Self::Biorthogonal(basis) => basis.analyse(f),
        }
    }

    fn synthesise(&self, c: &Coefficients) -> Result<Vec<f64>, MultiscaleError> {
        match self {
            Self::Orthogonal(basis) => basis.synthesise(c),
            Self::Biorthogonal(basis) => basis.synthesise(c),
        }
    }
}

fn multiscale(
    subject: &Subject<'_>,
    bands: &Bands,
    seconds: f64,
    method: Method,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let (walk, vertex_map, d) =
        (subject.walk.diffusion(), subject.walk.geometry().vertex_map(), subject.n_channels);
    let params = MultiscaleParams::default().with_levels(bands.n_levels());
    let start = Instant::now();
    let (basis, ranks, defect, functions) = if method == Method::DiffusionWavelets {
        let basis = DiffusionWavelets::new(walk, &params, progress)?;
        let last = basis.n_levels();
        let functions = basis.scaling_functions(last);
        (Basis::Orthogonal(basis.clone()), basis.ranks(), basis.orthogonality_defect(last), functions)
    } else {
        let basis = BiorthogonalDiffusionWavelets::new(walk, &params, progress)?;
        let last = basis.n_levels();
        let (defect, functions) = if last > 0 {
            (basis.biorthogonality_defect(last), basis.scaling_functions(last))
        } else {
            (0.0, Vec::new())
        };
        (Basis::Biorthogonal(basis.clone()), basis.ranks(), defect, functions)
    };
    let prepared = start.elapsed().as_secs_f64();
    let mean = vertex_map.mean(subject.signal, d);
    let start = Instant::now();
    let coefficients: Vec<Coefficients> =
        (0..d).map(|c| basis.analyse(&channel(&mean, d, c))).collect::<Result<_, _>>()?;
    let analysis = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let back: Vec<Vec<f64>> = coefficients.iter().map(|c| basis.synthesise(c)).collect::<Result<_, _>>()?;
    let synthesis = start.elapsed().as_secs_f64();
    // What the scaling functions of the last level alone give: the coarse shape.
    let coarse = coefficients.iter().map(|c| {
        let mut c = c.clone();
        c.wavelets.iter_mut().flatten().for_each(|w| *w = 0.0);
        basis.synthesise(&c)
    });
    let coarse = interleave(&coarse.collect::<Result<Vec<_>, _>>()?);
    let (ours, our_synthesis) = put_together(bands);
    let support =
        |f: &[Vec<f64>]| f.iter().map(|f| locality(f).support as f64).sum::<f64>() / f.len().max(1) as f64;
    let mut rows = vec![
        row("prepare, s", None, prepared),
        row("bands, s", seconds, analysis),
        row("put together, s", our_synthesis, synthesis),
        row(
            "largest error of the reconstruction",
            most(subject.signal, &ours),
            most(&mean, &interleave(&back)),
        ),
        row("defect of (bi)orthogonality", None, defect),
        row("mean support of a scaling function of the last level, vertices", None, support(&functions)),
    ];
    for (j, rank) in ranks.iter().enumerate() {
        rows.push(row(&format!("scaling coefficients at level {j}"), walk.n_vertices() as f64, *rank as f64));
    }
    let outcome = |values| vec![Outcome { name: "coarse".to_owned(), n_channels: d, values }];
    Ok(Comparison {
        task: "split into bands and put together".to_owned(),
        rows,
        adwave: outcome(bands.coarsest().to_vec()),
        other: outcome(vertex_map.scatter(&coarse, d)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    use adwave::sample::Sample;
    use adwave::shape::Mesh;

    #[test]
    fn every_method_does_its_task_and_smoothing_agrees() {
        let sample = Sample::by_name("torus", Some(700)).unwrap();
        let points = sample.points.clone();
        let shape = Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap());
        let walk = Decomposer::new(&shape);
        let schedule = Schedule::dyadic(6).unwrap();
        let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
        let with = |method, signal: &[f64], n_channels| {
            let params = BandsParams::default();
            let subject = Subject {
                shape: &shape,
                walk: &walk,
                schedule: &schedule,
                params: &params,
                signal,
                n_channels,
                n_harmonics: 300,
            };
            compare(&subject, method, Progress::none()).unwrap()
        };
        let value = |c: &Comparison, q: &str| {
            c.rows.iter().find(|r| r.quantity.starts_with(q)).unwrap().other.unwrap()
        };
        let coords = points.as_flattened();
        let mht = with(Method::Harmonics, coords, 3);
        let (moved, apart) = (value(&mht, "rms change"), value(&mht, "rms difference"));
        assert!(apart < 0.2 * moved, "the same heat by both: {moved} {apart}");
        for method in [Method::Sgwt, Method::DiffusionWavelets, Method::Biorthogonal] {
            assert!(value(&with(method, coords, 3), "largest error") < 1e-6, "{method:?}");
        }
        for method in [Method::Taubin, Method::Lee] {
            assert!(with(method, coords, 3).other[0].values.iter().all(|v| v.is_finite()), "{method:?}");
        }
        let critical = with(Method::FeatureMap, &heights, 1);
        assert_eq!(value(&critical, "sum of indices"), 0.0, "a torus");
    }

    #[test]
    fn ranks_correlate_as_they_should() {
        assert_eq!(rank_correlation(&[1.0, 2.0, 9.0], &[2.0, 3.0, 4.0]), 1.0);
        assert_eq!(rank_correlation(&[1.0, 2.0, 9.0], &[3.0, 2.0, 1.0]), -1.0);
        assert_eq!(rank_correlation(&[1.0, 1.0], &[3.0, 2.0]), 0.0);
        assert_eq!(shared_top(&[1.0, 2.0, 3.0, 4.0], &[4.0, 1.0, 2.0, 3.0], 0.5), 0.5);
    }
}
