//! Geometry of the HEALPix pixelization (`gorski2005`): numbers of pixels, their centers, and the mesh that joins them.
//!
//! The sphere is divided into 12 base faces. Within a face, x runs to the north-east and y to the north-west, from 0 to
//! `n_side` pixels. With the base face's row a ∈ {2, 3, 4} and column b (in eighths of a turn), a point of the face is
//! on the ring t = a − x − y (in units of `n_side` pixels, from 0 at the north pole to 4 at the south pole) and at the
//! longitude φ = (b + (x − y)/r)·π/4, where r is 1 on the belt 1 ≤ t ≤ 3 and the distance of t from 0 or 4 beyond it.
//! The height is z = (2 − t)·2/3 on the belt, and 1 − r²/3 beyond it, with the sign of the hemisphere.

use std::f64::consts::FRAC_PI_4;

use adwave::Progress;
use adwave::shape::Polygons;

use crate::ReadError;
use crate::progress::{collect, report_row};

/// Largest number of pixels along the side of a base face, so that numbers of pixels fit 62 bits.
pub(super) const MAX_N_SIDE: u64 = 1 << 29;

/// Order in which pixels are numbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ordering {
    /// Along rings of equal latitude, from north to south.
    Ring,
    /// By base face, and within it by quarters of quarters.
    Nested,
}

/// A pixel by its base face, 0 to 11, and its place within it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pixel {
    face: u64,
    x: u64,
    y: u64,
}

/// A resolution and an order of the pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pixelization {
    /// Number of pixels along the side of a base face; a power of two if the order is nested.
    pub(super) n_side: u64,
    pub(super) ordering: Ordering,
}

/// Row of a base face: 2 in the north, 3 on the belt, 4 in the south.
fn row(face: u64) -> u64 {
    2 + face / 4
}

/// Column of the center of a base face in eighths of a turn.
fn column(face: u64) -> u64 {
    2 * (face % 4) + u64::from(face / 4 != 1)
}

/// Every second bit of a number, from the lowest on.
fn even_bits(number: u64) -> u64 {
    let mut bits = number & 0x5555_5555_5555_5555;
    for (shift, mask) in [
        (1, 0x3333_3333_3333_3333),
        (2, 0x0f0f_0f0f_0f0f_0f0f),
        (4, 0x00ff_00ff_00ff_00ff),
        (8, 0x0000_ffff_0000_ffff),
        (16, 0x0000_0000_ffff_ffff),
    ] {
        bits = (bits | bits >> shift) & mask;
    }
    bits
}

/// Number whose every second bit, from the lowest on, are the 32 lowest bits of `bits`.
fn spread_bits(bits: u64) -> u64 {
    let mut number = bits & 0xffff_ffff;
    for (shift, mask) in [
        (16, 0x0000_ffff_0000_ffff),
        (8, 0x00ff_00ff_00ff_00ff),
        (4, 0x0f0f_0f0f_0f0f_0f0f),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        number = (number | number << shift) & mask;
    }
    number
}

impl Pixelization {
    /// Number of pixels of the sphere, `12·n_side²`.
    pub(super) fn n_pixels(self) -> u64 {
        12 * self.n_side * self.n_side
    }

    /// Pixel of a number, which must be below [`n_pixels`](Self::n_pixels).
    pub(super) fn pixel(self, number: u64) -> Pixel {
        match self.ordering {
            Ordering::Nested => {
                let within = number % (self.n_side * self.n_side);
                let face = number / (self.n_side * self.n_side);
                Pixel { face, x: even_bits(within), y: even_bits(within >> 1) }
            }
            Ordering::Ring => self.pixel_on_ring(number),
        }
    }

