//! Limit surfaces: which friction wrench a sliding load feels.
//!
//! # Source
//! [Goyal1991]: at a twist V the friction wrench is −μN ∇D(V), with D the mean over the footprint of the speed of its
//! points; the set of all such wrenches is the limit surface. [Howe1996]: its ellipsoidal approximation,
//! D = √(|v|² + c²ω²) with c the friction radius D(0, 0, 1).
//!
//! # Deviations
//! The mean over the footprint is a Gauss–Legendre sum: 4 × 8 points on a rectangle (friction radius +0.4 % for
//! 0.35 × 1.35 m, yaw of an off-centre push within 1 %). [`rectangle_dissipation`] is the closed form that it is tested
//! against.
//!
//! [Goyal1991]: crate::_documentation::references
//! [Howe1996]: crate::_documentation::references

use nalgebra::Vector2;

use crate::geometry::shape::ConvexPolygon;
use crate::se2::{Twist2, Wrench2, cross};

/// A point of the footprint and its share of the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportPoint {
    /// Position in the body frame, m.
    pub position: Vector2<f64>,
    /// Share of the normal force; the shares of a footprint sum to 1.
    pub weight: f64,
}

/// How friction depends on the direction of motion.
#[derive(Clone, Debug, PartialEq)]
pub enum LimitSurface {
    /// Dry friction at every support point.
    Exact(Vec<SupportPoint>),
    /// The ellipsoid with the given friction radius, m.
    Ellipsoid {
        /// Torque limit over force limit, m.
        radius: f64,
    },
}

/// Abscissas and weights on [−1, 1], positive half, of the Gauss–Legendre rules used here.
const GAUSS_4: [(f64, f64); 2] =
    [(0.339_981_043_584_856_3, 0.652_145_154_862_546_1), (0.861_136_311_594_052_6, 0.347_854_845_137_453_8)];
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_3),
];

fn both_halves(rule: &[(f64, f64)]) -> impl Iterator<Item = (f64, f64)> + '_ {
    rule.iter().flat_map(|&(x, w)| [(-x, w / 2.0), (x, w / 2.0)])
}

impl LimitSurface {
    /// Uniform pressure over `footprint`, which must have its centroid at the origin.
    pub fn exact(footprint: &ConvexPolygon) -> Self {
        let vertices = footprint.vertices();
        let is_rectangle = vertices.len() == 4
            && (0..4).all(|i| (footprint.edge(i).tangent().dot(&footprint.edge(i + 1).tangent())).abs() < 1e-9);
        let mut points = Vec::new();
        if is_rectangle {
            let center = (vertices[0] + vertices[2]) / 2.0;
            let (first, second) = ((vertices[1] - vertices[0]) / 2.0, (vertices[2] - vertices[1]) / 2.0);
            // more points along the longer side
            let (short, long) = if first.norm() < second.norm() { (first, second) } else { (second, first) };
            for (a, wa) in both_halves(&GAUSS_4) {
                for (b, wb) in both_halves(&GAUSS_8) {
                    points.push(SupportPoint { position: center + a * short + b * long, weight: wa * wb });
                }
            }
        } else {
            // a fan of triangles around the centroid, each mapped from the square (s, t) -> s·((1−t)·a + t·b)
            let inner = if vertices.len() > 6 { &GAUSS_4[..] } else { &GAUSS_8[..] };
            for i in 0..vertices.len() {
                let (a, b) = (vertices[i], vertices[(i + 1) % vertices.len()]);
                let share = cross(&a, &b) / 2.0 / footprint.area();
                for (s, ws) in both_halves(&GAUSS_4) {
                    for (t, wt) in both_halves(inner) {
                        let (s, t) = ((1.0 + s) / 2.0, (1.0 + t) / 2.0);
                        let position = s * ((1.0 - t) * a + t * b);
                        points.push(SupportPoint { position, weight: share * 2.0 * s * ws * wt });
                    }
                }
            }
        }
        Self::Exact(points)
    }

    /// The ellipsoid with the friction radius of uniform pressure over `footprint` (centroid at the origin).
    pub fn ellipsoid(footprint: &ConvexPolygon) -> Self {
        Self::Ellipsoid { radius: Self::exact(footprint).friction_radius() }
    }

    /// Dissipation D: friction power per unit of limit force μN at body twist `twist`, m/s.
    pub fn dissipation(&self, twist: &Twist2) -> f64 {
        match self {
            Self::Exact(points) => points.iter().map(|p| p.weight * twist.velocity_at(&p.position).norm()).sum(),
            Self::Ellipsoid { radius } => (twist.linear.norm_squared() + (radius * twist.angular).powi(2)).sqrt(),
        }
    }

    /// Friction wrench on a load sliding with body twist `twist` under the limit force μN = `limit` (N): −μN ∇D, in the
    /// body frame. Zero at rest, where the wrench is whatever the other forces ask for, up to the limit surface.
    pub fn wrench(&self, twist: &Twist2, limit: f64) -> Wrench2 {
        let mut sum = Wrench2::ZERO;
        match self {
            Self::Exact(points) => {
                for p in points {
                    let velocity = twist.velocity_at(&p.position);
                    let speed = velocity.norm();
                    if speed > 0.0 {
                        let force = -limit * p.weight / speed * velocity;
                        sum.force += force;
                        sum.torque += cross(&p.position, &force);
                    }
                }
            }
            Self::Ellipsoid { radius } => {
                let dissipation = self.dissipation(twist);
                if dissipation > 0.0 {
                    sum.force = -limit / dissipation * twist.linear;
                    sum.torque = -limit / dissipation * radius * radius * twist.angular;
                }
            }
        }
        sum
    }

