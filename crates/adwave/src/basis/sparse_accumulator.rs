//! A set of vertices that lists its members in order, at a cost that grows with the set and barely with the shape.

/// One bit per vertex, and one bit per nonempty word of those bits.
#[derive(Debug, Default)]
pub(super) struct SparseAccumulator {
    words: Vec<u64>,
    summary: Vec<u64>,
}

impl SparseAccumulator {
    /// An empty set over the vertices `0..n`.
    pub(super) fn new(n: usize) -> Self {
        let n_words = n.div_ceil(64);
        Self { words: vec![0; n_words], summary: vec![0; n_words.div_ceil(64)] }
    }

    /// Adds `x`; returns true if it was not in the set.
    #[inline]
    pub(super) fn insert(&mut self, x: u32) -> bool {
        let at = x as usize / 64;
        let bit = 1_u64 << (x % 64);
        if self.words[at] & bit != 0 {
            return false;
        }
        self.words[at] |= bit;
        self.summary[at / 64] |= 1 << (at % 64);
        true
    }

    /// Appends the members to `out` in ascending order and clears the set.
    pub(super) fn drain_sorted(&mut self, out: &mut Vec<u32>) {
        for (s, summary) in self.summary.iter_mut().enumerate() {
            while *summary != 0 {
                let at = 64 * s + summary.trailing_zeros() as usize;
                *summary &= *summary - 1;
                let mut word = std::mem::take(&mut self.words[at]);
                while word != 0 {
                    out.push((64 * at) as u32 + word.trailing_zeros());
                    word &= word - 1;
                }
            }
        }
    }
}
