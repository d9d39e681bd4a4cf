//! Laws of bands along time.

use adwave::bands::Schedule;
use adwave::grid::Grid;
use adwave::time::{TimeAxis, TimeEnds, TimeError};
use adwave::{Decomposer, Progress};
use std::f64::consts::PI;

const NONE: fn() -> Progress<'static> = Progress::none;

/// Numbers in [−½, ½) that look random.
fn random(n: usize) -> Vec<f64> {
    let mut state = 7_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..n).map(|_| next()).collect()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A unit at frame `at` after smoothing by `sigma`.
fn response(axis: &TimeAxis, at: usize, sigma: f64) -> Vec<f64> {
    let mut unit = vec![0.0; axis.n_frames()];
    unit[at] = 1.0;
    axis.smooth(&mut unit, 1, sigma, NONE()).unwrap();
    unit
}

fn moments(times: &[f64], weights: &[f64]) -> [f64; 3] {
    let moment = |power: i32| times.iter().zip(weights).map(|(t, w)| w * t.powi(power)).sum::<f64>();
    let (sum, mean) = (moment(0), moment(1));
    [sum, mean, moment(2) - mean * mean]
}

#[test]
fn cosines_are_eigenvectors_and_constants_stay_to_the_last_bit() {
    let (n, step, sigma) = (61, 0.7, 3.1);
    for (ends, k) in [(TimeEnds::Reflect, 5.0), (TimeEnds::Periodic, 8.0)] {
        let axis = TimeAxis::new(n, step).unwrap().with_ends(ends).unwrap();
        let angle = if ends == TimeEnds::Periodic { 2.0 * PI * k / n as f64 } else { PI * k / n as f64 };
        let shift = if ends == TimeEnds::Periodic { 0.3 } else { 0.5 };
        let wave: Vec<f64> = (0..n).map(|t| (angle * (t as f64 + shift)).cos()).collect();
        let mut smooth = wave.clone();
        axis.smooth(&mut smooth, 1, sigma, NONE()).unwrap();
        let factor = (-0.25 * sigma * sigma / step / step * (2.0 - 2.0 * angle.cos())).exp();
        let expected: Vec<f64> = wave.iter().map(|x| factor * x).collect();
        assert!(apart(&smooth, &expected) < 1e-12);
    }
    let times: Vec<f64> = (0..n).map(|t| (t as f64).powf(1.3)).collect();
    for axis in [
        TimeAxis::new(n, step).unwrap(),
        TimeAxis::new(n, step).unwrap().with_ends(TimeEnds::Causal).unwrap(),
        TimeAxis::from_times(&times).unwrap(),
        TimeAxis::from_times(&times).unwrap().with_ends(TimeEnds::Causal).unwrap(),
    ] {
        let steady: Vec<f64> = random(20).into_iter().flat_map(|v| std::iter::repeat_n(v, n)).collect();
        let bands = axis.bands(&steady, 1, &[1.0, 5.0], NONE()).unwrap();
        assert!(bands[..2].iter().flatten().all(|w| *w == 0.0) && bands[2] == steady);
    }
}

#[test]
fn variance_is_half_of_the_square_of_the_width() {
    let times: Vec<f64> = (0..2000).map(|t| 0.2 * f64::from(t)).collect();
    for sigma in [0.3, 1.0, 7.0] {
        let axis = TimeAxis::new(2000, 0.2).unwrap();
        let [sum, mean, variance] = moments(&times, &response(&axis, 1000, sigma));
        assert!((sum - 1.0).abs() < 1e-12 && (mean - 200.0).abs() < 1e-9);
        assert!((variance / (0.5 * sigma * sigma) - 1.0).abs() < 1e-9, "{sigma}: {variance}");
        let causal = axis.with_ends(TimeEnds::Causal).unwrap();
        let [sum, mean, variance] = moments(&times, &response(&causal, 200, sigma));
        assert!((sum - 1.0).abs() < 1e-12);
        assert!((mean - 40.0 - causal.delay(&[sigma])).abs() < 1e-9);
        assert!((variance / (0.5 * sigma * sigma) - 1.0).abs() < 1e-9, "{sigma}: {variance}");
    }
}

#[test]
fn the_width_at_half_of_the_peak_is_the_one_asked_for() {
    let axis = TimeAxis::new(4001, 0.05).unwrap();
    let fwhm = 3.0;
    let peak = response(&axis, 2000, fwhm / (4.0 * 2.0_f64.ln()).sqrt());
    let half = 0.5 * peak[2000];
    let k = (2000..4000).find(|&k| peak[k + 1] < half).unwrap();
    let crossing = k as f64 - 2000.0 + (peak[k] - half) / (peak[k] - peak[k + 1]);
    assert!((2.0 * crossing * 0.05 / fwhm - 1.0).abs() < 0.01);
}

