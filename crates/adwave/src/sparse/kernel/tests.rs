//! Every variant of the loops against the checked one.

use super::*;
use crate::Progress;
use crate::operator::{Diffusion, OperatorParams, local_operator};
use crate::shape::{Graph, PreparedGeometry, Shape};
use crate::sparse::tiles::Tiles;

/// A graph with rows of 1 to 13 entries.
fn diffusion(n: u32) -> Diffusion {
    let edges: Vec<_> = (0..n)
        .flat_map(|u| (1..=1 + u % 7).map(move |e| (u, (u + e * e) % n, 1.0 + f64::from((u * e) % 5))))
        .collect();
    let shape = Shape::Graph(Graph::new(n as usize, &edges).expect("edges of the graph"));
    let params = OperatorParams::default();
    let geometry = PreparedGeometry::new(&shape, params.weld, Progress::none()).unwrap();
    Diffusion::new(local_operator(&geometry, &params, Progress::none()).unwrap(), Progress::none()).unwrap()
}

struct Outcome {
    bands: Vec<f64>,
    now: Vec<f64>,
    before: Vec<f64>,
    squares: Vec<f64>,
}

/// One pass of `n_steps` over all tiles, by `kernel`.
fn pass<I: Index>(
    tiles: &[Tile<I>],
    (n, width, n_steps): (usize, usize, usize),
    is_first: bool,
    kernel: impl Fn(&Tile<I>, Pass<'_, '_>, &mut [f64]) -> Vec<f64>,
) -> Outcome {
    let value = |i: usize| ((i * 37 + 11) % 101) as f64 / 7.0 - 6.0;
    let now: Vec<f64> = (0..n * width).map(value).collect();
    let before: Vec<f64> = (0..n * width).map(|i| value(i + 5)).collect();
    let weights: Vec<f64> = (0..n).map(|x| 1.0 + value(x).abs()).collect();
    let coefficients: Vec<f64> = (0..=n_steps).map(|i| 1.0 / (1.0 + i as f64)).collect();
    let first = usize::from(!is_first);
    let term = Term { coefficients: &coefficients[first..], first, is_new: is_first, is_weighed: true };
    let mut out = Outcome {
        bands: vec![1.0; n * width],
        now: vec![0.0; n * width],
        before: vec![0.0; n * width],
        squares: Vec::new(),
    };
    for tile in tiles {
        let own = tile.first() * width..(tile.first() + tile.n_own()) * width;
        let pass = Pass {
            before: &before,
            now: &now,
            n_steps,
            is_first,
            next_before: &mut out.before[own.clone()],
            next_now: &mut out.now[own.clone()],
            terms: std::slice::from_ref(&term),
            weights: &weights[tile.first()..],
            outs: &mut [&mut out.bands[own]],
            stride: width,
            at: 0,
        };
        let mut scratch = vec![f64::NAN; scratch_len(tile, n_steps, lanes(width))];
        out.squares.extend(kernel(tile, pass, &mut scratch));
    }
    out
}

fn narrow(diffusion: &Diffusion, own: usize) -> Vec<Tile<u16>> {
    match Tiles::new(diffusion, own, 4) {
        Tiles::Narrow(tiles) => tiles,
        Tiles::Wide(_) => panic!("a small walk has narrow tiles"),
    }
}

#[test]
fn unchecked_loops_give_the_bits_of_checked_ones() {
    let diffusion = diffusion(300);
    let tiles = narrow(&diffusion, 70);
    for width in 1..=4 {
        for (n_steps, is_first) in [(1, true), (4, true), (3, false)] {
            let size = (300, width, n_steps);
            let safe = pass(&tiles, size, is_first, |tile, pass, scratch| {
                by_width::<u16, FUSED, true>(tile, width, pass, scratch)
            });
            let fast = pass(&tiles, size, is_first, |tile, pass, scratch| {
                run(Target::Portable, tile, width, pass, scratch)
            });
            assert_eq!((&safe.bands, &safe.now), (&fast.bands, &fast.now));
            assert_eq!((&safe.before, &safe.squares), (&fast.before, &fast.squares));
        }
    }
}

#[test]
fn every_target_agrees_with_the_portable_one() {
    /// A few roundings of values of at most some hundreds.
    const ROUNDING: f64 = 1e-11;
    let diffusion = diffusion(300);
    let tiles = narrow(&diffusion, 70);
    let mut targets = vec![Target::detect()];
    #[cfg(target_arch = "x86_64")]
    if Target::detect() == Target::Avx512 {
        targets.push(Target::Avx2);
    }
    for target in targets {
        for width in 1..=4 {
            let with = |target| {
                pass(&tiles, (300, width, 4), false, |tile, pass, scratch| {
                    run(target, tile, width, pass, scratch)
                })
            };
            let (portable, found) = (with(Target::Portable), with(target));
            for (a, b) in portable.bands.iter().zip(&found.bands).chain(portable.now.iter().zip(&found.now)) {
                assert!((a - b).abs() <= ROUNDING, "{target:?}, {width} channels: {a} and {b}");
            }
        }
    }
}

#[test]
fn neither_the_size_of_the_tiles_nor_of_their_numbers_changes_a_bit() {
    let diffusion = diffusion(500);
    let target = Target::detect();
    let small = narrow(&diffusion, 33);
    let one = pass(&narrow(&diffusion, 500), (500, 3, 4), true, |tile, pass, scratch| {
        run(target, tile, 3, pass, scratch)
    });
    let many = pass(&small, (500, 3, 4), true, |tile, pass, scratch| run(target, tile, 3, pass, scratch));
    assert_eq!((&one.bands, &one.now, &one.before), (&many.bands, &many.now, &many.before));
    let wide = Tiles::wide(&diffusion, 33, 4);
    let wide = pass(&wide, (500, 3, 4), true, |tile, pass, scratch| run(target, tile, 3, pass, scratch));
    assert_eq!((&wide.bands, &wide.now, &wide.squares), (&many.bands, &many.now, &many.squares));
}
