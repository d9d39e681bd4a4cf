//! Places along the curve as stretches of it.

use std::ops::Range;

/// Rising places, numbered from 0.
#[derive(Debug, Default)]
pub(crate) struct Stretches {
    ranges: Vec<Range<usize>>,
    /// The number of the first place of each.
    firsts: Vec<usize>,
}

impl Stretches {
    /// Adds a place after all others.
    pub(crate) fn push(&mut self, place: usize) {
        match self.ranges.last_mut() {
            Some(last) if last.end == place => last.end += 1,
            _ => {
                self.firsts.push(self.len());
                self.ranges.push(place..place + 1);
            }
        }
    }

    /// How many places.
    pub(crate) fn len(&self) -> usize {
        match (self.firsts.last(), self.ranges.last()) {
            (Some(first), Some(range)) => first + range.len(),
            _ => 0,
        }
    }

    pub(crate) fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    /// The place of a number below [`len`](Self::len).
    pub(crate) fn place(&self, number: usize) -> usize {
        let at = self.firsts.partition_point(|&first| first <= number) - 1;
        self.ranges[at].start + number - self.firsts[at]
    }

    /// The number of a place; none where it is not among these.
    pub(crate) fn number(&self, place: usize) -> Option<usize> {
        let at = self.ranges.partition_point(|range| range.start <= place).checked_sub(1)?;
        let range = &self.ranges[at];
        range.contains(&place).then(|| self.firsts[at] + place - range.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_numbers_are_inverse() {
        let places = [3, 4, 5, 9, 11, 12];
        let mut stretches = Stretches::default();
        for place in places {
            stretches.push(place);
        }
        assert_eq!((stretches.len(), stretches.ranges()), (6, [3..6, 9..10, 11..13].as_slice()));
        for (number, &place) in places.iter().enumerate() {
            assert_eq!((stretches.place(number), stretches.number(place)), (place, Some(number)));
        }
        assert!([0, 2, 6, 8, 10, 13].iter().all(|&place| stretches.number(place).is_none()));
    }
}
