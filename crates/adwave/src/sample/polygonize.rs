//! Closed triangle meshes of implicit surfaces: dual marching cubes on a sparse grid.
//!
//! The grid is searched from coarse to fine, and balls of space that a bound shows to be empty are skipped, so the
//! cost is that of the surface instead of the volume. In each cell the crossed edges form loops. Each loop gives a
//! vertex, and each crossed grid edge a quad of the four cells around it: the dual of a marching-cubes surface.
//! That dual is a manifold unless two loops meet twice on one ambiguous face, and such faces are linked in the
//! other way (`wenger2013`, `schaefer2007`).

use super::cell::{Links, corner_offset, edge_index, link};
use super::implicit::{Implicit, Side, V3};
use rayon::prelude::*;

/// Cells along a block's edge.
const BLOCK: usize = 8;
/// Grid corners along a block's edge.
const CORNERS: usize = BLOCK + 1;

/// A triangle mesh under construction.
#[derive(Clone, Debug)]
pub(super) struct SampledSurface {
    pub(super) points: Vec<V3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A cell that the surface crosses.
#[derive(Clone, Debug)]
struct Cell {
    /// Position x + 8y + 64z within the block.
    place: u16,
    /// One bit per corner inside the surface.
    inside: u8,
    /// One bit per face that is linked in the other way.
    flips: u8,
    /// First of its vertices within the block.
    first: u16,
}

/// The crossed cells of one block, ordered by position, and their vertices.
#[derive(Debug)]
struct GridBlock {
    at: [i32; 3],
    cells: Vec<Cell>,
    points: Vec<V3>,
}

/// The blocks that the surface crosses, in order of z, y, x, before faces are built.
#[derive(Debug)]
pub(super) struct CrossedGrid {
    blocks: Vec<GridBlock>,
    links: Vec<Links>,
    spacing: f64,
    origin: V3,
}

impl CrossedGrid {
    /// Finds the cells of size `spacing` (model units) that the surface of `field` crosses. O(area / spacing²) time
    /// and memory.
    pub(super) fn new<F: Implicit>(field: &F, spacing: f64) -> Self {
        let (low, high) = field.bounds();
        let margin = V3::repeat(2.0 * spacing);
        let origin = low - margin;
        let extent = (high + margin - origin).max() / (spacing * BLOCK as f64);
        let mut size = (extent.ceil() as u32).max(1).next_power_of_two() as i32;
        let mut nodes = vec![[0_i32; 3]];
        // Every level of the descent keeps its order, whichever thread does the work.
        loop {
            let width = f64::from(size) * BLOCK as f64 * spacing;
            let reach = 0.5 * width * 3.0_f64.sqrt();
            nodes = nodes
                .into_par_iter()
                .filter(|at| {
                    let center = V3::from_fn(|a, _| (f64::from(at[a]) + 0.5) * width) + origin;
                    field.side_of_ball(center, reach).is_none()
                })
                .collect();
            if size == 1 {
                break;
            }
            size /= 2;
            nodes = nodes
                .into_par_iter()
                .flat_map_iter(|at| {
                    (0..8).map(move |c| std::array::from_fn(|a| 2 * at[a] + corner_offset(c)[a]))
                })
                .collect();
        }
        nodes.par_sort_unstable_by_key(|at| sort_key(*at));
        let links: Vec<Links> = (0..=255).map(|inside| link(inside, 0)).collect();
        let blocks = nodes
            .into_par_iter()
            .filter_map(|at| GridBlock::sample(field, &links, at, origin, spacing))
            .collect();
        let mut grid = Self { blocks, links, spacing, origin };
        grid.separate_double_contacts(field);
        grid
    }

    /// Number of vertices that the mesh will have.
    pub(super) fn n_vertices(&self) -> usize {
        self.blocks.iter().map(|b| b.points.len()).sum()
    }

    fn find(&self, at: [i32; 3]) -> Option<usize> {
        self.blocks.binary_search_by_key(&sort_key(at), |b| sort_key(b.at)).ok()
    }

    /// The block and the cell that contain grid cell `place`, which may lie outside block `b` by one.
    fn locate(&self, b: usize, place: [i32; 3]) -> Option<(usize, usize)> {
        let n = BLOCK as i32;
        let at: [i32; 3] = std::array::from_fn(|a| self.blocks[b].at[a] + place[a].div_euclid(n));
        let b = if at == self.blocks[b].at { b } else { self.find(at)? };
        let local = pack(place.map(|x| x.rem_euclid(n)));
        let c = self.blocks[b].cells.binary_search_by_key(&local, |c| c.place).ok()?;
        Some((b, c))
    }

    fn cell_links(&self, cell: &Cell) -> Links {
        if cell.flips == 0 { self.links[cell.inside as usize] } else { link(cell.inside, cell.flips) }
    }

