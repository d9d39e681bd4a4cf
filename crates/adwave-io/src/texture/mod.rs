//! Colors of a texture at the vertices of a mesh: OBJ with its materials, or any shape with UVs and a picture.

mod gltf_parts;
mod materials;
mod obj_corners;
mod picture;

use std::path::Path;

use adwave::{ClassifiedError, ErrorKind, Progress};

use crate::limits::decompress;
use crate::registry::read::read_file;
use crate::{Field, FieldValues, ReadError, ReadLimits, ShapeFile};
use materials::read_materials;
use obj_corners::Corners;
use picture::Picture;

/// Why there are no colors.
#[derive(Debug, thiserror::Error)]
pub enum TextureError {
    /// The file of the shape, or of its materials, cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No vertex says where in the picture it is.
    #[error("{shape} has no texture coordinates (UVs), so no texture can be sampled; export it with them")]
    NoCoordinates {
        /// The shape's file.
        shape: String,
    },
    /// Nothing names a picture.
    #[error(
        "{shape} names no texture (no map_Kd or baseColorTexture in its materials); name one with --texture FILE.png"
    )]
    NoTexture {
        /// The shape's file.
        shape: String,
    },
    /// A picture is not there or is no picture.
    #[error("the texture {path} cannot be read ({cause}); check the name, or convert it to PNG or JPEG")]
    Picture {
        /// The picture's file.
        path: String,
        /// Why.
        cause: String,
        /// Whether the picture or the machine is to blame.
        kind: ErrorKind,
    },
}

impl ClassifiedError for TextureError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Read(error) => error.kind(),
            Self::NoCoordinates { .. } | Self::NoTexture { .. } => ErrorKind::Input,
            Self::Picture { kind, .. } => *kind,
        }
    }
}

/// The colors of a texture at the vertices: the field `texture`, red, green and blue in [0, 1] as the picture has them.
///
/// `image` is the picture; without it an OBJ's materials name one for each part (`map_Kd`), and a glTF's (`baseColorTexture`). Sampled between pixels, repeated
/// beyond the picture's edges, the first row of pixels at v = 1. A vertex on a seam gets the mean of its places in the
/// picture; one without a place NaN.
///
/// # Errors
/// [`TextureError`]: no UVs, no picture, or a file that cannot be read.
pub fn texture_colors(
    shape: &ShapeFile,
    path: &Path,
    image: Option<&Path>,
    limits: &ReadLimits,
) -> Result<Field, TextureError> {
    let name = || path.display().to_string();
    if let (Some(texcoord), Some(image)) = (shape.field("texcoord").filter(|f| f.n_channels >= 2), image) {
        let picture = Picture::open(image)?;
        let at = |i: usize| picture.sample(texcoord.get(i, 0), texcoord.get(i, 1));
        let colors: Vec<f64> = (0..texcoord.len()).flat_map(at).collect();
        return Ok(Field::new("texture", 3, FieldValues::F64(colors)));
    }
    if let Some(crate::model::original::Original::Gltf(original)) = shape.original.as_deref() {
        let given = image.map(Picture::open).transpose()?;
        return gltf_parts::colors(shape, original, given.as_ref(), &name());
    }
    if shape.format() != Some(crate::Format::Obj) {
        return Err(match shape.field("texcoord") {
            None => TextureError::NoCoordinates { shape: name() },
            Some(_) => TextureError::NoTexture { shape: name() },
        });
    }
    let bytes = read_file(path, limits, Progress::none())
        .and_then(|bytes| decompress(bytes, limits, Progress::none()));
    let bytes = bytes.map_err(|e| e.in_file(path))?;
    let corners = Corners::parse(&bytes, shape.n_vertices());
    if corners.places.is_empty() {
        return Err(TextureError::NoCoordinates { shape: name() });
    }
    let pictures: Vec<Option<Picture>> = if let Some(image) = image {
        vec![Some(Picture::open(image)?)]
    } else {
        let folder = path.parent().unwrap_or(Path::new(""));
        let materials = read_materials(folder, &corners.libraries, limits)?;
        let open =
            |name: &String| materials.get(name).map(|file| Picture::open(&folder.join(file))).transpose();
        corners.materials.iter().map(open).collect::<Result<_, _>>()?
    };
    if pictures.iter().all(Option::is_none) {
        return Err(TextureError::NoTexture { shape: name() });
    }
    let mut sums = vec![[0.0; 3]; shape.n_vertices()];
    let mut counts = vec![0_u32; shape.n_vertices()];
    for place in &corners.places {
        let picture = if image.is_some() { &pictures[0] } else { &pictures[place.material as usize] };
        if let Some(picture) = picture {
            let [u, v] = corners.texcoords[place.texcoord as usize];
            let color = picture.sample(u, v);
            let x = place.vertex as usize;
            counts[x] += 1;
            sums[x].iter_mut().zip(color).for_each(|(sum, c)| *sum += c);
        }
    }
    // 0/0 is the NaN of a vertex without a place.
    let mean = sums.iter().zip(&counts).flat_map(|(sum, &n)| sum.map(|s| s / f64::from(n)));
    Ok(Field::new("texture", 3, FieldValues::F64(mean.collect())))
}
