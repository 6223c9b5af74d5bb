"""Logs: decided anew, rescued."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from cohaul import _cohaul

__all__ = ["Difference", "Recovered", "Replayed", "recover", "replay"]


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
