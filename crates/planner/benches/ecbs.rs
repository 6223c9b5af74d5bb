//! Bounded plans for agents with goals of their own, CPU time.

use std::hint::black_box;

use cohaul_planner::grid::{Options, Planner, solve};
use cohaul_planner::search::Budget;
use criterion::{Criterion, criterion_group, criterion_main};

#[path = "shared/cpu_time.rs"]
mod cpu_time;
#[path = "shared/grids.rs"]
mod grids;
use cpu_time::CpuTime;

fn ecbs(criterion: &mut Criterion<CpuTime>) {
    for agents in [20, 50, 100] {
        let instance = grids::grid(1, 32, agents, false);
        for (name, planner, bound) in [("ECBS, 1.3", Planner::Ecbs, 1.3), ("ECBS, 1.1", Planner::Ecbs, 1.1)] {
            criterion.bench_function(&format!("{name}, {agents} agents on 32 × 32"), |bencher| {
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
    targets = ecbs
}
criterion_main!(benches);
