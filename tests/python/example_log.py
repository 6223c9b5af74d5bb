"""The example programs of cohaul-core that write and recover logs."""

import os
import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@cache
def example(name: str) -> Path:
    """Path of an example program, built if need be."""
    # the whole workspace: a package alone would be compiled with other features of its dependencies
    build = ["cargo", "build", "--quiet", "--release", "--workspace", "--example", name]
    subprocess.run(build, cwd=ROOT, check=True)
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "examples" / name


def write_log(path: Path, *, ticks: int) -> int:
    """Writes a log of `ticks` control ticks; gives the number of its messages."""
    done = subprocess.run([example("write_log"), path, str(ticks)], check=True, capture_output=True, text=True)
    return int(done.stdout)


def recover_log(source: Path, target: Path) -> dict[str, str]:
    """Recovers `source` into `target`; gives what the program reports."""
    done = subprocess.run([example("recover_log"), source, target], check=True, capture_output=True, text=True)
    return dict(line.split(maxsplit=1) for line in done.stdout.splitlines())
