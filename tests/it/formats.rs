//! Files of planning problems and plans: mutated ones, foreign ones, the command on them.
//!
//! `COHAUL_FUZZ=100000 cargo test --release -p cohaul-tests mutated` mutates each file as often as that.

use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};

use cohaul_planner::generate::{self, CarShape, Goals, GridShape};
use cohaul_planner::instance::{Drive, Instance, Obstacle, Vehicle};
use cohaul_planner::io::{self, Document, FormatError, Heading, movingai, schedule};
use cohaul_planner::outcome::{Ended, Outcome};
use cohaul_planner::plan::{Claims, Plan, Route};
use cohaul_planner::search::Budget;
use cohaul_planner::{car, certify, grid};

/// Most that one file may make the reader and the planner hold at once, bytes.
const MEMORY: u64 = 1 << 30;
/// CPU time that a planner is given, and by how much it may miss that, s.
const DEADLINE: f64 = 0.05;
const OVERRUN: f64 = 0.05;

fn mutations() -> u64 {
    std::env::var("COHAUL_FUZZ").ok().and_then(|text| text.parse().ok()).unwrap_or(2_000)
}

/// CPU time of this thread, s, where the system tells it.
fn cpu() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse::<f64>().ok().map(|nanoseconds| nanoseconds * 1e-9)
}

struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, below: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % below.max(1)
    }
}

const PIECES: [&str; 40] = [
    "-",
    ":",
    " ",
    "\n",
    "[",
    "]",
    "{",
    "}",
    ",",
    "#",
    "'",
    "\"",
    "\t",
    "\r\n",
    "- ",
    ": ",
    "&a ",
    "*a",
    "!t ",
    "|",
    "---\n",
    "~",
    "ö",
    "\u{0}",
    "potentialGoals: []\n",
    "goal: [1, 1]\n",
    "map:\n",
    "heading: counterclockwise\n",
    "vehicle: {drive: differential}\n",
    "polygons: [[[0, 0], [9, 0], [9, 9]]]\n",
    "agent1",
    "null",
    "[[[[",
    "@",
    ".",
    "width 9\n",
    "agents:\n",
    "<<: *a",
    "t: 0",
    "]]",
];
const NUMBERS: [&str; 22] = [
    "0",
    "-1",
    "1",
    "2",
    "3.5",
    "1e9",
    "99999999999",
    "nan",
    ".nan",
    ".inf",
    "-.inf",
    "1e308",
    "1e-308",
    "0.0001",
    "16777216",
    "4096",
    "1000000",
    "-0",
    "2147483648",
    "9223372036854775808",
    "1e5",
    "100000",
];

/// One to four changes to a text: numbers, lines, pieces of syntax, what lies between two places.
fn mutate(text: &str, seed: u64) -> String {
    let mut random = Random::new(seed);
    random.below(2);
    let mut text = text.to_owned();
    for _ in 0..1 + random.below(4) {
        let mut at = random.below(text.len() + 1);
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        match random.below(8) {
            0..=2 => {
                // the number at or after the place
                let is_digit = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
                if let Some(from) = text[at..].find(|c: char| c.is_ascii_digit()).map(|found| at + found) {
                    let to = text[from..].find(|c| !is_digit(c)).map_or(text.len(), |found| from + found);
                    text.replace_range(from..to, NUMBERS[random.below(NUMBERS.len())]);
                }
            }
            3 => text.insert_str(at, PIECES[random.below(PIECES.len())]),
            4 => {
                let end =
                    text.char_indices().map(|(i, _)| i).find(|i| *i > at + random.below(12)).unwrap_or(text.len());
                text.replace_range(at..end.max(at), "");
            }
            5 | 6 => {
                let mut lines: Vec<&str> = text.lines().collect();
                let (one, other) = (random.below(lines.len()), random.below(lines.len()));
                match random.below(3) {
                    0 if !lines.is_empty() => lines.swap(one, other),
                    1 if !lines.is_empty() => {
                        lines.remove(one);
                    }
                    _ if !lines.is_empty() => lines.insert(one, lines[other]),
                    _ => {}
                }
                text = lines.join("\n");
            }
            _ => text.truncate(if random.below(8) == 0 { at } else { text.len() }),
        }
    }
    text
}

/// Says which file it was, should the test panic over it.
struct Blame<'a> {
    name: &'a str,
    seed: u64,
    text: &'a str,
}

