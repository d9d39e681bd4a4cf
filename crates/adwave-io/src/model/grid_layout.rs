//! Places of an image or a volume in a file: sizes, spacings, axes and position.

use adwave::grid::{Grid, GridError, MAX_AXES};
use std::sync::Arc;

use crate::model::units::LengthUnit;
use crate::{Edges, ShapeFile, ShapeFileError, ValueType};

/// Name of the vertex field with the values of a grid.
pub const GRID_VALUES: &str = "values";

/// Cosine up to which axes count as at right angles: rounding of 32-bit floats in a matrix, ten times over.
const RIGHT_ANGLE: f64 = 1e-5;

/// Greatest distance between corners of two grids that count as the same, in spacings: headers round affine matrices to
/// 32-bit floats.
const SAME_PLACE: f64 = 0.1;

/// Sizes, spacings and position of the axes of an image or a volume.
///
/// ```
/// use adwave_io::{Field, FieldValues, Format, GridLayout, ReadLimits, ShapeFile, read_bytes, write_bytes};
/// let mut image = ShapeFile::from_grid(GridLayout::new(&[2, 3], &[0.5, 0.25]))?;
/// image.add_vertex_field(Field::new("values", 1, FieldValues::F32(vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0])))?;
/// let mut bytes = Vec::new();
/// write_bytes(&image, Format::NIFTI, &mut bytes).unwrap();
/// let again = read_bytes(bytes, Some("a.nii"), &ReadLimits::default()).unwrap();
/// assert_eq!(again.grid().unwrap().sizes, [2, 3]);
/// assert_eq!(again.grid().unwrap().spacings, [0.5, 0.25]);
/// assert_eq!(again.field("values"), image.field("values"));
/// # Ok::<(), adwave_io::ShapeFileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GridLayout {
    /// Number of places along each of the 1 to 3 axes, in the order of the values: the last axis is contiguous. A NIfTI,
    /// whose first index runs fastest, has `[k, j, i]`; an image has `[rows, columns]`.
    pub sizes: Vec<usize>,
    /// Distance of neighbors along each axis, above 0.
    pub spacings: Vec<f64>,
    /// Name of each axis, such as `z`, `y`, `x` or `row`, `column`.
    pub axis_names: Vec<&'static str>,
    /// Position of the first place in the coordinates of the file.
    pub origin: [f64; 3],
    /// Step of each axis in those coordinates: the columns of the affine matrix.
    pub steps: Vec<[f64; 3]>,
    /// Unit of spacings, origin and steps, if it is known.
    pub unit: Option<LengthUnit>,
    /// False at places without data; `None` if all have data.
    pub kept: Option<Vec<bool>>,
}

impl GridLayout {
    /// Layout with these sizes and spacings, at the origin, whose last axis is x, the one before it y, and the one
    /// before that z; the axes of an image are `row` and `column`.
    pub fn new(sizes: &[usize], spacings: &[f64]) -> Self {
        let n = sizes.len().min(MAX_AXES);
        let axis_names = match n {
            2 => vec!["row", "column"],
            _ => ["z", "y", "x"][MAX_AXES - n..].to_vec(),
        };
        let step = |axis: usize| {
            let mut step = [0.0; 3];
            step[n - 1 - axis] = spacings.get(axis).copied().unwrap_or(1.0);
            step
        };
        Self {
            sizes: sizes.to_vec(),
            spacings: spacings.to_vec(),
            axis_names,
            origin: [0.0; 3],
            steps: (0..n).map(step).collect(),
            unit: None,
            kept: None,
        }
    }

    /// Number of places.
    pub fn n_places(&self) -> usize {
        self.sizes.iter().product()
    }

    /// Number of places without data.
    pub fn n_missing(&self) -> usize {
        self.kept.as_ref().map_or(0, |kept| kept.iter().filter(|kept| !**kept).count())
    }

    /// The grid with these sizes and spacings, whose places without data are left out.
    ///
    /// # Errors
    /// [`ShapeFileError::Grid`] if the sizes or spacings are no grid, or no place has data.
    pub fn to_grid(&self) -> Result<Grid, ShapeFileError> {
        let grid = Grid::new(&self.sizes, &self.spacings)?.with_frame(self.origin, &self.steps)?;
        Ok(match &self.kept {
            Some(kept) => grid.with_kept(kept.clone())?,
            None => grid,
        })
    }

