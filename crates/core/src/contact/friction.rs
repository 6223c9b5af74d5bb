//! Dry friction of a footprint over one time step, solved implicitly.
//!
//! A body arrives at the end of a step with the free velocity V_f. Friction takes away as much energy as it can
//! (maximum dissipation): V⁺ = argmin ½ (V − V_f)ᵀ M (V − V_f) + C · D(V − V_ground), with M = diag(m, m, I), the limit
//! impulse C = μ N Δt and the dissipation D of the [`LimitSurface`]. Sticking, sliding and the transition between them are
//! one convex problem, without a threshold speed; the friction impulse is M (V⁺ − V_f).
//!
//! The same solver serves the load on the ground and the wheels of a robot: there V_ground is the velocity that the turning
//! wheels have over the ground, and the support points are the wheels.
//!
//! # Source
//! Primal–dual Newton iteration of [Chan1999], each point with its dual 2-vector p, |p| ≤ 1.
//!
//! # Deviations
//! The norm is smoothed by ε = C/m · 5·10⁻⁵; a result slower than C/m · 10⁻³ everywhere counts as rest, exactly zero. Both
//! scale with the step, so that the threshold of sliding does not depend on it.
//!
//! [Chan1999]: crate::_documentation::references

use nalgebra::{Matrix3, Vector3};

use super::limit_surface::{LimitSurface, SupportPoint};
use crate::se2::Twist2;

/// Speed below which a body is at rest, relative to what friction can change in one step.
const REST: f64 = 1e-3;
/// Smoothing of the norm relative to the speed of rest.
const SMOOTHING: f64 = 0.05;
/// Newton steps at most; cold starts over four decades of load need 16 at most.
const STEPS: usize = 60;

/// Mass and inertia of a planar body about its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// kg.
    pub mass: f64,
    /// About the vertical axis, kg·m².
    pub moment: f64,
}

impl Inertia {
    /// Velocity change of an impulse (N·s, N·s, N·m·s).
    pub fn velocity_change(&self, impulse: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(impulse.x / self.mass, impulse.y / self.mass, impulse.z / self.moment)
    }

    /// Impulse of a velocity change.
    pub fn impulse(&self, change: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(change.x * self.mass, change.y * self.mass, change.z * self.moment)
    }
}

/// The friction of one body with its warm start.
#[derive(Clone, Debug)]
pub struct FrictionSolver {
    inertia: Inertia,
    surface: Surface,
    last: Vector3<f64>,
}

#[derive(Clone, Debug)]
enum Surface {
    Points(Points),
    Ellipsoid { radius: f64 },
}

/// Lanes of a group of support points, so that the compiler can use vector instructions.
const LANES: usize = 4;
type Lanes = [f64; LANES];

/// Four support points: place, share of the load, dual vector, and what the last evaluation left for the dual update.
#[derive(Clone, Copy, Debug, Default)]
struct Group {
    x: Lanes,
    y: Lanes,
    weight: Lanes,
    dual_x: Lanes,
    dual_y: Lanes,
    /// Direction of the point's velocity and one over its smoothed speed.
    normal_x: Lanes,
    normal_y: Lanes,
    inverse: Lanes,
}

/// All support points, padded with weightless ones.
#[derive(Clone, Debug)]
struct Points {
    groups: Vec<Group>,
    /// Σ w |r|², m².
    second_moment: f64,
    /// Greatest |r|, m.
    radius: f64,
    centred: bool,
}

/// Value, gradient and Hessian of C Σ w √(|v_i|² + ε²), the Hessian with the duals in the place of one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Evaluation {
    value: f64,
    gradient: Vector3<f64>,
    /// Upper triangle: uu, uv, vv, uω, vω, ωω.
    hessian: [f64; 6],
}

