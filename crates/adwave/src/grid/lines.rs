//! Heat along the lines of one axis, any time at once.
//!
//! `exp(−sD)` with the second differences D of a line is replaced by a rational function r with r(0) = 1, whose poles and
//! residues minimize the greatest error on (−∞, 0] (Carathéodory–Fejér approximation, `trefethen2006`):
//! `r(−sD)x = x + Σ 2·Re((c/z)·u)` with `(sD + z)u = sDx` for each pair of conjugate poles z with the residue c. Each u is
//! a complex tridiagonal solve, so the cost does not depend on s. Written in differences, constants are kept to the last
//! bit and sums to rounding.

// The digits of poles and residues have no groups.
#![allow(clippy::unreadable_literal)]
// Functions that are compiled for the vectors of the machine must be inlined into the place that chooses these.
#![allow(clippy::inline_always)]

use crate::{Cancelled, Progress, parallel};

/// Lines that are solved together.
const TOGETHER: usize = 8;

/// Tiles of lines, or rows of the output, that a thread takes at a time.
const AT_A_TIME: usize = 16;

/// Fewest blocks of lines, one after another in memory, that are solved in place: enough for all threads.
const FEWEST_BLOCKS: usize = 64;

/// Values that a thread copies at a time.
const VALUES_AT_A_TIME: usize = 1 << 14;

/// Rounding of the solves, relative to the input and to the time s. Measured up to 1/16 of it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Time after which a line of n places is its mean, in n²: the slowest wave decays by exp(−4s/n²) or faster, here to
/// 4·10⁻¹⁸.
const LEVELED: f64 = 10.0;

/// Complex number (real, imaginary).
type Complex = (f64, f64);

/// A rational approximation of the exponential on (−∞, 0].
pub(crate) struct Approximation {
    /// Poles with a positive imaginary part, and their residues.
    pairs: &'static [(Complex, Complex)],
    /// Greatest error, with that of rounding.
    pub(crate) error: f64,
}

/// Approximations with 4 and 7 pairs of poles. The errors of the functions are 2.345e-8 and 1.43e-13 (measured at 400,000
/// points); the second is stated with the rounding of its solves.
pub(crate) static APPROXIMATIONS: [Approximation; 2] = [
    Approximation {
        pairs: &[
            ((3.2209452450543408, 1.1936196054193322), (-1.8317717106328966, -9.525608129943738)),
            ((2.2922491478210563, 3.6007714960771353), (2.436240732924865, 3.7167556408605296)),
            ((0.2694909873674965, 6.082032592700096), (-0.6325880537326855, -0.443923102700152)),
            ((-3.4085395014618016, 8.773034564408094), (0.028129757161818793, 0.011577384568874135)),
        ],
        error: 2.4e-8,
    },
    Approximation {
        pairs: &[
            ((5.62317153475742, 1.1940664287021552), (-27.876162291177156, -102.15000629291019)),
            ((5.089374564875054, 3.588816095602845), (46.93490458700584, 45.644543838980354)),
            ((3.993400429650635, 6.004818060139016), (-23.49897941909133, -5.808219208333141)),
            ((2.2698165258521406, 8.461717806877203), (4.807233308906512, -1.3211122031487392)),
            ((-0.20872377764902525, 10.991232026333313), (-0.37636336734574083, 0.33520468313104734)),
            ((-3.703239160176677, 13.656333463712498), (0.009438720567093254, -0.017185736312372236)),
            ((-8.897735413180298, 16.63093520842446), (-7.153878179758697e-05, 0.00014361901788104045)),
        ],
        error: 5e-13,
    },
];

/// The lines of values along one axis.
pub(crate) struct Lines<'a> {
    /// Places of a line.
    n: usize,
    /// Distance between the values of adjacent places, which is also the number of lines side by side.
    inner: usize,
    kind: LineKind<'a>,
}

/// Connection of the places of a line.
#[derive(Clone, Copy)]
pub(crate) enum LineKind<'a> {
    /// Places at equal distances; the ends reflect.
    Even,
    /// Places at equal distances; the last is beside the first.
    Ring,
    /// The weights of the places before and after each, `1/(m·d)` with the measure m of the place and the distance d; 0
    /// beyond the ends. Norms are weighted by the measure.
    Uneven(&'a [[f64; 2]]),
}

impl<'a> Lines<'a> {
    /// The lines of `n` places whose values are `inner` apart.
    pub(crate) fn new(n: usize, inner: usize, kind: LineKind<'a>) -> Self {
        Self { n, inner, kind }
    }

    /// Time of diffusion: on a ring of two places both sides of a place are the other one.
    fn time(&self, time: f64) -> f64 {
        if matches!(self.kind, LineKind::Ring) && self.n == 2 { 2.0 * time } else { time }
    }

