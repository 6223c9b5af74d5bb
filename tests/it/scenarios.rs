//! Scenario files: the good ones, the bad ones, overrides, drawn values, the schema.

use std::fs;
use std::path::{Path, PathBuf};

use cohaul_core::scenario::document::{Controller, Plan, Scenario, Shape, Slots, Variant};
use cohaul_core::scenario::{self, Override, Parsed, Problem, ScenarioError};
use proptest::prelude::*;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The missions: everything in `scenarios` but the planning instances.
fn missions() -> Vec<PathBuf> {
    let planner = root().join("scenarios/planner");
    let mut found = files(&root().join("scenarios"), ".yaml");
    found.retain(|path| !path.starts_with(&planner));
    found
}

const FLAT: &str = include_str!("../../scenarios/r2p2/flat.yaml");

fn with(overrides: &[&str]) -> Result<Parsed, ScenarioError> {
    let overrides: Vec<_> = overrides.iter().map(|text| Override::parse(text).unwrap()).collect();
    scenario::parse("flat.yaml", FLAT.as_bytes(), &overrides)
}

#[test]
fn every_scenario_of_the_repository_is_valid_without_warnings() {
    let files = missions();
    assert!(files.len() >= 3);
    for path in files {
        let parsed = scenario::parse(&path.to_string_lossy(), &fs::read(&path).unwrap(), &[]);
        let parsed = parsed.unwrap_or_else(|error| panic!("{error}; {}", error.remedy()));
        assert!(parsed.warnings.is_empty(), "{}", parsed.warnings[0]);
        assert_eq!(Some(parsed.scenario.name.as_ref()), path.file_stem().unwrap().to_str());
    }
}

