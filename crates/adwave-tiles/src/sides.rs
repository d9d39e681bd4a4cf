//! Which normals of a cloud are on the same side of its surface, over all tiles.
//!
//! The side is carried from point to point along the spanning tree of least cost, of all points and pairs of neighbors, as
//! [`cloud_normals`](adwave::signal::cloud_normals) has it; pairs of equal cost count in the order of the curve, so that there is one such
//! tree. A tile finds the pairs of its own that are in it for certain: taken by rising cost, a pair that joins two groups of points of which
//! one has no neighbor in another tile is the cheapest that leaves that group. Points that are joined so are a piece. All other pairs that
//! may be in the tree are few, and are looked at together.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave::signal::{plane_normals, side_step};
use rayon::prelude::*;

use crate::TilesError;
use crate::blocks::Blocks;
use crate::files::{At, Cursor, write_whole};
use crate::layout::u32_at;
use crate::part::{Limits, Neighborhoods, Part, each_part};
use crate::stretches::Stretches;

/// Groups of points, and of each point whether its normal is on the other side than that of its group's first.
struct Groups {
    parent: Vec<u32>,
    size: Vec<u32>,
    turned: Vec<bool>,
}

impl Groups {
    fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), size: vec![1; n], turned: vec![false; n] }
    }

    /// The root of a point, and whether the point is turned against it.
    fn find(&mut self, x: u32) -> (u32, bool) {
        let (mut root, mut turned) = (x, false);
        while self.parent[root as usize] != root {
            turned ^= self.turned[root as usize];
            root = self.parent[root as usize];
        }
        let (mut at, mut left) = (x, turned);
        while self.parent[at as usize] != root {
            let (parent, own) = (self.parent[at as usize], self.turned[at as usize]);
            self.parent[at as usize] = root;
            self.turned[at as usize] = left;
            left ^= own;
            at = parent;
        }
        (root, turned)
    }

    /// Makes one group of those of x and y, whose normals are on other sides where it `turns`; the roots that they had.
    fn join(&mut self, x: u32, y: u32, turns: bool) -> Option<[u32; 2]> {
        let ((a, of_x), (b, of_y)) = (self.find(x), self.find(y));
        if a == b {
            return None;
        }
        let (root, below) = if self.size[a as usize] < self.size[b as usize] { (b, a) } else { (a, b) };
        self.parent[below as usize] = root;
        self.size[root as usize] += self.size[below as usize];
        self.turned[below as usize] = of_x ^ of_y ^ turns;
        Some([root, below])
    }
}

/// A pair of neighbors that may be in the tree: what it costs, where its ends are along the curve, whether their normals as planes have
/// them are on other sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    /// The bits of the cost, which are in its order.
    cost: u32,
    x: u32,
    y: u32,
    turns: bool,
}

const MARK: &[u8; 8] = b"adwside1";
/// Bytes before the labels: the mark, and how many vertices, pieces and pairs there are.
const HEAD: usize = 8 + 3 * 8;
/// Bytes of a label: the number of the piece in its tile, twice, and 1 where the vertex is turned against it.
const LABEL: usize = 4;
/// Bytes of a pair.
const PAIR: usize = 16;

/// What a tile finds.
#[derive(Default)]
struct Found {
    labels: Vec<u32>,
    n_pieces: u32,
    pairs: Vec<Pair>,
}

