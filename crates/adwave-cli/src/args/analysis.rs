//! The signal, the map of where it stands out, and its features.

use super::named::named;
use crate::signal::COORDS;
use adwave::bands::DEFAULT_EXTENT;
use adwave::features::{FeatureParams, Refinement, Response, ThresholdScope};
use adwave::saliency::{SALIENCY_EXTENT, SaliencyParams, Sign, Weighting};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// The names that a signal can have.
macro_rules! signal_names {
    () => {
        "coords, x, y, z (heights, say), normals, mean-curvature, gaussian-curvature, shape-index, density, degree (of a graph), luminance, lightness, \
         texture, texture-luminance, texture-lightness, a field of the file, or FILE.npy, FILE.dmat, FILE.csv or FILE.csv:COLUMN, FILE.gii \
         or FILE.gii:NAME, FILE.nii (CIFTI), FILE.mgh, lh.thickness (FreeSurfer: curv, annot)"
    };
}

pub(crate) use signal_names;

/// The signal that is split, filtered or analyzed.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct FieldArgs {
    #[arg(
        long,
        value_name = "NAME",
        help = concat!("The signal: ", signal_names!(), " [default: coords]"),
        help_heading = "Signal"
    )]
    field: Option<String>,
    /// The picture of the texture [default: the one that the OBJ's materials name]
    #[arg(long, value_name = "FILE", help_heading = "Signal")]
    pub(crate) texture: Option<PathBuf>,
}

impl FieldArgs {
    /// The name that was asked for.
    pub(crate) fn asked(&self) -> Option<&str> {
        self.field.as_deref()
    }

    /// The name that was asked for, else that of the coordinates.
    pub(crate) fn name(&self) -> &str {
        self.asked().unwrap_or(COORDS)
    }

    /// The same with another name in the place of none.
    pub(crate) fn or(&self, name: &str) -> Self {
        Self { field: Some(self.asked().unwrap_or(name).to_owned()), ..self.clone() }
    }
}

/// What is masked near a border.
#[derive(Debug, Args)]
pub(crate) struct BorderArgs {
    /// Mask what lies within so many σ of a border or of what is masked: features, and of a map each level, which
    /// fades in between S·σ and 2·S·σ; coordinates need 1
    #[arg(long = "border", value_name = "S", allow_negative_numbers = true, help_heading = "Border")]
    pub(crate) sigmas: Option<f64>,
}

/// How the levels are put together to a map.
#[derive(Debug, Args)]
pub(crate) struct MapArgs {
    /// How many of the finest levels are skipped [default: 0, with another weighting than signed 2]
    #[arg(long, value_name = "N", help_heading = "Map")]
    pub(crate) skip: Option<usize>,
    /// How the levels are weighed; all but signed give a map without a sign
    #[arg(long, value_name = "KIND", value_enum, default_value_t = WeightingArg::Signed, help_heading = "Map")]
    pub(crate) weighting: WeightingArg,
    /// Leave out the sign: bumps and dents alike
    #[arg(long, help_heading = "Map")]
    pub(crate) unsigned: bool,
    /// Which axis points up: the map becomes ranks in [0, 1], a third of them by height, as people look at what is up
    #[arg(long, value_name = "AXIS", value_enum, help_heading = "Map")]
    pub(crate) up: Option<Axis>,
}

impl MapArgs {
    pub(crate) fn params(&self, border: &BorderArgs) -> SaliencyParams {
        let weighting = match self.weighting {
            WeightingArg::Signed => None,
            WeightingArg::Paper => Some(Weighting::PerLevel),
            WeightingArg::Printed => Some(Weighting::AsPrinted),
            WeightingArg::Normalized => Some(Weighting::Normalized),
            WeightingArg::Ranks => Some(Weighting::Ranks),
            WeightingArg::None => Some(Weighting::Uniform),
        };
        let params = match weighting {
            None if self.unsigned => SaliencyParams::default().with_sign(Sign::Unsigned),
            None => SaliencyParams::default(),
            Some(weighting) => SaliencyParams::paper().with_weighting(weighting),
        };
        SaliencyParams { skip: self.skip.unwrap_or(params.skip), border_sigmas: border.sigmas, ..params }
    }

    /// Up to which share of the diagonal levels go where none are asked for.
    pub(crate) fn extent(&self) -> f64 {
        if self.is_along_normals() { SALIENCY_EXTENT } else { DEFAULT_EXTENT }
    }

    /// Whether coordinates are measured along the normals.
    pub(crate) fn is_along_normals(&self) -> bool {
        self.weighting == WeightingArg::Signed
    }
}

/// An axis of the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// How levels are weighed, by its name here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum WeightingArg {
    /// 1/mean by how unevenly the level is spread, with the sign: of coordinates + where the shape is convex, - where concave
    Signed,
    /// (max − mean)², one number per level
    #[value(alias = "level")]
    Paper,
    /// (max − |W|)² at each vertex, as eq. 17 is printed
    Printed,
    /// 1/mean, so that every level counts alike
    Normalized,
    /// Ranks in place of values
    Ranks,
    /// 1
    None,
}

/// What counts as a feature.
#[derive(Debug, Args)]
pub(crate) struct DetectArgs {
    /// How many times the mean response of its level a feature has
    #[arg(
        long,
        value_name = "T",
        default_value_t = FeatureParams::default().theta,
        allow_negative_numbers = true,
        help_heading = "Features"
    )]
    pub(crate) theta: f64,
    /// The response that is compared in place and scale
    #[arg(long, value_name = "KIND", value_enum, default_value_t, help_heading = "Features")]
    pub(crate) response: ResponseArg,
    /// Take the mean in the threshold over each connected component
    #[arg(long, help_heading = "Features")]
    pub(crate) per_component: bool,
    /// Place features between vertices and levels, by fitting a quadric and a parabola
    #[arg(long, help_heading = "Features")]
    pub(crate) refine: bool,
    /// Reject edges: the largest ratio of the response's principal curvatures (SIFT takes 10)
    #[arg(long, value_name = "R", allow_negative_numbers = true, help_heading = "Features")]
    pub(crate) edge_ratio: Option<f64>,
    /// Keep only so many, the strong ones well spread
    #[arg(long, value_name = "N", help_heading = "Features")]
    pub(crate) best: Option<usize>,
}

impl DetectArgs {
    pub(crate) fn params(&self, border: &BorderArgs) -> FeatureParams {
        FeatureParams {
            theta: self.theta,
            response: self.response.into(),
            scope: if self.per_component { ThresholdScope::Component } else { ThresholdScope::Shape },
            refinement: if self.refine { Refinement::Quadratic } else { Refinement::Off },
            max_edge_ratio: self.edge_ratio,
            border_sigmas: border.sigmas,
            best: self.best,
        }
    }
}

named! {
    /// `adwave::features::Response` by its names here.
    ResponseArg for Response {
        /// Each level by its own mean
        Normalized = Normalized,
        /// W itself, as printed; finds the size of a scalar's bumps
        Literal = Literal,
        /// Every channel by itself
        Channels = Channels,
        /// W by σ of its level
        Sigma = Sigma,
    }
}
