//! From the --region arguments to weights on a shape.

use crate::error::CliError;
use crate::shape_input::Input;
use crate::signal;
use adwave::region::{Region, RegionSyntaxError, parse_region};
use adwave::{Decomposer, Progress};
use adwave_io::region_field;

/// What the help of every command with regions says of them.
macro_rules! regions_help {
    () => {
        "\
Regions (0 outside, rising smoothly to 1 inside; lengths in model units or in % of the diagonal):
  ball:vertex=V,radius=R[,falloff=F]        within R of a vertex along the surface (or point=X Y Z)
  stroke:path=X Y Z;X Y Z;…,radius=R        within R of a line over the surface (or vertices=V V …)
  box:min=X Y Z,max=X Y Z[,falloff=F]       half-space:point=X Y Z,normal=X Y Z[,falloff=F]
  field:name=NAME[,low=A][,high=B]          0 where the field is A, 1 where it is B
                                            (saliency, mean-curvature, band-3 and such of any shape)
  vertices:indices=V V …[,radius=R]         within R of one of them[,falloff=F]; all
  facing:direction=X Y Z[,falloff=COSINE]   normals that way          component:vertex=V  what hangs together
  grown:by=L(REGION)  shrunk:by=L(REGION)   its edge moved by L       blurred:by=L(REGION)  softer by L
  !REGION not   REGION & REGION both   REGION | REGION either   0.5*REGION fainter   ( … )
"
    };
}

pub(crate) use regions_help;

/// Reads a region, for clap.
pub(crate) fn region(text: &str) -> Result<Region, RegionSyntaxError> {
    parse_region(text)
}

/// Where any of the regions is; everywhere without one.
pub(crate) fn joined(regions: &[Region]) -> Region {
    match regions {
        [] => Region::Everywhere {},
        [one] => one.clone(),
        several => Region::Any(several.to_vec()),
    }
}

/// The weights of a region, one for each vertex of the shape, as a filter has them.
pub(crate) fn weights(
    region: &Region,
    input: &Input,
    decomposer: &Decomposer,
    progress: Progress<'_>,
) -> Result<Vec<f64>, CliError> {
    let names = signal::field_names(&input.file);
    let lookup = |name: &str| region_field(&input.file, decomposer, name);
    let weights = region.weights(decomposer.metric(), &lookup, &names, progress);
    let weights = weights.map_err(|e| CliError::classified(&e))?;
    Ok(weights.to_vertices(decomposer.geometry().vertex_map()))
}
