//! Surfaces assembled from four-sided patches that share their lines of vertices.

use super::implicit::V3;

/// Height of a row of equilateral triangles relative to their side: √3/2.
const ROW_HEIGHT: f64 = 0.866;
/// Number of chords that measure the length of a row.
const CHORDS: usize = 16;

/// Even number of rows with the height of equilateral triangles over a length.
pub(super) fn count_rows(length: f64, edge: f64) -> usize {
    2 * ((0.5 * length / (ROW_HEIGHT * edge)).round() as usize).max(1)
}

/// Number of segments of about this edge length on a line.
pub(super) fn count_segments(length: f64, edge: f64) -> usize {
    ((length / edge).round() as usize).max(1)
}

/// Orientation of the triangles of a patch: `Left` is counter-clockwise about ∂t × ∂s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    Left,
    Right,
}

impl Turn {
    pub(super) fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// A triangle mesh under construction.
#[derive(Clone, Debug, Default)]
pub(super) struct Weave {
    pub(super) points: Vec<V3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Weave {
    fn point(&mut self, p: V3) -> u32 {
        self.points.push(p);
        u32::try_from(self.points.len() - 1).expect("fewer than 2^32 vertices")
    }

    /// The vertices of a line of `n` segments between two existing vertices, at even parts of [0, 1].
    pub(super) fn line(&mut self, first: u32, last: u32, n: usize, at: impl Fn(f64) -> V3) -> Vec<u32> {
        let mut line = vec![first];
        line.extend((1..n).map(|k| self.point(at(k as f64 / n as f64))));
        line.push(last);
        line
    }

    /// The vertices of a line of `n` segments, ends included.
    pub(super) fn new_line(&mut self, n: usize, at: impl Fn(f64) -> V3) -> Vec<u32> {
        (0..=n).map(|k| self.point(at(k as f64 / n as f64))).collect()
    }

    /// Fills a patch `place(t, s)`, (t, s) in the unit square, with triangles of about equal edges. Its sides are
    /// lines of vertices: s = 0 by rising t, t = 1 by rising s, s = 1 by rising t, t = 0 by rising s. The two sides
    /// of rising s have the same number of vertices, one per row; the others may have any number. The number of
    /// vertices of a row follows its length, and every other row is shifted by half a step.
    pub(super) fn patch(
        &mut self,
        sides: [&Vec<u32>; 4],
        edge: f64,
        turn: Turn,
        place: impl Fn(f64, f64) -> V3,
    ) {
        let [bottom, right, top, left] = sides;
        assert_eq!(left.len(), right.len(), "a row ends on both sides");
        let n_rows = left.len() - 1;
        let mut below = bottom.clone();
        for row in 1..=n_rows {
            let s = row as f64 / n_rows as f64;
            let above = if row == n_rows {
                top.clone()
            } else {
                let on_row = |k: usize| place(k as f64 / CHORDS as f64, s);
                let length: f64 = (0..CHORDS).map(|k| (on_row(k + 1) - on_row(k)).norm()).sum();
                let n = count_segments(length, edge);
                let (shift, count) = if row % 2 == 1 { (0.5, n) } else { (1.0, n - 1) };
                let mut line = vec![left[row]];
                line.extend((0..count).map(|k| self.point(place((k as f64 + shift) / n as f64, s))));
                line.push(right[row]);
                line
            };
            self.zip(&below, &above, turn);
            below = above;
        }
    }

    /// Triangles between two parallel lines, always advancing along the shorter diagonal.
    fn zip(&mut self, below: &[u32], above: &[u32], turn: Turn) {
        let (mut i, mut j) = (0, 0);
        while i + 1 < below.len() || j + 1 < above.len() {
            let apart = |a: u32, b: u32| (self.points[a as usize] - self.points[b as usize]).norm_squared();
            let step_below = if j + 1 == above.len() {
                true
            } else if i + 1 == below.len() {
                false
            } else {
                apart(below[i + 1], above[j]) <= apart(below[i], above[j + 1])
            };
            let next = if step_below { below[i + 1] } else { above[j + 1] };
            let [a, b, c] = [below[i], next, above[j]];
            self.triangles.push(if turn == Turn::Left { [a, b, c] } else { [a, c, b] });
            if step_below { i += 1 } else { j += 1 }
        }
    }
}
