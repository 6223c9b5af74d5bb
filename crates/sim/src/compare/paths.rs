//! The ways that loads took in two logs.
//!
//! Two missions pass a place at different times, so the ways are compared where both have covered the same share of their
//! length. A load that turns on the spot covers none: it is compared at the same share of time.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::PathBuf;

use cohaul_core::record::{Header, LogReader, Record};
use cohaul_core::se2::{position, wrap_angle, yaw};
use nalgebra::Vector2;
use serde::Serialize;

use super::{CompareError, Table, number};
use crate::error::SimError;

/// Places at which two ways are compared, their ends included.
const PLACES: usize = 501;

/// A load at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// When, s.
    pub time: f64,
    /// Where its centre is in the world, m.
    pub at: Vector2<f64>,
    /// Its yaw, without jumps, rad.
    pub yaw: f64,
}

/// What a log says about its loads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// What the log says about its run.
    pub header: Header,
    /// The way of each load, by its name.
    pub loads: BTreeMap<String, Vec<Instant>>,
    /// How the mission ended, such as `reached`; `None` if the log does not say.
    pub outcome: Option<String>,
    /// Simulated duration, s.
    pub time_s: f64,
}

impl Track {
    /// Reads a log.
    ///
    /// # Errors
    /// A damaged log.
    pub fn read(input: impl Read) -> Result<Self, SimError> {
        let mut track = Self::default();
        for record in LogReader::new(input) {
            match record? {
                Record::Metadata(header) => track.header = header,
                Record::LoadState(state) => {
                    let name = track.header.loads.get(state.load.index());
                    let name = name.cloned().unwrap_or_else(|| format!("{}", state.load));
                    let way = track.loads.entry(name).or_default();
                    let before = way.last().map_or(0.0, |last: &Instant| last.yaw);
                    let turned = before + wrap_angle(yaw(&state.world_from_load) - before);
                    let time = state.time.seconds();
                    way.push(Instant { time, at: position(&state.world_from_load), yaw: turned });
                    track.time_s = track.time_s.max(time);
                }
                Record::Outcome { time, json } => {
                    track.time_s = time.seconds();
                    let outcome: serde_json::Value = serde_json::from_str(&json).unwrap_or_default();
                    track.outcome = outcome["outcome"].as_str().map(str::to_owned);
                }
                _ => {}
            }
        }
        Ok(track)
    }
}

/// One of two logs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Log {
    /// The file.
    pub log: PathBuf,
    /// Name of the mission.
    pub name: String,
    /// Simulator.
    pub world: String,
    /// Seed.
    pub seed: u64,
    /// How it ended; `None` if the log does not say.
    pub outcome: Option<String>,
    /// Simulated duration, s.
    pub time_s: f64,
}

/// The two ways of a load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Way {
    /// Name of the load.
    pub load: String,
    /// Length in A, m.
    pub path_length_a_m: f64,
    /// Length in B, m.
    pub path_length_b_m: f64,
    /// Root mean square of the distance between the two ways, m.
    pub rms_distance_m: f64,
    /// Largest distance between them, m.
    pub max_distance_m: f64,
    /// Distance between their ends, m.
    pub final_distance_m: f64,
    /// Yaw at the end, B − A, in (−π, π], rad.
    pub final_yaw_difference_rad: f64,
    /// Root mean square of the difference of yaw along the ways, rad.
    pub rms_yaw_difference_rad: f64,
}

/// What two logs say about each other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Paths {
    /// The one log.
    pub a: Log,
    /// The other.
    pub b: Log,
    /// Duration of B over that of A.
    pub time_ratio: f64,
    /// Loads that both have.
    pub loads: Vec<Way>,
    /// Picture, SVG, if one was asked for.
    pub svg: Option<PathBuf>,
    /// The same, PNG.
    pub png: Option<PathBuf>,
}

