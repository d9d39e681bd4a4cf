//! Meshes of cells: their corners and centers, and the mesh that joins the centers.

use adwave::Progress;
use adwave::shape::Polygons;

use crate::ReadError;
use crate::progress::report_row;

/// Largest number of cells that meet at a corner.
const MAX_CELLS_AT_CORNER: usize = 256;

/// Cells with their corners.
#[derive(Debug)]
pub(super) struct MeshCells {
    /// Corners of cells.
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) corners: Polygons,
    /// A point in each cell.
    pub(super) centers: Vec<[f64; 3]>,
}

/// Table of the corners of cells as a file has it: numbers from `first` on, cell after cell.
pub(super) struct CornerTable {
    pub(super) numbers: Vec<f64>,
    /// Numbers of a cell.
    pub(super) width: usize,
    /// Number of the first node.
    pub(super) first: f64,
    /// Number in place of a corner that a cell does not have.
    pub(super) fill: Option<f64>,
    /// Number of corners of each cell, if the file states it.
    pub(super) counts: Option<Vec<f64>>,
}

impl CornerTable {
    /// Corners of all cells.
    ///
    /// # Errors
    /// [`ReadError::Whole`] if a cell has fewer than three corners, the same corner twice, or one that does not exist.
    pub(super) fn to_polygons(&self, n_nodes: usize, progress: Progress<'_>) -> Result<Polygons, ReadError> {
        let wrong = |cell: usize, problem: String| {
            Err(ReadError::Whole(format!("cell {cell} of the mesh {problem}; correct the file")))
        };
        let n_cells = self.numbers.len() / self.width.max(1);
        let mut polygons = Polygons::new();
        let mut cell_corners: Vec<u32> = Vec::new();
        for cell in 0..n_cells {
            report_row(progress, cell as u64, n_cells as u64)?;
            let row = &self.numbers[cell * self.width..(cell + 1) * self.width];
            let n = match self.counts.as_ref().map(|counts| counts[cell]) {
                Some(n) if (0.0..=self.width as f64).contains(&n) => n as usize,
                Some(n) => {
                    return wrong(
                        cell,
                        format!("has {n} corners, and the table has room for {}", self.width),
                    );
                }
                None => self.width,
            };
            cell_corners.clear();
            for &number in &row[..n] {
                if self.fill == Some(number) || number.is_nan() {
                    continue;
                }
                let node = number - self.first;
                if !(0.0..n_nodes as f64).contains(&node) {
                    return wrong(
                        cell,
                        format!(
                            "names corner {number}, but they are {} to {}",
                            self.first,
                            self.first + n_nodes as f64 - 1.0
                        ),
                    );
                }
                // Cells with fewer corners may repeat the last one.
                if cell_corners.last() != Some(&(node as u32)) {
                    cell_corners.push(node as u32);
                }
            }
            if cell_corners.len() > 1 && cell_corners.first() == cell_corners.last() {
                cell_corners.pop();
            }
            if cell_corners.len() < 3 {
                return wrong(
                    cell,
                    format!("has {} corners and must have three at least", cell_corners.len()),
                );
            }
            if let Some(k) = (1..cell_corners.len()).find(|&k| cell_corners[..k].contains(&cell_corners[k])) {
                return wrong(
                    cell,
                    format!("names corner {} twice", f64::from(cell_corners[k]) + self.first),
                );
            }
            polygons.push(&cell_corners);
        }
        Ok(polygons)
    }
}

/// A cell at a node, with the two other ends of its sides there.
#[derive(Clone, Copy)]
struct CellAtNode {
    cell: u32,
    ends: [u32; 2],
}

impl MeshCells {
    /// Mesh that joins the centers of the cells: a face around each node at which three cells or more follow each other
    /// side by side, counterclockwise from outside (of a plane: from above). O(corners) for cells as they occur.
    pub(super) fn dual_faces(&self, is_sphere: bool, progress: Progress<'_>) -> Result<Polygons, ReadError> {
        let n_nodes = self.nodes.len();
        let mut offsets = vec![0_usize; n_nodes + 1];
        for &node in self.corners.corners() {
            offsets[node as usize + 1] += 1;
        }
        if let Some(node) = (0..n_nodes).find(|&node| offsets[node + 1] > MAX_CELLS_AT_CORNER) {
            return Err(ReadError::Whole(format!(
                "corner {node} of the mesh belongs to {} cells, and at most {MAX_CELLS_AT_CORNER} can meet; correct the file",
                offsets[node + 1]
            )));
        }
        for node in 0..n_nodes {
            offsets[node + 1] += offsets[node];
        }
        let mut next = offsets.clone();
        let mut at_nodes = vec![CellAtNode { cell: 0, ends: [0; 2] }; offsets[n_nodes]];
        for (cell, corners) in self.corners.iter().enumerate() {
            let n = corners.len();
            for k in 0..n {
                let place = &mut next[corners[k] as usize];
                at_nodes[*place] =
                    CellAtNode { cell: cell as u32, ends: [corners[(k + n - 1) % n], corners[(k + 1) % n]] };
                *place += 1;
            }
        }
        let mut faces = Polygons::new();
        for node in 0..n_nodes {
            report_row(progress, node as u64, n_nodes as u64)?;
            let mut left: Vec<CellAtNode> = at_nodes[offsets[node]..offsets[node + 1]].to_vec();
            while let Some(mut chain) = take_chain(&mut left) {
                if chain.len() >= 3 {
                    if self.is_turned_in(node, &chain, is_sphere) {
                        chain.reverse();
                    }
                    faces.push(&chain);
                }
            }
        }
        Ok(faces)
    }

