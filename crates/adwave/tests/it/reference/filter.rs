//! Eq. 18: `f′(x) = S_f(J,x) + Σ_j Γ(j,x)·W_f(j,x)`, Γ the product over the layers of `1 + r(x)·(g_j − 1)`.

use crate::reference::dense::{
    Bands, Mutant, bands, fill, local_operator, restricted, scaling_functions, weld,
};
use crate::reference::fast::{Fast, preset};
use crate::reference::shapes::{Case, Noise, cases, signal};
use crate::reference::{SEEN, assert_close, difference};

/// As for the bands, of which some are doubled.
const FILTER: f64 = 3e-11;

const LEVELS: usize = 5;

type Layers = Vec<(Vec<f64>, Vec<f64>)>;

fn filtered(bands: &Bands, n_channels: usize, layers: &Layers) -> Vec<f64> {
    let mut out = bands.scaling[bands.wavelet.len()].clone();
    for (i, value) in out.iter_mut().enumerate() {
        let x = i / n_channels;
        for (j, band) in bands.wavelet.iter().enumerate() {
            let mut gamma = 1.0;
            for (gains, weights) in layers {
                gamma *= 1.0 + weights[x] * (gains[j] - 1.0);
            }
            *value += gamma * band[i];
        }
    }
    out
}

/// Soft regions: 0 at some vertices, 1 at some, and anything between.
fn weights(n_vertices: usize, seed: u64) -> Vec<f64> {
    let mut noise = Noise::new(seed);
    (0..n_vertices).map(|_| (1.6 * noise.next() - 0.3).clamp(0.0, 1.0)).collect()
}

fn edits(n_vertices: usize) -> Vec<Layers> {
    let gains = [
        vec![0.0; LEVELS],
        vec![2.0, 1.7, 1.5, 1.2, 1.1],
        vec![1.0, 1.0, 0.0, 0.0, 1.0],
        vec![0.3, -1.0, 1.0, 2.5, 0.0],
    ];
    let everywhere = || vec![1.0; n_vertices];
    let region = |seed| weights(n_vertices, seed);
    vec![
        vec![],
        vec![(gains[0].clone(), everywhere())],
        vec![(gains[3].clone(), everywhere())],
        vec![(gains[1].clone(), region(1))],
        vec![(gains[0].clone(), region(2)), (gains[1].clone(), region(3))],
        vec![(gains[3].clone(), region(4)), (gains[2].clone(), everywhere()), (gains[1].clone(), region(5))],
    ]
}

fn dense_bands(case: &Case, f: &[f64], n_channels: usize) -> Bands {
    let phi = scaling_functions(&local_operator(case, Mutant::None).t, LEVELS);
    bands(&phi, &weld(&case.parts), f, n_channels)
}

#[test]
fn a_filter_is_the_sum_of_the_bands_times_their_gains() {
    for case in cases() {
        let n = case.parts.n_vertices();
        for n_channels in [1, 3] {
            let f = signal(n, n_channels, 60);
            let bands = dense_bands(&case, &f, n_channels);
            for layers in edits(n) {
                let found = Fast::new(&case).filter(&f, n_channels, LEVELS, &layers);
                let what = format!("{}, {} layers", case.name, layers.len());
                assert_close(&found, &filtered(&bands, n_channels, &layers), FILTER, &what);
                for x in (0..n).filter(|&x| layers.iter().all(|(_, r)| r[x] == 0.0)) {
                    let row = x * n_channels..(x + 1) * n_channels;
                    assert_eq!(found[row.clone()], f[row], "{what}: vertex {x} is outside all regions");
                }
            }
        }
    }
}

#[test]
fn a_filter_leaves_masked_vertices_as_they_are_and_edits_the_others_at_their_position() {
    let mut n_half = 0;
    for case in cases() {
        let (n, welded) = (case.parts.n_vertices(), weld(&case.parts));
        let flags: Vec<bool> = (0..n).map(|x| x % 6 == 1).collect();
        let is_masked: Vec<bool> = (0..welded.first.len())
            .map(|c| welded.class.iter().zip(&flags).all(|(&class, &flag)| class != c || flag))
            .collect();
        n_half += (0..n).filter(|&x| flags[x] && !is_masked[welded.class[x]]).count();
        let f = signal(n, 2, 61);
        let mut filled = f.clone();
        fill(&welded, &flags, &mut filled, 2);
        let phi = scaling_functions(&restricted(&local_operator(&case, Mutant::None), &is_masked).t, LEVELS);
        let bands = bands(&phi, &welded, &filled, 2);
        for layers in edits(n) {
            let expected = filtered(&bands, 2, &layers);
            // What a masked vertex has counts for nothing, and stays, be it a number or none.
            for value in [f64::NAN, 1e6] {
                let (mut given, mut expected) = (f.clone(), expected.clone());
                for x in (0..n).filter(|&x| flags[x]) {
                    given[2 * x..2 * x + 2].fill(value);
                    expected[2 * x..2 * x + 2].fill(f64::NAN);
                }
                let mut found = Fast::masked(&case, &flags).filter(&given, 2, LEVELS, &layers);
                for x in (0..n).filter(|&x| flags[x]) {
                    for found in &mut found[2 * x..2 * x + 2] {
                        assert!(found.to_bits() == value.to_bits(), "{}, vertex {x}: {found}", case.name);
                        *found = f64::NAN;
                    }
                }
                assert_close(&found, &expected, FILTER, case.name);
            }
        }
    }
    assert!(n_half > 0, "no position is masked by half");
}

#[test]
fn layers_that_add_and_gains_of_the_next_level_would_be_seen() {
    for case in cases() {
        let n = case.parts.n_vertices();
        let f = signal(n, 1, 62);
        let bands = dense_bands(&case, &f, 1);
        let layers = &edits(n)[5];
        let found = Fast::new(&case).filter(&f, 1, LEVELS, layers);
        let mut shifted = layers.clone();
        for (gains, _) in &mut shifted {
            gains.rotate_left(1);
        }
        assert!(difference(&found, &filtered(&bands, 1, &shifted)) > SEEN * FILTER, "{}", case.name);
        let mut sum = f.clone();
        for (i, value) in sum.iter_mut().enumerate() {
            for (gains, r) in layers {
                *value += (0..LEVELS).map(|j| r[i] * (gains[j] - 1.0) * bands.wavelet[j][i]).sum::<f64>();
            }
        }
        assert!(difference(&found, &sum) > SEEN * FILTER, "{}", case.name);
    }
}

#[test]
fn presets_treat_the_finest_third_rounded_up_as_fine() {
    assert_eq!(preset("suppress-paper", 4), [0.0; 4]);
    assert_eq!(preset("suppress", 4), [0.0, 0.0, 0.0, 2.0]);
    assert_eq!(preset("suppress", 1), [0.0]);
    assert_eq!(preset("band1", 4), [1.0, 1.0, 0.0, 0.0]);
    assert_eq!(preset("band2", 4), [0.0, 0.0, 2.0, 2.0]);
    assert_eq!(preset("band1", 6), [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    // From 2 toward 1.2, which the level after the last would have.
    assert_close(&preset("enhance", 4), &[2.0, 1.8, 1.6, 1.4], crate::reference::ROUNDING, "enhance");
}
