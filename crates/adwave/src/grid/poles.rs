//! Heat on lines by a rational approximation of the exponential, for any time.
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

use super::lines::TOGETHER;
use pulp::Simd;

/// Rounding of the solves, relative to the input and to the time s. Lines of 2 to 1500 places err by at most two thirds of the
/// bound with it.
pub(super) const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Complex number (real, imaginary).
type Complex = (f64, f64);

/// A rational approximation of the exponential on (−∞, 0].
pub(super) struct Approximation {
    /// Poles with a positive imaginary part, and their residues.
    pairs: &'static [(Complex, Complex)],
    /// Greatest error, with that of rounding at short times.
    error: f64,
    /// Rounding of the solves, relative to the input and to the time s.
    rounding: f64,
}

/// Approximations with 4, 7 and 8 pairs of poles. The greatest errors of the functions are 2.345e-8, 1.43e-13 and, with poles
/// and residues in 64 bits, 5.4e-15 (measured at 400,000 and 7,800 points); the last two are stated with the rounding of
/// their solves. The 8 pairs are those of `pusa2012`; their solves cancel more.
static APPROXIMATIONS: [Approximation; 3] = [
    Approximation {
        pairs: &[
            ((3.2209452450543408, 1.1936196054193322), (-1.8317717106328966, -9.525608129943738)),
            ((2.2922491478210563, 3.6007714960771353), (2.436240732924865, 3.7167556408605296)),
            ((0.2694909873674965, 6.082032592700096), (-0.6325880537326855, -0.443923102700152)),
            ((-3.4085395014618016, 8.773034564408094), (0.028129757161818793, 0.011577384568874135)),
        ],
        error: 2.4e-8,
        rounding: ROUNDING,
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
        rounding: ROUNDING,
    },
    Approximation {
        pairs: &[
            ((6.416177699099435, 1.1941223933701386), (-64.50087802553965, -224.59440762652096)),
            ((5.948152268951177, 3.587457362018322), (113.3977517848393, 101.94721704215857)),
            ((4.993174737717997, 5.996881713603942), (-62.51839246320792, -11.190391094283228)),
            ((3.509103608414918, 8.436198985884374), (15.059585270023467, -5.751405277642182)),
            ((1.419375897185666, 10.925363484496723), (-1.4793007113557999, 1.7686588323782937)),
            ((-1.4139284624888862, 13.497725698892745), (0.04102313683541002, -0.15743466173455467)),
            ((-5.264971343442647, 16.22022147316793), (0.0002115174218246603, 0.004389296964738067)),
            ((-10.843917078696988, 19.27744616718165), (-5.090152186522492e-07, -2.422001765285229e-05)),
        ],
        error: 2e-14,
        rounding: 4.0 * ROUNDING,
    },
];

impl Approximation {
    /// The one with the fewest poles whose error after a time is at most `error`, or else the most exact one. Times are in
    /// units of the inverse of the largest weight of a side.
    pub(super) fn choose(time: f64, error: f64) -> &'static Self {
        let [few, many @ ..] = &APPROXIMATIONS;
        if few.error_after(time) <= error {
            return few;
        }
        // The others cost nearly the same.
        many.iter().min_by(|a, b| a.error_after(time).total_cmp(&b.error_after(time))).unwrap_or(few)
    }

    /// Bound of the error after a time, relative to the norm of the input.
    pub(super) fn error_after(&self, time: f64) -> f64 {
        self.error + self.rounding * time
    }

    /// Number of pairs of poles.
    pub(super) fn n_pairs(&self) -> usize {
        self.pairs.len()
    }
}

/// The solves of tiles of lines for a time.
pub(crate) struct Poles {
    solvers: Vec<Solver>,
    /// Weights of the sides of each place, the time included.
    weights: Vec<[f64; 2]>,
    ends: Ends,
}

impl Poles {
    pub(super) fn new(approximation: &Approximation, weights: Vec<[f64; 2]>, ends: Ends) -> Self {
        let solvers = approximation.pairs.iter().map(|&(z, c)| Solver::new(&weights, z, c, ends)).collect();
        Self { solvers, weights, ends }
    }