impl Points {
    fn new(points: &[SupportPoint]) -> Self {
        let mean = points.iter().fold(nalgebra::Vector2::zeros(), |sum, p| sum + p.weight * p.position);
        let groups = points
            .chunks(LANES)
            .map(|chunk| {
                let mut group = Group::default();
                for (lane, point) in chunk.iter().enumerate() {
                    group.x[lane] = point.position.x;
                    group.y[lane] = point.position.y;
                    group.weight[lane] = point.weight;
                }
                group
            })
            .collect();
        Self {
            groups,
            second_moment: points.iter().map(|p| p.weight * p.position.norm_squared()).sum(),
            radius: points.iter().map(|p| p.position.norm()).fold(0.0, f64::max),
            centred: mean.norm() < 1e-9,
        }
    }

    /// Evaluates at `v` and remembers each point's direction for [`Points::update_duals`].
    fn evaluate(&mut self, v: &Vector3<f64>, limit: f64, smoothing: f64) -> Evaluation {
        let square = smoothing * smoothing;
        let mut sums = [[0.0; LANES]; 10];
        for group in &mut self.groups {
            #[expect(clippy::needless_range_loop, reason = "every array runs along the lanes; this shape vectorizes")]
            for lane in 0..LANES {
                let (x, y, weight) = (group.x[lane], group.y[lane], group.weight[lane]);
                let (a, b) = (v.x - v.z * y, v.y + v.z * x);
                let speed = (a * a + b * b + square).sqrt();
                let inverse = 1.0 / speed;
                let (nx, ny) = (a * inverse, b * inverse);
                group.normal_x[lane] = nx;
                group.normal_y[lane] = ny;
                group.inverse[lane] = inverse;
                let k = weight * inverse;
                let (px, py) = (group.dual_x[lane], group.dual_y[lane]);
                let sxx = k * (1.0 - px * nx);
                let sxy = -0.5 * k * (px * ny + py * nx);
                let syy = k * (1.0 - py * ny);
                let (mx, my) = (x * sxy - y * sxx, x * syy - y * sxy);
                sums[0][lane] += weight * speed;
                sums[1][lane] += weight * nx;
                sums[2][lane] += weight * ny;
                sums[3][lane] += weight * (x * ny - y * nx);
                sums[4][lane] += sxx;
                sums[5][lane] += sxy;
                sums[6][lane] += syy;
                sums[7][lane] += mx;
                sums[8][lane] += my;
                sums[9][lane] += x * my - y * mx;
            }
        }
        let total = sums.map(|lanes| limit * lanes.iter().sum::<f64>());
        Evaluation {
            value: total[0],
            gradient: Vector3::new(total[1], total[2], total[3]),
            hessian: [total[4], total[5], total[6], total[7], total[8], total[9]],
        }
    }

    /// Duals p ← n + (J dV − p (n · J dV)) / ρ, kept in the unit disc, for the Newton step `step` from the last evaluation.
    fn update_duals(&mut self, step: &Vector3<f64>) {
        for group in &mut self.groups {
            for lane in 0..LANES {
                let (x, y) = (group.x[lane], group.y[lane]);
                let (nx, ny, inverse) = (group.normal_x[lane], group.normal_y[lane], group.inverse[lane]);
                let (da, db) = (step.x - step.z * y, step.y + step.z * x);
                let along = nx * da + ny * db;
                let px = nx + (da - group.dual_x[lane] * along) * inverse;
                let py = ny + (db - group.dual_y[lane] * along) * inverse;
                let scale = 1.0 / (px * px + py * py).max(1.0).sqrt();
                group.dual_x[lane] = px * scale;
                group.dual_y[lane] = py * scale;
            }
        }
    }
}

impl FrictionSolver {
    /// For a body of `inertia` resting on `surface`, expressed in the body frame about its centre of mass.
    pub fn new(inertia: Inertia, surface: &LimitSurface) -> Self {
        let surface = match surface {
            LimitSurface::Exact(points) => Surface::Points(Points::new(points)),
            LimitSurface::Ellipsoid { radius } => Surface::Ellipsoid { radius: *radius },
        };
        Self { inertia, surface, last: Vector3::zeros() }
    }

    /// Mass and inertia.
    pub fn inertia(&self) -> Inertia {
        self.inertia
    }

    /// Whether the last call ended at rest relative to the ground.
    pub fn at_rest(&self) -> bool {
        self.last == Vector3::zeros()
    }

