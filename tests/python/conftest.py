"""One real mission, run by the installed command, for all tests that look at what it writes."""

import json
import math
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from example_log import ROOT


# a shell that starts the tests in the background has them ignore Ctrl-C, and what they start too
signal.signal(signal.SIGINT, signal.default_int_handler)


def command(*arguments: str | Path) -> list[str]:
    """The command line of the installed `cohaul`."""
    return [sys.executable, "-m", "cohaul", *map(str, arguments)]


@pytest.fixture(scope="session")
def mission(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What `cohaul run --json` says of the uphill mission."""
    out = tmp_path_factory.mktemp("mission")
    scenario = ROOT / "scenarios" / "r2p2" / "uphill.yaml"
    done = subprocess.run(command("run", scenario, "--out", out, "--json"), check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


@pytest.fixture(scope="session")
def mission_page(mission: dict[str, Any]) -> Path:
    """Its replay page."""
    return Path(mission["page"])


@pytest.fixture(scope="session")
def mission_final_pose(mission: dict[str, Any]) -> tuple[float, float, float]:
    """The last pose (x, y, yaw) of its load in the log, m and rad."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with Path(mission["log"]).open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        *_, last = reader.iter_decoded_messages(topics=["/loads/load/pose"])
    pose = last.decoded_message.pose
    yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
    return pose.position.x, pose.position.y, yaw
