//! Choice of the vertices that take part in a computation: by values of fields, by masks in other files, and by the
//! flags of LAS points.

mod condition;
mod error;
mod flagged;
mod mask;

pub use condition::{ClosedInterval, FieldCondition, FieldConditionError};
pub use error::SelectionError;
pub use flagged::FlaggedPoints;
pub use mask::{MaskFile, MaskSide};

use crate::{CoordinatePrecision, Field, FieldValues, ShapeFile, named_axis};
use flagged::{FlagRule, flagged_points};
use mask::read_mask;
use std::sync::Arc;

/// Vertices that take part in a computation: those that fulfill all conditions, are in the mask, and are not flagged as
/// withheld or noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Conditions on fields of the shape.
    pub conditions: Vec<FieldCondition>,
    /// Mask in another file.
    pub mask: Option<MaskFile>,
    /// Treatment of flagged points. A condition on `classification` lets the classes of noise that it names take part,
    /// and one on `classification_flags` lets withheld points take part.
    pub flagged: FlaggedPoints,
}

/// Part of a shape with the vertices that take part.
#[derive(Clone, Debug)]
pub struct SelectedShape {
    /// Part of the shape.
    pub file: ShapeFile,
    /// Number of vertices before.
    pub n_before: usize,
    /// Number of points that take no part because they are flagged as withheld or classified as noise.
    pub n_flagged: usize,
    /// Clause on the meaning of the mask.
    pub mask_meaning: Option<String>,
}

impl Selection {
    /// Returns true if conditions or a mask choose the vertices.
    pub fn is_restricted(&self) -> bool {
        !self.conditions.is_empty() || self.mask.is_some()
    }

    /// Returns true if the vertices outside of the mask take part.
    pub fn is_mask_inverted(&self) -> bool {
        self.mask.as_ref().is_some_and(|mask| mask.side == MaskSide::Outside)
    }

    /// Selects the vertices that take part. The others are as if the file did not have them, and keep their positions
    /// and values when the part is written. O(vertices + faces).
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues, Selection, ShapeFile};
    /// let mut file = ShapeFile::from_cloud(vec![[0.0; 3], [1.0; 3], [2.0; 3]]);
    /// file.add_vertex_field(Field::new("classification", 1, FieldValues::U8(vec![2, 5, 2])))?;
    /// let ground = Selection { conditions: vec!["classification=2".parse()?], ..Selection::default() };
    /// assert_eq!(ground.apply(file)?.file.points(), [[0.0; 3], [2.0; 3]]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SelectionError`]: a field is missing or has several channels, the mask cannot be read or has another number of
    /// vertices, or no vertex is left.
    pub fn apply(&self, file: ShapeFile) -> Result<SelectedShape, SelectionError> {
        let n_before = file.n_vertices();
        let mut keep = vec![true; n_before];
        for condition in &self.conditions {
            let scalar = scalar_field(&file, condition)?;
            let n_held = keep_where(&mut keep, |i| scalar.condition.holds(scalar.values[i]));
            if n_held == 0 {
                return Err(SelectionError::nothing(condition, &scalar.values));
            }
        }
        let mut mask_meaning = None;
        if let Some(mask) = &self.mask {
            let mask = read_mask(&file, mask)?;
            keep_where(&mut keep, |i| mask.takes_part[i]);
            mask_meaning = Some(mask.meaning);
        }
        if n_before > 0 && !keep.contains(&true) {
            return Err(SelectionError::NothingLeft { selection: self.describe().join(" and ") });
        }
        let n_chosen = keep.iter().filter(|&&kept| kept).count();
        let flagged = self.flag_rule().map_or_else(Vec::new, |rule| flagged_points(&file, rule));
        let mut n_left = n_chosen;
        if !flagged.is_empty() {
            n_left = keep.iter().zip(&flagged).filter(|&(&kept, &flagged)| kept && !flagged).count();
        }
        // If all points of a file are flagged, they are meant to be processed.
        let n_flagged = if n_left > 0 { n_chosen - n_left } else { 0 };
        if n_flagged > 0 {
            keep_where(&mut keep, |i| !flagged[i]);
        }
        let file = match keep.contains(&false) {
            true if file.grid().is_some() => keep_places(file, &keep),
            true => file.select_rows(&keep)?,
            false => file,
        };
        Ok(SelectedShape { file, n_before, n_flagged, mask_meaning })
    }

    /// Conditions and the mask, as texts.
    pub fn describe(&self) -> Vec<String> {
        let mask = self.mask.as_ref().map(|mask| match mask.side {
            MaskSide::Inside => format!("mask {}", mask.name),
            MaskSide::Outside => format!("outside of mask {}", mask.name),
        });
        self.conditions.iter().map(ToString::to_string).chain(mask).collect()
    }

    fn flag_rule(&self) -> Option<FlagRule> {
        let is_asked = |name: &str| self.conditions.iter().any(|condition| condition.field == name);
        (self.flagged == FlaggedPoints::LeftOut).then(|| FlagRule {
            leaves_out_noise: !is_asked("classification"),
            leaves_out_withheld: !is_asked("classification_flags"),
        })
    }
}

/// A file with an image or a volume in which only the flagged places have data.
fn keep_places(mut file: ShapeFile, keep: &[bool]) -> ShapeFile {
    if let Some(layout) = &mut file.grid {
        let n_places = layout.n_places();
        let kept = Arc::make_mut(layout).kept.get_or_insert_with(|| vec![true; n_places]);
        kept.iter_mut().zip(keep).for_each(|(kept, keep)| *kept &= keep);
    }
    file
}

/// Drops the vertices for which `holds` is false, and returns the number of vertices for which it is true.
fn keep_where(keep: &mut [bool], holds: impl Fn(usize) -> bool) -> usize {
    let mut n_held = 0;
    for (i, keep) in keep.iter_mut().enumerate() {
        let holds = holds(i);
        n_held += usize::from(holds);
        *keep &= holds;
    }
    n_held
}

/// Numbers of a condition's field, and the condition in the precision of these numbers.
struct ScalarField {
    values: Vec<f64>,
    condition: FieldCondition,
}

fn scalar_field(file: &ShapeFile, condition: &FieldCondition) -> Result<ScalarField, SelectionError> {
    let name = condition.field.as_str();
    let (values, is_single) = if let Some(field) = file.field(name) {
        if field.n_channels != 1 {
            let (condition, n_channels) = (condition.to_string(), field.n_channels);
            return Err(SelectionError::Channels { condition, n_channels, available: scalar_names(file) });
        }
        (field.to_f64(), matches!(field.values, FieldValues::F32(_)))
    } else if let Some(axis) = named_axis(file, name) {
        (file.points().iter().map(|p| p[axis]).collect(), file.precision() == CoordinatePrecision::F32)
    } else {
        let is_of_faces = file.face_fields().iter().any(|field| field.name == name);
        let (condition, available) = (condition.to_string(), scalar_names(file));
        return Err(SelectionError::unknown(condition, is_of_faces, available));
    };
    let condition = if is_single { condition.in_single_precision() } else { condition.clone() };
    Ok(ScalarField { values, condition })
}

/// Names of the fields with one number per vertex, and of the axes.
fn scalar_names(file: &ShapeFile) -> Vec<String> {
    let is_scalar = |field: &&Field| field.n_channels == 1;
    let fields = file.vertex_fields().iter().filter(is_scalar).map(|field| field.name.clone());
    let axes = ["x", "y", "z"].into_iter().filter(|name| named_axis(file, name).is_some()).map(str::to_owned);
    fields.chain(axes).collect()
}
