use cohaul_core::control::*;
use cohaul_core::id::*;
use cohaul_core::time::Time;
use cohaul_sim::episode::*;
use cohaul_sim::error::SimError;
use cohaul_sim::world::World;
struct R {
    next: f64,
    every: f64,
}
impl Recorder for R {
    fn memory(&mut self, _: Time, _: RobotId, _: &str) -> Result<(), SimError> {
        Ok(())
    }
    fn decision(&mut self, _: &Observation, _: &Decision) -> Result<(), SimError> {
        Ok(())
    }
    fn state(&mut self, w: &dyn World, d: &[Decision]) -> Result<(), SimError> {
        let t = w.time().seconds();
        if t < self.next {
            return Ok(());
        }
        self.next += self.every;
        let p = w.load_pose(LoadId(0));
        let v = w.load_twist(LoadId(0));
        println!(
            "t {t:.2} load ({:.3},{:.3},{:.1}°) v ({:.3},{:.3},{:.3}) wp {} e {:.1}° d {:.2} {:?}",
            p.translation.x,
            p.translation.y,
            p.rotation.angle().to_degrees(),
            v.linear.x,
            v.linear.y,
            v.angular,
            d[0].waypoint,
            d[0].heading_error.to_degrees(),
            d[0].distance,
            d[0].primitive
        );
        for (i, x) in d.iter().enumerate() {
            let s = w.robot_speeds(RobotId(i as u16));
            println!(
                "    {} {:?} {:?} tan {:.3} gap {:.3} hd {:.1}° cmd ({:.2},{:.2}) act ({:.2},{:.2}) F {:.2} {:?}",
                i + 1,
                x.role,
                x.phase,
                x.slot_tangential,
                x.slot_gap,
                x.slot_heading.to_degrees(),
                x.command.linear,
                x.command.angular,
                s.linear,
                s.angular,
                w.traction(RobotId(i as u16)),
                x.fault
            );
        }
        Ok(())
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let s = include_str!("trace.json");
    let mut s: cohaul_core::scenario::document::Scenario = serde_json::from_str(s).unwrap();
    s.terrain.slope_deg = a[1].parse().unwrap();
    s.seed = a[2].parse().unwrap();
    s.teams[0].mission.time_limit = a[3].parse().unwrap();
    if let Some(k) = a.get(5) {
        s.teams[0].controller = cohaul_core::scenario::document::Controller::R2p2(serde_json::from_str(k).unwrap());
    }
    if let Some(k) = a.get(6) {
        s.loads[0].mass = k.parse().unwrap();
    }
    if let Some(k) = a.get(7) {
        s.terrain.friction.dynamic = k.parse().unwrap();
    }
    let o = run(&s, &mut R { next: 0.0, every: a[4].parse().unwrap() }, &mut |_, _| false).unwrap();
    println!("{o:?}");
}
