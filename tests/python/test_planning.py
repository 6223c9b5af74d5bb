"""Plans for many agents, from Python and through the installed command."""

import csv
import json
import math
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import cohaul
import numpy as np
import pytest
import yaml
from example_log import ROOT
from numpy.testing import assert_allclose, assert_array_equal

SCRIPT = Path(sys.executable).with_name("cohaul")
# instances of other projects, which do not ship with this one
BENCH = ROOT.parent / "shared" / "bench"
needs_bench = pytest.mark.skipif(not BENCH.is_dir(), reason=f"the instances of other projects are not in {BENCH}")
KINDS = ["grid", "grid-all", "grid-window", "car", "car-all", "car-window", "forward-car", "differential"]
SMALL = {"grid": {"agents": 6, "size": 12}, "car": {"agents": 5, "size": 50, "obstacles": 10}}

GRID = """
agents:
- {name: ann, start: [0, 0], goal: [2, 0]}
- {name: bob, start: [0, 1], goal: [2, 1]}
map: {dimensions: [3, 2], obstacles: []}
"""
# body 3 by 2, obstacles keep 0.8 from it
CARS = """
agents:
- {name: ann, start: [10, 10, 0], goal: [30, 10, 0]}
- {name: bob, start: [10, 30, 0], goal: [30, 30, 0]}
map: {dimensions: [50, 50], obstacles: [[45, 45]]}
"""


def small(kind, seed=1):
    shape = SMALL["grid" if kind.startswith("grid") else "car"]
    return cohaul.generate(kind, seed=seed, **shape)


def run(*arguments):
    return subprocess.run([SCRIPT, *map(str, arguments)], capture_output=True, text=True)


def answer(*arguments, status=0):
    """What a command prints with --json, and nothing else."""
    done = run(*arguments, "--json")
    assert done.returncode == status, done.stdout + done.stderr
    assert done.stderr == ""
    return json.loads(done.stdout)


@pytest.fixture
def written(tmp_path):
    """Writes a text into a file."""

    def write(text, name="instance.yaml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


# from Python


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_planned_and_certified(kind):
    text = small(kind)
    assert text == small(kind) != small(kind, seed=2)
    instance = yaml.safe_load(text)
    plan = cohaul.plan(text)
    assert plan.status == "solved" and plan.solved and plan.reason is None and plan.reasons == ()
    assert cohaul.certify(plan) == [] and cohaul.certify(plan, text) == []
    assert list(plan.routes) == [agent["name"] for agent in instance["agents"]] == list(plan.goals)
    assert plan.cost >= plan.lower_bound > 0 and plan.flowtime >= plan.makespan > 0
    grid = kind.startswith("grid")
    for agent in instance["agents"]:
        states = plan.routes[agent["name"]]
        goals = agent.get("potentialGoals", [agent.get("goal")])
        assert states.dtype == (np.int64 if grid else np.float64) and states.shape[1] == (2 if grid else 3)
        assert states.flags.c_contiguous and not states.flags.writeable
        start, goal = np.array(agent["start"]), np.array(goals[plan.goals[agent["name"]]])
        if not grid:
            # the file's yaws turn clockwise, ours counter-clockwise
            start, goal = start * [1, 1, -1], goal * [1, 1, -1]
        assert_allclose(states[[0, -1]], [start, goal], rtol=0, atol=1e-9)
    taken = [tuple(states[-1]) for states in plan.routes.values()]
    assert len(set(taken)) == len(taken)


def test_a_known_plan():
    plan = cohaul.plan(GRID, planner="cbs")
    assert (plan.cost, plan.lower_bound, plan.makespan, plan.flowtime, plan.planner) == (4, 4, 2, 4, "cbs")
    assert_array_equal(plan.routes["bob"], [[0, 1], [1, 1], [2, 1]])
    assert plan.goals == {"ann": 0, "bob": 0}
    assert repr(plan) == "<Plan of instance, 2 agents: solved, cost 4>"
    assert "makespan      2" in str(plan)
    assert plan == cohaul.plan(GRID, planner="cbs") != cohaul.plan(GRID, planner="ecbs")
    assert plan.to_dict()["cost"] == 4 and "routes" not in plan.to_dict()


def test_arguments_reach_the_planner():
    cars = small("car")
    assert cohaul.plan(cars, agents=2).agents == 2
    assert cohaul.plan(cars, bound=3.0).bound == 3.0
    exact = cohaul.plan(cars, model="exact")
    assert cohaul.certify(exact, model="exact") == []
    assert cohaul.certify(cohaul.plan(cars, batch=1)) == []
    assert cohaul.certify(cohaul.plan(small("car-all"), metric="manhattan")) == []
    assert cohaul.plan(cohaul.generate("grid", agents=60, seed=3), timeout=0).status == "budget_spent"


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"planner": "astar"}, "'ecbs-ta'"),
        ({"planner": "cl-cbs"}, "use ecbs"),
        ({"bound": 0.9}, "at least 1"),
        ({"bound": math.nan}, "at least 1"),
        ({"model": "box"}, "'exact'"),
        ({"metric": "miles"}, "'manhattan'"),
        ({"starts": "any"}, "'free'"),
        ({"batch": 0}, "at least 1"),
        ({"timeout": -1}, "negative"),
    ],
)
def test_arguments_that_make_no_sense_are_refused(arguments, complaint):
    with pytest.raises(cohaul.PlanError, match=complaint):
        cohaul.plan(GRID, **arguments)