    /// Number of a pixel.
    pub(super) fn number(self, pixel: Pixel) -> u64 {
        let n = self.n_side;
        if self.ordering == Ordering::Nested {
            return pixel.face * n * n + spread_bits(pixel.x) + 2 * spread_bits(pixel.y);
        }
        let ring = row(pixel.face) * n - pixel.x - pixel.y - 1;
        let (first, length, shift) = self.ring(ring);
        // In units of π/4/r; base faces in the west reach beyond the meridian 0.
        let r = length / 4;
        let longitude = column(pixel.face) * r + 2 * length + pixel.x - pixel.y;
        first + (longitude - shift) / 2 % length
    }

    /// First number, number of pixels, and place of the first center east of the meridian 0 (0 or 1, in half pixels) of
    /// a ring, from 1 to `4n − 1`.
    fn ring(self, ring: u64) -> (u64, u64, u64) {
        let n = self.n_side;
        if ring < n {
            (2 * ring * (ring - 1), 4 * ring, 1)
        } else if ring <= 3 * n {
            (2 * n * (n - 1) + (ring - n) * 4 * n, 4 * n, (ring - n + 1) % 2)
        } else {
            let from_south = 4 * n - ring;
            (self.n_pixels() - 2 * from_south * (from_south + 1), 4 * from_south, 1)
        }
    }

    /// Ring on which a pixel with this number in the order of rings lies.
    fn ring_of(self, number: u64) -> u64 {
        let n = self.n_side;
        let n_cap = 2 * n * (n - 1);
        // 2·i·(i − 1) ≤ number < 2·i·(i + 1) on the ring i.
        let within_cap = |number: u64| (1 + 2 * number).isqrt().div_ceil(2);
        if number < n_cap {
            within_cap(number)
        } else if number < self.n_pixels() - n_cap {
            n + (number - n_cap) / (4 * n)
        } else {
            4 * n - within_cap(self.n_pixels() - 1 - number)
        }
    }

    fn pixel_on_ring(self, number: u64) -> Pixel {
        let n = self.n_side;
        let ring = self.ring_of(number);
        let (first, length, shift) = self.ring(ring);
        let (place, r) = (number - first, length / 4);
        let longitude = 2 * place + shift;
        for face in 0..12 {
            if row(face) * n <= ring || row(face) * n - ring - 1 > 2 * (n - 1) {
                continue;
            }
            let sum = (row(face) * n - ring - 1) as i64;
            // The difference x − y, within half a turn.
            let turn = 2 * length as i64;
            let ahead = (longitude as i64 - (column(face) * r) as i64).rem_euclid(turn);
            let difference = if ahead > turn / 2 { ahead - turn } else { ahead };
            let (x, y) = ((sum + difference).div_euclid(2), (sum - difference).div_euclid(2));
            let is_within = |k: i64| (0..n as i64).contains(&k);
            let is_polar = ring < n || ring > 3 * n;
            if is_within(x) && is_within(y) && x + y == sum && (!is_polar || difference.unsigned_abs() < r) {
                return Pixel { face, x: x as u64, y: y as u64 };
            }
        }
        unreachable!("each pixel of a ring lies in a base face")
    }

    /// Center of a pixel on the unit sphere.
    pub(super) fn center(self, pixel: Pixel) -> [f64; 3] {
        let n = self.n_side as f64;
        let ring = (row(pixel.face) * self.n_side - pixel.x - pixel.y - 1) as f64;
        let difference = pixel.x as f64 - pixel.y as f64;
        let (z, rho, r) = if ring < n || ring > 3.0 * n {
            let r = ring.min(4.0 * n - ring);
            let depth = r * r / (3.0 * n * n);
            let z = if ring < n { 1.0 - depth } else { depth - 1.0 };
            (z, (depth * (2.0 - depth)).sqrt(), r)
        } else {
            let z = (2.0 * n - ring) * 2.0 / (3.0 * n);
            (z, ((1.0 - z) * (1.0 + z)).sqrt(), n)
        };
        let longitude = (column(pixel.face) as f64 + difference / r) * FRAC_PI_4;
        [rho * longitude.cos(), rho * longitude.sin(), z]
    }

