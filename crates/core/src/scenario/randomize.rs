//! Keys drawn anew for every seed.

use super::document::Scenario;
use super::error::{Fault, Problem};
use super::schema;
use super::tree::{Node, Value, join};

/// Checks every range of `randomize`: the key exists and is numeric, the ends are in order, and each end makes a valid
/// scenario while the other keys keep their values.
pub(crate) fn check_ranges(scenario: &Scenario, tree: &Node) -> Result<(), Fault> {
    for (path, [low, high]) in &scenario.randomize {
        let entry = join("randomize", path);
        let refused = |reason: &str| {
            let problem = Problem::Randomize { path: super::tree::abbreviated(path), reason: reason.to_owned() };
            Err(Fault { problem, place: tree.place(&entry) })
        };
        if ["seed", "randomize", "format"].iter().any(|key| path.split('.').next() == Some(*key)) {
            return refused("this key is not drawn");
        }
        let Some(key) = schema::describe(path) else { return refused("there is no such key") };
        if !key.is_numeric() {
            return refused("it does not hold a number");
        }
        if low > high {
            return refused("the range runs from high to low");
        }
        if key.is_whole() && (low.fract() != 0.0 || high.fract() != 0.0) {
            return refused("the key holds whole numbers, the ends of its range do not");
        }
        if !exists(tree, path) {
            return refused("there is no such list entry, or it belongs to another choice");
        }
        for end in [low, high] {
            let mut drawn = tree.clone();
            let checked = set(&mut drawn, path, number(path, *end)).and_then(|()| super::check(&drawn));
            if let Err(fault) = checked {
                return refused(&format!("with {end}, {}", fault.problem));
            }
        }
    }
    Ok(())
}

/// Whether nothing but maps has to be made on the way to `path`, and no other choice was taken.
fn exists(tree: &Node, path: &str) -> bool {
    let mut node = Some(tree);
    let mut here = String::new();
    for segment in path.split('.') {
        let present = match node.map(|node| &node.value) {
            Some(Value::List(items)) => segment.parse::<usize>().is_ok_and(|index| index < items.len()),
            Some(Value::Map(entries)) => !schema::is_choice(&here) || entries.iter().any(|entry| entry.key == segment),
            Some(Value::Text(_)) => false,
            _ => segment.parse::<usize>().is_err(),
        };
        if !present {
            return false;
        }
        here = join(&here, segment);
        node = tree.get(&here);
    }
    true
}

/// The value drawn from [low, high] with `uniform` in [0, 1).
pub(crate) fn drawn(path: &str, [low, high]: [f64; 2], uniform: f64) -> Value {
    let value = if schema::describe(path).is_some_and(|key| key.is_whole()) {
        low + (uniform * (high - low + 1.0)).floor()
    } else {
        low + uniform * (high - low)
    };
    number(path, value.clamp(low, high))
}

fn number(path: &str, value: f64) -> Value {
    let whole = schema::describe(path).is_some_and(|key| key.is_whole());
    if whole { Value::Integer(value as i128) } else { Value::Float(value) }
}

/// Sets a drawn value; messages about it point at its range.
pub(crate) fn set(tree: &mut Node, path: &str, value: Value) -> Result<(), Fault> {
    let place = tree.place(&join("randomize", path));
    tree.set(path, Node { value, place }, &schema::is_choice).map_err(|problem| Fault { problem, place })
}
