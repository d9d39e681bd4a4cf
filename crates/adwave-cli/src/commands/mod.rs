//! The subcommands, a file or a folder each: resolve → compute → write.

mod analysis;
pub(crate) mod basis;
mod basis_transform;
pub(crate) mod compare;
pub(crate) mod convert;
pub(crate) mod demo;
pub(crate) mod denoise;
pub(crate) mod diff;
pub(crate) mod evaluate;
pub(crate) mod features;
pub(crate) mod filter;
pub(crate) mod formats;
pub(crate) mod info;
pub(crate) mod matching;
pub(crate) mod region;
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod reproduce;
mod result_file;
pub(crate) mod saliency;
pub(crate) mod sample;
pub(crate) mod shell;
pub(crate) mod simplify;
pub(crate) mod studio;
mod terrain;
pub(crate) mod tiles;
pub(crate) mod transform;
