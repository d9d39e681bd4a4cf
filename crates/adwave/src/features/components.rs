//! Thresholds for each connected component.

use super::ThresholdScope;
use super::response::Level;
use crate::population::Population;
use crate::shape::Adjacency;
use crate::{Cancelled, Progress};

/// Which component each vertex belongs to, numbered by their first vertices, and how many there are.
fn component_of(adjacency: &Adjacency) -> (Vec<u32>, usize) {
    const NONE: u32 = u32::MAX;
    let mut component = vec![NONE; adjacency.n_rows()];
    let mut stack = Vec::new();
    let mut count = 0;
    for start in 0..component.len() {
        if component[start] != NONE {
            continue;
        }
        component[start] = count;
        stack.push(start as u32);
        while let Some(x) = stack.pop() {
            for &y in adjacency.of(x as usize) {
                if component[y as usize] == NONE {
                    component[y as usize] = count;
                    stack.push(y);
                }
            }
        }
        count += 1;
    }
    (component, count as usize)
}

/// mean|R(j)| over what a vertex is compared with.
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
                // A directed cloud hangs together whichever way its edges point.
                let (component, n_components) = component_of(&adjacency.union_with_transpose(progress)?);
                Self { component: Some(component), n_components }
            }
        })
    }

    /// The mean of each group.
    pub(super) fn of(&self, population: &Population<'_>, level: &Level<'_>) -> Vec<f64> {
        let n = level.len();
        let Some(component) = &self.component else { return vec![population.mean_of(n, |x| level.at(x))] };
        let (mut sum, mut total) = (vec![0.0; self.n_components], vec![0.0; self.n_components]);
        for x in (0..n).filter(|&x| !population.is_masked(x)) {
            let weight = population.weight(x);
            sum[component[x] as usize] += weight * level.at(x).abs();
            total[component[x] as usize] += weight;
        }
        sum.iter().zip(&total).map(|(s, &of)| if of > 0.0 { s / of } else { 0.0 }).collect()
    }

    /// The group of a vertex.
    pub(super) fn group(&self, x: usize) -> usize {
        self.component.as_ref().map_or(0, |component| component[x] as usize)
    }
}
