use super::*;
use crate::instance::Drive;
use crate::io;

fn read_grid(text: &str) -> GridInstance {
    match read(text, "a.yaml", &Options::default()).unwrap() {
        Instance::Grid(grid) => grid,
        Instance::Car(_) => panic!("read as cars"),
    }
}

fn read_car(text: &str) -> CarInstance {
    match read(text, "a.yaml", &Options::default()).unwrap() {
        Instance::Car(car) => car,
        Instance::Grid(_) => panic!("read as a grid"),
    }
}

fn message(text: &str) -> String {
    read(text, "a.yaml", &Options::default()).unwrap_err().to_string()
}

#[test]
fn grid_with_goals_of_their_own() {
    let text = "agents:\n-   goal: [3, 1]\n    name: agent0\n    start: [0, 3]\nmap:\n    dimensions: [8, 4]\n    obstacles:\n    - [5, 3]\n    - [9, 9]\n";
    let grid = read_grid(text);
    assert_eq!((grid.width, grid.height), (8, 4));
    assert_eq!(grid.blocked.iter().filter(|blocked| **blocked).count(), 1);
    assert!(!grid.is_free(Cell { x: 5, y: 3 }));
    assert!(!grid.assignment);
    assert_eq!(grid.agents[0].goals, [Cell { x: 3, y: 1 }]);
}

#[test]
fn grid_with_goals_to_be_assigned() {
    let text = "agents:\n- name: a\n  potentialGoals:\n  - [1, 2]\n  - [0, 0]\n  start: [4, 3]\n- name: b\n  potentialGoals: []\n  start: [5, 3]\nmap:\n  dimensions: [8, 4]\n  obstacles: null\n";
    let grid = read_grid(text);
    assert!(grid.assignment);
    assert_eq!(grid.agents[0].goals.len(), 2);
    assert!(grid.agents[1].goals.is_empty());
}

/// In CL-CBS's files the body points along (cos yaw, −sin yaw).
#[test]
fn yaws_of_cars_turn_clockwise_unless_told() {
    let text = "agents:\n  - start: [21, 2, 0]\n    name: agent0\n    goal: [7, 14, 1.57]\nmap:\n  dimensions: [50, 50]\n  obstacles: \n    - [29.5, 48.7]\n";
    let car = read_car(text);
    assert_eq!(se2::yaw(&car.agents[0].goals[0]), -1.57);
    assert_eq!(car.obstacles, [Obstacle::Point { at: Point2::new(29.5, 48.7), radius: 0.8 }]);
    assert_eq!(car.vehicle, crate::instance::Vehicle::default());
    let turned = read_car(&format!("{text}heading: counterclockwise\n"));
    assert_eq!(se2::yaw(&turned.agents[0].goals[0]), 1.57);
}

#[test]
fn bodies_may_be_described_in_the_file() {
    let text = "agents: [{start: [1, 1, 0], potentialGoals: [[2, 2, 0], [3, 3, 0]]}]\nvehicle: {drive: differential, LF: 0.5, LB: 0.5, carWidth: 0.6, obsRadius: 0.2}\nmap:\n  dimensions: [10.5, 5]\n  obstacles: [[4, 4]]\n  polygons: [[[5, 1], [5, 2], [6, 2], [6, 1]]]\n";
    let car = read_car(text);
    assert!(car.assignment);
    assert_eq!(car.agents[0].name, "agent0");
    assert_eq!(car.vehicle.drive, Drive::Differential);
    assert_eq!(car.obstacles[0], Obstacle::Point { at: Point2::new(4.0, 4.0), radius: 0.2 });
    let corners = [[6.0, 1.0], [6.0, 2.0], [5.0, 2.0], [5.0, 1.0]].map(Point2::from);
    assert_eq!(car.obstacles[1], Obstacle::Polygon(corners.to_vec()), "counter-clockwise");
    // the command's own configuration goes first
    let options = Options { config: Some(Config::default()), agents: None };
    let Instance::Car(usual) = read(text, "a.yaml", &options).unwrap() else { panic!() };
    assert_eq!(usual.vehicle.drive, Drive::Car);
}

#[test]
fn what_is_written_is_read_again() {
    let grid = "agents:\n- {name: a, start: [0, 3], potentialGoals: [[3, 1], [2, 2]]}\n- {name: 'b c', start: [0, 2], potentialGoals: []}\nmap: {dimensions: [8, 4], obstacles: [[5, 3]]}\n";
    let car = "agents: [{name: \"null\", start: [1, 1, 0.25], goal: [2, 2.25, -3]}]\nvehicle: {drive: forward_car, obsRadius: 0.2, stepTime: 0.5}\nheading: counterclockwise\nmap: {dimensions: [10.5, 5], obstacles: [[4, 4]], polygons: [[[5, 1], [6, 1], [6, 2]]]}\n";
    let plain = "agents: [{name: x, start: [1, 1, 0], goal: [2, 2, 1.57]}]\nmap: {dimensions: [10, 5]}\n";
    for text in [grid, car, plain] {
        let document = read_document(text, "a.yaml", &Options::default()).unwrap();
        let written = io::write(&document.instance, document.heading);
        let again = read_document(&written, "a.yaml", &Options::default()).unwrap();
        assert_eq!(again.instance, document.instance, "{written}");
        assert_eq!(again.heading, document.heading);
    }
}