/// Finds and writes the pieces of the blocks `tile`.
pub(crate) fn sides_of_tile(
    blocks: &Blocks,
    neighborhoods: &Neighborhoods,
    tile: Range<usize>,
    limits: Limits,
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let mut found = Found::default();
    // Whose normals the pairs compare, and whose places these normals ask for.
    let limits = Limits { rings: 2, ..limits };
    each_part(blocks, neighborhoods, tile, limits, progress, |part, tile| {
        found.add(&part, blocks.vertices(tile.start).start, neighborhoods, progress)
    })?;
    write_whole(path, |out| {
        let mut head = MARK.to_vec();
        for n in [found.labels.len(), found.n_pieces as usize, found.pairs.len()] {
            head.extend((n as u64).to_le_bytes());
        }
        let mut put = |bytes: &[u8]| out.write_all(bytes).map_err(TilesError::io(path));
        put(&head)?;
        found.labels.iter().try_for_each(|label| put(&label.to_le_bytes()))?;
        found.pairs.iter().try_for_each(|pair| {
            [pair.cost, pair.x, pair.y, pair.turns.into()].iter().try_for_each(|n| put(&n.to_le_bytes()))
        })
    })
}

/// Vertices whose pairs a thread looks at, one after the other.
const VERTICES_AT_A_TIME: usize = 1 << 12;

impl Found {
    /// The pieces of a part, whose own vertices begin at the place `first`.
    fn add(
        &mut self,
        part: &Part,
        first: usize,
        neighborhoods: &Neighborhoods,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let normals = plane_normals(&part.points, &part.neighbors, progress)?;
        let step = |x: usize, y: usize| {
            let of = |x: usize| (part.points[x], normals[x], neighborhoods.radius(part.areas[x]));
            side_step(of(x), of(y))
        };
        let own = part.own.clone();
        let pairs_of = |range: Range<usize>| {
            progress.check()?;
            let (mut inside, mut across) = (Vec::new(), Vec::new());
            for x in range {
                for &y in part.neighbors.row(x) {
                    let y = y as usize;
                    if y < x && own.contains(&y) {
                        continue; // looked at from there
                    }
                    let step = step(x, y);
                    let cost = (step.cost as f32).to_bits();
                    let pair = Pair { cost, x: x as u32, y: y as u32, turns: step.turns };
                    if own.contains(&y) { inside.push(pair) } else { across.push(pair) }
                }
            }
            Ok((inside, across))
        };
        let starts: Vec<usize> = own.clone().step_by(VERTICES_AT_A_TIME).collect();
        let of_chunks: Vec<(Vec<Pair>, Vec<Pair>)> = starts
            .into_par_iter()
            .map(|start| pairs_of(start..(start + VERTICES_AT_A_TIME).min(own.end)))
            .collect::<Result<_, TilesError>>()?;
        let (inside, across): (Vec<Vec<Pair>>, Vec<Vec<Pair>>) = of_chunks.into_iter().unzip();
        let (mut inside, across) = (inside.concat(), across.concat());
        inside.par_sort_unstable();
        progress.check()?;
        let (n, number) = (own.len(), |x: u32| x - own.start as u32);
        // Groups that the cheapest pairs join, whether certain or not; which of them have a neighbor elsewhere; pieces.
        let (mut groups, mut pieces) = (Groups::new(n), Groups::new(n));
        let mut is_open = vec![false; n];
        for pair in &across {
            is_open[number(pair.x) as usize] = true;
        }
        let place = |x: u32| {
            let x = x as usize;
            if own.contains(&x) { (first + x - own.start) as u32 } else { part.stretches.place(x) as u32 }
        };
        let as_placed = |pair: &Pair| Pair { x: place(pair.x), y: place(pair.y), ..*pair };
        for pair in &inside {
            let (x, y) = (number(pair.x), number(pair.y));
            let (a, b) = (groups.find(x).0, groups.find(y).0);
            let is_certain = !is_open[a as usize] || !is_open[b as usize];
            let Some([root, below]) = groups.join(x, y, pair.turns) else { continue };
            is_open[root as usize] |= is_open[below as usize];
            if is_certain {
                pieces.join(x, y, pair.turns);
            } else {
                self.pairs.push(as_placed(pair));
            }
        }
        // Of two tiles the one that comes first along the curve names a pair.
        self.pairs.extend(across.iter().map(as_placed).filter(|pair| pair.x < pair.y));
        let mut names = vec![u32::MAX; n];
        for x in 0..n as u32 {
            let (root, turned) = pieces.find(x);
            let name = &mut names[root as usize];
            if *name == u32::MAX {
                *name = self.n_pieces;
                self.n_pieces += 1;
            }
            self.labels.push(*name << 1 | u32::from(turned));
        }
        Ok(())
    }
}

