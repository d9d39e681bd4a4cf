//! JSON tree whose objects keep the order of their keys.

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::cell::Cell;
use std::fmt;

use crate::ReadError;

/// Largest number of values per document: a tree takes about ten times the bytes of its text.
const MOST_VALUES: usize = 20_000_000;

/// JSON value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Json {
    Null,
    Bool(bool),
    Number(serde_json::Number),
    Text(String),
    List(Vec<Json>),
    Object(Vec<(String, Json)>),
}

impl Json {
    /// Parses a text.
    pub(crate) fn parse(text: &[u8]) -> Result<Self, ReadError> {
        let n_values = Cell::new(0);
        let mut parser = serde_json::Deserializer::from_slice(text);
        let value = Seed(&n_values).deserialize(&mut parser).and_then(|value| parser.end().map(|()| value));
        value.map_err(|e| ReadError::Line {
            line: e.line() as u64,
            message: format!("the JSON is damaged ({e}); get the whole file"),
        })
    }

    pub(crate) fn to_text(&self) -> Vec<u8> {
        serde_json::to_vec(self).unwrap_or_default()
    }

    /// Member of that name.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        match self {
            Self::Object(members) => {
                members.iter().rev().find(|(name, _)| name == key).map(|(_, value)| value)
            }
            _ => None,
        }
    }

    pub(crate) fn get_mut(&mut self, key: &str) -> Option<&mut Self> {
        match self {
            Self::Object(members) => {
                members.iter_mut().rev().find(|(name, _)| name == key).map(|(_, value)| value)
            }
            _ => None,
        }
    }

    /// Sets the member of that name, or appends it.
    pub(crate) fn set(&mut self, key: &str, value: Self) {
        match self.get_mut(key) {
            Some(old) => *old = value,
            None => {
                if let Self::Object(members) = self {
                    members.push((key.to_owned(), value));
                }
            }
        }
    }

    pub(crate) fn remove(&mut self, key: &str) {
        if let Self::Object(members) = self {
            members.retain(|(name, _)| name != key);
        }
    }

    /// Values of a list; empty for other values.
    pub(crate) fn list(&self) -> &[Self] {
        if let Self::List(values) = self { values } else { &[] }
    }

    /// List of that name; empty if it is missing.
    pub(crate) fn list_of(&self, key: &str) -> &[Self] {
        self.get(key).map_or(&[], Self::list)
    }

    /// List of that name, created if it is missing.
    pub(crate) fn list_mut(&mut self, key: &str) -> Option<&mut Vec<Self>> {
        if self.get(key).is_none() {
            self.set(key, Self::List(Vec::new()));
        }
        match self.get_mut(key) {
            Some(Self::List(values)) => Some(values),
            _ => None,
        }
    }

    /// Non-negative integer.
    pub(crate) fn index(&self) -> Option<usize> {
        match self {
            Self::Number(n) => n.as_u64().and_then(|n| usize::try_from(n).ok()).or_else(|| {
                // Some writers write `4.0`.
                let x = n.as_f64().filter(|x| x.fract() == 0.0 && (0.0..9e15).contains(x))?;
                Some(x as usize)
            }),
            _ => None,
        }
    }

    pub(crate) fn index_of(&self, key: &str) -> Option<usize> {
        self.get(key).and_then(Self::index)
    }

    pub(crate) fn number(&self) -> Option<f64> {
        if let Self::Number(n) = self { n.as_f64() } else { None }
    }

    pub(crate) fn text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    pub(crate) fn text_of(&self, key: &str) -> Option<&str> {
        self.get(key).and_then(Self::text)
    }

    /// Array of `N` numbers of that name.
    pub(crate) fn numbers<const N: usize>(&self, key: &str) -> Option<[f64; N]> {
        let values = self.list_of(key);
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(values) {
            *number = value.number()?;
        }
        (values.len() == N).then_some(numbers)
    }

    pub(crate) fn of_number(x: f64) -> Self {
        serde_json::Number::from_f64(x).map_or(Self::Null, Self::Number)
    }
}

impl From<usize> for Json {
    fn from(n: usize) -> Self {
        Self::Number(n.into())
    }
}

impl From<&str> for Json {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

/// Creates an object of these members.
pub(crate) fn object<const N: usize>(members: [(&str, Json); N]) -> Json {
    Json::Object(members.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}

impl Serialize for Json {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Null => serializer.serialize_unit(),
            Self::Bool(value) => serializer.serialize_bool(*value),
            Self::Number(value) => value.serialize(serializer),
            Self::Text(value) => serializer.serialize_str(value),
            Self::List(values) => serializer.collect_seq(values),
            Self::Object(members) => {
                let mut map = serializer.serialize_map(Some(members.len()))?;
                for (key, value) in members {
                    map.serialize_entry(key, value)?;
                }
                map.end()
            }
        }
    }
}

/// Deserializes one value and counts it.
struct Seed<'a>(&'a Cell<usize>);

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Json;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Json, D::Error> {
        self.0.set(self.0.get() + 1);
        if self.0.get() > MOST_VALUES {
            return Err(D::Error::custom(format!("more than {MOST_VALUES} values")));
        }
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
    type Value = Json;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E>(self) -> Result<Json, E> {
        Ok(Json::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Json, E> {
        Ok(Json::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Json, E> {
        Ok(Json::Number(value.into()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Json, E> {
        Ok(Json::Number(value.into()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Json, E> {
        Ok(Json::of_number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Json, E> {
        Ok(Json::Text(value.to_owned()))
    }

    fn visit_string<E>(self, value: String) -> Result<Json, E> {
        Ok(Json::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Json, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = sequence.next_element_seed(Seed(self.0))? {
            values.push(value);
        }
        Ok(Json::List(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Json, A::Error> {
        let mut members = Vec::new();
        while let Some(key) = map.next_key()? {
            members.push((key, map.next_value_seed(Seed(self.0))?));
        }
        Ok(Json::Object(members))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_comes_back_with_its_keys_in_order() {
        let text = br#"{"z":[1,-2.5,true,null],"a":{"y":"\u00e9\n","b":18446744073709551615},"m":1e300}"#;
        let json = Json::parse(text).unwrap();
        let again = String::from_utf8(json.to_text()).unwrap();
        assert_eq!(
            again,
            "{\"z\":[1,-2.5,true,null],\"a\":{\"y\":\"\u{e9}\\n\",\"b\":18446744073709551615},\"m\":1e+300}"
        );
        assert_eq!(json.get("a").and_then(|a| a.text_of("y")), Some("\u{e9}\n"));
    }

    #[test]
    fn broken_and_deep_texts_are_errors() {
        for text in [&b""[..], b"{", b"[1,]", b"{}x", b"{\"a\" 1}", &vec![b'['; 100_000]] {
            let said = Json::parse(text).unwrap_err().to_string();
            assert!(said.contains("JSON is broken") && !said.contains('\n'), "{said}");
        }
    }
}
