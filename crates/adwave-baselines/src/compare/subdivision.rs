//! Wavelets by lifting on levels of subdivision, or on levels of any mesh: compaction, and dependence on the place.
//!
//! On the sphere, `yeo2008` measured the same dependence on the place.

use super::shared::{largest_difference, reconstruct, row};
use super::{CompareError, Comparison, ComparisonInput, Outcome};
use adwave::Progress;
use adwave::bands::Bands;
use adwave::region::{Length, Location, Region};
use adwave::shape::{MeshArea, mesh_areas};
use adwave_subdivision::{BorderCorners, LiftedWavelets, SubdivisionError, WeldedMesh};
use std::time::Instant;

/// Number of values that each method may keep, as a share of all.
const SHARE: f64 = 0.1;

/// Number of places at which a bump is analyzed.
const N_PLACES: usize = 60;

/// Radius of a bump, in mean edge lengths.
const BUMP_EDGES: f64 = 10.0;

/// Number of bumps that are decomposed together, as the channels of one signal.
const BUMPS_AT_A_TIME: usize = 4;

pub(super) fn compare(
    input: &ComparisonInput<'_>,
    bands: &Bands,
    seconds: f64,
    progress: Progress<'_>,
) -> Result<Comparison, CompareError> {
    let Some(mesh) = input.shape.as_mesh() else { return Err(CompareError::NotMesh) };
    let start = Instant::now();
    let welded = WeldedMesh::new(mesh);
    let (points, d) = (welded.points(mesh), input.n_channels);
    let areas = mesh_areas(&points, &welded.triangles, MeshArea::Barycentric);
    let (wavelets, levels) = match welded.hierarchy(mesh, &[], BorderCorners::default(), progress) {
        Ok(hierarchy) => {
            let wavelets = LiftedWavelets::new(&hierarchy, hierarchy.usual_family(), &areas, progress)?;
            (wavelets, "levels of subdivision")
        }
        Err(error @ SubdivisionError::Cancelled(_)) => return Err(error.into()),
        Err(_) => {
            let wavelets = LiftedWavelets::new_irregular(&points, &welded.triangles, &areas, progress)?;
            (wavelets, "levels of removed vertices, since the mesh has none of subdivision")
        }
    };
    let prepared = start.elapsed().as_secs_f64();
    let field = welded.gather(input.signal, d)?;
    let start = Instant::now();
    let coefficients = wavelets.analyze(&field, d, progress)?;
    let analysis = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let back = wavelets.synthesize(&coefficients.values, d, progress)?;
    let synthesis = start.elapsed().as_secs_f64();
    let theirs = wavelets.synthesize(&coefficients.keep(SHARE)?.values, d, progress)?;
    let theirs = welded.scatter(&theirs, d);
    let masses = input.decomposer.areas();
    let ours = keep_bands(bands, &masses);
    let (reconstructed, our_synthesis) = reconstruct(bands);
    let error = |kept: &[f64]| relative_error(input.signal, kept, &masses);
    let bumps = Bumps::new(input, &welded, progress)?;
    let (our_spread, their_spread) = (bumps.spread_of_bands(input)?, bumps.spread_of_wavelets(&wavelets)?);
    let rows = vec![
        row("prepare, s", input.prepare_seconds, prepared),
        row("analysis, s", seconds, analysis),
        row("reconstruction, s", our_synthesis, synthesis),
        row(
            "largest error of the reconstruction",
            largest_difference(input.signal, &reconstructed),
            largest_difference(&field, &back),
        ),
        row("levels", bands.n_levels() as f64, wavelets.n_levels() as f64),
        row("coefficients per value", (bands.n_levels() + 1) as f64, 1.0),
        row(
            "error with a tenth as many coefficients as values, % of the deviation",
            error(&ours),
            error(&theirs),
        ),
        row(
            "share of a bump's energy on its strongest level: variation with its place, %",
            our_spread,
            their_spread,
        ),
    ];
    let outcome = |values| vec![Outcome { name: "kept".to_owned(), n_channels: d, values }];
    let task =
        format!("keep a tenth of the coefficients ({} family, {levels}); move a bump", wavelets.family());
    Ok(Comparison { task, rows, adwave: outcome(ours), other: outcome(theirs) })
}

/// Sums the largest coefficients of all bands, a tenth as many as there are vertices. The weight of a coefficient is
/// its magnitude times the root of its area.
fn keep_bands(bands: &Bands, masses: &[f64]) -> Vec<f64> {
    let (n, d, all) = (bands.n_vertices, bands.n_channels, bands.as_slice());
    let weight =
        |i: usize| masses[i % n].sqrt() * all[i * d..][..d].iter().map(|w| w * w).sum::<f64>().sqrt();
    let weights: Vec<f64> = (0..all.len() / d).map(weight).collect();
    let mut order: Vec<usize> = (0..weights.len()).collect();
    let n_kept = ((SHARE * n as f64).ceil() as usize).min(order.len());
    if n_kept < order.len() {
        order.select_nth_unstable_by(n_kept, |&a, &b| weights[b].total_cmp(&weights[a]).then(a.cmp(&b)));
    }
    let mut kept = order[..n_kept].to_vec();
    kept.sort_unstable();
    let mut sum = vec![0.0; n * d];
    for i in kept {
        let at = i % n * d;
        sum[at..at + d].iter_mut().zip(&all[i * d..]).for_each(|(s, w)| *s += w);
    }
    sum
}

