//! Weights of morph targets over time: keys and the interpolation between them.

use adwave::Progress;

use super::super::accessor::Accessor;
use super::super::document::Document;
use super::super::json::Json;
use super::rounded_text;
use crate::{ReadError, ReadLimits, ValueType};

/// KeyInterpolation between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum KeyInterpolation {
    Linear,
    /// Value of the key before.
    Step,
    /// Hermite spline with a tangent before and a tangent after each key.
    CubicSpline,
}

/// Weights of the targets of one node over time.
#[derive(Clone, Debug)]
pub(super) struct WeightTrack {
    /// Times of the keys in seconds, increasing; never empty.
    times: Vec<f64>,
    /// Weights of the targets at each key; for a spline in-tangents, weights and out-tangents.
    values: Vec<f64>,
    n_targets: usize,
    interpolation: KeyInterpolation,
}

/// Memory of the numbers read so far, checked against the limits of the file.
pub(super) struct MemoryCounter<'a> {
    limits: &'a ReadLimits,
    n_bytes: u64,
}

impl<'a> MemoryCounter<'a> {
    pub(super) fn new(limits: &'a ReadLimits) -> Self {
        Self { limits, n_bytes: 0 }
    }

    pub(super) fn limits(&self) -> &'a ReadLimits {
        self.limits
    }

    /// Adds `n` numbers of `size` bytes.
    pub(super) fn add(&mut self, n: usize, size: u64) -> Result<(), ReadError> {
        self.n_bytes = self.n_bytes.saturating_add((n as u64).saturating_mul(size));
        self.limits.check_bytes(self.n_bytes)
    }
}

impl WeightTrack {
    /// Reads a sampler of the weights of `n_targets` targets; `place` names it in errors.
    pub(super) fn read(
        document: &Document,
        sampler: &Json,
        n_targets: usize,
        place: &str,
        memory: &mut MemoryCounter<'_>,
        progress: Progress<'_>,
    ) -> Result<Self, ReadError> {
        let wrong = |what: String| ReadError::Whole(format!("{place} {what}; export the animation again"));
        let interpolation = match sampler.get("interpolation") {
            None => KeyInterpolation::Linear,
            Some(name) => match name.text() {
                Some("LINEAR") => KeyInterpolation::Linear,
                Some("STEP") => KeyInterpolation::Step,
                Some("CUBICSPLINE") => KeyInterpolation::CubicSpline,
                _ => {
                    return Err(wrong(
                        "must interpolate by LINEAR, STEP or CUBICSPLINE, got another word".into(),
                    ));
                }
            },
        };
        let mut numbers = |key: &str| {
            let index = sampler.index_of(key).ok_or_else(|| wrong(format!("has no {key}")))?;
            let accessor = Accessor::read(document, index, memory.limits)?;
            memory.add(accessor.count.saturating_mul(accessor.n_channels), 16)?;
            let values = accessor.values(document, progress)?;
            let is_float = accessor.value_type == ValueType::F32 || accessor.is_normalized;
            Ok::<_, ReadError>((accessor.fractions(&values).to_f64(), is_float))
        };
        let (times, has_times) = numbers("input")?;
        let (values, has_weights) = numbers("output")?;
        if !has_times || !has_weights {
            return Err(wrong("must have 32-bit floats or normalized integers, got other integers".into()));
        }
        check_times(&times).map_err(&wrong)?;
        let per_key = if interpolation == KeyInterpolation::CubicSpline { 3 * n_targets } else { n_targets };
        let (n_keys, n) = (times.len(), values.len());
        if n_keys.checked_mul(per_key) != Some(n) {
            let factor = if interpolation == KeyInterpolation::CubicSpline { "3 times " } else { "" };
            return Err(wrong(format!(
                "must have {factor}one weight for each of {n_keys} keys and {n_targets} targets, got {n} weights"
            )));
        }
        if let Some(k) = values.iter().position(|w| !w.is_finite()) {
            return Err(wrong(format!("must have finite weights, got {} at place {k}", values[k])));
        }
        Ok(Self { times, values, n_targets, interpolation })
    }

    pub(super) fn n_keys(&self) -> usize {
        self.times.len()
    }

    /// Times of the first and the last key.
    pub(super) fn range(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Mean distance between keys; `None` for one key.
    pub(super) fn mean_distance(&self) -> Option<f64> {
        let [first, last] = self.range();
        (self.times.len() > 1).then(|| (last - first) / (self.times.len() - 1) as f64)
    }

    /// True if all keys are within a share of the mean distance from even times.
    pub(super) fn is_even(&self) -> bool {
        const SHARE: f64 = 1e-3;
        let Some(step) = self.mean_distance() else { return true };
        let even = |k: usize| self.times[0] + k as f64 * step;
        self.times.iter().enumerate().all(|(k, t)| (t - even(k)).abs() <= SHARE * step + rounding(*t))
    }

    /// Weights at a time, those of the first or last key outside the keys. A key up to `tolerance` seconds after the
    /// time counts as reached, because 32-bit floats round the times of keys.
    pub(super) fn weights_at(&self, time: f64, tolerance: f64, weights: &mut [f64]) {
        let n = self.n_targets;
        let spline = self.interpolation == KeyInterpolation::CubicSpline;
        let tolerance =
            if self.interpolation == KeyInterpolation::Step { tolerance + rounding(time) } else { 0.0 };
        let n_reached = self.times.partition_point(|&t| t <= time + tolerance);
        let value = |key: usize, part: usize, k: usize| {
            if spline { self.values[(3 * key + part) * n + k] } else { self.values[key * n + k] }
        };
        let before = n_reached.saturating_sub(1);
        let is_between = n_reached > 0 && n_reached < self.times.len();
        if !is_between || self.interpolation == KeyInterpolation::Step {
            for (k, weight) in weights.iter_mut().enumerate() {
                *weight = value(before, 1, k);
            }
            return;
        }
        let length = self.times[n_reached] - self.times[before];
        let u = (time - self.times[before]) / length;
        for (k, weight) in weights.iter_mut().enumerate() {
            let (a, b) = (value(before, 1, k), value(n_reached, 1, k));
            *weight = if spline {
                let (out, into) = (length * value(before, 2, k), length * value(n_reached, 0, k));
                hermite(u, [a, out, b, into])
            } else {
                a + u * (b - a)
            };
        }
    }
}

/// Rounding of a time as a 32-bit float.
fn rounding(time: f64) -> f64 {
    time.abs() * f64::from(f32::EPSILON)
}

/// Cubic polynomial on 0 ≤ u ≤ 1 with the values a, b and the derivatives α, β at its ends, given as \[a, α, b, β\].
fn hermite(u: f64, [a, alpha, b, beta]: [f64; 4]) -> f64 {
    let (square, cube) = (u * u, u * u * u);
    (2.0 * cube - 3.0 * square + 1.0) * a
        + (cube - 2.0 * square + u) * alpha
        + (3.0 * square - 2.0 * cube) * b
        + (cube - square) * beta
}

/// Checks that there are keys at finite and increasing times.
fn check_times(times: &[f64]) -> Result<(), String> {
    if times.is_empty() {
        return Err("must have keys, got none".into());
    }
    if let Some(k) = times.iter().position(|t| !t.is_finite()) {
        return Err(format!("must have finite times, got {} at key {k}", times[k]));
    }
    if let Some(k) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        let [a, b] = [times[k], times[k + 1]].map(rounded_text);
        return Err(format!("must have increasing times, got {a} s at key {k} and {b} s at key {}", k + 1));
    }
    Ok(())
}