def test_bad_instances_name_their_place(tmp_path):
    with pytest.raises(cohaul.InstanceError) as caught:
        cohaul.plan("agents: []\nmop: {}\n")
    assert isinstance(caught.value, ValueError) and caught.value.file == "instance" and caught.value.line == 2
    with pytest.raises(cohaul.MissingFileError):
        cohaul.plan(tmp_path / "none.yaml")
    with pytest.raises(cohaul.PlanError, match="grid-all"):
        cohaul.generate("hexagons")
    with pytest.raises(cohaul.PlanError, match="room"):
        cohaul.generate("grid", agents=60, size=8)


def test_plans_are_saved_drawn_and_shown(tmp_path):
    plan = cohaul.plan(small("car"))
    path = plan.save(tmp_path / "made" / "plan.yaml")
    assert cohaul.certify(path, small("car")) == [] == cohaul.certify(path.read_text(), small("car"))
    page = plan.page(tmp_path / "plan.html")
    assert page.read_text().startswith("<!doctype html>") and plan.picture().startswith("<svg")
    assert "srcdoc" in plan._repr_html_()
    none = cohaul.plan(GRID.replace("goal: [2, 0]", "goal: [2, 1]"))
    assert none._repr_html_() is None and none.routes == {} == none.goals
    with pytest.raises(cohaul.PlanError, match="infeasible"):
        none.save(tmp_path / "none.yaml")


def test_certificates_tell_who_when_and_what():
    moved = cohaul.plan(GRID, planner="cbs")
    text = moved._planned.text()
    crossed = text.replace("bob", "eve").replace("ann", "bob").replace("eve", "ann")
    found = cohaul.certify(crossed, GRID)
    assert found and {violation.kind for violation in found} >= {"start"}
    other = GRID.replace("obstacles: []", "obstacles: [[1, 1]]")
    (blocked,) = [v for v in cohaul.certify(moved, other) if v.kind == "obstacle"]
    assert (blocked.time, blocked.agents) == (1.0, ("bob",)) and "1" in blocked.detail
    with pytest.raises(cohaul.InstanceError):
        cohaul.certify(moved, CARS)
    with pytest.raises(cohaul.PlanError, match="instance"):
        cohaul.certify(text)
    with pytest.raises(cohaul.PlanError, match="no plan"):
        cohaul.certify(cohaul.plan(GRID, timeout=0))


