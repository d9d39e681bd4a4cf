//! Laws of resampling between registered spheres, and a dense reference of its weights.

use adwave::Progress;
use adwave::vector::{cross, dot, norm};
use adwave_register::{Keep, Sphere, SphereError, SphereResampler, Zeros};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// Rounding of sums of some thousands of numbers, as a share.
const ROUNDING: f64 = 1e-12;

type Points = Vec<[f64; 3]>;
type Triangles = Vec<[u32; 3]>;

/// A sphere of radius 1, made from an icosahedron by cutting triangles into four.
fn icosphere(levels: usize) -> (Points, Triangles) {
    let g = f64::midpoint(1.0, 5_f64.sqrt());
    let mut points: Points = Vec::new();
    for (a, b) in [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)] {
        points.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    }
    for p in &mut points {
        *p = unit(*p);
    }
    let near = |a: usize, b: usize| a != b && dot(&points[a], &points[b]) > 0.4;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let is_outward = dot(&points[a], &cross(&points[b], &points[c])) > 0.0;
                    let t = if is_outward { [a, b, c] } else { [a, c, b] };
                    triangles.push(t.map(|v| v as u32));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middle = std::collections::BTreeMap::new();
        let mut cut = Vec::new();
        for t in &triangles {
            let ends = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
            let m = ends.map(|(a, b)| {
                *middle.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let [p, q] = [a, b].map(|v| points[v as usize]);
                    points.push(unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
                    points.len() as u32 - 1
                })
            });
            cut.extend([[t[0], m[0], m[2]], [t[1], m[1], m[0]], [t[2], m[2], m[1]], m]);
        }
        triangles = cut;
    }
    (points, triangles)
}

fn unit(p: [f64; 3]) -> [f64; 3] {
    p.map(|c| c / norm(&p))
}

/// A sphere whose vertices slide along it, as by a registration, and turned so that vertices do not meet.
fn warped(levels: usize, by: f64) -> (Points, Triangles) {
    let (points, triangles) = icosphere(levels);
    let slide = |p: &[f64; 3]| {
        let (sin, cos) = (0.3 + by * p[2] * p[2]).sin_cos();
        let q = [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2]];
        let (sin, cos) = (0.7_f64 + by * q[0]).sin_cos();
        unit([q[0], cos * q[1] - sin * q[2], sin * q[1] + cos * q[2]])
    };
    (points.iter().map(slide).collect(), triangles)
}

fn sphere((points, triangles): &(Points, Triangles)) -> Sphere {
    Sphere::new(points, triangles).unwrap()
}

fn uniform(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64).collect()
}

fn resampler(from: &Sphere, to: &Sphere) -> SphereResampler {
    SphereResampler::new(from, to, None, Progress::none()).unwrap()
}

fn apply(resampler: &SphereResampler, values: &[f64], keep: Keep) -> Vec<f64> {
    resampler.apply(values, 1, keep, Zeros::Values, Progress::none()).unwrap().values
}

/// Pairs of spheres: finer, coarser, of about one size, and strongly warped.
fn pairs() -> Vec<(Sphere, Sphere)> {
    let kinds = [(3, 4, 0.3), (4, 2, 0.3), (3, 3, 0.5), (4, 3, 0.9)];
    kinds.into_iter().map(|(a, b, by)| (sphere(&icosphere(a)), sphere(&warped(b, by)))).collect()
}

/// Barycentric weights of a direction, found by trying all triangles.
fn brute_weights(points: &Points, triangles: &Triangles, p: &[f64; 3]) -> Vec<f64> {
    let mut weights = vec![0.0; points.len()];
    let mut best = (f64::NEG_INFINITY, [0_u32; 3], [0.0; 3]);
    for t in triangles {
        let [a, b, c] = t.map(|v| points[v as usize]);
        let volume = dot(&a, &cross(&b, &c));
        let parts = [dot(p, &cross(&b, &c)), dot(p, &cross(&c, &a)), dot(p, &cross(&a, &b))];
        let total: f64 = parts.iter().sum();
        let least = parts.iter().map(|part| part / total).fold(f64::INFINITY, f64::min);
        if volume > 0.0 && total > 0.0 && least > best.0 {
            best = (least, *t, parts.map(|part| part / total));
        }
    }
    assert!(best.0 > -1e-9, "a triangle holds the direction");
    best.1.iter().zip(best.2).for_each(|(&v, weight)| weights[v as usize] = weight.max(0.0));
    weights
}

