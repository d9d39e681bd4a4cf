//! Nodes of an octree, and their selection from a hierarchy in pages.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use adwave::Progress;

use crate::ReadError;
use crate::formats::las::part::selection::Selection;

/// Finest level: node coordinates are signed 32-bit numbers in the files.
pub(super) const MOST_DEPTH: u32 = 30;
/// Fraction of the root's side by which cubes are enlarged, as a margin for rounding.
const SLACK: f64 = 1e-9;

/// Node: its level, and its position among the 2^level cubes along each axis. Ordered by these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key {
    pub(super) depth: u32,
    pub(super) place: [u32; 3],
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.place;
        write!(f, "{}-{x}-{y}-{z}", self.depth)
    }
}

impl Key {
    pub(super) const ROOT: Self = Self { depth: 0, place: [0; 3] };

    /// Creates the node with these numbers; `None` if they are invalid.
    pub(super) fn new([depth, place @ ..]: [i64; 4]) -> Option<Self> {
        let depth = u32::try_from(depth).ok().filter(|&depth| depth <= MOST_DEPTH)?;
        if place.iter().any(|n| !(0..1 << depth).contains(n)) {
            return None;
        }
        Some(Self { depth, place: place.map(|n| n as u32) })
    }

    /// True if this is `other` or a descendant of it.
    fn is_within(self, other: Self) -> bool {
        let up = self.depth.checked_sub(other.depth);
        up.is_some_and(|up| self.place.map(|n| n >> up) == other.place)
    }
}

/// Box of the root, and the distance of its points.
pub(super) struct Root {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    pub(super) spacing: f64,
    /// Largest distance of points from their nodes because of rounding.
    pub(super) rounding: [f64; 3],
}

impl Root {
    /// True if the numbers describe an octree.
    pub(super) fn is_valid(&self) -> bool {
        let is_length = |x: f64| x.is_finite() && x > 0.0;
        (0..3).all(|a| self.low[a].is_finite() && is_length(self.high[a] - self.low[a]))
            && is_length(self.spacing)
    }

    /// True if points of the node may be selected.
    fn is_wanted(&self, key: Key, selection: &Selection) -> bool {
        let side = [0, 1, 2].map(|a| self.high[a] - self.low[a]);
        let share = 0.5_f64.powi(key.depth as i32);
        let corner =
            |more: u32| [0, 1, 2].map(|a| self.low[a] + side[a] * share * f64::from(key.place[a] + more));
        let slack = [0, 1, 2].map(|a| SLACK * side[a] + self.rounding[a].abs());
        selection.meets(corner(0), corner(1), slack)
    }
}

/// Hierarchy entry of a node: its number of points and their location, or (−1) the location of the page with the
/// node.
pub(super) struct Entry<P> {
    pub(super) key: Key,
    pub(super) count: i64,
    pub(super) place: P,
}

/// Node with points.
pub(super) struct Node<P> {
    pub(super) key: Key,
    pub(super) n_points: u64,
    pub(super) place: P,
}

/// Nodes whose points may be selected, in order, from the page at `first` on. Pages of other nodes are not read.
pub(super) fn chosen<P: Copy>(
    root: &Root,
    selection: &Selection,
    most_points: u64,
    first: P,
    mut page: impl FnMut(Key, P) -> Result<Vec<Entry<P>>, ReadError>,
    progress: Progress<'_>,
) -> Result<Vec<Node<P>>, ReadError> {
    let depth = selection.depth(root.spacing);
    let (mut nodes, mut named) = (BTreeMap::new(), BTreeSet::from([Key::ROOT]));
    let mut waiting = vec![(Key::ROOT, first)];
    let mut left = most_points;
    while let Some((own, place)) = waiting.pop() {
        progress.check()?;
        for entry in page(own, place)? {
            let Entry { key, count, place } = entry;
            if !key.is_within(own) {
                return Err(wrong(key, &format!("is listed below {own}, but is not a descendant")));
            }
            if count < -1 {
                return Err(wrong(key, &format!("has {count} points")));
            }
            if count == 0 || key.depth > depth || !root.is_wanted(key, selection) {
                continue;
            }
            if count == -1 {
                if !named.insert(key) {
                    return Err(wrong(key, "has two lists, or a list that refers back to itself"));
                }
                waiting.push((key, place));
                continue;
            }
            let n_points = count.unsigned_abs();
            let rest = left.checked_sub(n_points);
            left = rest.ok_or_else(|| {
                wrong(key, &format!("and the previous nodes exceed the {most_points} points of the cloud"))
            })?;
            if nodes.insert(key, Node { key, n_points, place }).is_some() {
                return Err(wrong(key, "is listed twice"));
            }
        }
    }
    Ok(nodes.into_values().collect())
}

