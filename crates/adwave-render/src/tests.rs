use super::*;
use adwave::sample::Sample;
use adwave::{Cancelled, Progress};
use std::f64::consts::PI;

/// Tolerance of a silhouette's edge in pixels; the area may differ by this times the length of its border.
const BORDER_PIXELS: f64 = 0.5;

fn sphere() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let sample = Sample::from_name("sphere", Some(4000)).unwrap();
    (sample.points, sample.faces.iter().map(|f| [f[0], f[1], f[2]]).collect())
}

fn small() -> RenderParams {
    RenderParams::default().with_size(120, 90).with_view(View::FRONT)
}

#[test]
fn a_sphere_is_seen_as_a_disc_of_its_area() {
    let (points, triangles) = sphere();
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::CLAY };
    let parallel = Projection::Orthographic;
    let params =
        small().with_size(300, 300).with_background(Background::Transparent).with_projection(parallel);
    let picture = render(&surface, &[], &params, Progress::none()).unwrap();
    let seen: f64 = picture.rgba.iter().skip(3).step_by(4).map(|&a| f64::from(a) / 255.0).sum();
    let radius = (1.0 - 2.0 * layout::MARGIN) * 150.0;
    let expected = PI * radius * radius;
    assert!((seen - expected).abs() < BORDER_PIXELS * 2.0 * PI * radius, "{seen} {expected}");
    assert_eq!(picture.pixel(0, 0)[3], 0);
    assert_eq!(picture.pixel(150, 150)[3], 255);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let (points, triangles) = sphere();
    let values: Vec<f64> = points.iter().map(|p| p[0]).collect();
    let field =
        FieldPaint { values: &values, label: "x".to_owned(), color_map: None, range: ValueRange::Auto };
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::Field(field) };
    let on = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| render(&surface, &[], &small(), Progress::none()).unwrap())
    };
    let one = on(1);
    assert!(one == on(2) && one == on(3));
}

#[test]
fn what_is_nearer_hides_what_is_behind() {
    let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    let surface = Surface { points: &points, triangles: &[[0, 1, 2]], paint: Paint::Plain([255, 0, 0]) };
    let green_at_the_ball = |z: f64| {
        let ball = Ball { center: [0.0, -0.5, z], radius: 0.2, color: [0, 255, 0] };
        let picture = render(&surface, &[ball], &small(), Progress::none()).unwrap();
        let pixel = picture.pixel(60, 66);
        pixel[1] > pixel[0]
    };
    assert!(green_at_the_ball(1.0) && !green_at_the_ball(-1.0));
}

#[test]
fn a_ball_in_a_close_up_has_its_radius_in_either_projection() {
    let (points, triangles) = sphere();
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::Plain([255, 0, 0]) };
    let framing = Framing { zoom: 4.0, focus: Some([0.0, 0.0, 1.0]) };
    for projection in [Projection::Orthographic, RenderParams::default().projection] {
        let params = small().with_size(300, 300).with_projection(projection).with_framing(framing);
        let area = |radius: f64| {
            let ball = Ball { center: [0.0, 0.0, 1.0], radius, color: [0, 255, 0] };
            let picture = render(&surface, &[ball], &params, Progress::none()).unwrap();
            picture.rgba.chunks_exact(4).filter(|p| p[1] > p[0]).count() as f64
        };
        let [small, large] = [0.05, 0.1].map(area);
        assert!(small > 200.0 && (large / small - 4.0).abs() < 0.3, "{projection:?}: {small} {large}");
        if projection == Projection::Orthographic {
            // The whole sphere, of radius 1, would be 4 times as wide as the area inside the margins.
            let radius = 0.1 * 4.0 * (1.0 - 2.0 * layout::MARGIN) * 150.0;
            assert!((large - PI * radius * radius).abs() < BORDER_PIXELS * 2.0 * PI * radius, "{large}");
        }
    }
}

#[test]
fn a_close_up_leaves_bar_and_caption_free() {
    let (points, triangles) = sphere();
    let values: Vec<f64> = points.iter().map(|p| p[0]).collect();
    let field =
        FieldPaint { values: &values, label: "x".to_owned(), color_map: None, range: ValueRange::Auto };
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::Field(field) };
    let params =
        small().with_size(400, 300).with_framing(Framing { zoom: 20.0, focus: Some([0.0, 0.0, 1.0]) });
    let picture = render(&surface, &[], &params, Progress::none()).unwrap();
    let white = |x: u32| (0..300).filter(|&y| picture.pixel(x, y)[..3] == [255; 3]).count();
    assert_eq!((white(0), white(399)), (0, 300));
    let panel = Panel { surface, balls: Vec::new(), caption: "below".to_owned() };
    let sheet = grid(&[panel], 1, SharedCamera::Own, &params, Progress::none()).unwrap();
    assert_eq!(sheet.pixel(2, sheet.height - 1)[..3], [255; 3]);
}

