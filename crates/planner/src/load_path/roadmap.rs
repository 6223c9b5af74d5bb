//! Points that a path may turn at: beside corners, through gaps, on a grid.

use cohaul_core::se2::{perpendicular, unit};
use nalgebra::Vector2;

use super::body::distance_to_polygon;
use super::task::{Obstacle, Task};
use crate::search::{Budget, Spent};

/// Distance by which points keep off the closest place that is allowed, m.
const SLACK: f64 = 0.01;
/// Largest turn around a corner between two points beside it, rad.
const FACET: f64 = std::f64::consts::FRAC_PI_3;
/// Grids are made coarser rather than larger than this.
const GRID: f64 = 800.0;
/// Distances within which the nearest points of two obstacles count as one, m.
const SAME: f64 = 1e-6;

/// Points of the plane; the first is the start, the second the goal.
#[derive(Clone, Debug)]
pub(super) struct Roadmap {
    pub points: Vec<Vector2<f64>>,
    /// How many of them do not come from a grid.
    special: usize,
    /// Distance of neighbours on the grid, m; infinite without one.
    step: f64,
}

impl Roadmap {
    /// Start, goal, points beside corners and through gaps; with `spacing` (m) also a grid.
    ///
    /// # Errors
    /// A spent budget.
    pub fn new(task: &Task, spacing: Option<f64>, budget: &Budget<'_>) -> Result<Self, Spent> {
        let mut points = vec![task.start, task.goal];
        let wide = task.body.reach + task.margin + SLACK;
        let narrow = task.body.half_width().min(task.body.reach) + task.margin + SLACK;
        for obstacle in &task.obstacles {
            corners(&obstacle.corners, wide, &mut points);
            if wide - narrow > 5.0 * SLACK {
                corners(&obstacle.corners, narrow, &mut points);
            }
        }
        gaps(task, wide, &mut points, budget)?;
        let work = 1 + task.obstacles.len() as u64 / 8;
        let mut kept = points[..2].to_vec();
        for point in &points[2..] {
            budget.spend(work)?;
            if may_stand(task, point) {
                kept.push(*point);
            }
        }
        let special = kept.len();
        let mut step = f64::INFINITY;
        if let Some(spacing) = spacing {
            let (low, high) = extent(task);
            let size = high - low;
            step = spacing.max((size.x * size.y / GRID).sqrt());
            let (columns, rows) = ((size.x / step) as usize, (size.y / step) as usize);
            for row in 0..=rows {
                budget.spend(work * columns as u64)?;
                for column in 0..=columns {
                    let point = low + step * Vector2::new(column as f64, row as f64);
                    if may_stand(task, &point) {
                        kept.push(point);
                    }
                }
            }
        }
        Ok(Self { points: kept, special, step })
    }

    /// Longest leg tried between two points, m: on the grid many short ones do for a long one.
    pub fn longest_leg(&self, from: usize, to: usize) -> f64 {
        match (from >= self.special, to >= self.special) {
            (false, false) => f64::INFINITY,
            (true, true) => 3.0 * self.step,
            _ => 8.0 * self.step,
        }
    }
}

/// Whether the body's inner disc has room at `point`.
pub(super) fn may_stand(task: &Task, point: &Vector2<f64>) -> bool {
    let needed = task.body.inner + task.margin;
    let clear =
        |o: &Obstacle| o.least_distance(point, point) >= needed || distance_to_polygon(point, &o.corners) >= needed;
    task.is_inside(point) && task.obstacles.iter().all(clear)
}

/// The rectangle that paths are sought in: where the load may be, or else start, goal and obstacles with room around.
pub(super) fn extent(task: &Task) -> (Vector2<f64>, Vector2<f64>) {
    if let Some(region) = task.region {
        return region;
    }
    let mut low = task.start.inf(&task.goal);
    let mut high = task.start.sup(&task.goal);
    for corner in task.obstacles.iter().flat_map(|o| &o.corners) {
        low = low.inf(corner);
        high = high.sup(corner);
    }
    let room = 2.0 * (task.body.reach + task.margin);
    (low.add_scalar(-room), high.add_scalar(room))
}

/// Corners of a polygon drawn around the obstacle's, `distance` m from it.
fn corners(polygon: &[Vector2<f64>], distance: f64, points: &mut Vec<Vector2<f64>>) {
    let count = polygon.len();
    for i in 0..count {
        let before = polygon[i] - polygon[(i + count - 1) % count];
        let after = polygon[(i + 1) % count] - polygon[i];
        let first = (-before.x).atan2(before.y);
        let turn = (before.x * after.y - before.y * after.x).atan2(before.dot(&after));
        let facets = (turn / FACET).ceil().max(1.0);
        let step = turn / facets;
        // the outward normal turns from that of one edge to that of the next
        for k in 0..facets as usize {
            points.push(polygon[i] + distance / (step / 2.0).cos() * unit(first + step * (k as f64 + 0.5)));
        }
    }
}

/// Middle and both sides of every gap too narrow to turn in.
fn gaps(task: &Task, wide: f64, points: &mut Vec<Vector2<f64>>, budget: &Budget<'_>) -> Result<(), Spent> {
    let narrowest = 2.0 * (task.body.inner + task.margin);
    for (i, first) in task.obstacles.iter().enumerate() {
        budget.spend(1 + i as u64 / 8)?;
        for second in task.obstacles[..i].iter().filter(|second| first.least_distance_of(second) <= 2.0 * wide + SLACK)
        {
            budget.spend((first.corners.len() * second.corners.len()) as u64 / 32)?;
            for (a, b) in nearest(&first.corners, &second.corners) {
                let across = b - a;
                let gap = across.norm();
                if gap < narrowest || gap > 2.0 * wide + SLACK {
                    continue;
                }
                let middle = (a + b) / 2.0;
                let along = perpendicular(&across) / gap;
                points.push(middle);
                points.extend([-1.5, -1.0, 1.0, 1.5].map(|share| middle + share * wide * along));
            }
        }
    }
    Ok(())
}

/// The nearest pairs of points of two polygons that do not overlap: several where edges are parallel.
fn nearest(first: &[Vector2<f64>], second: &[Vector2<f64>]) -> Vec<(Vector2<f64>, Vector2<f64>)> {
    let mut pairs = Vec::new();
    let mut least = f64::INFINITY;
    for (polygon, other, swapped) in [(first, second, false), (second, first, true)] {
        for corner in polygon {
            for (i, start) in other.iter().enumerate() {
                let edge = other[(i + 1) % other.len()] - start;
                let share = ((corner - start).dot(&edge) / edge.norm_squared().max(SAME)).clamp(0.0, 1.0);
                let foot = start + share * edge;
                let distance = (foot - corner).norm();
                if distance > least + SAME {
                    continue;
                }
                if distance < least - SAME {
                    pairs.clear();
                }
                least = least.min(distance);
                pairs.push(if swapped { (foot, *corner) } else { (*corner, foot) });
            }
        }
    }
    pairs.dedup_by(|a, b| (a.0 - b.0).norm() < SAME && (a.1 - b.1).norm() < SAME);
    pairs
}
