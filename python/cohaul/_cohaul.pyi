from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal

from numpy import float64, int64
from numpy.typing import ArrayLike, NDArray

from cohaul.errors import ScenarioWarning

__all__ = [
    "LimitSurface",
    "Mission",
    "REVISION",
    "Recording",
    "Scenario",
    "VERSION",
    "cli_main",
    "flow",
    "recover",
    "replay",
    "schema",
]

VERSION: Final[str]
REVISION: Final[str]

def cli_main(argv: list[str]) -> int:
    """Runs the command line `argv`, the program's name first, and returns its exit status."""

def schema() -> str:
    """JSON Schema of scenario files."""

def flow() -> list[dict[str, Any]]:
    """The flow of control of one robot as a list of nodes: the steps of a tick in their order, then the phases."""

def replay(path: str | PathLike[str]) -> dict[str, Any]:
    """Decides the log at `path` anew."""

def recover(path: str | PathLike[str], out: str | PathLike[str] | None) -> dict[str, Any]:
    """Makes a valid log, at `out` or beside it, of what is left of the log at `path`."""

def compare(a: str | PathLike[str], b: str | PathLike[str], fields: list[str], out: str | PathLike[str] | None) -> str:
    """Compares two logs or two sets of trials; what `cohaul compare --json` prints."""

class Scenario:
    """A valid scenario."""

    @staticmethod
    def read(path: str | PathLike[str], changes: list[str]) -> Scenario:
        """Reads and checks the file at `path`; `changes` are `path=value`."""
    @staticmethod
    def parse(text: str, changes: list[str]) -> Scenario:
        """Checks the YAML `text`; `changes` are `path=value`."""
    @property
    def warnings(self) -> list[ScenarioWarning]:
        """What is allowed, but probably not meant: a list of `ScenarioWarning`."""
    def capacity(self, without: list[int]) -> tuple[str, list[str]]:
        """What every team can move once the robots `without` (from 1) are gone: a JSON object, and a table per team."""
    def run(self, out: str | PathLike[str] | None) -> Mission:
        """Runs the mission without holding the interpreter; writes log and page into the folder `out`, if any."""

