//! Identity of a format.

use std::fmt;

/// A format of shapes. Binary and text forms that share a file ending are formats of their own.
///
/// Constants such as [`Format::PLY`] stand in the folder of their format, beside the description of all that it can do.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Format(&'static str);

impl Format {
    /// The format of that name, which one descriptor of the table has.
    pub(crate) const fn new(name: &'static str) -> Self {
        Self(name)
    }

    /// The name on the command line and in messages: `ply-ascii`.
    pub fn name(self) -> &'static str {
        self.0
    }
}

impl fmt::Debug for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}
