//! Coordinate systems as well-known text, in the versions of 2001 (`PROJCS[…]`) and of 2015 (`PROJCRS[…]`).

use crate::model::units::show;
use crate::{CoordinateSystem, CoordinateSystemKind, LengthUnit};

/// Largest nesting of brackets; deeper texts are damaged.
const DEEPEST: usize = 32;
/// Largest text in bytes; a system with all its parts takes a few thousand.
const MOST_BYTES: usize = 1 << 20;

/// Keyword with its values: `UNIT["metre", 1]`.
struct Node<'a> {
    keyword: String,
    /// Quoted texts, numbers and words, in their order.
    values: Vec<&'a str>,
    children: Vec<Node<'a>>,
}

impl<'a> Node<'a> {
    /// Name of the object: its first value.
    fn name(&self) -> &'a str {
        self.values.first().copied().unwrap_or("")
    }

    fn child(&self, keywords: &[&str]) -> Option<&Self> {
        self.children.iter().find(|node| keywords.contains(&node.keyword.as_str()))
    }

    /// Unit of length of the axes: one for all, or that of the first.
    fn unit(&self) -> Option<LengthUnit> {
        let of_axis = || self.child(&["AXIS"])?.child(&["LENGTHUNIT", "UNIT"]);
        let node = self.child(&["LENGTHUNIT", "UNIT"]).or_else(of_axis)?;
        LengthUnit::from_meters(node.name(), node.values.get(1)?.parse().ok()?)
    }
}

/// Coordinate system in a text; `None` if the text describes none.
pub(crate) fn parse_wkt(text: &str) -> Option<CoordinateSystem> {
    if text.len() > MOST_BYTES {
        return None;
    }
    let mut rest = text;
    system(&node(&mut rest, 0)?)
}

/// Parses a keyword and its values in brackets.
fn node<'a>(rest: &mut &'a str, depth: usize) -> Option<Node<'a>> {
    let at = rest.find(['[', '('])?;
    let keyword = rest[..at].trim().to_ascii_uppercase();
    *rest = &rest[at + 1..];
    let mut node = Node { keyword, values: Vec::new(), children: Vec::new() };
    loop {
        *rest = rest.trim_start_matches([' ', ',', '\t', '\r', '\n']);
        match rest.bytes().next()? {
            b']' | b')' => {
                *rest = &rest[1..];
                return Some(node);
            }
            b'"' => {
                let end = rest[1..].find('"')?;
                node.values.push(&rest[1..=end]);
                *rest = &rest[end + 2..];
            }
            _ => {
                let end = rest.find([',', ']', ')', '[', '('])?;
                if matches!(rest.as_bytes()[end], b'[' | b'(') {
                    if depth == DEEPEST {
                        return None;
                    }
                    node.children.push(self::node(rest, depth + 1)?);
                } else {
                    node.values.push(rest[..end].trim());
                    *rest = &rest[end..];
                }
            }
        }
    }
}

