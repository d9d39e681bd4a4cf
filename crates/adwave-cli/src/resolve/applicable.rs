//! Refusal of options that apply to nothing on the shapes at hand.

use super::brain::SURFACE;
use super::shape::{Input, POINTS};
use crate::args::WALK_OPTIONS;
use crate::error::CliError;
use crate::global::Global;
use crate::output::note;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::Shape;
use adwave_io::Format;

/// Refuses options that none of the shapes of a command can use.
pub(crate) fn check_shape_options(inputs: &[&Input], global: &Global<'_>) -> Result<(), CliError> {
    let given = global.given;
    let Some(first) = inputs.first() else { return Ok(()) };
    let any = |is_it: fn(&Input) -> bool| inputs.iter().any(|input| is_it(input));
    let described = format!("{} is {} {}", first.name, article(first.kind_name()), first.kind_name());
    if !any(|input| input.shape.is_mesh()) {
        given
            .refuse(&["--rings", "--mesh-area", "--weld"], &format!("applies to meshes, and {described}"))?;
    }
    if !any(|input| input.shape.is_cloud() || input.name.starts_with(POINTS)) {
        given.refuse(&["--neighbors"], &format!("applies to clouds, and {described}"))?;
    }
    if !any(|input| input.shape.is_cloud()) {
        given.refuse(&["--cloud-area"], &format!("applies to clouds, and {described}"))?;
    }
    if !any(|input| input.file.brain().is_some()) {
        let applies = format!("applies to a CIFTI, which has values of several surfaces, and {described}");
        given.refuse(&[SURFACE], &applies)?;
    }
    if !any(|input| matches!(input.shape, Shape::Mesh(_) | Shape::Cloud(_))) {
        given.refuse(&["--no-weld"], &format!("applies to meshes and clouds, and {described}"))?;
    }
    check_source_options(inputs, global)
}

/// The article before the name of a kind of shape.
pub(crate) fn article(kind: &str) -> &'static str {
    if kind == "image" { "an" } else { "a" }
}

/// Refuses options that do not go with the files or samples that the shapes come from.
pub(crate) fn check_source_options(inputs: &[&Input], global: &Global<'_>) -> Result<(), CliError> {
    let given = global.given;
    let Some(first) = inputs.first() else { return Ok(()) };
    if !given.has("--noise") {
        given.refuse(&["--seed"], "applies to the noise of a sample (--noise)")?;
    }
    let has_flags =
        |input: &&Input| matches!(input.file.format(), Some(Format::LAS | Format::LAZ | Format::EPT));
    if !inputs.iter().any(has_flags) {
        let format = first.file.format().map_or("a sample".to_owned(), |format| format.to_string());
        given.refuse(
            &["--all-points"],
            &format!("applies to LAS and LAZ, whose points have flags, and {} is {format}", first.name),
        )?;
    }
    let is_geographic = |input: &&Input| {
        input.file.coordinate_system().is_some_and(adwave_io::CoordinateSystem::is_geographic)
    };
    if !inputs.iter().any(is_geographic) {
        given.refuse(
            &["--allow-degrees"],
            &format!("applies to files whose coordinates are degrees, and {} states none", first.name),
        )?;
    }
    Ok(())
}

/// Refuses options of the operator that a curve does not have, and notes that an option of the walk replaced the usual
/// operator.
pub(crate) fn check_operator_options(
    shape: &Shape,
    params: &OperatorParams,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let given = global.given;
    if let Shape::Graph(graph) = shape
        && graph.is_curve()
    {
        given.refuse(
            &["--operator", "--density-invariant"],
            "applies to meshes, clouds and graphs without positions, and a curve always has heat by arc length",
        )?;
    }
    let usual_is_surface = ["--lengths", "--fwhm"].iter().any(|option| given.has(option))
        || ["match", "diff"].contains(&given.command());
    let asked = WALK_OPTIONS.iter().find(|option| given.has(option));
    if let Some(option) = asked
        && usual_is_surface
        && !given.has("--operator")
        && params.kind == OperatorKind::Walk
    {
        note(
            global,
            &format!(
                "{option} is an option of the walk, so the operator is the walk instead of heat on the surface"
            ),
        );
    }
    Ok(())
}
