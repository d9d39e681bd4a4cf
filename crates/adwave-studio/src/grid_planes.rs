//! Parts of images and slices of volumes: how they are laid out on the screen, and their values and bands.

use crate::band_edit::BandEdit;
use crate::response::{ApiError, encode_f32};
use adwave_io::GridLayout;
use serde::Serialize;
use std::collections::HashMap;

/// Largest number of values that one response holds: 256 MiB.
const MAX_PLANE_VALUES: usize = 1 << 26;

/// Slice of a volume on the screen, or a whole image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct SliceView {
    pub(crate) name: &'static str,
    /// Axis that is fixed in a slice; `None` for an image.
    pub(crate) fixed: Option<usize>,
    /// Axes that run down and to the right.
    pub(crate) axes: [usize; 2],
    /// True for an axis whose index grows upward, or to the left.
    pub(crate) flips: [bool; 2],
    /// Names of the directions at the left, right, lower and upper edge, such as L, R, P and A; empty without names.
    pub(crate) edges: [&'static str; 4],
}

/// Names of the directions along x, y and z in NIfTI's coordinates, at the lower and the upper end.
const ANATOMICAL: [[&str; 2]; 3] = [["L", "R"], ["P", "A"], ["I", "S"]];

/// Axis of the grid along each axis of space, such that the cosines between them are largest together, and whether its
/// index falls with the coordinate.
fn axes_along_space(layout: &GridLayout) -> [(usize, bool); 3] {
    const ORDERS: [[usize; 3]; 6] = [[2, 1, 0], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [0, 1, 2]];
    let cosine = |axis: usize, c: usize| {
        let step = layout.steps[axis];
        let length = step.iter().map(|d| d * d).sum::<f64>().sqrt();
        if length > 0.0 { step[c] / length } else { 0.0 }
    };
    let fit = |order: &[usize; 3]| (0..3).map(|c| cosine(order[c], c).abs()).sum::<f64>();
    // The first of equals stays.
    let best =
        ORDERS.iter().fold(&ORDERS[0], |best, order| if fit(order) > fit(best) { order } else { best });
    std::array::from_fn(|c| (best[c], cosine(best[c], c) < 0.0))
}

/// Views of an image or a volume. A NIfTI is shown by its affine matrix, with the right of the body on the right. Axes
/// of space point up and to the right otherwise, rows and pages down.
pub(crate) fn slice_views(layout: &GridLayout, is_anatomical: bool) -> Vec<SliceView> {
    if layout.sizes.len() == 3 && is_anatomical {
        let space = axes_along_space(layout);
        let view = |name: &'static str, fixed: usize, up: usize, right: usize| SliceView {
            name,
            fixed: Some(space[fixed].0),
            axes: [space[up].0, space[right].0],
            flips: [!space[up].1, space[right].1],
            edges: [ANATOMICAL[right][0], ANATOMICAL[right][1], ANATOMICAL[up][0], ANATOMICAL[up][1]],
        };
        return vec![view("Axial", 2, 1, 0), view("Coronal", 1, 2, 0), view("Sagittal", 0, 2, 1)];
    }
    let view = |name: &'static str, fixed: Option<usize>, axes: [usize; 2]| {
        let is_of_space = |axis: usize| !matches!(layout.axis_names[axis], "row" | "page" | "column");
        let flips = [is_of_space(axes[0]), false];
        SliceView { name, fixed, axes, flips, edges: [""; 4] }
    };
    if layout.sizes.len() < 3 {
        return vec![view("Image", None, [0, 1])];
    }
    let names: [&'static str; 3] = match layout.axis_names[0] {
        "page" => ["Pages", "Rows", "Columns"],
        _ => ["Slices of z", "Slices of y", "Slices of x"],
    };
    vec![view(names[0], Some(0), [1, 2]), view(names[1], Some(1), [0, 2]), view(names[2], Some(2), [0, 1])]
}

/// Rectangle of an image or of a slice, of which every `step`-th row and column is sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PlaneRequest {
    /// Axes of rows and columns.
    axes: [usize; 2],
    /// First index along each axis of the grid.
    first: Vec<usize>,
    /// Number of rows and columns that are sent.
    sizes: [usize; 2],
    step: usize,
    /// Frame of a series; `None` without frames.
    frame: Option<usize>,
}

