//! Scenario files: what is moved, by whom, over which ground, how.
//!
//! ```
//! use cohaul_core::scenario::{self, Override};
//!
//! let text = "
//! format: cohaul/1
//! name: straight
//! world: planar
//! loads: [{id: load, shape: {rectangle: {length: 1.35, width: 0.35}}, mass: 2.0}]
//! teams:
//!   - id: team
//!     load: load
//!     robots: {count: 6}
//!     formation: {slots: six}
//!     mission: {goal: {x: 1.0, y: 0.0}}
//!     controller: {r2p2: {}}
//! ";
//! let heavier = Override::parse("loads.0.mass=3.3")?;
//! let parsed = scenario::parse("straight.yaml", text.as_bytes(), &[heavier])?;
//! assert_eq!(parsed.scenario.loads[0].mass, 3.3);
//!
//! let negative = Override::parse("loads.0.mass=-1")?;
//! let error = scenario::parse("straight.yaml", text.as_bytes(), &[negative]).unwrap_err();
//! assert!(error.to_string().starts_with("straight.yaml: --set loads.0.mass=-1: "));
//! # Ok::<(), cohaul_core::scenario::ScenarioError>(())
//! ```
//!
//! A file is read into a tree that remembers where each value stands, overrides are set in the tree, then it is decoded into
//! [`document::Scenario`] and checked. So overrides and drawn values pass the same checks as the file.

mod decode;
pub mod document;
mod error;
mod instance;
mod overrides;
mod problem;
mod randomize;
mod schema;
mod tree;
mod validate;

use std::sync::Arc;

use document::Scenario;
use error::{Fault, Source};
pub use error::{Problem, ScenarioError, Warning};
use garde::Validate;
pub use instance::{Instance, LoadInstance, TeamInstance};
pub use overrides::Override;
pub use schema::schema;
/// Why a scenario could not be written out as text.
pub use serde_saphyr::SerializeError as TextError;
use tree::{Node, Place, Span};

/// Largest scenario file, bytes. Read no more than one byte beyond it: a longer file is refused anyway.
pub const MAX_BYTES: usize = 1 << 20;

/// A valid scenario, not yet drawn for a seed.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The scenario as written, overrides applied.
    pub scenario: Scenario,
    /// What is allowed, but probably not meant.
    pub warnings: Vec<Warning>,
    source: Arc<Source>,
    tree: Node,
    overrides: Vec<Override>,
}

/// Reads and checks a scenario. `source` is the file's name for messages, `text` its content; `overrides` are set in order.
///
/// # Errors
/// The first problem, with its place in the file or the overrides that cause it.
pub fn parse(source: &str, text: &[u8], overrides: &[Override]) -> Result<Parsed, ScenarioError> {
    let shown = std::str::from_utf8(text).ok().filter(|text| text.len() <= MAX_BYTES);
    let file = Source::new(source, shown.unwrap_or_default());
    let bare = read(text).map_err(|fault| locate(&file, fault, overrides))?;
    let mut tree = bare.clone();
    for (index, change) in overrides.iter().enumerate() {
        change
            .apply(&mut tree, index)
            .map_err(|problem| locate(&file, Fault { problem, place: Place::Override(index) }, overrides))?;
    }
    let checked = check(&tree).and_then(|(scenario, warnings)| {
        randomize::check_ranges(&scenario, &tree)?;
        Ok((scenario, warnings))
    });
    let (scenario, warnings) = checked.map_err(|fault| blame(&file, fault, &bare, overrides))?;
    let warnings = warnings
        .into_iter()
        .map(|fault| {
            let (span, texts) = whereabouts(fault.place, overrides);
            Warning::new(&file, fault.problem, span, texts)
        })
        .collect();
    Ok(Parsed { scenario, warnings, source: file, tree, overrides: overrides.to_vec() })
}

impl Parsed {
    /// The scenario of one seed: every key of `randomize` drawn in the order of the keys, `randomize` emptied, `seed` set (the
    /// scenario's own where it is `None`). `draw` gives numbers uniform in [0, 1); whole-number keys take each value of their
    /// range with the same probability.
    ///
    /// # Errors
    /// Values drawn together that do not make a valid scenario.
    pub fn resolve(&self, seed: Option<u64>, draw: &mut dyn FnMut() -> f64) -> Result<Scenario, ScenarioError> {
        let mut tree = self.tree.clone();
        let mut drawn = Vec::new();
        for (path, range) in &self.scenario.randomize {
            let value = randomize::drawn(path, *range, draw());
            drawn.push(format!("{path}={value}"));
            randomize::set(&mut tree, path, value).map_err(|fault| locate(&self.source, fault, &self.overrides))?;
        }
        let (mut scenario, _) = check(&tree).map_err(|fault| {
            let problem = Problem::Drawn { drawn: drawn.join(", "), reason: fault.problem.to_string() };
            locate(&self.source, Fault { problem, place: tree.place("randomize") }, &self.overrides)
        })?;
        scenario.randomize.clear();
        scenario.seed = seed.unwrap_or(scenario.seed);
        Ok(scenario)
    }
}

