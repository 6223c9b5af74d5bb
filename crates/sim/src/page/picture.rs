//! A mission as one drawing.

use std::fmt::Write as _;

use super::{Activity, Frame, Kind, Replay, ReplayTeam, RobotFrame, escape};

/// Width of the drawing, pixels.
pub(super) const WIDTH: f64 = 1000.0;
/// Least and greatest height of the map, pixels.
const HEIGHT: [f64; 2] = [320.0, 900.0];
/// Height of the legend below the map, pixels.
pub(super) const LEGEND: f64 = 46.0;
/// Space around what is drawn, m.
const MARGIN: f64 = 0.25;
/// Instants at which a load is drawn, at most.
const INSTANTS_MAX: usize = 8;

const STYLE: &str = "\
text{font:500 13px system-ui,-apple-system,'Segoe UI','Noto Sans','DejaVu Sans',sans-serif;fill:#1c2430}\
.halo{paint-order:stroke;stroke:#fff;stroke-width:4px;stroke-linejoin:round}\
.number{font-weight:650;fill:#fff;text-anchor:middle;dominant-baseline:central}\
.grid{stroke:#edf0f3}.wall{fill:none;stroke:#8a94a2;stroke-width:5}\
.workspace{fill:none;stroke:#5d6878;stroke-width:1.5;stroke-dasharray:2 5}\
.obstacle{fill:#c3cad3;stroke:#8a94a2;stroke-width:1.5;stroke-linejoin:round}\
.plan{fill:none;stroke:#8a94a2;stroke-width:1.6;stroke-dasharray:7 6}\
.trace{fill:none;stroke:#86682c;stroke-width:3;stroke-linejoin:round;stroke-linecap:round}\
.load{fill:#ead9b5;stroke:#86682c;stroke-width:1.8;stroke-linejoin:round}\
.heading{stroke:#86682c;stroke-width:2.2;fill:#86682c}\
.waypoint{fill:#3c4756;fill-opacity:.08;stroke:#3c4756;stroke-width:1.4}\
.ink{stroke:#1c2430;stroke-width:1.8;fill:none}.solid{fill:#1c2430}";

impl Activity {
    const ALL: [Self; 5] = [Self::Push, Self::Prevent, Self::Support, Self::Reposition, Self::Hold];

    const fn color(self) -> &'static str {
        match self {
            Self::Push => "#0072b2",
            Self::Prevent => "#d55e00",
            Self::Support => "#009e73",
            Self::Reposition => "#c765a0",
            Self::Hold => "#6b7482",
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Push => "Push",
            Self::Prevent => "Prevent",
            Self::Support => "Support",
            Self::Reposition => "Repositioning",
            Self::Hold => "Hold",
        }
    }
}

/// An SVG of the whole mission: surroundings, plan, way of the loads, and loads and robots at several instants, later ones
/// stronger.
///
/// At the ends of the mission, where nobody works, the robots have the colours of their first and last roles.
///
/// ```
/// use cohaul_sim::page::{Replay, picture};
///
/// assert!(picture(&Replay::default()).starts_with("<svg"));
/// ```
pub fn picture(replay: &Replay) -> String {
    let frames: Vec<&Frame> = replay.frames.iter().filter(|frame| is_drawable(replay, frame)).collect();
    let mut drawing = Drawing::new(replay, &frames);
    drawing.surroundings(replay);
    for team in &replay.teams {
        drawing.plan(team, &frames);
    }
    let instants = instants(replay, &frames);
    for (order, instant) in instants.iter().enumerate() {
        let opacity = match order {
            0 => 0.5,
            _ if order + 1 == instants.len() => 1.0,
            _ => 0.2 + 0.25 * order as f64 / instants.len() as f64,
        };
        if order + 1 == instants.len() {
            drawing.traces(replay, &frames);
        }
        drawing.instant(replay, &frames, *instant, opacity);
    }
    for team in &replay.teams {
        drawing.waypoints(team, replay.teams.len() > 1);
    }
    drawing.uphill(replay);
    drawing.legend();
    drawing.finish(&replay.title)
}

