//! Distances between shapes. The only file that speaks parry and its vectors.

use nalgebra::Vector2;
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query::details::distance_support_map_support_map;
use parry2d_f64::shape::ConvexPolygon as Convex;

use super::shape::ConvexPolygon;
use crate::se2::{Pose2, position, yaw};

/// Distance between a polygon and a circle, m; negative by how far the circle's body reaches into the polygon.
///
/// `center` (world) and `radius` are in m.
///
/// ```
/// # use cohaul_core::{geometry::{query::distance_polygon_circle, shape::ConvexPolygon}, se2::pose};
/// # use nalgebra::Vector2;
/// let square = ConvexPolygon::rectangle(2.0, 2.0)?;
/// let distance = distance_polygon_circle(&square, &pose(1.0, 0.0, 0.0), &Vector2::new(3.0, 0.0), 0.25);
/// assert!((distance - 0.75).abs() < 1e-12);
/// # Ok::<(), cohaul_core::geometry::shape::ShapeError>(())
/// ```
pub fn distance_polygon_circle(
    polygon: &ConvexPolygon,
    world_from_polygon: &Pose2,
    center: &Vector2<f64>,
    radius: f64,
) -> f64 {
    let point = (world_from_polygon.inverse() * nalgebra::Point2::from(*center)).coords;
    let mut outside = f64::INFINITY; // from the nearest edge
    let mut inside = f64::NEG_INFINITY; // beyond the nearest edge's line; positive outside
    for i in 0..polygon.vertices().len() {
        let edge = polygon.edge(i);
        let from_start = point - edge.start;
        let along = from_start.dot(&edge.tangent()).clamp(0.0, edge.length());
        outside = outside.min((from_start - along * edge.tangent()).norm());
        inside = inside.max(-from_start.dot(&edge.inward()));
    }
    (if inside < 0.0 { inside } else { outside }) - radius
}

/// Distance between two polygons, m; 0 if they touch or overlap.
pub fn distance_polygons(
    first: &ConvexPolygon,
    world_from_first: &Pose2,
    second: &ConvexPolygon,
    world_from_second: &Pose2,
) -> f64 {
    let first_from_second = world_from_first.inverse() * world_from_second;
    match (convex(first), convex(second)) {
        (Some(first), Some(second)) => {
            distance_support_map_support_map(&parry_pose(&first_from_second), &first, &second)
        }
        _ => position(&first_from_second).norm() - first.radius() - second.radius(),
    }
}

fn parry_pose(pose: &Pose2) -> Pose {
    let at = position(pose);
    Pose::new(Vector::new(at.x, at.y), yaw(pose))
}

/// `None` for no valid polygon: parry refuses only what `ConvexPolygon` refuses.
fn convex(polygon: &ConvexPolygon) -> Option<Convex> {
    let points = polygon.vertices().iter().map(|v| Vector::new(v.x, v.y)).collect();
    Convex::from_convex_polyline_unmodified(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::se2::pose;

    #[test]
    fn circle_distances_are_those_of_face_corner_and_inside() {
        let plate = ConvexPolygon::rectangle(0.4, 1.2).unwrap();
        let world_from_plate = pose(1.0, 2.0, std::f64::consts::FRAC_PI_2); // lies along x now
        let distance = |x, y| distance_polygon_circle(&plate, &world_from_plate, &Vector2::new(x, y), 0.1);
        assert!((distance(1.0, 2.5) - 0.2).abs() < 1e-12);
        assert!((distance(1.9, 2.6) - 0.4).abs() < 1e-12); // 3-4-5 from the corner (1.6, 2.2)
        assert!((distance(1.0, 2.05) + 0.25).abs() < 1e-12);
    }

    #[test]
    fn polygon_distances_are_those_of_the_gap() {
        let square = ConvexPolygon::rectangle(1.0, 1.0).unwrap();
        let at = |x, y, yaw| distance_polygons(&square, &pose(0.0, 0.0, 0.0), &square, &pose(x, y, yaw));
        assert!((at(1.3, 0.2, 0.0) - 0.3).abs() < 1e-9);
        // a corner turned towards the face
        let reach = std::f64::consts::FRAC_1_SQRT_2;
        assert!((at(0.5 + reach + 0.1, 0.0, std::f64::consts::FRAC_PI_4) - 0.1).abs() < 1e-9);
        assert_eq!(at(0.9, 0.9, 0.0), 0.0);
        assert_eq!(at(0.0, 0.0, 0.0), 0.0);
    }
}
