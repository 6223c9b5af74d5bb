//! All of YAML, by the library, with limits.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;

use super::super::error::{FormatError, FormatProblem};
use super::{Kind, MAX_DEPTH, Raw};

/// Longest file that is read here; aliases and anchors make memory grow faster than the file.
const MAX_BYTES: usize = 4 << 20;
/// Longest text that is kept, so that repeating one by aliases stays cheap.
const MAX_TEXT: usize = 1024;

/// Reads `text` into nodes and the copies of their scalars.
pub(super) fn read(name: &str, text: &str) -> Result<(Vec<Raw>, String), FormatError> {
    if text.len() > MAX_BYTES {
        let what = "bytes of a file with anchors, texts of several lines or letters beyond ASCII";
        let problem = FormatProblem::TooMany { what, count: text.len(), most: MAX_BYTES };
        return Err(FormatError::new(name, 1, 1, problem));
    }
    let options = serde_saphyr::options! {
        with_snippet: false,
        strict_booleans: true,
        non_finite_float_policy: serde_saphyr::NonFiniteFloatPolicy::Reject,
        budget: serde_saphyr::budget! {
            max_depth: MAX_DEPTH,
            max_events: 2_000_000,
            max_nodes: 1_000_000,
            max_aliases: 1_000,
            max_anchors: 1_000,
            max_recorded_anchor_events: 100_000,
            max_recorded_anchor_bytes: MAX_BYTES,
            max_merge_keys: 1_000,
        },
        alias_limits: serde_saphyr::alias_limits! {
            max_total_replayed_events: 20_000,
            max_replay_stack_depth: 16,
        },
    };
    let root: Value = serde_saphyr::from_str_with_options(text, options).map_err(|error| problem(name, &error))?;
    // the first byte keeps the copies from being empty, which means that there are none
    let mut flat = Flat { nodes: Vec::new(), copied: " ".to_owned() };
    flat.add(&root, 0);
    Ok((flat.nodes, flat.copied))
}

fn problem(name: &str, error: &serde_saphyr::Error) -> FormatError {
    let full = error.to_string();
    let line = full.lines().next().unwrap_or_default();
    let message = line.rsplit_once(" at line ").map_or(line, |(message, _)| message);
    let message = message.trim_start_matches("budget breached: ").to_owned();
    let number = |n: u64| usize::try_from(n).unwrap_or(usize::MAX).max(1);
    let (line, column) = error.location().map_or((1, 1), |at| (number(at.line()), number(at.column())));
    FormatError::new(name, line, column, FormatProblem::Syntax { message })
}

struct Flat {
    nodes: Vec<Raw>,
    copied: String,
}

impl Flat {
    fn scalar(&mut self, kind: Kind, text: &str, place: u32) {
        let from = self.copied.len() as u32;
        self.copied.push_str(text);
        self.nodes.push(Raw { kind, place, from, to: self.copied.len() as u32 });
    }

    fn add(&mut self, value: &Value, place: u32) {
        match value {
            Value::Null => self.nodes.push(Raw { kind: Kind::Null, place, from: 0, to: 0 }),
            Value::Plain(text) => self.scalar(Kind::Plain, text, place),
            Value::Text(text) => self.scalar(Kind::Quoted, text, place),
            Value::List(items) => {
                let index = self.nodes.len();
                self.nodes.push(Raw { kind: Kind::List, place, from: items.len() as u32, to: 0 });
                for item in items {
                    self.add(&item.value, item.place);
                }
                self.nodes[index].to = self.nodes.len() as u32;
            }
            Value::Map(entries) => {
                let index = self.nodes.len();
                self.nodes.push(Raw { kind: Kind::Map, place, from: entries.len() as u32, to: 0 });
                for (key, key_place, item) in entries {
                    self.scalar(Kind::Plain, key, *key_place);
                    self.add(&item.value, item.place);
                }
                self.nodes[index].to = self.nodes.len() as u32;
            }
        }
    }
}

struct Placed {
    value: Value,
    place: u32,
}

enum Value {
    Null,
    /// A number or a truth value.
    Plain(String),
    Text(String),
    List(Vec<Placed>),
    Map(Vec<(String, u32, Placed)>),
}

fn place(at: serde_saphyr::Location) -> u32 {
    at.span().byte_offset().and_then(|offset| u32::try_from(offset).ok()).unwrap_or(0)
}

impl<'de> Deserialize<'de> for Placed {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let spanned = Spanned::<Value>::deserialize(deserializer)?;
        Ok(Self { value: spanned.value, place: place(spanned.referenced) })
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
        Ok(Value::Plain(value.to_string()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Plain(value.to_string()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Plain(value.to_string()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(Value::Plain(value.to_string()))
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Value, E> {
        if text.len() > MAX_TEXT {
            return Err(E::custom("a text of more than 1024 bytes"));
        }
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
        while let Some((key, item)) = map.next_entry::<Spanned<String>, Placed>()? {
            entries.push((key.value, place(key.referenced), item));
        }
        Ok(Value::Map(entries))
    }
}
