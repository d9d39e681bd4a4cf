//! Subsets of a file: the attributes of the remaining vertices and faces are kept.

use adwave::shape::Polygons;
use std::sync::Arc;

use crate::{Field, ShapeFile, ShapeFileError};

/// Part of a file to keep.
#[derive(Clone, Debug, Default)]
pub struct Subset<'a> {
    /// Vertices to keep, in ascending order.
    pub vertices: &'a [u32],
    /// New triangles; their indices refer to `vertices`.
    pub triangles: &'a [[u32; 3]],
    /// Face whose attributes each triangle gets.
    pub faces: &'a [u32],
    /// Corner whose texture coordinate, normal, material and group each corner of the triangles gets, counted through
    /// all faces of the file.
    pub corners: &'a [[u32; 3]],
}

impl ShapeFile {
    /// Creates a file with fewer vertices and other triangles. Fields keep their type of numbers; an OBJ keeps its
    /// lines, with texture coordinates and normals of corners, materials and groups. Edges and lines stay if both
    /// ends do. Other [`extras`](Self::extras), such as comments of a PLY, are dropped, except those of a LAS.
    /// O(vertices + faces).
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues, ShapeFile, Subset};
    /// let mut file = ShapeFile::from_cloud(vec![[0.0; 3], [1.0; 3], [2.0; 3]]);
    /// file.add_vertex_field(Field::new("heat", 1, FieldValues::U8(vec![7, 8, 9])))?;
    /// let part = file.subset(&Subset { vertices: &[0, 2], ..Subset::default() })?;
    /// assert_eq!(part.points(), [[0.0; 3], [2.0; 3]]);
    /// assert_eq!(part.field("heat").unwrap().to_f64(), [7.0, 9.0]);
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`ShapeFileError::Subset`] if a list refers to items that do not exist, or does not have one item per
    /// triangle.
    pub fn subset(&self, subset: &Subset<'_>) -> Result<Self, ShapeFileError> {
        self.check_subset(subset)?;
        let source = self.original.as_deref();
        if let Some(file) = source.and_then(|source| source.subset_shape(self, subset)) {
            return Ok(file);
        }
        let rows = |field: &Field, rows: &[u32]| selected(field, rows);
        let mut file = Self {
            n_vertices: subset.vertices.len(),
            points: Arc::new(if self.points.is_empty() {
                Vec::new()
            } else {
                subset.vertices.iter().map(|&x| self.points[x as usize]).collect()
            }),
            faces: Arc::new(Polygons::from_triangles(subset.triangles)),
            vertex_fields: self.vertex_fields.iter().map(|field| rows(field, subset.vertices)).collect(),
            vertex_names: self
                .vertex_names
                .as_deref()
                .map(|names| Arc::new(subset.vertices.iter().map(|&x| names[x as usize].clone()).collect())),
            face_fields: self.face_fields.iter().map(|field| rows(field, subset.faces)).collect(),
            format: self.format,
            precision: self.precision,
            unit: self.unit.clone(),
            coordinate_system: self.coordinate_system.clone(),
            is_map: self.is_map,
            original: source.and_then(|source| source.subset(subset.vertices)),
            // The normals of an STL belong to its triangles.
            moved: true,
            ..Self::empty()
        };
        file.edges.direction = self.edges.direction;
        let keeps_extras =
            |format| file.original.as_deref().is_some_and(|source| source.keeps_extras(format));
        if self.format.is_some_and(keeps_extras) {
            file.extras.clone_from(&self.extras);
        }
        for (k, pair) in self.edges.pairs.iter().enumerate() {
            let place = |x: &u32| subset.vertices.binary_search(x).ok().map(|place| place as u32);
            if let (Some(a), Some(b)) = (place(&pair[0]), place(&pair[1])) {
                file.edges.pairs.push([a, b]);
                file.edges.weights.extend(self.edges.weights.get(k));
            }
        }
        if subset.triangles.is_empty() && !self.faces.is_empty() {
            file.face_fields.clear();
        }
        Ok(file)
    }

    /// Labels the corners of the faces for simplification: labels are equal if texture coordinate, material and group
    /// are. Different labels at one vertex mark a seam. `None` if all labels are equal.
    ///
    /// For an OBJ the labels come from its text, for other files from the field `texcoord`, which distinguishes
    /// vertices at one position. A face field `color` or `material` distinguishes faces.
    ///
    /// ```
    /// use adwave_io::{ReadLimits, read_bytes};
    /// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 2 4 3\n";
    /// let file = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap();
    /// assert_eq!(file.corner_labels().unwrap(), [0, 0, 0, 1, 1, 1]);
    /// ```
    pub fn corner_labels(&self) -> Option<Vec<u32>> {
        let labels = match self.original.as_deref() {
            Some(source) => source.corner_labels(self),
            None => self.labels_by_texcoord(),
        };
        let fields: Vec<&Field> =
            self.face_fields.iter().filter(|field| ["color", "material"].contains(&&*field.name)).collect();
        if fields.is_empty() {
            return labels;
        }
        let of_face = distinct(self.faces.len(), |f| {
            let channels = fields.iter().flat_map(|field| (0..field.n_channels).map(|c| field.get(f, c)));
            channels.map(|x| (x + 0.0).to_bits()).collect::<Vec<_>>()
        });
        let face_of: Vec<u32> =
            self.faces.iter().enumerate().flat_map(|(f, face)| face.iter().map(move |_| f as u32)).collect();
        let key = |k: usize| (labels.as_ref().map(|labels| labels[k]), of_face[face_of[k] as usize]);
        Some(distinct(face_of.len(), key))
    }

    /// Returns colors and texture coordinates at the corners of the faces, for which 1 is the full range; `None`
    /// without either. Colors are those of the vertices.
    ///
    /// ```
    /// use adwave_io::{ReadLimits, read_bytes};
    /// let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.5\nvt 1 0\nf 1/1 2/2 3/1\n";
    /// let file = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap();
    /// let values = file.corner_values().unwrap();
    /// assert_eq!((values.values, values.n_channels), (vec![0.0, 0.5, 1.0, 0.0, 0.0, 0.5], 2));
    /// ```
    pub fn corner_values(&self) -> Option<CornerValues> {
        let corners = self.faces.corners();
        let mut parts = Vec::new();
        for field in ["color", "texcoord"].iter().filter_map(|name| self.field(name)) {
            let scale = if field.name == "color" { field.full_intensity() } else { 1.0 };
            let value = |&x: &u32| (0..field.n_channels).map(move |c| field.get(x as usize, c) / scale);
            parts.push((corners.iter().flat_map(value).collect(), field.n_channels));
        }
        if self.field("texcoord").is_none()
            && let Some(texcoords) = self.original.as_deref().and_then(|source| source.corner_texcoords(self))
        {
            parts.push((texcoords, 2));
        }
        let n_channels: usize = parts.iter().map(|(_, n)| n).sum();
        let row =
            |k: usize| parts.iter().flat_map(move |(values, n): &(Vec<f64>, usize)| &values[k * n..][..*n]);
        let values: Vec<f64> = (0..corners.len()).flat_map(row).copied().collect();
        (n_channels > 0 && values.iter().all(|x| x.is_finite()))
            .then_some(CornerValues { values, n_channels })
    }

    /// [`corner_labels`](Self::corner_labels) by the field `texcoord`.
    pub(crate) fn labels_by_texcoord(&self) -> Option<Vec<u32>> {
        let field = self.field("texcoord")?;
        let of_vertex = distinct(field.len(), |x| {
            (0..field.n_channels).map(|c| (field.get(x, c) + 0.0).to_bits()).collect::<Vec<_>>()
        });
        Some(self.faces.corners().iter().map(|&x| of_vertex[x as usize]).collect())
    }

    pub(crate) fn check_subset(&self, subset: &Subset<'_>) -> Result<(), ShapeFileError> {
        let wrong = |what: &'static str| Err(ShapeFileError::Subset { what });
        let (n_kept, n_triangles) = (subset.vertices.len(), subset.triangles.len());
        if !subset.vertices.is_sorted_by(|a, b| a < b)
            || subset.vertices.last().is_some_and(|&x| x as usize >= self.n_vertices)
        {
            return wrong("vertices that are not ascending or do not exist");
        }
        if subset.triangles.as_flattened().iter().any(|&x| x as usize >= n_kept) {
            return wrong("triangles with vertices outside the subset");
        }
        if subset.faces.len() != n_triangles || subset.faces.iter().any(|&f| f as usize >= self.faces.len()) {
            return wrong("faces that are not one per triangle or do not exist");
        }
        let n_corners = self.faces.corners().len();
        if subset.corners.len() != n_triangles
            || subset.corners.as_flattened().iter().any(|&k| k as usize >= n_corners)
        {
            return wrong("corners that are not three per triangle or do not exist");
        }
        Ok(())
    }
}