#[test]
fn bands_sum_to_the_signal_and_commute_with_those_of_space() {
    let (n_places, n_frames) = (30, 48);
    let signal = random(n_places * n_frames);
    let axis = TimeAxis::new(n_frames, 2.0).unwrap();
    let widths = [3.0, 6.0, 20.0];
    let grid = Grid::new(&[n_places], &[1.0]).unwrap();
    let space = Decomposer::from_domain(grid.clone(), grid.heat()).unwrap();
    let schedule = Schedule::lengths(&[1.0, 2.0], 1.0).unwrap();
    let in_space = |signal: &[f64]| -> Vec<Vec<f64>> {
        let bands = space.decompose(signal, n_frames, &schedule).unwrap();
        bands.wavelets().map(<[f64]>::to_vec).chain([bands.coarsest().to_vec()]).collect()
    };
    let space_first: Vec<Vec<f64>> =
        in_space(&signal).iter().flat_map(|band| axis.bands(band, 1, &widths, NONE()).unwrap()).collect();
    let by_time: Vec<Vec<Vec<f64>>> =
        axis.bands(&signal, 1, &widths, NONE()).unwrap().iter().map(|band| in_space(band)).collect();
    for (k, band) in space_first.iter().enumerate() {
        assert!(apart(band, &by_time[k % 4][k / 4]) < 1e-11);
    }
    let sum: Vec<f64> = (0..signal.len()).map(|i| space_first.iter().map(|band| band[i]).sum()).collect();
    assert!(apart(&sum, &signal) <= 2e-15);
}

#[test]
fn a_filter_is_the_sum_of_bands_times_gains() {
    let (n_frames, n_components) = (40, 3);
    let signal = random(7 * n_frames * n_components);
    let (widths, gains) = ([2.0, 5.0], [0.25, 3.0]);
    for ends in TimeEnds::ALL {
        let axis = TimeAxis::new(n_frames, 1.0).unwrap().with_ends(*ends).unwrap();
        let bands = axis.bands(&signal, n_components, &widths, NONE()).unwrap();
        let mut filtered = signal.clone();
        axis.filter(&mut filtered, n_components, &widths, &gains, NONE()).unwrap();
        let sum = |i: usize| gains[0] * bands[0][i] + gains[1] * bands[1][i] + bands[2][i];
        let expected: Vec<f64> = (0..signal.len()).map(sum).collect();
        assert!(apart(&filtered, &expected) < 1e-14, "{ends}");
        let mut smooth = signal.clone();
        axis.filter(&mut smooth, n_components, &widths, &[0.0, 0.0], NONE()).unwrap();
        assert!(apart(&smooth, &bands[2]) < 1e-15, "{ends}");
    }
}

#[test]
fn components_of_a_frame_are_filtered_as_if_alone() {
    let (n_frames, n_components, n_places) = (25, 3, 11);
    let together = random(n_places * n_frames * n_components);
    let axis = TimeAxis::new(n_frames, 1.0).unwrap();
    let mut smooth = together.clone();
    axis.smooth(&mut smooth, n_components, 4.0, NONE()).unwrap();
    for c in 0..n_components {
        let mut alone: Vec<f64> = together.iter().skip(c).step_by(n_components).copied().collect();
        axis.smooth(&mut alone, 1, 4.0, NONE()).unwrap();
        let found: Vec<f64> = smooth.iter().skip(c).step_by(n_components).copied().collect();
        assert_eq!(found, alone);
    }
}

#[test]
fn causal_values_do_not_depend_on_later_frames() {
    let n = 300;
    let signal = random(n);
    let times: Vec<f64> = (0..n).map(|t| t as f64 + 0.3 * (t as f64).sin()).collect();
    for axis in [TimeAxis::new(n, 1.0).unwrap(), TimeAxis::from_times(&times).unwrap()] {
        let axis = axis.with_ends(TimeEnds::Causal).unwrap();
        let before = axis.bands(&signal, 1, &[2.0, 9.0], NONE()).unwrap();
        let mut other = signal.clone();
        other[200..].fill(1e6);
        let after = axis.bands(&other, 1, &[2.0, 9.0], NONE()).unwrap();
        assert!((0..3).all(|band| before[band][..200] == after[band][..200]));
        assert!(before[0][200..] != after[0][200..]);
    }
}