impl Drop for Blame<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("{}, seed {}:\n{}", self.name, self.seed, self.text);
        }
    }
}

/// Plans within the deadline where the instance is small, and certifies what comes out. Gives whether it was planned.
fn plan(document: &Document) -> bool {
    let cells = match &document.instance {
        Instance::Grid(grid) => f64::from(grid.width) * f64::from(grid.height),
        Instance::Car(car) => car.width * car.height / car.vehicle.step_length().powi(2),
        _ => return false,
    };
    if document.instance.agents() > 100 || cells > 1e5 {
        return false;
    }
    let Some(began) = cpu() else { return false };
    let asked = Cell::new(0);
    let stop = || {
        asked.set(asked.get() + 1);
        cpu().is_some_and(|now| now - began >= DEADLINE)
    };
    let budget = Budget::new(u64::MAX, &stop);
    let violations = match &document.instance {
        Instance::Grid(instance) => {
            let Ended { outcome, .. } =
                grid::solve(instance, &grid::Options { planner: grid::Planner::Ecbs, bound: 1.3 }, &budget);
            check_deadline(began);
            match outcome {
                Outcome::Solved(plan) => certify::grid(instance, &plan),
                _ => Vec::new(),
            }
        }
        Instance::Car(instance) => {
            let Ended { outcome, .. } = car::solve(instance, &car::Options::default(), &budget);
            check_deadline(began);
            match outcome {
                Outcome::Solved(plan) => certify::car(instance, &plan, certify::Model::Clcbs),
                _ => Vec::new(),
            }
        }
        _ => Vec::new(),
    };
    assert!(violations.is_empty(), "{}", violations[0]);
    true
}

fn check_deadline(began: f64) {
    let took = cpu().unwrap_or(began) - began;
    assert!(took <= DEADLINE + OVERRUN, "{took:.3} s of CPU time for a deadline of {DEADLINE} s");
}

/// Mutates `text` and gives each to `read`; counts how many of them it takes.
fn fuzz(name: &str, text: &str, read: impl Fn(&str) -> Result<bool, FormatError>) {
    let (mut taken, mut planned) = (0, 0);
    for seed in 0..mutations() {
        let mutated = mutate(text, seed);
        let _blame = Blame { name, seed, text: &mutated };
        let mut result = Ok(false);
        let memory = allocation_counter::measure(|| result = read(&mutated));
        assert!(memory.bytes_max <= MEMORY, "{} MiB", memory.bytes_max >> 20);
        match result {
            Ok(was_planned) => {
                taken += 1;
                planned += u64::from(was_planned);
            }
            Err(error) => {
                assert!(error.line() >= 1 && error.column() >= 1 && !error.remedy().is_empty(), "{error}");
            }
        }
    }
    println!("{name}: {} mutations, {taken} read, {planned} planned", mutations());
    assert!(taken * 50 > mutations(), "{name}: only {taken} were read");
}

fn read_and_plan(text: &str) -> Result<bool, FormatError> {
    Ok(plan(&io::read_document(text, "fuzzed.yaml", &io::Options::default())?))
}

fn small_grid(goals: Goals) -> cohaul_planner::instance::GridInstance {
    generate::grid(&GridShape { width: 8, height: 8, obstacles: 12, agents: 4, goals }, 1).unwrap()
}

fn small_cars(drive: Drive, goals: Goals) -> cohaul_planner::instance::CarInstance {
    let vehicle = Vehicle { drive, ..Vehicle::default() };
    generate::car(&CarShape { size: 50, obstacles: 10, obstacle_radius: 0.8, agents: 4, goals, vehicle }, 1).unwrap()
}

#[test]
fn mutated_grids_are_read_or_refused() {
    fuzz("grid", &io::write(&Instance::Grid(small_grid(Goals::Own)), Heading::default()), read_and_plan);
}

#[test]
fn mutated_grids_with_assignment_are_read_or_refused() {
    fuzz("assignment", &io::write(&Instance::Grid(small_grid(Goals::Window(2))), Heading::default()), read_and_plan);
}

#[test]
fn mutated_cars_are_read_or_refused() {
    fuzz("cars", &io::write(&Instance::Car(small_cars(Drive::Car, Goals::Own)), Heading::default()), read_and_plan);
}

