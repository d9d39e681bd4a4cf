//! From level flags to a schedule.

use crate::args::LevelArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{note, number};
use adwave::bands::{BandsParams, DEFAULT_EXTENT, FWHM, Schedule};
use adwave::region::Length;
use adwave::{Decomposer, LevelSpec, LevelSpecError, ResolvedLevels};

/// Accuracy and memory limit of the bands. Refuses levels that no shape can have, before any shape is read.
pub(crate) fn check_levels(args: &LevelArgs) -> Result<BandsParams, CliError> {
    let params = bands_params(args.accuracy)?;
    args.to_spec().check().map_err(|error| match error {
        LevelSpecError::BadWidth { nth, .. } => {
            let (flag, widths) = match (&args.lengths, &args.fwhm) {
                (Some(lengths), _) => ("--lengths", lengths.as_slice()),
                (None, fwhm) => ("--fwhm", fwhm.as_deref().unwrap_or_default()),
            };
            let width = widths.get(nth - 1).map_or_else(String::new, |width| format_length(*width));
            CliError::Input(format!(
                "{flag}: widths must be positive, finite and increasing, but number {nth} is {width}"
            ))
        }
        other => CliError::input(other),
    })?;
    Ok(params)
}

/// A length as it is typed.
pub(crate) fn format_length(length: Length) -> String {
    match length {
        Length::Units(units) => format!("{units:?}"),
        Length::PercentOfDiagonal(percent) => format!("{percent:?}%"),
        Length::Degrees(angle) => format!("{angle:?}deg"),
    }
}

/// Bands of this accuracy, within the memory that the machine has left.
fn bands_params(accuracy: Option<f64>) -> Result<BandsParams, CliError> {
    let params = BandsParams::default();
    let params = accuracy.map_or(params, |accuracy| params.with_accuracy(accuracy));
    params.check()?;
    Ok(adwave_io::free_memory().map_or(params, |bytes| params.with_max_bytes(bytes)))
}

/// The levels that the flags ask for, on a shape.
pub(crate) fn resolve_levels(
    args: &LevelArgs,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<ResolvedLevels, CliError> {
    resolve_spec(&args.to_spec(), DEFAULT_EXTENT, decomposer, global)
}

/// Levels on a shape, with a note if one is finer than the edges or wider than the shape. If no number is asked for,
/// the last level reaches the share `extent` of the diagonal.
pub(crate) fn resolve_spec(
    spec: &LevelSpec,
    extent: f64,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<ResolvedLevels, CliError> {
    if let LevelSpec::Widths(widths) = spec
        && decomposer.extent() <= 0.0
        && widths.iter().any(|width| matches!(width, Length::PercentOfDiagonal(_)))
    {
        return Err(CliError::Input(
            "a width in % needs positions, which this shape does not have; give it in lengths of an edge, such as 3"
                .to_owned(),
        ));
    }
    let resolved = spec.resolve(decomposer, extent)?;
    if let LevelSpec::Widths(widths) = spec {
        note_arcs(widths, decomposer, global);
        note_unusual_widths(widths, decomposer, global);
    }
    Ok(resolved)
}

/// Prints the radius on which widths in degrees were taken, and the beam that they are.
fn note_arcs(widths: &[Length], decomposer: &Decomposer, global: &Global<'_>) {
    let angle = |width: &Length| if let Length::Degrees(angle) = width { Some(*angle) } else { None };
    let angles: Vec<f64> = widths.iter().filter_map(angle).collect();
    if angles.is_empty() {
        return; // the radius asks for all positions, which a volume does not store
    }
    let Some(radius) = decomposer.sphere_radius() else { return };
    let list = |factor: f64| {
        angles.iter().map(|angle| format!("{}°", number(factor * angle))).collect::<Vec<_>>().join(", ")
    };
    note(
        global,
        &format!(
            "degrees are taken on the sphere of radius {}: FWHM {}, as Gaussian beams exp(−l(l+1)σ²/2) with σ = {}",
            number(radius),
            list(FWHM),
            list(std::f64::consts::FRAC_1_SQRT_2)
        ),
    );
}

fn note_unusual_widths(widths: &[Length], decomposer: &Decomposer, global: &Global<'_>) {
    let diagonal = decomposer.extent();
    if diagonal <= 0.0 {
        return;
    }
    let sigma = |width: &Length| decomposer.model_units(*width).unwrap_or(f64::NAN);
    let edge = decomposer.mean_length();
    if let Some(finest) = widths.first().map(sigma).filter(|finest| *finest < edge) {
        let (finest, edge) = (number(finest), number(edge));
        note(
            global,
            &format!(
                "σ = {finest} is below the mean edge length {edge}: such a band shows the mesh; wider levels would not"
            ),
        );
    }
    if let Some(widest) = widths.last().map(sigma).filter(|widest| *widest > diagonal) {
        let (widest, diagonal) = (number(widest), number(diagonal));
        note(
            global,
            &format!(
                "σ = {widest} is larger than the shape, whose diagonal is {diagonal}; give widths in its units, or in %"
            ),
        );
    }
}

/// These levels on a shape whose step length differs, as for a changed copy of the shape.
pub(crate) fn rescale_levels(
    spec: &LevelSpec,
    sigma: &[f64],
    step_length: f64,
) -> Result<Schedule, CliError> {
    if !matches!(spec, LevelSpec::Default | LevelSpec::Dyadic(_)) {
        return Ok(Schedule::lengths(sigma, step_length)?);
    }
    let octaves = 2.0 * (sigma[sigma.len() - 1] / step_length).log2();
    Ok(Schedule::dyadic((1.0 + octaves.round()).max(3.0) as usize)?)
}