@pytest.mark.parametrize(
    "instance, change, kind, agents",
    [
        (GRID, ("goal: [2, 0]", "goal: [7, 0]"), "goal_outside", ("ann",)),
        (GRID, ("obstacles: []", "obstacles: [[2, 1]]"), "goal_blocked", ("bob",)),
        (GRID, ("obstacles: []", "obstacles: [[0, 0]]"), "start_blocked", ("ann",)),
        (GRID, ("obstacles: []", "obstacles: [[1, 0], [1, 1]]"), "unreachable", ("ann",)),
        (GRID, ("goal: [2, 0]", "goal: [2, 1]"), "goals_collide", ("ann", "bob")),
        (GRID, ("start: [0, 0]", "start: [0, 1]"), "starts_collide", ("ann", "bob")),
        (CARS, ("[[45, 45]]", "[[10.5, 31.7]]"), "start_blocked", ("bob",)),
        (CARS, ("[[45, 45]]", "[[32.7, 10]]"), "goal_blocked", ("ann",)),
        (CARS, ("goal: [30, 30, 0]", "goal: [30, 13, 0]"), "goals_collide", ("ann", "bob")),
        (CARS, ("goal: [30, 30, 0]", "goal: [30, 51, 0]"), "goal_outside", ("bob",)),
    ],
)
def test_infeasible_instances_blame_agents_by_name(instance, change, kind, agents):
    assert change[0] in instance
    plan = cohaul.plan(instance.replace(*change))
    assert plan.status == "infeasible" and plan.cost is None
    assert (kind, agents) in [(reason.kind, reason.agents) for reason in plan.reasons]
    assert all(f"`{name}`" in plan.reason for name in agents)


def test_starts_inside_obstacles_are_a_rule_to_choose():
    text = CARS.replace("[[45, 45]]", "[[10.5, 31.7]]")
    assert cohaul.plan(text).status == "infeasible"
    free = cohaul.plan(text, starts="free")
    assert free.solved and cohaul.certify(free) == [] == cohaul.certify(free, text, starts="free")
    assert [v.kind for v in cohaul.certify(free, text)] == ["obstacle"]


# more agents than a search for the best plan can manage
HARD = {"kind": "grid", "agents": 200, "size": 32, "obstacles": 200}


def test_other_threads_go_on_meanwhile():
    text = cohaul.generate(**HARD)
    done = threading.Event()
    thread = threading.Thread(target=lambda: (cohaul.plan(text, planner="cbs", timeout=1.0), done.set()))
    thread.start()
    count = 0
    while not done.wait(0.01):
        count += 1
    thread.join()
    assert count > 10


@pytest.mark.parametrize("command", [False, True])
def test_ctrl_c_ends_a_search(command, written):
    path = written(cohaul.generate(**HARD))
    program = f"import cohaul; cohaul.plan({str(path)!r}, planner='cbs', timeout=600)"
    arguments = [sys.executable, "-c", program]
    if command:
        arguments = [SCRIPT, "plan", path, "--planner", "cbs", "--timeout", "600"]
    process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    began = time.monotonic()
    _, complaint = process.communicate(timeout=60)
    assert time.monotonic() - began < 5  # other programs run too
    if command:
        assert process.returncode == 130
    else:
        assert process.returncode != 0 and "KeyboardInterrupt" in complaint


# the samples of the repository

SAMPLES = sorted((ROOT / "scenarios/planner").glob("*.yaml"))


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_samples_say_what_they_are_and_can_be_solved(path):
    assert path.read_text().startswith("# ") and f"cohaul plan scenarios/planner/{path.name}" in path.read_text()
    for model in ("clcbs", "exact"):
        plan = cohaul.plan(path, model=model)
        assert plan.solved and cohaul.certify(plan, model=model) == []


def test_the_picture_of_the_readme_is_the_commands(tmp_path):
    picture = tmp_path / "cars.svg"
    answer("plan", SAMPLES[[path.stem for path in SAMPLES].index("cars")], "--model", "exact", "--picture", picture)
    assert picture.read_text() == (ROOT / "scenarios/planner/cars.svg").read_text()


# through the command


