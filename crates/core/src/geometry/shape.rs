//! Convex polygons with their moments.

use nalgebra::Vector2;

use crate::se2::cross;

/// Why a list of vertices is no convex polygon.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// Fewer than three vertices.
    #[error("a polygon needs at least 3 vertices, got {count}")]
    TooFewVertices {
        /// Vertices given.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {index} is not finite")]
    NotFinite {
        /// Index of the vertex.
        index: usize,
    },
    /// The boundary turns right somewhere (or winds around twice), or two vertices coincide.
    #[error(
        "the polygon is not convex at vertex {index} (vertices must go round once, counter-clockwise or clockwise)"
    )]
    NotConvex {
        /// Index of the vertex, in the order given.
        index: usize,
    },
    /// A side of a rectangle is no length.
    #[error("the rectangle's side along {axis} is {length} m, must be positive")]
    Side {
        /// `x` or `y`.
        axis: char,
        /// Its length, m.
        length: f64,
    },
    /// Nearly no area.
    #[error("the polygon's area {area:.3e} m² is too small (at least 1e-6)")]
    TooSmall {
        /// Area, m².
        area: f64,
    },
}

/// A convex polygon, vertices counter-clockwise, m. Always valid: built only through its checked constructors.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexPolygon {
    vertices: Vec<Vector2<f64>>,
    area: f64,
    centroid: Vector2<f64>,
    second_moment: f64,
}

impl ConvexPolygon {
    /// A convex polygon from its vertices in either sense of rotation.
    ///
    /// # Errors
    /// Too few, non-finite or non-convex vertices, or nearly no area.
    pub fn new(vertices: &[Vector2<f64>]) -> Result<Self, ShapeError> {
        let count = vertices.len();
        if count < 3 {
            return Err(ShapeError::TooFewVertices { count });
        }
        if let Some(index) = vertices.iter().position(|v| !(v.x.is_finite() && v.y.is_finite())) {
            return Err(ShapeError::NotFinite { index });
        }
        let signed: f64 = (0..count).map(|i| cross(&vertices[i], &vertices[(i + 1) % count])).sum::<f64>() / 2.0;
        if signed.abs() < 1e-6 {
            return Err(ShapeError::TooSmall { area: signed.abs() });
        }
        let mut vertices = vertices.to_vec();
        if signed < 0.0 {
            vertices.reverse();
        }
        let original = |i: usize| if signed < 0.0 { count - 1 - i } else { i };
        // every corner turns left, and the edges turn once in all
        let mut turned = 0.0;
        for i in 0..count {
            let before = vertices[i] - vertices[(i + count - 1) % count];
            let after = vertices[(i + 1) % count] - vertices[i];
            let sine = cross(&before, &after);
            if sine.is_nan() || sine <= 1e-12 {
                return Err(ShapeError::NotConvex { index: original(i) });
            }
            turned += sine.atan2(before.dot(&after));
        }
        if turned > 1.5 * std::f64::consts::TAU {
            return Err(ShapeError::NotConvex { index: 0 });
        }
        let mut area = 0.0;
        let mut centroid = Vector2::zeros();
        for i in 0..count {
            let (a, b) = (vertices[i], vertices[(i + 1) % count]);
            let doubled = cross(&a, &b);
            area += doubled / 2.0;
            centroid += (a + b) * (doubled / 6.0);
        }
        centroid /= area;
        // ∫ |r − centroid|² dA over the triangles (centroid, a, b)
        let mut moment = 0.0;
        for i in 0..count {
            let (a, b) = (vertices[i] - centroid, vertices[(i + 1) % count] - centroid);
            moment += cross(&a, &b) * (a.dot(&a) + a.dot(&b) + b.dot(&b)) / 12.0;
        }
        Ok(Self { vertices, area, centroid, second_moment: moment / area })
    }

    /// A rectangle centred on the origin, `along_x` by `along_y` metres.
    ///
    /// # Errors
    /// A side that is not a positive finite number.
    pub fn rectangle(along_x: f64, along_y: f64) -> Result<Self, ShapeError> {
        for (axis, length) in [('x', along_x), ('y', along_y)] {
            if !(length > 0.0 && length.is_finite()) {
                return Err(ShapeError::Side { axis, length });
            }
        }
        let (x, y) = (along_x / 2.0, along_y / 2.0);
        Self::new(&[Vector2::new(-x, -y), Vector2::new(x, -y), Vector2::new(x, y), Vector2::new(-x, y)])
    }