    /// True if a face of centers around a node is clockwise from outside.
    fn is_turned_in(&self, node: usize, chain: &[u32], is_sphere: bool) -> bool {
        let origin = self.nodes[node];
        let out = if is_sphere { origin } else { [0.0, 0.0, 1.0] };
        let arm = |cell: u32| {
            let center = self.centers[cell as usize];
            [center[0] - origin[0], center[1] - origin[1], center[2] - origin[2]]
        };
        let turned = |k: usize| {
            let (a, b) = (arm(chain[k]), arm(chain[(k + 1) % chain.len()]));
            out[0] * (a[1] * b[2] - a[2] * b[1])
                + out[1] * (a[2] * b[0] - a[0] * b[2])
                + out[2] * (a[0] * b[1] - a[1] * b[0])
        };
        (0..chain.len()).map(turned).sum::<f64>() < 0.0
    }
}

/// Cells at a node that follow each other side by side, taken out of the list; from an end of the row if it has one.
fn take_chain(left: &mut Vec<CellAtNode>) -> Option<Vec<u32>> {
    let is_shared = |left: &[CellAtNode], k: usize, end: u32| {
        left.iter().enumerate().any(|(other, cell)| other != k && cell.ends.contains(&end))
    };
    let is_end = |k: usize| left[k].ends.iter().any(|&end| !is_shared(left, k, end));
    let start = (0..left.len()).find(|&k| is_end(k)).unwrap_or(0);
    if left.is_empty() {
        return None;
    }
    // The first side is the one that no other cell has.
    let [a, b] = left[start].ends;
    let mut end = if is_shared(left, start, b) { b } else { a };
    let mut chain = vec![left.swap_remove(start).cell];
    while let Some(k) = left.iter().position(|cell| cell.ends.contains(&end)) {
        let cell = left.swap_remove(k);
        end = if cell.ends[0] == end { cell.ends[1] } else { cell.ends[0] };
        chain.push(cell.cell);
    }
    Some(chain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(numbers: &[f64]) -> CornerTable {
        CornerTable { numbers: numbers.to_vec(), width: 4, first: 1.0, fill: Some(-1.0), counts: None }
    }

    #[test]
    fn rows_of_corners_are_cells_or_errors() {
        let good = table(&[1.0, 2.0, 3.0, -1.0, 2.0, 4.0, 3.0, 3.0, 1.0, 2.0, 4.0, 3.0]);
        let polygons = good.to_polygons(4, Progress::none()).unwrap();
        let cells: Vec<&[u32]> = polygons.iter().collect();
        assert_eq!(cells, [&[0_u32, 1, 2][..], &[1, 3, 2], &[0, 1, 3, 2]]);
        for (numbers, message) in [
            ([1.0, 2.0, -1.0, -1.0], "has 2 corners"),
            ([1.0, 2.0, 5.0, -1.0], "names corner 5, but they are 1 to 4"),
            ([0.0, 2.0, 3.0, -1.0], "names corner 0"),
            ([1.0, 2.0, 3.0, 2.0], "names corner 2 twice"),
        ] {
            let error = table(&numbers).to_polygons(4, Progress::none()).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn the_dual_of_a_grid_is_a_grid() {
        // 4 × 3 cells whose corners are in either order.
        let (m, n) = (4_u32, 3_u32);
        let nodes: Vec<[f64; 3]> =
            (0..=n).flat_map(|y| (0..=m).map(move |x| [f64::from(x), f64::from(y), 0.0])).collect();
        let mut corners = Polygons::new();
        let mut centers = Vec::new();
        for y in 0..n {
            for x in 0..m {
                let a = y * (m + 1) + x;
                let mut cell = [a, a + 1, a + m + 2, a + m + 1];
                if (x + y) % 2 == 0 {
                    cell.reverse();
                }
                corners.push(&cell);
                centers.push([f64::from(x) + 0.5, f64::from(y) + 0.5, 0.0]);
            }
        }
        let cells = MeshCells { nodes, corners, centers };
        let faces = cells.dual_faces(false, Progress::none()).unwrap();
        assert_eq!(faces.len() as u32, (m - 1) * (n - 1));
        for face in faces.iter() {
            let at = |k: usize| cells.centers[face[k % 4] as usize];
            let area: f64 = (0..4).map(|k| 0.5 * (at(k)[0] * at(k + 1)[1] - at(k)[1] * at(k + 1)[0])).sum();
            assert!((area - 1.0).abs() < 1e-14);
        }
    }
}
