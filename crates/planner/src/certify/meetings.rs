//! Bodies that meet obstacles and each other.

use cohaul_core::se2::{Pose2, position};
use nalgebra::{Point2, Vector2};

use super::bodies::{Disc, near_pairs};
use super::drive::Tolerance;
use super::motion::Motion;
use super::sweep::{Meeting, Moving, meeting, overlap};
use super::{Findings, Model, ViolationKind, Work};
use crate::instance::{Obstacle, Vehicle};
use crate::plan::Route;

/// What one look at two bodies takes compared to a look at two discs.
const LOOK: u64 = 50;
/// Most corners of an obstacle; a look at it takes their number squared.
const CORNERS_MAX: usize = 1000;

/// Corners of the body, grown by `margin` on every side.
pub(super) fn rectangle(vehicle: &Vehicle, margin: f64) -> [Vector2<f64>; 4] {
    let (front, rear, side) = (vehicle.front + margin, -vehicle.rear - margin, 0.5 * vehicle.width + margin);
    [Vector2::new(rear, -side), Vector2::new(front, -side), Vector2::new(front, side), Vector2::new(rear, side)]
}

fn reach(corners: &[Vector2<f64>]) -> f64 {
    corners.iter().map(Vector2::norm).fold(0.0, f64::max)
}

/// An obstacle, and the body as it must not touch it.
pub(super) struct Block {
    place: Motion,
    corners: Vec<Vector2<f64>>,
    disc: Disc,
    body: [Vector2<f64>; 4],
    reach: f64,
    number: usize,
}

impl Block {
    /// Obstacle `number`; what is wrong with it otherwise.
    pub(super) fn new(vehicle: &Vehicle, number: usize, obstacle: &Obstacle) -> Result<Self, String> {
        let (corners, margin): (Vec<Point2<f64>>, f64) = match obstacle {
            Obstacle::Point { at, radius } if *radius >= 0.0 => (vec![*at], *radius),
            Obstacle::Point { radius, .. } => return Err(format!("obstacle {number} has the radius {radius}")),
            Obstacle::Polygon(corners) => (corners.clone(), 0.0),
        };
        let Some(first) = corners.first() else {
            return Err(format!("obstacle {number} has no corners"));
        };
        if !(corners.iter().flat_map(|corner| corner.iter()).chain([&margin]).all(|value| super::car::is_sane(*value)))
        {
            return Err(format!("obstacle {number} has numbers that make no sense"));
        }
        if corners.len() > CORNERS_MAX {
            return Err(format!(
                "obstacle {number} has {} corners; more than {CORNERS_MAX} are not checked",
                corners.len()
            ));
        }
        let around: Vec<Vector2<f64>> = corners.iter().map(|corner| corner - first).collect();
        if corners.len() > 1 && !is_convex(&around) {
            return Err(format!("obstacle {number} is not a convex polygon with its corners counter-clockwise"));
        }
        let disc = Disc { centre: first.coords, radius: reach(&around) };
        let body = rectangle(vehicle, margin);
        let place = Motion::rest(&Pose2::new(first.coords, 0.0));
        Ok(Self { place, corners: around, disc, body, reach: reach(&body), number })
    }

    fn is_near(&self, centre: Vector2<f64>, length: f64) -> bool {
        (centre - self.disc.centre).norm() <= self.disc.radius + self.reach + length
    }

    fn moving(&self) -> Moving<'_> {
        Moving { motion: self.place, corners: &self.corners }
    }

    /// What one look at it takes compared to a look at two discs.
    pub(super) fn look(&self) -> u64 {
        let corners = self.corners.len() as u64 + 4;
        LOOK * (1 + corners * corners / 64)
    }

    /// Whether a body in this pose overlaps it.
    pub(super) fn is_touched(&self, pose: &Pose2) -> bool {
        let body = Moving { motion: Motion::rest(pose), corners: &self.body };
        self.is_near(position(pose), 0.0) && overlap(&body, &self.moving(), 0.0) > 0.0
    }
}

/// Whether corners turn to the left all the way round, once.
fn is_convex(corners: &[Vector2<f64>]) -> bool {
    let number = corners.len();
    let side = |k: usize| corners[(k + 1) % number] - corners[k % number];
    let mut turned = 0.0;
    for k in 0..number {
        let (one, next) = (side(k), side(k + 1));
        let turn = cohaul_core::se2::cross(&one, &next).atan2(one.dot(&next));
        // on a straight line corners may be off by rounding
        if !(turn > -1e-9 && turn < std::f64::consts::PI - 1e-9) || one.norm() == 0.0 {
            return false;
        }
        turned += turn;
    }
    number >= 3 && (turned - std::f64::consts::TAU).abs() < 1e-6
}

