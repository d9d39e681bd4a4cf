//! Numbers by which the producer of a scan takes points out.

/// Classes of noise: low points, and high noise.
pub const NOISE_CLASSES: [u8; 2] = [7, 18];

/// Bit of the field `classification_flags` of withheld points, in all point formats.
pub const WITHHELD_FLAG: u8 = 4;
