//! Choice of the graph of cells and of the times of imputation, by channels that the graph has not seen.
//!
//! Some channels are held back. Graphs of other channels, with several scalings, numbers of principal components and of
//! neighbors, are compared by how well a cell's value y of a held-back channel is predicted by other cells. With
//! `ŷ = Pᵗy` and the probability h of being back after t steps, the prediction without the value itself is off by
//! `(y − ŷ)/(1 − h)`. The sum of its squares over all cells, relative to that of `y − mean(y)`, is the unexplained
//! share of a channel, and the loss of a graph and a time is its mean over the channels: each of them counts the same.
//!
//! Nothing is assumed about noise but that it is independent between channels and cells, so the loss holds for
//! molecules that are counted and for dropout alike. Molecular cross-validation
//! ([`cross_validate`](crate::cross_validate)) takes a zero of a dropout for the truth, as it is one in both parts.
//!
//! The best time depends on how much of a channel is noise. Held-back channels are put into classes by their
//! explained share at the common time, each class has the time of its least loss, and all channels take the times of
//! their classes.

use crate::channel_keys::{mix, row_and_channel_keys};
use crate::components::{CenteredRows, ComponentScaling, principal_components};
use crate::held_back::{Curves, HeldBack, explained_shares};
use crate::kernel::KernelName;
use crate::{
    CountMatrix, CountValues, DimensionedPoints, GraphWalkError, SelfLoops, Transformation, WalkMatrix,
    WalkOptions, WalkPowers, kernel_weights, nearest_lists,
};
use adwave::Progress;
use adwave::rows::CompressedRows;
use std::collections::HashMap;

/// Numbers of principal components that are compared.
const COMPONENTS: [usize; 4] = [6, 12, 25, 50];

/// Number of neighbors with which components are compared.
const FIRST_NEIGHBORS: usize = 30;

/// Other numbers of neighbors that are compared on the best components.
const OTHER_NEIGHBORS: [usize; 4] = [10, 15, 60, 100];

/// Choices of components that go on to the comparison of neighbors.
const FINALISTS: usize = 2;

/// Largest number of steps of a comparison, and of the times of classes.
const MOST_STEPS: [u32; 2] = [16, 32];

/// Neighbor whose distance is the scale of the kernel.
const SCALE_NEIGHBOR: usize = 5;

/// Fewest cells and fewest varying channels of which a choice is made.
const FEWEST: [usize; 2] = [50, 20];

/// Fewest cells with a count of a channel that is held back.
const FEWEST_COUNTED: usize = 5;

/// One in so many varying channels is held back.
const HELD_BACK: usize = 5;

/// Held-back channels of a class, at least, and the largest number of classes.
const CLASSES: [usize; 2] = [16, 5];

/// Parameters of the choice of a graph.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GraphChoiceParams {
    /// Transformation before diffusion, after which values are compared. Without a library size they are compared after
    /// scaling to the median sum of the cells.
    pub transformation: Transformation,
    /// Largest number of cells to compare graphs on.
    pub most_cells: usize,
    /// Largest number of channels to hold back.
    pub most_held_back: usize,
    /// Seed of the choice of cells and channels.
    pub seed: u64,
}

impl Default for GraphChoiceParams {
    fn default() -> Self {
        Self { transformation: Transformation::default(), most_cells: 3000, most_held_back: 128, seed: 0 }
    }
}

impl GraphChoiceParams {
    /// Sets [`transformation`](Self::transformation).
    #[must_use]
    pub fn with_transformation(self, transformation: Transformation) -> Self {
        Self { transformation, ..self }
    }

    /// Sets [`seed`](Self::seed).
    #[must_use]
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

/// A graph that was compared, at its best time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedGraph {
    /// Values of the principal components.
    pub scaling: ComponentScaling,
    /// Number of principal components.
    pub n_components: usize,
    /// Number of nearest neighbors.
    pub n_neighbors: usize,
    /// Number of steps of the least loss.
    pub steps: u32,
    /// The loss: mean unexplained share of the held-back channels.
    pub loss: f64,
}

