//! Sharp edges and corners of meshes of quadrilaterals.

use super::parse::{number, parse_named};
use crate::error::CliError;
use crate::global::Global;
use adwave::Progress;
use adwave::shape::Mesh;
use adwave_subdivision::{BorderCorners, Hierarchy, SubdivisionError, WeldedMesh, sharp_edges};
use clap::Args;

/// Options that only meshes of quadrilaterals have.
pub(crate) const QUAD_OPTIONS: [&str; 2] = ["--sharp-edges", "--border-corners"];

/// Sharp edges and corners of Catmull–Clark subdivision.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Quadrilaterals")]
pub(crate) struct QuadArgs {
    /// Take edges with a greater angle between the normals of their faces as sharp, in degrees; of coarse edges, those
    /// with two sharp halves [default: no edge inside the surface is sharp]
    #[arg(long, value_name = "DEGREES", value_parser = number, allow_negative_numbers = true)]
    pub(crate) sharp_edges: Option<f64>,
    /// Rule for vertices of one face on a border [default: smooth]
    #[arg(long, value_name = "RULE", value_parser = parse_named::<BorderCorners>())]
    pub(crate) border_corners: Option<BorderCorners>,
}

impl QuadArgs {
    /// Refuses an angle that no edge can have, before a shape is read.
    pub(crate) fn check(&self) -> Result<(), CliError> {
        match self.sharp_edges {
            Some(angle) if !(0.0..=180.0).contains(&angle) => {
                Err(CliError::Input(format!("--sharp-edges must be in 0..=180 degrees, got {angle}")))
            }
            _ => Ok(()),
        }
    }

    /// Refuses these options for a mesh of triangles.
    pub(crate) fn refuse_on_triangles(mesh: &Mesh, name: &str, global: &Global<'_>) -> Result<(), CliError> {
        if mesh.faces().triangles().is_none() {
            return Ok(());
        }
        global.given.refuse(&QUAD_OPTIONS, &format!("applies to quadrilaterals, and {name} has triangles"))
    }

    /// Finds the levels of a mesh.
    pub(crate) fn hierarchy(
        &self,
        welded: &WeldedMesh,
        mesh: &Mesh,
        progress: Progress<'_>,
    ) -> Result<Hierarchy, SubdivisionError> {
        let creases = match self.sharp_edges {
            Some(angle) => {
                let of_welded = sharp_edges(&welded.points(mesh), &welded.faces, angle, progress)?;
                of_welded.into_iter().map(|pair| pair.map(|v| welded.vertices[v as usize])).collect()
            }
            None => Vec::new(),
        };
        welded.hierarchy(mesh, &creases, self.border_corners.unwrap_or_default(), progress)
    }
}
