//! The published experiments: their cells, a small sample of each, and what does not depend on threads or interruptions.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use cohaul_sim::experiment::runner::{self, Request};
use cohaul_sim::experiment::store::{self, Store};
use cohaul_sim::experiment::summary::summarise;
use cohaul_sim::experiment::trials::Trial;
use cohaul_sim::experiment::verdict::Verdict;
use cohaul_sim::experiment::{ALL, Results, find, report};

/// A folder of its own for each test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("cohaul-experiments-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        Self(path)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn request(world: &str, trials: usize, seed: u64, jobs: usize) -> Request {
    Request { world: world.to_owned(), trials, seed, jobs, changes: Vec::new() }
}

/// Runs an experiment into `folder`, until `stop` trials are done if that is given.
fn run(name: &str, request: &Request, folder: &Folder, stop: Option<usize>) -> Results {
    let experiment = find(name).unwrap();
    let cells = runner::cells(experiment, request).unwrap();
    let store = Store::open(&folder.0, &runner::header(experiment, request, &cells).unwrap()).unwrap();
    let finished = AtomicUsize::new(0);
    let mut progress = |done, _| finished.store(done, Ordering::Relaxed);
    let interrupted = || stop.is_some_and(|stop| finished.load(Ordering::Relaxed) >= stop);
    runner::run(experiment, request, &cells, &store, &mut progress, &interrupted).unwrap()
}

#[test]
fn every_table_has_the_cells_that_were_published() {
    let published = [
        ("r2p2-terrain", 3),
        ("r2p2-generalize", 27),
        ("r2p2-breakaway", 27),
        ("r2p2-baseline", 24),
        ("r2p2-baseline-variants", 24),
        ("r2p2-tight", 15),
        ("r2p2-capacity", 2),
        ("r2p2-rotation", 1),
        ("r2p2-taguchi", 2 * 3 * 81),
        ("r2p2-hardware", 1),
        ("r2p2-ten", 3),
        ("r2p2-two-teams", 1),
        ("r2p2-clutter", 20),
        ("r2p2-robustness", 3 * 27),
        ("r2p2-ablation", 3 * 16),
    ];
    assert_eq!(published.len(), ALL.len());
    for (name, count) in published {
        for world in ["planar", "spatial"] {
            let cells = runner::cells(find(name).unwrap(), &request(world, 1, 1, 1)).unwrap();
            assert_eq!(cells.len(), count, "{name}");
            let mut keys: Vec<_> = cells.iter().map(|cell| cell.key.clone()).collect();
            keys.sort();
            keys.dedup();
            assert_eq!(keys.len(), count, "{name} has two cells of one key");
            assert!(cells.iter().all(|cell| cell.scenario.warnings.is_empty()), "{name}");
        }
    }
}

/// Seeds that no study reports.
#[test]
fn a_sample_of_every_table_with_a_promise_is_reached() {
    for name in [
        "r2p2-terrain",
        "r2p2-generalize",
        "r2p2-tight",
        "r2p2-hardware",
        "r2p2-ten",
        "r2p2-two-teams",
        "r2p2-rotation",
    ] {
        for world in ["planar", "spatial"] {
            let results = run(name, &request(world, 1, 501, 0), &Folder::new(&format!("{name}-{world}")), None);
            assert!(results.complete);
            let failed: Vec<String> =
                results.trials.iter().filter(|t| !t.success()).map(|t| t.key.to_string()).collect();
            assert!(failed.is_empty(), "{name} {world}: {failed:?}");
        }
    }
}

#[test]
fn the_crossed_arrays_are_reached_by_teleport_and_by_driving() {
    let results = run("r2p2-taguchi", &request("planar", 1, 501, 0), &Folder::new("taguchi"), None);
    assert_eq!(results.trials.len(), 486);
    assert_eq!(results.trials.iter().filter(|t| t.success()).count(), 486);
    for trial in &results.trials {
        let time = trial.number("time_s").unwrap() + trial.number("penalty_s").unwrap();
        assert_eq!(trial.number("task_time_s"), Some(time));
    }
}

/// "The angular tolerance for the rotation is 11.46°": the error ends below it.
#[test]
fn the_rotation_ends_within_the_papers_tolerance() {
    let results = run("r2p2-rotation", &request("planar", 5, 501, 0), &Folder::new("rotation"), None);
    for trial in &results.trials {
        let error = trial.number("rotation_error_deg").unwrap();
        assert!(error <= 11.46, "{error}");
    }
}

