//! Edit recipes: small TOML files that people can read, write and apply again.
//!
//! ```toml
//! levels = 6                     # or steps = [1, 2.5, 4], or lengths = [0.01, "2%"]; left out: as many as fit the shape
//! operator = "walk"               # or "surface"; left out: the walk, with lengths the surface
//! density_invariant = true       # left out: false; and so keep_creases
//! field = "coords"               # left out: the coordinates
//! along = "normal"               # of coordinates: or "free", "surface", "x", "y", "z"; left out: normal for clouds, else free
//! local_fit = "linear"           # of a field, or along x, y or z: or "constant"; left out: linear
//! border = "natural"             # of coordinates: or "keep", "free"; left out: natural
//! volume = "keep"                # of coordinates: by an offset; left out: free
//! turned = [0, 512]              # of coordinates: first vertices of parts whose faces are turned over; left out: none
//!
//! [[layer]]
//! preset = "suppress"            # or gains = [0.0, 0.0, 1.0, 1.0, 1.0, 1.0]
//! region = "ball:vertex=120,radius=10%"     # as on the command line; left out: everywhere
//!
//! [[layer]]
//! gains = [3.0, 2.0, 1.0, 1.0, 1.0, 1.0]
//! region.half-space = { point = [0.0, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }
//!
//! [[clone]]                      # of coordinates: detail finer than 4.5 % of the diagonal, on top of the layers
//! source = 120                   # vertices, from 0
//! targets = [15, 16]
//! radius = "5%"
//! angle = 90.0                   # degrees about the normal; left out: 0
//! strength = 0.5                 # left out: 1
//!
//! [pose]                         # of coordinates: handles bend the filtered shape; left out: it keeps its pose
//! fixed = "ball:vertex=7,radius=10%"        # left out: nothing stays
//! stiffness = "5%"               # left out: 0.75 times the width; and so width, 4.5%
//!
//! [[pose.handle]]
//! region = "ball:vertex=1972,radius=5%"
//! turn = [0.0, 0.0, 30.0]        # axis, as long as the angle in degrees, through the center of the region; left out: none
//! by = [0.0, 0.0, 0.3]           # then by a vector in model units; left out: none
//! ```

use crate::{DetailClone, Pose, ReadError, WriteError, atomic_write};
use adwave::LevelSpec;
use adwave::bands::MAX_STEPS;
use adwave::filter::Layer;
use adwave::local_fit::LocalFit;
use adwave::operator::OperatorKind;
use adwave::positions::{Borders, MoveDirection, PositionParams, Volume};
use adwave::region::Length;
use serde::{Deserialize, Serialize, Serializer};
use std::io::Read;
use std::path::Path;

/// Edit: layers, the levels of their gains, and the signal they change.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    /// Name of the signal; `coords` stands for the coordinates.
    pub field: String,
    /// Operator that smooths the signal; `None` lets the reader choose by the levels.
    pub operator: Option<OperatorKind>,
    /// True if the walk is made independent of the sampling density.
    pub density_invariant: bool,
    /// True if steps prefer vertices with similar normals.
    pub keep_creases: bool,
    /// Fields that smoothing leaves unchanged, where a field or one coordinate changes; `None` means linear ones.
    pub local_fit: Option<LocalFit>,
    /// Constraints on new positions.
    pub positions: PositionParams,
    /// Levels of the gains.
    pub levels: LevelSpec,
    /// Changes and their regions.
    pub layers: Vec<Layer>,
    /// Clones of detail, which are added to the filtered shape.
    pub clones: Vec<DetailClone>,
    /// Handles that bend the filtered shape.
    pub pose: Option<Pose>,
    /// First vertices of the parts of a mesh whose faces are turned over in the written file.
    pub turned: Vec<u32>,
}

/// Changes nothing; the signal is the coordinates.
impl Default for Recipe {
    fn default() -> Self {
        Self {
            field: coords(),
            operator: None,
            density_invariant: false,
            keep_creases: false,
            local_fit: None,
            positions: PositionParams::default(),
            levels: LevelSpec::Default,
            layers: Vec::new(),
            clones: Vec::new(),
            pose: None,
            turned: Vec::new(),
        }
    }
}

/// TOML form of a recipe.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RecipeTable {
    #[serde(default = "coords")]
    field: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    operator: Option<OperatorKind>,
    #[serde(default, skip_serializing_if = "is_default")]
    density_invariant: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    keep_creases: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    local_fit: Option<LocalFit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    along: Option<MoveDirection>,
    #[serde(default, skip_serializing_if = "is_default")]
    border: Borders,
    #[serde(default, skip_serializing_if = "is_default")]
    volume: Volume,
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    voices: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "whole_as_whole")]
    steps: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lengths: Option<Vec<Length>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    turned: Vec<u32>,
    #[serde(default, rename = "layer")]
    layers: Vec<Layer>,
    #[serde(default, rename = "clone", skip_serializing_if = "Vec::is_empty")]
    clones: Vec<DetailClone>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<Pose>,
}

