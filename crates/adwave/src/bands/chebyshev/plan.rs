//! Passes of an evaluation.

/// Target degree of each pass of an evaluation. A series is inspected between passes to find where to truncate it.
/// Series evaluated in two calls get the bits of a single call if the second call takes the same passes as the
/// first.
#[derive(Debug, Default)]
pub(crate) struct PassPlan {
    /// Highest degree requested for each pass, for each block of channels.
    highest: Vec<Vec<usize>>,
    call: CallOrder,
}

/// Order of the call that takes the passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum CallOrder {
    #[default]
    First,
    Second,
    /// The second call needs terms that the first did not, so a single call would have taken other passes.
    Differs,
}

impl PassPlan {
    /// Marks the next call as the second.
    pub(crate) fn repeat(&mut self) {
        self.call = CallOrder::Second;
    }

    /// True if the second call gave up.
    pub(crate) fn differ(&self) -> bool {
        self.call == CallOrder::Differs
    }

    /// Target degree of a pass in a call that needs terms up to degree `own`; `None` if this does not fit the first
    /// call.
    pub(super) fn aim(&mut self, block: usize, pass: usize, own: usize) -> Option<usize> {
        if self.call == CallOrder::First {
            self.highest.resize(self.highest.len().max(block + 1), Vec::new());
            self.highest[block].push(own);
            return Some(own);
        }
        let first = self.highest[block].get(pass).copied().filter(|&first| own <= first);
        if first.is_none() {
            self.call = CallOrder::Differs;
        }
        first
    }
}
