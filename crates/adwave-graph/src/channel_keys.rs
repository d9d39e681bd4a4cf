//! Numbers by the content of rows and channels, which do not depend on their order.

use crate::CountMatrix;
use rayon::prelude::*;

/// Rows whose numbers a thread computes at a time.
const ROWS_AT_A_TIME: usize = 1 << 12;

/// The finalizer of SplitMix64 (`steele2014`).
pub(crate) fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A number for each channel by its values in all rows, whatever the order of the rows and channels.
pub(crate) fn channel_keys(counts: &CountMatrix<'_>) -> Vec<u64> {
    row_and_channel_keys(counts).1
}

/// A number for each row by its values, and for each channel by its values in the rows.
///
/// Values of a channel are mixed with the number of their row, so that channels with the same values in another order
/// differ.
pub(crate) fn row_and_channel_keys(counts: &CountMatrix<'_>) -> (Vec<u64>, Vec<u64>) {
    let n = counts.n_rows();
    let part = |first: usize| {
        let mut channels = vec![0_u64; counts.n_channels];
        let mut values: Vec<(usize, u64)> = Vec::new();
        let rows = (first..(first + ROWS_AT_A_TIME).min(n)).map(|x| {
            values.clear();
            values.extend(counts.entries(x).map(|(c, v)| (c, mix(v.to_bits()))));
            let key = mix(values.iter().fold(0_u64, |sum, &(_, bits)| sum.wrapping_add(bits)));
            for &(c, bits) in &values {
                channels[c] = channels[c].wrapping_add(mix(bits ^ key));
            }
            key
        });
        (rows.collect::<Vec<u64>>(), channels)
    };
    let parts: Vec<_> = (0..n).into_par_iter().step_by(ROWS_AT_A_TIME).map(part).collect();
    let (mut rows, mut channels) = (Vec::with_capacity(n), vec![0_u64; counts.n_channels]);
    for (own_rows, own_channels) in parts {
        rows.extend(own_rows);
        channels.iter_mut().zip(own_channels).for_each(|(sum, own)| *sum = sum.wrapping_add(own));
    }
    (rows, channels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CountValues;

    #[test]
    fn keys_follow_their_rows_and_channels_into_another_order() {
        let values = [1.0, 0.0, 2.0, 4.0, 2.0, 0.0, 3.0, 3.0, 1.0];
        let moved: Vec<f64> = [2, 0, 1].iter().flat_map(|x| [1, 2, 0].map(|c| values[x * 3 + c])).collect();
        let keys = |values: &[f64]| {
            row_and_channel_keys(&CountMatrix { values: CountValues::Dense(values), n_channels: 3 })
        };
        let ((rows, channels), (moved_rows, moved_channels)) = (keys(&values), keys(&moved));
        assert_eq!(moved_rows, [rows[2], rows[0], rows[1]]);
        assert_eq!(moved_channels, [channels[1], channels[2], channels[0]]);
        assert!(channels[0] != channels[1] && rows[0] != rows[1] && rows[1] != rows[2]);
    }
}
