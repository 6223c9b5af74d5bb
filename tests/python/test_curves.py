"""Shortest curves against OMPL's, and assignments against SciPy's: other people's code for the same mathematics."""

import itertools
import math

import cohaul
import numpy as np
import pytest
from cohaul import planning
from numpy.testing import assert_allclose

PAIRS = 10_000
SEED = 1
# lengths in metres; both sides compute in doubles, where rounding is some 1e-12 of a path of at most 60 m
TOLERANCE = 1e-6


def poses(seed):
    """Pairs of poses, 16 m apart at most, a tenth of them with headings and offsets that are special to the formulas."""
    random = np.random.default_rng(seed)
    pairs = random.uniform([-8, -8, -math.pi], [8, 8, math.pi], size=(PAIRS, 2, 3))
    special = random.integers(-4, 5, size=(PAIRS // 10, 2, 3)) * [1.0, 1.0, math.pi / 4]
    pairs[:: 10] = special
    return pairs


def ompl_lengths(space, pairs):
    """Distances in an OMPL state space."""
    ends = [space.allocState(), space.allocState()]
    found = []
    for pair in pairs.tolist():
        for state, (x, y, yaw) in zip(ends, pair, strict=True):
            state.setX(x)
            state.setY(y)
            state.setYaw(yaw)
        found.append(space.distance(*ends))
    return np.array(found)


@pytest.mark.parametrize("kind, radius", [("reeds_shepp", 1.0), ("reeds_shepp", 3.0), ("dubins", 1.0), ("dubins", 3.0)])
def test_lengths_are_those_of_ompl(kind, radius):
    base = pytest.importorskip("ompl.base")
    space = {"reeds_shepp": base.ReedsSheppStateSpace, "dubins": base.DubinsStateSpace}[kind](radius)
    curve = {"reeds_shepp": planning.reeds_shepp, "dubins": planning.dubins}[kind]
    pairs = poses(SEED)
    ours = np.array([curve(start, goal, radius=radius).length for start, goal in pairs])
    theirs = ompl_lengths(space, pairs)
    differ = np.abs(ours - theirs) > TOLERANCE
    worst = pairs[np.argmax(np.abs(ours - theirs))]
    assert not differ.any(), f"{differ.sum()} of {PAIRS}: {worst} ours {ours[differ][:3]} theirs {theirs[differ][:3]}"


@pytest.mark.parametrize("curve", [planning.reeds_shepp, planning.dubins])
def test_samples_lie_on_arcs_from_start_to_goal(curve):
    radius, spacing = 2.0, 0.05
    for start, goal in poses(2)[:300]:
        found = curve(start, goal, radius=radius)
        states = found.sample(spacing)
        assert states.dtype == np.float64 and states.shape[1] == 3 and not states.flags.writeable
        assert_allclose(states[0], start, rtol=0, atol=1e-12)
        assert_allclose(states[-1, :2], goal[:2], rtol=0, atol=1e-6)
        assert abs(math.remainder(states[-1, 2] - goal[2], math.tau)) < 1e-6
        steps = np.diff(states, axis=0)
        chords = np.hypot(steps[:, 0], steps[:, 1])
        assert chords.max() <= spacing + 1e-12
        # no arc is tighter than the radius; a chord is shorter than its arc by 1 − (s/r)²/24, here 3e-5
        turned = np.abs(steps[:, 2])
        assert (turned <= chords / radius * (1 + 1e-4) + 1e-9).all()
        assert chords.sum() == pytest.approx(found.length, rel=1e-4, abs=1e-9)
        # and every step goes along the heading
        middle = states[:-1, 2] + steps[:, 2] / 2
        ahead = steps[:, 0] * np.cos(middle) + steps[:, 1] * np.sin(middle)
        assert_allclose(np.abs(ahead), chords, rtol=0, atol=1e-9)
        if curve is planning.dubins:
            assert (ahead > -1e-9).all() and all(length > 0 for _, length in found.segments)


def test_bad_poses_are_refused():
    for start, goal, radius in [((0, 0), (1, 1, 1), 1), ((0, 0, math.nan), (1, 1, 1), 1), ((0, 0, 0), (1, 1, 1), 0)]:
        with pytest.raises(cohaul.PlanError):
            planning.reeds_shepp(start, goal, radius=radius)
    with pytest.raises(cohaul.PlanError, match="spacing"):
        planning.dubins((0, 0, 0), (1, 1, 1), radius=1).sample(0.0)


# assignments

# what stands for a forbidden pair in SciPy, which must find a full assignment: dearer than all allowed ones together
FORBIDDEN = 1e6


def scipy_best(costs):
    """Number of goals taken and least cost."""
    optimize = pytest.importorskip("scipy.optimize")
    allowed = np.isfinite(costs)
    rows, columns = optimize.linear_sum_assignment(np.where(allowed, costs, FORBIDDEN))
    taken = allowed[rows, columns]
    return int(taken.sum()), float(costs[rows[taken], columns[taken]].sum())


def random_costs(random, most):
    agents, goals = random.integers(1, most + 1, size=2)
    costs = random.uniform(0, 100, size=(agents, goals))
    if random.random() < 0.5:
        costs = np.floor(costs / 10)  # many of the same cost
    costs[random.random(size=costs.shape) < random.choice([0.0, 0.1, 0.5, 0.9])] = math.inf
    return costs


@pytest.mark.parametrize("most, count", [(6, 500), (20, 200), (60, 100)])
def test_assignments_are_those_of_scipy(most, count):
    random = np.random.default_rng(most)
    for _ in range(count):
        costs = random_costs(random, most)
        found = planning.assign(costs)
        pairs = [(agent, goal) for agent, goal in enumerate(found.goals) if goal is not None]
        assert len(found.goals) == len(costs) and len({goal for _, goal in pairs}) == len(pairs)
        assert found.cost == pytest.approx(sum(costs[pair] for pair in pairs), abs=1e-9)
        taken, cost = scipy_best(costs)
        assert len(pairs) == taken
        assert found.cost == pytest.approx(cost, abs=1e-9)


def test_next_best_go_on_where_scipy_begins():
    """The whole order for small ones; for large ones the first is SciPy's, the others never fall and never repeat."""
    random = np.random.default_rng(5)
    for _ in range(100):
        costs = random_costs(random, 5)
        taken, _ = scipy_best(costs)
        every = []
        for chosen in itertools.product([None, *range(costs.shape[1])], repeat=costs.shape[0]):
            pairs = [(agent, goal) for agent, goal in enumerate(chosen) if goal is not None]
            if len(pairs) == taken == len({goal for _, goal in pairs}):
                cost = sum(costs[pair] for pair in pairs)
                if math.isfinite(cost):
                    every.append((cost, chosen))
        found = list(planning.assignments(costs))
        assert_allclose([one.cost for one in found], sorted(cost for cost, _ in every), atol=1e-9)
        assert {one.goals for one in found} == {chosen for _, chosen in every}
    for _ in range(20):
        costs = random_costs(random, 60)
        found = list(itertools.islice(planning.assignments(costs), 50))
        assert found[0].cost == pytest.approx(scipy_best(costs)[1], abs=1e-9)
        assert (np.diff([one.cost for one in found]) > -1e-9).all()
        assert len({one.goals for one in found}) == len(found)


def test_costs_must_be_a_table():
    with pytest.raises(cohaul.PlanError, match="shape"):
        planning.assign([1.0, 2.0])
    assert planning.assign(np.zeros((0, 3))) == planning.Assignment((), 0.0)
    assert planning.assign([[math.nan]]).goals == (None,)
    assert planning.assign([[2, 1]]) == planning.Assignment((1,), 1.0)