    /// Largest weight of a side.
    fn largest_weight(&self) -> f64 {
        match self.kind {
            LineKind::Uneven(sides) => {
                sides.iter().flatten().fold(0.0, |most: f64, weight| most.max(*weight))
            }
            LineKind::Even | LineKind::Ring => 1.0,
        }
    }

    /// True if lines are their means after the time s.
    fn is_leveled(&self, time: f64) -> bool {
        !matches!(self.kind, LineKind::Uneven(_)) && time >= LEVELED * (self.n as f64).powi(2)
    }

    /// Bound of the error of [`diffuse`](Self::diffuse), relative to the norm of its input.
    pub(crate) fn error(&self, time: f64, approximation: &Approximation) -> f64 {
        let time = self.time(time);
        if self.is_leveled(time) {
            ROUNDING * self.n as f64
        } else {
            approximation.error + ROUNDING * time * self.largest_weight()
        }
    }

    /// Diffuses all lines of `values` for the time s: in squared spacings, or in units of the inverse weights.
    pub(crate) fn diffuse(
        &self,
        values: &mut [f64],
        time: f64,
        approximation: &Approximation,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        let Self { n, inner, kind } = *self;
        let n_lines = values.len() / n;
        let time = self.time(time);
        let is_leveled = self.is_leveled(time);
        let weights: Vec<[f64; 2]> = match kind {
            LineKind::Uneven(sides) => sides.iter().map(|side| side.map(|weight| time * weight)).collect(),
            LineKind::Even | LineKind::Ring => vec![[time; 2]; n],
        };
        let ends = match kind {
            LineKind::Ring if n > 2 => Ends::Joined,
            LineKind::Even | LineKind::Ring => Ends::Reflecting,
            LineKind::Uneven(_) => Ends::Weighted,
        };
        let pairs = if is_leveled { &[] } else { approximation.pairs };
        let solvers: Vec<Solver> = pairs.iter().map(|&(z, c)| Solver::new(&weights, z, c, ends)).collect();
        let solve = TileSolve { solvers: &solvers, weights: &weights, ends, is_leveled };
        let block = n * inner;
        if values.len() / block >= FEWEST_BLOCKS {
            // Lines that lie together are solved in place.
            let n_blocks = (AT_A_TIME * TOGETHER).div_ceil(inner);
            return parallel::try_visit_rows(values, block, n_blocks, progress, |_, rows| {
                let (mut work, mut tile) = (Work::new(n), vec![0.0; n * TOGETHER]);
                for line in (0..rows.len() / n).step_by(TOGETHER) {
                    self.read_tile(rows, line, &mut tile);
                    solve.run(&mut work, &mut tile);
                    self.write_tile(&tile, line, rows);
                }
            });
        }
        let tile_len = n * TOGETHER;
        let mut tiles = crate::pages::zeros(n_lines.div_ceil(TOGETHER) * tile_len);
        let given: &[f64] = values;
        parallel::try_visit_rows(&mut tiles, tile_len, AT_A_TIME, progress, |first, rows| {
            let mut work = Work::new(n);
            for (k, tile) in rows.chunks_exact_mut(tile_len).enumerate() {
                self.read_tile(given, (first + k) * TOGETHER, tile);
                solve.run(&mut work, tile);
            }
        })?;
        parallel::try_visit_rows(values, 1, VALUES_AT_A_TIME, progress, |first, rows| {
            let mut done = 0;
            while done < rows.len() {
                // Up to the end of the lines side by side at one place.
                let (outer, rest) = ((first + done) / block, (first + done) % block);
                let (at, line) = (rest / inner, outer * inner + rest % inner);
                let (lane, from) = (line % TOGETHER, line / TOGETHER * tile_len + at * TOGETHER);
                let n_here = (rows.len() - done).min(TOGETHER - lane).min(inner - rest % inner);
                rows[done..done + n_here].copy_from_slice(&tiles[from + lane..][..n_here]);
                done += n_here;
            }
        })
    }
}

impl Lines<'_> {
    /// Copies the lines from `line` on into a tile, n × [`TOGETHER`].
    fn read_tile(&self, values: &[f64], line: usize, tile: &mut [f64]) {
        let Self { n, inner, .. } = *self;
        let start = |line: usize| line / inner * inner * n + line % inner;
        if line % inner + TOGETHER <= inner {
            let first = start(line);
            for (at, row) in tile.as_chunks_mut::<TOGETHER>().0.iter_mut().enumerate() {
                row.copy_from_slice(&values[first + at * inner..][..TOGETHER]);
            }
        } else {
            for lane in 0..TOGETHER.min(values.len() / n - line) {
                let start = start(line + lane);
                for at in 0..n {
                    tile[at * TOGETHER + lane] = values[start + at * inner];
                }
            }
        }
    }
}

