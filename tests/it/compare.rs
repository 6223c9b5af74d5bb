//! Results side by side: trials pair by pair, logs way by way.

use std::fs;
use std::path::{Path, PathBuf};

use cohaul_core::scenario::{Override, parse};
use cohaul_sim::cli;
use cohaul_sim::compare::{CompareError, Compared, Pairs};
use cohaul_sim::episode::{NoRecorder, run};
use cohaul_sim::experiment::store::{Header, Store, TABLE, write_parquet};
use cohaul_sim::experiment::trials::{Key, Trial};
use cohaul_sim::files;
use cohaul_sim::plot::{Lines, Series, save};
use rayon::prelude::*;
use serde_json::Value;

use crate::trials::folder;

fn scenario(changes: &[String]) -> cohaul_core::scenario::document::Scenario {
    let text = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/r2p2/uphill.yaml")).unwrap();
    let overrides: Vec<Override> = changes.iter().map(|change| Override::parse(change).unwrap()).collect();
    parse("uphill", &text, &overrides).unwrap().resolve(None, &mut || 0.5).unwrap()
}

/// Two masses, the heavier one too heavy to reach the goal within the time.
fn episodes(world: &str, seeds: std::ops::RangeInclusive<u64>) -> Vec<Trial> {
    let cells = [2.0, 200.0].into_iter().flat_map(|mass| seeds.clone().map(move |seed| (mass, seed)));
    let trial = |(mass, seed): (f64, u64)| {
        let limit = if mass > 100.0 { 5.0 } else { 200.0 };
        let changes = [
            format!("world={world}"),
            format!("seed={seed}"),
            format!("loads.0.mass={mass}"),
            format!("teams.0.mission.time_limit={limit:?}"),
        ];
        let outcome = run(&scenario(&changes), &mut NoRecorder, &mut |_, _| false).unwrap();
        Trial::new("masses", world, Key::new().with("mass_kg", mass), seed).with_outcome(&outcome).unwrap()
    };
    cells.collect::<Vec<_>>().into_par_iter().map(trial).collect()
}

/// The results of both worlds: lines in one folder, a table in the other.
fn results() -> (PathBuf, PathBuf) {
    let folder = folder("compare-results");
    let store = Store::open(&folder, &Header::new("masses", "planar", 1, ["uphill"])).unwrap();
    episodes("planar", 1..=5).into_iter().for_each(|trial| store.append(trial).unwrap());
    let spatial = folder.join("spatial");
    fs::create_dir_all(&spatial).unwrap();
    write_parquet(&spatial.join(TABLE), &episodes("spatial", 2..=6)).unwrap();
    (store.folder().to_owned(), spatial)
}

/// Exit status of a command line.
fn command(arguments: &[&str]) -> i32 {
    let arguments = ["cohaul", "compare"].iter().chain(arguments).map(|text| (*text).to_owned()).collect();
    cli::main(arguments, &|| false)
}

#[test]
fn worlds_are_compared_pair_by_pair() {
    let (planar, spatial) = results();
    let fields = ["min_clearance_m".to_owned()];
    let Compared::Trials(pairs) = files::compare(&planar, &spatial, &fields, None).unwrap() else { panic!() };
    // seeds 2 to 5 of two cells
    assert_eq!((pairs.total.n, pairs.a.unpaired, pairs.b.unpaired), (8, 2, 2));
    let masses: Vec<String> = pairs.cells.iter().map(|cell| cell.key.as_ref().unwrap().to_string()).collect();
    assert_eq!(masses, ["mass_kg=2", "mass_kg=200"]);
    let (light, heavy) = (&pairs.cells[0], &pairs.cells[1]);
    assert_eq!((light.reached_a, light.reached_b, light.mcnemar_p), (4, 4, 1.0));
    assert_eq!((heavy.reached_a, heavy.reached_b), (0, 0));
    assert!(heavy.fields.is_empty(), "no time is compared where nobody reached the goal");
    let time = &light.fields["time_s"];
    let (a, b) = (files_of(&planar), files_of(&spatial));
    let of = |trials: &[Trial], seed| {
        let wanted = Key::new().with("mass_kg", 2.0);
        trials.iter().find(|trial| trial.key == wanted && trial.seed == seed).unwrap().number("time_s").unwrap()
    };
    let mean = (2..=5).map(|seed| of(&b, seed) - of(&a, seed)).sum::<f64>() / 4.0;
    assert!((time.mean_difference - mean).abs() < 1e-12);
    let (low, high) = time.mean_difference_interval;
    assert!(low <= mean && mean <= high && low < high);
    assert_eq!(time.ratio_of_medians, time.median_b / time.median_a);
    assert_eq!(light.fields["min_clearance_m"].n, 4);

    let same = files::compare(&planar, &planar, &[], None).unwrap();
    let json: Value = serde_json::from_str(&same.to_json()).unwrap();
    assert_eq!(json["kind"], "trials");
    assert_eq!(json["total"]["key"], Value::Null);
    assert_eq!(json["total"]["fields"]["time_s"]["mean_difference_interval"], serde_json::json!([0.0, 0.0]));
    assert_eq!(json["cells"][0]["key"], serde_json::json!({"mass_kg": 2.0}));

    let (table, rows) = (planar.join("t.md"), planar.join("t.tex"));
    let arguments = [planar.to_str().unwrap(), spatial.to_str().unwrap(), "--markdown", table.to_str().unwrap()];
    assert_eq!(command(&[&arguments[..], &["--latex", rows.to_str().unwrap(), "--json"]].concat()), cli::DONE);
    let text = fs::read_to_string(&table).unwrap();
    assert!(text.contains("A: masses, planar; 10 trials, 2 of them unpaired"), "{text}");
    assert!(text.contains("the two are of different experiments or worlds, with the same cells"), "{text}");
    assert!(text.contains("| mass_kg=2 ") && text.contains("| all "), "{text}");
    assert!(fs::read_to_string(&rows).unwrap().contains("mass\\_kg=200 & 4 & 0 & 0 & 1.000 & -- & -- \\\\"));
}

