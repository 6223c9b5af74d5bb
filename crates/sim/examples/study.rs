//! The three missions of `scenarios/r2p2` in both worlds over many seeds: how many reach their goals, how fast.
//!
//! `cargo run --release -p cohaul-sim --example study -- [first seed] [seeds] [path=value …]`

use std::error::Error;
use std::path::Path;

use cohaul_core::scenario::Override;
use cohaul_sim::episode::{NoRecorder, run};
use cohaul_sim::files;
use cohaul_sim::outcome::Outcome;
use cohaul_sim::statistics::{ascending, quantile, wilson};
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let first: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let count: u64 = arguments.next().map_or(Ok(20), |text| text.parse())?;
    let changes: Vec<String> = arguments.collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/r2p2");
    println!("seeds {first} to {}, {changes:?}", first + count - 1);
    println!("world    mission   reached  95 % interval    median [quartiles] s  repositioning");
    for world in ["planar", "spatial"] {
        for name in ["flat", "downhill", "uphill"] {
            let mut overrides = vec![Override::parse(&format!("world={world}"))?];
            for change in &changes {
                overrides.push(Override::parse(change)?);
            }
            let parsed = files::read_scenario(&folder.join(format!("{name}.yaml")), &overrides)?;
            let outcomes: Vec<(u64, Outcome)> = (first..first + count)
                .into_par_iter()
                .map(|seed| -> Result<_, String> {
                    let scenario = files::draw(&parsed, Some(seed)).map_err(|error| error.to_string())?;
                    let outcome = run(&scenario, &mut NoRecorder, &mut |_, _| false).map_err(|e| e.to_string())?;
                    Ok((seed, outcome))
                })
                .collect::<Result<_, _>>()?;
            let reached: Vec<&Outcome> = outcomes.iter().map(|(_, o)| o).filter(|o| o.success).collect();
            let times = ascending(&reached.iter().map(|o| o.time_s).collect::<Vec<f64>>());
            let (low, high) = wilson(reached.len(), outcomes.len());
            let share = reached.iter().map(|o| o.reposition_time_s / o.time_s).sum::<f64>() / reached.len() as f64;
            println!(
                "{world:<9}{name:<10}{:>3}/{count:<4} [{:.3}, {:.3}]   {:>5.1} [{:.1}, {:.1}]      {:.0} %",
                reached.len(),
                low,
                high,
                quantile(&times, 0.5),
                quantile(&times, 0.25),
                quantile(&times, 0.75),
                100.0 * share,
            );
            for (seed, outcome) in outcomes.iter().filter(|(_, o)| !o.success) {
                println!("    seed {seed}: {} after {:.1} s", outcome.outcome.name(), outcome.time_s);
            }
        }
    }
    Ok(())
}