impl Lines<'_> {
    /// Copies a tile, n × [`TOGETHER`], to the lines from `line` on.
    fn write_tile(&self, tile: &[f64], line: usize, values: &mut [f64]) {
        let Self { n, inner, .. } = *self;
        let start = |line: usize| line / inner * inner * n + line % inner;
        if line % inner + TOGETHER <= inner {
            let first = start(line);
            for (at, row) in tile.as_chunks::<TOGETHER>().0.iter().enumerate() {
                values[first + at * inner..][..TOGETHER].copy_from_slice(row);
            }
        } else {
            for lane in 0..TOGETHER.min(values.len() / n - line) {
                let start = start(line + lane);
                for at in 0..n {
                    values[start + at * inner] = tile[at * TOGETHER + lane];
                }
            }
        }
    }
}

/// The solves of one tile of lines.
struct TileSolve<'a> {
    solvers: &'a [Solver],
    weights: &'a [[f64; 2]],
    ends: Ends,
    is_leveled: bool,
}

impl TileSolve<'_> {
    fn run(&self, work: &mut Work, tile: &mut [f64]) {
        let &Self { solvers, weights, ends, is_leveled } = self;
        if is_leveled {
            level(tile);
        } else {
            pulp::Arch::new().dispatch(DiffuseTile { work, tile, solvers, weights, ends });
        }
    }
}

/// Replaces the lines of a tile, n × [`TOGETHER`], by their means; constants stay to the last bit.
fn level(tile: &mut [f64]) {
    let values = tile.as_chunks_mut::<TOGETHER>().0;
    let (first, n) = (values[0], values.len() as f64);
    let mut mean = [0.0; TOGETHER];
    for values in values.iter() {
        for ((mean, value), first) in mean.iter_mut().zip(values).zip(&first) {
            *mean += (value - first) / n;
        }
    }
    values.fill(std::array::from_fn(|lane| first[lane] + mean[lane]));
}

fn multiply(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn inverse(a: Complex) -> Complex {
    let square = a.0 * a.0 + a.1 * a.1;
    (a.0 / square, -a.1 / square)
}

/// Neighbor of the first and of the last place of a line, beyond the ends.
#[derive(Clone, Copy, PartialEq)]
enum Ends {
    /// The place itself.
    Reflecting,
    /// The place at the other end.
    Joined,
    /// None, by the weights.
    Weighted,
}

/// Factors of `sD + z` on a line or a ring, and the weight of its solution.
struct Solver {
    /// Inverse pivots.
    pivots: Vec<Complex>,
    /// Solution for the corners of a ring, scaled; empty on a line.
    corner: Vec<Complex>,
    /// First entry of the row that a ring adds: −s/γ.
    corner_row: Complex,
    /// Twice the residue divided by the pole.
    weight: Complex,
}

impl Solver {
    /// Factors for sides of these weights, the time included.
    fn new(weights: &[[f64; 2]], pole: Complex, residue: Complex, ends: Ends) -> Self {
        let (n, [time, _]) = (weights.len(), weights[0]);
        let mut diagonal: Vec<Complex> =
            weights.iter().map(|[before, after]| (pole.0 + (before + after), pole.1)).collect();
        // A ring is a line with corners: sD + z = T + a·bᵀ with a = (γ, 0, …, 0, −s), b = (1, 0, …, 0, −s/γ), γ = −d₀.
        let middle = diagonal[0];
        let gamma = (-middle.0, -middle.1);
        let over = inverse(gamma);
        match ends {
            Ends::Reflecting => {
                diagonal[0] = (pole.0 + time, pole.1);
                diagonal[n - 1] = diagonal[0];
            }
            Ends::Joined => {
                diagonal[0] = (middle.0 - gamma.0, middle.1 - gamma.1);
                diagonal[n - 1] = (middle.0 - time * time * over.0, middle.1 - time * time * over.1);
            }
            Ends::Weighted => {}
        }
        let mut pivots: Vec<Complex> = Vec::with_capacity(n);
        for (k, d) in diagonal.iter().enumerate() {
            let (less, product) =
                if k == 0 { ((0.0, 0.0), 0.0) } else { (pivots[k - 1], weights[k - 1][1] * weights[k][0]) };
            pivots.push(inverse((d.0 - product * less.0, d.1 - product * less.1)));
        }
        let double = multiply(residue, inverse(pole));
        let mut solver = Self {
            pivots,
            corner: Vec::new(),
            corner_row: (-time * over.0, -time * over.1),
            weight: (2.0 * double.0, 2.0 * double.1),
        };
        if ends == Ends::Joined {
            let mut q = vec![(0.0, 0.0); n];
            q[0] = gamma;
            q[n - 1] = (-time, 0.0);
            solver.solve_one(&mut q, time);
            let product = multiply(solver.corner_row, q[n - 1]);
            let scale = inverse((1.0 + q[0].0 + product.0, q[0].1 + product.1));
            solver.corner = q.into_iter().map(|q| multiply(q, scale)).collect();
        }
        solver
    }

    /// Solves one line without its corners in place.
    fn solve_one(&self, x: &mut [Complex], time: f64) {
        for k in 0..x.len() {
            let before = if k == 0 { (0.0, 0.0) } else { x[k - 1] };
            x[k] = multiply((x[k].0 + time * before.0, x[k].1 + time * before.1), self.pivots[k]);
        }
        for k in (0..x.len() - 1).rev() {
            let more = multiply(self.pivots[k], x[k + 1]);
            x[k] = (x[k].0 + time * more.0, x[k].1 + time * more.1);
        }
    }
}

/// [`Work::diffuse`] with the vectors of this machine.
struct DiffuseTile<'a> {
    work: &'a mut Work,
    tile: &'a mut [f64],
    solvers: &'a [Solver],
    weights: &'a [[f64; 2]],
    ends: Ends,
}

