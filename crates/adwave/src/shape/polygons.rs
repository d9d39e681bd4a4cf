//! Faces of a mesh as lists of corners, any number of corners a face.

/// The faces of a mesh: face `f` has the corners `corners[offsets[f]..offsets[f + 1]]`, each a vertex index.
///
/// Nothing is checked here; [`Mesh::new`](crate::shape::Mesh::new) checks that every corner names a vertex.
///
/// ```
/// use adwave::shape::Polygons;
/// let mut faces = Polygons::from_triangles(&[[0, 1, 2]]);
/// faces.push(&[0, 2, 3, 4]);
/// assert_eq!(faces.len(), 2);
/// assert_eq!(faces.get(1), [0, 2, 3, 4]);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Polygons {
    offsets: Vec<u32>,
    corners: Vec<u32>,
}

impl Default for Polygons {
    fn default() -> Self {
        Self::new()
    }
}

impl Polygons {
    /// No faces.
    pub fn new() -> Self {
        Self { offsets: vec![0], corners: Vec::new() }
    }

    /// No faces, with room for `n_faces` faces of `n_corners` corners in total.
    pub fn with_capacity(n_faces: usize, n_corners: usize) -> Self {
        let mut offsets = Vec::with_capacity(n_faces + 1);
        offsets.push(0);
        Self { offsets, corners: Vec::with_capacity(n_corners) }
    }

    /// One face for each triangle.
    pub fn from_triangles(triangles: &[[u32; 3]]) -> Self {
        let n = u32::try_from(triangles.len()).expect("at most 2^32/3 triangles");
        Self { offsets: (0..=n).map(|f| 3 * f).collect(), corners: triangles.as_flattened().to_vec() }
    }

    /// Faces from their two lists, without a copy: face `f` has the corners `corners[offsets[f]..offsets[f + 1]]`. Nothing
    /// where the offsets do not begin at 0, grow, and end at the number of corners.
    ///
    /// ```
    /// use adwave::shape::Polygons;
    /// let faces = Polygons::from_parts(vec![0, 3, 5], vec![0, 1, 2, 2, 3]).unwrap();
    /// assert_eq!(faces.get(1), [2, 3]);
    /// assert_eq!(faces.into_parts(), (vec![0, 3, 5], vec![0, 1, 2, 2, 3]));
    /// assert!(Polygons::from_parts(vec![0, 3], vec![0, 1]).is_none());
    /// ```
    pub fn from_parts(offsets: Vec<u32>, corners: Vec<u32>) -> Option<Self> {
        let ends = (offsets.first().copied(), offsets.last().map(|&end| end as usize));
        (ends == (Some(0), Some(corners.len())) && offsets.is_sorted()).then_some(Self { offsets, corners })
    }

    /// The offsets and the corners, without a copy; see [`from_parts`](Self::from_parts).
    pub fn into_parts(self) -> (Vec<u32>, Vec<u32>) {
        (self.offsets, self.corners)
    }

    /// Adds a face at the end.
    ///
    /// # Panics
    /// When the faces have 2³² corners or more in total.
    pub fn push(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.offsets.push(u32::try_from(self.corners.len()).expect("fewer than 2^32 corners"));
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The corners of face `f`, vertex indices in the file's order.
    pub fn get(&self, f: usize) -> &[u32] {
        &self.corners[self.offsets[f] as usize..self.offsets[f + 1] as usize]
    }

    /// The faces in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + '_ {
        self.offsets.windows(2).map(|w| &self.corners[w[0] as usize..w[1] as usize])
    }

    /// All corners of all faces, one after the other.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Where each face starts in [`corners`](Self::corners), and the end of the last: `len() + 1` numbers.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }
}

impl<'a> FromIterator<&'a [u32]> for Polygons {
    fn from_iter<I: IntoIterator<Item = &'a [u32]>>(faces: I) -> Self {
        let mut polygons = Self::new();
        for face in faces {
            polygons.push(face);
        }
        polygons
    }
}
