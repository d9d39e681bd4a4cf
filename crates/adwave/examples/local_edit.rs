//! Edits a shape in one place and takes it back: `cargo run --example local_edit [-- IN]`.
//!
//! An editor keeps the bands, so that each edit costs what it changes, not another transform.

use adwave::bands::Schedule;
use adwave::filter::{Preset, WeightedLayer, displacement};
use adwave::region::{Length, Location, Region};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape};
use adwave::{ChangedVertices, Decomposer, Progress};
use adwave_io::{ReadLimits, read_path};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let shape = if let Some(path) = std::env::args().nth(1) {
        read_path(Path::new(&path), &ReadLimits::default())?.into_shape()?
    } else {
        let knot = Sample::from_name("knot", Some(5000))?;
        Shape::Mesh(Mesh::new(knot.points, knot.faces)?)
    };
    let points = shape.points().ok_or("a graph has no coordinates to edit")?;
    let decomposer = Decomposer::new(&shape);
    let schedule = Schedule::dyadic(8)?;
    let mut editor = decomposer.request(points.as_flattened(), 3, &schedule).editor()?;

    // A ball along the surface round vertex 0; its weights fall softly to 0.
    let ball =
        Region::Ball { center: Location::Vertex(0), radius: Length::PercentOfDiagonal(10.0), falloff: None };
    let weights = ball.weights(decomposer.metric(), &|_| None, &[], Progress::none())?;
    let touched = editor.push_layer(WeightedLayer { gains: Preset::Suppress.gains(8), weights })?;
    if let ChangedVertices::Listed(touched) = &touched {
        println!("the ball holds {} vertices of {}", touched.len(), points.len());
    }
    let moved = |edited: &[f64]| displacement(points, edited.as_chunks().0).max;
    println!("smoothed: no vertex moved more than {:.4}", moved(editor.edited()));

    // Other gains for the same ball: fine to coarse, 1 keeps a band.
    editor.set_gains(1, &[1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0])?;
    println!("coarse bands doubled: no vertex moved more than {:.4}", moved(editor.edited()));

    // Undo: without its layer every value is back to the last bit.
    editor.remove_layer(1)?;
    assert_eq!(editor.edited(), points.as_flattened());
    println!("undone: no vertex moved more than {}", moved(editor.edited()));
    Ok(())
}