@pytest.mark.parametrize("kind", [*KINDS, "movingai"])
def test_the_commands_work_together(kind, tmp_path):
    shape = SMALL["car" if "car" in kind or kind == "differential" else "grid"]
    options = [str(text) for key, value in shape.items() for text in (f"--{key}", value)]
    made = answer("generate", kind, *options, "--count", 2, "--seed", 5, "--out", tmp_path)
    instances = [Path(path) for path in made["files"] if not path.endswith(".map")]
    assert len(instances) == 2 and (made["seed"], made["count"]) == (5, 2)
    plan, page, picture = tmp_path / "plan.yaml", tmp_path / "plan.html", tmp_path / "plan.svg"
    for path in instances:
        found = answer("plan", path, "--out", plan, "--page", page, "--picture", picture)
        promised = "status reason planner cost lower_bound makespan flowtime runtime_s cpu_s high_level_expanded"
        assert set(f"{promised} low_level_expanded plan".split()) <= set(found)
        assert found["status"] == "solved" and found["agents"] == shape["agents"] and found["reasons"] == []
        assert found["plan"] == str(plan) and found["page"] == str(page) and found["picture"] == str(picture)
        assert 0 <= found["runtime_s"] <= found["cpu_s"]
        assert answer("certify", plan, "--instance", path) == {"ok": True, "violations": []}
        # the layout of libMultiRobotPlanning, for any reader of YAML
        file = yaml.safe_load(plan.read_text())
        assert file["statistics"]["cost"] == found["cost"] and file["statistics"]["makespan"] == found["makespan"]
        assert len(file["schedule"]) == shape["agents"]
        states = cohaul.plan(path).routes
        for name, rows in file["schedule"].items():
            assert [row["t"] for row in rows] == list(range(len(rows)))
            columns = {2: ["x", "y"], 3: ["x", "y", "yaw"]}[states[name].shape[1]]
            assert set(rows[0]) == {*columns, "t"}
            # the same numbers bit for bit, and yaws that turn as in the file
            turned = states[name] * np.array([1, 1, -1])[: len(columns)]
            assert_array_equal([[row[column] for column in columns] for row in rows], turned)
        assert "<!doctype html>" in page.read_text() and picture.read_text().startswith("<svg")


def test_people_are_told_in_rows(written, tmp_path):
    path = written(GRID)
    done = run("plan", path, "--out", tmp_path / "plan.yaml")
    assert done.returncode == 0 and "status        solved" in done.stdout and "cost          4" in done.stdout
    done = run("certify", tmp_path / "plan.yaml", "--instance", path)
    assert done.returncode == 0 and done.stdout.endswith("plan.yaml: ok\n")


def test_exit_statuses_tell_what_happened(written, tmp_path):
    path, plan = written(GRID), tmp_path / "plan.yaml"
    assert answer("plan", path, "--out", plan)["status"] == "solved"
    # 1: it ran, and failed
    infeasible = written(GRID.replace("goal: [2, 0]", "goal: [2, 1]"), "infeasible.yaml")
    found = answer("plan", infeasible, "--out", tmp_path / "none.yaml", status=1)
    assert found["status"] == "infeasible" and found["plan"] is None and not (tmp_path / "none.yaml").exists()
    assert found["reasons"][0]["agents"] == ["ann", "bob"] and "`ann`" in found["reason"]
    hard = written(cohaul.generate(**HARD), "hard.yaml")
    found = answer("plan", hard, "--planner", "cbs", "--timeout", "0.1", status=1)
    assert found["status"] == "budget_spent" and found["lower_bound"] >= 0 and "0.1 s" in found["reason"]
    found = answer("certify", plan, "--instance", infeasible, status=1)
    assert not found["ok"] and set(found["violations"][0]) == {"kind", "time", "agents", "detail"}
    # 2: the command line makes no sense
    for arguments in (
        ["plan"],
        ["plan", path, "--planner", "astar"],
        ["plan", path, "--planner", "cl-cbs"],
        ["plan", path, "--bound", "0.5"],
        ["certify", plan],
        ["generate", "hexagons"],
        ["generate", "grid", "--agents", "0", "--out", tmp_path],
    ):
        assert run(*arguments).returncode == 2, arguments
    # 3: a bad file, with its place
    bad = written("agents:\n- {name: a, start: [0]}\nmap: {dimensions: [3, 2]}\n", "bad.yaml")
    error = answer("plan", bad, status=3)["error"]
    assert error["file"] == str(bad) and error["line"] == 2 and error["column"] and error["message"] and error["remedy"]
    assert run("plan", tmp_path / "missing.yaml").returncode == 3
    assert run("certify", path, "--instance", path).returncode == 3
    assert "bad.yaml:2:" in run("plan", bad).stderr


