//! Images and slices of volumes as flat meshes, or as reliefs.

use crate::error::CliError;
use crate::global::Global;
use crate::output::{count, note};
use crate::resolve::shape::Input;
use adwave_io::{GridLayout, LengthUnit};
use adwave_render::Ball;
use adwave_report::shape_report::{FlatMesh, SubjectGrid};

/// Most places that are drawn along an axis: beyond it a picture has several places in each of its pixels.
pub(crate) const MOST_PLACES: usize = 2048;
/// Most places that are drawn along an axis in the smaller pictures of a page.
const MOST_PLACES_OF_PAGE: usize = 700;
/// Gap between the slices of a volume, as a share of its longest axis.
const GAP: f64 = 0.05;

/// An image, or the three middle slices of a volume side by side, as a mesh in the plane z = 0: columns run to the
/// right, rows down, in the units of the grid.
pub(crate) struct FlatGrid {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Place of the grid at each point.
    places: Vec<u32>,
}

/// One rectangle of places.
struct Slice<'a> {
    layout: &'a GridLayout,
    /// Axes that run down and to the right.
    axes: [usize; 2],
    /// The place in its upper left corner.
    first: usize,
    /// Distance of its left side from that of the sheet.
    left: f64,
}

impl FlatGrid {
    /// The sheet of a grid of two or three axes.
    pub(crate) fn new(
        layout: &GridLayout,
        name: &str,
        most_places: usize,
        global: &Global<'_>,
    ) -> Result<Self, CliError> {
        let (sizes, spacings) = (&layout.sizes, &layout.spacings);
        if sizes.len() < 2 {
            return Err(CliError::Input(format!(
                "{name}: a picture needs an image or a volume, and this is a sequence; transform -o bands.npz writes its bands \
                 for a chart"
            )));
        }
        let step = sizes.iter().max().map_or(1, |size| size.div_ceil(most_places));
        if step > 1 {
            let most = count(most_places, "place", "places");
            note(global, &format!("{name} has more than {most} along an axis: one of {step} is drawn"));
        }
        let mut sheet = Self { points: Vec::new(), triangles: Vec::new(), places: Vec::new() };
        if sizes.len() == 2 {
            sheet.add(&Slice { layout, axes: [0, 1], first: 0, left: 0.0 }, step);
            return Ok(sheet);
        }
        let length = |axis: usize| (sizes[axis] - 1) as f64 * spacings[axis];
        let gap = GAP * (0..3).map(length).fold(0.0, f64::max);
        let mut left = 0.0;
        // As the axes are stored, the first slice shows the last two axes: z is fixed, then y, then x.
        for fixed in 0..3 {
            let axes = [usize::from(fixed == 0), if fixed == 2 { 1 } else { 2 }];
            let first = sizes[fixed] / 2 * stride(sizes, fixed);
            sheet.add(&Slice { layout, axes, first, left }, step);
            left += length(axes[1]) + gap;
        }
        Ok(sheet)
    }

    fn add(&mut self, slice: &Slice<'_>, step: usize) {
        let Slice { layout, axes, first, left } = *slice;
        let (sizes, spacings) = (&layout.sizes, &layout.spacings);
        let [n_down, n_right] = axes.map(|axis| sizes[axis].div_ceil(step));
        let is_up = points_up(layout, axes[0]);
        let base = self.points.len() as u32;
        for i in 0..n_down {
            for j in 0..n_right {
                let [row, column] = [i * step, j * step];
                let place = first + row * stride(sizes, axes[0]) + column * stride(sizes, axes[1]);
                let height = row as f64 * spacings[axes[0]];
                let y = if is_up { height } else { -height };
                self.points.push([left + column as f64 * spacings[axes[1]], y, 0.0]);
                self.places.push(place as u32);
            }
        }
        let corner = |i: usize, j: usize| base + (i * n_right + j) as u32;
        for i in 1..n_down {
            for j in 1..n_right {
                let [a, b, c, d] = [corner(i - 1, j - 1), corner(i - 1, j), corner(i, j - 1), corner(i, j)];
                self.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
    }

    pub(crate) fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Values of the places at the points that are drawn.
    pub(crate) fn spread<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.places.iter().map(|&place| values[place as usize]).collect()
    }

    /// The sheet of an image or a volume for a report; `None` for a sequence or a shape.
    pub(crate) fn new_for_page(input: &Input, global: &Global<'_>) -> Result<Option<Self>, CliError> {
        let layout = input.file.grid().filter(|layout| layout.sizes.len() > 1);
        layout.map(|layout| Self::new(layout, &input.name, MOST_PLACES_OF_PAGE, global)).transpose()
    }

    /// Lifts the points by `factor` times the values of their places, and drops triangles at places without a value.
    pub(crate) fn raise(&mut self, values: &[f64], factor: f64) {
        for (point, &place) in self.points.iter_mut().zip(&self.places) {
            point[2] = factor * values[place as usize];
        }
        let points = &self.points;
        self.triangles.retain(|triangle| triangle.iter().all(|&x| points[x as usize][2].is_finite()));
        for point in self.points.iter_mut().filter(|point| !point[2].is_finite()) {
            point[2] = 0.0;
        }
    }
}

/// Axes of an image or a volume for a report, with its sheet; `None` for a shape.
pub(crate) fn subject_grid<'a>(input: &'a Input, sheet: Option<&'a FlatGrid>) -> Option<SubjectGrid<'a>> {
    let layout = input.file.grid()?;
    let sheet = sheet.map(|sheet| FlatMesh {
        points: &sheet.points,
        triangles: &sheet.triangles,
        places: &sheet.places,
    });
    let unit = match input.file.length_unit().map(LengthUnit::name) {
        Some("millimeter") => "mm",
        Some("meter") => "m",
        Some("micron") => "µm",
        Some(name) => name,
        None => "units of the spacing",
    };
    let GridLayout { axis_names, sizes, spacings, .. } = layout;
    Some(SubjectGrid {
        kind: input.kind_name(),
        words: input.row_words(),
        axis_names,
        sizes,
        spacings,
        unit,
        sheet,
    })
}

/// A ball at a position of the file, on the sheet of an image.
pub(crate) fn ball_on_sheet(layout: &GridLayout, ball: Ball) -> Ball {
    let along = |axis: usize| {
        let step = layout.steps[axis];
        let (mut dot, mut square) = (0.0, 0.0);
        for ((d, c), origin) in step.iter().zip(ball.center).zip(layout.origin) {
            dot += d * (c - origin);
            square += d * d;
        }
        dot / square * layout.spacings[axis]
    };
    let y = if points_up(layout, 0) { along(0) } else { -along(0) };
    Ball { center: [along(1), y, 0.0], ..ball }
}

/// True if a sheet shows the axis from the bottom to the top: axes of space point up, rows of an image down.
fn points_up(layout: &GridLayout, axis: usize) -> bool {
    layout.axis_names[axis] != "row"
}

/// Distance along an axis between places in the order of the values.
fn stride(sizes: &[usize], axis: usize) -> usize {
    sizes[axis + 1..].iter().product()
}
