//! The domain of a CIFTI: its surfaces, which stand in files of their own, and its voxels.

use crate::args::{OPERATOR_OPTIONS, to_path};
use crate::error::CliError;
use crate::global::Global;
use crate::output::count;
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::Shape;
use adwave::{ClassifiedError, Decomposer, ErrorKind};
use adwave_io::{BrainLayout, BrainPart, BrainPlaces, ShapeFile, read_path_with};
use std::fmt::Display;

/// Commands that take a CIFTI as a whole.
const BRAIN_COMMANDS: [&str; 4] = ["info", "transform", "filter", "denoise"];

/// Option that names the file of a surface.
pub(crate) const SURFACE: &str = "--surface";

/// A surface for one of the parts.
struct GivenSurface {
    path: String,
    structure: String,
    shape: Shape,
}

/// The domain of the parts of a CIFTI, whose values diffuse within each part alone, and a remark that says so; `None` for
/// other files.
pub(crate) fn brain_of(
    file: &ShapeFile,
    name: &str,
    surfaces: &[String],
    global: &Global<'_>,
) -> Result<Option<Decomposer>, CliError> {
    let Some(layout) = file.brain() else { return Ok(None) };
    let command = global.given.command();
    if !BRAIN_COMMANDS.contains(&command) {
        return Err(CliError::Input(format!(
            "{command} takes shapes, and {name} has values of a brain, which {} take; give one surface as the shape and the \
             CIFTI as --signal",
            BRAIN_COMMANDS.join(", ")
        )));
    }
    let applies = format!("applies to shapes, and {name} is a CIFTI, whose surfaces have heat");
    global.given.refuse(&OPERATOR_OPTIONS, &applies)?;
    let applies = format!("applies to the vertices of one shape, and {name} is a CIFTI of several");
    global.given.refuse(&["--only", "--mask", "--invert-mask", "--as", "--walk"], &applies)?;
    let mut given: Vec<GivenSurface> =
        surfaces.iter().map(|text| read_surface(text, layout, name, global)).collect::<Result<_, _>>()?;
    let (mut parts, mut described) = (Vec::new(), Vec::new());
    let mut rest = &layout.parts[..];
    while let Some((part, after)) = rest.split_first() {
        if let BrainPlaces::Surface { n_vertices, vertices } = &part.places {
            let surface = take_surface(&mut given, part, *n_vertices, name)?;
            parts.push(surface_part(&surface, vertices, global)?);
            let (n, path) = (vertices.len(), &surface.path);
            described.push(format!("{} ({n} of {n_vertices} vertices of {path})", part.structure));
            rest = after;
            continue;
        }
        let n = rest.iter().take_while(|part| matches!(part.places, BrainPlaces::Voxels { .. })).count();
        let (voxels, after) = rest.split_at(n.max(1));
        parts.push(voxel_part(layout, voxels, name, global)?);
        let rows: usize = voxels.iter().map(|part| part.rows.len()).sum();
        let structures = count(n, "structure", "structures");
        described.push(format!("{} of {structures}, each by itself", count(rows, "voxel", "voxels")));
        rest = after;
    }
    if let Some(surface) = given.first() {
        return Err(CliError::Input(format!(
            "{SURFACE} {}: it is {}, of which {name} has no values; leave it out",
            surface.path, surface.structure
        )));
    }
    global.inputs.add_remark(format!("{name}: {}", described.join("; ")));
    Decomposer::union(&parts).map(Some).map_err(|e| CliError::Input(format!("{name}: {e}")))
}