#[test]
fn weights_are_those_of_the_dense_formula() {
    for (levels, other) in [(1, 2), (2, 1), (2, 2)] {
        let ((p, f), (q, g)) = (icosphere(levels), warped(other, 0.4));
        let (from, to) = (sphere(&(p.clone(), f.clone())), sphere(&(q.clone(), g.clone())));
        let areas = uniform(5, p.len() + q.len()).iter().map(|a| 0.5 + a).collect::<Vec<_>>();
        let from = from.with_areas(areas[..p.len()].to_vec()).unwrap();
        let to = to.with_areas(areas[p.len()..].to_vec()).unwrap();
        let gathered: Vec<Vec<f64>> = q.iter().map(|q| brute_weights(&p, &f, q)).collect();
        let scattered: Vec<Vec<f64>> = p.iter().map(|p| brute_weights(&q, &g, p)).collect();
        let mut w = vec![vec![0.0; p.len()]; q.len()];
        for t in 0..q.len() {
            let corners: Vec<usize> = (0..p.len()).filter(|&s| gathered[t][s] > 1e-10).collect();
            let around: Vec<usize> = (0..p.len()).filter(|&s| scattered[s][t] > 1e-10).collect();
            let uses_all = around.iter().any(|s| !corners.contains(s));
            for s in 0..p.len() {
                w[t][s] = to.areas()[t] * if uses_all { scattered[s][t] } else { gathered[t][s] };
            }
        }
        let column = |s: usize| w.iter().map(|row| row[s]).sum::<f64>();
        let totals: Vec<f64> = (0..p.len()).map(column).collect();
        let values = uniform(6, p.len());
        let resampler = resampler(&from, &to);
        let means = apply(&resampler, &values, Keep::Mean);
        let sums = apply(&resampler, &values, Keep::Sum);
        for t in 0..q.len() {
            let used = || (0..p.len()).filter(|&s| w[t][s] > 1e-12);
            let weight = |s: usize| w[t][s] / totals[s] * from.areas()[s];
            let total: f64 = used().map(weight).sum();
            let mean = used().map(|s| weight(s) * values[s]).sum::<f64>() / total;
            assert!((means[t] - mean).abs() < 1e-9, "{t}: {} {mean}", means[t]);
            let left_out = |s: usize| if totals[s] > 0.0 { w[t][s] / totals[s] } else { scattered[s][t] };
            let sum: f64 = (0..p.len()).map(|s| left_out(s) * values[s]).sum();
            assert!((sums[t] - sum).abs() < 1e-9, "{t}: {} {sum}", sums[t]);
        }
    }
}

#[test]
fn constants_sums_and_integrals_are_kept_both_ways() {
    for (k, (a, b)) in pairs().into_iter().enumerate() {
        for (from, to) in [(&a, &b), (&b, &a)] {
            let resampler = resampler(from, to);
            let [n, m] = resampler.sizes();
            let same = apply(&resampler, &vec![3.7; n], Keep::Mean);
            assert!(same.iter().all(|v| (v - 3.7).abs() < ROUNDING), "{k}");
            let values: Vec<f64> = uniform(k as u64, n).iter().map(|v| v - 0.3).collect();
            let size: f64 = values.iter().map(|v| v.abs()).sum();
            let sum = |values: &[f64]| values.iter().sum::<f64>();
            let found = apply(&resampler, &values, Keep::Sum);
            assert_eq!(found.len(), m);
            assert!((sum(&found) - sum(&values)).abs() < ROUNDING * size, "{k}");
            let integral = |values: &[f64], sphere: &Sphere| {
                values.iter().zip(sphere.areas()).map(|(v, a)| v * a).sum::<f64>()
            };
            let found = apply(&resampler, &values, Keep::Integral);
            let (before, after) = (integral(&values, from), integral(&found, to));
            let size: f64 = values.iter().zip(from.areas()).map(|(v, a)| (v * a).abs()).sum();
            assert!((before - after).abs() < ROUNDING * size, "{k}: {before} {after}");
        }
    }
}

#[test]
fn equal_spheres_of_any_radius_and_place_change_nothing() {
    let (points, triangles) = warped(3, 0.4);
    let own = sphere(&(points.clone(), triangles.clone()));
    for (radius, shift) in [(1.0, 0.0), (100.0, 0.0), (37.3, 2.5)] {
        let moved = points.iter().map(|p| [radius * p[0] + shift, radius * p[1], radius * p[2]]).collect();
        let other = sphere(&(moved, triangles.clone()));
        assert!((other.radius - radius).abs() < 1e-9 * radius);
        assert_eq!(other.remarks().len(), usize::from(shift != 0.0), "a shift is named");
        for &keep in Keep::ALL {
            let values: Vec<f64> = uniform(1, points.len()).iter().map(|v| (9.0 * v).floor()).collect();
            let found = apply(&resampler(&own, &other), &values, keep);
            assert!(values.iter().zip(&found).all(|(v, w)| (v - w).abs() < 1e-9), "{keep} {radius}");
        }
        // Turned inside out, as some files have it.
        let inside: Triangles = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let turned = sphere(&(points.clone(), inside));
        let values = uniform(2, points.len());
        assert_eq!(apply(&resampler(&own, &turned), &values, Keep::Mean), values);
    }
}

