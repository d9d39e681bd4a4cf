//! Edits: what is outside a region stays to the last bit, what is inside follows eq. 18.

use adwave::bands::Schedule;
use adwave::filter::{Edit, FilterError, Gains, Layer, Preset, displacement};
use adwave::region::{BrushStroke, Length, Location, Region, RegionError, parse_region};
use adwave::sample::Sample;
use adwave::shape::{Mesh, Shape, enclosed_volume, triangulate};
use adwave::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};

/// Allowed difference by the default accuracy of two ways to the same result, on shapes of about unit size.
const ACCURACY: f64 = 2e-9;

struct Fixture {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    decomposer: Decomposer,
    schedule: Schedule,
}

fn fixture(name: &str, n_vertices: usize) -> Fixture {
    let Sample { points, faces } = Sample::from_name(name, Some(n_vertices)).unwrap();
    let triangles = triangulate(&points, &faces);
    let shape = Shape::Mesh(Mesh::new(points.clone(), faces).unwrap());
    let decomposer = Decomposer::new(&shape);
    Fixture { points, triangles, decomposer, schedule: Schedule::dyadic(6).unwrap() }
}

impl Fixture {
    fn filter(&self, layers: &[Layer]) -> Result<Vec<[f64; 3]>, FilterError> {
        let coords = self.points.as_flattened();
        let field = |name: &str| (name == "height").then(|| (1, self.points.iter().map(|p| p[1]).collect()));
        let names = ["height".to_owned()];
        self.decomposer
            .request(coords, 3, &self.schedule)
            .filter(&Edit::new(layers).with_fields(&field, &names))
            .map(|edited| edited.as_chunks().0.to_vec())
    }

    fn bands(&self) -> adwave::bands::Bands {
        let coords = self.points.as_flattened();
        self.decomposer.decompose(coords, 3, &self.schedule).unwrap()
    }

    fn weights(&self, region: &str) -> Vec<f64> {
        weights(&self.decomposer, &parse_region(region).unwrap())
    }
}

/// One weight per vertex of the shape.
fn weights(decomposer: &Decomposer, region: &Region) -> Vec<f64> {
    let weights = region.weights(decomposer.metric(), &|_| None, &[], Progress::none()).unwrap();
    weights.to_vertices(decomposer.vertex_map())
}

fn everywhere(gains: Gains) -> Vec<Layer> {
    vec![Layer { gains, region: Region::Everywhere {} }]
}

#[test]
fn unit_gains_change_nothing_and_no_gains_leave_the_coarsest_level() {
    let f = fixture("torus", 2000);
    assert_eq!(f.filter(&everywhere(Gains::Gains(vec![1.0; 6]))).unwrap(), f.points);
    assert_eq!(f.filter(&[]).unwrap(), f.points);
    let bands = f.bands();
    let smooth = f.filter(&everywhere(Gains::Preset(Preset::SuppressPaper))).unwrap();
    for (a, b) in smooth.as_flattened().iter().zip(bands.coarsest()) {
        assert!((a - b).abs() < ACCURACY);
    }
}

#[test]
fn gains_weigh_their_bands() {
    let f = fixture("knot", 2000);
    let gains = vec![3.0, 0.5, 1.0, 0.0, 1.0, -1.0];
    let edited = f.filter(&everywhere(Gains::Gains(gains.clone()))).unwrap();
    let bands = f.bands();
    for (i, value) in edited.as_flattened().iter().enumerate() {
        let expected = bands.coarsest()[i] + (0..6).map(|j| gains[j] * bands.wavelet(j + 1)[i]).sum::<f64>();
        assert!((value - expected).abs() < ACCURACY);
    }
}

#[test]
fn an_edit_ends_where_its_region_ends() {
    let f = fixture("sphere", 4000);
    let region =
        Region::Ball { center: Location::Vertex(7), radius: Length::PercentOfDiagonal(10.0), falloff: None };
    let weights = weights(&f.decomposer, &region);
    assert_eq!(weights[7], 1.0);
    let n_touched = weights.iter().filter(|&&r| r > 0.0).count();
    let radius = 0.1 * f.decomposer.diagonal();
    // The cap of geodesic radius ρ on the unit sphere has the part (1 − cos ρ)/2 of its area; distances over edges are a
    // little long, so the ball is a little small.
    let cap = 4000.0 * (1.0 - radius.cos()) / 2.0;
    assert!((0.85 * cap..1.02 * cap).contains(&(n_touched as f64)), "{n_touched} of {cap}");
    let edited = f.filter(&[Layer { gains: Gains::Gains(vec![5.0; 6]), region }]).unwrap();
    for (x, r) in weights.iter().enumerate() {
        assert_eq!(edited[x] == f.points[x], *r == 0.0, "vertex {x} of weight {r}");
    }
}