    /// Replaces the lines of a tile, n × [`TOGETHER`], by r(−sD) of them.
    pub(super) fn run(&self, work: &mut Work, tile: &mut [f64]) {
        let Self { solvers, weights, ends } = self;
        work.fit(weights.len());
        pulp::Arch::new().dispatch(DiffuseTile { work, tile, solvers, weights, ends: *ends });
    }
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
pub(super) enum Ends {
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
    /// Inverse pivots times the weight of the place before, and of the place after.
    forward: Vec<Complex>,
    back: Vec<Complex>,
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
        let times = |side: usize| {
            pivots.iter().zip(weights).map(|(p, sides)| (sides[side] * p.0, sides[side] * p.1)).collect()
        };
        let (forward, back) = (times(0), times(1));
        let mut solver = Self {
            pivots,
            forward,
            back,
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

/// Replaces the lines of a tile by r(−sD) of them, with the vectors of this machine.
struct DiffuseTile<'a> {
    work: &'a mut Work,
    tile: &'a mut [f64],
    solvers: &'a [Solver],
    weights: &'a [[f64; 2]],
    ends: Ends,
}

impl pulp::WithSimd for DiffuseTile<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { work, tile, solvers, weights, ends } = self;
        let (values, work) = (S::as_mut_simd_f64s(tile).0, work.vectors::<S>());
        for side in 0..TOGETHER / S::F64_LANES {
            let mut lines = LinesOfVector { simd, weights, values: &mut *values, side };
            lines.differences(ends, &mut *work.right);
            // The solves of a group take turns, so that none waits for the place before.
            for group in solvers.chunks(GROUP) {
                match group {
                    [a, b, c, d] => lines.add_solutions([a, b, c, d], work.right, work.parts),
                    [a, b, c] => lines.add_solutions([a, b, c], work.right, work.parts),
                    [a, b] => lines.add_solutions([a, b], work.right, work.parts),
                    _ => group.iter().for_each(|a| lines.add_solutions([a], work.right, work.parts)),
                }
            }
        }
    }
}

/// Pairs of poles that are solved together: as many as the vectors of the machine hold.
const GROUP: usize = 4;

/// Buffers of a tile of lines, for [`TOGETHER`] of them or as many as a vector holds.
#[derive(Default)]
pub(super) struct Work {
    /// Right-hand sides sDx.
    right: Vec<f64>,
    /// Real and imaginary parts of the solutions of a group of pairs.
    parts: Vec<f64>,
}

/// Buffers of as many lines as a vector of the machine holds.
struct WorkOfSimd<'a, S: Simd> {
    right: &'a mut [S::f64s],
    parts: &'a mut [S::f64s],
}

impl Work {
    /// Makes room for lines of n places.
    fn fit(&mut self, n: usize) {
        self.right.resize(n * TOGETHER, 0.0);
        self.parts.resize(2 * GROUP * n * TOGETHER, 0.0);
    }

    #[inline(always)]
    fn vectors<S: Simd>(&mut self) -> WorkOfSimd<'_, S> {
        let Self { right, parts } = self;
        WorkOfSimd { right: S::as_mut_simd_f64s(right).0, parts: S::as_mut_simd_f64s(parts).0 }
    }
}

/// As many lines as a vector of the machine holds, from lane `side` vectors on of a tile.
struct LinesOfVector<'a, S: Simd> {
    simd: S,
    weights: &'a [[f64; 2]],
    /// Values of the tile, n × vectors of [`TOGETHER`] lines.
    values: &'a mut [S::f64s],
    side: usize,
}

