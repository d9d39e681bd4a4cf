//! Parts of the brain that the rows of a CIFTI belong to.

use std::ops::Range;
use std::sync::Arc;

use crate::{Edges, Field, GridLayout, ShapeFile};

/// Name of the vertex field with the values of a CIFTI.
pub const BRAIN_VALUES: &str = "values";

/// Parts of the brain that the rows of a CIFTI belong to: vertices of surfaces, which stand in other files, and voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct BrainLayout {
    /// The parts, whose rows follow each other.
    pub parts: Vec<BrainPart>,
    /// The smallest box that holds all voxels; `None` without voxels.
    pub volume: Option<GridLayout>,
    /// Number of columns whose meaning the file states.
    pub n_columns: usize,
}

/// A part of the brain.
#[derive(Clone, Debug, PartialEq)]
pub struct BrainPart {
    /// Name of the structure, such as `CORTEX_LEFT`.
    pub structure: String,
    /// Its rows.
    pub rows: Range<usize>,
    /// Place of each row.
    pub places: BrainPlaces,
}

/// Places of the rows of a part.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BrainPlaces {
    /// Vertices of a surface.
    Surface {
        /// Number of vertices of the surface, some of which may have no row.
        n_vertices: usize,
        /// Vertex of each row.
        vertices: Vec<u32>,
    },
    /// Voxels.
    Voxels {
        /// Place of each row in [`BrainLayout::volume`].
        voxels: Vec<u32>,
    },
}

impl BrainLayout {
    /// True if two names mean the same structure: `CortexLeft`, `CORTEX_LEFT` and `CIFTI_STRUCTURE_CORTEX_LEFT`.
    ///
    /// ```
    /// assert!(adwave_io::BrainLayout::is_same_structure("CortexLeft", "CIFTI_STRUCTURE_CORTEX_LEFT"));
    /// assert!(!adwave_io::BrainLayout::is_same_structure("CortexLeft", "CORTEX_RIGHT"));
    /// ```
    pub fn is_same_structure(a: &str, b: &str) -> bool {
        let plain =
            |name: &str| name.trim_start_matches("CIFTI_STRUCTURE_").replace('_', "").to_ascii_lowercase();
        plain(a) == plain(b)
    }
}

impl ShapeFile {
    /// Values of the parts of a brain, a row for each place.
    pub(crate) fn from_brain(layout: BrainLayout, values: Field) -> Self {
        let n_rows = layout.parts.last().map_or(0, |part| part.rows.end);
        let mut file = Self::from_graph(n_rows, Edges::default());
        file.brain = Some(Arc::new(layout));
        file.vertex_fields.push(values);
        file
    }

    /// True if the usual signal is the values of the file, which has no points: those of an image, a volume or a brain.
    pub fn carries_values(&self) -> bool {
        self.grid.is_some() || self.brain.is_some()
    }

    /// Parts of the brain that the values belong to; `None` for a shape, an image or a volume.
    pub fn brain(&self) -> Option<&BrainLayout> {
        self.brain.as_deref()
    }
}
