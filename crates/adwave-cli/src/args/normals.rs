//! Flags for normals and tangents of a shape whose vertices move.

use adwave_io::MovedNormals;
use clap::Args;

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct NormalArgs {
    /// Keep the normals and tangents in the file as they are; without this they are recomputed where the shape moves
    #[arg(long)]
    pub(crate) keep_normals: bool,
    /// The default, accepted for older scripts
    #[arg(long, hide = true, conflicts_with = "keep_normals")]
    pub(crate) update_normals: bool,
}

impl NormalArgs {
    pub(crate) fn to_rule(self) -> MovedNormals {
        if self.keep_normals { MovedNormals::Keep } else { MovedNormals::Follow }
    }
}
