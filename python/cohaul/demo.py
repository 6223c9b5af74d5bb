"""What `make demo` shows: missions run one after the other, their results as a table, and where their pages are."""

from __future__ import annotations

import argparse
import sys

import cohaul

_COLUMNS = ("mission", "outcome", "time", "final error", "repositions", "× real time")


def _row(outcome: cohaul.Outcome) -> tuple[str, ...]:
    return (
        outcome.name,
        outcome.outcome,
        f"{outcome.time_s:.1f} s",
        f"{outcome.final_error_m:.3f} m",
        f"{outcome.repositions}",
        f"{outcome.real_time_factor:.0f}",
    )


def main(arguments: list[str] | None = None) -> int:
    """Run the scenario files named in `arguments`; the exit status is 0 if every load was delivered."""
    parser = argparse.ArgumentParser(prog="python -m cohaul.demo", description=__doc__)
    parser.add_argument("scenarios", nargs="+", help="scenario files")
    parser.add_argument("--out", default="out/demo", help="folder for logs and pages")
    options = parser.parse_args(arguments)

    outcomes = [cohaul.run(path, out=options.out) for path in options.scenarios]
    rows = [_COLUMNS, *map(_row, outcomes)]
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    for mission, outcome, *numbers in rows:
        right = (cell.rjust(width) for cell, width in zip(numbers, widths[2:], strict=True))
        print("  ".join([mission.ljust(widths[0]), outcome.ljust(widths[1]), *right]))
    print("\nOpen in a browser to watch them:")
    for result in outcomes:
        print(f"  {result.page}")
    return 0 if all(result.success for result in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
