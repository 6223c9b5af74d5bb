//! The moving body as one convex polygon, and exact tests of its sweeps against convex obstacles.

use std::f64::consts::TAU;

use cohaul_core::geometry::shape::ConvexPolygon;
use cohaul_core::se2::{cross, rotate, unit};
use nalgebra::Vector2;

/// Corners of the polygon drawn around the disc of a robot: 4 % of its radius beyond it at the corners.
const DISC: usize = 12;
/// Classes of headings in which turns are tested.
pub(super) const CLASSES: usize = 72;
/// Width of such a class, rad.
pub(super) const CLASS: f64 = TAU / CLASSES as f64;

/// Load and robots in their slots.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Farthest corner from the load's centre, m.
    pub reach: f64,
    /// Nearest edge to it, m.
    pub inner: f64,
    /// Hull over all headings within the spread of a translation, load frame.
    fan: Vec<Vector2<f64>>,
    /// The same over each class of headings, world axes.
    classes: Vec<Vec<Vector2<f64>>>,
}

impl Body {
    /// The hull of `load` and of discs of `radius` m at `robots` (load frame), which translates with headings up to `spread`
    /// rad off its direction.
    pub fn new(load: &ConvexPolygon, robots: &[Vector2<f64>], radius: f64, spread: f64) -> Self {
        let mut points = load.vertices().to_vec();
        let circumscribed = radius / (TAU / 2.0 / DISC as f64).cos();
        for robot in robots {
            points.extend((0..DISC).map(|k| robot + circumscribed * unit(TAU * k as f64 / DISC as f64)));
        }
        let hull = hull(points);
        let reach = hull.iter().map(Vector2::norm).fold(0.0, f64::max);
        let inner = (0..hull.len())
            .map(|i| distance_to_segment(&Vector2::zeros(), &hull[i], &hull[(i + 1) % hull.len()]))
            .fold(f64::INFINITY, f64::min);
        let class = turned(&hull, CLASS / 2.0);
        let classes = (0..CLASSES)
            .map(|k| {
                let (sin, cos) = (CLASS * k as f64).sin_cos();
                class.iter().map(|v| rotate(v, sin, cos)).collect()
            })
            .collect();
        Self { reach, inner, fan: turned(&hull, spread), classes }
    }

    /// Half the width that the body takes while it translates: across its heading, spread included, m.
    pub fn half_width(&self) -> f64 {
        self.fan.iter().map(|v| v.y.abs()).fold(0.0, f64::max)
    }

    /// All that the body takes at `at` with headings of class `class`.
    pub fn standing(&self, at: &Vector2<f64>, class: usize) -> Vec<Vector2<f64>> {
        self.classes[class % CLASSES].iter().map(|v| v + at).collect()
    }

    /// All that it takes on the straight line `from`–`to`, turned by `heading` and up to the spread off.
    pub fn passing(&self, from: &Vector2<f64>, to: &Vector2<f64>, heading: f64) -> Vec<Vector2<f64>> {
        let (sin, cos) = heading.sin_cos();
        let first: Vec<Vector2<f64>> = self.fan.iter().map(|v| rotate(v, sin, cos) + from).collect();
        let mut second = Vec::new();
        sweep(&first, &(to - from), &mut second);
        second
    }

    /// Whether the body keeps `margin` m from `obstacle` with its centre at `at`, for every heading of class `class`.
    pub fn stands(
        &self,
        at: &Vector2<f64>,
        class: usize,
        obstacle: &[Vector2<f64>],
        margin: f64,
        room: &mut Room,
    ) -> bool {
        room.first.clear();
        room.first.extend(self.classes[class % CLASSES].iter().map(|v| v + at));
        are_apart(&room.first, obstacle, margin)
    }

    /// Whether it keeps it on the straight line `from`–`to`, turned by `heading` and up to the spread off.
    pub fn passes(
        &self,
        from: &Vector2<f64>,
        to: &Vector2<f64>,
        heading: f64,
        obstacle: &[Vector2<f64>],
        margin: f64,
        room: &mut Room,
    ) -> bool {
        let Room { first, second } = room;
        let (sin, cos) = heading.sin_cos();
        first.clear();
        first.extend(self.fan.iter().map(|v| rotate(v, sin, cos) + from));
        sweep(first, &(to - from), second);
        are_apart(second, obstacle, margin)
    }
}

