//! Measures the numbers of docs/SUBDIVISION.md and prints its tables.
//!
//! `cargo run --release -p adwave-subdivision --example measurements -- FOLDER MESH`, with a mesh of triangles, and a folder
//! with fsaverage5 as nilearn has it: `white_left.gii.gz` and the fields `sulc_left.gii.gz`, `thick_left.gii.gz` and
//! `curv_left.gii.gz`. Without the files their tables are left out.

use adwave::Progress;
use adwave::shape::{MeshArea, mesh_areas};
use adwave_io::{ReadLimits, read_gifti_fields, read_path};
use adwave_subdivision::{Family, HaarWavelets, Hierarchy, LiftedCoefficients, LiftedWavelets, subdivide};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn Error>>;

const LIFTED: [Family; 3] = [Family::Linear, Family::Butterfly, Family::Loop];
const NONE: fn() -> Progress<'static> = Progress::none;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    stability()?;
    if let Some(folder) = arguments.first() {
        fsaverage(Path::new(folder))?;
    }
    if let Some(file) = arguments.get(1) {
        any_mesh(Path::new(file))?;
    }
    Ok(())
}

/// Points and triangles of a surface.
struct Surface {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    fn read(path: &Path) -> Outcome<Self> {
        let file = read_path(path, &ReadLimits::default())?;
        let triangles = file.faces().triangles().ok_or("the mesh must have triangles")?.to_vec();
        Ok(Self { points: file.points().to_vec(), triangles })
    }

    /// An icosahedron with `n_levels` subdivisions on the unit sphere.
    fn icosphere(n_levels: usize) -> Self {
        let phi = f64::midpoint(1.0, 5.0_f64.sqrt());
        let points = [
            [-1.0, phi, 0.0],
            [1.0, phi, 0.0],
            [-1.0, -phi, 0.0],
            [1.0, -phi, 0.0],
            [0.0, -1.0, phi],
            [0.0, 1.0, phi],
            [0.0, -1.0, -phi],
            [0.0, 1.0, -phi],
            [phi, 0.0, -1.0],
            [phi, 0.0, 1.0],
            [-phi, 0.0, -1.0],
            [-phi, 0.0, 1.0],
        ];
        let triangles = [
            [0, 11, 5],
            [0, 5, 1],
            [0, 1, 7],
            [0, 7, 10],
            [0, 10, 11],
            [1, 5, 9],
            [5, 11, 4],
            [11, 10, 2],
            [10, 7, 6],
            [7, 1, 8],
            [3, 9, 4],
            [3, 4, 2],
            [3, 2, 6],
            [3, 6, 8],
            [3, 8, 9],
            [4, 9, 5],
            [2, 4, 11],
            [6, 2, 10],
            [8, 6, 7],
            [9, 8, 1],
        ];
        let mut surface = Self { points: points.to_vec(), triangles: triangles.to_vec() };
        for _ in 0..n_levels {
            surface = surface.subdivided();
        }
        for p in &mut surface.points {
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            *p = p.map(|x| x / length);
        }
        surface
    }

    fn subdivided(&self) -> Self {
        let finer = subdivide(self.points.len(), &self.triangles);
        let mut points = self.points.clone();
        for [a, b] in finer.parents {
            let (p, q) = (self.points[a as usize], self.points[b as usize]);
            points.push([0, 1, 2].map(|k| f64::midpoint(p[k], q[k])));
        }
        Self { points, triangles: finer.triangles }
    }

    fn areas(&self) -> Vec<f64> {
        mesh_areas(&self.points, &self.triangles, MeshArea::Barycentric)
    }

    fn face_areas(&self) -> Vec<f64> {
        let area = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| self.points[v as usize]);
            let (a, b) = ([0, 1, 2].map(|k| q[k] - p[k]), [0, 1, 2].map(|k| r[k] - p[k]));
            let cross = [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
            0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt()
        };
        self.triangles.iter().map(area).collect()
    }
}

