//! Descriptions of places in words, and patches of connected vertices.

use super::Subject;
use adwave_render::Up;

/// Share of the longest side up to which the extent along an axis is too small for words about this axis.
const FLAT: f64 = 0.05;

/// Describer of positions on a shape, as seen from its front.
pub(super) struct Places {
    low: [f64; 3],
    high: [f64; 3],
    /// Axis and direction (1 or −1) of up, right and toward the viewer.
    axes: [(usize, f64); 3],
}

impl Places {
    /// Prepares the descriptions; `None` for a shape without positions.
    pub(super) fn new(subject: &Subject<'_>, up: Up) -> Option<Self> {
        let (low, high) = adwave::shape::bounding_box(subject.shape.points()?)?;
        let axes = match up {
            Up::X => [(0, 1.0), (1, 1.0), (2, -1.0)],
            Up::Y => [(1, 1.0), (0, 1.0), (2, 1.0)],
            Up::Z => [(2, 1.0), (0, 1.0), (1, -1.0)],
        };
        Some(Self { low, high, axes })
    }

    /// Names the third of the bounding box that a point is in, such as `top, left, front`; middle thirds are omitted.
    pub(super) fn words(&self, p: &[f64; 3]) -> String {
        const NAMES: [[&str; 2]; 3] = [["bottom", "top"], ["left", "right"], ["back", "front"]];
        let size = |k: usize| self.high[k] - self.low[k];
        let longest = (0..3).map(size).fold(0.0, f64::max);
        let words: Vec<&str> = self
            .axes
            .iter()
            .zip(NAMES)
            .filter(|((axis, _), _)| size(*axis) > FLAT * longest)
            .filter_map(|(&(axis, sign), [less, more])| {
                let t = (p[axis] - self.low[axis]) / size(axis) - 0.5;
                match sign * t {
                    t if t < -1.0 / 6.0 => Some(less),
                    t if t > 1.0 / 6.0 => Some(more),
                    _ => None,
                }
            })
            .collect();
        if words.is_empty() { "middle".to_owned() } else { words.join(", ") }
    }
}

/// Connected set of welded vertices.
pub(super) struct Patch {
    /// Vertex with the largest value.
    pub(super) peak: usize,
    /// Number of vertices.
    pub(super) n_vertices: usize,
    /// Sum of the values.
    pub(super) sum: f64,
}

/// Finds the patches of welded vertices whose values exceed a threshold, the patch with the largest sum first.
pub(super) fn patches(subject: &Subject<'_>, values: &[f64], threshold: f64) -> Vec<Patch> {
    let neighbors = subject.decomposer.neighbors();
    let mut unvisited: Vec<bool> = values.iter().map(|&v| v > threshold).collect();
    let mut found = Vec::new();
    for first in 0..values.len() {
        if !unvisited[first] {
            continue;
        }
        unvisited[first] = false;
        let mut stack = vec![first];
        let mut patch = Patch { peak: first, n_vertices: 0, sum: 0.0 };
        while let Some(x) = stack.pop() {
            patch.n_vertices += 1;
            patch.sum += values[x];
            if values[x] > values[patch.peak] {
                patch.peak = x;
            }
            for &y in neighbors.row(x) {
                if std::mem::take(&mut unvisited[y as usize]) {
                    stack.push(y as usize);
                }
            }
        }
        found.push(patch);
    }
    found.sort_by(|a, b| b.sum.total_cmp(&a.sum));
    found
}

/// First vertex of the shape that belongs to a welded vertex.
pub(super) fn vertex_of(subject: &Subject<'_>, class: usize) -> usize {
    let classes = subject.decomposer.vertex_map().as_slice();
    classes.iter().position(|&c| c as usize == class).unwrap_or(class)
}
