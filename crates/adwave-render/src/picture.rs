//! Picture in memory, with PNG and JPEG output.

use crate::error::RenderError;
use crate::params::check_size;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, RgbaImage, imageops};

/// Picture with rows from the top. Each pixel has red, green, blue and alpha; the colors are not premultiplied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Pixels row by row, 4 × width × height bytes.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// Creates a picture of one color: red, green, blue and alpha.
    ///
    /// # Errors
    ///
    /// A picture without pixels, or with more than [`crate::MAX_PIXELS`].
    pub fn blank(width: u32, height: u32, color: [u8; 4]) -> Result<Self, RenderError> {
        check_size(width, height)?;
        Ok(Self { width, height, rgba: color.repeat(width as usize * height as usize) })
    }

    /// Returns the pixel in column `x` and row `y`, both from 0 and inside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        let at = 4 * (y as usize * self.width as usize + x as usize);
        [0, 1, 2, 3].map(|c| self.rgba[at + c])
    }

    /// Encodes the picture as PNG, without an alpha channel if it is opaque. Equal pictures give equal bytes.
    ///
    /// # Errors
    ///
    /// [`RenderError::Encoding`], which cannot occur for a picture of a valid size.
    pub fn png(&self) -> Result<Vec<u8>, RenderError> {
        let mut bytes = Vec::new();
        let opaque = self.rgba.chunks_exact(4).all(|p| p[3] == 255);
        let encoder =
            PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive);
        let written = if opaque {
            encoder.write_image(&self.rgb([255; 3]), self.width, self.height, ExtendedColorType::Rgb8)
        } else {
            encoder.write_image(&self.rgba, self.width, self.height, ExtendedColorType::Rgba8)
        };
        written.map_err(|e| RenderError::Encoding { reason: e.to_string() })?;
        Ok(bytes)
    }

    /// Encodes the picture as JPEG of `quality` 1 to 100; transparent pixels become white.
    ///
    /// # Errors
    ///
    /// [`RenderError::Encoding`].
    pub fn jpeg(&self, quality: u8) -> Result<Vec<u8>, RenderError> {
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, quality.clamp(1, 100))
            .write_image(&self.rgb([255; 3]), self.width, self.height, ExtendedColorType::Rgb8)
            .map_err(|e| RenderError::Encoding { reason: e.to_string() })?;
        Ok(bytes)
    }

    /// Returns red, green and blue of each pixel, blended over a background; 3 × width × height bytes.
    pub fn rgb(&self, background: [u8; 3]) -> Vec<u8> {
        let over = |p: &[u8]| {
            let alpha = u32::from(p[3]);
            [0, 1, 2].map(|c| {
                ((u32::from(p[c]) * alpha + u32::from(background[c]) * (255 - alpha) + 127) / 255) as u8
            })
        };
        self.rgba.chunks_exact(4).flat_map(over).collect()
    }

    /// Resizes the picture, with smoothing if it becomes smaller.
    ///
    /// # Errors
    ///
    /// A size without pixels, or with more than [`crate::MAX_PIXELS`].
    pub fn resize(&self, width: u32, height: u32) -> Result<Self, RenderError> {
        check_size(width, height)?;
        let resized = imageops::resize(&self.image(), width, height, imageops::FilterType::CatmullRom);
        Ok(Self { width, height, rgba: resized.into_raw() })
    }

    /// Crops the picture to a region.
    ///
    /// # Errors
    ///
    /// A region that is empty or extends beyond the picture.
    pub fn crop(&self, left: u32, top: u32, width: u32, height: u32) -> Result<Self, RenderError> {
        let inside = |from: u32, size: u32, whole: u32| {
            size > 0 && from.checked_add(size).is_some_and(|to| to <= whole)
        };
        if !inside(left, width, self.width) || !inside(top, height, self.height) {
            let (of_width, of_height) = (self.width, self.height);
            return Err(RenderError::BadRegion { left, top, width, height, of_width, of_height });
        }
        let row = |y: u32| {
            let at = 4 * (y as usize * self.width as usize + left as usize);
            &self.rgba[at..at + 4 * width as usize]
        };
        Ok(Self { width, height, rgba: (top..top + height).flat_map(row).copied().collect() })
    }

    /// Crops the borders that have the color of the upper left corner, except for `margin` pixels on each side.
    #[must_use]
    pub fn trim_borders(&self, margin: u32) -> Self {
        let empty = self.pixel(0, 0);
        let (mut low, mut high) = ([u32::MAX; 2], [0; 2]);
        for y in 0..self.height {
            for x in (0..self.width).filter(|&x| self.pixel(x, y) != empty) {
                low = [low[0].min(x), low[1].min(y)];
                high = [high[0].max(x), high[1].max(y)];
            }
        }
        if low[0] > high[0] {
            return self.clone();
        }
        let low = low.map(|c| c.saturating_sub(margin));
        let high = [(high[0] + margin).min(self.width - 1), (high[1] + margin).min(self.height - 1)];
        self.crop(low[0], low[1], high[0] - low[0] + 1, high[1] - low[1] + 1)
            .expect("the region lies inside the picture")
    }

    /// Copies another picture into this one, with its upper left corner at (`left`, `top`); pixels outside are clipped.
    pub fn place(&mut self, other: &Self, left: u32, top: u32) {
        if left >= self.width || top >= self.height {
            return;
        }
        let n = 4 * other.width.min(self.width - left) as usize;
        for y in 0..other.height.min(self.height - top) {
            let to = 4 * ((top + y) as usize * self.width as usize + left as usize);
            let from = 4 * y as usize * other.width as usize;
            self.rgba[to..to + n].copy_from_slice(&other.rgba[from..from + n]);
        }
    }

    /// Blends `color` into a pixel with a coverage in [0, 1]; positions outside the picture are ignored.
    pub(crate) fn blend(&mut self, x: i64, y: i64, color: [u8; 3], coverage: f32) {
        if x < 0 || y < 0 || x >= i64::from(self.width) || y >= i64::from(self.height) || coverage <= 0.0 {
            return;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        let pixel = &mut self.rgba[at..at + 4];
        let (over, under) = (coverage.min(1.0), f32::from(pixel[3]) / 255.0);
        let alpha = over + under * (1.0 - over);
        for c in 0..3 {
            let mixed = f32::from(color[c]) * over + f32::from(pixel[c]) * under * (1.0 - over);
            pixel[c] = (mixed / alpha).round() as u8;
        }
        pixel[3] = (alpha * 255.0).round() as u8;
    }

    fn image(&self) -> RgbaImage {
        RgbaImage::from_raw(self.width, self.height, self.rgba.clone()).expect("4 bytes per pixel")
    }
}
