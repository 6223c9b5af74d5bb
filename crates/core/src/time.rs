//! Instants and spans as whole nanoseconds.
//!
//! The pure crates never read a clock: an instant always arrives as an argument. Whole nanoseconds keep sums exact, so
//! that schedules never drift and logs compare bit for bit.

use serde::{Deserialize, Serialize};

/// An instant, counted in nanoseconds from the start of the episode (simulator) or from an arbitrary origin (robot).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Time(i64);

impl Time {
    /// The origin.
    pub const ZERO: Self = Self(0);

    /// From whole nanoseconds.
    pub const fn from_nanos(nanos: i64) -> Self {
        Self(nanos)
    }

    /// From seconds, rounded to the nearest nanosecond.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * 1e9).round() as i64)
    }

    /// Whole nanoseconds since the origin.
    pub const fn nanos(self) -> i64 {
        self.0
    }

    /// Seconds since the origin.
    pub fn seconds(self) -> f64 {
        self.0 as f64 * 1e-9
    }

    /// Seconds from `earlier` to `self`; negative if `earlier` is later.
    pub fn since(self, earlier: Self) -> f64 {
        self.0.saturating_sub(earlier.0) as f64 * 1e-9
    }

    /// This instant shifted by whole nanoseconds.
    #[must_use]
    pub const fn plus_nanos(self, nanos: i64) -> Self {
        Self(self.0.saturating_add(nanos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_round_to_the_nearest_nanosecond() {
        assert_eq!(Time::from_seconds(0.05).nanos(), 50_000_000);
        assert_eq!(Time::from_seconds(1e-9 * 0.6).nanos(), 1);
    }
}
