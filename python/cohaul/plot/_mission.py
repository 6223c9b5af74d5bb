"""Figures of one mission."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from cohaul.errors import PlotError
from cohaul import _cohaul
from cohaul.mission import Outcome, Phase, Primitive, Role, Traces
from cohaul.plot._style import COLORS, figure_of, finished, load, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy import float64, int8
    from numpy.typing import NDArray

    Source = Outcome | str | os.PathLike[str]

_TURN_LENGTH = 0.5
"""Metres that a radian counts for when outlines are spread along the way."""
_ROLES = {Role.PUSH: "push", Role.PREVENT: "prevent", Role.SUPPORT: "support"}
_ACTIVITIES = [*_ROLES.values(), "reposition", "hold"]


def _read(source: Source) -> tuple[Traces, dict[str, Any]]:
    """Traces and layout of an outcome or of a log."""
    mission = source._mission if isinstance(source, Outcome) else _cohaul.Recording.read(source)
    traces = source.traces if isinstance(source, Outcome) else Traces(**mission.traces())
    return traces, mission.layout()


def _placed(points: NDArray[float64], pose: NDArray[float64]) -> NDArray[float64]:
    """Points (n, 2) of a body's frame in the world, the body at `pose` (3,)."""
    x, y, yaw = pose
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    return np.asarray(points @ turn.T + [x, y])


def _activity(traces: Traces, index: int, robot: int) -> str:
    """What a robot is shown as: its role while it works, else what it does instead, as on the replay page.

    A robot without a role, before its first decision and after the last waypoint, has the one nearest in time.
    """
    known = np.flatnonzero(traces.role[:, robot] != Role.NONE)
    if known.size:
        index = known[np.argmin(np.abs(known - index))]
    role, phase = Role(traces.role[index, robot]), Phase(traces.phase[index, robot])
    if phase == Phase.WORK and role in _ROLES:
        return _ROLES[role]
    return "reposition" if phase in _repositioning() else "hold"


@cache
def _repositioning() -> frozenset[int]:
    """Codes of the phases in which a robot repositions itself."""
    phases = [node for node in _cohaul.flow() if node["kind"] == "phase"]
    return frozenset(code for code, node in enumerate(phases) if node["repositioning"])


def _spread(pose: NDArray[float64], count: int) -> NDArray[np.intp]:
    """Indices of `count` instants from the first to the last, spread evenly over how far the load (T, 3) has come."""
    steps = np.diff(np.column_stack([pose[:, :2], _TURN_LENGTH * np.unwrap(pose[:, 2])]), axis=0)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    return np.searchsorted(way, np.linspace(0.0, way[-1], count)).clip(0, len(way) - 1)


