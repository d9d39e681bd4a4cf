//! Faces of a mesh as a shape of their own, so that fields of faces are signals.

use crate::model::field::Field;
use crate::model::shape_file::ShapeFile;
use adwave::shape::{GraphError, Mesh, Shape, dual_graph};

/// The faces of a mesh as cells: a shape with a node for each face.
#[derive(Clone, Debug)]
pub struct FaceCells {
    /// Centers of the faces as points, and the fields of the faces as their fields.
    pub file: ShapeFile,
    /// Dual graph of the mesh, with the areas of the faces.
    pub shape: Shape,
}

impl FaceCells {
    /// Creates the cells of a mesh with these fields of faces. O(n log n).
    ///
    /// # Errors
    /// [`GraphError`] if the mesh has no faces.
    pub fn new(mesh: &Mesh, fields: &[Field]) -> Result<Self, GraphError> {
        let graph = dual_graph(mesh)?;
        let mut file = ShapeFile::from_cloud(graph.positions().unwrap_or_default().to_vec());
        file.vertex_fields = fields.to_vec();
        Ok(Self { file, shape: Shape::Graph(graph) })
    }
}

impl ShapeFile {
    /// True if a field of the faces has this name, and no field of the vertices.
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues, ShapeFile};
    /// let mut file = ShapeFile::from_mesh(vec![[0.0; 3]; 3], [[0, 1, 2].as_slice()].into_iter().collect());
    /// file.add_face_field(Field::new("pressure", 1, FieldValues::F64(vec![7.0])))?;
    /// assert!(file.has_face_field("pressure") && !file.has_face_field("speed"));
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    pub fn has_face_field(&self, name: &str) -> bool {
        self.field(name).is_none() && self.face_fields.iter().any(|field| field.name == name)
    }
}
