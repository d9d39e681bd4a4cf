//! A tiling job: its plan, its folder, and its finished tasks.

pub(crate) mod begin;
pub(crate) mod folder;
pub(crate) mod forecast;
pub(crate) mod inputs;
pub(crate) mod plan;
pub(crate) mod status;
pub(crate) mod tiling_job;
