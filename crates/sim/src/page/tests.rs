use super::*;

fn hostile() -> Replay {
    let name = "</script><script>alert(1)</script> {{script}} <!-- & \"'\u{2028}\u{1}".to_owned();
    Replay {
        title: name.clone(),
        description: name.clone(),
        version: name.clone(),
        world: name.clone(),
        loads: vec![ReplayLoad { id: name.clone(), polygon: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] }],
        robots: vec![ReplayRobot { name: name.clone(), radius: 0.1, ..ReplayRobot::default() }],
        teams: vec![ReplayTeam { id: name.clone(), waypoints: vec![[1.0, 1.0]], ..ReplayTeam::default() }],
        frames: vec![Frame {
            loads: vec![[0.0; 3]],
            robots: vec![RobotFrame::default()],
            teams: vec![TeamFrame::default()],
            ..Frame::default()
        }],
        events: vec![ReplayEvent { time: 0.0, text: name.clone() }],
        outcome: vec![(name.clone(), name)],
        ..Replay::default()
    }
}

/// The page has exactly the script elements of the template, whatever the names are.
#[test]
fn names_cannot_leave_their_place_in_the_page() {
    let html = render(&hostile());
    let plain = render(&Replay::default());
    for tag in ["<script", "</script", "<!--"] {
        assert_eq!(html.matches(tag).count(), plain.matches(tag).count(), "{tag}");
    }
    assert!(html.contains("{{script}}"), "a name that looks like a placeholder stays a name");
}

#[test]
fn names_cannot_leave_their_place_in_the_picture() {
    let svg = picture(&hostile());
    assert!(!svg.contains("<script") && !svg.contains('\u{1}'), "{svg}");
}

#[test]
fn the_same_replay_gives_the_same_bytes() {
    assert_eq!(render(&hostile()), render(&hostile().clone()));
    assert_eq!(picture(&hostile()), picture(&hostile().clone()));
}

/// A mission may end before its first frame, or log what is not a number.
#[test]
fn missing_frames_and_numbers_still_give_a_page() {
    assert!(render(&Replay::default()).ends_with("</html>\n"));
    assert!(picture(&Replay::default()).ends_with("</svg>\n"));
    let mut broken = hostile();
    broken.frames[0].loads[0] = [f64::NAN, f64::INFINITY, 0.0];
    broken.frames.push(Frame { time: 1.0, ..Frame::default() });
    assert!(!picture(&broken).contains("NaN") && !picture(&broken).contains("inf"));
    assert!(render(&broken).ends_with("</html>\n"));
}

/// The largest mission there is: 1500 s, two loads, twelve robots, logged at 40 Hz.
#[test]
fn the_page_of_a_long_mission_stays_below_two_megabytes() {
    let frames = (0..=60_000)
        .map(|i| {
            let time = f64::from(i) * 0.025;
            // half of the highest speed and yaw rate of the robots, with all digits in use
            let pose = |k: f64| [0.1 * time + k, (0.3 * time + k).sin(), (1.5 * time + k).sin()];
            let robot = |k: u32| RobotFrame {
                pose: pose(f64::from(k)),
                command: [0.1 * (time + f64::from(k)).sin(), 2.0 * (0.7 * time).sin()],
                speed: 0.2 * (time * 0.9).sin(),
                role: Role::ALL.get((i / 200) as usize % 4).copied(),
                ..RobotFrame::default()
            };
            Frame {
                time,
                loads: vec![pose(0.5), pose(1.5)],
                robots: (0..12).map(robot).collect(),
                teams: vec![TeamFrame { distance: 3.0 - 1e-3 * time, ..TeamFrame::default() }; 2],
            }
        })
        .collect();
    let replay = Replay {
        loads: vec![ReplayLoad::default(); 2],
        robots: vec![ReplayRobot::default(); 12],
        teams: vec![ReplayTeam::default(); 2],
        frames,
        ..Replay::default()
    };
    let bytes = render(&replay).len();
    assert!(bytes < 2_000_000, "{bytes}");
}

