//! Domains: whatever carries a signal, below everything that computes on it.
//!
//! A [`Domain`] states its places, their measure and the distances between them; an
//! [`Operator`](crate::operator::Operator) diffuses over the same places. Bands, filters, regions, saliency, features
//! and the denoising of signals ask for nothing else, so a domain that stores no rows, such as a grid, has all of them.
//! [`ShapeDomain`] is that of a mesh, a cloud or a graph, [`WalkDomain`] that of a walk given by its rows.

mod shape;
mod walk;

pub use shape::ShapeDomain;
pub use walk::WalkDomain;

use crate::local_fit::LocalFit;
use crate::shape::{Adjacency, PreparedGeometry, VertexMap, squared_distance};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress};
use std::any::Any;
use std::borrow::Cow;
use std::fmt::Debug;
use std::sync::OnceLock;
use thiserror::Error;

/// Places that carry a signal, in the order of the rows of an operator.
///
/// Two functions suffice: the map of the places, and their neighbors, if the operator has no rows that state them. All
/// other functions are optional: a domain without positions has no balls, and on one without a border nothing fades.
///
/// ```
/// use adwave::bands::Schedule;
/// use adwave::domain::Domain;
/// use adwave::operator::RowFunction;
/// use adwave::shape::{Adjacency, VertexMap};
/// use adwave::{Cancelled, Decomposer, Progress};
/// use std::borrow::Cow;
///
/// /// A ring of places, one after another.
/// #[derive(Debug)]
/// struct Ring(VertexMap);
///
/// impl Domain for Ring {
///     fn vertex_map(&self) -> &VertexMap {
///         &self.0
///     }
///
///     fn neighbors(&self, _: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
///         let n = self.0.n_welded() as u32;
///         let around = (0..n).flat_map(|x| { let mut row = [(x + n - 1) % n, (x + 1) % n]; row.sort(); row });
///         let offsets = (0..=n as usize).map(|x| 2 * x).collect();
///         Ok(Some(Cow::Owned(Adjacency::new(offsets, around.collect(), n as usize).expect("two neighbors each"))))
///     }
/// }
///
/// let n = 64;
/// let step = RowFunction::new(n, move |x| [((x + n - 1) % n, 0.25), ((x + 1) % n, 0.25)])?;
/// let ring = Decomposer::from_domain(Ring(VertexMap::identity(n)), step)?;
/// let wave: Vec<f64> = (0..n).map(|i| (std::f64::consts::TAU * i as f64 / n as f64).cos()).collect();
/// let bands = ring.decompose(&wave, 1, &Schedule::dyadic(1)?)?;
/// let lambda = (std::f64::consts::PI / n as f64).cos().powi(2); // its eigenvalue
/// assert!((bands.coarsest()[0] - lambda).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Domain: Any + Debug + Send + Sync {
    /// Map from the places in the caller's order to the rows of the operator; the identity for a grid.
    fn vertex_map(&self) -> &VertexMap;

    /// Measure of each place, at least 0: areas in squared model units, volumes, or lengths along a curve; `None` if it
    /// is 1 everywhere.
    fn measure(&self) -> Option<&[f64]> {
        None
    }

    /// Mean distance of neighboring places along each axis of the domain, in the unit of that axis: one number for a
    /// shape, two for a product with time.
    fn spacings(&self) -> &[f64] {
        &[1.0]
    }

    /// Positions of the places in model units; empty if they have none.
    fn positions(&self) -> &[[f64; 3]] {
        &[]
    }

    /// Length of [`positions`](Self::positions), for a domain that computes them on demand.
    fn n_positions(&self) -> usize {
        self.positions().len()
    }

    /// Size in model units, without the flagged places, from which default levels and lengths in percent follow; 0
    /// without positions.
    fn extent(&self, _masked: Option<&[bool]>) -> f64 {
        crate::shape::diagonal(self.positions())
    }

    /// Diagonal of the bounding box of all places, in model units; 0 without positions.
    fn diagonal(&self) -> f64 {
        crate::shape::diagonal(self.positions())
    }

    /// Neighbors of each place in ascending order, or `None` if the neighbors are the places between which the operator
    /// has entries. The caller stores the result.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn neighbors(&self, _progress: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        Ok(None)
    }

    /// True if [`neighbors`](Self::neighbors) returns neighbors.
    fn has_neighbors(&self) -> bool {
        true
    }

    /// Neighbors among which features and normals look, if these are closer than the neighbors of a step.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn one_ring(&self, _progress: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        Ok(None)
    }

    /// Number of rings of neighbors from which a feature must stand out.
    fn feature_rings(&self) -> usize {
        2
    }

    /// Squared distance of two neighboring places in squared model units; 1 without positions.
    fn squared_length(&self, x: usize, y: usize) -> f64 {
        match self.positions() {
            [] => 1.0,
            points => squared_distance(&points[x], &points[y]),
        }
    }

    /// Flags of the places that take no part and keep their values; `None` if all take part.
    fn outsiders(&self) -> Option<Vec<bool>> {
        None
    }

    /// The places on the border, and those next to masked ones, in ascending order. `neighbors` are those of a step
    /// between places that are not masked.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn border(
        &self,
        _neighbors: &Adjacency,
        masked: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Vec<usize>, Cancelled> {
        Ok(match (masked, self.neighbors(progress)?) {
            (Some(masked), Some(all)) => next_to_masked(&all, masked).collect(),
            _ => Vec::new(),
        })
    }

    /// Distance of each place from the nearest place of the [`border`](Self::border) along the domain, in model units,
    /// infinite beyond `radius`; `None` if the caller has to search for it from neighbor to neighbor.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    fn border_distances(
        &self,
        _masked: Option<&[bool]>,
        _radius: f64,
        _progress: Progress<'_>,
    ) -> Result<Option<Vec<f64>>, Cancelled> {
        Ok(None)
    }

    /// True if the places may fill a volume, and need not lie on a surface.
    fn may_fill_volume(&self) -> bool {
        false
    }

    /// Local fit that smoothing a field about `asked` has on this domain: a constant one if slopes cause no bias.
    fn local_fit(&self, asked: LocalFit) -> LocalFit {
        if self.n_positions() == 0 { LocalFit::Constant } else { asked }
    }

    /// The prepared mesh, cloud or graph, for faces, normals and volumes, which only shapes have.
    fn geometry(&self) -> Option<&PreparedGeometry> {
        None
    }
}

