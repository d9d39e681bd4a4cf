//! A synthetic landscape as an airborne laser scanner sees it, point by point.
//!
//! Each point depends on its index, the number of points and a seed alone, by hashes and by arithmetic that is the same
//! on every machine, so that any range of points can be generated independently.

/// Bytes of a record of point format 6.
pub(super) const RECORD_BYTES: usize = 30;
/// The point data record format.
pub(super) const FORMAT: u8 = 6;
/// Meters per step of the quantized coordinates, and the position of step 0.
pub(super) const SCALE: [f64; 3] = [0.001; 3];
pub(super) const OFFSET: [f64; 3] = [500_000.0, 4_500_000.0, 200.0];

/// Points per square meter, on average.
const DENSITY: f64 = 10.0;
/// Approximate distance between the center lines of two strips in meters, and the width of a strip as a multiple of it.
const STRIP_SPACING: f64 = 80.0;
const STRIP_WIDTH: f64 = 1.5;
/// Seconds between two points, and between two strips.
const POINT_INTERVAL: f64 = 2e-6;
const STRIP_INTERVAL: f64 = 90.0;

const GROUND: u8 = 2;
const TREE: u8 = 5;
const BUILDING: u8 = 6;

/// Side of the grid cells that can have a house or a tree, in meters.
const LOT: f64 = 40.0;
const TREE_CELL: f64 = 8.0;

/// Hashes a number (the finalizer of SplitMix64).
fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Pseudorandom numbers (SplitMix64).
struct SplitMix(u64);

impl SplitMix {
    /// Uniform in 0..1.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mix(self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Triangular distribution from -1 to 1.
    fn noise(&mut self) -> f64 {
        self.unit() + self.unit() - 1.0
    }

    /// True with this probability.
    fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }
}

/// Largest integer not above x. `f64::floor` is a slow call on many machines.
fn floor(x: f64) -> i64 {
    let near = x as i64;
    near - i64::from(x < near as f64)
}

/// A wave of period 1 from -1 to 1, close to -sin(2πt), and the same on every machine.
fn wave(turns: f64) -> f64 {
    let x = 2.0 * (turns - floor(turns) as f64) - 1.0;
    let arch = 4.0 * x * (1.0 - x.abs());
    arch * (0.775 + 0.225 * arch.abs())
}

/// The points of one flight line.
struct Strip {
    first: u64,
    n: u64,
    /// Distance of the center line to the east, in meters.
    middle: f64,
    /// Points per scan line.
    per_line: u64,
    flies_back: bool,
}

/// An echo of a laser pulse.
struct Echo {
    z: f64,
    class: u8,
    number: u8,
    n_echoes: u8,
    brightness: f64,
}

#[derive(Clone, Copy)]
struct House {
    middle: [f64; 2],
    /// Direction of the ridge.
    along: [f64; 2],
    /// Half the length and half the width.
    half: [f64; 2],
    eaves: f64,
    /// Height of the ridge above the eaves; 0 for a flat roof.
    rise: f64,
    /// Height of the ground at the center.
    base: f64,
}

#[derive(Clone, Copy)]
struct Tree {
    middle: [f64; 2],
    radius: f64,
    height: f64,
    /// Height of the lower end of the crown.
    trunk: f64,
}

/// A direct-mapped cache of the objects in cells of a grid.
struct GridCache<T>(Vec<Option<(i64, i64, Option<T>)>>);

impl<T: Copy> GridCache<T> {
    /// More cells than two scan lines cross.
    const SIDE: i64 = 32;

    fn new() -> Self {
        Self(vec![None; (Self::SIDE * Self::SIDE) as usize])
    }

    fn get_or_insert(&mut self, i: i64, j: i64, make: impl FnOnce() -> Option<T>) -> Option<T> {
        let slot = &mut self.0[(i.rem_euclid(Self::SIDE) * Self::SIDE + j.rem_euclid(Self::SIDE)) as usize];
        match slot {
            Some((cached_i, cached_j, what)) if (*cached_i, *cached_j) == (i, j) => *what,
            _ => {
                let what = make();
                *slot = Some((i, j, what));
                what
            }
        }
    }
}

struct ObjectCaches {
    houses: GridCache<House>,
    trees: GridCache<Tree>,
}

/// A square of land that is scanned in strips.
pub(super) struct Scene {
    seed: u64,
    /// Side of the square in meters.
    extent: f64,
    /// Width of a strip in meters.
    width: f64,
    strips: Vec<Strip>,
}