/// Buffers that tests share.
#[derive(Default)]
pub(super) struct Room {
    first: Vec<Vector2<f64>>,
    second: Vec<Vector2<f64>>,
}

/// The class of a heading.
pub(super) fn class_of(heading: f64) -> usize {
    ((heading / CLASS).round().rem_euclid(CLASSES as f64)) as usize % CLASSES
}

/// Pieces of the line drawn around the arc of a corner.
const PIECES: usize = 3;

/// A polygon around all turns of `polygon` about the origin by up to `angle` (below a quarter turn) either way: each corner's
/// arc lies between its chord and the tangents at its ends and in between.
fn turned(polygon: &[Vector2<f64>], angle: f64) -> Vec<Vector2<f64>> {
    let half = angle / PIECES as f64;
    let outer = 1.0 / half.cos();
    let mut points = Vec::with_capacity(polygon.len() * (PIECES + 2));
    for v in polygon {
        for end in [-angle, angle] {
            points.push(rotate(v, end.sin(), end.cos()));
        }
        for k in 0..PIECES {
            let between = (2 * k + 1) as f64 * half - angle;
            points.push(outer * rotate(v, between.sin(), between.cos()));
        }
    }
    hull(points)
}

/// Convex hull, counter-clockwise, without points on its edges (Andrew's monotone chain).
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup_by(|a, b| (*a - *b).norm() < 1e-9);
    let mut chain: Vec<Vector2<f64>> = Vec::with_capacity(points.len() + 1);
    let mut floor = 0;
    for pass in 0..2 {
        for k in 0..points.len() {
            let point = if pass == 0 { points[k] } else { points[points.len() - 1 - k] };
            while chain.len() >= floor + 2
                && cross(&(chain[chain.len() - 1] - chain[chain.len() - 2]), &(point - chain[chain.len() - 1])) <= 1e-12
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        floor = chain.len();
    }
    chain
}

/// The convex polygon swept over `way`, into `swept`.
fn sweep(polygon: &[Vector2<f64>], way: &Vector2<f64>, swept: &mut Vec<Vector2<f64>>) {
    swept.clear();
    let count = polygon.len();
    // an edge is in front if the way leads out through it: its outward normal is the tangent turned clockwise
    let front = |i: usize| cross(way, &(polygon[(i + 1) % count] - polygon[i % count])) > 0.0;
    let mut before = front(count - 1);
    for (i, corner) in polygon.iter().enumerate() {
        let after = front(i);
        match (before, after) {
            (false, false) => swept.push(*corner),
            (true, true) => swept.push(corner + way),
            (false, true) => swept.extend([*corner, corner + way]),
            (true, false) => swept.extend([corner + way, *corner]),
        }
        before = after;
    }
}

