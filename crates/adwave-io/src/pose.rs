//! Edits other than those of bands, as recipes and the studio store them: clones of detail, and a pose.

use adwave::region::{Length, Region, parse_region};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

/// Handles that bend a shape after its bands were edited.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Width σ of the coarse base; the usual one if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub width: Option<Length>,
    /// Bending length; that of the base if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<Length>,
    /// Share of lengths in [0, 1]: 0 keeps detail, 1 lengths.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub keep_lengths: f64,
    /// Region that stays where it is, except for the vertices of handles; nothing stays if `None`.
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "region_or_nothing")]
    pub fixed: Option<Region>,
    /// Handles; without them nothing bends.
    #[serde(default, rename = "handle")]
    pub handles: Vec<PoseHandle>,
}

/// A region that moves as a whole: it turns about its center, and then moves by a vector. A single vertex turns freely.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseHandle {
    /// Translation in model units.
    #[serde(default)]
    pub by: [f64; 3],
    /// Axis of the rotation, whose length is the angle in degrees.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub turn: [f64; 3],
    /// Vertices of the handle: those with a weight above 0.
    #[serde(deserialize_with = "region_or_text")]
    pub region: Region,
}

/// A region as text of the command line, or as a table.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "no such region; write it as on the command line, as in 'ball:vertex=3,radius=5%'"
)]
enum RegionForm {
    Text(String),
    Tree(Region),
}

impl RegionForm {
    fn resolve<E: Error>(self) -> Result<Region, E> {
        match self {
            Self::Text(text) => parse_region(&text).map_err(E::custom),
            Self::Tree(region) => Ok(region),
        }
    }
}

fn region_or_text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Region, D::Error> {
    RegionForm::deserialize(deserializer)?.resolve()
}

fn region_or_nothing<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Region>, D::Error> {
    Option::<RegionForm>::deserialize(deserializer)?.map(RegionForm::resolve).transpose()
}

/// Detail cloned from one place to another, as by a stamp.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DetailClone {
    /// Vertex in the middle of the detail, from 0.
    pub source: u32,
    /// Vertices to which the detail goes, one after the other.
    pub targets: Vec<u32>,
    /// Distance at which a clone has faded out.
    pub radius: Length,
    /// Turn about the normal in degrees, counterclockwise seen from outside.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub angle: f64,
    /// Share of the present detail that is replaced, in [0, 1].
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub strength: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands the field by reference")]
fn is_nothing(value: &f64) -> bool {
    *value == 0.0
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands the field by reference")]
fn is_one(value: &f64) -> bool {
    *value == 1.0
}

fn is_zero(turn: &[f64; 3]) -> bool {
    *turn == [0.0; 3]
}
