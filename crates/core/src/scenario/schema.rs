//! The JSON Schema of scenario files, for editors and for messages.

use std::sync::LazyLock;

use serde_json::Value;

use super::document::Scenario;

static SCHEMA: LazyLock<Value> = LazyLock::new(|| Value::from(schemars::schema_for!(Scenario)));

/// The JSON Schema (2020-12) of scenario files, pretty-printed: the text of `scenarios/scenario.schema.json`.
pub fn schema() -> String {
    format!("{:#}\n", *SCHEMA)
}

/// What the schema says about one key.
pub(crate) struct Key {
    schema: &'static Value,
    described: &'static Value,
}

/// What the schema says about the key at `path`.
pub(crate) fn describe(path: &str) -> Option<Key> {
    let mut key = Key { schema: resolved(&SCHEMA), described: &SCHEMA };
    if path.is_empty() {
        return Some(key);
    }
    for segment in super::tree::segments(path) {
        let described = child(key.schema, segment)?;
        key = Key { schema: resolved(described), described };
    }
    Some(key)
}

/// Whether the value at `path` is one of several keys with its value.
pub(crate) fn is_choice(path: &str) -> bool {
    describe(path).is_some_and(|key| key.schema.get("oneOf").is_some())
}

/// Follows references and takes the alternative that is not null.
fn resolved(mut schema: &'static Value) -> &'static Value {
    loop {
        let target =
            schema.get("$ref").and_then(Value::as_str).and_then(|name| SCHEMA.pointer(name.strip_prefix('#')?));
        let some = || {
            let alternatives = schema.get("anyOf")?.as_array()?;
            alternatives.iter().find(|one| one.get("type").and_then(Value::as_str) != Some("null"))
        };
        match target.or_else(some) {
            Some(next) => schema = next,
            None => return schema,
        }
    }
}

fn child(schema: &'static Value, segment: &str) -> Option<&'static Value> {
    if let Some(found) = schema.get("properties").and_then(|properties| properties.get(segment)) {
        return Some(found);
    }
    if let Some(alternatives) = schema.get("oneOf").and_then(Value::as_array) {
        return alternatives.iter().find_map(|one| child(resolved(one), segment));
    }
    if segment.parse::<usize>().is_ok()
        && let Some(items) = schema.get("items")
    {
        return Some(items);
    }
    schema.get("additionalProperties").filter(|other| other.is_object())
}

impl Key {
    fn is(&self, kind: &str) -> bool {
        match self.schema.get("type") {
            Some(Value::String(name)) => name == kind,
            Some(Value::Array(names)) => names.iter().any(|name| name == kind),
            _ => false,
        }
    }

    /// Whether the key holds one number.
    pub fn is_numeric(&self) -> bool {
        self.is("number") || self.is_whole()
    }

    /// Whether the key holds a whole number.
    pub fn is_whole(&self) -> bool {
        self.is("integer")
    }

    /// The comment of the key, as a sentence.
    pub fn description(&self) -> String {
        let text = |schema: &Value| schema.get("description").and_then(Value::as_str).map(str::to_owned);
        text(self.described).or_else(|| text(self.schema)).unwrap_or_default()
    }

    /// What the key may hold, as in "a number from 0 to 1".
    pub fn range(&self) -> String {
        let bound = |name: &str| self.schema.get(name).filter(|bound| bound.is_number());
        let (kind, low, high) = if self.is("array") {
            ("a list whose length is", bound("minItems"), bound("maxItems"))
        } else if self.is("string") {
            if let Some(pattern) = self.schema.get("pattern").and_then(|p| p.as_str()) {
                let starts = if pattern.contains("[A-Za-z_]") { ", the first no digit" } else { "" };
                let signs =
                    if pattern.contains("_-") { "letters, digits, `_` and `-`" } else { "letters, digits and `_`" };
                return format!("1 to 64 {signs}{starts}");
            }
            ("a text whose length is", bound("minLength"), bound("maxLength"))
        } else if self.is("object") {
            ("a number of keys that is", None, bound("maxProperties"))
        } else if self.is_whole() {
            ("a whole number", bound("minimum"), bound("maximum"))
        } else {
            ("a number", bound("minimum"), bound("maximum"))
        };
        match (low, high) {
            (Some(low), Some(high)) => format!("{kind} from {low} to {high}"),
            (Some(low), None) => format!("{kind} of at least {low}"),
            (None, Some(high)) => format!("{kind} of at most {high}"),
            (None, None) => kind.to_owned(),
        }
    }
}
