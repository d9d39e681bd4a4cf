//! Thresholds per connected component.

use super::ThresholdScope;
use super::response::ResponseLevel;
use crate::population::Population;
use crate::shape::{Adjacency, label_components};
use crate::{Cancelled, Progress};

/// Mean |R(j)| over the group with which a vertex is compared.
pub(super) struct Means {
    component: Option<Vec<u32>>,
    n_components: usize,
}

impl Means {
    pub(super) fn new(
        adjacency: &Adjacency,
        scope: ThresholdScope,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        Ok(match scope {
            ThresholdScope::Shape => Self { component: None, n_components: 1 },
            ThresholdScope::Component => {
                // In a directed cloud, edges connect in both directions.
                let (component, n_components) = label_components(&adjacency.union_with_transpose(progress)?);
                Self { component: Some(component), n_components }
            }
        })
    }

    /// Mean of each group.
    pub(super) fn component_means(&self, population: &Population<'_>, level: &ResponseLevel<'_>) -> Vec<f64> {
        let n = level.len();
        let Some(component) = &self.component else {
            return vec![population.mean_over(n, |x| level.value(x))];
        };
        let (mut sum, mut total) = (vec![0.0; self.n_components], vec![0.0; self.n_components]);
        for x in (0..n).filter(|&x| !population.is_masked(x)) {
            let weight = population.weight(x);
            sum[component[x] as usize] += weight * level.value(x).abs();
            total[component[x] as usize] += weight;
        }
        sum.iter().zip(&total).map(|(s, &of)| if of > 0.0 { s / of } else { 0.0 }).collect()
    }

    /// Group of a vertex.
    pub(super) fn group(&self, x: usize) -> usize {
        self.component.as_ref().map_or(0, |component| component[x] as usize)
    }
}
