"""Missions: checked, run, and what came out of them."""

from __future__ import annotations

import json
import math
import os
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cohaul import _cohaul
from cohaul.errors import ScenarioWarning

if TYPE_CHECKING:
    from numpy import bool_, float64, int8, int64
    from numpy.typing import NDArray

__all__ = ["Outcome", "Phase", "Primitive", "Role", "Traces", "check", "run", "schema"]


class Role(IntEnum):
    """What a robot does for the motion of the load ([R2P2] §IV-B)."""

    NONE = -1
    PUSH = 0
    """Drives the load towards the goal."""
    PREVENT = 1
    """Gives way in front of the load, so that it cannot run away."""
    SUPPORT = 2
    """Follows the load, so that it cannot slip out of the formation."""


class Phase(IntEnum):
    """Where a robot stands in its cycle of work and repositioning."""

    WORK = 0
    """Acts on its role."""
    HOLD = 1
    """Waits, because a peer's stop flag is up."""
    TURN_PARALLEL = 2
    """Repositioning: turns parallel to the edge."""
    SLIDE = 3
    """Repositioning: drives along the edge to its slot."""
    TURN_FACING = 4
    """Repositioning: turns to face the edge."""
    APPROACH = 5
    """Repositioning: creeps up to the edge."""
    DONE = 6
    """The last waypoint is reached."""
    TELEPORT = 7
    """Repositioning in simulation only: put into its slot at once."""


class Primitive(IntEnum):
    """The motion of the load that a team works for."""

    NONE = -1
    ROTATE_COUNTERCLOCKWISE = 0
    ROTATE_CLOCKWISE = 1
    TRANSLATE = 2


@dataclass(frozen=True, eq=False, repr=False)
class Traces:
    """The state of everything, 20 times per second and at the end, as read-only arrays.

    T instants, L loads, R robots, K teams, each in the order of the scenario (robots team by team). Poses are
    (x, y, yaw) in the world [m, m, rad]. What a robot decided is that of its last decision; before its first one, within
    the first control period, commands and errors are 0 and role and primitive are -1.
    """

    time: NDArray[float64]
    """(T,) Instants [s]."""
    load_pose: NDArray[float64]
    """(T, L, 3) Poses of the loads; a load's heading is its x axis."""
    robot_pose: NDArray[float64]
    """(T, R, 3) Poses of the robots."""
    command: NDArray[float64]
    """(T, R, 2) Commanded forward speed [m/s] and yaw rate [rad/s]."""
    speed: NDArray[float64]
    """(T, R) Forward speed of the robots [m/s]."""
    role: NDArray[int8]
    """(T, R) `Role` of the robots, -1 for none."""
    phase: NDArray[int8]
    """(T, R) `Phase` of the robots."""
    stop: NDArray[bool_]
    """(T, R) Whether the robot's stop flag is up."""
    primitive: NDArray[int8]
    """(T, K) `Primitive` of the teams, -1 for none."""
    heading_error: NDArray[float64]
    """(T, K) Bearing of the waypoint minus the load's heading, in (-pi, pi] [rad]."""
    distance: NDArray[float64]
    """(T, K) Distance of the load's centre from the waypoint [m]."""
    waypoint: NDArray[int64]
    """(T, K) Index of the waypoint; the goal is the last."""

    def __repr__(self) -> str:
        """Names and shapes."""
        arrays = ", ".join(f"{f.name} {getattr(self, f.name).shape}" for f in fields(self))
        return f"<Traces {arrays}>"


@dataclass(frozen=True, repr=False)
class Outcome:
    """How a mission ended; the names are those of `cohaul run --json`.

    With several teams, lengths and errors are the largest over the loads, counts are sums. Two outcomes are equal if the
    missions went the same way, wherever their files are and however long they took to compute.
    """

    name: str
    """Name of the mission."""
    outcome: str
    """`reached`, `timed_out`, `load_lost` or `collided`."""
    success: bool
    """Whether every load was delivered."""
    time_s: float
    """Simulated duration, s."""
    final_error_m: float
    """Distance of the load's centre from its goal at the last step, m."""
    final_yaw_error_rad: float
    """Heading that the goal asks for, or else the bearing from the last waypoint to the goal, minus the load's heading at the
    last step, absolute, rad: about π for a load that drove backwards."""
    waypoints_reached: int
    """Waypoints passed, goals included."""
    repositions: int
    """Intervals in which at least one robot's stop flag was up."""
    reposition_time_s: float
    """Their total length, s."""
    min_robot_distance_m: float
    """Least distance between the centres of two robots, m; infinite for a single one."""
    min_clearance_m: float
    """Least distance between the bodies of two robots, or of a robot and an obstacle, m; infinite without any."""
    path_length_m: float
    """Length of the load's path, m."""
    path_deviation_rms_m: float
    """Root mean square of the load's distance from the straight lines between its waypoints, m."""
    path_deviation_max_m: float
    """Largest such distance, m."""
    control_effort: float
    """Integral of v² + ω² over time, summed over the robots."""
    energy_j: float
    """Traction work of the robots, J."""
    caging_violation_s: float
    """Time during which the robots did not enclose the load's centre, s."""
    penalty_s: float
    """Time added for robots that were put into their slots, s; not part of `time_s`."""
    seed: int
    """Seed of everything random."""
    world: str
    """Simulator: `planar` or `spatial`."""
    records: int = field(compare=False)
    """Records in the log, 0 without one."""
    log: Path | None = field(compare=False)
    """The log (MCAP), if one was written."""
    page: Path | None = field(compare=False)
    """The replay page, if one was written."""
    cpu_s: float = field(compare=False)
    """CPU time that the process took, s."""
    wall_s: float = field(compare=False)
    """Time that it took, s."""
    _mission: _cohaul.Mission = field(compare=False)

    @property
    def real_time_factor(self) -> float:
        """Simulated over real time."""
        return self.time_s / self.wall_s

    @cached_property
    def traces(self) -> Traces:
        """What happened, as arrays."""
        return Traces(**self._mission.traces())

    @cached_property
    def scenario(self) -> str:
        """The scenario as YAML, everything drawn and every key written out: `run` takes it and gives the same outcome."""
        return self._mission.scenario

    def to_dict(self) -> dict[str, Any]:
        """The numbers alone, with the names of `cohaul run --json`: a row of a table."""
        values = {f.name: getattr(self, f.name) for f in fields(self) if not f.name.startswith("_")}
        return {**values, "real_time_factor": self.real_time_factor}

    def html(self) -> str:
        """A self-contained page that plays the mission in any browser."""
        return self._mission.html()

    def picture(self) -> str:
        """A drawing of the mission, SVG."""
        return self._mission.picture()

    def save(self, folder: str | os.PathLike[str]) -> tuple[Path, Path]:
        """Write the page NAME.html and the picture NAME.svg into a folder, which is made if need be; return their paths.

        The log is written by `run(..., out=folder)`, while the mission runs.
        """
        page = Path(folder, f"{self.name}.html")
        picture = page.with_name(f"{self.name}.svg")
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(self.html(), encoding="utf-8")
        picture.write_text(self.picture(), encoding="utf-8")
        return page, picture

    def _repr_html_(self) -> str:
        """The replay page, for notebooks."""
        import html  # slow to load, and only needed here

        style = "width: 100%; height: 720px; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{html.escape(self.html())}"></iframe>'

    def __repr__(self) -> str:
        """One line."""
        return f"<Outcome of {self.name}, seed {self.seed}: {self.outcome} after {self.time_s:.1f} s>"

    def __str__(self) -> str:
        """A table."""
        title = f"{self.name} (seed {self.seed}, {self.world} world)"
        return "\n".join([title, *(f"  {label:<26}{value}" for label, value in self._mission.rows())])


