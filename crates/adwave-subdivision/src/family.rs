//! Families of wavelets by name.

use adwave::named_values;

/// Family of wavelets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Family {
    /// Linear prediction from the ends of an edge (`lounsbery1997`); of the middle of a face from its corners.
    Linear,
    /// Prediction by modified butterfly subdivision (`zorin1996`, `schroder1995`).
    #[default]
    Butterfly,
    /// Loop subdivision; the coarse values are found by solving a linear system (`bertram2004`).
    Loop,
    /// Catmull–Clark subdivision of quadrilaterals (`catmull1978`); the coarse values are found like Loop's.
    CatmullClark,
    /// Haar wavelets on faces, orthonormal for any areas (`bonneau1999`).
    Haar,
    /// Prediction by mean values in the ring of a removed vertex, on any triangle mesh (`daubechies2001`).
    Irregular,
}

named_values!(Family, "family", {
    Linear => "linear", "prediction of a midpoint by the mean of both ends of its edge";
    Butterfly => "butterfly", "prediction by eight vertices, exact for cubic fields on a regular part";
    Loop => "loop", "Loop subdivision; a field that it made has no details";
    CatmullClark => "catmull-clark", "Catmull-Clark subdivision of quadrilaterals; a field that it made has no details";
    Haar => "haar", "one value per face, orthonormal for any areas of the faces";
    Irregular => "irregular", "prediction from the ring of a removed vertex, for any mesh of triangles";
});
