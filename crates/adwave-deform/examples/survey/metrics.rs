//! Measures of a deformation of a mesh.

use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::shape::enclosed_volume;
use adwave::vector::{cross, dot, norm, subtract, unit};
use adwave_deform::nearest_turn;
use std::collections::HashMap;

/// Measures of one deformed mesh.
pub(crate) struct Measures {
    pub(crate) strain_rms: f64,
    pub(crate) strain_99: f64,
    pub(crate) dihedral: f64,
    pub(crate) folds: usize,
    pub(crate) crossing: usize,
    /// Relative change of the volume; `None` for an open mesh.
    pub(crate) volume: Option<f64>,
    pub(crate) detail: f64,
}

type Points<'a> = &'a [[f64; 3]];

/// Measures `after` against `before`.
pub(crate) fn measure(decomposer: &Decomposer, schedule: &Schedule, after: Points<'_>) -> Measures {
    let Some(mesh) = decomposer.geometry().unwrap().shape().as_mesh() else { panic!("a mesh") };
    let (before, triangles) = (mesh.points(), mesh.faces().triangles().expect("triangles").to_vec());
    let edges = edges(&triangles);
    let length = |p: Points<'_>, a: u32, b: u32| norm(&subtract(&p[a as usize], &p[b as usize]));
    let mut strains: Vec<f64> =
        edges.keys().map(|&(a, b)| (length(after, a, b) / length(before, a, b) - 1.0).abs()).collect();
    strains.sort_by(f64::total_cmp);
    let angles: Vec<(f64, f64)> = edges
        .values()
        .filter(|faces| faces.len() == 2)
        .map(|f| (dihedral(before, &triangles, f), dihedral(after, &triangles, f)))
        .collect();
    let squares: f64 = angles.iter().map(|(a, b)| (b - a) * (b - a)).sum();
    let open = edges.values().any(|faces| faces.len() != 2);
    let volume = |p: Points<'_>| enclosed_volume(p, &triangles);
    Measures {
        strain_rms: (strains.iter().map(|s| s * s).sum::<f64>() / strains.len() as f64).sqrt(),
        strain_99: strains[strains.len() * 99 / 100],
        dihedral: (squares / angles.len() as f64).sqrt().to_degrees(),
        folds: angles.iter().filter(|(a, b)| a.abs() < 1.5 && b.abs() > 2.6).count(),
        crossing: crossing_triangles(after, &triangles),
        volume: (!open).then(|| volume(after) / volume(before) - 1.0),
        detail: detail_error(decomposer, schedule, after),
    }
}

fn edges(triangles: &[[u32; 3]]) -> HashMap<(u32, u32), Vec<usize>> {
    let mut edges: HashMap<_, Vec<usize>> = HashMap::new();
    for (f, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            edges.entry((a.min(b), a.max(b))).or_default().push(f);
        }
    }
    edges
}

fn normal(p: Points<'_>, t: &[u32; 3]) -> [f64; 3] {
    let at = |k: usize| &p[t[k] as usize];
    unit(&cross(&subtract(at(1), at(0)), &subtract(at(2), at(0)))).unwrap_or_default()
}

/// Angle between the normals of two triangles.
fn dihedral(p: Points<'_>, triangles: &[[u32; 3]], faces: &[usize]) -> f64 {
    let (n, m) = (normal(p, &triangles[faces[0]]), normal(p, &triangles[faces[1]]));
    norm(&cross(&n, &m)).atan2(dot(&n, &m))
}