impl Scene {
    pub(super) fn new(n: u64, seed: u64) -> Self {
        let seed = mix(seed);
        let extent = (n as f64 / DENSITY).sqrt();
        let n_strips = (extent / STRIP_SPACING).round().max(2.0) as u64;
        let spacing = extent / n_strips as f64;
        let width = STRIP_WIDTH * spacing;
        // Every second strip has up to ten times fewer points.
        let weight =
            |k: u64| if k.is_multiple_of(2) { 10.0 } else { SplitMix(mix(seed ^ k)).uniform(1.0, 10.0) };
        let total: f64 = (0..n_strips).map(weight).sum();
        let (mut strips, mut first, mut sum) = (Vec::new(), 0, 0.0);
        for k in 0..n_strips {
            sum += weight(k);
            let end = if k + 1 == n_strips { n } else { ((n as f64 * (sum / total)) as u64).clamp(first, n) };
            let n_in_strip = end - first;
            // The same spacing across the strip as along it.
            let per_line = (n_in_strip as f64 * width / extent).sqrt().ceil().max(1.0) as u64;
            let middle = (k as f64 + 0.5) * spacing;
            strips.push(Strip { first, n: n_in_strip, middle, per_line, flies_back: k % 2 == 1 });
            first = end;
        }
        Self { seed, extent, width, strips }
    }

    /// Fills the records of consecutive points, of which `first` is the first.
    pub(super) fn fill(&self, first: u64, records: &mut [u8]) {
        let mut caches = ObjectCaches { houses: GridCache::new(), trees: GridCache::new() };
        let mut k = self.strips.partition_point(|strip| strip.first + strip.n <= first);
        for (number, record) in (first..).zip(records.chunks_exact_mut(RECORD_BYTES)) {
            while self.strips.get(k).is_some_and(|strip| strip.first + strip.n <= number) {
                k += 1;
            }
            if let Some(strip) = self.strips.get(k) {
                self.point(k as u64, strip, number, &mut caches, record);
            }
        }
    }

    fn point(&self, k: u64, strip: &Strip, number: u64, caches: &mut ObjectCaches, record: &mut [u8]) {
        let mut rng = SplitMix(self.seed ^ mix(number));
        let i = number - strip.first;
        let place = i % strip.per_line;
        let across = (place as f64 + rng.unit()) / strip.per_line as f64 - 0.5;
        let along = self.extent * (i as f64 / strip.n as f64);
        let x = strip.middle + across * self.width;
        let y = if strip.flies_back { self.extent - along } else { along };
        let echo = self.echo(x, y, caches, &mut rng);
        let found = [x + 0.015 * rng.noise(), y + 0.015 * rng.noise(), echo.z + 0.03 * rng.noise() + 50.0];
        for axis in 0..3 {
            // Meters to millimeters; the offset is the corner of the land.
            let steps = floor(found[axis] / SCALE[axis] + 0.5) as i32;
            record[4 * axis..4 * axis + 4].copy_from_slice(&steps.to_le_bytes());
        }
        let intensity = (echo.brightness * rng.uniform(0.8, 1.2) * 65_535.0).clamp(0.0, 65_535.0) as u16;
        record[12..14].copy_from_slice(&intensity.to_le_bytes());
        record[14] = echo.number | echo.n_echoes << 4;
        let is_edge = place == 0 || place + 1 == strip.per_line;
        record[15] = u8::from(strip.flies_back) << 6 | u8::from(is_edge) << 7;
        record[16] = echo.class;
        record[17] = 0;
        // Scan angles of 20 degrees to each side, in steps of 0.006 degrees.
        let angle = (across * 2.0 * 20.0 / 0.006) as i16;
        record[18..20].copy_from_slice(&angle.to_le_bytes());
        record[20..22].copy_from_slice(&((k % 65_535 + 1) as u16).to_le_bytes());
        let time = 3e8 + number as f64 * POINT_INTERVAL + k as f64 * STRIP_INTERVAL;
        record[22..30].copy_from_slice(&time.to_le_bytes());
    }

    fn echo(&self, x: f64, y: f64, caches: &mut ObjectCaches, rng: &mut SplitMix) -> Echo {
        if let Some(echo) = self.house_echo(x, y, &mut caches.houses, rng) {
            return echo;
        }
        let ground = self.ground(x, y);
        if let Some(echo) = self.tree_echo(x, y, ground, &mut caches.trees, rng) {
            return echo;
        }
        let brightness = 0.25 + 0.15 * self.value_noise(x / 25.0, y / 25.0, 7);
        Echo { z: ground, class: GROUND, number: 1, n_echoes: 1, brightness }
    }

