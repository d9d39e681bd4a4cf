//! Shape prepared for one picture: projected primitives with normals and colors.

use crate::camera::Camera;
use crate::color_range::ColorScale;
use crate::normals::corner_normals;
use crate::occlusion::SurfaceKind;
use crate::params::RenderParams;
use crate::raster::{Corner, Disc, PixelBox, TileSamples, Triangle};
use crate::render::PreparedSurface;
use crate::shade::{CLAY, GLOSSY, Gloss, MATTE, reflect, to_linear};
use crate::surface::Paint;
use crate::vector::Direction;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of tabulated colors of a map.
const MAP_STEPS: usize = 2048;

/// Largest distance of a value from the color range, in widths of the range. Values beyond it are clamped, so that
/// interpolation does not overflow.
const FAR_OUT: f64 = 1e4;

/// Linear color at each point of the surface.
enum Pigment {
    Plain([f32; 3]),
    Colors(Vec<[f32; 3]>),
    /// Position of each vertex's value in the color map, and the colors of the map; the last color represents missing
    /// values.
    Field(Vec<f32>, Vec<[f32; 3]>),
}

impl Pigment {
    fn new(paint: &Paint, scale: Option<&ColorScale>) -> Self {
        match (paint, scale) {
            (Paint::Field(field), Some(scale)) => {
                let place = |v: &f64| scale.position(*v).clamp(-FAR_OUT, FAR_OUT) as f32;
                let map = (0..=MAP_STEPS).map(|k| scale.map.color(k as f64 / MAP_STEPS as f64));
                let table = map.chain([scale.map.color(f64::NAN)]).map(to_linear).collect();
                Self::Field(field.values.iter().map(place).collect(), table)
            }
            (Paint::Colors(colors), _) => Self::Colors(colors.iter().map(|c| to_linear(*c)).collect()),
            (Paint::Plain(color), _) => Self::Plain(to_linear(*color)),
            (Paint::Field(_), None) => Self::Plain([0.5; 3]),
        }
    }

    fn color(&self, vertices: [u32; 3], weights: [f32; 3]) -> [f32; 3] {
        match self {
            Self::Plain(color) => *color,
            Self::Colors(colors) => {
                let [a, b, c] = vertices.map(|v| colors[v as usize]);
                [0, 1, 2].map(|k| weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k])
            }
            Self::Field(places, table) => {
                let t = vertices.map(|v| places[v as usize]);
                let mixed = weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
                // A vertex without a value turns only its own third of the triangle gray.
                let place = if mixed.is_nan() { t[heaviest(weights)] } else { mixed };
                table[if place.is_nan() {
                    MAP_STEPS + 1
                } else {
                    (place.clamp(0.0, 1.0) * MAP_STEPS as f32).round() as usize
                }]
            }
        }
    }
}

fn heaviest(w: [f32; 3]) -> usize {
    if w[0] >= w[1] && w[0] >= w[2] {
        0
    } else if w[1] >= w[2] {
        1
    } else {
        2
    }
}

/// Color and normal of a sample.
pub(crate) struct ShadedSample {
    /// Linear color.
    pub(crate) color: [f32; 3],
    pub(crate) normal: Direction,
}

enum Body<'a> {
    Mesh {
        triangles: &'a [[u32; 3]],
        corners: Vec<Corner>,
        normals: Vec<Direction>,
        normals_of: Vec<[u32; 3]>,
    },
    Cloud(Vec<Disc>),
}