#[test]
fn the_order_of_layers_does_not_matter() {
    let f = fixture("sphere", 1000);
    let half = Layer {
        gains: Gains::Preset(Preset::Enhance),
        region: parse_region("half-space:point=0 0 0,normal=1 0 0,falloff=0.5").unwrap(),
    };
    let all = Layer { gains: Gains::Preset(Preset::Band1), region: Region::Everywhere {} };
    let forward = f.filter(&[half.clone(), all.clone()]).unwrap();
    let backward = f.filter(&[all, half]).unwrap();
    assert!(
        forward.as_flattened().iter().zip(backward.as_flattened()).all(|(a, b)| (a - b).abs() < ACCURACY)
    );
}

#[test]
fn regions_combine_as_sets_do() {
    let f = fixture("sphere", 1000);
    let (left, right) = ("half-space:point=0 0 0,normal=-1 0 0", "half-space:point=0 0 0,normal=1 0 0");
    let (a, b) = (f.weights(left), f.weights(right));
    let either = f.weights(&format!("{left} | {right}"));
    let both = f.weights(&format!("{left} & {right}"));
    let neither = f.weights(&format!("!({left} | {right})"));
    for x in 0..1000 {
        assert_eq!(either[x], a[x].max(b[x]));
        assert_eq!(both[x], 0.0);
        assert_eq!(neither[x], 1.0 - either[x]);
    }
    assert!(a.iter().filter(|&&r| r == 1.0).count() > 300);
    assert_eq!(f.weights("all"), vec![1.0; 1000]);
    let boxed = f.weights("box:min=-2 0 -2,max=2 2 2,falloff=0");
    assert!((0..1000).all(|x| (boxed[x] == 1.0) == (f.points[x][1] >= 0.0)));
    let some = f.weights("vertices:indices=3 5 8");
    assert!((0..1000).all(|x| (some[x] == 1.0) == [3, 5, 8].contains(&x)));
}

#[test]
fn a_ball_round_a_vertex_measures_as_the_vertex_itself_does() {
    let f = fixture("creature", 6000);
    for vertex in [7, 1000, 3001] {
        let radius = Length::PercentOfDiagonal(6.0);
        let ball = Region::Ball { center: Location::Vertex(vertex), radius, falloff: Some(radius) };
        let vertices = Region::Vertices { indices: vec![vertex], radius, falloff: None };
        let (ball, vertices) = (weights(&f.decomposer, &ball), weights(&f.decomposer, &vertices));
        let apart = ball.iter().zip(&vertices).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The two divide by the radius in another order.
        assert!(apart < 1e-13, "{vertex}: {apart}");
    }
}

#[test]
fn strokes_of_a_brush_follow_one_another() {
    let f = fixture("creature", 3000);
    let at = |vertex: u32, falloff: f64| Region::Vertices {
        indices: vec![vertex, vertex + 1],
        radius: Length::PercentOfDiagonal(12.0),
        falloff: Some(Length::PercentOfDiagonal(falloff)),
    };
    let [a, b, c] = [(7, 6.0), (9, 12.0), (1500, 0.0)].map(|(vertex, falloff)| at(vertex, falloff));
    let half = Region::Faded { factor: 0.5, region: Box::new(b.clone()) };
    let strokes = [&a, &half, &c, &a].map(Clone::clone);
    let painted = Region::Painted(vec![
        BrushStroke::Add(strokes[0].clone()),
        BrushStroke::Subtract(strokes[1].clone()),
        BrushStroke::Add(strokes[2].clone()),
        BrushStroke::Subtract(Region::Not(Box::new(Region::Everywhere {}))),
    ]);
    let [first, second, third] = [&a, &b, &c].map(|region| weights(&f.decomposer, region));
    let all = weights(&f.decomposer, &painted);
    for (x, r) in all.iter().enumerate() {
        assert_eq!(*r, first[x].min(1.0 - 0.5 * second[x]).max(third[x]), "vertex {x}");
    }
    assert!(third.iter().all(|&r| r == 0.0 || r == 1.0) && third.contains(&1.0));
    // Nested regions say the same.
    let nested = Region::Any(vec![Region::All(vec![a, Region::Not(Box::new(half))]), c]);
    assert_eq!(weights(&f.decomposer, &nested), all);
    // With a field of the shape, which may differ within a welded vertex.
    let mixed = Region::Painted(vec![
        BrushStroke::Add(strokes[0].clone()),
        BrushStroke::Add(Region::Field { name: "low".to_owned(), low: 0.0, high: 2.0 }),
        BrushStroke::Subtract(strokes[2].clone()),
    ]);
    let field = |_: &str| Some((1, vec![1.0; f.points.len()]));
    let mixed = mixed.weights(f.decomposer.metric(), &field, &["low".to_owned()], Progress::none()).unwrap();
    let mixed = mixed.to_vertices(f.decomposer.vertex_map());
    assert!((0..first.len()).all(|x| mixed[x] == first[x].max(0.5).min(1.0 - third[x])));
    let wrong = Region::Faded { factor: 1.5, region: Box::new(Region::Everywhere {}) };
    let refused = wrong.weights(f.decomposer.metric(), &|_: &str| None, &[], Progress::none());
    assert_eq!(refused.unwrap_err().to_string(), "the factor of the region is 1.5; it must be in [0, 1]");
}

