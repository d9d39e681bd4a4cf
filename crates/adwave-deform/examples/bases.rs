//! Detail put onto a bent base and onto a simplified mesh, measured against the exact results.
//!
//! `bases SHAPE SIMPLER`. The shape is bent on a cylinder by 69° along y, its base S_J alike; detail on the bent base is
//! compared with the bent shape. Detail of the shape on the simpler mesh is compared with the shape itself.

use adwave::bands::Schedule;
use adwave::shape::{Mesh, Shape};
use adwave::vector::{norm, subtract};
use adwave::{Decomposer, Progress};
use adwave_deform::{base_points, transfer, transfer_decomposer, with_base};
use adwave_io::{ReadLimits, read_path};
use adwave_register::ClosestPointSearch;

/// Angle of the bend.
const BEND: f64 = 69.0;

/// Widths of the bases in % of the diagonal.
const WIDTHS: [f64; 3] = [3.0, 4.3, 6.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [shape, simpler] = &args[..] else { return Err("bases SHAPE SIMPLER".into()) };
    let shape = Decomposer::new(&read_mesh(shape)?);
    let points = shape.points().unwrap_or_default();
    let diagonal = shape.diagonal();
    let (low, high) = points.iter().fold(([f64::MAX; 3], [f64::MIN; 3]), |(low, high), p| {
        ([0, 1, 2].map(|c| low[c].min(p[c])), [0, 1, 2].map(|c| high[c].max(p[c])))
    });
    let middle = [0, 1, 2].map(|c| 0.5 * (low[c] + high[c]));
    let radius = (high[1] - low[1]) / BEND.to_radians();
    let bend = |p: &[f64; 3]| {
        let (angle, away) = ((p[1] - middle[1]) / radius, radius + p[0] - middle[0]);
        [middle[0] + away * angle.cos() - radius, middle[1] + away * angle.sin(), p[2]]
    };
    let percent = |errors: Vec<f64>| {
        100.0 / diagonal * (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
    };
    let wanted: Vec<[f64; 3]> = points.iter().map(bend).collect();
    println!("| σ_J, % | error on a bent base, % of the diagonal | without frames |\n|---|---|---|");
    for width in WIDTHS {
        let step = shape.operator().step_length();
        let schedule = Schedule::lengths(&[width / 100.0 * shape.extent()], step)?;
        let base = base_points(&shape, &schedule, Progress::none())?;
        let bent: Vec<[f64; 3]> = base.iter().map(bend).collect();
        let found = with_base(&shape, &schedule, &bent, Progress::none())?;
        let with_frames = found.iter().zip(&wanted).map(|(p, q)| norm(&subtract(p, q))).collect();
        let plain = (0..points.len())
            .map(|v| norm(&[0, 1, 2].map(|c| bent[v][c] + points[v][c] - base[v][c] - wanted[v][c])))
            .collect();
        println!("| {width} | {:.3} | {:.3} |", percent(with_frames), percent(plain));
    }
    let (from, onto) =
        (transfer_decomposer(shape.geometry().unwrap().shape(), Progress::none())?, read_mesh(simpler)?);
    let onto = transfer_decomposer(&onto, Progress::none())?;
    let surface = ClosestPointSearch::new(from.geometry().unwrap(), Progress::none())?.ok_or("no surface")?;
    println!(
        "| width, % | distance of the simpler mesh with its detail from the shape, rms, % | of the simpler mesh's base |\n|---|---|---|"
    );
    for width in [1.0, 2.0, 4.3] {
        let sigma = width / 100.0 * onto.extent();
        let found = transfer(&from, &onto, Some(sigma), None, Progress::none())?;
        let away = |points: &[[f64; 3]]| -> Vec<f64> {
            points.iter().map(|p| norm(&subtract(p, &surface.closest(p).point))).collect()
        };
        let schedule = Schedule::lengths(&[sigma], onto.operator().step_length())?;
        let base = base_points(&onto, &schedule, Progress::none())?;
        println!("| {width} | {:.4} | {:.3} |", percent(away(&found.points)), percent(away(&base)));
    }
    Ok(())
}

/// A mesh from a file.
fn read_mesh(path: &str) -> Result<Shape, Box<dyn std::error::Error>> {
    let file = read_path(path.as_ref(), &ReadLimits::default())?;
    Ok(Shape::Mesh(Mesh::new(file.points().to_vec(), file.faces().clone())?))
}
