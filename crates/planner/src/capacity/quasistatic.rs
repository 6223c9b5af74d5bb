//! How load and robots move together, slowly: the velocities that dissipate least.
//!
//! # Source
//! [Goyal1991] gives the friction of the load a dissipation potential; [Peshkin1989] find the motion of a pushed load as the
//! one that costs least power. Wheels are dry friction too: a robot whose wheels turn at the velocity c and which moves at u
//! dissipates T |u − c|, with the traction T = μ_w N. So load twist V and robot velocities uᵢ minimise
//!
//! μ N D(V) − m g·v + Σᵢ (Tᵢ |uᵢ − cᵢ| − mᵢ g·uᵢ) + Σᵢ Fᵢ |tᵢ·(V(pᵢ) − uᵢ)|
//!
//! while no robot enters the load, nᵢ·(V(pᵢ) − uᵢ) ≥ 0, g being gravity along the ground. It is a second-order cone program; the
//! multipliers of the inequalities are the contact forces. If the objective is unbounded, nothing holds the load.
//!
//! # Deviations
//! Friction between robots and load depends on the contact force that it helps to find; its limit Fᵢ is taken from the step
//! before.
//!
//! [Goyal1991]: cohaul_core::_documentation::references
//! [Peshkin1989]: cohaul_core::_documentation::references

use cohaul_core::contact::limit_surface::LimitSurface;
use cohaul_core::se2::{Twist2, perpendicular};
use nalgebra::Vector2;

use crate::conic::{Affine, ConicError, Program, Variable};

/// A robot in contact with the load, everything in the load's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    /// Where it touches the load, m.
    pub point: Vector2<f64>,
    /// Unit vector into the load.
    pub facing: Vector2<f64>,
    /// Velocity at which its wheels turn, m/s.
    pub command: Vector2<f64>,
    /// Most that its wheels can hold, N.
    pub traction: f64,
    /// Its weight along the ground, N.
    pub weight: Vector2<f64>,
    /// Most that friction at the contact can hold, N.
    pub rubbing: f64,
}

/// A load on the ground, in its own frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground<'a> {
    /// Shape of the friction.
    pub surface: &'a LimitSurface,
    /// Limit force μ N, N.
    pub limit: f64,
    /// Weight of the load along the ground, N.
    pub weight: Vector2<f64>,
}

/// How load and robots move.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// Of the load.
    pub twist: Twist2,
    /// Contact forces, N.
    pub forces: Vec<f64>,
    /// Whether each robot's wheels slip.
    pub slips: Vec<bool>,
}

/// Difference between the velocities of wheels and robot that counts as slip, m/s.
const SLIP: f64 = 2e-3;

/// Velocity of the load's point `at` as expressions of the twist.
fn velocity_at(twist: [Variable; 3], at: &Vector2<f64>) -> [Affine; 2] {
    [1.0 * twist[0] + -at.y * twist[2], 1.0 * twist[1] + at.x * twist[2]]
}

/// The motion that dissipates least.
///
/// # Errors
/// [`ConicError::Unbounded`] if nothing holds the load.
pub(crate) fn motion(ground: &Ground<'_>, contacts: &[Contact]) -> Result<Motion, ConicError> {
    let mut program = Program::new();
    // forces in units of the largest ones, for the solver's sake
    let scale = contacts.iter().map(|c| c.traction).fold(ground.limit.max(ground.weight.norm()), f64::max).max(1e-9);
    let twist = [program.variable(), program.variable(), program.variable()];
    match ground.surface {
        LimitSurface::Exact(points) => {
            for point in points {
                let speed = program.variable();
                program.within(speed.into(), &velocity_at(twist, &point.position));
                program.minimize(ground.limit * point.weight / scale * speed);
            }
        }
        LimitSurface::Ellipsoid { radius } => {
            let speed = program.variable();
            program.within(speed.into(), &[twist[0].into(), twist[1].into(), *radius * twist[2]]);
            program.minimize(ground.limit / scale * speed);
        }
    }
    program.minimize(-ground.weight.x / scale * twist[0] + -ground.weight.y / scale * twist[1]);
    let mut robots = Vec::new();
    for contact in contacts {
        let (x, y, slip) = (program.variable(), program.variable(), program.variable());
        program.within(slip.into(), &[Affine::from(x) - contact.command.x, Affine::from(y) - contact.command.y]);
        program.minimize(contact.traction / scale * slip);
        program.minimize(-contact.weight.x / scale * x + -contact.weight.y / scale * y);
        let [load_x, load_y] = velocity_at(twist, &contact.point);
        let (dx, dy) = (load_x - x, load_y - y);
        let apart = program.nonnegative(contact.facing.x * dx.clone() + contact.facing.y * dy.clone());
        if contact.rubbing > 0.0 {
            let tangent = perpendicular(&contact.facing);
            let along = tangent.x * dx + tangent.y * dy;
            let rub = program.variable();
            program.nonnegative(Affine::from(rub) - along.clone());
            program.nonnegative(Affine::from(rub) + along);
            program.minimize(contact.rubbing / scale * rub);
        }
        robots.push((slip, apart));
    }
    let solution = program.solve()?;
    Ok(Motion {
        twist: Twist2::new(solution[twist[0]], solution[twist[1]], solution[twist[2]]),
        forces: robots.iter().map(|(_, apart)| scale * solution.multiplier(*apart)).collect(),
        slips: robots.iter().map(|(slip, _)| solution[*slip] > SLIP).collect(),
    })
}
