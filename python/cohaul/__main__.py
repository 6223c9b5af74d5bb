"""The `cohaul` command: the same as the Rust binary."""

from __future__ import annotations

import sys

from cohaul import _cohaul

INTERRUPTED = 130


def main() -> int:
    """Run the command line of this process and return its exit status."""
    try:
        return _cohaul.cli_main(["cohaul", *sys.argv[1:]])
    except KeyboardInterrupt:
        return INTERRUPTED


if __name__ == "__main__":
    sys.exit(main())