def trajectory(
    outcome: Source,
    *,
    times: Sequence[float] | None = None,
    outlines: int = 14,
    ax: Axes | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Figure:
    """Draw the way of the loads, seen from above, as in [R2P2] Fig. 6.

    outcome
        An outcome of `run`, or the path of a log.
    times
        Instants at which the robots are drawn [s]; by default four, spread over the way of the first load.
    outlines
        How many outlines of each load are drawn.
    ax
        Axes to draw into; by default a new figure.
    path
        File to save the figure to, PNG or SVG by its ending.
    """
    traces, layout = _read(outcome)
    patches = load("matplotlib.patches")
    own = ax is None
    if ax is None:
        figure, ax = new_figure(9.0, 6.0)
    else:
        figure = figure_of(ax)
    tidy(ax)
    if times is None:
        shown = _spread(traces.load_pose[:, 0], 4)
    else:
        shown = np.searchsorted(traces.time, times).clip(0, traces.time.size - 1)
    for obstacle in layout["obstacles"]:
        ax.add_patch(patches.Polygon(obstacle, fc=COLORS["obstacle"], ec=COLORS["obstacle-line"]))
    for team in layout["teams"]:
        _draw_reference(ax, traces.load_pose[0, team["load"], :2], team)
    for number, outline in enumerate(layout["outlines"]):
        pose = traces.load_pose[:, number]
        for index in _spread(pose, outlines):
            ax.add_patch(patches.Polygon(_placed(outline, pose[index]), fill=False, ec=COLORS["load-line"], alpha=0.35))
        for index in shown:
            corners = _placed(outline, pose[index])
            ax.add_patch(patches.Polygon(corners, fc=COLORS["load"], ec=COLORS["load-line"], alpha=0.6, zorder=2.1))
        final = patches.Polygon(_placed(outline, pose[-1]), fill=False, ec=COLORS["load-line"], lw=2.4, zorder=2.6)
        final.set_label("final pose")
        ax.add_patch(final)
        ax.plot(pose[:, 0], pose[:, 1], color=COLORS["load-line"], lw=1.8, zorder=2.5, label="way of the load")
    for team in layout["teams"]:
        for index in shown:
            _draw_robots(ax, traces, team, index)
        _name_instants(ax, traces, team, layout["outlines"][team["load"]], shown)
    ax.set_aspect("equal")
    ax.margins(0.04)
    ax.autoscale_view()
    ax.set(xlabel="x [m]", ylabel="y [m]")
    ax.set_title(layout["name"], color=COLORS["ink"])
    if own:
        # as high as the mission is, with room for title, axis and legend
        (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
        figure.set_size_inches(9.0, min(8.4 * (high - low) / (right - left) + 1.5, 12.0))
    robots = range(traces.role.shape[1])
    _add_legend(figure, ax, {_activity(traces, index, robot) for index in shown for robot in robots})
    return finished(figure, path)


def _add_legend(figure: Figure, ax: Axes, activities: set[str]) -> None:
    """One entry for each kind of line, and for each activity of the robots drawn."""
    lines = load("matplotlib.lines")
    handles, labels = ax.get_legend_handles_labels()
    named = dict(zip(labels, handles, strict=True))
    for activity in (a for a in _ACTIVITIES if a in activities):
        named[activity] = lines.Line2D([], [], ls="", marker="o", ms=9, color=COLORS[activity])
    figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=5, frameon=False, fontsize=9)


def _draw_reference(ax: Axes, start: NDArray[float64], team: dict[str, Any]) -> None:
    """Straight lines through the waypoints, and the circles within which these count as reached."""
    patches = load("matplotlib.patches")
    points = np.vstack([start, team["waypoints"]])
    ax.plot(*points.T, color=COLORS["waypoint"], ls=(0, (4, 3)), lw=1.2, zorder=2.2, label="reference")
    ax.plot(*points[1:].T, "x", color=COLORS["waypoint"], ms=5, zorder=3.2, label="waypoint")
    for point in points[1:]:
        circle = patches.Circle(point, team["tolerance"], fill=False, ec=COLORS["waypoint"], lw=1.0, zorder=3.1)
        ax.add_patch(circle)


def _draw_robots(ax: Axes, traces: Traces, team: dict[str, Any], index: int) -> None:
    """The robots of a team at one instant, each with a line to its front."""
    patches = load("matplotlib.patches")
    for robot in team["robots"]:
        x, y, yaw = traces.robot_pose[index, robot]
        color = COLORS[_activity(traces, index, robot)]
        ax.add_patch(patches.Circle((x, y), team["radius"], fc=color, ec=COLORS["card"], lw=0.6, zorder=2.8))
        front = team["radius"] * np.array([np.cos(yaw), np.sin(yaw)])
        ax.plot([x, x + front[0]], [y, y + front[1]], color=COLORS["card"], lw=1.2, zorder=2.9)


def _name_instants(
    ax: Axes, traces: Traces, team: dict[str, Any], outline: NDArray[float64], shown: NDArray[np.intp]
) -> None:
    """Writes the times beside the load, beyond its ends, where it is farthest from all robots and other times."""
    effects = load("matplotlib.patheffects")
    taken = traces.robot_pose[shown][:, team["robots"], :2].reshape(-1, 2)
    for index in shown:
        reach = max(outline[:, 1]) + 2.0 * team["radius"] + np.array([0.16, 0.26, 0.36])
        places = np.array([[0.0, side * away] for away in reach for side in (1.0, -1.0)])
        places = _placed(places, traces.load_pose[index, team["load"]])
        clear = np.linalg.norm(places[:, None] - taken, axis=-1).min(axis=1)
        # the nearest place that is clear enough, else the clearest
        enough = np.flatnonzero(clear > team["radius"] + 0.15)
        x, y = places[enough[0] if enough.size else int(np.argmax(clear))]
        taken = np.vstack([taken, [x, y]])
        text = ax.text(x, y, f"{traces.time[index]:.0f} s", ha="center", va="center", color=COLORS["ink"], zorder=4)
        text.set_path_effects([effects.withStroke(linewidth=3, foreground=COLORS["card"])])
        ax.update_datalim([(x - 0.15, y - 0.12), (x + 0.15, y + 0.12)])


def _first_rotation(primitive: NDArray[int8], time: NDArray[float64]) -> tuple[float, float]:
    """When the first rotation begins and ends, s."""
    turning = np.isin(primitive, (Primitive.ROTATE_COUNTERCLOCKWISE, Primitive.ROTATE_CLOCKWISE))
    if not turning.any():
        raise PlotError(f"the load is never rotated within {time[-1]:.1f} s; give the interval as `span`")
    first = int(np.argmax(turning))
    over = np.flatnonzero(~turning[first:])
    last = first + int(over[0]) - 1 if over.size else len(time) - 1
    return float(time[first]), float(time[last])


def rotation_traces(
    outcome: Source,
    *,
    team: int = 0,
    span: tuple[float, float] | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Figure:
    """Draw how a team turns its load, as in [R2P2] Fig. 7: heading error, yaw rate of the load, speeds by role.

    Intervals in which a robot repositions itself are shaded.

    outcome
        An outcome of `run`, or the path of a log.
    team
        Number of the team, from 0.
    span
        Interval to draw [s, s]; by default the first rotation.
    path
        File to save the figure to, PNG or SVG by its ending.
    """
    traces, layout = _read(outcome)
    spec = layout["teams"][team]
    begin, end = span or _first_rotation(traces.primitive[:, team], traces.time)
    inside = (traces.time >= begin) & (traces.time <= end)
    if inside.sum() < 2:
        raise PlotError(f"the mission, 0 to {traces.time[-1]:.1f} s, has no two instants from {begin} to {end} s")
    time = traces.time[inside]
    figure, axes = new_figure(8.0, 8.0, nrows=4, sharex=True)
    for ax in axes:
        tidy(ax)
        ax.axhline(0.0, color=COLORS["line"], lw=0.8)
    axes[0].plot(time, np.degrees(traces.heading_error[inside, team]), color=COLORS["ink"])
    if spec["heading_threshold"] is not None:
        threshold = float(np.degrees(spec["heading_threshold"]))
        sign = np.sign(np.median(traces.heading_error[inside, team])) or 1.0
        axes[0].axhline(sign * threshold, color=COLORS["accent"], ls="--", lw=1.0, label=f"begins at {threshold:.2f}°")
        _legend_beside(axes[0])
    axes[0].set_ylabel("heading\nerror [°]")
    yaw = np.unwrap(traces.load_pose[:, spec["load"], 2])
    axes[1].plot(time, np.gradient(yaw, traces.time)[inside], color=COLORS["load-line"])
    axes[1].set_ylabel("load's yaw\nrate [rad/s]")
    for ax, role in zip(axes[2:], (Role.PUSH, Role.PREVENT), strict=True):
        name = _ROLES[role]
        styles = iter(["-", (0, (5, 1.5)), (0, (1.5, 1)), (0, (5, 1.5, 1, 1.5))] * len(spec["robots"]))
        for robot in spec["robots"]:
            has = (traces.role[inside, robot] == role) & (traces.phase[inside, robot] == Phase.WORK)
            if has.any():
                speed = np.where(has, traces.speed[inside, robot], np.nan)
                ax.plot(time, speed, color=COLORS[name], ls=next(styles), lw=1.3, label=f"robot {robot + 1}")
        ax.set_ylabel(f"{name} robots'\nspeed [m/s]")
        if ax.get_legend_handles_labels()[0]:
            _legend_beside(ax)
    stopped = traces.stop[inside][:, spec["robots"]].any(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], stopped, [False]])))
    for first, after in edges.reshape(-1, 2):
        for ax in axes:
            ax.axvspan(time[first], time[min(after, time.size - 1)], color=COLORS["reposition"], alpha=0.18, lw=0)
    if edges.size:
        axes[1].axvspan(np.nan, np.nan, color=COLORS["reposition"], alpha=0.18, lw=0, label="repositioning")
        _legend_beside(axes[1])
    axes[-1].set(xlabel="time [s]", xlim=(time[0], time[-1]))
    axes[0].set_title(layout["name"], color=COLORS["ink"])
    figure.align_ylabels()
    return finished(figure, path)


def _legend_beside(ax: Axes) -> None:
    ax.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