impl<S: Simd> LinesOfVector<'_, S> {
    /// Vectors of a place of the tile.
    const VECTORS: usize = TOGETHER / S::F64_LANES;

    /// Computes sDx at all places.
    #[inline(always)]
    fn differences(&self, ends: Ends, out: &mut [S::f64s]) {
        let &Self { simd, weights, side, .. } = self;
        let n = weights.len();
        let value = |k: usize| self.values[k * Self::VECTORS + side];
        let (first, last) = if ends == Ends::Joined { (n - 1, 0) } else { (0, n - 1) };
        let (mut before, mut here) = (value(first), value(0));
        for (k, ([left, right], out)) in weights.iter().zip(out).enumerate() {
            let after = if k + 1 < n { value(k + 1) } else { value(last) };
            let (less, more) = (simd.sub_f64s(here, before), simd.sub_f64s(here, after));
            *out = if ends == Ends::Weighted {
                let less = simd.mul_f64s(simd.splat_f64s(*left), less);
                simd.mul_add_f64s(simd.splat_f64s(*right), more, less)
            } else {
                simd.mul_f64s(simd.splat_f64s(*left), simd.add_f64s(less, more))
            };
            (before, here) = (here, after);
        }
    }

    /// Solves `(sD + z)u = right` for N poles, and adds the real parts of their weighted solutions to the values.
    /// `parts` holds n × 2N vectors.
    #[inline(always)]
    fn add_solutions<const N: usize>(
        &mut self,
        solvers: [&Solver; N],
        right: &[S::f64s],
        parts: &mut [S::f64s],
    ) {
        let (simd, n) = (self.simd, self.weights.len());
        let (right, parts) = (&right[..n], &mut parts[..2 * N * n]);
        let pivots = solvers.map(|solver| &solver.pivots[..n]);
        let zero = simd.splat_f64s(0.0);
        let mut states = [[zero; 2]; N];
        for (k, (right, parts)) in right.iter().zip(parts.chunks_exact_mut(2 * N)).enumerate() {
            for p in 0..N {
                let ((a, b), before) = (pivots[p][k], solvers[p].forward[k]);
                let own = [a, b].map(|part| simd.mul_f64s(simd.splat_f64s(part), *right));
                states[p] = self.multiply_add(before, states[p], own);
                [parts[2 * p], parts[2 * p + 1]] = states[p];
            }
        }
        let back = solvers.map(|solver| &solver.back[..n]);
        let is_ring = solvers.iter().any(|solver| !solver.corner.is_empty());
        for (k, parts) in parts.chunks_exact_mut(2 * N).enumerate().rev() {
            let mut value = self.values[k * Self::VECTORS + self.side];
            for p in 0..N {
                if k + 1 < n {
                    states[p] = self.multiply_add(back[p][k], states[p], [parts[2 * p], parts[2 * p + 1]]);
                }
                if is_ring {
                    [parts[2 * p], parts[2 * p + 1]] = states[p];
                } else {
                    value = self.add_real_part(solvers[p].weight, states[p], value);
                }
            }
            self.values[k * Self::VECTORS + self.side] = value;
        }
        if is_ring {
            self.add_rings(solvers, parts);
        }
    }

    /// Adds the solutions of rings to the values, which are those of lines less a multiple of the corners' solution.
    #[inline(always)]
    fn add_rings<const N: usize>(&mut self, solvers: [&Solver; N], parts: &[S::f64s]) {
        let (simd, n) = (self.simd, self.weights.len());
        let part = |k: usize, p: usize| [parts[2 * (N * k + p)], parts[2 * (N * k + p) + 1]];
        for (p, solver) in solvers.into_iter().enumerate() {
            let factor = self.multiply_add(solver.corner_row, part(n - 1, p), part(0, p));
            let less = factor.map(|part| simd.neg_f64s(part));
            for (k, corner) in solver.corner.iter().enumerate() {
                let solution = self.multiply_add(*corner, less, part(k, p));
                let at = k * Self::VECTORS + self.side;
                self.values[at] = self.add_real_part(solver.weight, solution, self.values[at]);
            }
        }
    }

    /// `a·x + y` of complex numbers.
    #[inline(always)]
    fn multiply_add(&self, (a, b): Complex, [re, im]: [S::f64s; 2], [x, y]: [S::f64s; 2]) -> [S::f64s; 2] {
        let (simd, a, b) = (self.simd, self.simd.splat_f64s(a), self.simd.splat_f64s(b));
        let (x, y) = (simd.mul_add_f64s(a, re, x), simd.mul_add_f64s(a, im, y));
        [simd.negate_mul_add_f64s(b, im, x), simd.mul_add_f64s(b, re, y)]
    }

    /// `Re(a·x) + value`.
    #[inline(always)]
    fn add_real_part(&self, (a, b): Complex, [re, im]: [S::f64s; 2], value: S::f64s) -> S::f64s {
        let simd = self.simd;
        let value = simd.mul_add_f64s(simd.splat_f64s(a), re, value);
        simd.negate_mul_add_f64s(simd.splat_f64s(b), im, value)
    }
}