def test_movingai_scenarios_bring_their_map(tmp_path):
    answer("generate", "movingai", "--agents", 20, "--size", 16, "--out", tmp_path)
    (scenario,) = tmp_path.glob("*.scen")
    (grid_map,) = tmp_path.glob("*.map")
    plan = cohaul.plan(scenario, agents=12)
    assert plan.agents == 12 and cohaul.certify(plan, scenario, agents=12) == []
    elsewhere = grid_map.rename(tmp_path / "elsewhere.map")
    with pytest.raises(cohaul.MissingFileError):
        cohaul.plan(scenario)
    assert cohaul.plan(scenario, map=elsewhere, agents=12) == plan
    text = cohaul.plan(scenario.read_text(), map=elsewhere, agents=12)
    assert (text.cost, text.name) == (plan.cost, "instance")


# instances of other projects


@needs_bench
@pytest.mark.parametrize(
    "path, options",
    [
        ("grid/map_8by8_obst12_agents8_ex0.yaml", {"planner": "cbs"}),
        ("grid/map_32by32_obst204_agents60_ex0.yaml", {}),
        ("ta/map_8by8_obst12_agents8_ex0_win3.yaml", {"planner": "cbs-ta"}),
        ("ta/map_8by8_obst12_agents8_ex0_win3.yaml", {"planner": "ita-cbs"}),
        ("ta/map_32by32_obst204_agents30_ex0_all.yaml", {}),
        ("movingai/random-32-32-10-random-1.scen", {"agents": 100}),
        ("cl_cbs/map_50by50_obst25_agents10_ex0.yaml", {}),
        ("cl_cbs/map_100by100_obst50_agents50_ex0.yaml", {}),
        ("cl_cbs/map_100by100_obst50_agents10_ex0.yaml", {"model": "exact"}),
        ("cl_cbs/map_100by100_obst0_agents50_ex0.yaml", {"batch": 10}),
        ("cl_cbs/map_300by300_obst100_agents60_ex0.yaml", {}),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(map(str, value.values())),
)
def test_instances_of_others_are_solved_and_certified(path, options, tmp_path):
    path = BENCH / path
    arguments = [text for key, value in options.items() for text in (f"--{key}", str(value))]
    found = answer("plan", path, "--out", tmp_path / "plan.yaml", *arguments)
    assert found["status"] == "solved"
    kept = [text for key, value in options.items() if key in ("agents", "model") for text in (f"--{key}", str(value))]
    assert answer("certify", tmp_path / "plan.yaml", "--instance", path, *kept)["ok"]
    if found["planner"] in ("cbs", "cbs-ta", "ita-cbs"):
        assert found["cost"] == found["lower_bound"]
    elif found["planner"] != "cl-cbs":
        assert found["cost"] <= 1.3 * found["lower_bound"] + 1e-9


@needs_bench
def test_verdicts_agree_agent_by_agent():
    """On every car instance that is here: those with a start or a goal inside an obstacle, and all others."""
    with open(BENCH / "infeasible.csv", newline="") as file:
        blamed = {row["instance"]: row for row in csv.DictReader(file)}
    present = sorted((BENCH / "cl_cbs").glob("map_*_obst[1-9]*.yaml"))
    assert sum(path.name in blamed for path in present) >= 10
    for path in present:
        row = blamed.get(path.name, {"goal_in_obstacle_agents": "", "start_in_obstacle_agents": ""})
        names = [agent["name"] for agent in yaml.safe_load(path.read_text())["agents"]]
        told = {
            kind: {names[int(index)] for index in row[f"{kind}_in_obstacle_agents"].split()} for kind in ("start", "goal")
        }
        # what stands in the way is told before anything is searched
        plan = cohaul.plan(path, timeout=5.0 if path.name in blamed else 0.0)
        if path.name in blamed:
            ours = {
                kind: {reason.agents[0] for reason in plan.reasons if reason.kind == f"{kind}_blocked"}
                for kind in ("start", "goal")
            }
            assert (path.name, plan.status, ours) == (path.name, "infeasible", told)
        free = cohaul.plan(path, starts="free", timeout=10.0)
        expected = "infeasible" if told["goal"] else "solved"
        assert (path.name, free.status) == (path.name, expected)
        assert {name for reason in free.reasons for name in reason.agents} == told["goal"]