/// Serializes integral numbers of steps without a decimal point.
#[expect(clippy::ref_option, reason = "the signature is required by serde")]
fn whole_as_whole<S: Serializer>(steps: &Option<Vec<f64>>, serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    #[serde(untagged)]
    enum Number {
        Whole(u64),
        Real(f64),
    }
    serializer.collect_seq(steps.iter().flatten().map(|&n| {
        if n.fract() == 0.0 && (0.0..=MAX_STEPS as f64).contains(&n) {
            Number::Whole(n as u64)
        } else {
            Number::Real(n)
        }
    }))
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn coords() -> String {
    "coords".to_owned()
}

/// Parses a recipe.
///
/// ```
/// use adwave::LevelSpec;
/// use adwave_io::parse_recipe;
/// let recipe = parse_recipe("levels = 4\n[[layer]]\npreset = 'enhance'\nregion = 'ball:vertex=3,radius=5%'")?;
/// assert_eq!(recipe.levels, LevelSpec::Dyadic(4));
/// assert_eq!(recipe.layers.len(), 1);
/// # Ok::<(), adwave_io::ReadError>(())
/// ```
///
/// # Errors
/// [`ReadError::Line`], if the text is not a recipe.
pub fn parse_recipe(text: &str) -> Result<Recipe, ReadError> {
    let table: RecipeTable = toml::from_str(text).map_err(|e| {
        let line = e.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count() as u64);
        ReadError::Line { line, message: crate::text::one_line(&e.message()) }
    })?;
    let levels = match (table.levels, table.voices, table.steps, table.lengths) {
        (None, None, None, None) => LevelSpec::Default,
        (Some(levels), None, None, None) => LevelSpec::Dyadic(levels),
        (levels, Some(voices), None, None) => LevelSpec::Voices { levels, voices },
        (None, None, Some(steps), None) => LevelSpec::Steps(steps),
        (None, None, None, Some(lengths)) => LevelSpec::Widths(lengths),
        _ => {
            let message = "levels, steps and lengths exclude each other; give only one of them".to_owned();
            return Err(ReadError::Line { line: 1, message });
        }
    };
    Ok(Recipe {
        field: table.field,
        operator: table.operator,
        density_invariant: table.density_invariant,
        keep_creases: table.keep_creases,
        local_fit: table.local_fit,
        positions: PositionParams::default()
            .with_along(table.along)
            .with_borders(table.border)
            .with_volume(table.volume),
        levels,
        layers: table.layers,
        clones: table.clones,
        pose: table.pose,
        turned: table.turned,
    })
}

/// Largest size of a recipe in bytes: a hundred thousand strokes.
const MAX_BYTES: u64 = 256 << 20;

/// Reads the recipe in the file `path`.
///
/// # Errors
/// [`ReadError`] if the file cannot be read or is not a recipe.
pub fn read_recipe(path: &Path) -> Result<Recipe, ReadError> {
    let read = || {
        let mut text = String::new();
        let mut file = std::fs::File::open(path)?.take(MAX_BYTES + 1);
        file.read_to_string(&mut text)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(ReadError::Limit { what: "bytes", found: text.len() as u64, limit: MAX_BYTES });
        }
        parse_recipe(&text)
    };
    read().map_err(|e| e.in_file(path))
}

/// Formats a recipe as text that [`parse_recipe`] reads back to the same recipe.
pub fn recipe_to_text(recipe: &Recipe) -> String {
    let mut table = RecipeTable {
        field: recipe.field.clone(),
        operator: recipe.operator,
        density_invariant: recipe.density_invariant,
        keep_creases: recipe.keep_creases,
        local_fit: recipe.local_fit,
        along: recipe.positions.along,
        border: recipe.positions.borders,
        volume: recipe.positions.volume,
        levels: None,
        voices: None,
        steps: None,
        lengths: None,
        layers: recipe.layers.clone(),
        clones: recipe.clones.clone(),
        pose: recipe.pose.clone(),
        turned: recipe.turned.clone(),
    };
    match &recipe.levels {
        LevelSpec::Default => {}
        LevelSpec::Dyadic(levels) => table.levels = Some(*levels),
        LevelSpec::Voices { levels, voices } => {
            table.levels = *levels;
            table.voices = Some(*voices);
        }
        LevelSpec::Steps(steps) => table.steps = Some(steps.clone()),
        LevelSpec::Widths(lengths) => table.lengths = Some(lengths.clone()),
    }
    toml::to_string(&table).expect("numbers, texts and tables are TOML")
}

