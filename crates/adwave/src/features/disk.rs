//! Points of a surface by place, and the disks around a point.

use crate::shape::squared_distance;
use std::collections::HashMap;

/// Points in cells of a cubic grid.
pub(super) struct PointGrid {
    /// Points, those of a cell in succession.
    order: Vec<u32>,
    cells: HashMap<[i32; 3], (u32, u32)>,
    size: f64,
}

impl PointGrid {
    /// The points with the given indices in cells whose sides have the length `size`, which is above 0. O(n log n).
    pub(super) fn new(points: &[[f64; 3]], chosen: impl Iterator<Item = u32>, size: f64) -> Self {
        let mut keyed: Vec<([i32; 3], u32)> = chosen.map(|x| (cell(&points[x as usize], size), x)).collect();
        keyed.sort_unstable();
        let mut cells = HashMap::new();
        let mut start = 0;
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            let end = start + same.len() as u32;
            cells.insert(same[0].0, (start, end));
            start = end;
        }
        Self { order: keyed.into_iter().map(|(_, x)| x).collect(), cells, size }
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
        let mut visit_all = |list: &[u32]| {
            for &y in list {
                let away = squared_distance(center, &points[y as usize]);
                if away <= reach * reach {
                    visit(y as usize, away);
                }
            }
        };
        let low = cell(&[0, 1, 2].map(|c| center[c] - reach), self.size);
        let high = cell(&[0, 1, 2].map(|c| center[c] + reach), self.size);
        let n_cells: f64 = (0..3).map(|c| f64::from(high[c]) - f64::from(low[c]) + 1.0).product();
        if n_cells > self.order.len() as f64 {
            visit_all(&self.order);
            return;
        }
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                for k in low[2]..=high[2] {
                    if let Some(&(start, end)) = self.cells.get(&[i, j, k]) {
                        visit_all(&self.order[start as usize..end as usize]);
                    }
                }
            }
        }
    }
}

/// The cell of a point; the outermost ones take all that lies farther out.
fn cell(point: &[f64; 3], size: f64) -> [i32; 3] {
    const FARTHEST: f64 = 1e9;
    point.map(|c| (c / size).floor().clamp(-FARTHEST, FARTHEST) as i32)
}