#[test]
fn zooms_that_no_picture_can_have_are_refused_with_the_largest() {
    let error = |zoom| small().with_framing(Framing { zoom, focus: None }).check().unwrap_err().to_string();
    for zoom in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e5] {
        assert!(error(zoom).contains("above 0 and at most 2777"), "{}", error(zoom));
    }
    let most = Framing { zoom: 2777.0, focus: Some([0.5, -0.5, 0.5]) };
    let (points, triangles) = sphere();
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::CLAY };
    render(&surface, &[], &small().with_framing(most), Progress::none()).unwrap();
}

#[test]
fn a_flat_face_is_lit_evenly() {
    let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let surface = Surface { points: &points, triangles: &[[0, 1, 2], [0, 2, 3]], paint: Paint::CLAY };
    let picture = render(&surface, &[], &small(), Progress::none()).unwrap();
    let first = picture.pixel(40, 30);
    for (x, y) in [(60, 45), (75, 20), (50, 70)] {
        assert_eq!(picture.pixel(x, y), first);
    }
}

#[test]
fn turning_the_shape_is_turning_the_viewer() {
    let (points, triangles) = sphere();
    let points: Vec<_> = points.iter().map(|p| [p[0], 0.6 * p[1] + 0.3 * p[0], 0.4 * p[2]]).collect();
    let turned: Vec<_> = points.iter().map(|p| [-p[2], p[1], p[0]]).collect();
    let picture = |points: &[[f64; 3]], view| {
        let surface = Surface { points, triangles: &triangles, paint: Paint::CLAY };
        render(&surface, &[], &small().with_view(view), Progress::none()).unwrap()
    };
    let (a, b) = (picture(&points, "right".parse().unwrap()), picture(&turned, "front".parse().unwrap()));
    let difference: f64 =
        a.rgba.iter().zip(&b.rgba).map(|(x, y)| f64::from(x.abs_diff(*y))).sum::<f64>() / a.rgba.len() as f64;
    assert!(difference < 0.5, "{difference} of 255 on average");
}

#[test]
fn a_field_of_both_signs_is_centered_on_zero_and_the_bar_has_the_colors_of_the_ends() {
    let (points, triangles) = sphere();
    let values: Vec<f64> = points.iter().map(|p| p[1]).collect();
    let field =
        FieldPaint { values: &values, label: "y".to_owned(), color_map: None, range: ValueRange::Auto };
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::Field(field) };
    let picture = render(&surface, &[], &small().with_size(400, 300), Progress::none()).unwrap();
    let map = ColorMap::from_name("coolwarm").unwrap();
    for end in [map.color(0.0), map.color(1.0)] {
        let found = picture.rgba.chunks_exact(4).filter(|p| p[..3] == end).count();
        assert!(found >= 5, "{end:?}: {found} pixels");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused_by_name() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, f64::NAN]];
    let clay = |points, triangles| Surface { points, triangles, paint: Paint::CLAY };
    let error = |surface: &Surface, params: &RenderParams| {
        render(surface, &[], params, Progress::none()).unwrap_err().to_string()
    };
    assert!(error(&clay(&points, &[]), &small()).contains("vertex 2"));
    assert!(error(&clay(&points[..2], &[[0, 1, 2]]), &small()).contains("corner 2"));
    assert!(error(&clay(&[], &[]), &small()).contains("no points"));
    assert!(error(&clay(&points[..2], &[]), &small().with_size(0, 9)).contains("0x9"));
    assert!(
        error(&clay(&points[..2], &[]), &small().with_size(60_000, 9))
            .contains("pixels per side, got 60000x9")
    );
    let ball = Ball { center: [0.0; 3], radius: 0.0, color: [0; 3] };
    assert!(
        render(&clay(&points[..2], &[]), &[ball], &small(), Progress::none())
            .unwrap_err()
            .to_string()
            .contains("ball 0")
    );
    assert_eq!(grid(&[], 1, SharedCamera::Same, &small(), Progress::none()), Err(RenderError::NoPanels));
}

#[test]
fn shapes_without_extent_are_drawn_all_the_same() {
    for points in [
        vec![[1.0; 3]],
        vec![[1e100; 3]; 4],
        vec![[0.0; 3], [0.0, 0.0, 1e-300]],
        vec![[-1e100; 3], [1e100; 3]],
    ] {
        let cloud = Surface { points: &points, triangles: &[], paint: Paint::CLAY };
        let picture = render(&cloud, &[], &small(), Progress::none()).unwrap();
        assert!(picture.rgba.chunks_exact(4).any(|p| p[..3] != [255; 3]), "{points:?}");
        let flat = Surface { points: &points, triangles: &[[0, 0, 0]], paint: Paint::CLAY };
        render(&flat, &[], &small(), Progress::none()).unwrap();
    }
}

#[test]
fn a_sheet_has_room_for_its_panels_and_captions() {
    let (points, triangles) = sphere();
    let panel = |caption: &str| Panel {
        surface: Surface { points: &points, triangles: &triangles, paint: Paint::CLAY },
        balls: Vec::new(),
        caption: caption.to_owned(),
    };
    let plain =
        grid(&[panel(""), panel(""), panel("")], 2, SharedCamera::Same, &small(), Progress::none()).unwrap();
    assert_eq!((plain.width, plain.height), (240, 180));
    let named = grid(
        &[panel("σ"), panel("a very long caption that does not fit into its panel")],
        2,
        SharedCamera::Own,
        &small(),
        Progress::none(),
    );
    let named = named.unwrap();
    let row = |y: u32| (0..240).filter(|&x| named.pixel(x, y)[0] < 128).count();
    assert!((70..named.height).map(row).sum::<usize>() > 20, "no caption");
}

