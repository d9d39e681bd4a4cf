//! Marks of records: reasons for which they may take no part.

use adwave_io::{
    FieldCondition, LasColumn, LasReader, MeshReader, NOISE_CLASSES, SelectionError, VertexColumn,
    WITHHELD_FLAG,
};
use rayon::prelude::*;

use super::input_shape::InputShape;
use crate::error::TilesError;
use crate::layout::{
    FLAGGED, LasQuantization, MeshUnits, RecordLayout, SUSPECT, UNSELECTED, quantized_xyz, vertex_coordinates,
};
use crate::params::Params;

/// Names of the coordinates, which conditions may use.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Number of a record that a condition concerns.
#[derive(Clone, Debug)]
enum ConditionSource {
    Axis(usize),
    Las(LasColumn),
    /// Index among the columns that are read with the vertices.
    Column(usize),
}

/// Condition on a number of a record.
#[derive(Clone, Debug)]
struct RecordCondition {
    source: ConditionSource,
    condition: FieldCondition,
}

/// The rules by which records are marked.
#[derive(Clone, Debug, Default)]
pub(crate) struct RecordMarker {
    conditions: Vec<RecordCondition>,
    /// Column of the class of a point, if classes of noise are marked.
    class: Option<LasColumn>,
    /// Column of the flags of a point, if withheld points are marked.
    flags: Option<LasColumn>,
    /// Flags of the rows of all inputs that take part; empty without a mask.
    mask: Vec<bool>,
    /// Columns of a mesh that conditions concern.
    pub(crate) columns: Vec<VertexColumn>,
}

impl RecordMarker {
    /// Resolves the selection of a job on its inputs.
    pub(crate) fn new(shape: &InputShape, params: &Params) -> Result<Self, TilesError> {
        let selection = params.selection.to_selection()?;
        let mut marker = Self::default();
        let path = &shape.files[0].path;
        match shape.layout {
            RecordLayout::Las(_) => {
                let reader = LasReader::open(path)?;
                for condition in &selection.conditions {
                    marker.push_las_condition(&reader, condition)?;
                }
                if !params.selection.includes_flagged {
                    let is_asked = |name: &str| selection.conditions.iter().any(|asked| asked.field == name);
                    let column = |name: &str| reader.column(name).filter(|_| !is_asked(name));
                    marker.class = column("classification");
                    marker.flags = column("classification_flags");
                }
            }
            RecordLayout::Mesh(_) => {
                let reader = MeshReader::open(path)?;
                for condition in &selection.conditions {
                    marker.push_mesh_condition(&reader, condition)?;
                }
            }
        }
        if let Some(mask) = &selection.mask {
            marker.mask = mask.read_rows(shape.n_points as usize)?;
        }
        Ok(marker)
    }

    fn push_las_condition(
        &mut self,
        reader: &LasReader,
        condition: &FieldCondition,
    ) -> Result<(), TilesError> {
        let (column, axis) = (reader.column(&condition.field), axis_of(&condition.field));
        let (source, condition) = match (column, axis) {
            (Some(column), _) if column.is_single_precision() => {
                (ConditionSource::Las(column), condition.in_single_precision())
            }
            (Some(column), _) => (ConditionSource::Las(column), condition.clone()),
            (None, Some(axis)) => (ConditionSource::Axis(axis), condition.clone()),
            (None, None) => return Err(unknown_field(condition, reader.column_names()).into()),
        };
        self.conditions.push(RecordCondition { source, condition });
        Ok(())
    }

    fn push_mesh_condition(
        &mut self,
        reader: &MeshReader,
        condition: &FieldCondition,
    ) -> Result<(), TilesError> {
        let (column, axis) = (reader.column(&condition.field), axis_of(&condition.field));
        let (source, condition) = match (column, axis) {
            (Some(column), _) => {
                self.columns.push(column);
                let source = ConditionSource::Column(self.columns.len() - 1);
                let is_single = column.is_single_precision();
                (source, if is_single { condition.in_single_precision() } else { condition.clone() })
            }
            (None, Some(axis)) => {
                let is_single = reader.has_single_precision();
                let source = ConditionSource::Axis(axis);
                (source, if is_single { condition.in_single_precision() } else { condition.clone() })
            }
            (None, None) => return Err(unknown_field(condition, reader.column_names()).into()),
        };
        self.conditions.push(RecordCondition { source, condition });
        Ok(())
    }

    /// Returns true if the row of the inputs is in the mask, or if there is no mask.
    fn is_in_mask(&self, row: u64) -> bool {
        self.mask.get(row as usize).copied().unwrap_or(true)
    }

    fn mark(&self, row: u64, position: &[f64; 3], value: impl Fn(&ConditionSource) -> f64) -> u8 {
        let holds = |own: &RecordCondition| own.condition.holds(value(&own.source));
        let mut marks = 0;
        if !self.is_in_mask(row) || !self.conditions.iter().all(holds) {
            marks |= UNSELECTED;
        }
        if adwave::shape::may_be_placeholder(position) {
            marks |= SUSPECT;
        }
        marks
    }

    /// Appends point records of a LAS with their marks. `first_row` is the row of the first in all inputs.
    pub(crate) fn push_points(
        &self,
        quantization: LasQuantization,
        points: &[u8],
        first_row: u64,
        records: &mut Vec<u8>,
    ) {
        let own_bytes = quantization.record_bytes;
        let start = records.len();
        records.resize(start + points.len() / own_bytes * (own_bytes + 1), 0);
        let marked =
            records[start..].par_chunks_exact_mut(own_bytes + 1).zip(points.par_chunks_exact(own_bytes));
        marked.enumerate().for_each(|(i, (record, point))| {
            record[..own_bytes].copy_from_slice(point);
            let position = quantization.to_position(quantized_xyz(point));
            let mut marks = self.mark(first_row + i as u64, &position, |source| match source {
                ConditionSource::Axis(axis) => position[*axis],
                ConditionSource::Las(column) => column.value(point),
                ConditionSource::Column(_) => f64::NAN,
            });
            let number = |column: &Option<LasColumn>| column.as_ref().map(|column| column.value(point) as u8);
            let is_noise = number(&self.class).is_some_and(|class| NOISE_CLASSES.contains(&class));
            if is_noise || number(&self.flags).is_some_and(|flags| flags & WITHHELD_FLAG != 0) {
                marks |= FLAGGED;
            }
            record[own_bytes] = marks;
        });
    }

    /// Marks of a vertex record of a mesh, whose row has these `values` of [`columns`](Self::columns).
    pub(crate) fn mark_vertex(&self, row: u32, record: &[u8], values: &[f64]) -> u8 {
        let position = vertex_coordinates(&record[..MeshUnits::POSITION_BYTES]);
        self.mark(row.into(), &position, |source| match source {
            ConditionSource::Axis(axis) => position[*axis],
            ConditionSource::Las(_) => f64::NAN,
            ConditionSource::Column(k) => values.get(*k).copied().unwrap_or(f64::NAN),
        })
    }
}

fn axis_of(name: &str) -> Option<usize> {
    AXES.iter().position(|axis| *axis == name)
}

fn unknown_field(condition: &FieldCondition, columns: Vec<String>) -> SelectionError {
    let available = columns.into_iter().chain(AXES.map(str::to_owned)).collect();
    SelectionError::UnknownField { condition: condition.to_string(), available }
}
