//! scratch
mod shapes;
use adwave::bands::*;
use adwave::operator::*;
use adwave::shape::*;
use adwave::*;
use std::time::Instant;

fn main() {
    let path = std::env::args().nth(1).expect("path");
    let mesh = shapes::Triangles::from_obj(path.as_ref()).unwrap().subdivided().subdivided();
    let shape = mesh.into_shape();
    let t = Instant::now();
    let params = OperatorParams::default();
    let domain = Domain::new(&shape, params.weld);
    println!("domain {:?} n {}", t.elapsed(), domain.n_vertices());
    let t = Instant::now();
    let diffusion = Diffusion::new(local_operator(&shape, &domain, &params));
    println!("operator {:?} step {}", t.elapsed(), diffusion.step_length());
    let signal = domain.points.as_flattened().to_vec();
    let acc: f64 = std::env::var("ACC").ok().and_then(|v| v.parse().ok()).unwrap_or(1e-5);
    let levels: usize = std::env::var("J").ok().and_then(|v| v.parse().ok()).unwrap_or(8);
    let schedule = Schedule::dyadic(levels).unwrap();
    let t = Instant::now();
    let transform = Transform::new(&diffusion, &BandsParams::default().with_accuracy(acc)).unwrap();
    println!(
        "prepare {:?} working {} B/vertex",
        t.elapsed(),
        transform.working_bytes(3) / domain.n_vertices() as u64
    );
    let mut outs: Vec<Vec<f64>> = (0..levels).map(|_| vec![0.0; signal.len()]).collect();
    let mut best = f64::INFINITY;
    let mut info = None;
    for _ in 0..std::env::var("REPS").ok().and_then(|v| v.parse().ok()).unwrap_or(7) {
        let mut refs: Vec<&mut [f64]> = outs.iter_mut().map(|o| o.as_mut_slice()).collect();
        let t = Instant::now();
        info = Some(transform.wavelets_into(&signal, 3, &schedule, &mut refs, Progress::none()).unwrap());
        best = best.min(t.elapsed().as_secs_f64());
    }
    println!("J {levels} acc {acc} best {:.1} ms {:?}", best * 1e3, info.unwrap());
    if std::env::var("REF").is_ok() {
        let p = Transform::new(&diffusion, &BandsParams::default().with_engine(Engine::Powers)).unwrap();
        let mut exact: Vec<Vec<f64>> = (0..levels).map(|_| vec![0.0; signal.len()]).collect();
        let mut refs: Vec<&mut [f64]> = exact.iter_mut().map(|o| o.as_mut_slice()).collect();
        let t = Instant::now();
        p.wavelets_into(&signal, 3, &schedule, &mut refs, Progress::none()).unwrap();
        println!("powers {:?}", t.elapsed());
        for (a, b) in outs.iter().zip(&exact) {
            let e: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
            let s: f64 = b.iter().map(|b| b * b).sum();
            println!("{:.2e}", (e / s).sqrt());
        }
        let t = Instant::now();
        let bands = transform
            .decompose(&domain.weld, shape.points().unwrap().as_flattened(), 3, &schedule, Progress::none())
            .unwrap();
        println!("decompose {:?} {}", t.elapsed(), bands.wavelet.len());
    }
}