/// The chosen graph and times.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphChoice {
    /// The chosen graph, and the common time.
    pub best: ComparedGraph,
    /// Number of steps for each channel.
    pub steps: Vec<u32>,
    /// Loss of 1, 2, … steps on the chosen graph.
    pub losses: Vec<f64>,
    /// All graphs that were compared.
    pub compared: Vec<ComparedGraph>,
    /// Number of cells of the comparison.
    pub n_cells: usize,
    /// Number of channels that were held back.
    pub n_held_back: usize,
}

/// Chooses principal components, neighbors and times for imputation. `None` if there are fewer than 50 cells or 20
/// channels that vary.
///
/// Equal cells and equal channels are not told apart, and the order of cells and channels does not matter. Graphs are
/// compared on at most [`most_cells`](GraphChoiceParams::most_cells);
/// O(cells²·components + cells·neighbors·channels·steps) for each of 16.
///
/// # Errors
/// [`GraphWalkError`] if a value is negative or not finite, the library size is out of range, or the call is cancelled.
pub fn choose_graph(
    counts: &CountMatrix<'_>,
    params: GraphChoiceParams,
    progress: Progress<'_>,
) -> Result<Option<GraphChoice>, GraphWalkError> {
    if let Some((node, channel, value)) = counts.find(|v| !(v >= 0.0 && v.is_finite())) {
        return Err(GraphWalkError::NoComponents { node, channel, value });
    }
    let sample = CellSample::new(counts, &params);
    let held_back = sample.held_back(&params);
    if sample.n_cells() < FEWEST[0] || held_back.is_empty() {
        return Ok(None);
    }
    // Shares of the graph do not tell the sums of cells, so values are compared after scaling to equal sums.
    let library_size = params.transformation.library_size.or(Some(counts.median_row_sum()));
    let transformation = Transformation { library_size, ..params.transformation };
    let values = HeldBack::new(&sample.matrix(), &held_back, transformation)?;
    let mut search = GraphSearch::new(&sample, &held_back, progress)?;
    let n_graphs = search.components.iter().map(|(_, list)| list.len()).sum::<usize>();
    let n_all = (n_graphs + FINALISTS * OTHER_NEIGHBORS.len() + 1) as u64;
    for (scaling, n_components) in search.choices() {
        progress.step(search.compared.len() as u64, n_all)?;
        search.compare(&values, (scaling, n_components, FIRST_NEIGHBORS))?;
    }
    let mut finalists = search.compared.clone();
    finalists.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    for first in finalists.iter().take(FINALISTS) {
        for n_neighbors in OTHER_NEIGHBORS.into_iter().filter(|&k| 2 * k <= sample.n_cells()) {
            progress.step(search.compared.len() as u64, n_all)?;
            search.compare(&values, (first.scaling, first.n_components, n_neighbors))?;
        }
    }
    let compared = std::mem::take(&mut search.compared);
    let best =
        compared.iter().min_by(|a, b| a.loss.total_cmp(&b.loss)).copied().expect("a graph was compared");
    let powers = search.graph((best.scaling, best.n_components, best.n_neighbors))?;
    let curves = values.curves(&powers, MOST_STEPS[1], None, progress.quiet())?;
    let (steps, losses) = (curves.best_steps(), curves.losses());
    let classes = TimeClasses::new(&curves, steps);
    let shares = explained_shares(&powers, &sample.matrix(), transformation, steps, progress.quiet())?;
    let mut by_channel = vec![steps; counts.n_channels];
    for (place, share) in shares.iter().enumerate() {
        if let Some(share) = share {
            by_channel[sample.channels[place]] = classes.steps(*share);
        }
    }
    progress.step(n_all, n_all)?;
    let best = ComparedGraph { steps, loss: losses[steps as usize - 1], ..best };
    let (n_cells, n_held_back) = (sample.n_cells(), held_back.len());
    Ok(Some(GraphChoice { best, steps: by_channel, losses, compared, n_cells, n_held_back }))
}

/// The walk of a chosen graph on all cells: to their nearest neighbors in principal components of all channels, with
/// the adaptive kernel and loops of weight 1.
///
/// # Errors
/// As for [`principal_components`].
pub fn cell_walk(
    counts: &CountMatrix<'_>,
    graph: &ComparedGraph,
    progress: Progress<'_>,
) -> Result<WalkPowers, GraphWalkError> {
    let found = principal_components(counts, graph.scaling, graph.n_components, progress)?;
    neighbor_walk(&found.coordinates, found.n_components, graph.n_neighbors, progress)
}