fn files_of(folder: &Path) -> Vec<Trial> {
    cohaul_sim::experiment::store::read_trials(folder).unwrap()
}

/// b = 6, c = 0: p = 2/2⁶.
#[test]
fn success_is_tested_over_the_pairs_that_differ() {
    let trial = |seed: u64, success: bool, time: f64| {
        let mut trial = Trial::new("made up", "planar", Key::new().with("cell", "one"), seed);
        trial.push("success", success);
        trial.push("time_s", time);
        trial
    };
    let a: Vec<Trial> = (0..20).map(|seed| trial(seed, true, 10.0 + seed as f64)).collect();
    let b: Vec<Trial> = (0..20).map(|seed| trial(seed, seed >= 6, 15.0 + 1.5 * seed as f64)).collect();
    let pairs = Pairs::of(&a, &b, &[]).unwrap();
    assert_eq!((pairs.total.only_a, pairs.total.only_b, pairs.total.mcnemar_p), (6, 0, 2.0 / 64.0));
    let time = &pairs.total.fields["time_s"];
    // seeds 6 to 19, of mean 12.5: differences 5 + seed / 2; B = 1.5 A in every pair, hence in every sample
    assert_eq!((time.n, time.mean_difference), (14, 11.25));
    let (low, high) = time.ratio_of_medians_interval;
    // but for rounding
    assert!([low, time.ratio_of_medians, high].iter().all(|ratio| (ratio - 1.5).abs() < 1e-12), "{low} {high}");

    let error = Pairs::of(&a, &b, &["speed".to_owned()]).unwrap_err();
    assert_eq!(error.to_string(), r#"no trial of both sides has a number "speed"; there are time_s"#);
    let others: Vec<Trial> = (90..93).map(|seed| trial(seed, true, 1.0)).collect();
    let error = Pairs::of(&a, &others, &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "nothing to compare: no cell and seed is in both; A has 1 cells such as [cell=one] with seeds from 0 to 19, \
         B has 1 cells such as [cell=one] with seeds from 90 to 92"
    );
    assert!(matches!(Pairs::of(&a, &[], &[]), Err(CompareError::Nothing(_))));
    let twice = [trial(3, true, 1.0), trial(3, false, 2.0)];
    let error = Pairs::of(&twice, &b, &[]).unwrap_err();
    assert_eq!(error.to_string(), "A holds seed 3 of the cell [cell=one] twice: give one experiment in one world");
}

#[test]
fn the_exit_status_tells_what_went_wrong() {
    let folder = folder("compare-status");
    let [one, other, log] = ["one.parquet", "other.parquet", "run.mcap"].map(|name| folder.join(name));
    let trial = |seed| {
        let mut trial = Trial::new("made up", "planar", Key::new(), seed);
        trial.push("time_s", 1.0);
        trial
    };
    write_parquet(&one, &[trial(1)]).unwrap();
    write_parquet(&other, &[trial(2)]).unwrap();
    fs::write(&log, "no log").unwrap();
    let [one, other, log] = [&one, &other, &log].map(|path| path.to_str().unwrap());
    assert_eq!(command(&[one, one]), cli::DONE);
    assert_eq!(command(&[one, other]), cli::FAILED);
    assert_eq!(command(&[one, log]), cli::USAGE);
    assert_eq!(command(&[one, one, "--field", "speed"]), cli::USAGE);
    assert_eq!(command(&[one, one, "--out", "out"]), cli::USAGE);
    assert_eq!(command(&[log, log, "--field", "time_s"]), cli::USAGE);
    assert_eq!(command(&[one]), cli::USAGE);
    assert_eq!(command(&[log, log]), cli::BAD_INPUT);
    assert_eq!(command(&[one, "missing.parquet"]), cli::BAD_INPUT);
    assert_eq!(command(&[one, folder.to_str().unwrap()]), cli::BAD_INPUT);
}

#[test]
fn two_logs_become_a_picture() {
    let folder = folder("compare-logs");
    for world in ["planar", "spatial"] {
        let scenario = scenario(&[format!("world={world}"), format!("name={world}"), "seed=3".into()]);
        files::run_into(scenario, &folder, false, &mut |_, _| false).unwrap();
    }
    let [a, b] = ["planar.mcap", "spatial.mcap"].map(|name| folder.join(name));
    let Compared::Logs(paths) = files::compare(&a, &b, &[], Some(&folder)).unwrap() else { panic!() };
    let way = &paths.loads[0];
    // both follow the same three legs, with a tolerance of 0.1 m at their ends
    assert!(way.rms_distance_m < 0.1 && way.rms_distance_m <= way.max_distance_m, "{way:?}");
    assert!(way.final_distance_m < 0.2, "{way:?}");
    assert_eq!(paths.time_ratio, paths.b.time_s / paths.a.time_s);
    assert_eq!((paths.a.outcome.as_deref(), paths.b.world.as_str(), paths.b.seed), (Some("reached"), "spatial", 3));
    let svg = fs::read_to_string(folder.join("planar-vs-spatial.svg")).unwrap();
    assert!(svg.contains("spatial (spatial, seed 3): reached after"));
    assert!(!svg.contains("href"), "nothing is loaded from elsewhere");
    let png = fs::read(folder.join("planar-vs-spatial.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 10_000);
    // the same picture again
    files::compare(&a, &b, &[], Some(&folder)).unwrap();
    assert_eq!(fs::read_to_string(folder.join("planar-vs-spatial.svg")).unwrap(), svg);
    assert_eq!(fs::read(folder.join("planar-vs-spatial.png")).unwrap(), png);

    let Compared::Logs(same) = files::compare(&a, &a, &[], None).unwrap() else { panic!() };
    let way = &same.loads[0];
    assert_eq!((way.rms_distance_m, way.rms_yaw_difference_rad, same.time_ratio, &same.svg), (0.0, 0.0, 1.0, &None));
}

#[test]
fn charts_take_numbers_and_names() {
    let folder = folder("charts");
    let series = |name: &str, shift: f64| Series {
        name: name.to_owned(),
        points: (0..4).map(|i| (f64::from(i), 60.0 + shift * f64::from(i))).collect(),
        intervals: (0..4).map(|i| (57.0 + shift * f64::from(i), 64.0 + shift * f64::from(i))).collect(),
        marked: true,
        joined: true,
        bars: false,
    };
    let lines = Lines {
        title: "Time over mass".to_owned(),
        x: "mass, kg".to_owned(),
        y: "median time, s".to_owned(),
        series: vec![series("planar", 3.0), series("spatial", 5.0)],
        ..Lines::default()
    };
    save(&folder.join("lines"), (720, 480), &lines).unwrap();
    let mut bars = Lines { names: ["flat", "uphill", "downhill", "side"].map(String::from).to_vec(), ..lines.clone() };
    bars.series.iter_mut().for_each(|series| (series.joined, series.bars, series.marked) = (false, true, false));
    let (svg, png) = save(&folder.join("bars.v2"), (720, 480), &bars).unwrap();
    assert!(svg.ends_with("bars.v2.svg") && png.is_file());
    let text = fs::read_to_string(svg).unwrap();
    for name in ["flat", "downhill", "spatial", "median time, s"] {
        assert!(text.contains(name), "{name}");
    }
    // nothing, what is not finite, and no room at all
    save(&folder.join("empty"), (300, 200), &Lines::default()).unwrap();
    let odd = Series { points: vec![(f64::NAN, 1.0), (2.0, f64::INFINITY), (3.0, 3.0)], ..Series::default() };
    save(&folder.join("odd"), (300, 200), &Lines { series: vec![odd], ..Lines::default() }).unwrap();
    assert!(save(&folder.join("missing/lines"), (300, 200), &lines).is_err());
}
