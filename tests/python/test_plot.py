"""Figures: they show the data, their colours are the page's, and they can be saved."""

import re
import subprocess
import sys
from itertools import combinations
from pathlib import Path

import cohaul
import matplotlib
import numpy as np
import pandas as pd
import pytest
from cohaul.plot import _style
from cohaul.plot._trials import wilson
from numpy.testing import assert_allclose, assert_array_equal

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
FLAT = ROOT / "scenarios/r2p2/flat.yaml"
TURN = {
    "terrain.friction.dynamic": 0.001,
    "teams.0.mission": {"goal": {"x": 0.26, "y": 0.97}, "time_limit": 60},
    "teams.0.controller.r2p2": {"stance": "square"},
}
"""75 degrees, square to the edge: the robots reposition themselves."""


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    """A whole mission with its log."""
    return cohaul.run(FLAT, out=tmp_path_factory.mktemp("flat"))


@pytest.fixture(scope="module")
def turned():
    """A mission that begins with a rotation and repositioning."""
    return cohaul.run(FLAT, set=TURN)


@pytest.fixture(autouse=True)
def closed_figures():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def trials():
    """81 trials of four factors a terrain, one of which matters."""
    draw = np.random.default_rng(1)
    rows = []
    for terrain in ("downhill", "uphill", "flat"):
        for run in range(81):
            level = {name: float(run // 3**place % 3 + 1) for place, name in enumerate(("a", "b", "c", "d"))}
            reached = run % 7 != 0
            time_s = 100.0 * level["a"] + draw.normal() if reached else 1500.0
            rows.append({**level, "terrain": terrain, "outcome": "reached" if reached else "timed_out", "time_s": time_s})
    return pd.DataFrame(rows).assign(penalty_s=5.0)


def line(ax, label):
    """The line of that label."""
    (found,) = [each for each in ax.lines if each.get_label().startswith(label)]
    return found


def texts(figure):
    """Every text with its place in the picture."""
    figure.canvas.draw()
    # axes keep ticks outside of their limits, which are not drawn
    unused = set()
    for ax in figure.axes:
        for axis in (ax.xaxis, ax.yaxis):
            low, high = sorted(axis.get_view_interval())
            hidden = [tick for tick in axis.get_major_ticks() if not (low <= tick.get_loc() <= high and ax.axison)]
            unused |= {label for tick in hidden for label in (tick.label1, tick.label2)}
    found = figure.findobj(lambda artist: isinstance(artist, matplotlib.text.Text) and artist.get_text().strip())
    drawn = [text for text in found if text.get_visible() and text not in unused]
    return [(text.get_text(), text.get_window_extent()) for text in drawn]


def test_colors_are_those_of_the_page():
    style = (ROOT / "crates/sim/src/page/style.css").read_text(encoding="utf-8")
    light = dict(re.findall(r"--([\w-]+): (#\w{6});", style[: style.index("@media")]))
    assert _style.COLORS == {name: light[name] for name in _style.COLORS}


# linear RGB as seen without one kind of cones: Vienot, Brettel, Mollon 1999
COLOR_VISION = {
    "normal": np.eye(3),
    "protan": np.array([[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]),
    "deutan": np.array([[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]]),
}


def lab(color, vision):
    """CIE L*a*b* (D65) of an sRGB colour as seen with that vision."""
    rgb = np.array(matplotlib.colors.to_rgb(color))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = (to_xyz @ np.clip(COLOR_VISION[vision] @ linear, 0.0, 1.0)) / [0.9505, 1.0, 1.089]
    f = [np.cbrt(v) if v > 0.008856 else 7.787 * v + 16 / 116 for v in (x, y, z)]
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", COLOR_VISION)
def test_colors_of_roles_can_be_told_apart(vision):
    # a difference of 2.3 is just noticeable; ten times that is plain on small marks
    roles = [lab(_style.COLORS[name], vision) for name in ("push", "prevent", "support")]
    assert min(np.linalg.norm(a - b) for a, b in combinations(roles, 2)) > 23.0


def test_trajectory_shows_the_way_and_the_robots(logged):
    traces = logged.traces
    figure = cohaul.plot.trajectory(logged, times=[0.0, 20.0])
    (ax,) = figure.axes
    assert_array_equal(line(ax, "way of the load").get_xydata(), traces.load_pose[:, 0, :2])
    reference = line(ax, "reference").get_xydata()
    assert_allclose(reference, [traces.load_pose[0, 0, :2], [1.0, 0.4], [2.0, 0.0], [3.0, 0.5]])
    circles = [patch for patch in ax.patches if isinstance(patch, matplotlib.patches.Circle)]
    tolerances = [circle for circle in circles if circle.radius == 0.1]
    assert_allclose([circle.center for circle in tolerances], reference[1:])
    index = int(np.searchsorted(traces.time, 20.0))
    robots = [circle for circle in circles if circle.radius == 0.105][6:]
    assert_allclose([circle.center for circle in robots], traces.robot_pose[index, :, :2])
    names = {cohaul.Role.PUSH: "push", cohaul.Role.PREVENT: "prevent", cohaul.Role.SUPPORT: "support"}
    for robot, role in zip(robots, traces.role[index], strict=True):
        color = matplotlib.colors.to_hex(robot.get_facecolor())
        assert color == _style.COLORS[names[cohaul.Role(role)]]
    (final,) = [patch for patch in ax.patches if patch.get_label() == "final pose"]
    assert_allclose(final.get_xy()[:4].mean(axis=0), traces.load_pose[-1, 0, :2])
    assert {"0 s", "20 s"} <= {text.get_text() for text in ax.texts}


def test_a_log_is_drawn_as_its_outcome(logged, tmp_path):
    for draw in (cohaul.plot.trajectory, cohaul.plot.rotation_traces):
        draw(logged, path=tmp_path / "outcome.svg")
        draw(logged.log, path=tmp_path / "log.svg")
        assert (tmp_path / "outcome.svg").read_bytes() == (tmp_path / "log.svg").read_bytes()
    with pytest.raises(cohaul.MissingFileError):
        cohaul.plot.trajectory(tmp_path / "none.mcap")
    with pytest.raises(cohaul.RecordError):
        cohaul.plot.trajectory(FLAT)


def test_rotation_traces_are_the_traces(turned):
    traces = turned.traces
    figure = cohaul.plot.rotation_traces(turned, span=(0.0, 30.0))
    inside = traces.time <= 30.0
    error, rate, push, prevent = figure.axes
    assert_array_equal(error.lines[1].get_xdata(), traces.time[inside])
    assert_array_equal(error.lines[1].get_ydata(), np.degrees(traces.heading_error[inside, 0]))
    assert_allclose(line(error, "begins at 11.46").get_ydata(), 11.459, atol=1e-3)
    yaw = traces.load_pose[:, 0, 2]
    assert_allclose(rate.lines[1].get_ydata(), np.gradient(yaw, traces.time)[inside])
    for ax, role in ((push, cohaul.Role.PUSH), (prevent, cohaul.Role.PREVENT)):
        for robot in range(6):
            has = ((traces.role[:, robot] == role) & (traces.phase[:, robot] == cohaul.Phase.WORK))[inside]
            drawn = [each for each in ax.lines if each.get_label() == f"robot {robot + 1}"]
            assert len(drawn) == has.any()
            for each in drawn:
                assert_array_equal(each.get_ydata(), np.where(has, traces.speed[inside, robot], np.nan))
    # one shade for each interval in which a stop flag is up
    stopped = traces.stop[inside].any(axis=1)
    begins = int(stopped[0]) + int((np.diff(stopped.astype(int)) == 1).sum())
    assert begins >= 2 and len(push.patches) == begins


def test_rotation_traces_choose_the_first_rotation(turned):
    error = cohaul.plot.rotation_traces(turned).axes[0]
    turning = turned.traces.primitive[:, 0] == cohaul.Primitive.ROTATE_COUNTERCLOCKWISE
    first = np.flatnonzero(turning)[0]
    assert error.get_xlim()[0] == turned.traces.time[first]
    last = np.flatnonzero(~turning[first:])[0] + first - 1
    assert error.get_xlim()[1] == turned.traces.time[last]
    straight = cohaul.run(FLAT, set={"teams.0.mission": {"goal": {"x": 0.5, "y": 0.0}, "time_limit": 2}})
    with pytest.raises(ValueError, match="never rotated"):
        cohaul.plot.rotation_traces(straight)
    with pytest.raises(ValueError, match="no two instants"):
        cohaul.plot.rotation_traces(turned, span=(5.0, 5.01))


def test_main_effects_are_means_of_what_was_reached(trials, tmp_path):
    figure = cohaul.plot.main_effects(trials, factors={"a": "gain", "b": "b", "c": "c", "d": "d"})
    assert [ax.get_title() for ax in figure.axes] == ["flat", "uphill", "downhill"]
    for ax in figure.axes:
        reached = trials[(trials.terrain == ax.get_title()) & (trials.outcome == "reached")]
        seconds = reached.time_s + reached.penalty_s
        means = [seconds[reached.a == level].mean() for level in (1.0, 2.0, 3.0)]
        drawn = line(ax, "gain")
        assert_array_equal(drawn.get_xdata(), [1, 2, 3])
        assert_allclose(drawn.get_ydata(), means)
        assert drawn.get_label() == f"gain: Δ {max(means) - min(means):.3g} s"
        assert_allclose(line(ax, "mean").get_ydata(), seconds.mean())
    trials.to_parquet(tmp_path / "trials.parquet")
    for source in (tmp_path, tmp_path / "trials.parquet"):
        again = cohaul.plot.main_effects(source, factors=["a"])
        assert_array_equal(line(again.axes[0], "a:").get_ydata(), line(figure.axes[0], "gain").get_ydata())
    with pytest.raises(ValueError, match="no column e; there are a, b"):
        cohaul.plot.main_effects(trials, factors=["a", "e"])


def test_a_level_where_all_failed_leaves_a_hole(trials):
    spoilt = trials.assign(outcome=trials.outcome.where(trials.a != 3.0, "timed_out"))
    ax = cohaul.plot.main_effects(spoilt, factors=["a"]).axes[0]
    assert_array_equal(np.isnan(line(ax, "a:").get_ydata()), [False, False, True])
    nothing = trials.assign(outcome="timed_out")
    assert cohaul.plot.main_effects(nothing, factors=["a"]).axes[0].texts


def test_success_curves_are_shares_with_their_bands(trials):
    ax = cohaul.plot.success_curves(trials, factor="b").axes[0]
    flat = trials[trials.terrain == "flat"]
    shares = [(flat.outcome == "reached")[flat.b == level].mean() for level in (1.0, 2.0, 3.0)]
    assert_allclose(line(ax, "flat").get_ydata(), shares)
    band = ax.collections[0].get_paths()[0].vertices
    for level, share in zip((1.0, 2.0, 3.0), shares, strict=True):
        low, high = wilson(round(share * 27), 27)
        heights = band[np.isclose(band[:, 0], level)][:, 1]
        assert_allclose([heights.min(), heights.max()], [low, high])


def test_wilson_intervals_are_the_published_ones():
    # Newcombe 1998, table I, method 3
    for successes, count, interval in [(81, 263, (0.2553, 0.3662)), (15, 148, (0.0624, 0.1605)), (0, 20, (0.0, 0.1611))]:
        assert_allclose(wilson(successes, count), interval, atol=5e-5)
    assert wilson(0, 0) == (0.0, 1.0)


def test_flowchart_shows_every_node_and_every_way():
    figure = cohaul.plot.flowchart()
    drawn = [patch.get_gid() for patch in figure.axes[0].patches if patch.get_gid()]
    arrows = [[end.split("+") for end in name.split(" to ")] for name in drawn if " to " in name]
    # only simulations teleport
    nodes = [node for node in cohaul.flow() if node["name"] != "teleport"]
    for node in nodes:
        assert f"{node['kind']} {node['name']}" in drawn
        node["next"] = [way for way in node["next"] if way["to"] != "teleport"]
        for way in node["next"]:
            assert any(node["name"] in source and way["to"] in target for source, target in arrows), (node, way)
    told = {re.sub(r"\s+", " ", text) for text, _ in texts(figure)}
    for node in nodes:
        assert node["text"] in told
        assert {way["why"] for way in node["next"] if way["why"]} <= told


def test_no_text_covers_another_or_is_clipped(logged, turned, trials):
    for figure in (
        cohaul.plot.flowchart(),
        cohaul.plot.trajectory(logged),
        cohaul.plot.rotation_traces(turned),
        cohaul.plot.main_effects(trials, factors=["a", "b", "c", "d"]),
        cohaul.plot.success_curves(trials, factor="a"),
    ):
        page = figure.bbox.padded(1.0)
        shown = texts(figure)
        for text, box in shown:
            assert page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1, text
        for (a, box_a), (b, box_b) in combinations(shown, 2):
            assert not box_a.overlaps(box_b), (a, b)


@pytest.mark.parametrize("name", ["flat", "uphill", "downhill"])
def test_no_robot_covers_a_time(name):
    figure = cohaul.plot.trajectory(cohaul.run(ROOT / "scenarios/r2p2" / f"{name}.yaml"))
    (ax,) = figure.axes
    figure.canvas.draw()
    robots = [p for p in ax.patches if isinstance(p, matplotlib.patches.Circle) and p.radius == 0.105]
    assert len(ax.texts) == 4 and len(robots) == 24
    for text in ax.texts:
        box = text.get_window_extent()
        for robot in robots:
            # the disc touches the box if the point of the box nearest to its centre lies within
            center = ax.transData.transform(robot.center)
            radius = ax.transData.transform(np.add(robot.center, (0.105, 0.0)))[0] - center[0]
            nearest = np.clip(center, (box.x0, box.y0), (box.x1, box.y1))
            assert np.linalg.norm(nearest - center) > radius, text.get_text()


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_figures_are_saved_by_their_ending(logged, turned, trials, tmp_path, ending):
    begins = {"png": b"\x89PNG", "svg": b"<?xml"}[ending]
    draw = {
        "trajectory": lambda path: cohaul.plot.trajectory(logged, path=path),
        "rotation": lambda path: cohaul.plot.rotation_traces(turned, path=path),
        "effects": lambda path: cohaul.plot.main_effects(trials, factors=["a"], path=path),
        "success": lambda path: cohaul.plot.success_curves(trials, factor="a", path=path),
        "flow": lambda path: cohaul.plot.flowchart(path=path),
    }
    for name, save in draw.items():
        path = tmp_path / "new" / f"{name}.{ending}"
        assert isinstance(save(path), matplotlib.figure.Figure)
        content = path.read_bytes()
        assert content.startswith(begins) and len(content) > 5_000
        save(path)
        assert path.read_bytes() == content, "the same figure gives the same file"


def test_figures_go_into_axes_of_the_caller(logged, trials):
    figure, axes = plt.subplots(ncols=3)
    assert cohaul.plot.trajectory(logged, ax=axes[0]) is figure
    assert cohaul.plot.success_curves(trials, factor="a", ax=axes[1]) is figure
    assert cohaul.plot.flowchart(ax=axes[2]) is figure


def test_what_is_not_installed_is_named(tmp_path):
    code = f"""
import sys
sys.modules["matplotlib"] = sys.modules["pandas"] = None
import cohaul
for draw in (cohaul.plot.flowchart, lambda: cohaul.plot.success_curves({str(tmp_path)!r}, factor="a")):
    try:
        draw()
    except cohaul.MissingPackageError as error:
        print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    lines = [f"{name} is not installed; get it with: pip install cohaul[plot]" for name in ("matplotlib", "pandas")]
    assert done.stdout.splitlines() == lines


def test_import_loads_no_figures():
    code = "import sys, cohaul; assert not {'cohaul.plot', 'matplotlib', 'pandas'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_trials_are_selected_by_their_values(trials):
    doubled = pd.concat([trials.assign(kind="one"), trials.assign(kind="other", time_s=0.0)])
    selected = cohaul.plot.main_effects(doubled, factors=["a"], where={"kind": "one"})
    whole = cohaul.plot.main_effects(trials, factors=["a"])
    for ours, theirs in zip(selected.axes, whole.axes, strict=True):
        assert_allclose(ours.lines[-1].get_ydata(), theirs.lines[-1].get_ydata())
    with pytest.raises(cohaul.PlotError, match="no column nothing"):
        cohaul.plot.main_effects(trials, factors=["a"], where={"nothing": 1})