    /// The same polygon with its centroid moved to the origin.
    #[must_use]
    pub fn centred(&self) -> Self {
        let vertices = self.vertices.iter().map(|v| v - self.centroid).collect();
        Self { vertices, centroid: Vector2::zeros(), ..self.clone() }
    }

    /// Vertices, counter-clockwise, m.
    pub fn vertices(&self) -> &[Vector2<f64>] {
        &self.vertices
    }

    /// Edge `index` from vertex `index` to the next, m.
    pub fn edge(&self, index: usize) -> Edge {
        let count = self.vertices.len();
        Edge { start: self.vertices[index % count], end: self.vertices[(index + 1) % count] }
    }

    /// Area, m².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Centre of area, m.
    pub fn centroid(&self) -> Vector2<f64> {
        self.centroid
    }

    /// Mean of the squared distance from the centroid, m²: moment of inertia per kilogram of a uniform prism.
    pub fn second_moment(&self) -> f64 {
        self.second_moment
    }

    /// Lowest and highest coordinate, m.
    pub fn bounds(&self) -> (Vector2<f64>, Vector2<f64>) {
        let mut low = self.vertices[0];
        let mut high = low;
        for v in &self.vertices {
            low = low.inf(v);
            high = high.sup(v);
        }
        (low, high)
    }

    /// Greatest distance of a vertex from the origin, m.
    pub fn radius(&self) -> f64 {
        self.vertices.iter().map(Vector2::norm).fold(0.0, f64::max)
    }
}

/// One edge of a convex polygon, counter-clockwise, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Where it starts.
    pub start: Vector2<f64>,
    /// Where it ends.
    pub end: Vector2<f64>,
}

impl Edge {
    /// Length, m.
    pub fn length(&self) -> f64 {
        (self.end - self.start).norm()
    }

    /// Unit vector from start to end.
    pub fn tangent(&self) -> Vector2<f64> {
        (self.end - self.start) / self.length()
    }

    /// Unit vector into the polygon.
    pub fn inward(&self) -> Vector2<f64> {
        crate::se2::perpendicular(&self.tangent())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_rectangle_are_the_textbook_ones() {
        let polygon = ConvexPolygon::rectangle(0.35, 1.35).unwrap();
        assert!((polygon.area() - 0.35 * 1.35).abs() < 1e-12);
        assert!((polygon.second_moment() - (0.35_f64.powi(2) + 1.35_f64.powi(2)) / 12.0).abs() < 1e-12);
        assert!(polygon.centroid().norm() < 1e-12);
    }

    /// The product of two negative sides is a good area, and once passed for one.
    #[test]
    fn sides_that_are_no_lengths_are_refused() {
        for (x, y) in [(-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (0.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
            assert!(matches!(ConvexPolygon::rectangle(x, y), Err(ShapeError::Side { .. })), "{x} {y}");
        }
    }

    #[test]
    fn either_sense_of_rotation_gives_the_same_polygon_area() {
        let mut vertices = ConvexPolygon::rectangle(1.0, 2.0).unwrap().vertices().to_vec();
        vertices.reverse();
        assert!((ConvexPolygon::new(&vertices).unwrap().area() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn bow_tie_dart_and_pentagram_are_refused() {
        let v = Vector2::new;
        assert!(ConvexPolygon::new(&[v(0.0, 0.0), v(1.0, 1.0), v(1.0, 0.0), v(0.0, 1.5)]).is_err());
        assert!(ConvexPolygon::new(&[v(0.0, 0.0), v(1.0, 1.0), v(0.0, 0.3), v(-1.0, 1.0)]).is_err());
        let star: Vec<_> = (0..5).map(|i| crate::se2::unit(f64::from(i) * 2.0 * std::f64::consts::TAU / 5.0)).collect();
        assert!(matches!(ConvexPolygon::new(&star), Err(ShapeError::NotConvex { .. })));
    }
}
