//! Laws of the editing object: whatever way led to its layers, the result has the same bits, and it is the filter's.

use adwave::bands::Schedule;
use adwave::filter::{BandsView, FilterError, Gains, Layer, Preset, WeightedLayer, filter_bands};
use adwave::region::{RegionWeights, parse_region};
use adwave::sample::Sample;
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};
use adwave::{BandsRequest, ChangedVertices, Decomposer, Editor, Progress, filter::Edit};

/// Bands are accurate to 1e-10 of themselves, and a one-off filter of one layer sums them in another way.
const ACCURACY: f64 = 1e-9;
const N_LEVELS: usize = 6;

struct Fixture {
    decomposer: Decomposer,
    points: Vec<[f64; 3]>,
    schedule: Schedule,
}

fn fixture(shape: &Shape) -> Fixture {
    let points = shape.points().unwrap().to_vec();
    Fixture { decomposer: Decomposer::new(shape), points, schedule: Schedule::dyadic(N_LEVELS).unwrap() }
}

impl Fixture {
    fn request(&self) -> BandsRequest<'_> {
        self.decomposer.request(self.points.as_flattened(), 3, &self.schedule)
    }

    fn weights(&self, region: &str) -> RegionWeights {
        parse_region(region)
            .unwrap()
            .weights(self.decomposer.metric(), &|_| None, &[], Progress::none())
            .unwrap()
    }

    fn layer(&self, gain: f64, region: &str) -> WeightedLayer {
        let gains = (0..N_LEVELS).map(|j| gain + 0.1 * j as f64).collect();
        WeightedLayer { gains, weights: self.weights(region) }
    }
}

/// A mesh, a cloud, and triangles that share positions and no vertices.
fn shapes() -> Vec<(&'static str, Shape)> {
    let sample = Sample::from_name("torus", Some(6000)).unwrap();
    let (points, faces) = (sample.points.clone(), sample.faces.clone());
    let corners: Vec<[f64; 3]> = faces.corners().iter().map(|&c| points[c as usize]).collect();
    let soup: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    vec![
        ("mesh", Shape::Mesh(Mesh::new(points.clone(), faces).unwrap())),
        ("cloud", Shape::Cloud(PointCloud::new(points).unwrap())),
        ("soup", Shape::Mesh(Mesh::new(corners, Polygons::from_triangles(&soup)).unwrap())),
    ]
}

/// The bits of a fresh editor with these layers.
fn fresh(f: &Fixture, layers: &[WeightedLayer]) -> Vec<f64> {
    let mut editor = f.request().editor().unwrap();
    editor.set_layers(layers.to_vec()).unwrap();
    editor.into_edited()
}

#[test]
fn it_gives_what_a_single_filter_gives() {
    for (name, shape) in shapes() {
        let f = fixture(&shape);
        let ball = f.layer(2.0, "ball:vertex=7,radius=20%");
        let field: Vec<f64> = (0..f.points.len()).map(|x| (x % 11) as f64 / 10.0).collect();
        let field = WeightedLayer { weights: RegionWeights::Vertices(field), ..f.layer(0.3, "all") };
        for layers in [vec![f.layer(0.5, "all")], vec![ball.clone()], vec![ball, f.layer(1.5, "all"), field]]
        {
            let once = f.request().filter_layers(&layers).unwrap();
            for (a, b) in once.iter().zip(fresh(&f, &layers)) {
                assert!((a - b).abs() < ACCURACY, "{name}: {a} and {b}");
            }
        }
    }
}

#[test]
fn bands_in_the_order_of_the_shape_give_the_same_bits() {
    for (name, shape) in shapes() {
        let f = fixture(&shape);
        let map = f.decomposer.vertex_map();
        if map.n_welded() < map.n_vertices() {
            assert_eq!(name, "soup");
            continue;
        }
        let bands = f.request().bands().unwrap().into_vec();
        let (signal, n) = (f.points.as_flattened(), f.points.len());
        let weights: Vec<f64> = (0..n).map(|x| (x % 11) as f64 / 10.0).collect();
        let by_vertex = WeightedLayer { weights: RegionWeights::Vertices(weights), ..f.layer(0.3, "all") };
        let ball = f.layer(2.0, "ball:vertex=7,radius=20%");
        let all = f.layer(0.5, "all");
        let mut out = vec![f64::NAN; signal.len()];
        let view = |coefficients| BandsView { coefficients, n_levels: N_LEVELS, n_channels: 3 };
        for layers in [
            vec![],
            vec![all.clone()],
            vec![ball.clone()],
            vec![ball, all, by_vertex.clone()],
            vec![by_vertex],
        ] {
            filter_bands(signal, view(&bands), &layers, map, &mut out).unwrap();
            assert_eq!(out, fresh(&f, &layers), "{name}, {} layers", layers.len());
        }
        let short = filter_bands(signal, view(&bands[..9]), &[], map, &mut out);
        assert!(matches!(short, Err(FilterError::Bands(_))));
        let many = [WeightedLayer::everywhere(vec![1.0; N_LEVELS + 1])];
        assert!(filter_bands(signal, view(&bands), &many, map, &mut out).is_err());
    }
}

