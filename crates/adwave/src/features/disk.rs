//! Points of a surface by place, and the disks around a point.

use crate::shape::squared_distance;
use crate::{Cancelled, Progress, parallel};

/// Number of bits of a key for the place of a cell along each axis.
const BITS: u32 = 21;

/// Largest place of a cell along an axis.
const LAST: f64 = ((1_u64 << BITS) - 1) as f64;

/// Points in cells of a cubic grid.
pub(super) struct PointGrid {
    /// Points, those of a cell in succession.
    order: Vec<u32>,
    /// Keys of the cells that hold points, ascending, with the ends of their points in `order`.
    cells: Vec<(u64, u32)>,
    /// Smallest coordinates of the points.
    low: [f64; 3],
    /// Length of the sides of the cells.
    size: f64,
}

impl PointGrid {
    /// The chosen points, given by their indices, in cells whose sides have the length `size`, which is above 0. O(n
    /// log n).
    pub(super) fn new(
        points: &[[f64; 3]],
        chosen: &[u32],
        size: f64,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let low = chosen
            .iter()
            .fold([f64::INFINITY; 3], |low, &x| std::array::from_fn(|c| low[c].min(points[x as usize][c])));
        let mut grid = Self { order: Vec::new(), cells: Vec::new(), low, size };
        let mut keyed: Vec<(u64, u32)> =
            chosen.iter().map(|&x| (key(grid.cell(&points[x as usize])), x)).collect();
        parallel::sort_unstable_by(&mut keyed, progress, Ord::cmp)?;
        let mut end = 0;
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            end += same.len() as u32;
            grid.cells.push((same[0].0, end));
        }
        grid.order = keyed.into_iter().map(|(_, x)| x).collect();
        Ok(grid)
    }

    /// Calls `visit` with each point within `reach` of `center` and its squared distance, in an order that the
    /// positions decide.
    pub(super) fn visit_within(
        &self,
        points: &[[f64; 3]],
        center: &[f64; 3],
        reach: f64,
        mut visit: impl FnMut(usize, f64),
    ) {
        let low = self.cell(&center.map(|c| c - reach));
        let high = self.cell(&center.map(|c| c + reach));
        let mut visit_all = |list: &[u32]| {
            for &y in list {
                let away = squared_distance(center, &points[y as usize]);
                if away <= reach * reach {
                    visit(y as usize, away);
                }
            }
        };
        let n_columns: u64 = (0..2).map(|c| high[c] - low[c] + 1).product();
        if n_columns > self.order.len() as u64 {
            visit_all(&self.order);
            return;
        }
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                let (from, to) = (key([i, j, low[2]]), key([i, j, high[2]]));
                let first = self.cells.partition_point(|cell| cell.0 < from);
                let n_cells = self.cells[first..].iter().take_while(|cell| cell.0 <= to).count();
                if n_cells > 0 {
                    let start = if first == 0 { 0 } else { self.cells[first - 1].1 };
                    visit_all(&self.order[start as usize..self.cells[first + n_cells - 1].1 as usize]);
                }
            }
        }
    }

    /// The cell of a point; the outermost ones take all that lies farther out.
    fn cell(&self, point: &[f64; 3]) -> [u64; 3] {
        std::array::from_fn(|c| ((point[c] - self.low[c]) / self.size).clamp(0.0, LAST) as u64)
    }
}

/// Number that orders cells by their places.
fn key(cell: [u64; 3]) -> u64 {
    cell.into_iter().fold(0, |key, place| key << BITS | place)
}
