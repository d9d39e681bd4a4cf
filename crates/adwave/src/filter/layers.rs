//! Layers in a form that can be evaluated at any vertex.

use super::{Edit, FilterError, Layer};
use crate::Progress;
use crate::region::{RegionWeights, SurfaceMetric};
use crate::shape::VertexMap;

/// A layer as numbers: one gain per level, and the weights of its region on a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightedLayer {
    /// Gains g_1 … g_J, fine to coarse.
    pub gains: Vec<f64>,
    /// Weights r(x) of the region.
    pub weights: RegionWeights,
}

impl WeightedLayer {
    /// A layer that applies everywhere.
    pub fn everywhere(gains: Vec<f64>) -> Self {
        Self { gains, weights: RegionWeights::Everywhere }
    }

    /// Checks that there is one finite gain per level and that the weights match the shape.
    ///
    /// # Errors
    /// [`FilterError`] with the number `layer` (from 1) if they do not.
    pub fn check(&self, layer: usize, n_levels: usize, vertex_map: &VertexMap) -> Result<(), FilterError> {
        super::check_gains(&self.gains, n_levels)?;
        self.weights.check(vertex_map).map_err(|source| FilterError::Region { layer, source })
    }
}

impl Edit<'_> {
    /// Resolves the layers to numbers, for `n_levels` levels on a shape.
    ///
    /// # Errors
    /// [`FilterError`] if gains or regions do not match, or the call is cancelled.
    pub fn resolve(
        &self,
        n_levels: usize,
        metric: &SurfaceMetric,
        progress: Progress<'_>,
    ) -> Result<Vec<WeightedLayer>, FilterError> {
        let resolve = |(k, layer): (usize, &Layer)| {
            let gains = layer.gains.resolve(n_levels)?;
            let weights = layer.region.weights(metric, self.field, self.field_names, progress);
            let weights = weights.map_err(|source| FilterError::Region { layer: k + 1, source })?;
            Ok(WeightedLayer { gains, weights })
        };
        self.layers.iter().enumerate().map(resolve).collect()
    }
}

/// Weights with constant-time access at any vertex.
#[derive(Clone, Debug)]
enum DenseWeights {
    Everywhere,
    Welded(Vec<f64>),
    /// One weight per vertex of the shape, if vertices are welded.
    Vertices(Vec<f64>),
}

/// A layer for evaluation vertex by vertex.
#[derive(Clone, Debug)]
pub(crate) struct LayerSlot {
    /// Excess gains g_j − 1.
    excess: Vec<f64>,
    weights: DenseWeights,
    /// Welded vertices outside which all weights are 0, in ascending order; `None` if unknown.
    support: Option<Vec<u32>>,
}

impl LayerSlot {
    /// Prepares a layer that has been checked.
    pub(crate) fn new(layer: WeightedLayer, vertex_map: &VertexMap) -> Self {
        let mut slot = Self { excess: Vec::new(), weights: DenseWeights::Everywhere, support: None };
        slot.set_gains(&layer.gains);
        slot.set_weights(layer.weights, vertex_map);
        slot
    }

    /// Prepares a layer that has been checked, for access by the vertices of the shape.
    pub(crate) fn to_shape_order(layer: &WeightedLayer, vertex_map: &VertexMap) -> Self {
        let weights = match &layer.weights {
            RegionWeights::Everywhere => DenseWeights::Everywhere,
            weights => DenseWeights::Vertices(weights.to_vertices(vertex_map)),
        };
        let mut slot = Self { excess: Vec::new(), weights, support: None };
        slot.set_gains(&layer.gains);
        slot
    }

    pub(crate) fn set_gains(&mut self, gains: &[f64]) {
        self.excess.clear();
        self.excess.extend(gains.iter().map(|g| g - 1.0));
    }

