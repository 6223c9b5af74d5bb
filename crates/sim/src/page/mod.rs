//! A mission or a plan as one self-contained HTML page, and as a picture.
//!
//! [`Replay`] is plain data: whoever ran the mission fills it in, [`render`] makes the page that plays it in a browser and
//! [`picture`](fn@picture) the drawing. Both are pure functions; the same replay gives the same bytes. [`plan_page`] and
//! [`plan_picture`](fn@plan_picture) do the same with a plan and what a certifier says of it.
//!
//! The page loads nothing from anywhere and its content security policy forbids that it does. It offers `window.cohaul`
//! with `state()`, `seek(time)`, `play()` and `pause()` to those who embed it.

mod encode;
mod picture;
mod plan;
mod plan_picture;

use cohaul_core::control::Phase;
use cohaul_core::transport::primitive::Primitive;
use cohaul_core::transport::role::Role;
use serde_json::{Value, json};

pub use picture::picture;
pub use plan::{Planned, plan_page, plan_picture};

/// Everything the page shows of one mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replay {
    /// What it is.
    pub kind: Kind,
    /// Name of the mission.
    pub title: String,
    /// What the mission shows.
    pub description: String,
    /// Version of the program that ran it.
    pub version: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Which simulator ran it.
    pub world: String,
    /// Inclination of the ground, degrees.
    pub slope_deg: f64,
    /// Direction of steepest ascent, degrees from the x axis.
    pub uphill_deg: f64,
    /// Fixed obstacles: corners in the world, m.
    pub obstacles: Vec<Vec<[f64; 2]>>,
    /// Solid walls around [x_min, y_min, x_max, y_max], m.
    pub walls: Option<[f64; 4]>,
    /// Rectangle [x_min, y_min, x_max, y_max] that the loads must stay in, m.
    pub workspace: Option<[f64; 4]>,
    /// What is moved.
    pub loads: Vec<ReplayLoad>,
    /// Who moves it.
    pub robots: Vec<ReplayRobot>,
    /// Who moves what where.
    pub teams: Vec<ReplayTeam>,
    /// What happened, in the order of time; thinned out by [`render`] where there are too many.
    pub frames: Vec<Frame>,
    /// What is worth a mark on the time line.
    pub events: Vec<ReplayEvent>,
    /// What is wrong, in the order of time.
    pub conflicts: Vec<ReplayConflict>,
    /// Rows of the table of results: label and value.
    pub outcome: Vec<(String, String)>,
    /// Whether the mission succeeded.
    pub success: bool,
}

/// What a page shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Robots that move loads; time in seconds.
    #[default]
    Mission,
    /// A plan for many agents; time in steps. Robots have a colour each, and neither role nor speed.
    Plan,
}

/// Something wrong with a plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayConflict {
    /// When, in steps.
    pub time: f64,
    /// What kind of thing.
    pub kind: String,
    /// Indices of the robots concerned.
    pub robots: Vec<usize>,
    /// What exactly.
    pub text: String,
}

/// A load of the mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayLoad {
    /// Name.
    pub id: String,
    /// Corners in the load's frame, m; its heading is the x axis.
    pub polygon: Vec<[f64; 2]>,
}

/// A robot of the mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayRobot {
    /// Name.
    pub name: String,
    /// Index of its team.
    pub team: usize,
    /// Radius of its body, m.
    pub radius: f64,
    /// Pose [x, y, yaw] of its slot in the frame of its team's load, m and rad.
    pub slot: Option<[f64; 3]>,
    /// Corners of its body in its own frame, m; a disc if there are none.
    pub polygon: Vec<[f64; 2]>,
    /// Where it goes if that is its own matter, [x, y, yaw], m and rad.
    pub goal: Option<[f64; 3]>,
}

/// A team of the mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayTeam {
    /// Name.
    pub id: String,
    /// Index of its load.
    pub load: usize,
    /// Indices of its robots.
    pub robots: Vec<usize>,
    /// Points that the load's centre passes, the goal last, m.
    pub waypoints: Vec<[f64; 2]>,
    /// Distance at which a waypoint counts as reached, m.
    pub tolerance: f64,
    /// Planned path of the load's centre, m; if it is empty, straight lines through the waypoints are drawn.
    pub path: Vec<[f64; 2]>,
}

/// One instant of the mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// s.
    pub time: f64,
    /// Pose [x, y, yaw] of every load, m and rad.
    pub loads: Vec<[f64; 3]>,
    /// Every robot.
    pub robots: Vec<RobotFrame>,
    /// Every team.
    pub teams: Vec<TeamFrame>,
}

/// One robot at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RobotFrame {
    /// Pose [x, y, yaw], m and rad.
    pub pose: [f64; 3],
    /// Commanded forward speed, m/s, and yaw rate, rad/s.
    pub command: [f64; 2],
    /// Forward speed of the robot, m/s.
    pub speed: f64,
    /// Its role, if it has one.
    pub role: Option<Role>,
    /// Where it stands in its cycle.
    pub phase: Phase,
    /// Whether its stop flag is up.
    pub stop: bool,
}

