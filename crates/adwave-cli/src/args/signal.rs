//! The signal that is split, filtered or analyzed.

use adwave_io::{COORDS, ShapeFile, default_signal};
use clap::Args;
use std::path::PathBuf;

/// Names of signals, for help.
macro_rules! signal_names {
    () => {
        "coords, x, y, z (such as heights), normals, mean-curvature, gaussian-curvature, shape-index, principal-direction, density, degree (of a \
         graph), luminance, lightness, texture, texture-luminance, texture-lightness, a field of the file, or the values of another \
         file: FILE.npy, FILE.dmat, FILE.csv, FILE.csv:COLUMN, FILE.gii, FILE.gii:NAME, FILE.nii (CIFTI), FILE.mgh, \
         lh.thickness (FreeSurfer curv, annot, label)"
    };
}

pub(crate) use signal_names;

/// The signal that is split, filtered or analyzed.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct SignalArgs {
    #[arg(
        long = "signal",
        visible_alias = "field",
        value_name = "NAME",
        help = concat!("Signal on the shape: ", signal_names!(), " [default: coords; of an image or a volume its values]"),
        help_heading = "Signal"
    )]
    signal: Option<String>,
    /// Picture of the texture [default: the one that the materials of the OBJ name]
    #[arg(long, value_name = "FILE", help_heading = "Signal")]
    pub(crate) texture: Option<PathBuf>,
    /// Take -9999, 1e20 and other sentinels far from all other values as numbers, not as unknown
    #[arg(long, help_heading = "Signal")]
    keep_sentinels: bool,
}

impl SignalArgs {
    /// The name that was asked for.
    pub(crate) fn asked_name(&self) -> Option<&str> {
        self.signal.as_deref()
    }

    /// The name that was asked for, else that of the values of an image, a volume, a brain or a map, else that of the
    /// coordinates.
    pub(crate) fn name_on<'a>(&'a self, file: &'a ShapeFile) -> &'a str {
        let has_values = file.carries_values() || file.is_map();
        let usual = if has_values { default_signal(file) } else { COORDS };
        self.asked_name().unwrap_or(usual)
    }

    /// These arguments with another default name.
    pub(crate) fn with_default(&self, name: &str) -> Self {
        Self { signal: Some(self.asked_name().unwrap_or(name).to_owned()), ..self.clone() }
    }
}
