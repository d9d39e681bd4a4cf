//! LZF decompression, as binary_compressed PCD uses it.
//!
//! Thirty lines here instead of a library: those on crates.io trust the stated length or are not kept up.

use adwave::{Cancelled, Progress};

use crate::progress::at_row;

/// The `n` bytes that `packed` holds, or the position in `packed` where it is wrong.
pub(crate) fn decompress(
    packed: &[u8],
    n: usize,
    progress: Progress<'_>,
) -> Result<Result<Vec<u8>, usize>, Cancelled> {
    let mut plain = Vec::with_capacity(n);
    let (mut i, mut block) = (0, 0);
    while i < packed.len() {
        at_row(progress, block, 0)?;
        block += 1;
        if let Err(at) = step(packed, n, &mut plain, &mut i) {
            return Ok(Err(at));
        }
    }
    Ok(if plain.len() == n { Ok(plain) } else { Err(i) })
}

/// Adds what one literal or reference stands for.
fn step(packed: &[u8], n: usize, plain: &mut Vec<u8>, position: &mut usize) -> Result<(), usize> {
    let mut i = *position;
    let control = packed[i] as usize;
    i += 1;
    if control < 32 {
        let literal = packed.get(i..i + control + 1).ok_or(i)?;
        plain.extend_from_slice(literal);
        i += control + 1;
    } else {
        let mut length = control >> 5;
        if length == 7 {
            length += *packed.get(i).ok_or(i)? as usize;
            i += 1;
        }
        let low = *packed.get(i).ok_or(i)? as usize;
        i += 1;
        let back = ((control & 31) << 8) + low + 1;
        let from = plain.len().checked_sub(back).ok_or(i)?;
        for k in from..from + length + 2 {
            plain.push(plain[k]);
        }
    }
    *position = i;
    if plain.len() > n { Err(i) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use adwave::Progress;

    fn decompress(packed: &[u8], n: usize) -> Result<Vec<u8>, usize> {
        super::decompress(packed, n, Progress::none()).unwrap()
    }

    #[test]
    fn literals_and_references() {
        // Three literal bytes, then six bytes from three back, which overlap what they write.
        assert_eq!(decompress(&[2, b'a', b'b', b'c', 4 << 5, 2], 9).unwrap(), b"abcabcabc");
        assert!(decompress(&[2, b'a'], 3).is_err(), "cut literal");
        assert!(decompress(&[0, b'a', 1 << 5, 9], 4).is_err(), "reference before the start");
        assert!(decompress(&[0, b'a'], 2).is_err(), "too short");
    }
}
