//! Values that are chosen by name: the command line, recipes and the bindings read the names here.

use thiserror::Error;

/// One value of a [`NamedValue`] type, with its name and a line of help.
#[derive(Clone, Copy, Debug)]
pub struct NamedEntry<T: 'static> {
    /// The value.
    pub value: T,
    /// Name of the value, in lower case with hyphens.
    pub name: &'static str,
    /// Another name that is accepted too.
    pub alias: Option<&'static str>,
    /// One line about the value; empty if the name suffices.
    pub summary: &'static str,
}

/// A type whose values have names.
///
/// ```
/// use adwave::operator::OperatorKind;
/// assert_eq!("surface".parse(), Ok(OperatorKind::Surface));
/// assert_eq!(OperatorKind::Walk.to_string(), "walk");
/// let error = "heat".parse::<OperatorKind>().unwrap_err();
/// assert_eq!(error.to_string(), "operator must be walk or surface, got 'heat'");
/// ```
pub trait NamedValue: Copy + PartialEq + Sized + 'static {
    /// The noun that messages call the value by.
    const NOUN: &'static str;
    /// All values, in the order in which help lists them.
    const ENTRIES: &'static [NamedEntry<Self>];

    /// The value of a name or an alias.
    ///
    /// # Errors
    /// [`UnknownName`] if no value has that name.
    fn from_name(name: &str) -> Result<Self, UnknownName> {
        let entry = Self::ENTRIES.iter().find(|entry| entry.name == name || entry.alias == Some(name));
        entry.map(|entry| entry.value).ok_or_else(|| UnknownName {
            noun: Self::NOUN,
            names: list_names(Self::ENTRIES.iter().map(|entry| entry.name)),
            found: name.to_owned(),
        })
    }
}

/// A name that no value has.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{noun} must be {names}, got '{found}'")]
pub struct UnknownName {
    /// The noun of the value.
    pub noun: &'static str,
    /// The names that are known, as a list in words.
    pub names: String,
    /// The name that was given.
    pub found: String,
}

/// Names as a list in words: `a`, `a or b`, `a, b or c`.
fn list_names(names: impl Iterator<Item = &'static str>) -> String {
    let mut names: Vec<&str> = names.collect();
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last.to_owned() } else { format!("{} or {last}", names.join(", ")) }
}

/// Implements [`NamedValue`], `ALL`, `name`, `FromStr` and `Display` for an enum from one table of names.
#[doc(hidden)]
#[macro_export]
macro_rules! named_values {
    ($type:ident, $noun:literal, { $($variant:ident => $name:literal $(| $alias:literal)?, $summary:literal;)* }) => {
        impl $crate::NamedValue for $type {
            const NOUN: &'static str = $noun;
            const ENTRIES: &'static [$crate::NamedEntry<Self>] = &[$($crate::NamedEntry {
                value: Self::$variant,
                name: $name,
                alias: $crate::named_values!(@alias $($alias)?),
                summary: $summary,
            },)*];
        }

        impl $type {
            /// All values, in the order in which help lists them.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)*];

            /// The name on the command line, in recipes and in Python.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                <Self as $crate::NamedValue>::from_name(name)
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }
    };
    (@alias) => { None };
    (@alias $alias:literal) => { Some($alias) };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::denoise::Creases;
    use crate::features::Response;
    use crate::filter::{KeepVolume, Preset};
    use crate::operator::OperatorKind;
    use crate::positions::{Borders, MoveDirection, Volume};
    use crate::saliency::MapWeighting;
    use crate::shape::{CloudArea, MeshArea};

    fn check<T: NamedValue + std::fmt::Debug>() {
        for (k, entry) in T::ENTRIES.iter().enumerate() {
            assert_eq!(T::from_name(entry.name), Ok(entry.value));
            if let Some(alias) = entry.alias {
                assert_eq!(T::from_name(alias), Ok(entry.value));
            }
            let is_first = T::ENTRIES.iter().position(|other| other.name == entry.name) == Some(k);
            assert!(is_first, "{} stands twice", entry.name);
        }
        assert!(T::from_name("nonsense").unwrap_err().to_string().starts_with(T::NOUN));
    }

    #[test]
    fn every_name_reads_back_to_its_value() {
        check::<MoveDirection>();
        check::<Borders>();
        check::<CloudArea>();
        check::<Creases>();
        check::<KeepVolume>();
        check::<MapWeighting>();
        check::<MeshArea>();
        check::<OperatorKind>();
        check::<Preset>();
        check::<Response>();
        check::<Volume>();
    }

    #[test]
    fn recipes_use_the_same_names() {
        check_serde::<MoveDirection>();
        check_serde::<Borders>();
        check_serde::<Creases>();
        check_serde::<OperatorKind>();
        check_serde::<Preset>();
        check_serde::<Volume>();
    }

    fn check_serde<T: NamedValue + std::fmt::Debug + for<'de> serde::Deserialize<'de>>() {
        for entry in T::ENTRIES {
            let name: serde::de::value::StrDeserializer<'_, serde::de::value::Error> =
                serde::de::IntoDeserializer::into_deserializer(entry.name);
            assert_eq!(T::deserialize(name).unwrap(), entry.value);
        }
    }
}
