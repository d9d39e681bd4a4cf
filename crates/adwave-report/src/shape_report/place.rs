//! Places in words, and patches of vertices that hang together.

use super::Subject;
use adwave_render::Up;

/// An axis along which a shape is this part of its diagonal, or less, is not spoken of.
const FLAT: f64 = 0.05;

/// Where points are on a shape, as seen from its front.
pub(super) struct Places {
    low: [f64; 3],
    high: [f64; 3],
    /// Up, right, and toward the viewer: the axis, and 1 or −1 for its direction.
    axes: [(usize, f64); 3],
}

impl Places {
    /// None for a shape without positions.
    pub(super) fn new(subject: &Subject<'_>, up: Up) -> Option<Self> {
        let (low, high) = adwave::shape::bounding_box(subject.shape.points()?)?;
        let axes = match up {
            Up::X => [(0, 1.0), (1, 1.0), (2, -1.0)],
            Up::Y => [(1, 1.0), (0, 1.0), (2, 1.0)],
            Up::Z => [(2, 1.0), (0, 1.0), (1, -1.0)],
        };
        Some(Self { low, high, axes })
    }

    /// `top, left, front`: in which third of the bounding box a point is, without the middle thirds.
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

/// Welded vertices that hang together over its edges.
pub(super) struct Patch {
    /// The one with the largest value.
    pub(super) peak: usize,
    /// How many there are.
    pub(super) n_vertices: usize,
    /// The sum of their values.
    pub(super) sum: f64,
}

/// The patches of welded vertices whose value is above a threshold, that with the largest sum first.
pub(super) fn patches(subject: &Subject<'_>, values: &[f64], threshold: f64) -> Vec<Patch> {
    let neighbors = subject.decomposer.neighbors();
    let mut waiting: Vec<bool> = values.iter().map(|&v| v > threshold).collect();
    let mut found = Vec::new();
    for first in 0..values.len() {
        if !waiting[first] {
            continue;
        }
        waiting[first] = false;
        let mut stack = vec![first];
        let mut patch = Patch { peak: first, n_vertices: 0, sum: 0.0 };
        while let Some(x) = stack.pop() {
            patch.n_vertices += 1;
            patch.sum += values[x];
            if values[x] > values[patch.peak] {
                patch.peak = x;
            }
            for &y in neighbors.row(x) {
                if std::mem::take(&mut waiting[y as usize]) {
                    stack.push(y as usize);
                }
            }
        }
        found.push(patch);
    }
    found.sort_by(|a, b| b.sum.total_cmp(&a.sum));
    found
}

/// The first vertex of the shape that is this welded vertex.
pub(super) fn vertex_of(subject: &Subject<'_>, class: usize) -> usize {
    let classes = subject.decomposer.geometry().vertex_map().as_slice();
    classes.iter().position(|&c| c as usize == class).unwrap_or(class)
}
