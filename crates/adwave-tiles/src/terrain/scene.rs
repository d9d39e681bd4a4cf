//! A made landscape as a laser scanner sees it from the air, point by point.
//!
//! Each point depends on its number, the number of points and a seed alone, by hashes and by arithmetic that is the same on
//! every machine: so any part can be made at any time, and by any number of threads.

/// Bytes of a record of point format 6.
pub(super) const RECORD: usize = 30;
/// The point data record format.
pub(super) const FORMAT: u8 = 6;
/// Meters of a step, and what step 0 stands for.
pub(super) const SCALE: [f64; 3] = [0.001; 3];
pub(super) const OFFSET: [f64; 3] = [500_000.0, 4_500_000.0, 200.0];

/// Points of a square meter, on average.
const DENSITY: f64 = 10.0;
/// Meters between the middles of two strips, about, and the width of a strip in those distances.
const SPACING: f64 = 80.0;
const WIDTH: f64 = 1.5;
/// Seconds between two points, and between two strips.
const STEP: f64 = 2e-6;
const TURN: f64 = 90.0;

const GROUND: u8 = 2;
const TREE: u8 = 5;
const BUILDING: u8 = 6;

/// Meters between the places where a building or a tree can be.
const BLOCK: f64 = 40.0;
const STAND: f64 = 8.0;

/// Mixes the bits of a number so that neighbors have nothing in common (the finalizer of SplitMix64).
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Numbers that look random, from 0 to 1.
struct Dice(u64);

impl Dice {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mix(self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// From -1 to 1, most often near 0.
    fn noise(&mut self) -> f64 {
        self.unit() + self.unit() - 1.0
    }

    fn happens(&mut self, share: f64) -> bool {
        self.unit() < share
    }
}

/// The whole number below, without the call that `floor` is on most machines.
fn below(x: f64) -> i64 {
    let near = x as i64;
    near - i64::from(x < near as f64)
}

/// A wave of period 1, from -1 to 1: near to a sine, and the same on every machine.
fn wave(turns: f64) -> f64 {
    let x = 2.0 * (turns - below(turns) as f64) - 1.0;
    let arch = 4.0 * x * (1.0 - x.abs());
    arch * (0.775 + 0.225 * arch.abs())
}

/// The points of one flight line.
struct Strip {
    first: u64,
    n: u64,
    /// Meters to the east.
    middle: f64,
    /// Points of a scan line.
    per_line: u64,
    flies_back: bool,
}

/// What a pulse meets.
struct Echo {
    z: f64,
    class: u8,
    number: u8,
    of: u8,
    brightness: f64,
}

#[derive(Clone, Copy)]
struct House {
    middle: [f64; 2],
    /// The direction of its length, and half its length and width.
    along: [f64; 2],
    half: [f64; 2],
    eaves: f64,
    /// How far the ridge is above the eaves; 0 of a flat roof.
    rise: f64,
    /// The ground below its middle.
    base: f64,
}

#[derive(Clone, Copy)]
struct Tree {
    middle: [f64; 2],
    radius: f64,
    height: f64,
    /// Up to the crown.
    trunk: f64,
}

/// What stands at places of a grid that were asked for before.
struct Seen<T>(Vec<Option<(i64, i64, Option<T>)>>);

impl<T: Copy> Seen<T> {
    /// More than two scan lines cross.
    const SIDE: i64 = 32;

    fn new() -> Self {
        Self(vec![None; (Self::SIDE * Self::SIDE) as usize])
    }

