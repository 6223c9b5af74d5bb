"""The published experiments: the tables and figures of the papers, run anew."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cohaul import _cohaul
from cohaul.mission import override_texts

__all__ = ["experiments", "reproduce"]


def experiments() -> dict[str, str]:
    """Names of the published tables and figures, with what each of them shows."""
    return dict(_cohaul.experiments())


def reproduce(
    name: str,
    *,
    trials: int | None = None,
    seed: int = 1,
    world: str = "planar",
    jobs: int = 0,
    out: str | os.PathLike[str] = "out/reproduce",
    set: Mapping[str, object] | None = None,
) -> dict[str, Any]:
    """Re-run a published table or figure; the keys are those of `cohaul reproduce --json`, and `folder`.

    name
        One of `experiments()`, such as `r2p2-generalize`.
    trials
        Trials per cell; the experiment's own number if it is not given.
    seed
        Seed of the first trial of every cell; the others follow.
    world
        Simulator, `planar` or `spatial`.
    jobs
        Threads; as many as there are cores for 0.
    out
        Folder; trials.parquet, report.md and the figures are written into NAME-WORLD in it. Trials that are there already
        are not run again.
    set
        Keys of the scenario set in every cell, such as `{"sensors.latency": 0.05}`; use another `out`.

    Ctrl-C ends the experiment with `KeyboardInterrupt`; what has finished is kept, and the same call goes on from there.
    Raises `ExperimentError` for an unknown name or a folder of other trials, `ScenarioError`, `FileError`.
    """
    text, folder = _cohaul.reproduce(name, trials, seed, world, jobs, out, override_texts(set))
    found: dict[str, Any] = json.loads(text)
    found["folder"] = Path(folder)
    return found