#[test]
fn mutated_bodies_of_other_kinds_are_read_or_refused() {
    let mut cars = small_cars(Drive::Differential, Goals::Own);
    let corners = [[20.0, 20.0], [24.0, 20.0], [22.0, 23.0]].map(nalgebra::Point2::from);
    cars.obstacles.push(Obstacle::Polygon(corners.to_vec()));
    fuzz("bodies", &io::write(&Instance::Car(cars), Heading::CounterClockwise), read_and_plan);
}

#[test]
fn mutated_configurations_are_read_or_refused() {
    let text = "r: 3\ndeltat: 0.706\npenaltyTurning: 1.5\npenaltyReversing: 2.0\npenaltyCOD: 2.0\nmapResolution: 2.0\ncarWidth: 2.0\nLF: 2.0\nLB: 1.0\nobsRadius: 0.8\nconstraintWaitTime: 2\ndrive: car\nstepTime: 1\n";
    let cars = io::write(&Instance::Car(small_cars(Drive::Car, Goals::Own)), Heading::default());
    fuzz("configuration", text, |text| {
        let config = Some(io::read_config(text, "fuzzed.yaml")?);
        Ok(plan(&io::read_document(&cars, "cars.yaml", &io::Options { config, agents: None })?))
    });
}

#[test]
fn mutated_maps_and_scenarios_are_read_or_refused() {
    let (map, scenario) = movingai::write(&small_grid(Goals::Own), "a.map");
    let read = |map: &str, scenario: &str| {
        let map = movingai::Text { name: "a.map", text: map };
        let scenario = movingai::Text { name: "a.scen", text: scenario };
        let instance = Instance::Grid(movingai::read(map, scenario, None)?);
        Ok(plan(&Document { instance, heading: Heading::default() }))
    };
    fuzz("map", &map, |text| read(text, &scenario));
    fuzz("scenario", &scenario, |text| read(&map, text));
}

#[test]
fn mutated_plans_are_read_or_refused() {
    let instance = small_grid(Goals::Own);
    let routes = instance.agents.iter().map(|agent| Route {
        name: agent.name.clone(),
        goal: Some(0),
        states: vec![agent.start, agent.goals[0]],
    });
    let plan = Plan { routes: routes.collect(), claims: Claims { cost: Some(4.0), ..Claims::default() } };
    fuzz("schedule of a grid", &schedule::write_grid(&plan, &schedule::Statistics::default()), |text| {
        certify::grid(&instance, &schedule::read_grid(text, "fuzzed.yaml", &instance)?);
        Ok(false)
    });
    let instance = small_cars(Drive::Car, Goals::All);
    let routes = instance.agents.iter().map(|agent| Route {
        name: agent.name.clone(),
        goal: Some(0),
        states: vec![agent.start, agent.goals[0]],
    });
    let plan = Plan { routes: routes.collect(), claims: Claims::default() };
    fuzz(
        "schedule of cars",
        &schedule::write_car(&plan, Heading::default(), &schedule::Statistics::default()),
        |text| {
            let plan = schedule::read_car(text, "fuzzed.yaml", &instance, Heading::default())?;
            certify::car(&instance, &plan, certify::Model::Exact);
            Ok(false)
        },
    );
}

/// Files that other programs come with, where they are at hand.
fn foreign(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/bench").join(folder);
    let Ok(entries) = fs::read_dir(&folder) else {
        eprintln!("skipped: {} is not here", folder.display());
        return Vec::new();
    };
    let mut found: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    found.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("map_")));
    found.sort();
    found
}

#[test]
fn foreign_instances_are_read_and_written_again() {
    for path in ["grid", "ta", "cl_cbs"].into_iter().flat_map(foreign) {
        let name = path.display().to_string();
        let document = io::read_document(&fs::read_to_string(&path).unwrap(), &name, &io::Options::default()).unwrap();
        let text = io::write(&document.instance, document.heading);
        let again = io::read_document(&text, &name, &io::Options::default()).unwrap();
        assert_eq!(again, document, "{name}");
        let number = |key: &str| -> usize {
            let (_, rest) = name.rsplit_once(key).unwrap();
            rest.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse().unwrap()
        };
        assert_eq!(document.instance.agents(), number("agents"), "{name}");
        match &document.instance {
            Instance::Grid(grid) => {
                assert_eq!(grid.blocked.iter().filter(|blocked| **blocked).count(), number("obst"), "{name}");
                assert_eq!(grid.assignment, name.contains("/ta/"));
            }
            // the files without obstacles have one outside of the map
            Instance::Car(car) => assert_eq!(car.obstacles.len(), number("obst").max(1), "{name}"),
            _ => panic!("{name}"),
        }
    }
}

