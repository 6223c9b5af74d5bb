//! Trials on disk: resumed, torn, refused, as tables.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cohaul_core::scenario::parse;
use cohaul_sim::episode::{NoRecorder, run};
use cohaul_sim::error::chain;
use cohaul_sim::experiment::store::{
    Header, LINES, Store, TABLE, read_parquet, read_trials, write_parquet, write_text,
};
use cohaul_sim::experiment::summary::summarise;
use cohaul_sim::experiment::table::{latex_table, markdown_table};
use cohaul_sim::experiment::trials::{Key, Level, Trial, Value, cells, fingerprint, numbers};
use cohaul_sim::outcome::{End, Outcome};

/// An empty folder.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Made up, of awkward numbers.
fn outcome(seed: u64, end: End) -> Outcome {
    let time_s = 60.0 + (seed as f64 * 0.7).sin() / 3.0;
    Outcome {
        outcome: end,
        success: end == End::Reached,
        time_s,
        final_error_m: 0.1 / 3.0 + seed as f64 * 1e-17,
        final_yaw_error_rad: 5e-324,
        waypoints_reached: 3,
        repositions: seed as usize,
        reposition_time_s: time_s / 4.0,
        min_robot_distance_m: 0.2 + seed as f64 / 7.0,
        min_clearance_m: f64::INFINITY,
        path_length_m: 1e300 / 3.0,
        path_deviation_rms_m: 0.012_345_678_901_234_567,
        path_deviation_max_m: 0.1,
        control_effort: 12.3,
        energy_j: 4.5,
        caging_violation_s: 0.0,
        penalty_s: 0.0,
    }
}

fn trial(key: &Key, seed: u64, end: End) -> Trial {
    let mut trial = Trial::new("r2p2-terrains", "planar", key.clone(), seed).with_outcome(&outcome(seed, end)).unwrap();
    trial.push("capacity_kg", 1.0 / 3.0 * seed as f64);
    if seed > 2 {
        trial.push("note", "late");
    }
    trial
}

fn two_cells() -> Vec<Trial> {
    let uphill = Key::new().with("terrain", "uphill").with("mass_kg", 3.3);
    let flat = Key::new().with("terrain", "flat").with("mass_kg", 2.0);
    let mut trials: Vec<Trial> = (1..=4).map(|seed| trial(&uphill, seed, End::Reached)).collect();
    trials.extend((1..=8).map(|seed| trial(&flat, seed, if seed < 8 { End::Reached } else { End::TimedOut })));
    trials
}

fn header() -> Header {
    Header::new("r2p2-terrains", "planar", 1, ["name: flat", "name: uphill"])
}

#[test]
fn a_trial_holds_every_field_of_its_outcome() {
    let trial = trial(&Key::new(), 5, End::LoadLost);
    let object: serde_json::Value = serde_json::from_str(&outcome(5, End::LoadLost).to_json()).unwrap();
    for (name, value) in object.as_object().unwrap() {
        match trial.value(name) {
            Some(there) => assert_eq!(serde_json::to_value(there).unwrap(), *value, "{name}"),
            None => assert!(value.is_null(), "{name}"),
        }
    }
    assert_eq!(trial.outcome(), Some("load_lost"));
    assert!(!trial.success());
    assert_eq!(trial.value("repositions"), Some(&Value::Integer(5)));
    assert_eq!(trial.value("min_clearance_m"), None); // infinite
    assert_eq!(trial.number("note"), None);
}

