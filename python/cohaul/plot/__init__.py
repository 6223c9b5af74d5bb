"""Figures of missions, of trials and of the controller.

>>> import cohaul
>>> outcome = cohaul.run("scenarios/r2p2/flat.yaml")  # doctest: +SKIP
>>> cohaul.plot.trajectory(outcome, path="flat.png")  # doctest: +SKIP

Every function returns the matplotlib figure; `path` saves it too, in the format of its ending. Colours are those of the
replay page. matplotlib is loaded by the first figure; it comes with `pip install cohaul[plot]`.
"""

from __future__ import annotations

from cohaul.plot._flowchart import flowchart
from cohaul.plot._mission import rotation_traces, trajectory
from cohaul.plot._trials import main_effects, success_curves

__all__ = ["flowchart", "main_effects", "rotation_traces", "success_curves", "trajectory"]