#[test]
fn a_robot_shows_what_it_does_before_its_role() {
    let robot = |phase| Activity::of(&RobotFrame { role: Some(Role::Push), phase, ..RobotFrame::default() });
    assert_eq!(robot(Phase::Work), Activity::Push);
    assert_eq!(robot(Phase::Slide), Activity::Reposition);
    assert_eq!(robot(Phase::Hold), Activity::Hold);
    assert_eq!(robot(Phase::Done), Activity::Hold);
}

/// Two agents on a 3 × 2 grid of which the second drives through the first, and a hostile name.
fn planned() -> (cohaul_planner::instance::GridInstance, cohaul_planner::plan::GridPlan) {
    use cohaul_planner::instance::{Cell, GridAgent, GridInstance};
    use cohaul_planner::plan::{Claims, GridPlan, Route};

    let name = "</script><script>alert(1)</script>\u{1}";
    let row = |cells: [i32; 3]| cells.map(|x| Cell { x, y: 0 }).to_vec();
    let states = [row([0, 1, 2]), row([2, 1, 0])];
    let agents = states.iter().map(|s| GridAgent { name: name.into(), start: s[0], goals: vec![s[2]] }).collect();
    let instance = GridInstance { width: 3, height: 2, blocked: vec![false; 6], agents, assignment: false };
    let routes = states.map(|states| Route { name: name.into(), goal: Some(0), states }).to_vec();
    (instance, GridPlan { routes, claims: Claims::default() })
}

#[test]
fn a_plan_has_a_page_and_a_picture_with_its_violations() {
    let (instance, plan) = planned();
    let planned = Planned::Grid(&instance, &plan);
    let violations = cohaul_planner::certify::grid(&instance, &plan);
    assert_eq!(violations.len(), 1);
    let (html, svg) = (plan_page("two", planned, &violations), plan_picture("two", planned, &violations));
    assert_eq!(html.matches("<script").count(), render(&Replay::default()).matches("<script").count());
    assert!(html.contains("are both in (1, 0)") && svg.contains("are both in (1, 0)"));
    assert!(svg.contains("1 violation<") && svg.contains("class=\"ring\""), "{svg}");
    assert!(!svg.contains("<script") && !svg.contains('\u{1}'));
    assert!(plan_picture("two", planned, &[]).contains(">certified<"));
    assert_eq!(html, plan_page("two", planned, &violations));
}

/// Nothing that a plan can hold keeps it from being drawn.
#[test]
fn plans_that_make_no_sense_are_drawn() {
    use cohaul_planner::instance::{CarInstance, Obstacle, Vehicle};
    use cohaul_planner::plan::{CarPlan, Claims, Route};

    let (mut instance, mut plan) = planned();
    instance.width = i32::MIN;
    plan.routes[0].states.clear();
    plan.routes[1].goal = Some(9);
    let drawn = plan_picture("x", Planned::Grid(&instance, &plan), &[]);
    assert!(!drawn.contains("NaN") && !drawn.contains("inf"));
    let states = vec![cohaul_core::se2::pose(f64::NAN, 1e300, 0.0), cohaul_core::se2::pose(1.0, f64::INFINITY, 1.0)];
    let routes = vec![Route { name: String::new(), goal: None, states }];
    let instance = CarInstance {
        free_starts: false,
        width: f64::NAN,
        height: 1.0,
        obstacles: vec![Obstacle::Polygon(vec![])],
        vehicle: Vehicle { front: f64::NAN, ..Vehicle::default() },
        agents: vec![],
        assignment: true,
    };
    let plan = CarPlan { routes, claims: Claims { cost: Some(f64::NAN), ..Claims::default() } };
    let planned = Planned::Car(&instance, &plan);
    assert!(plan_page("x", planned, &[]).ends_with("</html>\n"));
    assert!(plan_picture("x", planned, &[]).ends_with("</svg>\n"));
}