impl Paths {
    /// Compares two logs, given with their files' names.
    ///
    /// # Errors
    /// No load of the same name in both.
    pub fn of(a: (PathBuf, &Track), b: (PathBuf, &Track)) -> Result<Self, CompareError> {
        let log = |log: PathBuf, track: &Track| Log {
            log,
            name: track.header.scenario_name.clone(),
            world: track.header.world.clone(),
            seed: track.header.seed,
            outcome: track.outcome.clone(),
            time_s: track.time_s,
        };
        let common = a.1.loads.iter().filter_map(|(name, way)| Some((name, way, b.1.loads.get(name)?)));
        let loads: Vec<Way> = common.filter_map(|(name, a, b)| way(name, a, b)).collect();
        if loads.is_empty() {
            let names = |track: &Track| track.loads.keys().cloned().collect::<Vec<_>>().join(", ");
            let reason = format!("no load is in both logs; A has [{}], B has [{}]", names(a.1), names(b.1));
            return Err(CompareError::Nothing(reason));
        }
        let time_ratio = b.1.time_s / a.1.time_s;
        Ok(Self { a: log(a.0, a.1), b: log(b.0, b.1), time_ratio, loads, svg: None, png: None })
    }

    pub(super) fn heading(&self) -> Vec<String> {
        let mut lines = vec![format!("A: {}", self.a.text()), format!("B: {}", self.b.text())];
        lines
            .push("differences are B − A, ratios B / A; ways are compared at equal shares of their lengths".to_owned());
        lines
    }

    pub(super) fn table(&self) -> Table {
        let header = ["load", "quantity", "value"].map(String::from).to_vec();
        let mut rows = vec![row("", "ratio of times", number(self.time_ratio))];
        for way in &self.loads {
            let degrees = |angle: f64| format!("{}°", number(angle.to_degrees()));
            let meters = |length: f64| format!("{} m", number(length));
            rows.extend([
                row(&way.load, "length of the way in A", meters(way.path_length_a_m)),
                row(&way.load, "length of the way in B", meters(way.path_length_b_m)),
                row(&way.load, "distance of the ways, rms", meters(way.rms_distance_m)),
                row(&way.load, "distance of the ways, max", meters(way.max_distance_m)),
                row(&way.load, "distance of their ends", meters(way.final_distance_m)),
                row(&way.load, "difference of yaw, rms", degrees(way.rms_yaw_difference_rad)),
                row(&way.load, "difference of yaw at the end", degrees(way.final_yaw_difference_rad)),
            ]);
        }
        (header, rows)
    }
}

impl Log {
    /// In a few words.
    pub(super) fn text(&self) -> String {
        let end = self.outcome.as_deref().unwrap_or("not finished").replace('_', " ");
        format!("{} ({}, seed {}): {end} after {:.1} s", self.name, self.world, self.seed, self.time_s)
    }
}

fn row(load: &str, quantity: &str, value: String) -> Vec<String> {
    vec![load.to_owned(), quantity.to_owned(), value]
}

/// `None` for a way without an instant.
fn way(name: &str, a: &[Instant], b: &[Instant]) -> Option<Way> {
    let (length_a, length_b) = (length(a), length(b));
    let (resampled_a, resampled_b) = (resampled(a)?, resampled(b)?);
    let pairs = || resampled_a.iter().zip(&resampled_b);
    let distances: Vec<f64> = pairs().map(|(a, b)| (b.at - a.at).norm()).collect();
    let turns: Vec<f64> = pairs().map(|(a, b)| wrap_angle(b.yaw - a.yaw)).collect();
    let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    Some(Way {
        load: name.to_owned(),
        path_length_a_m: length_a,
        path_length_b_m: length_b,
        rms_distance_m: rms(&distances),
        max_distance_m: distances.iter().copied().fold(0.0, f64::max),
        final_distance_m: *distances.last()?,
        final_yaw_difference_rad: *turns.last()?,
        rms_yaw_difference_rad: rms(&turns),
    })
}

fn length(way: &[Instant]) -> f64 {
    way.windows(2).map(|pair| (pair[1].at - pair[0].at).norm()).sum()
}