/// The labels of a tile, on disk.
struct Labels {
    file: At,
    n: usize,
    n_pieces: usize,
    n_pairs: usize,
}

impl Labels {
    /// Of a tile of `n` vertices.
    fn open(path: &Path, n: usize) -> Result<Self, TilesError> {
        let file = At::open(path)?;
        let head = file.read(0, HEAD)?;
        let broken = |what: &str| TilesError::broken(path, what);
        let mut cursor =
            Cursor { bytes: head.strip_prefix(MARK).ok_or_else(|| broken("it is another file"))? };
        let mut number = || cursor.u64().and_then(|n| usize::try_from(n).ok());
        let (Some(found), Some(n_pieces), Some(n_pairs)) = (number(), number(), number()) else {
            return Err(broken("it ends early"));
        };
        let bytes = n_pairs.checked_mul(PAIR).and_then(|bytes| bytes.checked_add(HEAD + LABEL * n));
        if found != n || n_pieces > n || bytes.map(|bytes| bytes as u64) != Some(file.len()) {
            return Err(broken("it is of other vertices"));
        }
        Ok(Self { file, n, n_pieces, n_pairs })
    }

    /// Of some of the vertices: the piece, and whether they are turned against it.
    fn read(&self, range: Range<usize>) -> Result<Vec<(usize, bool)>, TilesError> {
        let bytes = self.file.read((HEAD + LABEL * range.start) as u64, LABEL * range.len())?;
        let label = |bytes: &[u8; 4]| {
            let label = u32::from_le_bytes(*bytes);
            let piece = (label >> 1) as usize;
            (piece < self.n_pieces).then_some((piece, label & 1 == 1))
        };
        let labels: Option<Vec<_>> = bytes.as_chunks::<LABEL>().0.iter().map(label).collect();
        labels.ok_or_else(|| TilesError::broken(self.file.path(), "it names no piece"))
    }

    fn pairs(&self) -> Result<Vec<Pair>, TilesError> {
        let bytes = self.file.read((HEAD + LABEL * self.n) as u64, PAIR * self.n_pairs)?;
        let pair = |bytes: &[u8; PAIR]| {
            let [cost, x, y, turns] = [0, 4, 8, 12].map(|at| u32_at(bytes, at));
            Pair { cost, x, y, turns: turns != 0 }
        };
        Ok(bytes.as_chunks::<PAIR>().0.iter().map(pair).collect())
    }
}

/// The sides of all vertices.
pub(crate) struct Sides {
    tiles: Vec<Labels>,
    /// Whether a piece is turned, tile after tile.
    turned: Vec<u8>,
    /// The first piece of each tile among these.
    first_pieces: Vec<usize>,
    vertices_per_tile: usize,
}

impl Sides {
    /// From the files of all tiles, `path` where the sides of all pieces are, or are to be.
    pub(crate) fn open(
        paths: &[PathBuf],
        path: &Path,
        n_vertices: usize,
        vertices_per_tile: usize,
        progress: Progress<'_>,
    ) -> Result<Self, TilesError> {
        let (mut tiles, mut first_pieces, mut n_pieces) = (Vec::new(), Vec::new(), 0);
        for (tile, path) in paths.iter().enumerate() {
            let first = tile * vertices_per_tile;
            let labels = Labels::open(path, vertices_per_tile.min(n_vertices.saturating_sub(first)))?;
            first_pieces.push(n_pieces);
            n_pieces += labels.n_pieces;
            tiles.push(labels);
        }
        let mut sides = Self { tiles, turned: Vec::new(), first_pieces, vertices_per_tile };
        if !path.exists() {
            let turned = sides.turned(n_pieces, progress)?;
            write_whole(path, |out| out.write_all(&turned).map_err(TilesError::io(path)))?;
        }
        sides.turned = std::fs::read(path).map_err(TilesError::io(path))?;
        if sides.turned.len() != n_pieces {
            return Err(TilesError::broken(path, "it is of other pieces"));
        }
        Ok(sides)
    }