    /// Pixel south-west of a pixel.
    fn south_west(self, Pixel { face, x, y }: Pixel) -> Pixel {
        let (k, last) = (face % 4, self.n_side - 1);
        match (x, face / 4) {
            (1.., _) => Pixel { face, x: x - 1, y },
            (0, 0) => Pixel { face: 4 + k, x: last, y },
            (0, 1) => Pixel { face: 8 + (k + 3) % 4, x: last, y },
            (0, _) => Pixel { face: 8 + (k + 3) % 4, x: y, y: 0 },
        }
    }

    /// Pixel south-east of a pixel.
    fn south_east(self, Pixel { face, x, y }: Pixel) -> Pixel {
        let (k, last) = (face % 4, self.n_side - 1);
        match (y, face / 4) {
            (1.., _) => Pixel { face, x, y: y - 1 },
            (0, 0) => Pixel { face: 4 + (k + 1) % 4, x, y: last },
            (0, 1) => Pixel { face: 8 + k, x, y: last },
            (0, _) => Pixel { face: 8 + (k + 1) % 4, x: 0, y: x },
        }
    }

    /// Pixel north-east of a pixel.
    fn north_east(self, Pixel { face, x, y }: Pixel) -> Pixel {
        let (k, last) = (face % 4, self.n_side - 1);
        match face / 4 {
            _ if x < last => Pixel { face, x: x + 1, y },
            0 => Pixel { face: (k + 1) % 4, x: y, y: last },
            1 => Pixel { face: k, x: 0, y },
            _ => Pixel { face: 4 + (k + 1) % 4, x: 0, y },
        }
    }

    /// Pixel north-west of a pixel.
    fn north_west(self, Pixel { face, x, y }: Pixel) -> Pixel {
        let (k, last) = (face % 4, self.n_side - 1);
        match face / 4 {
            _ if y < last => Pixel { face, x, y: y + 1 },
            0 => Pixel { face: (k + 3) % 4, x: last, y: x },
            1 => Pixel { face: (k + 3) % 4, x, y: 0 },
            _ => Pixel { face: 4 + k, x, y: 0 },
        }
    }

    /// Pixels around the southern corner of a pixel, counterclockwise from outside, from that pixel on: three or four.
    /// A corner between two southern base faces is that of a pixel in either, and belongs to the western one; the south
    /// pole belongs to base face 8.
    fn pixels_at_south_corner(self, pixel: Pixel) -> Option<(Pixel, Pixel, Option<Pixel>, Pixel)> {
        let Pixel { face, x, y } = pixel;
        let last = self.n_side - 1;
        let (west, east) = (self.south_west(pixel), self.south_east(pixel));
        let south = match (x, y, face / 4) {
            (1.., ..) => Some(self.south_east(Pixel { face, x: x - 1, y })),
            (0, 1.., 2..) => return None,
            (0, 1.., _) => Some(self.south_west(Pixel { face, x, y: y - 1 })),
            (0, 0, 0) => Some(Pixel { face: 8 + face, x: last, y: last }),
            (0, 0, 1) => None,
            _ if face == 8 => Some(Pixel { face: 10, x: 0, y: 0 }),
            _ => return None,
        };
        Some((pixel, west, south, east))
    }

