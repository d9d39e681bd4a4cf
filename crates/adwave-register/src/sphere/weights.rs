//! Weights between the vertices of two spheres.
//!
//! The rule is that of Connectome Workbench's `ADAP_BARY_AREA`, by its documentation and its results: barycentric
//! weights both ways, of which each target takes those that use all data, with areas as correction.

use super::locate::{PlaceOnSphere, SphereCells};
use super::{Sphere, SphereError};
use adwave::Progress;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use rayon::prelude::*;

/// Directions that a thread locates between checks for cancellation.
const DIRECTIONS_AT_A_TIME: usize = 1 << 12;

/// Sparse weights, a row for each target vertex with the source vertices ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct SphereWeights {
    pub(super) starts: Vec<u32>,
    pub(super) sources: Vec<u32>,
    /// Weights of a mean; each row sums to 1.
    pub(super) means: Vec<f64>,
    /// Share of the amount at the source that the target gets; each column sums to 1.
    pub(super) shares: Vec<f64>,
}

impl SphereWeights {
    /// Computes the weights; targets that are not `kept` have none.
    pub(super) fn new(
        from: &Sphere,
        to: &Sphere,
        kept: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Self, SphereError> {
        let is_kept = |t: usize| kept.is_none_or(|kept| kept[t]);
        let gathered = locate_all(from, &to.directions, progress)?;
        let scattered = locate_all(to, &from.directions, progress)?;
        let spread = transpose(&scattered, to.n_vertices(), is_kept);
        let rows: Vec<Vec<(u32, f64)>> = (0..to.n_vertices())
            .into_par_iter()
            .map(|t| {
                let row = if is_kept(t) { choose_row(&gathered[t], spread.row(t)) } else { Vec::new() };
                row.into_iter().map(|(s, weight)| (s, weight * to.areas[t])).collect()
            })
            .collect();
        progress.check()?;
        let mut totals = vec![0.0; from.n_vertices()];
        rows.iter().flatten().for_each(|&(s, weight)| totals[s as usize] += weight);
        let amounts = left_out(&totals, &scattered, to, is_kept);
        Ok(Self::assemble(&rows, &totals, from, &amounts))
    }

    /// Joins the rows of means with the shares of the sources that these leave out.
    fn assemble(
        rows: &[Vec<(u32, f64)>],
        totals: &[f64],
        from: &Sphere,
        amounts: &[(u32, u32, f64)],
    ) -> Self {
        let mut weights = Self { starts: vec![0], ..Self::default() };
        let mut rest = amounts;
        for (t, row) in rows.iter().enumerate() {
            let n = rest.iter().take_while(|(target, ..)| *target as usize == t).count();
            let (own, after) = rest.split_at(n);
            rest = after;
            // In units of the area of the source, a weight of the mean times its share.
            let corrected = |&(s, weight): &(u32, f64)| weight / totals[s as usize] * from.areas[s as usize];
            let total: f64 = row.iter().map(corrected).sum();
            let mut entries: Vec<(u32, f64, f64)> = row
                .iter()
                .map(|entry| (entry.0, corrected(entry) / total, entry.1 / totals[entry.0 as usize]))
                .chain(own.iter().map(|&(_, s, share)| (s, 0.0, share)))
                .collect();
            entries.sort_unstable_by_key(|entry| entry.0);
            for (s, mean, share) in entries {
                weights.sources.push(s);
                weights.means.push(mean);
                weights.shares.push(share);
            }
            weights.starts.push(weights.sources.len() as u32);
        }
        weights
    }
}

/// Places of all directions on a sphere.
fn locate_all(
    sphere: &Sphere,
    directions: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<PlaceOnSphere>, SphereError> {
    let cells = SphereCells::new(sphere)?;
    let mut places = vec![PlaceOnSphere::default(); directions.len()];
    let chunks = places.par_chunks_mut(DIRECTIONS_AT_A_TIME).zip(directions.par_chunks(DIRECTIONS_AT_A_TIME));
    chunks
        .try_for_each(|(places, directions)| {
            progress.check()?;
            for (place, direction) in places.iter_mut().zip(directions) {
                *place = cells.locate(direction).ok_or(SphereError::Overlap)?;
            }
            Ok(())
        })
        .map(|()| places)
}

/// Rows of weights.
struct Rows {
    starts: Vec<u32>,
    entries: Vec<(u32, f64)>,
}

impl Rows {
    fn row(&self, t: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[t] as usize..self.starts[t + 1] as usize]
    }
}

/// Sources that have each target as a corner, ascending, with their weights there.
fn transpose(scattered: &[PlaceOnSphere], n_targets: usize, is_kept: impl Fn(usize) -> bool) -> Rows {
    let mut starts = vec![0_u32; n_targets + 1];
    for (t, _) in scattered.iter().flat_map(PlaceOnSphere::entries) {
        starts[t as usize + 1] += u32::from(is_kept(t as usize));
    }
    for t in 0..n_targets {
        starts[t + 1] += starts[t];
    }
    let (mut next, mut entries) = (starts.clone(), vec![(0, 0.0); starts[n_targets] as usize]);
    for (s, place) in scattered.iter().enumerate() {
        for (t, weight) in place.entries().filter(|(t, _)| is_kept(*t as usize)) {
            entries[next[t as usize] as usize] = (s as u32, weight);
            next[t as usize] += 1;
        }
    }
    Rows { starts, entries }
}

/// Weights of a target: those of the sources around it if one of these is no corner of the triangle that it is in, so
/// that all sources count, else those of the corners.
fn choose_row(gathered: &PlaceOnSphere, spread: &[(u32, f64)]) -> Vec<(u32, f64)> {
    let is_corner = |s: u32| gathered.entries().any(|(corner, _)| corner == s);
    if spread.iter().all(|(s, _)| is_corner(*s)) { gathered.entries().collect() } else { spread.to_vec() }
}

/// Shares (target, source, share) of sources that no mean uses, in the order of the targets: at the corners around the
/// source, or at the nearest kept target.
fn left_out(
    totals: &[f64],
    scattered: &[PlaceOnSphere],
    to: &Sphere,
    is_kept: impl Fn(usize) -> bool,
) -> Vec<(u32, u32, f64)> {
    let unused: Vec<usize> = (0..totals.len()).filter(|&s| totals[s] == 0.0).collect();
    let mut amounts = Vec::new();
    let mut far = Vec::new();
    for s in unused {
        let place: Vec<(u32, f64)> = scattered[s].entries().filter(|(t, _)| is_kept(*t as usize)).collect();
        let total: f64 = place.iter().map(|(_, weight)| weight).sum();
        if place.is_empty() {
            far.push(s);
        }
        amounts.extend(place.into_iter().map(|(t, weight)| (t, s as u32, weight / total)));
    }
    if !far.is_empty() {
        let kept: Vec<u32> = (0..to.n_vertices()).filter(|&t| is_kept(t)).map(|t| t as u32).collect();
        amounts.extend(nearest_targets(&far, scattered, to, &kept));
    }
    amounts.sort_unstable_by_key(|&(t, s, _)| (t, s));
    amounts
}

/// The whole amount of each source at the nearest of the kept targets.
fn nearest_targets(
    sources: &[usize],
    scattered: &[PlaceOnSphere],
    to: &Sphere,
    kept: &[u32],
) -> Vec<(u32, u32, f64)> {
    let points: Vec<[f64; 3]> = kept.iter().map(|&t| to.directions[t as usize]).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&points) else { return Vec::new() };
    let nearest = |&s: &usize| {
        let mut at = [0.0; 3];
        for (t, weight) in scattered[s].entries() {
            at.iter_mut().zip(to.directions[t as usize]).for_each(|(at, c)| *at += weight * c);
        }
        let found = tree.query(&at).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize;
        (kept[found], s as u32, 1.0)
    };
    sources.iter().map(nearest).collect()
}