/// The walk to the nearest neighbors of points.
fn neighbor_walk(
    values: &[f64],
    n_dimensions: usize,
    n_neighbors: usize,
    progress: Progress<'_>,
) -> Result<WalkPowers, GraphWalkError> {
    let lists = nearest_lists(DimensionedPoints { values, n_dimensions }, n_neighbors, progress)?;
    let weights = kernel_weights(&lists, KernelName::Adaptive.with_scale(1.0, SCALE_NEIGHBOR), progress)?;
    let options = WalkOptions { self_loops: SelfLoops::Weight(1.0), ..WalkOptions::default() };
    Ok(WalkPowers::new(WalkMatrix::from_weights(weights, options, progress)?, progress)?)
}

/// Some cells and all channels, in an order that depends on their content alone.
struct CellSample {
    counts: CompressedRows<f64>,
    /// Channel of the matrix at each place.
    channels: Vec<usize>,
    /// Key of the channel at each place.
    keys: Vec<u64>,
}

impl CellSample {
    fn new(counts: &CountMatrix<'_>, params: &GraphChoiceParams) -> Self {
        let (row_keys, channel_keys) = row_and_channel_keys(counts);
        let mut seen: HashMap<u64, u64> = HashMap::new();
        // Equal cells are numbered, so that some of them can be left out.
        let mut cells: Vec<(u64, usize)> = row_keys
            .iter()
            .enumerate()
            .map(|(x, &key)| {
                let number = seen.entry(key).or_default();
                *number += 1;
                (mix(key ^ mix(params.seed.wrapping_add(mix(*number)))), x)
            })
            .collect();
        cells.sort_unstable();
        cells.truncate(params.most_cells.max(1));
        let mut channels: Vec<usize> = (0..counts.n_channels).collect();
        channels.sort_by_key(|&c| (mix(channel_keys[c] ^ mix(params.seed)), c));
        let mut place_of = vec![0_u32; channels.len()];
        (0..).zip(&channels).for_each(|(place, &c)| place_of[c] = place);
        let mut row_of = vec![usize::MAX; row_keys.len()];
        cells.iter().enumerate().for_each(|(row, &(_, x))| row_of[x] = row);
        let mut rows = vec![Vec::new(); cells.len()];
        for (x, &row) in row_of.iter().enumerate() {
            if let Some(out) = rows.get_mut(row) {
                out.extend(counts.entries(x).map(|(c, v)| (place_of[c], v)));
                out.sort_unstable_by_key(|entry| entry.0);
            }
        }
        let entries =
            rows.iter().enumerate().flat_map(|(x, row)| row.iter().map(move |&(c, v)| (x as u32, c, v)));
        let counts = CompressedRows::from_sorted(cells.len(), counts.n_channels, entries.collect::<Vec<_>>())
            .expect("entries in the order of rows and columns");
        let keys = channels.iter().map(|&c| channel_keys[c]).collect();
        Self { counts, channels, keys }
    }

    fn n_cells(&self) -> usize {
        self.counts.n_rows()
    }

    fn matrix(&self) -> CountMatrix<'_> {
        CountMatrix { values: CountValues::Sparse(&self.counts), n_channels: self.channels.len() }
    }

    /// Places of the channels to hold back; none if few channels vary.
    fn held_back(&self, params: &GraphChoiceParams) -> Vec<usize> {
        let mut n_counted = vec![0; self.channels.len()];
        self.counts.columns().iter().for_each(|&c| n_counted[c as usize] += 1);
        let varying: Vec<usize> =
            (0..n_counted.len()).filter(|&c| n_counted[c] >= FEWEST_COUNTED && self.varies(c)).collect();
        if varying.len() < FEWEST[1] {
            return Vec::new();
        }
        varying[..(varying.len() / HELD_BACK).min(params.most_held_back.max(1))].to_vec()
    }

    /// True unless all values of a channel are equal.
    fn varies(&self, place: usize) -> bool {
        let first = self.counts.get(0, place);
        (1..self.n_cells()).any(|x| self.counts.get(x, place) != first)
    }
}

/// Scaling, number of components and number of neighbors of a graph.
type GraphKey = (ComponentScaling, usize, usize);

