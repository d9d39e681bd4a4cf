//! Triangles, discs and balls to samples, by a depth buffer, one strip of rows at a time; samples to pixels.

use crate::vector::{Direction, Vec3, dot_f32, facing_unit};
use rayon::prelude::*;

/// Discs whose normal points less towards the viewer than this are seen from their edge.
const STEEPEST: f32 = 0.05;

/// The radius in samples of the dot that a disc seen from its edge becomes.
const EDGE: f64 = 1.2;

/// Rows of pixels in a strip.
const STRIP: usize = 16;

/// What is drawn, in samples: x to the right, y down, z towards the viewer. Normals are right, up, towards the viewer.
#[derive(Debug)]
pub(crate) enum Primitive {
    /// Corners, their normals, their colours.
    Triangle { corners: [Vec3; 3], normals: [Direction; 3], colors: [Color; 3] },
    /// A disc round a point that lies in the plane of its normal; a ball where there is none.
    Disc { center: Vec3, radius: f64, normal: Direction, color: Color },
    /// A ball.
    Ball { center: Vec3, radius: f64, color: Color },
}

/// Red, green and blue, 0 to 255.
pub(crate) type Color = [f32; 3];

impl Primitive {
    /// The rows that it may touch.
    fn rows(&self) -> (f64, f64) {
        match self {
            Self::Triangle { corners, .. } => {
                let y = corners.map(|c| c[1]);
                (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]))
            }
            Self::Disc { center, radius, .. } | Self::Ball { center, radius, .. } => {
                (center[1] - radius, center[1] + radius)
            }
        }
    }
}

/// One pixel before it is lit from all around: means over its samples that show something.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pixel {
    /// Lit colour.
    pub(crate) color: Color,
    /// The part of its samples that show something.
    pub(crate) coverage: f32,
    /// Depth in pixels, towards the viewer.
    pub(crate) depth: f32,
    /// Unit normal.
    pub(crate) normal: Direction,
}

/// Draws primitives into `width` × `height` pixels of `samples`² samples. Where two lie at one depth, the earlier shows.
/// O(primitives + samples touched); the same result on any number of threads.
pub(crate) fn draw(primitives: &[Primitive], width: usize, height: usize, samples: usize) -> Vec<Pixel> {
    let n_strips = height.div_ceil(STRIP);
    let rows_of_strip = (STRIP * samples) as f64;
    let mut of_strip: Vec<Vec<u32>> = vec![Vec::new(); n_strips];
    for (k, primitive) in primitives.iter().enumerate() {
        let (low, high) = primitive.rows();
        if !(low.is_finite() && high.is_finite()) || high < 0.0 {
            continue;
        }
        let first = (low.max(0.0) / rows_of_strip) as usize;
        let last = (high / rows_of_strip) as usize;
        for strip in of_strip.iter_mut().take((last + 1).min(n_strips)).skip(first) {
            strip.push(k as u32);
        }
    }
    let mut pixels = vec![Pixel::default(); width * height];
    pixels.par_chunks_mut(width * STRIP).zip(of_strip.par_iter()).enumerate().for_each(|(s, (out, list))| {
        if list.is_empty() {
            return;
        }
        let mut strip = Strip::new(width * samples, (out.len() / width) * samples, s * STRIP * samples);
        for &k in list {
            strip.draw(&primitives[k as usize]);
        }
        strip.resolve(out, width, samples);
    });
    pixels
}

/// The samples of a strip of rows.
struct Strip {
    width: usize,
    height: usize,
    top: usize,
    depth: Vec<f32>,
    normal: Vec<Direction>,
    color: Vec<Color>,
}

impl Strip {
    fn new(width: usize, height: usize, top: usize) -> Self {
        let n = width * height;
        Self {
            width,
            height,
            top,
            depth: vec![f32::NEG_INFINITY; n],
            normal: vec![[0.0; 3]; n],
            color: vec![[0.0; 3]; n],
        }
    }

    fn put(&mut self, x: usize, y: usize, depth: f64, look: impl FnOnce() -> (Direction, Color)) {
        let at = y * self.width + x;
        if depth as f32 > self.depth[at] {
            self.depth[at] = depth as f32;
            (self.normal[at], self.color[at]) = look();
        }
    }

    fn columns(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        range(low, high, self.width)
    }

    fn rows(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        range(low - self.top as f64, high - self.top as f64, self.height)
    }

    fn draw(&mut self, primitive: &Primitive) {
        match primitive {
            Primitive::Triangle { corners, normals, colors } => self.triangle(corners, normals, colors),
            Primitive::Disc { center, radius, normal, color } if normal[2].abs() > STEEPEST => {
                let slope = [-normal[0] / normal[2], normal[1] / normal[2]].map(f64::from);
                let plane = |dx: f64, dy: f64, _| {
                    let height = slope[0] * dx + slope[1] * dy;
                    // Seen at an angle a disc is an ellipse; its middle is always seen.
                    let inside = dx * dx + dy * dy + height * height <= (radius * radius).max(1.0);
                    inside.then_some((height, *normal))
                };
                self.round(center, *radius, plane, *color);
            }
            // A disc from its edge has no area; a dot keeps it from vanishing.
            Primitive::Disc { center, normal, color, .. } if *normal != [0.0; 3] => {
                self.round(center, EDGE, |_, _, _| Some((0.0, *normal)), *color);
            }
            Primitive::Disc { center, radius, color, .. } | Primitive::Ball { center, radius, color } => {
                let ball = |dx: f64, dy: f64, out: f64| Some((out, [dx as f32, -dy as f32, out as f32]));
                self.round(center, *radius, ball, *color);
            }
        }
    }

