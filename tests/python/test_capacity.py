"""What a team can move: the command and the package say the same."""

import json
import subprocess

import cohaul
import pytest
from conftest import command
from example_log import ROOT

FLAT = ROOT / "scenarios" / "r2p2" / "flat.yaml"
# the paper's case: 15 kg on flat ground, two robots push with 17.66 N, enough for 18.0 kg
PAPER = {"loads.0.mass": 15.0, "terrain.friction.dynamic": 0.1}
SETS = [argument for key, value in PAPER.items() for argument in ("--set", f"{key}={value}")]
KEYS = {"feasible", "margin", "max_mass_kg", "max_slope_deg", "min_robots", "explanation", "limit", "teams"}


def run(*arguments):
    """Runs `cohaul capacity` to its end."""
    return subprocess.run(command("capacity", *arguments), capture_output=True, text=True)


def test_the_papers_15_kg_are_feasible():
    capacity = cohaul.capacity(FLAT, set=PAPER)
    assert capacity.feasible
    assert 17.9 <= capacity.max_mass_kg <= 18.0
    assert capacity.margin == pytest.approx(capacity.max_mass_kg / 15.0)
    assert capacity.teams[0].team == "team" and capacity.teams[0].limit["demand"] == "translate"
    assert "largest mass" in str(capacity)


def test_command_and_package_agree():
    done = run(FLAT, *SETS, "--json")
    assert done.returncode == 0, done.stderr
    numbers = json.loads(done.stdout)
    assert numbers.keys() >= KEYS
    capacity = cohaul.capacity(FLAT, set=PAPER)
    for name in ("feasible", "margin", "max_mass_kg", "max_slope_deg", "min_robots", "explanation"):
        assert numbers[name] == getattr(capacity, name), name


def test_exit_status_tells_feasible_from_not_and_from_bad_files(tmp_path):
    assert run(FLAT, *SETS).returncode == 0
    heavy = run(FLAT, "--set", "loads.0.mass=19", "--set", "terrain.friction.dynamic=0.1")
    assert heavy.returncode == 1
    assert "translate on leg 1 binds" in heavy.stdout
    bad = tmp_path / "bad.yaml"
    bad.write_text("format: cohaul/1\n")
    assert run(bad).returncode == 3
    assert run(FLAT, "--without", "7").returncode == 3


def test_a_team_without_a_robot_forms_anew_or_says_why_not():
    left = cohaul.capacity(FLAT, without=[3])
    assert left.feasible and left.teams[0].robots == 5
    done = run(FLAT, "--without", "3", "--without", "6", "--set", "loads.0.mass=60", "--set", "terrain.friction.dynamic=0.1")
    assert done.returncode == 1
    assert "4 robots" in done.stdout and "binds" in done.stdout
    few = run(FLAT, *(argument for robot in "1234" for argument in ("--without", robot)))
    assert few.returncode == 1
    assert "has 2 robots left, a formation needs at least 3" in few.stderr
    with pytest.raises(cohaul.PlanError, match="at least 3"):
        cohaul.capacity(FLAT, without=[1, 2, 3, 4])


def test_slots_that_do_not_fit_are_refused():
    crowd = {"teams.0.robots.count": 12, "teams.0.formation": {"slots": "auto"}}
    small = {"loads.0.shape.rectangle": {"length": 0.5, "width": 0.5}}
    with pytest.raises(cohaul.PlanError, match="12 robots do not fit"):
        cohaul.run(FLAT, set={**crowd, **small})
