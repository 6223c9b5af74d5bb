//! Curves of cars, CPU time for a thousand pairs of places.

use std::hint::black_box;

use cohaul_planner::car::curve::Place;
use cohaul_planner::car::{dubins, reeds_shepp};
use criterion::{Criterion, criterion_group, criterion_main};

#[path = "shared/cpu_time.rs"]
mod cpu_time;
use cpu_time::CpuTime;

#[path = "shared/numbers.rs"]
mod numbers;

fn curves(criterion: &mut Criterion<CpuTime>) {
    let mut numbers = numbers::Numbers(1);
    let mut unit = || numbers.below(1 << 20) as f64 / f64::from(1 << 20);
    let mut place = || Place::new(20.0 * unit(), 20.0 * unit(), std::f64::consts::TAU * unit());
    let pairs: Vec<(Place, Place)> = (0..1_000).map(|_| (place(), place())).collect();
    criterion.bench_function("Reeds-Shepp distance, 1000 pairs", |bencher| {
        bencher.iter(|| pairs.iter().map(|(from, to)| reeds_shepp::distance(black_box(from), to)).sum::<f64>());
    });
    criterion.bench_function("Dubins distance, 1000 pairs", |bencher| {
        bencher.iter(|| pairs.iter().map(|(from, to)| dubins::distance(black_box(from), to)).sum::<f64>());
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(CpuTime).sample_size(50);
    targets = curves
}
criterion_main!(benches);
