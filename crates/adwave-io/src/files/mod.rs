//! Reading files with a limit, and replacing them as a whole.

pub(crate) mod atomic;
pub(crate) mod positions;
pub(crate) mod read;
