//! Evaluation of a filter: `f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)` (eq. 18).
//!
//! Since `f = S_f(J) + Σ_j W_f(j)`, this equals `S_f(J) + Σ_j Γ(j,x)·W_f(j)`. In this form it is exact where
//! nothing is edited: a vertex outside all regions keeps its value to the last bit.

use super::FilterError;
use super::layers::{LayerSlot, WeightedLayer, gain_excess};
use crate::bands::{Wavelets, check_buffer};
use crate::pages::zeros;
use crate::parallel;
use crate::shape::VertexMap;

/// Number of vertices that a thread processes at a time; their rows of one band fit into the first-level cache.
const VERTICES_AT_A_TIME: usize = 1 << 10;

/// Bands of a signal in the order of the shape.
#[derive(Clone, Copy, Debug)]
pub struct BandsView<'a> {
    /// W_f(1) … W_f(J), one after another, each n_vertices × n_channels, as in [`Bands`](crate::bands::Bands); the
    /// rest of the slice is ignored.
    pub coefficients: &'a [f64],
    /// Number of levels J.
    pub n_levels: usize,
    /// Number of channels of the signal.
    pub n_channels: usize,
}

/// Vertices of the shape that were welded: those of the welded vertex x are
/// `members[first_member[x]..first_member[x + 1]]`.
#[derive(Clone, Copy)]
pub(crate) struct WeldedMembers<'a> {
    pub(crate) first_member: &'a [usize],
    pub(crate) members: &'a [u32],
}

