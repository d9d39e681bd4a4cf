//! A picture in memory, and its file.

use crate::error::RenderError;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

/// Pixels in rows from the top, each red, green, blue and alpha (not multiplied in).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// 4 bytes a pixel.
    pub rgba: Vec<u8>,
}

impl Picture {
    /// A picture of one colour.
    pub(crate) fn filled(width: u32, height: u32, color: [u8; 4]) -> Self {
        Self { width, height, rgba: color.repeat(width as usize * height as usize) }
    }

    /// The colour at a pixel.
    ///
    /// # Panics
    ///
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "({x}, {y}) of {}x{}", self.width, self.height);
        let at = 4 * (y as usize * self.width as usize + x as usize);
        self.rgba[at..at + 4].try_into().expect("four bytes")
    }

    /// Lays a colour over a pixel, with a part of 1; nothing outside.
    pub(crate) fn blend(&mut self, x: i64, y: i64, color: [u8; 3], part: f32) {
        if x < 0 || y < 0 || x >= i64::from(self.width) || y >= i64::from(self.height) || part <= 0.0 {
            return;
        }
        let at = 4 * (y as usize * self.width as usize + x as usize);
        let below = f32::from(self.rgba[at + 3]) / 255.0;
        let alpha = part + below * (1.0 - part);
        for (old, new) in self.rgba[at..at + 3].iter_mut().zip(color) {
            let mixed = (f32::from(new) * part + f32::from(*old) * below * (1.0 - part)) / alpha;
            *old = mixed.round() as u8;
        }
        self.rgba[at + 3] = (alpha * 255.0).round() as u8;
    }

    /// Puts a picture into this one; what sticks out is cut off.
    pub(crate) fn put(&mut self, other: &Self, left: u32, top: u32) {
        let n = 4 * other.width.min(self.width.saturating_sub(left)) as usize;
        for y in 0..other.height.min(self.height.saturating_sub(top)) {
            let to = 4 * ((top + y) as usize * self.width as usize + left as usize);
            let from = 4 * (y as usize * other.width as usize);
            self.rgba[to..to + n].copy_from_slice(&other.rgba[from..from + n]);
        }
    }

    /// The bytes of a PNG file; without the channel alpha where every pixel is opaque.
    ///
    /// # Errors
    ///
    /// When it cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>, RenderError> {
        let mut bytes = Vec::new();
        let encoder = PngEncoder::new(&mut bytes);
        let opaque = self.rgba.iter().skip(3).step_by(4).all(|&a| a == 255);
        let written = if opaque {
            let rgb: Vec<u8> = self.rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
            encoder.write_image(&rgb, self.width, self.height, ExtendedColorType::Rgb8)
        } else {
            encoder.write_image(&self.rgba, self.width, self.height, ExtendedColorType::Rgba8)
        };
        written.map_err(|e| RenderError::Encoding { reason: e.to_string() })?;
        Ok(bytes)
    }
}
