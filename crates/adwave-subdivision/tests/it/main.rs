//! Laws of hierarchies and of wavelets by lifting, on made meshes and on real ones.

mod bad_input;
mod common;
mod families;
mod hierarchy;
mod irregular;
mod quads;
mod real;