fn stability() -> Outcome<()> {
    let sphere = Surface::icosphere(4);
    let hierarchy = Hierarchy::new(sphere.points.len(), &sphere.triangles, NONE())?;
    println!("Riesz bounds, icosphere of {} vertices, {} levels", sphere.points.len(), hierarchy.n_levels());
    for (name, areas) in [("equal masses", vec![1.0; sphere.points.len()]), ("areas", sphere.areas())] {
        for family in LIFTED {
            let bounds = LiftedWavelets::new(&hierarchy, family, &areas, NONE())?.riesz_bounds(NONE())?;
            let condition = bounds.condition();
            println!("| {family}, {name} | {:.4} | {:.3} | {condition:.2} |", bounds.lower, bounds.upper);
        }
    }
    Ok(())
}

/// Root mean square of a difference by area, divided by the deviation of the field.
fn relative_error(field: &[f64], other: &[f64], areas: &[f64]) -> f64 {
    let d = field.len() / areas.len();
    let total: f64 = areas.iter().sum();
    let (mut error, mut variance) = (0.0, 0.0);
    for c in 0..d {
        let mean = areas.iter().enumerate().map(|(i, a)| a * field[i * d + c]).sum::<f64>() / total;
        for (i, a) in areas.iter().enumerate() {
            error += a * (field[i * d + c] - other[i * d + c]).powi(2);
            variance += a * (field[i * d + c] - mean).powi(2);
        }
    }
    (error / variance).sqrt()
}

fn mean(field: &[f64], areas: &[f64]) -> f64 {
    field.iter().zip(areas).map(|(f, a)| f * a).sum::<f64>() / areas.iter().sum::<f64>()
}

fn kept_errors(
    field: &[f64],
    areas: &[f64],
    coefficients: &LiftedCoefficients,
    synthesize: &dyn Fn(&[f64]) -> Outcome<Vec<f64>>,
) -> Outcome<Vec<f64>> {
    [0.05, 0.1, 0.2]
        .iter()
        .map(|share| Ok(relative_error(field, &synthesize(&coefficients.keep(*share)?.values)?, areas)))
        .collect()
}

fn fsaverage(folder: &Path) -> Outcome<()> {
    let surface = Surface::read(&folder.join("white_left.gii.gz"))?;
    let areas = surface.areas();
    let n = surface.points.len();
    let hierarchy = Hierarchy::new(n, &surface.triangles, NONE())?;
    let fields: Vec<(&str, Vec<f64>)> = ["sulc", "thick", "curv"]
        .into_iter()
        .map(|name| {
            let fields =
                read_gifti_fields(&folder.join(format!("{name}_left.gii.gz")), &ReadLimits::default())?;
            Ok((name, fields.first().ok_or("the file has no field")?.to_f64()))
        })
        .collect::<Outcome<_>>()?;
    println!("\nfsaverage5: {} levels", hierarchy.n_levels());
    for (name, field) in &fields {
        println!("{name}: error/deviation with 5, 10, 20 % of the coefficients");
        for family in LIFTED {
            let wavelets = LiftedWavelets::new(&hierarchy, family, &areas, NONE())?;
            let coefficients = wavelets.analyze(field, 1, NONE())?;
            let synthesize = |c: &[f64]| Ok(wavelets.synthesize(c, 1, NONE())?);
            println!("| {family} | {:.3?}", kept_errors(field, &areas, &coefficients, &synthesize)?);
        }
        let irregular = LiftedWavelets::new_irregular(&surface.points, &surface.triangles, &areas, NONE())?;
        let coefficients = irregular.analyze(field, 1, NONE())?;
        let synthesize = |c: &[f64]| Ok(irregular.synthesize(c, 1, NONE())?);
        let errors = kept_errors(field, &areas, &coefficients, &synthesize)?;
        println!(
            "| irregular, {} levels to {} | {errors:.3?}",
            irregular.n_levels(),
            irregular.n_vertices_at(irregular.n_levels())
        );
        let face_areas = surface.face_areas();
        let haar = HaarWavelets::new(&hierarchy, &face_areas)?;
        let on_faces: Vec<f64> = surface
            .triangles
            .iter()
            .map(|t| t.iter().map(|&v| field[v as usize]).sum::<f64>() / 3.0)
            .collect();
        let coefficients = haar.analyze(&on_faces, 1, NONE())?;
        let synthesize = |c: &[f64]| Ok(haar.synthesize(c, 1, NONE())?);
        println!("| haar | {:.3?}", kept_errors(&on_faces, &face_areas, &coefficients, &synthesize)?);
        coarser_by_one(&hierarchy, field, &areas)?;
    }
    large(folder)
}

