//! YAML as a tree that remembers where everything was written.
//!
//! Overrides and drawn values are set in this tree before it is decoded, so that they are read and checked like the file.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;

use super::error::Problem;

/// A stretch of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// Length in bytes; 0 where only the start is known.
    pub length: usize,
}

impl Span {
    /// The beginning of the file.
    pub const START: Self = Self { line: 1, column: 1, length: 0 };

    pub(crate) fn new(location: serde_saphyr::Location) -> Self {
        let number = |n: u64| usize::try_from(n).unwrap_or(usize::MAX);
        let length = location.span().byte_len().map_or(0, number);
        Self { line: number(location.line()).max(1), column: number(location.column()).max(1), length }
    }
}

/// Where a value was given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In the file.
    File(Span),
    /// In an override, counted from 0.
    Override(usize),
}

/// A value and where it was given.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub value: Value,
    pub place: Place,
}

/// A YAML value.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Null,
    Bool(bool),
    Integer(i128),
    Float(f64),
    Text(String),
    List(Vec<Node>),
    Map(Vec<Entry>),
}

/// A key with its value.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub key: String,
    pub place: Place,
    pub node: Node,
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => f.write_str("null"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Float(value) => write!(f, "{value}"),
            Self::Text(text) => write!(f, "text `{}`", abbreviated(text)),
            Self::List(items) => write!(f, "a list of {}", items.len()),
            Self::Map(entries) => write!(f, "{} keys", entries.len()),
        }
    }
}

/// At most 40 characters of a text, without line breaks or control characters.
pub(crate) fn abbreviated(text: &str) -> String {
    let mut short: String = text.chars().take(40).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

/// Parts of a path such as `loads.0.mass`; what follows `randomize.` is one key, dots included.
pub(crate) fn segments(path: &str) -> Vec<&str> {
    match path.strip_prefix("randomize.") {
        Some(key) => vec!["randomize", key],
        None => path.split('.').collect(),
    }
}

/// A path and one more part.
pub(crate) fn join(path: &str, segment: impl fmt::Display) -> String {
    if path.is_empty() { segment.to_string() } else { format!("{path}.{segment}") }
}

impl Node {
    /// Marks the whole tree as given in one place.
    pub fn moved_to(mut self, place: Place) -> Self {
        self.place = place;
        match &mut self.value {
            Value::List(items) => {
                for item in items {
                    *item = std::mem::replace(item, Self { value: Value::Null, place }).moved_to(place);
                }
            }
            Value::Map(entries) => {
                for entry in entries {
                    entry.place = place;
                    entry.node = std::mem::replace(&mut entry.node, Self { value: Value::Null, place }).moved_to(place);
                }
            }
            _ => {}
        }
        self
    }

    fn entry(&self, key: &str) -> Option<&Entry> {
        match &self.value {
            Value::Map(entries) => entries.iter().find(|entry| entry.key == key),
            _ => None,
        }
    }

    fn child(&self, segment: &str) -> Option<(&Self, Place)> {
        match &self.value {
            Value::List(items) => items.get(segment.parse::<usize>().ok()?).map(|item| (item, item.place)),
            _ => self.entry(segment).map(|entry| (&entry.node, entry.place)),
        }
    }

    /// The value at `path`.
    pub fn get(&self, path: &str) -> Option<&Self> {
        segments(path).into_iter().try_fold(self, |node, segment| node.child(segment).map(|(child, _)| child))
    }

    /// Where the value at `path` was given; where it was not, the key that should hold it.
    pub fn place(&self, path: &str) -> Place {
        let mut node = self;
        let mut key = self.place;
        for segment in segments(path) {
            match node.child(segment) {
                Some((child, place)) => (node, key) = (child, place),
                None => return key,
            }
        }
        node.place
    }

    /// Turns a path of the Rust structs (as in `controller[0].speed_min`) into the path of the file: the names of
    /// enum variants are put in, renamed keys replaced.
    pub fn path_in_file(&self, path: &str) -> String {
        let mut node = Some(self);
        let mut found = String::new();
        for segment in path.split(['.', '[', ']']).filter(|segment| !segment.is_empty()) {
            let segment = if segment == "breakaway" { "static" } else { segment };
            // a variant's name stands in the file as the only key
            let variant = node.and_then(|node| match &node.value {
                Value::Map(entries) if entries.len() == 1 && node.child(segment).is_none() => entries.first(),
                _ => None,
            });
            if let Some(entry) = variant {
                found = join(&found, &entry.key);
                node = Some(&entry.node);
                if segment.parse::<usize>().is_ok() {
                    continue;
                }
            }
            found = join(&found, segment);
            node = node.and_then(|node| node.child(segment)).map(|(child, _)| child);
        }
        found
    }

    /// Sets the value at `path`, making what is missing on the way. `is_choice` says whether a path holds exactly one of
    /// several keys, so that a new one replaces the old.
    pub fn set(&mut self, path: &str, value: Self, is_choice: &dyn Fn(&str) -> bool) -> Result<(), Problem> {
        let place = value.place;
        let mut node = self;
        let mut here = String::new();
        for segment in segments(path) {
            let index = segment.parse::<usize>().ok();
            if !matches!((&node.value, index), (Value::Map(_), _) | (Value::List(_), Some(_))) {
                if let Value::List(items) = &node.value {
                    return Err(Problem::NoSuchEntry { path: join(&here, segment), list: here, entries: items.len() });
                }
                let empty = if index.is_some() { Value::List(Vec::new()) } else { Value::Map(Vec::new()) };
                *node = Self { value: empty, place };
            }
            let null = Self { value: Value::Null, place };
            node = match (&mut node.value, index) {
                (Value::List(items), Some(index)) => {
                    let entries = items.len();
                    if index == entries {
                        items.push(null);
                    }
                    match items.get_mut(index) {
                        Some(item) => item,
                        None => return Err(Problem::NoSuchEntry { path: join(&here, segment), list: here, entries }),
                    }
                }
                (Value::Map(entries), _) => {
                    let position = match entries.iter().position(|entry| entry.key == segment) {
                        Some(position) => position,
                        None => {
                            if is_choice(&here) {
                                entries.clear();
                            }
                            entries.push(Entry { key: segment.to_owned(), place, node: null });
                            entries.len() - 1
                        }
                    };
                    &mut entries[position].node
                }
                _ => return Err(Problem::NoSuchEntry { path: path.to_owned(), list: here, entries: 0 }),
            };
            here = join(&here, segment);
        }
        *node = value;
        Ok(())
    }

    /// Drops the entries of `randomize` for `path` and everything below it.
    pub fn fix(&mut self, path: &str) {
        let Value::Map(entries) = &mut self.value else { return };
        let Some(randomize) = entries.iter_mut().find(|entry| entry.key == "randomize") else { return };
        if let Value::Map(drawn) = &mut randomize.node.value {
            drawn.retain(|entry| {
                entry.key.strip_prefix(path).is_none_or(|rest| !(rest.is_empty() || rest.starts_with('.')))
            });
        }
    }
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = Spanned::<Value>::deserialize(deserializer)?;
        Ok(Self { value: spanned.value, place: Place::File(Span::new(spanned.referenced)) })
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a YAML value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_none<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Integer(value.into()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Integer(value.into()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(Value::Float(value))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Value::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut entries = Vec::new();
        while let Some((key, node)) = map.next_entry::<Spanned<String>, Node>()? {
            let place = Place::File(Span::new(key.referenced));
            entries.push(Entry { key: key.value, place, node });
        }
        Ok(Value::Map(entries))
    }
}
