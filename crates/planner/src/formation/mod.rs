//! Slots for any convex load and 3 to 12 robots, and new ones for a team that has lost some.
//!
//! # Source
//! [R2P2] §IV wants places that give large moments (eq. 2), away from the corners, that cage the load (eq. 1e). Here they are
//! searched (`search.rs`) for the largest margin (`grip.rs`).
//!
//! # Deviations
//! - A formation that does not cage the load loses half of its worth per way out. Where the scenario requires caging, or
//!   there are two robots more than edges, a closed cage counts before the margin.
//! - Without the key `caging` a formation found to cage its load is resolved as `required`, another one as `partial`.
//!
//! [R2P2]: cohaul_core::_documentation::references

mod grip;
mod search;

use std::fmt;

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::contact::slope::Slope;
use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::scenario::document::{Caging, CustomSlot, GroundModel, Scenario, Slots};
use cohaul_core::scenario::{self, Problem};
use cohaul_core::transport::formation::{CagingGap, Formation};

pub use grip::Demand;
use grip::{Conditions, Grip};
use search::{Board, CLEAR};

use crate::capacity::{self, Capacity, CapacityError};

/// Robots beyond one per edge from which on a closed cage counts before the margin.
const SPARE: usize = 2;
/// Headings tried on a slope.
const DIRECTIONS: usize = 4;

/// Slots chosen for one team.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The team's id.
    pub team: String,
    /// Places on the edges, counter-clockwise, one per robot.
    pub slots: Vec<CustomSlot>,
    /// Factor by which all that the mission asks of the team could grow, ground friction and weight of the load alike.
    pub margin: f64,
    /// What keeps it from growing further.
    pub limited_by: Demand,
    /// Ways out for the load.
    pub gaps: Vec<CagingGap>,
    /// What the formation is held to.
    pub caging: Caging,
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "team `{}`: {} slots with margin {:.2}, limited by {}",
            self.team,
            self.slots.len(),
            self.margin,
            self.limited_by
        )?;
        for (i, slot) in self.slots.iter().enumerate() {
            writeln!(f, "  robot {}: edge {} at {:.3}", i + 1, slot.edge, slot.at)?;
        }
        match self.gaps.first() {
            None => write!(f, "  the formation cages the load"),
            Some(gap) => write!(f, "  the formation does not cage the load: {gap}"),
        }
    }
}

/// Why no slots can be chosen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormationPlanError {
    /// There is not enough room around the load.
    #[error(
        "team `{team}`: {robots} robots do not fit around the load: there is room for {fit} at a pitch of {pitch:.3} m along \
         edges of {perimeter:.2} m in all, {placement:.3} m away from the corners"
    )]
    Room {
        /// The team's id.
        team: String,
        /// Robots of the team.
        robots: usize,
        /// Robots that fit.
        fit: usize,
        /// Diameter of a robot and the clear distance, m.
        pitch: f64,
        /// Length of all edges, m.
        perimeter: f64,
        /// `contact_placement`, m.
        placement: f64,
    },
    /// No places were found in which the team can do what is asked.
    #[error(
        "team `{team}`: no places were found in which {robots} robots could do all that is asked: {demand} fails for any load"
    )]
    Powerless {
        /// The team's id.
        team: String,
        /// Robots of the team.
        robots: usize,
        /// What fails.
        demand: Demand,
    },
    /// The formation was required to cage the load.
    #[error("team `{team}`: no formation of {robots} robots was found that cages the load; of the best one, {gap}")]
    Caging {
        /// The team's id.
        team: String,
        /// Robots of the team.
        robots: usize,
        /// The first way out.
        gap: CagingGap,
    },
    /// The scenario itself cannot be built.
    #[error(transparent)]
    Scenario(#[from] Problem),
    /// The scenario with its slots is not valid.
    #[error("the slots chosen do not fit into the scenario: {0}")]
    Refused(String),
}

impl FormationPlanError {
    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Room { fit, .. } => {
                format!("use at most {fit} robots, a larger load, or a smaller `contact_placement`")
            }
            Self::Powerless { .. } => {
                "use more robots, more wheel friction or a gentler slope, or list `custom` slots".to_owned()
            }
            Self::Caging { .. } => "use more robots, or write `caging: partial`".to_owned(),
            Self::Scenario(problem) => problem.remedy(),
            Self::Refused(_) => "make room at the start, or list `custom` slots".to_owned(),
        }
    }
}