#[test]
fn threads_and_interruptions_change_no_byte() {
    let bytes = |results: &Results, folder: &Folder| {
        let path = folder.0.join(store::TABLE);
        store::write_parquet(&path, &results.trials).unwrap();
        (std::fs::read(path).unwrap(), report::markdown(find(results.name).unwrap(), results))
    };
    let alone = Folder::new("alone");
    let whole = bytes(&run("r2p2-tight", &request("planar", 2, 501, 1), &alone, None), &alone);
    let broken = Folder::new("broken");
    let part = run("r2p2-tight", &request("planar", 2, 501, 2), &broken, Some(7));
    assert!(!part.complete && part.trials.len() >= 7 && part.trials.len() < 30, "{}", part.trials.len());
    assert!(report::markdown(find("r2p2-tight").unwrap(), &part).contains("Some trials are missing"));
    // as if killed while writing
    let lines = broken.0.join("r2p2-tight-planar").join(store::LINES);
    let mut text = std::fs::read(&lines).unwrap();
    text.truncate(text.len() - 20);
    std::fs::write(&lines, text).unwrap();
    let resumed = bytes(&run("r2p2-tight", &request("planar", 2, 501, 2), &broken, None), &broken);
    assert!(whole == resumed);
}

#[test]
fn more_trials_and_other_seeds_share_a_folder_and_other_settings_do_not() {
    let folder = Folder::new("shared");
    let first = run("r2p2-hardware", &request("planar", 2, 501, 0), &folder, None);
    let more = run("r2p2-hardware", &request("planar", 3, 501, 0), &folder, None);
    assert_eq!(more.trials[..2], first.trials[..]);
    let others = run("r2p2-hardware", &request("planar", 2, 601, 0), &folder, None);
    assert_eq!(others.trials.iter().map(|t: &Trial| t.seed).collect::<Vec<_>>(), [601, 602]);

    let experiment = find("r2p2-hardware").unwrap();
    let changed = Request { changes: vec!["loads.0.mass=1.3".to_owned()], ..request("planar", 2, 501, 0) };
    let cells = runner::cells(experiment, &changed).unwrap();
    let refused = Store::open(&folder.0, &runner::header(experiment, &changed, &cells).unwrap());
    let message = refused.err().unwrap().to_string();
    assert!(message.contains("--out"), "{message}");
}

/// The verdicts and the paper's numbers stand in the report beside ours.
#[test]
fn reports_hold_verdicts_and_the_papers_numbers() {
    let results = run("r2p2-generalize", &request("planar", 2, 501, 0), &Folder::new("verdicts"), None);
    let experiment = find("r2p2-generalize").unwrap();
    let text = report::markdown(experiment, &results);
    for expected in ["323.27", "Verdicts on the paper's statements", "uphill takes longest", "s/kg", "--seed 501"] {
        assert!(text.contains(expected), "{expected} is missing in\n{text}");
    }
    let json = report::json(experiment, &results, 1.0, 2.0);
    assert_eq!(json["cells"].as_array().unwrap().len(), 27);
    let cell = &json["cells"][0];
    for name in [
        "key",
        "n",
        "reached",
        "wilson",
        "outcomes",
        "median_time_s",
        "q25_time_s",
        "q75_time_s",
        "mean_time_s",
        "sd_time_s",
        "min_distance_m",
        "paper",
    ] {
        assert!(!cell[name].is_null(), "{name} is missing in {cell}");
    }
    assert_eq!(cell["paper"]["time_s"], 77.7);
}

/// Trials of Table I, five per cell, whose times are made up.
fn made_up(time: impl Fn(&str, f64, f64) -> f64) -> Vec<Verdict> {
    let experiment = find("r2p2-generalize").unwrap();
    let mut trials = Vec::new();
    for cell in runner::cells(experiment, &request("planar", 1, 1, 1)).unwrap() {
        let level = |factor: &str| cell.key.level(factor).unwrap().to_string();
        let number = |factor: &str| level(factor).parse::<f64>().unwrap();
        for seed in 1..=5 {
            let mut trial = Trial::new(experiment.name(), "planar", cell.key.clone(), seed);
            trial.push("success", true);
            let scatter = 0.1 * (seed as f64 - 3.0);
            trial.push("time_s", time(&level("terrain"), number("mass_kg"), number("mu")) + scatter);
            trials.push(trial);
        }
    }
    let results = Results {
        name: "r2p2-generalize",
        world: "planar".to_owned(),
        seed: 1,
        requested: 5,
        changes: Vec::new(),
        complete: true,
        cells: summarise(&trials),
        trials,
    };
    experiment.verdicts(&results)
}

/// A drop at the last level alone once passed for no trend.
#[test]
fn verdicts_see_trends_that_are_there_and_none_that_are_not() {
    let as_in_the_paper = made_up(|terrain, mass, _| match terrain {
        "flat" => 80.0 + 10.0 * mass,
        "downhill" => 75.0,
        _ => 240.0 + 10.0 * mass,
    });
    assert!(as_in_the_paper.iter().all(|v| v.agrees == Some(true)), "{as_in_the_paper:#?}");
    let otherwise = made_up(|terrain, mass, mu| {
        let drop = if mu > 0.05 { 6.0 } else { 0.0 };
        if terrain == "downhill" { 21.0 + mass - drop } else { 14.0 - drop }
    });
    assert!(otherwise.iter().all(|v| v.agrees == Some(false)), "{otherwise:#?}");
}
