"""Two logs side by side. Sets of trials are tested in Rust, where they are made (tests/it/compare.rs)."""

import json
import math
import subprocess
import sys
from pathlib import Path

import cohaul
import pytest

FLAT = Path(__file__).resolve().parents[2] / "scenarios/r2p2/flat.yaml"
SHORT = {"teams__0__mission__time_limit": 20.0}
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Short missions in either world, and again with another seed."""
    folder = tmp_path_factory.mktemp("compare")
    worlds = {"planar": {}, "spatial": {}, "other": {"seed": 9}}
    for name, changes in worlds.items():
        world = "spatial" if name == "spatial" else "planar"
        outcome = cohaul.run(FLAT, out=folder, world=world, name=name, **changes, **SHORT)
        assert outcome.log == folder / f"{name}.mcap"
    return folder


def test_two_worlds_are_compared(logs, tmp_path):
    a, b = logs / "planar.mcap", logs / "spatial.mcap"
    found = cohaul.compare(a, b, out=tmp_path / "pictures")
    assert found["kind"] == "logs"
    assert (found["a"]["world"], found["b"]["world"]) == ("planar", "spatial")
    assert found["a"]["outcome"] == "timed_out" and found["time_ratio"] == pytest.approx(1.0)
    (way,) = found["loads"]
    assert way["load"] == "load"
    assert 0.0 < way["rms_distance_m"] <= way["max_distance_m"] < 1.0
    assert -math.pi < way["final_yaw_difference_rad"] <= math.pi
    svg, png = Path(found["svg"]), Path(found["png"])
    assert svg == tmp_path / "pictures" / "planar-vs-spatial.svg"
    assert svg.read_text(encoding="utf-8").startswith("<svg")
    assert png.read_bytes().startswith(PNG)


def test_the_numbers_are_those_of_the_traces(logs):
    a = cohaul.run(FLAT, world="planar", name="planar", **SHORT).traces.load_pose[:, 0]
    b = cohaul.run(FLAT, world="planar", name="other", seed=9, **SHORT).traces.load_pose[:, 0]
    found = cohaul.compare(logs / "planar.mcap", logs / "other.mcap")
    (way,) = found["loads"]
    assert way["final_distance_m"] == pytest.approx(math.dist(a[-1, :2], b[-1, :2]), abs=1e-12)
    assert way["final_yaw_difference_rad"] == pytest.approx(b[-1, 2] - a[-1, 2], abs=1e-12)
    length = sum(math.dist(p, q) for p, q in zip(a[:-1, :2], a[1:, :2], strict=True))
    assert way["path_length_a_m"] == pytest.approx(length, rel=1e-9)
    assert found["svg"] is None and found["png"] is None


def test_a_log_equals_itself(logs):
    found = cohaul.compare(logs / "planar.mcap", logs / "planar.mcap")
    (way,) = found["loads"]
    assert way["rms_distance_m"] == way["rms_yaw_difference_rad"] == 0.0 and found["time_ratio"] == 1.0


def test_python_gives_what_the_command_prints(logs, tmp_path):
    a, b = logs / "planar.mcap", logs / "other.mcap"
    arguments = [sys.executable, "-m", "cohaul", "compare", a, b, "--out", tmp_path, "--json"]
    done = subprocess.run(arguments, check=True, capture_output=True, text=True)
    assert json.loads(done.stdout) == cohaul.compare(a, b, out=tmp_path)


def test_what_does_not_fit_is_refused(logs, tmp_path):
    log = logs / "planar.mcap"
    with pytest.raises(cohaul.CompareError, match="one is a log and the other is not"):
        cohaul.compare(log, tmp_path)
    with pytest.raises(cohaul.CompareError, match="fields are those of trials"):
        cohaul.compare(log, log, fields=["time_s"])
    with pytest.raises(cohaul.MissingFileError):
        cohaul.compare(log, tmp_path / "missing.mcap")
    with pytest.raises(cohaul.MissingFileError):
        cohaul.compare(tmp_path, tmp_path)
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(log.read_bytes()[:-100])
    with pytest.raises(cohaul.RecordError):
        cohaul.compare(log, damaged)
    table = tmp_path / "trials.parquet"
    table.write_bytes(b"no table")
    with pytest.raises(cohaul.FileError, match="table of trials"):
        cohaul.compare(table, table)