/// Writes a recipe atomically: an old file is replaced only after the new one is complete.
///
/// # Errors
/// [`WriteError`] if the file cannot be written.
pub fn write_recipe(path: &Path, recipe: &Recipe) -> Result<(), WriteError> {
    atomic_write(path, |file| Ok(file.write_all(recipe_to_text(recipe).as_bytes())?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PoseHandle;
    use adwave::filter::{Gains, Preset};
    use adwave::region::{BrushStroke, Location, Region};

    #[test]
    fn writing_and_reading_is_the_identity() {
        let ball = Region::Ball {
            center: Location::Point([0.5, -1.0, 2.0]),
            radius: Length::PercentOfDiagonal(5.0),
            falloff: Some(Length::Units(0.25)),
        };
        let region = Region::Any(vec![
            Region::Not(Box::new(ball)),
            Region::All(vec![
                Region::Field { name: "thickness".into(), low: 1.0, high: 3.5 },
                Region::Vertices { indices: vec![1, 2, 9], radius: Length::Units(0.0), falloff: None },
                Region::Stroke { path: vec![Location::Vertex(7)], radius: Length::Units(0.1), falloff: None },
                Region::Painted(vec![
                    BrushStroke::Add(Region::Faded { factor: 0.5, region: Box::new(Region::Everywhere {}) }),
                    BrushStroke::Subtract(Region::Vertices {
                        indices: vec![4, 5],
                        radius: Length::PercentOfDiagonal(2.0),
                        falloff: Some(Length::Units(0.5)),
                    }),
                ]),
            ]),
        ]);
        let recipe = Recipe {
            field: "coords".into(),
            operator: Some(OperatorKind::Surface),
            density_invariant: false,
            keep_creases: true,
            local_fit: Some(LocalFit::Constant),
            positions: PositionParams::default()
                .with_along(Some(MoveDirection::Surface))
                .with_borders(Borders::Keep)
                .with_volume(Volume::Keep),
            levels: LevelSpec::Steps(vec![1.0, 2.5, 9.0]),
            layers: vec![
                Layer { gains: Gains::Gains(vec![0.0, 1.5, 1.0]), region },
                Layer { gains: Gains::Preset(Preset::Band2), region: Region::Everywhere {} },
            ],
            clones: Vec::new(),
            pose: None,
            turned: vec![0, 512],
        };
        let text = recipe_to_text(&recipe);
        assert_eq!(parse_recipe(&text).unwrap(), recipe, "{text}");
    }

    #[test]
    fn a_pose_is_written_and_read_again() {
        let handle = PoseHandle {
            by: [0.0, 0.25, -1.5],
            turn: [0.0, 0.0, 30.0],
            region: Region::Vertices { indices: vec![4], radius: Length::Units(0.0), falloff: None },
        };
        let pose = Pose {
            stiffness: Some(Length::PercentOfDiagonal(5.0)),
            fixed: Some(Region::Not(Box::new(Region::Everywhere {}))),
            handles: vec![PoseHandle { turn: [0.0; 3], ..handle.clone() }, handle],
            ..Pose::default()
        };
        let layer = Layer { gains: Gains::Preset(Preset::Band2), region: Region::Everywhere {} };
        let clone = DetailClone {
            source: 4,
            targets: vec![7, 2],
            radius: Length::PercentOfDiagonal(5.0),
            angle: 0.0,
            strength: 1.0,
        };
        let clones = vec![DetailClone { angle: 90.0, strength: 0.5, ..clone.clone() }, clone];
        let recipe = Recipe { pose: Some(pose), clones, layers: vec![layer], ..Recipe::default() };
        let text = recipe_to_text(&recipe);
        assert_eq!(parse_recipe(&text).unwrap(), recipe, "{text}");
        let typed = "[[pose.handle]]\nregion = 'ball:vertex=3,radius=5%'\nby = [0, 0, 1]";
        let pose = parse_recipe(typed).unwrap().pose.unwrap();
        assert_eq!((pose.fixed, pose.handles[0].by), (None, [0.0, 0.0, 1.0]));
        assert!(parse_recipe("[[pose.handle]]\nby = [0, 0, 1]").is_err());
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (text, line, named) in [
            ("levels = 4\n[[layer]]\npreset = 'smoothest'", 3, "smoothest"),
            ("levels = 4\n[[layer]]\ngains = [1.0, 'x']", 3, "expected"),
            ("level = 4", 1, "level"),
            ("levels = 2\nsteps = [1]", 1, "only one"),
            ("[[layer]]\npreset = 'enhance'\nregion = 'ball:radius=3'", 3, "vertex or point"),
            ("= =", 1, ""),
        ] {
            match parse_recipe(text) {
                Err(ReadError::Line { line: at, message }) => {
                    assert_eq!(at, line, "{text}: {message}");
                    assert!(message.contains(named), "{text}: {message}");
                    assert!(!message.contains('\n'));
                }
                other => panic!("{text}: {other:?}"),
            }
        }
    }
}