impl PlaneRequest {
    /// Parses `axes=A,B&from=R,C&to=R,C&step=S`, with `index=K` for a slice of a volume and `frame=T` for a series of
    /// `n_frames`; all but the axes are optional.
    pub(crate) fn parse(
        query: &HashMap<String, String>,
        layout: &GridLayout,
        n_frames: Option<usize>,
    ) -> Result<Self, ApiError> {
        let pair = |name: &str| -> Result<Option<[usize; 2]>, ApiError> {
            let Some(text) = query.get(name) else { return Ok(None) };
            let numbers = text.split_once(',').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
            numbers.map(Some).ok_or_else(|| {
                ApiError::bad_request(format!("'{name}' needs two whole numbers, such as 0,1, got '{text}'"))
            })
        };
        let number = |name: &str, usual: usize| match query.get(name) {
            None => Ok(usual),
            Some(text) => text
                .parse()
                .map_err(|_| ApiError::bad_request(format!("'{name}' needs a whole number, got '{text}'"))),
        };
        let n_axes = layout.sizes.len();
        let axes = pair("axes")?.unwrap_or([0, 1]);
        if axes[0] == axes[1] || axes.iter().any(|axis| *axis >= n_axes) {
            return Err(ApiError::bad_request(format!(
                "'axes' needs two different axes below {n_axes}, got {},{}",
                axes[0], axes[1]
            )));
        }
        let whole = axes.map(|axis| layout.sizes[axis]);
        let (from, to) = (pair("from")?.unwrap_or([0, 0]), pair("to")?.unwrap_or(whole));
        if (0..2).any(|k| from[k] >= to[k] || to[k] > whole[k]) {
            return Err(ApiError::bad_request(format!(
                "'from' must lie before 'to', and 'to' within {},{}, got {},{} and {},{}",
                whole[0], whole[1], from[0], from[1], to[0], to[1]
            )));
        }
        let step = number("step", 1)?.max(1);
        let mut first = vec![0; n_axes];
        if let Some(fixed) = (0..n_axes).find(|axis| !axes.contains(axis)) {
            let (index, size) = (number("index", layout.sizes[fixed] / 2)?, layout.sizes[fixed]);
            if index >= size {
                return Err(ApiError::bad_request(format!("'index' must be below {size}, got {index}")));
            }
            first[fixed] = index;
        }
        for k in 0..2 {
            first[axes[k]] = from[k];
        }
        let frame = match (n_frames, query.get("frame")) {
            (Some(n), _) => {
                let frame = number("frame", 0)?;
                if frame >= n {
                    return Err(ApiError::bad_request(format!("'frame' must be below {n}, got {frame}")));
                }
                Some(frame)
            }
            (None, Some(text)) => {
                return Err(ApiError::bad_request(format!(
                    "'frame' must be left out for an image or a volume that is no series, got '{text}'"
                )));
            }
            (None, None) => None,
        };
        let sizes = std::array::from_fn(|k| (to[k] - from[k]).div_ceil(step));
        Ok(Self { axes, first, sizes, step, frame })
    }

    /// Index of a place of the plane, counted by rows, among those of the grid.
    fn place(&self, layout: &GridLayout, k: usize) -> usize {
        let at = [k / self.sizes[1], k % self.sizes[1]];
        let mut place = 0;
        for (axis, size) in layout.sizes.iter().enumerate() {
            let moved = self.axes.iter().position(|a| *a == axis).map_or(0, |k| at[k] * self.step);
            place = place * size + self.first[axis] + moved;
        }
        place
    }