    /// Torque limit over force limit when spinning on the spot, m.
    pub fn friction_radius(&self) -> f64 {
        self.dissipation(&Twist2::new(0.0, 0.0, 1.0))
    }
}

/// D and its gradient for uniform pressure over a rectangle `along_x` by `along_y` (m), in closed form.
///
/// With the centre of rotation as origin the integrals of |r|, x/|r| and y/|r| over the rectangle are signed sums over
/// its corners. Twists that hardly rotate use the series in ω, because the corner sums cancel.
pub fn rectangle_dissipation(along_x: f64, along_y: f64, twist: &Twist2) -> (f64, [f64; 3]) {
    let (u, v, w) = (twist.linear.x, twist.linear.y, twist.angular);
    let speed = twist.linear.norm();
    if w.abs() * along_x.max(along_y) < 1e-3 * speed {
        let n = twist.linear / speed;
        // ⟨(n × r)²⟩, the variance of the lever arm
        let variance = ((along_x * n.y).powi(2) + (along_y * n.x).powi(2)) / 12.0;
        return (speed + w * w * variance / (2.0 * speed), [n.x, n.y, w / speed * variance]);
    }
    if w == 0.0 {
        return (0.0, [0.0; 3]);
    }
    let asinh = |a: f64, b: f64| if b == 0.0 { 0.0 } else { (a / b.abs()).asinh() };
    let (mut mean_x, mut mean_y, mut mean_r) = (0.0, 0.0, 0.0);
    for (sx, sy) in [(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0)] {
        // coordinates of the corner seen from the centre of rotation
        let x = sx * along_x / 2.0 + v / w;
        let y = sy * along_y / 2.0 - u / w;
        let r = x.hypot(y);
        let sign = sx * sy;
        mean_x += sign * (y * r + x * x * asinh(y, x)) / 2.0;
        mean_y += sign * (x * r + y * y * asinh(x, y)) / 2.0;
        mean_r += sign * (x * y * r / 3.0 + x.powi(3) / 6.0 * asinh(y, x) + y.powi(3) / 6.0 * asinh(x, y));
    }
    let area = along_x * along_y;
    let (mean_x, mean_y, mean_r) = (mean_x / area, mean_y / area, mean_r / area);
    let sign = w.signum();
    let gradient = [-sign * mean_y, sign * mean_x, sign * (mean_r - v / w * mean_x + u / w * mean_y)];
    (w.abs() * mean_r, gradient)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load() -> ConvexPolygon {
        ConvexPolygon::rectangle(0.35, 1.35).unwrap()
    }

    #[test]
    fn friction_radius_of_the_papers_load_is_0_359_m() {
        // closed form 0.35929 m; the 4 × 8 rule is +0.42 % off
        let (radius, _) = rectangle_dissipation(0.35, 1.35, &Twist2::new(0.0, 0.0, 1.0));
        assert!((radius - 0.35929).abs() < 5e-6, "{radius}");
        let rule = LimitSurface::exact(&load()).friction_radius();
        assert!((rule / radius - 1.0).abs() < 0.005, "{rule}");
    }

    /// The Gauss rule's error is largest where a point passes the centre of rotation: 0.061 μN over all twists.
    #[test]
    fn quadrature_agrees_with_the_closed_form() {
        let surface = LimitSurface::exact(&load());
        for i in 0..500 {
            let a = f64::from(i) * 0.754_877;
            let twist = Twist2::new(a.sin(), (1.7 * a).cos(), 3.0 * (2.3 * a).sin());
            let (dissipation, gradient) = rectangle_dissipation(0.35, 1.35, &twist);
            assert!((surface.dissipation(&twist) / dissipation - 1.0).abs() < 0.008);
            let wrench = surface.wrench(&twist, 1.0).vector();
            let error = (wrench + nalgebra::Vector3::from(gradient)).norm();
            assert!(error < 0.065, "{twist:?} {error}");
        }
    }

    /// The fan rule for any polygon against the same closed form, on a rectangle given with a redundant fifth corner.
    #[test]
    fn fan_of_triangles_agrees_with_the_closed_form() {
        let v = Vector2::new;
        let corner = 1e-6; // a fifth corner that moves no area to speak of
        let polygon = ConvexPolygon::new(&[
            v(-0.175, -0.675),
            v(0.175, -0.675),
            v(0.175 + corner, 0.0),
            v(0.175, 0.675),
            v(-0.175, 0.675),
        ])
        .unwrap()
        .centred();
        let surface = LimitSurface::exact(&polygon);
        let LimitSurface::Exact(points) = &surface else { unreachable!() };
        assert!((points.iter().map(|p| p.weight).sum::<f64>() - 1.0).abs() < 1e-12);
        for i in 0..100 {
            let a = f64::from(i) * 0.754_877;
            let twist = Twist2::new(a.sin(), (1.7 * a).cos(), 3.0 * (2.3 * a).sin());
            let (dissipation, _) = rectangle_dissipation(0.35, 1.35, &twist);
            assert!((surface.dissipation(&twist) / dissipation - 1.0).abs() < 0.01);
        }
    }
}
