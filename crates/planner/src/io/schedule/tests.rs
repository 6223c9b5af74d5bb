use super::*;
use crate::instance::Instance;
use crate::io;

const GRID: &str = "agents:\n- {name: agent0, start: [0, 0], potentialGoals: [[1, 0], [2, 0]]}\n- {name: agent1, start: [0, 1], potentialGoals: []}\nmap: {dimensions: [3, 2]}\n";

fn grid() -> GridInstance {
    let Instance::Grid(grid) = io::read(GRID, "grid.yaml", &io::Options::default()).unwrap() else { panic!() };
    grid
}

fn cars() -> CarInstance {
    let text = "agents:\n- {name: a, start: [2, 3, 1.57], goal: [9.25, 3, 0]}\nmap: {dimensions: [20, 10]}\n";
    let Instance::Car(cars) = io::read(text, "cars.yaml", &io::Options::default()).unwrap() else { panic!() };
    cars
}

fn grid_plan() -> GridPlan {
    let cells = |xs: &[i32], y: i32| xs.iter().map(|x| Cell { x: *x, y }).collect();
    let routes = vec![
        Route { name: "agent0".to_owned(), goal: Some(1), states: cells(&[0, 1, 2], 0) },
        Route { name: "agent1".to_owned(), goal: None, states: cells(&[0], 1) },
    ];
    let claims = Claims { cost: Some(2.0), makespan: Some(2.0), lower_bound: Some(2.0), ..Claims::default() };
    Plan { routes, claims }
}

#[test]
fn what_is_written_is_read_again() {
    let text = write_grid(&grid_plan(), &Statistics::default());
    assert_eq!(read_grid(&text, "plan.yaml", &grid()).unwrap(), grid_plan());

    let states = vec![se2::pose(2.0, 3.0, -1.57), se2::pose(0.1 + 0.2, 1.0 / 3.0, -2.5e-9), se2::pose(9.25, 3.0, 0.0)];
    let routes = vec![Route { name: "a".to_owned(), goal: Some(0), states }];
    let plan = Plan { routes, claims: Claims::default() };
    for heading in [Heading::Clockwise, Heading::CounterClockwise] {
        let text = write_car(&plan, heading, &Statistics::default());
        let again = read_car(&text, "plan.yaml", &cars(), heading).unwrap();
        for (wrote, read) in plan.routes[0].states.iter().zip(&again.routes[0].states) {
            assert_eq!(wrote.translation, read.translation);
            // the yaw is an arc tangent of what is stored: one rounding
            assert!((wrote.rotation.angle() - read.rotation.angle()).abs() <= 1e-15);
        }
    }
}

#[test]
fn yaws_are_written_as_the_instance_has_them() {
    let routes = vec![Route { name: "a".to_owned(), goal: Some(0), states: vec![se2::pose(2.0, 3.0, -1.57)] }];
    let text = write_car(&Plan { routes, claims: Claims::default() }, Heading::Clockwise, &Statistics::default());
    assert!(text.ends_with("schedule:\n  a:\n    - x: 2\n      y: 3\n      yaw: 1.57\n      t: 0\n"), "{text}");
}

#[test]
fn foreign_plans_have_other_orders_and_names_and_no_statistics() {
    let text = "schedule:\n  agent1:\n    - x: 0\n      y: 1\n      t: 0\n  agent0: [{x: 0, y: 0, t: 0}, {x: 1, y: 0, t: 1}]\n";
    let plan = read_grid(text, "plan.yaml", &grid()).unwrap();
    assert_eq!(plan.routes[0].states.len(), 2);
    assert_eq!(plan.routes[0].goal, Some(0));
    assert_eq!(plan.claims, Claims::default());
    // by number where the instance has names of its own
    let named: GridInstance = {
        let text = GRID.replace("agent0", "left").replace("agent1", "right");
        let Instance::Grid(grid) = io::read(&text, "grid.yaml", &io::Options::default()).unwrap() else { panic!() };
        grid
    };
    let plan = read_grid(text, "plan.yaml", &named).unwrap();
    assert_eq!(plan.routes[1].name, "right");
    assert_eq!(plan.routes[1].states, [Cell { x: 0, y: 1 }]);
}

#[test]
fn errors_name_the_place() {
    let message = |text: &str| read_grid(text, "plan.yaml", &grid()).unwrap_err().to_string();
    let agent1 = "  agent1: [{x: 0, y: 1, t: 0}]\n";
    let with = |agent0: &str| message(&format!("schedule:\n  agent0: {agent0}\n{agent1}"));
    assert_eq!(message("statistics: {cost: 1}\n"), "plan.yaml:1:1: `schedule` is missing in the plan");
    assert_eq!(message(GRID), "plan.yaml:1:1: this is an instance, not a plan");
    assert_eq!(message(&format!("schedule:\n{agent1}")), "plan.yaml:2:3: the schedule has no agent `agent0`");
    assert_eq!(with("[]"), "plan.yaml:2:3: the route of `agent0` has no states");
    assert_eq!(
        with("[{x: 0, y: 0, t: 0}, {x: 1, y: 0, t: 2}]"),
        "plan.yaml:2:48: step 2 of `agent0` stands where step 1 must be"
    );
    assert_eq!(with("[{x: 0, y: 0}]"), "plan.yaml:2:12: `t` is missing in a state");
    assert_eq!(with("[{x: 0.5, y: 0, t: 0}]"), "plan.yaml:2:16: `x` must be a whole number, not `0.5`");
    assert_eq!(
        message(&format!("schedule:\n  other: [{{x: 0, y: 0, t: 0}}]\n{agent1}")),
        "plan.yaml:2:3: the instance has no agent `other`"
    );
    let no_yaw = read_car("schedule: {a: [{x: 0, y: 0, t: 0}]}", "plan.yaml", &cars(), Heading::Clockwise);
    assert_eq!(no_yaw.unwrap_err().to_string(), "plan.yaml:1:20: `yaw` is missing in a state");
}