    /// Mesh that joins the centers of the pixels with these numbers: a face around each corner of pixels at which three
    /// or four of them meet. `numbers` are the pixels of the vertices. Polygons are counterclockwise from outside.
    /// O(n), O(n log n) for a part of the sphere.
    pub(super) fn dual_faces(
        self,
        numbers: &PixelNumbers,
        progress: Progress<'_>,
    ) -> Result<Polygons, ReadError> {
        let last = self.n_side - 1;
        let owners = self.owners(numbers, progress)?;
        let n_owners = owners.as_ref().map_or(self.n_pixels(), |owners| owners.len() as u64);
        let mut faces = Polygons::new();
        let mut face = Vec::with_capacity(4);
        let mut add = |corners: &[Pixel]| {
            face.clear();
            face.extend(corners.iter().filter_map(|&pixel| numbers.vertex(self.number(pixel))));
            if face.len() >= 3 {
                faces.push(&face);
            }
        };
        for k in 0..n_owners {
            report_row(progress, k, n_owners)?;
            let number = owners.as_ref().map_or(k, |owners| owners[k as usize]);
            match self.pixels_at_south_corner(self.pixel(number)) {
                Some((north, west, Some(south), east)) => add(&[north, west, south, east]),
                Some((north, west, None, east)) => add(&[north, west, east]),
                None => {}
            }
        }
        // Corners that are the southern one of no pixel: between two northern base faces, at the northern ends of those
        // of the belt, and the north pole.
        for [k, y] in self.northern_sides(numbers) {
            let next = (k + 1) % 4;
            add(&[
                Pixel { face: k, x: last, y },
                Pixel { face: k, x: last, y: y - 1 },
                Pixel { face: next, x: y - 1, y: last },
                Pixel { face: next, x: y, y: last },
            ]);
        }
        for k in 0..4 {
            let next = (k + 1) % 4;
            add(&[
                Pixel { face: k, x: last, y: 0 },
                Pixel { face: 4 + next, x: last, y: last },
                Pixel { face: next, x: 0, y: last },
            ]);
        }
        add(&[0, 1, 2, 3].map(|face| Pixel { face, x: last, y: last }));
        Ok(faces)
    }

    /// Corners between two northern base faces, without their ends, at which pixels are: the western face, and the
    /// place along the side from 1 on.
    fn northern_sides(self, numbers: &PixelNumbers) -> Vec<[u64; 2]> {
        let last = self.n_side - 1;
        let PixelNumbers::Some { of_vertex, .. } = numbers else {
            return (0..4).flat_map(|k| (1..=last).map(move |y| [k, y])).collect();
        };
        let mut sides = Vec::new();
        for &number in of_vertex {
            let Pixel { face, x, y } = self.pixel(number);
            // Three pixels are needed, so one of the western face is there.
            if face < 4 && x == last {
                sides.extend([y, y + 1].into_iter().filter(|y| (1..=last).contains(y)).map(|y| [face, y]));
            }
        }
        sides.sort_unstable();
        sides.dedup();
        sides
    }

    /// Numbers of the pixels whose southern corner belongs to one of the pixels of a part of the sphere, increasing;
    /// `None` for the whole sphere.
    fn owners(self, numbers: &PixelNumbers, progress: Progress<'_>) -> Result<Option<Vec<u64>>, ReadError> {
        let PixelNumbers::Some { of_vertex, .. } = numbers else { return Ok(None) };
        let mut owners: Vec<u64> = Vec::with_capacity(4 * of_vertex.len());
        for (k, &number) in of_vertex.iter().enumerate() {
            report_row(progress, k as u64, of_vertex.len() as u64)?;
            let pixel = self.pixel(number);
            let (east, west) = (self.north_east(pixel), self.north_west(pixel));
            // At corners of three pixels and at the pole these may be others, which own corners of their own.
            let around = [pixel, east, west, self.north_west(east), self.north_east(west)];
            owners.extend(around.map(|pixel| self.number(pixel)));
        }
        owners.push(self.number(Pixel { face: 8, x: 0, y: 0 }));
        owners.sort_unstable();
        owners.dedup();
        Ok(Some(owners))
    }

