//! How robots come to know poses: a shared measuring system with rate, noise and latency, and a radio that loses samples.
//!
//! One system measures every body at once, as motion capture does; its noise is the same for all who receive a sample.
//! Reception fails for each robot independently.

use std::collections::VecDeque;

use cohaul_core::control::filter::{FilterModel, PoseFilter};
use cohaul_core::id::{LoadId, RobotId};
use cohaul_core::scenario::document::Sensors;
use cohaul_core::se2::{Pose2, Twist2};
use cohaul_core::time::Time;
use nalgebra::{UnitComplex, Vector2};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::world::World;

/// Accelerations that the robots' filters expect of robots and loads, m/s² and rad/s².
const ROBOT_AGILITY: (f64, f64) = (1.0, 4.0);
const LOAD_AGILITY: (f64, f64) = (0.5, 1.0);

/// What one robot has received last.
#[derive(Clone, Copy, Debug)]
pub struct Received {
    /// When the poses were measured.
    pub sampled: Time,
    /// Pose of the robot.
    pub world_from_robot: Pose2,
    /// Pose of its load.
    pub world_from_load: Pose2,
    /// Velocity of the load's centre, world frame.
    pub load_twist_in_world: Twist2,
}

struct Sample {
    sampled: Time,
    arrives: Time,
    loads: Vec<Pose2>,
    robots: Vec<Pose2>,
    received: Vec<bool>,
}

struct Receiver {
    load: LoadId,
    latest: Received,
    load_filter: PoseFilter,
    robot_filter: PoseFilter,
}

/// The measuring system and every robot's receiver.
pub struct SensorSystem {
    settings: Sensors,
    period_nanos: i64,
    latency_nanos: i64,
    next: Time,
    random: ChaCha8Rng,
    loads: usize,
    on_the_way: VecDeque<Sample>,
    spare: Vec<Sample>,
    receivers: Vec<Receiver>,
}

impl SensorSystem {
    /// Starts measuring `world` at its first instant; `loads_of` names the load of each robot.
    ///
    /// Every robot begins with one sound sample; the later ones come at the set rate with a random phase.
    pub fn new(
        settings: Sensors,
        world: &dyn World,
        loads: usize,
        loads_of: &[LoadId],
        mut random: ChaCha8Rng,
    ) -> Self {
        let period_nanos = (1e9 / settings.rate_hz).round() as i64;
        let receivers = loads_of
            .iter()
            .enumerate()
            .map(|(robot, load)| {
                let latest = Received {
                    sampled: Time::ZERO,
                    world_from_robot: world.robot_pose(RobotId(robot as u16)),
                    world_from_load: world.load_pose(*load),
                    load_twist_in_world: Twist2::ZERO,
                };
                let mut load_filter = PoseFilter::new(model(&settings, LOAD_AGILITY));
                load_filter.update(Time::ZERO, &latest.world_from_load);
                let mut robot_filter = PoseFilter::new(model(&settings, ROBOT_AGILITY));
                robot_filter.update(Time::ZERO, &latest.world_from_robot);
                Receiver { load: *load, latest, load_filter, robot_filter }
            })
            .collect();
        let phase: f64 = random.random();
        Self {
            settings,
            period_nanos,
            latency_nanos: (settings.latency * 1e9).round() as i64,
            next: Time::from_nanos((phase * period_nanos as f64) as i64),
            random,
            loads,
            on_the_way: VecDeque::new(),
            spare: Vec::new(),
            receivers,
        }
    }

    /// Measures if it is time, and delivers what has arrived.
    pub fn advance(&mut self, world: &dyn World) {
        let now = world.time();
        if now >= self.next {
            self.next = self.next.plus_nanos(self.period_nanos);
            let sample = self.measure(now, world);
            self.on_the_way.push_back(sample);
        }
        while self.on_the_way.front().is_some_and(|sample| sample.arrives <= now) {
            let Some(sample) = self.on_the_way.pop_front() else { break };
            for (robot, receiver) in self.receivers.iter_mut().enumerate() {
                if sample.received[robot] {
                    let load = sample.loads[receiver.load.index()];
                    receiver.load_filter.update(sample.sampled, &load);
                    receiver.robot_filter.update(sample.sampled, &sample.robots[robot]);
                    receiver.latest = Received {
                        sampled: sample.sampled,
                        world_from_robot: receiver.robot_filter.pose().unwrap_or(sample.robots[robot]),
                        world_from_load: receiver.load_filter.pose().unwrap_or(load),
                        load_twist_in_world: receiver.load_filter.twist_in_world(),
                    };
                }
            }
            self.spare.push(sample);
        }
    }

    /// What `robot` knows.
    pub fn received(&self, robot: RobotId) -> &Received {
        &self.receivers[robot.index()].latest
    }

    fn measure(&mut self, now: Time, world: &dyn World) -> Sample {
        let robots = self.receivers.len();
        let mut sample = self.spare.pop().unwrap_or_else(|| Sample {
            sampled: now,
            arrives: now,
            loads: Vec::with_capacity(self.loads),
            robots: Vec::with_capacity(robots),
            received: Vec::with_capacity(robots),
        });
        sample.sampled = now;
        sample.arrives = now.plus_nanos(self.latency_nanos);
        sample.loads.clear();
        sample.robots.clear();
        sample.received.clear();
        for load in 0..self.loads {
            let pose = world.load_pose(LoadId(load as u16));
            sample.loads.push(self.noisy(&pose));
        }
        for robot in 0..robots {
            let pose = world.robot_pose(RobotId(robot as u16));
            sample.robots.push(self.noisy(&pose));
        }
        for _ in 0..robots {
            let lost = self.settings.dropout > 0.0 && self.random.random::<f64>() < self.settings.dropout;
            sample.received.push(!lost);
        }
        sample
    }

    fn noisy(&mut self, pose: &Pose2) -> Pose2 {
        let Sensors { position_sd, yaw_sd_deg, .. } = self.settings;
        let mut noisy = *pose;
        if position_sd > 0.0 {
            let (a, b) = gaussian_pair(&mut self.random);
            noisy.translation.vector += position_sd * Vector2::new(a, b);
        }
        if yaw_sd_deg > 0.0 {
            let (a, _) = gaussian_pair(&mut self.random);
            noisy.rotation *= UnitComplex::new(yaw_sd_deg.to_radians() * a);
        }
        noisy
    }
}

/// What a robot's filter knows of its sensors and of a body with these accelerations.
fn model(settings: &Sensors, (acceleration, angular_acceleration): (f64, f64)) -> FilterModel {
    FilterModel {
        position_sd: settings.position_sd,
        yaw_sd: settings.yaw_sd_deg.to_radians(),
        acceleration,
        angular_acceleration,
    }
}

/// Two independent standard normal numbers (Box–Muller).
fn gaussian_pair(random: &mut ChaCha8Rng) -> (f64, f64) {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * random.random::<f64>()).sin_cos();
    (radius * cos, radius * sin)
}
