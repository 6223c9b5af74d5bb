"""What a team can do, told before it drives."""

from __future__ import annotations

import json
import warnings
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from cohaul.mission import _load

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

__all__ = ["Capacity", "TeamCapacity", "capacity"]


@dataclass(frozen=True)
class TeamCapacity:
    """What one team can move, everything but the quantity in question as in the scenario."""

    team: str
    """Name of the team."""
    robots: int
    """How many robots it has."""
    feasible: bool
    """Whether it can do its mission."""
    margin: float
    """Largest mass over the load's mass."""
    mass_kg: float
    """Mass of the load, kg."""
    max_mass_kg: float
    """Largest mass, kg; 0 if not even a load without weight would arrive."""
    max_slope_deg: float | None
    """Steepest slope in the direction that is worst for the mission, degrees; None if not even flat ground will do."""
    min_robots: int | None
    """Size of the smallest team that still can, slots chosen anew; None if none of up to 12 robots can."""
    limit: dict[str, Any] | None
    """What ends the mission just beyond the largest mass: `demand` (`translate`, `rotate` or `hold`), `leg` (from 1), `cause`
    and `robots_at_limit` (from 1)."""
    explanation: str
    """The same in words."""


@dataclass(frozen=True)
class Capacity:
    """What the teams of a scenario can move; the numbers are those of the team with the least margin."""

    feasible: bool
    """Whether every team can do its mission."""
    margin: float
    """Largest mass over the load's mass."""
    max_mass_kg: float
    """Largest mass, kg."""
    max_slope_deg: float | None
    """Steepest slope in the direction that is worst for the mission, degrees."""
    min_robots: int | None
    """Size of the smallest team that still can."""
    explanation: str
    """What binds."""
    teams: tuple[TeamCapacity, ...]
    """Every team."""
    _tables: tuple[str, ...] = field(repr=False, compare=False)

    def __str__(self) -> str:
        """A table per team."""
        return "\n".join(self._tables)


def capacity(
    path: str | os.PathLike[str],
    *,
    without: Iterable[int] = (),
    set: Mapping[str, object] | None = None,
    **overrides: object,
) -> Capacity:
    """Tell whether the teams of a scenario can do their missions, with which margin, and where they end.

    path
        Scenario file; text with a line break is taken for the scenario itself.
    without
        Robots that are gone, counted from 1 over all teams; those left of their teams form anew.
    set, **overrides
        Keys of the scenario set to other values, as in `run`.

    Nothing is simulated: the mission is gone through without inertia, with the robots in their slots. Raises what `run`
    raises for a bad scenario, and `PlanError` for slots that cannot be chosen and teams that cannot form anew. Warns with
    `ScenarioWarning`.
    """
    scenario = _load(path, set, overrides)
    for warning in scenario.warnings:
        warnings.warn(warning, stacklevel=2)
    numbers, tables = scenario.capacity(list(without))
    values: dict[str, Any] = json.loads(numbers)
    teams = tuple(TeamCapacity(**team) for team in values.pop("teams"))
    names = {f.name for f in fields(Capacity)}
    shared = {name: value for name, value in values.items() if name in names}
    return Capacity(teams=teams, _tables=tuple(tables), **shared)