    /// Centers of the pixels of all vertices.
    pub(super) fn centers(
        self,
        numbers: &PixelNumbers,
        n: usize,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, ReadError> {
        Ok(collect(n, progress, |vertex| self.center(self.pixel(numbers.number(vertex))))?)
    }
}

/// Pixels of the vertices of a map.
#[derive(Clone, Debug)]
pub(super) enum PixelNumbers {
    /// Vertex k is pixel k, and all pixels are there.
    All,
    /// Some pixels.
    Some {
        /// Number of the pixel of each vertex.
        of_vertex: Vec<u64>,
        /// Pixel numbers in increasing order, with their vertices.
        sorted: Vec<(u64, u32)>,
    },
}

impl PixelNumbers {
    /// Pixels of vertices by their numbers, which must be different.
    ///
    /// # Errors
    /// [`ReadError::Whole`] if two numbers are equal or one is beyond the sphere.
    pub(super) fn new(of_vertex: Vec<u64>, n_pixels: u64) -> Result<Self, ReadError> {
        let mut sorted: Vec<(u64, u32)> =
            of_vertex.iter().enumerate().map(|(vertex, &number)| (number, vertex as u32)).collect();
        sorted.sort_unstable();
        if let Some(&(number, vertex)) = sorted.last()
            && number >= n_pixels
        {
            return Err(ReadError::Whole(format!(
                "row {vertex} of the map names pixel {number}, but there are {n_pixels}; correct the file"
            )));
        }
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(ReadError::Whole(format!(
                "rows {} and {} of the map name the same pixel {}; remove one of them",
                pair[0].1, pair[1].1, pair[0].0
            )));
        }
        Ok(Self::Some { of_vertex, sorted })
    }

    /// Number of the pixel of a vertex.
    pub(super) fn number(&self, vertex: usize) -> u64 {
        match self {
            Self::All => vertex as u64,
            Self::Some { of_vertex, .. } => of_vertex[vertex],
        }
    }

    /// Vertex of a pixel, if it is there.
    fn vertex(&self, number: u64) -> Option<u32> {
        match self {
            Self::All => Some(number as u32),
            Self::Some { sorted, .. } => {
                let at = sorted.binary_search_by_key(&number, |(number, _)| *number).ok()?;
                Some(sorted[at].1)
            }
        }
    }

    /// Pixels of some of the vertices.
    pub(super) fn subset(&self, vertices: &[u32]) -> Self {
        let of_vertex: Vec<u64> = vertices.iter().map(|&vertex| self.number(vertex as usize)).collect();
        let mut sorted: Vec<(u64, u32)> =
            of_vertex.iter().enumerate().map(|(vertex, &number)| (number, vertex as u32)).collect();
        sorted.sort_unstable();
        Self::Some { of_vertex, sorted }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N_SIDES: [u64; 7] = [1, 2, 3, 4, 5, 8, 16];

    /// Distance in space within which points are equal.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn numbers_lead_back_to_pixels_in_both_orders() {
        for n_side in N_SIDES {
            for ordering in [Ordering::Ring, Ordering::Nested] {
                if ordering == Ordering::Nested && !n_side.is_power_of_two() {
                    continue;
                }
                let pixels = Pixelization { n_side, ordering };
                for number in 0..pixels.n_pixels() {
                    assert_eq!(pixels.number(pixels.pixel(number)), number, "{n_side} {ordering:?}");
                }
            }
        }
        let large = Pixelization { n_side: MAX_N_SIDE, ordering: Ordering::Ring };
        for number in [0, 3, 4, 1 << 40, large.n_pixels() / 2, large.n_pixels() - 1] {
            assert_eq!(large.number(large.pixel(number)), number);
        }
    }

