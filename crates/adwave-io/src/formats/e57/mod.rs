//! ASTM E57: scans of laser scanners, read by the crate `e57`.
//!
//! The crate checks the sums of all pages and unpacks the records. What it does not check is checked here, before it reads a record:
//! ranges of whole numbers that are upside down (it panics), scans whose records take no bits at all (it does not end), and streams of
//! which one runs ahead of the others (its queues grow without bound).

pub(crate) mod read;
pub(crate) mod record;
