//! Levels of factors, the cells they make, and measured values.

use std::cmp::Ordering;
use std::fmt;

use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};

/// Level of a factor: a number or a word. Made by `From`, which sees to it that no word reads as a finite number, and that
/// numbers are finite and zero has no sign: two levels are equal exactly if they print the same.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged, from = "AnyLevel")]
pub enum Level {
    /// A finite number.
    Number(f64),
    /// A word.
    Text(String),
}

/// A level as it stands in a file.
#[derive(Deserialize)]
#[serde(untagged)]
enum AnyLevel {
    Number(f64),
    Text(String),
    Boolean(bool),
}

impl From<AnyLevel> for Level {
    fn from(level: AnyLevel) -> Self {
        match level {
            AnyLevel::Number(number) => number.into(),
            AnyLevel::Text(text) => text.into(),
            AnyLevel::Boolean(truth) => truth.to_string().into(),
        }
    }
}

impl From<f64> for Level {
    fn from(number: f64) -> Self {
        // −0 + 0 = 0
        if number.is_finite() { Self::Number(number + 0.0) } else { Self::Text(number.to_string()) }
    }
}

impl From<u32> for Level {
    fn from(number: u32) -> Self {
        Self::Number(f64::from(number))
    }
}

impl From<usize> for Level {
    fn from(number: usize) -> Self {
        Self::Number(number as f64)
    }
}

impl From<String> for Level {
    fn from(text: String) -> Self {
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => number.into(),
            _ => Self::Text(text),
        }
    }
}

impl From<&str> for Level {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl Ord for Level {
    /// Numbers before words.
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a.total_cmp(b),
            (Self::Text(a), Self::Text(b)) => a.cmp(b),
            (Self::Number(_), Self::Text(_)) => Ordering::Less,
            (Self::Text(_), Self::Number(_)) => Ordering::Greater,
        }
    }
}

impl PartialOrd for Level {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Level {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Level {}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// What distinguishes a cell from the others: the level of each factor, in the order of the experiment's factors. The order
/// is for people: two keys with the same levels are equal.
///
/// ```
/// # use cohaul_sim::experiment::trials::Key;
/// let key = Key::new().with("terrain", "flat").with("mass_kg", 2.0);
/// assert_eq!(key.to_string(), "terrain=flat mass_kg=2");
/// ```
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Key(Named<Level>);

impl Key {
    /// Without a factor: the only cell of an experiment.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one factor more; one of this name is replaced.
    #[must_use]
    pub fn with(mut self, factor: &str, level: impl Into<Level>) -> Self {
        self.0.set(factor, level.into());
        self
    }

    /// Level of a factor.
    pub fn level(&self, factor: &str) -> Option<&Level> {
        self.0.value(factor)
    }

    /// Factors and their levels, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Level)> {
        self.0.iter()
    }

    fn by_name(&self) -> Vec<(&str, &Level)> {
        let mut levels: Vec<_> = self.iter().collect();
        levels.sort();
        levels
    }
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> Ordering {
        self.by_name().cmp(&other.by_name())
    }
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Key {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Key {}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (factor, level)) in self.iter().enumerate() {
            let space = if place == 0 { "" } else { " " };
            write!(f, "{space}{factor}={level}")?;
        }
        Ok(())
    }
}

/// Something measured in a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, from = "serde_json::Value")]
pub enum Value {
    /// Yes or no.
    Boolean(bool),
    /// A count.
    Integer(i64),
    /// A number.
    Number(f64),
    /// A word, or a nested value as JSON.
    Text(String),
}

impl Value {
    /// As a number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(integer) => Some(*integer as f64),
            Self::Number(number) => Some(*number),
            Self::Boolean(_) | Self::Text(_) => None,
        }
    }
}

impl From<serde_json::Value> for Value {
    fn from(value: serde_json::Value) -> Self {
        match value {
            serde_json::Value::Bool(truth) => Self::Boolean(truth),
            serde_json::Value::Number(number) => match number.as_i64() {
                Some(integer) => Self::Integer(integer),
                None => Self::Number(number.as_f64().unwrap_or(f64::NAN)),
            },
            serde_json::Value::String(text) => Self::Text(text),
            nested => Self::Text(nested.to_string()),
        }
    }
}

impl From<bool> for Value {
    fn from(truth: bool) -> Self {
        Self::Boolean(truth)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<i64> for Value {
    fn from(integer: i64) -> Self {
        Self::Integer(integer)
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        i64::try_from(count).map_or(Self::Number(count as f64), Self::Integer)
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boolean(truth) => write!(f, "{truth}"),
            Self::Integer(integer) => write!(f, "{integer}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// Names and what they stand for, in order, each name once; a map in files, where nulls are missing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Named<V>(pub(super) Vec<(String, V)>);

impl<V> Default for Named<V> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<V> Named<V> {
    pub(super) fn set(&mut self, name: &str, value: V) {
        match self.0.iter_mut().find(|(other, _)| other == name) {
            Some((_, old)) => *old = value,
            None => self.0.push((name.to_owned(), value)),
        }
    }

    pub(super) fn value(&self, name: &str) -> Option<&V> {
        self.0.iter().find(|(other, _)| other == name).map(|(_, value)| value)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&str, &V)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value))
    }
}

impl<V: Serialize> Serialize for Named<V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de, V: Deserialize<'de>> Deserialize<'de> for Named<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder<V>(std::marker::PhantomData<V>);
        impl<'de, V: Deserialize<'de>> Visitor<'de> for InOrder<V> {
            type Value = Named<V>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("names with values")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Named<V>, A::Error> {
                let mut named = Named::default();
                while let Some((name, value)) = map.next_entry::<String, Option<V>>()? {
                    if let Some(value) = value {
                        named.set(&name, value);
                    }
                }
                Ok(named)
            }
        }
        deserializer.deserialize_map(InOrder(std::marker::PhantomData))
    }
}
