//! Plans for cars, CPU time.

use std::hint::black_box;

use cohaul_planner::car::{Model, Options, solve};
use cohaul_planner::search::Budget;
use criterion::{Criterion, criterion_group, criterion_main};

#[path = "shared/cars.rs"]
mod cars;
#[path = "shared/cpu_time.rs"]
mod cpu_time;
use cpu_time::CpuTime;

fn cl_cbs(criterion: &mut Criterion<CpuTime>) {
    for (size, agents, obstacles) in [(50, 10, 25), (100, 25, 50), (100, 50, 50), (300, 60, 100)] {
        let instance = cars::cars(1, size, agents, obstacles);
        for (name, model) in [("CL-CBS", Model::Clcbs), ("exact", Model::Exact)] {
            criterion.bench_function(&format!("{name}, {agents} cars on {size} m"), |bencher| {
                bencher.iter(|| {
                    let budget = Budget::new(2_000_000, &|| false);
                    black_box(solve(black_box(&instance), &Options { model, ..Options::default() }, &budget))
                });
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(CpuTime).sample_size(10);
    targets = cl_cbs
}
criterion_main!(benches);
