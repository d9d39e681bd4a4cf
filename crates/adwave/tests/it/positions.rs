//! Positions after a filter: what is flat stays where it is, outlines keep their length, volume is kept.

use adwave::bands::Schedule;
use adwave::filter::{Preset, WeightedLayer};
use adwave::positions::{
    Borders, MoveDirection, PositionParams, PositionsError, Volume, constrain_positions,
};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape, enclosed_volume};
use adwave::{Decomposer, Progress};
use std::f64::consts::PI;

use crate::common;

fn filtered(decomposer: &Decomposer, points: &[[f64; 3]], preset: Preset, n_levels: usize) -> Vec<[f64; 3]> {
    let layer = WeightedLayer::everywhere(preset.gains(n_levels));
    let schedule = Schedule::dyadic(n_levels).unwrap();
    let edited = decomposer.request(points.as_flattened(), 3, &schedule).filter_layers(&[layer]).unwrap();
    edited.as_chunks().0.to_vec()
}

fn settled(
    decomposer: &Decomposer,
    points: &[[f64; 3]],
    preset: Preset,
    n_levels: usize,
    params: PositionParams,
) -> Vec<[f64; 3]> {
    let after = filtered(decomposer, points, preset, n_levels);
    constrain_positions(decomposer, points, after, &params, Progress::none()).unwrap()
}

fn borders(borders: Borders) -> PositionParams {
    PositionParams::default().with_borders(borders)
}

fn farthest(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let square = |(p, q): (&[f64; 3], &[f64; 3])| p.iter().zip(q).map(|(x, y)| (x - y).powi(2)).sum::<f64>();
    a.iter().zip(b).map(square).fold(0.0, f64::max).sqrt()
}

fn decomposer(points: &[[f64; 3]], faces: &Polygons) -> Decomposer {
    Decomposer::new(&Shape::Mesh(Mesh::new(points.to_vec(), faces.clone()).unwrap()))
}

#[test]
fn a_flat_square_stays_where_it_is_as_a_mesh_and_as_a_cloud() {
    let (points, faces) = common::plane(40);
    let mesh = decomposer(&points, &faces);
    let cloud = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone()).unwrap()));
    for shape in [&mesh, &cloud] {
        for &preset in Preset::ALL {
            let name = preset.name();
            for kind in [Borders::Natural, Borders::Keep] {
                let after = settled(shape, &points, preset, 6, borders(kind));
                assert!(farthest(&points, &after) <= 1e-9, "{name}, {kind:?}");
            }
        }
        let free = borders(Borders::Free).with_along(Some(MoveDirection::Free));
        let free = settled(shape, &points, Preset::SuppressPaper, 6, free);
        assert!(farthest(&points, &free) > 0.05, "the paper's way draws corners in");
    }
}

#[test]
fn the_outline_of_a_half_cylinder_keeps_its_length_and_its_straight_edges() {
    let (square, faces) = common::plane(50);
    let bend = |p: &[f64; 3]| [(0.5 * PI * p[0]).sin(), (0.5 * PI * p[0]).cos(), p[1]];
    let points: Vec<[f64; 3]> = square.iter().map(bend).collect();
    let shape = decomposer(&points, &faces);
    let outline = |points: &[[f64; 3]]| {
        let on = |k: usize| {
            square
                .iter()
                .position(|p| {
                    let t = -1.0 + k as f64 / 25.0;
                    (p[0] - t).abs() < 1e-12 && p[1] == -1.0
                })
                .unwrap()
        };
        let length =
            |(a, b): ([f64; 3], [f64; 3])| a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
        (0..50).map(|k| length((points[on(k)], points[on(k + 1)]))).sum::<f64>()
    };
    let before = outline(&points);
    let change = |kind| outline(&settled(&shape, &points, Preset::Suppress, 6, borders(kind))) / before - 1.0;
    let (natural, keep, free) = (change(Borders::Natural), change(Borders::Keep), change(Borders::Free));
    assert!(natural.abs() <= 1e-3 && keep.abs() <= 1e-12 && free.abs() > 3e-3, "{natural} {keep} {free}");
    let after = settled(&shape, &points, Preset::Suppress, 6, borders(Borders::Natural));
    let along = points.iter().zip(&after).map(|(p, q)| (p[2] - q[2]).abs()).fold(0.0, f64::max);
    assert!(along <= 1e-4, "{along} along the axis");
}

#[test]
fn a_bump_next_to_the_border_is_smoothed_like_one_inside() {
    let (mut points, faces) = common::plane(80);
    let (radius, height) = (0.15, 0.1);
    let centers = [[0.0, 0.0], [1.0 - radius, 0.0]];
    for p in &mut points {
        let bump = |c: &[f64; 2]| {
            let square = (p[0] - c[0]).powi(2) + (p[1] - c[1]).powi(2);
            (-square / (2.0 * radius * radius)).exp()
        };
        p[2] = height * centers.iter().map(bump).sum::<f64>();
    }
    let shape = decomposer(&points, &faces);
    let top = |points: &[[f64; 3]], c: &[f64; 2]| {
        points.iter().filter(|p| (p[0] - c[0]).hypot(p[1] - c[1]) < 0.05).map(|p| p[2]).fold(0.0, f64::max)
    };
    let after = |preset| settled(&shape, &points, preset, 5, borders(Borders::Natural));
    let paper = after(Preset::SuppressPaper);
    let [inside, border] = centers.map(|c| top(&points, &c) - top(&paper, &c));
    assert!((border / inside - 1.0).abs() < 0.05, "{inside} taken off inside, {border} at the border");
    // What 2Φⁿ − Φ²ⁿ takes off is a small difference of large ones; what it leaves is alike.
    let gentle = after(Preset::Suppress);
    let [inside, border] = centers.map(|c| top(&gentle, &c));
    assert!(inside < 0.99 * height, "{inside} left of {height}");
    assert!((border / inside - 1.0).abs() < 0.02, "{inside} left inside, {border} at the border");
}