/// The slots of every team of `scenario` that leaves their choice open (`slots: auto`).
///
/// # Errors
/// Robots that do not fit, can do nothing, or leave a cage open that must be closed.
pub fn choose(scenario: &Scenario) -> Result<Vec<Chosen>, FormationPlanError> {
    let open = |team: &usize| scenario.teams[*team].formation.slots == Slots::Auto;
    (0..scenario.teams.len()).filter(open).map(|team| choose_for(scenario, team)).collect()
}

fn choose_for(scenario: &Scenario, index: usize) -> Result<Chosen, FormationPlanError> {
    let team = &scenario.teams[index];
    let unknown = || Problem::UnknownLoad {
        team: team.id.clone(),
        load: team.load.clone(),
        loads: scenario.loads.iter().map(|load| load.id.clone()).collect(),
    };
    let (place, spec) = scenario.loads.iter().enumerate().find(|(_, load)| load.id == team.load).ok_or_else(unknown)?;
    let path = format!("loads.{place}.shape");
    let load = spec.polygon().map_err(|error| Problem::Shape { path, error })?;
    let model = team.robots.model();
    let robots = team.robots.count;
    let edges = load.vertices().len();
    let formation = &team.formation;
    let caged = match formation.caging {
        Some(caging) => caging == Caging::Required,
        None => robots >= edges + SPARE,
    };
    let board =
        Board { load: &load, placement: formation.contact_placement, gap: formation.gap, radius: model.radius, caged };
    let fit = board.room();
    if robots > fit {
        return Err(FormationPlanError::Room {
            team: team.id.clone(),
            robots,
            fit,
            pitch: 2.0 * model.radius + CLEAR,
            perimeter: (0..edges).map(|i| load.edge(i).length()).sum(),
            placement: formation.contact_placement,
        });
    }
    let terrain = &scenario.terrain;
    let (low, high) = load.bounds();
    let conditions = Conditions {
        surface: surface(terrain.ground, &load),
        half_length: (high.y - low.y) / 2.0,
        reach: load.radius(),
        mass: spec.mass,
        friction: terrain.friction.breakaway.unwrap_or(terrain.friction.dynamic),
        contact_friction: spec.contact_friction,
        wheel_friction: terrain.friction.wheel,
        slope: Slope::new(terrain.slope_deg.to_radians(), terrain.uphill_deg.to_radians()),
        model,
        gap: formation.gap,
    };
    let grip = Grip::new(conditions, DIRECTIONS);
    let powerless = |demand| FormationPlanError::Powerless { team: team.id.clone(), robots, demand };
    let found = board.search(&grip, robots).ok_or_else(|| powerless(Demand::Hold))?;
    if found.margin <= 0.0 {
        return Err(powerless(found.limited_by));
    }
    let slots = found.places.iter().map(|p| board.slot(*p)).collect();
    let gaps = Formation::around(slots, formation.gap, model.radius).caging_gaps(&load);
    let caging = match (formation.caging, gaps.first()) {
        (Some(Caging::Required), Some(gap)) => {
            return Err(FormationPlanError::Caging { team: team.id.clone(), robots, gap: gap.clone() });
        }
        (Some(caging), _) => caging,
        (None, None) => Caging::Required,
        (None, Some(_)) => Caging::Partial,
    };
    let slots = found.places.iter().map(|p| CustomSlot { edge: p.edge, at: p.at }).collect();
    Ok(Chosen { team: team.id.clone(), slots, margin: found.margin, limited_by: found.limited_by, gaps, caging })
}

/// The friction of a footprint as the terrain models it.
pub(crate) fn surface(model: GroundModel, load: &ConvexPolygon) -> LimitSurface {
    match model {
        GroundModel::Exact => LimitSurface::exact(load),
        GroundModel::Ellipsoid => LimitSurface::ellipsoid(load),
    }
}

