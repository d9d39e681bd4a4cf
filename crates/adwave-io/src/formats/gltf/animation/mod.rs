//! Animations by morph targets: weights over time that move the vertices of a mesh.
//!
//! A vertex p of a mesh with the displacements dₖ of its targets, shown by a node with the transform M, is at
//! M (p + Σₖ wₖ(t) dₖ) at time t. `channels` finds the weights of each node, `sampler` evaluates them between their
//! keys, `read` gives the positions at even times, and `write` stores frames as a GLB with one target per frame.

mod channels;
mod read;
mod sampler;
mod write;

pub use read::ShapeFrames;
pub(crate) use read::frames_of_shape;
pub(crate) use write::{FramesInScene, check_frames, check_size, key_times, write_frames};

/// Number with six digits.
fn rounded_text(x: f64) -> String {
    format!("{x:.5e}").parse::<f64>().map_or_else(|_| x.to_string(), |x| x.to_string())
}
