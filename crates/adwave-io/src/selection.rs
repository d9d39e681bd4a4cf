//! Choice of the vertices that take part in a computation, by values of fields and by masks in other files.

use std::fmt;
use std::str::FromStr;

use adwave::{ClassifiedError, ErrorKind};

use crate::signal::values_of_file;
use crate::{Field, NamedSignalError, ShapeFile, ShapeFileError, named_axis};

/// Condition on the values of a scalar field: `classification=2,6` or `height=1..20`.
///
/// ```
/// use adwave_io::FieldCondition;
/// let ground: FieldCondition = "classification=2,8".parse()?;
/// assert!(ground.holds(2.0) && !ground.holds(3.0));
/// let low: FieldCondition = "height=-1..0.5".parse()?;
/// assert!(low.holds(0.5) && low.holds(-1.0) && !low.holds(f64::NAN));
/// assert_eq!(low.to_string(), "height=-1..0.5");
/// # Ok::<(), adwave_io::FieldConditionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FieldCondition {
    /// Name of the field.
    pub field: String,
    /// Values that are in.
    pub values: ConditionValues,
}

/// Values that a condition admits. NaN is never one of them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConditionValues {
    /// Any of these numbers.
    Any(Vec<f64>),
    /// Numbers from the first to the second, both included.
    Range(f64, f64),
}

/// Text that is no condition on a field.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a condition must be FIELD=VALUE,VALUE,… or FIELD=LOW..HIGH, got '{0}'")]
pub struct FieldConditionError(String);

impl FromStr for FieldCondition {
    type Err = FieldConditionError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || FieldConditionError(text.to_owned());
        let number = |word: &str| word.trim().parse::<f64>().ok().filter(|x| !x.is_nan()).ok_or_else(wrong);
        let (field, values) = text.rsplit_once('=').ok_or_else(wrong)?;
        if field.trim().is_empty() {
            return Err(wrong());
        }
        let values = match values.split_once("..") {
            None => ConditionValues::Any(values.split(',').map(number).collect::<Result<_, _>>()?),
            Some((low, high)) => {
                let end =
                    |word: &str, open: f64| if word.trim().is_empty() { Ok(open) } else { number(word) };
                let (low, high) = (end(low, f64::NEG_INFINITY)?, end(high, f64::INFINITY)?);
                if low > high {
                    return Err(wrong());
                }
                ConditionValues::Range(low, high)
            }
        };
        Ok(Self { field: field.trim().to_owned(), values })
    }
}

impl fmt::Display for FieldCondition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}=", self.field)?;
        match &self.values {
            ConditionValues::Any(values) => {
                let words: Vec<String> = values.iter().map(ToString::to_string).collect();
                f.write_str(&words.join(","))
            }
            ConditionValues::Range(low, high) => {
                let end = |x: f64| if x.is_finite() { x.to_string() } else { String::new() };
                write!(f, "{}..{}", end(*low), end(*high))
            }
        }
    }
}

impl FieldCondition {
    /// Tells if a value is in.
    pub fn holds(&self, value: f64) -> bool {
        match &self.values {
            ConditionValues::Any(values) => values.contains(&value),
            ConditionValues::Range(low, high) => *low <= value && value <= *high,
        }
    }
}

/// Vertices that take part in a computation: those that fulfil all conditions and are not 0 or NaN in the mask.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Conditions on fields of the shape.
    pub conditions: Vec<FieldCondition>,
    /// File of values, one per row of the file, optionally with `:NAME` for one of several columns.
    pub mask: Option<String>,
}

