//! Tests of `adwave-cli`, in one program: each program of its own would be linked with everything again.

mod analysis;
mod animate;
mod brains;
#[path = "../promises/cells_file.rs"]
mod cells_file;
mod cloud_part;
mod commands;
mod common;
mod compare;
mod curves;
#[path = "../../../adwave/tests/it/cylinder.rs"]
mod cylinder;
mod deform;
mod directions;
mod field_files;
mod gains_everywhere;
mod graphs;
mod grids;
mod grids_compared;
mod hostile;
mod labels;
mod levels;
mod many_channels;
mod missing_values;
mod moved_shapes;
mod own_domain;
mod plates;
mod provenance;
mod real_shapes;
mod region;
mod render;
mod report;
mod reproduce;
mod row_numbers;
mod selection;
mod series;
mod simplify;
mod slopes;
mod strays;
mod studio;
mod subdivision;
mod tiles;
mod tiles_in_memory;
mod two_shapes;
mod units;
mod walks;
