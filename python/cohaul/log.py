"""Logs: decided anew, rescued, compared; trials too."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cohaul import _cohaul

__all__ = ["Difference", "Recovered", "Replayed", "compare", "recover", "replay"]


@dataclass(frozen=True)
class Difference:
    """A decision that came out differently."""

    robot: int
    """Who decided: 1 for the robot `r1` of the log."""
    time_s: float
    """When, s."""
    recorded: str
    """What the log says."""
    decided: str
    """What came out now."""


@dataclass(frozen=True)
class Replayed:
    """What a replay found; the names are those of `cohaul replay --json`."""

    name: str
    """Name of the mission."""
    version: str
    """Version of the program that wrote the log."""
    decisions: int
    """Decisions compared."""
    different: int
    """Decisions that came out differently."""
    first_difference: Difference | None
    """The first of them."""

    @property
    def ok(self) -> bool:
        """Whether every decision came out as recorded, bit for bit."""
        return self.different == 0


@dataclass(frozen=True)
class Recovered:
    """What was rescued; the names are those of `cohaul recover --json`."""

    messages: int
    """Messages saved."""
    missing: int
    """Messages known to be lost between those saved."""
    skipped_bytes: int
    """Bytes passed over in search of the next whole chunk."""
    reason: str | None
    """What was wrong first; `None` if the log was whole."""
    log: Path
    """The new log."""


def replay(log: str | os.PathLike[str]) -> Replayed:
    """Decide every recorded observation of a log anew and compare the decisions bit for bit.

    Only what the log holds is used. Raises `MissingFileError`, `FileError`, and `RecordError` for a damaged log.
    """
    found = _cohaul.replay(log)
    first = found.pop("first_difference")
    return Replayed(**found, first_difference=None if first is None else Difference(**first))


def recover(log: str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None) -> Recovered:
    """Make a valid log of an unfinished or damaged one.

    The new log is `out`, or NAME.recovered.mcap beside the old one, which stays as it is. Raises `MissingFileError`,
    `FileError`, and `RecordError` if nothing can be saved.
    """
    return Recovered(**_cohaul.recover(log, out))


def compare(
    a: str | os.PathLike[str],
    b: str | os.PathLike[str],
    *,
    fields: Iterable[str] = (),
    out: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """Compare two logs, or two sets of trials; the keys are those of `cohaul compare --json`.

    Two logs (`.mcap`): distance [m] and difference of yaw [rad] between the ways of each load at equal shares of their
    length, and the ratio of times. With `out` a picture of both ways, A-vs-B.svg and A-vs-B.png after the names of the
    files, is written into that folder.

    Two sets of trials (result folders or `.parquet` files), paired by cell and seed: success with the exact p value of
    McNemar's test, difference and ratio of times [s] where both reached the goal with their 95 % intervals; the same for
    the other numbers named in `fields`.

    Raises `CompareError` if there is nothing to compare, `MissingFileError`, `FileError`, and `RecordError` for a damaged
    log.
    """
    found: dict[str, Any] = json.loads(_cohaul.compare(a, b, list(fields), out))
    return found