/// Reads the file of a surface, whose structure it states, or the text before `=`.
fn read_surface(
    text: &str,
    layout: &BrainLayout,
    name: &str,
    global: &Global<'_>,
) -> Result<GivenSurface, CliError> {
    let is_known = |structure: &str| {
        layout.parts.iter().any(|part| BrainLayout::is_same_structure(&part.structure, structure))
    };
    let (stated, path) = match text.split_once('=') {
        Some((structure, path)) if is_known(structure) => (Some(structure.to_owned()), path),
        _ => (None, text),
    };
    let failed = |e: &dyn Display| CliError::Input(format!("{SURFACE} {path}: {e}"));
    global.inputs.add_file(&to_path(path));
    let file =
        read_path_with(&to_path(path), &global.limits, global.progress()).map_err(|e| match e.kind() {
            ErrorKind::Cancelled => CliError::Cancelled,
            _ => CliError::input(e),
        })?;
    let Some(structure) = stated.or_else(|| file.structure().map(str::to_owned)) else {
        let first = layout.parts.first().map_or("CORTEX_LEFT", |part| &part.structure);
        return Err(failed(&format!(
            "the file does not say which part of {name} it is the surface of; write {SURFACE} {first}={path}"
        )));
    };
    let shape = file.to_shape().map_err(|e| failed(&e))?;
    if !shape.is_mesh() {
        return Err(failed(&"a surface is a mesh, and this file has no faces"));
    }
    Ok(GivenSurface { path: path.to_owned(), structure, shape })
}

/// Takes the surface of a part out of those that were given.
fn take_surface(
    given: &mut Vec<GivenSurface>,
    part: &BrainPart,
    n_vertices: usize,
    name: &str,
) -> Result<GivenSurface, CliError> {
    let structure = &part.structure;
    let is_own = |surface: &GivenSurface| BrainLayout::is_same_structure(&surface.structure, structure);
    let Some(at) = given.iter().position(is_own) else {
        return Err(CliError::Input(format!(
            "{name} has values of {structure}, whose surface is not given; add {SURFACE} with the file of a mesh of \
             {n_vertices} vertices, or change one surface alone: the surface as SHAPE, --signal {name}"
        )));
    };
    let surface = given.remove(at);
    if let Some(other) = given.iter().find(|surface| is_own(surface)) {
        return Err(CliError::Input(format!(
            "{SURFACE} {} and {} are both {structure}; leave one out",
            surface.path, other.path
        )));
    }
    let found = surface.shape.n_vertices();
    if found != n_vertices {
        return Err(CliError::Input(format!(
            "{SURFACE} {}: {structure} of {name} has {n_vertices} vertices, and the surface has {found}; use the matching \
             surface",
            surface.path
        )));
    }
    Ok(surface)
}

/// The vertices of a surface that have a row.
fn surface_part(
    surface: &GivenSurface,
    vertices: &[u32],
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let whole = Decomposer::with_params(&surface.shape, &params, global.progress())
        .map_err(|_| CliError::Cancelled)?;
    part(&whole, vertices, &vec![0; vertices.len()], &surface.path, global)
}

/// The voxels of some structures. Nothing flows from one structure to another.
fn voxel_part(
    layout: &BrainLayout,
    structures: &[BrainPart],
    name: &str,
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    let failed = |e: &dyn Display| CliError::Input(format!("{name}: {e}"));
    let Some(volume) = &layout.volume else { return Err(failed(&"the voxels have no volume")) };
    let grid = volume.to_grid().map_err(|e| failed(&e))?;
    let heat = grid.heat();
    let whole = Decomposer::from_domain(grid, heat).map_err(|e| failed(&e))?;
    let (mut places, mut labels) = (Vec::new(), Vec::new());
    for (label, structure) in (0..).zip(structures) {
        if let BrainPlaces::Voxels { voxels } = &structure.places {
            places.extend(voxels);
            labels.resize(places.len(), label);
        }
    }
    part(&whole, &places, &labels, name, global)
}

/// Some vertices of a domain as a domain of their own.
fn part(
    whole: &Decomposer,
    vertices: &[u32],
    labels: &[u32],
    name: &str,
    global: &Global<'_>,
) -> Result<Decomposer, CliError> {
    whole.part(vertices, labels, global.progress()).map_err(|e| match e.kind() {
        ErrorKind::Cancelled => CliError::Cancelled,
        _ => CliError::Input(format!("{name}: {e}")),
    })
}