/// Details of the result against the turned details of the original, over their size: rms of `|d′ − R d| / |d|` with R
/// from the neighbors on the coarse shapes.
fn detail_error(decomposer: &Decomposer, schedule: &Schedule, after: Points<'_>) -> f64 {
    let before = decomposer.points().expect("positions");
    let details = |p: Points<'_>| -> Vec<[f64; 3]> {
        let request = decomposer.request(p.as_flattened(), 3, schedule);
        let (sum, _) = request.weighted(&vec![1.0; schedule.n_levels()]).expect("bands");
        sum.as_chunks().0.to_vec()
    };
    let (d, e) = (details(before), details(after));
    let map = decomposer.vertex_map();
    let base = |p: Points<'_>, d: Points<'_>| -> Vec<[f64; 3]> {
        let smooth: Vec<[f64; 3]> = p.iter().zip(d).map(|(p, d)| subtract(p, d)).collect();
        map.positions(&smooth)
    };
    let (s, t) = (base(before, &d), base(after, &e));
    let (mut error, mut size) = (0.0, 0.0);
    for v in 0..before.len() {
        let x = map.welded(v);
        let frame = nearest_turn(
            decomposer
                .neighbors()
                .row(x)
                .iter()
                .map(|&y| (subtract(&s[y as usize], &s[x]), subtract(&t[y as usize], &t[x]))),
        );
        let turned = frame.apply(&d[v]);
        error += dot(&subtract(&e[v], &turned), &subtract(&e[v], &turned));
        size += dot(&d[v], &d[v]);
    }
    (error / size).sqrt()
}

/// Number of triangles that cross another without sharing a corner.
fn crossing_triangles(p: Points<'_>, triangles: &[[u32; 3]]) -> usize {
    let corner = |f: usize, k: usize| &p[triangles[f][k] as usize];
    let mut mean = 0.0;
    for f in 0..triangles.len() {
        mean += norm(&subtract(corner(f, 1), corner(f, 0))) / triangles.len() as f64;
    }
    let flat = FLAT * mean * mean * mean;
    let cell = |c: f64| (c / (2.0 * mean)).floor() as i64;
    let mut grid: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let span = |f: usize, c: usize| {
        let v = [0, 1, 2].map(|k| corner(f, k)[c]);
        (cell(v[0].min(v[1]).min(v[2])), cell(v[0].max(v[1]).max(v[2])))
    };
    for f in 0..triangles.len() {
        let (x, y, z) = (span(f, 0), span(f, 1), span(f, 2));
        for i in x.0..=x.1 {
            for j in y.0..=y.1 {
                for k in z.0..=z.1 {
                    grid.entry([i, j, k]).or_default().push(f);
                }
            }
        }
    }
    let mut crosses = vec![false; triangles.len()];
    for faces in grid.values() {
        for (n, &f) in faces.iter().enumerate() {
            for &g in &faces[n + 1..] {
                if triangles[f].iter().any(|c| triangles[g].contains(c)) || (crosses[f] && crosses[g]) {
                    continue;
                }
                let cuts = |f: usize, g: usize| {
                    (0..3).any(|k| {
                        pierces(corner(f, k), corner(f, (k + 1) % 3), [0, 1, 2].map(|k| corner(g, k)), flat)
                    })
                };
                if cuts(f, g) || cuts(g, f) {
                    (crosses[f], crosses[g]) = (true, true);
                }
            }
        }
    }
    crosses.iter().filter(|c| **c).count()
}

/// Volume, relative to the cubed mean edge, below which four points count as lying in a plane: parts that move rigidly stay
/// flat up to rounding.
const FLAT: f64 = 1e-9;

/// True if a segment goes through a triangle.
fn pierces(a: &[f64; 3], b: &[f64; 3], t: [&[f64; 3]; 3], flat: f64) -> bool {
    let volume = |p: &[f64; 3], q: &[f64; 3], r: &[f64; 3], s: &[f64; 3]| {
        dot(&subtract(q, p), &cross(&subtract(r, p), &subtract(s, p)))
    };
    let (u, v) = (volume(a, t[0], t[1], t[2]), volume(b, t[0], t[1], t[2]));
    if u * v >= 0.0 || u.abs().min(v.abs()) < flat {
        return false;
    }
    let s = [0, 1, 2].map(|k| volume(a, b, t[k], t[(k + 1) % 3]));
    s.iter().all(|c| *c > 0.0) || s.iter().all(|c| *c < 0.0)
}
