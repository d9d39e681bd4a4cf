//! Parameters of a deformation, and facts about it.

/// Parameters of a deformation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct DeformParams {
    /// Bending length in model units: rotations vary over at least about this length. The distance of the nodes if
    /// `None`; 0 lets thin shapes wrinkle.
    pub stiffness: Option<f64>,
    /// Share t of lengths in \[0, 1\]: 0 keeps the detail in turning frames, 1 keeps the lengths of edges, and values
    /// between weigh one against the other. [`Deformer::solve`](crate::Deformer::solve) then moves each vertex, at a cost that grows with their
    /// number; [`Deformer::step`](crate::Deformer::step) shows the shape for 0.
    pub keep_lengths: f64,
}

impl DeformParams {
    /// Sets [`stiffness`](Self::stiffness).
    #[must_use]
    pub fn with_stiffness(self, stiffness: Option<f64>) -> Self {
        Self { stiffness, ..self }
    }

    /// Sets [`keep_lengths`](Self::keep_lengths).
    #[must_use]
    pub fn with_keep_lengths(self, keep_lengths: f64) -> Self {
        Self { keep_lengths, ..self }
    }
}

/// Result of a step or a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeformInfo {
    /// Number of Newton steps.
    pub n_steps: usize,
    /// Number of products with the Hessian.
    pub n_products: usize,
    /// Energy before the first step, without unit; the rest shape has 0.
    pub energy_before: f64,
    /// Energy after the last step.
    pub energy_after: f64,
    /// Number of steps that keep lengths; 0 if [`DeformParams::keep_lengths`] is 0.
    pub n_length_steps: usize,
    /// True if the energy no longer falls.
    pub is_converged: bool,
}

/// Facts about a bound deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BindInfo {
    /// Number of nodes.
    pub n_nodes: usize,
    /// Number of samples of the coarse shape over which the energy is summed.
    pub n_samples: usize,
    /// Width σ_J of the coarse shape in model units.
    pub sigma: f64,
    /// Distance of the nodes in model units.
    pub spacing: f64,
    /// Bending length in model units.
    pub stiffness: f64,
    /// Number of connected parts without a region, which follow the nearest part that has one.
    pub n_following_parts: usize,
    /// Vertices of those parts.
    pub n_following_vertices: usize,
    /// True if nothing is held: the shape then follows its handles as a whole.
    pub is_free: bool,
}
