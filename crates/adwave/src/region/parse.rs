//! Text form of regions, as on a command line.
//!
//! ```text
//! region  = term { "|" term }                      any of them
//! term    = factor { "&" factor }                  all of them
//! factor  = "!" factor | number "*" factor | "(" region ")" | name [ ":" key "=" value { "," key "=" value } ]
//!         | ( "grown" | "shrunk" | "blurred" ) ":" "by" "=" length "(" region ")"
//! ```
//! Coordinates are separated by blanks, and locations of a stroke by `;`.

use super::{Length, Location, Region};
use crate::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Syntax error in the text of a region.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RegionSyntaxError {
    /// The text is not a length.
    #[error("'{}' is not a length; write model units (0.25) or a percentage of the diagonal (5%)", one_line(.0))]
    NotALength(String),
    /// The text is not a number.
    #[error("'{}' is not a number", one_line(.0))]
    NotANumber(String),
    /// The text is not a point.
    #[error("'{}' is not a point; write three numbers with blanks between, as in '0.1 0 2.5'", one_line(.0))]
    NotAPoint(String),
    /// The text is not a vertex index.
    #[error("'{}' is not a vertex index; vertices are counted from 0", one_line(.0))]
    NotAVertex(String),
    /// The kind of region does not exist.
    #[error(
        "there is no region '{}'; there are all, ball, stroke, box, half-space, facing, component, field, vertices, grown, shrunk and blurred",
        one_line(.0)
    )]
    NoSuchRegion(String),
    /// The region does not have this key.
    #[error("a {region} region has no '{}'; it has {known}", one_line(.key))]
    NoSuchKey {
        /// The kind of region.
        region: &'static str,
        /// The key.
        key: String,
        /// Keys of the region.
        known: &'static str,
    },
    /// A required key is missing.
    #[error("a {region} region needs {key}")]
    Missing {
        /// The kind of region.
        region: &'static str,
        /// The key.
        key: &'static str,
    },
    /// A part does not have the form `key=value`.
    #[error("'{}' is not of the form key=value", one_line(.0))]
    NotAKeyValue(String),
    /// The text ends too early or has extra characters.
    #[error(
        "unexpected text '{}' in the region; parts are joined by '&' and '|', negated by '!', grouped by '(' and ')'",
        one_line(.0)
    )]
    Unexpected(String),
    /// The text has too many nested brackets.
    #[error("the region is nested more than {0} deep")]
    TooDeep(usize),
}

impl ClassifiedError for RegionSyntaxError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Part of the text for a message, with control characters escaped so that the message stays on one line.
fn one_line(text: &str) -> String {
    text.chars().flat_map(|c| if c.is_control() { c.escape_default().collect() } else { vec![c] }).collect()
}

/// Maximal nesting of brackets and negations, which limits the recursion on hostile text.
const MAX_NESTED: usize = 64;

/// Parses a region as written on a command line.
///
/// ```
/// use adwave::region::{parse_region, Length, Location, Region};
/// let ball = parse_region("ball:vertex=12,radius=5%")?;
/// assert_eq!(ball, Region::Ball {
///     center: Location::Vertex(12), radius: Length::PercentOfDiagonal(5.0), falloff: None,
/// });
/// let upper = parse_region("half-space:point=0 0 0,normal=0 1 0 & !ball:point=0 1 0,radius=0.2")?;
/// assert!(matches!(upper, Region::All(parts) if parts.len() == 2));
/// # Ok::<(), adwave::region::RegionSyntaxError>(())
/// ```
///
/// # Errors
/// [`RegionSyntaxError`] with the text that could not be parsed and the valid forms.
pub fn parse_region(text: &str) -> Result<Region, RegionSyntaxError> {
    let mut rest = text;
    let region = parse_union(&mut rest, 0)?;
    if rest.trim_start().is_empty() {
        Ok(region)
    } else {
        Err(RegionSyntaxError::Unexpected(rest.trim().into()))
    }
}

type Parsed = Result<Region, RegionSyntaxError>;

fn parse_union(rest: &mut &str, depth: usize) -> Parsed {
    parse_list(
        rest,
        '|',
        |rest| parse_list(rest, '&', |rest| parse_factor(rest, depth), Region::All),
        Region::Any,
    )
}

