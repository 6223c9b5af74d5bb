//! From the tree to the structs, with messages for people: every error knows its path and place.

use std::fmt;

use serde::de::value::StrDeserializer;
use serde::de::{
    self, DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess, Visitor,
};

use super::error::{Fault, Problem};
use super::tree::{Entry, Node, Place, Value, join};

/// Decodes the whole tree.
pub(crate) fn decode<'a, T: de::Deserialize<'a>>(tree: &'a Node) -> Result<T, Fault> {
    let decoder = Decoder { node: tree, key: tree.place, path: String::new() };
    let root = decoder.clone();
    T::deserialize(decoder).map_err(|error| root.locate(error).into_fault())
}

/// An error on its way out: serde makes the latter kinds, which learn their place on the way.
#[derive(Debug)]
pub(crate) enum DecodeError {
    Located(Box<Fault>),
    UnknownKey(String, &'static [&'static str]),
    UnknownValue(String, &'static [&'static str]),
    MissingKey(&'static str),
    Other(String),
}

impl DecodeError {
    fn into_fault(self) -> Fault {
        match self {
            Self::Located(fault) => *fault,
            other => Fault {
                problem: Problem::Syntax { message: other.to_string() },
                place: Place::File(super::tree::Span::START),
            },
        }
    }
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Located(fault) => write!(f, "{}", fault.problem),
            Self::UnknownKey(text, _) | Self::UnknownValue(text, _) | Self::Other(text) => f.write_str(text),
            Self::MissingKey(key) => f.write_str(key),
        }
    }
}

impl std::error::Error for DecodeError {}

impl de::Error for DecodeError {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self::Other(message.to_string())
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        Self::UnknownValue(variant.to_owned(), expected)
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        Self::UnknownKey(field.to_owned(), expected)
    }

    fn missing_field(field: &'static str) -> Self {
        Self::MissingKey(field)
    }
}

#[derive(Clone)]
struct Decoder<'a> {
    node: &'a Node,
    /// Where the key that holds the node stands.
    key: Place,
    path: String,
}

impl<'a> Decoder<'a> {
    fn wrong(&self, expected: impl Into<String>) -> DecodeError {
        let problem = Problem::WrongType {
            path: self.path.clone(),
            expected: expected.into(),
            found: self.node.value.to_string(),
        };
        DecodeError::Located(Box::new(Fault { problem, place: self.node.place }))
    }

    fn locate(&self, error: DecodeError) -> DecodeError {
        let path = self.path.clone();
        let list = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
        let (problem, place) = match error {
            DecodeError::Located(_) => return error,
            DecodeError::UnknownKey(key, allowed) => {
                (Problem::UnknownKey { path, key, allowed: list(allowed) }, self.node.place)
            }
            DecodeError::UnknownValue(found, allowed) => {
                (Problem::UnknownValue { path, found, allowed: list(allowed) }, self.node.place)
            }
            DecodeError::MissingKey(key) => (Problem::MissingKey { path, key: key.to_owned() }, self.key),
            DecodeError::Other(expected) => {
                (Problem::WrongType { path, expected, found: self.node.value.to_string() }, self.node.place)
            }
        };
        DecodeError::Located(Box::new(Fault { problem, place }))
    }

    fn whole(&self) -> Option<i128> {
        match self.node.value {
            Value::Integer(value) => Some(value),
            // 2^53: beyond it a float no longer names one whole number
            Value::Float(value) if value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0 => {
                Some(value as i128)
            }
            _ => None,
        }
    }

    fn map(self, entries: &'a [Entry]) -> Entries<'a> {
        Entries { entries: entries.iter(), value: None, decoder: self }
    }
}

macro_rules! whole {
    ($($method:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
            let Some(value) = self.whole() else { return Err(self.wrong("a whole number")) };
            let located = match (u64::try_from(value), i64::try_from(value)) {
                (Ok(value), _) => visitor.visit_u64(value),
                (_, Ok(value)) => visitor.visit_i64(value),
                _ => return Err(self.wrong("a whole number of at most 64 bits")),
            };
            located.map_err(|_: DecodeError| self.wrong("a whole number that is neither negative nor too large"))
        }
    )*};
}

