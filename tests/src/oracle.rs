//! Closed forms that the worlds and planners are tested against.

use cohaul_core::contact::limit_surface::rectangle_dissipation;
use cohaul_core::contact::slope::GRAVITY;
use cohaul_core::se2::Twist2;

/// Stopping distance of a load that slides at `speed` (m/s) uphill on a slope of `angle` (rad): v² / 2g(μ cos α + sin α), m.
pub fn stopping_distance(speed: f64, friction: f64, angle: f64) -> f64 {
    speed * speed / (2.0 * GRAVITY * (friction * angle.cos() + angle.sin()))
}

/// Yaw (rad) of an `along_x` by `along_y` m load after a frictionless pusher moved `distance` m along x, touching the load at
/// lateral coordinate `offset` m: quasi-static, each step the twist of least dissipation that keeps contact.
pub fn off_centre_push(along_x: f64, along_y: f64, offset: f64, distance: f64) -> f64 {
    let steps = 200;
    let mut yaw = 0.0_f64;
    let increment = distance / f64::from(steps);
    // lateral coordinate of the contact point in the load frame; the pusher slides along the face
    let mut lateral = offset;
    for _ in 0..steps {
        // in the load frame the face's normal velocity at the contact is the pusher's: u − ω q_y = cos θ
        let normal = yaw.cos();
        let best = minimise_twist(along_x, along_y, lateral, normal);
        yaw += best.angular * increment;
        // contact point in the world is the pusher's; in the load frame it moves by the relative velocity along the face
        let relative = -yaw.sin() - (best.linear.y + best.angular * (-along_x / 2.0));
        lateral += relative * increment;
    }
    yaw
}

/// Twist of least dissipation with `u − ω q_y = normal`, over (v, ω), by nested golden section.
fn minimise_twist(along_x: f64, along_y: f64, lateral: f64, normal: f64) -> Twist2 {
    let twist = |v: f64, w: f64| Twist2::new(normal + w * lateral, v, w);
    let inner = |w: f64| {
        let (v, value) = golden(-3.0, 3.0, |v| rectangle_dissipation(along_x, along_y, &twist(v, w)).0);
        (v, value)
    };
    let (w, _) = golden(-12.0, 12.0, |w| inner(w).1);
    twist(inner(w).0, w)
}

fn golden(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> (f64, f64) {
    let ratio = (5.0_f64.sqrt() - 1.0) / 2.0;
    let mut a = high - ratio * (high - low);
    let mut b = low + ratio * (high - low);
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..60 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - ratio * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + ratio * (high - low);
            fb = f(b);
        }
    }
    let x = 0.5 * (low + high);
    (x, f(x))
}
