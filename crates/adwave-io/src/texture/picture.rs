//! Picture with interpolation between pixels.

use std::io::Cursor;
use std::path::Path;

use crate::error::kind_of_io;
use crate::model::texture::TextureError;
use crate::text::one_line;
use adwave::ErrorKind;
use image::{ImageError, ImageReader, RgbImage};

/// Largest width or height of a picture.
const LARGEST_SIDE: u32 = 1 << 16;
/// Largest decoded size of a picture in bytes.
const MAX_BYTES: u64 = 1 << 30;

/// A texture.
pub(crate) struct Picture {
    pixels: RgbImage,
}

impl Picture {
    pub(crate) fn open(path: &Path) -> Result<Self, TextureError> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| TextureError::Picture {
            path: name.clone(),
            cause: one_line(&e),
            kind: kind_of_io(&e),
        })?;
        Self::of_bytes(&bytes, &name)
    }

    /// A picture in memory, called so in errors.
    pub(crate) fn of_bytes(bytes: &[u8], name: &str) -> Result<Self, TextureError> {
        let wrong = |kind, cause: String| TextureError::Picture { path: name.to_owned(), cause, kind };
        let mut reader = ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|e| wrong(kind_of_io(&e), one_line(&e)))?;
        let mut limits = image::Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(LARGEST_SIDE), Some(LARGEST_SIDE));
        limits.max_alloc = Some(MAX_BYTES);
        reader.limits(limits);
        let pixels = reader.decode().map_err(|e| wrong(kind_of(&e), one_line(&e)))?.into_rgb8();
        if pixels.width() == 0 || pixels.height() == 0 {
            return Err(wrong(ErrorKind::Input, "the picture has no pixels".into()));
        }
        Ok(Self { pixels })
    }

    /// The color at (u, v), channels in [0, 1]; NaN where u or v is not finite.
    pub(crate) fn sample(&self, u: f64, v: f64) -> [f64; 3] {
        if !(u.is_finite() && v.is_finite()) {
            return [f64::NAN; 3];
        }
        let (width, height) = self.pixels.dimensions();
        // Pixel centers are half a pixel inside.
        let x = u.rem_euclid(1.0) * f64::from(width) - 0.5;
        let y = (1.0 - v).rem_euclid(1.0) * f64::from(height) - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let wrap = |i: f64, n: u32| (i as i64).rem_euclid(i64::from(n)) as u32;
        let pixel =
            |dx: f64, dy: f64| self.pixels.get_pixel(wrap(left + dx, width), wrap(top + dy, height)).0;
        let (fx, fy) = (x - left, y - top);
        let (a, b, c, d) = (pixel(0.0, 0.0), pixel(1.0, 0.0), pixel(0.0, 1.0), pixel(1.0, 1.0));
        std::array::from_fn(|k| {
            let [a, b, c, d] = [a, b, c, d].map(|p| f64::from(p[k]) / 255.0);
            (a * (1.0 - fx) + b * fx) * (1.0 - fy) + (c * (1.0 - fx) + d * fx) * fy
        })
    }
}

fn kind_of(error: &ImageError) -> ErrorKind {
    match error {
        // The picture is truncated.
        ImageError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => ErrorKind::Input,
        ImageError::IoError(e) => kind_of_io(e),
        ImageError::Limits(_) => ErrorKind::Memory,
        _ => ErrorKind::Input,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn pixels_lie_where_the_coordinates_say() {
        // Red and green above, blue and white below.
        let mut pixels = RgbImage::new(2, 2);
        let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        for (k, color) in colors.into_iter().enumerate() {
            pixels.put_pixel(k as u32 % 2, k as u32 / 2, Rgb(color));
        }
        let picture = Picture { pixels };
        assert_eq!(picture.sample(0.25, 0.75), [1.0, 0.0, 0.0]);
        assert_eq!(picture.sample(0.75, 0.75), [0.0, 1.0, 0.0]);
        assert_eq!(picture.sample(0.25, 0.25), [0.0, 0.0, 1.0]);
        assert_eq!(picture.sample(0.5, 0.5), [0.5, 0.5, 0.5]);
        assert_eq!(picture.sample(1.25, -0.25), picture.sample(0.25, 0.75));
        assert!(picture.sample(f64::NAN, 0.0)[0].is_nan());
        assert!(picture.sample(1e300, -1e300).iter().all(|c| (0.0..=1.0).contains(c)));
    }
}