fn parse_list(
    rest: &mut &str,
    sign: char,
    mut part: impl FnMut(&mut &str) -> Parsed,
    join: impl Fn(Vec<Region>) -> Region,
) -> Parsed {
    let mut parts = vec![part(rest)?];
    while let Some(after) = rest.trim_start().strip_prefix(sign) {
        *rest = after;
        parts.push(part(rest)?);
    }
    Ok(if parts.len() == 1 { parts.remove(0) } else { join(parts) })
}

fn parse_factor(rest: &mut &str, depth: usize) -> Parsed {
    if depth > MAX_NESTED {
        return Err(RegionSyntaxError::TooDeep(MAX_NESTED));
    }
    *rest = rest.trim_start();
    if let Some(after) = rest.strip_prefix('!') {
        *rest = after;
        return Ok(Region::Not(Box::new(parse_factor(rest, depth + 1)?)));
    }
    let end = rest.find(['*', ':', '&', '|', '(', ')']).unwrap_or(rest.len());
    if let Some(after) = rest[end..].strip_prefix('*') {
        let by = number(&rest[..end])?; // in [0, 1]: looked at with the shape
        *rest = after;
        return Ok(Region::Faded { factor: by, region: Box::new(parse_factor(rest, depth + 1)?) });
    }
    if rest.starts_with('(') {
        return parse_brackets(rest, depth);
    }
    let end = rest.find(['&', '|', ')', '(']).unwrap_or(rest.len());
    let (here, after) = rest.split_at(end);
    *rest = after;
    let (name, keys) = here.split_once(':').unwrap_or((here, ""));
    match name.trim() {
        kind @ ("grown" | "shrunk" | "blurred") => parse_changed(kind, keys, rest, depth),
        name => parse_primitive(name, keys),
    }
}

fn parse_brackets(rest: &mut &str, depth: usize) -> Parsed {
    let unexpected = |rest: &str| RegionSyntaxError::Unexpected(rest.into());
    *rest = rest.strip_prefix('(').ok_or_else(|| unexpected(rest))?;
    let region = parse_union(rest, depth + 1)?;
    *rest = rest.trim_start().strip_prefix(')').ok_or_else(|| unexpected(rest))?;
    Ok(region)
}

/// Parses a region derived from the one in brackets after it.
fn parse_changed(kind: &str, keys: &str, rest: &mut &str, depth: usize) -> Parsed {
    let name = match kind {
        "grown" => "grown",
        "shrunk" => "shrunk",
        _ => "blurred",
    };
    let mut keys = RegionKeys::new(name, "by, and a region in brackets after it", keys)?;
    let by: Length = keys.need("by")?.parse()?;
    keys.end(Region::Everywhere {})?;
    if !rest.starts_with('(') {
        return Err(RegionSyntaxError::Missing { region: name, key: "a region in brackets after it" });
    }
    let region = parse_brackets(rest, depth)?;
    Ok(match kind {
        "grown" => Region::Grown { by, region: Box::new(region) },
        "shrunk" => region.shrink(by),
        _ => Region::Blurred { by, region: Box::new(region) },
    })
}

/// The `key=value` parts of one region, consumed one by one.
struct RegionKeys<'a> {
    region: &'static str,
    known: &'static str,
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> RegionKeys<'a> {
    fn new(region: &'static str, known: &'static str, text: &'a str) -> Result<Self, RegionSyntaxError> {
        let pairs = text
            .split(',')
            .filter(|part| !part.trim().is_empty())
            .map(|part| match part.split_once('=') {
                Some((key, value)) => Ok((key.trim(), value.trim())),
                None => Err(RegionSyntaxError::NotAKeyValue(part.trim().into())),
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { region, known, pairs })
    }

    fn take(&mut self, key: &str) -> Option<&'a str> {
        let at = self.pairs.iter().position(|pair| pair.0 == key)?;
        Some(self.pairs.remove(at).1)
    }

    fn need(&mut self, key: &'static str) -> Result<&'a str, RegionSyntaxError> {
        let region = self.region;
        self.take(key).ok_or(RegionSyntaxError::Missing { region, key })
    }

    fn length(&mut self, key: &str) -> Result<Option<Length>, RegionSyntaxError> {
        self.take(key).map(str::parse).transpose()
    }

    fn number(&mut self, key: &str, default: f64) -> Result<f64, RegionSyntaxError> {
        self.take(key).map_or(Ok(default), number)
    }

    fn end(self, region: Region) -> Parsed {
        match self.pairs.first() {
            None => Ok(region),
            Some((key, _)) => Err(RegionSyntaxError::NoSuchKey {
                region: self.region,
                key: (*key).to_owned(),
                known: self.known,
            }),
        }
    }
}