    /// Forgets the warm start: after a teleport or a change of mass.
    pub fn reset(&mut self) {
        self.last = Vector3::zeros();
        if let Surface::Points(points) = &mut self.surface {
            for group in &mut points.groups {
                (group.dual_x, group.dual_y) = ([0.0; LANES], [0.0; LANES]);
            }
        }
    }

    /// Velocity after friction, body frame (m/s, m/s, rad/s), from the velocity `free` that the body would have without.
    ///
    /// `limit` is the limit impulse μ N Δt, N·s; both velocities are relative to the ground under the support points.
    /// Allocates nothing.
    pub fn solve(&mut self, free: &Twist2, limit: f64) -> Twist2 {
        let free = free.vector();
        let result = if limit > 0.0 && free.iter().all(|v| v.is_finite()) {
            match &mut self.surface {
                Surface::Points(points) => newton(points, self.inertia, self.last, free, limit),
                Surface::Ellipsoid { radius } => ellipsoid(*radius, self.inertia, free, limit),
            }
        } else {
            free
        };
        self.last = result;
        Twist2::new(result.x, result.y, result.z)
    }
}

/// Whether friction can hold the body at once: some field of duals p = a + β·r⊥ with |p| ≤ 1 balances the momentum.
fn is_held(points: &Points, momentum: &Vector3<f64>, limit: f64) -> bool {
    if !points.centred {
        return false;
    }
    let force = momentum.xy().norm() / limit;
    let spin = momentum.z / (limit * points.second_moment);
    if force + spin.abs() * points.radius <= 1.0 {
        return true;
    }
    let (a, b) = (momentum.x / limit, momentum.y / limit);
    points.groups.iter().all(|group| {
        (0..LANES).all(|lane| {
            let (p, q) = (a - spin * group.y[lane], b + spin * group.x[lane]);
            group.weight[lane] == 0.0 || p * p + q * q <= 1.0
        })
    })
}

fn newton(points: &mut Points, inertia: Inertia, last: Vector3<f64>, free: Vector3<f64>, limit: f64) -> Vector3<f64> {
    let momentum = inertia.impulse(&free);
    if is_held(points, &momentum, limit) {
        return Vector3::zeros();
    }
    let Inertia { mass, moment } = inertia;
    let gyration = (moment / mass).sqrt();
    let rest = REST * limit / mass;
    let smoothing = SMOOTHING * rest;
    let kinetic = |v: &Vector3<f64>| {
        let d = v - free;
        0.5 * (mass * (d.x * d.x + d.y * d.y) + moment * d.z * d.z)
    };
    // a body in motion goes on much as before; one that breaks away starts from its free velocity
    let mut v = if last == Vector3::zeros() { free } else { last };
    let mut at = points.evaluate(&v, limit, smoothing);
    for _ in 0..STEPS {
        let value = kinetic(&v) + at.value;
        let gradient = at.gradient + inertia.impulse(&(v - free));
        let [uu, uv, vv, uw, vw, ww] = at.hessian;
        let hessian = Matrix3::new(uu + mass, uv, uw, uv, vv + mass, vw, uw, vw, ww + moment);
        let Some(cholesky) = hessian.cholesky() else { break };
        let step = -cholesky.solve(&gradient);
        points.update_duals(&step);
        let moved = step.x.abs() + step.y.abs() + gyration * step.z.abs();
        let next = v + step;
        let size = next.x.abs() + next.y.abs() + gyration * next.z.abs();
        if moved < 0.05 * smoothing + 1e-5 * size {
            v = next;
            break;
        }
        // Armijo backtracking; a change within the rounding of the objective counts as none
        let slope = gradient.dot(&step);
        let rounding = 1e-13 * value.abs();
        let mut t = 1.0;
        v = next;
        at = points.evaluate(&v, limit, smoothing);
        while kinetic(&v) + at.value > value + 1e-4 * t * slope + rounding && t > 1e-6 {
            t *= 0.5;
            v = next - (1.0 - t) * step;
            at = points.evaluate(&v, limit, smoothing);
        }
    }
    if v.xy().norm() + points.radius * v.z.abs() < rest { Vector3::zeros() } else { v }
}

