//! The recurrence of an operator without one of its own: one call of [`Operator::difference`] per step.

use super::interface::{Continuation, Operator, RowOutput, RowWeights, SignalBlock, Steps, Sum, Weighing};
use crate::pages::zeros;
use crate::{Cancelled, Progress, parallel};

/// Number of rows that a thread processes at a time.
const ROWS_AT_A_TIME: usize = 2048;

/// Steps after which norms are computed.
const STEPS_PER_PASS: usize = 4;

/// The vectors `T_k(Y)u` for increasing k.
pub(crate) struct DifferenceSteps<'a, O: ?Sized> {
    operator: &'a O,
    weights: RowWeights<'a>,
    /// Vectors `T_k u` and `T_{k−1} u`, n_rows × width.
    now: Vec<f64>,
    before: Vec<f64>,
    /// `(I − Φ₁)T_k u`.
    product: Vec<f64>,
    output: RowOutput<'a>,
    square: f64,
    moves: bool,
    k: usize,
    /// First channel of the block, and number of channels of the block and of each row of a sum.
    at: usize,
    width: usize,
    stride: usize,
}

impl<'a, O: Operator + ?Sized> DifferenceSteps<'a, O> {
    /// Starts at `T_0 u = u = (I − Φ₁)f`.
    pub(crate) fn new(
        operator: &'a O,
        block: SignalBlock<'a>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let SignalBlock { values, n_channels, channels, weights, output, .. } = block;
        let (n, at, width) = (operator.n_rows(), channels.start, channels.len());
        let (mut now, mut product): (Vec<f64>, Vec<f64>) = (zeros(n * width), zeros(n * width));
        parallel::try_visit_rows(&mut product, width, ROWS_AT_A_TIME, progress, |first, rows| {
            for (row, x) in rows.chunks_exact_mut(width).zip(first..) {
                row.copy_from_slice(&values[x * n_channels + at..][..width]);
            }
        })?;
        operator.difference(&product, width, &mut now, progress)?;
        let parts = parallel::try_map_rows(&mut now, width, ROWS_AT_A_TIME, progress, |first, u| {
            let square =
                |(x, u): (usize, &[f64])| weights.weight(x, n) * u.iter().map(|v| v * v).sum::<f64>();
            let square: f64 = (first..).zip(u.chunks_exact(width)).map(square).sum();
            (square, u.iter().any(|&v| v != 0.0))
        })?;
        let (square, moves) =
            parts.into_iter().fold((0.0, false), |(sum, moves), (s, m)| (sum + s, moves || m));
        let stride = if let RowOutput::AlongNormals(_) = output { 1 } else { n_channels };
        let before = zeros(n * width);
        Ok(Self { operator, weights, now, before, product, output, square, moves, k: 0, at, width, stride })
    }

    /// Takes a step: `T_1 = T_0 − 2(I − Φ₁)T_0`, later `T_{k+1} = 2T_k − 4(I − Φ₁)T_k − T_{k−1}`.
    fn step(&mut self, progress: Progress<'_>) -> Result<(), Cancelled> {
        self.operator.difference(&self.now, self.width, &mut self.product, progress)?;
        let (now, product, is_first) = (&self.now, &self.product, self.k == 0);
        parallel::try_visit_rows(&mut self.before, self.width, ROWS_AT_A_TIME, progress, |first, rows| {
            let start = first * self.width;
            for (next, (now, product)) in rows.iter_mut().zip(now[start..].iter().zip(&product[start..])) {
                *next = if is_first { now - 2.0 * product } else { 2.0 * now - 4.0 * product - *next };
            }
        })?;
        std::mem::swap(&mut self.now, &mut self.before);
        self.k += 1;
        Ok(())
    }

    /// Adds the term k to the sums that have one.
    fn add(&self, sums: &mut [Sum<'_>], progress: Progress<'_>) -> Result<(), Cancelled> {
        let (at, width, is_new) = (self.at, self.width, self.k == 0);
        for sum in sums {
            let Some(&a) = sum.coefficients.get(self.k) else { continue };
            parallel::try_visit_rows(sum.out, self.stride, ROWS_AT_A_TIME, progress, |first, rows| {
                let vectors = self.now[first * width..].chunks_exact(width);
                for ((row, vector), x) in rows.chunks_exact_mut(self.stride).zip(vectors).zip(first..) {
                    let set = |out: &mut f64, term: f64| *out = if is_new { term } else { *out + term };
                    match self.output {
                        RowOutput::Channels => {
                            for (out, v) in row[at..at + width].iter_mut().zip(vector) {
                                set(out, a * v);
                            }
                        }
                        RowOutput::AlongNormals(normals) => {
                            let along: f64 = vector.iter().zip(&normals[x]).map(|(v, n)| v * n).sum();
                            set(&mut row[0], a * along);
                        }
                    }
                }
            })?;
        }
        Ok(())
    }

    /// Squared norm of a sum.
    fn square_of(&self, out: &[f64], progress: Progress<'_>) -> Result<f64, Cancelled> {
        let n = self.operator.n_rows();
        let channels = match self.output {
            RowOutput::Channels => self.at..self.at + self.width,
            RowOutput::AlongNormals(_) => 0..1,
        };
        parallel::try_sum(n, progress, |x| {
            let row = &out[x * self.stride..][channels.clone()];
            self.weights.weight(x, n) * row.iter().map(|v| v * v).sum::<f64>()
        })
    }
}

impl<O: Operator + ?Sized> Steps for DifferenceSteps<'_, O> {
    fn steps_per_pass(&self) -> usize {
        STEPS_PER_PASS
    }

    fn k(&self) -> usize {
        self.k
    }

    fn square(&self) -> f64 {
        self.square
    }

    fn is_nonzero(&self) -> bool {
        self.moves
    }

    fn advance(
        &mut self,
        n_steps: usize,
        sums: &mut [Sum<'_>],
        _next: Continuation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let first_term = if self.k == 0 { 0 } else { self.k + 1 };
        if self.k == 0 {
            self.add(sums, progress)?;
        }
        for _ in 0..n_steps {
            self.step(progress)?;
            self.add(sums, progress)?;
        }
        for sum in sums.iter_mut().filter(|sum| first_term < sum.coefficients.len()) {
            sum.square =
                if sum.weighing == Weighing::Weighed { self.square_of(sum.out, progress)? } else { 0.0 };
        }
        Ok(())
    }
}
