"""`cohaul reproduce` as its users run it."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import cohaul
import pandas
import pytest
from conftest import command


def reproduce(*arguments: str | Path, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command("reproduce", *arguments, "--out", folder), capture_output=True, text=True)


def test_a_table_is_printed_and_written_beside_the_papers(tmp_path: Path) -> None:
    done = reproduce("r2p2-tight", "--trials", "2", "--seed", "701", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "bearing_deg" in done.stdout and "paper: outcome" in done.stdout
    folder = tmp_path / "r2p2-tight-planar"
    assert (folder / "report.md").read_text() in done.stdout
    table = pandas.read_parquet(folder / "trials.parquet")
    assert len(table) == 30 and set(table["seed"]) == {701, 702}
    assert set(table["terrain"]) == {"flat", "downhill", "uphill"} and table["success"].all()
    for ending in ("png", "svg"):
        assert (folder / f"r2p2-tight.{ending}").stat().st_size > 5000


def test_json_has_the_promised_names_and_nothing_else(tmp_path: Path) -> None:
    done = reproduce("r2p2-hardware", "--trials", "2", "--world", "spatial", "--json", folder=tmp_path)
    assert done.returncode == 0 and done.stderr == ""
    found = json.loads(done.stdout)
    assert found["name"] == "r2p2-hardware" and found["world"] == "spatial" and found["trials"] == 2
    assert found["seed"] == 1 and found["wall_s"] > 0
    (cell,) = found["cells"]
    assert cell["n"] == 2 and cell["reached"] == 2 and cell["outcomes"] == {"reached": 2}
    assert cell["wilson"][0] < 1 and cell["min_distance_m"]["mean"] > 0.2


def test_an_interrupted_experiment_keeps_what_it_has_and_goes_on(tmp_path: Path) -> None:
    arguments = command("reproduce", "r2p2-generalize", "--trials", "40", "--jobs", "1", "--out", tmp_path)
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, text=True)
    lines = tmp_path / "r2p2-generalize-planar" / "trials.jsonl"
    while not (lines.exists() and lines.read_bytes().count(b"\n") > 20):
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130 and "goes on from here" in output
    before = lines.read_bytes()
    kept = before.count(b"\n") - 1
    assert 20 <= kept < 27 * 40
    done = reproduce("r2p2-generalize", "--trials", "2", folder=tmp_path)
    assert done.returncode == 0 and "54 trials" in done.stdout
    assert lines.read_bytes().startswith(before)


def test_wrong_names_and_foreign_folders_are_refused(tmp_path: Path) -> None:
    unknown = reproduce("r2p2-nonsense", folder=tmp_path)
    assert unknown.returncode == 2 and "r2p2-generalize" in unknown.stderr
    assert reproduce("r2p2-ten", "--trials", "0", folder=tmp_path).returncode == 2
    bad = reproduce("r2p2-ten", "--trials", "1", "--set", "loads.0.mass=-1", folder=tmp_path)
    assert bad.returncode == 3 and "loads.0.mass=-1" in bad.stderr
    assert reproduce("r2p2-hardware", "--trials", "1", folder=tmp_path).returncode == 0
    other = reproduce("r2p2-hardware", "--trials", "1", "--set", "loads.0.mass=1.3", folder=tmp_path)
    assert other.returncode == 3 and "--out" in other.stderr


def test_the_list_names_every_experiment() -> None:
    listed = subprocess.run(command("reproduce", "--list"), capture_output=True, text=True)
    assert listed.returncode == 0 and "r2p2-taguchi (486 cells × 5 trials)" in listed.stdout


def test_python_runs_the_same_experiments(tmp_path: Path) -> None:
    assert "r2p2-taguchi" in cohaul.experiments()
    found = cohaul.reproduce("r2p2-tight", trials=1, seed=701, out=tmp_path, set={"loads.0.mass": 0.06})
    assert len(found["cells"]) == 15 and all(cell["reached"] == 1 for cell in found["cells"])
    assert found["folder"] == tmp_path / "r2p2-tight-planar" and (found["folder"] / "report.md").exists()
    with pytest.raises(cohaul.ExperimentError, match="r2p2-generalize"):
        cohaul.reproduce("r2p2-nonsense", out=tmp_path)
    with pytest.raises(cohaul.ExperimentError, match="--out"):
        cohaul.reproduce("r2p2-tight", trials=1, out=tmp_path)
    with pytest.raises(cohaul.ScenarioError, match="world"):
        cohaul.reproduce("r2p2-tight", trials=1, out=tmp_path, world="flat")


def test_ctrl_c_in_python_is_a_keyboard_interrupt(tmp_path: Path) -> None:
    """The runner asks again and again whether it was interrupted, and once forgot that it had been."""
    program = f"import cohaul; cohaul.reproduce('r2p2-generalize', trials=400, jobs=1, out={str(tmp_path)!r})"
    process = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True)
    lines = tmp_path / "r2p2-generalize-planar" / "trials.jsonl"
    while not (lines.exists() and lines.read_bytes().count(b"\n") > 20):
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, complaint = process.communicate(timeout=60)
    assert process.returncode != 0 and "KeyboardInterrupt" in complaint


def test_the_report_tells_what_was_set(tmp_path: Path) -> None:
    found = cohaul.reproduce("r2p2-hardware", trials=1, out=tmp_path, set={"loads.0.mass": 1.3})
    assert "--set 'loads.0.mass=1.3'" in (found["folder"] / "report.md").read_text()
    assert found["set"] == ["loads.0.mass=1.3"]
