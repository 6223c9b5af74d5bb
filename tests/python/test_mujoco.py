"""Pushes recorded with cohaul and played again in MuJoCo: another engine, another friction model, the same motion.

The load stands on 6 x 16 equal feet, so that its weight is spread as evenly as cohaul takes it to be, and each foot has
dry friction. The robots follow the poses that cohaul recorded; what the load does is MuJoCo's. Nothing is fitted.

It found that rapier froze contact normals until a body had turned by 11 degrees ("contact recycling", now off): in the
push called `turn` the load ended 12 % of its path away and its robots pushed from a distance of 2 mm.

The pushes are open-loop: R2P2's pushing robots drive straight at one speed when the goal is far away, the printed law
(ω = 0) is chosen and nobody repositions himself.
"""

import dataclasses
import math
import os
from dataclasses import dataclass

import cohaul
import numpy as np
import pytest
from numpy.typing import NDArray

# headless physics needs no graphics, whose libraries may be missing
os.environ.setdefault("MUJOCO_GL", "disabled")
mujoco = pytest.importorskip("mujoco")

SECONDS = 10.0
STEP = 0.001
LENGTH, WIDTH, HEIGHT, MASS = 1.35, 0.35, 0.1, 2.0
RADIUS = 0.105
"""Radius of the robots, m."""
CONTACT_FRICTION = 0.3
"""Between robot and load."""
GRAVITY = 9.81
FEET = (6, 16)
"""Feet along and across the heading."""
FOOT = 0.002
"""Radius of a foot, m."""
SAG = 1e-3
"""How far the load sinks into the ground, m."""
PUSH_HEIGHT = 0.01
"""Height at which robots push, m: low, because a push higher up presses the front feet harder than the others."""

HARD = 1e4
"""Stiffness of friction over that of contact, `impratio`, that makes friction hard on soft feet; 10 lets it creep."""

SCENARIO = """
format: cohaul/1
name: push
world: {world}
terrain: {{slope_deg: {slope_deg}, friction: {{dynamic: {friction}, wheel: 0.9}}}}
loads:
  - id: load
    shape: {{rectangle: {{length: 1.35, width: 0.35}}}}
    mass: 2.0
    contact_friction: 0.3
teams:
  - id: team
    load: load
    robots: {{count: {count}, command_step: 0}}
    formation: {{slots: {{custom: [{slots}]}}, caging: none}}
    mission: {{goal: {goal}, time_limit: {seconds}}}
    controller: {{r2p2: {{reposition: never, speed_min: 0.05, speed_max: 0.05, {keys}}}}}
"""


@dataclass(frozen=True)
class Push:
    """A push over 10 s at 0.05 m/s."""

    behind: tuple[float, ...]
    """Where robots push from behind: y in the load's frame, m."""
    before: tuple[float, ...] = ()
    """Where robots push from the front, m."""
    turns: bool = False
    """Whether they turn the load on the spot, R2P2's rotation, instead of driving straight."""
    friction: float = 0.3
    slope_deg: float = 0.0

    def record(self, world: str = "planar") -> cohaul.Traces:
        """The push in cohaul."""
        places = [(3, 0.5 - y / LENGTH) for y in self.behind] + [(1, 0.5 + y / LENGTH) for y in self.before]
        outcome = cohaul.run(
            SCENARIO.format(
                world=world,
                slope_deg=self.slope_deg,
                friction=self.friction,
                count=len(places),
                slots=", ".join(f"{{edge: {edge}, at: {at!r}}}" for edge, at in places),
                seconds=SECONDS,
                # a goal on the left keeps the load turning; one far ahead keeps the robots driving
                goal="{x: 0, y: 1000}" if self.turns else "{x: 1000, y: 0}",
                keys="variant: recommended" if self.turns else "variant: literal, heading_threshold: 3.14",
            )
        )
        assert outcome.time_s == pytest.approx(SECONDS)
        assert (outcome.traces.role[5:] == cohaul.Role.PUSH).all()
        return outcome.traces


PUSHES = {
    "straight": Push(behind=(0.3, -0.3)),
    "uphill": Push(behind=(0.3, -0.3), slope_deg=5.0),
    "off centre by 0.1 m": Push(behind=(0.1,)),
    "off centre by 0.5 m": Push(behind=(0.5,)),
    "two off centre": Push(behind=(0.55, 0.2)),
    "turn": Push(behind=(-0.5,), before=(0.2,), turns=True),
}