    fn ground(&self, x: f64, y: f64) -> f64 {
        let hills = 14.0 * wave(x / 1300.0 + 0.2 * wave(y / 1700.0))
            + 9.0 * wave(y / 900.0 + x / 2900.0)
            + 2.5 * wave(x / 210.0 - y / 330.0);
        hills
            + 4.0 * self.value_noise(x / 70.0, y / 70.0, 1)
            + 0.6 * self.value_noise(x / 13.0, y / 13.0, 2)
            + 0.08 * self.value_noise(x / 2.0, y / 2.0, 3)
    }

    /// Hash of a grid cell; `salt` distinguishes the grids.
    fn hash(&self, i: i64, j: i64, salt: u64) -> u64 {
        mix(self.seed ^ salt.wrapping_mul(0xd6e8_feb8_6659_fd93) ^ mix(i as u64 ^ mix(j as u64)))
    }

    /// Value noise from -1 to 1: hashes at integer positions, smoothly interpolated.
    fn value_noise(&self, x: f64, y: f64, salt: u64) -> f64 {
        let (i, j) = (floor(x), floor(y));
        let ease = |t: f64| t * t * (3.0 - 2.0 * t);
        let (u, v) = (ease(x - i as f64), ease(y - j as f64));
        let at = |i: i64, j: i64| (self.hash(i, j, salt) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        let low = at(i, j) * (1.0 - u) + at(i + 1, j) * u;
        let high = at(i, j + 1) * (1.0 - u) + at(i + 1, j + 1) * u;
        low * (1.0 - v) + high * v
    }

    /// The house of a lot, which lies inside it; `None` if the lot is empty.
    fn house(&self, i: i64, j: i64) -> Option<House> {
        let middle = [(i as f64 + 0.5) * LOT, (j as f64 + 0.5) * LOT];
        let mut rng = SplitMix(self.hash(i, j, 4));
        let town = self.value_noise(middle[0] / 400.0, middle[1] / 400.0, 5);
        if !rng.chance(if town > 0.1 { 0.8 } else { 0.1 }) {
            return None;
        }
        // A rotation by the angle 2·atan(t).
        let t = rng.uniform(-1.0, 1.0);
        let along = [(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)];
        let half = [rng.uniform(6.0, 14.0), rng.uniform(4.0, 9.0)];
        let eaves = rng.uniform(3.0, 9.0) + if rng.chance(0.2) { 9.0 } else { 0.0 };
        let rise = if rng.chance(0.6) { rng.uniform(1.5, 5.0) } else { 0.0 };
        let shift = [rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0)];
        let middle = [middle[0] + shift[0], middle[1] + shift[1]];
        Some(House { middle, along, half, eaves, rise, base: self.ground(middle[0], middle[1]) })
    }

    fn house_echo(&self, x: f64, y: f64, cache: &mut GridCache<House>, rng: &mut SplitMix) -> Option<Echo> {
        const WALL: f64 = 0.25;
        let (i, j) = (floor(x / LOT), floor(y / LOT));
        let house = cache.get_or_insert(i, j, || self.house(i, j))?;
        let [dx, dy] = [x - house.middle[0], y - house.middle[1]];
        let u = (dx * house.along[0] + dy * house.along[1]).abs();
        let v = (dy * house.along[0] - dx * house.along[1]).abs();
        let inside = (house.half[0] - u).min(house.half[1] - v);
        if inside < 0.0 {
            return None;
        }
        if inside < WALL && rng.chance(0.4) {
            let z = house.base + house.eaves * rng.unit();
            return Some(Echo { z, class: BUILDING, number: 1, n_echoes: 1, brightness: 0.35 });
        }
        let z = house.base + house.eaves + house.rise * (1.0 - v / house.half[1]);
        let brightness = if house.rise > 0.0 { 0.2 } else { 0.5 };
        Some(Echo { z, class: BUILDING, number: 1, n_echoes: 1, brightness })
    }

