//! Flags that several commands share, each defined once. The flags of a single command stand with that command.

mod analysis;
mod base_width;
mod cloud_part;
mod file_name;
mod given_length;
mod global;
mod labels;
mod levels;
mod local_fit;
mod normals;
mod operator;
mod parse;
mod quads;
mod quantity;
mod region_help;
mod selection;
mod shape;
mod signal;
mod time;
mod walk;

pub(crate) use analysis::{BorderMaskArgs, DetectArgs, MapArgs};
pub(crate) use base_width::BaseWidthArgs;
pub(crate) use cloud_part::CloudPartArgs;
pub(crate) use file_name::{file_name, shown_text, to_path};
pub(crate) use given_length::GivenLength;
pub(crate) use global::GlobalArgs;
pub(crate) use labels::LabelArgs;
pub(crate) use levels::LevelArgs;
pub(crate) use local_fit::LocalFitArgs;
pub(crate) use normals::NormalArgs;
pub(crate) use operator::{OPERATOR_OPTIONS, OperatorArgs, WALK_OPTIONS};
pub(crate) use parse::{
    count, count_from_one, length, number, parse_named, region, seed, shared_noise, size, value_type,
};
pub(crate) use quads::{QUAD_OPTIONS, QuadArgs};
pub(crate) use quantity::QuantityArgs;
pub(crate) use region_help::regions_help;
pub(crate) use selection::SelectionArgs;
pub(crate) use shape::ShapeArgs;
pub(crate) use signal::{SignalArgs, signal_names};
pub(crate) use time::{GainRows, TimeArgs, TimeAxisArgs, gain_rows};
pub(crate) use walk::{GivenWalkArgs, SCALE_NEIGHBOR, WalkArgs};
