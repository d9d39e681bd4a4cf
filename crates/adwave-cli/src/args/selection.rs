//! The vertices that take part.

use crate::error::CliError;
use adwave_io::{FlaggedPoints, MaskFile, MaskSide, Selection};
use clap::Args;

/// The vertices that take part.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Part of the data")]
pub(crate) struct SelectionArgs {
    /// Compute on these vertices only: FIELD=VALUE,VALUE,… or FIELD=LOW..HIGH, where either end may be missing, as in
    /// 'classification=2'. May be given several times; all must hold. The other vertices keep their positions and
    /// values and are nobody's neighbors
    #[arg(long, value_name = "CONDITION")]
    only: Vec<String>,
    /// Compute on the vertices in this mask only. In a file of one number per vertex (.npy, .csv, .gii and others;
    /// :NAME selects a column) all but 0 and NaN are in; of a FreeSurfer label its vertices, of that of the medial wall
    /// the others; of an .annot the regions of the cortex, or those after a colon
    #[arg(long, value_name = "FILE")]
    mask: Option<String>,
    /// Compute on the vertices that are not in the mask
    #[arg(long, requires = "mask")]
    invert_mask: bool,
    /// LAS and LAZ: let points take part that are flagged as withheld or classified as noise (7 and 18)
    #[arg(long)]
    all_points: bool,
}

impl SelectionArgs {
    pub(crate) fn to_selection(&self) -> Result<Selection, CliError> {
        let conditions = self.only.iter().map(|text| text.parse()).collect::<Result<_, _>>();
        let side = if self.invert_mask { MaskSide::Outside } else { MaskSide::Inside };
        Ok(Selection {
            conditions: conditions.map_err(|e| CliError::Input(format!("--only: {e}")))?,
            mask: self.mask.clone().map(|name| MaskFile { name, side }),
            flagged: if self.all_points { FlaggedPoints::Included } else { FlaggedPoints::LeftOut },
        })
    }
}
