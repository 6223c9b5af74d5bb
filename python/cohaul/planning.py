"""Plans for many agents: ways on grids and for cars, certified, and the curves and assignments that they are made of."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cohaul import _cohaul
from cohaul.errors import PlanError

if TYPE_CHECKING:
    from numpy import float64, int64
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Assignment",
    "Curve",
    "Plan",
    "Reason",
    "Violation",
    "assign",
    "assignments",
    "certify",
    "dubins",
    "generate",
    "plan",
    "reeds_shepp",
]


@dataclass(frozen=True)
class Reason:
    """Why there is no plan."""

    kind: str
    """`start_outside`, `start_blocked`, `goal_outside`, `goal_blocked`, `starts_collide`, `goals_collide`, `unreachable`,
    `no_goal` or `exhausted`."""
    agents: tuple[str, ...]
    """Names of the agents that it is about."""
    detail: str
    """The same in words."""


@dataclass(frozen=True)
class Violation:
    """Something that is wrong with a plan."""

    kind: str
    """What: `collision`, `swap`, `obstacle`, `outside`, `step`, `start`, `goal`, `cost`, …"""
    time: float
    """When, in steps; between two steps where it happens there."""
    agents: tuple[str, ...]
    """Names of the agents, none where it is about the plan as a whole."""
    detail: str
    """What exactly, with numbers."""


@dataclass(frozen=True, repr=False)
class Plan:
    """What came of planning; the names are those of `cohaul plan --json`. Metres and radians, or cells and steps."""

    name: str
    """Name of the instance's file."""
    planner: str
    """The search."""
    agents: int
    """How many agents there are."""
    status: str
    """`solved`, `infeasible` or `budget_spent`."""
    reason: str | None
    """Why there is no plan, in a line."""
    reasons: tuple[Reason, ...]
    """Why the instance is infeasible, at least one reason if it is."""
    cost: float | None
    """What was minimised: on grids the sum of the steps in which the agents arrive, for cars the sum of lengths with
    penalties [m]."""
    lower_bound: float | None
    """No plan costs less."""
    bound: float | None
    """The cost is at most this times the lower bound, as was asked for."""
    makespan: float | None
    """Grids: step of the last arrival; cars: length of the longest way [m]."""
    flowtime: float | None
    """Grids: sum of the steps of arrival; cars: sum of the lengths of all ways [m]."""
    runtime_s: float = field(compare=False)
    """CPU time of the search with its set-up, s."""
    high_level_expanded: int
    """Nodes of the conflict tree that were expanded."""
    low_level_expanded: int
    """States that single-agent searches expanded."""
    assignments: int
    """Assignments of goals that were looked at."""
    _planned: _cohaul.Planned = field(compare=False)

    @property
    def solved(self) -> bool:
        """Whether there is a plan."""
        return self.status == "solved"

    @cached_property
    def routes(self) -> dict[str, NDArray[Any]]:
        """Where every agent is in step 0, 1, 2, … and, after the last, for good: read-only arrays by the agents' names.

        On grids cells (T, 2) of int64, x and y; for bodies poses (T, 3) of float64, x [m], y [m] and yaw [rad],
        counter-clockwise whatever the file has. Empty where there is no plan. T differs from agent to agent.
        """
        return {name: states for name, _, states in self._routes()}

    @cached_property
    def goals(self) -> dict[str, int | None]:
        """Which of its goals every agent takes, an index into its list of goals; None for those that go without."""
        return {name: goal for name, goal, _ in self._routes()}

    def _routes(self) -> Sequence[tuple[str, int | None, NDArray[int64] | NDArray[float64]]]:
        return self._planned.cells() or self._planned.poses() or []

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the plan in the layout of libMultiRobotPlanning (`schedule: agent0: [{x, y, t}, …]`); return where it is.

        Yaws turn as in the instance's file. Raises `PlanError` where there is no plan.
        """
        return _written(path, self._planned.text())

    def page(self, path: str | os.PathLike[str]) -> Path:
        """Write a self-contained page that plays the plan in any browser; return where it is."""
        return _written(path, self.html())

    def html(self) -> str:
        """That page."""
        return self._planned.html()

    def picture(self) -> str:
        """A drawing of the plan, SVG."""
        return self._planned.picture()

    def to_dict(self) -> dict[str, Any]:
        """The numbers alone: a row of a table."""
        return {f.name: getattr(self, f.name) for f in fields(self) if not f.name.startswith("_")}

    def _repr_html_(self) -> str | None:
        """The page, for notebooks."""
        if not self.solved:
            return None
        import html  # slow to load, and only needed here

        style = "width: 100%; height: 720px; border: 0"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{html.escape(self.html())}"></iframe>'

    def __repr__(self) -> str:
        """One line."""
        cost = "" if self.cost is None else f", cost {self.cost:g}"
        return f"<Plan of {self.name}, {self.agents} agents: {self.status.replace('_', ' ')}{cost}>"

    def __str__(self) -> str:
        """A table."""
        title = f"{self.name}: {self.agents} agents, {self.planner}"
        return "\n".join([title, *(f"  {label:<14}{value}" for label, value in self._planned.rows())])


def plan(
    path: str | os.PathLike[str],
    *,
    planner: str | None = None,
    bound: float | None = None,
    model: str = "clcbs",
    timeout: float = 60.0,
    batch: int | None = None,
    metric: str = "curve",
    starts: str = "checked",
    agents: int | None = None,
    map: str | os.PathLike[str] | None = None,
    vehicle: str | os.PathLike[str] | None = None,
) -> Plan:
    """Plan ways for many agents that do not meet, and tell why where there are none.

    path
        Instance: YAML of libMultiRobotPlanning or CL-CBS, or a MovingAI scenario beside its map. Text with a line break is
        taken for the instance itself.
    planner
        `cbs` or `ecbs` on grids, `cbs-ta`, `ecbs-ta`, `ita-cbs` or `ita-ecbs` where goals are to be assigned, `cl-cbs` for
        bodies that drive; the usual one of the instance's kind if it is not given.
    bound
        By which factor the cost may exceed the lower bound, at least 1. Usually 1.3 on grids; without it bodies that drive are
        planned fast, with a bound that comes out as it does.
    model
        When bodies count as touching: `clcbs`, discs at the ends of steps, or `exact`, rectangles all through every step.
    timeout
        CPU time of the process after which to give up, s; the status then is `budget_spent`.
    batch
        Plan so many bodies at once, later ones around earlier ones, instead of all.
    metric
        What assignments of goals to bodies are judged by: `curve`, the shortest curve that they can drive, or `manhattan`.
    starts
        `checked`, or `free`: bodies may start inside an obstacle and stay there until they first move.
    agents
        Only so many agents, the first ones.
    map, vehicle
        The map of a MovingAI scenario, and CL-CBS's config.yaml, instead of what the file says.

    Other threads go on meanwhile. Ctrl-C ends the search with `KeyboardInterrupt`. Raises `InstanceError` with file, line and
    column, `MissingFileError`, `FileError`, and `PlanError` for arguments that do not fit; no plan is no error.
    """
    instance = _instance(path, map=map, vehicle=vehicle, agents=agents, starts=starts)
    planned = instance.plan(planner, bound, model, batch, metric, float(timeout))
    values: dict[str, Any] = json.loads(planned.json())
    reasons = tuple(Reason(r["kind"], tuple(r["agents"]), r["detail"]) for r in values.pop("reasons"))
    return Plan(
        name=planned.title,
        planner=planned.planner,
        agents=instance.agents,
        reasons=reasons,
        _planned=planned,
        **values,
    )


def certify(
    plan: Plan | str | os.PathLike[str],
    instance: str | os.PathLike[str] | None = None,
    *,
    model: str = "clcbs",
    starts: str = "checked",
    agents: int | None = None,
    map: str | os.PathLike[str] | None = None,
    vehicle: str | os.PathLike[str] | None = None,
) -> list[Violation]:
    """Check a plan independently of the planners, ours or a foreign one; nothing in the list, and the plan is right.

    plan
        What `plan` gave; or a file in the layout of libMultiRobotPlanning or CL-CBS, or its text.
    instance
        What it is a plan for; not needed for what `plan` gave.
    model, starts, agents, map, vehicle
        As for `plan`.

    Checked are starts, goals and their assignment, every step, obstacles, bodies that meet, parked ones included, between the
    steps too, and the claimed numbers. In the order of time, at most 100. Raises what `plan` raises.
    """
    read = None
    if instance is not None:
        read = _instance(instance, map=map, vehicle=vehicle, agents=agents, starts=starts)
    if isinstance(plan, Plan):
        listed = plan._planned.certify(model, read)
    elif read is None:
        raise PlanError("a plan from a file needs its instance")
    else:
        listed = read.certify(*_source(plan, "plan"), model)
    found: list[dict[str, Any]] = json.loads(listed)
    return [Violation(v["kind"], v["time"], tuple(v["agents"]), v["detail"]) for v in found]


def generate(
    kind: str,
    *,
    agents: int = 10,
    size: int | None = None,
    obstacles: int | None = None,
    window: int = 3,
    seed: int = 1,
) -> str:
    """Make a planning instance from a seed, and return its text: what `plan` takes.

    kind
        `grid`, `grid-all`, `grid-window` (goals to be assigned: all, or `window` for each agent), `car`, `car-all`,
        `car-window`, `forward-car` or `differential`. MovingAI's files are made by the command, `cohaul generate movingai`.
    agents
        How many agents.
    size
        Side of the square map: cells for grids (32 if not given), metres for bodies (100).
    obstacles
        How many obstacles: a fifth of the cells if not given; 25, 50 or 100 for bodies on maps of 50, 100, 300 m.
    window
        How many goals an agent may take, for the kinds with windows.
    seed
        The same seed gives the same text.

    Raises `PlanError` for numbers out of range, or too little room.
    """
    return _cohaul.generate_instance(kind, agents, size, obstacles, window, seed)


@dataclass(frozen=True)
class Curve:
    """A shortest curve from one pose to another."""

    length: float
    """Its length, both ways counted [m]."""
    segments: tuple[tuple[str, float], ...]
    """How it steers, `left`, `straight` or `right`, and how far [m], negative backwards."""
    _curve: _cohaul.ShortestCurve = field(repr=False, compare=False)

    def sample(self, spacing: float) -> NDArray[float64]:
        """Poses (n, 3) along it [m, m, rad], at most `spacing` [m] apart, both ends of every piece among them.

        Yaws go on without jumps, so they may leave (-pi, pi].
        """
        return self._curve.sample(spacing)


def reeds_shepp(start: ArrayLike, goal: ArrayLike, *, radius: float) -> Curve:
    """The shortest curve of a car that drives both ways, from pose to pose (3,) [m, m, rad].

    radius
        Least turning radius [m].
    """
    return _curve(_cohaul.reeds_shepp_curve(_pose("start", start), _pose("goal", goal), radius))


def dubins(start: ArrayLike, goal: ArrayLike, *, radius: float) -> Curve:
    """The shortest curve of a car that only drives forwards, from pose to pose (3,) [m, m, rad].

    radius
        Least turning radius [m].
    """
    return _curve(_cohaul.dubins_curve(_pose("start", start), _pose("goal", goal), radius))


@dataclass(frozen=True)
class Assignment:
    """Who takes which goal."""

    goals: tuple[int | None, ...]
    """Index of every agent's goal; None for those that go without."""
    cost: float
    """Sum of the costs of those that take one."""


