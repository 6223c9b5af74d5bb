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
