//! Mutations of inputs.

/// Largest size of an input in bytes.
const MAX_BYTES: usize = 1 << 16;

/// Numbers that often expose faults of readers.
const NUMBERS: [&str; 26] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "255",
    "256",
    "-2147483648",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "1e308",
    "-1e308",
    "1e309",
    "5e-324",
    "nan",
    "inf",
    "-inf",
    "1.#IND",
    "0.1",
    "99999999999999999999999999999999999999",
];
const WHOLE: [u64; 18] = [
    0,
    1,
    2,
    3,
    127,
    128,
    255,
    256,
    32767,
    65535,
    65536,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x1_0000_0000,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
];

/// SplitMix64 generator: the same numbers on every machine.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Random number below `n`; 0 if `n` is 0.
    fn next_below(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { (self.next() % n as u64) as usize }
    }

    fn one_of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.next_below(all.len())]
    }

    /// Random range within `n`, usually short, seldom all of it.
    fn range(&mut self, n: usize) -> std::ops::Range<usize> {
        let most = if self.next_below(8) == 0 { n } else { n.min(16) };
        let start = self.next_below(n + 1);
        start..(start + self.next_below(most + 1)).min(n)
    }
}

/// Applies one to eight mutations to one of the inputs.
pub(crate) fn mutate(kept: &[Vec<u8>], words: &[&str], random: &mut Random) -> Vec<u8> {
    let mut bytes = random.one_of(kept).clone();
    for _ in 0..=random.next_below(4) * random.next_below(3) {
        change(&mut bytes, kept, words, random);
        bytes.truncate(MAX_BYTES);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, kept: &[Vec<u8>], words: &[&str], random: &mut Random) {
    let n = bytes.len();
    match random.next_below(16) {
        0 if n > 0 => bytes[random.next_below(n)] ^= 1 << random.next_below(8),
        1 if n > 0 => bytes[random.next_below(n)] = random.next() as u8,
        2 => bytes.truncate(random.next_below(n + 1)),
        3 => drop(bytes.drain(random.range(n))),
        4 => {
            let part = bytes[random.range(n)].to_vec();
            insert(bytes, random.next_below(n + 1), &part);
        }
        5 => {
            let noise: Vec<u8> = (0..random.next_below(9)).map(|_| random.next() as u8).collect();
            insert(bytes, random.next_below(n + 1), &noise);
        }
        6 => {
            // The beginning of one input and the end of another.
            let other = random.one_of(kept);
            let tail = &other[random.next_below(other.len() + 1)..];
            bytes.truncate(random.next_below(n + 1));
            bytes.extend_from_slice(tail);
        }
        7 => {
            let other = random.one_of(kept);
            let part = &other[random.range(other.len())];
            insert(bytes, random.next_below(n + 1), part);
        }
        8 | 9 => number_in_text(bytes, random),
        10 => whole_number(bytes, random),
        11 if !words.is_empty() => {
            let word = random.one_of(words).as_bytes();
            insert(bytes, random.next_below(n + 1), word);
        }
        12 if !words.is_empty() => word_for_word(bytes, words, random),
        13 => {
            // A line is repeated, or another one replaces it.
            let (one, other) = (line(bytes, random.next_below(n + 1)), line(bytes, random.next_below(n + 1)));
            let text = bytes[one].to_vec();
            if random.next_below(2) == 0 {
                insert(bytes, other.start, &text);
            } else {
                bytes.splice(other, text);
            }
        }
        14 => drop(bytes.drain(line(bytes, random.next_below(n + 1)))),
        _ => insert(bytes, random.next_below(n + 1), random.one_of(&NUMBERS).as_bytes()),
    }
}

fn insert(bytes: &mut Vec<u8>, at: usize, part: &[u8]) {
    bytes.splice(at..at, part.iter().copied());
}

/// Range of the line around a position, with its line feed.
fn line(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|&b| b == b'\n').map_or(0, |n| n + 1);
    let end = bytes[at..].iter().position(|&b| b == b'\n').map_or(bytes.len(), |n| at + n + 1);
    start..end
}

/// Replaces a number in a text by another.
fn number_in_text(bytes: &mut Vec<u8>, random: &mut Random) {
    let is_part = |b: u8| b.is_ascii_digit() || matches!(b, b'-' | b'.');
    let from = random.next_below(bytes.len() + 1);
    let Some(start) = bytes[from..].iter().position(|&b| is_part(b)).map(|n| from + n) else { return };
    let end = bytes[start..].iter().position(|&b| !is_part(b)).map_or(bytes.len(), |n| start + n);
    let number = if random.next_below(2) == 0 {
        (*random.one_of(&NUMBERS)).to_owned()
    } else {
        random.next_below(40).to_string()
    };
    bytes.splice(start..end, number.bytes());
}

/// Replaces some bytes by another number, in either byte order.
fn whole_number(bytes: &mut [u8], random: &mut Random) {
    let width = 1 << random.next_below(4);
    if bytes.len() < width {
        return;
    }
    let at = random.next_below(bytes.len() - width + 1);
    let number = random.one_of(&WHOLE).wrapping_add(random.next_below(3) as u64).wrapping_sub(1);
    let (little, big) = (number.to_le_bytes(), number.to_be_bytes());
    let new = if random.next_below(4) == 0 { &big[8 - width..] } else { &little[..width] };
    bytes[at..at + width].copy_from_slice(new);
}

/// Replaces a word of the format by another.
fn word_for_word(bytes: &mut Vec<u8>, words: &[&str], random: &mut Random) {
    let old = random.one_of(words).as_bytes();
    let new = random.one_of(words).as_bytes();
    let places: Vec<usize> =
        bytes.windows(old.len().max(1)).enumerate().filter(|(_, w)| *w == old).map(|(at, _)| at).collect();
    if !places.is_empty() {
        let at = *random.one_of(&places);
        bytes.splice(at..at + old.len(), new.iter().copied());
    }
}