/// Primitives of a picture, by number: first those of the surface, then the balls.
pub(crate) struct Scene<'a> {
    body: Body<'a>,
    pigment: Pigment,
    balls: Vec<(Disc, [f32; 3])>,
    gloss: Gloss,
    perspective: bool,
    samples: usize,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(
        prepared: &PreparedSurface<'a>,
        camera: &Camera,
        scale: Option<&ColorScale>,
        params: &RenderParams,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let PreparedSurface { surface, balls, splats, .. } = prepared;
        let samples = f64::from(params.samples);
        let direction = |n: &[f64; 3]| camera.rotate(n).map(|c| c as f32);
        let disc = |center: &[f64; 3], radius: f64, normal| {
            let p = camera.project(center);
            let (radius, near_per_radius) = camera.radius(center, radius);
            let [x, y, radius] = [p.x, p.y, radius].map(|c| (c * samples) as f32);
            Disc { x, y, near: p.near as f32, radius, near_per_radius: near_per_radius as f32, normal }
        };
        let body = if let Some(splats) = splats {
            let place = |(k, p): (usize, &[f64; 3])| {
                let n = direction(&splats.normals[k]);
                let n = if n[2] < 0.0 { n.map(|c| -c) } else { n };
                disc(p, splats.radii[k], Some(if n == [0.0; 3] { [0.0, 0.0, 1.0] } else { n }))
            };
            Body::Cloud(surface.points.par_iter().enumerate().map(place).collect())
        } else {
            let found = corner_normals(surface.points, surface.triangles, params.crease_angle, progress)?;
            let project = |p: &[f64; 3]| {
                let p = camera.project(p);
                Corner::new(p.x * samples, p.y * samples, p.near)
            };
            Body::Mesh {
                triangles: surface.triangles,
                corners: surface.points.par_iter().map(project).collect(),
                normals: found.normals.par_iter().map(direction).collect(),
                normals_of: found.of,
            }
        };
        progress.check()?;
        Ok(Self {
            body,
            pigment: Pigment::new(&surface.paint, scale),
            balls: balls.iter().map(|b| (disc(&b.center, b.radius, None), to_linear(b.color))).collect(),
            gloss: if matches!(surface.paint, Paint::Plain(_)) { CLAY } else { MATTE },
            perspective: camera.is_perspective(),
            samples: params.samples as usize,
        })
    }

    fn n_of_body(&self) -> usize {
        match &self.body {
            Body::Mesh { triangles, .. } => triangles.len(),
            Body::Cloud(discs) => discs.len(),
        }
    }

    pub(crate) fn n_primitives(&self) -> usize {
        self.n_of_body() + self.balls.len()
    }

    pub(crate) fn kind(&self) -> SurfaceKind {
        match self.body {
            Body::Mesh { .. } => SurfaceKind::Mesh,
            Body::Cloud(_) => SurfaceKind::Cloud,
        }
    }

    pub(crate) fn pixel_box(&self, k: usize) -> PixelBox {
        let samples = self.samples as i32;
        match (&self.body, k.checked_sub(self.n_of_body())) {
            (_, Some(ball)) => self.balls[ball].0.pixel_box(samples),
            (Body::Mesh { triangles, corners, .. }, None) => {
                triangle(&triangles[k], corners).pixel_box(samples)
            }
            (Body::Cloud(discs), None) => discs[k].pixel_box(samples),
        }
    }

    pub(crate) fn draw(&self, k: u32, tile: &mut TileSamples) {
        match (&self.body, (k as usize).checked_sub(self.n_of_body())) {
            (_, Some(ball)) => self.balls[ball].0.draw(k, tile),
            (Body::Mesh { triangles, corners, .. }, None) => {
                triangle(&triangles[k as usize], corners).draw(k, tile);
            }
            (Body::Cloud(discs), None) => discs[k as usize].draw(k, tile),
        }
    }

    /// Shades primitive `k` at a sample position.
    pub(crate) fn shade(&self, k: u32, x: f32, y: f32) -> ShadedSample {
        let (color, normal, gloss) = match (&self.body, (k as usize).checked_sub(self.n_of_body())) {
            (_, Some(ball)) => {
                let (disc, color) = &self.balls[ball];
                (*color, disc.normal_at(x, y), GLOSSY)
            }
            (Body::Mesh { triangles, corners, normals, normals_of }, None) => {
                let vertices = triangles[k as usize];
                let shape = triangle(&vertices, corners);
                let weights = shape.weights(x, y, self.perspective);
                let [a, b, c] = normals_of[k as usize].map(|n| normals[n as usize]);
                let sign = if shape.faces_viewer() { 1.0 } else { -1.0 };
                let mix = |i: usize| sign * (weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i]);
                (self.pigment.color(vertices, weights), [0, 1, 2].map(mix), self.gloss)
            }
            (Body::Cloud(discs), None) => {
                (self.pigment.color([k; 3], [1.0, 0.0, 0.0]), discs[k as usize].normal_at(x, y), self.gloss)
            }
        };
        let normal = crate::vector::facing_unit(&normal);
        ShadedSample { color: reflect(normal, color, gloss), normal }
    }
}

fn triangle(vertices: &[u32; 3], corners: &[Corner]) -> Triangle {
    Triangle(vertices.map(|v| corners[v as usize]))
}
