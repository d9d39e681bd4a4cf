//! Fig. 2: scaling functions and wavelets of three kinds on a line of 100 points.

use crate::charts::{N_POINTS, line, linear, row};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave_baselines::line::line_case;
use adwave_render::plot::{Chart, Sheet};

/// Levels of the figure in the paper.
const LEVELS: [usize; 2] = [9, 10];
/// Largest mean that is zero up to rounding.
const ZERO: f64 = 1e-9;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    context.progress.step(0, 1)?;
    let cases = line_case(&line()?, &LEVELS)?;
    let mut table = Table::new(
        "fig02.csv",
        "Means over all functions of a level; support counts entries above 1e-6 of the largest",
        &[
            "kind",
            "level",
            "steps",
            "functions",
            "support of φ",
            "support of ψ",
            "hold 99 % of φ",
            "hold 99 % of ψ",
            "mean of ψ",
        ],
    );
    for c in &cases {
        table.push([
            c.name.to_owned(),
            c.level.to_string(),
            c.steps.to_string(),
            c.count.to_string(),
            digits(c.scaling.support),
            digits(c.wavelet.support),
            digits(c.scaling.core),
            digits(c.wavelet.core),
            digits(c.wavelet.mean),
        ]);
    }
    let coarse = |name: &str| {
        let found = cases.iter().find(|c| c.name == name && c.level == LEVELS[1]);
        found.ok_or_else(|| FigureError::from(format!("{name} has no level {}", LEVELS[1])))
    };
    let (dw, bdw, adw) = (coarse("DW")?, coarse("BDW")?, coarse("ADW")?);
    let local = |support: f64| support < dw.scaling.support;
    let verdict = Verdict::from_parts(
        &[
            local(bdw.scaling.support),
            local(adw.scaling.support),
            adw.wavelet.mean < ZERO,
            bdw.wavelet.mean > ZERO,
            dw.wavelet.mean > ZERO,
        ],
        format!(
            "On level {}, after {} steps each, the support of the scaling functions is {} (DW), {} (BDW) and {} (ADW) \
             of {N_POINTS} points, and 99 % of a function lie on {}, {} and {} points. The largest mean of a wavelet \
             is {} (DW), {} (BDW) and {} (ADW).",
            LEVELS[1],
            adw.steps,
            digits(dw.scaling.support),
            digits(bdw.scaling.support),
            digits(adw.scaling.support),
            digits(dw.scaling.core),
            digits(bdw.scaling.core),
            digits(adw.scaling.core),
            digits(dw.wavelet.mean),
            digits(bdw.wavelet.mean),
            digits(adw.wavelet.mean),
        ),
    );
    let mut sheet = Sheet { columns: 3, ..Sheet::default() };
    for name in ["DW", "BDW", "ADW"] {
        let of_kind = || cases.iter().filter(|c| c.name == name);
        let scaling = of_kind().map(|c| row(format!("φ of level {}", c.level), &c.middle_scaling));
        let wavelet = of_kind().map(|c| row(format!("ψ of level {}", c.level), &c.middle_wavelet));
        for (kind, series) in [("scaling functions", scaling.collect()), ("wavelets", wavelet.collect())] {
            let title = format!("{name}: {kind}");
            sheet.charts.push(Chart { title, x: linear("point"), y: linear("value"), series });
        }
    }
    // Scaling functions above, wavelets below.
    sheet.charts = [0, 2, 4, 1, 3, 5].map(|k| sheet.charts[k].clone()).to_vec();
    let outcome = Outcome::new(verdict).add_shape(format!("a line of {N_POINTS} points")).charts(
        "fig02",
        "The functions whose peaks are closest to the center. From left to right: DW, BDW, ADW. Top: scaling \
         functions. Bottom: wavelets.",
        &sheet,
    )?;
    Ok(outcome
        .say(
            "The paper claims that diffusion wavelets (DW) are orthogonal but not local, that biorthogonal ones (BDW) \
             are local but do not have zero mean, and that admissible ones (ADW) are local with zero mean. \
             Level j of DW and BDW is T^(2^j − 1); ADW \
             is computed with the same number of steps. At such a deep level, the support of all of them is the whole \
              of such a short line. By the points with 99 % of a function, ADW and BDW are equal, since both are the \
              same power of the walk, and narrower than DW.",
        )
        .table(table))
}
