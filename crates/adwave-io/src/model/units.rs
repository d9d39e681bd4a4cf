//! Units of length and coordinate systems of a file's coordinates.

use std::borrow::Cow;
use std::fmt;

use crate::{Format, ShapeFile, WriteError, WriteReport};

/// Unit of length of coordinates.
///
/// ```
/// use adwave_io::LengthUnit;
/// let inch = LengthUnit::from_name("inches").unwrap();
/// assert_eq!((inch.name(), inch.meters()), ("inch", Some(0.0254)));
/// assert_eq!(inch.ratio_to(&LengthUnit::MILLIMETER), Some(25.4));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LengthUnit {
    name: Cow<'static, str>,
    /// Length in micrometers, in which the usual units are whole numbers; `None` if it is not known.
    microns: Option<f64>,
}

impl LengthUnit {
    /// 1e-6 m.
    pub const MICRON: Self = Self::new("micron", 1.0);
    /// 1e-3 m.
    pub const MILLIMETER: Self = Self::new("millimeter", 1e3);
    /// 0.01 m.
    pub const CENTIMETER: Self = Self::new("centimeter", 1e4);
    /// 0.0254 m.
    pub const INCH: Self = Self::new("inch", 25_400.0);
    /// 0.3048 m.
    pub const FOOT: Self = Self::new("foot", 304_800.0);
    /// 1200/3937 m, of surveys in the United States.
    pub const US_SURVEY_FOOT: Self = Self::new("US survey foot", 1.2e9 / 3937.0);
    /// 1 m.
    pub const METER: Self = Self::new("meter", 1e6);
    /// 1000 m.
    pub const KILOMETER: Self = Self::new("kilometer", 1e9);

    /// Other spellings of the units, in lower case.
    const SPELLINGS: &'static [(Self, &'static [&'static str])] = &[
        (Self::MICRON, &["micron", "microns", "micrometer", "micrometers", "micrometre", "um", "µm"]),
        (Self::MILLIMETER, &["millimeter", "millimeters", "millimetre", "millimetres", "mm"]),
        (Self::CENTIMETER, &["centimeter", "centimeters", "centimetre", "centimetres", "cm"]),
        (Self::INCH, &["inch", "inches", "in"]),
        (Self::FOOT, &["foot", "feet", "ft", "international foot", "foot (international)"]),
        (
            Self::US_SURVEY_FOOT,
            &["us survey foot", "us survey feet", "us_survey_foot", "foot_us", "us-ft", "ftus"],
        ),
        (Self::METER, &["meter", "meters", "metre", "metres", "m"]),
        (Self::KILOMETER, &["kilometer", "kilometers", "kilometre", "kilometres", "km"]),
    ];

    const fn new(name: &'static str, microns: f64) -> Self {
        Self { name: Cow::Borrowed(name), microns: Some(microns) }
    }

    /// Unit of that name in English, in singular or plural, or its symbol; `None` if no unit is called so.
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.trim().to_lowercase();
        let own = Self::SPELLINGS.iter().find(|(_, spellings)| spellings.contains(&name.as_str()));
        own.map(|(unit, _)| unit.clone())
    }

    /// Unit of a length in meters: one of the constants if it has that length, else one of that name.
    pub(crate) fn from_meters(name: &str, meters: f64) -> Option<Self> {
        if !(meters.is_finite() && meters > 0.0) {
            return None;
        }
        let is_own = |unit: &Self| unit.meters().is_some_and(|own| (own / meters - 1.0).abs() < 1e-9);
        let own = Self::SPELLINGS.iter().map(|(unit, _)| unit).find(|unit| is_own(unit)).cloned();
        let name = show(name);
        own.or(Some(Self { name: Cow::Owned(name), microns: Some(1e6 * meters) }))
    }

    /// Unit of a length that is not known.
    pub(crate) fn from_unknown_name(name: &str) -> Self {
        Self { name: Cow::Owned(show(name)), microns: None }
    }

    /// Name in singular, such as `inch`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Length in meters; `None` if it is not known.
    pub fn meters(&self) -> Option<f64> {
        self.microns.map(|microns| microns / 1e6)
    }

    /// Factor that converts numbers in this unit to numbers in `other`; `None` if one of the lengths is not known.
    pub fn ratio_to(&self, other: &Self) -> Option<f64> {
        Some(self.microns? / other.microns?)
    }

    /// Name in plural.
    pub fn plural(&self) -> String {
        match self.name() {
            "inch" => "inches".into(),
            "foot" => "feet".into(),
            "US survey foot" => "US survey feet".into(),
            name if self.microns.is_some() => format!("{name}s"),
            name => format!("the unknown unit `{name}`"),
        }
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Up to 80 printable characters of a name in a file.
pub(crate) fn show(name: &str) -> String {
    name.trim().chars().filter(|c| !c.is_control()).take(80).collect()
}

/// Kind of a coordinate reference system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CoordinateSystemKind {
    /// Lengths on a map: easting and northing.
    Projected,
    /// Angles: longitude and latitude. Distances between such coordinates are no lengths.
    Geographic,
    /// Lengths from the center of the earth.
    Geocentric,
    /// Lengths of a site.
    Local,
}

impl CoordinateSystemKind {
    /// Name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Projected => "projected",
            Self::Geographic => "geographic",
            Self::Geocentric => "geocentric",
            Self::Local => "local",
        }
    }
}