    /// Difference between the places of this grid and another one, such as `sizes are [2, 3], got [3, 2]`; `None` if
    /// their sizes are equal and their corners within a tenth of a spacing.
    ///
    /// ```
    /// let (grid, mut turned) = (adwave_io::GridLayout::new(&[4, 4], &[1.0; 2]), adwave_io::GridLayout::new(&[4, 4], &[1.0; 2]));
    /// assert_eq!(grid.difference(&turned), None);
    /// turned.steps.swap(0, 1);
    /// assert_eq!(grid.difference(&turned).unwrap(), "place 12 is at [0.0, 3.0, 0.0], got [3.0, 0.0, 0.0]");
    /// ```
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.sizes != other.sizes {
            return Some(format!("sizes are {:?}, got {:?}", self.sizes, other.sizes));
        }
        let finest = self.spacings.iter().copied().fold(f64::INFINITY, f64::min);
        let end = |axis: usize| {
            let stride: usize = self.sizes[axis + 1..].iter().product();
            stride * self.sizes[axis].saturating_sub(1)
        };
        std::iter::once(0).chain((0..self.sizes.len()).map(end)).find_map(|place| {
            let (expected, found) = (self.position(place), other.position(place));
            let square: f64 = expected.iter().zip(&found).map(|(a, b)| (a - b).powi(2)).sum();
            let is_same = square.sqrt() <= SAME_PLACE * finest;
            (!is_same).then(|| format!("place {place} is at {expected:?}, got {found:?}"))
        })
    }

    /// Position of a place in the coordinates of the file.
    pub fn position(&self, place: usize) -> [f64; 3] {
        let (mut rest, mut position) = (place, self.origin);
        for (size, step) in self.sizes.iter().zip(&self.steps).rev() {
            let at = (rest % size) as f64;
            rest /= size;
            for (c, d) in position.iter_mut().zip(step) {
                *c += at * d;
            }
        }
        position
    }
}

/// Says how many places have no data, and the number in the file that means it; nothing if all have data.
pub(crate) fn note_on_missing(layout: &GridLayout, missing: Option<&str>, notes: &mut Vec<String>) {
    let (n_missing, n_places) = (layout.n_missing(), layout.n_places());
    if n_missing > 0 {
        let missing: String = missing.unwrap_or("NaN").chars().filter(|c| !c.is_control()).take(40).collect();
        notes.push(format!("{missing} means no data: {n_missing} of {n_places} places"));
    }
}

/// Lengths of the steps of the axes, 1 for a step without a length. The notes say what was assumed of steps that are no
/// axes at right angles.
pub(crate) fn step_lengths(steps: &[[f64; 3]], notes: &mut Vec<String>) -> Vec<f64> {
    let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let length = |step: &[f64; 3]| {
        let length = dot(step, step).sqrt();
        if length.is_normal() { length } else { 1.0 }
    };
    let lengths: Vec<f64> = steps.iter().map(length).collect();
    if steps.iter().any(|step| !dot(step, step).sqrt().is_normal()) {
        notes.push("the file has an axis without a spacing, which is taken as 1".into());
    }
    let mut shear = 0_f64;
    for (a, step) in steps.iter().enumerate() {
        for (b, other) in steps.iter().enumerate().skip(a + 1) {
            shear = shear.max((dot(step, other) / (lengths[a] * lengths[b])).abs());
        }
    }
    if shear > RIGHT_ANGLE {
        let angle = shear.min(1.0).acos().to_degrees();
        notes.push(format!(
            "two axes of the file are at {angle:.1}° instead of right angles; the lengths of their steps are used as \
             spacings"
        ));
    }
    lengths
}

impl ShapeFile {
    /// Creates an image or a volume without an original file and without values: the places of the grid are the
    /// vertices, and the field `values` ([`GRID_VALUES`]) is what files store.
    ///
    /// # Errors
    /// [`ShapeFileError::Grid`] if the sizes, spacings or steps do not describe a grid.
    pub fn from_grid(layout: GridLayout) -> Result<Self, ShapeFileError> {
        Grid::new(&layout.sizes, &layout.spacings)?;
        let (n_sizes, n_places) = (layout.sizes.len(), layout.n_places());
        for (what, n_found) in [("step", layout.steps.len()), ("name", layout.axis_names.len())] {
            if n_found != n_sizes {
                return Err(GridError::Axes { what, n_sizes, n_found }.into());
            }
        }
        if let Some(kept) = layout.kept.as_ref().filter(|kept| kept.len() != n_places) {
            let n_kept = kept.iter().filter(|kept| **kept).count();
            return Err(GridError::Mask { n_places, n_flags: kept.len(), n_kept }.into());
        }
        let mut file = Self::from_graph(n_places, Edges::default());
        file.unit.clone_from(&layout.unit);
        file.grid = Some(Arc::new(layout));
        Ok(file)
    }

    /// Places of the image or volume; `None` for a shape.
    pub fn grid(&self) -> Option<&GridLayout> {
        self.grid.as_deref()
    }

    /// Type of the numbers that a file of an image or volume is written with, if it was set.
    pub fn value_type(&self) -> Option<ValueType> {
        self.value_type
    }

    /// Sets the type of the numbers that a file of an image or volume is written with; `None` for that of its original,
    /// or of the values if there is none.
    pub fn set_value_type(&mut self, value_type: Option<ValueType>) {
        self.value_type = value_type;
    }
}
