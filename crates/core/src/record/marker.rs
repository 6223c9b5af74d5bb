//! Shapes for `/cohaul/markers`.

use nalgebra::Vector2;

use super::cdr::Encoder;
use super::message::Message as _;
use super::message::standard;
use crate::id::{LoadId, RobotId};
use crate::se2::Pose2;
use crate::time::Time;
use crate::transport::role::Role;

/// Height at which outlines and waypoints are drawn, m: above the floor grid of a viewer.
const LIFT: f64 = 0.01;
/// Height of the cylinder that stands for a robot, m.
const ROBOT_HEIGHT: f64 = 0.19;
/// Width of an outline, m.
const LINE_WIDTH: f64 = 0.02;

/// One shape in the frame `map`. Drawing the same one again moves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Marker<'a> {
    /// Outline of a load.
    Load {
        /// Which load.
        load: LoadId,
        /// Its pose.
        world_from_load: Pose2,
        /// Its corners in its own frame, m, in order; the outline closes itself.
        outline_in_load: &'a [Vector2<f64>],
    },
    /// A robot, coloured by role.
    Robot {
        /// Which robot.
        robot: RobotId,
        /// Its pose.
        world_from_robot: Pose2,
        /// Radius of its body, m.
        radius: f64,
        /// Its role: push is green, prevent red, support blue, none grey.
        role: Option<Role>,
    },
    /// A waypoint.
    Waypoint {
        /// Its number.
        index: u16,
        /// Where, in the world, m.
        position: Vector2<f64>,
        /// Radius of the disc around it that counts as reached, m.
        radius: f64,
    },
}

/// Colours, by red, green, blue, opacity. The hues stay apart for colour-blind readers.
const fn color(role: Option<Role>) -> [f32; 4] {
    match role {
        Some(Role::Push) => [0.0, 0.62, 0.45, 1.0],
        Some(Role::Prevent) => [0.84, 0.37, 0.0, 1.0],
        Some(Role::Support) => [0.0, 0.45, 0.7, 1.0],
        None => [0.6, 0.6, 0.6, 1.0],
    }
}

/// Appends the fields of a MarkerArray of `markers`.
pub(super) fn encode(time: Time, markers: &[Marker<'_>], out: &mut Encoder<'_>) {
    let header = standard::Header { stamp: time.into(), frame_id: super::writer::MAP };
    out.sequence(markers.len());
    for marker in markers {
        standard(header, marker).encode(out);
    }
}

fn standard<'a>(header: standard::Header<'a>, marker: &Marker<'_>) -> standard::Marker<'a> {
    let at = |pose: &Pose2, z: f64| [pose.translation.x, pose.translation.y, z];
    let blank = standard::Marker { header, orientation: [0.0, 0.0, 0.0, 1.0], ..Default::default() };
    match marker {
        Marker::Load { load, world_from_load, outline_in_load } => standard::Marker {
            ns: "load",
            id: i32::from(load.0),
            kind: standard::Marker::LINE_STRIP,
            position: at(world_from_load, LIFT),
            orientation: standard::quaternion(world_from_load),
            scale: [LINE_WIDTH, 0.0, 0.0],
            color: [0.2, 0.2, 0.2, 1.0],
            points: outline_in_load.iter().chain(outline_in_load.first()).map(|p| [p.x, p.y, 0.0]).collect(),
            ..blank
        },
        Marker::Robot { robot, world_from_robot, radius, role } => standard::Marker {
            ns: "robot",
            id: i32::from(robot.0),
            kind: standard::Marker::CYLINDER,
            position: at(world_from_robot, 0.5 * ROBOT_HEIGHT),
            orientation: standard::quaternion(world_from_robot),
            scale: [2.0 * radius, 2.0 * radius, ROBOT_HEIGHT],
            color: color(*role),
            ..blank
        },
        Marker::Waypoint { index, position, radius } => standard::Marker {
            ns: "waypoint",
            id: i32::from(*index),
            kind: standard::Marker::SPHERE,
            position: [position.x, position.y, LIFT],
            scale: [2.0 * radius, 2.0 * radius, 2.0 * LIFT],
            color: [0.94, 0.89, 0.26, 0.7],
            ..blank
        },
    }
}
