"""The Python package: runs, arrays, exceptions, types, and what it does to the interpreter around it."""

import ast
import html
import inspect
import json
import math
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
import tomllib
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cohaul
import numpy as np
import pytest
import yaml
from cohaul import _cohaul
from numpy.testing import assert_allclose, assert_array_equal

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = sorted((ROOT / "scenarios/r2p2").glob("*.yaml"))
FLAT = ROOT / "scenarios/r2p2/flat.yaml"
# a load that six robots cannot move: the mission lasts as long as it may
STUCK = {"loads__0__mass": 1000.0}
SHORT = {"teams__0__mission__time_limit": 5.0}


@pytest.fixture(scope="module")
def flat():
    """The whole mission over flat ground."""
    return cohaul.run(FLAT)


# runs and arrays


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_every_trace_has_its_shape_and_type(path):
    scenario = yaml.safe_load(path.read_text())
    robots, loads = sum(team["robots"]["count"] for team in scenario["teams"]), len(scenario["loads"])
    teams = len(scenario["teams"])
    outcome = cohaul.run(path, **SHORT)
    traces = outcome.traces
    instants = traces.time.size
    assert instants > 0.9 * 20 * outcome.time_s
    shapes = {
        "time": (instants,),
        "load_pose": (instants, loads, 3),
        "robot_pose": (instants, robots, 3),
        "command": (instants, robots, 2),
        "speed": (instants, robots),
        "role": (instants, robots),
        "phase": (instants, robots),
        "stop": (instants, robots),
        "primitive": (instants, teams),
        "heading_error": (instants, teams),
        "distance": (instants, teams),
        "waypoint": (instants, teams),
    }
    kinds = {"role": "int8", "phase": "int8", "primitive": "int8", "stop": "bool", "waypoint": "int64"}
    for name, shape in shapes.items():
        array = getattr(traces, name)
        assert (name, array.shape, array.dtype) == (name, shape, kinds.get(name, "float64"))
        assert array.flags.c_contiguous and not array.flags.writeable
        with pytest.raises(ValueError):
            array.setflags(write=True)
    assert traces is outcome.traces, "the arrays are made once"


def test_traces_tell_what_happened(flat):
    traces = flat.traces
    assert flat.outcome == "reached" and flat.success
    assert traces.time[0] == 0.0 and traces.time[-1] == flat.time_s
    assert (np.diff(traces.time) > 0).all()
    last = traces.load_pose[-1, 0]
    # the goal of the scenario
    assert_allclose(np.hypot(last[0] - 3.0, last[1] - 0.5), flat.final_error_m, rtol=1e-9)
    assert set(np.unique(traces.role)) <= set(cohaul.Role)
    assert set(np.unique(traces.phase)) <= set(cohaul.Phase)
    turning = traces.primitive[:, 0] == cohaul.Primitive.ROTATE_COUNTERCLOCKWISE
    assert turning.any() and (traces.heading_error[turning, 0] > 0.0).all()
    steps = np.diff(traces.robot_pose[..., :2], axis=0)
    apart = traces.robot_pose[:, :, None, :2] - traces.robot_pose[:, None, :, :2]
    distance = np.linalg.norm(apart, axis=-1) + np.where(np.eye(6), np.inf, 0.0)
    assert distance.min() == pytest.approx(flat.min_robot_distance_m, abs=0.01)
    assert np.linalg.norm(steps, axis=-1).max() < 0.22 * 0.05 * 1.5


def test_codes_are_those_of_the_page(flat):
    data = re.search(r'"phases":(\[[^]]*\]).*?"roles":(\[[^]]*\])', flat.html())
    assert data is not None
    names = [[name.lower() for name in enum.__members__ if name != "NONE"] for enum in (cohaul.Phase, cohaul.Role)]
    assert [json.loads(group) for group in data.groups()] == names


def test_same_seed_same_outcome(flat):
    again = cohaul.run(FLAT)
    assert again == flat
    for name in vars(flat.traces):
        assert_array_equal(getattr(again.traces, name), getattr(flat.traces, name))
    assert again.html() == flat.html()
    assert cohaul.run(FLAT, seed=2) != flat


def test_resolved_scenario_gives_the_same_outcome():
    drawn = cohaul.run(FLAT, seed=7, randomize={"loads.0.mass": [1.5, 2.5]}, **SHORT)
    assert "mass: 2.0\n" not in drawn.scenario
    assert cohaul.run(drawn.scenario) == drawn


