//! From what was computed for the vertices of a tile to its records as they come out, block by block.

use std::ops::Range;

use adwave::Progress;
use rayon::prelude::*;

use crate::blocks::Blocks;
use crate::layout::Layout;
use crate::outputs::{Outputs, length};
use crate::plan::Plan;
use crate::totals::{BlockOutcome, LengthSums, StepSums};
use crate::{TilesError, cloud, mesh};

/// What a tile gives for some blocks.
pub(crate) struct Made {
    /// The records as they come out; the map is 0 as yet.
    pub(crate) records: Vec<u8>,
    /// The lengths of all bands of each vertex, where there are to be maps.
    pub(crate) lengths: Vec<u8>,
}

/// What was computed for a tile, or some of its blocks.
pub(crate) struct Results {
    /// The positions of the part that it was computed in.
    pub(crate) points: Vec<[f64; 3]>,
    /// The values of [`Params::series`](crate::Params), or the change of the positions, three numbers for each vertex of the part.
    pub(crate) outs: Vec<Vec<f64>>,
    /// Those of the blocks, among the vertices of the part.
    pub(crate) own: Range<usize>,
    /// What steps there are in each of the blocks.
    pub(crate) steps: Vec<StepSums>,
    /// E.
    pub(crate) mean_length: f64,
    /// A vertex that moved farther than this is counted.
    pub(crate) far: f64,
}

/// The vertices of a block, among those of a part whose own begin with the block `first`.
pub(crate) fn within(blocks: &Blocks, own: &Range<usize>, first: usize, block: usize) -> Range<usize> {
    let (first, vertices) = (blocks.vertices(first).start, blocks.vertices(block));
    own.start + vertices.start - first..own.start + vertices.end - first
}

/// Blocks whose records are in memory together.
const AT_A_TIME: usize = 64;

impl Results {
    /// Gives what becomes of the blocks to `out`, in their order.
    pub(crate) fn hand_over(
        &self,
        (plan, blocks): (&Plan, &Blocks),
        tile: Range<usize>,
        progress: Progress<'_>,
        out: &mut impl FnMut(&Made) -> Result<(), TilesError>,
    ) -> Result<Vec<BlockOutcome>, TilesError> {
        let outs: Vec<&[[f64; 3]]> = self.outs.iter().map(|out| out.as_chunks::<3>().0).collect();
        let (unit, measures, first) = (plan.layout.unit(), plan.params.has_maps(), tile.start);
        let all: Vec<usize> = tile.collect();
        let mut outcomes = Vec::with_capacity(all.len());
        for (group, steps) in all.chunks(AT_A_TIME).zip(self.steps.chunks(AT_A_TIME)) {
            progress.check()?;
            let made: Vec<(Made, BlockOutcome)> = group
                .par_iter()
                .zip(steps)
                .map(|(&block, &steps)| {
                    let own = within(blocks, &self.own, first, block);
                    let outs = outs.iter().map(|out| &out[own.clone()]).collect();
                    let outs = Outputs::new(&plan.params, unit, outs);
                    let sums = |values: &[[f64; 3]]| LengthSums::of(values, self.mean_length);
                    let is_far = |change: &&[f64; 3]| length(**change) > self.far;
                    let records = blocks.records(block)?;
                    let outcome = BlockOutcome {
                        n_points: (records.len() / plan.layout.record_bytes()) as u64,
                        moved: outs.change.map_or_else(LengthSums::default, sums),
                        n_far: outs.change.map_or(0, |changes| changes.iter().filter(is_far).count()) as u64,
                        bands: outs.bands.iter().map(|band| sums(band)).collect(),
                        steps,
                    };
                    let lengths = if measures { outs.lengths() } else { Vec::new() };
                    let points = &self.points[own];
                    let records = match plan.layout {
                        Layout::Las(steps) => cloud::records_of_block(plan, steps, &records, points, &outs)?,
                        Layout::Mesh(_) => mesh::results_of_block(plan, blocks, &records, points, &outs),
                    };
                    Ok((Made { records, lengths }, outcome))
                })
                .collect::<Result<_, TilesError>>()?;
            for (made, outcome) in made {
                out(&made)?;
                outcomes.push(outcome);
            }
        }
        Ok(outcomes)
    }
}
