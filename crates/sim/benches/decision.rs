//! One decision of one robot, CPU time.

use std::hint::black_box;
use std::path::Path;

use cohaul_core::control::{Observation, StopFlags};
use cohaul_core::id::RobotId;
use cohaul_core::se2::{Twist2, pose};
use cohaul_core::time::Time;
use cohaul_sim::{episode, files};
use criterion::{Criterion, criterion_group, criterion_main};

#[path = "cpu_time.rs"]
mod cpu_time;
use cpu_time::CpuTime;

fn decision(criterion: &mut Criterion<CpuTime>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/r2p2/flat.yaml");
    let parsed = files::read_scenario(&path, &[]).expect("scenario");
    let instance = parsed.scenario.instance().expect("instance");
    // the robots that push, prevent and support at the start
    for (name, place) in [("push", 3), ("prevent", 1), ("support", 2)] {
        let mut guard = episode::controller(&parsed.scenario, &instance, 0, place).expect("controller");
        let mut tick = 0_i64;
        criterion.bench_function(&format!("decision of R2P2, {name}"), |bencher| {
            bencher.iter(|| {
                tick += 1;
                let world_from_load = pose(0.3 * (0.01 * tick as f64).sin(), 0.1, 0.2 * (0.02 * tick as f64).cos());
                let time = Time::from_nanos(tick * 50_000_000);
                let observation = Observation {
                    time,
                    sampled: time,
                    robot: RobotId(place as u16),
                    world_from_robot: world_from_load * instance.formation(0).load_from_robot(place),
                    world_from_load,
                    load_twist_in_world: Twist2::new(0.1, 0.0, 0.1),
                    stop_flags: StopFlags::default(),
                };
                black_box(guard.step(black_box(&observation)))
            });
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(CpuTime);
    targets = decision
}
criterion_main!(benches);
