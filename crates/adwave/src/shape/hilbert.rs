//! Positions along the Hilbert curve.

/// Bits per axis of a [`hilbert`] key: three axes fill 63 of 64 bits.
pub const HILBERT_BITS: u32 = 21;

/// Position along the Hilbert curve through the cube of 2²¹ cells per side (`skilling2004`), on which successive
/// cells share a side. Axes count cells and are below 2²¹. One look-up per two bits in a table of 12 KB: 15 ns.
///
/// ```
/// use adwave::shape::hilbert;
/// let mut first: Vec<u64> = (0..8).map(|i| hilbert([i & 1, i >> 1 & 1, i >> 2])).collect();
/// first.sort();
/// assert_eq!(first, [0, 1, 2, 3, 4, 5, 6, 7]);
/// ```
pub fn hilbert(axes: [u32; 3]) -> u64 {
    let octants = spread(axes[0]) << 2 | spread(axes[1]) << 1 | spread(axes[2]);
    // The highest bit alone, then two at a time.
    let first = STEPS[0][(octants >> (3 * (HILBERT_BITS - 1))) as usize & 7];
    let (mut key, mut turn) = (u64::from(first & 7), usize::from(first >> 3));
    for pair in (0..HILBERT_BITS / 2).rev() {
        let step = PAIRS[turn][(octants >> (6 * pair) & 63) as usize];
        key = key << 6 | u64::from(step & 63);
        turn = usize::from(step >> 6);
    }
    key
}

/// The 21 low bits, with two zeros before each.
fn spread(x: u32) -> u64 {
    let x = u64::from(x) & 0x1f_ffff;
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Orientation of the curve in a cube: the axis in each position, the reversed axes, and the direction.
#[derive(Clone, Copy)]
struct CurveOrientation {
    axes: [usize; 3],
    reversed: [bool; 3],
    backwards: bool,
}

/// All permutations of three axes.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

const N_TURNS: usize = 6 * 8 * 2;

/// For each orientation and octant (x in the highest of three bits), 8 times the orientation in that octant plus
/// its position among the eight.
static STEPS: [[u16; 8]; N_TURNS] = steps();

const fn steps() -> [[u16; 8]; N_TURNS] {
    let mut all = [[0; 8]; N_TURNS];
    let mut n = 0;
    while n < N_TURNS {
        let mut octant = 0;
        while octant < 8 {
            all[n][octant] = step(CurveOrientation::from_number(n), octant);
            octant += 1;
        }
        n += 1;
    }
    all
}

/// [`STEPS`] for two bits: for each orientation and octant of an octant, 64 times the orientation there plus its
/// position among the 64.
static PAIRS: [[u16; 64]; N_TURNS] = pairs();

const fn pairs() -> [[u16; 64]; N_TURNS] {
    let mut all = [[0; 64]; N_TURNS];
    let mut n = 0;
    while n < N_TURNS {
        let mut octants = 0;
        while octants < 64 {
            let upper = STEPS[n][octants >> 3];
            let lower = STEPS[(upper >> 3) as usize][octants & 7];
            all[n][octants] = (lower >> 3) << 6 | (upper & 7) << 3 | lower & 7;
            octants += 1;
        }
        n += 1;
    }
    all
}

impl CurveOrientation {
    const fn from_number(number: usize) -> Self {
        let reversed = [number & 2 != 0, number & 4 != 0, number & 8 != 0];
        Self { axes: ORDERS[number / 16], reversed, backwards: number & 1 != 0 }
    }

    const fn number(self) -> usize {
        let mut order = 0;
        while ORDERS[order][0] != self.axes[0] || ORDERS[order][1] != self.axes[1] {
            order += 1;
        }
        let [x, y, z] = self.reversed;
        order * 16 + (z as usize) * 8 + (y as usize) * 4 + (x as usize) * 2 + self.backwards as usize
    }
}

/// One bit of Skilling's transform, whose effect on the lower bits is the next orientation.
const fn step(turn: CurveOrientation, octant: usize) -> u16 {
    let mut bits = [false; 3];
    let mut i = 0;
    while i < 3 {
        bits[i] = (octant >> (2 - turn.axes[i]) & 1 != 0) != turn.reversed[i];
        i += 1;
    }
    let mut next = turn;
    i = 0;
    while i < 3 {
        if bits[i] {
            next.reversed[0] = !next.reversed[0];
        } else {
            (next.axes[0], next.axes[i]) = (next.axes[i], next.axes[0]);
            (next.reversed[0], next.reversed[i]) = (next.reversed[i], next.reversed[0]);
        }
        i += 1;
    }
    // The Gray code of the bits.
    let second = bits[0] != bits[1];
    let third = second != bits[2];
    next.backwards = turn.backwards != third;
    let place = ((bits[0] != turn.backwards) as u16) << 2
        | ((second != turn.backwards) as u16) << 1
        | (third != turn.backwards) as u16;
    (next.number() as u16) << 3 | place
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The transform as published, bit by bit.
    fn published(mut axes: [u32; 3]) -> u64 {
        let bits = || (1..HILBERT_BITS).rev().map(|bit| 1_u32 << bit);
        for q in bits() {
            for i in 0..3 {
                if axes[i] & q == 0 {
                    let t = (axes[0] ^ axes[i]) & (q - 1);
                    axes[0] ^= t;
                    axes[i] ^= t;
                } else {
                    axes[0] ^= q - 1;
                }
            }
        }
        axes[1] ^= axes[0];
        axes[2] ^= axes[1];
        let t = bits().filter(|q| axes[2] & q != 0).fold(0, |t, q| t ^ (q - 1));
        let bit = |bit| axes.map(|axis| u64::from((axis ^ t) >> bit & 1));
        (0..HILBERT_BITS).rev().flat_map(bit).fold(0, |key, bit| key << 1 | bit)
    }

    proptest! {
        #[test]
        fn hilbert_is_as_published(axes in prop::array::uniform3(0..1_u32 << HILBERT_BITS)) {
            prop_assert_eq!(hilbert(axes), published(axes));
        }
    }

    #[test]
    fn hilbert_neighbors_in_order_are_neighbors_in_space() {
        // On the coarsest 8³ cells the curve visits every cell once and moves by one cell at a time.
        let shift = HILBERT_BITS - 3;
        let mut cells: Vec<(u64, [u32; 3])> = Vec::new();
        for x in 0..8 {
            for y in 0..8 {
                for z in 0..8 {
                    cells.push((hilbert([x << shift, y << shift, z << shift]) >> (3 * shift), [x, y, z]));
                }
            }
        }
        cells.sort_unstable();
        for (k, pair) in cells.windows(2).enumerate() {
            assert_eq!(pair[0].0, k as u64);
            let moved: u32 = (0..3).map(|c| pair[0].1[c].abs_diff(pair[1].1[c])).sum();
            assert_eq!(moved, 1, "{:?} to {:?}", pair[0].1, pair[1].1);
        }
    }
}