/// The scenario with slots chosen for every team that leaves them open: from there on they are `custom` slots, and pass the
/// checks of such. A scenario without `slots: auto` comes back as it is.
///
/// # Errors
/// Those of [`choose`], and slots for which the scenario has no room at the start.
pub fn resolve(scenario: &Scenario) -> Result<Scenario, FormationPlanError> {
    Ok(resolve_with(scenario)?.0)
}

/// The same with what was chosen, one entry for every team that left its slots open.
///
/// # Errors
/// Those of [`resolve`].
pub fn resolve_with(scenario: &Scenario) -> Result<(Scenario, Vec<Chosen>), FormationPlanError> {
    let chosen = choose(scenario)?;
    let mut resolved = scenario.clone();
    for choice in &chosen {
        if let Some(team) = resolved.teams.iter_mut().find(|team| team.id == choice.team) {
            team.formation.slots = Slots::Custom(choice.slots.clone());
            team.formation.caging = Some(choice.caging);
        }
    }
    if !chosen.is_empty() {
        let text = resolved.to_yaml().map_err(|error| FormationPlanError::Refused(error.to_string()))?;
        scenario::parse(&resolved.name, text.as_bytes(), &[])
            .map_err(|error| FormationPlanError::Refused(error.message()))?;
    }
    Ok((resolved, chosen))
}

/// Why a team that lost robots cannot go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReformError {
    /// A robot that the team does not have.
    #[error("team `{team}` has no robot {robot}: it has {robots}")]
    NoSuchRobot {
        /// The team's id.
        team: String,
        /// Robot asked for, counted from 1.
        robot: usize,
        /// How many there are.
        robots: usize,
    },
    /// A team that the scenario does not have.
    #[error("there is no team {team}: the scenario has {teams}")]
    NoSuchTeam {
        /// Team asked for, counted from 0.
        team: usize,
        /// How many there are.
        teams: usize,
    },
    /// Too few are left to form anew.
    #[error("team `{team}` has {left} robots left, a formation needs at least {needed}")]
    TooFew {
        /// The team's id.
        team: String,
        /// Robots left.
        left: usize,
        /// Fewest that can form.
        needed: usize,
    },
    /// They find no places.
    #[error(transparent)]
    Formation(#[from] FormationPlanError),
    /// They stand, but the mission is too much for them.
    #[error("team `{}` cannot go on with {} robots: {}", .0.team, .0.robots, .0.explanation)]
    Incapable(Box<Capacity>),
    /// Whether they can is not known.
    #[error(transparent)]
    Capacity(#[from] CapacityError),
}

/// Fewest robots that form anew.
const FEWEST: usize = 3;

/// The scenario of team `team` without the robots at the places `lost` (both from 0): new slots for those that are left, the
/// mission as it was.
///
/// # Errors
/// What keeps the rest from going on, the verdict of [`capacity::assess`] included.
pub fn reform(scenario: &Scenario, team: usize, lost: &[usize]) -> Result<Scenario, ReformError> {
    let mut left = scenario.clone();
    let teams = scenario.teams.len();
    let Some(spec) = left.teams.get_mut(team) else { return Err(ReformError::NoSuchTeam { team, teams }) };
    let robots = spec.robots.count;
    let mut lost = lost.to_vec();
    lost.sort_unstable();
    lost.dedup();
    if let Some(robot) = lost.iter().find(|robot| **robot >= robots) {
        return Err(ReformError::NoSuchRobot { team: spec.id.clone(), robot: robot + 1, robots });
    }
    let count = robots - lost.len();
    if count < FEWEST {
        return Err(ReformError::TooFew { team: spec.id.clone(), left: count, needed: FEWEST });
    }
    spec.robots.count = count;
    if let Some(rates) = &mut spec.robots.rates_hz {
        let mut place = 0;
        rates.retain(|_| {
            place += 1;
            !lost.contains(&(place - 1))
        });
    }
    spec.formation.slots = Slots::Auto;
    if spec.formation.caging == Some(Caging::Required) {
        // it closed a cage with all its robots; those left do what they can
        spec.formation.caging = None;
    }
    let resolved = resolve(&left)?;
    let verdict = capacity::assess_team(&resolved, team)?;
    if verdict.feasible { Ok(resolved) } else { Err(ReformError::Incapable(Box::new(verdict))) }
}