    #[test]
    fn centers_of_the_ring_order_are_those_of_the_paper() {
        // gorski2005, (4) to (9); on rings of the belt whose s is 0 the first center is at φ = 0, as in its programs.
        for n_side in N_SIDES {
            let pixels = Pixelization { n_side, ordering: Ordering::Ring };
            let mut number = 0;
            for ring in 1..4 * n_side {
                let (r, n) = (ring.min(4 * n_side - ring).min(n_side), n_side as f64);
                let from_pole = ring.min(4 * n_side - ring) as f64;
                let z = if r < n_side {
                    (1.0 - from_pole * from_pole / (3.0 * n * n)) * if ring < n_side { 1.0 } else { -1.0 }
                } else {
                    4.0 / 3.0 - 2.0 * ring as f64 / (3.0 * n)
                };
                let s = if r < n_side { 1 } else { (ring - n_side + 1) % 2 };
                for j in 0..4 * r {
                    let longitude = std::f64::consts::FRAC_PI_2 / r as f64 * (j as f64 + s as f64 / 2.0);
                    let rho = (1.0 - z * z).sqrt();
                    let expected = [rho * longitude.cos(), rho * longitude.sin(), z];
                    let found = pixels.center(pixels.pixel(number));
                    for c in 0..3 {
                        assert!((found[c] - expected[c]).abs() < ROUNDING, "{n_side} {ring} {j}");
                    }
                    number += 1;
                }
            }
            assert_eq!(number, pixels.n_pixels());
        }
    }

    #[test]
    fn the_mesh_of_all_pixels_is_a_closed_sphere() {
        for n_side in N_SIDES {
            let pixels = Pixelization { n_side, ordering: Ordering::Ring };
            let n = pixels.n_pixels() as usize;
            let faces = pixels.dual_faces(&PixelNumbers::All, Progress::none()).unwrap();
            let points = pixels.centers(&PixelNumbers::All, n, Progress::none()).unwrap();
            // Euler: 12n² vertices, 24n² edges.
            assert_eq!(faces.len(), n + 2);
            let mut sides = std::collections::HashSet::new();
            for face in faces.iter() {
                for k in 0..face.len() {
                    assert!(sides.insert([face[k], face[(k + 1) % face.len()]]), "{n_side}: {face:?}");
                }
                let [a, b, c] = [0, 1, 2].map(|k| points[face[k] as usize]);
                let minus = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
                let (u, v) = (minus(b), minus(c));
                let outward = a[0] * (u[1] * v[2] - u[2] * v[1])
                    + a[1] * (u[2] * v[0] - u[0] * v[2])
                    + a[2] * (u[0] * v[1] - u[1] * v[0]);
                assert!(outward > 0.0, "{n_side}: {face:?}");
            }
            assert_eq!(sides.len(), 2 * (n + faces.len() - 2));
            assert!(sides.iter().all(|&[a, b]| sides.contains(&[b, a])));
        }
    }

    #[test]
    fn a_part_has_the_faces_of_the_whole_among_its_pixels() {
        for n_side in [1, 2, 4, 8] {
            for ordering in [Ordering::Ring, Ordering::Nested] {
                let pixels = Pixelization { n_side, ordering };
                let whole = pixels.dual_faces(&PixelNumbers::All, Progress::none()).unwrap();
                for seed in 0..8_u64 {
                    let taken: Vec<u64> = (0..pixels.n_pixels())
                        .filter(|number| (number + 1).wrapping_mul(2 * seed + 0x9e37_79b9) >> 5 & 3 != 0)
                        .collect();
                    let part = PixelNumbers::new(taken.clone(), pixels.n_pixels()).unwrap();
                    let found = pixels.dual_faces(&part, Progress::none()).unwrap();
                    let mut found: Vec<Vec<u64>> = found
                        .iter()
                        .map(|face| face.iter().map(|&vertex| taken[vertex as usize]).collect())
                        .collect();
                    let mut expected: Vec<Vec<u64>> = whole
                        .iter()
                        .map(|face| {
                            face.iter().map(|&p| u64::from(p)).filter(|p| taken.contains(p)).collect()
                        })
                        .filter(|face: &Vec<u64>| face.len() >= 3)
                        .collect();
                    found.sort();
                    expected.sort();
                    assert_eq!(found, expected, "{n_side} {ordering:?} {seed}");
                }
            }
        }
    }
}