/// Bodies that touch obstacles.
pub(super) fn with_obstacles(
    blocks: &[Block],
    routes: &[Option<&Route<Pose2>>],
    (model, free_starts): (Model, bool),
    tolerance: &Tolerance,
    work: &mut Work,
    findings: &mut Findings,
) {
    let touches = |agent: usize, time: f64, number: usize, depth: f64, findings: &mut Findings| {
        findings.add(ViolationKind::Obstacle, time, &[agent], || {
            format!("agent {agent} is {depth:.6} m deep in obstacle {number}")
        });
    };
    for (agent, route) in routes.iter().enumerate() {
        let Some(route) = route else { continue };
        // with free starts a body need not be clear of obstacles before it moves
        let unmoved =
            route.states.iter().take_while(|state| free_starts && Some(*state) == route.states.first()).count();
        for (step, pose) in route.states.iter().enumerate().skip(unmoved) {
            if !work.spend(blocks.len() as u64 + 1) {
                too_much("obstacles", step as f64, findings);
                return;
            }
            let next = route.states.get(step + 1);
            // the last pose is the end of the step before it, and is only looked at where there is none
            if model == Model::Exact && next.is_none() && step > 0 {
                continue;
            }
            let motion = match (model, next) {
                (Model::Exact, Some(next)) => Motion::between(pose, next),
                _ => Motion::rest(pose),
            };
            let (centre, length) = (position(pose), motion.length());
            for block in blocks.iter().filter(|block| block.is_near(centre, length)) {
                let body = Moving { motion, corners: &block.body };
                let mut looked = 0;
                match meeting(&body, &block.moving(), tolerance.depth(block.reach), &mut looked) {
                    Meeting::Apart => {}
                    Meeting::Overlap { at, depth } => touches(agent, step as f64 + at, block.number, depth, findings),
                    Meeting::Undecided { at } => {
                        findings.add(ViolationKind::Unchecked, step as f64 + at, &[agent], || {
                            format!("agent {agent} is too close to obstacle {} for too long to tell", block.number)
                        });
                    }
                }
                if !work.spend(block.look() * looked) {
                    too_much("obstacles", step as f64, findings);
                    return;
                }
            }
        }
    }
}

pub(super) fn too_much(what: &str, time: f64, findings: &mut Findings) {
    findings
        .add(ViolationKind::Unchecked, time, &[], || format!("too much to look at: {what} were checked only in part"));
}

/// Bodies that overlap, or come too near, those included that have arrived.
pub(super) fn with_each_other(
    vehicle: &Vehicle,
    routes: &[Option<&Route<Pose2>>],
    model: Model,
    tolerance: &Tolerance,
    work: &mut Work,
    findings: &mut Findings,
) {
    let driving: Vec<(usize, &[Pose2], &Pose2)> = routes
        .iter()
        .enumerate()
        .filter_map(|(agent, route)| {
            let states = route.as_ref()?.states.as_slice();
            Some((agent, states, states.last()?))
        })
        .collect();
    let steps = driving.iter().map(|(_, states, _)| states.len()).max().unwrap_or(0);
    let body = rectangle(vehicle, 0.0);
    let (body_reach, separation) = (reach(&body), vehicle.separation());
    // a step between two states; states only where ends of steps matter, or where there is one alone
    let steps = if model == Model::Exact { steps.saturating_sub(1).max(1) } else { steps };
    let mut order = Vec::new();
    let mut motions: Vec<Motion> = Vec::with_capacity(driving.len());
    let mut discs: Vec<(usize, Disc)> = Vec::with_capacity(driving.len());
    for step in 0..steps {
        motions.clear();
        motions.extend(driving.iter().map(|(_, states, last)| {
            let from = states.get(step).unwrap_or(last);
            match (model, states.get(step + 1)) {
                (Model::Exact, Some(next)) => Motion::between(from, next),
                _ => Motion::rest(from),
            }
        }));
        let disc_reach = if model == Model::Exact { body_reach } else { 0.5 * separation };
        discs.clear();
        discs.extend(
            driving.iter().zip(&motions).map(|((agent, ..), motion)| (*agent, Disc::around(motion, disc_reach))),
        );
        let finished = near_pairs(&discs, &mut order, work, |one, other, work| {
            // who stood there in the step before already was looked at then
            let last = |index: usize| driving[index].1.len() - 1;
            if step > 0 && step > last(one).max(last(other)) {
                return true;
            }
            let (first, second) = (driving[one].0, driving[other].0);
            if model == Model::Clcbs {
                let distance = (motions[one].at(0.0).0 - motions[other].at(0.0).0).norm();
                if distance < separation - 2.0 * tolerance.position {
                    findings.add(ViolationKind::Collision, step as f64, &[first, second], || {
                        format!("agents {first} and {second} are {distance:.6} m apart, less than {separation:.6}")
                    });
                }
                return work.spend(1);
            }
            let (a, b) =
                (Moving { motion: motions[one], corners: &body }, Moving { motion: motions[other], corners: &body });
            let mut looked = 0;
            match meeting(&a, &b, tolerance.depth(body_reach), &mut looked) {
                Meeting::Apart => {}
                Meeting::Overlap { at, depth } => {
                    findings.add(ViolationKind::Collision, step as f64 + at, &[first, second], || {
                        format!("agents {first} and {second} overlap by up to {depth:.6} m")
                    });
                }
                Meeting::Undecided { at } => {
                    findings.add(ViolationKind::Unchecked, step as f64 + at, &[first, second], || {
                        format!("agents {first} and {second} are too close for too long to tell")
                    });
                }
            }
            work.spend(LOOK * looked)
        });
        if !finished {
            too_much("meetings", step as f64, findings);
            return;
        }
    }
}