/// Creates an error of the hierarchy.
pub(super) fn wrong(key: Key, what: &str) -> ReadError {
    ReadError::Whole(format!("the hierarchy is damaged: node {key} {what}; get an undamaged file"))
}

/// Splits nodes into runs of at most `most` nodes with a total size of at most `most_bytes`; a larger node forms a
/// run of its own.
pub(super) fn runs<P>(
    nodes: &[Node<P>],
    most: usize,
    most_bytes: u64,
    size: impl Fn(&Node<P>) -> u64,
) -> Vec<&[Node<P>]> {
    let (mut runs, mut start, mut sum) = (Vec::new(), 0, 0_u64);
    for (k, node) in nodes.iter().enumerate() {
        let more = sum.saturating_add(size(node));
        if k > start && (k - start >= most || more > most_bytes) {
            runs.push(&nodes[start..k]);
            (start, sum) = (k, size(node));
        } else {
            sum = more;
        }
    }
    if start < nodes.len() {
        runs.push(&nodes[start..]);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(numbers: [i64; 4]) -> Key {
        Key::new(numbers).unwrap()
    }

    #[test]
    fn nodes_are_named_ordered_and_nested() {
        assert_eq!(Key::new([2, 3, 4, 0]), None);
        assert_eq!(Key::new([2, -1, 0, 0]), None);
        assert_eq!(Key::new([i64::from(MOST_DEPTH) + 1, 0, 0, 0]), None);
        assert_eq!(key([2, 3, 0, 1]).to_string(), "2-3-0-1");
        assert!(key([2, 3, 0, 1]).is_within(key([1, 1, 0, 0])));
        assert!(!key([2, 3, 0, 1]).is_within(key([1, 0, 0, 0])));
        assert!(!Key::ROOT.is_within(key([1, 0, 0, 0])));
        assert!(key([1, 1, 1, 1]) < key([2, 0, 0, 0]) && key([2, 0, 1, 0]) < key([2, 1, 0, 0]));
    }

    #[test]
    fn the_nodes_of_a_box_are_those_whose_cubes_touch_it() {
        let root = Root { low: [0.0; 3], high: [8.0; 3], spacing: 1.0, rounding: [0.0; 3] };
        let part = crate::CloudPart::default().with_bounds([4.0; 3], [5.0; 3]).with_resolution(0.5);
        let selection = Selection::of(&part).unwrap();
        let all = |own: Key, ()| {
            assert_eq!(own, Key::ROOT);
            let levels = (0..4_i64).flat_map(|d| (0..1 << d).map(move |n| key([d, n, n, n])));
            Ok(levels.map(|key| Entry { key, count: 1, place: () }).collect())
        };
        let nodes = chosen(&root, &selection, 100, (), all, Progress::none()).unwrap();
        let names: Vec<_> = nodes.iter().map(|node| node.key.to_string()).collect();
        assert_eq!(names, ["0-0-0-0", "1-0-0-0", "1-1-1-1"]);
        assert!(chosen(&root, &selection, 2, (), all, Progress::none()).is_err());
    }

    #[test]
    fn runs_keep_to_numbers_and_sizes() {
        let node = |n_points| Node { key: Key::ROOT, n_points, place: () };
        let nodes: Vec<_> = [1, 1, 1, 9, 1, 2].into_iter().map(node).collect();
        let lengths = |most, bytes| -> Vec<usize> {
            runs(&nodes, most, bytes, |node| node.n_points).iter().map(|run| run.len()).collect()
        };
        assert_eq!(lengths(2, 100), [2, 2, 2]);
        assert_eq!(lengths(9, 3), [3, 1, 2]);
        assert!(runs(&nodes[..0], 2, 2, |_| 1).is_empty());
    }
}
