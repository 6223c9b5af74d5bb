//! What the cells of an experiment have in common: a base scenario and the keys that a cell sets.

use cohaul_core::scenario::{self, Override, Parsed, ScenarioError};
use serde_json::{Map, Value};

use super::trials::{Key, Level};

/// A scenario file of the repository, compiled in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Base {
    /// Its name in `scenarios/r2p2`.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! base {
    ($name:literal) => {
        Base { name: $name, text: include_str!(concat!("../../../../scenarios/r2p2/", $name)) }
    };
}

/// One load, one way, six robots: what the tables vary.
pub const SINGLE: Base = base!("single.yaml");
/// Three legs over flat ground.
pub const FLAT: Base = base!("flat.yaml");
/// Three legs up a slope.
pub const UPHILL: Base = base!("uphill.yaml");
/// Three legs down a slope.
pub const DOWNHILL: Base = base!("downhill.yaml");
/// The laboratory mission of four robots.
pub const HARDWARE: Base = base!("hardware.yaml");
/// Ten robots.
pub const TEN: Base = base!("ten.yaml");
/// A field of obstacles, waypoints planned.
pub const CLUTTER: Base = base!("clutter.yaml");
/// Two teams with two loads.
pub const TWO_TEAMS: Base = base!("two_teams.yaml");

/// The paper's terrains: flat, and 5° up or down along the load's heading at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terrain {
    /// Level ground.
    Flat,
    /// 5° down.
    Downhill,
    /// 5° up.
    Uphill,
}

impl Terrain {
    /// All of them, in the order of Table I.
    pub const ALL: [Self; 3] = [Self::Flat, Self::Downhill, Self::Uphill];

    /// Its name as a level.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Downhill => "downhill",
            Self::Uphill => "uphill",
        }
    }

    /// Slope along +x, degrees.
    pub const fn slope_deg(self) -> f64 {
        match self {
            Self::Flat => 0.0,
            Self::Downhill => -5.0,
            Self::Uphill => 5.0,
        }
    }
}

/// One cell of an experiment: its key, its scenario, the paper's values.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Levels of the factors.
    pub key: Key,
    /// The scenario, not yet drawn for a seed.
    pub scenario: Parsed,
    /// What the paper reports, by name.
    pub paper: Map<String, Value>,
}

/// A cell being described.
#[derive(Clone, Debug)]
pub struct Design {
    base: Base,
    key: Key,
    changes: Vec<String>,
    paper: Map<String, Value>,
}

impl Design {
    /// A cell that runs `base` as it is.
    pub fn new(base: Base) -> Self {
        Self { base, key: Key::new(), changes: Vec::new(), paper: Map::new() }
    }

    /// Names the cell's level of a factor.
    #[must_use]
    pub fn level(mut self, factor: &str, level: impl Into<Level>) -> Self {
        self.key = self.key.with(factor, level);
        self
    }

    /// Sets a key of the scenario, as `--set` does.
    #[must_use]
    pub fn set(mut self, path: &str, value: impl std::fmt::Display) -> Self {
        self.changes.push(format!("{path}={value}"));
        self
    }

    /// Notes a value of the paper.
    #[must_use]
    pub fn paper(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.paper.insert(name.to_owned(), value.into());
        self
    }

    /// A terrain, as a level and in the scenario.
    #[must_use]
    pub fn terrain(self, terrain: Terrain) -> Self {
        self.level("terrain", terrain.name()).set("terrain.slope_deg", terrain.slope_deg())
    }

    /// The goal at a bearing (degrees) and range (m) from the origin.
    #[must_use]
    pub fn goal(self, bearing_deg: f64, range: f64) -> Self {
        let (sin, cos) = bearing_deg.to_radians().sin_cos();
        self.set("teams.0.mission.goal", format_args!("{{x: {}, y: {}}}", range * cos, range * sin))
    }

    /// Reads the scenario in `world`; `changes` come last.
    ///
    /// # Errors
    /// Keys or values that the scenario does not have.
    pub fn cell(self, world: &str, changes: &[String]) -> Result<Cell, ScenarioError> {
        let mut overrides = vec![Override::parse(&format!("world={world}"))?];
        for change in self.changes.iter().chain(changes) {
            overrides.push(Override::parse(change)?);
        }
        let scenario = scenario::parse(self.base.name, self.base.text.as_bytes(), &overrides)?;
        Ok(Cell { key: self.key, scenario, paper: self.paper })
    }
}