/// One team at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TeamFrame {
    /// Motion of the load it works for.
    pub primitive: Option<Primitive>,
    /// Bearing of the waypoint minus the load's heading, rad.
    pub heading_error: f64,
    /// Distance of the load's centre from the waypoint, m.
    pub distance: f64,
    /// Index of the waypoint; the goal is the last.
    pub waypoint: usize,
}

/// Something worth a mark on the time line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplayEvent {
    /// s.
    pub time: f64,
    /// What happened.
    pub text: String,
}

const TEMPLATE: &str = include_str!("template.html");
const STYLE: &str = include_str!("style.css");
/// In this order they form one script.
const SCRIPTS: [&str; 5] = [
    include_str!("mission.js"),
    include_str!("stage.js"),
    include_str!("plots.js"),
    include_str!("plan.js"),
    include_str!("player.js"),
];

/// The complete HTML document that plays `replay`.
///
/// Poses keep 0.05 mm and 0.05 mrad; frames are thinned out to at most 20 per second, fewer in long missions of many
/// robots, and the first and the last frame always stay.
///
/// ```
/// use cohaul_sim::page::{Replay, render};
///
/// let replay = Replay { title: "</script>".into(), ..Replay::default() };
/// let html = render(&replay);
/// assert!(html.starts_with("<!doctype html>"));
/// assert!(html.contains("<title>&lt;/script&gt;"));
/// ```
pub fn render(replay: &Replay) -> String {
    let script = SCRIPTS.concat();
    let title = escape(&replay.title);
    let data = json_in_html(&document(replay));
    fill(TEMPLATE, |key| match key {
        "title" => &title,
        "style" => STYLE,
        "data" => &data,
        "script" => &script,
        _ => "",
    })
}

/// What the script reads.
fn document(replay: &Replay) -> Value {
    let loads: Vec<Value> = replay.loads.iter().map(|l| json!({"id": l.id, "polygon": l.polygon})).collect();
    let robots: Vec<Value> = replay
        .robots
        .iter()
        .map(|r| {
            json!({
                "name": r.name, "team": r.team, "radius": r.radius, "slot": r.slot, "polygon": r.polygon, "goal": r.goal,
            })
        })
        .collect();
    let teams: Vec<Value> = replay
        .teams
        .iter()
        .map(|t| {
            json!({
                "id": t.id, "load": t.load, "robots": t.robots, "waypoints": t.waypoints, "tolerance": t.tolerance,
                "path": t.path,
            })
        })
        .collect();
    let events: Vec<Value> = replay
        .events
        .iter()
        .filter(|event| event.time.is_finite())
        .map(|event| json!([event.time, event.text]))
        .collect();
    let conflicts: Vec<Value> = replay
        .conflicts
        .iter()
        .filter(|conflict| conflict.time.is_finite())
        .map(|c| json!({"time": c.time, "kind": c.kind, "robots": c.robots, "text": c.text}))
        .collect();
    json!({
        "kind": match replay.kind {
            Kind::Mission => "mission",
            Kind::Plan => "plan",
        },
        "title": replay.title,
        "description": replay.description,
        "version": replay.version,
        // a number above 2^53 would lose digits in JavaScript
        "seed": replay.seed.to_string(),
        "world": replay.world,
        "slope_deg": replay.slope_deg,
        "uphill_deg": replay.uphill_deg,
        "obstacles": replay.obstacles,
        "walls": replay.walls,
        "workspace": replay.workspace,
        "loads": loads,
        "robots": robots,
        "teams": teams,
        "events": events,
        "conflicts": conflicts,
        "outcome": replay.outcome,
        "success": replay.success,
        "roles": Role::ALL,
        "phases": Phase::ALL,
        "repositioning": Phase::ALL.map(Phase::is_repositioning),
        "frames": encode::frames(replay),
    })
}

/// JSON that may stand inside a script element: no `<`, so neither `</script` nor `<!--`.
fn json_in_html(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

/// Text that may stand in HTML or SVG, in an element or in a quoted attribute.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // characters that XML does not allow at all
            '\u{0}'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {
                escaped.push('\u{fffd}');
            }
            _ => escaped.push(character),
        }
    }
    escaped
}

/// Puts the value of `key` in the place of each `{{key}}`, in one pass: what is put in is never looked at again.
fn fill<'a>(template: &'a str, value: impl Fn(&str) -> &'a str) -> String {
    let mut filled = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        let Some((key, after)) = after.split_once("}}") else { break };
        filled.push_str(before);
        filled.push_str(value(key));
        rest = after;
    }
    filled.push_str(rest);
    filled
}

/// What a robot is shown as: its role while it works, else what it does instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Activity {
    Push,
    Prevent,
    Support,
    Reposition,
    Hold,
}

impl Activity {
    fn of(robot: &RobotFrame) -> Self {
        if robot.phase.is_repositioning() {
            return Self::Reposition;
        }
        match (robot.phase, robot.role) {
            (Phase::Work, Some(Role::Push)) => Self::Push,
            (Phase::Work, Some(Role::Prevent)) => Self::Prevent,
            (Phase::Work, Some(Role::Support)) => Self::Support,
            _ => Self::Hold,
        }
    }
}

#[cfg(test)]
mod tests;
