//! Tests of `adwave`, in one program: each program of its own would be linked with everything again.

mod basis;
mod bump;
mod cloud_normals;
mod common;
mod curves;
mod denoise;
mod density;
mod editor;
mod engine;
mod examples;
mod face_fields;
mod filters;
mod laws;
mod local_fit;
mod polygons;
mod positions;
mod real_steps;
mod reference;
mod regions;
mod saliency_features;
mod seams;
mod sheets;
mod signed_saliency;
mod strays;
mod surface;
