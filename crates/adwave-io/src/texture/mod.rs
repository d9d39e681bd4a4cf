//! Colors of a texture at the vertices of a mesh: files that name their pictures, or any shape with UVs and a picture.

pub(crate) mod picture;

use std::path::Path;

use crate::model::texture::{TextureError, TextureRequest};
use crate::{Field, FieldValues, ReadLimits, ShapeFile};
use picture::Picture;

/// Samples the colors of a texture at the vertices: the field `texture` with the red, green and blue of the picture
/// in [0, 1].
///
/// `image` is the picture; without it the materials of an OBJ (`map_Kd`) or a glTF (`baseColorTexture`) name one for
/// each part. Colors are interpolated between pixels and repeated beyond the edges of the picture; the first row of
/// pixels is at v = 1. A vertex on a seam gets the mean over its texture coordinates; a vertex without texture
/// coordinates gets NaN.
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