#[test]
fn uneven_times_keep_the_integral_and_follow_the_gaps() {
    let times: Vec<f64> = (0..120).map(|t| f64::from(t) + 0.4 * (1.7 * f64::from(t)).sin()).collect();
    let axis = TimeAxis::from_times(&times).unwrap();
    assert!((axis.step() - (times[119] - times[0]) / 119.0).abs() < 1e-12);
    let own = |k: usize| {
        let gap = |k: usize| times[k + 1] - times[k];
        0.5 * (gap(k.saturating_sub(1)) + gap(k.min(118)))
    };
    let signal = random(120);
    let mut smooth = signal.clone();
    axis.smooth(&mut smooth, 1, 6.0, NONE()).unwrap();
    let integral = |f: &[f64]| (0..120).map(|k| own(k) * f[k]).sum::<f64>();
    assert!((integral(&signal) - integral(&smooth)).abs() < 1e-12);
    // A step of the same slope in time, whatever the gaps: a line stays a line far from the ends.
    let mut line = times.clone();
    axis.smooth(&mut line, 1, 6.0, NONE()).unwrap();
    assert!(apart(&line[40..80], &times[40..80]) < 0.05);
    // Even times are the even axis.
    let even: Vec<f64> = (0..120).map(|t| 3.0 + 0.1 * f64::from(t)).collect();
    assert_eq!(TimeAxis::from_times(&even).unwrap().n_frames(), 120);
    let (mut a, mut b) = (signal.clone(), signal.clone());
    TimeAxis::from_times(&even).unwrap().smooth(&mut a, 1, 0.7, NONE()).unwrap();
    TimeAxis::new(120, 0.1).unwrap().smooth(&mut b, 1, 0.7, NONE()).unwrap();
    assert!(apart(&a, &b) < 1e-12);
}

#[test]
fn places_with_unknown_values_keep_theirs_and_change_no_other() {
    let n_frames = 30;
    let mut signal = random(12 * n_frames);
    let axis = TimeAxis::new(n_frames, 1.0).unwrap();
    let mut known = signal.clone();
    axis.smooth(&mut known, 1, 3.0, NONE()).unwrap();
    signal[5 * n_frames + 7] = f64::NAN;
    let mut smooth = signal.clone();
    axis.smooth(&mut smooth, 1, 3.0, NONE()).unwrap();
    for place in 0..12 {
        let row = place * n_frames..(place + 1) * n_frames;
        let expected = if place == 5 { &signal } else { &known };
        let same = smooth[row.clone()].iter().zip(&expected[row]).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same, "{place}");
    }
    let bands = axis.bands(&signal, 1, &[3.0], NONE()).unwrap();
    assert!(bands.iter().all(|band| (0..band.len()).all(|i| band[i].is_nan() == (i / n_frames == 5))));
}

#[test]
fn what_does_not_fit_is_refused() {
    assert_eq!(TimeAxis::new(1, 1.0), Err(TimeError::FewFrames { n_frames: 1 }));
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(TimeAxis::new(5, step), Err(TimeError::Step { .. })));
    }
    let times = TimeAxis::from_times(&[0.0, 1.0, 1.0]);
    assert_eq!(times, Err(TimeError::Times { frame: 2, time: 1.0, before: 1.0 }));
    let uneven = TimeAxis::from_times(&[0.0, 1.0, 3.0]).unwrap();
    assert_eq!(uneven.with_ends(TimeEnds::Periodic), Err(TimeError::UnevenCycle));
    let axis = TimeAxis::new(5, 1.0).unwrap();
    let mut values = vec![0.0; 10];
    for widths in [&[][..], &[1.0, 1.0], &[0.0], &[f64::NAN], &[2.0, 1.0]] {
        assert!(matches!(axis.bands(&values, 1, widths, NONE()), Err(TimeError::Widths { .. })));
    }
    assert!(matches!(axis.filter(&mut values, 1, &[1.0], &[], NONE()), Err(TimeError::Gains { .. })));
    assert!(matches!(axis.smooth(&mut values[..9], 1, 1.0, NONE()), Err(TimeError::Values { found: 9, .. })));
}

#[test]
fn extreme_widths_give_the_mean_or_the_signal() {
    let signal = random(50);
    let mean = signal.iter().sum::<f64>() / 50.0;
    for ends in [TimeEnds::Reflect, TimeEnds::Periodic] {
        let axis = TimeAxis::new(50, 1.0).unwrap().with_ends(ends).unwrap();
        let (mut wide, mut narrow) = (signal.clone(), signal.clone());
        axis.smooth(&mut wide, 1, 1e50, NONE()).unwrap();
        axis.smooth(&mut narrow, 1, 1e-50, NONE()).unwrap();
        assert!(wide.iter().all(|v| (v - mean).abs() < 1e-14) && apart(&narrow, &signal) < 1e-15);
    }
}
