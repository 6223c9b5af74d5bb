//! A plan as one drawing.

use std::fmt::Write as _;

use super::picture::{Drawing, LEGEND, WIDTH, place};
use super::{Frame, Replay, ReplayConflict, escape};

const STYLE: &str = "\
.way{fill:none;stroke-linejoin:round;stroke-linecap:round;opacity:.75}\
.body{stroke:#fff;stroke-width:1}.nose{fill:none;stroke:#fff;stroke-width:1.6}\
.goal{fill:none;stroke-dasharray:4 2.5}\
.conflict{fill:#d4111c;fill-opacity:.25;stroke:#d4111c;stroke-width:2}\
.ring{fill:none;stroke:#d4111c;stroke-width:2.5}.wrong{fill:#d4111c;font-weight:650}";

/// Violations that are marked.
const MARKS_MAX: usize = 20;

/// The drawing of a plan. See [`plan_picture`](super::plan_picture).
pub(super) fn picture(replay: &Replay) -> String {
    let frames: Vec<&Frame> = replay.frames.iter().collect();
    let mut drawing = Drawing::new(replay, &frames);
    drawing.put(format_args!("<style>{STYLE}</style>"));
    drawing.surroundings(replay);
    // thin enough to tell neighbours apart
    let thickness = replay.robots.iter().map(|robot| robot.radius).fold(1.0, f64::max) * drawing.scale * 0.18;
    let thickness = thickness.clamp(0.8, 3.0);
    for number in 0..replay.robots.len() {
        way(&mut drawing, replay, number, thickness);
    }
    for (number, robot) in replay.robots.iter().enumerate() {
        if let Some(goal) = robot.goal {
            let points = drawing.points(robot.polygon.iter().map(|corner| place(&goal, *corner)));
            let color = color(number);
            drawing.put(format_args!(
                "<polygon class=\"goal\" stroke=\"{color}\" stroke-width=\"{:.1}\" points=\"{points}\"/>",
                thickness.max(1.0)
            ));
        }
        if let Some(start) = replay.frames.first().and_then(|frame| frame.robots.get(number)) {
            body(&mut drawing, replay, number, start.pose);
        }
    }
    for conflict in replay.conflicts.iter().take(MARKS_MAX) {
        mark(&mut drawing, replay, conflict);
    }
    legend(&mut drawing, replay);
    drawing.finish(&replay.title)
}

/// Where a robot goes, corner by corner of its way.
fn way(drawing: &mut Drawing, replay: &Replay, number: usize, thickness: f64) {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for frame in &replay.frames {
        let Some([x, y, _]) = frame.robots.get(number).map(|robot| robot.pose) else { continue };
        if !(x.is_finite() && y.is_finite()) || kept.last() == Some(&[x, y]) {
            continue;
        }
        // a point on a straight way says nothing
        if let [.., a, b] = kept[..]
            && ((b[0] - a[0]) * (y - b[1]) - (b[1] - a[1]) * (x - b[0])).abs() < 1e-9
            && (b[0] - a[0]) * (x - b[0]) + (b[1] - a[1]) * (y - b[1]) > 0.0
        {
            kept.pop();
        }
        kept.push([x, y]);
    }
    let (points, color) = (drawing.points(kept), color(number));
    drawing.put(format_args!(
        "<polyline class=\"way\" stroke=\"{color}\" stroke-width=\"{thickness:.1}\" points=\"{points}\"/>"
    ));
}

/// A body with a line across where it is in front.
fn body(drawing: &mut Drawing, replay: &Replay, number: usize, pose: [f64; 3]) {
    if !pose.iter().all(|value| value.is_finite()) {
        return;
    }
    let robot = &replay.robots[number];
    let points = drawing.points(robot.polygon.iter().map(|corner| place(&pose, *corner)));
    let color = color(number);
    drawing.put(format_args!(
        "<polygon class=\"body\" fill=\"{color}\" points=\"{points}\"><title>{}</title></polygon>",
        escape(&robot.name)
    ));
    let front = robot.polygon.iter().map(|corner| corner[0]).fold(0.0, f64::max);
    let side = robot.polygon.iter().map(|corner| corner[1]).fold(0.0, f64::max);
    if replay.world != "grid" && side * drawing.scale > 3.0 {
        let nose = [[0.45 * front, -0.75 * side], [0.9 * front, 0.0], [0.45 * front, 0.75 * side]];
        let points = drawing.points(nose.map(|corner| place(&pose, corner)));
        drawing.put(format_args!("<polyline class=\"nose\" points=\"{points}\"/>"));
    }
}

