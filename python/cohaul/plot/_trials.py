"""Figures of many trials."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cohaul.errors import PlotError
from cohaul.plot._style import COLORS, DASHES, MARKERS, SERIES, figure_of, finished, load, new_figure, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_TERRAINS = ["flat", "uphill", "downhill"]
_NORMAL_95 = 1.959964
"""97.5 % quantile of the normal distribution."""


def _table(trials: Any) -> Any:
    """Trials as a pandas DataFrame: given as one, as a Parquet file, or as a results folder with `trials.parquet`."""
    if not isinstance(trials, str | os.PathLike):
        return load("pandas").DataFrame(trials)
    file = Path(trials)
    file = file / "trials.parquet" if file.is_dir() else file
    load("pyarrow")
    return load("pandas").read_parquet(file)


def _checked(table: Any, columns: Sequence[str]) -> None:
    missing = [name for name in columns if name not in table.columns]
    if missing:
        raise PlotError(f"the trials have no column {', '.join(missing)}; there are {', '.join(table.columns)}")
    if len(table) == 0:
        raise PlotError("there are no trials")


def _selected(table: Any, where: Mapping[str, object] | None) -> Any:
    """The trials that have these values."""
    _checked(table, list(where or ()))
    for name, value in (where or {}).items():
        table = table[table[name] == value]
    return table


def _terrains(table: Any) -> list[str | None]:
    """The terrains in the table, the known ones first; one unnamed if there is no such column."""
    if "terrain" not in table.columns:
        return [None]
    found = [str(name) for name in table["terrain"].unique()]
    return sorted(found, key=lambda name: (_TERRAINS.index(name) if name in _TERRAINS else len(_TERRAINS), name))


def _of(table: Any, terrain: str | None) -> Any:
    return table if terrain is None else table[table["terrain"] == terrain]


def main_effects(
    trials: Any,
    *,
    factors: Sequence[str] | Mapping[str, str],
    where: Mapping[str, object] | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Figure:
    """Draw what each factor does to the task time on each terrain, as in [R2P2] Figs. 8 and 9.

    The task time is `time_s` plus `penalty_s`; means are over the trials whose `outcome` is `reached`. Each line joins
    the means of one factor's levels, in ascending order of their values; the legend says their range. The dashed line is
    the mean of all.

    trials
        Folder of results with a `trials.parquet`, such a file, or a table: whatever `pandas.DataFrame` takes.
    factors
        Columns to draw as lines; a mapping gives each a name for the legend.
    where
        Columns and the values that trials must have there, such as `{"reposition": "teleport"}` for `r2p2-taguchi`.
    path
        File to save the figure to, PNG or SVG by its ending.
    """
    table = _selected(_table(trials), where)
    names = dict(factors) if isinstance(factors, Mapping) else {factor: factor for factor in factors}
    _checked(table, [*names, "outcome", "time_s"])
    terrains = _terrains(table)
    figure, axes = new_figure(4.2 * len(terrains), 4.6, ncols=len(terrains), sharey=False, squeeze=False)
    for ax, terrain in zip(axes[0], terrains, strict=True):
        tidy(ax)
        reached = _of(table, terrain)
        reached = reached[reached["outcome"] == "reached"]
        ax.set_title(terrain or "all trials", color=COLORS["ink"])
        if len(reached) == 0:
            ax.text(0.5, 0.5, "none reached its goal", transform=ax.transAxes, ha="center", color=COLORS["muted"])
            continue
        seconds = reached["time_s"] + (reached["penalty_s"] if "penalty_s" in reached.columns else 0.0)
        ax.axhline(seconds.mean(), color=COLORS["muted"], ls="--", lw=1.2, label=f"mean {seconds.mean():.3g} s")
        # a level keeps its place where all of its trials failed
        most = 1
        for number, (factor, name) in enumerate(names.items()):
            levels = sorted(table[factor].unique())
            means = seconds.groupby(reached[factor]).mean().reindex(levels)
            most = max(most, len(levels))
            ax.plot(
                range(1, len(levels) + 1),
                means.to_numpy(),
                color=SERIES[number % len(SERIES)],
                ls=DASHES[number % len(DASHES)],
                marker=MARKERS[number % len(MARKERS)],
                label=f"{name}: Δ {means.max() - means.min():.3g} s",
            )
        ax.set(xlabel="level", xticks=range(1, most + 1))
        ax.margins(x=0.12)
        ax.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=9, ncols=2)
    axes[0][0].set_ylabel("task time [s]")
    return finished(figure, path)


def wilson(successes: int, trials: int) -> tuple[float, float]:
    """95 % confidence interval of a share, from 0 to 1 ([Wilson1927]).

    >>> low, high = wilson(8, 10)
    >>> round(low, 3), round(high, 3)
    (0.49, 0.943)
    """
    if trials == 0:
        return 0.0, 1.0
    share, square = successes / trials, _NORMAL_95**2
    center = (share + square / (2 * trials)) / (1 + square / trials)
    half = _NORMAL_95 / (1 + square / trials) * math.sqrt(share * (1 - share) / trials + square / (4 * trials**2))
    return max(center - half, 0.0), min(center + half, 1.0)


def success_curves(
    trials: Any,
    *,
    factor: str,
    where: Mapping[str, object] | None = None,
    ax: Axes | None = None,
    path: str | os.PathLike[str] | None = None,
) -> Figure:
    """Draw the share of trials that reached their goal over a factor, one line a terrain, with 95 % Wilson bands.

    trials
        Folder of results with a `trials.parquet`, such a file, or a table: whatever `pandas.DataFrame` takes.
    factor
        Column of numbers to draw over.
    where
        Columns and the values that trials must have there, such as `{"disturbance": "noise_cm"}` for `r2p2-robustness`.
    ax
        Axes to draw into; by default a new figure.
    path
        File to save the figure to, PNG or SVG by its ending.
    """
    table = _selected(_table(trials), where)
    _checked(table, [factor, "outcome"])
    if ax is None:
        figure, ax = new_figure(6.5, 4.2)
    else:
        figure = figure_of(ax)
    tidy(ax)
    for number, terrain in enumerate(_terrains(table)):
        of_terrain = _of(table, terrain)
        levels = sorted(of_terrain[factor].unique())
        reached = [(of_terrain[of_terrain[factor] == level]["outcome"] == "reached") for level in levels]
        bands = [wilson(int(hits.sum()), len(hits)) for hits in reached]
        color = SERIES[number % len(SERIES)]
        lows, highs = [low for low, _ in bands], [high for _, high in bands]
        ax.fill_between(levels, lows, highs, color=color, alpha=0.15, lw=0)
        ax.plot(
            levels,
            [float(hits.mean()) for hits in reached],
            color=color,
            ls=DASHES[number % len(DASHES)],
            marker=MARKERS[number % len(MARKERS)],
            label=terrain or "all trials",
            clip_on=False,
        )
    ax.set(xlabel=factor, ylabel="share that reached the goal", ylim=(0.0, 1.0))
    ax.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.02), ncols=4, borderaxespad=0.0)
    return finished(figure, path)