    fn triangle(&mut self, corners: &[Vec3; 3], normals: &[Direction; 3], colors: &[Color; 3]) {
        let [a, b, c] = corners;
        let turn = |p: &Vec3, q: &Vec3, x: f64, y: f64| (p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x);
        let area = turn(b, c, a[0], a[1]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let least = |k: usize| a[k].min(b[k]).min(c[k]);
        let most = |k: usize| a[k].max(b[k]).max(c[k]);
        for y in self.rows(least(1), most(1)) {
            for x in self.columns(least(0), most(0)) {
                let (px, py) = (x as f64 + 0.5, (y + self.top) as f64 + 0.5);
                let u = turn(b, c, px, py) / area;
                let v = turn(c, a, px, py) / area;
                let w = 1.0 - u - v;
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    self.put(x, y, u * a[2] + v * b[2] + w * c[2], || {
                        let (u, v, w) = (u as f32, v as f32, w as f32);
                        let mix = |of: &[[f32; 3]; 3]| {
                            [0, 1, 2].map(|k| u * of[0][k] + v * of[1][k] + w * of[2][k])
                        };
                        (mix(normals), mix(colors))
                    });
                }
            }
        }
    }

    /// What is seen inside a circle: `look` gives the height above the centre and the normal at an offset, if anything.
    fn round(
        &mut self,
        center: &Vec3,
        radius: f64,
        look: impl Fn(f64, f64, f64) -> Option<(f64, Direction)>,
        color: Color,
    ) {
        for y in self.rows(center[1] - radius, center[1] + radius) {
            for x in self.columns(center[0] - radius, center[0] + radius) {
                let (dx, dy) = (x as f64 + 0.5 - center[0], (y + self.top) as f64 + 0.5 - center[1]);
                let square = radius * radius - dx * dx - dy * dy;
                if square >= 0.0
                    && let Some((height, normal)) = look(dx, dy, square.sqrt())
                {
                    self.put(x, y, center[2] + height, || (normal, color));
                }
            }
        }
    }

    fn resolve(&self, pixels: &mut [Pixel], width: usize, samples: usize) {
        let each = 1.0 / (samples * samples) as f32;
        for (at, pixel) in pixels.iter_mut().enumerate() {
            let (x, y) = (at % width, at / width);
            let mut n_seen = 0.0;
            for k in 0..samples * samples {
                let sample = (y * samples + k / samples) * self.width + x * samples + k % samples;
                if self.depth[sample] == f32::NEG_INFINITY {
                    continue;
                }
                let normal = facing(&self.normal[sample]);
                let lit = light(&self.color[sample], &normal);
                n_seen += 1.0;
                for c in 0..3 {
                    pixel.color[c] += lit[c];
                    pixel.normal[c] += normal[c];
                }
                pixel.depth += self.depth[sample] / samples as f32;
            }
            if n_seen > 0.0 {
                pixel.color = pixel.color.map(|c| c / n_seen);
                pixel.depth /= n_seen;
                pixel.normal = facing_unit(&pixel.normal);
                pixel.coverage = n_seen * each;
            }
        }
    }
}

/// The samples whose middles may lie between two places, of so many.
fn range(low: f64, high: f64, n: usize) -> std::ops::Range<usize> {
    let bound = |v: f64| v.clamp(0.0, n as f64) as usize;
    bound((low - 0.5).floor())..bound((high + 0.5).ceil())
}

/// The unit normal of the side that is seen: a surface has two.
fn facing(normal: &Direction) -> Direction {
    let normal = facing_unit(normal);
    if normal[2] < 0.0 { normal.map(|c| -c) } else { normal }
}

/// A colour under a strong light from the upper left and a weak one from the right, a little of it from everywhere.
fn light(color: &Color, normal: &Direction) -> Color {
    const KEY: Direction = [-0.483, 0.580, 0.656];
    const FILL: Direction = [0.814, 0.116, 0.569];
    /// Halfway between the strong light and the viewer.
    const SHINE: Direction = [-0.265, 0.319, 0.910];
    let key = dot_f32(normal, &KEY).max(0.0);
    let fill = dot_f32(normal, &FILL).max(0.0);
    let sky = 0.5 + 0.5 * normal[1];
    let shade = 0.29 + 0.10 * sky + 0.66 * key + 0.20 * fill;
    let shine = 16.0 * dot_f32(normal, &SHINE).max(0.0).powi(24);
    color.map(|c| (c * shade + shine).min(255.0))
}
