//! Which part of a cloud is read.

use adwave_io::CloudPart;
use clap::Args;

/// The least and the greatest coordinates.
type Bounds = ([f64; 3], [f64; 3]);

/// Which part of a cloud is read.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct PartArgs {
    /// Only the points in this box, in model units, its faces included: XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or XMIN,YMIN,XMAX,YMAX; of LAS,
    /// LAZ, COPC and EPT. Of the last two only the nodes that meet it are read
    #[arg(
        long = "box",
        value_name = "X,Y,…",
        value_parser = bounds,
        allow_hyphen_values = true,
        help_heading = "Part of a cloud"
    )]
    pub(crate) bounds: Option<Bounds>,
    /// Points about this far apart, in model units: no finer levels of a COPC or EPT are read than that needs
    #[arg(long, value_name = "R", allow_negative_numbers = true, help_heading = "Part of a cloud")]
    pub(crate) resolution: Option<f64>,
}

impl PartArgs {
    pub(crate) fn part(&self) -> CloudPart {
        CloudPart { bounds: self.bounds, resolution: self.resolution }
    }
}

/// Reads six numbers, or four where z is free.
fn bounds(text: &str) -> Result<Bounds, String> {
    let refused = || "it takes six numbers XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or four without z".to_owned();
    let number = |word: &str| word.trim().parse::<f64>().map_err(|_| refused());
    let numbers = text.split(',').map(number).collect::<Result<Vec<f64>, _>>()?;
    match numbers[..] {
        [x0, y0, x1, y1] => Ok(([x0, y0, f64::NEG_INFINITY], [x1, y1, f64::INFINITY])),
        [x0, y0, z0, x1, y1, z1] => Ok(([x0, y0, z0], [x1, y1, z1])),
        _ => Err(refused()),
    }
}
