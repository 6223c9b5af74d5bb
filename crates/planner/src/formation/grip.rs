//! How much a team in given slots can do: the factor by which everything asked of it can grow.
//!
//! # Source
//! Contact forces within friction cones as a second-order cone program: [Boyd2007]; a grasp rated by what it resists:
//! [Trinkle1992]. The friction wrench of the ground is that of the exact limit surface [Goyal1991], the roles are those of
//! [R2P2] §IV-B.
//!
//! For a demand d the program seeks the largest λ such that the contact forces fᵢ balance λ times weight and friction of the
//! load: Σ Wᵢ fᵢ + λ w_g + Σ αₖ wₖ = 0, Σ αₖ = λ, where the wₖ are the friction wrenches of twists that count as doing what is
//! demanded. Each fᵢ lies in the friction cone of its contact, and what the wheels give, fᵢ less the robot's own weight along
//! the ground, in the disc of its traction. The margin is the least λ over all demands.
//!
//! # Deviations
//! - A mix of friction wrenches stands for the surface between them, which bulges outwards: the surface is underrated by a few
//!   per cent.
//! - A rotation may have its pivot anywhere within 15 % of the load's radius (within a third it counts less), and a translation
//!   may drift by a tenth: the controller corrects both.
//!
//! [Boyd2007]: cohaul_core::_documentation::references
//! [Trinkle1992]: cohaul_core::_documentation::references
//! [Goyal1991]: cohaul_core::_documentation::references
//! [R2P2]: cohaul_core::_documentation::references

use std::fmt;

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::contact::slope::Slope;
use cohaul_core::control::r2p2::TOLERANCES;
use cohaul_core::robot::RobotModel;
use cohaul_core::se2::{Twist2, cross, perpendicular, unit};
use cohaul_core::transport::formation::Slot;
use cohaul_core::transport::primitive::{Primitive, Turn};
use cohaul_core::transport::role::{self, Role};
use nalgebra::{Vector2, Vector3};

use crate::conic::{Affine, Program};

/// Something that a team must be able to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// Move the load as a primitive of R2P2 does.
    Move(Primitive),
    /// Keep the load where it is.
    Hold,
}

impl Demand {
    /// Every demand.
    pub const ALL: [Self; 4] = [
        Self::Move(Primitive::Translate),
        Self::Move(Primitive::Rotate(Turn::Counterclockwise)),
        Self::Move(Primitive::Rotate(Turn::Clockwise)),
        Self::Hold,
    ];
}

impl fmt::Display for Demand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Move(Primitive::Translate) => "translating",
            Self::Move(Primitive::Rotate(Turn::Counterclockwise)) => "turning counter-clockwise",
            Self::Move(Primitive::Rotate(Turn::Clockwise)) => "turning clockwise",
            Self::Hold => "holding",
        })
    }
}

/// What a team has to do with: its load, its robots, its ground.
#[derive(Clone, Debug)]
pub(crate) struct Conditions {
    pub surface: LimitSurface,
    /// Half the load's extent across its heading, m.
    pub half_length: f64,
    /// Greatest distance of the load's edge from its centre, m.
    pub reach: f64,
    /// kg.
    pub mass: f64,
    /// Between load and ground.
    pub friction: f64,
    /// Between robot and load.
    pub contact_friction: f64,
    /// Between wheels and ground.
    pub wheel_friction: f64,
    pub slope: Slope,
    pub model: RobotModel,
    /// Distance between robot and load, m.
    pub gap: f64,
}

/// Factors below this are none: the solver's tolerance is far below.
const LEAST: f64 = 1e-4;
/// Distance of a rotation's pivot from the load's centre over the load's radius: done well, done badly, hardly done.
const PIVOTS: [f64; 3] = [0.15, 1.0 / 3.0, 1.0];
/// Share of the factor that each of them counts.
const WORTH: [f64; 3] = [1.0, 0.3, 0.0];
/// Largest factor of interest.
const CAP: f64 = 1e3;

/// How much a team can do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rating {
    /// Least factor over all demands.
    pub margin: f64,
    /// The demand that it belongs to.
    pub limited_by: Demand,
    /// How many demands, each heading for itself, are met how well.
    pub met: f64,
}

/// Friction wrenches for every demand, computed once.
#[derive(Clone, Debug)]
pub(crate) struct Grip {
    conditions: Conditions,
    /// Of each demand, in every way to do it, the best first.
    wrenches: [[Vec<Vector3<f64>>; 3]; 4],
    /// Directions of gravity along the ground in the load's frame; one zero vector on flat ground.
    gravity: Vec<Vector2<f64>>,
}