#[test]
fn a_stroke_is_as_wide_as_it_says_along_its_whole_length() {
    // A meridian of the unit sphere: the straight pieces between its three places cut deep through the inside.
    let f = fixture("sphere", 20_000);
    let weights = f.weights("stroke:path=1 0 0;0 0 1;-1 0 0,radius=0.2,falloff=0");
    for (x, p) in f.points.iter().enumerate() {
        let from_meridian = if p[2] > 0.3 { p[1].asin().abs() } else { continue };
        if from_meridian < 0.17 {
            assert_eq!(weights[x], 1.0, "{p:?} is {from_meridian} away");
        }
        if from_meridian > 0.21 {
            assert_eq!(weights[x], 0.0, "{p:?} is {from_meridian} away");
        }
    }
}

#[test]
fn suppressing_keeps_the_body_and_enhancing_makes_it_larger() {
    let f = fixture("torus", 4000);
    let volume = |points: &[[f64; 3]]| enclosed_volume(points, &f.triangles);
    let before = volume(&f.points);
    let smooth = f.filter(&everywhere(Gains::Preset(Preset::SuppressPaper))).unwrap();
    let crisp = f.filter(&everywhere(Gains::Preset(Preset::Enhance))).unwrap();
    assert!((0.5 * before..before).contains(&volume(&smooth)));
    assert!(volume(&crisp) > before);
    let moved = displacement(&f.points, &smooth);
    assert!(moved.rms > 0.0 && moved.rms < moved.max && moved.max < 0.2 * f.decomposer.diagonal());
}

#[test]
fn what_does_not_fit_is_named() {
    let f = fixture("sphere", 100);
    let edit = |gains: Vec<f64>, region: &str| {
        f.filter(&[Layer { gains: Gains::Gains(gains), region: parse_region(region).unwrap() }]).unwrap_err()
    };
    assert_eq!(edit(vec![1.0; 5], "all"), FilterError::WrongNumberOfGains { n_gains: 5, n_levels: 6 });
    assert!(matches!(edit(vec![f64::NAN; 6], "all"), FilterError::BadGain { level: 1, .. }));
    let region = |text: &str| match edit(vec![1.0; 6], text) {
        FilterError::Region { layer: 1, source } => source,
        other => panic!("{text}: {other}"),
    };
    assert_eq!(
        region("ball:vertex=100,radius=1"),
        RegionError::NoSuchVertex { vertex: 100, n_vertices: 100 }
    );
    assert!(matches!(region("field:name=heat"), RegionError::NoSuchField { .. }));
    assert!(region("field:name=heat").to_string().contains("height"));
    assert!(matches!(region("ball:vertex=1,radius=0"), RegionError::BadNumber { .. }));
    assert!(matches!(region("half-space:point=0 0 0,normal=0 0 0"), RegionError::BadNumber { .. }));
}

#[test]
fn the_weights_of_a_region_stop_when_told_to() {
    let f = fixture("sphere", 20_000);
    let stop = std::sync::atomic::AtomicBool::new(true);
    let cancelled = Progress::none().with_cancel(&stop);
    for region in [
        "all",
        "ball:vertex=0,radius=50%",
        "stroke:path=1 0 0;0 0 1;-1 0 0,radius=0.2",
        "box:min=-2 0 -2,max=2 2 2",
        "half-space:point=0 0 0,normal=0 0 1",
        "vertices:indices=3 5 8,radius=50%",
        "!(ball:vertex=0,radius=50% | all)",
    ] {
        let region = parse_region(region).unwrap();
        let error = region.weights(f.decomposer.metric(), &|_| None, &[], cancelled).unwrap_err();
        assert_eq!(error, RegionError::Cancelled(Cancelled), "{region:?}");
        let layers = [Layer { gains: Gains::Preset(Preset::Suppress), region: region.clone() }];
        let edit = Edit { layers: &layers, field: &|_| None, field_names: &[] };
        let error = edit.resolve(4, f.decomposer.metric(), cancelled).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Cancelled);
        // What was stopped is made by the next call.
        assert_eq!(weights(&f.decomposer, &region).len(), f.points.len());
    }
}
