//! `adwave render`: pictures of shapes, fields and features.

mod args;
mod balls;
mod framing;
mod glyphs;

use super::flat_grid::{FlatGrid, MOST_PLACES, ball_on_sheet};
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::with_spinner;
use crate::output::{check_writable, count, has_extension, note, print, write_file};
use crate::resolve::applicable::check_source_options;
use crate::resolve::operator::build_decomposer;
use crate::resolve::region::{WEIGHT, note_region, region_weights, union_of_regions};
use crate::resolve::shape::{Input, SampleSize, ShapeSource, load_source, row_words};
use crate::resolve::signal::{COORDS, Signal, default_signal, load_signal};
use crate::resolve::up::UpAxis;
use adwave::Progress;
use adwave::operator::OperatorParams;
use adwave::shape::{Graph, Shape, diagonal, picture_frame, triangulate};
use adwave::signal::SurfaceSignal;
use adwave_io::{Field, FieldValues};
use adwave_render::{
    Background, Ball, ColorBar, ColorMap, FieldPaint, Frame, Paint, Panel, Picture, Projection, RenderParams,
    SharedCamera, Surface, Tubes, Up, ValueRange, View, grid, render,
};
pub(crate) use args::RenderArgs;
use args::{RangeArg, SizeArg};
use balls::read_balls;
use glyphs::{Glyphs, draw_glyphs};
use serde_json::json;
use std::time::Instant;

/// Radius of the line of a curve, in diagonals of the part that the picture shows: about five pixels wide at the usual
/// size.
const TUBE_RADIUS: f64 = 0.002;

/// Name of the single color, instead of that of a signal.
const PLAIN: &str = "plain";

