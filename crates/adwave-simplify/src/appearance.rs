//! Seams, colors, texture coordinates and importance of a mesh, which a simplification respects in addition to the
//! shape.

/// Appearance of a mesh in addition to its shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct Appearance<'a> {
    /// One label per corner of the faces. Corners at one position with different labels lie on opposite sides of a seam
    /// (of a texture, of two materials).
    pub labels: Option<&'a [u32]>,
    /// Colors or texture coordinates, `n_channels` values per corner of the faces, with 1 as the full range.
    pub values: Option<AppearanceValues<'a>>,
    /// Importance of each vertex; the sign of a weight, as of a signed saliency map, does not count. Squared distances
    /// are multiplied by the magnitude, so that one half of a shape with weights of 4 keeps details half as deep as the
    /// other half with weights of 1.
    pub weights: Option<&'a [f64]>,
}

/// Values at the corners of faces, row by row.
#[derive(Clone, Copy, Debug)]
pub struct AppearanceValues<'a> {
    /// Values row by row: `n_channels` values for each corner.
    pub values: &'a [f64],
    /// Number of values per corner.
    pub n_channels: usize,
}