#[test]
fn any_way_to_the_same_layers_gives_the_same_bits() {
    for (name, shape) in shapes() {
        let f = fixture(&shape);
        let (small, large) = ("ball:vertex=7,radius=5%", "ball:vertex=90,radius=9%");
        let mut editor = f.request().editor().unwrap();
        assert_eq!(editor.edited(), f.points.as_flattened());
        let ball = f.layer(3.0, small);
        let everywhere = f.layer(0.7, "all");
        assert_eq!(editor.push_layer(everywhere.clone()).unwrap(), ChangedVertices::All);
        assert!(matches!(editor.push_layer(ball.clone()).unwrap(), ChangedVertices::Listed(_)));
        assert_eq!(editor.edited(), fresh(&f, &[everywhere.clone(), ball.clone()]), "{name}: pushed");
        let moved = WeightedLayer { weights: f.weights(large), ..ball.clone() };
        let ChangedVertices::Listed(touched) = editor.set_weights(2, f.weights(large)).unwrap() else {
            panic!("{name}: a ball that moves touches what it covered and what it covers")
        };
        assert!(touched.is_sorted() && touched.len() < f.points.len() / 5, "{name}: {}", touched.len());
        assert_eq!(editor.edited(), fresh(&f, &[everywhere.clone(), moved.clone()]), "{name}: moved");
        let louder = WeightedLayer { gains: vec![5.0; N_LEVELS], ..moved };
        editor.set_gains(2, &louder.gains).unwrap();
        assert_eq!(editor.edited(), fresh(&f, &[everywhere.clone(), louder]), "{name}: louder");
        editor.remove_layer(2).unwrap();
        assert_eq!(editor.edited(), fresh(&f, std::slice::from_ref(&everywhere)), "{name}: removed");
        editor.remove_layer(1).unwrap();
        assert_eq!(editor.edited(), f.points.as_flattened(), "{name}: all removed");
    }
}

#[test]
fn what_a_region_does_not_cover_keeps_its_bits() {
    for (name, shape) in shapes() {
        let f = fixture(&shape);
        let layer = f.layer(4.0, "ball:vertex=3,radius=8%");
        let weights = layer.weights.to_vertices(f.decomposer.vertex_map());
        let edited = fresh(&f, &[layer]);
        for (x, (p, q)) in f.points.iter().zip(edited.as_chunks::<3>().0).enumerate() {
            assert_eq!(p == q, weights[x] == 0.0, "{name}: vertex {x} of weight {}", weights[x]);
        }
    }
}

#[test]
fn edits_of_a_masked_signal_leave_what_is_masked_alone() {
    let (_, shape) = shapes().swap_remove(0);
    let signal: Vec<f64> = (0..6000).map(|x| if x < 50 { f64::NAN } else { f64::from(x % 17) }).collect();
    let flags: Vec<bool> = signal.iter().map(|v| v.is_nan()).collect();
    let masked = Decomposer::new(&shape).masked(&flags[..shape.n_vertices()]).unwrap();
    let signal = &signal[..shape.n_vertices()];
    let schedule = Schedule::dyadic(3).unwrap();
    let request = masked.request(signal, 1, &schedule);
    let layers = [Layer { gains: Gains::Preset(Preset::Suppress), region: parse_region("all").unwrap() }];
    let once = request.filter(&Edit::new(&layers)).unwrap();
    let mut editor = request.editor().unwrap();
    editor.set_edit(&Edit::new(&layers)).unwrap();
    for ((a, b), masked) in once.iter().zip(editor.edited()).zip(&flags) {
        assert!(if *masked { a.is_nan() && b.is_nan() } else { (a - b).abs() < ACCURACY }, "{a} {b}");
    }
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let (_, shape) = shapes().swap_remove(1);
    let f = fixture(&shape);
    let mut editor: Editor = f.request().editor().unwrap();
    editor.set_layers(vec![f.layer(0.5, "all")]).unwrap();
    let before = editor.edited().to_vec();
    assert_eq!(
        editor.set_gains(1, &[1.0]).unwrap_err(),
        FilterError::WrongNumberOfGains { n_gains: 1, n_levels: N_LEVELS }
    );
    assert_eq!(
        editor.set_gains(2, &[1.0; N_LEVELS]).unwrap_err(),
        FilterError::NoSuchLayer { layer: 2, n_layers: 1 }
    );
    assert!(matches!(editor.set_gains(1, &[f64::NAN; N_LEVELS]), Err(FilterError::BadGain { .. })));
    assert!(editor.remove_layer(0).is_err());
    for weights in [
        RegionWeights::Vertices(vec![1.0; 3]),
        RegionWeights::Welded(vec![f64::NAN; f.decomposer.n_places()]),
        RegionWeights::Sparse { vertices: vec![u32::MAX], weights: vec![1.0] },
    ] {
        assert!(editor.set_weights(1, weights).is_err());
    }
    assert_eq!(editor.edited(), before);
}