#[test]
fn labels_are_never_invented_and_ties_give_the_smallest() {
    for (a, b) in pairs() {
        let labels: Vec<f64> =
            uniform(3, a.n_vertices()).iter().map(|v| [7.0, -1.0, 4000.0][(3.0 * v) as usize]).collect();
        let found = apply(&resampler(&a, &b), &labels, Keep::Labels);
        assert!(found.iter().all(|v| labels.contains(v)));
    }
    // The middle of an edge has both ends in equal parts.
    let (coarse, fine) = (sphere(&icosphere(0)), sphere(&icosphere(1)));
    let labels: Vec<f64> = (0..12).map(|v| 100.0 - f64::from(v)).collect();
    let found = apply(&resampler(&coarse, &fine), &labels, Keep::Labels);
    assert_eq!(found[..12], labels[..]);
    for (t, [a, b, c]) in icosphere(1).1.iter().enumerate().map(|(t, f)| (t, f.map(|v| v as usize))) {
        if t % 4 < 3 {
            // Corner a and the middles of its edges.
            assert!(found[b] <= labels[a] && found[c] <= labels[a]);
        }
    }
}

#[test]
fn missing_values_do_not_bleed() {
    let (from, to) = (sphere(&icosphere(4)), sphere(&warped(3, 0.3)));
    let (points, _) = icosphere(4);
    let is_missing: Vec<bool> = points.iter().map(|p| p[2] > 0.8).collect();
    let resampler = resampler(&from, &to);
    let fill = |value: f64| -> Vec<f64> {
        is_missing.iter().zip(uniform(4, points.len())).map(|(m, v)| if *m { value } else { v }).collect()
    };
    let values = fill(f64::NAN);
    for keep in [Keep::Mean, Keep::Labels] {
        let found = apply(&resampler, &values, keep);
        let n_missing = found.iter().filter(|v| v.is_nan()).count();
        let share = n_missing as f64 / found.len() as f64;
        assert!((share - 0.1).abs() < 0.01, "as large as the missing cap: {share}");
        assert!(found.iter().all(|v| v.is_nan() || (0.0..=1.0).contains(v)));
    }
    let total: f64 = values.iter().filter(|v| !v.is_nan()).sum();
    let sum: f64 = apply(&resampler, &values, Keep::Sum).iter().filter(|v| !v.is_nan()).sum();
    assert!((sum / total - 1.0).abs() < ROUNDING);
    // A piece of zeros is the same, and stays 0.
    let zeros = resampler.apply(&fill(0.0), 1, Keep::Mean, Zeros::Wall, Progress::none()).unwrap();
    assert_eq!(zeros.n_wall, is_missing.iter().filter(|m| **m).count());
    let expected = apply(&resampler, &values, Keep::Mean);
    assert!(zeros.values.iter().zip(&expected).all(|(a, b)| *a == if b.is_nan() { 0.0 } else { *b }));
    // Zeros here and there are values.
    let sparse: Vec<f64> = uniform(8, points.len()).iter().map(|v| if *v < 0.1 { 0.0 } else { *v }).collect();
    let found = resampler.apply(&sparse, 1, Keep::Mean, Zeros::Wall, Progress::none()).unwrap();
    assert_eq!((found.n_wall, found.values), (0, apply(&resampler, &sparse, Keep::Mean)));
}

#[test]
fn a_target_mask_keeps_the_sum() {
    let (from, to) = (sphere(&icosphere(4)), sphere(&warped(3, 0.3)));
    let (points, _) = warped(3, 0.3);
    let kept: Vec<bool> = points.iter().map(|p| p[0] > -0.6).collect();
    let resampler = SphereResampler::new(&from, &to, Some(&kept), Progress::none()).unwrap();
    let values = uniform(9, from.n_vertices());
    for keep in [Keep::Sum, Keep::Mean, Keep::Labels] {
        let found = resampler.apply(&values, 1, keep, Zeros::Values, Progress::none()).unwrap();
        assert!(found.values.iter().zip(&kept).all(|(v, kept)| v.is_nan() != *kept));
        assert_eq!(found.n_missing, kept.iter().filter(|kept| !**kept).count());
    }
    let sum: f64 = apply(&resampler, &values, Keep::Sum).iter().filter(|v| !v.is_nan()).sum();
    assert!((sum / values.iter().sum::<f64>() - 1.0).abs() < ROUNDING);
}