def run(
    path: str | os.PathLike[str],
    *,
    seed: int | None = None,
    world: str | None = None,
    out: str | os.PathLike[str] | None = None,
    set: Mapping[str, object] | None = None,
    **overrides: object,
) -> Outcome:
    """Run a mission and return how it went.

    path
        Scenario file; text with a line break is taken for the scenario itself.
    seed
        Seed of everything random, instead of the scenario's. The same seed gives the same outcome, bit for bit.
    world
        Simulator, `planar` or `spatial`, instead of the scenario's.
    out
        Folder for the log NAME.mcap and the page NAME.html. Without it nothing is written.
    set, **overrides
        Keys of the scenario set to other values: `set={"loads.0.mass": 3.3}`, or the same with two underscores for each
        dot, `loads__0__mass=3.3`. Values are what JSON can say, or NumPy arrays and numbers of it.

    Other threads go on while the mission runs, and several missions may run in threads of their own. Ctrl-C ends the
    mission within a simulated second with `KeyboardInterrupt`; a log under way is finished.

    Raises `ScenarioError` with file, line and column, or with the override at fault; `MissingFileError` and `FileError`;
    `SimError`. Warns with `ScenarioWarning`.
    """
    named = {"seed": seed, "world": world}
    scenario = _load(path, set, {**overrides, **{name: value for name, value in named.items() if value is not None}})
    for warning in scenario.warnings:
        warnings.warn(warning, stacklevel=2)
    mission = scenario.run(out)
    log, page = mission.files or (None, None)
    cpu_s, wall_s = mission.seconds
    # JSON has no infinity
    numbers: dict[str, Any] = {k: math.inf if v is None else v for k, v in json.loads(mission.json()).items()}
    return Outcome(
        name=mission.name,
        seed=mission.seed,
        world=mission.world,
        records=mission.records,
        log=log,
        page=page,
        cpu_s=cpu_s,
        wall_s=wall_s,
        _mission=mission,
        **numbers,
    )


def check(
    path: str | os.PathLike[str], *, set: Mapping[str, object] | None = None, **overrides: object
) -> list[ScenarioWarning]:
    """Check a scenario without running it, and return what is allowed but probably not meant.

    The arguments are those of `run`. Raises `ScenarioError` with file, line and column, or with the override at fault;
    `MissingFileError` and `FileError`.
    """
    return _load(path, set, overrides).warnings


def schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of scenario files."""
    document: dict[str, Any] = json.loads(_cohaul.schema())
    return document


def _load(
    path: str | os.PathLike[str], by_path: Mapping[str, object] | None, by_name: Mapping[str, object]
) -> _cohaul.Scenario:
    changes = {**(by_path or {}), **{name.replace("__", "."): value for name, value in by_name.items()}}
    texts = override_texts(changes)
    if isinstance(path, str) and "\n" in path:
        return _cohaul.Scenario.parse(path, texts)
    return _cohaul.Scenario.read(path, texts)


def override_texts(changes: Mapping[str, object] | None) -> list[str]:
    """Keys and their values as `--set` takes them."""
    return [f"{key}={_yaml(key, value)}" for key, value in (changes or {}).items()]


def _yaml(key: str, value: object) -> str:
    """The value as JSON, which is YAML too."""

    def plain(value: object) -> object:
        if hasattr(value, "tolist"):  # NumPy arrays and numbers
            return value.tolist()
        raise TypeError(f"{key} cannot be set to a {type(value).__name__}")

    return json.dumps(value, default=plain)