/// Reasons for which a selection cannot be applied.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SelectionError {
    /// A condition names a field that does not exist or has several channels.
    #[error("the condition '{condition}' needs a field with one number per vertex; use {}", available.join(", "))]
    Field {
        /// The condition.
        condition: String,
        /// Names of the fields that can be used.
        available: Vec<String>,
    },
    /// No vertex fulfils the conditions.
    #[error("no vertex fulfils {selection}; the values of the field are {least} to {most}")]
    Nothing {
        /// The condition that leaves nothing.
        selection: String,
        /// Least value.
        least: f64,
        /// Greatest value.
        most: f64,
    },
    /// The mask does not have one number per vertex.
    #[error(
        "the mask {mask} needs one number for each of {n_rows} vertices, but has {found} rows of {n_channels}"
    )]
    Mask {
        /// Name of the file.
        mask: String,
        /// Number of its rows.
        found: usize,
        /// Numbers in a row.
        n_channels: usize,
        /// Number of vertices in the file of the shape.
        n_rows: usize,
    },
    /// The mask cannot be read.
    #[error(transparent)]
    Read(#[from] NamedSignalError),
    /// Nothing is left of the shape.
    #[error(transparent)]
    Shape(#[from] ShapeFileError),
}

impl ClassifiedError for SelectionError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read(error) => error.kind(),
            _ => ErrorKind::Input,
        }
    }
}

impl Selection {
    /// True if all vertices take part.
    pub fn is_everything(&self) -> bool {
        self.conditions.is_empty() && self.mask.is_none()
    }

    /// Part of the shape with the vertices that take part. The others are as if the file did not have them, and keep
    /// their positions and values when the part is written.
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues, Selection, ShapeFile};
    /// let mut file = ShapeFile::from_cloud(vec![[0.0; 3], [1.0; 3], [2.0; 3]]);
    /// file.add_vertex_field(Field::new("classification", 1, FieldValues::U8(vec![2, 5, 2])))?;
    /// let ground = Selection { conditions: vec!["classification=2".parse()?], mask: None };
    /// assert_eq!(ground.apply(&file)?.points(), [[0.0; 3], [2.0; 3]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SelectionError`].
    pub fn apply(&self, file: &ShapeFile) -> Result<ShapeFile, SelectionError> {
        let mut keep = vec![true; file.n_vertices()];
        for condition in &self.conditions {
            let values = scalar_field(file, &condition.field).ok_or_else(|| SelectionError::Field {
                condition: condition.to_string(),
                available: scalar_names(file),
            })?;
            let mut n_held = 0;
            for (keep, &value) in keep.iter_mut().zip(&values) {
                let holds = condition.holds(value);
                n_held += usize::from(holds);
                *keep &= holds;
            }
            if n_held == 0 {
                let present = || values.iter().copied().filter(|x| !x.is_nan());
                return Err(SelectionError::Nothing {
                    selection: condition.to_string(),
                    least: present().fold(f64::INFINITY, f64::min),
                    most: present().fold(f64::NEG_INFINITY, f64::max),
                });
            }
        }
        if let Some(mask) = &self.mask {
            let values = mask_values(file, mask)?;
            for (vertex, keep) in keep.iter_mut().enumerate() {
                let value = values.get(vertex, 0);
                *keep &= value != 0.0 && !value.is_nan();
            }
        }
        Ok(file.select_rows(&keep)?)
    }
}

/// Values of a mask at the vertices of the shape.
fn mask_values(file: &ShapeFile, mask: &str) -> Result<Field, SelectionError> {
    let n_rows = file.n_file_rows();
    let field = values_of_file(mask, file.structure(), n_rows)?
        .ok_or_else(|| NamedSignalError::Unknown(format!("there is no mask file '{mask}'")))?;
    if field.n_channels != 1 || (field.len() != n_rows && field.len() != file.n_vertices()) {
        let (found, n_channels) = (field.len(), field.n_channels);
        return Err(SelectionError::Mask { mask: mask.to_owned(), found, n_channels, n_rows });
    }
    Ok(match file.file_rows().filter(|_| field.len() == n_rows) {
        Some(rows) => rows.select(&field),
        None => field,
    })
}

fn scalar_field(file: &ShapeFile, name: &str) -> Option<Vec<f64>> {
    if let Some(field) = file.field(name) {
        return (field.n_channels == 1).then(|| field.to_f64());
    }
    let axis = named_axis(file, name)?;
    Some(file.points().iter().map(|p| p[axis]).collect())
}

fn scalar_names(file: &ShapeFile) -> Vec<String> {
    let fields = file.vertex_fields().iter().filter(|f| f.n_channels == 1).map(|f| f.name.clone());
    let axes = ["x", "y", "z"].into_iter().filter(|name| named_axis(file, name).is_some()).map(str::to_owned);
    fields.chain(axes).collect()
}