/// The neighbors that a domain states, without the flagged places; `None` if they are those of its operator. They are
/// listed once, in `listed`.
pub(crate) fn stated_neighbors<'a>(
    domain: &dyn Domain,
    masked: Option<&[bool]>,
    listed: &'a OnceLock<Adjacency>,
    progress: Progress<'_>,
) -> Result<Option<&'a Adjacency>, Cancelled> {
    if !domain.has_neighbors() {
        return Ok(None);
    }
    if let Some(neighbors) = listed.get() {
        return Ok(Some(neighbors));
    }
    let Some(stated) = domain.neighbors(progress)? else { return Ok(None) };
    let stated = without_masked(stated, masked, progress)?;
    Ok(Some(listed.get_or_init(|| stated)))
}

/// Neighbors without the flagged places.
pub(crate) fn without_masked(
    neighbors: Cow<'_, Adjacency>,
    masked: Option<&[bool]>,
    progress: Progress<'_>,
) -> Result<Adjacency, Cancelled> {
    match masked {
        Some(masked) => neighbors.remove_masked(masked, progress),
        None => Ok(neighbors.into_owned()),
    }
}

/// Places that are not masked and have a masked neighbor, in ascending order.
fn next_to_masked<'a>(neighbors: &'a Adjacency, masked: &'a [bool]) -> impl Iterator<Item = usize> + 'a {
    let is_masked = |y: &u32| masked[*y as usize];
    (0..masked.len()).filter(move |&x| !masked[x] && neighbors.row(x).iter().any(is_masked))
}

/// Error of joining a domain and an operator that do not fit together.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DomainError {
    /// The number of rows of the operator differs from the number of places of the domain.
    #[error("an operator has one row for each place, got {n_rows} rows for {n_places} places")]
    RowCount {
        /// Rows of the operator.
        n_rows: usize,
        /// Places of the domain.
        n_places: usize,
    },
    /// The number of values does not match the number of places.
    #[error("{what} must have one entry for each of the {n_places} places, got {n_found}")]
    Length {
        /// Name of the values.
        what: &'static str,
        /// Number of entries found.
        n_found: usize,
        /// Places of the domain.
        n_places: usize,
    },
    /// Neither the domain nor the operator states which places are neighbors.
    #[error(
        "neither the domain (`Domain::neighbors`) nor the operator (`Operator::rows`) tells which places are neighbors; give one of them"
    )]
    NoNeighbors,
    /// Domains that cannot be one.
    #[error("domains cannot be joined: {reason}")]
    Union {
        /// Reason.
        reason: &'static str,
    },
    /// Places that cannot be a domain of their own.
    #[error("some places of a domain cannot be a domain of their own: {reason}")]
    Part {
        /// Reason.
        reason: &'static str,
    },
    /// The operator has no rows, which the method needs.
    #[error(transparent)]
    NoRows(#[from] crate::operator::NoRows),
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The operator does not keep its promises.
    #[error(transparent)]
    Operator(#[from] crate::bands::BandsError),
}

impl ClassifiedError for DomainError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Operator(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}
