//! Tests of `adwave-cli`, in one program: each program of its own would be linked with everything again.

mod analysis;
mod cloud_part;
mod commands;
mod common;
mod compare;
mod curves;
mod field_files;
mod hostile;
mod labels;
mod levels;
mod moved_shapes;
mod provenance;
mod real_shapes;
mod region;
mod render;
mod report;
mod reproduce;
mod row_numbers;
mod simplify;
mod slopes;
mod strays;
mod studio;
mod tiles;
mod two_shapes;