impl<'de> Deserializer<'de> for Decoder<'de> {
    type Error = DecodeError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match &self.node.value {
            Value::Null => visitor.visit_unit(),
            Value::Bool(value) => visitor.visit_bool(*value),
            Value::Integer(_) => self.deserialize_i64(visitor),
            Value::Float(value) => visitor.visit_f64(*value),
            Value::Text(text) => visitor.visit_borrowed_str(text),
            Value::List(_) => self.deserialize_seq(visitor),
            Value::Map(_) => self.deserialize_map(visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match self.node.value {
            Value::Bool(value) => visitor.visit_bool(value),
            _ => Err(self.wrong("true or false")),
        }
    }

    whole!(deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64);

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match self.node.value {
            Value::Float(value) => visitor.visit_f64(value),
            Value::Integer(value) => visitor.visit_f64(value as f64),
            _ => Err(self.wrong("a number")),
        }
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match &self.node.value {
            Value::Text(text) => visitor.visit_borrowed_str(text),
            _ => Err(self.wrong("text")),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match self.node.value {
            Value::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, DecodeError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match &self.node.value {
            Value::List(items) => {
                let here = self.clone();
                visitor.visit_seq(Items { items, next: 0, path: self.path }).map_err(|error| here.locate(error))
            }
            _ => Err(self.wrong("a list")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, DecodeError> {
        match &self.node.value {
            Value::List(items) if items.len() == len => self.deserialize_seq(visitor),
            _ => Err(self.wrong(format!("a list of {len} numbers"))),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        match &self.node.value {
            Value::Map(entries) => {
                let here = self.clone();
                visitor.visit_map(self.map(entries)).map_err(|error| here.locate(error))
            }
            _ => Err(self.wrong("keys with values")),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DecodeError> {
        let one_of = || format!("one of {}", quoted(variants));
        match &self.node.value {
            Value::Text(text) if variants.contains(&text.as_str()) => {
                let name: StrDeserializer<'_, DecodeError> = text.as_str().into_deserializer();
                visitor.visit_enum(name).map_err(|_| self.wrong(format!("`{text}:` with its values below it")))
            }
            Value::Text(text) => Err(self.locate(DecodeError::UnknownValue(super::tree::abbreviated(text), variants))),
            Value::Map(entries) => match entries.as_slice() {
                [entry] => {
                    let content = Decoder { node: &entry.node, key: entry.place, path: join(&self.path, &entry.key) };
                    visitor.visit_enum(Choice { entry, content }).map_err(|error| match error {
                        DecodeError::UnknownValue(key, allowed) => {
                            let allowed = allowed.iter().map(|name| (*name).to_owned()).collect();
                            let problem = Problem::UnknownKey { path: self.path.clone(), key, allowed };
                            DecodeError::Located(Box::new(Fault { problem, place: entry.place }))
                        }
                        error => self.locate(error),
                    })
                }
                entries => {
                    let found = format!("{} keys", entries.len());
                    let expected = format!("exactly {}", one_of());
                    let problem = Problem::WrongType { path: self.path, expected, found };
                    // the second key is the one too many
                    let place = entries.get(1).map_or(self.node.place, |entry| entry.place);
                    Err(DecodeError::Located(Box::new(Fault { problem, place })))
                }
            },
            _ => Err(self.wrong(one_of())),
        }
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DecodeError> {
        self.deserialize_str(visitor)
    }

    serde::forward_to_deserialize_any! { i128 u128 char bytes byte_buf unit unit_struct tuple_struct ignored_any }
}

/// `a`, `b`, `c`.
pub(crate) fn quoted<T: AsRef<str>>(names: &[T]) -> String {
    names.iter().map(|name| format!("`{}`", name.as_ref())).collect::<Vec<_>>().join(", ")
}

struct Items<'a> {
    items: &'a [Node],
    next: usize,
    path: String,
}

impl<'de> SeqAccess<'de> for Items<'de> {
    type Error = DecodeError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, DecodeError> {
        let Some(node) = self.items.get(self.next) else { return Ok(None) };
        let decoder = Decoder { node, key: node.place, path: join(&self.path, self.next) };
        self.next += 1;
        seed.deserialize(decoder).map(Some)
    }
}

struct Entries<'a> {
    entries: std::slice::Iter<'a, Entry>,
    value: Option<&'a Entry>,
    decoder: Decoder<'a>,
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = DecodeError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, DecodeError> {
        let Some(entry) = self.entries.next() else { return Ok(None) };
        self.value = Some(entry);
        let key: StrDeserializer<'_, DecodeError> = entry.key.as_str().into_deserializer();
        let found = seed.deserialize(key).map_err(|error| match self.decoder.locate(error) {
            DecodeError::Located(mut fault) => {
                fault.place = entry.place;
                DecodeError::Located(fault)
            }
            other => other,
        });
        found.map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, DecodeError> {
        let Some(entry) = self.value.take() else {
            return Err(DecodeError::Other("a key before its value".to_owned()));
        };
        seed.deserialize(Decoder { node: &entry.node, key: entry.place, path: join(&self.decoder.path, &entry.key) })
    }
}

/// An enum variant given as its name with a value.
struct Choice<'a> {
    entry: &'a Entry,
    content: Decoder<'a>,
}

impl<'de> EnumAccess<'de> for Choice<'de> {
    type Error = DecodeError;
    type Variant = Decoder<'de>;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Decoder<'de>), DecodeError> {
        let name: StrDeserializer<'_, DecodeError> = self.entry.key.as_str().into_deserializer();
        Ok((seed.deserialize(name)?, self.content))
    }
}

impl<'de> VariantAccess<'de> for Decoder<'de> {
    type Error = DecodeError;

    fn unit_variant(self) -> Result<(), DecodeError> {
        Err(self.wrong("only the name, without a value below it"))
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, DecodeError> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, DecodeError> {
        self.deserialize_tuple(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], visitor: V) -> Result<V::Value, DecodeError> {
        self.deserialize_map(visitor)
    }
}