def assign(costs: ArrayLike) -> Assignment:
    """The cheapest of the assignments in which as many agents as possible take a goal.

    costs
        (agents, goals); what is not finite is forbidden.
    """
    goals, cost = _cohaul.optimal_assignment(_costs(costs))
    return Assignment(tuple(goals), cost)


def assignments(costs: ArrayLike) -> Iterator[Assignment]:
    """All assignments in which as many agents as possible take a goal, the cheapest first.

    costs
        (agents, goals); what is not finite is forbidden.
    """
    listed = _cohaul.Assignments.under(_costs(costs))
    while (found := listed.following()) is not None:
        yield Assignment(tuple(found[0]), found[1])


def _curve(curve: _cohaul.ShortestCurve) -> Curve:
    return Curve(curve.length, tuple(curve.segments), curve)


def _pose(name: str, values: ArrayLike) -> list[float]:
    import numpy as np  # only needed here and below

    pose = np.asarray(values, dtype=np.float64)
    if pose.shape != (3,):
        raise PlanError(f"{name} has shape {pose.shape}, must be (3,)")
    numbers: list[float] = pose.tolist()
    return numbers


def _costs(values: ArrayLike) -> NDArray[float64]:
    import numpy as np

    costs = np.asarray(values, dtype=np.float64)
    if costs.ndim != 2:
        raise PlanError(f"costs have shape {costs.shape}, must be (agents, goals)")
    return costs


def _source(path: str | os.PathLike[str], name: str) -> tuple[str | os.PathLike[str], str | None]:
    """Path and text of a file, or of a text that is given in its place."""
    return (name, path) if isinstance(path, str) and "\n" in path else (path, None)


def _instance(
    path: str | os.PathLike[str],
    *,
    map: str | os.PathLike[str] | None,
    vehicle: str | os.PathLike[str] | None,
    agents: int | None,
    starts: str,
) -> _cohaul.Instance:
    return _cohaul.Instance.read(*_source(path, "instance"), map, vehicle, agents, starts)


def _written(path: str | os.PathLike[str], text: str) -> Path:
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path
