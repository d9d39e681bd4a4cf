//! Items of an edit with the name and the eye that the list of the page gives them.

use adwave_io::{Pose, PoseHandle};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};

/// Clone or handle with its name and its eye.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedItem<T> {
    /// The clone or handle itself.
    pub item: T,
    /// Display name; empty for the usual one.
    pub name: String,
    /// True if the item has an effect.
    pub on: bool,
}

impl<T> From<T> for ListedItem<T> {
    fn from(item: T) -> Self {
        Self { item, name: String::new(), on: true }
    }
}

/// Removes a key from an object and parses its value; `None` if it is missing.
fn take<T: DeserializeOwned, E: Error>(object: &mut Map<String, Value>, key: &str) -> Result<Option<T>, E> {
    let value = object.remove(key);
    value.map(serde_json::from_value).transpose().map_err(|e| E::custom(format!("{key}: {e}")))
}

/// Converts a value to the object that it is written as.
fn to_object<S: Serializer>(value: &impl Serialize) -> Result<Map<String, Value>, S::Error> {
    let value = serde_json::to_value(value).map_err(serde::ser::Error::custom)?;
    Ok(if let Value::Object(object) = value { object } else { Map::new() })
}

/// The keys of the item, and `name` and `on` where they differ from an item without either.
impl<T: Serialize> Serialize for ListedItem<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = to_object::<S>(&self.item)?;
        if !self.name.is_empty() {
            object.insert("name".to_owned(), self.name.as_str().into());
        }
        if !self.on {
            object.insert("on".to_owned(), false.into());
        }
        object.serialize(serializer)
    }
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for ListedItem<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut object = Map::deserialize(deserializer)?;
        let name = take(&mut object, "name")?.unwrap_or_default();
        let on = take(&mut object, "on")?.unwrap_or(true);
        let item = serde_json::from_value(Value::Object(object)).map_err(D::Error::custom)?;
        Ok(Self { item, name, on })
    }
}

/// Pose whose handles and pins have eyes.
#[derive(Clone, Debug, PartialEq)]
pub struct DocumentPose {
    /// Widths and pins; its list of handles is empty.
    pub base: Pose,
    /// Handles, in the order in which they were made.
    pub handles: Vec<ListedItem<PoseHandle>>,
    /// True if the pins have an effect.
    pub is_pinned: bool,
}

impl From<Pose> for DocumentPose {
    fn from(mut pose: Pose) -> Self {
        let handles = std::mem::take(&mut pose.handles).into_iter().map(ListedItem::from).collect();
        Self { base: pose, handles, is_pinned: true }
    }
}

impl DocumentPose {
    /// Returns the pose of the handles and pins that are on.
    pub(crate) fn to_pose(&self) -> Pose {
        let handles = self.handles.iter().filter(|handle| handle.on).map(|handle| handle.item.clone());
        let fixed = self.base.fixed.clone().filter(|_| self.is_pinned);
        Pose { fixed, handles: handles.collect(), ..self.base.clone() }
    }
}

/// The keys of the pose, handles with theirs, and `pinned` if it is false.
impl Serialize for DocumentPose {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = to_object::<S>(&self.base)?;
        let handles = serde_json::to_value(&self.handles).map_err(serde::ser::Error::custom)?;
        object.insert("handle".to_owned(), handles);
        if !self.is_pinned {
            object.insert("pinned".to_owned(), false.into());
        }
        object.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for DocumentPose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut object = Map::deserialize(deserializer)?;
        let handles = take(&mut object, "handle")?.unwrap_or_default();
        let is_pinned = take(&mut object, "pinned")?.unwrap_or(true);
        let base = serde_json::from_value(Value::Object(object)).map_err(D::Error::custom)?;
        Ok(Self { base, handles, is_pinned })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave_io::DetailClone;
    use serde_json::json;

    #[test]
    fn names_and_eyes_are_written_only_where_they_differ() {
        let plain = json!({"source": 3, "targets": [5], "radius": 0.1});
        let read = |value: &Value| serde_json::from_value::<ListedItem<DetailClone>>(value.clone());
        assert_eq!(serde_json::to_value(read(&plain).unwrap()).unwrap(), plain);
        let named = json!({"source": 3, "targets": [5], "radius": 0.1, "name": "nose", "on": false});
        let item = read(&named).unwrap();
        assert_eq!((item.name.as_str(), item.on, item.item.source), ("nose", false, 3));
        assert_eq!(serde_json::to_value(&item).unwrap(), named);
        let wrong = json!({"source": 3, "targets": [5], "radius": 0.1, "eye": false});
        assert!(read(&wrong).unwrap_err().to_string().contains("unknown field `eye`"));
    }

    #[test]
    fn a_pose_leaves_out_what_is_off() {
        let handle = |vertex: u32, on: bool| {
            let mut handle =
                json!({"by": [0.0, 0.0, 0.5], "region": {"vertices": {"indices": [vertex], "radius": 0.0}}});
            if !on {
                handle["on"] = json!(false);
            }
            handle
        };
        let fixed = json!({"component": {"vertex": 1}});
        let value = json!({"fixed": fixed, "handle": [handle(7, true), handle(9, false)], "pinned": false});
        let pose: DocumentPose = serde_json::from_value(value.clone()).unwrap();
        assert_eq!(serde_json::to_value(&pose).unwrap(), value);
        let active = pose.to_pose();
        assert_eq!((active.handles.len(), active.fixed), (1, None));
        assert_eq!(active.handles[0], pose.handles[0].item);
    }
}
