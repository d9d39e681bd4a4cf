//! A search tree over boxes that lie along a curve, so that those with near numbers are near each other.

use std::ops::Range;

/// A box with sides along the axes; the one without points has `lo` above `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) lo: [f64; 3],
    pub(crate) hi: [f64; 3],
}

/// By this part boxes are made wider than lengths say, for the rounding of these.
const ROUNDING: f64 = 1e-9;

impl Bounds {
    pub(crate) const NONE: Self = Self { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    pub(crate) fn include(&mut self, other: &Self) {
        for c in 0..3 {
            self.lo[c] = self.lo[c].min(other.lo[c]);
            self.hi[c] = self.hi[c].max(other.hi[c]);
        }
    }

    pub(crate) fn of(position: [f64; 3]) -> Self {
        Self { lo: position, hi: position }
    }

    /// The box with everything within `radius`, and a little more.
    pub(crate) fn widened(&self, radius: f64) -> Self {
        let more = |c: f64| radius + ROUNDING * (radius + c.abs());
        Self { lo: self.lo.map(|c| c - more(c)), hi: self.hi.map(|c| c + more(c)) }
    }

    pub(crate) fn touches(&self, other: &Self) -> bool {
        (0..3).all(|c| self.lo[c] <= other.hi[c] && other.lo[c] <= self.hi[c])
    }
}

/// Boxes in groups of this many.
const FAN: usize = 16;

/// Boxes and boxes around them.
#[derive(Debug)]
pub(crate) struct BoxTree {
    /// The boxes, then those of groups of the level before, up to a single one.
    levels: Vec<Vec<Bounds>>,
}

impl BoxTree {
    pub(crate) fn new(boxes: Vec<Bounds>) -> Self {
        let mut levels = vec![boxes];
        while levels[levels.len() - 1].len() > 1 {
            let around = |group: &[Bounds]| {
                group.iter().fold(Bounds::NONE, |mut sum, bounds| {
                    sum.include(bounds);
                    sum
                })
            };
            let next = levels[levels.len() - 1].chunks(FAN).map(around).collect();
            levels.push(next);
        }
        Self { levels }
    }

    /// Calls `found` for each box that touches `bounds`, but for those of `without`, by rising number.
    pub(crate) fn touching(&self, bounds: &Bounds, without: &Range<usize>, found: &mut impl FnMut(usize)) {
        self.descend(self.levels.len() - 1, 0, bounds, without, found);
    }

    fn descend(
        &self,
        level: usize,
        first: usize,
        bounds: &Bounds,
        without: &Range<usize>,
        found: &mut impl FnMut(usize),
    ) {
        let width = FAN.pow(level as u32);
        for (i, around) in self.levels[level].iter().enumerate().skip(first).take(FAN) {
            let is_without = without.start <= i * width && (i + 1) * width <= without.end;
            if is_without || !around.touches(bounds) {
                continue;
            }
            if level > 0 {
                self.descend(level - 1, i * FAN, bounds, without, found);
            } else {
                found(i);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_a_look_at_all_boxes_finds() {
        let boxes: Vec<Bounds> = (0..1000_u32)
            .map(|i| {
                let at = |salt: u32| f64::from(i.wrapping_mul(2_654_435_761).rotate_left(salt) % 1000);
                let lo = [at(3), at(11), at(19)];
                Bounds { lo, hi: lo.map(|c| c + f64::from(i % 40)) }
            })
            .collect();
        let tree = BoxTree::new(boxes.clone());
        for (asked, without) in [(17, 0..0), (500, 480..700), (999, 0..1000)] {
            let asked = boxes[asked].widened(30.0);
            let all: Vec<usize> =
                (0..1000).filter(|i| !without.contains(i) && boxes[*i].touches(&asked)).collect();
            let mut found = Vec::new();
            tree.touching(&asked, &without, &mut |i| found.push(i));
            assert_eq!(found, all);
        }
    }
}
