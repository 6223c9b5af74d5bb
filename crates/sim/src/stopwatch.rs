//! The edge: how long the computation takes. Results never depend on it.
#![expect(
    clippy::disallowed_methods,
    reason = "the only clock of this crate; it measures the program, not the mission"
)]

use std::time::Instant;

use cpu_time::ProcessTime;

/// Measures wall and CPU time.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    wall: Instant,
    cpu: ProcessTime,
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self { wall: Instant::now(), cpu: ProcessTime::now() }
    }

    /// CPU time of the process since it began, s.
    pub fn process_seconds() -> f64 {
        ProcessTime::now().as_duration().as_secs_f64()
    }

    /// CPU and wall time since the start, s.
    pub fn seconds(&self) -> (f64, f64) {
        (self.cpu.elapsed().as_secs_f64(), self.wall.elapsed().as_secs_f64())
    }
}