#[test]
fn levels_are_equal_if_they_print_the_same() {
    assert_eq!(Level::from("2.50"), Level::from(2.5));
    assert_eq!(Level::from(-0.0), Level::from(0_u32));
    assert_eq!(Level::from(f64::INFINITY), Level::from("inf"));
    assert!(Level::from(1e9) < Level::from("flat") && Level::from(9.0) < Level::from(10.0));
    let key = Key::new().with("a", "x").with("b", 1.0).with("a", "y");
    assert_eq!(key.to_string(), "a=y b=1");
    assert_eq!(key, Key::new().with("b", 1.0).with("a", "y"));
    assert_eq!(serde_json::to_string(&key).unwrap(), r#"{"a":"y","b":1.0}"#);
    assert_eq!(serde_json::from_str::<Key>(r#"{"a":"y","b":1}"#).unwrap(), key);
}

/// Reference values of the 64-bit FNV-1a of "a\xff" are those of its two steps.
#[test]
fn the_fingerprint_tells_where_texts_end() {
    assert_eq!(fingerprint::<&str>([]), 0xcbf2_9ce4_8422_2325);
    // published value for "a" is af63dc4c8601ec8c
    assert_eq!(fingerprint(["a"]), (0xaf63_dc4c_8601_ec8c_u64 ^ 0xff).wrapping_mul(0x0100_0000_01b3));
    assert_ne!(fingerprint(["ab", "c"]), fingerprint(["a", "bc"]));
}

/// Once, numbers read from JSON differed in their last bit, and a resumed table from one made at a stretch.
#[test]
fn a_resumed_store_gives_the_same_bytes() {
    let trials = two_cells();
    let (whole, resumed) = (folder("trials-whole"), folder("trials-resumed"));
    let store = Store::open(&whole, &header()).unwrap();
    trials.iter().for_each(|trial| store.append(trial.clone()).unwrap());
    write_parquet(&whole.join(TABLE), &store.trials()).unwrap();

    let store = Store::open(&resumed, &header()).unwrap();
    trials[..5].iter().for_each(|trial| store.append(trial.clone()).unwrap());
    let lines = store.folder().join(LINES);
    assert_eq!(lines, resumed.join("r2p2-terrains-planar").join("trials.jsonl"));
    drop(store);
    // killed while it wrote the sixth
    let mut text = fs::read(&lines).unwrap();
    let end = text.len();
    text.extend_from_slice(br#"{"key":{"terrain":"flat","mass_kg":2.0},"seed":2,"valu"#);
    fs::write(&lines, &text).unwrap();

    // a report would tell trials of another program as those of this one
    let other = Header { revision: "another".into(), ..header() };
    assert!(Store::open(&resumed, &other).err().unwrap().to_string().contains("another revision"));

    let later = Header { seed: 99, ..header() };
    let store = Store::open(&resumed, &later).unwrap();
    assert_eq!(fs::read(&lines).unwrap().len(), end);
    assert_eq!(store.begun_by(), &header());
    assert_eq!(store.trials().len(), 5);
    for trial in trials.iter().rev() {
        match store.trial(&trial.key, trial.seed) {
            Some(finished) => assert_eq!(finished, *trial),
            None => store.append(trial.clone()).unwrap(),
        }
    }
    store.append(trials[0].clone()).unwrap(); // once is enough
    write_parquet(&resumed.join(TABLE), &store.trials()).unwrap();
    assert_eq!(fs::read(whole.join(TABLE)).unwrap(), fs::read(resumed.join(TABLE)).unwrap());
    assert_eq!(fs::read_to_string(&lines).unwrap().lines().count(), 1 + trials.len());
}

/// Every place at which the process may die leaves the whole lines before it.
#[test]
fn a_torn_line_costs_its_trial_alone() {
    let folder = folder("trials-torn");
    let store = Store::open(&folder, &header()).unwrap();
    let trials = two_cells();
    trials[..2].iter().for_each(|trial| store.append(trial.clone()).unwrap());
    let lines = store.folder().join(LINES);
    drop(store);
    let text = fs::read(&lines).unwrap();
    for end in (0..text.len()).step_by(7) {
        fs::write(&lines, &text[..end]).unwrap();
        let whole = text[..end].iter().filter(|byte| **byte == b'\n').count();
        let store = Store::open(&folder, &header()).unwrap();
        assert_eq!(store.trials().len(), whole.saturating_sub(1), "{end}");
    }
    fs::write(&lines, [text.clone(), b"{}\n".to_vec()].concat()).unwrap();
    let error = Store::open(&folder, &header()).unwrap_err();
    assert_eq!(chain(&error), "line 4 of the trials is damaged: missing field `key` at line 1 column 2");
}

#[test]
fn a_store_refuses_other_trials() {
    let folder = folder("trials-other");
    drop(Store::open(&folder, &header()).unwrap());
    let other = Header::new("r2p2-terrains", "planar", 1, ["name: flat", "name: downhill"]);
    let text = Store::open(&folder, &other).unwrap_err().to_string();
    assert!(text.contains("trials of another set of scenarios, with the fingerprint: "), "{text}");
    assert!(text.ends_with("choose another --out or remove the folder"), "{text}");
    let lines = folder.join("r2p2-terrains-planar").join(LINES);
    fs::create_dir_all(folder.join("r2p2-terrains-spatial")).unwrap();
    fs::copy(&lines, folder.join("r2p2-terrains-spatial").join(LINES)).unwrap();
    let other = Header { world: "spatial".into(), ..header() };
    let text = Store::open(&folder, &other).unwrap_err().to_string();
    assert!(text.contains("trials of another world: planar, not spatial"), "{text}");
    let open = Store::open(&folder, &header()).unwrap();
    let text = Store::open(&folder, &header()).unwrap_err().to_string();
    assert!(text.starts_with("another process writes trials into "), "{text}");
    drop(open);
}

#[test]
fn a_table_gives_the_trials_back() {
    let folder = folder("trials-table");
    let path = folder.join(TABLE);
    let mut trials = two_cells();
    trials[3].seed = u64::MAX;
    trials.push(Trial::new("r2p2-terrains", "planar", Key::new().with("mass_kg", "heavy"), 1)); // a word among numbers
    write_parquet(&path, &trials).unwrap();
    let read = read_parquet(&path).unwrap();
    let named = |trials: &[Trial]| -> BTreeMap<(Key, u64), BTreeMap<String, Value>> {
        let values = |trial: &Trial| trial.values().map(|(name, value)| (name.to_owned(), value.clone())).collect();
        trials.iter().map(|trial| ((trial.key.clone(), trial.seed), values(trial))).collect()
    };
    assert_eq!(named(&read), named(&trials));
    assert!(read.iter().all(|trial| trial.experiment == "r2p2-terrains" && trial.world == "planar"));
    let bytes = fs::read(&path).unwrap();
    write_parquet(&path, &read).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes);

    write_parquet(&path, &[]).unwrap();
    assert_eq!(read_trials(&folder).unwrap(), []);
}

#[test]
fn what_is_no_table_is_refused() {
    let folder = folder("trials-no-table");
    let path = folder.join(TABLE);
    write_text(&path, "PAR1 and so on").unwrap();
    assert!(read_trials(&path).unwrap_err().to_string().starts_with("table of trials: "));
    write_text(&folder.join(LINES), "").unwrap();
    assert_eq!(read_trials(&folder).unwrap_err().to_string(), "the trials have no header");
    let mut twice = trial(&Key::new().with("mass_kg", 2.0), 1, End::Reached);
    twice.push("mass_kg", 2.0);
    let text = write_parquet(&path, &[twice]).unwrap_err().to_string();
    assert_eq!(text, r#"column "mass_kg" would stand twice in the table of trials"#);
}

/// Whatever became of the file, reading it ends in trials or in an error.
#[test]
fn a_damaged_table_is_an_error() {
    let path = folder("trials-damaged").join(TABLE);
    write_parquet(&path, &two_cells()).unwrap();
    let whole = fs::read(&path).unwrap();
    for end in (0..whole.len()).step_by(97) {
        fs::write(&path, &whole[..end]).unwrap();
        assert!(read_parquet(&path).is_err(), "cut at {end}");
    }
    for place in (0..whole.len()).step_by(13) {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << (place % 8);
        fs::write(&path, &bytes).unwrap();
        let _ = read_parquet(&path);
    }
}

/// Seven times are in the cell that is not always reached: sorted in the head, and ranks 1 and 7 of 7 (P = 1/128 a side).
#[test]
fn a_summary_is_of_the_trials_that_reached_the_goal() {
    let trials = two_cells();
    let summaries = summarise(&trials);
    let keys: Vec<String> = summaries.iter().map(|summary| summary.key.to_string()).collect();
    assert_eq!(keys, ["terrain=uphill mass_kg=3.3", "terrain=flat mass_kg=2"]);
    let flat = &summaries[1];
    assert_eq!((flat.n, flat.reached), (8, 7));
    assert_eq!(flat.outcomes, BTreeMap::from([("reached".to_owned(), 7), ("timed_out".to_owned(), 1)]));
    let mut times: Vec<f64> = (1..=7).map(|seed| outcome(seed, End::Reached).time_s).collect();
    times.sort_by(f64::total_cmp);
    assert_eq!(flat.median_time_s, Some(times[3]));
    assert_eq!(flat.q25_time_s, Some(times[1] + 0.5 * (times[2] - times[1])));
    assert_eq!(flat.median_interval_s, Some([times[0], times[6]]));
    assert_eq!(flat.reposition_share, Some(0.25));
    assert!((flat.min_distance_m.mean.unwrap() - (0.2 + 4.0 / 7.0)).abs() < 1e-12);
    assert_eq!(summaries[0].median_interval_s, None); // four are too few
    let json = serde_json::to_value(flat).unwrap();
    assert_eq!(json["key"], serde_json::json!({"terrain": "flat", "mass_kg": 2.0}));
    assert!(json["min_distance_m"]["sd"].is_f64() && json["wilson"].is_array() && json.get("paper").is_none());
    assert_eq!(numbers(&trials, "capacity_kg").len(), 12);
    assert_eq!(cells(&trials)[1].1.len(), 8);
    assert_eq!(summarise(&[]), []);
}

#[test]
fn tables_survive_what_is_in_their_cells() {
    let rows = vec![vec!["a|b & 5 % of x_1".to_owned(), "−3".to_owned()], vec!["μ".to_owned()]];
    assert_eq!(
        markdown_table(&["what", "n"], &rows),
        "| what              |  n |\n|:------------------|---:|\n| a\\|b & 5 % of x_1 | −3 |\n| μ                 |    |\n"
    );
    let latex = latex_table(&["what", "n"], &rows);
    assert!(latex.starts_with("\\begin{tabular}{lr}\n\\toprule\nwhat & n \\\\\n"), "{latex}");
    assert!(latex.contains("a|b \\& 5 \\% of x\\_1 & $-$3 \\\\\n$\\mu$ &  \\\\\n"), "{latex}");
}

/// What an episode gives goes into a store and a table without a loss.
#[test]
fn a_mission_becomes_a_trial() {
    let text = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/r2p2/flat.yaml")).unwrap();
    let overrides = [cohaul_core::scenario::Override::parse("teams.0.mission.time_limit=2.0").unwrap()];
    let scenario = parse("flat", &text, &overrides).unwrap().resolve(Some(1), &mut || 0.5).unwrap();
    let outcome = run(&scenario, &mut NoRecorder, &mut |_, _| false).unwrap();
    let trial = Trial::new("one", "planar", Key::new(), 1).with_outcome(&outcome).unwrap();
    let folder = folder("trials-mission");
    let store = Store::open(&folder, &Header::new("one", "planar", 1, [&scenario.name])).unwrap();
    store.append(trial.clone()).unwrap();
    assert_eq!(read_trials(store.folder()).unwrap(), std::slice::from_ref(&trial));
    write_parquet(&folder.join(TABLE), std::slice::from_ref(&trial)).unwrap();
    assert_eq!(read_trials(&folder).unwrap(), [trial]);
}