#[test]
fn only_the_first_agents_may_be_asked_for() {
    let text = "agents: [{start: [0, 0], goal: [1, 1]}, {start: [2, 0], goal: [3, 1]}]\nmap: {dimensions: [8, 4]}";
    let options = |agents| Options { config: None, agents: Some(agents) };
    assert_eq!(read(text, "a.yaml", &options(1)).unwrap().agents(), 1);
    let few = read(text, "a.yaml", &options(3)).unwrap_err();
    assert_eq!(few.to_string(), "a.yaml:1:9: 3 agents were asked for, and the file has 2");
    assert_eq!(few.remedy(), "ask for at most 2");
}

#[test]
fn errors_name_the_place() {
    let with = |agent: &str| message(&format!("agents: [{agent}]\nmap: {{dimensions: [8, 4]}}"));
    assert_eq!(message(""), "a.yaml:1:1: `agents` is missing in the file");
    assert_eq!(message("[]"), "a.yaml:1:1: `the file` must be a map, not a list of 0");
    assert_eq!(
        message("agents: []\nmap: {dimensions: [8]}"),
        "a.yaml:2:19: `dimensions` must be two whole numbers [columns, rows], not a list of 1"
    );
    assert_eq!(
        message("agents: []\nmap: {dimensions: [0, 4]}"),
        "a.yaml:2:20: `dimensions` is 0; it must be between 1 and 16777216"
    );
    assert_eq!(
        message("agents: []\nmap: {dimensions: [5000, 5000]}"),
        "a.yaml:2:19: a map of 5000 × 5000 has 25000000 cells, at most 16777216 are read"
    );
    assert_eq!(with("{name: a, start: [1, 2], gaol: [1, 1]}"), "a.yaml:1:35: unknown key `gaol` in an agent");
    assert_eq!(with("{name: a, start: [1, 2]}"), "a.yaml:1:10: `goal` is missing in an agent");
    assert_eq!(with("{name: a, goal: [1, 2]}"), "a.yaml:1:10: `start` is missing in an agent");
    assert_eq!(with("{name: a, start: [1, 2], goal: [1, x]}"), "a.yaml:1:45: `goal` must be a whole number, not `x`");
    assert_eq!(
        with("{name: a, start: [1, 2], goal: [1, \"2\"]}"),
        "a.yaml:1:45: `goal` must be a whole number, not the text \"2\""
    );
    assert_eq!(
        with("{name: a, start: [1, 2], goal: [1, 2, 3]}"),
        "a.yaml:1:41: `goal` must be a cell [x, y] of two whole numbers, not a list of 3"
    );
    assert_eq!(
        with("{name: a, start: [1, 2], goal: [1, 2], potentialGoals: []}"),
        "a.yaml:1:10: an agent has both `goal` and `potentialGoals`"
    );
    assert_eq!(
        with("{name: a, start: [1, 2], goal: [1, 2]}, {name: a, start: [1, 3], goal: [1, 1]}"),
        "a.yaml:1:67: two agents are called `a`"
    );
    assert_eq!(with("{name: a, start: [1, 2, 0], goal: [1, 2, .nan]}").split(": ").next(), Some("a.yaml:1:51"));
    assert_eq!(
        with("{name: a, start: [1, 2, 0], goal: [1, 2e7, 0]}"),
        "a.yaml:1:48: `goal` is 20000000; it must be between -1000000 and 1000000"
    );
    assert_eq!(message("schedule: {}"), "a.yaml:1:1: this is a plan, not an instance");
    assert_eq!(message("type octile\nheight 3"), "a.yaml:1:1: this is a MovingAI file, of which two make an instance");
    assert_eq!(
        message("agents: []\nheading: left\nmap: {dimensions: [8, 4]}"),
        "a.yaml:2:10: `heading` must be `clockwise` or `counterclockwise`, not `left`"
    );
    let polygon =
        |corners: &str| message(&format!("agents: []\nmap:\n  dimensions: [8, 4]\n  polygons:\n  - {corners}"));
    assert_eq!(polygon("[[0, 0], [2, 0], [1, 0.2], [1, 1]]"), "a.yaml:5:5: the polygon is not convex, or has no area");
    assert_eq!(polygon("[[0, 0], [2, 0], [1, 0]]"), "a.yaml:5:5: the polygon is not convex, or has no area");
    // a needle, found by fuzzing: nobody could say whether it is convex
    assert_eq!(polygon("[[20, 20], [24, 20], [1000000, 23]]"), "a.yaml:5:5: the polygon is not convex, or has no area");
    assert_eq!(
        polygon("[[0, 0], [2, 0]]"),
        "a.yaml:5:5: `polygons` must be polygons of 3 to 1000 corners [x, y], not a list of 2"
    );
}

#[test]
fn aliases_and_depth_are_limited() {
    let bomb = "a: &a [x, x, x, x, x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a, *a, *a, *a, *a]\nc: &c [*b, *b, *b, *b, *b, *b, *b, *b, *b]\nd: &d [*c, *c, *c, *c, *c, *c, *c, *c, *c]\ne: &e [*d, *d, *d, *d, *d, *d, *d, *d, *d]\nf: &f [*e, *e, *e, *e, *e, *e, *e, *e, *e]\n";
    assert!(message(bomb).contains("not valid YAML"), "{}", message(bomb));
    let deep = format!("agents: {}{}", "[".repeat(5000), "]".repeat(5000));
    assert!(message(&deep).contains("not valid YAML"), "{}", message(&deep));
    // aliases within reason are read
    let shared = "agents:\n- {name: a, start: [1, 1], potentialGoals: &goals [[2, 2], [3, 3]]}\n- {name: b, start: [0, 0], potentialGoals: *goals}\nmap: {dimensions: [8, 4]}\n";
    assert_eq!(read_grid(shared).agents[1].goals.len(), 2);
}
