//! Layers made ready to be evaluated at any vertex.

use super::{Edit, FilterError, Layer};
use crate::Progress;
use crate::region::{RegionWeights, SurfaceMetric};
use crate::shape::VertexMap;

/// A layer as numbers: one gain for each level, and the weights of its region on a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightedLayer {
    /// g_1 … g_J, fine to coarse.
    pub gains: Vec<f64>,
    /// r(x).
    pub weights: RegionWeights,
}

impl WeightedLayer {
    /// A layer that applies everywhere.
    pub fn everywhere(gains: Vec<f64>) -> Self {
        Self { gains, weights: RegionWeights::Everywhere }
    }

    /// Checks that there is one finite gain for each level and that the weights belong to the shape.
    ///
    /// # Errors
    /// [`FilterError`]; `layer` is the layer's number in it, from 1.
    pub fn check(&self, layer: usize, n_levels: usize, vertex_map: &VertexMap) -> Result<(), FilterError> {
        super::check_gains(&self.gains, n_levels)?;
        self.weights.check(vertex_map).map_err(|source| FilterError::Region { layer, source })
    }
}

impl Edit<'_> {
    /// The layers as numbers, for `n_levels` levels on a shape.
    ///
    /// # Errors
    /// [`FilterError`] when gains or regions do not fit; cancelled.
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

/// Weights that can be read at any vertex in constant time.
#[derive(Clone, Debug)]
enum Dense {
    Everywhere,
    Welded(Vec<f64>),
    /// Per vertex of the shape, where vertices are welded.
    Vertices(Vec<f64>),
}

/// A layer that is evaluated vertex by vertex.
#[derive(Clone, Debug)]
pub(crate) struct LayerSlot {
    /// g_j − 1.
    excess: Vec<f64>,
    weights: Dense,
    /// The welded vertices, by rising index, beyond which all weights are 0; `None` where that is not known.
    support: Option<Vec<u32>>,
}

impl LayerSlot {
    /// A layer that has been checked.
    pub(crate) fn new(layer: WeightedLayer, vertex_map: &VertexMap) -> Self {
        let mut slot = Self { excess: Vec::new(), weights: Dense::Everywhere, support: None };
        slot.set_gains(&layer.gains);
        slot.set_weights(layer.weights, vertex_map);
        slot
    }

    /// A layer that has been checked, for reading by the vertices of the shape.
    pub(crate) fn in_shape_order(layer: &WeightedLayer, vertex_map: &VertexMap) -> Self {
        let weights = match &layer.weights {
            RegionWeights::Everywhere => Dense::Everywhere,
            weights => Dense::Vertices(weights.to_vertices(vertex_map)),
        };
        let mut slot = Self { excess: Vec::new(), weights, support: None };
        slot.set_gains(&layer.gains);
        slot
    }

    pub(crate) fn set_gains(&mut self, gains: &[f64]) {
        self.excess.clear();
        self.excess.extend(gains.iter().map(|g| g - 1.0));
    }

    /// Replaces the weights; the welded vertices where the old or the new ones may differ from 0, or `None` for all.
    pub(crate) fn set_weights(&mut self, weights: RegionWeights, vertex_map: &VertexMap) -> Option<Vec<u32>> {
        match (weights, &mut self.weights, self.support.take()) {
            (RegionWeights::Sparse { vertices, weights }, Dense::Welded(dense), Some(old)) => {
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
                self.weights = Dense::Welded(dense);
                self.support = Some(vertices);
            }
            (RegionWeights::Everywhere, ..) => self.weights = Dense::Everywhere,
            (RegionWeights::Welded(weights), ..) => self.weights = Dense::Welded(weights),
            (RegionWeights::Vertices(weights), ..) => {
                self.weights = if vertex_map.n_welded() < vertex_map.n_vertices() {
                    Dense::Vertices(weights)
                } else {
                    let mut welded = vec![0.0; weights.len()];
                    put(&mut welded, vertex_map.as_slice(), &weights);
                    Dense::Welded(welded)
                };
            }
        }
        None
    }

    /// The welded vertices where this layer may do anything, by rising index; `None` for all.
    pub(crate) fn support(&self) -> Option<&[u32]> {
        self.support.as_deref()
    }

    pub(crate) fn is_everywhere(&self) -> bool {
        matches!(self.weights, Dense::Everywhere)
    }

    /// Whether members of a welded vertex may have different weights.
    pub(crate) fn is_by_vertex(&self) -> bool {
        matches!(self.weights, Dense::Vertices(_))
    }

    /// r at welded vertex `x`, of which `vertex` is a member.
    #[inline]
    fn weight(&self, x: usize, vertex: usize) -> f64 {
        match &self.weights {
            Dense::Everywhere => 1.0,
            Dense::Welded(weights) => weights[x],
            Dense::Vertices(weights) => weights[vertex],
        }
    }
}

/// `Γ(j,x) − 1` for all levels j, `Γ(j,x) = Π_layers (1 + r(x)·(g_j − 1))` (eq. 18), at welded vertex `x`, of which `vertex` is
/// a member. Exactly 0 where no layer does anything, exactly g_j − 1 where one does with the weight 1.
#[inline]
pub(crate) fn excess_at(layers: &[LayerSlot], x: usize, vertex: usize, excess: &mut [f64]) {
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

/// The members of two lists by rising index, each once.
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
        excess_at(&layers, 0, 0, &mut excess);
        assert_eq!(excess, [2.0 * 2.0 - 1.0, 0.5 - 1.0]);
        excess_at(&layers, 1, 1, &mut excess);
        assert_eq!(excess, [1.0, 0.0]);
    }
}