fn system(node: &Node<'_>) -> Option<CoordinateSystem> {
    let is_cartesian =
        || node.child(&["CS"]).is_some_and(|axes| axes.name().eq_ignore_ascii_case("Cartesian"));
    let kind = match node.keyword.as_str() {
        "COMPD_CS" | "COMPOUNDCRS" => {
            let horizontal = node.children.iter().find_map(system)?;
            return Some(CoordinateSystem { name: show(node.name()), ..horizontal });
        }
        "BOUNDCRS" | "SOURCECRS" => return node.children.iter().find_map(system),
        "PROJCS" | "PROJCRS" | "PROJECTEDCRS" => CoordinateSystemKind::Projected,
        "GEOCCS" => CoordinateSystemKind::Geocentric,
        "GEODCRS" | "GEODETICCRS" if is_cartesian() => CoordinateSystemKind::Geocentric,
        "GEOGCS" | "GEOGCRS" | "GEOGRAPHICCRS" | "GEODCRS" | "GEODETICCRS" => {
            CoordinateSystemKind::Geographic
        }
        "LOCAL_CS" | "ENGCRS" | "ENGINEERINGCRS" => CoordinateSystemKind::Local,
        _ => return None,
    };
    // The unit of a geographic system is an angle, and that of its ellipsoid is not of the coordinates.
    let unit = if kind == CoordinateSystemKind::Geographic { None } else { node.unit() };
    Some(CoordinateSystem { name: show(node.name()), kind, unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WGS_84: &str = r#"GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],
        PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]"#;

    fn parsed(text: &str) -> (String, CoordinateSystemKind, Option<LengthUnit>) {
        let system = parse_wkt(text).unwrap();
        (system.name, system.kind, system.unit)
    }

    #[test]
    fn systems_of_both_versions_are_told_apart() {
        use CoordinateSystemKind::{Geocentric, Geographic, Local, Projected};
        assert_eq!(parsed(WGS_84), ("WGS 84".into(), Geographic, None));
        let utm = format!(
            r#"PROJCS["WGS 84 / UTM zone 33N",{WGS_84},PROJECTION["Transverse_Mercator"],
            PARAMETER["central_meridian",15],UNIT["metre",1],AXIS["Easting",EAST]]"#
        );
        assert_eq!(parsed(&utm), ("WGS 84 / UTM zone 33N".into(), Projected, Some(LengthUnit::METER)));
        let compound = format!(
            r#"COMPD_CS["UTM + height",{utm},VERT_CS["h",VERT_DATUM["d",2005],UNIT["foot",0.3048]]]"#
        );
        assert_eq!(parsed(&compound), ("UTM + height".into(), Projected, Some(LengthUnit::METER)));
        let feet = r#"PROJCRS["NAD83 / Ohio (ftUS)",BASEGEOGCRS["NAD83",DATUM["d",ELLIPSOID["GRS 1980",6378137,298.2,
            LENGTHUNIT["metre",1]]]],CONVERSION["c",METHOD["m"]],CS[Cartesian,2],
            AXIS["easting",east,LENGTHUNIT["US survey foot",0.304800609601219]]]"#;
        assert_eq!(parsed(feet), ("NAD83 / Ohio (ftUS)".into(), Projected, Some(LengthUnit::US_SURVEY_FOOT)));
        let geodetic = |axes: &str| {
            format!(
                r#"GEODCRS["WGS 84",DATUM["d",ELLIPSOID["e",6378137,298.2,LENGTHUNIT["metre",1]]],CS[{axes},3]]"#
            )
        };
        assert_eq!(parsed(&geodetic("ellipsoidal")).1, Geographic);
        assert_eq!(parsed(&geodetic("Cartesian")).1, Geocentric);
        let bound =
            format!("BOUNDCRS[SOURCECRS[{WGS_84}],TARGETCRS[{WGS_84}],ABRIDGEDTRANSFORMATION[\"t\"]]");
        assert_eq!(parsed(&bound).1, Geographic);
        assert_eq!(parsed(r#"LOCAL_CS["site",UNIT["foot",0.3048]]"#).2, Some(LengthUnit::FOOT));
        assert_eq!(parsed(r#"LOCAL_CS["site",UNIT["foot",0.3048]]"#).1, Local);
    }

    #[test]
    fn damaged_texts_are_none() {
        for text in
            ["", "EPSG:4326", "PROJCS[", "PROJCS[\"a", "PROJCS[\"a\",UNIT[\"m\",", "]][[", "VERT_CS[\"h\"]"]
        {
            assert_eq!(parse_wkt(text), None, "{text}");
        }
        assert_eq!(parse_wkt(&"COMPD_CS[".repeat(100_000)), None);
        assert_eq!(parse_wkt("PROJCS[\"a\",UNIT[\"m\",1e999]]").unwrap().unit, None);
    }
}
