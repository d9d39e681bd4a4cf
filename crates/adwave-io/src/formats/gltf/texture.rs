//! The pictures of a glTF at its vertices.

use crate::formats::gltf::document::Document;
use crate::formats::gltf::json::Json;
use crate::formats::gltf::read::{Part, field_name};
use crate::formats::gltf::update::GltfSource;
use crate::model::texture::{TextureError, TextureRequest};
use crate::texture::picture::Picture;
use crate::{Field, FieldValues, ShapeFile};

/// The base colors: those of pictures where a part has texture coordinates, else of the material alone; NaN without a material.
/// `given` takes the place of all pictures. Factors of the material multiply, as the format has it.
pub(crate) fn colors(shape: &ShapeFile, request: &TextureRequest<'_>) -> Result<Field, TextureError> {
    let Some(original) = shape.source::<GltfSource>() else { return Err(request.missing(shape)) };
    let given = request.image.map(Picture::open).transpose()?;
    let name = request.name();
    let mut colors = vec![f64::NAN; 3 * shape.n_vertices()];
    let mut found = Found::Nothing;
    for part in &original.parts {
        for &k in &part.primitives {
            let painted = Painted::of(&original.document, part, k, given.as_ref(), &name)?;
            found = found.max(painted.found());
            painted.paint(shape, part, &mut colors[3 * part.first..][..3 * part.positions.count]);
        }
    }
    match found {
        Found::Picture => Ok(Field::new("texture", 3, FieldValues::F64(colors))),
        Found::Coordinates => Err(TextureError::NoTexture { shape: name }),
        Found::Nothing => Err(TextureError::NoCoordinates { shape: name }),
    }
}

/// What a primitive has of a texture, the whole of it last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Found {
    Nothing,
    Coordinates,
    Picture,
}

/// Paint of a primitive.
enum Painted<'a> {
    Nothing(Found),
    Factor([f64; 3]),
    Picture(PictureOf<'a>, [f64; 3], &'a str),
}

enum PictureOf<'a> {
    Given(&'a Picture),
    Own(Picture),
}

impl<'a> Painted<'a> {
    fn of(
        document: &'a Document,
        part: &'a Part,
        k: usize,
        given: Option<&'a Picture>,
        name: &str,
    ) -> Result<Self, TextureError> {
        let json = &document.json;
        let primitive =
            json.list_of("meshes").get(part.instance.mesh).and_then(|mesh| mesh.list_of("primitives").get(k));
        let material =
            primitive.and_then(|p| p.index_of("material")).and_then(|m| json.list_of("materials").get(m));
        let metallic = material.and_then(|m| m.get("pbrMetallicRoughness"));
        let factor = metallic
            .and_then(|m| m.numbers::<4>("baseColorFactor"))
            .map_or([1.0; 3], |[r, g, b, _]| [r, g, b]);
        let texture = metallic.and_then(|m| m.get("baseColorTexture"));
        let set = texture.and_then(|t| t.index_of("texCoord")).unwrap_or(0);
        let wanted = format!("TEXCOORD_{set}");
        let places = part.attributes.iter().find(|(name, _)| *name == wanted).map(|(name, _)| name.as_str());
        let Some(places) = places else {
            return Ok(if metallic.is_some() { Self::Factor(factor) } else { Self::Nothing(Found::Nothing) });
        };
        if let Some(picture) = given {
            return Ok(Self::Picture(PictureOf::Given(picture), factor, places));
        }
        let image = texture
            .and_then(|t| t.index_of("index"))
            .and_then(|t| json.list_of("textures").get(t))
            .and_then(|t| t.index_of("source"));
        let Some(image) = image else {
            return Ok(if metallic.is_some() {
                Self::Factor(factor)
            } else {
                Self::Nothing(Found::Coordinates)
            });
        };
        let bytes = picture_bytes(document, image);
        let picture =
            Picture::of_bytes(bytes.as_deref().unwrap_or_default(), &format!("{name}, picture {image}"))?;
        Ok(Self::Picture(PictureOf::Own(picture), factor, places))
    }

    fn found(&self) -> Found {
        match self {
            Self::Nothing(found) => *found,
            Self::Factor(_) => Found::Coordinates,
            Self::Picture(..) => Found::Picture,
        }
    }

    fn paint(&self, shape: &ShapeFile, part: &Part, colors: &mut [f64]) {
        match self {
            Self::Nothing(_) => {}
            Self::Factor(factor) => {
                for color in colors.as_chunks_mut::<3>().0 {
                    *color = *factor;
                }
            }
            Self::Picture(picture, factor, places) => {
                let Some(places) = shape.field(&field_name(places)).filter(|field| field.n_channels == 2)
                else {
                    return;
                };
                let picture = match picture {
                    PictureOf::Given(picture) => picture,
                    PictureOf::Own(picture) => picture,
                };
                for (i, color) in colors.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                    let [u, v] = [0, 1].map(|c| places.get(part.first + i, c));
                    let sampled = picture.sample(u, v);
                    *color = std::array::from_fn(|c| sampled[c] * factor[c]);
                }
            }
        }
    }
}

/// Bytes of a picture: from a buffer, from the text, or from an external file.
fn picture_bytes(document: &Document, k: usize) -> Option<Vec<u8>> {
    if let Some(bytes) = document.pictures.get(k).and_then(Option::as_ref) {
        return Some(bytes.clone());
    }
    let image = document.json.list_of("images").get(k)?;
    if let Some(view) = image.index_of("bufferView") {
        let view = document.json.list_of("bufferViews").get(view)?;
        let of = |key: &str| view.index_of(key).unwrap_or(0);
        let bytes = document.buffer(of("buffer"))?;
        return bytes
            .get(of("byteOffset")..of("byteOffset").checked_add(of("byteLength"))?)
            .map(<[u8]>::to_vec);
    }
    let (_, encoded) = image.get("uri").and_then(Json::text)?.split_once(";base64,")?;
    base64::Engine::decode(&base64::engine::general_purpose::STANDARD, encoded).ok()
}
