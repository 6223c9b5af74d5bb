"""The flowchart of the controller, drawn from the tables that the Rust code is tested against.

On the left the steps of one tick, in layers from the top: questions lead down or right. On the right the phases: those
of the manoeuvre in the right column, the others in the left one, final ones above. What all phases of a column share is
drawn once, from the frame around them. Arrows run along rows and around the columns, so that they do not cross.
"""

from __future__ import annotations

import os
import textwrap
from typing import TYPE_CHECKING, Any

from cohaul import _cohaul
from cohaul.plot._style import COLORS, figure_of, finished, load, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    Point = tuple[float, float]

_ROW = 1.5
"""Distance of rows."""
# the phase at the goal
_END = "done"
_WIDTH, _HEIGHT = 2.1, 0.62
"""Of a box."""
_WIDER = 0.9
"""What the box of a step has more."""
_HALF_WIDTH, _HALF_HEIGHT = 1.2, 0.52
"""Of a question."""
_TICK_X, _END_X = 0.0, 3.2
"""Columns of the steps of a tick and of the ways in which it ends."""
_WORK_X, _MOVE_X = 8.2, 13.9
"""Columns of the phases."""


def flowchart(*, ax: Axes | None = None, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draw the flow of control of one robot, after [R2P2] Fig. 3: the questions of a tick, and the phases.

    Nodes and arrows are those of `cohaul.flow()`; the teleport of simulations, which no robot has, is left out.

    ax
        Axes to draw into; by default a new figure.
    path
        File to save the figure to, PNG or SVG by its ending.
    """
    if ax is None:
        figure, ax = new_figure(14.0, 8.6)
    else:
        figure = figure_of(ax)
    nodes = [_without(node, "teleport") for node in _cohaul.flow() if node["name"] != "teleport"]
    steps = [node for node in nodes if node["kind"] == "step"]
    phases = [node for node in nodes if node["kind"] == "phase"]
    texts = {phase["name"]: phase["text"] for phase in phases}
    moves = {phase["name"] for phase in phases if phase["repositioning"]}
    _Tick(ax, steps, texts, moves).draw()
    _Phases(ax, phases).draw()
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.02)
    ax.set_axis_off()
    return finished(figure, path)


def _without(node: dict[str, Any], name: str) -> dict[str, Any]:
    """The node without its arrows to `name`."""
    return {**node, "next": [way for way in node["next"] if way["to"] != name]}


def _color(name: str, moves: set[str]) -> str:
    if name in moves or name == "repositioning":
        return COLORS["reposition"]
    return COLORS[{"work": "push", "hold": "hold", "done": "good"}.get(name, "accent")]


def _box(ax: Axes, center: Point, text: str, *, color: str, filled: bool = False, name: str) -> None:
    patches = load("matplotlib.patches")
    x, y = center
    width = _WIDTH if filled else _WIDTH + _WIDER
    shape = patches.FancyBboxPatch(
        (x - width / 2, y - _HEIGHT / 2),
        width,
        _HEIGHT,
        boxstyle="round,pad=0,rounding_size=0.2",
        fc=color if filled else COLORS["control"],
        ec=color,
        lw=1.2,
        zorder=3,
        gid=name,
    )
    ax.add_patch(shape)
    ink = COLORS["card"] if filled else COLORS["ink"]
    lines = textwrap.fill(text, 26)
    ax.text(x, y, lines, ha="center", va="center", fontsize=9, color=ink, zorder=4, weight="bold" if filled else None)


def _question(ax: Axes, center: Point, text: str, *, name: str) -> None:
    patches = load("matplotlib.patches")
    x, y = center
    corners = [(x - _HALF_WIDTH, y), (x, y + _HALF_HEIGHT), (x + _HALF_WIDTH, y), (x, y - _HALF_HEIGHT)]
    ax.add_patch(patches.Polygon(corners, fc=COLORS["card"], ec=COLORS["ink"], lw=1.2, zorder=3, gid=name))
    lines = textwrap.fill(text, 15)
    ax.text(x, y, lines, ha="center", va="center", fontsize=8.5, color=COLORS["ink"], zorder=4, linespacing=1.0)


def _arrow(ax: Axes, points: list[Point], *, name: str) -> None:
    """A line with a head at its end, along `points`."""
    patches, paths = load("matplotlib.patches"), load("matplotlib.path")
    ax.add_patch(
        patches.FancyArrowPatch(
            path=paths.Path(points),
            arrowstyle="-|>,head_length=5,head_width=2.5",
            color=COLORS["ink"],
            lw=1.1,
            zorder=2,
            shrinkA=0,
            shrinkB=0,
            capstyle="butt",
            joinstyle="round",
            gid=name,
        )
    )
    ax.update_datalim(points)


def _label(ax: Axes, at: Point, text: str, *, ha: str = "center", va: str = "center", width: int = 24) -> None:
    ax.text(
        *at,
        textwrap.fill(text, width),
        ha=ha,
        va=va,
        fontsize=8.5,
        color=COLORS["muted"],
        zorder=5,
        linespacing=1.05,
    )


class _Tick:
    """The steps of one tick."""

    def __init__(self, ax: Axes, steps: list[dict[str, Any]], texts: dict[str, str], moves: set[str]) -> None:
        self.ax, self.steps, self.texts, self.moves = ax, steps, texts, moves
        self.row = {step["name"]: -_ROW * row for row, step in enumerate(steps)}

    def draw(self) -> None:
        _title(self.ax, (_TICK_X + _END_X) / 2, "A tick")
        for step in self.steps:
            x, y = _TICK_X, self.row[step["name"]]
            if len(step["next"]) > 1:
                _question(self.ax, (x, y), step["text"], name=f"step {step['name']}")
            else:
                _box(self.ax, (x, y), step["text"], color=COLORS["ink"], name=f"step {step['name']}")
            below = [way for way in step["next"] if way["to"] in self.row] or step["next"][-1:]
            for way in step["next"]:
                self.lead(step, way, down=way in below)

    def lead(self, step: dict[str, Any], way: dict[str, str], *, down: bool) -> None:
        x, y = _TICK_X, self.row[step["name"]]
        name = f"{step['name']} to {way['to']}"
        if not down:
            _arrow(self.ax, [(x + _HALF_WIDTH, y), (_END_X - _WIDTH / 2, y)], name=name)
            _label(self.ax, ((x + _HALF_WIDTH + _END_X - _WIDTH / 2) / 2, y + 0.16), way["why"])
            self.end(way["to"], (_END_X, y))
            return
        below = next((other for other in self.steps if other["name"] == way["to"]), None)
        begin, end = y - self.half_height(step), y - _ROW + self.half_height(below)
        _arrow(self.ax, [(x, begin), (x, end)], name=name)
        _label(self.ax, (x + 0.1, (begin + end) / 2 + 0.04), way["why"], ha="left")
        if below is None:
            self.end(way["to"], (x, y - _ROW))

    def half_height(self, step: dict[str, Any] | None) -> float:
        """Of the shape of a step, or of an end."""
        return _HALF_HEIGHT if step is not None and len(step["next"]) > 1 else _HEIGHT / 2

    def end(self, name: str, center: Point) -> None:
        text = self.texts.get(name, "reposition")
        _box(self.ax, center, text, color=_color(name, self.moves), filled=True, name=f"end {name}")


class _Phases:
    """Phases and what makes one follow another."""

    def __init__(self, ax: Axes, phases: list[dict[str, Any]]) -> None:
        self.ax, self.phases = ax, [phase if phase["name"] != _END else {**phase, "next": []} for phase in phases]
        # from the end it goes back to work: one arrow, drawn on its own
        self.back = next(way["why"] for phase in phases if phase["name"] == _END for way in phase["next"])
        self.moves = [phase["name"] for phase in phases if phase["repositioning"]]
        self.final = [_END]
        self.works = [p["name"] for p in phases if p["name"] not in {*self.moves, *self.final}]
        self.at: dict[str, Point] = {}
        for row, name in enumerate(self.moves):
            self.at[name] = (_MOVE_X, -_ROW * (row + 1) * 1.15)
        bottom = self.at[self.moves[-1]][1]
        top = self.at[self.moves[0]][1]
        # the phase that all others come back to stands lowest, beside the end of the manoeuvre
        for row, name in enumerate(self.works):
            share = row / max(len(self.works) - 1, 1)
            self.at[name] = (_WORK_X, bottom + share * (top - bottom))
        for row, name in enumerate(self.final):
            self.at[name] = (_WORK_X + row * 1.3 * _WIDTH, 0.0)
        pad = 0.45
        # with room for what stands beside the arrows inside
        self.left = (_WORK_X - _WIDTH / 2 - pad - 0.7, _WORK_X + _WIDTH / 2 + pad)
        self.right = (_MOVE_X - _WIDTH / 2 - pad, _MOVE_X + _WIDTH / 2 + pad + 0.6)
        self.bottom, self.top = bottom - _HEIGHT / 2 - pad, top + _HEIGHT / 2 + pad
        self.elbows = 0

    def draw(self) -> None:
        _title(self.ax, (_WORK_X + _MOVE_X) / 2, "Phases")
        moves = set(self.moves)
        for phase in self.phases:
            name = phase["name"]
            _box(self.ax, self.at[name], phase["text"], color=_color(name, moves), filled=True, name=f"phase {name}")
        self.frame(self.left)
        self.frame(self.right)
        for members, source, to, why in self.merged():
            self.lead(members, source, to, why)
        x, y = self.at[_END]
        back = x - 0.35 * _WIDTH
        _arrow(self.ax, [(back, y - _HEIGHT / 2), (back, self.top)], name=f"{_END} to {'+'.join(self.works)}")
        _label(self.ax, (back - 0.12, (y - _HEIGHT / 2 + self.top) / 2), self.back, ha="right")

    def merged(self) -> list[tuple[list[str], str, str, str]]:
        """Transitions as (members, source, to, why); `members` is a whole column if all of it has the transition."""
        arrows = [(p["name"], way["to"], way["why"]) for p in self.phases for way in p["next"]]
        found: list[tuple[list[str], str, str, str]] = []
        for source, to, why in arrows:
            column = self.moves if source in self.moves else self.works
            shared = len(column) > 1 and all((member, to, why) in arrows for member in column)
            if not shared:
                found.append(([source], source, to, why))
            elif source == column[0]:
                found.append((column, source, to, why))
        return found

    def frame(self, across: tuple[float, float]) -> None:
        patches = load("matplotlib.patches")
        size = (across[1] - across[0], self.top - self.bottom)
        style = "round,pad=0,rounding_size=0.3"
        box = patches.FancyBboxPatch((across[0], self.bottom), *size, boxstyle=style, fc=COLORS["card"], zorder=1)
        box.set(edgecolor=COLORS["obstacle-line"], linestyle=(0, (4, 3)), linewidth=1.0)
        self.ax.add_patch(box)

    def lead(self, members: list[str], source: str, to: str, why: str) -> None:
        name = f"{'+'.join(members)} to {to}"
        whole = len(members) > 1
        (x, y), (tx, ty) = self.at[source], self.at[to]
        half_w, half_h = _WIDTH / 2, _HEIGHT / 2
        gap = (self.left[1] + self.right[0]) / 2
        if to in self.final:
            # around the top
            start = self.left if source in self.works else self.right
            if start is self.left and tx == _WORK_X:
                _arrow(self.ax, [(tx, self.top), (tx, ty - half_h)], name=name)
                _label(self.ax, (tx + 0.12, (self.top + ty - half_h) / 2), why, ha="left")
            else:
                middle = x
                _arrow(self.ax, [(middle, self.top), (middle, ty), (tx + half_w, ty)], name=name)
                _label(self.ax, ((middle + tx + half_w) / 2, ty + 0.18), why, width=40)
        elif source in self.moves and to in self.moves:
            edge = half_h if ty > y else -half_h
            _arrow(self.ax, [(x, y + edge), (tx, ty - edge)], name=name)
            _label(self.ax, (x + 0.12, (y + ty) / 2), why, ha="left")
        elif source in self.works and to in self.works:
            # side by side: one up, one down
            up = ty > y
            side, edge = (-0.8, half_h) if up else (-0.3, -half_h)
            _arrow(self.ax, [(x + side, y + edge), (x + side, ty - edge)], name=name)
            spot = (y + ty) / 2 + (0.55 if up else -0.55)
            _label(self.ax, (x + side + (-0.1 if up else 0.1), spot), why, ha="right" if up else "left", width=12)
        elif source in self.works:
            begin = self.left[1] if whole else x + half_w
            _arrow(self.ax, [(begin, ty), (tx - half_w, ty)], name=name)
            _label(self.ax, (gap, ty + 0.12), why, va="bottom")
        elif whole:
            low = self.bottom - 0.7
            _arrow(self.ax, [(x, self.bottom), (x, low), (tx, low), (tx, ty - half_h)], name=name)
            _label(self.ax, (gap, low - 0.12), why, va="top", width=40)
        else:
            same_row = y == ty
            if same_row:
                _arrow(self.ax, [(x - half_w, y), (tx + half_w, ty)], name=name)
            else:
                into = tx + half_w - 0.2 - 0.3 * self.elbows
                self.elbows += 1
                _arrow(self.ax, [(x - half_w, y), (into, y), (into, ty + half_h)], name=name)
            _label(self.ax, (gap, y + 0.12), why, va="bottom")


def _title(ax: Axes, x: float, text: str) -> None:
    ax.text(x, 1.0, text, ha="center", va="center", fontsize=13, weight="bold", color=COLORS["ink"])
    ax.update_datalim([(x, 1.3)])
