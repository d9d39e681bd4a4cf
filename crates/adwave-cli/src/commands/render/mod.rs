//! `adwave render`: pictures of shapes, fields and features.

mod args;
mod balls;
mod framing;

use crate::commands::region::WEIGHT;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{check_writable, print, write_error};
use crate::progress::with_spinner;
use crate::region::{joined, weights};
use crate::shape_input::{Input, Source, load_source};
use crate::signal::{self, COORDS, Signal};
use crate::up::Upward;
use adwave::operator::OperatorParams;
use adwave::shape::{Shape, triangulate};
use adwave::signal::SurfaceSignal;
use adwave::{Decomposer, Progress};
use adwave_io::{FieldValues, atomic_write};
use adwave_render::{
    Background, Ball, ColorBar, ColorMap, FieldPaint, Paint, Panel, Picture, Projection, RenderParams,
    SharedCamera, Surface, ValueRange, grid, render,
};
pub(crate) use args::RenderArgs;
use args::{RangeArg, SizeArg};
use balls::features;
use serde_json::json;
use std::time::Instant;

/// The name of no field at all.
const PLAIN: &str = "plain";

pub(crate) fn run(args: &RenderArgs, global: &Global<'_>) -> Result<(), CliError> {
    let params = check(args)?;
    let balls = args.features.as_deref().map(features).transpose()?.unwrap_or_default();
    let start = Instant::now();
    let shapes = with_spinner(global, "reading", || load_all(args, global))?;
    let upward = Upward::of(args.up, &shapes[0].input);
    let params = params.with_up(upward.up).with_framing(args.framing.of(&shapes[0].input)?);
    let read = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let picture =
        with_spinner(global, "drawing", || draw(args, &params, &shapes, &balls, global.progress()))?;
    let drawn = start.elapsed().as_secs_f64();
    let png = picture.png()?;
    atomic_write(&args.output, |out| Ok(out.write_all(&png)?)).map_err(write_error)?;
    let text = format!(
        "{} × {} pixels, {} vertices; read {read:.2} s, drawn {drawn:.2} s\n{}{}",
        picture.width,
        picture.height,
        shapes.iter().map(|s| s.input.shape.n_vertices()).sum::<usize>(),
        upward.line(),
        args.output.display()
    );
    let json = json!({
        "output": args.output.display().to_string(),
        "width": picture.width,
        "height": picture.height,
        "shapes": shapes.iter().map(|s| json!({
            "shape": s.input.name,
            "vertices": s.input.shape.n_vertices(),
            "colors": s.looks.iter().map(Look::label).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "features": balls.len(),
        "up": upward.json(),
        "zoom": params.framing.zoom,
        "focus": params.framing.focus,
        "projection": if args.orthographic { "orthographic" } else { "perspective" },
        "seconds": {"read": read, "draw": drawn},
    });
    print(global, &text, &json)
}

/// What can be refused before anything is read.
fn check(args: &RenderArgs) -> Result<RenderParams, CliError> {
    if !args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return Err(CliError::Input(format!("{}: a picture is written as .png", args.output.display())));
    }
    check_writable(&args.output)?;
    if args.grid.is_none() && args.shapes.len() * args.color.len().max(1) > 1 {
        return Err(CliError::Input("several shapes or fields go on one sheet; add --grid".to_owned()));
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
        .with_background(background)
        .with_color_bar(if args.no_bar { ColorBar::Hidden } else { ColorBar::Shown })
        .with_crease_angle(args.crease);
    params.check()?;
    Ok(params)
}

fn color_map(args: &RenderArgs) -> Result<Option<ColorMap>, CliError> {
    let Some(name) = &args.colormap else { return Ok(None) };
    ColorMap::from_name(name).map(Some).ok_or_else(|| {
        let names: Vec<&str> = ColorMap::names().collect();
        CliError::Input(format!("there is no color map '{name}'; there is {}", names.join(", ")))
    })
}

/// A shape and what is shown of it.
struct Loaded {
    input: Input,
    triangles: Vec<[u32; 3]>,
    looks: Vec<Look>,
}

/// The colors of one panel.
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

fn load_all(args: &RenderArgs, global: &Global<'_>) -> Result<Vec<Loaded>, CliError> {
    args.shapes.iter().map(|name| load(args, name, global)).collect()
}

fn load(args: &RenderArgs, name: &str, global: &Global<'_>) -> Result<Loaded, CliError> {
    let (kind, vertices, part) = (args.kind, args.vertices, args.part.part());
    let input = load_source(&Source { kind, vertices, part, ..Source::new(name) }, global)?;
    let Some(points) = input.shape.points() else {
        return Err(CliError::Input(format!("{name}: a graph has no positions to draw")));
    };
    let triangles =
        if let Shape::Mesh(mesh) = &input.shape { triangulate(points, mesh.faces()) } else { Vec::new() };
    let looks = if !args.region.is_empty() {
        vec![region_look(args, &input, global)?]
    } else if args.color.is_empty() {
        let colors = input.file.field("color").and_then(|field| bytes(field.n_channels, &field.values));
        vec![colors.map_or(Look::Plain, |values| Look::Colors { values, label: "color".to_owned() })]
    } else {
        args.color.iter().map(|color| look(args, global, &input, color)).collect::<Result<_, _>>()?
    };
    Ok(Loaded { input, triangles, looks })
}

/// The weights of the regions.
fn region_look(args: &RenderArgs, input: &Input, global: &Global<'_>) -> Result<Look, CliError> {
    let progress = global.progress();
    let decomposer = Decomposer::with_params(&input.shape, &OperatorParams::default(), progress)
        .map_err(|_| CliError::Cancelled)?;
    let values = weights(&joined(&args.region), input, &decomposer, progress)?;
    let range = ValueRange::Fixed(0.0, 1.0);
    Ok(Look::Field { values, label: WEIGHT.to_owned(), unit: None, range })
}

/// What is shown by a field's name: its number, its length where it has several, or the colors that it holds.
fn look(args: &RenderArgs, global: &Global<'_>, input: &Input, name: &str) -> Result<Look, CliError> {
    if name == PLAIN {
        return Ok(Look::Plain);
    }
    let label = name.rsplit('/').next().unwrap_or(name).to_owned();
    if let Some(field) = input.file.field(name)
        && (name == "color" || matches!(field.values, FieldValues::U8(_)))
        && let Some(values) = bytes(field.n_channels, &field.values)
    {
        return Ok(Look::Colors { values, label });
    }
    let texture = args.texture.as_deref().filter(|_| name.starts_with("texture"));
    let Signal { n_channels, values } = signal::load(global, input, name, texture)?;
    if name == "texture"
        && let Some(values) = bytes(n_channels, &FieldValues::F64(values.to_vec()))
    {
        return Ok(Look::Colors { values, label });
    }
    // A field of the file goes before what the shape gives by itself, and its unit is not known.
    let own = SurfaceSignal::from_name(name).filter(|_| input.file.field(name).is_none());
    let unit = if name == COORDS { Some("model units") } else { own.and_then(SurfaceSignal::unit) };
    if n_channels == 1 {
        return Ok(Look::Field { values: values.to_vec(), label, unit, range: ValueRange::Auto });
    }
    let length = |row: &[f64]| row.iter().map(|v| v * v).sum::<f64>().sqrt();
    Ok(Look::Field {
        values: values.chunks_exact(n_channels).map(length).collect(),
        label: format!("|{label}|"),
        unit,
        range: ValueRange::Auto,
    })
}

/// Red, green and blue in bytes, of bytes, of words, or of numbers in [0, 1] (or to 255 where some are above 1).
fn bytes(n_channels: usize, values: &FieldValues) -> Option<Vec<[u8; 3]>> {
    if n_channels < 3 {
        return None;
    }
    let numbers = values.to_f64();
    let scale = match values {
        FieldValues::U16(words) if words.iter().any(|w| *w > 255) => 255.0 / 65535.0,
        // Many scanners write bytes into the words of LAS.
        FieldValues::U8(_) | FieldValues::U16(_) => 1.0,
        _ if numbers.iter().any(|v| *v > 1.0) => 1.0,
        _ => 255.0,
    };
    let byte = |v: f64| (scale * v).round().clamp(0.0, 255.0) as u8;
    Some(numbers.chunks_exact(n_channels).map(|row| [byte(row[0]), byte(row[1]), byte(row[2])]).collect())
}

fn draw(
    args: &RenderArgs,
    params: &RenderParams,
    shapes: &[Loaded],
    balls: &[Ball],
    progress: Progress<'_>,
) -> Result<Picture, CliError> {
    let color_map = color_map(args)?;
    let panels: Vec<Panel<'_>> = shapes
        .iter()
        .flat_map(|shape| shape.looks.iter().map(move |look| (shape, look)))
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
                    Paint::Field(FieldPaint { values, label, color_map, range })
                }
            };
            let points = shape.input.shape.points().unwrap_or_default();
            Panel {
                surface: Surface { points, triangles: &shape.triangles, paint },
                balls: balls.to_vec(),
                caption: caption(args, &shape.input.name, look.label()),
            }
        })
        .collect();
    if args.grid.is_none() {
        return Ok(render(&panels[0].surface, balls, params, progress)?);
    }
    let camera = if args.own_scale { SharedCamera::Own } else { SharedCamera::Same };
    Ok(grid(&panels, args.columns(panels.len()), camera, params, progress)?)
}

/// What tells a panel from the others.
fn caption(args: &RenderArgs, shape: &str, label: Option<&str>) -> String {
    let file = shape.rsplit('/').next().unwrap_or(shape);
    match (args.shapes.len() > 1, label.filter(|_| !(args.color.is_empty() && args.region.is_empty()))) {
        (false, Some(label)) => label.to_owned(),
        (true, Some(label)) => format!("{file}: {label}"),
        (_, None) => file.to_owned(),
    }
}