/// The way at [`PLACES`] equal shares of its length; `None` of none.
fn resampled(way: &[Instant]) -> Option<Vec<Instant>> {
    let (first, last) = (*way.first()?, *way.last()?);
    let all = length(way);
    let mut covered = Vec::with_capacity(way.len());
    let mut sum = 0.0;
    for (index, instant) in way.iter().enumerate() {
        sum += index.checked_sub(1).map_or(0.0, |before| (instant.at - way[before].at).norm());
        let share = if all > 0.0 { sum / all } else { (instant.time - first.time) / (last.time - first.time) };
        covered.push(share);
    }
    let mut below = 0;
    let mut places = Vec::with_capacity(PLACES);
    for place in 0..PLACES {
        let share = place as f64 / (PLACES - 1) as f64;
        while below + 1 < way.len() && covered[below + 1] < share {
            below += 1;
        }
        let (a, b) = (way[below], way[(below + 1).min(way.len() - 1)]);
        let step = covered[(below + 1).min(way.len() - 1)] - covered[below];
        let part = if step > 0.0 { ((share - covered[below]) / step).clamp(0.0, 1.0) } else { 0.0 };
        let between = |a: f64, b: f64| a + part * (b - a);
        places.push(Instant { time: between(a.time, b.time), at: a.at.lerp(&b.at, part), yaw: between(a.yaw, b.yaw) });
    }
    // the end is the end, turns on the spot there included
    if let Some(end) = places.last_mut() {
        *end = last;
    }
    Some(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64, f64, f64)]) -> Vec<Instant> {
        points.iter().map(|&(time, x, y, yaw)| Instant { time, at: Vector2::new(x, y), yaw }).collect()
    }

    /// Two parallel lines 0.3 m apart, driven at different speeds and looked at at different instants.
    #[test]
    fn parallel_ways_keep_their_distance() {
        let a = line(&[(0.0, 0.0, 0.0, 0.0), (1.0, 0.5, 0.0, 0.0), (9.0, 2.0, 0.0, 0.2)]);
        let b = line(&[(0.0, 0.0, 0.3, 0.0), (5.0, 2.0, 0.3, 0.2)]);
        let way = way("load", &a, &b).unwrap();
        assert!((way.rms_distance_m - 0.3).abs() < 1e-12 && (way.max_distance_m - 0.3).abs() < 1e-12, "{way:?}");
        assert!((way.path_length_a_m - 2.0).abs() < 1e-12);
        assert_eq!(way.final_yaw_difference_rad, 0.0);
        // B has turned by u/10 at u m; A by nothing until 0.5 m, then by (u − 0.5)/7.5: the mean square difference is
        // (∫₀^½ (u/10)² du + ∫_½² (u/10 − (u − ½)/7.5)² du) / 2 = (1/2400 + 1/800) / 2
        let exact = ((1.0 / 2400.0 + 1.0 / 800.0) / 2.0_f64).sqrt();
        // the sum over 501 places differs from the integral by a share of their order
        assert!((way.rms_yaw_difference_rad / exact - 1.0).abs() < 0.01, "{} {exact}", way.rms_yaw_difference_rad);
    }

    #[test]
    fn turns_on_the_spot_are_compared_over_time() {
        let a = line(&[(0.0, 1.0, 1.0, 0.0), (4.0, 1.0, 1.0, 3.0)]);
        let b = line(&[(0.0, 1.0, 1.0, 0.0), (8.0, 1.0, 1.0, 3.5)]);
        let way = way("load", &a, &b).unwrap();
        assert_eq!((way.rms_distance_m, way.path_length_a_m), (0.0, 0.0));
        assert!((way.final_yaw_difference_rad - 0.5).abs() < 1e-12);
        // ∫₀¹ (s/2)² ds = 1/12
        assert!((way.rms_yaw_difference_rad - (1.0_f64 / 12.0).sqrt()).abs() < 1e-3);
    }

    #[test]
    fn a_way_of_one_instant_is_a_place() {
        let a = line(&[(0.0, 1.0, 1.0, 0.0)]);
        let b = line(&[(0.0, 1.0, 2.0, 6.5)]);
        let way = way("load", &a, &b).unwrap();
        assert!((way.rms_distance_m - 1.0).abs() < 1e-12);
        assert!((way.final_yaw_difference_rad - (6.5 - std::f64::consts::TAU)).abs() < 1e-12);
        assert!(super::way("load", &a, &[]).is_none());
    }
}
