//! Colors and texture coordinates on a mesh, as part of the error.

/// Appearance of a mesh beside its shape.
#[derive(Clone, Copy, Debug, Default)]
pub struct Appearance<'a> {
    /// One value per corner of the faces. Corners at one position with different labels lie on opposite sides of a seam (of
    /// a texture, of two materials).
    pub labels: Option<&'a [u32]>,
    /// Colors or texture coordinates, `n_channels` values per corner of the faces, for which 1 is the full range.
    pub values: Option<AppearanceValues<'a>>,
}

/// Values at the corners of faces, row by row.
#[derive(Clone, Copy, Debug)]
pub struct AppearanceValues<'a> {
    /// `n_channels` values for each corner.
    pub values: &'a [f64],
    /// Number of values per corner.
    pub n_channels: usize,
}
