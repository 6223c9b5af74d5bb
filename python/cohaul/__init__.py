"""Teams of mobile robots that move loads by pushing them together.

>>> import cohaul
>>> outcome = cohaul.run("scenarios/r2p2/flat.yaml", seed=7)  # doctest: +SKIP
>>> outcome.success, outcome.time_s  # doctest: +SKIP
(True, 45.2)
>>> outcome.traces.load_pose.shape  # doctest: +SKIP
(905, 1, 3)

In a notebook the outcome shows itself as a page that plays the mission. All numbers are SI units and radians; yaw is
counter-clockwise; poses are (x, y, yaw). Everything raised on purpose is a `CohaulError`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cohaul._cohaul import REVISION as __revision__
from cohaul._cohaul import VERSION as __version__
from cohaul._cohaul import LimitSurface, flow
from cohaul.errors import (
    CohaulError,
    CompareError,
    ContactError,
    ControlError,
    ExperimentError,
    FileError,
    InstanceError,
    MissingFileError,
    MissingPackageError,
    PlanError,
    PlotError,
    RecordError,
    ScenarioError,
    ScenarioWarning,
    SimError,
)
from cohaul.experiments import experiments, reproduce
from cohaul.log import Difference, Recovered, Replayed, compare, recover, replay
from cohaul.mission import Outcome, Phase, Primitive, Role, Traces, check, run, schema
from cohaul.planner import Capacity, TeamCapacity, capacity
from cohaul.planning import Plan, Reason, Violation, certify, generate, plan

if TYPE_CHECKING:
    from cohaul import plot

__all__ = [
    "Capacity",
    "CohaulError",
    "CompareError",
    "ContactError",
    "ControlError",
    "Difference",
    "ExperimentError",
    "FileError",
    "InstanceError",
    "LimitSurface",
    "MissingFileError",
    "MissingPackageError",
    "Outcome",
    "Phase",
    "Plan",
    "PlanError",
    "PlotError",
    "Primitive",
    "Reason",
    "RecordError",
    "Recovered",
    "Replayed",
    "Role",
    "ScenarioError",
    "ScenarioWarning",
    "SimError",
    "TeamCapacity",
    "Traces",
    "Violation",
    "__revision__",
    "__version__",
    "capacity",
    "certify",
    "check",
    "compare",
    "experiments",
    "flow",
    "generate",
    "plan",
    "plot",
    "recover",
    "replay",
    "reproduce",
    "run",
    "schema",
]


def __getattr__(name: str) -> Any:
    """`cohaul.plot`, loaded when it is first used."""
    if name == "plot":
        import importlib

        return importlib.import_module("cohaul.plot")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