    fn at(&mut self, i: i64, j: i64, make: impl FnOnce() -> Option<T>) -> Option<T> {
        let slot = &mut self.0[(i.rem_euclid(Self::SIDE) * Self::SIDE + j.rem_euclid(Self::SIDE)) as usize];
        match slot {
            Some((own_i, own_j, what)) if (*own_i, *own_j) == (i, j) => *what,
            _ => {
                let what = make();
                *slot = Some((i, j, what));
                what
            }
        }
    }
}

struct Around {
    houses: Seen<House>,
    trees: Seen<Tree>,
}

/// A square of land that strips are flown over, `n` points in all.
pub(super) struct Scene {
    seed: u64,
    /// Meters of a side, and of the width of a strip.
    extent: f64,
    width: f64,
    strips: Vec<Strip>,
}

impl Scene {
    pub(super) fn new(n: u64, seed: u64) -> Self {
        let seed = mix(seed);
        let extent = (n as f64 / DENSITY).sqrt();
        let n_strips = (extent / SPACING).round().max(2.0) as u64;
        let spacing = extent / n_strips as f64;
        let width = WIDTH * spacing;
        // Every second strip is flown higher or faster: up to ten times fewer points.
        let weight = |k: u64| if k.is_multiple_of(2) { 10.0 } else { Dice(mix(seed ^ k)).between(1.0, 10.0) };
        let total: f64 = (0..n_strips).map(weight).sum();
        let (mut strips, mut first, mut sum) = (Vec::new(), 0, 0.0);
        for k in 0..n_strips {
            sum += weight(k);
            let end = if k + 1 == n_strips { n } else { ((n as f64 * (sum / total)) as u64).clamp(first, n) };
            let own = end - first;
            // As far apart across as along.
            let per_line = (own as f64 * width / extent).sqrt().ceil().max(1.0) as u64;
            let middle = (k as f64 + 0.5) * spacing;
            strips.push(Strip { first, n: own, middle, per_line, flies_back: k % 2 == 1 });
            first = end;
        }
        Self { seed, extent, width, strips }
    }

    /// Fills the records of the points from number `first` on.
    pub(super) fn fill(&self, first: u64, records: &mut [u8]) {
        let mut around = Around { houses: Seen::new(), trees: Seen::new() };
        let mut k = self.strips.partition_point(|strip| strip.first + strip.n <= first);
        for (number, record) in (first..).zip(records.chunks_exact_mut(RECORD)) {
            while self.strips.get(k).is_some_and(|strip| strip.first + strip.n <= number) {
                k += 1;
            }
            if let Some(strip) = self.strips.get(k) {
                self.point(k as u64, strip, number, &mut around, record);
            }
        }
    }

    fn point(&self, k: u64, strip: &Strip, number: u64, around: &mut Around, record: &mut [u8]) {
        let mut dice = Dice(self.seed ^ mix(number));
        let i = number - strip.first;
        let place = i % strip.per_line;
        let across = (place as f64 + dice.unit()) / strip.per_line as f64 - 0.5;
        let along = self.extent * (i as f64 / strip.n as f64);
        let x = strip.middle + across * self.width;
        let y = if strip.flies_back { self.extent - along } else { along };
        let echo = self.echo(x, y, around, &mut dice);
        let found = [x + 0.015 * dice.noise(), y + 0.015 * dice.noise(), echo.z + 0.03 * dice.noise() + 50.0];
        for axis in 0..3 {
            // Meters to millimeters; the offset is where the land begins.
            let steps = below(found[axis] / SCALE[axis] + 0.5) as i32;
            record[4 * axis..4 * axis + 4].copy_from_slice(&steps.to_le_bytes());
        }
        let intensity = (echo.brightness * dice.between(0.8, 1.2) * 65_535.0).clamp(0.0, 65_535.0) as u16;
        record[12..14].copy_from_slice(&intensity.to_le_bytes());
        record[14] = echo.number | echo.of << 4;
        let is_edge = place == 0 || place + 1 == strip.per_line;
        record[15] = u8::from(strip.flies_back) << 6 | u8::from(is_edge) << 7;
        record[16] = echo.class;
        record[17] = 0;
        // Twenty degrees to each side, in steps of 0.006 degrees.
        let angle = (across * 2.0 * 20.0 / 0.006) as i16;
        record[18..20].copy_from_slice(&angle.to_le_bytes());
        record[20..22].copy_from_slice(&((k % 65_535 + 1) as u16).to_le_bytes());
        let time = 3e8 + number as f64 * STEP + k as f64 * TURN;
        record[22..30].copy_from_slice(&time.to_le_bytes());
    }

    fn echo(&self, x: f64, y: f64, around: &mut Around, dice: &mut Dice) -> Echo {
        if let Some(echo) = self.on_house(x, y, &mut around.houses, dice) {
            return echo;
        }
        let ground = self.ground(x, y);
        if let Some(echo) = self.in_tree(x, y, ground, &mut around.trees, dice) {
            return echo;
        }
        let brightness = 0.25 + 0.15 * self.value(x / 25.0, y / 25.0, 7);
        Echo { z: ground, class: GROUND, number: 1, of: 1, brightness }
    }

    fn ground(&self, x: f64, y: f64) -> f64 {
        let hills = 14.0 * wave(x / 1300.0 + 0.2 * wave(y / 1700.0))
            + 9.0 * wave(y / 900.0 + x / 2900.0)
            + 2.5 * wave(x / 210.0 - y / 330.0);
        hills
            + 4.0 * self.value(x / 70.0, y / 70.0, 1)
            + 0.6 * self.value(x / 13.0, y / 13.0, 2)
            + 0.08 * self.value(x / 2.0, y / 2.0, 3)
    }

