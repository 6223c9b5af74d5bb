//! Optimal and next-best assignments, CPU time.

use std::hint::black_box;

use cohaul_planner::assign::{Costs, NextBest, optimal};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};

#[path = "shared/cpu_time.rs"]
mod cpu_time;
#[path = "shared/numbers.rs"]
mod numbers;
use cpu_time::CpuTime;

fn assignment(criterion: &mut Criterion<CpuTime>) {
    // distances on a grid: whole numbers with many ties
    for (agents, goals) in [(20, 20), (80, 80), (200, 200), (40, 80)] {
        let mut numbers = numbers::Numbers(agents as u64);
        let values = (0..agents * goals).map(|_| (1 + numbers.below(60)) as f64).collect();
        let costs = Costs::new(agents, goals, values);
        criterion.bench_function(&format!("optimal assignment, {agents} agents and {goals} goals"), |bencher| {
            bencher.iter(|| black_box(optimal(black_box(&costs))));
        });
        criterion.bench_function(&format!("ten next-best assignments, {agents} agents and {goals} goals"), |bencher| {
            bencher.iter_batched(
                || NextBest::new(&costs),
                |assignments| black_box(assignments.take(10).last()),
                BatchSize::SmallInput,
            );
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(CpuTime).sample_size(20);
    targets = assignment
}
criterion_main!(benches);