fn cohaul(arguments: &[&str]) -> i32 {
    let arguments = ["cohaul"].iter().chain(arguments).map(|text| (*text).to_owned()).collect();
    cohaul_sim::cli::main(arguments, &|| false)
}

/// From nothing to a certified plan, for every kind that is generated.
#[test]
fn what_is_generated_is_planned_and_certified() {
    let folder = std::env::temp_dir().join(format!("cohaul-formats-{}", std::process::id()));
    let folder_text = folder.display().to_string();
    for kind in ["grid", "grid-all", "grid-window", "movingai", "car"] {
        let out = format!("{folder_text}/{kind}");
        let size = if kind == "car" { "50" } else { "8" };
        let size = ["--size", size, "--agents", "4", "--count", "2", "--seed", "5", "--out", &out];
        assert_eq!(cohaul(&[&["generate", kind], &size[..]].concat()), 0);
        let mut planned = 0;
        for entry in fs::read_dir(&out).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "map") {
                continue;
            }
            let (file, plan) = (path.display().to_string(), format!("{out}/plan"));
            assert_eq!(cohaul(&["plan", &file, "--out", &plan, "--timeout", "20"]), 0, "{file}");
            assert_eq!(cohaul(&["certify", &plan, "--instance", &file]), 0, "{file}");
            planned += 1;
        }
        assert_eq!(planned, 2);
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn exit_statuses_say_how_it_went() {
    let folder = std::env::temp_dir().join(format!("cohaul-statuses-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| {
        fs::write(folder.join(name), text).unwrap();
        folder.join(name).display().to_string()
    };
    let map = "map: {dimensions: [4, 1], obstacles: [[2, 0]]}\n";
    let good = write("good.yaml", &format!("agents: [{{name: a, start: [0, 0], goal: [1, 0]}}]\n{map}"));
    let walled = write("walled.yaml", &format!("agents: [{{name: a, start: [0, 0], goal: [3, 0]}}]\n{map}"));
    let bad = write("bad.yaml", "agents: [");
    let plan = write("plan.yaml", "schedule: {a: [{x: 0, y: 0, t: 0}, {x: 1, y: 0, t: 1}]}");
    let jump = write("jump.yaml", "schedule: {a: [{x: 0, y: 0, t: 0}, {x: 3, y: 0, t: 1}]}");
    assert_eq!(cohaul(&["plan", &good]), 0);
    assert_eq!(cohaul(&["plan", &walled]), 1);
    assert_eq!(cohaul(&["plan", &good, "--timeout", "0"]), 1);
    assert_eq!(cohaul(&["plan", &bad]), 3);
    assert_eq!(cohaul(&["plan", "no such file"]), 3);
    assert_eq!(cohaul(&["plan", &plan]), 3);
    assert_eq!(cohaul(&["plan", &good, "--planner", "cl-cbs"]), 2);
    assert_eq!(cohaul(&["plan", &good, "--bound", "0.5"]), 2);
    assert_eq!(cohaul(&["certify", &plan, "--instance", &good]), 0);
    assert_eq!(cohaul(&["certify", &jump, "--instance", &good]), 1);
    assert_eq!(cohaul(&["certify", &bad, "--instance", &good]), 3);
    assert_eq!(cohaul(&["generate", "grid", "--agents", "0", "--out", &folder.display().to_string()]), 2);
    fs::remove_dir_all(&folder).unwrap();
}

/// A hundred agents are read in well under a millisecond: planning small instances takes not much longer.
#[test]
fn reading_takes_little_time() {
    let shape = CarShape {
        size: 300,
        obstacles: 100,
        obstacle_radius: 0.8,
        agents: 100,
        goals: Goals::Own,
        vehicle: Vehicle::default(),
    };
    let text = io::write(&Instance::Car(generate::car(&shape, 1).unwrap()), Heading::default());
    let Some(began) = cpu() else { return };
    for _ in 0..50 {
        io::read_document(&text, "cars.yaml", &io::Options::default()).unwrap();
    }
    let each = (cpu().unwrap() - began) / 50.0;
    assert!(each < 1e-3, "{each} s");
}
