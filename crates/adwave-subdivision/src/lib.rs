//! Subdivision hierarchies of meshes, and wavelets by lifting.
//!
//! A mesh that was made by cutting triangles into four, or polygons into quadrilaterals, has exact coarser levels,
//! which [`Hierarchy`] finds for any order of its vertices and faces. [`LiftedWavelets`] split a field at the vertices
//! into as many coefficients as it has values, with one of the families of [`Family`]; [`HaarWavelets`] do so for a
//! field at the faces. [`LiftedWavelets::new_irregular`] makes levels for any other mesh.
//!
//! | module | content |
//! |---|---|
//! | `topology` | the other side of each edge, and walks around vertices |
//! | `coarsening` | coarse vertices and midpoints of one level |
//! | `quad_coarsening` | the same for quadrilaterals: coarse vertices, edge points and face points |
//! | `quad_levels`, `quad_fit` | all levels of quadrilaterals, and which of several ways the positions fit |
//! | `hierarchy` | all levels, with an order of the vertices in which every coarser level comes first |
//! | `refine`, `weld` | subdivision of triangles and polygons; vertices at equal positions |
//! | `stencils` | rules of linear, butterfly and Loop subdivision |
//! | `quad_stencils` | rules of linear and Catmull–Clark subdivision on quadrilaterals |
//! | `even_solve` | the inverse of the rule that Loop and Catmull–Clark subdivision have for coarse vertices |
//! | `update` | the update of each wavelet by least squares |
//! | `lifting`, `prediction` | steps, analysis and synthesis |
//! | `irregular` | levels of any mesh |
//! | `haar` | wavelets on faces |
//! | `coefficients` | selection of the largest coefficients |
//! | `riesz` | measured stability |

mod coarsening;
mod coefficients;
mod error;
mod even_solve;
mod family;
mod haar;
mod hierarchy;
mod irregular;
mod lifting;
mod prediction;
mod quad_coarsening;
mod quad_fit;
mod quad_levels;
mod quad_stencils;
mod refine;
mod riesz;
mod rows;
mod stencils;
mod topology;
mod update;
mod weld;

pub use coefficients::LiftedCoefficients;
pub use error::{Obstacle, SubdivisionError};
pub use family::Family;
pub use haar::HaarWavelets;
pub use hierarchy::{BorderCorners, Hierarchy, SubdivisionPart, triangles_of};
pub use lifting::LiftedWavelets;
pub use quad_levels::{QuadParams, sharp_edges};
pub use refine::{SubdividedMesh, SubdividedPolygons, subdivide, subdivide_polygons};
pub use riesz::RieszBounds;
pub use weld::WeldedMesh;