/// Whether the frame has a finite pose for every body.
fn is_drawable(replay: &Replay, frame: &Frame) -> bool {
    frame.loads.len() == replay.loads.len()
        && frame.robots.len() == replay.robots.len()
        && frame.loads.iter().chain(frame.robots.iter().map(|r| &r.pose)).flatten().all(|v| v.is_finite())
}

/// Frames to draw: the first, the last, and between them one whenever the loads have moved on by most of their size.
fn instants(replay: &Replay, frames: &[&Frame]) -> Vec<usize> {
    let size = replay.loads.iter().map(|l| radius(&l.polygon)).fold(0.2, f64::max);
    let mut moved = vec![0.0];
    for pair in frames.windows(2) {
        let step: f64 = pair[0]
            .loads
            .iter()
            .zip(&pair[1].loads)
            .map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1]) + 0.3 * size * (b[2] - a[2]).sin().abs())
            .fold(0.0, f64::max);
        moved.push(moved[moved.len() - 1] + step);
    }
    let Some(last) = frames.len().checked_sub(1) else {
        return Vec::new();
    };
    let parts = ((moved[last] / (1.1 * size)) as usize).clamp(1, INSTANTS_MAX - 1);
    let mut chosen: Vec<usize> = (0..parts)
        .map(|part| moved.partition_point(|m| *m < moved[last] * part as f64 / parts as f64).min(last))
        .collect();
    chosen.push(last);
    chosen.dedup();
    chosen
}

fn radius(polygon: &[[f64; 2]]) -> f64 {
    polygon.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max)
}

/// The SVG as it grows.
pub(super) struct Drawing {
    body: String,
    /// Lowest x and highest y, m.
    origin: [f64; 2],
    /// Pixels per metre.
    pub(super) scale: f64,
    /// Of the map, pixels.
    pub(super) height: f64,
}

