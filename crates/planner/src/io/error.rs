//! What is wrong with a file, where, and how to mend it.

use std::fmt;

use crate::instance::VehicleError;

/// A file that cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub struct FormatError(Box<Details>);

#[derive(Clone, Debug, PartialEq)]
struct Details {
    file: String,
    line: usize,
    column: usize,
    problem: FormatProblem,
}

impl FormatError {
    /// The problem at byte `offset` of `text`.
    pub(crate) fn at(file: &str, text: &str, offset: usize, problem: FormatProblem) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line = 1 + before.bytes().filter(|byte| *byte == b'\n').count();
        let tail = before.rsplit('\n').next().unwrap_or_default();
        Self::new(file, line, 1 + tail.chars().count(), problem)
    }

    /// The problem at a line and column, both counted from 1.
    pub fn new(file: &str, line: usize, column: usize, problem: FormatProblem) -> Self {
        Self(Box::new(Details { file: file.to_owned(), line, column, problem }))
    }

    /// Name of the file, as given to the reader.
    pub fn file(&self) -> &str {
        &self.0.file
    }

    /// Line, counted from 1.
    pub fn line(&self) -> usize {
        self.0.line
    }

    /// Column in characters, counted from 1.
    pub fn column(&self) -> usize {
        self.0.column
    }

    /// What is wrong, as data.
    pub fn problem(&self) -> &FormatProblem {
        &self.0.problem
    }

    /// What is wrong, without the place.
    pub fn message(&self) -> String {
        self.0.problem.to_string()
    }

    /// What to do about it.
    pub fn remedy(&self) -> String {
        self.0.problem.remedy()
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Details { file, line, column, problem } = &*self.0;
        write!(f, "{file}:{line}:{column}: {problem}")
    }
}

impl std::error::Error for FormatError {}

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatProblem {
    /// It is not valid YAML.
    #[error("not valid YAML: {message}")]
    Syntax {
        /// What the reader of YAML says.
        message: String,
    },
    /// It is a file of another kind.
    #[error("{found}")]
    OtherKind {
        /// What it looks like.
        found: &'static str,
        /// What to do with it.
        remedy: &'static str,
    },
    /// There is more of something than is read.
    #[error("{what}: {count} are too many, at most {most} are read")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many may be.
        most: usize,
    },
    /// The map is too large for what moves in it.
    #[error("a map of {width} × {height} has {cells} cells, at most {most} are read")]
    TooLarge {
        /// Extent in x.
        width: f64,
        /// Extent in y.
        height: f64,
        /// Cells that a search would need; for cars of one step's length.
        cells: f64,
        /// How many may be.
        most: usize,
    },
    /// A value of another type.
    #[error("`{what}` must be {expected}, not {found}")]
    WrongType {
        /// The key.
        what: String,
        /// What is expected there.
        expected: String,
        /// What stands there.
        found: String,
    },
    /// A number outside of its range.
    #[error("`{what}` is {value}; it must be {range}")]
    OutOfRange {
        /// The key.
        what: String,
        /// The number.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// A key that must be there.
    #[error("`{key}` is missing in {place}")]
    MissingKey {
        /// The key.
        key: &'static str,
        /// Where.
        place: &'static str,
    },
    /// A key that means nothing here.
    #[error("unknown key `{key}` in {place}")]
    UnknownKey {
        /// The key.
        key: String,
        /// Where.
        place: &'static str,
        /// The known ones.
        allowed: Vec<&'static str>,
    },
    /// The same key twice.
    #[error("key `{key}` is given twice")]
    DuplicateKey {
        /// The key.
        key: String,
    },
    /// The same name twice.
    #[error("two agents are called `{name}`")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// An agent with a goal of its own and goals to choose from.
    #[error("an agent has both `goal` and `potentialGoals`")]
    TwoKindsOfGoals,
    /// A body that cannot be.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// A polygon whose corners do not make a convex outline.
    #[error("the polygon is not convex, or has no area")]
    NotConvex,
    /// A character that stands for nothing in a map.
    #[error("`{character}` stands for nothing in a map")]
    UnknownCharacter {
        /// The character.
        character: char,
    },
    /// A line of a map or scenario file that is not as it must be.
    #[error("{found}; expected {expected}")]
    Line {
        /// What stands there.
        found: String,
        /// What must stand there.
        expected: String,
    },
    /// Fewer agents than asked for.
    #[error("{asked} agents were asked for, and the file has {present}")]
    TooFewAgents {
        /// How many were asked for.
        asked: usize,
        /// How many there are.
        present: usize,
    },
    /// A scenario made for another map.
    #[error("the scenario is for a map of {scenario_width} × {scenario_height}, and the map is {width} × {height}")]
    OtherMap {
        /// Columns in the scenario.
        scenario_width: i32,
        /// Rows in the scenario.
        scenario_height: i32,
        /// Columns of the map.
        width: i32,
        /// Rows of the map.
        height: i32,
    },
    /// A plan without one of the agents.
    #[error("the schedule has no agent `{name}`")]
    MissingAgent {
        /// Whose route is missing.
        name: String,
    },
    /// A plan with an agent that the instance does not have.
    #[error("the instance has no agent `{name}`")]
    UnknownAgent {
        /// Who.
        name: String,
    },
    /// Steps that do not follow one another.
    #[error("step {found} of `{name}` stands where step {expected} must be")]
    Step {
        /// Whose.
        name: String,
        /// What `t` is.
        found: i64,
        /// What it must be.
        expected: i64,
    },
    /// A route without states.
    #[error("the route of `{name}` has no states")]
    EmptyRoute {
        /// Whose.
        name: String,
    },
}

impl FormatProblem {
    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Syntax { .. } => "mend the indentation, quotes and brackets there, or write the file anew".to_owned(),
            Self::OtherKind { remedy, .. } => (*remedy).to_owned(),
            Self::TooMany { .. } => "split the file into smaller ones".to_owned(),
            Self::TooLarge { .. } => "make the map smaller, or its cells coarser".to_owned(),
            Self::WrongType { expected, .. } => format!("write {expected} there"),
            Self::OutOfRange { range, .. } => format!("write a number that is {range}"),
            Self::MissingKey { key, .. } => format!("add `{key}:`"),
            Self::UnknownKey { allowed, .. } => format!("known are `{}`", allowed.join("`, `")),
            Self::DuplicateKey { .. } => "remove one of the two".to_owned(),
            Self::DuplicateName { .. } => "give every agent a name of its own, plans are matched by name".to_owned(),
            Self::TwoKindsOfGoals => {
                "keep one: `goal` is the agent's own, `potentialGoals` are to choose from".to_owned()
            }
            Self::Vehicle(_) => "correct it in `vehicle:` or in the file of --vehicle".to_owned(),
            Self::NotConvex => "split it into convex polygons, corners in order around each".to_owned(),
            Self::UnknownCharacter { .. } => "free are `.`, `G` and `S`; blocked are `@`, `O`, `T` and `W`".to_owned(),
            Self::Line { expected, .. } => format!("write {expected} there"),
            Self::TooFewAgents { present, .. } => format!("ask for at most {present}"),
            Self::OtherMap { .. } => "give the map that the scenario names".to_owned(),
            Self::MissingAgent { name } => format!("add `{name}:` with its states to `schedule:`"),
            Self::UnknownAgent { .. } => "remove its route, or give the instance that the plan is for".to_owned(),
            Self::Step { .. } => "list the states of every step from 0 on, none left out".to_owned(),
            Self::EmptyRoute { .. } => "list at least the state of step 0".to_owned(),
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