    /// Whether each piece is turned against the first of those that it is connected with.
    fn turned(&self, n_pieces: usize, progress: Progress<'_>) -> Result<Vec<u8>, TilesError> {
        let mut pairs = Vec::new();
        for tile in &self.tiles {
            progress.check()?;
            pairs.extend(tile.pairs()?);
        }
        pairs.par_sort_unstable();
        // What is known of the ends, by place.
        let mut ends: Vec<u32> = pairs.iter().flat_map(|pair| [pair.x, pair.y]).collect();
        ends.par_sort_unstable();
        ends.dedup();
        let mut of_ends = Vec::with_capacity(ends.len());
        let mut rest = &ends[..];
        for (tile, labels) in self.tiles.iter().enumerate() {
            progress.check()?;
            let first = tile * self.vertices_per_tile;
            let (here, after) = rest.split_at(rest.partition_point(|&x| (x as usize) < first + labels.n));
            rest = after;
            let labels = if here.is_empty() { Vec::new() } else { labels.read(0..labels.n)? };
            of_ends.extend(here.iter().map(|&x| {
                let (piece, turned) = labels[x as usize - first];
                ((self.first_pieces[tile] + piece) as u32, turned)
            }));
        }
        if !rest.is_empty() {
            let path = self.tiles.first().map_or_else(PathBuf::new, |tile| tile.file.path().to_owned());
            return Err(TilesError::broken(&path, "it names a vertex that is not there"));
        }
        let of = |x: u32| of_ends[ends.partition_point(|&end| end < x)];
        let mut groups = Groups::new(n_pieces);
        for pair in &pairs {
            let ((a, of_x), (b, of_y)) = (of(pair.x), of(pair.y));
            groups.join(a, b, pair.turns ^ of_x ^ of_y);
        }
        Ok((0..n_pieces as u32).map(|piece| u8::from(groups.find(piece).1)).collect())
    }

    /// Whether the normals at some places, as planes have them, are on the other side.
    pub(crate) fn are_turned(&self, places: &Stretches) -> Result<Vec<bool>, TilesError> {
        let mut turned = Vec::with_capacity(places.len());
        for stretch in places.ranges() {
            let mut place = stretch.start;
            while place < stretch.end {
                let tile = place / self.vertices_per_tile;
                let first = tile * self.vertices_per_tile;
                let end = stretch.end.min(first + self.tiles[tile].n);
                let labels = self.tiles[tile].read(place - first..end - first)?;
                turned.extend(labels.into_iter().map(|(piece, is_turned)| {
                    is_turned ^ (self.turned[self.first_pieces[tile] + piece] != 0)
                }));
                place = end;
            }
        }
        Ok(turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_know_who_is_turned_against_whom() {
        let mut groups = Groups::new(6);
        assert!(groups.join(0, 1, true).is_some());
        assert!(groups.join(2, 3, false).is_some());
        assert!(groups.join(1, 3, true).is_some());
        assert!(groups.join(0, 2, true).is_none()); // known already, and not taken
        assert!(groups.join(4, 3, true).is_some());
        let (root, _) = groups.find(0);
        let turned: Vec<bool> = (0..5).map(|x| groups.find(x).1).collect();
        let against_0: Vec<bool> = turned.iter().map(|t| t ^ turned[0]).collect();
        assert_eq!(against_0, [false, true, false, false, true]);
        assert!((0..5).all(|x| groups.find(x).0 == root) && groups.find(5).0 == 5);
    }
}
