//! Plans with assigned goals, every goal allowed to every agent, CPU time with the set-up.

use std::hint::black_box;

use cohaul_planner::grid::{Options, Planner, solve};
use cohaul_planner::search::Budget;
use criterion::{Criterion, criterion_group, criterion_main};

#[path = "shared/cpu_time.rs"]
mod cpu_time;
#[path = "shared/grids.rs"]
mod grids;
use cpu_time::CpuTime;

fn ecbs_ta(criterion: &mut Criterion<CpuTime>) {
    for (side, agents) in [(32, 20), (64, 50)] {
        let instance = grids::grid(1, side, agents, true);
        for (name, planner, bound) in [
            ("ECBS-TA, 1.3", Planner::EcbsTa, 1.3),
            ("ITA-ECBS, 1.3", Planner::ItaEcbs, 1.3),
            ("ITA-CBS", Planner::ItaCbs, 1.0),
        ] {
            criterion.bench_function(&format!("{name}, {agents} agents on {side} × {side}"), |bencher| {
                bencher.iter(|| {
                    let budget = Budget::new(2_000_000, &|| false);
                    black_box(solve(black_box(&instance), &Options { planner, bound }, &budget))
                });
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(CpuTime).sample_size(20);
    targets = ecbs_ta
}
criterion_main!(benches);
