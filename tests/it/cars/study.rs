//! How robust the planner is, over many instances. Slow, so only when asked for:
//!
//! ```sh
//! cargo test --release -p cohaul-tests --test it cars::study -- --ignored --nocapture --test-threads 1
//! ```
//!
//! `STUDY_SCALE` (1 if not set) shrinks or grows the numbers of instances; `STUDY_SEED` (1000) is the first seed.

use std::time::Duration;

use cohaul_planner::car::{Model, solve};
use cohaul_planner::generate;
use cohaul_planner::instance::CarInstance;
use cohaul_planner::outcome::Outcome;
use cohaul_planner::search::Budget;
use cpu_time::ThreadTime;

use super::{Draw, MODELS, options, reasons, shape};

/// CPU time after which an instance counts as not solved.
const LIMIT: Duration = Duration::from_secs(10);

fn setting(name: &str, usual: f64) -> f64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

fn scaled(count: u64) -> u64 {
    ((count as f64 * setting("STUDY_SCALE", 1.0)) as u64).max(1)
}

fn first_seed() -> u64 {
    setting("STUDY_SEED", 1000.0) as u64
}

/// How long it took, in s, and whether it was solved.
fn tried(instance: &CarInstance, model: Model) -> (f64, bool) {
    let start = ThreadTime::now();
    let ended = solve(instance, &options(model), &Budget::new(u64::MAX, &|| start.elapsed() > LIMIT));
    let took = start.elapsed().as_secs_f64();
    if let Outcome::Solved(plan) = &ended.outcome {
        super::assert_right(instance, &options(model), plan, "study");
        return (took, true);
    }
    if matches!(ended.outcome, Outcome::Infeasible(_)) {
        println!("{:?}", reasons(ended, ""));
    }
    (took, false)
}

/// The value below which a share of the sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

fn study(size: i32, agents: usize, obstacles: usize, count: u64) {
    for model in MODELS {
        let (mut times, mut solved) = (Vec::new(), 0);
        for seed in first_seed()..first_seed() + count {
            let (took, is_solved) = tried(&generate::car(&shape(size, agents, obstacles), seed).unwrap(), model);
            if !is_solved {
                println!("seed {seed}, {model:?}: not solved, {took:.3} s");
            }
            solved += u64::from(is_solved);
            times.push(took);
        }
        times.sort_by(f64::total_cmp);
        println!(
            "{size} m, {agents} cars, {obstacles} obstacles, {model:?}, seeds {} to {}: {solved} of {count} solved within {LIMIT:?}; \
             median {:.3} s, 95 % {:.3} s, most {:.3} s",
            first_seed(),
            first_seed() + count - 1,
            quantile(&times, 0.5),
            quantile(&times, 0.95),
            quantile(&times, 1.0),
        );
        assert!(solved as f64 >= 0.98 * count as f64, "{solved} of {count}");
    }
}

#[test]
#[ignore = "takes minutes"]
fn fifty_cars() {
    study(100, 50, 50, scaled(200));
}

#[test]
#[ignore = "takes minutes"]
fn a_hundred_cars() {
    study(300, 100, 100, scaled(50));
}

/// Starts and goals a little off must not make a plan much slower to find.
#[test]
#[ignore = "takes minutes"]
fn jitters() {
    let mut draw = Draw(first_seed());
    for model in MODELS {
        let mut worst = 0.0_f64;
        for seed in first_seed()..first_seed() + 10 {
            let given = generate::car(&shape(100, 50, 50), seed).unwrap();
            let (mut times, mut failed, mut infeasible) = (Vec::new(), 0, 0);
            for _ in 0..scaled(200) {
                let mut instance = given.clone();
                for pose in instance
                    .agents
                    .iter_mut()
                    .flat_map(|agent| std::iter::once(&mut agent.start).chain(&mut agent.goals))
                {
                    let mut off = |most: f64| draw.between(-most, most);
                    let at = cohaul_core::se2::position(pose);
                    let yaw = cohaul_core::se2::yaw(pose);
                    *pose = cohaul_core::se2::pose(at.x + off(0.2), at.y + off(0.2), yaw + off(0.1));
                }
                // places that nobody can stand in any more are told at once: another draw
                let told = solve(&instance, &options(model), &Budget::new(100, &|| false));
                if matches!(told.outcome, Outcome::Infeasible(_)) {
                    infeasible += 1;
                    continue;
                }
                let (took, is_solved) = tried(&instance, model);
                failed += u64::from(!is_solved);
                times.push(took);
            }
            times.sort_by(f64::total_cmp);
            let ratio = quantile(&times, 1.0) / quantile(&times, 0.5);
            worst = worst.max(ratio);
            println!(
                "{model:?}, seed {seed}: {} jitters, {infeasible} infeasible, {failed} not solved; median {:.3} s, most {:.3} s, ratio {ratio:.1}",
                times.len(),
                quantile(&times, 0.5),
                quantile(&times, 1.0),
            );
            assert_eq!(failed, 0);
        }
        println!("{model:?}: worst ratio {worst:.1}");
        assert!(worst <= 20.0, "{worst}");
    }
}
