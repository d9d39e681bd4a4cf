//! Grids: images and volumes, which carry the same bands as shapes.
//!
//! A [`Grid`] has one, two or three axes, each with a size, a spacing and a border that reflects or repeats, and may have
//! places without data. [`GridHeat`] is heat on it, `exp(−tL)` with the second differences L along the axes: it keeps
//! constants, sums and, to the accuracy asked, the range of a signal, for any width. Without places left out it is
//! separable and takes any number of steps at once; with them it is a stencil whose steps never leave the data, so that
//! no value crosses a mask.
//!
//! ```
//! use adwave::Decomposer;
//! use adwave::bands::Schedule;
//! use adwave::grid::Grid;
//! // An image of 48 rows and 64 columns, half a millimeter apart.
//! let grid = Grid::new(&[48, 64], &[0.5, 0.5])?;
//! let image: Vec<f64> = (0..48 * 64).map(|i| (0.2 * (i % 64) as f64).sin() + (i / 64) as f64).collect();
//! let decomposer = Decomposer::from_domain(grid.clone(), grid.heat())?;
//! let bands = decomposer.decompose(&image, 1, &Schedule::lengths(&[1.0, 2.0, 4.0], 0.5)?)?;
//! let sum = bands.reconstruct();
//! assert!(image.iter().zip(&sum).all(|(a, b)| (a - b).abs() < 1e-12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod distance;
mod heat;
pub(crate) mod lines;
mod places;
mod poles;
mod runs;
mod steps;
mod taps;

pub use heat::GridHeat;
pub(crate) use places::{NoiseMeasure, NoisePatches};

use crate::domain::Domain;
use crate::shape::{Adjacency, VertexMap, squared_distance};
use crate::{Cancelled, ClassifiedError, ErrorKind, Progress, parallel};
use std::any::Any;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};
use thiserror::Error;

/// Largest number of axes.
pub const MAX_AXES: usize = 3;

/// Error of describing a grid.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// The number of axes is not 1, 2 or 3, or differs from that of another argument.
    #[error("a grid has 1 to 3 axes, with one {what} each, got {n_sizes} sizes and {n_found}")]
    Axes {
        /// Name of the other argument, in the singular.
        what: &'static str,
        /// Number of sizes.
        n_sizes: usize,
        /// Number of values of the other argument.
        n_found: usize,
    },
    /// A size is 0, or there are more places than indices of 32 bits.
    #[error("the sizes of a grid must be at least 1, with fewer than 2³² places in all, got {sizes:?}")]
    Sizes {
        /// The sizes.
        sizes: Vec<usize>,
    },
    /// A spacing is not a positive number.
    #[error("spacing must be a finite number above 0 along each axis, got {spacing} along axis {axis}")]
    Spacing {
        /// Axis, from 0.
        axis: usize,
        /// The spacing.
        spacing: f64,
    },
    /// The mask does not fit, or leaves out every place.
    #[error(
        "a mask has one flag for each of the {n_places} places, at least one of them kept, got {n_flags} flags and {n_kept} kept"
    )]
    Mask {
        /// Places of the grid.
        n_places: usize,
        /// Flags.
        n_flags: usize,
        /// Places that the flags keep.
        n_kept: usize,
    },
}

impl ClassifiedError for GridError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Places of an image or a volume, in the order of its values: the last axis is contiguous. The place (i, j, k) is at
/// (i, j, k) times the spacings, unless [`with_frame`](Self::with_frame) puts it elsewhere.
#[derive(Clone, Debug)]
pub struct Grid {
    axes: Axes,
    map: VertexMap,
    /// Places that belong to the data; all if `None`.
    kept: Option<Arc<[bool]>>,
    frame: AxesInSpace,
    positions: OnceLock<Vec<[f64; 3]>>,
    spacing: [f64; 1],
}

/// Place of the axes in space.
#[derive(Clone, Debug, PartialEq)]
struct AxesInSpace {
    /// Position of the first place.
    origin: [f64; 3],
    /// Step of each axis.
    steps: Vec<[f64; 3]>,
}

/// Sizes, spacings and borders of the axes.
#[derive(Clone, Debug, PartialEq)]
struct Axes {
    sizes: Vec<usize>,
    spacings: Vec<f64>,
    is_periodic: Vec<bool>,
}

impl Axes {
    fn n_places(&self) -> usize {
        self.sizes.iter().product()
    }

    /// Distance along `axis` between places in the order of the values.
    fn stride(&self, axis: usize) -> usize {
        self.sizes[axis + 1..].iter().product()
    }

