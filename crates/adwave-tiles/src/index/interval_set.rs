//! Sorted sets of vertex indices, stored as intervals.

use std::ops::Range;

/// A set of indices as disjoint ascending intervals. The rank of an index is the number of smaller indices in the set.
#[derive(Debug, Default)]
pub(crate) struct IntervalSet {
    ranges: Vec<Range<usize>>,
    /// Rank of the first index of each interval.
    first_ranks: Vec<usize>,
}

impl IntervalSet {
    /// Adds an index above all others.
    pub(crate) fn push(&mut self, index: usize) {
        match self.ranges.last_mut() {
            Some(last) if last.end == index => last.end += 1,
            _ => {
                self.first_ranks.push(self.len());
                self.ranges.push(index..index + 1);
            }
        }
    }

    /// Number of indices.
    pub(crate) fn len(&self) -> usize {
        match (self.first_ranks.last(), self.ranges.last()) {
            (Some(first), Some(range)) => first + range.len(),
            _ => 0,
        }
    }

    pub(crate) fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// The rank of an index; `None` if it is not in the set.
    pub(crate) fn rank(&self, index: usize) -> Option<usize> {
        let at = self.ranges.partition_point(|range| range.start <= index).checked_sub(1)?;
        let range = &self.ranges[at];
        range.contains(&index).then(|| self.first_ranks[at] + index - range.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_count_the_indices_below() {
        let indices = [3, 4, 5, 9, 11, 12];
        let mut set = IntervalSet::default();
        for index in indices {
            set.push(index);
        }
        assert_eq!((set.len(), set.ranges()), (6, [3..6, 9..10, 11..13].as_slice()));
        for (rank, &index) in indices.iter().enumerate() {
            assert_eq!(set.rank(index), Some(rank));
        }
        assert!([0, 2, 6, 8, 10, 13].iter().all(|&index| set.rank(index).is_none()));
    }
}