/// The first line of each bad file says where the error is and which words its message has.
#[test]
fn every_bad_file_is_refused_at_its_line_and_column_with_a_remedy() {
    let files = files(&root().join("tests/bad"), ".yaml");
    assert!(files.len() >= 30);
    let mut wrong = Vec::new();
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let (place, words) = text.lines().next().unwrap().strip_prefix("# expect: ").unwrap().split_once(' ').unwrap();
        match scenario::parse(&name, text.as_bytes(), &[]) {
            Ok(_) => wrong.push(format!("{name}: accepted")),
            Err(error) => {
                let message = error.to_string();
                let missing: Vec<_> = words.split(' ').filter(|word| !message.contains(word)).collect();
                let at = format!("{}:{}", error.line().unwrap(), error.column().unwrap());
                if at != place || !missing.is_empty() || error.remedy().len() < 10 {
                    wrong.push(format!("{message} | missing {missing:?} | {}", error.remedy()));
                }
                assert!(message.starts_with(&format!("{name}:{at}: ")), "{message}");
            }
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_hundred_megabytes_are_refused_at_once() {
    let text = "# padding\n".repeat(10_000_000);
    let started = std::time::Instant::now();
    let error = scenario::parse("large.yaml", text.as_bytes(), &[]).unwrap_err();
    assert_eq!((error.line(), error.column()), (Some(1), Some(1)));
    assert!(matches!(error.problem(), Problem::TooLarge { bytes: 100_000_000, .. }));
    assert!(started.elapsed().as_secs_f64() < 1.0); // nothing of it is read
}

#[test]
fn alias_bombs_are_refused_at_the_budget() {
    // ten aliases of ten aliases of …: 10^9 values
    let mut text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n".to_owned();
    for i in 1..9 {
        let aliases = vec![format!("*a{}", i - 1); 10].join(", ");
        text += &format!("a{i}: &a{i} [{aliases}]\n");
    }
    let error = scenario::parse("bomb.yaml", text.as_bytes(), &[]).unwrap_err();
    assert!(matches!(error.problem(), Problem::Budget { .. }), "{error}");
    assert!(error.line().unwrap() > 1 && error.remedy().contains("aliases"), "{error}");
}

#[test]
fn bytes_that_are_no_text_are_refused_at_their_place() {
    let error = scenario::parse("latin1.yaml", b"format: cohaul/1\n# Z\xfcrich\n", &[]).unwrap_err();
    assert_eq!(error.to_string(), "latin1.yaml:2:4: the file is not UTF-8 text: byte 20 cannot be read");
}

#[test]
fn overrides_reach_every_key_given_or_not() {
    let parsed = with(&[
        "loads.0.mass=3.3",
        "terrain.friction.static=0.2",
        "teams.0.controller.r2p2.variant=literal",
        "teams.0.robots.ballast.mass=0.5",
        "start.position_jitter=0.001",
        "teams.0.mission.waypoints.2={x: 2.5, y: 0.1}",
        "terrain.walls=[-5, -5, 5, 5]",
        "randomize={loads.0.height: [0.1, 0.3]}",
        "randomize.physics.step=[0.005, 0.01]",
        "description='quoted: text'",
        "teams.0.mission.goal.x=3",
        "seed=18446744073709551615",
    ]);
    let parsed = parsed.unwrap_or_else(|error| panic!("{error}"));
    let scenario = parsed.scenario;
    assert_eq!(scenario.loads[0].mass, 3.3);
    assert_eq!(scenario.terrain.friction.breakaway, Some(0.2));
    assert_eq!(scenario.seed, u64::MAX);
    assert_eq!(scenario.description, "quoted: text");
    assert_eq!(scenario.teams[0].mission.waypoints.len(), 3);
    assert_eq!(scenario.teams[0].robots.model().mass_on_wheels, 1.5);
    assert_eq!(scenario.terrain.walls, Some([-5.0, -5.0, 5.0, 5.0]));
    assert_eq!(scenario.randomize.keys().collect::<Vec<_>>(), ["loads.0.height", "physics.step"]);
    let Controller::R2p2(r2p2) = scenario.teams[0].controller else { panic!("another controller") };
    assert_eq!(r2p2.variant, Variant::Literal);
    assert_eq!(r2p2.rotation_gain, Some(0.25)); // the rest stays
}

#[test]
fn an_override_of_another_choice_replaces_the_one_of_the_file() {
    let parsed = with(&[
        "loads.0.shape.polygon.vertices=[[0, 0], [2, 0], [1, 2]]",
        "teams.0.robots.count=2",
        "teams.0.formation.slots.custom=[{edge: 0, at: 0.5}]",
        "teams.0.formation.slots.custom.1={edge: 1, at: 0.5}",
        "teams.0.formation.caging=partial",
    ]);
    let parsed = parsed.unwrap_or_else(|error| panic!("{error}"));
    assert!(matches!(parsed.scenario.loads[0].shape, Shape::Polygon { .. }));
    assert!(matches!(parsed.scenario.teams[0].formation.slots, Slots::Custom(_)));
    assert_eq!(parsed.warnings.len(), 1); // edge 2 is open
    assert!(parsed.warnings[0].to_string().contains("no robot stands at edge 2"), "{}", parsed.warnings[0]);
    assert_eq!(parsed.warnings[0].overrides(), ["teams.0.formation.caging=partial"]);
}

#[test]
fn errors_of_overrides_name_the_override() {
    for (text, words) in [
        ("loads.0.mass=-1", "`loads.0.mass` is -1: lower than 0.001"),
        ("loads.0.mas=1", "unknown key `mas` in `loads.0`"),
        ("loads.1.mass=1", "key `id` is missing in `loads.1`"),
        ("loads.2.mass=1", "`loads.2` does not exist: `loads` has 1 entries"),
        ("loads.first.mass=1", "`loads.first` does not exist"),
        ("loads.0.mass.kg=1", "`loads.0.mass`: expected a number"),
        ("loads.0.mass=", "expected a number, found null"),
        ("physics.steps=1", "unknown key `steps` in `physics`"),
        ("world=kinematic", "unknown value `kinematic`"),
        ("terrain.slope_deg=91", "greater than 80"),
        ("teams.0.mission.waypoints=[]", "empty list"),
        // the value at fault stands in the file, the cause in the override
        ("loads.0.shape.rectangle.length=0.4", "contact placement 0.175 m lies outside"),
        ("randomize={loads.0.mass: [0, 1]}", "`loads.0.mass` cannot be drawn: with 0"),
    ] {
        let error = with(&[text]).map(|_| ()).expect_err(text);
        assert!(error.message().contains(words), "{error}");
        assert!(error.to_string().starts_with("flat.yaml: --set "), "{error}");
        assert_eq!((error.overrides(), error.line(), error.column()), (&[text.to_owned()][..], None, None));
        assert!(!error.remedy().is_empty());
    }
    // of two, only the one at fault
    let error = with(&["loads.0.mass=3", "loads.0.shape.rectangle.length=0.4"]).unwrap_err();
    assert_eq!(error.overrides(), ["loads.0.shape.rectangle.length=0.4"]);
    let allowed = with(&["loads.0.mas=1"]).unwrap_err().remedy();
    assert!(allowed.contains("`id`, `shape`, `height`, `mass`"), "{allowed}");
    for text in ["", "loads.0.mass", "=1", "loads..mass=1", "loads.0.mass=[1", "loads.0.mass=.nan"] {
        let error = Override::parse(text).map(|_| ()).expect_err(text);
        assert!(!error.remedy().is_empty(), "{error}");
    }
}

#[test]
fn errors_of_the_file_keep_their_place_beside_overrides() {
    let broken = FLAT.replace("mass: 2.0", "mass: -2.0");
    let change = [Override::parse("terrain.slope_deg=3").unwrap()];
    let error = scenario::parse("flat.yaml", broken.as_bytes(), &change).unwrap_err();
    let line = broken.lines().position(|line| line.contains("mass: -2.0")).unwrap() + 1;
    assert_eq!((error.line(), error.column()), (Some(line), Some(11)), "{error}");
}

#[test]
fn a_load_no_longer_than_two_robots_is_warned_about() {
    let parsed =
        with(&["loads.0.shape.rectangle={length: 0.42, width: 0.35}", "teams.0.formation.contact_placement=0"]);
    let parsed = parsed.unwrap_or_else(|error| panic!("{error}"));
    let warning = &parsed.warnings[0];
    assert!(matches!(warning.problem(), Problem::ShortEdge { .. }), "{warning}");
    assert!(
        with(&["loads.0.shape.rectangle={length: 0.43, width: 0.35}", "teams.0.formation.contact_placement=0"])
            .unwrap_or_else(|error| panic!("{error}"))
            .warnings
            .is_empty()
    );
}

#[test]
fn drawn_keys_depend_only_on_the_draws_and_are_checked() {
    let parsed = with(&[
        "terrain.walls=[-5, -5, 5, 5]",
        "randomize={loads.0.mass: [1, 3], teams.0.controller.r2p2.check_interval: [10, 12], terrain.walls.0: [-5, -4]}",
        "randomize.terrain.slope_deg=[-5, 5]",
    ]);
    let parsed = parsed.unwrap_or_else(|error| panic!("{error}"));
    // in the order of the keys: mass, check_interval, slope, wall
    let resolve = |draws: [f64; 4]| {
        let mut draws = draws.into_iter();
        parsed.resolve(Some(9), &mut || draws.next().unwrap()).unwrap()
    };
    let scenario = resolve([0.25, 0.99, 0.5, 0.75]);
    assert_eq!((scenario.loads[0].mass, scenario.terrain.slope_deg, scenario.seed), (1.5, 0.0, 9));
    assert_eq!(scenario.terrain.walls.unwrap()[0], -4.25);
    let Controller::R2p2(r2p2) = scenario.teams[0].controller else { panic!("another controller") };
    assert_eq!(r2p2.check_interval, Some(12)); // 10, 11, 12 have a third each
    assert!(scenario.randomize.is_empty());
    assert_eq!(resolve([0.25, 0.99, 0.5, 0.75]), scenario);
    assert_eq!(parsed.resolve(None, &mut || 0.0).unwrap().seed, 1);

    // an override wins over the range of the same key
    let fixed = with(&["randomize={loads.0.mass: [1, 3]}", "loads.0.mass=2.5"]).unwrap();
    assert_eq!(fixed.resolve(None, &mut || panic!("nothing to draw")).unwrap().loads[0].mass, 2.5);

    // each end is allowed, the two together are not
    let crossed = with(&[
        "teams.0.controller.r2p2={speed_min: 0.1, speed_max: 0.15}",
        "randomize={teams.0.controller.r2p2.speed_min: [0.1, 0.14], teams.0.controller.r2p2.speed_max: [0.12, 0.15]}",
    ]);
    let mut draws = [0.0, 0.9].into_iter();
    let error = crossed.unwrap().resolve(None, &mut || draws.next().unwrap()).unwrap_err();
    assert!(matches!(error.problem(), Problem::Drawn { .. }), "{error}");
}

#[test]
fn instances_have_the_bodies_of_the_file() {
    let parsed =
        with(&["teams.0.robots.ballast={mass: 0.5, at: rear}", "loads.0.pose={x: 1, y: 2, yaw_deg: 90}"]).unwrap();
    let instance = parsed.scenario.instance().unwrap();
    let (low, high) = instance.load_polygon(0).bounds();
    assert!((high - low - nalgebra::Vector2::new(0.35, 1.35)).norm() < 1e-12);
    assert_eq!((instance.robot_model(0).mass, instance.robot_model(0).mass_on_wheels), (1.5, 1.0));
    // slot 0, front left: (0.29, 0.5) in the load's frame, a quarter turn further in the world
    let first = instance.start_pose_of_robot(0, 0);
    assert!((first.translation.vector - nalgebra::Vector2::new(0.5, 2.29)).norm() < 1e-12, "{first}");
    assert!((first.rotation.angle() + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!(instance.teams[0].robots(), 6);
}

#[test]
fn the_schema_file_is_that_of_the_structs() {
    let path = root().join("scenarios/scenario.schema.json");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::write(&path, scenario::schema()).unwrap();
    }
    // compared as data: the order of keys depends on how serde_json is built
    let data = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    let written = data(&fs::read_to_string(path).unwrap());
    assert_eq!(written, data(&scenario::schema()), "run with UPDATE_GOLDEN=1 to rewrite it");
}

fn any_name() -> impl Strategy<Value = String> {
    const ODD: &[&str] = &["null", "true", "no", "1e5", "0x1F", "-", "---", "_", "12", "0o7", "1_000", "NaN"];
    prop_oneof!["[A-Za-z0-9_-]{1,64}", proptest::sample::select(ODD).prop_map(str::to_owned)]
}

/// The nearest id to a name: words that YAML could take for something else stay as they are.
fn id_like(name: &str) -> String {
    let mut id = name.replace('-', "_");
    if id.starts_with(|c: char| c.is_ascii_digit()) {
        id.replace_range(..1, "_");
    }
    id
}

prop_compose! {
    /// Scenarios that reach the corners of what YAML can write: odd names, any text, any digits.
    fn any_scenario()(
        name in any_name(),
        description in any::<String>(),
        seed in any::<u64>(),
        mass in 0.001..1e4_f64,
        yaw_deg in prop_oneof![Just(-0.0), Just(1e-300), -360.0..360.0_f64],
        goal in (-1e4..1e4_f64, prop_oneof![Just(5e-324), Just(1e-7), -1e4..1e4_f64]),
        speed_min in proptest::option::of(0.0..0.22_f64),
        wrap in any::<Option<bool>>(),
        breakaway in proptest::option::of(0.01..2.0_f64),
        rates in proptest::option::of(proptest::collection::vec(0.1..1000.0_f64, 6)),
        range in proptest::option::of((0.001..1.0_f64, 1.0..1e4_f64)),
        workspace in proptest::option::of(Just([-1e4, -1e4, 1e4, 1e4])),
    ) -> Scenario {
        let mut scenario = with(&[]).unwrap().scenario;
        scenario.name = name.clone();
        scenario.description = description;
        scenario.seed = seed;
        scenario.loads[0].mass = mass;
        scenario.loads[0].pose.yaw_deg = yaw_deg;
        let id = id_like(&name);
        (scenario.teams[0].id, scenario.teams[0].load) = (id.clone(), id.clone());
        scenario.loads[0].id = id;
        (scenario.teams[0].mission.goal.x, scenario.teams[0].mission.goal.y) = goal;
        let Controller::R2p2(r2p2) = &mut scenario.teams[0].controller else { panic!("another controller") };
        (r2p2.speed_min, r2p2.wrap) = (speed_min, wrap);
        scenario.terrain.friction.breakaway = breakaway;
        scenario.teams[0].robots.rates_hz = rates;
        scenario.terrain.workspace = workspace;
        if let Some((low, high)) = range {
            scenario.randomize.insert("loads.0.mass".to_owned(), [low, high]);
            scenario.teams[0].mission.waypoints.clear();
        }
        scenario
    }
}

proptest! {
    #[test]
    fn a_written_scenario_reads_back_bit_for_bit(scenario in any_scenario()) {
        let text = scenario.to_yaml().unwrap();
        let back = scenario::parse("written.yaml", text.as_bytes(), &[]);
        let back = back.map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        // `{:?}` tells -0.0 from 0.0 and prints every other float exactly
        prop_assert_eq!(format!("{:?}", back.scenario), format!("{scenario:?}"));
        prop_assert!(back.scenario == scenario);
    }
}

/// SplitMix64: enough to mutate files the same way every time.
struct Mutations(u64);

impl Mutations {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn pick<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }

    fn mutate(&mut self, text: &mut Vec<u8>) {
        let at = self.below(text.len());
        let end = (at + 1 + self.below(40)).min(text.len());
        match self.below(8) {
            0 if !text.is_empty() => text[at] ^= 1 << self.below(8),
            1 => drop(text.drain(at..end)),
            2 => {
                let copy = text[at..end].to_vec();
                let times = 1 + self.below(50);
                text.splice(at..at, copy.repeat(times));
            }
            3 => text.truncate(at),
            4 => {
                let long = self
                    .pick(&["x", "[", "{", "- ", "a: ", "\"", "é", "1", "&a [*a, ", "9.", "\n ", "? "])
                    .repeat(1 + self.below(5000));
                text.splice(at..at, long.bytes());
            }
            5 => {
                // a number replaced by another
                let digits: Vec<_> = (0..text.len()).filter(|i| text[*i].is_ascii_digit()).collect();
                if let Some(start) = digits.get(self.below(digits.len())) {
                    let stop =
                        (*start..text.len()).find(|i| !matches!(text[*i], b'0'..=b'9' | b'.')).unwrap_or(text.len());
                    text.splice(*start..stop, self.pick(TOKENS).bytes());
                }
            }
            6 => {
                let line = text[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |i| i + 1);
                text.splice(line..line, self.pick(TOKENS).bytes());
            }
            _ => drop(text.splice(at..at, self.pick(TOKENS).bytes())),
        }
    }
}

const TOKENS: &[&str] = &[
    "NaN",
    ".nan",
    ".inf",
    "-.inf",
    "1e308",
    "-1e308",
    "1e999",
    "1e-320",
    "0",
    "-0.0",
    "-1",
    "99999999999999999999",
    "1e16",
    "0x7f",
    "3.7",
    "90",
    "64",
    "&a ",
    "*a",
    "&a [*a]",
    "<<: *a\n",
    "!!float ",
    "!!binary ",
    "---\n",
    "...\n",
    "\u{feff}",
    "\u{0}",
    "\t",
    "\u{202e}",
    "💥",
    "null",
    "~",
    "true",
    "[]",
    "{}",
    "[[0, 0], [1, 0], [0, 1]]",
    ": ",
    "- ",
    "#",
    "|\n",
    ">\n",
    "'",
    "\"\\x",
    "? ",
    ",",
    "randomize: {loads.0.mass: [1, 3], teams.0.robots.count: [1, 64]}\n",
    "randomize: {loads.0.pose.x: [-10, 10], physics.step: [1e-4, 0.1]}\n",
    "physics: {step: 1e-4}\n",
    "terrain: {obstacles: [[[9, 9], [10, 9], [9, 10]]]}\n",
    "slots: four",
    "custom: [{edge: 3, at: 1}]",
    "polygon: {vertices: [[0, 0], [1e2, 0], [1e2, 1e-5], [0, 1]]}",
];

const PATHS: &[&str] = &[
    "loads.0.mass",
    "loads.0.shape",
    "loads.0.pose.x",
    "loads.1",
    "teams.0.robots.count",
    "teams.0.formation.slots",
    "teams.0.formation.gap",
    "teams.0.controller.r2p2.speed_min",
    "terrain.walls",
    "terrain.obstacles.0",
    "randomize",
    "randomize.loads.0.mass",
    "start",
    "x.y.z",
    "0",
];

/// Returns how many of the mutated files were accepted.
fn try_mutations(seed: u64, count: usize, good: &[Vec<u8>]) -> usize {
    let mut mutations = Mutations(seed);
    let mut accepted = 0;
    for _ in 0..count {
        let mut text = good[mutations.below(good.len())].clone();
        for _ in 0..=mutations.below(3) {
            mutations.mutate(&mut text);
        }
        let mut overrides = Vec::new();
        if mutations.below(8) == 0 {
            let change = format!("{}={}", mutations.pick(PATHS), mutations.pick(TOKENS));
            overrides.extend(Override::parse(&change));
        }
        let resolved = scenario::parse("mutated.yaml", &text, &overrides)
            .and_then(|parsed| parsed.resolve(None, &mut || mutations.uniform()));
        match resolved {
            Ok(scenario) => {
                accepted += 1;
                let open = scenario
                    .teams
                    .iter()
                    .any(|team| team.formation.slots == Slots::Auto || team.mission.plan == Plan::Auto);
                if open {
                    continue; // the planner chooses their slots and waypoints
                }
                let instance = scenario.instance().expect("a valid scenario has its bodies");
                for (team, built) in instance.teams.iter().enumerate() {
                    for place in 0..built.robots() {
                        assert!(cohaul_core::se2::is_finite(&instance.start_pose_of_robot(team, place)));
                    }
                }
            }
            Err(error) => {
                assert!(!error.remedy().is_empty() && !error.to_string().is_empty());
                if let Some(line) = error.line() {
                    let lines = 1 + text.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count();
                    assert!(line <= lines + 1, "{error}: line {line} of {lines}");
                }
            }
        }
    }
    accepted
}

/// Largest resident memory of this process so far, MB.
fn peak_memory() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap_or("0");
    line.trim().trim_end_matches("kB").trim().parse::<f64>().unwrap() / 1024.0
}

#[test]
fn mutated_files_never_panic_or_run_away() {
    let mut good: Vec<_> = missions().iter().map(|path| fs::read(path).unwrap()).collect();
    // written out, every key is there to be hit
    good.push(with(&[]).unwrap().scenario.to_yaml().unwrap().into_bytes());
    let before = peak_memory();
    let accepted: usize = std::thread::scope(|scope| {
        let good = &good;
        let workers: Vec<_> =
            [1, 2].map(|seed| scope.spawn(move || try_mutations(seed, 50_000, good))).into_iter().collect();
        workers.into_iter().map(|worker| worker.join().unwrap()).sum()
    });
    assert!(accepted > 5_000, "only {accepted} of 100000 were accepted: the mutations hide what comes after parsing");
    // the file of 100 MB of another test may be in it
    assert!(peak_memory() - before < 200.0, "{before} MB before, {} MB after", peak_memory());
    println!("{accepted} accepted, peak {before:.0} MB before, {:.0} MB after", peak_memory());
}