/// The same problem with D = √(|v|² + c²ω²): one scalar equation for s = D(V⁺).
fn ellipsoid(radius: f64, inertia: Inertia, free: Vector3<f64>, limit: f64) -> Vector3<f64> {
    let Inertia { mass, moment } = inertia;
    let square = radius * radius;
    let linear = mass * free.xy().norm();
    let angular = moment * free.z.abs();
    // held if the momentum lies inside the ellipsoid of impulses
    if (linear / limit).powi(2) + (angular / (limit * radius)).powi(2) <= 1.0 {
        return Vector3::zeros();
    }
    // V = (M + (C/s) A)⁻¹ M V_f; D(V)² = s² has one root in (0, D(V_f)], found by bisection with Newton's help
    let at = |s: f64| {
        let a = linear / (mass + limit / s);
        let b = angular / (moment + limit * square / s);
        (a, b, a * a + square * b * b - s * s)
    };
    let mut low = 0.0;
    let mut high = (free.xy().norm().powi(2) + square * free.z * free.z).sqrt();
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if at(middle).2 > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= 1e-13 * high {
            break;
        }
    }
    let s = 0.5 * (low + high);
    let linear_scale = mass / (mass + limit / s);
    let angular_scale = moment / (moment + limit * square / s);
    Vector3::new(free.x * linear_scale, free.y * linear_scale, free.z * angular_scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shape::ConvexPolygon;

    fn solver(surface: fn(&ConvexPolygon) -> LimitSurface) -> FrictionSolver {
        let load = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
        let inertia = Inertia { mass: 2.0, moment: 2.0 * load.second_moment() };
        FrictionSolver::new(inertia, &surface(&load))
    }

    /// The optimality condition of the minimisation: the impulse is the limit surface's wrench at the resulting twist.
    #[test]
    fn sliding_impulse_lies_on_the_limit_surface() {
        let load = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
        for surface in [LimitSurface::exact, LimitSurface::ellipsoid] {
            let mut solver = solver(surface);
            let limit = 0.02;
            let mut worst: Vec<f64> = Vec::new();
            for i in 0..2000 {
                let a = f64::from(i) * 0.618_034;
                let free = Twist2::new(0.3 * a.sin(), 0.3 * (1.3 * a).cos(), 0.8 * (2.1 * a).sin());
                let after = solver.solve(&free, limit);
                let impulse = solver.inertia().impulse(&(after.vector() - free.vector()));
                let expected = surface(&load).wrench(&after, limit).vector();
                worst.push((impulse - expected).norm() / limit);
            }
            worst.sort_by(f64::total_cmp);
            // beyond this quantile one support point lies at the centre of rotation, where the wrench is a set
            assert!(worst[1980] < 0.01, "{}", worst[1980]);
        }
    }

    #[test]
    fn momentum_within_the_limit_is_taken_away_exactly() {
        for surface in [LimitSurface::exact, LimitSurface::ellipsoid] {
            let mut solver = solver(surface);
            let limit = 0.02;
            assert_eq!(solver.solve(&Twist2::new(0.99 * limit / 2.0, 0.0, 0.0), limit), Twist2::ZERO);
            assert!(solver.at_rest());
            let after = solver.solve(&Twist2::new(1.01 * limit / 2.0, 0.0, 0.0), limit);
            assert!((after.linear.x - 0.01 * limit / 2.0).abs() < 1e-3 * limit / 2.0, "{after:?}");
        }
    }

    /// Friction never accelerates: the energy after is never above the energy before.
    #[test]
    fn friction_only_dissipates() {
        let mut solver = solver(LimitSurface::exact);
        for i in 0..2000 {
            let a = f64::from(i) * 0.618_034;
            let free = Twist2::new(a.sin(), (1.3 * a).cos(), 2.0 * (2.1 * a).sin());
            let after = solver.solve(&free, 0.05 * (1.0 + a.cos()));
            let energy = |t: &Twist2| 2.0 * t.linear.norm_squared() + solver.inertia().moment * t.angular * t.angular;
            assert!(energy(&after) <= energy(&free) + 1e-12);
        }
    }
}
