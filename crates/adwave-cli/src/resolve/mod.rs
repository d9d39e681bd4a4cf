//! From flags to the objects that they stand for: the shape, the signal on it, the operator, the levels, a region, the
//! axis that points up.

pub(crate) mod applicable;
pub(crate) mod brain;
pub(crate) mod levels;
pub(crate) mod operator;
pub(crate) mod pose;
pub(crate) mod quantity;
pub(crate) mod region;
pub(crate) mod shape;
pub(crate) mod signal;
pub(crate) mod time;
pub(crate) mod turned;
pub(crate) mod up;
pub(crate) mod walk;
