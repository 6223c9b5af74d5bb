"""Teams of mobile robots that move loads by pushing them together.

>>> import cohaul
>>> outcome = cohaul.run("scenarios/r2p2/flat.yaml", seed=7)  # doctest: +SKIP
>>> outcome.success, outcome.time_s  # doctest: +SKIP
(True, 331.05)
>>> outcome.traces.load_pose.shape  # doctest: +SKIP
(6622, 1, 3)

In a notebook the outcome shows itself as a page that plays the mission. All numbers are SI units and radians; yaw is
counter-clockwise; poses are (x, y, yaw). Everything raised on purpose is a `CohaulError`.
"""

from __future__ import annotations

from cohaul._cohaul import REVISION as __revision__
from cohaul._cohaul import VERSION as __version__
from cohaul._cohaul import LimitSurface
from cohaul.errors import (
    CohaulError,
    ContactError,
    ControlError,
    FileError,
    MissingFileError,
    PlanError,
    RecordError,
    ScenarioError,
    ScenarioWarning,
    SimError,
)
from cohaul.log import Difference, Recovered, Replayed, recover, replay
from cohaul.mission import Outcome, Phase, Primitive, Role, Traces, check, run, schema
from cohaul.planner import Capacity, TeamCapacity, capacity

__all__ = [
    "Capacity",
    "CohaulError",
    "ContactError",
    "ControlError",
    "Difference",
    "FileError",
    "LimitSurface",
    "MissingFileError",
    "Outcome",
    "Phase",
    "PlanError",
    "Primitive",
    "RecordError",
    "Recovered",
    "Replayed",
    "Role",
    "ScenarioError",
    "ScenarioWarning",
    "SimError",
    "TeamCapacity",
    "Traces",
    "__revision__",
    "__version__",
    "capacity",
    "check",
    "recover",
    "replay",
    "run",
    "schema",
]