/// Coordinate reference system that a file states.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateSystem {
    /// Name in the file, such as `WGS 84 / UTM zone 33N`, or its code `EPSG:32633`.
    pub name: String,
    /// Kind of the horizontal coordinates.
    pub kind: CoordinateSystemKind,
    /// Unit of the horizontal coordinates if they are lengths; `None` if the file does not state it.
    pub unit: Option<LengthUnit>,
}

impl CoordinateSystem {
    /// True if horizontal coordinates are angles.
    pub fn is_geographic(&self) -> bool {
        self.kind == CoordinateSystemKind::Geographic
    }
}

/// Units of length that files of a format can state.
#[derive(Clone, Copy, Debug)]
pub(crate) enum UnitRoom {
    /// Numbers without a unit.
    None,
    /// One unit in all files.
    Fixed(&'static LengthUnit),
    /// One of several; files without one have the first.
    Stated(&'static [LengthUnit]),
}

impl UnitRoom {
    /// Unit in which files are written whose own unit the format cannot state.
    fn default_unit(self) -> Option<&'static LengthUnit> {
        match self {
            Self::None => None,
            Self::Fixed(unit) => Some(unit),
            Self::Stated(units) => units.first(),
        }
    }

    fn holds(self, unit: &LengthUnit) -> bool {
        match self {
            Self::None => false,
            Self::Fixed(own) => own == unit,
            Self::Stated(units) => units.contains(unit),
        }
    }
}

/// Shape in a unit that the format can state, if it has to be converted; notes go to the report.
///
/// # Errors
/// The shape has a unit of unknown length, which the format cannot state.
pub(crate) fn convert_unit(
    shape: &ShapeFile,
    format: Format,
    report: &mut WriteReport,
) -> Result<Option<ShapeFile>, WriteError> {
    let room = format.descriptor().unit;
    let is_own_format = shape.format.is_some_and(|own| own.family() == format.family());
    if shape.points.is_empty() || is_own_format {
        return Ok(None);
    }
    match (&shape.unit, room.default_unit()) {
        (None, None) => Ok(None),
        (Some(unit), None) => {
            let is_kept = shape.original.as_deref().is_some_and(|source| source.keeps_extras(format));
            if !is_kept {
                report.add_note(format!(
                    "{format} has no unit of length; the numbers stay in {}, which 3MF, AMF and glTF would state",
                    unit.plural()
                ));
            }
            Ok(None)
        }
        (None, Some(unit)) => {
            report.add_note(format!(
                "the shape has no unit of length, and programs take the numbers of a {format} as {}; scale them before if \
                 they are others",
                unit.plural()
            ));
            Ok(None)
        }
        (Some(unit), Some(_)) if room.holds(unit) => Ok(None),
        (Some(unit), Some(target)) => {
            let Some(ratio) = unit.ratio_to(target) else {
                let what = format!(
                    "numbers in {}; state a known unit in the input, such as {target}",
                    unit.plural()
                );
                return Err(WriteError::CannotHold { format, what });
            };
            report.add_note(format!(
                "coordinates are converted from {} to {} (times {ratio})",
                unit.plural(),
                target.plural()
            ));
            let mut converted = shape.clone();
            converted.original = None;
            converted.moved = true;
            converted.points = shape.points.iter().map(|p| p.map(|c| c * ratio)).collect::<Vec<_>>().into();
            converted.unit = Some(target.clone());
            Ok(Some(converted))
        }
    }
}

impl ShapeFile {
    /// Unit of length of the coordinates, if the file states one or its format has one.
    pub fn length_unit(&self) -> Option<&LengthUnit> {
        self.unit.as_ref()
    }

    /// Coordinate reference system of the points, if the file states one.
    pub fn coordinate_system(&self) -> Option<&CoordinateSystem> {
        self.coordinate_system.as_deref()
    }

    /// Sets the unit of length of the coordinates, whose numbers stay as they are.
    pub fn set_length_unit(&mut self, unit: Option<LengthUnit>) {
        if unit != self.unit {
            self.original = None;
        }
        self.unit = unit;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_whole_units_are_exact() {
        let ratio = |a: &LengthUnit, b: &LengthUnit| a.ratio_to(b).unwrap();
        assert_eq!(ratio(&LengthUnit::INCH, &LengthUnit::MILLIMETER), 25.4);
        assert_eq!(ratio(&LengthUnit::INCH, &LengthUnit::METER), 0.0254);
        assert_eq!(ratio(&LengthUnit::FOOT, &LengthUnit::METER), 0.3048);
        assert_eq!(ratio(&LengthUnit::METER, &LengthUnit::MICRON), 1e6);
        assert_eq!(LengthUnit::US_SURVEY_FOOT.meters(), Some(1200.0 / 3937.0));
    }

    #[test]
    fn lengths_find_their_names() {
        assert_eq!(LengthUnit::from_meters("m", 1.0), Some(LengthUnit::METER));
        assert_eq!(
            LengthUnit::from_meters("Foot_US", 0.304_800_609_601_219_2),
            Some(LengthUnit::US_SURVEY_FOOT)
        );
        assert_eq!(LengthUnit::from_meters("chain", 20.1168).unwrap().name(), "chain");
        assert_eq!(LengthUnit::from_meters("m", f64::NAN), None);
        assert_eq!(LengthUnit::from_unknown_name("fur\u{7}long").name(), "furlong");
    }
}
