//! Overrides: `path=value` given beside the file.

use std::fmt;

use super::error::{Problem, ScenarioError, Source};
use super::read;
use super::tree::{Node, Place, Span, abbreviated};

/// One key set from outside the file, as `--set loads.0.mass=3.3` does.
///
/// The path has dots and list indices; the value is YAML. Missing parts of the path are made, an index one past the end of a
/// list appends, and a key that `randomize` would draw keeps the value given here.
///
/// ```
/// # use cohaul_core::scenario::Override;
/// assert_eq!(Override::parse("loads.0.mass = 3.3")?.path(), "loads.0.mass");
/// assert!(Override::parse("loads.0.mass").is_err());
/// # Ok::<(), cohaul_core::scenario::ScenarioError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Override {
    text: String,
    path: String,
    value: Node,
}

impl Override {
    /// An override from `path=value`.
    ///
    /// # Errors
    /// No `=`, an empty part of the path, or a value that is not YAML.
    pub fn parse(text: &str) -> Result<Self, ScenarioError> {
        let refused = |problem| {
            Err(ScenarioError::new(&Source::new("override", ""), problem, Span::START, vec![abbreviated(text)]))
        };
        let invalid = |reason: &str| Problem::OverrideSyntax { text: abbreviated(text), reason: reason.to_owned() };
        let Some((path, value)) = text.split_once('=') else { return refused(invalid("there is no `=`")) };
        let path = path.trim();
        if path.split('.').any(|segment| segment.trim() != segment || segment.is_empty()) {
            return refused(invalid("a part of the path is empty"));
        }
        if path.split('.').count() > 16 {
            return refused(invalid("no path has more than 16 parts"));
        }
        match read(value.trim().as_bytes()) {
            Ok(node) => {
                Ok(Self { text: format!("{path}={}", abbreviated(value.trim())), path: path.to_owned(), value: node })
            }
            Err(fault) => refused(fault.problem),
        }
    }

    /// The key that is set.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Sets the key in `tree`, as override number `index`.
    pub(crate) fn apply(&self, tree: &mut Node, index: usize) -> Result<(), Problem> {
        let value = self.value.clone().moved_to(Place::Override(index));
        tree.set(&self.path, value, &super::schema::is_choice)?;
        if self.path.split('.').next() != Some("randomize") {
            tree.fix(&self.path);
        }
        Ok(())
    }
}

impl fmt::Display for Override {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