fn parse_primitive(name: &str, text: &str) -> Parsed {
    match name {
        "all" | "everywhere" => RegionKeys::new("all", "no keys", text)?.end(Region::Everywhere {}),
        "ball" => {
            let mut keys = RegionKeys::new("ball", "vertex or point, radius, falloff", text)?;
            let center = match (keys.take("vertex"), keys.take("point")) {
                (Some(v), None) => Location::Vertex(vertex(v)?),
                (None, Some(p)) => Location::Point(point(p)?),
                _ => {
                    return Err(RegionSyntaxError::Missing { region: "ball", key: "either vertex or point" });
                }
            };
            let (radius, falloff) = (keys.need("radius")?.parse()?, keys.length("falloff")?);
            keys.end(Region::Ball { center, radius, falloff })
        }
        "stroke" => {
            let mut keys = RegionKeys::new("stroke", "path (points) or vertices, radius, falloff", text)?;
            let path = match (keys.take("path"), keys.take("vertices")) {
                (Some(points), None) => {
                    points.split(';').map(|p| point(p).map(Location::Point)).collect::<Result<_, _>>()?
                }
                (None, Some(list)) => list
                    .split([' ', ';'])
                    .filter(|v| !v.is_empty())
                    .map(|v| vertex(v).map(Location::Vertex))
                    .collect::<Result<Vec<_>, _>>()?,
                _ => {
                    return Err(RegionSyntaxError::Missing {
                        region: "stroke",
                        key: "either path or vertices",
                    });
                }
            };
            let (radius, falloff) = (keys.need("radius")?.parse()?, keys.length("falloff")?);
            keys.end(Region::Stroke { path, radius, falloff })
        }
        "box" => {
            let mut keys = RegionKeys::new("box", "min, max, falloff", text)?;
            let (min, max) = (point(keys.need("min")?)?, point(keys.need("max")?)?);
            let falloff = keys.length("falloff")?;
            keys.end(Region::Box { min, max, falloff })
        }
        "half-space" => {
            let mut keys = RegionKeys::new("half-space", "point, normal, falloff", text)?;
            let (at, normal) = (point(keys.need("point")?)?, point(keys.need("normal")?)?);
            let falloff = keys.length("falloff")?;
            keys.end(Region::HalfSpace { point: at, normal, falloff })
        }
        "facing" => {
            let mut keys = RegionKeys::new("facing", "direction, falloff", text)?;
            let (direction, falloff) = (point(keys.need("direction")?)?, keys.number("falloff", 0.0)?);
            keys.end(Region::Facing { direction, falloff })
        }
        "component" => {
            let mut keys = RegionKeys::new("component", "vertex", text)?;
            let vertex = vertex(keys.need("vertex")?)?;
            keys.end(Region::Component { vertex })
        }
        "field" => {
            let mut keys = RegionKeys::new("field", "name, low, high", text)?;
            let name = keys.need("name")?.to_owned();
            let (low, high) = (keys.number("low", 0.0)?, keys.number("high", 1.0)?);
            keys.end(Region::Field { name, low, high })
        }
        "vertices" => {
            let mut keys = RegionKeys::new("vertices", "indices, radius, falloff", text)?;
            let indices = keys
                .need("indices")?
                .split([' ', ';'])
                .filter(|v| !v.is_empty())
                .map(vertex)
                .collect::<Result<_, _>>()?;
            let radius = keys.length("radius")?.unwrap_or(Length::Units(0.0));
            let falloff = keys.length("falloff")?;
            keys.end(Region::Vertices { indices, radius, falloff })
        }
        other => Err(RegionSyntaxError::NoSuchRegion(other.to_owned())),
    }
}

