//! A bounding-volume hierarchy over boxes that are ordered along a space-filling curve.

use std::ops::Range;

use crate::bounds::BoundingBox;

/// Number of children of a node.
const FAN_OUT: usize = 16;

/// A tree whose nodes are runs of [`FAN_OUT`] consecutive boxes; consecutive boxes are close to each other along the
/// curve.
#[derive(Debug)]
pub(crate) struct BoundsTree {
    /// The boxes, then the boxes of the nodes of each higher level, up to a single root.
    levels: Vec<Vec<BoundingBox>>,
}

impl BoundsTree {
    pub(crate) fn new(boxes: Vec<BoundingBox>) -> Self {
        let mut levels = vec![boxes];
        while levels[levels.len() - 1].len() > 1 {
            let groups = levels[levels.len() - 1].chunks(FAN_OUT);
            let next = groups.map(|group| BoundingBox::union(group.iter().copied())).collect();
            levels.push(next);
        }
        Self { levels }
    }

    /// Calls `visit` with the index of each box that intersects `bounds` and is not in `excluded`, in ascending order.
    pub(crate) fn visit_intersecting(
        &self,
        bounds: &BoundingBox,
        excluded: &Range<usize>,
        visit: &mut impl FnMut(usize),
    ) {
        self.descend(self.levels.len() - 1, 0, bounds, excluded, visit);
    }

    fn descend(
        &self,
        level: usize,
        first: usize,
        bounds: &BoundingBox,
        excluded: &Range<usize>,
        visit: &mut impl FnMut(usize),
    ) {
        let width = FAN_OUT.pow(level as u32);
        for (i, node) in self.levels[level].iter().enumerate().skip(first).take(FAN_OUT) {
            let is_excluded = excluded.start <= i * width && (i + 1) * width <= excluded.end;
            if is_excluded || !node.intersects(bounds) {
                continue;
            }
            if level > 0 {
                self.descend(level - 1, i * FAN_OUT, bounds, excluded, visit);
            } else {
                visit(i);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_the_boxes_that_a_linear_search_finds() {
        let boxes: Vec<BoundingBox> = (0..1000_u32)
            .map(|i| {
                let at = |salt: u32| f64::from(i.wrapping_mul(2_654_435_761).rotate_left(salt) % 1000);
                let min = [at(3), at(11), at(19)];
                BoundingBox { min, max: min.map(|c| c + f64::from(i % 40)) }
            })
            .collect();
        let tree = BoundsTree::new(boxes.clone());
        for (query, excluded) in [(17, 0..0), (500, 480..700), (999, 0..1000)] {
            let query = boxes[query].expand_by(30.0);
            let expected: Vec<usize> =
                (0..1000).filter(|i| !excluded.contains(i) && boxes[*i].intersects(&query)).collect();
            let mut found = Vec::new();
            tree.visit_intersecting(&query, &excluded, &mut |i| found.push(i));
            assert_eq!(found, expected);
        }
    }
}
