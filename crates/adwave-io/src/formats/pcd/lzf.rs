//! LZF compression of binary_compressed PCD.
//!
//! The implementation is our own, because the crates either trust the stated length or are unmaintained.

use adwave::{Cancelled, Progress};

use crate::progress::at_row;

/// Decompresses `n` bytes; the error is the position in `packed` at which it is invalid.
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

/// Decodes one literal run or reference.
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

/// Compresses bytes with references to the last position of the next three bytes, found in a hash table.
pub(crate) fn compress(plain: &[u8], progress: Progress<'_>) -> Result<Vec<u8>, Cancelled> {
    const BITS: u32 = 14;
    /// Longest distance and longest run of a reference.
    const BACK: usize = 1 << 13;
    const LONGEST: usize = 264;
    let mut places = vec![usize::MAX; 1 << BITS];
    let mut packed = Vec::with_capacity(plain.len() / 2 + 64);
    let (mut i, mut literal, mut block) = (0, 0, 0);
    while i + 2 < plain.len() {
        at_row(progress, block, 0)?;
        block += 1;
        let three = u32::from_le_bytes([plain[i], plain[i + 1], plain[i + 2], 0]);
        let slot = &mut places[(three.wrapping_mul(0x9e37_79b1) >> (32 - BITS)) as usize];
        let from = std::mem::replace(slot, i);
        let is_same = from < i && i - from <= BACK && plain[from..from + 3] == plain[i..i + 3];
        if !is_same {
            i += 1;
            continue;
        }
        let most = LONGEST.min(plain.len() - i);
        let n = (3..most).find(|&k| plain[from + k] != plain[i + k]).unwrap_or(most);
        push_literals(&plain[literal..i], &mut packed);
        let (back, length) = (i - from - 1, n - 2);
        if length < 7 {
            packed.push(((length << 5) | (back >> 8)) as u8);
        } else {
            packed.extend([((7 << 5) | (back >> 8)) as u8, (length - 7) as u8]);
        }
        packed.push(back as u8);
        i += n;
        literal = i;
    }
    push_literals(&plain[literal..], &mut packed);
    Ok(packed)
}

fn push_literals(bytes: &[u8], packed: &mut Vec<u8>) {
    for run in bytes.chunks(32) {
        packed.push(run.len() as u8 - 1);
        packed.extend_from_slice(run);
    }
}

#[cfg(test)]
mod tests {
    use adwave::Progress;

    fn decompress(packed: &[u8], n: usize) -> Result<Vec<u8>, usize> {
        super::decompress(packed, n, Progress::none()).unwrap()
    }

    #[test]
    fn literals_and_references() {
        // Three literal bytes, then six bytes from three back, which overlap the output.
        assert_eq!(decompress(&[2, b'a', b'b', b'c', 4 << 5, 2], 9).unwrap(), b"abcabcabc");
        assert!(decompress(&[2, b'a'], 3).is_err(), "cut literal");
        assert!(decompress(&[0, b'a', 1 << 5, 9], 4).is_err(), "reference before the start");
        assert!(decompress(&[0, b'a'], 2).is_err(), "too short");
    }

    proptest::proptest! {
        #[test]
        fn what_is_packed_comes_back(
            parts in proptest::collection::vec((proptest::collection::vec(0_u8..4, 1..9), 1..200_usize), 0..40)
        ) {
            let plain: Vec<u8> = parts.iter().flat_map(|(part, n)| part.repeat(*n)).collect();
            let packed = super::compress(&plain, Progress::none()).unwrap();
            assert_eq!(decompress(&packed, plain.len()).unwrap(), plain);
        }
    }

    #[test]
    fn runs_shrink() {
        let packed = super::compress(&vec![7; 10_000], Progress::none()).unwrap();
        assert!(packed.len() < 200, "{}", packed.len());
    }
}