fn number(text: &str) -> Result<f64, RegionSyntaxError> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(RegionSyntaxError::NotANumber(text.trim().to_owned())),
    }
}

fn vertex(text: &str) -> Result<u32, RegionSyntaxError> {
    text.trim().parse().map_err(|_| RegionSyntaxError::NotAVertex(text.trim().to_owned()))
}

fn point(text: &str) -> Result<[f64; 3], RegionSyntaxError> {
    let not_a_point = || RegionSyntaxError::NotAPoint(text.trim().to_owned());
    let values: Vec<f64> =
        text.split_whitespace().map(number).collect::<Result<_, _>>().map_err(|_| not_a_point())?;
    values.try_into().map_err(|_| not_a_point())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn and_binds_closer_than_or() {
        let region = parse_region("all | all & !(all | all)").unwrap();
        let Region::Any(parts) = region else { panic!("not a union") };
        assert_eq!(parts[0], Region::Everywhere {});
        let Region::All(parts) = &parts[1] else { panic!("not an intersection") };
        assert!(matches!(&parts[1], Region::Not(inner) if matches!(**inner, Region::Any(_))));
    }

    #[test]
    fn a_number_and_a_star_fade_what_follows() {
        let region = parse_region("0.25*all & 1 * !(all | 0.5*all)").unwrap();
        let Region::All(parts) = region else { panic!("not an intersection") };
        assert_eq!(parts[0], Region::Faded { factor: 0.25, region: Box::new(Region::Everywhere {}) });
        assert!(matches!(&parts[1], Region::Faded { region, .. } if matches!(**region, Region::Not(_))));
        assert_eq!(parse_region(&"1*".repeat(1000)), Err(RegionSyntaxError::TooDeep(MAX_NESTED)));
        assert_eq!(parse_region("x*all"), Err(RegionSyntaxError::NotANumber("x".to_owned())));
    }

    #[test]
    fn what_changes_a_region_stands_before_it() {
        let by = Length::PercentOfDiagonal(2.0);
        let [grown, shrunk, blurred] = ["grown", "shrunk", "blurred"]
            .map(|kind| parse_region(&format!("{kind}:by=2% (all | component:vertex=3) & all")).unwrap());
        let inner = Region::Any(vec![Region::Everywhere {}, Region::Component { vertex: 3 }]);
        let with_all = |region: Region| Region::All(vec![region, Region::Everywhere {}]);
        assert_eq!(grown, with_all(Region::Grown { by, region: Box::new(inner.clone()) }));
        assert_eq!(shrunk, with_all(inner.clone().shrink(by)));
        assert_eq!(blurred, with_all(Region::Blurred { by, region: Box::new(inner) }));
        assert_eq!(parse_region(&"grown:by=1(".repeat(1000)), Err(RegionSyntaxError::TooDeep(MAX_NESTED)));
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        for (text, named) in [
            ("bal:radius=1", "no region 'bal'"),
            ("ball:radius=1", "either vertex or point"),
            ("ball:vertex=-1,radius=1", "'-1'"),
            ("ball:vertex=1,radius=-2", "'-2'"),
            ("ball:vertex=1,radius=1,fall=3", "'fall'"),
            ("box:min=0 0,max=1 1 1", "'0 0'"),
            ("all all", "no region 'all all'"),
            ("(all", "''"),
            ("all)", "')'"),
            ("", "no region ''"),
            ("ball:vertex", "key=value"),
            ("grown:by=2%", "in brackets"),
            ("grown:by=2%(all", "''"),
            ("blurred(all)", "needs by"),
            ("shrunk:by=-1(all)", "'-1'"),
            ("component:vertex=x", "'x'"),
            ("facing:falloff=1", "direction"),
        ] {
            let error = parse_region(text).unwrap_err().to_string();
            assert!(error.contains(named), "{text}: {error}");
        }
        assert_eq!(parse_region(&"!".repeat(1000)), Err(RegionSyntaxError::TooDeep(MAX_NESTED)));
        assert_eq!(parse_region(&"(".repeat(1000)), Err(RegionSyntaxError::TooDeep(MAX_NESTED)));
    }
}
