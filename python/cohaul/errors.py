"""Exceptions. Everything that cohaul raises on purpose is a `CohaulError`; bad values are also `ValueError`."""

from __future__ import annotations

__all__ = [
    "CohaulError",
    "CompareError",
    "ContactError",
    "ControlError",
    "ExperimentError",
    "FileError",
    "InstanceError",
    "MissingFileError",
    "MissingPackageError",
    "PlanError",
    "PlotError",
    "RecordError",
    "ScenarioError",
    "ScenarioWarning",
    "SimError",
]


class CohaulError(Exception):
    """Base of all exceptions of this package."""


class _Located(Exception):
    """A problem and its place: in the scenario file, or in the overrides where these are at fault."""

    message: str
    """What is wrong, without the place."""
    file: str
    """Name of the file; `scenario` for a scenario given as text."""
    line: int | None
    """Line in the file, counted from 1; `None` where an override is at fault."""
    column: int | None
    """Column in the line, in characters counted from 1; `None` where an override is at fault."""
    remedy: str
    """What to do about it."""
    overrides: tuple[str, ...]
    """The overrides at fault, as `path=value`."""

    def __init__(
        self,
        text: str,
        message: str = "",
        file: str = "",
        line: int | None = None,
        column: int | None = None,
        remedy: str = "",
        overrides: tuple[str, ...] | list[str] = (),
    ) -> None:
        super().__init__(text)
        self.message = message or text
        self.file = file
        self.line = line
        self.column = column
        self.remedy = remedy
        self.overrides = tuple(overrides)
        if remedy:
            self.add_note(f"help: {remedy}")


class ScenarioError(_Located, CohaulError, ValueError):
    """A scenario is refused: not YAML, an unknown key, a value out of range, or a mission that makes no sense."""


class ScenarioWarning(_Located, UserWarning):
    """Something in a scenario is allowed, but probably not meant."""


class CompareError(CohaulError, ValueError):
    """Two results have nothing to compare, are of different kinds, or lack a field."""


class ContactError(CohaulError, ValueError):
    """A contact model cannot be made of, or asked for, these values."""


class ControlError(CohaulError, ValueError):
    """A controller refuses its parameters, or a log's memory does not fit it."""


class PlotError(CohaulError, ValueError):
    """A figure cannot be drawn of these results."""


class ExperimentError(CohaulError, ValueError):
    """There is no such experiment, or its folder holds trials of another one."""


class InstanceError(_Located, CohaulError, ValueError):
    """A planning instance or a plan is refused: not of a known format, or a value that makes no sense."""


class PlanError(CohaulError, ValueError):
    """Slots that cannot be chosen, a team that cannot form anew, or planning asked for what it cannot do."""


class SimError(CohaulError):
    """A mission cannot be run or replayed."""


class RecordError(CohaulError):
    """A log is not one, is damaged, or cannot be written."""


class FileError(CohaulError, OSError):
    """A file cannot be read or written."""


class MissingFileError(FileError, FileNotFoundError):
    """A file does not exist."""


class MissingPackageError(CohaulError, ImportError):
    """A package that this function needs is not installed."""