/// The bodies concerned when it happens, with a ring around them.
fn mark(drawing: &mut Drawing, replay: &Replay, conflict: &ReplayConflict) {
    let at = replay.frames.partition_point(|frame| frame.time <= conflict.time).saturating_sub(1);
    let Some(frame) = replay.frames.get(at) else { return };
    let share = match replay.frames.get(at + 1) {
        Some(next) => ((conflict.time - frame.time) / (next.time - frame.time)).clamp(0.0, 1.0),
        None => 0.0,
    };
    let mut reached = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for number in &conflict.robots {
        let (Some(robot), Some(state)) = (replay.robots.get(*number), frame.robots.get(*number)) else { continue };
        let next = replay.frames.get(at + 1).and_then(|next| next.robots.get(*number)).unwrap_or(state).pose;
        let turn = cohaul_core::se2::wrap_angle(next[2] - state.pose[2]);
        let moved = [next[0] - state.pose[0], next[1] - state.pose[1], turn];
        let pose = [0, 1, 2].map(|k| state.pose[k] + share * moved[k]);
        if !pose.iter().all(|value| value.is_finite()) {
            continue;
        }
        let points = drawing.points(robot.polygon.iter().map(|corner| place(&pose, *corner)));
        drawing.put(format_args!("<polygon class=\"conflict\" points=\"{points}\"/>"));
        let [x, y] = drawing.pixel([pose[0], pose[1]]);
        reached = [reached[0].min(x), reached[1].min(y), reached[2].max(x), reached[3].max(y)];
    }
    if reached[0] <= reached[2] {
        let radius = replay.robots.first().map_or(0.0, |robot| robot.radius) * drawing.scale;
        let [x, y] = [(reached[0] + reached[2]) / 2.0, (reached[1] + reached[3]) / 2.0];
        let ring = 0.5 * (reached[2] - reached[0]).hypot(reached[3] - reached[1]) + radius + 6.0;
        drawing.put(format_args!(
            "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{ring:.1}\"><title>step {:.2}: {}</title></circle>",
            conflict.time,
            escape(&conflict.text)
        ));
    }
}

fn legend(drawing: &mut Drawing, replay: &Replay) {
    let height = drawing.height;
    let y = height + LEGEND / 2.0;
    drawing.put(format_args!(
        "<rect y=\"{height:.1}\" width=\"{WIDTH}\" height=\"{LEGEND}\" fill=\"#fff\"/>\
         <path stroke=\"#d9dee5\" d=\"M0 {height:.1}H{WIDTH}\"/>"
    ));
    let color = color(0);
    let mut x = 22.0;
    let symbols = [
        (format!("<rect x=\"0\" y=\"-6\" width=\"16\" height=\"12\" fill=\"{color}\"/>"), "Start"),
        (format!("<path class=\"way\" stroke=\"{color}\" stroke-width=\"2\" d=\"M-4 0h24\"/>"), "Way"),
        (
            format!(
                "<rect class=\"goal\" x=\"0\" y=\"-6\" width=\"16\" height=\"12\" stroke=\"{color}\" stroke-width=\"1.5\"/>"
            ),
            "Goal",
        ),
    ];
    for (symbol, name) in symbols {
        drawing.put(format_args!(
            "<g transform=\"translate({x:.0} {y:.1})\">{symbol}<text x=\"26\" dominant-baseline=\"central\">{name}</text></g>"
        ));
        x += 56.0 + 7.6 * name.len() as f64;
    }
    let mut verdict = String::new();
    let class = match replay.conflicts.len() {
        0 => {
            verdict.push_str("certified");
            ""
        }
        number => {
            // writing into a string does not fail
            let _ = write!(verdict, "{number} {}", if number == 1 { "violation" } else { "violations" });
            " class=\"wrong\""
        }
    };
    let facts: Vec<String> = replay
        .outcome
        .iter()
        .take(3)
        .map(|(name, value)| format!("{} {}", name.to_lowercase(), escape(value)))
        .collect();
    let facts = format!("{} · {}", escape(&replay.description), facts.join(" · "));
    drawing.put(format_args!(
        "<text x=\"{x:.0}\" y=\"{y:.1}\" dominant-baseline=\"central\"><tspan{class}>{verdict}</tspan> · {facts}</text>"
    ));
    drawing.scale_bar(y, if replay.world == "grid" { "cells" } else { "m" });
}

/// The colour of a body, as the page has it: hues that lie far apart for neighbours in number, none of them the red of
/// conflicts.
fn color(number: usize) -> String {
    // golden section of the hues from 25° to 335°
    let hue = 25.0 + 310.0 * (0.58 + 0.618_033_988_75 * number as f64).fract();
    let (saturation, lightness) = (0.62, 0.42_f64);
    let strength = saturation * lightness.min(1.0 - lightness);
    let channel = |offset: f64| {
        let k = (offset + hue / 30.0) % 12.0;
        let value = lightness - strength * (k - 3.0).min(9.0 - k).clamp(-1.0, 1.0);
        (value * 255.0).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", channel(0.0), channel(8.0), channel(4.0))
}
