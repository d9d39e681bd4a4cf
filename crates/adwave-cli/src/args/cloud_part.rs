//! The part of a cloud that is read.

use adwave_io::CloudPart;
use clap::Args;

/// The least and the greatest coordinates.
type Bounds = ([f64; 3], [f64; 3]);

/// The part of a cloud that is read.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct CloudPartArgs {
    /// Read only the points in this box, its faces included: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX or XMIN,YMIN,XMAX,YMAX in
    /// model units. For LAS, LAZ, COPC and EPT; of COPC and EPT only the nodes that meet the box are read
    #[arg(
        long = "box",
        value_name = "X,Y,…",
        value_parser = bounds,
        allow_hyphen_values = true,
        help_heading = "Part of a cloud"
    )]
    bounds: Option<Bounds>,
    /// Read points about this far apart, in model units: of COPC and EPT only the levels that this needs
    #[arg(long, value_name = "R", value_parser = super::number, allow_negative_numbers = true, help_heading = "Part of a cloud")]
    resolution: Option<f64>,
}

impl CloudPartArgs {
    pub(crate) fn to_part(&self) -> CloudPart {
        CloudPart { bounds: self.bounds, resolution: self.resolution }
    }
}

/// Reads six numbers, or four for a box without bounds in z.
fn bounds(text: &str) -> Result<Bounds, String> {
    let refused = || "must be XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX or XMIN,YMIN,XMAX,YMAX".to_owned();
    let number = |word: &str| word.trim().parse::<f64>().map_err(|_| refused());
    let numbers = text.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
    match numbers[..] {
        [x0, y0, x1, y1] => Ok(([x0, y0, f64::NEG_INFINITY], [x1, y1, f64::INFINITY])),
        [x0, y0, z0, x1, y1, z1] => Ok(([x0, y0, z0], [x1, y1, z1])),
        _ => Err(refused()),
    }
}