    /// Replaces the weights. Returns the welded vertices where the old or the new weights may differ from 0, or
    /// `None` for all.
    pub(crate) fn set_weights(&mut self, weights: RegionWeights, vertex_map: &VertexMap) -> Option<Vec<u32>> {
        match (weights, &mut self.weights, self.support.take()) {
            (RegionWeights::Sparse { vertices, weights }, DenseWeights::Welded(dense), Some(old)) => {
                for &x in &old {
                    dense[x as usize] = 0.0;
                }
                put(dense, &vertices, &weights);
                let touched = union(&old, &vertices);
                self.support = Some(vertices);
                return Some(touched);
            }
            (RegionWeights::Sparse { vertices, weights }, ..) => {
                let mut dense = vec![0.0; vertex_map.n_welded()];
                put(&mut dense, &vertices, &weights);
                self.weights = DenseWeights::Welded(dense);
                self.support = Some(vertices);
            }
            (RegionWeights::Everywhere, ..) => self.weights = DenseWeights::Everywhere,
            (RegionWeights::Welded(weights), ..) => self.weights = DenseWeights::Welded(weights),
            (RegionWeights::Vertices(weights), ..) => {
                self.weights = if vertex_map.n_welded() < vertex_map.n_vertices() {
                    DenseWeights::Vertices(weights)
                } else {
                    let mut welded = vec![0.0; weights.len()];
                    put(&mut welded, vertex_map.as_slice(), &weights);
                    DenseWeights::Welded(welded)
                };
            }
        }
        None
    }

    /// The welded vertices that this layer may change, in ascending order; `None` for all.
    pub(crate) fn support(&self) -> Option<&[u32]> {
        self.support.as_deref()
    }

    pub(crate) fn is_everywhere(&self) -> bool {
        matches!(self.weights, DenseWeights::Everywhere)
    }

    /// True if members of a welded vertex may have different weights.
    pub(crate) fn is_by_vertex(&self) -> bool {
        matches!(self.weights, DenseWeights::Vertices(_))
    }

    /// Weight r at welded vertex `x` for its member `vertex`.
    #[inline]
    fn weight(&self, x: usize, vertex: usize) -> f64 {
        match &self.weights {
            DenseWeights::Everywhere => 1.0,
            DenseWeights::Welded(weights) => weights[x],
            DenseWeights::Vertices(weights) => weights[vertex],
        }
    }
}

/// Computes `Γ(j,x) − 1` for all levels j, `Γ(j,x) = Π_layers (1 + r(x)·(g_j − 1))` (eq. 18), at welded vertex `x`
/// for its member `vertex`. The result is exactly 0 if no layer has an effect, and exactly g_j − 1 if one layer has
/// weight 1.
#[inline]
pub(crate) fn gain_excess(layers: &[LayerSlot], x: usize, vertex: usize, excess: &mut [f64]) {
    excess.fill(0.0);
    for layer in layers {
        let r = layer.weight(x, vertex);
        if r != 0.0 {
            for (total, own) in excess.iter_mut().zip(&layer.excess) {
                // Γ = Π (1 + r·(g_j − 1)) (eq. 18): (1 + a)(1 + b) − 1
                let own = r * own;
                *total += own + *total * own;
            }
        }
    }
}

fn put(dense: &mut [f64], vertices: &[u32], weights: &[f64]) {
    for (&x, &weight) in vertices.iter().zip(weights) {
        dense[x as usize] = weight;
    }
}

/// Members of two ascending lists, each once.
fn union(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut both = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut k) = (0, 0);
    while i < a.len() && k < b.len() {
        let next = a[i].min(b[k]);
        i += usize::from(a[i] == next);
        k += usize::from(b[k] == next);
        both.push(next);
    }
    both.extend_from_slice(&a[i..]);
    both.extend_from_slice(&b[k..]);
    both
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_joined_in_order() {
        assert_eq!(union(&[1, 3, 5], &[2, 3, 9]), [1, 2, 3, 5, 9]);
        assert_eq!(union(&[], &[4]), [4]);
    }

    #[test]
    fn gains_of_layers_multiply_by_their_weights() {
        let map = VertexMap::identity(2);
        let half = RegionWeights::Welded(vec![0.5, 0.0]);
        let layers = [
            LayerSlot::new(WeightedLayer::everywhere(vec![2.0, 1.0]), &map),
            LayerSlot::new(WeightedLayer { gains: vec![3.0, 0.0], weights: half }, &map),
        ];
        let mut excess = [0.0; 2];
        gain_excess(&layers, 0, 0, &mut excess);
        assert_eq!(excess, [2.0 * 2.0 - 1.0, 0.5 - 1.0]);
        gain_excess(&layers, 1, 1, &mut excess);
        assert_eq!(excess, [1.0, 0.0]);
    }
}