    /// The tree of a cell; `None` if the cell is empty. Its crown does not reach the center of the next cell.
    fn tree(&self, i: i64, j: i64) -> Option<Tree> {
        let mut rng = SplitMix(self.hash(i, j, 6));
        let middle = [(i as f64 + 0.5) * TREE_CELL, (j as f64 + 0.5) * TREE_CELL];
        // Single trees everywhere, more trees in woods.
        let share = rng.unit();
        let in_wood = || self.value_noise(middle[0] / 150.0, middle[1] / 150.0, 8) > 0.15;
        if share > 0.7 || (share > 0.05 && !in_wood()) {
            return None;
        }
        let middle = middle.map(|x| x + rng.uniform(-1.8, 1.8));
        let radius = rng.uniform(1.4, 3.8);
        let height = radius * rng.uniform(2.6, 4.5);
        Some(Tree { middle, radius, height, trunk: height * rng.uniform(0.15, 0.35) })
    }

    fn tree_echo(
        &self,
        x: f64,
        y: f64,
        ground: f64,
        cache: &mut GridCache<Tree>,
        rng: &mut SplitMix,
    ) -> Option<Echo> {
        let (i, j) = (floor(x / TREE_CELL), floor(y / TREE_CELL));
        let side = |x: f64, i: i64| if x / TREE_CELL - (i as f64) < 0.5 { i - 1 } else { i + 1 };
        let (i2, j2) = (side(x, i), side(y, j));
        for (i, j) in [(i, j), (i2, j), (i, j2), (i2, j2)] {
            let Some(tree) = cache.get_or_insert(i, j, || self.tree(i, j)) else { continue };
            let Tree { middle: [cx, cy], radius, height, trunk } = tree;
            let square = (x - cx) * (x - cx) + (y - cy) * (y - cy);
            let inside = 1.0 - square / (radius * radius);
            if inside <= 0.0 {
                continue;
            }
            if square < 0.3 * 0.3 && rng.chance(0.3) {
                let z = ground + trunk * rng.unit();
                return Some(Echo { z, class: TREE, number: 2, n_echoes: 3, brightness: 0.15 });
            }
            if !rng.chance(0.65) {
                return Some(Echo { z: ground, class: GROUND, number: 3, n_echoes: 3, brightness: 0.12 });
            }
            let half = 0.5 * (height - trunk);
            let z = ground + trunk + half * (1.0 + inside.sqrt() * rng.uniform(-1.0, 1.0));
            let number = if z - ground > trunk + half { 1 } else { 2 };
            return Some(Echo { z, class: TREE, number, n_echoes: 3, brightness: 0.45 });
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(n: u64, seed: u64) -> Vec<u8> {
        let mut records = vec![0; n as usize * RECORD_BYTES];
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
    fn ranges_of_points_agree_with_all_points_and_depend_on_the_seed() {
        let whole = all(10_000, 3);
        let scene = Scene::new(10_000, 3);
        for (first, n) in [(0, 1), (1, 700), (4321, 5679), (9999, 1)] {
            let mut part = vec![0; n * RECORD_BYTES];
            scene.fill(first, &mut part);
            assert!(part == whole[first as usize * RECORD_BYTES..][..part.len()], "{first}");
        }
        assert!(all(10_000, 4) != whole);
        for n in [1, 2, 3, 17] {
            assert!(all(n, 1).chunks(RECORD_BYTES).all(|record| record[14] != 0), "{n}");
        }
    }

    #[test]
    fn the_landscape_has_ground_houses_and_trees_within_its_bounds() {
        let n = 400_000;
        let records = all(n, 1);
        let extent = (n as f64 / DENSITY).sqrt();
        let mut classes = [0; 256];
        let mut time = 0.0;
        for record in records.chunks_exact(RECORD_BYTES) {
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
    fn densities_of_strips_differ_by_up_to_a_factor_of_ten() {
        let scene = Scene::new(20_000_000, 1);
        let n = |k: usize| scene.strips[k].n as f64;
        let ratios: Vec<f64> = (1..scene.strips.len()).step_by(2).map(|k| n(k - 1) / n(k)).collect();
        assert!(ratios.len() > 5 && ratios.iter().all(|r| (0.99..10.1).contains(r)), "{ratios:?}");
        assert!(ratios.iter().any(|r| *r > 2.0) && ratios.iter().any(|r| *r < 2.0), "{ratios:?}");
        assert_eq!(scene.strips.iter().map(|strip| strip.n).sum::<u64>(), 20_000_000);
    }

    #[test]
    fn the_wave_is_close_to_a_sine() {
        for k in 0..100 {
            let t = 0.01 * f64::from(k);
            assert!((wave(t) + (std::f64::consts::TAU * t).sin()).abs() < 2e-3, "{t}");
        }
    }
}
