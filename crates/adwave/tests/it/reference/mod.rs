//! The fast code against dense, literal references: every formula of the paper written out once more, on small irregular
//! shapes. `dense.rs` has the formulas, `shapes.rs` the shapes, `fast.rs` is the only file that calls the code under test.
//!
//! Each group of tests ends in one that changes the formula a little and asserts that the difference would be seen.

mod bands;
mod borders;
mod dense;
mod fast;
mod features;
mod filter;
mod heat;
mod local_fit;
mod operator;
mod refinement;
mod saliency;
mod shapes;
mod surface;
mod ties;

/// Sums and products of some hundred numbers in double precision, relative to the largest.
const ROUNDING: f64 = 1e-12;

/// Factor by which a comparison must exceed its tolerance when a formula is changed.
const SEEN: f64 = 1e4;

/// The largest difference of two lists, relative to the largest magnitude in the second. NaN must meet NaN.
#[track_caller]
fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().filter(|v| !v.is_nan()).fold(0.0_f64, |m, v| m.max(v.abs()));
    let worst = found.iter().zip(expected).fold(0.0_f64, |m, (f, e)| {
        assert_eq!(f.is_nan(), e.is_nan(), "{f} for {e}");
        if e.is_nan() { m } else { m.max((f - e).abs()) }
    });
    if largest > 0.0 { worst / largest } else { worst }
}

/// Fails unless two lists agree.
#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let difference = difference(found, expected);
    assert!(difference <= tolerance, "{what}: off by {difference:.1e}, more than {tolerance:.1e}");
}

/// Fails unless two matrices agree.
#[track_caller]
fn assert_same_matrix(found: &dense::Matrix, expected: &dense::Matrix, tolerance: f64, what: &str) {
    assert_close(&found.concat(), &expected.concat(), tolerance, what);
}
