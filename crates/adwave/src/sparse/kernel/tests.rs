//! Comparison of every variant of the loops with the checked one.

use super::*;
use crate::Progress;
use crate::operator::{Diffusion, OperatorParams, local_operator};
use crate::shape::{Graph, PreparedGeometry, Shape};
use crate::sparse::tiles::{TileList, Tiles};
use std::sync::Arc;

/// A graph with rows of 1 to 13 entries.
fn diffusion(n: u32) -> Arc<Diffusion> {
    let edges: Vec<_> = (0..n)
        .flat_map(|u| (1..=1 + u % 7).map(move |e| (u, (u + e * e) % n, 1.0 + f64::from((u * e) % 5))))
        .collect();
    let shape = Shape::Graph(Graph::new(n as usize, &edges).expect("edges of the graph"));
    let params = OperatorParams::default();
    let geometry = PreparedGeometry::new(&shape, params.weld, Progress::none()).unwrap();
    Arc::new(
        Diffusion::new(local_operator(&geometry, &params, Progress::none()).unwrap(), Progress::none())
            .unwrap(),
    )
}

struct PassOutcome<T> {
    bands: Vec<f64>,
    now: Vec<T>,
    before: Vec<T>,
    squares: Vec<f64>,
}

/// Location of the vectors before and after a pass.
#[derive(Clone, Copy, PartialEq)]
enum VectorStorage {
    Apart,
    InPlace,
}