#[test]
fn triangles_that_meet_leave_nothing_out() {
    // A square of uneven slivers, rotated so that no edge is aligned with the pixels.
    let n = 40_u32;
    let at = |k: u32| (f64::from(k) / f64::from(n)).powi(2);
    let points: Vec<_> =
        (0..=n).flat_map(|i| (0..=n).map(move |j| [at(i) + 0.3 * at(j), at(j) - 0.2 * at(i), 0.0])).collect();
    let cell = |i: u32, j: u32| {
        let a = i * (n + 1) + j;
        [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]
    };
    let triangles: Vec<_> = (0..n).flat_map(|i| (0..n).flat_map(move |j| cell(i, j))).collect();
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::CLAY };
    let clear = small().with_background(Background::Transparent);
    let picture = render(&surface, &[], &clear, Progress::none()).unwrap();
    for y in 0..picture.height {
        let opaque: Vec<u32> = (0..picture.width).filter(|&x| picture.pixel(x, y)[3] == 255).collect();
        if let (Some(first), Some(last)) = (opaque.first(), opaque.last()) {
            assert_eq!(opaque.len() as u32, last - first + 1, "a hole in row {y}");
        }
    }
}

#[test]
fn every_view_and_projection_frames_the_shape_fully() {
    let (points, triangles) = sphere();
    let points: Vec<_> = points.iter().map(|p| [4.0 * p[0] + 1e6, p[1], 0.4 * p[2] - 3.0]).collect();
    let surface = Surface { points: &points, triangles: &triangles, paint: Paint::CLAY };
    let perspective = |field_of_view| Projection::Perspective { field_of_view };
    for projection in [Projection::Orthographic, perspective(20.0), perspective(80.0)] {
        for view in View::names().map(|name| name.parse().unwrap()) {
            let params =
                small().with_background(Background::Transparent).with_view(view).with_projection(projection);
            let picture = render(&surface, &[], &params, Progress::none()).unwrap();
            let seen = |x: u32, y: u32| picture.pixel(x, y)[3] > 0;
            let border =
                (0..120).any(|x| seen(x, 0) || seen(x, 89)) || (0..90).any(|y| seen(0, y) || seen(119, y));
            assert!(!border, "{view:?} {projection:?} touches the border");
            let trimmed = picture.trim_borders(0);
            assert!(trimmed.width > 100 || trimmed.height > 70, "{view:?} {projection:?} leaves room");
        }
    }
}

#[test]
fn a_call_that_is_told_to_stop_gives_no_picture() {
    let (points, triangles) = sphere();
    let stop = std::sync::atomic::AtomicBool::new(true);
    let progress = Progress::none().with_cancel(&stop);
    for triangles in [&triangles[..], &[]] {
        let surface = Surface { points: &points, triangles, paint: Paint::CLAY };
        let panel = Panel { surface: surface.clone(), balls: Vec::new(), caption: String::new() };
        assert_eq!(render(&surface, &[], &small(), progress), Err(RenderError::Cancelled(Cancelled)));
        let sheet = grid(&[panel], 1, SharedCamera::Same, &small(), progress);
        assert_eq!(sheet, Err(RenderError::Cancelled(Cancelled)));
    }
}

#[test]
#[ignore = "times a million vertices; run with --release -- --ignored --nocapture"]
fn a_million_vertices_are_let_go_of_within_50_ms() {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::{Duration, Instant};
    let sample = Sample::from_name("sphere", Some(1_000_000)).unwrap();
    let triangles: Vec<[u32; 3]> = sample.faces.iter().map(|f| [f[0], f[1], f[2]]).collect();
    let surface = Surface { points: &sample.points, triangles: &triangles, paint: Paint::CLAY };
    let start = Instant::now();
    render(&surface, &[], &RenderParams::default(), Progress::none()).unwrap();
    let whole = start.elapsed();
    let mut longest = Duration::ZERO;
    for k in 0..20 {
        let stop = AtomicBool::new(false);
        let late = std::thread::scope(|scope| {
            let call = scope.spawn(|| {
                let made =
                    render(&surface, &[], &RenderParams::default(), Progress::none().with_cancel(&stop));
                (made, Instant::now())
            });
            std::thread::sleep(whole * k / 20);
            let asked = Instant::now();
            stop.store(true, Ordering::Relaxed);
            let (made, ended) = call.join().unwrap();
            if made.is_err() { ended.duration_since(asked) } else { Duration::ZERO }
        });
        longest = longest.max(late);
    }
    println!("a picture takes {whole:?}, and stops {longest:?} after the flag at the latest");
    assert!(longest < Duration::from_millis(50), "{longest:?}");
}