impl Drawing {
    pub(super) fn new(replay: &Replay, frames: &[&Frame]) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let mut add = |x: f64, y: f64, margin: f64| {
            if x.is_finite() && y.is_finite() {
                low = [low[0].min(x - margin), low[1].min(y - margin)];
                high = [high[0].max(x + margin), high[1].max(y + margin)];
            }
        };
        for frame in frames {
            for (pose, load) in frame.loads.iter().zip(&replay.loads) {
                add(pose[0], pose[1], radius(&load.polygon));
            }
            for (robot, body) in frame.robots.iter().zip(&replay.robots) {
                add(robot.pose[0], robot.pose[1], body.radius);
            }
        }
        replay.teams.iter().for_each(|t| t.waypoints.iter().for_each(|[x, y]| add(*x, *y, t.tolerance.max(0.2))));
        replay.obstacles.iter().flatten().for_each(|[x, y]| add(*x, *y, 0.0));
        let goals = replay.robots.iter().filter_map(|robot| Some((robot.goal?, robot.radius)));
        goals.for_each(|(goal, radius)| add(goal[0], goal[1], radius));
        let map = if replay.kind == Kind::Plan { replay.workspace } else { None };
        for [x0, y0, x1, y1] in [replay.walls, map].into_iter().flatten() {
            add(x0, y0, 0.0);
            add(x1, y1, 0.0);
        }
        if low[0] > high[0] {
            (low, high) = ([-1.0; 2], [1.0; 2]);
        }
        let size = [high[0] - low[0] + 2.0 * MARGIN, high[1] - low[1] + 2.0 * MARGIN];
        let height = (WIDTH * size[1] / size[0]).clamp(HEIGHT[0], HEIGHT[1]);
        let scale = (WIDTH / size[0]).min(height / size[1]);
        let origin = [(low[0] + high[0]) / 2.0 - WIDTH / scale / 2.0, (low[1] + high[1]) / 2.0 + height / scale / 2.0];
        Self { body: String::new(), origin, scale, height }
    }

    pub(super) fn put(&mut self, arguments: std::fmt::Arguments<'_>) {
        // writing into a string does not fail
        let _ = self.body.write_fmt(arguments);
        self.body.push('\n');
    }

    pub(super) fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.origin[0]) * self.scale, (self.origin[1] - y) * self.scale]
    }

    pub(super) fn points(&self, points: impl IntoIterator<Item = [f64; 2]>) -> String {
        let mut text = String::new();
        for point in points {
            let [x, y] = self.pixel(point);
            let _ = write!(text, "{x:.1},{y:.1} ");
        }
        text.trim_end().to_owned()
    }

    pub(super) fn surroundings(&mut self, replay: &Replay) {
        let height = self.height;
        let step = round_length(110.0 / self.scale);
        let (columns, rows) = (WIDTH / self.scale / step, self.height / self.scale / step);
        let first = [(self.origin[0] / step).ceil() * step, (self.origin[1] / step).floor() * step];
        for k in 0..=columns as usize {
            let x = self.pixel([first[0] + k as f64 * step, 0.0])[0];
            self.put(format_args!("<path class=\"grid\" d=\"M{x:.1} 0V{height:.1}\"/>"));
        }
        for k in 0..=rows as usize {
            let y = self.pixel([0.0, first[1] - k as f64 * step])[1];
            self.put(format_args!("<path class=\"grid\" d=\"M0 {y:.1}H{WIDTH}\"/>"));
        }
        for (class, rectangle) in [("workspace", replay.workspace), ("wall", replay.walls)] {
            if let Some([x0, y0, x1, y1]) = rectangle {
                let points = self.points([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
                self.put(format_args!("<polygon class=\"{class}\" points=\"{points}\"/>"));
            }
        }
        for corners in &replay.obstacles {
            let points = self.points(corners.iter().copied());
            self.put(format_args!("<polygon class=\"obstacle\" points=\"{points}\"/>"));
        }
    }

    fn plan(&mut self, team: &ReplayTeam, frames: &[&Frame]) {
        let start = frames.first().and_then(|f| f.loads.get(team.load)).map(|pose| [pose[0], pose[1]]);
        let points = if team.path.is_empty() {
            self.points(start.into_iter().chain(team.waypoints.iter().copied()))
        } else {
            self.points(team.path.iter().copied())
        };
        self.put(format_args!("<polyline class=\"plan\" points=\"{points}\"/>"));
    }

    fn traces(&mut self, replay: &Replay, frames: &[&Frame]) {
        for load in 0..replay.loads.len() {
            let mut kept: Vec<[f64; 2]> = Vec::new();
            for frame in frames {
                let [x, y, _] = frame.loads[load];
                // two pixels apart
                if kept.last().is_none_or(|[u, v]| (x - u).hypot(y - v) * self.scale > 2.0) {
                    kept.push([x, y]);
                }
            }
            let points = self.points(kept);
            self.put(format_args!("<polyline class=\"trace\" points=\"{points}\"/>"));
        }
    }

    fn waypoints(&mut self, team: &ReplayTeam, is_named: bool) {
        for (index, waypoint) in team.waypoints.iter().enumerate() {
            let [x, y] = self.pixel(*waypoint);
            let is_goal = index + 1 == team.waypoints.len();
            let ring = team.tolerance * self.scale;
            let dash = if is_goal { "" } else { " stroke-dasharray=\"4 3\"" };
            self.put(format_args!("<circle class=\"waypoint\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{ring:.1}\"{dash}/>"));
            if is_goal {
                self.put(format_args!("<path class=\"ink\" d=\"M{x:.1} {y:.1}v-22\"/>"));
                self.put(format_args!("<path class=\"solid\" d=\"M{x:.1} {:.1}l15 5-15 5z\"/>", y - 22.0));
            } else {
                self.put(format_args!("<circle class=\"solid\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>"));
            }
            let name = if is_goal { "goal".to_owned() } else { (index + 1).to_string() };
            let name = if is_named { format!("{} {name}", escape(&team.id)) } else { name };
            let (x, y) = (x + ring + 5.0, y + ring + 8.0);
            self.put(format_args!("<text class=\"halo\" x=\"{x:.1}\" y=\"{y:.1}\">{name}</text>"));
        }
    }

    /// Loads and robots in one frame.
    fn instant(&mut self, replay: &Replay, frames: &[&Frame], index: usize, opacity: f64) {
        self.put(format_args!("<g opacity=\"{opacity:.2}\">"));
        for (load, pose) in replay.loads.iter().zip(&frames[index].loads) {
            let points = self.points(load.polygon.iter().map(|corner| place(pose, *corner)));
            self.put(format_args!("<polygon class=\"load\" points=\"{points}\"/>"));
            let reach = 0.5 * radius(&load.polygon);
            let [x, y] = self.pixel([pose[0], pose[1]]);
            let (length, turn) = (reach * self.scale, -pose[2].to_degrees());
            self.put(format_args!(
                "<g class=\"heading\" transform=\"translate({x:.1} {y:.1}) rotate({turn:.2})\"><circle r=\"3\" stroke=\"none\"/>\
                 <path d=\"M0 0H{:.1}\"/><path stroke=\"none\" d=\"M{length:.1} 0l-10-5v10z\"/></g>",
                length - 8.0
            ));
        }
        for (number, body) in replay.robots.iter().enumerate() {
            let pose = frames[index].robots[number].pose;
            let color = activity(frames, index, number).color();
            let [x, y] = self.pixel([pose[0], pose[1]]);
            let size = (body.radius * self.scale).max(4.0);
            let turn = -pose[2].to_degrees();
            self.put(format_args!(
                "<g transform=\"translate({x:.1} {y:.1})\" fill=\"{color}\"><path d=\"M{:.1} {:.1}L{:.1} 0L{:.1} {:.1}z\" \
                 transform=\"rotate({turn:.2})\"/><circle r=\"{size:.1}\" stroke=\"#fff\" stroke-width=\"1.5\"/>",
                0.8 * size,
                -0.57 * size,
                1.5 * size,
                0.8 * size,
                0.57 * size,
            ));
            if size >= 7.0 && opacity >= 0.5 {
                let font = (0.95 * size).min(16.0) * if number > 8 { 0.8 } else { 1.0 };
                self.put(format_args!("<text class=\"number\" style=\"font-size:{font:.1}px\">{}</text>", number + 1));
            }
            self.put(format_args!("</g>"));
        }
        self.put(format_args!("</g>"));
    }

    fn uphill(&mut self, replay: &Replay) {
        if !replay.slope_deg.is_normal() || !replay.uphill_deg.is_finite() {
            return;
        }
        // a negative slope rises the other way
        let turn = if replay.slope_deg < 0.0 { 180.0 - replay.uphill_deg } else { -replay.uphill_deg };
        let x = WIDTH - 62.0;
        self.put(format_args!(
            "<rect x=\"{:.0}\" y=\"18\" width=\"88\" height=\"84\" rx=\"8\" fill=\"#fff\" stroke=\"#d9dee5\"/>\
             <g transform=\"translate({x:.0} 50) rotate({turn:.2})\"><path class=\"ink\" stroke-width=\"2.4\" d=\"M-22 0H14\"/>\
             <path class=\"solid\" d=\"M24 0l-12-6v12z\"/></g>\
             <text x=\"{x:.0}\" y=\"93\" text-anchor=\"middle\">uphill {}°</text>",
            x - 44.0,
            (replay.slope_deg.abs() * 10.0).round() / 10.0
        ));
    }

    fn legend(&mut self) {
        let height = self.height;
        let y = height + LEGEND / 2.0;
        self.put(format_args!(
            "<rect y=\"{height:.1}\" width=\"{WIDTH}\" height=\"{LEGEND}\" fill=\"#fff\"/>\
             <path stroke=\"#d9dee5\" d=\"M0 {height:.1}H{WIDTH}\"/>"
        ));
        let mut x = 26.0;
        for activity in Activity::ALL {
            let (color, name) = (activity.color(), activity.name());
            self.put(format_args!(
                "<g transform=\"translate({x:.0} {y:.1})\" fill=\"{color}\"><path d=\"M5.5-4.5L11.5 0 5.5 4.5z\"/><circle r=\"7\"/></g>\
                 <text x=\"{:.0}\" y=\"{y:.1}\" dominant-baseline=\"central\">{name}</text>",
                x + 17.0
            ));
            x += 50.0 + 7.6 * name.len() as f64;
        }
        for (class, name) in [("trace", "Way of the load"), ("plan", "Plan")] {
            self.put(format_args!(
                "<path class=\"{class}\" d=\"M{:.0} {y:.1}h28\"/><text x=\"{:.0}\" y=\"{y:.1}\" dominant-baseline=\"central\">{name}</text>",
                x - 8.0,
                x + 28.0
            ));
            x += 60.0 + 7.6 * name.len() as f64;
        }
        self.scale_bar(y, "m");
    }

    /// At the right end of the legend, whose middle is at `y`.
    pub(super) fn scale_bar(&mut self, y: f64, unit: &str) {
        let length = round_length(70.0 / self.scale);
        let bar = length * self.scale;
        let name = if length < 1.0 && unit == "m" {
            format!("{:.0} cm", length * 100.0)
        } else {
            format!("{length} {}", if length == 1.0 { unit.trim_end_matches('s') } else { unit })
        };
        self.put(format_args!(
            "<path class=\"ink\" d=\"M{:.1} {:.1}v5h{bar:.1}v-5\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{name}</text>",
            WIDTH - 22.0 - bar,
            y + 6.0,
            WIDTH - 22.0 - bar / 2.0,
            y + 4.0
        ));
    }

    pub(super) fn finish(self, title: &str) -> String {
        let height = self.height + LEGEND;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\">\n<title>{}</title>\n\
             <style>{STYLE}</style>\n\
             <clipPath id=\"card\"><rect width=\"{WIDTH}\" height=\"{height:.0}\" rx=\"12\"/></clipPath>\n\
             <g clip-path=\"url(#card)\">\n<rect width=\"{WIDTH}\" height=\"{height:.0}\" fill=\"#fff\"/>\n{}</g>\n</svg>\n",
            escape(title),
            self.body
        )
    }
}

/// What a robot is shown as; where nobody works, its last role before or its first one after.
fn activity(frames: &[&Frame], index: usize, robot: usize) -> Activity {
    let now = Activity::of(&frames[index].robots[robot]);
    if now != Activity::Hold || (index != 0 && index + 1 != frames.len()) {
        return now;
    }
    let working = |frame: &&Frame| Some(Activity::of(&frame.robots[robot])).filter(|a| *a != Activity::Hold);
    let found = if index == 0 { frames.iter().find_map(working) } else { frames.iter().rev().find_map(working) };
    found.unwrap_or_else(|| {
        // nobody ever worked: the role alone
        Activity::of(&RobotFrame { phase: cohaul_core::control::Phase::Work, ..frames[index].robots[robot] })
    })
}

/// A point of a body's frame in the world, m.
pub(super) fn place(pose: &[f64; 3], [x, y]: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = pose[2].sin_cos();
    [pose[0] + cosine * x - sine * y, pose[1] + sine * x + cosine * y]
}

/// The shortest of 1, 2 and 5 times a power of ten that is at least `least`, m.
fn round_length(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|length| *length >= least * 0.999).unwrap_or(power)
}
