//! Curves of at most five segments, each of constant curvature.

use std::f64::consts::{PI, TAU};

/// What a segment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steer {
    /// Straight.
    Straight,
    /// An arc of the turning radius to the left.
    Left,
    /// An arc of the turning radius to the right.
    Right,
    /// A turn in place, positive counter-clockwise.
    Spin,
}

/// One piece of a curve. Lengths are in units of the turning radius, so that an arc's length is its angle; negative is
/// backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// What it is.
    pub steer: Steer,
    /// How long, in turning radii or radians.
    pub length: f64,
}

/// A pose in units of the turning radius, as numbers that need no trigonometry to use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position in x.
    pub x: f64,
    /// Position in y.
    pub y: f64,
    /// Heading, not wrapped.
    pub yaw: f64,
    /// Its cosine.
    pub cos: f64,
    /// Its sine.
    pub sin: f64,
}

impl Place {
    /// The pose (x, y, yaw).
    pub fn new(x: f64, y: f64, yaw: f64) -> Self {
        let (sin, cos) = yaw.sin_cos();
        Self { x, y, yaw, cos, sin }
    }

    /// Where `segment` leads from here.
    pub fn after(&self, segment: Segment) -> Self {
        self.moved(segment, segment.length.sin_cos())
    }

    /// The same where the sine and cosine of the segment's length are known.
    #[inline]
    pub fn moved(&self, segment: Segment, (sin, cos): (f64, f64)) -> Self {
        let length = segment.length;
        // along, across, turned; body frame
        let (ahead, left, turn) = match segment.steer {
            Steer::Straight => (length, 0.0, 0.0),
            Steer::Left => (sin, 1.0 - cos, length),
            Steer::Right => (sin, cos - 1.0, -length),
            Steer::Spin => (0.0, 0.0, length),
        };
        let (c, s) = match segment.steer {
            Steer::Straight => (self.cos, self.sin),
            Steer::Left | Steer::Spin => (self.cos * cos - self.sin * sin, self.sin * cos + self.cos * sin),
            Steer::Right => (self.cos * cos + self.sin * sin, self.sin * cos - self.cos * sin),
        };
        Self {
            x: self.x + self.cos * ahead - self.sin * left,
            y: self.y + self.sin * ahead + self.cos * left,
            yaw: self.yaw + turn,
            cos: c,
            sin: s,
        }
    }

    /// `other` as seen from here: x ahead, y to the left, heading within (−π, π].
    #[inline]
    pub fn towards(&self, other: &Self) -> (f64, f64, f64) {
        let (dx, dy) = (other.x - self.x, other.y - self.y);
        (self.cos * dx + self.sin * dy, self.cos * dy - self.sin * dx, wrap(other.yaw - self.yaw))
    }
}

/// `angle` within (−π, π].
#[inline]
pub fn wrap(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    if angle > PI && angle <= 3.0 * PI {
        return angle - TAU;
    }
    if angle <= -PI && angle > -3.0 * PI {
        return angle + TAU;
    }
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

/// At most five segments in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    segments: [Segment; 5],
    count: u8,
    length: f64,
}

impl Curve {
    /// A curve of `segments`; those beyond the fifth are left out, and so are those of no length.
    pub fn new(segments: &[Segment]) -> Self {
        let mut curve = Self { segments: [Segment { steer: Steer::Straight, length: 0.0 }; 5], count: 0, length: 0.0 };
        for segment in segments.iter().filter(|segment| segment.length.abs() > 1e-12).take(5) {
            curve.segments[usize::from(curve.count)] = *segment;
            curve.count += 1;
            curve.length += segment.length.abs();
        }
        curve
    }

    /// The segments.
    pub fn segments(&self) -> &[Segment] {
        &self.segments[..usize::from(self.count)]
    }

    /// Sum of the segments' lengths, in turning radii.
    pub const fn length(&self) -> f64 {
        self.length
    }

    /// Where it leads from `start`.
    pub fn end(&self, start: &Place) -> Place {
        self.segments().iter().fold(*start, |place, segment| place.after(*segment))
    }
}
