//! Colors of a texture at the vertices of a mesh: files that name their pictures, or any shape with UVs and a picture.

pub(crate) mod picture;

use std::path::Path;

use crate::model::texture::{TextureError, TextureRequest};
use crate::{Field, FieldValues, ReadLimits, ShapeFile};
use picture::Picture;

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
    if let (Some(texcoord), Some(image)) = (shape.field("texcoord").filter(|f| f.n_channels >= 2), image) {
        let picture = Picture::open(image)?;
        let at = |i: usize| picture.sample(texcoord.get(i, 0), texcoord.get(i, 1));
        let colors: Vec<f64> = (0..texcoord.len()).flat_map(at).collect();
        return Ok(Field::new("texture", 3, FieldValues::F64(colors)));
    }
    let request = TextureRequest { path, image, limits };
    match shape.format().and_then(|format| format.descriptor().texture) {
        Some(sample) => sample(shape, &request),
        None => Err(request.missing(shape)),
    }
}