impl Grip {
    /// Prepares for `directions` headings on a slope.
    pub fn new(conditions: Conditions, directions: usize) -> Self {
        let limit = conditions.friction * conditions.mass * conditions.slope.normal;
        let wrench = |twist: Twist2| conditions.surface.wrench(&twist, limit).vector();
        let eighths = || (0..8).map(|i| unit(f64::from(i) * std::f64::consts::FRAC_PI_4));
        let radius = conditions.surface.friction_radius();
        let translate = [(0.0, 0.0), (0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.0, -0.1)];
        let translate = translate.map(|(y, turn)| wrench(Twist2::new(1.0, y, turn / radius))).to_vec();
        let rotate = |sign: f64| {
            PIVOTS.map(|reach| {
                let pivots = std::iter::once(Vector2::zeros()).chain(eighths().map(|u| u * conditions.reach * reach));
                pivots.map(|q| wrench(Twist2::new(sign * q.y, -sign * q.x, sign))).collect::<Vec<_>>()
            })
        };
        let hold = eighths()
            .flat_map(|u| [-1.0, 0.0, 1.0].map(|turn| Twist2::new(u.x, u.y, turn / radius)))
            .chain([1.0, -1.0].map(|turn| Twist2::new(0.0, 0.0, turn)))
            .map(wrench)
            .collect();
        let steepness = conditions.slope.tangential.norm();
        let gravity = if steepness > 0.0 {
            let turn = std::f64::consts::TAU / directions as f64;
            (0..directions).map(|i| steepness * unit(turn * i as f64)).collect()
        } else {
            vec![Vector2::zeros()]
        };
        let wrenches = [[translate, Vec::new(), Vec::new()], rotate(1.0), rotate(-1.0), [hold, Vec::new(), Vec::new()]];
        Self { wrenches, conditions, gravity }
    }

    /// How much the team can do in `slots`.
    pub fn rate(&self, slots: &[Slot]) -> Rating {
        let mut rating = Rating { margin: CAP, limited_by: Demand::Hold, met: 0.0 };
        for (demand, wrenches) in Demand::ALL.iter().zip(&self.wrenches) {
            for gravity in &self.gravity {
                if *demand == Demand::Hold && gravity.norm() == 0.0 {
                    continue;
                }
                // how well it is met: well, badly, or only with the pivot far away, which counts for nothing but a start
                let ways = wrenches.iter().filter(|way| !way.is_empty());
                let met = ways.zip(WORTH).find_map(|(way, worth)| {
                    let factor = self.factor(*demand, way, gravity, slots);
                    (factor > 0.0).then_some((worth * factor, worth))
                });
                let (margin, worth) = met.unwrap_or((0.0, -1.0));
                rating.met += 1.0 + worth;
                if margin < rating.margin {
                    (rating.margin, rating.limited_by) = (margin, *demand);
                }
            }
        }
        rating
    }

    /// Friction at the contact of a robot in `slot` that acts on the load for `demand`, `None` if it does not.
    fn contact(&self, demand: Demand, gravity: &Vector2<f64>, slot: &Slot) -> Option<f64> {
        let c = &self.conditions;
        let Demand::Move(primitive) = demand else { return Some(c.contact_friction) };
        let center = slot.center(c.model.radius, c.gap);
        let friction = c.friction * c.slope.normal;
        match role::assign(primitive, &center, &slot.facing, &Vector2::x(), c.half_length, &TOLERANCES) {
            Role::Push => Some(c.contact_friction),
            // gives way, so that it is felt only where the load would slide by itself: ahead if it is steep enough, sideways
            // on any slope, because friction on the ground opposes the motion and nothing else
            Role::Prevent if primitive == Primitive::Translate => {
                let leans = -gravity.y * slot.facing.y > 1e-9;
                (gravity.x > friction || leans).then_some(0.0)
            }
            Role::Prevent => (gravity.norm() > friction).then_some(0.0),
            // follows, and a slope may lean the load on it
            Role::Support => (gravity.norm() > 0.0).then_some(0.0),
        }
    }

    fn factor(&self, demand: Demand, wrenches: &[Vector3<f64>], gravity: &Vector2<f64>, slots: &[Slot]) -> f64 {
        let c = &self.conditions;
        let traction = c.wheel_friction * c.model.mass_on_wheels * c.slope.normal;
        let own = c.model.mass * gravity;
        let scale = traction.max(1e-9);
        let mut program = Program::new();
        let factor = program.variable();
        program.nonnegative(factor.into());
        program.nonnegative(Affine::constant(CAP) - factor);
        let weight = c.mass * gravity / scale;
        let mut balance = [weight.x * factor, weight.y * factor, Affine::constant(0.0)];
        let mut shares = Affine::from(factor);
        for wrench in wrenches {
            let share = program.variable();
            program.nonnegative(share.into());
            shares = shares - share;
            for (sum, part) in balance.iter_mut().zip(wrench.iter()) {
                sum.push(part / scale, share);
            }
        }
        match demand {
            Demand::Hold => {
                program.nonnegative(shares); // friction of rest: anything within the surface
            }
            Demand::Move(_) => program.zero(shares),
        }
        for (slot, friction) in slots.iter().filter_map(|s| Some((s, self.contact(demand, gravity, s)?))) {
            let (normal, along) = (program.variable(), program.variable());
            let tangent = perpendicular(&slot.facing);
            program.nonnegative(friction * normal - along);
            program.nonnegative(friction * normal + along);
            let force = |a: f64, b: f64| a * normal + b * along;
            let x = force(slot.facing.x, tangent.x);
            let y = force(slot.facing.y, tangent.y);
            program.within(Affine::constant(traction / scale), &[x.clone() - own.x / scale, y.clone() - own.y / scale]);
            let torque = force(cross(&slot.contact, &slot.facing), cross(&slot.contact, &tangent));
            for (sum, part) in balance.iter_mut().zip([x, y, torque]) {
                *sum = std::mem::take(sum) + part;
            }
        }
        for sum in balance {
            program.zero(sum);
        }
        program.minimize(-1.0 * factor);
        // a team that cannot even hold itself on the slope has no margin at all
        program.solve().map_or(0.0, |solution| if solution[factor] > LEAST { solution[factor] } else { 0.0 })
    }
}