impl pulp::NullaryFnOnce for DiffuseTile<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.work.diffuse(self.tile, self.solvers, self.weights, self.ends);
    }
}

/// Values of lines that are solved together, at one place.
type Together = [f64; TOGETHER];

/// Buffers of a tile of lines.
struct Work {
    /// Right-hand sides sDx.
    right: Vec<Together>,
    real: Vec<Together>,
    imaginary: Vec<Together>,
}

impl Work {
    fn new(n: usize) -> Self {
        let zeros = || vec![[0.0; TOGETHER]; n];
        Self { right: zeros(), real: zeros(), imaginary: zeros() }
    }

    /// Replaces the lines of a tile, n × [`TOGETHER`], by r(−sD) of them.
    #[inline(always)]
    fn diffuse(&mut self, tile: &mut [f64], solvers: &[Solver], weights: &[[f64; 2]], ends: Ends) {
        let values = tile.as_chunks_mut::<TOGETHER>().0;
        let n = values.len();
        for k in 0..n {
            let here = &values[k];
            let before = if k > 0 {
                &values[k - 1]
            } else if ends == Ends::Joined {
                &values[n - 1]
            } else {
                here
            };
            let after = if k + 1 < n {
                &values[k + 1]
            } else if ends == Ends::Joined {
                &values[0]
            } else {
                here
            };
            let [left, right] = weights[k];
            self.right[k] = if ends == Ends::Weighted {
                std::array::from_fn(|l| left * (here[l] - before[l]) + right * (here[l] - after[l]))
            } else {
                std::array::from_fn(|l| left * ((here[l] - before[l]) + (here[l] - after[l])))
            };
        }
        for solver in solvers {
            self.solve(solver, weights);
            let (real, imaginary) = solver.weight;
            for (values, (re, im)) in values.iter_mut().zip(self.real.iter().zip(&self.imaginary)) {
                for (value, (re, im)) in values.iter_mut().zip(re.iter().zip(im)) {
                    *value += real * re - imaginary * im;
                }
            }
        }
    }

    /// Solves `(sD + z)u = right` into the real and imaginary parts.
    #[inline(always)]
    fn solve(&mut self, solver: &Solver, weights: &[[f64; 2]]) {
        let n = self.right.len();
        let (mut re, mut im) = ([0.0; TOGETHER], [0.0; TOGETHER]);
        for (k, [before, _]) in weights.iter().enumerate() {
            let (a, b) = solver.pivots[k];
            for l in 0..TOGETHER {
                let (x, y) = (self.right[k][l] + before * re[l], before * im[l]);
                re[l] = a * x - b * y;
                im[l] = a * y + b * x;
            }
            self.real[k] = re;
            self.imaginary[k] = im;
        }
        for k in (0..n - 1).rev() {
            let [_, after] = weights[k];
            let (a, b) = (after * solver.pivots[k].0, after * solver.pivots[k].1);
            for l in 0..TOGETHER {
                let (x, y) = (re[l], im[l]);
                re[l] = self.real[k][l] + (a * x - b * y);
                im[l] = self.imaginary[k][l] + (a * y + b * x);
            }
            self.real[k] = re;
            self.imaginary[k] = im;
        }
        if !solver.corner.is_empty() {
            let (a, b) = solver.corner_row;
            let last = (self.real[n - 1], self.imaginary[n - 1]);
            let factor: [Complex; TOGETHER] = std::array::from_fn(|l| {
                (
                    self.real[0][l] + a * last.0[l] - b * last.1[l],
                    self.imaginary[0][l] + a * last.1[l] + b * last.0[l],
                )
            });
            for (k, corner) in solver.corner.iter().enumerate() {
                for (l, factor) in factor.iter().enumerate() {
                    let less = multiply(*factor, *corner);
                    self.real[k][l] -= less.0;
                    self.imaginary[k][l] -= less.1;
                }
            }
        }
    }
}