class Mission:
    """A finished mission."""

    @property
    def name(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def world(self) -> str: ...
    @property
    def records(self) -> int:
        """Records in the log, 0 without one."""
    @property
    def files(self) -> tuple[Path, Path] | None:
        """Log and page."""
    @property
    def seconds(self) -> tuple[float, float]:
        """CPU and wall time, s."""
    @property
    def scenario(self) -> str:
        """The scenario as YAML, everything drawn and every key written out."""
    def json(self) -> str:
        """How it ended, as a JSON object."""
    def traces(self) -> dict[str, NDArray[Any]]:
        """What happened: arrays by name."""
    def layout(self) -> dict[str, Any]:
        """Bodies, teams and their waypoints."""
    def rows(self) -> list[tuple[str, str]]:
        """Label and value of every row of the table of results."""
    def html(self) -> str:
        """The replay page."""
    def picture(self) -> str:
        """The picture, SVG."""

def experiments() -> list[tuple[str, str]]:
    """Names of the experiments with what each of them shows."""

def reproduce(
    name: str,
    trials: int | None,
    seed: int,
    world: str,
    jobs: int,
    out: str | PathLike[str],
    changes: list[str],
) -> tuple[str, Path]:
    """Runs an experiment into a folder; gives what `cohaul reproduce --json` prints, and the folder."""

class Recording:
    """A log as the mission that it recorded."""

    @staticmethod
    def read(path: str | PathLike[str]) -> Recording:
        """Reads the log at `path`."""
    def traces(self) -> dict[str, NDArray[Any]]:
        """What happened: arrays by name."""
    def layout(self) -> dict[str, Any]:
        """Bodies, teams and their waypoints."""

class LimitSurface:
    """Which friction wrench a load feels while it slides over the ground.

    Uniform pressure over the footprint. `model="exact"` is dry friction at every point of it, `"ellipsoid"` the ellipsoid
    with the same friction radius. Sources: [Goyal1991], [Howe1996].
    """

    @staticmethod
    def rectangle(*, along_x: float, along_y: float, model: Literal["exact", "ellipsoid"] = "exact") -> LimitSurface:
        """Of a rectangle `along_x` by `along_y` [m] centred on the origin."""
    @staticmethod
    def polygon(vertices: ArrayLike, *, model: Literal["exact", "ellipsoid"] = "exact") -> LimitSurface:
        """Of a convex polygon with `vertices` (n, 2) [m], moved so that its centroid is the origin."""
    def wrench(self, *, twist: ArrayLike, limit: float) -> NDArray[float64]:
        """Friction wrench (3,) [N, N, N·m] on a load that slides with `twist` (3,) [m/s, m/s, rad/s], both in the load's frame;
        `limit` [N] is the friction coefficient times the normal force. Zero at rest."""
    def dissipation(self, *, twist: ArrayLike) -> float:
        """Friction power per unit of limit force [m/s] at `twist` (3,) [m/s, m/s, rad/s]."""
    def friction_radius(self) -> float:
        """Largest torque over largest force [m]."""

def generate_instance(
    kind: str, agents: int, size: int | None, obstacles: int | None, window: int, seed: int
) -> str:
    """The text of the instance of `kind` that a seed gives."""

class Instance:
    """A planning instance."""

    @staticmethod
    def read(
        path: str | PathLike[str],
        text: str | None,
        map: str | PathLike[str] | None,
        vehicle: str | PathLike[str] | None,
        agents: int | None,
        starts: str,
    ) -> Instance:
        """Reads the file at `path`, or `text` in its place; `starts` is `checked` or `free`."""
    @property
    def agents(self) -> int:
        """How many agents there are."""
    def plan(
        self,
        planner: str | None,
        bound: float | None,
        model: str,
        batch: int | None,
        metric: str,
        timeout: float,
    ) -> Planned:
        """Plans without holding the interpreter, until `timeout` seconds of CPU time are spent."""
    def certify(self, path: str | PathLike[str], text: str | None, model: str) -> str:
        """What is wrong with the plan in the file at `path`, or with `text` in its place: a JSON list."""

class Planned:
    """What came of planning an instance."""

    @property
    def title(self) -> str:
        """What the file of the instance is called."""
    @property
    def planner(self) -> str:
        """The search."""
    def json(self) -> str:
        """The outcome with its numbers, as a JSON object."""
    def rows(self) -> list[tuple[str, str]]:
        """Label and value of every row of the table of results."""
    def cells(self) -> list[tuple[str, int | None, NDArray[int64]]] | None:
        """Cells (T, 2) of every agent with its name and the index of its goal; nothing for bodies that drive."""
    def poses(self) -> list[tuple[str, int | None, NDArray[float64]]] | None:
        """Poses (T, 3) of every agent with its name and the index of its goal; nothing for agents on grids."""
    def text(self) -> str:
        """The plan in the layout of libMultiRobotPlanning; yaws turn as in the instance's file."""
    def html(self) -> str:
        """The page that plays it."""
    def picture(self) -> str:
        """The picture, SVG."""
    def certify(self, model: str, instance: Instance | None) -> str:
        """What is wrong with it: a JSON list; against its own instance unless another one is given."""

def reeds_shepp_curve(start: list[float], goal: list[float], radius: float) -> ShortestCurve:
    """The shortest curve of a car that drives both ways."""

def dubins_curve(start: list[float], goal: list[float], radius: float) -> ShortestCurve:
    """The shortest curve of a car that drives forwards."""

class ShortestCurve:
    """A shortest curve from one pose to another."""

    @property
    def length(self) -> float:
        """Its length, m."""
    @property
    def segments(self) -> list[tuple[str, float]]:
        """Which way it steers and how far, m, negative backwards, piece by piece."""
    def sample(self, spacing: float) -> NDArray[float64]:
        """Poses (n, 3) along it, at most `spacing` apart, with both ends of every piece."""

def optimal_assignment(values: ArrayLike) -> tuple[list[int | None], float]:
    """The cheapest assignment."""

class Assignments:
    """The assignments in the order of their cost."""

    @staticmethod
    def under(values: ArrayLike) -> Assignments:
        """Those under costs (agents, goals)."""
    def following(self) -> tuple[list[int | None], float] | None:
        """The goals of all agents and the sum of the costs; nothing after the last assignment."""
