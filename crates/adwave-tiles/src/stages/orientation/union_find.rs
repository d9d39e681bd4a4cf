//! Union-find with parity.

/// Disjoint groups of points; each point has a parity relative to the root of its group. Here it tells whether their normals point to
/// opposite sides.
pub(super) struct UnionFindParity {
    parent: Vec<u32>,
    size: Vec<u32>,
    /// Parity relative to the parent.
    parity: Vec<bool>,
}

impl UnionFindParity {
    pub(super) fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), size: vec![1; n], parity: vec![false; n] }
    }

    /// The root of a point's group, and the parity of the point relative to it. Compresses the path.
    pub(super) fn find(&mut self, x: u32) -> (u32, bool) {
        let (mut root, mut parity) = (x, false);
        while self.parent[root as usize] != root {
            parity ^= self.parity[root as usize];
            root = self.parent[root as usize];
        }
        let (mut at, mut remaining) = (x, parity);
        while self.parent[at as usize] != root {
            let (parent, step) = (self.parent[at as usize], self.parity[at as usize]);
            self.parent[at as usize] = root;
            self.parity[at as usize] = remaining;
            remaining ^= step;
            at = parent;
        }
        (root, parity)
    }

    /// Joins the groups of x and y, whose parities differ if `flips`. Returns the new root and the root that was joined to it, or `None`
    /// if they were in one group.
    pub(super) fn join(&mut self, x: u32, y: u32, flips: bool) -> Option<[u32; 2]> {
        let ((a, parity_x), (b, parity_y)) = (self.find(x), self.find(y));
        if a == b {
            return None;
        }
        let (root, child) = if self.size[a as usize] < self.size[b as usize] { (b, a) } else { (a, b) };
        self.parent[child as usize] = root;
        self.size[root as usize] += self.size[child as usize];
        self.parity[child as usize] = parity_x ^ parity_y ^ flips;
        Some([root, child])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parities_are_relative_within_a_group() {
        let mut groups = UnionFindParity::new(6);
        assert!(groups.join(0, 1, true).is_some());
        assert!(groups.join(2, 3, false).is_some());
        assert!(groups.join(1, 3, true).is_some());
        assert!(groups.join(0, 2, true).is_none()); // in one group already: ignored
        assert!(groups.join(4, 3, true).is_some());
        let (root, _) = groups.find(0);
        let parities: Vec<bool> = (0..5).map(|x| groups.find(x).1).collect();
        let relative_to_0: Vec<bool> = parities.iter().map(|p| p ^ parities[0]).collect();
        assert_eq!(relative_to_0, [false, true, false, false, true]);
        assert!((0..5).all(|x| groups.find(x).0 == root) && groups.find(5).0 == 5);
    }
}