impl Scenario {
    /// The scenario as YAML with every key written out; reading it back gives the same scenario bit for bit.
    ///
    /// # Errors
    /// None for a scenario that came from [`parse`].
    pub fn to_yaml(&self) -> Result<String, TextError> {
        serde_saphyr::to_string(self)
    }
}

/// YAML text as a tree.
fn read(text: &[u8]) -> Result<Node, Fault> {
    let start = Place::File(Span::START);
    if text.len() > MAX_BYTES {
        return Err(Fault { problem: Problem::TooLarge { bytes: text.len(), limit: MAX_BYTES }, place: start });
    }
    let text = std::str::from_utf8(text).map_err(|error| {
        let offset = error.valid_up_to();
        let before = text.get(..offset).unwrap_or_default();
        let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
        let tail = before.rsplit(|byte| *byte == b'\n').next().unwrap_or_default();
        let column = 1 + String::from_utf8_lossy(tail).chars().count();
        Fault { problem: Problem::NotText { offset }, place: Place::File(Span { line, column, length: 0 }) }
    })?;
    let options = serde_saphyr::options! {
        with_snippet: false,
        strict_booleans: true,
        non_finite_float_policy: serde_saphyr::NonFiniteFloatPolicy::Reject,
        budget: serde_saphyr::budget! {
            max_depth: 32,
            max_events: 400_000,
            max_nodes: 200_000,
            max_aliases: 1_000,
            max_anchors: 1_000,
            max_recorded_anchor_events: 100_000,
            max_recorded_anchor_bytes: 4 * MAX_BYTES,
            max_merge_keys: 1_000,
        },
        alias_limits: serde_saphyr::alias_limits! {
            max_total_replayed_events: 100_000,
            max_replay_stack_depth: 16,
        },
    };
    serde_saphyr::from_str_with_options(text, options).map_err(|error| {
        let place = Place::File(error.location().map_or(Span::START, Span::new));
        Fault { problem: yaml_problem(&error), place }
    })
}

fn yaml_problem(error: &serde_saphyr::Error) -> Problem {
    use serde_saphyr::Error;
    let full = error.to_string();
    let line = full.lines().next().unwrap_or_default();
    let message = line.rsplit_once(" at line ").map_or(line, |(message, _)| message);
    let message = message.trim_start_matches("budget breached: ").to_owned();
    match error {
        Error::AliasError { error, .. } => yaml_problem(error),
        Error::DuplicateMappingKey { key: Some(key), .. } => Problem::DuplicateKey { key: tree::abbreviated(key) },
        Error::NonFiniteFloat { value, .. } => Problem::NotFinite { value: tree::abbreviated(value) },
        Error::MultipleDocuments { .. } => Problem::Syntax { message: "more than one document (`---`)".to_owned() },
        Error::RecursiveReferencesRequireWeakTypes { .. } => {
            Problem::Syntax { message: "an alias stands inside its own anchor".to_owned() }
        }
        Error::NullIntoString { .. } => Problem::Syntax { message: "a key is empty".to_owned() },
        Error::Budget { .. }
        | Error::AliasReplayLimitExceeded { .. }
        | Error::AliasExpansionLimitExceeded { .. }
        | Error::AliasReplayStackDepthExceeded { .. } => Problem::Budget { message },
        _ => Problem::Syntax { message },
    }
}

/// Decodes the tree and checks every rule.
fn check(tree: &Node) -> Result<(Scenario, Vec<Fault>), Fault> {
    let scenario: Scenario = decode::decode(tree)?;
    if let Err(report) = scenario.validate()
        && let Some((path, error)) = report.iter().next()
    {
        let path = tree.path_in_file(&path.to_string());
        let value = tree.get(&path).map(|node| node.value.to_string()).unwrap_or_default();
        let place = tree.place(&path);
        return Err(Fault { problem: Problem::OutOfRange { path, value, reason: error.message().to_owned() }, place });
    }
    let warnings = validate::validate(&scenario, tree)?;
    Ok((scenario, warnings))
}

/// Where a fault is reported: its span, and the override that gave the value.
fn whereabouts(place: Place, overrides: &[Override]) -> (Span, Vec<String>) {
    match place {
        Place::File(span) => (span, Vec::new()),
        Place::Override(index) => (Span::START, overrides.get(index).map(Override::to_string).into_iter().collect()),
    }
}

fn locate(file: &Arc<Source>, fault: Fault, overrides: &[Override]) -> ScenarioError {
    let (span, texts) = whereabouts(fault.place, overrides);
    ScenarioError::new(file, fault.problem, span, texts)
}

/// Locates a fault at a value of the file, unless the file is right without some of the overrides: then these are at fault.
fn blame(file: &Arc<Source>, fault: Fault, bare: &Node, overrides: &[Override]) -> ScenarioError {
    let (span, mut texts) = whereabouts(fault.place, overrides);
    if texts.is_empty() {
        let valid_without = |left_out: usize| {
            let mut tree = bare.clone();
            let mut others = overrides.iter().enumerate().filter(|(index, _)| *index != left_out);
            others.all(|(index, change)| change.apply(&mut tree, index).is_ok()) && check(&tree).is_ok()
        };
        texts = (0..overrides.len().min(64)).filter(|i| valid_without(*i)).map(|i| overrides[i].to_string()).collect();
    }
    ScenarioError::new(file, fault.problem, span, texts)
}
