//! Flags of saliency maps, of features, and of the mask near borders.

use super::parse::{count, count_from_one, number, parse_named};
use adwave::features::{FeatureParams, Refinement, Response, ThresholdScope};
use adwave::saliency::{MapWeighting, SaliencyParams, Sign};
use adwave::vector::Axis;
use clap::Args;
use std::num::NonZeroUsize;

/// The mask near a border.
#[derive(Debug, Args)]
pub(crate) struct BorderMaskArgs {
    /// Mask features within S·σ of a border or of masked vertices, and let each level of a map fade in between S·σ and
    /// 2·S·σ; maps of coordinates need 1 [default: 4 for significant features of a mesh, otherwise no mask]
    #[arg(
        long = "mask-border",
        alias = "border",
        value_name = "S",
        value_parser = number,
        allow_negative_numbers = true,
        help_heading = "Border"
    )]
    pub(crate) sigmas: Option<f64>,
}

/// Levels of a map and their weights.
#[derive(Debug, Args)]
#[command(next_help_heading = "Map")]
pub(crate) struct MapArgs {
    /// Number of the finest levels to skip [default: 0, with another weighting than signed 2]
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) skip: Option<usize>,
    /// Weighting of the levels; all but signed give a map without a sign
    #[arg(long, value_name = "KIND", value_parser = parse_named::<MapWeighting>(), default_value_t)]
    pub(crate) weighting: MapWeighting,
    /// Drop the sign: bumps and dents count alike
    #[arg(long)]
    pub(crate) unsigned: bool,
    /// Axis that points up: the map becomes ranks in [0, 1], a third of them by height, since people look at what is up
    #[arg(long, value_name = "AXIS", value_parser = parse_named::<Axis>())]
    pub(crate) up: Option<Axis>,
}

impl MapArgs {
    pub(crate) fn to_params(&self, border: &BorderMaskArgs) -> SaliencyParams {
        let params = self.weighting.params(if self.unsigned { Sign::Unsigned } else { Sign::Signed });
        params.with_skip(self.skip.unwrap_or(params.skip)).with_border_sigmas(border.sigmas)
    }
}

/// Criteria for features.
#[derive(Debug, Args)]
#[command(next_help_heading = "Features")]
pub(crate) struct DetectArgs {
    /// Threshold of the paper's Algorithm 2: least response, relative to the mean response of its level [default: 2.4,
    /// and significance for the coordinates of meshes and clouds]
    #[arg(long, value_name = "T", value_parser = number, allow_negative_numbers = true)]
    pub(crate) theta: Option<f64>,
    /// Response of Algorithm 2 that is compared between neighbors and levels; without this option literal on an image or a
    /// volume
    #[arg(long, value_name = "KIND", value_parser = parse_named::<Response>(), default_value_t)]
    pub(crate) response: Response,
    /// Compare with the mean over each connected component instead of the whole shape
    #[arg(long)]
    pub(crate) per_component: bool,
    /// Place features between vertices and levels, by fitting a quadric and a parabola
    #[arg(long)]
    pub(crate) refine: bool,
    /// Reject edges: largest ratio of the principal curvatures of the response (SIFT takes 10)
    #[arg(long, value_name = "R", value_parser = number, allow_negative_numbers = true)]
    pub(crate) edge_ratio: Option<f64>,
    /// Keep only the N strongest features that are well spread
    #[arg(long, value_name = "N", value_parser = count_from_one)]
    pub(crate) best: Option<NonZeroUsize>,
}

impl DetectArgs {
    pub(crate) fn to_params(&self, border: &BorderMaskArgs) -> FeatureParams {
        FeatureParams::default()
            .with_theta(self.theta)
            .with_response(self.response)
            .with_scope(if self.per_component { ThresholdScope::Component } else { ThresholdScope::Shape })
            .with_refinement(if self.refine { Refinement::Quadratic } else { Refinement::Off })
            .with_max_edge_ratio(self.edge_ratio)
            .with_border_sigmas(border.sigmas)
            .with_best(self.best.map(NonZeroUsize::get))
    }
}