/// To fsaverage4 and back.
fn coarser_by_one(hierarchy: &Hierarchy, field: &[f64], areas: &[f64]) -> Outcome<()> {
    let wavelets = LiftedWavelets::new(hierarchy, Family::Butterfly, areas, NONE())?;
    let coarse = wavelets.coarse_field(field, 1, 1, NONE())?;
    let back = wavelets.fine_field(&coarse, 1, 1, NONE())?;
    let taken: Vec<f64> = hierarchy.vertices(1)?.iter().map(|&v| field[v as usize]).collect();
    let back_taken = wavelets.fine_field(&taken, 1, 1, NONE())?;
    println!(
        "to fsaverage4 and back: {:.3}, mean shifted by {:.1e}; vertices taken: {:.3}, mean shifted by {:.1e}",
        relative_error(field, &back, areas),
        mean(&back, areas) - mean(field, areas),
        relative_error(field, &back_taken, areas),
        mean(&back_taken, areas) - mean(field, areas),
    );
    Ok(())
}

/// Times at the size of fsaverage7.
fn large(folder: &Path) -> Outcome<()> {
    let surface = Surface::read(&folder.join("white_left.gii.gz"))?.subdivided().subdivided();
    let (n, areas) = (surface.points.len(), surface.areas());
    let mut best = f64::INFINITY;
    let mut hierarchy = Hierarchy::new(n, &surface.triangles, NONE())?;
    for _ in 0..7 {
        let start = Instant::now();
        hierarchy = Hierarchy::new(n, &surface.triangles, NONE())?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("\n{n} vertices: {} levels found in {:.1} ms", hierarchy.n_levels(), 1e3 * best);
    let field: Vec<f64> = surface.points.iter().map(|p| (0.1 * p[0]).sin() + 0.01 * p[1]).collect();
    for family in LIFTED {
        let start = Instant::now();
        let wavelets = LiftedWavelets::new(&hierarchy, family, &areas, NONE())?;
        let prepared = start.elapsed().as_secs_f64();
        let (mut forth, mut back) = (f64::INFINITY, f64::INFINITY);
        let mut error = 0.0_f64;
        for _ in 0..15 {
            let start = Instant::now();
            let coefficients = wavelets.analyze(&field, 1, NONE())?;
            forth = forth.min(start.elapsed().as_secs_f64());
            let start = Instant::now();
            let again = wavelets.synthesize(&coefficients.values, 1, NONE())?;
            back = back.min(start.elapsed().as_secs_f64());
            error = again.iter().zip(&field).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        }
        let coarse = wavelets.coarse_field(&field, 1, wavelets.n_levels(), NONE())?;
        let flat = wavelets.fine_field(&coarse, 1, wavelets.n_levels(), NONE())?;
        println!(
            "| {family} | prepared {:.0} ms | analysis {:.2} ms | synthesis {:.2} ms | reconstruction {error:.1e} | mean {:.1e}",
            1e3 * prepared,
            1e3 * forth,
            1e3 * back,
            mean(&flat, &areas) - mean(&field, &areas)
        );
    }
    Ok(())
}

fn any_mesh(path: &Path) -> Outcome<()> {
    let surface = Surface::read(path)?;
    let areas = surface.areas();
    let start = Instant::now();
    let wavelets = LiftedWavelets::new_irregular(&surface.points, &surface.triangles, &areas, NONE())?;
    let prepared = start.elapsed().as_secs_f64();
    let field = surface.points.as_flattened();
    let coefficients = wavelets.analyze(field, 3, NONE())?;
    let synthesize = |c: &[f64]| Ok(wavelets.synthesize(c, 3, NONE())?);
    let again = synthesize(&coefficients.values)?;
    let error = again.iter().zip(field).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!(
        "\n{}: {} vertices, {} levels to {}, prepared in {prepared:.2} s, reconstruction {error:.1e}; 5, 10, 20 %: {:.5?}",
        path.display(),
        surface.points.len(),
        wavelets.n_levels(),
        wavelets.n_vertices_at(wavelets.n_levels()),
        kept_errors(field, &areas, &coefficients, &synthesize)?
    );
    Ok(())
}