    /// Encodes the values and then the bands W_1 … W_J, `f32 × rows × columns × channels` each, with one channel for a
    /// frame of a series. A place without data has NaN, and 0 in the bands.
    pub(crate) fn encode(&self, bands: &BandEdit, layout: &GridLayout) -> Result<Vec<u8>, ApiError> {
        let (signal, levels) = (bands.editor().signal(), &bands.editor().wavelets().levels);
        let n_channels = signal.len() / layout.n_places().max(1);
        let (first, n_sent) = self.frame.map_or((0, n_channels), |frame| (frame, 1));
        let n_places = self.sizes[0] * self.sizes[1];
        let n_values = n_places * n_sent;
        if n_values * (1 + levels.len()) > MAX_PLANE_VALUES {
            let most = MAX_PLANE_VALUES / (1 + levels.len());
            return Err(ApiError::bad_request(format!(
                "a response holds at most {most} values of {} bands, got {n_values}; ask for fewer rows or a larger step",
                levels.len()
            )));
        }
        let places: Vec<usize> = (0..n_places).map(|k| self.place(layout, k)).collect();
        let map = bands.decomposer.vertex_map();
        let is_kept = |place: usize| layout.kept.as_ref().is_none_or(|kept| kept[place]);
        let value = |row: usize, k: usize| row * n_channels + first + k % n_sent;
        let mut content = encode_f32(n_values, |k| {
            let place = places[k / n_sent];
            if is_kept(place) { signal[value(place, k)] as f32 } else { f32::NAN }
        });
        for level in levels {
            content.extend(encode_f32(n_values, |k| level[value(map.welded(places[k / n_sent]), k)] as f32));
        }
        Ok(content)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn query(pairs: &[(&str, &str)]) -> HashMap<String, String> {
        pairs.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
    }

    #[test]
    fn a_slice_names_its_places() {
        let layout = GridLayout::new(&[4, 3, 5], &[1.0; 3]);
        let plane = PlaneRequest::parse(&query(&[("axes", "0,2"), ("index", "1")]), &layout, None).unwrap();
        assert_eq!(plane.sizes, [4, 5]);
        let places: Vec<usize> = (0..20).map(|k| plane.place(&layout, k)).collect();
        let expected: Vec<usize> = (0..4).flat_map(|z| (0..5).map(move |x| 15 * z + 5 + x)).collect();
        assert_eq!(places, expected);
        let part = [("axes", "0,2"), ("index", "1"), ("from", "1,0"), ("to", "4,5"), ("step", "2")];
        let plane = PlaneRequest::parse(&query(&part), &layout, None).unwrap();
        assert_eq!(plane.sizes, [2, 3]);
        let places: Vec<usize> = (0..6).map(|k| plane.place(&layout, k)).collect();
        assert_eq!(places, [20, 22, 24, 50, 52, 54]);
        for (pairs, words) in [
            (&[("axes", "0,0")][..], "two different axes below 3, got 0,0"),
            (&[("axes", "0,3")], "got 0,3"),
            (&[("axes", "x")], "'axes' needs two whole numbers"),
            (&[("index", "5")], "'index' must be below 5, got 5"),
            (&[("to", "5,5")], "within 4,3, got 0,0 and 5,5"),
            (&[("from", "2,2"), ("to", "2,3")], "'from' must lie before 'to'"),
            (&[("frame", "2")], "'frame' must be left out"),
        ] {
            let error = format!("{:?}", PlaneRequest::parse(&query(pairs), &layout, None).unwrap_err());
            assert!(error.contains(words), "{error}");
        }
        let frame = |frame: &str| PlaneRequest::parse(&query(&[("frame", frame)]), &layout, Some(7));
        assert_eq!(frame("6").unwrap().frame, Some(6));
        assert!(format!("{:?}", frame("7").unwrap_err()).contains("'frame' must be below 7, got 7"));
        assert!(format!("{:?}", frame("-1").unwrap_err()).contains("'frame' needs a whole number, got '-1'"));
    }

    #[test]
    fn anatomical_views_follow_the_affine_matrix() {
        // The first stored axis runs from right to left, the second up, the third forward.
        let mut layout = GridLayout::new(&[4, 5, 6], &[1.0; 3]);
        layout.steps = vec![[-1.0, 0.0, 0.1], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
        let [axial, coronal, sagittal] = &slice_views(&layout, true)[..] else { panic!("three views") };
        assert_eq!((axial.fixed, axial.axes, axial.flips), (Some(1), [2, 0], [true, true]));
        assert_eq!(axial.edges, ["L", "R", "P", "A"]);
        assert_eq!((coronal.fixed, coronal.axes, coronal.flips), (Some(2), [1, 0], [true, true]));
        assert_eq!(coronal.edges, ["L", "R", "I", "S"]);
        assert_eq!((sagittal.fixed, sagittal.axes, sagittal.flips), (Some(0), [1, 2], [true, false]));
        assert_eq!(sagittal.edges, ["P", "A", "I", "S"]);
    }

    #[test]
    fn rows_run_down_and_axes_of_space_up() {
        let image = slice_views(&GridLayout::new(&[4, 5], &[1.0; 2]), false);
        assert_eq!((image.len(), image[0].axes, image[0].flips), (1, [0, 1], [false, false]));
        let volume = slice_views(&GridLayout::new(&[4, 5, 6], &[1.0; 3]), false);
        let shown: Vec<_> = volume.iter().map(|v| (v.fixed.unwrap(), v.axes, v.flips)).collect();
        let up = [true, false];
        assert_eq!(shown, [(0, [1, 2], up), (1, [0, 2], up), (2, [0, 1], up)]);
    }
}