def springs(stiffness: float, damping: float, impedance: float) -> str:
    """A contact as spring (N/m) and damper (N s/m) in MuJoCo's words.

    MuJoCo gives a contact the acceleration d (-b v - k r) and the regularisation R = (1 - d) A / d, where A is the inverse
    mass that the contact feels, for the load 1 / mass.
    """
    scale = (1.0 - impedance) / MASS
    return f'solref="{-stiffness * scale} {-damping * scale}" solimp="{impedance} {impedance} 0.001"'


def model(push: Push, impratio: float) -> "mujoco.MjModel":
    """Ground, load on its feet, and robots that are moved from outside.

    A sliding contact in MuJoCo is pushed apart as if it approached at the friction coefficient times its sliding speed, a
    trait of its convex cones. With stiffly damped contacts the load hops: half of its feet are in the air at any time.
    What this adds to a foot's share of the weight is 2 mu v zeta / sqrt(g sag), so the load stands on soft springs (it sags
    by 1 mm) with little damping (zeta = 0.1), which keeps every foot within a few percent of its share; a test below
    measures it. A high impratio makes friction hard nevertheless.
    """
    damping = 2.0 * 0.1 * math.sqrt(GRAVITY / SAG) * MASS / FEET[0] / FEET[1]
    on_ground = springs(MASS * GRAVITY / FEET[0] / FEET[1] / SAG, damping, 0.001)
    on_load = springs(6e4, 100.0, 0.1)  # gives way by 0.1 mm to 6 N
    feet = [
        f'<geom type="sphere" size="{FOOT}" pos="{x} {y} {FOOT}" mass="0" contype="0" conaffinity="1" '
        f'friction="{push.friction} 0 0" {on_ground}/>'
        for x in (np.arange(FEET[0]) - (FEET[0] - 1) / 2) * WIDTH / FEET[0]
        for y in (np.arange(FEET[1]) - (FEET[1] - 1) / 2) * LENGTH / FEET[1]
    ]
    # as discs: seen from above a ball is one, and MuJoCo knows its contact with a box in closed form
    robot = (
        f'<body pos="0 0 {PUSH_HEIGHT}"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        f'<joint type="hinge" axis="0 0 1"/><geom type="sphere" size="{RADIUS}" mass="1e4" contype="0" '
        f'conaffinity="2" friction="{CONTACT_FRICTION} 0 0" {on_load}/></body>'
    )
    slope = math.radians(push.slope_deg)
    return mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <option timestep="{STEP}" cone="elliptic" impratio="{impratio}" solver="Newton" tolerance="1e-10"
                  gravity="{-GRAVITY * math.sin(slope)} 0 {-GRAVITY * math.cos(slope)}"/>
          <default><geom condim="3"/></default>
          <worldbody>
            <geom name="ground" type="plane" size="5 5 1" contype="1" conaffinity="0"
                  friction="{push.friction} 0 0" {on_ground}/>
            <body><freejoint/>
              <geom type="box" size="{WIDTH / 2} {LENGTH / 2} {HEIGHT / 2}" pos="0 0 {HEIGHT / 2}" mass="{MASS}"
                    contype="2" conaffinity="0" friction="{CONTACT_FRICTION} 0 0" {on_load}/>
              {"".join(feet)}
            </body>
            {robot * (len(push.behind) + len(push.before))}
          </worldbody>
        </mujoco>""")


@dataclass(frozen=True)
class Played:
    """What MuJoCo makes of a push."""

    load_pose: NDArray[np.float64]
    """(T, 3) Poses of the load at the instants of the traces."""
    pressure: NDArray[np.float64]
    """(n, 96) Normal forces of the feet in units of their mean, looked at now and then once the load moves."""


def played(push: Push, traces: cohaul.Traces, *, impratio: float = HARD) -> Played:
    """The push in MuJoCo, the robots moving as recorded."""
    physics = model(push, impratio)
    state = mujoco.MjData(physics)
    state.qpos[2] = -SAG
    steps = np.arange(round(SECONDS / STEP) + 1)
    robots = np.unwrap(traces.robot_pose.reshape(traces.time.size, -1), axis=0)
    wanted = np.stack([np.interp(steps * STEP, traces.time, column) for column in robots.T], axis=1)
    poses = np.empty((steps.size, 3))
    pressures = []
    for step in steps:
        poses[step] = *state.qpos[:2], 2.0 * math.atan2(state.qpos[6], state.qpos[3])
        if step == steps[-1]:
            break
        # a body of 10 t at the recorded pose, with the velocity that leads to the next: contacts do not deflect it
        state.qpos[7:] = wanted[step]
        state.qvel[6:] = (wanted[step + 1] - wanted[step]) / STEP
        mujoco.mj_step(physics, state)
        if step > steps.size // 10 and step % 101 == 0:
            pressures.append(pressure(physics, state))
    at = np.round(traces.time / STEP).astype(int)
    return Played(poses[at], np.array(pressures))


def pressure(physics: "mujoco.MjModel", state: "mujoco.MjData") -> NDArray[np.float64]:
    """(96,) Normal forces of the feet in units of their mean; 0 for a foot in the air."""
    ground = mujoco.mj_name2id(physics, mujoco.mjtObj.mjOBJ_GEOM, "ground")
    force, forces = np.zeros(6), np.zeros(FEET[0] * FEET[1])
    touching = [number for number in range(state.ncon) if ground in state.contact.geom[number]]
    for place, number in enumerate(touching):
        mujoco.mj_contactForce(physics, state, number, force)
        forces[place] = force[0]
    return forces / forces.mean()


# the usual impratio for the pushes that are long; the turn moves the load's centre by 6 cm only, of which creep is 4 mm there
@pytest.mark.parametrize("world", ["planar", "spatial"])
@pytest.mark.parametrize(
    ("name", "impratio"), [(name, HARD) for name in PUSHES] + [(name, 10.0) for name in PUSHES if name != "turn"]
)
def test_both_engines_move_the_load_alike(name: str, impratio: float, world: str) -> None:
    push = PUSHES[name]
    traces = push.record(world)
    ours, theirs = traces.load_pose[:, 0], played(push, traces, impratio=impratio).load_pose
    path = np.hypot(*np.diff(ours[:, :2], axis=0).T).sum()
    apart = math.hypot(*(theirs[-1] - ours[-1])[:2])
    turned = abs(ours[-1, 2])
    assert path > 0.05 and (turned > math.radians(30) or push.behind == (0.3, -0.3))
    assert apart < 0.05 * path, f"{apart / path:.1%} of {path:.3f} m"
    assert abs(theirs[-1, 2] - ours[-1, 2]) < max(0.05 * turned, math.radians(1.0)), np.degrees([theirs[-1, 2], turned])


def test_every_foot_bears_its_share() -> None:
    push = PUSHES["off centre by 0.5 m"]
    shares = played(push, push.record()).pressure
    # 2 mu v zeta / sqrt(g sag) is 3 % at 0.05 m/s; no foot moves faster than 0.08 m/s; the rest is that robots push 1 cm
    # above the ground
    assert shares.shape[1] == 96 and abs(shares - 1.0).max() < 0.10


def test_friction_is_hard_in_mujoco() -> None:
    """On a slope just below the friction angle (16.70 deg) the load stays, just above it falls as a point mass would.

    Half a millimetre of creep in 10 s is allowed (0.34 mm measured): a sixth of what the shortest push may differ by.
    """
    stays, slides = (alone(Push(behind=(0.3, -0.3), slope_deg=slope_deg)) for slope_deg in (16.0, 17.5))
    assert abs(stays[-1]) < 5e-4
    slope = math.radians(17.5)
    # from positions 2 s apart, so that the jolt at the start does not count
    acceleration = (slides[80] - 2.0 * slides[40] + slides[0]) / 2.0**2
    assert -acceleration == pytest.approx(GRAVITY * (math.sin(slope) - 0.3 * math.cos(slope)), rel=0.01)


def alone(push: Push) -> NDArray[np.float64]:
    """Positions (201,) of the load along the slope in MuJoCo, 20 per second, its robots out of reach."""
    time = np.linspace(0.0, SECONDS, 201)
    robots = np.tile([[-100.0, 0.0, 0.0], [-100.0, 1.0, 0.0]], (time.size, 1, 1))
    traces = dataclasses.replace(push.record(), time=time, robot_pose=robots)
    return played(push, traces).load_pose[:, 0]