/// Root mean square difference, weighted by area, in % of the standard deviation of the signal; 0 for a constant
/// signal.
fn relative_error(signal: &[f64], other: &[f64], masses: &[f64]) -> f64 {
    let d = signal.len() / masses.len();
    let total: f64 = masses.iter().sum();
    let (mut error, mut variance) = (0.0, 0.0);
    for c in 0..d {
        let rows = || masses.iter().enumerate().map(|(x, m)| (m, x * d + c));
        let mean = rows().map(|(m, i)| m * signal[i]).sum::<f64>() / total;
        error += rows().map(|(m, i)| m * (signal[i] - other[i]).powi(2)).sum::<f64>();
        variance += rows().map(|(m, i)| m * (signal[i] - mean).powi(2)).sum::<f64>();
    }
    if variance > 0.0 { 100.0 * (error / variance).sqrt() } else { 0.0 }
}

/// Bumps of one size at several places of a mesh.
struct Bumps<'a> {
    /// One column for each bump over the welded vertices, scaled to an energy of 1 by area.
    columns: Vec<Vec<f64>>,
    welded: &'a WeldedMesh,
    progress: Progress<'a>,
}

impl<'a> Bumps<'a> {
    /// Places bumps around vertices with evenly spread indices. A bump falls from 1 to 0 with the distance along the
    /// surface.
    fn new(
        input: &ComparisonInput<'_>,
        welded: &'a WeldedMesh,
        progress: Progress<'a>,
    ) -> Result<Self, CompareError> {
        let (decomposer, masses) = (input.decomposer, input.decomposer.areas());
        let radius = Length::Units(BUMP_EDGES * decomposer.mean_length());
        let n_places = N_PLACES.min(masses.len());
        let mut columns = Vec::with_capacity(n_places);
        for place in 0..n_places {
            let center = Location::Vertex((place * masses.len() / n_places) as u32);
            let ball = Region::Ball { center, radius, falloff: Some(radius) };
            let weights = ball.weights(decomposer.metric(), &|_| None, &[], progress)?;
            let mut bump = weights.to_vertices(decomposer.vertex_map());
            let energy: f64 = bump.iter().zip(&masses).map(|(b, m)| m * b * b).sum();
            if energy > 0.0 {
                for b in &mut bump {
                    *b /= energy.sqrt();
                }
            }
            columns.push(welded.gather(&bump, 1)?);
        }
        Ok(Self { columns, welded, progress })
    }

    /// Relative variation over the bumps of the energy on the strongest band, in %.
    fn spread_of_bands(&self, input: &ComparisonInput<'_>) -> Result<f64, CompareError> {
        let masses = input.decomposer.areas();
        let mut energies = Vec::new();
        for some in self.columns.chunks(BUMPS_AT_A_TIME) {
            let d = some.len();
            let interleaved = super::shared::interleave(some);
            let signal = self.welded.scatter(&interleaved, d);
            let request = input.decomposer.request(&signal, d, input.schedule).params(input.params);
            let bands = request.progress(self.progress.quiet()).bands()?;
            for c in 0..d {
                let energy = |band: &[f64]| -> f64 {
                    masses.iter().enumerate().map(|(x, m)| m * band[x * d + c].powi(2)).sum()
                };
                energies.push(bands.wavelets().map(energy).collect());
            }
        }
        Ok(spread(&energies))
    }

    /// Relative variation over the bumps of the energy of the details on the strongest level, in %.
    fn spread_of_wavelets(&self, wavelets: &LiftedWavelets) -> Result<f64, CompareError> {
        let mut energies = Vec::new();
        for column in &self.columns {
            let coefficients = wavelets.analyze(column, 1, self.progress.quiet())?;
            let mut by_level = vec![0.0; wavelets.n_levels()];
            for (i, &level) in coefficients.levels.iter().enumerate() {
                if let Some(energy) = by_level.get_mut(level as usize - 1) {
                    *energy += (coefficients.values[i] * coefficients.norms[i]).powi(2);
                }
            }
            energies.push(by_level);
        }
        Ok(spread(&energies))
    }
}

/// Standard deviation over the bumps divided by the mean, in %, on the level with the largest mean.
fn spread(energies: &[Vec<f64>]) -> f64 {
    let n = energies.len() as f64;
    let n_levels = energies.first().map_or(0, Vec::len);
    let mean = |level: usize| energies.iter().map(|by_level| by_level[level]).sum::<f64>() / n;
    let Some(strongest) = (0..n_levels).max_by(|&a, &b| mean(a).total_cmp(&mean(b))) else { return 0.0 };
    let mean = mean(strongest);
    let variance = energies.iter().map(|by_level| (by_level[strongest] - mean).powi(2)).sum::<f64>() / n;
    if mean > 0.0 { 100.0 * variance.sqrt() / mean } else { 0.0 }
}