    /// Axes with more than one place: the others carry no difference.
    fn long(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.sizes.len()).filter(|&axis| self.sizes[axis] > 1)
    }

    /// Smallest spacing of an axis with more than one place, in model units.
    fn finest(&self) -> f64 {
        let finest = self.long().map(|axis| self.spacings[axis]).fold(f64::INFINITY, f64::min);
        if finest.is_finite() { finest } else { self.spacings[0] }
    }

    /// The places before and after a place along `axis`, given its coordinate on that axis; `None` beyond a border that
    /// reflects.
    fn sides(&self, axis: usize, place: usize, at: usize) -> [Option<usize>; 2] {
        let (n, stride) = (self.sizes[axis], self.stride(axis));
        let wraps = self.is_periodic[axis];
        let before = if at > 0 { Some(place - stride) } else { wraps.then(|| place + (n - 1) * stride) };
        let after = if at + 1 < n { Some(place + stride) } else { wraps.then(|| place - (n - 1) * stride) };
        if n > 1 { [before, after] } else { [None, None] }
    }

    /// Coordinate of a place along `axis`.
    fn coordinate(&self, axis: usize, place: usize) -> usize {
        place / self.stride(axis) % self.sizes[axis]
    }
}

impl Grid {
    /// The grid with these sizes and spacings (model units) of its axes, whose borders reflect.
    ///
    /// # Errors
    /// [`GridError`] unless there are 1 to 3 sizes of at least 1 with a positive spacing each, and fewer than 2³² places.
    pub fn new(sizes: &[usize], spacings: &[f64]) -> Result<Self, GridError> {
        if sizes.is_empty() || sizes.len() > MAX_AXES || spacings.len() != sizes.len() {
            return Err(GridError::Axes { what: "spacing", n_sizes: sizes.len(), n_found: spacings.len() });
        }
        let n_places = sizes.iter().try_fold(1_usize, |n, size| n.checked_mul(*size));
        if n_places.is_none_or(|n| n == 0 || n >= u32::MAX as usize) {
            return Err(GridError::Sizes { sizes: sizes.to_vec() });
        }
        if let Some(axis) = spacings.iter().position(|h| !(h.is_normal() && *h > 0.0)) {
            return Err(GridError::Spacing { axis, spacing: spacings[axis] });
        }
        let is_periodic = vec![false; sizes.len()];
        let axes = Axes { sizes: sizes.to_vec(), spacings: spacings.to_vec(), is_periodic };
        let (map, spacing) = (VertexMap::identity(axes.n_places()), [axes.finest()]);
        let step = |axis: usize| std::array::from_fn(|c| if c == axis { axes.spacings[axis] } else { 0.0 });
        let frame = AxesInSpace { origin: [0.0; 3], steps: (0..sizes.len()).map(step).collect() };
        Ok(Self { axes, map, kept: None, frame, positions: OnceLock::new(), spacing })
    }

    /// This grid with axes that repeat where the flag is set, as angles do.
    ///
    /// # Errors
    /// [`GridError`] unless there is one flag for each axis.
    pub fn with_periodic(mut self, is_periodic: &[bool]) -> Result<Self, GridError> {
        let n_sizes = self.axes.sizes.len();
        if is_periodic.len() != n_sizes {
            return Err(GridError::Axes { what: "flag", n_sizes, n_found: is_periodic.len() });
        }
        self.axes.is_periodic = is_periodic.to_vec();
        Ok(self)
    }

    /// This grid with its first place at `origin` and a step of each axis in space, for positions of features and
    /// regions. Spacings stay: heat takes the axes as orthogonal.
    ///
    /// # Errors
    /// [`GridError`] unless there is one step for each axis.
    pub fn with_frame(mut self, origin: [f64; 3], steps: &[[f64; 3]]) -> Result<Self, GridError> {
        let n_sizes = self.axes.sizes.len();
        if steps.len() != n_sizes {
            return Err(GridError::Axes { what: "step", n_sizes, n_found: steps.len() });
        }
        self.frame = AxesInSpace { origin, steps: steps.to_vec() };
        self.positions = OnceLock::new();
        Ok(self)
    }

    /// This grid with data only where `kept` is true. The other places keep their values, and no step reaches or leaves
    /// them.
    ///
    /// # Errors
    /// [`GridError`] unless there is one flag for each place, at least one of them true.
    pub fn with_kept(mut self, kept: Vec<bool>) -> Result<Self, GridError> {
        let (n_places, n_kept) = (self.axes.n_places(), kept.iter().filter(|kept| **kept).count());
        if kept.len() != n_places || n_kept == 0 {
            return Err(GridError::Mask { n_places, n_flags: kept.len(), n_kept });
        }
        self.kept = (n_kept < n_places).then(|| kept.into());
        Ok(self)
    }

    /// The grid that a domain is; `None` if it is no grid.
    pub fn from_domain(domain: &dyn Domain) -> Option<&Self> {
        (domain as &dyn Any).downcast_ref()
    }

    /// Sizes of the axes.
    pub fn sizes(&self) -> &[usize] {
        &self.axes.sizes
    }

    /// Number of places.
    pub fn n_places(&self) -> usize {
        self.axes.n_places()
    }

    /// Heat on this grid. One step has σ = the smallest spacing, with variance σ²/2 along each axis.
    pub fn heat(&self) -> GridHeat {
        GridHeat::new(self.axes.clone(), self.kept.clone())
    }

    fn is_kept(&self, place: usize) -> bool {
        self.kept.as_ref().is_none_or(|kept| kept[place])
    }

    /// True if a place has data and is not masked.
    fn is_part(&self, place: usize, masked: Option<&[bool]>) -> bool {
        self.is_kept(place) && masked.is_none_or(|masked| !masked[place])
    }

