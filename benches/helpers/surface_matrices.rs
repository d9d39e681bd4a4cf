//! The matrices of heat on a surface, for other programs: what is in the files that it writes is in the order of the shape.
//!
//! `surface_matrices SHAPE OUT` writes `OUT.mass.npy`, and `OUT.data.npy`, `OUT.indices.npy` and `OUT.indptr.npy`.
use adwave::{Progress, operator::{OperatorKind, OperatorParams, surface_diffusion, Semigroup}, shape::{PreparedGeometry, WeldMode}};

fn main() {
    let path = std::env::args().nth(1).unwrap();
    let shape = { let f = adwave_io::read_path(std::path::Path::new(&path), &adwave_io::ReadLimits::default()).unwrap(); f.to_shape().unwrap() };
    let g = PreparedGeometry::new(&shape, WeldMode::default(), Progress::none()).unwrap();
    let t = std::time::Instant::now();
    let l = adwave::laplacian::Laplacian::new(&g, 10, Progress::none()).unwrap();
    println!("{} flips, covered {}, lengthened {}, {} entries of {} rows, area {} {:?}", l.n_flips(), l.is_covered(), l.lengthened(), l.weights().nnz(), l.areas().len(), l.areas().iter().sum::<f64>(), t.elapsed());
    let mut hist = [0; 12];
    for x in 0..l.areas().len() { hist[l.weights().row(x).0.len().min(11)] += 1; }
    println!("{hist:?}");
    let mut d: Vec<f64> = (0..l.areas().len()).map(|x| l.weights().row(x).1.iter().sum::<f64>() / l.areas()[x]).collect();
    d.sort_by(f64::total_cmp);
    let p = OperatorParams::default().with_kind(OperatorKind::Surface);
    let s = surface_diffusion(&g, &p, Progress::none()).unwrap();
    let tau = s.diffusion.step_length().powi(2) / 4.0;
    for q in [0.01, 0.1, 0.5, 0.9, 0.95, 0.98, 0.99, 0.995, 0.999, 1.0] { println!("{q} {:.3}", tau * d[((d.len() - 1) as f64 * q) as usize]); }
    let d = &s.diffusion;
    let n = d.n_vertices();
    let mut seen = vec![false; n]; let mut comps = 0;
    for x0 in 0..n { if seen[x0] { continue; } comps += 1; let mut st = vec![x0]; seen[x0] = true; while let Some(x) = st.pop() { for (&y, &w) in d.row(x).0.iter().zip(d.row(x).1) { if w > 1e-9 && !seen[y as usize] { seen[y as usize] = true; st.push(y as usize); } } } }
    println!("components {comps}");
    let pts = g.points();
    let tr = adwave::bands::Transform::new(d.clone(), &adwave::bands::BandsParams::default()).unwrap();
    let sched = adwave::bands::Schedule::dyadic(8).unwrap();
    let mut bands = vec![vec![0.0; 3*n]; 8];
    let mut outs: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
    tr.wavelets_into(pts.as_flattened(), 3, &sched, &mut outs, Progress::none()).unwrap();
    println!("{:?}", bands.iter().map(|b| b.iter().map(|v| v*v).sum::<f64>().sqrt()).collect::<Vec<_>>());
    let Semigroup::Heat { rate: r0 } = s.diffusion.semigroup() else { panic!() };
    // Taylor by powers: exp(-r(1-P))f by uniformisation
    let mut f = pts.as_flattened().to_vec(); let mut g2 = vec![0.0; 3*n]; let mut prev = f.clone();
    for j in 0..8 { let steps = if j == 0 { 1 } else { 1 << (j-1) }; for _ in 0..steps { let mut term = f.clone(); let mut acc: Vec<f64> = term.iter().map(|v| v*(-r0).exp()).collect(); let mut c = (-r0).exp(); for k in 1..80 { adwave::sparse::apply(d, &term, &mut g2, 3); std::mem::swap(&mut term, &mut g2); c *= r0 / k as f64; for (a, t) in acc.iter_mut().zip(&term) { *a += c*t; } } f = acc; }
      println!("{j} {:?}", f.iter().zip(&prev).map(|(a,b)| (a-b)*(a-b)).sum::<f64>().sqrt()); prev = f.clone(); }
    let Semigroup::Heat { rate } = s.diffusion.semigroup() else { panic!() };
    println!("rate {rate} added {:e} {:?}", s.added_mass, t.elapsed());
}
#[allow(dead_code)]
fn dbg() {}
