//! How fast missions run, without log and page: CPU time of one core. One element is one simulated second, so the
//! throughput is the factor over real time.

use std::path::Path;

use cohaul_core::scenario::Override;
use cohaul_sim::episode::{NoRecorder, run};
use cohaul_sim::files;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

#[path = "cpu_time.rs"]
mod cpu_time;
use cpu_time::CpuTime;

fn missions(criterion: &mut Criterion<CpuTime>) {
    let mut group = criterion.benchmark_group("six robots");
    group.sample_size(20);
    for world in ["planar", "spatial"] {
        for name in ["flat", "downhill", "uphill"] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenarios/r2p2/{name}.yaml"));
            let change = Override::parse(&format!("world={world}")).expect("override");
            let parsed = files::read_scenario(&path, &[change]).expect("scenario");
            let scenario = files::draw(&parsed, None).expect("draw");
            let simulated = run(&scenario, &mut NoRecorder, &mut |_, _| false).expect("mission").time_s;
            group.throughput(Throughput::Elements(simulated.round() as u64));
            group.bench_with_input(BenchmarkId::new(world, name), &scenario, |bencher, scenario| {
                bencher.iter(|| run(scenario, &mut NoRecorder, &mut |_, _| false).expect("mission"));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(CpuTime);
    targets = missions
}
criterion_main!(benches);