/// One pass of `n_steps` over all tiles, by `kernel`; in place it reads entries in the order of the tiles.
fn pass<I: Index, T: VectorNumber>(
    tiles: &TileList<I>,
    (n, width, n_steps): (usize, usize, usize),
    (is_first, is_lazy, place): (bool, bool, VectorStorage),
    kernel: impl Fn(TileView<'_, I>, TilePass<'_, '_, T>, &mut [T]) -> Vec<f64>,
) -> PassOutcome<T> {
    let value = |i: usize| ((i * 37 + 11) % 101) as f64 / 7.0 - 6.0;
    let rounded = |value: f64| T::rounded(value, 1.0);
    let now: Vec<T> = (0..n * width).map(|i| rounded(value(i))).collect();
    let before: Vec<T> = (0..n * width).map(|i| rounded(value(i + 5))).collect();
    let exact_entries = tiles.diffusion().weights();
    let entries: Vec<T> = exact_entries.iter().map(|&w| rounded(w)).collect();
    let weights: Vec<f64> = (0..n).map(|x| 1.0 + value(x).abs()).collect();
    let coefficients: Vec<f64> = (0..=n_steps).map(|i| 1.0 / (1.0 + i as f64)).collect();
    let first = usize::from(!is_first);
    let term =
        PassTerm { coefficients: coefficients[first..].to_vec(), first, is_new: is_first, is_weighed: true };
    let mut out = PassOutcome {
        bands: vec![1.0; n * width],
        now: if place == VectorStorage::InPlace { now.clone() } else { vec![T::default(); n * width] },
        before: if place == VectorStorage::InPlace { before.clone() } else { vec![T::default(); n * width] },
        squares: Vec::new(),
    };
    for tile in tiles.iter() {
        let own = tile.first() * width..(tile.first() + tile.n_own()) * width;
        let around = |from: &[T], rings: usize| {
            let mut around = vec![rounded(f64::NAN); (tile.n_within(rings) - tile.n_own()) * width];
            copy_halo(tile, width, from, &mut around);
            around
        };
        let (around_now, around_before) = (around(&now, n_steps), around(&before, n_steps - 1));
        let mut of_tile = vec![rounded(f64::NAN); n_tile_entries(tile)];
        gather_tile(tile, exact_entries, &mut of_tile);
        let pass = TilePass {
            entries: match place {
                VectorStorage::Apart => TileEntries::Operator(&entries),
                VectorStorage::InPlace => TileEntries::Tile(&of_tile),
            },
            input: match place {
                VectorStorage::Apart => PassInput::Whole { before: &before, now: &now },
                VectorStorage::InPlace => PassInput::Copied { before: &around_before, now: &around_now },
            },
            n_steps,
            is_first,
            is_lazy,
            next_before: &mut out.before[own.clone()],
            next_now: &mut out.now[own.clone()],
            terms: std::slice::from_ref(&term),
            weights: &weights[tile.first()..],
            outs: &mut [&mut out.bands[own]],
            stride: width,
            at: 0,
            normals: &[],
        };
        let mut scratch = vec![rounded(f64::NAN); scratch_len::<_, T>(tile, n_steps, lanes(width))];
        out.squares.extend(kernel(tile, pass, &mut scratch));
    }
    out
}

fn narrow(diffusion: &Arc<Diffusion>, own: usize) -> TileList<u16> {
    match Tiles::new(diffusion, own, 4, Progress::none()) {
        Ok(Tiles::Narrow(tiles)) => tiles,
        _ => panic!("a small operator has narrow tiles"),
    }
}

#[test]
fn a_pass_is_the_recurrence_row_by_row() {
    assert_recurrence::<f64>(1e-10);
    // Four steps that multiply rounding by up to four each, of values of up to some hundreds.
    assert_recurrence::<f32>(1e-2);
}

fn assert_recurrence<T: VectorNumber>(rounding: f64) {
    let (n, n_steps) = (300, 4);
    let diffusion = diffusion(n as u32);
    let value = |i: usize| ((i * 37 + 11) % 101) as f64 / 7.0 - 6.0;
    let mut vectors: Vec<Vec<f64>> =
        vec![(0..n).map(|i| value(i + 5)).collect(), (0..n).map(value).collect()];
    for i in 1..=n_steps {
        let twice_y = |x: usize| {
            let (columns, weights) = diffusion.row(x);
            let moved: f64 = columns.iter().zip(weights).map(|(&y, w)| w * vectors[i][y as usize]).sum();
            4.0 * (moved + diffusion.diagonal(x) * vectors[i][x]) - 2.0 * vectors[i][x]
        };
        let next = (0..n).map(|x| twice_y(x) - vectors[i - 1][x]).collect();
        vectors.push(next);
    }
    let cases = [true, false]
        .into_iter()
        .flat_map(|lazy| [(lazy, VectorStorage::Apart), (lazy, VectorStorage::InPlace)]);
    for (is_lazy, place) in cases {
        let start = (false, is_lazy, place);
        let found = pass::<_, T>(&narrow(&diffusion, 70), (n, 1, n_steps), start, |tile, pass, scratch| {
            run(InstructionSet::detect(), tile, 1, pass, scratch)
        });
        for (x, now) in found.now.iter().enumerate().take(n) {
            assert!((now.to_f64() - vectors[n_steps + 1][x]).abs() < rounding);
            assert!((found.before[x].to_f64() - vectors[n_steps][x]).abs() < rounding);
            let band: f64 = (1..=n_steps).map(|i| vectors[i + 1][x] / (1.0 + i as f64)).sum();
            assert!((found.bands[x] - 1.0 - band).abs() < rounding, "{} {band}", found.bands[x]);
        }
    }
}

/// The pass with bounds checks, with or without fused multiply-add.
fn run_checked<T: VectorNumber, const FMA: bool>(
    tile: TileView<'_, u16>,
    width: usize,
    pass: TilePass<'_, '_, T>,
    scratch: &mut [T],
) -> Vec<f64> {
    match width {
        1 => steps::<u16, T, 1, 1, FMA, true>(tile, pass, scratch),
        2 => steps::<u16, T, 2, 2, FMA, true>(tile, pass, scratch),
        3 => steps::<u16, T, 4, 3, FMA, true>(tile, pass, scratch),
        _ => steps::<u16, T, 4, 4, FMA, true>(tile, pass, scratch),
    }
}

#[test]
fn unchecked_loops_give_the_bits_of_checked_ones() {
    assert_bits_of_checked::<f64>();
    assert_bits_of_checked::<f32>();
}

fn assert_bits_of_checked<T: VectorNumber + PartialEq>() {
    let diffusion = diffusion(300);
    let tiles = narrow(&diffusion, 70);
    for width in 1..=4 {
        let cases = [
            (1, true, VectorStorage::Apart),
            (4, true, VectorStorage::InPlace),
            (3, false, VectorStorage::Apart),
            (2, false, VectorStorage::InPlace),
        ];
        let both = cases.into_iter().flat_map(|case| [(case, true), (case, false)]);
        for ((n_steps, is_first, place), is_lazy) in both {
            let (size, start) = ((300, width, n_steps), (is_first, is_lazy, place));
            let safe = pass(&tiles, size, start, |tile, pass, scratch| {
                run_checked::<T, FUSED>(tile, width, pass, scratch)
            });
            let fast = pass::<_, T>(&tiles, size, start, |tile, pass, scratch| {
                run(InstructionSet::Portable, tile, width, pass, scratch)
            });
            assert_eq!((&safe.bands, &safe.now), (&fast.bands, &fast.now));
            assert_eq!((&safe.before, &safe.squares), (&fast.before, &fast.squares));
            if InstructionSet::detect() == InstructionSet::Portable {
                continue;
            }
            // A fused multiply-add rounds once, as an instruction or as a function.
            let safe = pass(&tiles, size, start, |tile, pass, scratch| {
                run_checked::<T, true>(tile, width, pass, scratch)
            });
            let fast = pass::<_, T>(&tiles, size, start, |tile, pass, scratch| {
                run(InstructionSet::detect(), tile, width, pass, scratch)
            });
            assert_eq!((&safe.bands, &safe.now, &safe.before), (&fast.bands, &fast.now, &fast.before));
        }
    }
}

#[test]
fn every_target_agrees_with_the_portable_one() {
    /// A few roundings of values of at most some hundreds.
    const ROUNDING: f64 = 1e-11;
    let diffusion = diffusion(300);
    let tiles = narrow(&diffusion, 70);
    let mut targets = vec![InstructionSet::detect()];
    #[cfg(target_arch = "x86_64")]
    if InstructionSet::detect() == InstructionSet::Avx512 {
        targets.push(InstructionSet::Avx2);
    }
    for target in targets {
        for (width, is_lazy) in (1..=4).flat_map(|width| [(width, true), (width, false)]) {
            let with = |target| {
                pass::<_, f64>(
                    &tiles,
                    (300, width, 4),
                    (false, is_lazy, VectorStorage::Apart),
                    |tile, pass, scratch| run(target, tile, width, pass, scratch),
                )
            };
            let (portable, found) = (with(InstructionSet::Portable), with(target));
            for (a, b) in portable.bands.iter().zip(&found.bands).chain(portable.now.iter().zip(&found.now)) {
                assert!((a - b).abs() <= ROUNDING, "{target:?}, {width} channels: {a} and {b}");
            }
        }
    }
}

#[test]
fn neither_the_size_of_the_tiles_nor_of_their_numbers_changes_a_bit() {
    assert_bits_of_tiles::<f64>();
    assert_bits_of_tiles::<f32>();
}

fn assert_bits_of_tiles<T: VectorNumber + PartialEq>() {
    let diffusion = diffusion(500);
    let target = InstructionSet::detect();
    let small = narrow(&diffusion, 33);
    let one = pass::<_, T>(
        &narrow(&diffusion, 500),
        (500, 3, 4),
        (true, true, VectorStorage::Apart),
        |tile, pass, scratch| run(target, tile, 3, pass, scratch),
    );
    let many =
        pass::<_, T>(&small, (500, 3, 4), (true, true, VectorStorage::Apart), |tile, pass, scratch| {
            run(target, tile, 3, pass, scratch)
        });
    assert_eq!((&one.bands, &one.now, &one.before), (&many.bands, &many.now, &many.before));
    let wide = Tiles::wide(&diffusion, 33, 4, Progress::none()).expect("nobody stops it");
    let wide = pass::<_, T>(&wide, (500, 3, 4), (true, true, VectorStorage::Apart), |tile, pass, scratch| {
        run(target, tile, 3, pass, scratch)
    });
    assert_eq!((&wide.bands, &wide.now, &wide.squares), (&many.bands, &many.now, &many.squares));
    let in_place =
        pass::<_, T>(&small, (500, 3, 4), (true, true, VectorStorage::InPlace), |tile, pass, scratch| {
            run(target, tile, 3, pass, scratch)
        });
    assert_eq!((&in_place.bands, &in_place.now, &in_place.before), (&many.bands, &many.now, &many.before));
}
