//! Wavelets for shapes. The crate splits the geometry of a mesh, a point cloud or a graph, or any signal on it,
//! into bands from fine to coarse, each local in space and in frequency. The bands can be measured and edited, and
//! their sum is the shape again without loss. The method is that of Hou & Qin, *Admissible Diffusion Wavelets*
//! (`houqin2013`); equation numbers refer to the paper.
//!
//! | concept | module or type | equation |
//! |---|---|---|
//! | shape, welded, triangulated and numbered for the analysis | [`shape`]: [`Shape`](shape::Shape),
//! [`PreparedGeometry`](shape::PreparedGeometry) | |
//! | affinity of neighbors: the local operator T | [`operator::local_operator`] | (eq. 1) (eq. 2) |
//! | one diffusion step, Φ₁ = \[T\]_r, and its stationary distribution | [`operator::Diffusion`] | (eq. 4) (eq. 5)
//! (eq. 10) |
//! | heat on the surface instead of that walk, for bands independent of the mesh | [`operator::surface_diffusion`],
//! [`laplacian`] | |
//! | images and volumes, with heat of any width at one cost | [`grid`] | |
//! | n steps by √n products with Φ₁ | [`sparse`], [`bands::Transform`] | |
//! | levels and their numbers of steps | [`bands::Schedule`] | |
//! | scaling functions and wavelets as matrices, Φ_j and Ψ_j | [`basis`](mod@basis) | (eq. 3) (eq. 6) to (eq. 9), Algorithm 1 |
//! | bands of a signal, W_f(j) = S_f(j−1) − S_f(j), and reconstruction | [`bands`], [`BandsRequest`] | (eq. 11)
//! (eq. 15) |
//! | filters: gains per band and region | [`filter`], [`region`], [`Editor`] | (eq. 18) |
//! | slopes kept: bands of a field about a local linear fit | [`local_fit`] | |
//! | positions after a filter: borders and volume kept | [`positions`] | |
//! | denoising of a shape or a signal by the least estimated risk | [`denoise`](mod@denoise) | |
//! | tangent vectors, lines and crosses, and symmetric tensors on a surface | [`directions`] | |
//! | saliency maps, and features with sizes | [`saliency`](mod@saliency), [`features`] | (eq. 17), Algorithm 2 |
//! | signals derived from the shape; vertices without a value | [`signal`], [`mask`] | |
//!
//! A [`Decomposer`] is a shape prepared for repeated use; [`Decomposer::request`] starts a request. From file to
//! file, with the crate `adwave-io`:
//!
//! ```
//! use adwave::bands::Schedule;
//! use adwave::filter::{Preset, WeightedLayer};
//! use adwave::Decomposer;
//! use adwave_io::{ReadLimits, read_path, write_path};
//! # let folder = std::env::temp_dir().join(format!("adwave-front-door-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! # let (rough, smooth) = (folder.join("rough.obj"), folder.join("smooth.obj"));
//! # std::fs::write(&rough, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 9\nf 1 2 3\nf 2 4 3\n")?;
//!
//! let mut file = read_path(&rough, &ReadLimits::default())?;
//! let decomposer = Decomposer::new(&file.to_shape()?);
//! let schedule = Schedule::dyadic(4)?;
//! let layer = WeightedLayer::everywhere(Preset::Suppress.gains(schedule.n_levels()));
//! let points = decomposer.request(file.points().as_flattened(), 3, &schedule).filter_layers(&[layer])?;
//! file.set_points(points.as_chunks().0.to_vec())?;
//! write_path(&file, &smooth, None)?;
//! # assert!(read_path(&smooth, &ReadLimits::default())?.points()[3][2] < 4.0);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Long calls take a [`Progress`] that reports and cancels them. Every error has an [`ErrorKind`]. The same input
//! gives the same bits on any number of threads, and the library prints nothing.

pub mod bands;
pub mod basis;
mod bessel;
mod decomposer;
pub mod denoise;
pub mod directions;
pub mod domain;
mod editor;
mod error;
pub mod features;
pub mod filter;
pub mod grid;
pub mod laplacian;
pub mod local_fit;
pub mod mask;
pub mod measure;
mod named;
pub mod operator;
#[doc(hidden)]
pub mod pages;
mod parallel;
mod population;
pub mod positions;
mod progress;
pub mod region;
pub mod rows;
pub mod saliency;
pub mod sample;
pub mod shape;
pub mod signal;
pub mod sparse;
pub mod time;
pub mod vector;

pub use decomposer::{
    BandsRequest, Decomposer, LevelSpec, LevelSpecError, ResolvedLevels, SpectralSeries, VertexFunctions,
};
pub use editor::{ChangedVertices, EditBits, Editor, MANY_CHANNELS};
pub use error::{ClassifiedError, ErrorKind};
pub use named::{NamedEntry, NamedValue, UnknownName};
pub use progress::{BackgroundWork, Cancelled, Progress, ProgressCounter};
