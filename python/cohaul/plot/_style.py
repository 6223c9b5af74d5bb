"""What all figures share: colours, the lazy import, saving."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from cohaul.errors import MissingPackageError, PlotError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# the light colours of the replay page, crates/sim/src/page/style.css; a test compares them
COLORS = {
    "ink": "#1c2430",
    "muted": "#5d6878",
    "line": "#d9dee5",
    "grid": "#edf0f3",
    "control": "#eef1f5",
    "card": "#ffffff",
    "accent": "#1f5fa8",
    "good": "#0b7a55",
    "bad": "#b3400a",
    "push": "#0072b2",
    "prevent": "#d55e00",
    "support": "#009e73",
    "reposition": "#c765a0",
    "hold": "#6b7482",
    "load": "#ead9b5",
    "load-line": "#86682c",
    "obstacle": "#c3cad3",
    "obstacle-line": "#8a94a2",
    "waypoint": "#3c4756",
}
SERIES = [COLORS[name] for name in ("push", "prevent", "support", "reposition", "load-line", "ink")]
"""Colours of lines without a meaning of their own."""
DASHES: list[Any] = ["-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (5, 1.5, 1, 1.5)), (0, (8, 2)), (0, (3, 1, 1, 1, 1, 1))]
"""Their dashes, so that they differ in print too."""
MARKERS = ["o", "s", "^", "D", "v", "P"]
"""Their markers."""


def load(name: str, *, extra: str = "plot") -> ModuleType:
    """The module `name`, or an error that says which extra of this package brings it."""
    try:
        return importlib.import_module(name)
    except ImportError as error:
        package = name.split(".")[0]
        raise MissingPackageError(f"{package} is not installed; get it with: pip install cohaul[{extra}]") from error


def new_figure(width: float, height: float, **layout: Any) -> tuple[Figure, Any]:
    """A figure of `width` by `height` inches and its axes, as `matplotlib.pyplot.subplots` lays them out."""
    figure: Figure = load("matplotlib.pyplot").figure(figsize=(width, height), layout="constrained")
    figure.set_facecolor(COLORS["card"])
    return figure, figure.subplots(**layout)


def figure_of(ax: Axes) -> Figure:
    """The figure that axes given by the caller belong to."""
    figure = ax.get_figure(root=True)
    if figure is None:
        raise PlotError("the axes belong to no figure")
    return figure


def tidy(ax: Axes) -> None:
    """The look of axes with scales: a light grid behind, no box."""
    ax.set_facecolor(COLORS["card"])
    ax.set_axisbelow(True)
    ax.grid(color=COLORS["grid"])
    ax.tick_params(colors=COLORS["muted"], labelcolor=COLORS["ink"])
    for side, spine in ax.spines.items():
        spine.set_color(COLORS["line"])
        spine.set_visible(side in ("left", "bottom"))


def finished(figure: Figure, path: str | os.PathLike[str] | None) -> Figure:
    """Saves the figure if it shall be; gives it back."""
    if path is not None:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        # the same figure gives the same file: no date, no random ids
        with load("matplotlib").rc_context({"svg.hashsalt": "cohaul"}):
            dated = Path(path).suffix.lower() in (".svg", ".pdf")
            key = {".svg": "Date", ".pdf": "CreationDate"}.get(Path(path).suffix.lower(), "")
            figure.savefig(path, dpi=150, metadata={key: None} if dated else None)
    return figure