/// Values at the corners of faces.
#[derive(Clone, Debug, PartialEq)]
pub struct CornerValues {
    /// `n_channels` values for each corner of each face.
    pub values: Vec<f64>,
    /// Number of values per corner.
    pub n_channels: usize,
}

/// Selects these rows of a field.
pub(crate) fn selected(field: &Field, rows: &[u32]) -> Field {
    let n = field.n_channels;
    let mut values = field.values.value_type().empty();
    macro_rules! select {
        ($($variant:ident),*) => {
            match (&field.values, &mut values) {
                $((crate::FieldValues::$variant(from), crate::FieldValues::$variant(to)) => {
                    to.extend(rows.iter().flat_map(|&row| &from[row as usize * n..][..n]));
                })*
                _ => {}
            }
        };
    }
    select!(U8, I8, U16, I16, U32, I32, U64, I64, F32, F64);
    Field { name: field.name.clone(), values, labels: field.labels.clone(), ..*field }
}

/// Numbers equal keys equally, from 0 in the order of their first occurrence.
pub(crate) fn distinct<K: std::hash::Hash + Eq>(n: usize, key: impl Fn(usize) -> K) -> Vec<u32> {
    let mut known = std::collections::HashMap::new();
    (0..n)
        .map(|k| {
            let next = known.len() as u32;
            *known.entry(key(k)).or_insert(next)
        })
        .collect()
}
