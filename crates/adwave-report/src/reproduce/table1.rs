//! Table 1: the properties of three kinds of wavelets, as numbers.

use super::charts::{N_POINTS, line};
use super::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave_baselines::line::{LineCase, line_case};

/// The levels that are measured.
const LEVELS: [usize; 3] = [4, 9, 10];
/// Orthogonal or biorthogonal to rounding.
const ORTHOGONAL: f64 = 1e-8;
/// A mean below this is zero to rounding.
const ZERO: f64 = 1e-9;
/// A reconstruction within this is lossless.
const LOSSLESS: f64 = 1e-8;

pub(super) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    context.progress.step(0, 1)?;
    let cases = line_case(&line()?, &LEVELS)?;
    let mut table = Table::new(
        "table1.csv",
        "What the paper ticks, as numbers",
        &[
            "kind",
            "level",
            "functions",
            "largest defect of (bi)orthogonality",
            "support of φ",
            "support of ψ",
            "largest mean of ψ",
            "admissibility sum of ψ",
            "largest error of reconstruction",
            "seconds of reconstruction",
        ],
    );
    for c in &cases {
        table.push([
            c.name.to_owned(),
            c.level.to_string(),
            c.count.to_string(),
            digits(c.defect),
            digits(c.scaling.support),
            digits(c.wavelet.support),
            digits(c.wavelet.mean),
            digits(admissibility(&c.middle_wavelet)),
            digits(c.error),
            digits(c.seconds),
        ]);
    }
    let all = |name: &str, holds: &dyn Fn(&LineCase) -> bool| {
        let mut of = cases.iter().filter(|c| c.name == name).peekable();
        of.peek().is_some() && of.all(holds)
    };
    let narrower = |c: &LineCase| {
        let dw = cases.iter().find(|d| d.name == "DW" && d.level == c.level);
        dw.is_some_and(|d| c.scaling.support <= d.scaling.support)
    };
    let claims = [
        ("DW are orthogonal", all("DW", &|c| c.defect < ORTHOGONAL)),
        ("BDW are biorthogonal", all("BDW", &|c| c.defect < ORTHOGONAL)),
        ("BDW are no wider than DW", all("BDW", &narrower)),
        ("ADW are no wider than DW", all("ADW", &narrower)),
        ("the wavelets of ADW have zero mean", all("ADW", &|c| c.wavelet.mean < ZERO)),
        ("those of BDW have not", all("BDW", &|c| c.wavelet.mean > ZERO)),
        ("all rebuild the signal", cases.iter().all(|c| c.error < LOSSLESS)),
    ];
    let failed: Vec<&str> = claims.iter().filter(|c| !c.1).map(|c| c.0).collect();
    let sentence = if failed.is_empty() {
        "Every claim holds in numbers.".to_owned()
    } else {
        format!("Not borne out: {}.", failed.join("; "))
    };
    let verdict = Verdict::from_parts(&claims.map(|c| c.1), sentence);
    Ok(Outcome::new(verdict)
        .on(format!("a line of {N_POINTS} points"))
        .say(
            "The admissibility sum is Σ |F_ψ(k)|²/k of section 3.2 over the cosines of the line, which are its manifold \
             harmonics, with the constant function, k = 0, counted as k = 1e-6 in place of a division by zero: a wavelet whose \
             mean is not zero shows as a large number.",
        )
        .table(table))
}

/// `Σ_k |⟨ψ, cos_k⟩|²/k` over the orthonormal cosines of the line, for ψ of unit length.
fn admissibility(wavelet: &[f64]) -> f64 {
    let n = wavelet.len();
    let square: f64 = wavelet.iter().map(|v| v * v).sum();
    let part = |k: usize| {
        let size = if k == 0 { 1.0 / n as f64 } else { 2.0 / n as f64 };
        let inner: f64 = wavelet
            .iter()
            .enumerate()
            .map(|(x, v)| v * (std::f64::consts::PI * k as f64 * (x as f64 + 0.5) / n as f64).cos())
            .sum();
        let weight = if k == 0 { 1e-6 } else { k as f64 };
        size * inner * inner / weight
    };
    if square > 0.0 { (0..n).map(part).sum::<f64>() / square } else { 0.0 }
}