    /// The hash of a place of a grid.
    fn hash(&self, i: i64, j: i64, what: u64) -> u64 {
        mix(self.seed ^ what.wrapping_mul(0xd6e8_feb8_6659_fd93) ^ mix(i as u64 ^ mix(j as u64)))
    }

    /// Smooth noise from -1 to 1 with values by hash at whole places.
    fn value(&self, x: f64, y: f64, what: u64) -> f64 {
        let (i, j) = (below(x), below(y));
        let ease = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (ease(x - i as f64), ease(y - j as f64));
        let at = |i: i64, j: i64| (self.hash(i, j, what) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let low = at(i, j) * (1.0 - u) + at(i + 1, j) * u;
        let high = at(i, j + 1) * (1.0 - u) + at(i + 1, j + 1) * u;
        low * (1.0 - v) + high * v
    }

    /// The house of a block; it stands within.
    fn house(&self, i: i64, j: i64) -> Option<House> {
        let middle = [(i as f64 + 0.5) * BLOCK, (j as f64 + 0.5) * BLOCK];
        let mut dice = Dice(self.hash(i, j, 4));
        let town = self.value(middle[0] / 400.0, middle[1] / 400.0, 5);
        if !dice.happens(if town > 0.1 { 0.8 } else { 0.1 }) {
            return None;
        }
        // A turn by twice the angle whose tangent this is.
        let t = dice.between(-1.0, 1.0);
        let along = [(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)];
        let half = [dice.between(6.0, 14.0), dice.between(4.0, 9.0)];
        let eaves = dice.between(3.0, 9.0) + if dice.happens(0.2) { 9.0 } else { 0.0 };
        let rise = if dice.happens(0.6) { dice.between(1.5, 5.0) } else { 0.0 };
        let shift = [dice.between(-2.0, 2.0), dice.between(-2.0, 2.0)];
        let middle = [middle[0] + shift[0], middle[1] + shift[1]];
        Some(House { middle, along, half, eaves, rise, base: self.ground(middle[0], middle[1]) })
    }

    fn on_house(&self, x: f64, y: f64, seen: &mut Seen<House>, dice: &mut Dice) -> Option<Echo> {
        const WALL: f64 = 0.25;
        let (i, j) = (below(x / BLOCK), below(y / BLOCK));
        let house = seen.at(i, j, || self.house(i, j))?;
        let [dx, dy] = [x - house.middle[0], y - house.middle[1]];
        let u = (dx * house.along[0] + dy * house.along[1]).abs();
        let v = (dy * house.along[0] - dx * house.along[1]).abs();
        let inside = (house.half[0] - u).min(house.half[1] - v);
        if inside < 0.0 {
            return None;
        }
        if inside < WALL && dice.happens(0.4) {
            let z = house.base + house.eaves * dice.unit();
            return Some(Echo { z, class: BUILDING, number: 1, of: 1, brightness: 0.35 });
        }
        let z = house.base + house.eaves + house.rise * (1.0 - v / house.half[1]);
        let brightness = if house.rise > 0.0 { 0.2 } else { 0.5 };
        Some(Echo { z, class: BUILDING, number: 1, of: 1, brightness })
    }

    /// The tree of a stand; its crown does not reach as far as the middle of the next.
    fn tree(&self, i: i64, j: i64) -> Option<Tree> {
        let mut dice = Dice(self.hash(i, j, 6));
        let middle = [(i as f64 + 0.5) * STAND, (j as f64 + 0.5) * STAND];
        // Single trees, and woods.
        let share = dice.unit();
        let in_wood = || self.value(middle[0] / 150.0, middle[1] / 150.0, 8) > 0.15;
        if share > 0.7 || (share > 0.05 && !in_wood()) {
            return None;
        }
        let middle = middle.map(|x| x + dice.between(-1.8, 1.8));
        let radius = dice.between(1.4, 3.8);
        let height = radius * dice.between(2.6, 4.5);
        Some(Tree { middle, radius, height, trunk: height * dice.between(0.15, 0.35) })
    }

    fn in_tree(&self, x: f64, y: f64, ground: f64, seen: &mut Seen<Tree>, dice: &mut Dice) -> Option<Echo> {
        let (i, j) = (below(x / STAND), below(y / STAND));
        let side = |x: f64, i: i64| if x / STAND - (i as f64) < 0.5 { i - 1 } else { i + 1 };
        let (i2, j2) = (side(x, i), side(y, j));
        for (i, j) in [(i, j), (i2, j), (i, j2), (i2, j2)] {
            let Some(tree) = seen.at(i, j, || self.tree(i, j)) else { continue };
            let Tree { middle: [cx, cy], radius, height, trunk } = tree;
            let square = (x - cx) * (x - cx) + (y - cy) * (y - cy);
            let inside = 1.0 - square / (radius * radius);
            if inside <= 0.0 {
                continue;
            }
            if square < 0.3 * 0.3 && dice.happens(0.3) {
                let z = ground + trunk * dice.unit();
                return Some(Echo { z, class: TREE, number: 2, of: 3, brightness: 0.15 });
            }
            if !dice.happens(0.65) {
                return Some(Echo { z: ground, class: GROUND, number: 3, of: 3, brightness: 0.12 });
            }
            let half = 0.5 * (height - trunk);
            let z = ground + trunk + half * (1.0 + inside.sqrt() * dice.between(-1.0, 1.0));
            let number = if z - ground > trunk + half { 1 } else { 2 };
            return Some(Echo { z, class: TREE, number, of: 3, brightness: 0.45 });
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(n: u64, seed: u64) -> Vec<u8> {
        let mut records = vec![0; n as usize * RECORD];
        Scene::new(n, seed).fill(0, &mut records);
        records
    }

    fn place(record: &[u8]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let own = record[4 * axis..4 * axis + 4].try_into().unwrap();
            f64::from(i32::from_le_bytes(own)) * SCALE[axis]
        })
    }

    #[test]
    fn parts_are_those_of_the_whole_and_a_seed_changes_them() {
        let whole = all(10_000, 3);
        let scene = Scene::new(10_000, 3);
        for (first, n) in [(0, 1), (1, 700), (4321, 5679), (9999, 1)] {
            let mut part = vec![0; n * RECORD];
            scene.fill(first, &mut part);
            assert!(part == whole[first as usize * RECORD..][..part.len()], "{first}");
        }
        assert!(all(10_000, 4) != whole);
        for n in [1, 2, 3, 17] {
            assert!(all(n, 1).chunks(RECORD).all(|record| record[14] != 0), "{n}");
        }
    }

    #[test]
    fn the_land_has_ground_houses_and_trees_within_its_bounds() {
        let n = 400_000;
        let records = all(n, 1);
        let extent = (n as f64 / DENSITY).sqrt();
        let mut classes = [0; 256];
        let mut time = 0.0;
        for record in records.chunks_exact(RECORD) {
            classes[usize::from(record[16])] += 1;
            let [x, y, z] = place(record);
            assert!(
                (-0.3 * extent..1.3 * extent).contains(&x) && (-0.1..extent + 0.1).contains(&y),
                "{x} {y}"
            );
            assert!((0.0..120.0).contains(&z), "{z}");
            let (number, of) = (record[14] & 15, record[14] >> 4);
            assert!((1..=of).contains(&number));
            let own = f64::from_le_bytes(record[22..30].try_into().unwrap());
            assert!(own > time);
            time = own;
        }
        for class in [GROUND, TREE, BUILDING] {
            assert!(classes[usize::from(class)] > n / 50, "{class}: {}", classes[usize::from(class)]);
        }
        assert_eq!(classes.iter().sum::<u64>(), n);
    }

    #[test]
    fn strips_differ_in_density_by_up_to_ten_times() {
        let scene = Scene::new(20_000_000, 1);
        let n = |k: usize| scene.strips[k].n as f64;
        let ratios: Vec<f64> = (1..scene.strips.len()).step_by(2).map(|k| n(k - 1) / n(k)).collect();
        assert!(ratios.len() > 5 && ratios.iter().all(|r| (0.99..10.1).contains(r)), "{ratios:?}");
        assert!(ratios.iter().any(|r| *r > 2.0) && ratios.iter().any(|r| *r < 2.0), "{ratios:?}");
        assert_eq!(scene.strips.iter().map(|strip| strip.n).sum::<u64>(), 20_000_000);
    }

    #[test]
    fn a_wave_is_near_to_a_sine() {
        for k in 0..100 {
            let t = 0.01 * f64::from(k);
            assert!((wave(t) + (std::f64::consts::TAU * t).sin()).abs() < 2e-3, "{t}");
        }
    }
}