/// A number of components, and coordinates in them.
type Coordinates = (usize, Vec<f64>);

/// Comparison of graphs.
struct GraphSearch<'a> {
    /// Coordinates by scaling, for each number of components.
    components: Vec<(ComponentScaling, Vec<Coordinates>)>,
    compared: Vec<ComparedGraph>,
    progress: Progress<'a>,
}

impl<'a> GraphSearch<'a> {
    fn new(sample: &CellSample, held_back: &[usize], progress: Progress<'a>) -> Result<Self, GraphWalkError> {
        let mut is_kept = vec![true; sample.channels.len()];
        for &c in held_back {
            is_kept[c] = false;
        }
        let mut components = Vec::new();
        for &scaling in ComponentScaling::ALL {
            let rows = CenteredRows::new(&sample.matrix(), &is_kept, scaling);
            let most = COMPONENTS[COMPONENTS.len() - 1].min(rows.most_components());
            let found = rows.components(most, &sample.keys, progress.quiet())?;
            let mut numbers: Vec<usize> = COMPONENTS.iter().map(|&k| k.min(most)).collect();
            numbers.dedup();
            components.push((scaling, numbers.into_iter().map(|k| (k, found.first(k))).collect()));
        }
        Ok(Self { components, compared: Vec::new(), progress })
    }

    fn choices(&self) -> Vec<(ComponentScaling, usize)> {
        let of = |(scaling, list): &(ComponentScaling, Vec<Coordinates>)| {
            list.iter().map(|(k, _)| (*scaling, *k)).collect::<Vec<_>>()
        };
        self.components.iter().flat_map(of).collect()
    }

    /// The graph of the cells.
    fn graph(&self, (scaling, n_components, n_neighbors): GraphKey) -> Result<WalkPowers, GraphWalkError> {
        let of_scaling =
            self.components.iter().find(|(s, _)| *s == scaling).expect("a scaling of the search");
        let (_, values) =
            of_scaling.1.iter().find(|(k, _)| *k == n_components).expect("components of the search");
        neighbor_walk(values, n_components, n_neighbors, self.progress.quiet())
    }

    /// Adds a graph at its best time.
    fn compare(&mut self, values: &HeldBack, key: GraphKey) -> Result<(), GraphWalkError> {
        let powers = self.graph(key)?;
        let patience = Some(3);
        let curves = values.curves(&powers, MOST_STEPS[0], patience, self.progress.quiet())?;
        let steps = curves.best_steps();
        let loss = curves.losses()[steps as usize - 1];
        let (scaling, n_components, n_neighbors) = key;
        self.compared.push(ComparedGraph { scaling, n_components, n_neighbors, steps, loss });
        Ok(())
    }
}

/// Times by the explained share of a channel.
struct TimeClasses {
    /// Smallest explained share of each class but the first, and the time of each class.
    bounds: Vec<f64>,
    steps: Vec<u32>,
}

impl TimeClasses {
    fn new(curves: &Curves, common: u32) -> Self {
        let at_common = curves.unexplained(common);
        let mut order: Vec<usize> = (0..at_common.len()).collect();
        order.sort_by(|&a, &b| at_common[b].total_cmp(&at_common[a]).then(a.cmp(&b)));
        let n_classes = (order.len() / CLASSES[0]).clamp(1, CLASSES[1]);
        let class = |i: usize| &order[i * order.len() / n_classes..(i + 1) * order.len() / n_classes];
        let loss = |i: usize, t: u32| {
            let now = curves.unexplained(t);
            class(i).iter().map(|&g| now[g] / at_common[g].max(f64::MIN_POSITIVE)).sum::<f64>()
        };
        let best = |i: usize| {
            (1..=curves.most_steps()).min_by(|&a, &b| loss(i, a).total_cmp(&loss(i, b))).unwrap_or(common)
        };
        let bounds = (1..n_classes).map(|i| 1.0 - at_common[class(i)[0]]).collect();
        let steps = if n_classes == 1 { vec![common] } else { (0..n_classes).map(best).collect() };
        Self { bounds, steps }
    }

    fn steps(&self, explained: f64) -> u32 {
        self.steps[self.bounds.partition_point(|&bound| bound <= explained)]
    }
}

#[cfg(test)]
#[path = "graph_choice_tests.rs"]
mod tests;