#[test]
fn closed_shapes_keep_their_bits_and_their_volume_where_asked() {
    let sample = Sample::from_name("creature", Some(20_000)).unwrap();
    let (points, faces) = (sample.points, sample.faces);
    let shape = decomposer(&points, &faces);
    let volume = |points: &[[f64; 3]]| {
        enclosed_volume(&shape.vertex_map().positions(points), shape.geometry().unwrap().triangles())
    };
    let smooth = filtered(&shape, &points, Preset::SuppressPaper, 5);
    assert_eq!(settled(&shape, &points, Preset::SuppressPaper, 5, PositionParams::default()), smooth);
    let before = volume(&points);
    let loss = |points: &[[f64; 3]]| (volume(points) / before - 1.0).abs();
    // 2Φⁿ − Φ²ⁿ on one level more is as smooth as dropping all bands.
    let limbs = settled(&shape, &points, Preset::Suppress, 6, PositionParams::default());
    assert!(loss(&limbs) < loss(&smooth) / 3.0, "{} of {}", loss(&limbs), loss(&smooth));
    let keep = PositionParams::default().with_volume(Volume::Keep);
    for preset in [Preset::Suppress, Preset::SuppressPaper, Preset::Enhance] {
        assert!(loss(&settled(&shape, &points, preset, 5, keep)) < 1e-12, "{preset:?}");
    }
    // What did not move does not move for the volume either.
    let mut half = smooth.clone();
    for (p, old) in half.iter_mut().zip(&points).filter(|(_, old)| old[1] > 0.0) {
        *p = *old;
    }
    let after = constrain_positions(&shape, &points, half, &keep, Progress::none()).unwrap();
    assert!(after.iter().zip(&points).all(|(p, old)| old[1] <= 0.0 || p == old) && loss(&after) < 1e-12);
}

#[test]
fn an_open_shape_has_no_volume_to_keep() {
    let (points, faces) = common::plane(4);
    let keep = PositionParams::default().with_volume(Volume::Keep);
    let error =
        constrain_positions(&decomposer(&points, &faces), &points, points.clone(), &keep, Progress::none());
    assert_eq!(error, Err(PositionsError::NoVolume));
}

/// The distance of each point to its nearest.
fn nearest(points: &[[f64; 3]]) -> Vec<f64> {
    adwave::shape::nearest_neighbors(points, 1).radius
}

#[test]
fn points_of_a_cloud_move_along_its_normals_and_stay_apart() {
    // A sphere with waves, sampled at random: neighbors are at all distances.
    let mut sample = Sample::from_name("sphere", Some(6000)).unwrap();
    sample.add_noise(adwave::sample::NoiseSigma::MeanEdge(0.3), 5).unwrap();
    let mut seed = 7_u64;
    sample.points.retain(|_| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        seed >> 63 == 0
    });
    let points = sample.points;
    let cloud = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone()).unwrap()));
    let radius = |p: &[f64; 3]| p.iter().map(|c| c * c).sum::<f64>().sqrt();
    let roughness = |points: &[[f64; 3]]| {
        let mean = points.iter().map(radius).sum::<f64>() / points.len() as f64;
        (points.iter().map(|p| (radius(p) - mean).powi(2)).sum::<f64>() / points.len() as f64).sqrt()
    };
    let of = |along| PositionParams::default().with_along(along);
    let after = |along| settled(&cloud, &points, Preset::SuppressPaper, 5, of(along));
    let least = |points: &[[f64; 3]]| {
        let mut distances = nearest(points);
        distances.sort_by(f64::total_cmp);
        distances[distances.len() / 20]
    };
    let (normal, free, surface) =
        (after(None), after(Some(MoveDirection::Free)), after(Some(MoveDirection::Surface)));
    assert_eq!(
        normal,
        after(Some(MoveDirection::Normal)),
        "clouds move along their normals unless told otherwise"
    );
    assert!(least(&normal) > 0.7 * least(&points), "{} of {}", least(&normal), least(&points));
    assert!(least(&free) < 0.9 * least(&normal), "{} of {}", least(&free), least(&normal));
    assert!(
        roughness(&normal) < 0.5 * roughness(&points),
        "{} of {}",
        roughness(&normal),
        roughness(&points)
    );
    assert!(roughness(&surface) > 0.9 * roughness(&points) && farthest(&surface, &points) > 0.0);
    for (axis, along) in [MoveDirection::X, MoveDirection::Y, MoveDirection::Z].into_iter().enumerate() {
        let moved = after(Some(along));
        let stays = |c: usize| moved.iter().zip(&points).all(|(p, q)| p[c] == q[c]);
        assert!((0..3).all(|c| stays(c) == (c != axis)), "{along:?}");
    }
}
