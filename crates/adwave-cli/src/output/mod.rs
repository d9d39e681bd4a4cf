//! Results for people, for machines and as files.

pub(crate) mod denoising;
pub(crate) mod features_file;
mod files;
pub(crate) mod health;
mod lengths;
pub(crate) mod movement;
pub(crate) mod number;
mod print;
pub(crate) mod progress;
pub(crate) mod provenance;
pub(crate) mod stopwatch;
pub(crate) mod values_file;

pub(crate) use files::{
    check_writable, clone_for_output, has_extension, make_folder, note_report, output_format, release_source,
    without_gzip, write_file, write_file_with, write_shape,
};
pub(crate) use health::given_normals_json;
pub(crate) use lengths::{bounds_json, bounds_text, coordinate_text, fwhm_json, fwhm_text, percent_of};
pub(crate) use number::{bytes_text, count, number, shift, steps_json, steps_text};
pub(crate) use print::{
    command_line, note, peak_memory, plain_text, print, print_bytes, print_remarks, table, tell,
};