/// Filters with precomputed bands: `out = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)` (eq. 18), with the same bits as
/// [`Editor`](crate::Editor), all in the order of the shape.
///
/// Each band whose gain is not 1 is read once. O(n·J·d).
///
/// ```
/// use adwave::{Decomposer, bands::Schedule, filter::{WeightedLayer, BandsView, filter_bands},
///     shape::{Graph, Shape}};
/// let path = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)])?);
/// let (decomposer, f) = (Decomposer::new(&path), [0.0, 4.0, 0.0]);
/// let bands = decomposer.request(&f, 1, &Schedule::dyadic(1)?).bands()?.into_vec();
/// let (map, mut out) = (decomposer.vertex_map(), [0.0; 3]);
/// let bands = BandsView { coefficients: &bands, n_levels: 1, n_channels: 1 };
/// filter_bands(&f, bands, &[WeightedLayer::everywhere(vec![0.0])], map, &mut out)?;
/// assert_eq!(out, [2.0, 2.0, 2.0]); // W_1 = (−2, 2, −2) taken away
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FilterError`] if gains, regions or sizes do not match.
///
/// # Panics
/// If vertices are welded; the members of a welded vertex share all bands but the finest.
pub fn filter_bands(
    signal: &[f64],
    bands: BandsView<'_>,
    layers: &[WeightedLayer],
    vertex_map: &VertexMap,
    out: &mut [f64],
) -> Result<(), FilterError> {
    let BandsView { coefficients: bands, n_levels, n_channels } = bands;
    let len = vertex_map.n_vertices() * n_channels;
    assert_eq!(vertex_map.n_welded(), vertex_map.n_vertices(), "no vertices are welded");
    for (k, layer) in layers.iter().enumerate() {
        layer.check(k + 1, n_levels, vertex_map)?;
    }
    check_buffer(signal.len(), len)?;
    check_buffer(out.len(), len)?;
    check_buffer(bands.len().min(n_levels * len), n_levels * len)?;
    let slots: Vec<_> = layers.iter().map(|layer| LayerSlot::to_shape_order(layer, vertex_map)).collect();
    let levels: Vec<&[f64]> = bands.chunks_exact(len.max(1)).take(n_levels).collect();
    match n_channels {
        1 => filter_rows::<1>(signal, &levels, 1, &slots, out),
        3 => filter_rows::<3>(signal, &levels, 3, &slots, out),
        d => filter_rows::<0>(signal, &levels, d, &slots, out),
    }
    Ok(())
}

/// [`filter_bands`] for D channels, or for `d` channels if D is 0.
fn filter_rows<const D: usize>(
    signal: &[f64],
    levels: &[&[f64]],
    d: usize,
    layers: &[LayerSlot],
    out: &mut [f64],
) {
    let d = if D == 0 { d } else { D };
    let mut same = vec![0.0; levels.len()];
    let is_same = layers.iter().all(LayerSlot::is_everywhere);
    if is_same {
        gain_excess(layers, 0, 0, &mut same);
    }
    parallel::visit_rows(out, d, VERTICES_AT_A_TIME, |first, rows| {
        let signal = &signal[first * d..][..rows.len()];
        if is_same {
            let edited = same.iter().zip(levels).filter(|(e, _)| **e != 0.0);
            let edited: Vec<(f64, &[f64])> =
                edited.map(|(e, level)| (*e, &level[first * d..][..rows.len()])).collect();
            sum_levels(&edited, rows);
        } else {
            let mut excess = vec![0.0; levels.len()];
            for (x, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                gain_excess(layers, x, x, &mut excess);
                row.fill(0.0);
                for (e, level) in excess.iter().zip(levels).filter(|(e, _)| **e != 0.0) {
                    for (sum, w) in row.iter_mut().zip(&level[x * d..][..d]) {
                        *sum += e * w;
                    }
                }
            }
        }
        for (value, f) in rows.iter_mut().zip(signal) {
            *value = if *value == 0.0 { *f } else { f + *value }; // −0 stays −0
        }
    });
}

/// Computes `Σ_k factor_k·level_k`, adding four levels per pass over the sum, one after another.
fn sum_levels(levels: &[(f64, &[f64])], sum: &mut [f64]) {
    sum.fill(0.0);
    let (fours, others) = levels.as_chunks::<4>();
    for &[(a, v), (b, w), (c, x), (e, y)] in fours {
        for ((((sum, v), w), x), y) in sum.iter_mut().zip(v).zip(w).zip(x).zip(y) {
            *sum = *sum + a * v + b * w + c * x + e * y;
        }
    }
    for (factor, level) in others {
        for (sum, w) in sum.iter_mut().zip(*level) {
            *sum += factor * w;
        }
    }
}

/// Input of a filter: a signal, its wavelets, and their relation.
#[derive(Clone, Copy)]
pub(crate) struct FilterInput<'a> {
    /// Signal, n_vertices × n_channels, in the order of the shape.
    pub(crate) signal: &'a [f64],
    /// Wavelets in the analysis order.
    pub(crate) wavelets: &'a Wavelets,
    /// Mean of the signal at each welded vertex; the difference from it is part of W_f(1).
    pub(crate) mean: &'a [f64],
    pub(crate) vertex_map: &'a VertexMap,
    /// Flags of the vertices that keep their values.
    pub(crate) masked: Option<&'a [bool]>,
}

impl<'a> FilterInput<'a> {
    /// Number of channels: D, so that loops are unrolled, or the actual number if D is 0.
    #[inline]
    fn n_channels<const D: usize>(&self) -> usize {
        if D == 0 { self.wavelets.n_channels } else { D }
    }

    fn is_welded(&self) -> bool {
        self.vertex_map.n_welded() < self.vertex_map.n_vertices()
    }

    /// Writes the edited signal at all vertices to `edited`; `change` is scratch memory of n_welded × n_channels
    /// values.
    pub(crate) fn apply(&self, layers: &[LayerSlot], change: &mut Vec<f64>, edited: &mut [f64]) {
        match self.wavelets.n_channels {
            1 => self.apply_channels::<1>(layers, change, edited),
            3 => self.apply_channels::<3>(layers, change, edited),
            _ => self.apply_channels::<0>(layers, change, edited),
        }
    }

    fn apply_channels<const D: usize>(
        &self,
        layers: &[LayerSlot],
        change: &mut Vec<f64>,
        edited: &mut [f64],
    ) {
        if layers.iter().any(LayerSlot::is_by_vertex) {
            return self.apply_by_vertex::<D>(layers, edited);
        }
        let (d, n_levels) = (self.n_channels::<D>(), self.wavelets.n_levels());
        if change.is_empty() {
            *change = zeros(self.vertex_map.n_welded() * d);
        }
        if layers.iter().all(LayerSlot::is_everywhere) {
            let mut excess = vec![0.0; n_levels];
            gain_excess(layers, 0, 0, &mut excess);
            self.same_everywhere::<D>(&excess, change);
            self.add::<D>(change, |_| excess[0], edited);
            return;
        }
        parallel::visit_rows(change, d, VERTICES_AT_A_TIME, |first, rows| {
            let mut excess = vec![0.0; n_levels];
            for (x, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                gain_excess(layers, x, 0, &mut excess);
                self.change::<D>(x, &excess, row);
            }
        });
        let mut finest = vec![0.0; if self.is_welded() { self.vertex_map.n_welded() } else { 0 }];
        parallel::visit_rows(&mut finest, 1, VERTICES_AT_A_TIME, |first, finest| {
            let mut excess = vec![0.0; n_levels];
            for (x, finest) in (first..).zip(finest) {
                gain_excess(layers, x, 0, &mut excess);
                *finest = excess[0];
            }
        });
        self.add::<D>(change, |x| finest[x], edited);
    }

    /// Computes `Σ_j excess[j−1]·W_f(j)` with the same factors at all vertices.
    fn same_everywhere<const D: usize>(&self, excess: &[f64], change: &mut [f64]) {
        let d = self.n_channels::<D>();
        let levels = excess.iter().zip(&self.wavelets.levels).filter(|(e, _)| **e != 0.0);
        let levels: Vec<(f64, &'a [f64])> = levels.map(|(e, level)| (*e, level.as_slice())).collect();
        parallel::visit_rows(change, d, VERTICES_AT_A_TIME, |first, change| {
            let part = |&(excess, level): &(f64, &'a [f64])| (excess, &level[first * d..][..change.len()]);
            sum_levels(&levels.iter().map(part).collect::<Vec<_>>(), change);
        });
    }

    /// Computes `Σ_j excess[j−1]·W_f(j,x)`.
    #[inline]
    fn change<const D: usize>(&self, x: usize, excess: &[f64], change: &mut [f64]) {
        let d = self.n_channels::<D>();
        let change = &mut change[..d];
        change.fill(0.0);
        for (excess, level) in excess.iter().zip(&self.wavelets.levels).filter(|(e, _)| **e != 0.0) {
            for (sum, w) in change.iter_mut().zip(&level[x * d..][..d]) {
                *sum += excess * w;
            }
        }
    }

    /// Adds the change of each welded vertex to the signal; `finest(x)` is Γ(1,x) − 1.
    fn add<const D: usize>(
        &self,
        change: &[f64],
        finest: impl Fn(usize) -> f64 + Sync + Send,
        edited: &mut [f64],
    ) {
        let (d, welded, is_welded) = (self.n_channels::<D>(), self.vertex_map.as_slice(), self.is_welded());
        parallel::visit_rows(edited, d, VERTICES_AT_A_TIME, |first, rows| {
            for ((vertex, &x), row) in (first..).zip(&welded[first..]).zip(rows.chunks_exact_mut(d)) {
                let x = x as usize;
                let finest = if is_welded { finest(x) } else { 0.0 };
                self.edit::<D>(vertex, &change[x * d..][..d], finest, row);
            }
        });
    }

    /// Computes the edited values of one vertex.
    #[inline]
    fn edit<const D: usize>(&self, vertex: usize, change: &[f64], finest: f64, row: &mut [f64]) {
        let d = self.n_channels::<D>();
        let (signal, row) = (&self.signal[vertex * d..][..d], &mut row[..d]);
        // f′(x) = f(x) + Σ_j (Γ(j,x) − 1)·W_f(j,x) (eq. 18)
        row.copy_from_slice(signal);
        if self.masked.is_some_and(|masked| masked[vertex]) {
            return;
        }
        for (value, change) in row.iter_mut().zip(change) {
            if *change != 0.0 {
                *value += change; // adding 0 would turn −0 into 0, and a file's text with it
            }
        }
        if finest != 0.0 {
            let mean = &self.mean[self.vertex_map.welded(vertex) * d..][..d];
            for ((value, f), m) in row.iter_mut().zip(signal).zip(mean) {
                if f != m {
                    *value += finest * (f - m);
                }
            }
        }
    }

    fn apply_by_vertex<const D: usize>(&self, layers: &[LayerSlot], edited: &mut [f64]) {
        let d = self.n_channels::<D>();
        parallel::visit_rows(edited, d, VERTICES_AT_A_TIME, |first, rows| {
            let (mut excess, mut change) = (vec![0.0; self.wavelets.n_levels()], vec![0.0; d]);
            for (vertex, row) in (first..).zip(rows.chunks_exact_mut(d)) {
                let x = self.vertex_map.welded(vertex);
                gain_excess(layers, x, vertex, &mut excess);
                self.change::<D>(x, &excess, &mut change);
                self.edit::<D>(vertex, &change, excess[0], row);
            }
        });
    }

    /// Writes the edited signal at the members of some welded vertices, with the same bits as
    /// [`apply`](Self::apply).
    pub(crate) fn apply_at(
        &self,
        layers: &[LayerSlot],
        touched: &[u32],
        members: WeldedMembers<'_>,
        edited: &mut [f64],
    ) {
        match self.wavelets.n_channels {
            1 => self.apply_channels_at::<1>(layers, touched, members, edited),
            3 => self.apply_channels_at::<3>(layers, touched, members, edited),
            _ => self.apply_channels_at::<0>(layers, touched, members, edited),
        }
    }

    fn apply_channels_at<const D: usize>(
        &self,
        layers: &[LayerSlot],
        touched: &[u32],
        welded: WeldedMembers<'_>,
        edited: &mut [f64],
    ) {
        let WeldedMembers { first_member, members } = welded;
        let (d, is_welded) = (self.n_channels::<D>(), self.is_welded());
        let is_by_vertex = layers.iter().any(LayerSlot::is_by_vertex);
        let (mut excess, mut change) = (vec![0.0; self.wavelets.n_levels()], vec![0.0; d]);
        for &x in touched {
            let x = x as usize;
            for (k, &vertex) in members[first_member[x]..first_member[x + 1]].iter().enumerate() {
                let vertex = vertex as usize;
                if k == 0 || is_by_vertex {
                    gain_excess(layers, x, vertex, &mut excess);
                    self.change::<D>(x, &excess, &mut change);
                }
                let finest = if is_welded { excess[0] } else { 0.0 };
                self.edit::<D>(vertex, &change, finest, &mut edited[vertex * d..][..d]);
            }
        }
    }
}