/// Distance of a point from a segment, m.
pub(super) fn distance_to_segment(point: &Vector2<f64>, start: &Vector2<f64>, end: &Vector2<f64>) -> f64 {
    let along = end - start;
    let length = along.norm_squared();
    let share = if length > 0.0 { ((point - start).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (point - start - share * along).norm()
}

/// Distance of a point from a convex polygon, m; 0 inside.
pub(super) fn distance_to_polygon(point: &Vector2<f64>, polygon: &[Vector2<f64>]) -> f64 {
    let mut inside = true;
    let mut distance = f64::INFINITY;
    for (i, start) in polygon.iter().enumerate() {
        let end = &polygon[(i + 1) % polygon.len()];
        inside &= cross(&(end - start), &(point - start)) >= 0.0;
        distance = distance.min(distance_to_segment(point, start, end));
    }
    if inside { 0.0 } else { distance }
}

/// Distance of a point from a convex polygon, m; negative inside, by how deep.
pub(super) fn signed_distance(point: &Vector2<f64>, polygon: &[Vector2<f64>]) -> f64 {
    let outside = distance_to_polygon(point, polygon);
    if outside > 0.0 { outside } else { beyond(polygon, std::slice::from_ref(point)) }
}

/// Whether two convex polygons, counter-clockwise, are at least `margin` apart.
fn are_apart(first: &[Vector2<f64>], second: &[Vector2<f64>], margin: f64) -> bool {
    // beyond an edge's line by the margin is enough, and the rule; beyond none of them the two overlap
    let (near, far) = (beyond(first, second), beyond(second, first));
    let separation = near.max(far);
    if separation >= margin {
        return true;
    }
    if separation <= 0.0 {
        return false;
    }
    corners_apart(first, second, margin) && corners_apart(second, first, margin)
}

/// How far `other` lies beyond the edge of `polygon` that it is farthest beyond, m; not positive if beyond none.
fn beyond(polygon: &[Vector2<f64>], other: &[Vector2<f64>]) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for (i, start) in polygon.iter().enumerate() {
        let edge = polygon[(i + 1) % polygon.len()] - start;
        let length = edge.norm();
        if length > 1e-9 {
            let least = other.iter().map(|point| -cross(&edge, &(point - start))).fold(f64::INFINITY, f64::min);
            most = most.max(least / length);
        }
    }
    most
}

/// Whether every corner of `points` is `margin` away from every edge of `polygon`.
fn corners_apart(points: &[Vector2<f64>], polygon: &[Vector2<f64>], margin: f64) -> bool {
    (0..polygon.len()).all(|i| {
        let (start, end) = (&polygon[i], &polygon[(i + 1) % polygon.len()]);
        points.iter().all(|point| distance_to_segment(point, start, end) >= margin)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, half: f64) -> Vec<Vector2<f64>> {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(a, b)| Vector2::new(x + half * a, y + half * b))
            .into()
    }

    #[test]
    fn apart_is_measured_from_faces_and_corners() {
        let first = square(0.0, 0.0, 1.0);
        // 3-4-5 between two corners
        let second = square(2.3, 2.4, 1.0);
        assert!(are_apart(&first, &second, 0.4999) && !are_apart(&first, &second, 0.5001));
        let beside = square(2.2, 0.5, 1.0);
        assert!(are_apart(&first, &beside, 0.1999) && !are_apart(&first, &beside, 0.2001));
        assert!(!are_apart(&first, &square(0.1, 0.0, 0.2), 0.0));
    }

    #[test]
    fn a_sweep_is_the_hull_of_its_ends() {
        let mut swept = Vec::new();
        for way in [Vector2::new(3.0, 0.0), Vector2::new(-1.0, 2.0), Vector2::zeros()] {
            let polygon = square(0.2, -0.1, 0.5);
            sweep(&polygon, &way, &mut swept);
            let expected = hull(polygon.iter().flat_map(|v| [*v, v + way]).collect());
            let area =
                |p: &[Vector2<f64>]| (0..p.len()).map(|i| cross(&p[i], &p[(i + 1) % p.len()])).sum::<f64>() / 2.0;
            assert!((area(&swept) - area(&expected)).abs() < 1e-12);
        }
    }

    /// A disc of one robot around a small load: whatever the heading, it needs its radius, up to the polygon drawn around.
    #[test]
    fn a_round_body_needs_the_same_room_in_every_direction() {
        let load = ConvexPolygon::rectangle(0.02, 0.02).unwrap();
        let body = Body::new(&load, &[Vector2::zeros()], 0.1, 0.2);
        let mut room = Room::default();
        let wall = square(1.0, 0.0, 0.5);
        for k in 0..CLASSES {
            let at = |gap: f64| Vector2::new(0.5 - 0.1 - gap, 0.2);
            assert!(body.stands(&at(0.006), k, &wall, 0.0, &mut room));
            assert!(!body.stands(&at(-0.001), k, &wall, 0.0, &mut room));
        }
        let along = |y: f64| (Vector2::new(-1.0, y), Vector2::new(3.0, y));
        let (from, to) = along(0.62);
        assert!(body.passes(&from, &to, 0.0, &wall, 0.01, &mut room));
        let (from, to) = along(0.59);
        assert!(!body.passes(&from, &to, 0.0, &wall, 0.0, &mut room));
    }
}