#[test]
fn folds_are_passed_over() {
    let (mut points, triangles) = icosphere(4);
    // A vertex pulled across its neighbors.
    let moved = 200;
    let neighbor =
        triangles.iter().find(|t| t.contains(&moved)).unwrap().iter().find(|v| **v != moved).unwrap();
    let [p, q] = [points[moved as usize], points[*neighbor as usize]];
    points[moved as usize] = unit([0, 1, 2].map(|c| p[c] + 2.2 * (q[c] - p[c])));
    let folded = sphere(&(points.clone(), triangles));
    assert!(folded.n_folded > 0 && folded.remarks().len() == 1);
    let other = sphere(&warped(4, 0.3));
    for (from, to) in [(&folded, &other), (&other, &folded)] {
        let resampler = resampler(from, to);
        let n = from.n_vertices();
        assert!(apply(&resampler, &vec![2.0; n], Keep::Mean).iter().all(|v| (v - 2.0).abs() < ROUNDING));
        let values = uniform(11, n);
        let sum: f64 = apply(&resampler, &values, Keep::Sum).iter().sum();
        assert!((sum / values.iter().sum::<f64>() - 1.0).abs() < ROUNDING);
    }
    let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
    let found = apply(&resampler(&folded, &other), &heights, Keep::Mean);
    let worst = warped(4, 0.3).0.iter().zip(&found).map(|(p, v)| (p[2] - v).abs()).fold(0.0, f64::max);
    assert!(worst < 0.05, "{worst}");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (from, to) = (sphere(&icosphere(5)), sphere(&warped(5, 0.3)));
    let values = uniform(12, 2 * from.n_vertices());
    let bits = |n_threads: usize, keep: Keep| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let found = pool.install(|| {
            resampler(&from, &to).apply(&values, 2, keep, Zeros::Wall, Progress::none()).unwrap()
        });
        found.values.iter().map(|v| v.to_bits()).collect()
    };
    for &keep in Keep::ALL {
        assert_eq!(bits(1, keep), bits(3, keep), "{keep}");
    }
}

#[test]
fn what_is_no_sphere_is_refused_with_advice() {
    let (points, triangles) = icosphere(2);
    let stretched: Points = points.iter().map(|[x, y, z]| [*x, *y, 1.5 * z]).collect();
    let refused = |points: &Points, triangles: &Triangles| Sphere::new(points, triangles).unwrap_err();
    assert!(matches!(refused(&stretched, &triangles), SphereError::NoSphere { .. }));
    assert!(matches!(refused(&points, &triangles[1..].to_vec()), SphereError::Open(..)));
    assert!(matches!(refused(&points, &Vec::new()), SphereError::NoTriangles { n_vertices: 162 }));
    assert!(matches!(refused(&points[1..].to_vec(), &triangles), SphereError::NoTriangles { .. }));
    let twice: Points = points.iter().chain(&points).copied().collect();
    let n = points.len() as u32;
    let both: Triangles =
        triangles.iter().copied().chain(triangles.iter().map(|t| t.map(|v| v + n))).collect();
    assert_eq!(refused(&twice, &both), SphereError::Cover(2));
    let mut bad = points.clone();
    bad[5][1] = f64::NAN;
    assert_eq!(refused(&bad, &triangles), SphereError::NotFinite(5));
    let zeros = vec![[0.0; 3]; points.len()];
    assert!(matches!(refused(&zeros, &triangles), SphereError::NoSphere { .. }));
    let own = sphere(&(points.clone(), triangles));
    let few = SphereError::Length { what: "areas", expected: 162, found: 3 };
    assert_eq!(own.clone().with_areas(vec![1.0; 3]).unwrap_err(), few);
    let none = own.clone().with_areas(vec![0.0; 162]).unwrap_err();
    assert_eq!(none, SphereError::Area { vertex: 0, area: 0.0 });
    let nothing = SphereResampler::new(&own, &own, Some(&[false; 162]), Progress::none()).unwrap_err();
    assert_eq!(nothing, SphereError::NothingKept);
    let mut values = vec![0.0; 162];
    values[7] = f64::INFINITY;
    let infinite = resampler(&own, &own).apply(&values, 1, Keep::Mean, Zeros::Wall, Progress::none());
    assert_eq!(infinite.unwrap_err(), SphereError::Infinite { vertex: 7, value: f64::INFINITY });
    for error in [few, none, nothing] {
        assert!(error.to_string().contains("; ") && !error.to_string().contains('\n'));
    }
}