    /// Faces on the far sides of the cells of block `b` that one loop passes twice in both adjacent cells: block
    /// and cell on this side, block and cell on the other, and the face's number on this side.
    fn double_contacts(&self, b: usize) -> Vec<(usize, usize, usize, usize, usize)> {
        let mut found = Vec::new();
        for (c, cell) in self.blocks[b].cells.iter().enumerate() {
            for axis in 0..3 {
                let face = 2 * axis + 1;
                if self.links[cell.inside as usize].twice & (1 << face) == 0 {
                    continue;
                }
                let mut place = unpack(cell.place);
                place[axis] += 1;
                let (nb, nc) =
                    self.locate(b, place).expect("a crossed face has a crossed cell on both sides");
                let beyond = self.blocks[nb].cells[nc].inside;
                if self.links[beyond as usize].twice & (1 << (face - 1)) != 0 {
                    found.push((b, c, nb, nc, face));
                }
            }
        }
        found
    }

    /// Links in the other way the faces on which one loop of either cell passes twice. Each change splits a loop in
    /// two in both cells and never joins any, so one sweep in a fixed order is enough.
    fn separate_double_contacts<F: Implicit>(&mut self, field: &F) {
        let this = &*self;
        let suspects: Vec<_> =
            (0..this.blocks.len()).into_par_iter().flat_map_iter(|b| this.double_contacts(b)).collect();
        let mut touched = Vec::new();
        for (b, c, nb, nc, face) in suspects {
            let here = self.cell_links(&self.blocks[b].cells[c]).twice & (1 << face) != 0;
            let there = self.cell_links(&self.blocks[nb].cells[nc]).twice & (1 << (face - 1)) != 0;
            if here && there {
                self.blocks[b].cells[c].flips |= 1 << face;
                self.blocks[nb].cells[nc].flips |= 1 << (face - 1);
                touched.extend([b, nb]);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        for b in touched {
            let (links, origin, spacing) = (&self.links, self.origin, self.spacing);
            self.blocks[b].refit_positions(field, links, origin, spacing);
        }
    }

    /// Builds the mesh: closed, 2-manifold, faces counter-clockwise as seen from outside.
    ///
    /// # Panics
    /// If the mesh has 2³² vertices or more.
    pub(super) fn into_surface(self) -> SampledSurface {
        let mut starts = Vec::with_capacity(self.blocks.len());
        let mut n = 0_usize;
        for block in &self.blocks {
            starts.push(u32::try_from(n).expect("fewer than 2^32 vertices"));
            n += block.points.len();
        }
        let triangles = (0..self.blocks.len())
            .into_par_iter()
            .flat_map_iter(|b| self.block_triangles(b, &starts))
            .collect();
        let points = self.blocks.into_iter().flat_map(|b| b.points).collect();
        SampledSurface { points, triangles }
    }

    fn block_triangles(&self, b: usize, starts: &[u32]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        for cell in &self.blocks[b].cells {
            for axis in 0..3 {
                let start_inside = cell.inside & 1 != 0;
                if start_inside == (cell.inside & (1 << (1 << axis)) != 0) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                // Counter-clockwise about +axis; the edge is at the far side of the cells before it.
                let round = [(1, 1), (0, 1), (0, 0), (1, 0)];
                let quad = round.map(|(du, dv)| {
                    let mut place = unpack(cell.place);
                    place[u] -= du;
                    place[v] -= dv;
                    let (nb, nc) = self.locate(b, place).expect("a crossed edge has four crossed cells");
                    let neighbor = &self.blocks[nb].cells[nc];
                    let edge = edge_index(axis, du as usize, dv as usize);
                    let which = u16::from(self.cell_links(neighbor).loop_of[edge]);
                    let local = neighbor.first + which;
                    (starts[nb] + u32::from(local), self.blocks[nb].points[local as usize])
                });
                let [a, b, c, d] = if start_inside { quad } else { [quad[3], quad[2], quad[1], quad[0]] };
                if (a.1 - c.1).norm_squared() <= (b.1 - d.1).norm_squared() {
                    triangles.extend([[a.0, b.0, c.0], [a.0, c.0, d.0]]);
                } else {
                    triangles.extend([[a.0, b.0, d.0], [b.0, c.0, d.0]]);
                }
            }
        }
        triangles
    }
}

impl GridBlock {
    fn sample<F: Implicit>(
        field: &F,
        links: &[Links],
        at: [i32; 3],
        origin: V3,
        spacing: f64,
    ) -> Option<Self> {
        let corner = |i: [usize; 3]| {
            origin + V3::from_fn(|a, _| (f64::from(at[a]) * BLOCK as f64 + i[a] as f64) * spacing)
        };
        let mut values = [f64::NAN; CORNERS * CORNERS * CORNERS];
        for i in boxes(2) {
            refine(field, &corner, i.map(|x| 4 * x), 4, spacing, &mut values);
        }
        let mut block = Self { at, cells: Vec::new(), points: Vec::new() };
        for [x, y, z] in boxes(BLOCK) {
            let around = std::array::from_fn(|c| {
                let [dx, dy, dz] = corner_offset(c).map(|d| d as usize);
                values[corner_index([x + dx, y + dy, z + dz])]
            });
            let inside = inside_mask(&around);
            if inside != 0 && inside != 255 {
                let cell = Cell { place: pack([x as i32, y as i32, z as i32]), inside, flips: 0, first: 0 };
                block.push(cell, &links[inside as usize], &around, corner([x, y, z]), spacing);
            }
        }
        block.points.shrink_to_fit();
        block.cells.shrink_to_fit();
        (!block.cells.is_empty()).then_some(block)
    }

    /// Adds a cell and one vertex for each of its loops: the mean of the loop's crossings.
    fn push(&mut self, mut cell: Cell, links: &Links, around: &[f64; 8], low: V3, spacing: f64) {
        cell.first = self.points.len() as u16;
        let mut sums = [(V3::zeros(), 0.0); 4];
        for axis in 0..3 {
            for (du, dv) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let which = links.loop_of[edge_index(axis, du, dv)];
                if which == Links::NONE {
                    continue;
                }
                let start = (du << ((axis + 1) % 3)) | (dv << ((axis + 2) % 3));
                let (f0, f1) = (around[start], around[start | (1 << axis)]);
                let mut crossing = V3::from(corner_offset(start).map(f64::from));
                crossing[axis] = f0 / (f0 - f1);
                sums[which as usize].0 += crossing;
                sums[which as usize].1 += 1.0;
            }
        }
        for (sum, n) in &sums[..links.n_loops as usize] {
            self.points.push(low + sum * (spacing / n));
        }
        self.cells.push(cell);
    }

    /// Recomputes the vertex positions for the present linking.
    fn refit_positions<F: Implicit>(&mut self, field: &F, links: &[Links], origin: V3, spacing: f64) {
        let cells = std::mem::take(&mut self.cells);
        let points = std::mem::take(&mut self.points);
        for cell in cells {
            let unflipped = &links[cell.inside as usize];
            if cell.flips == 0 {
                let old = cell.first as usize;
                let first = self.points.len() as u16;
                self.points.extend_from_slice(&points[old..old + unflipped.n_loops as usize]);
                self.cells.push(Cell { first, ..cell });
            } else {
                let place = unpack(cell.place);
                let whole: [i32; 3] = std::array::from_fn(|a| self.at[a] * BLOCK as i32 + place[a]);
                let low = origin + V3::from(whole.map(f64::from)) * spacing;
                let around = std::array::from_fn(|c| {
                    let whole: [i32; 3] = std::array::from_fn(|a| whole[a] + corner_offset(c)[a]);
                    field.value(origin + V3::from(whole.map(f64::from)) * spacing)
                });
                let relinked = link(cell.inside, cell.flips);
                self.push(cell, &relinked, &around, low, spacing);
            }
        }
    }
}

/// Fills the corner values of the box of `width` cells at `low`: ±∞ with the right sign where the bound excludes
/// the surface, the true value elsewhere.
fn refine<F: Implicit>(
    field: &F,
    corner: &impl Fn([usize; 3]) -> V3,
    low: [usize; 3],
    width: usize,
    spacing: f64,
    values: &mut [f64],
) {
    let half = width / 2;
    let reach = half as f64 * spacing * 3.0_f64.sqrt();
    let side = field.side_of_ball(corner(low.map(|x| x + half)), reach);
    if side.is_none() && width > 2 {
        for i in boxes(2) {
            refine(field, corner, std::array::from_fn(|a| low[a] + half * i[a]), half, spacing, values);
        }
        return;
    }
    for i in boxes(width + 1) {
        let i = std::array::from_fn(|a| low[a] + i[a]);
        let value = &mut values[corner_index(i)];
        match side {
            None if !value.is_finite() => *value = field.value(corner(i)),
            Some(Side::Inside) if value.is_nan() => *value = f64::NEG_INFINITY,
            Some(Side::Outside) if value.is_nan() => *value = f64::INFINITY,
            _ => {}
        }
    }
}

/// All index triples below `n`, x fastest.
fn boxes(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n * n * n).map(move |i| [i % n, i / n % n, i / (n * n)])
}

fn corner_index([x, y, z]: [usize; 3]) -> usize {
    x + CORNERS * (y + CORNERS * z)
}

fn inside_mask(around: &[f64; 8]) -> u8 {
    around.iter().enumerate().fold(0, |mask, (c, &f)| mask | (u8::from(f < 0.0) << c))
}

fn pack([x, y, z]: [i32; 3]) -> u16 {
    (x + 8 * (y + 8 * z)) as u16
}

fn unpack(place: u16) -> [i32; 3] {
    let place = i32::from(place);
    [place % 8, place / 8 % 8, place / 64]
}

fn sort_key(at: [i32; 3]) -> [i32; 3] {
    [at[2], at[1], at[0]]
}
