//! Colors of the pictures that an OBJ's materials name.

use std::path::Path;

use adwave::Progress;

use super::materials::read_materials;
use super::texture_corners::Corners;
use crate::files::read::parse_file;
use crate::model::texture::{TextureError, TextureRequest};
use crate::texture::picture::Picture;
use crate::{Field, FieldValues, ShapeFile};

/// The mean color of each vertex over its places in the pictures.
pub(crate) fn colors(shape: &ShapeFile, request: &TextureRequest<'_>) -> Result<Field, TextureError> {
    let TextureRequest { path, image, limits } = *request;
    let corners =
        parse_file(path, limits, Progress::none(), |bytes| Ok(Corners::parse(&bytes, shape.n_vertices())))?;
    if corners.places.is_empty() {
        return Err(TextureError::NoCoordinates { shape: request.name() });
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
        return Err(TextureError::NoTexture { shape: request.name() });
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