pub(crate) fn run(args: &RenderArgs, global: &Global<'_>) -> Result<(), CliError> {
    let params = check(args, global)?;
    let balls = args.features.as_deref().map(read_balls).transpose()?.unwrap_or_default();
    let start = Instant::now();
    let shapes = load_all(args, global)?;
    check_looks(&shapes, global)?;
    let balls = balls_on_shapes(balls, &shapes)?;
    let up = UpAxis::choose(args.up, &shapes[0].input);
    let params = match args.relief {
        _ if shapes[0].sheet.is_none() => params.with_up(up.up),
        Some(_) => params.with_up(Up::Z),
        None => params.with_up(Up::Y).with_view(View::FRONT).with_projection(Projection::Orthographic),
    };
    let params = params.with_framing(args.framing.resolve_for_shape(&shapes[0].input)?);
    let read = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let n_outside = note_outside(&shapes, params.frame, global);
    let picture =
        with_spinner(global, "drawing", || draw(args, &params, &shapes, &balls, global.progress()))?;
    let drawn = start.elapsed().as_secs_f64();
    let png = picture.png()?;
    write_file(global, &args.output, &png)?;
    let text = format!(
        "{} × {} pixels, {}; read {read:.2} s, drawn {drawn:.2} s\n{}{}",
        picture.width,
        picture.height,
        count_vertices(shapes.as_slice()),
        if shapes[0].sheet.is_some() { String::new() } else { up.line() },
        args.output.display()
    );
    let json = json!({
        "output": args.output.display().to_string(),
        "width": picture.width,
        "height": picture.height,
        "shapes": shapes.iter().map(|s| json!({
            "shape": s.input.name,
            row_words(&s.input.file)[1]: s.input.shape.n_vertices(),
            "colors": s.looks.iter().map(Look::label).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "features": balls.len(),
        "glyphs": shapes.iter().map(|s| s.glyphs.count).sum::<usize>(),
        "up": up.to_json(),
        "frame": params.frame.name(),
        "vertices_outside": n_outside,
        "zoom": params.framing.zoom,
        "focus": params.framing.focus,
        "projection": if args.orthographic { "orthographic" } else { "perspective" },
        "seconds": {"read": read, "draw": drawn},
    });
    print(global, &text, &json)
}

/// The number of vertices, pixels or voxels of all shapes.
fn count_vertices(shapes: &[ShownShape]) -> String {
    let [one, many] = shapes.first().map_or(["vertex", "vertices"], |shape| shape.input.row_words());
    count(shapes.iter().map(|s| s.input.shape.n_vertices()).sum::<usize>(), one, many)
}

/// Refuses options on colors and creases that no panel has.
fn check_looks(shapes: &[ShownShape], global: &Global<'_>) -> Result<(), CliError> {
    let given = global.given;
    let is_field = |look: &Look| matches!(look, Look::Field { .. });
    if !shapes.iter().any(|shape| shape.looks.iter().any(is_field)) {
        let applies = "applies to colors of a field (--color or --region), and the picture shows none";
        given.refuse(&["--color-map", "--range", "--no-bar"], applies)?;
    }
    if shapes.iter().all(|shape| shape.surface().1.is_empty()) {
        given.refuse(&["--crease"], "applies to meshes, and the picture shows none")?;
    }
    let inputs: Vec<&Input> = shapes.iter().map(|shape| &shape.input).collect();
    check_source_options(&inputs, global)
}

/// Number of vertices that the pictures leave out, with a note.
fn note_outside(shapes: &[ShownShape], frame: Frame, global: &Global<'_>) -> usize {
    let outside = |shape: &ShownShape| {
        let points = shape.input.shape.points().unwrap_or_default();
        Surface { points, triangles: &shape.triangles, paint: Paint::CLAY }.n_outside(frame)
    };
    let n_outside: usize = shapes.iter().map(outside).sum();
    if n_outside > 0 {
        let vertices = count(n_outside, "vertex", "vertices");
        note(
            global,
            &format!("the picture leaves out {vertices} far from all others; --frame all shows them"),
        );
    }
    n_outside
}

/// The parameters of the picture. Refuses arguments that are invalid for all shapes, before anything is read.
fn check(args: &RenderArgs, global: &Global<'_>) -> Result<RenderParams, CliError> {
    if !has_extension(&args.output, &["png"]) {
        return Err(CliError::Input(format!("{}: a picture is written as .png", args.output.display())));
    }
    check_writable(&args.output)?;
    if args.grid.is_none() && args.shapes.len() * args.color.len().max(1) > 1 {
        return Err(CliError::Input(
            "several shapes or signals need --grid, which puts them on one sheet".to_owned(),
        ));
    }
    if !args.color.iter().any(|name| name.starts_with("texture")) {
        global.given.refuse(&["--texture"], "applies to --color texture and other signals of a texture")?;
    }
    color_map(args)?;
    let usual = if args.grid.is_some() { SizeArg(600, 500) } else { SizeArg(1200, 900) };
    let SizeArg(width, height) = args.size.unwrap_or(usual);
    let background = if args.transparent { Background::Transparent } else { Background::Color([255; 3]) };
    let usual = RenderParams::default();
    let projection = if args.orthographic { Projection::Orthographic } else { usual.projection };
    let params = usual
        .with_size(width, height)
        .with_view(args.view)
        .with_projection(projection)
        .with_framing(args.framing.without_vertex())
        .with_frame(args.framing.frame)
        .with_background(background)
        .with_color_bar(if args.no_bar { ColorBar::Hidden } else { ColorBar::Shown })
        .with_crease_angle(args.crease);
    params.check()?;
    Ok(params)
}

fn color_map(args: &RenderArgs) -> Result<Option<ColorMap>, CliError> {
    let Some(name) = &args.color_map else { return Ok(None) };
    ColorMap::from_name(name).map(Some).ok_or_else(|| {
        let names: Vec<&str> = ColorMap::names().collect();
        CliError::Input(format!("--color-map must be one of {}, got '{name}'", names.join(", ")))
    })
}

/// A shape and the colors of its panels.
struct ShownShape {
    input: Input,
    triangles: Vec<[u32; 3]>,
    /// Tubes around the edges of a curve or graph.
    tubes: Option<Tubes>,
    /// An image, or the slices of a volume.
    sheet: Option<FlatGrid>,
    looks: Vec<Look>,
    glyphs: Glyphs,
}

impl ShownShape {
    /// Points and triangles that are drawn.
    fn surface(&self) -> (&[[f64; 3]], &[[u32; 3]]) {
        match (&self.tubes, &self.sheet) {
            (Some(tubes), _) => (tubes.points(), tubes.triangles()),
            (None, Some(sheet)) => (sheet.points(), sheet.triangles()),
            (None, None) => (self.input.shape.points().unwrap_or_default(), &self.triangles),
        }
    }

    /// Colors of the points that are drawn.
    fn drawn_look(&self, look: &Look) -> Look {
        match look {
            Look::Plain => Look::Plain,
            Look::Colors { values, label } => {
                Look::Colors { values: self.spread(values), label: label.clone() }
            }
            Look::Field { values, label, unit, range } => {
                Look::Field { values: self.spread(values), label: label.clone(), unit: *unit, range: *range }
            }
        }
    }

    /// Values of the vertices at the points that are drawn.
    fn spread<T: Copy>(&self, values: &[T]) -> Vec<T> {
        match (&self.tubes, &self.sheet) {
            (Some(tubes), _) => tubes.spread(values),
            (None, Some(sheet)) => sheet.spread(values),
            (None, None) => values.to_vec(),
        }
    }
}

/// The colors of one panel.
#[derive(Clone)]
enum Look {
    Plain,
    Colors { values: Vec<[u8; 3]>, label: String },
    Field { values: Vec<f64>, label: String, unit: Option<&'static str>, range: ValueRange },
}

impl Look {
    fn label(&self) -> Option<&str> {
        match self {
            Self::Plain => None,
            Self::Colors { label, .. } | Self::Field { label, .. } => Some(label),
        }
    }
}

fn load_all(args: &RenderArgs, global: &Global<'_>) -> Result<Vec<ShownShape>, CliError> {
    args.shapes.iter().map(|name| load(args, name, global)).collect()
}

fn load(args: &RenderArgs, name: &str, global: &Global<'_>) -> Result<ShownShape, CliError> {
    let (kind, part, selection) = (args.kind, args.part.to_part(), Some(&args.selection));
    let sample = SampleSize { n_vertices: args.vertices, ..SampleSize::default() };
    let source = ShapeSource { kind, sample, part, selection, ..ShapeSource::new(name) };
    let input = load_source(&source, global)?;
    if let Some(layout) = input.file.grid() {
        let sheet = FlatGrid::new(layout, name, MOST_PLACES, global)?;
        return load_sheet(args, input, sheet, global);
    }
    let applies = format!("applies to images, and {name} is a {}", input.kind_name());
    global.given.refuse(&["--relief"], &applies)?;
    let Some(points) = input.shape.points() else {
        return Err(CliError::Input(format!(
            "{name}: a graph has no positions to draw; only nodes with finite positions are drawn, as lines"
        )));
    };
    let tubes = match &input.shape {
        Shape::Graph(graph) => Some(tubes(graph, points)),
        _ => None,
    };
    let triangles =
        if let Some(mesh) = input.shape.as_mesh() { triangulate(points, mesh.faces()) } else { Vec::new() };
    let looks = if !args.region.is_empty() {
        vec![region_look(args, &input, global)?]
    } else if args.color.is_empty() && has_one_channel(&input) {
        vec![look(args, global, &input, default_signal(&input.file))?]
    } else if args.color.is_empty() {
        let colors = input.file.field("color").and_then(bytes);
        vec![colors.map_or(Look::Plain, |values| Look::Colors { values, label: "color".to_owned() })]
    } else {
        args.color.iter().map(|color| look(args, global, &input, color)).collect::<Result<_, _>>()?
    };
    let glyphs = match &args.glyphs {
        Some(name) => draw_glyphs(&input, name, args.glyph_kind.unwrap_or_default(), global)?,
        None => Glyphs::default(),
    };
    Ok(ShownShape { input, triangles, tubes, sheet: None, looks, glyphs })
}

/// True for a map whose first field has one value for each vertex.
fn has_one_channel(input: &Input) -> bool {
    input.file.is_map() && input.file.vertex_fields().first().is_some_and(|field| field.n_channels == 1)
}

/// An image or the slices of a volume with their colors: by default those of the file, else gray.
fn load_sheet(
    args: &RenderArgs,
    input: Input,
    mut sheet: FlatGrid,
    global: &Global<'_>,
) -> Result<ShownShape, CliError> {
    let is_volume = input.file.grid().is_some_and(|layout| layout.sizes.len() > 2);
    let usual = [default_signal(&input.file).to_owned()];
    let looks = if args.region.is_empty() {
        let colors = if args.color.is_empty() { &usual[..] } else { &args.color };
        colors.iter().map(|color| look(args, global, &input, color)).collect::<Result<_, _>>()?
    } else {
        vec![region_look(args, &input, global)?]
    };
    match args.relief {
        Some(_) if is_volume => {
            return Err(CliError::Input(format!(
                "--relief needs an image, and {} is a volume; leave it out",
                input.name
            )));
        }
        Some(factor) => {
            let heights = load_signal(global, &input, &usual[0], None)?;
            if heights.n_channels != 1 {
                return Err(CliError::Input(format!(
                    "--relief needs one value per pixel for the heights, and {} has {}; leave it out",
                    input.name, heights.n_channels
                )));
            }
            sheet.raise(&heights.values, factor);
        }
        None => {
            let applies =
                "applies to shapes, and an image or a volume is drawn flat (--relief gives an image heights)";
            global.given.refuse(&["--view", "--up", "--orthographic", "--crease"], applies)?;
        }
    }
    let applies = "applies to meshes and point clouds, and an image or a volume is none";
    global.given.refuse(&["--glyphs"], applies)?;
    let (triangles, tubes, glyphs) = (Vec::new(), None, Glyphs::default());
    Ok(ShownShape { input, triangles, tubes, sheet: Some(sheet), looks, glyphs })
}

/// Balls at the places where images show them.
fn balls_on_shapes(balls: Vec<Ball>, shapes: &[ShownShape]) -> Result<Vec<Ball>, CliError> {
    let Some(layout) = shapes[0].input.file.grid().filter(|_| !balls.is_empty()) else { return Ok(balls) };
    if layout.sizes.len() > 2 || shapes.len() > 1 {
        return Err(CliError::Input(format!(
            "--features needs one image or shapes, and {} is a {}; leave it out",
            shapes[0].input.name,
            shapes[0].input.kind_name()
        )));
    }
    Ok(balls.into_iter().map(|ball| ball_on_sheet(layout, ball)).collect())
}

/// Tubes around the edges of a graph, thin relative to the part that the picture shows.
fn tubes(graph: &Graph, points: &[[f64; 3]]) -> Tubes {
    let neighbors = |x: u32| graph.adjacency().row(x as usize).iter().map(move |&y| [x, y]);
    let edges: Vec<[u32; 2]> = (0..points.len() as u32).flat_map(neighbors).filter(|[x, y]| x < y).collect();
    let size = picture_frame(points, None).map_or(0.0, |(low, high)| diagonal(&[low, high]));
    let size = if size > 0.0 { size } else { diagonal(points) };
    Tubes::new(points, &edges, if size > 0.0 { TUBE_RADIUS * size } else { 1.0 })
}

/// The weights of the regions.
fn region_look(args: &RenderArgs, input: &Input, global: &Global<'_>) -> Result<Look, CliError> {
    let progress = global.progress();
    let decomposer = build_decomposer(input, &OperatorParams::default(), progress)?;
    let region = union_of_regions(&args.region);
    note_region(&region, &input.file, &decomposer, global)?;
    let values = region_weights(&region, input, &decomposer, progress)?;
    let range = ValueRange::Fixed(0.0, 1.0);
    Ok(Look::Field { values, label: WEIGHT.to_owned(), unit: None, range })
}

/// The colors of a panel by the name of a signal: its number, the length of its vectors, or the colors that it stores.
fn look(args: &RenderArgs, global: &Global<'_>, input: &Input, name: &str) -> Result<Look, CliError> {
    if name == PLAIN {
        return Ok(Look::Plain);
    }
    let label = name.rsplit('/').next().unwrap_or(name).to_owned();
    if let Some(field) = input.file.field(name)
        && (name == "color" || matches!(field.values, FieldValues::U8(_)))
        && let Some(values) = bytes(field)
    {
        return Ok(Look::Colors { values, label });
    }
    let texture = args.texture.as_deref().filter(|_| name.starts_with("texture"));
    let Signal { n_channels, values, .. } = load_signal(global, input, name, texture)?;
    if name == "texture"
        && let Some(values) = bytes(&Field::new(name, n_channels, FieldValues::F64(values.to_vec())))
    {
        return Ok(Look::Colors { values, label });
    }
    // A field of the file takes precedence over a signal of the shape, and its unit is not known.
    let surface_signal = SurfaceSignal::from_name(name).filter(|_| input.file.field(name).is_none());
    let unit =
        if name == COORDS { Some("model units") } else { surface_signal.and_then(SurfaceSignal::unit) };
    if n_channels == 1 {
        return Ok(Look::Field { values: values.to_vec(), label, unit, range: ValueRange::Auto });
    }
    if input.file.grid().is_some() {
        note(global, &format!("{name} has {n_channels} values per place: the first is drawn"));
        let values = values.iter().step_by(n_channels).copied().collect();
        return Ok(Look::Field { values, label, unit, range: ValueRange::Auto });
    }
    let length = |row: &[f64]| row.iter().map(|v| v * v).sum::<f64>().sqrt();
    Ok(Look::Field {
        values: values.chunks_exact(n_channels).map(length).collect(),
        label: format!("|{label}|"),
        unit,
        range: ValueRange::Auto,
    })
}

/// Red, green and blue in bytes; `None` of fewer than three channels.
fn bytes(colors: &Field) -> Option<Vec<[u8; 3]>> {
    if colors.n_channels < 3 {
        return None;
    }
    let scale = 255.0 / colors.full_intensity();
    let byte = |x: usize, c: usize| (scale * colors.get(x, c)).round().clamp(0.0, 255.0) as u8;
    Some((0..colors.len()).map(|x| [0, 1, 2].map(|c| byte(x, c))).collect())
}

fn draw(
    args: &RenderArgs,
    params: &RenderParams,
    shapes: &[ShownShape],
    balls: &[Ball],
    progress: Progress<'_>,
) -> Result<Picture, CliError> {
    let color_map = color_map(args)?;
    let drawn: Vec<(&ShownShape, Look)> = shapes
        .iter()
        .flat_map(|shape| shape.looks.iter().map(move |look| (shape, shape.drawn_look(look))))
        .collect();
    let panels: Vec<Panel<'_>> = drawn
        .iter()
        .map(|(shape, look)| (*shape, look))
        .map(|(shape, look)| {
            let paint = match look {
                Look::Plain => Paint::CLAY,
                Look::Colors { values, .. } => Paint::Colors(values),
                Look::Field { values, label, unit, range } => {
                    let range = match args.range {
                        RangeArg::Auto => *range,
                        RangeArg::Fixed(low, high) => ValueRange::Fixed(low, high),
                    };
                    let label = unit.map_or_else(|| label.clone(), |unit| format!("{label} ({unit})"));
                    let usual =
                        shape.sheet.as_ref().filter(|_| args.color.is_empty() && args.region.is_empty());
                    let color_map = color_map.or(usual.and_then(|_| ColorMap::from_name("gray")));
                    Paint::Field(FieldPaint { values, label, color_map, range })
                }
            };
            let (points, triangles) = shape.surface();
            Panel {
                surface: Surface { points, triangles, paint },
                balls: [balls, &shape.glyphs.balls].concat(),
                caption: caption(args, &shape.input.name, look.label()),
            }
        })
        .collect();
    if args.grid.is_none() {
        return Ok(render(&panels[0].surface, &panels[0].balls, params, progress)?);
    }
    let camera = if args.own_scale { SharedCamera::Own } else { SharedCamera::Same };
    Ok(grid(&panels, args.columns(panels.len()), camera, params, progress)?)
}

/// Caption that distinguishes a panel from the others.
fn caption(args: &RenderArgs, shape: &str, label: Option<&str>) -> String {
    let file = shape.rsplit('/').next().unwrap_or(shape);
    match (args.shapes.len() > 1, label.filter(|_| !(args.color.is_empty() && args.region.is_empty()))) {
        (false, Some(label)) => label.to_owned(),
        (true, Some(label)) => format!("{file}: {label}"),
        (_, None) => file.to_owned(),
    }
}
