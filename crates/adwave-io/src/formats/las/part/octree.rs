//! Nodes of an octree, and the choice among those that a hierarchy in pages lists.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use adwave::Progress;

use crate::ReadError;
use crate::formats::las::part::selection::Selection;

/// The finest level: places of nodes are signed 32-bit numbers in the files.
pub(super) const MOST_DEPTH: u32 = 30;
/// Share of the root's side by which cubes are taken larger than they are, against rounding.
const SLACK: f64 = 1e-9;

/// A node: its level, and which of the 2^level cubes along each axis it is. Ordered by these.
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

    /// The node of these numbers; `None` where there is none such.
    pub(super) fn new([depth, place @ ..]: [i64; 4]) -> Option<Self> {
        let depth = u32::try_from(depth).ok().filter(|&depth| depth <= MOST_DEPTH)?;
        if place.iter().any(|n| !(0..1 << depth).contains(n)) {
            return None;
        }
        Some(Self { depth, place: place.map(|n| n as u32) })
    }

    /// Whether it is `other` or lies below it.
    fn is_within(self, other: Self) -> bool {
        let up = self.depth.checked_sub(other.depth);
        up.is_some_and(|up| self.place.map(|n| n >> up) == other.place)
    }
}

/// The box of the root, and how far apart its points are.
pub(super) struct Root {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    pub(super) spacing: f64,
    /// How far from their nodes points may lie because they were rounded.
    pub(super) rounding: [f64; 3],
}

impl Root {
    /// Whether the numbers can be those of an octree.
    pub(super) fn is_valid(&self) -> bool {
        let is_length = |x: f64| x.is_finite() && x > 0.0;
        (0..3).all(|a| self.low[a].is_finite() && is_length(self.high[a] - self.low[a]))
            && is_length(self.spacing)
    }

    /// Whether points of the node may be wanted.
    fn is_wanted(&self, key: Key, selection: &Selection) -> bool {
        let side = [0, 1, 2].map(|a| self.high[a] - self.low[a]);
        let share = 0.5_f64.powi(key.depth as i32);
        let corner =
            |more: u32| [0, 1, 2].map(|a| self.low[a] + side[a] * share * f64::from(key.place[a] + more));
        let slack = [0, 1, 2].map(|a| SLACK * side[a] + self.rounding[a].abs());
        selection.meets(corner(0), corner(1), slack)
    }
}

/// What a hierarchy says of a node: how many points it has and where they are, or (−1) where the page is that lists it.
pub(super) struct Entry<P> {
    pub(super) key: Key,
    pub(super) count: i64,
    pub(super) place: P,
}

/// A node that has points.
pub(super) struct Node<P> {
    pub(super) key: Key,
    pub(super) n_points: u64,
    pub(super) place: P,
}

/// The nodes whose points may be wanted, in their order, from the page at `first` on. Pages of other nodes are not read.
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
                return Err(wrong(key, &format!("is listed below {own}, where it does not lie")));
            }
            if count < -1 {
                return Err(wrong(key, &format!("has {count} points")));
            }
            if count == 0 || key.depth > depth || !root.is_wanted(key, selection) {
                continue;
            }
            if count == -1 {
                if !named.insert(key) {
                    return Err(wrong(key, "has two lists, or one that leads back to itself"));
                }
                waiting.push((key, place));
                continue;
            }
            let n_points = count.unsigned_abs();
            let rest = left.checked_sub(n_points);
            left = rest.ok_or_else(|| {
                wrong(
                    key,
                    &format!("and those before it have more points than the {most_points} of the cloud"),
                )
            })?;
            if nodes.insert(key, Node { key, n_points, place }).is_some() {
                return Err(wrong(key, "is listed twice"));
            }
        }
    }
    Ok(nodes.into_values().collect())
}

/// An error of the hierarchy.
pub(super) fn wrong(key: Key, what: &str) -> ReadError {
    ReadError::Whole(format!("the hierarchy is broken: node {key} {what}; get an unbroken file"))
}

/// Splits nodes into runs of at most `most` nodes whose sizes sum to at most `most_bytes`, or of one node.
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