    /// True for a place with data at a border that reflects or next to a place that is left out.
    fn is_border(&self, place: usize, masked: Option<&[bool]>) -> bool {
        let is_end = |axis: usize| {
            let sides = self.axes.sides(axis, place, self.axes.coordinate(axis, place));
            sides.iter().any(|side| side.is_none_or(|other| !self.is_part(other, masked)))
        };
        self.is_part(place, masked) && self.axes.long().any(is_end)
    }

    /// The neighbors of a place along the axes.
    pub(crate) fn sides(&self, place: usize) -> impl Iterator<Item = usize> + '_ {
        let all = (0..self.axes.sizes.len())
            .flat_map(move |axis| self.axes.sides(axis, place, self.axes.coordinate(axis, place)))
            .flatten();
        all.filter(move |&other| other != place && self.is_kept(place) && self.is_kept(other))
    }
}

impl Domain for Grid {
    fn vertex_map(&self) -> &VertexMap {
        &self.map
    }

    fn spacings(&self) -> &[f64] {
        &self.spacing
    }

    fn positions(&self) -> &[[f64; 3]] {
        if let Some(positions) = self.positions.get() {
            return positions;
        }
        // Not inside the closure: a thread that waits there for others could take over work that asks for the positions.
        // If two threads arrive here at once, one of them works in vain.
        let positions = parallel::collect(self.n_places(), |place| self.position_at(self.coordinates(place)));
        self.positions.get_or_init(|| positions)
    }

    fn n_positions(&self) -> usize {
        self.n_places()
    }

    fn extent(&self, masked: Option<&[bool]>) -> f64 {
        /// Rows along the last axis that a thread looks at at a time.
        const ROWS_AT_A_TIME: usize = 64;
        if self.kept.is_none() && masked.is_none() {
            return self.diagonal();
        }
        let (last, n_axes) = (self.axes.sizes.len() - 1, self.axes.sizes.len());
        let row_len = self.axes.sizes[last];
        let none = [(usize::MAX, 0); MAX_AXES];
        let join = |a: [(usize, usize); MAX_AXES], b: [(usize, usize); MAX_AXES]| {
            std::array::from_fn(|axis| (a[axis].0.min(b[axis].0), a[axis].1.max(b[axis].1)))
        };
        let of_row = |row: usize| {
            let (first, mut places) = (row * row_len, row * row_len..(row + 1) * row_len);
            let Some(low) = places.clone().find(|&place| self.is_part(place, masked)) else { return none };
            let high = places.rfind(|&place| self.is_part(place, masked)).unwrap_or(low);
            std::array::from_fn(|axis| match axis {
                axis if axis < last => (self.axes.coordinate(axis, first), self.axes.coordinate(axis, first)),
                axis if axis == last => (low - first, high - first),
                _ => (0, 0),
            })
        };
        let parts = parallel::map_chunks(self.n_places() / row_len, ROWS_AT_A_TIME, |rows| {
            rows.map(of_row).fold(none, join)
        });
        let bounds = parts.into_iter().fold(none, join);
        let square = |axis: usize| {
            let (low, high) = bounds[axis];
            (high.saturating_sub(low) as f64 * self.axes.spacings[axis]).powi(2)
        };
        (0..n_axes).map(square).sum::<f64>().sqrt()
    }

    fn diagonal(&self) -> f64 {
        let Axes { sizes, spacings, .. } = &self.axes;
        sizes.iter().zip(spacings).map(|(n, h)| ((n - 1) as f64 * h).powi(2)).sum::<f64>().sqrt()
    }

    fn neighbors(&self, progress: Progress<'_>) -> Result<Option<Cow<'_, Adjacency>>, Cancelled> {
        let listed = |(): &mut (), place: usize, others: &mut Vec<u32>| {
            others.extend(self.sides(place).map(|other| other as u32));
        };
        Adjacency::from_neighbors(self.n_places(), progress, || (), listed)
            .map(|listed| Some(Cow::Owned(listed)))
    }

    fn outsiders(&self) -> Option<Vec<bool>> {
        self.kept.as_ref().map(|kept| kept.iter().map(|kept| !kept).collect())
    }

    fn border(
        &self,
        _: &Adjacency,
        masked: Option<&[bool]>,
        progress: Progress<'_>,
    ) -> Result<Vec<usize>, Cancelled> {
        progress.check()?;
        Ok((0..self.n_places()).filter(|&place| self.is_border(place, masked)).collect())
    }

    fn border_distances(
        &self,
        masked: Option<&[bool]>,
        radius: f64,
        progress: Progress<'_>,
    ) -> Result<Option<Vec<f64>>, Cancelled> {
        Self::border_distances(self, masked, radius, progress).map(Some)
    }

    fn squared_length(&self, x: usize, y: usize) -> f64 {
        let (at, other) = (self.position_at(self.coordinates(x)), self.position_at(self.coordinates(y)));
        squared_distance(&at, &other)
    }

    fn may_fill_volume(&self) -> bool {
        self.axes.long().count() == MAX_AXES
    }
}
