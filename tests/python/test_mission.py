"""The command as a user runs it: what it writes, what it says, how it ends, what survives when it is killed."""

import json
import os
import random
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from conftest import command
from example_log import ROOT
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

FLAT = ROOT / "scenarios" / "r2p2" / "flat.yaml"

# names of the `--json` output that users may rely on
RUN_KEYS = set(
    "outcome success time_s final_error_m final_yaw_error_rad waypoints_reached repositions reposition_time_s "
    "min_robot_distance_m min_clearance_m path_length_m path_deviation_rms_m path_deviation_max_m control_effort "
    "energy_j caging_violation_s penalty_s seed world log page cpu_s wall_s real_time_factor".split()
)

# more than a million records, if it were left alone: 1,600 s towards a goal out of reach
LONG = ["--set", "teams.0.mission={goal: {x: 400, y: 0}, time_limit: 1600}"]


def cohaul(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the command to its end."""
    return subprocess.run(command(*arguments), capture_output=True, text=True)


def test_json_has_every_promised_name(mission: dict[str, Any]) -> None:
    assert mission.keys() >= RUN_KEYS
    assert mission["outcome"] == "reached" and mission["success"] is True


def test_third_party_readers_decode_every_topic(mission: dict[str, Any]) -> None:
    log = Path(mission["log"])
    counts: dict[str, int] = {}
    with log.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for _, channel, _, decoded in reader.iter_decoded_messages():
            assert decoded is not None
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
    assert sum(counts.values()) == mission["records"]
    assert {"/tf", "/cohaul/markers", "/cohaul/outcome", "/loads/load/pose"} <= counts.keys()
    per_robot = {f"/r{i}/{name}" for i in range(1, 7) for name in ("observation", "decision", "cmd_vel", "pose")}
    assert per_robot <= counts.keys()

    seen: dict[str, int] = {}
    with AnyReader([log]) as bag:
        for connection, _, raw in bag.messages():
            assert bag.deserialize(raw, connection.msgtype) is not None
            seen[connection.topic] = seen.get(connection.topic, 0) + 1
    assert seen == counts


def test_replay_finds_every_decision_equal(mission: dict[str, Any]) -> None:
    done = cohaul("replay", mission["log"], "--json")
    found = json.loads(done.stdout)
    assert done.returncode == 0 and found["different"] == 0 and found["decisions"] > 1000


def test_same_seed_same_bytes(tmp_path: Path) -> None:
    logs = []
    for name in ("a", "b"):
        out = tmp_path / name
        assert cohaul("run", FLAT, "--seed", "7", "--out", out).returncode == 0
        logs.append((out / "flat.mcap").read_bytes())
    assert logs[0] == logs[1]


def test_exit_status_tells_what_happened(tmp_path: Path) -> None:
    short = ["--set", "teams.0.mission.time_limit=1", "--out", tmp_path]
    assert cohaul("run", FLAT, *short).returncode == 1
    assert cohaul("fly").returncode == 2
    assert cohaul("run", FLAT, "--set", "loads.0.mass=-1").returncode == 3
    assert cohaul("run", tmp_path / "none.yaml").returncode == 3
    assert cohaul("replay", FLAT).returncode == 3


@pytest.mark.parametrize("path", sorted((ROOT / "tests" / "bad").glob("*.yaml")), ids=lambda path: path.stem)
def test_bad_files_exit_3_with_place_and_remedy(path: Path) -> None:
    done = cohaul("check", path, "--json")
    error = json.loads(done.stdout)["error"]
    assert done.returncode == 3
    assert error["file"] == str(path) and error["line"] >= 1 and error["column"] >= 1
    assert error["message"] and error["remedy"]


def test_ctrl_c_keeps_a_finished_log(tmp_path: Path) -> None:
    process = subprocess.Popen(command("run", FLAT, *LONG, "--out", tmp_path), stdout=subprocess.DEVNULL)
    log = tmp_path / "flat.mcap"
    wait_for_size(log, 200_000)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=30) == 130
    assert cohaul("replay", log).returncode == 0
    assert (tmp_path / "flat.html").exists()


def wait_for_size(path: Path, size: int) -> None:
    """Waits until a file has grown to `size` bytes."""
    end = time.monotonic() + 30.0
    while not (path.exists() and path.stat().st_size >= size):
        assert time.monotonic() < end
        time.sleep(0.002)


@pytest.fixture(scope="module")
def long_log(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[int, bytes]]:
    """Time and bytes of every message of the whole long mission."""
    out = tmp_path_factory.mktemp("long")
    assert cohaul("run", FLAT, *LONG, "--out", out).returncode == 1
    records = messages(out / "flat.mcap")
    (out / "flat.mcap").unlink()
    assert len(records) >= 1_000_000
    return records


def messages(log: Path) -> list[tuple[int, bytes]]:
    """Time and bytes of every message, in the order of the file."""
    with log.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        return [(message.log_time, message.data) for *_, message in reader.iter_messages(log_time_order=False)]


# set COHAUL_KILLS=50 for the long version
@pytest.mark.parametrize("seed", range(int(os.environ.get("COHAUL_KILLS", "4"))))
def test_what_a_killed_mission_leaves_is_the_start_of_the_whole(
    tmp_path: Path, long_log: list[tuple[int, bytes]], seed: int
) -> None:
    log, saved = tmp_path / "flat.mcap", tmp_path / "saved.mcap"
    process = subprocess.Popen(command("run", FLAT, *LONG, "--out", tmp_path), stdout=subprocess.DEVNULL)
    wait_for_size(log, random.Random(seed).randrange(10_000, 60_000_000))
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    done = cohaul("recover", log, "--out", saved, "--json")
    report = json.loads(done.stdout)
    assert done.returncode == 0 and report["missing"] == 0 and report["reason"]
    recovered = messages(saved)
    assert len(recovered) == report["messages"] > 0
    assert recovered == long_log[: len(recovered)]
    # nothing but the chunk under way is lost: at most 64 messages, the file's bytes up to there are all whole chunks
    assert report["skipped_bytes"] < 64 * 4096
    with AnyReader([saved]) as bag:
        assert bag.message_count == len(recovered)
    log.unlink()
    saved.unlink()


@pytest.mark.parametrize("seed", range(25))
def test_flipped_bits_give_an_error_never_an_abort(mission: dict[str, Any], tmp_path: Path, seed: int) -> None:
    content = bytearray(Path(mission["log"]).read_bytes())
    draw = random.Random(seed)
    # half of them near the front, where lengths and definitions are
    place = draw.randrange(400 if seed % 2 else len(content))
    content[place] ^= 1 << draw.randrange(8)
    log = tmp_path / "flipped.mcap"
    log.write_bytes(content)
    replayed = cohaul("replay", log)
    assert replayed.returncode in (1, 3), (place, replayed.stdout, replayed.stderr)
    assert replayed.stderr.startswith("error: ")
    assert cohaul("recover", log, "--out", tmp_path / "saved.mcap").returncode in (0, 1, 3)