def test_names_are_those_of_the_command(flat, tmp_path):
    command = [sys.executable, "-m", "cohaul", "run", FLAT, "--json", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    printed = json.loads(done.stdout)
    ours = flat.to_dict()
    assert set(ours) - set(printed) == {"name"}
    assert set(printed) - set(ours) == {"picture", "warnings"}
    differ = {"log", "page", "records", "cpu_s", "wall_s", "real_time_factor"}
    assert {k: printed[k] for k in ours if k not in differ | {"name"}} == {
        k: v for k, v in ours.items() if k not in differ | {"name"}
    }


def test_every_seed_is_exact():
    for seed in (2**53 + 1, 2**64 - 1, np.int64(5)):
        assert cohaul.run(FLAT, seed=seed, **SHORT).seed == seed


def test_world_can_be_chosen(flat):
    spatial = cohaul.run(FLAT, world="spatial", **SHORT)
    assert (spatial.world, flat.world) == ("spatial", "planar")


def test_overrides_reach_the_scenario():
    by_name = cohaul.run(FLAT, loads__0__mass=np.float32(3.5), **SHORT)
    by_path = cohaul.run(FLAT, set={"loads.0.mass": 3.5, "teams.0.mission.time_limit": 5})
    assert "mass: 3.5" in by_name.scenario
    assert by_name == by_path
    moved = cohaul.run(FLAT, loads__0__pose={"x": 0.25, "y": np.float64(0.0), "yaw_deg": 0}, **SHORT)
    assert moved.traces.load_pose[0, 0, 0] == pytest.approx(0.25, abs=0.01)  # jitter of the start
    boxed = cohaul.run(FLAT, terrain__workspace=np.array([-2.0, -2.0, 5.0, 3.0]), **SHORT)
    assert "workspace" in boxed.scenario


# files


def test_nothing_is_written_without_out(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = cohaul.run(FLAT, **SHORT)
    assert (outcome.log, outcome.page, outcome.records) == (None, None, 0)
    assert outcome.html().startswith("<!doctype html>")
    assert list(tmp_path.iterdir()) == []


def test_log_and_page_are_written_into_out(tmp_path):
    outcome = cohaul.run(FLAT, out=tmp_path / "a/b", **SHORT)
    assert outcome.log == tmp_path / "a/b/flat.mcap" and outcome.page == tmp_path / "a/b/flat.html"
    assert outcome.page.read_text(encoding="utf-8") == outcome.html()
    replayed = cohaul.replay(outcome.log)
    assert replayed.ok and replayed.decisions > 100 and replayed.first_difference is None
    assert replayed.version == cohaul.__version__

    whole = outcome.log.read_bytes()
    outcome.log.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(cohaul.RecordError, match="unfinished|damaged"):
        cohaul.replay(outcome.log)
    recovered = cohaul.recover(outcome.log)
    assert recovered.log == tmp_path / "a/b/flat.recovered.mcap" and recovered.reason
    assert 0 < recovered.messages < outcome.records
    assert cohaul.replay(recovered.log).ok
    elsewhere = cohaul.recover(outcome.log, out=tmp_path / "saved.mcap")
    assert elsewhere.log.read_bytes() == recovered.log.read_bytes()


def test_page_and_picture_are_saved(flat, tmp_path):
    page, picture = flat.save(tmp_path / "new")
    assert page.read_text(encoding="utf-8") == flat.html()
    assert picture.read_text(encoding="utf-8") == flat.picture()
    assert flat.picture().startswith("<svg")


def test_notebooks_show_the_page(flat):
    shown = flat._repr_html_()
    found = re.fullmatch(r'<iframe [^>]*srcdoc="([^"]*)"></iframe>', shown)
    assert found and html.unescape(found[1]) == flat.html()


def test_outcome_reads_well(flat):
    assert repr(flat) == f"<Outcome of flat, seed 1: reached after {flat.time_s:.1f} s>"
    assert "least clearance" in str(flat)
    assert "load_pose" in repr(flat.traces)


# exceptions


def test_bad_scenario_names_its_place():
    path = ROOT / "tests/bad/unknown_world.yaml"
    with pytest.raises(cohaul.ScenarioError) as caught:
        cohaul.run(path)
    error = caught.value
    line = path.read_text(encoding="utf-8").splitlines().index("world: spacial") + 1
    assert (error.file, error.line, error.column, error.overrides) == (str(path), line, 8, ())
    assert error.message in str(error) and str(error).startswith(f"{path}:{line}:8: ")
    assert "planar" in error.remedy and error.remedy in error.__notes__[0]
    assert isinstance(error, ValueError) and isinstance(error, cohaul.CohaulError)
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.line, copy.remedy) == (str(error), error.line, error.remedy)


@pytest.mark.parametrize("path", sorted((ROOT / "tests/bad").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_bad_scenario_is_refused(path):
    with pytest.raises(cohaul.ScenarioError) as caught:
        cohaul.check(path)
    assert caught.value.line >= 1 and caught.value.column >= 1 and caught.value.remedy


@pytest.mark.parametrize(
    "override",
    [
        {"loads__0__mass": -1},
        {"loads__0__mass": math.nan},
        {"loads__0__mass": "heavy"},
        {"seed": -1},
        {"seed": 2**64},
        {"seed": 1.5},
        {"world": "flat"},
        {"no_such_key": 1},
        {"set": {"": 1}},
    ],
    ids=str,
)
def test_bad_override_is_blamed(override):
    with pytest.raises(cohaul.ScenarioError) as caught:
        cohaul.run(FLAT, **override)
    assert len(caught.value.overrides) == 1 and caught.value.line is None


def test_values_that_json_cannot_say_are_type_errors():
    with pytest.raises(TypeError, match=r"loads\.0\.mass"):
        cohaul.run(FLAT, loads__0__mass=object())
    with pytest.raises(TypeError):
        cohaul.run(3)
    with pytest.raises(TypeError):
        cohaul.run(FLAT, 7)


def test_scenario_may_be_text():
    text = FLAT.read_text(encoding="utf-8")
    assert cohaul.run(text, **SHORT) == cohaul.run(FLAT, **SHORT)
    with pytest.raises(cohaul.ScenarioError, match=r"^scenario:2:"):
        cohaul.check("format: cohaul/1\nname: []\n")


@pytest.mark.parametrize("use", [cohaul.run, cohaul.check, cohaul.replay, cohaul.recover])
def test_missing_file_is_named(use, tmp_path):
    with pytest.raises(cohaul.MissingFileError) as caught:
        use(tmp_path / "none.yaml")
    assert isinstance(caught.value, FileNotFoundError) and isinstance(caught.value, cohaul.CohaulError)
    assert caught.value.filename == str(tmp_path / "none.yaml")


def test_unusable_file_is_named(tmp_path):
    with pytest.raises(cohaul.FileError) as caught:
        cohaul.run(tmp_path)
    assert isinstance(caught.value, OSError) and caught.value.filename == str(tmp_path)
    with pytest.raises(cohaul.FileError):
        cohaul.run(FLAT, out=FLAT)


def test_no_log_is_no_log():
    with pytest.raises(cohaul.RecordError, match="not an MCAP file"):
        cohaul.replay(FLAT)


def test_doubtful_scenario_warns():
    path, change = ROOT / "tests/bad/caging_broken.yaml", {"teams__0__formation__caging": "partial"}
    found = cohaul.check(path, **change)
    assert [w.message.startswith("team `team` does not cage its load") for w in found] == [True]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        cohaul.run(path, **change, **SHORT)
    assert [str(w.message) for w in caught] == [str(w) for w in found]
    assert all(w.category is cohaul.ScenarioWarning for w in caught)
    assert cohaul.check(FLAT) == []


def test_schema_is_that_of_the_repository():
    assert cohaul.schema() == json.loads((ROOT / "scenarios/scenario.schema.json").read_text(encoding="utf-8"))


# the interpreter


def test_other_threads_go_on_during_a_run():
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.perf_counter()
    cohaul.run(FLAT, **STUCK, teams__0__mission__time_limit=300.0)
    end = time.perf_counter()
    done.set()
    thread.join()
    during = [t for t in ticks if start < t < end]
    # a thread of a run that held the interpreter would tick once per simulated second at best, when signals are asked for
    assert len(during) > 20
    assert max(np.diff(during)) < 0.5 * (end - start)


def test_missions_run_in_threads_of_their_own():
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda seed: cohaul.run(FLAT, seed=seed), range(8)))
    assert together == [cohaul.run(FLAT, seed=seed) for seed in range(8)]


ENDLESS = "loads.0.mass=1000", "teams.0.mission.time_limit=100000"


def interrupted(command, tmp_path):
    """Result of a process that gets Ctrl-C one second after it begins to simulate, and how long it took to end."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    log, until = tmp_path / "flat.mcap", time.monotonic() + 60
    while not (log.exists() and log.stat().st_size) and process.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
    time.sleep(1.0)
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    return process.returncode, out, err, time.monotonic() - start


def test_ctrl_c_ends_a_run(tmp_path):
    changes = dict(change.split("=") for change in ENDLESS)
    code = f"""
import cohaul
try:
    cohaul.run({str(FLAT)!r}, out={str(tmp_path)!r}, set={ {k: float(v) for k, v in changes.items()} })
except KeyboardInterrupt:
    print("interrupted")
"""
    status, out, err, seconds = interrupted([sys.executable, "-c", code], tmp_path)
    assert (status, out, err) == (0, "interrupted\n", "")
    assert seconds < 20
    # what was simulated is on disk
    assert cohaul.replay(tmp_path / "flat.mcap").ok


def test_ctrl_c_ends_the_command(tmp_path):
    command = [sys.executable, "-m", "cohaul", "run", str(FLAT), "--out", str(tmp_path)]
    for change in ENDLESS:
        command += ["--set", change]
    status, _, err, _ = interrupted(command, tmp_path)
    assert (status, err) == (130, "")


def test_command_is_installed():
    script = Path(sys.executable).with_name("cohaul")
    done = subprocess.run([script, "--version"], capture_output=True, text=True, check=True)
    assert done.stdout == f"cohaul {cohaul.__version__}\n"
    done = subprocess.run([script, "no-such-command"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and done.stdout == ""
    done = subprocess.run([script, "check", ROOT / "tests/bad/nan.yaml"], capture_output=True, text=True, check=False)
    assert done.returncode == 3


def test_import_is_quick():
    code = "import time; t = time.perf_counter(); import cohaul; print(time.perf_counter() - t)"
    seconds = [float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(7)]
    # the quickest of several, because other programs run too
    assert min(seconds) < 0.1
    loaded = subprocess.check_output([sys.executable, "-c", "import sys, cohaul; print('numpy' in sys.modules)"])
    assert loaded == b"False\n"


# contact


def test_limit_surface_of_the_papers_load():
    surface = cohaul.LimitSurface.rectangle(along_x=0.35, along_y=1.35)
    # closed form 0.35929 m; the quadrature is 0.42 % above it
    assert surface.friction_radius() == pytest.approx(0.35929, rel=0.005)
    assert_allclose(surface.wrench(twist=[1, 0, 0], limit=2.0), [-2.0, 0.0, 0.0], atol=1e-15)
    assert_array_equal(surface.wrench(twist=np.zeros(3), limit=2.0), np.zeros(3))
    for model in ("exact", "ellipsoid"):
        surface = cohaul.LimitSurface.rectangle(along_x=0.35, along_y=1.35, model=model)
        for twist in ([0.3, -0.1, 0.5], np.array([0, 1, -2], dtype=np.float32), np.arange(6.0)[::2]):
            # friction power is −limit times the dissipation
            power = surface.wrench(twist=twist, limit=2.0) @ np.asarray(twist, dtype=float)
            assert power == pytest.approx(-2.0 * surface.dissipation(twist=twist), rel=1e-12)


def test_polygon_is_moved_to_its_centroid():
    corners = np.array([[0.0, 0.0], [0.35, 0.0], [0.35, 1.35], [0.0, 1.35]])
    polygon = cohaul.LimitSurface.polygon(corners)
    rectangle = cohaul.LimitSurface.rectangle(along_x=0.35, along_y=1.35)
    twist = [0.1, 0.2, 0.3]
    assert_allclose(polygon.wrench(twist=twist, limit=1.0), rectangle.wrench(twist=twist, limit=1.0), rtol=1e-12)


@pytest.mark.parametrize(
    "make",
    [
        lambda surface: surface.rectangle(along_x=-1.0, along_y=1.0),
        lambda surface: surface.rectangle(along_x=1.0, along_y=1.0, model="box"),
        lambda surface: surface.polygon([[0, 0], [1, 0]]),
        lambda surface: surface.polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
        lambda surface: surface.polygon("corners"),
        lambda surface: surface.polygon([[0, 0], [1, 0], [0, math.nan]]),
        lambda surface: surface.rectangle(along_x=1.0, along_y=1.0).wrench(twist=[1, 0], limit=1.0),
        lambda surface: surface.rectangle(along_x=1.0, along_y=1.0).dissipation(twist=np.zeros((3, 1))),
    ],
)
def test_bad_contact_values_are_refused(make):
    with pytest.raises(cohaul.ContactError) as caught:
        make(cohaul.LimitSurface)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, cohaul.CohaulError)


# types


def members(body):
    """Names defined in a list of statements of the stub, with their docstrings."""
    found = {}
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found[node.name] = (node, ast.get_docstring(node))
        elif isinstance(node, ast.AnnAssign):
            found[node.target.id] = (node, None)
    return found


def test_stub_names_everything():
    stub = members(ast.parse(Path(_cohaul.__file__).with_name("_cohaul.pyi").read_text(encoding="utf-8")).body)
    public = {name for name in vars(_cohaul) if not name.startswith("__")}
    assert set(stub) == public == set(_cohaul.__all__)
    for name, (node, doc) in stub.items():
        if doc:
            assert inspect.getdoc(getattr(_cohaul, name)) == doc, name
        if isinstance(node, ast.ClassDef):
            methods = members(node.body)
            actual = vars(getattr(_cohaul, name))
            assert set(methods) == {m for m in actual if not m.startswith("__")}, name
            for method, (_, text) in methods.items():
                assert (inspect.getdoc(getattr(getattr(_cohaul, name), method)) or None) == text, f"{name}.{method}"


USER_SCRIPT = """
from pathlib import Path

import cohaul
import numpy as np
from numpy.typing import NDArray

outcome = cohaul.run(Path("flat.yaml"), seed=7, out="out", loads__0__mass=3.3, set={"name": "x"})
path: NDArray[np.float64] = outcome.traces.load_pose[:, 0, :2]
pushing: NDArray[np.bool_] = outcome.traces.role == cohaul.Role.PUSH
seconds: float = outcome.time_s
log: Path | None = outcome.log
wrench: NDArray[np.float64] = cohaul.LimitSurface.rectangle(along_x=1, along_y=2).wrench(twist=[1, 0, 0], limit=1)
try:
    warnings: list[cohaul.ScenarioWarning] = cohaul.check("flat.yaml", world="planar")
except cohaul.ScenarioError as error:
    line: int | None = error.line
replayed = cohaul.replay("x.mcap")
robot: int | None = replayed.first_difference.robot if replayed.first_difference else None
plan = cohaul.plan(Path("cars.yaml"), bound=2, model="exact", agents=3)
states: dict[str, NDArray[np.float64]] = plan.routes
wrong: list[cohaul.Violation] = cohaul.certify("plan.yaml", "cars.yaml") + cohaul.certify(plan)
blamed: tuple[str, ...] = plan.reasons[0].agents
poses: NDArray[np.float64] = cohaul.planning.dubins((0, 0, 0), [1, 1, 0], radius=1).sample(0.1)
cohaul.run("flat.yaml", 7)  # type: ignore[call-arg]
cohaul.LimitSurface.rectangle(along_x=1, along_y=2, model="box")  # type: ignore[arg-type]
"""


def test_types_are_strict(tmp_path):
    pytest.importorskip("mypy")
    script = tmp_path / "user.py"
    script.write_text(USER_SCRIPT, encoding="utf-8")
    mypy = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache"]
    for target in (["-p", "cohaul"], [script]):
        done = subprocess.run([*mypy, *target], capture_output=True, text=True, check=False, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
    assert (ROOT / "python/cohaul/py.typed").exists()


def test_everything_public_is_documented():
    for name in cohaul.__all__:
        value = getattr(cohaul, name)
        if not isinstance(value, str):
            assert inspect.getdoc(value), name


def test_version_is_that_of_the_workspace():
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text(encoding="utf-8"))
    assert cohaul.__version__ == workspace["workspace"]["package"]["version"]


# notebooks


@pytest.mark.parametrize("path", sorted((ROOT / "python/notebooks").glob("*.py")), ids=lambda path: path.stem)
def test_notebook_runs(path, tmp_path):
    for module in ("jupytext", "matplotlib", "nbmake"):
        pytest.importorskip(module)
    notebook = tmp_path / f"{path.stem}.ipynb"
    subprocess.run([sys.executable, "-m", "jupytext", "--to", "ipynb", "-o", notebook, path], check=True)
    command = [sys.executable, "-m", "pytest", "--nbmake", "-p", "no:cacheprovider", "--overwrite", notebook]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    shown = [kind for cell in cells for output in cell.get("outputs", []) for kind in output.get("data", {})]
    assert "image/png" in shown and "text/html" in shown
