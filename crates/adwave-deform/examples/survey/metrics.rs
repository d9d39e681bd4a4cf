//! Measures of a deformation of a mesh.

use adwave::bands::Schedule;
use adwave::shape::enclosed_volume;
use adwave::vector::{cross, dot, norm, subtract, unit};
use adwave::{Decomposer, Progress};
use adwave_deform::{nearest_turn, new_crossings};
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
        crossing: new_crossings(decomposer, after, Progress::none()).expect("a mesh").n_pairs,
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
