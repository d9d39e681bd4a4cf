//! Lengths with the options that give them.

use adwave::region::Length;

/// A length that an option of the command line gives.
#[derive(Clone, Copy)]
pub(crate) struct GivenLength {
    /// The option, such as `--lengths`.
    pub(crate) option: &'static str,
    pub(crate) length: Length,
}
